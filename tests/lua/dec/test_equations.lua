-- Poisson, Darcy, harmonic forms and the decomposition of Hodge
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, pi, exp = math.sin, math.cos, math.pi, math.exp
local function bend(x, y) return { x + 0.05 * sin(pi * x) * sin(pi * y), y + 0.05 * sin(2 * pi * x) * sin(pi * y) } end
local function cochain(K, k, shift)
  local x = {}
  for i = 1, K:count(k) do x[i] = sin(7 * i + i * i + (shift or 0)) end
  return K:form(k, x)
end

-- ---- Poisson (P25): u = cos(3 x) e^y, delta d u = 8 u
local function u(x, y) return cos(3 * x) * exp(y) end
local function f(x, y) return 8 * u(x, y) end
local errors = {}
for i, N in ipairs { 8, 16, 32 } do
  local K = dm.mesh { triangle = N, map = bend }
  errors[i] = (K:poisson { f = f, fixed = { boundary = u } } - K:form(0, u)):norm()
end
near(errors[1], 6.7617e-4, 5e-9, "N = 8")
near(errors[2], 1.66655e-4, 5e-10, "N = 16")
near(errors[3], 4.1513e-5, 5e-10, "N = 32")
-- order 2 also where stars are negative; the report counts them
local last, slope
for _, N in ipairs { 8, 16 } do
  local K = dm.mesh { grid = N, map = function(x, y) return { x + y / 2, y } end }
  local solved, report = K:poisson { f = f, fixed = { boundary = u } }
  local now = (solved - K:form(0, u)):max()
  ok(report.negative_stars == N * N, "negative stars are reported", report.negative_stars)
  slope, last = last and math.log(last / now) / math.log(2), now
end
ok(slope > 1.7, "order on a sheared grid", slope)

-- linear functions are exact, with any mixture of what is given at the boundary
local K = dm.mesh { triangle = 6, map = bend }
local function plane(x, y) return 1 + 2 * x - y end
local fixed = {}
for _, v in ipairs(K:boundary_cells(0)) do fixed[v] = plane(K:points()[v][1], K:points()[v][2]) end
ok((K:poisson { fixed = fixed } - K:form(0, plane)):max() < 1e-13, "vertices one by one")
local square = dm.mesh { grid = 5 }
local function slope_out(x, y) -- du/dn of 1 + 2x - y on the unit square
  return x == 1 and 2 or x == 0 and -2 or y == 1 and -1 or 1
end
ok((square:poisson { fixed = { [1] = 1 }, flux = slope_out } - square:form(0, plane)):max() < 1e-13,
  "flux through the boundary")
local free, report = square:poisson { f = 3, flux = slope_out }
local mean = free:dot(square:form(0, function() return 1 end))
ok(math.abs(mean) < 1e-14 and math.abs(report.mean - 3) < 1e-12 and report.text:find "mean",
  "without a fixed value the mean goes, and it is said")
ok((free - square:form(0, plane) - (free[1] - 1) * square:form(0, function() return 1 end)):max() < 1e-12,
  "the rest is right")
-- two components, one of them held
local two = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 0.4, 0.9 }, { 5, 0 }, { 6, 0 }, { 5.4, 0.9 } },
  simplices = { { 1, 2, 3 }, { 4, 5, 6 } } }
local parts, said = two:poisson { f = { 1, 2, -1, 1, 2, -1 }, fixed = { [2] = 7 } }
ok(parts[2] == 7 and said.mean and said.unknowns == 4, "a component that nothing holds")
local load, area = two:form(0, { 0, 0, 0, 1, 2, -1 }), two:form(0, { 0, 0, 0, 1, 1, 1 })
near(said.mean, load:dot(area) / area:dot(area), 1e-13, "its mean")
near(parts:dot(area), 0, 1e-13, "its solution has mean 0")
-- the sphere: delta d z = 2 z, order 2
local function sphere_error(s)
  local S = dm.mesh { icosphere = s }
  local z = S:form(0, function(_, _, z) return z end)
  return (S:poisson { f = 2 * z } - z):norm()
end
slope = math.log(sphere_error(2) / sphere_error(3)) / math.log(2)
ok(slope > 1.9 and slope < 2.2, "on the sphere", slope)

