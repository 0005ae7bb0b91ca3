--- Reduction of a discrete Lagrangian Ld(q0, q1) that the group leaves as it is: psi_mu, the
-- discrete connection, the reduced discrete Lagrangian and the discrete Routh equations, all from
-- -D1 Ld, D2 Ld and -D1D2 Ld. In coordinates (theta, x), with psi = theta1 - theta0:
--   dLd/dpsi (x0, x1, psi_mu) = mu,   L^d = Ld(x0, x1, psi_mu),
--   A^ = (mu psi_x0 - B(x0), mu psi_x1 + B(x1)),
--   D2 L^d(x0, x1) + D1 L^d(x1, x2) = A^2(x0, x1) + A^1(x1, x2)
-- (Jalnapurkar, Leok, Marsden & West 2006).
-- The second derivatives of psi_mu follow from the mixed ones, since Ld depends on theta1 - theta0
-- alone.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local psi_of = require "dm.reduce.discrete.psi"
local routh = require "dm.reduce.routh"
local shape_of = require "dm.reduce.routh.shape"

local M = {}

local abs, max = math.abs, math.max

local Discrete = core.class({ __name = "dm.discrete_shape" }, [[
dm.discrete_shape: a discrete Lagrangian without its group variables, made by shape:discrete
fields: shape (the reduced system), Ld (of the unreduced system), h; points x0, x1 are dim shape
numbers each.]])

function Discrete.__tostring(D) return ("reduced %s"):format(tostring(D.Ld)) end

local MOST = 60

local POINT = "%s must be a point of the shape space: %d number%s (got %s)"

local function point(D, x, what) return lists.numbers(what, x, D.info.d, POINT) end

local function points(D, x0, x1) return point(D, x0, "x0"), point(D, x1, "x1") end

local function mu_times(info, by)
  local out = {}
  for j = 1, info.d do
    out[j] = 0
    for a = 1, info.m do out[j] = out[j] + info.mu[a] * by[j][a] end
  end
  return out
end

---- the methods ----

local methods = Discrete.methods

function methods.psi(D, x0, x1, guess)
  x0, x1 = points(D, x0, x1)
  if guess ~= nil then guess = shape_of.theta_list(D.info, guess, "the guess of psi") end
  return core.vector(psi_of.pair(D, x0, x1, guess).psi)
end

local FULL = "%s must be a point of the unreduced system: %d number%s (got %s)"

-- a point of the unreduced system
local function full_point(D, q, what)
  q = lists.numbers(what, q, D.info.n, FULL)
  return D.info.ambient and D.info.ambient.place(q) or q
end

function methods.connection(D, q0, q1)
  local info = D.info
  q0, q1 = full_point(D, q0, "q0"), full_point(D, q1, "q1")
  local x0, a = model.split(info, q0)
  local x1, b = model.split(info, q1)
  local psi, out = psi_of.pair(D, x0, x1).psi, {}
  for i = 1, info.m do out[i] = b[i] - a[i] - psi[i] end
  return core.vector(out)
end

function methods.value(D, x0, x1)
  local s = psi_of.pair(D, points(D, x0, x1))
  return D.Ld(s.q0, s.q1)
end

function methods.routhian(D, x0, x1)
  local s, sum = psi_of.pair(D, points(D, x0, x1)), 0
  for a = 1, D.info.m do sum = sum + D.info.mu[a] * s.psi[a] end
  return D.Ld(s.q0, s.q1) - sum
end

-- A^1, A^2 at a pair
local function forms(D, s, x0, x1)
  local info, first, second = D.info, {}, {}
  local B0, B1 = shape_of.potential_of(info, core.vector(x0), 0),
    shape_of.potential_of(info, core.vector(x1), 0)
  local by0, by1 = mu_times(info, s.by0), mu_times(info, s.by1)
  for j = 1, info.d do first[j], second[j] = by0[j] - B0[j], by1[j] + B1[j] end
  return core.vector(first), core.vector(second)
end

function methods.one_form(D, x0, x1)
  x0, x1 = points(D, x0, x1)
  return forms(D, psi_of.pair(D, x0, x1), x0, x1)
end

-- D1 L^d, D2 L^d at a pair
local function slopes(D, s)
  local info, first, second = D.info, {}, {}
  local by0, by1 = mu_times(info, s.by0), mu_times(info, s.by1)
  for j, k in ipairs(info.shape) do first[j], second[j] = by0[j] - s.p0[k], by1[j] + s.p1[k] end
  return core.vector(first), core.vector(second)
