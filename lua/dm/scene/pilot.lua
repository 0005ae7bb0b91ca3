--- Pilot runs of a scene: a model stepped by a rule over the whole time, what is watched at given
-- times, distances between such records. How long the steps are is told by a number N: about so
-- many of them are made.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local engine = require "dm.reference.engine"
local has_own_time = require "dm.base.own_time"

local M = {}

local abs, ceil, max, min, huge = math.abs, math.ceil, math.max, math.min, math.huge

M.is_refusal, M.first_line = engine.is_refusal, engine.words

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

---- solvers ----

local LEAST_SECONDS = 5e-3

-- s of CPU that a run may take: until the deadline of the problem, or of that which it is another
-- form of, while it has one, and its part of all
local function seconds_of(problem)
  problem = problem.parent or problem
  if not problem.deadline then return nil end
  return max(LEAST_SECONDS, min(problem.deadline - core.cpu(), problem.most_seconds))
end

local function options_of(model, more)
  local start = model.start
  local out = { q = start.q, v = start.v, p = start.p, t0 = start.t0, project = start.project,
    seconds = seconds_of(model.problem) }
  for key, value in pairs(more) do out[key] = value end
  return out
end
M.options_of = options_of

--- Runs of a problem end with so many seconds of CPU from now on, each after a part of them; nil:
-- they take as long as they take.
function M.allow(problem, seconds, part)
  problem.deadline = seconds and core.cpu() + seconds
  problem.most_seconds = seconds and seconds * part
end

--- The rule R of "controlled(R)", whose steps are as long as their error allows; else nil.
function M.controlled(rule) return rule:match "^controlled%((.*)%)$" end

--- The rule of models that are solved: what is watched is a function of time there, and any step is
-- as good as another one.
M.EXACT = "exact"
local AT_REST = "verlet"  -- steps what rests there

--- Steps of a rule are of one length, by the time.
function M.is_even(rule) return not (M.controlled(rule) or has_own_time(rule)) end

local STANDARD, PROBES = 1e-9, { 64, 4096 }
local PLACES = 0.6180339887  -- where the mean of V is taken: never in step with the motion
local FEWEST = 16            -- the part of the steps of a probe that must be made at least
local OVER = 16              -- times the steps that were thought: such a run has lost its way

-- ds/dt of log-hamiltonian, |V|, in the mean over the motion; where it is not known, 1; whether V
-- has both signs; how many times the mean step the first one is
local function own_rate(model)
  local start, given, problem = model:ready().start, model.system.given, model.problem
  local V = bound(given.L, given.params)
  local fine, mean, signs = blame.try(function()
    local path = model.system:solver({ rule = "rk8", h = problem.T / 256 }):run(options_of(model, {
      at = M.times(problem, PROBES[1], PLACES), control = { tolerance = 1e-3 } }))
    local sum, least, most = 0, huge, -huge
    for i = 1, #path do
      local value = V(path.q[i], 0 * start.q, path.t[i])
      sum, least, most = sum + abs(value), min(least, value), max(most, value)
    end
    return sum / #path, least < 0 and most > 0
  end)
  if not (fine and mean > 0 and mean < huge) then return 1, fine and signs, 1 end
  return mean, signs, mean / abs(V(start.q, 0 * start.q, start.t0))
end

local SHORTER, TRIES = 1 / 16, 3
local ALMOST = "%s: V almost vanishes at the start, where its steps are too long"

