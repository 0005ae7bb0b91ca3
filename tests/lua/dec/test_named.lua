-- meshes by name: numbers of cells, and invariants of cochains that an independent program made
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function counts(K)
  local out = {}
  for k = 0, K.dimension do out[k + 1] = K:count(k) end
  return table.concat(out, " ")
end
for _, row in ipairs {
  { { icosphere = 2 }, "162 480 320", 2 }, { { hex_torus = 5 }, "25 75 50", 0 },
  { { bcc = 3 }, "54 378 648 324", 0 }, { { cube_tiling = 2 }, "27 98 120 48", 1 },
  { { simplex_boundary = 5 }, "6 15 20 15 6", 2 }, { { shells = { 3, 2 } }, "13 48 68 32", 1 },
  { { shells = { 3, 3 } }, "19 78 116 56", 1 }, { { named = "dunce" }, "8 24 17", 1 },
  { { named = "rp2" }, "6 15 10", 1 }, { { named = "csaszar7" }, "7 21 14", 0 },
  { { klein = 4 }, "16 48 32", 0 }, { { cross_polytope = 4 }, "8 24 32 16", 0 },
  { { annulus = { 3, 24 }, ratio = 1.5 }, "96 240 144", 0 },
  { { torus = { 24, 10 }, radii = { 3, 1 } }, "240 720 480", 0 } } do
  local K = dm.mesh(row[1])
  local name = next(row[1])
  ok(counts(K) == row[2] and K.euler == row[3], name .. " has the cells that it should", counts(K))
end
ok(not dm.mesh { klein = 4 }.orientable and not dm.mesh { named = "rp2" }.orientable
  and dm.mesh { named = "csaszar7" }.orientable, "who has an orientation")

-- |c|^2 and |dc|^2 of one cochain each
local function cochain(K, k)
  local x = {}
  for i = 1, K:count(k) do x[i] = ((29 * (i - 1) + 13 * k + 7) % 89) / 44.5 - 1 end
  return K:form(k, x)
end
local function bend(x, y)
  local pi = math.pi
  return { x + 0.05 * math.sin(pi * x) * math.sin(pi * y),
    y + 0.05 * math.sin(2 * pi * x) * math.sin(pi * y) }
end
for _, row in ipairs { { { triangle = 5, map = bend }, 1, 7.40272014958, 1849.44840206 },
  { { icosphere = 2 }, 1, 92.2999885646, 9652.46523822 }, { { bcc = 4 }, 2, 2048.533266, 935976.075748 },
  { { simplex_boundary = 5 }, 3, 12.5661317953, 290.028828625 } } do
  local c = cochain(dm.mesh(row[1]), row[2])
  near(c:norm() ^ 2 / row[3], 1, 1e-9, "norm of a cochain")
  near(c:d():norm() ^ 2 / row[4], 1, 1e-9, "norm of its derivative")
end

-- codifferentials and wedges of the same program; d and delta are adjoint
local flat = dm.mesh { triangle = 5, map = bend }
for _, row in ipairs { { flat, 1, 156.615180652 }, { dm.mesh { icosphere = 2 }, 1, 1014.43003721 },
  { dm.mesh { bcc = 4 }, 2, 351206.015402 }, { dm.mesh { simplex_boundary = 5 }, 3, 687.239867791 } } do
  local c = cochain(row[1], row[2])
  near(c:delta():norm() ^ 2 / row[3], 1, 1e-9, "norm of a codifferential")
  local b = cochain(row[1], row[2] - 1)
  near(b:d():dot(c) / b:dot(c:delta()), 1, 1e-11, "d and delta are adjoint")
end
local a, f = cochain(flat, 1), cochain(flat, 0)
local b = flat:form(1, a.values:map(function(x, i) return math.sin(3 * i) + x end))
near((a:wedge(b) + b:wedge(a)):max(), 0, 1e-14, "1-forms anticommute")
near((f:wedge(a):d() - f:d():wedge(a) - f:wedge(a:d())):max(), 0, 1e-14, "Leibniz' rule")
near((f:wedge(a, { rule = "cup" }):d() - f:d():wedge(a, { rule = "cup" }) - f:wedge(a:d(), { rule = "cup" })):max(),
  0, 1e-14, "Leibniz' rule of cup products")
-- worked by hand: a = (01: 1, 02: 0, 12: 2), b = (01: 3, 02: 1, 12: -1)
for _, row in ipairs { { { { 0, 0 }, { 1, 0 }, { 0, 1 } }, -7 / 8 }, { { { 0, 0 }, { 3, 0 }, { 1, 2 } }, -59 / 48 },
  { { { 0, 0 }, { 1, 0 }, { 0.5, math.sqrt(3) / 2 } }, -4 / 3 } } do
  local T = dm.mesh { points = row[1], simplices = { { 1, 2, 3 } } }
  local p, q = T:form(1, { 1, 0, 2 }), T:form(1, { 3, 1, -1 })
  near(p:wedge(q)[1], -4 / 3, 1e-15, "natural wedge of one triangle")
  near(p:wedge(q, { rule = "metric" })[1], row[2], 1e-14, "and the metric one")
