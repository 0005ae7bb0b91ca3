-- masses that are singular by themselves and regular with the constraints (mech/saddle.h): a massless slider, a body by its quaternion against
-- Euler's equations, a projected kinetic energy, rolling; each rule that knows constraints, its order measured
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, log, max, sin = math.abs, math.cos, math.log, math.max, math.sin

-- errors at h and h/2, and the order between them
local function order_of(rule, at, h)
  local e = { at(rule, h), at(rule, h / 2) }
  return log(e[1] / e[2]) / log(2), e[2]
end
local orders = { midpoint = 2, trapezoidal = 2, ["gauss(2)"] = 4, ["gauss(3)"] = 6, ["lobatto(2)"] = 2, ["lobatto(3)"] = 4, ["lobatto(4)"] = 6,
  ["galerkin(2, lobatto(3))"] = 4, rattle = 2, shake = 2, ["yoshida(4, rattle)"] = 4, ["suzuki(4, midpoint)"] = 4 }

-- q2 weighs nothing and rides on q2 = q1^2/2: an oscillator, q1 = cos t
local slider = dm.system { Q = dm.R(2), L = function(q, v) return v[1] ^ 2 / 2 - q[2] end, constraint = function(q) return q[2] - q[1] ^ 2 / 2 end }
local function slide(rule, h)
  local path = slider:solver { rule = rule, h = h }:run { q = { 1, 0.5 }, v = { 0, 0 }, t = 2 }
  return abs(path.q[#path][1] - cos(2))
end
for rule, expected in pairs(orders) do
  local order, error = order_of(rule, slide, expected > 4 and 0.2 or 0.1)
  ok(abs(order - expected) < 0.2, rule .. " on the massless slider has its order", order .. ", error " .. error)
end
local path = slider:solver { rule = "gauss(3)", h = 0.05 }:run { q = { 1, 0.5 }, v = { 0, 0 }, steps = 1000, record = { "energy", "lambda" } }
ok(path:worst "constraint" < 1e-15 and path:drift("energy").largest < 1e-10, "energy and constraint are kept")
local largest = 0
for i = 1, #path do largest = max(largest, abs(path.p[i][2])) end
near(largest, 0, 1e-14, "the massless momentum is 0 on the way")
near(path.lambda[1][1], 1, 1e-14, "its multiplier is its weight")

-- masses have any unit
for _, m in ipairs { 1e-12, 1e-27, 1e20 } do
  local function scaled(k)
    return dm.system { Q = dm.R(2), constraint = function(q) return q[2] - q[1] - q[1] ^ 2 / 10 end,
      L = function(q, v) return k * ((2 + dm.cos(q[1])) * v[1] ^ 2 / 2 - q[1] ^ 2) end }
  end
  local start = { q = { 0.1, 0.101 }, v = { 0.3, 0.306 }, steps = 50 }
  for _, rule in ipairs { "midpoint", "gauss(2)", "rattle" } do
    local one = scaled(1):solver { rule = rule, h = 0.02 }:run(start)
    local fine, path = pcall(function()
      return scaled(m):solver { rule = rule, h = 0.02 }:run(start)
    end)
    local off = fine and (path.q[51] - one.q[51]):norm() or path
    ok(fine and off < 1e-13, ("%s with a slider beside a mass of %g"):format(rule, m), off)
  end
end

-- what a script asks of the system is L as it is given
local s = slider:structure()
ok(s.saddle and s.separable and s.constant_mass, "structure tells of the saddle")
near(slider:mass({ 1, 0.5 }, { 0, 0 })[2][2], 0, 0, "the mass is that of L")
near(slider:energy({ 1, 0.5 }, { 1, 0 }), 1, 0, "the energy off the constraint is that of L")
near(slider:velocity({ 1, 0.5 }, { 3, 0 })[2], 3, 1e-14, "the velocity of a momentum is along the constraint")
ok(not dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end, constraint = function(q) return q[2] end }:structure().saddle,
  "a regular mass is none")

-- a free body, T = omega . I omega / 2 with omega = 2 Im(conj(q) v), rank 3 of 4; reference: Euler's equations by rk4 in small steps
local I = { 1, 2, 3.5 }
local function T(q, v)
  local a, b, c, d, A, B, C, D = q[1], q[2], q[3], q[4], v[1], v[2], v[3], v[4]
  local x, y, z = 2 * (a * B - b * A - c * D + d * C), 2 * (a * C + b * D - c * A - d * B), 2 * (a * D - b * C + c * B - d * A)
  return (I[1] * x ^ 2 + I[2] * y ^ 2 + I[3] * z ^ 2) / 2
end
local function euler(y)
  local a, b, c, d, x, w, z = table.unpack(y)
  return { (-b * x - c * w - d * z) / 2, (a * x + c * z - d * w) / 2, (a * w - b * z + d * x) / 2, (a * z + b * w - c * x) / 2,
    (I[2] - I[3]) / I[1] * w * z, (I[3] - I[1]) / I[2] * z * x, (I[1] - I[2]) / I[3] * x * w }
end
local function moved(y, k, h)
  local out = {}
  for i = 1, 7 do out[i] = y[i] + h * k[i] end
  return out
end
local reference, n = { 1, 0, 0, 0, 0.7, -0.4, 1.1 }, 4000
for _ = 1, n do
  local h = 2 / n
  local k1 = euler(reference); local k2 = euler(moved(reference, k1, h / 2)); local k3 = euler(moved(reference, k2, h / 2))
  local k4 = euler(moved(reference, k3, h))
  for i = 1, 7 do reference[i] = reference[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]) end
