--- Group actions: dm.action{group =, on =, map =} with its axioms tested, generators, momentum. Prolongations are in
-- dm.action_lift, tests of freeness and invariance in dm.action_test.
local blame = require "dm.blame"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"

local M = {}

local abs, max = math.abs, math.max

---- the class ----

local class = { __name = "dm.action", methods = {} }
debug.getregistry()["dm.action"] = class
core.docs["dm.action"] = [[
dm.action: an action of a group on a space, made by dm.action{group=, on=, map=, side=, domain=, name=}
fields: group, on, map, side, domain, name, dimension (numbers of a point), points and base (of a joint action); act(g, z) is
the moved point.]]

function class.__index(action, key) return class.methods[key] or rawget(action, key) end

function class.__tostring(a)
  local text = ("%s action of %s on %s"):format(a.side, tostring(a.group), tostring(a.on))
  if a.points then text = ("%s on %d points"):format(tostring(a.base), a.points) end
  return a.name and ("action '%s': %s"):format(a.name, text) or text
end

local function is_action(x) return type(x) == "table" and getmetatable(x) == class end
M.is_action = is_action

---- spaces that are acted on: points are vectors ----

local VECTORS = { R = true, T = true, S = true, Heisenberg = true }

--- Numbers of a point of the space.
function M.coordinates(space)
  local kit = groups.kit(space)
  if space.name == "product" then
    local sum = 0
    for _, part in ipairs(space.parts) do sum = sum + M.coordinates(part) end
    return sum
  end
  if VECTORS[space.name] or (space.n == 2 and (space.name == "SE" or space.name == "SO")) then return kit.coordinates end
  error(("dm.action: the points of %s are no vectors: let the group act on the entries, in dm.R(%d)")
    :format(tostring(space), #kit.entries(kit.identity())), 0)
end

-- which coordinates are angles
local function angles(space, out, first)
  if space.name == "product" then
    for _, part in ipairs(space.parts) do
      angles(part, out, first)
      first = first + M.coordinates(part)
    end
  elseif space.name == "T" then
    for i = 1, space.n do out[first + i] = true end
  elseif space.name == "SO" or space.name == "SE" then
    out[first + M.coordinates(space)] = true
  end
  return out
end

--- A random point of the space as a vector.
local function sample_point(space, stream, i)
  return core.vector(groups.kit(space).flat(groups.kit(space).sample(stream, i)))
end

---- the map ----

-- map(g, z) as a vector, unchecked arguments
local function image(action, g, z) return kits.vector(action.map(g, z), action.dimension, "what map(g, z) returns") end

local function is_inside(action, z)
  if not action.domain then return true end
  local value = action.domain(z)
  if type(value) ~= "number" then error(("domain(z) must return a number, > 0 inside (got %s)"):format(kits.class_of(value)), 0) end
  return value > 0
end

--- Largest difference of two points; angles by the circle.
function M.apart(action, a, b)
  local worst = 0
  for i = 1, #a do
    local d = abs(a[i] - b[i])
    if action.angles[i] then d = 2 * abs(math.sin(0.5 * (a[i] - b[i]))) end
    if not (d <= worst) then worst = d end
  end
  return worst
end

local function size_of(z)
  local most = 0
  for i = 1, #z do
    if not (abs(z[i]) <= most) then most = abs(z[i]) end
  end
  return most
end

-- the moved point, or nothing where it is not finite, huge or outside of the domain
local FAR = 1e4
local function moved(action, g, z)
  local w = image(action, g, z)
  local size = size_of(w)
  if size < FAR and is_inside(action, w) then return w end
end

---- the axioms ----

local POINTS, TRIES, TOLERANCE = 12, 240, 1e-9
local SIZES = { 0.05, 0.3, 1 }

local function show(x)
  if type(x) == "table" then
    local out = {}
    for i, part in ipairs(x) do out[i] = show(part) end
    return "{" .. table.concat(out, ", ") .. "}"
  end
  return (tostring(x):gsub("%s*\n%s*", " "))
end
M.show = show

local function broken(action, axiom, what, defect)
  error(("dm.action%s: it is no %s action of %s: the axiom of %s fails: %s (they differ by %.3g)"):format(
    action.name and " '" .. action.name .. "'" or "", action.side, tostring(action.group), axiom, what, defect), 0)
end

-- 1 where all is fine; nothing where the point cannot be tested
local function check_identity(action, kit, z)
  local neutral = kit.identity()
  local w = moved(action, neutral, z)
  if not w then return nil end
  local defect, scale = M.apart(action, w, z), 1 + size_of(z)
  if not (defect <= TOLERANCE * scale) then
    broken(action, "identity", ("map(e, z) is not z at z = %s, e = %s"):format(show(z), show(neutral)), defect)
  end
  for _, turn in ipairs(kit.turns()) do
    w = moved(action, turn, z)
    defect = w and M.apart(action, w, z) or 0
    if not (defect <= TOLERANCE * scale) then
      broken(action, "identity", ("a full turn, g = %s, moves z = %s"):format(show(turn), show(z)), defect)
    end
  end
  return 1
end

local function product_of(action, kit, g, h)
  if action.side == "left" then return kit.compose(g, h) end
  return kit.compose(h, g)
end

local function check_composition(action, kit, z, g, h)
  local w = moved(action, h, z)
  local twice, once = w and moved(action, g, w), moved(action, product_of(action, kit, g, h), z)
  if not twice or not once then return nil end
  local defect, scale = M.apart(action, twice, once), 1 + max(size_of(w), size_of(once)) ^ 2
  if not (defect <= TOLERANCE * scale) then
    local other = moved(action, action.side == "left" and kit.compose(h, g) or kit.compose(g, h), z)
    local hint = ""
    if other and M.apart(action, twice, other) <= TOLERANCE * scale then
      hint = (" (with side = \"%s\" it holds there)"):format(action.side == "left" and "right" or "left")
    end
    broken(action, "composition", ("map(g, map(h, z)) is not map(%s, z) at z = %s, g = %s, h = %s%s"):format(
      action.side == "left" and "g h" or "h g", show(z), show(g), show(h), hint), defect)
  end
  return 1
end

local function check_inverse(action, kit, z, g)
  local w = moved(action, g, z)
  local back = w and moved(action, kit.inverse(g), w)
  if not back then return nil end
  local defect = M.apart(action, back, z)
  if not (defect <= TOLERANCE * (1 + max(size_of(w), size_of(z)) ^ 2)) then
    broken(action, "inverse", ("map(g^-1, map(g, z)) is not z at z = %s, g = %s"):format(show(z), show(g)), defect)
  end
  return 1
end

-- on a sphere and the like: does the image lie there?
local function check_place(action, z, g)
  local kit, w = groups.kit(action.on), moved(action, g, z)
  if not w or not kit.bonds then return end
  for _, x in ipairs(kit.bonds(kits.list_of(w))) do
    if not (abs(x) <= TOLERANCE) then
      broken(action, "closure", ("map(g, z) is not in %s at z = %s, g = %s"):format(tostring(action.on), show(z), show(g)), abs(x))
    end
  end
end

--- Element i of the group, of one of three sizes.
function M.element(kit, stream, i)
  return kit.exp(kits.normals(stream, i, kit.dimension, SIZES[i % #SIZES + 1]))
end

local function check_axioms(action)
  local kit, stream, tested = groups.kit(action.group), core.random(20260), 0
  for i = 1, TRIES do
    local z = sample_point(action.on, stream, 3 * i)
    if is_inside(action, z) then
      local g, h = M.element(kit, stream, 3 * i + 1), M.element(kit, stream, 3 * i + 5)
      local first, second = check_identity(action, kit, z), check_composition(action, kit, z, g, h)
      local third = check_inverse(action, kit, z, g)
      check_place(action, z, g)
      if first and second and third then tested = tested + 1 end
      if tested == POINTS then return end
    end
  end
  if tested == 0 then
    error(("dm.action: map(g, z) is finite (and inside of the domain) together with its compositions at none of %d random points, "
      .. "so that the axioms cannot be tested: is it an action on %s?"):format(TRIES, tostring(action.on)), 0)
  end
end

---- making one ----

local KNOWN = { group = true, on = true, map = true, side = true, domain = true, name = true }

local function check_options(options)
  if type(options) ~= "table" then error("dm.action takes a table { group =, on =, map = }", 0) end
  for key in pairs(options) do
    if not KNOWN[key] then
      error(("dm.action: unknown field '%s'; known fields: domain, group, map, name, on, side"):format(tostring(key)), 0)
    end
  end
  for _, key in ipairs { "group", "on" } do
    if kits.class_of(options[key]) ~= "dm.space" then
      error(("dm.action: field '%s' must be a space, for instance %s (got %s)"):format(key,
        key == "group" and "dm.SO(2)" or "dm.R(2)", kits.class_of(options[key])), 0)
    end
  end
  if options.side ~= nil and options.side ~= "left" and options.side ~= "right" then
    error("dm.action: field 'side' must be \"left\" (the default) or \"right\"", 0)
  end
  if options.domain ~= nil and type(options.domain) ~= "function" then
    error("dm.action: field 'domain' must be a function of z that is > 0 where the action is defined", 0)
  end
end

-- the standard map, for a right action of the inverse
local function standard_map(options)
  local map, kind = require "dm.group.standard".find(options.group, options.on, M.coordinates, options.map)
  if not map then
    error(("dm.action: %s has no standard %saction on %s: give map = function(g, z)"):format(tostring(options.group),
      options.map and options.map .. " " or "", tostring(options.on)), 0)
  end
  if options.side ~= "right" then return map, kind end
  local inverse = groups.group(options.group).inverse
  return function(g, z) return map(inverse(g), z) end, kind
end

-- an action from checked parts
local function assemble(given)
  local action = { group = given.group, on = given.on, map = given.map, side = given.side or "left", domain = given.domain,
    name = given.name, dimension = M.coordinates(given.on), points = given.points, base = given.base, kind = given.kind,
    generator_by = given.generator_by }
  action.angles = angles(given.on, {}, 0)
  return setmetatable(action, class)
end
M.assemble = assemble

local doc_action = [[
dm.action{group=, on=, map=, side=, domain=, name=} -> dm.action
The action map(g, z) of a group on the points z, vectors, of dm.R(n), dm.T(n), dm.S(n) (n + 1 numbers) or a product of these.
map: a Lua function that returns the moved point; left out: the standard one (matrix times vector, rigid motions, translations,
SL(2) and SL(n) projectively on R^(n-1), SO(n+1) stereographically on R^n); or the name of one: "linear", "affine",
"projective", "translation", "stereographic" (SO(2): of the last two coordinates of the sphere). side: "left" (default:
map(g, map(h, z)) = map(g h, z)) or "right". domain(z) > 0 where a local action is defined. Identity, composition, inverse are
tested at random points; what fails is an error with the axiom, the point and the defect. Also act(g, z).]]

M.action = blame.caller(function(options)
  check_options(options)
  groups.group(options.group)
  local map, kind = options.map, nil
  if map == nil or type(map) == "string" then
    map, kind = standard_map(options)
  elseif type(map) ~= "function" and kits.class_of(map) ~= "dm.function" then
    error(("dm.action: field 'map' must be a function of (g, z) (got %s)"):format(kits.class_of(map)), 0)
  end
  local action = assemble { group = options.group, on = options.on, map = map, side = options.side, domain = options.domain,
    name = options.name, kind = kind }
  check_axioms(action)
  return action
end)
core.docs[M.action] = doc_action

---- methods ----

--- Add a method with its doc.
function M.method(name, f, doc) core.method("dm.action", name, blame.caller(f), doc) end

-- z as a vector of the right length
local function point(action, z) return kits.vector(z, action.dimension, "the point z") end
M.point, M.image, M.is_inside, M.moved, M.sample_point = point, image, is_inside, moved, sample_point

-- numbers that are not finite are an error
local function must_be_finite(action, value, z)
  if not kits.is_finite(value) then error(("%s is not defined at z = %s"):format(tostring(action), show(z)), 0) end
  return value
end

local function act(action, g, z)
  local kit = groups.kit(action.group)
  z = point(action, z)
  return must_be_finite(action, image(action, kit.element(g), z), z)
end
class.__call = blame.caller(act)
M.method("act", act, [[
action:act(g, z) -> dm.vector
The moved point; the same as action(g, z). Raises where it is not finite.]])

-- dm.function (xi, z) -> d map(exp(xi), z)/d(xi, z) at xi = 0
local function slope(action)
  if not rawget(action, "slope_function") then
    local kit = groups.kit(action.group)
    rawset(action, "slope_function", core.derivative(function(xi, z) return image(action, kit.near(xi), z) end,
      kit.dimension, action.dimension))
  end
  return rawget(action, "slope_function")
end

--- The matrix psi of generators at z, as a table of rows.
function M.generator_rows(action, z)
  local r = action.group.dimension
  if action.generator_by then return action.generator_by(z) end
  local J, rows = slope(action)(core.zeros(r), z), {}
  for i = 1, action.dimension do
    rows[i] = {}
    for a = 1, r do rows[i][a] = J[i][a] end
  end
  return rows
end

M.method("generator", function(action, z)
  z = point(action, z)
  local rows = M.generator_rows(action, z)
  for _, row in ipairs(rows) do must_be_finite(action, row, z) end
  return core.matrix(rows)
end, [[
action:generator(z) -> dm.matrix, dim z x dim G
Infinitesimal generators at z, a column for each basis vector of the algebra: d/dt map(exp(t e_a), z) at t = 0, exact from the
graph. z may hold symbols.]])

M.method("momentum", function(action, q, p)
  q, p = point(action, q), kits.vector(p, action.dimension, "the momentum p")
  local rows, out = M.generator_rows(action, q), {}
  for a = 1, action.group.dimension do
    local sum = 0
    for i = 1, action.dimension do sum = sum + rows[i][a] * p[i] end
    out[a] = sum
  end
  return core.vector(out)
end, [[
action:momentum(q, p) -> dm.vector of dim G entries
The momentum map <J(q, p), xi> = <p, xi_Q(q)> of the cotangent lift. Also path:momentum(action), Ld:momentum(action, q0, q1).]])

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

local function on_points(action, k)
  if not math.tointeger(k) or k < 1 then error("action:on_points(k) takes the number of points, a whole number >= 1", 0) end
  if action.points then error("this action is on several points already: ask its base, action.base:on_points(k)", 0) end
  k = math.tointeger(k)
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
  return assemble { group = action.group, on = k == 1 and action.on or core.product(table.unpack(copies)), map = joint,
    side = action.side, domain = domain or nil, name = action.name, points = k, base = action }
end

M.method("on_points", on_points, [[
action:on_points(k) -> dm.action
The joint (diagonal) action on k points, z = their numbers one after the other; fields points = k, base = action.]])
M.method("on_pairs", function(action) return on_points(action, 2) end, [[
action:on_pairs() -> dm.action
The joint action on two points, action:on_points(2).]])

-- prolongations and questions add their methods; they find this module complete
package.loaded["dm.action"] = M
require "dm.action_lift"
require "dm.action_test"

return M
