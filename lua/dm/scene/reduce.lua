--- Smaller models of a scene: coordinates that nothing watched feels, cyclic ones reduced away, and
-- changes that are inside the tolerance, each measured against the reference and put together.
local blame = require "dm.base.blame"
local changes = require "dm.scene.changes"
local core = require "dm.core"
local pilot = require "dm.scene.pilot"

local M = {}

---- exact: coordinates that do not reach what is watched ----

-- mark in `reached` all coordinates that terms join to those that are marked
local function spread(model, reached)
  local problem, grew = model.problem, true
  local function join(depends, more)
    local any, all = false, true
    for i = 1, problem.n do
      if model.keep[i] and (depends(i) or i == more) then
        any, all = any or reached[i], all and reached[i]
      end
    end
    if not any or all then return end
    grew = true
    for i = 1, problem.n do
      if model.keep[i] and (depends(i) or i == more) then reached[i] = true end
    end
  end
  while grew do
    grew = false
    for k, unit in ipairs(problem.units) do
      if model:acts(k) then
        join(function(i) return unit.depends[1][i] or unit.depends[2][i] end, unit.row)
      end
    end
    if problem.constraint then join(function(i) return problem.constraint_depends[i] end) end
    for _, depends in ipairs(model.constraints_depend or {}) do
      join(function(i) return depends[i] end)
    end
  end
end

local function names_of(problem, list)
  local out = {}
  for at, i in ipairs(list) do out[at] = problem.names[i] end
  return table.concat(out, ", ")
end

