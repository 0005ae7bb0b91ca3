--- Functions of unit vectors, one for every cell, in coordinates of their tangent spaces: at x a
-- step d goes to (x + B d) / |x + B d|, B an orthonormal basis across x; slopes are B^T g, and the
-- curvature is B^T (H - (x . g)) B, since a sphere bends away from its tangent space.
local core = require "dm.core"
local matrices = require "dm.dec.equations.matrices"

local M = {}

-- m unit vectors across u and each other: the columns of Householder's reflection of an axis to u,
-- but for u itself
local function across(u)
  local k, first = #u, 1
  for c = 2, k do if math.abs(u[c]) > math.abs(u[first]) then first = c end end
  local sign = u[first] > 0 and 1 or -1
  local w, out = {}, {}
  for c = 1, k do w[c] = u[c] end
  w[first] = w[first] + sign
  local factor = 1 / (1 + sign * u[first]) -- 2 / |w|^2
  for j = 1, k do
    if j ~= first then
      local e = {}
      for c = 1, k do e[c] = (c == j and 1 or 0) - factor * w[c] * w[j] end
      out[#out + 1] = e
    end
  end
  return out
end

--- B of all cells that are not held, a column for every unknown, and how many these are; problem: {
-- held }.
function M.basis(problem, f, x)
  local k, rows, columns, values, count = f.values, {}, {}, {}, 0
  for i = 0, f.n - 1, k do
    if not problem.held[i + 1] then
      local u = {}
      for c = 1, k do u[c] = x[i + c] end
      for _, e in ipairs(across(u)) do
        count = count + 1
        for c = 1, k do
          rows[#rows + 1], columns[#columns + 1], values[#values + 1] = i + c, count, e[c]
        end
      end
    end
  end
  return core.sparse(f.n, math.max(count, 1), rows, columns, values), count
end

local basis = M.basis

--- x . g of the cell, for every number of it.
function M.products(f, x, g)
  local out = core.vector(f.n)
  for i = 0, f.n - 1, f.values do
    local sum = 0
    for c = 1, f.values do sum = sum + x[i + c] * g[i + c] end
    for c = 1, f.values do out[i + c] = sum end
  end
  return out
end

local products = M.products

local function normalized(f, x)
  local out = core.vector(f.n)
  for i = 0, f.n - 1, f.values do
    local square = 0
    for c = 1, f.values do square = square + x[i + c] ^ 2 end
    for c = 1, f.values do out[i + c] = x[i + c] / square ^ 0.5 end
  end
  return out
end

--- The problem of newton.lua for one with values on spheres.
function M.problem(problem, f)
  local kept, B -- the basis at one point serves slopes, curvature and the step from there
  local function basis_at(x)
    if kept ~= x then kept, B = x, basis(problem, f, x) end
    return B
  end
  local _, count = basis(problem, f, core.constant(f.n, f.values ^ -0.5))
  return { value = problem.value, gradient = problem.gradient, unknowns = count,
    slopes = function(x) return basis_at(x):transpose() * problem.gradient(x) end,
    curvature = function(x)
      local bend = matrices.diagonal(products(f, x, problem.gradient(x)))
      local P = basis_at(x)
      return P:transpose() * ((problem.hessian(x) - bend) * P)
    end,
    moved = function(x, d) return normalized(f, x + basis_at(x) * d) end }
end

return M
