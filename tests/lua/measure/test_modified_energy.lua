-- the modified energy: closed forms on the oscillator, constancy where H swings, drift of what is not symplectic
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sqrt, asin, atan, cos = math.abs, math.sqrt, math.asin, math.atan, math.cos

-- Verlet on q'' = -q keeps p^2 + (1 - h^2/4) q^2 and turns at the rate 2/h asin(h/2); the midpoint rule keeps H and turns at 2/h atan(h/2)
local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local h = 0.1
local m = spring:solver({ rule = "verlet", h = h }):modified_energy { q = { 1 }, v = { 0.3 }, steps = 100 }
near(m.mean, (0.3 ^ 2 + 1 - h * h / 4) / 2 * (2 / h * asin(h / 2)) / sqrt(1 - h * h / 4), 1e-14, "Verlet on the oscillator, closed form")
ok(m.amplitude < 1e-14, "and constant", m.amplitude)
m = spring:solver({ rule = "midpoint", h = h }):modified_energy { q = { 1 }, v = { 0.3 }, steps = 100 }
near(m.mean, (0.3 ^ 2 + 1) / 2 * 2 / h * atan(h / 2), 1e-14, "midpoint on the oscillator, closed form")

-- nonlinear: H swings, the modified energy does not
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function swing(values)
  local worst = 0
  for i = 1, #values do worst = math.max(worst, abs(values[i] - values[1])) end
  return worst
end
local start = { q = { 0.7, 0 }, v = { 0, 1.2 }, steps = 2000 }
for _, case in ipairs { { "verlet", 1e-6 }, { "midpoint", 1e-6 }, { "yoshida(4)", 1e-9 }, { "gauss(2)", 1e-10 }, { "lobatto(3)", 1e-11 } } do
  m = kepler:solver({ rule = case[1], h = 0.02 }):modified_energy(start)
  ok(swing(m.H) > case[2] and m.amplitude < 2e-12, case[1] .. ": H swings, the modified energy stays", m.amplitude)
  ok(abs(m.drift) < 1e-15, "  without drift", m.drift)
end
local double = dm.system { Q = dm.T(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 2 * cos(q[1]) + cos(q[2])
end }
m = double:solver({ rule = "midpoint", h = 0.02 }):modified_energy { q = { 1, 0.5 }, v = { 0, 0 }, steps = 2000 }
ok(swing(m.H) > 1e-5 and m.amplitude < 2e-12, "midpoint on a double pendulum, whose mass varies", m.amplitude)
-- its distance from H is of the order of the rule
local function distance(step, rule)
  local e = kepler:solver({ rule = rule, h = step }):modified_energy { q = { 0.7, 0 }, v = { 0, 1.2 }, steps = 100 }
  return abs(e.energy[1] - e.H[1])
end
near(math.log(distance(0.02, "verlet") / distance(0.01, "verlet"), 2), 2, 0.2, "it is off H by h^2 for Verlet")
m = kepler:solver({ rule = "rk4", h = 0.02 }):modified_energy(start)
ok(abs(m.drift) > 20 * m.error and abs(m.drift) > 1e-12, "rk4 has none: what stands for it drifts", m.drift)

-- constraints: a rod, in time too; parameters
local rod = dm.system { Q = dm.R(2), params = { 2 }, L = function(q, v, t, c) return v:dot(v) / 2 - c[1] * q[2] end,
  constraint = function(q, t, c) return q:dot(q) - c[1] / 2 end }
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)" } do
  m = rod:solver({ rule = rule, h = 0.05 }):modified_energy { q = { math.sin(1), -cos(1) }, v = { 0, 0 }, steps = 400 }
  ok(swing(m.H) > 1e-8 and m.amplitude < 5e-12, rule .. ": a rod", m.amplitude)
end
raises("without time", function()
  dm.system({ Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q, t) return q:dot(q) - 1 - 0.1 * t end })
    :solver({ rule = "midpoint", h = 0.1 }):modified_energy { q = { 1, 0 }, v = { 0.05, 0 }, steps = 50 }
end)
raises("mass", function() rod:solver({ rule = "rattle", h = 0.1 }):modified_energy { q = { 1, 0 }, v = { 0, 0 }, steps = 50 } end)
raises("without time", function()
  dm.system({ Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 - q[1] * cos(t) end }):solver({ rule = "verlet", h = 0.1 }):modified_energy { q = { 1 }, v = { 0 }, steps = 50 }
end)
raises("a whole number from 15", function() spring:solver({ rule = "verlet", h = 0.1 }):modified_energy { q = { 1 }, v = { 0 }, steps = 5 } end)
raises("unknown option", function() spring:solver({ rule = "verlet", h = 0.1 }):modified_energy { x = 1 } end)
raises("time of its own", function() kepler:solver({ rule = "log-hamiltonian(kahan-li(6))", h = 0.1 }):modified_energy(start) end)
local d = dm.drift({ 0, 1, 2, 3 }, { 1, 3, 5, 7 })
near(d.per_time, 2, 1e-14, "dm.drift of two columns")
raises("3 times", dm.drift, { 1, 2 }, { 1, 2 })
tap.done()
