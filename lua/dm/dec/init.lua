--- Meshes: dm.mesh, and what a mesh makes. docs/design/dec.md says how they are built.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local files = require "dm.dec.files"
local form = require "dm.dec.form"
local lists = require "dm.base.lists"
require "dm.dec.chain"
require "dm.dec.field"
local named = require "dm.dec.named"
local option = require "dm.base.options"
local pointwise = require "dm.dec.pointwise"

local M = {}

local fail = option.failing "dm.mesh"

local KNOWN = { "simplices", "points", "lengths", "dual", "map", "radii", "ratio",
  table.unpack(named.names) }

-- the name of a mesh among the options, or nil
local function name_of(options)
  local found
  for _, name in ipairs(named.names) do
    if options[name] ~= nil then
      if found then fail("give one of '%s' and '%s'", found, name) end
      found = name
    end
  end
  return found
end

-- what belongs to one kind of mesh alone: options, and what they go with
local GOES_WITH = { ratio = "annulus", radii = "torus", simplices = "simplices",
  points = "simplices", lengths = "simplices" }

local function check_kind(options, name)
  for key, with in pairs(GOES_WITH) do
    if options[key] ~= nil and with ~= (name or "simplices") then
      if key == with then fail("give one of '%s' and '%s'", key, name) end
      fail("'%s' goes with '%s'%s", key, with, name and (", not with '%s'"):format(name) or "")
    end
  end
end

-- points moved by map(x, y, ...)
local function moved(points, map)
  if not points then fail("'map' moves points, and this mesh is made of lengths") end
  local out = {}
  map = core.one(map, "map")
  for i = 1, #points do
    local p = map(table.unpack(points[i]:totable()))
    if type(p) ~= "table" and getmetatable(p) ~= getmetatable(core.vector { 0 }) then
      fail("map must return the list of the moved point (got %s)", option.got(p))
    end
    out[i] = p
  end
  return out
end

--- From options to a mesh.
M.mesh = blame.caller(function(options)
  if type(options) == "string" then return files.mesh(options) end
  option.check(options, KNOWN, "dm.mesh")
  local name = name_of(options)
  check_kind(options, name)
  local given = name and named.make(name, options)
    or { simplices = options.simplices, points = options.points, lengths = options.lengths }
  if not given.simplices and given.points then -- Delaunay
    if not lists.count(given.points) then
      fail("option 'points' must be a list of points (got %s)", option.got(given.points))
    end
    given.points = core.matrix(given.points)
    given.simplices, given.degree = core.delaunay(given.points), #given.points[1]
  end
  option.callable(options, "map", "dm.mesh", "(x, y, ...)")
  if options.map then
    given.points = moved(given.points and core.matrix(given.points), options.map)
  end
  if not (given.points or given.lengths) then
    option.meaningless(options, "dual", "dm.mesh", "a mesh without points or lengths has no duals")
  end
  given.dual = options.dual
  return core.complex(given)
end)

core.docs[M.mesh] = [[
dm.mesh{simplices=, points= | lengths=, dual=, map=} or dm.mesh{name = size, ...} -> dm.mesh
dm.mesh(file) -> dm.mesh
A simplicial mesh of dimension 1 to 8: simplices, lists of vertex numbers from 1; points, a list of
points in any space, or lengths of edges (a number, a list, a function(i, j) with i < j), or
neither, for topology alone. Points alone: their Delaunay triangulation (dm.delaunay). map(x, y,
...) gives the list of the moved point; dual = "barycentric" takes duals from barycentres in place
of circumcentres: no star is zero or negative, but solutions of equations and speeds of waves err by
some percent however fine the mesh is. dm.complex says what is refused.
By name: grid = N (unit square), triangle = N (equilateral), annulus = {rings, m} with ratio =,
hex_torus = N, square_torus = N, torus = {nu, nv} with radii = {R, r}, klein = n, icosphere = s,
bcc = N (flat 3-torus), cube_tiling = N, simplex_boundary = m, cross_polytope = m, shells = {n, L},
named = "csaszar7" | "rp2" | "dunce".
From a file: .obj, .off, .msh (Gmsh 2.2 and 4.1), .mesh (Medit), .node and .ele (Triangle, TetGen),
as text. Points whose third coordinate is the same everywhere lie in the plane; of .msh and .mesh
the simplices of the highest dimension count. Errors name the line.]]

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
  local fine, values = blame.try(core.vector, x)
  if not fine or #values ~= count then
    option.fail("mesh:form", "values on the %d cells of degree %d are needed, got %s", count, k,
      fine and tostring(#values) or option.got(x))
  end
  return values
end

class.method("dm.mesh", "form", function(K, k, x, options)
  options = option.check(options or {}, { "dual", "order", "chart" }, "mesh:form")
  local is_dual = options.dual
  degree_of(K, k, "mesh:form")
  local listed = is_dual and K.dimension - k or k
  local order = option.whole(options, "order", "mesh:form", 1, 21)
  local chart = option.callable(options, "chart", "mesh:form", "(x, y, ...)")
  local values = type(x) == "function"
    and pointwise.told(K.ambient, K.integrals, K, k, x, is_dual, order, chart)
    or values_of(K, listed, x)
  return form.new(K, k, is_dual and "dual" or "primal", values)
end, [[
K:form(k, values | f, {dual=, order=, chart=}) -> dm.form
A form of degree k from its values, in the order of the cells (dual = true: of the duals of the
cells of degree n - k); or from f(x, y, ...), which gives the components of a smooth k-form, in
increasing order of their coordinates (dx dy, dx dz, dy dz): its integrals over the cells, about
ascending vertices, or over the dual cells (the de Rham map, Leok 3.5). order: the degree of
polynomials whose integrals are exact, 5 by default, at most 21. chart(x, y, ...) gives the list of
the point of a curved surface that belongs to a point of the mesh: cells are integrated over as it
bends them, such as p / |p| for a sphere. Raises where f gives what is not finite.]])

-- methods of forms that stand in rooms above
class.later("dm.form", "hodge", "dm.dec.equations")

return M
