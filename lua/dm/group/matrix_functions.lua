--- Matrix functions for the groups, over numbers, symbols and hyper-dual numbers: exponential and
-- its differential, principal logarithm, nearest orthogonal and symplectic matrix.
local blame = require "dm.base.blame"
local core = require "dm.core"
local linear = require "dm.base.linear"

local M = {}

local abs, ceil = math.abs, math.ceil

-- halvings that bring the matrix below 1/2; of symbols, whose size is not known, so many that it
-- may be up to 2^4 exactly
local SYMBOL_HALVINGS = 5
local function halvings(a)
  if not linear.is_plain(a) then return SYMBOL_HALVINGS end
  local size = linear.size(a)
  if not (size < 2 ^ 20) then
    error(("the exponential of a matrix of size %g is out of reach"):format(size), 0)
  end
  return size > 0.5 and ceil(math.log(2 * size, 2)) or 0
end

-- sum_k z^k/(k + 1)!, k <= 15, by powers of z^4
local weights = {}
do
  local factorial = 1
  for k = 0, 15 do
    weights[k] = 1 / factorial
    factorial = factorial * (k + 2)
  end
end
local function phi_series(z)
  local one, z2 = core.identity(z.rows), z * z
  local z3, z4 = z2 * z, z2 * z2
  local sum
  for k = 12, 0, -4 do
    local block = one * weights[k] + z * weights[k + 1] + z2 * weights[k + 2] + z3 * weights[k + 3]
    sum = sum and sum * z4 + block or block
  end
  return sum
end

--- phi(A) = sum_k A^k/(k + 1)! = (exp A - 1)/A: phi(2z) = phi(z) + z phi(z)^2/2.
function M.phi(a)
  local s = halvings(a)
  local z = a * 0.5 ^ s
  local phi = phi_series(z)
  for _ = 1, s do
    phi = phi + z * (phi * phi) * 0.5
    z = z * 2
  end
  return phi
end

--- exp A; F = exp z - 1 is doubled by 2F + F^2, which keeps the digits of F near the identity.
function M.exp(a)
  local s = halvings(a)
  local z = a * 0.5 ^ s
  local f = z * phi_series(z)
  for _ = 1, s do f = f * 2 + f * f end
  return core.identity(a.rows) + f
end

-- phi_series and its derivative at z along y
local function phi_slope(z, y)
  local z2, d2 = z * z, y * z + z * y
  local z3, d3 = z2 * z, d2 * z + z2 * y
  local z4, d4 = z2 * z2, d2 * z2 + z2 * d2
  local one, sum, slope = core.identity(z.rows), nil, nil
  for k = 12, 0, -4 do
    local block = one * weights[k] + z * weights[k + 1] + z2 * weights[k + 2] + z3 * weights[k + 3]
    local rate = y * weights[k + 1] + d2 * weights[k + 2] + d3 * weights[k + 3]
    if sum then block, rate = sum * z4 + block, slope * z4 + sum * d4 + rate end
    sum, slope = block, rate
  end
  return sum, slope
end

--- The derivative of exp at A along B, times exp(-A), by products of n x n matrices alone.
function M.dexp(a, b)
  local s = halvings(a)
  local z, y = a * 0.5 ^ s, b * 0.5 ^ s
  local phi, slope = phi_slope(z, y)
  local f, df = z * phi, y * phi + z * slope
  for _ = 1, s do f, df = f * 2 + f * f, df * 2 + df * f + f * df end
  return df * M.exp(-a)
end

-- |det A|^(-1/n): A times it is of determinant 1, which starts Newton's methods below near the unit
-- matrix
local function scale_of(a)
  local det = a:det()
  return (type(det) == "number" and abs(det) or core.abs(det)) ^ (-1 / a.rows)
end

-- the square root of A, of determinant 1, by Denman and Beavers' product iteration: until it stays,
-- or `steps` times
local function square_root(a, steps)
  local one = core.identity(a.rows)
  local m, x = a, a
  for k = 1, steps or 60 do
    local inverse = m:inverse()
    if not steps then
      local distance = linear.size(m - one)
      if distance < 1e-15 * a.rows then break end
      if distance > 1 and k > 1 then
        local scale = scale_of(m)
        x, m, inverse = x * scale ^ 0.5, m * scale, inverse * scale ^ -1
      end
    end
    x = (x + x * inverse) * 0.5
    m = (one + (m + inverse) * 0.5) * 0.5
  end
  return x
end

local function refuse_negative(a)
  local re, im = a:eigenvalues()
  for i = 1, #re do
    if abs(im[i]) <= 1e-8 * (abs(re[i]) + abs(im[i])) and re[i] <= 0 then
      error(("the matrix has no principal logarithm: %g is one of its eigenvalues")
        :format(re[i]), 0)
    end
  end
end

