-- values without mass in three dimensions: cubes cut into tetrahedra keep Yee's scheme on their edges; masses that are 0 by data
local dm, tap = require "dm", require "tap"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, pi, abs, max, floor = math.sin, math.pi, math.abs, math.max, math.floor
local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end

-- Yee's scheme by hand: a number on every edge of N^3 cubes of width 1/N, free boundaries or walls where it is held; edges by the corner
-- they begin at and their direction
local function yee_by_hand(N, held, start, h, steps)
  local dx, n = 1 / N, N + 1
  local function vertex(i) return i[1] + n * (i[2] + n * i[3]) end
  local function moved(i, a) local j = { i[1], i[2], i[3] } j[a] = j[a] + 1 return j end
  local edges, faces = {}, {}                                -- edges[3 vertex + a] = { value, mass, force, rate }
  local function at_wall(i, a) return i[a] == 0 or i[a] == N end
  local function each(f) for z = 0, N do for y = 0, N do for x = 0, N do f { x, y, z } end end end end
  each(function(i)
    for a = 1, 3 do
      local b, c = a % 3 + 1, (a + 1) % 3 + 1
      local walls = (at_wall(i, b) and 1 or 0) + (at_wall(i, c) and 1 or 0)
      if i[a] < N then edges[3 * vertex(i) + a] = { q = start(i, a), m = dx * 0.5 ^ walls, f = 0, v = 0, held = held and walls > 0 } end
      if i[b] < N and i[c] < N then
        faces[#faces + 1] = { w = 0.5 ^ (at_wall(i, a) and 1 or 0) / dx, 3 * vertex(i) + b, 3 * vertex(moved(i, b)) + c,
          3 * vertex(moved(i, c)) + b, 3 * vertex(i) + c }
      end
    end
  end)
  local function kick(s)
    for _, e in pairs(edges) do e.f = 0 end
    for _, f in ipairs(faces) do
      local p, q, r, o = edges[f[1]], edges[f[2]], edges[f[3]], edges[f[4]]
      local B = f.w * (p.q + q.q - r.q - o.q)
      p.f, q.f, r.f, o.f = p.f - B, q.f - B, r.f + B, o.f + B
    end
    for _, e in pairs(edges) do if not e.held then e.v = e.v + s * e.f / e.m end end
  end
  for _ = 1, steps do
    kick(h / 2)
    for _, e in pairs(edges) do e.q = e.q + h * e.v end
    kick(h / 2)
  end
  return function(i, a) return edges[3 * vertex(i) + a].q end
end

-- the corner and the direction of an edge of the mesh; nothing of a diagonal
local function place_of(points, edge, N)
  local i, a, more = {}, nil, 0
  for c = 1, 3 do
    local p, q = points[edge[1]][c] * N, points[edge[2]][c] * N
    i[c] = floor(math.min(p, q) + 0.5)
    if abs(p - q) > 0.5 then a, more = c, more + 1 end
  end
  if more == 1 then return i, a, points[edge[2]][a] > points[edge[1]][a] and 1 or -1 end
end

local N = 3
local K = dm.mesh { cube_tiling = N }
local points, edges = K:points(), K:simplices(1)
local function start(i, a) return sin(1 + 7.3 * i[1] + 2.9 * i[2] + 5.1 * i[3] + 1.7 * a) end
for _, wall in ipairs { "boundary", false } do
  local field = K:field { form = 1, fixed = wall or nil, massless = "eliminate", L = wave }
  local h, q = 0.98 * field:stability_limit "verlet", dm.zeros(K:count(1))
  for j, edge in ipairs(edges) do
    local i, a, sign = place_of(points, edge, N)
    local on_wall = false
    for c = 1, 3 do on_wall = on_wall or i and c ~= a and (i[c] == 0 or i[c] == N) end
    q[j] = i and not (wall and on_wall) and sign * start(i, a) or 0
  end
  local function first(i, a)
    for c = 1, 3 do if wall and c ~= a and (i[c] == 0 or i[c] == N) then return 0 end end
    return start(i, a)
  end
  for threads = 1, 2 do
    local run = field:solver { rule = "verlet", h = h, threads = threads }:run { q = q, v = 0 * q, steps = 60, every = 60 }
    local theirs, worst = yee_by_hand(N, wall, first, h, 60), 0
    for j, edge in ipairs(edges) do
      local i, a, sign = place_of(points, edge, N)
      if i then worst = max(worst, abs(run.q[2][j] - sign * theirs(i, a))) end
    end
    ok(worst < 1e-11, "Yee's scheme on cubes, " .. (wall or "free ends") .. ", threads " .. threads, worst)
  end
