--- K:save: meshes into files, to the last bit.
local class = require "dm.base.class"
local form = require "dm.dec.form"
local option = require "dm.base.options"
local text_file = require "dm.base.text_file"

local M = {}

local WHERE = "mesh:save"

local function fail(...) option.fail(WHERE, ...) end

-- points with three coordinates, a line each
local function point_lines(K, before)
  if (K.ambient or 0) == 0 then fail("this mesh has no points") end
  if K.ambient > 3 then fail("points of %d coordinates fit in no such file", K.ambient) end
  local out, points = {}, K:points()
  for i = 1, K:count(0) do
    local p = points[i]:totable()
    out[i] = ("%s%.17g %.17g %.17g"):format(before, p[1], p[2] or 0, p[3] or 0)
  end
  return out
end

-- top cells with their vertices in the coherent orientation, where there is one
local function oriented(K)
  local cells, signs = K:simplices(K.dimension), K:orientation()
  for i, cell in ipairs(cells) do
    local n = #cell
    if signs and signs[i] < 0 and n > 1 then cell[n - 1], cell[n] = cell[n], cell[n - 1] end
  end
  return cells
end

-- top cells, and cells of lower degree that are faces of none
local function maximal(K)
  local cells = oriented(K)
  for k = K.dimension - 1, K.pure and K.dimension or 1, -1 do
    for i, cell in ipairs(K:simplices(k)) do
      if #K:cofaces(k, i) == 0 then cells[#cells + 1] = cell end
    end
  end
  return cells
end

local function need_surface(K, format)
  if K.dimension > 2 then
    fail("%s files hold surfaces and lines; a mesh of dimension %d goes into .vtk", format,
      K.dimension)
  end
end

local writers = {}

