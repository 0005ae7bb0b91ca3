--- SO(n), rotation matrices, whose flat coordinates are their entries for n >= 4; of SO(2), angles,
-- and SO(3), quaternions, the kits have files of their own.
local acts = require "dm.group.acts"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local matrices = require "dm.group.matrices"
local matrix_functions = require "dm.group.matrix_functions"

local M = {}

--- Planes (i, j) in the order of the algebra: (2,3), (3,1), (1,2) of SO(3), so that hat(xi) x = xi
-- x x, else (1,2), (1,3) ...
function M.planes(n)
  if n == 3 then return { { 2, 3 }, { 3, 1 }, { 1, 2 } } end
  local out = {}
  for i = 1, n do
    for j = i + 1, n do out[#out + 1] = { i, j } end
  end
  return out
end

--- The skew matrix of xi.
function M.hat(xi, n)
  local out = core.zeros(n, n):totable()
  for a, plane in ipairs(M.planes(n)) do
    local i, j = plane[1], plane[2]
    out[j][i], out[i][j] = xi[a], -xi[a]
  end
  return core.matrix(out)
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

-- R^T R - 1 above and on the diagonal, of the first m columns
local function orthonormal(R, n, m)
  local out = {}
  for i = 1, m do
    for j = i, m do
      local sum = i == j and -1 or 0
      for k = 1, n do sum = sum + R[k][i] * R[k][j] end
      out[#out + 1] = sum
    end
  end
  return out
end

-- determinants of the first k columns in all choices of k rows, from those of one column less: sets
-- of rows as bits
local function more_minors(minors, R, n, k)
  local out = {}
  for set = 0, 1 << n + 1 do
    local minor, after = minors[set], 0  -- rows of the set below the new one
    for r = minor and n or 0, 1, -1 do
      local bit = 1 << r
      if set & bit ~= 0 then
        after = after + 1
      else
        local term = R[r][k] * minor
        if after % 2 == 1 then term = -term end
        out[set | bit] = out[set | bit] and out[set | bit] + term or term
      end
    end
  end
  return out
end

-- the vector across the first n - 1 columns, which is the last one of a rotation
local function across(R, n)
  local minors, all, out = { [0] = 1 }, (1 << n + 1) - 2, {}
  for k = 1, n - 1 do minors = more_minors(minors, R, n, k) end
  for r = 1, n do
    local minor = minors[all ~ (1 << r)]
    out[r] = (n - r) % 2 == 0 and minor or -minor
  end
  return out
end

local LARGEST_MINORS = 8  -- 2^n determinants

--- The n(n + 1)/2 equations of a rotation: orthonormal columns, the last of which is across the
-- others, so that the determinant is not -1; above n = 8, where that is long, orthonormal columns
-- alone.
function M.bonds(R, n)
  if n > LARGEST_MINORS then return orthonormal(R, n, n) end
  local out, w = orthonormal(R, n, n - 1), across(R, n)
  for r = 1, n do out[#out + 1] = R[r][n] - w[r] end
  return out
end

--- How far R is from a rotation.
function M.defect(R, n)
  local worst = core.orthonormality(R, n)
  local corner = R.rows == n and R or linear.fill(n, n, function(i, j) return R[i][j] end)
  if worst < 0.5 and corner:det() < 0 then
    return 2, "its determinant is -1"
  end
  if worst <= 1e-9 then return worst end
  return worst, ("its columns are off orthonormal ones by %.3g"):format(worst)
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

-- the logarithm of a matrix of symbols
local function smooth_log(R, n)
  if n == 4 then return require "dm.group.rotation_log".of_pair(R) end
  return matrix_functions.log(R)
end

-- the logarithm of a rotation matrix; of numbers that are none it is an error.
local function log_of(R, n)
  if not linear.is_plain(R) then return smooth_log(R, n) end
  local defect, why = M.defect(R, n)
  if not (defect < 1e-6) then
    error(("the matrix is no rotation: %s"):format(why or ("off by %g"):format(defect)), 0)
  end
  return require "dm.group.rotation_log".log(R)
end

-- angles of the planes of a rotation, each found twice among the eigenvalues
local function angle_norm(R)
  if not linear.is_plain(R) then return kits.norm(M.vee(smooth_log(R, R.rows), R.rows)) end
  local defect = M.defect(R, R.rows)
  if not (defect < 1e-6) then
    error(("the matrix a^T b is no rotation: off by %g"):format(defect), 0)
  end
  local re, im = R:eigenvalues()
  local sum = 0
  for i = 1, #re do sum = sum + math.atan(math.abs(im[i]), re[i]) ^ 2 end
  return math.sqrt(sum / 2)
end

-- the square of the larger angle of exp of a skew matrix of two planes, by the traces of X^2, X^4
local function larger_turn(X)
  local square = X * X
  local a, b = 0, 0
  for i = 1, X.rows do
    a = a - 0.5 * square[i][i]
    for j = 1, X.rows do b = b + 0.5 * square[i][j] * square[i][j] end
  end
  return 0.5 * (a + core.sqrt(core.abs(2 * b - a * a)))
end

local TWO_PLANES = { [4] = true, [5] = true }

--- SO(n) by its matrices, n >= 4.
function M.kit(n)
  local kit = { dimension = n * (n - 1) // 2, liftable = true }
  kit.acts = acts.rotations(kit, n)
  function kit.hat(xi) return M.hat(xi, n) end
  function kit.vee(m) return core.vector(M.vee(m, n)) end
  function kit.inverse(g) return g:transpose() end
  if TWO_PLANES[n] then function kit.arcs(xi) return { larger_turn(kit.hat(xi)) } end end
  function kit.log(g)
    return kit.vee(log_of(g, n))
  end
  function kit.bonds(list) return M.bonds(kit.rebuild(list), n) end
  function kit.project(m) return matrix_functions.nearest_rotation(m) end
  function kit.defect(g) return M.defect(g, n) end
  function kit.sample(stream, i) return M.sample(n, stream, i) end
  function kit.distance(a, b) return angle_norm(a:transpose() * b) end
  return matrices.complete(kit, n)
end

return M
