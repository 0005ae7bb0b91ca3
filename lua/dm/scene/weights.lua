--- What a run costs, in operations of about a nanosecond, by what it counted: evaluations of
-- kernels, their operations, iterations of Newton's method and those of them that take a matrix
-- anew, step equations, steps; and by the sizes of what they work on. Weights are of this file
-- alone, so that the same run always costs the same; they were fitted to the least ns of 80 rules
-- on seventeen models (docs/benchmarks/scenes.md), terms by the loops of the engines.
local core = require "dm.core"
local pilot = require "dm.scene.pilot"

local M = {}

local max = math.max

-- an evaluation: itself, a coordinate, an operation, a root or quotient, a sine or power
local CALL, PLACE, PLAIN, ROOT, SINE = 3, 1.2, 0.2, 3, 17
local SMALL = 4      -- coordinates of one point that is written out
local FEW = 0.3      -- matrices in a step equation, below which it is sweeps that solve it
local UNKNOWN = 5    -- operations of L: kernels of which no number is told
local LATENCY = 5    -- a root and its quotient, where a step has nothing else to do beside them

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

-- how much longer some of their operations take: of L, forces and constraints; how many of them are
-- roots and quotients
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
    model.slow, model.roots = ROOT * (roots + quotients) + SINE * sines, roots + quotients
  end
  return model.slow, model.roots
end

-- what the formulas need: e, an evaluation; n, coordinates; bound, multipliers
local function sizes_of(report, model)
  local s = model.structure or model.system:structure()
  model.structure = s
  -- groups are stepped in the lift, whose mass varies
  local lifted = model.system.place ~= nil
  local n, told = model.system.Q.dimension + (lifted and 1 or 0), report.operations > 0
  local operations = told and report.operations or UNKNOWN * s.operations
  local slow, roots = slow_operations(model)
  return { n = n, roots = roots, is_lifted = lifted, bound = s.constraints + s.rolling,
    forced = s.forced,
    mass_varies = not s.constant_mass or (lifted and not told),
    separable = s.separable and not (lifted and not told), is_bent = not s.quadratic_in_v,
    e = CALL + PLACE * n + PLAIN * operations + slow }
end

---- kinds of rules: what an evaluation costs, a step equation, an iteration, a matrix, a step ----

-- a whole method is solved for: its s points and their derivatives, each of all points before it
local function of_curve(z, s)
  local n, e = z.n, z.e
  local varies = z.mass_varies and 1 or 0
  if z.bound > 0 then
    local m = n + z.bound
    return { evaluation = 33 + 3.7 * e + 0.6 * s * n + 3.1 * m ^ 2, iteration = 13 * m ^ 2,
      matrix = 47 * s * m ^ 2 }
  end
  return { evaluation = 16 + 0.78 * e + (9 + 0.94 * s) * n, iteration = 75 + 4.5 * n ^ 2,
    matrix = 202 + (8.9 + 0.27 * s) * s * n ^ 2 + (0.85 + 30 * s * varies) * n ^ 3 }
end

-- s points and k velocities of a step; a matrix is k^2 blocks of s terms, and its factors
local function of_bound(z, s, k)
  local n, m = z.n, z.bound
  local N = k * n + s * m
  local blocks = 13 * k ^ 2 + 0.38 * k ^ 2 * n ^ 2 + (m > 0 and 4 * s ^ 2 or 0)
  return { evaluation = 0.4 * z.e + 7.5 * k * n, iteration = 106 + 26 * s * m,
    matrix = s * (54 + blocks) + 4.9 * N ^ 2 + 0.017 * N ^ 3 }
end

-- the same without constraints and forces; `cold`: where h is another one at every step equation,
-- so that nothing is left from the one before
local function of_newton(z, s, k, cold)
  local n = z.n
  return { evaluation = 11.5 + 0.21 * z.e + 3.1 * n ^ 2, iteration = 39,
    matrix = (s > 1 and 55 or 0) + s * k ^ 2 * (5.3 + 0.68 * n ^ 2) + 6.3 * (k * n) ^ 2,
    solve = cold and 80 + 0.35 * z.e + 8.4 * n ^ 2 + 1.35 * n ^ 3 or 0 }
end

