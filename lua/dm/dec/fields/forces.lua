--- Forces on a field beside those of its Lagrangian: `force`, and `absorbing` for boundaries that
-- let waves out. Both become sums over cells of their virtual work.
local blame = require "dm.base.blame"
local cell_of = require "dm.dec.fields.cell"
local cochain = require "dm.dec.fields.cochain"
local core = require "dm.core"
local form = require "dm.dec.form"
local held = require "dm.dec.fields.held"
local mass = require "dm.dec.equations.mass"
local option = require "dm.base.options"
local parts = require "dm.dec.parts"

local M = {}

local WHERE = "mesh:field"
local V, VARIED = 2, 3 -- sources of columns (core.cell_sum)

local function fail(...) option.fail(WHERE, ...) end

-- a sum of virtual work over `cells` cells, of a term of columns
local function add(f, around, cells, term)
  core.cell_sum(cells, around.n, term, around.held, nil, nil, around.sphere, true)
end

---- force = function(A, V, t, params) ----

-- its values on a cell, of a form, a list of forms (one for every value), or a list of numbers
local function reader(f, F, like)
  if cochain.is_cochain(F) or form.is_form(F) then
    local a = cochain.lifted(F, like, "option 'force'")
    if a.degree ~= f.degree or a.side ~= "primal" then
      fail("option 'force' must return a primal %d-form (got a %s %d-form)", f.degree, a.side,
        a.degree)
    end
    return function(cell, c)
      local x = a.at(cell, cell.all)
      if #x ~= f.values then
        fail("option 'force' must return a form of %d values a cell (got %d), or a list of %d "
          .. "forms", f.values, #x, f.values)
      end
      return cell.star * x[c]
    end
  end
  local size = (type(F) == "table" or type(F) == "userdata") and #F
  if size == f.values and size > 0 and (cochain.is_cochain(F[1]) or form.is_form(F[1])) then
    local each = {}
    for c = 1, size do
      each[c] = reader({ degree = f.degree, values = 1 }, F[c], like)
    end
    return function(cell, c) return each[c](cell, 1) end
  end
  local fine, list = blame.try(core.vector, F)
  if not fine or #list ~= f.n or type(list[1]) ~= "number" then
    fail("option 'force' must return a form, a list of %d forms, or a list of %d numbers that are "
      .. "added to dL/dq (got %s); a force at some cells that depends on t is a form of numbers "
      .. "times a function of t", f.values, f.n, option.got(F))
  end
  if f.massless and #f.massless > 0 then
    fail("a list of forces is not for fields with values that have no mass: give a form")
  end
  return function(cell, c) return cell_of.column(cell, list, f.values, 0, cell.all)[c] end
end

local function add_force(f, around, A, rate, t, params)
  local value = reader(f, f.force(A, rate, t, params), A)
  add(f, around, f.cells, function(column)
    local cell, sum = cell_of.new(f.mesh, f.degree, column, f.data), 0
    local varied = cell_of.column(cell, VARIED, f.values, 0, cell.all)
    for c = 1, f.values do sum = sum + value(cell, c) * varied[c] end
    return sum
  end)
end

---- absorbing ----

-- -c |*s| / |s| V, the star that of the boundary
local function add_absorbing(f, around)
  local list = f.absorbing
  add(f, around, #list.cells, function(column)
    local weight, sum = column(list.weights, 0, 1, nil, true), 0
    for c = 1, f.values do
      sum = sum - weight * column(V, c - 1, f.values, list.table)
        * column(VARIED, c - 1, f.values, list.table)
    end
    return sum
  end)
end

-- facets of the boundary all of whose faces of the field's degree are among `cells`
local function facets_of(f, cells)
  local K, out = f.mesh, {}
  local n, all = K.dimension - 1, K:simplices(K.dimension - 1)
  for _, i in ipairs(K:boundary_cells(n)) do
    local whole = true
    for _, set in ipairs(cell_of.faces_of(n, f.degree + 1)) do
      local face = {}
      for j = 0, n do if set >> j & 1 == 1 then face[#face + 1] = all[i][j + 1] end end
      whole = whole and cells[n == f.degree and i or #face == 1 and face[1] or K:find(face)]
    end
    if whole then out[#out + 1] = all[i] end
  end
  return out
end

-- stars of the boundary by the number of the cell in the mesh
local function stars_of(f, facets)
  local K, weights = f.mesh, {}
  if K.dimension == 1 then
    for _, s in ipairs(facets) do weights[s[1]] = 1 end
    return weights
  end
  local boundary, vertices = parts.part(K, facets)
  local stars = mass.of(boundary, f.degree)
  for i, s in ipairs(boundary:simplices(f.degree)) do
    local cell = {}
    for j, v in ipairs(s) do cell[j] = vertices[v] end
    if stars.values[i] < 0 then
      fail("the star of the boundary is negative at the cell {%s}: it would feed waves instead of "
        .. "letting them out; dual = \"barycentric\" gives other duals", table.concat(cell, ", "))
    end
    weights[#cell == 1 and cell[1] or K:find(cell)] = stars.values[i]
  end
  return weights
end

-- what the option names, and c
local function asked(options)
  local given, c = options.absorbing, 1
  if type(given) == "table" and given.c ~= nil then
    c = option.positive(given, "c", WHERE .. ": absorbing", "a speed")
    for key in pairs(given) do
      if math.type(key) ~= "integer" and key ~= "c" then
        fail("option 'absorbing' is a table of cells and c (got '%s')", tostring(key))
      end
    end
    if type(given[1]) ~= "number" then
      if #given > 1 then fail("option 'absorbing' has one selection of cells, and c") end
      given = given[1] or "boundary"
    end
  end
  return given, c
end

--- The cells of the boundary that absorb: { cells, weights = c |*s| / |s|, table }, or nothing.
function M.absorbing(f, options)
  if options.absorbing == nil then return nil end
  local given, c = asked(options)
  if f.degree == f.mesh.dimension then
    fail("a form of degree %d has no values on the boundary: nothing there can absorb", f.degree)
  end
  local cells = held.cells(f, given, "absorbing")
  local facets = facets_of(f, cells)
  if #facets == 0 then
    fail("option 'absorbing' names no facet of the boundary with all its cells of degree %d%s",
      f.degree, #f.mesh:boundary_cells(f.mesh.dimension - 1) == 0
      and ": the mesh is closed" or "")
  end
  local list, weights = {}, {}
  for i, weight in pairs(stars_of(f, facets)) do
    if weight > 0 then list[#list + 1] = i end
    weights[i] = c * weight
  end
  table.sort(list)
  local own = core.constant(#list, 0)
  for j, i in ipairs(list) do own[j] = weights[i] end
  return { cells = list, weights = own, table = core.cell_list(core.vector(list)) }
end

--- Adds the virtual work of all forces to the trace that is going on.
function M.add(f, around, A, rate, t, params)
  if f.force then add_force(f, around, A, rate, t, params) end
  if f.absorbing and #f.absorbing.cells > 0 then add_absorbing(f, around) end
end

return M
