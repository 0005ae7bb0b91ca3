--- Medit's .mesh, as text: words in any lines, keywords before their numbers. The simplices of the
-- highest dimension are read.
local reader = require "dm.dec.files.reader"

local M = {}

local SIMPLICES = { Edges = 2, Triangles = 3, Tetrahedra = 4 }
-- lists that say nothing about the mesh, and how many numbers an entry has; d: the dimension
local OTHERS = { Corners = 1, RequiredVertices = 1, Ridges = 1, RequiredEdges = 1,
  RequiredTriangles = 1, Normals = "d", Tangents = "d", NormalAtVertices = 2,
  TangentAtVertices = 2, TangentAtEdges = 3, SubDomain = 4, SubDomainFromMesh = 4,
  SubDomainFromGeom = 4 }
local REFUSED = { Quadrilaterals = true, Hexahedra = true, Hexaedra = true, Prisms = true,
  Pyramids = true }

local function count_of(r, what) return r:whole(r:word(what), "the count of " .. what, 0) end

local function vertices(m)
  local r = m.reader
  if not m.dimension then r:fail("Dimension must come before Vertices") end
  for _ = 1, count_of(r, "Vertices") do
    local p = {}
    for j = 1, m.dimension do p[j] = r:number(r:word "a coordinate", "a coordinate") end
    r:word "a reference"
    m.points[#m.points + 1] = p
  end
end

local function simplices(m, name)
  local r = m.reader
  for _ = 1, count_of(r, name) do
    local out = {}
    for j = 1, SIMPLICES[name] do out[j] = r:whole(r:word "a vertex", "a vertex", 1, #m.points) end
    r:word "a reference"
    r:add(m.simplices, out)
  end
end

local function section(m, name)
  local r = m.reader
  if name == "MeshVersionFormatted" then r:whole(r:word "a version", "the version", 1, 4)
  elseif name == "Dimension" then
    m.dimension = r:whole(r:word "a dimension", "the dimension", 2, 3)
  elseif name == "Vertices" then vertices(m)
  elseif SIMPLICES[name] then simplices(m, name)
  elseif OTHERS[name] then
    local each = OTHERS[name] == "d" and (m.dimension or 3) or OTHERS[name]
    for _ = 1, count_of(r, name) * each do r:word(name) end
  elseif REFUSED[name] then
    if count_of(r, name) > 0 then r:fail("%s are no simplices: split them first", name) end
  else
    r:fail("'%s' is no keyword of a .mesh file", name:sub(1, 40))
  end
end

function M.read(file)
  local r = reader.open(file, "#")
  local m = { reader = r, points = {}, simplices = {} }
  for name in function() return r:word() end do
    if name == "End" then break end
    section(m, name)
  end
  r:close()
  return reader.top(m.points, m.simplices)
end

return M
