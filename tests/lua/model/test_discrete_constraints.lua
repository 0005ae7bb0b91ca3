-- discrete Lagrangians with constraints: Cartesian and reduced equations with the same multipliers (spec 3.11), interior points with and without
-- multipliers of their own (3.17)
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, sin, cos, sqrt, log = math.abs, math.max, math.sin, math.cos, math.sqrt, math.log
local m1, m2, l1, l2, g = models.m1, models.m2, models.l1, models.l2, models.g

-- the double spherical pendulum in Cartesian coordinates with rods |q_i| - l_i = 0, and the trapezoidal Ld
local function potential(p) return m1 * g * p[3] + m2 * g * (p[3] + p[6]) end
local function kinetic(w)
  local a = w[1] ^ 2 + w[2] ^ 2 + w[3] ^ 2
  local b = (w[1] + w[4]) ^ 2 + (w[2] + w[5]) ^ 2 + (w[3] + w[6]) ^ 2
  return m1 * a / 2 + m2 * b / 2
end
local function rods(p)
  return { sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2) - l1, sqrt(p[4] ^ 2 + p[5] ^ 2 + p[6] ^ 2) - l2 }
end
local pendulum = dm.system { Q = dm.R(6), L = function(q, v) return kinetic(v) - potential(q) end, constraint = rods }
local h = 0.01
local Ld = dm.discrete_lagrangian { Q = dm.R(6), h = h, constraint = rods,
  Ld = function(q0, q1) return h * (kinetic((q1 - q0) / h) - potential(q0) / 2 - potential(q1) / 2) end }
local Q, V = { 0.6, 0, -0.8, 0.27, 0.36, -0.6 }, { 0.4, 1.2, 0.3, -0.64, -0.02, -0.3 }
local options = { q = Q, p = pendulum:momentum(Q, V), steps = 200, record = { "impulses" } }
local full = dm.solver({ Ld }):run(options)
-- positions at step 10 and lambda_9 of an independent computation in 36 digits (spec, section 4)
local at10 = { 0.60579018825290294, 0.130205165646526727, -0.784897995063991072, 0.227682293074725703, 0.330183927935511475, -0.633750224578509855 }
ok((full.q[11] - dm.vector(at10)):norm() < 1e-14, "ten steps, every digit", full.q[11])
-- a last digit of q counts m/h times: 4e-14
near(full.impulses[10][1], -0.300446207948560708, 1e-13, "lambda_9 of the first rod")
near(full.impulses[10][2], -0.120621893573602423, 1e-13, "lambda_9 of the second rod")
ok(full:worst "constraint" < 5e-16, "constraints hold to round-off", full:worst "constraint")
local twice = dm.discrete_lagrangian(pendulum, { rule = "trapezoidal", h = h })
local again = dm.solver({ twice }):run(options)
ok((again.q[201] - full.q[201]):norm() < 1e-14, "the trapezoidal Ld of the system brings its constraint along", (again.q[201] - full.q[201]):norm())

-- its positions are those of rattle, which projects momenta: half of lambda before a node and half behind it
local projected = pendulum:solver({ rule = "rattle", h = h }):run { q = Q, v = V, steps = 200, record = { "impulses", "lambda" } }
local worst, apart = 0, 0
for i = 1, 200 do
  worst = max(worst, (projected.q[i] - full.q[i]):norm(), (projected.impulses[i] - full.impulses[i]):norm())
  if i > 1 then apart = max(apart, (full.impulses[i] / h - projected.lambda[i]):norm()) end
end
ok(worst < 1e-12, "rattle has the same positions and multipliers", worst)
ok(apart < 0.02, "over h they are the tensions, to order 2", apart)
near(full.impulses[1][1] / full.impulses[2][1], 0.5, 0.01, "the first one, of a tangent momentum, is half an inner one")

-- 3.11: reduced, on (r1, z1, r2, z2, phi)
local function turn(t, p)
  local c, s = cos(t), sin(t)
  return { c * p[1] - s * p[2], s * p[1] + c * p[2], p[3], c * p[4] - s * p[5], s * p[4] + c * p[5], p[6] }
end
local shape = pendulum:routh { action = turn, names = { "theta", "r1", "z1", "r2", "z2", "phi" }, q = Q, v = V,
  section = function(x) return { x[1], 0, x[2], x[3] * cos(x[5]), x[3] * sin(x[5]), x[4] } end }
