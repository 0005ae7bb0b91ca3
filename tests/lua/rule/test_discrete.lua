-- discrete Lagrangians of a system and a rule, equal in rank with a user's own Ld(q0, q1)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos = math.sin, math.cos

local twisted = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 * (1 + q[1] ^ 2 / 3 + q[2] ^ 2 / 5) + v[1] * v[2] * sin(q[2]) / 3 + cos(q[1]) * cos(q[2])
end }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local q0, q1 = dm.vector { 0.4, 0.3 }, dm.vector { 0.45, 0.37 }

-- derivatives of Ld by differences of its value, sixth order in e
local function difference(f, e)
  local function odd(k) return f(k * e) - f(-k * e) end
  return (odd(3) - 9 * odd(2) + 45 * odd(1)) / (60 * e)
end
local function moved(q, i, e)
  local x = q + 0 * q
  x[i] = x[i] + e
  return x
end

local rules = { "verlet", "symplectic-euler(a)", "symplectic-euler(b)", "gauss(1)", "gauss(2)", "gauss(4)", "lobatto(3)", "galerkin(3, lobatto(4))",
  "galerkin(2, radau(3))", "galerkin(1, gauss(2))", "sprk(lobatto-3b-3a, 3)", dm.galerkin { degree = 2, nodes = { 0.1, 0.5, 0.8 } },
  dm.sprk { a = { { 0.5 } }, b = { 1 } } }
for _, rule in ipairs(rules) do
  local Ld = dm.discrete_lagrangian(twisted, { rule = rule, h = 0.1 })
  local p0, p1, omega = Ld:legendre_minus(q0, q1), Ld:legendre_plus(q0, q1), Ld:two_form(q0, q1)
  local worst, worst_form = 0, 0
  for i = 1, 2 do
    worst = math.max(worst, math.abs(p0[i] + difference(function(e) return Ld(moved(q0, i, e), q1) end, 0.01)),
      math.abs(p1[i] - difference(function(e) return Ld(q0, moved(q1, i, e)) end, 0.01)))
    for j = 1, 2 do
      worst_form = math.max(worst_form, math.abs(omega[i][j] - difference(function(e) return Ld:legendre_minus(q0, moved(q1, j, e))[i] end, 0.01)))
    end
  end
  near(worst, 0, 2e-10, tostring(rule) .. ": both Legendre transforms are the derivatives of the value")
  near(worst_form, 0, 2e-8, "  and the two-form is that of the momentum")
  local q, p = twisted:solver { rule = rule, h = 0.1 }:step { q = q0, p = p0 }
  near((q - q1):norm() + (p - p1):norm(), 0, 1e-14, "  the step from (q0, p0) ends in (q1, p1)")
end

-- the same numbers as formulas
local formula = dm.discrete_lagrangian(twisted, { rule = "midpoint", h = 0.1 })
local stages = dm.discrete_lagrangian(twisted, { rule = "gauss(1)", h = 0.1 })
near(formula(q0, q1), stages:value(q0, q1), 1e-16, "midpoint as a formula and gauss(1): the value")
near((formula:legendre_plus(q0, q1) - stages:legendre_plus(q0, q1)):norm(), 0, 1e-14, "  the momentum")
local gap = formula:two_form(q0, q1) - stages:two_form(q0, q1)
near(math.abs(gap[1][1]) + math.abs(gap[1][2]) + math.abs(gap[2][1]) + math.abs(gap[2][2]), 0, 1e-12, "  the two-form")
ok(formula:value(q0, q1) == formula(q0, q1), "value and call are one")
near(dm.discrete_lagrangian(kepler, { rule = "galerkin(1, lobatto(2))", h = 0.1 })(q0, q1), dm.discrete_lagrangian(kepler, { rule = "trapezoidal", h = 0.1 })(q0, q1),
  1e-15, "trapezoidal as a formula and by stages")
-- Ld of a harmonic oscillator, exactly: (cot h (q0^2 + q1^2)/2 - q0 q1 / sin h)
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local exact = dm.discrete_lagrangian(oscillator, { rule = "galerkin(8, gauss(8))", h = 0.5 })
near(exact({ 1 }, { 1.2 }), (1 + 1.44) / 2 / math.tan(0.5) - 1.2 / sin(0.5), 1e-14, "the exact discrete Lagrangian of the oscillator")
near(exact:two_form({ 1 }, { 1.2 })[1][1], 1 / sin(0.5), 1e-13, "and its two-form 1/sin h")

