--- Series: pairs of columns as plain numbers, what can be drawn of them, and no more points of them
-- than a picture can show.
local blame = require "dm.base.blame"
local option = require "dm.base.options"

local M = {}

local floor, huge = math.floor, math.huge
local NAN = 0 / 0
-- beyond it the width of a range would overflow, below its inverse decades end
local LARGEST = 1e300

local function is_list(values) return #values, values[1] end

-- a userdata as a table; the columns of a path, as path.t, have no totable but rows of numbers
local function as_table(values)
  local known, method = blame.try(function() return values.totable end)
  if known and method then return method(values) end
  local fine, n, first = blame.try(is_list, values)
  if not fine or type(first) ~= "number" then return values end
  local out = {}
  for i = 1, n do out[i] = values[i] end
  return out
end

--- The numbers of a dm.vector, a column of a path or a table, as a table of floats; anything else
-- raises and names `what`.
function M.numbers(values, what)
  if type(values) == "userdata" then values = as_table(values) end
  if type(values) ~= "table" then
    local columns = option.got(values) == "dm.columns"
    error(("%s must be a vector or a table of numbers (got %s%s)"):format(what, option.got(values),
      columns and ", all columns together: name one, as q1, \"q1\" in a plot of a path" or ""), 0)
  end
  local out = {}
  for i = 1, #values do
    local x = values[i]
    if type(x) ~= "number" then
      error(("%s[%d] must be a number (got %s)"):format(what, i, option.got(x)), 0)
    end
    out[i] = x * 1.0  -- a float; + 0.0 would lose the sign of -0.0
  end
  return out
end

local function drawable(x, is_log)
  return x == x and x > -LARGEST and x < LARGEST and not (is_log and x < 1 / LARGEST)
end

--- Put a gap (NaN in both columns) where a point cannot be drawn.
-- @return how many were not finite, how many not positive on a logarithmic axis
function M.mark_gaps(series, logx, logy)
  local x, y = series.x, series.y
  local broken, negative = 0, 0
  for i = 1, #x do
    if not (drawable(x[i]) and drawable(y[i])) then
      broken = broken + 1
      x[i], y[i] = NAN, NAN
    elseif not (drawable(x[i], logx) and drawable(y[i], logy)) then
      negative = negative + 1
      x[i], y[i] = NAN, NAN
    end
  end
  return broken, negative
end

--- Least and largest number over one column ("x" or "y") of all series; nil when there is none.
function M.range(all, column)
  local lo, hi = huge, -huge
  for _, series in ipairs(all) do
    for _, v in ipairs(series[column]) do
      if v < lo then lo = v end
      if v > hi then hi = v end
    end
  end
  if lo <= hi then return lo, hi end
end

--- Whether the numbers never decrease (gaps aside): a time column.
function M.rises(x)
  local last = -huge
  for i = 1, #x do
    if x[i] < last then return false end
    if x[i] == x[i] then last = x[i] end
  end
  return true
end

-- first, least, largest and last point of rows i..j, in the order in which they came
local function extremes(keep, y, i, j)
  local least, largest = i, i
  for k = i + 1, j do
    if y[k] < y[least] then least = k end
    if y[k] > y[largest] then largest = k end
  end
  local a, b = math.min(least, largest), math.max(least, largest)
  local last
  for _, k in ipairs { i, a, b, j } do
    if k ~= last then keep(k) end
    last = k
  end
end

-- one bunch of points per column of pixels
local function thin_rising(keep, series, fx, width)
  local x, y, n = series.x, series.y, #series.x
  local i = 1
  while i <= n do
    local j = i
    if x[i] == x[i] then
      local column = floor(fx(x[i]) * width)
      while j < n and floor(fx(x[j + 1]) * width) == column do j = j + 1 end
      extremes(keep, y, i, j)
    else
      keep(i)
    end
    i = j + 1
  end
end

-- pixel of point i as one whole number, nil for a gap; clamped so that far points stay countable
local function pixel(series, i, scale)
  local x, y = series.x[i], series.y[i]
  if x ~= x then return nil end
  local function place(f, length)
    local at = f * length
    if at < -length then at = -length elseif at > 2 * length then at = 2 * length end
    return floor(at) + length
  end
  return place(scale.fx(x), scale.width) * (3 * scale.height + 1) + place(scale.fy(y), scale.height)
end

-- a point in a pixel that has one already is not seen
local function thin_points(keep, series, scale)
  local seen = {}
  for i = 1, #series.x do
    local p = pixel(series, i, scale)
    if p and not seen[p] then
      seen[p] = true
      keep(i)
    end
  end
end

-- a stroke between two pixels is drawn once; where strokes are left out the line is lifted
local function thin_strokes(keep, lift, series, scale)
  local seen, last, lifted = {}, nil, true
  local pixels = (3 * scale.width + 1) * (3 * scale.height + 1)
  for i = 1, #series.x do
    local p = pixel(series, i, scale)
    local key = p and last and (last * pixels + p)
    if not p then
      lift()
      lifted = true
    elseif not key then
      keep(i)
      lifted = false
    elseif key and p ~= last and not seen[key] then
      seen[key] = true
      if lifted then keep(i - 1) end
      keep(i)
      lifted = false
    elseif p ~= last and not lifted then
      lift()
      lifted = true
    end
    last = p
  end
end

--- The same picture from fewer points.
-- @param series { x, y, style }, gaps marked
-- @param scale { width, height in pixels, fx, fy: number -> fraction of the axis }
-- @return series; the least and the largest value of each column of pixels are kept
function M.thin(series, scale)
  if #series.x <= 4 * scale.width or series.style == "cells" then return series end
  local x, y = {}, {}
  local function keep(i) x[#x + 1], y[#y + 1] = series.x[i], series.y[i] end
  local function lift()
    if x[#x] == x[#x] then x[#x + 1], y[#y + 1] = NAN, NAN end
  end
  if series.style == "points" then
    thin_points(keep, series, scale)
  elseif M.rises(series.x) then
    thin_rising(keep, series, scale.fx, scale.width)
  else
    thin_strokes(keep, lift, series, scale)
  end
  return setmetatable({ x = x, y = y }, { __index = series })
end

return M
