--- Simplicial maps: chains pushed forward, forms pulled back, homology (Leok 3.13; spec 2.15).
local blame = require "dm.base.blame"
local chain = require "dm.dec.chain"
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local homology = require "dm.dec.homology"
local morse = require "dm.dec.homology.morse"
local option = require "dm.base.options"

local M = {}

local Map = core.class({ __name = "dm.simplicial_map" }, [[
dm.simplicial_map: a map of vertices that takes simplices to simplices, made by
dm.simplicial_map(K, L, vertices)
fields: from, to (meshes), vertices]])

local fail = option.fail
local WHERE = "dm.simplicial_map"

-- images of the vertices of a cell, each once
local function image_of(f, vertices)
  local seen, out = {}, {}
  for _, v in ipairs(vertices) do
    local w = f.vertices[v]
    if not seen[w] then
      seen[w] = true
      out[#out + 1] = w
    end
  end
  return out
end

-- every cell that is the face of no other must go to a cell
local function check_simplices(f)
  local K = f.from
  for k = 0, K.dimension do
    for i, vertices in ipairs(K:simplices(k)) do
      if k == K.dimension or #K:cofaces(k, i) == 0 then
        local image = image_of(f, vertices)
        if not f.to:find(image) then
          fail(WHERE, "the simplex {%s} goes to {%s}, which is no simplex of the second mesh",
            table.concat(vertices, ", "), table.concat(image, ", "))
        end
      end
    end
  end
end

local function is_mesh(x) return option.got(x) == "dm.mesh" end

--- The map that sends vertex i of K to vertices[i] of L.
M.simplicial_map = blame.caller(function(K, L, vertices)
  if not (is_mesh(K) and is_mesh(L)) then fail(WHERE, "two meshes are needed") end
  local list = {}
  for i = 1, K:count(0) do
    local w = type(vertices) == "table" and vertices[i]
    if math.type(w) ~= "integer" or w < 1 or w > L:count(0) then
      fail(WHERE, "vertices[%d] must be a vertex of the second mesh, 1 to %d (got %s)", i,
        L:count(0), option.got(w))
    end
    list[i] = w
  end
  if #vertices > #list then
    fail(WHERE, "%d vertices are given, the first mesh has %d", #vertices, #list)
  end
  local f = setmetatable({ from = K, to = L, vertices = list }, Map)
  check_simplices(f)
  return f
end)

core.docs[M.simplicial_map] = [[
dm.simplicial_map(K, L, vertices) -> dm.simplicial_map
The simplicial map that sends vertex i of the mesh K to vertex vertices[i] of L. Raises where a
simplex does not go to a simplex. f:push(chain), f:pull(form), f:homology(k).]]

-- the cell of L that vertices go to, and the sign of their order; nothing where two coincide
local function cell_of(f, vertices)
  local image = image_of(f, vertices)
  if #image < #vertices then return nil end
  return f.to:find(image)
end

local function pushed(f, k, terms)
  local simplices, out = f.from:simplices(k), {}
  for cell, x in pairs(terms) do
    local to, sign = cell_of(f, simplices[cell])
    if to then chain.add(out, to, chain.product(sign, x)) end
  end
  return out
end

class.method("dm.simplicial_map", "push", function(f, c)
  if not chain.is_chain(c) or not rawequal(c.mesh, f.from) then
    fail("map:push", "a chain of the first mesh is needed (got %s)", option.got(c))
  end
  if c.degree > f.to.dimension then return chain.new(f.to, c.degree, {}) end
  return chain.new(f.to, c.degree, pushed(f, c.degree, c.coefficients))
end, [[
f:push(c) -> dm.chain
The image of a chain: cells whose vertices coincide give nothing. d commutes with it.]])

class.method("dm.simplicial_map", "pull", function(f, a)
  if not form.is_form(a) or not rawequal(a.mesh, f.to) or a.side ~= "primal" then
    fail("map:pull", "a primal form of the second mesh is needed (got %s)", option.got(a))
  end
  if a.degree > f.from.dimension then
    fail("map:pull", "the first mesh has no cells of degree %d", a.degree)
  end
  local values = core.zeros(f.from:count(a.degree))
  for i, vertices in ipairs(f.from:simplices(a.degree)) do
    local cell, sign = cell_of(f, vertices)
    if cell then values[i] = sign * a.values[cell] end
  end
  return form.new(f.from, a.degree, "primal", values)
end, [[
f:pull(a) -> dm.form
The form on the first mesh whose value on a cell is that of a on its image, 0 where vertices
coincide. It commutes with d and with the natural wedge product (Leok 3.13).]])

class.method("dm.simplicial_map", "homology", function(f, k)
  if math.type(k) ~= "integer" or k < 0 then
    fail("map:homology", "a degree is needed (got %s)", option.got(k))
  end
  local generators = k <= f.from.dimension and homology.of(morse.of(f.from), k).generators or {}
  local rows, there = {}, k <= f.to.dimension and morse.of(f.to)
  for i = 1, there and there:betti(k) or 0 do rows[i] = {} end
  for j, c in ipairs(generators) do
    local x = there and homology.coordinates(there, k, pushed(f, k, c.coefficients)) or {}
    for i = 1, #rows do rows[i][j] = x[i] end
  end
  return core.result(rows)
end, [[
f:homology(k) -> list of rows of integers
The matrix of the map between the homologies of degree k without torsion, in the bases
K:generators(k): row i, column j tells how often image j goes round generator i. In the highest
degree of closed oriented manifolds it is the degree of the map.]])

function Map.__tostring(f)
  return ("dm.simplicial_map of %d vertices to %d"):format(f.from:count(0), f.to:count(0))
end

return M
