-- Bernoulli (1732): with which frequencies does a chain of n = 30 rods hang and swing?
-- Masses 1/n in the plane, joined by massless rods of length 1/n: L = sum m (v_i^2/2 - g y_i), and one constraint a rod,
-- |x_i - x_(i-1)|^2 = l^2. Small swings of the hanging chain have frequencies w^2 = g lambda / l, where lambda are the zeros
-- of Laguerre's polynomial of degree n (for n -> infinity w = z/2 sqrt(g / length) with zeros z of Bessel's J_0).
-- By constraints a step costs n times the same, not n^3; large swings are stepped with the same equations.
local dm = require "dm"
local sqrt, abs, n, g, l, m = math.sqrt, math.abs, 30, 1, 1 / 30, 1 / 30
local picture = (arg and arg[1] or ".") .. "/pendulum_chain.png"

local chain = dm.system { name = "chain of 30 rods", Q = dm.R(2 * n), L = function(q, v)
  local L = m * v:dot(v) / 2
  for i = 1, n do L = L - m * g * q[2 * i] end
  return L
end, constraint = function(q)
  local rods, x, y = {}, 0, 0
  for i = 1, n do
    rods[i] = ((q[2 * i - 1] - x) ^ 2 + (q[2 * i] - y) ^ 2) / l ^ 2 - 1
    x, y = q[2 * i - 1], q[2 * i]
  end
  return rods
end }

-- Laguerre's polynomial by its recurrence, its smallest zero by bisection, and the shape x_i = L_(n-i)(lambda) of that swing
local function laguerre(k, x)
  local a, b = 0, 1
  for j = 0, k - 1 do a, b = b, ((2 * j + 1 - x) * b - j * a) / (j + 1) end
  return b
end
local low, high = 0, 2 / n
for _ = 1, 60 do
  if laguerre(n, (low + high) / 2) > 0 then low = (low + high) / 2 else high = (low + high) / 2 end
end
local w = sqrt(g * low / l)
-- hung a little aside in that shape, exactly on the rods, and let go
local aside, x, y = dm.vector(2 * n), 0, 0
for i = 1, n do
  local dx = 1e-4 * (laguerre(n - i, low) - laguerre(n - i + 1, low))
  x, y = x + dx, y - sqrt(l ^ 2 - dx ^ 2)
  aside[2 * i - 1], aside[2 * i] = x, y
end
local period = 2 * math.pi / w
local path = chain:solver({ rule = "yoshida(4, rattle)", h = period / 400 }):run {
  q = aside, v = dm.vector(2 * n), t = 10 * period, every = 4000 }
local tip = path.q[#path][2 * n - 1] / path.q[1][2 * n - 1]
print(("slowest swing: w = %.6f (a rope: %.6f); after 10 periods the tip is at %.8f of its start"):format(w, 2.404825557695773 / 2, tip))
assert(abs(tip - 1) < 1e-6, "the chain swings as Laguerre's zero says")

-- held out level and dropped
local level = dm.vector(2 * n)
for i = 1, n do level[2 * i - 1] = i * l end
local solver = chain:solver { rule = "rattle", h = 2e-4 }
path = solver:run { q = level, v = dm.vector(2 * n), t = 2, every = 1000 }
print(path, ("%d operations a step"):format(solver:report().operations))
assert(path:worst "constraint" < 1e-12 and path:drift("energy").largest < 1e-5, "rods and energy kept")
local shapes = {}
for k = 1, #path do
  shapes[k] = { x = { 0 }, y = { 0 }, name = ("t = %.1f"):format(path.t[k]) }
  for i = 1, n do shapes[k].x[i + 1], shapes[k].y[i + 1] = path.q[k][2 * i - 1], path.q[k][2 * i] end
end
print("picture  " .. dm.plot(shapes, { file = picture, title = "A chain of 30 rods, held level and dropped", xlabel = "x", ylabel = "y", equal = true }))
