-- the tangent map, symplecticity, Lyapunov exponents and MEGNO, reversal, backward error
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos = math.abs, math.cos

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { 0.4, 0 }, v = { 0, 2 }, steps = 100 }
local function with(s, more)
  local out = {}
  for k, v in pairs(s) do out[k] = v end
  for k, v in pairs(more or {}) do out[k] = v end
  return out
end

-- against central differences of the run itself (error e^2 of the differences)
local e = 1e-5
for _, rule in ipairs { "verlet", "midpoint", "gauss(3)", "lobatto(3)", "kahan-li(6)", "rk8", "rk4" } do
  local solver = kepler:solver { rule = rule, h = 0.02 }
  local M, q = solver:tangent(start)
  local path = solver:run(with(start, { every = 100 }))
  near((q - path.q[2]):norm(), 0, 1e-13, rule .. ": the end of the run comes with it")
  local worst = 0
  for k = 1, 4 do
    local function shifted(sign)
      local x = { 0.4, 0, 0, 2 }
      x[k] = x[k] + sign * e
      return solver:run { q = { x[1], x[2] }, p = { x[3], x[4] }, steps = 100, every = 100 }
    end
    local a, b = shifted(1), shifted(-1)
    for i = 1, 2 do
      worst = math.max(worst, abs((a.q[2][i] - b.q[2][i]) / (2 * e) - M[i][k]), abs((a.p[2][i] - b.p[2][i]) / (2 * e) - M[2 + i][k]))
    end
  end
  ok(worst < 1e-6, rule .. ": the tangent map agrees with differences", worst)
end

-- closed form: the midpoint rule on an oscillator is the Cayley transform
local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local M = spring:solver { rule = "midpoint", h = 0.5 }:tangent { q = { 1 }, v = { 0.3 }, steps = 1 }
local d = 1 + 0.5 ^ 2 / 4
near(M[1][1], (1 - 0.5 ^ 2 / 4) / d, 1e-15, "midpoint on the oscillator: cosine of the Cayley transform")
near(M[1][2], 0.5 / d, 1e-15, "and its sine"); near(M[2][1], -0.5 / d, 1e-15, "with the sign")

-- symplectic or not, L with t, coupled and varying mass
local double = dm.system { Q = dm.T(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 2 * cos(q[1]) + cos(q[2])
end }
local swing = dm.system { Q = dm.T(1), L = function(q, v, t) return v[1] ^ 2 / 2 + (1 + 0.3 * cos(2 * t)) * cos(q[1]) end }
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)", "trapezoidal" } do
  local defect = double:solver { rule = rule, h = 0.1 }:symplecticity { q = { 1, 2 }, v = { 0, 0.5 }, steps = 50 }
  ok(defect < 1e-13, rule .. " is symplectic on the double pendulum", defect)
  defect = swing:solver { rule = rule, h = 0.1 }:symplecticity { q = { 1 }, v = { 0 }, steps = 50, t0 = 0.4 }
  ok(defect < 1e-13, rule .. " is symplectic where L depends on t", defect)
end
local defect = double:solver { rule = "rk4", h = 0.1 }:symplecticity { q = { 1, 2 }, v = { 0, 0.5 }, steps = 50 }
ok(defect > 1e-8, "rk4 is not", defect)
local damped = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end, force = function(q, v) return { -0.1 * v[1] } end }
M = damped:solver({ rule = "midpoint", h = 0.1 }):tangent { q = { 1 }, v = { 0 }, steps = 100 }
near(M[1][1] * M[2][2] - M[1][2] * M[2][1], ((1 - 0.1 * 0.1 / 2 + 0.1 ^ 2 / 4) / (1 + 0.1 * 0.1 / 2 + 0.1 ^ 2 / 4)) ^ 100, 1e-13,
  "friction: the determinant is that of the midpoint rule")

-- constraints: the spherical pendulum in R^3 has the exponents of the one in angles near its upper equilibrium
local sphere = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return { q:dot(q) - 1 } end }
for _, rule in ipairs { "rattle", "gauss(2)" } do
  local up = sphere:solver({ rule = rule, h = 0.01 }):lyapunov { q = { 0, 0, 1 }, v = { 0, 0, 0 }, t = 20, u = { 1, 0, 0 }, dp = { 1, 0, 0 } }
  near(up.exponent, 1, 1e-4, rule .. ": the unstable equilibrium of a constrained pendulum, exponent sqrt(g/l)")
end
raises("not tangent to the constraints", function() sphere:solver({ rule = "rattle", h = 0.1 }):tangent { q = { 1, 0, 0 }, v = { 0, 0, 0 }, steps = 1 } end)
local skate = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - (q[1] ^ 2 + q[2] ^ 2) / 2 end,
  rolling = function(q, v) return { v[3] - q[2] * v[1] } end }
