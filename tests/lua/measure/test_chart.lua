-- dm.chart: measured orders, the cheapest, the front, references that are checked, failures that stay in the chart
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, pi, cos, abs = math.sqrt, math.pi, math.cos, math.abs

local kepler = dm.system { name = "Kepler", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local hs = { 0.1, 0.05, 0.025, 0.0125 }
local chart = dm.chart { kepler, q = { 0.8, 0 }, v = { 0, sqrt(1.5) }, t = 4 * pi, repeats = 1,
  rules = { "verlet", "gauss(2)", "kahan-li(6)", "rk4" }, h = hs }
for _, case in ipairs { { "verlet", 2 }, { "gauss(2)", 4 }, { "kahan-li(6)", 6 } } do
  near(chart:order(case[1]), case[2], 0.2, "the order of " .. case[1])
end
ok(#chart.points == 16 and #chart.failures == 0, "a point per rule and step")
local best = chart:cheapest(1e-6)
ok(best and best.error <= 1e-6 and best.ns > 0 and best.evaluations > 0, "the cheapest reaches what is asked")
for _, p in ipairs(chart.points) do
  if p.error <= 1e-6 and p.ns < best.ns then best = nil break end
end
ok(best, "and nothing cheaper does")
local front, rises = chart:pareto(), true
for i = 2, #front do rises = rises and front[i].ns >= front[i - 1].ns and front[i].error < front[i - 1].error end
ok(#front >= 2 and rises, "the front: dearer is better")
ok(chart:cheapest(1e-30) == nil, "no point where none is good enough")
ok(tostring(chart):find "not symplectic" or tostring(chart):find "cheapest at", "a chart prints itself with its table")
ok(chart:table():find "agree to", "the references are told")
ok(select(2, chart:csv():gsub("\n", "")) == 17, "a line of csv per point")
tap.raises("chart:csv: a file name is needed", chart.csv, chart, 7)
tap.raises("chart:csv: cannot open", chart.csv, chart, "/absent/a.csv")
local full = io.open("/dev/full", "w")
if full then
  full:close()
  tap.raises("cannot write /dev/full", chart.csv, chart, "/dev/full")
end

-- steps so fine that a rule's own round-off grows with their number say nothing of its order
local fine = dm.chart { kepler, q = { 0.4, 0 }, v = { 0, 2 }, t = 20 * pi, repeats = 1, rivals = false,
  rules = { "rk8pd" }, h = { 0.1, 0.07, 0.04, 0.025, 0.015, 0.009, 0.005, 0.003, 0.002 } }
ok(fine:order "rk8pd" > 7.5 and fine:order "rk8pd" < 10.5, "an order is measured above the round-off of the rule", fine:order "rk8pd")

-- the errors are right: the oscillator's Verlet has a closed form
local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
chart = spring:chart { q = { 1 }, v = { 0 }, t = 2, rules = { "verlet" }, h = { 0.1 }, samples = 1, repeats = 1 }
near(chart.points[1].error, abs(cos(2 * 2 / 0.1 * math.asin(0.05)) - cos(2)), 1e-12, "the error of Verlet on the oscillator, in closed form")
-- other errors than that of position
chart = kepler:chart { q = { 0.8, 0 }, v = { 0, sqrt(1.5) }, t = 2 * pi, rules = { "verlet" }, h = hs, error = "energy", repeats = 1 }
near(chart:order "verlet", 2, 0.1, "the energy of Verlet is of order 2")
chart = kepler:chart { q = { 0.8, 0 }, v = { 0, sqrt(1.5) }, t = 2 * pi, rules = { "verlet" }, h = { 0.1 }, repeats = 1,
  error = { function(q, _, _, p) return q[1] * p[2] - q[2] * p[1] end } }
ok(chart.points[1].error < 1e-14, "the angular momentum of Verlet does not change", chart.points[1].error)
chart = kepler:chart { q = { 0.8, 0 }, v = { 0, sqrt(1.5) }, t = 2 * pi, rules = { "gauss(3)" }, h = hs, repeats = 1,
  error = function(q) return q:norm() end }
near(chart:order "gauss(3)", 6, 0.2, "an observable against the reference")

-- what fails stays in the chart; what cannot be trusted is no reference
chart = spring:chart { q = { 1 }, v = { 0 }, t = 4000, rules = { "verlet", "midpoint" }, h = { 2.5 }, samples = 2, repeats = 1 }
ok(#chart.points + #chart.failures == 2 and chart:table():find "midpoint", "a rule beyond its limit does not end the chart")
local double = dm.system { Q = dm.T(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 2 * cos(q[1]) + cos(q[2])
end }
raises("disagree", dm.chart, { double, q = { 2.5, 2 }, v = { 0, 0 }, t = 150, rules = { "midpoint" }, h = { 0.02 }, samples = 4 })
raises("the system is missing", dm.chart, { t = 1, rules = { "verlet" }, h = { 0.1 } })
raises("option 't'", dm.chart, { kepler, rules = { "verlet" }, h = { 0.1 } })
raises("option 'rules'", dm.chart, { kepler, t = 1, h = { 0.1 } })
raises("option 'h'", dm.chart, { kepler, t = 1, rules = { "verlet" }, h = { -1 } })
raises("unknown option 'rule'", dm.chart, { kepler, t = 1, rule = "verlet" })
raises("no point of rule", chart.order, chart, "gauss(9)")
-- numbers that are none are no errors of 0
local gone = dm.chart { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = { 0.1, 0.05 }, repeats = 1, rivals = false, error = { function(q) return dm.sqrt(q[1]) end } }
ok(#gone.points == 0 and gone.failures[1].why:find "not finite", "what has no value on the way has no error", gone:table())
raises("no value at some of the samples", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, error = function(q) return dm.sqrt(q[1]) end })
for _, error in ipairs { function() return 1, 2 end, { function() return 1, 2 end } } do
  raises("option 'error' must return one value, not 2", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, error = error })
end
raises("option 'error' must return a number, got table", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, error = { function() return { 1, 2 } end } })
raises("got nil: is a return missing", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, error = function() end })
raises("'samples' must be a whole number >= 1", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, samples = 0 })
raises("'repeats' must be a whole number >= 1", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, repeats = "x" })
raises("no error above 0 with Newton iterations above 0", function() gone:plot { against = "newton" } end)
raises("rule 'verlet' is given twice", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = { "verlet", "verlet" }, h = 0.1 })
raises("'tolerances' must hold numbers", dm.chart, { spring, q = { 1 }, v = { 0 }, t = 5, rules = "midpoint", h = 0.1, tolerances = 2 })
local pushed = dm.system { Q = dm.R(1), L = function(q, v, t) return (v[1] ^ 2 - q[1] ^ 2) / 2 + q[1] * cos(t) end }
raises("the energy of this system changes by itself (L depends on t)", dm.chart, { pushed, q = { 1 }, v = { 0 }, t = 5, rules = "verlet", h = 0.1, error = "energy" })
-- an order that is not to be measured is told with its reason
do
  local function told(o, wanted, what)
    o[1], o.q, o.v, o.repeats, o.rivals = spring, { 1 }, { 0 }, 1, false
    local c = dm.chart(o)
    local order, why = c:order(c.rules[1])
    ok(order == nil and why:find(wanted, 1, true) and not tostring(c):find "nan", what, tostring(order) .. " " .. tostring(why))
  end
  told({ t = 2, rules = "verlet", h = 0.1 }, "one step of verlet gave an error", "one step has no order")
  told({ t = 2, rules = "gauss(6)", h = { 0.1, 0.05, 0.025 } }, "at no step of gauss(6) is the error above", "nor have errors at round-off")
  told({ t = 2, rules = "gauss(5)", h = { 1, 0.05, 0.025 } }, "at one step of gauss(5)", "nor has one step above it")
  told({ t = 2, rules = "verlet", h = { 0.1, 0.1 } }, "at one step of verlet", "nor has the same step twice")
  told({ t = 2, rules = "verlet", h = { 0.1, 0.05 } }, "three are needed", "nor have two, whose slope nothing supports")
  told({ t = 4000, rules = "verlet", h = { 2.5, 3 }, samples = 2 }, "no step of verlet gave an error", "nor have steps that all fail")
