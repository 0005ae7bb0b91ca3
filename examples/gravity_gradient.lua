-- Which way round does a satellite keep its face to the Earth? With its longest axis (least inertia) up and its shortest (most
-- inertia) across the orbit: a pitch swings at sqrt 3 n sqrt((I2 - I1)/I3). Laid along its way it leaves at that rate instead, and a
-- large pitch tumbles where its energy is above 3 n^2 (I2 - I1)/2, the hill of this pendulum.
local dm = require "dm"
local sqrt, pi, abs, log = math.sqrt, math.pi, math.abs, math.log
local picture = (arg and arg[1] or ".") .. "/gravity_gradient.png"

local G, I = dm.SO(3), { 0.1e-6, 0.2e-6, 0.25e-6 }               -- of mass 1, at distance 1 of an Earth with GM = 1
local satellite = dm.system { name = "satellite", Q = dm.product(G, dm.R(3)), L = function(q, v)
  local x = q[2]
  local X, d = q[1]:transpose() * x, sqrt(x:dot(x))
  return (I[1] * v[1] ^ 2 + I[2] * v[2] ^ 2 + I[3] * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 + 1 / d
    + (I[1] + I[2] + I[3] - 3 * (I[1] * X[1] ^ 2 + I[2] * X[2] ^ 2 + I[3] * X[3] ^ 2) / d ^ 2) / (2 * d ^ 3)
end }
local n = sqrt(1 + 1.5 * (I[2] + I[3] - 2 * I[1]))               -- of the circular orbit
local solver = satellite:solver { rule = "gauss(4)", h = 0.1 }

-- pitch: the angle of the first axis from the radius; rate: how fast it grows at the start
local function fly(angle, rate, t, speed)
  speed = speed or n
  local path = solver:run { q = { G:exp { 0, 0, angle }, { 1, 0, 0 } }, v = { 0, 0, speed + rate, 0, speed, 0 }, t = t,
    events = { level = function(q) return q[1][1][1] * q[2][2] - q[1][2][1] * q[2][1] end } }
  local pitch, turns, last = {}, 0, angle
  for i = 1, #path do
    local R, x = path.q[i][1], path.q[i][2]
    local now = math.atan(R[2][1] * x[1] - R[1][1] * x[2], R[1][1] * x[1] + R[2][1] * x[2]) + 2 * pi * turns
    local jump = math.floor((now - last) / (2 * pi) + 0.5)
    turns, now = turns - jump, now - 2 * pi * jump
    pitch[i], last = now, now
  end
  assert(path:drift "energy".largest < 1e-13 and path:drift(path:momentum(dm.SO(3)):column(3)).largest < 1e-12, "energy and momentum")
  return pitch, path:column "t", path
end

local swing = n * sqrt(3 * (I[2] - I[1]) / I[3])
local pitch, t, path = fly(1e-3, 0, 60)
local events = path.events
local period = 2 * (events[#events].t - events[1].t) / (#events - 1)
print(("pitch swings in %.5f orbits; theory %.5f"):format(period * n / (2 * pi), n / swing))
assert(abs(period * swing / (2 * pi) - 1) < 1e-5, "period of the pitch")
local small = { x = t, y = pitch, name = "a little off" }

local off = fly(pi / 2 + 1e-8, 0, 20, sqrt(1 + 1.5 * (I[1] + I[3] - 2 * I[2])))
local leaving = log((off[111] - pi / 2) / (off[61] - pi / 2)) / 5
print(("along its way it leaves at the rate %.5f; theory %.5f"):format(leaving, swing))
assert(abs(leaving / swing - 1) < 1e-4, "rate of leaving")

local hill = swing                                              -- rate at the bottom that just reaches the top
local below, t1 = fly(0, 0.99 * hill, 40)
local above = fly(0, 1.01 * hill, 40)
assert(math.max(table.unpack(below)) < pi / 2 and above[#above] > 2 * pi, "it turns over above the hill, and there alone")
print("picture  " .. dm.figure { { { x = t1, y = below, name = "0.99 of the hill" }, { x = t1, y = above, name = "1.01 of the hill" },
  xlabel = "t", ylabel = "pitch, rad", title = "large pitch" }, { small, xlabel = "t", ylabel = "pitch, rad", title = "small pitch" },
  title = "Satellite in its gravity gradient", file = picture })
