-- discrete Lagrange-Poincare equations: reduced runs against unreduced ones, the operators Ver and
-- Hor, the level of a spatial momentum, phases of rigid bodies, refusals
local tap = require "tap"
local dm = require "dm"
local space = require "dm.reduce.lagrange_poincare.space"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, max, sin, pi = math.abs, math.cos, math.max, math.sin, math.pi

---- reduced and unreduced steps are the same ----

local R1 = dm.R(1)
local cases = {
  { name = "SO(2)", Q = dm.product(R1, dm.SO(2)), G = dm.SO(2), x = { 1.2 }, p = { 0.1 },
    mu = { 0.8 },
    L = function(q, v)
      local x = q[1][1]
      return (v[1] ^ 2 + x ^ 2 * v[2] ^ 2 + 0.2 * v[1] * v[2]) / 2 - x ^ 2
    end },
  { name = "SE(2)", Q = dm.product(R1, dm.SE(2)), G = dm.SE(2), x = { 0.4 }, p = { 0.1 },
    mu = { 0.03, -0.02, 0.8 },
    L = function(q, v)
      local x = q[1][1]
      return ((1 + 0.3 * x ^ 2) * v[2] ^ 2 + 1.5 * v[3] ^ 2 + (2 + x ^ 2) * v[4] ^ 2 + v[1] ^ 2) / 2
        + 0.2 * v[1] * v[3] - x ^ 2 + 0.3 * v[2] * v[4]
    end },
  { name = "SO(3), the shape behind", Q = dm.product(dm.SO(3), dm.T(2)), G = dm.SO(3),
    x = { 0.4, 0.2 }, p = { 0.1, -0.1 }, mu = { 0.6, -0.4, 1.1 },
    L = function(q, w)
      local x = q[2]
      return (2 * w[1] ^ 2 + 3 * w[2] ^ 2 + 4 * w[3] ^ 2 + w[4] ^ 2 + w[5] ^ 2) / 2
        + 0.3 * w[1] * w[4] + 0.2 * w[3] * w[5] + 0.5 * (cos(x[1]) + cos(x[2]))
    end },
  { name = "SE(3)", Q = dm.product(R1, dm.SE(3)), G = dm.SE(3), x = { 0.4 }, p = { 0.1 },
    mu = { 0.6, -0.4, 1.1, 0.03, 0.02, -0.01 },
    L = function(q, w)
      local x = q[1][1]
      return ((1 + x ^ 2) * w[2] ^ 2 + (1.75 + x ^ 2) * w[3] ^ 2 + 2.25 * w[4] ^ 2
        + (1 + 0.1 * x ^ 2) * w[5] ^ 2 + 1.3 * w[6] ^ 2 + 0.8 * w[7] ^ 2 + w[1] ^ 2) / 2
        + 0.1 * w[2] * w[6] - w[1] / 2 * w[3] - x ^ 2
    end },
}
for _, c in ipairs(cases) do
  for _, rule in ipairs { "lie(1)", "lie(2)", "lie(1, cayley)", "lie(2, lobatto(3))" } do
    local name = c.name .. ", " .. rule
    local system = dm.system { Q = c.Q, L = c.L }
    local lp = system:reduce { group = c.G, rule = rule, h = 0.05 }
    local run = lp:solver():run { x = c.x, p = c.p, mu = c.mu, steps = 300 }
    local S, e = lp.space, c.G:identity()
    local full = system:solver { rule = rule, h = 0.05 }:run {
      q = space.element(S, dm.vector(c.x), e), p = space.joined(S, c.p, c.mu), steps = 300 }
    local back, worst, drift = run:reconstruct {}, 0, 0
    local J = c.G:coAd(e, c.mu)
    for k = 1, 301 do
      local x, g = space.split(S, full.q[k])
      local p, mu = space.parts(S, full.p[k])
      worst = max(worst, (x - run.x[k]):norm(), (p - run.p[k]):norm(), (mu - run.mu[k]):norm(),
        c.G:distance(g, back.g[k]))
      drift = max(drift, (c.G:coAd(back.g[k], run.mu[k]) - J):norm())
    end
    ok(worst < 1e-11, name .. ": the reduced run is the unreduced one", worst)
    ok(drift < 1e-12, name .. ": spatial momentum", drift)
    local ver, hor = lp:residual({ run.x[50], run.x[51], run.x[52] }, { run.f[50], run.f[51] })
    ok(ver:norm() < 1e-12 and hor:norm() < 1e-12, name .. ": Ver and Hor vanish", ver:norm())
  end
