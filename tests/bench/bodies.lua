-- dmlua tests/bench/bodies.lua: systems on groups, best of a few: lie(2) beside gauss(2) on a heavy top, the memory of 10^5 members, and what
-- a step of a chain of links costs a link, by the number of links (examples/link_chain.lua, swung from 0.4 rad); steps of members of an ensemble
-- of heavy tops beside steps alone; steps by the two lifts and by lie(2) on groups of all kinds, and what the first step of a system waits for.
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

for _, rule in ipairs { "rotations(2)", "lie(1)", "lie(1, gauss(1), cayley)", "lie(2)", "lie(2, gauss(2), cayley)", "gauss(2)", "gauss(8)",
  "lobatto(3)" } do
  local solver, members, steps, q, mu = top:solver { rule = rule, h = 0.05 }, 512, 200, {}, {}
  for i = 1, members do q[i], mu[i] = G:exp { 0.4 + 0.001 * i, 0, 0 }, { 0.2, 0.1, 1.5 - 5e-4 * i } end
  local function together(count)
    return best(4, function() solver:ensemble { members = members, steps = count, q = q, p = mu, threads = 1 } end)
  end
  local member = (together(steps + 1) - together(1)) / (members * steps) * 1e9
  local alone = best(4, function() solver:run { q = q[1], p = mu[1], steps = 5000, every = 5000 } end) / 5000 * 1e9
  print(("heavy tops by %s: ns a member and step %.0f, alone %.0f, %.1f times"):format(rule, member, alone, alone / member))
end

-- moments that differ, and a potential of some entries of the matrix
local moments = { 1, 1.2, 0.6, 0.9, 1.1, 0.8, 1.3, 0.7, 1.4, 0.5 }
local function system_on(Q)
  return dm.system { Q = Q, L = function(g, x)
    local m = Q:matrix(g)
    local sum = -(m[1][1] - 1) ^ 2 - m[1][2] ^ 2 - 0.3 * m[2][2]
    for i = 1, Q.dimension do sum = sum + moments[i] * x[i] ^ 2 / 2 end
    return sum
  end }
end

for _, Q in ipairs { dm.SO(3), dm.SE(2), dm.SE(3), dm.SL(2), dm.SL(3), dm.GL(3), dm.Heisenberg(3), dm.SO(4), dm.SO(5), dm.Sp(4) } do
  for _, rule in ipairs { "gauss(2)", "lobatto(3)", "verlet", "lie(1)", "lie(2)", "lie(2, gauss(2), cayley)" } do
    local clock, xi, rate = os.clock(), {}, {}
    for i = 1, Q.dimension do xi[i], rate[i] = 0.1 + 0.03 * i, 0.4 - 0.05 * i end
    local fine, solver = pcall(function()
      local solver = system_on(Q):solver { rule = rule, h = 0.02 }
      solver:run { q = Q:exp(xi), v = rate, steps = 1 }
      return solver
    end)
    local first = os.clock() - clock
    if fine then
      local n = 200
      local cost = best(5, function() solver:run { q = Q:exp(xi), v = rate, steps = n, every = n } end) / n
      print(("%s by %s%s: us a step %.2f, first step after %.0f ms"):format(Q, rule, solver.lift and ", lift " .. solver.lift or "", cost * 1e6,
        first * 1e3))
    else
      print(("%s by %s: refused"):format(Q, rule))
    end
  end
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
    local R, q, n = G:exp { 0, 0.4, 0 }, {}, 20000 // N
    for k = 1, N do q[2 * k - 1], q[2 * k] = R, R * half * (1 - 2 * k) end
    local solver = system:solver { rule = rule, h = 0.1 / N }
    local function steps(count)
      return function() solver:run { q = q, v = dm.zeros(6 * N), steps = count, every = count } end
    end
    local start = best(3, steps(1))
    local least = (best(3, steps(n + 1)) - start) / (n * N) * 1e9
    first = first or least
    print(("chain of %2d links by %s: %.1f us a link and step, %.2f of 10 links; %.1f iterations"):format(N, rule, least / 1e3, least / first,
      solver:report().newton_per_step))
  end
end
