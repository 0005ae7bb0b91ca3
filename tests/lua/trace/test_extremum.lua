-- dm.extremum: the derivatives of a stationary value are those of the formula; wrong hints are refused
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin = math.cos, math.sin

-- f(q, v, y) = y . M y/2 + b . y + rest, stationary at y = -M^-1 b, two unknowns that depend on q and v
local function parts(q, v)
  local a, b, c = 2 + cos(q[1]), 0.3 * q[2], 1.5 + q[2] ^ 2
  return a, b, c, v[1] * q[2] + sin(q[1]), v[2] - q[1] * v[1]
end
local function f(q, v, y, t)
  local a, b, c, d, e = parts(q, v)
  return (a * y[1] ^ 2 + 2 * b * y[1] * y[2] + c * y[2] ^ 2) / 2 + d * y[1] + e * y[2]
    + 2 * v:dot(v) - q:dot(q) / 2 + 0.1 * cos(t) * q[1]
end
local function solution(q, v)
  local a, b, c, d, e = parts(q, v)
  local det = a * c - b * b
  return { (b * e - c * d) / det, (b * d - a * e) / det }
end
local function formula(q, v, t)
  local y = solution(q, v)
  return f(q, v, dm.vector(y), t)
end
local plain = dm.system { Q = dm.R(2), L = formula }
local hinted = dm.system { Q = dm.R(2), L = function(q, v, t)
  return dm.extremum(formula(q, v, t), f, solution(q, v), q, v)
end }
local q, v = { 0.4, -0.3 }, { 0.2, 0.5 }
near((plain:momentum(q, v, 0.7) - hinted:momentum(q, v, 0.7)):norm(), 0, 1e-15, "the same momentum")
local A, B, worst = plain:mass(q, v, 0.7), hinted:mass(q, v, 0.7), 0
for i = 1, 2 do for k = 1, 2 do worst = math.max(worst, math.abs(A[i][k] - B[i][k])) end end
ok(worst < 1e-15, "the same mass", worst)
for _, rule in ipairs { "gauss(1)", "gauss(3)", "lobatto(3)", "midpoint" } do
  local a = plain:solver({ rule = rule, h = 0.05 }):run { q = q, v = v, steps = 100 }
  local b = hinted:solver({ rule = rule, h = 0.05 }):run { q = q, v = v, steps = 100 }
  ok((a.q[101] - b.q[101]):norm() < 1e-13, rule .. ": the same path", (a.q[101] - b.q[101]):norm())
  local c = hinted:solver({ rule = rule, h = 0.05, backend = "tape" }):run { q = q, v = v, steps = 100 }
  ok(c.q[101] == b.q[101] and c.p[101] == b.p[101], rule .. ": the same bits on the tape")
end
local one, two = plain:solver { rule = "gauss(1)", h = 0.1 }, hinted:solver { rule = "gauss(1)", h = 0.1 }
one:run { q = q, v = v, steps = 10 }
two:run { q = q, v = v, steps = 10 }
ok(two:report().operations < one:report().operations, "with fewer operations", two:report().operations)
local M, N = one:tangent { q = q, v = v, steps = 5 }, two:tangent { q = q, v = v, steps = 5 }
worst = 0
for i = 1, 4 do for k = 1, 4 do worst = math.max(worst, math.abs(M[i][k] - N[i][k])) end end
ok(worst < 1e-14, "the tangent map sees the formula", worst)

-- one unknown: sweeps evaluate the force as a polynomial in y, and eliminate M times f_yy
local function single(sign, unit)
  local function g(x, w, y, t) -- f_yy = sign (2 + cos x1), M of w positive definite at its y
    return unit * (sign * (2 + cos(x[1])) * y[1] ^ 2 / 2 + (0.4 * w[1] * x[2] - 0.3 * w[3] + 0.2 * sin(x[3]) + 0.1 * cos(t)) * y[1]
      + 2 * w:dot(w) + 0.3 * cos(x[2]) * w[1] * w[2] + 0.2 * x[1] * w[3] - x:dot(x) / 2 - 0.1 * x[1] ^ 2 * x[3])
  end
  local function at(x, w, t)
    return { -sign * (0.4 * w[1] * x[2] - 0.3 * w[3] + 0.2 * sin(x[3]) + 0.1 * cos(t)) / (2 + cos(x[1])) }
  end
  local function value(x, w, t) return g(x, w, dm.vector(at(x, w, t)), t) end
  return dm.system { Q = dm.R(3), L = value }, dm.system { Q = dm.R(3), L = function(x, w, t)
    return dm.extremum(value(x, w, t), g, at(x, w, t), x, w)
  end }
