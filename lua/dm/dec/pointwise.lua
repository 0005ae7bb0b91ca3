--- Functions of points, f(x, y, ...), that take the first coordinate for the point are told so.
local blame = require "dm.base.blame"

local M = {}

local RAW = "attempt to index a number value"

--- call(...), which asks a function of a script for values at points of `count` coordinates.
function M.told(count, call, ...)
  local fine, value = blame.try(call, ...)
  if fine then return value end
  if type(value) == "string" and value:find(RAW, 1, true) and count then
    value = ("%s; f(x, y, ...) gets the %d coordinates of a point, numbers"):format(value, count)
  end
  error(value, 0)
end

return M
