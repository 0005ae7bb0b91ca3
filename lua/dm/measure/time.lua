--- dm.time: how long a call takes.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local UNITS = { { 1e-6, 1e9, "ns" }, { 1e-3, 1e6, "us" }, { 1, 1e3, "ms" }, { math.huge, 1, "s" } }

-- 1.234e-5 -> "12.3 us"
local function text(seconds)
  for _, unit in ipairs(UNITS) do
    if seconds < unit[1] then return ("%.3g %s"):format(seconds * unit[2], unit[3]) end
  end
end

-- seconds that `calls` calls take, without those of an empty loop
local function batch(f, calls, ...)
  local clock = core.clock
  local start = clock()
  for _ = 1, calls do f(...) end
  local called = clock()
  for _ = 1, calls do end
  return 2 * called - start - clock()
end

local doc_time = [[
dm.time(f, ...) -> number, string
Seconds of one call f(...): the best of several batches, each long enough to be measured; and the
same as a text in ns, us or ms. Takes about a fifth of a second, or two calls when one takes
longer.]]

function M.time(f, ...)
  local meta = type(f) ~= "function" and getmetatable(f)
  if type(f) ~= "function" and not (type(meta) == "table" and meta.__call) then
    error(("dm.time: a function is needed (got %s); write dm.time(function() ... end)")
      :format(type(f)), 2)
  end
  local calls, best, batches, begin = 1, batch(f, 1, ...), 1, core.clock()
  while best < 2e-3 do
    calls = calls * 2
    best = batch(f, calls, ...)
  end
  best = best / calls
  repeat
    best = math.min(best, batch(f, calls, ...) / calls)
    batches = batches + 1
  until core.clock() - begin > 0.2
  best = math.max(best, 0)
  return best, ("%s per call, best of %d x %d"):format(text(best), batches, calls)
end

core.docs[M.time] = doc_time

local doc_bench = [[
dm.bench(f [, k]) -> number, string
Seconds of one call f(), the best of k batches (default 10) of 20 ms or one call each; and as a text
with the spread, the largest batch over the best.]]

local BATCH = 0.02 -- s

M.bench = blame.caller(function(f, k)
  k = k == nil and 10 or math.tointeger(k)
  if type(f) ~= "function" then
    error(("dm.bench: a function is needed (got %s); write dm.bench(function() ... end)")
      :format(type(f)), 0)
  end
  if not k or k < 2 or k > 10000 then
    error("dm.bench: the number of batches must be a whole number from 2 to 10000", 0)
  end
  local calls, once = 1, batch(f, 1)
  while once < BATCH / 2 do
    calls = calls * 2
    once = batch(f, calls)
  end
  local best, worst, loop = math.huge, 0, math.huge
  for _ = 1, k do
    local start = core.clock()
    for _ = 1, calls do end
    local between = core.clock()
    for _ = 1, calls do f() end
    loop = math.min(loop, between - start)
    local took = core.clock() - between
    best, worst = math.min(best, took), math.max(worst, took)
  end
  best, worst = math.max(best - loop, 0) / calls, math.max(worst - loop, 0) / calls
  return best, ("%s per call, best of %d x %d, spread %.0f %%"):format(text(best), k, calls,
    best > 0 and 100 * (worst / best - 1) or 0)
end)

core.docs[M.bench] = doc_bench

return M
