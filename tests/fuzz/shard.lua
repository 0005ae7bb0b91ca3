--[[ dmlua tests/fuzz/shard.lua SEED CALLS [SECONDS] - random calls of everything that scripts can
reach, in the current folder: functions, methods and operators, options by the signatures of docs,
right calls with one field wrong, functions that go wrong, spoilt files. A call must return or raise
an error with words: it must not crash, nor raise what Lua says of a nil inside dmlua. The file
last-call has the number of the call that is under way, so a crash names it: with VERBOSE=n call n
is printed, ALONE=n makes that one only. A file "costs" (name, microseconds), if there is one, makes
dear calls rarer; COSTS=file writes one. SLOW=s calls it a defect, too, when a call takes more than
s seconds of CPU time (without it none is: under sanitizers time says little of a call). Prints
counts, then one line for each kind of defect. ]]
package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local report = io.stdout
require "dm"
local values = require "values"

local seed, most = math.tointeger(arg[1]) or 1, math.tointeger(arg[2]) or 1000
local seconds = tonumber(arg[3]) or math.huge
math.randomseed(seed)
local random = math.random
local loud = math.tointeger(os.getenv "VERBOSE")

-- pictures of the terminal and the like go nowhere
io.stdout = assert(io.open("/dev/null", "w")) -- luacheck: ignore
io.output(io.stdout)
print = function() end -- luacheck: ignore

