-- errors name the line of the script that called, whoever wraps the method, and say what is wrong
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local solver = kepler:solver { rule = "gauss(2)", h = 0.5 }
local path = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 2 }

local function here() return debug.getinfo(2, "l").currentline end
local function message(f)
  local _, what = pcall(f)
  return tostring(what), what
end
local function told(line, words, f, name)
  local text = message(f)
  ok(text:find("test_misuse.lua:" .. line .. ": " .. words, 1, true) and not text:find("lua/dm/", 1, true), name .. ": the caller's line", text)
end

told(here(), "field 'q' must have 2 entries", function() local _ = solver:run { q = { 1 }, v = { 0, 1 }, steps = 1 } end, "solver:run")
told(here(), "unknown rule 'verlett'", function() local _ = kepler:solver { rule = "verlett", h = 1 } end, "system:solver")
told(here(), "SO(3) has no standard action", function() local _ = path:momentum(dm.SO(3)) end, "path:momentum")
told(here(), "gauss(2): the step equation", function() local _ = solver:run { q = { 0.1, 0 }, v = { 0, 0 }, t = 10 } end, "a failure")
local function go(q) return solver:run { q = q, v = { 0, 1 }, steps = 1 } end
told(here(), "field 'q' must have 2 entries", function() local _ = go { 1 } end, "a run in a tail call")
local text, failure = message(function() local _ = solver:run { q = { 0.1, 0 }, v = { 0, 0 }, t = 10 } end)
ok(failure.code == "no_convergence" and failure.path and text == failure.message, "a failure stays one, with its path", text)
told(here() + 1, "oops", function()
  local _ = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1, watch = { r = function() error "oops" end } }
end, "an error of the user's own function")
local polar = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 - math.log(q[1] - 0.5) * 3 end }
local shape = polar:routh { mu = 0.01 }:solver { rule = "verlet", h = 1 }
told(here(), "verlet: ", function() local _ = shape:run { q = { 1 }, v = { -3 }, t = 10 } end, "a reduced run")
told(here(), "field 'q' must have 1 entries (got 2): this system is reduced", function() local _ = shape:run { q = { 1, 0 }, v = { 0, 0 }, t = 1 } end, "a reduced start")
raises("a method is called with a colon, x:run(...)", function() local _ = solver.run { q = { 1, 0 } } end)
raises("x:solver(...)", function() local _ = kepler.solver { rule = "verlet", h = 1 } end)
ok(not select(2, pcall(kepler.solver, { h = 1 })):find "colon.*colon", "the colon is told once")
raises("bad argument #1 to 'solver'", function() local _ = kepler.solver { rule = "verlet", h = 1 } end)

raises("got table: rows make a dm.matrix", function() return { { 1, 0 }, { 0, 2 } } * dm.vector { 1, 2 } end)

