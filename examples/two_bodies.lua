-- What do two asteroids exchange while they go around each other? Two rigid bodies on (SO(3) x R^3)^2 that attract by their masses
-- and moments (MacCullagh): their spins and their orbit trade angular momentum, and only the sum of all stays. The orbit's part moves
-- by one part in thirty here; the sum by rounding.
local dm = require "dm"
local sqrt, max, min = math.sqrt, math.max, math.min
local picture = (arg and arg[1] or ".") .. "/two_bodies.png"

local G, m = dm.SO(3), { 1, 0.5 }
local I = { { 0.010, 0.015, 0.020 }, { 0.002, 0.0036, 0.0044 } }
local function moment(k, R, x, d2)                              -- tr I - 3 x . I x/|x|^2 of body k, seen from x
  local X, J = R:transpose() * x, I[k]
  return J[1] + J[2] + J[3] - 3 * (J[1] * X[1] ^ 2 + J[2] * X[2] ^ 2 + J[3] * X[3] ^ 2) / d2
end
local pair = dm.system { name = "two bodies", Q = dm.product(G, dm.R(3), G, dm.R(3)), L = function(q, v)
  local T = 0
  for k = 1, 2 do
    local at = 6 * (k - 1)
    for i = 1, 3 do T = T + I[k][i] * v[at + i] ^ 2 / 2 + m[k] * v[at + 3 + i] ^ 2 / 2 end
  end
  local x = q[4] - q[2]
  local d2, d = x:dot(x), x:norm()
  return T + m[1] * m[2] / d + (m[2] * moment(1, q[1], x, d2) + m[1] * moment(2, q[3], x, d2)) / (2 * d * d2)
end }

-- a nearly circular orbit about the centre of mass, both bodies tilted
local speed = sqrt(1.5)
local start = { q = { G:exp { 0.3, 0.1, 0 }, { -1 / 3, 0, 0 }, G:exp { 0, 0.4, 0.2 }, { 2 / 3, 0, 0 } },
  v = { 0, 0.1, 1.1, 0, -speed / 3, 0, 0.2, 0, 1.5, 0, 2 * speed / 3, 0 }, t = 40 }
local function fly(rule, h)
  start.every = math.floor(0.1 / h + 0.5)                      -- rows at the same times
  return pair:solver { rule = rule, h = h }:run(start)
end
local path = fly("gauss(4)", 0.02)
local J = path:momentum(dm.SO(3))
local worst, orbit, spins, total = 0, {}, { {}, {} }, {}
for i = 1, #path do
  local q, p = path.q[i], path.p[i]
  local sum = q[2]:cross(dm.vector { p[4], p[5], p[6] }) + q[4]:cross(dm.vector { p[10], p[11], p[12] })
  orbit[i] = sum[3]
  for k = 1, 2 do
    local spin = q[2 * k - 1] * dm.vector { p[6 * k - 5], p[6 * k - 4], p[6 * k - 3] }
    spins[k][i], sum = spin[3], sum + spin
  end
  total[i] = sum[3]
  worst = max(worst, (sum - J[1]):norm(), (J[i] - J[1]):norm())
end
local traded = (max(table.unpack(orbit)) - min(table.unpack(orbit))) / orbit[1]
print(("the orbit's angular momentum moves by %.3f of itself; the sum of all by %.0e, the energy by %.0e"):format(traded, worst, path:drift "energy".largest))
assert(traded > 0.01 and worst < 1e-13 and path:drift "energy".largest < 1e-10)

-- another discretization goes the same way, to its order
local function off(h) return (fly("lie(2)", h).q[401][4] - path.q[401][4]):norm() end
local order = math.log(off(0.05) / off(0.025), 2)
print(("lie(2) goes there, too, with order %.2f"):format(order))
assert(math.abs(order - 4) < 0.3)
local t, x, y = path:column "t", {}, {}
for i = 1, #path do x[i], y[i] = path.q[i][4][1] - path.q[i][2][1], path.q[i][4][2] - path.q[i][2][2] end
print("picture  " .. dm.figure { { { x = x, y = y }, equal = true, xlabel = "x", ylabel = "y", title = "one seen from the other" },
  { { x = t, y = orbit, name = "orbit" }, { x = t, y = spins[1], name = "spin of the larger" }, { x = t, y = spins[2], name = "of the smaller" },
    { x = t, y = total, name = "sum" }, xlabel = "t", title = "angular momentum, vertical part" }, title = "Two rigid bodies", file = picture })
