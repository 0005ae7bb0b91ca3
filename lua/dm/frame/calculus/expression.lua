--- Exact rational functions in a normal form: num/(d f1^e1 f2^e2 ...), num a polynomial with whole
-- coefficients, d > 0 whole, without a common factor of num's; the f are polynomials that a list of
-- the field keeps, none a multiple of another, and none divides num. Functions such as exp(kappa)
-- and roots are variables too ("atoms"); a root r = b^(1/q) obeys r^q = b.
local blame = require "dm.base.blame"
local factors = require "dm.frame.calculus.factors"
local P = require "dm.frame.calculus.polynomial"

local M = {}

local Expression = {}
Expression.__index = Expression
M.Expression = Expression

local times, whole_gcd = P.times, P.whole_gcd
local floor, abs, max = math.floor, math.abs, math.max

--- A new field: ring, what stands behind its variables, and the factors of denominators.
function M.new()
  return { ring = P.ring(), variables = {}, named = {}, factors = {}, factor_of = {} }
end

local function expression(field, num, d, den)
  return setmetatable({ field = field, num = num, d = d or 1, den = den or {} }, Expression)
end

function M.is(x) return getmetatable(x) == Expression end

---- variables ----

--- The variable called `key`, made at first use from info: { rank =, text =, tex =, ... }; an atom
-- has f (its row in functions.lua) and argument, a root base and q.
function M.variable(field, key, info)
  local v = field.named[key]
  if not v then
    v = P.variable(field.ring, info.rank)
    field.named[key], field.variables[v] = v, info
    info.key = key
    if info.q then field.roots = true end
  end
  return expression(field, P.of(field.ring, v))
end

---- normal form ----

-- without common factors of num and the denominator
local function simplified(field, num, d, den)
  if not next(num) then return expression(field, {}) end
  local ring, out = field.ring, nil
  for id, e in pairs(den) do
    local f, left = field.factors[id], e
    while left > 0 do
      local q = P.divide(ring, num, f)
      if not q then break end
      num, left = q, left - 1
    end
    out = out or {}
    out[id] = left > 0 and left or nil
  end
  if d ~= 1 then
    local g = whole_gcd(P.content(num), d)
    if g ~= 1 then
      local less = {}
      for m, c in pairs(num) do less[m] = c // g end
      num, d = less, d // g
    end
  end
  return expression(field, num, d, out)
end

-- product of factors with the exponents of `more` beyond those of `den`
local function missing(field, more, den)
  local out
  for id, e in pairs(more) do
    local rest = e - (den[id] or 0)
    if rest > 0 then
      local p = P.power(field.ring, field.factors[id], rest)
      out = out and P.multiply(field.ring, out, p) or p
    end
  end
  return out
end

---- numbers ----

local MOST_DENOMINATOR = 1000000

-- p, q with p/q == x in doubles, by continued fractions; nothing where q would be large
local function fraction(x)
  local p0, q0, p1, q1, rest = 0, 1, 1, 0, abs(x)
  if rest > 2 ^ 53 then return nil end
  for _ = 1, 40 do
    local a = floor(rest)
    p0, q0, p1, q1 = p1, q1, a * p1 + p0, a * q1 + q0
    if q1 > MOST_DENOMINATOR or p1 > 2 ^ 53 then return nil end
    if p1 / q1 == abs(x) then return (x < 0 and -1 or 1) * math.tointeger(p1),
      math.tointeger(q1) end
    rest = 1 / (rest - a)
  end
end

