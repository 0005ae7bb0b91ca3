-- A map beside Ld is compared with Ld, with its forces, reactions and constraints; a checkpoint is
-- of all functions of its system.
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos = math.sin, math.cos

local h, c = 0.1, 0.3
local function trapezoid(a, b, h)
  local v = (b - a) / h
  return h * (v:dot(v) / 2 - (a:dot(a) + b:dot(b)) / 4)
end
local function verlet(q, p)
  local b = q + h * (p - h / 2 * q)
  return { b[1], p[1] - h / 2 * (q[1] + b[1]) }
end
local function Ld(more)
  local options = { Q = dm.R(1), h = h, Ld = trapezoid, map = verlet }
  for key, value in pairs(more) do options[key] = value end
  return dm.discrete_lagrangian(options)
end
local function start(more)
  local options = { q = { 1 }, p = { 0.2 }, steps = 50 }
  for key, value in pairs(more or {}) do options[key] = value end
  return options
end

-- what is right is taken, and steps as "del" does
local path, other = Ld {}:solver {}:run(start()), Ld {}:solver { rule = "del" }:run(start())
near(path.q[51][1], other.q[51][1], 1e-13, "a right map steps as Ld does")

-- what is wrong is refused where it is made: at other momenta, at other points, by a little
for name, wrong in pairs {
  ["of a stiffer spring"] = function(q, p)
    local b = q + h * (p - h / 2 * 1.01 * q)
    return { b[1], p[1] - h / 2 * 1.01 * (q[1] + b[1]) }
  end,
  ["of another step"] = function(q, p)
    local b = q + 0.11 * (p - 0.11 / 2 * q)
    return { b[1], p[1] - 0.11 / 2 * (q[1] + b[1]) }
  end,
  ["symplectic Euler"] = function(q, p)
    local p1 = p - h * q
    return { (q + h * p1)[1], p1[1] }
  end,
  ["p1 alone"] = function(q, p) return { verlet(q, p)[1], p[1] - h * q[1] } end,
} do
  raises("map is not the step of this Ld", Ld, { map = wrong, name = name })
end
raises("entry 2", dm.discrete_lagrangian, { Q = dm.R(2), h = h, Ld = trapezoid, map = function(q, p)
  local b = q + h * (p - h / 2 * q)
  local e = p - h / 2 * (q + b)
  return { b[1], b[2], e[1], e[2] + 1e-5 * q[1] }
end })

