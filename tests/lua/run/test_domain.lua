-- Newton's method inside the domain of L: speeds near the limit, starts and steps that an increment would take out of it
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, random, cos, sin, abs, max = math.sqrt, math.random, math.cos, math.sin, math.abs, math.max

-- one dimension, where Verlet is p + h/2 f, q + h v(p): from v = -0.9 by a force of 100
local fast = dm.system { Q = dm.R(1), L = function(q, v) return -(1 - v[1] ^ 2) ^ 0.5 + 100 * q[1] end }
local function explicit(h, steps, v)
  local q, p = 0, v / sqrt(1 - v ^ 2)
  for _ = 1, steps do
    p = p + h / 2 * 100
    q = q + h * p / sqrt(1 + p ^ 2)
    p = p + h / 2 * 100
  end
  return q, p
end
for _, rule in ipairs { "verlet", "trapezoidal", "lobatto(2)", "gauss(2)", "midpoint" } do
  local path = fast:solver { rule = rule, h = 0.5 }:run { q = { 0 }, v = { -0.9 }, steps = 3 }
  local q, p = explicit(0.5, 3, -0.9)
  near(path.p[4][1], p, 1e-9 * p, rule .. " finds the momentum beyond the turn")
  if rule == "verlet" or rule == "lobatto(2)" then near(path.q[4][1], q, 1e-12, rule .. " and the explicit positions") end
end
near(fast:velocity({ 0 }, { 1e5 })[1], 1e5 / sqrt(1 + 1e10), 1e-15, "the velocity of a momentum of 10^5")
near(fast:velocity({ 0 }, { -30 })[1], -30 / sqrt(901), 1e-15, "and of -30")

-- a relativistic planet, L = -sqrt(1 - v^2) + 1/r: 200 bound starts that do not fall into the centre; Verlet is explicit in (q, p)
local planet = dm.system { Q = dm.R(2), L = function(q, v) return -(1 - v:dot(v)) ^ 0.5 + 1 / q:norm() end }
math.randomseed(5)
local starts = {}
while #starts < 200 do
  local r, a, s, b = 0.3 + 4 * random(), 2 * math.pi * random(), 0.995 * random(), 2 * math.pi * random()
  local g = 1 / sqrt(1 - s ^ 2)
  if g - 1 < 1 / r and g * r * s * abs(sin(b - a)) > 1.05 then
    starts[#starts + 1] = { q = { r * cos(a), r * sin(a) }, v = { s * cos(b), s * sin(b) } }
  end
end
local function planet_explicit(start, h, steps)
  local x, y, g = start.q[1], start.q[2], 1 / sqrt(1 - start.v[1] ^ 2 - start.v[2] ^ 2)
  local a, b = g * start.v[1], g * start.v[2]
  local function kick()
    local r3 = (x * x + y * y) ^ 1.5
    a, b = a - h / 2 * x / r3, b - h / 2 * y / r3
  end
  for _ = 1, steps do
    kick()
    local e = sqrt(1 + a * a + b * b)
    x, y = x + h * a / e, y + h * b / e
    kick()
  end
  return x, y
end
for _, h in ipairs { 0.02, 0.3 } do
  local solver, failed, worst = planet:solver { rule = "verlet", h = h }, 0, 0
  for _, start in ipairs(starts) do
    local fine, path = pcall(solver.run, solver, { q = start.q, v = start.v, steps = 20 })
    if fine then
      local x, y = planet_explicit(start, h, 20)
      worst = max(worst, abs(path.q[21][1] - x), abs(path.q[21][2] - y))
    else
      failed = failed + 1
    end
  end
  ok(failed == 0, "Verlet from 200 bound starts, h = " .. h, failed .. " fail")
  ok(worst < 1e-9, "and steps as its explicit form does, h = " .. h, worst)
end
for _, rule in ipairs { "midpoint", "gauss(2)", "gauss(3)", "lobatto(3)", "trapezoidal", "yoshida(4, midpoint)", "galerkin(2, lobatto(3))" } do
  local solver, failed = planet:solver { rule = rule, h = 0.02 }, 0
  for _, start in ipairs(starts) do
    if not pcall(solver.run, solver, { q = start.q, v = start.v, steps = 100 }) then failed = failed + 1 end
  end
  ok(failed == 0, rule .. " from 200 bound starts", failed .. " fail")
end
-- a step that shortens its way to the root has the bits of its kind in lanes too
for _, rule in ipairs { "verlet", "midpoint", "gauss(3)" } do
  local solver, same = planet:solver { rule = rule, h = 0.1 }, 0
  local all = solver:ensemble { members = 40, steps = 30, q = function(i) return starts[i].q end, v = function(i) return starts[i].v end }
  local whole = 0
  for i = 1, 40 do
    local fine, path = pcall(solver.run, solver, { q = starts[i].q, v = starts[i].v, steps = 30 })
    if fine then whole = whole + 1 end
    if fine and dm.vector(all.q[i]) == path.q[31] then same = same + 1 end
  end
  ok(whole > 30 and same == whole, rule .. ": members have the bits of runs of their own", same .. " of " .. whole)
end

-- the midpoint rule has a solution wherever the centre is further than h/2 (a continuous map of the ball of velocities into itself); nearer there
-- may be none, and the message says what stopped it
local coarse, named, unnamed, far = planet:solver { rule = "midpoint", h = 0.3 }, 0, 0, 0
for _, start in ipairs(starts) do
  local fine, why = pcall(coarse.run, coarse, { q = start.q, v = start.v, steps = 200 })
  if not fine then
    if why.message:find "domain" then named = named + 1 else unnamed = unnamed + 1 end
    if why.path.q[#why.path]:norm() > 0.151 then far = far + 1 end
  end
end
ok(named > 0 and unnamed == 0, "steps that fail name the domain", named .. " named, " .. unnamed .. " not")
ok(far == 0, "none fails where a solution exists", far)

-- a potential with an edge: the guess of a step is outside, its solution is inside
local wall = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ -0.5 end }
for _, rule in ipairs { "lobatto(3)", "lobatto(4)", "lobatto(5)" } do
  local path = wall:solver { rule = rule, h = 0.2 }:run { q = { 0.3 }, v = { -2 }, steps = 20 }
  local least = math.huge
  for i = 1, #path do least = math.min(least, path.q[i][1]) end
  ok(least > 0, rule .. " turns before the wall", least)
end
-- with a constraint: a fast bead on a circle
local bead = dm.system { Q = dm.R(2), constraint = function(q) return q:dot(q) - 1 end, L = function(q, v) return -(1 - v:dot(v)) ^ 0.5 - 20 * q[2] end }
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)" } do
  local path = bead:solver { rule = rule, h = 0.05 }:run { q = { 1, 0 }, v = { 0, -0.95 }, steps = 50 }
  ok(path:worst "constraint" < 1e-13, rule .. " keeps a fast bead on its circle")
