-- docs/failures.md, line by line: where each method fails, measured, beside the theory
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, sin, cos, pi, abs, huge = math.sqrt, math.sin, math.cos, math.pi, math.abs, math.huge

local function with(a, b)
  local out = {}
  for key, value in pairs(a) do out[key] = value end
  for key, value in pairs(b) do out[key] = value end
  return out
end
local function within(a, b, part, sentence) tap.ok(abs(a / b - 1) < part, sentence, ("%.6g against %.6g"):format(a, b)) end

---- oscillators ----

local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local map = spring:stability { rules = { "verlet", "lobatto(3)", "midpoint", "gauss(2)", "rkf45" }, h = { 0.05, 1e3, 80, "log" }, q = { 1 }, v = { 0 }, steps = 3000 }
within(map:limit { rule = "verlet" }, 2, 0.005, "Verlet: h omega = 2")
within(map:limit { rule = "lobatto(3)" }, sqrt(8), 0.005, "Lobatto 3: h omega = sqrt 8")
ok(map:limit { rule = "midpoint" } == huge and map:limit { rule = "gauss(2)" } == huge, "midpoint and Gauss: no limit up to h omega = 1000")
ok(map:at({ rule = "lobatto(3)" }, 3.2).class ~= "bounded" and map:at({ rule = "lobatto(3)" }, 4).class == "bounded", "Lobatto 3 is stable again between sqrt 12 and sqrt 24")
ok(map:at({ rule = "rkf45" }, 0.8).class ~= "bounded", "GSL's rkf45 gains energy from small steps on", map:at({ rule = "rkf45" }, 0.8).why)

-- a resonance at h omega = pi of a composition of order 6: a window a thousandth wide, which a coarse look passes over
local _, told = dm.stability_limit "blanes-moan(6)"
local gap = told.gaps[1]
local here = spring:stability { rule = "blanes-moan(6)", h = { gap[1] - 2e-3, (gap[1] + gap[2]) / 2, gap[2] + 2e-3 }, q = { 1 }, v = { 0.5 }, steps = 400000, refine = false, chaos = false }
ok(here:at(1, 1).class == "bounded" and here:at(1, 2).class ~= "bounded" and here:at(1, 3).class == "bounded", "Blanes-Moan 6: a narrow window of growth at h omega = pi", here:at(1, 2).why)

---- the stiff spring in two dimensions ----

local function stiff(k)
  return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
end
local swing = { q = { sin(1), -cos(1) }, v = { 0, 0 }, steps = 2000, chaos = false }
local rules = { "verlet", "yoshida(4)", "suzuki(4)", "blanes-moan(4)", "kahan-li(6)", "blanes-moan(6)", "blanes-moan(6, 14)", "suzuki-umeno(8)", "sofroniou-spaletta(10)", "rk4" }
map = stiff(1e6):stability(with(swing, { rules = rules, h = { 1.4e-3, 1.1e-2, 24, "log" } }))
for i, rule in ipairs(rules) do
  -- windows of a hundredth are found between the columns; the narrowest grow too slowly to be seen
  local gaps, wide = select(2, dm.stability_limit(rule)).gaps, nil
  for _, gap in ipairs(gaps) do wide = wide or gap[2] > 1.01 * gap[1] and gap[1] end
  within(map:limit(i) * 1e3, wide, 0.03, ("stiff spring, %s: h sqrt(k) = %.4g, the first wide window"):format(rule, map:limit(i) * 1e3))
  within(map:theory(i) * 1e3, gaps[1][1], 1e-3, "and theory stops at the first one, however narrow")
end
within(map:limit(1) * 1e3, 2, 0.01, "of which Verlet's is 2"); within(map:limit(2) * 1e3, 1.5734, 0.01, "and Yoshida's 1.5734")
-- the midpoint rule has no linear limit, but the rod of a pendulum swings through its chords: step equations with several solutions
for _, k in ipairs { 1e4, 1e6 } do
  local c = k ^ 0.25
  map = stiff(k):stability(with(swing, { rule = "midpoint", h = { 0.5 / c, 2 / c, 21, "log" } }))
  within(map:limit(1) * c, 1.015, 0.05, ("midpoint on the stiff spring, k = %.0e: h k^(1/4) = %.4g"):format(k, map:limit(1) * c))
