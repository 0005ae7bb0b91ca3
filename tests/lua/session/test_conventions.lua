-- docs/conventions.md: every row of its first table is typed and gives what it says; the statuses of scripts
local tap = require "tap"
local ok = tap.ok
local dmlua = os.getenv "DMLUA" or arg[-1]

local function session(lines)
  local name = os.tmpname()
  local file = assert(io.open(name, "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  local pipe = io.popen(("env -u LUA_INIT HOME=/nonexistent XDG_CONFIG_HOME=/nonexistent '%s' -n -i -q < '%s' 2>&1"):format(dmlua, name))
  local out = pipe:read "a"
  pipe:close()
  os.remove(name)
  return out
end

local rows = 0
local head = io.open "docs/conventions.md":read "a":match "| you type |.-\n\n"
for typed, wanted in head:gmatch "\n| (`[^\n|]-`) |([^\n|]*)|" do
  local lines = {}
  for line in typed:gmatch "`([^`]*)`" do lines[#lines + 1] = line end
  local out = session(lines)
  -- what was printed: prompts and what was typed left out
  local printed = {}
  for line in out:gmatch "[^\n]+" do
    if not line:find "^>>? " or line:find "^>>? *$" then printed[#printed + 1] = line end
  end
  local text = table.concat(printed, "\n")
  local part = wanted:match "`(.*)`"
  ok(part and text:find(part, 1, true) or not part and text:gsub("[>%s]", "") == "", typed, out)
  rows = rows + 1
end
ok(rows >= 19, "all rows were read", rows)

-- rows of the second table: their test is there
local named = 0
for what, file, words in io.open "docs/conventions.md":read "a":gmatch '\n| ([^|]-) | [^|]- | `(test_%a[%w_]*%.lua)`: "([^|]*)" |' do
  local found = io.popen("cat tests/house/" .. file .. " $(find tests/lua -name " .. file .. ") 2>/dev/null")
  ok(found:read "a":find(words, 1, true), "the test of " .. what, file .. ": " .. words)
  found:close()
  named = named + 1
end
local _, all = io.open "docs/conventions.md":read "a":match "\n| what | how | test |\n(.*)":gsub("\n| ", "")
ok(named == all and named >= 19, "every row names one", named .. " of " .. all)

-- statuses
local function status_of(command)
  local pipe = io.popen(command .. "; echo status $?")
  local out = pipe:read "a"
  pipe:close()
  return tonumber(out:match "status (%d+)%s*$")
end
ok(status_of(("'%s' -e 'x = 1' 2>/dev/null"):format(dmlua)) == 0, "0")
ok(status_of(("'%s' -e 'error(1)' 2>/dev/null"):format(dmlua)) == 1, "1 after an error")
ok(status_of(("'%s' -e 'os.exit(7)'"):format(dmlua)) == 7, "os.exit")
-- the signal comes while the code runs, which makes a file first, on a slow machine too
local interrupted = "'%s' -e 'assert(io.open(\"%s\", \"w\")):close() %s' 2>/dev/null & p=$!\n"
  .. "until [ -e '%s' ] || ! kill -0 $p; do sleep 0.1; done; sleep 0.3; kill -%s $p; wait $p"
local run = "dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }:solver { rule = \"verlet\", h = 0.1 }"
  .. ":run { q = {1}, v = {0}, steps = 1e12, every = 1e11 }"
local function interrupted_status(code, signal)
  local name, begun = os.tmpname(), os.tmpname()
  os.remove(begun)
  local file = assert(io.open(name, "w"))
  file:write("set -m\n", interrupted:format(dmlua, begun, code, begun, signal or "INT"), "\n")
  file:close()
  local status = status_of("sh " .. name .. " 2>/dev/null")
  os.remove(name)
  os.remove(begun)
  return status
end
ok(interrupted_status "while true do end" == 130, "130 where Ctrl-C ends a script")
ok(interrupted_status(run) == 130, "also in a C loop")
ok(interrupted_status("while true do end", "TERM") == 143, "143 where it is terminated")
ok(interrupted_status("while true do pcall(function() while true do end end) end", "TERM") == 143,
  "143 where a pcall in a loop catches that")
-- the loop in C answers the signal itself, again and again; the script ends for lack of time where nothing else ends it
ok(interrupted_status("local t = os.time() while os.time() < t + 15 do pcall(function() " .. run .. " end) end", "TERM") == 143,
  "143 where it catches what ends a C loop")
ok(interrupted_status("pcall(function() while true do end end) os.exit(3)") == 3, "a script that deals with it ends as it says")
-- digits, benchmarks
local dm = require "dm"
local pretty = require "dm.session.pretty"
pretty.format "long"
ok(tonumber(dm.pretty(0.1 + 0.2)) == 0.1 + 0.2 and dm.pretty(2.0) == "2.0" and dm.pretty(7) == "7" and dm.pretty(0 / 0):find "nan", "format long")
ok(dm.pretty(dm.matrix { { 1 / 3, 2 } }) == "[[0.33333333333333331, 2]]", "of matrices", dm.pretty(dm.matrix { { 1 / 3, 2 } }))
pretty.format "short"
ok(dm.pretty(1 / 3) == "0.33333333333333", "format short")
tap.raises("format", pretty.format, "wide")
tap.raises("format", pretty.format)
local best, text = dm.bench(function() local s = 0 for i = 1, 1000 do s = s + i end return s end, 3)
ok(best > 0 and best < 1 and text:find "best of 3 x %d+, spread %d+ %%", "dm.bench", text)
tap.raises("a function is needed", dm.bench, 3)
tap.raises("from 2 to 10000", dm.bench, print, 1)
tap.done()
