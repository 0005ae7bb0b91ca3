--- K:plot, a:plot, X:plot: meshes and what lives on them, through gnuplot in a file, or in a
-- terminal (terminal.lua).
local class = require "dm.base.class"
local colours = require "dm.dec.pictures.colours"
local drawing = require "dm.dec.pictures.drawing"
local gnuplot = require "dm.show.gnuplot"
local look = require "dm.show.look"
local option = require "dm.base.options"
local terminal = require "dm.dec.pictures.terminal"

local M = {}

local MOST = 30000 -- faces and edges of a picture
local FINE = 3000  -- faces that still have their edges drawn

local function fail(...) option.fail("plot of a mesh", ...) end

---- from space to the picture ----

-- (x, y, z) -> across, up, towards the eye; azimuth and height in radians, as in animated pages
local function camera(d, options)
  if d.dim == 2 then return function(p) return p[1], p[2], 0 end end
  local azimuth, height = options.azimuth or -0.6, options.height or 0.35
  local c, s, ch, sh = math.cos(azimuth), math.sin(azimuth), math.cos(height), math.sin(height)
  return function(p)
    local deep = c * p[2] + s * p[1]
    return c * p[1] - s * p[2], ch * p[3] + sh * deep, sh * p[3] - ch * deep
  end
end

