--- What boxes are singular by: matrices of a few rows.
local core = require "dm.core"

local M = {}

local TINY = 1e-10 -- of a balanced matrix: a pivot that is zero
local ROUNDS = 40

---- ranks, whatever units rows and columns have ----

-- the power of 2 that brings x near 1, from its root, as rows and columns share an entry
local function root_scale(x)
  return x > 0 and x < math.huge and 2.0 ^ -math.floor(math.log(x, 2) / 2 + 0.5) or 1.0
end

-- Rows and columns are multiplied by powers of 2 until the largest entry of each is near 1 (Ruiz
-- 2001); returns those of the columns and of the rows.
local function balance(rows, columns)
  local scales, weights = {}, {}
  for j = 1, columns do scales[j] = 1.0 end
  for i = 1, #rows do weights[i] = 1.0 end
  for _ = 1, ROUNDS do
    local most, by = {}, {}
    for j = 1, columns do most[j] = 0 end
    for i, row in ipairs(rows) do
      local largest = 0
      for j = 1, columns do
        largest, most[j] = math.max(largest, math.abs(row[j])), math.max(most[j], math.abs(row[j]))
      end
      by[i] = root_scale(largest)
      weights[i] = weights[i] * by[i]
    end
    for j = 1, columns do
      local c = root_scale(most[j])
      scales[j] = scales[j] * c
      for i, row in ipairs(rows) do row[j] = row[j] * by[i] * c end
    end
  end
  return scales, weights
end

-- rows and columns of a balanced matrix as lists, reduced: { pivot column of each row }, rank
local function reduce(rows, columns)
  local pivots, rank = {}, 0
  for j = 1, columns do
    local best = rank + 1
    for i = rank + 1, #rows do
      if math.abs(rows[i][j]) > math.abs(rows[best][j]) then best = i end
    end
    if rank < #rows and math.abs(rows[best][j]) > TINY then
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
  local rows = copied(K)
  balance(rows, #K)
  local _, rank = reduce(rows, #K)
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
  local scales = balance(rows, d)
  local pivots = reduce(rows, d)
  local is_pivot, out = {}, {}
  for i, j in ipairs(pivots) do is_pivot[j] = i end
  for j = 1, d do
    if not is_pivot[j] then
      local w = core.zeros(d)
      w[j] = 1
      for i, column in ipairs(pivots) do
        local x = rows[i][j]
        w[column] = math.abs(x) > TINY and -x * scales[column] / scales[j] or 0
      end
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

--- Powers of 2 that bring the equations of a box to like size, whatever units they have: pivots are
-- chosen among them.
function M.weights(boxes, h)
  local rows, H = {}, boxes.hessian(samples(boxes.d)[1])
  for i = 1, boxes.d do
    rows[i] = {}
    for j = 1, boxes.d do
      rows[i][j] = math.abs(boxes.M[i][j]) / h + math.abs(boxes.K[i][j]) / boxes.dx
        + math.abs(H[i][j]) / 2
    end
  end
  local _, weights = balance(rows, boxes.d)
  return weights
end

-- A component that both vectors of a gauge mode have, which no other mode holds: the first one with
-- a z_t, where there is one.
local function held_of(boxes, w, y, taken)
  local best, found = 0, nil
  local moves = moved(boxes, w):norm() > 0
  for c = 1, boxes.d do
    local size = not taken[c] and math.abs(w[c] * y[c]) or 0
    if moves and size > 0 and boxes.M[c]:norm() > 0 then return c end
    if size > best or not (found or taken[c]) then best, found = size, c end
  end
  return found
end

--- Gauge modes: constants w with (M/h - S''(z)/2) w = 0 for all z, so that no step determines them.
-- By the symmetry of the matrices as many rows y depend on each other. { held = the component whose
-- first node is held, instead of its row there, y, pull = M^T y }.
function M.gauges(boxes, h)
  local right, left = null_space(stacked(boxes, h, 1), boxes.d),
    null_space(stacked(boxes, h, -1), boxes.d)
  local out, taken = {}, {}
  for k, w in ipairs(right) do
    local held = held_of(boxes, w, left[k], taken)
    taken[held] = true
    out[k] = { held = held, y = left[k], pull = -moved(boxes, left[k]) }
  end
  return out
end

return M
