-- what the figures of the chapter show in numbers (Leok 2.2-2.5, 2.8), and property tests on them: momentum to the last bit, the form on S x S,
-- the printed magnetic form, tableaus that are refused
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sqrt, sin, cos = math.abs, math.sqrt, math.sin, math.cos

-- 2.2 to 2.5: the band of the reduced curve over 300 units, exact and by the midpoint rule: { J2, rule, h, least distance, most, energy error at most }
for _, case in ipairs { { 0, "gauss(6)", 0.1, 1, 1, 1e-14 }, { 0.05, "gauss(6)", 0.1, 0.8549, 1, 1e-14 }, { 0, "gauss(1)", 0.3, 0.99555, 1.00047, 9.1e-6 },
  { 0.05, "gauss(1)", 0.3, 0.8498, 1, 1.0e-3 } } do
  local J2, rule, h, inner, outer, energy = table.unpack(case)
  local path = models.satellite(J2):routh({ cyclic = 1, mu = 0.96 }):solver({ rule = rule, h = h }):run { q = { 1, 0 }, v = { 0, 0.28 }, t = 300 }
  local E, least, most, off = path:energy(), math.huge, 0, 0
  for i = 1, #path do
    local rho = path.q[i]:norm()
    least, most, off = math.min(least, rho), math.max(most, rho), math.max(off, abs(E[i] / E[1] - 1))
  end
  near(abs(least - inner) + abs(most - outer), 0, 1e-4, ("%s, h = %g, J2 = %g: the band"):format(rule, h, J2))
  ok(off <= energy, "and its energy", off)
end
-- crossings of the equator going up: a point without J2, a closed curve around it with (spec 2.1)
local cuts = models.satellite(0.05):routh({ cyclic = 1, mu = 0.96 }):solver({ rule = "gauss(4)", h = 0.05 }):run { q = { 1, 0 }, v = { 0, 0.28 }, t = 2000 }
local low, high, least, most, last = math.huge, 0, 0, 0, nil
for i = 1, #cuts do
  local q, p = cuts.q[i], cuts.p[i]
  if last and last[2] < 0 and q[2] >= 0 then
    local s = -last[2] / (q[2] - last[2])
    local r, pr = last[1] + s * (q[1] - last[1]), last.p + s * (p[1] - last.p)
    low, high, least, most = math.min(low, r), math.max(high, r), math.min(least, pr), math.max(most, pr)
  end
  last = { q[1], q[2], p = p[1] }
end
near(low, 0.8562, 1e-3, "section z = 0: least r"); near(high, 1, 1e-3, "most r"); near(least, -0.0774, 1e-3, "least p_r"); near(most, 0.0773, 1e-3, "most p_r")

-- 3.1: an angle that is a coordinate has its momentum to the last bit
for _, rule in ipairs { "gauss(1)", "gauss(2)", "gauss(3)", "lobatto(2)", "lobatto(3)" } do
  local path, off = models.satellite(0.05):solver({ rule = rule, h = 0.3 }):run { q = models.orbit.q, v = models.orbit.v, steps = 1000 }, 0
  for i = 1, #path do off = math.max(off, abs(path.p[i][1] - 0.96)) end
  ok(off <= 2 ^ -52, rule .. ": p_theta over 1000 steps, 0 or 1 ulp", off)
end

-- the double spherical pendulum away from its poles: gauss(2) after ten steps, its energy over 4000 (spec 4, 2.2)
local pendulum, safe = models.pendulum(), models.safe
local shape = pendulum:routh { cyclic = 1, q = safe.q, v = safe.v }
local x, u, theta = shape:start(safe.q, safe.v)
local path = shape:solver({ rule = "gauss(2)", h = 0.05 }):run { q = x, v = u, steps = 4000 }
local ten = shape:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = x, v = u, steps = 10 }):reconstruct({ theta = theta }).q[11]
near((ten - dm.vector { 1.87890503025272675, 0.693175148762185209, 0.483415090759976111, -0.527884160103264339 }):norm(), 0, 1e-13, "after ten steps")
near((shape:magnetic_momentum(path.q[11], path.p[11]) - dm.vector { 0.935416886733567775, 0.713457270009167694, 0.0264201908138473651 }):norm(), 0, 1e-12,
  "with its momenta")
local E, off, halves = path:energy(), 0, { 0, 0 }
for i = 1, #E do
  local d = abs(E[i] / E[1] - 1)
  off = math.max(off, d)
  halves[i <= 2000 and 1 or 2] = halves[i <= 2000 and 1 or 2] + d
end
ok(off <= 2.1e-6 and abs(halves[1] / halves[2] - 1) < 0.01, "energy over 200 s: bounded, the second half like the first", off)

