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
ok(order(poisson, 8) > 1.9, "Poisson's equation in tetrahedra, order 2", order(poisson, 8))

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
ok(order(gradient, 8) > 1.6, "gradients at vertices in space, towards order 2", order(gradient, 8))
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
ok(order(torus(0), 4) > 1.9, "eigenvalue of functions on the 3-torus, order 2", order(torus(0), 4))
ok(order(torus(1), 3) > 1.85, "eigenvalue of 1-forms on the 3-torus, towards order 2", order(torus(1), 3))
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
