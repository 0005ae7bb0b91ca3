--- What groups can do, as methods of dm.space: checked arguments, then the group's own file in
-- lua/dm/group.
local blame = require "dm.base.blame"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"

local element = groups.checked

-- raises where G.exp(xi) was written for G:exp(xi)
local function check_space(space)
  if kits.class_of(space) ~= "dm.space" then
    error(("methods of a group are called with a colon, G:exp(xi): a dm.space is needed (got %s)")
      :format(kits.class_of(space)), 0)
  end
end

local checks = {
  g = element,
  raw = function(kit, x) return kit.raw(x) end,
  x = function(kit, x)
    if kit.vee and kits.class_of(x) == "dm.matrix" then
      error(("the algebra element must be a vector of %d entries (got dm.matrix): G:vee(M) gives "
        .. "that of a matrix"):format(kit.dimension), 0)
    end
    return kits.vector(x, kit.dimension, "the algebra element")
  end,
  mu = function(kit, x) return kits.vector(x, kit.dimension, "the covector") end,
  flat = function(kit, x)
    return kits.list_of(kits.vector(x, kit.coordinates, "the list of flat coordinates"))
  end,
  M = function(kit, x)
    local n = kit.hat(core.zeros(kit.dimension)).rows
    return kits.matrix(x, n, "the matrix")
  end,
  stream = function(_, x)
    if kits.class_of(x) ~= "dm.random" then
      error(("a stream of random numbers, dm.random(seed), is needed (got %s)")
        :format(kits.class_of(x)), 0)
    end
    return x
  end,
}

-- NaN and infinite results are errors; symbols pass
local function finite(kit, value, kind)
  local list = value
  if kind == "g" then list = kit.entries(value) elseif kind == "number" then list = { value } end
  if not kits.is_finite(list) then
    error("the result is not finite: the argument is outside of the domain", 0)
  end
  return value
end

-- exp and log of a manifold begin at a point: method name -> function of a space
local geodesics = {}

local function from_a_point(name, f, check)
  geodesics[name] = function(space, z, x)
    if x == nil then
      error(("%s is a manifold, not a group: %s takes two arguments, a point and a %s")
        :format(tostring(space), name,
        name == "exp" and "tangent vector there" or "second point"), 0)
    end
    local kit = groups.kit(space)
    z = element(kit, z, space)
    return kits[f](kit, z, check(kit, z, x, space))
  end
end