end
local function same_paths(rule, L, R, start, size, what)
  local a = L:solver({ rule = rule, h = 0.05 }):run(start)
  local solver = R:solver { rule = rule, h = 0.05 }
  local b = solver:run(start)
  local last = #b.t
  local apart = math.max((a.q[last] - b.q[last]):norm(), (a.p[last] - b.p[last]):norm() / size)
  ok(apart < 1e-13, rule .. ": the same path, " .. what, apart)
  local c = R:solver({ rule = rule, h = 0.05, backend = "tape" }):run(start)
  ok(c.q[last] == b.q[last] and c.p[last] == b.p[last], rule .. ": the same bits on the tape, " .. what)
  local members = solver:ensemble { members = 9, q = function(i) return i == 4 and start.q or dm.vector(start.q) * (1 - 0.01 * i) end, v = function() return start.v end, steps = start.steps }
  ok(members.q[4] == b.q[last] and members.p[4] == b.p[last], rule .. ": the same bits in an ensemble, " .. what)
  return solver:report().newton_per_step
end
local begin = { q = { 0.4, -0.3, 0.2 }, v = { 0.2, 0.5, -0.1 }, steps = 100 }
for _, rule in ipairs { "gauss(2)", "gauss(3)", "gauss(5)" } do
  local L, R = single(1, 1)
  ok(same_paths(rule, L, R, begin, 1, "one unknown") < 12, rule .. ": by sweeps")
  same_paths(rule, single(-1, 1), select(2, single(-1, 1)), begin, 1, "f_yy negative")
end
for _, unit in ipairs { 1e-60, 1e60, 1e-120, 1e120 } do -- pivots out of range are left to Newton's method
  local L, R = single(1, unit)
  same_paths("gauss(3)", L, R, begin, unit, ("in units of %g"):format(unit))
end
-- a square of y that depends on v: no polynomial, though L is quadratic in v at its y
local bent = function(x, w, y) return (y[1] - w[1] ^ 2) ^ 2 / 2 + (2 + x[2] ^ 2) * w[1] ^ 2 + w[2] ^ 2 - x:dot(x) / 2 end
local straight = function(x, w) return (2 + x[2] ^ 2) * w[1] ^ 2 + w[2] ^ 2 - x:dot(x) / 2 end
same_paths("gauss(3)", dm.system { Q = dm.R(2), L = straight }, dm.system { Q = dm.R(2), L = function(x, w)
  return dm.extremum(straight(x, w), bent, { w[1] ^ 2 }, x, w)
end }, { q = q, v = v, steps = 100 }, 1, "not quadratic in (v, y)")

-- functions that are only known by an equation: the formula alone, one stage after the other in every backend
local depth = dm.root { name = "depth", start = 0, equations = function(z, x) return z + 0.2 * sin(z) - 0.3 * x end }
local turning = dm.system { Q = dm.R(3), L = function(x, w)
  return (1 + 0.3 * cos(x[2]) + depth(x[3]) ^ 2) * (w[1] + 0.2 * w[2]) ^ 2 / 2 + w[2] ^ 2 / 2 + w[3] ^ 2 - x[2] ^ 2 / 2 - x[3] ^ 2
end }
local shape = turning:routh { cyclic = { 1 }, q = begin.q, v = begin.v }
local x, u = shape:start(begin.q, begin.v)
for _, rule in ipairs { "gauss(2)", "gauss(3)" } do
  local a = turning:solver({ rule = rule, h = 0.05 }):run(begin)
  local b = shape:solver({ rule = rule, h = 0.05 }):run { q = x, v = u, steps = 100 }
  local apart = math.max(math.abs(a.q[101][2] - b.q[101][1]), math.abs(a.q[101][3] - b.q[101][2]))
  ok(apart < 1e-13, rule .. ": an implicit function in a reduced system", apart)
  for name, s in pairs { unreduced = { turning, begin, a }, reduced = { shape, { q = x, v = u, steps = 100 }, b } } do
    local c = s[1]:solver({ rule = rule, h = 0.05, backend = "tape" }):run(s[2])
    ok(c.q[101] == s[3].q[101] and c.p[101] == s[3].p[101], rule .. ": the same bits on the tape, " .. name)
  end
end

-- numbers pass through, and so does a value of another function
near(dm.extremum(3, f, { 1, 2 }, { 1, 1 }, { 1, 1 }), 3, 0, "a number is itself")
near(dm.trace(function(x) return dm.extremum(x[1] ^ 2, f, { x[1] }, x, x) end, 2)({ 3, 0 }), 9, 0, "and so is a value outside of a Lagrangian")

raises("not stationary", function()
  dm.system { Q = dm.R(1), L = function(x, w) return dm.extremum(w[1] ^ 2 + 1, function(_, u, y) return u[1] ^ 2 + y[1] end, { 1 }, x, w) end }
end)
raises("where the value is", function()
  dm.system { Q = dm.R(1), L = function(x, w) return dm.extremum(w[1] ^ 2, function(_, u, y) return u[1] ^ 2 + y[1] ^ 2 + 1 end, { 0 }, x, w) end }
end)
raises("a list of 1 to 64", function() dm.extremum(1, f, {}, { 1 }, { 1 }) end)
raises("number expected", function() dm.extremum("x", f, { 1 }, { 1 }, { 1 }) end)

tap.done()