end
-- one tetrahedron: not associative
local T = dm.mesh { simplex_boundary = 4 }
local function unit(i, j)
  local cell, sign = T:find { i, j }
  local x = dm.vector(T:count(1))
  x[cell] = sign
  return T:form(1, x)
end
local e1, e2, e3 = unit(1, 2), unit(1, 3), unit(2, 4)
near(e1:wedge(e2):wedge(e3):at { 1, 2, 3, 4 }, 1 / 72, 1e-16, "(a ^ b) ^ c")
near(e1:wedge(e2:wedge(e3)):at { 1, 2, 3, 4 }, 0, 1e-16, "a ^ (b ^ c)")

-- areas of icospheres (they tend to 4 pi), volumes of a cube and a ball of shells
near(dm.mesh { icosphere = 0 }:volume(2):sum(), 9.574541, 1e-6, "area of the icosahedron")
near(dm.mesh { icosphere = 3 }:volume(2):sum(), 12.506493, 1e-6, "area of icosphere(3)")
near(dm.mesh { cube_tiling = 3 }:volume(3):sum(), 1, 1e-14, "volume of a cube")
near(dm.mesh { shells = { 3, 2 } }:volume(3):sum(), 8 * 2 ^ 3 / 6, 1e-13, "volume of an octahedron of radius 2")

-- memory, in every dimension: all arrays by all cells
for n, shells in pairs { [2] = 40, [3] = 12, [4] = 6, [5] = 4, [6] = 3, [7] = 2, [8] = 2 } do
  local K, cells = dm.mesh { shells = { n, shells } }, 0
  for k = 0, n do cells = cells + K:count(k) end
  ok(K.bytes <= 72 * cells, ("at most 72 bytes a cell of any degree, dimension %d"):format(n), K.bytes / cells)
end

-- chains: integers, boundaries, Stokes
local K = dm.mesh { cube_tiling = 2 }
local c = K:chain(2, { { 3, K:simplices(2)[7] }, { -2, K:simplices(2)[31] } })
ok(c:boundary():boundary() == K:chain(0, {}), "the boundary of a boundary is 0")
near(cochain(K, 1):d():pair(c), cochain(K, 1):pair(c:boundary()), 1e-13, "Stokes")
ok(K:chain(1, { { 1, { 2, 1 } } }) == -K:chain(1, { { 1, { 1, 2 } } }), "a turned edge is the negative one")
ok(dm.mesh { icosphere = 1 }:fundamental():boundary():support()[1] == nil, "a sphere has no boundary")
raises("64 bits", function() return math.maxinteger * c end)
raises("integer", function() return 0.5 * c end)
raises("no cell", function() return K:chain(1, { { 1, { 1, 27 } } }) end)
raises("orient", function() dm.mesh { named = "rp2" }:fundamental() end)
raises("did you mean 'icosphere'", dm.mesh, { icospere = 2 })
raises("whole number", dm.mesh, { grid = 0 })
raises("whole number", dm.mesh, { grid = 2.5 })
ok(dm.mesh { triangle = 2 ^ 2 }:count(0) == 15 and dm.mesh { torus = { 2 ^ 2, 2 ^ 2 }, radii = { 2, 1 } }:count(0) == 16, "2^2 is a whole number")
raises("far above", dm.mesh, { simplices = { { 1, 2, 2000000000 } } })
raises("one of", dm.mesh, { grid = 2, triangle = 2 })
-- what is far too large is refused before it is made
for name, size in pairs { triangle = 10 ^ 6, klein = 10 ^ 6, torus = { 10 ^ 9, 10 ^ 9 }, annulus = { 10 ^ 6, 10 ^ 6 },
  shells = { 2, 10 ^ 12 } } do
  if type(size) == "table" then size = { size[1] // 1 | 0, size[2] // 1 | 0 } else size = size // 1 | 0 end
  raises("vertices are too many for a mesh", dm.mesh, { [name] = size, radii = name == "torus" and { 2, 1 } or nil,
    ratio = name == "annulus" and 2 or nil })
end
raises("cross_polytope must be a whole number from 2 to 9 (got 60)", dm.mesh, { cross_polytope = 60 })
raises("simplex_boundary must be a whole number from 2 to 9 (got 70)", dm.mesh, { simplex_boundary = 70 })
raises("shells[1] must be a whole number from 1 to 8 (got 30)", dm.mesh, { shells = { 30, 2 } })
tap.ok(dm.mesh { cross_polytope = 9 }.dimension == 8, "up to dimension 8")

tap.done()