function writers.off(K)
  need_surface(K, ".off")
  local cells = maximal(K)
  local lines = { "OFF", ("%d %d 0"):format(K:count(0), #cells) }
  table.move(point_lines(K, ""), 1, K:count(0), 3, lines)
  for _, cell in ipairs(cells) do
    local ids = {}
    for j, v in ipairs(cell) do ids[j] = v - 1 end
    lines[#lines + 1] = #cell .. " " .. table.concat(ids, " ")
  end
  return lines
end

function writers.obj(K)
  need_surface(K, ".obj")
  local lines = point_lines(K, "v ")
  for _, cell in ipairs(maximal(K)) do
    lines[#lines + 1] = (#cell == 3 and "f " or "l ") .. table.concat(cell, " ")
  end
  return lines
end

---- vtk ----

local TYPES = { 3, 5, 10 } -- line, triangle, tetrahedron

local function add_numbers(lines, name, values)
  lines[#lines + 1] = ("SCALARS %s double 1"):format(name)
  lines[#lines + 1] = "LOOKUP_TABLE default"
  for i = 1, #values do lines[#lines + 1] = ("%.17g"):format(values[i]) end
end

local function add_vectors(lines, name, X)
  lines[#lines + 1] = ("VECTORS %s double"):format(name)
  for i = 1, #X do
    local v = X[i]
    lines[#lines + 1] = ("%.17g %.17g %.17g"):format(v[1], v[2] or 0, v[3] or 0)
  end
end

-- A form of degree 2 in space as vectors, those of its Whitney form at the centres c of cells: with
-- the flux a_F through the face without vertex o, outwards, sum a_F (c - o) / (3 |cell|).
local function flux_vectors(K, a)
  local points, volumes, out = K:points(), K:volume(3), {}
  for i, cell in ipairs(K:simplices(3)) do
    local x = {}
    for j, v in ipairs(cell) do x[j] = points[v] end
    local centre, sum = (x[1] + x[2] + x[3] + x[4]) / 4, 0 * x[1]
    for j, v in ipairs(cell) do
      local face = { table.unpack(cell) }
      table.remove(face, j)
      local p, q, r = points[face[1]], points[face[2]], points[face[3]]
      local is_outward = (q - p):cross(r - p):dot(p - points[v]) > 0
      sum = sum + (is_outward and 1 or -1) * a.values[K:find(face)] * (centre - points[v])
    end
    out[i] = sum / (3 * volumes[i])
  end
  return out
end

-- forms of degree 0 at points, of degree n as densities of cells, others of degree 1 and of degree
-- 2 in space as vectors
local function split(K, forms)
  local at_points, at_cells = {}, {}
  for name, a in pairs(forms) do
    if not form.is_form(a) or not rawequal(a.mesh, K) then
      fail("option 'forms': '%s' must be a form of this mesh (got %s)", tostring(name),
        option.got(a))
    end
    if type(name) ~= "string" or not name:find "^[%w_]+$" then
      fail("option 'forms': names are of letters, digits and _ (got %s)", option.got(name))
    end
    local is_primal = a.side == "primal"
    if is_primal and a.degree == 0 then at_points[#at_points + 1] = { name, a.values }
    elseif is_primal and a.degree == K.dimension then
      at_cells[#at_cells + 1] = { name, a:star().values }
    elseif is_primal and a.degree == 1 then
      at_cells[#at_cells + 1] = { name, a:sharp { to = "cells" }, vectors = true }
    elseif is_primal and a.degree == 2 and K.dimension == 3 then
      at_cells[#at_cells + 1] = { name, flux_vectors(K, a), vectors = true }
    elseif not is_primal and a.degree == 0 then at_cells[#at_cells + 1] = { name, a.values }
    else
      fail("option 'forms': '%s' is a %s; .vtk takes primal ones, and dual ones of "
        .. "degree 0", name, form.name(a))
    end
  end
  local function by_name(x, y) return x[1] < y[1] end
  table.sort(at_points, by_name)
  table.sort(at_cells, by_name)
  return at_points, at_cells
end

function writers.vtk(K, forms)
  if K.dimension > 3 then fail(".vtk files hold meshes of dimension 1 to 3") end
  local cells, size = maximal(K), 0
  local at_points, at_cells = split(K, forms)
  if #at_cells > 0 and not K.pure then
    fail("option 'forms': '%s' has values on top cells alone, and this mesh has cells of lower "
      .. "degree that are faces of none", at_cells[1][1])
  end
  for _, cell in ipairs(cells) do size = size + #cell + 1 end
  local lines = { "# vtk DataFile Version 3.0", "mesh", "ASCII", "DATASET UNSTRUCTURED_GRID",
    ("POINTS %d double"):format(K:count(0)) }
  table.move(point_lines(K, ""), 1, K:count(0), #lines + 1, lines)
  lines[#lines + 1] = ("CELLS %d %d"):format(#cells, size)
  for _, cell in ipairs(cells) do
    local ids = {}
    for j, v in ipairs(cell) do ids[j] = v - 1 end
    lines[#lines + 1] = #cell .. " " .. table.concat(ids, " ")
  end
  lines[#lines + 1] = "CELL_TYPES " .. #cells
  for _, cell in ipairs(cells) do lines[#lines + 1] = tostring(TYPES[#cell - 1]) end
  for _, data in ipairs { { "POINT_DATA", K:count(0), at_points }, { "CELL_DATA", #cells,
    at_cells } } do
    if #data[3] > 0 then lines[#lines + 1] = data[1] .. " " .. data[2] end
    for _, entry in ipairs(data[3]) do
      (entry.vectors and add_vectors or add_numbers)(lines, entry[1], entry[2])
    end
  end
  return lines
end

class.method("dm.mesh", "save", function(K, file, options)
  if type(file) ~= "string" then fail("a file name is needed (got %s)", option.got(file)) end
  options = option.check(options or {}, { "forms" }, WHERE)
  local extension = (file:match "%.(%w+)$" or ""):lower()
  local writer = writers[extension]
  if not writer then fail("%s: a mesh is saved as .off, .obj or .vtk", file) end
  if options.forms ~= nil and extension ~= "vtk" then fail("forms go into .vtk files") end
  if options.forms ~= nil and type(options.forms) ~= "table" then
    fail("option 'forms' must be a table { name = form } (got %s)", option.got(options.forms))
  end
  return text_file.write(file, table.concat(writer(K, options.forms or {}), "\n") .. "\n", WHERE)
end, [[
K:save(file, {forms=}) -> file name
The mesh as .off or .obj (surfaces and lines, read back with the same bits) or .vtk (dimension 1 to
3) with forms = {name = form}: those of degree 0 at the points, those of the highest degree as
densities, others of degree 1, and of degree 2 in space (those that flow through the faces), as
vectors in the cells. Cells are written in their coherent orientation, and behind them those of
lower degree that are faces of none.]])

return M
