--- The Lagrangian of a Hamiltonian that is quadratic in p: with H = (p - a).A(q, t)(p - a)/2 + V,
-- that is b = H_p(q, 0, t), A = H_pp,
--   L(q, v, t) = (v - b).A^-1 (v - b)/2 - H(q, 0, t)      (the Legendre transform, HLW VI.1.2).
-- So every rule and every method that takes a Lagrangian takes such a system. Other H(q, p, t) are
-- stepped as they stand (integ/phase).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local options = require "dm.base.options"

local M = {}

local abs, max, huge = math.abs, math.max, math.huge

local MOST = 40          -- coordinates: more keep a matrix of masses only where it is diagonal
local POINTS = 12        -- where H is looked at
local EXACT = 1e-9       -- what a difference may leave of a sum that should vanish, relative

-- entries first + 1 .. first + n
local function part(x, first, n)
  local out = {}
  for i = 1, n do out[i] = x[first + i] end
  return core.vector(out)
end

-- numbers that are always the same, around 0 or around 1
local function numbers(n, k, seed)
  local out = {}
  for i = 1, n do out[i] = (k % 2) * 0.9 + 0.8 * math.sin(1.7 * k + 2.3 * i + seed) end
  return core.vector(out)
end

local function finite(x, n)
  for i = 1, n do
    if not (abs(x[i]) < huge) then return false end
  end
  return true
end

-- H_p at (q, p, t), or nothing where it has no value
local function velocity(slope, n, q, p, t)
  local fine, g = blame.try(slope, q, p, t)
  if not fine then return end
  local v = part(g, n, n)
  return finite(v, n) and v or nil
end

-- is H_p linear in p at q? By three points of a line. Nothing: it has no value there.
local function is_linear(slope, n, q, t, k)
  local u, w = numbers(n, k, 5), numbers(n, k + 1, 7)
  local a, b = velocity(slope, n, q, u, t), velocity(slope, n, q, u + w, t)
  local c = velocity(slope, n, q, u + 3 * w, t)
  if not (a and b and c) then return end
  local off, size = 0, 0
  for i = 1, n do
    off = max(off, abs((c[i] - a[i]) - 3 * (b[i] - a[i])))
    size = max(size, abs(a[i]), abs(b[i]), abs(c[i]))
  end
  return off <= EXACT * size
end

-- H_pp by columns, exact up to rounding where H_p is linear: zero beside the diagonal, or a matrix
-- that can be inverted
local function is_regular(slope, n, q, t)
  local zero = core.zeros(n)
  local b = velocity(slope, n, q, zero, t)
  if not b then return end
  local A, diagonal, least = core.matrix(n, n), true, huge
  for j = 1, n do
    local e = core.zeros(n)
    e[j] = 1
    local c = velocity(slope, n, q, e, t)
    if not c then return end
    for i = 1, n do
      A[i][j] = c[i] - b[i]
      if i ~= j and A[i][j] ~= 0 then diagonal = false end
    end
    least = math.min(least, abs(A[j][j]))
  end
  if n > MOST or diagonal then return diagonal and least > 0 end
  return (blame.try(A.solve, A, b))
end

-- has H a Lagrangian with a formula?
local function has_lagrangian(slope, n)
  local seen = 0
  for k = 1, POINTS do
    local q, t = numbers(n, k, 0), 0.3 * k
    local linear = is_linear(slope, n, q, t, k)
    local regular = true
    if linear and (n <= MOST or k <= 2) then regular = is_regular(slope, n, q, t) end
    if linear == false or regular == false then return false end
    seen = seen + (linear and 1 or 0)
  end
  return seen > 0
end

-- A^-1 (v - b) at a point: of many coordinates A is diagonal, its entries from H_p at unit vectors
-- of all coordinates at once
local function momentum(slope, n, q, v, t)
  local b = part(slope(q, core.zeros(n), t), n, n)
  if n > MOST then
    local ones = {}
    for i = 1, n do ones[i] = 1 end
    local c, out = part(slope(q, core.vector(ones), t), n, n), {}
    for i = 1, n do out[i] = (v[i] - b[i]) / (c[i] - b[i]) end
    return core.vector(out), b
  end
  local H = core.derivative(slope, n, n, "number")(q, core.zeros(n), t)
  local A = core.matrix(n, n)
  for i = 1, n do
    for j = 1, n do A[i][j] = H[n + i][n + j] end
  end
  return A:solve(core.vector(v) - b), b
end

local function is_number(x, n)
  for i = 1, n do
    if type(x[i]) ~= "number" then return false end
  end
  return true
end

-- of numbers L = p.v - H, by a plain call of H, with which the trace is compared; where the two
-- differ an upvalue or params have changed since the derivative was made
local function legendre(H, n)
  local slope
  return function(q, v, t, params)
    local of = bound(H, params)
    local plain = type(t) == "number" and is_number(q, n) and is_number(v, n)
    local function by_slope()
      local p, b = momentum(slope, n, q, v, t)
      return p, p:dot(core.vector(v) - b) / 2 - of(core.vector(q), core.zeros(n), t)
    end
    local kept = plain and slope
    if not kept then slope = core.derivative(of, n, n, "number") end
    local p, L = by_slope()
    if not plain then return L end
    local value = p:dot(core.vector(v)) - of(core.vector(q), p, t)
    if not kept or abs(value - L) <= EXACT * (abs(value) + abs(L)) then return value end
    slope = core.derivative(of, n, n, "number")
    p = by_slope()
    return p:dot(core.vector(v)) - of(core.vector(q), p, t)
  end
end

--- L(g, xi, t, params) of an H(g, mu, t, params) on a group that is quadratic in mu, of d entries:
-- element(flat(g)) is g again, by N numbers.
function M.on_elements(H, N, d, flat, element)
  return function(g, xi, t, params)
    local of, q = bound(H, params), core.vector(flat(g))
    local slope = core.derivative(function(x, mu, s) return of(element(x), mu, s) end, N, d,
      "number")
    local second = core.derivative(function(x, mu, s) return part(slope(x, mu, s), N, d) end, N, d,
      "number")(q, core.zeros(d), t)
    local b, A = part(slope(q, core.zeros(d), t), N, d), core.matrix(d, d)
    for i = 1, d do
      for j = 1, d do A[i][j] = second[i][N + j] end
    end
    local w = core.vector(xi) - b
    return A:solve(w):dot(w) / 2 - of(g, core.zeros(d), t)
  end
end

--- L of H for n coordinates, or nothing where no formula gives one. where: of the system, in
-- messages.
function M.lagrangian(H, n, params, where)
  H = options.numeric(H, where .. "H")
  local slope = core.derivative(bound(H, params), n, n, "number")
  if has_lagrangian(slope, n) then return legendre(H, n) end
end

return M
