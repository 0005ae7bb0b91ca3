--- K:stationary: forms at which a sum over cells is stationary, by Newton's method on its gradient
-- with the sparse Hessian ("discretize, then vary", Leok 3.12).
local action = require "dm.dec.fields.action"
local blame = require "dm.base.blame"
local cell = require "dm.dec.fields.cell"
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local held = require "dm.dec.fields.held"
local images = require "dm.dec.fields.images"
local newton = require "dm.dec.dynamics.newton"
local option = require "dm.base.options"
local spheres = require "dm.dec.fields.spheres"
local start = require "dm.dec.fields.start"
require "dm.dec.fields.sum"

local M = {}

local WHERE = "mesh:stationary"
local KNOWN = { "form", "values", "on", "fixed", "term", "x", "data", "iterations" }
local fail = option.failing(WHERE)

---- what is asked for ----

-- m of dm.S(m), and how many values a cell has
local function values_of(options)
  local values = option.whole(options, "values", WHERE, 1)
  if options.on == nil then return values or 1 end
  local m = tonumber(tostring(options.on):match "^S%((%d+)%)$")
  if not m then fail("option 'on' must be a sphere, dm.S(2) (got %s)", option.got(options.on)) end
  if values and values ~= m + 1 then
    fail("option 'values' is %d, and a point of S(%d) has %d", values, m, m + 1)
  end
  return m + 1, m
end

local function start_of(f, options)
  if options.x == nil then
    if f.sphere then fail("option 'x' is missing: where the search on the sphere begins") end
    return core.vector(f.n)
  end
  local read, given = blame.try(start.read, f, options.x, "q")
  if not read then fail("%s", (tostring(given):gsub("field 'q'", "option 'x'"))) end
  local fine, x = blame.try(core.vector, given)
  if not fine or #x ~= f.n then
    fail("option 'x' must be a form, a function of the position or a list of %d numbers (got %s)",
      f.n, fine and #x .. " numbers" or option.got(options.x))
  end
  local zeros = 0 * x
  if zeros:dot(zeros) ~= 0 then fail("option 'x' has values that are not finite") end
  return x
end

local function check_start(f, problem, x)
  local value, g = problem.value(x), problem.gradient(x)
  if value - value == 0 and g:dot(g) - g:dot(g) == 0 then return end
  local bad = images.inverted(f, x)
  fail("the term is %s at the start%s", value == value and "infinite, or its gradient," or "NaN",
    bad and (": the image of cell {%s} is inverted or degenerate; start from a map that turns no "
      .. "cell inside out"):format(table.concat(bad, ", ")) or ": start where it is finite")
end

---- results ----

local function forms_of(f, x)
  if f.values == 1 then return form.new(f.mesh, f.degree, "primal", x) end
  local list = core.result {}
  for c = 1, f.values do
    local values = core.vector(f.cells)
    for i = 1, f.cells do values[i] = x[(i - 1) * f.values + c] end
    list[c] = form.new(f.mesh, f.degree, "primal", values)
  end
  return list
end

-- value, gradient and Hessian by the numbers that are free
local function problem_of(f, options)
  local term = option.single(options.term, "term")
  local act = action.new(f.mesh, f.degree, f.values, term, f.fixed, options.data)
  local problem = { value = function(x) return act:value(x) end,
    gradient = function(x) return act:gradient(x) end,
    hessian = function(x) return act:hessian(x) end, held = f.held, n = f.n }
  return f.sphere and spheres.problem(problem, f) or newton.flat(problem), act
end

class.method("dm.mesh", "stationary", function(K, options)
  option.check(options, KNOWN, WHERE)
  local k = option.whole(options, "form", WHERE, 0, K.dimension, 0)
  local values, sphere = values_of(options)
  option.need(options, "term", WHERE, "a function of the form that gives a sum over cells")
  option.callable(options, "term", WHERE, "(A)")
  local most = option.whole(options, "iterations", WHERE, 1, nil, 100)
  local f = { mesh = K, degree = k, values = values, sphere = sphere, cells = K:count(k),
    n = values * K:count(k) }
  f.held, f.fixed = held.read(f, options.fixed)
  cell.check_data(K, options.data, WHERE)
  local x, problem, act = start_of(f, options), problem_of(f, options)
  check_start(f, problem, x)
  act:check(x)
  local report
  x, report = newton.solve(problem, x, most)
  return forms_of(f, x), report
end, [[
K:stationary{form=, values=, on=, fixed=, term=, x=, data=, iterations=} -> dm.form, report
A form of degree `form` (0 unless given) at which term(A), a sum over cells as the L of K:field has
it (K:sum, A:dot(B), A:d(), ...), is stationary: harmonic functions and maps, elastic bodies.
values: numbers a cell (1); on = dm.S(m): unit vectors of m + 1 numbers. fixed: cells that keep the
values of the start x: "boundary", a list of their numbers or a function of the position. x: a form,
a function of the position or a list (0; on spheres it must be given). Newton's method with the
sparse Hessian, downhill where that is not positive definite; a step that would make the term NaN or
infinite, as a cell turned inside out does, is cut. The result is a list of forms where a cell has
several values. report: code ("ok", "no_convergence"), text, value, iterations (at most 100, or as
given), residual (the norm of the gradient), kind ("minimum", "saddle", "degenerate": some
directions have no curvature, as where a constant may be added). Raises where the term is
not finite at the start, with the cell that is inverted, and where neighbours are opposite on a
sphere.]])

return M
