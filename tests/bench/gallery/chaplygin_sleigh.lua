-- the Chaplygin sleigh by discrete Lagrange-d'Alembert, beside its reduced equations, multiplier eliminated by hand
local dm = require "dm"
local sin, cos, I, a = math.sin, math.cos, 0.75, 0.5
local start, h = { q = { 0, 0, 0 }, v = { 0, 0, 1 } }, { 0.4, 0.2, 0.1, 0.05, 0.025 }
return {
  title = "Chaplygin sleigh, twenty units of time",
  text = [[A skate that cannot slip. The rivals integrate the accelerations with the multiplier eliminated by hand; they do not know that the skate must not
slip, and leave it by their own error. The motion settles to a glide, which any method follows: no structure decides here, only order, and rk8 wins
where its form is known.]],
  { dm.system { Q = dm.R(3), L = function(q, v)
      local x, y = v[1] - a * v[3] * sin(q[3]), v[2] + a * v[3] * cos(q[3])
      return (x * x + y * y) / 2 + I * v[3] ^ 2 / 2
    end, rolling = function(q, v) return cos(q[3]) * v[2] - sin(q[3]) * v[1] end }, q = start.q, v = start.v, t = 20,
    rules = { "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "lobatto(4)" }, h = h },
  { dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end, force = function(q, v)
      local c, s, w = cos(q[3]), sin(q[3]), v[3]
      local u = v[1] * c + v[2] * s
      local du, dw = a * w ^ 2, -a * u * w / (I + a ^ 2)
      return { du * c - u * w * s, du * s + u * w * c, dw }
    end }, suffix = "by hand", q = start.q, v = start.v, t = 20, rules = { "rk4", "rk8" }, h = h },
}
