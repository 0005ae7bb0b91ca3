-- discrete Routh reduction: psi_mu, the discrete Routh equations, RSPRK as written, symplectic forms, the cube (numbers: the spec's property tests)
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sqrt, sin, cos, pi = math.abs, math.sqrt, math.sin, math.cos, math.pi

local satellite, pendulum = models.satellite(0.05), models.pendulum()
local pole, safe = models.near_pole, models.safe

-- 3.3 every tableau, as written = moved classical Routhian; 3.5 reduced Legendre transforms; 3.4 the literal equations with any connection
local shape = pendulum:routh { cyclic = { 1 }, q = pole.q, v = pole.v }
local bent = pendulum:routh { cyclic = { 1 }, q = pole.q, v = pole.v, connection = function(x) return { x[2] * x[3], cos(x[3]), x[1] ^ 2 } end }
local x0, u0 = shape:start(pole.q, pole.v)
for _, rule in ipairs { "gauss(1)", "gauss(2)", "gauss(4)", "lobatto(2)", "lobatto(3)", "lobatto(4)" } do
  for name, s in pairs { ["its own connection"] = shape, ["another connection"] = bent } do
    local path, step = s:solver({ rule = rule, h = 0.02 }):run { q = x0, v = u0, steps = 20 }, s:rsprk { rule = rule, h = 0.02 }
    local x, sigma = x0, s:magnetic_momentum(x0, path.p[1])
    for _ = 1, 20 do x, sigma = step(x, sigma) end
    local off = (x - path.q[21]):norm() + (sigma - s:magnetic_momentum(path.q[21], path.p[21])):norm()
    ok(off < 6e-14, ("%s with %s: RSPRK as written = what the solver steps"):format(rule, name), off)
    local D, worst, leap = s:discrete { rule = rule, h = 0.02 }, 0, 0
    for k = 1, 20, 5 do
      worst = math.max(worst, D:residual(path.q[k], path.q[k + 1], path.q[math.min(k + 2, 21)]):norm() * (k < 20 and 1 or 0))
      leap = math.max(leap, (D:legendre_plus(path.q[k], path.q[k + 1]) - s:magnetic_momentum(path.q[k + 1], path.p[k + 1])):norm(),
        (D:legendre_minus(path.q[k], path.q[k + 1]) - s:magnetic_momentum(path.q[k], path.p[k])):norm())
    end
    ok(worst < 1e-12, "the literal discrete Routh equations hold along it", worst)
    ok(leap < 1e-12, "and the reduced Legendre transforms give its momenta", leap)
  end
end

-- 3.2 a discrete Lagrangian in Cartesian coordinates, reduced by an action (IC-A)
local function cartesian(J2)
  return dm.system { Q = dm.R(3), L = function(q, v)
    local rho = q:norm()
    return v:dot(v) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * q[3] ^ 2 / rho ^ 2 - 0.5)
  end }
end
local function turn(t, q) return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2], q[3] } end
local body = cartesian(0.05)
local plane = body:routh { action = turn, section = function(x) return { x[1], 0, x[2] } end, mu = 0.96 }
local D = plane:discrete(dm.discrete_lagrangian(body, { rule = "midpoint", h = 0.3 }))
local orbit = body:solver({ rule = "midpoint", h = 0.3 }):run { q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, steps = 1000 }
local function below(k)
  local q = orbit.q[k]
  return { sqrt(q[1] ^ 2 + q[2] ^ 2), q[3] }
end
near((orbit.q[11] - dm.vector { -0.487770578714972705, -0.518020880705221569, -0.174239184432625609 }):norm(), 0, 1e-14, "Cartesian midpoint, 10 steps")
local worst, lift = 0, 0
for k = 1, 999, 23 do
  worst = math.max(worst, D:residual(below(k), below(k + 1), below(k + 2)):norm())
  lift = math.max(lift, abs(sin(D:connection(orbit.q[k], orbit.q[k + 1])[1] / 2)))
end
ok(worst < 1e-11, "the projected path solves the discrete Routh equations, 1000 steps", worst)
ok(lift < 1e-11, "and the discrete connection vanishes on it", lift)
local a, b, theta = below(1), below(2), D:psi(below(1), below(2))[1]
for _ = 3, 41 do
  local c, psi = D:step(a, b)
  a, b, theta = b, c, theta + psi[1]
