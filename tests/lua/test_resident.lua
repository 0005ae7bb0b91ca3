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
local before = resident()
many()
-- sanitizers and valgrind keep what was freed for a while: there only the plain build can tell
local watched = (os.getenv "UNDER" or "") ~= ""
ok(watched or resident() - before < 4000, "a thousand runs with kernels of their own leave nothing behind", resident() - before .. " kB")

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
