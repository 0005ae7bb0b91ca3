-- dm.discrete_lagrangian(system, { rule = }) of a system with a force: p0 and p1 are the momenta of
-- the forced step of the rule (Leok 2.8.2), against its own solver, closed forms and formulas by hand
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, exp, sin, cos = math.abs, math.max, math.exp, math.sin, math.cos

-- a mass that depends on the place, a force that turns and brakes, with params
local function rough(more)
  local given = { Q = dm.R(2), params = { c = 0.3 },
    L = function(q, v) return v:dot(v) / 2 * (1 + q[1] ^ 2) - q:dot(q) / 2 - q[1] ^ 4 / 4 end,
    force = function(q, v, t, p)
      return { -p.c * v[1] + 0.2 * q[2] * v[2], -p.c * v[2] * q[1] ^ 2 - 0.2 * q[1] }
    end }
  for key, value in pairs(more or {}) do given[key] = value end
  return dm.system(given)
end
local RULES = { "midpoint", "trapezoidal", "verlet", "symplectic-euler", "gauss(1)", "gauss(2)", "gauss(3)", "lobatto(3)",
  "galerkin(3, lobatto(4))", "galerkin(2, gauss(3))" }

-- the largest differences of q and p of two paths
local function apart(a, b)
  local worst = 0
  for k = 1, #a do worst = max(worst, (a.q[k] - b.q[k]):norm(), (a.p[k] - b.p[k]):norm()) end
  return worst
end
-- of the momenta of Ld and those of a path
local function momenta(Ld, path)
  local worst = 0
  for k = 1, #path - 1 do
    local t = path.t[k]
    worst = max(worst, (Ld:legendre_minus(path.q[k], path.q[k + 1], t) - path.p[k]):norm(),
      (Ld:legendre_plus(path.q[k], path.q[k + 1], t) - path.p[k + 1]):norm())
  end
  return worst
end

local start = { q = { 0.7, 0.2 }, v = { 0.3, 0.5 }, steps = 20 }
for _, rule in ipairs(RULES) do
  local system = rough()
  local path = system:solver { rule = rule, h = 0.1 }:run(start)
  local Ld = dm.discrete_lagrangian(system, { rule = rule, h = 0.1 })
  near(momenta(Ld, path), 0, 1e-13, rule .. ": p0 and p1 are the momenta of the rule's steps")
  near(apart(dm.solver { Ld }:run { q = path.q[1], p = path.p[1], steps = 20 }, path), 0, 1e-13, rule .. ": so are its steps")
end

-- a force that depends on time; one that returns a vector
local driven = rough { force = function(q, v, t) return { sin(3 * t) * v[2], cos(t) * q[1] } end }
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(2)" } do
  local path = driven:solver { rule = rule, h = 0.1 }:run { q = { 0.7, 0.2 }, v = { 0.3, 0.5 }, t0 = 1, steps = 10 }
  near(momenta(dm.discrete_lagrangian(driven, { rule = rule, h = 0.1 }), path), 0, 1e-13, rule .. ": a force of the time")
end
local entries = rough { force = function(q, v) return { -0.1 * v[1], 0.2 * q[1] } end }
local by_list = rough { force = function(q, v) return dm.vector { -0.1 * v[1], 0.2 * q[1] } end }
local h = 0.1
for _, rule in ipairs { "midpoint", "trapezoidal" } do
  local a, b = dm.discrete_lagrangian(entries, { rule = rule, h = h }), dm.discrete_lagrangian(by_list, { rule = rule, h = h })
  ok(a:legendre_minus({ 0.1, 0.2 }, { 0.3, 0.1 }) == b:legendre_minus({ 0.1, 0.2 }, { 0.3, 0.1 }), rule .. ": a table and a vector")
end

-- by hand, of q'' = -q - c q': L and the force at the nodes of the rule
local c = 0.3
local damped = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end, force = function(q, v) return -c * v[1] end }
local a, b = 0.4, 0.5
local v = (b - a) / h
local middle, ends = dm.discrete_lagrangian(damped, { rule = "midpoint", h = h }), dm.discrete_lagrangian(damped, { rule = "trapezoidal", h = h })
near(middle:legendre_minus({ a }, { b })[1], v + h / 4 * (a + b) + h / 2 * c * v, 1e-14, "midpoint: p0 = -D1 Ld - F1")
near(middle:legendre_plus({ a }, { b })[1], v - h / 4 * (a + b) - h / 2 * c * v, 1e-14, "midpoint: p1 = D2 Ld + F2")
near(ends:legendre_minus({ a }, { b })[1], v + h / 2 * a + h / 2 * c * v, 1e-14, "trapezoidal: p0")
near(ends:legendre_plus({ a }, { b })[1], v - h / 2 * b - h / 2 * c * v, 1e-14, "trapezoidal: p1")
local F = middle.force(dm.vector { a }, dm.vector { b }, h)
near(F[1][1], -h / 2 * c * v, 1e-16, "F1")
near(F[2][1], -h / 2 * c * v, 1e-16, "F2")

