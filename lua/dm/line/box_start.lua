--- The first level of boxes: components that are given, and those that follow from rows without
-- z_t, between means and differences of neighbouring nodes.
local algebra = require "dm.line.box_algebra"
local core = require "dm.core"
local grids = require "dm.line.grid"
local option = require "dm.base.options"

local M = {}

local WHERE = "solver:run"

local function is_zero(row)
  for j = 1, #row do if row[j] ~= 0 then return false end end
  return true
end

-- given components as vectors, by number
local function given_of(boxes, z)
  if type(z) ~= "table" then
    option.fail(WHERE, "option 'z' must be a table { %s = f, ... } (got %s)", boxes.names[1],
      option.got(z))
  end
  local out = {}
  for name, f in pairs(z) do
    local c = boxes.number[name]
    if not c then
      option.fail(WHERE, "option 'z': there is no component %s; there are %s", option.got(name),
        table.concat(boxes.names, ", "))
    end
    out[c] = grids.values(boxes.grid, f, 1, name, WHERE)
    if boxes.gain[c] and type(f) == "function" then -- without its slope
      local slope = (f(boxes.to) - f(boxes.from)) / (boxes.to - boxes.from)
      for i = 1, boxes.cells do out[c][i] = out[c][i] - slope * (i - 1) * boxes.dx end
      boxes.slope_given[c] = slope
    end
  end
  return out
end

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

-- means of the known components over box i; others are 0
local function mean(boxes, known, i)
  local z = core.zeros(boxes.d)
  for c, values in pairs(known) do z[c] = (values[i] + values[right(boxes, i)]) / 2 end
  return z
end

-- sum of K[r][c] D_x z_c over known components in box i
local function differences(boxes, r, known, i)
  local sum = 0
  for c, values in pairs(known) do
    local slope = (values[right(boxes, i)] - values[i]) / boxes.dx + (boxes.slope[c] or 0)
    sum = sum + boxes.K[r][c] * slope
  end
  return sum
end

-- K[r][c] D_x z_c = S_r - ...: a sum along the ring; what it gains is its slope
local function integrate(boxes, r, c, known)
  local out, slopes, total = core.zeros(boxes.cells), {}, 0
  for i = 1, boxes.cells do
    slopes[i] = (boxes.gradient(mean(boxes, known, i))[r] - differences(boxes, r, known, i))
      / boxes.K[r][c]
    total = total + slopes[i]
  end
  local slope = total / boxes.cells
  if not boxes.gain[c] and math.abs(slope) * (boxes.to - boxes.from) > 1e-9 then
    option.fail(WHERE, "'%s' gains %.6g round the ring: name it in gain = { \"%s\" }",
      boxes.names[c], total * boxes.dx, boxes.names[c])
  end
  for i = 2, boxes.cells do out[i] = out[i - 1] + (slopes[i - 1] - slope) * boxes.dx end
  if boxes.gain[c] then boxes.slope[c] = slope end
  return out
end

-- S_r(z) = differences, for the mean of z_c in box i: Newton's method from 0
local function solve_mean(boxes, r, c, known, i)
  local z, wanted = mean(boxes, known, i), differences(boxes, r, known, i)
  for _ = 1, 50 do
    local step = (boxes.gradient(z)[r] - wanted) / boxes.hessian(z)[r][c]
    z[c] = z[c] - step
    if math.abs(step) <= 1e-15 * (1 + math.abs(z[c])) then return z[c] end
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

-- a component more that follows from a row without z_t; false: none does
local function follow(boxes, known)
  for r = 1, boxes.d do
    if is_zero(boxes.M[r]) then
      local by_K, by_S = unknowns_of(boxes, r, known)
      if #by_K == 1 and #by_S == 0 then
        known[by_K[1]] = integrate(boxes, r, by_K[1], known)
        return true
      elseif #by_K == 0 and #by_S == 1 and boxes.cells % 2 == 1 then
        known[by_S[1]] = average(boxes, r, by_S[1], known)
        return true
      end
    end
  end
  return false
end

-- the slope of a gained component that the gauge mode asks for: y K slope - (2/h) pull . mean z =
-- y grad S(0), without which no level above exists
local function fit_slope(boxes, gauge, known, h)
  local sum, at = boxes.gradient(core.zeros(boxes.d)):dot(gauge.y), nil
  for c = 1, boxes.d do
    local pulled = 0
    for r = 1, boxes.d do pulled = pulled + gauge.y[r] * boxes.K[r][c] end
    if known[c] then sum = sum + 2 / h * gauge.pull[c] * known[c]:sum() / boxes.cells end
    if boxes.gain[c] and pulled ~= 0 then at = { c = c, pulled = pulled } end
    if boxes.slope[c] and not (at and at.c == c) then sum = sum - pulled * boxes.slope[c] end
  end
  if at then
    boxes.slope[at.c] = sum / at.pulled
  elseif math.abs(sum) > 1e-9 then
    option.fail(WHERE, "the start has no level above it: its means are off by %.3g; a component "
      .. "that gains a constant round the ring is to be named in 'gain', or h is at a resonance of "
      .. "the boxes: take another h", sum)
  end
end

--- { z = vector of all nodes, node after node; slope = of gained components; loose = components
-- that nothing tells }.
function M.level(boxes, z, solver)
  local state = setmetatable({ slope = {}, slope_given = {} }, { __index = boxes })
  local known, loose = given_of(state, z), {}
  for c, slope in pairs(state.slope_given) do state.slope[c] = slope end
  while follow(state, known) do end
  for c = 1, boxes.d do
    if not known[c] then
      if not is_zero(boxes.M[c]) then
        option.fail(WHERE, "component '%s' is needed: z_t of it occurs, and no row without z_t "
          .. "tells it", boxes.names[c])
      end
      known[c], loose[#loose + 1] = core.zeros(boxes.cells), c
    end
  end
  for _, gauge in ipairs(solver.gauges) do fit_slope(state, gauge, known, solver.h) end
  local all = core.zeros(boxes.cells * boxes.d)
  for i = 1, boxes.cells do
    for c = 1, boxes.d do all[(i - 1) * boxes.d + c] = known[c][i] end
  end
  return { z = all, slope = state.slope, loose = loose }
end

return M
