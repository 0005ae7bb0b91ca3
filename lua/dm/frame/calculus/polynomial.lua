--- Polynomials with whole coefficients, the numerators and factors of exact formulas.
-- A ring has variables 1, 2, ...; a monomial is a number too, the place of its list { v1, e1, v2,
-- e2, ... } (v ascending, e > 0) in ring.monomials, and 1 is the monomial without variables. A
-- polynomial is a table monomial -> coefficient other than 0; none is changed once it is made.
local M = {}

local abs, max, min = math.abs, math.max, math.min

---- whole numbers ----

local FREE, LIMIT = 2 ^ 31, 2.0 ^ 62  -- factors below need no look; no coefficient is above

local function check(c, size)
  if size < LIMIT then return c end
  error("a coefficient of the exact formula is beyond 2^62", 0)
end

local function times(a, b)
  if abs(a) < FREE and abs(b) < FREE then return a * b end
  return check(a * b, abs(1.0 * a * b))
end

local function plus(a, b)
  local c = a + b
  return abs(c) < FREE and c or check(c, abs(1.0 * a + b))
end

local function whole_gcd(a, b)
  while b ~= 0 do a, b = b, a % b end
  return abs(a)
end

M.times, M.plus, M.whole_gcd = times, plus, whole_gcd

---- monomials ----

-- what compares monomials: { rank, exponent, ... }, the variable of the largest rank first
local function by_rank(ring, list)
  local pairs_of = {}
  for i = 1, #list, 2 do pairs_of[#pairs_of + 1] = { ring.rank[list[i]], list[i + 1] } end
  table.sort(pairs_of, function(a, b) return a[1] > b[1] end)
  return pairs_of
end

local function monomial(ring, list)
  local key = table.concat(list, ",")
  local id = ring.places[key]
  if not id then
    id = #ring.monomials + 1
    ring.places[key], ring.monomials[id], ring.products[id] = id, list, {}
    ring.order[id] = by_rank(ring, list)
  end
  return id
end

