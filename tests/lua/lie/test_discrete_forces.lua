-- discrete Lagrangians on groups with forces, constraints and rolling: order, momentum balance, multipliers, against
-- equations of motion written out here and solved by a Runge-Kutta method in plain Lua
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local V, max, abs, log = dm.vector, math.max, math.abs, math.log

local function rk4(f, x, t, n)
  local h = t / n
  for _ = 1, n do
    local a = f(x)
    local b = f(x + h / 2 * a)
    local c = f(x + h / 2 * b)
    x = x + h / 6 * (a + 2 * b + 2 * c + f(x + h * c))
  end
  return x
end
local function cross(a, b) return V { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1] } end
-- x = (w, rows of R): R' = R hat(w)
local function row(x, i) return V { x[1 + 3 * i], x[2 + 3 * i], x[3 + 3 * i] } end
local function with_rows(rate, x, w)
  local out = { rate[1], rate[2], rate[3] }
  for i = 1, 3 do
    local r = cross(row(x, i), w)
    for j = 1, 3 do out[3 * i + j] = r[j] end
  end
  return V(out)
end
local function start_of(w, g)
  local x = { w[1], w[2], w[3] }
  for i = 1, 3 do
    for j = 1, 3 do x[3 * i + j] = g[i][j] end
  end
  return V(x)
end
local function off(g, x)
  local sum = 0
  for i = 1, 3 do
    for j = 1, 3 do sum = sum + (g[i][j] - x[3 * i + j]) ^ 2 end
  end
  return math.sqrt(sum)
end
-- the order that two errors with twice as many steps tell
local function order(error_of, n, what)
  near(log(error_of(n) / error_of(2 * n), 2), 2, 0.05, what .. ": order 2")
end

local G = dm.SO(3)
local I = dm.matrix { { 1.0, 0.1, 0.3 }, { 0.1, 1.3, -0.2 }, { 0.3, -0.2, 0.7 } }
local c = V { 0.5, 0, 0.3 }
local function height(g) return g[3][1] * c[1] + g[3][2] * c[2] + g[3][3] * c[3] end
local function step_of(g0, g1) return G:log(g0:transpose() * g1) end
local function body(g0, g1, h)
  local xi = step_of(g0, g1) / h
  return h * (xi:dot(I * xi) / 2 - (height(g0) + height(g1)) / 2)
end
local q, w = G:exp { 0.4, 0.1, 0.2 }, V { 0.5, -0.3, 0.9 }
local function torque(x) return cross(I * row(x, 0), row(x, 0)) + cross(row(x, 3), c) end -- row 0: w

---- forces ----

local function drag(g, xi) return V { -0.3 * xi[1], -0.1 * xi[2] + 0.2 * g[3][1], -0.2 * xi[3] } end
local function dragged(g0, g1, h)
  local xi = step_of(g0, g1) / h
  return { h / 2 * drag(g0, xi), h / 2 * drag(g1, xi) }
end
local exact = rk4(function(x)
  local xi = row(x, 0)
  local f = V { -0.3 * xi[1], -0.1 * xi[2] + 0.2 * x[10], -0.2 * xi[3] }
  return with_rows(I:solve(torque(x) + f), x, xi)
end, start_of(w, q), 2, 500)
local function forced(h, more)
  local given = { Q = G, h = h, Ld = body, force = dragged }
  for key, value in pairs(more or {}) do given[key] = value end
  return dm.discrete_lagrangian(given)
end
order(function(n)
  local path = forced(2 / n):solver():run { q = q, p = I * w, steps = n }
  return off(path.q[n + 1], exact) + (path.p[n + 1] - I * row(exact, 0)):norm()
end, 20, "a body with drag")
local Ld = forced(0.05)
local solver = Ld:solver()
local path = solver:run { q = q, p = I * w, steps = 100 }
local worst = 0
for k = 2, 100 do
  worst = max(worst, (Ld:legendre_plus(path.q[k - 1], path.q[k]) - Ld:legendre_minus(path.q[k], path.q[k + 1])):norm())
