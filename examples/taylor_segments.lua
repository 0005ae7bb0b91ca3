-- Taylor methods as curve segments (Cuell & Patrick 2008, example 2): f:along(x, u) is the derivative of f along u, so that a
-- method can write the series of the flow. The bare method spirals away from Kepler's ellipse; made variational it keeps angular
-- momentum to round-off and its energy without drift, and has the same order.
local dm = require "dm"
local abs, log = math.abs, math.log
local picture = (arg and arg[1] or ".") .. "/taylor_segments.png"

local function taylor(order)
  return function(x, f, h)
    local x1 = f(x)
    local x2 = f:along(x, x1)
    local y = x + h * x1 + h ^ 2 / 2 * x2
    if order == 2 then return y end
    local x3 = f:along(x, x1, x1) + f:along(x, x2)
    y = y + h ^ 3 / 6 * x3
    if order == 3 then return y end
    return y + h ^ 4 / 24 * (f:along(x, x1, x1, x1) + 3 * f:along(x, x1, x2) + f:along(x, x3))
  end
end

local start = { q = { 0.8, 0.3 }, v = { -0.2, 1.1 } } -- on an ellipse with e = 0.19, period 5.5
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local T = 4
local goal = kepler:solver { rule = "gauss(4)", h = T / 400 }:run { q = start.q, v = start.v, steps = 400, every = 400 }.q[2]

local curves = {}
for order = 2, 4 do
  local rule, hs, errors = dm.curve { method = taylor(order), order = order }, {}, {}
  for i = 1, 6 do
    local n = 10 * 2 ^ i
    local path = kepler:solver { rule = rule, h = T / n }:run { q = start.q, v = start.v, steps = n, every = n }
    hs[i], errors[i] = T / n, (path.q[2] - goal):norm()
  end
  local long = kepler:solver { rule = rule, h = 0.1 }:run { q = start.q, v = start.v, steps = 20000, every = 20 }
  local J, measured = long:drift(long:momentum(dm.SO(2))), log(errors[5] / errors[6], 2)
  print(("taylor(%d): order %.2f, 20000 steps: energy %+.0e per time, angular momentum off by %.0e"):format(order, measured,
    long:drift "energy".per_time, J.largest))
  assert(abs(measured - order) < 0.3 and J.largest < 1e-12 and abs(long:drift "energy".per_time) < 1e-7)
  curves[#curves + 1] = { x = hs, y = errors, name = "order " .. order, style = "linespoints" }
end

-- the bare method of order 2 over the same time, with the third derivative by hand
local q, v, h = dm.vector(start.q), dm.vector(start.v), 0.1
local E0 = v:dot(v) / 2 - 1 / q:norm()
for _ = 1, 2000 do
  local r = q:norm()
  local a, jerk = -q / r ^ 3, -v / r ^ 3 + 3 * q:dot(v) * q / r ^ 5
  q, v = q + h * v + h ^ 2 / 2 * a, v + h * a + h ^ 2 / 2 * jerk
end
local lost = (v:dot(v) / 2 - 1 / q:norm() - E0) / 200
print(("bare taylor(2): energy %+.0e per time over 2000 steps"):format(lost))
assert(abs(lost) > 1e-4)

local file = dm.plot(curves, { log = "xy", xlabel = "h", ylabel = "error of q at t = 4",
  title = "Taylor methods as curve segments, on a Kepler ellipse", file = picture })
print("picture: " .. file)
