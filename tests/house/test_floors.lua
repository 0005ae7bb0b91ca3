-- Floors: every folder asks only folders below it (floors.lua says which those are); only bind and cli see
-- lua.h; only cli sees readline.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local tree = require "tree"
local floors = require "floors"

local function count(arrows)
  local n = 0
  for _, to in pairs(arrows) do for _ in pairs(to) do n = n + 1 end end
  return n
end

-- folders that hold files and have no place, and places that have no folder
local function places(top, list)
  local there, wrong, height = {}, {}, {}
  for i, name in ipairs(list) do height[top .. "/" .. name] = i end
  for _, file in ipairs(tree.files(".", top)) do
    local at = file:match "^(.*)/"
    if not height[at] and not there[at] and file ~= "lua/dm/init.lua" then wrong[#wrong + 1] = at .. " has no floor in floors.lua" end
    there[at] = true
  end
  for name in pairs(height) do if not there[name] then wrong[#wrong + 1] = name .. " is no folder" end end
  return height, wrong
end

local allowed = {}
for _, row in ipairs(floors.up) do allowed[table.concat(row, " ", 1, 3)] = row[4] end

-- the arrows that point up, without those that are let pass
local function up(how, top, arrows, height)
  local wrong = {}
  for from, list in pairs(arrows) do
    for to, why in pairs(list) do
      if height[from] and height[to] and height[to] > height[from] then
        local key = ("%s %s %s"):format(how, from:sub(#top + 2), to:sub(#top + 2))
        if allowed[key] then allowed[key] = true
        else wrong[#wrong + 1] = ("%s asks %s: %s"):format(from, to, why[1]) end
      end
    end
  end
  return wrong
end

-- the folders of a room of the first level stand together: then rooms have floors as well
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

local height, wrong = places("src", floors.src)
house.check("every folder of src has its floor", wrong)
house.check("the folders of a room of src stand together", scattered(floors.src))
local includes = tree.by_includes(".")
house.check("there are includes to look at", count(includes) > 20 and {} or { count(includes) .. " found" })
house.check("every #include points down", up("include", "src", includes, height))
if house.under == "" then
  local calls = tree.by_symbols(".", house.build)
  house.check("there are symbols to look at", count(calls) > 20 and {} or { count(calls) .. " arrows found" })
  house.check("every call points down", up("call", "src", calls, height))
end

local lua_height, homeless = places("lua/dm", floors.lua)
house.check("every folder of lua/dm has its floor", homeless)
local requires = tree.by_requires "."
house.check("there are requires to look at", count(requires) > 5 and {} or { count(requires) .. " found" })
house.check("every require points down", up("require", "lua/dm", requires, lua_height))

local idle = {}
for key, why in pairs(allowed) do
  if why ~= true and (house.under == "" or not key:find "^call") then idle[#idle + 1] = key .. ": take its row out of floors.lua" end
end
house.check("every arrow that is let pass is there", idle)

local strangers, lua, readline = {}, {}, {}
for _, line in ipairs(house.lines "grep -rnE '^ *# *include' src") do
  local room, header = line:match "^src/(%w+)/", line:match "[<\"](.-)[>\"]"
  local there = line:find '"' and io.open("src/" .. header)
  if there then there:close() elseif line:find '"' then strangers[#strangers + 1] = line end
  if header:find "^l?[ua][ualib]+x?%.h$" and room ~= "bind" and room ~= "cli" then lua[#lua + 1] = line end
  if header:find "^readline/" and room ~= "cli" then readline[#readline + 1] = line end
end
house.check("every include of the project names a file from src on", strangers)
house.check("only bind and cli see lua.h", lua)
house.check("only cli sees readline", readline)
house.finish()
