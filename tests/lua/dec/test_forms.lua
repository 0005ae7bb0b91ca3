-- forms of small meshes against values worked by hand
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local square = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 1.2, 1 }, { 0.1, 1.1 } },
  simplices = { { 1, 2, 3 }, { 1, 3, 4 } } }
local f = square:form(0, { 1, 2, 3, 5 })
ok(f:d() == square:form(1, { 1, 2, 4, 1, 2 }), "d of a function: differences along edges")
ok(f:d():d() == square:form(2, { 0, 0 }), "d d = 0")
ok(f:d():at { 3, 1 } == -2, "a turned edge changes the sign")
ok((f:star():star() - f):max() < 1e-15, "star star = 1 on functions of the plane")
local a = square:form(1, { 1, -2, 0.5, 3, 1 })
ok((a:star():star() + a):max() < 1e-14, "and -1 on 1-forms")
-- |1|^2 is the area: (1 * 1 + ...) by the shoelace formula
local area = ((0 * 0 - 1 * 0) + (1 * 1 - 1.2 * 0) + (1.2 * 1.1 - 0.1 * 1) + (0.1 * 0 - 0 * 1.1)) / 2
near(square:form(0, { 1, 1, 1, 1 }):dot(square:form(0, { 1, 1, 1, 1 })), area, 1e-14, "the norm of 1 is the area")
-- dual 0-forms are functions: the star of the area form is 1 on every cell, whatever the order of
-- vertices, and a constant has no d
local turned = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1.1, 1.2 } },
  simplices = { { 1, 3, 2 }, { 2, 3, 4 }, } }
local areas = turned:form(2, turned:oriented(turned:volume(2)))
ok((areas:star().values - dm.vector { 1, 1 }):norm() < 1e-15 and turned:orientation()[2] == -1,
  "the star of the area form")
local one = turned:form(0, { 1, 1 }, { dual = true })
ok(one:d():at { 2, 3 } == 0 and (one:star() - areas):max() < 1e-15, "a constant dual function")
ok(turned:form(0, { 5, 1 }, { dual = true }):d():at { 2, 3 } == 4, "left minus right")
ok(turned:form(2, { 1, 2 }):dot(turned:form(2, { 1, 2 })) > 0, "products are positive")
local rp2 = dm.mesh { named = "rp2" }
ok(rp2:form(2, rp2:volume(2)):delta():norm() > 0, "delta without orientation")
raises("orient", function() return rp2:form(2, rp2:volume(2)):star() end)
ok(tostring(dm.mesh { icosphere = 1 }) == "mesh of dimension 2: 42, 120, 80 cells; orientable, chi 2", "a mesh as text")
raises("degree", function() return f + a end)
raises("mesh", function() return f + dm.mesh { simplices = { { 1, 2, 3, 4 } } }:form(0, { 1, 2, 3, 4 }) end)
raises("4 cells", function() return square:form(0, { 1, 2 }) end)
raises("metric", function() return dm.mesh { simplices = { { 1, 2, 3 } } }:form(0, { 1, 2, 3 }):star() end)
tap.done()
