-- meshes and forms that are refused: the message says what it is, sizes at the edge of what numbers hold are none of them
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function edge(lengths) return dm.mesh { simplices = { { 1, 2, 3 } }, lengths = lengths } end
raises("the length of edge {1, 2} must be a number > 0 (got nil)", edge, function() return nil end)
raises("(got x)", edge, function() return "x" end)
raises("lengths must return one value", edge, function() return 1, 2 end)

-- the volume of a regular simplex of side a and degree n: a^n sqrt((n + 1)/2^n)/n!
local function simplex(n, a)
  local ids = {}
  for i = 1, n + 1 do ids[i] = i end
  return dm.mesh { simplices = { ids }, lengths = a }
end
for _, case in ipairs { { 8, 1e30 }, { 8, 1e-30 }, { 3, 1e90 }, { 2, 1e-140 }, { 1, 1e140 }, { 5, 1 } } do
  local n, a = table.unpack(case)
  local expected = ((n + 1) / 2 ^ n) ^ 0.5
  for i = 1, n do expected = expected * a / i end
  near(simplex(n, a):volume(n)[1] / expected, 1, 1e-13, ("a simplex of degree %d and side %g"):format(n, a))
end

-- stars of edges of a triangle, and of a tetrahedron over the unit: no size changes them (by hand: half the cotangent
-- of the opposite angle; the other two by an edge of length 1)
local function small(size, points, simplices)
  local P = {}
  for i, p in ipairs(points) do
    P[i] = {}
    for j, x in ipairs(p) do P[i][j] = size * x end
  end
  return dm.mesh { points = P, simplices = simplices }
end
local corner = { { 0, 0 }, { 1, 0 }, { 0.3, 1 } }
local solid = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.3, 1, 0 }, { 0.2, 0.4, 1 } }
local pent = { { 0, 0, 0, 0 }, { 1, 0, 0, 0 }, { 0.3, 1, 0, 0 }, { 0.2, 0.4, 1, 0 }, { 0.3, 0.2, 0.3, 1 } }
local of_solid, of_pent = small(1, solid, { { 1, 2, 3, 4 } }), small(1, pent, { { 1, 2, 3, 4, 5 } })
for _, size in ipairs { 1e-120, 1e-90, 1e-80, 1, 1e80, 1e100 } do
  local star = small(size, corner, { { 1, 2, 3 } }):star_weights(1)
  near((star - dm.vector { 0.395, 0.35, 0.15 }):norm(), 0, 1e-15, ("a triangle's stars at size %g"):format(size))
end
for _, size in ipairs { 1e-90, 1e-80, 1e80, 1e90 } do
  local K = small(size, solid, { { 1, 2, 3, 4 } })
  for k = 0, 3 do
    local off = (K:dual_volume(k) / size ^ (3 - k) - of_solid:dual_volume(k)):norm()
    near(off, 0, 1e-14, ("a tetrahedron's duals of degree %d at size %g"):format(3 - k, size))
  end
end
for _, size in ipairs { 1e-60, 1e60 } do
  local K = small(size, pent, { { 1, 2, 3, 4, 5 } })
  for k = 0, 4 do
    local off = (K:dual_volume(k) / size ^ (4 - k) - of_pent:dual_volume(k)):norm()
    near(off, 0, 1e-14, ("a 4-simplex's duals of degree %d at size %g"):format(4 - k, size))
  end
end
raises("too short for volumes of degree 2", simplex, 1, 1e-170)
raises("too long for volumes of degree 8", simplex, 8, 1e100)
raises("too short for volumes of degree 8", simplex, 8, 1e-100)
raises("Cayley-Menger", edge, { 1, 1, 3 })
raises("vertex 2147483648 is far above the 3 vertices", dm.mesh, { simplices = { { 1, 2, 2 ^ 31 } } })

-- meshes that lie over themselves in a space of their own dimension: taken, as surfaces of their own, and told
local function two(points, simplices) return dm.mesh { points = points, simplices = simplices } end
local kite = two({ { 0, 0 }, { 1, 0 }, { 0.5, 1 }, { 0.5, -0.8 } }, { { 1, 2, 3 }, { 1, 2, 4 } })
local shut = two({ { 0, 0 }, { 1, 0 }, { 0.5, 1 }, { 0.5, 0.8 } }, { { 1, 2, 3 }, { 1, 2, 4 } })
local count, first = shut:folds()
ok(kite:folds() == 0 and count == 1 and first == "{1, 2}", "two triangles on one side of their edge", first)
ok(tostring(shut):find "chi 1, folded$" and not tostring(kite):find "folded", "its text says so", tostring(shut))
ok(two({ { 0 }, { 2 }, { 1 } }, { { 1, 2 }, { 2, 3 } }):folds() == 1 and two({ { 0 }, { 1 }, { 2 } }, { { 1, 2 }, { 2, 3 } }):folds() == 0, "on a line")
local corners = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0.2, 0.2, -1 } }
ok(two(corners, { { 1, 2, 3, 4 }, { 1, 2, 3, 5 } }):folds() == 0, "tetrahedra on two sides")
corners[5][3] = 2
ok(two(corners, { { 1, 2, 3, 4 }, { 1, 2, 3, 5 } }):folds() == 1, "on one side")
for _, spec in ipairs { { grid = 4 }, { shells = { 3, 3 } }, { cube_tiling = 2 }, { annulus = { 2, 7 }, ratio = 2 }, { triangle = 3 },
  { icosphere = 1 }, { bcc = 3 }, { points = { { 0, 0 }, { 3, 1 }, { 1, 2 }, { 2, -1 }, { 1, 1 } } } } do
  ok(dm.mesh(spec):folds() == 0, "no folds in " .. next(spec))
