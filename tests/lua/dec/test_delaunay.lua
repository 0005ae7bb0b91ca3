-- Delaunay triangulations: no point inside of a circumsphere, the hull is filled, grids and other
-- points on spheres give complexes without cracks, what has no triangulation is named
local cochains = require "cochains"
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local fine, message = pcall(dm.delaunay, dm.matrix { { 0, 0 }, { 1, 0 }, { 0, 1 } })
if not fine then
  ok(message:find "libqhull%-dev", "without qhull the message names the package")
  tap.done()
  return
end

local centred = cochains.random(7)
local function random() return centred() + 0.5 end
local function cloud(count, n, scale, shift)
  local points = {}
  for i = 1, count do
    points[i] = {}
    for j = 1, n do points[i][j] = (scale or 1) * random() + (shift or 0) end
  end
  return points
end

-- the least distance of a point to a circumsphere that it is outside of, by the radius squared
local function emptiness(K)
  local n, points = K.dimension, K:points()
  local centres, least = K:circumcentres(n), math.huge
  for i, s in ipairs(K:simplices(n)) do
    local own = {}
    for _, v in ipairs(s) do own[v] = true end
    local function square(v)
      local d = points[v] - centres[i]
      return d:dot(d)
    end
    local radius = square(s[1])
    for v = 1, #points do
      if not own[v] then least = math.min(least, square(v) / radius - 1) end
    end
  end
  return least
end

for n, count in pairs { [2] = 200, [3] = 120, [4] = 60, [5] = 30 } do
  local K = dm.mesh { points = cloud(count, n) }
  ok(K.dimension == n and emptiness(K) > -1e-9, ("no point in a circumsphere, dimension %d"):format(n))
  ok(K.manifold and K.orientable and K.euler == 1 and K:quality().delaunay, "a ball, locally Delaunay")
  local far = dm.mesh { points = cloud(count, n, 1e-3, 1e4) }
  ok(far.manifold and far.euler == 1, "and of points far away")
end
ok(dm.mesh { points = cloud(12, 8) }.dimension == 8, "points of dimension 8")
local points = cloud(60, 2)
ok(dm.mesh { points = points }:simplices(2)[7][3] == dm.mesh { points = points }:simplices(2)[7][3]
  and dm.mesh { points = points }:volume(2) == dm.mesh { points = points }:volume(2), "the same every time")
local line = dm.mesh { points = { { 3 }, { 1 }, { 2.5 } } }
ok(line:count(1) == 2 and line:find { 1, 3 } and line:find { 2, 3 }, "points of a line")

-- points on common circles and spheres: a square grid, cubes, an octahedron, a regular polygon
for n, N in pairs { [2] = 12, [3] = 5, [4] = 2 } do
  local grid = {}
  for i = 0, (N + 1) ^ n - 1 do
    local p = {}
    for j = 1, n do p[j] = i // (N + 1) ^ (j - 1) % (N + 1) end
    grid[#grid + 1] = p
  end
  local K = dm.mesh { points = grid }
  near(K:volume(n):sum(), N ^ n, 1e-9, ("a grid of dimension %d is filled"):format(n))
  ok(K.manifold and K.euler == 1 and K:count(0) == #grid and emptiness(K) > -1e-9, "and is a ball, without cracks")
  local boundary = K:boundary()
  near(boundary:volume(n - 1):sum(), 2 * n * N ^ (n - 1), 1e-9, "whose boundary is that of the cube")
  ok(boundary:boundary() == nil and boundary.euler == 1 - (-1) ^ n, "a sphere")
end
local function rotated(points)
  local c, s, out = math.cos(0.7), math.sin(0.7), {}
  for i, p in ipairs(points) do out[i] = { c * p[1] - s * p[2], c * p[3] + s * (s * p[1] + c * p[2]), c * (s * p[1] + c * p[2]) - s * p[3] } end
  return out
end
local cubes = dm.mesh { cube_tiling = 8 }:points():totable()
local askew = dm.mesh { points = rotated(cubes) }
near(askew:volume(3):sum(), 1, 1e-12, "a turned grid is filled")
ok(askew.manifold and askew.euler == 1 and #askew:boundary():simplices(2) == 6 * 8 * 8 * 2, "and a ball with a cube's boundary")
local shuffled, order = {}, {}
for i = 1, #cubes do order[i] = (i * 100 - 1) % 729 + 1 end
for i = 1, #cubes do shuffled[i] = cubes[order[i]] end
local function named(K, number)
  local out = {}
  for i, s in ipairs(K:simplices(3)) do
    local cell = {}
    for j, v in ipairs(s) do cell[j] = number and number[v] or v end
    table.sort(cell)
    out[i] = table.concat(cell, " ")
  end
  table.sort(out)
  return table.concat(out, "; ")
end
ok(named(dm.mesh { points = cubes }) == named(dm.mesh { points = shuffled }, order), "in any order of points")
local sphere = dm.mesh { points = dm.mesh { icosphere = 2 }:points() }
ok(sphere:count(0) == 162 and sphere.manifold and sphere.euler == 1 and sphere:boundary():count(2) == 320, "points on a sphere")
local ring = {}
for i = 0, 99 do ring[i + 1] = { math.cos(2 * math.pi * i / 100), math.sin(2 * math.pi * i / 100) } end
local disc = dm.mesh { points = ring }
ok(disc:count(2) == 98 and disc.euler == 1, "a polygon of 100 points on a circle")
local turned = dm.mesh { points = ring, map = function(x, y) return { 2 * x, y } end }
ok(turned:count(2) == 98, "a map moves points after they are triangulated")
near(turned:volume(2):sum() / disc:volume(2):sum(), 2, 1e-12, "so the area is twice")

-- what has none
raises("points 2 and 4 are the same", dm.mesh, { points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 0 } } })
raises("smaller", dm.mesh, { points = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 3, 3 } } })
raises("smaller", dm.mesh, { points = { { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 2, 3, 1 } } })
raises("too few", dm.mesh, { points = { { 0, 0 }, { 1, 1 } } })
raises("1 to 8 coordinates", dm.mesh, { points = cloud(11, 9) })
raises("finite", dm.mesh, { points = { { 0, 0 }, { 1, 1 }, { 0, 0 / 0 } } })

-- simplices of many dimensions may be thin without being flat: one edge of 1, others of 1/100 across
for n = 4, 6 do
  local corners, volume = { {}, {} }, 1
  for k = 1, n + 1 do
    corners[k] = {}
    for i = 1, n do corners[k][i] = i == k - 1 and (i == 1 and 1 or 0.01) or 0 end
    volume = volume * (k <= n and (k == 1 and 1 or 0.01) / k or 1)
  end
  near(dm.mesh({ points = corners }):volume(n)[1] / volume, 1, 1e-12, "a thin simplex of dimension " .. n)
end
for n, count in pairs { [4] = 150, [5] = 70, [6] = 24 } do
  for try = 1, 3 do
    local fine, K = pcall(dm.mesh, { points = cloud(count, n) })
    tap.ok(fine and K.euler == 1 and K.manifold and #K:betti() == n + 1, ("random points, dimension %d, %d"):format(n, try), K)
  end
end
tap.done()
