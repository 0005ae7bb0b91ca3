-- dm.differential_invariants: formulas against the literature, closed forms and independent roads
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, exp, max, sin, tan = math.abs, math.cos, math.exp, math.max, math.sin, math.tan

local function calculus(group, n, independent, invariants, section, branch, map)
  return dm.differential_invariants {
    action = dm.action { group = group, on = dm.R(n), map = map }, independent = independent,
    invariants = invariants, cross_section = section, branch = branch }
end
local function text(f) return tostring(f) end
local function is(f, wanted, what) ok(text(f) == wanted, what, text(f)) end

---- curves in the plane, rigid motions ----

local plane = calculus(dm.SE(2), 2, 1, { kappa = 4 },
  function(z) return { z[1], z[2], z[3] } end)
local function bending(I) return I.kappa[1] ^ 2 / 2 end
is(plane:iota(6), "kappa_ss + 3 kappa^3", "u_xxxx, normalized")
is(plane:iota(3), "0", "u_x is a phantom")
is(plane:euler_lagrange(bending), "kappa_ss + kappa^3/2", "Euler's elastica")
is(plane:euler_lagrange(function() return 1 end), "-kappa", "length: straight lines")
is(plane:euler_lagrange(function(I) return I.kappa[1] end), "0", "the turn is a null Lagrangian")
is(plane:euler_lagrange(function(I) return dm.exp(I.kappa[1]) end),
  "exp(kappa) kappa_ss + exp(kappa) kappa_s^2 + exp(kappa) kappa^2 - exp(kappa) kappa",
  "of an elementary function")
is(plane:euler_lagrange(function(I) return dm.sqrt(I.kappa[1]) end),
  "-sqrt(kappa) kappa_ss/(4 kappa^2) + 3 sqrt(kappa) kappa_s^2/(8 kappa^3) - sqrt(kappa) kappa/2",
  "of a root")