end
ok(worst < 1e-13, "D2 Ld + F2 + D1 Ld + F1 = 0 at every node", worst)
-- signs and places of F1, F2, by differences of the value
for a = 1, 3 do
  local e = V { a == 1 and 1e-5 or 0, a == 2 and 1e-5 or 0, a == 3 and 1e-5 or 0 }
  local g0, g1 = path.q[7], path.q[8]
  local F = dragged(g0, g1, 0.05)
  local by0 = (Ld(g0 * G:exp(e), g1) - Ld(g0 * G:exp(-e), g1)) / 2e-5
  local by1 = (Ld(g0, g1 * G:exp(e)) - Ld(g0, g1 * G:exp(-e))) / 2e-5
  near(Ld:legendre_minus(g0, g1)[a], -by0 - F[1][a], 1e-9, "p0 = -D1 Ld - F1")
  near(Ld:legendre_plus(g0, g1)[a], by1 + F[2][a], 1e-9, "p1 = D2 Ld + F2")
end

-- Noether with forces: without gravity spatial momentum changes by what the forces do along the group
local free = forced(0.05, { Ld = function(g0, g1, h)
  local xi = step_of(g0, g1) / h
  return h * xi:dot(I * xi) / 2
end })
local balance = free:solver():run { q = q, p = I * w, steps = 100 }
local J = balance:momentum(G)
worst = 0
for k = 1, 100 do
  local F = dragged(balance.q[k], balance.q[k + 1], 0.05)
  worst = max(worst, (J[k + 1] - J[k] - balance.q[k] * F[1] - balance.q[k + 1] * F[2]):norm())
end
ok(worst < 1e-14, "the balance of spatial momentum", worst)
-- a force along the third axis of the body moves nothing about the vertical where that axis lies
local spun = forced(0.05, { force = function(g0, g1)
  return { 0.1 * V { g0[2][1], g0[2][2], g0[2][3] }, 0.2 * V { g1[1][1], g1[1][2], g1[1][3] } }
end }):solver():run { q = q, p = I * w, steps = 200 }
ok(spun:drift(spun:momentum(dm.SO(2))).largest < 1e-12, "a horizontal torque leaves the vertical momentum",
  spun:drift(spun:momentum(dm.SO(2))).largest)

---- members and restarts ----

local cloud = solver:ensemble { members = 3, q = function(i) return G:exp { 0.1 * i, 0, 0 } end, p = function() return I * w end, steps = 20 }
ok(cloud.p[3] == solver:run { q = G:exp { 0.1 * 3, 0, 0 }, p = I * w, steps = 20 }.p[21], "members have the bits of runs")
local file = os.tmpname()
solver:run { q = q, p = I * w, steps = 40 }:checkpoint(file)
ok(dm.resume(file, Ld):run { steps = 60 }.p[61] == path.p[101], "a run goes on bit for bit")
ok(dm.resume(file, forced(0.05)):run { steps = 60 }.p[61] == path.p[101], "with an Ld that was made again, too")
local short = solver:run { q = q, p = I * w, steps = 40 }
ok(dm.resume(short, Ld):run { steps = 60 }.p[61] == path.p[101], "from a path and its Ld, too")
for _, from in ipairs { short, file } do
  raises("of rule 'del (own)', not 'midpoint'", dm.resume, from, Ld, { rule = "midpoint" })
end
raises("dm.resume", dm.resume, short, Ld, "midpoint")
raises("not the one of the checkpoint", function()
  return dm.resume(file, forced(0.05, { force = function() return { { 0, 0, 0 }, { 0, 0, 0 } } end })):run { steps = 2 }
end)

---- holonomic constraints: the axis at one angle, against lie(2), whose impulses are others ----