-- the motion of the damped oscillator from q, v in closed form, with its velocity
local w = math.sqrt(1 - c ^ 2 / 4)
local function flow(q, u, t)
  local A, B = q, (u + c / 2 * q) / w
  local e, s, k = exp(-c / 2 * t), sin(w * t), cos(w * t)
  return e * (A * k + B * s), e * (-c / 2 * (A * k + B * s) + w * (B * k - A * s))
end
-- the velocity at a with which it is at b after t
local function aim(t)
  local zero, one = flow(a, 0, t), flow(a, 1, t)
  return (b - zero) / (one - zero)
end
local u = aim(0.8)
local _, later = flow(a, u, 0.8)
local exact = dm.discrete_lagrangian(damped, { rule = "exact", h = 0.8 })
near(exact:legendre_minus({ a }, { b })[1], u, 1e-13, "exact: p0")
near(exact:legendre_plus({ a }, { b })[1], later, 1e-13, "exact: p1")
-- the action along it, by Simpson's rule on many parts
local sum, parts = 0, 400
for k = 0, parts do
  local q, rate = flow(a, u, 0.8 * k / parts)
  sum = sum + (k % parts == 0 and 1 or k % 2 == 1 and 4 or 2) * (rate ^ 2 - q ^ 2) / 2
end
near(exact:value({ a }, { b }), sum * 0.8 / parts / 3, 1e-12, "exact: the action along the forced motion")

-- L_q that is constant: a fall with friction, v' = -g - c v, in closed form
local g, time = 9.8, 0.8
local falling = dm.system { Q = dm.R(2), L = function(q, rate) return rate:dot(rate) / 2 - g * q[2] end, force = function(q, rate) return -c * rate end }
local grow = exp(-c * time)
local from, to = { 0, a }, { 0.4, b }
local first = { c * (to[1] - from[1]) / (1 - grow), c * (b - a + g * time / c) / (1 - grow) - g / c }
local last = { first[1] * grow, (first[2] + g / c) * grow - g / c }
exact = dm.discrete_lagrangian(falling, { rule = "exact", h = time })
near((exact:legendre_minus(from, to) - dm.vector(first)):norm(), 0, 1e-12, "exact: p0 of a fall with friction")
near((exact:legendre_plus(from, to) - dm.vector(last)):norm(), 0, 1e-12, "exact: p1")
for _, rule in ipairs(RULES) do
  local path = falling:solver { rule = rule, h = 0.1 }:run(start)
  near(momenta(dm.discrete_lagrangian(falling, { rule = rule, h = 0.1 }), path), 0, 1e-13, rule .. ": a fall with friction")
end

-- orders of the steps, against the closed form at t = 2
for rule, order in pairs { midpoint = 2, trapezoidal = 2, verlet = 2, ["gauss(2)"] = 4, ["lobatto(3)"] = 4, ["gauss(3)"] = 6 } do
  local function off(n)
    local Ld = dm.discrete_lagrangian(damped, { rule = rule, h = 2 / n })
    return abs(dm.solver { Ld }:run { q = { 1 }, p = { 0 }, steps = n }.q[n + 1][1] - flow(1, 0, 2))
  end
  near(math.log(off(8) / off(16), 2), order, 0.12, rule .. ": order " .. order)
  local report = dm.discrete_lagrangian(damped, { rule = rule, h = 0.1 }):against_exact { q = { 1 }, v = { 0.3 }, h = { 0.4, 0.2, 0.1 } }
  near(report.value_slope, order + 1, 0.15, rule .. ": its value against that of the flow")
  ok(report.momentum_slope > order - 0.2, rule .. ": its momenta, too", report.momentum_slope)
end

-- constraints at the nodes beside a force: a pendulum with friction, as its midpoint rule
local pendulum = dm.system { Q = dm.R(2), L = function(q, rate) return rate:dot(rate) / 2 - q[2] end,
  constraint = function(q) return { (q:dot(q) - 1) / 2 } end, force = function(q, rate) return -0.2 * rate end }
