-- examples/read_journal.py reads every kind of journal, by its own reading of docs/sweeps.md
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

if not os.execute "python3 -c 'import struct, zlib' >/dev/null 2>&1" then
  print "1..0 # skipped: python3"
  os.exit(0)
end
local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))
local function name(base) return folder .. "/" .. base end
local function read(file)
  local pipe = io.popen(("python3 examples/read_journal.py '%s' 2>&1"):format(file))
  local out = pipe:read "a"
  pipe:close()
  return out
end
-- the number behind `key` in the line of a member
local function value(text, member, key)
  local line = text:match("\n" .. member .. " ([^\n]*)")
  return line and tonumber(((" " .. line):match(" " .. key .. "=%(?([%-%w.+]+)")))
end

local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.cos(q[1]) end }
local e = pendulum:solver { rule = "verlet", h = 0.1 }:ensemble { members = 300, q = function(i) return { i / 100 } end,
  v = function() return { 0 } end, steps = 30, every = 7, journal = name "e" }
local text = read(name "e")
ok(text:find "kind = ensemble" and text:find "members = 300", "the head", text:sub(1, 200))
ok(value(text, 300, "q") == e.q[300][1] and value(text, 17, "p") == e.p[17][1] and value(text, 17, "steps") == 30, "an ensemble")
local boom = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 4 / 4 end }:solver { rule = "verlet", h = 1 }
local s = dm.sweep { members = 20, journal = name "s", run = function(i)
  if i == 5 then boom:run { q = { 3 }, v = { 0 }, steps = 30 } end
  return { root = i ^ 0.5, b = -i }
end, workers = 1 }
text = read(name "s")
ok(value(text, 7, "root") == 7 ^ 0.5 and value(text, 20, "b") == -20 and #s == 20, "a sweep", text)
ok(text:find "\n5 message='[^\n]*' status='not_finite' step=%d", "a failed member", text)
local m = dm.stability { system = pendulum, rule = "verlet", q = { 1 }, v = { 0 }, steps = 200, h = { 0.1, 2.5, 7, "log" }, journal = name "m" }
text = read(name "m")
ok(value(text, 1, "error") == m:at(1, 1).error and text:find "\n7 class='[^\n]*'" and value(text, 7, "h") == 2.5, "a map", text)
local c = pendulum:chart { q = { 1 }, v = { 0 }, t = 5, rules = { "verlet" }, h = { 0.1, 0.05 }, repeats = 1, rivals = false, journal = name "c" }
text = read(name "c")
ok(value(text, 3, "error") == c.points[2].error and value(text, 3, "ns") == c.points[2].ns, "a chart", text)
-- a damaged record is passed over
local f = assert(io.open(name "e", "r+b"))
f:seek("end", -40)
f:write "XXXX"
f:close()
text = read(name "e")
ok(value(text, 1, "q") == e.q[1][1] and not text:find "\n300 ", "a damaged record is passed over")

-- the simulation of docs/sweeps.md gives the figures of its table
local page = assert(io.open "docs/sweeps.md"):read "a"
local printed = {}
local code = page:match "## On paper.-```lua\n(.-)```"
assert(load(code, "docs/sweeps.md", "t", setmetatable({ print = function(line) printed[#printed + 1] = line end }, { __index = _G })))()
local rows = 0
for _, line in ipairs(printed) do
  if page:find("| " .. line:gsub(" ", " | ") .. " |", 1, true) then rows = rows + 1 end
end
ok(rows == 4 and #printed == 4, "the simulation gives its table", table.concat(printed, "; "))

os.execute(("rm -rf '%s'"):format(folder))
tap.done()
