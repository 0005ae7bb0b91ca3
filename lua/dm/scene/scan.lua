--- The least number of steps of a rule on a model that keeps the tolerance. Errors do not fall with
-- every step more: where steps are longer than what is fast, 12 may serve, 40 not, and 400 again.
-- So what costs no more than the best so far is tried at every place of a grid that is the same for
-- all tolerances. Then a larger tolerance finds all that a smaller one does, and costs no more.
local blame = require "dm.base.blame"
local core = require "dm.core"
local narrow = require "dm.scene.narrow"
local pilot = require "dm.scene.pilot"

local M = {}

local max, min, ceil, floor, huge = math.max, math.min, math.ceil, math.floor, math.huge

M.TARGET = 0.85  -- of the tolerance, at the sampled times; the rest is for what lies between
-- what would cost so many times the best is still looked at: a part of the steps tells what all
-- cost, and clocks are not that good
local SLACK, CLOCK_SLACK = 1.05, 1.25
local CLOSE = 1.07   -- numbers of steps between success and failure are then close enough
local FEWEST = 2

---- the grid ----

-- All numbers at first: of ten steps one more may take a tenth of the iterations from each.
local ALL, RATIO, LARGEST = 20, 1.25, 2 ^ 40
local GRID = { FEWEST }
while GRID[#GRID] < LARGEST do
  local N = GRID[#GRID]
  GRID[#GRID + 1] = N < ALL and N + 1 or ceil(N * RATIO)
end

-- the first place whose number is not below N
local function place_of(N)
  local at = 1
  while GRID[at] < N and GRID[at + 1] do at = at + 1 end
  return at
end

---- errors, the cheapest look first ----

local ENDS, MOST_ENDS = 16, 8192  -- rows at ends of steps, up to so many of them
local MANY, PART = 1024, 12  -- from so many steps on a run is tried over a part of the time first
local LONG, EIGHTH = 64, 8   -- the same, at ends

--- Lists of times: for each number of the grid some ends of its steps, by the number of the list.
-- A step that ends there costs no row of its own.
function M.ends(problem)
  local lists, ends = {}, {}
  for _, N in ipairs(GRID) do
    if N > MOST_ENDS then break end
    local every, times = ceil(N / ENDS), {}
    for i = 1, N // every do times[i] = problem.t0 + problem.T * (i * every) / N end
    lists[#lists + 1] = times
    ends[N] = { every = every, rows = #times, list = #lists }
  end
  return ends, lists
end

-- every so many rows of times and of their record
local function sparse(problem, times, record)
  local some, of_them = {}, {}
  for i = PART, #times, PART do some[#some + 1] = times[i] end
  for _, name in ipairs(problem.columns) do
    local list = {}
    for i = PART, #times, PART do list[#list + 1] = record[name][i] end
    of_them[name] = core.vector(list)
  end
  return { times = some, reference = of_them }
end

--- Prepare a search: the rows of the reference that are looked at first, of long and short runs.
function M.prepare(search, problem)
  local count = max(1, #search.times // PART)
  search.most = search.profile:is_counted() and SLACK or CLOCK_SLACK
  search.early = { times = { table.unpack(search.times, 1, count) },
    reference = pilot.first_rows(problem, search.reference, count) }
  search.sparse = sparse(problem, search.times, search.reference)
  return search
end

-- error of N steps at rows of the reference, in tolerances; inf where the run fails
local function error_at(search, model, rule, N, rows)
  search.pilots = search.pilots + 1
  local record, why = pilot.run(model, rule, N, rows.times)
  if not record then return huge, why end
  return pilot.apart(model.problem, record, rows.reference)
end

-- error of N steps at ends of steps, so many of those whose reference is known
local function error_at_steps(search, model, rule, N, known, rows)
  search.pilots = search.pilots + 1
  local steps, problem = rows * known.every, model.problem
  local fine, path, report = blame.try(pilot.go, model, rule, N,
    { steps = steps, every = known.every, watch = model:ready().watch })
  if not fine then return huge, pilot.first_line(path) end
  search.profile:told(model, rule, N, report, steps)
  local record = {}
  for _, name in ipairs(problem.columns) do record[name] = path:column(name):slice(2, rows + 1) end
  return pilot.apart(problem, record, pilot.first_rows(problem, known.reference, rows))
end

-- a first look at N steps: beyond the tolerance here is beyond it
local function first_look(search, model, rule, N)
  local known = search.ends[N]
  if not (known and pilot.is_even(rule)) then
    return error_at(search, model, rule, N, search.early)
  end
  if N > LONG then
    local err, why = error_at_steps(search, model, rule, N, known, max(1, known.rows // EIGHTH))
    if err > 1 then return err, why end
  end
  return error_at_steps(search, model, rule, N, known, known.rows)
end

--- Error of N steps at the times of the search; beyond the tolerance, of a part of them.
local function at_rows(search, model, rule, N)
  local err, why = error_at(search, model, rule, N, N > MANY and search.early or search.sparse)
  if err > 1 then return err, why end
  return error_at(search, model, rule, N, search)
end
M.at_rows = at_rows

---- what the bound pays for ----

-- does the bound pay for N steps? Or why such a run fails
local function pays(search, model, rule, N)
  local fine, ns = blame.try(search.profile.about, search.profile, model, rule, N)
  if fine then return ns <= search.most * search.bound, nil, ns end
  return false, pilot.first_line(ns)
end

local MORE, PROBES = 4, 20

-- The largest number of steps that the bound may pay for; nil and why where there is none. A step
-- costs less the shorter it is, as implicit rules settle sooner, so that what it costs where the
-- bound no longer pays for all of them tells the number.
local function affordable(search, model, rule, guess)
  local N, why = guess, nil
  for _ = 1, PROBES do
    N = MORE * N
    local fits, failed, ns = pays(search, model, rule, N)
    if failed and (why or pilot.is_refusal(failed)) then return nil, failed, N end
    why = failed
    if ns and not fits then
      local most = floor(N * search.most * search.bound / ns)
      if most >= FEWEST then return most end
      return nil, ("%d steps cost more than the best"):format(FEWEST), FEWEST
    end
  end
  return N
end

-- can what is narrow inside of N steps be looked at?
local function can_look(search, model, rule, N)
  if not (search.looks and pilot.is_even(rule) and narrow.present(model)) then return true end
  local known = search.looks[N]
  if known == nil then
    known = narrow.can_look(model.problem, search.steps, search.check_times, N)
    search.looks[N] = known
  end
  return known
end

-- do N steps that are not of one length cost more than the best does?
local function costs_more(search, model, rule, N)
  if search.bound == huge or pilot.is_even(rule) then return false end
  local fine, cost = blame.try(search.profile.cost, search.profile, model, rule, N)
  return fine and cost > search.bound
end

---- numbers of steps ----

local FIRST_EVEN, FIRST_UNEVEN = 64, 24  -- numbers that are tried first: of stages, of steps
local STUCK = 3   -- times that more steps did not help, in a row, though as many as the reference's
-- times that a run with twice the steps still failed, in a row: coarse steps of long runs fail for
-- a while
local FAILING = 12

-- The place whose number is enough, and its error, by more and more steps; nil where nothing comes
-- of it, the error, why, and the last number.
local function grow(search, model, row, from)
  local at, err, why, last, stuck, failing = from, huge, nil, huge, 0, 0
  local until_ = min(search.deadline, core.cpu() + search.seconds / 5)
  while core.cpu() < until_ and GRID[at + 1] do
    local N = GRID[at]
    while not can_look(search, model, row.rule, N) do at, N = at + 1, GRID[at + 1] end
    err, why = first_look(search, model, row.rule, N)
    if err <= 1 then err, why = at_rows(search, model, row.rule, N) end
    if err <= M.TARGET then return at, err end
    if why and pilot.is_refusal(why) then return nil, err, why, N end
    failing = err == huge and failing + 1 or 0
    local idle = err < huge and not (err < 0.5 * last)
    stuck = idle and N >= search.resolved and stuck + 1 or 0
    -- a run that failed tells no cost: it would only be made again
    local more_dear = err < huge and costs_more(search, model, row.rule, N)
    if stuck > STUCK or failing > FAILING or more_dear then break end
    last = err
    local more = err < huge and (err / M.TARGET) ^ (1 / row.order) * 1.05 or 2
    -- few steps that the motion outruns err by its size, however many they are
    at = max(at + 1, place_of(N * min(12, max(idle and stuck == 0 and 2 or 1.1, more))))
  end
  return nil, err, why or stuck > STUCK and "more steps do not help"
    or "does not reach the tolerance in the time allowed", GRID[at]
end

local INSIDE = "something narrow lies inside of the steps that cost no more"
local DEAD = 3  -- places in a row at which no step can be made, or at which uneven ones err

-- Places of the grid that the first look lets pass, down from one, the cheapest first; and what
-- errs least of the others.
local function passing(search, model, rule, from)
  local found, nearest, dead, even = {}, { error = huge }, 0, pilot.is_even(rule)
  for at = from, 1, -1 do
    local N = GRID[at]
    if dead == DEAD then break end
    if core.cpu() > search.deadline then
      search.cut = true
      break
    end
    local err, why = huge, INSIDE
    if can_look(search, model, rule, N) then
      err, why = first_look(search, model, rule, N)
      dead = (err == huge or not even and err > 1) and dead + 1 or 0
    end
    if err <= M.TARGET then
      local _, _, cost = pays(search, model, rule, N)
      found[#found + 1] = { at = at, N = N, cost = cost or huge }
    elseif err < nearest.error or not nearest.N then
      nearest = { N = N, error = err, why = why }
    end
  end
  table.sort(found, function(a, b) return a.cost < b.cost or (a.cost == b.cost and a.N < b.N) end)
  return found, nearest
end

-- fewer steps down to `fails`, which are too few, as long as they cost less; all that were enough
-- on the way, and the error of the last
local function refine(search, model, rule, fails, N, err, cost)
  local enough = { N }
  while N > fails + 1 and N > CLOSE * fails and core.cpu() < search.deadline do
    local between = max(fails + 1, floor(math.sqrt(fails * N)))
    local now = can_look(search, model, rule, between) and at_rows(search, model, rule, between)
      or huge
    local _, _, ns = pays(search, model, rule, between)
    if now <= M.TARGET and ns and ns < cost then
      N, err, cost = between, now, ns
      enough[#enough + 1] = N
    else
      fails = between
    end
  end
  return enough, err
end

-- the place from which numbers of steps are tried downwards, and what it errs by if that is known;
-- nil, error, why and steps: none
local function start_of(search, model, row)
  local rule, even = row.rule, pilot.is_even(row.rule)
  if search.bound == huge or not even then
    local first = even and max(8, ceil(FIRST_EVEN / row.stages)) or FIRST_UNEVEN
    return grow(search, model, row, place_of(first))
  end
  local N, why, last = affordable(search, model, rule, ceil(search.guess / row.stages))
  if not N then return nil, huge, why, last end
  local at = place_of(N)
  return GRID[at] > N and at > 1 and at - 1 or at
end

--- Numbers of steps of a rule that keep the tolerance at no more than the bound, the cheapest one
-- last, and its error; else nil, the error of the nearest, why, and its steps.
function M.least(search, model, row)
  local rule = row.rule
  local from, err, why, last = start_of(search, model, row)
  if not from then return nil, err, why, last end
  local found, nearest = passing(search, model, rule, from)
  for _, place in ipairs(found) do
    if place.cost > search.most * search.bound or core.cpu() > search.deadline then break end
    local here, failed = at_rows(search, model, rule, place.N)
    if here <= M.TARGET then
      local fails = GRID[place.at - 1] or FEWEST - 1
      return refine(search, model, rule, fails, place.N, here, place.cost)
    end
    if here < nearest.error then nearest = { N = place.N, error = here, why = failed } end
  end
  if err then return { GRID[from] }, err end -- there was no time for more
  return nil, nearest.error, nearest.why or "not accurate enough at the cost of the best",
    nearest.N or GRID[from]
end

return M
