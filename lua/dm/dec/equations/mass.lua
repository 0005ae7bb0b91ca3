--- The masses of forms, |*s| / |s| for every cell: the inner product of primal forms is their
-- weighted sum. They may be 0 or negative where a mesh is not well-centred; what cannot go on with
-- that says so here.
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

--- What helps where stars are zero or negative.
M.REMEDY = "K:make_delaunay() gives other triangles to a surface, dual = \"barycentric\" other "
  .. "duals to any mesh, with which solutions do not converge"

local made = setmetatable({}, { __mode = "k" })

local EQUAL = 1e-9 -- relative: lengths of a mesh of regular simplices

--- Two notes as one, either of which may be missing.
function M.joined(a, b) return a and b and a .. "; " .. b or a or b end

-- of barycentric duals, or nothing: they do not stand upright on their cells but in regular
-- simplices, and a star of one number a cell errs by the same part on every mesh
local function barycentric_note(K)
  if K.dual ~= "barycentric" or K.dimension == 1 then return nil end
  local least, most = math.huge, 0
  for _, x in ipairs(K:volume(1)) do least, most = math.min(least, x), math.max(most, x) end
  if most - least <= EQUAL * most then return nil end
  return "barycentric duals are not at right angles to their cells: the solution does not "
    .. "converge where the mesh is refined"
end

--- What a report says of the mesh, or nothing.
function M.note(K)
  local folds, first = K:folds()
  local folded = folds > 0 and ("the mesh is folded at %d facet%s, the first %s: cells are "
    .. "turned inside out, and the solution is not that of what it covers"):format(folds,
      folds == 1 and "" or "s", first) or nil
  return M.joined(folded, barycentric_note(K))
end

--- The masses of the k-cells: { values, zeros, negatives, zero, negative }, the last two being the
-- first cell with such a dual. Made once for a mesh.
function M.of(K, k)
  local all = made[K] or {}
  made[K] = all
  if not all[k] then
    local values, zeros, negatives, zero, negative = K:star_weights(k)
    all[k] = { values = values, zeros = zeros, negatives = negatives, zero = zero,
      negative = negative }
  end
  return all[k]
end

local function cell_text(K, k, i)
  return ("{%s}"):format(table.concat(K:simplices(k)[i], ", "))
end

local function reciprocal(x) return x == 0 and 0 or 1 / x end

--- 1 / masses of the k-cells; where one is 0: 0 with pinv, else an error with the cell.
function M.inverse(K, k, pinv, where)
  local m = M.of(K, k)
  if m.zeros > 0 and not pinv then
    option.fail(where, "zero dual volume at simplex %s (one of %d of degree %d): its star has no "
      .. "inverse; give pinv = true for 0 there, or dual = \"barycentric\" to the mesh",
      cell_text(K, k, m.zero), m.zeros, k)
  end
  return m.values:map(reciprocal)
end

--- Raises where masses of k-cells are negative: what needs a norm has none.
function M.positive(K, k, where)
  local m = M.of(K, k)
  if m.negatives > 0 then
    option.fail(where, "the star is negative at %d cells of degree %d, the first is %s, so "
      .. "%d-forms have no norm and eigenvalues may be complex: %s", m.negatives, k,
      cell_text(K, k, m.negative), k, M.REMEDY)
  end
  return m.values
end

--- The moduli of the masses, their mean in the place of zeros: a norm on any mesh.
function M.norm(K, k)
  local values = M.of(K, k).values:map(math.abs)
  local mean = values:sum() / #values
  return values:map(function(x) return x == 0 and mean or x end)
end

--- Ones, as many as k-cells.
function M.ones(K, k) return core.constant(K:count(k), 1) end

return M