end
-- a vertex that is drawn over its neighbours: folds are the edges between areas of two signs, in the order of a sheet
local drawn = dm.mesh { grid = 8, map = function(x, y) return x == 0.5 and y == 0.5 and { 0.9, 0.6 } or { x, y } end }
local linear, report = drawn:poisson { fixed = { boundary = function(x, y) return x + 2 * y end } }
local sheet, P, sides = dm.mesh { grid = 8 }:oriented(drawn:volume(2)), drawn:points(), 0
local function side(c)
  local a, b, d = table.unpack(drawn:simplices(2)[c])
  local turned = (P[b][1] - P[a][1]) * (P[d][2] - P[a][2]) - (P[d][1] - P[a][1]) * (P[b][2] - P[a][2]) < 0
  return turned == (sheet[c] < 0)
end
for e = 1, drawn:count(1) do
  local c = drawn:cofaces(1, e)
  if c[2] and side(c[1]) ~= side(c[2]) then sides = sides + 1 end
end
ok(drawn:volume(2):sum() > 1.05 and sides > 0 and drawn:folds() == sides, "cells turned inside out", drawn:folds())
ok((linear - drawn:form(0, function(x, y) return x + 2 * y end)):max() > 0.1 and report.note:find "the mesh is folded at 4 facets", "a solution that is wrong is told")
ok(drawn:darcy { pressure = 0 }.report.note:find "folded" and shut:laplacian(0):eigen(1).note:find "folded", "fluxes and modes too")
ok(kite:poisson { f = 1 } and select(2, kite:poisson { f = 1 }).note == nil, "and nothing where nothing is")

-- options that belong to another kind of mesh
raises("'ratio' goes with 'annulus', not with 'grid'", dm.mesh, { grid = 2, ratio = 3 })
raises("'radii' goes with 'torus', not with 'annulus'", dm.mesh, { annulus = { 2, 5 }, ratio = 3, radii = { 2, 1 } })
raises("'points' goes with 'simplices', not with 'icosphere'", dm.mesh, { icosphere = 1, points = { { 1 } } })
raises("'lengths' goes with 'simplices', not with 'klein'", dm.mesh, { klein = 4, lengths = 1 })
raises("give one of 'simplices' and 'grid'", dm.mesh, { grid = 2, simplices = { { 1, 2 } } })
raises("'ratio' goes with 'annulus'", dm.mesh, { simplices = { { 1, 2 } }, ratio = 2 })
raises("points", dm.mesh, { simplices = { { 1, 2 } }, points = 3 })

local K = dm.mesh { grid = 2 }
raises("term 1 must be { integer, { vertices } } (got 1)", K.chain, K, 1, { 1 })
raises("a list of terms", K.chain, K, 1, 7)

-- forms have finite values, whatever makes them
local many = {}
for i = 1, K:count(0) do many[i] = i == 4 and 0 / 0 or 1 end
raises("value 4 of a primal 0-form is NaN", K.form, K, 0, many)
many[4] = 1 / 0
raises("value 4 of a primal 0-form is infinite", K.form, K, 0, dm.vector(many))
local large = K:form(0, function() return 1e308 end)
raises("infinite", function() return large + large end)
raises("infinite", function() return 10 * large end)
raises("infinite", function() return large / 1e-3 end)
raises("infinite", function() return large:wedge(large) end)
raises("too large", large.dot, large, large)
raises("too large", large.norm, large)
local sign = 1
raises("infinite", function() return K:form(0, function() sign = -sign return sign * 1.7e308 end):d() end)
-- why there is no orientation: an edge of three triangles is named
tap.raises("no manifold at {1, 2}, a face of 3 cells", function() return require "dm".mesh { named = "dunce" }:fundamental() end)
tap.raises("directions", function() return require "dm".mesh { klein = 3 }:fundamental() end)
tap.done()
