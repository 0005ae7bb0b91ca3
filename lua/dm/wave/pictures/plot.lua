--- path:plot and path:spacetime of waves.
local class = require "dm.base.class"
local gnuplot = require "dm.show.gnuplot"
local lists = require "dm.base.lists"
local look = require "dm.show.look"
local option = require "dm.base.options"
local plot = require "dm.show.plot"
local raster = require "dm.show.raster"

local M = {}

---- path:plot ----

-- what can be drawn over x, of a state
local OVER_X = {
  density = { "|psi|^2", function(v) return v:abs2() end },
  phase = { "arg psi", function(v) return v:arg() end },
  re = { "Re psi", function(v) return v.re end },
  im = { "Im psi", function(v) return v.im end },
}

-- rows to draw: the first and the last, unless given
local function chosen(path, rows)
  if rows == nil then return #path > 1 and { 1, #path } or { 1 } end
  if type(rows) == "number" then rows = { rows } end
  option.list({ rows = rows }, "rows", "path:plot", "numbers of rows")
  for _, i in ipairs(rows) do
    if math.type(i) ~= "integer" or i < 1 or i > #path then
      option.fail("path:plot", "option 'rows': rows are counted from 1 to %d (got %s)", #path,
        option.got(i))
    end
  end
  return rows
end

-- V at the points of the picture, scaled to a height; nothing where it is constant
local function potential(wave, height)
  local least, most = math.huge, -math.huge
  for j = 1, #wave.V do
    least, most = math.min(least, wave.V[j]), math.max(most, wave.V[j])
  end
  if most == least then return end
  local y = {}
  for j = 1, #wave.V do y[j] = height * (wave.V[j] - least) / (most - least) end
  return { x = wave.nodes, y = y, name = ("V, %.4g to %.4g"):format(least, most),
    colour = "#bbbbbb" }
end

local function over_x(path, what, options)
  local label, of = table.unpack(OVER_X[what])
  local series, height = {}, 0
  for k, i in ipairs(chosen(path, options.rows)) do
    local v = path.psi[i]
    local y = of(v)
    for j = 1, #y do height = math.max(height, y[j]) end
    series[k] = { x = v.x, y = y, name = ("t = %.4g"):format(path.t[i]), xlabel = "x",
      ylabel = label }
  end
  local V = what == "density" and potential(path.wave, height)
  if V then table.insert(series, 1, V) end
  local rest = lists.copy(options)
  rest.rows, rest.ylabel, rest.xlabel = nil, rest.ylabel or label, rest.xlabel or "x"
  rest.title = rest.title or path.title
  return plot.plot(series, rest)
end

-- columns over a column; one alone over t
local function columns(path, x, y, options)
  if y == nil then x, y = "t", x end
  local names, series = type(y) == "table" and y or { y }, {}
  for k, name in ipairs(names) do
    series[k] = { x = path:column(x), y = path:column(name), name = name, xlabel = x,
      ylabel = name, title = path.title }
  end
  return plot.plot(series, options)
end

class.method("dm.wave_path", "plot", function(path, x, y, options)
  if type(x) == "table" and x[1] == nil then x, options = nil, x end
  if type(y) == "table" and y[1] == nil then y, options = nil, y end
  options = options or {}
  if type(options) ~= "table" then
    option.fail("path:plot", "takes a table of options (got %s)", option.got(options))
  end
  if x == nil then x = "density" end
  if OVER_X[x] then return over_x(path, x, options) end
  return columns(path, x, y, options)
end, "path:plot(\"density\" | \"phase\" | \"re\" | \"im\", {rows=, file=, ...}) -> file or nothing"
  .. "   or   path:plot(x, y | {y1, y2, ...}, {file=, ...}) -> file or nothing\n" .. [[
Over x at the rows (first and last, unless given), the density with V behind it, scaled; or columns
("t", "norm", "energy", "x", "momentum", "noether") over one of them. Options as of dm.plot: without
a file in the terminal.]])

---- path:spacetime ----

local MOST = 400           -- points across and up of a picture
local SHADES = " .:-=+*#%@"
local VIRIDIS = "0 '#440154', 1 '#472c7a', 2 '#3b518b', 3 '#2c718e', 4 '#21908d', 5 '#27ad81', "
  .. "6 '#5cc863', 7 '#aadc32', 8 '#fde725'"

