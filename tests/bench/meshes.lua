-- make bench: making a mesh, with its volumes and signed duals, from arrays of simplices and points; and the bytes that it holds. The same
-- by hand in C: tests/bench/c/by_hand/meshes.c, which make bench runs after it. Arguments: levels of the icosphere, cubes a side.
require "dm" -- the verbs of meshes
local core = require "dm.core"
local named = require "dm.dec.named"

local REPEATS = 9

local function flat(simplices)
  local out = {}
  for _, s in ipairs(simplices) do
    for _, v in ipairs(s) do out[#out + 1] = v end
  end
  return core.vector(out)
end

-- the tables of a mesh by name are gone before anything is timed: the collector would go through them meanwhile
local function arrays(made)
  return flat(made.simplices), core.matrix(made.points), #made.simplices[1] - 1, #made.simplices
end

local function race(name, simplices, points, degree, cells)
  local best, bytes, total = math.huge, 0, 0
  for _ = 1, REPEATS do
    collectgarbage()
    local began = os.clock()
    local K = core.complex { simplices = simplices, degree = degree, points = points }
    best = math.min(best, os.clock() - began)
    bytes, total = K.bytes, 0
    for k = 0, degree do total = total + K:count(k) end
  end
  print(("%-28s %s %9.1f ns a cell   (%d cells, %.1f bytes a cell of any degree)"):format(name, "dmlua               ",
    best / cells * 1e9, cells, bytes / total))
end

print "\nmeshes: cells, incidences, volumes, signed duals"
race("mesh of triangles", arrays(named.icosphere(tonumber(arg[1]) or 7)))
race("mesh of tetrahedra", arrays(named.cube_tiling(tonumber(arg[2]) or 30)))
