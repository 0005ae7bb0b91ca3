-- orders of convergence in space, tetrahedra
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local function bent(x, y, z)
  local b = 0.04 * math.sin(math.pi * x) * math.sin(math.pi * y) * math.sin(math.pi * z)
  return { x + b, y - b, z + b / 2 }
end
local function wave(x, y, z) return math.exp(x) * math.sin(y) * math.cos(2 * z) end -- -div grad = 4 wave
local function slope(x, y, z)
  return { wave(x, y, z), math.exp(x) * math.cos(y) * math.cos(2 * z), -2 * math.exp(x) * math.sin(y) * math.sin(2 * z) }
end

-- log2 of errors at N and 2 N
local function order(error_of, N) return math.log(error_of(N) / error_of(2 * N), 2) end

local function cube(N) return dm.mesh { cube_tiling = N, map = bent } end

local function poisson(N)
  local K = cube(N)
  local u = K:poisson { f = function(...) return 4 * wave(...) end, fixed = { boundary = wave } }
  local e, volume, sum = u - K:form(0, wave), K:dual_volume(0), 0
  for i = 1, #e do sum = sum + volume[i] * e[i] ^ 2 end
  return sum ^ 0.5
end
local of_poisson = order(poisson, 8)
ok(of_poisson > 1.9, "Poisson's equation in tetrahedra, order 2", of_poisson)

-- Darcy flow of the pressure `wave` in a bent cube, tetrahedra of a body-centred lattice, well-centred but for half octahedra at the
-- boundary, whose centres lie in it: mean squares of the errors of the pressure, and of the flux density of facets inside
local function lattice_box(N)
  local P = {}
  for c = 0, 1 do
    for i = 0, N - c do
      for j = 0, N - c do
        for k = 0, N - c do P[#P + 1] = { (i + c / 2) / N, (j + c / 2) / N, (k + c / 2) / N } end
      end
    end
  end
  local cells = dm.mesh { points = P }:simplices(3)
  for i, x in ipairs(P) do P[i] = bent(table.unpack(x)) end
  return dm.mesh { points = P, simplices = cells }
end
local function mean_square(x, weights)
  local sum, size = 0, 0
  for i = 1, #x do sum, size = sum + weights[i] * x[i] ^ 2, size + weights[i] end
  return (sum / size) ^ 0.5
end
local function darcy(N)
  local K = lattice_box(N)
  local flow = K:darcy { pressure = wave, source = function(...) return 4 * wave(...) end }
  local centres, pressure, flux, inner = K:circumcentres(3), {}, {}, {}
  for i = 1, #centres do pressure[i] = flow.pressure[i] - wave(table.unpack(centres[i]:totable())) end
  local off = flow.flux - K:form(2, function(...)
    local s = slope(...)
    return { -s[3], s[2], -s[1] } -- of v = -grad p: v3 dx dy - v2 dx dz + v1 dy dz
  end, { order = 4 })
  local points = K:points():totable()
  for i, triangle in ipairs(K:simplices(2)) do
    inner[i] = 1
    for _, v in ipairs(triangle) do
      for c = 1, 3 do if math.abs(points[v][c] - 0.5) > 0.3 then inner[i] = 0 end end
    end
  end
  for i = 1, #off do flux[i] = off[i] / K:volume(2)[i] end
  return mean_square(pressure, K:volume(3)), mean_square(flux, inner), flow.report
end
local p1, v1, report = darcy(5)
local p2, v2 = darcy(10)
ok(math.log(p1 / p2, 2) > 1.9, "pressures of a Darcy flow in space, order 2", math.log(p1 / p2, 2))
ok(math.log(v1 / v2, 2) > 0.95, "fluxes inside, order 1", math.log(v1 / v2, 2))
ok(report.negative_stars == 300 and report.note:find "300 facets have a negative dual", "negative duals at the boundary are told",
  report.note)

-- the largest error of a field of vectors at points, those of `left_out` apart
local function worst(X, points, exact, left_out)
  local largest, out = 0, {}
  for _, i in ipairs(left_out) do out[i] = true end
  for i = 1, #X do
    local want = exact(table.unpack(points[i]:totable()))
    for c = 1, out[i] and 0 or 3 do largest = math.max(largest, math.abs(X[i][c] - want[c])) end
  end
  return largest
end
local function gradient(N)
  local K = cube(N)
  return worst(K:form(0, wave):grad(), K:points(), slope, K:boundary_cells(0))
end
local of_gradients = order(gradient, 8)
ok(of_gradients > 1.6, "gradients at vertices in space, towards order 2", of_gradients)
local function twisted(x, y, z) return { math.sin(y * z), x * x, math.cos(x + z) } end
local function whitney(N)
  local K = cube(N)
  return worst(K:form(1, twisted):sharp { to = "cells" }, K:circumcentres(3), twisted, {})
end
local first = order(whitney, 4)
ok(first > 0.9 and first < 1.2, "interpolation of 1-forms in space, order 1", first)

-- the flat 3-torus: first eigenvalue (2 pi)^2 of functions and of 1-forms, constant harmonic forms
local function torus(k)
  return function(N)
    return math.abs(dm.mesh { bcc = N }:laplacian(k):eigen(1, { above = 1 }).values[1] - 4 * math.pi ^ 2)
  end
end
local of_functions, of_forms = order(torus(0), 4), order(torus(1), 3)
ok(of_functions > 1.9, "eigenvalue of functions on the 3-torus, order 2", of_functions)
ok(of_forms > 1.85, "eigenvalue of 1-forms on the 3-torus, towards order 2", of_forms)
local T = dm.mesh { bcc = 3 }
for k = 1, 2 do
  local basis, largest = T:harmonic(k), 0
  ok(#basis == 3, "harmonic forms of the 3-torus")
  for _, h in ipairs(basis) do
    largest = math.max(largest, h:d():max(), h:delta():max())
  end
  ok(largest < 1e-9, "closed and coclosed", largest)
end
tap.done()
