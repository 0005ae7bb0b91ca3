-- Discrete forces, rolling constraints and constraints of an Ld that is reduced: its steps are
-- those of the unreduced Ld (Leok 2.8.2-2.8.3), and what the group does not spare is refused.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, sqrt, max = dm.sin, dm.cos, dm.sqrt, math.max
local h = 0.05

-- midpoint Ld of a system
local function midpoint(system)
  return function(a, b, k) return k * system.L((a + b) / 2, (b - a) / k, 0) end
end
-- friction of functions I_j(q) of the shape alone: F = -c (I_j(q1) - I_j(q0)) dI_j / 2 at either end
local function friction(n, c, list)
  local slopes = {}
  for j, I in ipairs(list) do slopes[j] = dm.derivative(I, n) end
  return function(a, b)
    local F1, F2 = 0 * a, 0 * b
    for j, I in ipairs(list) do
      local rate = -c / 2 * (I(b) - I(a))
      F1, F2 = F1 + rate * slopes[j](a), F2 + rate * slopes[j](b)
    end
    return { F1, F2 }
  end
end

-- A blade in the plane of the invariants x, y, z: z' = y x', at the middle of a step, with the row at
-- q0. The last one has both ends in it.
local function blade(n, x, y, z)
  local dx, dz = dm.derivative(x, n), dm.derivative(z, n)
  return function(a, b, k) return ((z(b) - z(a)) - (y(a) + y(b)) / 2 * (x(b) - x(a))) / k end,
    function(a, b) return { dz(a) - (2 * y(a) + y(b)) / 3 * dx(a) } end
end

