-- dm.curve by methods that are not linear in the values of f: Taylor methods by f:along, others; order, structure, bits, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, log, max = math.abs, math.cos, math.log, math.max

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
local round = { q = { 1, 0 }, v = { 0, 1.1 } }

local function bent(x, f, h)
  local k = f(x + h / 2 * f(x))
  return x + h * k * (1 + h * h * k:dot(k) / 10)
end
local function taylor(order)
  return function(x, f, h)
    local x1 = f(x)
    local x2 = f:along(x, x1)
    local y = x + h * x1 + h ^ 2 / 2 * x2
    if order == 2 then return y end
    local x3 = f:along(x, x1, x1) + f:along(x, x2)
    y = y + h ^ 3 / 6 * x3
    if order == 3 then return y end
    return y + h ^ 4 / 24 * (f:along(x, x1, x1, x1) + 3 * f:along(x, x1, x2) + f:along(x, x3))
  end
end
-- order 4 with one derivative: x + h x'(x) + h^2/6 (x''(x) + 2 x''(x + h/2 x' + h^2/8 x''))   (Chan & Tsai 2010)
local function two_derivatives(x, f, h)
  local k = f(x)
  local a = f:along(x, k)
  local y = x + h / 2 * k + h ^ 2 / 8 * a
  return x + h * k + h ^ 2 / 6 * (a + 2 * f:along(y, f(y)))
end
-- an exponential method: the velocity turned by a matrix that depends on f, here a rational function of it
local function rational(x, f, h)
  local k1 = f(x)
  local k2 = f(x + h * k1)
  local d = (k2 - k1):dot(k2 - k1)
  return x + h / 2 * (k1 + k2) / (1 + h * h * d)
end
local methods = { { "bent", bent, 2 }, { "rational", rational, 2 }, { "taylor(2)", taylor(2), 2 }, { "taylor(3)", taylor(3), 3 },
  { "taylor(4)", taylor(4), 4 }, { "two derivatives", two_derivatives, 4 } }

local function final(system, rule, start, n)
  local path = system:solver { rule = rule, h = 2 / n }:run { q = start.q, v = start.v, steps = n, every = n }
  return path.q[2], path.p[2], path
end
local tied = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] - 0.2 * q[1] ^ 2 end,
  constraint = function(q) return q:dot(q) - 1 end, force = function(_, v) return -0.3 * v:norm() * v end }
local skate = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[2] ^ 2 / 2 - 0.3 * q[1] ^ 2 end,
  rolling = function(q, v) return v[3] - q[2] * v[1] end }
-- a mass that varies, so that the acceleration is solved for in the graph
local cart = dm.system { Q = dm.R(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[2]) + cos(q[2]) - q[1] ^ 2 / 2
end, force = function(q, v) return { -0.3 * v[1] * q[2] ^ 2, -0.2 * v[2] } end }
local problems = { { "Kepler", kepler, round }, { "a force", cart, { q = { 0.3, 0.8 }, v = { 0.2, -0.4 } } },
  { "a constraint and a force", tied, { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 } } },
  { "rolling", skate, { q = { 0.3, 1, 0.2 }, v = { 0.7, 0.4, 0.7 } } } }
for _, problem in ipairs(problems) do
  local name, system, start = table.unpack(problem)
  local q, p = final(system, "gauss(4)", start, 200)
  for _, row in ipairs(methods) do
    local rule, n = dm.curve { method = row[2], order = row[3] }, row[3] > 2 and 20 or 60
    ok(rule.order == row[3] and rule.linear == false, row[1] .. ": its order is measured", rule.order)
    local q1, p1 = final(system, rule, start, n)
    local q2, p2 = final(system, rule, start, 2 * n)
    near(log(((q1 - q):norm() + (p1 - p):norm()) / ((q2 - q):norm() + (p2 - p):norm()), 2), row[3], 0.35,
      ("  %s: its variational form has order %d"):format(name, row[3]))
  end
  local rule = dm.curve { method = taylor(3), bias = 0.5 }
  local a, b = (final(system, rule, start, 10) - q):norm(), (final(system, rule, start, 20) - q):norm()
  near(log(a / b, 2), 4, 0.35, name .. ": to both sides order 3 becomes 4")
