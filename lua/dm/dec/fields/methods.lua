--- Rules that only fields have, as names of rules for field:solver.
local blame = require "dm.base.blame"
local checkpoints = require "dm.data.checkpoint"
local class = require "dm.base.class"
local core = require "dm.core"
local endings = require "dm.dec.fields.ending"
local option = require "dm.base.options"

local function wraps(place) return class.wraps("dm.dec.fields.methods", place) end

local solver, solver_doc, put_solver = wraps "dm.system:solver"

local function of_rule(system, options)
  local rule = type(options) == "table" and options.rule
  if type(rule) == "string" and rule:find "^%s*avi%s*$" then
    return require "dm.dec.fields.avi".solver(system, options)
  end
  if type(rule) == "table" and getmetatable(rule) and getmetatable(rule).__name == "dm.prismal" then
    return require "dm.dec.fields.prismal".solver(system, options)
  end
  return solver(system, options)
end

put_solver(blame.relay(of_rule, "solver"), solver_doc .. [[

Of a field on a mesh (K:field) also rule = "avi", with h a number, a list or a function(cell) of the
cells of the potential (default: half of what each allows), start = "half" for half a kick at the
start: every cell has a step of its own (Lew, Marsden, Ortiz & West 2003); and rule =
dm.prismal{t0, t1, ...}, without h: prisms over uneven slices of time.]])

local run, run_doc, put_run = wraps "dm.solver:run"

-- of a run of a field
local function guarded(solver, options)
  local system = core.system_of(solver)
  if not (system and system.field) then return run(solver, options) end
  return require "dm.dec.fields.failure".run(run, solver, system, options, solver.h)
end

-- dm.reduce.methods relays it
put_run(guarded, run_doc .. [[

A failure of a field on a mesh says where h is beyond its limit of stability, and which cell turned
inside out; a field without forces whose energy has outgrown the start by 2^104 fails, too.]])

---- where runs ended that the core knows nothing of ----

local checkpoint, checkpoint_doc, put_checkpoint = wraps "dm.path:checkpoint"

put_checkpoint(blame.relay(function(path, file)
  local kind = endings.kind_of(path)
  if not kind then return checkpoint(path, file) end
  return checkpoints.write(kind, path, file)
end, "checkpoint"), checkpoint_doc)

local resume, resume_doc, put_resume = wraps "resume"

put_resume(function(from, model, options)
  local kind = endings.kind_of(from)
  if not kind then return resume(from, model, options) end
  model = model or type(from) == "userdata" and from.system
  if option.got(model) ~= "dm.system" or not model.field then
    option.fail("dm.resume", "the field that the run is of is needed beside it (got %s)",
      option.got(model or nil))
  end
  local solver = checkpoints.resume(kind, model, from, options)
  solver.ending.missing = endings.missing(from)
  return solver
end, resume_doc)
