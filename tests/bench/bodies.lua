-- dmlua tests/bench/bodies.lua: systems on groups, best of a few: lie(2) beside gauss(2) on a heavy top, the memory of 10^5 members, and what
-- a step of a chain of links costs a link, by the number of links (examples/link_chain.lua, swung from 0.4 rad).
local dm = require "dm"
local G, vector = dm.SO(3), dm.vector

local function best(turns, f)
  local least = math.huge
  for _ = 1, turns do
    local t = os.clock()
    f()
    least = math.min(least, os.clock() - t)
  end
  return least
end

local top = dm.system { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end }
local tilted, p, cost = G:exp { 0.4, 0, 0 }, { 0.2, 0.1, 1.5 }, {}
for _, rule in ipairs { "gauss(2)", "lie(2)" } do
  local solver, n = top:solver { rule = rule, h = 0.05 }, 2000
  cost[rule] = best(10, function() solver:run { q = tilted, p = p, steps = n, every = n } end) / n * 1e9
end
print(("heavy top, ns a step: gauss(2) %.0f, lie(2) %.0f, %.1f times"):format(cost["gauss(2)"], cost["lie(2)"], cost["lie(2)"] / cost["gauss(2)"]))
for _, rule in ipairs { "rotations(2)", "gauss(2)", "lie(2)" } do
  collectgarbage()
  local before = collectgarbage "count"
  local cloud = top:solver { rule = rule, h = 0.05 }:ensemble { members = 1e5, steps = 1, q = function() return tilted end, p = function() return p end }
  collectgarbage()
  print(("10^5 heavy tops by %s: %.0f MB (%d members)"):format(rule, (collectgarbage "count" - before) / 1024, #cloud))
end

local function chain(N)
  local factors, I, half = {}, { 1 / N ^ 2 / 12, 1 / N ^ 2 / 12, 1 / N ^ 2 / 200 }, vector { 0, 0, 0.5 / N }
  for k = 1, N do factors[2 * k - 1], factors[2 * k] = G, dm.R(3) end
  return dm.system { Q = dm.product(table.unpack(factors)), L = function(q, v)
    local sum = 0
    for i = 1, 6 * N do sum = sum + (I[(i - 1) % 6 + 1] or 1) * v[i] ^ 2 / 2 end
    for k = 1, N do sum = sum - q[2 * k][3] end
    return sum / N
  end, constraint = function(q)
    local out, above = {}, vector { 0, 0, 0 }
    for k = 1, N do
      local x, arm = q[2 * k], q[2 * k - 1] * half
      for i = 1, 3 do out[#out + 1] = (x + arm - above)[i] end
      above = x - arm
    end
    return out
  end }, half
end

for _, rule in ipairs { "lie(1)", "lie(1, gauss(1), cayley)" } do
  local first
  for _, N in ipairs { 10, 20, 40, 80 } do
    local system, half = chain(N)
    local R, q, n = G:exp { 0, 0.4, 0 }, {}, 2000 // N
    for k = 1, N do q[2 * k - 1], q[2 * k] = R, R * half * (1 - 2 * k) end
    local solver = system:solver { rule = rule, h = 0.1 / N }
    local function steps(count)
      return function() solver:run { q = q, v = dm.zeros(6 * N), steps = count, every = count } end
    end
    local start = best(5, steps(1))
    local least = (best(5, steps(n + 1)) - start) / (n * N) * 1e9
    first = first or least
    print(("chain of %2d links by %s: %.1f us a link and step, %.2f of 10 links; %.1f iterations"):format(N, rule, least / 1e3, least / first,
      solver:report().newton_per_step))
  end
end