end
local rigid = stiff(1e6):solver({ rule = "midpoint", h = 0.02 }):run { q = swing.q, v = swing.v, steps = swing.steps }
local stretch = 0
for i = 1, #rigid do stretch = math.max(stretch, abs(rigid.q[i]:norm() - 1)) end
ok(stretch < 1e-3, "at h sqrt k = 20 the rod keeps its length", stretch)
map = stiff(1e6):stability(with(swing, { rule = "midpoint", h = 4e-3 }))
ok(map:at(1, 1).class == "bounded", "far below it is fine at h sqrt k = 4", map:at(1, 1).why)

---- Kepler at fixed steps ----

local function kepler_map(e, rule, lo, hi, columns, aside, refine)
  local turn = sqrt(1 + e) / (1 - e) ^ 1.5  -- rad per unit of time at the pericentre
  local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  return kepler:stability { rule = rule, h = { lo / turn, hi / turn, columns, "log" }, q = { 1 - e, aside or 0 }, v = { 0, sqrt((1 + e) / (1 - e)) },
    t = 200 * pi, chaos = false, refine = refine, inside = function(q) return 4 - q:norm() end }, turn
end
local function kepler_limit(e, rule, aside)
  local of_rule, turn = kepler_map(e, rule, 0.5, 2, 15, aside)
  return of_rule:limit(1) * turn
end
for _, case in ipairs { { 0.3, "verlet" }, { 0.6, "verlet" }, { 0.6, "yoshida(4)" } } do
  local turn = kepler_limit(case[1], case[2])
  ok(turn > 0.8 and turn < 1.3, ("Kepler e = %.1f, %s: leaves the ellipse when a step turns about 1 rad at the pericentre"):format(case[1], case[2]), turn)
end
-- others bear a little more, as docs/failures.md says
near(kepler_limit(0.6, "midpoint") / 5, 0.24, 0.02, "Kepler e = 0.6, midpoint: up to h = 0.24")
-- gauss(2) leaves the ellipse by chance, between 0.27 and 0.33 from starts 1e-13 apart: their median
local turns = {}
for i = 1, 5 do turns[i] = kepler_limit(0.6, "gauss(2)", 1e-13 * i) end
table.sort(turns)
near(turns[3] / 5, 0.30, 0.02, "Kepler e = 0.6, gauss(2): up to h = 0.3")
-- kahan-li(6) drifts or leaves from 0.3 on, at some h and not at others
local lost = { 0, 0 }
for i = 1, 5 do
  map = kepler_map(0.6, "kahan-li(6)", 1.4, 2.3, 2, 1e-13 * i, false)
  for j = 1, 2 do lost[j] = lost[j] + (map:at(1, j).class == "wrong" and 0 or 1) end
end
ok(lost[1] == 0 and lost[2] >= 4, "Kepler e = 0.6, kahan-li(6): never at h = 0.28, nearly always at 0.46", lost[1] .. " and " .. lost[2])
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local orbit = { q = { 0.4, 0 }, v = { 0, 2 }, t = 200 * pi }
map = kepler:stability(with(orbit, { rules = { "rk4", "rk8", "verlet", "gauss(2)" }, h = 0.1, chaos = false }))
ok(map:at(1, 1).class == "drifting" and map:at(2, 1).class == "drifting", "explicit Runge-Kutta methods drift", map:at(1, 1).why .. " " .. map:at(2, 1).why)
ok(map:at(3, 1).class == "wrong" and map:at(4, 1).class == "wrong", "Verlet and Gauss do not: bounded, but late or early after a hundred turns", map:at(4, 1).why)
raises("not finite", function() error((select(2, pcall(function()
  kepler:solver({ rule = "log-hamiltonian", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1.5 }, steps = 10000 }
end))).code:gsub("_", " ")) end)

