-- A spherical pendulum hung on a spherical pendulum (Leok 2.10), both below their pivots:
-- do its energy and its angular momentum about the vertical stay put?
-- Coordinates: azimuth theta of the first, radii r1, r2 in the horizontal plane, phi = theta2 - theta1.
local dm = require "dm"
local sqrt, sin, cos, abs, max = math.sqrt, math.sin, math.cos, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/double_spherical_pendulum.png"

local m1, m2, l1, l2, g = 2, 1.5, 1, 0.75, 9.8  -- kg, kg, m, m, m/s^2

local pendulum = dm.system { name = "double spherical pendulum", Q = dm.R(4),
  coordinates = { "theta", "r1", "r2", "phi" },
  units = { t = "s", r1 = "m", r2 = "m", theta = "rad", phi = "rad", energy = "J" },
  L = function(q, v)
    local _, r1, r2, phi = table.unpack(q)
    local z1, z2 = -sqrt(l1 ^ 2 - r1 ^ 2), -sqrt(l2 ^ 2 - r2 ^ 2)
    local c, s, radial, around = cos(phi), sin(phi), v[3], r2 * (v[1] + v[4])
    -- velocities in the frame (radial, around, up) of the first pendulum; w2 relative to it
    local w1 = dm.vector { v[2], r1 * v[1], -r1 * v[2] / z1 }
    local w2 = dm.vector { c * radial - s * around, s * radial + c * around, -r2 * v[3] / z2 }
    local T = m1 * w1:dot(w1) / 2 + m2 * (w1 + w2):dot(w1 + w2) / 2
    return T - m1 * g * z1 - m2 * g * (z1 + z2)
  end }

-- first at (0.6, 0, -0.8) m moving at (0, 2.1, 0) m/s; second, seen from it, at (0.36, 0.27, -0.6)
-- moving at (-0.945, 1.26, 0)
local start = { q = { 0, 0.6, 0.45, math.atan(0.27, 0.36) }, v = { 3.5, 0, 0, 0 } }
local E0, mu = -22.71303125, 7.741125
assert(abs(pendulum:energy(start.q, start.v) - E0) < 1e-13, "energy of the start")
assert(abs(pendulum:momentum(start.q, start.v)[1] - mu) < 1e-14, "angular momentum of the start")

local function run(rule, h, steps, every)
  local path = pendulum:solver { rule = rule, h = h }:run { q = start.q, v = start.v, steps = steps, every = every }
  local E, error, worst, mu_error = path:energy(), {}, 0, 0
  for i = 1, #path do
    error[i] = E[i] / E0 - 1
    worst, mu_error = max(worst, abs(error[i])), max(mu_error, abs(path.p[i][1] - mu))
  end
  return path, error, worst, mu_error
end
local path, error, worst, mu_error = run("gauss(2)", 0.05, 4000, 1)  -- 200 s
local rk4, rk4_error = run("rk4", 0.025, 8000, 2)  -- GSL's rk4 halves each step: h / 4
print(("gauss(2), h = 0.05: relative energy error %.1e, momentum to %.0e"):format(worst, mu_error))
print(("rk4, h = 0.025:     relative energy error %.1e and growing"):format(abs(rk4_error[#rk4])))
assert(worst < 3e-6, "energy should stay in its band")
assert(mu_error < 1e-12, "angular momentum should stay to round-off")
for k = 1, 3 do  -- at the quarters of the run
  assert(abs(rk4_error[1000 * k + 1]) < abs(rk4_error[1000 * (k + 1) + 1]), "RK4 should drift steadily")
end

local x, y = {}, {}
for i = 1, 400 do  -- track of the lower mass from above
  local theta, r1, r2, phi = table.unpack(path.q[i])
  x[i], y[i] = r1 * cos(theta) + r2 * cos(theta + phi), r1 * sin(theta) + r2 * sin(theta + phi)
end
print("picture  " .. dm.figure { title = "Double spherical pendulum", file = picture,
  { x, y, equal = true, xlabel = "x", ylabel = "y", xunit = "m", yunit = "m", title = "lower mass from above, 20 s" },
  { path:series("t", error, "gauss(2), h = 0.05"), rk4:series("t", rk4_error, "rk4, h = 0.025"),
    ylabel = "E/E0 - 1", title = "relative energy error" } })
