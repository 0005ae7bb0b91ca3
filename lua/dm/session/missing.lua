--- Errors about a nil say which name or index was asked for in vain, and the nearest there is.
local core = require "dm.core"
local variable = require "dm.session.variable"

local M = {}

local getregistry = debug.getregistry
local next, type, tonumber, find, match = next, type, tonumber, string.find, string.match
local OWN = { params = "the table of params", dm = "dm" }
local MOST = 12  -- names that are listed
local FEW = 4    -- classes that are
local FIRST = { ["dm.solver"] = 1, ["dm.path"] = 2, ["dm.system"] = 3 } -- of these

local function sorted(list)
  table.sort(list)
  return list
end

-- names of methods and documented fields of a class, of dm, or of the parameters
local function names_of(note)
  if not note.names then return sorted(require "dm.session.complete".names_of(note.of)) end
  local names = {}
  for name in next, note.names do
    names[#names + 1] = type(name) == "string" and not find(name, "^_") and name or nil
  end
  return sorted(names)
end

-- the classes that have this method, by name, joined; nil for none
local function owners(name)
  local complete, found = require "dm.session.complete", {}
  getmetatable(require "dm").load_all()  -- some classes come with a module
  for class in next, core.docs do
    if type(class) == "string" and (complete.methods_of(class) or {})[name] then
      found[#found + 1] = class
    end
  end
  table.sort(found, function(a, b)
    local first, second = FIRST[a] or 4, FIRST[b] or 4
    if first ~= second then return first < second end
    return a < b
  end)
  local rest = #found - FEW
  return #found > 0 and table.concat(found, ", ", 1, math.min(#found, FEW))
    .. (rest > 0 and (" and %d more"):format(rest) or "") or nil
end

-- what takes no step itself, and how a solver of it is made
local SOLVERS = { ["dm.system"] = "system:solver { rule =, h = }",
  ["dm.discrete_lagrangian"] = "Ld:solver {}" }

local function of_solver(note)
  return SOLVERS[note.of] and (require "dm.session.complete".methods_of "dm.solver"
    or {})[note.key]
end

-- what is no field, but made when it is asked for
local MADE = { ["dm.path"] = { v = "path:velocity()" } }

local function what_there_is(note)
  local names = names_of(note)
  local made = (MADE[note.of] or {})[note.key]
  if made then return "; it is " .. made end
  if note.of == "dm.path" and tonumber(note.key) then
    return ("; rows are those of its columns: path.q[%s], path.t[%s]"):format(note.key, note.key)
  end
  local near = core.nearest(note.key, names)
  if near == note.key then  -- a field that comes later, as scene.best with scene:run()
    return (", or not yet: ?%s says when it is there"):format(note.of)
  end
  if near then return ("; did you mean '%s'?"):format(near) end
  if of_solver(note) then
    return ("; a solver of it has: %s:%s"):format(SOLVERS[note.of], note.key)
  end
  local here = note.of ~= "dm" and rawget(require "dm", note.key)
  if type(here) == "function" and not math[note.key] then
    return ("; it is dm.%s, a function"):format(note.key)
  end
  local other = owners(note.key)
  if other then return ("; it is a method of %s"):format(other) end
  if #names == 0 then return "" end
  local entries = note.of == "dm.vector" and "; its entries are [1], [2], ...; beside them" or ":"
  if #names <= MOST then return entries .. " there is " .. table.concat(names, ", ") end
  return note.of == "dm" and "; help(dm) lists what there is" or "; help(x) lists what there is"
end

local function explained(note)
  if math.type(note.key) == "integer" then
    return ("%s has no entry %d"):format(note.of, note.key)
  end
  local of = OWN[note.of] or "a " .. note.of
  return ("%s has no '%s'%s"):format(of, note.key, what_there_is(note))
end

-- does the message speak of that nil? Its name, or that of an index, and a line that is the same
-- or, of a name, near
local function is_about(note, message)
  local source, line, rest = match(message, "^([^\n]-):(%d+): ([^\n]*)")
  if source ~= note.source then return false end
  local same = tonumber(line) == note.line
  if find(rest, "cannot compute nil", 1, true) or find(rest, "^cannot compute .* nil$") then
    return same
  end
  local name = find(rest, "a nil value", 1, true) and match(rest, "%(%a+ '([^']*)'%)")
  return name == note.key or same and (name == nil or name == "integer index" or name == "?")
    and find(rest, "a nil value", 1, true) ~= nil
end

-- functions and modules of other languages, and what stands for them
local ELSEWHERE = { len = "#x", range = "for i = 1, n do ... end", enumerate = "ipairs(x)",
  str = "tostring(x)", int = "x // 1", float = "tonumber(x)", sum = "x:sum(), of a vector",
  np = "math and dm", numpy = "math and dm", plt = "dm.plot", array = "dm.vector { 1, 2 }",
  norm = "x:norm(), of a vector", dot = "a:dot(b), of vectors", cross = "a:cross(b), of vectors",
  zeros = "dm.zeros(n)", linspace = "a loop: for i = 1, n do ... end" }

-- the message, the hint behind it once: what f of a user raised inside a run comes by twice
local function with(message, hint)
  return find(message, hint, 1, true) and message or message .. hint
end

-- a global that is not there but in math or dm, as sin and pi are: where it is
local function of_library(message)
  local name = find(message, "a nil value", 1, true)
    and match(message, "%(global '([%a_][%w_]*)'%)")
  if not name or find(name, "^_") then return message end
  local where = math[name] ~= nil and "math" or find(message, "attempt to call", 1, true)
    and core[name] ~= nil and "dm"
  local hint = where and (": it is %s.%s"):format(where, name)
    or ELSEWHERE[name] and ": here it is " .. ELSEWHERE[name]
  return hint and with(message, hint) or message
end

-- a method that was read like a field, path.energy[1]
local function of_method(message)
  local name = match(message, "a function value %(field '([%a_][%w_]*)'%)")
  return name and owners(name) and with(message, (": it is a method, x:%s(...)"):format(name))
    or message
end

local FAILED = 4  -- level of the function that raised, seen from what the handler calls

-- how the function of that name that raised was called, "method" or "field"; nil: it is not there
local function called_as(name)
  for level = 3, FAILED + 2 do
    local info = debug.getinfo(level, "n")
    if not info or info.name == name then return info and info.namewhat end
  end
end

-- a method in C that was called like a field, v.norm()
local function of_colon(message)
  local name = match(message, "bad argument #[12] to '([%a_][%w_]*)' %([^\n]*got no value%)$")
  if not name or called_as(name) ~= "field" or not owners(name) then return message end
  return with(message, ("; a method is called with a colon, x:%s(...)"):format(name))
end

-- a parameter that the caller, a function of dm, gave nothing for: L of (x, y, vx, vy)
local function of_parameter(message)
  local name = match(message, "a nil value %(local '([%a_][%w_]*)'%)")
  local f, caller = debug.getinfo(FAILED, "Su"), debug.getinfo(FAILED + 1, "S")
  if not name or not caller or caller.what ~= "C" or f.what ~= "Lua" then return "" end
  local place, given = 0, 0
  for i = 1, f.nparams do
    local parameter, value = debug.getlocal(FAILED, i)
    if parameter == name then place = i end
    if value ~= nil then given = i end
  end
  if given >= place then return "" end
  return (": it is argument %d of a function that is called with %d (q and v of a system are one "
    .. "vector each: q[1], q[2]%s)"):format(place, given,
    place == 4 and given == 3 and "; the fourth is the option params = { ... }" or "")
end

--- The message with what was noted about the nil in it, or where a global of that name is; any
-- other message as it is.
function M.explain(message)
  local note = getregistry().dm_missed
  if type(message) ~= "string" then return message end
  if find(message, "arithmetic on a dm.space value", 1, true) then
    return with(message, ": a product of spaces is dm.product(A, B)")
  end
  local of_nil = find(message, ": cannot compute nil %S+ %S+$")
    or find(message, ": cannot compute [^\n]* nil$")
  local name = of_nil and variable.of_nil(2) or ""
  if not note or not note.of or not is_about(note, message) then
    return of_colon(of_method(of_library(message))) .. name .. of_parameter(message)
  end
  local why = (type(note.key) == "string" or math.type(note.key) == "integer") and explained(note)
  note.of = nil
  if not why then return message .. name end
  if name == " (field '?')" then name = "" end
  return message .. name .. ": " .. why
end

--- That a class has nothing of this name, and what it has.
function M.of(class, key) return explained { of = class, key = key } end

local ENTRY = "stdin"  -- the chunk of what is entered in a session

--- Of an entry that gave nil: the name that is not there, or nothing.
function M.of_entry(entry)
  local note, name = getregistry().dm_missed, match(entry, "^%s*([%a_][%w_]*)%s*$")
  if note and note.of and note.source == ENTRY and type(note.key) == "string" then
    return explained(note)
  end
  if not name then return nil end
  local where = math[name] ~= nil and "math" or core[name] ~= nil and "dm"
  return where and ("%s is %s.%s"):format(name, where, name) or nil
end

--- "path.enrgy": the name that the entry, or a line that runs now, asked for in vain, or nothing.
function M.asked()
  local note, level = getregistry().dm_missed, 2
  if not note or not note.of or type(note.key) ~= "string" then return nil end
  local at = debug.getinfo(level, "Sl")
  while at and note.source ~= ENTRY
    and (at.short_src ~= note.source or at.currentline ~= note.line) do
    level = level + 1
    at = debug.getinfo(level, "Sl")
  end
  return at and ("%s.%s"):format(note.of:gsub("^dm%.", ""), note.key) or nil
end

--- What is noted in words, or nothing.
function M.noted()
  local note = getregistry().dm_missed
  local is_shown = note and note.of and (type(note.key) == "string"
    or math.type(note.key) == "integer")
  return is_shown and explained(note) or nil
end

--- " (global 'K')": what the nil that a function in C got as argument `arg` is called where that is
-- known, and why it is nil where that is.
function M.argument(arg)
  local kind, name = variable.of_argument(2, arg)
  local note = getregistry().dm_missed
  if not name then return "" end
  local text = (" (%s '%s')"):format(kind, name)
  if kind ~= "field" or not note or note.key ~= name or not note.of then
    return text .. (math[name] and kind == "global" and (": it is math.%s"):format(name) or "")
  end
  return text .. ": " .. explained(note)
end

local registry = getregistry()
registry.dm_explain, registry.dm_noted, registry.dm_argument = M.explain, M.noted, M.argument

return M
