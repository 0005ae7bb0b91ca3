--- Smaller models of a scene: coordinates that nothing watched feels, stiff terms as constraints, coordinates at rest, terms that do
-- not matter. Each is measured against the reference; what is inside the tolerance is put together.
local core = require "dm.core"
local pilot = require "dm.scene.pilot"

local M = {}

local abs, max = math.abs, math.max

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
      if model:acts(k) then join(function(i) return unit.depends[1][i] or unit.depends[2][i] end, unit.row) end
    end
    if problem.ties then join(function(i) return problem.tie_depends[i] end) end
    for _, tie in ipairs(model.tie_depends or {}) do join(function(i) return tie[i] end) end
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
  for i = 1, problem.n do reached[i] = model.keep[i] and (problem.needs.q[i] or problem.needs.v[i]) or false end
  spread(model, reached)
  for i = 1, problem.n do
    if model.keep[i] and not reached[i] then left[#left + 1] = i end
  end
  if #left == 0 or #left == #model:kept() then return nil end
  return model:changed(("without %s, which nothing watched feels"):format(names_of(problem, left)), function(m)
    for _, i in ipairs(left) do m.keep[i] = false end
  end)
end

---- stiff terms ----

-- coordinates, of those that are left, on which a function depends
local function coordinates(model, depends)
  local out = {}
  for i = 1, model.problem.n do
    if model.keep[i] and depends[1][i] then out[#out + 1] = i end
  end
  return out
end

local function of_position_only(model, unit)
  for i = 1, model.problem.n do
    if unit.depends[2][i] then return false end
  end
  return unit.kind == "L" and not unit.depends[3][1]
end

-- the zero of g(s) near s by Newton's method on numbers, nil where it does not settle
local function zero_near(g, slope, s)
  for _ = 1, 60 do
    local value, k = g(s), slope(s)
    local step = value / k
    if step ~= step or abs(step) == math.huge then return nil end
    s = s - step
    if abs(step) <= 4e-16 * max(abs(s), 1e-300) or step == 0 then return s end
  end
  return abs(g(s)) < 1e-12 and s or nil
end

-- q of the model with coordinate i at s
local function with(model, i, s)
  local q = {}
  for k = 1, model.problem.n do q[k] = model.value[k] end
  q[i] = s
  return core.vector(q)
end

local function held(model, i, s, why)
  return model:changed(("%s held at %.6g, %s"):format(model.problem.names[i], s, why), function(m)
    m.keep[i], m.value[i] = false, s
  end)
end

-- g(q) = 0 in place of unit k: the coordinate held at the root where there is one only, else a constraint
local function constrained(model, k, g, why)
  local problem, depends = model.problem, g:depends()
  local free = coordinates(model, depends)
  if #free == 1 then
    local i = free[1]
    local function value(s) return g(with(model, i, s), problem.v, problem.t0) end
    local function slope(s) return g:jacobian(with(model, i, s), problem.v, problem.t0)[1][i] end
    local s = zero_near(value, slope, problem.q[i])
    return s and held(model, i, s, why)
  end
  return #free > 1 and model:changed(("%s as a constraint, %s"):format(M.text(problem, g), why), function(m)
    m.ties[#m.ties + 1] = function(q, t) return g(q, problem.v, t) end
    m.tie_depends = { table.unpack(m.tie_depends or {}) }
    m.tie_depends[#m.tie_depends + 1] = depends[1]
    m.active[k] = false
  end) or nil
end

--- A function of (q, v, t) on one line.
function M.text(problem, f) return require "dm.scene.model".text_of(problem, f) end

-- -c g^2 ...: the base g of an even power
local function square_of(unit)
  local c, factors = unit.f:factors()
  if not (c < 0) then return nil end
  for _, factor in ipairs(factors) do
    if factor.power > 0 and factor.power % 2 == 0 then return factor.base end
  end
end

-- the potential that depends on coordinate i alone, as a traced function: the sum of all such terms, at least one
local function well(model, i)
  local terms = {}
  for k, unit in ipairs(model.problem.units) do
    local free = of_position_only(model, unit) and model:acts(k) and coordinates(model, unit.depends) or {}
    if #free == 1 and free[1] == i then terms[#terms + 1] = unit.f end
  end
  if #terms == 0 then return nil end
  local n = model.problem.n
  return core.trace(function(q, v, t)
    local sum = 0
    for _, f in ipairs(terms) do sum = sum + f(q, v, t) end
    return sum
  end, n, n, "number")
end

local MOST_TIES = 8

-- units that a constraint could stand for, the stiffest first
local function stiff_units(model)
  local found = {}
  for k, unit in ipairs(model.problem.units) do
    local g = model:acts(k) and of_position_only(model, unit) and square_of(unit)
    if g then found[#found + 1] = { k = k, g = g, unit = unit, frequency = pilot.frequency(model.problem.as_given, unit.f) } end
  end
  table.sort(found, function(a, b) return a.frequency > b.frequency or (a.frequency == b.frequency and a.k < b.k) end)
  return found
end

-- changes that put constraints in the place of stiff terms: list of functions model -> model or nil
local function stiff_changes(problem, out)
  for at, row in ipairs(stiff_units(problem.as_given)) do
    if at > MOST_TIES then break end
    local why = ("where the term %s rests (frequency %.3g)"):format(row.unit.text, row.frequency)
    out[#out + 1] = function(model) return model:acts(row.k) and constrained(model, row.k, row.g, why) end
  end
  for i = 1, problem.n do
    out[#out + 1] = function(model)
      local U = model.keep[i] and well(model, i)
      local function slope(s) return U:gradient(with(model, i, s), problem.v, problem.t0)[i] end
      local function curve(s) return U:hessian(with(model, i, s), problem.v, problem.t0)[i][i] end
      local fine, s = pcall(function() return U and zero_near(slope, curve, problem.q[i]) end)
      return fine and s and curve(s) < 0 and held(model, i, s, "where its own potential is least") or nil
    end
  end
end

---- coordinates at rest, terms without effect ----

local function rest_changes(problem, out)
  for i = 1, problem.n do
    if problem.v[i] == 0 then
      out[#out + 1] = function(model) return model.keep[i] and held(model, i, problem.q[i], "where it starts") end
    end
  end
end

local function drop_changes(problem, out)
  for k, unit in ipairs(problem.units) do
    local what = unit.kind == "force" and ("the force %s on %s"):format(unit.text, problem.names[unit.row]) or "the term " .. unit.text
    out[#out + 1] = function(model)
      return model:acts(k) and model:changed("without " .. what, function(m) m.active[k] = false end)
    end
  end
  for i = 1, problem.n do
    out[#out + 1] = function(model)
      return model.keep[i] and not (problem.needs.q[i] or problem.needs.v[i])
        and model:changed("without every term of " .. problem.names[i], function(m)
          for k, unit in ipairs(problem.units) do
            m.active[k] = m.active[k] and not (unit.depends[1][i] or unit.depends[2][i] or unit.row == i)
          end
          m.keep[i] = false
        end)
    end
  end
end

---- small terms together ----

local STATES = 24   -- along the orbit, at which the size of a term is looked at
local GAP = 8       -- a term so much smaller than the next larger one ends a group
local MOST_GROUPS = 6

-- states (q, v, t) of the system as given along the whole time
local function states(model)
  local problem = model.problem
  local path = pilot.solver(model, "gauss(4)", 2 * math.ceil(pilot.first_N(model))):run(pilot.options_of(model, {
    at = pilot.times(problem, STATES, 0.3819660112501051) }))
  local v, out = path:velocity(), {}
  for i = 1, #path do out[i] = { path.q[i], v:row(i), path.t[i] } end
  return out
end

-- largest force or derivative of L that a unit makes anywhere along the orbit
local function size_of(unit, n, along)
  local worst = 0
  for _, s in ipairs(along) do
    if unit.kind == "force" then
      worst = max(worst, abs(unit.f(s[1], s[2], s[3])))
    else
      local g = unit.f:gradient(s[1], s[2], s[3])
      for i = 1, 2 * n do worst = max(worst, abs(g[i])) end
    end
  end
  return worst
end

-- units sorted by size, the smallest first, those that cannot be evaluated last
local function by_size(model)
  local problem, sizes, order = model.problem, {}, {}
  local along = states(model)
  for k, unit in ipairs(problem.units) do
    local fine, size = pcall(size_of, unit, problem.n, along)
    sizes[k], order[k] = fine and size or math.huge, k
  end
  table.sort(order, function(a, b) return sizes[a] < sizes[b] or (sizes[a] == sizes[b] and a < b) end)
  return order, sizes
end

local function without(list, words)
  return function(model)
    local any = false
    for _, k in ipairs(list) do any = any or model:acts(k) end
    return any and model:changed(words, function(m)
      for _, k in ipairs(list) do m.active[k] = false end
    end)
  end
end

-- groups of the smallest terms, up to each gap in size; and the whole force
local function group_changes(problem, out)
  local fine, order, sizes = pcall(by_size, problem.as_given)
  if not fine then
    pilot.pass_stop(order)
    return
  end
  local largest, groups, list = sizes[order[#order]], 0, {}
  for at, k in ipairs(order) do
    list[#list + 1] = k
    local above = order[at + 1] and sizes[order[at + 1]]
    if above and above > GAP * sizes[k] and #list > 1 and groups < MOST_GROUPS then
      groups = groups + 1
      out[#out + 1] = without({ table.unpack(list) }, ("without the %d smallest terms, at most %.1e of the largest")
        :format(#list, sizes[k] / largest))
    end
  end
  local force = {}
  for k, unit in ipairs(problem.units) do
    if unit.kind == "force" then force[#force + 1] = k end
  end
  if #force > 1 then out[#out + 1] = without(force, "without the force") end
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
  return n < n0 or operations <= PAYS * operations0 or (s.separable and not s0.separable) or (s.constant_mass and not s0.constant_mass)
    or (s0.forced and not s.forced)
end

local ROADS = { "gauss(6)", "gauss(4)", "degenerate(3)" }

-- error of a model after a part of the time, which often tells enough; nil when it is small
local function early(search, model, rule, N)
  local count = math.max(1, #search.times // 12)
  local times = { table.unpack(search.times, 1, count) }
  local coarse, fine = pilot.run(model, rule, N, times), pilot.run(model, rule, 2 * N, times)
  if not (coarse and fine) then return nil end
  local err = pilot.apart(model.problem, fine, pilot.first_rows(model.problem, search.reference, count))
  if err > 3 and pilot.apart(model.problem, coarse, fine) < 0.2 * err then return err, times[count] end
end

--- The error that a model makes however small the step is, in tolerances, and words where that says less.
function M.measure(search, model)
  local problem, why = model.problem, nil
  local N0 = pilot.first_N(model)
  local how = { from = N0, goal = 0.05, times = search.times, seconds = search.seconds / 8 }
  for _, rule in ipairs(ROADS) do
    local err, t = early(search, model, rule, N0)
    if err then return err, ("already at t = %.3g"):format(t) end
    local record, change = pilot.refine(model, rule, how)
    if record then return pilot.apart(problem, record, search.reference) end
    if not pilot.is_refusal(change) then why = change:gsub(";.*$", "") end
  end
  return math.huge, why
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
    key[#key + 1] = not model.keep[i] and (model.problem.needs.q[i] and ("%.17g"):format(model.value[i]) or "-") or "+"
  end
  key = table.concat(key, " ")
  local known = search.seen[key]
  search.seen[key] = true
  return known
end

-- a change of the model, with what falls off by it; nil where it does not apply or does not pay
local function changed(model, change)
  local fine, out = pcall(function()
    local next_one = change(model)
    if not next_one then return nil end
    next_one = M.connected(next_one) or next_one
    return moves(next_one) and pays(next_one, model) and next_one or nil
  end)
  if not fine then pilot.pass_stop(out) end
  return fine and out or nil
end

-- single changes that are inside the tolerance, those first that gain most
local function singles(search, base, changes)
  local good = {}
  for at, change in ipairs(changes) do
    if core.cpu() > search.half_time then
      search.cut = true
      break
    end
    local model = changed(base, change)
    if model and not tried(search, model) then
      local err, why = M.measure(search, model)
      local kept = err <= ENOUGH
      note(search, model, err, kept and "inside the tolerance" or why or "beyond the tolerance", kept)
      if kept then
        local n, operations = model:size()
        good[#good + 1] = { change = change, n = n, operations = operations, error = err, at = at, model = model }
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
      note(search, model, err, err <= ENOUGH and "inside the tolerance" or "together beyond the tolerance", err <= ENOUGH)
    end
    if err and err <= ENOUGH then
      now = model
      rungs[#rungs + 1] = model
    end
  end
  return rungs
end

--- The models of a scene that deliver what is watched, from the system as given to the smallest.
function M.ladder(search, given)
  local problem, rungs = given.problem, { given }
  note(search, given, 0, "the system as given", true)
  search.seen = {}
  if not problem.units then
    search.whole = problem.whole or "its terms are not taken apart"
    return rungs
  end
  problem.as_given = given
  local base = M.connected(given) or given
  if base ~= given then
    note(search, base, 0, "exact", true)
    rungs[#rungs + 1] = base
  end
  local changes = {}
  stiff_changes(problem, changes)
  rest_changes(problem, changes)
  group_changes(problem, changes)
  drop_changes(problem, changes)
  for _, model in ipairs(together(search, base, singles(search, base, changes))) do rungs[#rungs + 1] = model end
  return rungs
end

return M
