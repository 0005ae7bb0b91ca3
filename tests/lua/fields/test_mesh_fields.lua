-- fields on meshes: explicit rules, modes, limits, Gauss's law, energy, orders, what is refused
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local small
local cos, sqrt, sin, pi = math.cos, math.sqrt, math.sin, math.pi

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function zero() return 0 end

-- Maxwell's equations in a cavity (Leok 3.12): discrete frequency, Gauss's law, energy of a step
local cavity, h = dm.mesh { triangle = 8 }, 0.03
local maxwell = cavity:field { form = 1, fixed = "boundary", L = wave }
local mode = maxwell:modes(2, { above = 1 })
near(mode.values[1], 17.445976939997, 1e-9, "first mode of the cavity past 21 zeros")
near(mode.forms[1]:norm(), 1, 1e-12, "of norm 1")
local omega = 2 / h * math.asin(h * sqrt(mode.values[1]) / 2)
local first, solver = mode.forms[1], maxwell:solver { rule = "verlet", h = h }
local run = solver:run { q = first, v = 0 * first, steps = 400, every = 400 }
ok((run:form(2) - cos(omega * 400 * h) * first):norm() < 1e-10, "a mode keeps its discrete frequency")
local function component(x, y) return { y * x * (1 - x), y ^ 2 * x } end
run = solver:run { q = cavity:form(1, component), v = function(x, y) return { x, -y } end, steps = 2000, every = 40 }
ok(run:drift "gauss".largest < 1e-13, "Gauss's law", run:drift "gauss".largest)
ok(run:drift "energy".largest < 0.02 * run:energy()[1], "energy stays near", run:drift "energy".largest)

