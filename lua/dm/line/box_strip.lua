--- The strip of boxes (core.strip): their equations, and where components begin that only two steps
-- tell.
local algebra = require "dm.line.box_algebra"
local core = require "dm.core"
local follow = require "dm.line.box_follow"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

--- Sum of matrix[i][j] v[j], without zeros.
function M.row_times(matrix, i, v)
  local sum = 0
  for j = 1, #v do
    local x = matrix[i][j]
    if x ~= 0 then sum = sum + x * v[j] end
  end
  return sum
end

local row_times = M.row_times

--- Derivatives of S as it is now.
function M.derive(boxes)
  local gradient = core.derivative(boxes.S, boxes.d)
  boxes.gradient = gradient
  boxes.hessian = core.derivative(function(z) return gradient(z) end, boxes.d)
  for c in pairs(boxes.gain) do
    if algebra.depends(boxes, c) then
      option.fail("dm.multisymplectic", "'%s' gains a constant round the ring, but S depends on it",
        boxes.names[c])
    end
  end
end

--- A solver of S as it is now: what S reads may have changed since the last run.
function M.follow(solver)
  local boxes = solver.boxes
  M.derive(boxes)
  solver.gauges, solver.held = algebra.gauges(boxes, solver.h), {}
  for k, gauge in ipairs(solver.gauges) do solver.held[k] = boxes.names[gauge.held] end
end

-- M D_t m_x z + K D_x m_t z - grad S(m z), each row times its weight, as a function for core.strip
local function equations(boxes, slope, h)
  local d, dx, weights = boxes.d, boxes.dx, algebra.weights(boxes, h)
  return function(lower, upper, _, clock)
    local a, b = lists.part(lower, 0, d), lists.part(lower, d, d)
    local c, e = lists.part(upper, 0, d), lists.part(upper, d, d)
    local zt = (c + e - a - b) / (2 * clock[2])
    local zx = (b + e - a - c) / (2 * dx)
    local out, gradient = {}, boxes.gradient((a + b + c + e) / 4)
    for i = 1, d do
      local lifted = row_times(boxes.M, i, zt) + row_times(boxes.K, i, zx) - gradient[i]
      for k, s in pairs(slope) do lifted = lifted + boxes.K[i][k] * s end
      out[i] = weights[i] * lifted
    end
    return out
  end
end

--- The strip of a run, whose gained components have these slopes.
function M.new(solver, slope)
  local boxes = solver.boxes
  local held = core.zeros(boxes.cells * boxes.d)
  for _, gauge in ipairs(solver.gauges) do held[gauge.held] = 1 end
  return core.strip(equations(boxes, slope, solver.h), { values = boxes.d, cells = boxes.cells,
    ring = true, boxes = true, held = held, absorbs = { 0, 0 },
    place = core.zeros(boxes.cells) })
end

---- loose components ----

-- entry c of all nodes of a level
local function entry(boxes, z, c)
  local out = core.zeros(boxes.cells)
  for i = 1, boxes.cells do out[i] = z[(i - 1) * boxes.d + c] end
  return out
end

-- how far both vectors are apart at most, and what may be: they are taken at order 2
local function check_loose(solver, name, given, found, mean, next_mean)
  local off, size, change = 0, 0, 0
  for i = 1, #given do
    off = math.max(off, math.abs(given[i] - found[i]))
    size = math.max(size, math.abs(given[i]), math.abs(found[i]))
    change = math.max(change, math.abs(next_mean[i] - mean[i]))
  end
  if off > change + size / 4 then
    option.fail("solver:run", "'%s' of the start is off by %.3g from what the first two steps "
      .. "tell, which is %.3g at most: only its means over steps occur in the equations, and it "
      .. "would go to and fro by that; leave '%s' out, it follows", name, off, size, name)
  end
end

-- Loose components that are not given onto the rows without z_t that tell their means.
local function onto_rows(solver, level)
  local state = setmetatable({ slope = level.slope }, { __index = solver.boxes })
  local known, loose, d = {}, {}, state.d
  for _, c in ipairs(level.loose) do loose[c] = true end
  for c = 1, d do known[c] = not loose[c] and entry(state, level.z, c) or nil end
  for c in pairs(loose) do
    local found = not level.given[c] and follow.nearest(state, c, known, entry(state, level.z, c))
    for i = 1, found and state.cells or 0 do level.z[(i - 1) * d + c] = found[i] end
  end
end

--- Loose components begin where their means over the first two steps point to; means are all of
-- them that the equations contain, so that no other component depends on it. Where a row without
-- z_t has their means at the start (rings of an even number of nodes) they are put there.
function M.settle(solver, level, strip, t0)
  if #level.loose == 0 then return end
  local boxes = solver.boxes
  local out = strip:run { u = level.z, t0 = t0, h = solver.h, steps = 2 }
  if out.code ~= "ok" then return end
  for _, c in ipairs(level.loose) do
    local z0, z1, z2 = entry(boxes, out.u[1], c), entry(boxes, out.u[2], c),
      entry(boxes, out.u[3], c)
    local mean, next_mean = (z0 + z1) / 2, (z1 + z2) / 2
    local found, given = 1.5 * mean - 0.5 * next_mean, level.given[c]
    if given then check_loose(solver, boxes.names[c], given, found, mean, next_mean) end
    for i = 1, given and 0 or boxes.cells do level.z[(i - 1) * boxes.d + c] = found[i] end
  end
  if boxes.cells % 2 == 0 then onto_rows(solver, level) end
end

return M
