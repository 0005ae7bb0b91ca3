--- dm.form: cochains, the discrete forms of a mesh (Leok 3.5, Def 3.10-3.12). A primal form of
-- degree k has a number for every k-cell, a dual one for the dual of every (n - k)-cell; dual forms
-- are listed by these primal cells. Forms of one mesh, degree and side can be added.
local class = require "dm.base.class"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local Form = core.class({ __name = "dm.form" }, [[
dm.form: a number for every cell of a degree of a mesh, made by K:form(k, ...)
fields: mesh, degree, side ("primal", "dual"), values (a dm.vector); a[i], #a, + - * / with
numbers, == entry by entry]])

local fail = option.fail
local rawequal, getmetatable, type = rawequal, getmetatable, type

--- The degree of the primal cells that a form is listed by.
local function listed(a) return a.side == "dual" and a.mesh.dimension - a.degree or a.degree end
M.listed = listed

local function is_finite(x) return x - x == 0 end

--- A form of a mesh; values: a dm.vector, as many as there are cells. Raises where one is NaN or
-- infinite.
function M.new(mesh, degree, side, values)
  local zeros = 0 * values  -- NaN where an entry is not finite
  if not is_finite(zeros:dot(zeros)) then
    for i = 1, #values do
      if not is_finite(values[i]) then
        fail("dm.form", "value %d of a %s %d-form is %s: values must be finite", i, side, degree,
          values[i] ~= values[i] and "NaN" or "infinite")
      end
    end
  end
  return setmetatable({ mesh = mesh, degree = degree, side = side, values = values }, Form)
end
local new = M.new

function M.is_form(x) return getmetatable(x) == Form end
local is_form = M.is_form

--- "primal 1-form", of messages.
function M.name(a) return ("%s %d-form"):format(a.side, a.degree) end
local name = M.name

--- Raises where two forms are not of one kind.
function M.match(a, b, where)
  if not (is_form(a) and is_form(b)) then
    fail(where, "a form of the same kind is needed (got %s)", option.got(is_form(a) and b or a))
  end
  if not rawequal(a.mesh, b.mesh) then fail(where, "the forms are of two meshes") end
  if a.degree ~= b.degree then
    fail(where, "the forms have different degrees, %d and %d", a.degree, b.degree)
  end
  if a.side ~= b.side then fail(where, "one form is %s, the other %s", a.side, b.side) end
end
local match = M.match

---- arithmetic ----

--- a form among the symbols of a Lagrangian, beside x: set by dm.dec.fields.cochain
function M.lift() return nil end

-- what a form is lifted to where the other operand, of the two that follow, is no number
local function lifted(a, b)
  if is_form(a) and is_form(b) then return nil end
  local up = is_form(a) and M.lift(a, b) or not is_form(a) and M.lift(b, a)
  if not up then return nil end
  return is_form(a) and up or a, is_form(a) and b or up
end

local function with(a, values) return new(a.mesh, a.degree, a.side, values) end

function Form.__add(a, b)
  local x, y = lifted(a, b)
  if x then return x + y end
  match(a, b, "form + form")
  return with(a, a.values + b.values)
end

function Form.__sub(a, b)
  local x, y = lifted(a, b)
  if x then return x - y end
  match(a, b, "form - form")
  return with(a, a.values - b.values)
end

function Form.__unm(a) return with(a, -a.values) end

function Form.__mul(a, b)
  if type(a) == "number" then return with(b, a * b.values) end
  if type(b) == "number" then return with(a, a.values * b) end
  local x, y = lifted(a, b)
  if x then return x * y end
  fail("form * x", "forms are multiplied by numbers; a:wedge(b) is the product of two")
end

function Form.__div(a, b)
  local x, y = lifted(a, b)
  if x then return x / y end
  if type(b) ~= "number" then fail("form / x", "a form is divided by numbers") end
  return with(a, a.values / b)
end

