-- How much weight below its middle keeps a slender vehicle from turning broadside as it rises? Kirchhoff's equations on SE(3): the
-- water makes the mass along the axis, m3, less than that across it, m1, and a body that moves along its axis with the momentum P
-- turns at the rate sqrt((P^2 (1/m3 - 1/m1) - mgl)/I). A weight mgl above P^2 (1/m3 - 1/m1) makes it swing instead (Leonard 1997).
local dm = require "dm"
local sqrt, pi, log, abs = math.sqrt, math.pi, math.log, math.abs
local picture = (arg and arg[1] or ".") .. "/underwater.png"

local I, m1, m3, P, E = 1, 2, 1, 1, dm.SE(3)
local critical = P ^ 2 * (1 / m3 - 1 / m1)
local function vehicle(weight)
  return dm.system { name = "vehicle", Q = E, L = function(g, x)
    return (m1 * (x[1] ^ 2 + x[2] ^ 2) + m3 * x[3] ^ 2 + I * (x[4] ^ 2 + x[5] ^ 2) + 0.3 * x[6] ^ 2) / 2 + weight * g[3][3]
  end }
end

-- the tilt of its axis from the vertical, a little at the start
local function rise(weight, tilt, t)
  local path = vehicle(weight):solver { rule = "lie(2)", h = 0.05 }:run { q = E:exp { 0, 0, 0, tilt, 0, 0 }, t = t,
    p = { 0, P * math.sin(tilt), P * math.cos(tilt), 0, 0, 0 }, events = { upright = function(g) return g[3][2] end } }
  local S = path:momentum(E)
  for i = 1, #path do assert(abs(S[i][3] - P) < 1e-12 and abs(S[i][6]) < 1e-12, "momentum up, and about the vertical") end
  assert(path:drift "energy".largest < 1e-5, "energy in a band")
  local theta, up = {}, {}
  for i = 1, #path do theta[i], up[i] = math.atan(path.q[i][3][2], path.q[i][3][3]), path.q[i][3][4] end
  return theta, path:column "t", path, up
end

local theta, t, _, up = rise(0, 1e-10, 40)
local rate = log(abs(theta[401] / theta[201])) / 10
print(("without a weight it turns broadside at the rate %.6f; theory %.6f"):format(rate, sqrt(critical / I)))
assert(abs(rate - sqrt(critical / I)) < 1e-5, "rate of turning")
local turning = { x = t, y = theta, name = "no weight" }

local swings, curves, tracks = {}, { turning, xlabel = "t", ylabel = "tilt, rad", title = "a start 1e-10 and 0.05 rad off the vertical" }, {}
tracks[1] = { x = t, y = up, name = "no weight" }
for k, part in ipairs { 1.5, 2, 4 } do
  local angle, times, path, height = rise(part * critical, 1e-4, 40)
  local first, last = path.events[1].t, path.events[#path.events].t
  local period = 2 * (last - first) / (#path.events - 1)
  local theory = 2 * pi / sqrt((part * critical - critical) / I)
  print(("%.1f times the critical weight: it swings in %.5f; theory %.5f"):format(part, period, theory))
  assert(abs(period / theory - 1) < 2e-4, "period of swinging")
  swings[k] = period
  angle, times, _, height = rise(part * critical, 0.05, 40)
  curves[k + 1] = { x = times, y = angle, name = ("%.1f critical"):format(part) }
  tracks[k + 1] = { x = times, y = height, name = ("%.1f critical"):format(part) }
end
assert(swings[1] > swings[2] and swings[2] > swings[3])
tracks.xlabel, tracks.ylabel, tracks.title = "t", "height", "how high it has come"
print("picture  " .. dm.figure { curves, tracks, title = "A slender vehicle that rises in water", file = picture })
