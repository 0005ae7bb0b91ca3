-- make bench: what a step costs when the group is reduced, against the same rule unreduced, with one
-- shape beside SO(2), SE(2), SO(3) and SE(3): point masses, one of which slides on springs to the
-- others, written in space: velocities g hat(xi) r, places g r. The memory of a run, and what exact
-- formulas of curves under SE(3) cost. The sides take turns, best of many.
local dm = require "dm"

local STEPS, TIMES = 4000, 12
local R1 = dm.R(1)

-- masses at these places of the body, in the homogeneous coordinates of a matrix group
local function body(G)
  local n = G:matrix(G:identity()).rows
  local moving = G:hat(dm.zeros(G.dimension)).rows
  local affine = tostring(G):find "SE" ~= nil
  local function place(k, x)
    local r = {}
    for i = 1, n do r[i] = ((k + i) % 3 - 0.7) * (1 + 0.2 * i) end
    if k == 1 then r[1] = x end
    if affine then r[n] = 1 end
    return dm.vector(r)
  end
  assert(moving == n)
  return function(q, v)
    local x, g, xi, sum = q[1][1], G:matrix(q[2]), G:hat(v:slice(2, 1 + G.dimension)), -q[1][1] ^ 2
    local sliding = g * place(1, x)
    for k = 2, 4 do
      local gap = sliding - g * place(k, x)
      sum = sum - (dm.sqrt(gap:dot(gap)) - 1) ^ 2 / 2
    end
    for k = 1, 4 do
      local u = dm.zeros(n):totable()
      u[1] = k == 1 and v[1] or 0
      local w = g * (xi * place(k, x) + dm.vector(u))
      sum = sum + (1 + 0.1 * k) * w:dot(w) / 2
    end
    return sum
  end
end

local function once(run, options)
  local before = dm.cpu()
  run(options)
  return (dm.cpu() - before) / STEPS
end

-- two runs with the group, and one that keeps all its rows
local function sides(G, rule)
  local system = dm.system { Q = dm.product(R1, G), L = body(G) }
  local solver = system:reduce { group = G, rule = rule, h = 0.05 }:solver()
  local full, mu, p = system:solver { rule = rule, h = 0.05 }, {}, { 0.1 }
  for i = 1, G.dimension do mu[i], p[1 + i] = 0.9 / i, 0.9 / i end
  local q = { { 0.4 }, G:identity() }
  local function reduced(steps, every)
    return solver:run { x = 0.4, p = 0.1, mu = mu, steps = steps, every = every }
  end
  return function() reduced(STEPS, STEPS) end, function()
    full:run { q = q, p = p, steps = STEPS, every = STEPS }
  end, reduced
end

local function memory()
  for line in io.lines "/proc/self/status" do
    local size = line:match "^VmHWM:%s+(%d+)"
    if size then return 1024 * tonumber(size) end
  end
end

local all
for _, rule in ipairs { "lie(1)", "lie(2)" } do
  for _, G in ipairs { dm.SO(2), dm.SE(2), dm.SO(3), dm.SE(3) } do
    local reduced, full, run = sides(G, rule)
    local a, b = math.huge, math.huge
    for _ = 1, TIMES do a, b = math.min(a, once(reduced)), math.min(b, once(full)) end
    print(("%s, a shape and %s: %.0f ns a step reduced, %.0f unreduced (%.2f)"):format(rule,
      tostring(G), a * 1e9, b * 1e9, a / b))
    all = run
  end
end
local rows, before = 400000, memory()
local path = all(rows)
if before then
  print(("a reduced run of %d rows: %.0f bytes a row, of %d numbers"):format(rows,
    (memory() - before) / rows, 1 + #path.path.q[1][1] + 7 + #path.path.p[1]))
end

local least = math.huge
for _ = 1, 5 do
  local before = dm.cpu()
  local space = dm.differential_invariants { action = dm.action { group = dm.SE(3), on = dm.R(3) },
    independent = 1, invariants = { kappa = 6, w = 9 }, branch = function(z) return z[6] end,
    cross_section = function(z) return { z[1], z[2], z[3], z[4], z[5], z[7] } end }
  space:euler_lagrange(function(I) return I.kappa[1] ^ 2 / 2 + I.w[1] ^ 2 end)
  least = math.min(least, dm.cpu() - before)
end
print(("formulas of SE(3), curves and their Euler-Lagrange equations: %.0f ms"):format(least * 1e3))
