--- What boxes are singular by: matrices of a few rows.
local core = require "dm.core"

local M = {}

local TINY = 1e-10

-- rows and columns of a matrix as lists, reduced: { pivot column of each row }, rank
local function reduce(rows, columns)
  local pivots, rank, size = {}, 0, 0
  for _, row in ipairs(rows) do
    for j = 1, columns do size = math.max(size, math.abs(row[j])) end
  end
  for j = 1, columns do
    local best = rank + 1
    for i = rank + 1, #rows do
      if math.abs(rows[i][j]) > math.abs(rows[best][j]) then best = i end
    end
    if rank < #rows and math.abs(rows[best][j]) > TINY * size then
      rank = rank + 1
      rows[rank], rows[best] = rows[best], rows[rank]
      pivots[rank] = j
      local top = rows[rank]
      for k = columns, 1, -1 do top[k] = top[k] / top[j] end
      for i = 1, #rows do
        local part = i ~= rank and rows[i][j] or 0
        for k = 1, part ~= 0 and columns or 0 do rows[i][k] = rows[i][k] - part * top[k] end
      end
    end
  end
  return pivots, rank
end

local function copied(matrix)
  local rows = {}
  for i = 1, #matrix do
    rows[i] = {}
    for j = 1, #matrix[1] do rows[i][j] = matrix[i][j] end
  end
  return rows
end

--- Is every entry 0?
function M.is_zero(row)
  for j = 1, #row do if row[j] ~= 0 then return false end end
  return true
end

--- det K = 0?
function M.is_singular(K)
  local _, rank = reduce(copied(K), #K)
  return rank < #K
end

-- places where S is looked at
local function samples(d)
  local random, out = core.random(7), {}
  for k = 1, 4 do
    out[k] = core.zeros(d)
    for c = 1, d do out[k][c] = 0.1 + random:uniform(k, c) end
  end
  return out
end

--- Does dS/dz_r (any row where r is left out) depend on component c?
function M.depends(boxes, c, r)
  for _, z in ipairs(samples(boxes.d)) do
    local H = boxes.hessian(z)
    for row = r or 1, r or boxes.d do
      if H[row][c] ~= 0 then return true end
    end
    if not r and boxes.gradient(z)[c] ~= 0 then return true end
  end
  return false
end

-- a vector of the null space for each column that has no pivot
local function null_space(rows, d)
  local pivots = reduce(rows, d)
  local is_pivot, out = {}, {}
  for i, j in ipairs(pivots) do is_pivot[j] = i end
  for j = 1, d do
    if not is_pivot[j] then
      local w = core.zeros(d)
      w[j] = 1
      for i, column in ipairs(pivots) do w[column] = -rows[i][j] end
      out[#out + 1] = w
    end
  end
  return out
end

-- sign M/h - S''/2 at all samples
local function stacked(boxes, h, sign)
  local rows = {}
  for _, z in ipairs(samples(boxes.d)) do
    local H = boxes.hessian(z)
    for i = 1, boxes.d do
      local row = {}
      for j = 1, boxes.d do row[j] = sign * boxes.M[i][j] - 0.5 * h * H[i][j] end
      rows[#rows + 1] = row
    end
  end
  return rows
end

-- M w
local function moved(boxes, w)
  local out = core.zeros(boxes.d)
  for i = 1, boxes.d do
    for j = 1, boxes.d do out[i] = out[i] + boxes.M[i][j] * w[j] end
  end
  return out
end

--- Vectors y with y M = 0: y (K z_x - grad S(z)) = 0 has no z_t, and binds z at every time.
function M.bonds(boxes) return null_space(copied(boxes.M), boxes.d) end

--- Gauge modes: constants w with (M/h - S''(z)/2) w = 0 for all z, so that no step determines them.
-- By the symmetry of the matrices as many rows y depend on each other. { held = the component whose
-- first node is held, instead of its row there, y, pull = M^T y }.
function M.gauges(boxes, h)
  local right, left = null_space(stacked(boxes, h, 1), boxes.d),
    null_space(stacked(boxes, h, -1), boxes.d)
  local out = {}
  for k, w in ipairs(right) do
    local y, held = left[k], nil
    for c = 1, boxes.d do
      local column = moved(boxes, w)
      if not held and w[c] ~= 0 and y[c] ~= 0 and column:norm() > 0
        and boxes.M[c]:norm() > 0 then held = c end
    end
    held = held or 1
    out[k] = { held = held, y = y, pull = -moved(boxes, y) }
  end
  return out
end

return M
