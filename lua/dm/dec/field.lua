--- dm.vector_field: a vector at every vertex or in every top cell of a mesh with points, and what
-- leads from vectors to forms and back (Leok 3.7, 3.9, Def 3.20-3.23, 3.26).
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local pointwise = require "dm.dec.pointwise"

local M = {}

local Field = core.class({ __name = "dm.vector_field" }, [[
dm.vector_field: a vector at every vertex or in every top cell of a mesh, made by
K:vector_field(f, ...) and a:sharp()
fields: mesh, on ("vertices", "cells"), values (a dm.matrix, a row each), projected (the largest
length of what pointed out of the cells and was taken away); X[i] is the list of components at
vertex or cell i, #X how many there are; + - and * / with numbers]])

local fail = option.fail
local rawequal, getmetatable, type, rawget = rawequal, getmetatable, type, rawget

local PLACES = { "vertices", "cells" }

--- A field of a mesh; values: a dm.matrix, a row for every vertex or top cell.
function M.new(mesh, on, values, projected)
  return setmetatable({ mesh = mesh, on = on, values = values, projected = projected or 0 }, Field)
end
local new = M.new

function M.is_field(x) return getmetatable(x) == Field end
local is_field = M.is_field

---- arithmetic ----

local function match(X, Y, where)
  if not (is_field(X) and is_field(Y)) then
    fail(where, "a field of vectors is needed (got %s)", option.got(is_field(X) and Y or X))
  end
  if not rawequal(X.mesh, Y.mesh) then fail(where, "the fields are of two meshes") end
  if X.on ~= Y.on then fail(where, "one field is on %s, the other on %s", X.on, Y.on) end
end

function Field.__add(X, Y)
  match(X, Y, "field + field")
  return new(X.mesh, X.on, X.values + Y.values)
end

function Field.__sub(X, Y)
  match(X, Y, "field - field")
  return new(X.mesh, X.on, X.values - Y.values)
end

function Field.__unm(X) return new(X.mesh, X.on, -X.values) end

function Field.__mul(X, x)
  if type(X) == "number" then X, x = x, X end
  if type(x) ~= "number" then fail("field * x", "fields are multiplied by numbers") end
  return new(X.mesh, X.on, x * X.values)
end

function Field.__div(X, x)
  if type(x) ~= "number" then fail("field / x", "a field is divided by numbers") end
  return new(X.mesh, X.on, X.values / x)
end

function Field.__eq(X, Y)
  return rawequal(X.mesh, Y.mesh) and X.on == Y.on and X.values == Y.values
end

function Field.__len(X) return #X.values end

local index = Field.__index
function Field.__index(X, key)
  if type(key) == "number" then
    local row = rawget(X, "values")[key]
    return row and row:totable()
  end
  return index(X, key)
end

function Field.__tostring(X)
  return ("field of vectors on %d %s: %s"):format(#X, X.on, tostring(X.values))
end

---- making them ----

local function sample(f, points)
  local out = {}
  f = core.one(f, "f(x, y, ...)")
  for i = 1, #points do
    local point = points[i]:totable()
    local v = pointwise.told(#point, f, table.unpack(point))
    if type(v) == "number" then v = { v } end
    out[i] = v
  end
  return out
end

-- the matrix of a function or of lists
local function values_of(K, x, on)
  local where = "mesh:vector_field"
  local count, N = K:count(on == "cells" and K.dimension or 0), K.ambient
  if type(x) == "function" then
    x = sample(x, on == "cells" and K:circumcentres(K.dimension) or K:points())
  end
  local fine, values = blame.try(core.matrix, lists.count(x) and x or {})
  if not fine then
    fail(where, "a vector of %d components is needed at each of the %s (%s)", N, on,
      lists.count(x) and tostring(values) or "got " .. option.got(x))
  end
  if #values ~= count or #values[1] ~= N then
    fail(where, "%d vectors of %d components are needed, one for each of the %s (got %d of %d)",
      count, N, on, #values, #values[1])
  end
  for i = 1, count do
    local square = values[i]:dot(values[i])
    if square - square ~= 0 then fail(where, "the vector of number %d is not finite", i) end
  end
  return values
end

class.method("dm.mesh", "vector_field", function(K, x, options)
  option.check(options or {}, { "on" }, "mesh:vector_field")
  local on = option.one_of(options or {}, "on", "mesh:vector_field", PLACES, "vertices")
  if not K.ambient then
    fail("mesh:vector_field", "fields of vectors need points, and this mesh has none; forms go on "
      .. "without")
  end
  local values = values_of(K, x, on)
  if on == "cells" and K.ambient > K.dimension then
    return new(K, on, K:tangent_values(values, on))
  end
  return new(K, on, values)
end, [[
K:vector_field(f | vectors, {on = "vertices" | "cells"}) -> dm.vector_field
The field f(x, y, ...) -> { vx, vy, ... } at the vertices (the default) or at the centres of the top
cells; or a list of vectors. On cells of a surface in space what points out of the cell is taken
away; X.projected is the largest length that went (Leok, Def 3.20, 3.21).]])

---- flat and sharp ----

class.method("dm.vector_field", "flat", function(X, options)
  option.check(options or {}, { "to" }, "field:flat")
  local to = option.one_of(options or {}, "to", "field:flat", { "primal", "dual" }, "primal")
  local values, averaged = X.mesh:flat_values(X.values, X.on, to)
  local a = form.new(X.mesh, 1, to, values)
  a.averaged = averaged
  return a
end, [[
X:flat{to = "primal" | "dual"} -> dm.form
The 1-form of a field. To edges e (the default), from cells: the mean of X.e with the shares of the
dual of e as weights (Leok, Def 3.22); where that dual has no volume the plain mean, and a.averaged
counts these edges; from vertices: (X_i + X_j).e / 2. To duals of facets f: the sum of |*f in s| X.m
over the top cells s at f, m the unit vector along *f; from vertices X is its mean over f. Constant
fields give exact values of the de Rham map.]])

class.method("dm.form", "sharp", function(a, options)
  options = option.check(options or {}, { "to", "rule", "pinv" }, "form:sharp")
  if a.degree ~= 1 then fail("form:sharp", "a 1-form is needed (got a %s)", form.name(a)) end
  local is_dual = a.side == "dual"
  local to = option.one_of(options, "to", "form:sharp", PLACES, is_dual and "cells" or "vertices")
  local rule = option.one_of(options, "rule", "form:sharp", { "gradients", "thesis" }, "gradients")
  if is_dual and to == "vertices" then
    fail("form:sharp", "a dual 1-form becomes a field on cells")
  end
  if rule == "thesis" and (is_dual or to == "cells") then
    fail("form:sharp", 'rule = "thesis" takes primal 1-forms to vertices')
  end
  return new(a.mesh, to,
    a.mesh:sharp_values(a.values, a.side, to, rule == "thesis", options.pinv or false))
end, [[
a:sharp{to = "vertices" | "cells", rule = "thesis", pinv=} -> dm.vector_field
The field of a 1-form. A primal one to vertices (the default): the sum over the top cells s of a
vertex v of |*v in s| / |*v| times the sum of a[v, u] grad phi_u (Leok, Def 3.23 with the gradients
and weights that make it exact on d of linear functions); to cells: its Whitney interpolant at the
centre. A dual one to cells: least squares over the facets of a cell. rule = "thesis" is Def 3.23 as
printed, which is not exact on constants. Raises "zero dual volume" where one is divided by, unless
pinv = true: 0 there.]])

---- gradient, curl, divergence ----

class.method("dm.form", "grad", function(f, options)
  if f.degree ~= 0 then fail("form:grad", "a 0-form is needed (got a %s)", form.name(f)) end
  return f:d():sharp(options)
end, [[
f:grad{to = "vertices" | "cells", ...} -> dm.vector_field
The gradient (df)-sharp of a function, options as in a:sharp; exact for linear functions. That of a
dual function is on cells.]])

class.method("dm.vector_field", "curl", function(X, options)
  local n = X.mesh.dimension
  if n ~= 2 and n ~= 3 then
    fail("field:curl", "a mesh of dimension 2 or 3 is needed (got %d)", n)
  end
  local turned = X:flat():d():star()
  return n == 2 and turned or turned:sharp(options)
end, [[
X:curl() -> dm.form or dm.vector_field
In dimension 2 the dual 0-form * d X-flat, circulation by area in every triangle; in dimension 3 the
field (* d X-flat)-sharp on cells.]])

class.method("dm.vector_field", "div", function(X, options)
  option.check(options or {}, { "boundary" }, "field:div")
  local boundary = option.one_of(options or {}, "boundary", "field:div", { "flux" })
  return form.new(X.mesh, 0, "primal",
    X.mesh:divergence_values(X.values, X.on, boundary == "flux"))
end, [[
X:div{boundary = "flux"} -> dm.form
The divergence -delta X-flat, a primal 0-form: 1 / |*v| times the flux of X out of the dual cell of
v (Leok, Def 3.26). The sum of |*v| div X over vertices is the flux between their dual cells and
the others; the part of a dual cell that lies in the boundary of the mesh is left out unless
boundary = "flux", so without it constant fields have a divergence there.]])

---- contraction and Lie derivative ----

local SIDES = { "central", "forward", "backward" }

local function extrusion(a, X, side)
  if a.side ~= "primal" then
    fail("form:contract", 'a primal form is needed (got a %s)', form.name(a))
  end
  local values, averaged = X.mesh:contract_values(a.degree, a.values, X.values, X.on, side)
  local out = form.new(a.mesh, a.degree - 1, "primal", values)
  out.averaged = averaged
  return out
end

-- (-1)^(k (n - k)) * (*a ^ X-flat)
local function algebraic(a, X)
  local k, n = a.degree, a.mesh.dimension
  local sign = k * (n - k) % 2 == 0 and 1 or -1
  if a.side ~= "primal" then
    fail("form:contract", 'a primal form is needed (got a %s)', form.name(a))
  end
  return sign * a:star():wedge(X:flat { to = "dual" }):star()
end

local function contract(a, X, options, where)
  options = option.check(options or {}, { "method", "side" }, where)
  if not is_field(X) then
    fail(where, "a field of vectors is needed (got %s)", option.got(X))
  end
  if not rawequal(a.mesh, X.mesh) then fail(where, "form and field are of two meshes") end
  if a.degree == 0 then fail(where, "a form of degree 0 has no contraction") end
  local method = option.one_of(options, "method", where, { "extrusion", "algebraic" }, "extrusion")
  local side = option.one_of(options, "side", where, SIDES)
  if method == "algebraic" then
    if side then fail(where, 'sides belong to method = "extrusion"') end
    return algebraic(a, X)
  end
  return extrusion(a, X, side or "central")
end

class.method("dm.form", "contract", function(a, X, options)
  return contract(a, X, options, "form:contract")
end, [[
a:contract(X, {method = "extrusion" | "algebraic", side = "central" | "forward" | "backward"})
-> dm.form
The contraction i_X a of a primal k-form, a primal (k - 1)-form. "extrusion" (the default): the
derivative of the integral of a, as its Whitney interpolant, over the extrusion of a cell along X,
oriented (X, cell) (Leok, Lemma 3.5). Its value from each top cell differs: "central" takes the mean
by shares of the dual cell, "forward" the one that X points into, "backward" the one that -X points
into; where there is none, the nearest. "algebraic": (-1)^(k (n - k)) *(*a ^ X-flat), all dual
(Lemma 3.6). Both are exact on constants inside.]])

class.method("dm.form", "lie", function(a, X, options)
  local n, out = a.mesh.dimension, nil
  if a.side ~= "primal" then
    fail("form:lie", "a primal form is needed (got a %s)", form.name(a))
  end
  if a.degree < n then out = contract(a:d(), X, options, "form:lie") end
  if a.degree == 0 then return out end
  local exact = contract(a, X, options, "form:lie"):d()
  return out and out + exact or exact
end, [[
a:lie(X, {method=, side=}) -> dm.form
The Lie derivative i_X d a + d i_X a, options as in a:contract; d (L_X a) = L_X (d a) (Leok, Lemma
3.7).]])

-- in a room above this one
class.later("dm.vector_field", "plot", "dm.dec.pictures.plot")

return M