-- Newton's method stopped by a tolerance: what round-off kept is lost to the tolerance
local function momentum_lost(tolerance)
  local path = kepler:solver({ rule = "midpoint", h = 0.1, newton = { tolerance = tolerance } }):run(with(orbit, { every = 100 }))
  local J = path:momentum(dm.SO(2))
  return abs(J[#J] - J[1])
end
ok(momentum_lost(4e-15) < 1e-13 and momentum_lost(1e-3) > 1e-8, "a loose Newton loses the angular momentum of the midpoint rule", momentum_lost(1e-3))

---- step-size resonances ----

-- Verlet on q'' = -q - q^2 has a period of 3 steps a, a, b with b = c - a, c = (3 - h^2)/h^2, h^2 a^2 + (h^2 - 2) a + c = 0; at b it is at rest
local function third(h)
  local c, d = (3 - h * h) / (h * h), h * h - 2
  return c - (-d + sqrt(d * d - 4 * h * h * c)) / (2 * h * h)
end
local well = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 - q[1] ^ 3 / 3 end }
local function amplitude(h, side)
  return (well:stability { rule = "verlet", h = h, a = { 1e-4, 0.45, 30, "log" }, q = function(a) return { side * a } end, v = { 0 }, steps = 20000, chaos = false }:limit(1))
end
for _, h in ipairs { 1.7, 1.72, 1.74, 1.76, 1.8 } do
  local b = third(h)
  within(amplitude(h, b > 0 and 1 or -1), abs(b), 0.02, ("resonance at h omega = sqrt 3: at h = %g stable up to the period of 3 steps, %.4f"):format(h, b))
end
ok(amplitude(sqrt(3), 1) < 1e-3 and amplitude(1, 1) > 0.4, "at h = sqrt 3 nothing is stable, at h = 1 most of the well", amplitude(1, 1))

---- implicit steps without a solution ----

local cubic = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 3 / 3 end }
local fold = cubic:solver({ rule = "midpoint", h = 0.1 }):fold { q = { 1 }, v = { 0 } }
near(fold.h, 1, 1e-8, "midpoint on q'' = q^2 from rest at 1: no step beyond h = 1 (closed form)"); ok(fold.fold, "since two solutions meet", fold.why)
raises("did not converge", function() cubic:solver({ rule = "midpoint", h = 1.01 }):step { q = { 1 }, v = { 0 } } end)
-- the angle of a discrete free rotor: r0 r1 sin psi = mu h has no root beyond mu h = r0 r1
local psi = dm.root { equations = function(y, mh) return { math.sin(y[1]) - mh[1] } end, start = { 0 } }
near(psi { 0.999 }[1], math.asin(0.999), 1e-12, "psi of a discrete reduction up to mu h = r0 r1")
raises("no value", function() psi { 1.001 } end)

---- coordinates ----