end
raises("domain", fast.velocity, dm.system { Q = dm.R(1), L = function(_, v) return (v[1] - 3) ^ 0.5 * v[1] end }, { 0 }, { -5 })

-- L = -log(1 - v^2)/2 - 3 q^2: 1/(1 - v^2) is a number beyond v = 1 too, where L is none. Midpoint has one root inside, by bisection in its
-- momentum; verlet is explicit, v = 2 p / (1 + sqrt(1 + 4 p^2)). By traces and by hyper-dual numbers
local function bent(_, v) return -dm.log(1 - v[1] ^ 2) / 2 end
local function velocity(p) return 2 * p / (1 + sqrt(1 + 4 * p * p)) end
for _, derivatives in ipairs { "exact", "hyperdual" } do
  local slow = dm.system { Q = dm.R(1), derivatives = derivatives, L = function(q, v) return bent(q, v) - 3 * q[1] ^ 2 end }
  local h, worst = 0.3, { midpoint = 0, verlet = 0 }
  local solvers = { midpoint = slow:solver { rule = "midpoint", h = h }, verlet = slow:solver { rule = "verlet", h = h } }
  for _ = 1, 60 do
    local q, p = 4 * random() - 2, 8 * random() - 4
    local low, high = -20, 20
    for _ = 1, 70 do
      local m = (low + high) / 2
      if m - p + 3 * h * (q + h / 2 * velocity(m)) > 0 then high = m else low = m end
    end
    local half = p - 3 * h * q
    local ends = { midpoint = q + h * velocity(low), verlet = q + h * velocity(half) }
    for rule, solver in pairs(solvers) do
      worst[rule] = max(worst[rule], abs(solver:run({ q = { q }, p = { p }, steps = 1 }).q[2][1] - ends[rule]))
    end
  end
  ok(worst.midpoint < 1e-13 and worst.verlet < 1e-13, "speeds stay where log(1 - v^2) is a number, " .. derivatives, worst.midpoint)
end
-- behind the wall of -log(q) the force 1/q has numbers too: no step goes on there
local barrier = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + dm.log(q[1]) - q[1] end }
for _, rule in ipairs { "verlet", "midpoint", "gauss(2)", "lobatto(3)", "trapezoidal", "yoshida(4)", "symplectic-euler", "rk4", "curve(rk4)" } do
  raises("domain", function() barrier:solver({ rule = rule, h = 0.3 }):run { q = { 0.117 }, p = { -4.35 }, steps = 20 } end)
  local path = barrier:solver({ rule = rule, h = 0.02 }):run { q = { 0.5 }, p = { -1 }, steps = 500 }
  ok(path:drift "energy".largest < 0.03, rule .. " turns before the wall of -log(q)", path:drift "energy".largest)
