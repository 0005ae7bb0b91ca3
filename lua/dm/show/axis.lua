--- Axes: from the range of the data to the range that is shown, its ticks and their texts.
-- A shown number is (value - offset) / 10^power; both are written into the caption, so that an
-- energy of -0.5 that wanders by 1e-9 has readable ticks and still says what it is.
local M = {}

local floor, ceil, abs, max, log = math.floor, math.ceil, math.abs, math.max, math.log

local superscripts = { ["-"] = "⁻", ["0"] = "⁰", ["1"] = "¹", ["2"] = "²", ["3"] = "³",
  ["4"] = "⁴", ["5"] = "⁵", ["6"] = "⁶", ["7"] = "⁷", ["8"] = "⁸", ["9"] = "⁹" }

local function power_of_ten(k)
  return "10" .. ("%d"):format(k):gsub(".", superscripts)
end

--- The text with whole powers written above the line: "m^2/s" as "m²/s".
function M.raised(text)
  return (text:gsub("%^(%-?%d+)%f[^%w.]", function(power)
    return (power:gsub(".", superscripts))
  end))
end

local function decade(x) return floor(log(x, 10) + 1e-9) end

--- Where x lies between the ends of the axis: 0 at lo, 1 at hi.
function M.fraction(axis, x)
  if axis.log then return (log(x) - log(axis.lo)) / (log(axis.hi) - log(axis.lo)) end
  return (x - axis.lo) / (axis.hi - axis.lo)
end

-- 1, 2 or 5 times a power of ten, just above `raw`; also that power
local function nice(raw)
  local k = decade(raw)
  for _, digit in ipairs { 1, 2, 5 } do
    if digit * 10.0 ^ k >= raw * (1 - 1e-9) then return digit * 10.0 ^ k, k end
  end
  return 10.0 ^ (k + 1), k + 1
end

-- a constant gets a width; a few units in the last place are shown as the small thing they are
local function widen(lo, hi)
  local size, middle = max(abs(lo), abs(hi)), lo + (hi - lo) / 2
  if hi - lo > 2e-14 * size and hi - lo > 1e-300 then return lo, hi end
  local half = size * (hi > lo and 1e-14 or 0.1)
  if half < 1e-300 then half = 1 end
  return middle - half, middle + half
end

-- the round number to subtract when the range is narrow beside its distance from zero, else 0
local function offset_of(lo, hi)
  local span, size = hi - lo, max(abs(lo), abs(hi))
  if span > 1e-5 * size then return 0 end
  local unit = 10.0 ^ ceil(log(span, 10))
  return tonumber(("%.15g"):format(floor((lo + hi) / 2 / unit + 0.5) * unit))
end

local function power_for(size)
  if size >= 1e6 or size < 1e-3 then return decade(size) end
  return 0
end

-- numbers of the first and last tick, as multiples of the step
local function tick_numbers(axis, step)
  local lo, hi = axis.lo - axis.offset, axis.hi - axis.offset
  return ceil(lo / step - 1e-6), floor(hi / step + 1e-6)
end

-- at most `most` ticks, but two at least
local function add_ticks(axis, most)
  local step, k = nice((axis.hi - axis.lo) / most)
  local first, last = tick_numbers(axis, step)
  while last - first < 1 do
    step, k = nice(step / 2.6)  -- the next smaller one
    first, last = tick_numbers(axis, step)
  end
  local decimals = max(0, axis.power - k)
  for i = first, last do
    local text = ("%.*f"):gsub("%*", decimals):format(i * step / 10.0 ^ axis.power)
    local fraction = (i * step - (axis.lo - axis.offset)) / (axis.hi - axis.lo)
    axis.ticks[#axis.ticks + 1] = { shown = i * step / 10.0 ^ axis.power, fraction = fraction,
      text = text }
  end
end

local function linear(lo, hi, most)
  lo, hi = widen(lo, hi)
  local offset = offset_of(lo, hi)
  local power = power_for(max(abs(lo - offset), abs(hi - offset)))
  local axis = { lo = lo, hi = hi, offset = offset, power = power, ticks = {} }
  add_ticks(axis, most)
  return axis
end