--- The model without coordinates that are not joined to anything watched; nil when there are none.
function M.connected(model)
  local problem, reached, left = model.problem, {}, {}
  for i = 1, problem.n do
    reached[i] = model.keep[i] and (problem.needs.q[i] or problem.needs.v[i]) or false
  end
  spread(model, reached)
  for i = 1, problem.n do
    if model.keep[i] and not reached[i] then left[#left + 1] = i end
  end
  if #left == 0 or #left == #model:kept() then return nil end
  return model:changed(("without %s, which nothing watched feels"):format(names_of(problem, left)),
    function(m)
    for _, i in ipairs(left) do m.keep[i] = false end
  end)
end

---- exact: cyclic coordinates ----

--- The model reduced by the cyclic coordinates that are not watched (Routh); nil when there are
-- none, or it cannot be.
function M.reduced(model)
  local problem, kept, list = model.problem, model:ready():kept(), {}
  local cyclic = problem.group or {}
  for _, name in ipairs(model.system:structure().cyclic) do cyclic[name] = true end
  for _, i in ipairs(kept) do
    if cyclic[problem.names[i]] and not problem.needs.q[i] then list[#list + 1] = i end
  end
  if #list == 0 or #list == #kept then return nil end
  local out = model:reduced(list, ("reduced by %s, cyclic and not watched")
    :format(names_of(problem, list)))
  local fine = blame.try(out.ready, out)
  return fine and out or nil
end

---- measuring ----

-- every coordinate that is left has a term with its rate: else there is no motion to compute
local function moves(model)
  for i = 1, model.problem.n do
    local any = not model.keep[i]
    for k, unit in ipairs(model.problem.units) do
      any = any or (unit.kind == "L" and unit.depends[2][i] and model:acts(k))
    end
    if not any then return false end
  end
  return #model:kept() > 0
end

local PAYS = 0.93  -- of the operations of L: less gain is not looked at

-- is the model smaller than `than`: fewer coordinates, fewer operations, or a simpler structure
local function pays(model, than)
  local n, operations, s = model:size()
  local n0, operations0, s0 = than:size()
  return n < n0 or operations <= PAYS * operations0 or (s.separable and not s0.separable)
    or (s.constant_mass and not s0.constant_mass)
    or (s0.forced and not s.forced)
end

-- error of steps, at which what the steps themselves err by is nothing beside the tolerance; of a
-- first look over a part of the time
local FINE, COARSE = 1e-11, 1e-7
local LOST = 3  -- tolerances: so much early on is not run to the end

-- error of a run of the model with steps of that tolerance, over the first rows of the reference
local function error_of(search, model, tolerance, times, reference)
  local path, why = pilot.free_run(model, tolerance, { at = times, watch = model.watch })
  if not path then return math.huge, why end
  return pilot.apart(model.problem, pilot.record(model.problem, path), reference)
end

--- The error that a model makes however small the step is, in tolerances, and words where that says
-- less.
function M.measure(search, model)
  model:ready()
  local times = search.early.times
  local early = error_of(search, model, COARSE, times, search.early.reference)
  if early > LOST and early < math.huge then
    return early, ("already at t = %.3g"):format(times[#times])
  end
  local err, why = error_of(search, model, FINE, search.times, search.reference)
  return err, why and why:gsub(";.*$", "")
end

---- the ladder ----

local ENOUGH = 0.6  -- of the tolerance for the model; the rest is for the step

local function note(search, model, err, verdict, kept)
  search.models[#search.models + 1] = { model = model, error = err, verdict = verdict, kept = kept }
end

-- the same system with the same coordinates held has been looked at
local function tried(search, model)
  local key = { model:fingerprint() }
  for i = 1, model.problem.n do
    key[#key + 1] = not model.keep[i] and (model.problem.needs.q[i] and ("%.17g")
      :format(model.value[i]) or "-") or "+"
  end
  key = table.concat(key, " ")
  local known = search.seen[key]
  search.seen[key] = true
  return known
end

-- a change of the model, with what falls off by it; nil where it does not apply or does not pay
local function changed(model, change)
  local fine, out = blame.try(function()
    local next_one = change(model)
    if not next_one then return nil end
    next_one = M.connected(next_one) or next_one
    return moves(next_one) and pays(next_one, model) and next_one or nil
  end)
  return fine and out or nil
end

-- single changes that are inside the tolerance, those first that gain most
local function singles(search, base, list)
  local good = {}
  for at, change in ipairs(list) do
    if core.cpu() > search.half_time then
      search.models_cut = true
      break
    end
    local model = changed(base, change)
    if model and not tried(search, model) then
      local err, why = M.measure(search, model)
      local kept = err <= ENOUGH
      note(search, model, err, kept and "inside the tolerance" or why or "beyond the tolerance",
        kept)
      if kept then
        local n, operations = model:size()
        good[#good + 1] = { change = change, n = n, operations = operations, error = err, at = at,
          model = model }
      end
    end
  end
  table.sort(good, function(a, b)
    if a.n ~= b.n then return a.n < b.n end
    if a.operations ~= b.operations then return a.operations < b.operations end
    return a.at < b.at
  end)
  return good
end

-- put good changes together, one after the other, as long as all of them stay inside the tolerance
local function together(search, base, good)
  local rungs, now = {}, base
  for _, row in ipairs(good) do
    local model = now == base and row.model or changed(now, row.change)
    local err = model and (now == base and row.error or M.measure(search, model))
    if err and now ~= base then
      note(search, model, err, err <= ENOUGH and "inside the tolerance"
        or "together beyond the tolerance", err <= ENOUGH)
    end
    if err and err <= ENOUGH then
      now = model
      rungs[#rungs + 1] = model
    end
  end
  return rungs
end

-- each rung also without its cyclic coordinates, and the system in coordinates of a symmetry
-- without those of the group
local function with_reduced(search, rungs, splits)
  local all = { table.unpack(rungs) }
  for _, split in ipairs(splits) do all[#all + 1] = split end
  for _, rung in ipairs(all) do
    local model = M.reduced(rung)
    if model and not tried(search, model) then
      local err, why = M.measure(search, model)
      local kept = err <= ENOUGH
      note(search, model, err, kept and "inside the tolerance" or why or "beyond the tolerance",
        kept)
      if kept then rungs[#rungs + 1] = model end
    end
  end
end

-- models that are linear, or in other coordinates, each if it delivers what is watched
local function with_others(search, rungs, others)
  for _, model in ipairs(others) do
    local err, why = M.measure(search, model)
    local kept = err <= ENOUGH
    note(search, model, err, kept and "inside the tolerance" or why or "beyond the tolerance",
      kept)
    if kept then rungs[#rungs + 1] = model end
  end
end

-- the relative motion, and that of it which what is watched feels; the smallest of those kept, or
-- the base
local function with_relative(search, rungs, base, relative)
  local count = #rungs
  local n, operations = base:size()
  relative.problem.as_given = relative
  with_others(search, rungs, { relative, M.connected(relative) })
  local last = rungs[#rungs]
  local m, fewer = last:size()
  return #rungs > count and m < n and fewer <= operations and last or base
end

--- The models of a scene that deliver what is watched, from the system as given to the smallest;
-- splits: the same in coordinates of symmetries, others: further models; relative: that of the
-- relative motion.
function M.ladder(search, given, splits, others, relative)
  local problem, rungs, base = given.problem, { given }, given
  note(search, given, 0, "the system as given", true)
  search.seen = {}
  with_reduced(search, rungs, splits)
  if not problem.units then
    search.whole = problem.whole or "its terms are not taken apart"
  else
    problem.as_given = given
    base = M.connected(given) or given
    if base ~= given then
      note(search, base, 0, "exact", true)
      rungs[#rungs + 1] = base
    end
    with_others(search, rungs, others)
    if relative then base = with_relative(search, rungs, base, relative) end
    problem = base.problem
    for _, model in ipairs(together(search, base, singles(search, base, changes.all(problem)))) do
      rungs[#rungs + 1] = model
    end
    with_reduced(search, rungs, {})
  end
  return rungs
end

return M
