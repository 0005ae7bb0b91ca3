-- the standard library under dmlua answers as under lua5.4: names, math on all kinds of arguments,
-- messages of its errors
local tap = require "tap"

local probe = [==[
local values = { 0, 1, -1, 3, 7, 2.5, -2.5, 1e300, 1 / 0, -1 / 0, 0 / 0, math.maxinteger, math.mininteger, 2^53, 1e-320,
  "10", "0x10", " 2.5 ",
  "x", "", true, false, {}, print }
local names = {}
for name in pairs(math) do names[#names + 1] = name end
table.sort(names)
local function shown(...)
  local t = table.pack(...)
  for i = 1, t.n do
    local v = t[i]
    if type(v) == "number" then v = v ~= v and "nan" or ("%q"):format(v) end
    t[i] = type(v) == "string" and v:gsub("0x%x+", "ADDRESS") or type(v)
  end
  return table.concat(t, " ", 1, t.n)
end
for _, name in ipairs(names) do
  local f = math[name]
  if type(f) ~= "function" then print(name, shown(f)) end
  if type(f) == "function" and not name:find "^random" then
    print(name, shown(pcall(f)))
    for i, a in ipairs(values) do
      print(name, i, shown(pcall(f, a)))
      print(name, i, "method", shown(pcall(function() return math[name](a) end)))
      for j, b in ipairs(values) do print(name, i, j, shown(pcall(f, a, b))) end
    end
    print(name, shown(pcall(f, 1, 2, 3, 4, 5)))
  end
end
math.randomseed(42)
print(math.random(), math.random(10), math.random(5, 8), math.random(0))
local libraries = {}
for name, library in pairs(_G) do
  if type(library) == "table" and name ~= "dm" and name ~= "arg" then libraries[#libraries + 1] = name end
  if name ~= "dm" then libraries[#libraries + 1] = name end
end
table.sort(libraries)
for _, name in ipairs(libraries) do
  local inside = {}
  if type(_G[name]) == "table" and name ~= "_G" then for key in pairs(_G[name]) do inside[#inside + 1] = tostring(key) end end
  table.sort(inside)
  print(name, table.concat(inside, " "))
end
print(pcall(string.rep), pcall(setmetatable, 1), pcall(math.floor, {}), select("#", math.modf(3.7)))
print(pcall(require, "nowhere.at.all"))
print(collectgarbage "incremental", collectgarbage "generational")
print(select(2, pcall(function() local x = 1 + {} end)), select(2, pcall(function() return nowhere.x end)))
]==]

local dmlua, lua = os.getenv "DMLUA" or arg[-1], io.popen("command -v lua5.4"):read "l"
local file = os.tmpname()
local handle = assert(io.open(file, "w"))
handle:write(probe)
handle:close()

local function lines(program)
  local list, pipe = {}, io.popen(program .. " " .. file .. " 2>&1")
  -- where math.atan2 is math.atan, a message may name either
  for line in pipe:lines() do list[#list + 1] = (line:gsub("math%.atan2", "math.atan")) end
  pipe:close()
  return list
end

if not lua then
  print "1..0 # SKIP no lua5.4 to compare with"
  os.exit()
end
local ours, theirs = lines(dmlua), lines(lua)
local different, first = 0, nil
for i = 1, math.max(#ours, #theirs) do
  if ours[i] ~= theirs[i] then
    different = different + 1
    first = first or ("line %d\n# dmlua:  %s\n# lua5.4: %s"):format(i, ours[i], theirs[i])
  end
end
tap.ok(#theirs > 5000, "thousands of calls are compared", #theirs)
tap.ok(different == 0, "every answer is that of lua5.4", ("%d lines differ; %s"):format(different, first))
os.remove(file)
tap.done()
