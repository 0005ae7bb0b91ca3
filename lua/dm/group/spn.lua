--- Sp(n), n = 2k: flat coordinates are the entries of the matrix; the algebra is {{A, B}, {C,
-- -A^T}}, B and C symmetric.
local acts = require "dm.group.acts"
local core = require "dm.core"
local linear = require "dm.base.linear"
local matrices = require "dm.group.matrices"
local matrix_functions = require "dm.group.matrix_functions"

local M = {}

-- places (i, j) of the upper triangle, row by row
local function triangle(k)
  local out = {}
  for i = 1, k do
    for j = i, k do out[#out + 1] = { i, j } end
  end
  return out
end

local function sp_hat(xi, k)
  local out, corner = core.zeros(2 * k, 2 * k):totable(), triangle(k)
  for i = 1, k do
    for j = 1, k do
      local a = xi[(i - 1) * k + j]
      out[i][j], out[k + j][k + i] = a, -a
    end
  end
  for c, place in ipairs(corner) do
    local i, j = place[1], place[2]
    local b, d = xi[k * k + c], xi[k * k + #corner + c]
    out[i][k + j], out[j][k + i], out[k + i][j], out[k + j][i] = b, b, d, d
  end
  return core.matrix(out)
end

local function sp_vee(m, k)
  local out, corner = {}, triangle(k)
  for i = 1, k do
    for j = 1, k do out[#out + 1] = 0.5 * (m[i][j] - m[k + j][k + i]) end
  end
  for _, p in ipairs(corner) do out[#out + 1] = 0.5 * (m[p[1]][k + p[2]] + m[p[2]][k + p[1]]) end
  for _, p in ipairs(corner) do out[#out + 1] = 0.5 * (m[k + p[1]][p[2]] + m[k + p[2]][p[1]]) end
  return core.vector(out)
end

function M.kit(n)
  -- the same matrices in the same coordinates
  if n == 2 then return require "dm.group.sln".kit(2) end
  local k, J = n // 2, matrix_functions.symplectic_unit(n)
  local kit = { dimension = n * (n + 1) // 2, liftable = true }
  kit.acts = { linear = acts.linear(kit, n) }
  function kit.hat(xi) return sp_hat(xi, k) end
  function kit.vee(m) return sp_vee(m, k) end
  function kit.inverse(g) return J:transpose() * g:transpose() * J end
  function kit.bonds(list)
    local g, out = kit.rebuild(list), {}
    local defect = g:transpose() * J * g - J
    for i = 1, n do
      for j = i + 1, n do out[#out + 1] = defect[i][j] end
    end
    return out
  end
  function kit.project(g) return matrix_functions.near_symplectic(g, J) end
  function kit.defect(g)
    local off = linear.largest(g:transpose() * J * g - J)
    return off / math.max(1, linear.largest(g)) ^ 2, ("g^T J g is off J by %.3g"):format(off)
  end
  kit.sample = matrices.from_exponentials(kit)
  return matrices.complete(kit, n)
end

return M
