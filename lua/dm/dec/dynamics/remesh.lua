--- dm.remesh: forms from one mesh to another one of the same set (Leok 3.14). The matrices are C's
-- (src/dec/transfer/transfer.h).
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"

local M = {}

local Remesh = core.class({ __name = "dm.remesh" }, [[
dm.remesh: takes forms of a mesh to another mesh of the same set, made by dm.remesh(K, M)
fields: from, to (meshes), rule; T(a) is the form on the other mesh]])

local WHERE = "dm.remesh"
local fail = option.failing(WHERE)

local RULES = { "whitney", "sum", "thesis" }

local function check_mesh(K, which)
  if option.got(K) ~= "dm.mesh" then
    fail("the %s must be a mesh (got %s)", which, option.got(K))
  end
  if not K.ambient then fail("the %s has no points: make it with points =", which) end
end

M.remesh = blame.caller(function(K, L, options)
  check_mesh(K, "first argument")
  check_mesh(L, "second argument")
  options = option.check(options or {}, { "rule" }, WHERE)
  if K.dimension ~= L.dimension then
    fail("the meshes have dimensions %d and %d", K.dimension, L.dimension)
  end
  if K.ambient ~= L.ambient then
    fail("the points have %d and %d coordinates", K.ambient, L.ambient)
  end
  local rule = option.one_of(options, "rule", WHERE, RULES, "whitney")
  if rule == "thesis" and K.ambient ~= K.dimension then
    fail('rule = "thesis" is for meshes that fill their space, not for bent ones')
  end
  return setmetatable({ from = K, to = L, rule = rule, matrices = {} }, Remesh)
end)

core.docs[M.remesh] = [[
dm.remesh(K, M, {rule = "whitney" | "sum" | "thesis"}) -> dm.remesh
T(a): a primal form on the mesh K as a form on M, a mesh of the same set |K| = |M|. "whitney" (the
default): integrals of the Whitney form over the cells of M; exact on constant forms, T d = d T, the
identity for M = K, and where K is coarse and M finer the exact prolongation. "sum": for cells of M
that are unions of cells of K, their sums: the restriction to a coarser mesh. "thesis": by supports,
sum of +-|V_t and V_s| / |V_s|, as printed (Leok 3.14): right for the highest degree alone.
T:matrix(k) is the matrix of degree k. Raises where a cell of M is not covered by K once, with how
much of it is; surfaces in space must have the same points, not only nearly.]]

local function cell_text(K, k, i)
  return ("{%s}"):format(table.concat(K:simplices(k)[i], ", "))
end

local function matrix_of(T, k, where)
  if math.type(k) ~= "integer" or k < 0 or k > T.from.dimension then
    option.fail(where, "a degree from 0 to %d is needed (got %s)", T.from.dimension, option.got(k))
  end
  if not T.matrices[k] then
    local matrix, cell, covered = T.from:transfer(T.to, k, T.rule)
    if not matrix and T.rule == "sum" then
      option.fail(where, "the meshes are not nested: cell %s of degree %d of the second one is not "
        .. "a union of cells of the first (%.6g of it is)", cell_text(T.to, k, cell), k, covered)
    elseif not matrix then
      option.fail(where, "the meshes are not of one set: of cell %s of degree %d of the second one "
        .. "the part %.6g lies in the first", cell_text(T.to, k, cell), k, covered)
    end
    T.matrices[k] = matrix
  end
  return T.matrices[k]
end

function Remesh.__call(T, a)
  local where = "T(a) of dm.remesh"
  if not form.is_form(a) or not rawequal(a.mesh, T.from) then
    option.fail(where, "a form of the first mesh is needed (got %s)",
      form.is_form(a) and "a form of another mesh" or option.got(a))
  end
  if a.side ~= "primal" then
    option.fail(where, "a primal form is needed, not a %s; its star is one", form.name(a))
  end
  return form.new(T.to, a.degree, "primal", matrix_of(T, a.degree, where) * a.values)
end

function Remesh.__tostring(T)
  return ('remesh by "%s" from %d to %d vertices'):format(T.rule, T.from:count(0), T.to:count(0))
end

class.method("dm.remesh", "matrix", function(T, k) return matrix_of(T, k, "remesh:matrix") end, [[
T:matrix(k) -> dm.sparse
The matrix that takes values of k-forms: a row for each k-cell of the second mesh, a column for each
of the first.]])

return M
