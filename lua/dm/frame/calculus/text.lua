--- Exact formulas as text: kappa_ss + kappa^3/2, and the same for TeX.
local P = require "dm.frame.calculus.polynomial"
local field = require "dm.frame.calculus.field"

local M = {}

local Expression = field.Expression

-- how a style writes powers, fractions, brackets; name: the field of a variable that it shows
local plain = { power = function(x, e) return x .. "^" .. e end, name = "text",
  inside = function(x) return "(" .. x .. ")" end }
local tex = { power = function(x, e) return ("%s^{%d}"):format(x, e) end, name = "tex",
  inside = function(x) return "\\left(" .. x .. "\\right)" end }

function plain.fraction(top, bottom, is_product)
  return top .. "/" .. (is_product and "(" .. bottom .. ")" or bottom)
end
function tex.fraction(top, bottom) return ("\\frac{%s}{%s}"):format(top, bottom) end

-- v^e as a word
local function word(style, e, v, power)
  local info = e.field.variables[v]
  local name = info[style.name]
  if power == 1 then return name end
  if info.base or info.argument and style == tex then name = style.inside(name) end
  return style.power(name, power)
end

-- exponents of a monomial over one of the denominator: rows { v, exponent }, low ranks first
local function exponents(e, m, below)
  local rank, out, seen = e.field.ring.rank, {}, {}
  local list = e.field.ring.monomials[m]
  for i = 1, #list, 2 do
    local v = list[i]
    seen[v] = true
    out[#out + 1] = { v, list[i + 1] - (below[v] or 0) }
  end
  for v, power in pairs(below) do
    if not seen[v] then out[#out + 1] = { v, -power } end
  end
  table.sort(out, function(a, b) return rank[a[1]] < rank[b[1]] end)
  return out
end

-- one term of the numerator, without its sign, over the denominator d * monomial `below`
local function term(style, e, m, d, below)
  local c = math.abs(e.num[m])
  local g = P.whole_gcd(c, d)
  local above, under = {}, {}
  for _, row in ipairs(exponents(e, m, below)) do
    if row[2] > 0 then above[#above + 1] = word(style, e, row[1], row[2]) end
    if row[2] < 0 then under[#under + 1] = word(style, e, row[1], -row[2]) end
  end
  if c ~= g or #above == 0 then table.insert(above, 1, tostring(c // g)) end
  if d ~= g then table.insert(under, 1, tostring(d // g)) end
  local top = table.concat(above, " ")
  return #under == 0 and top or style.fraction(top, table.concat(under, " "), #under > 1)
end

local function sum(style, e, d, below)
  local out = {}
  for i, m in ipairs(P.sorted(e.field.ring, e.num)) do
    local negative = e.num[m] < 0
    out[#out + 1] = i == 1 and (negative and "-" or "") or (negative and " - " or " + ")
    out[#out + 1] = term(style, e, m, d, below)
  end
  return #out > 0 and table.concat(out) or "0"
end

-- the denominator: exponents of its variables, and words of its sums
local function denominator(style, e)
  local below, sums, ids = {}, {}, {}
  for id in pairs(e.den) do ids[#ids + 1] = id end
  table.sort(ids)
  for _, id in ipairs(ids) do
    local p, power = e.field.factors[id], e.den[id]
    local m = next(p)
    if next(p, m) == nil then
      below[e.field.ring.monomials[m][1]] = power
    else
      local text = style.inside(sum(style, field.expression(e.field, p), 1, {}))
      sums[#sums + 1] = power == 1 and text or style.power(text, power)
    end
  end
  return below, sums
end

local function written(style, e)
  local below, sums = denominator(style, e)
  if #sums == 0 then return sum(style, e, e.d, below) end
  local names, ordered = {}, {}
  for v in pairs(below) do ordered[#ordered + 1] = v end
  table.sort(ordered)
  if e.d ~= 1 then names[1] = tostring(e.d) end
  for _, v in ipairs(ordered) do names[#names + 1] = word(style, e, v, below[v]) end
  for _, text in ipairs(sums) do names[#names + 1] = text end
  local top = sum(style, e, 1, {})
  if style == plain and next(e.num, (next(e.num))) ~= nil then top = "(" .. top .. ")" end
  return style.fraction(top, table.concat(names, " "), #names > 1)
end

function Expression.__tostring(e) return written(plain, e) end
function Expression:tex() return written(tex, self) end

--- Does a text of a formula need brackets as a factor?
function M.is_sum(text) return text:find(" [+-] ") ~= nil or text:sub(1, 1) == "-" end

return M
