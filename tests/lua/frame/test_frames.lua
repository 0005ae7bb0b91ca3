-- moving frames: solved and given, their properties at random points, first way, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, atan, cos, exp, max, sin = math.abs, math.atan, math.cos, math.exp, math.max, math.sin
local frame = dm.moving_frame

-- rotations of the sphere about y^1, in the stereographic plane (Bogfjellmo 4.10)
local function turn(theta, w)
  local n = w:dot(w)
  local d = 1 + n - cos(theta) * (n - 1) - 2 * sin(theta) * w[2]
  return { 2 * w[1] / d, (-sin(theta) * (n - 1) + 2 * cos(theta) * w[2]) / d }
end
local sphere = dm.action { group = dm.SO(2), on = dm.R(2), map = turn }
local plane = dm.action { group = dm.SE(2), on = dm.R(2) }
local line = dm.action { group = dm.SL(2), on = dm.R(1) }
local scaling = dm.action { group = dm.product(dm.SO(2), dm.R(1)), on = dm.R(2),
  map = function(g, z)
  local c, s, e = cos(g[1]), sin(g[1]), exp(g[2][1])
  return { e * (c * z[1] - s * z[2]), e * (s * z[1] + c * z[2]) }
end }
local affine = dm.action { group = dm.semidirect(dm.GL(2), dm.R(2)), on = dm.R(2),
  map = function(g, z) return g[1] * z + g[2] end }

local function chord(a, b) return { a[1], a[2], b[2] } end
local function along(_, b) return b[1] end
local cases = {
  { "SO(2), stereographic", { action = sphere, points = 2,
  cross_section = function(a) return a:dot(a) - 1 end, branch = function(a) return a[2] end } },
  { "SE(2) on the plane", { action = plane, points = 2, cross_section = chord, branch = along } },
  { "SE(2), a right action", { action = dm.action { group = dm.SE(2), on = dm.R(2),
  side = "right" }, points = 2, cross_section = chord, branch = along } },
  { "SL(2) on the line", { action = line, points = 3,
  cross_section = function(a, b, c) return { a[1] + 1, b[1], c[1] - 1 } end } },
  { "SE(3) in space", { action = dm.action { group = dm.SE(3), on = dm.R(3) }, points = 3,
    cross_section = function(a, b, c) return { a[1], a[2], a[3], b[2], b[3], c[3] } end,
    branch = function(_, b, c) return { b[1], c[2] } end } },
  { "SO(3) in space", { action = dm.action { group = dm.SO(3), on = dm.R(3) }, points = 2,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end } },
  { "SO(3) on the sphere", { action = dm.action { group = dm.SO(3), on = dm.S(2) }, points = 2,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end } },
  { "GL(2) on the plane", { action = dm.action { group = dm.GL(2), on = dm.R(2) }, points = 2,
    cross_section = function(a, b) return { a[1] - 1, a[2], b[1], b[2] - 1 } end } },
  { "affine maps of the plane", { action = affine, points = 3,
    cross_section = function(a, b, c) return { a[1], a[2], b[1] - 1, b[2], c[1], c[2] - 1 } end } },
  { "the Heisenberg group", { action = dm.action { group = dm.Heisenberg(1), on = dm.R(3) },
  cross_section = function(a) return a end } },
  { "projective maps of the plane",
  { action = dm.action { group = dm.SL(3), on = dm.R(2) }, points = 4,
    cross_section = function(a, b, c, d) return {
    a[1], a[2], b[1] - 1, b[2], c[1], c[2] - 1, d[1] - 1, d[2] - 1 } end } },
  { "turns and scalings of pairs", { action = scaling:on_pairs(),
  cross_section = function(a) return { a[2], a:dot(a) - 1 } end,
  branch = function(a) return a[1] end } },
  { "SO(2) on tangent vectors", { action = dm.action { group = dm.SO(2), on = dm.R(2) }:tangent(),
    cross_section = function(z) return z[2] end, branch = function(z) return z[1] end } },
}
for _, case in ipairs(cases) do
  local defect, what = frame(case[2]):check()
  ok(defect < 1e-12 and what.samples == 8,
    case[1] .. ": equivariance, replacement, shifts and derivatives at random points", defect)
  ok(what.shift ~= nil and what.derivative ~= nil, case[1] .. ": both corrections were compared")
