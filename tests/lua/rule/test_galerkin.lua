-- Galerkin variational integrators: a user's nodes and weights against quadratures with names, and every refusal
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, cos, sin = math.sqrt, math.cos, math.sin

local twisted = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 * (1 + q[1] ^ 2 / 3 + q[2] ^ 2 / 5) + v[1] * v[2] * sin(q[2]) / 3 + cos(q[1]) * cos(q[2])
end }
local plain = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + cos(q[1]) * cos(q[2] - q[1] / 3) end }
local start = { q = { 0.4, 0.3 }, v = { 0.5, 0.7 } }
local function final(system, rule, n)
  local path = system:solver { rule = rule, h = 2 / n }:run { q = start.q, v = start.v, steps = n, every = n }
  return path.q[#path], path.p[#path]
end
local function agree(a, b, tolerance, sentence)
  for name, system in pairs { general = twisted, separable = plain } do
    local q, p = final(system, a, 40)
    local Q, P = final(system, b, 40)
    near((q - Q):norm() + (p - P):norm(), 0, tolerance, sentence .. ", L " .. name)
  end
end

-- own nodes, with and without weights
local x = sqrt(3) / 6
agree(dm.galerkin { degree = 2, nodes = { 0.5 - x, 0.5 + x } }, "galerkin(2, gauss(2))", 1e-14, "own Gauss nodes are gauss(2)")
agree(dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 }, weights = { 1 / 6, 2 / 3, 1 / 6 } }, "galerkin(2, lobatto(3))", 1e-14, "Simpson is lobatto(3)")
agree("galerkin(3, gauss(3))", "gauss(3)", 0, "galerkin(s, gauss(s)) is gauss(s), bit for bit")
agree("galerkin(3, lobatto(3))", "lobatto(3)", 0, "galerkin(s, lobatto(s)) is lobatto(s), bit for bit")
agree("galerkin(1, lobatto(2))", "trapezoidal", 1e-14, "galerkin(1, lobatto(2)) is the trapezoidal rule")
agree("galerkin(1, gauss(1))", "midpoint", 0, "galerkin(1, gauss(1)) is the midpoint rule, bit for bit")
agree("galerkin(3, gauss(6))", "galerkin(3, gauss(12))", 1e-8, "more nodes than needed: near the exact integral")

local simpson38 = dm.galerkin { degree = 3, nodes = { 0, 1 / 3, 2 / 3, 1 } }
ok(simpson38.order == 4, "Simpson's 3/8 rule is exact to degree 3: order 4", simpson38.order)
ok(dm.galerkin { degree = 2, nodes = { 0.1, 0.4, 0.8 } }.order == 3, "three nodes anywhere: order 3")
ok(tostring(simpson38) == "rule galerkin(3, 4 own nodes)", "a rule prints itself", tostring(simpson38))
local solver = plain:solver { rule = simpson38, h = 0.1 }
ok(solver.rule == simpson38 and plain:solver { rule = solver.rule, h = 0.2 }.order == 4, "solver.rule is the object again")
local function order(rule, n)
  local reference = final(twisted, "gauss(8)", 40)
  return math.log((final(twisted, rule, n) - reference):norm() / (final(twisted, rule, 2 * n) - reference):norm(), 2)
end
for rule, n in pairs {
  ["galerkin(1, radau(1))"] = 800, ["galerkin(1, radau-left(1))"] = 800, ["galerkin(2, radau(2))"] = 80,
  ["galerkin(2, radau-left(2))"] = 80, ["galerkin(3, radau(3))"] = 40, ["galerkin(3, radau-left(3))"] = 40,
  ["galerkin(4, radau(4))"] = 10, ["galerkin(2, radau(3))"] = 160, ["galerkin(4, clenshaw-curtis(4))"] = 80,
  ["galerkin(5, clenshaw-curtis(5))"] = 40, ["galerkin(6, clenshaw-curtis(6))"] = 80,
} do near(order(rule, n), twisted:solver({ rule = rule, h = 1 }).order, 0.05, "measured: " .. rule) end
near(order(simpson38, 40), 4, 0.05, "measured: Simpson's 3/8 rule")
near(order(dm.galerkin { degree = 2, nodes = { 0.1, 0.4, 0.8 } }, 160), 3, 0.05, "measured: three nodes anywhere")
near(order(dm.galerkin { degree = 3, nodes = { 0.1, 0.4, 0.8 } }, 160), 2, 0.05, "measured: degree 3 with these")
ok(dm.galerkin { degree = 3, nodes = { 0.1, 0.4, 0.8 } }.order == 2, "and says so")
-- the data of a rule outlive the rule
do
  local lone = plain:solver { rule = dm.galerkin { degree = 1, nodes = { 0.25, 0.75 } }, h = 0.1 }
  for _ = 1, 3 do collectgarbage() end
  local path = lone:run { q = start.q, v = start.v, steps = 100 }
  ok(path:drift("energy").largest < 1e-2, "a rule that only its solver knows is kept")
