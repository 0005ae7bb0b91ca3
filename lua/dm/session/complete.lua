--- Completion: what can stand at the end of a piece of Lua. No code of the user runs: tables are
-- read with rawget and next, methods of userdata are found in their class, results of calls in the
-- docs.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lexer = require "dm.session.lexer"

local M = {}

local next, type, rawget, rawequal, ipairs = next, type, rawget, rawequal, ipairs
local getmetatable, getregistry = debug.getmetatable, debug.getregistry
local match, gmatch, gsub, sub, sort = string.match, string.gmatch, string.gsub, string.sub,
  table.sort
local docs, string_library = core.docs, string

local KEYWORDS = { "and", "break", "do", "else", "elseif", "end", "false", "for", "function",
  "goto",
  "if", "in", "local", "nil", "not", "or", "repeat", "return", "then", "true", "until", "while" }
local is_keyword = {}
for _, word in ipairs(KEYWORDS) do is_keyword[word] = true end

---- what an expression stands for: { value = v }, { class = "dm.path" } or nil ----

local function class_of(value)
  local meta = getmetatable(value)
  local name = type(meta) == "table" and rawget(meta, "__name")
  return type(name) == "string" and name or nil
end

-- methods of a class of the core, as a table
local function methods_of(class)
  local meta = class and getregistry()[class]
  local methods = type(meta) == "table" and rawget(meta, "methods")
  return type(methods) == "table" and methods or nil
end
M.methods_of, M.class_of = methods_of, class_of

local function is_dm(value)
  local loaded = getregistry()._LOADED
  return type(loaded) == "table" and rawequal(rawget(loaded, "dm"), value)
end

-- the table that this one inherits from, or stands for
local function behind(value)
  local meta = getmetatable(value)
  return type(meta) == "table" and (rawget(meta, "__params") or rawget(meta, "__index"))
end

-- a field of a table, or of the tables that it inherits from
local function inherited(value, name)
  for _ = 1, 20 do
    if type(value) ~= "table" then return nil end
    local found = rawget(value, name)
    if found ~= nil then return found end
    if is_dm(value) then return value[name] end
    value = behind(value)
  end
end

-- classes of C whose fields are read without running anything of the user's
local OWN_FIELDS = { ["dm.path"] = true, ["dm.solver"] = true, ["dm.ensemble"] = true,
  ["dm.space"] = true }

local function member(object, name)
  local found
  if object.class then
    found = (methods_of(object.class) or {})[name]
    if found == nil and type(object.value) == "table" then found = rawget(object.value, name) end
    if found == nil and OWN_FIELDS[object.class] and object.value ~= nil then
      local fine, field = blame.try(function() return object.value[name] end)  -- C of ours
      found = fine and field or nil
    end
  elseif type(object.value) == "string" then
    found = string_library[name]
  elseif type(object.value) == "table" then
    found = inherited(object.value, name)
  end
  if found ~= nil then return { value = found } end
end

-- what a documented function returns: the class after -> in its first line
local function result(object)
  local doc = object and type(object.value) == "function" and docs[object.value]
  local class = doc and match(doc, "^[^\n]-%->%s*([%w_.]+)")
  return class and methods_of(class) and { class = class } or nil
end

local CLOSE = { [")"] = "(", ["}"] = "{", ["]"] = "[" }

-- index of the token that opens what tokens[at] closes
local function opening(tokens, at)
  local depth = 0
  for i = at, 1, -1 do
    local t = tokens[i].text
    if tokens[i].kind == "symbol" then
      if CLOSE[t] then depth = depth + 1 end
      if t == "(" or t == "{" or t == "[" then depth = depth - 1 end
    end
    if depth == 0 then return i end
  end
end

local function described(value)
  if value == nil then return nil end
  local class = class_of(value)
  local is_object = type(value) == "userdata" or type(value) == "table" and methods_of(class)
  return { class = is_object and class or nil, value = value }
end

local function normal(object)
  return object and object.value ~= nil and described(object.value) or object
end

local resolve

