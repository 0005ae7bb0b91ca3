--- What an element of a group looks like, in words and as an example, for messages and help.
local kits = require "dm.group.kit"

local M = {}

local LONGEST = 60  -- characters of an example

-- an element as it is written in Lua
local function written(g)
  if type(g) ~= "table" and kits.class_of(g) ~= "dm.vector" and kits.class_of(g) ~= "dm.matrix" then
    return ("%.6g"):format(g)
  end
  local out = {}
  for i = 1, #g do out[i] = written(g[i]) end
  return "{" .. table.concat(out, ", ") .. "}"
end

-- G:exp of a small vector of the algebra
local function near_identity(kit)
  local out = {}
  for k = 1, kit.dimension do out[k] = ("%g"):format(k / 10) end
  return ("G:exp{%s}"):format(table.concat(out, ", "))
end

--- "a matrix of 2 x 2, for instance {{1, 0}, {0, 1}} or G:exp{0.1}", of the kit of a group
function M.of(kit)
  local example, other = written(kit.identity()), near_identity(kit)
  local short = #example <= LONGEST and example
  local long = #other <= LONGEST and other
  local both = short and long and short .. " or " .. long or short or long or "G:identity()"
  return ("%s, for instance %s"):format(kit.form, both)
end

return M
