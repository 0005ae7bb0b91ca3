-- dm.step: parts of the state, a time of its own, declared orders, functions of H
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function far(a, b)
  local worst = 0
  for i = 1, #b do worst = math.max(worst, math.abs(a[i] - b[i])) end
  return worst
end

---- parts: the midpoint rule of an oscillator, which counts and sums on the way ----

local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local function rule(changed)
  local options = { name = "counting", unknowns = 1, order = 2, parts = { { "E", 1 }, { "F", 2 } },
    begin = function(q, p, _, m) return { E = m.H(q, p), F = { q[1], 7 } } end,
    start = function(y, h) return { h * y.p[1] } end,
    equation = function(y, x, h)
      return { x[1] / h + h * (y.q[1] + x[1] / 2) / 2 - y.p[1] }
    end,
    next = function(y, x, h)
      return { q = { y.q[1] + x[1] }, p = { x[1] / h - h * (y.q[1] + x[1] / 2) / 2 },
        E = y.E + 1, F = { y.q[1], y.F[2] + y.F[1] } }
    end }
  for key, value in pairs(changed or {}) do options[key] = value or nil end
  return dm.step(options)
end
local counting = rule()
local solver, start = oscillator:solver { rule = counting, h = 0.1 }, { q = { 1 }, p = { 0 } }
local function run(changed)
  local options = { q = start.q, p = start.p, steps = 30 }
  for key, value in pairs(changed or {}) do options[key] = value or nil end
  return solver:run(options)
end
local path = run()
ok(table.concat(path.columns, " ") == "t q1 p1 E F1 F2", "parts are columns")
near(far(path:column "E", { 0.5, 1.5, 2.5 }), 0, 0, "a number, set at the start")
local sum, worst = 7, 0
for i = 1, 31 do
  worst = math.max(worst, math.abs(path:column "F2"[i] - sum))
  sum = sum + path:column(i == 1 and "q1" or "F1")[i]
end
near(worst, 0, 1e-14, "a vector, which follows the state")
near(run { watch = { "F2", "q1" } }:column "F2"[31], path:column "F2"[31], 0, "a part is watched")
local recorded = run { record = { "energy" } }
ok(recorded.columns[6] == "F2" and recorded.columns[7] == "energy", "and stands before what is "
  .. "recorded")
local with_events = run { events = { half = function(q) return q[1] - 0.5 end } }
ok(#with_events.events == 1 and with_events:column "F2"[31] == path:column "F2"[31],
  "steps on the side leave no trace")
near(run { steps = false, at = { 0.05, 0.15, 3 } }:column "F2"[3] - path:column "F2"[31], 0, 1e-13,
  "nor those to given times")
near(far(run { steps = false, at = { 0.05, 0.15, 0.25 } }:column "E", { 1.5, 2.5, 3.5 }), 0, 0,
  "which have the parts of a step from the one before")
local file = os.tmpname()
run { steps = 12 }:checkpoint(file)
local on = dm.resume(file, oscillator, { rule = counting }):run { steps = 18 }
local other = rule { next = function(y, x, h)
  return { q = { y.q[1] + x[1] }, p = { x[1] / h - 1.001 * h * (y.q[1] + x[1] / 2) / 2 } }
end }
raises("the rule is not the one of the checkpoint", function()
  dm.resume(file, oscillator, { rule = other }):run { steps = 18 }
end)
os.remove(file)
ok(on:column "F2"[19] == path:column "F2"[31] and on:column "E"[1] == 12.5,
  "a checkpoint has them, too")
local stopped = run { events = { half = { g = function(q) return q[1] - 0.5 end,
  stop = true } } }
