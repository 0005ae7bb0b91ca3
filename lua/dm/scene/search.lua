--- The cheapest rule and step for a model: each rule is tried first with as many steps as cost what
-- the best one does so far. Where that is not enough for the tolerance the rule is out, with one
-- pilot run; else fewer steps are looked for.
local blame = require "dm.base.blame"
local core = require "dm.core"
local narrow = require "dm.scene.narrow"
local pilot = require "dm.scene.pilot"
local rule_alone = require "dm.base.rule_alone"

local M = {}

local max, min, ceil, floor, huge = math.max, math.min, math.ceil, math.floor, math.huge

-- tried first, since a good bound early rules out the others quickly; this orders, it does not
-- choose
local EARLY = { "blanes-moan(6)", "gauss(4)", "verlet", "rattle", "gauss(6)", "kahan-li(8)",
  "blanes-moan(4)", "gauss(2)", "rk8" }
-- rules that the table has no instance of, and whose step is a time
local FURTHER = { "shake", "degenerate(1)", "degenerate(2)", "degenerate(3)", "degenerate(4)",
  "suzuki(4, rattle)", "kahan-li(6, rattle)", "kahan-li(8, rattle)" }
-- rules whose steps are not of one length, tried first: where the motion is uneven, too, others
-- need far more
local UNEVEN = { "controlled(rk8)", "log-hamiltonian(kahan-li(8))", "log-hamiltonian(verlet)",
  "controlled(gauss(4))" }

