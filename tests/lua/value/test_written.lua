-- whatever a field of an object hands out, written to, is written there or raises: a copy that takes what is written loses it
local tap = require "tap"
local calls = require "samples"
local core = require "dm.core"
local ok = tap.ok

local NUMBERS = { ["dm.vector"] = true, ["dm.matrix"] = true, ["dm.complex_vector"] = true }

local MOST_DEEP, ENTRIES = 4, 3

local function is_holder(value)
  local meta = debug.getmetatable(value)
  return type(value) == "table" or type(value) == "userdata" and (meta.__name == "dm.vector" or meta.__name == "dm.matrix" or meta.__list == true
    or meta.__len ~= nil)
end

-- another value of the kind of `old`
local function other(old)
  if type(old) == "number" then return old == 9 and 8 or 9 end
  return type(old) == "string" and old .. "?" or 9
end

-- some keys of a table, vector or list
local function keys_of(value)
  local keys = {}
  local fine, count = pcall(function() return #value end)
  for i = 1, math.min(fine and count or 0, ENTRIES) do keys[#keys + 1] = i end
  pcall(function()
    for key in pairs(value) do
      if type(key) == "string" then keys[#keys + 1] = key end
    end
  end)
  return keys
end

-- an object that the caller may change as a whole: docs say that it is his own
local COPIES = { ["dm.complex_vector"] = "path.psi[i] is a copy" }

local lost, raised, written = {}, 0, 0

-- read(): the holder, as a script reads it
local function write(read, key, where)
  local holder = read()
  local fine, old = pcall(function() return holder[key] end)
  if not fine or old == nil then return end
  local meta = debug.getmetatable(holder)
  if meta and COPIES[meta.__name] then return end
  local mark = other(old)
  local is_own = type(holder) ~= "table" or rawget(holder, key) ~= nil or debug.getmetatable(holder).__newindex
  if not pcall(function() holder[key] = mark end) then
    raised = raised + 1
    return
  end
  local there, now = pcall(function() return read()[key] end)
  now = there and now
  if not is_own then rawset(holder, key, nil) end -- what hides the entry does not set it
  if is_own and now == mark or is_own and type(now) == "number" and type(mark) == "number" and math.abs(now - mark) < 1e-12 then
    written = written + 1
  else
    lost[#lost + 1] = where
  end
  pcall(function() holder[key] = old end)
end

-- objects of other classes are walked on their own
local function walk(read, where, depth, open)
  local fine, value = pcall(read)
  if not fine or value == nil or not is_holder(value) or open[value] then return end
  local meta = debug.getmetatable(value)
  if depth > 1 and meta and calls[meta.__name] and not NUMBERS[meta.__name] then return end
  open[value] = true
  for _, key in ipairs(keys_of(value)) do
    local place = where .. (type(key) == "number" and "[" .. key .. "]" or "." .. key)
    write(read, key, place)
    if depth < MOST_DEEP then walk(function() return read()[key] end, place, depth + 1, open) end
  end
  open[value] = nil
end

for class, rows in pairs(calls) do
  for _, row in ipairs(rows) do
    local object = row[1]
    local names = { true } -- [1], what it has itself, and all words of its doc
    for name in pairs(type(object) == "table" and object or {}) do names[name] = true end
    for word in (core.docs[class] or ""):gmatch "[%a_][%w_]*" do names[word] = true end
    for name in pairs(names) do
      local fine, value = pcall(function() return object[name] end)
      if fine and type(value) ~= "function" then
        local place = type(name) == "string" and "." .. name or ("[%s]"):format(name)
        walk(function() return object[name] end, class .. place, 1, {})
      end
    end
  end
end

-- is it a table that the object holds, such as one of chart.points?
local function is_held(value, holder, depth)
  if rawequal(value, holder) then return true end
  for _, entry in next, depth > 0 and type(holder) == "table" and holder or {} do
    if is_held(value, entry, depth - 1) then return true end
  end
  return false
end

-- what a method gives is the caller's own: written to, it changes nothing that is given later
local kept, given = {}, 0
for class, rows in pairs(calls) do
  for _, row in ipairs(rows) do
    for name, arguments in pairs(row) do
      local function call() return row[1][name](row[1], table.unpack(arguments)) end
      local fine, value = pcall(type(name) == "string" and call or error)
      if fine and is_holder(value) and not (type(value) == "table" and is_held(value, row[1], 2)) then
        for _, key in ipairs(keys_of(value)) do
          local there, old = pcall(function() return value[key] end)
          if there and type(old) == "number" and pcall(function() value[key] = old + 9 end) then
            given = given + 1
            local again, now = pcall(function() return call()[key] end)
            if again and now == old + 9 then kept[#kept + 1] = class .. ":" .. name end
            value[key] = old
          end
        end
      end
    end
  end
end
ok(#kept == 0, ("results of methods are the caller's: %d entries"):format(given), table.concat(kept, "\n# "))
ok(#lost == 0, ("fields are written or raise: %d and %d"):format(written, raised), table.concat(lost, "\n# "))
ok(written > 100 and raised > 20, "and there are such", written .. ", " .. raised)
tap.done()
