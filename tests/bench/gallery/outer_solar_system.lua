-- the Sun and the five outer planets; data of Hairer, Lubich and Wanner, I.2.4
local dm = require "dm"
local G = 2.95912208286e-4
local m = { 1.00000597682, 0.000954786104043, 0.000285583733151, 0.0000437273164546, 0.0000517759138449, 1 / 1.3e8 }
local function of(i, z) return z:slice(3 * i - 2, 3 * i) end
return {
  title = "Outer solar system, 20,000 days",
  text = [[Nearly circular orbits and an expensive force. Gauss rules win from four digits on: their stages go through vector registers side by side. Rules that know
that the Sun dominates (Wisdom and Holman) would win by more; they are not rules for any Lagrangian, and not in this table.]],
  { dm.system { Q = dm.R(18), L = function(q, v)
      local L = 0
      for i = 1, 6 do
        L = L + m[i] * of(i, v):dot(of(i, v)) / 2
        for j = 1, i - 1 do L = L + G * m[i] * m[j] / (of(i, q) - of(j, q)):norm() end
      end
      return L
    end },
    q = { 0, 0, 0, -3.5023653, -3.8169847, -1.5507963, 9.0755314, -3.0458353, -1.6483708, 8.3101420, -16.2901086, -7.2521278, 11.4707666,
      -25.7294829, -10.8169456, -15.5387357, -25.2225594, -3.1902382 },
    v = { 0, 0, 0, 0.00565429, -0.00412490, -0.00190589, 0.00168318, 0.00483525, 0.00192462, 0.00354178, 0.00137102, 0.00055029, 0.00288930,
      0.00114527, 0.00039677, 0.00276725, -0.00170702, -0.00136504 }, t = 20000,
    rules = { "verlet", "blanes-moan(4)", "blanes-moan(6)", "kahan-li(8)", "sofroniou-spaletta(10)", "gauss(4)", "gauss(6)", "rk8" },
    h = { 400, 200, 100, 50, 25 } },
}
