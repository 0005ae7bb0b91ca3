--- Small oscillations of a field around a state, and the steps that they allow:
--   M u'' = -S u, S = -d2L/dq2, of the cells that are not fixed.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local matrices = require "dm.dec.equations.matrices"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local spheres = require "dm.dec.fields.spheres"
require "dm.dec.equations"

local function field_of(system, where)
  local f = system.field
  if not f then option.fail(where, "this system is no field: K:field makes one") end
  return f
end

-- S once values without mass, whose block is a diagonal, follow from their own equation; where L
-- does not have one its row is 0. And the function that puts these values into a vector.
local function without(f, S)
  local marks = core.constant(f.n, 0)
  for _, i in ipairs(f.massless) do marks[i] = 1 end
  local own = S:pick(marks, marks):diagonal():map(function(x) return x == 0 and 0 or 1 / x end)
  local all = core.constant(f.n, 1)
  local beside = S:pick(marks, all)
  return S - beside:transpose() * beside:scale(own), function(x)
    local out, slopes = 1 * x, beside * x
    for j, i in ipairs(f.massless) do out[i] = -own[j] * slopes[j] end
    return out
  end
end

-- of unit vectors q: S and M in tangent spaces, and the basis of these
local function tangent_pencil(system, f, q, t)
  local kind, B, count = operator.primal(f.degree), spheres.basis(f, f, q)
  local bend = spheres.products(f, q, -1 * core.field_force(system, q, t))
  local S = -1 * core.field_hessian(system, q, t) - matrices.diagonal(bend)
  local masses = (B:transpose() * (matrices.diagonal(f.masses) * B)):diagonal()
  return operator.new(f.mesh, kind, kind, { weights = masses, keep = core.constant(count, 1),
    stiffness = B:transpose() * (S * B) }), function(x) return B * x end
end

-- the time at which L is looked at
local function time_of(system, options, where)
  local t = option.number(options, "t", where)
  if not t and core.field_is_timed(system) then
    option.fail(where, "L depends on t: give { t = }, the time it is looked at")
  end
  return t or 0
end

-- The masses, which L may have changed since K:field looked at them.
local function masses_of(system, f, where)
  local masses, unfit = core.field_masses(system)
  if unfit then option.fail(where, unfit) end
  local eliminated = {}
  for _, i in ipairs(f.massless or {}) do eliminated[i] = true end
  for i = 1, f.n do
    if masses[i] == 0 and not f.held[i] and not eliminated[i] then
      option.fail(where, "what L reads has changed since K:field: value %d has no mass now", i)
    end
  end
  return masses
end

-- S and M as an operator of the values, of unit vectors of tangent ones; and the function, if any,
-- from its vectors to all values
local function pencil(system, f, options, where)
  local q, t = options.q, time_of(system, options, where)
  if f.sphere and q == nil then
    option.fail(where, "option 'q' is missing: the state, unit vectors, that oscillations are "
      .. "around")
  end
  q = q and core.vector(f.start(q, "q")) or core.constant(f.n, 0)
  if #q ~= f.n then
    option.fail(where, "option 'q' must have %d numbers (got %d)", f.n, #q)
  end
  core.field_check(system, q, t)
  if f.sphere then return tangent_pencil(system, f, q, t) end
  local kind, masses = operator.primal(f.degree), masses_of(system, f, where)
  local keep = core.constant(f.n, 1)
  for i = 1, f.n do if f.held[i] or masses[i] == 0 then keep[i] = 0 end end
  local S = -1 * core.field_hessian(system, q, t)
  local whole
  if f.massless and #f.massless > 0 then S, whole = without(f, S) end
  return operator.new(f.mesh, kind, kind, { weights = masses, keep = keep, stiffness = S }), whole
end

-- the values of one eigenvector as a form, or as one for every value of a cell
local function shown(f, x)
  if f.values == 1 then return form.is_form(x) and x or form.new(f.mesh, f.degree, "primal", x) end
  local list = core.result {}
  for c = 1, f.values do
    local values = core.constant(f.cells, 0)
    for i = 1, f.cells do values[i] = x[(i - 1) * f.values + c] end
    list[c] = form.new(f.mesh, f.degree, "primal", values)
  end
  return list
end

class.method("dm.system", "modes", function(system, n, options)
  local where = "field:modes"
  local f = field_of(system, where)
  options = option.check(options or {}, { "q", "t", "above", "near" }, where)
  local A, whole = pencil(system, f, options, where)
  local found = A:eigen(n, { above = options.above, near = options.near })
  for i, x in ipairs(found.forms) do
    if whole then x = whole(form.is_form(x) and x.values or x) end
    found.forms[i] = shown(f, x)
  end
  return found
end, [[
field:modes(n, {q=, t=, above=, near=}) -> { values, forms, residuals, solver }
n modes of small oscillations of a field around the state q (default 0): squares of frequencies,
omega^2, and forms of norm 1 in the kinetic energy, those nearest to 0, with above = x the least
beyond x, with near = x nearest to x. t: the time of L, needed where L depends on it. They are
those of L: forces beside it are left out. Cells that are fixed stay at 0; those without mass
follow from their own equation. Of unit
vectors (on = dm.S(m)) q must be given; forms are tangent there, and where q is no equilibrium the
constraint's force is that of q.]])

---- the largest step ----

-- the largest h omega up to which a rule is stable, narrow bands of growth below it seen too
local function limit_of(rule)
  if rule:find "gauss%s*%(%s*%d+%s*,%s*%d" then
    option.fail("field:stability_limit", "a number of sweeps starts each step from the stages of "
      .. "the last one, so that one step tells no limit: try runs, dm.stability")
  end
  return (require "dm".stability_limit(rule))
end

-- the largest eigenvalue, as the one nearest to a bound of all
local function largest(A)
  local S, bound = A.stiffness, 0
  local rows = S:row_sums()
  for i = 1, #rows do
    if A.keep[i] ~= 0 then bound = math.max(bound, rows[i] / A.weights[i]) end
  end
  if bound == 0 then return 0 end
  return A:eigen(1, { near = 1.001 * bound }).values[1]
end

class.method("dm.system", "stability_limit", function(system, rule, options)
  local where = "field:stability_limit"
  local f = field_of(system, where)
  options = option.check(options or {}, { "q", "t" }, where)
  if type(rule) ~= "string" then option.fail(where, "a rule is needed, as \"verlet\"") end
  if rule:find "^%s*avi" then
    option.fail(where, "avi has a step of its own in every cell: solver:report() tells those "
      .. "beyond their limit")
  end
  local lambda = largest((pencil(system, f, options, where)))
  return lambda > 0 and limit_of(rule) / math.sqrt(lambda) or math.huge
end, [[
field:stability_limit(rule, {q=, t=}) -> number
The largest step of a rule on small oscillations of a field around q (default 0): the h omega up to
which the rule is stable on a harmonic oscillator (dm.stability_limit, which also sees narrow bands
of growth) over the largest frequency; 2 over it for verlet. Infinite where no step is too large. t:
the time of L, needed where L depends on it; forces beside L are left out.]])

return {}
