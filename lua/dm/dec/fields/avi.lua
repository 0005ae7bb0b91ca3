--- field:solver { rule = "avi" }: asynchronous variational integrators, a step of its own in every
-- cell of the potential (Lew, Marsden, Ortiz & West 2003).
local blame = require "dm.base.blame"
local cell_of = require "dm.dec.fields.cell"
local checkpoint = require "dm.data.checkpoint"
local class = require "dm.base.class"
local core = require "dm.core"
local endings = require "dm.dec.fields.ending"
local failure = require "dm.dec.fields.failure"
local lacking = require "dm.base.lacking"
local option = require "dm.base.options"

local M = {}

local WHERE = "field:solver"

local Solver = core.class({ __name = "dm.avi_solver" }, [[
dm.avi_solver: asynchronous steps of a field, made by field:solver{rule = "avi"}
fields: system, rule, h, start]])

lacking.refuse(Solver, { fellow = "dm.solver", what = "solver of asynchronous steps",
  why = "its cells have steps of their own; a rule with one step, as verlet, has it", reasons = {
    ensemble = "a member is a run of its own: call solver:run for each start",
    step = "run { t = } takes as many events as come before t",
    reversal = "its events in reverse are other ones; run { at = } has rows at chosen times" } })

local function fail(...) option.fail(WHERE, ...) end

--- What field:solver makes of options whose rule is avi.
function M.solver(system, options)
  if not system.field then fail("rule 'avi' is for fields on meshes (K:field)") end
  option.check(options, { "rule", "h", "start" }, WHERE)
  option.one_of(options, "start", WHERE, { "whole", "half" })
  local h = options.h
  if type(h) == "number" then
    option.positive(options, "h", WHERE, "a step")
  elseif h ~= nil and type(h) ~= "function" and type(h) ~= "table" and type(h) ~= "userdata" then
    fail("option 'h' must be a step, a list of one for every cell of the potential, or a "
      .. "function(cell) (got %s)", option.got(h))
  end
  return setmetatable({ system = system, rule = "avi", h = h, start = options.start or "whole" },
    Solver)
end

---- steps ----

-- cell i of a degree with the numbers that it has
local function numbers(f, degree, i)
  return cell_of.new(f.mesh, degree, function(source, first, step, faces)
    return source[first + step * ((faces and faces[i] or i) - 1) + 1]
  end, f.data)
end