end

---- where L is written with g: 10^3 steps side by side, J over 10^4 ----

-- masses on a body, one of which slides on it: kinetic energy from their velocities in space
local function masses(K)
  local n = K:hat(dm.zeros(K.dimension)).rows
  local function spot(k, x)
    local r = {}
    for i = 1, n do r[i] = ((k + i) % 3 - 0.7) * (1 + 0.2 * i) end
    r[1], r[n] = k == 1 and x or r[1], K ~= dm.SO(2) and K ~= dm.SO(3) and 1 or r[n]
    return dm.vector(r)
  end
  return function(q, v)
    local x, g, xi, sum = q[1][1], K:matrix(q[2]), K:hat(v:slice(2, 1 + K.dimension)), -q[1][1] ^ 2
    for k = 1, 4 do
      local u = dm.zeros(n):totable()
      u[1] = k == 1 and v[1] or 0
      local w = g * (xi * spot(k, x) + dm.vector(u))
      sum = sum + (1 + 0.1 * k) * w:dot(w) / 2
    end
    return sum
  end
end

for _, row in ipairs { { "SO(2)", dm.SO(2) }, { "SE(2)", dm.SE(2) }, { "SO(3)", dm.SO(3) },
  { "SE(3)", dm.SE(3) } } do
  local K, name = row[2], row[1] .. " by masses"
  local system = dm.system { Q = dm.product(R1, K), L = masses(K) }
  local lp, mu, p = system:reduce { group = K, rule = "lie(2)", h = 0.05 }, {}, { 0.1 }
  for i = 1, K.dimension do mu[i], p[1 + i] = 0.9 / i, 0.9 / i end
  local run = lp:solver():run { x = 0.4, p = 0.1, mu = mu, steps = 10000, every = 10 }
  local full = system:solver { rule = "lie(2)", h = 0.05 }:run { q = { { 0.4 }, K:identity() },
    p = p, steps = 1000, every = 10 }
  local back, worst, drift = run:reconstruct {}, 0, 0
  for k = 1, 101 do
    worst = max(worst, abs(full.q[k][1][1] - run.x[k][1]), abs(full.p[k][1] - run.p[k][1]),
      K:distance(full.q[k][2], back.g[k]))
  end
  for k = 1, 1001 do
    drift = max(drift, (K:coAd(back.g[k], run.mu[k]) - dm.vector(mu)):norm())
  end
  ok(worst < 1e-12, name .. ": the reduced run is the unreduced one for 10^3 steps", worst)
  ok(drift < 2e-13, name .. ": spatial momentum for 10^4 steps", drift)
end

---- a formula: Ver and Hor with a connection, starts, members ----

local G = dm.SO(3)
local function bead(a, b, f, h)
  local x, v, w = (a[1] + b[1]) / 2, (b[1] - a[1]) / h, G:cayleyinv(f) / h
  return h * (((1 + x ^ 2) * w[1] ^ 2 + (1.75 + x ^ 2) * w[2] ^ 2 + 2.25 * w[3] ^ 2) / 2
    - x / 2 * w[1] * w[3] - v / 2 * w[2] + v ^ 2 / 2 - x ^ 2)
end
local form = dm.matrix { { 0.2 }, { -0.3 }, { 0.1 } }
local A = dm.connection { group = G, base = R1, form = function(x) return form * (1 + x[1]) end }
local lp = dm.lagrange_poincare { group = G, base = R1, h = 0.05, l = bead, connection = A }
local flat = dm.lagrange_poincare { group = G, base = R1, h = 0.05, l = bead }
local mu, g0 = dm.vector { 0.6, -0.4, 1.1 }, G:exp { 0.3, -0.2, 0.5 }
local xs = { { 0.4 }, { 0.41 }, { 0.43 } }
local fs = { G:exp { 0.03, 0.01, -0.02 }, G:exp { 0.02, 0.015, -0.01 } }
-- off solutions the operators pair the Euler-Lagrange covector with vertical and horizontal vectors
local ver, hor = lp:residual(xs, fs)
local ver0, hor0 = flat:residual(xs, fs)
near((ver - ver0):norm(), 0, 1e-15, "Ver does not know the connection")
near(hor[1], hor0[1] - ver0:dot((form * 1.41):column(1)), 1e-12, "Hor takes away <Ver, A>")
-- Gamma by differences of the action of two steps, g1 moved by exp(e eta)
local function action(x1, g1)
  return bead(xs[1], { x1 }, g1, 0.05)
    + bead({ x1 }, xs[3], G:compose(G:inverse(g1), G:compose(fs[1], fs[2])), 0.05)
