--- Meshes made from parts of a mesh (Leok 3.3): skeleton, closure of cells, boundary, link; and the
-- mesh that flips make of a surface. A part has its own numbering of vertices, ascending as in the
-- mesh it is of, and comes with the list of what they are there.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local fail = option.fail

local function degree_of(K, k, where)
  if math.type(k) ~= "integer" or k < 0 or k > K.dimension then
    fail(where, "a degree from 0 to %d is needed (got %s)", K.dimension, option.got(k))
  end
  return k
end

-- new numbers of the vertices that occur, and the list of the old ones
local function numbering(simplices)
  local number, vertices = {}, {}
  for _, s in ipairs(simplices) do
    for _, v in ipairs(s) do
      if not number[v] then number[v], vertices[#vertices + 1] = true, v end
    end
  end
  table.sort(vertices)
  for i, v in ipairs(vertices) do number[v] = i end
  return number, vertices
end

local function renumbered(simplices, number)
  local out = {}
  for i, s in ipairs(simplices) do
    local cell = {}
    for j, v in ipairs(s) do cell[j] = number[v] end
    out[i] = cell
  end
  return out
end

-- the lengths of edges between old vertices, as a function of new ones
local function lengths_of(K, vertices)
  local volume = K:volume(1)
  return function(i, j) return volume[K:find { vertices[i], vertices[j] }] end
end

--- The mesh of some simplices of K with the metric of K, and the vertices that it is of; nothing
-- where there are no simplices.
function M.part(K, simplices)
  if #simplices == 0 then return nil end
  local number, vertices = numbering(simplices)
  local given = { simplices = renumbered(simplices, number), dual = K.dual }
  if K.ambient then
    local points, all = {}, K:points()
    for i, v in ipairs(vertices) do points[i] = all[v]:totable() end
    given.points = core.matrix(points)
  elseif K.measured then
    given.lengths = lengths_of(K, vertices)
  end
  return core.complex(given), vertices
end
local part = M.part

-- simplices of degree k with these numbers
local function simplices_of(K, k, cells, out)
  local all = K:simplices(k)
  if type(cells) ~= "table" then
    fail("mesh:subcomplex", "the cells of degree %d must be a list of their numbers (got %s)", k,
      option.got(cells))
  end
  for _, i in ipairs(cells) do
    if not all[i] then
      fail("mesh:subcomplex", "there is no cell %s of degree %d", option.got(i), k)
    end
    out[#out + 1] = all[i]
  end
  return out
end

class.method("dm.mesh", "subcomplex", function(K, cells)
  local out = {}
  if type(cells) ~= "table" then
    fail("mesh:subcomplex", "takes a table { [k] = { cell, ... } } (got %s)", option.got(cells))
  end
  for k = 0, K.dimension do simplices_of(K, k, cells[k] or {}, out) end
  for k in pairs(cells) do degree_of(K, k, "mesh:subcomplex") end
  return part(K, out)
end, [[
K:subcomplex{[k] = {cell, ...}} -> dm.mesh, list of vertices
The closure of cells, given by their numbers in every degree: a mesh of its own with the metric of
this one, its vertices numbered anew, in the same order; and the list of what they are here. Nothing
where there are no cells.]])

class.method("dm.mesh", "skeleton", function(K, k)
  return part(K, K:simplices(degree_of(K, k, "mesh:skeleton")))
end, [[
K:skeleton(k) -> dm.mesh, list of vertices
The mesh of all cells of degree k and their faces; vertices as in mesh:subcomplex.]])

class.method("dm.mesh", "boundary", function(K)
  local k = K.dimension - 1
  return part(K, simplices_of(K, k, K:boundary_cells(k), {}))
end, [[
K:boundary() -> dm.mesh, list of vertices   or nothing
The mesh of the facets that have one top cell; vertices as in mesh:subcomplex. Nothing where there
is no boundary.]])

class.method("dm.mesh", "open_star", function(K, k, cell)
  local out = {}
  for d = degree_of(K, k, "mesh:open_star"), K.dimension do out[d] = K:star_cells(k, cell, d) end
  return out
end, [[
K:open_star(k, i) -> table of lists of cell numbers
The cells that have cell i of degree k as a face, with the cell itself, by degree: star[d].]])

class.method("dm.mesh", "link", function(K, k, cell)
  local out, own = {}, {}
  local star = K:open_star(k, cell)
  for _, v in ipairs(K:simplices(k)[cell]) do own[v] = true end
  for d = k + 1, K.dimension do
    local all = K:simplices(d)
    for _, i in ipairs(star[d]) do
      local opposite = {}
      for _, v in ipairs(all[i]) do opposite[#opposite + 1] = not own[v] and v or nil end
      out[#out + 1] = opposite
    end
  end
  return part(K, out)
end, [[
K:link(k, i) -> dm.mesh, list of vertices   or nothing
The link of cell i of degree k: of every cell around it the face that it leaves out; vertices as in
mesh:subcomplex. Nothing where it is no face of another cell.]])

class.method("dm.mesh", "make_delaunay", function(K)
  local simplices, squares = K:flip_values()
  local given = { simplices = simplices, degree = 2, dual = K.dual }
  if K.ambient == 2 then
    given.points = K:points()
  else
    local length = {}
    for t = 0, #simplices - 1, 3 do
      for i = 0, 2 do
        local a, b = simplices[t + (i + 1) % 3 + 1], simplices[t + (i + 2) % 3 + 1]
        length[(a < b and a or b) * 2 ^ 32 + (a < b and b or a)] = squares[t + i + 1] ^ 0.5
      end
    end
    given.lengths = function(i, j) return length[i * 2 ^ 32 + j] end
  end
  return core.complex(given)
end, [[
K:make_delaunay() -> dm.mesh
The surface in other triangles: edges between two triangles whose dual is negative are flipped until
there are none, by lengths alone (Bobenko & Springborn 2007). Vertices, and the shape of the
surface, stay; a mesh in the plane keeps its points, one in space becomes a mesh of lengths, as new
edges run within its surface. Boundary edges stay. Raises where the result is no simplicial
complex.]])

--- dm.embeddable(D): is there a set of points with these distances?
M.embeddable = blame.caller(function(D, options)
  options = option.check(options or {}, { "tolerance" }, "dm.embeddable")
  local tolerance = option.positive(options, "tolerance", "dm.embeddable", "a number", 1e-10)
  local fine, distances = blame.try(core.matrix, D)
  if not fine then fail("dm.embeddable", "a matrix of distances is needed") end
  local n = #distances
  local squares, mean, total = {}, {}, 0
  for i = 1, n do
    squares[i], mean[i] = {}, 0
    for j = 1, n do
      local d = distances[i][j]
      if not d or d < 0 or d ~= distances[j][i] or i == j and d ~= 0 or d - d ~= 0 then
        fail("dm.embeddable", "distances are symmetric, not negative, 0 from a point to itself: "
          .. "entry [%d][%d] is %s", i, j, tostring(d))
      end
      squares[i][j] = d * d
      mean[i], total = mean[i] + d * d / n, total + d * d / n / n
    end
  end
  local gram = core.zeros(n, n)
  for i = 1, n do
    for j = 1, n do gram[i][j] = -(squares[i][j] - mean[i] - mean[j] + total) / 2 end
  end
  local eigenvalues = gram:eigenvalues()
  local least, largest, dimension = math.huge, 0, 0
  for i = 1, n do
    least, largest = math.min(least, eigenvalues[i]), math.max(largest, eigenvalues[i])
  end
  for i = 1, n do
    if eigenvalues[i] > tolerance * largest then dimension = dimension + 1 end
  end
  return least >= -tolerance * largest, eigenvalues, dimension
end)

core.docs[M.embeddable] = [[
dm.embeddable(D [, {tolerance=}]) -> boolean, dm.vector, number
Are there points of a Euclidean space with the distances D[i][j]? The eigenvalues of -J D^2 J / 2,
D^2 of the squares and J = 1 - 1 1^T / n, tell: none may be below -tolerance (1e-10) of the largest.
The third result is how many are above: the dimension (Leok, Ex 3.4).]]

return M