local D = shape:discrete(Ld)
local s = models.near_pole
local x, u = { 0.6, -0.8, 0.45, -0.6, s.q[4] }, { s.v[2], 0.6 * s.v[2] / 0.8, s.v[3], 0.45 * s.v[3] / 0.6, s.v[4] }
local reduced = D:solver():run { q = x, p = shape:momentum(x, u), steps = 200, record = { "impulses" } }
local back = reduced:reconstruct()
local positions, momenta, lambda = 0, 0, 0
for i = 1, #full do
  positions = max(positions, (back.q[i] - full.q[i]):norm())
  momenta = max(momenta, (back.p[i] - full.p[i]):norm())
  lambda = max(lambda, (reduced.impulses[i] - full.impulses[i]):norm())
end
ok(positions < 1.6e-12, "3.11: reduced = unreduced, positions", positions)
ok(momenta < 1.6e-12, "3.11: momenta", momenta)
ok(lambda < 1.6e-12, "3.11: multipliers", lambda)
ok(reduced:worst "constraint" < 5e-16, "3.11: constraints of the shape hold to round-off", reduced:worst "constraint")
local J, most = 3.1095, 0
for i = 2, #full do
  local q, p = full.q[i], full.p[i]
  most = max(most, abs(q[1] * p[2] - q[2] * p[1] + q[4] * p[5] - q[5] * p[4] - J))
end
ok(most < 3e-13, "the momentum of the group is kept with constraints", most)
-- stage rules on both sides: multipliers of all tie points
for _, rule in ipairs { "midpoint", "gauss(2)" } do
  local start = { q = { 0, 0.6, -0.8, 0.36 }, v = { 1.7, 0.4, 0.3, 0.48 } }
  local cylinder = dm.system { Q = dm.R(4), coordinates = { "theta", "r", "z", "w" }, L = function(q, v)
    return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2 + v[3] ^ 2) / 2 + v[4] ^ 2 / 3 - g * q[3] - q[4] ^ 2
  end, constraint = function(q) return { (q[2] ^ 2 + q[3] ^ 2 - 1) / 2, q[4] - q[2] ^ 2 } end }
  local part = cylinder:routh { q = start.q, v = start.v }
  local a = cylinder:solver({ rule = rule, h = 0.02 }):run { q = start.q, v = start.v, steps = 60, record = { "impulses", "inner", "lambda" } }
  local b = part:solver({ rule = rule, h = 0.02 }):run { q = { 0.6, -0.8, 0.36 }, v = { 0.4, 0.3, 0.48 }, steps = 60, record = { "impulses", "inner", "lambda" } }
  local off, gap = 0, 0
  for i = 1, #a do
    off = max(off, (a.impulses[i] - b.impulses[i]):norm())
    gap = max(gap, (a.lambda[i] - b.lambda[i]):norm())
  end
  if rule == "gauss(2)" then
    for i = 1, 60 do off = max(off, abs(a:column "inner1_1"[i] - b:column "inner1_1"[i]), abs(a:column "inner1_2"[i] - b:column "inner1_2"[i])) end
  end
  ok(off < 1.6e-12, rule .. ": impulses, inner ones too, are those of the unreduced run", off)
  ok(gap < 1e-10, rule .. ": and so are multipliers at the states", gap)
end

-- 3.17: a parabola through q0, Q, q1 with Simpson's weights; Q stationary, with g(Q) = 0 and a multiplier, or without
local function mass(q, v) return v:dot(v) / 2 - g * q[2] end
local function bob(q) return (q:dot(q) - 1) / 2 end
local function simpson(q0, Q1, q1, k)
  return k / 6 * (mass(q0, (4 * Q1 - 3 * q0 - q1) / k) + 4 * mass(Q1, (q1 - q0) / k) + mass(q1, (q0 - 4 * Q1 + 3 * q1) / k))
end
local function parabola(k, inner)
  local middle = dm.root { start = function(q0, q1)
    local Q1 = (q0 + q1) / 2
    return inner and { Q1[1], Q1[2], 0 } or { Q1[1], Q1[2] }
  end, stationary = function(y, q0, q1)
    local Q1 = dm.vector { y[1], y[2] }
    return simpson(q0, Q1, q1, k) + (inner and y[3] * bob(Q1) or 0)
  end }
  return dm.discrete_lagrangian { Q = dm.R(2), h = k, constraint = bob, Ld = function(q0, q1) return middle:value(q0, q1) end }
