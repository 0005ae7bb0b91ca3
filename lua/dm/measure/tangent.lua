--- Structure, measured: the exact tangent map of a solver, the symplecticity of its step, chaos,
-- reversal, energy.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local prolong = require "dm.measure.prolong"
local starts = require "dm.base.start"

local M = {}

local abs, sqrt, log, max = math.abs, math.sqrt, math.log, math.max

local function newton(solver)
  return { tolerance = solver.tolerance, max_iterations = solver.max_iterations }
end

local function solver_of(solver, system, h)
  local rule = prolong.rule(solver.system, solver.rule)
  return system:solver { rule = rule, h = h or solver.h, newton = newton(solver) }
end

-- why L~ stepped by the rule is not the tangent of the rule, or nothing
local function refuse(solver, what)
  local rule = tostring(solver.rule)
  local given = solver.system.given
  if rule:find "^degenerate" then
    error(what .. ": L is linear in v, so that p is a function of q, and (q, p) has no "
      .. "neighbours off p = alpha(q): not for rule '"
      .. rule .. "'", 0)
  end
  if not (given and given.L) then
    error(what .. ": a discrete Lagrangian has no prolonged system here; use a dm.system", 0)
  end
  if solver.system.given.control then
    error(what .. ": a control held over a step is not part of the prolonged system; put it into "
      .. "'force' to see its tangent", 0)
  end
  if rule:find "^log%-hamiltonian" then
    error(what .. ": '" .. rule
      .. "' changes the time with the state, so the prolonged system runs on another time: "
      .. "use a rule with a fixed step", 0)
  end
end

-- q and p at the start; t0
local function start_of(solver, options)
  local system = solver.system
  local t0 = options.t0 or 0
  if not options.q or not (options.v or options.p) then
    error("give the start as q and v, or as q and p", 0)
  end
  local p = options.p or system:legendre(options.q, options.v, t0)
  return core.vector(options.q), core.vector(p), t0
end

local MOST = 2 ^ 53  -- steps: more could not be counted in numbers of Lua that are not integers

local function steps_of(solver, options)
  local steps = options.steps
  if not steps then
    if type(options.t) ~= "number" or not (options.t > 0) then
      error("give 'steps' or 't' (a duration > 0)", 0)
    end
    steps = math.ceil(options.t / solver.h - 1e-9)
  end
  if not math.tointeger(steps) or steps < 0 or steps > MOST then
    error(("'steps' must be a whole number from 0 to 2^53 (got %s)"):format(tostring(steps)), 0)
  end
  return math.tointeger(steps)
end

local KNOWN = { "q", "v", "p", "t0", "steps", "t" }
local function check_options(options, what, known)
  return option.check(options, known or KNOWN, what, "{ q =, v =, steps = }")
end

local function is_constrained(solver)
  local given = solver.system.given
  return (given.constraint or given.rolling) ~= nil
end

-- where the unit vectors of (q, p), or what of them is tangent to the constraints, lead; and these;
-- and the end of the run
local function columns(solver, options)
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
must each column: use tangent vectors of solver:lyapunov instead.]]

M.tangent = blame.caller(function(solver, options)
  options = starts.lists(options, solver)
  check_options(options, "solver:tangent")
  refuse(solver, "solver:tangent")
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
  options = starts.lists(options, solver)
  check_options(options, "solver:symplecticity")
  refuse(solver, "solver:symplecticity")
  local cols, first = columns(solver, options)
  return defect_of(cols, first)
end)

---- chaos ----

local LARGEST = 200  -- growth of ln |tangent vector| within a block: far from overflow

