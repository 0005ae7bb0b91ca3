--- The system on the tangent group T G whose step by a rule of the group is the tangent of a step.
-- T G is the semidirect product of G and its algebra by Ad, (g, w) with w = Ad_g u and u = g^-1 dg;
-- its exp is the tangent of exp, so rules of the group step the prolonged Lagrangian
--   L~(g, w; xi, omega) = L_g . u + L_xi . omega,   omega = u' + [xi, u] = Ad_(g^-1) w',
-- omega the change of xi, by the tangent of their step of L. Momenta: (dp, p). Of an H without L it
-- is H_g . u + H_p . dp. The work <f, eta> of
-- a covector changes by <df, eta> + <f, zeta>, zeta = Ad_(g^-1) of the variation of w: on T G it is
-- (df, f).
local bound = require "dm.base.bound"
local core = require "dm.core"
local flats = require "dm.group.flat"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local matrix_functions = require "dm.group.matrix_functions"
local place = require "dm.group.place"

local M = {}

local joined, part = lists.joined, lists.part

--- The place of the same group with entries of matrices for coordinates, which elements have at
-- once.
function M.entries_of(system)
  local side = system.place.right and "right" or "left"
  return place.of(system.Q, { columns = "matrix", trivialization = side })
end

---- its exp and its Cayley map ----

-- Both are the tangent of that of G: (xi, omega) goes to (tau(xi), w) with w = slope_xi omega,
-- slope the right-trivialized differential of tau; and with g' g^-1 = a = slope_xi eta, w' - [a, w]
-- is that of the tangent: the function (xi, omega, eta, nu) -> a, w' - [a, w].
local function second_slope(kit, slope)
  local d = kit.dimension
  local along = core.derivative(slope, d, d)
  return function(xi, omega, eta, nu)
    local a, moved, J = slope(xi, eta), slope(xi, nu), along(xi, omega)
    for i = 1, d do
      for k = 1, d do moved[i] = moved[i] + J[i][k] * eta[k] end
    end
    return a, moved - kit.ad(a, slope(xi, omega))
  end
end

-- the same of exp, by the matrices {{X, Y}, {0, X}} of T G where that of G is a series
local function second_dexp(kit)
  if not kit.by_series then return second_slope(kit, kit.dexp) end
  local n = kit.matrix(kit.identity()).rows
  local function doubled(x, y)
    local X, Y = kit.hat(x), kit.hat(y)
    return linear.fill(2 * n, 2 * n, function(i, j)
      if j > n then return i > n and X[i - n][j - n] or Y[i][j - n] end
      return i > n and 0 or X[i][j]
    end)
  end
  local function block(W, first)
    return kit.vee(linear.fill(n, n, function(i, j) return W[i][first + j] end))
  end
  return function(xi, omega, eta, nu)
    local W = matrix_functions.dexp(doubled(xi, omega), doubled(eta, nu))
    return block(W, 0), block(W, n)
  end
end

-- of a product factor by factor
local function by_factors(kit)
  if not kit.parts then return second_dexp(kit) end
  local of = {}
  for i, factor in ipairs(kit.parts) do of[i] = by_factors(factor) end
  return function(...)
    local first, lists_of, a, b = 0, { ... }, {}, {}
    for i, factor in ipairs(kit.parts) do
      local own, d = {}, factor.dimension
      for k, x in ipairs(lists_of) do own[k] = part(x, first, d) end
      a[i], b[i] = of[i](table.unpack(own))
      first = first + d
    end
    return joined(table.unpack(a)), joined(table.unpack(b))
  end
end

local function give_map(tangent, own, name, slope_name, slope, second)
  local kit, d = own.kit, own.kit.dimension
  local function split(x) return part(x, 0, d), part(x, d, d) end
  tangent[name] = function(x)
    local xi, omega = split(x)
    return { kit[name](xi), slope(xi, omega) }
  end
  tangent[slope_name] = function(x, rate)
    local xi, omega = split(x)
    return joined(second(xi, omega, split(rate)))
  end
  tangent.smooth[name] = function(x)
    local xi, omega = split(x)
    return kits.list_of(joined(own[name](xi), slope(xi, omega)))
  end
end

