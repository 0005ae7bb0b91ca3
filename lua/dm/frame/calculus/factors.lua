--- The factors of denominators: a list that a field keeps, polynomials without a divisor in common
-- as far as splitting off known ones and squares finds them.
local blame = require "dm.base.blame"
local P = require "dm.frame.calculus.polynomial"

local M = {}

local function text_of(field, p)
  local out = {}
  for i, m in ipairs(P.sorted(field.ring, p)) do
    out[i] = p[m] .. "*" .. table.concat(field.ring.monomials[m], ",")
  end
  return table.concat(out, ";")
end

-- the place of a primitive polynomial in the list of factors
local function keep(field, p)
  local key = text_of(field, p)
  local id = field.factor_of[key]
  if not id then
    id = #field.factors + 1
    field.factor_of[key], field.factors[id] = id, p
  end
  return id
end

--- Is p a number?
function M.is_constant(p)
  local m = next(p)
  return m == nil or m == 1 and next(p, m) == nil
end

-- add p^e to the factors `out` (place -> exponent), in parts that have no divisor in common with
-- those that are known
local function split(field, p, e, out)
  local ring = field.ring
  if M.is_constant(p) then return end
  local key = field.factor_of[text_of(field, p)]
  if key then
    out[key] = (out[key] or 0) + e
    return
  end
  for id = 1, #field.factors do
    local f = field.factors[id]
    local q = P.divide(ring, p, f)
    if q then
      out[id] = (out[id] or 0) + e
      return split(field, q, e, out)
    end
  end
  for _, v in ipairs(P.variables(ring, p)) do
    local slope = P.partial(ring, p, v)
    local fine, g = blame.try(P.gcd, ring, p, slope)
    if fine and not M.is_constant(g) then
      local rest = P.divide(ring, p, g)
      if rest and not M.is_constant(rest) then
        split(field, g, e, out)
        return split(field, rest, e, out)
      end
    end
  end
  out[keep(field, p)] = (out[keep(field, p)] or 0) + e
end

--- c and factors { place = exponent } of p = c * product of factors.
function M.of(field, p)
  local ring, out = field.ring, {}
  local content = P.content(p)
  if p[P.leading(ring, p)] < 0 then content = -content end
  p = P.primitive(ring, p)
  for _, v in ipairs(P.variables(ring, p)) do
    local least = math.huge
    for m in pairs(p) do least = math.min(least, P.exponent(ring, m, v)) end
    if least > 0 then
      local x = P.of(ring, v)
      out[keep(field, x)] = (out[keep(field, x)] or 0) + least
      p = P.divide(ring, p, P.power(ring, x, least))
    end
  end
  split(field, p, 1, out)
  return content, out
end

return M
