--- Errors name the line of the script that called, not a line inside these modules.
local explain = require "dm.missed".explain

local M = {}

-- positions that error and C functions put in front, inside lua/dm
local INSIDE = "^[^\n]-lua/dm/[%w_/]+%.lua:%d+: "

local PLACE = "^[^\n]-:%d+: "

-- a dm.failure whose message names a line in here, or none
local function is_misplaced(value)
  local meta = type(value) == "table" and getmetatable(value)
  return meta and meta.__name == "dm.failure" and (value.message:find(INSIDE) or not value.message:find(PLACE))
end

local function finish(fine, ...)
  if fine then return ... end
  local message = ...
  if type(message) == "string" then message = message:gsub(INSIDE, "") end
  if is_misplaced(message) then message.message = select(2, pcall(error, "", 3)) .. message.message:gsub(INSIDE, "") end
  error(message, 2)  -- the caller: finish took its place by a tail call
end

--- Is it what Ctrl-C raises, in a C loop or between two instructions of Lua? What runs things under pcall passes it on.
function M.is_stop(failure)
  if type(failure) == "string" then return failure:find("interrupted!", 1, true) ~= nil end
  local fine, code = pcall(function() return failure.code end)
  return fine and code == "stopped"
end

--- The dm.failure of a stop by Ctrl-C, also where that came between instructions of Lua and is a string; other errors as they are.
function M.stopped(failure)
  if type(failure) ~= "string" or not M.is_stop(failure) then return failure end
  return setmetatable({ code = "stopped", message = failure }, debug.getregistry()["dm.failure"])
end

--- f, with the position of its caller in its error messages, those of a dm.failure too; other error values pass as they are.
function M.caller(f)
  return function(...) return finish(xpcall(f, explain, ...)) end
end

-- the same around a method written in C, which puts a position in front itself: that of a function of the user stays alone
local function relay(fine, ...)
  local what = ...
  if fine or type(what) ~= "string" then return finish(fine, ...) end
  if what:find(PLACE) and not what:find(INSIDE) then error(what, 0) end
  local method = what:match "bad argument #1 to '(%w+)' %(dm%."
  return finish(fine, method and ("%s; a method is called with a colon, x:%s(...)"):format(what, method) or what)
end

--- f, which calls a method written in C, with the position of its caller in place of one inside these modules.
function M.relay(f)
  return function(...) return relay(xpcall(f, explain, ...)) end
end

return M