function Form.__eq(a, b)
  return rawequal(a.mesh, b.mesh) and a.degree == b.degree and a.side == b.side
    and a.values == b.values
end

function Form.__len(a) return #a.values end

local index = Form.__index
function Form.__index(a, key)
  if type(key) == "number" then return a.values[key] end
  return index(a, key)
end

function Form.__tostring(a)
  return ("%s: %s"):format(name(a), tostring(a.values))
end

---- methods ----

local SIGN = "the value on the cell with these vertices, in this order"

class.method("dm.form", "at", function(a, vertices)
  local cell, sign = a.mesh:find(vertices)
  if not cell or #vertices ~= listed(a) + 1 then
    fail("form:at", "there is no cell of degree %d with these vertices", listed(a))
  end
  return sign * a.values[cell]
end, "a:at{i, j, ...} -> number\n" .. SIGN:gsub("^t", "T") .. [[: odd orders change its sign. Of
dual forms the dual of the cell with these vertices.]])

class.method("dm.form", "d", function(a)
  local K, k, n = a.mesh, listed(a), a.mesh.dimension
  if a.degree == n then fail("form:d", "a form of degree %d, that of the mesh, has no d", n) end
  if a.side == "primal" then return new(K, k + 1, "primal", K:coboundary(k, a.values)) end
  local sign = k % 2 == 0 and 1 or -1
  local values = k == n and K:oriented(a.values) or a.values
  return new(K, a.degree + 1, "dual", sign * K:boundary_sum(k, values))
end, [[
a:d() -> dm.form
The exterior derivative, exact: d d = 0. On duals of k-cells it is (-1)^k times the transpose (Leok,
Def 3.16, 3.17, with the sign that keeps Def 3.19 right).]])

class.method("dm.form", "star", function(a, options)
  options = option.check(options or {}, { "pinv" }, "form:star")
  local K, k, n = a.mesh, listed(a), a.mesh.dimension
  local to = a.side == "primal" and "dual" or "primal"
  local values = K:star_values(k, a.values, to, options.pinv)
  return new(K, n - a.degree, to, k == n and K:oriented(values) or values)
end, [[
a:star{pinv=} -> dm.form
The Hodge star: a primal k-form becomes a dual (n - k)-form and back; star star = (-1)^(k (n - k)).
Raises "zero dual volume" with the cell where there is no way back, unless pinv = true: 0 there
(Leok, Def 3.18). Values on top cells are about ascending vertices, dual 0-forms are plain
functions: between them the sign of the coherent orientation enters.]])

class.method("dm.form", "delta", function(a, options)
  options = option.check(options or {}, { "pinv" }, "form:delta")
  if a.degree == 0 then fail("form:delta", "a form of degree 0 has no delta") end
  local K, k, n = a.mesh, a.degree, a.mesh.dimension
  if a.side == "dual" then
    return (n * (k - 1) % 2 == 0 and -1 or 1) * a:star():d():star(options)
  end
  local dual = K:boundary_sum(k, K:star_values(k, a.values, "dual"))
  local sign = (k - 1) * (n - k + 1) % 2 == 0 and 1 or -1
  return new(K, k - 1, "primal",
    sign * K:star_values(k - 1, dual, "primal", options.pinv))
end, [[
a:delta{pinv=} -> dm.form
The codifferential (-1)^(n (k - 1) + 1) * d * of a k-form, the adjoint of d: (d a).b = a.(delta b),
on closed meshes or with natural boundary conditions (Leok, Def 3.19). That of primal forms is
M^-1 d^T M and needs no orientation.]])

-- the factors of support volumes, which a product of complementary degrees is on (Def 3.35)
local SUPPORT = { "l2", "geometric", "thesis" }

-- number of lists of k among n
local function binomial(n, k)
  local product = 1
  for i = 1, k do product = product * (n - k + i) // i end
  return product
end

