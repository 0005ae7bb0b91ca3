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

local missing = {}
for file in readme:gmatch "%]%(([%w_./-]+)%)" do
  local f = io.open(file)
  if f then f:close() else missing[#missing + 1] = file end
end
house.check("every link of README leads to a file", missing)
house.finish()
