--- What the journal of a sweep says of itself: a list of { key, text }, the kind first. Two calls
-- whose heads are equal have the same members.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local function version()
  local known, manual = blame.try(require, "dm.manual")
  return known and manual.version or "-"
end

--- The head of every kind: what decides bits whatever is swept.
function M.of(kind, members)
  return { { "kind", kind }, { "members", members }, { "version", version() },
    { "processor", core.processor() } }
end

--- A value of an option: numbers with all digits, also of vectors and matrices, tables in a fixed
-- order; of a function what say(function) gives, or that it is one.
function M.text(x, say)
  if type(x) == "number" then return ("%.17g"):format(x) end
  if type(x) == "function" then return say and say(x) or "function" end
  if type(x) == "userdata" then
    local fine, list = blame.try(function() return x:totable() end)
    if fine then x = list end
  end
  if type(x) ~= "table" then return tostring(x) end
  local out = {}
  for i, value in ipairs(x) do out[i] = M.text(value, say) end
  local named = {}
  for key, value in pairs(x) do
    if type(key) == "string" then named[#named + 1] = key .. ":" .. M.text(value, say) end
  end
  table.sort(named)
  table.move(named, 1, #named, #out + 1, out)
  return table.concat(out, " ")
end

return M
