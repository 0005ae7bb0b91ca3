--- Values as characters, from light to dark: rasters in a terminal.
local core = require "dm.core"
local look = require "dm.show.look"

local M = {}

local SHADES = { " ", ".", ":", "-", "=", "+", "*", "#", "%", "@" }
local MARGIN = 10 -- characters left of a raster

--- A function value -> character for values from lo to hi, and the sentence that explains it. With
-- `first` = 2 the blank is left to what has no value.
function M.scale(lo, hi, first)
  local count = #SHADES - first + 1
  local function shade(x)
    local part = hi > lo and (x - lo) / (hi - lo) or 0.5
    return SHADES[first + math.max(0, math.min(count - 1, math.floor(part * count)))]
  end
  return shade, ("'%s' = %.4g, '%s' = %.4g"):format(SHADES[first], lo, SHADES[#SHADES], hi)
end

--- Columns that fit, as options or the terminal say, and rows, where options say so.
function M.size(options)
  local known = core.terminal and core.terminal() or {}
  local width, height = look.pixels(options)
  return math.max(20, math.min(width or known.width or 80, 200) - MARGIN), height
end

--- A line of a raster behind its label, a number or nothing.
function M.line(label, text)
  return (label and ("%8.4g |"):format(label) or (" "):rep(MARGIN)) .. text
end

--- The line below, with what stands at both ends.
function M.ends(from, to, columns)
  from, to = ("%.4g"):format(from), ("%.4g"):format(to)
  return (" "):rep(MARGIN) .. from .. (" "):rep(math.max(1, columns - #from - #to)) .. to
end

return M