-- name, kinds of the arguments, kind of the result ("g", "x", "number", "any"), doc
local function method(name, kinds, result, doc, also_manifolds)
  core.method("dm.space", name, blame.caller(function(space, ...)
    check_space(space)
    local own = geodesics[name]
    if own and groups.kit(space).manifold then return own(space, ...) end
    local kit = also_manifolds and groups.kit(space) or groups.group(space)
    local f = kit[name]
    if not f then error(("%s has no '%s'"):format(tostring(space), name), 0) end
    if own and (select(2, ...)) ~= nil then
      error(("bad argument #2 to '%s' (a surplus argument: %s is a group, G:%s(%s))")
        :format(name, tostring(space), name, name == "exp" and "xi" or "g"), 0)
    end
    local given = { ... }
    for i, kind in ipairs(kinds) do given[i] = checks[kind](kit, given[i], space) end
    local value = f(table.unpack(given, 1, #kinds))
    return result == "any" and value or finite(kit, value, result)
  end), doc)
end

method("identity", {}, "g", [[
G:identity() -> element
The neutral element. Elements are: SO(2) an angle; R(n), T(n), SE(2) = (x, y, theta), SU(2) = (w, x,
y, z), Heisenberg(n) vectors; SO(n), SE(n), SL(n), GL(n), Sp(n) dm.matrix; products lists. All
methods of groups also take symbols.]])
method("compose", { "g", "g" }, "g", [[
G:compose(a, b) -> element
The product a b. Angles are not wrapped.]])
method("left", { "g", "g" }, "g", [[
G:left(g, h) -> element
The left translation L_g h = g h.]])
method("right", { "g", "g" }, "g", [[
G:right(g, h) -> element
The right translation R_g h = h g.]])
method("left_tangent", { "g", "g", "raw" }, "any", [[
G:left_tangent(g, h, w) -> w'
The tangent T_h L_g w of the left translation at h; w, a change of h, has the shape of an
element.]])
method("right_tangent", { "g", "g", "raw" }, "any", [[
G:right_tangent(g, h, w) -> w'
The tangent T_h R_g w of the right translation at h; w, a change of h, has the shape of an
element.]])
method("inverse", { "g" }, "g", [[
G:inverse(g) -> element
The inverse element.]])
from_a_point("exp", "shoot", function(kit, z, w) return kits.tangent(kit, z, w) end)
from_a_point("log", "aim", function(kit, _, y, space) return element(kit, y, space) end)
method("exp", { "x" }, "g", [[
G:exp(xi) -> element   or   S:exp(z, w) -> point
The exponential of an algebra vector of dim G entries (a number will do for dim 1), with exact
derivatives at 0 too. Closed forms; for GL(n), Sp(2n), SL(n > 2), SO(n > 3) scaling and squaring (of
symbols for norms up to 32). Of a manifold, S(n) or a product with one: the point at the end of the
geodesic (great circle) of length |w| from z along the tangent vector w, z cos|w| + w sin|w|/|w|; of
a product lists, with g exp(xi) for factors that are groups.]])
method("log", { "g" }, "x", [[
G:log(g) -> dm.vector of dim G entries   or   S:log(z, y) -> w
The principal logarithm: exp(log(g)) is g; rotations by up to pi, with all digits near 0 and near
pi. Raises where there is none. Of a manifold, S(n) or a product with one: the tangent vector w at z
of the shortest geodesic to y, exp(z, w) = y, |w| = distance(z, y). Raises at antipodes.]])
method("Ad", { "g", "x" }, "x", [[
G:Ad(g, xi) -> dm.vector
The adjoint action g xi g^-1 on the algebra.]])
method("ad", { "x", "x" }, "x", [[
G:ad(xi, eta) -> dm.vector
The bracket [xi, eta] of the algebra, of matrices X Y - Y X.]])
method("coAd", { "g", "mu" }, "x", [[
G:coAd(g, mu) -> dm.vector
The coadjoint action Ad*_(g^-1): <coAd(g, mu), xi> = <mu, Ad(g^-1, xi)>, a left action.]])
method("coad", { "x", "mu" }, "x", [[
G:coad(xi, mu) -> dm.vector
The transpose of ad: <coad(xi, mu), eta> = <mu, [xi, eta]>, as in the Euler-Poincare equations mu' =
coad(xi, mu).]])
method("hat", { "x" }, "any", [[
G:hat(xi) -> dm.matrix
The matrix of an algebra vector: of SO(3) that of xi x; of vector groups the one of their
homogeneous matrices.]])
method("vee", { "M" }, "x", [[
G:vee(M) -> dm.vector
The algebra vector of a matrix: the inverse of hat; what of M is not in the algebra is left out.]])
method("cayley", { "x" }, "g", [[
G:cayley(xi) -> element
The Cayley map (1 - X/2)^-1 (1 + X/2), X = hat(xi), which agrees with exp to second order; angles 2
atan(xi/2). Not for SL(n > 2), whose determinant it does not keep.]])
method("cayleyinv", { "g" }, "x", [[
G:cayleyinv(g) -> dm.vector
The inverse of the Cayley map, 2 (g - 1)(g + 1)^-1. Raises where -1 is an eigenvalue.]])
method("dexp", { "x", "x" }, "x", [[
G:dexp(xi, eta) -> dm.vector
The right-trivialized differential of exp: d/dt exp(xi) = hat(dexp(xi, xi')) exp(xi), dexp = (e^ad -
1)/ad (HLW III.4). The left one is dexp(-xi, eta).]])
method("dexpinv", { "x", "x" }, "x", [[
G:dexpinv(xi, eta) -> dm.vector
The inverse of eta -> dexp(xi, eta). Raises where it has none (rotations by 2 pi).]])
method("dcay", { "x", "x" }, "x", [[
G:dcay(xi, eta) -> dm.vector
The right-trivialized differential of the Cayley map: (1 - X/2)^-1 Y (1 + X/2)^-1. The left one is
dcay(-xi, eta).]])
method("dcayinv", { "x", "x" }, "x", [[
G:dcayinv(xi, eta) -> dm.vector
The inverse of eta -> dcay(xi, eta): (1 - X/2) Y (1 + X/2).]])
method("matrix", { "g" }, "any", [[
G:matrix(g) -> dm.matrix
The (homogeneous) matrix of an element; of a product the blocks on the diagonal.]])
method("flat", { "g" }, "any", [[
G:flat(g) -> list of N numbers
Coordinates of an element without a singularity: a unit quaternion for SO(3), entries for other
matrices, angles as they are.]], true)
method("unflat", { "flat" }, "any", [[
G:unflat(list) -> element
The element of flat coordinates, which fulfil G:bonds.]], true)
method("bonds", { "flat" }, "any", [[
G:bonds(list) -> list of numbers
N - dim G equations that flat coordinates fulfil: |q|^2 - 1 of a quaternion, orthonormal columns of
other rotations, the last across the others, det - 1 of SL(n), g^T J g = J above the diagonal of
Sp(n).]], true)
method("project", { "raw" }, "g", [[
G:project(M) -> element
The nearest rotation of SO(n) and SE(n) (the polar factor), M/det^(1/n) of SL(n), a symplectic
matrix near M of Sp(n), angles wrapped to -pi .. pi, a unit vector of S(n).]], true)
method("distance", { "g", "g" }, "number", [[
G:distance(a, b) -> number
The angle of rotation of a^-1 b (SO(n), T(n): of all planes, in the Euclidean norm; S(n): between
the vectors), |log(a^-1 b)| for R(n), SE(n), Heisenberg(n), the Frobenius norm of a - b for GL(n),
SL(n), Sp(n).]], true)

---- what has arguments of other kinds ----

core.method("dm.space", "random", blame.caller(function(space, stream, i, size)
  check_space(space)
  local kit = groups.kit(space)
  checks.stream(kit, stream)
  i = i or 0
  if not lists.whole(i) or i < 0 then
    error("the place i in the stream must be a whole number >= 0", 0)
  end
  if size == nil then return kit.sample(stream, lists.whole(i)) end
  if type(size) ~= "number" or not (size >= 0 and size < math.huge) then
    error("size must be a number >= 0", 0)
  end
  if kit.manifold then
    error(("%s is a manifold, not a group: random(stream, i) is uniform")
      :format(tostring(space)), 0)
  end
  return kit.exp(kits.normals(stream, lists.whole(i), kit.dimension, size))
end), [==[
G:random(stream [, i [, size]]) -> element
Element i (0) of the stream dm.random(seed): uniform on SO(n), T(n), S(n) and their products
(translations normal), else a product of exponentials. With size: exp of normal numbers of that
deviation.]==])

local VALID = 1e-9

core.method("dm.space", "valid", blame.caller(function(space, g)
  check_space(space)
  local kit = groups.kit(space)
  local fine, element = blame.try(kit.element, g)
  if not fine then return false, element end
  if not kits.is_finite(kit.entries and kit.entries(element) or kit.flat(element)) then
    return false, "it is not finite"
  end
  local defect, why = kit.defect(element)
  if defect <= VALID then return true, defect end
  return false, why or ("it is off by %g"):format(defect)
end), [==[
G:valid(g) -> true, defect   or   false, why
Is g an element: of the right shape, finite, and on the group to 1e-9?]==])

return {}
