--- The mechanical connection of an invariant system on S x G (Leok 4.6.4): of the rule lie(s), with
-- the action S(q0, e, V) of a step from q0 near(e) with the velocities V
-- (group/discrete/action.lua), from (x0, e) to the fibre of x1 with the body momentum 0 along the
-- group,
--   S_(V_j) = h beta_j S1,  h sum_j beta_j V_j = xi, its shape part that of x1,
--   p0 = dtau^-1(xi)^T S1 - S_e = 0 along G,   A(x0, x1) = tau(xi)^-1.
-- Coordinates of S are those of the other factors of Q, one after the other.
local actions = require "dm.group.discrete.action"
local bundles = require "dm.connection.bundle"
local connections = require "dm.connection"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local options = require "dm.base.options"
local source = require "dm.reduce.lagrange_poincare.source"
local space = require "dm.reduce.lagrange_poincare.space"

local M = {}

local WHERE = "system:mechanical_connection"

-- tau^-1 of x1 - x0, factor by factor: on R^n itself
local function shape_step(S, tau, x0, x1)
  local out, first = {}, 0
  for _, part in ipairs(S.rest) do
    local kit, d = kits.of(part), part.dimension
    local dx = lists.part(x1, first, d) - lists.part(x0, first, d)
    local step = tau == "exp" and dx or actions.map(kit, tau)(kit.unflat(lists.entries(dx)))
    for j = 1, d do out[#out + 1] = step[j] end
    first = first + d
  end
  return out
end

---- the connection ----

local FAILURE = "is the locked inertia singular there, or are the shapes too far apart for one "
  .. "step? take nearer ones"

local function places(x, list)
  local out = {}
  for k, i in ipairs(list) do out[k] = x[i] end
  return out
end

-- what a step of length h of the rule of Ld solves, as a function of y = (V, S1): equations and xi
local function equations_of(Ld, S)
  local way = actions.action(Ld)
  local s, c, P = way.stages, way.coefficients, Ld.place
  local D = P.dimension
  local slope = core.derivative(way.value, P.size, D, s * D, "number")
  local function step_of(y, h)
    local xi = core.zeros(D)
    for j = 1, s do xi = xi + lists.part(y, (j - 1) * D, D) * (h * c.beta[j]) end
    return xi
  end
  local function equations(y, x0, x1, h)
    local q0 = core.vector(P.flat(space.element(S, x0, S.kit.identity())))
    local V, S1, xi = lists.part(y, 0, s * D), lists.part(y, s * D, D), step_of(y, h)
    local G = slope(q0, core.zeros(D), V, h)
    local back = linear.matrix_of(function(e) return way.inverse(xi, e) end, D):transpose()
    local p0, out = back * S1 - lists.part(G, P.size, D), {}
    for j = 1, s do
      out[j] = lists.part(G, P.size + j * D, D) - S1 * (h * c.beta[j])
    end
    local gap = core.vector(places(xi, S.shape))
      - core.vector(shape_step(S, way.tau, x0, x1))
    return lists.joined(lists.joined(table.unpack(out)), gap, places(p0, S.body))
  end
  return equations, step_of, way, D
end

-- the local form as a function of (x0, x1, h), h the length of the step
local function form_of(Ld, S)
  local equations, step_of, way, D = equations_of(Ld, S)
  local s, kit = way.stages, S.kit
  local _, _, map = actions.map(kit, way.tau)
  local root = core.root { name = "the discrete mechanical connection", unknowns = (s + 1) * D,
    failure = FAILURE,
    start = function(x0, x1, h)
      local V, step = core.zeros(D), shape_step(S, way.tau, x0, x1)
      for k, i in ipairs(S.shape) do V[i] = step[k] / h end
      local all = {}
      for j = 1, s do all[j] = V end
      all[s + 1] = core.zeros(D)
      return lists.joined(table.unpack(all))
    end,
    equations = function(y, x0, x1, h) return equations(core.vector(y), x0, x1, h) end }
  local function form(x0, x1, h)
    local xi = core.vector(places(step_of(root(x0, x1, h), h), S.body))
    return kit.inverse(map(xi))
  end
  return form, s
end

local BETTER, MOST = 3, 8  -- stages of the reference above those of the rule; so many are enough

local function made(system, given, S, B)
  local Ld = core.discrete_lagrangian(system, { rule = given.rule, h = given.h })
  local form, s = form_of(Ld, S)
  local function with_step(h)
    return function(x0, x1) return form(x0, x1, h) end
  end
  local facts = { group = given.group, base = B.base, given = "system", by = given.rule }
  local A = connections.new(facts, B, with_step(given.h))
  A.own.with_step = with_step
  -- of an order that is higher by 6, so that its error is no part of what is measured; with more
  -- stages its equations, which are written out, take 150 MB
  function A.own.reference()
    local rule = ("lie(%d)"):format(math.min(s + BETTER, math.max(s + 1, MOST)))
    return made(system, { group = given.group, rule = rule, h = given.h }, S, B)
  end
  return A
end

-- the base by its coordinates: SO(2) is a circle, T(1)
local function base_of(S)
  local out, turns = {}, kits.of(core.SO(2))
  for k, part in ipairs(S.rest) do out[k] = kits.of(part) == turns and core.T(1) or part end
  return #out > 1 and core.product(table.unpack(out)) or out[1]
end

--- Of a system on a product with the group as factor k.
function M.of_factor(system, given, k)
  local S = space.of(system.Q, given.group, k, WHERE)
  if not system:structure().autonomous then
    options.fail(WHERE, "L must not depend on the time")
  end
  local B = bundles.of(given.group, base_of(S), WHERE)
  source.check_invariance(S, system, WHERE)
  return made(system, given, S, B)
end

return M
