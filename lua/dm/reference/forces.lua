--- The forces of a system, and what is watched, as one traced function of (q, v, t), of H and on
-- groups of (q, p, t), for steps that must not jump over what is narrow in them
-- (solver:run{control = { hidden = }}).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local constraints = require "dm.reference.constraints"
local core = require "dm.core"
local lists = require "dm.base.lists"
local polynomial = require "dm.reference.polynomial"

local M = {}

local entries = lists.entries

local ROOM = 0.02      -- of a tolerance: what is watched may be off by so much unseen
local LARGEST = 20000  -- operations: beyond it nothing is looked for

-- Entries of what is watched at (q, v, t, p), in parts of `ROOM` of their tolerances. What goes by
-- a name alone, as coordinates, has no features of its own.
local function watched_entries(look, ...)
  local names, out = {}, {}
  for name, f in pairs(look and look.watch or {}) do
    if type(f) == "function" then names[#names + 1] = name end
  end
  table.sort(names)
  for _, name in ipairs(names) do
    for i, x in ipairs(entries(look.watch[name](...))) do
      out[#out + 1] = x / (ROOM * (look.tolerance[name] or look.tolerance[name .. i]))
    end
  end
  return out
end

-- appended to a list, how many
local function append(out, x)
  for i = 1, #x do out[#out + 1] = x[i] end
  return #x
end

-- n entries of a gradient, from number `first` on
local function part(g, first, n)
  local out = {}
  for i = 1, n do out[i] = g[first + i - 1] end
  return core.vector(out)
end

-- f(q, v or p, t) as a traced function: forces, n rates or momenta, what is watched
local function traced(n, f)
  local watched
  local out = core.trace(function(q, v, t)
    local forces, rates, seen = f(q, v, t)
    append(forces, rates)
    watched = append(forces, seen)
    return core.vector(forces)
  end, n, n, "number")
  return out, watched
end

-- (dL/dq, what else pushes, dL/dv, what is watched): of the last what counts is its size, of the
-- others their impulse
local function of_lagrangian(system, look)
  local given, n = system.given, system.Q.dimension
  local L = bound(given.L, given.params)
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local force = given.force and not given.control and bound(given.force, given.params)
  local held = constraints.of(given, n, L)
  return traced(n, function(q, v, t)
    local g, out = slope(q, v, t), {}
    local p = part(g, n + 1, n)
    append(out, part(g, 1, n))
    append(out, force and entries(force(q, v, t)) or {})
    append(out, held and held(q, v, t) or {})
    return out, p, watched_entries(look, q, v, t, p)
  end)
end

-- of H(q, p, t): (dH/dq, what else pushes, dH/dp, what is watched)
local function of_hamiltonian(system, look)
  local given, n = system.given, system.Q.dimension
  local H = bound(given.H, given.params)
  local slope = core.derivative(function(q, p, t) return H(q, p, t) end, n, n, "number")
  local force = given.force and not given.control and bound(given.force, given.params)
  return traced(n, function(q, p, t)
    local g, out = slope(q, p, t), {}
    local v = part(g, n + 1, n)
    append(out, part(g, 1, n))
    append(out, force and entries(force(q, v, t)) or {})
    return out, v, watched_entries(look, q, v, t, p)
  end)
end

-- On a group what is narrow in the element and in t, at one velocity or momentum: rules keep them
-- in ways of their own.
local function on_group(system, look)
  local own, given = system.place, system.given
  local n, d = own.size, own.dimension
  local f = bound(given.L or given.H, given.params)
  local force = given.force and not given.control and bound(given.force, given.params)
  local ones, zeros = core.zeros(d), core.zeros(n)
  for i = 1, d do ones[i] = 1 end
  -- coordinates may be multiples of those of the element
  local function element(q)
    local list, unit = entries(q), {}
    local scale = own.scale and own.scale(list) or {}
    for i = 1, n do unit[i] = scale[i] and list[i] / scale[i] or list[i] end
    return own.element(unit)
  end
  local slope = core.derivative(function(q, t) return f(element(q), ones, t) end, n, "number")
  return traced(n, function(q, _, t)
    local g, out = element(q), {}
    append(out, part(slope(q, t), 1, n))
    append(out, force and entries(force(g, ones, t)) or {})
    return out, zeros, watched_entries(look, g, ones, t, ones)
  end)
end

local function all_forces(system, look)
  if system.place then return on_group(system, look) end
  return (system.given.L and of_lagrangian or of_hamiltonian)(system, look)
end

--- The function and how many of its last entries are watched, or nil and why nothing can be hidden
-- in the forces, or is not looked for. look: { watch = { name = f(q, v, t, p) }, tolerance = } with
-- the tolerance of each column, or nil.
function M.of(system, look)
  local fine, f, watched = blame.try(all_forces, system, look)
  if look and not (fine and f:operations() <= LARGEST) then return M.of(system) end
  if not fine then return nil, "the forces are not traced" end
  if f:operations() > LARGEST then
    return nil, ("the forces are %d operations"):format(f:operations())
  end
  if polynomial.is(f) then return nil end
  return f, watched
end

return M
