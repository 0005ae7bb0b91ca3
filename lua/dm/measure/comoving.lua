--- Matrices of systems linearised about motions along a symmetry, in what moves with them: at a
-- relative equilibrium the vector field X is w Z, Z the lift of a generator of the symmetry, and
-- d(X - w Z) there does not depend on time, where dX does.
local bound = require "dm.base.bound"
local core = require "dm.core"
local left = require "dm.group.trivialization.left"
local lists = require "dm.base.lists"
local on_group = require "dm.measure.on_group"
local option = require "dm.base.options"
local tangent_group = require "dm.measure.tangent_group"

local M = {}

local joined, part = lists.joined, lists.part

local SAME = 1e-8  -- of the motion: what of it is not along the generator

-- w with X = w Z; raises where there is none
local function rate_of(X, Z, what)
  local square = Z:dot(Z)
  if not (square > 0) then
    option.fail(what, "option 'generator': it moves nothing at this state")
  end
  local w = X:dot(Z) / square
  local rest = (X - w * Z):norm()
  if not (rest <= SAME * math.max(X:norm(), w * w * math.sqrt(square))) then
    option.fail(what, "this state is no relative equilibrium of option 'generator': %.3g of its "
      .. "rates of change is not along it", rest / X:norm())
  end
  return w
end

-- what the user's generator gives, as a vector of n entries
local function checked(generator, n, what)
  return function(q)
    return lists.numbers(what .. ": what option 'generator' returns", generator(q), n,
      "%s must be a list of %d number%s (got %s)")
  end
end

---- in coordinates ----

-- the rates of (q, v), or of (q, p) where there is only H
local function rates_in_coordinates(system, t)
  local given, n = system.given, system.Q.dimension
  if given.L then
    return function(q, v) return joined(v, system:acceleration(q, v, t)) end
  end
  local slope = core.derivative(bound(given.H, given.params), n, n, "number")
  return function(q, p)
    local y = slope(q, p, t)
    return joined(part(y, n, n), -part(y, 0, n))
  end
end

-- those along a generator
local function lift_in_coordinates(system, generator)
  local n, of_velocity = system.Q.dimension, system.given.L
  local slope = core.derivative(generator, n)
  return function(q, y)
    local J, moved = slope(q), {}
    for i = 1, n do
      moved[i] = 0
      for k = 1, n do
        moved[i] = moved[i] + (of_velocity and J[i][k] or -J[k][i]) * y[k]
      end
    end
    return joined(generator(q), moved)
  end
end

--- The matrix at (q, v), or (q, p) of an H alone, and the rate w.
function M.matrix(system, q, y, t, generator, what)
  local n, zeta = system.Q.dimension, checked(generator, system.Q.dimension, what)
  local rates, lift = rates_in_coordinates(system, t), lift_in_coordinates(system, zeta)
  local w = rate_of(rates(q, y), lift(q, y), what)
  return core.derivative(function(x, z) return rates(x, z) - w * lift(x, z) end, n, n)(q, y), w
end

---- on groups, in the left trivialization ----

-- what the body velocity eta of the generator adds to that of a motion; of an H alone to the
-- momentum, by the field of <mu, eta>
local function lift_on_group(system, eta)
  local kit, d = system.place.kit, system.place.dimension
  if not system.given.L then
    return on_group.rates_of_momentum(system, function(g, mu) return eta(g):dot(mu) end)
  end
  local slope, N = tangent_group.slopes(system, function(g) return eta(g) end)
  return function(g, xi, t)
    local J, moved = slope(g, xi, t), kit.ad(xi, eta(g))
    for i = 1, d do
      for k = 1, d do moved[i] = moved[i] + J[i][N + k] * xi[k] end
    end
    return joined(eta(g), moved)
  end
end

--- The same of changes (g^-1 dg, dxi), or (g^-1 dg, dmu) of an H alone.
function M.matrix_on_group(system, g, x, t, generator, what)
  local own, d = system.place, system.place.dimension
  if own.right then
    return M.matrix_on_group(left.system(system), g, left.moved(system, g, x), t, generator, what)
  end
  local rates = on_group.rates(system)
  local lift = lift_on_group(system, checked(generator, d, what))
  local w = rate_of(rates(g, x, t), lift(g, x, t), what)
  local slope, N = tangent_group.slopes(system, function(...) return rates(...) - w * lift(...) end)
  local J, out = slope(g, x, t), core.matrix(2 * d, 2 * d)
  for i = 1, 2 * d do
    for k = 1, d do out[i][k], out[i][d + k] = J[i][N + k], J[i][N + d + k] end
  end
  return out, w
end

---- reduced systems: (xi, a) or (mu, a), as they are ----

-- rates of mu and of a as functions of (xi or mu, a): mu' = ad*_xi mu + l_a <> a, a' = -xi a
local function reduced_rates(system)
  local kit, d = system.place.kit, system.place.dimension
  local reduced = system.place.reduced
  local f, carry, n = reduced.f, reduced.carry, reduced.carry and #reduced.a or 0
  local function seen(e, a) return carry and carry(kit.inverse(kit.near(e)), a) or a end
  local still = core.zeros(d)
  local slope = core.derivative(function(x, e, a)
    return f(x, carry and core.vector(seen(e, a)) or nil)
  end, d, d, n > 0 and n or 1)
  local moved = core.derivative(function(e, a) return core.vector(seen(e, a)) end, d,
    n > 0 and n or 1)
  -- of mu, and of a where xi carries it
  local function rates(x, xi, mu, a)
    local torque, along = part(slope(x, still, a), d, d), {}
    local J = n > 0 and moved(still, a)
    for i = 1, n do
      along[i] = 0
      for k = 1, d do along[i] = along[i] + J[i][k] * xi[k] end
    end
    return kit.coad(xi, mu) + torque * (reduced.name == "L" and 1 or -1), along
  end
  return rates, function(x, a) return part(slope(x, still, a), 0, d) end, n
end

-- (x, a) -> (x', a'), x = xi of an l and mu of an h
local function reduced_field(system)
  local d, of_l = system.place.dimension, system.place.reduced.name == "L"
  local rates, first, n = reduced_rates(system)
  if not of_l then
    return function(mu, a) return joined(rates(mu, first(mu, a), mu, a)) end, n
  end
  local second = core.derivative(first, d, n > 0 and n or 1)
  return function(xi, a)
    local turned, along = rates(xi, xi, first(xi, a), a)
    local J, mass = second(xi, a), {}
    for i = 1, d do
      mass[i] = {}
      for k = 1, d do mass[i][k] = J[i][k] end
      for k = 1, n do turned[i] = turned[i] - J[i][d + k] * along[k] end
    end
    return joined(core.matrix(mass):solve(turned), along)
  end, n
end

--- The matrix of a reduced system at x = xi (of an h: mu) and the quantity a, of changes (dx, da);
-- and the rates there.
function M.reduced_matrix(system, x, a)
  local d = system.place.dimension
  local f, n = reduced_field(system)
  a = a or core.zeros(1)
  local J, out = core.derivative(f, d, #a)(x, a), core.matrix(d + n, d + n)
  for i = 1, d + n do
    for k = 1, d + n do out[i][k] = J[i][k] end
  end
  return out, f(x, a)
end

return M