end
near((b - dm.vector(below(41))):norm(), 0, 1e-12, "the discrete Routh equations step along it")
near(b[1] * cos(theta), orbit.q[41][1], 1e-12, "with the angle")
near((D:residual(below(5), below(6), below(7)) - D:residual(below(5), below(6), below(7), "direct")):norm(), 0, 1e-14, "literal = direct")
local flow = D:solver():run { q = { 1, 0 }, p = { 0, 0.28 }, steps = 1000 }
local above = flow:reconstruct { theta = 0 }
ok(dm.compare(orbit, above).worst < 1e-11, "stepped in C for 1000 steps and lifted, it is the unreduced path", tostring(dm.compare(orbit, above)))
-- 3.1 the momentum map of the unreduced one
worst = 0
for k = 1, 1001 do worst = math.max(worst, abs(orbit.q[k][1] * orbit.p[k][2] - orbit.q[k][2] * orbit.p[k][1] - 0.96)) end
ok(worst < 1e-13, "momentum over 1000 Cartesian steps", worst)

-- closed forms of the midpoint in cylindrical coordinates (spec 2.1)
local kept = satellite:routh { cyclic = { "theta" }, mu = 0.96 }
local C = kept:discrete { rule = "midpoint", h = 0.3 }
local r, V = 0.95, satellite:lagrangian({ 0, 0.95, 0.1 }, { 0, 0, 0 })
near(C:psi({ 1, 0.05 }, { 0.9, 0.15 })[1], 0.3 * 0.96 / r ^ 2, 1e-15, "psi_mu of the midpoint rule")
near(C:value({ 1, 0.05 }, { 0.9, 0.15 }), 0.3 * ((0.01 + 0.01) / (2 * 0.09) + 0.96 ^ 2 / (2 * r * r) + V), 1e-15, "reduced discrete Lagrangian")
near(C:routhian({ 1, 0.05 }, { 0.9, 0.15 }), C:value({ 1, 0.05 }, { 0.9, 0.15 }) - 0.3 * 0.96 ^ 2 / r ^ 2, 1e-15, "discrete Routhian")
local one, two = C:one_form({ 1, 0.05 }, { 0.9, 0.15 })
near(one[1], -0.3 * 0.96 ^ 2 / r ^ 3, 1e-14, "the one-form does not vanish although A does"); near(two[1], one[1], 1e-15, "nor its other half")

-- 3.14 any two close shapes lift to a pair with momentum mu; equivariance of the discrete connection
local E = shape:discrete { rule = "gauss(2)", h = 0.05 }
local z0, z1 = { 0.5, 0.4, 0.3 }, { 0.52, 0.37, 0.36 }
local psi = E:psi(z0, z1)[1]
near(E.Ld:legendre_plus({ 0, 0.5, 0.4, 0.3 }, { psi, 0.52, 0.37, 0.36 })[1], 3.1095, 1e-13, "any pair of shapes lifts to the momentum")
near(E:connection({ 0.2, 0.5, 0.4, 0.3 }, { 0.9, 0.52, 0.37, 0.36 })[1], 0.7 - psi, 1e-15, "discrete connection: equivariant")

-- 3.15 the discrete mechanical connection along a closed loop tends to the holonomy, order 2
local still = pendulum:routh { cyclic = { 1 }, mu = 0 }
local function loop(s) return { 0.5 + 0.1 * cos(s), 0.5 + 0.05 * sin(2 * s), 1 + 0.3 * sin(s) } end
local errors = {}
for i, N in ipairs { 16, 32, 64 } do
  local F, sum = still:discrete { rule = "midpoint", h = 2 * pi / N }, 0
  for k = 1, N do sum = sum + F:psi(loop(2 * pi * (k - 1) / N), loop(2 * pi * k / N))[1] end
  errors[i] = sum - 0.0249664851943495
end
ok(abs(errors[1]) < 6e-4, "holonomy of the discrete mechanical connection, 16 points", errors[1])
near(errors[1] / errors[2], 4, 0.1, "order 2"); near(errors[2] / errors[3], 4, 0.05, "order 2 again")

-- 3.6 symplectic forms: that of S x S by Phi, that of T*S by the tangent map moved by B
local function multiply(A, B)
  local out = {}
  for i = 1, #A do
    out[i] = {}
    for k = 1, #B[1] do
      out[i][k] = 0
      for j = 1, #B do out[i][k] = out[i][k] + A[i][j] * B[j][k] end
    end
  end
  return out