local function from_function(f, cells, of)
  local list = {}
  of = core.one(of, "h")
  for _, sum in ipairs(cells:sums()) do
    for i = 1, sum[2] do
      local h = of(numbers(f, f.degrees[sum[1]], i))
      if type(h) ~= "number" then
        fail("the step of cell %d must be a number > 0 (got %s)", #list + 1, option.got(h))
      end
      list[#list + 1] = h
    end
  end
  return list
end

local function from_list(cells, list)
  local sums = cells:sums()
  if #sums ~= 1 then
    fail("a list of steps is for one sum in the potential, and this one has %d: give a number or "
      .. "a function(cell)", #sums)
  end
  if #list ~= sums[1][2] then
    fail("%d steps are given for the %d cells of the potential", #list, sums[1][2])
  end
  return list
end

-- half of what a cell alone allows; where nothing moves, the largest of the others
local function by_default(limits)
  local most, list = 0, {}
  for i = 1, #limits do
    if limits[i] < math.huge then most = math.max(most, limits[i]) end
  end
  if most == 0 then fail("no cell of the potential has a limit of its own: give 'h'") end
  for i = 1, #limits do list[i] = math.min(limits[i], most) / 2 end
  return list
end

local function steps_of(s, f, cells, limits)
  local h, list = s.h, nil
  if h == nil then
    list = by_default(limits)
  elseif type(h) == "number" then
    return core.constant(#limits, h)
  elseif type(h) == "function" then
    list = from_function(f, cells, h)
  else
    list = from_list(cells, h)
  end
  for i = 1, #list do
    local x = list[i]
    if type(x) ~= "number" or not (x > 0 and x < math.huge) then
      fail("the step of cell %d must be a number > 0 (got %s)", i, option.got(x))
    end
  end
  return core.vector(list)
end

---- runs ----

local RUN = "solver:run"

local function start_of(s, f, options, key)
  local x = option.need(options, key, RUN, "the start")
  local vector = core.vector(f.start(x, key))
  if #vector ~= f.n then
    option.fail(RUN, "option '%s' must have %d numbers (got %d)", key, f.n, #vector)
  end
  return vector
end

-- p of the options, or of v
local function momentum_of(s, f, options)
  if (options.p == nil) == (options.v == nil) then
    option.fail(RUN, "give one of 'v' (velocity) and 'p' (momentum) beside 'q'")
  end
  if options.p then return start_of(s, f, options, "p") end
  local v = start_of(s, f, options, "v")
  local masses = f.masses
  return v:map(function(x, i) return masses[i] * x end)
end

-- times that grow from `now` on, up to `last`
local function times_at(options, now, last)
  local fine, at = blame.try(core.vector, options.at)
  if not fine or #at == 0 then
    option.fail(RUN, "option 'at' must be a list of growing times (got %s)", option.got(options.at))
  end
  local list = { now }
  for i = 1, #at do
    local t = at[i]
    if type(t) ~= "number" or t - t ~= 0 or i > 1 and t <= at[i - 1] then
      option.fail(RUN, "option 'at' must hold growing times (entry %d is %s)", i, tostring(t))
    end
    if t > last * (1 + 1e-12) then
      option.fail(RUN, "option 'at': entry %d, %g, is behind the end of the run, %g", i, t, last)
    end
    if t > now then list[#list + 1] = t end
  end
  return list
end

-- the start, every largest step from t0 on or the times asked for, and the end, where there is one
local function times_of(options, h, t0, now)
  local t = option.positive(options, "t", RUN, "a duration")
  if not (t or options.at) then
    option.fail(RUN, "option 't' is missing: the duration of the run")
  end
  local every = option.whole(options, "every", RUN, 1, nil, 1)
  local last, list, k = t and now + t or math.huge, { now }, 1
  if options.at then
    if options.every then option.fail(RUN, "give one of 'at' (times of rows) and 'every'") end
    list = times_at(options, now, last)
  else
    k = math.floor((now - t0) / (every * h) * (1 + 1e-12)) + 1
    while t0 + k * every * h < now + t * (1 - 1e-12) do
      list[#list + 1] = t0 + k * every * h
      k = k + 1
    end
  end
  if t and not (list[#list] >= last * (1 - 1e-12)) then list[#list + 1] = last end
  return list
end

local MARGIN = 0.05 -- of a half period: nearer kicks are in resonance

local function largest(x)
  local most, least = 0, math.huge
  for i = 1, #x do most, least = math.max(most, x[i]), math.min(least, x[i]) end
  return most, least
end

local function describe(s, h, limits, events, duration, cells)
  local _, least = largest(h)
  local beyond, first = 0, nil
  for i = 1, #h do
    if h[i] > limits[i] then beyond, first = beyond + 1, first or i end
  end
  s.last = core.result { rule = "avi", events = events, cells = #h, beyond = beyond,
    first_beyond = first, gain = events > 0 and #h * duration / least / events or nil,
    resonances = cells:resonances(MARGIN) }
end

-- { cells, h, limits, t0, now, given = what cells:run takes } of a start, or of an ending
local function begin(s, options)
  local f, ending, out = s.system.field, s.ending, { given = {} }
  if ending then
    checkpoint.check_options(options, { "q", "v", "p", "t0" })
    endings.check_still("avi", s)
    out.now, out.t0, out.h = ending.t, ending.t0, ending.h
    out.cells = core.avi(s.system, core.vector(ending.q), out.now)
    out.given.from, out.given.t0 = ending.state, ending.t0
    out.given.missing = ending.missing
  else
    local q = start_of(s, f, options, "q")
    out.given.p = momentum_of(s, f, options)
    out.t0 = option.number(options, "t0", RUN, nil, 0)
    core.field_check(s.system, q, out.t0)
    out.now, out.cells = out.t0, core.avi(s.system, q, out.t0)
  end
  out.limits = out.cells:limits()
  if not ending then
    out.h = steps_of(s, f, out.cells, out.limits)
  elseif #out.h ~= #out.limits then
    option.fail(RUN, "the checkpoint has steps of %d cells, and the potential %d", #out.h,
      #out.limits)
  end
  out.given.half = s.start == "half"
  return out
end

-- what a failed run may come from
local function blamed(report)
  local first = report.first_beyond
  return ("%d of %d cells have steps beyond their own limit%s, and %d pairs of cells are near a "
    .. "resonance: solver:report() tells more"):format(report.beyond, report.cells,
    first and (" (the first is cell %d)"):format(first) or "", report.resonances)
end

local function run(s, options)
  option.check(options, { "q", "v", "p", "t", "t0", "at", "every", "file", "checkpoint" }, RUN)
  local b = begin(s, options)
  local file = option.text(options, "checkpoint", RUN)
  b.given.file = option.text(options, "file", RUN)
  local times = times_of(options, (largest(b.h)), b.t0, b.now)
  local path, status, events, row, why = b.cells:run(b.given, b.h, core.vector(times))
  endings.keep(path, { kind = "avi", state = b.given.ending, t = times[row], t0 = b.t0, h = b.h,
    start = s.start, missing = why and #path })
  describe(s, b.h, b.limits, events, path.t[#path] - times[1], b.cells)
  if file and not why then path:checkpoint(file) end -- behind missing rows it would leave a gap
  if status ~= 0 then
    core.strip_fail({ status = status, done = events, time = path.t[#path], h = path.h }, "avi",
      path, why or blamed(s.last))
  end
  failure.check_growth(s.system, path, options, path.h, blamed(s.last))
  return path
end

class.method("dm.avi_solver", "run", run, [[
solver:run{q=, v= | p=, t=, t0=, at=, every=, file=, checkpoint=} -> dm.path
Asynchronous steps of a field for the duration t, from q and v or p. Rows at the start, at every
largest h (every = k: every k-th) or at the times `at`, and at t itself, which no h need divide:
copies of the values drift there with the velocities that they have. file: a .npy file that the rows
go to as they come (the path keeps the last). checkpoint: a file for where it ended, also where it
was stopped; dm.resume goes on from it with the bits of a run that never stopped, and so from the
path. A run that ends early, by Ctrl-C too, raises dm.failure, whose `path` is the run so far and
whose step counts events.]])

class.method("dm.avi_solver", "report", function(s)
  if not s.last then option.fail("solver:report", "no report yet: run the solver first") end
  return s.last
end, [[
solver:report() -> table
Of the last run: events (kicks of cells), cells, gain (how many kicks as many equal steps of the
least h would have made, over events), beyond (cells whose step is beyond their own limit, the first
as first_beyond), resonances (pairs of cells with a common entry of which one kicks the other near a
multiple of its half period, by 0.05 of it, or whose kicks would make one oscillator that both drive
grow round their common period, at most 32 of one step and 256 of the other: the motion may grow
although each step is within its limit; take another step for one of them). Pairs alone are looked
at: growth that takes three cells or more is not counted, so 0 is no promise; the energy of the rows
shows it.]])

function Solver.__tostring(s)
  return ("solver 'avi' for %s"):format(tostring(s.system))
end

return M
