-- Plots: axes tell the truth, braille dots lie where the data are, thinning keeps what is seen, files
-- are what their names say, and misuse is named.
local tap = require "tap"
local dm = require "dm"
local axis, series, braille, gnuplot = require "dm.show.axis", require "dm.show.series", require "dm.show.braille", require "dm.show.gnuplot"
local ok, near, raises = tap.ok, tap.near, tap.raises
local pi, abs, max, min = math.pi, math.abs, math.max, math.min

---- axes ----

-- the number that a tick's text, the power and the offset of the axis stand for
local function meant(a, tick) return a.offset + tonumber(tick.text) * 10.0 ^ a.power end

local ranges = { { 0, 1 }, { -0.5 - 1e-9, -0.5 + 3e-9 }, { 0.8, 0.8 }, { 0, 0 }, { 0.8 - 2e-16, 0.8 + 1e-16 }, { 0, 2e5 },
  { -7e12, 1.3e13 }, { 1e-12, 5e-12 }, { -3, 17 }, { 1e5, 1e5 + 2 }, { -1e299, 1e299 }, { 5e-324, 1e-310 }, { 0.0999,
    0.1001 }, { 123456, 123457.5 } }
local honest, counted, inside = true, true, true
for _, r in ipairs(ranges) do
  for _, most in ipairs { 3, 6, 11 } do
    local a = axis.new(r[1], r[2], most)
    local width, last = a.hi - a.lo, -1
    counted = counted and #a.ticks >= 2 and #a.ticks <= most + 1
    inside = inside and a.lo <= r[1] and a.hi >= r[2]
    for _, tick in ipairs(a.ticks) do
      local at = a.lo + tick.fraction * width
      honest = honest and abs(meant(a, tick) - at) <= 1e-6 * width + 2.3e-16 * abs(at) and tick.fraction > last
      last = tick.fraction
    end
  end
end
ok(honest, "every tick stands where its text says, offset and power included")
ok(counted, "an axis has two ticks or more, and no more than asked for")
ok(inside, "an axis holds the range it is made for")
local a = axis.new(-0.5 - 1e-9, -0.5 + 3e-9, 6)
ok(axis.caption(a, "energy", "J") == "energy + 0.5 (10⁻⁹ J)", "the caption names offset, power and unit", axis.caption(a,
  "energy", "J"))
ok(axis.caption(axis.new(0, 1, 5), "t") == "t", "and nothing when there is nothing to name")
a = axis.new(1e-18, 1e5, 6, true)
near(axis.fraction(a, 10 ^ -6.5), 0.5, 1e-12, "the middle of a logarithmic axis is the geometric mean")
ok(#a.ticks >= 3 and #a.ticks <= 7 and a.ticks[1].text == "10⁻¹⁶", "ticks of a logarithmic axis are powers of ten",
  a.ticks[1].text)
a = axis.new(2, 7, 6, true)
ok(a.ticks[1].text == "2" and a.ticks[2].text == "5", "within a decade also 2 and 5 times them")

---- thinning ----