for _, rule in ipairs { "midpoint", "trapezoidal" } do
  local own = pendulum:solver { rule = rule, h = 0.05 }:run { q = { 0.6, -0.8 }, v = { 0.4, 0.3 }, steps = 40 }
  local Ld = dm.discrete_lagrangian(pendulum, { rule = rule, h = 0.05 })
  local path = dm.solver { Ld }:run { q0 = own.q[1], q1 = own.q[2], steps = 40 }
  local worst = 0
  for k = 1, 41 do worst = max(worst, (path.q[k] - own.q[k]):norm()) end
  near(worst, 0, 1e-12, rule .. ": a constraint at the nodes and a force")
end

-- reduced: friction of the shape, by the rule and by its Ld
local planar = dm.system { Q = dm.R(2), coordinates = { "theta", "r" }, L = function(q, rate)
  return (rate[2] ^ 2 + q[2] ^ 2 * rate[1] ^ 2) / 2 - q[2] ^ 2 / 2
end, force = function(q, rate) return { 0, -0.1 * rate[2] * q[2] } end }
local shape = planar:routh { cyclic = { "theta" }, mu = 0.8 }
for _, rule in ipairs { "midpoint", "trapezoidal" } do
  local own = planar:solver { rule = rule, h = 0.1 }:run { q = { 0, 1 }, p = { 0.8, 0.2 }, steps = 20 }
  local D = shape:discrete(dm.discrete_lagrangian(planar, { rule = rule, h = 0.1 }))
  local x2 = D:step({ own.q[1][2] }, { own.q[2][2] })
  near(x2[1], own.q[3][2], 1e-13, rule .. ": a step of the reduced Ld")
  near(shape:discrete { rule = rule, h = 0.1 }:step({ own.q[1][2] }, { own.q[2][2] })[1], own.q[3][2], 1e-13, rule .. ": and by the rule's name")
end
raises("has a force", function() shape:discrete { rule = "gauss(2)", h = 0.1 } end)
raises("has a force", function() shape:discrete(dm.discrete_lagrangian(planar, { rule = "gauss(2)", h = 0.1 })) end)

-- members that vary a parameter of L and one of the force, against systems with these values
local function swing(k, drag)
  return dm.system { Q = dm.R(1), params = { k = k, drag = drag },
    L = function(q, rate, _, p) return (rate[1] ^ 2 - p.k * q[1] ^ 2) / 2 end,
    force = function(_, rate, _, p) return -p.drag * rate[1] end }
end
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(2)" } do
  local function solver(k, drag) return dm.solver { dm.discrete_lagrangian(swing(k, drag), { rule = rule, h = h }) } end
  local members = solver(1, 0.2):ensemble { members = 2, steps = 20, q = { { 1 }, { 1 } }, p = { { 0 }, { 0 } },
    vary = { k = { 1, 3 }, drag = { 0.2, 0.7 } } }
  local worst = 0
  for i, own in ipairs { { 1, 0.2 }, { 3, 0.7 } } do
    local path = solver(own[1], own[2]):run { q = { 1 }, p = { 0 }, steps = 20 }
    worst = max(worst, abs(members.q[i][1] - path.q[21][1]), abs(members.p[i][1] - path.p[21][1]))
  end
  near(worst, 0, 1e-14, rule .. ": members that vary parameters")
end

-- a system is no entry of the table
for _, one in ipairs { { damped, rule = "midpoint", h = h }, { system = damped, h = h },
  { Q = dm.R(1), rule = "midpoint", h = h } } do
  raises("it is dm.discrete_lagrangian(system, { rule =, h = })", dm.discrete_lagrangian, one)
end

-- what has none
local stages = dm.discrete_lagrangian(damped, { rule = "gauss(2)", h = h })
raises("this system has a force, with which steps keep no two-form", stages.two_form, stages, { a }, { b })
raises("'force'", function() stages:average(dm.SO(2)) end)
raises("no place for a control", dm.discrete_lagrangian, dm.system { Q = dm.R(1), L = function(_, rate) return rate[1] ^ 2 / 2 end,
  control = function(q) return -q[1] end, force = function(_, _, _, held) return { held[1] } end }, { rule = "midpoint", h = h })
raises("no place for rolling constraints", dm.discrete_lagrangian, dm.system { Q = dm.R(2), L = function(_, rate) return rate:dot(rate) / 2 end,
  rolling = function(q, rate) return { rate[1] - q[1] * rate[2] } end }, { rule = "midpoint", h = h })
tap.done()