local angles = dm.system { Q = dm.R(2), coordinates = { "theta", "phi" }, L = function(q, v) return (v[1] ^ 2 + sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * cos(q[1]) end }
angles = dm.system(with(angles.given, { L = function(q, v) return (v[1] ^ 2 + math.sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * math.cos(q[1]) end }))
local pole = angles:solver({ rule = "gauss(2)", h = 0.01 }):singularities { q = { 1, 0 }, v = { 0, 1e-4 }, t = 5 }
ok(pole.why:find "'phi'", "spherical angles at the pole", pole.why)
ok(pole.worst > 5e3 and pole.worst < 5e4, "pass so near that the mass matrix has condition 10^4", pole.worst)
local rod = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - 9.81 * q[3] end, constraint = function(q) return { q:dot(q) - 1 } end }
-- Euler's angles of a free body near theta = 0, where phi and psi are one turn
local euler = dm.system { Q = dm.R(3), coordinates = { "phi", "theta", "psi" }, L = function(q, v)
  local th = q[2]
  return (v[2] ^ 2 + v[1] ^ 2 * math.sin(th) ^ 2 + (v[3] + v[1] * math.cos(th)) ^ 2) / 2
end }
local gimbal = euler:solver({ rule = "gauss(2)", h = 0.001 }):singularities { q = { 0, 1, 0 }, v = { 0, -1, 0 }, t = 0.999 }
ok(gimbal.worst > 1e4 and gimbal.why:find("'phi' and 'psi' move the same there", 1, true), "two angles that become one are named", gimbal.why)
local regular = rod:solver({ rule = "gauss(2)", h = 0.01 }):singularities { q = { sin(1), 0, -cos(1) }, v = { 0, 1e-4, 0 }, t = 5 }
ok(#regular.places == 0, "the same pendulum in R^3 passes", regular.why)
-- reduced: the hidden angle turns v^2/mu rad per unit of time at the bottom, and a step must follow it
local speed = 2 * 9.81 * (1 - cos(1))
for _, mu in ipairs { 0.1, 0.01 } do
  local turn = angles:routh({ cyclic = { "phi" }, mu = mu }):stability { rule = "verlet", h = { 1e-2 * mu, mu, 20, "log" }, q = { 1 }, v = { 0 }, t = 10, chaos = false }:limit(1) * speed / mu
  ok(turn > 0.5 and turn < 1.3, ("reduced by its symmetry at mu = %g: a step may turn the hidden angle by about 1 rad"):format(mu), turn)
end
local polar = dm.system { Q = dm.R(2), coordinates = { "r", "phi" }, L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 - q[1] ^ 2 / 2 end }
near(polar:routh({ cyclic = { "phi" }, mu = 0.1 }):locked_inertia({ 0 })[1][1], 0, 0, "no inertia of the group where the bodies are in line with its axis")
raises("infinite at the start", function() polar:routh({ cyclic = { "phi" }, mu = 0.1 }):solver({ rule = "midpoint", h = 0.01 }):run { q = { 0 }, v = { 1 }, steps = 1 } end)

---- rolling, recurrences, chaos ----

local function contact(shift)
  return dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 + shift * math.sin(q[3]) * v[3] end,
    rolling = function(q, v) return v[1] + q[2] * v[3] end }
end
local function drift_of(shift)
  return contact(shift):solver({ rule = "midpoint", h = 2 * sin(pi / 40) }):run({ q = { sqrt(1.5), 1, -sqrt(0.5) }, v = { 0, 0, 0 }, steps = 10000 }):drift "energy".per_time
end
ok(abs(drift_of(1)) > 10 * abs(drift_of(0)), "a nonholonomic system that hides its reversal drifts", ("%g, %g"):format(drift_of(1), drift_of(0)))
-- SL(2), the Schwarzian: the tool finds the triple root of its own recurrence (Bogfjellmo 2011, 6.1)
local width = 0.01
local rho = dm.moving_frame { action = dm.action { group = dm.SL(2), on = dm.R(1) }, points = 3,
  cross_section = function(a, b, c) return { a[1] + width, b[1], c[1] - width } end,
  solution = function(a, b, c)
    local u, v, w = a[1], b[1], c[1]
    return dm.matrix { { width * (w - u), -width * (w - u) * v }, { (w - v) - (v - u), (w - u) * v - 2 * u * (w - v) } } / dm.sqrt(2 * width * (w - u) * (w - v) * (v - u))
  end }
local schwarzian = dm.invariant_problem { frame = rho, L = function(I) return (I[4][1] - 2 * I[3][1] + I[2][1]) ^ 2 / (width ^ 2 * 0.01 ^ 3) end }
local said = schwarzian:stability { points = { 0, 0.01, 0.02, 0.03, 0.04, 0.05 }, steps = 64 }.why
ok(said:find "root 3 times" and said:find "n%^2", "the SL(2) recurrence has a triple root 1", said)
-- SE(2), the elastica: at chords of 1/25 no bend solves the scalar equation where the strip turns most; what was found is kept
local function elastica(n)
  local fine = 8 * n
  local strip = dm.system { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 end,
    force = function(q, v) return { -q[1] ^ 3 / 2, v[1], -math.sin(q[2]) * q[1], math.cos(q[2]) * q[1] } end }
    :solver({ rule = "gauss(5)", h = 1 / fine }):run { q = { 0, 0, 0, 0 }, v = { 200, 0, 1, 0 }, steps = fine }
  local first = {}
  for i = 0, 4 do first[i + 1] = { strip.q[1 + 8 * i][3], strip.q[1 + 8 * i][4] } end
  local frame = dm.moving_frame { action = dm.action { group = dm.SE(2), on = dm.R(2) }, points = 2,
    cross_section = function(a, b) return { a[1], a[2], b[2] } end, branch = function(a, b) return b[1] end }
  return dm.invariant_problem { frame = frame, invariants = { lambda = { 2, 1 }, sigma = { 3, 2 } }, L = function(I) return I.sigma ^ 2 / I.lambda ^ 3 end,
    constraint = function(I) return I.lambda - 1 / n end, inside = function(I) return I.lambda ^ 2 / 2 - I.sigma ^ 2 end }:solve { points = first, n = n + 1 }
end
local found, broken = pcall(elastica, 25)
ok(not found and broken.code == "no_convergence" and #broken.path > 5, "the elastica at 1/25: no root, and the points so far", not found and tostring(broken))
ok(pcall(elastica, 50), "at 1/50 there is one")
local recurrence = dm.recurrence { -1, 3, -3, 1 }
ok(not recurrence.stable and recurrence.why:find "multiplicity 3", "a triple root 1: round-off grows like k^2", recurrence.why)
local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q:dot(q) / 2 + q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
raises("disagree", function() henon:chart { q = { 0, -0.016 }, p = { 0.49974, 0 }, t = 2000, rules = { "verlet" }, h = { 0.05 }, samples = 4, repeats = 1 } end)
-- constraints that become one; forces beside an L linear in v
local crossing = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end,
  rolling = function(x, v) return { v[1] - x[3] * v[2], v[1] + x[3] * v[2] } end }
local held, met = pcall(function() crossing:solver({ rule = "midpoint", h = 0.1 }):run { q = { 0, 0, 1 }, v = { 0, 0, -1 }, steps = 30 } end)
tap.ok(not held and met.code == "singular" and met.rolling == 2 and met.step == 10, "conditions that become one are named", met)
tap.raises("no rule steps such a system", function()
  dm.system({ Q = dm.R(2), L = function(q, v) return q[1] * v[2] - q:dot(q) / 2 end, force = function(q) return -0.1 * q end })
    :solver({ rule = "degenerate(2)", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 0 }, steps = 1 }
end)
-- fields: growth beyond the CFL limit, on a line and on a mesh; even rings; ends for another speed
local CELLS = 40
local function string_of(options)
  options.L = function(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
  options.x = options.x or { 0, 1, CELLS, periodic = true }
  return dm.field(options)
end
local function zigzag(x) return 1e-3 * (-1) ^ math.floor(x * CELLS + 0.5) end
for lambda, grows in pairs { [0.99] = false, [1.05] = true } do
  local u = string_of({}):solver({ rule = "cell(corners)", h = lambda / CELLS }):run { u = zigzag, steps = 40 }.u
  local largest = math.max(math.abs(u[41][1]), math.abs(u[40][1]))
  local by = u[41][1] / u[40][1]
  if grows then
    tap.near(-by, (lambda + math.sqrt(lambda ^ 2 - 1)) ^ 2, 1e-9, "a string beyond its limit grows by")
  else
    ok(largest < 1.1e-3, "a string below its limit does not grow", largest)
  end
end
local membrane = dm.mesh { grid = 8 }:field { form = 0, fixed = "boundary",
  L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
local most = membrane:stability_limit "verlet"
local function sizes(part, steps)
  local rough = { q = function(x, y) return math.sin(37 * x) * math.sin(29 * y) end, v = function() return 0 end }
  rough.steps, rough.every = 2 * steps, steps
  local q = membrane:solver({ rule = "verlet", h = part * most }):run(rough).q
  return q[2]:norm(), q[3]:norm()
end
local middle, last = sizes(0.999, 1000)
ok(middle < 10 and last < 10, "a membrane below its limit stays", last)
middle, last = sizes(1.001, 150)
tap.near((last / middle) ^ (1 / 150), (1.001 + math.sqrt(1.001 ^ 2 - 1)) ^ 2, 1e-3, "beyond it it grows by")
raises("even", function()
  dm.multisymplectic({ x = { 0, 1, 20, periodic = true }, names = { "u", "v", "w" },
    M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = function(z) return z.v ^ 2 / 2 - z.w ^ 2 / 2 + z.u ^ 2 / 2 end }):solver { h = 0.1 }
end)
tap.near(string_of({ x = { 0, 1, 40 }, absorbing = 2 }):reflection().left, -1 / 3, 1e-15, "ends for twice the impedance")

---- dry friction: a force that jumps ----

local function rubbed(force) return dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end, force = force } end
local function at_rest(force, rule, h)
  local path = rubbed(force):solver { rule = rule, h = h }:run { q = { 1.05 }, v = { 0 }, t = 25 }
  return path.q[#path][1]
end
local function jump(_, v) return dm.where(v[1], -0.1, 0.1) end
local function steep(_, v) return -0.1 * dm.tanh(v[1] / 1e-3) end
for _, rule in ipairs { "midpoint", "gauss(2)", "gauss(3)", "lobatto(3)" } do
  raises("the force has a branch (dm.where): where it jumps", at_rest, jump, rule, 0.01)
  tap.near(at_rest(steep, rule, 0.01), -0.0452, 5e-5, rule .. " takes a steep force, and creeps")
end
tap.near(at_rest(jump, "rk4", 0.01), -0.05, 1.2e-3, "rk4 takes the jump")

-- a watched column that is NaN ends the run at that row: cos(t) is below 0 behind t = pi/2
local swing = dm.system({ Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }):solver { rule = "verlet", h = 0.1 }
local function logarithm(q) return math.log(q[1]) end
for name, case in pairs { watch = { { watch = { "q1", ln = logarithm } }, "'ln'", 16, 16 },
  record = { { record = { "energy", pair = function(q) return { q[1], math.log(q[1]) } end } }, "'pair2'", 16, 16 },
  ["every = 7"] = { { watch = { ln = logarithm }, every = 7 }, "'ln'", 21, 3 } } do
  local options, column, step, rows = table.unpack(case)
  options.q, options.v, options.steps = { 1 }, { 0 }, 100
  local fine, e = pcall(swing.run, swing, options)
  tap.ok(not fine and e.code == "no_value" and tostring(e):find(column, 1, true) and e.step == step and math.abs(e.time - step / 10) < 1e-12,
    name .. ": column, step and time of a NaN are named", e)
  tap.ok(#e.path == rows and e.path.steps == step, name .. ": the rows before it are kept", e.path)
end
raises("step 0, t = 0.0", swing.run, swing, { q = { -1 }, v = { 0 }, steps = 3, watch = { ln = logarithm } })
tap.ok(swing:run({ q = { 0 }, v = { 0 }, steps = 3, watch = { ln = logarithm } }):column("ln")[4] == -math.huge, "an infinite number is one")
local gaps = swing:run { q = { 1 }, v = { 0 }, steps = 20, gaps = true, watch = { ln = logarithm } }:column "ln"
tap.ok(gaps[17] ~= gaps[17] and gaps[16] == gaps[16] and #gaps == 21, "gaps = true keeps NaN")
raises("'gaps' must be true or false", swing.run, swing, { q = { 1 }, v = { 0 }, steps = 3, gaps = 1, watch = { ln = logarithm } })
for _, rule in ipairs { "verlet", "gauss(2)", "rk8" } do -- in lanes and alone
  local function members(more)
    local options = { members = 9, q = function(i) return { i < 5 and 1 or 0.1 } end, v = function(i) return { i < 5 and 0 or 0.2 } end, steps = 16, every = 1,
      watch = { ln = logarithm } }
    for key, value in pairs(more) do options[key] = value end
    return swing.system:solver({ rule = rule, h = 0.1 }):ensemble(options)
  end
  local e = members {}
  tap.ok(e.status[1] == "no_value" and e.steps[1] == 16 and #e:path(1) == 16 and e.status[9] == "ok", rule .. ": a member whose column is NaN fails alone", e)
  tap.ok(e:failures()[1].message:find "a recorded column is NaN", rule .. ": and says why", e:failures()[1].message)
  tap.ok(members({ gaps = true }).status[1] == "ok", rule .. ": but with gaps")
  local last = members { every = 7 } -- the row of the last step is one more
  tap.ok(last.status[1] == "no_value" and #last:path(1) == 3 and last.status[9] == "ok" and last.steps[9] == 16,
    rule .. ": also in the row of the last step alone", last)
end

-- printing raises nothing that the functions of a system raise by now
_G.stiffness = 2
local own = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - stiffness * q[1] ^ 2 / 2 end }
local tied = dm.system { Q = dm.R(2), L = function(_, v) return stiffness * v:dot(v) / 2 end, constraint = function(q) return q[1] end }
local printed = own:solver { rule = "gauss(2)", h = 0.1 }
local rows = printed:run { q = { 1 }, v = { 0 }, steps = 10 }
_G.stiffness = nil
for _, x in ipairs { own, tied, printed } do
  tap.ok(tostring(x):find "fail now: .*global 'stiffness'", "a system whose global is gone says so", tostring(x))
end
tap.ok(tostring(rows):find "path of 10 steps", "a path of it prints", tostring(rows))

-- a mass with a pole: no run is behind it (docs/failures.md; before, of 100: 5, 19, 1, 2)
for _, rule in ipairs { "lobatto(3)", "trapezoidal", "gauss(3)", "rk8" } do
  local random, drawn, behind = dm.random(3), 0, 0
  local function between(a, b) drawn = drawn + 1 return a + (b - a) * random:uniform(drawn, 0) end
  for k = 1, 100 do
    local a = between(0.2, 2)
    local pole = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / (2 * (1 - q[1] ^ 2) ^ 2) - a * q[1] end }
    local start = { q = { between(-0.9, 0.9) }, v = { between(-0.5, 0.5) }, steps = 60 }
    local fine, result = pcall(function() return pole:solver({ rule = rule, h = ({ 0.05, 0.1, 0.2, 0.4 })[k % 4 + 1] }):run(start) end)
    for i = 1, fine and #result or 0 do
      if math.abs(result.q[i][1]) > 1 then behind = behind + 1 break end
    end
  end
  tap.ok(behind == 0, rule .. ": none of 100 runs is behind a pole of the mass without a word", behind)
end
tap.done()