local KNOWN = { "of", "file", "title", "ascii", table.unpack(look.KNOWN) }

-- at most `most` of 1 .. count, both ends among them
local function thinned(count, most)
  local out, step = {}, math.max(1, (count - 1) / (most - 1))
  for k = 0, math.min(count, most) - 1 do out[k + 1] = math.floor(1 + k * step + 0.5) end
  return out
end

-- numbers of the rows and points that are shown, and the largest
local function samples(path, of, across, up)
  local points, rows, values, most = thinned(path.wave.N, across), thinned(#path, up), {}, 0
  for k, i in ipairs(rows) do
    local y = OVER_X[of][2](path.psi[i])
    values[k] = {}
    for l, j in ipairs(points) do
      values[k][l] = y[j]
      most = math.max(most, y[j])
    end
  end
  return points, rows, values, most
end

local function script(path, options, of, file)
  local points, rows, values, most = samples(path, of, MOST, MOST)
  local lines = {}
  local function add(line) lines[#lines + 1] = line end
  local x = { tostring(#points) }
  for l, j in ipairs(points) do x[l + 1] = ("%.9g"):format(path.wave.x[j]) end
  add(gnuplot.head(file, options, 800, 560))
  add("$data << EOD\n" .. table.concat(x, " "))
  for k, i in ipairs(rows) do
    local line = { ("%.9g"):format(path.t[i]) }
    for l = 1, #points do line[l + 1] = ("%.5g"):format(values[k][l]) end
    add(table.concat(line, " "))
  end
  add "EOD"
  add("set title " .. gnuplot.caption(options.title or path.title))
  local x0, x1 = path.wave.x[1], path.wave.x[points[#points]]
  local t0, t1 = path.t[1], path.t[rows[#rows]]
  add "set pm3d map corners2color c1"
  add(raster.axes(options, 800, 560, { x = { x0, x1, "x" }, y = { t0, t1, "t" },
    cb = of == "density" and { 0, most > 0 and most or 1, "|psi|^2" } or nil }))
  add(("set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]"):format(x0, x1, t0, t1))
  if of == "density" then
    add("set palette defined (" .. VIRIDIS .. ")")
  else
    add "set palette model HSV functions gray, 0.75, 0.95"
    add "set cbrange [-pi:pi]\nset cbtics ('-π' -pi, '0' 0, 'π' pi)"
    add("set cblabel " .. gnuplot.caption "arg psi")
  end
  add "splot $data nonuniform matrix with pm3d\nunset output"
  return table.concat(lines, "\n") .. "\n"
end

-- the latest row above
local function to_terminal(path, options, of)
  local width, height = look.pixels(options)
  width, height = width or 72, height or 24
  local points, rows, values, most = samples(path, of, width, height)
  for k = #rows, 1, -1 do
    local line = {}
    for l = 1, #points do
      local y = values[k][l]
      local part = of == "density" and (most > 0 and y / most or 0) or y / (2 * math.pi) + 0.5
      local shade = math.max(1, math.min(#SHADES, math.floor(part * #SHADES) + 1))
      line[l] = SHADES:sub(shade, shade)
    end
    io.write(("%9.4g |%s|\n"):format(path.t[rows[k]], table.concat(line)))
  end
  io.write((" "):rep(11), ("x = %.4g to %.4g; %s, up to %.3g\n"):format(path.wave.x[1],
    path.wave.x[points[#points]], OVER_X[of][1], most))
end

class.method("dm.wave_path", "spacetime", function(path, options)
  options = option.check(options or {}, KNOWN, "path:spacetime")
  local of = option.one_of(options, "of", "path:spacetime", { "density", "phase" }, "density")
  option.text(options, "title", "path:spacetime")
  look.check(options)
  if #path < 2 then option.fail("path:spacetime", "at least two rows are needed") end
  if not option.text(options, "file", "path:spacetime") then
    return to_terminal(path, options, of)
  end
  gnuplot.draw(options.file, function(part) return script(path, options, of, part) end)
  return options.file
end, [[
path:spacetime{of = "density" | "phase", file=, title=, size=, ...} -> file or nothing
x across, t up, |psi|^2 or the phase by colours with their scale, in a .png, .svg or .pdf; without a
file by characters in the terminal. Sizes and letters as of dm.plot.]])

return M
