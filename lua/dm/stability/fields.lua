--- Linear theory of fields on meshes: their fastest oscillation along the orbit of a cell. Fields
-- have no forces that are linear in v, so every rule takes their oscillations apart.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local PLACES, LONGEST = 8, 4096 -- states that are looked at, and steps of the orbit

-- the largest frequency about q: verlet's limit is 2 over it
local function fastest(system, q)
  return 2 / system:stability_limit("verlet", { q = q })
end

-- is the frequency the same at a state that has nothing to do with the start?
local function is_constant(system, omega)
  local random, q = core.random(1), core.zeros(system.field.n)
  for i = 1, #q do q[i] = 2 * random:uniform(i, 0) - 1 end
  local fine, other = blame.try(fastest, system, q)
  return fine and math.abs(other - omega) <= 1e-9 * omega
end

-- q at even times of the run of a cell
local function states(map, cell, system)
  local h = map.h[1]
  local steps = math.ceil(math.min(LONGEST, (map.options.t or map.options.steps * h) / h))
  local fine, path = blame.try(function()
    return system:solver({ rule = map.rule_list[cell.rule], h = h }):run { q = map.start.q(cell),
      v = map.start.v and map.start.v(cell), p = map.start.p and map.start.p(cell),
      t0 = map.options.t0, steps = steps, every = math.max(1, steps // PLACES) }
  end)
  local out = {}
  for i = 1, fine and #path or 0 do out[i] = path.q[i] end
  return out
end

--- { fastest, matrices = {}, modes = { fastest }, constant }; nil and why.
function M.along_orbit(map, cell, system)
  if system.field.sphere then
    return nil, "no linear theory of fields with values on a sphere is there"
  end
  local fine, omega = blame.try(fastest, system, map.start.q(cell))
  if not fine then return nil, (tostring(omega):gsub("^[^\n]-lua:%d+: ", "")) end
  local out = { matrices = {}, fastest = omega, constant = is_constant(system, omega) }
  for _, q in ipairs(out.constant and {} or states(map, cell, system)) do
    out.fastest = math.max(out.fastest, fastest(system, q))
  end
  out.modes = { out.fastest }
  if not (out.fastest > 0) then return nil, "nothing oscillates along the orbit" end
  return out
end

return M