-- stepping: position pairs, position and momentum
local Ld = dm.discrete_lagrangian(kepler, { rule = "galerkin(2, gauss(2))", h = 0.05 })
local flow = dm.solver { Ld }
local q2 = flow:step(q0, q1)
near((Ld:legendre_plus(q0, q1) - Ld:legendre_minus(q1, q2)):norm(), 0, 1e-13, "step(q0, q1): the discrete Euler-Lagrange equations")
local a = flow:run { q0 = q0, q1 = q1, steps = 100 }
local b = flow:run { q0 = q0, p0 = Ld:legendre_minus(q0, q1), steps = 100 }
near((a.q[101] - b.q[101]):norm(), 0, 1e-11, "run from (q0, q1) and from (q0, p0)")
near((a.q[3] - q2):norm(), 0, 1e-13, "and step is its third row")
near(Ld:momentum(dm.SO(2), a.q[1], a.q[2])[1], Ld:momentum(dm.SO(2), a.q[100], a.q[101])[1], 1e-13, "the momentum of the rotations is kept")
local own = dm.discrete_lagrangian { Q = dm.R(2), h = 0.05, Ld = function(x, y, h) local v = (y - x) / h return h * (v:dot(v) / 2 + 1 / ((x + y) / 2):norm()) end }
local c = own:solver {}:run { q0 = q0, p0 = own:legendre_minus(q0, q1), steps = 10 }
near((c.q[2] - q1):norm(), 0, 1e-14, "a formula starts from (q0, p0) too")
ok(Ld:solver {}.rule == "galerkin(2, gauss(2))" and Ld.system == kepler and Ld.h == 0.05, "what it knows of itself")
ok(tostring(Ld) == "discrete Lagrangian on R^2, h = 0.05, by galerkin(2, gauss(2))", "and says", tostring(Ld))

-- Hamilton-Pontryagin: p_i = dL/dv at the points, multipliers of the ends are the Legendre transforms
local hp = Ld:hamilton_pontryagin(q0, q1)
ok(hp.value == Ld(q0, q1) and hp.residual < 1e-13, "Hamilton-Pontryagin: the value; its equations hold", hp.residual)
near((hp.p0 - Ld:legendre_minus(q0, q1)):norm() + (hp.p1 - Ld:legendre_plus(q0, q1)):norm(), 0, 0, "multipliers of the ends")
local twist = dm.discrete_lagrangian(twisted, { rule = "lobatto(3)", h = 0.1 }):hamilton_pontryagin(q0, q1)
local off = 0
for i = 1, 3 do off = math.max(off, (twist.p[i] - twisted:momentum(twist.q[i], twist.v[i])):norm()) end
near(off, 0, 1e-15, "p_i = dL/dv(q_i, v_i)")
near((twist.q[1] - q0):norm() + (twist.q[3] - q1):norm(), 0, 1e-15, "Lobatto's points begin and end with q0 and q1")
local action = 0
for i, w in ipairs { 1 / 6, 2 / 3, 1 / 6 } do action = action + 0.1 * w * twisted:lagrangian(twist.q[i], twist.v[i]) end
near(action, twist.value, 1e-16, "the value is h sum b_i L(q_i, v_i)")

-- order, measured
for rule, p in pairs { midpoint = 2, trapezoidal = 2, verlet = 2, ["symplectic-euler(a)"] = 1, ["gauss(2)"] = 4, ["galerkin(3, lobatto(4))"] = 6,
  ["galerkin(2, radau(2))"] = 3, ["galerkin(4, clenshaw-curtis(4))"] = 2, ["gauss(4)"] = 8 } do
  near(dm.discrete_lagrangian(kepler, { rule = rule, h = 0.05 }):order(), p, 0.05, "order of Ld by " .. rule)