-- 2 atanh(Z), Z = (A - 1)/(A + 1), for A near 1
local function near_log(a, terms)
  local one = core.identity(a.rows)
  local z = (a + one):solve(a - one)
  local square, sum = z * z, one * (1 / (2 * terms + 1))
  for k = terms - 1, 0, -1 do sum = sum * square + one * (1 / (2 * k + 1)) end
  return z * sum * 2
end

-- x + log(exp(-x) a) to first order, where x is nearly log a; raises where it is not near enough
local function corrected(x, a)
  local rest = M.exp(-x) * a - core.identity(a.rows)
  local size = linear.size(rest)
  if not (size < 1e-4) then
    error("the matrix has no principal logarithm to working precision: an eigenvalue is too near "
      .. "the negative axis", 0)
  end
  return size < 1e-9 and x or x + rest  -- below that it is round-off of exp(-x) a
end

-- roots of symbols: many steps for the first, whose argument may be near the negative axis, few for
-- what is near 1
local SYMBOL_STEPS = { 12, 7, 6 }

--- The principal logarithm, by square roots until A is near 1. Symbols: three roots, for matrices
-- whose eigenvalues are not near the negative axis.
function M.log(a)
  local one = core.identity(a.rows)
  if linear.is_plain(a) then refuse_negative(a) end
  local scale = scale_of(a)
  local root, shift = a * scale, one * core.log(scale)
  if linear.is_plain(a) then
    local roots = 0
    while linear.size(root - one) > 0.15 do root, roots = square_root(root), roots + 1 end
    return corrected(near_log(root, 7) * 2.0 ^ roots - shift, a)
  end
  for _, steps in ipairs(SYMBOL_STEPS) do root = square_root(root, steps) end
  return near_log(root, 12) * 2.0 ^ #SYMBOL_STEPS - shift
end

local SYMBOL_AVERAGES = 9

-- no matrix of that kind is nearest: to a singular one, or where averages become singular, as of
-- one that lies between several
local function refuse_average(what, i, why)
  if i > 1 then
    error(("no nearest %s matrix was found: several are as near, or all are far"):format(what), 0)
  end
  error(("there is no nearest %s matrix: %s"):format(what, why), 0)
end

-- x -> (x + dual(x))/2 until it stays; the determinant is brought to 1 before each step but the
-- last ones
local function average(x, dual, what)
  local plain = linear.is_plain(x)
  for i = 1, plain and 100 or SYMBOL_AVERAGES do
    if i < 5 then
      local fine, scale = blame.try(scale_of, x)
      if not fine or scale == math.huge then refuse_average(what, i, "it is singular") end
      x = x * scale
    end
    local fine, other = blame.try(dual, x)
    if not fine then refuse_average(what, i, other) end
    local y = (x + other) * 0.5
    if plain and linear.size(y - x) <= 1e-15 * linear.size(x) then return y end
    if plain and i == 100 then error(("no nearest %s matrix was found"):format(what), 0) end
    x = y
  end
  return x
end

--- The nearest orthogonal matrix, of positive determinant (the polar factor).
function M.nearest_rotation(a)
  if linear.is_plain(a) and not (a:det() > 0) then
    error(("there is no single nearest rotation: the determinant is %g, not positive")
      :format(a:det()), 0)
  end
  return average(a, function(x) return x:inverse():transpose() end, "orthogonal")
end

--- A symplectic matrix near a: x = J^-1 x^-T J.
function M.near_symplectic(a, J)
  return average(a, function(x) return J:transpose() * x:inverse():transpose() * J end,
    "symplectic")
end

-- numerators of the diagonal Pade approximants of exp, 1 + x/2 + ...
local PADE = { [2] = { 1, 1 / 2, 1 / 12 }, [3] = { 1, 1 / 2, 1 / 10, 1 / 120 },
  [4] = { 1, 1 / 2, 3 / 28, 1 / 84, 1 / 1680 } }

--- z with cay(z) = the Pade approximant of degree k of exp(x), k = 2, 3, 4: twice the odd part of
-- its numerator over the even one, z = 2 o e^-1. Then dz along y.
function M.pade(k, x, y)
  local c, power, slope = PADE[k], core.identity(x.rows), nil
  local odd, even = x * 0, power
  local d_odd, d_even = x * 0, x * 0
  for i = 1, k do
    if y then slope = slope and slope * x + power * y or y end
    power = power * x
    if i % 2 == 1 then
      odd = odd + power * c[i + 1]
      if y then d_odd = d_odd + slope * c[i + 1] end
    else
      even = even + power * c[i + 1]
      if y then d_even = d_even + slope * c[i + 1] end
    end
  end
  local inverse = even:inverse()
  local z = odd * inverse * 2
  return z, y and (d_odd * 2 - z * d_even) * inverse
end

--- J of R^(2k), x = (q, p).
function M.symplectic_unit(n)
  local k = n // 2
  return linear.fill(n, n, function(i, j) return j == i + k and 1 or i == j + k and -1 or 0 end)
end

return M