end

function methods.legendre_minus(D, x0, x1)
  x0, x1 = points(D, x0, x1)
  local s = psi_of.pair(D, x0, x1)
  return forms(D, s, x0, x1) - slopes(D, s)
end

function methods.legendre_plus(D, x0, x1)
  x0, x1 = points(D, x0, x1)
  local s = psi_of.pair(D, x0, x1)
  local _, A2 = forms(D, s, x0, x1)
  local _, D2 = slopes(D, s)
  return D2 - A2
end

-- dLd/dx at both ends, psi eliminated: canonical momenta
local function canonical(D, s)
  local y0, y1 = {}, {}
  for j, k in ipairs(D.info.shape) do y0[j], y1[j] = s.p0[k], s.p1[k] end
  return core.vector(y0), core.vector(y1)
end

function methods.residual(D, x0, x1, x2, kind)
  x0, x1 = points(D, x0, x1)
  x2 = point(D, x2, "x2")
  local s, r = psi_of.pair(D, x0, x1), psi_of.pair(D, x1, x2)
  if kind == "direct" then
    local _, y = canonical(D, s)
    return y - (canonical(D, r))
  elseif kind ~= nil and kind ~= "literal" then
    error("residual: the kind must be \"literal\" or \"direct\"", 0)
  end
  local _, A2 = forms(D, s, x0, x1)
  local _, D2 = slopes(D, s)
  return D2 + slopes(D, r) - A2 - forms(D, r, x1, x2)
end

-- -d2W/dx0dx1
local function two_form(D, s)
  local info, out = D.info, {}
  for i, k in ipairs(info.shape) do
    out[i] = {}
    for j, l in ipairs(info.shape) do
      local sum = s.T[k][l]
      for a, c in ipairs(info.cyclic) do sum = sum + s.T[k][c] * s.by1[j][a] end
      out[i][j] = sum
    end
  end
  return out
end

function methods.two_form(D, x0, x1)
  return core.matrix(two_form(D, psi_of.pair(D, points(D, x0, x1))))
end

function methods.step(D, x0, x1)
  if D.constraint then
    error("step: this system has constraints, with which D:solver{} steps it", 0)
  end
  x0, x1 = points(D, x0, x1)
  local s, x2 = psi_of.pair(D, x0, x1), {}
  local _, y = canonical(D, s)
  for j = 1, D.info.d do x2[j] = 2 * x1[j] - x0[j] end
  local guess, last = s.psi, math.huge
  for _ = 1, MOST do
    local r = psi_of.pair(D, x1, x2, guess)
    local rest, found = y - (canonical(D, r)), two_form(D, r)
    local move, size, scale = linear.solution(found, rest), 0, 1
    if not move then
      error("step: the reduced two-form is singular here, so that no next point is determined", 0)
    end
    for j = 1, D.info.d do
      x2[j] = x2[j] + move[j]; size, scale = max(size, abs(move[j])), max(scale, abs(x2[j]))
    end
    guess = r.psi
    if size <= 4e-16 * scale or (size >= last and size < 1e-12 * scale) then
      return core.vector(x2), core.vector(guess)
    end
    last = size
  end
  error(("step: no next point was found after x1 = %s"):format(tostring(core.vector(x1))), 0)
end

function methods.solver(D, options) return require "dm.reduce.discrete.del".solver(D, options) end

---- docs ----

local function doc(name, text)
  core.method("dm.discrete_shape", name, blame.caller(methods[name]), text)
end

