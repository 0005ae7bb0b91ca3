-- The Sun and the five outer planets for 200,000 days: do they keep their periods?
-- Astronomical units, days, solar masses; data of 5 September 1994 (Hairer, Lubich, Wanner, I.2.4).
local dm = require "dm"
local abs, max, pi = math.abs, math.max, math.pi
local picture = (arg and arg[1] or ".") .. "/outer_solar_system.png"
local G = 2.95912208286e-4
local bodies = {  -- mass, position, velocity, sidereal period
  { "Sun", 1.00000597682, { 0, 0, 0 }, { 0, 0, 0 } },
  { "Jupiter", 0.000954786104043, { -3.5023653, -3.8169847, -1.5507963 }, { 0.00565429, -0.00412490, -0.00190589 }, 4332.6 },
  { "Saturn", 0.000285583733151, { 9.0755314, -3.0458353, -1.6483708 }, { 0.00168318, 0.00483525, 0.00192462 }, 10759 },
  { "Uranus", 0.0000437273164546, { 8.3101420, -16.2901086, -7.2521278 }, { 0.00354178, 0.00137102, 0.00055029 }, 30687 },
  { "Neptune", 0.0000517759138449, { 11.4707666, -25.7294829, -10.8169456 }, { 0.00288930, 0.00114527, 0.00039677 }, 60190 },
  { "Pluto", 1 / 1.3e8, { -15.5387357, -25.2225594, -3.1902382 }, { 0.00276725, -0.00170702, -0.00136504 } },
}
local q0, v0 = {}, {}
for i, body in ipairs(bodies) do
  for k = 1, 3 do q0[3 * i - 3 + k], v0[3 * i - 3 + k] = body[3][k], body[4][k] end
end
local function of(i, z) return z:slice(3 * i - 2, 3 * i) end  -- body i's part of a vector

local solar = dm.system { name = "outer solar system", Q = dm.R(18), units = { t = "d", q = "AU" },
  L = function(q, v)
    local L = 0
    for i, a in ipairs(bodies) do
      L = L + a[2] * of(i, v):dot(of(i, v)) / 2
      for j = 1, i - 1 do L = L + G * a[2] * bodies[j][2] / (of(i, q) - of(j, q)):norm() end
    end
    return L
  end }
local path = solar:solver { rule = "verlet", h = 20 }:run { q = q0, v = v0, steps = 10000, every = 5 }
-- orbit of body i about the Sun, and its mean period: slope of the angle in the x-y plane of the data
local function follow(i)
  local x, y, angle = {}, {}, {}
  for k = 1, #path do
    local r = of(i, path.q[k]) - of(1, path.q[k])
    local last, now = angle[k - 1] or 0, math.atan(r[2], r[1])
    x[k], y[k], angle[k] = r[1], r[2], last + (now - last + pi) % (2 * pi) - pi
  end
  return x, y, 2 * pi / path:drift(dm.vector(angle)).per_time
end
local orbits = {}
for i = 2, #bodies do
  local name, known, x, y, period = bodies[i][1], bodies[i][5], follow(i)
  orbits[#orbits + 1] = { x = x, y = y, name = name }
  print(("%-8s period %6.0f days%s"):format(name, period, known and (", known %6.0f"):format(known) or ""))
  assert(not known or abs(period / known - 1) < 0.002, name .. " should keep its period to 0.2 %")
end

-- energy in a band; total and angular momentum to round-off, so the centre of mass moves evenly
local E, J, worst_E, worst_P, worst_J = path:energy(), path:momentum(dm.SO(3)), 0, 0, 0
for k = 1, #path do
  local P = dm.zeros(3)
  for i = 1, #bodies do P = P + of(i, path.p[k]) - of(i, path.p[1]) end
  worst_E, worst_P = max(worst_E, abs(E[k] / E[1] - 1)), max(worst_P, P:norm())
  worst_J = max(worst_J, (J[k] - J[1]):norm() / J[1]:norm())
end
print(("relative energy error %.1e, total momentum to %.0e, angular momentum to %.0e"):format(worst_E, worst_P, worst_J))
assert(worst_E < 1e-4 and worst_P < 1e-18 and worst_J < 1e-12, "conservation laws")
print("picture  " .. dm.plot(orbits, { equal = true, title = "Outer solar system, 200,000 days", xlabel = "x",
  ylabel = "y", xunit = "AU", yunit = "AU", file = picture, size = { 720, 640 } }))