end
local start = { q = { 1, 0, 0, 0 }, v = { 0, 0.35, -0.2, 0.55 } }
local function with(more)
  for key, value in pairs(start) do more[key] = more[key] or value end
  return more
end
local body = dm.system { Q = dm.R(4), L = T, constraint = function(q) return q:dot(q) - 1 end }
local on_sphere = dm.system { Q = dm.S(3), L = T }
local function turn(rule, h)
  local path, worst = body:solver { rule = rule, h = h }:run(with { t = 2 }), 0
  for i = 1, 4 do worst = max(worst, abs(path.q[#path][i] - reference[i])) end
  return worst
end
for rule, expected in pairs(orders) do
  local order, error = order_of(rule, turn, 0.1)
  ok(abs(order - expected) < 0.25, rule .. " on the body has its order", order .. ", error " .. error)
end
local a, b = body:solver { rule = "gauss(2)", h = 0.05 }:run(with { steps = 40 }), on_sphere:solver { rule = "gauss(2)", h = 0.05 }:run(with { steps = 40 })
ok(a.q[41] == b.q[41] and a.p[41] == b.p[41], "on dm.S(3) it is the same body, bit for bit")

-- the machinery around: tangents, ensembles, checkpoints, backends, singular places, starts
for _, rule in ipairs { "gauss(2)", "lobatto(3)", "midpoint", "rattle", "yoshida(4, rattle)" } do
  local solver = body:solver { rule = rule, h = 0.05 }
  local defect = solver:symplecticity(with { steps = 10 })
  ok(defect < 1e-15, rule .. " is symplectic by the exact tangent", defect)
  ok(solver:reversal(with { steps = 10 }) < 1e-13, rule .. " goes back")
end
local solver = body:solver { rule = "gauss(2)", h = 0.05 }
local all = solver:ensemble { members = 5, steps = 20, q = function() return start.q end, v = function(i) return { 0, 0.1 * i, -0.2, 0.5 } end }
for i = 1, 5 do
  local one = solver:run { q = start.q, v = { 0, 0.1 * i, -0.2, 0.5 }, steps = 20 }
  ok(dm.vector(all.q[i]) == dm.vector(one.q[21]), "member " .. i .. " has the bits of a run of its own")
end
local file = os.tmpname()
solver:run(with { steps = 20 }):checkpoint(file)
local later, whole = dm.resume(file, body):run { steps = 20 }, solver:run(with { steps = 40 })
ok(later.q[#later] == whole.q[41] and later.p[#later] == whole.p[41], "a run goes on from a checkpoint, bit for bit")
os.remove(file)
for _, backend in ipairs { "tape", "jit" } do
  local one = body:solver { rule = "gauss(2)", h = 0.05, backend = backend }:run(with { steps = 40 })
  ok(one.q[41] == whole.q[41], "the same bits by " .. backend)
end
near(solver:singularities(with { steps = 30 }).worst, 3.5, 1e-9, "the condition of the mass is that on the tangent space, I3/I1")
near(slider:solver({ rule = "gauss(2)", h = 0.05 }):singularities({ q = { 1, 0.5 }, v = { 0, 0 }, steps = 30 }).worst, 1, 1e-12, "and of one velocity 1")
path = slider:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 1, 0.6 }, v = { 0.3, 0 }, steps = 1, project = true }
near(slider:constraint(path.q[1])[1], 0, 1e-15, "a start is moved onto the constraint")

-- a kinetic energy of the projected velocity is singular on the sphere alone, where the bob moves as ever
local function bob(kinetic)
  local system = dm.system { Q = dm.S(2), L = function(q, v) return kinetic(q, v) - q[3] end }
  local path = system:solver { rule = "gauss(3)", h = 0.02 }:run { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, t = 2 }
  return path.q[#path], system:structure().saddle
end
local projected, found = bob(function(q, v) local w = v - q:dot(v) * q; return w:dot(w) / 2 end)
local plain, none = bob(function(_, v) return v:dot(v) / 2 end)
ok(found and not none, "the projected one is singular on the sphere")
near((projected - plain):norm(), 0, 1e-11, "and moves like the plain one")

-- rolling alone: a massless steering angle that is turned at rate 1
local skate = dm.system { Q = dm.R(3), L = function(q, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 - 0.3 * q[1] end,
  rolling = function(q, v) return { v[3] - 1, v[1] * sin(q[3]) - v[2] * cos(q[3]) } end }
-- speed u' = -0.3 cos t from 1, x' = u cos t
local function x_at(t) return sin(t) - 0.3 * sin(t) ^ 2 / 2 end
for rule, expected in pairs { midpoint = 2, ["gauss(2)"] = 4, ["gauss(3)"] = 6, ["lobatto(3)"] = 4 } do
  local order, error = order_of(rule, function(r, h)
    local path = skate:solver { rule = r, h = h }:run { q = { 0, 0, 0 }, v = { 1, 0, 1 }, t = 1 }
    return abs(path.q[#path][1] - x_at(1))
  end, 0.1)
  ok(abs(order - expected) < 0.3, rule .. " on a massless steering angle has its order", order .. ", error " .. error)
end

-- what no constraint determines stays refused
raises("degenerate", function()
  dm.system { Q = dm.R(2), L = function(_, v) return v[1] ^ 2 / 2 end, constraint = function(q) return q[1] end }
    :solver({ rule = "midpoint", h = 0.1 }):run { q = { 0, 0 }, v = { 0, 0 }, steps = 1 }
end)

-- a row that vanishes at the start leaves a massless coordinate without a mass: that is said
local vanishing = dm.system { Q = dm.R(3), L = function(_, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 end, rolling = function(q, v) return q[1] * v[3] end }
tap.raises("a row of the constraints, which alone make d2L/dv2 regular, zero there", function()
  vanishing:solver { rule = "midpoint", h = 0.05 }:run { q = { 0, 0, 0 }, v = { 0.5, 1, 0 }, steps = 5 }
end)
tap.done()
