--- What is written into a panel beside its lines: triangles of a slope on logarithmic axes, marked
-- points, minor ticks. Places are in the units of the data.
local axis = require "dm.show.axis"
local option = require "dm.base.options"

local M = {}

local WHERE = "plot"
local fail = option.failing(WHERE)

local log = math.log

---- options ----

local function check_slopes(options)
  local slopes = options.slopes
  if slopes == nil then return end
  if type(slopes) == "number" then slopes = { slopes } end
  if type(slopes) ~= "table" or #slopes == 0 or #slopes > 8 then
    fail("option 'slopes' must be a list of one to eight numbers (got %s)", option.got(slopes))
  end
  for _, s in ipairs(slopes) do
    if type(s) ~= "number" or not (math.abs(s) < 100) or s == 0 then
      fail("option 'slopes' must hold numbers other than 0 (got %s)", option.got(s))
    end
  end
  if options.log ~= "xy" then
    fail("option 'slopes' draws powers, which are lines where both axes are logarithmic: log = "
      .. '"xy"')
  end
  return slopes
end

local function check_marks(options)
  local marks = option.passing(options, "marks", WHERE, function(x) return type(x) == "table" end,
    "a list of { x, y, \"text\" }")
  for i, mark in ipairs(marks or {}) do
    local fine = type(mark) == "table" and type(mark[1]) == "number" and type(mark[2]) == "number"
      and mark[1] - mark[1] == 0 and mark[2] - mark[2] == 0
      and (mark[3] == nil or type(mark[3]) == "string")
    if not fine then fail("option 'marks': entry %d must be { x, y, \"text\" }", i) end
  end
  return marks
end

--- Slopes and marks of a panel as they are given; raises where they are wrong.
function M.read(options) return check_slopes(options) or {}, check_marks(options) or {} end

---- triangles ----

-- least squares slope of log y over log x, and the middle of the series
local function power_of(series)
  local n, sx, sy, sxx, sxy = 0, 0, 0, 0, 0
  for i = 1, #series.x do
    local x, y = log(series.x[i]), log(series.y[i])
    if x - x == 0 and y - y == 0 then
      n, sx, sy, sxx, sxy = n + 1, sx + x, sy + y, sxx + x * x, sxy + x * y
    end
  end
  local spread = n * sxx - sx * sx
  if n < 2 or spread <= 0 then return nil end
  return (n * sxy - sx * sy) / spread, sx / n, sy / n
end

-- the middle of the series that is nearest to this slope, in logarithms, and its own slope
local function place_for(panel, slope)
  local best, at_x, at_y, own
  for _, series in ipairs(panel.series) do
    local s, x, y = power_of(series)
    local off = s and math.abs(s - slope)
    if off and (not best or off < best) then best, at_x, at_y, own = off, x, y, s end
  end
  local x, y = panel.x, panel.y
  return at_x or (log(x.lo) + log(x.hi)) / 2, at_y or (log(y.lo) + log(y.hi)) / 2,
    own or slope
end

local WIDE, BELOW, ROOM = 0.16, 0.07, 0.04 -- parts of the axes

local function clamp(v, lo, hi) return math.max(lo, math.min(hi, v)) end

-- Left end and foot of the triangle of a slope, `moved` to the right: below the series at both of
-- its ends, inside the panel.
local function foot_of(panel, slope, width, moved)
  local x, y = panel.x, panel.y
  local across, up, rise = log(x.hi / x.lo), log(y.hi / y.lo), slope * width
  local mx, my, own = place_for(panel, slope)
  local x0 = clamp(mx + moved, log(x.lo) + ROOM * across, log(x.hi) - 2.5 * ROOM * across - width)
  local low = my + own * (x0 - mx) + math.min(0, own * width - rise) - BELOW * up
    - math.max(0, -rise)
  return x0, clamp(low, log(y.lo) + ROOM * up + math.max(0, -rise),
    log(y.hi) - ROOM * up - math.max(0, rise))
end

-- is a box { x0, x1, y0, y1 } apart from all others?
local function is_free(box, others)
  for _, o in ipairs(others) do
    if box[1] < o[2] and o[1] < box[2] and box[3] < o[4] and o[3] < box[4] then return false end
  end
  return true
end

local MOVES = { 0, 1, -1, 2, -2, 3, -3, 0 } -- widths by which a triangle is moved out of the way

--- Triangles { x = 4 numbers, y = 4 numbers, at = { x, y }, text } of the slopes of a panel whose
-- axes are made: below and to the right of the series that each is nearest to, inside the panel.
function M.triangles(panel)
  local out, boxes, x, y = {}, {}, panel.x, panel.y
  local across, up = log(x.hi / x.lo), log(y.hi / y.lo)
  for k, slope in ipairs(panel.slopes) do
    local width = WIDE * across
    local rise = slope * width
    if math.abs(rise) > 0.5 * up then
      width = 0.5 * up / math.abs(slope)
      rise = slope * width
    end
    local x0, low
    for _, by in ipairs(MOVES) do
      x0, low = foot_of(panel, slope, width, by * (width + 0.08 * across))
      boxes[k] = { x0, x0 + width + 0.07 * across, math.min(low, low + rise),
        math.max(low, low + rise) }
      if is_free(boxes[k], { table.unpack(boxes, 1, k - 1) }) then break end
    end
    local x1, y1 = x0 + width, low + rise
    local e = math.exp
    out[k] = { x = { e(x0), e(x1), e(x1), e(x0) }, y = { e(low), e(low), e(y1), e(low) },
      at = { e(x1 + 0.012 * across), e((low + y1) / 2) }, text = ("%g"):format(slope) }
  end
  return out
end

---- marks ----

--- A mark's text stands on the side where there is more room: "left" or "right" of the point.
function M.side(panel, mark) return axis.fraction(panel.x, mark[1]) > 0.6 and "left" or "right" end

return M
