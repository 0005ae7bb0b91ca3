--- Tables of options: are their keys known, do they hold what is needed, and the one way to raise.
-- `where` is the function that the user called, as it stands in messages: "dm.chart". Errors carry
-- no position: base/blame.lua, which wraps the functions of dm and of its classes, adds the line of
-- the script. A getter lets an option be left out: it returns `default` then, or nil; `need` is for
-- the others.
local core = require "dm.core"

local M = {}

-- a session prints through this module: what a user makes of these globals does not reach it
local type, next, ipairs, tostring, error = type, next, ipairs, tostring, error
local huge, tointeger, math_type = math.huge, math.tointeger, math.type
local concat, remove, getmetatable = table.concat, table.remove, debug.getmetatable

--- Raises "where: text", the text formatted with what follows it.
function M.fail(where, text, ...) error(("%s: %s"):format(where, text:format(...)), 0) end

--- fail(text, ...) of a module that raises in one name only.
function M.failing(where)
  return function(...) M.fail(where, ...) end
end

--- What was given, in a few words: a number, a text in quotes, nil, or the name of a type.
function M.got(x)
  local kind = type(x)
  if kind == "string" and #x <= 40 then
    local hint = tonumber(x) and ": write it without quotes, or tonumber(text)" or ""
    return ("%q"):format(x):gsub("\n", "n") .. hint
  end
  if kind == "number" or kind == "boolean" or kind == "nil" then return tostring(x) end
  local metatable = getmetatable(x)
  local name = type(metatable) == "table" and metatable.__name
  return type(name) == "string" and name or kind
end

local function is_among(key, known)
  if known.entries and math_type(key) == "integer" then return true end
  for _, name in ipairs(known) do
    if name == key then return true end
  end
  return false
end