end

-- modes and limit; boxes of other sides
local function square(a, l) return 4 * (N / l) ^ 2 * sin(pi * a / (2 * N)) ^ 2 end
local field = K:field { form = 1, fixed = "boundary", massless = "eliminate", L = wave }
local found, expected = field:modes(5, { above = 1 }).values, { 18, 18, 18, 27, 27 }
for i = 1, 5 do near(found[i], expected[i], 1e-10, "eigenvalue " .. i .. " of Yee's scheme in space") end
near(field:stability_limit "verlet", 2 / math.sqrt(3 * square(2, 1)), 1e-10, "its limit")
local bricks = dm.mesh { cube_tiling = N, map = function(x, y, z) return { x, 2.1 * y, 0.7 * z } end }
found = bricks:field { form = 1, fixed = "boundary", massless = "eliminate", L = wave }:modes(1, { above = 1 }).values
near(found[1], square(1, 1) + square(1, 2.1), 1e-10, "and that of bricks")

-- masses that are 0 by data: those values follow from their own equation, whatever the rest does; two values a cell are twice one
local plate = dm.mesh { triangle = 4 }
local rho = plate:form(0, function(x, y) return 0 end)
for i = 1, #rho.values do rho.values[i] = i % 5 == 0 and 0 or 1 end
local function heavy(u, v)
  return plate:sum(0, function(a, cell) return cell.rho * cell.star * a ^ 2 / 2 end, v) - u:d():dot(u:d()) / 2
end
local one = plate:field { data = { rho = rho }, massless = "eliminate", L = heavy }
local run = one:solver { rule = "verlet", h = 0.02 }:run { q = function(x) return x * x end, v = function() return 0 end, steps = 50 }
local worst = 0
local weights, simplices = plate:star_weights(1), plate:simplices(1)
for i = 5, #rho.values, 5 do
  local sum = 0
  for j, edge in ipairs(simplices) do
    local other = edge[1] == i and edge[2] or edge[2] == i and edge[1]
    if other then sum = sum + weights[j] * (run.q[51][other] - run.q[51][i]) end
  end
  worst = max(worst, abs(sum))
end
ok(worst < 1e-14, "a vertex without mass is the mean of those around it", worst)
local function both(u, v)
  return plate:sum(0, function(a, cell) return cell.rho * cell.star * a:dot(a) / 2 end, v) - u:d():dot(u:d()) / 2
end
local two = plate:field { values = 2, data = { rho = rho }, massless = "eliminate", L = both }
local pair = two:solver { rule = "verlet", h = 0.02 }:run { q = function(x, y) return { x * x, y } end, v = function() return { 0, 0 } end, steps = 50 }
worst = 0
for i = 1, #rho.values do worst = max(worst, abs(pair.q[51][2 * i - 1] - run.q[51][i])) end
ok(worst < 1e-13, "two values a vertex are twice one", worst)

raises("meet in L", function()
  K:field { form = 1, massless = "eliminate", L = function(u, v) return wave(u, v) - K:sum(3, function(a) local s = 0 for i = 1, 6 do s = s + a[i] end return s ^ 2 end, u) end }
end)
raises("linear in its value", function()
  K:field { form = 1, massless = "eliminate", L = function(u, v) return v:dot(v) / 2 - K:sum(3, function(a) local s = 0 for i = 1, 6 do s = s + a[i] end return s end, u) end }
end)
raises("no equation of its own", function()
  plate:field { values = 3, on = dm.S(2), data = { rho = rho }, massless = "eliminate", L = both }
end)
raises("a force acts on the cell {5}, which has no kinetic energy", function()
  plate:field { data = { rho = rho }, massless = "eliminate", L = heavy, force = function(_, v) return -1 * v end }
end)
raises("a force acts on the cell", function() plate:field { data = { rho = rho }, massless = "eliminate", L = heavy, absorbing = "boundary" } end)
-- a step beyond the limit ends in numbers that are none, not in a root that is not found
raises("a value became NaN or infinite", function()
  field:solver { rule = "verlet", h = 2 }:run { q = function(x, y, z) return { y, z, x * x } end, v = function() return { 0, 0, 0 } end, steps = 3000 }
end)
-- what is settled stays: bits of a run do not depend on where it is cut; rules that do not eliminate are refused
local function q(x, y, z) return { sin(3 * y), x * z, sin(pi * x) } end
local function still() return { 0, 0, 0 } end
local solver = field:solver { rule = "verlet", h = 0.05 }
local whole = solver:run { q = q, v = still, steps = 40 }
local half = solver:run { q = q, v = still, steps = 15, every = 4 }
ok(dm.resume(half, field):run { steps = 25 }.q[26] == whole.q[41], "a run that goes on has the bits of one that never stopped")
ok(solver:ensemble { members = 2, steps = 40, q = function() return q end, v = function() return still end }.q[2] == whole.q[41], "so has a member")
raises("for kicks, drifts and explicit Runge-Kutta", function() field:solver { rule = "midpoint", h = 0.05 }:run { q = q, v = still, steps = 1 } end)
-- explicit Runge-Kutta rules eliminate at every stage: a mode turns as cos(w t), with their order; L may depend on t where a run is cut
local found1 = one:modes(4, { above = 1 })
local w, mode = math.sqrt(found1.values[3]), found1.forms[3]
ok(abs(mode.values[5]) > 0.1, "a mode has values without mass as their equation has them", mode.values[5])
for _, case in ipairs { { "rk4", 4 }, { "rk8", 8 }, { "rkf45", 4 }, { "rk8pd", 8 } } do
  local off = {}
  for k, h in ipairs { 0.05, 0.025 } do
    local r = one:solver { rule = case[1], h = h }:run { q = mode, v = function() return 0 end, t = 1 }
    off[k] = 0
    for i = 1, #rho.values do off[k] = max(off[k], abs(r.q[#r][i] - math.cos(w) * mode.values[i])) end
  end
  ok(off[2] < 1e-4 and (off[2] < 1e-10 or math.log(off[1] / off[2], 2) > case[2] - 0.3), case[1] .. " with values without mass: its order", off[1], off[2])