local function leaning(g) return { g[3][3] - 0.6 } end
local lean = G:exp { math.acos(0.6), 0, 0 }
local system = dm.system { Q = G, L = function(g, xi) return xi:dot(I * xi) / 2 - height(g) end,
  constraint = leaning, force = drag }
local spin = { 0, 0.32, 0.9 } -- the axis stays at its angle: w1 = 0 there
local same = system:solver { rule = "lie(3)", h = 0.05 }:run { q = lean, v = spin, steps = 40 }
order(function(n)
  local held = forced(2 / n, { constraint = leaning }):solver():run { q = lean, p = same.p[1], steps = n }
  return G:distance(held.q[n + 1], same.q[41])
end, 20, "a body that leans")
local held = forced(0.05, { constraint = leaning })
local steady = held:solver()
local tied = steady:run { q = lean, p = same.p[1], steps = 400, record = { "impulses" } }
ok(tied:worst "constraint" < 4e-16, "the constraint after 400 steps", tied:worst "constraint")
-- momenta of neighbours differ by the impulse along the gradient, (-g32, g31, 0) of the body
worst = 0
for k = 2, 400 do
  local r = held:legendre_minus(tied.q[k], tied.q[k + 1]) - held:legendre_plus(tied.q[k - 1], tied.q[k])
  local g = tied.q[k]
  worst = max(worst, (r - tied.impulses[k][1] * V { -g[3][2], g[3][1], 0 }):norm())
end
ok(worst < 1e-13, "impulses are the multipliers of their gradient", worst)
steady:run { q = lean, p = same.p[1], steps = 150 }:checkpoint(file)
ok(dm.resume(file, held):run { steps = 250 }.p[251] == tied.p[401], "a run with constraints goes on bit for bit")
local many = steady:ensemble { members = 4, q = function() return lean end,
  p = function(i) return same.p[1] * i end, steps = 30 }
ok(many.p[4] == steady:run { q = lean, p = same.p[1] * 4, steps = 30 }.p[31], "and so do members")

-- what a constraint takes from outside may change: its rows are then others, too
local part = 1
local function mixed() return forced(0.05, { constraint = function(g) return part * (g[3][3] - lean[3][3]) + (1 - part) * (g[3][1] - lean[3][1]) end }) end
local tilted = mixed()
local again = { q = lean, p = same.p[1], steps = 20 }
local before = tilted:solver():run(again)
part = 0.5
local after = tilted:solver():run(again)
ok(after.p[21] == mixed():solver():run(again).p[21] and after.p[21] ~= before.p[21], "rows follow what a constraint takes from outside")

---- rolling: Suslov's body, w3 = 0, with gravity ----

local function no_spin(g0, g1, h) return step_of(g0, g1)[3] / h end
local across = I[1][1] * I[2][2] - I[1][2] ^ 2
exact = rk4(function(x)
  local t = torque(x)
  return with_rows({ (t[1] * I[2][2] - t[2] * I[1][2]) / across, (I[1][1] * t[2] - I[1][2] * t[1]) / across, 0 }, x, row(x, 0))
end, start_of({ 0.5, -0.3, 0 }, q), 2, 500)
local function suslov(h)
  return dm.discrete_lagrangian { Q = G, h = h, Ld = body, rolling = no_spin, reaction = function() return { 0, 0, 1 } end }
end
order(function(n)
  return off(suslov(2 / n):solver():run { q = q, p = I * V { 0.5, -0.3, 0 }, steps = n }.q[n + 1], exact)
end, 20, "Suslov's body")
local rolls = suslov(0.05)
path = rolls:solver():run { q = q, p = I * V { 0.5, -0.3, 0 }, steps = 300, record = { "impulses" } }
ok(path:worst "rolling" < 1e-14, "no spin after 300 steps", path:worst "rolling")
worst = 0
for k = 2, 300 do
  local r = rolls:legendre_minus(path.q[k], path.q[k + 1]) - rolls:legendre_plus(path.q[k - 1], path.q[k])
  worst = max(worst, (r - V { 0, 0, path.impulses[k][1] }):norm())
