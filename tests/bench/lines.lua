-- make bench: fields on lines. A sine-Gordon step on bilinear cells by 2 x 2 Gauss points, to round-off; by hand in C:
-- tests/bench/c/by_hand/line_cells.c. Argument: cells.
local dm = require "dm"

local STEPS, REPEATS = 40, 15
local g = 1 / math.sqrt(0.75)

local function race(cells)
  local field = dm.field { x = { -15, 15, cells }, fixed = "ends",
    L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 - (1 - dm.cos(u)) end }
  local solver, best, run = field:solver { rule = "cell(gauss(2))", h = 15 / cells }, math.huge, nil
  local u, ut = {}, {}
  for i = 0, cells do
    local x = -15 + 30 / cells * i
    u[i + 1], ut[i + 1] = 4 * math.atan(math.exp(g * x)), -g / dm.cosh(g * x)
  end
  for _ = 1, REPEATS do
    run = solver:run { u = u, ut = ut, steps = STEPS, every = STEPS }
    best = math.min(best, run.ns_per_step)
  end
  print(("%-28s dmlua                %9.1f ns a cell   (%d cells, u = %.6f)"):format("sine-Gordon cell step", best / cells, cells,
    run.u[2][cells // 2 + 1]))
end

-- KdV's soliton by boxes, all four components; by hand in C, u alone: tests/bench/c/by_hand/kdv.c
local function boxes(N)
  local kdv = dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" }, M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } },
    K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } }, x = { -20, 20, N, periodic = true },
    S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end }
  local solver, few, many, run = kdv:solver { h = 0.02 * 129 / N }, math.huge, math.huge, nil
  local function seconds(steps)
    local began = os.clock()
    run = solver:run { z = { u = function(x) return 2 / dm.cosh(x) ^ 2 end }, steps = steps, every = steps }
    return os.clock() - began
  end
  for _ = 1, REPEATS do
    few, many = math.min(few, seconds(1)), math.min(many, seconds(50)) -- a run has a trace of its own
  end
  print(("%-28s dmlua                %9.1f ns a node   (%d nodes, u = %.6f)"):format("KdV by boxes", (many - few) / 49 / N * 1e9, N, run.u[2][N // 2 + 1]))
end

-- a flow on a sphere: midpoint steps to round-off, each sweep a solve of Poisson's equation
local function flow(level)
  local K = dm.mesh { icosphere = level }
  local euler = K:euler { vorticity = function(x, y, z) return 2 * z + 6 * z * (x ^ 3 - 3 * x * y ^ 2) end }
  local solver, best, run = euler:solver { rule = "midpoint", h = 0.4 / 2 ^ level }, math.huge, nil
  for _ = 1, 5 do
    local began = os.clock()
    run = solver:run { steps = 10, every = 10 }
    best = math.min(best, os.clock() - began)
  end
  local sweeps, b, bare = run.sweeps * 10, K:form(0, function(x, y, z) return x * y + z end), math.huge
  for _ = 1, 5 do
    local began = os.clock()
    K:poisson { f = b }
    bare = math.min(bare, os.clock() - began)
  end
  print(("%-28s dmlua                %9.1f ns a vertex and sweep   (%d vertices, %.1f sweeps a step; K:poisson alone %.1f)"):format("Euler flow",
    best / sweeps / K:count(0) * 1e9, K:count(0), run.sweeps, bare / K:count(0) * 1e9))
end

print "\nfields on lines, flows"
race(tonumber(arg[1]) or 1000)
boxes(513)
flow(5)
