-- all rules of coordinates on groups, by the homogeneous lift: orders against lie(4), exact symplecticity, forces, constraints, bits, refusals
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
local function finish(system, rule, h, steps, s)
  local path = system:solver { rule = rule, h = h }:run { q = s.q, p = s.p, v = s.v, steps = steps, every = steps }
  return path.q[#path], path.p[#path], path
end
-- order from n and 2n steps over the time t; the value is that of another rule, with short steps, where there is one
local function check_order(system, rule, order, n, t, s, exact, what)
  local e = {}
  for k = 1, 2 do
    local q, p = finish(system, rule, t / n / k, n * k, s)
    e[k] = max(far(q, exact[1]), far(p, exact[2]))
  end
  near(log(e[1] / e[2]) / log(2), order, 0.15, ("%s: order %d on %s"):format(rule, order, what))
end

---- orders on a heavy top, symplectic to round-off on T*SO(3) ----

local G = dm.SO(3)
local function kinetic(W) return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 + 0.1 * W[1] * W[2] end
local function potential(R) return R[3][3] + 0.3 * R[1][2] ^ 2 end
local top = dm.system { Q = G, L = function(R, W) return kinetic(W) - potential(R) end }
local tilt = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } }
local exact = { finish(top, "lie(4)", 0.01, 200, tilt) }
for _, row in ipairs { { "verlet", 2, 40 }, { "trapezoidal", 2, 40 }, { "lobatto(3)", 4, 20 }, { "lobatto(4)", 6, 16 }, { "galerkin(2, gauss(3))", 4, 20 },
  { "galerkin(3, lobatto(4))", 6, 10 }, { "sprk(radau-1a, 2)", 3, 20 }, { "yoshida(4)", 4, 80 }, { "rk4", 4, 40 } } do
  check_order(top, row[1], row[2], row[3], 2, tilt, exact, "a heavy top")
  local solver = top:solver { rule = row[1], h = 0.1 }
  local defect = solver:symplecticity { q = tilt.q, p = tilt.p, steps = 5 }
  if row[1] == "rk4" then ok(defect > 1e-8, "rk4 is not symplectic", defect)
  else ok(defect < 1e-13, row[1] .. " is symplectic on T*SO(3)", defect) end
  ok(solver.lift == "homogeneous", row[1] .. " goes by the homogeneous lift")
end
ok(top:solver { rule = "gauss(2)", h = 0.1 }.lift == "collective", "gauss(2) by the collective one, as before")
ok(top:solver { rule = "lie(2)", h = 0.1 }.lift == nil, "lie(2) by none")

---- units of mass change nothing; nor does a factor of a product that has other ones ----