end
ok(worst < 1e-13, "reactions are along the rows alone", worst)
rolls:solver():run { q = q, p = I * V { 0.5, -0.3, 0 }, steps = 100 }:checkpoint(file)
ok(dm.resume(file, rolls):run { steps = 200 }.p[201] == path.p[301], "a rolling run goes on bit for bit")
os.remove(file)

---- Chaplygin's sleigh on SE(2): the blade, v2 = 0, at a from the centre of mass ----

local S, a, m, inertia = dm.SE(2), 0.3, 1.2, 0.5
local function moved(g0, g1) return S:log(S:compose(S:inverse(g0), g1)) end
local function sleigh(h)
  return dm.discrete_lagrangian { Q = S, h = h, Ld = function(g0, g1, h)
    local v = moved(g0, g1) / h
    return h * (m / 2 * (v[1] ^ 2 + (v[2] + a * v[3]) ^ 2) + inertia / 2 * v[3] ^ 2)
  end, rolling = function(g0, g1, h) return { moved(g0, g1)[2] / h } end, reaction = function() return { { 0, 1, 0 } } end }
end
exact = rk4(function(x) -- u, w, x, y, angle
  return V { a * x[2] ^ 2, -m * a * x[1] * x[2] / (inertia + m * a ^ 2), x[1] * math.cos(x[5]), x[1] * math.sin(x[5]), x[2] }
end, V { 0.7, 1.1, 0, 0, 0.3 }, 3, 1000)
order(function(n)
  local run = sleigh(3 / n):solver():run { q = { 0, 0, 0.3 }, steps = n,
    p = { m * 0.7, m * a * 1.1, (m * a ^ 2 + inertia) * 1.1 } }
  return (run.q[n + 1] - V { exact[3], exact[4], exact[5] }):norm()
end, 30, "the sleigh")

---- Chaplygin's sphere on a plate: its momentum about the point of contact is kept ----

local B, mass, radius = dm.product(G, dm.R(2)), 0.8, 0.5
local D = V { 0.3, 0.2, 0.25 }
local function turned(z0, z1) return G:log(z1[1] * z0[1]:transpose()) end -- in space
local function sphere(h)
  return dm.discrete_lagrangian { Q = B, h = h, Ld = function(z0, z1, h)
    local xi, v = step_of(z0[1], z1[1]) / h, (z1[2] - z0[2]) / h
    return h * (D[1] * xi[1] ^ 2 + D[2] * xi[2] ^ 2 + D[3] * xi[3] ^ 2 + mass * v:dot(v)) / 2
  end, rolling = function(z0, z1, h)
    local t, x = turned(z0, z1) / h, (z1[2] - z0[2]) / h
    return { x[1] - radius * t[2], x[2] + radius * t[1] }
  end, reaction = function(z0)
    local g = z0[1]
    return { { -radius * g[2][1], -radius * g[2][2], -radius * g[2][3], 1, 0 },
      { radius * g[1][1], radius * g[1][2], radius * g[1][3], 0, 1 } }
  end }
end
local function inertia_at(x) -- in space, with that of the centre about the contact; x = (place, rows of g)
  return dm.matrix((function()
    local out = {}
    for i = 1, 3 do
      out[i] = {}
      for j = 1, 3 do
        out[i][j] = i == j and i < 3 and mass * radius ^ 2 or 0
        for k = 1, 3 do out[i][j] = out[i][j] + row(x, i)[k] * D[k] * row(x, j)[k] end
      end
    end
    return out
  end)())
