-- dm.curve{substeps =}: substeps that are chosen at the start of a step and held; order, structure, what changing costs, bits, misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, log = math.abs, math.log

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local fast = { q = { 0.4, 0 }, v = { 0, 2 } } -- e = 0.6, at the near end
local function radius(x)
  local sum = 0
  for i = 1, #x // 2 do sum = sum + x[i] ^ 2 end
  return sum ^ 0.5
end
local function near_more(x) return 1.6 / radius(x) end
local function taylor(x, f, h) local k = f(x) return x + h * k + h ^ 2 / 2 * f:along(x, k) end
local function final(rule, n)
  return kepler:solver { rule = rule, h = 2 / n }:run { q = fast.q, v = fast.v, steps = n, every = n }.q[2]
end

-- a fixed choice is a method of its own: two or three substeps of Heun's method by hand
local function heun(x, f, h) local k = f(x) return x + h / 2 * (k + f(x + h * k)) end
for _, row in ipairs { { { 1, 1 }, { 1 / 2, 1 / 2 } }, { { 2, 0, 1 }, { 2 / 3, 1 / 3 } }, { { 1.2, 2.9, 0.4 }, { 1 / 4, 3 / 4 } } } do
  local by_hand = dm.curve { method = function(x, f, h) for _, part in ipairs(row[2]) do x = heun(x, f, part * h) end return x end }
  for _, bias in ipairs { 1, 0.5 } do
    local hand = dm.curve { method = function(x, f, h) for _, part in ipairs(row[2]) do x = heun(x, f, part * h) end return x end, bias = bias }
    local chosen = dm.curve { method = "heun", bias = bias, substeps = function() return row[1] end }
    near((final(chosen, 40) - final(hand, 40)):norm(), 0, 1e-13, "weights " .. table.concat(row[1], ", ") .. " make these substeps")
  end
  ok(by_hand.order == 2, "of order 2")
end
local twice = dm.curve { method = function(x, f, h) return taylor(taylor(x, f, h / 2), f, h / 2) end }
near((final(dm.curve { method = taylor, substeps = function() return 2 end }, 40) - final(twice, 40)):norm(), 0, 1e-13,
  "a number of substeps of a method that is not linear in f")

-- the order is that of the method, whatever is chosen
local goal = final("gauss(4)", 200)
local rules = {
  { dm.curve { method = "rk4", substeps = near_more }, 4 },
  { dm.curve { method = taylor, substeps = near_more, most = 6 }, 2 },
  { dm.curve { method = "kutta3", bias = 0.5, substeps = function(x) return { 1, 2 / radius(x), 1 } end }, 4 },
}
for i, row in ipairs(rules) do
  local rule, p = row[1], row[2]
  near(log((final(rule, 100) - goal):norm() / (final(rule, 200) - goal):norm(), 2), p, 0.15, i .. ": order " .. p .. " with chosen substeps")
  local solver = kepler:solver { rule = rule, h = 0.05 }
  ok(solver:symplecticity { q = fast.q, v = fast.v, steps = 20 } < 1e-14, "  each step is symplectic, the choice held")
  local path = solver:run { q = fast.q, v = fast.v, steps = 10000, every = 10 }
  ok(path:drift(path:momentum(dm.SO(2))).largest < 5e-14, "  angular momentum is kept to round-off")
  local per_step = solver:report().substeps_per_step
  ok(per_step > 1.2 and per_step < 5, "  substeps are reported", per_step)
end
-- what changing costs: the energy drifts where the same method with a fixed choice has no drift
local function drift(substeps)
  local rule = dm.curve { method = "rk4", substeps = substeps }
  return abs(kepler:solver { rule = rule, h = 0.05 }:run { q = fast.q, v = fast.v, steps = 20000, every = 20 }:drift("energy").per_time)
end
local changing, fixed = drift(near_more), drift(function() return 2 end)
ok(changing > 5e-9 and fixed < 1e-10, "the energy drifts where the choice changes, and only there", changing .. ", " .. fixed)

-- bits
for i, row in ipairs(rules) do
  local ends = {}
  for k, backend in ipairs { "tape", "jit" } do
    local path = kepler:solver { rule = row[1], h = 0.05, backend = backend }:run { q = fast.q, v = fast.v, steps = 200, every = 200 }
    ends[k] = ("%a %a"):format(path.q[2][1], path.p[2][2])
  end
  ok(ends[1] == ends[2], i .. ": tape and native code give the same bits", ends[1])
  local solver, file = kepler:solver { rule = row[1], h = 0.05 }, os.tmpname()
  local whole = solver:run { q = fast.q, v = fast.v, steps = 200, every = 200 }
  solver:run { q = fast.q, v = fast.v, steps = 77, every = 77 }:checkpoint(file)
  local rest = dm.resume(file, kepler, { rule = row[1] }):run { steps = 123, every = 123 }
  os.remove(file)
  ok(rest.q[#rest] == whole.q[2] and rest.p[#rest] == whole.p[2], "  a restart goes on bit for bit")
  local members = solver:ensemble { members = 3, q = function() return fast.q end, v = function() return fast.v end, steps = 200, threads = 2 }
  ok(members.q[2] == whole.q[2], "  members of an ensemble are runs of their own")
end
-- threads share the rule, and nothing that a choice is computed in: with a long one they would be at it together all the time
do
  local function long(x)
    local r, sum = radius(x), 2.5
    for k = 1, 4000 do sum = sum + dm.sin(k * r) / k end
    return sum
  end
  local function q(i) return { 0.5 + 0.1 * (i % 8), 0 } end
  local function v(i) return { 0, 1.9 - 0.1 * (i % 8) } end
  local solver = kepler:solver { rule = dm.curve { method = "euler", substeps = long, most = 6 }, h = 0.05, backend = "tape" }
  local alone, wrong = {}, 0
  for i = 0, 7 do alone[i] = solver:run { q = q(i), v = v(i), steps = 30, every = 30 }.q[2] end
  local members = solver:ensemble { members = 64, q = q, v = v, steps = 30, threads = 4 }
  for i = 1, 64 do wrong = wrong + (members.q[i] == alone[i % 8] and 0 or 1) end
  ok(wrong == 0, "a choice is made by each thread for itself", wrong .. " of 64 members differ from runs")
end
-- with a constraint, another dim Q
local bob = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end }
local path = bob:solver { rule = dm.curve { method = "rk4", substeps = function(x) return 2 - x[3] end }, h = 0.1 }
  :run { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, steps = 200 }
ok(abs(path.q[201]:dot(path.q[201]) - 1) < 1e-14, "a constraint is held with chosen substeps")

-- misuse
local function bad(words, options) raises(words, function() options.method = options.method or "rk4" return dm.curve(options) end) end
bad("must be a function(x, h, t)", { substeps = 3 })
bad("more than 40 points", { method = "dop853", substeps = near_more })
bad("2 to 40 of them", { substeps = function() return { 1 } end })
bad("field 'most'", { substeps = near_more, most = 0 })
bad("field 'most'", { substeps = near_more, most = 99 })
bad("mine", { substeps = function() error "mine" end })
for _, weights in ipairs { function(x) return { 0 * x[1], 0 } end, function(x) return { 1, -x[1] ^ 2 * 100 } end, function(x) return { 1 / (x[2] - x[2]), 1 } end } do
  local _, failure = pcall(function() return kepler:solver { rule = dm.curve { method = "rk4", substeps = weights }, h = 0.05 }:run { q = fast.q, v = fast.v, steps = 5 } end)
  ok(type(failure) == "string" or failure.code == "not_finite", "weights that are none end the run", failure)
end
tap.done()
