-- What is not asked for is not dropped in silence: surplus arguments raise, and so do entries of
-- rows of a path, which are copies. A path says where it is other than was asked for.
local tap = require "tap"
local core, dm = require "dm.core", require "dm"
local reference = require "dm.session.reference"
local ok, raises = tap.ok, tap.raises

local v = dm.vector { 1, 2 }
raises("bad argument #2 to 'dot' (a surplus argument: v:dot(w))",
  function() return v:dot({ 1, 1 }, { 5, 5 }) end)
ok(v:dot({ 1, 1 }, nil) == 3, "a nil behind the last argument is none")
ok(math.sin(0, 1, 2) == 0, "math.* is as in Lua")

-- the signature of a doc says how many
local arity = core.arity
ok(arity "dm.clock() -> number" == 0 and arity "v:copy() -> dm.vector" == 1, "no argument")
ok(arity "dm.where(c, a, b) -> number" == 3, "three")
ok(arity "random:normal(i, k [, mean, deviation]) -> number" == 5, "optional ones")
ok(arity "system:solver{rule=, newton={tolerance=, most=}} -> dm.solver" == 2, "a table is one")
ok(arity "dm.resume(file, system [, {rule=}]) -> x   or   dm.resume(path) -> x" == 3, "the most")
ok(arity "dm.max(x, ...) -> number" == nil, "any number")
ok(arity "dm.vector{x1, x2, ...} -> dm.vector" == 1, "a list is one")
ok(arity "path:plot(x, y | {y1, y2, ...}, {file=}) -> name" == 4, "lists inside")

-- every function of dm: more than that raise before anything else is done
local function all()
  local list = {}
  for name, f in pairs(reference.functions(dm)) do list[name] = f end
  for class, methods in pairs(reference.classes()) do
    for name, f in pairs(methods) do list[class .. ":" .. name] = f end
  end
  return list