end

-- turns about one axis do not lead Newton's method to every branch
local four = frame { action = dm.action { group = dm.SO(4), on = dm.R(4) }, points = 3,
  cross_section = function(a, b, c) return { a[2], a[3], a[4], b[3], b[4], c[4] } end,
  branch = function(a, b, c) return { a[1], b[2], c[3] } end }
local J = four:invariants { { -2.22301, 1.32716, -7.0793, 3.7693 },
  { -0.120669, -2.09878, 1.9013, -2.09676 }, { 2.43149, -3.03629, -2.55405, -2.969 } }
near(J[1][1], dm.vector { -2.22301, 1.32716, -7.0793, 3.7693 }:norm(), 1e-13,
  "a frame of SO(4) far from the identity")

-- angles are compared by the circle: which turn the root is found in does not matter
local torus = frame { action = dm.action {
  group = dm.T(1), on = dm.T(2), map = function(g, z) return { z[1] + g[1], z[2] + 2 * g[1] } end },
  cross_section = function(z) return sin(z[1]) end, branch = function(z) return cos(z[1]) end }
ok(torus:check { samples = 40 } < 1e-12, "a frame on the torus", torus:check { samples = 40 })

-- given = solved, as what they do to points
local given = {
  { cases[1][2], function(w) return -atan(w:dot(w) - 1, 2 * w[2]) end },
  { cases[2][2], function(a, b)
    local theta = -atan(b[2] - a[2], b[1] - a[1])
    local c, s = cos(theta), sin(theta)
    return dm.vector { -c * a[1] + s * a[2], -s * a[1] - c * a[2], theta }
  end },
  { cases[4][2], function(u, v, w) -- (6.5), made unimodular
    local a, c, d = w[1] - u[1], w[1] - 2 * v[1] + u[1], w[1] * v[1] - 2 * w[1] * u[1] + v[1] * u[1]
    local b = -a * v[1]
    local k = dm.sqrt(a * d - b * c)
    return dm.matrix { { a / k, b / k }, { c / k, d / k } }
  end },
}
local places = { { { { 0.3, 0.4 }, { 0.5, 0.1 } }, { { -0.9, -0.2 }, { 1, 1 } },
  { { 0.2, -1.4 }, { 0, 0.3 } } },
  { { { 0.2, 0.1 }, { 0.5, 0.5 } }, { { 1, -2 }, { -1, -2.5 } }, { { 0, 0 }, { 0, -1 } } },
  { { 0.1, 0.5, 1.2 }, { -2, -1.9, -1.5 }, { 3, 4, 5.5 } } }
for i, row in ipairs(given) do
  local o = { solution = row[2] }
  for key, value in pairs(row[1]) do o[key] = value end
  local solved, formula, worst = frame(row[1]), frame(o), 0
  ok(formula:check() < 1e-12, "a given frame is one, case " .. i)
  for _, z in ipairs(places[i]) do
    local a, b, S, T = solved:invariants(z), formula:invariants(z), solved:tangent(table.unpack(z)),
      formula:tangent(table.unpack(z))
    for j = 1, #a do
      for k = 1, #a[j] do worst = max(worst, abs(a[j][k] - b[j][k])) end
      for k = 1, #T do worst = max(worst, abs(S[j][k] - T[j][k])) end
    end
  end
  ok(worst < 1e-13, "solved = given, case " .. i, worst)
end

-- a formula as the start of the root
local from_formula = { start = given[1][2] }
for key, value in pairs(given[1][1]) do from_formula[key] = value end
near((frame(from_formula):invariants(places[1][1])[2] - frame(given[1][1]):invariants(
  places[1][1])[2]):norm(), 0, 1e-15, "a start that is a function of the points")

-- closed forms: chord and bend; cross-ratio (6.6)
local planar = frame { action = plane, points = 3, cross_section = chord, branch = along }
local I = planar:invariants { { 0.2, 0.1 }, { 0.5, 0.5 }, { 0.4, 1.1 } }
near((planar:invariants { 0.2, 0.1, 0.5, 0.5, 0.4, 1.1 }[3] - I[3]):norm(), 0, 0,
  "points as one flat vector")