end
local function transpose(A)
  local out = {}
  for i = 1, #A[1] do
    out[i] = {}
    for k = 1, #A do out[i][k] = A[k][i] end
  end
  return out
end
-- dx ^ ds - beta at x, or without beta
local function reduced_form(s, x, d, with)
  local form, out = s:symplectic_form(x), {}
  for i = 1, 2 * d do
    out[i] = {}
    for k = 1, 2 * d do out[i][k] = (with or i > d or k > d) and form[i][k] or 0 end
  end
  return out
end
-- (x, p) -> (x, s), ds = dp -+ dB dx, dB by differences of order 4
local function differences(s, x, d, sign)
  local out, e = {}, 1e-4
  for i = 1, 2 * d do out[i] = {} for k = 1, 2 * d do out[i][k] = i == k and 1 or 0 end end
  local none = { 0, 0, 0 }
  for k = 1, d do
    local J = {}
    for _, w in ipairs { { 1, 8 / 12 }, { -1, -8 / 12 }, { 2, -1 / 12 }, { -2, 1 / 12 } } do
      local y = { x[1], x[2], x[3] }
      y[k] = y[k] + w[1] * e
      local B = s:magnetic_momentum(y, none)
      for i = 1, d do J[i] = (J[i] or 0) + w[2] * B[i] / e end
    end
    for i = 1, d do out[d + i][k] = sign * J[i] end
  end
  return out
end
for name, s in pairs { ["near a pole"] = { shape, pole, 0.28 }, ["away from it"] = { pendulum:routh { cyclic = { 1 }, q = safe.q, v = safe.v }, safe, 0.65 } } do
  local reduced, state = s[1], s[2]
  local x, u = reduced:start(state.q, state.v)
  local solver = reduced:solver { rule = "gauss(2)", h = 0.05 }
  local M, x1 = solver:tangent { q = x, v = u, steps = 1 }
  local rows = {}
  for i = 1, 6 do rows[i] = {} for k = 1, 6 do rows[i][k] = M[i][k] end end
  -- in (x, s): S1 M S0^-1
  local N = multiply(differences(reduced, x1, 3, 1), multiply(rows, differences(reduced, x, 3, -1)))
  local function defect(with)
    local form, most = multiply(transpose(N), multiply(reduced_form(reduced, x1, 3, with), N)), 0
    local before = reduced_form(reduced, x, 3, with)
    for i = 1, 6 do for k = 1, 6 do most = math.max(most, abs(form[i][k] - before[i][k])) end end
    return most
  end
  local kept_form, canonical = defect(true), defect(false)
  ok(kept_form < 1e-9, name .. ": RSPRK keeps dx ^ ds - beta", kept_form)
  ok(abs(canonical - s[3]) < 0.01, name .. ": and not the canonical form", canonical)
end