end
local e = 1e-5
for a = 1, 3 do
  local eta = dm.zeros(3):totable()
  eta[a] = e
  local plus, minus = G:compose(fs[1], G:exp(eta)), G:compose(fs[1], G:exp(dm.vector(eta) * -1))
  near(ver[a], (action(0.41, plus) - action(0.41, minus)) / (2 * e), 1e-8,
    "Ver is the variation of the element, " .. a)
end
near(hor0[1], (action(0.41 + e, fs[1]) - action(0.41 - e, fs[1])) / (2 * e), 1e-8,
  "Hor with the trivial connection is that of the shape")

local run = lp:solver():run { x = { 0.4 }, p = { 0.1 }, mu = mu, steps = 60 }
local level = lp:solver():run { x = 0.4, p = 0.1, g = g0, momentum = G:coAd(g0, mu), steps = 60 }
near((level.mu[61] - run.mu[61]):norm(), 0, 1e-14, "the level of J is that of its mu")
near(G:distance(run:reconstruct { g = g0 }.g[61], level.path.q[61][2]), 0, 1e-13,
  "and the same motion from g0")
near(run.t[61], 3, 1e-14, "fields of the path behind")
local every = lp:solver():run { x = 0.4, p = 0.1, mu = mu, steps = 60, every = 20 }
near((every.mu[4] - run.mu[61]):norm(), 0, 0, "rows that are left out change nothing")
near(G:distance(every.f[1], G:compose(G:inverse(run.path.q[1][2]), run.path.q[21][2])), 0, 1e-15,
  "f leads from row to row")
local cloud = lp:solver():ensemble { members = 3, x = function(i) return { 0.3 + 0.05 * i } end,
  p = { 0.1 }, mu = mu, steps = 60, every = 30 }
