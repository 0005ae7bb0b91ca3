-- Lists of plain numbers that modules read at once: what is none gives nothing, and is never read as
-- something else.
local tap = require "tap"
local core = require "dm.core"
local dm = require "dm"
local ok = tap.ok
local huge, nan = math.huge, 0 / 0

local z = dm.vector { 1, 2 }
ok(core.plain(z, 2) == z and not rawequal(core.plain(z, 2), z), "a vector is copied")
ok(core.plain({ 1, 2 }, 2) == z and core.plain(4, 1) == dm.vector { 4 }, "a table, a number")
ok(core.plain(dm.matrix { { 1, 2 }, { 5, 6 } }[2], 2) == dm.vector { 5, 6 }, "a row of a matrix")
local list = setmetatable({ 1, 2 }, { __index = function() return 7 end })
for _, x in ipairs { { 1 }, { 1, "2" }, { 1, huge }, { nan, 1 }, "ab", true, list, dm.vector(3) } do
  ok(core.plain(x, 2) == nil, "not two finite numbers")
end
ok(core.plain(nil, 2) == nil and core.plain(huge, 1) == nil and core.plain(1, 2) == nil, "nor these")
tap.raises("a length from 0", core.plain, z, -1)

ok(core.largest(dm.vector { 1, -3, 2 }) == 3 and core.largest { -5, 1 } == 5, "the largest entry")
ok(core.largest(dm.vector { 1, -huge }) == huge, "an infinite one of a vector")
local none = core.largest(dm.vector { nan, 1 })
ok(none ~= none and core.largest { nan } == nil, "a NaN stays, that of a table is nothing")
ok(core.largest(dm.vector(0)) == 0 and core.largest "ab" == nil, "of nothing")

ok(core.joined { z, dm.vector { 3 } } == dm.vector { 1, 2, 3 }, "one after the other")
ok(core.joined { z, { 3 } } == nil and core.joined({}) == dm.vector(0), "no vector, none at all")

-- a map may write on its point
local function map(g, x)
  x[1] = x[1] + g
  return x
end
local out, most = core.images(map, 5, { z, dm.vector { -9, 0 } }, 2)
ok(out[1] == dm.vector { 6, 2 } and out[2] == dm.vector { -4, 0 } and most == 6, "images")
ok(z == dm.vector { 1, 2 }, "the points are what they were")
local kept = dm.vector { 1, 1 }
ok(not rawequal(core.images(function() return kept end, 0, { z }, 2)[1], kept), "nor is one shared")
for _, bad in ipairs { { 1, 2, 3 }, { 1, nan }, "ab", false } do
  ok(core.images(function() return bad end, 0, { z }, 2) == nil, "an image that is none")
end
ok(core.images(map, 0, { { 1, 2 } }, 2) == nil, "a table is no point")
tap.raises("of the map", core.images, function() error "of the map" end, 0, { z }, 2)

-- inside a trace nothing is plain: the modules go on with symbols
local f = dm.derivative(function(x)
  if type(x[1]) ~= "number" then
    ok(core.plain(x, 2) == nil and core.largest(x) == nil and core.joined { x } == nil, "symbols")
  end
  return x[1] * x[2]
end, 2)
ok(f { 3, 4 } == dm.vector { 4, 3 }, "which stay what they are")

local random = dm.random(3)
ok(core.normals(random, 7, 3, 0.5)[3] == random:normal(7, 2, 0, 0.5), "numbers of a place")
tap.raises("dm.random expected", core.normals, z, 7, 3, 1)
tap.done()
