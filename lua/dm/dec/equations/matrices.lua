--- K:d, K:star, K:laplacian, K:laplace_beltrami: the operators of a mesh as sparse matrices.
local class = require "dm.base.class"
local core = require "dm.core"
local mass = require "dm.dec.equations.mass"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"

local M = {}

local fail = option.fail
local primal, dual = operator.primal, operator.dual

local function degree_of(K, k, most, where)
  if math.type(k) ~= "integer" or k < 0 or k > most then
    fail(where, "a degree from 0 to %d is needed (got %s)", most, option.got(k))
  end
end

-- the signs of the top cells, as factors of rows or columns
local function signs(K) return K:oriented(mass.ones(K, K.dimension)) end

class.method("dm.mesh", "d", function(K, k, options)
  local is_dual, n = option.check(options or {}, { "dual" }, "mesh:d").dual, K.dimension
  degree_of(K, k, n - 1, "mesh:d")
  if not is_dual then
    return operator.new(K, primal(k), primal(k + 1), { matrix = K:incidence(k) })
  end
  local cells = n - k -- dual k-forms are listed by them
  return operator.new(K, dual(k), dual(k + 1), { make = function()
    local transposed = K:incidence(cells - 1):transpose()
    if cells == n then transposed = transposed:scale(nil, signs(K)) end
    return (cells % 2 == 0 and 1 or -1) * transposed
  end })
end, [[
K:d(k, {dual=}) -> dm.operator
d of primal k-forms, entries 1 and -1; dual = true: of dual k-forms, (-1)^(n - k) times the
transpose of d of (n - k - 1)-forms.]])

class.method("dm.mesh", "star", function(K, k, options)
  local n = K.dimension
  options = option.check(options or {}, { "dual", "pinv" }, "mesh:star")
  if not options.dual then
    option.meaningless(options, "pinv", "mesh:star", "only dual = true divides by volumes")
  end
  degree_of(K, k, n, "mesh:star")
  local cells = options.dual and n - k or k
  local function make()
    local ratio = options.dual and mass.inverse(K, cells, options.pinv, "mesh:star")
      or mass.of(K, cells).values
    local sign = options.dual and k * (n - k) % 2 == 1 and -1 or 1
    return M.diagonal(sign * ratio):scale(cells == n and signs(K) or nil)
  end
  if options.dual then return operator.new(K, dual(k), primal(n - k), { make = make }) end
  return operator.new(K, primal(k), dual(n - k), { make = make })
end, [[
K:star(k, {dual=, pinv=}) -> dm.operator
The Hodge star of primal k-forms, a diagonal of |*s| / |s|; dual = true: of dual k-forms, its
inverse times (-1)^(k (n - k)). Raises "zero dual volume" with the cell, unless pinv = true: 0
there.]])

--- The diagonal matrix of a vector.
function M.diagonal(values)
  local at = {}
  for i = 1, #values do at[i] = i end
  return core.sparse(#values, #values, at, at, values)
end

---- Laplacians ----

-- marks of the k-cells that are not fixed, or nil
local function kept(K, k, fixed)
  if fixed == nil or k < 0 or k > K.dimension then return nil end
  if fixed == "boundary" then return K:boundary_marks(k):map(function(x) return 1 - x end) end
  local keep = mass.ones(K, k)
  for _, i in ipairs(fixed) do
    if math.type(i) ~= "integer" or i < 1 or i > #keep then
      fail("mesh:laplacian", "fixed: there is no cell %s of degree %d", option.got(i), k)
    end
    keep[i] = 0
  end
  return keep
end

-- of a list of k-cells, their faces are fixed as well
local function faces_of(K, k, fixed)
  if type(fixed) ~= "table" or k < 1 then return fixed end
  local out, seen = {}, {}
  for _, i in ipairs(fixed) do
    for _, face in ipairs(K:faces(k, i)) do
      if not seen[face] then out[#out + 1] = face end
      seen[face] = true
    end
  end
  return out
end

--- d^T M d of k-forms, or nil in the highest degree.
function M.up(K, k)
  if k == K.dimension then return nil end
  return K:incidence(k):gram(mass.of(K, k + 1).values)
end

--- M d M^-1 d^T M of k-forms, or nil in degree 0; keep: marks of the (k - 1)-cells that count.
function M.down(K, k, keep, pinv, where)
  if k == 0 then return nil end
  local adjoint = K:incidence(k - 1):transpose():scale(nil, mass.of(K, k).values)
  if keep then adjoint = adjoint:pick(keep) end
  local inverse = mass.inverse(K, k - 1, pinv, where)
  return adjoint:gram(keep and core.pick(inverse, keep) or inverse)
end

--- Both parts, or those that `part` names.
function M.stiffness(K, k, part, fixed, pinv, where)
  local up = part ~= "down" and M.up(K, k)
  local down = part ~= "up" and M.down(K, k, kept(K, k - 1, faces_of(K, k, fixed)), pinv, where)
  local S = up and down and up + down or up or down
  if S then return S end
  local zeros = mass.ones(K, k) * 0
  return M.diagonal(zeros):scale()
end

-- S = M A for A, with `keep`: forms that are 0 on the other cells
local function of_stiffness(K, k, S, keep, pinv, where)
  if keep then S = S:scale(keep, keep) end
  return operator.new(K, primal(k), primal(k), {
    stiffness = S, keep = keep,
    make = function() return S:scale(mass.inverse(K, k, pinv, where)) end,
  })
end

class.method("dm.mesh", "laplacian", function(K, k, options)
  degree_of(K, k, K.dimension, "mesh:laplacian")
  options = option.check(options or {}, { "part", "fixed", "pinv" }, "mesh:laplacian")
  local part = option.one_of(options, "part", "mesh:laplacian", { "up", "down" })
  local fixed = options.fixed
  if fixed ~= nil and fixed ~= "boundary" and type(fixed) ~= "table" then
    fail("mesh:laplacian", "fixed must be \"boundary\" or a list of cells of degree %d (got %s)", k,
      option.got(fixed))
  end
  local S = M.stiffness(K, k, part, fixed, options.pinv, "mesh:laplacian")
  return of_stiffness(K, k, S, kept(K, k, fixed), options.pinv, "mesh:laplacian")
end, [[
K:laplacian(k, {part = "up" | "down", fixed = "boundary" | {cells}, pinv=}) -> dm.operator
The Laplacian of de Rham and Hodge, d delta + delta d of k-forms: positive, so that functions have
-u'' on a line (K:laplace_beltrami() has the other sign). part = "up": delta d alone, "down":
d delta. fixed: forms that are 0 on the boundary, or on these k-cells and their faces. Where nothing
is fixed, conditions are natural. Raises "zero dual volume" with the cell where an inverse star is
needed, unless pinv = true: 0 there (Leok 3.9).]])

class.method("dm.mesh", "laplace_beltrami", function(K, options)
  return -K:laplacian(0, options)
end, [[
K:laplace_beltrami({fixed=, pinv=}) -> dm.operator
div grad of functions: negative, u'' on a line, -K:laplacian(0) (Leok 3.9, with div grad where div
curl is printed).]])

return M