local H, star = plane:operator()
is(H, "kappa: D^2 + kappa^2", "how the curvature changes")
is(star, "E of u: D^2 + kappa^2", "which is self-adjoint")
is(H:coefficient(1, 1, 0), "kappa^2", "a coefficient of it")
ok(#plane:syzygies() == 0, "one curvature is free")
ok(plane:iota(6):tex() == "\\kappa_{ss} + 3 \\kappa^{3}", "for TeX", plane:iota(6):tex())
ok(plane:iota(6) == plane:iota(6) and plane:iota(6) ~= plane:iota(5), "normal forms are compared")
is(plane:euler_lagrange(plane:iota(4)), "0", "a formula is a Lagrangian too")
local doubled = calculus(dm.SE(2), 2, 1, { kappa = 4, c = 5 },
  function(z) return { z[1], z[2], z[3] } end)
is(doubled:syzygies()[1], "kappa_s - c", "an invariant too many has a syzygy")

-- jets: y = u(x) with derivatives by hand, curvature by the textbook
local function jet(x) return { x, sin(x), cos(x), -sin(x), -cos(x), sin(x) } end
local function curvature(x) return -sin(x) / (1 + cos(x) ^ 2) ^ 1.5 end
local I, d = plane:invariants(jet(0.4)), 1e-5
near(I.kappa[1], curvature(0.4), 1e-13, "curvature of a graph")
local speed = math.sqrt(1 + cos(0.4) ^ 2)
near(I.kappa[2], (curvature(0.4 + d) - curvature(0.4 - d)) / (2 * d) / speed, 1e-9,
  "its derivative by arclength")

-- E(L) is the variation of the integral of L ds: by differences along a bump
local function wavy(J)
  return J.kappa[1] ^ 4 / 4 + J.kappa[2] ^ 2 * J.kappa[1] + dm.exp(J.kappa[1])
end
local function jets_of(size)
  local f = dm.trace(function(x)
    return 0.4 * dm.sin(1.3 * x) + 0.2 * x ^ 2 + size * (1 - x ^ 2) ^ 8
  end, "number")
  local list = { f }
  for k = 1, 6 do
    local g = list[k]
    list[k + 1] = dm.derivative(function(x) return g(x) end, "number")
  end
  return function(x)
    local out = { x }
    for k = 1, 7 do out[1 + k] = list[k](x) end
    return out
  end
end
local function simpson(f)
  local sum, n = 0, 100
  for i = 0, n do
    sum = sum + ((i == 0 or i == n) and 1 or i % 2 == 1 and 4 or 2) * f(-1 + 2 * i / n)
  end
  return sum * 2 / (3 * n)
end
local function functional(size)
  local jets = jets_of(size)
  return simpson(function(x)
    local z = jets(x)
    local J = plane:invariants(z)
    local k, ks = J.kappa[1], J.kappa[2]
    return (k ^ 4 / 4 + ks ^ 2 * k + exp(k)) * math.sqrt(1 + z[3] ^ 2)
  end)
end
local rest, E = jets_of(0), plane:euler_lagrange(wavy)
local paired = simpson(function(x)
  return E:value({ kappa = plane:invariants(rest(x)).kappa })[1] * (1 - x ^ 2) ^ 8
end)
near((functional(1e-4) - functional(-1e-4)) / 2e-4 / paired, 1, 1e-4, "E(L) is the variation")

-- extremals keep c, and c is the force and moment that mechanics has
local law = plane:conservation_law(bending)
local wire = plane:extremal { L = bending, start = { kappa = { 0.5, 1 } }, length = 2, steps = 100 }
-- a jet of the curve at row k, from kappa, kappa_s and the angle of the frame
local function jet_of_wire(k)
  local y = wire.path.q[k]
  local x, angle = wire.points:row(k), wire.frame[k][3]
  local c, s = cos(angle), sin(angle)
  local u2 = y[1] / c ^ 3
  return { x[1], x[2], s / c, u2, y[2] / c ^ 4 + 3 * (s / c) * u2 ^ 2 / (1 / c ^ 2) }
end
local first = law:value(jet_of_wire(1))
local worst = 0
for k = 1, 60 do worst = max(worst, (law:value(jet_of_wire(k)) - first):norm()) end
ok(worst < 1e-12, "Ad(rho)^-1 v is kept along an elastica", worst)
local coarse = plane:extremal { L = bending, start = { kappa = { 0.5, 1 } }, length = 2, steps = 10,
  rule = "gauss(6)", frame = { 1, 2, 0.3 } }
local p, q = coarse.points:row(11), wire.points:row(101)
near(p[1], 1 + cos(0.3) * q[1] - sin(0.3) * q[2], 1e-9, "another frame moves the curve")
near(coarse.kappa[11], wire.kappa[101], 1e-10, "another rule, the same curvature")
local circle = plane:extremal { L = function(J) return J.kappa[1] ^ 2 / 2 + 2 end,
  start = { kappa = { 2, 0 } }, length = math.pi, steps = 64 }
ok(circle.points:row(65):norm() < 1e-12, "kappa = 2: a circle, for L = kappa^2/2 + 2")

---- curves in space ----

local space = calculus(dm.SE(3), 3, 1, { kappa = 6, w = 9 },
  function(z) return { z[1], z[2], z[3], z[4], z[5], z[7] } end, function(z) return z[6] end)
is(space:euler_lagrange(bending)[1], "kappa_ss + kappa^3/2 - w^2/kappa", "rods, along the normal")
is(space:euler_lagrange(bending)[2], "w kappa_s/kappa + w_s", "and along the binormal")
is(space:euler_lagrange(function() return 1 end)[1], "-kappa", "length in space")
is(space:euler_lagrange(function() return 1 end)[2], "0", "has no binormal part")
local helix = space:invariants { 0, 2, 0, 0, 0.75, -2 / 16, 0, 0, -0.75 / 16 + 0 }
ok(#helix.kappa == 2 and #helix.w == 1, "as many derivatives as the jet has")
local rod = space:extremal { L = bending, start = { kappa = { 0.5, 0.3 }, w = { 0.2 } }, length = 3,
  steps = 60 }
worst = 0
for k = 1, 61 do
  worst = max(worst, abs(rod.kappa[k] * rod.w[k] - 0.1))
end
ok(worst < 1e-10, "kappa^2 tau = kappa w is kept along a rod", worst)
-- far enough that the frame turns by more than half a turn
local long = space:extremal { L = bending, start = { kappa = { 1, 0.4 }, w = { 0.2 } }, length = 14,
  steps = 700 }
worst = 0
for k = 2, 701 do
  worst = max(worst, abs((long.points:row(k) - long.points:row(k - 1)):norm() / 0.02 - 1))
end
ok(worst < 1e-4, "a long rod by arclength, through every turn of its frame", worst)
local tangent = (rod.points:row(2) - rod.points:row(1)):norm() / 0.05
near(tangent, 1, 1e-3, "by arclength")

-- D v + ad_R^T v + E w = 0 is an identity of formulas: Noether's theorem
local function identity(c, L)
  local current = require "dm.frame.calculus.current"
  local C = c.C
  local E = c:euler_lagrange(L)
  local expression = c:euler_lagrange(L)[1].expression
  local v, w = current.of(C, L(setmetatable({}, { __index = function(_, name)
    return setmetatable({}, { __index = function(_, k)
      return require("dm.frame.calculus.normal").invariant(C, C.find(name, "L"), k)
    end })
  end })))
  local rate, zero = current.derivative(C, v), expression ~= nil
  for a = 1, C.r do
    local sum = rate[a]
    for b = 1, C.q do sum = sum + E[b].expression * w[b][a] end
    zero = zero and require("dm.frame.calculus.field").reduced(sum):is_zero()
  end
  return zero
end
ok(identity(plane, bending), "Noether's identity in the plane")
ok(identity(plane, function(J) return J.kappa[2] ^ 2 / 2 + J.kappa[1] ^ 3 end), "of higher order")
ok(identity(space, bending), "Noether's identity in space")
ok(identity(space, function(J) return J.w[1] ^ 2 / J.kappa[1] ^ 3 end), "with the torsion")

---- curves with a parameter, projective, affine, similar ----

local line = calculus(dm.SL(2), 1, nil, { S = 4 }, function(z) return { z[1], z[2] - 1, z[3] } end)
is(line:euler_lagrange(function(J) return J.S[1] ^ 2 / 2 end), "-S_xxx - 3 S S_x", "Schwarzian^2/2")
is(line:operator(), "S: D^3 + 2 S D + S_x", "the operator of Korteweg and de Vries")
ok(identity(line, function(J) return J.S[1] ^ 2 / 2 end), "Noether's identity of SL(2)")
near(line:invariants({ tan(0.3), 1 / cos(0.3) ^ 2, 2 * tan(0.3) / cos(0.3) ^ 2,
  (2 + 6 * tan(0.3) ^ 2) / cos(0.3) ^ 2 }).S[1], 2, 1e-12, "the Schwarzian of tan is 2")

-- u = tan x has S = 2, an extremal of S^2/2: c is kept through its jets
local tangents, kept = { dm.trace(function(x) return dm.sin(x) / dm.cos(x) end, "number") }, {}
for k = 1, 6 do
  local g = tangents[k]
  tangents[k + 1] = dm.derivative(function(x) return g(x) end, "number")
end
local schwarz = line:conservation_law(function(J) return J.S[1] ^ 2 / 2 end)
for i, x in ipairs { 0.1, 1 } do
  local z = {}
  for k = 1, 6 do z[k] = tangents[k](x) end
  kept[i] = schwarz:value(z)
end
ok((kept[1] - kept[2]):norm() < 1e-11 and (kept[1] - dm.vector { 0, 4, -4 }):norm() < 1e-11,
  "what the tangent keeps", tostring(kept[2]))

-- a helix with kappa^2 = 2 tau^2 is a rod, as a graph over x in a tilted frame
local b, tilt, dX = 0.5, 0.4, nil
local a = math.sqrt(2) * b
local helical = { function(t) return cos(tilt) * b * t + sin(tilt) * a * dm.sin(t) end,
  function(t) return a * dm.cos(t) end,
  function(t) return -sin(tilt) * b * t + cos(tilt) * a * dm.sin(t) end }
dX = dm.derivative(helical[1], "number")
local function by_x(f)
  local out = { dm.trace(f, "number") }
  for k = 1, 4 do
    local g = dm.derivative(function(t) return out[k](t) end, "number")
    out[k + 1] = dm.trace(function(t) return g(t) / dX(t) end, "number")
  end
  return out
end
local ys, zs, rods = by_x(helical[2]), by_x(helical[3]), {}
local rod_law = space:conservation_law(bending)
for i, t in ipairs { 0.1, 0.4, 0.8 } do
  local z = { dm.trace(helical[1], "number")(t), ys[1](t), zs[1](t) }
  for k = 2, 5 do z[#z + 1], z[#z + 2] = ys[k](t), zs[k](t) end
  rods[i] = rod_law:value(z)
end
ok((rods[1] - rods[2]):norm() < 1e-12 and (rods[1] - rods[3]):norm() < 1e-12,
  "force and moment of a helical rod", tostring(rods[3]))

-- Kogan & Olver 2003, equi-affine curves
local affine = calculus(dm.semidirect(dm.SL(2), dm.R(2)), 2, 1, { kappa = 6 },
  function(z) return { z[1], z[2], z[3], z[4] - 1, z[5] } end)
is(affine:operator(), "kappa: D^4 + 5 kappa/3 D^2 + 5 kappa_s/3 D + kappa_ss/3 + 4 kappa^2/9",
  "equi-affine curvature changes as Kogan and Olver have it")
is(affine:euler_lagrange(function() return 1 end), "-2 kappa/9", "affine length: parabolas")
ok(identity(affine, function(J) return J.kappa[1] end), "Noether's identity of affine curves")
near(affine:invariants({ 0.2, 0.5 * 0.04, 0.2, 1, 0, 0 }).kappa[1], 0, 1e-13, "a parabola has none")

-- similarities: the invariant is k_s/k^2
local similar = dm.group { name = "Sim", basis = { { { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 0 } },
  { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 0 } }, { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 } } } }
local sim = calculus(similar, 2, 1, { s = 5 },
  function(z) return { z[1], z[2], z[3], z[4] - 1 } end, nil, function(g, z)
    return { g[1][1] * z[1] + g[1][2] * z[2] + g[1][3], g[2][1] * z[1] + g[2][2] * z[2] + g[2][3] }
  end)
local euclid = plane:invariants { 0.1, 0.5, 0.2, 0.9, -0.4 }
near(sim:invariants({ 0.1, 0.5, 0.2, 0.9, -0.4 }).s[1], euclid.kappa[2] / euclid.kappa[1] ^ 2,
  1e-12,
  "similarity curvature")
ok(identity(sim, function(J) return J.s[1] ^ 2 end), "Noether's identity of similarities")
-- d theta = kappa ds is invariant under both: the turn has no equation
is(sim:euler_lagrange(function() return 1 end), "0", "omega is the turn")

-- projective curves: a group of dimension 8
local projective = calculus(dm.SL(3), 2, 1, { eta = 9 }, function(z)
  return { z[1], z[2], z[3], z[4] - 1, z[5], z[6], z[7] - 1, z[8] }
end)
is(projective:euler_lagrange(function(J) return J.eta[1] end),
  "eta_sssss/3 - 4 eta eta_sss/3 - 8 eta_s eta_ss/3 + 32 eta^2 eta_s/27", "projective curvature")
ok(identity(projective, function(J) return J.eta[1] end), "Noether's identity of SL(3)")

-- sections that need solving: of a pair of entries, of a square with a branch
local pair = calculus(dm.SE(2), 2, 1, { k = 4 },
  function(z) return { z[1] - z[2], z[1] + z[2] - 2, z[3] } end)
is(pair:iota(6), "k_ss + 3 k^3", "two linear equations")
local slanted = calculus(dm.SE(2), 2, 1, { k = 4 },
  function(z) return { z[1], z[2], z[3] ^ 2 - 1 } end, function(z) return z[3] end)
is(slanted:iota(5), "k_s + 3 k^2/2", "the root on the branch, u_x = 1")
local graph = calculus(dm.SO(2), 2, 1, { r = 1, a = 3 }, function(z) return { z[2] } end,
  function(z) return z[1] end)
is(graph:maurer_cartan(), "R^1 = -a/r", "a section of points alone")
is(graph:euler_lagrange(function(J) return J.r[1] end), "0", "r dr is exact")

-- SO(2) about the origin: radius and angle
local turn = calculus(dm.SO(2), 2, nil, { r = 1, a = 3, b = 4 }, function(z) return { z[2] } end)
is(turn:syzygies()[1], "r_x - a", "r' is the radial velocity")
is(turn:maurer_cartan(), "R^1 = -b/r", "the angle's velocity")

---- surfaces ----

local surface = calculus(dm.SE(3), 3, { 1, 2 }, { a = 6, b = 8 },
  function(z) return { z[1], z[2], z[3], z[4], z[5], z[7] } end)
is(surface:euler_lagrange(function() return 1 end), "-a - b", "area: minimal surfaces")
is(surface:euler_lagrange(function(J) return J.a[1] * J.b[1] end), "0", "Gauss and Bonnet")
is(surface:euler_lagrange(function(J) return (J.a[1] + J.b[1]) / 2 end), "-b a",
  "total mean curvature (Steiner)")
local syzygy = surface:syzygies()
-- Gauss' equation on a surface of revolution, (r(z) turned): a = -r''/(1 + r'^2)^1.5, b = 1/(r
-- sqrt(1 + r'^2)) with D_1 along the meridian; D_2 = 0 there
local function profile(s) -- by arclength of the meridian, r = 2 + cos(s)/2
  local r, r1, r2 = 2 + cos(s) / 2, -sin(s) / 2, -cos(s) / 2
  local root = math.sqrt(1 - r1 ^ 2)
  return -r2 / root, root / r
end
local s, h = 0.7, 1e-4
local a0, b0 = profile(s)
local a1, b1 = profile(s + h)
local a2, b2 = profile(s - h)
local values = { a = { a0, (a1 - a2) / (2 * h), 0, (a1 - 2 * a0 + a2) / h ^ 2, 0, 0 },
  b = { b0, (b1 - b2) / (2 * h), 0, (b1 - 2 * b0 + b2) / h ^ 2, 0, 0 } }
ok(#syzygy > 0 and syzygy:value(values):norm() < 1e-6, "Gauss and Codazzi on a torus-like surface",
  syzygy:value(values):norm())

-- derivatives of invariants at a jet satisfy what all jets do, whichever way their entry is reached
local function random_jet(count)
  local stream, out = dm.random(21), {}
  for i = 1, count do out[i] = stream:normal(i, 1) end
  return out
end
local function on_jets(c, order_length, what)
  local I, v = c:invariants(random_jet(order_length)), {}
  for _, name in ipairs(c.names) do v[name] = I[name] end
  local off = c:syzygies():value(v):norm()
  ok(off < 1e-9, what, off)
end
on_jets(surface, 17, "Gauss and Codazzi at a jet")
on_jets(calculus(dm.SE(2), 3, { 1, 2 }, { v = 3, m = 4, a = 6, b = 7, c = 8 },
  function(z) return { z[1], z[2], z[5] } end, nil, function(g, z)
    local p, q = dm.cos(g[3]), dm.sin(g[3])
    return { p * z[1] - q * z[2] + g[1], q * z[1] + p * z[2] + g[2], z[3] }
  end), 17, "functions on the plane under its motions")
local named_twice = calculus(dm.SE(2), 2, 1, { kappa = 4, c = 6 },
  function(z) return { z[1], z[2], z[3] } end)
near(named_twice:invariants(jet(0.4)).kappa[3], plane:invariants(jet(0.4)).kappa[3], 1e-13,
  "kappa_ss, though iota(u_xxxx) has a name of its own")
local pipe = surface:invariants { 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, -3, 0, 0, 0, 0 }
ok(pipe.a[1] == -1 and pipe.a[4] == 0 and pipe.a[6] == 0 and pipe.b[4] == 0, "a cylinder's top")

---- what is refused ----

raises("unknown invariant 'torsion': known are kappa", function()
  plane:euler_lagrange(function(J) return J.torsion[1] end)
end)
raises("kappa needs 3 numbers, kappa, kappa_s, kappa_ss", function()
  plane:iota(6):value { kappa = { 1 } }
end)
raises("unknown invariant 'k'", function() plane:iota(6):value { k = { 1 } } end)
raises("not finite", function() space:euler_lagrange(bending):value { kappa = { 0, 1, 1 }, w = { 1,
  1 } } end)
raises("name it too", function()
  calculus(dm.SE(3), 3, 1, { kappa = 6 }, function(z)
    return { z[1], z[2], z[3], z[4], z[5], z[7] }
  end):euler_lagrange(bending)
end)
raises("fixed by the cross-section", function()
  calculus(dm.SE(2), 2, 1, { k = 3 }, function(z) return { z[1], z[2], z[3] } end)
end)
raises("2 equations, but the group has 3", function()
  calculus(dm.SE(2), 2, 1, { k = 4 }, function(z) return { z[1], z[2] } end)
end)
raises("not transversal", function()
  calculus(dm.SE(2), 2, 1, { k = 6 }, function(z) return { z[1], z[2], z[4] } end)
end)
raises("isotropy group of dimension 1", function()
  calculus(dm.R(2), 2, nil, { k = 4 }, function(z) return { z[1], z[2] } end,
    nil, function(g, z) return { z[1] + g[1] + g[2], z[2] } end)
end)
raises("linear in an entry", function()
  calculus(dm.SE(2), 2, 1, { k = 5 }, function(z) return { z[1], z[2],
    z[3] * z[4] - z[3] ^ 3 - 1 } end)
end)
raises("'abs' has no exact formula",
  function() plane:euler_lagrange(function(J) return dm.abs(J.kappa[1]) end) end)
raises("divides by zero",
  function() plane:euler_lagrange(function(J) return J.kappa[1] / 0 end) end)
raises("left actions", function()
  dm.differential_invariants { action = dm.action { group = dm.SE(2), on = dm.R(2),
    side = "right" },
    independent = 1, cross_section = function(z) return { z[1], z[2], z[3] } end }
end)
raises("start.kappa must have 2 numbers, kappa, kappa_s", function()
  plane:extremal { L = bending, start = { kappa = { 1 } }, length = 1 }
end)
raises("option 'length' must be how far the curve goes, a number > 0 (got -1)", function()
  plane:extremal { L = bending, start = { kappa = { 1, 0 } }, length = -1 }
end)
raises("leaves kappa free", function()
  plane:extremal { L = function(J) return J.kappa[1] end, start = { kappa = {} }, length = 1 }
end)
raises("for curves", function() surface:conservation_law(function() return 1 end) end)
raises("jet", function() plane:conservation_law(bending):value { 1, 2 , 3, 4, 5, 6, "x" } end)
raises("independent", function() calculus(dm.SE(2), 2, 3, {}, function(z) return z end) end)
ok(exp(0) == 1, "done")

-- what stands for an invariant and its derivatives is no number
do
  local curves = dm.differential_invariants { action = dm.action { group = dm.SE(2), on = dm.R(2) }, independent = 1,
    invariants = { kappa = 4 }, cross_section = function(z) return { z[1], z[2], z[3] } end }
  for _, L in ipairs { function(I) return I.kappa ^ 2 end, function(I) return 2 * I.kappa end, function(I) return -I.kappa end,
    function(I) return 1 + I.kappa end, function(I) return I.kappa / 2 end } do
    tap.raises("I.kappa is kappa with its derivatives: the invariant itself is I.kappa[1]", curves.euler_lagrange, curves, L)
  end
  tap.ok(tostring(curves:syzygies()):find("^no syzygies: the invariants are free"), "no syzygies are told in a sentence")
  local wire = curves:extremal { L = function(I) return I.kappa[1] ^ 2 / 2 end, start = { kappa = { 0.5, 1 } }, length = 1, steps = 20 }
  tap.ok(not tostring(wire.path):find "energy", "an extremal's path speaks of no energy", tostring(wire.path))
  local real = dm.system { Q = dm.R(1), H = function(q, p) return q[1] * p[1] end }
    :solver { rule = "gauss(2)", h = 0.1 }:run { q = { 1 }, p = { 1 }, steps = 20 }
  tap.ok(tostring(real):find "energy off by", "that of an H with momenta does", tostring(real))
end

tap.done()
