-- discrete mechanical connections: closed forms, orders, conserved momentum, groups of all kinds;
-- what is not invariant or singular is told
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos = dm.sin, dm.cos

-- T = (I v1^2 + 2 b.x' v1 + x'^2)/2 - V over two shapes
local function I(x) return 2 + sin(x[1]) * cos(x[2]) / 2 end
local function b(x) return dm.vector { 0.4 + x[2] / 3, -x[1] / 2 } end
local function system(V)
  return dm.system { Q = dm.R(3), coordinates = { "theta", "x", "y" }, L = function(q, v)
    local x, u = dm.vector { q[2], q[3] }, dm.vector { v[2], v[3] }
    return I(x) * v[1] ^ 2 / 2 + b(x):dot(u) * v[1] + u:dot(u) - (V and V(x) or 0)
  end }
end
local function of(s, rule, mu)
  return dm.discrete_lagrangian(s, { rule = rule, h = 0.1 })
    :connection { cyclic = { "theta" }, mu = mu }
end

local kinetic, pushed = system(), system(function(x) return x[1] ^ 2 + cos(x[2]) end)
local q0, q1 = { 0.2, 0.3, -0.4 }, { 0.9, 0.5, 0.1 }
local x0, x1 = dm.vector { 0.3, -0.4 }, dm.vector { 0.5, 0.1 }
local mean = (x0 + x1) / 2
near(of(kinetic, "midpoint")(q0, q1)[1], 0.7 + b(mean):dot(x1 - x0) / I(mean), 1e-13,
  "midpoint in closed form")
near(of(kinetic, "trapezoidal")(q0, q1)[1], 0.7 + (b(x0) + b(x1)):dot(x1 - x0) / (I(x0) + I(x1)),
  1e-13, "trapezoidal in closed form")
for _, s in ipairs { kinetic, pushed } do
  for k = 1, 4 do near(of(s, "gauss(" .. k .. ")"):order(), 2 * k, 0.3, "order of gauss " .. k) end
  near(of(s, "trapezoidal"):order(), 2, 0.3, "order of trapezoidal")
  near(of(s, "lobatto(3)"):order(), 4, 0.3, "order of lobatto(3)")
end
local A = of(pushed, "gauss(2)")
ok(A:check().worst < 1e-12, "axioms with a potential", A:check().worst)
ok((of(kinetic, "gauss(2)"):continuous(x0):row(1) - b(x0) / I(x0)):norm() < 1e-12, "tends to b/I")
-- points are those of Q, in its order; a run with momentum 0 is horizontal
local lifted = A:lift(x0, x1, q0)
ok(A(q0, lifted):norm() < 1e-13 and lifted[2] == 0.5 and lifted[3] == 0.1, "lift to a point of Q")
local Ld = dm.discrete_lagrangian(pushed, { rule = "gauss(2)", h = 0.1 })
for _, mu in ipairs { 0, 0.7 } do
  local C, path = of(pushed, "gauss(2)", mu), nil
  local p = pushed:momentum({ 0.2, 0.3, -0.4 }, { 0, 0.5, 0.2 })
  path = Ld:solver {}:run { q = q0, p = { mu, p[2], p[3] }, steps = 40 }
  local worst = 0
  for k = 1, 40 do worst = math.max(worst, C(path.q[k], path.q[k + 1]):norm()) end
  ok(worst < 1e-12, "runs with the momentum mu are lifts, mu = " .. mu, worst)
end
ok(of(pushed, "gauss(2)", 0.7):check().splitting > 1e-3, "momentum other than 0: (ii) does not hold")
local reduced = pushed:routh { cyclic = { "theta" }, mu = 0.7 }:discrete { rule = "gauss(2)", h = 0.1 }
ok((of(pushed, "gauss(2)", 0.7)(q0, q1) - reduced:connection(q0, q1)):norm() < 1e-12,
  "that of the discrete Routh reduction")

