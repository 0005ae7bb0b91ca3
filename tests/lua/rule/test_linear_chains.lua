-- steps of linear chains that sweeps cannot take: one band a step size, against the normal modes; cost counted in evaluations, not timed
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sin, cos, pi, abs = math.sin, math.cos, math.pi, math.abs

-- fixed ends: q_i(t) = sum_k a_k sin(i k pi / (n + 1)) cos(omega_k t), omega_k = 2 sin(k pi / (2 n + 2))
local function chain(n, cubic)
  return dm.system { Q = dm.R(n), L = function(q, v)
    local U = q[1] ^ 2 + q[n] ^ 2
    for i = 1, n - 1 do U = U + (q[i + 1] - q[i]) ^ 2 + (cubic or 0) * (q[i + 1] - q[i]) ^ 4 end
    return (v:dot(v) - U) / 2
  end }
end
local function modes(n, t)
  local out = {}
  for i = 1, n do
    out[i] = 0
    for k = 1, 3 do out[i] = out[i] + sin(i * k * pi / (n + 1)) * cos(2 * sin(k * pi / (2 * n + 2)) * t) / k end
  end
  return out
end
local function farthest(q, exact)
  local worst = 0
  for i = 1, #exact do worst = math.max(worst, abs(q[i] - exact[i])) end
  return worst