end
-- a shift in time in less than two swings, where the amplitude is wrong too: x_n = q cos(n theta) + v h/sin(theta) sin(n theta)
do
  local c = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }:chart { q = { 0.3 }, v = { -0.2 }, t = 10, rules = { "verlet" },
    h = { 0.1, 0.05 }, error = "phase", rivals = false, repeats = 1 }
  for _, p in ipairs(c.points) do
    local theta = math.acos(1 - p.h ^ 2 / 2)
    local ahead = 10 * (theta / p.h - 1) + math.atan(0.2 * p.h / math.sin(theta), 0.3) - math.atan(0.2, 0.3)
    ok(math.abs(p.error / ahead - 1) < 0.01, "the shift of Verlet with a velocity, h = " .. p.h, p.error .. " " .. ahead)
  end
end
-- nor have errors that are as large as the motion, though their slopes agree
do
  local near = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  local c = near:chart { q = { 0.1, 0 }, v = { 0, math.sqrt(19) }, t = 20, rules = { "verlet" }, h = { 0.1, 0.05, 0.02, 0.005 }, rivals = false, repeats = 1 }
  local order, why = c:order "verlet"
  ok(order == nil and why:find("not asymptotic: at no step", 1, true) and c.points[1].far, "no order of errors as large as the motion", tostring(order or why))
