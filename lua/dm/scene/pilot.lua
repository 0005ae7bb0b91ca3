--- Pilot runs of a scene: a model stepped N times over the whole time, what is watched at given
-- times, distances between such records.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local abs, max, floor = math.abs, math.max, math.floor

--- Times that do not fall in step with anything: `count` of them, t0 < t <= t0 + T, the last one at
-- the end.
function M.times(problem, count, seed)
  local out = {}
  for i = 1, count do
    local jitter = (i * seed) % 1
    out[i] = problem.t0 + problem.T * (i == count and 1 or (i - 0.9 * jitter) / count)
  end
  return out
end

--- A failure that only the person at the keyboard can mean is passed on.
function M.pass_stop(failure)
  if blame.is_stop(failure) then error(failure, 0) end
end

local REFUSALS = { "cannot step this system", "needs a regular Lagrangian", "^field 'rule'" }

--- Is it the rule that cannot, whatever the step?
function M.is_refusal(why)
  for _, words in ipairs(REFUSALS) do
    if why:find(words) then return true end
  end
  return false
end

local function options_of(model, more)
  local start = model.start
  local out = { q = start.q, v = start.v, t0 = start.t0, project = start.project }
  for key, value in pairs(more) do out[key] = value end
  return out
end
M.options_of = options_of

function M.solver(model, rule, N)
  return model:ready().system:solver { rule = rule, h = model.problem.T / N }
end

--- Columns of what is watched at the times, by N steps; or nil and why not.
function M.run(model, rule, N, times)
  local fine, path = pcall(function()
    local solver = M.solver(model, rule, N)
    return solver:run(options_of(model, { at = times, watch = model.watch })), solver:report()
  end)
  if not fine then
    M.pass_stop(path)
    return nil, tostring(path):match "^[^\n]*":gsub("^.-%.lua:%d+: ", "")
  end
  local out = {}
  for _, name in ipairs(model.problem.columns) do out[name] = path:column(name) end
  return out
end

--- Largest distance of two records in parts of the tolerance, over their rows from..to (default
-- all).
function M.apart(problem, a, b)
  local worst = 0
  for _, name in ipairs(problem.columns) do
    local x, y, tolerance = a[name], b[name], problem.tolerance[name]
    for i = 1, #x do
      local d = abs(x[i] - y[i]) / tolerance
      if d ~= d then return math.huge end
      worst = max(worst, d)
    end
  end
  return worst
end

local GIVE_UP = 3  -- failures, or halvings that make nothing better, in a row

