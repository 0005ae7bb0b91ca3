-- Kepler's ellipse, e = 0.6, for a thousand periods: which rule keeps it?
-- Verlet and the midpoint rule keep the energy in a band and the angular momentum to round-off. RK4,
-- given as many force evaluations a period as Verlet, loses energy, and the orbit with it.
local dm = require "dm"
local pi, sqrt, abs, max = math.pi, math.sqrt, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/kepler.png"

local kepler = dm.system { name = "Kepler", Q = dm.R(2),
  L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }

local e, periods, T = 0.6, 1000, 2 * pi
local q0, v0 = { 1 - e, 0 }, { 0, sqrt((1 + e) / (1 - e)) }  -- pericentre of the ellipse with semi-axis 1
local E0, J0 = -1 / 2, sqrt(1 - e ^ 2)

-- largest |E - E0| in each period of n steps
local function energy_errors(E, n)
  local worst = {}
  for period = 1, periods do
    worst[period] = 0
    for i = (period - 1) * n + 1, period * n + 1 do worst[period] = max(worst[period], abs(E[i] - E0)) end
  end
  return worst
end

local orbits = { title = "the last ten periods", equal = true, xlabel = "q1", ylabel = "q2" }
local errors = { title = "largest energy error in a period", log = "y", xlabel = "period", ylabel = "|E - E0|" }
for i, case in ipairs { { "verlet", 240 }, { "midpoint", 240 }, { "rk4", 40 } } do
  local rule, n = table.unpack(case)  -- n steps a period
  local solver = kepler:solver { rule = rule, h = T / n }
  local path = solver:run { q = q0, v = v0, steps = periods * n }
  local E, J, J_error = energy_errors(path:energy(), n), path:momentum(dm.SO(2)), 0
  for k = 1, #path do J_error = max(J_error, abs(abs(J[k]) - J0)) end
  print(("%-9s %4.0f evaluations a period: energy error %.4f in the first, %.4f in the last; momentum %.0e")
    :format(rule, solver:report().evaluations / periods, E[1], E[periods], J_error))
  if rule == "rk4" then
    assert(E[periods] > 100 * E[1] and J_error > 0.01, "RK4 should lose energy and angular momentum")
  else
    assert(max(table.unpack(E)) < 1.1 * E[1], rule .. " should keep the energy in its band")
    assert(J_error < 1e-12, rule .. " should keep the angular momentum to round-off")
  end

  local x, y, period = {}, {}, {}
  for k = #path - 10 * n, #path do x[#x + 1], y[#y + 1] = path.q[k][1], path.q[k][2] end
  for k = 1, periods do period[k] = k end
  orbits[i], errors[i] = { x = x, y = y, name = rule }, { x = period, y = E, name = rule }
end
print("picture  " .. dm.figure { orbits, errors, file = picture, size = { 1100, 480 },
  title = "Kepler's ellipse, e = 0.6, a thousand periods" })
