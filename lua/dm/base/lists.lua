--- Lists of numbers or symbols: tables, vectors and rows of paths alike.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

--- How many entries x has; nothing where it is no list. A text is none, although it has a length.
function M.count(x)
  if type(x) == "string" then return nil end
  local fine, count = blame.try(function() return #x end)
  return fine and count or nil
end

--- A vector or a column of a path as a plain table; anything else as it is.
function M.plain(x)
  local meta = type(x) == "userdata" and debug.getmetatable(x)
  local is_list = meta and (meta.__name == "dm.vector" or meta.__list)
  return is_list and table.move(x, 1, #x, 1, {}) or x
end

--- The middle one of a list of numbers: the size of values that some points have none of, in the
-- units of the user; 0 of an empty list.
function M.middle(list)
  local sorted = table.move(list, 1, #list, 1, {})
  table.sort(sorted)
  return sorted[(#sorted + 1) // 2] or 0
end

--- What messages say was given in place of a list: how many entries it has, or its type.
function M.got(x) return M.count(x) or type(x) end

--- x, a list of any length, as a vector; `what` it is, of messages.
function M.vector(x, what)
  if type(x) == "number" then x = { x } end
  if not M.count(x) then
    error(("%s: a list of numbers is needed (got %s)"):format(what, type(x)), 0)
  end
  return core.vector(x)
end

--- x as a vector of `count` finite numbers or symbols. `text` tells what it must be, with places
-- for `what` it is, the count, a plural s, and what was given.
function M.numbers(what, x, count, text)
  if type(x) == "number" and count == 1 then x = { x } end
  local fine, out = blame.try(core.vector, M.count(x) == count and x or nil)
  if not fine then
    local got = M.count(x) == count and "something else" or M.got(x)
    error(text:format(what, count, count == 1 and "" or "s", got), 0)
  end
  for i = 1, count do
    if type(out[i]) == "number" and not (math.abs(out[i]) < math.huge) then
      error(("%s: entry %d is %s, but must be finite"):format(what, i, out[i]), 0)
    end
  end
  return out
end

--- A table of n zeros; core.zeros makes a vector.
function M.zeros(n)
  local out = {}
  for i = 1, n do out[i] = 0 end
  return out
end

--- What a function returned, a number or a list, as a list.
function M.entries(value)
  if type(value) == "table" then return value end
  local count, out = M.count(value), {}
  if not count then return { value } end
  for i = 1, count do out[i] = value[i] end
  return out
end

--- Entries first + 1 .. first + n of x as a vector.
function M.part(x, first, n)
  local out = {}
  for i = 1, n do out[i] = x[first + i] end
  return core.vector(out)
end

--- Lists or vectors one after the other, as a vector.
function M.joined(...)
  local out, first = {}, 0
  for _, list in ipairs { ... } do
    for i = 1, #list do out[first + i] = list[i] end
    first = first + #list
  end
  return core.vector(out)
end

--- A table with the keys and values of t.
function M.copy(t)
  local out = {}
  for key, value in pairs(t) do out[key] = value end
  return out
end

--- x as an integer, where it is a whole number; a text of digits is none.
function M.whole(x) return type(x) == "number" and math.tointeger(x) or nil end

return M