near(I[2][1], 0.5, 1e-15, "the chord length")
near(I[3][2], (1 * 0.3 - 0.2 * 0.4) / 0.5, 1e-15, "and the bend")
local moebius = frame(cases[4][2])
local u = { 0.1, 0.5, 1.2, 3 }
near(moebius:invariants(u)[4][1], (u[3] - u[1]) * (u[4] - u[2]) / (
  (u[4] - u[1]) * (u[3] - u[2]) - (u[4] - u[3]) * (u[2] - u[1])), 1e-14,
  "the fourth point is the cross-ratio of (6.6)")
-- P of (6.7), up to a factor; the corrections (5.3) with their printed sign put right
local s, P = moebius:invariants(u)[4][1], moebius:correction(table.unpack(u))
near(P[1][1] / P[1][2], -1, 1e-13, "the correction element has -1 in its first row")
near(P[2][1] / P[2][2], (s - 2) / s, 1e-13, "and (sigma - 2) / sigma in its second")
local C, change, moved = moebius:derivative_correction(u, { 0.7, -0.2, 0.4, 1 })
local m = { moved[1][1], moved[2][1], moved[3][1], moved[4][1] }
near(change[4][1], m[4] + (m[1] - m[3]) * s / 2 - m[2] - (m[3] - 2 * m[2] + m[1]) * s ^ 2 / 2,
  1e-13, "d sigma by (5.3)")
ok(#C == 3 and abs(change[1][1]) + abs(change[2][1]) + abs(change[3][1]) < 1e-14,
  "phantom invariants do not change")
local phantom = moebius:phantom(4)
ok(phantom[1][1] == -1 and phantom[2][1] == 0 and phantom[3][1] == 1 and phantom[4][1] == false,
  "which entries are constant")

-- frames on jets: turns and translations of curves y(x) with their slope; the third entry is the
-- slope at the point
local jets = frame { action = plane:jet(2, { independent = 1 }),
  cross_section = function(z) return { z[1], z[2], z[3] } end,
  branch = function(z) return z[4] end } -- half a turn changes the sign of the curvature of a graph
local z = jets:invariants { { 0.3, -0.2, 0.5, 0.8 } }[1]
near(z[4], 0.8 / (1 + 0.5 ^ 2) ^ 1.5, 1e-14, "the second derivative at the frame is the curvature")

-- first way: any Ld becomes invariant, what was invariant stays
local rho = frame(cases[1][2])
local function energy(a, b) return a:dot(b) + a[1] * b[2] - 0.2 * b[1] end
local F = rho:invariantize(energy)
local a, b, g = dm.vector { 0.3, 0.4 }, dm.vector { 0.5, 0.1 }, 0.4
near(F(a, b), F(sphere(g, a), sphere(g, b)), 1e-15, "an invariantized function is invariant")
near(rho:invariantize(F)(a, b), F(a, b), 1e-15, "and its own invariantization")
ok(abs(energy(a, b) - energy(sphere(g, a), sphere(g, b))) > 0.01, "it was not before")
local Ld0 = dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(q0, q1, h)
  return (q1 - q0):dot(q1 - q0) / (2 * h) - h / 8 * (q0 + q1):dot(q0 + q1) + 0.01 * q0[1]
end }
local Ld = rho:invariantize(Ld0)
ok(sphere:invariant(Ld) and not sphere:invariant(Ld0), "the action agrees")
local J0, J1 = Ld:momentum(sphere, a, b)[1], sphere:momentum(a, Ld:legendre_minus(a, b))[1]
near(J0, J1, 1e-14, "discrete Noether: the momentum of both ends")
-- time reparametrized: h = htilde sigma(q0), and what the symmetry leaves of it
local slow = rho:invariantize {
  Ld = Ld0, sigma = function(q) return 2 / (1 + q:dot(q)) end, H0 = 0.5 }
local n = rho:invariants { a, b }
local h = 0.1 * 2 / (1 + n[1]:dot(n[1]))
near(slow(a, b), Ld0.Ld(n[1], n[2], h) + 0.5 * h, 1e-15, "K = sigma (H - H0) by h = htilde sigma")

-- a rotation frame in a solver: momentum kept to round-off where the plain Ld loses it
local spin = dm.action { group = dm.SO(2), on = dm.R(2) }
local polar = frame { action = spin, points = 2, cross_section = function(q) return q[2] end,
  branch = function(q) return q[1] end }
