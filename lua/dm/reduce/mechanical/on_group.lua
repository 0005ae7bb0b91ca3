--- The mechanical connection of an invariant system on S x G (Leok 4.6.4): of the rule lie(s), with
-- the action S(q0, e, V) of a step from q0 near(e) with the velocities V (group/discrete.lua), from
-- (x0, e) to the fibre of x1 with the body momentum 0 along the group,
--   S_(V_j) = h beta_j S1,  h sum_j beta_j V_j = xi, its shape part that of x1,
--   p0 = dtau^-1(xi)^T S1 - S_e = 0 along G,   A(x0, x1) = tau(xi)^-1.
-- Coordinates of S are those of the other factors of Q, one after the other.
local bundles = require "dm.connection.bundle"
local connections = require "dm.connection"
local core = require "dm.core"
local discrete = require "dm.group.discrete"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local options = require "dm.base.options"

local M = {}

local WHERE = "system:mechanical_connection"

---- the product ----

-- where the factors of Q have their entries of the algebra: lists of places, of the shape and of
-- the group, and the base
local function layout_of(Q, k)
  local out, first, rest = { factor = k, shape = {}, group = {} }, 0, {}
  for i, part in ipairs(Q.parts) do
    local places = i == k and out.group or out.shape
    for j = 1, part.dimension do places[#places + 1] = first + j end
    if i ~= k then rest[#rest + 1] = part end
    first = first + part.dimension
  end
  out.base = #rest == 1 and rest[1] or core.product(table.unpack(rest))
  out.rest = rest
  return out
end

-- the element of Q with the shape x and g
local function element_of(Q, layout, x, g)
  local out, first = {}, 0
  for i, part in ipairs(Q.parts) do
    if i == layout.factor then
      out[i] = g
    else
      out[i] = kits.of(part).unflat(lists.entries(lists.part(x, first, part.dimension)))
      first = first + part.dimension
    end
  end
  return out
end

-- tau^-1 of x1 - x0, factor by factor: on R^n itself
local function shape_step(layout, tau, x0, x1)
  local out, first = {}, 0
  for _, part in ipairs(layout.rest) do
    local kit, d = kits.of(part), part.dimension
    local dx = lists.part(x1, first, d) - lists.part(x0, first, d)
    local step = tau == "exp" and dx or kit.cayleyinv(kit.unflat(lists.entries(dx)))
    for j = 1, d do out[#out + 1] = step[j] end
    first = first + d
  end
  return out
end

---- invariance ----

local TRIES, ENOUGH = 60, 8

-- L(h g, xi) = L(g, xi), at random points where it is finite
local function check_invariance(system, layout, B)
  local stream, kit, Q = core.random(4640), B.kit, system.Q
  local L = require "dm.base.bound"(system.given.L, system.given.params)
  local whole, tested = kits.of(Q).dimension, 0
  for i = 1, TRIES do
    local x, xi = kits.normals(stream, 4 * i, B.n, 0.5), kits.normals(stream, 4 * i + 1, whole, 1)
    local g = kit.exp(kits.normals(stream, 4 * i + 2, B.d, 0.5))
    local h = kit.exp(kits.normals(stream, 4 * i + 3, B.d, 0.7))
    local fine, a, b = pcall(function()
      return L(element_of(Q, layout, x, g), xi, 0),
        L(element_of(Q, layout, x, kit.compose(h, g)), xi, 0)
    end)
    if fine and math.abs(a) < math.huge and math.abs(b) < math.huge then
      tested = tested + 1
      if math.abs(a - b) > 1e-9 * (1 + math.abs(a)) then
        options.fail(WHERE, "L is not invariant under %s: it goes from %.9g to %.9g at x = %s, g = "
          .. "%s when h = %s moves it", tostring(B.group), a, b, bundles.show(x), bundles.show(g),
          bundles.show(h))
      end
    end
    if tested == ENOUGH then return end
  end
end

---- the connection ----

local FAILURE = "is the locked inertia singular there, or are the shapes too far apart for one "
  .. "step? take nearer ones"

local function places(x, list)
  local out = {}
  for k, i in ipairs(list) do out[k] = x[i] end
  return out
end

local function joined(...)
  local out = {}
  for _, list in ipairs { ... } do
    for i = 1, #list do out[#out + 1] = list[i] end
  end
  return core.vector(out)
end

-- what a step of Ld solves, as a function of y = (V, S1): equations and xi
local function equations_of(Ld, layout, B)
  local way = discrete.action(Ld)
  local h, s, c, P, Q = Ld.h, way.stages, way.coefficients, Ld.place, Ld.Q
  local D = P.dimension
  local slope = core.derivative(way.value, P.size, D, s * D)
  local function step_of(y)
    local xi = core.zeros(D)
    for j = 1, s do xi = xi + lists.part(y, (j - 1) * D, D) * (h * c.beta[j]) end
    return xi
  end
  local function equations(y, x0, x1)
    local q0 = core.vector(P.flat(element_of(Q, layout, x0, B.kit.identity())))
    local V, S1, xi = lists.part(y, 0, s * D), lists.part(y, s * D, D), step_of(y)
    local G = slope(q0, core.zeros(D), V)
    local back = linear.matrix_of(function(e) return way.inverse(xi, e) end, D):transpose()
    local p0, out = back * S1 - lists.part(G, P.size, D), {}
    for j = 1, s do
      out[j] = lists.part(G, P.size + j * D, D) - S1 * (h * c.beta[j])
    end
    local gap = core.vector(places(xi, layout.shape))
      - core.vector(shape_step(layout, way.tau, x0, x1))
    return joined(joined(table.unpack(out)), gap, places(p0, layout.group))
  end
  return equations, step_of, way, D
end

local function local_form_of(Ld, layout, B)
  local equations, step_of, way, D = equations_of(Ld, layout, B)
  local s, kit = way.stages, B.kit
  local root = core.root { name = "the discrete mechanical connection", unknowns = (s + 1) * D,
    failure = FAILURE,
    start = function(x0, x1)
      local V, step = core.zeros(D), shape_step(layout, way.tau, x0, x1)
      for k, i in ipairs(layout.shape) do V[i] = step[k] / Ld.h end
      local all = {}
      for j = 1, s do all[j] = V end
      all[s + 1] = core.zeros(D)
      return joined(table.unpack(all))
    end,
    equations = function(y, x0, x1) return equations(core.vector(y), x0, x1) end }
  return function(x0, x1)
    local xi = core.vector(places(step_of(root(x0, x1)), layout.group))
    return kit.inverse(kit[way.tau](xi))
  end
end

local function made(system, given, layout, B)
  local function with(rule, h)
    local Ld = core.discrete_lagrangian(system, { rule = rule, h = h })
    return local_form_of(Ld, layout, B)
  end
  local facts = { group = given.group, base = layout.base, given = "system", by = given.rule }
  local A = connections.new(facts, B, with(given.rule, given.h))
  function A.own.with_step(h) return with(given.rule, h) end
  function A.own.reference()
    return made(system, { group = given.group, rule = "lie(8)", h = given.h }, layout, B)
  end
  return A
end

--- Of a system on a product with the group as factor k.
function M.of_factor(system, given, k)
  local layout = layout_of(system.Q, k)
  if not system:structure().autonomous then
    options.fail(WHERE, "L must not depend on the time")
  end
  local B = bundles.of(given.group, layout.base, WHERE)
  check_invariance(system, layout, B)
  return made(system, given, layout, B)
end

return M
