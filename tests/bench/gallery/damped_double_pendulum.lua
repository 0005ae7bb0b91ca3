-- the double pendulum in oil by constraints, beside angles
local dm = require "dm"
local sin, cos, g, c = math.sin, math.cos, 9.81, 0.002
local a, b = 0.3, -0.42
local h = { 0.2, 0.1, 0.05, 0.025, 0.0125 }
return {
  title = "Double pendulum in oil, two minutes",
  text = [[Rods by constraints, drag by a force; rivals in two angles, where the drag is -c times the mass matrix times the rates (error: height of the lower
mass). The explicit method of order 8 in angles wins at every accuracy: two unknowns in place of six, and nothing to solve. At equal rules (gauss(3)) angles take a
third of the time of constraints. Coarse steps are another matter: see the [example](examples.md), where RK4 takes half of the energy by itself.]],
  { dm.system { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 - g * (q[2] + q[4]) end,
      constraint = function(q) return { q[1] ^ 2 + q[2] ^ 2 - 1, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - 1 } end,
      force = function(_, v) return -c * v end },
    q = { sin(a), -cos(a), sin(a) + sin(b), -cos(a) - cos(b) }, v = { 0, 0, 0, 0 }, t = 120, error = function(q) return q[4] end,
    rules = { "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "lobatto(4)" }, h = h },
  { dm.system { Q = dm.R(2), L = function(q, v)
      return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + g * (2 * cos(q[1]) + cos(q[2]))
    end, force = function(q, v)
      local d = cos(q[1] - q[2])
      return { -c * (2 * v[1] + d * v[2]), -c * (d * v[1] + v[2]) }
    end }, suffix = "in angles", q = { a, b }, v = { 0, 0 }, t = 120, error = function(q) return -cos(q[1]) - cos(q[2]) end,
    rules = { "gauss(3)", "rk4", "rk8" }, h = h },
}