-- all that is drawn as pieces { depth, kind, coordinates, colour }, the farthest first
local function pieces_of(d, see, scale)
  local out = {}
  local function add(kind, list, colour, nearer)
    local flat, depth = {}, 0
    for _, p in ipairs(list) do
      local x, y, z = see(p)
      flat[#flat + 1], flat[#flat + 2], depth = x, y, depth + z / #list
    end
    out[#out + 1] = { depth + (nearer or 0), kind, flat, colour, #out }
  end
  local function points(cell)
    local list = {}
    for j, v in ipairs(cell) do list[j] = d.points[v] end
    return list
  end
  local function is_seen(cell)
    local corners = {}
    for j, p in ipairs(points(cell)) do corners[j] = { see(p) } end
    return not drawing.is_turned_away(d, table.unpack(corners))
  end
  local around = {} -- pairs of vertices that are edges of what is seen
  for i, cell in ipairs(d.faces) do
    if is_seen(cell) then
      for j, v in ipairs(cell) do
        local w = cell[j % #cell + 1]
        around[math.min(v, w) .. " " .. math.max(v, w)] = true
      end
      add("face", points(cell), d.on == "faces" and colours.at(scale, d.values[i]) or "#eef2f6")
    end
  end
  for i, cell in ipairs((d.on == "edges" or #d.faces == 0) and d.edges or {}) do
    if not d.solid or around[math.min(cell[1], cell[2]) .. " " .. math.max(cell[1], cell[2])] then
      add("edge", points(cell), d.on == "edges" and colours.at(scale, d.values[i]) or "#303030",
        0.6 * d.unit)
    end
  end
  for _, pair in ipairs(d.dual) do add("dual", pair, "#b35806", 0.7 * d.unit) end
  for _, arrow in ipairs(d.arrows) do
    local p, q = arrow[1], {}
    for c = 1, 3 do q[c] = p[c] + arrow[2][c] end
    add("arrow", { p, q }, "#202020", 0.9 * d.unit)
  end
  table.sort(out, function(a, b)
    if a[1] ~= b[1] then return a[1] < b[1] end
    return a[5] < b[5]
  end)
  return out
end

-- least and largest coordinate of all pieces, a little wider
local function box_of(pieces)
  local lo, hi = { math.huge, math.huge }, { -math.huge, -math.huge }
  for _, piece in ipairs(pieces) do
    for i, x in ipairs(piece[3]) do
      local c = (i - 1) % 2 + 1
      lo[c], hi[c] = math.min(lo[c], x), math.max(hi[c], x)
    end
  end
  local margin = 0.03 * math.max(hi[1] - lo[1], hi[2] - lo[2], 1e-300)
  return lo[1] - margin, hi[1] + margin, lo[2] - margin, hi[2] + margin
end

---- gnuplot ----

local function polygon(number, xy, style)
  local corners = {}
  for i = 1, #xy, 2 do corners[#corners + 1] = ("%.7g,%.7g"):format(xy[i], xy[i + 1]) end
  corners[#corners + 1] = corners[1]
  return ("set object %d polygon from %s %s"):format(number, table.concat(corners, " to "), style)
end

-- shaft and head of an arrow, there and back
local function arrow_of(xy)
  local x, y, dx, dy = xy[3], xy[4], xy[3] - xy[1], xy[4] - xy[2]
  local left, right = { x - 0.3 * dx + 0.12 * dy, y - 0.3 * dy - 0.12 * dx },
    { x - 0.3 * dx - 0.12 * dy, y - 0.3 * dy + 0.12 * dx }
  local mx, my = x - 0.3 * dx, y - 0.3 * dy
  return { xy[1], xy[2], mx, my, left[1], left[2], x, y, right[1], right[2], mx, my }
end

-- lines are polygons, too: so gnuplot draws all of them in the order of their numbers, and what is
-- near hides what is far
local function object_of(piece, number, with_edges, linewidth)
  local kind, xy, colour = piece[2], piece[3], piece[4]
  if kind == "face" then
    return polygon(number, xy, ("fillcolor rgb '%s' fillstyle solid %s"):format(colour,
      with_edges and "border lc rgb '#707070'" or "noborder"))
  end
  local width = (linewidth or 1) * (kind == "edge" and 1.8 or 1)
  local style = kind == "arrow" and ("fillcolor rgb '%s' fillstyle solid border"):format(colour)
    or "fillstyle empty border"
  return polygon(number, kind == "arrow" and arrow_of(xy) or xy,
    ("%s lc rgb '%s' lw %g"):format(style, colour, width))
end

local function colour_box(lines, d, scale)
  local stops = {}
  for i, stop in ipairs(scale.stops) do stops[i] = ("%d '%s'"):format(i - 1, stop) end
  lines[#lines + 1] = "set palette defined (" .. table.concat(stops, ", ") .. ")"
  lines[#lines + 1] = ("set cbrange [%.17g:%.17g]"):format(scale.least, scale.largest)
  lines[#lines + 1] = "set cblabel " .. gnuplot.upright(d.label)
end

local function script_of(d, pieces, scale, title, file, options)
  local lines = { gnuplot.head(file, options, 760, 640) }
  local x0, x1, y0, y1 = box_of(pieces)
  lines[#lines + 1] = d.dim == 2
    and "set xlabel 'x'\nset ylabel 'y' norotate\nset tics out nomirror"
    or "unset border\nunset xtics\nunset ytics"
  lines[#lines + 1] = "set size ratio -1\nset title " .. gnuplot.caption(title)
  local with_edges = #d.faces <= FINE and d.on ~= "edges"
  for i, piece in ipairs(pieces) do
    lines[#lines + 1] = object_of(piece, i, with_edges, options.linewidth)
  end
  if scale then colour_box(lines, d, scale) end
  lines[#lines + 1] = ("plot [%.9g:%.9g] [%.9g:%.9g] %s"):format(x0, x1, y0, y1,
    scale and "'+' using (0):(0):(0) with points pt 7 ps 0 palette notitle" or "NaN notitle")
  return table.concat(lines, "\n") .. "\n"
end

---- all ----

local KNOWN = { "file", "title", "dual", "azimuth", "height", "label", "ascii",
  table.unpack(look.SIZED) }

-- what lines are lifted by towards the eye, to stand before the faces they lie on
local function median_length(K)
  local lengths = K:volume(1):totable()
  table.sort(lengths)
  return lengths[(#lengths + 1) // 2]
end

local function title_of(d, options, what)
  if options.title then return options.title end
  local notes = {}
  if d.values then
    local lo, hi = math.huge, -math.huge
    for _, x in ipairs(d.values) do lo, hi = math.min(lo, x), math.max(hi, x) end
    notes[1] = ("%s from %.4g to %.4g"):format(d.name, lo, hi)
  end
  notes[#notes + 1] = d.arrow_note
  return what .. (#notes > 0 and ", " .. table.concat(notes, ", ") or "")
end

local function draw(d, K, options, what, where)
  options = option.check(options or {}, KNOWN, where)
  for _, key in ipairs { "file", "title", "label" } do option.text(options, key, where) end
  for _, key in ipairs { "azimuth", "height" } do
    option.number(options, key, where, "an angle in radians")
  end
  local sized = look.sized(options)
  look.check(sized)
  if options.dual then drawing.add_dual(d, K) end
  d.unit, d.label = median_length(K), options.label or d.name
  local see, title = camera(d, options), title_of(d, options, what)
  if not options.file then return terminal.draw(d, see, title, options) end
  if #d.faces + #d.edges > MOST then
    fail("%d faces and edges are too many for a picture (at most %d); K:animate draws them",
      #d.faces + #d.edges, MOST)
  end
  local scale = d.values and colours.scale(d.values)
  local pieces = pieces_of(d, see, scale)
  gnuplot.draw(options.file, function(part)
    return script_of(d, pieces, scale, title, part, sized)
  end)
  return options.file
end

local OPTIONS = [[
Without a file in the terminal, as lines or, where cells have colours, in shades, with it through
gnuplot to a .png, .svg or .pdf. Surfaces in space are seen from azimuth and height (radians); of
meshes of dimension 3 the boundary is drawn.
dual = true adds the edges of the dual cells of a surface; title, label (of the colours). size, dpi,
font, fontsize, linewidth and ascii as of dm.plot.]]

class.method("dm.mesh", "plot", function(K, options)
  return draw(drawing.mesh(K), K, options, ("mesh of %d vertices"):format(K:count(0)), "mesh:plot")
end, "K:plot{file=, dual=, azimuth=, height=, title=} -> file name or nothing\nDraw a mesh.\n"
  .. OPTIONS)

class.method("dm.form", "plot", function(a, options)
  return draw(drawing.form(a), a.mesh, options, ("%s %d-form"):format(a.side, a.degree),
    "form:plot")
end, [[
a:plot{file=, dual=, azimuth=, height=, title=, label=} -> file name or nothing
Draw a form: of degree 0 by colours, the mean over each cell; of degree 1 edges coloured by value
per length, and arrows of its Whitney interpolant in each cell; of degree 2 by colours, value per
area.
]] .. OPTIONS)

class.method("dm.vector_field", "plot", function(X, options)
  local d = drawing.arrows(drawing.mesh(X.mesh), X)
  return draw(d, X.mesh, options, ("vectors on %d %s"):format(#X, X.on), "field:plot")
end, [[
X:plot{file=, dual=, azimuth=, height=, title=} -> file name or nothing
Draw a field of vectors as arrows, the longest as long as an edge at the median.
]] .. OPTIONS)

return M
