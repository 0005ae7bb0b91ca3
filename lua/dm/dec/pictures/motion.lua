--- Runs of forms on a mesh, flows and paths of fields, drawn: a row as a picture, all rows as a
-- page in motion, as VTK files with their times, as NumPy records.
local class = require "dm.base.class"
local colours = require "dm.dec.pictures.colours"
local drawing = require "dm.dec.pictures.drawing"
local npy = require "dm.data.npy"
local option = require "dm.base.options"
local page = require "dm.show.animate.page"
local series = require "dm.data.series"
local text_file = require "dm.base.text_file"
local turned = require "dm.dec.pictures.animate"
require "dm.dec"
require "dm.dec.flow"
require "dm.dec.pictures.plot"
require "dm.dec.save"

local M = {}

local FRAMES, NUMBERS = 400, 4e6 -- at most, of a page

---- one face for both: mesh, count, t(i), names, form(i, name) ----

local function of_flow(run)
  return { mesh = run.mesh, count = #run, names = { "w", "psi" }, title = "vorticity",
    t = function(i) return run.t[i] end,
    form = function(i, name) return name == "psi" and run:stream(i) or run:form(i) end }
end

-- q and p of a field, of several values q1, q2, ...
local function of_path(path, where)
  local f = path.system.field
  if not f then option.fail(where, "the system of this path is no field: K:field makes one") end
  local names = {}
  for _, what in ipairs { "q", "p" } do
    for c = 1, f.values do names[#names + 1] = f.values > 1 and what .. c or what end
  end
  return { mesh = f.mesh, count = #path, names = names, title = path.title, field = f,
    t = function(i) return path.t[i] end,
    form = function(i, name)
      local forms = path:form(i, name:sub(1, 1))
      return f.values > 1 and forms[tonumber(name:sub(2))] or forms
    end,
    -- where the values are points of the space of the mesh: a body that moves
    points = f.degree == 0 and f.values == f.mesh.ambient
      and function(i) return path.q[i] end or nil }
end

local function check_name(run, name, where)
  if name == nil then return run.names[1] end
  for _, own in ipairs(run.names) do
    if own == name then return name end
  end
  option.fail(where, "takes the name of a form, %s (got %s)", table.concat(run.names, ", "),
    option.got(name))
end

---- a row as a picture, a column as a line ----

local PLOT = { "row", "file", "title", "azimuth", "height", "label", "dual", "ascii",
  table.unpack(require "dm.show.look".SIZED) }

local function draw(run, name, options, where)
  options = option.check(options or {}, PLOT, where)
  name = check_name(run, name, where)
  local row = option.whole(options, "row", where, 1, run.count, run.count)
  local own = {}
  for key, value in pairs(options) do own[key] = value end
  own.row = nil
  own.title = options.title or ("%s at t = %.4g"):format(name, run.t(row))
  own.label = options.label or name
  return run.form(row, name):plot(own)
end

---- a page in motion ----

-- numbers of rows, evenly, the first and the last among them
local function frames_of(run, floats)
  local most = math.max(2, math.min(FRAMES, math.floor(NUMBERS / math.max(1, floats))))
  local out = {}
  if run.count <= most then
    for i = 1, run.count do out[i] = i end
    return out
  end
  for k = 0, most - 1 do out[k + 1] = 1 + math.floor(k * (run.count - 1) / (most - 1) + 0.5) end
  return out
end

local function add_points(out, run, i)
  local q, N = run.points(i), run.mesh.ambient
  for v = 0, run.mesh:count(0) - 1 do
    for c = 1, 3 do out[#out + 1] = c <= N and q[v * N + c] or 0 end
  end
end

-- values of all frames, one after the other, with their scale; times; points where they move
local function motion_of(run, d, name, options)
  local t, values, points, on, label = {}, {}, {}, nil, nil
  local rows = frames_of(run, #d.faces + #d.edges + (run.points and 3 * #d.points or 0))
  for k, i in ipairs(rows) do
    local laid = drawing.values(d, run.form(i, name))
    t[k], on, label = run.t(i), laid.on, laid.name
    table.move(laid.values, 1, #laid.values, #values + 1, values)
    if run.points then add_points(points, run, i) end
  end
  local scale = colours.scale(values)
  return { t = page.doubles(t), frames = #t, values = page.floats(values),
    points = run.points and page.floats(points) or nil, seconds = options.seconds or 10 },
    { name = name, on = on, label = ("%s, %s"):format(name, label), least = scale.least,
      largest = scale.largest, stops = scale.stops, arrows = page.floats {} }
end

local function write_page(run, file, options, where)
  if type(file) ~= "string" or not file:find "%.html?$" then
    option.fail(where, "a file name that ends in .html is needed (got %s)", option.got(file))
  end
  options = option.check(options or {}, { "of", "title", "seconds" }, where)
  option.text(options, "title", where)
  option.positive(options, "seconds", where)
  local name, d = check_name(run, options.of, where), drawing.mesh(run.mesh)
  local data = turned.data(d)
  local motion, entry = motion_of(run, d, name, options)
  data.motion, data.forms[2] = motion, entry
  local note = ("%d vertices, %d of %d rows from t = %.4g to %.4g; drag to turn, wheel to come "
    .. "nearer, space to pause"):format(run.mesh:count(0), motion.frames, run.count, run.t(1),
    run.t(run.count))
  return text_file.write(file, turned.page(options.title or run.title, note, data), where)
end

---- files ----

local function write_vtk(run, prefix, where)
  local function forms(i)
    local out = {}
    for _, name in ipairs(run.names) do out[name] = run.form(i, name) end
    return out
  end
  return series.vtk(prefix, run.count, run.t, where, function(i, file)
    return run.mesh:save(file, { forms = forms(i) })
  end)
end

local function write_npy(path, file)
  local f = path.system.field
  npy.stream(file, { { "t", 0 }, { "q", f.n }, { "p", f.n } }, "path:npy", function(write)
    for i = 1, #path do write { t = path.t[i], q = path.q[i], p = path.p[i] } end
  end)
  return file
end

---- methods ----

class.method("dm.flow", "plot", function(flow, name, options)
  local where = "flow:plot"
  if type(name) == "table" then name, options = nil, name end
  local run = of_flow(flow)
  if type(name) == "string" and (name == "energy" or name == "enstrophy" or name == "circulation")
  then
    option.check(options or {}, { "file", "title" }, where)
    return require "dm.show.plot".plot({ { x = flow.t, y = flow:column(name), name = name,
      xlabel = "t", ylabel = name } }, options or {})
  end
  return draw(run, name, options, where)
end, [[
run:plot("w" | "psi" | column, {row=, file=, title=, azimuth=, height=, label=}) -> file name
or nothing
The vorticity (or the stream function) of a row, the last by default, as form:plot draws it; or a
column, such as "energy", over t. In the terminal, or with file = to a .png, .svg or .pdf.]])

class.method("dm.flow", "animate", function(flow, file, options)
  return write_page(of_flow(flow), file, options, "flow:animate")
end, [[
run:animate(file, {of = "w" | "psi", title=, seconds=}) -> file name
A page, name.html, in which a browser shows the rows one after the other on the surface, which can
be turned, without a network; seconds: how long all of them take (10).]])

class.method("dm.flow", "vtk", function(flow, prefix)
  return write_vtk(of_flow(flow), prefix, "flow:vtk")
end, [[
run:vtk(file) -> list of file names
file_00001.vtk, ... for every row, with w and psi at the vertices, and as the last one
file.vtk.series, which gives ParaView their times.]])

class.method("dm.path", "vtk", function(path, prefix)
  return write_vtk(of_path(path, "path:vtk"), prefix, "path:vtk")
end, [[
path:vtk(file) -> list of file names
Of a field on a mesh: file_00001.vtk, ... for every row with q and p (q1, q2, ... of several
values), forms of degree 1, and of degree 2 in space, as vectors in the cells, and as the last one
file.vtk.series, which gives ParaView their times.]])

---- what of_fields.lua gives to paths ----

function M.animate(path, file, options)
  return write_page(of_path(path, "path:animate"), file, options, "path:animate")
end

M.npy = write_npy

--- A row of a form; a second result true: it is not one that was asked for.
function M.plot(path, name, options)
  if type(name) == "table" and not name[1] then name, options = nil, name end
  if name ~= nil and (type(name) ~= "string" or not name:find "^[qp]%d*$") then return nil, true end
  return draw(of_path(path, "path:plot"), name, options, "path:plot")
end

return M
