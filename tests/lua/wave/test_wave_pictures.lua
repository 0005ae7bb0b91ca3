-- pictures of waves: over x with V, space and time, pages; looked at by eye when they change
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function read(name)
  local handle = assert(io.open(name, "rb"))
  local text = handle:read "a"
  handle:close()
  os.remove(name)
  return text
end
local base = os.tmpname()
os.remove(base)

local function packet(x) local a = math.exp(-x ^ 2 / 2) return a * math.cos(x), a * math.sin(x) end
local ring = dm.schroedinger { x = { -8, 8, 64 }, V = function(x) return x ^ 2 / 2 end }
local walls = dm.schroedinger { x = { -8, 8, 41 }, boundary = "walls" }
local path = ring:solver({ rule = "strang", h = 0.1 }):run { psi = packet, steps = 20 }
local box = walls:solver({ rule = "gauss(2)", h = 0.1 }):run { psi = packet, steps = 20 }

local pipe = io.popen "gnuplot --version 2>/dev/null"
local is_there = pipe:read "a":find "^gnuplot"
pipe:close()
if is_there then
  local name = base .. ".svg"
  for what, draw in pairs {
    density = function() return path:plot("density", { file = name, rows = { 1, 11, 21 } }) end,
    phase = function() return path:plot("phase", { file = name, rows = 3 }) end,
    column = function() return path:plot("x", { file = name }) end,
    columns = function() return path:plot("t", { "x", "momentum" }, { file = name }) end,
    spacetime = function() return path:spacetime { file = name, size = { 8.5, 6, "cm" } } end,
    phases = function() return path:spacetime { file = name, of = "phase", title = "turning" } end,
    walls = function() return box:spacetime { file = name } end,
  } do
    local text = read(draw())
    ok(text:find "<svg" and #text > 3000, what .. " drawn")
    if what == "density" then ok(text:find "V, 0 to 32" and text:find "t = 2", "  with V and times") end
    if what == "density" then
      local free = dm.schroedinger { x = { -8, 8, 64 } }
      local still = free:solver({ rule = "strang", h = 0.1 }):run { psi = packet, steps = 2 }
      ok(read(still:plot("density", { file = name })):find "<svg", "  and where V is 0")
    end
    if what == "spacetime" then ok(text:find 'width="321" height="227"', "  in centimetres") end
    if what == "phases" then ok(text:find "turning" and text:find "arg ψ", "  title and colour scale") end
  end
else
  print "# gnuplot is not installed: files are not drawn"
end

-- in the terminal: a line for each row that is shown, the last above
local lines, write = {}, io.write
io.write = function(...) for _, s in ipairs { ... } do lines[#lines + 1] = s end end -- luacheck: ignore
path:spacetime { width = 40, height = 10 }
io.write = write -- luacheck: ignore
ok(#lines == 12 and lines[1]:find "^ +2 |" and lines[10]:find "^ +0 |", "space and time by characters", #lines)

local page = read(path:animate(base .. ".html", { title = "a <wave>" }))
ok(page:lower():find "^<!doctype html" and page:find "a &lt;wave&gt;" and not page:find "https?://", "a page of its own")
ok(page:find "21 of 21 rows" and page:find '"most":', "  with its frames")
ok(read(box:animate(base .. ".html")):find "gauss", "  between walls")

raises("no column", function() path:plot "colour" end)
raises("rows", function() path:plot("density", { rows = { 22 } }) end)
raises("'of'", function() path:spacetime { of = "energy" } end)
raises(".html", function() path:animate "wave.gif" end)
raises("two rows", function() ring:solver({ rule = "strang", h = 0.1 }):run({ psi = packet, steps = 0 }):spacetime() end)
tap.done()
