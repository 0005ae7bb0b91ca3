-- Figures 2.2 to 2.5 of Leok: can one see in a picture of an orbit whether it precesses, or whether its integrator does?
-- Unreduced, a ribbon is a ribbon. In the shape space (r, z) of the J2 satellite without its angle only the physics makes a band: the
-- midpoint rule with a step of a twentieth of an orbit makes the node of a Kepler orbit creep, and leaves the reduced curve thin.
local dm = require "dm"
local sqrt, cos, sin, abs, pi, min, max = math.sqrt, math.cos, math.sin, math.abs, math.pi, math.min, math.max
local picture = (arg and arg[1] or ".") .. "/reduced_satellite.png"

local function satellite(J2)  -- (theta, r, z), radius of the planet 1, G M = 1
  return dm.system { name = "J2 satellite", Q = dm.R(3), coordinates = { "theta", "r", "z" }, L = function(q, v)
    local r, z = q[2], q[3]
    local rho = sqrt(r * r + z * z)
    return (v[2] ^ 2 + r * r * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * z * z / rho ^ 2 - 0.5)
  end }
end

-- the turning of the ascending node per unit of time, and columns of the track seen from 17 degrees above the equator
local function track(path)
  local x, y, node, last, turns = {}, {}, {}, nil, 0
  for i = 1, #path do
    local q, p = path.q[i], path.p[i]
    local c, s, r = cos(q[1]), sin(q[1]), q[2]
    x[i], y[i] = r * c, q[3] + 0.3 * r * s
    -- horizontal angular momentum: z times the radial velocity minus r times the vertical one, and its part along theta
    local out, around = -q[3] * p[1] / r, q[3] * p[2] - r * p[3]
    local now = math.atan(out * c - around * s, -(out * s + around * c))
    if last and now - last > pi then turns = turns - 1 elseif last and last - now > pi then turns = turns + 1 end
    node[i], last = now + 2 * pi * turns, now
  end
  return x, y, path:drift(node).per_time
end

local panels, wanted = { file = picture, columns = 4, width = 1300, height = 620 }, {
  { "exact motion, J2 = 0", 0, "gauss(6)", 0.1, 0, 1 }, { "exact motion, J2 = 0.05", 0.05, "gauss(6)", 0.1, -0.0887, 0.8549 },
  { "midpoint, h = 0.3, J2 = 0", 0, "midpoint", 0.3, 0.00831, 0.99555 }, { "midpoint, h = 0.3, J2 = 0.05", 0.05, "midpoint", 0.3, -0.0734, 0.8498 } }
for k, case in ipairs(wanted) do
  local name, J2, rule, h, rate, inner = table.unpack(case)
  local shape = satellite(J2):routh { cyclic = { "theta" }, mu = 0.96 }
  local path = shape:solver { rule = rule, h = h }:run { q = { 1, 0 }, v = { 0, 0.28 }, t = 300 }
  local whole = path:reconstruct()
  local x, y, turning = track(whole)
  local least, most = math.huge, 0
  for i = 1, #path do
    local rho = path.q[i]:norm()
    least, most = min(least, rho), max(most, rho)
  end
  print(("%-30s node %+.4f rad per unit, distance from the centre %.4f to %.4f"):format(name, turning, least, most))
  assert(abs(turning - rate) < 2e-4 and abs(least - inner) < 2e-4, name)
  assert((most - least > 0.1) == (J2 > 0), "only J2 makes a band")
  panels[k] = { x, y, title = name, xlabel = "x (radii)", ylabel = "z + 0.3 y (radii)", equal = true }
  panels[4 + k] = { path:column "r", path:column "z", title = "reduced: r, z", xlabel = "r (radii)", ylabel = "z (radii)", xrange = { 0.8, 1.02 }, yrange = { -0.3, 0.3 } }
end
print("picture  " .. dm.figure(panels))
