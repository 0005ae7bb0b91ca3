--- GL(n): flat coordinates are the entries of the matrix; the algebra is all matrices, row by row.
local acts = require "dm.group.acts"
local core = require "dm.core"
local linear = require "dm.base.linear"
local matrices = require "dm.group.matrices"
local special = require "dm.group.sln"

local M = {}

-- of GL(2): log(sqrt(det)) on the diagonal, then as in SL(2)
local function log2(g)
  local det = g[1][1] * g[2][2] - g[1][2] * g[2][1]
  if type(det) == "number" and not (det > 0) then
    error(("the matrix has no real logarithm: its determinant is %g"):format(det), 0)
  end
  local size = core.sqrt(det)
  local xi, half = special.log2(g * (1 / size)), 0.5 * core.log(det)
  return core.vector { half + xi[1], xi[2], xi[3], half - xi[1] }
end

-- entries have no relation (group/flat.lua)
local function free_entries(kit)
  return { scales = 0,
    scale = function(list)
      local out = {}
      for i = 1, #list do out[i] = 1 end
      return out
    end,
    velocity = function(list, rates)
      return matrices.entries(kit.inverse(kit.rebuild(list)) * kit.rebuild(rates))
    end }
end

-- GL(1) multiplies vectors of any length
local function stretch() return function(g, z) return core.vector(z) * g[1][1] end end

function M.kit(n)
  local kit = { dimension = n * n, abelian = n == 1 }
  kit.acts = { linear = n == 1 and stretch or acts.linear(kit, n),
    projective = acts.projective(kit, n) }
  function kit.hat(xi) return linear.fill(n, n, function(i, j) return xi[(i - 1) * n + j] end) end
  function kit.vee(m) return core.vector(matrices.entries(m)) end
  function kit.defect(g)
    if linear.is_plain(g) and not (math.abs(g:det()) > 1e-14 * linear.size(g) ^ n) then
      return 1, "it is singular"
    end
    return 0
  end
  function kit.others()
    return { linear.fill(n, n, function(i, j) return i ~= j and 0 or i == 1 and -1 or 1 end) }
  end
  if n == 2 then kit.log = log2 end
  kit.sample = matrices.from_exponentials(kit)
  kit.smooth = free_entries(kit)
  return matrices.complete(kit, n)
end

return M
