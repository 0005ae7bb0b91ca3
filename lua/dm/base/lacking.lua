--- What a class does not have that its fellow with coordinates q and momenta has: such a method
-- raises with the reason, or with what serves instead.
local blame = require "dm.base.blame"

local M = {}

local GENERAL = "it is one of coordinates q and their momenta"

local function refuse(what, name, why)
  return blame.caller(function() error(("a %s has no '%s': %s"):format(what, name, why), 0) end)
end

--- The metatable `class` (begun by core.class) refuses the methods of of.fellow ("dm.path") that it
-- has not. of: { fellow, what (it is called so), why (else), reasons = { method = why } }.
function M.refuse(class, of)
  local index, reasons = class.__index, of.reasons or {}
  class.__index = function(object, key)
    local value = index(object, key)
    if value ~= nil or type(key) ~= "string" then return value end
    local methods = debug.getregistry()[of.fellow].methods
    if methods[key] then return refuse(of.what, key, reasons[key] or of.why or GENERAL) end
  end
end

return M
