-- the groups: laws at random, hard points (tiny angles, angles near pi), differentials against the
-- derivatives of traced maps
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, pi, cos, sin, exp = math.abs, math.max, math.pi, math.cos, math.sin, math.exp

local stream = dm.random(3)
local function vector(n, i, size)
  local out = {}
  for k = 1, n do out[k] = stream:normal(i, k, 0, size or 0.5) end
  return dm.vector(out)
end
local function entries(m)
  local out = {}
  for i = 1, #m do
    for j = 1, #m[i] do out[#out + 1] = m[i][j] end
  end
  return dm.vector(out)
end

-- a script's own, by matrices (with a form, nilpotent, of other entries) and by products of vectors
local lorentz = dm.group { name = "SO(2, 1)", form = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } },
  basis = { { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 1 }, { 0, 0, 0 }, { 1, 0, 0 } },
    { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 } } } }
local affine = dm.group { name = "Aff(1)",
  basis = { { { 0, 1 }, { 0, 0 } }, { { 1, 0 }, { 0, 0 } } } }
local upper = dm.group { name = "U(3)", basis = { { { 0, 1, 0 }, { 0, 0, 0 }, { 0, 0, 0 } },
  { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 0 } }, { { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 0 } } } }
local heisenberg = dm.group { name = "H", dimension = 3, identity = { 0, 0, 0 },
  mul = function(x, y) return { x[1] + y[1], x[2] + y[2], x[3] + y[3] + x[1] * y[2] } end,
  inv = function(x) return { -x[1], -x[2], x[1] * x[2] - x[3] } end,
  exp = function(x) return { x[1], x[2], x[3] + x[1] * x[2] / 2 } end,
  log = function(x) return { x[1], x[2], x[3] - x[1] * x[2] / 2 } end }

local groups = { lorentz, affine, upper, heisenberg, dm.SU(2), dm.product(dm.SU(2), affine),
  dm.semidirect(affine, dm.R(2)), dm.R(3), dm.T(2), dm.SO(2), dm.SO(3), dm.SO(4), dm.SO(5), dm.SE(2), dm.SE(3),
  dm.SE(4), dm.SL(2), dm.SL(3),
  dm.GL(1), dm.GL(2), dm.GL(3), dm.Sp(2), dm.Sp(4), dm.Heisenberg(), dm.Heisenberg(2),
  dm.product(dm.SO(3), dm.R(2)),
  dm.product(dm.SE(2), dm.SL(2), dm.T(1)), dm.semidirect(dm.SO(3), dm.R(3)),
  dm.semidirect(dm.SL(2), dm.R(2)),
  dm.semidirect(dm.SO(2), dm.R(2)),
  dm.semidirect(dm.product(dm.SO(2), dm.R(1)), dm.R(2), function(g, v)
    local c, s, a = cos(g[1]), sin(g[1]), exp(g[2][1])
    return { a * (c * v[1] - s * v[2]), a * (s * v[1] + c * v[2]) }
  end) }

---- laws ----

local function laws_of_elements(G, worst, i)
  local a, b, c = G:random(stream, i, 0.5), G:random(stream, i + 100, 0.5),
    G:random(stream, i + 200, 0.5)
  local e = G:identity()
  worst("(ab)c = a(bc)", G:distance(G:compose(a, G:compose(b, c)), G:compose(G:compose(a, b), c)))
  worst("a a^-1 = e", G:distance(G:compose(a, G:inverse(a)), e))
  worst("e a = a", G:distance(G:compose(e, a), a))
  worst("flat coordinates", G:distance(G:unflat(G:flat(a)), a))
  for _, x in ipairs(G:bonds(G:flat(a))) do worst("bonds", x) end
  worst("exp(log a) = a", G:distance(G:exp(G:log(a)), a))
  worst("project", G:distance(G:project(a), a))
  worst("left and right", G:distance(G:left(a, b), G:right(b, a)))
end

