--- Power series in p variables up to an order, whose coefficients are exact expressions (or
-- numbers): a table place of K -> coefficient of t^K, those that are zero left out.
local multi_index = require "dm.action.multi_index"
local field = require "dm.frame.calculus.field"

local M = {}

local Series = {}
Series.__index = Series

--- The multi-indices of p variables up to an order, with the place of every sum and K!.
function M.space(p, order)
  local space = multi_index.up_to(p, order)
  space.sum, space.factorial = {}, {}
  for i, K in ipairs(space.list) do
    space.sum[i] = {}
    local f = 1
    for k = 1, p do
      for j = 2, K[k] do f = f * j end
    end
    space.factorial[i] = f
    for j, L in ipairs(space.list) do
      local both = {}
      for k = 1, p do both[k] = K[k] + L[k] end
      space.sum[i][j] = space.place[multi_index.key(both)]
    end
  end
  return space
end

local function is_zero(c) return c == 0 or field.is(c) and c:is_zero() end

local function series(space, terms) return setmetatable({ space = space, terms = terms },
  Series) end
M.of = series

local function lifted(a, b)
  local space = (getmetatable(a) == Series and a or b).space
  if getmetatable(a) ~= Series then a = series(space, { a }) end
  if getmetatable(b) ~= Series then b = series(space, { b }) end
  return space, a.terms, b.terms
end

local function combined(a, b, sign)
  local space, x, y = lifted(a, b)
  local out = {}
  for i, c in pairs(x) do out[i] = c end
  for i, c in pairs(y) do
    local sum = out[i] and out[i] + c * sign or c * sign
    out[i] = not is_zero(sum) and sum or nil
  end
  return series(space, out)
end

function Series.__add(a, b) return combined(a, b, 1) end
function Series.__sub(a, b) return combined(a, b, -1) end
function Series.__unm(a) return a * -1 end

function Series.__mul(a, b)
  local space, x, y = lifted(a, b)
  local out = {}
  for i, c in pairs(x) do
    for j, d in pairs(y) do
      local k = space.sum[i][j]
      if k then
        local sum = out[k] and out[k] + c * d or c * d
        out[k] = not is_zero(sum) and sum or nil
      end
    end
  end
  return series(space, out)
end

-- sum of rows[k + 1] s^k, s without a constant term
local function composed(s, rows)
  local out = series(s.space, {})
  for k = #rows, 1, -1 do out = out * s + rows[k] end
  return out
end

-- the constant term, and the rest
local function parted(a)
  local rest = {}
  for i, c in pairs(a.terms) do rest[i] = i ~= 1 and c or nil end
  return a.terms[1] or 0, series(a.space, rest)
end

-- (c + s)^e = c^e sum of binomials (s/c)^k
local function power(a, e)
  local c, s = parted(a)
  local rows, binomial = {}, 1
  if field.is(c) then e = field.number(c.field, e) end
  for k = 0, a.space.order[#a.space.order] do
    rows[k + 1] = c ^ (e - k) * binomial
    binomial = (e - k) * binomial / (k + 1)
  end
  return composed(s, rows)
end

function Series.__pow(a, e)
  local n = math.type(e) == "integer" and e or math.tointeger(e)
  if not n or n < 0 then return power(a, e) end
  local out = series(a.space, { 1 })
  for _ = 1, n do out = out * a end
  return out
end

function Series.__div(a, b)
  if getmetatable(b) ~= Series then return a * (field.is(b) and 1 / b or series(a.space,
    { 1 / b })) end
  return a * power(b, -1)
end

--- f(a) of an elementary function by its name: Taylor's series about the constant term.
function M.apply(name, a)
  if getmetatable(a) ~= Series then return field.apply(name, a) end
  local c, s = parted(a)
  local own = field.new()
  local u = field.variable(own, "u", { rank = 1, text = "u", tex = "u" })
  local f, rows, factorial = field.apply(name, u), {}, 1
  for k = 0, a.space.order[#a.space.order] do
    rows[k + 1] = field.map(f, function() return c end) / factorial
    f, factorial = field.partial(f, 1), factorial * (k + 1)
  end
  return composed(s, rows)
end

--- d/dt_k, of which the last order is missing.
function M.derivative(a, k)
  local space, out = a.space, {}
  for i, K in ipairs(space.list) do
    local j = space.next[i][k]
    local c = j and a.terms[j]
    if c then out[i] = c * (K[k] + 1) end
  end
  return series(space, out)
end

return M
