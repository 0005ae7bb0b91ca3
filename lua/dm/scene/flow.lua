--- The solution of x' = A x, x(0) = z, as a formula in u from 0 to 1: for each cluster of
-- eigenvalues e^(lambda u) times a polynomial in u. Eigenvalues that are closer than the motion can
-- tell in this time make one cluster, whose invariant subspace is well conditioned where their
-- eigenvectors are not (critical damping, resonance): Bavely, Stewart, SIAM J. Numer. Anal. 16
-- (1979) 359. The exponential of what is left of A there is its Taylor series.
local core = require "dm.core"

local M = {}

local abs, max, sqrt, huge = math.abs, math.max, math.sqrt, math.huge

---- complex vectors: { re =, im = }, two dm.vectors ----

local function dot(x, y)  -- x* y
  return x.re:dot(y.re) + x.im:dot(y.im), x.re:dot(y.im) - x.im:dot(y.re)
end

-- x + (a + i b) y
local function plus(x, a, b, y)
  return { re = x.re + a * y.re - b * y.im, im = x.im + a * y.im + b * y.re }
end

-- an orthonormal basis of what they span, by Gram and Schmidt, twice
local function orthonormal(vectors)
  local out = {}
  for k, x in ipairs(vectors) do
    for _ = 1, 2 do
      for j = 1, k - 1 do
        local a, b = dot(out[j], x)
        x = plus(x, -a, -b, out[j])
      end
      local length = sqrt((dot(x, x)))
      x = { re = x.re / length, im = x.im / length }
    end
    out[k] = x
  end
  return out
end

---- balance ----

local SWEEPS = 20

--- Powers of two d by which rows and columns of d^-1 A d are alike in size (Osborne); A, by rows,
-- becomes that.
function M.balance(A, N)
  local d = {}
  for i = 1, N do d[i] = 1 end
  for _ = 1, SWEEPS do
    local changed = false
    for i = 1, N do
      local row, column = 0, 0
      for j = 1, N do
        if j ~= i then
          row, column = row + abs(A[i][j]), column + abs(A[j][i])
        end
      end
      -- what only drives others, or is only driven
      if row == 0 and column > 0 then row = 1 / column end
      if column == 0 and row > 0 then column = 1 / row end
      if row > 0 and column > 0 and (row > 4 * column or column > 4 * row) then
        local f = 2.0 ^ math.floor(0.5 * math.log(row / column, 2) + 0.5)
        d[i], changed = d[i] * f, true
        for j = 1, N do
          if j ~= i then A[i][j], A[j][i] = A[i][j] / f, A[j][i] * f end
        end
      end
    end
    if not changed then break end
  end
  return d
end

---- clusters of eigenvalues ----

local function distance(x, re, im) return sqrt((x[1] - re) ^ 2 + (x[2] - im) ^ 2) end

