-- mesh files: every format against the mesh that it describes, round trips bit for bit, and files
-- that are wrong, cut off or made at random
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local base = os.tmpname()
local made = { base }
local function file(extension, text)
  local name = base .. extension
  local handle = assert(io.open(name, "wb"))
  handle:write(text)
  handle:close()
  made[#made + 1] = name
  return name
end

---- what is read ----

-- a unit square cut along the diagonal 1-3, in every format
local square = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } }, simplices = { { 1, 2, 3 }, { 1, 3, 4 } } }
local texts = {
  [".off"] = "OFF # square\n4 2 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\n3 0 1 2\n3 0 2 3 255 0 0\n",
  [".obj"] = "# square\no square\nv 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nvn 0 0 1\nf 1/1/1 2//1 3\nf -4 -2 -1\n",
  [".msh"] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"a b\"\n$EndPhysicalNames\n$Nodes\n5\n11 0 0 0\n12 1 0 0\n99 7 7 0\n"
    .. "13 1 1 0\n14 0 1 0\n$EndNodes\n$Elements\n4\n1 15 2 0 1 11\n2 1 2 0 1 11 12\n3 2 2 0 1 11 12 13\n4 2 2 0 1 11 13 14\n$EndElements\n",
  [".mesh"] = "MeshVersionFormatted 2\nDimension\n3\nVertices\n4\n0 0 0 1\n1 0 0 1\n1 1 0 1 0 1 0 1\nCorners 2 1 2\nEdges\n1\n1 2 5\nTriangles 2\n"
    .. "1 2 3 0\n1 3 4 0\nEnd\n",
}
for extension, text in pairs(texts) do
  local K = dm.mesh(file(extension, text))
  ok(K:count(0) == 4 and K:count(1) == 5 and K:count(2) == 2 and K.ambient == 2, extension .. ": cells, in the plane")
  ok(K:volume(2) == square:volume(2) and K:points()[3] == square:points()[3], extension .. ": points")
  local windows = "\xEF\xBB\xBF" .. text:gsub("\n", "\r\n")
  ok(dm.mesh(file(extension, windows)):volume(2) == square:volume(2), extension .. ": with a byte order mark and CRLF")
end
local four = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n$EndEntities\n$Nodes\n2 5 1 5\n0 1 0 1\n1\n0 0 0\n3 1 0 4\n2\n3\n4\n5\n"
  .. "1 0 0\n0 1 0\n0 0 1\n9 9 9\n$EndNodes\n$Elements\n2 2 1 2\n2 1 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 4\n$EndElements\n"
local tetrahedron = dm.mesh(file(".msh", four))
ok(tetrahedron.dimension == 3 and tetrahedron:count(0) == 4, "version 4.1: the highest dimension alone")
near(tetrahedron:volume(3)[1], 1 / 6, 1e-15, "its volume")
for first = 0, 1 do
  local node = { "# a comment\n4 2 1 1\n" }
  for i, p in ipairs { "0 0", "1 0", "1 1", "0 1" } do node[i + 1] = ("%d %s 0.5 1\n"):format(i - 1 + first, p) end
  file(".node", table.concat(node))
  local ele = file(".ele", ("2 3 0\n%d %d %d %d\n%d %d %d %d\n"):format(first, first, first + 1, first + 2, first + 1, first, first + 2, first + 3))
  ok(dm.mesh(ele):volume(2) == square:volume(2), "nodes and elements from " .. first)
  ok(dm.mesh(base .. ".node"):count(2) == 2, "by the other name")
end

---- what is written ----

