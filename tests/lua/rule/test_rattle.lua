-- RATTLE and SHAKE: against reduced coordinates, order of the compositions, symplectic, reversible, to round-off, linear cost
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, abs, max = math.sin, math.cos, math.abs, math.max

local function end_of(system, rule, start, h, n)
  local path = system:solver { rule = rule, h = h }:run { q = start.q, v = start.v, p = start.p, steps = n, every = n }
  return path.q[#path], path.p[#path], path
end
local function same(a, b)
  for i = 1, #a do if a[i] ~= b[i] then return false end end
  return true
end

-- spherical pendulum on the unit sphere, and in angles (from the downward vertical, azimuth)
local sphere = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end,
  constraint = function(q) return { q:dot(q) - 1 } end }
local angles = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[1] ^ 2 + sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + cos(q[1])
end }
local function point(a) return dm.vector { sin(a[1]) * cos(a[2]), sin(a[1]) * sin(a[2]), -cos(a[1]) } end
local function rate(a, w)
  return dm.vector { w[1] * cos(a[1]) * cos(a[2]) - w[2] * sin(a[1]) * sin(a[2]),
    w[1] * cos(a[1]) * sin(a[2]) + w[2] * sin(a[1]) * cos(a[2]), w[1] * sin(a[1]) }
end
local a0, w0, T = { 0.9, 0.2 }, { 0.3, 1.1 }, 2
local start = { q = point(a0), v = rate(a0, w0) }
local exact = point((end_of(angles, "gauss(6)", { q = a0, v = w0 }, T / 200, 200)))

for _, row in ipairs { { "rattle", 2, 100 }, { "shake", 2, 100 }, { "yoshida(4, rattle)", 4, 100 }, { "suzuki(4, rattle)", 4, 50 },
  { "mclachlan(4, rattle)", 4, 50 }, { "yoshida(6, rattle)", 6, 30 }, { "kahan-li(6, rattle)", 6, 20 },
  { "kahan-li(8, rattle)", 8, 9 }, { "suzuki-umeno(8, rattle)", 8, 10 } } do
  local rule, p, n = row[1], row[2], row[3]
  local coarse = (end_of(sphere, rule, start, T / n, n) - exact):norm()
  local fine = (end_of(sphere, rule, start, T / (2 * n), 2 * n) - exact):norm()
  local measured = math.log(coarse / fine, 2)
  ok(abs(measured - p) < 0.1 and fine > 1e-14, ("%s on the sphere against gauss(6) in angles: order %d"):format(rule, p),
    measured .. " with " .. fine .. " left")
end

local q1, p1 = end_of(sphere, "rattle", start, 0.05, 400)
local q2, p2 = end_of(sphere, "shake", start, 0.05, 400)
near((q1 - q2):norm(), 0, 1e-12, "shake has the positions of rattle")
ok(abs(q1:dot(p1)) < 1e-15 and abs(q2:dot(p2)) > 1e-6, "rattle's momentum is tangent, shake's is not", q1:dot(p1) .. " " .. q2:dot(p2))
-- a rod in the plane: shake's velocities err like h across the constraint; along it, and energies, like h^2
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return q:dot(q) - 1 end }
local function errors(rule, h)
  local path = rod:solver { rule = rule, h = h }:run { q = { 1, 0 }, v = { 0, -0.3 }, t = 1 }
  local n = #path
  return path.q[n], path:velocity()[n], path:energy()[n]
end
local there, rate_there = errors("rattle", 1 / 2 ^ 13)
for _, row in ipairs { { "rattle", 2, 2, 2 }, { "shake", 1, 2, 2 } } do
  local across, along, energy = {}, {}, {}
  for k = 1, 2 do
    local _, v, E = errors(row[1], 1 / 2 ^ (5 + k))
    local d = v - rate_there
    across[k], along[k], energy[k] = abs(there:dot(d)), abs(there[1] * d[2] - there[2] * d[1]), abs(E - 0.045)
  end
  for i, e in ipairs { across, along, energy } do
    near(math.log(e[1] / e[2], 2), row[1 + i], 0.05, ("%s: order of its velocity across, along, of its energy: %d"):format(row[1], i))
  end