-- lists of eigenvalues that chains of steps up to `apart` join
local function joined(values, apart)
  local out, of = {}, {}
  for i, x in ipairs(values) do
    local cluster = { x }
    of[i] = cluster
    for j = 1, i - 1 do
      local other = of[j]
      if other ~= cluster and distance(x, values[j][1], values[j][2]) <= apart then
        for _, y in ipairs(other) do cluster[#cluster + 1] = y end
        for k = 1, i do if of[k] == other then of[k] = cluster end end
      end
    end
  end
  local seen = {}
  for i = 1, #values do
    if not seen[of[i]] then seen[of[i]], out[#out + 1] = true, of[i] end
  end
  return out
end

-- centre, radius and the distance to the next eigenvalue outside; real: it is its own conjugate
local function describe(cluster, values)
  local re, im, up, down = 0, 0, false, false
  for _, x in ipairs(cluster) do
    re, im, up, down = re + x[1], im + x[2], up or x[2] >= 0, down or x[2] <= 0
    cluster[x] = true
  end
  cluster.re, cluster.im = re / #cluster, up and down and 0 or im / #cluster
  cluster.radius, cluster.gap = 0, huge
  for _, x in ipairs(values) do
    local away = distance(x, cluster.re, cluster.im)
    if cluster[x] then
      cluster.radius = max(cluster.radius, away)
    else
      cluster.gap = math.min(cluster.gap, away)
    end
  end
  return cluster
end

-- how close eigenvalues of a cluster are, in parts of 1/T: the first that leaves clusters apart
local APART = { 1, 3, 0.3, 8, 0.1, 0.01, 0 }
local WITHIN = 0.5  -- of the distance to what is outside

local function clusters_of(values)
  for _, apart in ipairs(APART) do
    local list, fine = joined(values, apart), true
    for _, cluster in ipairs(list) do
      describe(cluster, values)
      fine = fine and cluster.radius <= WITHIN * cluster.gap
    end
    if fine then return list end
  end
end

---- invariant subspaces ----

local ROUNDS, OFFSET = 60, 0.1

-- (A - lambda)^-1 as a map of complex vectors, by the real matrix of twice the size
local function shifted_inverse(A, N, re, im)
  local rows = {}
  for i = 1, N do
    local upper, lower = {}, {}
    for j = 1, N do
      upper[j], upper[N + j], lower[j], lower[N + j] = A[i][j], 0, 0, A[i][j]
    end
    upper[i], upper[N + i] = upper[i] - re, im
    lower[i], lower[N + i] = -im, lower[N + i] - re
    rows[i], rows[N + i] = upper, lower
  end
  local inverse = core.matrix(rows):inverse()
  return function(x)
    local both = core.zeros(2 * N)
    for i = 1, N do both[i], both[N + i] = x.re[i], x.im[i] end
    both = inverse * both
    return { re = both:slice(1, N), im = both:slice(N + 1, 2 * N) }
  end
end

-- m vectors that depend on each other in no way: unit vectors of the whole space, else numbers that
-- look like random ones
local function first_vectors(N, m, is_real)
  local out = {}
  for k = 1, m do
    out[k] = { re = core.zeros(N), im = core.zeros(N) }
    for i = 1, N do
      out[k].re[i] = m == N and (i == k and 1 or 0)
        or (i * k * 0.6180339887498949 + i * i * 0.2360679774997896) % 1 - 0.5
      out[k].im[i] = is_real and 0
        or (i * k * 0.4142135623730951 + i * i * 0.7320508075688772) % 1 - 0.5
    end
  end
  return out
end

-- W* A W by rows of { re, im }, and the largest entry of A W - W (W* A W)
local function projected(A, W)
  local B, left = {}, 0
  for j = 1, #W do B[j] = {} end
  for k, w in ipairs(W) do
    local x = { re = A * w.re, im = A * w.im }
    for j, v in ipairs(W) do
      local a, b = dot(v, x)
      B[j][k] = { a, b }
    end
    for j, v in ipairs(W) do x = plus(x, -B[j][k][1], -B[j][k][2], v) end
    left = max(left, sqrt((dot(x, x))))
  end
  return B, left
end

-- Orthonormal basis of the subspace of a cluster by inverse iteration; W, W* A W. The shift is no
-- closer than it must be: where the matrix is defective the steps of a close one lie nearly in one
-- line.
local function subspace(A, N, size, cluster)
  local W = first_vectors(N, #cluster, cluster.im == 0)
  if #cluster == N then return W, (projected(A, W)) end
  local offset = max(OFFSET * cluster.gap, 1e-13 * size)
  local inverse = shifted_inverse(A, N, cluster.re + offset, cluster.im)
  local best, least, worse = nil, huge, 0
  for _ = 1, ROUNDS do
    for k, w in ipairs(W) do W[k] = inverse(w) end
    W = orthonormal(W)
    local B, left = projected(A, W)
    if left < 0.5 * least then
      best, least, worse = { W, B }, left, 0
    else
      worse = worse + 1
    end
    if worse > 2 or left == 0 then break end
  end
  if not (least <= 1e-9 * size) then return nil end
  return best[1], best[2]
end

---- the solution ----

local LAST, MOST_TERMS = 1e-20, 80

-- coefficients of e^((B - lambda) u) a: lists of { re, im } by powers of u
local function series(B, re, im, a)
  local out, m, size = { [0] = a }, #a, 0
  for _, x in ipairs(a) do size = size + abs(x[1]) + abs(x[2]) end
  if m == 1 then return out end
  for k = 1, MOST_TERMS do
    local next_one, length = {}, 0
    for i = 1, m do
      local x, y = 0, 0
      for j = 1, m do
        local b, c = B[i][j][1] - (i == j and re or 0), B[i][j][2] - (i == j and im or 0)
        x = x + b * out[k - 1][j][1] - c * out[k - 1][j][2]
        y = y + b * out[k - 1][j][2] + c * out[k - 1][j][1]
      end
      next_one[i] = { x / k, y / k }
      length = length + abs(x) + abs(y)
    end
    if not (length > LAST * size) then break end
    out[k] = next_one
  end
  return out
end

-- how much of each vector of the bases is in z: a list of { re, im } for each cluster
local function coordinates(parts, z, N)
  local columns = {}
  for _, part in ipairs(parts) do
    for _, w in ipairs(part.W) do
      columns[#columns + 1] = w.re
      if part.im ~= 0 then columns[#columns + 1] = -w.im end
    end
  end
  local rows = {}
  for i = 1, N do
    rows[i] = {}
    for j, column in ipairs(columns) do rows[i][j] = column[i] end
  end
  local matrix = core.matrix(rows)
  local y = matrix:solve(z)
  y = y + matrix:solve(z - matrix * y)
  local at = 0
  for _, part in ipairs(parts) do
    part.a = {}
    for k = 1, #part.W do
      part.a[k] = { y[at + 1], part.im ~= 0 and y[at + 2] or 0 }
      at = at + (part.im ~= 0 and 2 or 1)
    end
  end
end

-- powers of u with complex vectors of the first coordinates, in the units before the balance
local function polynomial(part, d)
  local out, N = {}, #d
  local B, W = part.B, part.W
  for power, a in pairs(series(B, part.re, part.im, part.a)) do
    local sum = { re = core.zeros(N), im = core.zeros(N) }
    for k, w in ipairs(W) do sum = plus(sum, a[k][1], a[k][2], w) end
    for i = 1, N do sum.re[i], sum.im[i] = sum.re[i] * d[i], sum.im[i] * d[i] end
    out[power] = sum
  end
  return out
end

--- The solution: a list of { re, im, P, count }, x(u) = sum of Re(e^((re + i im) u) sum_k P[k]
-- u^k), P[k] complex vectors { re, im }; count: how many of `values`, the list of the eigenvalues
-- { re, im } of A, it stands for, beside those that are marked `forcing`. A by rows (changed by it:
-- balanced), z a list. nil where no clusters can be told apart.
function M.solve(A, z, values, N)
  local d, size = M.balance(A, N), 0
  for i = 1, N do for j = 1, N do size = max(size, abs(A[i][j])) end end
  if size == 0 then size = 1 end
  local matrix, list, parts = core.matrix(A), clusters_of(values), {}
  if not list then return nil end
  for _, cluster in ipairs(list) do
    if cluster.im >= 0 then
      local W, B = subspace(matrix, N, size, cluster)
      if not W then return nil end
      local part = { W = W, B = B, re = 0, im = 0, count = 0 }
      for k = 1, #W do
        part.re = part.re + B[k][k][1] / #W
        part.im = cluster.im == 0 and 0 or part.im + B[k][k][2] / #W
      end
      for _, x in ipairs(cluster) do
        part.count = part.count + (x.forcing and 0 or cluster.im == 0 and 1 or 2)
      end
      parts[#parts + 1] = part
    end
  end
  local start = core.zeros(N)
  for i = 1, N do start[i] = z[i] / d[i] end
  coordinates(parts, start, N)
  for _, part in ipairs(parts) do part.P = polynomial(part, d) end
  return parts
end

return M
