--- dm.chain: integer sums of cells of one degree (Leok 3.5, Def 3.10): exact, sums that leave 64
-- bits raise.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local Chain = core.class({ __name = "dm.chain" }, [[
dm.chain: a sum of cells of a mesh with integer coefficients, made by K:chain(k, {{2, {i, j}}, ...})
fields: mesh, degree; c[i] is the coefficient of cell i; + - and integer * chain, ==]])

local fail = option.fail
local rawequal, getmetatable, next, pairs = rawequal, getmetatable, next, pairs
local math_type, mininteger = math.type, math.mininteger

--- A chain; coefficients: a table cell -> integer that is not 0.
function M.new(mesh, degree, coefficients)
  return setmetatable({ mesh = mesh, degree = degree, coefficients = coefficients }, Chain)
end
local new = M.new

function M.is_chain(x) return getmetatable(x) == Chain end
local is_chain = M.is_chain

local TOO_LARGE = "a coefficient leaves the 64 bits of integers"

--- a + b of integers.
local function sum(a, b)
  local c = a + b
  if (a ~ c) & (b ~ c) < 0 then fail("dm.chain", TOO_LARGE) end
  return c
end
M.sum = sum

--- a * b of integers.
function M.product(a, b)
  if a == 0 or b == 0 then return 0 end
  local c = a * b
  if a == mininteger or b == mininteger or c // b ~= a or c % b ~= 0 then
    fail("dm.chain", TOO_LARGE)
  end
  return c
end
local product = M.product

--- coefficients[cell] += x, no zeros left.
function M.add(coefficients, cell, x)
  local total = sum(coefficients[cell] or 0, x)
  coefficients[cell] = total ~= 0 and total or nil
end
local add = M.add

local function match(a, b, where)
  if not (is_chain(a) and is_chain(b)) then
    fail(where, "a chain is needed (got %s)", option.got(is_chain(a) and b or a))
  end
  if not rawequal(a.mesh, b.mesh) then fail(where, "the chains are of two meshes") end
  if a.degree ~= b.degree then
    fail(where, "the chains have different degrees, %d and %d", a.degree, b.degree)
  end
end

local function combined(a, b, factor, where)
  match(a, b, where)
  local out = {}
  for cell, x in pairs(a.coefficients) do out[cell] = x end
  for cell, x in pairs(b.coefficients) do add(out, cell, product(factor, x)) end
  return new(a.mesh, a.degree, out)
end

function Chain.__add(a, b) return combined(a, b, 1, "chain + chain") end

function Chain.__sub(a, b) return combined(a, b, -1, "chain - chain") end

function Chain.__mul(a, b)
  if is_chain(a) then a, b = b, a end
  if math_type(a) ~= "integer" then
    fail("chain * x", "chains have integer coefficients (got %s)", option.got(a))
  end
  return combined(new(b.mesh, b.degree, {}), b, a, "chain * x")
end

function Chain.__unm(a) return -1 * a end

function Chain.__eq(a, b)
  if not rawequal(a.mesh, b.mesh) or a.degree ~= b.degree then return false end
  for cell, x in pairs(a.coefficients) do
    if b.coefficients[cell] ~= x then return false end
  end
  for cell in pairs(b.coefficients) do
    if not a.coefficients[cell] then return false end
  end
  return true
end

local index = Chain.__index
function Chain.__index(c, key)
  if math_type(key) == "integer" then return rawget(c, "coefficients")[key] or 0 end
  return index(c, key)
end

local MOST = 12 -- terms that are shown

