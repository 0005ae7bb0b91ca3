--- What reduction adds to methods of the core: rules of reduced systems, reasons of their failures.
local blame = require "dm.base.blame"
local core = require "dm.core"

-- rsprk(rule) is one more name of a rule, of reduced systems
local solver, solver_doc = core.method("dm.system", "solver")

local function of_rule(system, options)
  local rule = type(options) == "table" and options.rule
  if type(rule) == "string" and rule:find "^%s*rsprk" then
    return require "dm.reduce.routh.rsprk".solver(solver, system, options)
  end
  return solver(system, options)
end

core.method("dm.system", "solver", blame.relay(of_rule, "solver"), solver_doc .. [[

Of a reduced system (system:routh) also "rsprk(rule)", the reduced rule of Leok 2.5: the same steps
as `rule`, whose p is s + mu A.]])

local run, run_doc = core.method("dm.solver", "run")

-- a run of a reduced system that fails says what of the reduction is in the way
local function guarded(solver, options)
  local routh = package.loaded["dm.reduce.routh"]
  if routh and pcall(function() return solver.system end) and routh.info(solver.system) then
    return require "dm.reduce.run.failure".run(run, solver, options)
  end
  return run(solver, options)
end

core.method("dm.solver", "run", blame.relay(guarded, "run"), run_doc .. [[

A failure of a reduced system (system:routh) has a reason: "collapse" (the locked inertia vanishes;
also raised where a step jumped through such a shape), "pole" or "edge" of the coordinates. Jumps
are looked for at the rows that are kept and, where these are suspect, between them: with every = k
fewer may be seen. Members of ensembles are not looked through for jumps: watch = { "energy" } shows
them.]])

return {}
