-- make bench: midpoint where many masses move alike, L = sum_i exp(-q_i) v_i^2/2; looks at them must not grow with n.
local dm = require "dm"

local H, STEPS, REPEATS = 0.02, 150, 5

for _, n in ipairs { 1, 5, 20, 60 } do
  local system = dm.system { Q = dm.R(n), L = function(q, v)
    local sum = 0
    for i = 1, n do sum = sum + dm.exp(-q[i]) * v[i] ^ 2 / 2 end
    return sum
  end }
  local q, v, best = {}, {}, math.huge
  for i = 1, n do q[i], v[i] = 0, 0.5 end
  local solver = system:solver { rule = "midpoint", h = H }
  for _ = 1, REPEATS do
    local from = os.clock()
    solver:run { q = q, v = v, steps = STEPS, every = STEPS }
    best = math.min(best, os.clock() - from)
  end
  print(("%-44s%10.0f ns"):format(n .. " masses that move alike, a step", 1e9 * best / STEPS))
end
