--- Moving pictures: path:animate and dm.animate write a page of its own that a browser shows
-- without a network. dm.animate.points reads points off the rows, dm.animate.page makes the page,
-- dm.animate.script runs in it.
local blame = require "dm.base.blame"
local core = require "dm.core"
local film = require "dm.show.animate.film"
local inline = require "dm.show.inline"
local option = require "dm.base.options"
local points_, plots_ = require "dm.show.animate.points", require "dm.show.animate.plots"

local M = {}

local abs, min, max, ceil = math.abs, math.min, math.max, math.ceil

local WHERE = "animate"
local fail = option.failing(WHERE)

---- options ----

local KNOWN = { "points", "dim", "draw", "rods", "bodies", "trail", "plots", "title", "names",
  "frames", "t" }
table.move(film.KNOWN, 1, #film.KNOWN, #KNOWN + 1, KNOWN)

local DRAW = "(q, t) that returns { points = { {x, y}, ... } }"

local function is_span(t)
  return type(t) == "table" and type(t[1]) == "number" and type(t[2]) == "number" and t[1] < t[2]
end

-- a finite number from `least` on
local function check_number(options, key, least, what)
  local x = option.number(options, key, WHERE, what, least)
  option.demand(x >= least, options, key, WHERE, what)
end

-- options that are lists, and what stands in them
local LISTS = {
  { "plots", 'a list of columns, such as { "q1", "energy" }' },
  { "names", 'a list with a name for every path, such as { "verlet", "gauss(2)" }' },
  { "bodies", "a list with a table for every body: { { factor = 1 } } of a system on a group, else "
    .. "{ { pose = function(q, t) return R, x end } }, a rotation matrix and a place" },
}

local function check_options(options)
  option.check(options, KNOWN, WHERE)
  option.callable(options, "draw", WHERE, DRAW)
  if options.draw and options.points then fail "options 'draw' and 'points' exclude each other" end
  option.whole(options, "dim", WHERE, 2, 3)
  option.text(options, "title", WHERE)
  check_number(options, "trail", 0, "a time >= 0")
  check_number(options, "frames", 2, "a number of frames from 2")
  option.passing(options, "t", WHERE, is_span, "{from, to}, two times")
  local function is_table(x) return type(x) == "table" end
  for _, row in ipairs(LISTS) do option.passing(options, row[1], WHERE, is_table, row[2]) end
end

local function check_file(file)
  if type(file) ~= "string" or not (file:find "%.html?$" or film.is_film(file)) then
    fail("a file name that ends in .html, .mp4 or .gif is needed (got %s)", tostring(file))
  end
end

local function check_path(path, which)
  local function columns() return #path, path.t, path.columns[1] end
  local kind = type(path)
  if not (kind == "userdata" or kind == "table") or not blame.try(columns) then
    fail("%s is not a path (got %s): animate what solver:run returned", which, kind)
  end
  if #path == 0 then fail("%s has no rows: there is nothing to show", which) end
end

---- which rows ----

local FRAMES = 1500  -- frames of a page, unless asked for: about 25 s of a screen's pace

local function rows_within(path, span)
  local first, last = 1, #path
  if not span then return first, last end
  while first <= last and path.t[first] < span[1] do first = first + 1 end
  while last >= first and path.t[last] > span[2] do last = last - 1 end
  if first > last then
    fail("no row lies between t = %g and %g: the path goes from %g to %g", span[1], span[2],
      path.t[1], path.t[#path])
  end
  return first, last
end

-- how far the points go over all, and from row to row at the median: a long run would jump about if
-- it were thinned to fit
local function jump(reader, first, last)
  local lo, hi, moves, size = {}, {}, {}, reader.count * reader.dim
  local probe = max(1, (last - first) // 400)
  for i = first, last - 1, probe do
    local here, there, far = {}, {}, 0
    reader.row(i, here)
    reader.row(i + 1, there)
    for k = 1, size do
      local axis = k % reader.dim
      lo[axis], hi[axis] = min(lo[axis] or here[k], here[k]), max(hi[axis] or here[k], here[k])
      far = max(far, abs(there[k] - here[k]))
    end
    moves[#moves + 1] = far
  end
  table.sort(moves)
  local extent = 0
  for axis in pairs(lo) do extent = max(extent, hi[axis] - lo[axis]) end
  return extent > 0 and (moves[(#moves + 1) // 2] or 0) / extent or 0
end

-- the rows to show: all where they fit; else every k-th as long as the picture still moves
-- smoothly, and only the first part where it would not
local function chosen_rows(path, reader, options)
  local first, last = rows_within(path, options.t)
  local frames = math.floor(options.frames or FRAMES)
  local stride = max(1, ceil((last - first + 1) / frames))
  if stride > 1 and not options.frames and not options.t then
    local step = jump(reader, first, last)
    local smooth = step == step and step > 0 and max(1, math.floor(0.03 / step)) or stride
    if smooth < stride then stride, last = smooth, min(last, first + smooth * (frames - 1)) end
  end
  local rows = {}
  for i = first, last, stride do rows[#rows + 1] = i end
  return rows, first, last
end

---- what is read from a path ----

local function check_finite(numbers, path, rows, size, which)
  for k = 1, #numbers do
    local x = numbers[k]
    if x ~= x or abs(x) > 1e37 then
      local i = rows[(k - 1) // size + 1]
      fail("%s: a point is not finite, or beyond 1e37, in row %d, t = %g: show what is before "
        .. "with t = {%g, %g}", which, i, path.t[i], path.t[1],
        path.t[max(1, i - 1)])
    end
  end
end

local function is_constrained(path)
  local system = type(path) == "userdata" and path.system
  local fine, given = blame.try(function() return system.given end)
  return fine and given and given.constraint ~= nil
end

-- { name, points, dim, axes, rods, bodies, t, xyz } of one path, numbers still plain
local function read(path, options, which)
  local reader = points_.reader(path, options)
  local rows, first, last = chosen_rows(path, reader, options)
  local xyz, t = {}, {}
  for k, i in ipairs(rows) do
    reader.row(i, xyz, true)
    t[k] = path.t[i]
  end
  check_finite(xyz, path, rows, reader.count * reader.dim, which)
  for _, body in ipairs(reader.bodies) do check_finite(body.poses, path, rows, 7, which) end
  local rods = reader.rods
  if not rods and is_constrained(path) and reader.count <= 60 then
    rods = points_.held(xyz, reader.count, reader.dim)
  end
  return { points = reader.count, dim = reader.dim, axes = reader.axes, rods = rods or {}, t = t,
    xyz = xyz, bodies = reader.bodies, trails = reader.trails, first = first, last = last,
    rows = #rows }
end

---- the page ----

local function note_of(paths, shown)
  local out = {}
  for i, path in ipairs(paths) do
    local s = shown[i]
    local part = s.last < #path or s.first > 1
    if part then
      out[i] = ("t = %.6g to %.6g of %.6g to %.6g, %d frames")
        :format(s.t[1], s.t[#s.t], path.t[1], path.t[#path], s.rows)
    else
      out[i] = ("t = %.6g to %.6g, %s of %d rows")
        :format(s.t[1], s.t[#s.t], s.rows == #path and "all" or s.rows .. " frames", #path)
    end
    if out[i] == out[1] and i > 1 then out[i] = nil end
  end
  return table.concat(out, "; ") .. (shown[1].dim == 3 and ". Drag to turn, wheel to come nearer."
    or ". Wheel: nearer.")
    .. " Space: pause; arrow keys: step; click on a plot: that time."
end

local function names_of(paths, options)
  local names = {}
  for i, path in ipairs(paths) do
    names[i] = tostring(options.names and options.names[i] or path.title or "path " .. i)
  end
  return names
end

local function scene_of(paths, options, width)
  local shown = {}
  local function which(i) return #paths > 1 and "path " .. i or "the path" end
  for i, path in ipairs(paths) do check_path(path, which(i)) end
  local names = names_of(paths, options)
  for i, path in ipairs(paths) do
    shown[i] = read(path, options, which(i))
    if shown[i].dim ~= shown[1].dim then
      fail("path %d is drawn in %d dimensions, path 1 in %d", i, shown[i].dim, shown[1].dim)
    end
  end
  local span = shown[1].t[#shown[1].t] - shown[1].t[1]
  return { title = options.title or (#paths == 1 and names[1] or table.concat(names, "; ")),
    note = note_of(paths, shown), dim = shown[1].dim,
    axes = shown[1].axes, trail = (options.trail or span / 5) * 1.0, paths = shown,
    plots = plots_.all(paths, shown, options, names, width or 600) }, names
end

-- a body as the page has it
local function packed(body, page)
  local solid = body.solid
  return { vertices = page.floats(solid.vertices), faces = solid.faces, tints = solid.tints,
    reach = body.reach:totable(), poses = page.floats(body.poses) }
end

-- numbers to text, and only what the page needs
local function packed_scene(scene, names)
  local page = require "dm.show.animate.page"
  for i, s in ipairs(scene.paths) do
    local bodies = {}
    for k, body in ipairs(s.bodies) do bodies[k] = packed(body, page) end
    scene.paths[i] = { name = #names > 1 and names[i] or "", points = s.points, rods = s.rods,
      t = page.doubles(s.t), xyz = page.floats(s.xyz), bodies = bodies, trails = s.trails }
  end
  for _, plot in ipairs(scene.plots) do
    for i, line in ipairs(plot.lines) do
      plot.lines[i] = { name = line.name, t = page.doubles(line.t), y = page.floats(line.y) }
    end
  end
  return scene
end

--- What the page's script shows of some paths, its numbers as text; options as of dm.animate; width
-- of the plots in pixels, by default 600.
function M.scene(paths, options, width)
  check_options(options)
  return packed_scene(scene_of(paths, options, width))
end

-- a film of what the page would show
local function write_film(paths, file, options)
  return film.write(file, options, function(frames)
    local own = {}
    for key, value in pairs(options) do own[key] = value end
    own.frames, own.plots = frames, {}
    local scene, names = scene_of(paths, own)
    for i, s in ipairs(scene.paths) do s.name = #paths > 1 and names[i] or scene.title end
    return scene
  end)
end

local make
function make(paths, file, options)
  if file == nil and inline.show then
    return inline.file("html", function(name) make(paths, name, options) end)
  end
  check_file(file)
  check_options(options)
  if film.is_film(file) then return write_film(paths, file, options) end
  for _, key in ipairs(film.KNOWN) do
    if options[key] ~= nil then fail("option '%s' is of films (.mp4, .gif), not of pages", key) end
  end
  local text = require "dm.show.animate.page".text(M.scene(paths, options))
  return require "dm.base.text_file".write(file, text, "animate")
end

local doc_animate =
  "dm.animate({path, path, ...}, file, {points=, dim=, draw=, rods=, bodies=, trail=, plots=, "
  .. "names=, title=, frames=, t=, fps=, seconds=, size=}) -> file name\n" .. [[
A page for a browser (no network, nothing to install) in which several paths move side by side on
one clock and one scale: with trails, energy and momentum over time, a slider, speed, and, in space,
a camera that the mouse turns. names: one for each path; the other options are those of
path:animate.]]

M.animate = blame.caller(function(paths, file, options)
  if type(paths) ~= "table" or #paths == 0 then
    fail("dm.animate takes a list of paths, { path, path, ... }, and a file name")
  end
  return make(paths, file, options or {})
end)

local doc_path = [[
path:animate(file, {points=, dim=, draw=, rods=, bodies=, trail=, plots=, title=, frames=, t=,
  fps=, seconds=, size=}) -> file name
Write a page (.html, of its own: no network) with the moving system, its trail, energy and momentum
over time, a slider and a speed. In a notebook it stands there without a file.
Points are coordinates by name (x, y, z; x1, y1, x2, ...), else pairs or triples of q (dim = 2 or
3) without its angles, unless nothing else is left; or points = { {"x1", "y1"}, ... }, columns; or
draw = function(q, t) return { points = { {x, y}, ... }, rods = { {1, 2}, ... } } end, called for
every frame. rods: pairs of points, 0 is the origin; of a system with constraints those distances
that stay.
On a group every factor that turns (SO(3), SE(3)) is a body, with its axes and the trail of a point
on the third one, placed by the next factor R^3 or R^2; its ellipsoid is that of its inertia. bodies
= { { factor = 1, at = 2 or {x, y, z} or function(q, t), shape = "ellipsoid" | "box" | "cylinder",
inertia = {I1, I2, I3}, mass = or size = half lengths, centre = {x, y, z}, points = body points with
a trail, joints = without }, ... } says otherwise; of other systems with pose = function(q, t)
return R, {x, y, z} end. Points of bodies follow those of draw in the numbers that rods have.
trail: how much time it shows; plots: {
"energy", "theta", dm.SO(2), { name, numbers } }; t = {from, to} and frames: which rows (default: as
many as move smoothly, at most 1500).
A file .mp4 or .gif is a film, drawn by gnuplot and joined by ffmpeg: fps = 25 frames a second for
seconds = 10, size = {640, 480} pixels; each frame is the recorded row that is nearest to its
time.]]

M.path = blame.caller(function(path, file, options) return make({ path }, file, options or {}) end)

core.docs[M.animate] = doc_animate
core.method("dm.path", "animate", M.path, doc_path)

return M
