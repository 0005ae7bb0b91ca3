--- Resolved flows of fields on lines for stability maps: the field's equation itself, as cells of
-- finer lines and heights tell it. Errors of cells go by even powers of both, so that runs of (m
-- cells, s slabs), (2m, 2s) and (3m, 3s) make one of order 6 (Richardson); two unlike rules of
-- cells must agree on it, as for other systems (dm.stability.flows).
local blame = require "dm.base.blame"
local core = require "dm.core"
local fields = require "dm.line"
local grids = require "dm.line.grid"

local M = {}

local abs, max, min, floor, ceil, huge = math.abs, math.max, math.min, math.floor, math.ceil,
  math.huge

--- Rules, with their slabs in parts of those of a level.
M.RULES = { { "cell(gauss(2))", 1 }, { "cell(corners)", 1.37 }, { "cell(gauss(3))", 1.13 } }

-- cells of the finest run of a level that is not too dear
local MOST = 2 ^ 22

local FINER = { 1, 2, 3 }
local WEIGHTS = { 1 / 24, -16 / 15, 81 / 40 }
local SAFE = 1.25     -- by how much the limit of stability is above the height of a slab
local POINTS = 8      -- rows of a polynomial in time

---- starts on finer lines ----

-- nil: on every line; else why not
local function unfit(map)
  if map.start.p then return "give 'ut' in the place of 'p', which belongs to one mesh" end
end

local function is_of_place(given)
  return given == nil or type(given) == "number" or type(given) == "function"
end

-- u, ut of a start on the grid of a field
local function start_of(map, flow, field)
  local out = {}
  for key, name in pairs { q = "u", v = "ut" } do
    local given = map.start.given[key] and map.start.given[key](flow)
    if not is_of_place(given) then
      error(("'%s' is a list for one mesh: a function of x has values on finer ones"):format(name),
        0)
    end
    out[key] = grids.values(field.grid, given, field.values, name, "dm.stability")
  end
  return out
end

-- the same field with `m` times as many cells
local function finer(field, m)
  local given = {}
  for key, value in pairs(field.given) do given[key] = value end
  given.x = { field.from, field.to, field.cells * m, periodic = field.periodic }
  return fields.field(given)
end

---- how fine ----

