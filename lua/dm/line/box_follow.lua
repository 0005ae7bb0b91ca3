--- Components of boxes that follow from others by rows without z_t, between means and differences
-- of neighbouring nodes.
local algebra = require "dm.line.box_algebra"
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local is_zero = algebra.is_zero
local WHERE = "solver:run"

-- of a row: unknown components by K and by S
local function unknowns_of(boxes, r, known)
  local by_K, by_S = {}, {}
  for c = 1, boxes.d do
    if not known[c] and boxes.K[r][c] ~= 0 then by_K[#by_K + 1] = c end
    if not known[c] and algebra.depends(boxes, c, r) then by_S[#by_S + 1] = c end
  end
  return by_K, by_S
end

local function right(boxes, i) return i == boxes.cells and 1 or i + 1 end

--- Means of the known components over box i; others are 0.
function M.mean(boxes, known, i)
  local z = core.zeros(boxes.d)
  for c, values in pairs(known) do z[c] = (values[i] + values[right(boxes, i)]) / 2 end
  return z
end

local mean = M.mean

--- Slopes of S, by boxes.gradient or boxes.hessian, at z in box i. Raises where there are none.
function M.slopes(f, z, i)
  local fine, out = blame.try(f, z)
  if fine then return out end
  option.fail(WHERE, "S of the start has no slopes in the box at node %d: is it inside of the "
    .. "domain of S?", i)
end

local slopes_of = M.slopes

--- Sum of K[r][c] D_x z_c over known components in box i.
function M.differences(boxes, r, known, i)
  local sum = 0
  for c, values in pairs(known) do
    local slope = (values[right(boxes, i)] - values[i]) / boxes.dx + (boxes.slope[c] or 0)
    sum = sum + boxes.K[r][c] * slope
  end
  return sum
end

local differences = M.differences

local CLOSED = 1e-9 -- of its terms: a sum round the ring that is 0

-- K[r][c] D_x z_c = S_r - ...: a sum along the ring; what it gains is its slope
local function integrate(boxes, r, c, known)
  local out, slopes, total, terms = core.zeros(boxes.cells), {}, 0, 0
  for i = 1, boxes.cells do
    local gradient = slopes_of(boxes.gradient, mean(boxes, known, i), i)
    local S_r, D = gradient[r], differences(boxes, r, known, i)
    slopes[i] = (S_r - D) / boxes.K[r][c]
    total = total + slopes[i]
    terms = terms + (math.abs(S_r) + math.abs(D)) / math.abs(boxes.K[r][c])
  end
  local slope = total / boxes.cells
  if not boxes.gain[c] and math.abs(total) > CLOSED * terms then
    option.fail(WHERE, "'%s' gains %.6g round the ring: name it in gain = { \"%s\" }",
      boxes.names[c], total * boxes.dx, boxes.names[c])
  end
  for i = 2, boxes.cells do out[i] = out[i - 1] + (slopes[i - 1] - slope) * boxes.dx end
  if boxes.gain[c] then boxes.slope[c] = slope end
  return out
end

-- S_r(z) = differences, for the mean of z_c in box i: Newton's method from 0, until a step is
-- round-off of the row's terms
local function solve_mean(boxes, r, c, known, i)
  local z, wanted = mean(boxes, known, i), differences(boxes, r, known, i)
  local last = math.huge
  for _ = 1, 50 do
    local slopes, terms = slopes_of(boxes.hessian, z, i)[r], math.abs(wanted)
    local step = (slopes_of(boxes.gradient, z, i)[r] - wanted) / slopes[c]
    if not (math.abs(step) < math.huge) then break end
    z[c] = z[c] - step
    for k = 1, boxes.d do terms = terms + math.abs(slopes[k] * z[k]) end
    local size, moved = terms / math.abs(slopes[c]), math.abs(step)
    if moved <= 1e-15 * size or moved > 0.5 * last and moved <= 1e-12 * size then return z[c] end
    last = moved
  end
  option.fail(WHERE, "'%s' does not follow from row %d without z_t at node %d: give it in z",
    boxes.names[c], r, i)
end

-- nodes from means, on a ring of an odd number of nodes
local function nodes_of(boxes, means)
  local out, sign = core.zeros(boxes.cells), 1
  for i = 1, boxes.cells do
    out[1] = out[1] + sign * means[i]
    sign = -sign
  end
  for i = 2, boxes.cells do out[i] = 2 * means[i - 1] - out[i - 1] end
  return out
end

local function average(boxes, r, c, known)
  local means = {}
  for i = 1, boxes.cells do means[i] = solve_mean(boxes, r, c, known, i) end
  return nodes_of(boxes, means)
end

-- What row r tells of a component: its number, and how. Differences leave its constant open, which
-- must not matter then.
local function told_by(boxes, r, known)
  local by_K, by_S = unknowns_of(boxes, r, known)
  if #by_K == 1 and #by_S == 0 and not algebra.depends(boxes, by_K[1]) then
    return by_K[1], integrate
  end
  if #by_K == 0 and #by_S == 1 and boxes.cells % 2 == 1 then return by_S[1], average end
end

-- a component more that follows from a row without z_t; false: none does
local function follow(boxes, known, given)
  for r = 1, boxes.d do
    if is_zero(boxes.M[r]) then
      local c, how = told_by(boxes, r, known)
      if c then
        local fine, values = blame.try(how, boxes, r, c, known)
        if not fine and not given[c] then error(values, 0) end
        known[c] = fine and values or given[c]
        return true
      end
    end
  end
  return false
end

---- rings of an even number of nodes ----

-- takes (-1)^i alt off x, alt its mean with alternating signs, which is returned
local function without_alternation(x)
  local alt, sign = 0, 1
  for i = 1, #x do alt, sign = alt + sign * x[i] / #x, -sign end
  sign = 1
  for i = 1, #x do x[i], sign = x[i] - sign * alt, -sign end
  return alt
end

-- the row without z_t that tells c from known components alone, averaging it; nil: none does
local function row_of(boxes, c, known)
  for r = 1, boxes.d do
    local by_K, by_S = unknowns_of(boxes, r, known)
    if is_zero(boxes.M[r]) and #by_K == 0 and #by_S == 1 and by_S[1] == c then return r end
  end
end

--- The level nearest to `from` of a component whose means a row without z_t tells from the `known`
-- ones. There (-1)^i has no means, so from keeps its part of that; and means that alternate are
-- those of no level: they are left out. nil: no row tells c.
function M.nearest(boxes, c, known, from)
  local r = row_of(boxes, c, known)
  if not r then return nil end
  local rest, change = core.zeros(boxes.cells), core.zeros(boxes.cells)
  for i = 1, boxes.cells do
    rest[i] = solve_mean(boxes, r, c, known, i) - (from[i] + from[right(boxes, i)]) / 2
  end
  without_alternation(rest)
  for i = 2, boxes.cells do change[i] = 2 * rest[i - 1] - change[i - 1] end
  without_alternation(change)
  return from + change
end

--- Adds to known components (vectors by number) all that follow from them; where that fails for one
-- of `given`, it is that one.
function M.all(boxes, known, given)
  while follow(boxes, known, given) do end
  return known
end

return M
