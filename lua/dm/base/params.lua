--- Parameters of a system: which of them its functions read, and what `system.params` is.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local ALL = {} -- a key that is no name

-- a metatable by which `params` are read, which notes the names, and by ALL that they are
-- enumerated
local function watching(params, seen)
  local function whole(f)
    return function()
      seen[ALL] = true
      return f(params)
    end
  end
  return { __index = function(_, key)
    seen[key] = true
    return params[key]
  end, __pairs = whole(pairs), __len = whole(function(t) return #t end) }
end

-- does code have this text as a constant? One of a length in several bytes may be there
local function has_constant(code, text)
  return #text > 100 or code:find(string.char(#text + 1 | 0x80) .. text, 1, true) ~= nil
end

local mentions

-- does one of the functions that code may call from a table, by their names, or from one in it?
local function is_behind(code, value, text, looked, counts, depth)
  if type(value) == "function" then return mentions(value, text, looked, counts) end
  if type(value) ~= "table" or depth == 0 then return false end
  if rawequal(value, package.loaded.dm) then return false end -- no function of a user
  for key, inner in next, value do
    if type(key) == "string" and has_constant(code, key)
      and is_behind(code, inner, text, looked, counts, depth - 1) then
      return true
    end
  end
  return false
end

local DEPTH = 4 -- of tables in tables: library.forces.spring is a global two deep

-- does code of the function, or of one that it calls by an upvalue or a global, have this text as a
-- constant? counts(f, code): only of such ones
function mentions(f, text, looked, counts)
  if looked[f] then return false end
  looked[f] = true
  local fine, code = blame.try(string.dump, f, true)
  if not fine then return false end -- it is in C
  if has_constant(code, text) and (not counts or counts(f, code)) then return true end
  for k = 1, 255 do
    local name, value = debug.getupvalue(f, k)
    if not name then return false end
    if is_behind(code, value, text, looked, counts, DEPTH) then return true end
  end
end

local OF_PAIRS = { "Ld", "constraint", "rolling", "reaction", "force" }

-- functions by their names, among other things, of a system, a field or a discrete Lagrangian
local function functions_of(system)
  local field = type(system) ~= "table" and system.field -- whose functions are wrapped
  if field or system.given then return field and field.options or system.given end
  local out = {}
  for _, key in ipairs(OF_PAIRS) do out[key] = system[key] end
  return out
end

--- Can a function of the system read this parameter? It has the name in its code: a branch may be
-- taken later.
function M.may_read(system, name)
  local looked = {}
  for _, f in pairs(functions_of(system)) do
    if type(f) == "function" and mentions(f, name, looked) then return true end
  end
  return false
end

-- is value, or one in it under names that code has, one of which is_own holds?
local function is_held(code, value, is_own, depth)
  if is_own(value) then return true end
  if type(value) ~= "table" or depth == 0 or rawequal(value, package.loaded.dm) then
    return false
  end
  for key, inner in next, value do
    if type(key) == "string" and has_constant(code, key)
      and is_held(code, inner, is_own, depth - 1) then
      return true
    end
  end
  return false
end

-- does the function, or one that it calls, name the parameter and have the system, or the table of
-- its params, as an upvalue or a global, or in one?
local function reads_table(f, system, name)
  local params = system.params
  local shown = debug.getmetatable(params)
  local raw = shown and shown.__params
  local function is_own(value)
    return value ~= nil
      and (rawequal(value, system) or rawequal(value, params) or rawequal(value, raw))
  end
  return mentions(f, name, {}, function(g, code)
    for k = 1, 255 do
      local upvalue, value = debug.getupvalue(g, k)
      if not upvalue then return false end
      if is_held(code, value, is_own, DEPTH) then return true end
    end
  end)
end

-- where functions get params: L(q, v, t, params) and those like it; constraint(q, t, params), and
-- force(q, v, t, u, params) beside a control; fields on lines, L(u, ut, ux, x, t, params)
local PLACE, OF_CONSTRAINT, ON_LINES = 4, 3, 6

local function place_of(key, functions, is_line)
  if is_line then return ON_LINES end
  if key == "constraint" then return OF_CONSTRAINT end
  return key == "force" and functions.control and PLACE + 1 or PLACE
end

-- The name of a function of the system, the first one, of which asked(f, takes) holds; takes: does
-- it take params?
local function any_function(system, asked)
  local first
  local is_line, functions = type(system) == "table", functions_of(system)
  for key, f in pairs(functions) do
    local info = type(f) == "function" and debug.getinfo(f, "u")
    local takes = info and (info.isvararg or info.nparams >= place_of(key, functions, is_line))
    if info and (not first or key < first) and asked(f, takes) then first = key end
  end
  return first
end

-- Can a function of the system read this parameter in what it is given?
local function may_be_given(system, name)
  return any_function(system, function(f, takes)
    return takes and mentions(f, name, {}) and not reads_table(f, system, name)
  end)
end

-- a function that takes no params and reads this one elsewhere, whatever others do
local function reads_elsewhere(system, name)
  return any_function(system, function(f, takes)
    return not takes and reads_table(f, system, name)
  end)
end

local NOWHERE = "no function of the system reads it"
local ELSEWHERE = "%s elsewhere, from a table that stays as it is; functions get params as their "
  .. "last argument, as L(q, v, t, params)"
local UNREAD = NOWHERE .. ": '%s' is read"

-- why another value of a parameter that is unread reaches no function, and whether it is read
-- somewhere; nil: it may, in another branch
local function why_nowhere(system, name)
  if may_be_given(system, name) then return nil end
  if not M.may_read(system, name) then return NOWHERE, false end
  return ELSEWHERE:format(UNREAD:format(name)), true
end

--- The first of the names whose other values do not reach all functions of the system that read it,
-- why, and is it read somewhere? unread: those of them that M.unread gave
function M.out_of_reach(system, names, unread)
  for _, name in ipairs(names) do
    local key = reads_elsewhere(system, name)
    if key then return name, ELSEWHERE:format(("'%s' reads it"):format(key)), true end
  end
  for _, name in ipairs(unread) do
    local why, somewhere = why_nowhere(system, name)
    if why then return name, why, somewhere end
  end
end

-- system -> names that its functions have read; ALL: which ones cannot be told
local read = setmetatable({}, { __mode = "k" })

local function left(names, seen)
  local out = {}
  for _, name in ipairs(seen[ALL] and {} or names) do
    if not seen[name] then out[#out + 1] = name end
  end
  return out
end

--- Of the names those that no function of the system has read, the last time while it was traced
-- with these params; none where that cannot be told: they are enumerated, looked at by rawget or
-- next, or not traced. A system is traced only for names that it has not read before.
function M.unread(system, params, names)
  read[system] = read[system] or {}
  local seen = read[system]
  if #left(names, seen) == 0 then return {} end
  if not blame.try(core.trace_with, system, watching(params, seen)) then return {} end
  return left(names, seen)
end

--- A function of the table `watch` that reads one of these parameters from the system, or the table
-- it was made with: its name and that of the parameter; nil where none does. It sees the values of
-- the system, whatever those of members are.
function M.outside(system, watch, names)
  local first, its
  for key, f in pairs(type(watch) == "table" and watch or {}) do
    local asked = type(f) == "function" and not (first and tostring(first) < tostring(key))
    for _, name in ipairs(asked and names or {}) do
      if reads_table(f, system, name) then first, its = key, name end
    end
  end
  return first, its
end

--- Names of parameters, joined: those that are there.
function M.names(params)
  local names = {}
  for name in pairs(params) do names[#names + 1] = tostring(name) end
  table.sort(names)
  return #names > 0 and table.concat(names, ", ") or "none", names
end

-- a name that the system did not have is taken where something reads it
local function check(system, params, name, value)
  local copy = {}
  for key, own in pairs(params) do copy[key] = own end
  copy[name] = value
  if #M.unread(system, copy, { name }) == 0 or M.may_read(system, name) then return end
  local there, names = M.names(params)
  local near = core.nearest(name, names)
  error(("params.%s: no function of this system reads it; its parameters are %s%s"):format(name,
    there, near and ("; did you mean '%s'?"):format(near) or ""), 3)
end

-- why no function of the system can be computed with these params, or nil
local function why_not(system, params)
  local fine, why = blame.try(core.trace_with, system, watching(params, {}))
  return not fine and (type(why) == "string" and why or "no number comes of it") or nil
end

local function shown_value(value)
  if type(value) == "table" then return "a table" end
  return type(value) == "string" and ("%q"):format(value) or tostring(value)
end

-- a number in place of a number is taken, any other value where the functions that could be
-- computed before still can
local function check_value(system, params, key, value)
  if value ~= value then
    error(("params.%s: NaN is no value of a parameter"):format(key), 3)
  end
  if type(params[key]) == "number" then
    if type(value) == "number" then return end
    if type(value) == "string" then
      error(("params.%s = %q: a text in place of the number %s"):format(key, value,
        params[key]), 3)
    end
  end
  local copy = setmetatable({}, getmetatable(params))
  for name, own in next, params do copy[name] = own end
  copy[key] = value
  local why = why_not(system, copy)
  if why and not why_not(system, params) then
    error(("params.%s = %s: the functions of this system cannot be computed with it: %s"):format(
      key, shown_value(value), why), 3)
  end
end

-- table of params -> a function that brings what has changed in another one
local followers = setmetatable({}, { __mode = "k" })

--- refresh() is called before a script sees params.
function M.follow(params, refresh) followers[params] = refresh end

--- Brings what params follow.
function M.refresh(params)
  local refresh = params ~= nil and followers[params]
  if refresh then refresh() end
end

local shown = setmetatable({}, { __mode = "k" })

-- do two stand for one table, as those of systems that share their params?
local function stands_for_same(a, b)
  return debug.getmetatable(a).__params == debug.getmetatable(b).__params
end

--- What `system.params` is: the table that the system was made with, but that a name which nothing
-- reads is refused, and a value with which nothing can be computed. A metatable put there would
-- hide the params.
function M.shown(system, params)
  M.refresh(params)
  if shown[system] then return shown[system] end
  local function fresh()
    M.refresh(params)
    return params
  end
  shown[system] = setmetatable({}, { __name = "dm.params", __metatable = "dm.params",
    __params = params, __eq = stands_for_same,
    __index = followers[params] and function(_, key) return fresh()[key] end or params,
    __pairs = function() return pairs(fresh()) end, __len = function() return #params end,
    __newindex = function(_, key, value)
      M.refresh(params)
      if type(key) == "string" and value ~= nil and params[key] == nil then
        check(system, params, key, value)
      end
      if params[key] ~= value then check_value(system, params, key, value) end
      params[key] = value
    end })
  return shown[system]
end

return M