-- Pade's approximants are the Cayley map of z(xi), that of the tangent is of (z, z_xi omega)
local function give_pade(tangent, kit, d)
  local along = {}
  local function slope(k)
    along[k] = along[k] or core.derivative(function(xi, omega)
      return (select(2, kit.pade(k, xi, omega)))
    end, d, d)
    return along[k]
  end
  function tangent.pade(k, x, rate)
    local xi, omega = part(x, 0, d), part(x, d, d)
    local z, dz = kit.pade(k, xi, omega)
    if not rate then return joined(z, dz) end
    local eta, nu = part(rate, 0, d), part(rate, d, d)
    local _, of_eta = kit.pade(k, xi, eta)
    local _, of_nu = kit.pade(k, xi, nu)
    local J = slope(k)(xi, omega)
    for i = 1, d do
      for j = 1, d do of_nu[i] = of_nu[i] + J[i][j] * eta[j] end
    end
    return joined(z, dz), joined(of_eta, of_nu)
  end
end

-- gains of turns about axes (group/flat.lua): w stays where g turns, and (1, x e_a) adds x Ad_g e_a
-- to w and x coad(e_a, p) to dp; exp(x e_a) from the right takes w along
local function give_turns(tangent, own, kit, d)
  if not own.turn then return end
  local zero, one = core.zeros(d), core.vector(own.flat(kit.identity()))
  local function turn(a, x, q, right)
    local g, w = part(q, 0, #one), part(q, #one, d)
    if a > d then
      local along = linear.unit(d, a - d) * x
      if not right then along = kit.Ad(own.element(g), along) end
      return kits.list_of(joined(0 * one, along))
    end
    local moved = right and kit.Ad(kit.exp(linear.unit(d, a) * x), w) - w or zero
    return kits.list_of(joined(own.turn(a, x, g, right), moved))
  end
  tangent.smooth.turn = turn
  function tangent.smooth.turned(a, x, mu)
    local dp, p = part(mu, 0, d), part(mu, d, d)
    if a <= d then return joined(own.turned(a, x, dp), own.turned(a, x, p)) end
    return joined(kit.coad(linear.unit(d, a - d), p) * x, zero)
  end
  function tangent.smooth.mend(q)
    return kits.list_of(joined(own.mend(part(q, 0, #one)), zero))
  end
end

local function space_of(system)
  local kit, d = system.place.kit, system.place.dimension
  local Q = core.semidirect(system.Q, core.R(d), function(g, w) return kit.Ad(g, w) end)
  local tangent, own = kits.of(Q), flats.of(kit)
  tangent.pade = nil
  give_turns(tangent, own, kit, d)
  give_map(tangent, own, "exp", "dexp", kit.slope or kit.dexp, by_factors(kit))
  if kit.cayley and kit.dcay and not kit.no_cayley then
    give_map(tangent, own, "cayley", "dcay", kit.dcay, second_slope(kit, kit.dcay))
    if kit.pade then give_pade(tangent, kit, d) end
  end
  return Q
end

---- functions of a state on it ----

--- The derivative of F(g near(e), xi, t, more) in (e, xi, t, more) at e = 0 (right: near(e) g) as a
-- function of (g, xi, t, more), behind as many numbers as are returned second; more: how many.
function M.slopes(system, F, more)
  local P, d = M.entries_of(system), system.place.dimension
  local lengths = { P.size, d, d, "number", more }
  local J = core.derivative(function(q, e, ...)
    local moved = P.right and P.carry(P.near(e), q) or P.carry(q, P.near(e))
    return F(P.element(moved), ...)
  end, table.unpack(lengths))
  return function(g, ...) return J(core.vector(P.flat(g)), core.zeros(d), ...) end, P.size
end

local slopes = M.slopes

-- the change of g and of xi
local function changes(kit, z, x, d)
  return kit.Ad(kit.inverse(z[1]), z[2]), part(x, 0, d), part(x, d, d)
end

-- f(g, xi, t [, numbers]) and its change along (u, omega [, changes of the numbers]), as two lists;
-- more: how many numbers
local function with_change(system, f, more)
  local kit, d = system.place.kit, system.place.dimension
  local slope, N = slopes(system, function(...) return core.vector(lists.entries(f(...))) end, more)
  return function(z, x, t, given)
    local u, xi, omega = changes(kit, z, x, d)
    local state = { xi, t, more and part(given, 0, more) }
    local J, f0 = slope(z[1], table.unpack(state)), lists.entries(f(z[1], table.unpack(state)))
    local change = {}
    for i = 1, #f0 do
      local sum = 0
      for k = 1, d do sum = sum + J[i][N + k] * u[k] + J[i][N + d + k] * omega[k] end
      for k = 1, more or 0 do sum = sum + J[i][N + 2 * d + 1 + k] * given[more + k] end
      change[i] = sum
    end
    return f0, change
  end
end

local function lift_lagrangian(system, L)
  local kit, d = system.place.kit, system.place.dimension
  local slope, N = slopes(system, L)
  return function(z, x, t)
    local u, xi, omega = changes(kit, z, x, d)
    local y, sum = slope(z[1], xi, t), 0
    for k = 1, d do sum = sum + y[N + k] * u[k] + y[N + d + k] * omega[k] end
    return sum
  end
end

-- H~(g, w; dp, p) = H_g . u + H_p . dp of a Hamiltonian
local function lift_hamiltonian(system, H)
  local kit, d = system.place.kit, system.place.dimension
  local slope, N = slopes(system, H)
  return function(z, x, t)
    local u, dp, p = changes(kit, z, x, d)
    local y, sum = slope(z[1], p, t), 0
    for k = 1, d do sum = sum + y[N + k] * u[k] + y[N + d + k] * dp[k] end
    return sum
  end
end

-- rows of E one after the other: given, or dphi/dxi
local function reaction_rows(system, E, phi)
  local d = system.place.dimension
  if E then
    return function(g, xi, t)
      local out = {}
      for _, row in ipairs(lists.entries(E(g, xi, t))) do
        for k = 1, d do out[#out + 1] = row[k] end
      end
      return out
    end
  end
  local slope, N = slopes(system, function(...) return core.vector(lists.entries(phi(...))) end)
  return function(g, xi, t)
    local J, out = slope(g, xi, t), {}
    for i = 1, #lists.entries(phi(g, xi, t)) do
      for k = 1, d do out[#out + 1] = J[i][N + d + k] end
    end
    return out
  end
end

-- reactions along (E, 0) for the change of phi, and along (dE, E) for phi itself
local function lift_reaction(system, E)
  local d, lifted = system.place.dimension, with_change(system, E)
  return function(z, x, t)
    local rows, change = lifted(z, x, t)
    local of_change, of_phi, zero = {}, {}, core.zeros(d)
    for r = 1, #rows // d do
      local row = part(rows, (r - 1) * d, d)
      of_change[r], of_phi[r] = joined(row, zero), joined(part(change, (r - 1) * d, d), row)
    end
    return table.move(of_phi, 1, #of_phi, #of_change + 1, of_change)
  end
end

-- what the step is held to, beside L~
local function add_constraints(options, system)
  local given, d = system.given, system.place.dimension
  local function own(key) return bound(given[key], given.params) end
  local g, phi = own "constraint", own "rolling"
  if g then
    local lifted = with_change(system, function(q, _, t) return g(q, t) end)
    local rest = core.zeros(2 * d)
    function options.constraint(z, t) return joined(lifted(z, rest, t)) end
  end
  if phi then
    local lifted = with_change(system, phi)
    function options.rolling(z, x, t) return joined(lifted(z, x, t)) end
    options.reaction = lift_reaction(system, reaction_rows(system, own "reaction", phi))
  end
end

-- a torque, and a control that is held over a step, with its change
local function add_forces(options, system)
  local given, lifted = system.given, nil
  local f, control = bound(given.force, given.params), bound(given.control, given.params)
  if control then
    local held = with_change(system, control)
    function options.control(z, x, t) return joined(held(z, x, t)) end
  end
  options.force = f and function(z, x, t, u)
    lifted = lifted or with_change(system, f, control and #u // 2)
    local value, change = lifted(z, x, t, u)
    return joined(change, value)
  end
end

--- The prolonged system of one on a group, in the left trivialization.
function M.system(system)
  local given = system.given
  local options = { Q = space_of(system), crossings = given.crossings }
  if not given.L then
    options.H = lift_hamiltonian(system, bound(given.H, given.params))
    return core.prolonged(options)
  end
  options.L = lift_lagrangian(system, bound(given.L, given.params))
  add_forces(options, system)
  add_constraints(options, system)
  return core.prolonged(options)
end

return M
