--- GL(n), SL(n), Sp(n): flat coordinates are the entries of the matrix.
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.group.linear"
local matrices = require "dm.group.matrices"
local smooth = require "dm.group.smooth"

local M = {}

local abs = math.abs

local function from_exponentials(kit)
  return function(stream, i)
    return kit.compose(kit.exp(kits.normals(stream, i, kit.dimension, 0.7)),
      kit.exp(kits.normals(stream, i + 2 ^ 31 | 0, kit.dimension, 0.7)))
  end
end

---- GL(n): the algebra is all matrices, row by row ----

function M.gl(n)
  local kit = { dimension = n * n }
  function kit.hat(xi) return linear.fill(n, n, function(i, j) return xi[(i - 1) * n + j] end) end
  function kit.vee(m) return core.vector(matrices.entries(m)) end
  function kit.defect(g)
    if linear.is_plain(g) and not (abs(g:det()) > 1e-14 * linear.size(g) ^ n) then return 1, "it is singular" end
    return 0
  end
  if n == 2 then kit.log = M.log2 end
  kit.sample = from_exponentials(kit)
  return matrices.complete(kit, n)
end

---- SL(2): {{a, b}, {c, -a}} squared is -t with t = -a^2 - b c ----

local function hat2(xi) return core.matrix { { xi[1], xi[2] }, { xi[3], -xi[1] } } end

local function square2(xi) return -(xi[1] * xi[1] + xi[2] * xi[3]) end

local function exp2(xi)
  local t = square2(xi)
  return core.identity(2) * smooth.stumpff(0, t) + hat2(xi) * smooth.stumpff(1, t)
end

-- x/sin x at c = cos x, t = sin^2 x: two halvings of the angle near the identity, atan2 and the logarithm away from it
local NEAR = 0.5
local function angle_ratio(c, t)
  local choose, guarded = smooth.choose, smooth.guarded
  local turned = choose(c, function() return t - NEAR end, function() return 1 end)  -- > 0: by atan2
  local function near()
    local c1 = core.sqrt(0.5 * (1 + guarded(c, c)))
    local t1 = t / (4 * c1 * c1)
    local c2 = core.sqrt(0.5 * (1 + c1))
    return smooth.arc_signed(c2, t1 / (4 * c2 * c2)) / (c1 * c2)
  end
  local function circular()
    local s = core.sqrt(guarded(turned, t))
    return core.atan(s, c) / s
  end
  local function hyperbolic()
    local s = core.sqrt(guarded(-NEAR - t, -t))
    return core.log(s + guarded(c, c)) / s
  end
  return choose(turned, circular, function() return choose(-NEAR - t, hyperbolic, near) end)
end

-- the logarithm of a matrix of determinant 1: (g - c) x/sin x, c = cos x half its trace
local function log2(g)
  local c, d = 0.5 * (g[1][1] + g[2][2]), 0.5 * (g[1][1] - g[2][2])
  local t = -(d * d + g[1][2] * g[2][1])
  if type(c) == "number" and type(t) == "number" and c <= 0 and not (t > 0) then
    if d == 0 and g[1][2] == 0 and g[2][1] == 0 then return core.vector { 0, -math.pi, math.pi } end
    error(("the matrix has no real logarithm: its trace is %g, and it is no rotation"):format(2 * c), 0)
  end
  local ratio = angle_ratio(c, t)
  return core.vector { d * ratio, g[1][2] * ratio, g[2][1] * ratio }
end

--- Of GL(2): log(sqrt(det)) on the diagonal, then as in SL(2).
function M.log2(g)
  local det = g[1][1] * g[2][2] - g[1][2] * g[2][1]
  if type(det) == "number" and not (det > 0) then
    error(("the matrix has no real logarithm: its determinant is %g"):format(det), 0)
  end
  local size = core.sqrt(det)
  local xi, half = log2(g * (1 / size)), 0.5 * core.log(det)
  return core.vector { half + xi[1], xi[2], xi[3], half - xi[1] }
end

local function adjugate(g) return core.matrix { { g[2][2], -g[1][2] }, { -g[2][1], g[1][1] } } end

---- SL(n): the trace is zero, so that the last entry is left out ----

local function unit_determinant(g, n)
  local det = g:det()
  if type(det) == "number" and (det == 0 or det < 0 and n % 2 == 0) then
    error(("no multiple of the matrix has determinant 1: its own is %g"):format(det), 0)
  end
  if type(det) == "number" and det < 0 then return g * -(abs(det) ^ (-1 / n)) end
  return g * det ^ (-1 / n)
end

function M.sl(n)
  local kit = { dimension = n * n - 1, no_cayley = n > 2 }
  function kit.hat(xi)
    local trace = 0
    for i = 1, n - 1 do trace = trace + xi[(i - 1) * n + i] end
    return linear.fill(n, n, function(i, j) return i == n and j == n and -trace or xi[(i - 1) * n + j] end)
  end
  function kit.vee(m)
    local list = matrices.entries(m)
    list[n * n] = nil
    return core.vector(list)
  end
  function kit.bonds(list) return { kit.rebuild(list):det() - 1 } end
  function kit.project(g) return unit_determinant(g, n) end
  function kit.defect(g)
    local det = g:det()
    return abs(det - 1) / math.max(1, linear.largest(g)) ^ n, ("its determinant is %.9g, not 1"):format(det)
  end
  if n == 2 then kit.exp, kit.log, kit.inverse = exp2, log2, adjugate end
  kit.sample = from_exponentials(kit)
  return matrices.complete(kit, n)
end

---- Sp(n), n = 2k: {{A, B}, {C, -A^T}} ----

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

function M.sp(n)
  if n == 2 then return M.sl(2) end  -- the same matrices in the same coordinates
  local k, J = n // 2, linear.symplectic_unit(n)
  local kit = { dimension = n * (n + 1) // 2 }
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
  function kit.project(g) return linear.near_symplectic(g, J) end
  function kit.defect(g)
    local off = linear.largest(g:transpose() * J * g - J)
    return off / math.max(1, linear.largest(g)) ^ 2, ("g^T J g is off J by %.3g"):format(off)
  end
  kit.sample = from_exponentials(kit)
  return matrices.complete(kit, n)
end

return M
