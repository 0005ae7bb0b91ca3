-- Airy (1851): how fast does the ellipse of a pendulum turn, that does not swing in a plane?
-- A unit mass on a rod of length 1, stepped in space on the constraint |q|^2 = 1: L = v.v/2 - z. The horizontal ellipse
-- with half axes a, b turns in the sense of the motion, by 3/8 a b sqrt(g / length) in a unit of time, to first order in a b.
-- The exact turn from one far point to the next is twice Psi = J int_{z1}^{z2} dz / ((1 - z^2) sqrt(2 (E - z)(1 - z^2) - J^2)).
local dm = require "dm"
local sqrt, sin, pi, atan, abs = math.sqrt, math.sin, math.pi, math.atan, math.abs
local picture = (arg and arg[1] or ".") .. "/spherical_pendulum.png"

local pendulum = dm.system { name = "spherical pendulum", Q = dm.R(3), coordinates = { "x", "y", "z" },
  L = function(q, v) return v:dot(v) / 2 - q[3] end,
  constraint = function(q) return q:dot(q) - 1 end }

-- from the far point at x = a with the speed u across; the next ones lie where the height is largest again
local function turn(a, u, rule, h, t)
  local path = pendulum:solver({ rule = rule, h = h }):run { q = { a, 0, -sqrt(1 - a ^ 2) }, v = { 0, u, 0 }, t = t }
  local angle, far = 0, 0
  for i = 3, #path do
    local before, after = path.p[i - 1][3], path.p[i][3]
    if before > 0 and after <= 0 then
      local part = before / (before - after)
      local function azimuth(k) return atan(path.q[k][2], path.q[k][1]) end
      local step = (azimuth(i) - azimuth(i - 1) + pi) % (2 * pi) - pi
      local now = azimuth(i - 1) + part * step
      angle, far = now + pi * math.floor((angle - now) / pi + 1.5), far + 1
    end
  end
  return angle / far, path
end

-- z = (z1 + z2)/2 + (z2 - z1)/2 sin s takes both roots out of the cubic 2 (z - z1)(z2 - z)(z3 - z); the rest is periodic in s
local function exact(a, u)
  local z2, J = -sqrt(1 - a ^ 2), a * u
  local E = u ^ 2 / 2 + z2
  -- the other two roots of (E - z)(1 - z^2) - J^2/2 = z^3 - E z^2 - z + E - J^2/2
  local sum, product = E - z2, -(E - J ^ 2 / 2) / z2
  local root = sqrt(sum ^ 2 / 4 - product)
  local z1, z3, psi, N = sum / 2 - root, sum / 2 + root, 0, 400
  for k = 1, N do
    local z = (z1 + z2) / 2 + (z2 - z1) / 2 * sin(2 * pi * (k - 0.5) / N)
    psi = psi + J / ((1 - z ^ 2) * sqrt(2 * (z3 - z))) * pi / N
  end
  return 2 * psi
end

for _, case in ipairs { { 0.1, 0.05 }, { 0.6, 0.3 }, { 0.95, 0.4 } } do
  local a, b = table.unpack(case)
  local goal, airy = exact(a, b) - pi, 3 / 8 * a * b * pi
  local measured = turn(a, b, "kahan-li(8, rattle)", 0.02, 100) - pi
  print(("a = %.2f, speed %.2f: turns by %.8f at a far point, exactly %.8f, by Airy %.8f"):format(a, b, measured, goal, airy))
  assert(abs(measured / goal - 1) < 1e-4, "the exact turn")
  if a == 0.1 then assert(abs(goal / airy - 1) < 0.02, "and Airy's, where the ellipse is small") end
end
local _, path = turn(0.6, 0.3, "rattle", 0.02, 60)
assert(path:worst "constraint" < 1e-14 and path:drift("energy").largest < 1e-4, "on the sphere, with its energy")
print("picture  " .. path:plot("x", "y", { file = picture, title = "Spherical pendulum from above", equal = true }))
