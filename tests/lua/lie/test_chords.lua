-- dmlua tests/lua/lie/test_chords.lua: steps on H whose sweeps do not contract, or that have more than eight stages, by chords in the eigenvectors of
-- Gauss' coefficients: against rules and steps that sweep, invariants, and a start that is far from its step.
local dm = require "dm"
local tap = require "tap"
local ok, near = tap.ok, tap.near

local G = dm.SO(4)
local growing = dm.system { Q = G, H = function(g, p)
  return p[1] * p[2] + g[1][1] * p[3] + p[4] + g[2][3] * p[5] + g[4][4] * p[6]
end }
local function finish(system, rule, h, steps, start)
  local path = system:solver { rule = rule, h = h }:run { q = start.q, p = start.p, steps = steps, every = steps }
  return path.p[#path.p], path.q[#path.q], path
end
local slow = { q = G:identity(), p = { 0.3, 0.2, -0.1, 0.4, 0.1, 0.2 } }
local p8, q8 = finish(growing, "gauss(8)", 0.05, 160, slow)
for _, rule in ipairs { "gauss(9)", "gauss(12)", "gauss(16)", "gauss(18)" } do
  local p, q = finish(growing, rule, 0.2, 40, slow)
  near((p - p8):norm(), 0, 2e-13, rule .. " goes where sweeps of gauss(8) go: momentum")
  local off = 0
  for i = 1, 4 do
    for k = 1, 4 do off = math.max(off, math.abs(q[i][k] - q8[i][k])) end
  end
  near(off, 0, 2e-13, rule .. ": element")
end

-- long steps, of a rule that sweeps where they are short: the first step begins far from its end
local fast = { q = G:identity(), p = { 3, 2, -1, 0.4, 0.1, 0.2 } }
local pf = finish(growing, "gauss(8)", 0.05, 160, fast)
local p = finish(growing, "gauss(8)", 0.2, 40, fast)
ok((p - pf):norm() < 1e-3 * pf:norm(), "gauss(8) at a step four times as long", (p - pf):norm())
local p12 = finish(growing, "gauss(12)", 0.2, 40, fast)
ok((p12 - pf):norm() < 1e-4 * pf:norm(), "gauss(12) is nearer", (p12 - pf):norm())

-- a free body of four dimensions: spatial momentum and rotation, with all steps by chords
local free = dm.system { Q = G, L = function(_, x)
  local sum = 0
  for i = 1, 6 do sum = sum + (1 + 0.3 * i) * x[i] ^ 2 / 2 end
  return sum
end }
local _, _, path = finish(free, "gauss(10)", 0.5, 400, { q = G:exp { 0.3, 0.1, -0.2, 0.4, 0.2, -0.1 }, p = { 0.5, -0.3, 0.8, 0.2, 0.4, -0.6 } })
local J, R = path:momentum(G), path.q[2]
near((J[2] - J[1]):norm(), 0, 1e-13, "spatial momentum after 400 steps")
local worst = 0
local product = R:transpose() * R
for i = 1, 4 do
  for k = 1, 4 do worst = math.max(worst, math.abs(product[i][k] - (i == k and 1 or 0))) end
end
near(worst, 0, 1e-13, "a rotation after 400 steps")
near(path:energy()[2], path:energy()[1], 1e-13, "energy after 400 steps")

-- on R^n, too: oscillators, each turned by the diagonal Pade approximant N(z)/N(-z) of exp z, z = i omega h, once a step
local n, s, h = 20, 10, 0.5
local chain = dm.system { Q = dm.R(n), H = function(q, p)
  local sum = 0
  for i = 1, n do sum = sum + p[i] ^ 2 / 2 + i ^ 2 * q[i] ^ 2 / 2 end
  return sum
end }
local function turn(angle)
  local re, im, c = 0, 0, 1
  for k = 0, s do
    local term = c * angle ^ k * (k % 4 < 2 and 1 or -1)
    if k % 2 == 0 then re = re + term else im = im + term end
    c = c * (s - k) / ((2 * s - k) * (k + 1))
  end
  return 2 * math.atan(im, re)
end
local ones = dm.zeros(n) + 1
local last = chain:solver { rule = "gauss(10)", h = h }:run { q = ones, p = ones * 0, steps = 4, every = 4 }
for i = 1, n do near(last.q[2][i], math.cos(4 * turn(i * h)), 1e-13, ("oscillator %d"):format(i)) end
tap.done()
