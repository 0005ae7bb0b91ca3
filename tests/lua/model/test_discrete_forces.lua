-- discrete Lagrangians with forces F1, F2 and with rolling constraints on pairs: their equations, worked out again
-- here from values and differences, along the paths
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, sin, cos, exp = math.abs, math.max, math.sin, math.cos, math.exp

-- a damped oscillator against its recursion
local h, c = 0.1, 0.3
local function midpoint(a, b, h)
  local v, q = (b - a) / h, (a + b) / 2
  return h * (v:dot(v) / 2 - q:dot(q) / 2)
end
local function drag(a, b)
  local f = -c / 2 * (b - a)
  return { f, f }
end
local damped = dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = midpoint, force = drag }
local path = dm.solver { damped }:run { q = { 1 }, p = { 0 }, steps = 200 }
local x, y = 1, 0
for _ = 1, 200 do
  local n = (y + x * (1 / h - h / 4 + c / 2)) / (1 / h + h / 4 + c / 2)
  y = (n - x) / h - h / 4 * (x + n) - c / 2 * (n - x)
  x = n
end
near(path.q[201][1], x, 1e-13, "positions of a damped oscillator")
near(path.p[201][1], y, 1e-13, "momenta of a damped oscillator")
near(damped:legendre_minus({ 1 }, { 1.1 })[1], 1 - -h / 4 * 2.1 + c / 2 * 0.1, 1e-14, "p0 = -D1 Ld - F1")
near(damped:legendre_plus({ 1 }, { 1.1 })[1], 1 - h / 4 * 2.1 - c / 2 * 0.1, 1e-14, "p1 = D2 Ld + F2")

-- the same by the midpoint rule of the forced system; order 2 against the exact solution
local function ends(n)
  local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 2 / n, Ld = midpoint, force = drag }
  return dm.solver { Ld }:run { q = { 1 }, p = { 0 }, steps = n }.q[n + 1][1]
end
local system = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end,
  force = function(q, v) return { -c * v[1] } end }
near(ends(20), system:solver { rule = "midpoint", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 20 }.q[21][1], 1e-13,
  "a midpoint Ld with the midpoint of its force is the midpoint rule")
local w = math.sqrt(1 - c ^ 2 / 4)
local exact = exp(-c) * (cos(2 * w) + c / 2 / w * sin(2 * w))
near(math.log((ends(40) - exact) / (ends(80) - exact), 2), 2, 0.02, "order 2")

-- a nonlinear force on two coordinates, params, h: residual of p1(k) = p0(k + 1)
local function Ld(a, b, h, params)
  local v, q = (b - a) / h, (a + b) / 2
  return h * ((1 + q[1] ^ 2) * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 - params.k * cos(q[1]) * q[2] ^ 2 / 2)
end
local function push(a, b, h, params)
  local v = (b - a) / h
  return { { -0.1 * h * v[1] ^ 3, h * params.k * sin(b[2]) * v[1] }, { 0.05 * h * a[1] * b[2], -0.2 * h * v[2] } }
end
local bent = dm.discrete_lagrangian { Q = dm.R(2), h = h, Ld = Ld, force = push, params = { k = 0.7 } }
path = dm.solver { bent }:run { q = { 0.3, 0.4 }, p = { 0.5, -0.2 }, steps = 50 }
local worst = 0
for k = 2, 50 do
  local r = bent:legendre_plus(path.q[k - 1], path.q[k]) - bent:legendre_minus(path.q[k], path.q[k + 1])
  worst = max(worst, r:norm())
end
ok(worst < 1e-13, "D2 Ld + F2 + D1 Ld + F1 = 0 at every node", worst)
-- the derivative of Ld by differences, so that a wrong sign of F would be seen
local q0, q1, e = path.q[7], path.q[8], 1e-6
local slope = (bent({ q0[1] + e, q0[2] }, q1) - bent({ q0[1] - e, q0[2] }, q1)) / (2 * e)
near(bent:legendre_minus(q0, q1)[1], -slope - push(q0, q1, h, { k = 0.7 })[1][1], 1e-9, "signs of F1")

-- ensembles and checkpoints
local solver = dm.solver { bent }
local cloud = solver:ensemble { members = 3, q = function(i) return { 0.1 * i, 0.4 } end,
  p = function() return { 0.5, -0.2 } end, steps = 20 }
ok(cloud.q[3] == solver:run { q = { 0.1 * 3, 0.4 }, p = { 0.5, -0.2 }, steps = 20 }.q[21], "members have the bits of runs")
local file = os.tmpname()
solver:run { q = { 0.3, 0.4 }, p = { 0.5, -0.2 }, steps = 20 }:checkpoint(file)
ok(dm.resume(file, bent):run { steps = 30 }.q[31] == path.q[51], "a run goes on bit for bit")
os.remove(file)

-- rolling: v3 = y v1, reactions along (-y, 0, 1); the equations along the path
local function knife(a, b, h) return { (b[3] - a[3]) / h - (a[2] + b[2]) / 2 * (b[1] - a[1]) / h } end
local function free(a, b, h)
  local v, q = (b - a) / h, (a + b) / 2
  return h * (v:dot(v) / 2 - q[2] ^ 2 / 2)
