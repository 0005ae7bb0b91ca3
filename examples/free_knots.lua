-- Where should eight elements stand to catch a boundary layer? -u'' = f with a layer of width 1/20 at x = 1:
-- least energy over values and knots alike (Leok 5.6).
local dm = require "dm"

local e, N = 0.05, 8
local c = 1 - math.exp(-1 / e)
local function exact(x) return x - (math.exp(-(1 - x) / e) - math.exp(-1 / e)) / c end
local function f(x) return math.exp(-(1 - x) / e) / (e ^ 2 * c) end

-- energy of the solution itself: u' = 1 - exp(-(1-x)/e)/(e c), the integral of -u'^2/2
local energy = -(1 / (4 * e * c ^ 2) * (1 - math.exp(-2 / e)) - 0.5)
local function distance(x, u)                -- largest error between knots
  local worst = 0
  for k = 1, #x - 1 do
    for j = 0, 20 do
      local s = j / 20
      local X = x[k] + s * (x[k + 1] - x[k])
      worst = math.max(worst, math.abs(u[k] + s * (u[k + 1] - u[k]) - exact(X)))
    end
  end
  return worst
end

local knots = dm.adapt { W = function(s) return s ^ 2 / 2 end, f = f, x = { 0, 1, N }, ends = { 0, 0 } }
print("knots", knots.x)
print("force", knots.force)

-- the same with equal elements: values at nodes are exact, so only the places differ
local x, u = {}, {}
for i = 0, N do x[i + 1], u[i + 1] = i / N, exact(i / N) end
local fixed, free = distance(x, u), distance(knots.x, knots.u)
print(("largest error %.3f on equal elements, %.4f on free ones; energy above the least: %.4f"):format(fixed, free, knots.energy - energy))
assert(free < fixed / 9 and knots.energy > energy and knots.energy - energy < 0.3)

-- a knot is at rest where the solution's slope is the mean of the slopes beside it
for i = 2, N do
  local left = (knots.u[i] - knots.u[i - 1]) / (knots.x[i] - knots.x[i - 1])
  local right = (knots.u[i + 1] - knots.u[i]) / (knots.x[i + 1] - knots.x[i])
  local slope = 1 - math.exp(-(1 - knots.x[i]) / e) / (e * c)
  assert(math.abs((left + right) / 2 - slope) < 1e-8 and math.abs(knots.force[i]) < 1e-10)
end
if arg and arg[1] then
  local X, U = {}, {}
  for k = 0, 400 do X[k + 1], U[k + 1] = k / 400, exact(k / 400) end
  dm.plot({ { x = X, y = U, name = "solution" }, { x = x, y = u, name = "equal elements" },
    { x = knots.x, y = knots.u, name = "free knots", style = "linespoints" } }, { file = arg[1] .. "/free_knots.png", xlabel = "x", ylabel = "u",
      title = "eight elements and a layer" })
end