-- x^a y^b ... as a list, of two lists; exponents of the second times `sign`
local function merged(a, b, sign)
  local out, i, k = {}, 1, 1
  while i <= #a or k <= #b do
    local v, w = a[i] or math.huge, b[k] or math.huge
    local e = (v <= w and a[i + 1] or 0) + (w <= v and sign * b[k + 1] or 0)
    if e < 0 then return nil end
    if e > 0 then out[#out + 1], out[#out + 2] = min(v, w), e end
    if v <= w then i = i + 2 end
    if w <= v then k = k + 2 end
  end
  return out
end

local function product(ring, a, b)
  if a > b then a, b = b, a end
  local known = ring.products[a][b]
  if not known then
    known = monomial(ring, merged(ring.monomials[a], ring.monomials[b], 1))
    ring.products[a][b] = known
  end
  return known
end

-- a/b, or nothing
local function quotient(ring, a, b)
  local list = merged(ring.monomials[a], ring.monomials[b], -1)
  return list and monomial(ring, list)
end

-- is a before b, the variable of the largest rank deciding first?
local function is_greater(ring, a, b)
  local x, y = ring.order[a], ring.order[b]
  for i = 1, max(#x, #y) do
    if not y[i] then return true end
    if not x[i] then return false end
    if x[i][1] ~= y[i][1] then return x[i][1] > y[i][1] end
    if x[i][2] ~= y[i][2] then return x[i][2] > y[i][2] end
  end
  return false
end

---- polynomials ----

--- A new ring without variables.
function M.ring()
  local ring = { rank = {}, monomials = {}, places = {}, products = {}, order = {} }
  monomial(ring, {})
  return ring
end

--- A new variable. rank: a number of its own that orders variables, that of 1 before that of 0.
function M.variable(ring, rank)
  ring.rank[#ring.rank + 1] = rank
  return #ring.rank
end

--- The polynomial of variable v.
function M.of(ring, v) return { [monomial(ring, { v, 1 })] = 1 } end

--- p + k q
function M.add(p, q, k)
  local out = {}
  for m, c in pairs(p) do out[m] = c end
  for m, c in pairs(q) do
    local sum = plus(out[m] or 0, times(k, c))
    out[m] = sum ~= 0 and sum or nil
  end
  return out
end

function M.scale(p, k)
  local out = {}
  for m, c in pairs(p) do out[m] = times(c, k) end
  return out
end

function M.multiply(ring, p, q)
  local out = {}
  for m, c in pairs(p) do
    for n, d in pairs(q) do
      local id = product(ring, m, n)
      local sum = plus(out[id] or 0, times(c, d))
      out[id] = sum ~= 0 and sum or nil
    end
  end
  return out
end

function M.power(ring, p, e)
  local out = { 1 }
  for _ = 1, e do out = M.multiply(ring, out, p) end
  return out
end

--- The variables of p, ascending.
function M.variables(ring, p)
  local seen, out = {}, {}
  for m in pairs(p) do
    local list = ring.monomials[m]
    for i = 1, #list, 2 do
      if not seen[list[i]] then
        seen[list[i]] = true
        out[#out + 1] = list[i]
      end
    end
  end
  table.sort(out)
  return out
end

local function exponent(ring, m, v)
  local list = ring.monomials[m]
  for i = 1, #list, 2 do
    if list[i] == v then return list[i + 1] end
  end
  return 0
end
M.exponent = exponent

--- dp/dv
function M.partial(ring, p, v)
  local out, x = {}, monomial(ring, { v, 1 })
  for m, c in pairs(p) do
    local e = exponent(ring, m, v)
    if e > 0 then out[quotient(ring, m, x)] = times(c, e) end
  end
  return out
end

--- The greatest common divisor of the coefficients, 0 of 0.
function M.content(p)
  local g = 0
  for _, c in pairs(p) do
    g = whole_gcd(g, c)
    if g == 1 then break end
  end
  return g
end

--- The monomials of p, the first in the order of ranks first.
function M.sorted(ring, p)
  local out = {}
  for m in pairs(p) do out[#out + 1] = m end
  table.sort(out, function(a, b) return is_greater(ring, a, b) end)
  return out
end

local function leading(ring, p)
  local best
  for m in pairs(p) do
    if not best or is_greater(ring, m, best) then best = m end
  end
  return best
end
M.leading = leading

--- p/q where that is a polynomial with whole coefficients, else nothing.
function M.divide(ring, p, q)
  local top, out, rest = leading(ring, q), {}, p
  while next(rest) do
    local m = leading(ring, rest)
    local factor = quotient(ring, m, top)
    if not factor or rest[m] % q[top] ~= 0 then return nil end
    local c = rest[m] // q[top]
    out[factor] = c
    rest = M.add(rest, M.multiply(ring, { [factor] = c }, q), -1)
  end
  return out
end

---- greatest common divisors ----

-- coefficients of powers of v, polynomials without it, from 0; and the degree
local function by_powers(ring, p, v)
  local out, degree = {}, 0
  for m, c in pairs(p) do
    local e = exponent(ring, m, v)
    out[e] = out[e] or {}
    out[e][e > 0 and quotient(ring, m, monomial(ring, { v, e })) or m] = c
    degree = max(degree, e)
  end
  return out, degree
end

--- p without its content, the leading coefficient positive.
function M.primitive(ring, p)
  local g = M.content(p)
  if g == 0 then return p end
  if p[leading(ring, p)] < 0 then g = -g end
  local out = {}
  for m, c in pairs(p) do out[m] = c // g end
  return out
end

-- the part of p, seen as a polynomial in v, that does not contain v
local function content_in(ring, p, v)
  local g
  for _, c in pairs((by_powers(ring, p, v))) do
    g = g and M.gcd(ring, g, c) or c
  end
  return g
end

-- a remainder of p by q in v, times some power of the leading coefficient of q
local function remainder(ring, p, q, v)
  local b, n = by_powers(ring, q, v)
  local a, m = by_powers(ring, p, v)
  while m >= n and next(p) do
    local shift = m > n and { [monomial(ring, { v, m - n })] = 1 } or { 1 }
    p = M.add(M.multiply(ring, p, b[n]), M.multiply(ring, M.multiply(ring, a[m], shift), q), -1)
    p = M.primitive(ring, p)
    a, m = by_powers(ring, p, v)
    if m == 0 and n == 0 then break end
  end
  return p
end

--- The greatest common divisor, primitive (Euclid's algorithm on primitive parts).
function M.gcd(ring, p, q)
  if not next(p) then return M.primitive(ring, q) end
  if not next(q) then return M.primitive(ring, p) end
  local v = M.variables(ring, p)[1]
  if not v or #M.variables(ring, q) == 0 then return { 1 } end
  v = max(v, M.variables(ring, q)[1])
  local c, d = content_in(ring, p, v), content_in(ring, q, v)
  local a, b = M.divide(ring, p, c), M.divide(ring, q, d)
  a, b = M.primitive(ring, a or p), M.primitive(ring, b or q)
  while next(b) do
    local _, degree = by_powers(ring, b, v)
    if degree == 0 then
      a = { 1 }
      break
    end
    local r = remainder(ring, a, b, v)
    a = b
    b = next(r) and M.primitive(ring, M.divide(ring, r, content_in(ring, r, v)) or r) or r
  end
  return M.primitive(ring, M.multiply(ring, M.gcd(ring, c, d), a))
end

return M
