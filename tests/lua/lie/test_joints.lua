-- constraints, rolling conditions, forces and controls of systems on groups, stepped by lie(s)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, log, sin, cos = math.abs, math.max, math.log, math.sin, math.cos
local vector = dm.vector

local function far(a, b)
  if type(b) == "number" then return abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = max(worst, far(a[i], b[i])) end
  return worst
end

local function run(system, rule, t, n, start, every)
  return system:solver { rule = rule, h = t / n }:run { q = start.q, v = start.v, steps = n,
    every = every or n, project = start.project }
end

-- the order between n and 2 n steps of `entry` of a path, against its value
local function order(system, rule, t, n, start, value, entry)
  local coarse = far(entry(run(system, rule, t, n, start)), value)
  return log(coarse / far(entry(run(system, rule, t, 2 * n, start)), value), 2)
end

local SO3, one = dm.SO(3), dm.SO(3):identity()
local pair = dm.product(SO3, dm.R(3))
local function body(q, v)
  return (v[1] ^ 2 + 1.2 * v[2] ^ 2 + 0.6 * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 - q[2][3]
end
local function finish(path) return { path.q[#path], path.p[#path] } end

---- a joint: the top of test_lie.lua with its centre of mass beside it ----

local top = dm.system { Q = SO3, L = function(R, W)
  return (2 * W[1] ^ 2 + 2.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3]
end }
local function held(q) return q[2] - q[1] * vector { 0, 0, 1 } end
local hung = dm.system { Q = pair, L = body, constraint = held }
local R, W = SO3:exp { 0.4, 0, 0 }, vector { 0.2, 0.2 / 2.2, 2.5 }
local V = R * vector { W[2], -W[1], 0 }
local tilt = { q = { R, R * vector { 0, 0, 1 } }, v = { W[1], W[2], W[3], V[1], V[2], V[3] } }
local at2 = run(top, "lie(5)", 2, 100, { q = R, v = W }).q[2]
local function attitude(path) return path.q[#path][1] end
for _, row in ipairs { { "lie(1)", 2, 40 }, { "lie(1, lobatto(2))", 2, 40 },
  { "lie(1, cayley)", 2, 160 }, { "lie(2)", 4, 40 }, { "lie(2, lobatto(3))", 4, 40 },
  { "lie(2, gauss(2), cayley)", 4, 80 }, { "lie(3)", 6, 20 }, { "lie(3, lobatto(4))", 6, 20 } } do
  near(order(hung, row[1], 2, row[3], tilt, at2, attitude), row[2], 0.15,
    row[1] .. " with a joint")
end
local long = run(hung, "lie(2)", 100, 2000, tilt, 10)
ok(long:worst "constraint" < 1e-14, "no drift off the joint")
local J = long:momentum(SO3)
local turned = 0
for i = 1, #long do turned = max(turned, abs(J[i][3] - J[1][3])) end
ok(turned < 1e-13, "vertical momentum of a body and its joint")
local energy = long:drift "energy"
ok(energy.largest < 1e-6 and abs(energy.per_time) < 1e-8, "energy in a band")

-- everything at once, and in time: a joint that moves, a rolling condition, a torque
local function rolls(q, v) return { v[3] - 0.3 * v[1] * q[1][1][1] - 0.2 * v[5] } end
local all = dm.system { Q = pair, L = body, rolling = rolls,
  constraint = function(q, t) return q[2] - q[1] * vector { 0, 0.1 * dm.sin(t), 1 } end,
  force = function(q, v, t)
    return { -0.1 * v[1], 0.2 * dm.sin(t), -0.3 * v[3] * v[2], q[2][1], 0, -0.2 * v[6] }
  end }
local off = { q = { R, R * vector { 0, 0, 1.05 } }, v = { 0.2, 0.3, 0.1, 0, 0, 0 }, project = true }
local mirrored = dm.system { Q = pair, trivialization = "right", rolling = rolls, constraint = held,
  L = function(q, v)
    local w = q[1]:transpose() * vector { v[1], v[2], v[3] }
    return body(q, { w[1], w[2], w[3], v[4], v[5], v[6] })
  end }
-- reactions that turn with the velocity
local turning = dm.system { Q = pair, L = function(q, v) return body(q, v) - q[1][3][3] end,
  rolling = function(q, v) return { v[1] ^ 2 + v[2] ^ 2 + q[1][1][1] * v[4] ^ 2 - 1 } end }
local unit = { q = { R, { 0, 0, 0 } }, v = { 0.6, 0.3, 0.1, 0.7, 0.1, 0.2 }, project = true }
for name, case in pairs { ["a joint, rolling and a torque"] = { all, off },
  ["right trivialization"] = { mirrored, off }, ["a speed that is held"] = { turning, unit } } do
  local fine = finish(run(case[1], "lie(4)", 1, 64, case[2]))
  for _, row in ipairs { { "lie(1)", 2, 16 }, { "lie(2)", 4, 8 }, { "lie(2, lobatto(3))", 4, 16 },
    { "lie(3)", 6, 6 } } do
    near(order(case[1], row[1], 1, row[3], case[2], fine, finish), row[2], 0.15,
      row[1] .. ": " .. name)
  end
end

---- rolling: closed forms ----

local ball = dm.system { Q = dm.product(SO3, dm.R(2)),
  L = function(_, v) return 0.2 * (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) + (v[4] ^ 2 + v[5] ^ 2) / 2 end,
  rolling = function(q, v)
    local w = q[1] * vector { v[1], v[2], v[3] }
    return { v[4] + 1.4 * q[2][2] - w[2], v[5] - 1.4 * q[2][1] + w[1] }
  end }
local on_table = { q = { one, vector { 0.5, 0.2 } }, v = { 0.3, -0.1, 0.7, -0.38, 0.4 } }
local s, c = sin(1.2), cos(1.2) -- 2/7 of the table's rate
local there = { 0.5 + (s * -0.38 - (1 - c) * 0.4) / 0.4, 0.2 + ((1 - c) * -0.38 + s * 0.4) / 0.4 }
for _, row in ipairs { { "lie(3)", 30 }, { "lie(4)", 10 } } do
  local path = run(ball, row[1], 3, row[2], on_table)
  ok(far(path.q[2][2], there) < 1e-11, row[1] .. ": a circle on a turntable")
  ok(path:worst "rolling" < 1e-14, "without slip")
end

local suslov = dm.system { Q = SO3, rolling = function(_, w) return { w[3] } end,
  L = function(_, w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 1.5 * w[3] ^ 2) / 2 + 0.5 * w[1] * w[3] end }
local slow = run(suslov, "lie(4)", 2, 40, { q = one, v = { 1, 0.2, 0 } })
near(slow:velocity(2)[2], 0.563944408309486226, 1e-11, "Suslov's tanh")
ok(run(suslov, "lie(1)", 200, 2000, { q = one, v = { 1, 0.2, 0 } }):worst "rolling" < 1e-15,
  "which stays without a spin about the third axis")

-- Chaplygin's sphere: the momentum about the point of contact is fixed in space
local A = { 0.3, 0.4, 0.5 }
local sphere = dm.system { Q = dm.product(SO3, dm.R(2)),
  L = function(_, v)
    return (A[1] * v[1] ^ 2 + A[2] * v[2] ^ 2 + A[3] * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2) / 2
  end,
  rolling = function(q, v)
    local w = q[1] * vector { v[1], v[2], v[3] }
    return { v[4] - w[2], v[5] + w[1] }
  end }
local function about_contact(path, i)
  local w, q = path:velocity(i), path.q[i]
  local spin = q[1] * vector { A[1] * w[1], A[2] * w[2], A[3] * w[3] }
  return { spin[1] - w[5], spin[2] + w[4], spin[3] }
end
local w = one * vector { 0.7, -0.4, 0.9 }
local rolled = run(sphere, "lie(4)", 10, 200, { q = { one, vector { 0, 0 } },
  v = { 0.7, -0.4, 0.9, w[2], -w[1] } }, 20)
for i = 1, #rolled do
  if far(about_contact(rolled, i), about_contact(rolled, 1)) > 1e-11 then
    ok(false, "Chaplygin's sphere: momentum about the contact")
  end
end
ok(far(rolled.q[#rolled][1], one) > 0.5, "Chaplygin's sphere turns")
ok(rolled:drift "energy".largest < 1e-11, "Chaplygin's sphere: energy")

-- an upright disk that rolls round with a constant body velocity
local disk = dm.system { Q = dm.product(dm.SE(2), dm.T(1)),
  L = function(_, v) return (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2 + v[4] ^ 2) / 2 end,
  rolling = function(_, v) return { v[1] - v[4], v[2] } end }
local SE2 = dm.SE(2)
for _, row in ipairs { { "lie(3)", 60 }, { "lie(4)", 30 } } do
  local path = run(disk, row[1], 3, row[2], { q = { SE2:identity(), 0 }, v = { 2, 0, 1, 2 } })
  ok(far(path.q[2][1], SE2:exp { 6, 0, 3 }) < 1e-10, row[1] .. ": a disk that rolls round")
end

---- spheres beside a group ----

local held_by = dm.system { Q = dm.product(SO3, dm.S(2), dm.R(1)), L = function(q, v)
  local d = q[1] * vector { 0, 0, 1 } - q[2]
  return (v[1] ^ 2 + 2 * v[2] ^ 2 + 1.5 * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2 + v[7] ^ 2) / 2
    - d:dot(d) - q[3][1] ^ 2 / 2 - q[2][3]
end }
local beside = { q = { R, vector { 0, 0.6, 0.8 }, { 0.1 } }, v = { 0.1, 0.2, 0.3, 0.4, 0, 0, 0.2 } }
local fine = finish(run(held_by, "lie(4)", 1, 64, beside))
for _, row in ipairs { { "lie(1)", 2 }, { "lie(2)", 4 }, { "lie(3)", 6 } } do
  near(order(held_by, row[1], 1, 6, beside, fine, finish), row[2], 0.15,
    row[1] .. ": a body and a point on a sphere")
end

---- a chain of links: its matrix is a band ----

local links = {}
for i = 1, 6 do links[2 * i - 1], links[2 * i] = SO3, dm.R(3) end
local chain = dm.system { Q = dm.product(table.unpack(links)),
  L = function(q, v)
    local sum = 0
    for i = 0, 5 do
      local k = 6 * i
      sum = sum + (v[k + 1] ^ 2 / 12 + v[k + 2] ^ 2 / 12 + v[k + 3] ^ 2 / 100 + v[k + 4] ^ 2
        + v[k + 5] ^ 2 + v[k + 6] ^ 2) / 2 - 9.81 * q[2 * i + 2][3]
    end
    return sum
  end,
  constraint = function(q)
    local out, last = {}, vector { 0, 0, 0 }
    for i = 1, 6 do
      local half = q[2 * i - 1] * vector { 0, 0, 0.5 }
      local joint = q[2 * i] + half - last
      for k = 1, 3 do out[#out + 1] = joint[k] end
      last = q[2 * i] - half
    end
    return out
  end }
local hanging, at = { q = {}, v = dm.zeros(36) }, vector { 0, 0, 0 }
for i = 1, 6 do
  local turn = SO3:exp { 0.5, 0.1 * sin(i), 0 }
  local half = turn * vector { 0, 0, 0.5 }
  hanging.q[2 * i - 1], hanging.q[2 * i], at = turn, at - half, at - 2 * half
end
local swung = finish(run(chain, "lie(3)", 0.5, 50, hanging))
near(order(chain, "lie(1)", 0.5, 25, hanging, swung, finish), 2, 0.15, "lie(1): a chain")
near(order(chain, "lie(2)", 0.5, 10, hanging, swung, finish), 4, 0.15, "lie(2): a chain")
local swings = chain:solver { rule = "lie(1)", h = 0.01 }
local whole = swings:run { q = hanging.q, v = hanging.v, steps = 2000, every = 20 }
local drift = whole:drift "energy"
ok(drift.largest < 0.01 and abs(drift.per_time) < 1e-4, "energy of a chain")
ok(whole:worst "constraint" < 1e-13 and swings:report().newton_per_step < 6, "and its joints")

---- controls are held over a step ----

local steered = dm.system { Q = SO3, L = function(_, v) return v:dot(v) / 2 end,
  control = function(_, _, t) return { t } end,
  force = function(_, _, _, u) return { 0, 0, u[1] } end }
near(run(steered, "lie(2)", 1, 4, { q = one, v = { 0, 0, 0 } }):velocity(2)[3],
  0.25 * (0.25 + 0.5 + 0.75), 1e-14, "a control")

---- multipliers at a state: those of the step, and the motion of the equations ----

for _, case in ipairs { { hung, tilt }, { mirrored, { q = tilt.q, v = V and
  run(mirrored, "lie(2)", 1e-3, 1, { q = tilt.q, v = tilt.v, project = true }):velocity(1) } } } do
  local system, state = case[1], case[2]
  local a = system:acceleration(state.q, state.v)
  local function velocity(h)
    return run(system, "lie(3)", h, 1, state):velocity(2) - run(system, "lie(3)", h, 1, state)
      :velocity(1)
  end
  local step = 1e-3 -- a difference without its part of order h
  local slope = velocity(step) * (2 / step) - velocity(2 * step) * (1 / (2 * step))
  ok(far(slope, a) < 1e-5, "acceleration at a state")
end
local recorded = hung:solver { rule = "lie(1)", h = 1e-4 }:run { q = tilt.q, v = tilt.v, steps = 2,
  record = { "lambda", "impulses" } }
near(recorded:column "impulse3"[2] / 1e-4, recorded:column "lambda3"[2], 1e-3,
  "lambda and impulses")
ok(far(hung:constraint(tilt.q), { 0, 0, 0 }) < 1e-15, "system:constraint of an element")
near(suslov:rolling(one, { 1, 0, 3 })[1], 3, 0, "system:rolling of an element")

---- many bodies ----

-- nine tops are more than 24 dimensions, and equal ones share their kernels: each moves as it does
-- alone, by the engine of one body
local inertia, factors, start = {}, {}, { q = {}, v = {} }
for k = 1, 9 do
  inertia[k] = k == 4 and { 2, 1, 1.5 } or { 1, 1.2, 0.6 }
  factors[k], start.q[k] = SO3, SO3:exp { 0.1 * k, 0.3, -0.2 }
  for i = 1, 3 do start.v[3 * k - 3 + i] = 0.3 * i - 0.1 * k end
end
local function kinetic(I, w, at)
  return (I[1] * w[at + 1] ^ 2 + I[2] * w[at + 2] ^ 2 + I[3] * w[at + 3] ^ 2) / 2
end
local many = dm.system { Q = dm.product(table.unpack(factors)), L = function(q, w)
  local sum = 0
  for k = 1, 9 do sum = sum + kinetic(inertia[k], w, 3 * k - 3) - q[k][3][3] - 0.2 * q[k][1][2] end
  return sum
end }
for _, rule in ipairs { "lie(1)", "lie(2)", "lie(2, lobatto(3), cayley)", "lie(1, gauss(1), pade(2))" } do
  local all, worst = many:solver { rule = rule, h = 0.05 }:run { q = start.q, v = start.v, steps = 40 }, 0
  for k = 1, 9 do
    local one_of = dm.system { Q = SO3, L = function(R, w)
      return kinetic(inertia[k], w, 0) - R[3][3] - 0.2 * R[1][2]
    end }
    local alone = one_of:solver { rule = rule, h = 0.05 }:run { q = start.q[k], steps = 40,
      v = { start.v[3 * k - 2], start.v[3 * k - 1], start.v[3 * k] } }
    worst = max(worst, far(all.q[41][k], alone.q[41]))
  end
  ok(worst < 1e-13, rule .. ": nine tops, one of them another, as each alone", worst)
end

---- what a run keeps ----

local solver = hung:solver { rule = "lie(2)", h = 0.05 }
local path = solver:run { q = tilt.q, v = tilt.v, steps = 100, record = { "impulses" } }
ok(#path.columns == 1 + 7 + 6 + 3, "impulses")
local file = os.tmpname()
solver:run { q = tilt.q, v = tilt.v, steps = 70 }:checkpoint(file)
near(far(dm.resume(file, hung):run { steps = 30 }.p[31], path.p[101]), 0, 0, "a run goes on")
os.remove(file)
local cloud = solver:ensemble { members = 3, steps = 100, q = function() return tilt.q end,
  v = function() return tilt.v end }
near(far(cloud.p[2], path.p[101]), 0, 0, "a member has the bits of a run")

---- refusals ----

raises("off the constraints: constraint 3", solver.run, solver, { q = off.q, v = off.v, steps = 1 })
raises("constraint 4 depends on those before it", run, dm.system { Q = pair, L = body,
  constraint = function(q)
    local g = held(q)
    return { g[1], g[2], g[3], g[1] + g[2] }
  end }, "lie(1)", 0.1, 1, tilt)
-- of two axes that are one but for rounding 1 - cos has no gradient, though that is no zero
local twist = SO3:exp { 0.3, 0.2, 0.1 }
local aligned = dm.system { Q = dm.product(SO3, SO3), L = function(_, v) return v:dot(v) / 2 end,
  constraint = function(q)
    local axis = vector { 0, 0, 1 }
    return { 1 - (q[1] * axis):dot(q[2] * axis) }
  end }
for _, project in ipairs { false, true } do
  raises("the gradient of constraint 1 is zero at this q", run, aligned, "lie(1)", 0.1, 1,
    { q = { twist, twist }, v = { 0.1, 0.2, 0.3, 0.1, 0.2, 0.5 }, project = project })
end
raises("turns the body by 4.0 rad; the chart ends at pi", run, hung, "lie(1)", 1, 1,
  { q = { one, vector { 0, 0, 1 } }, v = { 0, 0, 4, 0, 0, 0 } })
raises("lie(s) does", run, dm.system { Q = dm.SO(4), L = function(_, w) return w:dot(w) / 2 end,
  rolling = function(_, w) return w[1] end }, "gauss(2)", 1, 10, { q = dm.SO(4):identity(),
  v = { 0, 1, 0, 0, 0, 0 } })
raises("degenerate", run, dm.system { Q = pair, L = function(_, v) return v[1] ^ 2 end,
  constraint = held }, "lie(1)", 0.1, 1, tilt)

-- what is traced of a map other than exp outlives the model that asked for it first
local factor = 1
local spun = dm.system { Q = SO3, rolling = function(_, w) return { w[3] } end,
  L = function(_, w) return factor * w:dot(w) / 2 end }
for k = 1, 3 do
  factor = k
  near(run(spun, "lie(1, gauss(1), cayley)", 0.1, 1, { q = one, v = { 1, 0, 0 } }).p[2][1], k, 1e-14,
    "a model after another, by the Cayley map")
  collectgarbage()
end

tap.done()
