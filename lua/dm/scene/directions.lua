--- Directions along which a system may be moved without a change: the null space of derivatives at
-- states near the start.
local core = require "dm.core"

local M = {}

local abs, max = math.abs, math.max

-- of the largest entry, each column and row in its own unit: what is less is round-off
local NOTHING = 1e-9
local SAMPLES = 5
local TIMES = { 0, 0.37, 0.81, 0.13, 0.59 }  -- of the whole time, at which a sample is taken
local WHOLE = { 1e-13, 24 }  -- entries so near to a quotient of small numbers are this quotient

-- numbers from -1 to 1 that fall in step with nothing
local function irregular(seed)
  local x = seed
  return function()
    x = (x * 69069 + 1234567) % 4294967296
    return 2 * x / 4294967296 - 1
  end
end

--- A state (q, v, t) near the start of a problem, number k of a sequence.
function M.state(problem, k)
  local next_one, q, v = irregular(k), problem.q + 0, problem.v + 0
  local far, fast = 0.02 * problem.q:norm() / problem.n, 0.02 * problem.v:norm() / problem.n
  for _ = 1, 3 do next_one() end
  for i = 1, problem.n do
    q[i] = q[i] * (1 + 0.05 * next_one()) + far * next_one()
    v[i] = v[i] * (1 + 0.1 * next_one()) + (fast > 0 and fast or 0.01) * next_one()
  end
  return q, v, problem.t0 + problem.T * TIMES[1 + k % #TIMES]
end

-- the part of a matrix that belongs to q, of its first rows, appended to rows
local function append(rows, J, count, n)
  for i = 1, count do
    local row = {}
    for k = 1, n do row[k] = J[i][k] end
    rows[#rows + 1] = row
  end
end

-- each column and then each row by its largest entry; rows of nothing fall off
local function balanced(rows, n)
  local scale, out = {}, {}
  for k = 1, n do
    scale[k] = 0
    for _, row in ipairs(rows) do scale[k] = max(scale[k], abs(row[k])) end
    if scale[k] == 0 then scale[k] = 1 end
  end
  for _, row in ipairs(rows) do
    local largest = 0
    for k = 1, n do
      row[k] = row[k] / scale[k]
      largest = max(largest, abs(row[k]))
    end
    if largest > NOTHING then
      for k = 1, n do row[k] = row[k] / largest end
      out[#out + 1] = row
    end
  end
  return out, scale
end

-- the largest entry of rows `from`, ... in columns without pivot
local function largest_entry(rows, from, n, has_pivot)
  local best, at, column = 0, nil, nil
  for r = from, #rows do
    for k = 1, n do
      local size = not has_pivot[k] and abs(rows[r][k]) or 0
      if size > best * (1 + 1e-6) then best, at, column = size, r, k end
    end
  end
  return best, at, column
end

-- elimination with full pivots: the row of each pivot's column
local function eliminate(rows, n)
  local has_pivot, count = {}, 0
  while count < n and count < #rows do
    local size, at, column = largest_entry(rows, count + 1, n, has_pivot)
    if size <= NOTHING then break end
    count = count + 1
    rows[count], rows[at] = rows[at], rows[count]
    has_pivot[column] = rows[count]
    for r, row in ipairs(rows) do
      local factor = r ~= count and row[column] / rows[count][column] or 0
      for k = 1, factor ~= 0 and n or 0 do row[k] = row[k] - factor * rows[count][k] end
    end
  end
  return has_pivot
end

-- x, or the quotient of small numbers that it is but for round-off
local function tidy(x)
  for d = 1, WHOLE[2] do
    local near = math.floor(x * d + 0.5)
    if near ~= 0 and abs(x * d - near) <= WHOLE[1] * d and abs(near) <= WHOLE[2] then
      return near / d
    end
  end
  return x
end

--- A basis of the directions a of q along which all derivatives by q of the functions are zero: a
-- list of { at = i, [k] = a_k }, a_i = 1, and a_i = 0 in the others. jacobians(q, v, t) -> list of
-- { matrix, rows (default all) } whose first n columns are derivatives by q.
function M.unchanged(problem, jacobians)
  local n, rows = problem.n, {}
  for k = 1, SAMPLES do
    for _, part in ipairs(jacobians(M.state(problem, k))) do
      append(rows, part[1], part[2] or part[1].rows, n)
    end
  end
  local scale
  rows, scale = balanced(rows, n)
  local pivots, out = eliminate(rows, n), {}
  for i = 1, n do
    if not pivots[i] then
      local a = { at = i }
      for k = 1, n do
        local row = pivots[k]
        a[k] = k == i and 1 or row and tidy(-row[i] / row[k] * scale[i] / scale[k]) or 0
        if abs(a[k]) * scale[k] <= NOTHING * scale[i] then a[k] = 0 end
      end
      out[#out + 1] = a
    end
  end
  return out
end

--- sum_k s[k] basis[k] as a vector of n.
function M.along(basis, s, n)
  local out = {}
  for i = 1, n do
    out[i] = 0
    for k, a in ipairs(basis) do
      if a[i] ~= 0 then out[i] = out[i] + a[i] * s[k] end
    end
  end
  return core.vector(out)
end

return M
