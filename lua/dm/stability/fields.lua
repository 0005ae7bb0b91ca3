--- Linear theory of fields on meshes: their fastest oscillation along the orbit of a cell. Fields
-- have no forces that are linear in v, so every rule takes their oscillations apart.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local ceil, max, min = math.ceil, math.max, math.min

local PLACES, LONGEST = 32, 4096 -- states that are looked at, and steps of the orbit
local CLOSER = 16               -- states about the fastest one
local NEAR = 1e-3               -- of the time: that is its end

-- the largest frequency about q at a time: verlet's limit is 2 over it
local function fastest(system, q, t)
  return 2 / system:stability_limit("verlet", { q = q, t = t })
end

local SOME = { 0.6180339887, 0.2360679775 } -- parts of the time: in step with nothing

-- is the frequency the same at states and times that have nothing to do with the start?
local function is_constant(system, omega, t0, T)
  local random, q = core.random(1), core.zeros(system.field.n)
  for i = 1, #q do q[i] = 2 * random:uniform(i, 0) - 1 end
  for _, part in ipairs(SOME) do
    local fine, other = blame.try(fastest, system, q, t0 + part * T)
    if not (fine and math.abs(other - omega) <= 1e-9 * omega) then return false end
  end
  return true
end

-- a run of a cell with about so many rows, from a state { q, p, t } where one is given; an empty
-- list where it fails
local function orbit(map, cell, system, from, steps, rows)
  local h = map.h[1]
  local solver = system:solver { rule = map.rule_list[cell.rule], h = h }
  local options = { t0 = from and from.t or map.options.t0, steps = steps,
    every = max(1, steps // rows) }
  if from then
    options.q, options.p = from.q, from.p
  else
    options.q = map.start.q(cell)
    options.v = map.start.v and map.start.v(cell)
    options.p = map.start.p and map.start.p(cell)
  end
  local fine, path = blame.try(solver.run, solver, options)
  return fine and path or {}
end

-- the largest frequency at rows of a path, if larger than omega; number of the row that has it
local function largest(system, path, omega)
  local where
  for i = 1, #path do
    local fine, here = blame.try(fastest, system, path.q[i], path.t[i])
    if fine and here > omega then omega, where = here, i end
  end
  return omega, where
end

-- The largest frequency along the orbit, first at rows and then between those about the fastest,
-- and for how long that was.
local function along(map, cell, system, omega, T)
  local h = map.h[1]
  local all = ceil(T / h * (1 - NEAR * NEAR))
  local path = orbit(map, cell, system, nil, min(LONGEST, all), PLACES)
  local found, i = largest(system, path, omega)
  omega, i = max(omega, found), i or 1
  if #path > 1 then
    local from, to = max(1, i - 1), min(#path, i + 1)
    local a = { q = path.q[from], p = path.p[from], t = path.t[from] }
    local steps = math.floor((path.t[to] - a.t) / h + 0.5)
    omega = largest(system, orbit(map, cell, system, a, steps, CLOSER), omega)
  end
  return omega, #path > 0 and path.t[#path] - path.t[1] or 0
end

--- { fastest, matrices = {}, modes = { fastest }, means, constant, T = the time that was looked at,
-- where it is less than all }; nil and why.
function M.along_orbit(map, cell, system)
  if system.field.sphere then
    return nil, "no linear theory of fields with values on a sphere is there"
  end
  local t0 = map.options.t0 or 0
  local T = map.options.t or map.options.steps * map.h[1]
  local fine, omega = blame.try(fastest, system, map.start.q(cell), t0)
  if not fine then return nil, (tostring(omega):gsub("^[^\n]-lua:%d+: ", "")) end
  local out = { matrices = {}, fastest = omega, constant = is_constant(system, omega, t0, T) }
  if not out.constant then
    local done
    out.fastest, done = along(map, cell, system, omega, T)
    out.T = done < (1 - NEAR) * T and done or nil
  end
  out.modes, out.means = { out.fastest }, { [out.fastest] = not out.constant or nil }
  if not (out.fastest > 0) then return nil, "nothing oscillates along the orbit" end
  return out
end

return M