-- rule -> { rule, order, stages } as the table of rules has it
local function instances()
  local known, names = {}, {}
  for _, method in ipairs(core.rules()) do
    for _, instance in ipairs(method.instances) do
      known[instance.rule], names[#names + 1] = instance, instance.rule
    end
  end
  return known, names
end

local TWICE = 3  -- a controlled step is made whole and in two halves

--- Every instance of the table of rules, the early ones first, or the rules that are given, but not
-- those of the reference (except[rule]): list of { rule, order, stages }.
function M.rules(given, system, except)
  local known, names = instances()
  local out, seen = {}, {}
  local s = system:structure()
  -- where kicks and drifts step the system, what solves with any step only costs more
  if not given and s.separable and s.constraints + s.rolling == 0 then
    seen["controlled(gauss(4))"] = true
  end
  for _, list in ipairs(given and { given } or { UNEVEN, EARLY, names, FURTHER }) do
    for _, rule in ipairs(list) do
      local inner = pilot.controlled(rule) or rule
      if not seen[rule] and not (except and except[rule]) then
        seen[rule] = true
        local row = known[inner] or { order = rule_alone(system, inner).order, stages = 1 }
        out[#out + 1] = { rule = rule, order = row.order,
          stages = inner == rule and row.stages or TWICE * row.stages }
      end
    end
  end
  return out
end

local TARGET = 0.85  -- of the tolerance, at the sampled times; the rest is for what lies between
-- a rule that would cost so much more is still looked at: clocks are not that good
local SLACK = 1.25
local CLOSE = 1.07   -- numbers of steps between success and failure are then close enough
local FEWEST, FEWEST_UNEVEN = 2, 24


local MANY, PART = 1024, 12  -- from so many steps on a run is tried over a part of the time first

-- error of N steps at the first rows of the reference, in tolerances; inf where the run fails
local function error_at(search, model, rule, N, times, reference)
  search.pilots = search.pilots + 1
  local record, why = pilot.run(model, rule, N, times)
  if not record then return huge, why end
  return pilot.apart(model.problem, record, reference)
end

-- error of N steps; what is beyond the tolerance early on is not run to the end
local function error_of(search, model, rule, N)
  if N > MANY then
    local err, why = error_at(search, model, rule, N, search.early_times, search.early_reference)
    if err > 1 then return err, why end
  end
  return error_at(search, model, rule, N, search.times, search.reference)
end

--- Prepare a search: the rows of the reference that come first.
function M.prepare(search, problem)
  local count = max(1, #search.times // PART)
  search.early_times = { table.unpack(search.times, 1, count) }
  search.early_reference = pilot.first_rows(problem, search.reference, count)
  return search
end

-- does the bound pay for N steps? Or why such a run fails
local function pays(search, model, rule, N)
  local fine, ns = blame.try(search.profile.about, search.profile, model, rule, N)
  if fine then return ns <= SLACK * search.bound, nil, ns end
  return false, pilot.first_line(ns)
end

local LADDER = { 4, 2, 1, 0.5, 0.25, 0.1, 0.03 }  -- times a guess

-- The largest number of steps that the bound pays for, beginning with a guess; nil and why where
-- there is none. Downwards, since implicit rules may cost more in all with fewer steps.
local function affordable(search, model, rule, guess)
  local why, last
  for at, factor in ipairs(LADDER) do
    local N = max(FEWEST, floor(factor * guess))
    local fits, failed, ns = pays(search, model, rule, N)
    if failed and (pilot.is_refusal(failed) or (why and at > 3)) then return nil, failed, N end
    if fits then
      while at == 1 and fits and N < 1e9 do
        N = 4 * N
        fits, failed, ns = pays(search, model, rule, N)
      end
      if not fits then N = N // 4; fits, failed, ns = pays(search, model, rule, N) end
      local more = fits and floor(N * min(4, SLACK * search.bound / ns)) or N
      return pays(search, model, rule, more) and more or N
    end
    why, last = failed or why, N
    if N == FEWEST then break end
  end
  return nil, why or ("%d steps cost more than the best"):format(last), last
end

-- the least number of steps at which what is narrow is still looked at
local function fewest(search, model, rule)
  if search.fewest <= FEWEST or not pilot.is_even(rule) then return FEWEST end
  return narrow.present(model) and search.fewest or FEWEST
end

-- the least number of steps that is enough, between `fails` and `enough`, by the order of the rule
local function shrink(search, model, row, enough, err)
  local fails = fewest(search, model, row.rule) - 1
  for _ = 1, 9 do
    if enough / fails < CLOSE or enough <= fails + 1 or core.cpu() > search.deadline then break end
    local by_order = ceil(enough * (err / TARGET) ^ (1 / row.order) * 1.01)
    local N = min(max(by_order, fails + 1, floor(enough / 6)), floor(enough * 0.96), enough - 1)
    if fails >= FEWEST and by_order <= fails * 1.01 then N = floor(math.sqrt(fails * enough)) end
    if N <= fails then break end
    local now = error_of(search, model, row.rule, N)
    if now <= TARGET then enough, err = N, now else fails = N end
  end
  return enough, err
end

local STUCK = 3   -- times that more steps did not help, in a row, though as many as the reference's
-- times that a run with twice the steps still failed, in a row: coarse steps of long runs fail for
-- a while
local FAILING = 12

-- do N steps that are not of one length cost more than the best does?
local function costs_more(search, model, row, N)
  if search.bound == huge or pilot.is_even(row.rule) then return false end
  local fine, cost = blame.try(search.profile.cost, search.profile, model, row.rule, N)
  return fine and cost > search.bound
end

-- more steps until it is enough; nil where nothing comes of it
local function grow(search, model, row, N)
  local err, why, last, stuck, failing = huge, nil, huge, 0, 0
  local until_ = min(search.deadline, core.cpu() + search.seconds / 5)
  while core.cpu() < until_ do
    err, why = error_of(search, model, row.rule, N)
    if err <= TARGET then return N, err end
    if why and pilot.is_refusal(why) then return nil, err, why, N end
    failing = err == huge and failing + 1 or 0
    local idle = err < huge and not (err < 0.5 * last)
    stuck = idle and N >= search.resolved and stuck + 1 or 0
    if stuck > STUCK or failing > FAILING or costs_more(search, model, row, N) then break end
    last = err
    local more = err < huge and (err / TARGET) ^ (1 / row.order) * 1.05 or 2
    -- few steps that the motion outruns err by its size, however many they are
    N = ceil(N * min(12, max(idle and stuck == 0 and 2 or 1.1, more)))
  end
  return nil, err, why or stuck > STUCK and "more steps do not help"
    or "does not reach the tolerance in the time allowed", N
end

local function candidate(search, model, row, N, err, words, kept)
  local out = { model = model, rule = row.rule, order = row.order, N = N, h = model.problem.T / N,
    error = err, why = words, kept = kept }
  if err < huge and kept then
    local fine, cost = blame.try(search.profile.cost, search.profile, model, row.rule, N)
    -- the time for rules was over while it was counted: it is taken where there is nothing else
    out.cost = fine and cost or huge
    if not fine then out.why, search.cut = words .. "; no time was left to count it", true end
  end
  search.candidates[#search.candidates + 1] = out
  return out
end

-- why a rule cannot, without its name and without those that can
local function short(why)
  return (why:gsub(";.*$", ""):gsub("^rule '[^']*' ", ""):gsub("and rule '[^']*' needs",
    "and the rule needs"):gsub("^field 'rule': '[^']*': ", ""))
end

-- the rule is out: it cannot step the model, or not as cheaply
local function give_up(search, model, row, why, N, err)
  if pilot.is_refusal(why) then
    search.refused[#search.refused + 1] = { model = model, rule = row.rule, why = short(why) }
  else
    candidate(search, model, row, N, err or huge, short(why), false)
  end
end

-- a number of steps that is enough and its error; nil where there is none as cheap as the bound
local function first_enough(search, model, row)
  local even, least = pilot.is_even(row.rule), fewest(search, model, row.rule)
  if search.bound == huge or not even then
    local N, err, why, last = grow(search, model, row,
      even and max(8, least, ceil(64 / row.stages)) or FEWEST_UNEVEN)
    if not N then give_up(search, model, row, why, last, err) end
    return N, err
  end
  local N, why, at = affordable(search, model, row.rule,
    max(least, ceil(search.guess / row.stages)))
  if N and N < least then
    N, why, at = nil, "something narrow lies inside of the steps that cost no more", N
  end
  if not N then return give_up(search, model, row, why, at) end
  local err, failed = error_of(search, model, row.rule, N)
  if err <= TARGET then return N, err end
  candidate(search, model, row, N, err, failed and short(failed)
    or "not accurate enough at the cost of the best", false)
end

-- more steps that cost less: where those of an implicit rule then converge so much faster
local function cheaper(search, model, rule, N, err)
  local least, best = search.profile:cost(model, rule, N), N
  for _, factor in ipairs { 1.1, 1.25, 1.5, 2 } do
    local more = ceil(N * factor)
    local fine, ns = blame.try(search.profile.cost, search.profile, model, rule, more)
    if fine and ns < 0.9 * least then least, best = ns, more end
  end
  if best == N then return N, err end
  local now = error_of(search, model, rule, best)
  if now <= TARGET then return best, now end
  return N, err
end

local function try_rule(search, model, row)
  local N, err = first_enough(search, model, row)
  if not N then return end
  N, err = shrink(search, model, row, N, err)
  if not search.profile:is_counted() then N, err = cheaper(search, model, row.rule, N, err) end
  local found = candidate(search, model, row, N, err, "reaches the tolerance", true)
  if found.kept and found.cost < search.bound then
    search.bound, search.guess = found.cost, N * row.stages
  end
end

-- a model that is solved: there is nothing to be chosen
local function take_solved(search, model)
  local row = { rule = pilot.EXACT, order = 1, stages = 1 }
  local err, why = error_of(search, model, row.rule, FEWEST)
  if err > TARGET then
    return give_up(search, model, row, why or "beyond the tolerance", FEWEST, err)
  end
  local found = candidate(search, model, row, FEWEST, err, "reaches the tolerance", true)
  if found.kept and found.cost < search.bound then
    search.bound, search.guess = found.cost, FEWEST
  end
end

local function smallest_first(rungs)
  local out, size = {}, {}
  for i, rung in ipairs(rungs) do
    local n, operations = rung:size()
    out[i], size[rung] = rung, { n, operations, -i }
  end
  table.sort(out, function(a, b)
    local x, y = size[a], size[b]
    if x[1] ~= y[1] then return x[1] < y[1] end
    if x[2] ~= y[2] then return x[2] < y[2] end
    return x[3] < y[3]
  end)
  return out
end

--- Look at all rules for all models; adds candidates to the search. Each rule on every model, the
-- smallest first: what is small is not always what costs least, and a good bound spares the rest.
function M.models(search, rungs)
  search.refused = {}
  local stepped = {}
  for _, model in ipairs(smallest_first(rungs)) do
    if model.is_solved then take_solved(search, model) else stepped[#stepped + 1] = model end
  end
  for _, row in ipairs(search.rules) do
    for _, model in ipairs(stepped) do
      if core.cpu() > search.deadline then
        search.cut = true
        return
      end
      try_rule(search, model, row)
    end
  end
end

local AS_GOOD = 1.15    -- costs that differ by less are equal: the smaller model is then preferred
local NEAR, ROUNDS = 1.6, 5  -- what cost so many times the best is timed again, so often

-- candidates that are near to the best, timed once more; their least cost
local function near(search)
  local out, least = {}, huge
  for _, c in ipairs(search.candidates) do
    if c.kept and c.cost < huge and c.cost <= NEAR * search.bound then out[#out + 1] = c end
  end
  search.profile:again(out, ROUNDS, search.seconds / 20)
  for _, c in ipairs(out) do
    c.cost = search.profile:least(c.model, c.rule, c.N)
    least = min(least, c.cost)
  end
  return out, least
end

-- what was kept but costs more, for the case that nothing close to the best stands the check
local function add_dearer(search, out)
  local close, dearer = {}, {}
  for _, c in ipairs(out) do close[c] = true end
  for _, c in ipairs(search.candidates) do
    if c.kept and not close[c] then
      c.n, c.operations = c.model:size()
      dearer[#dearer + 1] = c
    end
  end
  table.sort(dearer, function(a, b)
    return a.cost < b.cost or (a.cost == b.cost and a.rule < b.rule)
  end)
  table.move(dearer, 1, #dearer, #out + 1, out)
  return out
end

--- What is close to the best: of equal cost the smaller model first, then by cost; then the rest.
function M.finalists(search)
  local out, least = near(search)
  for _, c in ipairs(out) do
    c.n, c.operations = c.model:size()
    c.class = c.cost <= AS_GOOD * least and 0 or 1
  end
  table.sort(out, function(a, b)
    if a.class ~= b.class then return a.class < b.class end
    if a.class == 0 and a.n ~= b.n then return a.n < b.n end
    if a.class == 0 and a.operations ~= b.operations then return a.operations < b.operations end
    return a.cost < b.cost or (a.cost == b.cost and a.rule < b.rule)
  end)
  return add_dearer(search, out)
end

return M
