-- dm.step: tangent maps of steps of one's own, beside those of the same rules of the list and
-- beside differences of runs
local tap = require "tap"
local dm = require "dm"
local linear = require "dm.base.linear"
local ok, near, raises = tap.ok, tap.near, tap.raises
local vector, abs, max = dm.vector, math.abs, math.max

local G = dm.SO(3)
local function gap(A, B) return linear.largest(A - B) end

---- on R^n ----

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function midpoint(extra)
  local options = { unknowns = 4, order = 2,
    start = function(y) return { y.q[1], y.q[2], y.p[1], y.p[2] } end,
    equation = function(y, x, h, m)
      local q1, p1 = vector { x[1], x[2] }, vector { x[3], x[4] }
      local q, mu = (y.q + q1) * 0.5, (y.p + p1) * 0.5
      local a, b = q1 - y.q - m.H_p(q, mu, y.t) * h, p1 - y.p + m.H_q(q, mu, y.t) * h
      return { a[1], a[2], b[1], b[2] }
    end,
    next = function(_, x) return { q = { x[1], x[2] }, p = { x[3], x[4] } } end }
  for key, value in pairs(extra or {}) do options[key] = value end
  return dm.step(options)
end
local start = { q = { 0.8, 0 }, v = { 0, 1.2 }, steps = 20 }
local mine = kepler:solver { rule = midpoint(), h = 0.05 }
local listed = kepler:solver { rule = "midpoint", h = 0.05 }
local M, q, p = mine:tangent(start)
near(gap(M, listed:tangent(start)), 0, 1e-13, "the midpoint rule by hand has its tangent map")
local path = mine:run(start)
near((q - path.q[21]):norm() + (p - path.p[21]):norm(), 0, 1e-13, "and the end of the run")
near(mine:symplecticity(start), 0, 1e-14, "it is symplectic")
near(mine:lyapunov { q = start.q, v = start.v, steps = 200 }.exponent,
  listed:lyapunov { q = start.q, v = start.v, steps = 200 }.exponent, 1e-10, "its exponent")
local summed = kepler:solver { h = 0.05, rule = midpoint { sums = true, next = function(y, x)
  return { q = { x[1] - y.q[1], x[2] - y.q[2] }, p = { x[3] - y.p[1], x[4] - y.p[2] } }
end } }
near(gap(summed:tangent(start), M), 0, 1e-13, "steps that give what they add")

-- Euler's explicit rule of an oscillator: M = (1 + h^2) times a turn, so M^T J M - J = h^2 J a step
local oscillator = dm.system { Q = dm.R(1), L = function(x, v)
  return (v[1] ^ 2 - x[1] ^ 2) / 2
end }
local euler = oscillator:solver { h = 0.1, rule = dm.step { unknowns = 1, order = 1,
  start = function() return { 0 } end,
  equation = function(y, x, h) return { x[1] - h * y.p[1] } end,
  next = function(y, x, h) return { q = y.q + x, p = y.p - y.q * h } end } }
near(euler:symplecticity { q = { 1 }, p = { 0 }, steps = 1 }, 0.01, 1e-15,
  "and the defect of one that is not")

---- parts ----

-- an oscillator whose spring stretches as it goes: F is state that acts on the next step
local function with_parts(next)
  return oscillator:solver { h = 0.1, rule = dm.step { unknowns = 1, order = 1,
    parts = { { "F", 1 } }, begin = function(x, y) return { F = x[1] * y[1] } end,
    start = function(y, h) return { h * y.p[1] } end,
    equation = function(y, x, h) return { x[1] - h * y.p[1] } end, next = next } }
end
local acting = with_parts(function(y, x, h)
  return { q = { y.q[1] + x[1] }, p = { y.p[1] - h * (y.q[1] + x[1]) * (1 + h * y.F) },
    F = y.F + h * y.q[1] ^ 2 }
end)
local function finish(x, y)
  local run = acting:run { q = { x }, p = { y }, steps = 12, every = 12 }
  return run.q[2][1], run.p[2][1]
end
local D, e = acting:tangent { q = { 0.7 }, p = { 0.4 }, steps = 12 }, 1e-4
local function slope(k, entry)
  local function at(s)
    return (select(entry, finish(0.7 + (k == 1 and s or 0), 0.4 + (k == 2 and s or 0))))
  end
  return (8 * (at(e) - at(-e)) - at(2 * e) + at(-2 * e)) / (12 * e)
end
local worst = 0
for i = 1, 2 do
  for k = 1, 2 do worst = max(worst, abs(D[i][k] - slope(k, i))) end
end
near(worst, 0, 1e-11, "parts move along, from `begin` on")
raises("parts of this step's state act on later steps", acting.lyapunov, acting,
  { q = { 0.7 }, p = { 0.4 }, steps = 100 })
