-- Floors: every folder asks only folders below it (floors.lua says which those are); only bind and
-- cli see lua.h; only cli sees readline.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local tree = require "tree"
local floors = require "floors"

-- the height of every folder; folders that hold files and have none, heights that have no folder
local function heights(top, list)
  local height, there, wrong = {}, {}, {}
  for i, name in ipairs(list) do height[top .. "/" .. name] = i end
  for _, file in ipairs(tree.files(".", top)) do
    local at = file:match "^(.*)/"
    if not height[at] and not there[at] and file ~= "lua/dm/init.lua" then
      wrong[#wrong + 1] = at .. " has no floor in floors.lua"
    end
    there[at] = true
  end
  for name in pairs(height) do
    if not there[name] then wrong[#wrong + 1] = name .. " is no folder" end
  end
  return height, wrong
end

-- rows { how it is seen, from, to, why } as exceptions by place and name
local rows = {}
for i, row in ipairs(floors.up) do rows[i] = { row[1] .. " " .. row[2], row[3], row[4] } end
local let_pass = house.exceptions(rows)

-- the arrows that point up, without those that are let pass
local function up(how, top, arrows, height)
  local wrong = {}
  local function look(from, to, why)
    if not height[from] or not height[to] or height[to] < height[from] then return end
    if let_pass.owed(how .. " " .. from:sub(#top + 2), to:sub(#top + 2)) then return end
    wrong[#wrong + 1] = ("%s asks %s: %s"):format(from, to, why)
  end
  for from, list in pairs(arrows) do
    for to, why in pairs(list) do look(from, to, why[1]) end
  end
  return wrong
end

-- the folders of a room of the first level stand together: so rooms have floors as well
local function scattered(list)
  local closed, last, wrong = {}, nil, {}
  for _, name in ipairs(list) do
    local room = name:match "^[^/]+"
    if room ~= last then
      if closed[room] then wrong[#wrong + 1] = name end
      closed[last or ""] = true
    end
    last = room
  end
  return wrong
end

local height, homeless = heights("src", floors.src)
house.check("every folder of src has its floor", homeless)
house.check("the folders of a room of src stand together", scattered(floors.src))
local includes = tree.by_includes "."
house.enough("there are includes to look at", tree.count(includes), 20)
house.check("every #include points down", up("include", "src", includes, height))
local calls = tree.by_symbols(".", house.build)
house.enough("there are symbols to look at", tree.count(calls), 20)
house.check("every call points down", up("call", "src", calls, height))

height, homeless = heights("lua/dm", floors.lua)
house.check("every folder of lua/dm has its floor", homeless)
local requires = tree.by_requires "."
house.enough("there are requires to look at", tree.count(requires), 5)
house.check("every require points down", up("require", "lua/dm", requires, height))
house.check("every arrow that is let pass is there", let_pass.idle())

local strangers, lua, readline = {}, {}, {}
for _, line in ipairs(house.lines "grep -rnE '^ *# *include' src") do
  local room, header = line:match "^src/(%w+)/", line:match "[<\"](.-)[>\"]"
  local low = room ~= "bind" and room ~= "cli"
  local known = line:find "<" or house.is_there("src/" .. header)
  if not known then strangers[#strangers + 1] = line end
  if low and header:find "^l?[ua][ualib]+x?%.h$" then lua[#lua + 1] = line end
  if room ~= "cli" and header:find "^readline/" then readline[#readline + 1] = line end
end
house.check("every include of the project names a file from src on", strangers)
house.check("only bind and cli see lua.h", lua)
house.check("only cli sees readline", readline)
house.finish()
