--- The forces of a system, and what is watched, as one traced function of (q, v, t), for steps that
-- must not jump over what is narrow in them (solver:run{control = { hidden = }}).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local entries = lists.entries

local ROOM = 0.02      -- of a tolerance: what is watched may be off by so much unseen
local LARGEST = 20000  -- operations: beyond it nothing is looked for

-- operations that make no narrow feature of smooth motion: sums, products, powers of low degree
local SMOOTH = { ["+"] = true, ["-"] = true, ["*"] = true, fma = true }

-- is every node of the function a polynomial?
local function is_polynomial(f)
  for line in f:graph():gmatch "[^\n]+" do
    local text = (line:match "= (.*)$" or ""):gsub("%^[2-6]%f[%D]", "")
    for word in text:gmatch "%a[%w_]*" do
      if not word:find "^[tx]%d+$" and not SMOOTH[word] then return false end
    end
    if text:find "[/^]" then return false end
  end
  return true
end

-- entries of what is watched at (q, v, t, p), in parts of `ROOM` of their tolerances
local function watched_entries(look, ...)
  local names, out = {}, {}
  for name in pairs(look and look.watch or {}) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do
    for i, x in ipairs(entries(look.watch[name](...))) do
      out[#out + 1] = x / (ROOM * (look.tolerance[name] or look.tolerance[name .. i]))
    end
  end
  return out
end

-- (dL/dq, what else pushes, dL/dv, what is watched): of the last what counts is its size, of the
-- others their impulse
local function all_forces(system, look)
  local given, n, watched = system.given, system.Q.dimension, 0
  local L = bound(given.L, given.params)
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local force = given.force and not given.control and bound(given.force, given.params)
  local f = core.trace(function(q, v, t)
    local g, out, p = slope(q, v, t), {}, {}
    for i = 1, n do out[i] = g[i] end
    for _, f in ipairs(force and entries(force(q, v, t)) or {}) do out[#out + 1] = f end
    for i = 1, n do p[i], out[#out + 1] = g[n + i], g[n + i] end
    local seen = watched_entries(look, q, v, t, core.vector(p))
    watched = #seen
    return core.vector(table.move(seen, 1, watched, #out + 1, out))
  end, n, n, "number")
  return f, watched
end

--- The function and how many of its last entries are watched, or nil and why nothing can be hidden
-- in the forces, or is not looked for. look: { watch = { name = f(q, v, t, p) }, tolerance = } with
-- the tolerance of each column, or nil.
function M.of(system, look)
  if not system.given.L then return nil, "the system is given by its H" end
  if system.place then return nil, "the system lives on a group" end
  local fine, f, watched = blame.try(all_forces, system, look)
  if look and not (fine and f:operations() <= LARGEST) then return M.of(system) end
  if not fine then return nil, "the forces are not traced" end
  if f:operations() > LARGEST then
    return nil, ("the forces are %d operations"):format(f:operations())
  end
  if is_polynomial(f) then return nil end
  return f, watched
end

return M