-- 3.10: the magnetic form as printed is that of the connection without its dr terms: off by 0.62 at t = 1, whatever the step
local mu, m1, m2 = shape:reduction().mu[1], models.m1, models.m2
local function truncated(at)  -- d(mu A), A = m2 (r2^2 + r1 r2 cos phi)/I dphi
  return function(y)
    local r1, r2, c = y[1], y[2], cos(y[3])
    local I, N = m1 * r1 ^ 2 + m2 * (r1 ^ 2 + r2 ^ 2 + 2 * r1 * r2 * c), r2 ^ 2 + r1 * r2 * c
    local by1 = at * m2 * (r2 * c * I - N * 2 * (m1 * r1 + m2 * (r1 + r2 * c))) / I ^ 2
    local by2 = at * m2 * ((2 * r2 + r1 * c) * I - N * 2 * m2 * (r2 + r1 * c)) / I ^ 2
    return { { 0, 0, by1 }, { 0, 0, by2 }, { -by1, -by2, 0 } }
  end
end
local pole = { models.near_pole.q[2], models.near_pole.q[3], models.near_pole.q[4] }
local printed = pendulum:routh { cyclic = 1, mu = 3.1095, connection = function(y)
  return { 0, 0, m2 * (y[2] ^ 2 + y[1] * y[2] * cos(y[3])) / (m1 * y[1] ^ 2 + m2 * (y[1] ^ 2 + y[2] ^ 2 + 2 * y[1] * y[2] * cos(y[3]))) }
end }
near(truncated(3.1095)(pole)[3][1], 1.41289646845904610, 1e-12, "the printed form at the start near a pole")
near(printed:curvature(pole)[3][1], 1.41289646845904610, 1e-12, "which is the curvature of the connection without its dr terms")
for _, h in ipairs { 0.05, 0.025 } do
  local steps = math.floor(1 / h + 0.5)
  local step = shape:rsprk { rule = "gauss(2)", h = h, beta = truncated(mu) }
  local a, s = x, shape:magnetic_momentum(x, shape:legendre(x, u))
  for _ = 1, steps do a, s = step(a, s) end
  local right = shape:solver({ rule = "gauss(2)", h = h }):run({ q = x, v = u, steps = steps }).q[steps + 1]
  local gap = 0
  for j = 1, 3 do gap = math.max(gap, abs(a[j] - right[j])) end
  near(gap, 0.62, 0.01, "the printed form is wrong by O(1) at h = " .. h)
end

-- 3.6: the discrete Routh equations keep W_x0x1 dx0 ^ dx1 (Cartesian midpoint rule, derivative of the step by differences of order 4)
local J2 = 0.05
local cartesian = dm.system { Q = dm.R(3), L = function(p, w)
  local rho = p:norm()
  return w:dot(w) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * p[3] ^ 2 / rho ^ 2 - 0.5)
end }
local plane = cartesian:routh { mu = 0.96, section = function(y) return { y[1], 0, y[2] } end,
  action = function(t, p) return { cos(t) * p[1] - sin(t) * p[2], sin(t) * p[1] + cos(t) * p[2], p[3] } end }
local D = plane:discrete(dm.discrete_lagrangian(cartesian, { rule = "midpoint", h = 0.3 }))
local z, e = { 1, 0, 0.95, 0.08 }, 1e-3  -- x0, x1
local function next_of(y)
  local x2 = D:step({ y[1], y[2] }, { y[3], y[4] })
  return { y[3], y[4], x2[1], x2[2] }
end
local columns, after = {}, next_of(z)
for k = 1, 4 do
  columns[k] = { 0, 0, 0, 0 }
  for _, w in ipairs { { 1, 8 / 12 }, { -1, -8 / 12 }, { 2, -1 / 12 }, { -2, 1 / 12 } } do
    local y = table.move(z, 1, 4, 1, {})
    y[k] = y[k] + w[1] * e
    local there = next_of(y)
    for i = 1, 4 do columns[k][i] = columns[k][i] + w[2] * there[i] / e end
  end
end
local function form(W, a, b)
  local sum = 0
  for i = 1, 2 do for k = 1, 2 do sum = sum + W[i][k] * (a[i] * b[2 + k] - b[i] * a[2 + k]) end end
  return sum
end
local W0, W1, worst, size = D:two_form({ z[1], z[2] }, { z[3], z[4] }), D:two_form({ after[1], after[2] }, { after[3], after[4] }), 0, 0
for i = 1, 4 do
  for k = 1, 4 do
    local a, b = { 0, 0, 0, 0 }, { 0, 0, 0, 0 }
    a[i], b[k] = 1, 1
    worst = math.max(worst, abs(form(W1, columns[i], columns[k]) - form(W0, a, b)))
    size = math.max(size, abs(form(W0, a, b)))
  end
