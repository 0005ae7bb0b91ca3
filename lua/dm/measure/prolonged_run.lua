--- What runs of a prolonged system have in common: its solver, what cannot be prolonged, options.
local core = require "dm.core"
local option = require "dm.base.options"
local has_own_time = require "dm.base.own_time"
local starts = require "dm.base.start"
local prolong = require "dm.measure.prolong"

local M = {}

local function newton(solver)
  return { tolerance = solver.tolerance, max_iterations = solver.max_iterations }
end

--- The solver of `system`, prolonged, that steps as `solver` does.
function M.solver_of(solver, system, h)
  local rule = prolong.rule(solver.system, solver.rule)
  if type(rule) ~= "string" and rule.own and system.Q.dimension ~= solver.system.Q.dimension then
    error(("the functions of '%s' are for its system, and a tangent map is a run of another one, "
      .. "of twice as many coordinates: none is known"):format(tostring(rule)), 0)
  end
  return system:solver { rule = rule, h = h or solver.h, newton = newton(solver) }
end

--- Does the rule step the prolonged system by its own tangent? Not where its method is not linear
-- in the values of f, which in L~ are not those of L and their derivatives side by side.
function M.prolongs(solver)
  local rule = solver.rule
  return type(rule) == "string" or rule.linear ~= false
end

--- Raises why L~ stepped by the rule is not the tangent of the rule. any_time: for what looks at
-- runs of L alone, at whatever times.
function M.refuse(solver, what, any_time)
  local rule = tostring(solver.rule)
  local given = solver.system.given
  if rule:find "^degenerate" then
    error(what .. ": L is linear in v, so that p is a function of q, and (q, p) has no "
      .. "neighbours off p = alpha(q): not for rule '"
      .. rule .. "'", 0)
  end
  if not (given and (given.L or given.H)) then
    error(what .. ": a discrete Lagrangian has no prolonged system here; use a dm.system", 0)
  end
  if has_own_time(solver) and not any_time then
    error(what .. ": '" .. rule
      .. "' changes the time with the state, so the prolonged system, or the reversed one, runs on "
      .. "another time: use a rule with a fixed step", 0)
  end
end

--- Raises where a start is not whole.
function M.check_start(options)
  starts.check_one(options)
  if options.q == nil or options.v == nil and options.p == nil then
    error("give the start as q and v, or as q and p", 0)
  end
end

--- q and p at the start; t0.
function M.start_of(solver, options)
  local system = solver.system
  local t0 = options.t0 or 0
  M.check_start(options)
  local p = options.p or system:legendre(options.q, options.v, t0)
  return core.vector(options.q), core.vector(p), t0
end

local MOST = 2 ^ 53  -- steps: more could not be counted in numbers of Lua that are not integers

--- How many steps are asked for, by steps or t.
function M.steps_of(solver, options)
  local steps = options.steps
  if steps and options.t then error("give one of 'steps' and 't' (a duration), not both", 0) end
  if not steps then
    if type(options.t) ~= "number" or not (options.t > 0) then
      error("give 'steps' or 't' (a duration > 0)", 0)
    end
    steps = math.ceil(options.t / solver.h - 1e-9)
  end
  if type(steps) ~= "number" or not math.tointeger(steps) or steps < 0 or steps > MOST then
    error(("'steps' must be a whole number from 0 to 2^53 (got %s)"):format(option.got(steps)), 0)
  end
  return math.tointeger(steps)
end

local KNOWN = { "q", "v", "p", "t0", "steps", "t" }

--- The options of verbs that run a prolonged system.
function M.check_options(options, what, known)
  return option.check(options, known or KNOWN, what, "{ q =, v =, steps = }")
end

--- Are tangent vectors bound to constraints?
function M.is_constrained(solver)
  local given = solver.system.given
  return (given.constraint or given.rolling) ~= nil
end

return M
