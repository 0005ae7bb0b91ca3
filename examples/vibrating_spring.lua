-- A pendulum on a spring that vibrates a thousand times as fast as it swings (Leok 5.7): must steps
-- follow the vibration? Not if the curve of a step has it: powers of t beside sin(w t) and cos(w t),
-- integrated by Filon's weights. A step then costs the same however stiff the spring.
local dm = require "dm"
local cos, sqrt, abs = math.cos, math.sqrt, math.abs
local picture = (arg and arg[1] or ".") .. "/vibrating_spring.png"

local g = 9.81  -- unit mass and length
local function spring(k)
  return dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
    return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + g * (1 + q[1]) * cos(q[2]) - k * q[1] ^ 2 / 2
  end }
end
local start = { q = { 0.01, 0.8 }, v = { 0, 0 } }  -- stretched by 1 %, 46 degrees from the vertical
local function run(k, rule, h, more)
  local given = { q = start.q, v = start.v }
  for key, value in pairs(more) do given[key] = value end
  return spring(k):solver { rule = rule, h = h }:run(given)
end

-- the frequency, read off ten resolved periods
local short = run(1e6, "gauss(3)", 2e-4, { steps = 1000 })
local omega = short:frequency "a"
print(("frequency of the stretch: %.2f, sqrt(k/m) = 1000"):format(omega))
assert(abs(omega - 1000) < 1)

-- theta after a second in eight steps, for springs a thousand to a hundred million times as stiff
local cost = {}
for _, k in ipairs { 1e3, 1e4, 1e5, 1e6 } do
  local rule = dm.multiscale { frequency = sqrt(k), degrees = { 2, 3 } }
  local path = run(k, rule, 1 / 8, { steps = 8 })
  local truth = run(k, "gauss(6)", 0.25 / sqrt(k), { at = { 1 } })
  local plain = run(k, "midpoint", 1 / 8, { steps = 8 })
  cost[#cost + 1] = path.solver:report().newton_per_step
  print(("k = %.0e: theta off by %.1e, midpoint %.1e; stretch by %.1e, %.1e; %.1f iterations a step")
    :format(k, abs(path.q[9][2] - truth.q[1][2]), abs(plain.q[9][2] - truth.q[1][2]),
      abs(path.q[9][1] - truth.q[1][1]), abs(plain.q[9][1] - truth.q[1][1]), cost[#cost]))
  assert((path.q[9] - truth.q[1]):norm() < 1e-5, "both, in steps that do not see the vibration")
  assert(abs(plain.q[9][1] - truth.q[1][1]) > 1e-3 or k == 1e3, "midpoint loses the stretch")
end
assert(cost[4] <= cost[1], "the cost does not grow with the stiffness")

-- what eight steps know of the vibration: rows inside a step are read off its curve
local times = {}
for i = 1, 400 do times[i] = 0.5 * i / 400 end
local rule = dm.multiscale { frequency = 100, degrees = { 2, 3 } }
local coarse, fine = run(1e4, rule, 1 / 8, { at = times }), run(1e4, "gauss(6)", 2.5e-3, { at = times })
print("picture  " .. dm.plot({ { x = times, y = fine:column "a", name = "gauss(6), h = 1/400" },
    { x = times, y = coarse:column "a", name = "multiscale, h = 1/8", style = "points" } },
  { xlabel = "t", ylabel = "stretch", title = "Stretch of the spring, k = 10^4: four steps", file = picture }))
