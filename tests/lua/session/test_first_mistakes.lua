-- what is mistaken on a first day on groups, bundles and meshes is told in its own words
local tap = require "tap"
local dm = require "dm"
local raises, ok = tap.raises, tap.ok

local spring = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p)
  return (v[1] ^ 2 - p.k * q[1] ^ 2) / 2
end }

-- a file where a table of options goes
local chart = spring:chart { q = { 1 }, v = { 0 }, t = 1, h = { 0.1, 0.05 }, rules = { "verlet" } }
raises("chart:plot: takes a table of options (got \"x.png\"): { file = \"x.png\" }", chart.plot,
  chart, "x.png")
raises("takes a table of options (got \"x.svg\"): { file = \"x.svg\" }", dm.plot, { 1 }, { 1 }, "x.svg")
local map = dm.stability { system = spring, rule = "verlet", q = { 1 }, v = { 0 }, steps = 10,
  h = { 0.1, 1, 2, "log" } }
raises("map:plot: takes a table of options (got \"x.png\")", map.plot, map, "x.png")
raises("(got \"1e-4\": write it without quotes, or tonumber(text))", dm.scene, { system = spring, q = { 1 }, v = { 0 }, watch = { "q1" },
  tolerance = "1e-4", until_t = 1 })

-- groups
local top = dm.system { Q = dm.SO(3), L = function(g, xi) return xi:dot(xi) / 2 - g[3][3] end }
local path = top:solver({ rule = "lie(1)", h = 0.1 }):run { q = dm.identity(3), v = { 0, 0, 1 },
  steps = 2 }
raises("what the generator returns must have 3 entries (got 2)", path.momentum, path,
  function() return { 0, 0 } end)
raises("the generator must return one value, not 2", path.momentum, path,
  function() return 0, 0 end)
ok(path:momentum(function() return { 0, 0, 1 } end)[3] == path.p[3][3], "a right generator")
raises("(got body)", path.momentum, path, dm.SO(3), { side = "body" })
raises("a b must move an element as b and then a do", path.momentum, path, dm.SO(3),
  { action = function(k, g) return k * g * k end })
