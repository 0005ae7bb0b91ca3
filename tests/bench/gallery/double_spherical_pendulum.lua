-- the double spherical pendulum of Leok 2.10, in azimuth and radii
local dm = require "dm"
local sqrt, sin, cos = math.sqrt, math.sin, math.cos
local m1, m2, l1, l2, g = 2, 1.5, 1, 0.75, 9.8
return {
  title = "Double spherical pendulum, ten seconds",
  text = [[L does not separate: the mass depends on the shape, and the chart has an edge where a pendulum is level. No splitting applies; the rules are
implicit or not symplectic. For a rough answer the explicit method of order 8 wins, since it solves nothing; from six digits on gauss(4) does. A step that is too
large costs Newton iterations, so that the coarsest points of implicit rules may be dearer than finer ones.]],
  { dm.system { Q = dm.R(4), L = function(q, v)
      local _, r1, r2, phi = table.unpack(q)
      local z1, z2 = -sqrt(l1 ^ 2 - r1 ^ 2), -sqrt(l2 ^ 2 - r2 ^ 2)
      local c, s, radial, around = cos(phi), sin(phi), v[3], r2 * (v[1] + v[4])
      local w1 = dm.vector { v[2], r1 * v[1], -r1 * v[2] / z1 }
      local w2 = dm.vector { c * radial - s * around, s * radial + c * around, -r2 * v[3] / z2 }
      local T = m1 * w1:dot(w1) / 2 + m2 * (w1 + w2):dot(w1 + w2) / 2
      return T - m1 * g * z1 - m2 * g * (z1 + z2)
    end }, q = { 0, 0.6, 0.45, math.atan(0.27, 0.36) }, v = { 3.5, 0, 0, 0 }, t = 10,
    rules = { "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "lobatto(4)", "rk4", "rk8" }, h = { 0.1, 0.05, 0.025, 0.0125, 0.00625 } },
}
