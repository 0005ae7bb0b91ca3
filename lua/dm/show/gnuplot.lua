--- Pictures in files: writes a gnuplot script with the data in it, and has gnuplot draw it.
local axis = require "dm.show.axis"
local blame = require "dm.base.blame"
local boxes = require "dm.show.boxes"
local core = require "dm.core"
local label = require "dm.show.label"
local look_ = require "dm.show.look"
local notes_ = require "dm.show.notes"
local palette = require "dm.show.palette"
local series_ = require "dm.show.series"

local M = {}

local quote, caption, TERMINALS = label.quote, label.caption, look_.TERMINALS

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

-- ticks with their texts, and minor ones without; texts are left out where another panel has them
local function ticks_of(panel, a)
  local out = {}
  if a.bare then return "" end
  for _, tick in ipairs(a.ticks) do
    out[#out + 1] = ("%s %.17g"):format(a.hidden and '""' or caption(tick.text, panel.plain),
      tick.shown)
  end
  for _, x in ipairs(panel.minor and axis.minor(a) or {}) do
    out[#out + 1] = ('"" %.17g 1'):format(x)
  end
  return table.concat(out, ", ")
end

local function set_axis(add, panel, name, text, notes)
  local a = panel[name]
  local shown, ticks, below = scaled(a), ticks_of(panel, a), ""
  for _, note in ipairs(notes) do below = below .. '."\\n".' .. caption(note, true) end
  add(("set %srange [%.17g:%.17g]"):format(name, shown(a.lo), shown(a.hi)))
  add((a.log and "set logscale %s" or "unset logscale %s"):format(name))
  add(ticks ~= "" and ("set %stics (%s)"):format(name, ticks) or ("unset %stics"):format(name))
  add(("set %slabel %s%s"):format(name, caption(a.hidden and "" or text, panel.plain), below))
end

-- Half a pixel over the edges of a cell: between neighbours there is no line of the paper.
local OVER = 0.6

local function grown(a, lo, hi, pixels)
  local by = OVER / math.max(pixels, 1)
  if a.log then
    local factor = (a.hi / a.lo) ^ by
    return lo / factor, hi * factor
  end
  return lo - by * (a.hi - a.lo), hi + by * (a.hi - a.lo)
end

local function add_data(add, block, series, panel)
  local fx, fy = scaled(panel.x), scaled(panel.y)
  add(block .. " << EOD")
  for i = 1, #series.x do
    if series.x[i] == series.x[i] and series.style == "cells" then
      local left, right = grown(panel.x, series.xlow[i], series.xhigh[i], panel.width)
      local low, high = grown(panel.y, series.ylow[i], series.yhigh[i], panel.height)
      add(("%.10g %.10g %.10g %.10g %.10g %.10g")
        :format(fx(series.x[i]), fy(series.y[i]), fx(left), fx(right), fy(low), fy(high)))
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

-- The colours are used again after the last, each time with other dashes and points: full lines and
-- discs, then open circles, squares, triangles up and down, diamonds.
local DASHES = { "", " dt 2", " dt 3", " dt 4", " dt 5", " dt (14,3,2,3,2,3)" }
local POINTS = { 7, 6, 4, 8, 10, 12 }

local function draw_style(series, colour, round, linewidth)
  local paint, again = "lc rgb " .. quote(colour), round % #DASHES + 1
  if series.style ~= "points" then paint = paint .. DASHES[again] end
  local dots = ("pt %d ps %.2f "):format(POINTS[again],
    size_of_points(#series.x) * (round > 0 and 1.4 or 1))
  if series.style == "cells" then
    return "boxxyerror fs solid 1 noborder " .. paint
  end
  if series.style == "points" then return "points " .. dots .. paint end
  local width = linewidth or #series.x > 4000 and not series_.rises(series.x) and 0.7 or 1.3
  return ("%s lw %g %s%s"):format(series.style, width, series.style == "lines" and "" or dots,
    paint)
end

-- white round lines and points that are drawn over cells
local function halo_of(series, block)
  local dots = size_of_points(#series.x)
  return ("%s using 1:2 with %s lc rgb '#ffffff' notitle"):format(block, series.style == "points"
    and ("points pt 7 ps %.2f"):format(dots + 0.35) or "lines lw 3.5")
end

local function add_series(add, panel, number, prefix)
  local plots = {}
  local scale = { width = 2 * panel.width, height = 2 * panel.height,
    fx = function(x) return axis.fraction(panel.x, x) end,
    fy = function(y) return axis.fraction(panel.y, y) end }
  for i, full in ipairs(panel.series) do
    local series, block = series_.thin(full, scale), ("$%s_%d_%d"):format(prefix, number, i)
    local colour = series.colour or palette.LINES[(i - 1) % #palette.LINES + 1]
    local title = panel.legend and "title " .. caption(series.name, panel.plain) or "notitle"
    add_data(add, block, series, panel)
    if series.halo then plots[#plots + 1] = halo_of(series, block) end
    plots[#plots + 1] = ("%s using %s with %s %s")
      :format(block, series.style == "cells" and "1:2:3:4:5:6" or "1:2",
      draw_style(series, colour, series.open and 1 or series.colour and 0 or
        (i - 1) // #palette.LINES,
      panel.linewidth), title)
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
  panel.x.hidden, panel.y.hidden = panel.hidex, panel.hidey
  panel.x.bare, panel.y.bare = (panel.xlabel or ""):find "^%s+$", (panel.ylabel or ""):find "^%s+$"
end

-- how many rows and columns the legend has above the panel; gnuplot counts 9 pixels a letter
-- (pngcairo, 11 points)
local function lay_out_legend(panel)
  panel.legend_rows = 0
  if not panel.legend then return end
  local widest = 0
  for _, s in ipairs(panel.series) do widest = math.max(widest, utf8.len(s.name) or #s.name) end
  local room = panel.box and (panel.box[2] - panel.box[1]) * panel.whole or panel.width - 85
  local columns = math.max(1, math.min(#panel.series, room // (9 * widest + 45)))
  panel.legend_columns, panel.legend_rows = columns, math.ceil(#panel.series / columns)
end

-- triangles of slopes: three sides, and the number beside the upright one; added to the plots
local function add_triangles(add, panel, number, plots)
  for k, t in ipairs(#panel.slopes > 0 and notes_.triangles(panel) or {}) do
    local block = ("$slope_%d_%d"):format(number, k)
    add_data(add, block, { x = t.x, y = t.y, style = "lines" }, panel)
    plots[#plots + 1] = block .. " using 1:2 with lines lw 1 lc rgb '#505050' notitle"
    add(("set label %s at %.10g,%.10g left offset 0.3,0 front textcolor rgb '#505050'")
      :format(caption(t.text), t.at[1], t.at[2]))
  end
end

-- marked points with their texts
local function add_marks(add, panel)
  local fx, fy = scaled(panel.x), scaled(panel.y)
  for _, mark in ipairs(panel.marks) do
    local side = notes_.side(panel, mark)
    add(("set label %s at %.10g,%.10g %s offset %s,0.5 front point pt 7 ps 0.6 lc rgb '#303030'")
      :format(caption(mark[3] or "", panel.plain), fx(mark[1]), fy(mark[2]),
      side == "right" and "left" or "right", side == "right" and "0.6" or "-0.6"))
  end
end

-- Rows that stand above a panel: those of the legend, the title.
local function add_head(add, panel)
  local rows = panel.legend_rows
  if rows > 0 then add(("set key maxcols %d"):format(panel.legend_columns)) end
  add(("set title %s offset 0,%g"):format(caption(panel.title or "", panel.plain), 1.1 * rows))
  if not panel.box then
    add(("set tmargin %g"):format(1 + 1.4 * rows + (panel.title and 2 or 0)))
  end
end

-- where the panels of a figure stand, as parts of the picture
local function add_box(add, panel)
  local b = panel.box
  if not b then return end
  add(("set lmargin at screen %.6f"):format(b[1]))
  add(("set rmargin at screen %.6f"):format(b[2]))
  add(("set bmargin at screen %.6f"):format(b[3]))
  add(("set tmargin at screen %.6f"):format(b[4]))
end

local function add_panel(add, panel, number)
  local x, y = panel.x, panel.y
  add "unset label"
  add_head(add, panel)
  add_box(add, panel)
  set_axis(add, panel, "x", axis.caption(x, panel.xlabel, panel.xunit), panel.notes)
  set_axis(add, panel, "y", axis.caption(y, panel.ylabel, panel.yunit), {})
  add(panel.equal and not panel.box
    and ("set size ratio %.9g"):format((y.hi - y.lo) / (x.hi - x.lo)) or "set size noratio")
  if panel.letter then
    add(("set label %s at graph 0,1 right offset -1,0.6 font ',%g'"):format(caption(panel.letter),
      1.1 * panel.points))
  end
  add_marks(add, panel)
  local plots = add_series(add, panel, number, "data")
  add_triangles(add, panel, number, plots)
  add("plot " .. table.concat(plots, ", \\\n     "))
end

---- the whole ----

local function kind_of(file)
  local kind = file:lower():match("%.(%w+)$")
  if TERMINALS[kind] then return kind end
  error(("file %q: a picture is .png, .svg or .pdf"):format(file), 0)
end

local function add_look(add, figure)
  local points = figure.look.points
  add "set encoding utf8"
  add "set border 3 lc rgb '#808080'"
  add "set tics out nomirror textcolor rgb '#303030'"
  add "set grid lt 1 lc rgb '#e4e4e4' lw 0.7"
  add(("set title font ',%g' textcolor rgb '#101010'"):format(points * 12 / 11))
  add("set key at graph 0.5,1.01 center bottom horizontal Left reverse samplen 2 textcolor rgb "
    .. "'#303030'")
  if #figure.panels > 1 then
    local title = figure.title and (" title %s font ',%g'"):format(caption(figure.title,
      figure.plain), points * 14 / 11) or ""
    add(("set multiplot layout %d,%d%s"):format(figure.rows, figure.columns, title))
  end
end

--- The gnuplot script for a figure, data included.
-- @param figure { panels, rows, columns, look (dm.show.look), title }
-- @param file the name to draw to; its ending chooses the format
function M.script(figure, file)
  local lines = {}
  local function add(line) lines[#lines + 1] = line end
  add("set terminal " .. TERMINALS[kind_of(file)](figure.look))
  add("set output " .. quote(output_name(file)))
  add_look(add, figure)
  for _, panel in ipairs(figure.panels) do
    panel.width = figure.look.width // figure.columns
    panel.height = figure.look.height // figure.rows
    panel.whole = figure.look.width
    panel.linewidth, panel.points = figure.linewidth, figure.look.points
    make_axes(panel)
    lay_out_legend(panel)
  end
  if #figure.panels > 1 then
    boxes.place(figure)
    for _, panel in ipairs(figure.panels) do lay_out_legend(panel) end -- equal ones are narrower
    boxes.place(figure)
  end
  for i, panel in ipairs(figure.panels) do add_panel(add, panel, i) end
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
  local fits, why = file:write(script)
  local ended, late = file:close()
  if not fits or not ended then
    os.remove(name)
    error(("cannot write the script of a picture, %s: %s"):format(name, why or late), 0)
  end
  local pipe = io.popen("gnuplot " .. shell_quote(name) .. " 2>&1 </dev/null")
  local said = pipe:read("a")
  local fine = pipe:close()
  os.remove(name)
  return fine, said
end

-- how a picture ends that is whole: gnuplot does not look whether all could be written
local ENDS = { png = "IEND\xAEB`\x82$", svg = "</svg>%s*$", pdf = "%%%%EOF%s*$" }
local TAIL = 64 -- bytes

--- Is the picture in a file whole, up to its end?
function M.is_whole(file, kind)
  local made = io.open(file, "rb")
  if not made then return false end
  made:seek("set", math.max(0, made:seek "end" - TAIL))
  local tail = made:read "a"
  made:close()
  return tail:find(ENDS[kind]) ~= nil
end

--- Why nothing more can be written to a file, or nil.
function M.stopped_by(file)
  local made, why = io.open(file, "ab")
  if not made then return why end
  local fits, full = made:write((" "):rep(2 ^ 16))
  local ended, late = made:close()
  return not (fits and ended) and (full or late) or nil
end

local function complaint(file, part, said)
  local full = M.stopped_by(part)
  if full then return ("cannot write %s: %s"):format(file, full) end
  if not have_gnuplot() then
    return ("cannot draw %q: gnuplot is not installed; install it (Debian, Ubuntu: apt install "
      .. "gnuplot-nox), or leave out 'file' for a plot in the terminal"):format(file)
  end
  said = said:gsub("%s+", " "):sub(1, 300)
  return ("cannot draw %q: gnuplot says: %s"):format(file, said ~= "" and said
    or "nothing, but the picture has no end")
end

--- The first lines of a script that draws to `file`, as large as the options of dm.show.look say;
-- width and height: pixels of one that has no size.
function M.head(file, options, width, height)
  local look = look_.of(options, width, height)
  return "set terminal " .. TERMINALS[kind_of(file)](look) .. "\nset output "
    .. quote(output_name(file)) .. "\nset encoding utf8\n"
end

--- Text of a user, as gnuplot reads it; of a scale that goes up.
M.caption, M.upright = caption, label.upright

--- Have gnuplot draw the script that script_of(name of a new file) is; the file appears whole or
-- not at all.
function M.draw(file, script_of)
  if file:find("%c") then
    error(("file %q: a name without control characters is needed"):format(file), 0)
  end
  local kind = kind_of(file)  -- raises before there is a file
  local part, why = core.new_file(file)
  if not part then error(("cannot write %s: does the folder exist?"):format(why), 0) end
  local drawn, fine, said = blame.try(run, script_of(part))
  if not drawn or not fine or not M.is_whole(part, kind) then
    local why = drawn and complaint(file, part, said) or fine
    os.remove(part)
    error(why, 0)
  end
  assert(core.end_file(part, file))
end

--- Draw a figure to a file.
function M.write(figure, file)
  M.draw(file, function(part) return M.script(figure, part) end)
end

return M
