--- Group actions: dm.action{group =, on =, map =} with its axioms tested, generators, momentum.
-- Prolongations are in dm.action.lift, tests of freeness and invariance in dm.action.test.
local blame = require "dm.base.blame"
local class_methods = require "dm.base.class"
local core = require "dm.core"
local groups = require "dm.group"
local axioms = require "dm.action.axioms"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local options = require "dm.base.options"
local points = require "dm.action.points"
local standard = require "dm.action.standard"

local M = {}


local image, point, show = points.image, points.point, points.show

---- the class ----

local class = core.class({ __name = "dm.action" }, [[
dm.action: an action of a group on a space, made by dm.action{group=, on=, map=, side=, domain=}
fields: group, on, map, side, domain, name, dimension (numbers of a point); of a joint or prolonged
action base, and points (how many); act(g, z) is the moved point.]])

function class.__tostring(a)
  local text = ("%s action of %s on %s"):format(a.side, tostring(a.group), tostring(a.on))
  if a.points then return ("%s on %d points"):format(tostring(a.base), a.points) end
  return a.name and ("action '%s': %s"):format(a.name, text) or text
end

local function is_action(x) return type(x) == "table" and getmetatable(x) == class end
M.is_action = is_action

---- making one ----

local KNOWN = { "group", "on", "map", "side", "domain", "name" }

local function check_options(given)
  options.check(given, KNOWN, "dm.action", "{ group =, on =, map = }")
  for key, such in pairs { group = "dm.SO(2)", on = "dm.R(2)" } do
    options.demand(kits.class_of(given[key]) == "dm.space", given, key, "dm.action",
      "a space, for instance " .. such)
  end
  options.text(given, "name", "dm.action")
  options.one_of(given, "side", "dm.action", { "left", "right" })
  options.callable(given, "domain", "dm.action", "z that is > 0 where the action is defined")
end

-- the standard map and its kind of the group in `given` on a space
local function standard_on(given, space)
  return standard.find(given.group, space, points.coordinates, given.map)
end