local function log_tick(axis, digit, k, plain)
  local at = digit * 10.0 ^ k
  if at < axis.lo * (1 - 1e-9) or at > axis.hi * (1 + 1e-9) then return end
  local text = (digit > 1 and digit .. "·" or "") .. power_of_ten(k)
  if plain then text = ("%g"):format(at) end
  axis.ticks[#axis.ticks + 1] = { shown = at, fraction = M.fraction(axis, at), text = text }
end

-- powers of ten, thinned to `most`; within two decades also 2 and 5 times them
local function logarithmic(lo, hi, most)
  if hi <= lo * (1 + 1e-12) then lo, hi = lo / 2, hi * 2 end
  local axis = { lo = lo, hi = hi, offset = 0, power = 0, ticks = {}, log = true }
  local first, last = ceil(log(lo, 10) - 1e-6), floor(log(hi, 10) + 1e-6)
  local stride = max(1, ceil((last - first + 1) / most))
  if last - first < 2 then
    for k = first - 1, last do
      for _, digit in ipairs { 1, 2, 5 } do log_tick(axis, digit, k, abs(k) <= 3) end
    end
  else
    for k = stride * ceil(first / stride), last, stride do log_tick(axis, 1, k) end
  end
  return axis
end

--- Axis over lo..hi with about `most` ticks at the most. @return { lo, hi, offset, power, log,
-- ticks = { {shown, fraction, text} ... } }; fraction: 0 at lo, 1 at hi
function M.new(lo, hi, most, is_log)
  return (is_log and logarithmic or linear)(lo, hi, most)
end

-- multiples of the parts of a decade
local function minor_log(axis)
  local out = {}
  for k = floor(log(axis.lo, 10)) - 1, ceil(log(axis.hi, 10)) do
    for digit = 2, 9 do out[#out + 1] = digit * 10.0 ^ k end
  end
  return out
end

--- Shown numbers of the minor ticks of an axis: four between two ticks; of a logarithmic one 2 to 9
-- times its powers, or the powers that have no tick.
function M.minor(axis)
  local out, ticks = {}, axis.ticks
  if #ticks < 2 then return out end
  if axis.log then
    if axis.hi / axis.lo > 1e7 then
      for k = ceil(log(axis.lo, 10)), floor(log(axis.hi, 10)) do out[#out + 1] = 10.0 ^ k end
      return out
    end
    for _, x in ipairs(minor_log(axis)) do
      if x >= axis.lo and x <= axis.hi then out[#out + 1] = x end
    end
    return out
  end
  local step = (ticks[2].shown - ticks[1].shown) / 5
  local unit = 10.0 ^ axis.power
  for k = -4, 5 * #ticks do
    local x = ticks[1].shown + k * step
    local at = x * unit + axis.offset
    if k % 5 ~= 0 and at >= axis.lo and at <= axis.hi then out[#out + 1] = x end
  end
  return out
end

--- The range lo..hi with the part `by` of its width added on either side.
function M.pad(lo, hi, by, is_log)
  if is_log then
    local factor = math.exp(by * (log(hi) - log(lo)))
    return max(lo / factor, 1e-305), math.min(hi * factor, 1e305)
  end
  return lo - by * (hi - lo), hi + by * (hi - lo)
end

--- "energy + 0.5 (10⁻⁹ J)" from the label, the unit and what the axis takes away from its numbers.
function M.caption(axis, label, unit)
  local parts = { label }
  if axis.offset ~= 0 then
    parts[2] = (axis.offset > 0 and "- " or "+ ") .. ("%.15g"):format(abs(axis.offset))
  end
  local scale = axis.power ~= 0 and power_of_ten(axis.power) or nil
  local inside = scale and unit and scale .. " " .. unit or scale or unit
  if inside then parts[#parts + 1] = "(" .. inside .. ")" end
  return M.raised(table.concat(parts, " "))
end

--- The ranges that give both axes the same length per unit on an area of w by h (any unit of
-- length). @return lox, hix, loy, hiy
function M.equal(x, y, w, h)
  local scale = max((x[2] - x[1]) / w, (y[2] - y[1]) / h)
  local function around(range, length)
    local middle = (range[1] + range[2]) / 2
    return middle - scale * length / 2, middle + scale * length / 2
  end
  local lox, hix = around(x, w)
  return lox, hix, around(y, h)
end

return M
