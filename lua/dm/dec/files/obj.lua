--- Wavefront object files: lines v x y z, f i j k (numbers from 1, or from the end when negative;
-- i/j/k for textures and normals), l i j.
local reader = require "dm.dec.files.reader"

local M = {}

-- lines that say nothing about the mesh
local OTHERS = {}
for word in ("vn vt vp g o s usemtl mtllib p cstype deg surf curv parm end"):gmatch "%S+" do
  OTHERS[word] = true
end

local function vertex(r, word, count)
  local index = r:whole(word:match "^[^/]*", "a vertex", -count, count)
  if index == 0 then r:fail("vertices are numbered from 1") end
  return index > 0 and index or count + index + 1
end

local function cell(r, words, least, most, points)
  local n = #words - 1
  if n < least or n > most then
    r:fail("'%s' with %d vertices: meshes are of triangles (or edges); split it first", words[1], n)
  end
  local out = {}
  for j = 1, n do out[j] = vertex(r, words[j + 1], #points) end
  return out
end

function M.read(file)
  local r, points, simplices = reader.open(file, "#"), {}, {}
  for words in function() return r:next() end do
    local kind = words[1]
    if kind == "v" then points[#points + 1] = r:point(2, 4, "a coordinate")
    elseif kind == "f" then r:add(simplices, cell(r, words, 3, 3, points))
    elseif kind == "l" then r:add(simplices, cell(r, words, 2, 2, points))
    elseif not OTHERS[kind] then r:fail("'%s' is no line of an obj file", kind:sub(1, 40)) end
  end
  r:close()
  return reader.given(points, simplices)
end

return M
