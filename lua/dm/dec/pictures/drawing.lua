--- What is drawn of a mesh, a form or a field of vectors: points, faces with a number each, edges
-- with a number each, arrows, edges of the dual cells. Of a mesh of dimension 3 the boundary is
-- drawn.
local form = require "dm.dec.form"
local option = require "dm.base.options"

local M = {}

local function fail(...) option.fail("plot of a mesh", ...) end

-- points with x, y, z
local function points_of(K)
  if (K.ambient or 0) == 0 then
    fail("this mesh has no points to draw; give points = to dm.mesh")
  end
  if K.ambient > 3 then fail("points of %d coordinates cannot be drawn", K.ambient) end
  local out, points = {}, K:points()
  for i = 1, K:count(0) do
    local p = points[i]:totable()
    out[i] = { p[1], p[2] or 0, p[3] or 0 }
  end
  return out
end

-- the cells of degree 2 that are seen, by number
local function seen_faces(K)
  local out = {}
  if K.dimension < 2 then return out end
  for i = 1, K:count(2) do
    if K.dimension == 2 or #K:cofaces(2, i) == 1 then out[#out + 1] = i end
  end
  return out
end

-- edges of the faces that are seen, or all of a curve
local function seen_edges(K, faces)
  local out, seen = {}, {}
  if K.dimension == 1 then
    for i = 1, K:count(1) do out[i] = i end
    return out
  end
  for _, face in ipairs(faces) do
    for _, edge in ipairs(K:faces(2, face)) do
      if not seen[edge] then
        seen[edge] = true
        out[#out + 1] = edge
      end
    end
  end
  table.sort(out)
  return out
end

local function vertices_of(simplices, cells)
  local out = {}
  for i, cell in ipairs(cells) do out[i] = simplices[cell] end
  return out
end

-- six times the signed volume of a tetrahedron
local function volume(a, b, c, d)
  local x, y, z = {}, {}, {}
  for k = 1, 3 do x[k], y[k], z[k] = b[k] - a[k], c[k] - a[k], d[k] - a[k] end
  return x[1] * (y[2] * z[3] - y[3] * z[2]) + x[2] * (y[3] * z[1] - y[1] * z[3])
    + x[3] * (y[1] * z[2] - y[2] * z[1])
end

-- the vertices of a face in the boundary of a body, anticlockwise as seen from outside
local function outward(K, points, face, cell)
  local a, b, c = table.unpack(cell)
  local body, other = K:simplices(3)[K:cofaces(2, face)[1]], nil
  for _, v in ipairs(body) do if v ~= a and v ~= b and v ~= c then other = v end end
  if volume(points[a], points[b], points[c], points[other]) > 0 then b, c = c, b end
  return { a, b, c }
end

--- Is a face of a body turned away, by its corners in the picture, { across, up } each? Its other
-- side, which is inside, is not seen.
function M.is_turned_away(d, p, q, r)
  return d.solid and (q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1]) < 0
end

--- The mesh alone; solid: of a body, whose faces are anticlockwise as seen from outside.
function M.mesh(K)
  if K.dimension > 3 then fail("meshes of dimension %d cannot be drawn", K.dimension) end
  local faces = seen_faces(K)
  local edges, d = seen_edges(K, faces), nil
  d = { dim = K.ambient == 3 and 3 or 2, points = points_of(K), arrows = {}, dual = {},
    face_cells = faces, edge_cells = edges,
    faces = #faces > 0 and vertices_of(K:simplices(2), faces) or {},
    edges = vertices_of(K:simplices(1), edges) }
  if K.dimension == 3 then
    d.solid = true
    for i, cell in ipairs(d.faces) do d.faces[i] = outward(K, d.points, faces[i], cell) end
  end
  return d
end

---- forms ----

-- a number for each vertex -> means over faces, or over edges of a curve
local function by_vertices(d, values, name)
  local list, out = #d.faces > 0 and d.faces or d.edges, {}
  for i, cell in ipairs(list) do
    local sum = 0
    for _, v in ipairs(cell) do sum = sum + values[v] end
    out[i] = sum / #cell
  end
  d.values, d.on, d.name = out, #d.faces > 0 and "faces" or "edges", name
