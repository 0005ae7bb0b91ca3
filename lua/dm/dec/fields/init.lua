--- K:field: a Lagrangian of a form on a mesh as a system, whose coordinates are the values of the
-- form, cell after cell.
local cell = require "dm.dec.fields.cell"
local class = require "dm.base.class"
local cochain = require "dm.dec.fields.cochain"
local core = require "dm.core"
local forces = require "dm.dec.fields.forces"
local mass = require "dm.dec.equations.mass"
local option = require "dm.base.options"
local start = require "dm.dec.fields.start"
local held = require "dm.dec.fields.held"
local paths = require "dm.dec.fields.path"
require "dm.dec.fields.modes"
require "dm.dec.fields.sum"

local WHERE = "mesh:field"
local KNOWN = { "form", "L", "values", "on", "fixed", "absorbing", "data", "massless", "force",
  "params", "name" }

local function fail(...) option.fail(WHERE, ...) end

---- what is asked for ----

local function degree_of(K, options)
  local k = option.whole(options, "form", WHERE, 0, nil, 0)
  if k > K.dimension then
    fail("option 'form' is the degree of the form, from 0 to %d on this mesh (got %d)",
      K.dimension, k)
  end
  return k
end

-- how many values a cell has; on = dm.S(m): m + 1
local function values_of(options)
  local values = option.whole(options, "values", WHERE, 1)
  local on = options.on
  if on == nil then return values or 1 end
  local name = tostring(on)
  local m = tonumber(name:match "^S%((%d+)%)$")
  if not m then fail("option 'on' must be a sphere, dm.S(2) (got %s)", option.got(on)) end
  if values and values ~= m + 1 then
    fail("option 'values' is %d, and a point of %s has %d", values, name, m + 1)
  end
  return m + 1, m
end

---- the kinetic energy ----

local REMEDY = mass.REMEDY

-- Raises where free cells have no kinetic energy, or a negative one.
local function check_mass(f, masses)
  local zeros, negatives, zero, negative = 0, 0, nil, nil
  for i = 1, f.n do
    local m = masses[i]
    if not f.held[i] and m == 0 and f.fixed[i] == 0 then zeros, zero = zeros + 1, zero or i end
    if not f.held[i] and m < 0 then negatives, negative = negatives + 1, negative or i end
  end
  local function name(i)
    local at = (i - 1) // f.values + 1
    return table.concat(f.mesh:simplices(f.degree)[at], ", ")
  end
  if negatives > 0 then
    fail("the kinetic energy is negative at %d of %d values, the first at the cell {%s}: stars of "
      .. "degree %d are negative there, and every explicit rule is unstable whatever its step; %s",
      negatives, f.n, name(negative), f.degree, REMEDY)
  end
  if zeros > 0 then
    local dual = mass.of(f.mesh, f.degree).zeros > 0
    fail("%d of %d values have no kinetic energy, the first at the cell {%s}%s; massless = "
      .. "\"eliminate\" lets them follow from their own equation, %s", zeros, f.n, name(zero),
      dual and " (zero dual volume)" or "", REMEDY)
  end
end