end

-- Taylor's method of order 2 on q'' = -q is the series of the flow; one step by hand: y from p0 = p1 - ..., see below
local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local h, Y, V = 0.3, 0.7, -0.4
local bundle = dm.bundle { system = spring, h = h, segments = dm.curve { method = taylor(2) } }
near(bundle:plus({ Y }, { V })[1], Y + h * V - h ^ 2 / 2 * Y, 1e-15, "a segment of Taylor's method is its series")
local half = { Y + h / 2 * V - h ^ 2 / 8 * Y, V - h / 2 * Y - h ^ 2 / 8 * V }
near(bundle:action({ Y }, { V }), h * (half[2] ^ 2 - half[1] ^ 2) / 2, 1e-15, "its action is that of a Gauss node")
-- a method that is linear, asked in a way that is not seen to be, makes the steps of its kind
local same = dm.curve { method = function(x, f, h) local k = f(x) return x + h * f(x + h / 2 * (k * k:dot(k) / k:dot(k))) end }
ok(same.linear == false and same.order == 2, "k (k.k)/(k.k) is not seen to be linear")

-- structure
for _, row in ipairs(methods) do
  local rule = dm.curve { method = row[2] }
  local solver = kepler:solver { rule = rule, h = 0.05 }
  ok(solver:symplecticity { q = { 0.4, 0 }, v = { 0, 2 }, steps = 20 } < 1e-14, row[1] .. " is symplectic")
  local path = solver:run { q = round.q, v = round.v, steps = 10000, every = 10 }
  ok(path:drift(path:momentum(dm.SO(2))).largest < 5e-14, "  keeps the angular momentum", path:drift(path:momentum(dm.SO(2))).largest)
  ok(abs(path:drift "energy".per_time) < 1e-7, "  and the energy without drift", path:drift "energy".per_time)
end
-- the exact derivative of a step against differences of order 6
local solver = kepler:solver { rule = dm.curve { method = taylor(3), bias = 0.4 }, h = 0.1 }
local D = solver:step_tangent { q = round.q, p = round.v }
local worst = 0
for j = 1, 4 do
  local sum = dm.vector { 0, 0, 0, 0 }
  for k, w in pairs { [-3] = -1, [-2] = 9, [-1] = -45, [1] = 45, [2] = -9, [3] = 1 } do
    local y = { round.q[1], round.q[2], round.v[1], round.v[2] }
    y[j] = y[j] + 5e-3 * k
    local q, p = solver:step { q = { y[1], y[2] }, p = { y[3], y[4] } }
    sum = sum + w / 0.3 * dm.vector { q[1], q[2], p[1], p[2] }
  end
  for i = 1, 4 do worst = max(worst, abs(sum[i] - D[i][j])) end
end
near(worst, 0, 1e-9, "the derivative of a step is exact")
local tangent = pendulum:solver({ rule = dm.curve { method = bent }, h = 0.1 }):tangent { q = { 1 }, p = { 0.3 }, steps = 5 }
near(tangent[1][1] * tangent[2][2] - tangent[1][2] * tangent[2][1], 1, 1e-14, "of five steps its determinant is 1")
raises("prolonged", function() solver:lyapunov { q = round.q, v = round.v, steps = 10 } end)
raises("constraints", function()
  tied:solver({ rule = dm.curve { method = bent }, h = 0.1 }):symplecticity { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, steps = 2 }
end)

