--- dm.prismal{t0, t1, ...}: slices of time, between which a field is stepped over prisms of their
-- own height (Leok 3.12). The action of the prisms gives leapfrog with each slice's own step.
local blame = require "dm.base.blame"
local checkpoint = require "dm.data.checkpoint"
local class = require "dm.base.class"
local core = require "dm.core"
local endings = require "dm.dec.fields.ending"
local failure = require "dm.dec.fields.failure"
local lacking = require "dm.base.lacking"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.prismal"

local Slices = core.class({ __name = "dm.prismal" }, [[
dm.prismal: slices of time, made by dm.prismal{t0, t1, ...}, the rule of a field's solver
fields: times (a dm.vector)]])

function Slices.__tostring(s)
  return ("prismal: %d slices from t = %g to %g"):format(#s.times - 1, s.times[1],
    s.times[#s.times])
end

--- dm.prismal{t0, t1, ...}
M.prismal = blame.caller(function(times)
  local fine, list = blame.try(core.vector, times)
  if not fine or #list < 2 then
    option.fail(WHERE, "a list of two growing times or more is needed (got %s)", option.got(times))
  end
  for i = 1, #list do
    if type(list[i]) ~= "number" or list[i] - list[i] ~= 0 then
      option.fail(WHERE, "time %d must be a finite number (got %s)", i, option.got(list[i]))
    end
    if i > 1 and list[i] <= list[i - 1] then
      option.fail(WHERE, "times must grow: time %d is %g, and the one before it %g", i, list[i],
        list[i - 1])
    end
  end
  return setmetatable({ times = 1 * list }, Slices)
end)

core.docs[M.prismal] = [[
dm.prismal{t0, t1, ...} -> dm.prismal
Slices of time as the rule of a field: field:solver{rule = dm.prismal{...}}, without h. Space-time
is cut into prisms over the cells of the mesh, from slice to slice; varying their action gives
M ((A2 - A1)/h1 - (A1 - A0)/h0) = (h0 + h1)/2 dL/dA at every inner slice (Leok 3.12): symplectic, it
keeps Gauss's law to round-off, has order 2 where steps change smoothly, and is verlet where all
are equal.]]

---- the solver ----

local Solver = core.class({ __name = "dm.prismal_solver" }, [[
dm.prismal_solver: steps of a field between uneven slices, made by
field:solver{rule = dm.prismal{...}}
fields: system, rule, slices]])

lacking.refuse(Solver, { fellow = "dm.solver", what = "solver over slices",
  why = "its slices have steps of their own; a rule with one step, as verlet, has it", reasons = {
    ensemble = "a member is a run of its own: call solver:run for each start",
    step = "a list of two times is one step" } })

--- What field:solver makes of options whose rule is one of slices.
function M.solver(system, options)
  local rule = options.rule
  local where = "field:solver"
  if not system.field then
    option.fail(where, "rule 'prismal' is for fields on meshes (K:field)")
  end
  option.check(options, { "rule", "threads", "sums", "backend" }, where)
  local h = rule.times[2] - rule.times[1]
  local base = system.field.sphere and "rattle" or "verlet"
  local inner = system:solver { rule = base, h = h, threads = options.threads,
    sums = options.sums, backend = options.backend }
  return setmetatable({ system = system, rule = "prismal", slices = rule, inner = inner,
    sums = options.sums }, Solver)
end

-- Slices that a run goes on over: its own, or others that have the time at which it ended; and how
-- many are done.
local function slices_from(ending, rule)
  local slices = rule or M.prismal(ending.times)
  if option.got(slices) ~= "dm.prismal" then
    option.fail("dm.resume", "option 'rule' must be a dm.prismal{...} (got %s)", option.got(slices))
  end
  local now = ending.times[ending.done + 1]
  for k = 1, #slices.times - 1 do
    if slices.times[k] == now then return slices, k - 1 end
  end
  option.fail("dm.resume", "the run ended at t = %.17g, and %s: give { rule = dm.prismal{...} } "
    .. "with that time and later ones", now, rule and "the slices have none that begins there"
    or "all its slices are done")
end

--- The solver that goes on from an ending { done, times, state, sums }.
function M.resume(system, ending, options)
  options = option.check(options or {}, { "rule", "threads", "backend" }, "dm.resume")
  if ending.done >= #ending.times then
    option.fail("dm.resume", "the checkpoint says that %d of %d slices are done", ending.done,
      #ending.times - 1)
  end
  local slices, done = slices_from(ending, options.rule)
  local s = M.solver(system, { rule = slices, threads = options.threads,
    backend = options.backend, sums = ending.sums == "plain" and "plain" or nil })
  s.ending = { state = ending.state, done = done }
  return s
end

local RUN = "solver:run"

-- what core.prismal_run takes
local function given_of(s, options)
  local given = { file = option.text(options, "file", RUN), done = 0 }
  if s.ending then
    checkpoint.check_options(options, { "q", "v", "p" })
    endings.check_still("prismal", s)
    given.from, given.done = s.ending.state, s.ending.done
    given.missing = s.ending.missing
    return given
  end
  given.q, given.v, given.p = options.q, options.v, options.p
  return given
end

-- where a path ended; a checkpoint of it
local function keep(s, path, given, file)
  endings.keep(path, { kind = "prismal", state = given.ending, done = given.done,
    times = s.slices.times, sums = s.sums, missing = given.unwritten and #path })
  if file and not given.unwritten then path:checkpoint(file) end -- else it would leave a gap
end

local function run(s, options)
  option.check(options, { "q", "v", "p", "every", "file", "checkpoint" }, RUN)
  local every = option.whole(options, "every", RUN, 1, nil, 1)
  local file = option.text(options, "checkpoint", RUN)
  local given, times, largest = given_of(s, options), s.slices.times, 0
  for i = 2, #times do largest = math.max(largest, times[i] - times[i - 1]) end
  local fine, path = pcall(failure.run, function(inner)
    return core.prismal_run(inner, given, times, every)
  end, s.inner, s.system, given, largest)
  local made = fine and path or type(path) ~= "string" and path.path
  if made and given.ending then keep(s, made, given, file) end
  if not fine then error(path, 0) end
  return path
end

class.method("dm.prismal_solver", "run", run, [[
solver:run{q=, v= | p=, every=, file=, checkpoint=} -> dm.path
Steps of a field over all slices of dm.prismal, from q and v or p at the first one. Rows at the
start, at every slice (every = k: every k-th) and at the last. file: a .npy file that the rows go to
as they come (the path keeps the last). checkpoint: a file for where it ended, also where it was
stopped; dm.resume goes on from it, and from the path, over the slices that are left or over others,
dm.resume(from, field, { rule = dm.prismal{...} }), with the bits of a run that never stopped.]])

function Solver.__tostring(s)
  return ("solver '%s' for %s"):format(tostring(s.slices), tostring(s.system))
end

return M
