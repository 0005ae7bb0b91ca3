--- The tangent map of a rule as a rule: the system of x = (q, u) with the Lagrangian
--   L~(q, u, v, w) = L_q . u + L_v . w
-- has the equations of L (from the variation of u) and their linearization (of q). A rule that does
-- not care for linear changes of coordinates (stages, splittings, compositions) takes one step of
-- L~ as the exact derivative of its step of L. Momenta: of q the varied momentum dp, of u the
-- momentum p. Of an H(q, p, t) without a Lagrangian it is H~(q, u; dp, p) = H_q . u + H_p . dp.
local bound = require "dm.base.bound"
local lists = require "dm.base.lists"
local saddle = require "dm.measure.saddle"

local M = {}

local part, joined, entries = lists.part, lists.joined, lists.entries

-- f and its change along (u, w [, changes of the numbers]), as two lists: of a function of (q, v, t
-- [, `more` numbers]), or, holonomic, of (q, t)
local function with_change(f, n, holonomic, more)
  local core = require "dm.core"
  local function all(q, v, t, ...)
    if holonomic then return core.vector(entries(f(q, t))) end
    return core.vector(entries(f(q, v, t, ...)))
  end
  local lengths = { n, n, "number", more }
  local value = core.trace(all, table.unpack(lengths))
  local slope = core.derivative(all, table.unpack(lengths))
  return function(x, y, t, given)
    local q, u, v, w = part(x, 0, n), part(x, n, n), part(y, 0, n), part(y, n, n)
    local state, change = { q, v, t, more and part(given, 0, more) }, {}
    local f0, J = value(table.unpack(state)), slope(table.unpack(state))
    for i = 1, #f0 do
      local sum = 0
      for k = 1, n do sum = sum + J[i][k] * u[k] + J[i][n + k] * w[k] end
      for k = 1, more or 0 do sum = sum + J[i][2 * n + 1 + k] * given[more + k] end
      change[i] = sum
    end
    return f0, change
  end
end

-- L~ of a Lagrangian
local function lift_lagrangian(L, n)
  local slope = require "dm.core".derivative(function(q, v, t) return L(q, v, t) end, n, n,
    "number")
  return function(x, y, t)
    local g, sum = slope(part(x, 0, n), part(y, 0, n), t), 0
    for k = 1, n do sum = sum + g[k] * x[n + k] + g[n + k] * y[n + k] end
    return sum
  end
end

-- a copy of params with the numbers of these names from list[first + 1] on
local function with_numbers(params, names, list, first)
  local out = {}
  for key, value in pairs(params) do out[key] = value end
  for i, name in ipairs(names) do out[name] = list[first + i] end
  return out
end

-- the same with parameters of these names left open: to the derivative they are coordinates more
local function lift_open(L, n, params, names)
  local function all(q, v, t) return L(part(q, 0, n), v, t, with_numbers(params, names, q, n)) end
  local slope, many = require "dm.core".derivative(all, n + #names, n, "number"), #names
  return function(x, y, t, P)
    local values = {}
    for i, name in ipairs(names) do values[i] = P[name] end
    local g, sum = slope(joined(part(x, 0, n), values), part(y, 0, n), t), 0
    for k = 1, n do sum = sum + g[k] * x[n + k] + g[n + many + k] * y[n + k] end
    return sum
  end
end

-- reactions along (E, 0) for the change of phi, and along (dE, E) for phi itself
local function lift_reaction(E, n)
  local lifted = with_change(E, n)
  return function(x, y, t)
    local rows, change = lifted(x, y, t)
    local of_change, of_phi = {}, {}
    for r = 0, #rows // n - 1 do
      local first, second = {}, {}
      for k = 1, n do
        first[k], first[n + k] = rows[r * n + k], 0
        second[k], second[n + k] = change[r * n + k], rows[r * n + k]
      end
      of_change[#of_change + 1], of_phi[#of_phi + 1] = first, second
    end
    for _, row in ipairs(of_phi) do of_change[#of_change + 1] = row end
    return of_change
  end
end

-- rows of E one after the other: given, or dphi/dv
local function reaction_rows(given, phi, n)
  local core = require "dm.core"
  if given then
    return function(q, v, t)
      local out = {}
      for _, row in ipairs(given(q, v, t)) do
        for k = 1, n do out[#out + 1] = row[k] end
      end
      return out
    end
  end
  local function value(q, v, t) return core.vector(entries(phi(q, v, t))) end
  local slope = core.derivative(value, n, n, "number")
  return function(q, v, t)
    local J, out = slope(q, v, t), {}
    for i = 1, #entries(phi(q, v, t)) do
      for k = 1, n do out[#out + 1] = J[i][n + k] end
    end
    return out
  end
end

-- H~ of a Hamiltonian, of (q, u) and their momenta (dp, p)
local function lift_hamiltonian(H, n)
  local slope = require "dm.core".derivative(function(q, p, t) return H(q, p, t) end, n, n,
    "number")
  return function(x, y, t)
    local g, sum = slope(part(x, 0, n), part(y, n, n), t), 0
    for k = 1, n do sum = sum + g[k] * x[n + k] + g[n + k] * y[k] end
    return sum
  end
end

-- a force, and a control that is held over a step, with its change
local function add_forces(out, f, control, n)
  local lifted, held = nil, control and with_change(control, n)
  out.control = held and function(x, y, t) return joined(held(x, y, t)) end
  out.force = f and function(x, y, t, u)
    lifted = lifted or with_change(f, n, false, control and #u // 2)
    local value, change = lifted(x, y, t, u)
    return joined(change, value)
  end
end

--- The prolonged system of a dm.system, on R^(2n). names: parameters that it has, too, where L
-- alone makes the system; all others are the numbers that they are.
function M.system(system, names)
  local core = require "dm.core"
  if system.place then error("prolonged systems are those of free coordinates", 0) end
  local given, n = system.given, system.Q.dimension
  local params = given.params
  if not given.L then
    return core.prolonged { Q = core.R(2 * n), H = lift_hamiltonian(bound(given.H, params), n) }
  end
  if names then
    return core.prolonged { Q = core.R(2 * n), params = params,
      L = lift_open(given.L, n, params, names) }
  end
  local g, phi = bound(given.constraint, params), bound(given.rolling, params)
  local L = saddle.lagrangian(system, bound(given.L, params), g, phi)
  local out = { Q = core.R(2 * n), L = lift_lagrangian(L, n), crossings = given.crossings }
  if g then
    local lifted = with_change(g, n, true)
    out.constraint = function(x, t) return joined(lifted(x, x, t)) end
  end
  if phi then
    local lifted = with_change(phi, n)
    out.rolling = function(x, y, t)
      local value, change = lifted(x, y, t)
      return joined(change, value)
    end
    local rows = reaction_rows(given.reaction and bound(given.reaction, params), phi, n)
    out.reaction = lift_reaction(rows, n)
  end
  add_forces(out, bound(given.force, params), bound(given.control, params), n)
  return core.prolonged(out)
end

--- The rule whose step of the prolonged system is the derivative of a step by `rule`: where the
-- mass is singular by itself RATTLE is the Lobatto pair of two stages, and L~ does not tell.
function M.rule(system, rule)
  if type(rule) ~= "string" or not system:structure().saddle then return rule end
  return (rule:gsub("%f[%w]rattle%f[%W]", "lobatto(2)"))
end

return M
