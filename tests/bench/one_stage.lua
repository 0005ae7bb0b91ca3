-- make bench: a step of one stage (midpoint) where L = T(v) - V(q, t) with constant mass, alone and of a member of an ensemble: up to four
-- coordinates by one kernel of two iterations (src/integ/stage/lanes/one_point.h), above by sweeps.
local dm = require "dm"
local cos, sqrt = math.cos, math.sqrt

local STEPS, MEMBERS, MEMBER_STEPS, REPEATS = 100000, 1024, 200, 5

local function ring(n)
  return function(q, v)
    local sum = v:dot(v) / 2
    for i = 1, n do sum = sum - (q[i % n + 1] - q[i]) ^ 2 / 2 - (q[i % n + 1] - q[i]) ^ 4 / 4 end
    return sum
  end
end

local function pendulums(n)
  return function(q, v)
    local sum = v:dot(v) / 2
    for i = 1, n do sum = sum + cos(q[i]) end
    for i = 1, n - 1 do sum = sum - (q[i + 1] - q[i]) ^ 2 / 2 end
    return sum
  end
end

local function start(n)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = math.sin(1.7 * i), 0.1 * cos(2.3 * i) end
  return q, v
end

local models = {
  { "pendulum", function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end, { 1 }, { 0.3 }, 0.1 },
  { "Kepler, e = 0.6", function(q, v) return v:dot(v) / 2 + 1 / q:norm() end, { 0.4, 0 }, { 0, 2 }, 0.02 },
  { "full mass matrix", function(q, v) return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] / 2 + cos(q[1]) + 2 * cos(q[2] - q[1]) end, { 1, 0.5 }, { 0.1, 0.2 }, 0.1 },
  { "two bodies of a plane", function(q, v)
    return v[1] ^ 2 / 2 + v[2] ^ 2 / 2 + v[3] ^ 2 + v[4] ^ 2 + 1 / sqrt((q[1] - q[3]) ^ 2 + (q[2] - q[4]) ^ 2)
  end, { 1, 0, -0.5, 0 }, { 0, 1, 0, -0.5 }, 0.02 },
}
for _, n in ipairs { 4, 5, 8 } do
  local q, v = start(n)
  models[#models + 1] = { ("ring of %d"):format(n), ring(n), q, v, 0.05 }
  models[#models + 1] = { ("%d pendulums"):format(n), pendulums(n), q, v, 0.05 }
end

-- least of some
local function best(ns)
  local least = math.huge
  for _ = 1, REPEATS do least = math.min(least, ns()) end
  return least
end

print(("%-24s %10s %10s %10s"):format("one stage, ns a step", "alone", "member", "Newton"))
for _, m in ipairs(models) do
  local solver = dm.system({ Q = dm.R(#m[3]), L = m[2] }):solver { rule = "midpoint", h = m[5] }
  local q = {}
  for i = 1, MEMBERS do
    q[i] = { table.unpack(m[3]) }
    q[i][1] = q[i][1] + 1e-5 * i
  end
  q = dm.matrix(q)
  local alone = best(function() return solver:run({ q = m[3], v = m[4], steps = STEPS, every = STEPS }).ns_per_step end)
  local newton = solver:report().newton_per_step
  local member = best(function()
    local began = os.clock()
    solver:ensemble { members = MEMBERS, q = q, v = function() return m[4] end, steps = MEMBER_STEPS, threads = 1 }
    return (os.clock() - began) * 1e9 / (MEMBERS * MEMBER_STEPS)
  end)
  print(("%-24s %10.1f %10.1f %10.2f"):format(m[1], alone, member, newton))
end
