--- Annotations for editors (LuaLS): docs/meta/dm.lua, made from the docs that help() prints. A
-- signature names its arguments; what a name stands for is told by the classes that there are.
local core = require "dm.core"
local reference = require "dm.session.reference"

local M = {}

local function sorted(t)
  local keys = {}
  for key in pairs(t) do keys[#keys + 1] = key end
  table.sort(keys)
  return keys
end

-- doc -> first lines with all of the signature, the rest
local function split(doc)
  local signature, text = doc:match "^([^\n]*)\n?(.*)$"
  local function is_open(s)
    local depth = 0
    for sign in s:gmatch "[%(%){}]" do
      depth = depth + ((sign == "(" or sign == "{") and 1 or -1)
    end
    return depth > 0
  end
  while is_open(signature) and text ~= "" do
    local line, rest = text:match "^%s*([^\n]*)\n?(.*)$"
    signature, text = signature .. " " .. line, rest
  end
  return signature, text
end

local PLAIN = { string = "string", number = "number", integer = "integer", boolean = "boolean",
  table = "table", list = "table", text = "string", ["file name"] = "string", ["nil"] = "nil",
  ["true"] = "boolean", ["false"] = "boolean", nothing = "nil", vector = "dm.vector",
  matrix = "dm.matrix" }

-- what a result is, in the words of the annotations
local function type_of(words, classes)
  words = words:match "^%s*(.-)%s*$"
  if classes[words] then return words end
  local first = words:match "^dm%.[%w_]+"
  if first and classes[first] then return first end
  if words:find "^[{]" then return "table" end
  if words:find "^function" or words:find "^f%(" then return "function" end
  return PLAIN[words] or PLAIN[words:match "^[%a]+" or ""] or "any"
end

local function returns_of(signature, classes)
  local result = signature:match "%->%s*(.*)$"
  if not result then return {} end
  result = result:gsub("%s+or%s.*%f[%w]%w+[.:][%w_]+%(.*", "")
  local out = {}
  for one in (result:gsub("%b{}", "{}"):gsub("%b()", "") .. ","):gmatch "([^,]*)," do
    local kinds, seen = {}, {}
    for word in (one:gsub("%s+or%s+", "|") .. "|"):gmatch "([^|]*)|" do
      local kind = type_of(word, classes)
      if not seen[kind] then seen[kind], kinds[#kinds + 1] = true, kind end
    end
    out[#out + 1] = table.concat(kinds, "|")
  end
  return out
end

local KEYWORDS = { ["end"] = true, ["function"] = true, ["for"] = true, ["in"] = true,
  ["local"] = true, ["or"] = true, ["and"] = true, ["not"] = true, ["if"] = true,
  ["repeat"] = true, ["until"] = true, ["then"] = true, ["do"] = true, ["while"] = true,
  ["true"] = true, ["false"] = true, ["nil"] = true, ["return"] = true, ["goto"] = true,
  ["break"] = true, ["else"] = true, ["elseif"] = true }

-- names of the arguments of "f(a, b [, c])" or "f{a=, b=}": a table of options is one argument
local function arguments_of(signature)
  local head = signature:gsub("%s*%->.*$", "")
  local open = head:match "[%({]"
  if open == "{" then return { { name = "options", kind = "table" } } end
  local inside = head:match "%((.*)%)" or ""
  inside = inside:gsub("%b{}", " options "):gsub("%b()", " callback "):gsub("[%[%]]", "")
  local out, seen = {}, {}
  for one in (inside .. ","):gmatch "([^,]*)," do
    local optional = one:find "|%s*nil" ~= nil
    local name = one:match "[%a_][%w_]*"
    if one:find "%.%.%." then
      out[#out + 1] = { name = "...", kind = "any" }
      break
    end
    if name then
      if KEYWORDS[name] then name = name .. "_" end
      while seen[name] do name = name .. "_" end
      seen[name] = true
      out[#out + 1] = { name = name, optional = optional,
        kind = name == "options" and "table" or name == "file" and "string" or "any" }
    end
  end
  return out
end

local function comment(out, text)
  for line in (text:gsub("%s+$", "") .. "\n"):gmatch "([^\n]*)\n" do
    out[#out + 1] = ("---%s"):format(line)
  end
end

-- one function: doc, parameters, returns, an empty body
local function add(out, name, doc, classes)
  local signature, text = split(doc)
  local parameters = {}
  comment(out, signature .. (text ~= "" and "\n\n" .. text or ""))
  for i, a in ipairs(arguments_of(signature)) do
    parameters[i] = a.name
    out[#out + 1] = ("---@param %s %s"):format(a.name == "..." and "..." or a.name .. "?", a.kind)
  end
  for _, kind in ipairs(returns_of(signature, classes)) do out[#out + 1] = "---@return " .. kind end
  out[#out + 1] = ("function %s(%s) end\n"):format(name, table.concat(parameters, ", "))
end

local function is_name(x) return x:find "^[%a_][%w_]*$" and not KEYWORDS[x] end

--- The annotations of everything that `dm` has, as one text.
function M.text(dm)
  local out = { "---@meta dm", "-- Made by `make docs` from what help() prints.\n",
    "---@class dm", "dm = {}\n" }
  local classes, functions = reference.classes(), reference.functions(dm)
  local tables = {}
  for _, name in ipairs(sorted(classes)) do
    comment(out, core.docs[name])
    out[#out + 1] = ("---@class %s"):format(name)
    local variable = name:gsub("[^%w]", "_") .. "_class"
    out[#out + 1] = ("local %s = {}\n"):format(variable)
    for _, method in ipairs(sorted(classes[name])) do
      if is_name(method) then
        add(out, variable .. ":" .. method, core.docs[classes[name][method]] or method, classes)
      end
    end
  end
  for _, name in ipairs(sorted(functions)) do
    local owner, own = name:match "^(.*)%.([^.]*)$"
    if is_name(own) and not name:find "[^%w_.]" then
      if owner ~= "dm" and not tables[owner] then
        tables[owner] = true
        out[#out + 1] = owner .. " = {}\n"
      end
      add(out, name, core.docs[functions[name]] or name, classes)
    end
  end
  out[#out + 1] = "return dm\n"
  return table.concat(out, "\n")
end

--- Write them into a folder as dm.lua.
function M.write(folder)
  local file <close> = assert(io.open(folder .. "/dm.lua", "w"))
  file:write(M.text(require "dm"))
end

return M
