-- tests/bench/stability.lua [folder for pictures]: the stability map of the stiff spring with 200 x 200 cells, by Verlet and by the midpoint rule, and the
-- work-precision chart of Kepler, e = 0.6, with 12 rules and 10 steps: seconds on the clock and of CPU time.
local dm = require "dm"
local folder = arg and arg[1]

local function timed(what, f)
  local clock, cpu = dm.clock(), dm.cpu()
  local result = f()
  print(("%-34s %7.1f s on the clock, %6.1f s of CPU time, load %.1f"):format(what, dm.clock() - clock, dm.cpu() - cpu, dm.load_average()))
  return result
end

local spring = dm.system { name = "pendulum on a stiff spring", Q = dm.R(2), params = { k = 1e6 },
  L = function(q, v, _, P) return v:dot(v) / 2 - P.k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
for _, rule in ipairs { "verlet", "midpoint" } do
  local map = timed("stiff spring, 200 x 200, " .. rule, function()
    return spring:stability { rule = rule, k = { 1e2, 1e6, 200, "log" }, h = { 1e-4, 1, 200, "log" }, q = { math.sin(1), -math.cos(1) }, v = { 0, 0 }, steps = 2000 }
  end)
  print((tostring(map):match "^[^\n]*"))
  if folder then map:plot { file = ("%s/stability-%s.png"):format(folder, rule) } end
end

local kepler = dm.system { name = "Kepler", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local h = {}
for i = 1, 10 do h[i] = 0.4 * 2 ^ (-(i - 1) / 2) end
timed("Kepler, 12 rules x 10 steps", function()
  return kepler:chart { q = { 0.4, 0 }, v = { 0, 2 }, t = 20 * math.pi, h = h, rules = { "verlet", "midpoint", "yoshida(4)", "suzuki(4)", "blanes-moan(4)",
    "blanes-moan(6)", "kahan-li(8)", "gauss(2)", "gauss(4)", "lobatto(3)", "rk4", "rk8" } }
end)
