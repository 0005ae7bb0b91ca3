--- The logarithm of a rotation matrix: of any size, numbers only, to all digits near the identity
-- and near half turns; of R^4 in symbols too.
--
-- S = (R + R^T)/2 and K = (R - R^T)/2 commute; in the eigenvectors of S a plane turned by x has S =
-- cos x, K = sin x J. Where cos x is away from -1 the logarithm is x/sin x K, a smooth function of
-- S times K. Near half turns, x = pi - s, it is pi J - asin(sin s)/sin s K: there J is found by
-- pairing vectors, since K says little about it.
local core = require "dm.core"
local linear = require "dm.base.linear"
local smooth = require "dm.group.smooth"

local M = {}

local sqrt = math.sqrt

-- where to part the half turns from the rest: the middle of the largest gap of the cosines between
-- -0.97 and -0.6
local function threshold(cosines)
  local low, high, last, widest, at = -0.97, -0.6, -0.97, 0, -0.97
  for _, c in ipairs(cosines) do
    local now = math.min(math.max(c, low), high)
    if now - last > widest then widest, at = now - last, 0.5 * (now + last) end
    last = now
  end
  if high - last > widest then at = 0.5 * (high + last) end
  return at
end

-- x/sin x at c = cos x
local function ratio(c)
  local d = math.max(0, 1 - c)
  local s = sqrt(d * (2 - d))
  return s < 1e-4 and 1 + d / 3 or math.atan(s, 1 - d) / s
end

-- asin(x)/x from x^2
local function asin_ratio(square)
  local x = sqrt(math.min(1, math.max(0, square)))
  return x < 1e-4 and 1 + square / 6 or math.asin(x) / x
end

-- v without its parts along the list, and its length
local function residual(v, list)
  for _ = 1, 2 do
    for _, u in ipairs(list) do v = v - u * u:dot(v) end
  end
  return v, v:norm()
end

-- the candidate that the list spans least, made orthogonal to it, as a unit vector
local function least_spanned(candidates, list)
  local best, most = nil, 0
  for _, v in ipairs(candidates) do
    local rest, size = residual(v, list)
    if size > most then best, most = rest * (1 / size), size end
  end
  if not best or most < 1e-3 then
    error("the matrix is no rotation: an eigenvalue -1 stands alone", 0)
  end
  return residual(best, list)
end

-- the unit vector that B, restricted to the span of the basis, stretches most
local function most_stretched(B, basis)
  local images, square = {}, {}
  for a, u in ipairs(basis) do
    local image = B * u
    images[a] = core.vector(#basis)
    for c, w in ipairs(basis) do images[a][c] = w:dot(image) end
  end
  for a in ipairs(basis) do
    square[a] = {}
    for c in ipairs(basis) do square[a][c] = images[a]:dot(images[c]) end
  end
  local _, vectors = linear.symmetric(square)
  local v = core.zeros(B.rows)
  for a, u in ipairs(basis) do v = v + u * vectors[#basis][a] end
  return v
end

-- J of B = sin(s) J: pairs v, J v, the largest sine first; each is taken away before the next is
-- looked for, as its square would hide what is 1e-8 of it. Where B v is nothing any partner will
-- do.
local function complex_structure(B)
  local m, taken, J = B.rows, {}, core.zeros(B.rows, B.rows)
  local basis = {}
  for k = 1, m do basis[k] = core.identity(m):row(k) end
  while #basis > 0 do
    local v = most_stretched(B, basis)
    taken[#taken + 1] = v
    local image, size = residual(B * v, taken)
    local w = size > 0 and image * (1 / size) or least_spanned(basis, taken)
    taken[#taken + 1] = w
    J = J + (w:outer(v) - v:outer(w))
    local rest, known = {}, { table.unpack(taken) }
    for k = 1, #basis - 2 do
      rest[k] = least_spanned(basis, known)
      known[#known + 1] = rest[k]
    end
    basis = rest
  end
  return J
end

-- pi J - asin(B), in the basis of the vectors of the span, where B is K
local function of_half_turns(K, span)
  local m = #span
  local B = core.zeros(m, m)
  for a = 1, m do
    for b = 1, a - 1 do
      B[a][b] = span[a]:dot(K * span[b])
      B[b][a] = -B[a][b]
    end
  end
  local squares, vectors = linear.symmetric((B:transpose() * B):totable())
  local L = complex_structure(B) * math.pi
  for k, v in ipairs(vectors) do L = L - (B * v):outer(v) * asin_ratio(squares[k]) end
  local basis = core.matrix(span)
  return basis:transpose() * L * basis
end

--- log R as a skew matrix.
function M.log(R)
  local transposed = R:transpose()
  local K = (R - transposed) * 0.5
  local cosines, vectors = linear.symmetric(((R + transposed) * 0.5):totable())
  local part, span, out = threshold(cosines), {}, core.zeros(R.rows, R.rows)
  for k, c in ipairs(cosines) do
    local v = vectors[k]
    if c < part then
      span[#span + 1] = v
    else
      out = out + (K * v):outer(v) * ratio(c)
    end
  end
  if #span > 0 then out = out + of_half_turns(K, span) end
  return (out - out:transpose()) * 0.5
end

---- rotations of R^4 ----

-- matrices of x -> e_i x and of x -> x e_i
local left, right = {}, {}
local units = core.identity(4):totable()
for i, e in ipairs(units) do
  local l, r = {}, {}
  for j, x in ipairs(units) do
    l[j], r[j] = linear.quaternion_product(e, x), linear.quaternion_product(x, e)
  end
  left[i], right[i] = core.matrix(l):transpose(), core.matrix(r):transpose()
end

-- A[i][j] = <e_i x e_j, R>/4
local function pairing(R)
  local rows = {}
  for i = 1, 4 do
    rows[i] = {}
    for j = 1, 4 do
      local turn, sum = left[i] * right[j], 0
      for a = 1, 4 do
        for b = 1, 4 do
          if turn[a][b] ~= 0 then sum = sum + turn[a][b] * R[a][b] end
        end
      end
      rows[i][j] = 0.25 * sum
    end
  end
  return core.matrix(rows)
end

-- log of a unit quaternion other than -1, three numbers, by that of its square root
local function log_unit(q)
  local w = core.sqrt(0.5 * (1 + q[1]))
  local s = q[2] * q[2] + q[3] * q[3] + q[4] * q[4]
  local f = smooth.arc(w, s / (4 * w * w)) / w
  return { q[2] * f, q[3] * f, q[4] * f }
end

local function unit(v) return v * (1 / core.sqrt(v:dot(v))) end

--- The principal logarithm of a rotation of R^4 in closed form, for symbols and hyper-dual numbers
-- too: x -> p x q with unit quaternions, log = log p on the left and log q on the right, which
-- commute. A = p q^T is linear in the entries; A e_w = q_w p, A A^T e_w = p_w p. Of (p, q) and
-- (-p, -q) it is that with p_w + q_w > 0: their angles have a sum below pi, as the larger turn has.
-- So p is the direction of A e_w + A A^T e_w, and q likewise, without a choice.
function M.of_pair(R)
  local A = pairing(R)
  local B = A:transpose()
  local e = core.vector(units[1])
  local p, q = A * e, B * e
  local a, b = log_unit(unit(p + A * q)), log_unit(unit(q + B * p))
  local sum = core.zeros(4, 4)
  for k = 1, 3 do sum = sum + left[k + 1] * a[k] + right[k + 1] * b[k] end
  return sum
end

return M
