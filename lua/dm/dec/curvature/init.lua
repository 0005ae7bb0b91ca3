--- K:levi_civita: the discrete Levi-Civita connection of a simplicial manifold, on dual edges (Leok
-- 4.7.3) or, on surfaces, on edges (primal.lua). Rotations, rings and deficits are C
-- (src/dec/levi_civita); here are frames, loops and messages.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local options = require "dm.base.options"

local M = {}

local WHERE = "K:levi_civita"
local pi = math.pi

local Class = core.class({ __name = "dm.levi_civita" }, [[
dm.levi_civita: a discrete Levi-Civita connection, made by K:levi_civita{frames=, rule=, on=,
metric=}
fields: mesh, rule ("face" or "thesis"), on ("dual": frames in top cells, or "primal": frames at the
vertices of a surface).]])

function Class.__tostring(c)
  return ("Levi-Civita connection on %s edges%s of %s"):format(c.on,
    c.rule == "thesis" and ", as printed," or "", tostring(c.mesh))
end

---- the metric and the frames ----

-- squared lengths of the edges of a cell by its matrix g_ij = e_i . e_j, e_i from its first vertex
local function check_edges(squares, known, vertices, g, cell)
  local n = #vertices - 1
  local function G(i, j) return i > 0 and j > 0 and g[i][j] or 0 end
  for i = 0, n do
    for j = i + 1, n do
      local l = G(i, i) + G(j, j) - G(i, j) - G(j, i)
      local key = ("%d %d"):format(vertices[i + 1], vertices[j + 1])
      local other = squares[key]
      if other and math.abs(other - l) > 1e-10 * math.abs(l) then
        options.fail(WHERE, "metric: the cells %d and %d do not agree: the edge {%d, %d} has the "
          .. "length %.9g in one and %.9g in the other", known[key], cell, vertices[i + 1],
          vertices[j + 1], math.sqrt(math.abs(other)), math.sqrt(math.abs(l)))
      end
      if not (l > 0) then
        options.fail(WHERE, "metric: the matrix of cell %d is not positive definite: the edge {%d, "
          .. "%d} has the squared length %.6g", cell, vertices[i + 1], vertices[j + 1], l)
      end
      squares[key], known[key] = other or l, known[key] or cell
    end
  end
end

-- the mesh with the same cells and the metric that is a matrix on every top cell
local function measured_by(K, metric)
  local n, simplices, squares, known = K.dimension, K:simplices(K.dimension), {}, {}
  if not K.pure then
    options.fail(WHERE, "metric: every cell must lie in a cell of degree %d", n)
  end
  for cell = 1, #simplices do
    local g = kits.matrix(metric(cell), n, ("metric: what is returned for cell %d"):format(cell))
    check_edges(squares, known, simplices[cell], g, cell)
  end
  local list = {}
  for i = 1, #simplices do list[i] = lists.entries(simplices[i]) end
  return core.complex { simplices = list, lengths = function(i, j)
    return math.sqrt(squares[("%d %d"):format(i, j)])
  end }
end

-- a rotation of n x n of a user; of the plane an angle will do
local function rotation_of(value, n, what)
  if n == 2 and type(value) == "number" then
    local c, s = math.cos(value), math.sin(value)
    return core.matrix { { c, -s }, { s, c } }
  end
  local T = kits.matrix(value, n, what)
  local off = linear.largest(T:transpose() * T - core.identity(n))
  if not (off <= 1e-9) or T:det() < 0 then
    error(("%s must be a rotation, an element of SO(%d) (it is off by %.3g, det %.3g)")
      :format(what, n, off, T:det()), 0)
  end
  return T
end
M.rotation_of = rotation_of

