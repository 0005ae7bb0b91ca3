--- The field of exact expressions (expression.lua) with its derivations, elementary functions and
-- maps to other algebras.
local functions = require "dm.frame.calculus.functions"
local M = require "dm.frame.calculus.expression"
local P = require "dm.frame.calculus.polynomial"

local expression = M.expression

-- what a derivation makes of an atom: f'(u) Du, and r Db/(q b) of a root
local function of_atom(field, v, info, derive)
  if info.constant then return 0 end
  if info.argument then
    return functions[info.f].slope(info.argument, M.apply) * derive(info.argument)
  end
  return expression(field, P.of(field.ring, v)) * derive(info.base) / (info.base * info.q)
end

--- The derivation of the field that takes variable v to rate(v, info), an expression or number; on
-- atoms by the chain rule.
function M.derive(e, rate)
  local field = e.field
  local ring = field.ring
  local function rate_of(v)
    local info = field.variables[v]
    if info.constant or info.argument or info.base then
      return of_atom(field, v, info, function(x) return M.derive(x, rate) end)
    end
    return rate(v, info)
  end
  local function of_polynomial(p)
    local out = expression(field, {})
    for _, v in ipairs(P.variables(ring, p)) do
      local r = rate_of(v)
      if r ~= 0 then out = out + expression(field, P.partial(ring, p, v)) * r end
    end
    return out
  end
  local sum = of_polynomial(e.num) * expression(field, { 1 }, e.d, e.den)
  for id, power in pairs(e.den) do
    local slope = of_polynomial(field.factors[id])
    if not slope:is_zero() then
      sum = sum - e * slope * expression(field, { power }, 1, { [id] = 1 })
    end
  end
  return sum
end

--- The partial derivative de/dv.
function M.partial(e, v)
  return M.derive(e, function(w) return w == v and 1 or 0 end)
end

--- f(x) of an elementary function by its name: a number, or an atom of the field.
function M.apply(name, x)
  local row = functions[name]
  if not M.is(x) then return row.value(x) end
  local c = x:constant()
  if c and row.exact[c] then return M.number(x.field, row.exact[c]) end
  local text = ("%s(%s)"):format(name, tostring(x))
  return M.variable(x.field, text, { rank = -1e6 - #x.field.variables, text = text,
    tex = ("\\%s\\left(%s\\right)"):format(row.tex or name, x:tex()), f = name, argument = x })
end

--- e with value(v, info) in the place of variable v: numbers, or expressions of any field.
function M.map(e, value)
  local field, known = e.field, {}
  local function at(v)
    local info = field.variables[v]
    if known[v] == nil then
      if info.constant then
        known[v] = info.constant
      elseif info.argument then
        known[v] = M.apply(info.f, M.map(info.argument, value))
      elseif info.base then
        known[v] = M.map(info.base, value) ^ (1 / info.q)
      else
        known[v] = value(v, info)
      end
    end
    return known[v]
  end
  local function of_polynomial(p)
    local out = 0
    for _, m in ipairs(P.sorted(field.ring, p)) do
      local list, term = field.ring.monomials[m], p[m]
      for i = 1, #list, 2 do
        local x = at(list[i])
        term = list[i + 1] == 1 and term * x or term * x ^ list[i + 1]
      end
      out = out + term
    end
    return out
  end
  local out = of_polynomial(e.num)
  if e.d ~= 1 then out = out / e.d end
  for id, power in pairs(e.den) do
    local f = of_polynomial(field.factors[id])
    out = out / (power == 1 and f or f ^ power)
  end
  return out
end

return M
