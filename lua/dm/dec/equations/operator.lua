--- dm.operator: linear maps of forms as sparse matrices. An operator knows which forms it takes and
-- gives; self-adjoint ones also have their stiffness S = M A, the symmetric matrix of the product
-- a . (A b), from which A itself is made when it is asked for.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"

local M = {}

local Operator = core.class({ __name = "dm.operator" }, [[
dm.operator: a linear map of forms as a sparse matrix, made by K:d, K:star, K:laplacian, ...
fields: mesh, from, to ({ degree, side }), matrix (dm.sparse), nonzeros (entries that are not 0);
A * form, A * B, A + B, A - B, number * A]])
class.later("dm.operator", "eigen", "dm.dec.equations")

local fail = option.fail
local getmetatable, rawget, rawequal, type = getmetatable, rawget, rawequal, type

--- The degree of the cells that forms of a kind are listed by.
function M.listed(mesh, kind)
  return kind.side == "dual" and mesh.dimension - kind.degree or kind.degree
end

function M.primal(degree) return { degree = degree, side = "primal" } end
function M.dual(degree) return { degree = degree, side = "dual" } end

--- An operator. parts: matrix, or make = a function that gives it; stiffness = S of a self-adjoint
-- one; keep = marks of the cells that are not fixed, nil for all; weights = the masses of another
-- product than that of the forms.
function M.new(mesh, from, to, parts)
  parts.mesh, parts.from, parts.to = mesh, from, to
  return setmetatable(parts, Operator)
end
local new = M.new

function M.is_operator(x) return getmetatable(x) == Operator end
local is_operator = M.is_operator

local function same(a, b) return a.degree == b.degree and a.side == b.side end

local function named(kind) return ("%s %d-forms"):format(kind.side, kind.degree) end

local index = Operator.__index
function Operator.__index(A, key)
  if key == "matrix" and rawget(A, "make") then
    local matrix = A.make()
    rawset(A, "matrix", matrix)
    return matrix
  end
  if key == "nonzeros" then return A.matrix.nonzeros end
  return index(A, key)
end

function Operator.__tostring(A)
  return ("operator from %s to %s"):format(named(A.from), named(A.to))
end

---- what it does ----

local function apply(A, a)
  if not rawequal(A.mesh, a.mesh) then fail("operator * form", "they are of two meshes") end
  if not same(A.from, a) then
    fail("operator * form", "it takes %s, not a %s", named(A.from), form.name(a))
  end
  return form.new(A.mesh, A.to.degree, A.to.side, A.matrix * a.values)
end

local function compose(A, B)
  if not rawequal(A.mesh, B.mesh) then fail("operator * operator", "they are of two meshes") end
  if not same(A.from, B.to) then
    fail("operator * operator", "the left one takes %s, the right one gives %s", named(A.from),
      named(B.to))
  end
  return new(A.mesh, B.from, A.to, { make = function() return A.matrix * B.matrix end })
end

local function scaled(A, factor)
  return new(A.mesh, A.from, A.to, {
    make = function() return factor * A.matrix end,
    stiffness = A.stiffness and factor * A.stiffness, keep = A.keep,
  })
end

function Operator.__mul(A, B)
  if type(A) == "number" then return scaled(B, A) end
  if type(B) == "number" then return scaled(A, B) end
  if form.is_form(B) then return apply(A, B) end
  if is_operator(A) and is_operator(B) then return compose(A, B) end
  fail("operator * x", "a form, an operator or a number is needed (got %s)",
    option.got(is_operator(A) and B or A))
end

local function sum(A, B, factor, where)
  if not (is_operator(A) and is_operator(B)) then
    fail(where, "two operators are needed (got %s)", option.got(is_operator(A) and B or A))
  end
  if not rawequal(A.mesh, B.mesh) then fail(where, "they are of two meshes") end
  if not (same(A.from, B.from) and same(A.to, B.to)) then
    fail(where, "one maps %s to %s, the other %s to %s", named(A.from), named(A.to),
      named(B.from), named(B.to))
  end
  local alike = A.stiffness and B.stiffness and A.keep == B.keep
  return new(A.mesh, A.from, A.to, {
    make = function() return A.matrix + factor * B.matrix end,
    stiffness = alike and A.stiffness + factor * B.stiffness or nil, keep = alike and A.keep or nil,
  })
end

function Operator.__add(A, B) return sum(A, B, 1, "operator + operator") end

function Operator.__sub(A, B) return sum(A, B, -1, "operator - operator") end

function Operator.__unm(A) return scaled(A, -1) end

return M