local counted = with_parts(function(y, x, h)
  return { q = { y.q[1] + x[1] }, p = { y.p[1] - h * (y.q[1] + x[1]) }, F = y.F + 1 }
end)
near(counted:lyapunov { q = { 0.7 }, p = { 0.4 }, steps = 100 }.exponent,
  oscillator:solver { rule = "symplectic-euler", h = 0.1 }
    :lyapunov { q = { 0.7 }, p = { 0.4 }, steps = 100 }.exponent, 0.02, "parts that only count")
local timed = with_parts(function(y, x, h)
  return { q = { y.q[1] + x[1] }, p = { y.p[1] - h * (y.q[1] + x[1]) },
    t = y.t + h * (1 + y.q[1] ^ 2) }
end)
raises("changes the time with the state", timed.tangent, timed, { q = { 1 }, p = { 0 }, steps = 2 })

---- on a group ----

local I = { 1, 1.2, 0.6 }
local function times_I(x) return vector { I[1] * x[1], I[2] * x[2], I[3] * x[3] } end
local function body(height, side)
  return dm.system { Q = G, trivialization = side, L = function(R, w)
    if side then w = R:transpose() * w end
    return times_I(w):dot(w) / 2 - height * R[3][3]
  end }
end
local spin = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 }, steps = 20 }
local free = body(0)
local chart = dm.step { name = "lie(1) by hand", unknowns = 3, order = 2,
  start = function(y, h) return { h * y.p[1] / I[1], h * y.p[2] / I[2], h * y.p[3] / I[3] } end,
  equation = function(y, x, h) return G:dexpinv(-x, times_I(x) / h) - y.p end,
  next = function(y, x, h)
    return { q = G:compose(y.q, G:exp(x)), p = G:dexpinv(x, times_I(x) / h) }
  end }
local by_hand = free:solver { rule = chart, h = 0.1 }
local of_list = free:solver { rule = "lie(1)", h = 0.1 }
near(gap(by_hand:tangent(spin), of_list:tangent(spin)), 0, 1e-12,
  "lie(1) by hand has that of lie(1)")
near(by_hand:symplecticity(spin), 0, 1e-14, "and its two-form")
near(by_hand:lyapunov { q = spin.q, p = spin.p, steps = 200 }.exponent,
  of_list:lyapunov { q = spin.q, p = spin.p, steps = 200 }.exponent, 1e-9, "and its exponent")

local function lie_euler(side)
  return dm.step { unknowns = 3, order = 1,
    start = function(y, h, m) return m.H_p(y.q, y.p, y.t) * h end,
    equation = function(y, x, h, m) return x - m.H_p(y.q, y.p, y.t) * h end,
    next = function(y, x, h, m)
      local moved = y.p - m.H_q(y.q, y.p, y.t) * h
      if side then return { q = G:exp(x) * y.q, p = G:coAd(G:exp(x), moved) } end
      return { q = y.q * G:exp(x), p = G:coAd(G:exp(-x), moved) }
    end }
end
-- five-point differences of runs, in changes g^-1 dg (right: dg g^-1) and dp
local function by_differences(solver, side)
  local step, base = 1e-3, solver:run(spin)
  local R, out = base.q[21], dm.matrix(6, 6)
  local function at(k, s)
    local u, dp = dm.zeros(3), vector(spin.p)
    if k <= 3 then u[k] = s else dp[k - 3] = dp[k - 3] + s end
    local g = side and G:exp(u) * spin.q or spin.q * G:exp(u)
    local run = solver:run { q = g, p = dp, steps = 20, every = 20 }
    local turned = side and run.q[2] * G:inverse(R) or G:inverse(R) * run.q[2]
    local w, mu = G:log(turned), run.p[2]
    return vector { w[1], w[2], w[3], mu[1], mu[2], mu[3] }
  end
  for k = 1, 6 do
    local column = (at(k, step) - at(k, -step)) * (8 / (12 * step))
      - (at(k, 2 * step) - at(k, -2 * step)) * (1 / (12 * step))
    for i = 1, 6 do out[i][k] = column[i] end
  end
  return out
end
for _, side in ipairs { false, "right" } do
  local solver = body(1, side or nil):solver { rule = lie_euler(side), h = 0.05 }
  local exact = solver:tangent(spin)
  near(gap(exact, by_differences(solver, side)), 0, 1e-9 * linear.largest(exact),
    side and "the spatial velocity" or "a heavy top")
end

---- what has none ----

-- x^2 = y.p^2 from a start where two roots are alike
local double = oscillator:solver { h = 0.1, rule = dm.step { unknowns = 1, order = 1,
  start = function() return { 0 } end,
  equation = function(y, x) return { (x[1] - y.p[1]) ^ 3 } end,
  next = function(y, x, h)
    return { q = y.q + x * h, p = { x[1] - h * (y.q[1] + h * x[1]) } }
  end } }
raises("tangent map is known", double.tangent, double, { q = { 1 }, p = { 0 }, steps = 1 })
ok(mine:reversal(start) < 1e-13, "runs of other systems go on as before")

tap.done()
