-- absorbing boundaries in 1 to 4 dimensions, forces beside values without mass, in ensembles with varied params
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sin, cos, exp, abs, max = math.sin, math.cos, math.exp, math.abs, math.max

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function below(x, bound, what) ok(x < bound, ("%s (%.2g)"):format(what, x), x) end
local function apart(a, b)
  local most = 0
  for i = 1, #a do most = a[i] == a[i] and max(most, abs(a[i] - b[i])) or math.huge end
  return most
end

---- a bar of N cubes in n dimensions, each in n! simplices round its diagonal: plane waves along it are those of a line ----

local function orders(n, list, out)
  list, out = list or {}, out or {}
  if #list == n then out[#out + 1] = { table.unpack(list) } end
  for i = 1, #list < n and n or 0 do
    local used = false
    for _, j in ipairs(list) do used = used or i == j end
    if not used then
      list[#list + 1] = i
      orders(n, list, out)
      list[#list] = nil
    end
  end
  return out
end
local function bar(n, N)
  local points, simplices, size = {}, {}, 2 ^ (n - 1) // 1
  local function id(x)
    local k = x[n]
    for i = 1, n - 1 do k = 2 * k + x[i] end
    return k + 1
  end
  for k = 0, (N + 1) * size - 1 do
    local p = {}
    for i = 1, n - 1 do p[i] = (k >> (n - 1 - i) & 1) / N end
    p[n] = k // size / N
    points[k + 1] = p
  end
  for z = 0, N - 1 do
    for _, order in ipairs(orders(n)) do
      local x = {}
      for i = 1, n do x[i] = i == n and z or 0 end
      local s = { id(x) }
      for _, axis in ipairs(order) do
        x[axis] = x[axis] + 1
        s[#s + 1] = id(x)
      end
      simplices[#simplices + 1] = s
    end
  end
  return dm.mesh { points = points, simplices = simplices }
end
local function hump(z) return exp(-60 * (z - 0.45) ^ 2) end
local N = 10
local function absorbed(n, rule)
  local function last(...) return (select(n, ...)) end
  local function ends(...) return abs(last(...) - 0.5) > 0.5 - 1e-9 end
  return bar(n, N):field { L = wave, absorbing = { ends, c = 1.7 } }:solver { rule = rule, h = 0.5 / N }:run {
    q = function(...) return hump(last(...)) end, v = function() return 0.3 end, t = 1.3 }
end
for _, rule in ipairs { "verlet", "midpoint" } do
  local line = absorbed(1, rule)
  below(line:energy()[#line] / line:energy()[1], 0.2, rule .. ": most of the energy has left the line")
  for n = 2, 4 do
    local run, worst = absorbed(n, rule), 0
    local points = run.system.field.mesh:points()
    for i = 1, #points do worst = max(worst, abs(run.q[#run][i] - line.q[#line][math.floor(points[i][n] * N + 0.5) + 1])) end
    below(worst, 1e-13, rule .. (": a bar in %d dimensions is the line"):format(n))
  end
end
-- all faces absorb: the midpoint rule loses h c |*s| v^2 a step, stars of the boundary by hand: parts of squares
local h, run = 0.05, nil
run = bar(3, N):field { L = wave, absorbing = "boundary" }:solver { rule = "midpoint", h = h }:run {
  q = function(_, _, z) return hump(z) end, v = function() return 0.3 end, t = 0.5 }
local points, E, off = run.system.field.mesh:points(), run:energy(), 0
for k = 1, #run - 1 do
  local lost = 0
  for i = 1, #points do
    local inner = points[i][3] > 1e-9 and points[i][3] < 1 - 1e-9
    local area = (inner and 1 or 0.5) * 2 * 0.5 / N ^ 2 + (inner and 0 or 0.25 / N ^ 2)
    lost = lost + h * area * ((run.q[k + 1][i] - run.q[k][i]) / h) ^ 2
  end
  off = max(off, abs(E[k + 1] - E[k] + lost))
end
below(off, 1e-15, "all of a boundary in space: what leaves is the loss of energy")

---- diagonals without mass, friction, a driving form and an absorbing boundary: the equations by hand, by Runge's rule ----

local K = dm.mesh { grid = 3 }
local n, D, c, g, J = K:count(1), K:incidence(1):dense(), 0.8, 0.4, {}
local S, C, diagonals, free = {}, {}, {}, {}
local lengths = K:volume(1)
for i = 1, n do
  J[i], C[i], S[i] = sin(3 * i), 0, {}
  local list = abs(lengths[i] - 1 / 3) < 1e-9 and free or diagonals
  list[#list + 1] = i
  for j = 1, n do
    S[i][j] = 0
    for k = 1, K:count(2) do S[i][j] = S[i][j] + D[k][i] * D[k][j] * 18 end -- 1/area of a triangle
  end
end
local mass = {}
for _, i in ipairs(free) do mass[i] = 1 end -- dual edge as long as the edge, half of it on the boundary
for _, i in ipairs(K:boundary_cells(1)) do C[i], mass[i] = 3, 0.5 end
local function whole(u)
  local all = { table.unpack(u, 1, n) }
  for _, m in ipairs(diagonals) do
    local sum = 0
    for _, j in ipairs(free) do sum = sum + S[m][j] * u[j] end
    all[m] = -sum / S[m][m]
  end
  return all
end
local function rates(x, t) -- of u, v in one list
  local u, out = whole(x), {}
  for i = 1, 2 * n do out[i] = i <= n and x[n + i] or 0 end
  for _, i in ipairs(free) do
    local F = -c * C[i] * x[n + i]
    for j = 1, n do F = F - S[i][j] * u[j] end
    out[n + i] = F / mass[i] + cos(2 * t) * J[i] - g * x[n + i]
  end
  return dm.vector(out)
end
local q, v, both = {}, {}, {}
for i = 1, n do q[i], v[i] = sin(i), cos(2 * i) end
for i = 1, 2 * n do both[i] = i <= n and q[i] or v[i - n] end
local x, dt = dm.vector(both), 0.01
for k = 0, 49 do
  local t = k * dt
  local a = rates(x, t)
  local b = rates(x + dt / 2 * a, t + dt / 2)
  local e = rates(x + dt / 2 * b, t + dt / 2)
  x = x + dt / 6 * (a + 2 * b + 2 * e + rates(x + dt * e, t + dt))
end
local form = K:form(1, J)
local field = K:field { form = 1, massless = "eliminate", absorbing = { "boundary", c = c }, force = function(_, V, t) return cos(2 * t) * form - g * V end, L = wave }
local errors = {}
for k = 1, 2 do
  local path = field:solver { rule = "verlet", h = 0.02 / k }:run { q = q, v = v, t = 0.5 }
  errors[k] = apart(path.q[#path], whole(x))
end
tap.near(errors[1] / errors[2], 4, 0.1, "forces beside values without mass: order 2 towards the equations by hand")
below(errors[2], 1e-3, "and near them")

---- drag that is strong within a step, by rules of several stages: v' = -30 v^3, so 1/v^2 = 1/v0^2 + 60 t ----

local sphere = dm.mesh { icosphere = 1 }
local braked = sphere:field { form = 0, L = function(_, rate) return rate:dot(rate) / 2 end, force = function(_, V) return -30 * V:map(function(x) return x ^ 3 end) end }
for rule, bound in pairs { ["gauss(2)"] = 5e-4, ["gauss(3)"] = 8e-5, ["gauss(4)"] = 1.5e-5 } do
  local path = braked:solver { rule = rule, h = 0.02 }:run { q = function() return 0 end, v = function(x1) return 2 + x1 end, t = 1 }
  local where, rates, worst = sphere:points(), path:form(#path, "p").values, 0
  for i = 1, #rates do
    local v0 = 2 + where[i][1]
    worst = max(worst, abs(rates[i] / braked.field.masses[i] - v0 / math.sqrt(1 + 60 * v0 ^ 2)))
  end
  below(worst, bound, rule .. ": strong drag is solved for")
  ok(#braked:solver { rule = rule, h = 0.2 }:run { q = function() return 0 end, v = function() return 2 end, t = 1 } == 6, "by long steps, too")
end

---- ensembles: forces with params that differ, by rules that factorize, are the runs one by one ----

local ball = dm.mesh { icosphere = 1 }
local speeds, frictions, members = { 1, 50, 0.01, 3 }, { 0, 1, 2, 30 }, {}
local function damped(values, params)
  return ball:field { values = values, params = params, L = function(u, rate, _, P) return rate:dot(rate) / 2 - P.c * u:d():dot(u:d()) / 2 end,
    force = function(_, V, _, P) return -P.g * V end }
end
for values = 1, 2 do
  local random, size = dm.random(1), 42 * values
  for m = 1, 4 do
    members[m] = {}
    for i = 1, size do members[m][i] = random:uniform(m, i) end
  end
  for _, rule in ipairs { "verlet", "midpoint", "gauss(2)", "trapezoidal", "yoshida(4, midpoint)" } do
    local e = damped(values, { c = 1, g = 0 }):solver { rule = rule, h = 0.02 }:ensemble { members = 4, q = members, v = members, steps = 20, threads = 2,
      vary = { c = speeds, g = frictions } }
    local worst = 0
    for m = 1, 4 do
      local alone = damped(values, { c = speeds[m], g = frictions[m] }):solver { rule = rule, h = 0.02 }:run { q = members[m], v = members[m], steps = 20 }
      worst = max(worst, apart(e.q[m], alone.q[#alone]))
    end
    below(worst, 1e-12, ("%d value(s), %s: members of an ensemble are runs"):format(values, rule))
  end
end
tap.done()
