-- How far does the plane of Foucault's pendulum turn in a day? A gyroscope carried along a parallel turns against the ground by
-- 2 pi cos(colatitude): the holonomy of the connection dtheta + cos(colatitude) dphi of the sphere, whose curvature is its area. The
-- pendulum itself, swung for a day, agrees; so does a fine mesh of the sphere that knows nothing but lengths (Leok 4.1, 4.7.3).
local dm = require "dm"
local sin, cos, pi, abs = math.sin, math.cos, math.pi, math.abs
local picture = (arg and arg[1] or ".") .. "/foucault.png"

local sphere = dm.connection { name = "sphere", group = dm.SO(2), base = dm.T(2), -- (colatitude, longitude)
  local_form = function(a, b) return dm.cos((a[1] + b[1]) / 2) * (b[2] - a[2]) end }
local function parallel(colatitude)
  local loop = {}
  for i = 0, 24 do loop[i + 1] = { colatitude, 2 * pi * i / 24 } end
  return loop
end
local function wrapped(x) return math.atan(sin(x), cos(x)) end
local paris = (90 - 48.85) * pi / 180
local turn = sphere:holonomy(parallel(paris))
assert(abs(wrapped(turn + 2 * pi * cos(paris))) < 1e-12 and abs(sphere:curvature({ paris, 0 }, 1, 2)[1] + sin(paris)) < 1e-12)
print(("Paris: %.2f degrees a day"):format(turn * 180 / pi))

-- a pendulum in the turning frame: x'' = -w0^2 x + 2 W cos(colatitude) y', a few hundred swings a day
local W, w0 = 2 * pi, 300
local swing = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 - w0 ^ 2 * q:dot(q) / 2 + W * cos(paris) * (q[1] * v[2] - q[2] * v[1])
end }
local h = 2 * pi / w0 / 40
local path = swing:solver { rule = "gauss(3)", h = h }:run { q = { 1, 0 }, v = { 0, 0 }, t = 1 + 40 * h }
-- the plane of swing: the axis of sum of q q^T over the two swings about t = 1
local xx, xy, yy, n = 0, 0, 0, #path
for i = n - 80, n - 1 do
  local q = path.q[i]
  xx, xy, yy = xx + q[1] ^ 2, xy + q[1] * q[2], yy + q[2] ^ 2
end
local measured = math.atan(2 * xy, xx - yy) / 2
local off = (measured - turn) % pi
print(("the pendulum: %.3f rad, modulo a half turn %.4f from the connection"):format(measured, math.min(off, pi - off)))
assert(math.min(off, pi - off) < 2e-3, "the pendulum's plane turns with the connection")

-- the cap north of the parallel, on a mesh: deficits of its vertices against its area, 2 pi (1 - cos)
local K = dm.mesh { icosphere = 5 }
local deficit, points, cap = K:levi_civita():angle(), K:points(), 0
for v = 1, K:count(0) do if points[v][3] > cos(paris) then cap = cap + deficit[v] end end
print(("curvature of the cap on a mesh: %.3f, its area %.3f"):format(cap, 2 * pi * (1 - cos(paris))))
assert(abs(cap / (2 * pi * (1 - cos(paris))) - 1) < 0.02, "curvature of a cap is its area")

path:animate(picture:gsub("png$", "html"), { title = "Foucault's pendulum, a day", dim = 2, trail = 0.02 })
local x, y, theory, track = {}, {}, { x = {}, y = {}, name = "2 pi cos(colatitude)" }, { x = {}, y = {} }
for i = 1, 17 do
  local c = (i * 10 + 0.01) * pi / 180
  x[i], y[i] = i * 10, -sphere:holonomy(parallel(c)) / pi
  theory.x[i], theory.y[i] = i * 10, 2 * cos(c)
end
for i = 1, 1001 do track.x[i], track.y[i] = path.q[i][1], path.q[i][2] end
print("picture  " .. dm.figure { { track, title = "two hours of swings in Paris", equal = true, xlabel = "east", ylabel = "north" },
  { { x = x, y = y, name = "holonomy of 24 points", style = "points" }, theory, title = "turn of the plane in a day / pi", xlabel = "colatitude, degrees" },
  file = picture, size = { 1100, 480 }, title = "Foucault's pendulum" })
