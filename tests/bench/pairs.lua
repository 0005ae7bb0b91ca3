-- make bench: Verlet steps of bodies in pairs: all pairs of 1000 stars, and 864 Lennard-Jones atoms by lists. By hand in C:
-- tests/bench/c/by_hand/pairs.c, which make bench runs after it. Argument: threads.
local dm = require "dm"

local STEPS, REPEATS = 40, 9
local golden = 0.618033988749895
local threads = tonumber(arg[1]) or 1

-- The time of so many steps more, as the machine may be busy: CPU time of one thread, wall time of several
local function race(name, pairs, h, system, q, v)
  local solver, few, many, run = system:solver { rule = "verlet", h = h, threads = threads }, math.huge, math.huge, nil
  local clock = threads > 1 and dm.clock or dm.cpu
  local function seconds(steps)
    local began = clock()
    run = solver:run { q = q, v = v, steps = steps, every = steps }
    return clock() - began
  end
  for _ = 1, REPEATS do
    few, many = math.min(few, seconds(1)), math.min(many, seconds(STEPS))
  end
  print(("%-28s dmlua                %9.2f ns a pair   (%d bodies%s, x = %.9f)"):format(name, (many - few) / (STEPS - 1) / pairs * 1e9, #q // 3,
    threads > 1 and (", %d threads"):format(threads) or "", run.q[2][1]))
end

local function stars(n)
  local q, v, mass, soft = {}, {}, {}, 0.02
  for i = 1, n do
    mass[i] = 1 / n
    for k = 0, 2 do q[3 * i - 2 + k], v[3 * i - 2 + k] = i * (golden + 0.13 * k) % 1, 0 end
  end
  race("all pairs", n * (n - 1) / 2, 1e-3, dm.system { Q = dm.R(3 * n), L = function(x, u)
    return dm.sum_over(u, mass, function(w, m) return m * w:dot(w) / 2 end, { block = 3 })
      + dm.sum_over(x, mass, function(a, m, b, k) local d = a - b return m * k / dm.sqrt(d:dot(d) + soft ^ 2) end, { pairs = true, block = 3 })
  end }, q, v)
end

local function atoms(side, cut)
  local n, q, v, corner = 4 * side ^ 3, {}, {}, { { 0, 0, 0 }, { 0.5, 0.5, 0 }, { 0.5, 0, 0.5 }, { 0, 0.5, 0.5 } }
  local box, near = (n / 0.8442) ^ (1 / 3), 0
  for i = 0, n - 1 do
    local c = i // 4
    local at = { c // side // side, c // side % side, c % side }
    for k = 1, 3 do
      q[3 * i + k] = (at[k] + corner[i % 4 + 1][k]) * box / side
      v[3 * i + k] = 3.6 * ((3 * i + k) * golden % 1 - 0.5)
    end
  end
  local L = function(x, u)
    return dm.sum_over(u, function(w) return w ^ 2 / 2 end) - dm.sum_over(x, function(a, b)
      local d = a - b
      local s = 1 / d:dot(d) ^ 3
      return 4 * (s * s - s)
    end, { pairs = true, block = 3, within = cut, margin = 0.3, box = box })
  end
  near = dm.sum_over(q, function(a, b) return 0 * a[1] * b[1] + 1 end, { pairs = true, block = 3, within = cut, box = box })
  race("pairs by lists", near, 0.004, dm.system { Q = dm.R(3 * n), L = L }, q, v)
end

print "\npairs of bodies"
stars(1000)
atoms(6, 2.5)
