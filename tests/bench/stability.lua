-- tests/bench/stability.lua [folder for pictures]: the stability map of the stiff spring with 200 x 200 cells, by Verlet and by the midpoint rule, and the
-- work-precision chart of Kepler, e = 0.6, with 12 rules and 10 steps: seconds on the clock and of CPU time; what the class `wrong` costs.
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

-- maps with and without the class `wrong`: CPU time, the least of five, one after the other
local function L_of_chain(q, v, _, P)
  local V = q[1] ^ 2 / 2 + q[12] ^ 2 / 2
  for i = 1, 11 do V = V + P.k * (q[i + 1] - q[i]) ^ 2 / 2 + 0.25 * (q[i + 1] - q[i]) ^ 4 end
  return v:dot(v) / 2 - V
end
local plucked = dm.zeros(12):totable()
plucked[1] = 1
local maps = {
  { "pendulum", { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + dm.cos(q[1]) end },
    { a = { 0.3, 2.8, 12, "linear" }, q = function(a) return { a } end, v = { 0 }, rule = "verlet", h = { 0.005, 2.5, 160, "log" }, t = 100 } },
  { "pendulum, midpoint", { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + dm.cos(q[1]) end },
    { a = { 0.3, 2.8, 12, "linear" }, q = function(a) return { a } end, v = { 0 }, rule = "midpoint", h = { 0.005, 2.5, 160, "log" }, t = 100 } },
  { "double pendulum, midpoint", { Q = dm.R(2), L = function(q, v) return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * dm.cos(q[1] - q[2]) + 19.62 * dm.cos(q[1]) + 9.81 * dm.cos(q[2]) end },
    { a = { 0.1, 0.9, 8, "linear" }, q = function(a) return { a, 1.2 * a } end, v = { 0, 0 }, rule = "midpoint", h = { 0.002, 0.5, 120, "log" }, t = 20 } },
  { "Kepler", { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end },
    { e = { 0.1, 0.7, 8, "linear" }, q = function(e) return { 1 - e, 0 } end, v = function(e) return { 0, math.sqrt((1 + e) / (1 - e)) } end, rule = "verlet", h = { 0.001, 0.5, 160, "log" }, t = 60 } },
  { "Henon-Heiles", { Q = dm.R(2), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3 end },
    { y = { -0.2, 0.3, 10, "linear" }, q = function(y) return { 0, y } end, v = { 0.3, 0 }, rule = "verlet", h = { 0.01, 2.5, 160, "log" }, t = 200 } },
  { "quartic chain of 12", { Q = dm.R(12), params = { k = 1 }, L = L_of_chain },
    { k = { 1, 10, 6, "log" }, q = plucked, v = dm.zeros(12), rule = "verlet", h = { 0.005, 1, 120, "log" }, t = 60 } },
  { "pendulum on a spring", { Q = dm.R(2), params = { k = 10 }, L = function(q, v, _, P) return v:dot(v) / 2 - P.k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end },
    { k = { 1e2, 1e4, 10, "log" }, q = { math.sin(1), -math.cos(1) }, v = { 0, 0 }, rule = "verlet", h = { 1e-4, 0.3, 160, "log" }, t = 10 } },
  { "rod, rattle", { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end },
    { s = { 0.2, 1.5, 8, "linear" }, q = { 0.6, -0.8 }, v = function(s) return { 0.8 * s, 0.6 * s } end, rule = "rattle", h = { 0.002, 0.8, 120, "log" }, t = 30 } },
}
print "maps, CPU time without and with the class wrong, ms: as they are; without exponents (chaos = false)"
for _, row in ipairs(maps) do
  local best = {}
  for _ = 1, 5 do
    for k, how in ipairs { { accuracy = false }, {}, { accuracy = false, chaos = false }, { chaos = false } } do
      local options, system = {}, dm.system(row[2])
      for key, value in pairs(row[3]) do options[key] = value end
      for key, value in pairs(how) do options[key] = value end
      collectgarbage()
      local start = dm.cpu()
      system:stability(options)
      best[k] = math.min(best[k] or math.huge, dm.cpu() - start)
    end
  end
  print(("%-28s %6.0f %6.0f  %.2f   %6.0f %6.0f  %.2f"):format(row[1], 1e3 * best[1], 1e3 * best[2], best[2] / best[1], 1e3 * best[3], 1e3 * best[4], best[4] / best[3]))
end
