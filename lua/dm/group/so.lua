--- SO(n), n >= 4: rotation matrices; flat coordinates are their entries.
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.group.linear"
local matrices = require "dm.group.matrices"

local M = {}

--- Planes (i, j) in the order of the algebra: (2,3), (3,1), (1,2) of SO(3), so that hat(xi) x = xi x x, else (1,2), (1,3) ...
function M.planes(n)
  if n == 3 then return { { 2, 3 }, { 3, 1 }, { 1, 2 } } end
  local out = {}
  for i = 1, n do
    for j = i + 1, n do out[#out + 1] = { i, j } end
  end
  return out
end

--- The skew matrix of xi, entries `first + 1` on, as the corner of a matrix of `size` rows.
function M.hat(xi, n, size, first)
  local out = core.zeros(size, size):totable()
  for a, plane in ipairs(M.planes(n)) do
    local i, j = plane[1], plane[2]
    out[j][i], out[i][j] = xi[first + a], -xi[first + a]
  end
  return out
end

--- The entries of the skew part of the corner of m.
function M.vee(m, n)
  local out = {}
  for a, plane in ipairs(M.planes(n)) do
    local i, j = plane[1], plane[2]
    out[a] = 0.5 * (m[j][i] - m[i][j])
  end
  return out
end

--- R^T R - 1 above and on the diagonal.
function M.bonds(R, n)
  local out = {}
  for i = 1, n do
    for j = i, n do
      local sum = i == j and -1 or 0
      for k = 1, n do sum = sum + R[k][i] * R[k][j] end
      out[#out + 1] = sum
    end
  end
  return out
end

--- How far R is from a rotation.
function M.defect(R, n)
  local worst = 0
  for _, x in ipairs(M.bonds(R, n)) do
    if not (math.abs(x) <= worst) then worst = math.abs(x) end
  end
  if worst < 0.5 and linear.fill(n, n, function(i, j) return R[i][j] end):det() < 0 then return 2, "its determinant is -1" end
  return worst
end

--- Uniform: Gram and Schmidt on normal numbers; the last row is turned to make the determinant 1.
function M.sample(n, stream, i)
  local x, rows = kits.normals(stream, i, n * n, 1), {}
  for k = 1, n do
    local v = x:slice((k - 1) * n + 1, k * n)
    for _ = 1, 2 do
      for _, u in ipairs(rows) do v = v - u * u:dot(v) end
    end
    rows[k] = v * (1 / v:norm())
  end
  if core.matrix(rows):det() < 0 then rows[n] = -rows[n] end
  return core.matrix(rows)
end

-- the logarithm of a rotation matrix; of numbers that are none it is an error.
local function log_of(R, n)
  if not linear.is_plain(R) then return linear.log(R) end
  local defect, why = M.defect(R, n)
  if not (defect < 1e-6) then error(("the matrix is no rotation: %s"):format(why or ("off by %g"):format(defect)), 0) end
  return require "dm.group.rotation_log".log(R)
end

-- angles of the planes of a rotation, each found twice among the eigenvalues
local function angle_norm(R)
  if not linear.is_plain(R) then return kits.norm(M.vee(linear.log(R), R.rows)) end
  local defect = M.defect(R, R.rows)
  if not (defect < 1e-6) then error(("the matrix a^T b is no rotation: off by %g"):format(defect), 0) end
  local re, im = R:eigenvalues()
  local sum = 0
  for i = 1, #re do sum = sum + math.atan(math.abs(im[i]), re[i]) ^ 2 end
  return math.sqrt(sum / 2)
end

function M.kit(n)
  local kit = { dimension = n * (n - 1) // 2 }
  function kit.hat(xi) return core.matrix(M.hat(xi, n, n, 0)) end
  function kit.vee(m) return core.vector(M.vee(m, n)) end
  function kit.inverse(g) return g:transpose() end
  function kit.log(g)
    return kit.vee(log_of(g, n))
  end
  function kit.bonds(list) return M.bonds(kit.rebuild(list), n) end
  function kit.project(m) return linear.nearest_rotation(m) end
  function kit.defect(g) return M.defect(g, n) end
  function kit.sample(stream, i) return M.sample(n, stream, i) end
  function kit.distance(a, b) return angle_norm(a:transpose() * b) end
  return matrices.complete(kit, n)
end

return M
