--- Films: the frames of an animation drawn by gnuplot and joined by ffmpeg, as .mp4 or .gif.
local gnuplot = require "dm.show.gnuplot"
local label = require "dm.show.label"
local look_ = require "dm.show.look"
local option = require "dm.base.options"
local palette = require "dm.show.palette"

local M = {}

local min, max, cos, sin, floor = math.min, math.max, math.cos, math.sin, math.floor

local WHERE = "animate"
local fail = option.failing(WHERE)

local FPS, SECONDS, WIDTH, HEIGHT = 25, 10, 640, 480
local MOST = 20000      -- frames
local TRAIL = 400       -- points of a trail that a frame shows
local TURN, RISE = -0.9, 0.45 -- rad: whence a motion in space is seen

---- options ----

--- Options of films alone.
M.KNOWN = { "fps", "seconds", "size" }

--- Is it the name of a film?
function M.is_film(file) return type(file) == "string" and file:lower():find "%.mp4$"
  or type(file) == "string" and file:lower():find "%.gif$" end

local function even(x) return floor(x / 2 + 0.5) * 2 end

-- { fps, count, width, height }
local function plan_of(options)
  for _, key in ipairs { "plots", "frames" } do
    if options[key] ~= nil then
      fail("option '%s' is of pages (.html): a film has 'fps' and 'seconds'", key)
    end
  end
  local fps = option.number(options, "fps", WHERE, nil, FPS)
  local seconds = option.positive(options, "seconds", WHERE, "how long the film is, in s,", SECONDS)
  if not (fps >= 1 and fps <= 120) then fail("option 'fps' must be from 1 to 120 (got %g)", fps) end
  local count = floor(fps * seconds + 0.5)
  if count < 2 or count > MOST then
    fail("a film has 2 to %d frames: fps times seconds are %d", MOST, count)
  end
  look_.check { size = options.size }
  local w, h = look_.pixels { size = options.size }
  if options.size and not (w and h) then
    fail "option 'size' of a film must be {width, height} in pixels"
  end
  return { fps = fps, count = count, width = even(w or WIDTH), height = even(h or HEIGHT) }
end

---- what a frame shows ----

-- onto the plane of the picture
local function project(x, y, z, dim)
  if dim == 2 then return x, y end
  local u, v = cos(TURN) * x - sin(TURN) * y, sin(TURN) * x + cos(TURN) * y
  return u, cos(RISE) * z + sin(RISE) * v
end

-- point k (0: the origin) of row i
local function point(s, i, k)
  if k == 0 then return project(0, 0, 0, s.dim) end
  local at = ((i - 1) * s.points + k - 1) * s.dim
  return project(s.xyz[at + 1], s.xyz[at + 2], s.xyz[at + 3], s.dim)
end

