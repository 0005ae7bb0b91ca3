-- the step equation with multipliers and forces on the test problems of the literature: exact solutions, drift, momentum
-- equation, energy balance, failures
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, exp, sqrt, abs, max, pi = math.sin, math.cos, math.exp, math.sqrt, math.abs, math.max, math.pi
local watched = os.getenv "UNDER" ~= "" and os.getenv "UNDER" ~= nil -- under a sanitizer: shorter runs

local function run(system, rule, h, steps, start, every)
  return system:solver { rule = rule, h = h }:run { q = start.q, v = start.v, steps = steps, every = every or steps, t0 = start.t0 }
end

-- ---- constraints over a million steps ----

local sphere = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end }
local swing = { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 } }
local steps = watched and 20000 or 1000000
local path = run(sphere, "midpoint", 0.02, steps, swing, 100)
ok(path:worst "constraint" < 1e-15, "10^6 steps of midpoint on the sphere: |q|^2 - 1 at every step", path:worst "constraint")
local worst = 0
for i = 1, #path do worst = max(worst, abs(path.q[i][1] * path.p[i][2] - path.q[i][2] * path.p[i][1] - 0.6)) end
ok(worst < 1e-13, "  and the momentum about the vertical", worst)
ok(path:drift("energy").per_time * 0.02 * steps < 1e-6, "  and no drift of the energy", path:drift("energy").per_time)

-- ---- many constraints: the matrix is a band; the trapezoid has the positions of rattle to round-off ----

local function chain(n)
  return dm.system { Q = dm.R(2 * n), L = function(q, v)
    local height = 0
    for i = 1, n do height = height + q[2 * i] end
    return v:dot(v) / 2 - height
  end, constraint = function(q)
    local g = { q[1] ^ 2 + q[2] ^ 2 - 1 }
    for i = 2, n do g[i] = (q[2 * i - 1] - q[2 * i - 3]) ^ 2 + (q[2 * i] - q[2 * i - 2]) ^ 2 - 1 end
    return g
  end }
end
local function hanging(n) -- stretched, at 53 degrees from the horizontal
  local start = { q = {}, v = {} }
  for i = 1, n do start.q[2 * i - 1], start.q[2 * i], start.v[2 * i - 1], start.v[2 * i] = 0.6 * i, -0.8 * i, 0, 0 end
  return start
end
for _, n in ipairs { 2, 12, 30 } do
  local one, two = run(chain(n), "trapezoidal", 0.01, 100, hanging(n)), run(chain(n), "rattle", 0.01, 100, hanging(n))
  near((one.q[2] - two.q[2]):norm(), 0, 1e-12 * n, n .. " rods: the trapezoid is rattle")