-- m cells of a level for every cell: as many as slabs of the height h, and a third of it, are
-- stable on
local function refinement(field, rule, h, u, t)
  local fine, limit = blame.try(field.stability_limit, field, rule, { u = u, t = t })
  if not fine or not (limit < huge) then limit = 0.4 * field.dx end
  local m = max(1, floor(limit / (SAFE * h)))
  while m > 1 do
    local last = finer(field, FINER[#FINER] * m)
    local known, its = blame.try(last.stability_limit, last, rule, { t = t })
    if not known or not (its < h / FINER[#FINER]) then break end
    m = m // 2
  end
  return m
end

---- flows ----

-- rows of every `every`-th level at every m-th node
local function coarse_rows(run, field, m)
  local n, out = field.values, {}
  for r = 1, #run do
    local row, from = core.zeros(field.nodes * n), run.u[r]
    for i = 0, field.nodes - 1 do
      for c = 1, n do row[i * n + c] = from[i * m * n + c] end
    end
    out[r] = row
  end
  return out
end

-- rows at all times of the coarsest run, and the code of the worst one
local function extrapolated(map, flow, field, rule, steps, T)
  local rows, t, finest = nil, nil, FINER[#FINER]
  local m = refinement(field, rule, T / steps, start_of(map, flow, field).q, map.options.t0 or 0)
  if field.cells * m * finest * steps * finest > MOST then return nil, "too_large" end
  for k, times in ipairs(FINER) do
    local line = finer(field, m * times)
    local start = start_of(map, flow, line)
    local fine, run = blame.try(function()
      return line:solver({ rule = rule, h = T / (steps * times) }):run { u = start.q, ut = start.v,
        steps = steps * times, every = times, t0 = map.options.t0 }
    end)
    if not fine and type(run) == "string" then error(run, 0) end
    if not fine then return nil, run.code, run end
    local some = coarse_rows(run, field, m * times)
    t, rows = run.t, rows or {}
    for r = 1, #some do
      rows[r] = rows[r] and rows[r] + WEIGHTS[k] * some[r] or WEIGHTS[k] * some[r]
    end
  end
  return { t = t, rows = rows }
end

---- columns of rows ----

-- entries k, k + n, ... of a row, or all
local function component(row, k, n)
  if n == 1 then return row end
  local out = core.zeros(#row // n)
  for i = 1, #out do out[i] = row[(i - 1) * n + k] end
  return out
end

local function largest(v) -- of |v|
  local most = 0
  for i = 1, #v do
    local x = abs(v[i])
    if x ~= x then return huge end
    most = max(most, x)
  end
  return most
end

-- what a column says at a row, as a vector
local function values_at(column, row, t, n)
  if type(column) == "function" then
    local x = column(row, nil, t)
    return core.vector { type(x) == "number" and x or 0 / 0 }
  end
  return component(row, column.component, n)
end

---- lists of flows, as ensembles are ----

local Flows = {}
Flows.__index = Flows

function Flows:failures() return {} end

function Flows:range(i, name)
  local low, high, one = huge, -huge, self.list[i]
  for r = 1, #one.rows do
    local now = values_at(self.columns[name], one.rows[r], one.t[r], self.n)
    for k = 1, #now do low, high = min(low, now[k]), max(high, now[k]) end
  end
  return high - low, largest(values_at(self.columns[name], one.rows[1], one.t[1], self.n))
end

-- the row of one flow at time t: the polynomial through rows around it
local function row_at(one, t)
  local last, first = #one.t, one.t[1]
  local h = (one.t[last] - first) / (last - 1)
  local place = (t - first) / h + 1
  local near = floor(place + 0.5)
  if abs(place - near) < 1e-9 then return one.rows[max(1, min(last, near))] end
  local count = min(POINTS, last)
  local from = max(1, min(last - count + 1, floor(place) - count // 2 + 1))
  local sum
  for k = from, from + count - 1 do
    local weight = 1
    for j = from, from + count - 1 do
      if j ~= k then weight = weight * (place - j) / (k - j) end
    end
    sum = sum and sum + weight * one.rows[k] or weight * one.rows[k]
  end
  return sum
end

-- How far rows t, u are from member j of flows, by column, up to a time; and the last time up to
-- which that stays within bounds, huge where it always does.
local function departure(t, rows, flows, j, columns, until_t, bounds)
  local off, one, good = {}, flows.list[j], -huge
  for k = 1, #columns do off[k] = 0 end
  for r = 1, #t do
    if t[r] > until_t then break end
    local its, within = row_at(one, t[r]), true
    for k, name in ipairs(columns) do
      local column = flows.columns[name]
      local here = largest(values_at(column, rows[r], t[r], flows.n)
        - values_at(column, its, t[r], flows.n))
      off[k] = max(off[k], here)
      within = within and not (bounds and not (here <= bounds[k]))
    end
    if not within then return off, good end
    good = t[r]
  end
  return off, huge
end

function Flows:departure(i, flows, j, columns, until_t, bounds)
  local one = self.list[i]
  return departure(one.t, one.rows, flows, j, columns, until_t, bounds)
end

--- By the names of columns how far the rows of a run are from a flow { e, i, horizon }.
function M.off(run, flow, names)
  local out, off = {}, departure(run.t, run.u, flow.e, flow.i, names, flow.horizon)
  for k, name in ipairs(names) do out[name] = off[k] end
  return out
end

-- what a parabola through three rows, k apart, misses in the middle of the first two
local function missed(self, one, name, k)
  local column, n, most = self.columns[name], self.n, 0
  local function at(r) return values_at(column, one.rows[r], one.t[r], n) end
  for r = 1, #one.rows - 2 * k, k do
    most = max(most, largest(0.375 * at(r) + 0.75 * at(r + k) - 0.125 * at(r + 2 * k)
      - at(r + k // 2)))
  end
  return most
end

--- Every so many rows show what member i does, to a share of its range.
function Flows:stride(i, columns, share)
  local one, k = self.list[i], 1
  while 8 * k < #one.rows do
    for _, name in ipairs(columns) do
      if missed(self, one, name, 2 * k) > share * self:range(i, name) then return k end
    end
    k = 2 * k
  end
  return k
end

--- Flows by one of the rules of a level, with so many slabs.
function M.run(job, flows, rule, steps)
  local map, e = job.map, setmetatable({ list = {}, status = {}, columns = {} }, Flows)
  for _, name in ipairs(map.beside.observed.columns) do
    e.columns[name] = map.beside.observed.watch[name]
  end
  for i, flow in ipairs(flows) do
    local field = map.system_of(flow).line
    e.n = field.values
    local one, code, failure = extrapolated(map, flow, field, rule, steps, map.options.t)
    if code == "stopped" then error(failure, 0) end
    e.list[i], e.status[i] = one or {}, one and "ok" or code
  end
  return e
end

--- Two rules for a flow, or nil, and why.
function M.rules_of(job, cell)
  local why = unfit(job.map)
  if why then return nil, why end
  local fine, refused = blame.try(start_of, job.map, cell, job.map.system_of(cell).line)
  if not fine then return nil, refused end
  return { M.RULES[1], M.RULES[2] }
end

--- Slabs of the finest level of a flow.
function M.most_of(job, flow)
  local field = job.map.system_of(flow).line
  return max(64, ceil(MOST / (FINER[#FINER] ^ 2 * field.cells)))
end

--- { names, columns, watch } of what is observed on a line, from its entries { name, f }.
function M.observed(list, field)
  local fail = require "dm.base.options".failing "dm.stability"
  local out = { names = {}, columns = {}, watch = {} }
  for i, entry in ipairs(list) do
    local k = entry.name == "u" and field.values == 1 and 1
      or math.tointeger(tonumber(tostring(entry.name):match "^u(%d+)$"))
    if not entry.f and not (k and k >= 1 and k <= field.values) then
      fail("option 'observe': on lines observe u%s, or name = function(u, nil, t) ... end (got "
        .. "'%s')", field.values > 1 and (" by its values, u1 to u%d"):format(field.values) or "",
        tostring(entry.name))
    end
    out.names[i], out.columns[i] = entry.name, "observed_" .. entry.name
    out.watch[out.columns[i]] = entry.f or { component = k }
  end
  return out
end

--- What is observed where nothing is said: all values.
function M.names(field)
  if field.values == 1 then return { "u" } end
  local out = {}
  for k = 1, field.values do out[k] = "u" .. k end
  return out
end

return M
