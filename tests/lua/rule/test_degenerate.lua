-- L = alpha(q) . v - H(q), linear in v: Lotka-Volterra, a guiding centre in a tokamak, the pendulum in phase space
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local log, abs, max, sqrt, cos = math.log, math.abs, math.max, math.sqrt, math.cos

-- q1' = q1 (q2 - 2), q2' = -q2 (q1 - 1); gauge adds a total derivative and more to alpha, which changes the motion off p = alpha(q)
local function volterra(gauge)
  return dm.system { Q = dm.R(2), L = function(q, v)
    return (log(q[2]) / q[1] + gauge * q[2]) * v[1] + gauge * q[1] * v[2] - (q[1] + q[2] - log(q[1]) - 2 * log(q[2]))
  end }
end
-- Ellison, Burby & Qin 2015: (R, Z, phi, u), B0 = R0 = 1, safety factor 2; phi is cyclic
local mu = 2.25e-6
local centre = dm.system { Q = dm.R(4), L = function(q, v)
  local R, Z, u = q[1], q[2], q[4]
  local r2 = (R - 1) ^ 2 + Z ^ 2
  local S = sqrt(r2 + 4)
  local a1, a2, a3 = Z / (2 * R) + u * Z / S, -log(R) / 2 - u * (R - 1) / S, -r2 / 4 + 2 * u * R / S
  return a1 * v[1] + a2 * v[2] + a3 * v[3] - (u ^ 2 / 2 + mu * S / (2 * R))
end }
local banana = { 1.05, 0, 0, -4.306e-4 }

local function off_alpha(path, system)
  local worst, zero = 0, 0 * path.q[1]
  for i = 1, #path do worst = max(worst, (path.p[i] - system:momentum(path.q[i], zero)):norm()) end
  return worst
end
local function spread(E)
  local worst = 0
  for i = 1, #E do worst = max(worst, abs(E[i] / E[1] - 1)) end
  return worst
end

-- orders: against ten steps more of a rule of order 10, in the Lagrangian with and without gauge
for _, gauge in ipairs { 0, 1 } do
  local system = volterra(gauge)
  local function final(rule, N)
    local path = system:solver { rule = rule, h = 1 / N }:run { q = { 2, 1 }, steps = N, every = N }
    return path.q[#path]
  end
  local exact = final("degenerate(5)", 100)
  for s, N in ipairs { 40, 20, 8 } do
    local rule = ("degenerate(%d)"):format(s)
    near(log((final(rule, N) - exact):norm() / (final(rule, 2 * N) - exact):norm(), 2), 2 * s, 0.1, ("%s has order %d, gauge %d"):format(rule, 2 * s, gauge))
  end
  -- an independent road: the equations of first order by a fourth-order Runge-Kutta method
  local q1, q2, h = 2, 1, 1 / 4000
  local function f(a, b) return a * (b - 2), -b * (a - 1) end
  for _ = 1, 4000 do
    local a1, b1 = f(q1, q2)
    local a2, b2 = f(q1 + h / 2 * a1, q2 + h / 2 * b1)
    local a3, b3 = f(q1 + h / 2 * a2, q2 + h / 2 * b2)
    local a4, b4 = f(q1 + h * a3, q2 + h * b3)
    q1, q2 = q1 + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4), q2 + h / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
  end
  near((exact - dm.vector { q1, q2 }):norm(), 0, 1e-12, "the motion is that of the equations, gauge " .. gauge)
end

-- 10^5 steps, some 1500 periods: energy without drift, momentum on its constraint
local system = volterra(1)
local path = system:solver { rule = "degenerate(2)", h = 0.1 }:run { q = { 2, 1 }, steps = 100000, every = 50 }
ok(spread(path:energy()) < 2e-5, "Lotka-Volterra, 10^5 steps: energy bounded", spread(path:energy()))
near(path:drift("energy").per_time, 0, 1e-11, "  without drift")
ok(off_alpha(path, system) < 1e-14, "  p = alpha(q)", off_alpha(path, system))
path = system:solver { rule = "degenerate(1)", h = 0.1 }:run { q = { 2, 1 }, steps = 100000, every = 50 }
ok(spread(path:energy()) < 1e-2 and abs(path:drift("energy").per_time) < 1e-8, "  also by one stage", spread(path:energy()))

