-- A text of digits is no number: of every function of dm that an example of help calls, each number
-- among the arguments, in tables too, is replaced by its text in turn, and the call must be refused.
local tap = require "tap"
local dm = require "dm"
local known = require "dm.session.transcripts"

-- math.* stays as Lua has it; pretty takes anything, so do pairs; of numbers extremum gives back its
-- first argument
local TAKE = { pretty = true, pair = true, extremum = true, sign = true, pow = true, cosh = true,
  sinh = true, tanh = true, log10 = true }
-- examples that print, write files, or begin processes
local SKIPPED = { "%.%a%a%a+\"", "file", "journal", "sweep", "mpi", "plot", "animate", "os%.", "help", "apropos",
  "print", "who", "show", "draw" }

local function copy(value)
  if type(value) ~= "table" or getmetatable(value) then return value end
  local out = {}
  for key, entry in pairs(value) do out[key] = copy(entry) end
  return out
end

-- where there are numbers: lists of keys
local function numbers_in(value, path, out)
  for key, entry in pairs(value) do
    local here = { table.unpack(path) }
    here[#here + 1] = key
    if type(entry) == "number" then
      out[#out + 1] = here
    elseif type(entry) == "table" and not getmetatable(entry) then
      numbers_in(entry, here, out)
    end
  end
  return out
end

-- the same of all entries of a list
local function name_of(path)
  local out = {}
  for i, key in ipairs(path) do out[i] = (type(key) == "number" and i > 1) and "#" or tostring(key) end
  return table.concat(out, ".")
end

local tried, tries, taken, raw = {}, 0, {}, {}

local function with_text(arguments, path)
  local out = copy(arguments)
  local place = out
  for i = 1, #path - 1 do place = place[path[i]] end
  place[path[#path]] = tostring(place[path[#path]])
  return out
end

local function try(name, f, arguments, count)
  for _, path in ipairs(numbers_in(arguments, {}, {})) do
    local what = ("dm.%s, argument %s"):format(name, name_of(path))
    if not tried[what] then
      tried[what], tries = true, tries + 1
      local fine, why = pcall(f, table.unpack(with_text(arguments, path), 1, count))
      if fine then taken[#taken + 1] = what end
      if not fine and tostring(why):find "attempt to" then raw[#raw + 1] = what .. ": " .. tostring(why) end
    end
  end
end

local watched = setmetatable({}, { __index = function(_, name)
  local f = dm[name]
  if type(f) ~= "function" or TAKE[name] or math[name] then return f end
  return function(...)
    try(name, f, { ... }, select("#", ...))
    return f(...)
  end
end })

local function is_skipped(text)
  for _, pattern in ipairs(SKIPPED) do
    if text:find(pattern) then return true end
  end
end

-- what is typed, one chunk after the other
local function play(text)
  local env = setmetatable({ dm = watched }, { __index = _G })
  local chunks = {}
  for line in (text .. "\n"):gmatch "([^\n]*)\n" do
    local first, more = line:match "^> (.*)$", line:match "^>> (.*)$"
    if first then chunks[#chunks + 1] = first end
    if more then chunks[#chunks] = chunks[#chunks] .. "\n" .. more end
  end
  for _, code in ipairs(chunks) do
    local f = load("return " .. code, "=typed", "t", env) or load(code, "=typed", "t", env)
    if f then pcall(f) end -- some examples show an error
  end
end

local names = {}
for name, text in pairs(known) do
  if not is_skipped(text) then names[#names + 1] = name end
end
table.sort(names)
for _, name in ipairs(names) do play(known[name]) end
tap.ok(tries > 100, "a hundred numbers and more were texts", tries)
tap.ok(#taken == 0, "no text is taken for a number", table.concat(taken, "; "))
tap.ok(#raw == 0, "and none is computed with before it is refused", table.concat(raw, "; "))
tap.raises("number expected, got the text \"3\": write it without quotes", dm.zeros, "3")

-- what arg and io.read give: in fields, lists, options of Lua, and where L computes with it
local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local solver = spring:solver { rule = "verlet", h = 0.1 }
for what, f in pairs {
  h = function() spring:solver { rule = "verlet", h = "0.1" } end,
  steps = function() solver:run { q = { 1 }, v = { 0 }, steps = "10" } end,
  members = function() solver:ensemble { q = { { 1 } }, v = { { 0 } }, members = "1", steps = 1 } end,
  start = function() solver:run { q = { "1" }, v = { 0 }, steps = 1 } end,
  ["dm.vector"] = function() dm.vector { 1, "2" } end,
  ["dm.matrix"] = function() dm.matrix { { 1, "2" } } end,
  ["dm.R"] = function() dm.R("2") end,
  mu = function()
    dm.system { Q = dm.R(2), L = function(q, v) return v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2 end }
      :routh { cyclic = { 2 }, mu = "0.5" }
  end,
  points = function() dm.schroedinger { x = { -10, 10, "256" } } end,
  ["L"] = function()
    dm.system { Q = dm.R(1), params = { k = "2" }, L = function(q, v, _, p) return v[1] ^ 2 - p.k * q[1] end }
  end,
  ["a factor of a vector"] = function() return dm.vector { 1, 2 } * "2" end,
} do
  print("# " .. what)
  tap.raises("tonumber(text)", f)
end
local fine, why = pcall(dm.vector, { "two" })
tap.ok(not fine and not why:find "tonumber", "no text of a word", why)
tap.done()
