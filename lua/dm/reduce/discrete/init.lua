--- Reduction of a discrete Lagrangian Ld(q0, q1) that the group leaves as it is: psi_mu, the
-- discrete connection, the reduced discrete Lagrangian and the discrete Routh equations. In
-- coordinates (theta, x), with psi = theta1 - theta0:
--   dLd/dpsi (x0, x1, psi_mu) = mu,   L^d = Ld(x0, x1, psi_mu),
--   A^ = (mu psi_x0 - B(x0), mu psi_x1 + B(x1)),
--   D2 L^d(x0, x1) + D1 L^d(x1, x2) = A^2(x0, x1) + A^1(x1, x2)
-- (Jalnapurkar, Leok, Marsden & West 2006).
local action = require "dm.reduce.discrete.action"
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local check = require "dm.reduce.discrete.check"
local core = require "dm.core"
local forces = require "dm.reduce.discrete.forces"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local parameters = require "dm.reduce.routh.params"
local psi_of = require "dm.reduce.discrete.psi"
local routh = require "dm.reduce.routh"
local shape_of = require "dm.reduce.routh.shape"
local step_of = require "dm.reduce.discrete.step"

local M = {}

local Discrete = core.class({ __name = "dm.discrete_shape" }, [[
dm.discrete_shape: a discrete Lagrangian without its group variables, made by shape:discrete
fields: shape (the reduced system), Ld (of the unreduced system), h; points x0, x1 are dim shape
numbers each.]])

function Discrete.__tostring(D)
  return ("%s, reduced to %s"):format(tostring(D.Ld), D.shape.Q)
end

local POINT = "%s must be a point of the shape space: %d number%s (got %s)"

local function point(D, x, what) return lists.numbers(what, x, D.info.d, POINT) end

local function points(D, x0, x1) return point(D, x0, "x0"), point(D, x1, "x1") end

-- mu . psi_x, d numbers, of the m rows of psi_x
local function mu_times(info, psi_x)
  local out = core.zeros(info.d)
  for a = 1, info.m do out = out + info.mu[a] * psi_x[a] end
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

-- theta and the shape of a point of the unreduced system; of several shapes the one near another
local function full_point(D, q, what, near)
  q = lists.numbers(what, q, D.info.n, FULL)
  local home = routh.info(D.shape).ambient
  local x, theta = model.split(D.info, home and home.place(q, near) or q)
  return core.vector(x), theta
end

function methods.connection(D, q0, q1)
  local info = D.info
  local x0, a = full_point(D, q0, "q0")
  local x1, b = full_point(D, q1, "q1", x0)
  local psi, out = psi_of.pair(D, x0, x1).psi, {}
  for i = 1, info.m do out[i] = b[i] - a[i] - psi[i] end
  return core.vector(out)
end

function methods.routhian(D, x0, x1)
  x0, x1 = points(D, x0, x1)
  return D.root:value(x0, x1, psi_of.pair(D, x0, x1).psi)
end

function methods.value(D, x0, x1)
  x0, x1 = points(D, x0, x1)
  local psi = psi_of.pair(D, x0, x1).psi
  return D.root:value(x0, x1, psi) + core.vector(D.info.mu):dot(psi)
end

-- a pair of shapes: psi, y0, y1 and their derivatives, and A^1, A^2
local function both_ends(D, x0, x1)
  local s = psi_of.pair(D, x0, x1)
  local by = psi_of.derivatives(D, x0, x1, s.psi)
  s.y0_x1, s.by0, s.by1 = by.y0_x1, mu_times(D.info, by.psi_x0), mu_times(D.info, by.psi_x1)
  s.A1 = s.by0 - shape_of.potential_of(D.info, x0, 0)
  s.A2 = s.by1 + shape_of.potential_of(D.info, x1, 0)
  return s
end

function methods.one_form(D, x0, x1)
  local s = both_ends(D, points(D, x0, x1))
  return s.A1, s.A2
end

-- D1 L^d + F1, D2 L^d + F2 at a pair
local function slopes(s) return s.by0 - s.y0, s.by1 + s.y1 end

function methods.legendre_minus(D, x0, x1)
  local s = both_ends(D, points(D, x0, x1))
  return s.A1 - (slopes(s))
end

function methods.legendre_plus(D, x0, x1)
  local s = both_ends(D, points(D, x0, x1))
  return select(2, slopes(s)) - s.A2
end

function methods.residual(D, x0, x1, x2, kind)
  x0, x1 = points(D, x0, x1)
  x2 = point(D, x2, "x2")
  if kind == "direct" then return psi_of.pair(D, x0, x1).y1 - psi_of.pair(D, x1, x2).y0 end
  if kind ~= nil and kind ~= "literal" then
    error("residual: the kind must be \"literal\" or \"direct\"", 0)
  end
  local s, r = both_ends(D, x0, x1), both_ends(D, x1, x2)
  return select(2, slopes(s)) + slopes(r) - s.A2 - r.A1
end