local solver = skate:solver { rule = "midpoint", h = 0.05 }
local _, w = pcall(solver.lyapunov, solver, { q = { 1, 0, 0 }, v = { 0, 1, 0 }, steps = 40, every = 40, u = { 0, 0, 1 }, dp = { 0, 0, 0 } })
local moved = solver:run { q = { 1, 0, 1e-3 }, v = { 0, 1, 0 }, steps = 40 }
local fixed = solver:run { q = { 1, 0, 0 }, v = { 0, 1, 0 }, steps = 40 }
near((moved.q[41] - fixed.q[41])[3] / 1e-3, 1, 1e-9, "rolling: a shift along a symmetry stays one")
ok(type(w) == "table" and abs(w.exponent) < 1e-12, "and its tangent vector does not grow", w)
local mixed = { q = { 1, 0.2, 0 }, v = { 0.3, 1, 0.06 }, steps = 60, every = 60 }
local e2 = 1e-5
local plus, minus = solver:run { q = { 1 + e2, 0.2, 0 }, p = { 0.3, 1, 0.06 }, steps = 60, every = 60 }, solver:run { q = { 1 - e2, 0.2, 0 }, p = { 0.3, 1, 0.06 }, steps = 60, every = 60 }
local d1 = (plus.q[2] - minus.q[2]) * (1 / (2 * e2))
mixed.u, mixed.dp = { 1, 0, 0 }, { 0, 0, 0 }
w = solver:lyapunov(mixed)
local d2 = (plus.p[2] - minus.p[2]) * (1 / (2 * e2))
near(w.exponent * 60 * 0.05, 0.5 * math.log(d1:dot(d1) + d2:dot(d2)), 1e-8, "rolling: growth of a tangent vector against differences")

-- Lyapunov: exactly known for a hyperbolic point, zero for Kepler, positive for a chaotic orbit of Henon-Heiles
local saddle = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2) / 2 end }
local r = saddle:solver { rule = "gauss(4)", h = 0.05 }:lyapunov { q = { 0 }, v = { 0 }, t = 2000, u = { 1 }, dp = { 1 } }
near(r.exponent, 1, 1e-12, "a saddle: exponent 1 over a growth of e^2000")
near(r.megno, 1000, 1e-6, "and MEGNO t / 2")
local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q:dot(q) / 2 + q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
local function orbit(y, px) return henon:solver { rule = "kahan-li(6)", h = 0.1 }:lyapunov { q = { 0, y }, p = { px, 0 }, t = 5000 } end
r = orbit(0.55, 0.2417)
ok(abs(r.megno - 2) < 0.1 and r.exponent < 0.003, "a regular orbit of Henon-Heiles: MEGNO 2", r.megno)
-- round-off decides how long a chaotic orbit stays near an island: the mean of some that begin 1e-13 apart
local exponent, megno = 0, 0
for k = 0, 5 do
  r = orbit(-0.016 + k * 1e-13, 0.49974)
  exponent, megno = exponent + r.exponent / 6, megno + r.megno / 6
end
ok(megno > 50 and exponent > 0.02 and exponent < 0.1, "chaotic ones at the same energy 1/8", exponent)
ok(abs(megno / (exponent * r.t / 2) - 1) < 0.5, "MEGNO is exponent t / 2")
ok(#r.history.t == 1000 and r.history.t[1000] == r.t, "with its history")

-- symmetric rules come back
for _, rule in ipairs { "verlet", "midpoint", "gauss(3)", "lobatto(4)", "kahan-li(8)" } do
  ok(kepler:solver { rule = rule, h = 0.02 }:reversal(start) < 1e-12, rule .. " comes back")
end
ok(kepler:solver { rule = "rk4", h = 0.02 }:reversal(start) > 1e-10, "rk4 does not")
local magnetic = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + (q[1] * v[2] - q[2] * v[1]) - q[1] ^ 4 end }
ok(magnetic:solver { rule = "gauss(2)", h = 0.1 }:reversal { q = { 1, 0 }, v = { 0, 1 }, steps = 100 } < 1e-12, "also in a magnetic field, which is not even in v")
ok(swing:solver { rule = "gauss(2)", h = 0.1 }:reversal { q = { 1 }, v = { 0 }, steps = 100, t0 = 0.3 } < 1e-12, "also where L depends on t")

-- backward error
r = kepler:solver { rule = "verlet", h = 0.02 }:backward_error { q = { 0.4, 0 }, v = { 0, 2 }, steps = 10000 }
near(r.order, 2, 0.05, "the energy of Verlet oscillates as h^2"); ok(abs(r.drift) < 3 * r.error + 1e-9, "without drift")
r = kepler:solver { rule = "rk4", h = 0.02 }:backward_error { q = { 0.4, 0 }, v = { 0, 2 }, steps = 10000 }
ok(abs(r.drift) > 10 * r.error, "that of rk4 drifts", r.drift / r.error)

-- misuse
raises("changes the time with the state", function() kepler:solver { rule = "log-hamiltonian(kahan-li(6))", h = 0.1 }:tangent(start) end)
raises("whole number", function() kepler:solver { rule = "verlet", h = 0.1 }:tangent { q = { 1, 0 }, v = { 0, 1 }, steps = 2 ^ 62 } end)
raises("unknown option 'stepz'", function() kepler:solver { rule = "verlet", h = 0.1 }:tangent { stepz = 3 } end)
raises("give 'steps' or 't'", function() kepler:solver { rule = "verlet", h = 0.1 }:tangent { q = { 1, 0 }, v = { 0, 1 } } end)
raises("give the start as q and v", function() kepler:solver { rule = "verlet", h = 0.1 }:tangent { q = { 1, 0 }, steps = 3 } end)
raises("is zero", function() kepler:solver { rule = "verlet", h = 0.1 }:lyapunov { q = { 1, 0 }, v = { 0, 1 }, steps = 3, u = { 0, 0 }, dp = { 0, 0 } } end)
tap.done()