local calls = require("calls").list()
local pool = require("objects").list()
for _, why in ipairs(pool.failed) do report:write("an object could not be made: ", why, "\n") end
local made = #pool
values.open(random, pool)
local readers = require("files").readers(random)
for _, name in ipairs { "a spoilt checkpoint", "a spoilt csv", "a spoilt npy" } do
  calls[#calls + 1] = { name = name, f = readers[name], ways = {} }
end

---- which call is next: cheap ones as often as one another, dear ones as often as time allows ----

local AFFORDED = 60 -- microseconds: what costs more is called less often
local cumulative, total = {}, 0
do
  local cost = {}
  local file = io.open "costs"
  for line in file and file:lines() or function() end do
    local us, name = line:match "^(%S+) (.*)$"
    cost[name] = tonumber(us)
  end
  if file then file:close() end
  for i, call in ipairs(calls) do
    total = total + math.min(1, AFFORDED / math.max(cost[call.name] or 1, 1))
    cumulative[i] = total
  end
end
local function next_call()
  local x, least, greatest = random() * total, 1, #calls
  while least < greatest do
    local middle = (least + greatest) // 2
    if cumulative[middle] < x then least = middle + 1 else greatest = middle end
  end
  return calls[least]
end

---- what goes wrong ----

local kinds, order = {}, {} -- of defects: text -> count
local function defect(call, i, text)
  text = ("%s: %s"):format(call.name, text:sub(1, 600):gsub("0x%x+", "0x"))
  if not kinds[text] then
    order[#order + 1], kinds[text] = text, 0
    report:write(("seed %d call %d: %s\n"):format(seed, i, text))
    report:flush()
  end
  kinds[text] = kinds[text] + 1
end
-- where the newest error came from: the handler of base/blame.lua sees it with its position
local came_from
local explain = debug.getregistry().dm_explain
debug.getregistry().dm_explain = function(message)
  if type(message) == "string" then came_from = message:match "([%w_]+/[%w_]+%.lua:%d+:)" end
  return explain(message)
end
local RAW = { "attempt to ", "number has no integer representation", "for' ", "table index is ",
  "invalid value %(at index", "invalid option", "invalid key to", "string slice too long",
  "to 'unpack'", "to 'format'", "to 'insert'", "to 'concat'", "to 'rep'",
  "to 'ipairs'", "to 'pairs'", "to 'char'", "to 'sub'", "to 'sort'", "invalid order function" }
-- what Lua itself says, of a line that is not one of this folder's functions
local function is_raw(message)
  if message:find "fuzz/" or message:find "yield" then return end
  for _, text in ipairs(RAW) do
    if message:find(text) then return true end
  end
end
local function judge(call, i, message)
  local failure = values.class_of(message) == "dm.failure"
  if failure then message = tostring(message) end
  if type(message) ~= "string" then return end
  if message:find "DEFECT" then return defect(call, i, message) end
  if call.name:find "^math" or call.name == "dm.max" or call.name == "dm.min" -- as in Lua
    or call.name:find "%.__" or call.class and not failure
    and message:find "^bad argument" then return end
  if not message:find "%a%a%a" then return defect(call, i, ("no words: %q"):format(message)) end
  if is_raw(message) then defect(call, i, (came_from or "?") .. " " .. message) end
end

---- calling ----

local log = assert(io.open("last-call", "w"))
log:setvbuf "no"
local function note(i, call)
  log:seek "set"
  log:write(i, " ", call.name, "                              \n")
end

-- a short word for an argument, without calling anything of it
local function shown(x, depth)
  local kind = math.type(x) or type(x)
  if kind == "string" then return ("%q"):format(x:sub(1, 30)) end
  if kind == "table" and depth < 4 and getmetatable(x) == nil then
    local words = {}
    for k, v in next, x do words[#words + 1] = ("%s = %s"):format(shown(k, 4), shown(v, depth + 1)) end
    return "{" .. table.concat(words, ", ") .. "}"
  end
  if kind == "function" then
    local info = debug.getinfo(x, "S")
    return ("function:%s:%d"):format(info.short_src:match "[^/]*$", info.linedefined)
  end
  if kind == "userdata" and values.class_of(x) == "dm.vector" then return tostring(x) end
  return values.class_of(x) or kind == "table" and kind or tostring(x)
end

local function arguments_of(call)
  if call.given then return { values.like(call.given, 0) }, 1 end
  local self = call.class and (random(12) > 1 and values.of_class(call.class) or values.value(1))
  if #call.ways > 0 and random(6) > 1 then
    return values.by_signature(values.pick(call.ways), self, call.class)
  end
  return values.anything(self, call.class)
end

-- what takes too long is stopped, as by Ctrl-C: loops of Lua by a hook, those of C by core.within
local INSTRUCTIONS, PATIENCE = 2e6, 1.5
local SLOW = tonumber(os.getenv "SLOW") or math.huge
local function too_long() error("interrupted! the fuzzer lost patience", 0) end
local function guarded(f)
  return function(...)
    debug.sethook(too_long, "", INSTRUCTIONS)
    return f(...)
  end
end

local spent, times, returned = {}, {}, 0 -- by name
local clock, within = os.clock, require("dm.core").within
-- pcall with an end
local function tried(f, ...)
  local fine, ended, result = pcall(within, PATIENCE, f, ...)
  if not fine then return false, ended end
  return ended, result
end
local function once(i)
  math.randomseed(seed, i) -- what a call drew before says nothing of this one
  local call = next_call()
  local arguments, n = arguments_of(call)
  note(i, call)
  if loud == i then
    local words = {}
    for k = 1, n do words[k] = shown(arguments[k], 0) end
    report:write(("call %d: %s(%s)\n"):format(i, call.name, table.concat(words, ", ")))
    report:flush()
  end
  local called = guarded(call.f)
  came_from = nil
  local began = clock()
  local fine, result = tried(random(50) > 1 and called or coroutine.wrap(called),
    table.unpack(arguments, 1, n))
  debug.sethook()
  local took = clock() - began
  spent[call.name] = (spent[call.name] or 0) + took
  times[call.name] = (times[call.name] or 0) + 1
  if took > SLOW then defect(call, i, ("took more than %g s"):format(SLOW)) end
  if loud == i then report:write(("-> %s %s (%.3f s)\n"):format(fine, tostring(result), took)) end
  if not fine then return judge(call, i, result) end
  returned = returned + 1
  call.returned = true
  -- results live on as arguments
  if type(result) == "userdata" or values.class_of(result) then
    if random(5) == 1 then pool[made + random(60)] = result end
    if random(4) == 1 then
      local named, text = pcall(tostring, result)
      if not named then judge({ name = "tostring after " .. call.name }, i, text) end
    end
  end
end

local alone = math.tointeger(os.getenv "ALONE")
local start, n = os.time(), alone and alone - 1 or 0
if alone then loud, most = alone, alone end
for i = made + 1, made + 60 do pool[i] = i end
while n < most and os.difftime(os.time(), start) < seconds do
  n = n + 1
  once(n)
end
log:close()

---- what came of it ----

local reached, without = 0, {}
for _, call in ipairs(calls) do
  if call.returned then reached = reached + 1 else without[#without + 1] = call.name end
end
report:write(("%d calls of %d functions, methods and operators: %d returned, of %d of them; the "
  .. "others raised an error\n"):format(n, #calls, returned, reached))
if os.getenv "WITHOUT" then report:write("never returned: ", table.concat(without, ", "), "\n") end
local costs = os.getenv "COSTS"
if costs then
  local file <close> = assert(io.open(costs, "w"))
  for _, call in ipairs(calls) do
    local name = call.name
    if times[name] then file:write(("%.1f %s\n"):format(1e6 * spent[name] / times[name], name)) end
  end
end
os.exit(#order == 0, true)
