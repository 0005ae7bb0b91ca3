-- spatial momentum of collective lifts over long runs: no slope, whatever is left out in a step
local tap = require "tap"
local dm = require "dm"
local near, exp = tap.near, dm.SO(3).exp
local G, max = dm.SO(3), math.max
local STEPS = tap.watched and 1e4 or 1e5 -- in the same bounds
-- round-off of a quarter of an ulp of 1 a step walks by 1.8e-14 in 10^5 steps: three times that (J
-- of 10^6 steps is off by 2 to 3 times as much, not by 10); without fused products a step by a power
-- of 2 leaves more (docs/benchmarks/groups.md)
local most = os.getenv "DMLUA_PROCESSOR" == "plain" and 2e-13 or 3 * 2 ^ -54 * 1e5 ^ 0.5

-- the largest error of J(q, p) along a run, and of |q|^2 (the first four coordinates)
local function worst(system, options, J)
  local path = system:solver { rule = options.rule, h = options.h }
    :run { q = options.q, v = options.v, p = options.p, steps = options.steps,
      every = options.steps // 100 }
  local first, off, norm = J(path.q[1], path.p[1]), 0, 0
  for i = 1, #path do
    off = max(off, (J(path.q[i], path.p[i]) - first):norm())
    local sum = -1
    for k = 1, 4 do sum = sum + path:column("q" .. k)[i] ^ 2 end
    norm = max(norm, math.abs(sum))
  end
  return off, norm
end

---- a top: coefficients by a decimal step, sweeps whose ratios change in turns ----

local function top(I)
  return dm.system { Q = G, L = function(R, w)
    return (I[1] * w[1] ^ 2 + I[2] * w[2] ^ 2 + I[3] * w[3] ^ 2) / 2 - R[3][3]
  end }
end
local function vertical(R, p)
  return dm.vector { R[3][1] * p[1] + R[3][2] * p[2] + R[3][3] * p[3] }
end
for _, case in ipairs {
  { { 1, 2, 0.5 }, "midpoint", 0.05 }, { { 1, 2, 0.5 }, "gauss(2)", 0.05 },
  { { 1, 2, 0.5 }, "gauss(2)", 0.0625 }, { { 1, 1.2, 0.6 }, "gauss(8)", 0.05 } } do
  local random = dm.random(7)
  local off, norm = 0, 0
  for k = 0, 3 do
    local x = {}
    for i = 1, 6 do x[i] = random:uniform(1, 6 * k + i, 0, 1) end
    local a, b = worst(top(case[1]), { rule = case[2], h = case[3], steps = STEPS,
      q = exp(G, { 2 * x[1] - 1, 2 * x[2] - 1, 2 * x[3] - 1 }), p = { x[4], x[5], 1 + x[6] } },
      vertical)
    off, norm = max(off, a), max(norm, b)
  end
  near(off, 0, most, ("a top by %s, h = %g: J over 10^5 steps"):format(case[2], case[3]))
  near(norm, 0, most / 2, "and |q|^2")
end

---- a satellite in the gradient of gravity, on SE(3): p is regauged ----

local I = { 0.1, 0.2, 0.25 }
local function parts(g)
  return dm.matrix { { g[1][1], g[1][2], g[1][3] }, { g[2][1], g[2][2], g[2][3] },
    { g[3][1], g[3][2], g[3][3] } }, dm.vector { g[1][4], g[2][4], g[3][4] }
end
local satellite = dm.system { Q = dm.SE(3), L = function(g, v)
  local R, x = parts(g)
  local X, d2 = R:transpose() * x, x:dot(x)
  local V = -1 / math.sqrt(d2) - 0.005 * (I[1] + I[2] + I[3]
    - 3 * (I[1] * X[1] ^ 2 + I[2] * X[2] ^ 2 + I[3] * X[3] ^ 2) / d2) / d2 ^ 1.5
  return (I[1] * v[4] ^ 2 + I[2] * v[5] ^ 2 + I[3] * v[6] ^ 2 + v[1] ^ 2 + v[2] ^ 2
    + v[3] ^ 2) / 2 - V
end }
local function angular(g, p)
  local R, x = parts(g)
  return R * dm.vector { p[4], p[5], p[6] } + x:cross(R * dm.vector { p[1], p[2], p[3] })
end
local R = exp(G, { 0.3, -0.4, 0.5 })
local b = R:transpose() * dm.vector { 0.05, 1, 0.1 }
local off, norm = worst(satellite, { rule = "gauss(3)", h = 0.05, steps = 2e5,
  q = { { R[1][1], R[1][2], R[1][3], 1.05 }, { R[2][1], R[2][2], R[2][3], 0.1 },
    { R[3][1], R[3][2], R[3][3], -0.1 }, { 0, 0, 0, 1 } },
  v = { b[1], b[2], b[3], 0.3, -0.2, 0.7 } }, angular)
near(off, 0, 4e-14, "a satellite: J over 2 10^5 steps")
near(norm, 0, 1e-14, "and |q|^2")

tap.done()
