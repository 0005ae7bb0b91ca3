-- what random calls (tests/fuzz) found: arguments of a wrong kind are told in a sentence of their
-- own, and no number of an option is cut to 32 bits
local tap = require "tap"
local dm = require "dm"
local core = require "dm.core"
local ok, raises = tap.ok, tap.raises

-- a message that is not Lua's own about a line inside dmlua
local function told(text, f, ...)
  local fine, why = pcall(f, ...)
  why = tostring(why)
  ok(not fine and why:find(text, 1, true) and not why:find "attempt to", text, why)
end

---- numbers beyond 32 bits: once a division by zero ----

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local solver = kepler:solver { rule = "verlet", h = 0.05 }
local path = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 3 }
told("no standard action", path.momentum, path, dm.SO(2), { block = 2 ^ 32 })
told("no standard action", path.momentum, path, dm.SO(2), { block = 2 ^ 32 + 2 })
told("degree + 1 numbers", core.complex,
  { simplices = dm.vector { 1, 2, 3 }, degree = 2 ^ 32 - 1 })
told("degree + 1 numbers", core.complex,
  { simplices = dm.vector { 1, 2, 3 }, degree = 2 ^ 32 + 2 })
told("'vertices' is too large", core.complex, { simplices = { { 1, 2, 3 } }, vertices = 2 ^ 32 + 3 })
told("'vertices' is too large", core.complex, { simplices = { { 1, 2, 3 } }, vertices = 2 ^ 31 - 1 })
told("table expected, got number", path.momentum, path, dm.SO(2), -1)
ok(core.complex { simplices = { { 1, 2, 3 } }, vertices = 5 }:count(0) == 5, "two more vertices")

---- starts and steps ----

told("field 'q': a list of numbers is needed (got function)", kepler.linearize, kepler,
  { q = print })
told("'steps' must be a whole number from 0 to 2^53 (got \"10\": write it without quotes, or tonumber(text))", solver.reversal, solver,
  { q = { 1, 0 }, v = { 0, 1 }, steps = "10" })
told("'steps' must be a whole number from 0 to 2^53 (got \"10\": write it without quotes, or tonumber(text))", solver.singularities, solver,
  { q = { 1, 0 }, v = { 0, 1 }, steps = "10" })
told("field 'q': a list of numbers", solver.lyapunov, solver,
  { q = true, v = { 0, 1 }, steps = 3 })
told("u and dp must be finite numbers (got -inf)", solver.lyapunov, solver,
  { q = { 1, 0 }, v = { 0, 1 }, steps = 3, u = { -math.huge, 1 } })
told("u and dp must be finite numbers (got dm.system)", solver.lyapunov, solver,
  { q = { 1, 0 }, v = { 0, 1 }, steps = 3, u = { kepler, 1 } })
local one = solver:lyapunov { q = { 1, 0 }, v = { 0, 1 }, steps = 20, u = { 1, 0 } }
local large = solver:lyapunov { q = { 1, 0 }, v = { 0, 1 }, steps = 20, u = { 1e300, 0 } }
tap.near(large.exponent, one.exponent, 1e-12, "the length of u says nothing, not even 1e300")
told("must have a row for each of the 2 members (got a dm.space)", solver.ensemble, solver,
  { members = 2, q = dm.R(2), v = function() return { 0, 1 } end, steps = 1 })
local top = dm.system { Q = dm.SO(3), L = function(_, W) return W:dot(W) / 2 end }
told("field 'q' must be a function of the member's number", function()
  top:solver { rule = "lie(1)", h = 0.1 }:ensemble { members = 2, q = 5, v = print, steps = 1 }
end)

---- reduction, symmetry, frames ----

told("dm.commute takes a system", dm.commute,
  dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.1 }), { q = { 1, 0 }, v = { 0, 1 } })
told("on R^2 body velocities are those of the coordinates", dm.euler_poincare,
  { group = dm.R(2), l = function(x) return x:dot(x) / 2 end })
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
told("option 'a': a list of numbers is needed (got boolean)", dm.euler_poincare,
  { group = dm.SO(3), l = function(W, a) return W:dot(W) / 2 - a[1] end, advected = turn, a = true })
local calls = 0
told("must return as many numbers everywhere", turn.invariant, turn, function()
  calls = calls + 1
  return calls % 2 == 0 and { 1 } or { 1, 2 }
end)
told("entry 1 must be a number", turn.transitive, turn, { { 1 }, print })
raises("dm.path expected, got boolean", path.momentum, true, turn)
local sly = 0
told("the branch must return a number", function()
  dm.moving_frame { action = turn, cross_section = function(z) return z[2] end, branch = function(z)
    sly = sly + 1
    return sly == 1 and z[1] or { z, z }
  end }
end)
local planet = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2]
end }
local shape = planet:routh { cyclic = 1, mu = 1 }
told("option 'beta' must be a function", shape.rsprk, shape,
  { rule = "gauss(2)", h = 0.1, beta = {} })
-- a formula that is finite nowhere on a section that is no section: there is no root to ask instead
told("nowhere transversal", dm.moving_frame, { action = turn,
  cross_section = function(z) return z:norm() - 1 end, solution = function() return 0 / 0 end })
local rho = dm.moving_frame { action = turn, cross_section = function(z) return z[2] end,
  branch = function(z) return z[1] end }
told("must have 2 entries", rho.tangent, rho, { { 1, 2 }, "q1" })

---- meshes ----

