-- dm.curve on systems with forces, constraints and rolling, alone and together: the order is that of the method, constraints hold
-- to round-off, and what theory keeps is kept
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local abs, cos, sin, exp, log, max, sqrt = math.abs, math.cos, math.sin, math.exp, math.log, math.max, math.sqrt

local function system(n, L, more)
  local options = { Q = dm.R(n), L = L }
  for key, value in pairs(more) do options[key] = value end
  return dm.system(options)
end
local function drag(_, v) return -0.3 * v:norm() * v end
local function sphere(q) return q:dot(q) - 1 end
local function skate(q, v) return v[3] - q[2] * v[1] end
local function bowl(q, v) return v:dot(v) / 2 - q[2] ^ 2 / 2 - 0.3 * q[1] ^ 2 end
local function hill(q, v) return v:dot(v) / 2 - q[3] - 0.2 * q[1] ^ 2 end

-- problems without a closed form, against gauss(4) at small steps, another engine; those with a force alone against rk8
local down, along = { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 } }, { q = { 0.3, 1, 0.2 }, v = { 0.7, 0.4, 0.7 } }
local problems = {
  { "a force", "rk8", { q = { 0.3, 0.8 }, v = { 0.2, -0.4 } }, system(2, function(q, v, t)
    return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[2]) + cos(q[2]) * (1 + 0.2 * sin(t)) - q[1] ^ 2 / 2
  end, { force = function(q, v, t) return { -0.3 * v[1] * q[2] ^ 2 + sin(t), -0.2 * v[2] * (1 + q[1] ^ 2) } end }) },
  { "a constraint", "gauss(4)", down, system(3, hill, { constraint = sphere }) },
  { "a constraint that moves, and a force", "gauss(4)", { q = { 0.6, 0, -0.8 }, v = { 0.06, 1, -0.08 } }, system(3, hill,
    { constraint = function(q, t) return q:dot(q) - (1 + 0.1 * sin(t)) ^ 2 end, force = drag }) },
  { "rolling", "gauss(4)", along, system(3, bowl, { rolling = skate }) },
  { "rolling and a force", "gauss(4)", along, system(3, bowl, { rolling = skate, force = drag }) },
  { "rolling with reactions of another kind", "gauss(4)", along, system(3, bowl,
    { rolling = skate, reaction = function(q) return { { -0.5 * q[2], 0.2, 1 } } end }) },
  { "rolling, nonlinear", "gauss(4)", { q = { 0, 0, 0 }, v = { 0.6, 0, 0.8 } }, system(3, hill,
    { rolling = function(q, v) return v:dot(v) - 1 end }) },
  { "constraint, rolling and a force", "gauss(4)", { q = { 0.3, 1, 0.2, 0.105 }, v = { 0.7, 0.4, 0.7, 0.444 } }, system(4,
    function(q, v) return bowl(q, v) - 0.5 * q[4] end,
    { constraint = function(q) return q[4] - q[1] ^ 2 / 2 - 0.3 * q[2] * q[3] end, rolling = skate, force = drag }) },
}
local function final(system, rule, start, n)
  local path = system:solver { rule = rule, h = 2 / n }:run { q = start.q, v = start.v, steps = n, every = n }
  return path.q[2], path.p[2], path
end
for _, row in ipairs(problems) do
  local name, rule, start, s = table.unpack(row)
  local q, p = final(s, rule, start, rule == "rk8" and 400 or 200)
  for _, method in ipairs { { "curve(euler)", 1, 160 }, { "curve(heun)", 2, 80 }, { "curve(kutta3)", 3, 80 }, { "curve(rk4)", 4, 40 },
    { "curve(butcher6)", 6, 14 }, { "curve(euler, 0.5)", 2, 40 }, { "curve(kutta3, 0.5)", 4, 20 }, { "curve(rk4, 0.3)", 4, 40 } } do
    local q1, p1 = final(s, method[1], start, method[3])
    local q2, p2, path = final(s, method[1], start, 2 * method[3])
    local a, b = (q1 - q):norm() + (p1 - p):norm(), (q2 - q):norm() + (p2 - p):norm()
    near(log(a / b, 2), method[2], 0.3, ("%s: %s has order %d"):format(name, method[1], method[2]))
    local g = s.given.constraint and s.given.constraint(path.q[2], 2) or 0
    ok(abs(g) < 3e-15, "  and holds the constraint", g)
  end
