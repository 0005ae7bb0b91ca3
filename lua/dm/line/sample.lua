--- What the L of a field on a line is: numbers at which it is looked at, and its trace.
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

-- L of a field on a line, traced; t is later(t)
local function traced(field, later)
  local each = field.values == 1 and "number" or field.values
  local function L(u, ut, ux, x, t) return field.L(u, ut, ux, x, later(t)) end
  return core.trace(L, each, each, each, "number", "number")
end

--- What L of a field on a line computes now, as a text (core.fingerprint).
function M.of_L(field) return core.fingerprint(traced(field, function(t) return t end)) end

--- The same of S of boxes.
function M.of_S(boxes)
  return core.fingerprint(core.trace(function(z) return boxes.S(z) end, boxes.d))
end

--- Does L not depend on t? Then it is the same function of any other time.
function M.is_autonomous(field)
  return M.of_L(field) == core.fingerprint(traced(field, function(t) return 2 * t + 1 end))
end

return M
