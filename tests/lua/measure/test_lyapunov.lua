-- several exponents at once: known rates, their sum, pairs of a Hamiltonian flow, long times
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

-- two pendulums upside down: rates +-1 and +-1/2, for ever
local tops = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 - math.cos(q[1]) - math.cos(q[2]) / 4
end }:solver { rule = "gauss(4)", h = 0.1 }
local still = { 0, 0 }
local all = tops:lyapunov { q = still, v = still, t = 1000, exponents = 4 }
for i, rate in ipairs { 1, 0.5, -0.5, -1 } do near(all.exponents[i], rate, 2e-3, "rate " .. rate) end
near(all.sum, 0, 1e-12, "volumes are kept")
ok(all.exponent == all.exponents[1], "the first one is the largest")
local long = tops:lyapunov { q = still, v = still, t = 2e4 }
near(long.exponent, 1, 1e-4, "a vector that would grow by e^20000")
ok(#long.history.t == 1000, "a row every thousandth of the time, however short the blocks")
near(long.megno, 2e4 / 2, 10, "MEGNO grows by half of the exponent")

-- MEGNO from its definition, by the growth of every step
local few = tops:lyapunov { q = { 0.3, 0.1 }, v = { 0, 0.2 }, t = 8, every = 1 }.history
local sum, mean, Y = 0, 0, 0
for i = 1, #few.t do
  local s, t = i > 1 and few.t[i - 1] or 0, few.t[i]
  sum = sum + (few.exponent[i] * t - (i > 1 and few.exponent[i - 1] * s or 0)) * (t + s) / 2
  mean, Y = mean + (Y + 2 * sum / t) / 2 * (t - s), 2 * sum / t
end
near(few.megno[#few.t], mean / few.t[#few.t], 1e-13, "MEGNO is the mean of 2/t int s d ln|u|")

-- a million steps, growth by e^100000 and e^1000: of verlet's own map on a hill, 2 cosh(rate h) = 2 + (w h)^2
for _, c in ipairs { { 1e-2 }, { 1e-6, 2 } } do
  local hill = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 + c[1] * q[1] ^ 2) / 2 end }:solver { rule = "verlet", h = 1 }
  local last = hill:lyapunov { q = { 0 }, v = { 0 }, t = 1e6, exponents = c[2] }
  near(last.exponent, 2 * math.log(math.sqrt(c[1]) / 2 + math.sqrt(1 + c[1] / 4)), 1e-5, "growth is taken off as it comes, over t = 1e6")
  if c[2] then near(last.sum, 0, 1e-12, "and decay with it") end
end

-- exponents of a chaotic flow come in pairs
local henon = dm.system { Q = dm.R(2), L = function(q, v)
  return (v:dot(v) - q:dot(q)) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3
end }:solver { rule = "verlet", h = 0.05 }
local start = { q = { 0, 0.1 }, v = { 0.5603570290448759, 0.1 }, t = 1000 }
start.exponents = 4
local pairs_ = henon:lyapunov(start).exponents
near(pairs_[1] + pairs_[4], 0, 2e-3, "the largest and the least are opposite")
near(pairs_[2] + pairs_[3], 0, 2e-3, "the two in the middle as well")
ok(pairs_[1] > 0.05, "chaos", pairs_[1])
start.t = 100 -- blocks of other lengths round differently, and chaos makes the most of it
local together = henon:lyapunov(start).exponents[1]
start.exponents = nil
near(henon:lyapunov(start).exponent, together, 1e-6, "alone it is the same one")

-- friction: volumes shrink at its rate, whatever the orbit does
for _, c in ipairs { 0.1, 0.4 } do
  local duffing = dm.system { Q = dm.R(1), L = function(q, v, t)
    return (v[1] ^ 2 + q[1] ^ 2) / 2 - q[1] ^ 4 / 4 + 0.3 * math.cos(1.2 * t) * q[1]
  end, force = function(_, v) return -c * v end }:solver { rule = "gauss(4)", h = 0.05 }
  near(duffing:lyapunov { q = { 0.5 }, v = { 0 }, t = 300, exponents = 2 }.sum, -c, 1e-7, "the rate of friction")
end

-- under a constraint there are as many vectors as the surface has tangent directions
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end,
  constraint = function(q) return { q:dot(q) - 1 } end }:solver { rule = "rattle", h = 0.05 }