local skew = dm.discrete_lagrangian { Q = dm.R(2), h = 0.05, Ld = function(q0, q1, h)
  return (q1 - q0):dot(q1 - q0) / (2 * h) - h / 2 * (1.1 * q0[1] ^ 2 + 0.9 * q0[2] ^ 2)
end }
local function drift(L)
  local path, worst = dm.solver { L }:run { q = { 1, 0 }, p = { 0.1, 0.8 }, steps = 400 }, 0
  local J = path:momentum(spin)
  for i = 1, #path do worst = max(worst, abs(J[i] - 0.8)) end
  return worst
end
ok(drift(skew) > 1e-3 and drift(polar:invariantize(skew)) < 1e-13,
  "invariantized: angular momentum to round-off", drift(polar:invariantize(skew)))

---- misuse ----
raises("no moving frame near z = (1, 0), (1, 0.1): the cross-section is not transversal",
  function() return rho:invariants { { 1, 0 }, { 1, 0.1 } } end)
raises("transversal", function() return frame { action = sphere, points = 2,
  cross_section = function() return 3 end }:invariants { { 0.3, 0.4 }, { 0.5, 0.1 } } end)
raises("has 2 equations, but the group has 3 dimensions", frame,
  { action = plane, points = 2, cross_section = function(a) return { a[1], a[2] } end })
raises("tangent", function() return frame {
  action = spin, cross_section = function(q) return q:dot(q) - 1 end }:invariants { { 1, 0 } } end)
raises("nowhere transversal to the orbits", frame,
  { action = spin, cross_section = function(q) return q:dot(q) + 1 end })
raises("have 2 dimensions, the group has 3: no cross-section crosses them once; take more points "
  .. "(points = 2)",
  frame, { action = plane, cross_section = function(q) return { q[1], q[2], q[1] } end })
raises("have 2 dimensions, the group has 3", frame, { action = dm.action {
  group = dm.SO(3), on = dm.R(3) }, cross_section = function(q) return q end })
raises("have 3 dimensions, the group has 6", frame,
  { action = dm.action { group = dm.SE(3), on = dm.R(3) },
  solution = function() return dm.SE(3):identity() end,
  cross_section = function(q) return { q[1], q[2], q[3], 0, 0, 0 } end })
