-- A double pendulum in oil: does a coarse step take out as much energy as the oil does?
-- Rods by two constraints in the plane (x1, y1, x2, y2), drag -c v on both masses. What the drag takes is c times
-- the integral of v^2, so that E + c int v^2 dt must stay; RK4 (in angles) takes energy of its own.
local dm = require "dm"
local sin, cos, abs, max = math.sin, math.cos, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/damped_double_pendulum.png"
local m, l, g, c, T = 1, 1, 9.81, 0.002, 400  -- kg, m, m/s^2, kg/s, s
local pendulum = dm.system { name = "double pendulum in oil", Q = dm.R(4), coordinates = { "x1", "y1", "x2", "y2" },
  units = { t = "s", x1 = "m", y1 = "m", x2 = "m", y2 = "m", energy = "J" },
  L = function(q, v) return m * v:dot(v) / 2 - m * g * (q[2] + q[4]) end,
  constraint = function(q) return { q[1] ^ 2 + q[2] ^ 2 - l ^ 2, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - l ^ 2 } end,
  force = function(_, v) return -c * v end }
local a, b = 0.3, -0.42  -- released from there in the fast swing, rad
local start = { q = { l * sin(a), -l * cos(a), l * (sin(a) + sin(b)), -l * (cos(a) + cos(b)) }, v = { 0, 0, 0, 0 } }
local floor = -3 * m * g * l  -- at rest
local swing0 = pendulum:energy(start.q, start.v) - floor

local lines, options = {}, { xlabel = "t", ylabel = "energy of the swing / at the start", xunit = "s", file = picture, title = "Double pendulum in oil" }
local function draw(name, energy, h)
  local t, y = {}, {}
  for k = 1, #energy, 25 do t[#t + 1], y[#y + 1] = (k - 1) * h, energy[k] / swing0 end
  lines[#lines + 1] = { x = t, y = y, name = name .. ", h = " .. h }
  return energy[#energy] / swing0
end
print "rule            h   energy left   balance off by   rods off by"
local left = {}
for _, row in ipairs { { "gauss(4)", 0.01, 1e-5 }, { "gauss(2)", 0.08, 1e-2 }, { "midpoint", 0.08, 0.1 } } do
  local rule, h, bound = table.unpack(row)
  local path = pendulum:solver { rule = rule, h = h }:run { q = start.q, v = start.v, t = T }
  local E, took, off, v2 = path:energy(), 0, 0, 0
  for i = 1, #path do  -- the integral by trapezoids
    local now = path.p[i]:dot(path.p[i]) / m ^ 2
    took, v2, E[i] = took + (i > 1 and c * h * (v2 + now) / 2 or 0), now, E[i] - floor
    off = max(off, abs(E[i] + took - swing0) / swing0)
  end
  left[rule] = draw(rule, E, h)
  print(("%-12s %5.2f %11.4f %16.1e %13.0e"):format(rule, h, left[rule], off, path:worst "constraint"))
  assert(off < bound and abs(left[rule] - left["gauss(4)"]) < 0.02, rule .. ": only the drag should take energy")
  assert(path:worst "constraint" < 1e-14, rule .. ": the rods should keep their lengths")
end

-- RK4 in the angles: M = (2, d; d, 1), d = cos(x - y), and the drag is -c M u
local h, z, energy = 0.08, dm.vector { a, b, 0, 0 }, {}
local function field(x, y, u, w)
  local d, s = cos(x - y), sin(x - y)
  local r1, r2 = -s * w * w - 2 * g / l * sin(x), s * u * u - g / l * sin(y)
  return dm.vector { u, w, (r1 - d * r2) / (2 - d * d) - c / m * u, (2 * r2 - d * r1) / (2 - d * d) - c / m * w }
end
for i = 1, T // h + 1 do
  local x, y, u, w = table.unpack(z)
  energy[i] = m * l * l * (u * u + w * w / 2 + cos(x - y) * u * w) - m * g * l * (2 * cos(x) + cos(y)) - floor
  local k1 = field(x, y, u, w)
  local k2 = field(table.unpack(z + h / 2 * k1))
  local k3 = field(table.unpack(z + h / 2 * k2))
  z = z + h / 6 * (k1 + 2 * k2 + 2 * k3 + field(table.unpack(z + h * k3)))
end
local share = draw("RK4", energy, h)
print(("RK4          %5.2f %11.4f"):format(h, share))
assert(share < 0.8 * left["gauss(4)"], "RK4 should take energy of its own")
print("picture  " .. dm.plot(lines, options))