local swing = { q = { 0.6, -0.8 }, v = { 0.8, 0.6 }, t = 100, exponents = 2 }
ok(math.abs(rod:lyapunov(swing).exponents[1]) < 0.06, "a pendulum is not chaotic")
swing.exponents = 3
raises("only 2 independent", rod.lyapunov, rod, swing)
swing.exponents = 5
raises("from 1 to 4", rod.lyapunov, rod, swing)
raises("every", rod.lyapunov, rod, { q = { 0.6, -0.8 }, v = { 0.8, 0.6 }, t = 1, every = 0 })
-- a mass that depends on q: large tangent vectors hide the sign of d2L/dv2, not the motion
local double = dm.system { Q = dm.R(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * dm.cos(q[1] - q[2]) + 9.81 * (2 * dm.cos(q[1]) + dm.cos(q[2]))
end }
local both = double:solver { rule = "midpoint", h = 0.01 }:lyapunov { q = { math.pi / 2, math.pi / 2 }, v = { 0, 0 }, t = 200 }
ok(both.exponent > 0.5 and both.exponent < 1.5, "double pendulum over long blocks", both.exponent)
local rods = dm.system { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 - 9.81 * (q[2] + q[4]) end,
  constraint = function(q) return { q[1] ^ 2 + q[2] ^ 2 - 1, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - 1 } end }
local level = rods:solver { rule = "rattle", h = 0.005 }:lyapunov { q = { 1, 0, 2, 0 }, v = { 0, 0, 0, 0 }, t = 20, exponents = 4 }
near(level.sum, 0, 1e-9, "level rods, whose tangents are along axes: Liouville's volume on the surface is kept")
ok(level.exponents[1] > 0.3, "and they are chaotic", level.exponents[1])
swing.exponents, swing.t = 2, 10
for _, rule in ipairs { "rattle", "shake", "gauss(2)", "lobatto(3)" } do
  local both = rod.system:solver { rule = rule, h = 0.05 }:lyapunov(swing)
  near(both.sum, 0, 1e-12, "a rod after ten seconds: " .. rule)
  near(both.exponent, both.exponents[1], 1e-12, "by one length: " .. rule)
end
local arm = dm.system { Q = dm.SO(3), L = function(g, xi) return (xi[1] ^ 2 + 2 * xi[2] ^ 2 + 3 * xi[3] ^ 2) / 2 - g[3][3] end,
  constraint = function(g) return { g[1][3] } end }
near(arm:solver { rule = "lie(2)", h = 0.05 }:lyapunov { q = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, v = { 0.3, 0, 0.7 },
  t = 10, exponents = 4 }.sum, 0, 1e-12, "a joint on SO(3)")
-- saddles and an oscillator that do not see each other: vectors along axes would keep the rate of another one for ln(1e16) / 2.8
local apart = dm.system { Q = dm.R(3), L = function(q, v)
  return v:dot(v) / 2 + (9 * q[1] ^ 2 + 0.04 * q[2] ^ 2 - 4 * q[3] ^ 2) / 2
end }:solver { rule = "verlet", h = 0.02 }:lyapunov { q = { 0, 0, 0.1 }, v = { 0, 0, 0 }, t = 300, exponents = 6 }
for i, rate in ipairs { 3, 0.2, 0, 0, -0.2, -3 } do near(apart.exponents[i], rate, 5e-3, "by itself " .. rate) end
-- the same in any units of mass and time
for _, c in ipairs { { 1e-8, 1 }, { 1e8, 1 }, { 1, 1e8 }, { 1, 1e-8 } } do
  local m, w = c[1], c[2]
  local units = dm.system { Q = dm.R(1), L = function(q, v) return m * (v[1] ^ 2 + w ^ 2 * q[1] ^ 2) / 2 end }
    :solver { rule = "gauss(4)", h = 0.1 / w }:lyapunov { q = { 0 }, v = { 0 }, t = 200 / w, exponents = 2 }
  near(units.exponents[1] / w, 1, 0.05, ("mass %g, rate %g"):format(m, w))
  near(units.sum / w, 0, 1e-12, "and its opposite")
end
-- Lorenz's flow x' = f(x) as x'' = f'(x) x', on x' = f(x): his exponents and three zeros; the sum is that of the divergence
local function lorenz_force(q, v)
  return { 10 * (v[2] - v[1]), v[1] * (28 - q[3]) - q[1] * v[3] - v[2], v[1] * q[2] + q[1] * v[2] - 8 / 3 * v[3] }
end
local x, y, z = -5.76, -10.0, 12.0
local lorenz = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end, force = lorenz_force }:solver { rule = "rk8", h = 0.01 }
  :lyapunov { q = { x, y, z }, v = { 10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z }, t = 200, exponents = 6 }
near(lorenz.exponents[1], 0.906, 0.06, "Lorenz: the largest")
near(lorenz.exponents[6], -14.572, 0.06, "Lorenz: the least")
near(lorenz.sum, -41 / 3, 2e-3, "Lorenz: volumes shrink by 41/3")
-- orbits beside unlike vectors differ by rounding, which chaos makes much of in a long block
local driven = dm.system { Q = dm.R(1), L = function(q, v, t)
  return v[1] ^ 2 / 2 + q[1] ^ 2 / 2 - q[1] ^ 4 / 4 + 0.3 * math.cos(t) * q[1]
end, force = function(_, v) return -0.25 * v end }
near(driven:solver { rule = "gauss(2)", h = 0.02 }:lyapunov { q = { 1 }, v = { 0 }, t = 5000, exponents = 2 }.sum, -0.25, 1e-6,
  "friction in chaos")
tap.done()
