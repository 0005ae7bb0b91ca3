-- A pendulum with friction, by a discrete Lagrangian of one's own: where does the force of a step belong? The discrete
-- Lagrange-d'Alembert principle (Leok 2.8.2; Marsden & West 2001, 3.2) asks for F1 at the start of the step and F2 at its
-- end. Half and half keeps the order of Ld; all of it at one end costs an order, however good Ld is.
local dm = require "dm"
local cos, abs, log, max = math.cos, math.abs, math.log, math.max
local picture = (arg and arg[1] or ".") .. "/own_forces.png"
local c, T = 0.2, 8 -- friction, duration

local function Ld(a, b, h)
  local v, q = (b[1] - a[1]) / h, (a[1] + b[1]) / 2
  return h * (v ^ 2 / 2 + cos(q))
end
local function friction(share) -- of the force that acts at the start of the step
  return function(a, b)
    local f = -c * (b[1] - a[1]) -- h times the force -c v
    return { { share * f }, { (1 - share) * f } }
  end
end

local function pendulum(share, n)
  local system = dm.discrete_lagrangian { Q = dm.R(1), h = T / n, Ld = Ld, force = friction(share), coordinates = { "theta" } }
  return dm.solver { system }:run { q = { 2 }, p = { 0 }, steps = n }
end

-- the same pendulum as a system with a force, by a rule of order 8
local exact = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end,
  force = function(q, v) return { -c * v[1] } end }:solver { rule = "gauss(4)", h = T / 512 }
  :run { q = { 2 }, v = { 0 }, steps = 512, every = 32 }

local curves = {}
for _, row in ipairs { { 0.5, "half and half", 2 }, { 1, "all at q0", 1 }, { 0, "all at q1", 1 } } do
  local hs, errors = {}, {}
  for i = 1, 5 do
    local n = 16 * 2 ^ i
    local path, worst = pendulum(row[1], n), 0
    for k = 1, 17 do worst = max(worst, abs(path.q[(k - 1) * n // 16 + 1][1] - exact.q[k][1])) end
    hs[i], errors[i] = T / n, worst
  end
  local order = log(errors[4] / errors[5], 2)
  print(("%-14s error at h = %.4f: %.1e, order %.2f"):format(row[2], hs[5], errors[5], order))
  assert(abs(order - row[3]) < 0.1, row[2] .. ": not of order " .. row[3])
  curves[#curves + 1] = { x = hs, y = errors, name = row[2], style = "linespoints" }
end

local file = dm.plot(curves, { log = "xy", xlabel = "h", ylabel = "largest error of theta", yunit = "rad",
  title = "where the force of a step acts", file = picture })
print("picture: " .. file)