function methods.two_form(D, x0, x1)
  x0, x1 = points(D, x0, x1)
  return core.matrix(psi_of.derivatives(D, x0, x1, psi_of.pair(D, x0, x1).psi).y0_x1)
end

function methods.step(D, x0, x1)
  if D.constraint or D.forces and D.forces.rolling then
    error("step: this system has constraints, with which D:solver{} steps it", 0)
  end
  x0, x1 = points(D, x0, x1)
  local step, before_psi = step_of.of(D)
  local fine, found = blame.try(step, x1, psi_of.pair(D, x0, x1).y1, x1)
  if not fine then
    error(("step: no next point was found after x1 = %s: %s"):format(tostring(x1), found), 0)
  end
  return lists.part(found, 0, D.info.d), lists.part(found, before_psi, D.info.m)
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
The reduced momentum at x0, s0 = -(D1 L^d + F1 - A^1), F1 the discrete force where there is one: p -
mu A of the unreduced path there.]])
doc("legendre_plus", [[
D:legendre_plus(x0, x1) -> dm.vector
The reduced momentum at x1, s1 = D2 L^d + F2 - A^2.]])
doc("residual", [[
D:residual(x0, x1, x2 [, kind]) -> dm.vector
What is left of the discrete Routh equations at three points in a row: kind = "literal" (default),
D2 L^d + D1 L^d - A^2 - A^1 (Leok 2.3.29), or "direct", dLd/dx1 + dLd/dx1 at psi_mu, which is the
same without a connection; discrete forces F2 + F1 are in it (Leok 2.8.2), reactions are not.]])
doc("two_form", [[
D:two_form(x0, x1) -> dm.matrix, dim shape x dim shape
The matrix -d2W/dx0dx1 (row x0, column x1) of the reduced discrete symplectic form, W the discrete
Routhian: kept along paths, and regular where x1 determines the momentum.]])
doc("step", [[
D:step(x0, x1) -> x2, psi
The next point of the discrete Routh equations after x0 and x1, and psi_mu(x1, x2), solved for
together, to round-off; of several solutions the one that the step of Ld takes. For long runs use
D:solver, which takes the same steps.]])

doc("solver", [[
D:solver{...} -> dm.solver
A solver of the discrete Routh equations, in C: the discrete Lagrangian D:routhian with its step as
a map, x1 and psi_mu solved for together by the equations of Ld in the coordinates of Q, so that it
steps what Ld steps (run it from q and p, or q0 and q1; p is the canonical momentum s + mu A). Of a
partitioned Runge-Kutta rule in the coordinates (theta, x) it is the solver of the shape, which
takes the same steps. path:reconstruct adds psi_mu from step to step. Constraints of the system are
those of the shape, with the multipliers of the unreduced equations (run with record = {
"impulses" }, Leok 2.8.1). Options as for dm.solver.]])

---- its maker ----

-- the discrete Lagrangian that was given, or that of a rule in the coordinates (theta, x)
local function read(info, full, given)
  if full.place and (type(given) ~= "table" or given.Q ~= nil) then
    error("shape:discrete: a discrete Lagrangian on a group knows no theta and x: give { rule =, h "
      .. "= }, a rule for these coordinates", 0)
  end
  if type(given) == "table" then
    local home = parameters.full(info)
    if home.given.rolling then check.places(info, home) end
    local Ld = check.of_rule(home, { rule = given.rule, h = given.h })
    check.places(info, home, Ld)
    return Ld
  end
  local fine, n = blame.try(function() return given.Q.dimension, given.h end)
  if not fine or type(given) ~= "userdata" or n ~= full.Q.dimension then
    error("shape:discrete takes { rule =, h = } or a dm.discrete_lagrangian on the unreduced "
      .. "coordinates", 0)
  end
  check.places(info, full, given)
  return given
end

M.discrete = blame.caller(function(shape, given)
  local info = routh.need(shape, "discrete")
  local full = parameters.unreduced(info)
  local Ld = read(info, full, given)
  local own = lists.copy(info)
  if type(given) == "table" then own.ambient = nil end
  local D = setmetatable({ info = own, Ld = Ld, h = Ld.h, shape = shape,
    action = action.of(Ld), constraint = shape.given.constraint, forces = forces.of(Ld) }, Discrete)
  if type(given) ~= "table" then check.given(D, full) end
  psi_of.make(D)
  return D
end)

M.class = Discrete

class.method("dm.system", "discrete", M.discrete, [[
shape:discrete{rule=, h=} -> dm.discrete_shape   or   shape:discrete(Ld) -> dm.discrete_shape
A discrete Lagrangian of the unreduced system without its group variables: that of a stage rule, or
a dm.discrete_lagrangian in the unreduced coordinates. It has psi_mu, the discrete connection, the
discrete Routh equations. Raises where the group does not leave Ld as it is, where it is that of
another system (its equations do not approach those of L as h goes to 0) or has another momentum
along the group than L has, or a constraint that the system has not. Its forces and rolling
constraints are reduced where the group leaves them and their reactions invariant and they have no
part along it (Leok 2.8.2-2.8.3); else raises with the entry and the component.]])

return M