end
for _, rule in ipairs(dm.rules()) do
  if rule.name == "shake" then ok(rule.doc:find "velocities of rows err like h across", "and its doc says so", rule.doc) end
end

local back = end_of(sphere, "rattle", { q = q1, p = -p1 }, 0.05, 400)
near((back - start.q):norm(), 0, 1e-12, "the same steps lead back")

-- two-form of T*S^2: with the momentum of the angles, the Jacobian D of a step (differences of order 6) has D' J D = J
local function step_in_angles(z, h)
  local a, P = { z[1], z[2] }, { z[3], z[4] }
  local q, p = sphere:solver({ rule = "rattle", h = h }):step { q = point(a), v = rate(a, { P[1], P[2] / sin(a[1]) ^ 2 }) }
  local theta, phi = math.acos(-q[3]), math.atan(q[2], q[1])
  local e1, e2 = rate({ theta, phi }, { 1, 0 }), rate({ theta, phi }, { 0, 1 })
  return dm.vector { theta, phi, p:dot(e1), p:dot(e2) }
end
local function two_form_defect(h)
  local z, d, D, J = { 0.9, 0.2, 0.3, 0.7 }, 5e-3, {}, { { 0, 0, 1, 0 }, { 0, 0, 0, 1 }, { -1, 0, 0, 0 }, { 0, -1, 0, 0 } }
  for k = 1, 4 do
    local function at(s)
      local moved = { table.unpack(z) }
      moved[k] = moved[k] + s * d
      return step_in_angles(moved, h)
    end
    D[k] = ((at(3) - at(-3)) - 9 * (at(2) - at(-2)) + 45 * (at(1) - at(-1))) / (60 * d)
  end
  local worst = 0
  for i = 1, 4 do
    for j = 1, 4 do
      local sum = 0
      for k = 1, 4 do for l = 1, 4 do sum = sum + D[i][k] * J[k][l] * D[j][l] end end
      worst = max(worst, abs(sum - J[i][j]))
    end
  end
  return worst
end
near(two_form_defect(0.2), 0, 1e-10, "a step of 0.2 keeps the two-form of T*S^2")

-- double spherical pendulum in R^6
local double = dm.system { Q = dm.R(6), L = function(q, v) return v:dot(v) / 2 - 9.81 * (q[3] + q[6]) end,
  constraint = function(q)
    local x, y, z = q[4] - q[1], q[5] - q[2], q[6] - q[3]
    return { (q[1] ^ 2 + q[2] ^ 2 + q[3] ^ 2 - 1) / 2, (x ^ 2 + y ^ 2 + z ^ 2 - 1) / 2 }
  end }
local c, d = sin(0.8), sin(0.4)
local swing = { q = { c, 0, -cos(0.8), c + d, 0, -cos(0.8) - cos(0.4) }, v = { 0, 1, 0, 0, 0.5, 0 } }
local long = double:solver { rule = "rattle", h = 0.01 }
local path = long:run { q = swing.q, v = swing.v, steps = 1e6, every = 1e4 }
ok(path:worst "constraint" < 1e-13, "10^6 steps of a double spherical pendulum: constraints below 1e-13", path:worst "constraint")
ok(path:drift(path:momentum(dm.SO(2), { block = 3 })).largest < 1e-11, "and the vertical angular momentum to round-off",
  path:drift(path:momentum(dm.SO(2), { block = 3 })).largest)
local drift = path:drift "energy"
ok(abs(drift.per_time) < 4 * drift.error + 1e-9 and drift.largest < 0.01, "and no drift of the energy", drift.per_time)
ok(long:report().newton_per_step < 2.01, "two Newton iterations a step", long:report().newton_per_step)

-- exact tangents, by the prolonged constraints: the two-form on vectors that are tangent, and chaos
for _, rule in ipairs { "rattle", "shake", "kahan-li(6, rattle)" } do
  local defect = double:solver({ rule = rule, h = 0.02 }):symplecticity { q = swing.q, v = swing.v, steps = 50 }
  ok(defect < 1e-14, rule .. " is symplectic on the constraints to round-off", defect)
