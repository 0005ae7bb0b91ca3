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

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function step_of(rule)
  local solver, best = kepler:solver { rule = rule, h = 0.05 }, math.huge
  for _ = 1, 10 do
    best = math.min(best, solver:run { q = { 0.5, 0 }, v = { 0, sqrt(3) }, steps = 20000, every = 20000 }.ns_per_step)
  end
  return best
end
local plain = step_of "midpoint"
for _, rule in ipairs { "sem(1, gauss(1))", "sem(2, gauss(2))" } do
  local ns = step_of(rule)
  print(("%-34s %8.0f ns, midpoint %.0f ns: %.1f times"):format(rule .. ", a step", ns, plain, ns / plain))
end
