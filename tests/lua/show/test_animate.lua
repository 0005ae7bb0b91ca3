-- path:animate and dm.animate: the page needs nothing else, its script runs (node, chromium where there are some) and shows the
-- numbers of the path; what is chosen without being told; misuse
local tap = require "tap"
local dm = require "dm"
local browser = require "browser"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, sin, cos = math.abs, math.max, math.sin, math.cos

local base = os.tmpname()
local html = base .. ".html"

local function slurp(file)
  local f <close> = assert(io.open(file))
  return f:read "a"
end

local function has(program) return os.execute("command -v " .. program .. " >/dev/null 2>&1") end
local node = has "node" and "node"

-- what tests/lua/animated.js prints of a page: rows { path, frame, t, coordinates ... }, plots { name, count, first, last }
local function watch(file, ...)
  local command = ("%s tests/lua/animated.js %s %s 2>&1"):format(node, file, table.concat({ ... }, " "))
  local pipe = io.popen(command)
  local out = { rows = {}, plots = {}, text = pipe:read "a" }
  pipe:close()
  for line in out.text:gmatch "[^\n]+" do
    local name, numbers = line:match "^plot (.-): (.*)$"
    local list = {}
    for word in (numbers or line):gmatch "%S+" do list[#list + 1] = tonumber(word) end
    if name then
      out.plots[#out.plots + 1] = { name = name, count = list[1], first = list[2], last = list[3] }
    elseif line:find "^%d" then
      out.rows[#out.rows + 1] = list
    end
  end
  return out
end

-- coordinates of a row as printed against those expected, as floats of seven digits
local function off(row, ...)
  local worst = 0
  for k, x in ipairs { ... } do worst = max(worst, abs((row[3 + k] or 1e9) - x)) end
  return worst
end

local kepler = dm.system { name = "Kepler <e = 0.6> & more", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local orbit = kepler:solver { rule = "verlet", h = 0.01 }:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 1000 }
local rod = dm.system { Q = dm.R(6), coordinates = { "x1", "y1", "z1", "x2", "y2", "z2" },
  L = function(q, v) return v:dot(v) / 2 - q[3] - q[6] end,
  constraint = function(q)
    local a, b = dm.vector { q[1], q[2], q[3] }, dm.vector { q[4], q[5], q[6] }
    return { a:dot(a) - 1, (b - a):dot(b - a) - 4 }
  end }
local swing = rod:solver { rule = "rattle", h = 0.01 }:run { q = { 1, 0, 0, 1, 0, -2 }, v = { 0, 0.3, 0, 0, 0.2, 0 }, steps = 400 }
local pendulum = dm.system { Q = dm.T(1), coordinates = { "theta" }, L = function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end }
local tick = pendulum:solver { rule = "verlet", h = 0.05 }:run { q = { 2 }, v = { 0 }, steps = 300 }
local function drawing(q) return { points = { { sin(q[1]), -cos(q[1]) }, { 0, 1 } }, rods = { { 0, 1 } } } end

---- the page ----

ok(orbit:animate(html) == html, "the file name comes back")
local text = slurp(html)
ok(text:find "^<!DOCTYPE html>" and text:find "</html>%s*$", "a page from end to end")
ok(not text:find "https?:" and not text:find "src=" and not text:find "<link", "that asks nobody for anything")
ok(text:find("<title>Kepler &lt;e = 0.6&gt; &amp; more: verlet, h = 0.01</title>", 1, true), "titles are text, not markup")
local data = text:match '<script type="application/json" id="data">(.-)</script>'
ok(data and not data:find "[<&]", "nor can data end the script")
ok(#text < 21500 + 1001 * (8 + 4 * 2) * 4 / 3 + 2 * 1001 * 12 * 4 / 3, "a double and floats in base64 for each row, no more", #text)

local polar = dm.system { Q = dm.R(2), coordinates = { "r", "phi" },
  L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
polar:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = { 0.4, 0 }, v = { 0, 5 }, steps = 20 }):animate(html)
ok(not slurp(html):find "momentum of SO", "r and phi are not turned as if they were x and y")
orbit:animate(html)

if node then
  local seen = watch(html, 0, 5, 1e9)
  ok(seen.text:find "drawn yes", "its script plays, stops and draws, with finite numbers only", seen.text)
  near(off(seen.rows[1], 0.4, 0), 0, 1e-7, "the first row")
  near(off(seen.rows[2], orbit.q[501][1], orbit.q[501][2]), 0, 1e-6, "a row in between")
  near(off(seen.rows[3], orbit.q[1001][1], orbit.q[1001][2]), 0, 1e-6, "the last one, for times beyond it")
  local E = orbit:energy()
  ok(seen.plots[1].name == "energy + 0.5", "energy is shown as its change", seen.plots[1].name)
  near(seen.plots[1].last, E[1001] - E[1], 1e-8, "with the digits that the change has")
  ok(seen.plots[2].name:find "^momentum of SO%(2%)", "and the angular momentum", seen.plots[2].name)

  swing:animate(html)
  seen = watch(html, 1, 4)
  ok(seen.text:find "drawn yes", "in space, too", seen.text)
  near(off(seen.rows[1], table.unpack(swing.q[101]:totable())), 0, 1e-6, "x1, y1, z1, x2, ... are points of space")
  ok(slurp(html):find('"rods":[[0,1],[1,2]]', 1, true), "what the constraints hold together are rods, the origin among them")

  tick:animate(html, { draw = drawing, plots = { "theta", { "twice", tick:column "theta" * 2 } } })
  seen = watch(html, 3)
  near(off(seen.rows[1], sin(tick.q[61][1]), -cos(tick.q[61][1]), 0, 1), 0, 1e-7, "a user's own points")
  near(seen.plots[2].last, 2 * tick.q[301][1], 1e-6, "and numbers")

  local coarse = kepler:solver { rule = "rk4", h = 0.1 }:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 80 }
  ok(dm.animate({ orbit, coarse }, html, { names = { "fine", "coarse" }, title = "two" }) == html, "several side by side")
  seen = watch(html, 4.05, 8)
  ok(seen.rows[2][3] == 4 and off(seen.rows[2], coarse.q[41][1], coarse.q[41][2]) < 1e-6, "a row stays until the next: nothing is invented",
    seen.rows[2][3])
  near(off(seen.rows[4], coarse.q[81][1], coarse.q[81][2]), 0, 1e-6, "each has its own rows")
  ok(#seen.plots == 4 and seen.plots[1].name == "energy, change from the start", "one plot holds the lines of both", #seen.plots)

  local watched = kepler:solver { rule = "verlet", h = 0.1 }:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 50,
    watch = { "energy", a = function(q) return q[1] end, b = function(q) return 2 * q[2] end } }
  watched:animate(html, { points = { { "a", "b" } } })
  seen = watch(html, 5)
  near(off(seen.rows[1], watched:column "a"[51], watched:column "b"[51]), 0, 1e-6, "columns that were watched")
else
  print "# no node here: the script of the pages was not run"
end

-- how many rows
local long = kepler:solver { rule = "verlet", h = 0.01 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1e5, every = 10 }
long:animate(html)
text = slurp(html)
ok(text:find "frames" and text:find "of 0 to 1000, 1500 frames", "a long run is not thinned until it jumps: its first part is shown, and it says so",
  text:match "<p>(.-)</p>")
long:animate(html, { t = { 100, 200 } })
ok(slurp(html):find "t = 100 to 200 of 0 to 1000, 1001 frames", "or the part that is asked for")
long:animate(html, { frames = 500 })
ok(slurp(html):find "t = 0 to %S+, 477 frames of 10001 rows", "or so many frames of all, at most")

-- one coordinate; a coasting body that stands still
dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 end }:solver { rule = "verlet", h = 1 }:run { q = { 0 }, v = { 0 }, steps = 3 }
  :animate(html)
if node then ok(watch(html, 1).text:find "drawn yes", "a point at rest on a line is a picture") end

-- paths that no single run made: reduced and reconstructed ones, members of an ensemble, columns put together, what was only watched
do
  local turning = dm.system { Q = dm.R(2), coordinates = { "theta", "r" },
    L = function(q, v) return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2] end }
  local reduced = turning:routh { cyclic = { "theta" }, mu = 1 }:solver { rule = "gauss(2)", h = 0.1 }:run { q = { 1.2 }, v = { 0 }, steps = 50 }
  local full = reduced:reconstruct()
  full:animate(html, { draw = function(q) return { { q[2] * cos(q[1]), q[2] * sin(q[1]) } } end })
  ok(not node or off(watch(html, 3).rows[1], full.q[31][2] * cos(full.q[31][1]), full.q[31][2] * sin(full.q[31][1])) < 1e-6, "a reconstructed path")
  reduced:animate(html)
  ok(not node or off(watch(html, 3).rows[1], reduced.q[31][1], 0) < 1e-6, "the reduced one: a point on a line")
  local many = kepler:solver { rule = "verlet", h = 0.1 }:ensemble { members = 3, q = function(i) return { 0.3 + 0.1 * i, 0 } end,
    v = function() return { 0, 1.8 } end, steps = 40, every = 1 }
  dm.animate({ many:path(1), many:path(3) }, html, { names = { "near", "far" } })
  ok(not node or off(watch(html, 2).rows[2], many:path(3).q[21][1], many:path(3).q[21][2]) < 1e-6, "members of an ensemble")
  local seen = kepler:solver { rule = "verlet", h = 0.1 }:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 30,
    watch = { r = function(q) return q:norm() end, angle = function(q, v) return q:dot(v) end } }
  seen:animate(html)
  ok(not node or watch(html, 1).text:find "drawn yes", "two numbers that were watched, in their plane")