raises("is no element of SO(3): its columns are off", frame, { points = 2,
  action = dm.action { group = dm.SO(3), on = dm.R(3) },
  cross_section = function(a, b) return { a[2], a[3], b[3] } end,
  solution = function() return { { 2, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } end })
raises("compares the frame of points 1 to 2 with that of points 2 to 3, so it takes 3 points (got "
  .. "2)", function() return rho:correction({ 1, 2 }, { 1, 3 }) end)
raises("is made of 2 points (got 1)", function() return rho { 1, 2 } end)
raises("point 2 must have 2 entries", function() return rho({ 1, 2 }, { 1, 2, 3 }) end)
raises("the branch condition does not hold", function()
  return frame { action = spin, solution = function(q) return math.pi - atan(q[2], q[1]) end,
    cross_section = function(q) return q[2] end,
    branch = function(q) return q[1] end }:invariants { { 1, 0.3 } }
end)
raises("not on the cross-section", function()
  return frame { action = spin, solution = function() return 0 end,
    cross_section = function(q) return q[2] end }:invariants { { 1, 0.3 } }
end)
raises("unknown option 'section'", frame, { action = spin, section = 1 })
raises("'action' must be a dm.action", frame, { action = 3, cross_section = print })
raises("on 2 points already", frame,
  { action = plane:on_pairs(), points = 3, cross_section = chord })
raises("this frame needs 3", function() return moebius:invariantize(Ld0) end)
raises("on a space of dimension 1", function()
  return frame { action = dm.action { group = dm.R(1), on = dm.R(1) },
    cross_section = function(x) return x end }:invariantize(Ld0)
end)
raises("write Ld as a function of (q0, q1, h)", function()
  return rho:invariantize { Ld = dm.discrete_lagrangian {
    Q = dm.R(2), h = 1, Ld = function(x, y) return x:dot(y) end }, sigma = function() return 1 end }
end)
-- near a fixed point a given frame is refused as a solved one is, before its digits are gone
do
  local function rotate(theta, w)
    local n = w:dot(w)
    local d = 1 + n - math.cos(theta) * (n - 1) - 2 * math.sin(theta) * w[2]
    return { 2 * w[1] / d, (-math.sin(theta) * (n - 1) + 2 * math.cos(theta) * w[2]) / d }
  end
  local given = dm.moving_frame {
    action = dm.action { group = dm.SO(2), on = dm.R(2), map = rotate }, points = 2,
    cross_section = function(w) return { w:dot(w) - 1 } end, branch = function(w) return w[2] end,
    solution = function(w) return -dm.atan(w:dot(w) - 1, 2 * w[2]) end }
  local function second(e) return given:invariants { { 1 + e, 0.3 * e }, { 1, 0.1 } }[2][1] end
  near(second(1e-8), second(1e-6), 1e-8, "near the fixed point the invariants go on")
  for _, e in ipairs { 1e-11, 1e-13, 1e-15, 0 } do raises("not transversal", second, e) end
end

-- a matrix is the list of its rows; several values are as good as a list
do
  local space = dm.action { group = dm.SE(3), on = dm.R(3) }
  local rho = dm.moving_frame { action = space, points = 3,
    cross_section = function(a, b, c) return a[1], a[2], a[3], b[2], b[3], c[3] end,
    branch = function(_, b, c) return b[1], c[2] end }
  near(rho:check(), 0, 1e-12, "all conditions of a branch that returns several numbers are kept")
  local rows = { { 1, 2, 3 }, { 2, 2, 4 }, { 0, 1, 5 } }
  near((rho:invariants(dm.matrix(rows))[3] - rho:invariants(rows)[3]):norm(), 0, 0,
    "the points of a frame as rows of a matrix")
  -- time that would run backwards
  local circle = dm.moving_frame {
    action = dm.action { group = dm.SO(2), on = dm.R(2) }, points = 2,
    cross_section = function(a) return a[2] end, branch = function(a) return a[1] end }
  local Ld = dm.discrete_lagrangian {
    Q = dm.R(2), h = 0.1, Ld = function(a, b, h) return (b - a):dot(b - a) / (2 * h) end }
  local back = circle:invariantize { Ld = Ld, sigma = function(q) return -q:norm() end }
  raises("not_finite\nNaN", function()
    local fine, failure = pcall(function() return dm.solver { back }:run {
      q = { 1, 0 }, p = { 0, 1 }, steps = 3 } end)
    error(fine and "it runs" or failure.code .. "\n" .. tostring(failure):match "NaN", 0)
  end)
end

-- rotations of a sphere in its stereographic plane or space: points near the pole are far away, and
-- a pole of Z is no root of it
for n, count in pairs { [3] = 150, [4] = 25 } do
  local m = n - 1
  local rho = frame { action = dm.action { group = dm.SO(n), on = dm.R(m) }, points = m,
    cross_section = function(...)
      local out = {}
      for k, z in ipairs { ... } do
        for j = k, m do out[#out + 1] = z[j] end
      end
      return out
    end,
    branch = function(...)
      local out = {}
      for k = 2, m do out[k - 1] = select(k, ...)[k - 1] end
      return out
    end }
  local random, off, missing = dm.random(3), 0, 0
  for i = 1, count do
    local list = {}
    for k = 1, m do
      list[k] = {}
      for j = 1, m do list[k][j] = 5 * random:normal(i, 10 * k + j) end
    end
    local fine, I = pcall(rho.invariants, rho, list)
    if not fine then missing = missing + 1 end
    -- the chordal distance of two points of the sphere, 2 |a - b|/sqrt((1 + a^2)(1 + b^2)), does
    -- not change
    local a, b = dm.vector(list[1]), dm.vector(list[2])
    if fine then
      off = max(off, abs((a - b):norm() / ((1 + a:dot(a)) * (1 + b:dot(b))) ^ 0.5
        - I[2]:norm() / (1 + I[2]:dot(I[2])) ^ 0.5))
    end
  end
  ok(missing == 0, ("SO(%d), stereographic: a frame at %d random points"):format(n, count), missing)
  ok(off < 1e-13, ("SO(%d): it keeps distances on the sphere"):format(n), off)
end

tap.done()
