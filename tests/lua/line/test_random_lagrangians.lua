-- every discrete action of a line, over random Lagrangians: its gradient against differences, a symmetric Hessian, a symplectic step, order 2
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local abs, max, sin = math.abs, math.max, math.sin

local random = dm.random(2026)
local draw = 0
local function uniform(lo, hi) draw = draw + 1 return lo + (hi - lo) * random:uniform(draw, 0) end

-- L of n values: a mass that depends on u, a stiffness, a potential, x, t and terms linear in ut (gyroscopic)
local function lagrangian(n, autonomous)
  local a, b, c, d, e, g = uniform(0, 0.3), uniform(0, 0.3), uniform(0.1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-0.5, 0.5)
  local s = autonomous and 0 or 1
  if n == 1 then
    return function(u, ut, ux, x, t)
      return ut ^ 2 / 2 * (1 + a * u ^ 2) - ux ^ 2 / 2 * (1 + b * dm.cos(u)) - c * u ^ 4 + d * dm.sin(x) * u + s * e * dm.cos(t) * u + g * u ^ 2 * ux * ut
    end
  end
  return function(u, ut, ux, x, t)
    local sum = ut:dot(ut) / 2 - ux:dot(ux) / 2 - c * u:dot(u) ^ 2
    for k = 1, n do sum = sum + a * u[k] ^ 2 * ut[k] ^ 2 / 2 - b * dm.cos(u[k]) * ux[k] ^ 2 / 2 + d * dm.sin(x) * u[k] + s * e * dm.cos(t) * u[k] end
    return sum + g * (u[1] * ut[2] - u[2] * ut[1])
  end
end

local function level(count, size)
  local out = {}
  for i = 1, count do out[i] = uniform(-size, size) end
  return dm.vector(out)
end

-- largest difference of two rows, in units of the largest entry
local function off(a, b)
  local most, size = 0, 1e-300
  for k = 1, #a do most, size = max(most, abs(a[k] - b[k])), max(size, abs(a[k])) end
  return most / size
end

-- rows of cell c: entries of the lower and upper level that it has
local function entries(field, c, n)
  local right, out = c == field.nodes and 1 or c + 1, {}
  for _, side in ipairs { "lower", "upper" } do
    for _, node in ipairs { c, right } do
      for k = 1, n do out[#out + 1] = { side, (node - 1) * n + k } end
    end
  end
  return out
end

-- gradient and Hessian of the action of one cell against central differences
local function check(name, strip, field, n, lower, upper, t, h)
  local eps, c = 1e-5, 1 + draw % field.cells
  local slopes, hessian = strip:cells(lower, upper, t, h, "slopes"), strip:cells(lower, upper, t, h, "hessian")
  local by_value, by_slope, size = {}, {}, 4 * n
  for j, entry in ipairs(entries(field, c, n)) do
    local level_ = entry[1] == "lower" and lower or upper
    local kept = level_[entry[2]]
    level_[entry[2]] = kept + eps
    local up, steep = strip:cells(lower, upper, t, h, "value")[c][1], strip:cells(lower, upper, t, h, "slopes")[c]
    level_[entry[2]] = kept - eps
    local down, flat = strip:cells(lower, upper, t, h, "value")[c][1], strip:cells(lower, upper, t, h, "slopes")[c]
    level_[entry[2]] = kept
    by_value[j] = (up - down) / (2 * eps)
    for i = 1, size do by_slope[(i - 1) * size + j] = (steep[i] - flat[i]) / (2 * eps) end
  end
  ok(off(slopes[c], by_value) < 1e-7, name .. ": gradient of the action", off(slopes[c], by_value))
  ok(off(hessian[c], by_slope) < 1e-7, name .. ": Hessian of the action", off(hessian[c], by_slope))
  local turned = {}
  for i = 0, size - 1 do for j = 0, size - 1 do turned[i * size + j + 1] = hessian[c][j * size + i + 1] end end
  ok(off(hessian[c], turned) <= 1e-14, name .. ": symmetric", off(hessian[c], turned))
end

-- D^T J D = J for the derivative of (u, p) -> (u, p) by central differences
local function is_symplectic(name, field, solver, n)
  local N, eps = field.nodes * n, 1e-5
  local u, p = level(N, 0.4), level(N, 0.2)
  local function image(z)
    local a, b = {}, {}
    for i = 1, N do a[i], b[i] = z[i], z[N + i] end
    local run = solver:run { u = a, p = b, steps = 1 }
    local out = {}
    for i = 1, N do out[i], out[N + i] = run.u[2][i], run.p[2][i] end
    return out
  end
  local z, D = {}, {}
  for i = 1, N do z[i], z[N + i] = u[i], p[i] end
  for j = 1, 2 * N do
    local kept = z[j]
    z[j] = kept + eps
    local up = image(z)
    z[j] = kept - eps
    local down = image(z)
    z[j] = kept
    D[j] = {}
    for i = 1, 2 * N do D[j][i] = (up[i] - down[i]) / (2 * eps) end
  end
  local most, size = 0, 0
  for a = 1, 2 * N do
    for b = 1, 2 * N do
      local sum = 0
      for i = 1, N do sum = sum + D[a][i] * D[b][N + i] - D[a][N + i] * D[b][i] end
      local J = b == a + N and 1 or a == b + N and -1 or 0
      most = max(most, abs(sum - J))
      for i = 1, N do size = max(size, abs(D[a][i] * D[b][N + i])) end
    end
  end
  ok(most < 1e-7 * max(1, size), name .. ": a step is symplectic", most)
end

for round, case in ipairs { { 1, "cell(gauss(1))", 5, true }, { 1, "cell(gauss(2))", 4 }, { 1, "cell(corners)", 1 }, { 2, "cell(gauss(2))", 3 }, { 3, "cell(gauss(3))", 2 }, { 2, "cell(corners)", 5, true } } do
  local n, rule, cells, ring = case[1], case[2], case[3], case[4]
  local name = ("%s, %d values, %d cells%s"):format(rule, n, cells, ring and " of a ring" or "")
  local field = dm.field { x = { 0, 1.5, cells, periodic = ring }, values = n, L = lagrangian(n, round % 2 == 0) }
  local solver = field:solver { rule = rule, h = 0.05 }
  local count = field.nodes * n
  check(name, solver.strip, field, n, level(count, 1), level(count, 1), 0.3, 0.2)
  is_symplectic(name, field, solver, n)
  local run = solver:run { u = level(count, 0.5), ut = level(count, 0.5), steps = 12 }
  ok(run:multisymplectic() < 1e-12, name .. ": the form formula", run:multisymplectic())
end

-- order 2 of random nonlinear fields, beside the finest of three sizes
for round = 1, 2 do
  local L = lagrangian(1, round == 1)
  local chart = dm.chart { system = function(cells) return dm.field { x = { 0, 2 * math.pi, cells, periodic = true }, L = L } end, cells = { 16, 32, 256 }, t = 0.75,
    h = function(cells) return 3 / cells end, u = function(x) return 0.4 * sin(x) + 0.2 * math.cos(2 * x) end, rules = { "cell(gauss(2))", "cell(corners)" } }
  for _, rule in ipairs(chart.rules) do
    local order = chart:order(rule)
    ok(order > 1.7 and order < 2.6, ("%s, L number %d: order 2"):format(rule, round), order)
  end
end
tap.done()