end

-- a number for each cell of degree k -> those that are seen
local function by_cells(d, cells, values, on, name)
  local out = {}
  for i, cell in ipairs(cells) do out[i] = values[cell] end
  d.values, d.on, d.name = out, on, name
end

-- values of degree k per volume of their cells
local function densities(K, k, values)
  local out, volume = {}, K:volume(k)
  for i = 1, #values do out[i] = values[i] / volume[i] end
  return out
end

local function by_edges(d, K, a)
  by_cells(d, d.edge_cells, densities(K, 1, a.values), "edges", "per length")
end

--- Vectors at vertices or top cells, as arrows whose largest is as long as an edge at the median.
function M.arrows(d, X)
  local K, largest = X.mesh, 0
  local cells, lengths = X.on == "cells" and K:simplices(K.dimension), K:volume(1):totable()
  table.sort(lengths)
  for i = 1, #X do
    local sum = 0
    for _, x in ipairs(X[i]) do sum = sum + x * x end
    largest = math.max(largest, sum ^ 0.5)
  end
  local scale = largest > 0 and lengths[(#lengths + 1) // 2] / largest or 0
  for i = 1, #X do
    local at, x = { 0, 0, 0 }, X[i]
    for _, v in ipairs(cells and cells[i] or { i }) do
      for c = 1, 3 do at[c] = at[c] + d.points[v][c] / (cells and #cells[i] or 1) end
    end
    d.arrows[i] = { at, { scale * x[1], scale * (x[2] or 0), scale * (x[3] or 0) } }
  end
  d.arrow_note = ("longest arrow: %.4g"):format(largest)
  return d
end

--- The numbers of a form on what is drawn of its mesh: { values, on, name }, without arrows. Dual
-- 1-forms have vectors alone, so they are refused.
function M.values(d, a)
  local K, n = a.mesh, a.mesh.dimension
  local out = setmetatable({}, { __index = d })
  if a.side == "dual" then a = a:star() end
  if a.degree == 0 then by_vertices(out, a.values, "value")
  elseif a.degree == 1 then by_edges(out, K, a)
  elseif a.degree == 2 then
    local values = n == 2 and K:oriented(a.values) or a.values
    by_cells(out, d.face_cells, densities(K, 2, values), "faces", "per area")
  else fail("a %s has no values on the boundary, which is what is drawn", form.name(a)) end
  return out
end

--- The mesh with a form on it.
function M.form(a)
  local K, n = a.mesh, a.mesh.dimension
  local d = M.mesh(K)
  if a.side == "dual" and (a.degree == 0 or a.degree == n) then a = a:star() end
  if a.side == "dual" and a.degree == 1 and n > 1 then return M.arrows(d, a:sharp()) end
  if a.side == "dual" then fail("a %s cannot be drawn; its star can", form.name(a)) end
  if a.degree == 0 then by_vertices(d, a.values, "value")
  elseif a.degree == 1 and n > 1 then
    by_edges(d, K, a)
    M.arrows(d, a:sharp { to = "cells" })
  elseif a.degree == 1 then by_edges(d, K, a)
  elseif a.degree == 2 and n == 2 then
    by_cells(d, d.face_cells, densities(K, 2, K:oriented(a.values)), "faces", "per area")
  elseif a.degree == 2 then
    by_cells(d, d.face_cells, densities(K, 2, a.values), "faces", "per area")
  else fail("a %s has no values on the boundary, which is what is drawn", form.name(a)) end
  return d
end

---- dual cells ----

-- from the centre of every cell of degree n - 1 to those of its top cells, of plane meshes
function M.add_dual(d, K)
  if K.dimension ~= 2 then fail("dual cells are drawn of surfaces") end
  local top, sides = K:circumcentres(2), K:circumcentres(1)
  for edge = 1, K:count(1) do
    for _, face in ipairs(K:cofaces(1, edge)) do
      local p, q = sides[edge], top[face]
      d.dual[#d.dual + 1] = { { p[1], p[2] or 0, p[3] or 0 }, { q[1], q[2] or 0, q[3] or 0 } }
    end
  end
  return d
end

return M
