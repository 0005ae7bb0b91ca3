--- How large a picture is and how it is written: size with its unit, dots per inch, letters, lines.
-- Lengths of layouts are in pixels of a picture whose letters have 11 points at 96 dots per inch.
local option = require "dm.base.options"

local M = {}

local WHERE = "plot"
local fail = option.failing(WHERE)

--- Options that say it.
M.KNOWN = { "width", "height", "size", "dpi", "font", "fontsize", "linewidth" }

--- Those of a picture whose height is an angle.
M.SIZED = { "size", "dpi", "font", "fontsize", "linewidth" }

--- The options among these that are of M.SIZED.
function M.sized(options)
  local out = {}
  for _, key in ipairs(M.SIZED) do out[key] = options[key] end
  return out
end

local INCHES = { cm = 1 / 2.54, mm = 1 / 25.4, ["in"] = 1 }
local SCREEN, PRINT = 96, 300     -- dots per inch
local POINTS, PRINT_POINTS = 11, 8 -- of letters

-- width and height as they are given, and inches per unit of them: nil of pixels, or of characters
local function given_size(options)
  local size = options.size or {}
  if type(size) ~= "table" then fail "option 'size' must be {width, height} or {8.5, 6, \"cm\"}" end
  local unit = size[3]
  if unit ~= nil and unit ~= "px" and not INCHES[unit] then
    fail("option 'size': the unit must be \"cm\", \"mm\", \"in\" or \"px\" (got %s)",
      option.got(unit))
  end
  return options.width or size[1], options.height or size[2], INCHES[unit]
end

local function check_lengths(w, h, inch)
  for name, n in pairs { width = w or 100, height = h or 100 } do
    if inch and not (type(n) == "number" and n * inch >= 0.5 and n * inch <= 60) then
      fail("option '%s' must be a length from half an inch to 60", name)
    end
    if not inch and (type(n) ~= "number" or not (n >= 4 and n <= 20000)) then
      fail("option '%s' must be a number from 4 to 20000 (pixels in a file, characters in a "
        .. "terminal)", name)
    end
  end
end

--- Raises where one of these options is wrong.
function M.check(options)
  check_lengths(given_size(options))
  local function between(key, least, most)
    local x = option.number(options, key, WHERE)
    if x and not (x >= least and x <= most) then
      fail("option '%s' must be from %g to %g (got %g)", key, least, most, x)
    end
  end
  between("dpi", 20, 2400)
  between("fontsize", 2, 100)
  between("linewidth", 0.05, 20)
  option.passing(options, "font", WHERE, function(x)
    return type(x) == "string" and x:find "^[%w][%w %-]*$"
  end, "the name of a font")
end

--- Width and height in whole pixels or characters, as far as they are given so.
function M.pixels(options)
  local w, h, inch = given_size(options)
  if inch then return nil end
  return w and math.floor(w), h and math.floor(h)
end

--- { inches = {w, h}, dpi, font, points, linewidth (points, or nil), printed, width, height }; w
-- and h: pixels of one that has no size. width and height are those of the layout.
function M.of(options, w, h)
  local asked_w, asked_h, inch = given_size(options)
  local look = { printed = inch ~= nil, font = options.font or "DejaVu Sans",
    dpi = options.dpi or inch and PRINT or SCREEN, linewidth = options.linewidth,
    points = options.fontsize or inch and PRINT_POINTS or POINTS, sized = options.fontsize ~= nil }
  if inch then
    asked_w, asked_h = asked_w * inch, (asked_h or asked_w * 0.7) * inch
  else
    asked_w, asked_h = math.floor(asked_w or w) / SCREEN, math.floor(asked_h or h) / SCREEN
  end
  look.inches = { asked_w, asked_h }
  local unit = SCREEN * POINTS / look.points
  look.width, look.height = asked_w * unit, asked_h * unit
  return look
end

local function round(x) return math.floor(x + 0.5) end

local TERMINALS = {}

function TERMINALS.png(look)
  local scale = look.dpi / SCREEN
  local w, h = round(look.inches[1] * look.dpi), round(look.inches[2] * look.dpi)
  return ("pngcairo enhanced size %d,%d font '%s,%g' fontscale %g linewidth %g background rgb "
    .. "'white'"):format(w, h, look.font, look.points, scale, scale)
end

function TERMINALS.svg(look)
  local points = (look.printed or look.sized) and look.points * SCREEN / 72 or 13
  return ("svg enhanced size %d,%d dynamic font '%s,%g' background rgb 'white'")
    :format(round(look.inches[1] * SCREEN), round(look.inches[2] * SCREEN), look.font, points)
end

function TERMINALS.pdf(look)
  local by = look.printed and 1 or SCREEN / 100
  return ("pdfcairo enhanced size %.4f,%.4f font '%s,%g'%s"):format(look.inches[1] * by,
    look.inches[2] * by, look.font, (look.printed or look.sized) and look.points or 10,
    look.printed and " fontscale 1 linewidth 1" or "")
end

--- Pictures that can be written, by the ending of the file: a terminal of gnuplot for each.
M.TERMINALS = TERMINALS

return M
