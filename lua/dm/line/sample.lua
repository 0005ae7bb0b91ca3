--- Numbers at which the L of a field on a line is looked at.
local blame = require "dm.base.blame"
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

--- f(...) as a number; NaN where it is none.
function M.number(f, ...)
  local fine, value = blame.try(f, ...)
  return fine and type(value) == "number" and value or 0 / 0
end

--- L of a field on a line at four such places of its line, by a time for each; time(row): when.
function M.values_of(field, time)
  local random, out = core.random(17), {}
  for row = 1, 4 do
    local u, ut, ux = M.of(random, row, field.values)
    local x = field.from + (field.to - field.from) * random:uniform(row, 0)
    out[row] = M.number(field.L, u, ut, ux, x, time and time(row) or 0.3 * row)
  end
  return out
end

--- Are numbers of values_of those of another time? NaN is NaN.
function M.same(a, b)
  for i = 1, #a do
    if a[i] ~= b[i] and (a[i] == a[i] or b[i] == b[i]) then return false end
  end
  return true
end

--- S of boxes at four random z.
function M.values_of_S(boxes)
  local random, out = core.random(17), {}
  for row = 1, 4 do
    local z = core.zeros(boxes.d)
    for c = 1, boxes.d do z[c] = 0.1 + 0.8 * random:uniform(row, c) end
    out[row] = M.number(boxes.S, z)
  end
  return out
end

--- Does L not depend on t? Looked at with numbers.
function M.is_autonomous(field)
  local now, later = M.values_of(field),
    M.values_of(field, function(row) return 0.7 + 0.4 * row end)
  for row = 1, #now do
    local a, b = now[row], later[row]
    if a ~= b and a == a and b == b then return false end
  end
  return true
end

return M
