--- Symmetric block tridiagonal matrices with blocks of 2 x 2, one for each knot: what dm.adapt
-- solves. D[i] = { a, b, c } is {{a, b}, {b, c}}, E[i] = { a, b, c, d } couples knot i (rows) to
-- knot i + 1.
local M = {}

function M.zeros(n)
  local H = { n = n, D = {}, E = {} }
  for i = 1, n do H.D[i], H.E[i] = { 0, 0, 0 }, { 0, 0, 0, 0 } end
  return H
end

--- The 4 x 4 matrix of an element between knots e and e + 1.
function M.add(H, e, h)
  local a, b, c = H.D[e], H.D[e + 1], H.E[e]
  a[1], a[2], a[3] = a[1] + h[1][1], a[2] + h[1][2], a[3] + h[2][2]
  b[1], b[2], b[3] = b[1] + h[3][3], b[2] + h[3][4], b[3] + h[4][4]
  c[1], c[2], c[3], c[4] = c[1] + h[1][3], c[2] + h[1][4], c[3] + h[2][3], c[4] + h[2][4]
end

--- Row and column k become those of 1.
function M.hold(H, k)
  local i, first = (k + 1) // 2, k % 2 == 1
  local D, E, before = H.D[i], H.E[i], H.E[i - 1]
  D[2] = 0
  if first then D[1], E[1], E[2] = 1, 0, 0 else D[3], E[3], E[4] = 1, 0, 0 end
  if before and first then before[1], before[3] = 0, 0 end
  if before and not first then before[2], before[4] = 0, 0 end
end

function M.largest(H)
  local largest = 0
  for i = 1, H.n do
    for k = 1, 3 do largest = math.max(largest, math.abs(H.D[i][k])) end
  end
  return largest
end

-- the inverse of a positive definite block; nil: it is none
local function inverse(a, b, c)
  local det = a * c - b * b
  if not (a > 0 and det > 1e-14 * a * c) then return nil end
  return c / det, -b / det, a / det
end

--- x = -(H + shift)^-1 g, blocks eliminated from the first to the last; nil: H + shift is not
-- positive definite.
function M.solve(H, g, shift)
  local n, inv, r = H.n, {}, {}
  for k = 1, 2 * n do r[k] = -g[k] end
  for i = 1, n do
    local a, b, c = H.D[i][1] + shift, H.D[i][2], H.D[i][3] + shift
    if i > 1 then -- less E^T D^-1 E of the knot before
      local e, p = H.E[i - 1], inv[i - 1]
      local u1, u2 = p[1] * e[1] + p[2] * e[3], p[2] * e[1] + p[3] * e[3]
      local v1, v2 = p[1] * e[2] + p[2] * e[4], p[2] * e[2] + p[3] * e[4]
      a, b, c = a - e[1] * u1 - e[3] * u2, b - e[1] * v1 - e[3] * v2, c - e[2] * v1 - e[4] * v2
      r[2 * i - 1] = r[2 * i - 1] - u1 * r[2 * i - 3] - u2 * r[2 * i - 2]
      r[2 * i] = r[2 * i] - v1 * r[2 * i - 3] - v2 * r[2 * i - 2]
    end
    local p, q, s = inverse(a, b, c)
    if not p then return nil end
    inv[i] = { p, q, s }
  end
  for i = n, 1, -1 do
    local x, y = r[2 * i - 1], r[2 * i]
    if i < n then
      local e = H.E[i]
      x = x - e[1] * r[2 * i + 1] - e[2] * r[2 * i + 2]
      y = y - e[3] * r[2 * i + 1] - e[4] * r[2 * i + 2]
    end
    local p = inv[i]
    r[2 * i - 1], r[2 * i] = p[1] * x + p[2] * y, p[2] * x + p[3] * y
  end
  return r
end

return M
