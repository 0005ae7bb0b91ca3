--- The functions of dm.step as functions of flat coordinates, which are traced: y becomes a table
-- with q, p, t, and m has the functions of the system.
local bound = require "dm.base.bound"
local core = require "dm.core"
local place = require "dm.group.place"

local M = {}

local function part(x, first, n)
  local out = {}
  for i = 1, n do out[i] = x[first + i] end
  return core.vector(out)
end

---- L and H of the system ----

-- L(q, v, t) as a function of (base, e, v, t): q = base moved by e, so that derivatives in e are
-- those of the space; coordinates of the base, and how many e has
local function moved(system, L)
  local own = system.place
  if not own then
    return function(base, e, v, t) return L(base + e, v, t) end, core.vector, system.Q.dimension
  end
  local side = own.right and "right" or "left"
  local P = place.of(system.Q, { columns = "matrix", trivialization = side })
  local function at(base, e, v, t)
    local list = own.right and P.carry(P.near(e), base) or P.carry(base, P.near(e))
    return L(P.element(list), v, t)
  end
  return at, function(q) return core.vector(P.flat(q)) end, own.dimension
end

-- m: functions are made when they are asked for, since most steps ask for few
local function functions_of(system)
  local L = bound(system.given.L, system.given.params)
  local at, coordinates, d = moved(system, L)
  local slopes, masses, N
  local function slope(q, v, t)
    local base = coordinates(q)
    N = #base
    slopes = slopes or core.derivative(at, N, d, d, "number")
    return slopes(base, core.zeros(d), core.vector(v), t or 0)
  end
  local m = {}
  function m.L(q, v, t) return L(q, core.vector(v), t or 0) end
  function m.L_q(q, v, t) return part(slope(q, v, t), N, d) end
  function m.L_v(q, v, t) return part(slope(q, v, t), N + d, d) end
  -- v with L_v = p, for L quadratic in v
  local function velocity(q, p, t)
    local b = m.L_v(q, core.zeros(d), t)
    masses = masses or core.derivative(function(base, v, s)
      return part(slopes(base, core.zeros(d), v, s), N + d, d)
    end, N, d, "number")
    local J = masses(coordinates(q), core.zeros(d), t or 0)
    local mass = core.zeros(d, d):totable()
    for i = 1, d do
      for k = 1, d do mass[i][k] = J[i][N + k] end
    end
    return core.matrix(mass):solve(core.vector(p) - b)
  end
  function m.H(q, p, t)
    local v = velocity(q, p, t)
    return core.vector(p):dot(v) - m.L(q, v, t)
  end
  function m.H_q(q, p, t) return -m.L_q(q, velocity(q, p, t), t) end
  m.H_p = velocity
  return m
end

---- the state ----

-- what the functions of a step get as y
local function state_of(system, q, p, t)
  local own = system.place
  return { q = own and own.element(q) or q, p = p, t = t }
end

local KNOWN = { q = true, p = true }

-- the numbers of what `next` returned, the coordinates of q near those before
local function flattened(system, before, value)
  if type(value) ~= "table" or value.q == nil or value.p == nil then
    error("'next' must return a table { q =, p = }", 0)
  end
  for key in pairs(value) do
    if not KNOWN[key] then
      error(("'next' returned '%s': a step gives q and p; t grows by h"):format(tostring(key)), 0)
    end
  end
  local own, out = system.place, {}
  local q = own and own.follow(own.flat(own.kit.element(value.q)), before) or core.vector(value.q)
  for i = 1, #q do out[i] = q[i] end
  local p = core.vector(value.p)
  for i = 1, #p do out[#out + 1] = p[i] end
  return out
end

--- The functions of the options of dm.step for a system.
function M.functions(options, system)
  local m, out = functions_of(system), {}
  local function of_root(name)
    local f = options[name]
    return f and function(q, p, t, x, h) return f(state_of(system, q, p, t), x, h, m) end
  end
  local function of_state(name)
    local f = options[name]
    return f and function(q, p, t, h) return f(state_of(system, q, p, t), h, m) end
  end
  out.equation, out.inside = of_root "equation", of_root "inside"
  out.start, out.scale = of_state "start", of_state "scale"
  local after = of_root "next"
  function out.next(q, p, t, x, h) return flattened(system, q, after(q, p, t, x, h)) end
  return out
end

return M