-- a formula, on a torus, with its own step
local pendulums = dm.discrete_lagrangian { Q = dm.T(3), h = 0.1, Ld = function(a, c, h)
  local m, u = (a + c) / 2, (c - a) / h
  return h * (u:dot(u) / 2 + u[2] * u[3] * cos(m[1] - m[3]) + u[2] * u[1] / 3 * sin(m[1]))
end }
local T = pendulums:connection { cyclic = { 2 } }
ok(tostring(T.group) == "T^1" and T:check().worst < 1e-12, "a formula on a torus")
near(T({ 0.1, 0.2, 0.3 }, { 0.2, 0.4, 0.2 })[1],
  0.2 + (-0.1) * math.cos(0.15 - 0.25) + 0.1 / 3 * math.sin(0.15), 1e-14, "its closed form")
raises("reference", function() return T:order() end)

---- on groups: locked inertia of a body with two rotors, each of them exact ----

local G = dm.SO(3)
local function rotors(coupling)
  return dm.system { Q = dm.product(dm.R(2), G), L = function(q, xi)
    local x, u = q[1], { xi[1], xi[2] }
    local w = { xi[3], xi[4], xi[5] }
    return (2 * w[1] ^ 2 + 3 * w[2] ^ 2 + 4 * w[3] ^ 2) / 2 + 0.5 * (w[1] + u[1]) ^ 2 / 2
      + 0.4 * (w[2] + u[2]) ^ 2 / 2 + coupling * w[3] * (x[1] * u[2] + u[1])
  end }
end
for s = 1, 3 do
  local M = rotors(0.3):mechanical_connection { group = G, rule = ("lie(%d)"):format(s), h = 0.1 }
  ok(M:check().worst < 1e-12, "lie: axioms")
  near(M:order(), 2 * s, 0.3, ("order of lie(%d)"):format(s))
  local form = M:continuous { 0.3, -0.2 }
  near(form[1][1], 0.2, 1e-12, "I_lock^-1 of the first rotor")
  near(form[2][2], 0.4 / 3.4, 1e-12, "of the second")
  near(form[3][2], 0.3 * 0.3 / 4, 1e-12, "of the coupling")
end
-- one rotor alone turns the body about its axis by I_lock^-1 I_r dx, whatever the rule
local M = rotors(0):mechanical_connection { group = G, rule = "lie(2)", h = 0.1 }
ok(G:distance(M:local_form({ 0, 0 }, { 0.7, 0 }), G:exp { 0.14, 0, 0 }) < 1e-13, "one rotor")
-- runs from rest of the momentum stay horizontal
local s = rotors(0.3)
local path = s:solver { rule = "lie(2)", h = 0.1 }
  :run { q = { { 0.1, 0.2 }, G:exp { 0.3, 0.1, -0.2 } }, p = { 0.4, 0.3, 0, 0, 0 }, steps = 20 }
local C, worst = s:mechanical_connection { group = G, rule = "lie(2)", h = 0.1 }, 0
for k = 1, 20 do
  worst = math.max(worst, G:distance(C(path.q[k], path.q[k + 1]), G:identity()))
end
ok(worst < 1e-12, "runs of momentum 0 are lifts", worst)

for _, row in ipairs { { dm.SE(2), "lie(1)" }, { dm.SE(2), "lie(2, cayley)" }, { dm.SE(3), "lie(1)" },
  { dm.SE(2), "lie(2, pade(2))" },
  { dm.SU(2), "lie(1)" }, { dm.Heisenberg(), "lie(1)" } } do
  local K, d = row[1], row[1].dimension
  local sys = dm.system { Q = dm.product(dm.T(1), K), L = function(q, xi)
    local sum = xi:dot(xi) / 2
    for k = 1, d do sum = sum + 0.2 * xi[1] * xi[1 + k] * cos(q[1][1] + k) end
    return sum + 0.3 * xi[2] * xi[d + 1]
  end }
  local N = sys:mechanical_connection { group = K, rule = row[2], h = 0.1 }
  local name = tostring(K) .. " by " .. row[2]
  ok(N:check().worst < 1e-12, name .. ": axioms", N:check().worst)
  near(N:order(), row[2]:find "2" and 4 or 2, 0.3, name .. ": order")
