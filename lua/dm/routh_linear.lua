--- Small linear systems of numbers or symbols alike: what is eliminated from a Lagrangian has the size of the group.
local M = {}

-- rows of A in the order in which elimination has the largest pivots for the numbers in A; nothing where it is singular
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

--- x with A x = b for every list b of `columns`; rows are taken in the order given (M.order of a sample).
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

return M
