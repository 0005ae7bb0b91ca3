--- Pictures in files: writes a gnuplot script with the data in it, and has gnuplot draw it.
local axis = require "dm.show.axis"
local core = require "dm.core"
local series_ = require "dm.show.series"

local M = {}

-- colours that colour-blind readers can tell apart (P. Tol, "bright")
local COLOURS = { "#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377" }
local FONT = "DejaVu Sans"

local TERMINALS = {
  png = function(w, h)
    return ("pngcairo noenhanced size %d,%d font '%s,11' background rgb 'white'"):format(w, h, FONT)
  end,
  svg = function(w, h)
    return ("svg noenhanced size %d,%d dynamic font '%s,13' background rgb 'white'")
      :format(w, h, FONT)
  end,
  pdf = function(w, h)  -- inches
    return ("pdfcairo noenhanced size %.3f,%.3f font '%s,10'"):format(w / 100, h / 100, FONT)
  end,
}

-- A string as gnuplot reads it back. Between double quotes it reads these, backslashes and commands
-- in backquotes, so they are given by number; single quotes are no way, as it takes two of them at
-- the begin of a string for an empty one.
local function quote(text)
  local function octal(c) return ("\\%03o"):format(c:byte()) end
  return '"' .. text:gsub('[%c"\\`]', octal) .. '"'
end

-- of what is shown: bytes that are no UTF-8 would make an SVG unreadable
local function caption(text)
  text = tostring(text)
  if not utf8.len(text) then text = text:gsub("[\128-\255]", "?") end
  return quote(axis.raised((text:gsub("%c", " "))))
end

-- gnuplot reads a leading | as a command, ~ as a home folder
local function output_name(file)
  if file:find("^[|~%-]") then return "./" .. file end
  return file
end

local function shell_quote(text)
  return "'" .. text:gsub("'", "'\\''") .. "'"
end

---- one panel ----

-- what is drawn: the shown number, (value - offset) / 10^power
local function scaled(a)
  if a.log then return function(v) return v end end
  local unit = 10.0 ^ a.power
  return function(v) return (v - a.offset) / unit end
end

local function set_axis(add, name, a, text, notes)
  local shown, ticks = scaled(a), {}
  for i, tick in ipairs(a.bare and {} or a.ticks) do
    ticks[i] = ("%s %.17g"):format(caption(tick.text), tick.shown)
  end
  local below = ""
  for _, note in ipairs(notes) do below = below .. '."\\n".' .. caption(note) end
  add(("set %srange [%.17g:%.17g]"):format(name, shown(a.lo), shown(a.hi)))
  add((a.log and "set logscale %s" or "unset logscale %s"):format(name))
  add(#ticks > 0 and ("set %stics (%s)"):format(name, table.concat(ticks, ", ")) or ("unset %stics")
    :format(name))
  add(("set %slabel %s%s"):format(name, caption(text), below))
end

local function add_data(add, block, series, panel)
  local fx, fy = scaled(panel.x), scaled(panel.y)
  add(block .. " << EOD")
  for i = 1, #series.x do
    if series.x[i] == series.x[i] and series.style == "cells" then
      add(("%.10g %.10g %.10g %.10g %.10g %.10g")
        :format(fx(series.x[i]), fy(series.y[i]), fx(series.xlow[i]), fx(series.xhigh[i]),
        fy(series.ylow[i]), fy(series.yhigh[i])))
    elseif series.x[i] == series.x[i] then
      add(("%.10g %.10g"):format(fx(series.x[i]), fy(series.y[i])))
    else
      add ""  -- a blank line lifts the pen
    end
  end
  add "EOD"
end

