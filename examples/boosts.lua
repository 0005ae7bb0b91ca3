-- What does a boost do to a wave? u(x, t) that solves the heat equation or Korteweg and de Vries' goes to another solution: prolonged
-- to jets, the group keeps the equation. And what a falling body keeps of its boosts needs a divergence (Bogfjellmo 2.3; Olver).
local dm = require "dm"
local exp, abs, cosh = math.exp, math.abs, function(x) return (math.exp(x) + math.exp(-x)) / 2 end
local picture = (arg and arg[1] or ".") .. "/boosts.png"
local function acting(name, map) return dm.action { name = name, group = dm.R(1), on = dm.R(3), map = map } end

-- u_t = u_xx: x -> x + 2 e t, u -> u exp(-e x - e^2 t), on jets x, t, u, u_x, u_t, u_xx, u_xt, u_tt; exp(a^2 t + a x) solves it
local jets = acting("boosts", function(e, z) return { z[1] + 2 * e[1] * z[2], z[2], z[3] * dm.exp(-e[1] * z[1] - e[1] ^ 2 * z[2]) } end)
  :jet(2, { independent = { 1, 2 } })
local worst = 0
for i = 1, 50 do
  local x, t, a = -2 + 0.08 * i, 0.3 + 0.02 * i, 1 + 0.01 * i
  local u = exp(a ^ 2 * t + a * x)
  local z = jets({ 0.7 }, { x, t, u, a * u, a ^ 2 * u, a ^ 2 * u, a ^ 3 * u, a ^ 4 * u })
  worst = math.max(worst, abs(z[5] - z[6]) / abs(z[5]))
end
print(("heat equation: |u_t - u_xx| of the moved solution, at most %.0e of u_t"):format(worst))
assert(worst < 1e-12, "a solution goes to a solution")

-- u_t + 6 u u_x + u_xxx = 0: Galilei's x -> x + 6 e t, u -> u + e; a soliton gets another speed and a background
local third = acting("Galilei's boosts", function(e, z) return { z[1] + 6 * e[1] * z[2], z[2], z[3] + e[1] } end):jet(3, { independent = { 1, 2 } })
local soliton = dm.trace(function(z) return 8 / (dm.exp(z[1] - 4 * z[2]) + dm.exp(4 * z[2] - z[1])) ^ 2 end, 2)
local slope = dm.derivative(soliton, 2)
local second = dm.derivative(slope, 2)
local cubic = dm.derivative(function(z) return second(z)[1][1] end, 2)
worst = 0
for i = -20, 20 do
  local at = { 0.15 * i, 0.1 }
  local g, H = slope(at), second(at)
  local z = third({ 0.4 }, { at[1], at[2], soliton(at), g[1], g[2], H[1][1], H[1][2], H[2][2], cubic(at)[1], 0, 0, 0 })
  worst = math.max(worst, abs(z[5] + 6 * z[3] * z[4] + z[9]))
end
print(("Korteweg and de Vries: residual of the boosted soliton, at most %.0e"):format(worst))
assert(worst < 1e-12, "the boost solves the equation")

-- a stone: what its boosts keep is found, up to a divergence
local fall = dm.system { name = "stone", Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - 9.81 * q[1] end }
local _, _, symmetry = dm.action { group = dm.R(1), on = dm.R(2), map = function(e, z) return { z[1] + e[1] * z[2], z[2] } end }:invariant(fall)
local N = fall:solver { rule = "verlet", h = 0.01 }:run { q = { 2 }, v = { 3 }, steps = 200 }:noether(symmetry)
print(("stone: %s; it keeps %.9f to %.0e"):format(tostring(symmetry), N[1], abs(N[201] - N[1])))
assert(abs(N[201] - N[1]) < 1e-12 and N[1] == -2, "where it began")

-- the crests, as a page that moves, and both waves
local columns = { {}, {}, {}, {}, {} }
for k = 0, 120 do
  local t = k / 60
  for i, x in ipairs { t, 4 * t, 6.4 * t, 0, 0 } do columns[i][k + 1] = x end
end
dm.path { system = dm.system { name = "crests", Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end }, h = 1 / 60, columns = columns }
  :animate(picture:gsub("png$", "html"), { title = "crests of a soliton, and of the boosted one", plots = { "q1", "q2" }, draw = function(q) return { points = { { q[1], 2 }, { q[2], 2.4 } } } end })
local waves = { { title = "a soliton", xlabel = "x", ylabel = "u" }, { title = "boosted by 0.4", xlabel = "x", ylabel = "u" } }
for k, t in ipairs { 0, 0.5, 1 } do
  for j, e in ipairs { 0, 0.4 } do
    local x, u = {}, {}
    for i = 1, 161 do x[i], u[i] = -4 + 0.1 * (i - 1), e + 2 / cosh(-4 + 0.1 * (i - 1) - (4 + 6 * e) * t) ^ 2 end
    waves[j][k] = { x = x, y = u, name = "t = " .. t }
  end
end
print("picture  " .. dm.figure { waves[1], waves[2], file = picture, size = { 1100, 480 }, title = "Boosts of a wave" })