-- a primal k-form by a dual (n - k)-form: a number for the support of every k-cell
local function support_wedge(a, b, rule)
  local K, k, n = a.mesh, a.degree, a.mesh.dimension
  if a.side == "dual" then
    return (b.degree * (n - b.degree) % 2 == 0 and 1 or -1) * support_wedge(b, a, rule)
  end
  local factor = rule == "geometric" and 1 / binomial(n, k) or rule == "thesis" and 1 / n or 1
  local x, y = k == n and K:oriented(a.values) or a.values, b.values
  return x:map(function(value, i) return factor * value * y[i] end)
end

class.method("dm.form", "wedge", function(a, b, options)
  options = option.check(options or {}, { "rule" }, "form:wedge")
  local x, y = lifted(a, b)
  if x then return x:wedge(y, options) end
  if not is_form(b) then fail("form:wedge", "a form is needed (got %s)", option.got(b)) end
  if not rawequal(a.mesh, b.mesh) then fail("form:wedge", "the forms are of two meshes") end
  local K, degree = a.mesh, a.degree + b.degree
  local function rule(names)
    return option.one_of(options, "rule", "form:wedge", names, names[1])
  end
  if a.side ~= b.side then
    if degree ~= K.dimension then
      fail("form:wedge", "a %s and a %s have a product only where their degrees add up to %d",
        name(a), name(b), K.dimension)
    end
    return support_wedge(a, b, rule(SUPPORT))
  end
  local values = a.side == "dual"
    and K:dual_wedge_values(a.degree, a.values, b.degree, b.values, rule { "consistent", "thesis" })
    or K:wedge_values(a.degree, a.values, b.degree, b.values, rule { "natural", "metric", "cup" })
  return new(K, degree, a.side, values)
end, [[
a:wedge(b, {rule=}) -> dm.form, or a dm.vector
The product of two forms. Both primal: rule "natural" (the default), the mean over all orders of
vertices; anticommutative, d (a ^ b) = da ^ b +- a ^ db, no metric (Leok, Def 3.47); "metric":
weighted by shares of dual volumes (Def 3.24), without that rule; "cup": in the order of the
vertices, associative, not anticommutative. Both dual: "consistent" (the default), exact on constant
forms; "thesis": Def 3.25 as printed, wrong by a factor that depends on the cells around.
One primal of degree k, one dual of degree n - k: a dm.vector with a number for the support of every
k-cell, whose sum() is the integral: rule "l2" a(s) b(*s), "geometric" with 1 / C(n, k), "thesis"
with 1 / n (Def 3.35). Dual products need an orientation.]])

class.method("dm.form", "dot", function(a, b)
  local x, y = lifted(a, b)
  if x then return x:dot(y) end
  match(a, b, "form:dot")
  local K, k = a.mesh, listed(a)
  local sign = a.side == "dual" and k * a.degree % 2 == 1 and -1 or 1
  local product = K:star_values(k, a.values, a.side == "dual" and "primal" or "dual"):dot(b.values)
  if not is_finite(product) then fail("form:dot", "the product is too large for a number") end
  return sign * product
end, [[
a:dot(b) -> number
The L2 product of two forms of one kind, sum of |*s| / |s| a(s) b(s). Raises where it overflows.]])

class.method("dm.form", "norm", function(a)
  local square = a:dot(a)
  if square < 0 then
    fail("form:norm", "the square of the norm is %g, negative: the mesh has negative stars; "
      .. "K:quality() counts them", square)
  end
  return square ^ 0.5
end, "a:norm() -> number\nThe L2 norm. Raises where negative stars make its square negative.")

class.method("dm.form", "max", function(a)
  local largest = 0
  for i = 1, #a.values do
    local x = a.values[i]
    if x < 0 then x = -x end
    if x > largest or x ~= x then largest = x end
  end
  return largest
end, "a:max() -> number\nThe largest modulus of its values.")

-- in a room above this one
class.later("dm.form", "plot", "dm.dec.pictures.plot")

return M
