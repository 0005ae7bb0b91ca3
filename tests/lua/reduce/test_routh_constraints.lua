-- Routh reduction with constraints and forces: the same equations reduced and unreduced, momenta kept or lost by law (spec 1.10 - 1.12)
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sin, cos = math.abs, math.sin, math.cos
local m1, m2, l1, l2, g = models.m1, models.m2, models.l1, models.l2, models.g

-- double spherical pendulum in cylinder coordinates with its rods as constraints, friction in the joint
local function rods(friction)
  return dm.system { Q = dm.R(6), coordinates = { "theta", "r1", "z1", "r2", "z2", "phi" }, L = function(q, v)
    local r1, r2, phi = q[2], q[4], q[6]
    local t1, t2, c, s = v[1], v[1] + v[6], cos(phi), sin(phi)
    local T1 = v[2] ^ 2 + r1 ^ 2 * t1 ^ 2 + v[3] ^ 2
    local T2 = v[2] ^ 2 + r1 ^ 2 * t1 ^ 2 + v[4] ^ 2 + r2 ^ 2 * t2 ^ 2 + 2 * (v[2] * v[4] + r1 * r2 * t1 * t2) * c
      + 2 * (r1 * v[4] * t1 - r2 * v[2] * t2) * s + (v[3] + v[5]) ^ 2
    return m1 * T1 / 2 + m2 * T2 / 2 - m1 * g * q[3] - m2 * g * (q[3] + q[5])
  end, constraint = function(q) return { (q[2] ^ 2 + q[3] ^ 2 - l1 ^ 2) / 2, (q[4] ^ 2 + q[5] ^ 2 - l2 ^ 2) / 2 } end,
    force = friction and function(_, v) return { 0, 0, 0, 0, 0, -friction * v[6] } end }
end
local s = models.near_pole
local q = { 0, 0.6, -0.8, 0.45, -0.6, s.q[4] }
local v = { s.v[1], s.v[2], 0.6 * s.v[2] / 0.8, s.v[3], 0.45 * s.v[3] / 0.6, s.v[4] }

-- 3.11 (Cartesian and with multipliers: test_discrete_ties), 3.12: constraints, with and without a force, every kind of stage rule with its inner multipliers
for name, friction in pairs { ["rods"] = false, ["rods and friction"] = 0.2 } do
  local full = rods(friction or nil)
  local shape = full:routh { q = q, v = v }
  local x, u = shape:start(q, v)
  for _, rule in ipairs { "gauss(1)", "gauss(2)", "lobatto(2)", "lobatto(3)" } do
    local a = full:solver({ rule = rule, h = 0.01 }):run { q = q, v = v, steps = 100 }
    local b = shape:solver({ rule = rule, h = 0.01 }):run { q = x, v = u, steps = 100 }
    local apart = dm.compare(a, b:reconstruct())
    ok(apart.worst < 2e-12, name .. ", " .. rule .. ": reduced and back = unreduced, positions and momenta", tostring(apart))
    ok(b:worst "constraint" < 1e-15, "constraints hold", b:worst "constraint")
    ok(abs(a:column("p_theta")[101] - a:column("p_theta")[1]) < 3e-13, "the momentum is kept above", a:drift "p_theta".largest)
  end
end

