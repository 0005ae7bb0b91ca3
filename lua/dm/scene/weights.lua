--- What a run costs, in operations of about a nanosecond, by what it counted: evaluations of
-- kernels, their operations, iterations and the sizes of their equations, steps. Weights are of
-- this table alone, so that the same run always costs the same; they were fitted to ns of 80 rules
-- on ten models (docs/benchmarks/scenes.md).
local core = require "dm.core"
local pilot = require "dm.scene.pilot"

local M = {}

local max = math.max

-- an evaluation: itself, a coordinate, an operation, a root or quotient, a sine or power
local CALL, PLACE, PLAIN, ROOT, SINE = 3, 1.2, 0.2, 3, 17
-- beside an evaluation: of GSL's methods and of rk8, a coordinate; n^2: a mass that varies
local GSL, RK8, ACCELERATION = 22, 15, 3
local GSL_MASS, RK8_MASS = 12, 3
-- beside kicks and drifts; a stage without equations, and its step
local KICK = 3
local STAGE, STAGE_PLACE, STEP, STEP_PLACE = 12, 3, 20, 7
-- a sweep over all stages, side by side in lanes, and the step around it
local LANES, SWEEP, SWEEP_PLACE, SWEPT = 1.2, 8, 2, 50
-- an iteration of Newton's method: of one stage written out, of any, with constraints or forces; of
-- a stage; s k^2: the matrix, k unknown velocities by s stages
local SMALL, NEWTON, BOUND = 15, 20, 100
local OF_STAGE, BOUND_STAGE, BOUND_PLACE = 60, 45, 25
local MATRIX, BOUND_MATRIX, BOUND_MATRIX_PLACE = 1.3, 4, 4.7
-- RATTLE, and as a part of a composition
local RATTLE, COMPOSED = 32, 1.5
-- an iteration where a whole method is solved for, and of a stage of it
local CURVE, CURVE_PLACE, CURVE_STAGE, CURVE_STAGE_PLACE = 20, 50, 10, 18
local CURVE_MASS, CURVE_LIFTED = 1.6, 2.6
local CURVE_BOUND, CURVE_BOUND_STAGE = 60, 14
-- time of its own: an evaluation, a step
local LOGARITHM, OWN_TIME = 1.2, 55
local NOTICED = 0.02 -- sweeps more than iterations of Newton's method, in parts of these
local UNKNOWN = 5    -- operations of L: kernels of which no number is told

---- what is known of a rule, and of a model ----

local known

-- { stages, kind } of the instances in the table of rules
local function facts_of(rule)
  if not known then
    known = {}
    for _, method in ipairs(core.rules()) do
      for _, instance in ipairs(method.instances) do
        known[instance.rule] = { stages = instance.stages, explicit = instance.explicit,
          curve = method.cost:find "^2 n unknowns" ~= nil,
          composed = method.cost:find "steps of the base" ~= nil }
      end
    end
  end
  return known[rule:match "^controlled%((.*)%)$" or rule] or {}
end

-- operations that are written as functions and take no longer than others; sqrt is told apart
local QUICK = { abs = true, min = true, max = true, where = true, sign = true, floor = true,
  ceil = true, fma = true, sqrt = true }

-- how much longer some of their operations take: of L, forces and constraints
local function slow_operations(model)
  if not model.slow then
    local text = model:graphs()
    local _, roots = text:gsub("sqrt", "")
    local _, quotients = text:gsub("/", "")
    local _, powers = text:gsub("%^", "")
    local _, whole = text:gsub("%^%d+%f[^%d.]", "")
    local sines = powers - whole
    for name in text:gmatch "(%a[%w_]*)%(" do
      if not QUICK[name] then sines = sines + 1 end
    end
    model.slow = ROOT * (roots + quotients) + SINE * sines
  end
  return model.slow
end

-- what the formulas need: e, an evaluation; n, coordinates; bound, multipliers
local function sizes_of(report, model)
  local s = model.structure or model.system:structure()
  model.structure = s
  -- groups are stepped in the lift, whose mass varies
  local lifted = model.system.place ~= nil
  local n, told = model.system.Q.dimension + (lifted and 1 or 0), report.operations > 0
  local operations = told and report.operations or UNKNOWN * s.operations
  return { n = n, is_lifted = lifted, bound = s.constraints + s.rolling, forced = s.forced,
    mass_varies = not s.constant_mass or (lifted and not told),
    separable = s.separable and not (lifted and not told),
    e = CALL + PLACE * n + PLAIN * operations + slow_operations(model) }
