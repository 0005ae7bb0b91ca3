--- The cheapest rule and step: each rule on each model is looked at with the numbers of steps that
-- cost no more than the best so far (scan.lua).
local blame = require "dm.base.blame"
local core = require "dm.core"
local pilot = require "dm.scene.pilot"
local rule_alone = require "dm.base.rule_alone"
local scan = require "dm.scene.scan"

local M = {}

local huge = math.huge

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

-- the rule is enough with any of these numbers of steps, the last of which is taken
local function keep(search, model, row, enough, err)
  local N = table.remove(enough)
  local found = candidate(search, model, row, N, err, "reaches the tolerance", true)
  found.enough = enough
  if found.kept and found.cost < search.bound then
    search.bound, search.guess = found.cost, N * row.stages
  end
end

local function try_rule(search, model, row)
  local enough, err, why, last = scan.least(search, model, row)
  if not enough then return give_up(search, model, row, why, last, err) end
  keep(search, model, row, enough, err)
end

-- a model that is solved: there is nothing to be chosen
local function take_solved(search, model)
  local row, N = { rule = pilot.EXACT, order = 1, stages = 1 }, 2
  local err, why = scan.at_rows(search, model, row.rule, N)
  if err > scan.TARGET then
    return give_up(search, model, row, why or "beyond the tolerance", N, err)
  end
  keep(search, model, row, { N }, err)
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

local NEAR, ROUNDS = 1.6, 5  -- what cost so many times the best is timed again, so often

-- candidates that are near to the best are timed once more, where a clock decides
local function time_again(search)
  local near = {}
  for _, c in ipairs(search.candidates) do
    if c.kept and c.cost < huge and c.cost <= NEAR * search.bound then near[#near + 1] = c end
  end
  search.profile:again(near, ROUNDS, search.seconds / 20)
  for _, c in ipairs(near) do c.cost = search.profile:least(c.model, c.rule, c.N) end
end

--- Is a the better choice? It costs less, or, at the same cost, its model is smaller.
function M.is_better(a, b)
  if a.cost ~= b.cost then return a.cost < b.cost end
  if a.n ~= b.n then return a.n < b.n end
  if a.operations ~= b.operations then return a.operations < b.operations end
  return a.rule < b.rule
end

--- All that keep the tolerance, the cheapest first.
function M.finalists(search)
  time_again(search)
  local out = {}
  for _, c in ipairs(search.candidates) do
    if c.kept then
      c.n, c.operations = c.model:size()
      out[#out + 1] = c
    end
  end
  table.sort(out, M.is_better)
  return out
end

return M