-- the method of that name of the first class that has one, for a receiver that is not known
local function any_method(name)
  for class in next, docs do
    local found = type(class) == "string" and (methods_of(class) or {})[name]
    if found then return { value = found } end
  end
end

local function resolve_name(tokens, at)
  local name, before = tokens[at].text, tokens[at - 1]
  local access = before and before.kind == "symbol" and (before.text == "." or before.text == ":")
  if not access then
    return not is_keyword[name] and normal { value = inherited(_G, name) } or nil
  end
  local object = at > 2 and resolve(tokens, at - 2)
  local found = object and member(object, name)
  if not found and before.text == ":" and not object then found = any_method(name) end
  return normal(found)
end

-- x[1] or x["key"]
local function resolve_index(tokens, at)
  local open = opening(tokens, at)
  local object = open == at - 2 and open > 1 and resolve(tokens, open - 1)
  if object and object.class == "dm.matrix" then return { class = "dm.vector" } end
  if not object or type(object.value) ~= "table" then return nil end
  local key, kind = tokens[at - 1].text, tokens[at - 1].kind
  if kind == "string" then key = match(key, "^[\"'](.*)[\"']$") end
  if kind == "number" then key = tonumber(key) end
  if kind ~= "string" and kind ~= "number" or key == nil then return nil end
  return normal { value = rawget(object.value, key) }
end

--- The object that the expression ending at tokens[at] stands for.
function resolve(tokens, at)
  local t = tokens[at]
  if t.kind == "name" then return resolve_name(tokens, at) end
  if t.kind == "string" then
    local called = at > 1 and tokens[at - 1].kind == "name" and not is_keyword[tokens[at - 1].text]
    if called then return result(resolve(tokens, at - 1)) end
    return { value = "" }
  end
  if t.text == "]" then return resolve_index(tokens, at) end
  if t.text ~= ")" and t.text ~= "}" then return nil end
  local open = opening(tokens, at)
  local callee = open and open > 1 and tokens[open - 1]
  local called = callee and (callee.kind ~= "symbol" or CLOSE[callee.text])
    and not is_keyword[callee.text]
  if called then return result(resolve(tokens, open - 1)) end
  return open == at - 2 and t.text == ")" and resolve(tokens, at - 1) or nil
end

---- candidates ----

