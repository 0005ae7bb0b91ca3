-- masses that vanish beside others that hide it: a light cart with a heavy pendulum, whose mass is nearly singular all along, negative
-- masses, steps that choose their length and grow before they come to a narrow dip
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local stream, drawn = dm.random(19), 0
local function uniform(a, b)
  drawn = drawn + 1
  return a + (b - a) * stream:uniform(drawn, 0)
end

-- the mass of q1 grows by far, then touches zero; how runs end that come to it: p1 = M1 v1, M1 v1^2 are constant
local function tally(beside)
  local out = { over = 0, named = 0, runs = 0 }
  for _ = 1, 40 do
    local at, g, c = uniform(1, 4), uniform(1, 5), 1 - 10 ^ uniform(-5, -3.4)
    local system = dm.system { Q = dm.R(3), L = function(q, v)
      return (dm.exp(g * q[1]) * (q[1] / at - 1) ^ 2 * v[1] ^ 2 + beside(v[2], v[3], c)) / 2
    end }
    local start = { q = { 0, 0, 0 }, v = { uniform(0.2, 1), 0.1, 0.3 }, steps = 600 }
    for _, rule in ipairs { "midpoint", "gauss(2)", "rk4" } do
      local fine, path = pcall(function() return system:solver { rule = rule, h = uniform(0.005, 0.05) }:run(start) end)
      local last = fine and path or path.path
      out.runs = out.runs + 1
      out.over = out.over + (fine and last.q[#last][1] > at and 1 or 0)
      out.named = out.named + (not fine and (path.code == "inertia" or path.fading) and 1 or 0)
    end
  end
  return out
end
local coupled = tally(function(v2, v3, c) return v2 ^ 2 + 2 * c * v2 * v3 + v3 ^ 2 end)
-- before: 31 of 120, and 2 named
ok(coupled.over == 0 and coupled.named > coupled.runs / 3, "beside a mass that is nearly singular no run goes over",
  coupled.over .. ", " .. coupled.named)
local negative = tally(function(v2, v3) return v2 ^ 2 - v3 ^ 2 end)
-- before: 58 named
ok(negative.over <= negative.runs / 20 and negative.named > negative.runs / 2, "beside a negative mass few do",
  negative.over .. ", " .. negative.named)

-- a dip far along the way, narrower than the steps that were chosen until then
local over, told = 0, 0
for _ = 1, 20 do
  local width, at, deep = 10 ^ uniform(-3, -1), uniform(3, 30), uniform(1.05, 1.5)
  local system = dm.system { Q = dm.R(2), L = function(q, v)
    return (1 - deep * dm.exp(-((q[1] - at) / width) ^ 2)) * v[1] ^ 2 / 2 + (1 + 0.1 * dm.cos(q[1]) * dm.sin(q[2])) * v[2] ^ 2 / 2
      - dm.cos(q[2]) / 10
  end }
  for _, rule in ipairs { "rk8", "gauss(3)" } do
    local solver = system:solver { rule = rule, h = 0.01 }
    local fine, path = pcall(solver.run, solver, { q = { 0, 0.3 }, v = { 1, 0.1 }, t = 40, control = { tolerance = 1e-5 } })
    local last = fine and path or path.path
    if last.q[#last][1] > at + 4 * width then over = over + 1 end
    if not fine and (path.code == "inertia" or path.fading) then told = told + 1 end
  end
end
-- before: 24 of 40
ok(over == 0 and told == 40, "steps that choose their length come to no dip unseen", over .. ", " .. told)
tap.done()