end

---- bodies: of groups by themselves, or as they are told; a point of a body is R X + x in every row ----

local G = dm.SO(3)
local top = dm.system { Q = G, L = function(R, W) return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3] end }
local turning = top:solver { rule = "gauss(4)", h = 0.1 }:run { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 }, steps = 60 }
local flying = dm.system { Q = dm.product(G, dm.R(3)), L = function(_, v)
  return (2 * v[1] ^ 2 + 3 * v[2] ^ 2 + 4 * v[3] ^ 2 + 5 * (v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2)) / 2 end }
local thrown = flying:solver { rule = "lie(2)", h = 0.1 }:run { q = { G:identity(), { 0, 0, 1 } }, v = { 0.1, 1, 0.2, 0.3, 0, 0.1 }, steps = 60 }
do
  turning:animate(html)
  ok(not node or watch(html, 2).text:find "drawn yes", "the body of a group", node and watch(html, 2).text)
  local R = turning.q[21]
  local tip = 1.4 -- its ellipsoid is longest along the third axis, and has no mass to tell how long
  if node then near(off(watch(html, 2).rows[1], tip * R[1][3], tip * R[2][3], tip * R[3][3]), 0, 1e-6, "the end of its third axis moves with it") end

  thrown:animate(html)
  local g, c = thrown.q[31], 1.4 * math.sqrt(2.5 * (2 + 3 - 4) / 5)
  local x = g[1] * dm.vector { 0, 0, c } + dm.vector(g[2])
  if node then near(off(watch(html, 3).rows[1], x[1], x[2], x[3]), 0, 1e-6, "where the next factor R^3 places it, as large as its inertia says") end
  for _, shape in ipairs { "box", "ellipsoid", "cylinder" } do
    thrown:animate(html, { bodies = { { shape = shape, points = { { 1, 0, 0 } }, joints = { { 0, 0, -1 } } } }, rods = { { 0, 2 } } })
    x = g[1] * dm.vector { 1, 0, 0 } + dm.vector(g[2])
    local y = dm.vector(g[2]) - g[1] * dm.vector { 0, 0, 1 }
    if node then near(off(watch(html, 3).rows[1], x[1], x[2], x[3], y[1], y[2], y[3]), 0, 1e-6, shape .. ": points and joints as asked for") end
  end
  local SE = dm.SE(3)
  local whole = dm.system { Q = SE, L = function(_, v) return (v:dot(v) + v[4] ^ 2) / 2 end }
  local path = whole:solver { rule = "lie(1)", h = 0.1 }:run { q = SE:identity(), v = { 1, 0, 0, 0.1, 0.5, 0 }, steps = 30 }
  path:animate(html, { bodies = { { size = { 1, 1, 1 }, points = { { 0, 1, 0 } } } } })
  local E = path.q[11]
  if node then near(off(watch(html, 1).rows[1], E[1][2] + E[1][4], E[2][2] + E[2][4], E[3][2] + E[3][4]), 0, 1e-6, "a body on SE(3)") end

  -- of no group: from angles, beside a point of draw's
  tick:animate(html, { bodies = { { pose = function(q) return G:exp { 0, q[1], 0 }, { 0, 0, 2 } end, shape = "box", inertia = { 1, 2, 2.5 },
    points = {}, joints = { { 0, 0, -2 } } } }, draw = function(q) return { { 0, 0, q[1] } } end })
  local a = tick.q[61][1]
  if node then near(off(watch(html, 3).rows[1], 0, 0, a, -2 * sin(a), 0, 2 - 2 * cos(a)), 0, 1e-6, "a body of no group, behind a point that draw gave") end
  dm.animate({ turning, turning }, html)
  ok(not node or watch(html, 3).text:find "drawn yes", "several paths with bodies")
  raises("unknown option 'sise'", turning.animate, turning, html, { bodies = { { sise = 1 } } })
  raises("'shape' must be", turning.animate, turning, html, { bodies = { { shape = "cube" } } })
  raises("a factor that turns", thrown.animate, thrown, html, { bodies = { { factor = 2 } } })
  raises("needs pose = function", tick.animate, tick, html, { bodies = { {} } })
  raises("list of tables", turning.animate, turning, html, { bodies = { 3 } })
  for _, size in ipairs { { 1, -2, 1 }, { 1, 0 / 0, 1 } } do raises("half lengths > 0", turning.animate, turning, html, { bodies = { { size = size } } }) end
  raises("'inertia' of a body must have 3", turning.animate, turning, html, { bodies = { { inertia = { 1, 2 } } } })
  raises("must give a place", turning.animate, turning, html, { bodies = { { at = function() return 1 end } } })
  for _, R in ipairs { 1, dm.matrix { { 2, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } } do
    raises("must return a rotation matrix", tick.animate, tick, html, { bodies = { { pose = function() return R end } } })
  end
  raises("must have 3 entries", turning.animate, turning, html, { bodies = { { points = { { 1, 2 } } } } })
  raises("three coordinates", tick.animate, tick, html, { draw = drawing, bodies = { { pose = function() return G:identity() end } } })
end

---- in a browser ----

if browser.there() and (os.getenv "UNDER" or "") == "" then
  swing:animate(html)
  local dom = browser.dom(html .. "#t=2")
  ok(dom:find 'data%-frame="200"', "chromium: the script ran and stands at the row that the address asks for", dom:match "<body[^>]*>")
  ok(dom:find "<canvas" and dom:find "t = 2%.0000", "with canvases, and the time in words")
  thrown:animate(html)
  dom = browser.dom(html .. "#t=2")
  ok(dom:find 'data%-frame="20"', "chromium: bodies are drawn, too", dom:match "<body[^>]*>")
else
  print "# no chromium here: the page was not opened in a browser"
end

---- misuse ----

raises("ends in .html", orbit.animate, orbit)
raises("ends in .html", orbit.animate, orbit, "orbit.png")
raises("cannot open", orbit.animate, orbit, "/no/such/folder/a.html")
if os.execute("ln -s /dev/full " .. base .. ".full.html 2>/dev/null && test -c /dev/full") then
  raises("cannot write", orbit.animate, orbit, base .. ".full.html")
  os.remove(base .. ".full.html")
end
raises("unknown option 'trails'", orbit.animate, orbit, html, { trails = 1 })
raises("takes a table of options", orbit.animate, orbit, html, 7)
raises("'trail' must be a time", orbit.animate, orbit, html, { trail = -1 })
raises("'frames' must be", orbit.animate, orbit, html, { frames = 0 / 0 })
raises("{from, to}", orbit.animate, orbit, html, { t = { 3, 2 } })
raises("no row lies between", orbit.animate, orbit, html, { t = { 50, 60 } })
raises("list of pairs or triples", orbit.animate, orbit, html, { points = { "q1", "q2" } })
raises("'nowhere'", orbit.animate, orbit, html, { points = { { "q1", "nowhere" } } })
raises("must be a whole number from 2 to 3", orbit.animate, orbit, html, { dim = 4 })
raises("exclude each other", orbit.animate, orbit, html, { draw = drawing, points = { { "q1", "q2" } } })
raises("must return { points", orbit.animate, orbit, html, { draw = function() end })
raises("point 2 of row 1", orbit.animate, orbit, html, { draw = function(q) return { points = { q, { 1, 2, 3 } } } end })
raises("holds a string", orbit.animate, orbit, html, { draw = function(q) return { points = { { q[1], "2" } } } end })
local calls = 0
raises("in row 1, but 2", orbit.animate, orbit, html, { draw = function(q)
  calls = calls + 1
  return { points = calls > 5 and { q, q } or { q } }
end })
raises("my own error", orbit.animate, orbit, html, { draw = function() error "my own error" end })
raises("rod 1 must be a pair of points from 1 to 1", orbit.animate, orbit, html, { rods = { { 1, 2 } } })
raises("option 'bodies' must be a list with a table for every body: { { factor = 1 } } of a system on a group", orbit.animate, orbit, html, { bodies = 3 })
raises('option \'plots\' must be a list of columns, such as { "q1", "energy" } (got 3)', orbit.animate, orbit, html, { plots = 3 })
raises("rods must be a list", orbit.animate, orbit, html, { rods = 5 })
raises("not finite, or beyond 1e37, in row", orbit.animate, orbit, html, { draw = function(q, t) return { { t < 5 and q[1] or 0 / 0, 0 } } end })
raises("the path has 1001 rows", orbit.animate, orbit, html, { plots = { { "mine", { 1, 2 } } } })
raises("option 'plots' holds", orbit.animate, orbit, html, { plots = { {} } })
raises("list of paths", dm.animate, {}, html)
raises("path 2 is not a path", dm.animate, { orbit, 3 }, html)
raises("dimensions", dm.animate, { orbit, swing }, html)
raises("draw = function", function()
  local five = dm.system { Q = dm.R(5), L = function(_, v) return v:dot(v) / 2 end }
  five:solver { rule = "verlet", h = 1 }:run { q = dm.vector(5), v = dm.vector(5), steps = 2 }:animate(html)
end)
raises("only what it watched", function()
  local path = kepler:solver { rule = "verlet", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 5, watch = { "energy" } }
  path:animate(html)
end)
local steep = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - 100 * q[1] ^ 2) / 2 end }
local lost, failure = pcall(function() return steep:solver { rule = "verlet", h = 0.21 }:run { q = { 1 }, v = { 0 }, steps = 5000 } end)
ok(not lost and tostring(failure.path):find "energy beyond all bounds", "a run that blew up can be looked at", failure)
raises("beyond 1e37", failure.path.animate, failure.path, html)
local fine, message = pcall(function() orbit:animate(html, { dim = 4 }) end)
ok(not fine and message:find "test_animate.lua:%d+: animate:", "an error names the line of the script", message)

