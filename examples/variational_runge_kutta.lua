-- Kepler's ellipse, e = 0.6, for a thousand periods: what does a Runge-Kutta method gain when it is made variational?
-- The same explicit method, of order 4, draws the curve of a step. Bare, the end of the curve is the next state.
-- Variational, curves are joined so that the sum of their actions is stationary (Cuell and Patrick 2008): a step costs
-- some iterations more, is as accurate, and keeps the symplectic form, the angular momentum and the energy's band.
local dm = require "dm"
local pi, sqrt, abs, max = math.pi, math.sqrt, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/variational_runge_kutta.png"

local kepler = dm.system { name = "Kepler", Q = dm.R(2),
  L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local e, periods, n, T = 0.6, 1000, 60, 2 * pi  -- n steps a period
local start = { q = { 1 - e, 0 }, v = { 0, sqrt((1 + e) / (1 - e)) }, steps = periods * n }

-- orders, on a quarter of the orbit
local function order(rule)
  local goal = kepler:solver { rule = "gauss(8)", h = T / 4 / 100 }:run { q = start.q, v = start.v, steps = 100 }.q[101]
  local errors = {}
  for i, steps in ipairs { 100, 200 } do
    errors[i] = (kepler:solver { rule = rule, h = T / 4 / steps }:run { q = start.q, v = start.v, steps = steps }.q[steps + 1] - goal):norm()
  end
  return math.log(errors[1] / errors[2], 2)
end

local orbits = { title = "the last ten periods", equal = true, xlabel = "q1", ylabel = "q2" }
local errors = { title = "largest energy error in a period", log = "y", xlabel = "period", ylabel = "|E + 1/2|" }
local cost = {}
for i, case in ipairs { { "bare", "rk4" }, { "variational", dm.curve "gsl-rk4" } } do
  local name, rule = table.unpack(case)
  local solver = kepler:solver { rule = rule, h = T / n }
  local path = solver:run(start)
  local E, J, worst, J_error = path:energy(), path:momentum(dm.SO(2)), {}, 0
  for k = 1, #J do J_error = max(J_error, abs(J[k] - J[1])) end
  for period = 1, periods do
    worst[period] = 0
    for k = (period - 1) * n + 1, period * n + 1 do worst[period] = max(worst[period], abs(E[k] + 0.5)) end
  end
  cost[i] = solver:report().ns_per_step
  print(("%-11s order %.2f; energy error %.1e in the first period, %.1e in the last; momentum %.0e; %.0f ns a step")
    :format(name, order(rule), worst[1], worst[periods], J_error, cost[i]))
  if i == 1 then
    assert(worst[periods] > 100 * worst[1] and J_error > 1e-3, "bare, it should lose energy and angular momentum")
  else
    assert(max(table.unpack(worst)) < 1.5 * worst[1] and J_error < 1e-12, "variational, it should keep both")
  end
  local x, y, period = {}, {}, {}
  for k = #path - 10 * n, #path do x[#x + 1], y[#y + 1] = path.q[k][1], path.q[k][2] end
  for k = 1, periods do period[k] = k end
  orbits[i], errors[i] = { x = x, y = y, name = name }, { x = period, y = worst, name = name }
end
print("picture  " .. dm.figure { orbits, errors, file = picture, size = { 1100, 480 },
  title = "Runge-Kutta of order 4 on Kepler's ellipse, e = 0.6, 60 steps a period, a thousand periods" })
