--- What the function of a sum over cells sees of a cell: values of cochains on its faces, its
-- volume, star, lengths, points, and data by name. Every number that is asked for becomes a column
-- of the sum (core.cell_sum), once; a set of vertices of the cell is a number whose bit j stands
-- for its vertex j, so faces are ascending as cells are.
local core = require "dm.core"
local form = require "dm.dec.form"
local mass = require "dm.dec.equations.mass"
local option = require "dm.base.options"

local M = {}

local tables = setmetatable({}, { __mode = "k" }) -- mesh -> degree -> set -> core.cell_faces
local numbers = setmetatable({}, { __mode = "k" }) -- mesh -> name and degree -> vector

local function kept(all, K, key, make)
  local own = all[K] or {}
  all[K] = own
  if own[key] == nil then own[key] = make() end
  return own[key]
end

-- the faces with these vertices of all cells of a degree; nil: the cells themselves
local function faces(K, degree, set)
  if set == (2 << degree) - 1 then return nil end
  return kept(tables, K, degree << 16 | set, function() return core.cell_faces(K, degree, set) end)
end

--- How many vertices a set has.
function M.size(set)
  local count = 0
  while set ~= 0 do set, count = set & (set - 1), count + 1 end
  return count
end
local size = M.size

local subsets = {} -- by the number of vertices of the cell and of the face

--- The sets of m among the vertices 0 .. k, in the order of the faces.
function M.faces_of(k, m)
  local key = k << 8 | m
  if subsets[key] then return subsets[key] end
  local out = {}
  local function add(set, from, left)
    if left == 0 then
      out[#out + 1] = set
      return
    end
    for j = from, k + 1 - left do add(set | 1 << j, j + 1, left - 1) end
  end
  add(0, 0, m)
  subsets[key] = out
  return out
end
local faces_of = M.faces_of

local Cell = {}

---- columns ----

-- entries c = 1 .. width of source (1: q, 2: v, or a vector) on the face `set`; stays: the vector
-- is kept, and never changed
local function column(cell, source, width, offset, set, stays)
  local made = rawget(cell, "made")
  local own = made[source] or {}
  made[source] = own
  local key = offset << 16 | set
  if own[key] then return own[key] end
  local list, at = {}, faces(cell.mesh, cell.degree, set)
  for c = 1, width do list[c] = cell.column(source, offset + c - 1, width, at, stays) end
  own[key] = list
  return list
end
M.column = column

--- A cell of a mesh, whose columns are made by column(source, first, step, table).
function M.new(K, degree, column_of, data)
  return setmetatable({ mesh = K, degree = degree, column = column_of, data = data, made = {},
    all = (2 << degree) - 1 }, Cell)
end

---- its geometry ----

local function weight(K, degree, name)
  return kept(numbers, K, name .. degree, function()
    if name == "star" then return mass.of(K, degree).values end
    return K:volume(degree)
  end)
end

-- one number of a face
function M.measure(cell, name, set)
  return column(cell, weight(cell.mesh, size(set) - 1, name), 1, 0, set, true)[1]
end

local function points(K)
  return kept(numbers, K, "points", function()
    local matrix = K:points()
    return { core.entries(matrix), #matrix[1] }
  end)
end

local made = {}

function made.volume(cell) return M.measure(cell, "volume", cell.all) end
function made.star(cell) return M.measure(cell, "star", cell.all) end

function made.lengths(cell)
  local list = {}
  for i, set in ipairs(faces_of(cell.degree, 2)) do list[i] = M.measure(cell, "volume", set) end
  return core.vector(list)
end

function made.points(cell)
  local all, list = points(cell.mesh), {}
  for j = 0, cell.degree do
    list[j + 1] = core.vector(column(cell, all[1], all[2], 0, 1 << j, true))
  end
  return list
end

--- Raises where the option `data` is no table of primal forms of this mesh by names that cells do
-- not have of their own.
function M.check_data(K, data, where)
  if data == nil then return end
  if type(data) ~= "table" then
    option.fail(where, "option 'data' must be a table name -> form (got %s)", option.got(data))
  end
  for name, a in pairs(data) do
    if not form.is_form(a) or not rawequal(a.mesh, K) or a.side ~= "primal" then
      option.fail(where, "data '%s' must be a primal form of this mesh (got %s)", tostring(name),
        option.got(a))
    end
    if made[name] then
      option.fail(where, "data '%s': every cell has a '%s' of its own, which K:sum would see in "
        .. "its place; give it another name", name, name)
    end
  end
end

--- What the user's function gets of values on all faces of a degree: a number where it is that of
-- the cell, else a vector, or a list of vectors where there are several values.
function M.shown(cell, degree, at)
  local list, single = {}, true
  for i, set in ipairs(faces_of(cell.degree, degree + 1)) do
    local values = at(cell, set)
    single = #values == 1
    list[i] = single and values[1] or core.vector(values)
  end
  if degree == cell.degree then return list[1] end
  return single and core.vector(list) or list
end

-- the values of a form of numbers
local function datum(cell, a, name)
  if not form.is_form(a) or a.side ~= "primal" then
    option.fail("K:sum", "data '%s' must be a primal form of the mesh (got %s)", name,
      option.got(a))
  end
  if a.degree > cell.degree then
    option.fail("K:sum", "data '%s' is a %d-form, and a cell of degree %d has no such face", name,
      a.degree, cell.degree)
  end
  return M.shown(cell, a.degree, function(c, set) return column(c, a.values, 1, 0, set) end)
end

function Cell.__index(cell, key)
  local make, data = made[key], rawget(cell, "data")
  local value
  if make then
    value = make(cell)
  elseif data and data[key] ~= nil then
    value = datum(cell, data[key], key)
  else
    local names = {}
    for name in pairs(data or {}) do names[#names + 1] = name end
    table.sort(names)
    option.fail("K:sum", "a cell has no '%s': it has volume, star, lengths, points%s%s",
      tostring(key), #names > 0 and " and, as data, " or "", table.concat(names, ", "))
  end
  rawset(cell, key, value)
  return value
end

return M