-- beyond the limit a mode grows, just below it does not
for degree, limit in pairs { [0] = 2 / (6 * sqrt(6)), [1] = 1 / (6 * sqrt(6)) } do
  local field = dm.mesh { hex_torus = 6 }:field { form = degree, L = wave }
  near(field:stability_limit "verlet", limit, 1e-9, "limit on the hexagonal torus, degree " .. degree)
  local n = field.field.n
  local random = {}
  for i = 1, n do random[i] = sin(i * i) end
  local function size(part)
    local path = field:solver { rule = "verlet", h = part * limit }:run { q = random, v = random, steps = 1000, every = 1000 }
    return path.q[#path]:norm() / path.q[1]:norm()
  end
  ok(size(0.999) < 100, "stable at 0.999 of it", size(0.999))
  local fine, grown = pcall(size, 1.01)
  ok(not fine or grown > 1e3, "unstable beyond it")
end

-- nonlinear, several values, in space, with t and params: order 2, 4; energy of autonomous ones
local function order(field, rule, q, v)
  local function last(steps)
    local path = field:solver { rule = rule, h = 0.4 / steps }:run { q = q, v = v, steps = steps, every = steps }
    return path.q[#path]
  end
  local a, b, c = last(16), last(32), last(64)
  return math.log((a - b):norm() / (b - c):norm()) / math.log(2)
end
local box = dm.mesh { bcc = 3 }
local driven = box:field { form = 1, params = { k = 2 }, L = function(u, v, t, params)
  return v:dot(v) / 2 - cos(t) * u:d():dot(u:d()) / 20 - box:sum(1, function(a, cell) return cell.star * (params.k - cos(t * a)) end, u) end }
local n = driven.field.n
local q, v = {}, {}
for i = 1, n do q[i], v[i] = sin(i), cos(2 * i) end
near(order(driven, "verlet", q, v), 2, 0.1, "driven 1-form in space: verlet has order 2")
near(order(driven, "yoshida(4)", q, v), 4, 0.3, "and yoshida(4) order 4")
local plate = dm.mesh { triangle = 3 }
local map = plate:field { values = 2, fixed = { 1, 4 }, L = function(u, v)
  return v:dot(v) / 2 - plate:sum(2, function(x, cell) return cell.volume * ((x[2] - x[1]):dot(x[3] - x[1]) ^ 2 + x[1]:dot(x[1])) end, u) end }
local path = map:solver { rule = "verlet", h = 0.01 }:run { q = function(x, y) return { x + 0.1 * y, y } end,
  v = function(x) return { 0, x } end, steps = 100 }
ok(path.q[101][7] == path.q[1][7] and path.q[101][8] == path.q[1][8], "fixed values stay")
ok(#path:form(3) == 2 and path:form(3)[2][2] == path.q[3][4], "a form for every value")
ok(path:drift "energy".largest < 1e-4, "energy of a map", path:drift "energy".largest)

-- the same bits on the tape and in lanes
local function bits(backend)
  local p = map:solver { rule = "verlet", h = 0.01, backend = backend }:run { q = function(x, y) return { x + 0.1 * y, y } end,
    v = function(x) return { 0, x } end, steps = 20 }
  return p.q[21]
end
ok(bits "tape" == bits "jit", "tape and machine code give the same bits")
-- threads of a step, also with sums without compensation, with time in factors, and on spheres; on the torus, whose
-- cells have entries near to each other, threads have ranges of them, on the icosphere lists
local sphere, torus = dm.mesh { icosphere = 4 }, dm.mesh { hex_torus = 48 }
local function threaded(what, L, rule, options, q, v, K)
  options.L = L
  local field = (K or sphere):field(options)
  local function last(threads, sums)
    local p = field:solver { rule = rule, h = K and 0.002 or 0.01, threads = threads, sums = sums }:run { q = q, v = v, steps = 20, every = 7 }
    return p.q[#p], p.p[#p]
  end
  local q1, p1 = last(1)
  for threads = 2, 4 do
    local q2, p2 = last(threads)
    ok(q1 == q2 and p1 == p2, what .. (": %d threads give the same bits"):format(threads))
  end
  return (q1 - last(2, "plain")):norm()
end
local function pulse(x, y, z) return math.exp(4 * z) / 50 end
small = threaded("0-form", function(u, v) return wave(u, v) - sphere:sum(0, function(a, cell) return cell.star * (1 - cos(a)) end, u) end, "verlet", {}, pulse, zero)
ok(small < 1e-13, "plain sums differ by round-off", small)
threaded("1-form, time in factors", function(u, v, t) return v:dot(v) / 2 - cos(t) * u:d():dot(u:d()) end, "yoshida(4)", { form = 1 },
  function(x, y, z) return { z, x, y } end, function() return { 0, 0, 0 } end)
local function along(x, y, z) local c, s = cos(3 * z), sin(3 * z) return { c * x - s * y, s * x + c * y, z } end
local function across(x, y, z) local a = along(x, y, z) return { -a[2], a[1], 0 } end
threaded("wave map", wave, "rattle", { values = 3, on = dm.S(2) }, along, across)
for degree = 0, 1 do
  local q = {}
  for i = 1, torus:count(degree) do q[i] = math.sin(i * i) end
  q = dm.vector(q)
  threaded(("%d-form on a torus"):format(degree), wave, "verlet", { form = degree, fixed = { 2, 300 } }, q, 0 * q, torus)
  threaded(("%d-form on a torus, any slopes"):format(degree), function(u, v, t)
    return wave(u, v) - (1 + t) * torus:sum(degree, function(a, cell) return cell.star * a ^ 4 end, u)
  end, "yoshida(4)", { form = degree }, q, 0 * q, torus)
end
local flat = dm.mesh { triangle = 40 }
threaded("unit vectors on a triangle", wave, "rattle", { values = 3, on = dm.S(2) }, function(x, y) return { cos(9 * x), sin(9 * x), 0 } end,
  function(_, y) return { 0, 0, y } end, flat)
threaded("friction on a triangle", wave, "verlet", { force = function(_, v) return -v end }, function(x, y) return sin(9 * x + y) end, zero, flat)
-- wave maps: order 2, unit vectors, energy, reversibility, angular momentum (target rotations)
local maps = dm.mesh { icosphere = 1 }:field { values = 3, on = dm.S(2), L = wave }
near(order(maps, "rattle", along, across), 2, 0.1, "a wave map by rattle has order 2")
near(order(maps, "yoshida(4, rattle)", along, across), 4, 0.2, "compositions of rattle have theirs")
path = maps:solver { rule = "rattle", h = 0.02 }:run { q = along, v = across, steps = 500 }
ok(path:drift "energy".largest < 1e-2 * path:energy()[1], "energy of a wave map", path:drift "energy".largest)
local off, J = 0, {}
for _, i in ipairs { 1, 501 } do
  local x, p, sum = path.q[i], path.p[i], 0
  for c = 0, #x - 1, 3 do
    off = math.max(off, math.abs(x[c + 1] ^ 2 + x[c + 2] ^ 2 + x[c + 3] ^ 2 - 1), math.abs(x[c + 1] * p[c + 1] + x[c + 2] * p[c + 2] + x[c + 3] * p[c + 3]))
    sum = sum + x[c + 1] * p[c + 2] - x[c + 2] * p[c + 1]
  end
  J[#J + 1] = sum
end
ok(off < 1e-14, "unit vectors with tangent momenta", off)
near(J[1], J[2], 1e-12, "rotations of the target keep their momentum")
local back = maps:solver { rule = "rattle", h = 0.02 }:run { q = path.q[501], p = -path.p[501], steps = 500, every = 500 }
ok((back.q[2] - path.q[1]):norm() < 1e-11, "rattle is reversible", (back.q[2] - path.q[1]):norm())

-- right triangles: diagonals have no mass; eliminated, they leave Yee's scheme on squares
local M = 5
local squares = dm.mesh { grid = M }
local yee = squares:field { form = 1, fixed = "boundary", massless = "eliminate", L = wave }
local function square(a) return 4 * M ^ 2 * sin(pi * a / (2 * M)) ^ 2 end
local found, expected = yee:modes(5, { above = 1 }).values, { square(1), square(1), 2 * square(1), square(2), square(2) }
for i = 1, 5 do near(found[i], expected[i], 1e-10, "eigenvalue " .. i .. " of Yee's scheme") end
local tm = squares:form(1, function(x, y) return { sin(pi * y), 0 } end)
for threads = 1, 2 do
  path = yee:solver { rule = "verlet", h = 0.05, threads = threads }:run { q = tm, v = 0 * tm, steps = 200 }
  local slow, worst = 2 / 0.05 * math.asin(0.05 * sqrt(square(1)) / 2), 0
  for i = 1, #path.q[1] do worst = math.max(worst, math.abs(path.q[201][i] - cos(slow * 10) * path.q[1][i])) end
  ok(worst < 1e-12, "and a mode of it, diagonals too", worst)
end

-- a member of an ensemble has the bits of a run; a checkpoint goes on
local cloud = map:solver { rule = "verlet", h = 0.01 }:ensemble { members = 2, steps = 20, q = function() return function(x, y) return { x + 0.1 * y, y } end end,
  v = function() return function(x) return { 0, x } end end }
ok(cloud.q and cloud.q[1] and true or cloud ~= nil, "ensembles start from functions of the position")
-- a line: the string's dispersion, free ends, a function of the position that fixes
local line, N = {}, 16
for i = 1, N do line[i] = { i, i + 1 } end
local points = {}
for i = 0, N do points[i + 1] = { i / N } end
local string = dm.mesh { simplices = line, points = points }:field { fixed = function(x) return x == 0 or x == 1 end, L = wave }
near(string:modes(1).values[1], 4 * N ^ 2 * sin(pi / (2 * N)) ^ 2, 1e-10, "first mode of a string")

-- modes of unit vectors are tangent: a great circle, harmonic, along 2 w cos(a) (1 - cos ka)/m, across 2 w (cos(a) - cos ka)/m
do
  local n, ring, at = 10, {}, {}
  local a = 2 * pi / n
  for i = 1, n do ring[i], at[i] = { i, i % n + 1 }, { cos(a * i), sin(a * i) } end
  local hoop = dm.mesh { simplices = ring, points = at }
  local target = hoop:field { values = 3, on = dm.S(2), L = wave }
  local w, m = hoop:star_weights(1)[1], hoop:star_weights(0)[1]
  local expected = {}
  for k = 0, n - 1 do
    expected[#expected + 1] = 2 * w / m * cos(a) * (1 - cos(k * a))
    expected[#expected + 1] = 2 * w / m * (cos(a) - cos(k * a))
  end
  table.sort(expected)
  local q = function(x, y) local r = sqrt(x * x + y * y) return { x / r, y / r, 0 } end
  local found, worst = target:modes(2 * n, { q = q, above = expected[1] - 0.1 }), 0
  for i, value in ipairs(expected) do worst = math.max(worst, math.abs(found.values[i] - value)) end
  ok(worst < 1e-12, "modes of a map onto a great circle, the unstable one too", worst)
  ok(math.abs(expected[1] + 2 * w / m * (1 - cos(a))) < 1e-12 and expected[1] < 0, "(it slips off the circle)")
  local tangent = 0
  for _, forms in ipairs(found.forms) do
    for i = 1, n do
      local x = q(at[i][1], at[i][2])
      tangent = math.max(tangent, math.abs(forms[1][i] * x[1] + forms[2][i] * x[2]))
    end
  end
  ok(tangent < 1e-13, "their forms are tangent", tangent)
  near(target:stability_limit("rattle", { q = q }), 2 / sqrt(expected[2 * n]), 1e-9, "and the limit of rattle is that of the fastest")
  raises("option 'q' is missing: the state, unit vectors", function() target:modes(2) end)
  raises("option 'q' is missing", function() target:stability_limit "rattle" end)
  raises("a step of its own in every cell", function() string:stability_limit "avi" end)
end

raises("option 'form' is the degree", function() cavity:field { form = 3, L = wave } end)
raises("larger cell", function() cavity:field { form = 1, L = function(V, W) return W:dot(W) / 2 - V:delta():dot(V:delta()) / 2 end } end)
raises("negative", function()
  dm.mesh { points = { { 0, 0 }, { 4, 0 }, { 1, 1 } }, simplices = { { 1, 2, 3 } } }:field { form = 1, L = wave } end)
raises("zero dual", function() dm.mesh { grid = 4 }:field { form = 1, L = wave } end)
raises("meet in L", function() dm.mesh { cube_tiling = 2 }:field { form = 2, massless = "eliminate", L = wave } end)
raises("take verlet", function() yee:solver { rule = "midpoint", h = 0.1 }:run { q = tm, v = 0 * tm, steps = 1 } end)
raises("sum of m v^2 / 2", function() cavity:field { L = function(u, w) return cavity:sum(1, function(a) return a[1] * a[2] end, w) end } end)
raises("no kinetic energy", function() cavity:field { L = function(u, w) return cavity:sum(0, function(a, cell) return 0 * a end, w) - u:dot(u) end } end)
raises("must return a number", function() cavity:field { L = function(u) return u end } end)
raises("unknown option 'fixd'", function() cavity:field { L = wave, fixd = "boundary" } end)
raises("must be the number of a cell", function() cavity:field { L = wave, fixed = { 1000 } } end)
raises("primal 1-form", function() solver:run { q = cavity:form(0, zero), v = 0 * first, steps = 1 } end)
raises("no Gauss's law", function() cavity:field { L = wave }:solver { rule = "verlet", h = 0.01 }:run { q = zero, v = zero, steps = 3 }:column "gauss" end)
raises("unit vector", function() maps:solver { rule = "rattle", h = 0.1 }:run { q = function() return { 1, 1, 0 } end, v = across, steps = 1 } end)
raises("tangent", function() maps:solver { rule = "rattle", h = 0.1 }:run { q = along, v = along, steps = 1 } end)
raises("unit vectors; take rattle", function() maps:solver { rule = "verlet", h = 0.1 }:run { q = along, v = across, steps = 1 } end)
raises("take verlet", function() solver.system:solver { rule = "rattle", h = 0.1 }:run { q = first, v = 0 * first, steps = 1 } end)
raises("must be a sphere", function() cavity:field { L = wave, on = dm.R(2) } end)
raises("and a point of S(2) has 3", function() cavity:field { L = wave, on = dm.S(2), values = 2 } end)
raises("list of 3 numbers", function() maps:solver { rule = "rattle", h = 0.1 }:run { q = zero, v = across, steps = 1 } end)
raises("no field", function() dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 end }:modes(1) end)

-- what would write L out in symbols says that a field's L stays a loop
do
  local small = dm.mesh { triangle = 2 }
  local f = small:field { form = 0, L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
  tap.raises("written out in symbols", function()
    f:solver { rule = "verlet", h = 0.01 }:lyapunov { q = function(x) return x end, v = function() return 0 end, t = 1 }
  end)
end

-- starts of several values: rows for cells, as the points of a body are
do
  local sheet = dm.mesh { grid = 3 }
  local body = sheet:field { values = 2, L = function(x, v) return v:dot(v) / 2 - x:d():dot(x:d()) / 2 end }
  local rows, flat, still = {}, {}, function() return { 0, 0 } end
  for i, p in ipairs(sheet:points():totable()) do
    rows[i], flat[2 * i - 1], flat[2 * i] = { p[1], p[2] }, p[1], p[2]
  end
  local solver = body:solver { rule = "verlet", h = 0.1 }
  for what, x in pairs { matrix = sheet:points(), lists = rows, ["function"] = function(x, y) return { x, y } end } do
    ok(solver:run { q = x, v = still, steps = 1 }.q[1] == dm.vector(flat), "a start of rows: " .. what)
  end
  rows[5] = { 1 }
  raises("a list of 2 numbers is needed for every cell", function() solver:run { q = rows, v = still, steps = 1 } end)
  raises("32 numbers", function() solver:run { q = dm.mesh { grid = 2 }:points(), v = still, steps = 1 } end)
end
tap.done()
