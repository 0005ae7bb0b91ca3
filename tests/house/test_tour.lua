-- docs/tour.md: everything that it types answers what is printed there (times and last digits aside), its scripts run, its links lead
-- somewhere.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local tour = house.read "docs/tour.md"

-- "12.3 ns/step" differs from machine to machine, digits beyond the ninth from processor to processor
local function timeless(text)
  return (text:gsub("%S+ [num]?s/step", "(T/step"):gsub("%d+%.%d+", function(x) return ("%.9g"):format(x) end):gsub("%s+$", ""))
end

local function written(text)
  local name = os.tmpname()
  local file <close> = assert(io.open(name, "w"))
  file:write(text)
  return name
end

-- one session from the first block to the last
local typed, printed, blocks = {}, {}, 0
for block in tour:gmatch "```text\n(.-)```" do
  blocks = blocks + 1
  for line in block:gmatch "[^\n]+" do
    typed[#typed + 1] = line:match "^>>? (.*)$"
    if not line:find "^%$ " then printed[#printed + 1] = line end
  end
end
local session = written(table.concat(typed, "\n") .. "\n")
local text = house.output(("NO_COLOR=1 TERM=dumb COLUMNS=200 HOME=/nowhere '%s' -q -n -i <%s"):format(house.dmlua, session))
os.remove(session)
local differences, got = {}, {}
for line in timeless(text:gsub("> %s*$", "")):gmatch "[^\n]+" do got[#got + 1] = line end
for i = 1, math.max(#got, #printed) do
  local want = printed[i] and timeless(printed[i])
  if got[i] ~= want and (got[i] or ""):gsub("%s+$", "") ~= want then
    differences[#differences + 1] = ("printed: %s   answered: %s"):format(tostring(want), tostring(got[i]))
    break  -- what follows is shifted
  end
end
house.check("the tour types a good deal", #typed > 60 and blocks > 10 and {} or { #typed .. " entries" })
house.check("and its answers are what the interpreter says", differences)

local broken, scripts = {}, 0
for script in tour:gmatch "```lua\n(.-)```" do
  scripts = scripts + 1
  local file = written(script)
  local out, fine = house.output(("'%s' %s"):format(house.dmlua, file))
  os.remove(file)
  if not fine then broken[#broken + 1] = out end
end
house.check("its scripts run", scripts > 0 and broken or { "no script" })

local other = tour:gsub("```text\n.-```", ""):gsub("```lua\n.-```", "")
house.check("no block of another kind stays unread", other:find "```" and { other:match "```[^\n]*" } or {})
local missing = {}
for file in tour:gmatch "%]%(([%w_./-]+)%)" do
  local f = io.open("docs/" .. file)
  if f then f:close() else missing[#missing + 1] = file end
end
house.check("every link and picture is there", missing)
house.finish()
