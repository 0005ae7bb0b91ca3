-- make bench: problem P7, a pendulum on a spring of any stiffness in steps that do not see the vibration
-- (start of P6: natural length, 1 rad, at rest; T = 16), and what a step of sem costs beside midpoint.
local dm = require "dm"
local sqrt, cos, abs, max = math.sqrt, math.cos, math.abs, math.max

local function spring(k)
  return dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
    return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - k * q[1] ^ 2 / 2
  end }
end

-- largest error of theta at the 32 times, CPU time of a run (best of 3), Newton iterations a step
local function measure(system, rule, start, steps, truth)
  local solver, best, path = system:solver { rule = rule, h = 16 / steps }, math.huge, nil
  for _ = 1, 3 do
    local began = os.clock()
    path = solver:run { q = start, v = { 0, 0 }, steps = steps, every = steps // 32 }
    best = math.min(best, os.clock() - began)
  end
  local worst = 0
  for i = 1, #path do worst = max(worst, abs(path.q[i][2] - truth.q[i][2])) end
  return worst, best * 1e3, solver:report().newton_per_step
end

local times = {}
for i = 0, 32 do times[i + 1] = i / 2 end
print(("%-34s %5s %10s %9s %7s"):format("P7, theta", "steps", "error", "ms", "newton"))
for _, a in ipairs { 0, 0.02 } do
  for _, k in ipairs { 1e2, 1e3, 1e4, 1e6, 1e8 } do
    local system, start = spring(k), { a, 1 }
    local truth = system:solver { rule = "gauss(6)", h = 0.5 / sqrt(k) }:run { q = start, v = { 0, 0 }, at = times }
    for _, steps in ipairs { 32, 128 } do
      local soft = 16 / steps * sqrt(k) < 3
      local rule = dm.multiscale { frequency = sqrt(k), degrees = { 2, 3 }, nodes = soft and 6 or nil, phases = soft and 15 or nil }
      for name, each in pairs { multiscale = rule, ["gauss(3)"] = "gauss(3)" } do
        local fine, worst, ms, newton = pcall(measure, system, each, start, steps, truth)
        local head = ("a = %-4g k = %-7.0e %-12s %8d"):format(a, k, name, steps)
        print(fine and ("%s %10.1e %9.2f %7.1f"):format(head, worst, ms, newton) or head .. "     failed")
      end
    end
  end
end

-- what sem keeps, and a step of it beside one of midpoint: ns, the best of many, taking turns
local function line(V)
  return dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - V(q[1]) end }
end
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local pendulum = line(function(x) return -cos(x) end)
local planets
for _, model in ipairs(dofile "tests/bench/dm/models.lua") do
  if model.key == "P3" then planets = model end
end
-- a chain of cubic springs between walls
local function chain(n)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = 0.3 * math.sin(math.pi * i / (n + 1)), cos(i) / 20 end
  return { ("chain of %d"):format(n), dm.system { Q = dm.R(n), L = function(x, u)
    local L = u:dot(u) / 2
    for i = 0, n do
      local d = (i < n and x[i + 1] or 0) - (i > 0 and x[i] or 0)
      L = L - d ^ 2 / 2 - d ^ 4 / 4
    end
    return L
  end }, q, v, 0.1 }
end
local PROBLEMS = {
  { "Kepler, e = 0.5", kepler, { 0.5, 0 }, { 0, sqrt(3) }, 0.05 },
  { "pendulum from 1 rad", pendulum, { 1 }, { 0 }, 0.1 },
  { "oscillator", line(function(x) return x ^ 2 / 2 end), { 1 }, { 0 }, 0.1 },
  { "two rods", dm.system { Q = dm.R(2), L = function(q, v)
    return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 2 * cos(q[1]) + cos(q[2])
  end }, { 0.3, 0.2 }, { 0, 0 }, 0.02 },
  { "J2 satellite", dm.system { Q = dm.R(3), L = function(q, v)
    local r = q:norm()
    return v:dot(v) / 2 + 1 / r - 0.025 / r ^ 3 * (3 * q[3] ^ 2 / r ^ 2 - 1)
  end }, { 0.9, 0, 0 }, { 0, 0.99, 0.55 }, 0.05 },
  { "five coordinates", dm.system { Q = dm.R(5), L = function(q, v)
    return v:dot(v) / 2 - q:dot(q) / 2 - q:dot(q) ^ 2 / 4
  end }, { 0.5, 0.3, 0.1, 0, 0.2 }, { 0, 0.2, 0.4, 0.1, 0.3 }, 0.05 },
  { "outer solar system", planets.system, planets.q, planets.v, 40 },
  chain(8), chain(13), chain(16), chain(20), chain(32), chain(128),
}

local function runner(problem, rule)
  local solver = problem[2]:solver { rule = rule, h = problem[5] }
  local steps = rule == "sem(2, gauss(2))" and 500 or #problem[3] < 10 and 10000 or #problem[3] < 100 and 1000 or 200  -- about a millisecond
  local from = { q = problem[3], v = problem[4], steps = steps, every = steps }
  return function() return solver:run(from).ns_per_step end, solver
end
print(("\n%-24s %10s %10s %8s %10s %8s"):format("a step, ns", "midpoint", "sem(1)", "times", "sem(2)", "times"))
for _, problem in ipairs(PROBLEMS) do
  local sides, best = {}, {}
  for i, rule in ipairs { "midpoint", "sem(1, gauss(1))", #problem[3] < 10 and "sem(2, gauss(2))" or nil } do
    sides[i], best[i] = runner(problem, rule), math.huge
  end
  for _ = 1, 15 do
    for i, each in ipairs(sides) do best[i] = math.min(best[i], each()) end
  end
  local second = best[3] and ("%10.0f %8.1f"):format(best[3], best[3] / best[1]) or ""
  print(("%-24s %10.0f %10.0f %8.2f %s"):format(problem[1], best[1], best[2], best[2] / best[1], second))
end

print(("\n%-24s %8s %10s %10s %10s"):format("sem on Kepler, 1e5 steps", "h", "E_d", "momentum", "flagged"))
for s = 1, 3 do
  local path = kepler:solver { rule = ("sem(%d, gauss(%d))"):format(s, s), h = 0.05 }
    :run { q = { 0.5, 0 }, v = { 0, sqrt(3) }, steps = 1e5, every = 1000 }
  print(("%-24s %8.3g %10.1e %10.1e %10d"):format(("sem(%d, gauss(%d))"):format(s, s), 0.05, path.sem.defect,
    path:drift(path:momentum(dm.SO(2))).largest, path.sem.fallbacks))
end

-- Ld of gauss(s) beside the exact one, between the ends of a motion
print(("\n%-24s %10s %10s %10s"):format("Ld of the pendulum", "slope", "of momenta", "2s+1, 2s"))
for s = 1, 3 do
  local e = dm.discrete_lagrangian(pendulum, { rule = ("gauss(%d)"):format(s), h = 0.2 })
    :against_exact { q = { 0.7 }, v = { 0.9 }, h = { 0.8, 0.4, 0.2 } }
  print(("%-24s %10.2f %10.2f %7d, %d"):format(("gauss(%d)"):format(s), e.value_slope, e.momentum_slope, 2 * s + 1, 2 * s))
end
