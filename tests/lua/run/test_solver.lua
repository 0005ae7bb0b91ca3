-- dm.solver and dm.path as a script sees them: starts, recording, quantities, failures, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, sqrt, abs = math.sin, math.cos, math.sqrt, math.abs

local kepler = dm.system { name = "Kepler", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { 0.4, 0 }, v = { 0, 2 } }

-- recording
local path = kepler:solver { rule = "verlet", h = 0.01 }:run { q = start.q, v = start.v, steps = 25, every = 10 }
ok(#path == 4, "start, every tenth step and the end are kept", #path)
near(path.t[4], 0.25, 1e-16, "the last row is the end"); near(path.t[3], 0.2, 1e-16, "t = t0 + k h")
ok(path.q[1][1] == 0.4 and path.p[1][2] == 2, "the first row is the start")
ok(table.concat(path.columns, " ") == "t q1 q2 p1 p2", "columns are named")
ok(path:column "q1"[4] == path.q[4][1], "a column by its name")
ok(path.q[5] == nil, "one past the end is nil, so that ipairs stops")
local count = 0
for _ in ipairs(path.q) do count = count + 1 end
ok(count == 4, "ipairs over a column")
near(path:velocity()[1][2], 2, 0, "velocity from momentum")
ok(#path:velocity(4) == 2 and (path:velocity(4) - path:velocity()[4]):norm() < 1e-15, "of one row")
ok(not pcall(path.velocity, path, 5) and not pcall(path.velocity, path, 0), "there are no other rows")
do -- m(q) = (1 + q1^2) and 1 along v = (v1, v2)
  local bent = dm.system { Q = dm.R(2), L = function(q, v) return ((1 + q[1] ^ 2) * v[1] ^ 2 + v[2] ^ 2) / 2 + q[2] end }
  local M = bent:solver({ rule = "midpoint", h = 0.1 }):run({ q = { 0.5, 0 }, v = { 0, 1 }, steps = 3 }):mass { 2, 0 }
  ok(M[1][1] == 5 and M[2][2] == 1 and M[1][2] == 0, "the mass at a place by the kernels of the run", M)
  local inside = dm.system { Q = dm.R(1), L = function(q, v) return math.log(q[1]) * v[1] ^ 2 / 2 end }
  local short = inside:solver({ rule = "midpoint", h = 0.01 }):run { q = { 2 }, v = { 1 }, steps = 3 }
  raises("not finite at this q", function() short:mass { -1 } end)
end
ok(tostring(path):find "25 steps of verlet", "a path prints itself as a sentence", tostring(path))
local none = kepler:solver { rule = "verlet", h = 0.01 }:run { q = start.q, v = start.v, steps = 0 }
ok(#none == 1 and none.t[1] == 0, "no steps: the start alone")
local shifted = kepler:solver { rule = "verlet", h = 0.01 }:run { q = start.q, v = start.v, t = 0.245, t0 = 5 }
ok(#shifted == 26 and abs(shifted.t[26] - 5.25) < 1e-14, "a duration is covered by whole steps", shifted.t[#shifted])

-- the three ways to start agree
for _, rule in ipairs { "verlet", "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)" } do
  local solver = kepler:solver { rule = rule, h = 0.01 }
  local a = solver:run { q = start.q, v = start.v, steps = 50 }
  local b = solver:run { q = start.q, p = start.v, steps = 50 }
  local c = solver:run { q0 = a.q[1], q1 = a.q[2], steps = 50 }
  ok(a.q[51] == b.q[51], rule .. ": q, v = q, p")
  near((a.q[51] - c.q[51]):norm(), 0, 2e-12, rule .. ": q0, q1 starts the same path")
end

-- the same numbers by plain hand-written Verlet
local x, y, vx, vy, h = 0.4, 0, 0, 2, 0.01
for _ = 1, 100 do
  local r3 = (x * x + y * y) ^ 1.5
  vx, vy = vx - h / 2 * x / r3, vy - h / 2 * y / r3
  x, y = x + h * vx, y + h * vy
  r3 = (x * x + y * y) ^ 1.5
  vx, vy = vx - h / 2 * x / r3, vy - h / 2 * y / r3
end
path = kepler:solver { rule = "verlet", h = h }:run { q = start.q, v = start.v, steps = 100 }
near(path.q[101][1], x, 1e-13, "Verlet is Verlet, q1"); near(path.p[101][2], vy, 1e-13, "and p2")

-- Noether
path = kepler:solver { rule = "midpoint", h = 0.05 }:run { q = start.q, v = start.v, steps = 1000 }
local J = path:momentum(dm.SO(2))
local mine = path:momentum(function(q) return { -q[2], q[1] } end)
near(J[1], 0.8, 1e-15, "angular momentum of the start")
ok(J == mine, "a generator written in Lua gives the same momentum")
local worst = 0
for i = 1, #J do worst = math.max(worst, abs(J[i] - 0.8)) end
ok(worst < 1e-13, "midpoint keeps it to round-off", worst)
local three = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local cross = three:solver { rule = "verlet", h = 0.05 }:run { q = { 1, 0.2, 0.3 }, v = { 0, 0.9, 0.1 }, steps = 3 }
local M = cross:momentum(dm.SO(3))
near(M[1][1], 0.2 * 0.1 - 0.3 * 0.9, 1e-16, "SO(3): q x p, first component"); near(M[1][3], 0.9, 1e-16, "third component")
near(cross:momentum(dm.SO(2))[1], 0.9, 1e-16, "SO(2) on R^3 turns about the third axis")

-- coordinates that do not turn so: the kinetic energy tells, and what has the symmetry or a constant mass is taken
local polar = dm.system { Q = dm.R(2), coordinates = { "r", "phi" }, L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
local turned = polar:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 1, 0 }, v = { 0.1, 1 }, steps = 40 }
raises("turns coordinates as those of points in space", turned.momentum, turned, dm.SO(2))
raises("function(q) return { 0, 1 } end", turned.momentum, turned, dm.SE(2))
ok(turned:momentum(function() return { 0, 1 } end) == turned.p_phi and turned:momentum(dm.R(2))[3][2] == turned.p[3][2], "by its generator, or of shifts")
near(turned:momentum(function(q) return { -q[2], q[1] } end)[1], 1, 1e-15, "a generator is taken as it is given")
local bowl = function(skew) -- a bead in z = (x^2 + (1 + skew) y^2)/2, of x and y
  return dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + (q[1] * v[1] + (1 + skew) * q[2] * v[2]) ^ 2 / 2 - q:dot(q) / 2 end }
    :solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 1, 0.2 }, v = { 0.1, 1 }, steps = 40 }
