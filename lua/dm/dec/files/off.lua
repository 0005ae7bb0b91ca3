--- Object file format: OFF, the counts of vertices, faces and edges, then these.
local reader = require "dm.dec.files.reader"

local M = {}

-- counts stand on the line of the word OFF, or on the next
local function counts(r)
  local words = r:need "the word OFF"
  if not words[1]:find "^S?T?C?N?OFF$" then -- what these add stands behind the coordinates
    r:fail("an OFF file begins with the word OFF (got %s)", words[1])
  end
  table.remove(words, 1)
  if #words == 0 then words = r:need "the counts of vertices and faces" end
  return r:whole(words[1], "the count of vertices", 0), r:whole(words[2], "the count of faces", 0)
end

local function face(r, words, vertices)
  local n = r:whole(words[1], "the count of vertices of a face", 0)
  if n < 2 or n > 3 then
    r:fail("a face of %d vertices: meshes are of triangles (or edges); split it first", n)
  end
  local out = {}
  for j = 1, n do out[j] = r:whole(words[j + 1], "a vertex", 0, vertices - 1) + 1 end
  return out
end

function M.read(file)
  local r = reader.open(file, "#")
  local vertices, faces = counts(r)
  local points, simplices = {}, {}
  for i = 1, vertices do
    r:need("vertices", i, vertices)
    points[i] = r:point(1, 3, "a coordinate")
  end
  for i = 1, faces do r:add(simplices, face(r, r:need("faces", i, faces), vertices)) end
  r:ends("faces", faces)
  r:close()
  return reader.given(points, simplices)
end

return M
