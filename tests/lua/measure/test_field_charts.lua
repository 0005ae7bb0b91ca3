-- dm.chart of fields over their size: errors against formulas and against the finest of the sizes
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local pi, sqrt, exp, atan = math.pi, math.sqrt, math.exp, math.atan

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function zero() return 0 end

---- lines: the kink of sine-Gordon against its formula, figures of the issue on fields ----

local g = 1 / sqrt(0.75)
local function kinks(cells)
  return dm.field { x = { -15, 15, cells }, fixed = "ends", L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 - (1 - dm.cos(u)) end }
end
local kink = { system = kinks, cells = { 60, 120, 240 }, t = 10, h = function(n) return 15 / n end, error = "largest",
  u = function(x) return 4 * atan(exp(g * x)) end, ut = function(x) return -g / dm.cosh(g * x) end, exact = function(x, t) return 4 * atan(exp(g * (x - t / 2))) end }
local chart = dm.chart(kink)
for i, figure in ipairs { 0.0204644733882, 0.00453877564388, 1.08783e-3 } do near(chart.points[i].error, figure, 1e-6, "kink, size " .. chart.points[i].size) end
near(chart:order(), 2.06, 0.02, "towards order 2")
ok(#chart == 3 and chart.points[2].width == 0.25 and chart.points[2].h == 0.125 and chart.points[2].steps == 80 and chart.against == "a formula", "what a point has")
ok(tostring(chart):find "cell%(gauss%(2%)%)" and chart:table():find "1.0878e%-03", "as text", tostring(chart))

-- against the finest size, at the nodes that sizes share: d'Alembert's solution on a ring
local function ring(n) return dm.field { x = { 0, 1, n, periodic = true }, L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end } end
local rings = { system = ring, n = { 12, 24, 384 }, t = 0.3, h = function(n) return 0.6 / n end, u = function(x) return math.sin(2 * pi * x) end }
local beside = dm.chart(rings)
rings.exact = function(x, t) return math.sin(2 * pi * x) * math.cos(2 * pi * t) end
local exact = dm.chart(rings)
ok(#beside == 2 and #exact == 3 and beside.against == "n = 384", "the finest is no point")
for i = 1, 2 do near(beside.points[i].error, exact.points[i].error, 0.02 * exact.points[i].error, "the finest tells nearly what the formula tells") end
-- a mode on a ring keeps its shape: the relative error in the norm is |cos(omega_h t) - cos(omega t)| / |cos(omega t)|
local dx, h = 1 / 12, 0.05
local X = (h / dx) ^ 2 / (1 / math.sin(pi * dx) ^ 2 - 2 / 3)
near(exact.points[1].error, math.abs(math.cos(6 * 2 * math.asin(sqrt(X / (1 + 2 * X / 3)))) - math.cos(0.6 * pi)) / math.abs(math.cos(0.6 * pi)), 1e-10,
  "the discrete dispersion relation")

---- meshes ----

-- a standing wave in a triangle: the error of a mode is that of its frequency
local function membrane(N) return dm.mesh { grid = N }:field { form = 0, fixed = "boundary", L = wave } end
local function mode(x, y) return math.sin(pi * x) * math.sin(2 * pi * y) end
local plate = { system = membrane, N = { 4, 8, 16 }, rules = { "verlet", "midpoint" }, t = 0.25, h = function(N) return 0.25 / N end, q = mode, v = zero,
  exact = function(x, y, t) return mode(x, y) * math.cos(sqrt(5) * pi * t) end }
chart = dm.chart(plate)
ok(#chart == 6 and chart.rules[2] == "midpoint", "rules at every size")
for _, rule in ipairs(chart.rules) do near(chart:order(rule), 2, 0.2, rule .. ": order 2 in the size") end
plate.exact, plate.N = nil, { 4, 8, 32 }
beside = dm.chart(plate)
for i = 1, 2 do near(beside.points[i].error, chart.points[i].error, 0.15 * chart.points[i].error, "beside a finer mesh") end
-- 1-forms, through dm.remesh
chart = dm.chart { system = function(N) return dm.mesh { triangle = N }:field { form = 1, fixed = "boundary", L = wave } end, N = { 4, 8, 16 }, rule = "verlet", t = 0.1,
  h = function(N) return 0.1 / N end, v = function() return { 0, 0 } end,
  q = function(x, y) local b = y * (sqrt(3) * x - y) * (sqrt(3) * (1 - x) - y) return { b, b * x } end }
ok(#chart == 2 and chart.points[2].error < chart.points[1].error and chart.points[2].error > 0, "forms of degree 1", tostring(chart))

-- flow on a sphere: relative to the formula (0.69986 in the issue on fields), and at the vertices that meshes share
local function haurwitz(x, y, z, t)
  local c, s = math.cos(0.9 * t), math.sin(0.9 * t)
  local a, b = c * x + s * y, c * y - s * x
  return 2 * z + 6 * z * (a ^ 3 - 3 * a * b ^ 2)
end
local balls = { system = function(level) return dm.mesh { icosphere = level }:euler { vorticity = function(x, y, z) return haurwitz(x, y, z, 0) end } end, level = { 1, 2 },
  h = function(level) return 0.4 / 2 ^ level end, t = 2, exact = haurwitz }
chart = dm.chart(balls)
near(chart.points[2].error, 0.69985549041, 1e-6, "Rossby-Haurwitz wave")
balls.exact, balls.level = nil, { 0, 1, 2 }
ok(#dm.chart(balls) == 2, "curved meshes by their common vertices")

-- boxes: the soliton of KdV
chart = dm.chart { system = function(N) return dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" },
  M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
  x = { -20, 20, N, periodic = true }, S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end } end, N = { 65, 129 }, h = { 0.04, 0.02 }, t = 1,
  component = "u", z = { u = function(x) return 2 / dm.cosh(x) ^ 2 end }, exact = function(x, t) return 2 / dm.cosh(x - 4 * t) ^ 2 end, error = "largest" }
near(chart.points[2].error, 0.165468301862, 1e-7, "KdV soliton")

---- what is refused or told ----

local function with(more)
  local out = {}
  for key, value in pairs(kink) do out[key] = value end
  for key, value in pairs(more) do if value == "none" then out[key] = nil else out[key] = value end end
  return function() dm.chart(out) end
end
raises("sizes are missing", with { cells = "none" })
raises("whole numbers that grow", with { cells = { 60, 30 } })
raises("whole numbers that grow", with { cells = { 60.5, 90 } })
raises("two sizes", with { cells = { 60 } })
raises("three are needed", with { cells = { 60, 120 }, exact = "none" })
raises("names the sizes", with { more = { 1, 2 } })
raises("option 'h'", with { h = { 0.1 } })
raises("option 'h' must be a step", with { h = function() return -1 end })
raises("'t'", with { t = -1 })
raises("a duration", with { t = "none" })
raises("the start of such a field is u", with { q = zero })
raises("must return a field", with { system = function() return 3 end })
raises("sizes must divide", with { cells = { 20, 30, 50 }, exact = "none" })
raises("on a line", with { rule = "verlet" })
raises("vanishes at the end", function() dm.chart { system = ring, n = { 12, 24 }, t = 0.1, h = 0.05, u = function(x) return x end, exact = zero } end)
-- a size that fails is told, the others stand: the step is beyond the limit of the finest
chart = dm.chart { system = function(N) return membrane(N) end, N = { 4, 8, 40 }, rule = "verlet", h = 0.05, t = 100, q = mode, v = zero, exact = plate.exact or function(x, y, t)
  return mode(x, y) * math.cos(sqrt(5) * pi * t) end }
ok(#chart == 2 and #chart.failures == 1 and chart.failures[1].size == 40 and chart:table():find "N = 40", "a failure belongs into the chart", chart:table())
ok(chart:csv():match "^rule,size" and select(2, chart:csv():gsub("\n", "")) == 3, "as comma-separated values")
tap.raises("a field on a line is charted over its size", function()
  dm.chart { dm.field { x = { 0, 1, 8 }, L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end }, u = 1, t = 1 }
end)
tap.done()
