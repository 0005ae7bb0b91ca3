-- make bench: making a mesh, with its volumes and signed duals, from arrays of simplices and points, and by name; the bytes that it
-- holds; Delaunay triangulations; Betti numbers of 10^6 cells. Meshes by hand in C: tests/bench/c/by_hand/meshes.c, which make bench
-- runs after it. Arguments: levels of the icosphere, cubes a side.
local dm = require "dm"
local core = require "dm.core"
local named = require "dm.dec.named"

local REPEATS = 9

-- make(): the mesh
local function race(name, make)
  local best, bytes, total, cells = math.huge, 0, 0, 0
  for _ = 1, REPEATS do
    collectgarbage()
    local began = os.clock()
    local K = make()
    best = math.min(best, os.clock() - began)
    bytes, total, cells = K.bytes, 0, K:count(K.dimension)
    for k = 0, K.dimension do total = total + K:count(k) end
  end
  print(("%-28s %s %9.1f ns a cell   (%d cells, %.1f bytes a cell of any degree)"):format(name, "dmlua               ",
    best / cells * 1e9, cells, bytes / total))
end

local function of_arrays(made)
  local given = { simplices = made.simplices, degree = made.degree, points = core.matrix(made.points) }
  return function() return core.complex(given) end
end

local function by_name(key, size)
  return function() return dm.mesh { [key] = size } end
end

local level, side = tonumber(arg[1]) or 7, tonumber(arg[2]) or 30
print "\nmeshes: cells, incidences, volumes, signed duals"
race("mesh of triangles", of_arrays(named.icosphere(level)))
race("mesh of tetrahedra", of_arrays(named.cube_tiling(side)))
race("icosphere by name", by_name("icosphere", level))
race("cube tiling by name", by_name("cube_tiling", side))

-- curvature: what it costs beside the volumes and duals, the difference of making a mesh with points and without
local function curvature(made)
  local given = { simplices = made.simplices, degree = made.degree, points = core.matrix(made.points) }
  local bare, K = { simplices = made.simplices, degree = made.degree }, core.complex(given)
  local function best(f)
    local least = math.huge
    for _ = 1, REPEATS do
      collectgarbage()
      local began = os.clock()
      f()
      least = math.min(least, os.clock() - began)
    end
    return least / K:count(K.dimension) * 1e9
  end
  local stars = best(function() core.complex(given) end) - best(function() core.complex(bare) end)
  local first = best(function() core.complex(given):levi_civita():angle() end) - best(function() core.complex(given) end)
  print(("%-28s dmlua                %9.1f ns a cell   (volumes and duals %.1f, the first time %.1f)"):format("Levi-Civita, all angles",
    best(function() K:levi_civita():angle() end), stars, first))
end
curvature(named.icosphere(level))

-- the best of three: run(make()), wall time, as qhull works in a process of its own
local function seconds(name, size, unit, make, run)
  local best = math.huge
  for _ = 1, 3 do
    local x = make()
    collectgarbage()
    local began = dm.clock()
    run(x)
    best = math.min(best, dm.clock() - began)
  end
  print(("%-28s %s %9.3f s   (%d %s)"):format(name, "dmlua               ", best, size, unit))
end

print "\nDelaunay triangulations (qhull), topology"
for _, row in ipairs { { 2, 100000 }, { 3, 30000 } } do
  local n, count = row[1], row[2]
  seconds("Delaunay, dimension " .. n, count, "points", function()
    local points = {}
    math.randomseed(1)
    for i = 1, count do
      points[i] = {}
      for c = 1, n do points[i][c] = math.random() end
    end
    return core.matrix(points)
  end, core.delaunay)
end
for _, given in ipairs { { grid = 408 }, { bcc = 27 } } do
  local function make() return dm.mesh(given) end
  local K, cells = make(), 0
  for k = 0, K.dimension do cells = cells + K:count(k) end
  seconds("Betti numbers, dimension " .. K.dimension, cells, "cells of any degree", make, function(x) x:betti() end)
end

print "\ngrowth: ns a cell, three sizes"
for _, key in ipairs { "icosphere", "cube_tiling" } do
  for k = 2, 0, -1 do
    race(key, of_arrays(named[key](key == "icosphere" and level - k or math.tointeger((side + 2) // 2 ^ k))))
  end
end
for _, size in ipairs { 100, 200, 400 } do
  local best, cells = math.huge, 0
  for _ = 1, 5 do
    collectgarbage()
    local began = os.clock()
    local K = dm.mesh { grid = size }
    K:betti()
    best, cells = math.min(best, os.clock() - began), 0
    for k = 0, K.dimension do cells = cells + K:count(k) end
  end
  print(("%-28s dmlua                %9.1f ns a cell   (%d cells of any degree)"):format("grid and Betti numbers", best / cells * 1e9,
    cells))
end
