-- make bench: what a step costs when the group is reduced, against the same rule unreduced, with one
-- shape beside SO(2), SE(2), SO(3) and SE(3): point masses, one of which slides, whose kinetic energy
-- is written with their velocities in space, g hat(xi) r. And what exact formulas of curves under
-- SE(3) cost. The sides take turns, best of many.
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
    for k = 1, 4 do
      local u = dm.zeros(n):totable()
      u[1] = k == 1 and v[1] or 0
      local w = g * (xi * place(k, x) + dm.vector(u))
      sum = sum + (1 + 0.1 * k) * w:dot(w) / 2
    end
    return sum
  end
end

local function best(run, options)
  local least = math.huge
  local before = dm.cpu()
  run(options)
  least = math.min(least, (dm.cpu() - before) / STEPS)
  return least
end

for _, row in ipairs { { "SO(2)", dm.SO(2) }, { "SE(2)", dm.SE(2) }, { "SO(3)", dm.SO(3) },
  { "SE(3)", dm.SE(3) } } do
  local G = row[2]
  local r = G.dimension
  local system = dm.system { Q = dm.product(R1, G), L = body(G) }
  local reduced = system:reduce { group = G, rule = "lie(1)", h = 0.05 }:solver()
  local full, mu, p = system:solver { rule = "lie(1)", h = 0.05 }, {}, { 0.1 }
  for i = 1, r do mu[i], p[1 + i] = 0.9 / i, 0.9 / i end
  local q = { { 0.4 }, G:identity() }
  local a, b = math.huge, math.huge
  for _ = 1, TIMES do
    a = math.min(a, best(function() reduced:run { x = 0.4, p = 0.1, mu = mu, steps = STEPS,
      every = STEPS } end))
    b = math.min(b, best(function() full:run { q = q, p = p, steps = STEPS, every = STEPS } end))
  end
  print(("lie(1), a shape and %s: %.0f ns a step reduced, %.0f unreduced (%.2f)"):format(row[1],
    a * 1e9, b * 1e9, a / b))
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