end
-- a group of coordinates, points are { x, g }
local F = dm.system { Q = dm.product(dm.R(2), dm.T(1)), L = function(q, v)
  return (v:dot(v) + v[3] * (v[1] * q[2] - q[1] * v[2])) / 2
end }:mechanical_connection { group = dm.T(1), rule = "gauss(2)", h = 0.1 }
near(F({ { 1, 2 }, { 0.3 } }, { { 1.1, 2.2 }, { 0.5 } })[1], 0.2, 1e-14, "a factor T(1)")
near(F:order(), 4, 0.3, "its order")

---- errors ----

raises("not invariant under translations of 'x'", function()
  return dm.discrete_lagrangian(kinetic, { rule = "midpoint", h = 0.1 }):connection { cyclic = "x" }
end)
raises("not invariant under translations of 'x'", function()
  return dm.discrete_lagrangian(kinetic, { rule = "gauss(2)", h = 0.1 }):connection { cyclic = "x" }
end)
raises("not invariant under SO(3)", function()
  return dm.system { Q = dm.product(dm.R(1), G), L = function(q, v)
    return v:dot(v) / 2 - q[2][3][3]
  end }:mechanical_connection { group = G, rule = "lie(1)", h = 0.1 }
end)
local polar = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v)
  return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2
end }
local P = dm.discrete_lagrangian(polar, { rule = "midpoint", h = 0.1 }):connection { cyclic = "theta" }
raises("locked inertia", P, { -0.5, 0 }, { 0.5, 0 })
raises("locked inertia", function() return P:continuous { 0 } end)
raises("mu must be 1 number", function()
  return dm.discrete_lagrangian(polar, { rule = "midpoint", h = 0.1 })
    :connection { cyclic = "theta", mu = { 1, 2 } }
end)
raises("q0 must be a point of Q: 2 numbers", P, { 1 }, { 1, 2 })
raises("no product with SE(2)", function()
  return s:mechanical_connection { group = dm.SE(2), rule = "lie(1)", h = 0.1 }
end)
raises("must not depend on the time", function()
  return dm.discrete_lagrangian(dm.system { Q = dm.R(2), L = function(q, v, t)
    return v:dot(v) * (1 + t * t) / 2 + q[1]
  end }, { rule = "gauss(2)", h = 0.1 }):connection { cyclic = { 2 } }
end)
raises("'rule' is missing", function() return s:mechanical_connection { group = G, h = 0.1 } end)
raises("take a chart", function()
  return dm.system { Q = dm.product(G, G), L = function(_, v) return v:dot(v) / 2 end }
    :mechanical_connection { group = G, rule = "lie(1)", h = 0.1 }
end)
-- a rotation as a shape, behind the group: a free run from no momentum is the lift of its shapes
local wheel = dm.system { Q = dm.product(dm.T(1), G, dm.SO(2)), L = function(q, v)
  return v:dot(v) / 2 + 0.2 * v[1] * v[3] + 0.3 * v[4] * v[5] * dm.cos(q[1][1]) + v[2] * v[5] / 5
end }
local W = wheel:mechanical_connection { group = G, rule = "lie(1)", h = 0.1 }
local spin = wheel:solver { rule = "lie(1)", h = 0.1 }:run { q = { { 0.1 }, G:identity(), 3.1 },
  p = { 0.4, 0, 0, 0, 0.9 }, steps = 10 }
local shapes = {}
for k = 1, 11 do shapes[k] = { spin.q[k][1][1], spin.q[k][3] } end
near(G:distance(W:multi_lift(shapes, { shapes[1], G:identity() })[11][2], spin.q[11][2]), 0, 1e-13,
  "SO(2) as a shape")

tap.done()
