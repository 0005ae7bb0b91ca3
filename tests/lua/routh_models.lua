-- the systems of the reduction tests: J2 satellite, double spherical pendulum, charged particle, a group of two dimensions
local dm = require "dm"
local M = {}
local sqrt, sin, cos = math.sqrt, math.sin, math.cos

--- L of a satellite of an oblate planet in (theta, r, z); GM = 1, radius 1
function M.satellite(J2)
  return dm.system { Q = dm.R(3), coordinates = { "theta", "r", "z" }, L = function(q, v)
    local r, z = q[2], q[3]
    local rho = sqrt(r * r + z * z)
    return (v[2] ^ 2 + r * r * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * z * z / rho ^ 2 - 0.5)
  end }
end
M.orbit = { q = { 0, 1, 0 }, v = { 0.96, 0, 0.28 } }

M.m1, M.m2, M.l1, M.l2, M.g = 2, 1.5, 1, 0.75, 9.8

--- double spherical pendulum, q = (theta1, r1, r2, phi), both rods below their joints
function M.pendulum()
  local m1, m2, l1, l2, g = M.m1, M.m2, M.l1, M.l2, M.g
  return dm.system { Q = dm.R(4), coordinates = { "theta1", "r1", "r2", "phi" }, L = function(q, v)
    local r1, r2, phi = q[2], q[3], q[4]
    local t1, t2 = v[1], v[1] + v[4]
    local z1, z2 = -sqrt(l1 ^ 2 - r1 ^ 2), -sqrt(l2 ^ 2 - r2 ^ 2)
    local dz1, dz2 = -r1 * v[2] / z1, -r2 * v[3] / z2
    local c, s = cos(phi), sin(phi)
    local T1 = v[2] ^ 2 + r1 ^ 2 * t1 ^ 2 + dz1 ^ 2
    local T2 = v[2] ^ 2 + r1 ^ 2 * t1 ^ 2 + v[3] ^ 2 + r2 ^ 2 * t2 ^ 2 + 2 * (v[2] * v[3] + r1 * r2 * t1 * t2) * c
      + 2 * (r1 * v[3] * t1 - r2 * v[2] * t2) * s + (dz1 + dz2) ^ 2
    return m1 * T1 / 2 + m2 * T2 / 2 - m1 * g * z1 - m2 * g * (z1 + z2)
  end }
end

-- a start in the chart from horizontal positions and velocities of the two rods
function M.in_chart(a, b, da, db)
  local function polar(x, dx)
    local r = sqrt(x[1] ^ 2 + x[2] ^ 2)
    return r, math.atan(x[2], x[1]), (x[1] * dx[1] + x[2] * dx[2]) / r, (x[1] * dx[2] - x[2] * dx[1]) / r ^ 2
  end
  local r1, t1, dr1, dt1 = polar(a, da)
  local r2, t2, dr2, dt2 = polar(b, db)
  return { q = { t1, r1, r2, t2 - t1 }, v = { dt1, dr1, dr2, dt2 - dt1 } }
end
M.safe = M.in_chart({ 0.6, 0 }, { 0.36, 0.27 }, { 0, 2.1 }, { -0.945, 1.26 })         -- mu = 7.741125
M.near_pole = M.in_chart({ 0.6, 0 }, { 0.27, 0.36 }, { 0.4, 1.2 }, { -0.64, -0.02 })  -- mu = 3.1095

--- particle of Kaluza and Klein, q = (theta, x, y), with the potential A(x, y) of a magnetic field
function M.particle(A)
  return dm.system { Q = dm.R(3), L = function(q, v)
    local a = A(q[2], q[3])
    return (v[2] ^ 2 + v[3] ^ 2 + (v[1] + a[1] * v[2] + a[2] * v[3]) ^ 2) / 2
  end }
end

--- q = (theta1, theta2, x, y) with a connection that is not flat, and one with inertia that depends on the shape
function M.two_angles()
  return dm.system { Q = dm.R(4), L = function(q, v)
    local x, y = q[3], q[4]
    local a = v[1] - 0.3 * y * v[3] + 0.2 * x * v[4]
    local b = v[2] + 0.1 * v[3] + 0.4 * x * y * v[4]
    return (v[3] ^ 2 + v[4] ^ 2) / 2 + (2 * a * a + a * b + b * b) / 2 - (x * x + 2 * y * y) / 2 - 0.1 * x * x * y
  end }
end

--- largest difference of the q of two paths
function M.apart(a, b)
  local worst = 0
  for i = 1, #a do
    for k = 1, #a.q[i] do worst = math.max(worst, math.abs(a.q[i][k] - b.q[i][k])) end
  end
  return worst
end

return M
