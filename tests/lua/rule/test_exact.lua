-- exact discrete Lagrangians, and what those of rules are off by
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin, pi = math.cos, math.sin, math.pi

local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local double = dm.system { Q = dm.R(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 9.81 * (2 * cos(q[1]) + cos(q[2]))
end }
local function exact(system, h) return dm.discrete_lagrangian(system, { rule = "exact", h = h }) end

-- closed forms, also beyond the first conjugate time
for _, h in ipairs { 0.01, 1.3, 4, 20, 60 } do
  local Ld = exact(oscillator, h)
  local c, s = cos(h), sin(h)
  near(Ld({ 0.3 }, { 0.8 }), (0.73 * c - 0.48) / (2 * s), 1e-12, ("oscillator, h = %g"):format(h))
  near(Ld:legendre_minus({ 0.3 }, { 0.8 })[1], (0.8 - 0.3 * c) / s, 2e-12, "  p0")
  near(Ld:legendre_plus({ 0.3 }, { 0.8 })[1], (0.8 * c - 0.3) / s, 2e-12, "  p1")
  near(Ld:two_form({ 0.3 }, { 0.8 })[1][1], 1 / s, 1e-11, "  -D1D2 Ld")
end
local E = exact(kepler, 2)
near(E({ 1, 0 }, { cos(2), sin(2) }), 3, 1e-13, "circular orbit: the action is 3/2 h")
near(E:legendre_plus({ 1, 0 }, { cos(2), sin(2) })[1], -sin(2), 1e-13, "  its momentum")
near(E:momentum(dm.SO(2), { 1, 0 }, { cos(2), sin(2) })[1], 1, 1e-13, "  its angular momentum")
-- a mass that changes, L that depends on time: p1 = D2 Ld is where the flow ends
local path = double:solver { rule = "gauss(8)", h = 0.05 }:run { q = { 0.4, 0.9 }, v = { 1, -1 }, steps = 10 }
local D = exact(double, 0.5)
ok((D:legendre_plus(path.q[1], path.q[11]) - path.p[11]):norm() < 1e-12, "two pendulums: p1 of the flow")
ok((D:legendre_minus(path.q[1], path.q[11]) - path.p[1]):norm() < 1e-12, "  and p0")
local timed = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 + t * q[1] end }
-- q = q0 + v0 t + t^3/6 from t = 0
near(exact(timed, 2):legendre_plus({ 0 }, { 2 + 8 / 6 })[1], 1 + 2, 1e-13, "a force that grows with time")

-- what rules are off by
local function slopes(system, rule, start)
  return dm.discrete_lagrangian(system, { rule = rule, h = 0.1 }):against_exact { q = start[1], v = start[2], h = { 0.06, 0.03, 0.015 } }
end
for s = 1, 3 do
  local r = slopes(double, ("gauss(%d)"):format(s), { { 0.5, -0.3 }, { 1.2, 0.7 } })
  near(r.value_slope, 2 * s + 1, 0.3, ("gauss(%d): Ld off by h^%d"):format(s, 2 * s + 1))
  near(r.momentum_slope, 2 * s, 0.35, "  momenta by one power less")
end
local r = slopes(kepler, "midpoint", { { 1, 0.2 }, { 0.1, 0.8 } })
near(r.value_slope, 3, 0.3, "midpoint, a formula of its system")
ok(#r.value == 3 and r.value[3] < r.value[1] and r.h[2] == 0.03, "  with its errors")
ok(slopes(kepler, "gauss(8)", { { 1, 0 }, { 0, 1 } }).value_slope == nil, "errors of round-off have no slope")

-- what is refused
raises("conjugate", function() return exact(oscillator, pi):value({ 0.3 }, { -0.3 }) end)
raises("conjugate", function() return exact(oscillator, pi):value({ 0.3 }, { 0.8 }) end)
raises("singularity", function() return exact(kepler, 2):value({ 1, 0 }, { -1, 0 }) end)
local light = dm.system { Q = dm.R(1), L = function(_, v) return -(1 - v[1] ^ 2) ^ 0.5 end }
near(exact(light, 1):value({ 0 }, { 0.5 }), -0.75 ^ 0.5, 1e-14, "slower than light")
raises("no curve", function() return exact(light, 1):value({ 0 }, { 2 }) end)
raises("to compare with", function() return exact(oscillator, 1):solver {} end)
raises("no coefficients", function() return exact(oscillator, 1):coefficients() end)
raises("formula Ld(q0, q1)", function()
  return dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h) return (b[1] - a[1]) ^ 2 / (2 * h) end }
    :against_exact { q = { 1 }, v = { 1 }, h = { 0.1 } }
end)
local Ld = dm.discrete_lagrangian(oscillator, { rule = "gauss(1)", h = 0.1 })
raises("list of steps > 0", function() return Ld:against_exact { q = { 1 }, v = { 0 }, h = { -0.1 } } end)
raises("option 'v' is missing", function() return Ld:against_exact { q = { 1 }, h = { 0.1 } } end)
tap.done()
