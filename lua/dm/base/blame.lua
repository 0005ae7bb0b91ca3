--- Errors name the line of the script that called, not a line inside these modules.

-- what an unknown key or global was, in the message (dm.session.missing, which sets it when dm is
-- loaded)
local function explain(message) return debug.getregistry().dm_explain(message) end

local core = require "dm.core"

local getinfo = debug.getinfo

local M = {}

-- positions that error and C functions put in front, inside lua/dm
local INSIDE = "^[^\n]-lua/dm/[%w_/]+%.lua:%d+: "

local PLACE = "^[^\n]-:%d+: "

-- a dm.failure whose message names a line in here, or none
local function is_misplaced(value)
  local meta = type(value) == "table" and getmetatable(value)
  return meta and meta.__name == "dm.failure"
    and (value.message:find(INSIDE) or not value.message:find(PLACE))
end

-- functions that caller made
local wrapped = setmetatable({}, { __mode = "k" })

-- { [class] = name } of the classes that have the method f; nil: it is none
local function owners(f)
  local out
  for class, meta in pairs(debug.getregistry()) do
    local methods = type(class) == "string" and type(meta) == "table" and rawget(meta, "methods")
    for name, method in pairs(type(methods) == "table" and methods or {}) do
      if method == f then
        out = out or {}
        out[class] = name
      end
    end
  end
  return out
end

-- raises where something else is in the place of a method's object: the method would read it, and
-- write into it
local function check_object(classes, object)
  local meta = debug.getmetatable(object)
  local got = type(meta) == "table" and type(meta.__name) == "string" and meta.__name
  if classes[got] then return end
  local class
  for one in pairs(classes) do class = (class == nil or one < class) and one or class end
  local name = classes[class]
  error(("bad argument #1 to '%s' (%s expected, got %s); a method is called with a colon, "
    .. "x:%s(...)"):format(name, class, got or type(object), name), 4)
end

--- A message without a position in here, for another one that quotes it.
function M.bare(message) return (tostring(message):gsub(INSIDE, "")) end

local function finish(fine, ...)
  if fine then return ... end
  local message = ...
  if type(message) == "string" then message = M.bare(message) end
  local _, here = pcall(error, "", 3) -- of the caller: finish took its place by a tail call
  if is_misplaced(message) then message.message = here .. message.message:gsub(INSIDE, "") end
  if type(message) == "string" and here ~= "" and message:sub(1, #here) == here then here = "" end
  error(type(message) == "string" and here .. message or message, 0)
end

--- Is it a stop: what Ctrl-C or the end of core.within raises, in a C loop or between two
-- instructions of Lua?
function M.is_stop(failure)
  if type(failure) == "string" then return failure:find("interrupted!", 1, true) ~= nil end
  local fine, code = pcall(function() return failure.code end)
  return fine and code == "stopped"
end

local function passed(fine, ...)
  if not fine and M.is_stop((...)) then error((...), 0) end
  return fine, ...
end

--- pcall, but for a stop, which passes: for what is tried by code that goes on where it fails. Our
-- modules have pcall only where every error is raised again, or a stop is handed on with what is
-- there; tests/house knows these places.
function M.try(f, ...)
  core.pass_stop() -- what tries things in a loop ends, too
  return passed(pcall(f, ...))
end

--- The dm.failure of a stop by Ctrl-C, also where that came between instructions of Lua and is a
-- string; other errors as they are.
function M.stopped(failure)
  if type(failure) ~= "string" or not M.is_stop(failure) then return failure end
  return setmetatable({ code = "stopped", message = failure }, debug.getregistry()["dm.failure"])
end

-- the signature that begins a doc, without results; a long one has a second line
local function signature(doc)
  local line = doc:match "^[^\n]*"
  if not line:find " %->" then line = doc:match("^[^\n]*\n[^\n]*"):gsub("\n%s*", " ") end
  return (line:gsub(" %->.*", ""))
end

local function refuse_surplus(doc, most)
  local name = doc:match "[:.]?([%w_]+)%s*[({]" or "?"
  local number = doc:match "^[%w_]+:" and most or most + 1
  error(("bad argument #%d to '%s' (a surplus argument: %s)")
    :format(number, name, signature(doc)), 4)
end

-- A check of how many arguments `call` is given: as many as its doc allows, or that of the method
-- that stands for it; nil behind them is no argument. A method's first one is of its class, unless
-- `call` is nil: what stands behind it checks that. The doc is there when it is first called.
local function counter(doc_of, call)
  local most, doc, classes
  return function(...)
    if not most then
      doc = doc_of()
      most = doc and core.arity(doc) or math.huge
      classes = call and doc and doc:find "^[%w_]+:" and owners(call)
    end
    local n = select("#", ...)
    while n > most and (select(n, ...)) == nil do n = n - 1 end
    if n > most then refuse_surplus(doc, most) end
    if classes then check_object(classes, (...)) end
  end
end

--- f, with the position of its caller in its error messages, those of a dm.failure too; other error
-- values pass as they are.
function M.caller(f)
  local check
  local function call(...)
    check(...)
    return finish(xpcall(f, explain, ...))
  end
  check = counter(function() return core.docs[call] or core.docs[f] end, call)
  wrapped[call] = true
  return call
end

--- Is f one that M.caller made?
function M.is_caller(f) return wrapped[f] == true end

-- the same around a method written in C, which puts a position in front itself: that of a function
-- of the user stays alone
local function relay(fine, ...)
  local what = ...
  if fine or type(what) ~= "string" then return finish(fine, ...) end
  if what:find(PLACE) and not what:find(INSIDE) then error(what, 0) end
  return finish(fine, what)
end

-- was the method `call` called with a colon? A tail call, as that of a session, hides it: a colon
-- is likelier
local function has_colon(call)
  for level = 3, 100 do
    local info = getinfo(level, "fnt")
    if not info then return false end
    if info.func == call then return info.namewhat == "method" or info.istailcall end
  end
end

--- f, which calls the method `name` written in C, with the position of its caller in place of one
-- inside these modules, and arguments counted from the first one behind the colon, as Lua does
-- where C is called directly.
function M.relay(f, name)
  local bad = "bad argument #(%d+) to '" .. name .. "'"
  local call
  local function look(what)
    what = explain(what)
    local number = type(what) == "string" and tonumber(what:match(bad))
    if number == 1 then
      local hint = ("; a method is called with a colon, x:%s(...)"):format(name)
      return what:sub(-#hint) == hint and what or what .. hint -- a method may call its namesake
    end
    if not number or not has_colon(call) then return what end
    return (what:gsub(bad, ("bad argument #%d to '%s'"):format(number - 1, name), 1))
  end
  local check = counter(function() return core.docs[call] end)
  call = function(...)
    check(...)
    return relay(xpcall(f, look, ...))
  end
  return call
end

return M