-- the length of the motion in the time of a rule that has its own, with steps that are short enough
-- to tell: shorter ones where they fail
local function length_of(model, rule, finish)
  local mean, signs, first = 1, false, 1
  if rule:find "^log%-hamiltonian" then mean, signs, first = own_rate(model) end
  if signs then
    error(("%s: V changes its sign on the way, where its steps have no length"):format(rule), 0)
  end
  -- even of the finest probe's steps the first one leaves the motion: what comes after takes long
  if not (first < PROBES[2]) then error(ALMOST:format(rule), 0) end
  local h, count, steps, failed = mean * model.problem.T / PROBES[1], 0, nil, nil
  for _ = 1, TRIES + 2 do
    local solver = model:ready().system:solver { rule = rule, h = h }
    local fine, why = blame.try(solver.run, solver, options_of(model, { at = finish }))
    if fine then
      count, steps = count + 1, solver:report().steps
      if count == 2 then return h * max(1, steps), steps end
      h = h * max(1, steps) / PROBES[2]
    else
      failed, h = why, h * SHORTER
    end
  end
  error(failed, 0)
end

-- how many steps a rule with lengths of its own makes of the whole, and at which tolerance, or how
-- long it is in its own time
local function measured_scale(model, rule)
  local T, inner = model.problem.T, M.controlled(rule)
  local finish = { model.problem.t0 + T }
  if inner then
    local solver = model:ready().system:solver { rule = inner, h = T / 256 }
    solver:run(options_of(model, { at = finish, control = { tolerance = STANDARD,
      largest = T / 2, hidden = model.untouched and model.problem.hidden or nil } }))
    return { solver = solver, N = max(4, solver:report().steps), order = solver.order }
  end
  local length, steps = length_of(model, rule, finish)
  if steps < PROBES[2] / FEWEST then
    error(ALMOST:format(rule), 0)
  end
  return { length = length }
end

-- the same, found once for a model, and so is that there is none
local function scale_of(model, rule)
  model.scales = model.scales or {}
  local known = model.scales[rule]
  if not known then
    local fine, out = blame.try(measured_scale, model, rule)
    known = fine and out
      or { why = "cannot step this system: " .. M.first_line(out):gsub("^[^:]*: ", "") }
    model.scales[rule] = known
  end
  if known.why then error(known.why, 0) end
  return known
end

-- the solver, its control or nil, the most steps of a rule with lengths of its own or nil
local function solver_of(model, rule, N)
  local problem = model.problem
  if M.is_even(rule) then
    return model:ready().system:solver { rule = rule == M.EXACT and AT_REST or rule,
      h = problem.T / N }
  end
  local scale = scale_of(model, rule)
  if scale.length then
    return model:ready().system:solver { rule = rule, h = scale.length / N }, nil, OVER * ceil(N)
  end
  local tolerance = max(1e-17, STANDARD * (scale.N / N) ^ (scale.order + 1))
  return scale.solver, { tolerance = min(0.1, tolerance), largest = problem.T / 2,
    reach = problem.t0 + problem.T, hidden = model.untouched and problem.hidden or nil }
end

--- Run N steps of a rule on a model with the options `more` of solver:run; path, report. Without
-- times to be kept it is the end.
function M.go(model, rule, N, more)
  local solver, control, most = solver_of(model, rule, N)
  local options = options_of(model, more)
  if not more.at then
    if M.is_even(rule) then
      options.steps, options.every = more.steps or N, more.every or more.steps or N
    else
      options.steps, options.every = nil, nil
      options.at = { model.problem.t0 + model.problem.T }
    end
  end
  options.control, options.most = control, most
  local path = solver:run(options)
  return path, solver:report()
end

--- Columns of what is watched at the times, by N steps, and the report; or nil and why not.
function M.run(model, rule, N, times)
  local fine, path, report = blame.try(M.go, model, rule, N,
    { at = times, watch = model:ready().watch })
  if not fine then return nil, M.first_line(path) end
  return M.record(model.problem, path), report
end

--- Columns of a path as a record.
function M.record(problem, path)
  local out = {}
  for _, name in ipairs(problem.columns) do out[name] = path:column(name) end
  return out
end

---- distances ----