-- every solver gives the same
local by = {}
for _, way in ipairs { "cholesky", "lu", "gradients", "dense" } do
  if dm.mesh and (way == "gradients" or way == "dense" or require "dm.core".solvers()) then
    local solved, how = K:poisson { f = f, fixed = { boundary = u }, solver = way }
    by[#by + 1] = solved
    ok((solved - by[1]):max() < 1e-11 and how.solver, way .. ": " .. how.solver, (solved - by[1]):max())
  end
end
raises("no vertex 999", function() K:poisson { fixed = { [999] = 1 } } end)
raises("finite", function() K:poisson { f = function() return 0 / 0 end } end)
raises("option 'solver'", function() K:poisson { solver = "magic" } end)
raises("metric", function() dm.mesh { simplices = { { 1, 2, 3 } } }:poisson { f = 1 } end)
raises("points", function() dm.mesh { hex_torus = 3 }:poisson { f = f } end)

-- ---- Darcy
local flow = K:darcy { pressure = plane }
ok((flow.flux - K:form(1, function() return { -1, -2 } end)):max() < 1e-13, "constant flow is exact (n = 2)")
ok((flow.pressure - K:form(0, plane, { dual = true })):max() < 1e-13, "and the pressure")
local ico, cone = dm.mesh { icosphere = 0 }, {} -- twenty tetrahedra round a vertex
for i, t in ipairs(ico:simplices(2)) do cone[i] = { t[1], t[2], t[3], 13 } end
local tips = {}
for i = 1, 12 do tips[i] = ico:points()[i]:totable() end
tips[13] = { 0.03, -0.02, 0.01 }
local box = dm.mesh { points = tips, simplices = cone }
flow = box:darcy { pressure = function(x, y, z) return x - 2 * y + 3 * z end }
local v = { -1, 2, -3 } -- v1 dy dz - v2 dx dz + v3 dx dy
ok((flow.flux - box:form(2, function() return { v[3], -v[2], v[1] } end)):max() < 1e-12, "n = 3")
-- right triangles share centres; layers in series; what flows in flows out
local layers = dm.mesh { grid = 4 }
flow = layers:darcy { permeability = function(x) return x < 0.5 and 1 or 4 end,
  pressure = function(x) return x == 0 and 1 or x == 1 and 0 or nil end }
local through = 1 / (0.5 / 1 + 0.5 / 4)
ok((flow.flux - layers:form(1, function() return { 0, through } end)):max() < 1e-13, "layers in series")
ok(flow.report.note:find "zero dual", "cells with one centre are solved for together")
flow = layers:darcy { source = 2, flux = function(x, y) return x == 1 and 2 or 0 end }
ok((flow.flux - layers:form(1, function(x) return { 0, 2 * x } end)):max() < 1e-12 and flow.report.mean,
  "a source that flows out on one side")
near(flow.flux:d():pair(layers:fundamental()), 2, 1e-13, "div v = q")
-- a right triangle whose rim is shut has nothing to solve for: by every way
for _, way in ipairs { "cholesky", "lu", "dense" } do
  local shut = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 0, 1 } }, simplices = { { 1, 2, 3 } } }
  local still = shut:darcy { source = 3, solver = way }
  ok(still.flux:max() == 0 and still.pressure:max() == 0, "a triangle that is shut, " .. way)
end
local wrong = dm.mesh { grid = 2 }:darcy { source = 1 }
ok(math.abs(wrong.report.mean - 1) < 1e-13 and wrong.flux:max() < 1e-13, "a source with nowhere to go is taken away")
raises("permeability must be > 0", function() layers:darcy { permeability = -1, pressure = 0 } end)
-- stars of the octahedron's corners are negative in such a way that the matrix is singular
raises("singular", function() dm.mesh { shells = { 3, 1 } }:darcy { pressure = 1 } end)
raises("orient", function() dm.mesh { named = "rp2" }:darcy { source = 1 } end)

