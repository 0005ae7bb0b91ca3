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

print "\nfields on lines"
race(tonumber(arg[1]) or 1000)
