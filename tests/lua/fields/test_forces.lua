-- forces on fields: force, absorbing; reflection, orders, exact solutions, threads, what is refused
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, exp, pi, abs = math.sin, math.cos, math.exp, math.pi, math.abs

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function zero() return 0 end
local function line(N)
  local simplices, points = {}, {}
  for i = 1, N do simplices[i] = { i, i + 1 } end
  for i = 1, N + 1 do points[i] = { (i - 1) / N } end
  return dm.mesh { simplices = simplices, points = points }
end

-- a packet of 20 cells a wave that runs into an end: u_tt = u_xx, force -c u_t at the end node. From
-- (dx/2) u_tt = (u_1 - u_0)/dx - c u_t with waves exp(i (w t +- k x)), a = k dx, central differences:
-- R = (1 - z)/(1 + z), z = dx sin(w h)/(h sin a); for h -> 0 (cos(a/2) - 1)/(cos(a/2) + 1)
local function reflection(rule, lambda, c)
  local N, a = 1000, pi / 10
  local dx, h, k = 1 / N, lambda / N, a * N
  local omega = 2 / h * math.asin(lambda * sin(a / 2))
  local group = cos(a / 2) / math.sqrt(1 - (lambda * sin(a / 2)) ^ 2)
  local function u(x, t) return exp(-((x - 0.5 - group * t) / 0.08) ^ 2) * cos(k * x - omega * t) end
  local run = line(N):field { L = wave, absorbing = { "boundary", c = c } }:solver { rule = rule, h = h }:run {
    q = function(x) return u(x, 0) end, v = function(x) return (u(x, h) - u(x, -h)) / (2 * h) end, t = 0.9, every = 1e6 }
  local last, most = run.q[#run], 0
  for i = 1, #last do most = math.max(most, abs(last[i])) end
  local z = dx * sin(omega * h) / (h * sin(a)) * c
  return most, abs((1 - z) / (1 + z))
end
local measured, theory = reflection("verlet", 0.5, 1)
near(measured, theory, 0.05 * theory, "reflection of an absorbing end")
measured = reflection("verlet", 1, 1)
ok(measured < 1e-4, "none where a step is a cell wide", measured)
measured, theory = reflection("verlet", 0.5, 2)
near(measured, theory, 0.02 * theory, "reflection of another speed")
measured = reflection("midpoint", 0.25, 1)
ok(measured < 0.01, "midpoint", measured)

-- an E-field between two conducting plates: A = f(x - t) leaves through the end of equilateral triangles
local N, rows, simplices, points = 80, 3, {}, {}
local function id(i, j) return j * (N + 1) + i + 1 end
for j = 0, rows do
  for i = 0, N do points[id(i, j)] = { (i + 0.5 * (j % 2)) / N, j * math.sqrt(3) / 2 / N } end
end
for j = 0, rows - 1 do
  for i = 0, N - 1 do
    local a, b, c, d = id(i, j), id(i + 1, j), id(i, j + 1), id(i + 1, j + 1)
    simplices[#simplices + 1] = j % 2 == 0 and { a, b, c } or { a, d, c }
    simplices[#simplices + 1] = j % 2 == 0 and { b, d, c } or { a, b, d }
  end
end
local strip = dm.mesh { points = points, simplices = simplices }
local function plates(_, y) return y < 1e-9 or y > rows * math.sqrt(3) / 2 / N - 1e-9 end
local function left_over(absorbing)
  local run = strip:field { form = 1, L = wave, fixed = plates, absorbing = absorbing }:solver { rule = "verlet", h = 0.2 / N }:run {
    q = strip:form(1, function(x) return { 0, exp(-100 * (x - 0.5) ^ 2) } end),
    v = strip:form(1, function(x) return { 0, 200 * (x - 0.5) * exp(-100 * (x - 0.5) ^ 2) } end), t = 1.5, every = 10000 }
  return run:energy()[2] / run:energy()[1]
end
near(left_over(nil), 1, 0.01, "Maxwell's waves stay between conductors and free ends")
local left = left_over(function(x, y) return x > 1 - 0.6 / N and not plates(x, y) end)
ok(left < 0.01, "and leave through an end that absorbs", left)

-- damping of everything: u = exp(-g t/2) (...), with each rule's own order; a driving force of t
local plate = dm.mesh { triangle = 3 }
local J = plate:form(0, function(x, y) return x * y end)
local function with(force, more)
  local options = { values = 2, force = force, L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 - u:dot(u) end }
  for key, x in pairs(more or {}) do options[key] = x end
  return plate:field(options)
end
local forces = {
  friction = with(function(_, V) return -0.7 * V end),
  cubic = with(function(_, V) return V:map(function(v) return { -v[1] * v:dot(v) + 0.3 * v[2], -v[2] ^ 3 - 0.2 * v[1] * v[2] } end) end),
  driven = with(function(_, _, t) return { sin(3 * t) * J, J * cos(t) } end, { absorbing = { "boundary", c = 0.5 } }),
  place = with(function(A, _, t) return A:map(function(a) return { a[2] * cos(t), -a[1] } end) end) }
local n = 2 * plate:count(0)
local q, v = {}, {}
for i = 1, n do q[i], v[i] = sin(i), cos(2 * i) end
local function order(field, rule)
  local function last(steps)
    local run = field:solver { rule = rule, h = 0.4 / steps }:run { q = q, v = v, steps = steps, every = steps }
    return run.q[#run]
  end
  local exact = field:solver { rule = "gauss(3)", h = 0.4 / 100 }:run { q = q, v = v, t = 0.4, every = 100 }.q[2]
  return math.log((last(8) - exact):norm() / (last(16) - exact):norm()) / math.log(2)
end
for name, field in pairs(forces) do
  for rule, expected in pairs { verlet = 2, midpoint = 2, trapezoidal = 2, ["gauss(2)"] = 4, ["lobatto(3)"] = 4 } do
    local found = order(field, rule)
    ok(found > expected - 0.15, name .. ": order of " .. rule, found)
  end
end
near(order(forces.place, "yoshida(4)"), 4, 0.2, "forces of q and t: any splitting")

-- explicit Runge-Kutta: cubic drag without neighbours, v' = -v^3, has v = v0/sqrt(1 + 2 v0^2 t); a
-- nonlinear wave with absorbing ends and a force of A, V and t against stages
local function expected_of(rule) return ({ rk4 = 4, rkf45 = 5, rk8 = 8, rk8pd = 8 })[rule] end
local drag = plate:field { L = function(_, V) return V:dot(V) / 2 end, force = function(_, V) return V:map(function(v) return -v ^ 3 end) end }
local rates, ends = {}, {}
for i = 1, plate:count(0) do
  rates[i] = 1 + 0.1 * i
  ends[i] = (math.sqrt(1 + 2 * rates[i] ^ 2) - 1) / rates[i]
end
local mixed = with(function(A, V, t) return A:map(function(a) return { a[1] * a[2], cos(t) * a[1] ^ 2 } end) - V:map(function(x) return { x[1] ^ 3, x[2] * x:dot(x) } end) end,
  { absorbing = { "boundary", c = 0.5 }, L = function(u, w) return w:dot(w) / 2 - u:d():dot(u:d()) / 2 + u:map(function(x) return { cos(x[1]), cos(x[2]) } end):dot(u) end })
local reference = mixed:solver { rule = "gauss(4)", h = 0.004 }:run { q = q, v = v, t = 0.4, every = 100 }.q[2]
for _, rule in ipairs { "rk4", "rkf45", "rk8", "rk8pd" } do
  local few = expected_of(rule) == 8 and 6 or 16
  local function drag_error(steps)
    local run = drag:solver { rule = rule, h = 1 / steps }:run { q = zero, v = rates, steps = steps, every = steps }
    return (run.q[2] - dm.vector(ends)):norm()
  end
  local function mixed_error(steps)
    local run = mixed:solver { rule = rule, h = 0.4 / steps }:run { q = q, v = v, steps = steps, every = steps }
    return (run.q[2] - reference):norm()
  end
  for name, error_of in pairs { ["cubic drag"] = drag_error, ["a nonlinear wave"] = mixed_error } do
    local found = math.log(error_of(few) / error_of(2 * few)) / math.log(2)
    ok(found > expected_of(rule) - 0.4, name .. ": order of " .. rule, found)
  end
end

-- a list of numbers is added to dL/dq; constant force, one step by hand
local list = {}
for i = 1, plate:count(0) do list[i] = i / 10 end
local pushed = plate:field { L = function(_, V) return V:dot(V) / 2 end, force = function() return list end }
local step = pushed:solver { rule = "verlet", h = 0.5 }:run { q = zero, v = zero, steps = 4, every = 4 }
for i = 1, #list, 3 do near(step.p[2][i], 2 * list[i], 1e-14, "p = F t") end

-- friction on spheres, threads, bursts, checkpoints
local ring, around = {}, {}
for i = 1, 12 do ring[i], around[i] = { i, i % 12 + 1 }, { cos(pi * i / 6), sin(pi * i / 6) } end
local map = dm.mesh { simplices = ring, points = around }:field { values = 3, on = dm.S(2), L = wave, force = function(_, V) return -0.5 * V end }
local start = { q = function(x, y) return { x, y, 0 } end, v = function(x, y) return { -0.7 * y, 0.7 * x, 0 } end, steps = 200 }
local turned = map:solver { rule = "rattle", h = 0.01 }:run(start)
local function speed(i) return (turned.p[i]:norm() / turned.p[1]:norm()) end
near(speed(201), exp(-0.5 * 2), 1e-5, "friction slows a wave map down as exp(-g t)")
local ball = dm.mesh { icosphere = 3 }
local damped = ball:field { L = wave, force = function(A, V) return A:map(sin) - V end }
local begin = { q = function(x, y, z) return exp(z) end, v = zero, steps = 40, every = 40 }
local function last(options)
  options.rule, options.h = "verlet", 0.02
  local run = damped:solver(options):run(begin)
  return run.q[#run]
end
ok(last { threads = 1 } == last { threads = 2 }, "threads give the same bits")
begin.every = 1
local by_one = last {}
begin.every = 40
ok(by_one == last {}, "bursts too")

-- what is refused
raises("kicks inside", function() forces.friction:solver { rule = "yoshida(4)", h = 0.1 }:run { q = q, v = v, steps = 1 } end)
raises("forces beside L", function() forces.friction:solver { rule = "curve(rk4)", h = 0.1 }:run { q = q, v = v, steps = 1 } end)
raises("forces beside L", function() forces.friction:solver { rule = "avi", h = 0.1 }:run { q = q, v = v, t = 1 } end)
raises("closed", function() ball:field { L = wave, absorbing = "boundary" } end)
raises("no values on the boundary", function() plate:field { form = 2, L = function(_, V) return V:dot(V) / 2 end, absorbing = "boundary" } end)
raises("names no facet", function() plate:field { L = wave, absorbing = { 1 } } end)
raises("must return a form", function() plate:field { L = wave, force = function() return 3 end } end)
raises("primal 0-form", function() plate:field { L = wave, force = function(A) return A:d() end } end)
raises("'c'", function() plate:field { L = wave, absorbing = { c = -1 } } end)
tap.done()