local K = dm.mesh { grid = 2 }
told("the cells of degree 1 must be a list", K.subcomplex, K, { [1] = 3 })
told("function expected, got number", K.integrals, K, 1, 5)
told("function expected, got nil", K.integrals, K, 1)
told("list of vertices expected, got number", K.find, K, 5)
told("a vertex is a whole number (got nan)", function()
  K:find { 1, -(0 / 0) }
end)
told("option 'map' must be a function", dm.mesh, { grid = 2, map = dm.vector { 1 } })
told("option 'points' must be a list of points (got 0.5)", dm.mesh, { points = 0.5 })
told("radii must be { R, r }", dm.mesh, { torus = { 4, 4 }, radii = 3 })
told("a vector of 2 components is needed at each of the vertices (got 5)", K.vector_field, K, 5)
told("takes a table", K:form(1, K:volume(1)).delta, K:form(1, K:volume(1)), 5)
told("there is no cell 1.5", core.matching, K, { { 1.5 } })
told("entry 1 of row 2 must be an integer (got nil)", dm.smith, { { 1, 2 }, { nil, 2 } })
told("a matrix of integers is needed", dm.five_lemma, { top = { nil, { { 1 } } },
  bottom = { { { 1 } }, { { 1 } } }, maps = { { { 1 } }, { { 1 } }, { { 1 } } } })

local line = dm.mesh { simplices = { { 1, 2 }, { 2, 3 } }, points = { { 0 }, { 1 }, { 2.5 } } }
local picture = os.tmpname() .. ".svg"
ok(line:plot { file = picture }, "a mesh on a line is drawn")
os.remove(picture)

---- others ----

told("option 'repeats' must be a whole number >= 1", dm.scaling, { system = kepler, members = { 1 },
  start = function() return { 1, 0 }, { 0, 1 } end, rules = { "verlet" }, h = 0.1, repeats = "x" })
told("'system' is one dm.system (got 5)", dm.scaling, { system = 5, members = { 1 },
  start = function() return { 1, 0 }, { 0, 1 } end, rules = { "verlet" }, h = 0.1 })

told("coefficient 0 must be a finite number", dm.polynomial_roots, { nil, 1, 2 })
told("must be a table of 2 rows", dm.sprk, { a = 5, b = { 0.5, 0.5 } })
local map = dm.stability { system = kepler, rule = "verlet", q = { 1, 0 }, v = { 0, 1 }, steps = 5,
  h = { 0.1, 0.2 }, refine = false }
told("option 'most' must be a whole number >= 1", map.table, map, {})
ok(#map:table(1) > 0, "one row of a table")
ok(dm.pretty({ { { 1, 2 }, { 3 } } }, { width = 1 }):find "1", "a page one character wide")

---- functions that return something else ----

local function own(force) return dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, force = force,
  Ld = function(a, b, h) return (b - a):dot(b - a) / (2 * h) end } end
local function forced(F1, F2) return function() return dm.solver { own(function() return { F1, F2 } end) }:run { q = { 0, 0 },
  p = { 0, 0 }, steps = 1 } end end
ok(forced({ 1, 2 }, { 3, 4 })().p[2][2] == 6, "F1 and F2 of two numbers each")
told("row 1 has 3 entries, row 2 has 1", forced({ 1, 2, 3 }, { 4 }))
told("force must return a number, or a vector or table of numbers, got dm.space", function()
  dm.solver { own(function() return dm.SO(3) end) }:run { q = { 0, 0 }, p = { 0, 0 }, steps = 1 }
end)
for result, text in pairs { [{ 1 }] = "got table", [dm.vector { 1 }] = "got dm.vector", [false] = "got false" } do
  told("H must return a number, " .. text, dm.system, { Q = dm.R(1), H = function() return result end })
end
told("H must return a number, got nil: is a return missing?", dm.system, { Q = dm.R(1), H = function() end })
told("H must return one value, not 2", dm.system, { Q = dm.R(1), H = function(_, p) return p[1] ^ 2 / 2, 1 end })
told("the function is NaN whatever its arguments are", dm.derivative, function() return 0 / 0 end, 1)
told("entry 2 of the function is infinite", dm.derivative, function(x) return { x[1], 1 / 0 } end, 1)
for _, result in ipairs { { 1, x = 2 }, { 1, nil, 3 }, { [2] = 1 }, { [true] = 1 }, dm.SO(2) } do
  told("run must return a number, a list of numbers or named numbers", dm.sweep, { members = 1, run = function() return result end })
end
ok(dm.sweep { members = 1, run = function() return { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 } end }.x10[1] == 10, "a list of ten numbers")
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
told("the function returns an empty list", turn.invariant, turn, function() return {} end)
local shift = dm.action { group = dm.R(1), on = dm.R(1) }
local slide = dm.moving_frame { action = shift, cross_section = function(a) return a end }
told("L must return a number, got dm.vector", function()
  dm.invariant_problem { frame = slide, points = 2, L = function(I) return dm.vector { I[2][1] ^ 2, 5 } end }
end)
local moves = dm.differential_invariants { action = dm.action { group = dm.SE(2), on = dm.R(2) }, independent = 1,
  cross_section = function(z) return { z[1], z[2], z[3] } end, invariants = { kappa = 4 } }
told("L must return a number, got dm.vector", moves.euler_lagrange, moves, function(I) return dm.vector { I.kappa[1], 1 } end)
told("NaN or infinite", moves.euler_lagrange, moves, function(I) return I.kappa[1] * (0 / 0) end)
told("dm.adapt: f must return a number, got nil: is a return missing?", dm.adapt, { W = function(s) return s ^ 2 / 2 end,
  f = function() end, x = { 0, 1, 4 }, ends = { 0, 0 } })
told("L must return a number, got function", function()
  dm.field { x = { 0, 1, 4 }, L = function() return print end }:solver { h = 0.1 }
end)
tap.done()
