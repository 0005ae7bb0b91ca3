--- Pictures: dm.plot, dm.figure, path:plot, path:series. This file makes a figure out of arguments;
-- dm.braille shows it in a terminal, dm.gnuplot in a file.
local blame = require "dm.base.blame"
local core = require "dm.core"
local axis, series_ = require "dm.show.axis", require "dm.show.series"
local inline = require "dm.show.inline"
local look = require "dm.show.look"
local notes = require "dm.show.notes"
local option = require "dm.base.options"

local M = {}

local KNOWN = { "file", "title", "xlabel", "ylabel", "xunit", "yunit", "log", "style", "names",
  "legend", "equal", "xrange", "yrange", "slopes", "marks", "minor", "text", "ascii",
  entries = true }
table.move(look.KNOWN, 1, #look.KNOWN, #KNOWN + 1, KNOWN)
-- of a series also "cells": rectangles xlow..xhigh, ylow..yhigh
local STYLES = { "lines", "points", "linespoints" }

local WHERE = "plot"
local fail = option.failing(WHERE)

---- options ----

local function check_text(options, keys)
  for _, key in ipairs(keys) do option.text(options, key, WHERE) end
end

local function check_range(options, key)
  local range = options[key]
  if range == nil then return end
  local lo, hi = table.unpack(type(range) == "table" and range or {})
  if type(lo) ~= "number" or type(hi) ~= "number"
    or not (lo < hi and lo > -1e300 and hi < 1e300) then
    fail("option '%s' must be {least, largest}", key)
  end
  if options.log and options.log:find(key:sub(1, 1)) and lo < 1e-300 then
    fail("option '%s' must be positive on a logarithmic axis", key)
  end
end

-- what a panel and a figure both take
local function check_look(options)
  look.check(options)
  option.one_of(options, "text", WHERE, { "plain" })
  for _, key in ipairs { "ascii", "minor" } do
    option.passing(options, key, WHERE, function(x) return type(x) == "boolean" end,
      "true or false")
  end
end

local function check_options(options)
  option.check(options, KNOWN, WHERE)
  check_text(options, { "file", "title", "xlabel", "ylabel", "xunit", "yunit", "log", "style" })
  if options.log ~= "" then option.one_of(options, "log", WHERE, { "x", "y", "xy" }) end
  option.one_of(options, "style", WHERE, STYLES)
  check_range(options, "xrange")
  check_range(options, "yrange")
  check_look(options)
  notes.read(options)
end

---- from arguments to series ----

local function is_column(v)
  return type(v) == "userdata" or type(v) == "table" and type(v[1]) == "number"
end

local OF_SERIES = { "title", "xlabel", "ylabel", "xunit", "yunit" }

-- a name that gnuplot knows, or red, green and blue
local function is_colour(x)
  return type(x) == "string" and (x:find "^%a[%w-]*$" or x:find "^#%x%x%x%x%x%x$") ~= nil
end

local function check_series(given, where)
  for _, key in ipairs(OF_SERIES) do option.text(given, key, where) end
  option.passing(given, "colour", where, is_colour, "the name of a colour or \"#rrggbb\"")
end

-- { x =, y =, name =, style =, colour = } with its own copy of the numbers; halo: white round what
-- is drawn over cells, open: circles for points
local function make_series(given, options, i)
  local what = "series " .. i
  local x = series_.numbers(given.x or given[1], what .. ": x")
  local y = series_.numbers(given.y or given[2], what .. ": y")
  if #x ~= #y then fail("%s has %d numbers x but %d numbers y", what, #x, #y) end
  if #x == 0 then fail("%s is empty", what) end
  check_series(given, WHERE .. ": " .. what)
  if given.style ~= "cells" then option.one_of(given, "style", WHERE .. ": " .. what, STYLES) end
  local names = core.unlocked(options.names)
  names = type(names) == "table" and names or {}
  local out = { x = x, y = y, name = tostring(names[i] or given.name or what), of = given,
    colour = given.colour, halo = given.halo, open = given.open,
    style = given.style or options.style or (#x == 1 and "points" or "lines") }
  for _, edge in ipairs(out.style == "cells" and { "xlow", "xhigh", "ylow", "yhigh" } or {}) do
    out[edge] = series_.numbers(given[edge] or {}, what .. ": " .. edge)
    if #out[edge] ~= #x then
      fail("%s has %d numbers x but %d numbers %s", what, #x, #out[edge], edge)
    end
  end
  return out
end

-- the arguments of dm.plot as a list of { x =, y = } and the options
local function sort_arguments(a, b, c)
  if is_column(a) and is_column(b) then return { { x = a, y = b } }, c or {} end
  if is_column(a) and type(b) == "table" and is_column(b[1]) then
    local list = {}
    for i, y in ipairs(b) do list[i] = { x = a, y = y } end
    return list, c or {}
  end
  if type(a) == "table" and type(a[1]) == "table" then
    return a, b or {}
  end
  local got = b == nil and option.got(a) or option.got(a) .. " and " .. option.got(b)
  fail("needs two columns (vectors or tables of numbers), one column and a list of columns, "
    .. "or a list of series { x =, y =, name = } (got %s%s)", got,
    is_column(a) and b == nil and ": against what? A path has plot of its own, path:plot(y)"
      or "")
end

---- from series to a panel ----

-- what all series agree on, else nil
local function shared(list, key)
  local value = list[1].of[key]
  for _, s in ipairs(list) do
    if s.of[key] ~= value then return nil end
  end
  return value
end

local function count_gaps(list, panel)
  local broken, negative = 0, 0
  for _, s in ipairs(list) do
    local b, n = series_.mark_gaps(s, panel.logx, panel.logy)
    broken, negative = broken + b, negative + n
  end
  local function note(n, why)
    local points = n == 1 and "1 point" or n .. " points"
    if n > 0 then panel.notes[#panel.notes + 1] = points .. " not shown: " .. why end
  end
  note(broken, "not finite")
  note(negative, "not positive on a logarithmic axis")
end

-- data range of a column with a little room around it, or the range that was asked for
local function set_range(panel, name, room)
  local is_log = panel["log" .. name]
  local lo, hi = series_.range(panel.series, name)
  if not lo then
    fail("nothing to draw: no point is finite%s", (panel.logx or panel.logy)
      and " and positive on the logarithmic axis" or "")
  end
  if not is_log then
    local plain = axis.new(lo, hi, 2)  -- gives a constant column a width
    lo, hi = plain.lo, plain.hi
  elseif lo == hi then
    lo, hi = lo / 2, hi * 2
  end
  panel[name .. "range"] = { axis.pad(lo, hi, room, is_log) }
end

local function decide_equal(panel, list, options)
  if panel.logx or panel.logy then
    if options.equal then fail "option 'equal' and a logarithmic axis exclude each other" end
    return false
  end
  if options.equal ~= nil then return options.equal and true or false end
  local place = shared(list, "xplace")
  if not (place and place == shared(list, "yplace") and panel.xunit == panel.yunit) then
    return false
  end
  local x, y = panel.xrange, panel.yrange
  local ratio = (x[2] - x[1]) / (y[2] - y[1])
  if ratio < 4 and ratio > 0.25 then return true end
  panel.notes[#panel.notes + 1] = "axes not equal: one range is 4 times the other or more"
  return false
end

-- options win over what the series say of themselves
local function make_panel(given, options)
  check_options(options)
  local list = {}
  for i, s in ipairs(given) do
    if type(s) ~= "table" then
      fail("series %d must be a table { x =, y = } (got %s)", i, type(s))
    end
    list[i] = make_series(s, options, i)
  end
  if #list == 0 then fail "there is no series to draw" end
  local log = options.log or ""
  local panel = { series = list, notes = {}, logx = log:find("x") ~= nil,
    logy = log:find("y") ~= nil,
    title = options.title or shared(list, "title"),
    xlabel = options.xlabel or shared(list, "xlabel") or "x",
    ylabel = options.ylabel or shared(list, "ylabel") or (#list == 1 and "y" or nil),
    xunit = options.xunit or shared(list, "xunit"), yunit = options.yunit or shared(list, "yunit") }
  count_gaps(list, panel)
  local rising = true
  for _, s in ipairs(list) do rising = rising and s.style == "lines" and series_.rises(s.x) end
  set_range(panel, "x", rising and 0 or 0.04)
  set_range(panel, "y", 0.04)
  panel.slopes, panel.marks = notes.read(options)
  panel.minor, panel.plain = options.minor, options.text == "plain"
  panel.legend = (#list > 1 or list[1].style == "cells") and options.legend ~= false
  panel.equal = decide_equal(panel, list, options)
  for _, name in ipairs { "xrange", "yrange" } do
    local asked = options[name]
    -- floats: whole numbers wrap
    if asked then panel[name] = { asked[1] * 1.0, asked[2] * 1.0 } end
  end
  return panel
end

---- showing ----

-- pixels of one panel when none are asked for: equal axes get the shape of the data
local function default_pixels(panel)
  if not panel.equal then return 800, 480 end
  local x, y = panel.xrange, panel.yrange
  local w = 110 + 470 * (x[2] - x[1]) / (y[2] - y[1])
  return math.floor(math.max(380, math.min(1100, w))), 560
end

-- panels of a column, or of a row, that share an axis: one range, and texts on the last one alone
local function share_axis(figure, name)
  local panels, columns = figure.panels, figure.columns
  local range = { math.huge, -math.huge }
  for _, panel in ipairs(panels) do
    local own = panel[name .. "range"]
    range = { math.min(range[1], own[1]), math.max(range[2], own[2]) }
    if panel["log" .. name] ~= panels[1]["log" .. name] then
      fail("share = %q: all axes must be logarithmic, or none", name)
    end
  end
  for i, panel in ipairs(panels) do
    panel[name .. "range"] = range
    local last = i + columns > #panels
    if name == "y" then last = (i - 1) % columns == 0 end
    panel["hide" .. name] = not last
  end
end

local function to_file(panels, options)
  local columns = math.min(options.columns or math.min(2, #panels), #panels)
  local figure = { panels = panels, title = options.title, columns = columns,
    plain = options.text == "plain", rows = math.ceil(#panels / columns) }
  for name in (options.share or ""):gmatch "." do share_axis(figure, name) end
  for i, panel in ipairs(panels) do
    if options.letters and #panels > 1 then
      panel.letter = ("(%s)"):format(string.char(97 + (i - 1) % 26))
    end
  end
  local w, h = default_pixels(panels[1])
  if #panels > 1 then w, h = 560 * figure.columns, 430 * figure.rows end
  figure.look = look.of(options, w, h)
  figure.linewidth = options.linewidth and options.linewidth * 96 / 72
  require "dm.show.gnuplot".write(figure, options.file)
  return options.file
end

local function terminal()
  local known = core.terminal and core.terminal() or {}
  return { colour = known.colour, width = math.min(known.width or 80, 100) }
end

local function to_terminal(panels, options)
  local here = terminal()
  local w, h = look.pixels(options)
  local signs = require "dm.show.characters".here(options.ascii)
  local text = signs.text
  if options.title and #panels > 1 then io.write(text(options.title), "\n") end
  local room = { colour = here.colour, width = math.max(20, math.min(w or here.width, 400)),
    height = math.max(8, math.min(h or 24, 200)), signs = signs }
  for _, panel in ipairs(panels) do
    io.write(table.concat(require "dm.show.braille".lines(panel, room), "\n"), "\n")
  end
end

-- a picture of many points is smaller as pixels
local MOST_SVG = 5000

-- into the page of a notebook
local function to_page(panels, options)
  local points = 0
  for _, panel in ipairs(panels) do
    for _, series in ipairs(panel.series) do points = points + #series.x end
  end
  inline.file(points > MOST_SVG and "png" or "svg", function(name)
    local here = setmetatable({ file = name }, { __index = options })
    to_file(panels, here)
  end)
end

local function show(panels, options)
  if options.file then return to_file(panels, options) end
  if inline.show then return to_page(panels, options) end
  return to_terminal(panels, options)
end

local doc_plot = "dm.plot(x, y, {file=, title=, xlabel=, ylabel=, xunit=, yunit=, log=, style=, "
  .. "names=, legend=, equal=, xrange=, yrange=, width=, height=, size=, dpi=, font=, fontsize=, "
  .. "linewidth=, slopes=, marks=, minor=, text=, ascii=}) -> file name or nothing\n" .. [[
Plot y against x: two vectors or tables of numbers of one length; x and a list of columns y; or a
list of series { x =, y =, name =, style =, colour = } (then the options come second; a colour is
"#rrggbb" or a name). Without `file` in the terminal, in ASCII where the locale is not UTF-8; with
it through gnuplot to a .png, .svg or .pdf. log: "x", "y" or "xy"; style: "lines", "points" or
"linespoints"; names: texts of the legend (legend = false: none); equal: one length per unit on both
axes; xrange, yrange: {least, largest}; width, height (or size = {width, height}): pixels in a file,
characters in a terminal. For print: size = {8.5, 6, "cm"} ("mm", "in"), dpi (300 then), font,
fontsize and linewidth in points. slopes = {2, 4}: triangles of these powers (log = "xy"); marks =
{ {x, y, "text"} }: points with a text; minor = true: minor ticks. Texts of files know q_1, p_theta,
10^{-3} and Greek names; text = "plain": as they stand. ascii = true: no other signs in the
terminal. Points that are not finite, or not positive on a logarithmic axis, leave
gaps and are counted below the plot. Long columns are thinned to what the picture can show, extremes
kept.]]

M.plot = blame.caller(function(a, b, c)
  local list, options = sort_arguments(a, b, c)
  return show({ make_panel(list, options) }, options)
end)

local doc_figure = [[
dm.figure{panel, panel, ..., file=, title=, columns=, share=, letters=, width=, height=, size=,
  dpi=, font=, fontsize=, linewidth=, text=, ascii=} -> file or nothing
Several plots in one picture. Each panel is a list of series { x =, y =, name = } (path:series makes
them), or x, y, with the options of dm.plot: { orbit:series("q1", "q2"), equal = true, title =
"orbit" }. Panels stand in `columns`, their edges in line; share = "x", "y" or "xy": one range for
all, with texts on the last panels alone; letters = true: (a), (b), ...]]

-- of the whole picture, not of one panel
local OF_FIGURE = { "file", "ascii", table.unpack(look.KNOWN) }

local FIGURE_KNOWN = { "file", "title", "columns", "share", "letters", "text", "ascii",
  entries = true }
table.move(look.KNOWN, 1, #look.KNOWN, #FIGURE_KNOWN + 1, FIGURE_KNOWN)

-- a panel as it was given, with what the figure says of texts
local function with_text(panel, text)
  local out = {}
  for key, value in pairs(panel) do out[key] = value end
  out.text = text
  return out
end

M.figure = blame.caller(function(given)
  option.check(given, FIGURE_KNOWN, "dm.figure", "of panels")
  check_text(given, { "file", "title" })
  option.whole(given, "columns", WHERE, 1, 100)
  option.one_of(given, "share", WHERE, { "x", "y", "xy" })
  check_look(given)
  local panels = {}
  for i, panel in ipairs(given) do
    if type(panel) ~= "table" then
      fail("panel %d must be a list of series (got %s)", i, type(panel))
    end
    for _, key in ipairs(OF_FIGURE) do
      if panel[key] ~= nil then
        fail("panel %d: '%s' belongs to the figure, behind its panels", i, key)
      end
    end
    if panel.x ~= nil and panel.y ~= nil then panel = { panel } end -- a series alone
    if given.text and panel.text == nil then panel = with_text(panel, given.text) end
    panels[i] = make_panel(is_column(panel[1]) and { panel } or panel, panel)
  end
  if #panels == 0 then fail "a figure needs at least one panel: a list of series" end
  if #panels == 1 and given.title then  -- there is no other place for it
    panels[1].title = panels[1].title and given.title .. ": " .. panels[1].title or given.title
  end
  return show(panels, given)
end)

core.docs[M.plot], core.docs[M.figure] = doc_plot, doc_figure

return M
