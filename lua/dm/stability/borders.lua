--- Borders of a stability map: to what is lost, and to what is not right, refined by cells between.
local axes = require "dm.stability.axes"
local blame = require "dm.base.blame"
local cells = require "dm.stability.cells"
local tongues = require "dm.stability.tongues"

local M = {}

local abs, max, min, log, huge = math.abs, math.max, math.min, math.log, math.huge

local PARTS = 7   -- cells between two neighbours of which one is lost, run at once
local ROUNDS = 16 -- of refinement at most

--- A cell of a row at x; cells of a row share its parameters, where the columns are steps.
function M.cell_at(map, row, x)
  local values = row.values
  if map.column ~= map.h then
    values = { [map.column.name] = x }
    for name, value in pairs(row.values) do values[name] = value end
  end
  return { rule = row.number, h = map.column == map.h and x or map.h[1], values = values, x = x,
    row = row }
end

local function is_lost(cell) return cells.CLASSES[cell.class].lost end

local function is_not_right(cell)
  return not cell.is_right and cell.class ~= cells.NUMBER["not run"]
end

-- cells of a row against their neighbour of smaller step that shows the motion
local function compare_row(map, row)
  if map.column ~= map.h then return end
  local smaller
  for _, cell in ipairs(row) do
    if smaller then cells.compare(cell, smaller) end
    if not is_lost(cell) and (cell.kinetic or 0) > 0 then smaller = cell end
  end
end

-- the last cell before the first for which test holds, and that one
local function border(row, test)
  for j, cell in ipairs(row) do
    if test(cell) then return { under = row[j - 2], low = row[j - 1], high = cell } end
  end
  return {}
end

--- map.borders[i], map.right[i] = { low, high, under, number = i }: the last cell of a row before
-- the first that is lost, or not right, that one, and the one below both.
function M.find(map)
  for i, row in ipairs(map.cells) do
    compare_row(map, row)
    map.borders[i] = border(row, is_lost)
    map.right[i] = map.beside and border(row, is_not_right) or {}
    map.borders[i].number, map.right[i].number = i, i
  end
end

