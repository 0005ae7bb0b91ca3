-- Henon and Heiles (1964): is a star's motion in a galaxy orderly or chaotic?
-- L = (v1^2 + v2^2 - q1^2 - q2^2)/2 - q1^2 q2 + q2^3/3, cut where q1 = 0 and p1 > 0. At E = 1/12 the cuts
-- of an orbit lie on curves; at E = 1/8 some orbits fill areas, and neighbours part exponentially.
local dm = require "dm"
local sqrt, abs, max = math.sqrt, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/henon_heiles.png"

local star = dm.system { name = "Henon-Heiles", Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 - q:dot(q) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3
end }
local solver = star:solver { rule = "verlet", h = 0.02 }

-- start on the cut with energy E at (q2, p2)
local function on_cut(E, q2, p2)
  return { q = { 0, q2 }, v = { sqrt(2 * E - p2 ^ 2 - q2 ^ 2 + 2 * q2 ^ 3 / 3), p2 } }
end

-- largest Lyapunov exponent and MEGNO (2 where the motion is regular) after t = 2000
local order, chaos = on_cut(1 / 12, -0.2, 0), on_cut(1 / 8, -0.2, 0)
order.t, chaos.t = 2000, 2000
order, chaos = solver:lyapunov(order), solver:lyapunov(chaos)
print(("neighbours part as exp(%.3f t) at E = 1/8, MEGNO %.0f; at E = 1/12 MEGNO is %.2f"):format(
  chaos.exponent, chaos.megno, order.megno))
assert(chaos.exponent > 0.03 and chaos.megno > 20, "the orbit at E = 1/8 should be chaotic")
assert(abs(order.megno - 2) < 0.2, "the one at E = 1/12 should be regular")

local panels, count, worst = { file = picture, title = "Henon-Heiles: cuts at q1 = 0", size = { 1100, 560 } }, 0, 0
for i, E in ipairs { 1 / 12, 1 / 8 } do
  panels[i] = { title = ("E = 1/%.0f"):format(1 / E), legend = false, equal = true, style = "points" }
  local starts = {}
  for j, point in ipairs { { -0.2, 0 }, { 0.3, 0 }, { 0.1, 0 }, { 0, 0.25 }, { 0, -0.25 }, { -0.1, 0 } } do
    starts[j] = on_cut(E, table.unpack(point))
  end
  local section = solver:section { g = "q1", starts = starts, steps = 500000, every = 500 }  -- t = 10000
  for j, series in ipairs(section:series()) do panels[i][j] = series end
  for _, orbit in ipairs(section.orbits) do worst = max(worst, abs(orbit.path:drift("energy").largest)) end
  count = count + section.count
end
print(("%d cuts of 12 orbits, energy error at most %.1e"):format(count, worst))
assert(worst < 1e-4, "energy in its band")
print("picture  " .. dm.figure(panels))
