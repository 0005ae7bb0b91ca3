--- Models of a scene: the system as given, or fewer terms of L and of the force on fewer
-- coordinates, with further constraints.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"
local place = require "dm.group.place"
local routh = require "dm.reduce.routh"
local routh_model = require "dm.reduce.routh.model"
local watch = require "dm.scene.watch"

local M = {}
M.__index = M

local MOST_COORDINATES, MOST_TERMS = 48, 200  -- beyond, a system is taken as a whole

local entries = lists.entries

M.entries = entries

---- the problem: what all models of a scene share ----

-- x3 of a listing: the coordinate, its rate or the time
local function input_name(problem, digits)
  local i, n = math.tointeger(tonumber(digits)), problem.n
  if i <= n then return problem.names[i] end
  return i <= 2 * n and "d" .. problem.names[i - n] or "t"
end

local LONGEST_TEXT = 60

--- A traced function of (q, v, t) on one line: its listing with what it names put in place.
function M.text_of(problem, f)
  local parts, text = {}, ""
  for name, expression in f:graph():gmatch "(%w+) = ([^\n]*)" do
    text = expression:gsub("t%d+", function(part)
      return parts[part] and "(" .. parts[part] .. ")"
    end)
    parts[name] = text
    if #text > 4 * LONGEST_TEXT then break end
  end
  text = text:gsub("x(%d+)", function(digits) return input_name(problem, digits) end)
  return #text > LONGEST_TEXT and text:sub(1, LONGEST_TEXT - 3) .. "..." or text
end

local function add_units(problem, f, kind, row)
  for _, term in ipairs(f:terms()) do
    problem.units[#problem.units + 1] = { kind = kind, row = row, f = term,
      depends = term:depends(), text = M.text_of(problem, term) }
  end
end

-- the terms of L and of each component of the force; nil where the system is taken as a whole
local function take_apart(problem)
  local given, n = problem.given, problem.n
  if n > MOST_COORDINATES or given.rolling or given.control or given.reaction
    or given.derivatives then
    return
  end
  problem.units = {}
  add_units(problem, core.trace(problem.L, n, n, "number"), "L")
  if given.force then
    local force = bound(given.force, given.params)
    for i = 1, n do
      add_units(problem, core.trace(function(q, v, t) return entries(force(q, v, t))[i] end, n, n,
        "number"), "force", i)
    end
  end
  if given.constraint then
    problem.constraint = function(q, t) return given.constraint(q, t, given.params) end
    problem.constraint_depends =
      core.trace(function(q, t) return core.vector(entries(problem.constraint(q, t))) end, n,
      "number"):depends()[1]
  end
  if #problem.units > MOST_TERMS then problem.units = nil end
end

-- what p_i = dL/dv_i depends on, found when it is asked for
local function momentum_depends(problem)
  local n, slope = problem.n, nil
  return function(i)
    slope = slope or core.derivative(problem.L, n, n, "number")
    return core.trace(function(q, v, t) return slope(q, v, t)[n + i] end, n, n, "number"):depends()
  end
end

--- The problem of a scene: system, start, terms, what is watched.
function M.problem(system, options)
  local given = system.given
  local problem = { system = system, given = given, n = system.Q.dimension,
    names = watch.names(system), t0 = options.t0 or 0,
    T = options.until_t - (options.t0 or 0), project = options.project }
  problem.L = bound(given.L, given.params)
  problem.momentum_depends = momentum_depends(problem)
  problem.q = core.vector(options.q)
  problem.v = core.vector(options.v or system:velocity(options.q, options.p, problem.t0))
  problem.p = system:legendre(problem.q, problem.v, problem.t0)
  watch.read(problem, options)
  local fine, why = blame.try(take_apart, problem)
  if not fine then problem.units, problem.whole = nil, why end
  return problem
end

---- a model ----

--- The system as it is given.
function M.given(problem)
  local model = setmetatable({ problem = problem, active = {}, keep = {}, value = {},
    constraints = {},
    steps = {},
    untouched = true }, M)
  for k = 1, #(problem.units or {}) do model.active[k] = true end
  for i = 1, problem.n do model.keep[i], model.value[i] = true, problem.q[i] end
  return model