local n, x, y = 1000000, {}, {}
for i = 1, n do x[i], y[i] = i, math.sin(i * 1e-3) end
y[314159], y[271828] = 9, -7
local full = { x = x, y = y, style = "lines" }
local scale = { width = 500, height = 300, fx = function(v) return v / n end, fy = function(v) return (v + 7) / 16 end }
local few = series.thin(full, scale)
local lo, hi = series.range({ few }, "y")
ok(#few.x <= 4 * 501 and hi == 9 and lo == -7 and few.x[#few.x] == n,
  "10^6 points: four a pixel column at most, spikes kept", #few.x)
for i = 1, n do x[i], y[i] = math.cos(i * 0.02), math.sin(i * 0.02) end
local unit = { width = 400, height = 400, fx = function(v) return (v + 1.1) / 2.2 end,
  fy = function(v) return (v + 1.1) / 2.2 end }
few = series.thin(full, unit)
local longest = 0
for i = 2, #few.x do
  if few.x[i] == few.x[i] and few.x[i - 1] == few.x[i - 1] then
    longest = max(longest, abs(few.x[i] - few.x[i - 1]), abs(few.y[i] - few.y[i - 1]))
  end
end
ok(#few.x < 60000 and longest < 0.03, "an orbit drawn 3000 times over: each stroke once, none across", #few.x .. " " .. longest)
full.style = "points"
few = series.thin(full, unit)
ok(#few.x < 4000 and #few.x > 1000, "points: one a pixel", #few.x)

---- braille ----

local WEIGHT = { { 1, 2, 4, 64 }, { 8, 16, 32, 128 } }
-- dots of a drawing as {i, j} from the lower left of the canvas, and its size in cells
local function dots(lines)
  local rows, out, w = {}, {}, 0
  for _, line in ipairs(lines) do
    rows[#rows + 1] = line:match "┤(.*)$" or line:match "│(.*)$"
  end
  for r, body in ipairs(rows) do
    local c = 0
    for _, code in utf8.codes(body) do
      for i = 1, 2 do
        for j = 1, 4 do
          if code > 0x2800 and code < 0x2900 and (code - 0x2800) & WEIGHT[i][j] ~= 0 then
            out[#out + 1] = { 2 * c + i - 1, 4 * (#rows - r) + 4 - j }
          end
        end
      end
      c = c + 1
      w = max(w, c)
    end
  end
  return out, w, #rows
end

-- what dm.plot writes: its lines and the whole
local function drawn(...)
  local kept, file = io.output(), assert(io.tmpfile())
  io.output(file)
  local fine, message = pcall(dm.plot, ...)
  io.output(kept)
  if not fine then error(message, 0) end
  file:seek "set"
  local text, lines = file:read "a", {}
  file:close()
  for line in text:gmatch "([^\n]*)\n" do lines[#lines + 1] = line end
  return lines, text
end
-- the whole alone
local function shown(...) return select(2, drawn(...)) end

local cx, cy = {}, {}
for i = 0, 720 do cx[i + 1], cy[i + 1] = 5 + 2 * math.cos(i * pi / 360), -1 + 2 * math.sin(i * pi / 360) end
local lines, text = drawn(cx, cy, { equal = true, title = "circle", xlabel = "x", ylabel = "y" })
local d = dots(lines)
local left, right, low, high = 1e9, -1e9, 1e9, -1e9
for _, p in ipairs(d) do left, right, low, high = min(left, p[1]), max(right, p[1]), min(low, p[2]), max(high, p[2]) end
local mx, my, r, off = (left + right) / 2, (low + high) / 2, (right - left) / 2, 0
for _, p in ipairs(d) do off = max(off, abs(math.sqrt((p[1] - mx) ^ 2 + (p[2] - my) ^ 2) - r)) end
ok(#d > 100 and abs((right - left) - (high - low)) <= 1 and off < 1.6, "equal axes: a circle is round to a dot or so", off)
ok(text:find "circle" and text:find "\n +x\n", "title and label are there")
lines = drawn({ 0, 1 }, { 0, 1 }, { width = 60, height = 20 })
local _, h
d, _, h = dots(lines)
off = 0
for _, p in ipairs(d) do off = max(off, abs(p[1] / (2 * 48 - 1) - (1.08 * p[2] / (4 * 15 - 1) - 0.04)) * 60) end
ok(#d > 60 and h == 15 and off < 1, "a straight line lies within a dot of where it should, margins of 4 % above and below", off)
local widest = 0
for _, line in ipairs(lines) do widest = max(widest, utf8.len(line)) end
ok(widest <= 60 and #lines <= 20, "the plot keeps to the size asked for", widest .. " x " .. #lines)
ok(not text:find "\27", "no colour when the output is not a terminal")
text = shown({ 1, 2, 3 }, { { 1, 2, 3 }, { 3, 2, 1 } }, { names = { "up", "down" } })
ok(text:find "a up" and text:find "b down", "without colour the legend has letters")
ok(not shown({ 1, 2, 3 }, { { 1, 2, 3 }, { 3, 2, 1 } }, { xlabel = "", ylabel = "", legend = false }):find "%a", "and without a legend there are none")
local panel = { series = { { x = { 1, 2 }, y = { 1, 2 }, name = "one", style = "lines" }, { x = { 1, 2 }, y = { 2, 1 },
  name = "two", style = "lines" } },
  notes = {}, xrange = { 1, 2 }, yrange = { 1, 2 }, xlabel = "x", legend = true }
text = table.concat(braille.lines(panel, { width = 60, height = 20, colour = true }), "\n")
ok(text:find "\27%[34m" and text:find "\27%[31m" and not text:find "a one", "with colour, colours")
text = shown({ 1, 2, 3, 4, 5 }, { 1, 0 / 0, 3, 1 / 0, 5 })
ok(text:find "2 points not shown: not finite", "NaN and infinity leave gaps and are counted")
text = shown({ 1, 2, 3 }, { 1, 0, 100 }, { log = "y" })
ok(text:find "1 point not shown: not positive", "so is what a logarithmic axis cannot show")
text = shown({ 3 }, { 4 })
ok(text:find "•", "a single point shows")
text = shown({ 1, 2, 3 }, { 0.8, 0.8, 0.8 })
ok(text:find("0.75", 1, true) and text:find("0.80", 1, true) and text:find("0.85", 1, true),
  "constant data get an axis around them")
ok(#dots((drawn({ 0, 1, 2 }, { -1e200, 0, 1e200 }, { yrange = { -1, 1 } }))) > 0, "strokes that leave the range are clipped")

---- paths ----

local kepler = dm.system { name = "Kepler", Q = dm.R(2), units = { q = "AU", t = "d", energy = "J" },
  L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local path = kepler:solver { rule = "verlet", h = 0.02 }:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 500 }
local s = path:series("t", "energy", "mine")
ok(s.name == "mine" and s.xunit == "d" and s.yunit == "J" and s.ylabel == "energy" and #s.y == 501,
  "path:series brings labels and units")
ok(path:series("q1", "p1").yunit == nil and path:series("q1", "q2").yunit == "AU",
  "units by kind of column; none given, none shown")
do
  local G = dm.SO(3)
  local body = dm.system { Q = dm.product(G, dm.R(2)), L = function(_, v) return v:dot(v) / 2 end }
  local run = body:solver { rule = "gauss(1)", h = 0.1 }
    :run { q = { G:identity(), { 0, 0 } }, v = { 1, 0, 2, 1, 1 }, steps = 20 }
  local place = function(x) return run:series("t", x).yplace end
  ok(place "q4" == "q" and place "q6" == "q" and not place "p1", "an element has more columns than entries")
  ok(place "R11_1" == "rotation" and place "q1" ~= place "R11_1", "entries of rotations have a place of their own")
  local columns = {}
  local of = require "dm.show.plot"
  local plot = of.plot
  of.plot = function(list) for i, one in ipairs(list) do columns[i] = one.name end end
  run:plot()
  ok(table.concat(columns, " ") == "q1 q2 q3 q4 q5 q6", "every q against t, of a group, too", table.concat(columns, " "))
  local watched = body:solver { rule = "gauss(1)", h = 0.1 }:run { q = { G:identity(), { 0, 0 } }, v = { 1, 0, 2, 1, 1 },
    steps = 3, watch = { "q5", "energy", rate = function(_, v) return v[1] end } }
  columns = {}
  watched:plot()
  ok(table.concat(columns, " ") == "q5 energy rate", "all that was watched", table.concat(columns, " "))
  of.plot = plot
end
local base = os.tmpname()
local function slurp(file)
  local f = io.open(file, "rb")
  if not f then return nil end
  local bytes = f:read "a"
  f:close()
  return bytes
end
local png = base .. " it's $HOME `id`.png"
ok(path:plot("q1", "q2", { file = png, size = { 420, 300 } }) == png, "path:plot returns the name of the file")
local bytes = slurp(png)
ok(bytes and bytes:sub(1, 8) == "\137PNG\r\n\26\n", "a PNG, by a name with quotes and blanks")
local pw, ph = (">I4I4"):unpack(bytes, 17)
ok(pw == 420 and ph == 300, "of the size asked for", pw .. " x " .. ph)
path:plot { file = base .. ".svg", title = "it's a 'title' \\ with `id` @x <&> %d" }
local svg = slurp(base .. ".svg")
ok(svg and svg:find "<svg" and svg:find("it's a 'title' \\ with `id` @x &lt;&amp;> %d", 1, true),
  "an SVG, the title as it was given")
ok(svg:find "q1" and svg:find "q2" and svg:find "t %(d%)" and svg:find "%(AU%)",
  "every q against t when nothing is said, with units")
path:plot("energy", { file = base .. ".pdf" })
ok((slurp(base .. ".pdf") or ""):sub(1, 5) == "%PDF-", "a PDF")
dm.figure { { path:series("q1", "q2"), equal = true }, { path:series("t", "energy"), log = nil }, { { 1, 2 }, { 3, 4 } },
  file = base .. ".png", columns = 3 }
ok((slurp(base .. ".png") or ""):sub(2, 4) == "PNG", "several panels in one picture")
dm.plot({ 1, 2, 3 }, { 0.8, 0.8 + 1e-16, 0.8 }, { file = base .. ".png" })
ok((slurp(base .. ".png") or ""):sub(2, 4) == "PNG", "a column that wanders by round-off can be drawn")
local script = gnuplot.script({ panels = {}, columns = 1, rows = 1, look = require "dm.show.look".of({}, 99, 99) }, "|rm -rf x.png")
ok(script:find('set output "./|rm -rf x.png"', 1, true) ~= nil, "a name is never a command")

---- maps of colours ----

do
  local axes = require "dm.show.raster".axes
  local function margins(t, u)
    local text = axes({}, 800, 600, { x = { 0, 1, "x" }, y = { 0, t, "t" }, cb = { -u, u, "u" } })
    return tonumber(text:match "lmargin at screen (%S+)"), tonumber(text:match "rmargin at screen (%S+)"), text
  end
  local l, r, text = margins(10, 1)
  local wide, narrow = margins(0.002, 0.002)
  ok(wide > l and narrow < r, "margins as the ticks need them", wide .. " " .. narrow)
  ok(text:find 'set ytics %("0" 0, "2" 2' and text:find 'cblabel "u"', "ticks of axes, names", text)
  ok(text:find('set ylabel "t" norotate offset -', 1, true), "a name stands apart from its ticks", text)
  ok(select(3, margins(2e-5, 1)):find 'set ylabel "t %(10' ~= nil, "tiny times have a power beside their name")
end

---- text of a user is text: no command of a shell or of gnuplot, no element of a page ----

local u = { 1, 2, 3 }
local mark = base .. ".run"
local commands = { "'; system 'touch " .. mark .. "'; '", "`touch " .. mark .. "`", "$(touch " .. mark .. ")",
  "red'\nsystem 'touch " .. mark, "x\\' ; ! touch " .. mark, "<script>alert(1)</script>&\"", "@x %s \xff\xfe", "a^2_b{c}" }
for i, text in ipairs(commands) do
  dm.plot({ { x = u, y = u, name = text, xlabel = text, xunit = text }, { x = u, y = u, name = text } },
    { file = base .. ".svg", title = text, ylabel = text, yunit = text, names = { text, text } })
  local svg = slurp(base .. ".svg")
  ok(svg and utf8.len(svg) and not svg:find "<script", ("text %d of a figure stays text"):format(i))
  dm.figure { { { x = u, y = u, title = text } }, { u, u, title = text }, title = text, file = base .. ".svg" }
  raises("colour", dm.plot, { { x = u, y = u, colour = text } }, { file = base .. ".svg" })
  raises("colour", dm.plot, { { x = u, y = u, colour = text } })
end
ok(not slurp(mark), "and nothing of it was run")
for _, colour in ipairs { "#12345", "#1234567", "#gggggg", "", " red", "red ", 7, {} } do
  raises("must be the name of a colour or \"#rrggbb\"", dm.plot, { { x = u, y = u, colour = colour } })
end
dm.plot({ { x = u, y = u, colour = "dark-blue" }, { x = u, y = u, colour = "#0bF3a9" } }, { file = base .. ".svg" })
ok((slurp(base .. ".svg") or ""):lower():find "0bf3a9" or (slurp(base .. ".svg") or ""):find "11, 243, 169",
  "names and #rrggbb are colours")
raises("'xlabel' must be a string", dm.plot, { { x = u, y = u, xlabel = {} } })
local odd = base .. "'^2 `x` $(y).svg"
dm.plot(u, u, { file = odd })
ok(slurp(odd), "a file may be called anything")
os.remove(odd)

---- misuse ----

raises("needs two columns", dm.plot)
raises("no point is finite and positive on the logarithmic axis", dm.plot, { 1, 2 }, { -1, -2 }, { log = "y" })
raises("no point is finite and positive on the logarithmic axis", dm.plot, { -1, -2 }, { 1, 2 }, { log = "xy" })
do -- a series is a panel of one
  local one, two = base .. "_one.svg", base .. "_two.svg"
  dm.figure { { { x = { 1, 2 }, y = { 3, 5 }, name = "a" } }, file = one }
  dm.figure { { x = { 1, 2 }, y = { 3, 5 }, name = "a" }, file = two }
  ok(slurp(one) == slurp(two) and slurp(one), "a series alone is a panel")
end
raises("needs two columns", dm.plot, 1, 2)
raises("3 numbers x but 2 numbers y", dm.plot, u, { 1, 2 })
raises("is empty", dm.plot, { { x = {}, y = {} } })
raises("unknown option 'titel'", dm.plot, u, u, { titel = "x" })
do -- options in the list of columns were lost
  local free = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
  local path = free:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 1 }, steps = 3 }
  raises("'file' stands in the list of columns", path.plot, path, { "q1", file = "x.png" })
  raises("'title' stands in the list of columns", path.plot, path, "t", { "q1", "p1", title = "x" })
end
raises("'log' must be", dm.plot, u, u, { log = "z" })
raises("'style' must be", dm.plot, u, u, { style = "dots" })
raises("'xrange' must be", dm.plot, u, u, { xrange = { 2, 1 } })
raises("positive on a logarithmic axis", dm.plot, u, u, { log = "x", xrange = { 0, 1 } })
raises("from 4 to 20000", dm.plot, u, u, { width = 1e9 })
raises("nothing to draw", dm.plot, u, { -1, -2, 0 }, { log = "y" })
raises("nothing to draw", dm.plot, u, { 0 / 0, 0 / 0, 0 / 0 })
raises("y[2] must be a number", dm.plot, u, { 1, "x", 3 })
raises("takes a table of options", dm.plot, u, u, 7)
raises("equal", dm.plot, u, u, { log = "y", equal = true })
raises(".png, .svg or .pdf", dm.plot, u, u, { file = "picture.jpeg" })
raises("does the folder exist", dm.plot, u, u, { file = "/no/such/folder/a.png" })
raises("panel 1: 'file' belongs to the figure", dm.figure, { { u, u, file = "a.png" } })
do
  local function script(figure) return require "dm.show.gnuplot".script(figure, "a.png") end
  local gnuplot, kept = require "dm.show.gnuplot", nil
  local write = gnuplot.write
  gnuplot.write = function(figure) kept = script(figure) end
  dm.figure { { u, u, xunit = "m^2/s^-2" }, title = "one panel", file = "a.png" }
  ok(kept:find('set title "one panel"', 1, true), "the title of a figure of one panel", kept)
  ok(kept:find("(m²/s⁻²)", 1, true), "powers in units are raised", kept)
  dm.figure { { u, u, title = "right" }, title = "left", file = "a.png" }
  ok(kept:find('set title "left: right"', 1, true), "both titles")
  dm.figure { { u, u }, { u, u }, file = "a.png" }
  ok(kept:find("set multiplot layout 1,2\n", 1, true), "no room for a title that is not there")
  dm.figure { { { x = u, y = u }, { x = u, y = u } }, file = "a.png" }
  ok(kept:find('set ytics ("1.0" 1', 1, true), "several series without a common name have numbers on their axis", kept)
  dm.figure { { u, u, ylabel = "" }, file = "a.png" }
  ok(kept:find('set ytics ("1.0" 1', 1, true), "nor has one without a name lost them", kept)
  dm.figure { { u, u, ylabel = " " }, file = "a.png" }
  ok(kept:find("unset ytics", 1, true), "an axis whose name is blank has none", kept)
  gnuplot.write = write
end
raises("at least one panel", dm.figure, {})
raises("a table of panels", dm.figure, 3)
raises("'columns' must be", dm.figure, { { u, u }, columns = 0 })
raises("no column 'q9'", path.plot, path, "q9")
raises("has 3 numbers, but the path has 501 rows", path.plot, path, "t", u)
raises("x must be one column", path.plot, path, { "q1", "q2" }, { "p1", "p2" })

local _, where = pcall(function() path:plot("t", "q9") end)
ok(where:find "^[^\n]*test_plot.lua:%d+: no column 'q9'", "an error names the line of the script that called", where)
_, where = pcall(function() return dm.load(base .. ".none") end)
ok(where:find "cannot open" and not where:find "lua/dm/", "and no line inside the modules", where)

local dmlua = os.getenv "DMLUA" or arg[-1]

-- ASCII where the locale is not UTF-8, whichever of the variables says so
local function in_locale(variables, chunk)
  local pipe = io.popen(("D=%q; unset LC_ALL LC_CTYPE LANG; %s \"$D\" -e '%s' 2>&1"):format(dmlua, variables, chunk))
  local said = pipe:read "a"
  pipe:close()
  return said
end
local picture = "dm.plot({ 1, 2, 3 }, { 1e-9, 3e-9, 2e-9 }, { title = \"\u{e4} m^2\", xunit = \"\u{b5}m\", width = 60 }) "
  .. "dm.plot({ { x = { 1, 2 }, y = { 1e-7, 1e9 }, name = \"a\u{b2}\" }, { x = { 1, 2 }, y = { 1, 2 } } }, "
  .. "{ log = \"y\", style = \"points\" }) "
  .. "dm.stability { system = function(k) return dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - k*q[1]^2/2 end } end, "
  .. "q = {1}, v = {0}, rule = \"verlet\", steps = 50, h = {0.5, 3, 4, \"linear\"}, k = {1, 2, 2, \"linear\"} }:plot()"
for _, variables in ipairs { "", "LC_ALL=C", "LANG=de_DE.ISO-8859-1", "LC_ALL=POSIX LANG=C.UTF-8", "LC_CTYPE=C LANG=C.UTF-8" } do
  local said = in_locale(variables, picture)
  ok(#said > 500 and not said:find "[\128-\255]", "a picture in ASCII: " .. variables, said)
  ok(said:find("(10^-9)", 1, true) and said:find "m%^2" and said:find "[.':]" and said:find "|" and said:find "%+%-",
    "with its axes, powers and points", said)
end
for _, variables in ipairs { "LC_ALL=C.UTF-8", "LANG=en_US.utf8", "LC_ALL= LC_CTYPE=en_GB.UTF-8 LANG=C" } do
  ok(in_locale(variables, picture):find "[\u{2801}-\u{28ff}]", "and in braille: " .. variables)
end
-- each row of the picture is as wide in ASCII
local wide, plain = in_locale("LANG=C.UTF-8", picture), in_locale("LANG=C", picture)
local bars = {}
for _, text in ipairs { wide, plain } do
  for line in text:gmatch "[^\n]+" do
    local at = line:match "^[^|\u{2502}]-()\u{2502}" or line:match "^[^|]-()|"
    if at then bars[#bars + 1] = utf8.len(line:sub(1, at - 1)) end
  end
end
ok(#bars > 40 and bars[1] == bars[#bars // 2 + 1], "axes stand in one column", #bars)

-- 36 curves of a style, each drawn in a way of its own
for _, style in ipairs { "lines", "points", "linespoints" } do
  local many, kept = {}, nil
  for k = 1, 36 do many[k] = { x = { 0, 1 }, y = { k, k + 1 }, name = "curve " .. k, style = style } end
  local write = gnuplot.write
  gnuplot.write = function(figure) kept = gnuplot.script(figure, "a.png") end
  dm.plot(many, { file = "a.png" })
  gnuplot.write = write
  local seen, count = {}, 0
  for way in kept:gmatch "using 1:2 with ([^\n]-) title" do
    if not seen[way] then seen[way], count = true, count + 1 end
  end
  ok(count == 36, style .. ": 36 curves are drawn in 36 ways", count)
end

-- without gnuplot: a clear message, nothing left behind
local chunk = "print(pcall(dm.plot, {1,2}, {1,2}, {file=\"" .. base .. ".none.png\"}))"
local pipe = io.popen(("D=%q; PATH=/nonexistent \"$D\" -e '%s' 2>&1"):format(dmlua, chunk))
local said = pipe:read "a"
pipe:close()
ok(said:find "false" and said:find "gnuplot is not installed" and said:find "apt install",
  "without gnuplot: what to install", said)
ok(not slurp(base .. ".none.png") and not slurp(base .. ".none.png.part.png"), "and no half-made file")
for _, name in ipairs { base, png, base .. ".svg", base .. ".pdf", base .. ".png" } do os.remove(name) end
tap.done()
