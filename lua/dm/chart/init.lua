--- dm.chart: what accuracy costs. Every rule at every step: the error of what one looks at against
-- CPU time, evaluations, steps.
local blame = require "dm.base.blame"
local budget = require "dm.chart.budget"
local class = require "dm.base.class"
local core = require "dm.core"
local given_steps = require "dm.chart.steps"
local has_own_time = require "dm.base.own_time"
local journal = require "dm.chart.journal"
local measures = require "dm.chart.measures"
local option = require "dm.base.options"
local orders = require "dm.chart.orders"
local ranks = require "dm.sweep.ranks"
local reference = require "dm.chart.reference_run"
local rows = require "dm.chart.rows"
local rule_alone = require "dm.base.rule_alone"
local show = require "dm.chart.show"
local sizes = require "dm.chart.sizes"
local starts = require "dm.base.start"
local tables = require "dm.chart.table"

local M = {}

local Chart = core.class({ __name = "dm.chart" }, [[
dm.chart: a work-precision chart, made by dm.chart{system, q=, v=, t=, rules=, h=}
fields: points (a list of {rule, h, error, ns, setup, steps, evaluations, newton, below}), rules
(names), failures (what could not be run, and why), floor (errors below it cannot be told from the
reference's), rival]])

local max, min, floor = math.max, math.min, math.floor

local WHERE = "dm.chart"
local fail = option.failing(WHERE)

---- options ----

local KNOWN = { 1, "system", "q", "v", "p", "t", "t0", "rules", "h", "steps", "against", "error",
  "samples", "repeats", "reference", "tolerances", "rivals", "seconds", "journal" }

local function system_of(options)
  local system = options.system or options[1]
  if not system then
    fail("the system is missing: dm.chart { system, q =, v =, t =, rules =, h = }")
  end
  local fine, solver = blame.try(function() return system.solver end)
  if not (fine and solver) then
    fail("the first entry must be one dm.system (got %s): make a chart of each system",
      option.got(system))
  end
  if getmetatable(system).__name == "dm.schroedinger" then
    fail("a wave has rules of its own: run wave:solver { rule =, h = } and compare psi")
  end
  if system.Ld then
    fail("a discrete Lagrangian has one step only: give a dm.system, or time runs of solvers by "
      .. "path.ns_per_step")
  end
  return system
end

local function check_options(options)
  option.check(options, KNOWN, WHERE, "{ system, q =, v =, t =, rules = {...}, h = {...} }")
  local system = system_of(options)
  option.need(options, "t", WHERE, "a duration > 0")
  option.positive(options, "t", WHERE, "a duration")
  option.positive(options, "seconds", WHERE, "seconds of CPU time")
  if option.text(options, "journal", WHERE) and options.seconds then
    fail("give 'seconds' or 'journal': a chart with a journal goes on where it was stopped")
  end
  for _, key in ipairs { "samples", "repeats" } do option.whole(options, key, WHERE, 1) end
  if options.against ~= nil and options.against ~= "reference" then
    fail("option 'against' must be \"reference\", which is what errors are measured against (got "
      .. "%s); chart:plot{against =} chooses the axis", option.got(options.against))
  end
  option.flag(options, "rivals", WHERE)
  if options.h ~= nil then
    option.meaningless(options, "steps", WHERE, "'h' has the sizes of steps")
  end
  if options.h ~= nil or options.steps ~= nil then given_steps.sizes(options) end
  local rules = given_steps.list(options, "rules", "rules, such as \"verlet\" or \"gauss(4)\"")
  for _, rule in ipairs(rules) do
    rule_alone(system, rule)  -- a misspelled one is told here
  end
  return system
end

--- A rule as it is written: of an object what it prints without the word "rule".
function M.name(rule) return (tostring(rule):gsub("^rule ", "")) end

---- one point ----

local BATCHES, LONG_ENOUGH = 5, 2e-3
local FAR = 0.3  -- of how far the motion reaches: errors that tell of no order

-- median over batches of the best of the runs in a batch, seconds of CPU of one run
local function cpu_seconds(run, repeats)
  local all = {}
  for b = 1, repeats do
    local best, spent = math.huge, 0
    repeat
      local start = core.cpu()
      run()
      local took = core.cpu() - start
      best, spent = min(best, took), spent + took
    until spent > LONG_ENOUGH
    all[b] = best
  end
  table.sort(all)
  return all[(#all + 1) // 2]
end

local function run_options(options, more)
  local out = { q = options.q, v = options.v, p = options.p, t0 = options.t0 }
  for key, value in pairs(more) do out[key] = value end
  return out
end

-- number of steps for the whole duration; rules with a time of their own are timed as they are run
local function steps_for(options, h) return max(1, floor(options.t / h + 0.5)) end

local function measure(chart, entry, h)
  local options, rule = chart.options, entry.rule
  local steps = steps_for(options, h)
  local step = options.t / steps
  local own = has_own_time(rule)
  local solver = chart.system:solver { rule = rule, h = own and h or step, newton = entry.newton }
  local setup = core.cpu()
  solver:run(run_options(options, { steps = 1 }))
  setup = core.cpu() - setup
  local path = solver:run(run_options(options, rows.of(chart, own, steps)))
  local point = { rule = entry.name, h = own and h or step, setup = 1e9 * setup,
    error = chart.measure(path, chart.reference) }
  if point.error < chart.floor then point.error, point.below = chart.floor, true end
  if chart.reach and point.error > FAR * chart.reach then point.far = true end
  local timed = own and { at = { (options.t0 or 0) + options.t } }
    or { steps = steps, every = steps }
  local plain = run_options(options, timed)
  point.ns = 1e9 * cpu_seconds(function() solver:run(plain) end, options.repeats or BATCHES)
  local report = solver:report()
  point.steps, point.evaluations, point.newton = report.steps, report.evaluations, report.newton
  return point
end

-- a refusal without its numbers: another step is refused for the same reason
local function reason(why) return (why:gsub("%d[%d%.]*e?[-+]?%d*", "#")) end

-- what several steps of a rule fail by is told once, of the first of them
local function note_failure(chart, rule, h, why)
  for _, known in ipairs(chart.failures) do
    if known.rule == rule and reason(known.why) == reason(why) then
      known.count = known.count + 1
      return
    end
  end
  chart.failures[#chart.failures + 1] = { rule = rule, h = h, why = why, count = 1 }
end

-- a point, or { why }: a failure belongs into the chart, it says where a rule stops working
local function try_point(chart, entry, h)
  local fine, point = blame.try(measure, chart, entry, h)
  if fine and point.error == point.error and point.error < math.huge then return point end
  local why = tostring(point):match "^[^\n]*":gsub("^.-%.lua:%d+: ", "")
  if why:find(measures.NO_NUMBER, 1, true) then fail("%s", why) end -- no rule is to blame
  return { rule = entry.name, h = h, why = fine and "the error is not finite" or why }
end

-- what was found for a rule at a step, into the chart
local function enter(chart, task, found)
  if not found.why then
    task.points[#task.points + 1] = core.result(found)
  elseif task.points == chart.points then
    note_failure(chart, found.rule, found.h, found.why)
  end
end

---- what the chart tells ----

class.method("dm.chart", "cheapest", function(chart, target)
  return orders.cheapest(chart.points, target)
end, [[
chart:cheapest(error) -> {rule, h, error, ns, steps, evaluations, newton} or nil
The cheapest measured point whose error is at most the given one, by CPU time.]])

class.method("dm.chart", "pareto", function(chart)
  local sorted, out, best = {}, core.result {}, math.huge
  for i, p in ipairs(chart.points) do sorted[i] = p end
  table.sort(sorted, function(a, b) return a.ns < b.ns end)
  for _, p in ipairs(sorted) do
    if p.error < best then out[#out + 1], best = p, p.error end
  end
  return out
end, [[
chart:pareto() -> list of points
The points that no other beats in both error and time, from the cheapest to the most accurate.]])

function Chart:__tostring()
  return ("work-precision chart of %d point%s, %d rule%s, error of %s over t = %g\n")
    :format(#self.points, #self.points == 1 and "" or "s", #self.rules,
      #self.rules == 1 and "" or "s", self.what, self.options.t) .. self:table()
end

---- making one ----

local doc_chart = "dm.chart{system, q=, v= | p=, t=, rules={...}, h={...}, error=, tolerances=, "
  .. "rivals=, samples=, repeats=, reference=, seconds=, journal=, t0=} -> dm.chart\n" .. [[
Run every rule with every step h (or `steps`: the same, or how many, all larger than t; left out:
seven, from the coarsest that shows the motion, by halves) over the duration t (h is made to fit a
whole number of steps) and measure error against CPU time (median of batches, set-up included,
pinned to one core), evaluations, Newton iterations and steps. error: "position" (default: the
largest difference of a coordinate from a reference over 32 times; on a group of elements their
distance, of rotations the angle between them), "phase" (the time by which a run is ahead of the
reference or behind it, the shift that fits it best, followed from the start), "precession" (how far
it has turned besides: cyclic coordinates, else rotations of the plane or of space that L does not
feel, in rad), "energy", "momentum" (of coordinates that L does not depend on) or a group
(dm.SO(2)), "constraint", a function f(q, v, t, p) compared with the reference, or { f }: the change
of f along the run. What changes along the run itself is looked at after each step, or at as many
times as `samples` says. Errors below
chart.floor, what the references differ by, are raised to it and marked `below`; those of more than
0.3 of the range of the motion, which tell of no order, are marked `far`. ns is the CPU time of a
run, setup that of its first step, kernels included.
The reference is found: two unlike methods, each refined until they agree; where they do not come
close enough, dm.chart raises and says how far apart they are; reference = { rule =, h = } takes one
on your word. tolerances = { 1e-6 }: rules that solve also with Newton's method stopped at these.
Where no rule is of the kind that preserves nothing, rk8 is measured beside them (chart.rival;
rivals = false: not), and the table says when it wins. seconds: CPU time for all of it, in which
pilot runs, references and points end; chart.cut says what was left out, false where nothing was.
journal = "file": measured points are kept there, and the same call goes on where it stopped. A
chart is never split, since times of two machines do not compare: of parts and ranks the first one
measures (docs/sweeps.md). chart.journal is { file, found, run }.
On a terminal's stderr a line tells how far it is from 2 s on. chart:table(), :order(rule),
:cheapest(error), :pareto(), :plot{}, :csv().
On Ctrl-C the error's `chart` field has what was measured so far, which a session keeps as _.
Fields over their size: system = function(N) that returns a field (K:field, dm.field, K:euler,
dm.multisymplectic), N = {8, 16, 32}, h a number, a list or a function of N, rule or rules, t, the
start in functions of the position, and exact = f(x, ..., t), a formula; without it the finest size
is compared with (through dm.remesh, or at the nodes that they share). error: "norm" (the default,
relative) or "largest"; component: of boxes. -> dm.field_chart: chart:table(), :order(rule),
:plot{}, :csv().]]

local SHARE_OF_STEPS, SHARE_OF_REFERENCE = 0.25, 0.9  -- of the seconds that are left

-- the options with steps in h: those given, as h or steps, or found
local function with_steps(system, options, clock, known)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  out.rules = given_steps.list(options, "rules", "rules")
  if options.h or options.steps or known then
    out.h = (options.h or options.steps) and given_steps.sizes(options) or known.h
    return out
  end
  local fine, found = clock:call(SHARE_OF_STEPS, function()
    return given_steps.find(system, options)
  end)
  if fine == nil then
    fail("pilot runs for the steps did not end within %.3g s, their part of option 'seconds' = %g: "
      .. "give steps, h = { 0.1, 0.05, 0.025 }", found, options.seconds)
  end
  out.h = found
  return out
end

local function names_of(entries)
  local out = {}
  for i, entry in ipairs(entries) do out[i] = entry.name end
  return out
end

-- what is there goes with the failure
local function raise(chart, failure)
  failure = blame.stopped(failure)
  if type(failure) == "table" then failure.chart = chart end
  if blame.is_stop(failure) then
    failure.path = chart  -- what a session keeps as _, not the run that was stopped
    failure.message = "dm.chart: stopped on request; what is there is in the failure's field chart"
  end
  error(failure, 0)
end

-- what is found for a rule at a step, pinned to one core; nothing where time is over
local function measure_task(chart, task)
  local pinned = core.pin()
  chart.clock:tell(("chart: %s, step %d of %d (Ctrl-C stops)"):format(task.entry.name, task.number,
    #chart.options.h))
  local fine, found = chart.clock:call(1, core.until_stop, try_point, chart, task.entry,
    chart.options.h[task.number])
  core.unpin(pinned)
  chart.clock:tell()
  if fine == nil then
    chart.clock:leave_out(task.entry.name)
  elseif not fine then
    raise(chart, found)
  else
    return found
  end
end

local function find_reference(chart)
  local fine, ref, apart, text = chart.clock:call(SHARE_OF_REFERENCE, core.until_stop,
    reference.find, chart)
  if fine == nil then
    fail("no reference was found within %.3g s, its part of option 'seconds' = %g: give more, a "
      .. "shorter t, or reference = { rule =, h = }", ref, chart.options.seconds)
  end
  if not fine then raise(chart, ref) end
  chart.reference, chart.floor, chart.reference_text = ref, apart, text
  chart.reach = measures.reach(chart.system, chart.what, ref)
end

-- The chart without its points. known: { h, floor, text, load } of one that was begun before, whose
-- reference is found again where a point is still missing.
local function new_chart(system, options, known)
  local clock = budget.clock(options.seconds)
  options = with_steps(system, options, clock, known)
  local what_measure, what, needs_reference, watched, dense = measures.make(system, options.error,
    options)
  local entries = measures.entries(options.rules, options.tolerances, M.name)
  local by_steps = not needs_reference and not options.samples
  local chart = setmetatable({ system = system, options = options, points = {}, failures = {},
    rules = names_of(entries), measure = what_measure, what = what,
    times = rows.times(options, dense, by_steps), load = core.load_average(),
    watch = watched and { watched = watched } or nil, reference_text = "no reference is needed",
    clock = clock, dense = dense, by_steps = by_steps, batches = options.repeats or BATCHES,
    entries = entries }, Chart)
  if not known and needs_reference then find_reference(chart) end
  if not known and not needs_reference then chart.floor = reference.own_floor(chart) end
  if known then
    chart.floor, chart.reference_text, chart.load = known.floor, known.text, known.load
    chart.lacks_reference = needs_reference
  end
  return chart
end

-- { entry, number of the step, points } of all rules at all steps, the rival last
local function tasks_of(chart)
  local out, options = {}, chart.options
  local function add(entry, points)
    for k = 1, #options.h do out[#out + 1] = { entry = entry, number = k, points = points } end
  end
  for _, entry in ipairs(chart.entries) do add(entry, chart.points) end
  local rival = options.rivals ~= false and measures.rival(chart.system, options.rules, M.name)
  if rival then
    rival.points, chart.rival = {}, rival
    add(rival, rival.points)
  end
  return out
end

-- a point that the journal lacks, with the floor of those that it has
local function measure_later(chart, task)
  if chart.lacks_reference then
    local floor, text = chart.floor, chart.reference_text
    find_reference(chart)
    chart.floor, chart.reference_text, chart.lacks_reference = floor, text, false
  end
  return measure_task(chart, task)
end

-- the chart whose points are kept in a journal, or measured by the first rank alone
local function kept_chart(system, options)
  return journal.chart(system, options, { default_steps = given_steps.COUNT,
    new = function(known)
      local chart = new_chart(system, options, known)
      return chart, tasks_of(chart)
    end,
    measure = measure_later, enter = enter })
end

M.chart = blame.caller(function(options)
  if sizes.is_meant(options) then return sizes.chart(options) end
  options = starts.of_system(options)
  local system = check_options(options)
  options = starts.lists(options, system)
  if options.journal or ranks.here() then return kept_chart(system, options) end
  local chart = new_chart(system, options)
  for _, task in ipairs(tasks_of(chart)) do
    local found = measure_task(chart, task)
    if found then enter(chart, task, found) end
  end
  chart.cut = chart.clock:told()
  return chart
end)

core.docs[M.chart] = doc_chart
class.method("dm.chart", "order", orders.order, orders.doc)
class.method("dm.chart", "table", tables.table, tables.doc)
class.method("dm.chart", "plot", show.plot, show.doc_plot)
class.method("dm.chart", "csv", show.csv, show.doc_csv)

class.method("dm.system", "chart", function(system, options)
  local given = {}
  for key, value in pairs(type(options) == "table" and options or {}) do given[key] = value end
  given.system = system
  return M.chart(given)
end, [[
system:chart{q=, v= | p=, t=, rules={...}, h={...}, ...} -> dm.chart
The same as dm.chart{system, ...}.]])

return M