-- the tangent vector: given, or one without symmetry, made a unit vector
local function first_vector(options, n)
  for _, name in ipairs { "u", "dp" } do
    local given = options[name]
    local kind = type(given) == "userdata" and (getmetatable(given) or {}).__name or type(given)
    if given ~= nil and ((kind ~= "table" and kind ~= "dm.vector") or #given ~= n) then
      error(("solver:lyapunov: option '%s' must be a vector or table of %d numbers (got %s)")
        :format(name, n,
        (kind == "table" or kind == "dm.vector") and #given or kind), 0)
    end
  end
  local u, dp = options.u or {}, options.dp or {}
  local out = {}
  for i = 1, n do
    out[i] = u[i] or (options.dp and 0 or 1 / (1 + i))
    out[n + i] = dp[i] or (options.u and 0 or 1 / (2 + i * i))
  end
  local size = 0
  for i = 1, 2 * n do size = size + out[i] ^ 2 end
  if not (size > 0) then error("solver:lyapunov: the tangent vector u, dp is zero", 0) end
  for i = 1, 2 * n do out[i] = out[i] / sqrt(size) end
  return out
end

-- ln of the length of (u, dp) along the run, as a watched number
local function growth(n)
  return function(x, _, _, p)
    local sum = 0
    for i = 1, n do sum = sum + x[n + i] ^ 2 + p[i] ^ 2 end
    return 0.5 * math.log(sum)
  end
end

-- one block of steps from state s; rows of (t, ln growth) are added to the record
local function block(lifted, s, n, steps, every)
  local q, p = core.vector(s.x), core.vector(s.p)
  local path = lifted:run { q = q, p = p, t0 = s.t, steps = steps, every = every,
    project = s.project,
    watch = { "energy", growth = growth(n), x = function(x) return x end,
      p = function(_, _, _, y) return y end } }
  local ln = path:column "growth"
  return path, ln
end

local function end_of(path, n)
  local x, p = {}, {}
  for i = 1, 2 * n do
    x[i], p[i] = path:column("x" .. i)[#path], path:column("p" .. i)[#path]
  end
  return x, p
end

-- MEGNO (Cincotta & Simo 2000): Y(t) = 2/t int (d ln|u|/ds) s ds, and its mean over time
local function follow(record, t, dt, dln)
  record.sum = record.sum + dln * (t - 0.5 * dt - record.t0)
  record.growth = record.growth + dln
  local age = t - record.t0
  local Y = 2 * record.sum / age
  record.mean = record.mean + 0.5 * (Y + record.Y) * dt
  record.Y = Y
  local i = #record.t + 1
  record.t[i], record.exponent[i], record.megno[i] = t, record.growth / age, record.mean / age
end

local doc_lyapunov = [[
solver:lyapunov{q=, v= | p=, steps= | t=, every=, u=, dp=, t0=} -> {exponent, megno, t, ...}
Follow one tangent vector (u, dp; default: one without symmetry) by the exact tangent map of the
rule. exponent: ln |growth| / t, the largest Lyapunov exponent, per unit of time, of the last row;
megno: the mean of MEGNO (Cincotta & Simo 2000), which tends to 2 on a regular orbit and to exponent
* t / 2 on a chaotic one. A row is taken every `every` steps (default: 1000 rows). history: {t,
exponent, megno} of all rows; q, p: the end.]]

M.lyapunov = blame.caller(function(solver, options)
  options = starts.lists(options, solver)
  check_options(options, "solver:lyapunov",
    { "q", "v", "p", "t0", "steps", "t", "every", "u", "dp" })
  refuse(solver, "solver:lyapunov")
  local n, steps = #(options.q or {}), steps_of(solver, options)
  if steps < 1 then error("solver:lyapunov needs at least one step", 0) end
  local every = options.every or max(1, steps // 1000)
  local q, p, t0 = start_of(solver, options)
  local w = first_vector(options, n)
  local s = { t = t0, x = {}, p = {}, project = is_constrained(solver) }
  for i = 1, n do s.x[i], s.x[n + i], s.p[i], s.p[n + i] = q[i], w[i], w[n + i], p[i] end
  local lifted = solver_of(solver, prolong.system(solver.system))
  local record = { t0 = t0, sum = 0, growth = 0, mean = 0, Y = 0, t = {}, exponent = {},
    megno = {} }
  local done, length = 0, every * 64
  while done < steps do
    local now = math.min(length, steps - done)
    local path, ln = block(lifted, s, n, now, every)
    if abs(ln[#ln]) > LARGEST and now > every then
      length = max(every, (now // every // 2) * every)
    else
      for i = 2, #path do
        follow(record, path.t[i], path.t[i] - path.t[i - 1], ln[i] - ln[i - 1])
      end
      s.x, s.p = end_of(path, n)
      local scale = math.exp(-ln[#ln])
      for i = 1, n do s.x[n + i], s.p[i] = s.x[n + i] * scale, s.p[i] * scale end
      done, s.t = done + now, t0 + (done + now) * solver.h
      if abs(ln[#ln]) < LARGEST / 4 and length < every * 4096 then length = length * 2 end
    end
  end
  local last = #record.t
  return core.result { exponent = record.exponent[last], megno = record.megno[last],
    t = record.t[last],
    history = { t = core.vector(record.t), exponent = core.vector(record.exponent),
      megno = core.vector(record.megno) },
    q = lists.part(s.x, 0, n), p = lists.part(s.p, n, n) }
end)

---- there and back ----

-- the system run backwards: L(q, -v, t1 - t)
local function reversed(system, t1)
  local given = system.given
  local function back(f)
    return f and function(q, v, t) return f(q, -v, t1 - t, given.params) end
  end
  local out = { Q = given.Q, L = back(given.L), force = back(given.force),
    rolling = back(given.rolling),
    reaction = back(given.reaction) }
  if given.constraint then
    out.constraint = function(q, t) return given.constraint(q, t1 - t, given.params) end
  end
  return core.system(out)
end

local doc_reversal = [[
solver:reversal{q=, v= | p=, steps= | t=, t0=} -> number
Run, then run L(q, -v, -t) from the end with the momentum reversed: the largest distance from the
start in any entry of q or p. Round-off, as far as the orbit lets it stay so, for a symmetric rule;
the error of the step for any other.]]

M.reversal = blame.caller(function(solver, options)
  check_options(options, "solver:reversal")
  options = starts.lists(options, solver)
  local what = "solver:reversal"
  refuse(solver, what)
  local steps = steps_of(solver, options)
  local q, p, t0 = start_of(solver, options)
  local there = solver:run { q = q, p = p, t0 = t0, steps = steps, every = max(steps, 1) }
  local t1 = there.t[#there]
  local back = solver_of(solver, reversed(solver.system, t1)):run {
    q = there.q[#there], p = -there.p[#there], steps = steps, every = max(steps, 1) }
  local worst = 0
  for i = 1, #q do
    worst = max(worst, abs(back.q[#back][i] - q[i]), abs(back.p[#back][i] + p[i]))
  end
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
  check_options(options, "solver:backward_error")
  refuse(solver, "solver:backward_error")
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
core.method("dm.solver", "lyapunov", M.lyapunov, doc_lyapunov)
core.method("dm.solver", "reversal", M.reversal, doc_reversal)
core.method("dm.solver", "backward_error", M.backward_error, doc_backward)

return M