--- Largest distance of two records in parts of the tolerance.
function M.apart(problem, a, b)
  local worst = 0
  for _, name in ipairs(problem.columns) do
    local d, tolerance = (a[name] - b[name]):totable(), problem.tolerance[name]
    for i = 1, #d do
      local here = abs(d[i]) / tolerance
      if here ~= here then return huge end
      worst = max(worst, here)
    end
  end
  return worst
end

local UNIT = 2 ^ -52

--- What numbers of a record are rounded by, in parts of the tolerance.
function M.round_off(problem, record)
  local worst = 0
  for _, name in ipairs(problem.columns) do
    local tolerance = problem.tolerance[name]
    for _, x in ipairs(record[name]:totable()) do worst = max(worst, UNIT * abs(x) / tolerance) end
  end
  return worst
end

-- An error that goes like a parabola between the times is an eighth of its second difference more
-- than it is at them, one with a kink up to a half; the margin is for what is left.
local BEND, MARGIN = 1 / 4, 1.1

--- The same with what the difference may be between the rows: as it bends there, and a margin.
function M.apart_between(problem, a, b)
  local worst = 0
  for _, name in ipairs(problem.columns) do
    local d, tolerance = (a[name] - b[name]):totable(), problem.tolerance[name]
    for i = 1, #d do
      local bend = i > 1 and i < #d and BEND * abs(d[i - 1] - 2 * d[i] + d[i + 1]) or 0
      local here = (abs(d[i]) + bend) / tolerance
      if here ~= here then return huge end
      worst = max(worst, here)
    end
  end
  return MARGIN * worst
end

local SHARP, NEARLY = 0.1, 0.8 -- of the largest difference: a second one, what may be as large

--- Numbers of the rows about which the difference bends so much that it may be the largest between
-- them, and how large, in tolerances: { i = largest }; err: what apart_between told.
function M.unresolved(problem, a, b, err)
  local out = {}
  for _, name in ipairs(problem.columns) do
    local d = (a[name] - b[name]):totable()
    local tolerance = problem.tolerance[name]
    local most = err / MARGIN * tolerance
    for i = 2, #d - 1 do
      local bend = abs(d[i - 1] - 2 * d[i] + d[i + 1])
      local here = abs(d[i]) + bend
      if bend > SHARP * most and here > NEARLY * most then
        out[i] = max(out[i] or 0, MARGIN * here / tolerance)
      end
    end
  end
  return out
end

--- The first rows of a record, `count` of them.
function M.first_rows(problem, record, count)
  local out = {}
  for _, name in ipairs(problem.columns) do out[name] = record[name]:slice(1, count) end
  return out
end

---- how fast ----

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
  local fine, squared = blame.try(function()
    local function L(q, v, t) return given.L(q, v, t, given.params) end
    local H = core.trace(L, n, n, "number"):hessian(start.q, start.v, start.t0)
    return stiffness(H, term and term:hessian(start.q, start.v, start.t0) or H, n)
  end)
  return fine and squared == squared and math.sqrt(squared) or 0
end

--- A number of steps at which Gauss collocation begins to see the fastest oscillation.
function M.first_N(model) return max(16, model.problem.T * M.frequency(model) / 2) end

---- runs that find their own steps ----

local RULES = { "rk8", "gauss(4)", "degenerate(3)" }

--- The path of a model by steps as long as a tolerance allows: at times, or at each of them. Path,
-- or nil and why not.
function M.free_run(model, tolerance, more)
  local problem, why = model.problem, nil
  for _, rule in ipairs(RULES) do
    local fine, path = blame.try(function()
      local options = options_of(model:ready(), { control = { tolerance = tolerance,
        largest = problem.T / 16 } })
      for key, value in pairs(more) do options[key] = value end
      if not options.at then options.t = problem.T end
      return model.system:solver({ rule = rule, h = problem.T / 256 }):run(options)
    end)
    if fine then return path end
    if not why or M.is_refusal(why) then why = M.first_line(path) end
    if not M.is_refusal(M.first_line(path)) then return nil, why end
  end
  return nil, why
end

return M
