-- stationary forms: harmonic functions and maps, elasticity, saddles (K:stationary; Leok 3.12, P22)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, sqrt, log = math.sin, math.cos, math.sqrt, math.log
local function dirichlet(u) return u:d():dot(u:d()) / 2 end
local function bubble(x, y) return y * (sqrt(3) * x - y) * (sqrt(3) * (1 - x) - y) end

-- harmonic functions: worked values of the energy, the solution of K:poisson, in dimensions 1 to 3
for N, energy in pairs { [2] = 1.25, [4] = 1.3125, [8] = 1.328125 } do
  local u, report = dm.mesh { grid = N }:stationary { fixed = "boundary", term = dirichlet, x = function(x, y) return x * x - y * y end }
  ok(report.code == "ok" and report.iterations == 0 and report.kind == "minimum", "x^2 - y^2 is discretely harmonic")
  near(report.value, energy, 1e-13, "its energy, N = " .. N)
  near(u:d():norm() ^ 2 / 2, energy, 1e-13, "and that of the form")
end
for _, K in ipairs { dm.mesh { triangle = 8 }, dm.mesh { cube_tiling = 3 },
  dm.mesh { points = { { 0 }, { 0.2 }, { 0.5 }, { 1 } }, simplices = { { 1, 2 }, { 2, 3 }, { 3, 4 } } } } do
  local function f(x, y) return sin(3 * x) + (y or 0) end
  local load = K:form(0, f)
  local u, report = K:stationary { fixed = "boundary", term = function(a) return dirichlet(a) - a:dot(load) end, x = f }
  local v = K:poisson { f = load, fixed = { boundary = f } }
  ok((u - v):max() < 1e-12 and report.code == "ok", "discretize, then vary = vary, then discretize", (u - v):max())
end
local free = dm.mesh { triangle = 6 }
local load = free:form(0, function(x) return x - 0.5 end)
local u, report = free:stationary { term = function(a) return dirichlet(a) - a:dot(load) end }
ok((u:d() - free:poisson { f = load }:d()):max() < 1e-9 and report.code == "ok", "nothing fixed: known up to a constant", (u:d() - free:poisson { f = load }:d()):max())
-- 1-forms: the rotation of a potential with given rotation; the divergence is arbitrary, so it is held by a second square
local K = dm.mesh { triangle = 5 }
local B = K:form(2, function(x, y) return 1 + x * y end)
local A = K:stationary { form = 1, fixed = "boundary", term = function(a) return (a:d() - B):dot(a:d() - B) / 2 + 1e-6 * a:dot(a) end }
local expected = K:laplacian(1, { part = "up", fixed = "boundary" })
local marks, worst, residual = K:boundary_marks(1), 0, (expected * A) - (B:delta()) + 2e-6 * A
for i = 1, #marks do if marks[i] == 0 then worst = math.max(worst, math.abs(residual[i])) end end
ok(worst < 1e-11, "delta d A = delta B at free edges", worst)

-- harmonic maps into spheres: the figure of the issue; the angle of a map into a circle is a harmonic function to order 2
local plate = dm.mesh { triangle = 4 }
local maps, map = plate:stationary { values = 3, on = dm.S(2), fixed = "boundary", term = dirichlet, x = function(x, y)
  local a, b = 1.8 * (x - 0.5), 1.8 * (y - sqrt(3) / 6) local r = a * a + b * b
  return { 2 * a / (1 + r), 2 * b / (1 + r), (r - 1) / (1 + r) } end }