os.remove(base)
---- films ----

local flat = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
  :solver { rule = "verlet", h = 0.05 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 100 }
tap.raises("'plots' is of pages", flat.animate, flat, html .. ".mp4", { plots = {} })
tap.raises("'fps' is of films", flat.animate, flat, html, { fps = 3 })
tap.raises("fps", flat.animate, flat, html .. ".gif", { fps = 0 })
tap.raises("frames", flat.animate, flat, html .. ".gif", { fps = 100, seconds = 1e4 })
tap.raises("in pixels", flat.animate, flat, html .. ".gif", { size = { 8, 6, "cm" } })
tap.raises(".html, .mp4 or .gif", flat.animate, flat, html .. ".avi")
local function holds(name)
  local f <close> = io.open(name, "rb")
  return f and f:read "a"
end
if os.execute "command -v ffmpeg >/dev/null && command -v gnuplot >/dev/null" then
  flat:animate(html .. ".mp4", { fps = 10, seconds = 1, size = { 160, 121 } })
  tap.ok((holds(html .. ".mp4") or ""):sub(5, 8) == "ftyp", "an MP4")
  local pipe = io.popen("ffprobe -v error -count_frames -select_streams v -show_entries stream=width,height,nb_read_frames -of csv=p=0 '" .. html .. ".mp4'")
  local told = pipe:read "l"
  pipe:close()
  tap.ok(told == "160,122,10", "ten frames of an even size", told)
  local body = dm.system { Q = dm.SO(3), L = function(_, w) return w:dot(dm.vector { w[1], 2 * w[2], 3 * w[3] }) / 2 end }
    :solver { rule = "lie(2)", h = 0.05 }:run { q = dm.matrix { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, v = { 0.1, 2, 0 }, steps = 40 }
  dm.animate({ body, body }, html .. ".gif", { fps = 5, seconds = 1, size = { 160, 120 } })
  tap.ok((holds(html .. ".gif") or ""):sub(1, 6) == "GIF89a", "a GIF of two bodies")
  tap.raises("does the folder exist", flat.animate, flat, "/no/such/folder/a.gif", { fps = 2, seconds = 1 })
  os.remove(html .. ".mp4")
  os.remove(html .. ".gif")
else
  print "# skipped: films (ffmpeg)"
end
local without = io.popen(("D=%q; PATH=/nonexistent \"$D\" -e '%s' 2>&1"):format(os.getenv "DMLUA" or arg[-1],
  "dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end }:solver { rule = \"verlet\", h = 1 }:run "
  .. "{ q = { 1, 0 }, v = { 0, 1 }, steps = 9 }:animate(\"" .. html .. ".mp4\")"))
local complaint = without:read "a"
without:close()
tap.ok(complaint:find "ffmpeg is not installed" and not holds(html .. ".mp4"), "without ffmpeg: what to install, no file", complaint)

-- points of groups: all coordinates, of each factor, and of these those that are no angles
local reader = require "dm.show.animate.points".reader
local SE2 = dm.SE(2)
for Q, is in pairs { [SE2] = { 1, 2 }, [dm.product(SE2, SE2)] = { 2, 2 }, [dm.SO(2)] = { 1, 2 }, [dm.SL(2)] = { 2, 2 },
  [dm.product(dm.R(2), SE2)] = { 2, 2 }, [dm.T(2)] = { 1, 2 } } do
  local q = Q == dm.T(2) and { 0, 0 } or Q:identity()
  local path = dm.system { Q = Q, L = function(_, v) return v:dot(v) / 2 end }:solver { rule = "gauss(1)", h = 0.1 }
    :run { q = q, v = dm.zeros(Q.dimension), steps = 1 }
  local read = reader(path, {})
  tap.ok(read.count == is[1] and read.dim == is[2], ("%d points of %s"):format(is[1], tostring(Q)), read.count)
end

os.remove(html)
tap.done()