end
path = run(chain(30), "gauss(2)", 0.02, 50, hanging(30))
near((path.q[#path] - run(chain(30), "gauss(3)", 0.02, 50, hanging(30)).q[2]):norm(), 0, 1e-4, "30 rods: gauss(2) and gauss(3) agree")
near((run(chain(30), "gauss(2)", 0.01, 100, hanging(30)).q[2] - run(chain(30), "gauss(3)", 0.01, 100, hanging(30)).q[2]):norm(), 0, 1e-5,
  "  and better at half the step")

-- ---- Galerkin rules and compositions keep their orders: variable mass, damping and a constraint; rolling ----

local heavy = dm.system { Q = dm.R(3), L = function(q, v) return (1 + 0.3 * q[1] ^ 2) * v:dot(v) / 2 - q[3] end,
  constraint = function(q) return q:dot(q) - 1 end, force = function(_, v) return -0.1 * v end }
local rolls = dm.system { Q = dm.R(3), rolling = function(q, v) return v[3] - q[2] * v[1] end,
  L = function(q, v) return v:dot(v) / 2 - (q[1] ^ 2 + q[2] ^ 2) / 2 - 0.3 * q[3] * sin(q[1] + q[2]) end }
for _, case in ipairs { { heavy, swing, "constraint" }, { rolls, { q = { 1, 0.5, 0 }, v = { 0.4, 1, 0.2 } }, "rolling" } } do
  local system, start, tie = table.unpack(case)
  local want = run(system, "gauss(6)", 1 / 60, 60, start).q[2]
  for _, row in ipairs { { "galerkin(1, gauss(2))", 2, 32 }, { "galerkin(2, lobatto(3))", 4, 16 }, { "galerkin(2, gauss(3))", 4, 16 },
    { "galerkin(2, radau(2))", 3, 32 }, { "galerkin(3, radau(3))", 5, 16 }, { "galerkin(3, lobatto(4))", 6, 8 },
    { "galerkin(3, clenshaw-curtis(5))", 6, 8 }, { "yoshida(4, midpoint)", 4, 32 }, { "suzuki(4, lobatto(2))", 4, 16 },
    { "kahan-li(6, trapezoidal)", 6, 16 } } do
    local rule, order, n = table.unpack(row)
    local coarse, fine = run(system, rule, 1 / n, n, start).q[2], run(system, rule, 0.5 / n, 2 * n, start).q[2]
    near(math.log((coarse - want):norm() / (fine - want):norm(), 2), order, 0.1, rule .. ": order with a " .. tie)
  end
end

-- ---- vertical rolling disk, mass, radius and both inertias 1: heading w t, circles of radius 1 / w ----

local disk = dm.system { Q = dm.R(4), L = function(_, v) return v:dot(v) / 2 end,
  rolling = function(q, v) return { v[1] - cos(q[4]) * v[3], v[2] - sin(q[4]) * v[3] } end }
local spin = { q = { 0, 0, 0, 0 }, v = { 1, 0, 1, 2 } }
path = run(disk, "gauss(4)", 0.1, 1000, spin, 1)
worst = 0
for i = 1, #path do
  local t = 0.1 * (i - 1)
  local q = dm.vector { sin(2 * t) / 2, (1 - cos(2 * t)) / 2, t, 2 * t }
  worst = max(worst, (path.q[i] - q):norm())
end
ok(worst < 1e-9, "rolling disk: the exact circles for 50 turns", worst)
ok(path:worst "rolling" < 1e-14, "  no slip at any step", path:worst "rolling")
ok(abs(path:drift("energy").per_time) < 1e-15, "  energy to round-off", path:drift("energy").per_time)

-- ---- knife edge on a slope: a cycloid; it does not slide down ----

local knife = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 + q[1] end,
  rolling = function(q, v) return sin(q[3]) * v[1] - cos(q[3]) * v[2] end }
path = run(knife, "gauss(3)", 0.05, 4000, { q = { 0, 0, 0 }, v = { 0, 0, 1 } }, 1)
worst = 0
for i = 1, #path do
  local t = 0.05 * (i - 1)
  worst = max(worst, abs(path.q[i][1] - sin(t) ^ 2 / 2), abs(path.q[i][2] - (t - sin(2 * t) / 2) / 2))
end
ok(worst < 1e-8, "knife edge: the exact cycloid for 200 units of time", worst)

-- ---- Chaplygin sleigh: v = V tanh(c t), heading (k / a) gd(c t), c = a V / k^2, k^2 = a^2 + I / m ----

local a, inertia = 0.5, 0.75
local sleigh = dm.system { Q = dm.R(3),
  L = function(q, v)
    local x, y = v[1] - a * v[3] * sin(q[3]), v[2] + a * v[3] * cos(q[3])
    return (x * x + y * y) / 2 + inertia * v[3] ^ 2 / 2
  end,
  rolling = function(q, v) return cos(q[3]) * v[2] - sin(q[3]) * v[1] end }
for _, case in ipairs { { "midpoint", 2e-4 }, { "gauss(3)", 1e-12 }, { "lobatto(4)", 1e-12 } } do
  local last = run(sleigh, case[1], 0.02, 500, { q = { 0, 0, 0 }, v = { 0, 0, 1 } })
  near(last.q[#last][3], 4 * math.atan((exp(5) - 1) / (exp(5) + 1)), case[2],
    "Chaplygin sleigh turns by the Gudermannian of its time: " .. case[1])
end

-- ---- nonholonomic momentum equation, from positions alone: with xi in D, J_xi1(v1) = J_xi1(v0) to round-off ----

local h = 0.1
local function midpoint_momenta(system, q0, q1) -- -D1 Ld, D2 Ld of Ld = h L((q0 + q1)/2, (q1 - q0)/h), by hand below
  local v, force = (q1 - q0) / h, system((q0 + q1) / 2)
  return v - h / 2 * force, v + h / 2 * force
end
local function momentum_equation(q, force, xi)
  local largest = 0
  for i = 2, #q - 1 do
    local _, before = midpoint_momenta(force, q[i - 1], q[i])
    local after = midpoint_momenta(force, q[i], q[i + 1])
    largest = max(largest, abs((after - before):dot(xi(q[i]))))
  end
  return largest
end
path = run(disk, "midpoint", h, 500, spin, 1)
worst = momentum_equation(path.q, function() return dm.vector { 0, 0, 0, 0 } end,
  function(q) return dm.vector { cos(q[4]), sin(q[4]), 1, 0 } end)
ok(worst < 1e-13 / h, "momentum equation of the disk to round-off of the positions", worst)
local particle = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[2] ^ 2 / 2 end,
  rolling = function(q, v) return v[3] - q[2] * v[1] end }
path = run(particle, "midpoint", h, 500, { q = { 0, 1, 0 }, v = { 0.7, 0.3, 0.7 } }, 1)
worst = momentum_equation(path.q, function(q) return dm.vector { 0, -q[2], 0 } end, function(q) return dm.vector { 1, 0, q[2] } end)
ok(worst < 1e-13 / h, "momentum equation of the nonholonomic particle", worst)
local low, high = 1, -1
for i = 1, #path do low, high = math.min(low, path.p[i][1]), max(high, path.p[i][1]) end
ok(high - low > 0.1, "  while the momentum along x comes and goes", high - low)

-- ---- contact oscillator (McLachlan & Perlmutter 2006, 5.2) and its non-reversible form (Modin & Verdier 2020) ----

local function contact(shift)
  return dm.system { Q = dm.R(3), rolling = function(q, v) return v[1] + q[2] * v[3] end,
    L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 + shift * sin(q[3]) * v[3] end }
end
local rest = { q = { 1, 1, -sqrt(0.5) }, v = { 0, 0, 0 } }
rest.q[1] = sqrt(1.5)
local function slope(shift, rule)
  return run(contact(shift), rule, 2 * sin(pi / 40), 5000, rest, 1):drift("energy").per_time
end
ok(abs(slope(0, "midpoint")) < 1e-7, "contact oscillator: no drift of midpoint", slope(0, "midpoint"))
ok(abs(slope(0, "gauss(2)")) < 1e-10, "  nor of gauss(2)")
ok(abs(slope(1, "midpoint")) > 3e-7, "non-reversible: midpoint drifts", slope(1, "midpoint"))
ok(abs(slope(1, "gauss(2)")) < 1e-7, "  gauss(2) less")
ok(abs(slope(1, "gauss(4)")) < 1e-13, "  gauss(4) below what matters", slope(1, "gauss(4)"))

-- ---- Appell-Hamel: z'^2 = x'^2 + y'^2 under gravity; Chetaev: z'' = -g/2; a vertical reaction: a straight line ----

local function appell(reaction)
  return dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, reaction = reaction,
    rolling = function(_, v) return v[3] ^ 2 - v[1] ^ 2 - v[2] ^ 2 end }
end
local cone = { q = { 0, 0, 0 }, v = { 3, 4, 5 } }
path = run(appell(nil), "gauss(2)", 0.1, 50, cone)
local travel = 5 * 5 - 25 / 4
near((path.q[#path] - dm.vector { 0.6 * travel, 0.8 * travel, travel }):norm(), 0, 1e-12, "Appell-Hamel by Chetaev's rule: z'' = -g/2")
ok(path:worst "rolling" < 1e-13, "  on the cone", path:worst "rolling")
path = run(appell(function() return { { 0, 0, 1 } } end), "gauss(2)", 0.1, 50, cone)
near((path.q[#path] - dm.vector { 15, 20, 25 }):norm(), 0, 1e-12, "with vertical reactions: a straight line")

-- ---- forces: the right decay where rk4's own dissipation is four times as large ----

local c, H, N = 1e-4, 0.5, 4000
local damped = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end, force = function(_, v) return -c * v[1] end }
for _, case in ipairs { { "midpoint", 0.02 }, { "lobatto(3)", 0.01 }, { "gauss(3)", 1e-3 } } do
  path = run(damped, case[1], H, N, { q = { 1 }, v = { 0 } })
  near(path:energy()[#path] * 2, exp(-c * H * N), case[2], case[1] .. ": decay over 2000 units of time at h = 0.5")
end
local x, u = 1, 0
local function f(y, w) return w, -y - c * w end
for _ = 1, N do
  local a1, b1 = f(x, u)
  local a2, b2 = f(x + H / 2 * a1, u + H / 2 * b1)
  local a3, b3 = f(x + H / 2 * a2, u + H / 2 * b2)
  local a4, b4 = f(x + H * a3, u + H * b3)
  x, u = x + H / 6 * (a1 + 2 * a2 + 2 * a3 + a4), u + H / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
end
ok(x * x + u * u < 0.5 * exp(-c * H * N), "  of which rk4 loses more than half by itself", x * x + u * u)

-- a force with a given history on a particle: exact by any rule whose quadrature is
local driven = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end, force = function(_, _, t) return 6 * t end }
path = run(driven, "gauss(2)", 0.25, 8, { q = { 0 }, v = { 0 }, t0 = 1 })
near(path.q[#path][1], 3 ^ 3 - 1 - 3 * 2, 1e-13, "force 6 t from t0 = 1: q = t^3 - 3 t + 2")
near(path.p[#path][1], 3 * (9 - 1), 1e-13, "  and its momentum")

-- a control held over each step: the exact solution between samples, whatever the rule
local gain, damping = 2, 1.5
local sampled = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end,
  control = function(q, v) return { -gain * q[1], -damping * v[1] } end, force = function(_, _, _, held) return held[1] + held[2] end }
local y, w = 1, 0
for _ = 1, 20 do
  local held = -gain * y - damping * w
  y, w = y + w / 4 + held / 32, w + held / 4
end
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)" } do
  path = run(sampled, rule, 0.25, 20, { q = { 1 }, v = { 0 } })
  near(path.q[#path][1], y, 1e-15, "sampled control by " .. rule)
end
near(sampled:control({ 1 }, { 2 })[2], -3, 0, "system:control")
near(sampled:force({ 1 }, { 2 })[1], -5, 0, "system:force as at the start of a step")
local A = sampled:solver({ rule = "midpoint", h = 0.25 }):tangent { q = { 1 }, v = { 0 }, steps = 1 }
for i, exact in ipairs { { 1 - gain / 32, 0.25 - damping / 32 }, { -gain / 4, 1 - damping / 4 } } do
  near(A[i][1], exact[1], 1e-15, "tangent map of a sampled control, by q")
  near(A[i][2], exact[2], 1e-15, "  by p")
end
raises("it knows no controls", run, sampled, "rattle", 0.1, 1, { q = { 1 }, v = { 0 } })
raises("there is no 'force'", dm.system, { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end, control = function() return 1 end })

-- the same power by a Lagrangian that depends on time, with and without a force that takes the general step
local function pushed(force) return dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 + cos(q[1]) + q[1] * sin(3 * t) end, force = force } end
for _, rule in ipairs { "midpoint", "gauss(3)", "lobatto(3)", "galerkin(2, lobatto(3))" } do
  local one = run(pushed(nil), rule, 0.1, 100, { q = { 0.3 }, v = { 0.2 } })
  local two = run(pushed(function() return 0 end), rule, 0.1, 100, { q = { 0.3 }, v = { 0.2 } })
  near(one.q[#one][1], two.q[#two][1], 1e-12, "L(q, v, t) by " .. rule .. ": the general step is the same step")
end

-- ---- the same bits on tape and in machine code ----

for _, case in ipairs { { heavy, swing }, { rolls, { q = { 1, 0.5, 0 }, v = { 0.4, 1, 0.2 } } }, { appell(nil), cone } } do
  local system, start = table.unpack(case)
  for _, rule in ipairs { "midpoint", "gauss(3)", "lobatto(3)" } do
    local ends = {}
    for i, backend in ipairs { "tape", "jit" } do
      local one = system:solver { rule = rule, h = 0.02, backend = backend }:run { q = start.q, v = start.v, steps = 100, every = 100 }
      ends[i] = ("%a %a %a %a"):format(one.q[2][1], one.q[2][2], one.p[2][1], one.p[2][2])
    end
    ok(ends[1] == ends[2], rule .. ": tape and machine code agree to the bit", ends[1] .. " / " .. ends[2])
  end
end

-- ---- as many stages as there can be ----

for _, rule in ipairs { "gauss(32)", "lobatto(32)" } do
  path = run(sphere, rule, 0.5, 4, swing)
  near((path.q[2] - run(sphere, "gauss(8)", 0.1, 20, swing).q[2]):norm(), 0, 1e-13, rule .. " on the sphere")
end

-- ---- failures ----

local closing = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end,
  constraint = function(q, t) return { q:dot(q) - 1, q[3] - 0.9 - t / 10 } end }
local fine, failure = pcall(run, closing, "gauss(2)", 0.01, 200, { q = { sqrt(0.19), 0, 0.9 }, v = { -0.09 / sqrt(0.19), 0, 0.1 } })
ok(not fine and failure.code == "singular" and failure.constraint == 2, "constraints that meet tangentially: the second is named", failure)
near(failure.path.t[#failure.path.t], 0.99, 1e-12, "  with the path up to the row before they meet, at t = 1")
raises("constraint 2 depends", run, closing, "midpoint", 0.01, 200, { q = { sqrt(0.19), 0, 0.9 }, v = { -0.09 / sqrt(0.19), 0, 0.1 } })
local across = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, rolling = function(_, v) return v[1] end,
  reaction = function() return { { 0, 1 } } end }
raises("rolling constraint 1 depends", run, across, "midpoint", 0.1, 1, { q = { 0, 0 }, v = { 0, 1 } })
raises("did not converge", run, sphere, "midpoint", 3, 10, swing)
raises("without constraints", run, sphere, "gauss(2, 3)", 0.1, 10, swing)
path = run(sphere, "gauss(2)", 1, 50, swing, 1)
ok(path:worst "constraint" < 1e-14, "steps of an eighth of a turn converge, by way of shorter ones", path:worst "constraint")

-- every backend lays the matrices of a step out alike, and so rounds alike
local function ends(system, start, rule, backend)
  local solver = system:solver { rule = rule, h = 0.02, backend = backend }
  local path = solver:run { q = start.q, v = start.v, steps = 60, every = 60 }
  return ("%a %a %a"):format(table.unpack(path.q[2]))
end
local function free(q, v) return v:dot(v) / 2 - sin(q[3]) - 0.3 * q[1] * q[2] end
local skate = dm.system { Q = dm.R(3), L = free,
  rolling = function(q, v) return cos(q[3]) * v[2] - sin(q[3]) * v[1] end }
local shell = dm.system { Q = dm.R(3), L = free, constraint = function(q) return q:dot(q) - 1 end }
for _, rule in ipairs { "gauss(2)", "gauss(3)", "lobatto(3)" } do
  for name, case in pairs { skate = { skate, { q = { 0, 0, 0 }, v = { 1, 0, 0.7 } } },
    shell = { shell, { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 } } } } do
    local tape = ends(case[1], case[2], rule, "tape")
    ok(ends(case[1], case[2], rule, "cc") == tape and ends(case[1], case[2], rule) == tape,
      rule .. ": all backends have the same bits, " .. name)
  end
end
tap.done()
