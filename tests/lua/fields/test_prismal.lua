-- prisms over uneven slices: leapfrog where they are even, order 2, Gauss's law, symplectic
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, pi = math.sin, math.pi

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local K = dm.mesh { triangle = 6 }
local maxwell = K:field { form = 1, fixed = "boundary", L = wave }
local q = K:form(1, function(x, y) return { y * x * (1 - x), y ^ 2 * x } end)
local v = K:form(1, function(x, y) return { x, -y } end)
local function run(times, options)
  options = options or {}
  options.q, options.v = q, v
  return maxwell:solver { rule = dm.prismal(times) }:run(options)
end

-- even slices are verlet's steps
local even = {}
for i = 0, 200 do even[i + 1] = i / 32 end
local a, b = run(even), maxwell:solver { rule = "verlet", h = 1 / 32 }:run { q = q, v = v, steps = 200 }
ok(#a == 201 and (a.q[201] - b.q[201]):norm() < 1e-13 and (a.p[201] - b.p[201]):norm() < 1e-13, "leapfrog")
ok(#run(even, { every = 7 }) == 30, "every 7th, and the last")

-- uneven ones by hand: M ((A2 - A1)/h1 - (A1 - A0)/h0) = (h0 + h1)/2 dL/dA, on every edge
local times = { 1, 1.03, 1.04, 1.09, 1.1, 1.15 }
local path, mass = run(times), maxwell.field.masses
local force = require "dm.core".field_force
for k = 2, 5 do
  local before, after, F = times[k] - times[k - 1], times[k + 1] - times[k], force(maxwell, path.q[k])
  local worst = 0
  for i = 1, #mass do
    local left = mass[i] * ((path.q[k + 1][i] - path.q[k][i]) / after - (path.q[k][i] - path.q[k - 1][i]) / before)
    worst = math.max(worst, math.abs(left - (before + after) / 2 * F[i]))
  end
  ok(worst < 1e-14, "the equation of slice " .. k, worst)
  near(path.t[k], times[k], 0, "its time")
end

-- order 2 where steps change smoothly, and Gauss's law where they do not
local function smooth(n)
  local list = {}
  for i = 0, n do list[i + 1] = 0.5 * (i / n + 0.1 * sin(2 * pi * i / n)) end
  return run(list, { every = n }).q[2]
end
local exact = smooth(2000)
near(math.log((smooth(50) - exact):norm() / (smooth(100) - exact):norm()) / math.log(2), 2, 0.05, "order 2")
local rough = { 0 }
for i = 1, 2000 do rough[i + 1] = rough[i] + 0.02 * (1 + 0.9 * sin(i * i)) end
ok(run(rough, { every = 50 }):drift "gauss".largest < 1e-13, "Gauss's law")

-- symplectic: the form of two variations stays, on an anharmonic field with unit vectors and without
local plate = dm.mesh { triangle = 2 }
local bent = plate:field { L = function(u, w) return wave(u, w) - plate:sum(0, function(x, cell) return cell.star * x ^ 4 end, u) end }
local function ends(x, y)
  local last = bent:solver { rule = dm.prismal { 0, 0.1, 0.13, 0.3 } }:run { q = x, p = y, every = 3 }
  return last.q[2], last.p[2]
end
local n, e = 6, 1e-4
local function vary(f)
  local x, y = {}, {}
  for i = 1, n do x[i], y[i] = sin(i) + f(i), math.cos(i) + f(i + n) end
  return ends(x, y)
end
local function variation(f)
  local q1, p1 = vary(function(i) return e * f(i) end)
  local q0, p0 = vary(function(i) return -e * f(i) end)
  return (q1 - q0) / (2 * e), (p1 - p0) / (2 * e)
end
local function f(i) return sin(3 * i) end
local function g(i) return math.cos(i * i) end
local fq, fp = variation(f)
local gq, gp = variation(g)
local before = 0
for i = 1, n do before = before + f(i) * g(i + n) - g(i) * f(i + n) end
near(fq:dot(gp) - gq:dot(fp), before, 1e-6, "symplectic")

-- what is refused
raises("two growing times", function() dm.prismal { 1 } end)
raises("times must grow", function() dm.prismal { 0, 1, 1 } end)
raises("finite number", function() dm.prismal { 0, 1 / 0 } end)
raises("unknown option 'h'", function() maxwell:solver { rule = dm.prismal { 0, 1 }, h = 1 } end)
raises("fields on meshes", function()
  dm.system { Q = dm.R(1), L = function(_, w) return w:dot(w) / 2 end }:solver { rule = dm.prismal { 0, 1 } } end)
local beyond = {}
for i = 0, 400 do beyond[i + 1] = i end
raises("NaN or infinite", function() run(beyond) end)

-- the inner function takes what is none of slices, options and endings for what it is
do
  local core = require "dm.core"
  local solver = dm.system({ Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }):solver { rule = "verlet", h = 0.1 }
  local times = dm.vector { 0, 0.1, 0.3 }
  local function run(more, slices, every)
    local options = { q = { 0, 1 }, v = { 0, 0 } }
    for key, value in pairs(more) do options[key] = value end
    return core.prismal_run(solver, options, slices, every)
  end
  for _, slices in ipairs { {}, { 1 }, { 0, -1 }, { 0, 0 } } do tap.raises("#3", run, {}, slices, 1) end
  for _, from in ipairs { 3, {}, { 1, 2 }, "x" } do tap.raises("'from' must be an ending", run, { from = from }, times, 1) end
  for _, every in ipairs { 0, math.mininteger } do tap.raises("#4", run, {}, times, every) end
  tap.ok(#run({}, times, math.maxinteger) == 2, "rows at every so many'th slice of more than there are: start and end")
end
tap.done()
