-- core.within: a call ends when its CPU time is over, by the road of Ctrl-C, and only then
local tap = require "tap"
local dm = require "dm"
local core = require "dm.core"
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function run(steps) return kepler:solver({ rule = "gauss(4)", h = 1e-3 }):run { q = { 0.4, 0 }, v = { 0, 2 }, steps = steps, every = steps } end
local fine, failure = core.within(0.05, run, 1e10)
tap.ok(fine == false and failure.code == "stopped" and failure.path, "a run is stopped, with its path", tostring(failure))
local whole, path = core.within(60, run, 100)
tap.ok(whole == true and #path == 2, "one that ends before gives its results")
tap.ok(#run(100) == 2, "nothing rings afterwards")
local inner, outer
outer = core.within(60, function() inner = core.within(0.05, run, 1e10) return run(100) end)
tap.ok(inner == false and outer == true, "the inner of two ends alone")
outer = core.within(0.05, function() inner = core.within(60, run, 1e10) return run(100) end)
tap.ok(outer == false and inner == false, "the outer ends both")
tap.ok(select(2, pcall(core.within, 60, error, "mine", 0)) == "mine", "other errors pass")
local tried = 0
outer, failure = core.within(0.02, function()
  while true do require "dm.base.blame".try(error, "a try that fails") tried = tried + 1 end
end)
tap.ok(not outer and tostring(failure):find "interrupted!" and tried > 0, "a loop of Lua that tries things ends", tostring(failure))

-- a function that has no value at points that are made up: that is no answer to a stop that came meanwhile
local partial = dm.system { Q = dm.R(1), L = function(q, v)
  if type(q[1]) == "number" and q[1] ~= 1 then error "no value here" end
  return v[1] ^ 2 / 2 - q[1] ^ 2 / 2
end }
local function start() return partial:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 1 } end
local passed, ended, why = pcall(core.within, 0, start)
tap.ok(passed and ended == false and tostring(why):find "interrupted!", "a try that fails beside a stop is the stop", tostring(ended) .. tostring(why))
tap.ok(#start() == 2, "and is tried again by the next call")

-- what is read through a pipe when a stop comes is closed: nothing comes through this one
local pipe = os.tmpname() .. ".pipe"
os.execute("mkfifo " .. pipe)
local stat = io.open "/proc/self/stat"
local own = stat:read "n"
stat:close()
-- files without a name, in which what comes is gathered
local function open_files()
  collectgarbage()
  collectgarbage()
  local list = io.popen(("ls -l /proc/%d/fd | grep -v memfd | grep -c '(deleted)'"):format(own))
  local count = list:read "n"
  list:close()
  return count
end
coroutine.wrap(function() -- its stack keeps nothing alive
  for _ = 1, 3 do core.within(0, dm.load, pipe) end
end)()
tap.ok(open_files() == 0, "a stop leaves no file open", open_files())
os.remove(pipe)
tap.done()