end
local angle = dm.system { Q = dm.R(1), L = function(q, w) return w[1] ^ 2 / 2 + g * cos(q[1]) end }
local exact = angle:solver({ rule = "gauss(6)", h = 0.01 }):run { q = { 1 }, v = { 2 }, t = 1 }
local tension = g * cos(exact.q[101][1]) + exact:velocity(101)[1] ^ 2
for inner, order in pairs { [true] = 4, [false] = 2 } do
  local errors, forces = {}, {}
  for i, k in ipairs { 0.04, 0.02 } do
    local steps = math.floor(1 / k + 0.5)
    local p = dm.solver({ parabola(k, inner) }):run { q = { sin(1), -cos(1) }, p = { 2 * cos(1), 2 * sin(1) }, steps = steps + 1, record = { "impulses" } }
    errors[i] = (p.q[steps + 1] - dm.vector { sin(exact.q[101][1]), -cos(exact.q[101][1]) }):norm()
    forces[i] = abs(p.impulses[steps + 1][1] + tension * k * (inner and 1 / 3 or 1))
  end
  near(log(errors[1] / errors[2], 2), order, 0.2, ("3.17: order %d %s interior multipliers"):format(order, inner and "with" or "without"))
  ok(forces[2] < 0.02 * 0.02, "multipliers of the nodes are a third of the tension, or all of it", forces[2])
end

-- spheres, two positions, checkpoints, what goes wrong
local ball = dm.discrete_lagrangian { Q = dm.S(2), h = 0.05, Ld = function(q0, q1, k) return (q1 - q0):dot(q1 - q0) / 2 / k - k * g * (q0[3] + q1[3]) / 2 end }
local solver = dm.solver { ball }
local c = cos(0.05)
local free = dm.discrete_lagrangian { Q = dm.S(2), h = 0.05, Ld = function(q0, q1, k) return (q1 - q0):dot(q1 - q0) / 2 / k end }
local circle = dm.solver({ free }):run { q0 = { 1, 0, 0 }, q1 = { c, sin(0.05), 0 }, steps = 100, record = { "impulses" } }
near(circle.q[101][1], cos(5), 1e-13, "a free point on a sphere goes in equal arcs (Moser-Veselov)")
near(circle.impulses[50][1], (c - 1) / 0.05, 1e-14, "with q2 - 2 q1 + q0 = 2 (cos - 1) q1: lambda of |q|^2 - 1 in closed form")
local long = solver:run { q = { 1, 0, 0 }, p = { 0, 1, 0 }, steps = 40 }
local first = solver:run { q = { 1, 0, 0 }, p = { 0, 1, 0 }, steps = 25 }
local file = os.tmpname()
first:checkpoint(file)
local second = dm.resume(file, ball):run { steps = 15 }
os.remove(file)
ok(second.q[16][1] == long.q[41][1] and second.p[16][3] == long.p[41][3], "goes on bit for bit from a checkpoint")
local two = solver:ensemble { members = 2, q = function() return { 1, 0, 0 } end, p = function(i) return { 0, i, 0 } end, steps = 40 }
ok(two.q[1][1] == long.q[41][1] and two.status[2] == "ok", "members of an ensemble")
near(dm.discrete_lagrangian(dm.system { Q = dm.R(2), L = mass, constraint = bob }, { rule = "midpoint", h = 0.02 }):order { q = { 0, -1 }, v = { 1, 0 } }, 2, 0.01,
  "the order of a discrete Lagrangian with a constraint")
raises("start on the constraint", function() ball:order() end)
raises("member 2: no start", function()
  solver:ensemble { members = 2, q = function(i) return { i, 0, 0 } end, p = function() return { 0, 1, 0 } end, steps = 4 }
end)
raises("off the constraints", function() solver:run { q = { 1, 0.1, 0 }, p = { 0, 1, 0 }, steps = 1 } end)
raises("q1: no start", function() solver:run { q0 = { 1, 0, 0 }, q1 = { 1, 0.1, 0 }, steps = 1 } end)
raises("has no mass", function() solver:run { q = { 1, 0.1, 0 }, p = { 0, 1, 0 }, steps = 1, project = true } end)
raises("knows no time", function()
  dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(q0, q1) return q0:dot(q1) end, constraint = function(q, t) return q[1] - t end }
end)
raises("impulses", function() solver:run { q = { 1, 0, 0 }, p = { 0, 1, 0 }, steps = 1, record = { "lambda" } } end)
raises("multipliers of its steps", function() return long:multipliers() end)
raises("at its nodes", function() dm.discrete_lagrangian(pendulum, { rule = "gauss(2)", h = 0.1 }) end)
raises("at points inside", function() shape:discrete { rule = "gauss(2)", h = 0.1 } end)
raises("has constraints", function() D:step(x, x) end)

tap.done()