-- the chart and the constrained form agree as the step goes to zero, with order 4
local function last(system, start, rule, h)
  local x, u = system:start(start.q, start.v)
  local p = system:solver({ rule = rule, h = h }):run { q = x, v = u, steps = math.floor(0.4 / h + 0.5) }
  return p.q[#p]
end
local tied, chart = rods():routh { q = q, v = v }, models.pendulum():routh { cyclic = { 1 }, q = s.q, v = s.v }
local gaps = {}
for i, h in ipairs { 0.02, 0.01 } do
  local a, b = last(tied, { q = q, v = v }, "gauss(2)", h), last(chart, s, "gauss(2)", h)
  gaps[i] = math.max(abs(a[1] - b[1]), abs(a[3] - b[2]), abs(a[5] - b[3]))
end
near(math.log(gaps[1] / gaps[2], 2), 4, 0.3, "multipliers and chart approach each other with order 4")

-- friction in the joint: energy falls, and the rods end as one rigid body in rotation
local damped = rods(2):routh { q = q, v = v }
local x, u = damped:start(q, v)
local fall = damped:solver({ rule = "gauss(1)", h = 0.05 }):run { q = x, v = u, steps = 2000, every = 20 }
local E, rising = fall:energy(), 0
for i = 2, #E do rising = math.max(rising, E[i] - E[i - 1]) end
ok(rising < 1e-3 and E[#E] < E[1] - 0.5, "friction takes energy", rising)
near(fall:velocity()[#fall][5], 0, 0.05, "until the rods turn nearly together")

-- drag on the shape of an orbit: reducible
local function satellite(force)
  local given = models.satellite(0.05)
  return dm.system { Q = dm.R(3), coordinates = given.coordinates, L = given.L, force = force }
end
local dragged = satellite(function(_, w) return { 0, -0.01 * w[2], -0.01 * w[3] } end)
local kept = dragged:routh { cyclic = { "theta" }, mu = 0.96 }
for _, rule in ipairs { "gauss(1)", "gauss(2)", "lobatto(3)" } do
  local a = dragged:solver({ rule = rule, h = 0.3 }):run { q = models.orbit.q, v = models.orbit.v, steps = 1000 }
  local b = kept:solver({ rule = rule, h = 0.3 }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = 1000 }:reconstruct()
  ok(dm.compare(a, b).worst < 1e-11, rule .. ": a dragged satellite, 1000 steps", tostring(dm.compare(a, b)))
  ok(b:energy()[1001] < b:energy()[1] - 1e-3, "loses energy", b:energy()[1001])
end

-- 3.13 drag along the group: momentum by the Cayley map of the rate, and no reduction
local gamma, h = 0.01, 0.2
local slowed = satellite(function(p, w) return { -gamma * p[2] ^ 2 * w[1], 0, 0 } end)
local path = slowed:solver({ rule = "gauss(1)", h = h }):run { q = models.orbit.q, v = models.orbit.v, steps = 100 }
near(path:column "p_theta"[101] / (0.96 * ((1 - gamma * h / 2) / (1 + gamma * h / 2)) ^ 100), 1, 1e-13, "momentum under azimuthal drag: closed form")
raises("pushes 'theta'", function() slowed:routh { cyclic = { 1 }, mu = 1 } end)
raises("changes from", function()
  satellite(function(p, w) return { 0, -w[2] * (1 + 0.1 * sin(p[1])), 0 } end):routh { cyclic = { 1 }, mu = 1 }
end)
raises("constraint is not invariant", function()
  dm.system { Q = dm.R(3), L = models.satellite(0).L, constraint = function(p) return p[2] * cos(p[1]) - 1 end }:routh { cyclic = { 1 }, mu = 1 }
end)

-- ambient coordinates: an action on R^6 that the rods and the joint respect
local function turn(t, p)
  local c, r = cos(t), sin(t)
  return { c * p[1] - r * p[2], r * p[1] + c * p[2], p[3], c * p[4] - r * p[5], r * p[4] + c * p[5], p[6] }
end
local ambient = dm.system { Q = dm.R(6), L = function(p, w)
  local a = w[1] ^ 2 + w[2] ^ 2 + w[3] ^ 2
  local b = (w[1] + w[4]) ^ 2 + (w[2] + w[5]) ^ 2 + (w[3] + w[6]) ^ 2
  return m1 * a / 2 + m2 * b / 2 - m1 * g * p[3] - m2 * g * (p[3] + p[6])
end, constraint = function(p)
  return { (p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2 - l1 ^ 2) / 2, (p[4] ^ 2 + p[5] ^ 2 + p[6] ^ 2 - l2 ^ 2) / 2 }
end }
local Q, V = { 0.6, 0, -0.8, 0.27, 0.36, -0.6 }, { 0.4, 1.2, 0.3, -0.64, -0.02, -0.3 }
local plane = ambient:routh { action = turn, q = Q, v = V }
near(plane:reduction().mu[1], 3.1095, 1e-13, "momentum in ambient coordinates")
local y, w = plane:start(Q, V)
local ends = {}
for i, step in ipairs { 0.02, 0.01 } do
  local p = plane:solver({ rule = "gauss(2)", h = step }):run { q = y, v = w, steps = math.floor(0.4 / step + 0.5), project = true }:reconstruct()
  local reference = ambient:solver({ rule = "gauss(2)", h = 0.0025 }):run { q = Q, v = V, steps = 160, project = true }
  ends[i] = (p.q[#p] - reference.q[161]):norm()
end
ok(ends[1] < 1e-3 and math.log(ends[1] / ends[2], 2) > 3.5, "the section with its constraints, lifted, is the unreduced motion to order 4", ends[1])

-- what has no place for ties says so
raises("has constraints", function() tied:discrete { rule = "gauss(1)", h = 0.1 } end)
raises("has a force", function() kept:rsprk { rule = "gauss(1)", h = 0.1 } end)

tap.done()
