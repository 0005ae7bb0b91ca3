-- A ball whose inside is uneven rolls on a table, its centre of mass in its middle: what stays? Its energy, and the momentum about
-- the point where it touches, K = I w + m r^2 (w - (w.e) e), which no symmetry gives (Chaplygin 1903): in space it does not move,
-- so that the ball keeps its general direction for ever, however it wobbles. lie(s) on SO(3) x R^2 (Lagrange-d'Alembert) keeps K to
-- rounding, since it is the sum of momenta of turns and slides whose fields do not slip; the energy to the order.
local dm = require "dm"
local max, log, abs = math.max, math.log, math.abs
local picture = (arg and arg[1] or ".") .. "/chaplygin_sphere.png"

local G, I = dm.SO(3), { 0.2, 0.35, 0.5 }                       -- mass and radius are 1
local ball = dm.system { name = "Chaplygin sphere", Q = dm.product(G, dm.R(2)),
  L = function(_, v) return (I[1] * v[1] ^ 2 + I[2] * v[2] ^ 2 + I[3] * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2) / 2 end,
  rolling = function(q, v)                                     -- x' = w x e with w in space
    local w = q[1] * dm.vector { v[1], v[2], v[3] }
    return { v[4] - w[2], v[5] + w[1] }
  end }

local w0 = dm.vector { 1, 0.2, 0.4 }
local function roll(rule, h, t)
  local path = ball:solver { rule = rule, h = h }:run { q = { G:identity(), { 0, 0 } }, v = { w0[1], w0[2], w0[3], w0[2], -w0[1] }, t = t }
  local v, K, worst = path:velocity(), {}, 0
  for i = 1, #path do
    local w = dm.vector { v[i][1], v[i][2], v[i][3] }
    local inside = dm.vector { I[1] * w[1], I[2] * w[2], I[3] * w[3] }
    local R = path.q[i][1]
    local spin = R * w
    K[i] = R * inside + dm.vector { spin[1], spin[2], 0 }
    worst = max(worst, (K[i] - K[1]):norm())
  end
  assert(path:worst "rolling" < 1e-12, "it slips")
  return worst, path, K[1]
end

for _, row in ipairs { { "lie(1)", 2 }, { "lie(2)", 4 } } do
  local energy = {}
  for k, h in ipairs { 0.1, 0.05 } do
    local worst, path = roll(row[1], h, 20)
    assert(worst < 1e-13, "K stays to rounding")
    energy[k] = path:drift "energy".largest
  end
  print(("%s: energy within %.1e and %.1e at steps of 0.1 and 0.05"):format(row[1], energy[1], energy[2]))
  assert(abs(log(energy[1] / energy[2], 2) - row[2]) < 0.5, "order of " .. row[1])
end
local worst, path, K = roll("lie(2)", 0.05, 400)
local energy = path:drift "energy"
print(("after 8000 steps K is off by %.0e, the energy by %.0e"):format(worst, energy.largest))
assert(worst < 1e-12 and energy.largest < 1e-6, "K and energy stay")

-- the way of the centre, and the direction across K
local x, y = {}, {}
for i = 1, #path do x[i], y[i] = path.q[i][2][1], path.q[i][2][2] end
local far = math.sqrt(x[#x] ^ 2 + y[#y] ^ 2)
local across = abs(x[#x] * K[1] + y[#y] * K[2]) / (far * math.sqrt(K[1] ^ 2 + K[2] ^ 2))
print(("it came %.0f radii far, %.3f rad off the direction across K"):format(far, math.asin(across)))
assert(far > 100 and across < 0.05, "its direction is that of K")
local wobble = { xlabel = "x", ylabel = "y", title = "way of the centre, t = 0 to 60" }
wobble[1] = { x = table.move(x, 1, 1201, 1, {}), y = table.move(y, 1, 1201, 1, {}) }
print("picture  " .. dm.figure { wobble, { { x = path:column "t", y = path:energy() - path:energy()[1] }, xlabel = "t", title = "energy, change from the start" },
  title = "Chaplygin's sphere", file = picture })
