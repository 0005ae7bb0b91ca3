-- the upright rolling disk, beside its accelerations by hand
local dm = require "dm"
local sin, cos = math.sin, math.cos
local start, h = { q = { 0, 0, 0, 0 }, v = { 1, 0, 1, 2 } }, { 0.4, 0.2, 0.1, 0.05, 0.025 }
return {
  title = "Rolling disk, a hundred turns",
  text = [[The disk runs around a circle, so that every method of order p errs by its phase alone. The rivals have the accelerations found by hand, which are two products, and win
at every accuracy; what they do not have is the constraint, which they leave by their error.]],
  { dm.system { Q = dm.R(4), L = function(_, v) return v:dot(v) / 2 end,
      rolling = function(q, v) return { v[1] - cos(q[4]) * v[3], v[2] - sin(q[4]) * v[3] } end }, q = start.q, v = start.v, t = 100 * math.pi,
    rules = { "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "lobatto(4)" }, h = h },
  { dm.system { Q = dm.R(4), L = function(_, v) return v:dot(v) / 2 end, force = function(q, v)
      return { -sin(q[4]) * v[4] * v[3], cos(q[4]) * v[4] * v[3], 0, 0 }
    end }, suffix = "by hand", q = start.q, v = start.v, t = 100 * math.pi, rules = { "rk4", "rk8" }, h = h },
}
