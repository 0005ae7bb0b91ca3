-- implicit rules on fields by sparse Newton: against the same system written out, orders, energy, above 400 coordinates
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos = math.sin, math.cos

-- a chain of N values: stars of edges and vertices are 1 / dx and dx
local N, dx = 9, 0.125
local points, simplices = {}, {}
for i = 1, N do points[i] = { (i - 1) * dx } simplices[i] = i < N and { i, i + 1 } or nil end
local line = dm.mesh { points = points, simplices = simplices }
local field = line:field { L = function(u, v, t)
  return v:dot(v) / 2 - u:d():dot(u:d()) / 2 - line:sum(0, function(a, cell) return cell.star * (1 - cos(a + t)) end, u) end }
local plain = dm.system { Q = dm.R(N), L = function(q, v, t)
  local sum = 0
  for i = 1, N do
    local star = (i == 1 or i == N) and dx / 2 or dx
    sum = sum + star * (v[i] ^ 2 / 2 - 1 + cos(q[i] + t))
    if i < N then sum = sum - (q[i + 1] - q[i]) ^ 2 / (2 * dx) end
  end
  return sum
end }
local q, v = {}, {}
for i = 1, N do q[i], v[i] = sin(3 * i), cos(i) / 2 end
for _, rule in ipairs { "verlet", "midpoint", "trapezoidal", "gauss(2)", "gauss(4)", "lobatto(3)", "yoshida(4, midpoint)", "suzuki(4)" } do
  local function last(system)
    local path = system:solver { rule = rule, h = 0.05 }:run { q = q, v = v, t0 = 0.3, steps = 20 }
    return path.q[21], path.p[21]
  end
  local a, b = last(field)
  local c, d = last(plain)
  ok((a - c):norm() < 2e-13 and (b - d):norm() < 2e-13, rule .. ": as the system written out", (a - c):norm() + (b - d):norm())
end

-- more than 400 coordinates, beyond the explicit limit: energy of a linear field is kept by midpoint
local K = dm.mesh { icosphere = 3 }
local function wave(u, w) return w:dot(w) / 2 - u:d():dot(u:d()) / 2 end
local linear = K:field { L = wave }
ok(linear:stability_limit "midpoint" == math.huge, "no step is too large for midpoint")
local solver = linear:solver { rule = "midpoint", h = 5 * linear:stability_limit "verlet" }
local path = solver:run { q = function(x, y, z) return z + x * y end, v = function(x) return x end, steps = 50 }
ok(path:drift "energy".largest < 1e-12 * path:energy()[1], "midpoint keeps a quadratic energy", path:drift "energy".largest)
near(solver:report().newton_per_step, 2, 1.01, "a linear field takes one solve and one look")
local maxwell = K:field { form = 1, L = wave }
path = maxwell:solver { rule = "gauss(2)", h = 0.3 }:run { q = function(x, y, z) return { z, x, y } end, v = function() return { 0, 0, 0 } end, steps = 10 }
ok(path:drift "energy".largest < 1e-12 * path:energy()[1] and path:drift "gauss".largest < 1e-11, "gauss(2) keeps energy and Gauss's law")

-- fixed cells stay; the order of a nonlinear field with fixed boundary
local plate = dm.mesh { triangle = 5 }
local fixed = plate:field { fixed = "boundary", L = function(u, w)
  return wave(u, w) - plate:sum(0, function(a, cell) return cell.star * (1 - cos(3 * a)) end, u) end }
local function last(rule, steps)
  local p = fixed:solver { rule = rule, h = 0.2 / steps }:run { q = function(x, y) return sin(3 * x) * y end, v = function(x, y) return cos(x + y) end, steps = steps }
  return p.q[#p], p.q[1]
end
for rule, order in pairs { midpoint = 2, ["gauss(2)"] = 4 } do
  local a, b, c = last(rule, 8), last(rule, 16), last(rule, 32)
  near(math.log((a - b):norm() / (b - c):norm()) / math.log(2), order, 0.1, rule .. " has its order")
end
local a, b = last("midpoint", 4)
ok(a[1] == b[1] and a[2] == b[2], "fixed values stay")

raises("not for fields", function() linear:solver { rule = "gauss(2, 3)", h = 0.1 }:run { q = b, v = b, steps = 1 } end)
tap.done()
