-- systems on groups stepped by lie(s): orders, schemes to their last digits, structure, starts
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, log = math.abs, math.max, math.log

local function far(a, b)
  if type(b) == "number" then return abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = max(worst, far(a[i], b[i])) end
  return worst
end

local function run(system, rule, h, steps, start, every)
  return system:solver { rule = rule, h = h }:run { q = start.q, p = start.p, v = start.v,
    steps = steps, every = every or steps }
end

local function finish(...)
  local path = run(...)
  return path.q[#path], path.p[#path], path
end

-- the order between n and 4 n steps over a time t, against g at its end
local function order(system, rule, t, n, start, g)
  local coarse = far(finish(system, rule, t / n, n, start), g)
  return log(coarse / far(finish(system, rule, t / n / 4, 4 * n, start), g), 4)
end

local SO3 = dm.SO(3)
local one = SO3:identity()
local function top(I, mgl)
  return dm.system { Q = SO3, L = function(R, W)
    return (I[1] * W[1] ^ 2 + I[2] * W[2] ^ 2 + I[3] * W[3] ^ 2) / 2 - mgl * R[3][3]
  end }
end

---- a heavy top without symmetry: orders, and digits of a program of its own ----

local heavy, tilt = top({ 1, 1.2, 0.6 }, 1), { q = SO3:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } }
-- by an independent program
local at4 = { { 0.863360085068844877, 0.297258278600659099, -0.407733833907967313 },
  { 0.243379992796450193, 0.462521913646183728, 0.852548918539852477 },
  { 0.442013057065418363, -0.83529096439530884, 0.326976241007260511 } }
for _, row in ipairs { { "lie(1)", 2, 40 }, { "lie(1, cayley)", 2, 80 }, { "lie(2)", 4, 20 },
  { "lie(2, lobatto(3))", 4, 40 }, { "lie(2, gauss(2), cayley)", 4, 40 }, { "lie(3)", 6, 20 },
  { "lie(3, lobatto(4))", 6, 20 }, { "lie(1, pade(1))", 2, 80 }, { "lie(1, pade(2))", 2, 80 },
  { "lie(2, pade(3))", 4, 40 }, { "lie(3, gauss(3), pade(4))", 6, 20 } } do
  near(order(heavy, row[1], 4, row[3], tilt, at4), row[2], 0.15, row[1] .. " on a heavy top")
end
local R, p = finish(heavy, "lie(1)", 0.2, 20, tilt)
near(R[1][1], 0.86956906380665008, 1e-14, "lie(1) after 20 steps, R11")
near(p[2], -0.57641298379200955, 1e-14, "lie(1) after 20 steps, Pi2")
R = finish(heavy, "lie(1, lobatto(2))", 0.2, 20, tilt)
near(R[3][3], 0.32037425565901778, 1e-14, "lie(1, lobatto(2)) after 20 steps, R33")

---- other groups ----

local SE3 = dm.SE(3)
local body = dm.system { Q = SE3, L = function(g, x)
  return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2 + 1.5 * x[4] ^ 2 + x[5] ^ 2 + 0.5 * x[6] ^ 2) / 2
    - 0.5 * g[3][4] - 0.3 * g[1][4] ^ 2 - g[1][1]
end }
local swimming = { q = SE3:exp { 0.1, 0.2, 0.3, 0.3, -0.2, 0.4 },
  p = { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 } }
local special = dm.system { Q = dm.SL(2), L = function(g, x)
  return (x[1] ^ 2 + 2 * x[2] ^ 2 + 1.5 * x[3] ^ 2) / 2 + 0.3 * x[1] * x[2]
    - (g[1][1] - 1) ^ 2 - g[1][2] ^ 2
end }
local sheared = { q = dm.SL(2):exp { 0.1, 0.2, 0.3 }, p = { 0.4, -0.3, 0.6 } }
for _, case in ipairs { { "SE(3)", body, swimming }, { "SL(2)", special, sheared } } do
  local fine = finish(case[2], "lie(4)", 1 / 128, 128, case[3])
  for _, row in ipairs { { "lie(1)", 2, 8 }, { "lie(2)", 4, 4 }, { "lie(2, lobatto(3))", 4, 4 },
    { "lie(3)", 6, 2 }, { "lie(2, cayley)", 4, 4 }, { "lie(2, pade(2))", 4, 4 } } do
    near(order(case[2], row[1], 1, row[3], case[3], fine), row[2], 0.15,
      row[1] .. " on " .. case[1])
  end
end

---- large charts: exp by products of small matrices, its second derivatives row by row (mech/group_map.h) ----

