--- Ld:average: the mean of a discrete Lagrangian over a compact group, which is invariant.
local actions = require "dm.action"
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local options = require "dm.base.options"
local solved = require "dm.measure.solved"

local abs, max = math.abs, math.max

local WHERE = "Ld:average"
local POINTS, MOST = 8, 20000     -- of a circle; elements in all
local TRIES, WANTED = 60, 6       -- places where invariance is looked at
local INVARIANT = 1e-12           -- of the size of the terms

-- what is given as an action on Q
local function action_of(given, Q)
  if actions.is_action(given) then
    if tostring(given.on) ~= tostring(Q) then
      options.fail(WHERE, "the action is on %s, and the discrete Lagrangian on %s",
        tostring(given.on), tostring(Q))
    end
    return given
  end
  if kits.class_of(given) ~= "dm.space" then
    options.fail(WHERE, "takes a group or an action (got %s)", options.got(given))
  end
  return actions.action { group = given, on = Q }
end

-- elements and weights; nothing where the group has no such rule
local function elements_of(kit, points)
  if kit.mean then return kit.mean(points) end
  if not kit.parts then return nil end
  local out = { { {}, 1 } }
  for _, part in ipairs(kit.parts) do
    local list, longer = elements_of(part, points), {}
    if not list then return nil end
    for _, before in ipairs(out) do
      for _, more in ipairs(list) do
        local g = { table.unpack(before[1]) }
        g[#g + 1] = more[1]
        longer[#longer + 1] = { g, before[2] * more[2] }
      end
    end
    if #longer > MOST then break end
    out = longer
  end
  return out
end

local function check_size(kit, G, points)
  local circles = kit.dimension
  if circles > 0 and points ^ circles > MOST then
    options.fail(WHERE, "%d points on each of the %d angles of %s are %.3g elements: take fewer, "
      .. "or a smaller group", points, circles, tostring(G), points ^ circles)
  end
end

-- of a rule of stages, whose velocities are found inside
local function solved_formula(Ld)
  local fine, coefficients = blame.try(Ld.coefficients, Ld)
  if not fine or not coefficients then
    options.fail(WHERE, "the Ld of '%s' is no formula and has no stages: take a rule of stages, "
      .. "gauss(s), lobatto(s), galerkin(s, quadrature), or a formula of your own", Ld.rule)
  end
  if not Ld.system:structure().autonomous then
    options.fail(WHERE, "L depends on time, and the mean of a rule whose stages are solved for "
      .. "has none: take midpoint or trapezoidal of an L at a given time")
  end
  return solved.formula(coefficients, Ld.system.L, Ld.Q.dimension)
end

-- Ld as a function of (q0, q1, h, params), which numbers and symbols go through
local function formula_of(Ld)
  for _, key in ipairs { "constraint", "force", "rolling", "map" } do
    if Ld[key] ~= nil or Ld.system and Ld.system.given[key] ~= nil then
      options.fail(WHERE, "this discrete Lagrangian has '%s', which a mean of Ld leaves out", key)
    end
  end
  return Ld.Ld or solved_formula(Ld)
end

-- sum of w Ld(g q0, g q1) over the elements
local function mean_of(f, action, elements)
  return function(a, b, h, params)
    local sum = 0
    for _, element in ipairs(elements) do
      local g, w = element[1], element[2]
      sum = sum + w * f(actions.move(action, g, a), actions.move(action, g, b), h, params)
    end
    return sum
  end
end

-- |mean(g q0, g q1) - mean(q0, q1)| at a random place, over the size of the terms; nil where Ld has
-- no value
local function defect_at(f, mean, Ld, action, stream, i)
  local kit, n = groups.kit(action.group), action.dimension
  local a = kits.normals(stream, 2 * i, n, 0.7)
  local b = a + kits.normals(stream, 2 * i + 1, n, 0.3)
  local g = kit.sample(stream, 1000 + i)
  local fine, x, y, size = blame.try(function()
    local function at(F, u, v) return F(u, v, Ld.h, Ld.params) end
    return at(mean, a, b), at(mean, actions.move(action, g, a), actions.move(action, g, b)),
      abs(at(f, a, b)) + abs(at(f, actions.move(action, g, a), actions.move(action, g, b)))
  end)
  if not fine or x - x ~= 0 or y - y ~= 0 then return nil end
  return abs(x - y) / max(abs(x), abs(y), size, 1e-300)
end

local function check_invariant(f, mean, Ld, action, points)
  local stream, seen, worst = core.random(29), 0, 0
  for i = 1, TRIES do
    local defect = defect_at(f, mean, Ld, action, stream, i)
    if defect then seen, worst = seen + 1, max(worst, defect) end
    if seen == WANTED then break end
  end
  if seen == 0 then
    options.fail(WHERE, "Ld has no value at random places of %s: whether its mean is invariant "
      .. "cannot be seen", tostring(Ld.Q))
  end
  if worst > INVARIANT then
    options.fail(WHERE, "with points = %d the mean still changes under %s, by %.2g of its terms: "
      .. "take more points", points, tostring(action.group), worst)
  end
end

class.method("dm.discrete_lagrangian", "average", function(Ld, given, more)
  more = options.check(more or {}, { "points" }, WHERE, "{ points = }")
  local f, action = formula_of(Ld), action_of(given, Ld.Q)
  local points = options.whole(more, "points", WHERE, 1, 1000, POINTS)
  local kit = groups.kit(action.group)
  if kit.mean or kit.parts then check_size(kit, action.group, points) end
  local elements = elements_of(kit, points)
  if not elements then
    options.fail(WHERE, "%s is not compact, or has no rule of means here: averages are over SO(2), "
      .. "T^n, SO(3) and products of these", tostring(action.group))
  end
  local mean = mean_of(f, action, elements)
  check_invariant(f, mean, Ld, action, points)
  return core.discrete_lagrangian { Q = Ld.Q, h = Ld.h, Ld = mean, params = Ld.params,
    name = Ld.name, coordinates = Ld.coordinates, units = Ld.units }
end, [[
Ld:average(group | action [, {points=}]) -> dm.discrete_lagrangian
The mean of Ld(g q0, g q1) over a compact group, by its standard action on Q or the given one: it
is invariant, so that its steps keep the momentum map (Leok, remark 5.2). points: of every angle
(8), by the trapezoidal rule on SO(2) and T^n, by Euler's angles on SO(3) with Gauss nodes of the
cosine, by factors on products. Invariance is looked at to 1e-12: raises where more points are
needed, and for a group that is not compact. Of a rule of stages, gauss(2), these are solved for
inside of the mean, at every element.]])

return {}