end
ok(double:solver({ rule = "rattle", h = 0.02 }):reversal { q = swing.q, v = swing.v, steps = 50 } < 1e-12, "and rattle reversible")
local calm = sphere:solver({ rule = "rattle", h = 0.05 }):lyapunov { q = start.q, v = start.v, steps = 20000 }
local wild = double:solver({ rule = "rattle", h = 0.01 }):lyapunov { q = { 0, 0, 1, 0.6, 0, 1.8 }, v = { 0, 0.5, 0, 0, 1, 0 }, steps = 20000 }
ok(abs(calm.megno - 2) < 0.1 and wild.exponent > 0.5, "a spherical pendulum is regular, a double one in full swing chaotic",
  calm.megno .. " " .. wild.exponent)

-- bits: backends, rows, an ensemble
local function bits(backend)
  local p = double:solver({ rule = "yoshida(4, rattle)", h = 0.01, backend = backend }):run { q = swing.q, v = swing.v, steps = 3000, every = 3000 }
  return p.q[#p], p.p[#p]
end
local qj, pj = bits "jit"
local qt, pt = bits "tape"
ok(same(qj, qt) and same(pj, pt), "tape and native code give the same bits")
local often = double:solver({ rule = "rattle", h = 0.01 }):run { q = swing.q, v = swing.v, steps = 500 }
local once = double:solver({ rule = "rattle", h = 0.01 }):run { q = swing.q, v = swing.v, steps = 500, every = 500 }
local between = double:solver({ rule = "rattle", h = 0.01 }):run { q = swing.q, v = swing.v, at = { 1.2345, 3.3333, 5 } }
ok(same(often.q[501], once.q[2]) and same(often.p[501], once.p[2]), "rows do not change a run")
ok(same(once.q[2], between.q[3]), "nor do times between steps")
for _, rule in ipairs { "rattle", "yoshida(4, rattle)", "shake" } do
  local solver, file = double:solver { rule = rule, h = 0.01 }, os.tmpname()
  local whole = solver:run { q = swing.q, v = swing.v, steps = 300, every = 300 }
  local sideways = solver:run { q = swing.q, v = swing.v, at = { 0.123, 0.777, 3 } }
  solver:run({ q = swing.q, v = swing.v, steps = 100, every = 100 }):checkpoint(file)
  local rest = dm.resume(file, double):run { steps = 200, every = 200 }
  ok(same(rest.q[#rest], whole.q[2]) and same(rest.p[#rest], whole.p[2]), rule .. " goes on from a checkpoint bit for bit")
  ok(same(sideways.q[3], whole.q[2]), "and is not changed by times between its steps")
  os.remove(file)
end
ok(between:worst "constraint" < 1e-14, "which lie on the constraints too")
-- products that force, g and G share
local bent = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 - cos(q[1] * q[2] + q[3] ^ 2) end,
  constraint = function(q) return q[1] * q[2] + sin(q[1] * q[2] + q[3]) end }
local on_it = { q = { 0.3, 0.4, -0.3 }, v = { 0.4, 0.3, 0.1 }, project = true, steps = 400 }
often = bent:solver({ rule = "rattle", h = 0.02 }):run(on_it)
on_it.every = 400
once = bent:solver({ rule = "rattle", h = 0.02 }):run(on_it)
ok(same(often.q[401], once.q[2]) and same(often.p[401], once.p[2]), "nor where force and constraint share products")
local many = double:solver({ rule = "rattle", h = 0.01 }):ensemble { members = 3, q = function() return swing.q end,
  v = function(i) return { 0, i == 2 and 1 or 0.7, 0, 0, 0.5, 0 } end, steps = 500, threads = 2 }
ok(same(many.q[2], between.q[3]), "a member of an ensemble has the bits of a run of its own")

-- what is a constraint in one description is none in another
local free = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local kepler = { q = { 0.4, 0 }, v = { 0, 2 } }
near((end_of(free, "rattle", kepler, 0.01, 100) - end_of(free, "verlet", kepler, 0.01, 100)):norm(), 0, 1e-13,
  "without constraints rattle is verlet")
local pushed = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 end, force = function() return { 0, 0, -1 } end,
  constraint = function(q) return q:dot(q) - 1 end }
near((end_of(pushed, "rattle", start, 0.05, 100) - end_of(sphere, "rattle", start, 0.05, 100)):norm(), 0, 1e-13,
  "gravity as a force or in L")
-- x = q1, y = q1 + q2: a full mass matrix
local skew = dm.system { Q = dm.R(3), L = function(q, v)
  local y, vy = q[1] + q[2], v[1] + v[2]
  return (v[1] ^ 2 + vy ^ 2 + v[3] ^ 2) / 2 - q[3] + 0 * y
end, constraint = function(q) return q[1] ^ 2 + (q[1] + q[2]) ^ 2 + q[3] ^ 2 - 1 end }
local qs, vs = start.q, start.v
local other = end_of(skew, "rattle", { q = { qs[1], qs[2] - qs[1], qs[3] }, v = { vs[1], vs[2] - vs[1], vs[3] } }, 0.05, 100)
near((dm.vector { other[1], other[1] + other[2], other[3] } - end_of(sphere, "rattle", start, 0.05, 100)):norm(), 0, 1e-12,
  "in skew coordinates, with a full mass matrix")

-- a pivot that moves, x = 0.3 sin 2t, and a rod that grows, r = 1 + t/5: against the angle as coordinate
local function X(t) return 0.3 * sin(2 * t) end
local moving = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end,
  constraint = function(q, t) return ((q[1] - X(t)) ^ 2 + q[2] ^ 2 - (1 + t / 5) ^ 2) / 2 end }
local angle = dm.system { Q = dm.R(1), L = function(q, v, t)
  local r, u = 1 + t / 5, 0.6 * cos(2 * t)
  local x, y = u + 0.2 * sin(q[1]) + r * cos(q[1]) * v[1], -0.2 * cos(q[1]) + r * sin(q[1]) * v[1]
  return (x ^ 2 + y ^ 2) / 2 + r * cos(q[1])
end }
local goal = end_of(angle, "gauss(6)", { q = { 0.7 }, v = { 0.4 } }, 0.01, 200)[1]
local pivot = { q = { sin(0.7), -cos(0.7) }, v = { 0.6 + 0.2 * sin(0.7) + 0.4 * cos(0.7), -0.2 * cos(0.7) + 0.4 * sin(0.7) } }
local function moving_error(rule, n)
  local q = end_of(moving, rule, pivot, 2 / n, n)
  return (q - dm.vector { X(2) + 1.4 * sin(goal), -1.4 * cos(goal) }):norm()
end
for _, row in ipairs { { "rattle", 2, 100 }, { "yoshida(4, rattle)", 4, 40 } } do
  local rule, p, n = table.unpack(row)
  local measured = math.log(moving_error(rule, n) / moving_error(rule, 2 * n), 2)
  near(measured, p, 0.1, rule .. " with a constraint that moves: order " .. p)
end

-- a force that sees v, taken at (q1 - q0)/h in both kicks: f = -0.2 (1 + v.v) v + (0, 0, sin t), and its pull-back to the angles
local drag = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end,
  force = function(_, v, t) return -0.2 * (1 + v:dot(v)) * v + dm.vector { 0, 0, sin(t) } end }