--- A number as an expression: a fraction, or an atom where it is none with a small denominator.
function M.number(field, x)
  if x == 0 then return expression(field, {}) end
  if x - x ~= 0 then error(("an exact formula has a number that is not finite: %s"):format(x),
    0) end
  local p, q = fraction(x)
  if p then return expression(field, { p }, q) end
  local text
  for digits = 15, 17 do
    text = ("%." .. digits .. "g"):format(abs(x))
    if tonumber(text) == abs(x) then break end
  end
  local c = M.variable(field, text,
    { rank = -2 - #field.variables, text = text, tex = text, constant = abs(x) })
  return x < 0 and -c or c
end

local function lifted(a, b)
  local field = (M.is(a) and a or b).field
  if not M.is(a) then a = M.number(field, a) end
  if not M.is(b) then b = M.number(field, b) end
  return field, a, b
end

--- The number that a constant expression is, else nothing.
function Expression:constant()
  if not next(self.num) then return 0 end
  if next(self.den) or not factors.is_constant(self.num) then return nil end
  return self.num[1] / self.d, self.num[1], self.d
end

function Expression:is_zero() return next(self.num) == nil end

---- arithmetic ----

-- c * monomial m without powers r^q of roots: a polynomial, and the product of their b, or nothing
local function without_roots(field, m, c)
  local ring, term, factor = field.ring, { c }, nil
  local list = ring.monomials[m]
  for i = 1, #list, 2 do
    local v, k = list[i], list[i + 1]
    local info = field.variables[v]
    if info.q and k >= info.q then
      local whole = info.base ^ (k // info.q)
      factor, k = factor and factor * whole or whole, k % info.q
    end
    if k > 0 then term = P.multiply(ring, term, P.power(ring, P.of(ring, v), k)) end
  end
  return term, factor
end

-- powers of roots r^q, r^q = b, opened
local function opened(e)
  local field, low, high = e.field, {}, {}
  for m, c in pairs(e.num) do
    local term, factor = without_roots(field, m, c)
    if factor then
      high[#high + 1] = expression(field, term) * factor
    else
      low[m] = c
    end
  end
  if #high == 0 then return e end
  local sum = expression(field, low)
  for _, part in ipairs(high) do sum = sum + part end
  return sum * expression(field, { 1 }, e.d, e.den)
end

local function finished(field, num, d, den)
  local e = simplified(field, num, d, den)
  return field.roots and opened(e) or e
end

local function add(a, b, sign)
  local field
  field, a, b = lifted(a, b)
  if not next(b.num) then return a end
  local ring, num, other = field.ring, a.num, b.num
  local extra, extra_other = missing(field, b.den, a.den), missing(field, a.den, b.den)
  if extra then num = P.multiply(ring, num, extra) end
  if extra_other then other = P.multiply(ring, other, extra_other) end
  local g = whole_gcd(a.d, b.d)
  local k, l = b.d // g, sign * (a.d // g)
  if k ~= 1 then num = P.scale(num, k) end
  local den = a.den
  if next(b.den) then
    den = {}
    for id, e in pairs(a.den) do den[id] = e end
    for id, e in pairs(b.den) do den[id] = max(e, den[id] or 0) end
  end
  return finished(field, P.add(num, other, l), times(a.d, k), den)
end

function Expression.__add(a, b) return add(a, b, 1) end
function Expression.__sub(a, b) return add(a, b, -1) end
function Expression.__unm(a) return expression(a.field, P.scale(a.num, -1), a.d, a.den) end

function Expression.__mul(a, b)
  local field
  field, a, b = lifted(a, b)
  if not next(a.num) then return a end
  if not next(b.num) then return b end
  local den = a.den
  if next(b.den) then
    den = {}
    for id, e in pairs(a.den) do den[id] = e end
    for id, e in pairs(b.den) do den[id] = e + (den[id] or 0) end
  end
  return finished(field, P.multiply(field.ring, a.num, b.num), times(a.d, b.d), den)
end

-- roots go to the numerator: 1/r = r^(q - 1)/b
local function inverse_of_roots(field, den)
  local factor
  for id, e in pairs(den) do
    local p = field.factors[id]
    local m = next(p)
    local list = next(p, m) == nil and field.ring.monomials[m]
    local info = list and #list == 2 and field.variables[list[1]]
    if info and info.q then
      local times_root = expression(field, P.power(field.ring, p, (-e) % info.q))
        / info.base ^ ((e + (-e) % info.q) // info.q)
      factor = factor and factor * times_root or times_root
      den[id] = nil
    end
  end
  return factor
end

local function inverse(a)
  local field = a.field
  if not next(a.num) then error("an exact formula divides by zero", 0) end
  local c, den = factors.of(field, a.num)
  local num = { c < 0 and -a.d or a.d }
  for id, e in pairs(a.den) do
    num = P.multiply(field.ring, num, P.power(field.ring, field.factors[id], e))
  end
  local factor = field.roots and inverse_of_roots(field, den)
  local out = finished(field, num, abs(c), den)
  return factor and out * factor or out
end

function Expression.__div(a, b)
  local _
  _, a, b = lifted(a, b)
  return a * inverse(b)
end

-- the root b^(1/q) as a variable
local function root_of(b, q)
  local text = tostring(b)
  local tex = b:tex()
  return M.variable(b.field, ("(%s)^(1/%d)"):format(text, q), { rank = -1e6 - #b.field.variables,
    text = q == 2 and ("sqrt(%s)"):format(text) or ("(%s)^(1/%d)"):format(text, q),
    tex = q == 2 and ("\\sqrt{%s}"):format(tex) or ("\\sqrt[%d]{%s}"):format(q, tex),
    base = b, q = q })
end

-- the q-th root of a positive constant, where it is a fraction
local function exact_root(b, q)
  local x, p, d = b:constant()
  if not x or x < 0 then return nil end
  local r, s = floor(p ^ (1 / q) + 0.5), floor(d ^ (1 / q) + 0.5)
  if r ^ q == p and s ^ q == d then return M.number(b.field, r / s) end
end

function Expression.__pow(a, e)
  if M.is(e) then
    local x, p, q = e:constant()
    if not x then error("an exponent of an exact formula must be a number", 0) end
    local whole = math.tointeger(p // q)
    if q == 1 then return a ^ whole end
    local root = exact_root(a, q) or root_of(a, q)
    return root ^ (p - q * whole) * a ^ whole
  end
  if math.type(e) ~= "integer" then
    if e == floor(e) and abs(e) < 1e6 then return a ^ floor(e) end
    return a ^ M.number(a.field, e)
  end
  if e < 0 then return inverse(a) ^ (-e) end
  local out = expression(a.field, { 1 })
  for _ = 1, e do out = out * a end
  return out
end

function Expression.__eq(a, b) return (a - b):is_zero() end

--- The variables in e, its denominator and its atoms: a table v -> info.
function Expression:uses(out)
  out = out or {}
  local field = self.field
  local function look(p)
    for _, v in ipairs(P.variables(field.ring, p)) do
      local info = field.variables[v]
      if not out[v] then
        out[v] = info
        if info.base then info.base:uses(out) end
        if info.argument then info.argument:uses(out) end
      end
    end
  end
  look(self.num)
  for id in pairs(self.den) do look(field.factors[id]) end
  return out
end

--- The last word of normal form: also divisors that factors have in common with the numerator are
-- gone.
function M.reduced(e)
  local field = e.field
  for id, power in pairs(e.den) do
    local f = field.factors[id]
    local fine, g = blame.try(P.gcd, field.ring, e.num, f)
    if fine and not factors.is_constant(g) then
      local rest = P.divide(field.ring, f, g)
      local den = {}
      for other, k in pairs(e.den) do den[other] = other ~= id and k or nil end
      local again = expression(field, e.num, e.d, den)
      for _ = 1, power do
        again = again * inverse(expression(field, g)) * inverse(expression(field, rest))
      end
      return M.reduced(again)
    end
  end
  return e
end

M.expression = expression

return M