local function laws_of_algebra(G, worst, i)
  local r = G.dimension
  local a, b = G:random(stream, i, 0.5), G:random(stream, i + 100, 0.5)
  local xi, eta, zeta = vector(r, i), vector(r, i + 50), vector(r, i + 70)
  worst("log(exp xi) = xi", (G:log(G:exp(xi)) - xi):norm())
  worst("Ad is a homomorphism", (G:Ad(a, G:Ad(b, xi)) - G:Ad(G:compose(a, b), xi)):norm())
  worst("Ad keeps brackets", (G:Ad(a, G:ad(xi, eta)) - G:ad(G:Ad(a, xi), G:Ad(a, eta))):norm())
  worst("a exp(xi) a^-1", (G:log(G:compose(G:compose(a, G:exp(xi)), G:inverse(a)))
    - G:Ad(a, xi)):norm())
  worst("Jacobi", (G:ad(xi, G:ad(eta, zeta)) + G:ad(eta, G:ad(zeta, xi))
    + G:ad(zeta, G:ad(xi, eta))):norm())
  worst("coAd", G:coAd(a, zeta):dot(xi) - zeta:dot(G:Ad(G:inverse(a), xi)))
  worst("coad", G:coad(xi, zeta):dot(eta) - zeta:dot(G:ad(xi, eta)))
  worst("dexpinv", (G:dexpinv(xi, G:dexp(xi, eta)) - eta):norm())
end

-- the rest where there is one: Cayley's map, matrices
local function laws_of_maps(G, worst, i)
  local r = G.dimension
  local xi, eta = vector(r, i), vector(r, i + 50)
  if pcall(G.cayley, G, xi) then
    worst("cayleyinv", (G:cayleyinv(G:cayley(xi)) - xi):norm())
    worst("dcayinv", (G:dcayinv(xi, G:dcay(xi, eta)) - eta):norm())
  end
  if pcall(G.hat, G, xi) then
    local a, b = G:random(stream, i, 0.5), G:random(stream, i + 100, 0.5)
    worst("hat and vee", (G:vee(G:hat(xi)) - xi):norm())
    worst("matrices multiply", (entries(G:matrix(G:compose(a, b)))
      - entries(G:matrix(a) * G:matrix(b))):norm())
    worst("hat is a homomorphism", (entries(G:hat(G:ad(xi, eta)))
      - entries(G:hat(xi) * G:hat(eta) - G:hat(eta) * G:hat(xi))):norm())
  end
end

for _, G in ipairs(groups) do
  local most, name = 0, "none"
  local function worst(law, x)
    if not (abs(x) <= most) and most == most then most, name = abs(x), law end
  end
  for i = 1, 6 do
    laws_of_elements(G, worst, i)
    laws_of_algebra(G, worst, i)
    laws_of_maps(G, worst, i)
  end
  ok(most < 2e-12, ("laws of %s"):format(tostring(G)), name .. " " .. most)
  ok(G:valid(G:random(stream, 7)) and G:valid(G:identity()), "  its random elements are elements")
end

---- differentials, by the exact derivative of the traced map in its entries ----

-- d/dt of the list f(xi + t eta) at t = 0, by the graph
local function along(f, xi, eta)
  return dm.derivative(function(t) return dm.vector(f(xi + eta * t[1])) end, 1) { 0 }
end
local function flat_of(G, g) return G:flat(g) end
for _, G in ipairs(groups) do
  local r, most = G.dimension, 0
  for i = 1, 3 do
    local xi, eta = vector(r, i + 300), vector(r, i + 350)
    -- T(exp)(eta) and the curve exp(t dexp(xi, eta)) exp(xi): the same derivative at t = 0
    local d1 = along(function(x) return flat_of(G, G:exp(x)) end, xi, eta)
    local g, rate = G:exp(xi), G:dexp(xi, eta)
    local d2 = along(function(x) return flat_of(G, G:compose(G:exp(x), g)) end, dm.zeros(r), rate)
    for k = 1, #d1 do most = max(most, abs((d1[k][1] or d1[k]) - (d2[k][1] or d2[k]))) end
    if pcall(G.cayley, G, xi) then
      local c, slope = G:cayley(xi), G:dcay(xi, eta)
      d1 = along(function(x) return flat_of(G, G:cayley(x)) end, xi, eta)
      d2 = along(function(x) return flat_of(G, G:compose(G:exp(x), c)) end, dm.zeros(r), slope)
      for k = 1, #d1 do most = max(most, abs((d1[k][1] or d1[k]) - (d2[k][1] or d2[k]))) end
    end
  end
  ok(most < 5e-13, ("dexp and dcay of %s are the derivatives of exp and cayley")
    :format(tostring(G)), most)
end

---- the hard points ----

