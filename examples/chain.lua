-- Toda (1967): do solitons of a chain of 2000 bodies come out of a collision unchanged?
-- L = sum v_i^2/2 - W(q_i - q_(i+1)), W(d) = exp(d) - d - 1. A soliton has the strain
-- exp(q_n - q_(n+1)) - 1 = (sinh k)^2 / cosh(k (n - c))^2 and the speed sinh(k)/k: high ones are fast. After an
-- overtaking both have their shape back, and are displaced by log(sinh((k1 + k2)/2) / sinh((k1 - k2)/2)) / k,
-- the fast one forwards, the slow one backwards (Hirota's two-soliton solution).
local dm = require "dm"
local exp, log, sqrt, sinh = math.exp, math.log, math.sqrt, dm.sinh
local picture = (arg and arg[1] or ".") .. "/chain.png"
local N, T = 2000, 1000

local chain = dm.system { name = "Toda chain", Q = dm.R(N), L = function(q, v)
  return dm.sum_over(v, function(u) return u ^ 2 / 2 end)
    - dm.sum_over(q, function(a, b) return exp(a - b) - (a - b) - 1 end, { shift = 1 })
end }

-- far apart they add up: q_n = log(tau_(n-1) / tau_n), tau_n = 1 + exp(2 k (n - c))
local solitons = { { k = 1.2, c = 200 }, { k = 0.6, c = 300 } }
local q, v = dm.vector(N), dm.vector(N)
for _, s in ipairs(solitons) do
  local function log_tau(n)
    local x = 2 * s.k * (n - s.c)
    return math.max(x, 0) + log(1 + exp(-math.abs(x)))
  end
  local function rate(n) return -2 * sinh(s.k) / (1 + exp(-2 * s.k * (n - s.c))) end  -- of log tau_n
  for n = 1, N do
    q[n] = q[n] + log_tau(n - 1) - log_tau(n)
    v[n] = v[n] + rate(n - 1) - rate(n)
  end
end

local path = chain:solver { rule = "blanes-moan(6)", h = 0.2 }:run { q = q, v = v, t = T, every = 1250 }
local function strain(row, n) return exp(row[n] - row[n + 1]) - 1 end

-- c from three strains around the top: f = cosh(k (n - c)), f(n+1) - f(n-1) = 2 f sinh(k) tanh(k (n - c))
local function centre(row, k, from, to)
  local top = from
  for n = from, to do if strain(row, n) > strain(row, top) then top = n end end
  local function f(n) return 1 / sqrt(strain(row, n)) end
  local x = (f(top + 1) - f(top - 1)) / (2 * f(top) * sinh(k))
  return top - log((1 + x) / (1 - x)) / (2 * k), strain(row, top) / (1 - x ^ 2)
end

local last, shift = path.q[#path], log(sinh(0.9) / sinh(0.3))
for i, s in ipairs(solitons) do
  local free = s.c + T * sinh(s.k) / s.k
  local c, height = centre(last, s.k, free // 1 - 30, free // 1 + 30)
  local expected = (i == 1 and 1 or -1) * shift / s.k
  print(("k = %.1f: displaced by %+.5f bodies (theory %+.5f), height %.6f"):format(s.k, c - free, expected, height))
  assert(math.abs(c - free - expected) < 1e-4, "displaced as Hirota says")
  assert(math.abs(height / sinh(s.k) ^ 2 - 1) < 1e-4, "and of the same height")
end
assert(path:drift("energy").largest < 1e-5 and path:drift(path:momentum(dm.R(1))).largest < 1e-10, "energy and momentum kept")

local rows, time = {}, path:column "time"
for i = 1, #path do
  rows[i] = { x = {}, y = {}, name = ("t = %.0f"):format(time[i]) }
  for n = 100, 1600 do rows[i].x[n - 99], rows[i].y[n - 99] = n, strain(path.q[i], n) end
end
print("picture  " .. dm.plot(rows, { file = picture, title = "Two Toda solitons: one overtakes the other",
  xlabel = "body", ylabel = "exp(q_n - q_(n+1)) - 1", size = { 1100, 560 } }))