end
-- blow-ups have slopes, but no order; the neighbours of a slope must agree with it
do
  local stiff = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - 1e4 * q[1] ^ 2) / 2 end }
  local c = stiff:chart { q = { 1 }, v = { 0 }, t = 1, rules = { "verlet" }, h = { 0.1, 0.05, 0.025, 0.0125 }, rivals = false, repeats = 1 }
  local order, why = c:order "verlet"
  ok(order == nil and why:find("not asymptotic", 1, true), "no order through blow-ups", tostring(order) .. " " .. tostring(why))
  -- errors below what references differ by are raised to it; a refusal is told once
  local exact = dm.chart { spring, q = { 1 }, v = { 0 }, t = 2, rules = { "gauss(8)", "degenerate(2)" }, h = { 0.2, 0.1, 0.05 }, rivals = false, repeats = 1 }
  local fine = #exact.points > 0
  for _, p in ipairs(exact.points) do fine = fine and p.error >= exact.floor and (p.error > exact.floor or p.below) and p.setup > 0 end
  ok(fine and exact.points[#exact.points].below and tostring(exact):find "below %d", "errors below the floor are told as that", tostring(exact))
  ok(#exact.failures == 1 and exact.failures[1].count == 3, "a refusal is told once a rule", #exact.failures)
  local steep = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - 1e4 * q[1] ^ 2) / 2 - q[1] ^ 4 / 10 end }
  local lost = dm.chart { steep, q = { 1 }, v = { 0 }, t = 3, rules = { "verlet", "yoshida(4)" }, h = { 0.08, 0.04, 0.03 }, rivals = false, repeats = 1 }
  ok(#lost.failures == 2 and lost.failures[1].count == 3 and lost.failures[2].count == 3, "also where it comes at another step of the run", #lost.failures)
end
---- shifts in time, turns, seconds ----

do
  local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
  local phase = spring:chart { q = { 1 }, v = { 0 }, t = 100, rules = { "verlet", "midpoint" }, h = { 0.1, 0.05 }, error = "phase", rivals = false, repeats = 1 }
  for i, h in ipairs { 0.1, 0.05 } do
    near(phase.points[i].error, 100 * (2 / h * math.asin(h / 2) - 1), 1e-7, ("Verlet is ahead by this time, h = %g"):format(h))
    near(phase.points[2 + i].error, 100 * (1 - 2 / h * math.atan(h / 2)), 1e-7, "and the midpoint rule behind")
  end
  ok(phase.cut == nil, "without seconds nothing is cut")
  -- an ellipse that turns: a force 1/r^3 beside 1/r^2 turns Kepler's by pi (1/sqrt(1 - 2 eps/l^2) - 1) in half a turn; here of the rule alone, and as much in polar coordinates
  local plane = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  local polar = dm.system { Q = dm.R(2), coordinates = { "r", "phi" }, L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
  local o = { q = { 0.4, 0 }, v = { 0, 2 }, t = 50, rules = { "verlet" }, h = { 0.02, 0.01 }, error = "precession", rivals = false, repeats = 1 }
  local turned = plane:chart(o)
  -- the Runge-Lenz vector turns by that angle
  local path = plane:solver({ rule = "verlet", h = 0.01 }):run { q = o.q, v = o.v, t = 50 }
  local q, p = path.q[#path], path.p[#path]
  local l = q[1] * p[2] - q[2] * p[1]
  local angle = math.atan(-p[1] * l - q[2] / q:norm(), p[2] * l - q[1] / q:norm())
  near(turned.points[2].error, math.abs(angle), 0.1 * math.abs(angle), "the ellipse of Verlet turns as its Runge-Lenz vector does")
  near(turned.points[1].error / turned.points[2].error, 4, 0.3, "by the square of the step")
  o.v, o.rules = { 0, 5 }, { "midpoint" }
  ok(#polar:chart(o).points == 2, "coordinates that L does not depend on are shifted")
  raises("no group that could turn", spring.chart, spring, { q = { 1 }, v = { 0 }, t = 9, rules = { "verlet" }, h = { 0.1 }, error = "precession" })
  -- what is left of the seconds ends runs
  local cut = plane:chart { q = { 0.4, 0 }, v = { 0, 2 }, t = 2000, rules = { "verlet", "midpoint" }, h = { 0.1, 1e-2, 1e-8 }, error = "energy", rivals = false, seconds = 0.4 } -- the last of them would go on for an hour
  ok(cut.cut and cut.cut:find "left out after 0.4 s" and tostring(cut):find "left out", "a chart ends when its seconds are over, and says what it left out", cut.cut)
  ok(spring:chart({ q = { 1 }, v = { 0 }, t = 1, rules = { "verlet" }, h = { 0.1 }, rivals = false, seconds = 20, repeats = 1 }).cut == false, "or that it left out nothing")
  raises("'seconds' must be", spring.chart, spring, { q = { 1 }, v = { 0 }, t = 1, rules = { "verlet" }, seconds = -1 })
end

---- steps that are not given ----

local orbit = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local found = orbit:chart { q = { 0.4, 0 }, v = { 0, 2 }, t = 20, rules = { "gauss(2)", "rk4" }, repeats = 1 }
local fewest = math.huge
for _, p in ipairs(found.points) do fewest = math.min(fewest, p.h) end
tap.ok(#found.points == 14, "seven steps are found, by halves", #found.points)
tap.ok(math.abs(found:order "gauss(2)" - 4) < 0.2 and fewest < 0.05, "fine enough to see the order", found:order "gauss(2)")
local linear = dm.system { Q = dm.R(2), L = function(q, v) return q[2] * v[1] - q:dot(q) / 2 end }
tap.ok(#linear:chart { q = { 1, 0 }, v = { 0, 0 }, t = 10, rules = { "degenerate(2)" }, repeats = 1 }.points == 7, "also where L is linear in v")
local synonym = dm.chart { orbit, q = { 0.4, 0 }, v = { 0, 2 }, t = 5, rules = { "gauss(2)" }, steps = { 0.1 }, against = "reference", repeats = 1 }
tap.ok(#synonym.points == 1 and math.abs(synonym.points[1].h - 0.1) < 1e-12, "steps = is another name of h =")
tap.raises("'steps' must hold steps > 0", dm.chart, { orbit, q = { 0.4, 0 }, v = { 0, 2 }, t = 5, rules = { "gauss(2)" }, steps = { -1 } })
tap.raises("against", dm.chart, { orbit, q = { 0.4, 0 }, v = { 0, 2 }, t = 5, rules = { "gauss(2)" }, against = "time" })
tap.raises("did not settle", dm.chart, { orbit, q = { 0.001, 0 }, v = { 0, 0 }, t = 100, rules = { "verlet" } })

---- other errors, tolerances, rivals ----

local polar = dm.system { Q = dm.R(2), coordinates = { "r", "phi" }, L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
local turning = polar:chart { q = { 0.8, 0 }, v = { 0, sqrt(1.5) / 0.8 }, t = 6, rules = { "midpoint" }, h = { 0.1, 0.05 }, error = "momentum", repeats = 1, tolerances = { 1e-2 } }
ok(#turning.rules == 2 and turning.rules[2]:find "Newton to 1e%-02", "a loose Newton is a line of its own", turning.rules[2])
ok(turning.points[1].error < 1e-13, "the momentum of a cyclic coordinate is kept", turning.points[1].error)
local loose = kepler:chart { q = { 0.4, 0 }, v = { 0, 2 }, t = 60, rules = { "midpoint" }, h = { 0.1 }, error = dm.SO(2), repeats = 1, tolerances = { 1e-2 } }
ok(loose.points[1].error < 1e-13 and loose.points[2].error > 1e-9, "angular momentum to round-off, and lost where Newton's method stops early", loose.points[2].error)
ok(turning.points[1].newton > turning.points[3].newton, "for fewer iterations", turning.points[3].newton)
ok(turning.rival and turning.rival.rule == "rk8" and #turning.rival.points == 2 and #turning.points == 4, "a rival that preserves nothing is measured beside them")
ok(turning:table():find "front of error and time", "the table has the front")
ok(not polar:chart({ q = { 0.8, 0 }, v = { 0, 1 }, t = 1, rules = { "midpoint" }, h = { 0.1 }, error = "energy", repeats = 1, rivals = false }).rival, "unless it is not wanted")
ok(not kepler:chart({ q = { 0.8, 0 }, v = { 0, 1 }, t = 1, rules = { "midpoint", "rk4" }, h = { 0.1 }, error = "energy", repeats = 1 }).rival, "or there is one")
local around = kepler:chart { q = { 0.8, 0 }, v = { 0, sqrt(1.5) }, t = 6, rules = { "verlet", "rk4" }, h = { 0.1 }, error = dm.SO(2), repeats = 1 }
ok(around.points[1].error < 1e-14 and around.points[2].error > 1e-9 and around.what:find "momentum of", "the momentum of a group", around.what)
local rod = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end }
local tied = rod:chart { q = { 1, 0 }, v = { 0, 0 }, t = 5, rules = { "rattle", "rk8" }, h = { 0.1 }, error = "constraint", repeats = 1 }
ok(tied.points[1].error < 1e-13, "the constraint of RATTLE is kept to round-off", tied.points[1].error)
raises("the system has none", dm.chart, { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, h = { 0.1 }, error = "constraint" })
raises("L depends on every coordinate", dm.chart, { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, h = { 0.1 }, error = "momentum" })
raises("'tolerances' must hold numbers", dm.chart, { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "midpoint" }, h = { 0.1 }, tolerances = { 2 } })
local pinned = dm.pin()
ok(pinned == nil or dm.unpin(pinned) == true, "pinned to a core and back")
raises("not what dm.pin() gave", dm.unpin, "x")

-- one number or one name is as good as a list of it; steps that are counted
do
  local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3 end }
  local function chart(more)
    local o = { henon, q = { 0, 0.1 }, v = { 0.3, 0.1 }, t = 20, rules = "verlet", repeats = 1 }
    for key, value in pairs(more) do o[key] = value end
    return dm.chart(o)
  end
  tap.near(chart { steps = { 200, 400, 800 } }:order "verlet", 2, 0.05, "whole numbers of steps, all larger than t")
  tap.near(chart { h = 0.1 }.points[1].h, 0.1, 1e-15, "one step")
  tap.raises("holds 50, but the run has the duration t = 20", chart, { steps = { 0.1, 50 } })
  tap.raises("holds 100, but the run", chart, { h = { 100 } })
  tap.raises("must be one dm.system (got table)", dm.chart, { { henon, henon }, q = { 0, 0.1 }, v = { 0.3, 0.1 }, t = 20, rules = "verlet", h = 0.1 })
end
-- what help(), completion and the reference know of objects that are tables
for class, method in pairs { ["dm.chart"] = "order", ["dm.stability_map"] = "limit", ["dm.scene"] = "why", ["dm.scaling"] = "exponent" } do
  local _ = { dm.chart, dm.stability, dm.scene, dm.scaling }  -- loads them
  local methods = require "dm.session.complete".methods_of(class)
  local core = require "dm.core"
  tap.ok(methods and core.docs[methods[method]] and core.docs[class], "the methods of " .. class .. " are known by name")
end
-- references are never the rules that are measured: L linear in v as q' = f(q, t), here a rotation, driven, in closed form
do
  local L = function(q, v, t) return q[2] * v[1] - (q[1] ^ 2 + q[2] ^ 2) / 2 - q[1] * math.sin(2 * t) end
  local first = dm.system { Q = dm.R(2), coordinates = { "x", "y" }, L = L }
  local function chart(more)
    local o = { first, q = { 1, 0 }, t = 5, rules = { "degenerate(2)", "degenerate(3)", "degenerate(4)" }, h = { 0.2, 0.1 }, repeats = 1, seconds = 20 }
    for key, value in pairs(more) do o[key] = value end
    return dm.chart(o)
  end
  local turned = chart {}
  tap.ok(turned.reference_text:find "^references rk8 and gauss%(7%)", "two methods of another kind", turned.reference_text)
  -- L_v = (y, 0): y' = -x - sin 2t, x' = y, so that x'' + x = -sin 2t
  local x, y = turned.reference:column "x", turned.reference:column "y"
  local worst = 0
  for i, t in ipairs(turned.times) do
    worst = math.max(worst, math.abs(x[i] - math.cos(t) + 2 / 3 * math.sin(t) - math.sin(2 * t) / 3),
      math.abs(y[i] + math.sin(t) + 2 / 3 * math.cos(t) - 2 / 3 * math.cos(2 * t)))
  end
  tap.ok(worst < 2e-13, "the motion in closed form", worst)
  local p = chart { rules = "degenerate(3)", error = function(_, _, _, p) return p[1] end }
  tap.ok(p.points[2].error < 1e-5, "momenta of the reference are dL/dv", p.points[2].error)
  local all = dm.chart { kepler, q = { 0.4, 0 }, v = { 0, 2 }, t = 3, rules = { "rk8", "kahan-li(8)", "gauss(7)", "gauss(4)" }, h = { 0.1 }, repeats = 1 }
  tap.ok(#all.points == 4 and all.reference_text:find "rk8pd and gauss%(6%)", "where the usual ones are measured", all.reference_text)
end
-- what changes is told from the start on, not from the first sample: Verlet's energy of
-- q'' = -q from (1, 0) is off by h^2 / 8 where q = 0, here at both samples
do
  local chart = dm.chart { dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end },
    q = { 1 }, v = { 0 }, t = 1.5 * math.pi, samples = 3, rules = { "verlet" }, h = { math.pi / 60 }, error = "energy", rivals = false }
  ok(math.abs(chart.points[1].error / ((math.pi / 60) ^ 2 / 8) - 1) < 0.01, "the change of an energy is from its start", chart.points[1].error)
  local late = dm.chart { dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end },
    q = { 1 }, v = { 0 }, t = math.pi / 2, samples = 1, rules = { "verlet" }, h = { math.pi / 60 }, error = "energy", rivals = false }
  ok(math.abs(late.points[1].error / ((math.pi / 60) ^ 2 / 8) - 1) < 0.01, "and with one sample", late.points[1].error)
end
-- energy is looked at after each step: at 32 times, an eighth of a turn apart, Verlet's looked better than it is
do
  local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
  local function error_of(samples)
    return dm.chart { oscillator, q = { 1 }, v = { 0 }, t = 64 * math.pi, rules = { "verlet" }, h = { math.pi / 32 }, error = "energy",
      rivals = false, samples = samples }.points[1].error
  end
  local path, worst = oscillator:solver({ rule = "verlet", h = math.pi / 32 }):run { q = { 1 }, v = { 0 }, steps = 2048 }, 0
  local E = path:energy()
  for i = 1, #E do worst = math.max(worst, math.abs(E[i] - E[1])) end
  tap.ok(math.abs(error_of() / worst - 1) < 1e-9, "the largest change of the energy", error_of() / worst)
  tap.ok(error_of(32) < 0.9 * worst, "which 32 times in step with the motion do not show", error_of(32) / worst)
end
-- floors go by the size of what is measured: orders are the same in any unit
for _, unit in ipairs { 1, 1e-15, 1e12 } do
  local pair = dm.system { Q = dm.R(2), L = function(q, v) return (v:dot(v) - (q[1] - q[2]) ^ 2) / 2 * unit end }
  local energies = dm.chart { pair, q = { 1, 0 }, v = { 0, 0.3 }, t = 10, error = "energy", rules = { "verlet" }, h = { 0.2, 0.1, 0.05 }, rivals = false }
  local places = dm.chart { pair, q = { unit, 0 }, v = { 0, 0.3 * unit }, t = 10, rules = { "verlet", "gauss(2)" }, h = { 0.2, 0.1, 0.05 }, rivals = false }
  tap.near(energies:order "verlet" or 0, 2, 0.1, ("energy in units of %g"):format(unit))
  tap.near(places:order "verlet" or 0, 2, 0.1, ("lengths in units of %g"):format(unit))
  tap.near(places:order "gauss(2)" or 0, 4, 0.2, ("lengths in units of %g, a finer rule"):format(unit))
end
-- a control that is held over a step makes the motion depend on it
local held = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end,
  control = function(q) return { q[1] } end, force = function(_, _, _, u) return { -u[1] } end }
raises("held over every step", function()
  held:chart { q = { 1 }, v = { 0 }, t = 3, rules = { "midpoint" }, h = { 0.1, 0.05 } }
end)
tap.done()
