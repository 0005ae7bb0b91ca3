-- lists that objects hand out to be read, userdata, stand where a list of one's own may
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

local system = dm.system { Q = dm.R(2), params = { k = 2 }, L = function(q, v, _, P) return v:dot(v) / 2 - P.k * q:dot(q) / 2 end }
local solver = system:solver { rule = "verlet", h = 0.1 }
local start = { q = { 1, 0 }, v = { 0, 1 }, steps = 20 }
local path = solver:run(start)
local own = table.move(path.columns, 1, #path.columns, 1, {})

-- what is drawn is what a list of one's own draws, with its names
local function picture(...)
  local file = os.tmpname() .. ".svg"
  local arguments = { ... }
  arguments[#arguments].file = file
  path:plot(table.unpack(arguments))
  local handle = assert(io.open(file))
  local text = handle:read "a"
  handle:close()
  os.remove(file)
  return text
end
local whole = picture("t", own, { names = own })
ok(whole:find(">p2<", 1, true) and picture("t", path.columns, { names = path.columns }) == whole, "plots take them, as columns and as names")

-- options of C and of Lua, results, and all options of a system
local core = require "dm.core"
local function handed_out(list) return core.locked(list, "a list") end
local watched = solver:run { q = start.q, v = start.v, steps = 3, watch = handed_out { "q2", "energy" } }
ok(table.concat(watched.columns, " ") == "t q2 energy", "names of what is watched", table.concat(watched.columns, " "))
local function free(_, v) return v:dot(v) / 2 end
ok(table.concat(dm.system({ Q = dm.R(2), coordinates = handed_out { "x", "y" }, L = free }).coordinates, " ") == "x y", "coordinates")
local file = os.tmpname()
local handle = assert(io.open(file, "w"))
handle:write "1 2\n3 4\n"
handle:close()
near(dm.load(file, { names = handed_out { "a", "b" } }).b[2], 4, 0, "names of a file's columns")
os.remove(file)
near(dm.sweep({ members = 2, workers = 1, run = function(i) return handed_out { i, 2 * i } end }).x2[2], 4, 0, "what a member of a sweep gives")
ok(core.unlocked(handed_out { 7 })[1] == 7 and type(core.unlocked(path.columns)) == "table", "unlocked they are tables")
local again = dm.system(system.given)
ok(again.L == system.L and again:solver({ rule = "verlet", h = 0.1 }):run(start).q[21] == path.q[21], "a system of the options of another one")
tap.done()
