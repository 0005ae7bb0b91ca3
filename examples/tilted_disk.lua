-- How does a leaning disk roll? Around a circle, without falling, when lean, turning and rolling are in step: (C + m a^2) w3 Omega
-- sin theta - A Omega^2 sin theta cos theta + m g a cos theta = 0 (Routh 1884). And an upright one falls over where it rolls slower
-- than w^2 = A m g a/(C (C + m a^2)). A disk of 15 kg (Hante 2018), on SO(3) x R^3, which touches the table and does not slip.
local dm = require "dm"
local sqrt, sin, cos, abs, log = math.sqrt, math.sin, math.cos, math.abs, math.log
local picture = (arg and arg[1] or ".") .. "/tilted_disk.png"

local G, m, a, g = dm.SO(3), 15, 1, 9.81
local A, C = m / 4, m / 2                                       -- about a diameter, about the axis
-- from the centre to where it touches: down along the disk, e3 its axis: a (e3 cos theta - e_z)/sin theta
local function arm(R)
  local e, c = dm.vector { R[1][3], R[2][3], R[3][3] }, R[3][3]
  return (e * c - dm.vector { 0, 0, 1 }) * (a / dm.sqrt(1 - c * c))
end
local disk = dm.system { name = "disk", Q = dm.product(G, dm.R(3)),
  L = function(q, v) return (A * (v[1] ^ 2 + v[2] ^ 2) + C * v[3] ^ 2 + m * (v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2)) / 2 - m * g * q[2][3] end,
  constraint = function(q) return { q[2][3] + arm(q[1])[3] } end,
  rolling = function(q, v)
    local slip = dm.vector { v[4], v[5], v[6] } + (q[1] * v:slice(1, 3)):cross(arm(q[1]))
    return { slip[1], slip[2] }
  end }

-- axis tilted by theta from the vertical, Omega about the vertical, w3 about the axis
local function roll(theta, Omega, w3, rule, h, t)
  local R, w = G:exp { theta, 0, 0 }, dm.vector { 0, Omega * sin(theta), w3 }
  local V = -(R * w):cross(arm(R))
  local path = disk:solver { rule = rule, h = h }:run { q = { R, { 0, 0, a * sin(theta) } }, v = { 0, w[2], w3, V[1], V[2], V[3] }, t = t }
  assert(path:worst "rolling" < 1e-11 and path:worst "constraint" < 1e-13, "it touches and does not slip")
  local tilt, px, py = {}, {}, {}
  for i = 1, #path do
    local S, x = path.q[i][1], path.q[i][2]
    tilt[i], px[i], py[i] = math.acos(S[3][3]), (x + arm(S))[1], (x + arm(S))[2]
  end
  return tilt, px, py, path
end

-- steady: the lean stays, the point of contact goes around a circle
local theta, Omega = math.pi / 2 - 0.26, 0.5
local w3 = (A * Omega ^ 2 * sin(theta) * cos(theta) - m * g * a * cos(theta)) / ((C + m * a ^ 2) * Omega * sin(theta))
local theory, worst, radius = a * abs(w3 / Omega - cos(theta)), 0, 0
local tilt, x, y = roll(theta, Omega, w3, "lie(2)", 0.02, 13)
for i = 1, #tilt do
  worst, radius = math.max(worst, abs(tilt[i] - theta)), math.max(radius, sqrt((x[i] - x[1]) ^ 2 + (y[i] - y[1]) ^ 2) / 2)
end
print(("the lean stays to %.1e, the circle has radius %.4f (theory %.4f)"):format(worst, radius, theory))
assert(worst < 1e-8 and abs(radius - theory) < 0.001, "a leaning disk rolls around a circle")
local circle, lean = { { x = x, y = y }, equal = true, xlabel = "x", ylabel = "y", title = "leaning: where it touches" }, {}

-- upright: the lean grows at the root of m g a/(A + m a^2) - C (C + m a^2) w^2/(A (A + m a^2)), or swings
for k, w in ipairs { 1.5, 2.2 } do
  local square = (m * g * a - C * (C + m * a ^ 2) * w ^ 2 / A) / (A + m * a ^ 2)
  local leans, _, _, path = roll(math.pi / 2 - (k == 1 and 1e-7 or 1e-3), 0, w, "lie(2)", 0.02, 12)
  for i = 1, #leans do leans[i] = leans[i] - math.pi / 2 end
  lean[k] = { x = path:column "t", y = leans, name = ("rolling at %.1f"):format(w) }
  local rate, most = log((leans[251] - leans[201]) / (leans[201] - leans[151])), math.max(table.unpack(leans)) - math.min(table.unpack(leans))
  print(square > 0 and ("rolling at %.1f it falls over at the rate %.4f; theory %.4f"):format(w, rate, sqrt(square))
    or ("rolling at %.1f it swings by %.4f rad about upright"):format(w, most))
  assert(square > 0 and abs(rate - sqrt(square)) < 1e-3 or square < 0 and most < 0.01)
end
print("picture  " .. dm.figure { circle, { lean[1], lean[2], xlabel = "t", ylabel = "lean, rad", title = "started upright" }, title = "Rolling disk", file = picture })
