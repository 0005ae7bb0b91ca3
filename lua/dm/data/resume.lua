--- dm.resume of whatever has an end to go on from: paths of systems by the core, runs of fields on
-- lines, of boxes, of waves and of flows by the method `resume` of what they are runs of.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.resume"

-- what runs are of, by the class of the run; and the classes of those models
local OF_RUN = { ["dm.line_run"] = "field", ["dm.box_run"] = "boxes", ["dm.wave_path"] = "wave",
  ["dm.flow"] = "euler" }
local MODELS = { ["dm.line_field"] = true, ["dm.boxes"] = true, ["dm.schroedinger"] = true,
  ["dm.euler"] = true }

-- the same with a discrete Lagrangian of a system and a rule, whose steps are the system's
local function resume_pair(from, Ld, options)
  local own, with = Ld:solver {}, lists.copy(options or {})
  with.rule = with.rule or own.rule
  local solver = core.resume(from, own.system, with)
  if solver.h ~= own.h then
    option.fail(WHERE, "the checkpoint is of steps h = %g, this discrete Lagrangian has h = %g",
      solver.h, own.h)
  end
  return solver
end

--- dm.resume(file | run [, model])
M.resume = blame.caller(function(from, model, options)
  local key = OF_RUN[option.got(from)]
  if type(from) == "table" and not key then
    option.fail(WHERE, "a file, a path, or a run of a line, boxes, a wave or a flow is needed "
      .. "(got %s); others go on by a new run from their last row", option.got(from))
  end
  if option.got(model) == "dm.discrete_shape" then model = model:solver {}.system end
  if option.got(model) == "dm.discrete_lagrangian" and model.system then
    return resume_pair(from, model, options)
  end
  if not key and not MODELS[option.got(model)] then return core.resume(from, model, options) end
  if options ~= nil then
    option.fail(WHERE, "the rule of a run on a line, of a wave or a flow is that of its "
      .. "checkpoint: there are no options")
  end
  model = model or from[key]
  if not MODELS[option.got(model)] then
    option.fail(WHERE, "what the run is of is needed beside it, or nothing (got %s)",
      option.got(model))
  end
  return model:resume(from)
end)

core.docs[M.resume] = core.docs[core.resume] .. [[

So do runs of fields on lines, of boxes, of waves and of flows: dm.resume(run), or dm.resume(file,
field) with the dm.field, dm.multisymplectic, dm.schroedinger or K:euler that they are of; and runs
of fields on meshes by rule "avi" (run{t=} goes on from there) and over the slices of dm.prismal
(those that are left, or those of { rule = dm.prismal{...} }). Runs by D = shape:discrete(Ld) go on
with D in the place of the system.]]

return M
