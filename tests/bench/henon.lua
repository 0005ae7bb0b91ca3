-- Henon-Heiles over t = 10^4 and 5 10^4: largest error of the energy and CPU time of the whole run.
--   build/dmlua tests/bench/henon.lua
-- The start and the two first rows are those of a published table (SciML's benchmarks of energy conservation).
local dm = require "dm"

local star = dm.system { name = "Henon-Heiles", Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 - (q:dot(q) + 2 * q[1] ^ 2 * q[2] - 2 * q[2] ^ 3 / 3) / 2
end }

print(("%-24s %6s %9s %10s %12s %9s"):format("rule", "h", "t", "steps", "|E - E0|", "s"))
for _, case in ipairs { { "kahan-li(8)", 0.01 }, { "sofroniou-spaletta(10)", 0.01 }, { "kahan-li(8)", 0.1 },
  { "sofroniou-spaletta(10)", 0.2 }, { "gauss(6)", 0.25 }, { "gauss(8)", 0.25 }, { "rk8", 0.1 } } do
  for _, t in ipairs { 1e4, 5e4 } do
    local solver = star:solver { rule = case[1], h = case[2] }
    local start = os.clock()
    local path = solver:run { q = { 0.1, 0 }, v = { 0, 0.5 }, t = t, every = 100, watch = { "energy" } }
    local seconds = os.clock() - start
    print(("%-24s %6g %9g %10d %12.2e %9.4f"):format(case[1], case[2], t, path.steps, path:drift("energy").largest, seconds))
  end
end