-- 3.7 orders of reduced and unreduced points on the satellite, against the spec's errors at t = 3 (h = 0.3, 0.15)
local exact = { -0.798046910427261695, -0.280882551050369038, -0.130326311987126223 }
for rule, wanted in pairs { ["gauss(1)"] = { 1.27e-2, 2 }, ["gauss(2)"] = { 6.7e-5, 4 }, ["gauss(3)"] = { 1.15e-7, 6 },
  ["lobatto(3)"] = { 2.2e-5, 4 }, ["lobatto(4)"] = { 3.3e-8, 6 } } do
  local errors_of = {}
  for i = 1, 2 do
    local p = kept:solver({ rule = rule, h = 0.3 / i }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = 10 * i }:reconstruct()
    local q = p.q[#p]
    local off = dm.vector { q[2] * cos(q[1]), q[2] * sin(q[1]), q[3] } - dm.vector(exact)
    errors_of[i] = math.max(abs(off[1]), abs(off[2]), abs(off[3]))
  end
  ok(abs(errors_of[1] / wanted[1] - 1) < 0.05, rule .. ": the error at t = 3", errors_of[1])
  near(math.log(errors_of[1] / errors_of[2], 2), wanted[2], 0.2, "and its order")
end

-- 3.9 a shift of the angle by f(x): nothing for f of degree 2, the order of the rule for others
local function shifted(f)
  local given = pendulum.L
  return dm.system { Q = dm.R(4), L = function(q, v)
    local fx = dm.derivative(function(x) return f(x[1], x[2], x[3]) end, 3)(dm.vector { q[2], q[3], q[4] })
    return given(q, dm.vector { v[1] + fx[1] * v[2] + fx[2] * v[3] + fx[3] * v[4], v[2], v[3], v[4] }, 0)
  end }
end
local free = pendulum:routh { cyclic = { 1 }, q = safe.q, v = safe.v }
local xs, us = free:start(safe.q, safe.v)
local mu = free:reduction().mu[1]
local function at_one(s, h) return s:solver({ rule = "gauss(2)", h = h }):run({ q = xs, v = us, steps = math.floor(1 / h + 0.5) }).q end
local straight = at_one(free, 0.05)
near((at_one(shifted(function(r1, _, phi) return r1 * phi end):routh { cyclic = { 1 }, mu = mu }, 0.05)[21] - straight[21]):norm(), 0, 1e-13,
  "theta + r1 phi: the same points")
local cubic = shifted(function(_, _, phi) return 0.1 * phi * phi * phi end):routh { cyclic = { 1 }, mu = mu }
local far, near_by = (at_one(cubic, 0.05)[21] - straight[21]):norm(), (at_one(cubic, 0.025)[41] - at_one(free, 0.025)[41]):norm()
ok(far > 1e-6 and far < 1e-4, "theta + phi^3/10: other points", far)
near(math.log(far / near_by, 2), 4, 0.25, "that approach each other with the order of the rule")

-- 3.10 a magnetic form that is not d(mu A), like the printed one, gives something else, whatever the step
local wrong = {}
for i, h in ipairs { 0.05, 0.025 } do
  local step = free:rsprk { rule = "gauss(2)", h = h, beta = function(x)
    local b, out = 2 * mu * models.m1 * models.m2 * x[1] * x[2], {}
    local I = models.m1 * x[1] ^ 2 + models.m2 * (x[1] ^ 2 + x[2] ^ 2 + 2 * x[1] * x[2] * cos(x[3]))
    for r = 1, 3 do out[r] = { 0, 0, 0 } end
    out[3][1], out[1][3] = b * x[2] / I, -b * x[2] / I  -- the square of I is lost
    out[3][2], out[2][3] = -b * x[1] / I, b * x[1] / I
    return out
  end }
  local x, s = xs, free:magnetic_momentum(xs, free:legendre(xs, us))
  for _ = 1, math.floor(0.5 / h + 0.5) do x, s = step(x, s) end
  wrong[i] = (x - at_one(free, h)[math.floor(0.5 / h + 0.5) + 1]):norm()
end
ok(wrong[1] > 0.02 and abs(wrong[1] / wrong[2] - 1) < 0.1, "a wrong magnetic form is wrong at every step size", wrong[1])

-- 3.16 order of a discrete Lagrangian as an action, circular orbit of radius 1: L = 3/2, so that the action is 1.5 h
local circle = models.satellite(0)
for i, h in ipairs { 0.3, 0.15, 0.075 } do
  local Ld = dm.discrete_lagrangian(cartesian(0), { rule = "midpoint", h = h })
  local off = Ld({ 1, 0, 0 }, { cos(h), sin(h), 0 }) - 1.5 * h
  near(abs(off) / ({ 2.28e-3, 2.82e-4, 3.52e-5 })[i], 1, 0.02, "error of the action at h = " .. h)
end
near(circle:lagrangian({ 0, 1, 0 }, { 1, 0, 0 }), 1.5, 1e-15, "L on the circle")

-- 3.18 reversal
for _, rule in ipairs { "gauss(1)", "gauss(2)", "lobatto(3)" } do
  local back = kept:solver({ rule = rule, h = 0.3 }):reversal { q = { 1, 0 }, v = { 0, 0.28 }, steps = 100 }
  ok(back < 2e-14, rule .. ": 100 steps there and back", back)
end

-- the cube, and a rule for which it does not close: more nodes than the degree of its curve
local cube = dm.commute(pendulum, { q = safe.q, v = safe.v, cyclic = { 1 }, rule = "gauss(2)", h = 0.02, steps = 20 })
ok(cube.commutes and #cube == 12, "all edges of the cube commute", tostring(cube))
ok(tostring(cube):find "DEL %-> DR", "and are printed", tostring(cube))
cube = dm.commute(models.two_angles(), { q = { 0, 0, 1, 0.5 }, v = { 0.1, 0.2, 0, 0.3 }, rule = "lobatto(3)", h = 0.1, steps = 10 })
ok(cube.commutes, "with a group of two dimensions, found from the graph", tostring(cube))
cube = dm.commute(pendulum, { q = safe.q, v = safe.v, cyclic = { 1 }, rule = "galerkin(2, lobatto(3))", h = 0.02, steps = 10 })
ok(not cube.commutes, "not for a Galerkin rule with more nodes than its degree", tostring(cube))

-- dm.compare
local p = satellite:solver({ rule = "gauss(2)", h = 0.3 }):run { q = models.orbit.q, v = models.orbit.v, steps = 20 }
local q = satellite:solver({ rule = "gauss(4)", h = 0.15 }):run { q = models.orbit.q, v = models.orbit.v, steps = 40 }
local found = dm.compare(p, q)
ok(found.rows == 21 and found.worst > 1e-6 and found.worst < 1e-2 and found.column ~= nil, "two paths are compared at common times", tostring(found))
local largest = 0
for k = 1, 21 do largest = math.max(largest, abs(p.q[k][1] - q.q[2 * k - 1][1])) end
near(found[1].difference, largest, 0, "by the largest difference")
raises("no times in common", function() dm.compare(p, satellite:solver({ rule = "gauss(2)", h = 0.3 }):run { q = models.orbit.q, v = models.orbit.v, steps = 3, t0 = 100 }) end)
raises("two paths", function() dm.compare(p, 1) end)
raises("unknown option", function() dm.compare(p, p, { column = "q1" }) end)

-- misuse
raises("not symplectic", function() shape:rsprk { h = 0.1, a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 0.5, 0.5 }, A = { { 0.5, 0 }, { 0.5, 0.1 } } } end)
raises("weight b_2 is zero", function() shape:rsprk { h = 0.1, a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 1, 0 } } end)
raises("gauss(s) or lobatto(s)", function() shape:rsprk { rule = "rk4", h = 0.1 } end)
raises("point of the shape space", function() E:psi({ 1 }, { 2 }) end)
raises("literal", function() E:residual(z0, z1, z1, "other") end)
raises("reduced system", function() pendulum:discrete { rule = "gauss(2)", h = 0.1 } end)
raises("this Ld is not invariant", function()
  kept:discrete(dm.discrete_lagrangian { Q = dm.R(3), h = 0.1, Ld = function(p0, p1) return (p1 - p0):dot(p1 - p0) / 0.2 - sin(p0[1]) * p0[2] end })
end)
raises("shape:discrete takes", function() shape:discrete(3) end)
raises("no psi_mu", function()  -- a free rotor in Cartesian coordinates: r0 r1 sin psi = mu h has no root
  local rotor = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end }
  local reduced = rotor:routh { action = turn, section = function(x) return { x[1], 0, x[2] } end, mu = 5 }
  reduced:discrete(dm.discrete_lagrangian(rotor, { rule = "midpoint", h = 1 })):psi({ 1, 0 }, { 1, 0 })