local SU2 = dm.SU(2)
local function of_units(Q, I, K, coupled)
  return dm.system { Q = Q, L = function(g, w)
    local R = coupled and g[1] or g
    local sum = I * ((w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 * (1 + 0.1 * R[1][2] ^ 2) - R[3][3])
    return coupled and sum + K * ((w[4] ^ 2 + w[5] ^ 2 + 2 * w[6] ^ 2) / 2 - g[2][1] * g[2][2]) or sum
  end }
end
for _, rule in ipairs { "verlet", "lobatto(3)", "trapezoidal", "rk4", "symplectic-euler" } do
  local v, two = { 0.2, 0.1, 1.5 }, dm.product(G, SU2)
  local q = { tilt.q, SU2:exp { 0.1, 0.3, 0.2 } }
  local one = finish(of_units(G, 1), rule, 0.1, 40, { q = tilt.q, v = v })
  for _, I in ipairs { 1e-3, 1e3, 1e6 } do
    near(far(finish(of_units(G, I), rule, 0.1, 40, { q = tilt.q, v = v }), one), 0, 1e-13,
      ("%s of a body with %g times the mass"):format(rule, I))
  end
  local w = { v[1], v[2], v[3], 0.4, 0.2, 0.3 }
  local both = finish(of_units(two, 1, 1, true), rule, 0.1, 40, { q = q, v = w })
  local apart = finish(of_units(two, 1e-3, 1e4, true), rule, 0.1, 40, { q = q, v = w })
  near(far(apart[1], one), 0, 1e-13, rule .. ": beside another body")
  near(far(apart[2], both[2]), 0, 1e-13, rule .. ": and that one")
end
-- a turn of a radian in a step, which had no solution with 1 for the mass across the sphere
local fast = dm.system { Q = G, L = function(_, w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end }
ok(G:distance((finish(fast, "verlet", 0.5, 1, { q = G:identity(), v = { 0, 0, 2 } })), G:identity()) > 0.9, "a radian in a step")

-- d2L/dxi2 that depends on xi, infinite at rest
local bent = dm.system { Q = G, L = function(R, w)
  return (2 + R[1][1]) * (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) ^ 0.75 - R[3][3]
end }
local moving = { q = tilt.q, v = { 0.5, 1, 0.2 } }
local bent_exact = { (finish(bent, "lie(3)", 0.01, 20, moving)) }
near(far({ (finish(bent, "lobatto(3)", 0.01, 20, moving)) }, bent_exact), 0, 1e-7, "a mass infinite at rest: lobatto(3)")
near(far({ (finish(bent, "verlet", 0.01, 20, moving)) }, bent_exact), 0, 3e-4, "and verlet")
ok(bent:solver { rule = "verlet", h = 0.05 }:symplecticity { q = moving.q, v = moving.v, steps = 10 } < 1e-12, "and its tangent map")

---- vertical momentum, energy, bits ----

local hanging = dm.system { Q = G, L = function(R, W) return kinetic(W) - R[3][3] end }
local solver = hanging:solver { rule = "lobatto(3)", h = 0.1 }
local path = solver:run { q = tilt.q, p = tilt.p, steps = 20000, every = 20 }
ok(path:drift(path:momentum(dm.SO(2))).largest < 2e-14, "lobatto(3): vertical momentum over 20000 steps")
local first, second = 0, 0
local E = path:energy()
for i = 1, #E do
  local off = abs(E[i] - E[1])
  if i < #E // 2 then first = max(first, off) else second = max(second, off) end
end
ok(second < 1.05 * first and first < 1e-5, "its energy stays in a band", second)
-- symplectic Euler makes the quaternion longer in every step: it is brought back by powers of 2, its momentum with it
local lengthened = hanging:solver { rule = "symplectic-euler", h = 0.1 }:run { q = tilt.q, p = tilt.p, steps = 2000, every = 10 }
ok(lengthened:drift(lengthened:momentum(dm.SO(2))).largest < 1e-14 and abs(lengthened:drift("energy").per_time) < 1e-4,
  "symplectic-euler: vertical momentum where coordinates are scaled", lengthened:drift(lengthened:momentum(dm.SO(2))).largest)
local once, by_one = solver:run { q = tilt.q, p = tilt.p, steps = 200, every = 200 }, solver:run { q = tilt.q, p = tilt.p, steps = 200 }
ok(far(once.p[2], by_one.p[201]) == 0 and far(once.q[2], by_one.q[201]) == 0, "a burst has the bits of its steps")
local file = os.tmpname()
solver:run { q = tilt.q, p = tilt.p, steps = 123 }:checkpoint(file)
ok(far(dm.resume(file, hanging):run { steps = 77 }.p[78], by_one.p[201]) == 0, "so has a run that goes on")
os.remove(file)
local cloud = solver:ensemble { members = 3, q = function() return tilt.q end, p = function(i) return { 0.2, 0.1 * i, 1.5 } end, steps = 200 }
ok(far(cloud.p[1], by_one.p[201]) == 0, "and a member of an ensemble")

---- the exact tangent map against differences, both lifts on one model ----

local strange = dm.system { Q = G, H = function(R, P) return dm.sqrt(1 + P[1] ^ 2 + P[2] ^ 2 + 2 * P[3] ^ 2) + R[3][3] end }
for _, rule in ipairs { "lobatto(3)", "gauss(2)", "rk4", "lobatto(2)" } do
  local own = strange:solver { rule = rule, h = 0.1 }
  local M, q1, p1 = own:tangent { q = tilt.q, p = tilt.p, steps = 5 }
  local q, p = finish(strange, rule, 0.1, 5, tilt)
  ok(far(p, p1) + far(q, q1) < 1e-14, rule .. ": the tangent map follows the run, of an H without L")
  local e = 1e-4
  local plus, minus = finish(strange, rule, 0.1, 5, { q = G:compose(tilt.q, G:exp { 0, e, 0 }), p = tilt.p }),
    finish(strange, rule, 0.1, 5, { q = G:compose(tilt.q, G:exp { 0, -e, 0 }), p = tilt.p })
  local u = G:log(G:compose(G:inverse(minus), plus)) * (0.5 / e)
  ok(far({ M[1][2], M[2][2], M[3][2] }, u) < 1e-8, rule .. ": its column is the derivative")
end

---- other groups ----

local SE, SL, SL3 = dm.SE(3), dm.SL(2), dm.SL(3)
local SR, heisenberg = dm.product(G, dm.SU(2), dm.R(2)), dm.Heisenberg(1)
local Aff = dm.group { name = "Aff(1)", basis = { { { 0, 1 }, { 0, 0 } }, { { 1, 0 }, { 0, 0 } } } }
local function half(x) return x:dot(x) / 2 end
local function with_quartic(x) return half(x) + 0.1 * x[1] ^ 4 end
for _, row in ipairs {
  { SE, function(g, x) return half(x) + 0.2 * x[1] * x[5] - g[3][3] - 0.5 * g[3][4] ^ 2 end, { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 } },
  { dm.semidirect(G, dm.R(3)), function(g, x) return half(x) + x[1] ^ 2 - g[1][3][3] - 0.5 * g[2]:dot(g[2]) end, { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 } },
  { SL, function(g, x) return half(x) - 0.5 * g[1][1] ^ 2 end, { 0.5, 0.2, 0.3 } },
  { SL3, function(g, x) return half(x) - 0.5 * g[1][2] ^ 2 end, { 0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.4, 0.5 } },
  { dm.GL(2), function(g, x) return half(x) - g[1][2] * g[2][1] end, { 0.5, 0.3, 0.2, 0.1 } },
  { SR, function(g, x) return half(x) + x[1] * x[4] / 2 - g[1][1][1] * g[2][1] - g[3][1] ^ 2 end, { 0.5, 0.3, 0.2, 0.1, 0.3, 0.2, 0.4, 0.5 } },
  { heisenberg, function(g, x) return with_quartic(x) - g[1] ^ 2 - g[3] * g[2] end, { 0.5, 0.3, 0.2 } },
  { Aff, function(g, x) return with_quartic(x) - g[1][1] ^ 2 end, { 0.5, 0.3 } } } do
  local Q = row[1]
  local system, start = dm.system { Q = Q, L = row[2] }, { q = Q:identity(), v = row[3] }
  local value = { finish(system, "lie(3)", 0.01, 50, start) }
  check_order(system, "lobatto(3)", 4, 4, 0.5, start, value, tostring(Q))
  local s = system:solver { rule = "galerkin(2, gauss(3))", h = 0.1 }
  ok(s:symplecticity { q = start.q, v = start.v, steps = 2 } < 1e-13, "galerkin(2, gauss(3)) is symplectic on T*" .. tostring(Q))
end
local sideways = dm.system { Q = G, trivialization = "right", L = function(R, w) return kinetic(R:transpose() * w) - potential(R) end,
  force = function(_, w, t) return -0.1 * w + dm.vector { 0, dm.sin(t), 0 } end }
exact = { finish(sideways, "lie(3)", 0.02, 50, tilt) }
check_order(sideways, "lobatto(3)", 4, 10, 1, tilt, exact, "the right trivialization with a torque")
check_order(sideways, "gauss(2)", 4, 10, 1, tilt, exact, "the right trivialization with a torque")

---- forces, controls, constraints, rolling ----

local swung = dm.system { Q = G, L = function(R, W) return kinetic(W) - potential(R) end, control = function(_, W) return { -W[1], -W[2] } end,
  force = function(R, W, t, u) return { 0.3 * u[1] - 0.1 * W[1], 0.3 * u[2], R[1][1] * dm.sin(t) } end }
local a, b = { finish(swung, "lie(3)", 0.02, 50, tilt) }, { finish(swung, "gauss(3)", 0.02, 50, tilt) }
local c = { finish(swung, "lobatto(4)", 0.02, 50, tilt) }
ok(far(a[2], b[2]) < 2e-8 and far(a[2], c[2]) < 2e-8, "torques and controls held over a step: three rules agree")
local hung = dm.system { Q = dm.product(G, dm.R(3)), constraint = function(q) return q[2] - q[1] * dm.vector { 0, 0, 1 } end,
  L = function(q, v) return (v[1] ^ 2 + 1.2 * v[2] ^ 2 + 0.6 * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 - q[2][3] end }
local W = dm.vector { 0.2, 0.2 / 2.2, 2.5 }
local V = tilt.q * dm.vector { W[2], -W[1], 0 }
local hook = { q = { tilt.q, tilt.q * dm.vector { 0, 0, 1 } }, v = { W[1], W[2], W[3], V[1], V[2], V[3] } }
for _, row in ipairs { { "lobatto(2)", 2 }, { "gauss(2)", 4 }, { "lobatto(3)", 4 }, { "midpoint", 2 } } do
  local e, run = {}, nil
  for k = 1, 2 do
    run = hung:solver { rule = row[1], h = 0.1 / k }:run { q = hook.q, v = hook.v, steps = 20 * k, record = { "lambda", "impulses" } }
    e[k] = abs(run.q[#run][1][3][3] - 0.414657157329603274)
  end
  near(log(e[1] / e[2]) / log(2), row[2], 0.1, row[1] .. ": a joint on SO(3) x R^3")
  ok(run:worst "constraint" < 1e-13, "and no drift off it")
  near(run:column "lambda1"[41], -0.07498, row[2] == 4 and 1e-5 or 5e-3, "multipliers are those of lie(2)")
end
local moved = { q = { tilt.q, tilt.q * dm.vector { 0, 0, 1.1 } }, v = hook.v }
local joint = dm.system { Q = hung.Q, constraint = hung.given.constraint, L = hung.given.L }
local brought = joint:solver { rule = "gauss(2)", h = 0.1 }:run { q = moved.q, v = moved.v, project = true, steps = 1 }
ok(brought:worst "constraint" < 1e-13, "project = true where no step goes by the chart")
raises("constraint 4 depends on those before it", function()
  dm.system { Q = hung.Q, L = hung.given.L, constraint = function(q)
    local g = q[2] - q[1] * dm.vector { 0, 0, 1 }
    return { g[1], g[2], g[3], g[1] + g[2] }
  end }:solver { rule = "gauss(2)", h = 0.1 }:run { q = moved.q, v = moved.v, project = true, steps = 1 }
end)
local ball = dm.system { Q = dm.product(G, dm.R(2)), L = function(_, v) return 0.2 * (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) + (v[4] ^ 2 + v[5] ^ 2) / 2 end,
  rolling = function(q, v)
    local w = q[1] * dm.vector { v[1], v[2], v[3] }
    return { v[4] + 1.4 * q[2][2] - w[2], v[5] - 1.4 * q[2][1] + w[1] }
  end }
for _, rule in ipairs { "gauss(3)", "lobatto(4)" } do
  local place, _, run = finish(ball, rule, 0.04, 75, { q = { G:identity(), { 0.5, 0.2 } }, v = { 0.3, -0.1, 0.7, -0.38, 0.4 } })
  ok(far(place[2], { -1.02307937719219145, 0.526278952720066248 }) < 1e-12, rule .. ": a ball on a turntable, in closed form")
  ok(run:worst "rolling" < 1e-12, "no slip")
end

---- refusals ----

local four = dm.system { Q = dm.SO(4), L = function(g, x) return half(x) - g[1][1] end }
local rest = { q = four.Q:identity(), v = { 0.1, 0.2, 0.3, 0.4, 0.5, 0.6 } }
raises("lie(s, lobatto(s + 1)) is the pair", function() finish(four, "lobatto(3)", 0.1, 1, rest) end)
raises("rotations(k)", function() finish(top, "blanes-moan(6)", 0.1, 1, tilt) end)
raises("time of its own", function() finish(top, "sem(1, gauss(1))", 0.1, 1, tilt) end)
do -- with forces verlet is the Lobatto pair
  local x, y = { finish(swung, "verlet", 0.1, 20, tilt) }, { finish(swung, "lobatto(2)", 0.1, 20, tilt) }
  ok(x[1] == y[1] and x[2] == y[2], "verlet with forces", x[1])
end
tap.done()
