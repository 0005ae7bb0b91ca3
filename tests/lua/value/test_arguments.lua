-- the number of an argument that a message tells is the position that was typed: x:method(a, b) has a in position 1
local tap = require "tap"
local dm = require "dm"
local reference = require "dm.session.reference"
local calls = require "samples"
local path = calls["dm.path"][1][1]
local ok = tap.ok

---- one argument wrong ----

local WRONG = { "no such word", true, 1e99, {}, print, path, { {} }, nil }

local function arity(list)
  local names = {}
  for k = 1, #list do names[k] = "a" .. k end
  return table.concat(names, ", ")
end

-- x:name(...) as someone types it, with a position
local function typed(name, list)
  local names = arity(list)
  return load(("local x%s = ...\nlocal out = table.pack(x:%s(%s))\nreturn table.unpack(out, 1, out.n)"):format(names == "" and "" or ", " .. names, name, names), "=typed")
end

local function text_of(fine, what) return not fine and tostring(what) or nil end

local told, seen, counted = {}, {}, 0

-- results that are meant as lists of numbers; every other table that a method gives prints its entries
local LISTS, bare = { totable = true, flat = true, bonds = true }, {}
local function look(class, name, fine, ...)
  for i = 1, select("#", ...) do
    local value = select(i, ...)
    if fine and type(value) == "table" and not LISTS[name] and tostring(value):find "^table: 0x" then bare[#bare + 1] = class .. ":" .. name end
  end
  return text_of(fine, ...)
end
local function try(class, name, object, list, k, wrong)
  local given = table.move(list, 1, #list, 1, {})
  given[k] = wrong
  local text = text_of(pcall(typed(name, list), object, table.unpack(given, 1, #list)))
  local number = text and tonumber(text:match "argument #(%d+)")
  if not number then return end
  counted = counted + 1
  if number ~= k then told[#told + 1] = ("%s:%s, argument %d = %s: %s"):format(class, name, k, tostring(wrong), text) end
end

for class, list in pairs(calls) do
  for _, row in ipairs(list) do
    for name, arguments in pairs(row) do
      if type(name) == "string" then
        seen[class .. ":" .. name] = true
        local text = look(class, name, pcall(typed(name, arguments), row[1], table.unpack(arguments)))
        ok(not text, ("%s:%s takes what this test calls right"):format(class, name), text)
        for k = 1, #arguments do
          for i = 1, 8 do try(class, name, row[1], arguments, k, WRONG[i]) end
        end
      end
    end
  end
end

ok(#bare == 0, "tables that methods return print themselves", table.concat(bare, ", "))
local function told_by(f, ...) return text_of(pcall(f, ...)) end
ok(told_by(dm.R, "x"):find("to 'dm.R'", 1, true), "a function is told by its name in dm", told_by(dm.R, "x"))
local tail = load("local x = ... return x:momentum(3)", "=tail")
ok(told_by(tail, path):find("#1 to 'momentum' (dm.space", 1, true), "a method in a tail call, as in a session", told_by(tail, path))
ok(told_by(path.momentum, 3):find("a method is called with a colon", 1, true), "a method without its object", told_by(path.momentum, 3))

-- methods whose arguments have places, by their docs, that have no call above: at least a first argument that is wrong
local missing = {}
for class, methods in pairs(reference.classes()) do
  for name, method in pairs(methods) do
    local first = require "dm.core".docs[method]:match "^[^\n]-:[%w_]+%(([^)]*)"
    local placed = first and first:find "%S" and not first:find "^file" and not first:find "^%["
    if placed and not calls[class] then missing[#missing + 1] = class end
    if placed and calls[class] and not seen[class .. ":" .. name] then
      for i = 1, 8 do try(class, name, calls[class][1][1], { false }, 1, WRONG[i]) end
    end
  end
end
---- a table of options in the place of the object, as solver.run { ... } gives it, is refused and left as it was ----

local taken = {}
for class, methods in pairs(reference.classes()) do
  for name in pairs(methods) do
    local written
    local options = setmetatable({}, { __newindex = function(_, key) written = key end })
    local fine, why = pcall(debug.getregistry()[class].methods[name], options)
    local says = not fine and tostring(why):find "bad argument #1 to .*expected, got table" and tostring(why):find(class, 1, true)
    if written or not says then taken[#taken + 1] = class .. ":" .. name .. ": " .. tostring(written or why) end
  end
end
ok(#taken == 0, "methods refuse a table of options in the place of their object", table.concat(taken, "\n# "))

ok(#missing == 0, "every class with such methods is tried", table.concat(missing, ", "))
ok(#told == 0 and counted > 100, ("messages of methods count as one types (%d numbers told)"):format(counted), table.concat(told, "\n# "))
tap.done()