end)
raises("takes a system and", function() dm.commute(pendulum, { h = 1 }) end)


-- numbers and names where there is one coordinate
do
  local planet = dm.system { Q = dm.R(2), coordinates = { "angle", "r" }, L = function(q, v) return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2] end }
  local shape = planet:routh { cyclic = "angle", mu = 1 }
  tap.near(planet:routh { cyclic = 1, mu = 1 }:amended_potential(2), shape:amended_potential { 2 }, 0, "the only cyclic coordinate by number or name")
  tap.near(shape:relative_equilibria { region = { 0.5, 2 } }[1].x[1], 1, 1e-12, "the region of an only coordinate")
  local D = shape:discrete { rule = "gauss(2)", h = 0.1 }
  tap.near(D:psi(1.5, 1.6)[1], D:psi({ 1.5 }, { 1.6 })[1], 0, "psi of numbers")
  tap.near(D:step(1.5, 1.51)[1], D:step({ 1.5 }, { 1.51 })[1], 0, "a step from numbers")
  tap.near(shape:rsprk { rule = "gauss(2)", h = 0.1 }(1.5, 0.1)[1], shape:rsprk { rule = "gauss(2)", h = 0.1 }({ 1.5 }, { 0.1 })[1], 0, "rsprk of numbers")
  tap.raises("q0 must be a point of the unreduced system: 2 numbers", D.connection, D, { 1.5 }, { 1.6 })
  tap.ok(#shape:slice("amended_potential", { from = 0.5, to = 2 }) == 1, "a slice between numbers")
end
tap.done()
