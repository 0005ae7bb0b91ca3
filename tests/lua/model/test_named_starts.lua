-- positions, velocities and momenta by the names of coordinates, wherever a start is given
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local kepler = dm.system { Q = dm.R(2), coordinates = { "x", "y" }, L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local plain = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local q, v, Q, V = { 1, 0 }, { 0.1, 1.1 }, { y = 0, x = 1 }, { x = 0.1, y = 1.1 }
local solver = kepler:solver { rule = "verlet", h = 0.05 }

local list, named = solver:run { q = q, v = v, steps = 20 }, solver:run { q = Q, v = V, steps = 20 }
ok(list.q[21] == named.q[21] and list.p[21] == named.p[21], "a run by names is the run by lists")
ok(Q.x == 1 and Q[1] == nil, "and what was given stays as it was")
ok(solver:run({ q = q, p = { x = 0.1, y = 1.1 }, steps = 20 }).q[21] == list.q[21], "momenta too, beside a list")
ok(solver:run({ q0 = { x = 1, y = 0 }, q1 = { x = 1, y = 0.05 }, steps = 3 }).q[4] == solver:run({ q0 = { 1, 0 }, q1 = { 1, 0.05 }, steps = 3 }).q[4],
  "and two positions")
ok(solver:run({ q0 = Q, p0 = V, steps = 2 }).q[3] == solver:run({ q0 = q, p0 = v, steps = 2 }).q[3], "q0 and p0")
ok(solver:step { q = Q, v = V } == solver:step { q = q, v = v }, "a step")
local own = plain:solver({ rule = "verlet", h = 0.05 }):run { q = { q1 = 1, q2 = 0 }, v = { q1 = 0.1, q2 = 1.1 }, steps = 20 }
ok(own.q[21] == list.q[21], "q1, q2 where there are no names")
local function ensemble(a, b) return solver:ensemble { members = 2, steps = 20, q = a, v = b } end
ok(ensemble(function() return Q end, { V, v }).q == ensemble({ q, q }, { v, v }).q, "members of an ensemble")

ok(kepler:energy(Q, V) == kepler:energy(q, v) and kepler:momentum(Q, V) == kepler:momentum(q, v), "energy and momentum of a system")
ok(solver:tangent { q = Q, v = V, steps = 5 } == solver:tangent { q = q, v = v, steps = 5 }, "the tangent map")
ok(solver:lyapunov({ q = Q, v = V, steps = 50 }).exponent == solver:lyapunov({ q = q, v = v, steps = 50 }).exponent, "the exponent")
ok(solver:fold({ q = Q, v = V }).h == solver:fold({ q = q, v = v }).h, "the fold")
local rest = dm.system { Q = dm.R(1), coordinates = { "x" }, L = function(x, u) return u[1] ^ 2 / 2 - 2 * x[1] ^ 2 end }
ok(math.abs(rest:linearize({ q = { x = 0 } }).fastest - 2) < 1e-12, "a linearization")
local function map(a, b) return dm.stability { system = kepler, rule = "verlet", q = a, v = b, h = { 0.01, 1 }, steps = 100, refine = false } end
ok(map(Q, V):at(1, 1).error == map(q, v):at(1, 1).error, "a stability map")
ok(#solver:section({ g = "y", q = Q, v = V, t = 30 }).orbits[1].x == #solver:section({ g = "y", q = q, v = v, t = 30 }).orbits[1].x, "a section")
local chart = kepler:chart { q = Q, v = V, t = 2, rules = { "verlet" }, h = { 0.1, 0.05, 0.025 }, repeats = 1 }
ok(math.abs(chart:order "verlet" - 2) < 0.3, "a chart", chart:order "verlet")
local polar = dm.system { Q = dm.R(2), coordinates = { "r", "phi" }, L = function(x, u) return (u[1] ^ 2 + x[1] ^ 2 * u[2] ^ 2) / 2 + 1 / x[1] end }
local reduced = polar:routh { cyclic = { "phi" }, q = { r = 1, phi = 0 }, v = { r = 0, phi = 1.1 } }
ok(reduced:energy({ 1 }, { 0 }) == polar:energy({ 1, 0 }, { 0, 1.1 }), "the momentum of a reduction")
local scene = dm.scene { system = kepler, q = Q, v = V, watch = { "x" }, tolerance = 1e-2, until_t = 2, rules = { "verlet", "gauss(2)" } }
ok(scene:run().error_estimate <= 1e-2, "a scene")

local function run(a, b) return solver:run { q = a, v = b, steps = 1 } end
raises("field 'q': the coordinate 'y' is missing; all of x, y are needed", run, { x = 1 }, v)
raises("field 'v': there is no coordinate 'z'; they are x, y", run, q, { x = 0, y = 1, z = 2 })
raises("field 'q': there is no coordinate 'q", run, { q1 = 0, q2 = 1 }, v)
raises("entry 2 must be a number, got string", run, { x = 1, y = "a" }, v)
raises("field 'q' must have 2 entries (got 0)", run, {}, v)
raises("'v' of member 1: the coordinate 'x' is missing", ensemble, { q, q }, { { y = 1 }, v })
raises("field 'q': the coordinate 'y' is missing", solver.tangent, solver, { q = { x = 1 }, v = v, steps = 5 })
raises("field 'q': there is no coordinate 'z'", solver.lyapunov, solver, { q = { x = 1, y = 0, z = 1 }, v = v, steps = 5 })
tap.done()