-- what is wrong, not what follows from it
raises("test_misuse.lua:" .. here() .. ": oops", function() kepler:routh { mu = 1, action = function() error "oops" end } end)
raises("attempt to index a number value", function() kepler:routh { mu = 1, action = function(th, q) return { q[1] + th[1], q[2] } end } end)
raises("L is infinite at the start", function() kepler:chart { q = { 0, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" } } end)
raises("field 'q' must have 2 entries", function() kepler:chart { q = { 1 }, v = { 0, 1 }, t = 1, rules = { "verlet" } } end)
raises("option 'u' must be a vector or table of 2 numbers (got 3)", function() solver:lyapunov { q = { 1, 0 }, v = { 0, 1 }, t = 1, u = { 1, 0, 0 } } end)
raises("option 'dp' must be a vector or table of 2 numbers (got string)",
  function() solver:lyapunov { q = { 1, 0 }, v = { 0, 1 }, t = 1, dp = "x" } end)
raises("did you mean 'verlet'", function() kepler:solver { rule = "leapfrog", h = 1 } end)
ok(not message(function() kepler:solver { rule = "foo", h = 1 } end):find "did you mean", "no guess where nothing is near")
raises("unknown rule 'foo'; ?rules", function() dm.discrete_lagrangian(kepler, { rule = "foo", h = 1 }) end)

-- options under the names that other programs use
raises("unknown field 'dt'; did you mean 'h'?", function() kepler:solver { rule = "verlet", dt = 1 } end)
raises("unknown field 'integrator'; did you mean 'rule'?", function() kepler:solver { integrator = "verlet", h = 1 } end)
raises("unknown field 'LL'; did you mean 'L'?", dm.system, { Q = dm.R(1), LL = function() return 0 end })
raises("how long? 'steps' (how many), 't' (a duration) or 'at' (times) is missing", solver.run, solver, { q = { 1, 0 }, v = { 0, 1 } })

local moved = dm.action { group = dm.SE(2), on = dm.R(2) }
local function section(a, b) return { a[1], a[2], b[2] } end
local function with(params, L) return dm.system { Q = dm.R(1), params = params, L = L } end
raises("test_misuse.lua:" .. here() + 1 .. ": cannot compute the string \"x\" * dm.symbol",
  function() with({ k = "x" }, function(q, v, _, P) return v[1] ^ 2 - P.k * q[1] end) end)
raises("field 'params' must be a table that L gets as its last argument, for instance { k = 2 } (got number)", with, 3, function(_, v) return v[1] ^ 2 end)
raises("the params of a system are the fourth argument", with, { k = 3 }, function(_, v, P) return P.k * v[1] ^ 2 end)
raises("'points' must be a whole number", function() dm.moving_frame { action = moved, points = "2", cross_section = section } end)
raises("unknown option 'section'; did you mean", function() dm.moving_frame { action = moved, section = section } end)
local rho = dm.moving_frame { action = moved, points = 2, cross_section = section, branch = function(_, b) return b[1] end }
raises("point 1 must have 2 entries", function() rho({ 1 }, { 2 }) end)
raises("\"picture\" is every coordinate and stands alone", function()
  dm.scene { system = kepler, q = { 1, 0 }, v = { 0, 1 }, watch = { "picture" }, tolerance = 1e-3, until_t = 1 }
end)
raises("entry 1 must be a number, got dm.vector", function()
  dm.action { group = dm.GL(1), on = dm.R(2), map = function(g, z) return { g[1] * z[1], g[1] * z[2] } end }
end)

-- what was meant, where it can be guessed
raises("did you mean 'rk4'", function() kepler:solver { rule = "RK4", h = 1 } end)
raises("a condition on velocities is `rolling`",
  function() dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end, constraint = function(_, v) return v[1] end } end)
raises("as in dm.derivative(f, n)", function() dm.derivative(function(x) return x[1] end) end)
raises('for 6 values from 0.1 to 10: {0.1, 10, 6, "linear"}',
  function() kepler:stability { rule = "verlet", q = { 1, 0 }, v = { 0, 1 }, h = { 0.1, 10, 6 }, steps = 9 } end)
raises("option 'reference' must be { rule =, h = }",
  function() kepler:chart { q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, reference = "exact" } end)
raises("field 'checkpoint': cannot write /nowhere/x", function() solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1, checkpoint = "/nowhere/x" } end)
raises("field 'checkpoint': cannot write /:", function() solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1, checkpoint = "/" } end)
local ball = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, constraint = function(q) return q:dot(q) - 1 end }
raises("dm.scene: no start: it is off the constraints", function()
  dm.scene({ system = ball, q = { 2, 0 }, v = { 0, 0 }, watch = { "q1" }, tolerance = 1e-3, until_t = 1 }):run()
end)
raises("how long? 'steps'", function() solver:ensemble { members = 1, q = { { 1, 0 } }, v = { { 0, 1 } } } end)
raises("the same for all is function", function() solver:ensemble { members = 5, q = { 1, 0 }, v = { 0, 1 }, steps = 1 } end)
raises("M:column(1) of a matrix", function() path:drift(path:momentum(dm.R(2))) end)
local own = dm.discrete_lagrangian { Q = dm.R(1), h = 1, Ld = function(a, b, h) return (b[1] - a[1]) ^ 2 / h end }
ok(not tostring(dm.solver { own }):find "order", "no order is claimed for one's own Ld", tostring(dm.solver { own }))

-- an energy that the motion does not keep is not "off"
local function energy_of(o)
  o.Q = dm.R(1)
  return tostring(dm.system(o):solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1 }, v = { 0 }, t = 2 }):match "energy %a+"