for _, action in ipairs { function(k, g) return k * g end,
  function(k, g) return g * k end, function(k, g) return k * g * k:transpose() end } do
  ok(#path:momentum(dm.SO(3), { action = action }) == 3, "actions on either side")
end
local fine, message = pcall(top.reduce, top, { group = dm.SO(3), rule = "lie(1)", h = 0.1 })
ok(not fine and message:find(" at g = ", 1, true), "no shape x without a base", message)

-- starts and states on groups: an element, not flat coordinates
local step = top:solver { rule = "lie(1)", h = 0.1 }
local I = dm.identity(3)
raises("field 'q' is missing: an element of SO(3) is a matrix of 3 x 3", step.run, step,
  { steps = 2 })
raises("field 'q' is missing", step.run, step, { steps = 2, v = { 0, 0, 1 } })
for _, ask in ipairs { "energy", "mass", "momentum" } do
  raises("the element q is missing, argument 1: an element of SO(3)", top[ask], top)
  raises("argument 2 behind the element is missing: a vector of 3 numbers", top[ask], top, I)
  raises("(q and v come one after the other)", top[ask], top, { q = I, v = { 0, 0, 1 } })
end
raises("a unit quaternion is an element of dm.SU(2)", step.run, step,
  { q = { 1, 0, 0, 0 }, v = { 0, 0, 1 }, steps = 2 })
raises("field 'v': entry 3 must be a number, got string", step.run, step,
  { q = I, v = { 0, 0, "1" }, steps = 2 })
raises("must be one flat list of 3 numbers (got a list of lists)", step.run, step,
  { q = I, v = { { 0, 0, 1 } }, steps = 2 })
-- what is no rotation is one nowhere, not read as a start
local off = dm.matrix { { 2, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }
raises("this is no element of SO(3)", top.linearize, top, { q = off })
raises("this is no element of SO(3)", top.acceleration, top, off, { 0, 0, 1 })
raises("G:project(g) is an element near it", top.energy, top, off, { 0, 0, 1 })
raises("project = true starts at the nearest one", step.run, step,
  { q = off, v = { 0, 0, 1 }, steps = 2 })
raises("field 'v' must have 3 entries (got 2)", top.linearize, top, { q = I, v = { 0, 0 } })
for _, key in ipairs { "v", "p" } do
  raises("this is no element of SO(3)", step.tangent, step,
    { q = off, [key] = { 0, 0, 1 }, steps = 2 })
end
local Ld = dm.discrete_lagrangian(top, { rule = "lie(1)", h = 0.1 })
raises("g1: this is no element of SO(3)", Ld, I, off)
raises("g0: this is no element of SO(3)", Ld.legendre_minus, Ld, off, I)
raises("g1: the group element must be a matrix of 3 x 3 (got nil)", Ld, I)
-- a run that goes on has its element
ok(dm.resume(path):run({ steps = 2 }).t[3] == 0.4, "a run on a group goes on")
for _, start in ipairs { { q = I, steps = 2 }, { v = { 0, 0, 1 }, steps = 2 } } do
  raises("goes on from a checkpoint", function() dm.resume(path):run(start) end)
end
-- where elements are lists, velocities are not
local product = dm.product(dm.SO(3), dm.R(3))
for _, L in ipairs { function(_, xi) return xi[1]:dot(xi[1]) end,
  function(_, xi) return xi[2][1] end } do
  raises("of a product are one flat list of numbers, factor after factor: xi:slice(1, 3)",
    dm.system, { Q = product, L = L })
end
local pair = dm.system { Q = product, L = function(_, xi) return xi:dot(xi) / 2 end }
raises("one flat list of 6 numbers, factor after factor (got a list of lists)", pair.energy, pair,
  { I, { 0, 0, 0 } }, { { 0, 0, 1 }, { 0, 0, 0 } })
local two = pair:solver { rule = "lie(1)", h = 0.1 }
raises("one flat list of 6 numbers", two.run, two, { q = { I, { 0, 0, 0 } }, steps = 2,
  p = { dm.vector { 0, 0, 1 }, dm.vector { 0, 0, 0 } } })
-- a reduced run begins at the identity, with v or p
local reduced = dm.euler_poincare { group = dm.SO(3), l = function(xi) return xi:dot(xi) / 2 end }
local round = reduced:solver { rule = "lie(1)", h = 0.1 }
raises("fields 'v' and 'p' are missing", round.run, round, { steps = 2 })
ok(dm.resume(round:run { v = { 0, 0, 1 }, steps = 2 }):run({ steps = 2 }).t[3] == 0.4,
  "a reduced run goes on")

-- columns: a path has them as fields, what is no column is called by its class
local orbit = dm.system { Q = dm.R(2), coordinates = { "x", "csv" },
  L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }
  :solver({ rule = "verlet", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 9 }
for name, of in pairs { x = { "q", 1 }, q1 = { "q", 1 }, q2 = { "q", 2 }, p_x = { "p", 1 },
  p2 = { "p", 2 } } do
  local column, alike = orbit[name], true
  for i = 1, #orbit do alike = alike and column[i] == orbit[of[1]][i][of[2]] end
  ok(alike and #column == 10, "path." .. name .. " is that column")
end
ok(type(orbit.csv) == "function" and #orbit.q == 10, "methods and fields keep their names")
ok(orbit.q3 == nil and orbit.time == nil, "what is no column is nil")
raises("y must be a vector or a table of numbers (got dm.columns, all columns together", orbit.plot,
  orbit, orbit.q)
raises("(got dm.path)", orbit.plot, orbit, orbit)
raises("or a list of series { x =, y =, name = } (got nil)", dm.plot)
raises("(got dm.vector: against what?", dm.plot, orbit.x)
raises("(got nil and dm.vector)", dm.plot, nil, orbit.x)
for got, draw in pairs { ["got dm.vector"] = function(q) return q end,
  ["got points = a dm.vector"] = function(q) return { points = q } end,
  ["holds a dm.path"] = function() return { points = { { orbit, 1 } } } end } do
  raises(got, orbit.animate, orbit, "x.html", { draw = draw })
end

-- the only rule of a chart needs no name, of several one does
raises("chart:order takes the rule whose order is asked for: verlet, midpoint", function()
  spring:chart({ q = { 1 }, v = { 0 }, t = 1, h = { 0.1, 0.05 }, rules = { "verlet", "midpoint" } })
    :order()
end)
ok(select("#", chart:order()) > 0 and chart:order() == chart:order "verlet", "the only rule")

-- units stand under names of columns; a dimension is none, unless something is called so
local function with(units, more)
  local o = { Q = dm.R(1), units = units, L = function(_, v) return v[1] ^ 2 / 2 end }
  for key, value in pairs(more or {}) do o[key] = value end
  return dm.system(o)
end
for _, name in ipairs { "length", "mass", "time" } do
  raises(("'%s' is no column: units stand under q and p"):format(name), with, { [name] = "m" })
  ok(with({ [name] = "m" }, { params = { [name] = 1 } }).units[name] == "m", "a parameter " .. name)
  ok(name == "time" or with({ [name] = "m" }, { coordinates = { name } }).units[name] == "m",
    "a coordinate " .. name)
end
ok(with({ q = "m", reach = "m", t = "s" }).units.reach == "m", "what a run will watch")

-- what a solver has
local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h)
  return (b[1] - a[1]) ^ 2 / (2 * h)
end }
local function explained(f)
  local _, text = xpcall(f, debug.getregistry().dm_explain)
  return text
end
local said = explained(function() Ld:run { steps = 1 } end)
ok(said:find("a solver of it has: Ld:solver {}:run", 1, true), "Ld:run", said)
said = explained(function() dm.R(2):run() end)
ok(said:find("a method of dm.solver, dm.avi_cells, dm.box_solver, dm.euler_solver and ", 1, true),
  "few classes are named, the usual ones first", said)

-- bundles
for _, form in ipairs { function(x) return { -x[2] } end, function(x) return { x[3], 1 } end } do
  raises("option 'form' has no value at 120 random points", dm.connection,
    { group = dm.SO(2), base = dm.R(2), form = form })
end
local A = dm.connection { group = dm.SO(2), base = dm.R(2), form = function(x)
  return { -x[2] / 2, x[1] / 2 }
end }
raises("a list { x, g } of 2 numbers and an element of SO(2)", A, { 0, 0 }, { 1, 0 })

-- meshes
local K = dm.mesh { grid = 2 }
raises("gets the 2 coordinates of a point", K.form, K, 0, function(x) return x[1] end)
raises("gets the 2 coordinates of a point", K.poisson, K,
  { f = function(x) return x[1] end, fixed = { boundary = 0 } })
raises("gets the 2 coordinates of a point", K.poisson, K,
  { fixed = { boundary = function(x) return x[1] end } })
raises("gets the 2 coordinates of a point", K.euler, K, { vorticity = function(x) return x[1] end })
local a = K:form(0, function(x) return x end)
local _, why = xpcall(function() return a.valus[1] end, debug.getregistry().dm_explain)
ok(why:find("a dm.form has no 'valus'; did you mean 'values'?", 1, true), "a field that is not there",
  why)

-- other names of spaces; places in a matrix
for other, name in pairs { Sphere = "S", sphere = "S", torus = "T", Torus = "T", circle = "T", Rn = "R" } do
  _, why = xpcall(function() return dm[other](2) end, debug.getregistry().dm_explain)
  ok(why:find(("dm has no '%s'; did you mean '%s'?"):format(other, name), 1, true), "dm." .. other, why)
end
raises("entry 1 of row 2 must be a number, got string", dm.matrix, { { 1, 2 }, { "x", 3 } })
raises("entry 2 of row 1 must be a number, got table", dm.matrix, { { 1, {} }, { 2, 3 } })
tap.done()
