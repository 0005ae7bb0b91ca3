--- Meshes: dm.mesh, and what a mesh makes. docs/design/dec.md says how they are built.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"

local M = {}

--- From options to a mesh.
function M.mesh(options)
  return core.complex(options)
end

core.docs[M.mesh] = [[
dm.mesh{simplices=, points= | lengths=, dual=} -> dm.mesh
A simplicial mesh of dimension 1 to 8: simplices, lists of vertex numbers from 1; points, a list of
points in any space, or lengths of edges (a number, a list, a function(i, j) with i < j), or neither,
for topology alone. See dm.complex for what is refused.]]

---- forms ----

local function degree_of(K, k, where)
  if math.type(k) ~= "integer" or k < 0 or k > K.dimension then
    option.fail(where, "a degree from 0 to %d is needed (got %s)", K.dimension, option.got(k))
  end
  return k
end

local function values_of(K, k, x)
  local count = K:count(k)
  if type(x) == "number" and count == 1 then x = { x } end
  local fine, values = pcall(core.vector, x)
  if not fine or #values ~= count then
    option.fail("mesh:form", "values on the %d cells of degree %d are needed, got %s", count, k,
      fine and tostring(#values) or option.got(x))
  end
  return values
end

class.method("dm.mesh", "form", function(K, k, x, options)
  option.check(options or {}, { "dual" }, "mesh:form")
  local is_dual = options and options.dual
  degree_of(K, k, "mesh:form")
  local listed = is_dual and K.dimension - k or k
  return form.new(K, k, is_dual and "dual" or "primal", values_of(K, listed, x))
end, [[
K:form(k, values | f(x, y, ...), {dual=}) -> dm.form
A form of degree k from its values, in the order of the cells (dual = true: of the duals of the cells
of degree n - k).]])

return M