-- R^4 may be meant as two points of R^2: says so, where the group acts on such points
local function on_parts(given)
  local n = given.on.dimension
  if not groups.kit(given.on).euclidean then return "" end
  for k = 2, n do
    if n % k == 0 and standard_on(given, core.R(n // k)) then
      return (", or take the action on dm.R(%d) and %d points of it, action:on_points(%d)")
        :format(n // k, k, k)
    end
  end
  return ""
end

-- the standard map, for a right action of the inverse
local function standard_map(given)
  local map, kind = standard_on(given, given.on)
  if not map then
    options.fail("dm.action", "%s has no standard %saction on %s: give map = function(g, z)%s",
      tostring(given.group), given.map and given.map .. " " or "", tostring(given.on),
      on_parts(given))
  end
  if given.side ~= "right" then return map, kind end
  local inverse = groups.group(given.group).inverse
  return function(g, z) return map(inverse(g), z) end, kind
end

-- an action from checked parts; false, as what is missing in a class is noted (core/missing_key.h)
local function assemble(given)
  return setmetatable({ group = given.group, on = given.on, map = given.map,
    side = given.side or "left", domain = given.domain or false, name = given.name,
    dimension = points.coordinates(given.on), angles = groups.kit(given.on).angles,
    points = given.points, count = given.points, base = given.base, kind = given.kind,
    generator_by = given.generator_by or false }, class)
end
M.assemble = assemble

-- map is called once before the axioms, for the error of one that takes g or z for something else
local function try_map(action)
  local kit, name = groups.kit(action.group), tostring(action.group)
  local z = points.sample_point(action.on, core.random(20260), 3)
  local fine, message = blame.try(image, action, kit.identity(), z)
  if fine or type(message) ~= "string" then return end
  error(("%s; map(g, z) gets g in %s, %s, and z, a vector of %d number%s, and returns such a "
    .. "vector"):format(message, name, require "dm.group.starts".form(kit), action.dimension,
      action.dimension == 1 and "" or "s"), 0)
end

local doc_action = [[
dm.action{group=, on=, map=, side=, domain=, name=} -> dm.action
The action map(g, z) of a group on the points z, vectors, of dm.R(n), dm.T(n), dm.S(n) (n + 1
numbers) or a product of these. map: a Lua function that returns the moved point; left out: the
standard one (matrix times vector, rigid motions, translations, SL(2) and SL(n) projectively on
R^(n-1), SO(n+1) stereographically on R^n); or the name of one: "linear", "affine", "projective",
"translation", "stereographic" (SO(2): of the last two coordinates of the sphere). side: "left"
(default: map(g, map(h, z)) = map(g h, z)) or "right". domain(z) > 0 where a local action is
defined. Identity, composition, inverse are tested at random points; what fails is an error with the
axiom, the point and the defect. Also act(g, z).]]

M.action = blame.caller(function(given)
  check_options(given)
  groups.group(given.group)
  local map, kind = given.map, nil
  if map == nil or type(map) == "string" then
    map, kind = standard_map(given)
  else
    options.demand(type(map) == "function" or kits.class_of(map) == "dm.function", given, "map",
      "dm.action", "a function of (g, z)")
  end
  local action = assemble { group = given.group, on = given.on, map = core.one(map, "map"),
    side = given.side, domain = core.one(given.domain, "domain"), name = given.name, kind = kind }
  if given.map == map then try_map(action) end
  axioms.check(action)
  return action
end)
core.docs[M.action] = doc_action

---- methods ----

--- Add a method with its doc.
function M.method(name, f, doc) core.method("dm.action", name, blame.caller(f), doc) end

-- numbers that are not finite are an error
local function must_be_finite(action, value, z)
  if not kits.is_finite(value) then
    error(("%s is not defined at z = %s"):format(tostring(action), show(z)), 0)
  end
  return value
end

--- The moved point, of an element that is known to be one, or holds symbols.
function M.move(action, g, z)
  z = point(action, z)
  return must_be_finite(action, image(action, groups.kit(action.group).element(g), z), z)
end

local function act(action, g, z)
  z = point(action, z)
  return must_be_finite(action, image(action, groups.element(action.group, g), z), z)
end
class.__call = blame.caller(act)
M.method("act", act, [[
action:act(g, z) -> dm.vector
The moved point; the same as action(g, z). Raises where g is no element of the group (to 1e-6),
where the point is not finite.]])

-- dm.function (xi, z) -> d map(exp(xi), z)/d(xi, z) at xi = 0
local function slope(action)
  if not rawget(action, "slope_function") then
    local kit = groups.kit(action.group)
    local function near(xi, z) return image(action, kit.near(xi), z) end
    rawset(action, "slope_function", core.derivative(near, kit.dimension, action.dimension))
  end
  return rawget(action, "slope_function")
end

--- The matrix psi of generators at z, as a table of rows.
function M.generator_rows(action, z)
  local r = action.group.dimension
  if action.generator_by then return action.generator_by(z) end
  local rows = slope(action)(core.zeros(r), z):totable()
  for i = 1, action.dimension do rows[i] = { table.unpack(rows[i], 1, r) } end
  return rows
end

M.method("generator", function(action, z)
  z = point(action, z)
  local rows = M.generator_rows(action, z)
  for _, row in ipairs(rows) do must_be_finite(action, row, z) end
  return core.matrix(rows)
end, [[
action:generator(z) -> dm.matrix, dim z x dim G
Infinitesimal generators at z, a column for each basis vector of the algebra: d/dt map(exp(t e_a),
z) at t = 0, exact from the graph. z may hold symbols.]])

M.method("momentum", function(action, q, p)
  q, p = point(action, q), point(action, p, "the momentum p")
  local rows, out = M.generator_rows(action, q), {}
  for a = 1, action.group.dimension do
    local sum = 0
    for i = 1, action.dimension do sum = sum + rows[i][a] * p[i] end
    out[a] = sum
  end
  return core.vector(out)
end, [[
action:momentum(q, p) -> dm.vector of dim G entries
The momentum map <J(q, p), xi> = <p, xi_Q(q)> of the cotangent lift. Also path:momentum(action),
Ld:momentum(action, q0, q1).]])

-- z cut into points of m entries
local function cut(z, k, m)
  local out = {}
  for i = 0, k - 1 do
    local part = {}
    for j = 1, m do part[j] = z[i * m + j] end
    out[i + 1] = core.vector(part)
  end
  return out
end
M.cut = cut

local MOST_POINTS = 1000

local function on_points(action, k)
  if not lists.whole(k) or k < 1 or k > MOST_POINTS then
    error(("action:on_points(k) takes the number of points, a whole number from 1 to %d (got %s)")
      :format(MOST_POINTS, tostring(k)), 0)
  end
  if action.points then
    error("this action is on several points already: ask its base, action.base:on_points(k)", 0)
  end
  k = lists.whole(k)
  local m, copies = action.dimension, {}
  for i = 1, k do copies[i] = action.on end
  local function joint(g, z)
    local out = {}
    for i, part in ipairs(cut(z, k, m)) do
      local w = image(action, g, part)
      for j = 1, m do out[(i - 1) * m + j] = w[j] end
    end
    return core.vector(out)
  end
  local domain = action.domain and function(z)
    local least = math.huge
    for _, part in ipairs(cut(z, k, m)) do least = math.min(least, action.domain(part)) end
    return least
  end
  return assemble { group = action.group,
    on = k == 1 and action.on or core.product(table.unpack(copies)), map = joint,
    side = action.side, domain = domain or nil, name = action.name, points = k, base = action }
end

M.method("on_points", on_points, [[
action:on_points(k) -> dm.action
The joint (diagonal) action on k points, z = their numbers one after the other, or a list of them;
fields points = k, base = action.]])
M.method("on_pairs", function(action) return on_points(action, 2) end, [[
action:on_pairs() -> dm.action
The joint action on two points, action:on_points(2).]])

-- prolongations and questions come with modules of their own
for name, module in pairs { tangent = "lift", cotangent = "lift", jet = "jet", isotropy = "test",
  free = "test", transitive = "test", invariant = "test" } do
  class_methods.later("dm.action", name, "dm.action." .. module)
end

return M