function Chain.__tostring(c)
  local cells, out = {}, {}
  for cell in pairs(c.coefficients) do cells[#cells + 1] = cell end
  table.sort(cells)
  local simplices = c.mesh:simplices(c.degree)
  for i = 1, math.min(#cells, MOST) do
    local x = c.coefficients[cells[i]]
    local sign = x < 0 and (i == 1 and "-" or " - ") or i == 1 and "" or " + "
    local size = x < 0 and -x or x
    out[#out + 1] = ("%s%s[%s]"):format(sign, size == 1 and "" or size .. " ",
      table.concat(simplices[cells[i]], ", "))
  end
  if #cells > MOST then out[#out + 1] = (" + ... (%d terms)"):format(#cells) end
  return ("%d-chain: %s"):format(c.degree, #cells == 0 and "0" or table.concat(out))
end

---- methods ----

class.method("dm.chain", "boundary", function(c)
  local K, out = c.mesh, {}
  if c.degree == 0 then fail("chain:boundary", "a chain of vertices has no boundary") end
  for cell, x in pairs(c.coefficients) do
    for j, face in ipairs(K:faces(c.degree, cell)) do
      add(out, face, j % 2 == 1 and x or product(-1, x))
    end
  end
  return new(K, c.degree - 1, out)
end, "c:boundary() -> dm.chain\nThe boundary, exact: of [i, j] it is [j] - [i] (Leok, Def 3.13).")

class.method("dm.chain", "support", function(c)
  local cells = {}
  for cell in next, c.coefficients do cells[#cells + 1] = cell end
  table.sort(cells)
  return cells
end, "c:support() -> list of cell numbers\nThe cells with coefficients that are not 0, ascending.")

class.method("dm.form", "pair", function(a, c)
  if not is_chain(c) then fail("form:pair", "a chain is needed (got %s)", option.got(c)) end
  if not rawequal(a.mesh, c.mesh) then fail("form:pair", "form and chain are of two meshes") end
  if a.side ~= "primal" or a.degree ~= c.degree then
    fail("form:pair", "a %s and a %d-chain have no pairing: degrees must agree, and the form be "
      .. "primal", form.name(a), c.degree)
  end
  local total = 0.0
  for _, cell in ipairs(c:support()) do total = total + c.coefficients[cell] * a.values[cell] end
  return total
end, [[
a:pair(c) -> number
The value of a form on a chain, its integral: sum of c_i a(cell i), in the order of the cells.]])

---- making them ----

local function term(K, k, t, i)
  local x, vertices = t[1], t[2]
  if math_type(x) ~= "integer" or type(vertices) ~= "table" then
    fail("mesh:chain", "term %d must be { integer, { vertices } }", i)
  end
  local cell, sign = K:find(vertices)
  if not cell or #vertices ~= k + 1 then
    fail("mesh:chain", "term %d: there is no cell {%s} of degree %d", i,
      table.concat(vertices, ", "), k)
  end
  return cell, product(sign, x)
end

class.method("dm.mesh", "chain", function(K, k, terms)
  local out = {}
  if math_type(k) ~= "integer" or k < 0 or k > K.dimension then
    fail("mesh:chain", "a degree from 0 to %d is needed (got %s)", K.dimension, option.got(k))
  end
  if terms ~= nil and type(terms) ~= "table" then
    fail("mesh:chain", "a list of terms { integer, { vertices } } is needed (got %s)",
      option.got(terms))
  end
  for i, t in ipairs(terms or {}) do
    if type(t) ~= "table" then
      fail("mesh:chain", "term %d must be { integer, { vertices } } (got %s)", i, option.got(t))
    end
    local cell, x = term(K, k, t, i)
    add(out, cell, x)
  end
  return new(K, k, out)
end, [[
K:chain(k, {{2, {i, j}}, ...}) -> dm.chain
The sum of 2 [i, j] + ... of cells of degree k. The order of vertices counts: [j, i] = -[i, j].]])

class.method("dm.mesh", "fundamental", function(K)
  local signs, out = K:oriented(core.constant(K:count(K.dimension), 1)), {}
  for i = 1, #signs do out[i] = lists.whole(signs[i]) end
  return new(K, K.dimension, out)
end, [[
K:fundamental() -> dm.chain
The sum of all top cells in their coherent orientation; forms of the highest degree are integrated
over it. Raises where the mesh is not orientable.]])

return M
