-- What becomes of a body that must not turn about one of its own axes? w3 = 0 is no condition on where it is (Suslov 1902): the body
-- swings from one steady turn to the opposite one, w2 = a tanh(k t), and no momentum is kept though nothing but the condition acts.
-- The energy is: lie(s) keeps it in a band that falls with the order.
local dm = require "dm"
local sqrt, abs, max, log = math.sqrt, math.abs, math.max, math.log
local picture = (arg and arg[1] or ".") .. "/suslov.png"

local G, I, I13 = dm.SO(3), { 1, 2, 1.5 }, 0.5
local body = dm.system { name = "Suslov", Q = G, rolling = function(_, w) return { w[3] } end,
  L = function(_, w) return (I[1] * w[1] ^ 2 + I[2] * w[2] ^ 2 + I[3] * w[3] ^ 2) / 2 + I13 * w[1] * w[3] end }

-- I1 w1' = -I13 w1 w2, I2 w2' = I13 w1^2: with E = (I1 w1^2 + I2 w2^2)/2 w2 = a tanh(k (t - t0)), w1 = b / cosh
local E = 2.25
local a, b = sqrt(2 * E / I[2]), sqrt(2 * E / I[1])
local k, t0 = I13 * a / I[1], 5
local function exact(t) return a * (1 - 2 / (math.exp(2 * k * (t - t0)) + 1)), b / ((math.exp(k * (t - t0)) + math.exp(-k * (t - t0))) / 2) end
local w2, w1 = exact(0)

local function run(rule, h)
  local path = body:solver { rule = rule, h = h }:run { q = G:identity(), v = { w1, w2, 0 }, t = 10 }
  local worst, w = 0, path:velocity()
  for i = 1, #path do
    local y, x = exact(path.t[i])
    worst = max(worst, abs(w[i][2] - y), abs(w[i][1] - x))
  end
  assert(path:worst "rolling" < 1e-12, "it turns about the third axis")
  return worst, path, w
end
local lines = { log = "xy", style = "linespoints", xlabel = "h", ylabel = "error of w", title = "error" }
for _, row in ipairs { { "lie(1)", 2 }, { "lie(2)", 4 }, { "lie(3)", 6 } } do
  local hs, errors = { 0.2, 0.1, 0.05 }, {}
  for j, h in ipairs(hs) do errors[j] = run(row[1], h) end
  local order = log(errors[2] / errors[3], 2)
  print(("%s: off the tanh by %.1e, %.1e, %.1e, order %.2f"):format(row[1], errors[1], errors[2], errors[3], order))
  assert(abs(order - row[2]) < 0.3, "order of " .. row[1])
  lines[#lines + 1] = { x = hs, y = errors, name = row[1] }
end
local _, path, w = run("lie(2)", 0.05)
local drift = path:drift "energy".largest
local J = path:momentum(G)
print(("its energy moves by %.0e, its momentum in space turns from (%.2f, %.2f, %.2f) to (%.2f, %.2f, %.2f)"):format(drift, J[1][1], J[1][2], J[1][3],
  J[#J][1], J[#J][2], J[#J][3]))
assert(drift < 1e-6 and (J[#J] - J[1]):norm() > 0.3, "energy stays, momentum does not")
local x, y = {}, {}
for i = 1, #path do x[i], y[i] = w[i][1], w[i][2] end
local t = path:column "t"
print("picture  " .. dm.figure { { { x = t, y = x, name = "w1" }, { x = t, y = y, name = "w2" }, xlabel = "t", title = "angular velocity of the body" }, lines,
  title = "Suslov's problem", file = picture })
