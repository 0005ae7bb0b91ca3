--- K:sum: a sum over the cells of a mesh, in a Lagrangian (where it stays a loop) or on forms.
local class = require "dm.base.class"
local cell_of = require "dm.dec.fields.cell"
local cochain = require "dm.dec.fields.cochain"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"

local WHERE = "mesh:sum"

local function fail(...) option.fail(WHERE, ...) end

-- what the function gets of one argument
local function reader(K, k, x, i)
  if not cochain.is_cochain(x) and not form.is_form(x) then
    if type(x) == "number" or core.is_symbol(x) then return function() return x end end
    fail("argument %d must be a form, a number or a scalar of L (got %s)", i + 2, option.got(x))
  end
  if not rawequal(x.mesh, K) then fail("argument %d is a form of another mesh", i + 2) end
  if x.side ~= "primal" then fail("argument %d must be a primal form", i + 2) end
  if x.degree > k then
    fail("argument %d is a %d-form, and a cell of degree %d has no such face: put the sum on the "
      .. "larger cell", i + 2, x.degree, k)
  end
  if form.is_form(x) then
    return function(cell)
      return cell_of.shown(cell, x.degree, function(c, set)
        return cell_of.column(c, x.values, 1, 0, set)
      end)
    end
  end
  return function(cell) return cell_of.shown(cell, x.degree, x.at) end
end

-- what the first unknown of a Lagrangian belongs to; of forms alone: no unknown
local function around_of(list)
  for _, x in ipairs(list) do
    if cochain.is_cochain(x) and x.around then return x.around end
  end
  return { n = 0, q = core.constant(1, 0) }
end

class.method("dm.mesh", "sum", function(K, k, f, ...)
  if math.type(k) ~= "integer" or k < 0 or k > K.dimension then
    fail("a degree from 0 to %d is needed (got %s)", K.dimension, option.got(k))
  end
  if type(f) ~= "function" then
    fail("a function (a, ..., cell) of the values on the faces of a cell is needed (got %s)",
      option.got(f))
  end
  local list, read = { ... }, {}
  if select("#", ...) == 0 then fail("a form is needed behind the function") end
  for i = 1, select("#", ...) do read[i] = reader(K, k, list[i], i) end
  local around = around_of(list)
  return cochain.sum(K, k, around, around.data, function(cell)
    local values = {}
    for i = 1, #read do values[i] = read[i](cell) end
    values[#read + 1] = cell
    return f(table.unpack(values, 1, #read + 1))
  end)
end, [[
K:sum(k, f, A, ...) -> number
The sum of f(a, ..., cell) over the cells of degree k. a: the values of the form A on the faces of
the cell, a dm.vector in ascending order; a number where A has the degree k; a list of vectors where
A has several values. Numbers and scalars of L, such as t, are passed on. cell: volume, star (dual
volume over volume), lengths of its edges (a vector), points of its vertices (a list of vectors),
and the data of the field by name. In L of K:field and in the term of K:stationary f is called once,
with symbols, and the sum stays a loop whatever the size of the mesh; on forms of numbers it is a
loop in Lua. Every entry of the gradient is written by one place in a fixed order.]])
