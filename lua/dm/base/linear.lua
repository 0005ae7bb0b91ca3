--- Small linear algebra in Lua: systems of numbers or symbols alike (what is eliminated from a
-- Lagrangian has the size of the group), choices of rows, singular values, eigenvectors, and what
-- is asked of a dm.matrix.
local core = require "dm.core"

local M = {}

local abs, max, sqrt = math.abs, math.max, math.sqrt

---- lists and matrices ----

--- The unit vector k of n entries.
function M.unit(n, k)
  local out = {}
  for i = 1, n do out[i] = i == k and 1 or 0 end
  return core.vector(out)
end

--- The product of two quaternions (w, x, y, z), as a list.
function M.quaternion_product(a, b)
  return { a[1] * b[1] - a[2] * b[2] - a[3] * b[3] - a[4] * b[4],
    a[1] * b[2] + a[2] * b[1] + a[3] * b[4] - a[4] * b[3],
    a[1] * b[3] - a[2] * b[4] + a[3] * b[1] + a[4] * b[2],
    a[1] * b[4] + a[2] * b[3] - a[3] * b[2] + a[4] * b[1] }
end

--- The matrix of a linear map f on vectors of n entries.
function M.matrix_of(f, n)
  local columns = {}
  for k = 1, n do columns[k] = f(M.unit(n, k)) end
  return M.fill(n, n, function(i, j) return columns[j][i] end)
end

--- Are all entries of a plain numbers?
function M.is_plain(a)
  for i = 1, a.rows do
    for j = 1, a.columns do
      if type(a[i][j]) ~= "number" then return false end
    end
  end
  return true
end

--- Largest row sum of |a_ij|, numbers only.
function M.size(a)
  local largest = 0
  for i = 1, a.rows do
    local row, sum = a[i], 0
    for j = 1, a.columns do sum = sum + abs(row[j]) end
    if not (sum <= largest) and largest == largest then largest = sum end
  end
  return largest
end

--- The matrix with the entry f(i, j).
function M.fill(rows, columns, f)
  local out = {}
  for i = 1, rows do
    local row = {}
    for j = 1, columns do row[j] = f(i, j) end
    out[i] = row
  end
  return core.matrix(out)
end

--- Largest |a_ij|.
function M.largest(a)
  local most = 0
  for i = 1, a.rows do
    for j = 1, a.columns do
      local x = abs(a[i][j])
      if not (x <= most) and most == most then most = x end
    end
  end
  return most
end

--- A with rows and columns multiplied so that their largest entries are near 1.
function M.balanced(a)
  for _ = 1, 3 do
    local down, across = {}, {}
    for i = 1, a.rows do
      for j = 1, a.columns do down[i] = max(down[i] or 0, abs(a[i][j])) end
    end
    for j = 1, a.columns do
      for i = 1, a.rows do across[j] = max(across[j] or 0, abs(a[i][j]) / down[i]) end
    end
    a = M.fill(a.rows, a.columns, function(i, j) return a[i][j] / (down[i] * across[j]) end)
  end
  return a
end

---- systems ----

--- The rows of A in the order in which elimination has the largest pivots, for numbers; nothing
-- where A is singular.
function M.order(A)
  local m, rows, order = #A, {}, {}
  for i = 1, m do
    rows[i], order[i] = {}, i
    for k = 1, m do rows[i][k] = A[i][k] end
  end
  local size = 0
  for i = 1, m do for k = 1, m do size = max(size, abs(rows[i][k])) end end
  for c = 1, m do
    local best = c
    for i = c + 1, m do
      if abs(rows[i][c]) > abs(rows[best][c]) then best = i end
    end
    if not (abs(rows[best][c]) > 1e-14 * size) then return nil end
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

