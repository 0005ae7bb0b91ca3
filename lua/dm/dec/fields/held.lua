--- Cells of a field that are fixed: "boundary", a list of numbers, a function of the position.
local core = require "dm.core"
local mass = require "dm.dec.equations.mass"
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
  test = core.one(test, "fixed")
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

---- values without mass ----

--- Marks free values without kinetic energy as massless (2). Returns a list of their numbers.
function M.massless(f, masses)
  local list = {}
  for i = 1, f.n do
    if masses[i] == 0 and not f.held[i] then list[#list + 1], f.fixed[i] = i, 2 end
  end
  if f.sphere and #list > 0 then
    option.fail(WHERE, "massless = \"eliminate\": a unit vector without mass (cell %d) has no "
      .. "equation of its own", (list[1] - 1) // f.values + 1)
  end
  return list
end

-- values at which the structure of L is looked at: of either sign, between 0.1 and 0.9, and small
local RANGES = { { -1, 1 }, { 0.1, 0.9 }, { -1e-3, 1e-3 } }

local function random_values(n, row)
  local random, x, range = core.random(11), core.zeros(n), RANGES[row]
  for i = 1, n do x[i] = range[1] + (range[2] - range[1]) * random:uniform(row, i) end
  return x
end

local ROUND_OFF = 1e-12 -- of the diagonal: entries that are none

-- the place in `list` of what the value at place i meets most
local function partner(own, marks, i)
  local row = core.zeros(#marks)
  row[i] = 1
  local size, at = own:pick(row, nil):transpose():row_sums(), i == 1 and 2 or 1
  for j = 1, #size do if j ~= i and size[j] > size[at] then at = j end end
  return at
end

-- Raises where the Hessian S and the force of one state show that values of `list` cannot follow
-- one by one.
local function check_equations(f, S, force, list, marks)
  local own = S:pick(marks, marks)
  local all, among, diagonal = S:pick(marks, nil):row_sums(), own:row_sums(), own:diagonal()
  local function cell(place)
    local i = (list[place] - 1) // f.values + 1
    return table.concat(f.mesh:simplices(f.degree)[i], ", ")
  end
  for place = 1, #list do
    local mine = math.abs(diagonal[place])
    if among[place] - mine > ROUND_OFF * mine then
      local other = cell(partner(own, core.constant(#list, 1), place))
      option.fail(WHERE, "%s {%s}%s have no kinetic energy and meet in L: they cannot be "
        .. "eliminated one by one; dual = \"barycentric\" of the mesh gives every cell a star",
        other == cell(place) and "two values of the cell" or "the cells", cell(place),
        other == cell(place) and "" or (" and {%s}"):format(other))
    end
    if mine == 0 and (all[place] > 0 or force[list[place]] ~= 0) then
      option.fail(WHERE, "the cell {%s} has no kinetic energy and L is linear in its value: no "
        .. "equation of its own determines it", cell(place))
    end
  end
end

-- Raises where a force acts on a value of `list`, whose equation has L alone; forms act by stars.
local function check_forces(f, list)
  local stars, absorbs = mass.of(f.mesh, f.degree).values, {}
  for _, i in ipairs(f.absorbing and f.absorbing.cells or {}) do absorbs[i] = true end
  for _, at in ipairs(list) do
    local i = (at - 1) // f.values + 1
    if f.force and stars[i] ~= 0 or absorbs[i] then
      option.fail(WHERE, "a force acts on the cell {%s}, which has no kinetic energy and follows "
        .. "from L alone: put the potential of the force into L, or give the cell a mass",
        table.concat(f.mesh:simplices(f.degree)[i], ", "))
    end
  end
end

--- Raises where values without mass meet in L, or L is linear in one. Those that L does not have
-- at all stay where they start: their force is 0.
function M.check_massless(f, system)
  if #f.massless == 0 then return end
  check_forces(f, f.massless)
  local marks = core.constant(f.n, 0)
  for _, i in ipairs(f.massless) do marks[i] = 1 end
  for row = 1, #RANGES do
    local q, t = random_values(f.n, row), 0.37 * row
    local S, force = core.field_hessian(system, q, t), core.field_force(system, q, t)
    local sum = S:row_sums():sum() + force:sum()
    if sum - sum == 0 then check_equations(f, S, force, f.massless, marks) end
  end
end

return M
