--- Fields on a line in a stability map: what its passes ask of a system and of an ensemble, done by
-- runs of the field, one a member.
local blame = require "dm.base.blame"
local core = require "dm.core"
local fields = require "dm.line"
local grids = require "dm.line.grid"
local line_flows = require "dm.stability.line_flows"
local sample = require "dm.line.sample"

local M = {}

local abs, max, huge = math.abs, math.max, math.huge

---- ensembles ----

-- what the energy of row i has beside that of a field at rest there, whose cells do h times -L
local function kinetic(run, i)
  local u, rest = run.u[i], 0
  local cells = run.level.strip:cells(u, u, run.t[i], run.h, "value")
  for c = 1, #cells do rest = rest - cells[c][1] / run.h end
  return abs(run.energy[i] - rest)
end

-- the columns of a run that are watched: "energy", functions (q, v, t, p) without a v, and the
-- kinetic energy; values of u (dm.stability.line_flows) are looked at in the rows
local function columns_of(run, watch)
  local out = {}
  for name, f in pairs(watch) do
    local y = {}
    for i = 1, type(f) == "table" and 0 or #run do
      y[i] = f == kinetic and kinetic(run, i)
        or type(f) == "function" and f(run.u[i], nil, run.t[i], run.p[i]) or run.energy[i]
    end
    out[type(name) == "string" and name or f] = y
  end
  return out
end

-- one member: { status, steps, t, columns, off = how far its columns are from its flow (o.beside:
-- dm.stability.cells) }; raises what refuses the start
local function member(solver_of, o, i)
  local h, flow = o.h[i], o.beside and o.beside.flows[i]
  local steps = o.steps or math.ceil(o.t / h - 1e-9)
  local rows = max(o.rows or 1, flow and flow.rows or 1)
  local fine, run = pcall(function()
    return solver_of(h):run { u = o.q[i], ut = o.v and o.v[i], p = o.p and o.p[i], t0 = o.t0,
      steps = steps, every = max(1, steps // rows) }
  end)
  local failure = not fine and type(run) ~= "string" and run.path and run
  if not fine and not failure then error(run, 0) end
  if failure then run = failure.path end
  return { status = failure and failure.code or "ok", steps = run.steps, t = run.t,
    columns = columns_of(run, o.watch), failure = failure or nil,
    off = flow and line_flows.off(run, flow, o.beside.compared) or {} }
end

local Ensemble = {}
Ensemble.__index = Ensemble

function Ensemble:summary(name)
  local out = {}
  for i, one in ipairs(self.list) do
    for key, x in pairs(core.summary(one.t, one.columns[name])) do
      out[key] = out[key] or {}
      out[key][i] = x
    end
  end
  return out
end

function Ensemble:followed(i) return self.list[i].off end

function Ensemble:failures()
  local out = {}
  for i, one in ipairs(self.list) do
    if one.failure then
      out[#out + 1] = { member = i, code = one.status, message = one.failure.message }
    end
  end
  return out
end

local function ensemble(solver_of, o)
  local e = setmetatable({ list = {}, status = {}, steps = {}, systems = 1 }, Ensemble)
  for i = 1, o.members do
    local one = member(solver_of, o, i)
    if one.status == "stopped" then
      one.failure.path = e
      for k = i, o.members do e.list[k], e.status[k], e.steps[k] = one, "stopped", 0 end
      error(one.failure, 0)
    end
    e.list[i], e.status[i], e.steps[i] = one, one.status, one.steps
  end
  return e
end

---- systems ----

local System = { kinetic = kinetic }
System.__index = System

function System:structure()
  self.autonomous = self.autonomous == nil and sample.is_autonomous(self.line) or self.autonomous
  -- absorbing ends take the energy away
  local closed = not (self.line.absorbing.left or self.line.absorbing.right)
  return { separable = true, linear_in_v = true, constant_mass = true,
    autonomous = self.autonomous and closed }
end

function System:solver(options)
  local field = self.line
  local function of(h) return field:solver { rule = options.rule, h = h } end
  local kept = of(options.h)
  local function at(h)
    if kept.h ~= h then kept = of(h) end
    return kept
  end
  return {
    ensemble = function(_, o) return ensemble(at, o) end,
    run = function(_, o)
      local run = at(options.h):run { u = o.q, ut = o.v, p = o.p, steps = o.steps, t0 = o.t0 }
      return { q = run.u, p = run.p }
    end,
  }
end

--- Is x a field on a line?
function M.is_line(x)
  local meta = type(x) == "table" and getmetatable(x)
  return meta and meta.__name == "dm.line_field" or false
end

--- The field as such a system; anything else as it is.
function M.wrapped(x)
  if not M.is_line(x) then return x end
  local keys, n = { q = "u", v = "ut", p = "p" }, x.nodes * x.values
  local function start(given, key)
    return grids.values(x.grid, given, x.values, keys[key] or key, "dm.stability")
  end
  return setmetatable({ line = x, given = {}, params = x.params, Q = { dimension = n },
    field = { n = n, start = start } }, System)
end

--- The same field with these numbers among its params.
function M.with_params(system, values, names)
  local given, params = {}, {}
  for key, value in pairs(system.line.given) do given[key] = value end
  for key, value in pairs(system.params) do params[key] = value end
  for _, name in ipairs(names) do params[name] = values[name] end
  given.params = params
  return M.wrapped(fields.field(given))
end

---- theory ----

--- The limit of the start of a cell, nil where it has none; and a sentence.
function M.limit(map, cell, system)
  local rule = map.rule_list[cell.rule]
  local fine, limit = blame.try(system.line.stability_limit, system.line, rule,
    { u = map.start.q(cell), t = map.options.t0 or 0 })
  if not fine then return nil, (tostring(limit):gsub("^[^\n]-lua:%d+: ", "")) end
  if limit == huge then return huge, "no oscillation about the start grows at any height" end
  return limit, ("about the start the fastest oscillation of %d cells grows from lambda = h/dx = "
    .. "%.6g on"):format(system.line.cells, limit / system.line.dx)
end

return M
