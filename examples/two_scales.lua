-- Which curves can follow a spring that shakes while it swings? In 0.2 s it shakes three times: five functions that know
-- the frequency fit its stretch a thousand times better than the five of a quartic (Leok 5.7.2, figure 5.7).
local dm = require "dm"
local sin, cos, sqrt = math.sin, math.cos, math.sqrt
local folder = arg and arg[1] or "."

local m, g, k, l = 1, 9.81, 1e4, 1
local pendulum = dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
  return m / 2 * (v[1] ^ 2 + (l + q[1]) ^ 2 * v[2] ^ 2) + m * g * (l + q[1]) * cos(q[2]) - k / 2 * q[1] ^ 2
end }
local path = pendulum:solver({ rule = "gauss(4)", h = 2e-4 }):run { q = { 0.02, 1 }, v = { 0, 0 }, t = 0.2 }
local t, a = path.t, path:column "a"

-- least squares over the rows, and what they leave of |a|
local function fit(functions)
  local A, b = dm.zeros(#functions, #functions), dm.zeros(#functions)
  for i = 1, #path do
    local f = {}
    for n, of in ipairs(functions) do f[n] = of(t[i]) end
    for n = 1, #f do
      for o = 1, #f do A[n][o] = A[n][o] + f[n] * f[o] end
      b[n] = b[n] + f[n] * a[i]
    end
  end
  local c, curve, left, all = A:solve(b), {}, 0, 0
  for i = 1, #path do
    curve[i] = 0
    for n, of in ipairs(functions) do curve[i] = curve[i] + c[n] * of(t[i]) end
    left, all = left + (a[i] - curve[i]) ^ 2, all + a[i] ^ 2
  end
  return sqrt(left / all), curve
end

local w = sqrt(k / m)
local function power(n) return function(s) return (s / 0.2) ^ n end end
local quartic, smooth = fit { power(0), power(1), power(2), power(3), power(4) }
local scales, shaking = fit { power(0), power(1), power(2), function(s) return sin(w * s) end, function(s) return cos(w * s) end }
print(("left of the stretch: %.1e by two scales, %.2f by a quartic"):format(scales, quartic))
assert(math.abs(scales - 7.4e-4) < 5e-5 and math.abs(quartic - 0.89) < 0.01)

dm.plot({ { x = t, y = a, name = "stretch a(t)" }, { x = t, y = shaking, name = "{1, t, t^2, sin, cos}" },
  { x = t, y = smooth, name = "quartic" } }, { file = folder .. "/two_scales.png", title = "A pendulum on a stiff spring",
  xlabel = "t", ylabel = "a" })
print("picture  " .. folder .. "/two_scales.png")
