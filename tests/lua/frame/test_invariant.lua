-- invariant variational problems: the second way, both forms, constraints, ends, stability, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, atan, cos, max, sin, sqrt, tan = math.abs, math.atan, math.cos, math.max, math.sin,
  math.sqrt, math.tan

local line = dm.action { group = dm.SL(2), on = dm.R(1) }
local plane = dm.action { group = dm.SE(2), on = dm.R(2) }
local function of_step(h)
  return dm.moving_frame { action = line, points = 3,
    cross_section = function(a, b, c) return { a[1] + h, b[1], c[1] - h } end }
end
local planar = dm.moving_frame {
  action = plane, points = 2, cross_section = function(a, b) return { a[1], a[2], b[2] } end,
  branch = function(_, b) return b[1] end, invariants = { lambda = { 2, 1 }, sigma = { 3, 2 } } }

-- SL(2): the recurrence (6.4) of the thesis, derived by hand there, holds for the invariants that
-- are found
local h = 0.02
local schwarz = dm.invariant_problem { frame = of_step(1), invariants = { sigma = { 4, 1 } },
  L = function(I) return (I.sigma - 2) ^ 2 / h ^ 3 end }
local start = {}
for i = 0, 5 do start[i + 1] = tan(1.3 * i * h) + 0.1 * (i * h) ^ 2 * (1 + i * h) ^ 3 end
for _, form in ipairs { "points", "momentum" } do
  local curve, worst = schwarz:solve { points = start, n = 60, form = form }, 0
  local s = curve.invariants.sigma
  for i = 4, #s do
    local a, b, c, d = s[i], s[i - 1], s[i - 2], s[i - 3]
    worst = max(worst, abs(b / (b - 1) * (c - 1) / c * d * (d - 1) * (d - 2)
      - b / (b - 1) * (c ^ 2 - 1) * (c - 2)
      + (b + 1) * b * (b - 2) - a * (a - 1) * (a - 2)))
  end
  ok(worst < 2e-13 and #s >= 50, form .. ": (6.4) holds along the curve", worst)
  local J0, J1 = schwarz:momentum { curve.points[1][1], curve.points[2][1], curve.points[3][1],
    curve.points[4][1], curve.points[5][1], curve.points[6][1] },
    schwarz:momentum { curve.points[31][1], curve.points[32][1], curve.points[33][1],
    curve.points[34][1], curve.points[35][1], curve.points[36][1] }
  ok((J0 - J1):norm() < 1e-6 * J0:norm(),
    form .. ": the three momenta are kept, as far as the points tell", (J0 - J1):norm() / J0:norm())
  ok(abs(curve.points[6][1] - start[6]) < 1e-14 and curve.points.rows == 60,
    form .. ": it goes through what was given")
end

-- u = tan x: constant Schwarzian 2, an exact solution, through its poles; started from a frame and
-- its momentum
-- where sigma is that of a tangent, 1 + 1/cos(h sqrt(2 kappa)) (cross-ratio of four of its points)
local function exact_kappa(s)
  return (math.acos(1 / (s - 1)) / h) ^ 2 / 2
end
local x1 = dm.invariant_problem {
  frame = of_step(h), L = function(I) return (I[4][1] / h - 2) ^ 2 / h ^ 3 end }
local tangents = {}
for i = 0, 5 do tangents[i + 1] = tan(i * h) end
local curve = x1:solve { points = tangents, n = 200 }
local worst = 0
for i = 1, 200 do worst = max(worst, abs(sin(atan(curve.points[i][1]) - (i - 1) * h))) end
ok(worst < 1e-8, "tan x is followed through its pole", worst)
near(exact_kappa(x1:solve({ points = tangents, n = 7 }).points.rows == 7
  and of_step(1):invariants(tangents)[4][1]), 2, 1e-10, "its Schwarzian is 2")

-- elastica: the thesis' start from five points, order 2; both forms are the same equations
local function elastica(Lambda)
  return dm.invariant_problem { frame = planar,
    L = function(I) return I.sigma ^ 2 / I.lambda ^ 3 end,
    constraint = function(I) return I.lambda - Lambda end,
    inside = function(I) return 0.5 * I.lambda ^ 2 - I.sigma ^ 2 end }
end
-- kappa'' = -kappa^3/2, theta' = kappa, as second-order equations: kappa(0) = 0, kappa'(0) = 200
local N = 6400
local fine = dm.system { Q = dm.R(4), L = function(_, v) return v:dot(v) / 2 end,
  force = function(q, v) return { -q[1] ^ 3 / 2, v[1], -sin(q[2]) * q[1], cos(q[2]) * q[1] } end }
  :solver { rule = "gauss(5)", h = 1 / N }:run {
    q = { 0, 0, 0, 0 }, v = { 200, 0, 1, 0 }, steps = N, every = 1 }
local function reference(i, n) local q = fine.q[1 + i * N // n] return { q[3], q[4] } end
local function first(n)
  local out = {}
  for i = 0, 4 do out[i + 1] = reference(i, n) end
  return out
end
local errors = {}
for k, n in ipairs { 200, 400, 800 } do
  local c = elastica(1 / n):solve { points = first(n), n = n + 1 }
  errors[k] = 0
  for i = 0, n do
    local z = reference(i, n)
    errors[k] = max(errors[k], sqrt(
      (c.points[i + 1][1] - z[1]) ^ 2 + (c.points[i + 1][2] - z[2]) ^ 2))
  end
  if n == 400 then
    local other = elastica(1 / n):solve { points = first(n), n = n + 1, form = "points" }
    near(max(abs(other.points[n][1] - c.points[n][1]), abs(other.points[n][2] - c.points[n][2])), 0,
      1e-10, "both forms are the same equations")
    local chord, most = 0, 0
    for i = 5, n do
      chord = sqrt((c.points[i + 1][1] - c.points[i][1]) ^ 2
        + (c.points[i + 1][2] - c.points[i][2]) ^ 2)
      most = max(most, abs(chord * n - 1))
    end
    ok(most < 1e-12, "every chord has its length", most)
    ok(c.multiplier.rows > 390, "the multiplier comes with the curve")
    -- force and moment, the same along the strip
    local function J(i) -- at the points i ... i + 3
      local site = i + 1 - c.first_site + 1 -- the last window that they hold
      return elastica(1 / n):momentum({ c.points[i], c.points[i + 1], c.points[i + 2],
        c.points[i + 3] }, { c.multiplier[site - 1], c.multiplier[site] })
    end
    near((J(20) - J(300)):norm() / J(20):norm(), 0, 1e-9,
      "force and moment are the same along the strip")
  end
end
near(math.log(errors[1] / errors[2], 2), 2, 0.05, "elastica: order 2")
near(math.log(errors[2] / errors[3], 2), 2, 0.02, "and again")
local failed, failure = pcall(
  elastica(1 / 25).solve, elastica(1 / 25), { points = first(25), n = 26 })
ok(not failed and failure.code == "no_convergence" and #failure.path.points >= 8
  and tostring(failure):find "no root", "Lambda = 1/25: a failure with the points so far",
  tostring(failure))
near(failure.path.points[5][1], reference(4, 25)[1], 1e-14, "which begin with those given")

-- a frame that is declared on more points than its section looks at: the same curve
local three = dm.moving_frame {
  action = plane, points = 3, cross_section = function(a, b) return { a[1], a[2], b[2] } end,
  branch = function(_, b) return b[1] end,
  invariants = { lambda = { 2, 1 }, sigma = { 3, 2 } } }
local wide = dm.invariant_problem { action = plane, frame = three,
  L = function(I) return I.sigma ^ 2 / I.lambda ^ 3 end,
  constraint = function(I) return I.lambda - 1 / 200 end }
for _, form in ipairs { "points", "momentum" } do
  local a, b = wide:solve { points = first(200), n = 60, form = form },
    elastica(1 / 200):solve { points = first(200), n = 60 }
  near((a.points[60] - b.points[60]):norm(), 0, 1e-11,
    "points that the section does not look at are of no consequence, " .. form)
end
ok(wide:stability({ points = first(200) }).momentum ~= nil, "nor for the roots")

-- first order, both ways: the same sequence (Bogfjellmo leaves it open)
local spin = dm.action { group = dm.SO(2), on = dm.R(2) }
local polar = dm.moving_frame { action = spin, points = 1,
  cross_section = function(q) return q[2] end, branch = function(q) return q[1] end }
local step = 0.05
local function L(q0, q1)
  return (q1 - q0):dot(q1 - q0) / (2 * step)
    - step * (q0[1] ^ 4 + 0.3 * q1[2] ^ 2 + 0.2 * q0[1] * q1[2])
end
local one = dm.solver { polar:invariantize(
  dm.discrete_lagrangian { Q = dm.R(2), h = step, Ld = L }) }
  :run { q = { 1, 0.2 }, p = { 0.1, 0.8 }, steps = 400, every = 1 }
local way = dm.invariant_problem {
  frame = polar, points = 2, L = function(I) return L(I[1], I[2]) end }
for _, form in ipairs { "points", "momentum" } do
  local two, apart = way:solve { points = { one.q[1], one.q[2] }, n = 401, form = form }, 0
  for i = 1, 401 do apart = max(apart, (two.points[i] - one.q[i]):norm()) end
  ok(apart < 1e-10, "first order: both ways are one sequence, " .. form, apart)
end
-- geodesic sequences of the hyperbolic plane: SL(2) on the half-plane, the frame of a pair
local half = dm.action { group = dm.SL(2), on = dm.R(2), domain = function(z) return z[2] end,
  map = function(g, z)
  local a, b, c, d, x, y = g[1][1], g[1][2], g[2][1], g[2][2], z[1], z[2]
  local n = (c * x + d) ^ 2 + (c * y) ^ 2
  return { ((a * x + b) * (c * x + d) + a * c * y * y) / n, y / n }
end }
local upright = dm.moving_frame {
  action = half, points = 2, cross_section = function(a, b) return { a[1], a[2] - 1, b[1] } end,
  branch = function(_, b) return b[2] - 1 end }
local hyperbolic = dm.invariant_problem {
  frame = upright, points = 2, L = function(I) return (I[2][2] - 1) ^ 2 / (2 * I[2][2]) end }
local both = hyperbolic:both_ways { points = { { 0.1, 1 }, { 0.12, 1.01 } }, n = 100 }
ok(both.difference < 1e-12, "geodesics of the half-plane: both ways are one sequence",
  both.difference)
-- they lie on a circle about a point of the axis: x^2 + y^2 - 2 c x is the same
local P, c = both.second.points, nil
local function circle_of(i, j)
  return (P[j][1] ^ 2 + P[j][2] ^ 2 - P[i][1] ^ 2 - P[i][2] ^ 2) / (2 * (P[j][1] - P[i][1]))
end
c = circle_of(1, 50)
near(circle_of(50, 100), c, 1e-10 * abs(c), "which are circles across the axis")
raises("is for problems of two points",
  function() return schwarz:both_ways { points = start, n = 9 } end)

-- a frame that needs both points of the pair, so that the window is longer than L's
local pair = dm.invariant_problem { frame = planar, points = 2,
  L = function(I) return (I[2][1] - 1) ^ 2 + I[2][1] ^ 4 end, invariants = {} }
local straight = pair:solve { points = { { 0, 0 }, { 0.6, 0.8 }, { 1.2, 1.6 } }, n = 8 }
near(straight.points[8][1], 4.2, 1e-12, "a free particle under SE(2) goes straight")
near(straight.points[8][2], 5.6, 1e-12, "at its speed")

-- both ends given: harmonic sequences; Schwarzian with both ends; an arc of given chord
local shift = dm.moving_frame {
  action = dm.action { group = dm.R(1), on = dm.R(1) }, cross_section = function(a) return a end }
local harmonic = dm.invariant_problem {
  frame = shift, points = 2, L = function(I) return I[2][1] ^ 2 end }
near(harmonic:boundary({ first = { 0 }, last = { 3 }, n = 31, guess = sin }).points[11][1], 1,
  1e-14, "the shortest way is even")
near(harmonic:boundary({ first = { 2 }, last = {}, n = 9, guess = sin }).points[9][1], 2, 1e-14,
  "a free end has the natural condition")
local n, ends = 41, {}
for i = 1, 41 do ends[i] = tan((i - 1) / 40) end
local short = dm.invariant_problem {
  frame = of_step(1 / 40), L = function(I) return (40 * I[4][1] - 2) ^ 2 * 40 ^ 3 end }
local arc = short:boundary { first = { ends[1], ends[2], ends[3] },
  last = { ends[39], ends[40], ends[41] }, n = n,
  guess = function(i) return ends[i] + 0.01 * sin(3 * i / 40) * (i - 1) * (41 - i) / 1600 end }
worst = 0
for i = 1, n do worst = max(worst, abs(arc.points[i][1] - ends[i])) end
ok(worst < 1e-11, "tan x between its ends", worst)
local bow = elastica(0.05):boundary {
  first = { { 0, 0 }, { 0.05, 0 } }, last = { { 1.75, 0 }, { 1.8, 0 } }, n = 41,
  guess = function(i) return { 1.8 * (i - 1) / 40, 0.38 * sin(math.pi * (i - 1) / 40) ^ 2 } end }
local five = {}
for i = 1, 5 do five[i] = bow.points[i] end
near(bow.points[21][1], 0.9, 1e-11, "a bow between clamps has its top in the middle")
local shot = elastica(0.05):solve { points = five, n = 41 }
near((shot.points[41] - bow.points[41]):norm(), 0, 1e-7, "and is what its first points lead to")
near(sqrt((bow.points[21][1] - bow.points[20][1]) ^ 2
  + (bow.points[21][2] - bow.points[20][2]) ^ 2), 0.05, 1e-13, "its chords are those asked for")

-- stability: the triple root before anybody runs
local flat = {}
for i = 0, 5 do flat[i + 1] = i * h end
local roots = x1:stability { points = flat, steps = 256 }
ok(roots.constant and roots.points.multiplicity == 3 and roots.points.spread < 1e-3
  and roots.points.jordan, "SL(2) as printed: a triple root 1 in a Jordan block", roots.why)
near(roots.points.exponent, 2, 0.05, "its powers grow like n^2")
ok(roots.momentum.multiplicity == 3 and not roots.momentum.jordan
  and roots.momentum.growth < roots.points.growth / 1e4, "the form of momenta has no such block",
  roots.momentum.why)
ok(tostring(roots):find "n^3" ~= nil, "in words")
-- a stable problem by hand: u1 = 2 cos(w) u0 - u_-1 of the oscillator is not in question of groups;
-- its roots are on the circle
local w2 = 0.3
local circle = dm.invariant_problem { frame = polar, points = 2,
  L = function(I) return (I[2] - I[1]):dot(I[2] - I[1]) / 2 - w2 * I[1]:dot(I[1]) / 2 end }
local angle = math.acos(1 - w2 / 2)
local ring = circle:stability { points = { { 1, 0 }, { cos(angle), sin(angle) } } }
ok(ring.constant and abs(ring.points.largest - 1) < 1e-6, "a rotation of constant radius is a "
  .. "relative equilibrium with roots on the circle", ring.points.largest)
worst = 1
for i = 1, #ring.points.re do
  worst = math.min(worst, abs(ring.points.re[i] - cos(2 * angle))
    + abs(abs(ring.points.im[i]) - sin(2 * angle)))
end
ok(worst < 1e-10, "which turn by twice its angle", worst)

-- a constraint on one point alone: great circles of the sphere, SO(3) on R^3, frame of a pair
local turns = dm.moving_frame { action = dm.action { group = dm.SO(3), on = dm.R(3) }, points = 2,
  cross_section = function(a, b) return { a[2], a[3], b[3] } end,
  branch = function(a, b) return { a[1], b[2] } end }
local globe = dm.invariant_problem {
  frame = turns, points = 2, L = function(I) return (I[2] - I[1]):dot(I[2] - I[1]) / 2 end,
  constraint = function(I) return I[1]:dot(I[1]) - 1 end }
local way_round = globe:solve {
  points = { { 1, 0, 0 }, { cos(0.1), 0.6 * sin(0.1), 0.8 * sin(0.1) },
  { cos(0.2), 0.6 * sin(0.2), 0.8 * sin(0.2) } }, n = 41 }
near((way_round.points[41] - dm.vector { cos(4), 0.6 * sin(4), 0.8 * sin(4) }):norm(), 0, 1e-12,
  "free motion on the sphere is along a great circle, evenly")
raises("are not independent", function()
  return dm.invariant_problem { frame = dm.moving_frame {
    action = dm.action { group = dm.SO(3), on = dm.S(2) }, points = 2,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end }, points = 2,
    L = function(I) return I[2][1] end }
end)

---- misuse ----
raises("'frame' must be a moving frame", dm.invariant_problem, { frame = 3, L = print })
raises("L must return one value", dm.invariant_problem, { frame = planar,
  L = function(I) return I[2]:dot(I[2]), 1 end })
raises("option 'L' is missing: a function", dm.invariant_problem, { frame = planar })
raises("there is no invariant 'kappa'", dm.invariant_problem,
  { frame = planar, L = function(I) return I.kappa end })
raises("invariant 'd': there is no entry 1 of point 2 among", dm.invariant_problem,
  { frame = planar, L = function(I) return I.d end, invariants = { d = { "2", 1 } } })
raises("is L degenerate", function()
  return dm.invariant_problem { frame = planar, L = function(I) return I.lambda ^ 2 end,
    points = 3 }:solve { points = { { 0, 0 }, { 1, 0 }, { 2, 0.1 }, { 3, 0 } }, n = 8 }
end)
raises("unknown option 'lagrangian'", dm.invariant_problem, { frame = planar, lagrangian = print })
raises("'points' must be a whole number", dm.invariant_problem,
  { frame = planar, L = print, points = 1 })
raises("starts from 6 points (got 2)",
  function() return schwarz:solve { points = { 1, 2 }, n = 9 } end)
raises("starts from 5 points",
  function() return elastica(0.1):solve {
  points = { { 0, 0 }, { 0.1, 0 }, { 0.2, 0 }, { 0.3, 0 } }, n = 9 } end)
raises("'n', the number of points", function() return schwarz:solve { points = start } end)
raises("n = 3 is less than", function() return schwarz:solve { points = start, n = 3 } end)
raises("no moving frame near",
  function() return schwarz:solve { points = { 1, 1, 1, 2, 3, 4 }, n = 9 } end)
raises("unknown option 'steps'", function() return schwarz:solve { points = start, steps = 3 } end)
raises("must be \"momentum\" or \"points\"",
  function() return schwarz:solve { points = start, n = 9, form = "x" } end)
raises("with `momentum`, give 3 points",
  function() return schwarz:solve { points = { 1, 2 }, momentum = { 1, 2, 3 }, n = 9 } end)
raises("has dim G = 3 entries",
  function() return schwarz:solve { points = { 1, 2, 3 }, momentum = { 1 }, n = 9 } end)
raises("all points are given",
  function() return harmonic:boundary { first = { 0, 1 }, last = { 2 }, n = 3 } end)
raises("give a 'guess'", function() return harmonic:boundary {
  first = { 0 }, last = {}, n = 5 } end)
raises("the constraint does not depend on the points", dm.invariant_problem,
  { frame = planar, L = function(I) return I.sigma end, constraint = function() return 1 end })

-- points as rows of a matrix, such as those of another curve; as one flat list
do
  local space = dm.moving_frame { action = dm.action { group = dm.SO(3), on = dm.R(3) }, points = 2,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end }
  local central = dm.invariant_problem { frame = space, points = 2, L = function(I)
    local d = I[2] - I[1]
    return d:dot(d) / 2 - 0.01 / I[1]:norm()
  end }
  local first = central:solve { points = { 1, 0, 0, 1, 0.1, 0.05 }, n = 20 }
  local on = central:solve { points = first.points, n = 40 }
  near((dm.vector(on.points[40]) - central:solve {
    points = { { 1, 0, 0 }, { 1, 0.1, 0.05 } }, n = 40 }.points[40]):norm(), 0, 1e-12,
    "a curve goes on from the points of another")
  near((central:momentum(first.points) - central:momentum { { 1, 0, 0 }, { 1, 0.1, 0.05 } }):norm(),
    0, 1e-14, "momentum of the points of a curve")
  near(central:boundary { first = { 1, 0, 0 }, last = dm.matrix { on.points[40] },
    n = 40 }.points[20][2], on.points[20][2], 1e-11, "ends as a point, and as a matrix")
  ok(central:stability { points = on.points }.momentum.largest < 1.5,
    "residuals that cancel are not taken for a wrong trace")
  local ray = dm.moving_frame { action = dm.action { group = dm.R(1), on = dm.R(1) },
    cross_section = function(z) return z[1] end }
  local tied = dm.invariant_problem { frame = ray, points = 3,
    L = function(I) return I[3][1] ^ 2 end, constraint = function(I) return I[2][1] - 1 end }
  raises("starts from 4 with their `multiplier`s (5 points give 1 equations for 2", tied.solve,
    tied, { points = { 0, 1, 2, 3, 4 }, n = 9 })
end
-- a momentum of one entry as a number
do
  local ray = dm.moving_frame { action = dm.action { group = dm.R(1), on = dm.R(1) },
    cross_section = function(z) return z[1] end }
  local free = dm.invariant_problem { frame = ray, L = function(I) return I[2][1] ^ 2 / 2 end }
  near(free:solve { points = { 0 }, momentum = 0.3, n = 5 }.points[5][1], 1.2, 1e-14,
    "a start from a momentum that is a number")
end
-- a group of one's own has the sequences of the built-in one that it is
local matrices = dm.group { name = "motions", basis = { { { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 0 } },
  { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 0 } }, { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } } } }
local ends = {}
for k, G in ipairs { dm.SE(2), matrices } do
  local rho = dm.moving_frame { action = dm.action { group = G, on = dm.R(2),
    map = k == 2 and function(g, z)
      local w = g * dm.vector { z[1], z[2], 1 }
      return { w[1], w[2] }
    end or nil }, points = 2, cross_section = function(a, b) return { a[1], a[2], b[2] } end,
    branch = function(_, b) return b[1] end }
  ends[k] = dm.invariant_problem { frame = rho, points = 3, L = function(I)
    local r = I[2][1]
    return (r - 1) ^ 2 / 2 + 0.3 * (I[3][1] - 2) ^ 2 + 0.7 * I[3][2] ^ 2 + 0.2 * I[3][1] * r
  end }:solve({ points = { { 0, 0 }, { 1, 0.1 }, { 2, 0.1 }, { 3, 0.05 } }, n = 10 }).points:row(10)
end
near((ends[1] - ends[2]):norm(), 0, 1e-10, "a group of one's own in the second way")

tap.done()
