-- what others call an option, a method or a piece of syntax is told in the words of here
local tap = require "tap"
local dm = require "dm"
local raises, ok = tap.raises, tap.ok
local core = require "dm.core"

local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local corners = { { 0, 0 }, { 1, 0 }, { 0, 1 } }

-- options, whether C or Lua takes them: 'triangle' is spelt alike, but means another thing
raises("did you mean 'h'?", spring.solver, spring, { rule = "verlet", dt = 0.1 })
raises("did you mean 'simplices'?", dm.mesh, { points = corners, triangles = { { 1, 2, 3 } } })
raises("did you mean 'points'?", dm.mesh, { vertices = corners })
local grid = dm.mesh { grid = 2 }
raises("did you mean 'f'?", grid.poisson, grid, { rhs = 1 })
raises("did you mean 'fixed'?", grid.poisson, grid, { f = 1, boundary = 0 })
raises("did you mean 'fixed'?", grid.field, grid, { form = 1, dirichlet = "boundary" })
raises("did you mean 'fixed'?", dm.field, { x = { 0, 1, 4 }, bc = "ends" })
raises("did you mean 'coordinates'?", dm.system, { Q = dm.R(1), names = { "x" } })
raises("did you mean 'file'?", dm.plot, { 1, 2 }, { 1, 2 }, { filename = "x.png" })

-- methods
local missing = require "dm.session.missing"
for _, row in ipairs { { "dm.system", "hamiltonian", "energy" }, { "dm.system", "solve", "solver" },
  { "dm.matrix", "inv", "inverse" }, { "dm.path", "save", "csv" }, { "dm.path", "export", "csv" },
  { "dm.path", "energy_error", "drift" }, { "dm.path", "period", "frequency" },
  { "dm", "eye", "identity" }, { "dm", "jacobian", "derivative" }, { "dm.matrix", "determinant", "det" },
  { "dm.vector", "length", "norm" }, { "dm.space", "bracket", "ad" }, { "dm.space", "coadjoint", "coAd" },
  { "dm.system", "symmetries", "structure" } } do
  local text = missing.of(row[1], row[2])
  ok(text:find(("did you mean '%s'?"):format(row[3]), 1, true), row[2], text)
end

raises("unknown field 'V'; did you mean 'L'?", dm.system, { Q = dm.R(1), V = function() return 0 end,
  L = function() return 0 end })
for name, rule in pairs { ["forest-ruth"] = "yoshida", ode45 = "rkf45", ["velocity-verlet"] = "verlet" } do
  raises(("did you mean '%s'?"):format(rule), spring.solver, spring, { rule = name, h = 0.1 })
end

-- products of spaces
local product = missing.explain "stdin:1: attempt to perform arithmetic on a dm.space value"
ok(product:find("a product of spaces is dm.product(A, B)", 1, true), "dm.SO(3) * dm.R(3)", product)
raises("did you mean 't'?", function() spring:solver({ rule = "verlet", h = 1 }):run { q = { 1 }, v = { 0 }, tspan = 1 } end)
raises("did you mean 'newton'?", spring.solver, spring, { rule = "verlet", h = 1, tol = 1 })

-- what is left out where a name or a number has to be
local path = spring:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 99 }
raises('path:frequency: takes the name of a column, as "q1" (got nil)', path.frequency, path)
raises('a column name ("energy", "q1") or a vector of 100 numbers', path.drift, path)