-- A unit vector of values with different masses would need another equation for its multiplier.
local function check_sphere(f, masses)
  for i = 1, f.n do
    local first = masses[(i - 1) // f.values * f.values + 1]
    if math.abs(masses[i] - first) > 1e-14 * math.abs(first) then
      fail("on a sphere all values of a cell must have one mass (cell %d has %g and %g)",
        (i - 1) // f.values + 1, first, masses[i])
    end
  end
end

---- the system ----

-- L of vectors q, v: nil while it is traced, numbers while it is compared
local function lagrangian(f, L)
  L = option.single(L, WHERE .. ": L")
  return function(q, v, t, params)
    if q and type(q[1]) ~= "number" then
      fail("L of a field stays a loop over cells and is not written out in symbols: what asks for "
        .. "that is not had of a field; solvers, charts, ensembles, modes and limits are")
    end
    local around = { n = f.n, held = f.marks, data = f.data, q = q, v = v,
      sphere = f.sphere and f.values }
    local A = cochain.leaf(f.mesh, f.degree, f.values, 1, around)
    local V = cochain.leaf(f.mesh, f.degree, f.values, 2, around)
    if not q then around.degrees = {} end
    local value = L(A, V, t, params)
    if not q then f.degrees = around.degrees end
    if cochain.is_cochain(value) then
      fail("L must return a number: a:dot(b) is the product of two forms (got a form)")
    end
    if not q then forces.add(f, around, A, V, t, params) end
    return value
  end
end

-- the system, and the mass of every value
local function traced(f)
  local options = f.options
  local system = core.field_system { Q = f.n, L = lagrangian(f, options.L), field = f,
    params = options.params, name = options.name }
  local masses = core.field_masses(system)
  if not masses then
    fail("the kinetic energy must be a sum of m v^2 / 2 over cells with masses that are numbers, "
      .. "as v:dot(v) / 2 is")
  end
  return system, masses
end

-- f.masses: those that L has now, which may have changed with its upvalues; as many as the unknowns
local function with_masses(f, system)
  setmetatable(f, { __index = function(_, key)
    if key == "masses" then return core.field_masses(system) end
  end })
  return system
end

class.method("dm.mesh", "field", function(K, options)
  option.check(options, KNOWN, WHERE)
  local k = degree_of(K, options)
  local values, sphere = values_of(options)
  option.need(options, "L", WHERE, "a function of the form, its rate and t")
  option.callable(options, "L", WHERE, "(A, V, t, params)")
  option.callable(options, "force", WHERE, "(A, V, t, params)")
  cell.check_data(K, options.data, WHERE)
  local f = { mesh = K, degree = k, values = values, sphere = sphere, data = options.data,
    cells = K:count(k), n = values * K:count(k), on = options.on }
  f.held, f.fixed = held.read(f, options.fixed)
  f.marks = core.marks(f.fixed)
  f.absorbing = forces.absorbing(f, options)
  f.force = options.force and option.single(options.force, WHERE .. ": force")
  f.start = function(x, key) return start.read(f, x, key) end
  f.column = function(path, name) return paths.column(f, path, name) end
  f.options = options
  local system, masses = traced(f)
  if option.one_of(options, "massless", WHERE, { "eliminate" }) then
    f.massless = held.massless(f, masses)
    if #f.massless > 0 then
      f.marks = core.marks(f.fixed)
      system, masses = traced(f)
      held.check_massless(f, system)
    end
  end
  check_mass(f, masses)
  if f.sphere then check_sphere(f, masses) end
  f.fixed = nil -- the marks say the same
  return with_masses(f, system)
end, [[
K:field{form=, L=, values=, on=, fixed=, absorbing=, force=, data=, massless=, ...} -> dm.system
A field: a form of degree `form` (0 unless given) that moves by the Lagrangian L(A, V, t, params) of
the form A and its rate V, sums over cells: A:dot(B), A:d(), A:wedge(B), A:map(f), A:star(), K:sum.
The kinetic energy is V:dot(V) / 2 or any sum of m v^2 / 2. values: numbers a cell (default 1); on =
dm.S(m): unit vectors of m + 1 numbers, by rule = "rattle". fixed: cells that stay where they start,
"boundary", a list of their numbers or a function of the position of their centre that is true
there; other boundaries are natural (free). absorbing: boundary cells, named like those of fixed or
{ "boundary", c = 2 }, that let waves of speed c (default 1) out: the force -c V with the star of
the boundary, exact for waves that come at a right angle, up to (cos a - 1)/(cos a + 1) for those at
the angle a; facets all of whose cells are named absorb. force(A, V, t, params): a form f beside L,
whose virtual work is f:dot(dA) (friction -g * V, driving cos(t) * J), a list of one for every
value, or a list of numbers that are added to dL/dq; it reads A and V on the cell itself. Forces of
V are stepped by verlet, rattle, rules of stages and explicit Runge-Kutta, others by every splitting
too. massless =
"eliminate": values without kinetic energy, as on cells whose star is 0, follow from their own
equation, one by one (two that meet in L are refused), by kicks and drifts; one that L does not have
at all stays where it starts. So grids, and cubes cut into tetrahedra, have Yee's scheme. data =
{ name = form }: numbers by name in the cells of K:sum. A field is a system: it has solvers, charts,
ensembles and checkpoints; q, v and p of a start are forms, functions of the position, lists, or
of several values a list or matrix with a row for every cell, as K:points();
path:form(i) is row i as a form, path.q[i] its values, cell after cell; p = dL/dV. Columns "energy"
and "gauss" (the largest change of d^T p at free cells, where L has A only in dA). Raises where free
cells have no kinetic energy, or a negative one.]])

return {}
