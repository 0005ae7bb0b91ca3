-- make bench: fields on meshes. Leapfrog of waves and of Maxwell's equations on the hexagonal torus, by hand in C:
-- tests/bench/c/by_hand/fields.c; events of avi beside cells of the synchronous step; how time and memory grow.
-- Arguments: N of the torus, N of the largest one.
local dm = require "dm"

local STEPS, REPEATS, MANY = 40, 9, 60
local N, LARGEST = tonumber(arg[1]) or 60, tonumber(arg[2]) or 577
local WHAT = { [0] = "wave", "Maxwell" }

local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end

local function start_of(K, degree)
  local q = {}
  for i = 1, K:count(degree) do q[i] = math.sin(i) end
  return dm.vector(q)
end

-- the least time of a step, in ns an unknown
local function least(solver, q, steps, repeats)
  local best = math.huge
  for _ = 1, repeats do
    best = math.min(best, solver:run({ q = q, v = 0 * q, steps = steps, every = steps }).ns_per_step)
  end
  return best / #q
end

local function row(text, value, unit, more)
  print(("%-36s %9.2f %s   %s"):format(text, value, unit, more or ""))
end

local function leapfrog(K, degree)
  local field, q = K:field { form = degree, L = wave }, start_of(K, degree)
  local h = 0.5 * field:stability_limit "verlet"
  for _, sums in ipairs { "plain", "compensated" } do
    for threads = 1, 2 do
      local solver = field:solver { rule = "verlet", h = h, sums = sums, threads = threads }
      row(("%s, leapfrog, %s, %d thread%s"):format(WHAT[degree], sums, threads, threads > 1 and "s" or ""),
        least(solver, q, STEPS, MANY), "ns an unknown", ("(%d)"):format(#q))
    end
  end
end

-- midpoint steps at half the explicit limit, without the first one, which finds the ordering (and where the equation is
-- linear the factors of all); by hand in C: tests/bench/c/by_hand/midpoint.c
local function midpoint(K, what, degree, L)
  local field, q, few, many = K:field { form = degree, L = L }, start_of(K, degree), math.huge, math.huge
  local solver = field:solver { rule = "midpoint", h = 0.5 * K:field { form = degree, L = wave }:stability_limit "verlet" }
  local function seconds(steps)
    local began = dm.cpu()
    solver:run { q = q, v = 0 * q, steps = steps, every = steps }
    return dm.cpu() - began
  end
  for _ = 1, REPEATS do
    few, many = math.min(few, seconds(1)), math.min(many, seconds(STEPS + 1))
  end
  row(what .. ", midpoint", (many - few) / STEPS / #q * 1e9, "ns an unknown", ("(%d)"):format(#q))
end

-- an event of avi, and a cell of the synchronous step
local function asynchronous(K)
  local field, q = K:field { form = 1, L = wave }, start_of(K, 1)
  local h = 0.25 * field:stability_limit "verlet"
  local cells, verlet = K:count(2), least(field:solver { rule = "verlet", h = h }, q, STEPS, REPEATS)
  local steps = {}
  for i = 1, cells do steps[i] = h * (0.5 + 0.6180339887498949 * i % 1) end
  local solver, best = field:solver { rule = "avi", h = steps }, math.huge
  for _ = 1, 5 do
    local c = os.clock()
    solver:run { q = q, v = 0 * q, t = 2 * h, at = { 2 * h } }
    local long, few = os.clock(), solver:report().events
    solver:run { q = q, v = 0 * q, t = 62 * h, at = { 62 * h } }
    best = math.min(best, (os.clock() - long - (long - c)) / (solver:report().events - few) * 1e9)
  end
  row("Maxwell, avi", best, "ns an event", ("(a cell of leapfrog: %.2f)"):format(verlet * #q / cells))
end

-- bytes that are reached: what is made for fields is of the collector's memory, and the process keeps what was freed
local function held()
  collectgarbage() collectgarbage()
  return 1024 * collectgarbage "count"
end

local function growth(size)
  local K = dm.mesh { hex_torus = size }
  local q = start_of(K, 1)
  local v = 0 * q
  K:star_weights(1)
  local before, c = held(), dm.cpu()
  local field = K:field { form = 1, L = wave }
  local made = dm.cpu() - c
  local solver = field:solver { rule = "verlet", h = 0.1 / size }
  local run = solver:run { q = q, v = v, steps = 1 }
  local traced, with_run = solver:report().trace_ms, held()
  run = run and nil
  local holds = held()
  local ns = least(field:solver { rule = "verlet", h = 0.1 / size, sums = "plain" }, q, STEPS, REPEATS)
  row(("Maxwell, %d unknowns"):format(#q), ns, "ns an unknown", ("set-up %.0f ns, %.0f bytes an unknown beside the mesh, %.0f with a run of two rows; traced in %.2f ms")
    :format(made / #q * 1e9, (holds - before) / #q, (with_run - before) / #q, traced))
end

print "\nfields on meshes"
local K = dm.mesh { hex_torus = N }
midpoint(K, "wave", 0, wave)
midpoint(K, "Maxwell", 1, wave)
midpoint(K, "sine-Gordon", 0, function(u, v)
  return wave(u, v) - K:sum(0, function(a, cell) return cell.star * (1 - dm.cos(a)) end, u)
end)
for _, quartic in ipairs { 1e-3, 1 } do
  midpoint(K, ("wave - %g u^4"):format(quartic), 0, function(u, v)
    return wave(u, v) - K:sum(0, function(a, cell) return cell.star * quartic * a ^ 4 end, u)
  end)
end
leapfrog(K, 0)
leapfrog(K, 1)
asynchronous(K)
for _, size in ipairs { 60, 182, LARGEST } do growth(size) end