-- all stages side by side in lanes, a sweep an evaluation of each; weights of a step of another h
local function of_sweeps(z, s, cold)
  local n, e = z.n, z.e
  local sweep = 12.5 + 0.28 * e + n + (0.5 * n + 0.032 * e) * s
  if not z.separable then sweep = sweep + 8 + 0.23 * n * s end
  return { evaluation = sweep / s, solve = 51 + (cold and 85 + 15 * s ^ 2 or 0) }
end

-- two iterations of one point are one kernel
local function of_one_point(z, cold)
  return { iteration = 15 + 0.84 * z.e + 0.8 * z.n, solve = cold and 80 or 0 }
end

-- lie(s) on a group, with operations of its own kernel
local function of_group(report) return { evaluation = 146 + 0.065 * report.operations } end

local function of_explicit(z, own)
  local n, e = z.n, z.e
  local indirect = z.separable and not z.mass_varies and 0 or z.is_bent and 3.5 or 1
  if own and not z.is_bent then
    local lift = z.is_lifted and 40 or 0
    return { evaluation = 18 + lift + 0.4 * e + 2.8 * n + indirect * (2 + 1.35 * n ^ 2) }
  end
  -- v(q, p) is Newton's method with the mass at its iterates, more of them where L is not quadratic
  -- in v; rk8 has a kernel of its own for one that is
  return { evaluation = 30 + 0.3 * e + 2 * n + indirect * (92 + 0.2 * e + 5.5 * n ^ 2) }
end

local function of_rattle(z, composed)
  local e = z.e
  if z.bound == 0 and not z.forced then
    return composed and { evaluation = 20 + 0.9 * e + LATENCY * z.roots, step = 6 }
      or { evaluation = 0.48 * e, step = 7 }
  end
  return { evaluation = 36 + (z.forced and 28 or 0) + (composed and 8 + 0.34 * e or 0),
    iteration = 1.6 * z.bound ^ 3 }
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
  if z.bound > 0 or z.forced then return of_bound(z, s, k) end
  if z.is_lifted and rule:find "^lie" and report.operations > 0 and report.matrices > 0 then
    return of_group(report)
  end
  local cold = facts.composed or rule:find "^controlled" ~= nil
  if report.matrices >= FEW * max(report.solves, 1) then return of_newton(z, s, k, cold) end
  if s == 1 and z.n <= SMALL and z.separable and not z.mass_varies then
    return of_one_point(z, cold)
  end
  local cost = of_sweeps(z, s, cold)
  cost.matrix = of_newton(z, s, k, cold).matrix
  return cost
end

-- no equations are solved
local function of_evaluations(z, rule, facts)
  local n, e = z.n, z.e
  if rule:find "^log%-hamiltonian" then return { evaluation = e, step = 68 } end
  if facts.explicit and rule:find "rk" then
    return of_explicit(z, rule:find "rk8%f[^%w]" ~= nil)
  end
  if facts.composed or rule:find "verlet" or rule:find "euler" or rule:find "blanes" then
    return { evaluation = 0.74 * e + 0.18 * n + (z.roots > 0 and LATENCY or 0),
      step = 1.6 + 0.43 * n + (rule == "symplectic-euler(a)" and 3.5 + 0.3 * n or 0) }
  end
  return { evaluation = 13.5 + 0.24 * e + 2.15 * n, step = 17 + 7.6 * n }
end

local function cost_of(report, z, rule, facts)
  if rule:find "rattle" or rule:find "shake" then return of_rattle(z, rule:find ", " ~= nil) end
  if report.newton == 0 then return of_evaluations(z, rule, facts) end
  if facts.curve then return of_curve(z, facts.stages) end
  return of_stages(report, z, rule, facts)
end

--- Operations of a run: of the kernels, of the equations solved, and what surrounds them.
function M.work(report, model, rule)
  local facts, z = facts_of(rule), sizes_of(report, model)
  if rule == pilot.EXACT then return z.n * report.steps end
  local cost = cost_of(report, z, rule, facts)
  local evaluations = report.newton == 0 and max(report.evaluations, report.steps)
    or report.evaluations
  return (cost.evaluation or 0) * evaluations + (cost.solve or 0) * report.solves
    + (cost.iteration or 0) * report.newton + (cost.matrix or 0) * report.matrices
    + (cost.step or 0) * report.steps
end

return M