end
local round = bowl(0)
near(round:momentum(dm.SO(2))[1], round.q[1][1] * round.p[1][2] - round.q[1][2] * round.p[1][1], 1e-15, "a mass that turns along")
ok(round:drift(round:momentum(dm.SO(2))).largest < 1e-12, "  whose momentum stays")
raises("the kinetic energy of this system is not the same", function() bowl(0.5):momentum(dm.SO(2)) end)
local fast = dm.system { Q = dm.R(3), L = function(q, v) return -dm.sqrt(1 - v:dot(v)) + 1 / q:norm() end }
  :solver({ rule = "gauss(3)", h = 0.05 }):run { q = { 3, 0.2, 0.1 }, v = { 0.1, 0.4, 0.2 }, steps = 40 }
ok(fast:drift(fast:momentum(dm.SO(3)):column(3)).largest < 1e-12, "a mass of the velocity")

-- drift: a damped-looking explicit method drifts, a symplectic one does not
local rk = kepler:solver { rule = "rk4", h = 0.05 }:run { q = start.q, v = start.v, steps = 20000, every = 10 }:drift "energy"
local sy = kepler:solver { rule = "verlet", h = 0.01 }:run { q = start.q, v = start.v, steps = 100000, every = 10 }:drift "energy"
ok(abs(rk.per_time) > 10 * rk.error and rk.per_time < 0, "RK4 loses energy, and the drift says so", rk.per_time)
ok(abs(sy.per_time) < 5 * sy.error + 1e-12, "Verlet does not", sy.per_time .. " +- " .. sy.error)

