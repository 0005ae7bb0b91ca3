--- Changes that may make a model smaller: stiff terms as constraints, coordinates at rest held,
-- terms left out. Each is a function from a model to another one, or nil where it does not apply;
-- whether it is allowed is measured elsewhere.
local blame = require "dm.base.blame"
local core = require "dm.core"
local model_of = require "dm.scene.model"
local pilot = require "dm.scene.pilot"

local M = {}

local abs, max = math.abs, math.max

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

-- g(q) = 0 in place of unit k: the coordinate held at the root where there is one only, else a
-- constraint
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
  return #free > 1 and model:changed(("%s as a constraint, %s")
    :format(model_of.text_of(problem, g), why), function(m)
    m.constraints[#m.constraints + 1] = function(q, t) return g(q, problem.v, t) end
    m.constraints_depend = { table.unpack(m.constraints_depend or {}) }
    m.constraints_depend[#m.constraints_depend + 1] = depends[1]
    m.active[k] = false
  end) or nil
end

-- -c g^2 ...: the base g of an even power
local function square_of(unit)
  local c, factors = unit.f:factors()
  if not (c < 0) then return nil end
  for _, factor in ipairs(factors) do
    if factor.power > 0 and factor.power % 2 == 0 then return factor.base end
  end
end

-- the potential that depends on coordinate i alone, as a traced function: the sum of all such
-- terms, at least one
local function well(model, i)
  local terms = {}
  for k, unit in ipairs(model.problem.units) do
    local free = of_position_only(model, unit) and model:acts(k)
      and coordinates(model, unit.depends) or {}
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
    if g then
      found[#found + 1] = { k = k, g = g, unit = unit,
        frequency = pilot.frequency(model, unit.f) }
    end
  end
  table.sort(found, function(a, b)
    return a.frequency > b.frequency or (a.frequency == b.frequency and a.k < b.k)
  end)
  return found
end

--- The stiffest of them { unit =, frequency = }, or nil.
function M.stiffest(model) return stiff_units(model)[1] end

-- changes that put constraints in the place of stiff terms: list of functions model -> model or nil
local function stiff_changes(problem, out)
  for at, row in ipairs(stiff_units(problem.as_given)) do
    if at > MOST_TIES then break end
    local why = ("where the term %s rests (frequency %.3g)"):format(row.unit.text, row.frequency)
    out[#out + 1] = function(model)
      return model:acts(row.k) and constrained(model, row.k, row.g, why)
    end
  end
  for i = 1, problem.n do
    out[#out + 1] = function(model)
      local U = model.keep[i] and well(model, i)
      local function slope(s) return U:gradient(with(model, i, s), problem.v, problem.t0)[i] end
      local function curve(s) return U:hessian(with(model, i, s), problem.v, problem.t0)[i][i] end
      local fine, s = blame.try(function() return U and zero_near(slope, curve, problem.q[i]) end)
      return fine and s and curve(s) < 0 and held(model, i, s, "where its own potential is least")
        or nil
    end
  end
end

---- coordinates at rest, terms without effect ----

local function rest_changes(problem, out)
  for i = 1, problem.n do
    if problem.v[i] == 0 then
      out[#out + 1] = function(model)
        return model.keep[i] and held(model, i, problem.q[i], "where it starts")
      end
    end
  end
end

local function drop_changes(problem, out)
  for k, unit in ipairs(problem.units) do
    local what = unit.kind == "force" and ("the force %s on %s")
      :format(unit.text, problem.names[unit.row]) or "the term " .. unit.text
    out[#out + 1] = function(model)
      return model:acts(k) and model:changed("without " .. what,
        function(m) m.active[k] = false end)
    end
  end
  for i = 1, problem.n do
    out[#out + 1] = function(model)
      return model.keep[i] and not (problem.needs.q[i] or problem.needs.v[i])
        and model:changed("without every term of " .. problem.names[i], function(m)
          for k, unit in ipairs(problem.units) do
            m.active[k] = m.active[k] and not (unit.depends[1][i] or unit.depends[2][i]
              or unit.row == i)
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
  local path = assert(pilot.free_run(model, 1e-6, {
    at = pilot.times(model.problem, STATES, 0.3819660112501051) }))
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
    local fine, size = blame.try(size_of, unit, problem.n, along)
    sizes[k], order[k] = fine and size or math.huge, k
  end
  table.sort(order, function(a, b)
    return sizes[a] < sizes[b] or (sizes[a] == sizes[b] and a < b)
  end)
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
  local fine, order, sizes = blame.try(by_size, problem.as_given)
  if not fine then return end
  local largest, groups, list = sizes[order[#order]], 0, {}
  for at, k in ipairs(order) do
    list[#list + 1] = k
    local above = order[at + 1] and sizes[order[at + 1]]
    if above and above > GAP * sizes[k] and #list > 1 and groups < MOST_GROUPS then
      groups = groups + 1
      out[#out + 1] = without({ table.unpack(list) },
        ("without the %d smallest terms, at most %.1e of the largest")
        :format(#list, sizes[k] / largest))
    end
  end
  local force = {}
  for k, unit in ipairs(problem.units) do
    if unit.kind == "force" then force[#force + 1] = k end
  end
  if #force > 1 then out[#out + 1] = without(force, "without the force") end
end

--- All changes of a problem, those that gain most first: a list of functions model -> model or nil.
function M.all(problem)
  local out = {}
  stiff_changes(problem, out)
  rest_changes(problem, out)
  group_changes(problem, out)
  drop_changes(problem, out)
  return out
end

return M