end
near(own:order(), 2, 0.02, "order of a formula")
near(dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(x, y, h) return (y[1] - x[1]) ^ 2 / (2 * h) + h * cos(x[1]) end }:order(), 1, 0.02, "order of a formula of first order")
near(Ld:order { q = { 1, 0 }, v = { 0, 0.8 } }, 4, 0.05, "order from a start that is given")
raises("'p' must have 2 entries", function() Ld:order { q = { 1, 0 }, p = { 0, 0.8, 1 } } end)
raises("use its argument h", function()
  dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(x, y) return (y[1] - x[1]) ^ 2 / 0.2 + 0.1 * cos(x[1]) end }:order()
end)

-- time in L, hyper-dual numbers
local driven = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 + q[1] * cos(2 * t) end }
local forced = dm.discrete_lagrangian(driven, { rule = "gauss(3)", h = 0.1 })
ok(forced({ 0 }, { 0.1 }, 1) ~= forced({ 0 }, { 0.1 }), "a time is heard where L depends on it")
for rule, stages in pairs { midpoint = "gauss(1)", trapezoidal = "galerkin(1, lobatto(2))" } do
  local timed = dm.discrete_lagrangian(driven, { rule = rule, h = 0.1 })
  near(timed({ 0 }, { 0.1 }, 1), dm.discrete_lagrangian(driven, { rule = stages, h = 0.1 })({ 0 }, { 0.1 }, 1), 1e-15, rule .. ": the same")
  local path = dm.solver({ timed }):run { q = { 1 }, p = { 0 }, steps = 30 }
  near(path.q[31][1], driven:solver({ rule = rule, h = 0.1 }):run({ q = { 1 }, v = { 0 }, steps = 30 }).q[31][1], 1e-13, rule .. ": and in its steps")
end
local dual = dm.discrete_lagrangian(dm.system { Q = dm.R(1), derivatives = "hyperdual", L = driven.L }, { rule = "midpoint", h = 0.1 })
near(dual({ 0 }, { 0.1 }, 1), dm.discrete_lagrangian(driven, { rule = "midpoint", h = 0.1 })({ 0 }, { 0.1 }, 1), 1e-15, "and on hyper-dual numbers")
raises("knows no time", function()
  dm.discrete_lagrangian(dm.system { Q = dm.R(1), L = driven.L, constraint = function(q) return q[1] end }, { rule = "midpoint", h = 0.1 })
end)
local slow = dm.system { Q = dm.R(2), derivatives = "hyperdual", L = twisted.L }
near(dm.discrete_lagrangian(slow, { rule = "gauss(2)", h = 0.1 })(q0, q1), dm.discrete_lagrangian(twisted, { rule = "gauss(2)", h = 0.1 })(q0, q1), 1e-15, "on hyper-dual numbers")

-- the galerkin rule in words
local words = dm.discrete_lagrangian(kepler, { rule = "galerkin", degree = 3, quadrature = "lobatto(4)", h = 0.05 })
ok(words.rule == "galerkin(3, lobatto(4))" and words(q0, q1) == dm.discrete_lagrangian(kepler, { rule = "galerkin(3, lobatto(4))", h = 0.05 })(q0, q1),
  "rule, degree and quadrature apart")
raises("rule = \"galerkin\"", function() dm.discrete_lagrangian(kepler, { rule = "gauss(2)", degree = 3, h = 0.05 }) end)
raises("'quadrature' must be", function() dm.discrete_lagrangian(kepler, { rule = "galerkin", degree = 3, h = 0.05 }) end)
raises("degree of its polynomials, from 1 to 32", function() dm.discrete_lagrangian(kepler, { rule = "galerkin", degree = 2 ^ 32 | 0, quadrature = "lobatto(4)", h = 0.05 }) end)
raises("'degree'", function() dm.discrete_lagrangian(kepler, { rule = "galerkin", quadrature = "lobatto(4)", h = 0.05 }) end)