end

local function copied(list)
  local out = {}
  for key, value in pairs(list) do out[key] = value end
  return out
end

--- A model that differs by what `change(model)` does to it, described in words.
function M:changed(words, change)
  local out = setmetatable({ problem = self.problem, active = copied(self.active),
    keep = copied(self.keep), value = copied(self.value),
    constraints = copied(self.constraints), steps = copied(self.steps) }, M)
  out.steps[#out.steps + 1] = words
  change(out)
  return out
end

function M:words() return #self.steps == 0 and "as given" or table.concat(self.steps, "; ") end

--- Does unit k act on this model: is it there, and does a coordinate that is left feel it?
function M:acts(k)
  local unit = self.problem.units[k]
  if not self.active[k] then return false end
  if unit.kind == "force" then return self.keep[unit.row] end
  for i = 1, self.problem.n do
    if self.keep[i] and (unit.depends[1][i] or unit.depends[2][i]) then return true end
  end
  return false
end

--- Numbers of the coordinates that are left.
function M:kept()
  local out = {}
  for i = 1, self.problem.n do
    if self.keep[i] then out[#out + 1] = i end
  end
  return out
end

--- The model without cyclic coordinates, at the momentum of the start: Routh's reduction.
function M:reduced(list, words)
  return self:changed(words, function(m)
    m.base = self
    for _, i in ipairs(list) do m.keep[i] = false end
  end)
end

-- q(x), v(x, y, t): all coordinates from those that are left; rates of the others are zero, of
-- reduced ones those of the momentum
local function embedding(self)
  local place, value, n = {}, self.value, self.problem.n
  for at, i in ipairs(self:kept()) do place[i] = at end
  local function of(x, others)
    local out = {}
    for i = 1, n do out[i] = place[i] and x[place[i]] or others and others[i] or 0 end
    return core.vector(out)
  end
  local info = self.base and routh.info(self.system)
  local function rates(x, y, t)
    if not info then return nil end
    local rate, out, kept = routh_model.group_velocity(info, x, y, t), {}, self.base:kept()
    for a, at in ipairs(info.cyclic) do out[kept[at]] = rate[a] end
    return out
  end
  return function(x) return of(x, value) end, function(x, y, t) return of(y, rates(x, y, t)) end
end

-- the sum of the terms that act, as a Lagrangian of the coordinates that are left
local function lagrangian(self, q_of, v_of)
  local terms = {}
  for k, unit in ipairs(self.problem.units) do
    if unit.kind == "L" and self:acts(k) then terms[#terms + 1] = unit.f end
  end
  return function(x, y, t)
    local q, v, sum = q_of(x), v_of(x, y, t), 0
    for _, f in ipairs(terms) do sum = sum + f(q, v, t) end
    return sum
  end
end

local function force(self, q_of, v_of)
  local rows, any = {}, false
  for at, i in ipairs(self:kept()) do
    rows[at] = {}
    for k, unit in ipairs(self.problem.units) do
      if unit.kind == "force" and unit.row == i and self.active[k] then
        rows[at][#rows[at] + 1], any = unit.f, true
      end
    end
  end
  return any and function(x, y, t)
    local q, v, out = q_of(x), v_of(x, y, t), {}
    for at, row in ipairs(rows) do
      out[at] = 0
      for _, f in ipairs(row) do out[at] = out[at] + f(q, v, t) end
    end
    return core.vector(out)
  end or nil
end

local function constraint(self, q_of)
  local problem = self.problem
  if not problem.constraint and #self.constraints == 0 then return nil end
  return function(x, t)
    local q, out = q_of(x), {}
    for _, g in ipairs(problem.constraint and entries(problem.constraint(q, t)) or {}) do
      out[#out + 1] = g
    end
    for _, g in ipairs(self.constraints) do out[#out + 1] = g(q, t) end
    return core.vector(out)
  end
end

-- entries of a list of all coordinates that are left
local function left(self, list)
  local out = {}
  for at, i in ipairs(self:kept()) do out[at] = list[i] end
  return out
end

local function start_of(self, project)
  local problem = self.problem
  return { q = core.vector(left(self, problem.q)), v = core.vector(left(self, problem.v)),
    t0 = problem.t0, project = project }
end

-- the system reduced by the coordinates that its base has more
local function build_reduced(self)
  local base, cyclic = self.base:ready(), {}
  for at, i in ipairs(base:kept()) do
    if not self.keep[i] then cyclic[#cyclic + 1] = at end
  end
  return base.system:routh { cyclic = cyclic, q = base.start.q, v = base.start.v },
    start_of(self, base.start.project)
end

-- the system of the model and where it starts
local function build(self)
  local problem = self.problem
  if self.untouched then
    return problem.system, problem.start or start_of(self, problem.project)
  end
  if self.base then return build_reduced(self) end
  local q_of, v_of = embedding(self)
  local constrained = constraint(self, q_of)
  local whole = #self:kept() == problem.n
  local system = core.system { Q = whole and problem.given.Q or core.R(#self:kept()),
    L = lagrangian(self, q_of, v_of),
    force = force(self, q_of, v_of), constraint = constrained,
    coordinates = left(self, problem.names),
    units = problem.given.units,
    name = problem.given.name }
  return system, start_of(self, constrained and true or nil)
end

-- what is watched, as functions of the state of the model; momenta are those of the system as given
local function observables(self)
  local problem, out = self.problem, {}
  if self.untouched then
    for name, f in pairs(problem.watched) do out[name] = f end
    return out
  end
  local q_of, v_of = embedding(self)
  local slope = core.derivative(problem.L, problem.n, problem.n, "number")
  for name, f in pairs(problem.watched) do
    local needs_p = core.trace(f, problem.n, problem.n, "number", problem.n):depends()[4]
    local any = false
    for i = 1, problem.n do any = any or needs_p[i] end
    out[name] = function(x, y, t)
      local q, v = q_of(x), v_of(x, y, t)
      local p = any and slope(q, v, t)
      local momentum = {}
      for i = 1, problem.n do momentum[i] = p and p[problem.n + i] or 0 end
      return f(q, v, t, core.vector(momentum))
    end
  end
  return out
end

--- system, start, watch of the model, made when first asked for.
function M:ready()
  if not self.system then
    self.system, self.start = build(self)
    self.watch = observables(self)
  end
  return self
end

--- Dimension and operations of L: what a model costs at first sight.
function M:size()
  local structure = self:ready().system:structure()
  return self.system.Q.dimension, structure.operations, structure
end

-- 64 bits of a text, FNV-1a
local function hash(text)
  local h = 0xcbf29ce484222325
  for i = 1, #text do h = (h ~ text:byte(i)) * 0x100000001b3 end
  return ("%016x"):format(h)
end

-- graphs of the constraints and of the force of a system, in coordinates
local function graphs_beside(system)
  local given, own, n, out = system.given, system.place, system.Q.dimension, {}
  if own then n = own.size end
  local function of(f, wrapped)
    local g = own and wrapped(own, f) or f
    return function(...) return core.vector(entries(g(...))) end
  end
  if given.constraint then
    local f = of(bound(given.constraint, given.params), place.of_position)
    out[1] = core.trace(function(q, t) return f(q, t) end, n, "number"):graph()
  end
  if given.force and not given.control then
    local f = of(bound(given.force, given.params), place.of_velocity)
    out[#out + 1] = core.trace(function(q, v, t) return f(q, v, t) end, n, n, "number"):graph()
  end
  return out
end

--- The graphs of L, of the constraints and of the force as one text.
function M:graphs()
  if not self.graph_text then
    local fine, text = blame.try(self:ready().system.graph, self.system)
    self.graph_text = table.concat({ fine and text or tostring(self.system),
      table.unpack(graphs_beside(self.system)) }, "|")
  end
  return self.graph_text
end

--- A name of the model that is the same in another session: of its graphs and its dimension.
function M:fingerprint()
  self.print = self.print or hash(self:graphs() .. "|" .. tostring(self.system))
  return self.print
end

return M
