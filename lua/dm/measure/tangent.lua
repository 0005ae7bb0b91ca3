--- Structure, measured: the exact tangent map of a solver, the symplecticity of its step,
-- reversal, energy.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local on_group = require "dm.measure.on_group"
local own_step = require "dm.measure.own_step"
local prolong = require "dm.measure.prolong"
local prolonged = require "dm.measure.prolonged_run"
local starts = require "dm.base.start"

local M = {}

local abs, log, max = math.abs, math.log, math.max
local check_options, is_constrained, refuse = prolonged.check_options, prolonged.is_constrained,
  prolonged.refuse
local solver_of, start_of, steps_of = prolonged.solver_of, prolonged.start_of, prolonged.steps_of

-- unit vectors of n entries
local function units(n)
  local out = {}
  for k = 1, n do
    local unit = lists.zeros(n)
    unit[k], out[k] = 1, unit
  end
  return out
end

-- the same from the derivatives of the steps, one by one
local function columns_of_steps(solver, options)
  local q, p, t0 = start_of(solver, options)
  if is_constrained(solver) then
    error(("%s is curves by a method that is not linear in the values of f: its tangent is not "
      .. "known with constraints"):format(tostring(solver.rule)), 0)
  end
  local out, first = {}, units(2 * #q)
  for k, unit in ipairs(first) do out[k] = core.vector(unit) end
  for i = 1, steps_of(solver, options) do
    local D
    D, q, p = solver:step_tangent { q = q, p = p, t0 = t0 + (i - 1) * solver.h }
    for k = 1, #out do out[k] = D * out[k] end
  end
  return out, first, q, p
end

-- the same of a dm.step, by the derivatives of its functions
local function columns_of_own(solver, options)
  local q, p, t0 = start_of(solver, options)
  local s, first = { q = q, p = p, t = t0 }, units(2 * #q)
  local along = own_step.map(solver, "solver:tangent")
  return along(s, steps_of(solver, options), first), first, s.q, s.p
end

-- where the unit vectors of (q, p), or what of them is tangent to the constraints, lead; and these;
-- and the end of the run
local function columns(solver, options)
  if own_step.is(solver) then return columns_of_own(solver, options) end
  if not prolonged.prolongs(solver) then return columns_of_steps(solver, options) end
  local q, p, t0 = start_of(solver, options)
  local n, steps = #q, steps_of(solver, options)
  local lifted = solver_of(solver, prolong.system(solver.system))
  local out, first, last = {}, {}, nil
  for k = 1, 2 * n do
    local u, dp = lists.zeros(n), lists.zeros(n)
    if k <= n then u[k] = 1 else dp[k - n] = 1 end
    last = lifted:run { q = lists.joined(q, u), p = lists.joined(dp, p), t0 = t0, steps = steps,
      every = max(steps, 1),
      project = is_constrained(solver) }
    local function vector(i)
      return lists.joined(lists.part(last.q[i], n, n), lists.part(last.p[i], 0, n))
    end
    first[k], out[k] = vector(1), vector(#last)
  end
  return out, first, lists.part(last.q[#last], 0, n), lists.part(last.p[#last], n, n)
end

local function matrix_of(cols)
  local rows = {}
  for i = 1, #cols do
    rows[i] = {}
    for k = 1, #cols do rows[i][k] = cols[k][i] end
  end
  return core.matrix(rows)
end

local doc_tangent = [[
solver:tangent{q=, v= | p=, steps= | t=, t0=} -> dm.matrix, q, p
The exact derivative of the flow of the rule, d(q, p at the end)/d(q, p at the start), 2 dim Q x 2
dim Q, not a difference: the rule steps the prolonged Lagrangian dL . (u, w), whose step is the
tangent of the step. Also the end of the run. With constraints the start must lie on them, and so
must each column: use tangent vectors of solver:lyapunov instead. On a group the changes are g^-1 dg
and that of the body momentum (right trivialization: dg g^-1, of the spatial one); with constraints
or rolling it is the derivative of the step after the nearest changes that these allow.]]

-- the start of a run on a group: an element stays one
local function start_on_group(solver, options)
  prolonged.check_start(options)
  return { q = options.q, v = options.v, p = options.p, t0 = options.t0 or 0,
    steps = steps_of(solver, options) }
end

M.tangent = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  check_options(options, "solver:tangent")
  refuse(solver, "solver:tangent")
  if solver.system.place then
    local start = start_on_group(solver, options)
    local cols, _, q, p = on_group.columns(solver, start, "solver:tangent")
    return matrix_of(cols), q, p
  end
  if is_constrained(solver) then
    error("solver:tangent: the unit vectors of (q, p) are not tangent to the constraints of this "
      .. "system", 0)
  end
  local cols, _, q, p = columns(solver, options)
  return matrix_of(cols), q, p
end)

-- largest change of the two-form between the vectors, over the square of the largest entry where
-- that is above 1
local function defect_of(cols, first)
  local n, worst, size = #cols // 2, 0, 1
  local function form(list, a, b)
    local sum = 0
    for i = 1, n do sum = sum + list[a][i] * list[b][n + i] - list[a][n + i] * list[b][i] end
    return sum
  end
  for i = 1, 2 * n do
    for k = 1, 2 * n do size = max(size, abs(cols[k][i])) end
  end
  for a = 1, 2 * n do
    for b = 1, 2 * n do worst = max(worst, abs(form(cols, a, b) - form(first, a, b))) end
  end
  return worst / size ^ 2
end

local doc_symplecticity = [[
solver:symplecticity{q=, v= | p=, steps= | t=, t0=} -> number
The largest entry of M^T J M - J, M the exact tangent map of the run (solver:tangent), relative to
the square of the largest entry of M where that is above 1: round-off for a symplectic rule, the
defect of any other. With constraints: of the two-form on the vectors that are tangent to them.]]

M.symplecticity = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  check_options(options, "solver:symplecticity")
  refuse(solver, "solver:symplecticity")
  if solver.system.place then
    return on_group.defect(solver, start_on_group(solver, options), "solver:symplecticity")
  end
  local cols, first = columns(solver, options)
  return defect_of(cols, first)
end)

---- there and back ----

-- the system run backwards: L(q, -v, t1 - t), of an H alone H(q, -p, t1 - t)
local function reversed(system, t1)
  local given, own = system.given, system.place
  local side = own and own.right and "right" or nil
  local function back(f)
    return f and function(q, v, t) return f(q, -v, t1 - t, given.params) end
  end
  if not given.L then
    return core.system { Q = given.Q, H = back(given.H), trivialization = side }
  end
  local out = { Q = given.Q, L = back(given.L), force = back(given.force),
    rolling = back(given.rolling), reaction = back(given.reaction), trivialization = side }
  if given.constraint then
    out.constraint = function(q, t) return given.constraint(q, t1 - t, given.params) end
  end
  return core.system(out)
end

local doc_reversal = [[
solver:reversal{q=, v= | p=, steps= | t=, t0=} -> number
Run, then run L(q, -v, -t), or H(q, -p, -t), from the end with the momentum reversed: the largest
distance from the start in any entry of q (on a group that of elements) or p. Round-off, as far as
the orbit lets it stay so, for a symmetric rule; the error of the step for any other.]]

M.reversal = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  check_options(options, "solver:reversal")
  local what = "solver:reversal"
  refuse(solver, what)
  if (solver.system.given or solver.system).control then
    error(what .. ": a control is held from the start of a step, which run backwards is its end",
      0)
  end
  prolonged.check_start(options)
  local steps = steps_of(solver, options)
  local there = solver:run { q = options.q, v = options.v, p = options.p, t0 = options.t0,
    steps = steps, every = max(steps, 1) }
  local t1 = there.t[#there]
  local back = solver_of(solver, reversed(solver.system, t1)):run {
    q = there.q[#there], p = -there.p[#there], steps = steps, every = max(steps, 1) }
  local Q, p, r = solver.system.Q, there.p[1], back.p[#back]
  local q, z = there.q[1], back.q[#back]
  local worst = solver.system.place and Q:distance(q, z) or 0
  for i = 1, solver.system.place and 0 or #q do worst = max(worst, abs(z[i] - q[i])) end
  for i = 1, #p do worst = max(worst, abs(r[i] + p[i])) end
  return worst
end)

---- backward error ----

local doc_backward = [[
solver:backward_error{q=, v= | p=, steps= | t=, t0=} -> {amplitude, order, drift, error, ...}
The energy along the run next to that of half the step over the same time. A symplectic rule of
order p keeps a modified energy H + h^p H_p + ... up to exponentially small terms (Hairer, Lubich &
Wanner IX.8): H then stays within `amplitude` = h^p max |H_p - mean| of its mean, order = log2 of
the ratio of the two amplitudes is p, and what the modified energy itself drifts is the slope
`drift` of H per unit of time, with its standard error `error`. energy, mean: at the start and
along the run; finer: the same figures with h/2.]]

local function energies(solver, options, steps, every)
  local path = solver:run { q = options.q, v = options.v, p = options.p, t0 = options.t0,
    steps = steps, every = every }
  local drift, E = path:drift "energy", path:energy()
  local spread = 0
  for i = 1, #E do spread = max(spread, abs(E[i] - drift.mean)) end
  return drift, spread, E[1]
end

M.backward_error = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  check_options(options, "solver:backward_error")
  refuse(solver, "solver:backward_error", options.steps ~= nil)
  local steps = steps_of(solver, options)
  local every = max(1, steps // 20000)
  if steps // every < 16 then error("solver:backward_error needs at least 16 steps", 0) end
  local drift, spread, E0 = energies(solver, options, steps, every)
  local finer, less = energies(solver_of(solver, solver.system, solver.h / 2), options, 2 * steps,
    2 * every)
  local order = less > 0 and log(spread / less, 2) or math.huge
  return core.result { amplitude = spread, order = order, drift = drift.per_time,
    error = drift.error, energy = E0,
    mean = drift.mean, finer = { amplitude = less, drift = finer.per_time, error = finer.error,
      mean = finer.mean } }
end)

core.method("dm.solver", "tangent", M.tangent, doc_tangent)
core.method("dm.solver", "symplecticity", M.symplecticity, doc_symplecticity)
core.method("dm.solver", "reversal", M.reversal, doc_reversal)
core.method("dm.solver", "backward_error", M.backward_error, doc_backward)

return M
