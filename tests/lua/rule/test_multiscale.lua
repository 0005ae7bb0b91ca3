-- steps over many vibrations: dm.multiscale, and Filon's weights
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, cos, sin, pi, sqrt = math.abs, math.max, math.cos, math.sin, math.pi, math.sqrt

-- a pendulum on a stiff spring: stretch and angle
local function spring(k)
  return dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
    return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - k * q[1] ^ 2 / 2
  end }
end
local function solver(k, h, more)
  local given = { frequency = sqrt(k), degrees = { 2, 3 } }
  for key, value in pairs(more or {}) do given[key] = value end
  return spring(k):solver { rule = dm.multiscale(given), h = h }
end
local function resolved(k, start, at)
  return spring(k):solver { rule = "gauss(6)", h = 0.25 / sqrt(k) }:run { q = start, v = { 0, 0 }, at = at }
end

-- weights: int x^j exp(i z x) by parts, on both sides of the series and at 0
local g, w = require "dm.core".quadrature { named = "gauss(32)" }
for _, name in ipairs { "lobatto(5)", "gauss(3)", "lobatto(8)" } do
  local worst = 0
  for _, z in ipairs { 0, 1e-3, 0.7, 5.99, 6.01, 7.99, 8.01, 30, -30, 1e4 } do
    local re, im, c = dm.filon(name, z)
    for j = 0, #c - 1 do
      local sr, si, a, b = 0, 0, 0, 0
      for i = 1, #c do sr, si = sr + re[i] * c[i] ^ j, si + im[i] * c[i] ^ j end
      local N = max(1, math.ceil(abs(z) / 20))
      for piece = 0, N - 1 do
        for i = 1, 32 do
          local x = (piece + g[i]) / N
          a, b = a + w[i] / N * x ^ j * cos(z * x), b + w[i] / N * x ^ j * sin(z * x)
        end
      end
      worst = max(worst, abs(sr - a), abs(si - b))
    end
  end
  ok(worst < 1e-14, "Filon weights on " .. name .. " are exact for powers", worst)
end
local re, im = dm.filon({ nodes = { 0, 0.5, 1 } }, 0)
ok(abs(re[1] - 1 / 6) + abs(re[2] - 2 / 3) + im:norm() < 1e-15, "z = 0: Simpson's rule")
raises("unknown quadrature", dm.filon, "lobato(5)", 3)
raises("at most 8", dm.filon, "gauss(9)", 3)
raises("nodes must grow", dm.filon, { nodes = { 0, 0, 1 } }, 3)
raises("z must be finite", dm.filon, "gauss(3)", 0 / 0)

-- the vibration alone is in the space: exact for any h
for _, h in ipairs { 0.1, 0.29, pi / 20, 1 } do
  local path, worst = solver(4e4, h):run { q = { 0.03, 0 }, v = { 0, 0 }, steps = 10 }, 0
  local rest = 9.81 / 4e4
  for i = 1, 11 do worst = max(worst, abs(path.q[i][1] - rest - (0.03 - rest) * cos(200 * path.t[i]))) end
  ok(worst < 1e-12, ("theta = 0, h omega = %.4g: exact"):format(200 * h), worst)
end

-- beside the slow motion, whatever the stiffness, at a cost that does not grow
local newton = {}
for _, k in ipairs { 1e3, 1e4, 1e5, 1e6 } do
  local s, start = solver(k, 0.125), { 0.01, 0.8 }
  local path, truth = s:run { q = start, v = { 0, 0 }, steps = 8 }, resolved(k, start, { 1 })
  near(path.q[9][2], truth.q[1][2], 1e-5, ("k = %.0e: theta"):format(k))
  near(path.q[9][1], truth.q[1][1], 1e-5, "  stretch")
  newton[k] = s:report().newton_per_step
  ok(s:report().defect < 0.1 and s:report().condition > 1, "  momentum at the ends of curves", s:report().defect)
end
ok(newton[1e6] <= newton[1e3] and newton[1e3] < 6, "cost does not grow with k", newton[1e3])
local soft = { nodes = 6, phases = 15 }
near(solver(1e2, 0.125, soft):run { q = { 0.01, 0.8 }, v = { 0, 0 }, steps = 8 }.q[9][2],
  resolved(1e2, { 0.01, 0.8 }, { 1 }).q[1][2], 1e-8, "h omega = 1.25 with 6 nodes and 15 phases")

-- three coordinates, two of them fast
local plate = dm.system { Q = dm.R(3), L = function(q, v)
  return v:dot(v) / 2 - 5e3 * (q[1] ^ 2 + q[2] ^ 2) + cos(q[3]) + q[1] * q[2] * cos(q[3]) - q[1] * sin(q[3]) end }
