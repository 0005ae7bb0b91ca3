-- a symmetry that holds in a part of the space only is none: what is not invariant beyond some
-- angle or radius is refused by whatever is reduced; what is invariant is taken
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local max, cos, sin = dm.max, dm.cos, dm.sin

local function free(q, v) return (v[1] ^ 2 + (1 + q[1] ^ 2) * v[2] ^ 2) / 2 - q[1] ^ 2 end
local names = { "r", "theta" }
local function reduced(L, more)
  local o = { Q = dm.R(2), coordinates = names, L = L }
  for key, value in pairs(more or {}) do o[key] = value end
  return dm.system(o):routh { cyclic = "theta", mu = 1 }
end
local function formula(L, force)
  return dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, force = force, Ld = function(a, b, h)
    return h * L((a + b) / 2, (b - a) / h) end }
end
for _, wall in ipairs { 2, 5, 9, 20, -1, -3, -8, -20 } do
  local function beyond(q)
    return (wall > 0 and max(0, q[2] - wall) or max(0, wall - q[2])) ^ 3
  end
  local function L(q, v) return free(q, v) - beyond(q) end
  raises("L is not invariant", reduced, L)
  raises("the force is not invariant", reduced, free,
    { force = function(q) return { -beyond(q), 0 } end })
  local tied = dm.system { Q = dm.R(3), coordinates = { "r", "theta", "z" },
    L = function(q, v) return free(q, v) + v[3] ^ 2 / 2 end,
    constraint = function(q) return q[3] - q[1] - beyond(q) end }
  raises("the constraint is not invariant", tied.routh, tied, { cyclic = "theta", mu = 1 })
  local shape = reduced(free)
  raises("this Ld is not invariant", shape.discrete, shape, formula(L))
  raises("is not invariant", shape.discrete, shape,
    formula(free, function(a, _, h) return { { -h * beyond(a), 0 }, { 0, 0 } } end))
end

-- radii farther out than the start, under an action
local function turn(t, q) return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2] } end
local function walled(wall)
  return dm.system { Q = dm.R(2), L = function(q, v)
    return v:dot(v) / 2 - q:dot(q) / 2 - max(0, q[1] - wall) ^ 3 end }
end
local options = { action = turn, section = function(x) return { x[1], 0 } end, q = { 1, 0 },
  v = { 0, 1 } }
for _, wall in ipairs { 0.5, 1.5, 2.4, 4 } do
  raises("not invariant under the action", walled(wall).routh, walled(wall), options)
end

-- an Ld of a system that differs from it beyond r = 1 only
local shape = reduced(free)
raises("is of another system", shape.discrete, shape,
  formula(function(q, v) return free(q, v) - 5 * max(0, q[1] - 1) ^ 2 end))

-- right ones, with the same walls in the shape
local function walls(q) return max(0, q[1] - 1) ^ 3 + max(0, -2 - q[1]) ^ 3 end
local function L(q, v) return free(q, v) - walls(q) end
local fine, why = pcall(function()
  local whole = reduced(L, { force = function(q, v) return { -walls(q) - v[1] * q[1] ^ 2, 0 } end })
  ok(whole, "a force of shapes")
  ok(reduced(L):discrete(formula(L)), "an Ld with walls in the shape")
end)
ok(fine, "what is invariant is taken", why)
tap.done()
