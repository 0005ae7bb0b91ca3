--- Poisson's equation delta d u = f of functions: d^T M_1 d u = M_0 f + flux, the load lumped at
-- the vertices. What is fixed goes to the right; components of the mesh where nothing is fixed have
-- a solution only for a load without mean, and it is known up to a constant.
local class = require "dm.base.class"
local core = require "dm.core"
local loose = require "dm.dec.equations.loose"
local mass = require "dm.dec.equations.mass"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local sample = require "dm.dec.equations.sample"
local solver = require "dm.dec.equations.solver"

local M = {}

local WHERE = "mesh:poisson"
local KNOWN = { "f", "fixed", "flux", "solver" }

local function fail(...) option.fail(WHERE, ...) end

---- what is fixed ----

-- values at the fixed vertices, 0 elsewhere; marks of the free ones; a key that tells which are
-- fixed
local function fixed_values(K, fixed)
  local count = K:count(0)
  local u, keep, key = core.vector(count), mass.ones(K, 0), {}
  if type(fixed) ~= "table" then
    fail("fixed must be a table { boundary =, [vertex] = } (got %s)", option.got(fixed))
  end
  local function set(i, x) u[i], keep[i] = x, 0 end
  if fixed.boundary ~= nil then
    local marks = K:boundary_marks(0)
    local values = sample.values(fixed.boundary, K, operator.primal(0), count,
      function() return K:points() end, WHERE, "fixed.boundary")
    for i = 1, count do
      if marks[i] ~= 0 then set(i, values[i]) end
    end
    key[1] = "boundary"
  end
  local single = {}
  for i, x in pairs(fixed) do
    if i ~= "boundary" then
      if math.type(i) ~= "integer" or i < 1 or i > count then
        fail("fixed: there is no vertex %s", option.got(i))
      end
      if type(x) ~= "number" or x - x ~= 0 then
        fail("fixed[%d] must be a finite number (got %s)", i, option.got(x))
      end
      set(i, x)
      single[#single + 1] = i
    end
  end
  table.sort(single)
  return u, keep, table.concat(key) .. " " .. table.concat(single, " ")
end

---- components without a fixed vertex ----

-- lists of vertices of such components; false where it is the whole mesh, which goes by vectors
local function floating(K, keep)
  local _, count = K:component_of()
  local function is_held(i) return keep[i] == 0 end
  if count > 1 then return loose.lists(K, #keep, function(i) return i end, is_held) end
  for i = 1, #keep do
    if is_held(i) then return {} end
  end
  return { false }
end

-- the sum of x over a component
local function total(x, vertices)
  if not vertices then return x:dot(core.constant(#x, 1)) end
  local sum = 0
  for _, i in ipairs(vertices) do sum = sum + x[i] end
  return sum
end

-- x - factor y on a component
local function less(x, factor, y, vertices)
  if not vertices then return x - factor * y end
  for _, i in ipairs(vertices) do x[i] = x[i] - factor * y[i] end
  return x
end

---- the system ----

-- densities of the flux through the boundary, at the centres of its facets, as a load of vertices
local function flux_load(K, flux)
  local k = K.dimension - 1
  local density, out = sample.on_facets(K, flux, WHERE, "flux"), core.vector(K:count(k))
  for _, i in ipairs(K:boundary_cells(k)) do out[i] = density(i) or 0 end
  return K:lumped(k, out)
end

local function load_of(K, options)
  local count, weights = K:count(0), mass.of(K, 0).values
  local f = sample.values(options.f or 0, K, operator.primal(0), count,
    function() return K:points() end, WHERE, "f")
  local b, flux = K:star_values(0, f, "dual"), options.flux
  if flux == nil then return b, weights end
  return b + flux_load(K, flux), weights
end

--- d^T M_1 d of functions: -div grad of K without its masses.
function M.stiffness(K)
  return solver.once(K, "poisson", function() return K:incidence(0):gram(mass.of(K, 1).values) end)
end

-- the matrix, what of it is free, its solver and the components without a fixed vertex: made once
-- for what is fixed
local function system_of(K, keep, key, wish)
  return solver.once(K, ("poisson %s %s"):format(wish or "", key), function()
    local A = M.stiffness(K)
    local floats = floating(K, keep)
    keep = keep:copy()
    for _, vertices in ipairs(floats) do keep[vertices and vertices[1] or 1] = 0 end
    local S = A:pick(keep, keep)
    return { A = A, keep = keep, floats = floats,
      solver = S.rows > 0 and solver.new(S, wish, WHERE) or nil }
  end)
end

local function note_mean(report, removed)
  local largest = 0
  for _, x in ipairs(removed) do largest = math.max(largest, math.abs(x)) end
  report.mean = #removed == 1 and removed[1] or removed
  report.text = ("nothing is fixed on %s: the mean of the load, %.6g, is taken away, and u has "
    .. "mean 0"):format(#removed == 1 and "a component" or #removed .. " components", largest)
end

class.method("dm.mesh", "poisson", function(K, options)
  option.check(options, KNOWN, WHERE)
  local wish = option.one_of(options, "solver", WHERE, solver.ways)
  local b, weights = load_of(K, options)
  local u, keep, key = fixed_values(K, options.fixed or {})
  local system = system_of(K, keep, key, wish)
  local removed, floats = {}, system.floats
  for c, vertices in ipairs(floats) do
    removed[c] = total(b, vertices) / total(weights, vertices)
    b = less(b, removed[c], weights, vertices)
  end
  local right = b
  if key ~= " " then right = b - system.A * u end
  if system.solver then
    u = core.spread(system.solver:solve(core.pick(right, system.keep)), system.keep, u)
  end
  for _, vertices in ipairs(floats) do
    local mean = 0
    if vertices then
      for _, i in ipairs(vertices) do mean = mean + weights[i] * u[i] end
    else
      mean = weights:dot(u)
    end
    local ones = mass.ones(K, 0)
    u = less(u, mean / total(weights, vertices), ones, vertices)
  end
  local report = system.solver and system.solver:report() or core.result { unknowns = 0 }
  if #floats > 0 then note_mean(report, removed) end
  local negatives = mass.of(K, 1).negatives
  if negatives > 0 then report.negative_stars = negatives end
  report.note = mass.joined(report.note, mass.note(K))
  return K:form(0, u), report
end, [[
K:poisson{f=, fixed={boundary=, [vertex]=}, flux=, solver=} -> dm.form, report
u with delta d u = f, f a density: a number, a function of the point, a 0-form or a list (0). fixed:
values on the boundary (the same kinds), and at single vertices; flux: du/dn outward through the
rest of the boundary, a number or a function of the point, asked at circumcentres of facets (0;
nil is 0).
Where nothing is fixed the mean of the load is taken away, u has mean 0 and report.text says so.
Factors are kept: the next solve with the same vertices fixed is cheap. report: solver, unknowns,
note where the matrix is not positive definite and of barycentric duals, negative_stars of edges.
solver = "cholesky", "lu", "gradients" or "dense" asks for one. Order 2 in the L2 norm, also where
stars of edges are negative; none with barycentric duals, which err by some percent on any mesh.]])

return M