local function add(list, seen, name, start)
  if type(name) ~= "string" or seen[name] or sub(name, 1, #start) ~= start then return end
  if not match(name, "^[%a_][%w_]*$") or is_keyword[name] then return end
  if sub(name, 1, 1) == "_" and start == "" then return end
  seen[name] = true
  list[#list + 1] = name
end

local function add_table(list, seen, value, start, wanted)
  for _ = 1, 20 do
    if type(value) ~= "table" then return end
    for name, v in next, value do
      if not wanted or type(v) == wanted then add(list, seen, name, start) end
    end
    if is_dm(value) then
      return add_table(list, seen, rawget(getmetatable(value), "lazy"), start)
    end
    value = behind(value)
  end
end

-- the fields of an object that is a table
local function add_own(list, seen, value, start)
  for name in next, type(value) == "table" and value or {} do add(list, seen, name, start) end
end

-- names after "fields:" in the doc of a class: "t[i] (number), columns (names); #path rows" -> t,
-- columns
local function add_fields(list, seen, class, start)
  local doc = docs[class]
  local line = type(doc) == "string" and match(doc, "\n%s*fields:([^;]*)") or ""
  line = gsub(gsub(line, "%b()", ""), "%b[]", "")
  for name in gmatch(line, "[%a_][%w_]*") do add(list, seen, name, start) end
end

local function members(object, start, with_colon)
  local list, seen = {}, {}
  if not object then
    if not with_colon then return list end
    for class in next, docs do
      if type(class) == "string" then add_table(list, seen, methods_of(class), start) end
    end
  elseif object.class then
    add_table(list, seen, methods_of(object.class), start)
    if not with_colon then
      add_fields(list, seen, object.class, start)
      add_own(list, seen, object.value, start)
    end
  elseif type(object.value) == "string" then
    add_table(list, seen, string_library, start)
  else
    add_table(list, seen, object.value, start, with_colon and "function" or nil)
  end
  return list
end

--- The names of all methods and documented fields of a class ("dm.path"), or of the table dm
-- ("dm").
function M.names_of(class)
  return members(class == "dm" and { value = require "dm" } or { class = class }, "")
end

local function names(start)
  local list, seen = {}, {}
  add_table(list, seen, _G, start)
  for _, word in ipairs(KEYWORDS) do
    if start ~= "" and sub(word, 1, #start) == start then list[#list + 1] = word end
  end
  return list
end

-- index of the innermost bracket that is still open before tokens[at]
local function enclosing(tokens, at)
  local depth = 0
  for i = at, 1, -1 do
    local t = tokens[i].kind == "symbol" and tokens[i].text
    if CLOSE[t] then depth = depth + 1 end
    if t == "(" or t == "{" or t == "[" then
      if depth == 0 then return i end
      depth = depth - 1
    end
  end
end

-- the signature line of the function that is called by the brace at tokens[open]
local function signature(tokens, open)
  if tokens[open].text ~= "{" then return nil end
  local at = open - 1
  if at > 1 and tokens[at].text == "(" then at = at - 1 end
  while at > 1 and tokens[at].text == "," do -- f(x, {
    local outer = enclosing(tokens, at)
    if not outer or tokens[outer].text ~= "(" then return nil end
    at = outer - 1
  end
  local object = at >= 1 and resolve(tokens, at)
  local doc = object and type(object.value) == "function" and docs[object.value]
  return doc and match(doc, "^[^\n]*")
end

-- option keys "h = " of the call whose braces the cursor is in, when a key can stand here
local function option_keys(tokens, at, start)
  local before = tokens[at]
  if not before or not match(before.text, "^[{,;]$") then return nil end
  local open = enclosing(tokens, at)
  local line = open and signature(tokens, open)
  local inside = line and match(line, "%b{}")
  if not inside then return nil end
  local given, list = {}, {}
  for i = open, at do
    if tokens[i + 1] and tokens[i + 1].text == "=" then given[tokens[i].text] = true end
  end
  for key in gmatch(gsub(sub(inside, 2, -2), "%b{}", ""), "([%a_][%w_]*)%s*=") do
    if not given[key] and sub(key, 1, #start) == start then list[#list + 1] = key .. " = " end
  end
  return #list > 0 and list or nil
end

-- inside of a string: the words that are known to fit; else true, for file names
local function in_string(tokens)
  local words, start, list = require "dm.session.complete_words".words(tokens, resolve, enclosing),
    sub(tokens[#tokens].text, 2), {}
  for _, word in ipairs(words or {}) do
    if sub(word, 1, #start) == start then list[#list + 1] = word end
  end
  sort(list)
  return not words or list
end

--- What can complete the last word of `text`: a list of words, or true for file names, or nil.
function M.candidates(text)
  local tokens, cut = lexer.tokens(text)
  if cut == "comment" then return nil end
  if cut == "string" then return in_string(tokens) end
  local last, start, at = tokens[#tokens], "", #tokens
  if last and last.kind == "number" and last.last == #text then return nil end
  if last and last.kind == "name" and last.last == #text then start, at = last.text, at - 1 end
  local before = tokens[at]
  local access = before and before.kind == "symbol" and match(before.text, "^[.:]$")
  local list
  if access then
    list = members(at > 1 and resolve(tokens, at - 1) or nil, start, access == ":")
  else
    list = option_keys(tokens, at, start) or names(start)
  end
  sort(list)
  return list
end

--- Does an entry end in a ; that is no part of a string or comment?
function M.is_silent(text)
  local tokens = lexer.tokens(text)
  return #tokens > 0 and tokens[#tokens].text == ";"
end

--- The value behind a dotted path such as "dm.solver" or "path.drift", without calling anything.
function M.look_up(text)
  local tokens = lexer.tokens((text:gsub(":", ".")))
  local object = #tokens > 0 and resolve(tokens, #tokens)
  return object or nil
end

return M