end
for _, n in ipairs { 30, 60 } do
  for _, h in ipairs { 2.35, 3.1 } do
    local solver = chain(n):solver { rule = "gauss(8)", h = h }
    local path = solver:run { q = modes(n, 0), v = dm.zeros(n), steps = 100 }
    ok(farthest(path.q[#path], modes(n, 100 * h)) < 1e-12, ("n = %d, h = %g: slow modes after 100 steps"):format(n, h), farthest(path.q[#path], modes(n, 100 * h)))
    local energy = path:energy()
    near(energy[#energy], energy[1], 1e-14 * energy[1], "and their energy to round-off")
  end
end
-- all modes excited: sweeps do not contract, and a step takes two solutions with the factors that are there, of eight evaluations each, and eight at the root
for _, n in ipairs { 30, 60 } do
  local rough = {}
  for i = 1, n do rough[i] = 0.1 * sin(i * i) end
  local solver = chain(n):solver { rule = "gauss(8)", h = 2.35 }
  local path = solver:run { q = rough, v = dm.zeros(n), steps = 1000, every = 1000 }
  local energy, report = path:energy(), solver:report()
  near(energy[2], energy[1], 1e-13 * energy[1], "the energy of a rough start to round-off, after 1000 steps")
  ok(report.evaluations <= 30 * 1000 and report.newton <= 2.1 * 1000, "by 25 evaluations a step, whatever its length", report.evaluations)
end
-- a run is a function of its start: whole, in two parts, and with rows at times between
local solver = chain(30):solver { rule = "gauss(8)", h = 2.35 }
local whole = solver:run { q = modes(30, 0), v = dm.zeros(30), steps = 40 }
local between = chain(30):solver({ rule = "gauss(8)", h = 2.35 }):run { q = modes(30, 0), v = dm.zeros(30), at = { 10.1, 33.3, 40 * 2.35 } }
ok(farthest(between.q[3], whole.q[#whole]) == 0, "rows at times between change no bit")
ok(farthest(between.q[1], modes(30, 10.1)) < 1e-12, "and are as right", farthest(between.q[1], modes(30, 10.1)))
local e = chain(30):solver({ rule = "gauss(8)", h = 2.35 }):ensemble { members = 3, q = function() return modes(30, 0) end, v = function() return dm.zeros(30) end, steps = 40 }
ok(farthest(e.q[2], whole.q[#whole]) == 0, "nor does an ensemble")
-- not quite linear: the same band by Newton's method, against small steps
local bent = chain(20, 0.3)
local coarse = bent:solver({ rule = "gauss(8)", h = 2 }):run { q = modes(20, 0), v = dm.zeros(20), steps = 10, every = 10 }
local fine = bent:solver({ rule = "gauss(8)", h = 0.1 }):run { q = modes(20, 0), v = dm.zeros(20), steps = 200, every = 200 }
ok(farthest(coarse.q[2], fine.q[2]) < 1e-7, "a chain that is nearly linear", farthest(coarse.q[2], fine.q[2]))
-- its factors are kept while they converge: a rough start at which sweeps do not contract, counted; as right as with short steps; the same in two parts, from a file, as a member of an ensemble, after another run, at times between
local function rough(n, size)
  local out = {}
  for i = 1, n do out[i] = size * sin(i * i) end
  return out
end
local nearly = chain(30, 1e-3)
local kept = nearly:solver { rule = "gauss(8)", h = 2.35 }
local start = { q = rough(30, 0.3), v = dm.zeros(30), steps = 400, every = 400 }
kept:run(start)
local report = kept:report()
ok(report.newton < 8 * 400, "a kept matrix converges in few iterations", report.newton)
local slow = nearly:solver({ rule = "gauss(8)", h = 0.47 }):run { q = rough(30, 0.3), v = dm.zeros(30), steps = 100, every = 100 }
local quick = nearly:solver({ rule = "gauss(8)", h = 2.35 }):run { q = rough(30, 0.3), v = dm.zeros(30), steps = 20, every = 20 }
ok(farthest(slow.q[2], quick.q[2]) < 2e-6, "and to what short steps find", farthest(slow.q[2], quick.q[2]))
-- few unknowns, a full matrix of 24 and 64: made seldom, and with the same root as of the general form, in which d/dt (q_1 q_2) is added to L and every step makes its matrix
for _, case in ipairs { { 6, "gauss(4)" }, { 8, "gauss(8)" } } do
  local n, rule = table.unpack(case)
  local few = chain(n, 1e-3):solver { rule = rule, h = 2.35 }
  few:run { q = rough(n, 0.3), v = dm.zeros(n), steps = 400, every = 400 }
  local told = few:report()
  ok(told.matrices < 10 and told.newton < 8 * 400, ("%d bodies: a few matrices serve 400 steps"):format(n), told.matrices .. " matrices, " .. told.newton .. " iterations")
  local L = chain(n, 1e-3).L
  local general = dm.system { Q = dm.R(n), L = function(q, v) return L(q, v) + q[1] * v[2] + q[2] * v[1] end }
  local other = general:solver({ rule = rule, h = 2.35 }):run { q = rough(n, 0.3), v = dm.zeros(n), steps = 40, every = 40 }
  local kept_root = chain(n, 1e-3):solver({ rule = rule, h = 2.35 }):run { q = rough(n, 0.3), v = dm.zeros(n), steps = 40, every = 40 }
  ok(farthest(other.q[2], kept_root.q[2]) < 1e-13, "and lead where others do", farthest(other.q[2], kept_root.q[2]))
end
-- 0.3 and 1: it has to be made again and again
for _, case in ipairs { { 30, "gauss(8)", 1e-3 }, { 30, "gauss(8)", 0.3 }, { 30, "gauss(8)", 1 }, { 6, "gauss(4)", 1e-3 }, { 6, "gauss(4)", 0.1 }, { 8, "gauss(8)", 1e-3 }, { 8, "gauss(8)", 1 }, { 2, "gauss(2)", 1e-3 } } do
  local n, rule, cubic = table.unpack(case)
  local bends = chain(n, cubic)
  local one = bends:solver { rule = rule, h = 2.35 }
  local energy = one:run({ q = rough(n, 0.3), v = dm.zeros(n), steps = 100, every = 100 })
  local half = bends:solver({ rule = rule, h = 2.35 }):run { q = rough(n, 0.3), v = dm.zeros(n), steps = 37, every = 37 }
  local file = os.tmpname()
  half:checkpoint(file)
  local rest = dm.resume(file, chain(n, cubic)):run { steps = 63, every = 63 }
  os.remove(file)
  ok(farthest(rest.q[#rest.q], energy.q[2]) == 0 and farthest(rest.p[#rest.p], energy.p[2]) == 0, ("%d bodies, quartic part %g: two parts of a run, bit for bit"):format(n, cubic))
  local other = one:run { q = rough(n, 0.2), v = dm.zeros(n), steps = 50, every = 50 }
  local again = one:run { q = rough(n, 0.3), v = dm.zeros(n), steps = 100, every = 100 }
  local members = bends:solver({ rule = rule, h = 2.35 }):ensemble { members = 5, q = function(i) return rough(n, i == 2 and 0.2 or i == 4 and 0.3 or 0.1 * i) end, v = function() return dm.zeros(n) end, steps = 100 }
  ok(farthest(again.q[2], energy.q[2]) == 0 and other, "after another run")
  ok(farthest(members.q[4], energy.q[2]) == 0 and farthest(members.q[3], one:run({ q = rough(n, 0.1 * 3), v = dm.zeros(n), steps = 100, every = 100 }).q[2]) == 0, "as a member of an ensemble")
  local looked = bends:solver({ rule = rule, h = 2.35 }):run { q = rough(n, 0.3), v = dm.zeros(n), at = { 3.3, 77.7, 235 } }
  ok(farthest(looked.q[3], energy.q[2]) == 0, "and looked at between")
end
tap.done()
