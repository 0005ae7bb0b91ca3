-- A satellite of an oblate planet: how fast does the plane of its orbit turn?
-- L = T - V with V = -1/r + J2/r^3 (3 z^2/(2 r^2) - 1/2): Leok 2.9, with the sign that attracts.
-- Units: planet's radius 1, G M = 1. To first order in J2 the node of a circular orbit of radius 1
-- regresses by 3/2 J2 cos i radians per unit of time; J2 = 0.05 is 46 times the Earth's.
local dm = require "dm"
local pi, abs, cos, max = math.pi, math.abs, math.cos, math.max
local picture = (arg and arg[1] or ".") .. "/satellite.png"

local function satellite(J2)
  return dm.system { name = "J2 satellite", Q = dm.R(3), coordinates = { "x", "y", "z" },
    L = function(q, v)
      local r, z = q:norm(), q[3]
      return v:dot(v) / 2 + 1 / r - J2 / r ^ 3 * (3 * z ^ 2 / (2 * r ^ 2) - 1 / 2)
    end }
end

-- angle of the ascending node along a path, made continuous
local function node(path)
  local angle, last, turns = {}, nil, 0
  for i = 1, #path do
    local J = path.q[i]:cross(path.p[i])
    local now = math.atan(J[1], -J[2])
    if last and now - last > pi then turns = turns - 1 elseif last and last - now > pi then turns = turns + 1 end
    angle[i], last = now + 2 * pi * turns, now
  end
  return dm.vector(angle)
end

local function run(J2)
  local path = satellite(J2):solver { rule = "gauss(2)", h = 0.05 }:run {
    q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, steps = 6000, every = 2 }  -- t = 300
  local angle = node(path)
  return path, angle, path:drift(angle).per_time
end

local inclination = math.atan(0.28, 0.96)
local path, angle, rate = run(0.05)
local _, _, slow = run(0.001)
local E, worst_E, worst_J = path:energy(), 0, 0
for i = 1, #path do
  local q, p = path.q[i], path.p[i]
  worst_E = max(worst_E, abs(E[i] / E[1] - 1))
  worst_J = max(worst_J, abs(q[1] * p[2] - q[2] * p[1] - 0.96))
end
print(("node rate %.4f rad per unit for J2 = 0.05, %.6f for 0.001 (first order: %.6f)")
  :format(rate, slow, -1.5 * 0.001 * cos(inclination)))
print(("relative energy error %.1e, vertical angular momentum to %.0e"):format(worst_E, worst_J))
assert(abs(rate + 0.0887) < 2e-4, "node rate at J2 = 0.05")
assert(abs(slow / (-1.5 * 0.001 * cos(inclination)) - 1) < 0.01, "small J2: first-order theory within 1 %")
assert(worst_E < 1e-5 and worst_J < 1e-12, "energy bounded, momentum to round-off")

-- the picture: the orbit seen from a little above the equator while its node goes round once
local x, tilted = {}, {}
for i = 1, math.ceil(2 * pi / abs(rate) / 0.1) do
  local q = path.q[i]
  x[i], tilted[i] = q[1], q[3] + 0.3 * q[2]
end
print("picture  " .. dm.figure { { x, tilted, equal = true, xlabel = "x", ylabel = "z + 0.3 y", title = "one turn of the node" },
  { path:series("t", angle), title = "ascending node", ylabel = "angle", yunit = "rad" },
  title = "J2 satellite, J2 = 0.05, inclination 16°", file = picture })
