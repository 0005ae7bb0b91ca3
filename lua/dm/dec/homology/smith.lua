--- dm.smith: Smith's normal form of a matrix of integers (Leok, appendix A).
local blame = require "dm.base.blame"
local core = require "dm.core"
local integers = require "dm.dec.homology.integers"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

--- A matrix of integers from a list of rows of the same length.
function M.read(A, where)
  if type(A) ~= "table" or type(A[1]) ~= "table" then
    option.fail(where, "a matrix of integers is needed, a list of rows (got %s)", option.got(A))
  end
  local columns = #A[1]
  for i = 1, #A do
    local row = A[i]
    if type(row) ~= "table" or #row ~= columns then
      option.fail(where, "row %d must have %d entries, as the first one", i, columns)
    end
    for j = 1, columns do
      local x = row[j]
      if not lists.whole(x) then
        option.fail(where, "entry %d of row %d must be an integer (got %s)", j, i, option.got(x))
      end
    end
  end
  return integers.fill(#A, columns, function(i, j) return lists.whole(A[i][j]) end)
end

local function plain(A)
  local out = {}
  for i = 1, A.rows do out[i] = table.move(A[i], 1, A.columns, 1, {}) end
  return out
end

M.smith = blame.caller(function(A)
  A = M.read(A, "dm.smith")
  local s = integers.smith(A)
  local D = integers.fill(A.rows, A.columns, function(i, j)
    return i == j and s.factors[i] or 0
  end)
  return core.result { factors = s.factors, rank = s.rank, D = plain(D), U = plain(s.U),
    V = plain(s.V) }
end)

core.docs[M.smith] = [[
dm.smith(A) -> {factors, rank, D, U, V}
Smith's normal form of a matrix of integers, a list of rows: D = U A V is diagonal, U and V have
determinant 1 or -1, and each of the factors, > 0, divides the next one. Raises where an integer
leaves 64 bits on the way.]]

return M
