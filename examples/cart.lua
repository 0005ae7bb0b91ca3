-- A pendulum balanced on a cart: how slowly may a digital controller sample?
-- q = (x, theta), theta from upright; the controller sees the state at the start of a step and holds its force over the step, as a
-- sampled controller does. Its gains put the roots of the continuous, linear loop at -2, -2, -3, -3. The step is the sampling period:
-- gauss(4) is exact enough for any of them, so that what is seen is the sampling, not the integrator.
local dm = require "dm"
local cos, abs, max = math.cos, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/cart.png"

local M, m, l, g = 1, 0.2, 0.5, 9.81  -- kg, kg, m, m/s^2
local a, b, c, e = (M + m) * g / (M * l), 1 / (M * l), 1 / M, g / (M * l)
local k1, k2 = 36 / e, 60 / e
local k3, k4 = (37 + a + c * k1) / b, (10 + c * k2) / b

local cart = dm.system { name = "pendulum on a cart", Q = dm.R(2), coordinates = { "x", "theta" },
  L = function(q, v)
    return (M + m) * v[1] ^ 2 / 2 + m * l * v[1] * v[2] * cos(q[2]) + m * l ^ 2 * v[2] ^ 2 / 2 - m * g * l * cos(q[2])
  end,
  control = function(q, v) return { k1 * q[1] + k2 * v[1] + k3 * q[2] + k4 * v[2] } end,
  force = function(_, _, _, u) return { u[1], 0 } end }

-- the angle over 8 s, and whether the pendulum stays up
local function balance(period)
  local fine, path = pcall(function()
    return cart:solver({ rule = "gauss(4)", h = period }):run { q = { 0, 0.3 }, v = { 0, 0 }, t = 8,
      events = { fallen = { g = function(q) return q[2] ^ 2 - 1.5 ^ 2 end, stop = true } } }
  end)
  if not fine then path = path.path end
  return path, fine and #path.events == 0 and abs(path.q[#path][2]) < 0.05
end

-- the longest period that keeps it up, by bisection
local good, bad = 0.01, 0.5
assert(select(2, balance(good)) and not select(2, balance(bad)))
while bad - good > 1e-3 do
  local middle = (good + bad) / 2
  if select(2, balance(middle)) then good = middle else bad = middle end
end
print(("it comes to rest with a sample every %.3f s, not every %.3f s"):format(good, bad))
assert(good > 0.05 and good < 0.3, "between what is comfortable and half a swing")

-- while it works nothing but the controller takes energy out: with frequent samples the loop is the continuous one
local path = balance(0.002)
local worst = 0
for i = 1, #path do
  if path.t[i] > 6 then worst = max(worst, abs(path.q[i][1]), abs(path.q[i][2])) end
end
assert(worst < 2e-3, "roots at -2 and -3: after 6 s the start is forgotten")
local panels = { file = picture, title = "Pendulum on a cart, force held between samples", size = { 1000, 420 } }
for i, column in ipairs { "theta", "x" } do
  panels[i] = { title = i == 1 and "angle" or "cart", xlabel = "t", xunit = "s", ylabel = column, yunit = i == 1 and "rad" or "m" }
  for j, period in ipairs { 0.002, 0.1, bad + 0.02 } do
    local run = balance(period)
    panels[i][j] = { x = run:column "t", y = run:column(column), name = ("every %.3g s"):format(period) }
  end
end
print("picture  " .. dm.figure(panels))