for _, spec in ipairs { { icosphere = 3 }, { torus = { 12, 8 }, radii = { 3, 1 } }, { grid = 5 } } do
  local K = dm.mesh(spec)
  for _, extension in ipairs { ".off", ".obj" } do
    made[#made + 1] = base .. extension
    local L = dm.mesh(K:save(base .. extension))
    ok(L:volume(2) == K:volume(2) and L:dual_volume(1) == K:dual_volume(1), extension .. ": read as written, bit for bit")
  end
end
local K = dm.mesh { shells = { 3, 1 } }
made[#made + 1] = base .. ".vtk"
local f = K:form(0, { 1, 2, 3, 4, 5, 6, 7 })
K:save(base .. ".vtk", { forms = { height = f, density = K:form(3, K:oriented(K:volume(3))) } })
local handle = io.open(base .. ".vtk")
local text = handle:read "a"
handle:close()
ok(text:find "POINTS 7 double" and text:find "CELLS 8 40" and text:find "POINT_DATA 7\nSCALARS height double 1\nLOOKUP_TABLE default\n1\n2\n",
  "vtk: points, cells, a form at the points")
ok(text:find "CELL_DATA 8\nSCALARS density double 1\nLOOKUP_TABLE default\n1\n1\n", "and a density")
-- forms of degree 2 in space are flows: a constant one is that vector in every cell
local slanted = dm.mesh { cube_tiling = 2, map = function(x, y, z) return { x + 0.3 * y * z, y - 0.2 * x * x, 2 * z + 0.1 * x } end }
slanted:save(base .. ".vtk", { forms = { flow = slanted:form(2, function() return { 0.7, 1.1, 0.3 } end) } })
local rows, off = 0, 0
for line in io.open(base .. ".vtk"):read "a":match "VECTORS flow double\n(.*)":gmatch "[^\n]+" do
  local x, y, z = line:match "(%S+) (%S+) (%S+)"
  rows, off = rows + 1, math.max(off, math.abs(x - 0.3), math.abs(y + 1.1), math.abs(z - 0.7))
end
ok(rows == slanted:count(3) and off < 1e-14, "vtk: a flow in space, a vector a cell", off)
-- a triangle with a path of two edges: cells that are faces of none are kept
local kite = dm.mesh { points = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 }, { 2, 2, 0 }, { 3, 1, 0 } },
  simplices = { { 1, 2, 3 }, { 2, 4 }, { 4, 5 } } }
for _, extension in ipairs { ".off", ".obj" } do
  local L = dm.mesh(kite:save(base .. extension))
  ok(L:count(1) == 5 and L:find { 2, 4 } and L:find { 4, 5 } and L:points() == kite:points(), "a tail comes back from " .. extension, L:count(1))
  os.remove(base .. extension)
end
kite:save(base .. ".vtk", { forms = { height = kite:form(0, { 1, 2, 3, 4, 5 }) } })
local tailed = io.open(base .. ".vtk"):read "a"
ok(tailed:find("CELLS 3 10\n3 0 1 2\n2 1 3\n2 3 4\nCELL_TYPES 3\n5\n3\n3\n", 1, true), ".vtk has its cells by their types", tailed)
raises("faces of none", function() kite:save(base .. ".vtk", { forms = { area = kite:form(2, { 1 }) } }) end)
raises(".vtk", function() K:save(base .. ".off") end)
raises("degree", function() K:save(base .. ".vtk", { forms = { x = f:d():star() } }) end)
raises("points", function() dm.mesh { named = "rp2" }:save(base .. ".obj") end)
raises("saved as", function() square:save(base .. ".stl") end)
raises("cannot open", function() square:save(base .. "/no/such.off") end)

---- what is refused, with its line ----

local square_2 = texts[".msh"]