end
-- a log of what is never negative is as it was, and one in a branch that is not taken does no harm
near(dm.derivative(function(x) return dm.log(dm.abs(x[1])) end, 1)({ -2 })[1], -0.5, 0, "log |x| at -2")
near(dm.derivative(function(x) return dm.where(x[1], dm.log(x[1]), x[1] ^ 2) end, 1)({ -2 })[1], -4, 0, "a branch beside log")
raises("domain", dm.derivative(function(x) return dm.log(x[1]) end, 1), { -2 })

-- V = -sqrt(q) from q = 0, v = 1: the force is infinite at the start, where Gauss rules have no stage, though lanes may stand idle
-- there. With u = v = sqrt(1 + 2 sqrt(q)) the time is u^3 / 3 - u + 2 / 3
local root = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + dm.sqrt(q[1]) end }
for s = 1, 8 do
  local path = root:solver { rule = ("gauss(%d)"):format(s), h = 0.01 }:run { q = { 0 }, v = { 1 }, steps = 5 }
  local u = sqrt(1 + 2 * sqrt(path.q[6][1]))
  near(u ^ 3 / 3 - u + 2 / 3, 0.05, 1.5e-3, "gauss(" .. s .. ") from a pole")
end

-- curve(rk4), whose inner method leaves the domain from the guess: the root that is the one of a small step, found by halving
-- p0(v) = p of the segment written out here, between velocities that the root of ever longer steps came by
local function segment(L, a, h)
  return function(y)
    local q, v1 = y[1], y[2]
    local a1 = a(q, v1)
    local v2 = v1 + h / 2 * a1
    local q2, a2 = q + h / 2 * v1, a(q + h / 2 * v1, v2)
    local v3 = v1 + h / 2 * a2
    local q3, a3 = q + h / 2 * v2, a(q + h / 2 * v2, v3)
    local v4, q4 = v1 + h * a3, q + h * v3
    return { h / 6 * (L(q, v1) + 2 * L(q2, v2) + 2 * L(q3, v3) + L(q4, v4)), q + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4) }
  end
end
local function falls(q, v) return -(1 - v ^ 2) ^ 0.5 + 3 * q end
local function swings(q, v) return -(1 - v ^ 2) ^ 0.5 - 10 * q ^ 2 end
local function turns(q, v) return -(1 - v ^ 2) ^ 0.5 - 40 * q ^ 2 end
for _, case in ipairs {
  { turns, function(q, v) return -80 * q * (1 - v ^ 2) ^ 1.5 end, -0.95562470452457, 0.4095044802297, 0.2088918629644, -0.808715, -0.808714, 1e-8 }, -- beside the edge of the domain
  { falls, function(_, v) return 3 * (1 - v ^ 2) ^ 1.5 end, 0.602, 0.31984, 0.3992, -0.1, -0.08 },
  { falls, function(_, v) return 3 * (1 - v ^ 2) ^ 1.5 end, -0.3771, 0.69949, 0.3906, 0.83, 0.845 },
  { swings, function(q, v) return -20 * q * (1 - v ^ 2) ^ 1.5 end, 0.5599, -0.12988, 0.2868, 0.5, 0.51 } } do
  local L, a, q, v, h, low, high, edge = table.unpack(case)
  local of = segment(L, a, h)
  local D = dm.derivative(of, 2)
  local function momenta(u)
    local d = D { q, u }
    local p1 = d[1][2] / d[2][2]
    return p1 * d[2][1] - d[1][1], p1
  end
  local p = v / sqrt(1 - v ^ 2)
  local rising = momenta(high) > p
  for _ = 1, 60 do
    local u = (low + high) / 2
    if (momenta(u) > p) == rising then high = u else low = u end
  end
  local system = dm.system { Q = dm.R(1), L = function(x, u) return L(x[1], u[1]) end }
  local x, y = system:solver { rule = "curve(rk4)", h = h }:step { q = { q }, v = { v } }
  near(x[1], of({ q, low })[2], 1e-13, "curve(rk4) from outside of its domain")
  near(y[1], select(2, momenta(low)), edge or 1e-11, "and its momentum")
