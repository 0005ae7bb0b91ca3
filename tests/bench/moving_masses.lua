-- make bench: midpoint where many masses move alike, L = sum_i exp(-q_i) v_i^2/2, and where a full M grows as a whole,
-- L = exp(-mean of q) v.A v/2; looks at them must not grow with n.
local dm = require "dm"

local H, REPEATS = 0.02, 5

local function alike(q, v)
  local T = 0
  for i = 1, #q do T = T + dm.exp(-q[i]) * v[i] ^ 2 / 2 end
  return T
end

-- A_ij = 1/(i + j), and 2 on the diagonal
local function whole(q, v)
  local n, T, mean = #q, 0, 0
  for i = 1, n do
    local row = 2 * v[i]
    for j = 1, n do row = row + v[j] / (i + j) end
    T, mean = T + v[i] * row / 2, mean + q[i] / n
  end
  return dm.exp(-mean) * T
end

local function measure(name, n, L, steps)
  local q, v, best = {}, {}, math.huge
  for i = 1, n do q[i], v[i] = 0, 0.5 end
  local solver = dm.system { Q = dm.R(n), L = L }:solver { rule = "midpoint", h = H }
  for _ = 1, REPEATS do
    local from = os.clock()
    solver:run { q = q, v = v, steps = steps, every = steps }
    best = math.min(best, os.clock() - from)
  end
  print(("%-44s%10.0f ns"):format(n .. " masses that move " .. name .. ", a step", 1e9 * best / steps))
end

for _, n in ipairs { 1, 5, 20, 60 } do measure("alike", n, alike, 150) end
for _, n in ipairs { 5, 20, 60 } do measure("as a whole", n, whole, n < 60 and 100 or 50) end
