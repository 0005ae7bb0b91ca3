-- a rod as a constraint in space, beside the same pendulum in angles
local dm = require "dm"
local sin, cos = math.sin, math.cos
local h = { 0.2, 0.1, 0.05, 0.025, 0.0125 }
return {
  title = "Spherical pendulum, three hundred units of time",
  text = [[The rod as a constraint in space, and as rivals the same motion in two angles, by Gauss and by explicit Runge-Kutta methods (error: the coordinate x
of the mass, in both). RATTLE is cheapest for two digits; beyond that rk8 in angles wins, since two angles are fewer unknowns than three coordinates and a
multiplier, and it solves nothing. What the chart does not show: angles have a pole, and an orbit near it needs small steps or breaks; the constraint knows none.]],
  { dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end },
    q = { 0.6, 0, -0.8 }, v = { 0, 0.5, 0 }, t = 300, error = function(q) return q[1] end,
    rules = { "rattle", "yoshida(4, rattle)", "kahan-li(8, rattle)", "gauss(4)" }, h = h },
  { dm.system { Q = dm.R(2), L = function(q, v)
      return (v[1] ^ 2 + sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + cos(q[1])
    end }, suffix = "in angles", q = { math.asin(0.6), 0 }, v = { 0, 0.5 / 0.6 }, t = 300, error = function(q) return sin(q[1]) * cos(q[2]) end,
    rules = { "gauss(4)", "rk4", "rk8" }, h = h },
}
