--- Small linear systems of numbers or symbols alike: what is eliminated from a Lagrangian has the
-- size of the group.
local M = {}

-- rows of A in the order in which elimination has the largest pivots for the numbers in A; nothing
-- where it is singular
function M.order(A)
  local m, rows, order = #A, {}, {}
  for i = 1, m do
    rows[i], order[i] = {}, i
    for k = 1, m do rows[i][k] = A[i][k] end
  end
  local size = 0
  for i = 1, m do for k = 1, m do size = math.max(size, math.abs(rows[i][k])) end end
  for c = 1, m do
    local best = c
    for i = c + 1, m do
      if math.abs(rows[i][c]) > math.abs(rows[best][c]) then best = i end
    end
    if not (math.abs(rows[best][c]) > 1e-14 * size) then return nil end
    rows[c], rows[best], order[c], order[best] = rows[best], rows[c], order[best], order[c]
    for i = c + 1, m do
      local factor = rows[i][c] / rows[c][c]
      for k = c, m do rows[i][k] = rows[i][k] - factor * rows[c][k] end
    end
  end
  return order
end

--- x with A x = b for every list b of `columns`; rows are taken in the order given (M.order of a
-- sample).
function M.solve(A, columns, order)
  local m, rows = #A, {}
  for i = 1, m do
    local from = order[i]
    rows[i] = {}
    for k = 1, m do rows[i][k] = A[from][k] end
    for c, b in ipairs(columns) do rows[i][m + c] = b[from] end
  end
  local width = m + #columns
  for c = 1, m do
    for i = c + 1, m do
      local factor = rows[i][c] / rows[c][c]
      for k = c + 1, width do rows[i][k] = rows[i][k] - factor * rows[c][k] end
    end
  end
  local out = {}
  for c = 1, #columns do
    local x = {}
    for i = m, 1, -1 do
      local sum = rows[i][m + c]
      for k = i + 1, m do sum = sum - rows[i][k] * x[k] end
      x[i] = sum / rows[i][i]
    end
    out[c] = x
  end
  return out
end

--- x with A x = b, for numbers; nothing where A is singular.
function M.solution(A, b)
  local order = M.order(A)
  return order and M.solve(A, { b }, order)[1]
end

---- positive definite ----

-- entries other than zero that row i has among those of `order` from k on
local function degree(A, order, k, i)
  local count = 0
  for c = k, #A do
    if A[i][order[c]] ~= 0 then count = count + 1 end
  end
  return count
end

--- The order of elimination along the diagonal that fills in little and has few divisions in a row
-- (minimum degree, as in graph/linear.c), for numbers; nothing where A is not positive definite.
function M.diagonal_order(A)
  local m, rows, order, depth = #A, {}, {}, {}
  for i = 1, m do
    rows[i], order[i], depth[i] = { table.unpack(A[i]) }, i, 0
  end
  for k = 1, m do
    local best, least = k, degree(rows, order, k, order[k])
    for c = k + 1, m do
      local now = degree(rows, order, k, order[c])
      if now < least or now == least and depth[order[c]] < depth[order[best]] then
        best, least = c, now
      end
    end
    order[k], order[best] = order[best], order[k]
    local p = order[k]
    if not (rows[p][p] > 1e-14 * math.abs(A[p][p])) then return nil end
    for r = k + 1, m do
      local i, factor = order[r], rows[order[r]][p] / rows[p][p]
      if factor ~= 0 then depth[i] = math.max(depth[i], depth[p] + 1) end
      for c = k + 1, m do rows[i][order[c]] = rows[i][order[c]] - factor * rows[p][order[c]] end
    end
  end
  return order
end

-- two by two by Cramer's rule
local function solve_two(A, b)
  local inverse = 1 / (A[1][1] * A[2][2] - A[1][2] * A[1][2])
  return { (A[2][2] * b[1] - A[1][2] * b[2]) * inverse,
    (A[1][1] * b[2] - A[1][2] * b[1]) * inverse }
end

--- x with A x = b for a positive definite A, of symbols or numbers, in the order of
-- M.diagonal_order of a sample. The operations are those by which the second derivatives of an
-- extremum have A^-1 (graph/linear.c), so that a kernel of both divides once.
function M.solve_definite(A, b, order)
  local m, x, upper, inverse = #A, {}, {}, {}
  if m == 2 then return solve_two(A, b) end
  for i = 1, m do
    x[i], upper[i] = b[i], { table.unpack(A[i]) }
  end
  local function at(i, j) return upper[math.min(i, j)], math.max(i, j) end
  for k = 1, m do
    local p = order[k]
    inverse[p] = 1 / upper[p][p]
    for r = k + 1, m do
      local i = order[r]
      local from, column = at(i, p)
      local factor = from[column] * inverse[p]
      for c = r, m do
        local to, j = at(i, order[c])
        local row, l = at(p, order[c])
        to[j] = to[j] - factor * row[l]
      end
      x[i] = x[i] - factor * x[p]
    end
  end
  for k = m, 1, -1 do
    local p = order[k]
    for c = k + 1, m do
      local row, l = at(p, order[c])
      x[p] = x[p] - row[l] * x[order[c]]
    end
    x[p] = x[p] * inverse[p]
  end
  return x
end

return M
