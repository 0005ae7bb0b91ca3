-- means of discrete Lagrangians over groups, frequencies of runs
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, pi = math.cos, math.pi

local function own(Q, f) return dm.discrete_lagrangian { Q = Q, h = 0.1, Ld = function(a, b, h)
  local w = (b - a) / h
  return h * (w:dot(w) / 2 + f(a, b))
end } end
local function value(Ld, a, b) return Ld(a, b) end

-- means that are known
local mean = own(dm.R(2), function(a) return a[1] ^ 4 end):average(dm.SO(2), { points = 5 })
near(mean({ 1, 2 }, { 1, 2 }), 0.1 * 3 / 8 * 25, 1e-14, "SO(2): a1^4 becomes 3/8 |a|^4")
mean = own(dm.R(3), function(a) return a[1] ^ 4 end):average(dm.SO(3), { points = 5 })
near(mean({ 1, 2, 2 }, { 1, 2, 2 }), 0.1 * 81 / 5, 1e-13, "SO(3): 1/5 |a|^4")
mean = own(dm.R(3), function(a, b) return a[1] * b[2] end):average(dm.SO(3), { points = 3 })
near(value(mean, { 1, 2, 2 }, { 1, 2, 2 }), 0, 1e-14, "  a1 b2 becomes 0")
mean = own(dm.T(2), function(a) return cos(a[1]) + cos(a[1] - a[2]) end)
near(value(mean:average(dm.T(2), { points = 3 }), { 0.1, 0.2 }, { 0.1, 0.2 }), 0, 1e-15, "T^2: both angles")
local together = dm.action { group = dm.SO(2), on = dm.T(2), map = function(g, z) return { z[1] + g, z[2] + g } end }
near(value(mean:average(together, { points = 3 }), { 0.1, 0.3 }, { 0.1, 0.3 }), 0.1 * cos(0.2), 1e-15, "an action of one's own: one angle for both")
mean = own(dm.product(dm.R(2), dm.R(2)), function(a) return a[1] ^ 2 * a[3] ^ 2 end):average(dm.product(dm.SO(2), dm.SO(2)), { points = 3 })
near(value(mean, { 1, 0, 0, 2 }, { 1, 0, 0, 2 }), 0.1, 1e-15, "a product, factor by factor")

-- its steps keep what the group gives
local crooked = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 - 0.3 * q[1] * q[2] end }
local Ld = dm.discrete_lagrangian(crooked, { rule = "midpoint", h = 0.1 })
local path = Ld:average(dm.SO(2), { points = 4 }):solver {}:run { q0 = { 1, 0 }, q1 = { 1, 0.1 }, steps = 500 }
ok(path:drift(path:momentum(dm.SO(2))).largest < 1e-12, "steps of the mean keep the angular momentum")
path = Ld:solver {}:run { q0 = { 1, 0 }, q1 = { 1, 0.1 }, steps = 500 }
ok(path:drift(path:momentum(dm.SO(2))).largest > 0.1, "  those of Ld do not")

raises("take more points", function() return own(dm.R(2), function(a) return a[1] ^ 4 end):average(dm.SO(2), { points = 4 }) end)
raises("not compact", function() return Ld:average(dm.SE(2)) end)
-- stages are solved for inside: the mean over the angles one by one, and steps that keep the momentum
local quartic = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 - q[1] ^ 4 / 4 end }
for _, rule in ipairs { "gauss(2)", "galerkin(2, gauss(3))", "lobatto(3)" } do
  local given = dm.discrete_lagrangian(quartic, { rule = rule, h = 0.1 })
  local solved, sum = given:average(dm.SO(2), { points = 24 }), 0
  for k = 0, 23 do
    local c, s = cos(pi * k / 12), math.sin(pi * k / 12)
    sum = sum + given({ c - 0.2 * s, s + 0.2 * c }, { 0.9 * c - 0.35 * s, 0.9 * s + 0.35 * c }) / 24
  end
  near(solved({ 1, 0.2 }, { 0.9, 0.35 }), sum, 1e-14, "stages inside, " .. rule)
  local run = solved:solver {}:run { q0 = { 1, 0 }, q1 = { 1, 0.1 }, steps = 50 }
  ok(run:drift(run:momentum(dm.SO(2))).largest < 1e-13, "  the momentum stays", run:drift(run:momentum(dm.SO(2))).largest)
end
raises("'exact' is no formula", function() return dm.discrete_lagrangian(crooked, { rule = "exact", h = 0.1 }):average(dm.SO(2)) end)
raises("depends on time", function()
  local timed = dm.system { Q = dm.R(2), L = function(q, v, t) return v:dot(v) / 2 - t * q[1] ^ 2 end }
  return dm.discrete_lagrangian(timed, { rule = "gauss(2)", h = 0.1 }):average(dm.SO(2))
end)
raises("takes a group or an action", function() return Ld:average(3) end)
raises("action is on T^2", function() return Ld:average(together) end)
raises("unknown option 'point'", function() return Ld:average(dm.SO(2), { point = 3 }) end)
raises("elements", function() return own(dm.T(6), function() return 0 end):average(dm.T(6)) end)

-- frequencies
local spring = dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
  return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - 5e5 * q[1] ^ 2
end }
local T = 2 * pi / 1000
path = spring:solver { rule = "galerkin(3, gauss(3))", h = T / 200 }:run { q = { 0.02, 0.5 }, v = { 0, 0 }, steps = 2000 }
near(path:frequency "a", 1000, 0.1, "ten periods of a stiff spring")
local line = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local function run(h, steps) return line:solver { rule = "gauss(4)", h = h }:run { q = { 1 }, v = { 0.3 }, steps = steps } end
near(run(0.1, 3000):frequency "q1", 1, 1e-8, "fifty periods of an oscillator")
raises("has 1.6 periods", function() return run(0.1, 100):frequency "q1" end)
raises("does not resolve it", function() return run(2.9, 100):frequency "q1" end)
raises("too few", function() return run(0.1, 10):frequency "q1" end)
raises("is constant", function() return line:solver { rule = "gauss(4)", h = 0.1 }:run { q = { 0 }, v = { 0 }, steps = 100 }:frequency "q1" end)
raises("equally far apart", function() return line:solver { rule = "gauss(4)", h = 0.1 }:run { q = { 1 }, v = { 0 },
  at = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16.5 } }:frequency "q1" end)
tap.done()
