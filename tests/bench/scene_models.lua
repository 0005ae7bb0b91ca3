-- tests/bench/scene_models.lua [COUNT [SEED]] - random models through dm.scene, against references in long double by a program in C: answers that err by more
-- than the tolerance or than they say, at 10^4 times and on lines between rows; refusals; scenes that take more than 1.2 times their seconds. 300 by default.
package.path = "tests/lua/scene/?.lua;" .. package.path
local models = require "scene_models"
local count, seed, SECONDS = tonumber(arg[1]) or 300, tonumber(arg[2]) or 1, 1

local list = models.make(count, seed)
if not models.solve(list, 10000) then
  print "skipped  random models: install a C compiler"
  return
end
local kinds, rows, all = {}, {}, { kind = "all", n = 0, wrong = 0, refused = 0, late = 0, seconds = 0 }
local function add(row, found)
  row.n, row.seconds = row.n + 1, row.seconds + found.seconds
  row.refused = row.refused + (found.refused and 1 or 0)
  row.wrong = row.wrong + (found.refused == nil and not found.kept and 1 or 0)
  row.late = row.late + (found.seconds > 1.2 * SECONDS and 1 or 0)
end
for k, m in ipairs(list) do
  local found, row = models.try(m, SECONDS), kinds[m.kind]
  if not row then
    row = { kind = m.kind, n = 0, wrong = 0, refused = 0, late = 0, seconds = 0 }
    kinds[m.kind], rows[#rows + 1] = row, row
  end
  add(row, found)
  add(all, found)
  if found.refused then print(("model %d, %s, is refused: %s"):format(k, m.kind, found.refused)) end
  if found.refused == nil and not found.kept then
    print(("model %d, %s, is wrong: off by %.3g of %g, estimate %.3g"):format(k, m.kind, found.worst, m.tolerance, found.estimate))
  end
end
rows[#rows + 1] = all
print(("random models, seed %d, %g s each   count  wrong  refused  over time   mean s"):format(seed, SECONDS))
for _, row in ipairs(rows) do
  print(("%-34s %5d  %5d  %7d  %9d   %6.2f"):format(row.kind, row.n, row.wrong, row.refused, row.late, row.seconds / row.n))
end