ok(stopped:column "E"[#stopped] == #stopped - 0.5, "a run that an event ends")
local cloud = solver:ensemble { members = 3, steps = 30, q = function(i) return { i } end,
  p = function() return { 0 } end }
near(cloud.q[1][1], path.q[31][1], 0, "members of an ensemble")
-- what `next` leaves out stays; without `begin` they are 0
local lazy = oscillator:solver { h = 0.1, rule = rule { next = function(y, x, h)
  return { q = { y.q[1] + x[1] }, p = { x[1] / h - h * (y.q[1] + x[1] / 2) / 2 } }
end } }:run { q = { 1 }, p = { 0 }, steps = 3 }
near(far(lazy:column "F2", { 7, 7, 7, 7 }), 0, 0, "parts stay")
near(oscillator:solver { h = 0.1, rule = rule { begin = false } }
  :run { q = { 1 }, p = { 0 }, steps = 3 }:column "E"[4], 3, 0, "and begin at 0")

---- on a group: momentum of the last step, as a multistep method keeps it ----

local G = dm.SO(3)
local free = dm.system { Q = G, L = function(_, w)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2
end }
local function inertia(x) return dm.vector { x[1], 2 * x[2], 3 * x[3] } end
local turning = free:solver { h = 0.1, rule = dm.step { name = "lie(1), counted", unknowns = 3,
  order = 2, parts = { { "angle", 1 }, { "last", 3 } }, begin = function(_, p) return { last = p } end,
  start = function(y, h) return { h * y.p[1], h * y.p[2] / 2, h * y.p[3] / 3 } end,
  equation = function(y, x, h) return G:dexpinv(-x, inertia(x) / h) - y.p end,
  next = function(y, x, h)
    return { q = G:compose(y.q, G:exp(x)), p = G:dexpinv(x, inertia(x) / h),
      angle = y.angle + x:norm(), last = y.p }
  end } }:run { q = G:identity(), p = { 0.9, 0.3, 1.2 }, steps = 20 }
near(turning:column "last3"[11], turning.p[10][3], 0, "the momentum of the step before")
local angle = 0
for i = 1, 20 do angle = angle + G:distance(turning.q[i], turning.q[i + 1]) end
near(turning:column "angle"[21], angle, 1e-12, "the angle that was turned")

---- a time of its own ----

local timed = oscillator:solver { h = 0.1, rule = rule { parts = { { "n", 1 } }, begin = false,
  next = function(y, x, h)
    return { q = { y.q[1] + x[1] }, p = { x[1] / h - h * (y.q[1] + x[1] / 2) / 2 },
      t = y.t + h * (1 + y.t), n = y.n + 1 }
  end } }
local own = timed:run { q = { 1 }, p = { 0 }, steps = 10 }
near(own.t[11], 1.1 ^ 10 - 1, 1e-13, "t as the step gives it")
local at = timed:run { q = { 1 }, p = { 0 }, at = { own.t[3], (own.t[3] + own.t[4]) / 2, own.t[11] } }
ok(math.abs(at.q[1][1] - own.q[3][1]) + math.abs(at.q[3][1] - own.q[11][1]) < 1e-13
  and at:column "n"[3] == 10 and at:column "n"[2] == 3, "states at times of its own")
raises("has a time of its own", timed.run, timed, { q = { 1 }, p = { 0 }, t = 1 })
-- the midpoint rule with steps h/(1 + q^2), explicit in q: of order 2 at one time
local paced = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^4/4 end }:solver { h = 0.1,
  rule = dm.step { name = "paced", unknowns = 2, order = 2, start = function(y) return { y.q[1], y.p[1] } end,
    equation = function(y, x, h)
      local k = h / (1 + y.q[1]^2)
      return { x[1] - y.q[1] - k/2 * x[2], x[2] - y.p[1] + k/2 * x[1]^3 }
    end,
    next = function(y, x, h)
      return { q = { 2*x[1] - y.q[1] }, p = { 2*x[2] - y.p[1] }, t = y.t + h / (1 + y.q[1]^2) }
    end } }
near(paced:measured_order({ q = { 1 }, v = { 0 }, t = 2 }).order, 2, 0.1, "  orders are measured at one time")
raises("time of its own", paced.modified_energy, paced, { q = { 1 }, v = { 0 }, steps = 60 })

---- the declared order ----

raises("declares order 3, and from this start it has order 2.00", function()
  oscillator:solver { rule = rule { order = 3 }, h = 0.1 }:run { q = { 1 }, p = { 0.3 }, steps = 1 }
end)
oscillator:solver { rule = rule { order = 1 }, h = 0.1 }:run { q = { 1 }, p = { 0.3 }, steps = 1 }

---- functions of systems that are given by H ----

local function euler_of(system)
  return system:solver { h = 0.1, rule = dm.step { unknowns = 2, order = 1,
    start = function(y, h, m) return m.H_p(y.q, y.p, y.t) * h end,
    equation = function(y, x, h, m) return x - m.H_p(y.q, y.p, y.t) * h end,
    next = function(y, x, h, m)
      return { q = y.q + x, p = y.p - m.H_q(y.q + x, y.p, y.t) * h }
    end } }:run { q = { 0.4, 0.1 }, p = { 0.3, -0.2 }, steps = 5 }
end
local both = euler_of(dm.system { Q = dm.R(2), H = function(q, p) return p[1] * p[2] + q[1] ^ 4 end })
local q, p = dm.vector { 0.4, 0.1 }, dm.vector { 0.3, -0.2 }
for _ = 1, 5 do
  q = q + dm.vector { p[2], p[1] } * 0.1
  p = p - dm.vector { 4 * q[1] ^ 3, 0 } * 0.1
end
near(far(both.q[6], q) + far(both.p[6], p), 0, 1e-15, "m of an H that is quadratic in p")
local singular = euler_of(dm.system { Q = dm.R(2), H = function(x, y) return x[1] * y[1] + y[2] end })
near(singular.q[6][1], 0.4 * 1.1 ^ 5, 1e-14, "m of an H that no L belongs to")
raises("m.L is not there", function()
  dm.system { Q = dm.R(1), H = function(x, y) return x[1] * y[1] end }:solver { h = 0.1,
    rule = rule { parts = false, begin = false, next = function(y, _, _, m)
      return { q = y.q, p = m.L_v(y.q, y.p) }
    end } }:run { q = { 1 }, p = { 1 }, steps = 1 }
end)
raises("need an L that is quadratic in v", function()
  dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 4 + v[1] ^ 2 end }:solver { h = 0.1,
    rule = rule() }:run { q = { 1 }, p = { 1 }, steps = 1 }
end)

---- refusals ----

for _, case in ipairs {
  { "must be a list such as", { parts = 3 } },
  { "[1] is called 'q', which every state has", { parts = { { "q", 1 } } } },
  { "[1] is called 'p2', which every state has", { parts = { { "p2", 1 } } } },
  { "[1] must say how many numbers 'E' has", { parts = { { "E", 0 } } } },
  { "[2] is called 'E', as another one", { parts = { { "E", 1 }, { "E", 2 } } } },
  { "[1] must be { name, how many numbers }", { parts = { "E" } } },
  { "'begin' sets parts, and there are none", { parts = {} } },
} do
  raises(case[1], rule, case[2])
end
local function once(changed)
  oscillator:solver { rule = rule(changed), h = 0.1 }:run { q = { 1 }, p = { 0 }, steps = 1 }
end
raises("'begin' returned 'X'", once, { begin = function() return { X = 1 } end })
raises("the part 'F' must have 2 entries (got 1)", once, { begin = function() return { F = 1 } end })
raises("'begin' must return a table", once, { begin = function() return 1 end })
tap.done()
