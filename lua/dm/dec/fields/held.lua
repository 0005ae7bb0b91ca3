--- Cells of a field that are fixed: "boundary", a list of numbers, a function of the position.
local cell_of = require "dm.dec.fields.cell"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local WHERE = "mesh:field"
local WHAT = "\"boundary\", a list of cell numbers, or a function of the position of their centre"

-- the mean of the vertices of every cell
local function centres(K, degree)
  local points, out = K:points(), {}
  for i, cell in ipairs(K:simplices(degree)) do
    local sum = {}
    for _, vertex in ipairs(cell) do
      local p = points[vertex]
      for c = 1, #p do sum[c] = (sum[c] or 0) + p[c] / #cell end
    end
    out[i] = sum
  end
  return out
end
M.centres = centres

local function from_list(f, list, marked)
  for j, i in ipairs(list) do
    if math.type(i) ~= "integer" or i < 1 or i > f.cells then
      option.fail(WHERE, "option 'fixed'[%d] must be the number of a cell of degree %d, from 1 to "
        .. "%d (got %s)", j, f.degree, f.cells, option.got(i))
    end
    marked[i] = true
  end
end

local function from_function(f, test, marked)
  for i, p in ipairs(centres(f.mesh, f.degree)) do
    if test(table.unpack(p)) then marked[i] = true end
  end
end

--- The cells that an option names: a set of their numbers.
function M.cells(f, fixed, key)
  local marked = {}
  if fixed == nil then return marked end
  if fixed == "boundary" then
    local marks = f.mesh:boundary_marks(f.degree)
    for i = 1, #marks do if marks[i] ~= 0 then marked[i] = true end end
  elseif type(fixed) == "table" then
    from_list(f, fixed, marked)
  elseif type(fixed) == "function" then
    from_function(f, fixed, marked)
  else
    option.fail(WHERE, "option '%s' must be %s (got %s)", key, WHAT, option.got(fixed))
  end
  return marked
end

--- Entry by entry: a set of those that are held, and a vector of marks.
function M.read(f, fixed)
  local entries, marks = {}, core.constant(f.n, 0)
  for i in pairs(M.cells(f, fixed, "fixed")) do
    for c = 1, f.values do
      local at = (i - 1) * f.values + c
      entries[at], marks[at] = true, 1
    end
  end
  return entries, marks
end

--- Marks the values on free cells whose star is 0 as massless (2); no two of them may meet in a
-- top cell. Returns a list of their numbers.
function M.massless(f, stars)
  local list, met = {}, {}
  for i = 1, f.cells do
    if stars[i] == 0 then
      for c = 1, f.values do
        local at = (i - 1) * f.values + c
        if not f.held[at] then
          list[#list + 1], f.fixed[at] = at, 2
          met[i] = true
        end
      end
    end
  end
  if f.values > 1 and #list > 0 then
    option.fail(WHERE, "massless = \"eliminate\" is for one value a cell")
  end
  local all = core.cell_faces
  for _, set in ipairs(cell_of.faces_of(f.mesh.dimension, f.degree + 1)) do
    M.met(f, met, all(f.mesh, f.mesh.dimension, set))
  end
  f.meeting = nil
  return list
end

-- counts massless faces of top cells
function M.met(f, met, faces)
  f.meeting = f.meeting or {}
  for i = 1, f.mesh:count(f.mesh.dimension) do
    if met[faces[i]] then
      f.meeting[i] = (f.meeting[i] or 0) + 1
      if f.meeting[i] > 1 then
        option.fail(WHERE, "two cells without kinetic energy meet in cell %d of degree %d: they "
          .. "cannot be eliminated one by one; dual = \"barycentric\" of the mesh gives every cell "
          .. "a star", i, f.mesh.dimension)
      end
    end
  end
end

return M
