-- Something to interrupt: it traces, steps, loops in Lua, collects and fails, over and over.
local dm = require "dm"

local pendulum = dm.system { Q = dm.T(1), L = function(q, v) return v:dot(v) / 2 + math.cos(q[1]) end }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }

print "ready"
io.stdout:flush()
for _ = 1, 1000 do
  kepler:solver { rule = "verlet", h = 0.001 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 20000 }
  pendulum:solver { rule = "gauss(2)", h = 0.05 }:run { q = { 1 }, v = { 0 }, steps = 2000 }
  local _, e = pcall(error, setmetatable({}, { __gc = function() collectgarbage "step" end }))
  if type(e) == "string" then error(e, 0) end  -- Ctrl-C in there
  local s = 0
  for i = 1, 1e5 do s = s + math.sin(i) end
  for i = 1, 1e4 do s = dm.vector { i, s }:norm() end
end
