-- the double spherical pendulum of Leok 2.10 without its azimuth
local dm = require "dm"
local sqrt, sin, cos = math.sqrt, math.sin, math.cos
local m1, m2, l1, l2, g = 2, 1.5, 1, 0.75, 9.8
local whole = dm.system { Q = dm.R(4), L = function(q, v)
  local _, r1, r2, phi = table.unpack(q)
  local z1, z2 = -sqrt(l1 ^ 2 - r1 ^ 2), -sqrt(l2 ^ 2 - r2 ^ 2)
  local c, s, radial, around = cos(phi), sin(phi), v[3], r2 * (v[1] + v[4])
  local w1 = dm.vector { v[2], r1 * v[1], -r1 * v[2] / z1 }
  local w2 = dm.vector { c * radial - s * around, s * radial + c * around, -r2 * v[3] / z2 }
  return (m1 * w1:dot(w1) + m2 * (w1 + w2):dot(w1 + w2)) / 2 - m1 * g * z1 - m2 * g * (z1 + z2)
end }
local q, v = { 0, 0.6, 0.45, math.atan(0.27, 0.36) }, { 3.5, 0, 0, 0 }
return {
  title = "Double spherical pendulum without its azimuth, ten swings",
  text = [[Three coordinates and a mass matrix that varies: every rule is implicit or evaluates accelerations from it. rk8 wins
for four digits, Gauss rules from six on.]],
  { whole:routh { cyclic = { 1 }, q = q, v = v }, q = { 0.6, 0.45, q[4] }, v = { 0, 0, 0 }, t = 10,
    rules = { "gauss(1)", "gauss(2)", "gauss(3)", "gauss(4)", "gauss(6)", "rk4", "rk8" }, h = { 0.1, 0.05, 0.025, 0.0125 } },
}