-- a user's own discrete Lagrangian
local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(q0, q1, h)
  local v, m = (q1[1] - q0[1]) / h, (q0[1] + q1[1]) / 2
  return h * (v ^ 2 / 2 - m ^ 2 / 2)
end }
-- -D1 = (q1 - q0)/h + h (q0 + q1)/4,  D2 = (q1 - q0)/h - h (q0 + q1)/4
near(Ld:legendre_minus({ 1 }, { 1.2 })[1], 2 + 0.055, 1e-14, "p0 = -D1 Ld")
near(Ld:legendre_plus({ 1 }, { 1.2 })[1], 2 - 0.055, 1e-14, "p1 = D2 Ld")
near(Ld:two_form({ 1 }, { 1.2 })[1][1], 10 + 0.025, 1e-13, "-D1D2 Ld")
near(Ld({ 1 }, { 1.2 }), 0.1 * (2 - 1.21 / 2), 1e-15, "the value of Ld")
-- linear: q2 = 2 c q1 - q0 with c = (1 - h^2/4)/(1 + h^2/4)
local c = (1 - 0.0025) / (1 + 0.0025)
near(dm.solver { Ld }:step({ 1 }, { 1.2 })[1], 2 * c * 1.2 - 1, 1e-14, "discrete Euler-Lagrange step in closed form")
path = dm.solver { Ld }:run { q0 = { 1 }, q1 = { 1.2 }, steps = 2 }
near(path.q[3][1], 2 * c * 1.2 - 1, 1e-14, "run from two positions")
-- its order on the pendulum, against gauss(6) of the same L
local swing = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
local goal = swing:solver { rule = "gauss(6)", h = 0.01 }:run { q = { 1.2 }, v = { 0.5 }, steps = 200 }.q[201][1]
local off = {}
for i, n in ipairs { 100, 200 } do
  local own = dm.discrete_lagrangian { Q = dm.R(1), h = 2 / n, Ld = function(q0, q1, h)
    local u = (q1[1] - q0[1]) / h
    return h * (u ^ 2 / 2 + (cos(q0[1]) + cos(q1[1])) / 2)
  end }
  off[i] = abs(dm.solver { own }:run { q = { 1.2 }, p = { 0.5 }, steps = n }.q[n + 1][1] - goal)
end
near(math.log(off[1] / off[2], 2), 2, 0.05, "a trapezoidal Ld of one's own has order 2")
local composed = dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.02 })
local a = dm.solver { composed }:run { q = start.q, p = start.v, steps = 300 }
local b = kepler:solver { rule = "midpoint", h = 0.02 }:run { q = start.q, v = start.v, steps = 300 }
near((a.q[301] - b.q[301]):norm(), 0, 1e-12, "composed from a system = the built-in rule")
near(composed:momentum(dm.SO(2), { 1, 0 }, { 1, 0.1 })[1], composed:momentum(dm.SO(2), { 0, 1 }, { -0.1, 1 })[1], 1e-14, "discrete momentum is invariant")

-- hyper-dual and traced give the same path
local function model(mode) return dm.system { Q = dm.R(2), derivatives = mode, L = function(q, v) return v:dot(v) / 2 * (1 + q[1] ^ 2 / 10) - cos(q[1]) * sin(q[2]) end } end
for _, rule in ipairs { "verlet", "gauss(2)", "rk4" } do
  local e = model "exact":solver { rule = rule, h = 0.05 }:run { q = { 0.3, 0.1 }, v = { 0.5, -0.2 }, steps = 100 }
  local d = model "hyperdual":solver { rule = rule, h = 0.05 }:run { q = { 0.3, 0.1 }, v = { 0.5, -0.2 }, steps = 100 }
  near((e.q[101] - d.q[101]):norm(), 0, 1e-13, rule .. ": hyper-dual = traced")
end

