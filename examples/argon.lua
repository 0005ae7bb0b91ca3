-- 864 atoms of argon in a periodic box: does the liquid stay one, and at what pressure? (Rahman 1964, Verlet 1967)
-- Lennard-Jones units; pairs within 2.5 by lists that are kept until an atom has moved half the margin.
local dm = require "dm"
local abs = math.abs
local n, density, cut = 6, 0.8442, 2.5
local N = 4 * n ^ 3 // 1 | 0
local L = (N / density) ^ (1 / 3)
local random = dm.random(1)

local q, v = {}, {}
for i = 0, n - 1 do for j = 0, n - 1 do for k = 0, n - 1 do
  for _, b in ipairs { { 0, 0, 0 }, { 0.5, 0.5, 0 }, { 0.5, 0, 0.5 }, { 0, 0.5, 0.5 } } do
    for c, x in ipairs { i, j, k } do q[#q + 1], v[#v + 1] = (x + b[c]) * L / n, random:normal(#q, 0, 0, 1.44 ^ 0.5) end
  end
end end end
for c = 1, 3 do -- at rest as a whole
  local sum = 0
  for i = c, 3 * N, 3 do sum = sum + v[i] end
  for i = c, 3 * N, 3 do v[i] = v[i] - sum / N end
end

local edge = 4 * (cut ^ -12 - cut ^ -6) -- the potential ends at 0
local function U(a, b)
  local d = a - b
  local s = 1 / d:dot(d) ^ 3
  return 4 * (s * s - s) - edge
end
local liquid = dm.system { Q = dm.R(3 * N), L = function(x, u)
  return dm.sum_over(u, function(w) return w ^ 2 / 2 end) - dm.sum_over(x, U, { pairs = true, block = 3, within = cut, margin = 0.3, box = L })
end }
local run = liquid:solver { rule = "verlet", h = 0.004 }:run { q = q, v = v, steps = 500, every = 25 }
local energy, p = run:drift "energy", run.p[#run]
local temperature, momentum = p:dot(p) / (3 * N), 0
for c = 1, 3 do
  local sum = 0
  for i = c, 3 * N, 3 do sum = sum + p[i] end
  momentum = math.max(momentum, abs(sum))
end
print(run)
print(("energy an atom %.5f, kept to %.1e; temperature %.3f; momentum %.1e"):format(energy.mean / N, energy.largest / abs(energy.mean), temperature, momentum))
assert(energy.largest < 2e-3 * abs(energy.mean), "the energy of a liquid is kept")
assert(momentum < 1e-9, "momentum is kept to round-off")
assert(temperature > 0.6 and temperature < 0.9, "half of the heat goes into the potential as the crystal melts")