end

---- kinds of rules ----

local function of_curve(report, z, stages)
  local e = CURVE_STAGE + z.e
  if z.bound > 0 then
    local n = z.n + z.bound
    return report.newton * (CURVE_BOUND * n + stages * (e + CURVE_BOUND_STAGE * n * n))
  end
  return report.newton * (CURVE + CURVE_PLACE * z.n + stages * (e + CURVE_STAGE_PLACE * z.n)
    * (z.is_lifted and CURVE_LIFTED or z.mass_varies and CURVE_MASS or 1))
end

-- iterations of Newton's method for k velocities by s stages
local function of_newton(report, z, s, k)
  if z.bound > 0 or z.forced then
    local n = z.n + z.bound
    return report.newton * (BOUND + s * (BOUND_STAGE + BOUND_PLACE * n + z.e)
      + (BOUND_MATRIX + BOUND_MATRIX_PLACE * n) * s * k * k)
  end
  if s == 1 and z.separable and not z.mass_varies then return report.newton * (SMALL + z.e) end
  return report.newton * (NEWTON + s * (OF_STAGE + z.e) + MATRIX * z.n * z.n * s * k * k)
end

-- stages and unknown velocities of a stage method, or of the base of a composition
local function stages_of(rule, facts, z)
  if facts.composed then
    local s = rule:find "midpoint" and 1 or 2
    return s, s
  end
  local s = facts.stages or 1
  local degree = tonumber(rule:match "galerkin%((%d+)" or rule:match "lie%((%d+)")
  if rule:find "trapezoidal" then degree = 1 end
  -- where constraints hold at its ends
  if z.bound > 0 and rule:find "^lobatto" then degree = s - 0.5 end
  return s, degree or s
end

local function of_stages(report, z, rule, facts)
  local s, k = stages_of(rule, facts, z)
  local sweeps = report.evaluations / s
  local more = sweeps - report.newton
  local may_sweep = z.bound == 0 and not z.forced and (s == 1 or not facts.composed)
  if may_sweep and more > NOTICED * report.newton then
    return SWEPT * more + sweeps * (LANES * z.e + SWEEP_PLACE * z.n + SWEEP)
  end
  return of_newton(report, z, s, k)
end

-- no equations are solved
local function of_evaluations(report, z, rule, facts)
  local evaluations = max(report.evaluations, report.steps)
  if rule:find "^log%-hamiltonian" then
    return LOGARITHM * evaluations * z.e + OWN_TIME * report.steps
  end
  if facts.explicit and rule:find "rk" then
    local own = rule:find "rk8%f[^%w]" ~= nil
    local mass = z.mass_varies and (own and RK8_MASS or GSL_MASS) * z.n * z.n or 0
    return evaluations * (z.e + (own and RK8 or GSL) + ACCELERATION * z.n + mass)
  end
  if rule:find ", rattle" then return evaluations * (z.e + RATTLE) end
  if facts.composed or rule:find "verlet" or rule:find "euler" or rule:find "blanes"
    or rule:find "rattle" or rule:find "shake" then
    return evaluations * z.e + KICK * report.steps
  end
  return evaluations * (z.e + STAGE + STAGE_PLACE * z.n)
    + report.steps * (STEP + STEP_PLACE * z.n)
end

--- Operations of a run: of the kernels, of the equations solved, and what surrounds them.
function M.work(report, model, rule)
  local facts, z = facts_of(rule), sizes_of(report, model)
  if rule == pilot.EXACT then return z.n * report.steps end
  if report.newton == 0 then return of_evaluations(report, z, rule, facts) end
  if rule:find "rattle" or rule:find "shake" then
    local composed = report.evaluations > 1.5 * report.steps
    return report.evaluations * (z.e + RATTLE) * (composed and COMPOSED or 1)
  end
  if facts.curve then return of_curve(report, z, facts.stages) end
  return of_stages(report, z, rule, facts)
end

return M