-- bits: backends, checkpoints, ensembles
for _, problem in ipairs(problems) do
  local name, system, start = table.unpack(problem)
  local rule, ends = dm.curve { method = taylor(3), bias = 0.5 }, {}
  for i, backend in ipairs { "tape", "jit" } do
    local path = system:solver { rule = rule, h = 0.05, backend = backend }:run { q = start.q, v = start.v, steps = 60, every = 60 }
    ends[i] = ("%a %a %a"):format(path.q[2][1], path.q[2][2], path.p[2][2])
  end
  ok(ends[1] == ends[2], name .. ": tape and native code give the same bits", ends[1])
  local solver, file = system:solver { rule = rule, h = 0.05 }, os.tmpname()
  local whole = solver:run { q = start.q, v = start.v, steps = 60, every = 60 }
  solver:run { q = start.q, v = start.v, steps = 37, every = 37 }:checkpoint(file)
  raises("rule = the object", function() dm.resume(file, system) end)
  local rest = dm.resume(file, system, { rule = rule }):run { steps = 23, every = 23 }
  os.remove(file)
  ok(rest.q[#rest] == whole.q[2] and rest.p[#rest] == whole.p[2], "  a restart goes on bit for bit")
  local members = solver:ensemble { members = 3, q = function() return start.q end, v = function() return start.v end, steps = 60, threads = 2 }
  ok(members.q[2] == whole.q[2] and members.p[3] == whole.p[2], "  members of an ensemble are runs of their own")
end

-- time
local driven = dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 + (1 + 0.3 * cos(t)) * cos(q[1]) end }
local timed = dm.curve { order = 2, method = function(x, f, h, t)
  local k = f(x + h / 2 * f(x, t), t + h / 2)
  return x + h * k * (1 + h * h * k:dot(k) / 10)
end }
local swing = { q = { 1.2 }, v = { 0.5 } }
local goal = final(driven, "gauss(4)", swing, 200)
near(log((final(driven, timed, swing, 60) - goal):norm() / (final(driven, timed, swing, 120) - goal):norm(), 2), 2, 0.1, "with the time of its points: order 2")
-- Taylor methods along (f, 1): x'' = f_x f + f_t, and so on
local function timed_taylor(order)
  return dm.curve { order = order, method = function(x, f, h, t)
    local x1 = f(x, t)
    local x2 = f:along(x, t, x1)
    local y = x + h * x1 + h ^ 2 / 2 * x2
    if order == 2 then return y end
    local x3 = f:along(x, t, x1, x1) + f:along(x, t, { x2, 0 })
    y = y + h ^ 3 / 6 * x3
    if order == 3 then return y end
    return y + h ^ 4 / 24 * (f:along(x, t, x1, x1, x1) + 3 * f:along(x, t, x1, { x2, 0 }) + f:along(x, t, { x3, 0 }))
  end }
end
for order = 2, 4 do
  local rule = timed_taylor(order)
  local coarse, fine = (final(driven, rule, swing, 30) - goal):norm(), (final(driven, rule, swing, 60) - goal):norm()
  near(log(coarse / fine, 2), order, 0.25, ("Taylor's method with the time, order %d"):format(order))
end
-- where nothing depends on t it is the one that does not ask
local still, told = final(kepler, dm.curve { method = taylor(3) }, round, 20), final(kepler, timed_taylor(3), round, 20)
near((still - told):norm(), 0, 1e-14, "and without a time in L that of f:along(x, u)")
raises("write f(x, t) and f:along(x, t, u)", function() final(driven, dm.curve { method = taylor(2) }, swing, 10) end)
raises("write f(x, t)", function() final(driven, dm.curve { method = bent }, swing, 10) end)

-- misuse
local function bad(words, method, more)
  raises(words, function()
    local options = more or {}
    options.method = method
    return dm.curve(options)
  end)
end
bad("order 2 only", taylor(2), { order = 3 })
bad("a direction", function(x, f, h) return x + h * f:along(x) end)
bad("direction of f:along must be a vector", function(x, f, h) return x + h * f(x) + h * h * f:along(x, 3) end)
bad("{ u, rate } needs a time", function(x, f, h) local k = f(x) return x + h * k + h * h * f:along(x, { k, 1 }) end)
bad("direction of f:along must be a vector", function(x, f, h, t) return x + h * f(x, t) + h * h * f:along(x, t, { 1 }) end)
bad("at most 4 directions", function(x, f, h) local k = f(x) return x + h * k + h ^ 6 * f:along(x, k, k, k, k, k) end)
bad("not consistent", function(x, f, h) local k = f(x) return x + h * f:along(x, k) end)
bad("not consistent", function(x, f, h) return x / 0 + h * f(x) * f(x):norm() end)
bad("more than 40 times", function(x, f, h) for _ = 1, 41 do x = x + h * f:along(x, x) end return x end)
bad("as many entries as x", function(x, f, h) return { (x + h * f(x) * x[1])[1] } end)
bad("what the method returns", function(x, f, h) local k = f(x) return { k[1] * k[2], 2 } end)
-- a method for one dim Q only says so when it meets another
raises("out of range", function()
  local narrow = dm.curve { method = function(x, f, h)
    local k = f(x)
    local y = x + h * k * (1 + h * k:dot(k))
    return { y[1], y[2], y[3], y[4] }
  end }
  pendulum:solver { rule = narrow, h = 0.1 }
end)
-- steps too large end with the path so far
local steep = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.exp(q[1]) end }
local _, failure = pcall(function() return steep:solver { rule = dm.curve { method = taylor(3) }, h = 2 }:run { q = { -9 }, v = { 0 }, steps = 1000 } end)
ok(failure.code ~= nil and #failure.path == failure.step, "steps too large: a failure with the path", failure)

-- rotations in quaternions and matrices: derivatives along a direction are one sweep, not a Jacobian at each level
local function spin(q, v)
  return q[1] * v[2] - q[2] * v[1] - q[3] * v[4] + q[4] * v[3], q[1] * v[3] - q[3] * v[1] - q[4] * v[2] + q[2] * v[4],
    q[1] * v[4] - q[4] * v[1] - q[2] * v[3] + q[3] * v[2]
end
local function columns_apart(q)
  local out = {}
  for i = 0, 6, 3 do
    for j = i, 6, 3 do
      out[#out + 1] = q[i + 1] * q[j + 1] + q[i + 2] * q[j + 2] + q[i + 3] * q[j + 3] - (i == j and 1 or 0)
    end
  end
  return out
end
local bodies = {
  { "a body in quaternions", dm.system { Q = dm.R(4), constraint = function(q) return { q:dot(q) - 1 } end, L = function(q, v)
    local a, b, c = spin(q, v)
    return 2 * a ^ 2 + 4 * b ^ 2 + 6 * c ^ 2
  end }, { 1, 0, 0, 0 }, { 0, 0.5, 0.1, 0.2 } },
  { "a top in a matrix", dm.system { Q = dm.R(9), constraint = columns_apart, L = function(q, v)
    local T = 0
    for i = 1, 9 do T = T + v[i] ^ 2 / 2 * (1 + (i - 1) // 3) end
    return T - q[9]
  end }, { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, { 0, 0.3, 0, -0.3, 0, 0.1, 0, -0.1, 0 } },
}
for _, b in ipairs(bodies) do
  local goal, off = b[2]:solver { rule = "gauss(4)", h = 0.02 }:run { q = b[3], v = b[4], steps = 40, every = 40 }.q[2], {}
  for k = 1, 2 do
    local path = b[2]:solver { rule = dm.curve { method = taylor(3) }, h = 0.08 / k }:run { q = b[3], v = b[4], steps = 10 * k, every = 10 * k }
    off[k] = (path.q[2] - goal):norm()
  end
  ok(math.abs(math.log(off[1] / off[2], 2) - 3) < 0.2, "taylor(3), " .. b[1], off[1] .. " " .. off[2])
end


---- a checkpoint is of one method: the end of the step counts, beyond f and its derivatives ----
local function ending(c)
  return dm.curve { method = function(x, f, h)
    local k = f(x)
    local a, n, e = f:along(x, k), #x, {}
    for i = 1, n do e[i] = x[i] + h * k[i] + h ^ 2 / 2 * a[i] end
    e[n] = e[n] + c * h ^ 3 * a[n]
    return dm.vector(e)
  end }
end
local swinging = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + dm.cos(q[1]) end }
local state = os.tmpname()
swinging:solver { rule = ending(1), h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 10 }:checkpoint(state)
ok(dm.resume(state, swinging, { rule = ending(1) }):run { steps = 1 }.steps == 1, "the same method goes on")
raises("not the one of the checkpoint", function() dm.resume(state, swinging, { rule = ending(0.25) }):run { steps = 1 } end)
os.remove(state)
tap.done()