-- path of the solver against the unreduced one, to 1e-11 over 1000 steps
local function compare(name, system, how, q, v, more)
  local given = { Q = system.Q, h = h, Ld = midpoint(system), constraint = system.given.constraint }
  for key, value in pairs(more) do given[key] = value end
  local Ld = dm.discrete_lagrangian(given)
  how.q, how.v = q, v
  local shape = system:routh(how)
  local D = shape:discrete(Ld)
  local x, u, theta = shape:start(q, v)
  local p = system:momentum(q, v)
  local full = Ld:solver {}:run { q = q, p = p, steps = 1000 }
  local start = { q = x, p = shape:momentum(x, u), steps = 1000 }
  local path = D:solver {}:run(start)
  local back = path:reconstruct { theta = theta }
  local worst, moved = 0, 0
  for k = 1, #full do
    worst = max(worst, (back.q[k] - full.q[k]):norm(), (back.p[k] - full.p[k]):norm())
    moved = max(moved, (full.q[k] - full.q[1]):norm())
  end
  ok(#path == 1001 and worst < 1e-11, name .. ": reduced is unreduced", worst)
  ok(moved > 0.1, name .. ": and moves", moved)
  -- without what acts it goes elsewhere
  local bare = { Q = system.Q, h = h, Ld = given.Ld, constraint = given.constraint }
  local free = dm.discrete_lagrangian(bare):solver {}:run { q = q, p = p, steps = 1000 }
  ok((free.q[1001] - full.q[1001]):norm() > 1e-3, name .. ": what acts is felt")
  return { D = D, path = path, start = start, Ld = Ld, full = full, theta = theta }
end

---- forces ----

local rotor = dm.system { Q = dm.R(3), coordinates = { "theta", "r", "z" }, L = function(q, v)
  return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / sqrt(q[2] ^ 2 + q[3] ^ 2)
end }
local drag = compare("a satellite with drag along r and z", rotor, { cyclic = "theta" },
  { 0.2, 1, 0.1 }, { 0.9, 0.1, 0.3 }, { force = function(a, b, k, params)
    local f = -params.c / 2 * (b - a)
    return { { 0, f[2], f[3] }, { 0, f[2] * a[2], f[3] } }
  end, params = { c = 0.02 } })

local pair = dm.system { Q = dm.R(4), L = function(q, v)
  local x, y = q[3] - q[1], q[4] - q[2]
  return (v[1] ^ 2 + v[2] ^ 2) / 2 + v[3] ^ 2 + v[4] ^ 2 - (q[1] ^ 2 + q[2] ^ 2) / 2
    - 0.4 * (x * x + y * y)
end }
local function turn(t, q)
  local c, s = cos(t), sin(t)
  local out = { c * q[1] - s * q[2], s * q[1] + c * q[2], c * q[3] - s * q[4], s * q[3] + c * q[4] }
  return { table.unpack(out, 1, #q) }
end
local function apart(q) return sqrt((q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2) end
local function out(q) return q[1] ^ 2 + q[2] ^ 2 end
local function along(x) return { x[1], 0, x[2], x[3] } end
local joints = compare("friction between two particles in the plane", pair,
  { action = turn, section = along }, { 0.9, 0.1, -0.4, 0.7 }, { 0.2, 0.6, -0.5, 0.3 },
  { force = friction(4, 0.1, { apart, out }) })

local function both(t, q)
  local c1, s1, c2, s2 = cos(t[1]), sin(t[1]), cos(t[2]), sin(t[2])
  return { c1 * q[1] - s1 * q[2], s1 * q[1] + c1 * q[2], c2 * q[3] - s2 * q[4],
    s2 * q[3] + c2 * q[4] }
end
local torus = dm.system { Q = dm.R(4), L = function(q, v)
  local r, s = out(q), q[3] ^ 2 + q[4] ^ 2
  return v:dot(v) / 2 - r - s / 2 - 0.3 * r * s
end }
compare("two turns", torus, { action = both, dimension = 2,
  section = function(z) return { z[1], 0, 0, z[2] } end }, { 0.8, 0.3, -0.2, 1.1 },
  { -0.4, 0.9, 0.7, 0.2 }, { force = friction(4, 0.05, { out,
    function(q) return q[3] ^ 2 + q[4] ^ 2 end }) })

---- constraints, rolling constraints, all together ----

local bowl = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end,
  constraint = function(q) return q[3] - (q[1] ^ 2 + q[2] ^ 2) / 2 end }
local function upright(x) return { x[1], 0, x[2] } end
local function spin(t, q) return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2], q[3] } end
compare("a bead in a bowl, with friction", bowl, { action = spin, section = upright },
  { 0.8, 0.3, 0.365 }, { -0.2, 0.9, 0.11 }, { constraint = bowl.given.constraint,
    force = friction(3, 0.05, { function(q) return q[3] end }) })

local top = dm.system { Q = dm.R(4), coordinates = { "theta", "x", "y", "z" }, L = function(q, v)
  return (v[2] ^ 2 + v[3] ^ 2 + v[4] ^ 2) / 2 + (1 + q[2] ^ 2) * (v[1] + 0.3 * q[3] * v[2]) ^ 2 / 2
    - q[2] ^ 2 / 2 - 0.3 * q[3] ^ 2 - 0.1 * q[4] ^ 2
end }
local function c(i) return function(q) return q[i] end end
local phi, E = blade(4, c(2), c(3), c(4))
local rolls = compare("a blade with a rotor", top, { cyclic = "theta" }, { 0.1, 0.3, 1, 0.2 },
  { 0.5, 0.7, 0.2, 0.7 }, { rolling = phi, reaction = E })

local cloud = dm.system { Q = dm.R(4), L = function(q, v)
  return pair.L(q, v, 0) - 0.2 * (q[3] ^ 2 + q[4] ^ 2) ^ 2
end, constraint = function(q) return q[3] ^ 2 + q[4] ^ 2 - 1 end }
phi, E = blade(4, out, function(q) return q[1] * q[3] + q[2] * q[4] end, apart)
local all = compare("rolling, a constraint and friction in the plane", cloud,
  { action = turn, section = function(x) return { x[2], x[3], x[1], 0 } end },
  { 0.9, 0.1, 0.6, 0.8 }, { 0.2, 0.6, -0.4, 0.3 },
  { constraint = cloud.given.constraint, rolling = phi, reaction = E, force = friction(4, 0.05, { out }) })

-- impulses are those of the unreduced equations
local record = { "impulses" }
local given = all.start
given.record = record
local one = all.D:solver {}:run(given)
local other = all.Ld:solver {}:run { q = { 0.9, 0.1, 0.6, 0.8 },
  p = cloud:momentum({ 0.9, 0.1, 0.6, 0.8 }, { 0.2, 0.6, -0.4, 0.3 }), steps = 1000, record = record }
local worst = 0
for k = 1, 1001 do worst = max(worst, (one.impulses[k] - other.impulses[k]):norm()) end
ok(worst < 1e-10, "impulses of both kinds of constraints", worst)
ok(one:worst "rolling" < 1e-12 and one:worst "constraint" < 1e-12, "which hold along the reduced path")

---- the equations, members, checkpoints, two positions ----

for name, r in pairs { drag = drag, joints = joints } do
  local a, b, d = r.path.q[20]:copy(), r.path.q[21]:copy(), r.path.q[22]:copy()
  for _, kind in ipairs { "literal", "direct" } do
    local left = r.D:residual(a, b, d, kind):norm()
    ok(left < 1e-12, name .. ": the forced discrete Routh equations, " .. kind, left)
  end
  local x2, psi = r.D:step(a, b)
  ok((x2 - d):norm() < 1e-12 and (psi - r.D:psi(b, d)):norm() < 1e-12, name .. ": D:step")
  local W = r.path.system
  ok((W:legendre_plus(a, b) - r.path.p[21]):norm() < 1e-12
    and (W:legendre_minus(a, b) - r.path.p[20]):norm() < 1e-12, name .. ": momenta have the forces")
  local two = r.D:solver {}:run { q0 = r.path.q[1], q1 = r.path.q[2], steps = 100 }
  ok((two.q[101] - r.path.q[101]):norm() < 1e-11, name .. ": from two positions")
end
local file = os.tmpname()
for name, r in pairs { drag = drag, rolls = rolls, all = all } do
  local solver = r.D:solver {}
  local many = solver:ensemble { members = 3, steps = 60, q = function() return r.start.q end,
    p = function(i) return i == 2 and r.start.p or 0.9 * r.start.p end }
  ok(many.q:row(2) == r.path.q[61], name .. ": a member has the bits of a run")
  solver:run({ q = r.start.q, p = r.start.p, steps = 25 }):checkpoint(file)
  ok(dm.resume(file, r.path.system):run({ steps = 35 }).q[36] == r.path.q[61], name .. ": a checkpoint goes on")
end
os.remove(file)
-- a checkpoint with one force is none with another
drag.D:solver {}:run({ q = drag.start.q, p = drag.start.p, steps = 5 }):checkpoint(file)
local more = rotor:routh({ cyclic = "theta", mu = drag.D.info.mu }):discrete(dm.discrete_lagrangian {
  Q = dm.R(3), h = h, Ld = midpoint(rotor), force = function(a, b)
    local f = -0.011 * (b - a)
    return { { 0, f[2], f[3] }, { 0, f[2] * a[2], f[3] } }
  end })
raises("the sum of force was", function() dm.resume(file, more:solver {}.system):run { steps = 1 } end)
os.remove(file)

---- a system that has the force, too ----

local function air(q, v) return { 0, -0.01 * (1 + q[2]) * v[2], -0.02 * v[3] } end
local slowed = dm.system { Q = dm.R(3), coordinates = rotor.coordinates, L = rotor.L, force = air }
local shape = slowed:routh { cyclic = "theta", mu = drag.D.info.mu }
local path = shape:discrete(drag.Ld):solver {}:run(drag.start)
ok(path.q[1001] == drag.path.q[1001], "a system with the force of its Ld")
raises("the force of this Ld is not that of its system", shape.discrete, shape, dm.discrete_lagrangian {
  Q = dm.R(3), h = h, Ld = midpoint(rotor), force = function(a, b)
    local f = -0.03 / 2 * (b - a)
    return { { 0, f[2], f[3] }, { 0, f[2], f[3] } }
  end })
ok(shape:discrete(dm.discrete_lagrangian { Q = dm.R(3), h = h, Ld = midpoint(rotor), force = function(a, b)
  local f = h / 2 * dm.vector(air(a, (b - a) / h)) -- which knows one h
  return { f, f }
end }), "nor is one refused that knows its h")
raises("this system has a force", shape.discrete, shape,
  dm.discrete_lagrangian { Q = dm.R(3), h = h, Ld = midpoint(rotor) })

---- what the group does not spare ----

local function refused(words, system, how, given)
  given.Q, given.h, given.Ld = system.Q, h, midpoint(system)
  how.mu = how.mu or 0.5
  local shape = system:routh(how)
  raises(words, shape.discrete, shape, dm.discrete_lagrangian(given))
end
local polar, plane = { cyclic = "theta" }, { action = turn, section = along }
refused("F1 of this Ld has a component along the group: it pushes 'theta'", rotor, polar, {
  force = function(a, b) return { a - b, 0 * b } end })
refused("F2 of this Ld has a component along the group: it pushes 'theta'", rotor, polar, {
  force = function(a, b) return { { 0, 0, 0 }, { 1e-3, 0, 0 } } end })
refused("F1 of this Ld is not invariant: entry 2", rotor, polar, {
  force = function(a, b) return { { 0, 0.1 * sin(a[1]) ^ 2, 0 }, { 0, 0, 0 } } end })
refused("along the group", pair, plane, { -- in the air, which turns with nobody
  force = function(a, b) local f = 0.05 * (a - b) return { f, f } end })
refused("is not invariant", pair, plane, { force = function(a, b)
  local f = friction(4, 0.1 , { apart })(a, b)
  return { (1 + a[1]) * f[1], f[2] }
end })
refused("row 1 of 'reaction' of this Ld has a component along the group: it pulls 'theta'", top, polar, {
  rolling = function(a, b, k) return (b[4] - a[4] - a[3] * (b[1] - a[1])) / k end,
  reaction = function(a) return { { -a[3], 0, 0, 1 } } end })
refused("'rolling' of this Ld is not invariant", top, polar, {
  rolling = function(a, b, k) return (b[4] - a[4] - cos(a[1]) * (b[2] - a[2])) / k end,
  reaction = function(a) return { { 0, -a[3], 0, 1 } } end })
refused("row 1 of 'reaction' of this Ld is not invariant", top, polar, {
  rolling = function(a, b, k) return (b[4] - a[4] - a[3] * (b[2] - a[2])) / k end,
  reaction = function(a) return { { 0, -cos(a[1]), 0, 1 } } end })
tap.done()
