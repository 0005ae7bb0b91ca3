-- systems that are given by H(q, p, t): those of a Lagrangian by every rule, and those that have none
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, sin, cos, exp, log, abs, max, pi = math.sqrt, math.sin, math.cos, math.exp, math.log, math.abs, math.max, math.pi

local function last(system, rule, h, steps, s, more)
  local options = { q = s.q, v = s.v, p = s.p, steps = steps, every = steps }
  for k, x in pairs(more or {}) do options[k] = x end
  local path = system:solver { rule = rule, h = h }:run(options)
  return path.q[#path], path.p[#path], path
end
local function apart(a, b) return (dm.vector(a) - dm.vector(b)):norm() end
-- order from the errors of two runs, against gauss(8)
local function order(system, rule, s, T, n, reference)
  local e = {}
  for k = 1, 2 do
    local q, p = last(system, rule, T / (n * k), n * k, s)
    e[k] = apart(q, reference[1]) + apart(p, reference[2])
  end
  return log(e[1] / e[2]) / log(2)
end

---- H of a Lagrangian ----

-- L = v.M(q) v/2 + a(q).v - V(q, t), H = (p - a).M^-1 (p - a)/2 + V written by hand
local function M(q) return 2 + sin(q[1]), 0.4 * cos(q[2]), 1.5 + 0.3 * q[1] ^ 2 end
local function V(q, t) return q[1] ^ 2 / 2 + q[2] ^ 4 / 4 + 0.2 * sin(q[1] + 0.7 * (t or 0)) end
local forms = {
  { L = function(q, v, t)
    local a, b, c = M(q)
    return (a * v[1] ^ 2 + 2 * b * v[1] * v[2] + c * v[2] ^ 2) / 2 + q[2] * v[1] - V(q, t)
  end, H = function(q, p, t)
    local a, b, c = M(q)
    local x, y = p[1] - q[2], p[2]
    return (c * x ^ 2 - 2 * b * x * y + a * y ^ 2) / (2 * (a * c - b ^ 2)) + V(q, t)
  end },
  { L = function(q, v, t) return v[1] ^ 2 + v[2] ^ 2 / 4 - V(q, t) end,
    H = function(q, p, t) return p[1] ^ 2 / 4 + p[2] ^ 2 + V(q, t) end },
  { L = function(q, v) return (v[1] ^ 2 + v[1] * v[2] + v[2] ^ 2) / 2 + v[1] / 3 - V(q) end,
    H = function(q, p)
      local x, y = p[1] - 1 / 3, p[2]
      return 2 / 3 * (x ^ 2 - x * y + y ^ 2) + V(q)
    end },
}
local s = { q = { 0.4, 0.3 }, p = { 0.5, -0.7 } }
for _, row in ipairs(dm.rules()) do
  for _, instance in ipairs(row.instances) do
    local rule, worst, compared = instance.rule, 0, 0
    for _, f in ipairs(forms) do
      local A, B = dm.system { Q = dm.R(2), L = f.L }, dm.system { Q = dm.R(2), H = f.H }
      local fine, q, p = pcall(last, A, rule, 0.05, 20, s)
      local same, Q, P = pcall(last, B, rule, 0.05, 20, s)
      if fine ~= same then worst = math.huge end
      if fine and same then compared, worst = compared + 1, max(worst, apart(q, Q), apart(p, P)) end
    end
    if compared > 0 or worst > 0 then
      ok(worst < 3e-13, ("%s: H and L agree on %d systems (%.1e)"):format(rule, compared, worst))
    end
  end
end
local twin = dm.system { Q = dm.R(2), H = forms[2].H }
ok(tostring(twin):find "separable, constant mass", "the structure of the Lagrangian is read off: " .. tostring(twin))
ok(twin.H == forms[2].H and twin:structure().diagonal_mass and not twin:structure().hamiltonian, "H stays a field, L is stepped")
near(twin:energy({ 0.4, 0.3 }, { 1, 2 }), 1 + 1 + V { 0.4, 0.3 }, 1e-15, "its energy")
local forced = dm.system { Q = dm.R(1), H = function(_, p) return p[1] ^ 2 / 4 end, force = function(_, v) return { -v[1] } end }
near(last(forced, "gauss(4)", 0.1, 10, { q = { 0 }, v = { 1 } })[1], 2 * (1 - exp(-0.5)), 1e-12, "a force, of the velocity")
local ring = dm.system { Q = dm.R(2), H = function(_, p) return p:dot(p) / 2 end, constraint = function(q) return q:dot(q) - 1 end }
near(last(ring, "gauss(3)", 0.1, 10, { q = { 1, 0 }, v = { 0, 1 } })[1], cos(1), 1e-9, "a constraint")
local k = { 2 }
local sprung = dm.system { Q = dm.R(1), params = { k = 4 }, H = function(q, p, _, c) return p[1] ^ 2 / 2 + c.k * q[1] ^ 2 / 2 * k[1] / 2 end }
near(last(sprung, "gauss(6)", 0.1, 10, { q = { 1 }, p = { 0 } })[1], cos(2), 1e-13, "params")
k[1] = 0.5
near(last(sprung, "gauss(6)", 0.1, 10, { q = { 1 }, p = { 0 } })[1], cos(1), 1e-13, "an upvalue that changes is seen")
local many = dm.system { Q = dm.R(60), H = function(q, p)
  local sum = 0
  for i = 1, 60 do sum = sum + p[i] ^ 2 / (2 * i) + q[i] ^ 2 * i / 2 end
  return sum
end }
ok(many:structure().diagonal_mass, "many coordinates, a mass that is a list of numbers")
local ones = {}
for i = 1, 60 do ones[i] = 1 end
near(last(many, "gauss(6)", 0.1, 10, { q = ones, v = dm.zeros(60) })[60], cos(1), 1e-12, "and steps of it")

---- H without one ----

local saddle = dm.system { Q = dm.R(1), H = function(q, p) return q[1] * p[1] end }
near(last(saddle, "gauss(4)", 0.1, 10, { q = { 1 }, p = { 1 } })[1], exp(1), 1e-14, "H = q p")
near(saddle:velocity({ 2 }, { 3 })[1], 2, 0, "its velocity is dH/dp")
near(saddle:energy({ 2 }, { 3 }), 6, 0, "its energy is H(q, p)")

-- four vortices in the plane (Kirchhoff): q = x, p = strength * y; and a relativistic particle in a potential that moves
local G = { 1, -0.6, 0.8, 0.5 }
local vortices = dm.system { Q = dm.R(4), H = function(q, p)
  local sum = 0
  for i = 1, 4 do
    for j = 1, i - 1 do
      sum = sum - G[i] * G[j] / (4 * pi) * dm.log((q[i] - q[j]) ^ 2 + (p[i] / G[i] - p[j] / G[j]) ^ 2)
    end
  end
  return sum
end }
local at = { q = { 1, -0.8, 0.2, -0.4 }, p = { 0.3, 0.36, -0.72, 0.45 } }
local fast = dm.system { Q = dm.R(2), H = function(q, p, t)
  return dm.sqrt(1 + p:dot(p)) + q:dot(q) / 2 + q[1] ^ 3 / 9 + 0.1 * q[2] * dm.sin(0.8 * t)
end }
local flying = { q = { 0.5, -0.4 }, p = { 0.8, 0.9 } }
local mixed = dm.system { Q = dm.R(2), H = function(q, p)
  return dm.cosh(p[1] + 0.3 * q[2]) + q[1] ^ 2 * p[2] ^ 2 / 5 + p[2] ^ 2 * p[1] / 7 + q:dot(q) / 2 + q[2] * p[2] / 3
end }
local near0 = { q = { 0.3, 0.4 }, p = { -0.2, 0.3 } }
local cases = { { "vortices", vortices, at, 4, 1 }, { "relativistic", fast, flying, 2, 1 }, { "neither", mixed, near0, 2, 1 } }
local function references(system, start, T) return { last(system, "gauss(8)", T / 80, 80, start) } end
for _, c in ipairs(cases) do
  local name, system, start, T = table.unpack(c)
  ok(system:structure().hamiltonian and not system.L, name .. ": no Lagrangian")
  local reference = references(system, start, T)
  for _, r in ipairs { { "symplectic-euler", 1, 320 }, { "midpoint", 2, 80 }, { "verlet", 2, 160 }, { "gauss(2)", 4, 24 },
    { "gauss(3)", 6, 12 }, { "lobatto(3)", 4, 32 }, { "lobatto(4)", 6, 16 }, { "galerkin(2, radau(2))", 3, 40 }, { "yoshida(4)", 4, 80 },
    { "suzuki(4)", 4, 40 }, { "kahan-li(6)", 6, 32 }, { "mclachlan(4, midpoint)", 4, 40 }, { "rk4", 4, 40 }, { "rkf45", 5, 24 } } do
    local found = order(system, r[1], start, T, r[3], reference)
    ok(abs(found - r[2]) < 0.25, ("%s, %s: order %d (%.2f)"):format(name, r[1], r[2], found))
  end
  for _, rule in ipairs { "gauss(4)", "gauss(9)", "lobatto(3)", "midpoint", "verlet", "symplectic-euler(b)", "kahan-li(6)" } do
    local defect = system:solver { rule = rule, h = 0.1 }:symplecticity { q = start.q, p = start.p, steps = 10 }
    ok(defect < 2e-14, ("%s, %s: symplectic (%.1e)"):format(name, rule, defect))
  end
  for _, rule in ipairs { "gauss(4)", "verlet", "lobatto(3)" } do
    ok(system:solver { rule = rule, h = 0.1 }:reversal { q = start.q, p = start.p, steps = 20 } < 2e-13, name .. ", " .. rule .. ": symmetric")
  end
  for _, rule in ipairs { "gauss(2)", "gauss(8)", "gauss(10)", "verlet", "lobatto(4)", "rk8", "midpoint" } do
    local a = { last(system, rule, 0.1, 30, start) }
    local b = { system:solver { rule = rule, h = 0.1, backend = "tape" }:run { q = start.q, p = start.p, steps = 30, every = 30 } }
    ok(apart(a[1], b[1].q[2]) == 0 and apart(a[2], b[1].p[2]) == 0, name .. ", " .. rule .. ": the tape has the same bits")
  end
end
local _, _, long = last(vortices, "gauss(4)", 0.2, 20000, at, { every = 20 })
local x, y, I, first = 0, 0, 0, nil
for i = 1, #long do
  local q, p = long.q[i], long.p[i]
  local X, Y, J = 0, 0, 0
  for a = 1, 4 do X, Y, J = X + G[a] * q[a], Y + p[a], J + G[a] * q[a] ^ 2 + p[a] ^ 2 / G[a] end
  first = first or { X, Y, J }
  x, y, I = max(x, abs(X - first[1])), max(y, abs(Y - first[2])), max(I, abs(J - first[3]))
end
ok(x < 3e-14 and y < 3e-14 and I < 1e-12, ("vortices: impulse and angular impulse over 20000 steps (%.1e, %.1e, %.1e)"):format(x, y, I))
ok(long:drift "energy".largest < 1e-6, "and the energy in a band", long:drift "energy".largest)
local drifts = vortices:solver { rule = "gauss(8)", h = 0.2 }:run { q = at.q, p = at.p, steps = 20000, every = 100 }:drift "energy"
ok(drifts.largest < 1e-13, ("gauss(8) keeps it to round-off (%.1e)"):format(drifts.largest))
local P = long:momentum(dm.R(1))
ok(abs(P[#P] - P[1]) < 1e-13, "the momentum of translations, sum p")

-- two vortices turn about their centre at (G1 + G2)/(2 pi d^2)
local pair = dm.system { Q = dm.R(2), H = function(q, p)
  return -2 / (4 * pi) * dm.log((q[1] - q[2]) ^ 2 + (p[1] - p[2] / 2) ^ 2)
end }
local q = last(pair, "gauss(5)", 0.25, 40, { q = { 0, 1 }, p = { 0, 0 } })
local w = 3 / (2 * pi) * 10
near(q[1], 2 / 3 * (1 - cos(w)), 1e-10, "two vortices of strengths 1 and 2")

---- what takes a system ----

local solver = vortices:solver { rule = "gauss(3)", h = 0.1 }
local path = solver:run { q = at.q, p = at.p, steps = 100, record = { "energy", speed = function(_, v) return v[1] end },
  events = { crossing = function(z) return z[1] - z[2] - 1.5 end } }
near(path:column "energy"[50], vortices:energy(path.q[50], path.p[50]), 0, "a recorded energy")
near(path:column "speed"[50], path:velocity(50)[1], 0, "functions of a state see v = dH/dp")
ok(#path.events > 0 and abs(path.events[1].q[1] - path.events[1].q[2] - 1.5) < 1e-12, "an event")
local file = os.tmpname()
solver:run { q = at.q, p = at.p, steps = 60 }:checkpoint(file)
ok(apart(dm.resume(file, vortices):run { steps = 40 }.q[41], path.q[101]) == 0, "a run goes on bit for bit")
os.remove(file)
local cloud = solver:ensemble { members = 11, q = function(i) return { 1 + i / 100, -0.8, 0.2, -0.4 } end, p = function() return at.p end, steps = 100 }
local alone = last(vortices, "gauss(3)", 0.1, 100, { q = { 1.05, -0.8, 0.2, -0.4 }, p = at.p })
ok(apart(cloud.q[5], alone) == 0, "a member has the bits of a run")
local grid = vortices:solver { rule = "gauss(3)", h = 0.25 }:run { q = at.q, p = at.p, at = { 0.1, 3.3 } }
ok(apart(grid.q[2], last(vortices, "gauss(8)", 0.1, 33, at)) < 1e-6, "rows at times")
local lyapunov = solver:lyapunov { q = at.q, p = at.p, steps = 200 }
ok(abs(lyapunov.exponent) < 1, "a Lyapunov exponent", lyapunov.exponent)
local lines = saddle:linearize { q = { 0 }, p = { 0 } }
near(max(lines.rates[1], lines.rates[2]), 1, 1e-14, "linearised: exp(t)")
local moving = last(fast, "gauss(4)", 0.1, 1, { q = flying.q, v = { 0.5, 0.6 } })
local at_v = 1 / sqrt(1 - 0.25 - 0.36)
ok(apart(moving, last(fast, "gauss(4)", 0.1, 1, { q = flying.q, p = { 0.5 * at_v, 0.6 * at_v } })) < 1e-15, "a start by its velocity")
local varied = dm.system { Q = dm.R(1), params = { a = 2 }, H = function(z, p, _, c) return c.a * z[1] * p[1] end }
local fan = varied:solver { rule = "gauss(4)", h = 0.1 }:ensemble { members = 3, q = function() return { 1 } end, p = function() return { 1 } end,
  steps = 10, vary = { a = function(i) return i / 2 end } }
near(fan.q[3][1], exp(1.5), 1e-13, "members with params of their own")
-- a stiff H, where sweeps do not contract and Newton's method solves
local stiff = dm.system { Q = dm.R(2), H = function(z, p) return 500 * (z[1] ^ 2 + p[1] ^ 2) + z[2] * p[2] + dm.sin(z[1] * p[2]) / 10 end }
local path2 = stiff:solver { rule = "gauss(2)", h = 0.05 }:run { q = { 1, 0.1 }, p = { 0, 0.1 }, steps = 60 }
ok(path2:drift "energy".largest < 1e-3 * 500, "a stiff H by Newton's method", path2:drift "energy".largest)

---- refusals ----

raises("quadratic in p", function() last(saddle, "galerkin(2, gauss(3))", 0.1, 1, { q = { 1 }, p = { 1 } }) end)
raises("needs a Lagrangian", function() last(saddle, "rattle", 0.1, 1, { q = { 1 }, p = { 1 } }) end)
raises("needs a Lagrangian", function() last(fast, "blanes-moan(6)", 0.1, 1, flying) end)
raises("instead of 'v'", function() last(saddle, "gauss(2)", 0.1, 1, { q = { 1 }, v = { 2 } }) end)
raises("two positions are no start", function() saddle:solver { rule = "gauss(2)", h = 0.1 }:run { q0 = { 1 }, q1 = { 1.1 }, steps = 1 } end)
raises("not both", function() dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end, H = function(_, p) return p[1] ^ 2 end } end)
raises("function of (q, p)", function() dm.system { Q = dm.R(1), H = 3 } end)
raises("'force' needs a Lagrangian", function() dm.system { Q = dm.R(1), H = function(z, p) return z[1] * p[1] end, force = function() return { 0 } end } end)
raises("no Lagrangian", function() saddle:lagrangian({ 1 }, { 1 }) end)
raises("no Lagrangian", function() saddle:mass({ 1 }, { 1 }) end)
raises("needs an L", function() dm.discrete_lagrangian(saddle, { rule = "gauss(2)", h = 0.1 })({ 1 }, { 1 }) end)
raises("need a Lagrangian", function() saddle:acceleration({ 1 }, { 1 }) end)
raises("the start is missing", function() dm.scene { saddle } end)

---- a length of 1e11 beside an angle: neither sees the other, and the angle keeps its digits ----

local function angle(q, p) return p ^ 2 / (2 + cos(q)) - cos(q) + 0.1 * p * sin(q) end
local alone = dm.system { Q = dm.R(1), H = function(q, p) return angle(q[1], p[1]) end }
local beside = dm.system { Q = dm.R(2), H = function(q, p) return p[1] ^ 2 / 2 + q[1] ^ 2 / 2 + angle(q[2], p[2]) end }
for _, rule in ipairs { "midpoint", "gauss(3)", "lobatto(3)", "symplectic-euler", "rk8" } do
  local q, p = last(beside, rule, 0.1, 100, { q = { 1e11, 1.2 }, p = { 3e10, 0.5 } })
  local q1, p1 = last(alone, rule, 0.1, 100, { q = { 1.2 }, p = { 0.5 } })
  ok(abs(q[2] - q1[1]) + abs(p[2] - p1[1]) < 1e-14, rule .. ": an angle beside a length of 1e11", q[2] - q1[1])
end
tap.done()