end
local z = start_of({ 0, 0, 0 }, q)
local turn = V { 0.6, 0.9, -0.4 }
local about = inertia_at(z) * turn
exact = rk4(function(x)
  local W = inertia_at(x):solve(about)
  local out = { radius * W[2], -radius * W[1], 0 }
  for j = 1, 3 do -- columns of g turn with W
    local column = cross(W, V { row(x, 1)[j], row(x, 2)[j], row(x, 3)[j] })
    for i = 1, 3 do out[3 * i + j] = column[i] end
  end
  return V(out)
end, z, 2, 300)
local spin_of_body = q:transpose() * turn
order(function(n)
  local run = sphere(2 / n):solver():run { q = { q, { 0, 0 } }, steps = n, p = { D[1] * spin_of_body[1], D[2] * spin_of_body[2],
    D[3] * spin_of_body[3], mass * radius * turn[2], -mass * radius * turn[1] } }
  local at = run.q[n + 1]
  return off(at[1], exact) + abs(at[2][1] - exact[1]) + abs(at[2][2] - exact[2])
end, 20, "Chaplygin's sphere")

---- a step depends on its state alone: before, Newton's method began at the root of the step before, which a
---- member or a resumed run has not

local plain = dm.discrete_lagrangian { Q = G, h = 0.05, Ld = body }
local whole = plain:solver():run { q = q, p = I * w, steps = 50 }
ok(dm.resume(plain:solver():run { q = q, p = I * w, steps = 20 }):run { steps = 30 }.p[31] == whole.p[51],
  "a run without forces goes on bit for bit")

---- bad input ----

raises("{ F1, F2 }", forced, 0.1, { force = function() return { 1, 2, 3 } end })
raises("force: F2 must have 3 entries", forced, 0.1, { force = function() return { { 1, 2, 3 }, { 1, 2 } } end })
raises("force: F1: entry 2 is", forced, 0.1, { force = function() return { { 1, 0 / 0, 3 }, { 1, 2, 3 } } end })
raises("'force' must be a function of (g0, g1", forced, 0.1, { force = 3 })
raises("must return one value", forced, 0.1, { force = function() return { 1, 2, 3 }, { 1, 2, 3 } end })
raises("field 'reaction' is missing", forced, 0.1, { rolling = no_spin })
raises("there are none", forced, 0.1, { reaction = no_spin })
raises("1 rows of 3 numbers", forced, 0.1, { rolling = no_spin, reaction = function() return { { 1, 0, 0 }, { 0, 1, 0 } } end })
raises("must have 3 entries", forced, 0.1, { rolling = no_spin, reaction = function() return { { 1, 2 } } end })
raises("rolling constraint 1 does not depend on", forced, 0.1, { rolling = function(g0) return g0[1][1] end, reaction = function() return { 0, 0, 1 } end })
raises("constraint 1 does not depend on q", forced, 0.1, { constraint = function() return 0 end })
raises("they leave no motion", forced, 0.1, { constraint = function(g) return { g[1][1], g[1][2], g[1][3], g[2][1] } end })
raises("off the constraints: constraint 1", steady.run, steady, { q = q, p = w, steps = 2 })
raises("has no mass, and 'project'", steady.run, steady, { q = lean, p = w, project = true, steps = 2 })
raises("knows no velocity", steady.run, steady, { q = lean, v = w, steps = 2 })
raises("knows no velocity", steady.ensemble, steady, { members = 2, q = function() return lean end, v = function() return w end, steps = 2 })
raises("no equations at a state", steady.run, steady, { q = lean, p = w, steps = 2, record = { "lambda" } })
raises("no rolling constraint", function() return tied:worst "rolling" end)
raises("so steps have no impulses", solver.run, solver, { q = q, p = w, steps = 2, record = { "impulses" } })
raises("is zero at this q", function()
  return forced(0.1, { constraint = function(g) return (g[3][3] - 0.6) ^ 2 end }):solver():run { q = lean, p = w, steps = 2 }
end)
raises("equation is NaN at the start", function()
  return forced(0.1, { force = function(g0) return { { (-1 - g0[1][1] ^ 2) ^ 0.5, 0, 0 }, { 0, 0, 0 } } end })
    :solver():run { q = q, p = w, steps = 2 }
end)
tap.done()