-- what is wrong far away only is refused by the run that starts there, and by its ensemble
local far = Ld { map = function(q, p)
  local out = verlet(q, p)
  return { out[1], out[2] + dm.max(0, q[1] - 3) }
end }
ok(#far:solver {}:run(start()) == 51, "a run from where the map is right")
raises("from q0 = {4.0}", function() far:solver {}:run(start { q = { 4 } }) end)
raises("from q0 = {5.0}", function()
  far:solver {}:ensemble { members = 3, q = { { 1 }, { 5 }, { 1 } }, p = { { 0 }, { 0 }, { 0 } }, steps = 2 }
end)
raises("from q0 = {4.0}", function() far:solver {}:run { q0 = { 4 }, q1 = { 4.1 }, steps = 3 } end)

-- a step h of 1e-5, where q1 - q0 has few digits, is no reason
local tiny = 1e-5
ok(dm.discrete_lagrangian { Q = dm.R(1), h = tiny, Ld = trapezoid, map = function(q, p)
  local b = q + tiny * (p - tiny / 2 * q)
  return { b[1], p[1] - tiny / 2 * (q[1] + b[1]) }
end }, "round-off of q1 is no contradiction")

-- a force beside a map: the map has it, or is refused
local function drag(a, b)
  local f = -c / 2 * (b - a)
  return { f, f }
end
raises("map is not the step of this Ld", Ld, { force = drag })
local forced = Ld { force = drag, map = function(q, p)
  local b = (p[1] + q[1] / h - h / 2 * q[1] + c / 2 * q[1]) / (1 / h + c / 2)
  return { b, (b - q[1]) / h - h / 2 * b - c / 2 * (b - q[1]) }
end }
near(forced:solver {}:run(start()).q[51][1], forced:solver { rule = "del" }:run(start()).q[51][1], 1e-13,
  "a map with the force of its Ld")

-- a constraint, and a rolling constraint, with their impulses: a bead on the line y = x, a blade
-- along x + y = const
local function free(a, b, h) return (b - a):dot(b - a) / 2 / h end
local function along(sign) -- p along (1, sign) is kept, the rest taken up: lambda or mu
  return function(q, p)
    local s = (p[1] + sign * p[2]) / 2
    local lambda = p[1] - s
    return { q[1] + h * s, q[2] + sign * h * s, s, sign * s, -lambda }
  end
end
local function bead(map)
  return dm.discrete_lagrangian { Q = dm.R(2), h = h, Ld = free, constraint = function(q) return q[1] - q[2] end, map = map }
end
local function blade(map)
  return dm.discrete_lagrangian { Q = dm.R(2), h = h, Ld = free,
    rolling = function(a, b, h) return (b[1] + b[2] - a[1] - a[2]) / h end,
    reaction = function() return { { 1, 1 } } end, map = map }
end
for name, made in pairs { bead = bead(along(1)), blade = blade(along(-1)) } do
  local from = { q = { 0.2, 0.2 }, p = { 0.7, 0.1 }, steps = 5, record = { "impulses" } }
  local a, b = made:solver {}:run(from), made:solver { rule = "del" }:run(from)
  ok((a.q[6] - b.q[6]):norm() < 1e-14 and (a.impulses[1] - b.impulses[1]):norm() < 1e-13,
    name .. ": a map with its impulses")
end
raises("map is not the step of this Ld", bead, along(-1))
raises("map is not the step of this Ld", blade, along(1))
raises("and an impulse for each constraint, got 4", blade, function(q, p) return { q[1], q[2], p[1], p[2] } end)
-- g(q1) is looked at, too
raises("g(q1) is", bead, function(q, p) -- a free step: no impulse, off the line
  return { q[1] + h * p[1], q[2] + h * p[2], p[1], p[2], 0 }
end)

---- checkpoints: every function of the system is looked at ----

local file = os.tmpname()
local skate = { Q = dm.R(3), h = h, Ld = function(a, b, h, k)
  local v, q = (b - a) / h, (a + b) / 2
  return h * (v:dot(v) / 2 - 0.1 * q[2] ^ 2)
end, rolling = function(a, b, h)
  local m = (a[3] + b[3]) / 2
  return { (-sin(m) * (b[1] - a[1]) + cos(m) * (b[2] - a[2])) / h }
end, reaction = function(a, b) return { { -sin(a[3]), cos(a[3]), 0 } } end,
  force = function(a, b) local f = -0.02 * (b - a) return { f, f } end }
local function with(base, key, f)
  local out = {}
  for k, v in pairs(base) do out[k] = v end
  out[key] = f
  return out
end
local whole = dm.discrete_lagrangian(skate):solver {}
local from = { q = { 0, 0, 0.2 }, p = { 1, 0.2, 0.6 }, steps = 20 }
whole:run(from):checkpoint(file)
from.steps = 30
ok(dm.resume(file, dm.discrete_lagrangian(skate)):run { steps = 10 }.q[11] == whole:run(from).q[31], "goes on bit for bit")
for key, f in pairs {
  force = function(a, b) local f = -0.0200001 * (b - a) return { f, f } end,
  rolling = function(a, b, h) return { (-sin(a[3]) * (b[1] - a[1]) + cos(a[3]) * (b[2] - a[2])) / h } end,
  reaction = function(a, b) return { { -sin(b[3]), cos(b[3]), 0 } } end,
  Ld = function(a, b, h) return h * ((b - a):dot(b - a) / h ^ 2 / 2 - 0.1 * ((a[2] + b[2]) / 2) ^ 3) end,
} do
  raises(key == "Ld" and "state Ld was" or "the sum of " .. key .. " was", function() dm.resume(file, dm.discrete_lagrangian(with(skate, key, f))):run { steps = 1 } end)
end
raises("it has no 'force'", function() dm.resume(file, dm.discrete_lagrangian(with(skate, "force", nil))):run { steps = 1 } end)
raises("it has a 'constraint'", function()
  dm.resume(file, dm.discrete_lagrangian(with(skate, "constraint", function(q) return q[1] - q[2] end))):run { steps = 1 }
end)
-- of a map, and from the path itself
local half = Ld {}:solver {}:run(start())
half:checkpoint(file)
local fine = pcall(function() dm.resume(file, Ld {}):run { steps = 1 } end)
ok(fine, "the same map goes on")
raises("brings with it as map =", function() dm.resume(half, dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = trapezoid }):run { steps = 1 } end)
-- of dm.system: force, control, constraint
local L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end
local system = { Q = dm.R(2), L = L, force = function(q, v, t, u) return -0.1 * v + u[1] * q end,
  control = function(q, v) return { 0.1 * q[1] } end, constraint = function(q) return q[1] - q[2] end }
path = dm.system(system):solver { rule = "midpoint", h = 0.01 }:run { q = { 1, 1 }, v = { 0, 0 }, steps = 10 }
path:checkpoint(file)
ok(pcall(function() dm.resume(file, dm.system(system)):run { steps = 1 } end), "a system with control, force and constraint")
for key, f in pairs { force = function(q, v, t, u) return -0.2 * v + u[1] * q end,
  control = function(q, v) return { 0.1 * q[2] } end, constraint = function(q) return 2 * (q[1] - q[2]) end } do
  raises("the sum of " .. key .. " was", function() dm.resume(file, dm.system(with(system, key, f))):run { steps = 1 } end)
end
os.remove(file)
tap.done()