-- ---- harmonic forms: as many as the Betti numbers, also with negative stars
for _, row in ipairs { { { icosphere = 2 }, { 1, 0, 1 } }, { { hex_torus = 6 }, { 1, 2, 1 } },
  { { bcc = 3 }, { 1, 3, 3, 1 } }, { { triangle = 4 }, { 1, 0, 0 } }, { { named = "csaszar7" }, { 1, 2, 1 } },
  { { klein = 6 }, { 1, 1, 0 }, true }, { { simplex_boundary = 5 }, { 1, 0, 0, 0, 1 } } } do
  local M, worst, found = dm.mesh(row[1]), 0, {}
  for k = 0, M.dimension do
    local basis = M:harmonic(k, { pinv = row[3] })
    found[k + 1] = #basis
    for i, h in ipairs(basis) do
      if k < M.dimension then worst = math.max(worst, h:d():max() / h:max()) end
      for j, g in ipairs(basis) do worst = math.max(worst, math.abs(h:dot(g) - (i == j and 1 or 0))) end
    end
  end
  ok(table.concat(found, " ") == table.concat(row[2], " ") and worst < 1e-11, "Betti numbers " .. table.concat(found, " "), worst)
end
for _, row in ipairs { { 3, 24, 2.5626878802 }, { 6, 48, 2.5513730470 } } do
  local ring = dm.mesh { annulus = { row[1], row[2] }, ratio = 1.5 }
  local terms, h = {}, ring:harmonic(1)
  for i = 1, row[2] do terms[i] = { 1, { i, i % row[2] + 1 } } end
  ok(#h == 1 and ring:quality().negative[1] > 0 or row[1] == 6, "one form, some stars negative")
  near(h[1]:norm() ^ 2 * (2 * pi / h[1]:pair(ring:chain(1, terms))) ^ 2, row[3], 1e-9, "circulation 2 pi")
end

-- ---- the decomposition, of forms of every degree and both sides (P31)
for _, row in ipairs { { torus = { 8, 6 }, radii = { 3, 1 } }, { bcc = 3 }, { simplex_boundary = 5 } } do
  local M, worst = dm.mesh(row), 0
  for k = 0, M.dimension do
    for _, a in ipairs { cochain(M, k), cochain(M, M.dimension - k):star() } do
      local p = a:hodge()
      local size = a:norm()
      local function note(x) worst = math.max(worst, math.abs(x) / size) end
      note((p.exact + p.coexact + p.harmonic - a):max())
      note(p.exact:dot(p.coexact) / size)
      note(p.exact:dot(p.harmonic) / size)
      note(p.harmonic:dot(p.coexact) / size)
      if p.potential then note((p.potential:d() - p.exact):max()) end
      if p.copotential then note((p.copotential:delta() - p.coexact):max()) end
      if k < M.dimension then note(p.harmonic:d():max()) end
    end
  end
  ok(worst < 1e-10, "Hodge in all degrees of dimension " .. M.dimension, worst)
end
raises("zero dual", function() cochain(layers, 2):hodge() end)
local ring = dm.mesh { annulus = { 3, 24 }, ratio = 1.5 }
local a = cochain(ring, 1)
local p = a:hodge()
ok((p.potential:d() + p.coexact + p.harmonic - a):max() < 1e-12 and p.harmonic:d():max() < 1e-12
  and p.coexact:delta():norm() < 1e-10, "with negative stars")
-- two components, one of them held by a pressure, or by values: the other has a solution of mean 0
do
  local P = { { 0, 0 }, { 1, 0 }, { 0.5, 0.8 }, { 5, 5 }, { 6, 5 }, { 5.5, 5.8 }, { 6.5, 5.8 } }
  local K = dm.mesh { points = P, simplices = { { 1, 2, 3 }, { 4, 5, 6 }, { 5, 6, 7 } } }
  local u, report = K:poisson { f = 1, fixed = { 1, [2] = 2, [3] = 3 },
    flux = function(x) return x > 3 and 1 or nil end }
  ok(u[1] == 1 and u[2] == 2 and u[3] == 3 and report.mean > 1, "values that are held, a mean that is taken away")
  local v, mean = K:dual_volume(0), 0
  for i = 4, 7 do mean = mean + v[i] * u[i] end
  near(mean, 0, 1e-14, "u has mean 0 where nothing is held")
  local flow = K:darcy { pressure = function(x) return x < 3 and 7 or nil end, source = 0 }
  near(flow.pressure[1], 7, 1e-12, "the pressure that is held")
  near(flow.flux:max(), 0, 1e-13, "and nothing flows")
  near(flow.pressure[2] + flow.pressure[3], 0, 1e-13, "mean 0 where none is held")
end
tap.done()