-- what the projection is for: without it p leaves alpha(q)
local plain = volterra(0)
local fine, failure = pcall(function() return plain:solver { rule = "degenerate(2, free)", h = 0.1 }:run { q = { 2, 1 }, steps = 20000, every = 10 } end)
ok(not fine or off_alpha(failure, plain) > 0.1, "two free stages leave alpha(q) far behind, or fail", fine and off_alpha(failure, plain))
path = plain:solver { rule = "degenerate(1, free)", h = 0.1 }:run { q = { 2, 1 }, steps = 2000 }
ok(off_alpha(path, plain) > 1e-3, "one free stage stays near it, not on it", off_alpha(path, plain))

-- guiding centre: bounce of a trapped particle, about 54 steps a period
path = centre:solver { rule = "degenerate(2)", h = 800 }:run { q = banana, steps = 100000, every = 100 }
ok(spread(path:energy()) < 1e-5, "guiding centre, 10^5 steps: energy bounded", spread(path:energy()))
near(path:drift("energy").per_time * 8e7 / path:energy()[1], 0, 1e-7, "  its drift over the whole run, relative")
local worst = 0
for i = 1, #path do worst = max(worst, abs(path.p[i][3] - path.p[1][3])) end
ok(worst < 1e-13, "  toroidal momentum of the cyclic angle to round-off", worst)
ok(off_alpha(path, centre) < 1e-15, "  p = alpha(q)", off_alpha(path, centre))
local turns = 0
for i = 2, #path do turns = turns + (path.q[i][4] * path.q[i - 1][4] < 0 and 1 or 0) end
ok(turns > 100, "  and it goes on bouncing", turns)

-- linear alpha: Gauss collocation of Hamilton's equations, and nothing to project
local phase = dm.system { Q = dm.R(2), L = function(q, v) return q[2] * v[1] - (q[2] ^ 2 / 2 - cos(q[1])) end }
local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
for s = 1, 3 do
  local a = phase:solver { rule = ("degenerate(%d)"):format(s), h = 0.2 }:run { q = { 1.2, 0.5 }, steps = 100 }
  local b = pendulum:solver { rule = ("gauss(%d)"):format(s), h = 0.2 }:run { q = { 1.2 }, v = { 0.5 }, steps = 100 }
  near(abs(a.q[101][1] - b.q[101][1]) + abs(a.q[101][2] - b.p[101][1]), 0, 1e-12, ("the pendulum in phase space is gauss(%d)"):format(s))
end

-- symmetric
local solver = plain:solver { rule = "degenerate(2)", h = 0.3 }
local q, p = solver:step { q = { 2, 1 } }
local back = dm.system { Q = dm.R(2), L = function(x, v) return plain.L(x, -1 * v) end }
local home = back:solver { rule = "degenerate(2)", h = 0.3 }:step { q = q, p = -1 * p }
near((home - dm.vector { 2, 1 }):norm(), 0, 1e-14, "a step back ends where it began")

-- the form d alpha, dq1 dq2 (d1 alpha2 - d2 alpha1): kept to more than the order of the rule, not exactly; differences of fourth order
local general = dm.system { Q = dm.R(2), L = function(x, v)
  return (x[2] + x[1] * x[2] ^ 2 / 3 + math.sin(x[2])) * v[1] + (cos(x[1] * x[2]) - x[1] ^ 2) * v[2] - (x[1] ^ 2 + x[2] ^ 2 / 2 + x[1] ^ 2 * x[2] / 5)
end }
local function slope(f, x, j)
  local e = 1e-3
  local function at(d) local y = { x[1], x[2] } y[j] = y[j] + d return f(y) end
  return (8 * (at(e) - at(-e)) - (at(2 * e) - at(-2 * e))) / (12 * e)
end
local function form(x)
  local function alpha(y) return general:momentum(y, { 0, 0 }) end
  return slope(alpha, x, 1)[2] - slope(alpha, x, 2)[1]
