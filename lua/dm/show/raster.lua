--- A map of colours in a file: axes with ticks as those of curves, its scale at the right, and
-- margins as their texts need them.
local axis = require "dm.show.axis"
local label = require "dm.show.label"
local look_ = require "dm.show.look"

local M = {}

local WIDTH = 0.62  -- of a digit, in heights of a letter
-- away from the ticks, in widths of a letter: a name at its tick would be read with it
local APART = { x = 0, y = -0.9, cb = 0.9 }

-- Ticks and name of one axis { lo, hi, text }. @return width of its widest tick, its range
local function set_axis(add, name, given)
  local a = axis.new(given[1], given[2], 8)
  local ticks, widest = {}, 0
  for i, tick in ipairs(a.ticks) do
    ticks[i] = ("%s %.12g"):format(label.quote(tick.text), a.offset + tick.shown * 10.0 ^ a.power)
    widest = math.max(widest, #tick.text)
  end
  local text = axis.caption(a, given[3])
  local shown = name == "cb" and label.upright(text) or label.caption(text)
  local upright = name == "y" and (utf8.len(text) or 4) <= 3 and " norotate" or ""
  local apart = shown:find "norotate$" and "" or (" offset %g,0"):format(APART[name])
  add(("set %stics (%s)"):format(name, table.concat(ticks, ", ")))
  add(("set %slabel %s%s%s"):format(name, shown, upright, apart))
  return WIDTH * widest, a
end

--- Lines of a script: ticks, margins, ranges. axes: x, y and cb (of the colours), each
-- { from, to, name }; without cb the caller sets a scale of its own. width, height: pixels of a
-- picture that has no size.
function M.axes(options, width, height, axes)
  local look = look_.of(options, width, height)
  local across, up = look.points / 72 / look.inches[1], look.points / 72 / look.inches[2]
  local lines = { "set tics out nomirror textcolor rgb '#303030'",
    "set border lc rgb '#808080'\nunset key" }
  local function add(line) lines[#lines + 1] = line end
  set_axis(add, "x", axes.x)
  local left, right = set_axis(add, "y", axes.y), 4 * WIDTH
  if axes.cb then
    local scale
    right, scale = set_axis(add, "cb", axes.cb)
    add(("set cbrange [%.12g:%.12g]"):format(scale.lo, scale.hi))
  end
  add(("set lmargin at screen %.4f\nset rmargin at screen %.4f"):format((4 + left) * across,
    (1 - (3.6 + right) * across) / 1.09))
  add(("set bmargin at screen %.4f\nset tmargin at screen %.4f"):format(5.2 * up, 1 - 2.6 * up))
  return table.concat(lines, "\n")
end

return M