for _, row in ipairs { { ".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "line 6: a vertex must be a whole number from 0 to 2" },
  { ".off", "OFF\n2000000000 9 0\n", "line 3: the file ends, 0 of 2000000000 vertices are there" },
  { ".off", "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "line 4: a coordinate must be a finite number" },
  { ".off", "OFF\n3 1 0\n0 0 0\n1 0 1e999\n", "line 4" }, { ".off", "OFF\n-1 1 0\n", "line 2" },
  { ".off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", "split it first" },
  { ".off", "ply\n", "line 1: an OFF file begins" }, { ".off", "", "line 1" },
  { ".off", "OFF\n\0\1\2", "line 2: this is binary" }, { ".obj", "v 0 0 0\nhello\n", "line 2: 'hello' is no line" },
  { ".obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n", "line 3" }, { ".obj", "v 0 0\n", "line 1" }, { ".obj", "v 0 0 0x10\n", "line 1" },
  { ".obj", "v 0 0 0\n", "no simplices" },
  { ".msh", "$MeshFormat\n2.2 1 8\n", "binary" }, { ".msh", "$MeshFormat\n3 0 8\n", "line 2: version 3" },
  { ".msh", "$Nodes\n1\n", "line 1: $MeshFormat must come first" },
  { ".msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 2 0 1 1 7\n", "line 10: there is no node 7" },
  { ".msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n1\n1 3 0 1 2 3 4\n", "quadrangle" },
  { ".mesh", "MeshVersionFormatted 1\nDimension 3\nVertices 3\n0 0 0 0\n", "line 5" },
  { ".mesh", "MeshVersionFormatted 1\nDimension 2\nVertices 1\n0 0 0\nTriangles 1\n1 1 2 0\n", "line 6" },
  { ".mesh", "MeshVersionFormatted 1\nDimension 2\nQuadrilaterals 1\n", "no simplices" },
  { ".off", "OFF\n4 2 0\n0 0 0\n1 0 0\n2 0 0\n0 1 0\n3 0 1 3\n\n3 0 1 2\n",
    "line 9: the simplex of degree 2 {1, 2, 3} is degenerate" },
  { ".off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n",
    "line 7: simplex 2, {3, 2, 1}, is a duplicate" },
  { ".obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 2\n", "line 4: a vertex is repeated in simplex 1" },
  { ".mesh", "MeshVersionFormatted 1\nDimension 2\nVertices 4\n9 9 0\n0 0 0\n1e200 0 0\n"
    .. "0 1 0\nEdges 1 1 2 0\nTriangles 1\n2 3 4 0\n", "line 10: edge {1, 2} is too long" },
  { ".off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
    "line 8: more faces stand here than the 1 that are counted" },
  { ".msh", square_2:gsub("Elements\n4", "Elements\n3"), "more elements stand here than the 3" },
  { ".msh", square_2:gsub("Nodes\n5", "Nodes\n4"), "more nodes stand here than the 4" },
  { ".msh", square_2:gsub("%$EndElements\n", ""), "the file ends where $EndElements should stand" },
  { ".msh", four:gsub("Elements\n2", "Elements\n1"), "more blocks of elements stand here than the 1" },
  { ".msh", four:gsub("Nodes\n2", "Nodes\n1"), "more blocks of nodes stand here than the 1" },
  { ".stl", "solid\n", "a mesh file ends in" } } do
  raises(row[3], function() dm.mesh(file(row[1], row[2])) end)
end
raises("cannot open", function() dm.mesh "no/such/file.off" end)
file(".node", "3 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n")
local two = file(".ele", "1 3 0\n0 0 1 2\n1 0 2 3\n")
raises(".node, line 5: more nodes stand here than the 3", dm.mesh, two)
file(".node", "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n")
raises(".ele, line 3: more elements stand here than the 1", dm.mesh, two)

-- a byte of every format changed, cut or doubled at random: a mesh or an error, nothing else
local random, draws = dm.random(11), 0
local function draw(n)
  draws = draws + 1
  return math.floor(random:uniform(draws, 0) * n)
end
texts["4.msh"] = four
local refused, total = 0, 0
for extension, whole in pairs(texts) do
  for _ = 1, 150 do
    local at, kind = 1 + draw(#whole), draw(4)
    local changed = kind == 0 and whole:sub(1, at) or whole:sub(1, at - 1)
      .. (kind == 1 and string.char(draw(256)) or kind == 2 and tostring(draw(1e9)) or "") .. whole:sub(at + 1)
    local fine, why = pcall(dm.mesh, file(extension:match "%.%a+$", changed))
    total = total + 1
    if not fine then
      refused = refused + 1
      if not tostring(why):find "dm.mesh" then ok(false, "an error of dm.mesh", why) end
    end
  end
end
ok(refused > total / 10 and refused < total, "files with a byte changed are read or refused", refused)
for _, name in ipairs(made) do os.remove(name) end
os.remove(base .. ".node")
tap.done()
