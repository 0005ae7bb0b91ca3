--- dm.time: how long a call takes.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local UNITS = { { 1e-6, 1e9, "ns" }, { 1e-3, 1e6, "us" }, { 1, 1e3, "ms" }, { math.huge, 1, "s" } }

-- 1.234e-5 -> "12.3 us"
local function text(seconds)
  for _, unit in ipairs(UNITS) do
    if seconds < unit[1] then return ("%.3g %s"):format(seconds * unit[2], unit[3]) end
  end
end

-- Batches of so many calls: the least and the largest seconds of one, and the least that an empty
-- loop took. Other work of the machine makes a time longer, never shorter, so that least times are
-- those of the call: each by itself, since of two that are subtracted either may have been
-- disturbed.
local function new_batches(calls)
  return { calls = calls, count = 0, best = math.huge, worst = 0, loop = math.huge }
end

local function take(b, f, ...)
  local clock, calls = core.clock, b.calls
  local start = clock()
  for _ = 1, calls do end
  local between = clock()
  for _ = 1, calls do f(...) end
  local took = clock() - between
  b.loop, b.count = math.min(b.loop, between - start), b.count + 1
  b.best, b.worst = math.min(b.best, took), math.max(b.worst, took)
end

-- Batches until is_enough(b) says so, each of `least` seconds where one call is shorter: what was
-- taken for long enough and was a disturbance is seen when a batch is short, and what is no longer
-- than an empty loop is not known yet.
local function measure(f, least, is_enough, ...)
  local b = new_batches(1)
  repeat
    take(b, f, ...)
    if b.best < least then b = new_batches(2 * b.calls) end
  until b.best < math.huge and b.best > b.loop and is_enough(b)
  return (b.best - b.loop) / b.calls, b
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
  local begin = core.clock()
  local best, b = measure(f, 2e-3, function(b)
    return b.count > 1 and core.clock() - begin > 0.2
  end, ...)
  return best, ("%s per call, best of %d x %d"):format(text(best), b.count, b.calls)
end

core.docs[M.time] = doc_time

local doc_bench = [[
dm.bench(f [, k]) -> number, string
Seconds of one call f(), the best of k batches (default 10) of 20 ms or one call each; and as a text
with the spread, the largest batch over the best.]]

local BATCH = 0.02 -- s

M.bench = blame.caller(function(f, k)
  k = k == nil and 10 or lists.whole(k)
  if type(f) ~= "function" then
    error(("dm.bench: a function is needed (got %s); write dm.bench(function() ... end)")
      :format(type(f)), 0)
  end
  if not k or k < 2 or k > 10000 then
    error("dm.bench: the number of batches must be a whole number from 2 to 10000", 0)
  end
  local best, b = measure(f, BATCH / 2, function(b) return b.count >= k end)
  return best, ("%s per call, best of %d x %d, spread %.0f %%"):format(text(best), b.count, b.calls,
    100 * ((b.worst - b.loop) / (b.best - b.loop) - 1))
end)

core.docs[M.bench] = doc_bench

return M
