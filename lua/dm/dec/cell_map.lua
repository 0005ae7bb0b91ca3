--- The linear map of each top cell to its namesake in another realization: the vector sum r_i p_i,
-- whose rates r add up to 0, goes to sum r_i p'_i.
local core = require "dm.core"

local M = {}

-- edges p_j - p_0 of a cell
local function edges_of(points, cell)
  local out, base = {}, points[cell[1]]
  for j = 2, #cell do
    local e = {}
    for c = 1, #base do e[c] = points[cell[j]][c] - base[c] end
    out[j - 1] = e
  end
  return out
end

local function tables(matrix)
  local out = {}
  for i = 1, #matrix do out[i] = matrix[i]:totable() end
  return out
end

-- x with A x = b by elimination with pivots; the determinant of A
local function solve(A, b)
  local n, sign, product = #b, 1, 1
  for k = 1, n do
    local best = k
    for i = k + 1, n do
      if math.abs(A[i][k]) > math.abs(A[best][k]) then best = i end
    end
    if best ~= k then
      A[k], A[best], b[k], b[best], sign = A[best], A[k], b[best], b[k], -sign
    end
    product = product * A[k][k]
    for i = k + 1, n do
      local factor = A[i][k] / A[k][k]
      for j = k, n do A[i][j] = A[i][j] - factor * A[k][j] end
      b[i] = b[i] - factor * b[k]
    end
  end
  for k = n, 1, -1 do
    for j = k + 1, n do b[k] = b[k] - A[k][j] * b[j] end
    b[k] = b[k] / A[k][k]
  end
  return b, sign * product
end

local function dot(a, b)
  local sum = 0
  for c = 1, #a do sum = sum + a[c] * b[c] end
  return sum
end

--- The signs of the volumes of the top cells of a mesh that fills its space, as integers; rows:
-- other points of its vertices, a list each.
function M.signs(K, rows)
  local points, out = rows or tables(K:points()), {}
  for i, cell in ipairs(K:simplices(K.dimension)) do
    local zeros = {}
    for j = 1, K.dimension do zeros[j] = 0 end
    local _, determinant = solve(edges_of(points, cell), zeros)
    out[i] = determinant > 0 and 1 or determinant < 0 and -1 or 0
  end
  return out
end

-- the rates of X along the edges of a cell, of what lies in the cell
local function rates_of(X, edges)
  local gram, right = {}, {}
  for i, e in ipairs(edges) do
    gram[i], right[i] = {}, dot(e, X)
    for j, f in ipairs(edges) do gram[i][j] = dot(e, f) end
  end
  return (solve(gram, right))
end

--- Vectors in the top cells of K, a matrix with a row each, as vectors in those of L.
function M.carry(values, K, L)
  local from, to, rows = tables(K:points()), tables(L:points()), {}
  for i, cell in ipairs(K:simplices(K.dimension)) do
    local rates = rates_of(values[i]:totable(), edges_of(from, cell))
    local image, row = edges_of(to, cell), {}
    for c = 1, L.ambient do
      row[c] = 0
      for j, r in ipairs(rates) do row[c] = row[c] + r * image[j][c] end
    end
    rows[i] = row
  end
  return core.matrix(rows)
end

return M