-- q and v are vectors: who takes their entries apart hears which argument nobody gives
local program = os.getenv "DMLUA" or arg[-1]
local shell = io.popen(([['%s' -e "require('dm').system { Q = dm.R(2), L = function(x, y, vx, vy)
  return vx^2/2 + vy^2/2 end }" 2>&1]]):format(program))
local said = shell:read "a"
shell:close()
ok(said:find("(local 'vy'): it is argument 4 of a function that is called with 3", 1, true), "L(x, y, vx, vy)", said)
ok(said:find("the fourth is the option params = { ... }", 1, true), "L(q, v, t, p) without params", said)

-- a name that is there, one that is misspelt, one that is neither: 'map' is no misprint of 'mean'
ok(core.nearest("step", { "h", "step" }) == "step", "what is there is meant")
ok(core.nearest("stpe", { "h", "step" }) == "step" and core.nearest("step", { "h" }) == "h", "else what is like it")
ok(core.nearest("mean", { "map", "norm" }) == nil, "two of four letters are no misprint")

-- globals of other languages, where they are called or read from; those of Lua and dm as before
local explain = missing.explain
for name, here in pairs { len = "#x", norm = "x:norm()", np = "math and dm", sin = "math.sin" } do
  local text = explain(("f.lua:1: attempt to call a nil value (global '%s')"):format(name))
  ok(text:find(here, 1, true), name, text)
end
local other = "f.lua:1: attempt to call a nil value (global 'f')"
ok(explain(other) == other, "a name of nobody")

-- syntax: Lua's own message of a chunk, and what it gets
local syntax = require "dm.session.syntax"
local function told(text) return syntax.explain(select(2, load(text, "=stdin")), text) end
for text, way in pairs { ["x = 2**3"] = "x^2", ["x = [1, 2]"] = "{ 1, 2, 3 }", ["x += 1"] = "x = x + y",
  ["y = x != 3"] = "~=", ["import numpy"] = "require", ["def f(x):"] = "function f(x)", ["x = A[1,2]"] = "A[1][2]",
  ["x = x[end]"] = "x[#x]", ["x = 1 # one"] = "--", ["print x"] = "print(x)", ["f = lambda x: x\n1)"] = "function(x)",
  ["for i in range(9): f(i)\nx = 1"] = "for i = 1, n do", ["x = { 1, y = 2 z = 3 }"] = "comma missing",
  ["L = function(q, v) v:dot(v)/2 end"] = "lack a return",
  ["s = { L = function(q) return q end, f = function(q) q[1] - 1 end }"] = "lack a return", ["\n\nif x == 1:"] = "if x then" } do
  ok(told(text):find(": [^\n]*" .. way:gsub("%p", "%%%0")), text, told(text))
end
for _, text in ipairs { "x = = 1", "x = 'a != b' y", "x = 1 y -- x += 1", "f = function() return 1 / / 2 end", "x = (1",
  "print 'a'\nx = = 3", "print { 1 }\nx = = 3", "local lambda = 3\nx = = 3", "y = lambda:norm()\nx = = 3",
  "for _, b in self:bodies() do\nx = = 3", "for _, b in self:bodies() do x = = 3", "def = 1\nx = = 3" } do
  local message = select(2, load(text, "=stdin"))
  ok(told(text) == message, "nothing is guessed: " .. text, told(text))
end
ok(syntax.explain("no place", "x") == "no place", "a message without a line")

-- of a script, of -e and of a line at the prompt
local dmlua, file = os.getenv "DMLUA" or arg[-1], os.tmpname()
local function said(how)
  local pipe = assert(io.popen(how:format(dmlua, file) .. " 2>&1"))
  local text = pipe:read "a"
  pipe:close()
  return text
end
local out = assert(io.open(file, "w"))
out:write "x = 1\nx += 1\n"
out:close()
for _, how in ipairs { "%s %s", "%s -e 'x += 1' %s", "%s -i < %s" } do
  ok(said(how):find("near '+': x += y is written  x = x + y", 1, true), how, said(how))
end
os.remove(file)

-- the momentum of a coordinate is a column
local swung = spring:solver { rule = "verlet", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 2 }
raises("that of a coordinate is a column: path.p1", swung.momentum, swung, "q1")
local named = dm.system({ Q = dm.R(1), coordinates = { "x" }, L = function(_, v) return v[1]^2/2 end })
  :solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 2 }, steps = 1 }
raises("that of a coordinate is a column: path.p_x", named.momentum, named, "x")
ok(swung.p1[1] == 0 and named.p_x[1] == 2, "these are columns")
-- params of a constraint come third
raises("constraint gets (q, t, params)", dm.system, { Q = dm.R(1), params = { l = 1 },
  L = function(_, v) return v[1]^2/2 end, constraint = function(q, p) return q[1] - p.l end })

-- no acceleration, no linearization: told with the place, not as a matrix that nobody wrote
local sphere = dm.system { Q = dm.R(2), L = function(q, v) return (v[1]^2 + math.sin(q[1])^2*v[2]^2)/2 + math.cos(q[1]) end }
raises("no acceleration follows from L at q = [0, 0], v = [0, 0]: d2L/dv2 is singular there", sphere.linearize, sphere, { q = { 0, 0 } })

-- words of textbooks lead somewhere
local words = require "dm.session.text".collected
local find = require "dm.session.apropos".apropos
for word, text in pairs { maxwell = "the example %?cavity", Casimirs = "dm.euler_poincare", ["Störmer"] = "verlet", stormer = "verlet",
  ["gross-pitaevskii"] = "dm.schroedinger with g =", ["parallel transport"] = "A:holonomy", ["generating function"] = "system:legendre" } do
  local said = words(find, word)
  ok(said:find(text), word .. " leads to " .. text, said)
end
tap.done()