-- the names among the known keys: a place, such as 1 for the system, is not listed
local function names_of(known)
  local out = {}
  for _, name in ipairs(known) do
    if type(name) == "string" then out[#out + 1] = name end
  end
  return out
end

local function unknown(key, known, where)
  local names = names_of(known)
  local near = type(key) == "string" and core.nearest(key, names)
  M.fail(where, "unknown option '%s'; %soptions are %s", tostring(key),
    near and ("did you mean '%s'? "):format(near) or "", concat(names, ", "))
end

-- of a name of a picture where its options are meant
local function as_file(t)
  local picture = type(t) == "string" and (t:find "%.png$" or t:find "%.svg$" or t:find "%.pdf$")
  return picture and (": { file = %q }"):format(t) or ""
end

--- The table t itself, once all of its keys are in the list `known` (with known.entries = true also
-- [1], [2], ...); `takes` tells what a call without a table should have given.
function M.check(t, known, where, takes)
  if type(t) ~= "table" then
    M.fail(where, "takes a table %s (got %s)%s", takes or "of options", M.got(t), as_file(t))
  end
  for key in next, t do
    if not is_among(key, known) then unknown(key, known, where) end
  end
  if t[1] ~= nil and t.system ~= nil then
    M.fail(where, "the system is given twice, first and as option 'system'")
  end
  return t
end

--- A copy of options that may be left out and are checked by who takes them.
function M.copy(t, where)
  local out = {}
  if t ~= nil and type(t) ~= "table" then
    M.fail(where, "takes a table of options (got %s)%s", M.got(t), as_file(t))
  end
  for key, value in next, t or {} do out[key] = value end
  return out
end

--- Raises that option `key` must be `what`, where `fine` is not true.
function M.demand(fine, t, key, where, what)
  if not fine then M.fail(where, "option '%s' must be %s (got %s)", key, what, M.got(t[key])) end
end

--- t[key], which may not be left out.
function M.need(t, key, where, what)
  if t[key] == nil then M.fail(where, "option '%s' is missing: %s", key, what) end
  return t[key]
end

--- t[key] if it passes test(value).
function M.passing(t, key, where, test, what, default)
  local x = core.unlocked(t[key])
  if x == nil then return default end
  M.demand(test(x), t, key, where, what)
  return x
end

local function is_finite(x) return type(x) == "number" and x - x == 0 end

--- A finite number, `what` of the messages.
function M.number(t, key, where, what, default)
  return M.passing(t, key, where, is_finite, what or "a finite number", default)
end

--- A finite number > 0: what = "a step", "a duration".
function M.positive(t, key, where, what, default)
  local function is_positive(x) return is_finite(x) and x > 0 end
  return M.passing(t, key, where, is_positive, (what or "a number") .. " > 0", default)
end

--- A number between 0 and 1, both excluded.
function M.fraction(t, key, where, default)
  local function is_fraction(x) return type(x) == "number" and x > 0 and x < 1 end
  return M.passing(t, key, where, is_fraction, "a number between 0 and 1", default)
end

--- A whole number from `least` to `most` (left out: any); 3.0 is 3.
function M.whole(t, key, where, least, most, default)
  local function is_whole(x)
    return type(x) == "number" and tointeger(x) and x >= least and x <= (most or huge)
  end
  local range = most and ("from %.0f to %.0f"):format(least, most) or (">= %.0f"):format(least)
  return tointeger(M.passing(t, key, where, is_whole, "a whole number " .. range, default))
end

--- A function; of = "(q, v, t, p)" tells its arguments.
function M.callable(t, key, where, of)
  local function is_function(x) return type(x) == "function" end
  return M.passing(t, key, where, is_function, of and "a function of " .. of or "a function")
end

--- An object of a class; what = "a group, such as dm.SO(3)".
function M.object(t, key, where, class, what, default)
  local function is_one(x) return M.got(x) == class end
  return M.passing(t, key, where, is_one, what, default)
end

-- what a function gave: one value, `what` of the message
local function one(what, value, ...)
  local more = select("#", ...)
  if more > 0 then
    error(("%s must return one value, not %d: a list of numbers is one as a table, return { a, b }")
      :format(what, more + 1), 0)
  end
  return value
end

--- A function of a script that must return one value: more of them raise instead of being lost.
function M.single(f, what)
  return function(...) return one(what, f(...)) end
end

--- A function of a script that must return one number, symbol or hyper-dual number; `what` begins
-- what is raised.
function M.numeric(f, what)
  local single, registry = M.single(f, what), debug.getregistry()
  return function(...)
    registry.dm_forget()
    local value = single(...)
    local got = M.got(value)
    if type(value) == "number" or got == "dm.symbol" or got == "dm.hyperdual" then return value end
    local why = value == nil and ": " .. (registry.dm_noted() or "is a return missing?") or ""
    error(("%s must return a number, got %s%s"):format(what, got, why), 0)
  end
end

local function is_flag(x) return type(x) == "boolean" end

--- True or false.
function M.flag(t, key, where, default)
  return M.passing(t, key, where, is_flag, "true or false", default)
end

--- Raises that option `key`, where it is given, has no meaning, and why; false asks for nothing.
function M.meaningless(t, key, where, why)
  if t[key] then M.fail(where, "option '%s' has no meaning here: %s", key, why) end
end

--- A text.
function M.text(t, key, where, default)
  local function is_text(x) return type(x) == "string" end
  return M.passing(t, key, where, is_text, "a string", default)
end

--- A table with at least one entry [1]; what = "rules", of the messages.
function M.list(t, key, where, what, default)
  local function is_list(x) return type(x) == "table" and #x > 0 end
  return M.passing(t, key, where, is_list, "a list of " .. what, default)
end

--- One of the texts of a list.
function M.one_of(t, key, where, texts, default)
  local quoted = {}
  for i, text in ipairs(texts) do quoted[i] = '"' .. text .. '"' end
  local last = remove(quoted)
  local what = #quoted > 0 and concat(quoted, ", ") .. " or " .. last or last
  local function is_one(x) return is_among(x, texts) end
  return M.passing(t, key, where, is_one, what, default)
end

return M