-- failures carry what was computed
-- L = v^2/2 + exp q: the midpoint velocity V = v0 + (h/2) exp(q0 + h V/2) has no root for h = 2, v0 = q0 = 0
local steep = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.exp(q[1]) end }
local fine, failure = pcall(function() return steep:solver { rule = "midpoint", h = 2 }:run { q = { -9 }, v = { 0 }, steps = 1000 } end)
ok(not fine and failure.code == "no_convergence" and failure.step >= 1 and #failure.path == failure.step, "no convergence: code, step and path", failure)
ok(tostring(failure):find "try", "and what to try")
local bowl = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + sqrt(1 - q[1] ^ 2) end }
fine, failure = pcall(function() return bowl:solver { rule = "verlet", h = 0.05 }:run { q = { 0 }, v = { 10 }, steps = 100 } end)
ok(not fine and failure.code == "not_finite" and #failure.path >= 1, "leaving the domain: not_finite", failure)
local far, line = bowl:solver { rule = "verlet", h = 0.05 }, nil
fine, failure = pcall(function() line = debug.getinfo(1, "l").currentline; local path = far:run { q = { 0 }, v = { 10 }, steps = 100 }; return path end)
ok(tostring(failure):find("test_solver.lua:" .. line .. ": verlet", 1, true), "a failure names the line of the script", failure)
fine, failure = pcall(function() local path = far:run { stps = 1 }; return path end)
ok(tostring(failure):find("test_solver.lua:" .. line + 2 .. ": unknown", 1, true), "misuse too", failure)
fine, failure = pcall(function() return far:run { q = { 0 }, v = { 10 }, steps = 100 } end)
for i = 1, #failure.path do ok(failure.path.q[i][1] == failure.path.q[i][1], "row " .. i .. " of the kept path is finite") end

-- cancellation inside L makes the residual noisier than its terms tell: converged steps are not refused
for _, case in ipairs { { 1e4, 0.05, "gauss(2)" }, { 1e4, 0.05, "gauss(3)" }, { 1e5, 0.01, "gauss(2)" } } do
  local stiff = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - case[1] / 2 * (q:norm() - 1) ^ 2 - 9.8 * q[2] end }
  local done, stopped = pcall(function() return stiff:solver { rule = case[3], h = case[2] }:run { q = { 1, 0 }, v = { 0, 0 }, steps = 5000, every = 5000 } end)
  ok(done, ("stiff spring k = %g, h = %g, %s runs on"):format(table.unpack(case)), stopped)
end

-- an error inside the user's function during a run is the user's own error
local calls, own = 0, setmetatable({}, { __tostring = function() return "mine" end })
local moody = dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v) calls = calls + 1; if calls > 50 then error(own) end return v[1] ^ 2 / 2 - q[1] ^ 2 end }
fine, failure = pcall(function() return moody:solver { rule = "verlet", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 1000 } end)
ok(not fine and rawequal(failure, own), "the user's own error object comes back", failure)

