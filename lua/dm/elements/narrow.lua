--- What integrals by points of panels have not seen: places where a function that can be traced
-- leaves what its samples on a panel are. Its bounds in boxes, which hold every value, tell where
-- to look.
local blame = require "dm.base.blame"
local core = require "dm.core"
local integrals = require "dm.elements.integrals"

local M = {}

local abs, max, min = math.abs, math.max, math.min

local UNLIKE, SMALL = 0.5, 1e-2 -- of the range of the samples, of their size: more is a feature
local NOTHING = 1e-15           -- of the integral of |f|: a part so small counts for nothing
local DEEPEST, BOXES = 48, 20000
local LEAST = 1e-290

-- the least, the largest and the largest |f| of the samples of a panel
local function samples(f, a, b)
  local low, high = math.huge, -math.huge
  for _, x in ipairs(integrals.points(a, b)) do
    local y = f(x)
    low, high = min(low, y), max(high, y)
  end
  return low, high, max(abs(low), abs(high))
end

-- Is there more in [a, b] than between low and high? Then marks get the middles on the way there.
local function look(s, a, b, low, high, depth)
  local least, most = s.bounded:bounds(a, b)
  s.left = s.left - 1
  local size = max(abs(least), abs(most))
  if least >= low and most <= high or depth == 0 or s.left < 0
    or size <= LEAST or (b - a) * size <= NOTHING * s.integral then
    return false
  end
  local found_low, found_high = samples(s.f, a, b)
  if found_low < low or found_high > high then return true end
  local middle = (a + b) / 2
  local left = look(s, a, middle, low, high, depth - 1)
  local right = look(s, middle, b, low, high, depth - 1)
  if left or right then s.marks[#s.marks + 1] = middle end
  return left or right
end

--- Places, growing, at which panels must end so that f is seen as it is; none where all is seen
-- between the edges, or `given`, f as a script gave it, cannot be traced.
function M.marks(f, given, edges)
  local fine, bounded = blame.try(core.trace, given, "number")
  if not fine then return {} end
  local panels, s = {}, { f = f, bounded = bounded, marks = {}, integral = 0, left = BOXES }
  for i = 2, #edges do
    local low, high, size = samples(f, edges[i - 1], edges[i])
    panels[i] = { low, high, size }
    s.integral = s.integral + size * (edges[i] - edges[i - 1])
  end
  for i = 2, #edges do
    local low, high, size = table.unpack(panels[i])
    local slack = UNLIKE * (high - low) + SMALL * size
    look(s, edges[i - 1], edges[i], low - slack, high + slack, DEEPEST)
  end
  table.sort(s.marks)
  return s.marks
end

return M