local start = { q = { 0.01, -0.02, 1 }, v = { 0.5, 0, 0 } }
local path = plate:solver { rule = dm.multiscale { frequency = 100 }, h = 0.25 }:run { q = start.q, v = start.v, steps = 8 }
local truth = plate:solver { rule = "gauss(6)", h = 0.002 }:run { q = start.q, v = start.v, at = { 2 } }
ok((path.q[9] - truth.q[1]):norm() < 1e-6, "three coordinates", (path.q[9] - truth.q[1]):norm())

-- rows and events inside a step are read off its curve
local s = solver(1e6, 0.125)
path, truth = s:run { q = { 0.01, 0.8 }, v = { 0, 0 }, at = { 0.1, 0.125, 0.7 } }, resolved(1e6, { 0.01, 0.8 }, { 0.1, 0.125, 0.7 })
for i = 1, 3 do near(path.q[i][2], truth.q[i][2], 2e-5, "a row inside a step") end
local plain = s:run { q = { 0.01, 0.8 }, v = { 0, 0 }, steps = 16 }
local seen = s:run { q = { 0.01, 0.8 }, v = { 0, 0 }, steps = 16, events = { bottom = function(q) return q[2] end } }
ok(#seen.events == 2 and seen.q[17][1] == plain.q[17][1], "events leave the run as it is", #seen.events)
near(seen.events[1].t, spring(1e6):solver { rule = "gauss(6)", h = 2e-4 }:run { q = { 0.01, 0.8 }, v = { 0, 0 }, t = 1,
  events = { bottom = function(q) return q[2] end } }.events[1].t, 1e-5, "  and are zeros")
ok(dm.resume(s:run { q = { 0.01, 0.8 }, v = { 0, 0 }, steps = 5 }):run { steps = 11 }.q[12][1] == plain.q[17][1], "a checkpoint goes on bit for bit")

-- what goes wrong is told, and where the energy goes the run ends
local function of(frequency, start)
  local s = spring(1e6):solver { rule = dm.multiscale { frequency = frequency, degrees = { 2, 3 } }, h = 0.125 }
  return s:run { q = start, v = { 0, 0 }, steps = 8 }, s:report()
end
for _, frequency in ipairs { 900, 1010, 1100, 1414 } do
  raises("energy has left that of the start", of, frequency, { 0.01, 0.8 })
end
local path, report = of(1001, { 0.01, 0.8 })
ok(report.drift > 0.01 and tostring(path):find "is the frequency right", "a frequency off by a thousandth is told", report.drift)
path, report = of(1000, { 0.01, 0.8 })
ok(report.drift < 1e-3 and not tostring(path):find "is the frequency right", "  the right one is not", report.drift)
local two = dm.system { Q = dm.R(3), L = function(q, v)
  return v:dot(v) / 2 - 5e3 * q[1] ^ 2 - 5e3 * 3 * q[2] ^ 2 + cos(q[3]) + q[1] * q[2] * cos(q[3]) + q[2] * q[3] ^ 2 end }
raises("or not its only fast one", function()
  two:solver { rule = dm.multiscale { frequency = 100 }, h = 0.25 }:run { q = { 0.01, 0.01, 1 }, v = { 0, 0, 0 }, steps = 40 }
end)
-- P(t) (1 + a sin + b cos) has the mean of theta, and little else: it says how badly its equations stand
local product = solver(1e4, 0.05, { ansatz = "product" })
path = product:run { q = { 0.001, 1 }, v = { 0, 0 }, steps = 2 }
near(path.q[3][2], resolved(1e4, { 0.001, 1 }, { 0.1 }).q[1][2], 1e-5, "the product ansatz: theta")
ok(product:report().condition > 1e7 and tostring(path):find "condition of a step", "  its condition is told", product:report().condition)
local function run(k, h, more) return function() solver(k, h, more):run { q = { 0.01, 0.8 }, v = { 0, 0 }, steps = 8 } end end
raises("take nodes = 6 and phases = 15", run(1e2, 0.125))
raises("which polynomials follow", run(1e2, 0.0125))
raises("no solution near a straight line", run(1e4, 0.2, { ansatz = "product" }))
-- a root of other equations' motion: its momentum at the end is hundreds of times the step's
for _, k in ipairs { 1e3, 1e4 } do
  raises("take the additive one", function()
    solver(k, 0.2, { ansatz = "product" }):run { q = { 0, 0.8 }, v = { 0, 0 }, steps = 5 }
  end)
end
raises("2 coordinates", run(1e4, 0.1, { degrees = { 2, 3, 4 } }))
raises("'frequency' is missing", dm.multiscale, {})
raises("must be odd", dm.multiscale, { frequency = 10, phases = 8 })
raises("from 2 to 8", dm.multiscale, { frequency = 10, nodes = 9 })
raises("lists of 2 and 1", dm.multiscale, { frequency = 10, degrees = { 2, 3 }, oscillating = { 0 } })
raises("additive ansatz", dm.multiscale, { frequency = 10, ansatz = "product", oscillating = 1 })
tap.done()