-- vertices of a body at row i, on the plane
local function vertices(body, i)
  local p, list, out = body.poses, body.solid.vertices, {}
  local at = 7 * (i - 1)
  local w, a, b, c = p[at + 1], p[at + 2], p[at + 3], p[at + 4]
  for k = 1, #list, 3 do
    local x, y, z = list[k], list[k + 1], list[k + 2]
    local tx, ty, tz = 2 * (b * z - c * y), 2 * (c * x - a * z), 2 * (a * y - b * x)
    local u, v = project(x + w * tx + b * tz - c * ty + p[at + 5],
      y + w * ty + c * tx - a * tz + p[at + 6], z + w * tz + a * ty - b * tx + p[at + 7], 3)
    out[#out + 1] = { u, v }
  end
  return out
end

-- the range that all rows of all paths need, with one scale on both axes
local function box_of(paths, width, height)
  local lo, hi = { 1e300, 1e300 }, { -1e300, -1e300 }
  local function take(x, y)
    lo[1], lo[2], hi[1], hi[2] = min(lo[1], x), min(lo[2], y), max(hi[1], x), max(hi[2], y)
  end
  for _, s in ipairs(paths) do
    for i = 1, #s.t do
      for k = 1, s.points do take(point(s, i, k)) end
      for _, body in ipairs(s.bodies) do
        for _, xy in ipairs(i % 8 == 1 and vertices(body, i) or {}) do take(xy[1], xy[2]) end
      end
    end
    for _, rod in ipairs(s.rods) do
      if rod[1] == 0 or rod[2] == 0 then take(project(0, 0, 0, s.dim)) end
    end
  end
  local middle = { (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2 }
  local each = width / #paths / height
  local half = 0.55 * max(hi[2] - lo[2], (hi[1] - lo[1]) / each, 1e-9)
  return middle[1] - half * each, middle[1] + half * each, middle[2] - half, middle[2] + half
end

-- rows of a path that are nearest to even times
local function rows_at(s, from, to, count)
  local out, i = {}, 1
  for k = 0, count - 1 do
    local t = from + (to - from) * k / (count - 1)
    while i < #s.t and math.abs(s.t[i + 1] - t) <= math.abs(s.t[i] - t) do i = i + 1 end
    out[k + 1] = i
  end
  return out
end

---- the script ----

local function block(add, name, lists)
  add("$" .. name .. " << EOD")
  for _, list in ipairs(lists) do
    for _, xy in ipairs(list) do add(("%.6g %.6g"):format(xy[1], xy[2])) end
    add ""
  end
  add "EOD"
end

-- the last part of the way of each point that leaves one
local function trails_of(s, i, trail)
  local first = i
  while first > 1 and s.t[i] - s.t[first - 1] <= trail do first = first - 1 end
  local stride, out = max(1, (i - first) // TRAIL), {}
  local numbers = s.trails
  for k = 1, numbers and #numbers or s.points do
    local list = {}
    local number = numbers and numbers[k] or k
    for row = first, i, stride do list[#list + 1] = { point(s, row, number) } end
    list[#list + 1] = { point(s, i, number) }
    out[k] = list
  end
  return out
end

local function lines_of(s, i)
  local rods, faces, dots = {}, {}, {}
  for k, rod in ipairs(s.rods) do rods[k] = { { point(s, i, rod[1]) }, { point(s, i, rod[2]) } } end
  for _, body in ipairs(s.bodies) do
    local list = vertices(body, i)
    for _, face in ipairs(body.solid.faces) do
      local around = {}
      for k, number in ipairs(face) do around[k] = list[number + 1] end
      around[#around + 1] = around[1]
      faces[#faces + 1] = around
    end
  end
  for k = 1, s.points do dots[k] = { point(s, i, k) } end
  return rods, faces, dots
end

local function add_path(add, s, i, number, scene)
  local rods, faces, dots = lines_of(s, i)
  local colour = palette.LINES[(number - 1) % #palette.LINES + 1]
  local plots = {}
  local function layer(name, lists, style)
    if #lists == 0 then return end
    block(add, name .. number, lists)
    plots[#plots + 1] = ("$%s%d using 1:2 with %s"):format(name, number, style)
  end
  layer("trail", trails_of(s, i, scene.trail), ("lines lw 1.2 lc rgb '%s'"):format(colour))
  layer("faces", faces, "lines lw 0.5 lc rgb '#909090'")
  layer("rods", rods, "lines lw 2 lc rgb '#404040'")
  layer("dots", { dots }, ("points pt 7 ps %g lc rgb '%s'"):format(s.points > 20 and 0.6 or 1.2,
    colour))
  add(("set title %s"):format(label.caption(("%s%st = %.4g"):format(s.name or "",
    (s.name or "") ~= "" and ", " or "", s.t[i]))))
  add("plot " .. table.concat(plots, ", "))
end

local function script_of(scene, plan, folder)
  local lines, paths = {}, scene.paths
  local function add(line) lines[#lines + 1] = line end
  add("set terminal " .. look_.TERMINALS.png(look_.of({}, plan.width, plan.height)))
  add "set encoding utf8\nunset key\nset border 3 lc rgb '#c0c0c0'\nset tics out nomirror"
  if scene.dim == 3 then add "unset border\nunset tics" end
  add(("set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]"):format(box_of(paths, plan.width,
    plan.height - 60)))
  add "set size ratio -1"
  local from, to, rows = math.huge, -math.huge, {}
  for _, s in ipairs(paths) do from, to = min(from, s.t[1]), max(to, s.t[#s.t]) end
  for k, s in ipairs(paths) do rows[k] = rows_at(s, from, to, plan.count) end
  for frame = 1, plan.count do
    add(("set output %s"):format(label.quote(("%s/%06d.png"):format(folder, frame))))
    if #paths > 1 then
      add(("set multiplot layout 1,%d title %s"):format(#paths, label.caption(scene.title)))
    end
    for k, s in ipairs(paths) do add_path(add, s, rows[k][frame], k, scene) end
    if #paths > 1 then add "unset multiplot" end
  end
  add "unset output"
  return table.concat(lines, "\n") .. "\n"
end

---- the programs ----

local function shell_quote(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

-- what a program says, and whether it ended well
local function run(command)
  local pipe = io.popen(command .. " 2>&1 </dev/null")
  local said = pipe:read "a"
  return pipe:close(), said
end

local function need(program, package)
  if not run("command -v " .. program) then
    fail("%s is not installed; install it (Debian, Ubuntu: apt install %s), or write a page, .html",
      program, package)
  end
end

local CODECS = { mp4 = "-c:v libx264 -pix_fmt yuv420p -crf 20 -movflags +faststart",
  gif = "-vf 'split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer' -loop 0" }

local function join(folder, file, plan)
  local kind = file:lower():match "%.(%w+)$"
  local core = require "dm.core"
  local part, why = core.new_file(file)
  if not part then fail("cannot write %s: does the folder exist?", why) end
  local fine, said = run(("ffmpeg -v error -y -framerate %g -i %s %s -f %s %s"):format(plan.fps,
    shell_quote(folder .. "/%06d.png"), CODECS[kind], kind, shell_quote(part)))
  if not fine then
    os.remove(part)
    fail("ffmpeg cannot make %s: %s", file, said:gsub("%s+", " "):sub(1, 300))
  end
  assert(core.end_file(part, file))
end

--- Writes the film; scene_of(frames) gives what a page would show of at most so many rows.
function M.write(file, options, scene_of)
  local plan = plan_of(options)
  if file:find "%c" then fail("file %q: a name without control characters is needed", file) end
  need("ffmpeg", "ffmpeg")
  need("gnuplot", "gnuplot-nox")
  local scene = scene_of(4 * plan.count)
  local folder = os.tmpname()
  os.remove(folder)
  run("mkdir -m 700 " .. shell_quote(folder))
  local fine, why = pcall(function()
    local handle = assert(io.open(folder .. "/script", "w"))
    assert(handle:write(script_of(scene, plan, folder)))
    assert(handle:close())
    local drawn, said = run("gnuplot " .. shell_quote(folder .. "/script"))
    if not drawn then fail("gnuplot says: %s", said:gsub("%s+", " "):sub(1, 300)) end
    local last = ("%s/%06d.png"):format(folder, plan.count)
    if not gnuplot.is_whole(last, "png") then
      fail("cannot write the frames: %s", gnuplot.stopped_by(last) or "the last one has no end")
    end
    join(folder, file, plan)
  end)
  run("rm -r " .. shell_quote(folder))
  if not fine then error(why, 0) end
  return file
end

return M