local drag_angles = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + cos(q[1]) end,
  force = function(q, v, t)
    local s2 = sin(q[1]) ^ 2
    local c = -0.2 * (1 + v[1] ^ 2 + s2 * v[2] ^ 2)
    return { c * v[1] + sin(q[1]) * sin(t), c * s2 * v[2] }
  end }
local rest = point((end_of(drag_angles, "gauss(4)", { q = a0, v = w0 }, T / 400, 400)))
for _, row in ipairs { { "rattle", 2, 100 }, { "yoshida(4, rattle)", 4, 40 } } do
  local rule, p, n = table.unpack(row)
  local coarse = (end_of(drag, rule, start, T / n, n) - rest):norm()
  local fine = (end_of(drag, rule, start, T / (2 * n), 2 * n) - rest):norm()
  near(math.log(coarse / fine, 2), p, 0.1, rule .. " with drag on the sphere: order " .. p)
end
q1, p1, path = end_of(drag, "rattle", start, 0.02, 2000)
ok(abs(q1:dot(q1) - 1) < 1e-15 and abs(q1:dot(p1)) < 1e-15 and path:worst "constraint" < 1e-15, "and stays on it")
local full = dm.system { Q = dm.R(3), L = function(_, v) return (v[1] ^ 2 + (v[1] + v[2]) ^ 2 + v[3] ^ 2) / 2 + v[1] end,
  force = function(_, v) return { -v[1] - (v[1] + v[2]), -(v[1] + v[2]), -2 * v[3] } end }