end
local function defect(rule, h)
  local x = { 0.5, 0.4 }
  local function step(y) return (general:solver { rule = rule, h = h }:step { q = y }) end
  local a, b = slope(step, x, 1), slope(step, x, 2)
  return abs((a[1] * b[2] - a[2] * b[1]) * form(step(x)) / form(x) - 1)
end
local d1, d2 = defect("degenerate(1)", 0.56), defect("degenerate(1)", 0.4)
ok(d1 > 1e-9 and d1 < 1e-6, "the symplectic form has a defect, as the doc says", d1)
ok(log(d1 / d2) / log(1.4) > 4, "of an order above that of the rule", log(d1 / d2) / log(1.4))

ok(tostring(plain):find "linear in v", "a system says that its L is linear in v", tostring(plain))

-- starts and refusals
ok(plain:solver({ rule = "degenerate(1)", h = 0.1 }):run({ q = { 2, 1 }, v = { 7, 7 }, steps = 1 }).p[1][1] == 0, "a velocity has no say")
near((plain:solver({ rule = "degenerate(1)", h = 0.1 }):run({ q = { 2, 3 }, p = plain:momentum({ 2, 3 }, { 0, 0 }), steps = 1 }).p[1] - plain:momentum({ 2, 3 }, { 0, 0 })):norm(), 0, 0,
  "the momentum may be given")
raises("the given p is off by 1", function() plain:solver({ rule = "degenerate(1)", h = 0.1 }):run { q = { 2, 1 }, p = { 1, 0 }, steps = 1 } end)
raises("degenerate(2)", function() plain:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 2, 1 }, v = { 0, 0 }, steps = 1 } end)
raises("degenerate(2)", function() plain:solver({ rule = "verlet", h = 0.1 }):run { q = { 2, 1 }, v = { 0, 0 }, steps = 1 } end)
raises("position q alone", function() plain:solver({ rule = "degenerate(1)", h = 0.1 }):run { q0 = { 2, 1 }, q1 = { 2, 1 }, steps = 1 } end)
raises("not linear in v", function() pendulum:solver({ rule = "degenerate(1)", h = 0.1 }):run { q = { 2 }, v = { 1 }, steps = 1 } end)
raises("odd", function()
  dm.system({ Q = dm.R(3), L = function(x, v) return x[2] * v[1] - x[3] ^ 2 end }):solver({ rule = "degenerate(1)", h = 0.1 }):run { q = { 1, 1, 1 }, steps = 1 }
end)
raises("singular", function() -- d alpha = 0
  dm.system({ Q = dm.R(2), L = function(x, v) return x[1] * v[1] - x[2] ^ 2 end }):solver({ rule = "degenerate(1)", h = 0.1 }):run { q = { 1, 1 }, steps = 1 }
end)
raises("linear in v", function() plain:velocity({ 2, 1 }, { 0, 0 }) end)
raises("word free", function() plain:solver { rule = "degenerate(2, fixed)", h = 0.1 } end)
raises("whole number", function() plain:solver { rule = "degenerate(0)", h = 0.1 } end)

-- what is beside an L linear in v that no rule knows is told at once, whatever the rule
for _, beside in ipairs { { "forces", { force = function(q) return { -0.1 * q[1], 0 } end } },
  { "constraints", { constraint = function(q) return q[1] - 1 end } },
  { "rolling constraints", { rolling = function(_, v) return v[1] end } } } do
  local options = { Q = dm.R(2), L = function(q, v) return q[1] * v[2] - q:dot(q) / 2 end }
  for key, f in pairs(beside[2]) do options[key] = f end
  local system = dm.system(options)
  for _, rule in ipairs { "midpoint", "degenerate(2)", "gauss(2)", "rk4", "verlet" } do
    local fine, why = pcall(function() system:solver({ rule = rule, h = 0.1 }):run { q = { 1, 0 }, v = { 0, 0 }, steps = 1 } end)
    ok(not fine and tostring(why):find("there are " .. beside[1] .. " beside it: no rule steps such a system", 1, true)
      and not tostring(why):find "rules that do" and not tostring(why):find '"degenerate', beside[1] .. " by " .. rule, why)
  end
