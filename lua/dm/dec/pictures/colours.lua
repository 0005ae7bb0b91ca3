--- Colours for numbers that the colour-blind can order: from dark to bright (viridis, by N. Smith
-- and S. van der Walt), or from blue over white to red where there are numbers of both signs.
local M = {}

local RISING = { 0x440154, 0x472c7a, 0x3b518b, 0x2c718e, 0x21908d, 0x27ad81, 0x5cc863, 0xaadc32,
  0xfde725 }
local SIGNED = { 0x2166ac, 0x67a9cf, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xef8a62, 0xb2182b }

local SAME = 1e-12  -- numbers whose range is less, beside their size, are one number with round-off

local function hex(x) return ("#%06x"):format(x) end

--- The scale of a list of numbers: least, largest, stops (colours as "#rrggbb", evenly spaced).
-- Numbers of both signs have 0 in the middle.
function M.scale(values)
  local lo, hi = math.huge, -math.huge
  for i = 1, #values do lo, hi = math.min(lo, values[i]), math.max(hi, values[i]) end
  local stops = {}
  local is_signed = math.min(-lo, hi) > 0.01 * math.max(-lo, hi) -- not by round-off
  if is_signed then lo, hi = math.min(lo, -hi), math.max(hi, -lo) end
  for i, x in ipairs(is_signed and SIGNED or RISING) do stops[i] = hex(x) end
  local size = math.max(-lo, hi)
  if hi - lo <= SAME * size then
    local middle = lo + (hi - lo) / 2
    local half = middle == 0 and 0.5 or math.abs(middle) / 2
    lo, hi = middle - half, middle + half
  end
  return { least = lo, largest = hi, stops = stops, numbers = is_signed and SIGNED or RISING }
end

local function mixed(a, b, t, shift)
  local x, y = a >> shift & 255, b >> shift & 255
  return math.floor(x + (y - x) * t + 0.5) << shift
end

--- The colour of x on a scale, "#rrggbb".
function M.at(scale, x)
  local count = #scale.numbers - 1
  local place = (x - scale.least) / (scale.largest - scale.least) * count
  place = math.max(0, math.min(count, place))
  local i = math.min(count - 1, math.floor(place))
  local a, b, t = scale.numbers[i + 1], scale.numbers[i + 2], place - i
  return hex(mixed(a, b, t, 16) + mixed(a, b, t, 8) + mixed(a, b, t, 0))
end

return M
