-- Every #include names its room and points down or sideways; only bind and cli see lua.h; only cli
-- sees readline.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

local floors = { "base", "linalg", "solve", "expr", "geom", "action", "mech", "integ", "run", "bind", "cli" }
local height = {}
for i, room in ipairs(floors) do height[room] = i end

local unknown, up, lua, readline, homeless = {}, {}, {}, {}, {}
local includes = house.lines "grep -rnE '^ *#include' src"
for _, line in ipairs(includes) do
  local room, header = line:match "^src/(%w+)/", line:match "[<\"](.-)[>\"]"
  local quoted = line:find '"'
  local from, to = height[room], height[header:match "^(%w+)/"]
  if not from then
    unknown[#unknown + 1] = line
  else
    if quoted and not to then homeless[#homeless + 1] = line end
    if to and to > from then up[#up + 1] = line end
    if header:find "^l?[ua][ualib]+x?%.h$" and from < height.bind then lua[#lua + 1] = line end
    if header:find "^readline/" and room ~= "cli" then readline[#readline + 1] = line end
  end
end
house.check("there are includes to look at", #includes > 20 and {} or { #includes .. " found" })
house.check("every folder of src is a room of the house", unknown)
house.check("every include of the project names its room", homeless)
house.check("every include points down or sideways", up)
house.check("only bind and cli see lua.h", lua)
house.check("only cli sees readline", readline)
house.finish()
