-- every discrete action of a mesh, over random Lagrangians: force against differences of the energy, a symmetric Hessian against differences of the force,
-- a symplectic step, orders of rules
local tap = require "tap"
local dm = require "dm"
local core = require "dm.core"
local ok, near = tap.ok, tap.near
local abs, max = math.abs, math.max

local random = dm.random(19)
local draw = 0
local function uniform(lo, hi) draw = draw + 1 return lo + (hi - lo) * random:uniform(draw, 0) end
local function level(count, size)
  local out = {}
  for i = 1, count do out[i] = uniform(-size, size) end
  return out
end

-- a sum over cells of degree m of a random function of the values of a k-form on their faces
local function random_term(K, m, values)
  local a, b, c = uniform(0.1, 1), uniform(-1, 1), uniform(0.1, 1)
  return function(A)
    return K:sum(m, function(x, cell)
      local sum = 0
      local list = type(x) == "number" and { x } or x
      local ok_, count = pcall(function() return #list end)
      if not ok_ then list, count = { x }, 1 end
      for i = 1, count do
        local y, z = list[i], list[i % count + 1]
        if values > 1 then
          for k = 1, values do sum = sum + a * y[k] ^ 2 + b * y[k] * z[k % values + 1] + c * y[k] ^ 4 end
        else
          sum = sum + a * y ^ 2 + b * y * z + c * (1 - dm.cos(y))
        end
      end
      return cell.volume * sum
    end, A)
  end
end

for _, case in ipairs { { { triangle = 2 }, 0, 2, 1 }, { { triangle = 2 }, 1, 2, 1 }, { { grid = 2 }, 0, 1, 2 }, { { icosphere = 1 }, 0, 2, 3 }, { { cube_tiling = 1 }, 0, 3, 1 }, { { hex_torus = 3 }, 0, 1, 1 } } do
  local K, k, m, values = dm.mesh(case[1]), case[2], case[3], case[4]
  local name = ("%s, %d-forms of %d values in cells of degree %d"):format(next(case[1]), k, values, m)
  local term = random_term(K, m, values)
  local system = K:field { form = k, values = values, massless = "eliminate", L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 - term(u) end }
  local n, eps = system.Q.dimension, 1e-5
  local q, still = level(n, 1), {}
  for i = 1, n do still[i] = 0 end
  local force, hessian = core.field_force(system, dm.vector(q), 0), core.field_hessian(system, dm.vector(q), 0)
  local worst, size, curve, bend, skew = 0, 0, 0, 0, 0
  local probes = {}
  for j = 1, n, max(1, n // 12) do probes[#probes + 1] = j end
  for _, j in ipairs(probes) do
    local kept = q[j]
    q[j] = kept + eps
    local up, F = system:energy(q, still), core.field_force(system, dm.vector(q), 0)
    q[j] = kept - eps
    local down, G = system:energy(q, still), core.field_force(system, dm.vector(q), 0)
    q[j] = kept
    worst, size = max(worst, abs(force[j] + (up - down) / (2 * eps))), max(size, abs(force[j]))
    local unit = {}
    for i = 1, n do unit[i] = i == j and 1 or 0 end
    local column, row = hessian * dm.vector(unit), hessian:transpose() * dm.vector(unit)
    for i = 1, n do
      curve, bend = max(curve, abs(column[i] - (F[i] - G[i]) / (2 * eps))), max(bend, abs(column[i]))
      skew = max(skew, abs(column[i] - row[i]))
    end
  end
  ok(worst < 1e-7 * size, name .. ": force", worst / size)
  ok(curve < 1e-7 * bend, name .. ": Hessian", curve / bend)
  ok(skew <= 1e-14 * bend, name .. ": symmetric", skew / bend)
end

-- symplectic, and of their orders: D^T J D = J by differences, errors beside a step a hundredth as long
local K = dm.mesh { triangle = 2 }
local term = random_term(K, 2, 1)
local system = K:field { L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 - term(u) end }
local n = system.Q.dimension
local function step(solver, z)
  local q, p, out = {}, {}, {}
  for i = 1, n do q[i], p[i] = z[i], z[n + i] end
  local a, b = solver:step { q = q, p = p }
  for i = 1, n do out[i], out[n + i] = a[i], b[i] end
  return out
end
local limit = system:stability_limit "verlet"
for _, rule in ipairs { "verlet", "yoshida(4)", "midpoint", "gauss(2)", "trapezoidal" } do
  local solver, z, D, eps = system:solver { rule = rule, h = 0.3 * limit }, level(2 * n, 0.5), {}, 1e-5
  for j = 1, 2 * n do
    local kept = z[j]
    z[j] = kept + eps
    local up = step(solver, z)
    z[j] = kept - eps
    local down = step(solver, z)
    z[j] = kept
    D[j] = {}
    for i = 1, 2 * n do D[j][i] = (up[i] - down[i]) / (2 * eps) end
  end
  local most, size = 0, 1
  for a = 1, 2 * n do
    for b = 1, 2 * n do
      local sum = 0
      for i = 1, n do sum = sum + D[a][i] * D[b][n + i] - D[a][n + i] * D[b][i] end
      local J = b == a + n and 1 or a == b + n and -1 or 0
      most = max(most, abs(sum - J))
      for i = 1, n do size = max(size, abs(D[a][i] * D[b][n + i])) end
    end
  end
  ok(most < 1e-7 * size, rule .. " is symplectic", most / size)
end
for rule, order in pairs { verlet = 2, ["yoshida(4)"] = 4, midpoint = 2, ["gauss(2)"] = 4 } do
  local start = { q = level(n, 0.3), p = level(n, 0.1), t = 8 * limit / 4 }
  local function finish(parts)
    start.every = parts
    local run = system:solver { rule = rule, h = 2 * limit / parts }:run(start)
    return run.q[#run]
  end
  local best = finish(512)
  local a, b = (finish(8) - best):norm(), (finish(16) - best):norm()
  near(math.log(a / b, 2), order, 0.4, rule .. ": its order")
end
tap.done()
