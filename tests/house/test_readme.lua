-- README's session is typed into the interpreter and must answer what is printed there (figures of
-- time aside); the files that it names are there.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local readme = house.read "README.md"

-- "12.3 ns/step" and the like differ from machine to machine, the last digits from version to version
local function timeless(text)
  return (text:gsub("%S+ [num]?s/step", "(T/step"):gsub("%d+%.%d+", function(x) return ("%.9g"):format(x) end)
    :gsub("%s+$", ""))
end

local session = readme:match "```text\n%$ build/dmlua\n(.-)```"
local typed = {}
for line in (session or ""):gmatch "[^\n]+" do typed[#typed + 1] = line:match "^> (.*)$" end
local script = os.tmpname()
do
  local f <close> = assert(io.open(script, "w"))
  f:write(table.concat(typed, "\n"), "\n")
end
-- -i on what is no terminal: prompts, entries and answers are written as a terminal shows them
local text = house.output(("NO_COLOR=1 TERM=dumb COLUMNS=200 HOME=/nowhere '%s' -q -n -i <%s"):format(house.dmlua, script))
os.remove(script)
local got, want = timeless(text:gsub("> %s*$", "")), timeless(session or "")
house.check("README has a session of about ten lines", #typed >= 4 and {} or { #typed .. " entries" })
house.check("its answers are what the interpreter says", got == want and {} or { "answered:\n" .. got, "printed:\n" .. want })

-- its scripts leave out what is told elsewhere, but are Lua; the calls that are whole name options that there are
local broken = {}
for block in readme:gmatch "```lua\n(.-)```" do
  local chunk, why = load((block:gsub("%.%.%. end", "end")), "=README")
  if not chunk then broken[#broken + 1] = why end
end
house.check("its scripts are Lua", broken)
local dm = require "dm"
local map = readme:match "(dm%.stability %b{})"
local spring = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p) return (v[1] ^ 2 - p.k * q[1] ^ 2) / 2 end }
local drawn, what = pcall(load("local dm, spring = ... return " .. tostring(map)), dm, spring)
house.check("its stability map can be had", drawn and {} or { tostring(what) })

local missing = {}
for file in readme:gmatch "%]%(([%w_./-]+)%)" do
  local f = io.open(file)
  if f then f:close() else missing[#missing + 1] = file end
end
house.check("every link of README leads to a file", missing)
house.finish()
