--- Is a function that vanishes at samples zero everywhere in a box? Its bounds tell where they are
-- zero; else the boxes with the largest ones are cut in two, and their middles looked at: so that
-- what is narrower than samples are apart is found. Bounds of what cancels by formula are exact, as
-- of cyclic coordinates; where it cancels by numbers only, as in Cartesian ones, they stay wide and
-- the search ends with its budget.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local abs, max = math.abs, math.max
local BOXES = 160 -- a bump of 1e-4 of the box in two coordinates takes 80

-- the largest |f| that a box may hold, infinite where nothing is known
local function bound(f, low, high)
  local fine, least, most = blame.try(f.bounds, f, low, high)
  local size = fine and max(abs(least), abs(most)) or math.huge
  return size == size and size or math.huge
end

local function with(list, i, x)
  local out = table.move(list, 1, #list, 1, {})
  out[i] = x
  return out
end

-- the coordinates that f(z) depends on
local function free_of(f, low, high)
  local n, out = #low, {}
  local fine, least, most = blame.try(function()
    local gradient = core.derivative(f, n)
    return core.trace(function(z) return gradient(z) end, n):bounds(low, high)
  end)
  for i = 1, n do
    if not fine or least[i] ~= 0 or most[i] ~= 0 then out[#out + 1] = i end
  end
  return out
end

-- the box with the largest bound; or, in turn with it, the largest of the smallest boxes: along
-- ridges there are too many of one size
local function take(boxes, deep)
  local best = 1
  for k = 2, #boxes do
    local a, b = boxes[k], boxes[best]
    local deeper = deep and a.depth - b.depth or 0
    if deeper > 0 or deeper == 0 and a.size > b.size then best = k end
  end
  return #boxes > 0 and table.remove(boxes, best)
end

--- look(z) at every z found between the lists low and high at which |f(z)| is above `least`: it
-- raises where that is too much. Nothing where f cannot be traced.
function M.search(given, low, high, least, look)
  local traced, f = blame.try(core.trace, given, #low)
  if not traced then return end
  local boxes = { { low = low, high = high, depth = 0, size = bound(f, low, high) } }
  if boxes[1].size <= least then return end
  local free = free_of(given, low, high)
  if #free == 0 then return end -- a number, which samples have
  for round = 1, BOXES do
    local box = take(boxes, round % 2 == 0)
    if not box then return end
    local i = free[box.depth % #free + 1]
    local middle = (box.low[i] + box.high[i]) / 2
    for half = 1, 2 do
      local a = half == 1 and box.low or with(box.low, i, middle)
      local b = half == 2 and box.high or with(box.high, i, middle)
      local z, size = {}, bound(f, a, b)
      for k = 1, #a do z[k] = (a[k] + b[k]) / 2 end
      local fine, value = blame.try(f, z)
      if fine and abs(value) > least then look(z) end
      if size > least then
        boxes[#boxes + 1] = { low = a, high = b, depth = box.depth + 1, size = size }
      end
    end
  end
end

--- Ends of a box about the samples, lists of as many numbers: as far out again as they are apart.
function M.box(samples)
  local low, high = {}, {}
  for i = 1, samples[1] and #samples[1] or 0 do
    local a, b = math.huge, -math.huge
    for _, z in ipairs(samples) do a, b = math.min(a, z[i]), max(b, z[i]) end
    low[i], high[i] = 2 * a - b, 2 * b - a
  end
  return low, high
end

return M