-- points with gaps on both sides, which a line would not show
local function isolated(series)
  local x, y, out = series.x, series.y, { x = {}, y = {} }
  local function gap(i) return x[i] ~= x[i] or x[i] == nil end
  for i = 1, #x do
    if not gap(i) and gap(i - 1) and gap(i + 1) then
      out.x[#out.x + 1], out.y[#out.y + 1] = x[i], y[i]
    end
  end
  return out
end

local function size_of_points(n)
  return n > 2000 and 0.2 or n > 200 and 0.35 or n > 80 and 0.45 or 0.7
end

-- the colours are used again after the last: then dashed, with open points; and a third time with
-- squares
local function draw_style(series, colour, round)
  local paint = "lc rgb " .. quote(colour)
  if round > 0 and series.style ~= "points" then paint = paint .. " dt 2" end
  local dots = ("pt %d ps %.2f "):format(round == 0 and 7 or round == 1 and 6 or 4,
    size_of_points(#series.x) * (round > 0 and 1.4 or 1))
  if series.style == "cells" then
    local fill = series.pattern and "pattern " .. series.pattern or "solid 1"
    return ("boxxyerror fs %s %s lw 0.6"):format(fill, paint)
  end
  if series.style == "points" then return "points " .. dots .. paint end
  local width = #series.x > 4000 and not series_.rises(series.x) and 0.7 or 1.3
  return ("%s lw %g %s%s"):format(series.style, width, series.style == "lines" and "" or dots,
    paint)
end

local function add_series(add, panel, number, prefix)
  local plots = {}
  local scale = { width = 2 * panel.width, height = 2 * panel.height,
    fx = function(x) return axis.fraction(panel.x, x) end,
    fy = function(y) return axis.fraction(panel.y, y) end }
  for i, full in ipairs(panel.series) do
    local series, block = series_.thin(full, scale), ("$%s_%d_%d"):format(prefix, number, i)
    local colour = series.colour or COLOURS[(i - 1) % #COLOURS + 1]
    local title = panel.legend and "title " .. caption(series.name) or "notitle"
    add_data(add, block, series, panel)
    plots[#plots + 1] = ("%s using %s with %s %s")
      :format(block, series.style == "cells" and "1:2:3:4:5:6" or "1:2",
      draw_style(series, colour, series.colour and 0 or (i - 1) // #COLOURS), title)
    local alone = series.style == "lines" and isolated(series) or { x = {} }
    if #alone.x > 0 then
      add_data(add, block .. "_alone", alone, panel)
      plots[#plots + 1] = ("%s_alone using 1:2 with points pt 7 ps %.2f lc rgb %s notitle")
        :format(block, size_of_points(#alone.x), quote(colour))
    end
  end
  return plots
end

local function make_axes(panel)
  local x, y = panel.xrange, panel.yrange
  panel.x = axis.new(x[1], x[2], math.max(2, panel.width // 90), panel.logx)
  panel.y = axis.new(y[1], y[2], math.max(2, panel.height // 55), panel.logy)
  -- an axis whose name is a blank has no numbers, as that of a map without rows; one without a
  -- name, as of several columns, has
  panel.x.bare, panel.y.bare = (panel.xlabel or ""):find "^%s+$", (panel.ylabel or ""):find "^%s+$"
end

-- how many rows the legend needs above the panel; gnuplot counts 9 pixels a letter (pngcairo, 11
-- points)
local function legend_rows(add, panel)
  if not panel.legend then return 0 end
  local widest = 0
  for _, s in ipairs(panel.series) do widest = math.max(widest, utf8.len(s.name) or #s.name) end
  local columns = math.max(1, math.min(#panel.series, (panel.width - 85) // (9 * widest + 45)))
  add("set key maxcols " .. columns)
  return math.ceil(#panel.series / columns)
end

local function add_panel(add, panel, number)
  make_axes(panel)
  local x, y = panel.x, panel.y
  local rows = legend_rows(add, panel)
  add(("set title %s offset 0,%g"):format(caption(panel.title or ""), 1.1 * rows))
  add(("set tmargin %g"):format(1 + 1.4 * rows + (panel.title and 2 or 0)))
  set_axis(add, "x", x, axis.caption(x, panel.xlabel, panel.xunit), panel.notes)
  set_axis(add, "y", y, axis.caption(y, panel.ylabel, panel.yunit), {})
  add(panel.equal and ("set size ratio %.9g"):format((y.hi - y.lo) / (x.hi - x.lo))
    or "set size noratio")
  local plots = add_series(add, panel, number, "data")
  add("plot " .. table.concat(plots, ", \\\n     "))
end

---- the whole ----

local function kind_of(file)
  local kind = file:lower():match("%.(%w+)$")
  if TERMINALS[kind] then return kind end
  error(("file %q: a picture is .png, .svg or .pdf"):format(file), 0)
end

local function add_look(add, figure)
  add "set encoding utf8"
  add "set border 3 lc rgb '#808080'"
  add "set tics out nomirror textcolor rgb '#303030'"
  add "set grid lt 1 lc rgb '#e4e4e4' lw 0.7"
  add "set title font ',12' textcolor rgb '#101010'"
  add("set key at graph 0.5,1.01 center bottom horizontal Left reverse samplen 2 textcolor rgb "
    .. "'#303030'")
  if #figure.panels > 1 then
    local title = figure.title and (" title %s font ',14'"):format(caption(figure.title)) or ""
    add(("set multiplot layout %d,%d%s"):format(figure.rows, figure.columns, title))
  end
end

--- The gnuplot script for a figure, data included.
-- @param figure { panels, rows, columns, width, height (pixels), title }
-- @param file the name to draw to; its ending chooses the format
function M.script(figure, file)
  local lines = {}
  local function add(line) lines[#lines + 1] = line end
  add("set terminal " .. TERMINALS[kind_of(file)](figure.width, figure.height))
  add("set output " .. quote(output_name(file)))
  add_look(add, figure)
  for i, panel in ipairs(figure.panels) do
    panel.width, panel.height = figure.width // figure.columns, figure.height // figure.rows
    add_panel(add, panel, i)
  end
  if #figure.panels > 1 then add "unset multiplot" end
  add "unset output"
  return table.concat(lines, "\n") .. "\n"
end

local function have_gnuplot()
  local pipe = io.popen("gnuplot --version 2>/dev/null")
  local answer = pipe:read("a")
  pipe:close()
  return answer:find("^gnuplot") ~= nil
end

-- the script goes by a file: writing to a pipe whose reader has gone would end the process
local function run(script)
  local name = os.tmpname()
  local file = assert(io.open(name, "w"))
  file:write(script)
  file:close()
  local pipe = io.popen("gnuplot " .. shell_quote(name) .. " 2>&1 </dev/null")
  local said = pipe:read("a")
  local fine = pipe:close()
  os.remove(name)
  return fine, said
end

local function complaint(file, said)
  if not have_gnuplot() then
    return ("cannot draw %q: gnuplot is not installed; install it (Debian, Ubuntu: apt install "
      .. "gnuplot-nox), or leave out 'file' for a plot in the terminal"):format(file)
  end
  return ("cannot draw %q: gnuplot says: %s"):format(file, said:gsub("%s+", " "):sub(1, 300))
end

--- The first lines of a script that draws to `file`: width and height in pixels.
function M.head(file, width, height)
  return "set terminal " .. TERMINALS[kind_of(file)](width, height) .. "\nset output "
    .. quote(output_name(file)) .. "\nset encoding utf8\n"
end

--- Text of a user, as gnuplot reads it.
M.caption = caption

--- Have gnuplot draw the script that script_of(name of a new file) is; the file appears whole or
-- not at all.
function M.draw(file, script_of)
  if file:find("%c") then
    error(("file %q: a name without control characters is needed"):format(file), 0)
  end
  kind_of(file)  -- raises before there is a file
  local part, why = core.new_file(file)
  if not part then error(("cannot write %s: does the folder exist?"):format(why), 0) end
  local fine, said = run(script_of(part))
  local made = io.open(part, "rb")
  local size = made and made:seek("end") or 0
  if made then made:close() end
  if not fine or size == 0 then
    os.remove(part)
    error(complaint(file, said), 0)
  end
  assert(core.end_file(part, file))
end

--- Draw a figure to a file.
function M.write(figure, file)
  M.draw(file, function(part) return M.script(figure, part) end)
end

return M
