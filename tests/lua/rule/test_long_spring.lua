-- a stiff spring far from the origin: its length is a difference of large numbers, whose round-off
-- is in the equation of a step, and increments of Newton's method bounce in it to the last one
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local K, STEPS = 1e4, 100
local refused, off, drift = {}, 0, 0
for _, rule in ipairs { "midpoint", "gauss(2)", "gauss(3)" } do
  for _, length in ipairs { 1e2, 1e3 } do
    local spring = dm.system { Q = dm.R(3), L = function(q, v)
      local r = dm.sqrt((q[1] - length) ^ 2 + q[2] ^ 2 + q[3] ^ 2)
      return v:dot(v) / 2 - K * (r - length) ^ 2 / 2 - q[3]
    end }
    local solver = spring:solver { rule = rule, h = 0.01 }
    for k = 1, 6 do
      local start = { q = { 0, 0, 0 }, v = { 0, 0.3 * k, 0.1 }, steps = STEPS }
      local fine, there = pcall(solver.run, solver, start)
      local found, back = fine, nil
      if fine then found, back = pcall(solver.run, solver, { q = there.q[STEPS + 1], p = -there.p[STEPS + 1], steps = STEPS }) end
      if found then
        off = math.max(off, back.q[STEPS + 1]:norm()) -- the rules are symmetric: the motion runs back
        drift = math.max(drift, there:drift "energy".largest)
      else
        refused[#refused + 1] = ("%s, %g, %d"):format(rule, length, k)
      end
    end
  end
end
ok(#refused == 0, "every step is found", table.concat(refused, "; "))
ok(off < 1e-9, "and leads back", off)
ok(drift < 1e-2, "with the energy", drift)

-- on a group
local Q = dm.SE(3)
local body = dm.system { Q = Q, L = function(g, w)
  local r = dm.sqrt((g[1][4] - 1e3) ^ 2 + g[2][4] ^ 2 + g[3][4] ^ 2)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 1.5 * w[3] ^ 2 + w[4] ^ 2 + w[5] ^ 2 + w[6] ^ 2) / 2 - K * (r - 1e3) ^ 2 / 2 - g[3][4]
end }
local path = body:solver { rule = "lie(1)", h = 0.01 }:run { q = Q:identity(), v = { 0, 0.3, 0.2, 0, 0.3, 0.1 }, steps = STEPS }
local worst = path:drift "energy".largest
ok(worst < 1e-5, "lie(1) of a body at such a spring", worst)
tap.done()
