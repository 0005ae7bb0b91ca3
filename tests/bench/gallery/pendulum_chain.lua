-- eight rods as constraints, beside eight angles
local dm = require "dm"
local sin, cos, n, l = math.sin, math.cos, 8, 1 / 8
local q, v = dm.vector(2 * n), dm.vector(2 * n)
for i = 1, n do q[2 * i - 1], q[2 * i] = 0.3 * l * i, -math.sqrt(1 - 0.09) * l * i end
local function rods(z)
  local out, x, y = {}, 0, 0
  for i = 1, n do
    out[i] = ((z[2 * i - 1] - x) ^ 2 + (z[2 * i] - y) ^ 2) / l ^ 2 - 1
    x, y = z[2 * i - 1], z[2 * i]
  end
  return out
end
local function in_angles(a, w)
  local L, x, y, height = 0, 0, 0, 0
  for i = 1, n do
    x, y, height = x + l * cos(a[i]) * w[i], y + l * sin(a[i]) * w[i], height - l * cos(a[i])
    L = L + (x * x + y * y) / 2 - height
  end
  return L
end
local angles = dm.vector(n)
for i = 1, n do angles[i] = math.asin(0.3) end
local h = { 0.1, 0.05, 0.025, 0.0125, 0.00625 }
return {
  title = "Chain of eight rods, ten units of time",
  text = [[Eight rods as eight constraints, and as rivals eight angles, whose mass matrix is full (error: where the end of the chain is, horizontally). For
four digits RATTLE is cheapest, beyond that rk8 in angles wins here. In angles the work of a step grows like n^3, by constraints like n, so this is
a matter of how many rods.]],
  { dm.system { Q = dm.R(2 * n), L = function(z, u)
      local L = u:dot(u) / 2
      for i = 1, n do L = L - z[2 * i] end
      return L
    end, constraint = rods }, q = q, v = v, t = 10, error = function(z) return z[2 * n - 1] end,
    rules = { "rattle", "yoshida(4, rattle)", "kahan-li(8, rattle)", "gauss(4)" }, h = h },
  { dm.system { Q = dm.R(n), L = in_angles }, suffix = "in angles", q = angles, v = dm.vector(n), t = 10,
    error = function(a)
      local x = 0
      for i = 1, n do x = x + l * sin(a[i]) end
      return x
    end, rules = { "gauss(3)", "rk4", "rk8" }, h = h },
}