--- Which `count` rows are far from dependent, by elimination with the largest pivot of all, and
-- which are left: lists of their places. Nothing, and how many there are, where every pivot is at
-- most `least` (0).
function M.choose_rows(rows, count, least)
  local A, taken = {}, {}
  for i, row in ipairs(rows) do A[i] = { table.unpack(row) } end
  for step = 1, count do
    local most, at, column = least or 0, nil, nil
    for i, row in ipairs(A) do
      for j = 1, taken[i] and 0 or #row do
        if abs(row[j]) > most then most, at, column = abs(row[j]), i, j end
      end
    end
    if not at then return nil, step - 1 end
    taken[at] = true
    for i, row in ipairs(A) do
      local factor = not taken[i] and row[column] / A[at][column] or 0
      for j = 1, taken[i] and 0 or #row do row[j] = row[j] - factor * A[at][j] end
    end
  end
  local chosen, others = {}, {}
  for i = 1, #rows do table.insert(taken[i] and chosen or others, i) end
  return chosen, others
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
    if not (rows[p][p] > 1e-14 * abs(A[p][p])) then return nil end
    for r = k + 1, m do
      local i, factor = order[r], rows[order[r]][p] / rows[p][p]
      if factor ~= 0 then depth[i] = max(depth[i], depth[p] + 1) end
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
  local function at(i, j) return upper[math.min(i, j)], max(i, j) end
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

---- singular values and eigenvectors ----

local SWEEPS, SMALL = 60, 1e-15

-- one rotation of the columns a, b of both lists that makes those of U orthogonal; the cosine of
-- their angle before
local function rotate(U, V, a, b)
  local alpha, beta, gamma = U[a]:dot(U[a]), U[b]:dot(U[b]), U[a]:dot(U[b])
  local cosine = abs(gamma) / sqrt(max(alpha * beta, 1e-300))
  if cosine <= SMALL or gamma == 0 then return 0 end
  local zeta = (beta - alpha) / (2 * gamma)
  local t = (zeta >= 0 and 1 or -1) / (abs(zeta) + sqrt(1 + zeta * zeta))
  local c = 1 / sqrt(1 + t * t)
  local s = c * t
  U[a], U[b] = U[a] * c - U[b] * s, U[a] * s + U[b] * c
  V[a], V[b] = V[a] * c - V[b] * s, V[a] * s + V[b] * c
  return cosine
end

--- Singular values of a matrix and the vectors that they belong to, by one-sided rotations of
-- Jacobi (Hestenes): lists, with |A V_k| = s_k.
function M.singular_values(matrix)
  local U, V, n = {}, {}, matrix.columns
  for k = 1, n do U[k], V[k] = matrix:column(k), M.unit(n, k) end
  for _ = 1, SWEEPS do
    local worst = 0
    for a = 1, n do
      for b = a + 1, n do worst = max(worst, rotate(U, V, a, b)) end
    end
    if worst <= SMALL then break end
  end
  local values = {}
  for k = 1, n do values[k] = U[k]:norm() end
  return values, V
end

-- one rotation in the plane (p, q) that makes A[p][q] zero; A rows and columns, V columns (as rows
-- of the list)
local function turn(A, V, p, q)
  local n, zeta = #A, (A[q][q] - A[p][p]) / (2 * A[p][q])
  local t = (zeta >= 0 and 1 or -1) / (abs(zeta) + sqrt(1 + zeta * zeta))
  local c = 1 / sqrt(1 + t * t)
  local s = c * t
  for k = 1, n do
    local x, y = A[k][p], A[k][q]
    A[k][p], A[k][q] = c * x - s * y, s * x + c * y
  end
  for k = 1, n do
    local x, y = A[p][k], A[q][k]
    A[p][k], A[q][k] = c * x - s * y, s * x + c * y
    x, y = V[p][k], V[q][k]
    V[p][k], V[q][k] = c * x - s * y, s * x + c * y
  end
end

--- Eigenvalues of a symmetric matrix (a table of rows, overwritten) by rotations of Jacobi,
-- ascending, and unit eigenvectors.
function M.symmetric(A)
  local n, V = #A, core.identity(#A):totable()
  for _ = 1, 40 do
    local off, size = 0, 0
    for p = 1, n do
      size = max(size, abs(A[p][p]))
      for q = p + 1, n do
        off = max(off, abs(A[p][q]))
        if abs(A[p][q]) > 1e-300 then turn(A, V, p, q) end
      end
    end
    if off <= 1e-17 * size then break end
  end
  local order, values, vectors = {}, {}, {}
  for k = 1, n do order[k] = k end
  table.sort(order, function(a, b) return A[a][a] < A[b][b] or A[a][a] == A[b][b] and a < b end)
  for k, i in ipairs(order) do values[k], vectors[k] = A[i][i], core.vector(V[i]) end
  return values, vectors
end

return M
