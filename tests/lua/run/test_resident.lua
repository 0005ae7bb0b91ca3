-- what native kernels hold outside of Lua is given back: the process does not grow, and finalizers may still use it
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local function resident() -- kB
  for line in io.lines "/proc/self/status" do
    local size = line:match "^VmRSS:%s+(%d+)"
    if size then return tonumber(size) end
  end
end
local k = 1
local spring = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - k * q[1] ^ 2 / 2 end }
local solver = spring:solver { rule = "gauss(2)", h = 0.1 }
local function many()
  for _ = 1, 1000 do
    k = k + 1e-4 -- another trace, another kernel
    solver:run({ q = { 1 }, v = { 0 }, steps = 10 }):energy()
  end
  collectgarbage()
  collectgarbage()
end
many()
-- the least growth of three rounds: what is left behind is left by each, and pages that the machine gives by the megabyte come in one
local least = math.huge
for _ = 1, 3 do
  local before = resident()
  many()
  least = math.min(least, resident() - before)
end
-- sanitizers and valgrind keep what was freed for a while: there only the plain build can tell
local watched = (os.getenv "UNDER" or "") ~= ""
ok(watched or least < 4000, "a thousand runs with kernels of their own leave nothing behind", least .. " kB")

-- what a system keeps from run to run does not grow with the runs
local function held()
  for _ = 1, 3 do collectgarbage() end
  return collectgarbage "count"
end
local function growth(f)  -- kB a call
  for _ = 1, 20 do f() end
  local first = held()
  for _ = 1, 100 do f() end
  return (held() - first) / 100
end
local function free(_, v) return v:dot(v) / 2 end
local kinds = {
  { "constraint", Q = dm.R(2), L = free, constraint = function(q) return q:dot(q) - 1 end },
  { "rolling constraint", Q = dm.R(2), L = free, rolling = function(q, v) return v[1] - q[2] * v[2] end },
  { "force", Q = dm.R(2), L = free, force = function(_, v) return -0.1 * v end },
}
for _, made in ipairs(kinds) do
  local what = table.remove(made, 1)
  local system = dm.system(made)
  local run = system:solver { rule = "gauss(2)", h = 0.01 }
  local kB = growth(function() run:run { q = { 1, 0 }, v = { 0, 1 }, steps = 2 } end)
  ok(kB < 1, "a run with a " .. what .. " leaves nothing with its system", kB)
end
local round = dm.system { Q = dm.R(2), L = function(q, v) return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2] end }
local shape = round:routh { cyclic = { 1 }, mu = 1 }
local reduced = shape:solver { rule = "gauss(2)", h = 0.01 }
local kB = growth(function() reduced:run { q = { 1 }, v = { 0.1 }, steps = 4 } end)
ok(kB < 1, "nor does one of a reduced system", kB)
kB = growth(function() shape:energy({ 1 }, { 0.1 }) end)
ok(kB < 1, "nor a question for its energy", kB)

-- finalizers that run after the kernels were given back
local seen = {}
local function leave(what, use) setmetatable({}, { __gc = function() seen[what] = { pcall(use) } end }) end
do
  local path = solver:run { q = { 1 }, v = { 0 }, steps = 5 }
  local f = dm.trace(function(x) return x[1] ^ 2 end, 1)
  local s = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 - q[1] end }
  s:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 5 }
  leave("path", function() return #path:energy() end)
  leave("function", function() return f { 3 } end)
  leave("run", function() return s:solver({ rule = "verlet", h = 0.1 }):run({ q = { 1 }, v = { 0 }, steps = 2 }).q[3][1] end)
end
for _ = 1, 4 do collectgarbage() end
ok(seen.path and seen.path[1] and seen.path[2] == 6, "a finalizer may ask a dead path for its energy", seen.path and seen.path[2])
ok(seen["function"] and seen["function"][2] == 9, "or call a dead function")
ok(seen.run and seen.run[1], "or run a dead system", seen.run and seen.run[2])
tap.done()