end

-- closed forms: the damped oscillator, a rolling disk (Bloch 2003, 1.4) whose path is a circle
local c = 0.3
local oscillator = system(1, function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end, { force = function(q, v) return { -c * v[1] } end })
local function damped(t)
  local w = sqrt(1 - c ^ 2 / 4)
  return exp(-c * t / 2) * (cos(w * t) + c / 2 / w * sin(w * t))
end
for _, row in ipairs { { "rk4", 4, 20 }, { "butcher6", 6, 24 }, { "dop853", 8, 3 } } do
  local function off(n) return abs(final(oscillator, dm.curve(row[1]), { q = { 1 }, v = { 0 } }, n)[1] - damped(2)) end
  near(log(off(row[3]) / off(2 * row[3]), 2), row[2], 0.4, row[1] .. " on the damped oscillator: order " .. row[2])
end
local disk = system(4, function(q, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 + v[3] ^ 2 / 4 + v[4] ^ 2 / 8 end, { rolling = function(q, v)
  return { v[1] - cos(q[4]) * v[3], v[2] - sin(q[4]) * v[3] }
end })
local function circle(h)
  local path = disk:solver { rule = "curve(rk4)", h = h }:run { q = { 0, -2, 0, 0 }, v = { 1, 0, 1, 0.5 }, t = 20 }
  local off, slip = 0, 0
  for i = 1, #path do
    local t, q, p = path.t[i], path.q[i], path.p[i]
    off = max(off, abs(q[1] - 2 * sin(t / 2)), abs(q[2] + 2 * cos(t / 2)), abs(q[3] - t), abs(q[4] - t / 2))
    slip = max(slip, abs(p[1] - cos(q[4]) * 2 * p[3]), abs(p[2] - sin(q[4]) * 2 * p[3]))
  end
  return off, slip
end
local off, slip = circle(0.02)
near(log(circle(0.04) / off, 2), 4, 0.1, "a rolling disk runs on its circle, to order 4")
ok(slip < 1e-14, "without slipping", slip)

-- structure: symplectic on T* of the constraint, momentum to round-off, no drift; the forced law of Noether
local bob = system(3, function(q, v) return v:dot(v) / 2 - q[3] end, { constraint = sphere })
local turn = dm.action { group = dm.SO(2), on = dm.R(3), map = function(s, q)
  return { cos(s) * q[1] - sin(s) * q[2], sin(s) * q[1] + cos(s) * q[2], q[3] }
end }
for _, rule in ipairs { "curve(rk4)", "curve(kutta3, 0.5)", "curve(heun)" } do
  local solver = bob:solver { rule = rule, h = 0.05 }
  ok(solver:symplecticity { q = down.q, v = down.v, steps = 20 } < 1e-14, rule .. " is symplectic on a sphere")
  local path = solver:run { q = down.q, v = down.v, steps = 20000, every = 10 }
  ok(path:drift(path:momentum(turn)).largest < 5e-14, "  keeps the momentum", path:drift(path:momentum(turn)).largest)
  ok(abs(path:drift "energy".per_time) < 1e-8, "  and the energy without drift", path:drift "energy".per_time)
end
-- a torque of constant size about the axis adds its work to the momentum: J grows by exactly T a unit of time
local swung = system(3, function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end, { force = function(q)
  local r2 = q[1] ^ 2 + q[2] ^ 2
  return { -0.1 * q[2] / r2, 0.1 * q[1] / r2, 0 }
end })
for _, rule in ipairs { "curve(heun)", "curve(rk4)", "curve(kutta3, 0.5)" } do
  local path = swung:solver { rule = rule, h = 0.1 }:run { q = { 1, 0, 0.2 }, v = { 0, 1, 0 }, steps = 300 }
  local J, worst = path:momentum(turn), 0
  for i = 1, #J do worst = max(worst, abs(J[i] - 1 - 0.1 * path.t[i])) end
  ok(worst < 2e-13, rule .. ": a torque adds to the momentum what it is", worst)
end
-- the nonholonomic momentum of the free skate, q3' = q2 q1', is v1 sqrt(1 + q2^2): kept by the flow, to the order of the method here
local free = system(3, function(q, v) return v:dot(v) / 2 end, { rolling = skate })
local function kept(h)
  local path = free:solver { rule = "curve(rk4)", h = h }:run { q = along.q, v = along.v, t = 4 }
  local first, worst
  for i = 1, #path do
    local J = path.p[i][1] * sqrt(1 + path.q[i][2] ^ 2)
    first = first or J
    worst = max(worst or 0, abs(J - first))
  end
  return worst
end
near(log(kept(0.1) / kept(0.05), 2), 4, 0.4, "the nonholonomic momentum is kept to the order of the method")

-- controls are held over a step
local held = system(1, function(q, v) return v[1] ^ 2 / 2 end, { control = function(q, v, t) return sin(t) end,
  force = function(q, v, t, u) return { u[1] } end })
local path = held:solver { rule = "curve(rk4)", h = 0.25 }:run { q = { 0 }, v = { 0 }, steps = 8 }
local v = 0
for k = 0, 7 do v = v + 0.25 * sin(k / 4) end
near(path.p[9][1], v, 1e-15, "a control is held over a step")

-- bits: backends, checkpoints, ensembles; impulses
for _, row in ipairs(problems) do
  local name, _, start, s = table.unpack(row)
  local rule = dm.curve("kutta3", { bias = 0.5 })
  local ends = {}
  for i, backend in ipairs { "tape", "jit" } do
    local path = s:solver { rule = rule, h = 0.05, backend = backend }:run { q = start.q, v = start.v, steps = 60, every = 60 }
    ends[i] = ("%a %a %a"):format(path.q[2][1], path.q[2][2], path.p[2][2])
  end
  ok(ends[1] == ends[2], name .. ": tape and native code give the same bits", ends[1])
  local solver, file = s:solver { rule = rule, h = 0.05 }, os.tmpname()
  local whole = solver:run { q = start.q, v = start.v, steps = 60, every = 60 }
  solver:run { q = start.q, v = start.v, steps = 37, every = 37 }:checkpoint(file)
  local rest = dm.resume(file, s):run { steps = 23, every = 23 }
  os.remove(file)
  ok(rest.q[#rest] == whole.q[2] and rest.p[#rest] == whole.p[2], "  a restart goes on bit for bit")
  local members = solver:ensemble { members = 3, q = function() return start.q end, v = function() return start.v end, steps = 60, threads = 2 }
  ok(members.q[2] == whole.q[2] and members.p[3] == whole.p[2], "  members of an ensemble are runs of their own")
end
local one = bob:solver { rule = "curve(rk4)", h = 0.05 }:run { q = down.q, v = down.v, steps = 40, record = { "impulses" } }
local other = bob:solver { rule = "rattle", h = 0.05 }:run { q = down.q, v = down.v, steps = 40, record = { "impulses" } }
local worst = 0
for i = 2, 40 do worst = max(worst, abs(one:column "impulse"[i] - other:column "impulse"[i])) end
ok(worst < 1e-4, "impulses are those of rattle, to its order", worst)

-- bundles: the one-form of a system with a force is that of the step
local bundle = dm.bundle { system = oscillator, h = 0.1, segments = "rk4" }
local q, element = { 0.7 }, { -0.4 }
local p0, p1 = bundle:momenta(q, element)
local Q, P = oscillator:solver({ rule = dm.curve "rk4", h = 0.1 }):step { q = q, p = p0 }
near(Q[1], bundle:plus(q, element)[1], 1e-14, "the step of a bundle with a force ends where its segment does")
near(P[1], p1[1], 1e-14, "with its momentum")
tap.done()
