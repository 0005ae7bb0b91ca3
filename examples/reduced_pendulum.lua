-- Figures 2.7 to 2.9 of Leok: the double spherical pendulum without its azimuth. Does the reduced rule of order 4 keep the energy for a
-- hundred swings, does RK4, and are the reduced rule as it is written, with connection and magnetic form, and the one for the classical Routhian the same?
local dm = require "dm"
local sqrt, sin, cos, abs, max = math.sqrt, math.sin, math.cos, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/reduced_pendulum.png"

local m1, m2, l1, l2, g = 2, 1.5, 1, 0.75, 9.8
local pendulum = dm.system { name = "double spherical pendulum", Q = dm.R(4), coordinates = { "theta", "r1", "r2", "phi" }, L = function(q, v)
  local _, r1, r2, phi = table.unpack(q)
  local z1, z2 = -sqrt(l1 ^ 2 - r1 ^ 2), -sqrt(l2 ^ 2 - r2 ^ 2)
  local c, s, radial, around = cos(phi), sin(phi), v[3], r2 * (v[1] + v[4])
  -- velocities in the frame (radial, around, up) of the first pendulum; w2 relative to it
  local w1 = dm.vector { v[2], r1 * v[1], -r1 * v[2] / z1 }
  local w2 = dm.vector { c * radial - s * around, s * radial + c * around, -r2 * v[3] / z2 }
  return (m1 * w1:dot(w1) + m2 * (w1 + w2):dot(w1 + w2)) / 2 - m1 * g * z1 - m2 * g * (z1 + z2)
end }
local q, v = { 0, 0.6, 0.45, math.atan(0.27, 0.36) }, { 3.5, 0, 0, 0 }

local shape = pendulum:routh { cyclic = { "theta" }, q = q, v = v }
local x, u, theta = shape:start(q, v)
print(shape)
print("connection at the start", shape:connection(x))
local path = shape:solver { rule = "rsprk(gauss(2))", h = 0.05 }:run { q = x, v = u, steps = 4000 }
local whole = path:reconstruct { theta = theta }
local rk4 = pendulum:solver { rule = "rk4", h = 0.025 }:run { q = q, v = v, steps = 8000, every = 2 }  -- GSL's rk4 halves each step

local function energy_error(p)
  local E, out, worst = p:energy(), {}, 0
  for i = 1, #p do
    out[i] = E[i] / E[1] - 1
    worst = max(worst, abs(out[i]))
  end
  return out, worst
end
local reduced_error, worst = energy_error(path)
local rk4_error, drift = energy_error(rk4)
print(("relative energy error over %g s: reduced %.1e, RK4 %.1e"):format(path.t[#path], worst, drift))
assert(worst < 2.2e-6 and abs(rk4_error[4001]) > abs(rk4_error[2001]), "bounded, and steadily drifting")

-- as it is written, in (x, s) with s = p - mu A, next to the classical Routhian's steps
local step, apart, a, s = shape:rsprk { rule = "gauss(2)", h = 0.05 }, {}, x, shape:magnetic_momentum(x, path.p[1])
for i = 1, 200 do
  a, s = step(a, s)
  apart[i] = max((a - path.q[i + 1]):norm(), (s - shape:magnetic_momentum(path.q[i + 1], path.p[i + 1])):norm(), 1e-17)
end
print(("as written and by the classical Routhian: %.1e apart after %d steps"):format(apart[#apart], #apart))
assert(apart[#apart] < 1e-11)

local t, east, north = {}, {}, {}
for i = 1, 400 do
  local th, r1, r2, phi = table.unpack(whole.q[i])
  t[i], east[i], north[i] = whole.t[i], r1 * cos(th) + r2 * cos(th + phi), r1 * sin(th) + r2 * sin(th + phi)
end
local function first(name) return { x = t, y = { table.unpack(path:column(name):totable(), 1, 400) }, name = name } end
print("picture  " .. dm.figure { file = picture, columns = 2, width = 1000, height = 720,
  { first "r1", first "r2", first "phi", xlabel = "t (s)", ylabel = "r (m), phi (rad)", title = "shape" },
  { east, north, equal = true, xlabel = "x (m)", ylabel = "y (m)", title = "lower mass from above, 20 s" },
  { path:series("t", reduced_error, "reduced gauss(2), h = 0.05"), rk4:series("t", rk4_error, "rk4, two halves of 0.025"), xlabel = "t (s)", ylabel = "E/E0 - 1", title = "relative energy error" },
  { { table.unpack(path:column("t"):totable(), 2, 201) }, apart, log = "y", xlabel = "t (s)", ylabel = "difference (m, kg m/s)", title = "as written - classical Routhian" } })
