-- A walk over all that scripts can reach, the list of tests/fuzz, with what is of a wrong type: as the first and second argument,
-- as the object of a method, and in place of every field of right options. What is raised are sentences of dmlua, or Lua's
-- "bad argument" with its number: never what Lua says of a nil inside dmlua.
-- Calls write files: all of it runs in a folder of its own.
if not os.getenv "IN_FOLDER" then
  local here = io.popen("pwd"):read "l"
  local folder = os.tmpname()
  local program = (os.getenv "DMLUA" or "build/dmlua"):gsub("^[^/]", here .. "/%0")
  local fine = os.execute(("rm -f %s && mkdir %s && cd %s && IN_FOLDER=%s LUA_PATH='%s/tests/lua/?.lua;;' '%s' '%s/%s'")
    :format(folder, folder, folder, here, here, program, here, arg[0]))
  os.execute("rm -r " .. folder)
  os.exit(fine == true)
end
package.path = os.getenv "IN_FOLDER" .. "/tests/fuzz/?.lua;" .. package.path
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local said = print
print = function() end -- luacheck: ignore
local stdout = io.stdout
io.stdout = assert(io.open("/dev/null", "w")) -- luacheck: ignore
io.output(io.stdout)

local class_of = require("values").class_of
local calls, objects = require("calls").list(), {}
for _, x in ipairs(require("objects").list()) do
  local class = class_of(x)
  if class then objects[class] = objects[class] or x end
end

local WRONG = { { "2", 2 }, { "0.5", 0.5 }, { "-1", -1 }, { "nan", 0 / 0 }, { "a string", "x" }, { "true", true }, { "nil" }, { "{}", {} },
  { "{1, 2}", { 1, 2 } }, { "{q = 1}", { q = 1 } }, { "a function", function(x) return x end }, { "a vector", dm.vector { 1, 2 } },
  { "a matrix", dm.matrix { { 1, 2 }, { 3, 4 } } }, { "a space", dm.R(2) }, { "a group", dm.SO(3) }, { "a thread", coroutine.create(said) },
  { "a system", dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end } }, { "a mesh", dm.mesh { grid = 2 } } }
-- in place of an option
local OTHER = {}
for i, wrong in ipairs(WRONG) do
  if i == 1 or i > 3 and i ~= 6 and i ~= 9 and i < 13 or i == #WRONG then OTHER[#OTHER + 1] = wrong end
end
local RAW = { "attempt to ", "'for' ", "table index is ", "invalid value %(at index", "invalid key to", "string slice too long",
  "to 'unpack'", "to 'format'", "to 'insert'", "to 'concat'", "to 'rep'", "to 'ipairs'", "to 'pairs'", "to 'char'", "to 'sub'",
  "to 'sort'", "invalid order function" }
local AS_IN_LUA = { ["dm.max"] = true, ["dm.min"] = true }

local raw, count = {}, 0
local function judge(call, how, message)
  if type(message) ~= "string" or AS_IN_LUA[call.name] or call.name:find "^math" or call.name:find "^core"
    or call.name:find "%.__" or message:find "fuzz/" then return end
  for _, text in ipairs(RAW) do
    if message:find(text) then raw[#raw + 1] = ("%s, %s: %s"):format(call.name, how, message) end
  end
end
-- a field takes a third of the wrong values, which one by its place (SAMPLES=1: all)
local stride = 60 // tap.samples(60)
local function some(list, place)
  local out = {}
  for i, x in ipairs(list) do
    if (i + #place) % stride == 0 then out[#out + 1] = x end
  end
  return out
end
local within = require("dm.core").within
-- a call under a name: for errors of nameless ones Lua looks through all modules that are loaded
local function named(f, ...)
  local result = f(...)
  return result
end
local function try(call, how, ...)
  count = count + 1
  local fine, ended, result = pcall(within, 0.2, named, call.f, ...) -- (what takes longer is stopped as by Ctrl-C)
  if not fine then judge(call, how, ended) elseif not ended then judge(call, how, result) end
end

local function with(t, key, x)
  local out = {}
  for k, y in next, t do out[k] = y end
  out[key] = x
  return out
end

-- each field of the options wrong, at any depth; whole(t): the options with t in this place
local function walk(call, t, path, whole)
  for key, x in next, t do
    local place = path .. "." .. tostring(key)
    for _, wrong in ipairs(some(OTHER, call.name .. place)) do try(call, place .. " = " .. wrong[1], whole(with(t, key, wrong[2]))) end
    if type(x) == "table" and not getmetatable(x) and #place < 40 then
      walk(call, x, place, function(inner) return whole(with(t, key, inner)) end)
    end
  end
end

-- numbers and tables as a second argument follow every first one
local function pairs_of(call, self)
  for i, first in ipairs(WRONG) do
    local more, on = WRONG[i % #WRONG + 1], (i + #call.name) % stride == 0
    if on and call.class then
      try(call, first[1], self, first[2])
      try(call, first[1] .. ", " .. more[1], self, first[2], more[2])
      try(call, "as the object " .. first[1], first[2])
    elseif on then
      try(call, first[1], first[2])
      try(call, first[1] .. ", " .. more[1], first[2], more[2])
    end
  end
end

for _, call in ipairs(calls) do
  if call.given then
    walk(call, call.given, "", function(t) return t end)
  elseif not call.class or objects[call.class] then
    pairs_of(call, call.class and objects[call.class])
  end
end

io.stdout = stdout -- luacheck: ignore
io.output(stdout)
print = said -- luacheck: ignore
ok(count > 20000 / stride, count .. " calls with wrong types")
ok(#raw == 0, #raw .. " messages of Lua's own from inside dmlua")
for i = 1, math.min(#raw, 20) do print("# " .. raw[i]) end

-- what the walk once found, and what takes more than one step to reach
local raises = tap.raises
local shapes = dm.system { Q = dm.product(dm.R(1), dm.SO(3)), L = function(_, v) return v:dot(v) / 2 end }
raises("'group' must be a group, such as dm.SO(3) (got dm.vector)", shapes.level, shapes, { group = dm.vector { 1 } })
raises("'action' must be a dm.action (got dm.space)", shapes.level, shapes, { action = dm.SO(3) })
raises("'factor' must be a whole number >= 1 (got \"x\")", shapes.level, shapes, { group = dm.SO(3), factor = "x" })
local K = dm.mesh { grid = 2 }
ok(K.euler == 1, "a number that can be called")
raises("function expected, got number", function() return dm.vector({ 1 }):map(3) end)
raises("function expected, got number", K.integrals, K, 1, 2)
tap.done()
