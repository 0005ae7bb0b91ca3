--- Matrices of integers, lists of rows with fields `rows` and `columns`: exact, what leaves 64 bits
-- raises. The empty ones count: a boundary of no cells is a matrix, too.
local chain = require "dm.dec.chain"
local core = require "dm.core"

local M = {}

local sum, product = chain.sum, chain.product

--- The matrix with the entry f(i, j).
function M.fill(rows, columns, f)
  local out = { rows = rows, columns = columns }
  for i = 1, rows do
    local row = {}
    for j = 1, columns do row[j] = f(i, j) end
    out[i] = row
  end
  return out
end

function M.zeros(rows, columns)
  return M.fill(rows, columns, function() return 0 end)
end

function M.unit(n)
  return M.fill(n, n, function(i, j) return i == j and 1 or 0 end)
end

--- a + factor * b, and a * b, of integers; fractions are added and multiplied as they are.
local function is_whole(a, b) return math.type(a) == "integer" and math.type(b) == "integer" end

local function times(a, b) return is_whole(a, b) and product(a, b) or a * b end

local function plus(a, b) return is_whole(a, b) and sum(a, b) or a + b end

--- A B.
function M.times(A, B)
  return M.fill(A.rows, B.columns, function(i, j)
    local total = 0
    for k = 1, A.columns do
      if A[i][k] ~= 0 and B[k][j] ~= 0 then total = plus(total, times(A[i][k], B[k][j])) end
    end
    return total
  end)
end

--- A + factor B.
function M.plus(A, B, factor)
  return M.fill(A.rows, A.columns, function(i, j)
    return plus(A[i][j], times(factor, B[i][j]))
  end)
end

--- A x for a list x.
function M.apply(A, x)
  local out = {}
  for i = 1, A.rows do
    out[i] = 0
    for j = 1, A.columns do
      if A[i][j] ~= 0 and x[j] ~= 0 then out[i] = plus(out[i], times(A[i][j], x[j])) end
    end
  end
  return out
end

--- Rows first .. last of A.
function M.part(A, first, last)
  return M.fill(math.max(last - first + 1, 0), A.columns, function(i, j)
    return A[first + i - 1][j]
  end)
end

function M.is_zero(A)
  for i = 1, A.rows do
    for j = 1, A.columns do if A[i][j] ~= 0 then return false end end
  end
  return true
end

--- factors, rank and U, W = U^-1, V, X = V^-1 with U A V = diag(factors).
function M.smith(A)
  local s = core.smith_form(A, A.columns)
  for _, name in ipairs { "U", "W" } do s[name].rows, s[name].columns = A.rows, A.rows end
  for _, name in ipairs { "V", "X" } do s[name].rows, s[name].columns = A.columns, A.columns end
  return s
end

return M