end
ok(size > 1 and worst < 1e-9, "the discrete Routh equations keep their form on S x S", worst)

-- 3.7: lobatto(2) at t = 3
local exact = { -0.798046910427261695, -0.280882551050369038, -0.130326311987126223 }
local function error_of(steps)
  local p = models.satellite(J2):routh({ cyclic = 1, mu = 0.96 }):solver({ rule = "lobatto(2)", h = 3 / steps }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = steps }
  local q = p:reconstruct().q[steps + 1]
  return math.max(abs(q[2] * cos(q[1]) - exact[1]), abs(q[2] * sin(q[1]) - exact[2]), abs(q[3] - exact[3]))
end
near(error_of(10), 1.08e-2, 1e-4, "lobatto(2): the error at t = 3"); near(math.log(error_of(20) / error_of(40), 2), 2, 0.1, "and its order")

-- other coordinates, other points: the Cartesian midpoint rule beside the cylindrical one, apart by the order of both (Leok 2.9.6)
local function apart(steps)
  local h = 3 / steps
  local a = models.satellite(J2):routh({ cyclic = 1, mu = 0.96 }):solver({ rule = "midpoint", h = h }):run({ q = { 1, 0 }, v = { 0, 0.28 }, steps = steps }).q[steps + 1]
  local b = cartesian:solver({ rule = "midpoint", h = h }):run({ q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, steps = steps }).q[steps + 1]
  return abs(a[1] - sqrt(b[1] ^ 2 + b[2] ^ 2)) + abs(a[2] - b[3])
end
ok(apart(10) > 1e-3, "Cartesian steps have other reduced points", apart(10)); near(math.log(apart(40) / apart(80), 2), 2, 0.1, "apart by the order of the rule")

-- rods as constraints: the trapezoidal rule after ten steps by four names, and past the pole where the chart ends (spec 4, 2.2)
local l1, l2, g = models.l1, models.l2, models.g
local ambient = dm.system { Q = dm.R(6), L = function(p, w)
  local b = (w[1] + w[4]) ^ 2 + (w[2] + w[5]) ^ 2 + (w[3] + w[6]) ^ 2
  return m1 * (w[1] ^ 2 + w[2] ^ 2 + w[3] ^ 2) / 2 + m2 * b / 2 - m1 * g * p[3] - m2 * g * (p[3] + p[6])
end, constraint = function(p) return { (p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2 - l1 ^ 2) / 2, (p[4] ^ 2 + p[5] ^ 2 + p[6] ^ 2 - l2 ^ 2) / 2 } end }
local start = { q = { 0.6, 0, -0.8, 0.27, 0.36, -0.6 }, v = { 0.4, 1.2, 0.3, -0.64, -0.02, -0.3 } }
local wanted = dm.vector { 0.60579018825290294, 0.130205165646526727, -0.784897995063991072, 0.227682293074725703, 0.330183927935511475, -0.633750224578509855 }
for _, rule in ipairs { "rattle", "shake", "trapezoidal", "lobatto(2)" } do
  local last = ambient:solver({ rule = rule, h = 0.01 }):run({ q = start.q, v = start.v, steps = 10 }).q[11]
  near((last - wanted):norm(), 0, 1e-14, rule .. ": constrained, ten steps")
end
local past = ambient:solver({ rule = "trapezoidal", h = 0.02 }):run { q = start.q, v = start.v, steps = 2000, project = true }
local spread = 0
for _, now in ipairs(past:energy():totable()) do spread = math.max(spread, abs(now / -33.4825 - 1)) end
ok(spread < 3.3e-4 and past:worst "constraint" < 1e-14, "goes past the pole, with its energy", spread)

-- 3.20: tableaus that are not symplectic, with the place
local a2 = { { 0.25, 0.25 - sqrt(3) / 6 }, { 0.25 + sqrt(3) / 6, 0.25 } }
local rk4 = { { 0, 0, 0, 0 }, { 0.5, 0, 0, 0 }, { 0, 0.5, 0, 0 }, { 0, 0, 1, 0 } }
raises("at i = 1, j = 2", function() shape:rsprk { h = 0.1, a = rk4, A = rk4, b = { 1 / 6, 1 / 3, 1 / 3, 1 / 6 } } end)
raises("at i = 2, j = 1", function() shape:rsprk { h = 0.1, a = a2, A = { a2[1], { a2[2][1] + 1e-9, 0.25 } }, b = { 0.5, 0.5 } } end)
raises("the weight b_2 is zero", function() shape:rsprk { h = 0.1, a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 1, 0 } } end)
raises("must add up to 1", function() shape:rsprk { h = 0.1, a = a2, b = { 0.5, 0.6 } } end)

tap.done()
