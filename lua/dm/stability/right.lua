--- Cells beside the resolved flow: right or wrong by the observables at all times that are looked
-- at, and by the velocity that constraints leave over.
local classes = require "dm.stability.classes"
local jobs = require "dm.stability.jobs"
local observables = require "dm.stability.observables"

local M = {}

local NUMBER, finite = classes.NUMBER, classes.finite
local ceil, max, min, sqrt = math.ceil, math.max, math.min, math.sqrt

local DENSER, LEAST = 4, 256    -- rows that tell right from wrong: times those of the flow
local EVERY = 4096              -- steps that are all looked at
local NEAR = 0.9                -- of what is right: beyond it cells of the grid are looked at so

-- the observables, and what constraints ask of the velocity
local function observed_of(map, system)
  local watch = {}
  for key, value in pairs(map.beside.observed.watch) do watch[key] = value end
  if system.given.constraint then
    watch._hidden, watch._hidden_size = observables.hidden(system)
  end
  return watch
end

--- What an ensemble of cells is to look at beside their flows (solver:ensemble{beside=}), at
-- rows_of(cell) rows; bounded: until it is beyond what a right cell may be.
function M.beside(job, cells, rows_of, bounded)
  local list = {}
  for i, cell in ipairs(cells) do
    local flow = cell.flow
    list[i] = flow.e and { e = flow.e, i = flow.i, horizon = flow.horizon * (1 + 1e-14),
      rows = rows_of(cell), bound = bounded and flow.bound or nil } or false
  end
  return { watch = observed_of(job.map, job.system), flows = list,
    compared = job.map.beside.observed.columns }
end

-- the observable that is furthest off, in parts of what it may be
local function compare_with_flow(map, cell, off)
  local flow = cell.flow
  for k, column in ipairs(map.beside.observed.columns) do
    local ratio = off[column] / flow.bound[k]
    if not (ratio <= cell.ratio) then
      cell.ratio, cell.observable, cell.off, cell.range = ratio, k, off[column], flow.range[k]
    end
  end
  if not cell.observable then cell.observable, cell.off, cell.range = 1, 0, flow.range[1] end
end

-- the velocity that constraints leave over, in parts of the whole
local function compare_hidden(map, cell, off)
  cell.hidden = finite(sqrt(off._hidden))
  local part = sqrt(off._hidden / max(off._hidden_size, 1e-300)) / map.beside.accuracy
  cell.loose = not (part <= 1)
  if not (part <= cell.ratio) then cell.ratio = part end
end

--- Right or not: by the observables, and by the velocity that constraints leave over.
function M.tell(job, cells, e)
  local status = e.status
  for i, cell in ipairs(cells) do
    local flow, fine = cell.flow, status[i] == "ok"
    cell.horizon, cell.unresolved = flow.e and flow.horizon, not flow.e and flow.why or nil
    cell.ratio = 0
    local off = fine and e:followed(i)
    if fine and flow.e then compare_with_flow(job.map, cell, off) end
    if fine and off._hidden then compare_hidden(job.map, cell, off) end
    cell.is_right = fine and flow.e ~= nil and cell.ratio <= 1
  end
end

-- rows that show whether a cell is right: all of its steps where they are few
local function close_rows(cell)
  return max(LEAST, DENSER * cell.flow.rows, min(ceil(cell.flow.horizon / cell.h), EVERY))
end

--- Right or not alone, at those rows.
function M.look_closely(job, cells)
  local o = jobs.starts(job, cells)
  o.beside = M.beside(job, cells, close_rows)
  local e, stopped = jobs.guarded(job, job.system, o)
  M.tell(job, cells, e)
  return stopped
end

--- Cells that are right by little: what lies between their rows may be further off.
function M.near_look(job, part)
  local cells = {}
  for _, cell in ipairs(part) do
    local bounded = cell.class == NUMBER.bounded
    if bounded and cell.is_right and cell.ratio > NEAR then cells[#cells + 1] = cell end
  end
  if #cells == 0 then return end
  local stopped = M.look_closely(job, cells)
  if stopped then for _, cell in ipairs(cells) do cell.class = NUMBER["not run"] end end
  return stopped
end

--- What is bounded, but not right; the flows are let go.
function M.tell_wrong(part)
  for _, cell in ipairs(part) do
    local judged = cell.flow and (cell.flow.e or cell.loose)
    if judged and cell.class == NUMBER.bounded and not cell.is_right then
      cell.class = NUMBER.wrong
    end
    cell.flow = nil
  end
end

return M
