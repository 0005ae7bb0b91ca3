-- A pendulum whose rod is a stiff spring (Leok 5.7): how large a step does each rule bear?
-- The spring's frequency omega = sqrt(k/m) is a thousand times what one wants to see. Verlet blows up
-- once h omega > 2, however slow the swing; the implicit midpoint rule steps over the vibration.
local dm = require "dm"
local abs, max = math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/stiff_spring.png"

local m, l, g, k = 1, 1, 9.81, 1e6  -- kg, m, m/s^2, N/m
local omega = math.sqrt(k / m)
local pendulum = dm.system { name = "pendulum on a stiff spring", Q = dm.R(2),
  L = function(q, v)
    local stretch = q:norm() - l
    return m * v:dot(v) / 2 - m * g * q[2] - k * stretch ^ 2 / 2
  end }

-- released at 45 degrees from the vertical with the spring at its natural length
local angle = math.pi / 4
local start = { q = { l * math.sin(angle), -l * math.cos(angle) }, v = { 0, 0 } }
local swing = m * g * l * (1 - math.cos(angle))  -- energy of the swing, J

-- largest energy error over 5000 steps in units of the swing's energy; a run that is lost counts as 1e9
local function energy_error(rule, h)
  local solver = pendulum:solver { rule = rule, h = h }
  local fine, path = pcall(solver.run, solver, { q = start.q, v = start.v, steps = 5000 })
  if not fine then return 1e9 end  -- the numbers overflowed, or a step had no solution
  local E, worst = path:energy(), 0
  for i = 1, #E do worst = max(worst, abs(E[i] - E[1])) end
  return worst / swing < 1e9 and worst / swing or 1e9
end

local scaled, errors, limit, worst = {}, { verlet = {}, midpoint = {} }, 0, 0
for i = 1, 64 do
  scaled[i] = (i - 0.5) / 16
  for rule, list in pairs(errors) do list[i] = energy_error(rule, scaled[i] / omega) end
  if errors.verlet[i] < 1e-3 then limit = scaled[i] end
  worst = max(worst, errors.midpoint[i])
end
print(("verlet keeps the energy up to h omega = %.4f (theory: 2)"):format(limit))
print(("midpoint: energy error at most %.1e of the swing's up to h omega = 4"):format(worst))
for i = 1, 64 do
  assert(errors.verlet[i] < 1e-3 == (scaled[i] < 2), "Verlet holds below the limit and fails above it")
end
assert(worst < 1e-3, "the midpoint rule holds on both sides")

print("picture  " .. dm.plot({ { x = scaled, y = errors.verlet, name = "verlet" },
    { x = scaled, y = errors.midpoint, name = "midpoint" } },
  { log = "y", yrange = { 1e-10, 1e4 }, style = "linespoints", title = "Pendulum on a stiff spring, 5000 steps",
    xlabel = "h sqrt(k/m)", ylabel = "energy error / energy of the swing", file = picture }))
