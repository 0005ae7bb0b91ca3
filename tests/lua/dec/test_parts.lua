-- parts of meshes, quality, flips, embeddings: against counts and values worked by hand
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt = math.sqrt

local function counts(K)
  local out = {}
  for k = 0, K.dimension do out[k + 1] = K:count(k) end
  return table.concat(out, " ")
end

-- ---- boundary, link, star, skeleton, closure, components

local disc = dm.mesh { triangle = 3 } -- one inner vertex, number 6, a hexagon round it
ok(#disc:boundary_cells(0) == 9 and #disc:boundary_cells(1) == 9 and #disc:boundary_cells(2) == 0, "cells of a boundary")
local rim, vertices = disc:boundary()
ok(rim.dimension == 1 and counts(rim) == "9 9" and rim.euler == 0 and rim:boundary() == nil, "the boundary of a disc is a circle")
near(rim:volume(1):sum(), 3, 1e-14, "with its length")
ok(#vertices == 9 and vertices[9] == 10 and vertices[6] == 7, "whose vertices are known", table.concat(vertices, " "))
ok(dm.mesh { icosphere = 1 }:boundary() == nil, "a sphere has none")
local link, around = disc:link(0, 6)
ok(counts(link) == "6 6" and #around == 6, "the link of an inner vertex is a hexagon")
ok(counts(disc:link(0, 1)) == "2 1" and counts(disc:link(1, (disc:find { 6, 7 }))) == "2", "at the boundary an edge; of an edge two points")
ok(disc:link(2, 1) == nil, "a top cell has no link")
local star = disc:open_star(0, 6)
ok(#star[0] == 1 and #star[1] == 6 and #star[2] == 6, "an open star")
local skeleton = dm.mesh { bcc = 3 }:skeleton(1)
ok(counts(skeleton) == "54 378" and skeleton.ambient == nil, "a skeleton keeps lengths")
near(skeleton:volume(1)[1], dm.mesh { bcc = 3 }:volume(1)[1], 1e-16, "the same lengths")
local two, names = dm.mesh { grid = 4 }:subcomplex { [2] = { 1, 32 }, [1] = { 1 } }
ok(two:count(2) == 2 and two.euler == 2 and #two:components() == 2 and names[1] == 1, "the closure of two triangles")
ok(#dm.mesh { grid = 2 }:components() == 1 and #dm.mesh { grid = 2 }:components()[1] == 9, "one component")
ok(dm.mesh { shells = { 3, 2 } }:boundary().euler == 2, "the boundary of a ball is a sphere")
ok(dm.mesh { klein = 3 }.manifold and not dm.mesh { named = "dunce" }.manifold
  and not dm.mesh { simplices = { { 1, 2, 3 }, { 1, 4, 5 } } }.manifold
  and not dm.mesh { simplices = { { 1, 2, 3, 4 }, { 4, 5, 6, 7 } } }.manifold
  and not dm.mesh { simplices = { { 1, 2, 3 }, { 3, 4 } } }.manifold, "what is a manifold")
raises("no cell 99", function() return disc:subcomplex { [2] = { 99 } } end)
raises("degree from 0 to 2", function() return disc:skeleton(3) end)

-- suspension of a projective plane: facets have two cells and links are connected, but two links are no spheres
local cones, base = {}, dm.mesh { named = "rp2" }:simplices(2)
for _, t in ipairs(base) do
  cones[#cones + 1] = { t[1], t[2], t[3], 7 }
  cones[#cones + 1] = { t[1], t[2], t[3], 8 }
end
ok(not dm.mesh { simplices = cones }.manifold, "the suspension of a projective plane is no manifold")

-- ---- centres and quality

local obtuse = dm.mesh { points = { { 0, 0 }, { 4, 0 }, { 1, 1 } }, simplices = { { 1, 2, 3 } } }
near((obtuse:circumcentres(2)[1] - dm.vector { 2, -1 }):norm(), 0, 1e-14, "a circumcentre outside")
near((obtuse:circumcentres(1)[1] - dm.vector { 2, 0 }):norm(), 0, 1e-15, "of an edge its midpoint")
local q = obtuse:quality()
ok(q.negative[0] == 1 and q.negative[1] == 1 and q.negative[2] == 0 and not q.well_centred and q.delaunay, "quality of an obtuse triangle")
ok(dm.mesh { triangle = 3 }:quality().well_centred and dm.mesh { icosphere = 2 }:quality().well_centred, "equilateral ones are well centred")
near(dm.mesh { triangle = 1 }:quality().least, 1 / 3, 1e-15, "least coordinate of a centre")
local tiling = dm.mesh { cube_tiling = 1 }:quality()
ok(tiling.zero[2] == 6 and tiling.zero[1] == 7, "a cube of six tetrahedra: zero duals of 6 faces, 7 edges")
ok(dm.mesh { cube_tiling = 1, dual = "barycentric" }:quality().zero[2] == 0, "barycentric duals are not zero")

-- supports add up to |K|, whatever the signs and the centres
for _, options in ipairs { { grid = 3, map = function(x, y) return { x + y, y } end }, { cube_tiling = 2 }, { shells = { 4, 1 } },
  { shells = { 3, 2 }, dual = "barycentric" }, { annulus = { 2, 5 }, ratio = 3 } } do
  local K = dm.mesh(options)
  local n, binomial = K.dimension, 1
  for k = 0, n do
    local sum = K:volume(k):dot(K:dual_volume(k)) / binomial
    near(sum / K:volume(n):sum(), 1, 1e-12, ("supports of degree %d add up"):format(k))
    binomial = binomial * (n - k) // (k + 1)
  end
end

-- ---- flips

local function negative(K) return K:quality().negative[1] end
for _, s in ipairs { 0.5, 1, 1.5 } do
  local K = dm.mesh { grid = 6, map = function(x, y) return { x + s * y, y } end }
  local mended = K:make_delaunay()
  ok(mended:quality().delaunay and not K:quality().delaunay, ("a grid sheared by %g is mended inside"):format(s))
  near(mended:volume(2):sum(), 1, 1e-13, "its area stays")
  ok(mended.ambient == 2 and mended:count(0) == 49 and mended.euler == 1 and mended.manifold, "and its vertices and points")
end
ok(negative(dm.mesh { grid = 4, map = function(x, y) return { x + y / 2, y } end }:make_delaunay()) == 0, "no negative star is left")
-- a quadrilateral of lengths alone: the other diagonal is that of the plane
local quad = { { 0, 0 }, { 4, 0 }, { 1, 1 }, { 2.5, -0.7 } }
local other = dm.mesh { simplices = { { 1, 2, 3 }, { 1, 2, 4 } }, lengths = function(i, j)
  return (dm.vector(quad[i]) - dm.vector(quad[j])):norm()
end }:make_delaunay()
near(other:volume(1)[other:find { 3, 4 }], math.sqrt(1.5 ^ 2 + 1.7 ^ 2), 1e-14, "the length of an edge that flips")
near(other:volume(2):sum(), 3.4, 1e-14, "and the areas beside it")
local squeezed = dm.mesh { icosphere = 2, map = function(x, y, z) return { x, y, 4 * z } end }
local intrinsic = squeezed:make_delaunay()
ok(negative(squeezed) > 0 and negative(intrinsic) == 0 and intrinsic.ambient == nil and intrinsic.euler == 2, "a long ellipsoid, by lengths alone")
near(intrinsic:volume(2):sum(), squeezed:volume(2):sum(), 1e-11, "flips keep the area of a surface")
local well = dm.mesh { icosphere = 1 }
near((well:make_delaunay():volume(1) - well:volume(1)):norm(), 0, 1e-14, "what is Delaunay stays")
-- two triangles folded along a long edge, with the other diagonal there already
raises("no simplicial complex", function()
  local length = function(i, j) return i + j == 3 and 1.9 or 1 end
  return dm.mesh { simplices = { { 1, 2, 3 }, { 1, 2, 4 }, { 2, 3, 4 }, { 1, 3, 4 } }, lengths = length }:make_delaunay()
end)
raises("dimension 3", function() return dm.mesh { bcc = 3 }:make_delaunay() end)
raises("orientable", function() return dm.mesh { named = "rp2" }:make_delaunay() end)

-- ---- distances (Ex 3.4): four points of a circle

local fine, eigenvalues, dimension = dm.embeddable { { 0, 1, 2, 1 }, { 1, 0, 1, 2 }, { 2, 1, 0, 1 }, { 1, 2, 1, 0 } }
local sorted = eigenvalues:totable()
table.sort(sorted)
ok(not fine, "lengths of arcs are no distances of points")
for i, x in ipairs { -1, 0, 2, 2 } do near(sorted[i], x, 1e-13, "an eigenvalue of -J D^2 J / 2") end
local square
square, eigenvalues, dimension = dm.embeddable { { 0, 1, sqrt(2), 1 }, { 1, 0, 1, sqrt(2) }, { sqrt(2), 1, 0, 1 }, { 1, sqrt(2), 1, 0 } }
ok(square and dimension == 2, "a square has points in the plane")
raises("symmetric", dm.embeddable, { { 0, 1 }, { 2, 0 } })

-- ---- positions and lengths give the same (P33)

for _, options in ipairs { { triangle = 3 }, { icosphere = 1 }, { shells = { 3, 1 } } } do
  local K = dm.mesh(options)
  local L = dm.mesh { simplices = K:simplices(K.dimension), lengths = K:volume(1), dual = K.dual }
  for k = 0, K.dimension do
    near((K:dual_volume(k) - L:dual_volume(k)):norm(), 0, 1e-12, "duals from lengths")
    near((K:volume(k) - L:volume(k)):norm(), 0, 1e-12, "volumes from lengths")
  end
end

-- ---- cotangents (P6): |*e| / |e| is half the sum of the cotangents of the angles across

local K = dm.mesh { torus = { 12, 8 }, radii = { 3, 1 } }
local points, worst = K:points(), 0
for e, s in ipairs(K:simplices(1)) do
  local sum = 0
  for _, t in ipairs(K:cofaces(1, e)) do
    for _, v in ipairs(K:simplices(2)[t]) do
      if v ~= s[1] and v ~= s[2] then
        local a, b = points[s[1]] - points[v], points[s[2]] - points[v]
        sum = sum + a:dot(b) / a:cross(b):norm() / 2
      end
    end
  end
  worst = math.max(worst, math.abs(sum - K:dual_volume(1)[e] / K:volume(1)[e]))
end
ok(worst < 1e-12, "cotangent weights", worst)
tap.done()