local SO3 = dm.SO(3)
local axis = dm.vector { 2 / 7, -3 / 7, 6 / 7 }
for _, angle in ipairs { 1e-300, 1e-12, 1e-8, 1e-4, 0.1, 1, 3, pi - 1e-4, pi - 1e-8,
  pi - 1e-12, pi } do
  local R = SO3:exp(axis * angle)
  local back = SO3:log(R)
  if angle == pi and back:dot(axis) < 0 then back = -back end
  ok((back - axis * angle):norm() < 1e-15 * max(1, angle) + 4e-16 * angle,
    ("log(exp) of SO(3) at the angle %.13g"):format(angle),
    (back - axis * angle):norm())
  local exact = math.abs(SO3:distance(SO3:identity(), R) - angle)
  ok(exact < 1e-15 * max(1e-290, angle) + 1e-16 * (angle > 1 and 8 or 0),
    "  and the distance", exact)
end
-- near pi the logarithm of SE(3) keeps its translation
local SE3 = dm.SE(3)
for _, angle in ipairs { 1e-9, 1, pi - 1e-9 } do
  local xi = dm.vector { 0.3, -1, 2, axis[1] * angle, axis[2] * angle, axis[3] * angle }
  ok((SE3:log(SE3:exp(xi)) - xi):norm() < 3e-15,
    ("log(exp) of SE(3) at the angle %.10g"):format(angle), (SE3:log(SE3:exp(xi)) - xi):norm())
  xi = dm.vector { 0.3, -1, angle }
  ok((dm.SE(2):log(dm.SE(2):exp(xi)) - xi):norm() < 2e-15, "  and of SE(2)")
end
-- SO(n): several planes at once near half turns, at them, and at angles near zero
local worst_round, worst_length = 0, 0
for n = 4, 8 do
  local G = dm.SO(n)
  for i = 1, 6 do
    local M = dm.zeros(n, n)
    for k = 1, n // 2 do
      local angles = { pi, pi - 10 ^ -(15 * stream:uniform(i, 60 + k)),
        10 ^ -(10 * stream:uniform(i, 70 + k)), 3.1 * stream:uniform(i, 80 + k) }
      local angle = angles[(i + k * k) % 4 + 1]
      M[2 * k][2 * k - 1], M[2 * k - 1][2 * k] = angle, -angle
    end
    local Q = G:random(stream, i)
    local xi = G:vee(Q * M * Q:transpose())
    local R = G:exp(xi)
    local back = G:log(R)
    worst_round = max(worst_round, entries(G:exp(back) - R):norm())
    worst_length = max(worst_length, abs(back:norm() - xi:norm()))
  end
end
ok(worst_round < 1e-13, "exp(log R) = R for SO(4) to SO(8) near half turns", worst_round)
ok(worst_length < 1e-13, "and the logarithm is the shortest", worst_length)
-- to all digits of the angle, where x/sin x and asin x/x go over to their series
for _, size in ipairs { 1e-7, 3e-5, 9.9e-5, 1.1e-4, 1e-2 } do
  local G, M = dm.SO(4), dm.zeros(4, 4)
  M[2][1], M[1][2], M[4][3], M[3][4] = size, -size, pi - size, size - pi
  local small = G:vee(M) * (size / (2 * pi))
  ok((G:log(G:exp(small)) - small):norm() < 1e-15 + 3e-15 * small:norm(), "SO(4): two small angles", size)
  M[4][3], M[3][4] = 0, 0
  local one = G:vee(M)
  ok((G:log(G:exp(one)) - one):norm() < 1e-13 * size, "SO(4): one small angle", size)
  M[2][1], M[1][2] = pi - size, size - pi
  ok(abs((G:log(G:exp(G:vee(M)))):norm() / G:vee(M):norm() - 1) < 1e-15, "and one that is nearly half a turn", size)
end
-- the flat coordinates of a reflection do not pass for a rotation
for n = 4, 6 do
  local G = dm.SO(n)
  local list = G:flat(G:random(stream, n))
  ok(#list - #G:bonds(list) == G.dimension and dm.vector(G:bonds(list)):norm() < 1e-14,
    ("bonds of SO(%d)"):format(n))
  for j = 1, n do list[j] = -list[j] end
  ok(dm.vector(G:bonds(list)):norm() > 1, "  a reflection breaks them")