-- refusals
raises("has no discrete Lagrangian of stages", function() dm.discrete_lagrangian(kepler, { rule = "rk4", h = 0.1 }) end)
raises("has no discrete Lagrangian of stages", function() dm.discrete_lagrangian(kepler, { rule = "yoshida(4)", h = 0.1 }) end)
raises("'rule' must be", function() dm.discrete_lagrangian(kepler, { h = 0.1 }) end)
raises("did you mean", function() dm.discrete_lagrangian(kepler, { rule = "gaus(2)", h = 0.1 }) end)
raises("'h'", function() dm.discrete_lagrangian(kepler, { rule = "gauss(2)" }) end)
raises("made with h", function() Ld:solver { h = 1 } end)
raises("has its rule", function() Ld:solver { rule = "verlet" } end)
raises("no formula", function() Ld:emit_c() end)
raises("no stages", function() own:hamilton_pontryagin(q0, q1) end)
-- of a rule that is a formula the message names the same rule with stages
for rule, staged in pairs { midpoint = "gauss(1)", trapezoidal = "galerkin(1, lobatto(2))" } do
  local line = dm.system { Q = dm.R(1), L = function(q, v) return (1 + q[1] ^ 2) * v[1] ^ 2 / 2 end }
  local short = dm.discrete_lagrangian(line, { rule = rule, h = 0.1 })
  local long = dm.discrete_lagrangian(line, { rule = staged, h = 0.1 })
  raises(staged, short.hamilton_pontryagin, short, { 0.2 }, { 0.3 })
  near(short({ 0.2 }, { 0.3 }), long({ 0.2 }, { 0.3 }), 1e-16, "  which has the same value")
end
raises("q0", function() Ld({ 1 }, q1) end)
raises("inside the domain", function() Ld({ 0, 0 }, { 0, 0 }) end)
raises("p0 with the position q0", function() flow:run { q = q0, p0 = q1, steps = 1 } end)

-- an Ld that is not defined where q0 = q1: 1/(q2 - q1) = 1/(q1 - q0) - h q1
local apart = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h) return -math.log(b[1] - a[1]) + h * a[1] ^ 2 / 2 end }
local line = dm.solver({ apart }):run { q0 = { 1 }, q1 = { 1.1 }, steps = 2 }
near(line.q[2][1], 1.1, 1e-15, "a start from two positions knows where its first step leads")
near(line.q[3][1], 1.1 + 1 / (10 - 0.11), 1e-14, "and the next one goes on from there")
near(dm.solver({ apart }):step({ 1 }, { 1.1 })[1], 1.1 + 1 / (10 - 0.11), 1e-14, "so does a single step")

-- momentum of a closed Ld whose term is not symmetric: a random walk of round-off, not a drift
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
for _, e in ipairs { 0.01, 1 } do
  local closed = dm.discrete_lagrangian { Q = dm.R(2), h = 0.05, Ld = function(a, b, h)
    local q, v, r = (a + b) / 2, (b - a) / h, a:norm()
    return h * (v:dot(v) / 2 + 1 / q:norm() + e * h ^ 2 * (r + a:dot(b) / r) / 2)
  end }
  local steps = 1e5
  local path = dm.solver { closed }:run { q = { 0.6, 0 }, p = { 0, 1.3 }, steps = steps, every = 500 }
  local off = path:drift(path:momentum(turn)).largest
  ok(off < 5e-14, "del keeps J of an Ld that is not symmetric", off)
end

-- the report counts matrices: del takes the exact one at its iterates, at least one a step
local swing = dm.solver { dm.discrete_lagrangian { Q = dm.R(1), h = 0.1,
  Ld = function(a, b, h) return h * (((b[1] - a[1]) / h) ^ 2 / 2 + dm.cos((a[1] + b[1]) / 2)) end } }
swing:run { q = { 1 }, p = { 0 }, steps = 100 }
local cost = swing:report()
ok(cost.matrices >= 100 and cost.matrices <= cost.newton, "matrices of del are counted", cost.matrices, cost.newton)
-- coefficients of D1 and of D1 + D2 are the same to the bit, or J drifts by their difference in every step: 0.002 and 0.1/3 would be
-- taken out of sums in which the other has no exact quotient (6e-19 a step)
local uneven = dm.solver { dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(a, b, h)
  return (b - a):dot(b - a) * 4 - h * (2 * a:dot(a) + b:dot(b)) / 6 + 0.002 * a:dot(b) / a:norm()
end } }
local drift = 0
for k = 1, 4 do
  local turned = uneven:run { q = { 0.5 + 0.1 * k, 0.1 }, p = { -0.1, 0.7 + 0.05 * k }, steps = 1e5, every = 1e3 }
  drift = drift + turned:drift(turned:momentum(dm.SO(2))).per_time * 0.1 / 4
end
tap.ok(math.abs(drift) < 1e-19, "an Ld with uneven coefficients keeps J", drift)
tap.done()