end
local shaken = plate:field { data = { rho = rho }, massless = "eliminate", L = function(u, v, t)
  return plate:sum(0, function(a, cell) return cell.rho * cell.star * a ^ 2 / 2 end, v) - (1 + 0.3 * dm.sin(t)) * u:d():dot(u:d()) / 2
    - plate:sum(0, function(a, cell) return cell.star * a ^ 4 end, u) end }
for _, rule in ipairs { "rk4", "rk8", "verlet" } do
  local from = { q = function(x, y) return sin(3 * x) + y end, v = function() return 0 end, steps = 15 }
  local part = shaken:solver { rule = rule, h = 0.02 }:run(from)
  from.steps = 40
  local all = shaken:solver { rule = rule, h = 0.02 }:run(from)
  local rest = dm.resume(part):run { steps = 25 }
  ok(rest.q[1] == all.q[16] and rest.q[26] == all.q[41], rule .. ": L of t, values without mass, goes on as it was, from its first row")
end
raises("curve segments need derivatives of the acceleration", function()
  plate:field { L = wave }:solver { rule = dm.curve "rk4", h = 0.01 }:run { q = function(x) return x end, v = function() return 0 end, steps = 1 }
end)
local map = dm.stability { field, rule = "verlet", h = { 0.02, 0.2 }, t = 0.5, q = q, v = still }
local right = map:limit(1, "right")
ok(right and right > 0.02 and right < 0.2, "a map of more values than a run watches has a resolved flow, without mass too", right)
raises("there is no 'q280'", function() dm.stability { field, rule = "verlet", h = 0.02, t = 0.5, q = q, v = still, observe = "q280" } end)
map = dm.stability { field, rule = "verlet", h = { 0.02, 0.2 }, t = 0.5, q = q, v = still, observe = "q200" }
ok(map:at(1, 2).observable == "q200" or map:at(1, 2).class == "bounded", "one of the last values, by name")
-- values without mass whose equation has no root, e^x, or a threefold one, (x - 0.3)^4 + ...: told, or found as well as rounding lets
do
  local squares = dm.mesh { grid = 2 }
  local weights = squares:star_weights(1)
  local function with(g)
    return squares:field { form = 1, massless = "eliminate", L = function(a, v)
      return v:dot(v) / 2 - a:dot(a) / 2 - squares:sum(1, function(x) return g(x - 0.3) end, a) end }
  end
  local begin = squares:form(1, function() return { 0.4, 0.2 } end)
  for _, rule in ipairs { "verlet", "yoshida(4)" } do
    local lost = with(function(x) return dm.exp(x) end):solver { rule = rule, h = 0.01 }
    raises("no root of the equation dL/dA = 0", function() lost:run { q = begin, v = 0 * begin, steps = 3 } end)
    local run = with(function(x) return x ^ 4 end):solver { rule = rule, h = 0.01 }:run { q = begin, v = 0 * begin, steps = 3 }
    for i = 1, #weights do if weights[i] == 0 then near(run.q[4][i], 0.3, 1e-7, "a threefold root, " .. rule) end end
  end
end
tap.done()
