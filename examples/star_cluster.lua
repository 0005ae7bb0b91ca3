-- A cluster of 1000 stars: how near is it to balance after it fell together? (Henon 1964: twice the kinetic energy is minus the potential one)
-- All pairs, softened; units in which mass, G and the radius of the cluster are 1.
local dm = require "dm"
local abs = math.abs
local N, soft = 1000, 0.02
local random = dm.random(3)

-- a ball of even density, nearly at rest: it falls together and shakes itself into balance
local q, v, mass = {}, {}, {}
for i = 1, N do
  local r, z, phi = random:uniform(i, 0) ^ (1 / 3), 2 * random:uniform(i, 1) - 1, 2 * math.pi * random:uniform(i, 2)
  local s = (1 - z * z) ^ 0.5
  for c, x in ipairs { s * math.cos(phi), s * math.sin(phi), z } do q[3 * i - 3 + c], v[3 * i - 3 + c] = r * x, 0.35 * random:normal(i, 2 + c) end
  mass[i] = 1 / N
end
local cluster = dm.system { Q = dm.R(3 * N), L = function(x, u)
  return dm.sum_over(u, mass, function(w, m) return m * w:dot(w) / 2 end, { block = 3 })
    + dm.sum_over(x, mass, function(a, m, b, k) local d = a - b return m * k / (d:dot(d) + soft ^ 2) ^ 0.5 end, { pairs = true, block = 3 })
end }
local run = cluster:solver { rule = "verlet", h = 0.01 }:run { q = q, v = v, t = 6, every = 20 }
local E, ratio, late = run:column "energy", {}, 0
for i = 1, #run do
  local kinetic = N * run.p[i]:dot(run.p[i]) / 2
  ratio[i] = 2 * kinetic / abs(E[i] - kinetic)
  if run.t[i] > 4 then late = math.max(late, abs(ratio[i] - 1)) end
end
local first = 0
for i = 1, #run do if run.t[i] < 2 then first = math.max(first, ratio[i]) end end
print(run)
print(("2 T / |U|: %.3f at the start, %.3f as it falls together, within %.2f of 1 after t = 4"):format(ratio[1], first, late))
assert(ratio[1] < 0.8 and first > 1.05 and late < 0.25, "it shakes itself into balance")
assert(run:drift("energy").largest < 1e-3 * abs(E[1]), "the energy is kept")
