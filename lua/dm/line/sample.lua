--- Numbers at which the L of a field on a line is looked at.
local core = require "dm.core"

local M = {}

--- u, ut, ux of n values between 0.1 and 0.9, numbers where n is 1, from row `row` of a stream of
-- random numbers (core.random); ut[changed] is another one than without `changed`.
function M.of(random, row, n, changed)
  local out = {}
  for which = 1, 3 do
    local w = core.zeros(n)
    for k = 1, n do w[k] = 0.1 + 0.8 * random:uniform(row, 3 * k + which) end
    if which == 2 and changed then w[changed] = w[changed] + 0.05 end
    out[which] = n == 1 and w[1] or w
  end
  return out[1], out[2], out[3]
end

return M
