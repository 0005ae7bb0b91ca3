-- pictures of meshes: what is drawn by files, terminals and pages; looked at by eye when they change
local tap = require "tap"
local dm = require "dm"
local browser = require "browser"
local ok, raises = tap.ok, tap.raises

local function read(name)
  local handle = assert(io.open(name, "rb"))
  local text = handle:read "a"
  handle:close()
  os.remove(name)
  return text
end
local function count(text, pattern) return select(2, text:gsub(pattern, "")) end

local base = os.tmpname()
os.remove(base)
local flat, ball, solid = dm.mesh { grid = 3 }, dm.mesh { icosphere = 1 }, dm.mesh { shells = { 3, 1 } }
local height = ball:form(0, function(_, _, z) return z end)
local swirl = flat:form(1, function(x, y) return { -y, x } end)

---- a terminal: faces in shades, the nearest one counts ----

local function printed(f)
  local write, out = io.write, {}
  io.write = function(...) out[#out + 1] = table.concat({ ... }) end -- luacheck: ignore
  local fine, why = pcall(f)
  io.write = write -- luacheck: ignore
  ok(fine, "drawn in a terminal", why)
  local lines = {}
  for line in table.concat(out):gmatch "[^\n]+" do lines[#lines + 1] = line end
  return lines
end
local lines = printed(function() flat:form(0, function(x) return x end):plot { size = { 40, 12 }, title = "slope" } end)
ok(lines[1] == "slope" and #lines == 15 and lines[15]:find "'%.' = 0%.1111, '@' = 0%.8889", "title, twelve rows, the scale", lines[15])
local row = lines[7]:match "|(.*)"
local order, rises = ".:-=+*#%@", #row == 24 and row:find "^%.%.%.:?" and row:find "@@@$"
for i = 2, 24 do rises = rises and order:find(row:sub(i, i), 1, true) >= order:find(row:sub(i - 1, i - 1), 1, true) end
ok(rises, "means of triangles from light to dark", row)
lines = printed(function() ball:form(0, function(x) return x end):plot { size = { 40, 10 }, azimuth = math.pi / 2, height = 0 } end)
-- the eye is at x = +infinity or - infinity: one sign of x alone is seen
local seen = table.concat(lines, "", 2, #lines - 1)
ok(not seen:find "@" ~= not seen:find "%.", "what is near hides what is far", seen)

---- files ----

local pipe = io.popen "gnuplot --version 2>/dev/null"
local is_there = pipe:read "a":find "^gnuplot"
pipe:close()
if is_there then
  local name = base .. ".svg"
  for what, draw in pairs {
    mesh = function() return flat:plot { file = name, dual = true } end,
    ["0-form"] = function() return height:plot { file = name, azimuth = 1, height = 0.2 } end,
    ["1-form"] = function() return swirl:plot { file = name, title = "a swirl", label = "m/s" } end,
    ["2-form"] = function() return flat:form(2, flat:oriented(flat:volume(2))):plot { file = name } end,
    ["dual function"] = function() return flat:form(2, flat:volume(2)):star():plot { file = name } end,
    field = function() return swirl:sharp { to = "cells" }:plot { file = name } end,
    solid = function() return dm.mesh { cube_tiling = 2 }:plot { file = name } end,
  } do
    local file = draw()
    local text = read(file)
    ok(text:find "<svg" and count(text, "<polygon") + count(text, "<path") > 20, what .. " drawn")
    if what == "1-form" then ok(text:find "a swirl" and text:find "m/s", "title and label") end
  end
  -- of a body only the faces that look this way: half of those of a cube, 6 N^2
  local function faces(N)
    return count(read(dm.mesh { cube_tiling = N }:form(0, function(x) return x end):plot { file = name }), "<polygon")
  end
  ok(faces(2) - faces(1) == 6 * (4 - 1), "faces that are turned away are not drawn", faces(2) - faces(1))
  -- and of their edges: 9 N^2 + 3 N of the 18 N^2 (a disc of 6 N^2 triangles with 6 N edges round it), which have lines
  -- of a width of their own
  local function lines(N)
    local drawn = read(dm.mesh { cube_tiling = N }:form(1, function() return { 1, 0, 0 } end):plot { file = name })
    return count(drawn, 'currentColor" stroke%-width="1.80"')
  end
  for N, seen in pairs { 12, 42, 90 } do ok(lines(N) == seen, "edges that are turned away are not drawn", lines(N)) end
  -- a name of one letter stands upright beside its colours, a longer one along them
  local function upright(label)
    return not read(dm.mesh { grid = 2 }:form(0, function(x) return x end):plot { file = name, label = label }):find "rotate%(270"
  end
  ok(upright "p" and not upright "pressure", "short names are upright")
  -- d(y dx - x dy) = -2, with round-off in its values per area: one colour, and a scale about it
  local constant = flat:form(1, function(x, y) return { y, -x } end):d()
  for what, form in pairs { ["constant by round-off"] = constant, large = 1e300 * height, even = 1e8 * constant } do
    local drawn = read(form:plot { file = name })
    ok(drawn:find "<svg", "drawn: a form that is " .. what)
    local middle = count(drawn, "<polygon fill = 'rgb%( ?33, 144, 141%)'") -- the fifth of the nine stops
    ok(form ~= constant or middle >= flat:count(2), "one colour for one value", middle)
  end
  raises("does the folder exist", function() flat:plot { file = base .. "/no/such.png" } end)
else
  print "# gnuplot is not installed: files are not drawn"
end
raises("picture is .png", function() flat:plot { file = base .. ".gif" } end)
if is_there then
  local png = swirl:plot { file = base .. ".png", size = { 8.5, 6, "cm" }, dpi = 300, fontsize = 8, linewidth = 0.7 }
  local file = assert(io.open(png, "rb"))
  local w, h = (">I4I4"):unpack(file:read(24), 17)
  file:close()
  os.remove(png)
  ok(w == 1004 and h == 709, "8.5 x 6 cm at 300 dots per inch", w)
end
raises("furlong", function() flat:plot { file = base .. ".png", size = { 8, 6, "furlong" } } end)
raises("no points", function() dm.mesh { hex_torus = 4 }:plot() end)
raises("'axis'", function() flat:plot { axis = 1 } end)
raises("boundary", function() solid:form(3, solid:volume(3)):plot() end)
raises("surfaces", function() solid:plot { dual = true } end)

---- a page ----

local name = base .. ".html"
ball:animate(name, { forms = { height = height, slope = height:d() }, title = "a <ball> & more" })
local page = read(name)
ok(page:lower():find "^<!doctype html" and page:find "a &lt;ball&gt; &amp; more", "a page with its title")
ok(not page:find "https?://" and not page:find "@%u+@", "of its own: no network, nothing left out")
local data = page:match '<script type="application/json" id="data">(.-)</script>'
ok(count(data, '"name":') == 3 and data:find '"least":%-1' and data:find '"label":"per length"', "mesh and forms, with their scales")
ok(#data:match '"points":"([^"]*)"' == 4 * math.ceil(ball:count(0) * 3 * 4 / 3), "all points")
solid:animate(name)
ok(read(name):find "drawn", "a solid")
raises("html", function() ball:animate(base .. ".png") end)
raises("of this mesh", function() ball:animate(name, { forms = { x = swirl } }) end)

---- chromium, where it is: the page runs and draws ----

if browser.there() then
  ball:animate(name, { forms = { height = height } })
  local dom = browser.dom(name .. "#form=2")
  os.remove(name)
  ok(dom:find 'data%-form="height"' and count(dom, "<option") == 2, "a browser draws it")
else
  print "# chromium is not installed: the page is not opened"
end
tap.done()