for _, Q in ipairs { dm.SO(4), dm.SO(5), dm.SL(3), dm.GL(3), dm.Sp(4) } do
  local xi, rate = {}, {}
  for i = 1, Q.dimension do xi[i], rate[i] = 0.1 + 0.03 * i, 0.4 - 0.05 * i end
  local kit = require "dm.group.kit".of(Q)
  ok((kit.slope(dm.vector(xi), dm.vector(rate)) - kit.dexp(xi, dm.vector(rate))):norm() < 1e-14, "the differential of exp on " .. tostring(Q))
  local solid = dm.system { Q = Q, L = function(g, x)
    local sum = -(g[1][1] - 1) ^ 2 - g[1][2] ^ 2 - 0.3 * g[2][2]
    for i = 1, Q.dimension do sum = sum + (0.5 + 0.1 * i) * x[i] ^ 2 / 2 end
    return sum
  end }
  local swing = { q = Q:exp(xi), v = rate }
  local fine = finish(solid, "gauss(4)", 1 / 80, 64, swing)
  for _, row in ipairs { { "lie(2)", 4, 8 }, { "lie(3)", 6, 4 } } do
    near(order(solid, row[1], 0.8, row[3], swing, fine), row[2], 0.15, row[1] .. " on " .. tostring(Q))
  end
end

---- the right trivialization is the same motion ----

local spatial = dm.system { Q = SO3, trivialization = "right", L = function(g, w)
  local W = g:transpose() * w
  return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - g[3][3]
end }
local turned = { q = tilt.q, p = tilt.q * dm.vector(tilt.p) }
near(order(spatial, "lie(2)", 4, 20, turned, at4), 4, 0.15, "lie(2), right trivialization")
local S, s = finish(spatial, "lie(3)", 0.02, 100, turned)
local B, b = finish(heavy, "lie(3)", 0.02, 100, tilt)
ok(far(S, B) < 1e-8 and far(s, B * b) < 1e-8, "and its momentum is the spatial one")
local right, left = run(spatial, "lie(3)", 0.02, 100, turned, 20), run(heavy, "lie(3)", 0.02, 100, tilt, 20)
for _, how in ipairs { "left", "right" } do
  local J, same = right:momentum(SO3, { side = how }), left:momentum(SO3, { side = how })
  for i = 1, #right do ok((J[i] - same[i]):norm() < 1e-8, how .. " momentum of either trivialization, row " .. i) end
end
local vertical, alike = right:momentum(dm.SO(2)), left:momentum(dm.SO(2))
for i = 1, #right do near(vertical[i], alike[i], 1e-8, "vertical momentum of either trivialization, row " .. i) end

---- structure ----

local free, spin = top({ 1, 2, 3 }, 0), { q = one, p = { 0.9, 0.3, 1.2 } }
local long = run(free, "lie(1)", 0.1, 1e4, spin, 10)
local off, drift = 0, 0
for i = 1, #long do
  off = max(off, far(long.q[i]:transpose() * long.q[i], one))
  drift = max(drift, far(long.q[i] * long.p[i], spin.p))
end
ok(off < 1e-14, "R^T R = 1 at every row")
ok(drift < 1e-13, "spatial momentum")

-- left equivariance: the run from k g0 is k times that from g0 for an L that does not see g
local k = SO3:exp { 0.3, -1.1, 0.7 }
local moved, there = finish(free, "lie(2)", 0.1, 50, { q = k, p = spin.p })
local still, here = finish(free, "lie(2)", 0.1, 50, spin)
ok(far(moved, k * still) < 1e-13 and far(there, here) < 1e-14, "left equivariance")

-- a turn about a fixed axis is not refused by a rotation that goes on and on
local turning = run(free, "lie(1)", 0.1, 200, { q = one, v = { 0, 0, 1 } }, 1)
local jump = 0
for c = 2, 5 do
  local x = turning:column(turning.columns[c])
  for i = 2, #x do jump = max(jump, abs(x[i] - x[i - 1])) end
end
ok(jump < 0.06, "quaternion columns do not change sign on the way")

-- on R^n it is galerkin(s)
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local start = { q = { 0.8, 0 }, v = { 0, 1.2 } }
for degree = 1, 3 do
  local name = ("(%d, gauss(%d))"):format(degree, degree)
  ok(far(finish(kepler, "lie" .. name, 0.05, 50, start),
    finish(kepler, "galerkin" .. name, 0.05, 50, start)) < 1e-15, "lie on R^n is galerkin" .. name)
end

---- momentum maps, tangent maps, linearization ----