local qf = end_of(full, "rattle", { q = { 0, 0, 0 }, v = { 1, 0, 1 } }, 0.1, 10)
-- one step of v' = -k v is v (1 - k h/2) / (1 + k h/2), and q moves by the mean
local function decay(k) return (1 - ((1 - k * 0.05) / (1 + k * 0.05)) ^ 10) / k end
near((qf - dm.vector { decay(1), 0, decay(2) }):norm(), 0, 1e-14, "without constraints, full mass matrix, linear drag: the closed form")

-- n rods in a row: G W G' has one band, and operations grow like n
local function chain(n)
  return dm.system { Q = dm.R(2 * n), L = function(q, v)
    local L = v:dot(v) / 2
    for i = 1, n do L = L - q[2 * i] end
    return L
  end, constraint = function(q)
    local g, x, y = {}, 0, 0
    for i = 1, n do
      g[i] = ((q[2 * i - 1] - x) ^ 2 + (q[2 * i] - y) ^ 2 - 1) / 2
      x, y = q[2 * i - 1], q[2 * i]
    end
    return g
  end }
end
local function chain_run(n)
  local q, v = dm.vector(2 * n), dm.vector(2 * n)
  for i = 1, n do q[2 * i - 1] = i end
  local solver = chain(n):solver { rule = "rattle", h = 0.002 }
  local p = solver:run { q = q, v = v, steps = 200, every = 50 }
  return solver:report().operations, p:worst "constraint"
end
local at10, at11, at50 = chain_run(10), chain_run(11), chain_run(50)
ok(at50 - at10 == 40 * (at11 - at10), "each further rod of a chain costs the same number of operations", at10 .. " " .. at11 .. " " .. at50)
local _, worst = chain_run(50)
ok(worst < 1e-13, "50 rods to round-off", worst)

-- what goes wrong
local fine, failure = pcall(end_of, sphere, "rattle", start, 3, 10)
ok(not fine and failure.code == "no_convergence" and failure.path.steps == failure.step - 1, "too long a step fails with the path so far",
  fine or failure)
local bent = dm.system { Q = dm.R(2), L = function(q, v) return (1 + q[1] ^ 2) * v:dot(v) / 2 end, constraint = function(q) return q[2] end }
raises("constant mass", end_of, bent, "rattle", { q = { 0, 0 }, v = { 1, 0 } }, 0.1, 1)
raises("it takes no argument", sphere.solver, sphere, { rule = "rattle(2)", h = 0.1 })
raises("name one that does", end_of, sphere, "yoshida(4)", start, 0.1, 1)
raises("base must be a symmetric rule", sphere.solver, sphere, { rule = "yoshida(4, shake)", h = 0.1 })
-- a state that stops being finite is found in its step, however long the bursts
local steep = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 4 end }
for _, every in ipairs { 1, 7, 50, 1000 } do
  local one = steep:solver { rule = "rattle", h = 0.01 }
  local _, failure = pcall(one.run, one, { q = { 1 }, v = { 1 }, steps = 1000, every = every })
  local last = failure.path.q[#failure.path][1]
  tap.ok(failure.code == "not_finite" and failure.step == failure.path.steps + 1 and last == last and math.abs(last) < math.huge,
    "rattle stops before what is not finite, every = " .. every, failure.step)
end
tap.done()
