--- What reduction adds to methods of the core: rules of reduced systems, reasons of their failures.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"

local function wraps(place) return class.wraps("dm.reduce.methods", place) end

-- rsprk(rule) is one more name of a rule, of reduced systems
local solver, solver_doc, put_solver = wraps "dm.system:solver"

local function of_rule(system, options)
  local rule = type(options) == "table" and options.rule
  if type(rule) == "string" and rule:find "^%s*rsprk" then
    return require "dm.reduce.routh.rsprk".solver(solver, system, options)
  end
  return solver(system, options)
end

put_solver(blame.relay(of_rule, "solver"), solver_doc .. [[

Of a reduced system (system:routh) also "rsprk(rule)", the reduced rule of Leok 2.5: the same steps
as `rule`, whose p is s + mu A.]])

local run, run_doc, put_run = wraps "dm.solver:run"

-- a run of a reduced system that fails says what of the reduction is in the way
local function guarded(solver, options)
  local routh = package.loaded["dm.reduce.routh"]
  local system = core.system_of(solver)
  if not system then return run(solver, options) end
  if routh and routh.info(system) then
    return require "dm.reduce.run.failure".run(run, solver, options)
  end
  local independent = package.loaded["dm.measure.independent"]
  if independent then return independent.look(system, run(solver, options)) end
  return run(solver, options)
end

put_run(blame.relay(guarded, "run"), run_doc .. [[

A failure of a reduced system (system:routh) has a reason: "collapse" (the locked inertia vanishes;
also raised where a step jumped through such a shape), "pole" or "edge" of the coordinates. Jumps
are looked for at every step of runs of up to 20000 steps, whatever rows are kept (steps between
rows are made again), in longer ones at the rows that are kept and, where these are suspect, between
them.]])

local ensemble, ensemble_doc, put_ensemble = wraps "dm.solver:ensemble"

local function guarded_ensemble(solver, options)
  local reduced = package.loaded["dm.reduce.euler_poincare"] and type(options) == "table"
  if reduced and options.a ~= nil then
    solver, options = require "dm.reduce.run.carried".of(solver, options)
  end
  local routh = package.loaded["dm.reduce.routh"]
  if routh and blame.try(function() return solver.system end) and routh.info(solver.system) then
    return require "dm.reduce.run.members".ensemble(ensemble, run, solver, options)
  end
  return ensemble(solver, options)
end

put_ensemble(blame.relay(guarded_ensemble, "ensemble"), ensemble_doc .. [[

Members of a reduced system (system:routh) are looked through for jumps: status[i] is "collapse",
"pole" or "edge" where a run of its own would have been refused, failures() names the step; q and p
are those of its end. All members are, where these take up to 20000 steps in all, else those whose
energy at the end has moved by more than 2 %, the 256 that moved most. Not looked through are
ensembles that only watch, of more than 1000 members with less than 500 steps each, and long ones
with vary, a force or a time in L.]])

local failures, failures_doc, put_failures = wraps "dm.ensemble:failures"
put_failures(blame.relay(function(e)
  local members = package.loaded["dm.reduce.run.members"]
  if members then return members.failures(failures, e) end
  return failures(e)
end, "failures"), failures_doc)

local text, _, put_text = wraps "dm.ensemble:__tostring"
put_text(function(e)
  local members = package.loaded["dm.reduce.run.members"]
  return members and members.text(text, e) or text(e)
end)

return {}