end
-- relativistic Kepler, c = 3, beside the centre: steps of more than two radii have no root. Where the root of midpoint's step ends, as it is
-- followed from h = 0 by a program of its own in (q, p), and 3000 starts found no other beyond
local light = dm.system { Q = dm.R(2), L = function(q, v) return -9 * (1 - v:dot(v) / 9) ^ 0.5 + 1 / q:norm() end }
for _, row in ipairs { { -0.0073732585248317923, 0.00080781530908186896, 135.21376965075984, 35.48654955302775, 0.989 * 0.005 },
  { -0.014887208185778246, 0.018460259102390554, 16.386739348768135, 9.8812811310382571, 0.790 * 0.02 },
  { -0.010700544234144301, 0.014191805560775657, 19.101399045760164, 10.68573464088151, 0.592 * 0.02 },
  { -0.0083709584068284645, 0.020599684163287727, 17.354818681033493, 2.2144101256565047, 0.741 * 0.02 } } do
  local function step(share)
    return pcall(function()
      return light:solver { rule = "midpoint", h = share * row[5] }:run { q = { row[1], row[2] }, p = { row[3], row[4] }, steps = 1 }
    end)
  end
  local _, failure = step(1.02)
  ok(step(0.95) and failure.code == "no_convergence", "beside the centre steps are found up to where there are any, h = " .. row[5], failure)
end
-- Steps beside the centre whose roots exist: followed from h = 0 by a program of its own in (q, p),
-- which gave their ends
for _, row in ipairs {
  { "gauss(2)", 0.005, { -0.0053317649102186532, 0.0061565649504871905 }, { -26.260655574741584, -33.791882320595747 },
    { 3.58190345960321e-05, -0.00291046684056015 }, { 117.233661478273, 17.8988566477462 } },
  { "gauss(2)", 0.005, { -0.0020550462587028626, -0.0059885987065517341 }, { -48.709562391994147, 28.355506653941333 },
    { 0.00165774712834936, 0.000624560395016611 }, { 363.937559536446, -73.9997748491871 } },
  { "gauss(2)", 0.01, { 0.0053183295226311815, -0.014196562521112021 }, { -23.711183320373916, -6.4422410323107755 },
    { -0.00924912453779628, 0.00377479620877564 }, { 19.5705401460278, 32.1116290704773 } },
  { "gauss(2)", 0.01, { -0.011189041496403195, -0.0023380281183591999 }, { 16.198422679716032, -27.476838226046105 },
    { -0.000790239840711507, 0.00492027913760423 }, { -137.726365319939, 420.556259075844 } },
  { "gauss(3)", 0.005, { 0.0056091901219662357, 0.0011042203842331769 }, { -15.295591786708215, 57.932801846580716 },
    { -0.00439617865042364, 0.000102710613312246 }, { 5.17716232819951, -77.8807188785228 } },
  { "gauss(3)", 0.005, { -0.00083780405318246466, 0.006610817258978244 }, { -50.314957767595047, -15.248977424835559 },
    { -0.00129239957110217, -0.00427591811100412 }, { 76.486554584344, -14.1971590698105 } },
  { "gauss(3)", 0.01, { -0.0052039979934322481, 0.0064292763166551633 }, { -27.346758857728645, -31.903535559337371 },
    { 6.98428936050028e-05, 0.00223223077248589 }, { -144.264542497406, 283.694617038786 } },
  { "gauss(3)", 0.01, { 0.0097058582974845556, -0.00023414171240246882 }, { -7.9088948398153178, -35.867214145236389 },
    { 5.4333446038138e-05, 0.002093749669479 }, { 169.222522656636, 79.7980065075877 } },
  { "midpoint", 0.0007, { -0.0019527331114460192, 0.0017504574466252754 }, { -61.661204297923042, -119.78620554606442 },
    { -0.00159222267171711, -0.000317982343389113 }, { 115.923633323574, -191.546158043425 } },
  { "midpoint", 0.0007, { 0.0020498803859406991, 0.00020604339397579854 }, { -68.611176682429104, 161.60053476869362 },
    { -2.21978147628052e-05, 0.000546887842054972 }, { -629.674250789592, -46.736766090647 } },
  { "midpoint", 0.0014, { -0.0032506853201407825, -0.002515724164808089 }, { 73.136391952077247, -48.560472635323414 },
    { 0.000610175422246771, -0.000863775019718477 }, { 260.586669640596, 191.350788857344 } },
  { "midpoint", 0.0014, { -0.0035877012867408277, -0.0022504230966795945 }, { -22.818882945227159, 83.234844574006587 },
    { -0.000865126486015768, 0.000946634163863884 }, { 226.831533361498, 156.332540344989 } },
} do
  local rule, h, q, p, x, y = table.unpack(row)
  local there = light:solver({ rule = rule, h = h }):run { q = q, p = p, steps = 1 }
  local name = ("%s, h = %g, from %g: "):format(rule, h, q[1])
  local size, large = math.abs(x[1]) + math.abs(x[2]), math.abs(y[1]) + math.abs(y[2])
  near((there.q[2] - dm.vector(x)):norm() / size, 0, 1e-10, name .. "q is that of the root")
  near((there.p[2] - dm.vector(y)):norm() / large, 0, 1e-10, name .. "p is that of the root")
end
tap.done()
