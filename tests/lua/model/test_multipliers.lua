-- forces of constraints: multipliers at states against closed forms, impulses of steps against the discrete equations, what is recorded
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, sin, cos, log = math.abs, math.max, math.sin, math.cos, math.log
local g = 9.81

local function rod(l, mass)
  return dm.system { Q = dm.R(2), L = function(q, v) return mass * (v:dot(v) / 2 - g * q[2]) end,
    constraint = function(q) return q:norm() - l end }
end

-- tension of a pendulum, m (g cos theta + l theta'^2), which pulls inwards: -lambda
local l, m = 0.8, 1.7
local pendulum = rod(l, m)
do
  local q, v = { l * sin(0.6), -l * cos(0.6) }, { 1.3 * cos(0.6), 1.3 * sin(0.6) }
  near(pendulum:multipliers(q, v)[1], -m * (g * cos(0.6) + 1.3 ^ 2 / l), 1e-12, "tension of a rod at a state")
  local a = pendulum:acceleration(q, v)
  near(a[1] * v[1] + a[2] * v[2], -g * v[2], 1e-12, "acceleration along the circle is that of the weight")
  near(a[1] * q[1] + a[2] * q[2], -1.3 ^ 2, 1e-12, "and towards the middle v^2/l")
end

-- the same pendulum by its angle, with a tight rule: another road to the tension at t = 1
local function tension_by_angle(t)
  local angle = dm.system { Q = dm.R(1), L = function(q, w) return w[1] ^ 2 / 2 + g / l * cos(q[1]) end }
  local path = angle:solver({ rule = "gauss(6)", h = 0.01 }):run { q = { 2 }, v = { 0 }, t = t }
  return m * (g * cos(path.q[#path][1]) + l * path:velocity(#path)[1] ^ 2)
end
local exact = tension_by_angle(1)
for rule, order in pairs { rattle = 2, ["gauss(1)"] = 2, ["gauss(2)"] = 4, ["gauss(3)"] = 6, ["lobatto(3)"] = 4, ["yoshida(4, rattle)"] = 4 } do
  local errors = {}
  for i, h in ipairs { 0.02, 0.01 } do
    local path = pendulum:solver({ rule = rule, h = h }):run { q = { l * sin(2), -l * cos(2) }, v = { 0, 0 }, t = 1, record = { "lambda" } }
    errors[i] = abs(-path.lambda[#path][1] - exact)
  end
  near(log(errors[1] / errors[2], 2), order, 0.25, rule .. ": the tension has the order of the rule")
end

-- what is recorded is what the states say; columns, drift, plots, files, watched rows, events, ensembles know it
local start = { q = { 0, -l }, v = { 4.9, 0 } }
local solver = pendulum:solver { rule = "gauss(2)", h = 0.01 }
local function run_with(options)
  options.q, options.v, options.steps = start.q, start.v, options.steps or 60
  return solver:run(options)
end
local plain, path = run_with {}, run_with { record = { "lambda", "energy", speed = function(_, v) return v:norm() end } }
local M = plain:multipliers()
do
  ok(#path.lambda == 61 and #path.lambda[1] == 1 and #path.columns == 8, "columns beside q and p: lambda, energy, speed")
  local worst, same = 0, true
  for i = 1, #plain do
    worst = max(worst, abs(M[i][1] - path.lambda[i][1]))
    same = same and path.q[i][1] == plain.q[i][1] and path.p[i][2] == plain.p[i][2]
  end
  ok(worst == 0, "path:multipliers() has the bits of what the run recorded", worst)
  ok(same, "recording does not change the run")
  near(path:column "speed"[61], plain:velocity(61):norm(), 1e-14, "functions beside q and p")
  ok(path:energy()[61] == plain:energy()[61] and path:column "lambda"[5] == path.lambda[5][1], "columns by name, energy as before")
  ok(path:drift "lambda".largest > 1, "drift of a recorded column")
  local file = os.tmpname()
  path:csv(file)
  local read = dm.load(file)
  ok(read.lambda[61] == path.lambda[61][1], "csv knows the column")
  local npy = file .. ".npy"
  run_with { record = { "lambda" }, file = npy }
  ok(dm.load(npy).lambda[61] == path.lambda[61][1], "and files of rows")
  os.remove(file)
  os.remove(npy)
  local watched = run_with { watch = { "lambda", "q1" } }
  ok(watched:column "lambda"[31] == path.lambda[31][1] and watched:column "q1"[31] == path.q[31][1], "watched rows")
  ok(path:series("t", "lambda").ylabel == "lambda" and path:series("t", "q2").yplace and not path:series("t", "p1").yplace, "series know their places")
  local many = solver:ensemble { members = 3, q = function() return { 0, -l } end, v = function(i) return { 1 + i, 0 } end, steps = 20, watch = { "lambda" } }
  near(many:path(2):column "lambda"[1], -m * (g + 9 / l), 1e-12, "members of an ensemble")
  local slack = run_with { steps = 200, events = { slack = { g = function(q, v) return pendulum:multipliers(q, v)[1] end, stop = true } } }
  local height = (2 * g * l - 4.9 ^ 2) / (3 * g * l)
  near(-slack.events[1].q[2] / l, height, 1e-7, "a rope goes slack where cos theta = (2 g l - v^2) / 3 g l")
end

-- Atwood's machine: one rope, tension 2 m1 m2 g / (m1 + m2)
local atwood = dm.system { Q = dm.R(2), L = function(q, v) return (2 * v[1] ^ 2 + 3 * v[2] ^ 2) / 2 - g * (2 * q[1] + 3 * q[2]) end,
  constraint = function(q) return q[1] + q[2] + 4 end }
near(atwood:multipliers({ -1, -3 }, { 0.2, -0.2 })[1], 2 * 2 * 3 * g / 5, 1e-12, "Atwood's machine")
near(atwood:acceleration({ -1, -3 }, { 0.2, -0.2 })[1], g / 5, 1e-12, "and how fast the heavier one falls")

-- a bead on the parabola y = x^2/2: y'' = x'^2 + x x'', so lambda = m (g + x'^2) / (1 + x^2)
local wire = dm.system { Q = dm.R(2), L = function(q, v) return m * (v:dot(v) / 2 - g * q[2]) end,
  constraint = function(q) return q[2] - q[1] ^ 2 / 2 end }
near(wire:multipliers({ 0.7, 0.245 }, { 1.1, 0.77 })[1], m * (g + 1.21) / 1.49, 1e-12, "a bead on a wire")

-- a straight wire that turns with the rate w: r = r0 cosh w t, and the wire pushes with the Coriolis force 2 m w r'
local w = 1.3
local turning = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end,
  constraint = function(q, t) return q[2] * cos(w * t) - q[1] * sin(w * t) end }
local out = turning:solver({ rule = "gauss(3)", h = 0.02 }):run { q = { 1, 0 }, v = { 0, w }, t = 1, record = { "lambda" } }
near(out.lambda[51][1], 2 * w ^ 2 * (math.exp(w) - math.exp(-w)) / 2, 1e-9, "a wire that turns: time in the constraint")

-- a disc that rolls upright in circles: friction is the centripetal force
local disc = dm.system { Q = dm.R(4), coordinates = { "x", "y", "phi", "theta" },
  L = function(_, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 + 0.3 * v[3] ^ 2 + 0.4 * v[4] ^ 2 end,
  rolling = function(q, v) return { v[1] - 0.5 * cos(q[3]) * v[4], v[2] - 0.5 * sin(q[3]) * v[4] } end }
for _, rule in ipairs { "midpoint", "gauss(2)" } do
  local p = disc:solver({ rule = rule, h = 0.01 }):run { q = { 0, 0, 0, 0 }, v = { 1, 0, 0.7, 2 }, t = 1, record = { "lambda" } }
  local F, phi = p.lambda[#p], p.q[#p][3]
  near(F[1], -0.7 * sin(phi), 1e-12, rule .. ": friction of a rolling disc, x")
  near(F[2], 0.7 * cos(phi), 1e-12, "friction of a rolling disc, y")
end
-- down a slope: friction m a_s I / (I + m R^2) for the pull a_s along it
local slope = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + 0.4 * 0.25 * v[2] ^ 2) / 2 + 3 * q[1] end,
  rolling = function(_, v) return v[1] - 0.5 * v[2] end }
near(slope:multipliers({ 0, 0 }, { 1, 2 })[1], -3 * 0.4 / 1.4, 1e-12, "a ball down a slope")
-- reactions as given, forces, a control: v1 is held, so lambda = -f1, and the second row pushes v2 with half of it
local given = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, rolling = function(_, v) return v[1] - 1 end,
  reaction = function() return { { 1, 0.5 } } end, control = function(_, v) return v[2] end,
  force = function(q, v, _, u) return { -3 * v[1] + q[2], u[1] } end }
near(given:multipliers({ 0, 2 }, { 1, 0.4 })[1], 1, 1e-12, "a given row of reactions, a force")
near(given:acceleration({ 0, 2 }, { 1, 0.4 })[2], 0.4 + 0.5, 1e-12, "and a control")

-- systems without ties, and on a sphere
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
near(kepler:acceleration({ 3, 4 }, { 1, 0 })[2], -4 / 125, 1e-15, "acceleration without constraints")
local sphere = dm.system { Q = dm.S(2), L = function(q, v) return v:dot(v) / 2 - g * q[3] end }
near(2 * sphere:multipliers({ 0, 0, -1 }, { 1.5, 0, 0 })[1], -(g + 2.25), 1e-12, "a sphere: |q|^2 - 1, whose gradient is 2 q")

-- a chain that hangs at rest: every rod bears what is below it; accelerations and multipliers are more than 64
do
  local N, hanging, still = 24, {}, {}
  for i = 1, N do hanging[2 * i - 1], hanging[2 * i], still[2 * i - 1], still[2 * i] = 0, -i, 0, 0 end
  local chain = dm.system { Q = dm.R(2 * N), L = function(q, v)
    local L = 0
    for i = 1, N do L = L + (v[2 * i - 1] ^ 2 + v[2 * i] ^ 2) / 2 - g * q[2 * i] end
    return L
  end, constraint = function(q)
    local out, x, y = {}, 0, 0
    for i = 1, N do
      out[i] = ((q[2 * i - 1] - x) ^ 2 + (q[2 * i] - y) ^ 2 - 1) / 2
      x, y = q[2 * i - 1], q[2 * i]
    end
    return out
  end }
  local p = chain:solver({ rule = "rattle", h = 0.01 }):run { q = hanging, v = still, steps = 3, record = { "lambda", "impulses" } }
  local worst = 0
  for i = 1, N do worst = max(worst, abs(p.lambda[3][i] + (N + 1 - i) * g), abs(p.impulses[3][i] / 0.01 + (N + 1 - i) * g)) end
  ok(worst < 1e-10 and #p.columns == 1 + 6 * N, "a hanging chain: tensions and impulses of all rods", worst)
  ok(chain:acceleration(hanging, still):norm() < 1e-11, "and nothing moves")
end

-- numbers that L uses may change; params
local pull = 1
local changing = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - pull * q[2] end, constraint = function(q) return q:norm() - 1 end }
near(changing:multipliers({ 0, -1 }, { 0, 0 })[1], -1, 1e-14, "multipliers as L is")
pull = 2
near(changing:multipliers({ 0, -1 }, { 0, 0 })[1], -2, 1e-14, "and as L has become")
local with = dm.system { Q = dm.R(2), params = { g = 3, l = 1 }, L = function(q, v, _, p) return v:dot(v) / 2 - p.g * q[2] end,
  constraint = function(q, _, p) return q:norm() - p.l end }
near(with:multipliers({ 0, -1 }, { 1, 0 })[1], -4, 1e-13, "params")

-- impulses: what the discrete equations have at a node, D2 Ld(q0, q1) + D1 Ld(q1, q2) + G^T I = 0 (Leok 2.8.1)
local free = dm.system { Q = dm.R(2), L = pendulum.L }
for _, rule in ipairs { "midpoint", "trapezoidal" } do
  local Ld = dm.discrete_lagrangian(free, { rule = rule, h = 0.02 })
  local p = pendulum:solver({ rule = rule, h = 0.02 }):run { q = { 0, -l }, v = { 2, 0 }, steps = 20, record = { "impulses" } }
  local worst = 0
  for i = 2, #p - 1 do
    local rest = Ld:legendre_plus(p.q[i - 1], p.q[i]) - Ld:legendre_minus(p.q[i], p.q[i + 1]) + p.impulses[i][1] * p.q[i] / p.q[i]:norm()
    worst = max(worst, rest:norm())
  end
  ok(worst < 2e-13, rule .. ": impulses are the multipliers of the discrete equations", worst)
  local half = p.p[1] - Ld:legendre_minus(p.q[1], p.q[2]) + p.impulses[1][1] * p.q[1] / l
  ok(half:norm() < 2e-13, "that of the start is what its step needs alone", half:norm())
end
-- rolling too: reactions along E = dphi/dv at the node (Cuell-Patrick)
do
  local Ld = dm.discrete_lagrangian(dm.system { Q = dm.R(4), L = disc.L }, { rule = "midpoint", h = 0.05 })
  local p = disc:solver({ rule = "midpoint", h = 0.05 }):run { q = { 0, 0, 0.3, 0 }, v = { cos(0.3), sin(0.3), 0.7, 2 }, steps = 20, record = { "impulses" } }
  local worst = 0
  for i = 2, #p - 1 do
    local phi, I = p.q[i][3], p.impulses[i]
    local push = dm.vector { I[1], I[2], 0, -0.5 * (cos(phi) * I[1] + sin(phi) * I[2]) }
    worst = max(worst, (Ld:legendre_plus(p.q[i - 1], p.q[i]) - Ld:legendre_minus(p.q[i], p.q[i + 1]) + push):norm())
  end
  ok(worst < 2e-13, "impulses of a rolling disc are those of the discrete equations", worst)
end
-- over the time that a node stands for they are forces: order 2 for nodes at the ends, for all rules of one stage; weights of the ends of s tie intervals
for rule, weight in pairs { rattle = 1, shake = 1, midpoint = 1, trapezoidal = 1, ["gauss(2)"] = 1 / 3, ["lobatto(3)"] = 1 / 3, ["gauss(3)"] = 1 / 6 } do
  local errors = {}
  for i, h in ipairs { 0.02, 0.01 } do
    local p = pendulum:solver({ rule = rule, h = h }):run { q = { 0, -l }, v = { 2, 0 }, t = 0.4, record = { "impulses", "lambda" } }
    local k = math.floor(0.2 / h + 0.5) + 1
    errors[i] = abs(p.impulses[k][1] / (weight * h) - p.lambda[k][1])
  end
  ok(errors[2] < 0.01 and log(errors[1] / errors[2], 2) > 1.8, rule .. ": impulses over their time are forces, to order 2 and more",
    ("%.2g %.2g"):format(errors[1], errors[2]))
end
-- inner ones too; rows that are kept seldom have those of their node; reversed steps have the same
do
  local p = solver:run { q = start.q, v = start.v, steps = 40, record = { "impulses", "inner" } }
  local seldom = solver:run { q = start.q, v = start.v, steps = 40, every = 8, record = { "impulses", "inner" } }
  ok(#p.columns == 7 and p.columns[7] == "inner1", "one inner point of two stages", table.concat(p.columns, " "))
  near(p:column "inner1"[20] / (2 / 3 * 0.01), (p:multipliers()[20][1] + p:multipliers()[21][1]) / 2, 2e-2, "inner impulses are forces in the middle")
  ok(seldom.impulses[3][1] == p.impulses[17][1] and seldom:column "inner1"[3] == p:column "inner1"[17], "rows of one state in eight")
  local back = solver:run { q = p.q[41], p = -p.p[41], steps = 40, record = { "impulses", "inner" } }
  local worst = 0
  for i = 1, 41 do worst = max(worst, abs(back.impulses[i][1] - p.impulses[42 - i][1])) end
  for i = 1, 40 do worst = max(worst, abs(back:column "inner1"[i] - p:column "inner1"[41 - i])) end
  ok(worst < 1e-12, "run back in time they come in turn, ends too", worst)
end

-- what goes wrong
raises("no constraint", function() kepler:multipliers({ 1, 0 }, { 0, 1 }) end)
raises("no constraint", function() kepler:solver({ rule = "verlet", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 1, record = { "lambda" } } end)
raises("no constraint", function() kepler:solver({ rule = "verlet", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 1, record = { "impulses" } } end)
raises("must be 2 numbers", function() pendulum:multipliers({ 1 }, { 0, 1 }) end)
raises("must be 2 numbers", function() pendulum:acceleration({ 1, 0 }) end)
raises("did not record it", function() return plain.lambda end)
raises("did not record it", function() return path.impulses end)
raises("not both", function() run_with { record = { "lambda" }, watch = { "lambda" } } end)
raises("made of several steps", function()
  pendulum:solver({ rule = "yoshida(4, rattle)", h = 0.01 }):run { q = start.q, v = start.v, steps = 1, record = { "impulses" } }
end)
raises("inside of them", function() solver:run { q = start.q, v = start.v, at = { 0.1 }, record = { "impulses" } } end)
raises("no column 'tension'", function() run_with { record = { "tension" } } end)
raises("already", function() run_with { record = { "q1" } } end)
raises("is empty", function() run_with { record = {} } end)
raises("must be a table", function() run_with { record = "lambda" } end)
raises("does not go with 'vary'", function()
  with:solver({ rule = "midpoint", h = 0.01 }):ensemble { members = 2, q = function() return { 0, -1 } end, v = function() return { 1, 0 } end, steps = 2, watch = { "lambda" },
    vary = { g = { 1, 2 } } }
end)
raises("independent", function()
  dm.system { Q = dm.R(2), L = free.L, constraint = function(q) return { q[1] - 1, 2 * q[1] - 2 } end }:multipliers({ 1, 0 }, { 0, 0 })
end)

tap.done()