-- n n numbers for every top cell, for C
local function frames_of(K, frames)
  if frames == nil then return nil end
  local n, out = K.dimension, {}
  for cell = 1, K:count(n) do
    local T = rotation_of(frames(cell), n, ("%s: the frame of cell %d"):format(WHERE, cell))
    for i = 1, n do
      for j = 1, n do out[#out + 1] = T[i][j] end
    end
  end
  return core.vector(out)
end

---- paths of cells ----

-- numbers of cells from 1 to count, at least one
local function path_of(list, count, what)
  local length = lists.count(list)
  if not length or length == 0 then
    error(("%s takes a list of cells (got %s)"):format(what, options.got(list)), 0)
  end
  local out = {}
  for k = 1, length do
    local cell = lists.whole(list[k])
    if not cell or cell < 1 or cell > count then
      error(("%s: entry %d must be the number of a cell, from 1 to %d (got %s)")
        :format(what, k, count, options.got(list[k])), 0)
    end
    out[k] = cell
  end
  return out
end
M.path_of = path_of

-- the product of the rotations along a path
local function along(c, path)
  local R = core.identity(c.mesh.dimension)
  for k = 1, #path - 1 do
    if path[k] ~= path[k + 1] then R = c:rotation(path[k], path[k + 1]) * R end
  end
  return R
end
M.along = along

local function is_closed(path, what)
  if path[1] == path[#path] then return end
  error(("%s: the loop is not closed: it goes from %d to %d; its last cell must be the first")
    :format(what, path[1], path[#path]), 0)
end

-- the angle of a rotation: with its sign in the plane, of all planes together in space
local function angle_of(R)
  if R.rows == 2 then return math.atan(R[2][1], R[1][1]) end
  return core.SO(R.rows):distance(R, core.identity(R.rows))
end

---- on dual edges ----

local dual = {}

function dual.count(c) return c.mesh:count(c.mesh.dimension) end

function dual.rotation(c, i, j)
  return c.mesh:frame_rotation(i, j, c.axes, c.rule == "thesis")
end

-- 2 pi - sum, or the angle of that rotation
local function angle_between(deficit)
  return math.abs(deficit - 2 * pi * math.floor(deficit / (2 * pi) + 0.5))
end

function dual.angle(c)
  local out = c.mesh:deficits()
  if c.rule == "thesis" then
    for cell = 1, #out do out[cell] = out[cell] and angle_of(dual.curvature(c, cell)) end
  elseif c.mesh.dimension > 2 then
    for cell = 1, #out do out[cell] = out[cell] and angle_between(out[cell]) end
  end
  return out
end

function dual.curvature(c, cell)
  local ring = c.mesh:dual_ring(cell)
  ring[#ring + 1] = ring[1]
  return along(c, ring)
end

-- the axes of the frame of a top cell in space: columns
function dual.frame(c, cell)
  local K = c.mesh
  local n, N = K.dimension, K.ambient
  if not N then error("A:frame: this mesh has no points: its frames have no place in space", 0) end
  local places, points = K:frame_places(cell, c.axes), K:points()
  local vertices = K:simplices(n)[cell]
  local own = linear.fill(n, n, function(i, j) return places[j + 1][i] end)
  local edges = linear.fill(N, n, function(i, j)
    return points[vertices[j + 1]][i] - points[vertices[1]][i]
  end)
  return edges * own:inverse()
end

local ways = { dual = dual }

---- the object ----

local KNOWN = { "frames", "rule", "on", "metric" }

M.levi_civita = blame.caller(function(K, given)
  given = options.check(given or {}, KNOWN, WHERE, "{ frames =, rule =, on =, metric = }")
  options.callable(given, "frames", WHERE, "the number of a cell, or of a vertex")
  options.callable(given, "metric", WHERE, "the number of a top cell")
  local rule = options.one_of(given, "rule", WHERE, { "face", "thesis" }, "face")
  local on = options.one_of(given, "on", WHERE, { "dual", "primal" }, "dual")
  if K.dimension < 2 then
    options.fail(WHERE, "a mesh of dimension 1 has no curvature: 2 or more is needed")
  end
  local metric = core.one(given.metric, "metric")
  if metric then K = measured_by(K, metric) end
  if not K.measured then
    options.fail(WHERE, "this mesh has no metric: give points or lengths to dm.mesh, or metric = "
      .. "a function that gives a matrix for every top cell")
  end
  if not K.manifold then K:deficits() end -- raises where top cells make no ring or fan
  local frames = core.one(given.frames, "frames")
  local c = setmetatable({ mesh = K, rule = rule, on = on }, Class)
  if on == "primal" then
    if rule ~= "face" then options.fail(WHERE, "rule = \"thesis\" goes with on = \"dual\"") end
    c.way = require "dm.dec.curvature.primal"
    c.way.make(c, frames)
  else
    c.way, c.axes = ways.dual, frames_of(K, frames)
  end
  return c
end)

local function method(name, f, doc) core.method("dm.levi_civita", name, blame.caller(f), doc) end

method("rotation", function(c, i, j) return c.way.rotation(c, i, j) end, [[
A:rotation(i, j) -> dm.matrix, n x n
The rotation that takes vectors from the frame of top cell i to that of its neighbour j, as if both
were unfolded: edges of the common face go to themselves. With on = "primal": from vertex i to
vertex j along their edge. Raises where they are no neighbours.]])
method("angle", function(c) return c.way.angle(c) end, [[
A:angle() -> list of numbers
The curvature of all cells of codimension 2, in their order: on a surface the deficit 2 pi - sum of
angles with its sign, which over a closed surface sums to 2 pi chi; in higher dimensions the angle
of the rotation round the cell, 0 to pi; false at the boundary. With on = "primal": of all
triangles, the angles at which are those of the surface over 2 pi at every inner vertex.]])
method("curvature", function(c, cell) return c.way.curvature(c, cell) end, [[
A:curvature(cell) -> dm.matrix, n x n
The rotation round a cell of codimension 2, in the frame of the top cell round it with the least
number, in the sense of the orientation; on a surface by the deficit. With on = "primal": round a
triangle, in the frame of its first vertex. Raises at the boundary.]])
method("holonomy", function(c, cells)
  local path = path_of(cells, c.way.count(c), "A:holonomy")
  is_closed(path, "A:holonomy")
  return along(c, path)
end, [[
A:holonomy{i, j, ..., i} -> dm.matrix, n x n
The rotation along a closed path of neighbours, top cells (on = "primal": vertices), in the frame of
the first.]])
method("transport", function(c, cells, v)
  local path = path_of(cells, c.way.count(c), "A:transport")
  return along(c, path) * kits.vector(v, c.mesh.dimension, "the vector that is transported")
end, [[
A:transport({i, j, ...}, v) -> dm.vector
The vector v, n numbers in the frame of the first cell, taken in parallel along a path of
neighbours, in the frame of the last. A:frame gives the axes of a frame in space.]])
method("frame", function(c, cell) return c.way.frame(c, cell) end, [[
A:frame(cell) -> dm.matrix
The frame of a top cell of a mesh with points: its axes in space as columns, ambient x n.]])

class.method("dm.mesh", "levi_civita", M.levi_civita, [[
K:levi_civita{frames=, rule=, on=, metric=} -> dm.levi_civita
The discrete Levi-Civita connection of a simplicial manifold of dimension 2 or more (Leok 4.7.3): a
frame in every top cell, a rotation for every dual edge. frames(cell): a rotation (an element of
SO(n); on surfaces an angle will do) of the cell's own frame, which is Cholesky's of its edges.
rule: "face" (default), rotations that keep the common face, or "thesis", the least rotation of one
normal to the other, which is wrong for frames of no common chart [E10]. on = "primal", of oriented
surfaces: frames at vertices, rotations along edges, curvature of triangles. metric(cell): the
matrix e_i . e_j of the edges from the first vertex of a top cell, in place of points or lengths;
faces must agree. Raises where the top cells round a cell of codimension 2 make no loop or fan.]])

return M