end
raises("\"degenerate(2)\" is for such an L", function()
  volterra(0):solver({ rule = "midpoint", h = 0.1 }):run { q = { 1, 1 }, v = { 0, 0 }, steps = 1 }
end)

-- two point vortices: three stages take hardly more iterations than two, so that a step costs what its equations do
for _, row in ipairs { { 1, 1, 0.1 }, { 1, 1, 0.5 }, { 1, 0.5, 0.1 }, { 1, -1, 0.1 }, { 2, -1, 0.5 }, { 1, 1, 0.001 } } do
  local a, b, h = table.unpack(row)
  local pair = dm.system { Q = dm.R(4), L = function(q, v)
    local r2 = (q[1] - q[3]) ^ 2 + (q[2] - q[4]) ^ 2
    return a * q[1] * v[2] + b * q[3] * v[4] + a * b * log(r2) / (4 * math.pi)
  end }
  local cost = {}
  for s = 2, 3 do
    local solver = pair:solver { rule = ("degenerate(%d)"):format(s), h = h }
    solver:run { q = { 0.5, 0, -0.5, 0.2 }, v = { 0, 0, 0, 0 }, steps = 2000, every = 2000 }
    local report = solver:report()
    cost[s] = report.evaluations / report.steps
  end
  ok(cost[3] < 2 * cost[2] and cost[3] < 40, ("vortices %g, %g, h = %g: kernels a step by two and three stages"):format(a, b, h),
    cost[2] .. " and " .. cost[3])
end

-- three vortices, 8 starts of 4000 steps: the impulse walks by 1.7e-17 a step (9e-17 where alpha was rounded before it was subtracted)
local G, off = { 1, 0.7, 1.3 }, 0
local three = dm.system { Q = dm.R(6), L = function(q, v)
  local sum = 0
  for i = 1, 3 do
    local x, y = q[2 * i - 1], q[2 * i]
    sum = sum + G[i] * (x * v[2 * i] - y * v[2 * i - 1]) / 2
    for j = 1, i - 1 do sum = sum + G[i] * G[j] * log((x - q[2 * j - 1]) ^ 2 + (y - q[2 * j]) ^ 2) / (8 * math.pi) end
  end
  return sum
end }
for k = 1, 8 do
  local path = three:solver { rule = "degenerate(2)", h = 0.05 }
    :run { q = { -1 + 0.02 * k, 0.1, 0.5, 1 - 0.03 * k, 0.8, -0.7 }, v = { 0, 0, 0, 0, 0, 0 }, steps = 4000, every = 4000 }
  local change = 0
  for i = 1, 6 do change = change + G[(i + 1) // 2] * (path.q[2][i] - path.q[1][i]) * (path.q[2][i] + path.q[1][i]) / 2 end
  off = off + change ^ 2 / 8
end
-- members: positions alone are starts, as of runs; a p that is given must be alpha(q)
do
  local function q(i) return { -1 + 0.1 * i, 0.1, 0.5, 1, 0.8, -0.7 } end
  local solver = three:solver { rule = "degenerate(2)", h = 0.05 }
  local e, same = solver:ensemble { members = 4, q = q, steps = 20, threads = 2 }, true
  for i = 1, 4 do
    local path = solver:run { q = q(i), steps = 20 }
    same = same and path.q[21] == e.q[i] and path.p[21] == e.p[i]
  end
  ok(same, "members that start at positions are runs of their own")
  local function alpha(i) return solver:run({ q = q(i), steps = 0 }).p[1] end
  ok(solver:ensemble { members = 4, q = q, p = alpha, steps = 20 }.q == e.q, "the same with p = alpha(q)")
  raises("member 3: no start: L is linear in v", solver.ensemble, solver,
    { members = 4, q = q, p = function(i) return i == 3 and { 1, 2, 3, 4, 5, 6 } or alpha(i) end, steps = 20 })
  local free = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
  raises("one of 'v' and 'p' is needed", function()
    return free:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 1, q = { { 1 } }, steps = 1 }
  end)
end
ok(off < 2.5e-15 ^ 2, "three vortices keep their impulse", off ^ 0.5)
tap.done()