end
local particle = dm.discrete_lagrangian { Q = dm.R(3), h = h, Ld = free, rolling = knife,
  reaction = function(a) return { { -a[2], 0, 1 } } end }
local start = { q0 = { 0.3, 1, 0.2 }, q1 = { 0.37, 1.04, 0.2714 }, steps = 300 }
path = dm.solver { particle }:run(start)
worst = 0
for k = 2, #path - 1 do
  local a, b, d = path.q[k - 1], path.q[k], path.q[k + 1]
  local r = (b - a) / h - (d - b) / h
  worst = max(worst, abs(r[2] - h / 4 * (a[2] + 2 * b[2] + d[2])), abs(r[1] + b[2] * r[3]),
    abs(knife(b, d, h)[1]))
end
ok(worst < 1e-12, "a particle that rolls, node by node", worst)
ok(path:worst "rolling" < 1e-12, "what is left of the constraint", path:worst "rolling")

-- with rows that see both ends, a constraint and a force beside them: a skate on a cylinder
local function rows(a, b) local m = (a[3] + b[3]) / 2 return { { -sin(m), cos(m), 0, 0 } } end
local skate = dm.discrete_lagrangian { Q = dm.R(4), h = 0.05, Ld = function(a, b, h)
  local v, q = (b - a) / h, (a + b) / 2
  return h * (v:dot(v) / 2 + 0.1 * v[1] * v[4] - 0.3 * q[1] ^ 2)
end, rolling = function(a, b, h)
  local m = (a[3] + b[3]) / 2
  return { (-sin(m) * (b[1] - a[1]) + cos(m) * (b[2] - a[2])) / h }
end, reaction = rows, constraint = function(q) return q[4] - q[1] ^ 2 / 2 end,
  force = function(a, b, h) local f = -0.02 * (b - a) return { f, f } end }
path = dm.solver { skate }:run { q = { 0, 0, 0.2, 0 }, p = { 1, 0.2, 0.6, 0.1 }, steps = 200, record = { "impulses" } }
worst = 0
for k = 2, 200 do
  local a, b, d = path.q[k - 1], path.q[k], path.q[k + 1]
  local r = skate:legendre_minus(b, d) - skate:legendre_plus(a, b)
  -- r = G(b)^T lambda + E(b, d)^T mu: what is across both vanishes
  local E = dm.vector(rows(b, d)[1]) -- G(b) = (-b1, 0, 0, 1)
  local across = dm.vector { E[2], -E[1], 0, E[2] * b[1] } -- in the first, second and fourth direction
  worst = max(worst, abs(r[3]), abs(across:dot(r)) / across:norm())
end
ok(worst < 1e-12, "reactions lie in the rows of G and E alone", worst)
ok(path:worst "rolling" < 1e-13 and path:worst "constraint" < 1e-13, "both kinds of constraints hold")

-- bad input
local disc = dm.system { Q = dm.R(2), coordinates = { "r", "theta" },
  L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }:routh { cyclic = { "theta" }, mu = 1 }
raises("a component along the group", function()
  return disc:discrete(dm.discrete_lagrangian { Q = dm.R(2), h = h, Ld = function(a, b, h) return (b - a):dot(b - a) / 2 / h end,
    force = function(a, b) return { a - b, a - b } end })
end)
raises("fit rolling constraint 1", function()
  return dm.solver { particle }:run { q0 = start.q0, q1 = { 0.37, 1.04, 0.3 }, steps = 3 }
end)
raises("reaction", dm.discrete_lagrangian, { Q = dm.R(3), h = h, Ld = free, rolling = knife })
raises("rows", dm.discrete_lagrangian, { Q = dm.R(3), h = h, Ld = free, rolling = knife, reaction = function(a) return { { 1, 2 } } end })
raises("{ F1, F2 }", dm.discrete_lagrangian, { Q = dm.R(1), h = h, Ld = midpoint, force = function(a, b) return b - a end })
raises("must be a function of (q0, q1", dm.discrete_lagrangian, { Q = dm.R(1), h = h, Ld = midpoint, force = 3 })
raises("force is NaN", function()
  return dm.solver { dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = midpoint,
    force = function(a, b) return { { dm.sqrt(-1 - a[1] ^ 2) }, { 0 } } end } }:run { q0 = { 1 }, q1 = { 1 }, steps = 3 }
end)

-- what a step takes is counted anew in each: a linear equation has its root by one iteration
do
  local spring = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h)
    return (b[1] - a[1]) ^ 2 / (2 * h) - h * (a[1] + b[1]) ^ 2 / 8
  end }
  local solver = dm.solver { spring }
  for _, steps in ipairs { 10, 1000 } do
    solver:run { q = { 1 }, p = { 0 }, steps = steps }
    local each = solver:report().evaluations / steps
    tap.ok(each >= 2 and each <= 5, "evaluations a step do not grow, " .. steps, each)
  end
end
tap.done()
