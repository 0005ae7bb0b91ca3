--- What a run costs, in operations, by what it counted: evaluations of kernels, their operations,
-- iterations. Weights are of this table alone, so that the same run always costs the same; they
-- were fitted to ns of 80 rules on five models (docs/benchmarks/scenes.md).
local core = require "dm.core"

local M = {}

local max = math.max

local AROUND = 8     -- operations about each evaluation, a coordinate
local EXPLICIT = 2.3 -- of an evaluation of a Runge-Kutta method, beside that of a kick and drift
local MASS = 10      -- n^2: a matrix of masses that varies, solved for in each of them
local SWEEP = 2.2    -- of the stages of a sweep, which lie side by side in lanes
local SWEEPS = 2     -- that a step takes beside its sweeps
local NOTICED = 0.02 -- sweeps more than iterations of Newton's method, in parts of these
local LINEAR = 28    -- m^2: an iteration of Newton's method for m unknowns
local CURVE, SOLVE = 3.5, 80 -- of an evaluation and an iteration where a whole method is solved for

local known

-- { stages, explicit, whole (its unknowns are ends, whatever its stages are) } of the instances in
-- the table of rules
local function facts_of(rule)
  if not known then
    known = {}
    for _, method in ipairs(core.rules()) do
      local whole = method.cost:find "^2 n unknowns" ~= nil
      for _, instance in ipairs(method.instances) do
        known[instance.rule] = { stages = instance.stages, explicit = instance.explicit,
          whole = whole }
      end
    end
  end
  return known[rule:match "^controlled%((.*)%)$" or rule] or {}
end

-- a run of a stage method by Newton's method for all stages, multipliers among the unknowns
local function of_newton(report, unit, unknowns)
  local m = report.evaluations / report.newton * unknowns
  return report.evaluations * unit + LINEAR * report.newton * m * m
end

--- Operations of a run: of the kernels, of the equations solved, and what surrounds them.
function M.work(report, model, rule)
  local facts, n = facts_of(rule), model.system.Q.dimension
  local s = model.structure or model.system:structure()
  model.structure = s
  local unit = report.operations + AROUND * n
  local plain = max(report.evaluations, report.steps) * unit
  if facts.explicit then
    return EXPLICIT * (plain + (s.constant_mass and 0 or MASS * n * n * report.evaluations))
  end
  if report.newton == 0 then return plain end
  -- a sweep more than iterations, in every step
  local steps = facts.stages and report.evaluations / facts.stages - report.newton or 0
  if steps > NOTICED * report.newton then
    return SWEEP * (report.newton + SWEEPS * steps) * unit
  end
  local bound = s.constraints + s.rolling
  if facts.whole and bound == 0 then return CURVE * plain + SOLVE * report.newton end
  local is_small = s.separable and not s.forced and bound == 0 -- written out, or a composition
  if is_small or report.evaluations < report.newton then return plain + report.newton * n * n end
  return of_newton(report, unit, n + bound)
end

return M