near((space.parts(lp.space, cloud:path(2).p[#cloud:path(2)]) - run.p[61]):norm(), 0, 1e-14,
  "a member is a run")
local half = lp:solver():run { x = 0.4, p = 0.1, mu = mu, steps = 30 }
local event = lp:solver():run { x = 0.4, p = 0.1, mu = mu, steps = 60,
  events = { bottom = function(q) return q[1][1] - 0.1 end } }
ok(#half.path == 31 and #event.events > 0, "events look at Q")

-- other groups, and shapes that are angles: the chart moves these too
for _, row in ipairs { { "SO(2)", dm.SO(2) }, { "SE(2)", dm.SE(2) }, { "SE(3)", dm.SE(3) },
  { "SL(2)", dm.SL(2) }, { "Heisenberg", dm.Heisenberg(3) } } do
  local K = row[2]
  local r, has = K.dimension, row[1] ~= "Heisenberg"
  local other = dm.lagrange_poincare { group = K, base = dm.T(1), h = 0.05, l = function(a, b, f, h)
    local x, v, w = (a[1] + b[1]) / 2, (b[1] - a[1]) / h, has and K:cayleyinv(f) or K:log(f)
    local sum = v ^ 2 / 2 + 0.5 * cos(x)
    for i = 1, r do sum = sum + (1 + 0.2 * i + 0.1 * cos(x)) * (w[i] / h) ^ 2 / 2 end
    return h * sum
  end }
  local momentum = {}
  for i = 1, r do momentum[i] = 0.4 / i end
  local moved = other:solver():run { x = 0.3, p = 0.2, mu = momentum, steps = 60 }
  local v, w = other:residual({ moved.x[50], moved.x[51], moved.x[52] },
    { moved.f[50], moved.f[51] })
  ok(v:norm() < 1e-12 and w:norm() < 1e-12, row[1] .. " over angles: Ver and Hor vanish", w:norm())
end

-- a semidirect product is one group, not a product
local motions = dm.semidirect(G, dm.R(3))
local alone = dm.system { Q = motions,
  L = function(_, v) return v:dot(v) / 2 + 0.3 * v[1] * v[6] end }
  :reduce { group = motions, rule = "lie(2)", h = 0.05 }
local carried = alone:solver():run { mu = { 0.1, 0.2, 0.3, 0.4, 0.5, 0.6 }, steps = 50 }
near((motions:coAd(carried:reconstruct {}.g[51], carried.mu[51]) - carried.mu[1]):norm(), 0, 1e-14,
  "SO(3) |x R^3 without a shape")

-- far from the origin: m + x times p keeps its digits while x grows (150 and 160 away)
for _, K in ipairs { dm.SE(2), dm.SE(3), dm.Heisenberg(3) } do
  local r = K.dimension
  local other = dm.lagrange_poincare { group = K, base = R1, h = 0.05, l = function(a, b, f, h)
    local x, v, w = (a[1] + b[1]) / 2, (b[1] - a[1]) / h, K:cayleyinv(f)
    local sum = v ^ 2 / 2 - x ^ 2
    for i = 1, r do sum = sum + (1 + 0.2 * i + 0.1 * x ^ 2) * (w[i] / h) ^ 2 / 2 end
    return h * sum
  end }
  local momentum, drift = {}, 0
  for i = 1, r do momentum[i] = 0.4 / i end
  local far = other:solver():run { x = 0.3, p = 0.2, mu = momentum, steps = 10000, every = 50 }
  for k = 1, 201 do
    drift = max(drift, (K:coAd(far.path.q[k][2], far.mu[k]) - dm.vector(momentum)):norm())
  end
  ok(drift < 5e-13, tostring(K) .. ", a formula: spatial momentum for 10^4 steps", drift)
end

---- phases ----

-- a symmetric top: precession about J by |J|/I1 t, closed forms
local I1, I3, h = 1.5, 1, 0.01
local top = dm.lagrange_poincare { group = G, h = h, l = function(f, step)
  local w = G:cayleyinv(f) / step
  return step * (I1 * (w[1] ^ 2 + w[2] ^ 2) + I3 * w[3] ^ 2) / 2
end }
local m = dm.vector { 0.6, 0, 0.8 }
local spin = top:solver():run { mu = m, steps = 2356 }
local phases = spin:phases()
local worst = 0
for k = 1, 2357, 100 do
  worst = max(worst, abs(phases.total[k] - phases.dynamic[k] - phases.geometric[k]))
end
ok(worst < 1e-11, "total = dynamic + geometric", worst)
-- mu turns about e3 by rate -mu_3 (1/I3 - 1/I1)... its cone has area rate (1 - cos a) times that
local rate = 0.8 * (1 / I3 - 1 / I1)
near(abs(phases.geometric[2357]), abs(rate) * 23.56 * (1 - 0.8), 5e-3,
  "area of the cone of momenta")
near(phases.dynamic[2357], 23.56 * (0.36 / I1 + 0.64 / I3), 5e-3, "dynamic: 2 H t/|J|")
ok(abs(phases.total[2357]) > 2 * pi, "turns are not wrapped", phases.total[2357])
local body = dm.euler_poincare { group = G, l = function(w)
  return (w[1] ^ 2 + 1.6 * w[2] ^ 2 + 2.5 * w[3] ^ 2) / 2
end }
local p = body:solver { rule = "lie(2)", h = 15.22285740158978 / 400 }
  :run { p = { 0.5, 0.4, 1.2 }, steps = 400 }:phases()
near(math.atan(sin(p.total[401] - 3.140263738475), cos(p.total[401] - 3.140263738475)), 0, 1e-6,
  "the phase of a period, by Euler-Poincare")
near(p.total[401], p.dynamic[401] + p.geometric[401], 1e-11, "and its sum")
-- the same motion right-trivialized, on the cover, with a shape, and without reduction
local inertia = dm.matrix { { 1, 0, 0 }, { 0, 1.6, 0 }, { 0, 0, 2.5 } }
local function spun(system, start)
  start.steps = 100
  return system:solver { rule = "lie(4)", h = 0.05 }:run(start):phases()
end
local function energy(w) return w:dot(inertia * w) / 2 end
local turned = spun(dm.euler_poincare { group = G, l = energy }, { p = { 0.5, 0.4, 1.2 } })
local others = {
  right = spun(dm.system { Q = G, trivialization = "right",
    L = function(g, w) return energy(g:transpose() * w) end },
    { q = G:identity(), p = { 0.5, 0.4, 1.2 } }),
  cover = spun(dm.euler_poincare { group = dm.SU(2), l = energy }, { p = { 0.5, 0.4, 1.2 } }),
  product = spun(dm.system { Q = dm.product(R1, G),
    L = function(_, v) return energy(v:slice(2, 4)) + v[1] ^ 2 / 2 end },
    { q = { { 0 }, G:identity() }, p = { 0.3, 0.5, 0.4, 1.2 } }),
}
for name, other in pairs(others) do
  near(other.total[101], turned.total[101], 1e-9, "phases, " .. name)
  near(other.geometric[101], turned.geometric[101], 1e-9, "and their area, " .. name)
end

---- what is refused ----

local tilted = dm.system { Q = dm.product(R1, G),
  L = function(q, v) return v:dot(v) / 2 - q[2][3][3] end }
raises("L is not invariant under SO(3)", function()
  tilted:reduce { group = G, rule = "lie(1)", h = 0.1 }
end)
local free = dm.system { Q = dm.product(R1, G), L = function(_, v) return v:dot(v) / 2 end }
raises("the rule must be lie(s", function() free:reduce { group = G, rule = "verlet", h = 0.1 } end)
raises("behind the degree come", function()
  free:reduce { group = G, rule = "lie(1, foo)", h = 0.1 }
end)
raises("is a vector space", function()
  dm.lagrange_poincare { group = dm.R(2), base = R1, h = 0.1, l = function() return 0 end }
end)
raises("has no factor SE(2)", function()
  free:reduce { group = dm.SE(2), rule = "lie(1)", h = 0.1 }
end)
raises("the shapes are vectors", function()
  dm.system { Q = dm.product(G, G), L = function(_, v) return v:dot(v) / 2 end }
    :reduce { group = G, rule = "lie(1)", h = 0.1 }
end)
raises("depends on the time", function()
  dm.system { Q = dm.product(R1, G), L = function(_, v, t) return (1 + t) * v:dot(v) / 2 end }
    :reduce { group = G, rule = "lie(1)", h = 0.1 }
end)
raises("field 'mu' is missing", function() lp:solver():run { x = 0.4, p = 0.1, steps = 1 } end)
raises("give 'mu'", function()
  lp:solver():run { x = 0.4, p = 0.1, mu = mu, momentum = mu, steps = 1 }
end)
raises("not from q", function() lp:solver():run { q = { 1 }, steps = 1 } end)
raises("give 'v' or 'p', not both", function()
  free:reduce({ group = G, rule = "lie(1)", h = 0.1 }):solver():run { x = 0.4, p = 0.1,
    v = { 0, 0, 0, 1 }, steps = 1 }
end)
raises("must be 3 numbers, the body momentum (got 2)", function()
  lp:solver():run { x = 0.4, p = 0.1, mu = { 1, 2 }, steps = 1 }
end)
raises("must be 1 number, the shape (got 2)", function() lp:solver():run { x = { 1, 2 }, p = 0, mu = mu,
  steps = 1 } end)
raises("of another bundle", function()
  dm.lagrange_poincare { group = dm.SO(2), base = R1, h = 0.1, connection = A,
    l = function(_, _, f, step) return f ^ 2 / step end }
end)
raises("phases are known for SO(3)", function()
  dm.system { Q = cases[2].Q, L = cases[2].L }:reduce { group = dm.SE(2), rule = "lie(1)", h = 0.1 }
    :solver():run { x = 0.1, p = 0, mu = { 1, 0, 1 }, steps = 2 }:phases()
end)
raises("spatial momentum is not kept", function()
  spun(dm.system { Q = G, L = function(g, w) return energy(w) - g[3][3] end },
    { q = G:identity(), p = { 0.5, 0.4, 1.2 } })
end)
raises("more than half a turn is not seen in rows", function()
  body:solver { rule = "lie(2)", h = 0.05 }:run { p = { 0.5, 0.4, 1.2 }, steps = 200, every = 100 }
    :phases()
end)
raises("not for SO(3) x SO(3)", function()
  spun(dm.system { Q = dm.product(G, G), L = function(_, v) return v:dot(v) / 2 end },
    { q = { G:identity(), G:identity() }, p = { 1, 0, 0, 0, 1, 0 } })
end)
raises("momentum is zero", function()
  top:solver():run { mu = { 0, 0, 0 }, steps = 2 }:phases()
end)

tap.done()
