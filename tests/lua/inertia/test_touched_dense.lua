-- masses of five to eight velocities, all coupled, that touch or cross zero as a whole, in one or two
-- velocities, or beside a factor that all have: what is looked at of them is not the product of all values
local tap = require "tap"
local dm = require "dm"

local stream, drawn = dm.random(3), 0
local function uniform(a, b)
  drawn = drawn + 1
  return a + (b - a) * stream:uniform(drawn, 0)
end
local function any(...) return (select(math.floor(uniform(0, select("#", ...))) + 1, ...)) end

local RULES = { "midpoint", "gauss(3)", "lobatto(3)", "rk4", "rk8", "verlet" }

-- sum_i m_i (R v)_i^2/2 with w^k in the place of some m_i, which is 0 on a curve
local function model()
  local n, k, kind = math.floor(uniform(5, 9)), any(1, 2, 2, 4), any("whole", "one", "two", "factor")
  local c, b, g, R, m = uniform(-0.5, 0.5), uniform(-1, 1), uniform(-2, 2), {}, {}
  local vanish = kind == "whole" and n or kind == "two" and 2 or 1
  local function w(q) return q[1] - c + b * q[2] + 0.3 * q[2] ^ 2 end
  for i = 1, n do
    R[i], m[i] = {}, uniform(0.3, 2)
    for j = 1, n do R[i][j] = (i == j and 1 or 0) + uniform(-0.4, 0.4) end
  end
  local system = dm.system { Q = dm.R(n), L = function(q, v)
    local T, power = 0, w(q) ^ (kind == "whole" and 2 * k or k)
    for i = 1, n do
      local sum = 0
      for j = 1, n do sum = sum + R[i][j] * v[j] end
      T = T + (i <= vanish and power or m[i]) * sum ^ 2 / 2
    end
    return (kind == "factor" and dm.exp(g * q[2]) or 1) * T - q:dot(q) / 2
  end }
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = uniform(-1, 1), uniform(-1.5, 1.5) end
  while math.abs(w(q)) > 0.4 do q[1] = uniform(-1.5, 1.5) end
  return system, { q = q, v = v }, w, uniform(0.01, 0.06)
end

local runs, over, named, unlike = 0, 0, 0, 0
for i = 1, 60 do
  local system, start, w, h = model()
  start.steps = math.ceil(2 / h)
  for r = 1 + i % 2, #RULES, 2 do
    local solver = system:solver { rule = RULES[r], h = h }
    local fine, path = pcall(solver.run, solver, start)
    local way, goes = fine and path or path.path, false
    for j = 2, #way do goes = goes or w(way.q[j]) * w(way.q[j - 1]) < 0 end
    runs, over = runs + 1, over + (goes and 1 or 0)
    named = named + (not fine and (path.code == "inertia" or path.fading) and 1 or 0)
    if i % 10 == 1 then
      local members = solver:ensemble { members = 3, steps = start.steps, threads = 1,
        q = function() return start.q end, v = function() return start.v end }
      local code, steps = fine and "ok" or path.code, fine and start.steps or path.step - 1
      if members.status[2] ~= code or members.steps[2] ~= steps then unlike = unlike + 1 end
    end
  end
end
tap.ok(over <= runs / 40, "hardly a run goes over such a place", over .. " of " .. runs)
tap.ok(named > runs / 3, "many come to one and are told by name", named .. " of " .. runs)
tap.ok(unlike == 0, "members end as runs of their own", unlike)
tap.done()
