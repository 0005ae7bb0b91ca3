--- .node and .ele of Triangle and TetGen: two files of one name, numbers from 0 or from 1.
local reader = require "dm.dec.files.reader"

local M = {}

-- points, and the number of the first one
local function nodes(file)
  local r = reader.open(file, "#")
  local words = r:need "the counts of nodes"
  local count = r:whole(words[1], "the count of nodes", 0)
  local dimension = r:whole(words[2], "the dimension", 2, 3)
  local points, first = {}, nil
  for i = 1, count do
    words = r:need("nodes", i, count)
    first = first or r:whole(words[1], "the number of the first node", 0, 1)
    r:whole(words[1], "the number of this node", first + i - 1, first + i - 1)
    points[i] = r:point(2, dimension + 1, "a coordinate")
  end
  r:ends("nodes", count)
  r:close()
  return points, first or 1
end

local function elements(file, points, first)
  local r = reader.open(file, "#")
  local words = r:need "the counts of elements"
  local count = r:whole(words[1], "the count of elements", 0)
  local size = r:whole(words[2], "the count of nodes of an element", 1)
  if size < 3 or size > 4 then
    r:fail("elements of %d nodes: triangles have 3, tetrahedra 4", size)
  end
  local simplices = {}
  for i = 1, count do
    words = r:need("elements", i, count)
    local out = {}
    for j = 1, size do
      out[j] = r:whole(words[j + 1], "a node", first, first + #points - 1) - first + 1
    end
    r:add(simplices, out)
  end
  r:ends("elements", count)
  r:close()
  return simplices
end

--- Either of the two names will do.
function M.read(file)
  local stem = file:gsub("%.%w+$", "")
  local points, first = nodes(stem .. ".node")
  return reader.given(points, elements(stem .. ".ele", points, first))
end

return M
