-- Where does a ball go that rolls on a turning table? Not off it: its centre goes around a circle, at 2/7 of the table's rate for a
-- solid ball, wherever it was put and however it was pushed (Earnshaw 1844). The table drives it, so its energy is not kept, but the
-- circle closes. On SO(3) x R^2, with the condition that the ball does not slip (Lagrange-d'Alembert).
local dm = require "dm"
local sqrt, cos, sin, pi, max, log = math.sqrt, math.cos, math.sin, math.pi, math.max, math.log
local picture = (arg and arg[1] or ".") .. "/turntable.png"

local G, rate = dm.SO(3), 1.4
local ball = dm.system { name = "ball on a turntable", Q = dm.product(G, dm.R(2)),
  L = function(_, v) return 0.2 * (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) + (v[4] ^ 2 + v[5] ^ 2) / 2 end,
  rolling = function(q, v)                                     -- velocity of the ball where it touches, less that of the table
    local w = q[1] * dm.vector { v[1], v[2], v[3] }
    return { v[4] + rate * q[2][2] - w[2], v[5] - rate * q[2][1] + w[1] }
  end }

-- x' is turned at 2/7 of the rate: the centre of the circle is x + J x'/(2/7 rate)
local omega, period = 2 / 7 * rate, 2 * pi / (2 / 7 * rate)
local function roll(x, v, rule, n)
  -- the spin that does not slip: w = (rate x1 - v2, v1 + rate x2, any)
  local start = { q = { G:identity(), x }, v = { rate * x[1] - v[2], v[1] + rate * x[2], 0.7, v[1], v[2] } }
  start.steps = n
  local path = ball:solver { rule = rule, h = period / n }:run(start)
  assert(path:worst "rolling" < 1e-12, "it slips")
  local centre, worst = { x[1] - v[2] / omega, x[2] + v[1] / omega }, 0
  local a, b = x[1] - centre[1], x[2] - centre[2]
  for i = 1, #path do
    local c, s, y = cos(omega * path.t[i]), sin(omega * path.t[i]), path.q[i][2]
    worst = max(worst, sqrt((y[1] - centre[1] - c * a + s * b) ^ 2 + (y[2] - centre[2] - s * a - c * b) ^ 2))
  end
  return worst, path
end

local lines = { log = "xy", style = "linespoints", xlabel = "steps a revolution", ylabel = "distance from the circle", title = "error" }
for _, row in ipairs { { "lie(1)", 2, 40 }, { "lie(2)", 4, 160 }, { "lie(3)", 6, 20 } } do
  local ns, errors = { row[3], 2 * row[3], 4 * row[3] }, {}
  for k, n in ipairs(ns) do errors[k] = roll({ 0.5, 0.2 }, { -0.38, 0.4 }, row[1], n) end
  local order = log(errors[2] / errors[3], 2)
  print(("%s: off the circle by %.1e, %.1e, %.1e, order %.2f"):format(row[1], errors[1], errors[2], errors[3], order))
  assert(order > row[2] - 0.3, "order of " .. row[1])
  lines[#lines + 1] = { x = ns, y = errors, name = row[1] }
end
local tracks = { equal = true, xlabel = "x", ylabel = "y", title = "centres of three balls" }
for k, v in ipairs { { -0.38, 0.4 }, { 0.1, 0.2 }, { 0.3, -0.3 } } do
  local worst, path = roll({ 0.5, 0.2 }, v, "lie(3)", 100)
  assert(worst < 1e-7)
  local x, y = {}, {}
  for i = 1, #path do x[i], y[i] = path.q[i][2][1], path.q[i][2][2] end
  tracks[k] = { x = x, y = y, name = ("pushed by (%g, %g)"):format(v[1], v[2]) }
end
print("picture  " .. dm.figure { tracks, lines, title = "Balls on a turntable", file = picture })