-- misuse
local good = kepler:solver { rule = "verlet", h = 0.01 }
raises("field 'h'", function() kepler:solver { rule = "verlet" } end)
raises("field 'h'", function() kepler:solver { rule = "verlet", h = -1 } end)
raises("rule", function() kepler:solver { h = 1 } end)
raises("did you mean 'verlet'", function() kepler:solver { rule = "verlat", h = 1 } end)
raises("gauss", function() kepler:solver { rule = "gauss(0)", h = 1 } end)
raises("gauss", function() kepler:solver { rule = "gauss", h = 1 } end)
raises("rule", function() kepler:solver { rule = "gauss(2", h = 1 } end)
raises("del", function() kepler:solver { rule = "del", h = 1 } end)
raises("did you mean", function() kepler:solver { rule = "verlet", h = 1, newtno = {} } end)
raises("tolerance", function() kepler:solver { rule = "verlet", h = 1, newton = { tolerance = -1 } } end)
raises("backend", function() kepler:solver { rule = "verlet", h = 1, backend = "quantum" } end)
raises("steps", good.run, good, { q = start.q, v = start.v })
raises("steps", good.run, good, { q = start.q, v = start.v, steps = -1 })
raises("steps", good.run, good, { q = start.q, v = start.v, steps = 0 / 0 })
raises("every", good.run, good, { q = start.q, v = start.v, steps = 1, every = 0 })
raises("'v'", good.run, good, { q = start.q, steps = 1 })
raises("mixture", good.run, good, { q = start.q, q0 = start.q, q1 = start.q, steps = 1 })
raises("q1", good.run, good, { q0 = start.q, steps = 1 })
raises("q", good.run, good, { q = { 0.4, "x" }, v = start.v, steps = 1 })
raises("q", good.run, good, { q = { 0.4, 0 / 0 }, v = start.v, steps = 1 })
raises("memory", good.run, good, { q = start.q, v = start.v, steps = 10 ^ 13 })
raises("no velocity", function() dm.solver { Ld }:run { q = { 1 }, v = { 0 }, steps = 1 } end)
raises("no column 'q7'", path.column, path, "q7")
raises("no energy", function() return a:energy() end)
raises("rows 1 to", function() return path.q[99] end)
raises("row number", function() return path.q.x end)
raises("block", function() return dm.system { Q = dm.R(6), L = function(q, v) return v:dot(v) / 2 end }:solver { rule = "verlet", h = 1 }:run { q = { 1, 2, 3, 4, 5, 6 }, v = { 1, 2, 3, 4, 5, 6 }, steps = 1 }:momentum(dm.SO(2)) end)
raises("degenerate", function() return dm.system { Q = dm.R(2), L = function(q, v) return q[1] * v[2] - q[2] ^ 2 end }:solver { rule = "midpoint", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 0 }, steps = 1 } end)
raises("not both", good.run, good, { q = start.q, v = start.v, at = { 1 }, every = 2 })
raises("too many", good.run, good, { q = start.q, v = start.v, t = 1e300 })
raises("max_iterations", function() kepler:solver { rule = "verlet", h = 1, newton = { max_iterations = 2 ^ 31 } } end)
local function odd(L) return function() dm.system({ Q = dm.R(1), derivatives = "hyperdual", L = L }):solver({ rule = "midpoint", h = 0.01 }):run { q = { 1 }, v = { 0 }, steps = 1 } end end
raises("NaN at the start", odd(function(q, v) return v[1] ^ 2 / 2 - math.log(q[1] - 2) end))
raises("random", odd(function(q, v) return v[1] ^ 2 / 2 + math.random() end))
ok(tostring(good):find "solver 'verlet', order 2, h = 0.01, for system 'Kepler'", "a solver prints itself", tostring(good))
raises("report", function() return kepler:solver { rule = "verlet", h = 1 }:report() end)
good:run { q = start.q, v = start.v, steps = 10 }
local report = good:report()
ok(report.steps == 10 and report.operations > 0 and report.compile_ms > 0 and report.order == 2, "the report of a run")
ok(#dm.rules() >= 8, "dm.rules lists the rules", #dm.rules())
-- steps so long that Newton's method fails from its first guess are found by continuation in h: roots of the step equation
local humps = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + 5 * cos(q[1]) + cos(3 * q[1]) end }
math.randomseed(1)
local found, off = 0, 0
for _ = 1, 200 do
  local step, q, v = 0.3 + 2 * math.random(), { 4 * math.random() - 2 }, { 4 * math.random() - 2 }
  local one = humps:solver { rule = "midpoint", h = step }
  local fine, Q, P = pcall(one.step, one, { q = q, v = v })
  if fine then
    local middle = (Q[1] + q[1]) / 2
    found = found + 1
    off = math.max(off, abs(P[1] - v[1] + step * (5 * sin(middle) + 3 * sin(3 * middle))), abs((Q[1] - q[1]) / step - (P[1] + v[1]) / 2))
  end
end
ok(found > 185, "long midpoint steps: nearly all are solved", found)
ok(off < 1e-12, "and solve the equation of the step", off)

