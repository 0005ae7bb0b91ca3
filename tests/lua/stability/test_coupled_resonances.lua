-- frequencies of coupled oscillators at large amplitudes: those of the motion, by the spectrum of a long run of its own, and what is a mean alone
local dm = require "dm"
local core = require "dm.core"
local tap = require "tap"
local ok, near = tap.ok, tap.near
local cos, pi, sqrt = math.cos, math.pi, math.sqrt

-- { omega = is it a mean }
local function told(system, q, v, t)
  local map = dm.stability { system = system, q = q, v = v, rule = "verlet", h = { 0.01, 4, 3, "log" }, t = t, refine = false, accuracy = false, chaos = false }
  local out, count = {}, 0
  for _, r in ipairs(map:resonances(1)) do
    if out[r.omega] == nil then out[r.omega], count = r.mean or false, count + 1 end
  end
  return out, count
end

-- lines of all coordinates over a time eight times as long, under a window of another kind (Blackman's)
local function lines(system, n, q, v)
  local rows, T, at, out = 8192, 800, {}, {}
  for i = 1, rows do at[i] = T * i / rows end
  local path = system:solver({ rule = "blanes-moan(6)", h = 0.02 }):run { q = q, v = v, at = at }
  for i = 1, n do
    local x, A, most = path:column("q" .. i):totable(), {}, 0
    for k = 1, rows do x[k] = x[k] * (0.42 - 0.5 * cos(2 * pi * k / rows) + 0.08 * cos(4 * pi * k / rows)) end
    local re, im = core.fft(x)
    for k = 1, rows // 2 do A[k] = sqrt(re[k] ^ 2 + im[k] ^ 2) most = math.max(most, A[k]) end
    for k = 4, #A - 1 do
      if A[k] > 0.02 * most and A[k] > A[k - 1] and A[k] >= A[k + 1] then out[#out + 1] = 2 * pi * (k - 1) / T end
    end
  end
  return out, pi / T
end

local seed = 77
local function random(a, b)
  seed = seed * 16807 % 2147483647
  return a + (b - a) * seed / 2147483647
end
for trial = 1, 10 do
  local n, m, K, quartic, q, v = 2 + trial % 2, {}, {}, random(0.2, 0.6), {}, {}
  for i = 1, n do
    m[i], K[i], q[i], v[i] = random(0.8, 1.5), { [i] = (1 + 1.3 * i) ^ 2 * random(0.4, 0.6) }, random(-1.2, 1.2), random(-0.5, 0.5)
    for j = 1, i - 1 do K[i][j] = 0.2 * sqrt(K[i][i] * K[j][j]) * random(-1, 1) end
  end
  local system = dm.system { Q = dm.R(n), L = function(x, y)
    local L = 0
    for i = 1, n do
      L = L + m[i] * y[i] ^ 2 / 2 - quartic * x[i] ^ 4 - K[i][i] * x[i] ^ 2 / 2
      for j = 1, i - 1 do L = L - K[i][j] * x[i] * x[j] end
    end
    return L
  end }
  local list, count = told(system, q, v, 200)
  local seen, half = lines(system, n, q, v)
  ok(count == n, "as many frequencies as oscillators", count)
  for omega, mean in pairs(list) do
    local off = math.huge
    for _, line in ipairs(seen) do off = math.min(off, math.abs(omega - line)) end
    ok(mean or off <= half + 5e-3 * omega, ("trial %d: a line of the motion"):format(trial), omega, off)
  end
end

-- two like oscillators that swing together, x'' = -x - 2 x^3: one frequency, that of the amplitude; the other mode does not move
do
  local A = 0.9
  local pair = dm.system { Q = dm.R(2), L = function(x, y)
    return (y:dot(y) - x:dot(x)) / 2 - (x[1] ^ 4 + x[2] ^ 4) / 2 - 0.4 * (x[1] - x[2]) ^ 2
  end }
  local a, b = 1, sqrt(1 - A ^ 2 / (1 + 2 * A ^ 2))
  for _ = 1, 40 do a, b = (a + b) / 2, sqrt(a * b) end
  local list, count = told(pair, { A, A }, { 0, 0 }, 100)
  local own, means = nil, 0
  for omega, mean in pairs(list) do
    if mean then means = means + 1 else own = omega end
  end
  ok(count <= 2 and means == count - 1, "one of them is a mean, and says so", count, means)
  near(own or 0, sqrt(1 + 2 * A ^ 2) * a, 2e-3, "the other one is that of the amplitude")
end
tap.done()