end
local function L(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 end
ok(energy_of { L = L } == "energy off", "energy off: where it is kept")
-- beyond h omega = 2 by Verlet it grows, and no line fits that; a spring of its own does not
do
  local spring = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
  local function text(h) return tostring(spring:solver { rule = "verlet", h = h }:run { q = { 1 }, v = { 0.1 }, steps = 100 }) end
  ok(text(2.05):find "and growing: is h beyond the limit" and text(1.99):find "no drift", "an energy that grows", text(2.05))
end
ok(energy_of { L = L, force = function(_, v) return -v end } == "energy changes", "energy changes: by a force")
ok(energy_of { L = function(q, v, t) return L(q, v) + q[1] * math.cos(t) end } == "energy changes", "energy changes: by time")

local still = dm.system({ Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end }):solver({ rule = "verlet", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 3 }
raises("a group, such as dm.SO(2)", function() still:momentum "SO(2)" end)

-- a dot in place of a colon, in methods that are written in Lua
local function dotted(class, f, ...) tap.raises(class .. " expected, got ", f, ...) end
local orbit = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local turning = orbit:solver { rule = "midpoint", h = 0.1 }
local track = turning:run { q = { 1 }, v = { 0 }, steps = 5 }
local limits = dm.stability { system = orbit, rule = "verlet", q = { 1 }, v = { 0 }, h = { 0.1, 0.2 }, steps = 10, refine = false }
dotted("dm.solver", turning.fold, { q = { 1 }, v = { 0 } })
dotted("dm.solver", turning.tangent, { q = { 1 }, v = { 0 }, steps = 1 })
dotted("dm.path", track.plot, "q1", "p1")
dotted("dm.path", track.csv, "x.csv")
dotted("dm.system", orbit.routh, { cyclic = { 1 } })
dotted("dm.stability_map", limits.limit, 1)
dotted("dm.stability_map", limits.table)
tap.raises("there are rows 1 to 1", limits.limit, limits, 77)
tap.raises("give the start as q and v, or as q and p", turning.tangent, turning, { steps = 3 })
tap.raises("give the start as q and v, or as q and p", turning.symplecticity, turning, {})
tap.raises("function expected, got table", dm.vector({ 1 }).map, dm.vector { 1 }, {})
tap.raises("dm.pretty: takes a table of options", dm.pretty, 1, 2)
tap.raises("dm.discrete_lagrangian expected", dm.discrete_lagrangian(orbit, { rule = "midpoint", h = 0.1 }).order, { q = { 1 }, v = { 0 } })

-- what is set, or not there
-- columns and vectors are taken wherever a list of numbers is
do
  local made = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 3 }
  local t = made:column "t"
  local again = solver:run { q = made.q[1], p = made.p[1], at = made.t }
  ok(again.q[4] == made.q[4] and again:column "t" == t, "at = path.t: the same rows")
  ok(dm.vector(made.t) == t and dm.matrix(made.q)[3] == dm.vector(made.q[3]), "as a vector, rows as a matrix")
  ok(dm.fft(made.t) == dm.fft(t), "as an argument")
  local options = { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 0.4, rules = { "verlet" }, h = dm.vector { 0.2, 0.1 }, repeats = 1, reference = { rule = "gauss(3)", h = 0.05 } }
  ok(#dm.chart(options).points >= 2, "steps of a chart")
  ok(tostring(dm.stability { system = kepler, rule = "verlet", q = { 1, 0 }, v = { 0, 1 }, steps = 5, h = dm.vector { 0.1, 0.5 }, refine = false }) ~= "", "an axis of a map")
  raises("dm.vector or table of numbers expected, got dm.path", dm.vector, made)
  raises("entry 1 must be a number, got dm.vector", dm.vector, made.q)
end
-- lists of what an object holds read as tables do, and cannot be set: a column without a name once ended the program
do
  local made = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 2, record = { "energy" } }
  local members = solver:ensemble { members = 2, q = { { 1, 0 }, { 1, 0 } }, v = { { 0, 1 }, { 0, 1 } }, steps = 2 }
  for _, row in ipairs { { made, "columns" }, { members, "status" }, { members, "steps" } } do
    local list = row[1][row[2]]
    local _, behind = pairs(list)
    for _, change in ipairs { function() behind[2] = nil end, function() list[1] = nil end, function() list[1] = "x" end, function() list[#list + 1] = "x" end, function() list.x = 1 end } do
      raises("cannot be set, since it is a copy: change a list of your own", change)
    end
    local same = #list == #table.move(list, 1, #list, 1, {})
    for i, value in pairs(list) do same = same and list[i] == value end
    ok(same and tostring(list):find "^{ " and rawequal(row[1][row[2]][1], list[1]), row[2] .. " is read as a table is", tostring(list))
  end
  ok(table.concat(made.columns, " ") == "t q1 q2 p1 p2 energy" and #made:column "q1" == 3, "and nothing has changed")
end
raises("the field 'h' of a dm.solver cannot be set: make another dm.solver", function() solver.h = 0.1 end)
raises("a run takes a table of options: solver:run { q =, v =, t = } (got nil)", function() solver:run() end)
local explain = require "dm.session.missing".explain
ok(explain "x.lua:1: attempt to call a nil value (global 'sin')" == "x.lua:1: attempt to call a nil value (global 'sin'): it is math.sin", "sin is math.sin")
ok(explain "x.lua:1: attempt to call a nil value (global 'vector')":find "it is dm.vector", "vector is dm.vector")
ok(not explain "x.lua:1: attempt to index a nil value (global 'T')":find "it is", "T may be anything")
raises("field 'units' must be a table name -> unit", dm.system, { Q = dm.R(1), L = L, units = "m" })
raises("field 'units'[1] must be a text under the name of what has it", dm.system, { Q = dm.R(1), L = L, units = { "m" } })
raises("field 'at' is empty", function() solver:run { q = { 1, 0 }, v = { 0, 1 }, at = {} } end)
raises("(got dm.space)", function() solver:run { q = dm.R(2), v = { 0, 1 }, t = 1 } end)
raises("rows needs 4e+04 GB", function() solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1e12 } end)
raises("its name is one word", function() kepler:solver { rule = "implicit midpoint", h = 1 } end)
raises("slice: 'from' and 'to' are the same shape", function() polar:routh { mu = 1 }:slice("connection", { from = { 1 }, to = { 1 } }) end)
local short = dm.chart { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, h = { 0.1, 0.05 }, rivals = false, repeats = 1 }
told(here(), "dm.chart: no point of rule 'foo'", function() local _ = short:order "foo" end, "chart:order")
told(here(), "dm.chart: chart:cheapest takes an error", function() local _ = short:cheapest "x" end, "chart:cheapest")
local scaled = dm.action { name = "scaling", group = dm.R(1), on = dm.R(2), map = function(s, z) return math.exp(s[1]) * z end }
ok(tostring(scaled:on_pairs()) == "action 'scaling': left action of R^1 on R^2 on 2 points", "one name for an action on pairs")

-- a Lagrangian without velocities; a rule that needs a well, and a two-form that is singular
local still = dm.system { Q = dm.R(2), L = function(q) return -q:dot(q) end }
ok(tostring(still):find("no velocity in L", 1, true), "a system says that its L has no velocity", tostring(still))
for _, rule in ipairs { "verlet", "gauss(2)", "degenerate(2)", "curve(rk4)" } do
  raises("L has no velocity in it", function() still:solver { rule = rule, h = 0.1 }:run { q = { 1, 0 }, v = { 0, 0 }, steps = 1 } end)
end
raises("L has no velocity in it", still.velocity, still, { 1, 0 }, { 0, 0 })
raises("no acceleration follows", still.linearize, still, { q = { 1, 0 } })
local function bowl(c, start, h)
  local sprung = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 + c end }
  return sprung:solver { rule = "log-hamiltonian", h = h }:run { q = start, v = { 0.3 }, steps = 100 }
end
raises("needs an attracting well, V < 0 in L", bowl, 0, { 0.4 }, 0.1)
raises("needs an attracting well, V < 0 in L", bowl, 0, { 0 }, 0.1)
ok(bowl(1, { 0.4 }, 0.1):drift "energy".largest < 1e-3, "a constant in L makes a well of a bowl, and changes no motion")
raises("rises to 0 or beyond within the step", bowl, 0.09, { 0.1 }, 50)
local gradient = dm.system { Q = dm.R(2), L = function(q, v) return q:dot(v) - q:dot(q) end }
raises("two-form d alpha", function() gradient:solver { rule = "degenerate(1)", h = 0.1 }:run { q = { 1, 0 }, steps = 1 } end)
raises("has no curvature", function() polar:routh { mu = 1 }:slice("curvature", { from = { 1 }, to = { 2 } }) end)
local lost = kepler:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 2, q = { { 1, 0 }, { 1e-160, 0 } }, v = { { 0, 1 }, { 0, 0 } }, steps = 2 }
ok(lost:failures()[1].message == "a value became NaN or infinite", "a failed member says why", lost:failures()[1].message)

-- what there is, in place of Lua's own words
raises("ensemble:path: there are members 1 to 2 (got 3)", function()
  solver:ensemble({ members = 2, q = function() return { 1, 0 } end, v = function() return { 0, 1 } end, steps = 1, every = 1 }):path(3)
end)
raises('path:worst takes "constraint" or "rolling" (got energy)', path.worst, path, "energy")
raises("path:velocity: there are rows 1 to 3 (got 4)", path.velocity, path, 4)
for _, t in ipairs { 0 / 0, math.huge } do
  raises("'t' must be a finite number", still.linearize, still, { q = { 1, 0 }, t = t })
end
raises("(got dm.matrix)", path.drift, path, dm.matrix { { 1, 2 }, { 3, 4 } })
raises("a surplus argument: system:solver{rule=, h=", kepler.solver, kepler, "verlet", 0.1)
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
local pair = dm.discrete_lagrangian { Q = dm.R(4), h = 0.1, Ld = function(a, b, h) return (b - a):dot(b - a) / (2 * h) end }
ok(turn:on_pairs():invariant(pair), "a joint action moves a discrete Lagrangian of two bodies")
local function angle(z) return math.atan(z[2], z[1]) end
local function frame(solution) return dm.moving_frame { action = turn, cross_section = function(z) return z[2] end, solution = solution } end
raises("the solution is not on the cross-section (off by", frame, function() return 0.3 end)
raises("its inverse is: solution gives the element that moves the points to the section", frame, angle)
ok(frame(function(z) return -angle(z) end), "a formula that is right is taken")

tap.done()