-- errors of runs name the line of the script: of a string, of a failure with a path, and not at all where a module called
local function line() return debug.getinfo(2, "l").currentline end
local here
local _, word = pcall(function()
  here = line() + 1
  local p = kepler:solver { rule = "verlet", h = 0.1 }:run { q = start.q, v = start.v, stepz = 3 }
  return p
end)
ok(word:find(("test_solver.lua:%d: unknown field 'stepz'"):format(here), 1, true), "misuse of run is told with the line that called", word)
local quick = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 3 / 3 end }
local _, lost = pcall(function()
  here = line() + 1
  local p = quick:solver { rule = "midpoint", h = 3 }:run { q = { 1 }, v = { 0 }, steps = 3 }
  return p
end)
ok(lost.code == "no_convergence" and lost.message:find(("test_solver.lua:%d: midpoint"):format(here), 1, true), "and so is a run that fails", lost)

-- Newton's method of a stage rule begins near the root: where motion is smooth on the scale of h, with differences of six steps, an
-- error of h^7 or so is left, squared by the first increment and again by the second; from the polynomial of one step alone it took 5
local turning = dm.system { Q = dm.R(2), L = function(q, v)
  local r2 = q[1] ^ 2 + q[2] ^ 2
  return (v[1] ^ 2 + v[2] ^ 2) * (1 + r2 / 10) / 2 - r2 / 2
end }
for _, rule in ipairs { "gauss(1)", "lobatto(3)" } do
  local solver = turning:solver { rule = rule, h = 0.05 }
  local path = solver:run { q = { 1, 0 }, v = { 0, 0.5 }, steps = 4000, every = 4000 }
  local q, p, worst = path.q, path.p, 0
  for i = 1, #path do worst = math.max(worst, math.abs(q[i][1] * p[i][2] - q[i][2] * p[i][1] - 0.55)) end
  tap.ok(solver:report().newton_per_step < 3.5, rule .. ": three iterations a step, or hardly more", solver:report().newton_per_step)
  tap.ok(worst < 1e-14, "  and the angular momentum stays", worst)
end

-- what a run counts: a matrix of h alone is taken once, a composition solves an equation for each of its parts
local springs = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 - q[1] * q[2] / 4 end }
local function counts(system, rule)
  local solver = system:solver { rule = rule, h = 0.05 }
  solver:run { q = { 1, 0.3 }, v = { 0, 0.2 }, steps = 100 }
  return solver:report()
end
local linear, bent = counts(springs, "curve(rk4)"), counts(turning, "curve(rk4)")
tap.ok(linear.matrices == 1 and linear.solves == 100 and linear.newton >= 100, "a linear system: one matrix for all steps of a curve", linear.matrices)
tap.ok(bent.matrices > 1 and bent.matrices < bent.newton, "another takes some of its iterations with a new one", bent.matrices)
tap.ok(counts(springs, "yoshida(4, midpoint)").solves == 300, "three step equations in each step of yoshida(4)")
-- what a printed path says of the energy: an oscillation of verlet's energy that every = 628 rows alias
-- (w = 1, 2, all but 628 h = 20 pi) is not called a drift; rk4 loses, and that is one
local two = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 - q[1]^2/2 - 2*q[2]^2 end }
local function said(rule, every)
  local solver = two:solver { rule = rule, h = 0.1 }
  return tostring(solver:run { q = {1, 0}, v = {0, 0}, steps = 62800, every = every })
end
ok(said("verlet", 1):find "energy off by 0%.0012, no drift; 62801 rows", "all rows: no drift")
local sparse = said("verlet", 628)
ok(not sparse:find ", drift " and sparse:find "at these rows, slope .* oscillation faster than the rows",
  "aliased rows: no drift is claimed, and whose the energy is", sparse)
ok(said("rk4", 1):find "drift %-", "  what drifts is said to")

-- many columns of one function: names are told apart by a table
local many = kepler:solver { rule = "verlet", h = 0.1 }:run { q = start.q, v = start.v, steps = 2,
  watch = { a = function(q) return dm.zeros(50000) + q[1] end } }
ok(#many.columns == 50001 and many.columns[50001] == "a50000" and many.a50000[3] == many.a1[3], "50000 columns")
raises("there is a column 'a2' already", function()
  kepler:solver { rule = "verlet", h = 0.1 }:run { q = start.q, v = start.v, steps = 2, watch = { a2 = function(q) return q[1] end,
    a = function(q) return { q[1], q[2] } end } }
end)
tap.done()
