-- what is mistaken on a first day on groups, bundles and meshes is told in its own words
local tap = require "tap"
local dm = require "dm"
local raises, ok = tap.raises, tap.ok

local spring = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p)
  return (v[1] ^ 2 - p.k * q[1] ^ 2) / 2
end }

-- a file where a table of options goes
local chart = spring:chart { q = { 1 }, v = { 0 }, t = 1, h = { 0.1, 0.05 }, rules = { "verlet" } }
raises("chart:plot: takes a table of options (got \"x.png\")", chart.plot, chart, "x.png")
local map = dm.stability { system = spring, rule = "verlet", q = { 1 }, v = { 0 }, steps = 10,
  h = { 0.1, 1, 2, "log" } }
raises("map:plot: takes a table of options (got \"x.png\")", map.plot, map, "x.png")
raises("(got \"1e-4\")", dm.scene, { system = spring, q = { 1 }, v = { 0 }, watch = { "q1" },
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
local fine, message = pcall(top.reduce, top, { group = dm.SO(3), rule = "lie(1)", h = 0.1 })
ok(not fine and message:find(" at g = ", 1, true), "no shape x without a base", message)

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
local a = K:form(0, function(x) return x end)
local _, why = xpcall(function() return a.valus[1] end, debug.getregistry().dm_explain)
ok(why:find("a dm.form has no 'valus'; did you mean 'values'?", 1, true), "a field that is not there",
  why)
tap.done()