doc("psi", [[
D:psi(x0, x1 [, guess]) -> dm.vector of dim G entries
psi_mu: how far the group variable goes from x0 to x1 at the momentum mu, the solution of
dLd/dpsi(x0, x1, psi) = mu (Leok 2.3); of several the one that Newton's method reaches from the
guess, by default h theta' of the straight line. Raises where there is none.]])
doc("connection", [[
D:connection(q0, q1) -> dm.vector of dim G entries
The discrete connection theta1 - theta0 - psi_mu(x0, x1) of two points of the unreduced system: zero
where their discrete momentum is mu; with mu = 0 the discrete mechanical connection.]])
doc("value", [[
D:value(x0, x1) -> number
The reduced discrete Lagrangian Ld(x0, x1, psi_mu). It is not what is stationary along paths: that
is D:routhian.]])
doc("routhian", [[
D:routhian(x0, x1) -> number
The discrete classical Routhian Ld(x0, x1, psi_mu) - mu . psi_mu, whose discrete Euler-Lagrange
equations are the discrete Routh equations.]])
doc("one_form", [[
D:one_form(x0, x1) -> dm.vector, dm.vector
The two halves of the one-form of Leok (2.3.29), mu psi_x0 - mu A(x0) and mu psi_x1 + mu A(x1), with
the connection of the shape.]])
doc("legendre_minus", [[
D:legendre_minus(x0, x1) -> dm.vector
The reduced momentum at x0, s0 = -(D1 L^d - A^1): p - mu A of the unreduced path there.]])
doc("legendre_plus", [[
D:legendre_plus(x0, x1) -> dm.vector
The reduced momentum at x1, s1 = D2 L^d - A^2.]])
doc("residual", [[
D:residual(x0, x1, x2 [, kind]) -> dm.vector
What is left of the discrete Routh equations at three points in a row: kind = "literal" (default),
D2 L^d + D1 L^d - A^2 - A^1 (Leok 2.3.29), or "direct", dLd/dx1 + dLd/dx1 at psi_mu, which is the
same without a connection.]])
doc("two_form", [[
D:two_form(x0, x1) -> dm.matrix, dim shape x dim shape
The matrix -d2W/dx0dx1 (row x0, column x1) of the reduced discrete symplectic form, W the discrete
Routhian: kept along paths, and regular where x1 determines the momentum.]])
doc("step", [[
D:step(x0, x1) -> x2, psi
The next point of the discrete Routh equations after x0 and x1, and psi_mu(x1, x2), by Newton's
method to round-off. For long runs of a rule use shape:solver, which takes the same steps.]])

doc("solver", [[
D:solver{...} -> dm.solver
A solver of the discrete Routh equations, in C: of a formula Ld as the discrete Euler-Lagrange
equations of D:routhian, with psi_mu an implicit function in its graph (run it from q0 and q1, or q
and p; p is the canonical momentum s + mu A); of a rule the solver of the shape. path:reconstruct
adds psi_mu from step to step. Constraints of the system are those of the shape, with the
multipliers of the unreduced equations (run with record = { "impulses" }, Leok 2.8.1). Options as
for dm.solver.]])

---- its maker ----

-- its Ld is a formula in L: midpoint, trapezoidal
local function is_formula(rule)
  for _, row in ipairs(core.rules()) do
    if row.name == rule then return row.formula end
  end
end

-- forces have no place in a formula; constraints have one at its nodes, and rules with stages
-- inside
local function check_constraints(info, given)
  local full, rule = info.full.given, type(given) == "table" and tostring(given.rule)
  local tied = full.constraint and not full.force
  if tied and (not rule or is_formula(rule)) then return end
  if tied then
    error(("discrete: this system has constraints, and '%s' has them at points inside of its "
      .. "steps, for which shape:solver has the reduced equations; "
      .. "\"midpoint\", \"trapezoidal\" and a dm.discrete_lagrangian have them at their nodes "
      .. "alone"):format(rule), 0)
  end
  routh.need_free(info, "discrete")
end

M.discrete = blame.caller(function(shape, given)
  local info = routh.need(shape, "discrete")
  check_constraints(info, given)
  local full = info.ambient and info.ambient.system or info.full
  local Ld = given
  if type(given) == "table" then routh.need_autonomous(info, "discrete") end
  if type(given) == "table" then
    Ld = core.discrete_lagrangian(info.full, { rule = given.rule, h = given.h })
  end
  local fine, n = pcall(function() return Ld.Q.dimension, Ld.h end)
  if not fine or type(Ld) ~= "userdata" or n ~= full.Q.dimension then
    error("shape:discrete takes { rule =, h = } or a dm.discrete_lagrangian on the unreduced "
      .. "coordinates", 0)
  end
  local own = lists.copy(info)
  if type(given) == "table" then own.ambient = nil end
  local D = setmetatable({ info = own, Ld = Ld, h = Ld.h, shape = shape, slopes = psi_of.slopes(Ld),
    constraint = shape.given.constraint }, Discrete)
  if type(given) ~= "table" then psi_of.check_invariance(D) end
  return D
end)

M.class = Discrete

class.method("dm.system", "discrete", M.discrete, [[
shape:discrete{rule=, h=} -> dm.discrete_shape   or   shape:discrete(Ld) -> dm.discrete_shape
A discrete Lagrangian of the unreduced system without its group variables: that of a stage rule, or
a dm.discrete_lagrangian in the unreduced coordinates, which the group must leave as it is. It has
psi_mu, the discrete connection, the discrete Routh equations.]])

return M