--- Halve the step until the record changes by less than `goal` tolerances: record, change, N; or
-- nil, why. how: from (a number of steps), goal, times, seconds (of CPU that may go into it), most
-- (steps)
function M.refine(model, rule, how)
  local begin, took, N, last, change, why = core.cpu(), 0, max(4, floor(how.from)), nil, nil, nil
  local rising, failures = 0, 0
  while N < (how.most or 2 ^ 40) and core.cpu() - begin + 2 * took <= how.seconds do
    local start = core.cpu()
    local record, failed = M.run(model, rule, N, how.times)
    took, why = core.cpu() - start, failed or why
    failures = failed and failures + 1 or 0
    if failed and (M.is_refusal(failed) or failures == GIVE_UP) then return nil, failed end
    if record and last then
      local now = M.apart(model.problem, record, last)
      if now <= how.goal then return record, now, N end
      rising = change and now > 0.5 * change and N > 8 * how.from and rising + 1 or 0
      if rising == GIVE_UP then return nil, M.best_words(model.problem, rule, now, N), now end
      change = now
    end
    last, N = record, 2 * N
  end
  return nil, change and M.best_words(model.problem, rule, change, N // 2) or why
    or "not even one run fits into the time allowed", change
end

function M.best_words(problem, rule, change, N)
  return ("%s still changes by %.1e tolerances when the step is halved to h = %.3g")
    :format(rule, change, problem.T / N)
end

-- largest |eigenvalue| of L_vv^-1 K for the blocks of a Hessian by (q, v, t)
local function stiffness(H, of, n)
  local mass, K = {}, {}
  for i = 1, n do
    mass[i], K[i] = {}, {}
    for k = 1, n do mass[i][k], K[i][k] = H[n + i][n + k], of[i][k] end
  end
  local re, im = (core.matrix(mass):inverse() * core.matrix(K)):eigenvalues()
  local worst = 0
  for i = 1, n do worst = max(worst, math.sqrt(re[i] ^ 2 + im[i] ^ 2)) end
  return worst
end

local LARGEST = 24  -- coordinates for which frequencies are looked at

--- The largest frequency of small oscillations about the start, sqrt |L_vv^-1 L_qq|; of a term of L
-- with the mass of L where one is given. 0 where it is not known.
function M.frequency(model, term)
  model:ready()
  local given, start = model.system.given, model.start
  local n = model.system.Q.dimension
  if n > LARGEST then return 0 end
  local fine, squared = pcall(function()
    local function L(q, v, t) return given.L(q, v, t, given.params) end
    local H = core.trace(L, n, n, "number"):hessian(start.q, start.v, start.t0)
    return stiffness(H, term and term:hessian(start.q, start.v, start.t0) or H, n)
  end)
  if not fine then M.pass_stop(squared) end
  return fine and squared == squared and math.sqrt(squared) or 0
end

-- unlike methods: Gauss collocation, then Runge-Kutta, compositions, Lobatto; the last for L linear
-- in v
local FIRST = { "gauss(6)", "lobatto(6)", "degenerate(3)" }
local SECOND = { "rk8", "kahan-li(8)", "lobatto(5)", "gauss(4)", "degenerate(2)" }
local AGREED = 0.05  -- tolerances

local function first_that_can(model, rules, how)
  local tried = {}
  for _, rule in ipairs(rules) do
    local record, change, N = M.refine(model, rule, how)
    if record then return { rule = rule, record = record, change = change, N = N }, tried end
    if not M.is_refusal(change) then tried[#tried + 1] = change end
  end
  return nil, tried
end

--- A number of steps at which Gauss collocation of order 12 begins to see the fastest oscillation.
function M.first_N(model) return max(16, model.problem.T * M.frequency(model) / 2) end

--- The first rows of a record, `count` of them.
function M.first_rows(problem, record, count)
  local out = {}
  for _, name in ipairs(problem.columns) do out[name] = record[name]:slice(1, count) end
  return out
end

-- Where oscillations are so fast that to follow each of them costs much: two implicit methods with
-- steps that step over them. What they miss acts on the slow motion like a force, so by t^2: a part
-- of the time is run with all oscillations resolved and must agree so well that T is covered too.
local PART, COSTLY = 16, 4096
local UNSEEN = 0.2 / PART ^ 2  -- tolerances

local SLOW = { { "gauss(6)", "lobatto(6)" }, { "gauss(4)", "lobatto(5)" } }

local function slow_reference(model, times, seconds, N0)
  local problem = model.problem
  local how = { from = max(64, N0 / 2 ^ 12), goal = UNSEEN / 4, times = times,
    seconds = seconds / 4, most = N0 }
  local a = first_that_can(model, SLOW[1], how)
  local b = a and first_that_can(model, SLOW[2], how)
  if not b or M.apart(problem, a.record, b.record) > UNSEEN then return nil end
  local count = max(1, #times // PART)
  local resolved = M.refine(model, "gauss(6)",
    { from = N0, goal = UNSEEN / 4, times = { table.unpack(times, 1, count) },
    seconds = seconds / 4 })
  local distance = resolved and M.apart(problem, resolved, M.first_rows(problem, a.record, count))
  if not distance or distance > UNSEEN then return nil end
  return a.record, AGREED,
    ("%s with h = %.3g and %s with h = %.3g, which step over the oscillations, agree to %.1e of "
    .. "the tolerance; with "
    .. "all of them resolved, until t = %.3g, to %.1e")
      :format(a.rule, problem.T / a.N, b.rule, problem.T / b.N,
    M.apart(problem, a.record, b.record), times[count], distance)
end

--- The reference of a scene: two unlike methods on the system as given, each refined until it
-- stays, that agree: record, distance in tolerances, words. Raises what was measured.
function M.reference(model, times, seconds)
  local problem, N0 = model.problem, M.first_N(model)
  if N0 > COSTLY then
    local record, distance, words = slow_reference(model, times, seconds, N0)
    if record then return record, distance, words end
  end
  local how = { from = N0, goal = AGREED / 2, times = times, seconds = seconds }
  local a, tried = first_that_can(model, FIRST, how)
  local nowhere = not a and tried[1] and tried[1]:match "no start: .*"
  if nowhere then error("dm.scene: " .. nowhere, 0) end
  local b, others = nil, {}
  if a then b, others = first_that_can(model, SECOND, how) end
  local distance = a and b and M.apart(problem, a.record, b.record)
  if distance and distance <= 2 * AGREED then
    return a.record, distance,
      ("%s with h = %.3g and %s with h = %.3g agree to %.1e of the tolerance")
      :format(a.rule, problem.T / a.N,
      b.rule, problem.T / b.N, distance)
  end
  for _, words in ipairs(others) do tried[#tried + 1] = words end
  if distance then
    tried[#tried + 1] = ("%s and %s have settled, but %.1e tolerances apart")
      :format(a.rule, b.rule, distance)
  end
  error(("dm.scene: the tolerance cannot be promised, since no reference is known that well: %s. "
    .. "Is the motion chaotic over this time, or the "
    .. "tolerance below round-off? Take a larger tolerance, a shorter until_t, watch something "
      .. "less sensitive, or give more seconds")
    :format(table.concat(tried, "; ")), 0)
end

return M
