-- the double spherical pendulum by angles, folded and turning: a motion near a relative equilibrium that the magnetic term stabilizes
local dm = require "dm"
local sin, cos = math.sin, math.cos
local m1, m2, l1, l2, g = 2, 1.5, 1, 0.75, 9.8
local whole = dm.system { Q = dm.R(4), L = function(q, v)
  local _, a, b, phi = table.unpack(q)
  local around = l2 * sin(b) * (v[1] + v[4])
  local w1 = dm.vector { l1 * cos(a) * v[2], l1 * sin(a) * v[1], l1 * sin(a) * v[2] }
  local out, c, s = l2 * cos(b) * v[3], cos(phi), sin(phi)
  local w2 = dm.vector { c * out - s * around, s * out + c * around, l2 * sin(b) * v[3] }
  return (m1 * w1:dot(w1) + m2 * (w1 + w2):dot(w1 + w2)) / 2 + (m1 + m2) * g * l1 * cos(a) + m2 * g * l2 * cos(b)
end }
return {
  title = "Folded double spherical pendulum near its relative equilibrium",
  text = [[The shape swings with a small amplitude about the folded equilibrium at mu = 2, which is no minimum of the amended potential: the magnetic term holds it. The motion is
smooth and short: rk8 wins or is level at every accuracy here, as the energy that it loses does not show yet.]],
  { whole:routh { cyclic = { 1 }, mu = 2 }, q = { 0.33, -0.85, 0.05 }, v = { 0, 0, 0 }, t = 10,
    rules = { "gauss(1)", "gauss(2)", "gauss(3)", "gauss(4)", "gauss(6)", "rk4", "rk8" }, h = { 0.1, 0.05, 0.025, 0.0125 } },
}