end
local checked, silent = 0, {}
for name, f in pairs(all()) do
  local doc = core.docs[f]
  local most = doc and doc:find("^math%.") == nil and math[name:match "[%w_]+$"] == nil and arity(doc)
  if most then
    local list = {}
    for i = 1, most + 1 do list[i] = 1 end
    local fine, why = pcall(f, table.unpack(list))
    checked = checked + 1
    if fine or not tostring(why):find "surplus argument" then
      silent[#silent + 1] = name .. ": " .. tostring(why)
    end
  end
end
ok(checked > 150 and #silent == 0, "all functions of dm refuse a surplus argument (" .. checked .. ")",
  table.concat(silent, "; "))

-- rows of a path
local osc = dm.system { Q = dm.R(1), L = function(q, w) return w[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local solver = osc:solver { rule = "verlet", h = 0.3 }
local path = solver:run { q = { 1 }, v = { 0 }, steps = 5, every = 100 }
raises("local v = dm.vector(row)", function() path.q[2][1] = 9 end)
local G = dm.product(dm.SO(3), dm.R(2))
local turned = dm.system({ Q = G, L = function(_, xi) return xi:dot(xi) / 2 end }):solver({ rule = "lie(1)", h = 0.1 })
  :run { q = G:identity(), v = { 0, 1, 0.4, 1, 1 }, steps = 2 }
raises("local m = dm.matrix(row)", function() turned.q[2][1][1][2] = 9 end)
raises("local m = dm.matrix(row)", function() turned.q[2][1][1] = { 1, 0, 0 } end)
raises("local v = dm.vector(row)", function() turned.q[2][2][1] = 9 end)
raises("since it is a copy", function() turned.q[2][1] = 9 end)
raises("since it is a copy", function() turned.q[2][3] = 9 end)
do
  local row, seen = turned.q[2], 0
  for k, factor in pairs(row) do seen = seen + (row[k] == factor and 1 or 0) end
  local g = { table.unpack(row) }
  g[2] = { 3, 4 }
  ok(#row == 2 and seen == 2 and #g == 2 and G:distance(row, turned.q[2]) == 0 and G:distance(g, row) > 1,
    "an element of a product is read as a list, copied and changed")
  ok(turned.system:solver({ rule = "lie(1)", h = 0.1 }):run { q = row, v = { 0, 1, 0.4, 1, 1 }, steps = 1 }.q[1][2] == row[2],
    "and starts a run")
end
local own = dm.matrix(turned.q[2][1])
own[1][2] = 9
ok(own[1][2] == 9 and turned.q[2][1][1][2] ~= 9, "a copy of an element of a group can be changed")
local row = dm.vector(path.q[2])
row[1] = 9
ok(row[1] == 9 and path.q[2][1] ~= 9, "a copy of a row can be changed")
ok((path.q[2] * 2)[1] == 2 * path.q[2][1], "a row computes as any vector")
ok(tostring(path):find("every = 100 is more than the 5 steps", 1, true) ~= nil,
  "an `every` above the steps is told", tostring(path))
path = solver:run { q = { 1 }, v = { 0 }, t = 1 }
ok(tostring(path):find("to t = 1.2 (h = 0.3 does not divide the way to 1)", 1, true) ~= nil,
  "a time that h does not divide is told", tostring(path))
ok(not tostring(solver:run { q = { 1 }, v = { 0 }, t = 0.9 }):find "divide", "one that it divides is not")

-- momentum maps: options that would change nothing
do
  local oscillator = dm.system { Q = dm.R(2), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end }
  local path = oscillator:solver { rule = "verlet", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 2 }
  local turn, plane = function(theta, z) return { z[1] + theta, z[2] } end, dm.action { group = dm.SO(2), on = dm.R(2) }
  raises("unknown field 'action'", path.momentum, path, dm.SO(2), { action = turn })
  raises("unknown field 'blocks'", path.momentum, path, dm.SO(2), { blocks = 2 })
  raises("a surplus argument: path:momentum(generator)", path.momentum, path,
    function(q) return { -q[2], q[1] } end, { block = 2 })
  raises("a surplus argument: path:momentum(action)", path.momentum, path, plane, { block = 2 })
  local Ld = dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = function(a, b) return (b - a):dot(b - a) / 0.2 end }
  raises("unknown field 'action'", Ld.momentum, Ld, dm.SO(2), { 1, 0 }, { 0, 1 }, { action = turn })
  raises("has no time", Ld.momentum, Ld, plane, { 1, 0 }, { 0, 1 }, 7)
  raises("bad argument #5 to 'momentum' (a surplus", Ld.momentum, Ld, plane, { 1, 0 }, { 0, 1 }, 7, 8)
  local body = dm.system { Q = dm.SO(3), L = function(_, xi) return xi:dot(xi) / 2 end }
  local turned = body:solver { rule = "lie(1)", h = 0.1 }
    :run { q = dm.SO(3):identity(), v = { 1, 0, 0 }, steps = 2 }
  raises("did you mean 'action'?", turned.momentum, turned, dm.SO(3), { actoin = turn })
  raises("takes a table", turned.momentum, turned, dm.SO(3), 7)
  raises("'side' is of groups by their own action", turned.momentum, turned, dm.SO(3),
    { action = function(k, g) return k * g end, side = "right" })
  raises("'side' is of groups by their own action", turned.momentum, turned,
    function() return { 1, 0, 0 } end, { side = "right" })
end

-- what takes another number of arguments for another first one
do
  local SO3, S2 = dm.SO(3), dm.S(2)
  raises("a surplus argument: SO(3) is a group, G:exp(xi)", SO3.exp, SO3, { 1, 0, 0 }, { 0, 1, 0 })
  raises("a surplus argument: SO(3) is a group, G:log(g)", SO3.log, SO3, SO3:identity(), SO3:identity())
  ok(math.abs(S2:exp({ 0, 0, 1 }, { 1, 0, 0 })[1] - math.sin(1)) < 1e-15, "of a manifold exp takes two")
  raises("a surplus argument: dm.matrix(rows)", dm.matrix, { { 1 } }, 2)
  raises("a surplus argument: dm.matrix(rows)", dm.matrix, dm.matrix { { 1 } }, 2)
end

tap.done()