local J = long:momentum(SO3)
ok(far(J[#long], spin.p) < 1e-13, "spatial momentum of a path")
near(far(long:momentum(SO3, { side = "right" })[7], long.p[7]), 0, 0, "body momentum")
local nod = run(heavy, "lie(2)", 0.1, 2000, tilt, 1)
ok(nod:drift(nod:momentum(dm.SO(2))).largest < 1e-12, "vertical momentum of a top")
near(nod:momentum(function(g) return g:transpose() * dm.vector { 0, 0, 1 } end)[9],
  nod:momentum(dm.SO(2))[9], 1e-14, "and by its generator")
local pair = dm.system { Q = dm.product(SO3, dm.R(3)), L = function(q, v)
  return (v[1] ^ 2 + 2 * v[2] ^ 2 + 3 * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2
    - (q[1]:transpose() * q[2])[1] ^ 2
end }
local flying = run(pair, "lie(2)", 0.05, 100, { q = { tilt.q, { 0.3, 0.1, -0.2 } },
  v = { 0.1, 0.4, -0.3, 0.2, 0.1, 0.5 } }, 1)
local M = flying:momentum(SO3)
ok(far(M[101], M[1]) < 1e-14, "rotations of a body and a point")
raises("no standard action", nod.momentum, nod, dm.R(2))

for _, rule in ipairs { "lie(1)", "lie(2)", "lie(2, lobatto(3))", "lie(3)" } do
  ok(heavy:solver { rule = rule, h = 0.1 }
    :symplecticity { q = tilt.q, p = tilt.p, steps = 20 } < 1e-12, rule .. " is symplectic")
end
local tangent_solver = heavy:solver { rule = "lie(2)", h = 0.1 }
local T, end_q, end_p = tangent_solver:tangent { q = tilt.q, p = tilt.p, steps = 20 }
local e, worst = 1e-5, 0
local function changed(u, dp)
  local there = tangent_solver:run { q = tilt.q * SO3:exp(u), p = dm.vector(tilt.p) + dp,
    steps = 20 }
  return SO3:log(end_q:transpose() * there.q[21]), there.p[21] - end_p
end
for column = 1, 6 do
  local u, dp = dm.zeros(3), dm.zeros(3)
  if column <= 3 then u[column] = e else dp[column - 3] = e end
  local a, da = changed(u, dp)
  local c, dc = changed(-u, -dp)
  for i = 1, 3 do
    worst = max(worst, abs((a[i] - c[i]) / (2 * e) - T[i][column]),
      abs((da[i] - dc[i]) / (2 * e) - T[3 + i][column]))
  end
end
ok(worst < 1e-8, "the tangent map against differences")
near(max(table.unpack(free:linearize { q = one, v = { 0, 1, 0 } }.rates:totable())),
  1 / math.sqrt(3), 1e-14, "growth about the middle axis")
local hanging = heavy:linearize { q = SO3:exp { math.pi, 0, 0 }, v = { 0, 0, 0 } }
near(hanging.fastest, 1, 1e-12, "a hanging top swings with sqrt(m g l / I)")

---- what a run takes and gives ----

local path = run(heavy, "lie(2)", 0.1, 20, tilt, 1)
ok(table.concat(path.columns, " ") == "t q1 q2 q3 q4 p1 p2 p3", "columns")
near(path:column "R31"[21], path.q[21][3][1], 0, "an entry of R as a column")
near(far(path:velocity(21), { path.p[21][1], path.p[21][2] / 1.2, path.p[21][3] / 0.6 }), 0, 1e-15,
  "velocity")
ok(path:drift "energy".largest < 1e-3, "energy")
local entries = dm.system { Q = SO3, columns = "matrix", L = heavy.L }
local other = run(entries, "lie(2)", 0.1, 20, tilt, 1)
ok(far(other.q[21], path.q[21]) < 1e-14 and #other.columns == 13, [[columns = "matrix"]])
near(heavy:energy(tilt.q, { 0, 0, 0 }), tilt.q[3][3], 1e-15, "energy of a state")
ok(far(heavy:legendre(tilt.q, { 1, 1, 1 }), { 1, 1.2, 0.6 }) < 1e-15, "momentum of a state")
ok(far(heavy:velocity(tilt.q, { 1, 1.2, 0.6 }), { 1, 1, 1 }) < 1e-15, "velocity of a state")
ok(heavy:mass(tilt.q, { 0, 0, 0 }).rows == 3, "mass of a state")

local solver = heavy:solver { rule = "lie(2)", h = 0.1 }
local whole_run = solver:run { q = tilt.q, p = tilt.p, steps = 1 }
local nodded = solver:run { q = tilt.q, p = tilt.p, steps = 50,
  events = { low = function(g) return g[3][3] - 0.5 end },
  record = { height = function(g) return g[3][3] end } }
near(nodded.events[1].q[3][3], 0.5, 1e-12, "an event of the element")
near(nodded:column "height"[51], nodded.q[51][3][3], 0, "a recorded function of the element")

local g, mu = solver:step { q = tilt.q, p = tilt.p }
ok(far(g, whole_run.q[2]) == 0 and far(mu, whole_run.p[2]) == 0, "solver:step")

local file = os.tmpname()
solver:run { q = tilt.q, p = tilt.p, steps = 70 }:checkpoint(file)
local whole = solver:run { q = tilt.q, p = tilt.p, steps = 100 }
near(far(dm.resume(file, heavy):run { steps = 30 }.p[31], whole.p[101]), 0, 0, "a run goes on")
os.remove(file)

local cloud = solver:ensemble { members = 5, steps = 100, q = function() return tilt.q end,
  p = function(i) return { 0.2, 0.1 * i, 1.5 } end }
near(far(cloud.p[1], whole.p[101]), 0, 0, "a member has the bits of a run")
near(far(cloud.q[1], whole.q[101]), 0, 0, "and its element")

---- forces ----

local damped = dm.system { Q = SO3, L = function(_, w) return w:dot(w) / 2 end,
  force = function(_, w) return -0.4 * w end }
local angle = (1 - math.exp(-2)) / 0.4
ok(far(finish(damped, "lie(2)", 0.05, 100, { q = one, v = { 0.3, -0.2, 0.5 } }),
  SO3:exp { 0.3 * angle, -0.2 * angle, 0.5 * angle }) < 1e-6, "friction")
local driven = dm.system { Q = SO3, L = heavy.L, force = function(g, w, t)
  return { -0.3 * w[1] + 0.2 * g[1][2], 0.1 * t - 0.2 * w[2], 0.2 * g[3][1] - w[3] ^ 2 / 10 }
end }
local fine = finish(driven, "lie(4)", 1 / 64, 128, tilt)
for _, row in ipairs { { "lie(1)", 2, 20 }, { "lie(2)", 4, 10 }, { "lie(3)", 6, 6 } } do
  near(order(driven, row[1], 2, row[3], tilt, fine), row[2], 0.2, row[1] .. " with a torque")
end

---- refusals ----

raises("pi: take a smaller step", finish, free, "lie(1)", 1, 1, { q = one, v = { 0, 0, 4 } })
raises("no element of SO(3), its columns are off orthonormal ones by 0.21", finish, free, "lie(1)", 0.1, 1,
  { q = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1.1 } }, v = { 0, 0, 1 } })
local near_by = free:solver { rule = "lie(1)", h = 0.1 }:run { v = { 0, 0, 1 }, steps = 1,
  q = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1.1 } }, project = true }
ok(far(near_by.q[1], one) < 1e-14, "project = true")
raises("field 'q' is missing: an element of SO(3) is a matrix of 3 x 3", function()
  free:solver { rule = "lie(1)", h = 0.1 }:run { v = { 0, 0, 1 }, steps = 1 }
end)
raises("matrix of 3 x 3", finish, free, "lie(1)", 0.1, 1, { q = { 1, 0 }, v = { 0, 0, 1 } })
raises("3 entries", finish, free, "lie(1)", 0.1, 1, { q = one, v = { 0, 0, 1, 0 } })
raises("degenerate", finish, dm.system { Q = SO3, L = function(_, w) return w[1] ^ 2 end },
  "lie(1)", 0.1, 1, { q = one, v = { 1, 0, 0 } })
raises("compositions of midpoint and lie(s) do", finish, dm.system { Q = dm.SO(4), L = function(_, w)
  return w:dot(w) / 2
end }, "verlet", 0.1, 1, { q = dm.SO(4):identity(), v = { 1, 0, 0, 0, 0, 0 } })
raises("no Cayley map", finish, dm.system { Q = dm.SL(3),
  L = function(_, x) return x:dot(x) / 2 end }, "lie(1, cayley)", 0.1, 1,
  { q = dm.SL(3):identity(), p = { 0, 0, 0, 0, 0, 0, 0, 1 } })
raises("lie takes the degree", heavy.solver, heavy, { rule = "lie(1.5)", h = 0.1 })
raises("exp, cayley or pade(k)", heavy.solver, heavy, { rule = "lie(1, nothing)", h = 0.1 })
raises("s nodes at least", heavy.solver, heavy, { rule = "lie(2, gauss(1))", h = 0.1 })
raises("left\" or \"right", dm.system, { Q = SO3, trivialization = "up", L = heavy.L })

tap.done()
