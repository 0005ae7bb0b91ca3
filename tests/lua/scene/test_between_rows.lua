-- what lies between rows, and rows to an early time: a narrow wall far off, whose passage has a closed form; steps as long as their error allows
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local exp, sqrt, abs, max = math.exp, math.sqrt, math.abs, math.max

-- L = v^2/2 - A exp(-((q - a)/w)^2) from q = 0 with v = 1: q = t before the wall, q = t - D behind it, where D = w int (1 - 2 A e^(-u^2))^(-1/2) - 1 du
local function delay(A, w)
  local sum, h = 0, 1e-3
  for k = -10000, 10000 do sum = sum + h * (1 / sqrt(1 - 2 * A * exp(-(k * h) ^ 2)) - 1) end
  return w * sum
end
for _, one in ipairs { { 18.7, 1e-3, 0.286 }, { 7.3, 3e-3, 0.45 }, { 33.1, 4e-4, 0.4 } } do
  local a, w, A = table.unpack(one)
  local D, T = delay(A, w), 256 * a / 197.1
  local scene = dm.scene { dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - A * dm.exp(-((q[1] - a) / w) ^ 2) end }, q = { 0 }, v = { 1 }, watch = { "q1" },
    tolerance = 1.2 * D, until_t = T, seconds = 5, rules = { "controlled(rk8)" } }
  local run = scene:run()
  local t, x, worst, i = run.t, run:column "q1", 0, 1
  for k = 1, 200000 do
    local time = T * k / 200000
    while i + 1 < #t and t[i + 1] < time do i = i + 1 end
    if abs(time - a) > 12 * w + D then
      local line = x[i] + (x[i + 1] - x[i]) * (time - t[i]) / (t[i + 1] - t[i])
      worst = max(worst, abs(line - (time < a and time or time - D)))
    end
  end
  ok(worst <= run.error_estimate and run.error_estimate <= 1.2 * D, ("lines over a wall at %g err by no more than is told"):format(a), worst, run.error_estimate, D)
end

-- what is watched may be narrow where forces are not: cos(t) passes through a peak of width w
for _, one in ipairs { { 0.31, 3e-3, 1e-2 }, { -0.64, 4e-4, 3e-2 } } do
  local place, w, tolerance = table.unpack(one)
  local function peak(x) return dm.exp(-((x - place) / w) ^ 2) end
  local run = dm.scene { dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }, q = { 1 }, v = { 0 }, until_t = 10,
    watch = { peak = function(q) return peak(q[1]) end }, tolerance = tolerance, seconds = 5, rules = { "verlet", "blanes-moan(6)", "gauss(4)" } }:run()
  local t, x, i, worst = run.t, run:column "peak", 1, 0
  for k = 1, 200000 do
    local time = k / 20000
    while i + 1 < #t and t[i + 1] < time do i = i + 1 end
    worst = max(worst, abs(x[i] + (x[i + 1] - x[i]) * (time - t[i]) / (t[i + 1] - t[i]) - peak(math.cos(time))))
  end
  ok(worst <= run.error_estimate and run.error_estimate <= tolerance, ("a peak of width %g that is watched"):format(w), worst, run.error_estimate)
end

-- rows to an early time are those of the run that was checked, to the bit
local clutch = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end,
  force = function(_, v) return { -2.77 * dm.exp(-((v[1] - 0.0813) / 0.0084) ^ 2) } end }
local scene = dm.scene { clutch, q = { 1 }, v = { 0 }, watch = { "q1" }, tolerance = 1e-5, until_t = 10, rules = { "controlled(rk8)" } }
local whole, some = {}, {}
for k = 1, 100 do whole[k] = k / 10 end
for k = 1, 31 do some[k] = k / 10 end
local all, early = scene:run { at = whole }:column "q1", scene:run { at = some }:column "q1"
local same = true
for k = 1, #some do same = same and all[k] == early[k] end
ok(same, "rows to an early time have the steps of the whole")

-- starts of a field on a mesh as functions of the position; what is no system of scenes and maps is told first
local field = dm.mesh { triangle = 4 }:field { form = 0, fixed = "boundary", L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }
local function bump(x, y) return math.sin(math.pi * x) * y end
local function rest() return 0 end
local function scene_of(q, v) return dm.scene { field, q = q, v = v, watch = { "q7" }, tolerance = 1e-3, until_t = 1,
  rules = { "verlet", "gauss(2)" } }:run():column "q7" end
local first = field:solver { rule = "verlet", h = 0.1 }:run { q = bump, v = rest, steps = 1 }
local by_function, by_list = scene_of(bump, rest), scene_of(first.q[1]:totable(), dm.zeros(field.Q.dimension))
ok(by_function[#by_function] == by_list[#by_list], "a start that is a function of the position", by_function[#by_function])
local boxes = dm.multisymplectic { names = { "u", "p", "q" }, x = { 0, 6, 33, periodic = true }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, S = function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 end }
tap.raises("got dm.boxes", dm.stability, { system = boxes, z = { u = math.sin }, h = { 0.1, 1, 3, "log" }, t = 1 })
tap.raises("make a run, system:solver", dm.scene, { boxes, z = { u = math.sin }, tolerance = 1, until_t = 1 })
-- rows in steps of log-hamiltonian far from a weak well, where time as a function of the step is rounded coarsely
do
  local e, T, at, lost = 0.044389409885876, 3.1, {}, 0
  for k = 1, 3000 do at[k] = T * (k - k * 0.618034 % 1 * 0.99) / 3000 end
  at[3000] = T
  local core = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + e / 2 / (q:dot(q) + e * e) end }
  for i = 1, 20 do
    local fine, why = pcall(function()
      core:solver { rule = "log-hamiltonian(kahan-li(8))", h = 0.002 * (1 + i) }:run { q = { -2, 0.01 }, v = { 1.3, 0 }, at = at }
    end)
    if not fine and tostring(why):find "did not converge" then lost = lost + 1 end
  end
  ok(lost == 0, "rows in steps of a time of their own", lost)
end

-- what is solved in closed form is rounded, too
do
  local run = dm.scene { dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }, q = { 0.7 }, v = { 0.3 },
    watch = { "q1" }, tolerance = 1e-9, until_t = 1e-7 }:run { at = { 5e-8, 1e-7 } }
  ok(run.error_estimate > 1e-16 and run.error_estimate < 1e-15, "an estimate is not below round-off", run.error_estimate)
end

tap.done()