end
-- SL(2): elliptic, parabolic, hyperbolic
local SL2 = dm.SL(2)
for _, xi in ipairs { { 0, -3.1, 3.1 }, { 0, 1, 0 }, { 1e-9, 1, -1e-12 }, { 3, 1, 2 },
  { 0.2, 0.5, -0.08 } } do
  local back = SL2:log(SL2:exp(xi))
  ok((back - dm.vector(xi)):norm() < 2e-14 * max(1, exp(dm.vector(xi):norm()) / 20),
    "log(exp) of SL(2) at " .. tostring(dm.vector(xi)),
    (back - dm.vector(xi)):norm())
end
near(SL2:exp { 1, 0, 0 }[1][1], exp(1), 1e-15, "exp of a diagonal matrix")
near(SL2:distance(SL2:exp(SL2:log { { -1, 0 }, { 0, -1 } }), { { -1, 0 }, { 0, -1 } }), 0, 1e-15,
  "-1 of SL(2) is a rotation by pi")

-- exact derivatives at 0, with symbols: the second derivative of exp along eta at 0 is hat(eta)^2
local eta = dm.vector { 0.3, -0.7, 0.4 }
local f = dm.trace(function(x) return SO3:exp(x)[1][2] end, 3)
local square = SO3:hat(eta) * SO3:hat(eta)
near(f:gradient({ 0, 0, 0 }):dot(eta), SO3:hat(eta)[1][2], 1e-16, "first derivative of exp at 0")
near((f:hessian { 0, 0, 0 } * eta):dot(eta), square[1][2], 1e-15, "second derivative of exp at 0")
-- and of log at the identity, through exp: the identity map has the identity as its derivative
for _, G in ipairs { SO3, SE3, dm.SE(2), SL2, dm.SO(4), dm.GL(2), dm.Sp(4) } do
  local r = G.dimension
  local loop = dm.trace(function(x) return G:log(G:exp(x)) end, r)
  local most = 0
  for _, x in ipairs { dm.zeros(r), vector(r, 11, 0.3) } do
    local J, y = loop:jacobian(x), loop(x)
    for i = 1, r do
      most = max(most, abs(y[i] - x[i]))
      for k = 1, r do most = max(most, abs(J[i][k] - (i == k and 1 or 0))) end
    end
  end
  ok(most < 1e-12, "with symbols log(exp x) = x and its derivative is 1: " .. tostring(G), most)
end