-- cells of a row and others between them, the smallest x first
local function joined(row, others)
  local out = { table.unpack(row) }
  for _, cell in ipairs(others) do out[#out + 1] = cell end
  table.sort(out, function(a, b) return a.x < b.x end)
  return out
end

-- the first cell of a row beyond x that is not lost, though one before it is
local function first_again(row, x)
  for _, cell in ipairs(row) do
    if cell.x > x and not is_lost(cell) and cell.class ~= cells.NUMBER["not run"] then
      return cell.x
    end
  end
end

-- the last column of a row before x; its rows are those that neighbours are compared with, for a
-- step that turns by a part of a circle may show the motion at rest at all of them
local function column_before(row, x)
  local last
  for _, cell in ipairs(row) do
    if cell.x < x then last = cell end
  end
  return last
end

-- the borders of row i, where one of the cells in between that linear theory doubts is lost
local function find_again(map, i, others, is_judged)
  local row = map.cells[i]
  for _, cell in ipairs(others) do cells.compare(cell, column_before(row, cell.x)) end
  local found = border(joined(row, others), is_lost)
  local high, before = found.high, map.borders[i].high
  if not high or before and high.x >= before.x then return false end
  found.base, found.again = column_before(row, high.x), first_again(row, high.x)
  found.number, map.borders[i] = i, found
  local right = map.right[i].high
  if is_judged and not (right and right.x <= high.x) then
    map.right[i] = border(joined(row, { high }), is_not_right)
    map.right[i].number = i
  end
  return true
end

-- Cells of row i that columns step over, where linear theory expects the motion to be lost: what a
-- stop on request was, and whether one is lost; is_judged: borders of what is right end there too.
local function look_between(map, i, is_judged)
  local b, others = map.borders[i], {}
  local top = b.high and b.high.x or map.column[#map.column]
  for k, x in ipairs((b.low or not b.high) and tongues.places(map, i, top) or {}) do
    others[k] = M.cell_at(map, map.rows[i], x)
    others[k].number = k
  end
  if #others == 0 then return nil, false end
  local stopped = cells.run(map, others)
  if stopped then return stopped end
  return nil, find_again(map, i, others, is_judged)
end

local function is_open(map, b)
  if not (b.low and b.high) then return false end
  local gap = abs(b.high.x - b.low.x)
  if map.by_ones then return gap > 1 end
  return gap > map.resolution * max(abs(b.high.x), abs(b.low.x))
end

-- has a column of whole numbers no system between them, as that of sizes of a mesh?
local function is_by_ones(map)
  for i, b in ipairs(map.column.whole and map.borders or {}) do
    if b.low and b.high then
      local cell = M.cell_at(map, map.rows[i], b.low.x + 0.5)
      return not blame.try(map.system_of, cell)
    end
  end
  return false
end

-- where in a border that is lost: nothing is known between its ends
local function even_places()
  local out = {}
  for k = 1, PARTS do out[k] = k / (PARTS + 1) end
  return out
end

-- the power of x that the error is between two cells; nil where it is not known
local function power(a, b)
  local known = a and a.x > 0 and a.ratio and b.ratio and a.ratio > 0 and b.ratio < huge
  if not known then return nil end
  local p = log(b.ratio / a.ratio) / log(b.x / a.x)
  return p > 0.25 and p < 32 and p or nil
end

-- Where between low and high, from 0 to 1, the error comes to what is allowed. A cell that is not
-- right was looked at closely here alone; the power is that of those below it before.
local function place_of_border(map, b)
  local low, high = b.low, b.high
  local p = not high.is_close and power(b.under, low) or power(low, high)
  if not p then return nil end
  local x = low.x * low.ratio ^ (-1 / p)
  local s = map.column.log and log(x / low.x) / log(high.x / low.x)
    or (x - low.x) / (high.x - low.x)
  return min(max(s, 0.02), 0.98)
end

-- First the place itself, whose error tells it closely; then two about it, so near to each other
-- that they are a border; where an error is not known even ones.
local function places_by_error(map, b)
  local s = place_of_border(map, b)
  if not s then return even_places() end
  if not b.is_near then
    b.is_near = true
    return { s }
  end
  local apart = 0.4 * map.resolution * max(abs(b.high.x), abs(b.low.x)) / abs(b.high.x - b.low.x)
  return { max(s - apart, 0.02), min(max(s + apart, 0.04), 0.98) }
end

-- cells between the ends of all borders that are open
local function between(map, list, places_of)
  local open, todo = {}, {}
  for _, b in ipairs(list) do
    local parts = {}
    for k, s in ipairs(is_open(map, b) and places_of(map, b) or {}) do
      local x = axes.between(map.column, b.low.x, b.high.x, s)
      if map.by_ones then x = max(b.low.x + 1, min(b.high.x - 1, math.floor(x))) end
      local cell = M.cell_at(map, map.rows[b.number], x)
      cell.number = k
      parts[k], todo[#todo + 1] = cell, cell
    end
    if #parts > 0 then open[#open + 1] = { border = b, parts = parts } end
  end
  return open, todo
end

-- Narrow all borders of a list at once: cells in each, run by `run`, then the part in which the
-- first is such. They are all compared with the cell that the border began at: at the limit itself
-- rows are in step with the motion, and may show it at rest.
local function narrow(map, list, places_of, test, run)
  for _, b in ipairs(list) do b.base = b.base or b.low end
  for _ = 1, ROUNDS do
    local open, todo = between(map, list, places_of)
    if #todo == 0 then return end
    local stopped = run(map, todo)
    if stopped then return stopped end
    for _, one in ipairs(open) do
      for _, cell in ipairs(one.parts) do
        if test == is_lost and map.column == map.h then
          cells.compare(cell, one.border.base)
        end
        if test(cell) then
          one.border.high = cell
          break
        end
        one.border.under, one.border.low = one.border.low, cell
      end
    end
  end
end

-- f(...) of cells that are not compared with their flows; these come back however f ends
local function without_flows(map, f, ...)
  local beside = map.beside
  local _ <close> = setmetatable({}, { __close = function() map.beside = beside end })
  map.beside = nil
  return f(...)
end

-- both kinds of borders, of all rows or of one; what a stop on request was, or nothing
local function narrow_both(map, lost, right)
  return without_flows(map, narrow, map, lost, even_places, is_lost, cells.run)
    or map.beside and narrow(map, right, places_by_error, is_not_right, cells.run_right) or nil
end

--- Narrow all borders to the resolution of the map; what a stop on request was, or nothing.
function M.refine(map)
  map.by_ones = is_by_ones(map)
  local stopped = narrow_both(map, map.borders, map.right)
  map.is_refined = not stopped
  return stopped
end

-- was a cell of the row left out?
local function is_cut(row)
  for _, cell in ipairs(row) do
    if cell.class == cells.NUMBER["not run"] then return true end
  end
  return false
end

--- The borders of row i, once also looked for between its columns (tongues.lua), which costs linear
-- theory along the orbit and some cells more; what a stop on request was, or nothing.
function M.settle(map, i)
  local row = map.rows[i]
  if row.is_settled or not map.is_refined or is_cut(map.cells[i]) then return nil end
  local stopped, found = without_flows(map, look_between, map, i, map.beside ~= nil)
  row.is_wide = row.is_wide or found -- until it is narrow: a stop on request leaves the rest to do
  stopped = stopped or row.is_wide and narrow_both(map, { map.borders[i] }, { map.right[i] }) or nil
  row.is_settled = not stopped
  return stopped
end

return M
