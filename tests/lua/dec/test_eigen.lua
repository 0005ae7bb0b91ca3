-- eigenvalues of Laplacians against closed forms
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin, pi, sqrt = math.cos, math.sin, math.pi, math.sqrt

local function spectrum(A, want, what)
  local found, worst = A:eigen(#want), 0
  for i = 1, #want do worst = math.max(worst, math.abs(found.values[i] - want[i])) end
  for i, r in ipairs(found.residuals:totable()) do
    worst = math.max(worst, r, math.abs(found.forms[i]:norm() - 1))
  end
  ok(#found.values == #want and worst < 1e-11, what, worst)
end
local function list(...)
  local out, given = {}, { ... }
  for i = 1, #given, 2 do for _ = 1, given[i + 1] do out[#out + 1] = given[i] end end
  return out
end

local cell5 = dm.mesh { simplex_boundary = 4 }
spectrum(cell5:laplacian(0), list(0, 1, 7.5, 4), "the boundary of a 4-simplex, functions")
spectrum(cell5:laplacian(1), list(7.5, 4, 80 / 3, 6), "1-forms")
spectrum(cell5:laplacian(2), list(80 / 3, 6, 45, 4), "2-forms")
spectrum(cell5:laplacian(3), list(0, 1, 45, 4), "3-forms")
local torus7 = dm.mesh { named = "csaszar7" }
spectrum(torus7:laplacian(0), list(0, 1, 14 / 3, 6), "Csaszar's torus, functions")
spectrum(torus7:laplacian(2), list(0, 1, 12 - 4 * sqrt(2), 6, 12 + 4 * sqrt(2), 6, 24, 1), "2-forms")
local icosahedron = dm.mesh { icosphere = 0 }
local edge = icosahedron:volume(1)[1]
local ICO = list(0, 1, 2, 3, 3 + 3 / sqrt(5), 5, 3 + sqrt(5), 3)
spectrum(icosahedron:laplacian(0), ICO, "the icosahedron in the unit sphere")
spectrum(icosahedron:laplacian(2), list(0, 1, 5 - sqrt(5), 3), "its 2-forms")
spectrum(icosahedron:laplace_beltrami(), list(0, 1, -2, 3), "nearest to 0, also from below")
local unit = dm.mesh { simplices = icosahedron:simplices(2), lengths = 1 }
near(unit:laplacian(0):eigen(2).values[2], 2 * edge ^ 2, 1e-13, "scaling")

-- the five-point scheme: right triangles have no diagonal
local N = 8
local grid = dm.mesh { grid = N }
near(grid:laplacian(0):eigen(2).values[2], 4 * N ^ 2 * sin(pi / (2 * N)) ^ 2, 1e-11, "Neumann")
near(grid:laplacian(0, { fixed = "boundary" }):eigen(1).values[1], 8 * N ^ 2 * sin(pi / (2 * N)) ^ 2, 1e-11, "Dirichlet")

-- n^2 vertices of the hexagonal torus: large ones by Lanczos iterations, where that is there
local function hexagonal(n)
  local out = {}
  for p = 0, n - 1 do
    for q = 0, n - 1 do
      local sum = 0
      for _, a in ipairs { p, q, p - q } do sum = sum + 1 - cos(2 * pi * a / n) end
      out[#out + 1] = 4 * n * n / 3 * sum
    end
  end
  table.sort(out)
  return out
end
local function close(found, want, from, what)
  local worst = 0
  for i = 1, #found.values do worst = math.max(worst, math.abs(found.values[i] - want[from + i]) / want[from + i]) end
  ok(worst < 1e-10, what .. ", " .. found.solver, worst)
end
for _, n in ipairs { 8, 20 } do
  local K, want = dm.mesh { hex_torus = n }, hexagonal(n)
  local A = K:laplacian(0)
  close(A:eigen(20, { above = 1 }), want, 1, "20 above 1")
  -- the least beyond a value inside: some multiplicity is cut
  local x = (want[13] + want[14]) / 2
  close(A:eigen(9, { above = x }), want, 13, "9 above a gap")
  local found = A:eigen(6, { near = want[2] + 0.3 }).values
  local worst = 0
  for i = 1, 6 do worst = math.max(worst, math.abs(found[i] - want[2])) end
  ok(worst < 1e-9, "6 near one of multiplicity 6", worst)
  local all = A:eigen(n * n)
  worst = 0
  for i = 1, #all.values do worst = math.max(worst, math.abs(all.values[i] - want[i]) / want[n * n]) end
  ok(worst < 1e-12 and #all.values >= n * n - 1, "all of them", worst)
  raises("is an eigenvalue", function() A:eigen(3, { above = want[2] }) end)
  raises("is an eigenvalue", function() A:eigen(3, { near = 0 }) end)
end

-- values know nothing of the order of vertices
local sphere = dm.mesh { icosphere = 3 }
local order, points, simplices = {}, {}, {}
for i = 1, sphere:count(0) do order[i] = 1 + (i * 101) % sphere:count(0) end
for i, p in ipairs(order) do points[p] = sphere:points()[i]:totable() end
for i, t in ipairs(sphere:simplices(2)) do simplices[i] = { order[t[3]], order[t[1]], order[t[2]] } end
local turned = dm.mesh { points = points, simplices = simplices }
for _, k in ipairs(require "dm.core".solvers() and { 0, 1 } or { 0 }) do
  local a, b = sphere:laplacian(k):eigen(16), turned:laplacian(k):eigen(16)
  ok((a.values - b.values):norm() < 1e-10, ("%d-forms in another order of vertices"):format(k), (a.values - b.values):norm())
end
-- spherical harmonics: l (l + 1), with order 2 (P32)
local function error_of(s, i, want) return math.abs(dm.mesh { icosphere = s }:laplacian(0):eigen(9).values[i] - want) end
local slope = math.log(error_of(2, 9, 6) / error_of(3, 9, 6)) / math.log(2)
ok(slope > 1.85 and slope < 2.25, "order of the eigenvalue 6", slope)
ok(error_of(3, 3, 2) < 1e-5, "and the eigenvalue 2", error_of(3, 3, 2))
-- curl curl of a cavity whose walls conduct: as many zeros as vertices inside
local cavity = dm.mesh { triangle = 8 }:laplacian(1, { part = "up", fixed = "boundary" })
local low = cavity:eigen(23).values
ok(math.abs(low[21]) < 1e-11 and math.abs(low[22] - 17.44597694) < 1e-8, "21 zero modes of a cavity", low[22])
near(cavity:eigen(2, { above = 1 }).values[1], 17.44597694, 1e-8, "the first beyond them")

-- what has no eigenvalues, or none that can be had
raises("whole number", function() sphere:laplacian(0):eigen(0) end)
raises("one of 'above' and 'near'", function() sphere:laplacian(0):eigen(1, { above = 1, near = 2 }) end)
raises("no eigenvalues", function() sphere:d(0):eigen(1) end)
local sheared = dm.mesh { grid = 4, map = function(x, y) return { x + y / 2, y } end }
raises("negative at 16 cells of degree 1", function() sheared:laplacian(1):eigen(1) end)
raises("make_delaunay", function() sheared:laplacian(1):eigen(1) end)
ok(sheared:make_delaunay():quality().negative[1] == 0
  and sheared:make_delaunay():laplacian(0):eigen(2).values[2] > 1, "flips mend it")
raises("every cell is fixed", function() dm.mesh { triangle = 1 }:laplacian(0, { fixed = "boundary" }):eigen(1) end)
local K = dm.mesh { triangle = 3 }
local skew = K:star(2, { dual = true }) * K:star(0) + K:laplacian(0)
ok(skew:eigen(1).values[1] > 0.99, "1 + a Laplacian")
-- cells of zero dual volume may leave the problem singular: that is said, not that the shift was bad
tap.raises("zero dual volume", function() return require "dm".mesh { cube_tiling = 2 }:laplacian(1):eigen(3) end)

---- units of length in which masses times eigenvalues are no doubles ----
local ball = dm.mesh { icosphere = 1 }
local function in_units(size)
  local places = {}
  for i, p in ipairs(ball:points()) do places[i] = { size * p[1], size * p[2], size * p[3] } end
  return dm.mesh { simplices = ball:simplices(2), points = places }
end
for _, size in ipairs { 1e-100, 1e80, 1e100 } do
  raises("another unit of length", function() in_units(size):laplacian(2):eigen(4) end)
end
for _, size in ipairs { 1e-60, 1e60 } do
  local values = in_units(size):laplacian(2):eigen(4).values * size ^ 2
  near(values[4], ball:laplacian(2):eigen(4).values[4], 1e-12, "eigenvalues of 2-forms in units of " .. size)
end
-- a grid of 6 by 6 thin cells: along it waves have 72 (1 - cos(k pi/6)), across it a^2 more; the
-- residuals bound what is off, and a note says where that is all of it
for _, a in ipairs { 1, 1e3, 1e6, 1e9 } do
  local points, cells, n = {}, {}, 6
  for j = 0, n do for i = 0, n do points[#points + 1] = { i / n, j / n / a } end end
  for j = 0, n - 1 do
    for i = 1, n do
      local k = j * (n + 1) + i
      cells[#cells + 1], cells[#cells + 2] = { k, k + 1, k + n + 2 }, { k, k + n + 2, k + n + 1 }
    end
  end
  local K, want = dm.mesh { simplices = cells, points = points }, {}
  for j = 0, n do
    for k = 0, n do
      want[#want + 1] = 2 * n ^ 2 * ((1 - cos(k * pi / n)) + a ^ 2 * (1 - cos(j * pi / n)))
    end
  end
  table.sort(want)
  local found, within = K:laplacian(0):eigen(4), true
  for i = 1, 4 do
    local nearest = math.huge
    for _, x in ipairs(want) do nearest = math.min(nearest, math.abs(x - found.values[i])) end
    within = within and nearest <= found.residuals[i]
  end
  ok(within, ("thin cells, 1 : %g: values are as near as residuals say"):format(a), tostring(found.values))
  ok((found.note ~= nil) == (a >= 1e6), ("thin cells, 1 : %g: a note"):format(a), found.note)
  for _, c in ipairs(a < 1e9 and { 9e16, 1e-12 } or {}) do -- as of light in m/s
    local note = (c * K:laplacian(0)):eigen(4).note
    ok((note ~= nil) == (a >= 1e6), ("  of %g times the Laplacian too"):format(c), note)
  end
end
tap.done()