near(map.value, 3.4695944080879, 1e-11, "harmonic map")
local length = 0
for i = 1, plate:count(0) do length = math.max(length, math.abs(maps[1][i] ^ 2 + maps[2][i] ^ 2 + maps[3][i] ^ 2 - 1)) end
ok(length < 1e-14 and #maps == 3, "on the sphere", length)
local energy = 0
for c = 1, 3 do energy = energy + maps[c]:d():norm() ^ 2 / 2 end
near(energy, map.value, 1e-12, "the energy of its components")
local off = {}
for i, N in ipairs { 4, 8 } do
  local M = dm.mesh { grid = N }
  local function angle(x, y) return x * x - y * y + 2 * x * y end -- harmonic
  local c = M:stationary { on = dm.S(1), fixed = "boundary", term = dirichlet, x = function(x, y)
    local a = angle(x, y) + sin(9 * x * y) * x * (1 - x) * y * (1 - y) return { cos(a), sin(a) } end }
  off[i] = 0
  local at = M:points()
  for v = 1, M:count(0) do off[i] = math.max(off[i], math.abs(math.atan(c[2][v], c[1][v]) - angle(at[v][1], at[v][2]))) end
end
ok(off[1] < 0.03 and off[1] / off[2] > 3, "a map into the circle: its angle is harmonic, to order 2", off[1] / off[2])
-- the identity of a sphere is harmonic: its energy is the area
local ball = dm.mesh { icosphere = 2 }
local _, identity = ball:stationary { on = dm.S(2), term = dirichlet, x = function(x, y, z) return { x, y, z } end }
ok(identity.code == "ok" and identity.value <= ball:volume(2):sum() + 1e-12, "from the identity of the sphere, energy at most its area")

-- elasticity from W(F): patch test, a saddle, inverted starts
local function density(a, b, c, d) local J = log(a * d - b * c) return (a ^ 2 + b ^ 2 + c ^ 2 + d ^ 2 - 2 - 2 * J) / 2 + J ^ 2 end
local function strain(x, cell)
  local p = cell.points
  local a, b, s, t = p[2] - p[1], p[3] - p[1], x[2] - x[1], x[3] - x[1]
  local D = a[1] * b[2] - a[2] * b[1]
  return cell.volume * density((s[1] * b[2] - t[1] * a[2]) / D, (t[1] * a[1] - s[1] * b[1]) / D, (s[2] * b[2] - t[2] * a[2]) / D, (t[2] * a[1] - s[2] * b[1]) / D)
end
local function elastic(X) return plate:sum(2, strain, X) end
local function patch(x, y) return { 1.2 * x + 0.3 * y + 0.2 * bubble(x, y), 0.9 * y - 0.3 * bubble(x, y) } end
local X, body = plate:stationary { values = 2, fixed = "boundary", term = elastic, x = patch }
near(body.value, sqrt(3) / 4 * density(1.2, 0.3, 0, 0.9), 1e-13, "patch test")
local p, wrong = plate:points(), 0
for i = 1, plate:count(0) do wrong = math.max(wrong, math.abs(X[1][i] - 1.2 * p[i][1] - 0.3 * p[i][2]), math.abs(X[2][i] - 0.9 * p[i][2])) end
ok(wrong < 1e-12, "the affine map", wrong)
local loose, rest = plate:stationary { values = 2, fixed = { 1, 2 }, term = elastic, x = function(x, y) return { x + 0.1 * y, y + 0.05 * x * x } end }
ok(rest.code == "ok" and rest.kind == "minimum" and math.abs(rest.value) < 1e-2 and loose[1][1] == X[1][1], "free sides: nearly unstrained", rest.value)
-- a double well with a bump in the middle: from near the bump the saddle, from beside it the minimum
local line = dm.mesh { points = { { 0 }, { 1 } }, simplices = { { 1, 2 } } }
local function well(a) return line:sum(0, function(u) return (u ^ 2 - 1) ^ 2 / 4 end, a) end
local top, saddle = line:stationary { term = well, x = { 0.05, -0.03 } }
ok(saddle.kind == "saddle" and top:max() < 1e-9, "a saddle near the start is stationary, and called what it is", saddle.kind)
local _, minimum = line:stationary { term = well, x = { 0.8, -0.9 } }
ok(minimum.kind == "minimum" and minimum.value < 1e-20, "a minimum", minimum.value)
local _, none = line:stationary { term = function(a) return line:sum(0, function(v) return math.exp(v) end, a) end, iterations = 20 }
ok(none.code == "no_convergence" and none.iterations == 20, "no minimum at a finite place is told", none.text)
-- data of cells, everything fixed
local weight = line:form(0, { 2, 4 })
local solved = line:stationary { data = { k = weight }, term = function(a) return line:sum(0, function(v, cell) return cell.k * v ^ 2 / 2 - v end, a) end }
near(solved[1], 1 / 2, 1e-15, "data of cells") near(solved[2], 1 / 4, 1e-15, "by name")
local same, all = line:stationary { fixed = { 1, 2 }, x = { 3, 4 }, term = dirichlet }
ok(same[1] == 3 and all.iterations == 0 and all.code == "ok", "nothing is free")

-- refusals
raises("inverted or degenerate", function() plate:stationary { values = 2, fixed = "boundary", term = elastic, x = function(x, y) return { -x, y } end } end)
raises("inverted or degenerate", function() plate:stationary { values = 2, fixed = "boundary", term = elastic } end)
raises("opposite on the sphere", function() line:stationary { on = dm.S(2), term = dirichlet, x = { 1, 0, 0, -1, 0, 0 } } end)
raises("unit vector", function() line:stationary { on = dm.S(2), term = dirichlet, x = { 1, 0, 0, 2, 0, 0 } } end)
raises("'x' is missing", function() line:stationary { on = dm.S(2), term = dirichlet } end)
raises("'term' is missing", function() line:stationary {} end)
raises("must be a form, a function", function() line:stationary { term = dirichlet, x = { 1, 2, 3 } } end)
raises("must be a sphere", function() line:stationary { term = dirichlet, on = dm.SO(3), x = { 1, 2 } } end)
raises("unknown option 'rule'", function() line:stationary { term = dirichlet, rule = "newton" } end)
raises("form", function() line:stationary { form = 3, term = dirichlet } end)

-- a constant may be added: degenerate; a load that no constant balances has no answer
local free = dm.mesh { triangle = 3 }
local level, flat = free:stationary { term = function(u) return u:d():dot(u:d()) / 2 end, x = function(x) return math.sin(3 * x) end }
ok(flat.code == "ok" and flat.kind == "degenerate" and level:d():max() < 1e-12, "a constant, whichever", flat.kind)
local _, none = free:stationary { term = function(u) return u:d():dot(u:d()) / 2 + free:sum(0, function(a, cell) return cell.star * a end, u) end }
ok(none.code == "no_convergence" and none.residual > 0.01, "no stationary form, and told", none.residual)

-- the same springs, hung up by their ends, in metres and in units of 1e-10 and 1e-20 of them; displacements near 0 of a net
-- under stress, whose residual is the round-off of the stress
local function sag(size)
  local points, springs = {}, {}
  for i = 1, 9 do points[i], springs[i] = { (i - 1) / 8 * size }, i < 9 and { i, i + 1 } or nil end
  local K = dm.mesh { points = points, simplices = springs }
  local u, told = K:stationary { values = 2, fixed = { 1, 9 }, x = function(x) return { 1.2 * x, 0 } end, term = function(X)
    return K:sum(1, function(a, cell) return 25 * ((a[2] - a[1]):norm() - cell.volume) ^ 2 / cell.volume / size end, X)
      + K:sum(0, function(a, cell) return cell.star * a[2] / size ^ 2 end, X)
  end }
  return told.code == "ok" and u[2][5] / size
end
for _, size in ipairs { 1e-20, 1e-10, 1e8 } do near(sag(size), sag(1), 1e-13, ("a chain of springs in units of %g"):format(size)) end
local u, told = free:stationary { values = 2, fixed = "boundary", term = function(A)
  return free:sum(1, function(a, cell) return (((cell.points[2] + a[2]) - (cell.points[1] + a[1])):norm() - 0.7 * cell.volume) ^ 2 end, A)
end }
ok(told.code == "ok" and told.iterations < 10 and u[1]:max() < 1e-15, "a net under stress is at rest", told.iterations)
_, told = free:stationary { iterations = 3, x = function() return 300 end, term = function(a)
  return free:sum(0, function(x, cell) return cell.star * dm.cosh(x) end, a) end }
ok(told.code == "no_convergence" and told.text:find "iterations were not enough", "few iterations are told", told.text)

-- a cubic that is stationary nowhere, in units of any size
for _, size in ipairs { 1, 2 ^ -40, 2 ^ -80 } do
  _, told = free:stationary { x = function(x) return size * (0.5 + 0.1 * x) end, term = function(a)
    return size ^ 2 * free:sum(0, function(x) return (x / size) ^ 3 / 3 + x / size end, a) end }
  ok(told.code == "no_convergence", ("nowhere stationary, in units of %g"):format(size), told.iterations)
end
tap.done()