-- every method takes symbols: traced, it gives what it gives with numbers
local function numbers_of(x)
  if type(x) == "number" then return { x } end
  if type(x) == "table" then
    local out = {}
    for _, part in ipairs(x) do
      for _, y in ipairs(numbers_of(part)) do out[#out + 1] = y end
    end
    return out
  end
  if getmetatable(x).__name == "dm.matrix" then return numbers_of(x:totable()) end
  if getmetatable(x).__name == "dm.vector" then return x:totable() end
  return { x }
end
local methods = { compose = "gg", inverse = "g", exp = "x", log = "g", Ad = "gx", ad = "xx",
  coAd = "gx", coad = "xx", hat = "x", cayley = "x",
  dexp = "xx", dexpinv = "xx", dcay = "xx", dcayinv = "xx", matrix = "g", flat = "g", project = "g",
  distance = "gg", left = "gg", right = "gg",
  left_tangent = "ggg", right_tangent = "ggg" }
-- a group takes a third of the methods, the next another one (SAMPLES=1: all)
local names, stride = {}, math.min(3, 60 // tap.samples(60))
for method in pairs(methods) do names[#names + 1] = method end
table.sort(names)
for turn, G in ipairs { dm.T(2), dm.SO(2), SO3, dm.SO(4), dm.SU(2), lorentz, affine, heisenberg, dm.SE(2), SE3, dm.SE(4), SL2, dm.SL(3),
  dm.GL(2), dm.GL(3), dm.Sp(4), dm.Heisenberg(),
  dm.product(SO3, dm.R(2)), dm.semidirect(SL2, dm.R(2)) } do
  local kit, r = require "dm.group".kit(G), G.dimension
  local a, b, x, y = G:random(stream, 1, 0.4), G:random(stream, 2, 0.4), vector(r, 3, 0.4),
    vector(r, 4, 0.4)
  local n, most, name = #kit.entries(a), 0, "none"
  for i, method in ipairs(names) do
    local kinds = methods[method]
    local function call(g, h, xi, eta_)
      local list = { g = { g, h, g }, x = { xi, eta_ } }
      local arguments = {}
      for k = 1, #kinds do arguments[k] = table.remove(list[kinds:sub(k, k)], 1) end
      return dm.vector(numbers_of(G[method](G, table.unpack(arguments))))
    end
    local fine, value = pcall(call, a, b, x, y)
    if fine and (i + turn) % stride == 0 then
      local traced = dm.trace(function(g, h, xi, eta_) return call(
        kit.rebuild(g), kit.rebuild(h), xi, eta_) end, n, n, r, r)
      local off = (traced(kit.entries(a), kit.entries(b), x, y) - value):norm()
      if not (off <= most) and most == most then most, name = off, method end
    end
  end
  ok(most < 1e-12, "with symbols as with numbers: " .. tostring(G), name .. " " .. most)
end

---- closed forms ----

local R = SO3:exp { 0, 0, pi / 2 }
near((R * dm.vector { 1, 0, 0 } - dm.vector { 0, 1, 0 }):norm(), 0, 1e-15,
  "a quarter turn about the third axis")
near((SO3:cayley { 0, 0, 2 } * dm.vector { 1, 0, 0 } - dm.vector { 0, 1, 0 }):norm(), 0, 1e-15,
  "Cayley of 2 is a quarter turn")
near(dm.SO(2):cayley(2), pi / 2, 1e-15, "and on SO(2)")
near((dm.SE(2):exp { 1, 0, pi / 2 } - dm.vector { 2 / pi, 2 / pi, pi / 2 }):norm(), 0, 1e-15,
  "a quarter of a circle in SE(2)")
near((dm.Heisenberg():compose({ 1, 0, 0 }, { 0, 1, 0 }) - dm.vector { 1, 1, 0.5 }):norm(), 0, 0,
  "half an area in the Heisenberg group")
near((dm.GL(2):log { { 1, 1 }, { 0, 1 } })[2], 1, 1e-15, "logarithm of a shear")
near(dm.S(2):distance({ 1, 0, 0 }, { cos(3), sin(3), 0 }), 3, 4e-16, "distance on the sphere")
near(dm.T(1):distance({ 0.1 }, { 2 * pi - 0.1 }), 0.2, 1e-15, "the short way round")
local M = SO3:project { { 1, 0.1, 0 }, { -0.1, 1, 0 }, { 0, 0, 2 } }
near(SO3:distance(M, SO3:exp { 0, 0, -math.atan(0.1) }), 0, 1e-15,
  "the nearest rotation is the polar factor")
ok(dm.product(dm.R(1), dm.SO(3)) == dm.product(dm.R(1), dm.SO(3)) and dm.SO(3) ~= dm.SO(4),
  "spaces are compared by what they are")
-- tangents of translations: those of matrices are products
local w = SO3:hat { 1, 2, 3 }
near(entries(SO3:left_tangent(R, R, w) - R * w):norm(), 0, 0, "T L_g of SO(3)")
near((dm.SE(2):left_tangent({ 1, 2, pi / 2 }, { 0, 0, 0 }, { 1, 0, 1 })
  - dm.vector { 0, 1, 1 }):norm(), 0, 1e-15, "T L_g of SE(2)")
near((dm.Heisenberg():right_tangent({ 1, 0, 0 }, { 0, 0, 0 }, { 0, 1, 0 })
  - dm.vector { 0, 1, -0.5 }):norm(), 0, 1e-15, "T R_g of Heisenberg")

---- the same generators in C (momentum maps of standard actions) and in Lua ----

for _, row in ipairs { { dm.SE(2), 2 }, { dm.SE(3), 3 }, { dm.SL(2), 2 }, { dm.SL(3), 3 },
  { dm.GL(2), 2 }, { dm.Sp(4), 4 }, { dm.Heisenberg(), 3 }, { dm.SU(2), 4 },
  { dm.SO(4), 4 }, { dm.SO(3), 3 }, { dm.SO(2), 3 } } do
  local G, n = row[1], row[2]
  local free = dm.discrete_lagrangian {
    Q = dm.R(n), h = 1, Ld = function(q0, q1) return (q1 - q0):dot(q1 - q0) / 2 end }
  local q0, q1 = vector(n, 400), vector(n, 401)
  local J, K = free:momentum(G, q0, q1),
    dm.action { group = G, on = dm.R(n), map = n == 2 and G.name == "SL" and "linear" or nil }
    :momentum(q1, q1 - q0)
  ok((J - K):norm() < 1e-14, ("momentum of %s on R^%d"):format(tostring(G), n), (J - K):norm())
end

---- a free rigid body in exponential coordinates ----

-- body rates are the left-trivialized differential of exp
local inertia = dm.matrix { { 1, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2.5 } }
local body = dm.system { Q = dm.R(3), L = function(q, v)
  local rate = SO3:dexp(-q, v)
  return (inertia * rate):dot(rate) / 2
end }
local tumble = body:solver { rule = "gauss(4)", h = 0.05 }:run {
  q = { 0, 0, 0 }, v = { 0.2, 1, 0.1 }, steps = 40, every = 1 }
local start, most = inertia * dm.vector { 0.2, 1, 0.1 }, 0
local rates = tumble:velocity()
for i = 1, #tumble do
  local q = tumble.q[i]
  most = max(most, (SO3:exp(q) * (inertia * SO3:dexp(-q, rates[i])) - start):norm())
end
ok(most < 1e-9, "a rigid body in exponential coordinates, from q = 0 on, keeps its momentum in "
  .. "space", most)

---- misuse ----

raises("manifold, not a group", function() return dm.S(2):exp { 1, 2 } end)
raises("must have 3 entries (got 2)", function() return SO3:exp { 1, 2 } end)
raises("must be a matrix of 3 x 3", function() return SO3:log { 1, 2, 3 } end)
raises("(got 2 x 2)", function() return SO3:log { { 1, 0 }, { 0, 1 } } end)
raises("no real logarithm", function() return SL2:log { { -2, 0 }, { 0, -0.5 } } end)
raises("no principal logarithm",
  function() return dm.GL(3):log { { -1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } end)
raises("-1 is one of its eigenvalues", function() return SO3:cayleyinv(SO3:exp { pi, 0, 0 }) end)
raises("does not reach", function() return dm.SO(2):cayleyinv(pi) end)
raises("multiple of 2 pi", function() return SO3:dexpinv({ 0, 2 * pi, 0 }, { 1, 0, 0 }) end)
raises("multiple of 2 pi", function() return SE3:dexpinv(
  { 1, 2, 3, 0, 2 * pi, 0 }, { 1, 0, 0, 1, 0, 0 }) end)
raises("has no 'cayley'", function() return dm.SL(3):cayley(dm.zeros(8)) end)
raises("nearest rotation", function() return SO3:project {
  { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } } end)
raises("multiple of 2", function() return dm.Sp(3) end)
raises("two or more spaces", function() return dm.product(dm.R(1)) end)
raises("not linear in v", function() return dm.semidirect(
  dm.SO(2), dm.R(1), function(g, v) return { v[1] ^ 2 } end) end)
-- when it is made, not at its first use
raises("give the action", function() return dm.semidirect(dm.SO(3), dm.R(2)) end)
raises("must have 3 entries (got 1)",
  function() return dm.semidirect(dm.SO(3), dm.R(3), function() return { 1 } end) end)
raises("list of 2 factors", function() return dm.product(dm.R(1), dm.R(2)):inverse { { 1 } } end)
raises("no standard action", function() return dm.discrete_lagrangian {
  Q = dm.R(2), h = 1, Ld = function(a, b) return a:dot(b) end }
  :momentum(dm.SE(3), { 1, 2 }, { 3, 4 }) end)
near(dm.system { Q = dm.product(SO3, dm.S(2)), L = function(_, v) return v:dot(v) end }
  :structure().constraints, 1, 0, "a sphere beside a group is a constraint")
raises("no element of SO(3): its determinant is -1",
  function() return SO3:log { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } } end)
raises("its columns are off orthonormal ones by 8",
  function() return SO3:inverse { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 3 } } end)
raises("called with a colon", function() return SO3.exp { 1, 2, 3 } end)
raises("not finite", function() return SO3:exp { 0 / 0, 0, 0 } end)
raises("out of reach", function() return dm.GL(2):exp { 1e7, 0, 0, 0 } end)
local fine, why = SO3:valid { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } }
ok(fine == false and why:find "determinant", "a reflection is no rotation", why)
for _, group in ipairs { "R", "T", "S", "SO", "SE", "SL", "GL", "Sp", "SU", "Heisenberg" } do
  raises("number expected, got the text \"2\"", dm[group], "2")
  for _, n in ipairs { -1, 0, 2.5, 1e9, 1e300, 0 / 0, 1 / 0 } do
    raises("needs a whole number from", dm[group], n)
  end
end
tap.done()