end

ok(dm.galerkin({ degree = 2, nodes = { 0.1, 0.5, 0.9 } }).symmetric and not dm.galerkin({ degree = 2, nodes = { 0.1, 0.5, 0.8 } }).symmetric,
  "a rule says whether it is symmetric")
near(plain:solver({ rule = dm.galerkin { degree = 2, nodes = { 0.1, 0.5, 0.9 } }, h = 0.3 }):reversal { q = start.q, v = start.v, steps = 5 }, 0, 1e-14, "measured: it is")
ok(simpson38.symplectic, "and symplectic")
near(twisted:solver({ rule = simpson38, h = 0.3 }):symplecticity { q = start.q, v = start.v, steps = 3 }, 0, 1e-13, "measured: it is")
-- a run goes on from a file bit for bit, the rule being given again
do
  local file = os.tmpname()
  local whole = plain:solver({ rule = simpson38, h = 0.1 }):run { q = start.q, v = start.v, steps = 40, every = 40 }
  plain:solver({ rule = simpson38, h = 0.1 }):run({ q = start.q, v = start.v, steps = 20 }):checkpoint(file)
  local rest = dm.resume(file, plain, { rule = simpson38 }):run { steps = 20, every = 20 }
  ok(rest.q[#rest] == whole.q[#whole], "restart of a rule with own nodes, bit for bit")
  os.remove(file)
end

-- refusals
raises("at most 32", function() dm.galerkin { degree = 2 ^ 32 | 0, nodes = { 0.5 } } end)
raises("need 3 nodes", function() dm.galerkin { degree = 3, nodes = { 0, 1 } } end)
raises("exact to degree 2", function() dm.galerkin { degree = 3, nodes = { 0, 0.5, 1 }, weights = { 0.25, 0.5, 0.25 } } end)
raises("sum must be 1", function() dm.galerkin { degree = 1, nodes = { 0, 1 }, weights = { 1, 1 } } end)
raises("growing", function() dm.galerkin { degree = 1, nodes = { 0.5, 0.5 } } end)
raises("[0, 1]", function() dm.galerkin { degree = 1, nodes = { 0.5, 1.5 } } end)
raises("2 nodes", function() dm.galerkin { degree = 1, nodes = { 0.5, 0.6 }, weights = { 1 } } end)
raises("'nodes' is missing", function() dm.galerkin { degree = 1 } end)
raises("'nodes' must be", function() dm.galerkin { degree = 1, nodes = {} } end)
raises("degree", function() dm.galerkin { nodes = { 0.5 } } end)
raises("degenerate", function() dm.galerkin { degree = 2, nodes = { 0.25, 0.5, 0.75 }, weights = { 0, 1, 0 } } end)
for rule, words in pairs {
  ["galerkin"] = "takes the degree", ["galerkin(2)"] = "takes the degree", ["galerkin(0, gauss(2))"] = "takes the degree",
  ["galerkin(2, 3)"] = "takes the degree", ["galerkin(3, gauss(2))"] = "nodes at least", ["galerkin(2, gaus(2))"] = "radau-left(r)",
  ["galerkin(2, gauss)"] = "number of nodes", ["galerkin(1, lobatto(1))"] = "from 2", ["galerkin(40, gauss(40))"] = "32",
} do raises(words, function() plain:solver { rule = rule, h = 0.1 } end) end
raises("'h'", function() plain:solver { rule = "galerkin(2, gauss(2))" } end)
raises("dm.rule", function() plain:solver { rule = {}, h = 1 } end)
tap.done()
