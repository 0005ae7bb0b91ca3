--- The system linearised at a state, and the exact tangent map along an orbit: eigenvalues that say
-- whether small changes stay small.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local comoving = require "dm.measure.comoving"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local left = require "dm.group.trivialization.left"
local lists = require "dm.base.lists"
local on_constraints = require "dm.measure.on_constraints"
local on_group = require "dm.measure.on_group"
local option = require "dm.base.options"
local starts = require "dm.base.start"
local tangent_space = require "dm.measure.tangent_space"

local M = {}

local abs, sqrt, max, huge = math.abs, math.sqrt, math.max, math.huge

local NO_MASS = "system:linearize: no acceleration follows from L at q = %s, v = %s: d2L/dv2 is "
  .. "singular there (system:mass(q, v) shows it); take a state beside it, or other coordinates"

---- matrices of small changes, as functions of a state (q, v, t), and its rates ----

-- d(q, v)/dt: M a = L_qq q + (L_qv - L_vq) v; L does not depend on t
local function by_hessian(system)
  local given, n, traced = system.given, system.Q.dimension, nil
  return function(q, v, t)
    traced = traced or core.trace(function(x, y) return given.L(x, y, t, given.params) end, n, n)
    local H = traced:hessian(q, v)
    local mass, right, out = core.matrix(n, n), core.matrix(n, 2 * n), core.matrix(2 * n, 2 * n)
    for i = 1, n do
      for k = 1, n do
        mass[i][k] = H[n + i][n + k]
        right[i][k], right[i][n + k] = H[i][k], H[i][n + k] - H[n + i][k]
      end
    end
    local fine, solved = blame.try(mass.solve, mass, right)
    if not fine then error(NO_MASS:format(core.vector(q), core.vector(v)), 0) end
    for i = 1, n do out[i][n + i], out[n + i] = 1, solved[i] end
    return out
  end
end

-- constraints and forces of a system in coordinates: the accelerations know them
local function is_bound(given)
  return given.constraint or given.rolling or given.force or given.control
end

-- the same where L depends on time, or there is more than L
local function by_acceleration(system, rates)
  local n = system.Q.dimension
  local slope = core.derivative(rates, n, n, "number")
  return function(q, v, t)
    local J, out = slope(q, v, t), core.matrix(2 * n, 2 * n)
    for i = 1, 2 * n do
      for k = 1, 2 * n do out[i][k] = J[i][k] end
    end
    return out
  end
end

local function field(system)
  local function rates(q, v, t) return lists.joined(v, system:acceleration(q, v, t)) end
  if system:structure().autonomous and not is_bound(system.given) then
    return by_hessian(system), rates
  end
  return by_acceleration(system, rates), rates
end

-- d(q, p)/dt, by the second derivatives of H
local function phase_field(system)
  local given, n = system.given, system.Q.dimension
  local H = core.trace(function(q, p, t) return given.H(q, p, t, given.params) end, n, n, "number")
  local function rates(q, p, t)
    local y = H:gradient(q, p, t)
    return lists.joined(lists.part(y, n, n), -lists.part(y, 0, n))
  end
  return function(q, p, t)
    local S, out = H:hessian(q, p, t), core.matrix(2 * n, 2 * n)
    for i = 1, n do
      for k = 1, 2 * n do out[i][k], out[n + i][k] = S[n + i][k], -S[i][k] end
    end
    return out
  end, rates
end

-- p of a state of a system that has only H: given, or the one of v
local function momentum_of(system, options, q)
  if options.p then return core.vector(options.p) end
  if options.v then return system:legendre(q, options.v, options.t or 0) end
  return core.zeros(#q)
end

local function check_plain(system, what)
  local given = system.given
  if not (given and (given.L or given.H)) then error(what .. " needs a dm.system", 0) end
  if system:structure().linear_in_v then
    error(what .. ": L has no term quadratic in v, so that no acceleration follows from it: its "
      .. "equations are not of second order", 0)
  end
end

local function largest_of(A)
  local out = 0
  for i = 1, A.rows do
    for k = 1, A.columns do out = max(out, abs(A[i][k])) end
  end
  return out
end

local MOVED = 2 ^ -40  -- of the largest entry

-- A multiple eigenvalue that lacks eigenvectors, as 0 of a momentum and its place, is known to the
-- root of round-off, and comes apart to either side. Does more than round-off move it on?
local function is_round_off(A, growth)
  local random, B, size = core.random(1), core.matrix(A.rows, A.columns), largest_of(A)
  for i = 1, A.rows do
    for k = 1, A.columns do B[i][k] = A[i][k] + MOVED * size * random:uniform(-1, 1) end
  end
  return max(table.unpack(B:eigenvalues():totable())) > 2 * growth
end

local function describe(A, rates, frequencies)
  local fastest, growth = 0, 0
  for _, w in ipairs(frequencies) do fastest = max(fastest, w) end
  for _, s in ipairs(rates) do growth = max(growth, s) end
  local small = 1e-7 * max(fastest, growth)
  if growth > small and not is_round_off(A, growth) then
    return false, ("unstable: a small change grows like exp(%.5g t)"):format(growth), fastest
  end
  return true, ("no small change grows exponentially; the fastest oscillation has omega = %.5g")
    :format(fastest), fastest
end

local function check_matrix(A, what)
  for i = 1, A.rows do
    for k = 1, A.columns do
      if not (abs(A[i][k]) < huge) then
        error(what .. ": the second derivatives of L are not finite at this state", 0)
      end
    end
  end
end

local function result_of(A)
  local re, im = A:eigenvalues()
  local stable, why, fastest = describe(A, re:totable(), im:totable())
  return core.result { stable = stable, why = why, fastest = fastest, rates = re, frequencies = im,
    matrix = A }
end

-- what the constraints leave of a matrix of changes (n of them, and as many rates)
local function restricted(A, system, n, q, x, t)
  local rows = tangent_space.of_velocity(system, q, x, t)
  if #rows == 0 then return A end
  local basis = tangent_space.basis(rows, n)
  local out = core.matrix(#basis, #basis)
  for k, y in ipairs(basis) do
    local moved = A * y
    for i, x in ipairs(basis) do out[i][k] = x:dot(moved) end
  end
  return out
end

---- does the matrix stay what it is along the motion? ----

local LATER, SAME = { 0.3, 1.1 }, 1e-7  -- in units of the fastest rate; of the largest entry

-- Is A that at states behind (q, x) on a parabola, which the motion is where its acceleration is
-- zero? move(q, u): q moved by u.
local function is_steady(A, at, rates, move, q, x, t)
  local size, n = largest_of(A), #x
  local fine, same = blame.try(function()
    local r = rates(q, x, t)
    local v, a = lists.part(r, 0, n), lists.part(r, n, n)
    for _, later in ipairs(LATER) do
      local s = later / max(size, 1e-300)
      local B = at(move(q, s * v + 0.5 * s * s * a), x + s * a, t + s)
      if not (largest_of(A - B) <= SAME * size) then return false end
    end
    return true
  end)
  return size == 0 or fine and same
end

---- of a state ----

local function vector_of(place, x, key)
  return kits.vector(x, place.dimension, ("field '%s'"):format(key))
end

-- of changes (g^-1 dg, dxi); of an H alone (g^-1 dg, dmu)
local function state_on_group(system, options)
  local place, t = system.place, options.t or 0
  local g = groups.element(place.space, options.q)
  local x = options.v and vector_of(place, options.v, "v")
  if not system.given.L then
    x = options.p and vector_of(place, options.p, "p") or x and system:legendre(g, x, t)
  end
  if system.given.L and options.p then x = system:velocity(g, options.p, t) end
  return g, x and core.vector(x) or core.zeros(place.dimension), t
end

-- A, whether it stays what it is, at a state on a group
local function at_on_group(system, g, x, t, kept)
  local kit, right = system.place.kit, system.place.right
  if not kept.at then kept.at, kept.rates = on_group.field(system) end
  local at, rates = kept.at, kept.rates
  local A = at(g, x, t)
  return A, function()
    return is_steady(A, at, rates, function(z, u)
      local f = kit.exp(u)
      return right and kit.compose(f, z) or kit.compose(z, f)
    end, g, x, t)
  end
end

-- in the right trivialization a motion along a symmetry on the left may be steady in the left one
local function of_group(system, options, what, kept)
  local own, g, x, t = system.place, state_on_group(system, options)
  local A, is_constant, w
  if options.generator then
    A, w = comoving.matrix_on_group(system, g, x, t, options.generator, what)
    if own.right then system, x = left.system(system), left.moved(system, g, x) end
  else
    A, is_constant = at_on_group(system, g, x, t, kept)
    if own.right and not is_constant() then
      kept.left = kept.left or { system = left.system(system) }
      local other, y = kept.left.system, left.moved(system, g, x)
      local B, steady = at_on_group(other, g, y, t, kept.left)
      if steady() then system, x, A, is_constant = other, y, B, steady end
    end
  end
  return restricted(A, system, own.dimension, g, x, t), is_constant, w
end

local function in_coordinates(system, options, what, kept)
  local n, t = system.Q.dimension, options.t or 0
  local second = options.v or options.p
  if #options.q ~= n or second and #second ~= n then
    error(("%s: q and v have %d entries"):format(what, n), 0)
  end
  local q, x = core.vector(options.q), core.vector(options.v or core.zeros(n))
  if not system.given.L then
    x = momentum_of(system, options, q)
  elseif options.p then
    x = system:velocity(q, options.p, t)
  end
  on_constraints.check(system, q, x, t, what)
  if options.generator then
    local A, w = comoving.matrix(system, q, x, t, options.generator, what)
    return restricted(A, system, n, q, x, t), w
  end
  if not kept.at then
    kept.at, kept.rates = (system.given.L and field or phase_field)(system)
  end
  local at, rates = kept.at, kept.rates
  local A = at(q, x, t)
  return restricted(A, system, n, q, x, t), function()
    return is_steady(A, at, rates, function(y, u) return y + u end, q, x, t)
  end
end

-- of a reduced system, on the space of (xi, a), or of (mu, a)
local function of_reduced(system, options, what)
  local own, t = system.place, options.t or 0
  local reduced, kit = own.reduced, own.kit
  local g = groups.element(own.space, options.q or kit.identity())
  local a = reduced.usual or reduced.a
  if reduced.carry and not a then
    error(what .. ": the quantity that is carried along is missing, a =", 0)
  end
  a = a and core.vector(reduced.carry(kit.inverse(g), a))
  local x, of_h = options.v or core.zeros(own.dimension), reduced.name == "H"
  if of_h and options.v then x = system:legendre(g, options.v, t) end
  if options.p then x = of_h and options.p or system:velocity(g, options.p, t) end
  x = vector_of(own, x, options.p and "p" or "v")
  local A, moved = comoving.reduced_matrix(system, x, a)
  return A, function() return moved:norm() <= SAME * largest_of(A) * max(1, x:norm()) end
end

local function check_generator(options, system, what)
  if options.generator == nil then return end
  if type(options.generator) ~= "function" then
    error(("%s: option 'generator' must be a function of %s (got %s)"):format(what, system.place
      and "an element that returns the body velocity of its field"
      or "q that returns the velocity of its field", option.got(options.generator)), 0)
  end
  if system.place and system.place.reduced then
    error(what .. ": option 'generator' is for systems that are not reduced", 0)
  end
end

-- the matrix at a state, whether it is that of the motion as a function, and the rate along a
-- generator; kept: that the system can be linearised and what was traced, for the next state of the
-- same system and parameters
local function matrix_of(system, options, kept)
  kept = kept or {}
  options, system = starts.lists(options, system)
  local what = "system:linearize"
  option.check(options, { "q", "v", "p", "t", "generator" }, what, "{ q =, v = }")
  if options.v and options.p then error(what .. ": give the velocity v or the momentum p", 0) end
  local reduced = system.place and system.place.reduced
  if not reduced then option.need(options, "q", what, "the state is q and v (default: at rest)") end
  option.number(options, "t", what, nil, 0)
  if not kept.plain then check_plain(system, what) end
  kept.plain = true
  check_generator(options, system, what)
  local of = reduced and of_reduced or system.place and of_group or in_coordinates
  local A, is_constant, w = of(system, options, what, kept)
  check_matrix(A, what)
  if options.generator then
    w, is_constant = w or is_constant, function() return true end
  end
  return A, is_constant, w
end

--- What oscillates with coefficients as they are at the state, whatever the motion: { matrix,
-- frequencies = list, fastest }; kept: a table that one call leaves to the next, of the same system
-- and parameters.
function M.frozen(system, options, kept)
  local A = matrix_of(system, options, kept)
  local frequencies = select(2, A:eigenvalues()):totable()
  return { matrix = A, frequencies = frequencies, fastest = max(0, table.unpack(frequencies)) }
end

M.linearize = blame.caller(function(system, options)
  local A, is_constant, w = matrix_of(system, options)
  local out = result_of(A)
  out.frozen, out.rate = not is_constant(), w
  if out.frozen then
    out.stable = nil
    out.why = "frozen at this state, which moves on: " .. out.why:gsub("^unstable: ", "") .. ". Of "
      .. "a motion solver:multipliers and solver:lyapunov tell; a relative equilibrium needs its "
      .. "generator"
  end
  return out
end)

---- orbits ----

M.multipliers = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  local matrix, q, p = solver:tangent(options)
  local re, im = matrix:eigenvalues()
  local place = solver.system.place
  local largest, size, n = 0, 1, matrix.rows // 2
  for i = 1, 2 * n do
    largest = max(largest, sqrt(re[i] ^ 2 + im[i] ^ 2))
    for k = 1, 2 * n do size = max(size, abs(matrix[i][k])) end
  end
  local p0 = options.p or solver.system:legendre(options.q, options.v, options.t0 or 0)
  local closes = 0
  for i = 1, n do closes = max(closes, abs(p[i] - p0[i])) end
  if place then closes = max(closes, place.kit.distance(place.kit.element(options.q), q)) end
  for i = 1, place and 0 or n do closes = max(closes, abs(q[i] - options.q[i])) end
  local slack = max(1e-6, 10 * sqrt(2.2e-16 * size))
  local stable = largest <= 1 + slack
  local why = stable
    and ("no multiplier is outside of the unit circle (largest modulus %.9g, known to %.1g)")
      :format(largest, slack)
    or ("unstable: a small change grows by a factor of %.6g"):format(largest)
  if closes > slack then
    why = why .. ("; the run ends %.2g from its start, so they are those of a closed orbit only "
      .. "up to a symmetry"):format(closes)
  end
  return core.result { stable = stable, why = why, largest = largest, re = re, im = im,
    matrix = matrix, closes = closes }
end)

class.method("dm.system", "linearize", M.linearize, [[
system:linearize{q=, v= | p=, t=, generator=, a=} -> {stable, why, fastest, frequencies, rates, ...}
The system linearised at a state (v default 0, t default 0): d(dq, dv)/dt = matrix (dq, dv), with
real parts `rates` and imaginary parts `frequencies` of its eigenvalues. At an equilibrium, and at a
relative equilibrium with v along coordinates that L does not depend on, this is its linear
stability; anywhere else coefficients change along the motion: frozen is true, there is no `stable`,
and it is how fast the system oscillates there. At a relative equilibrium that is none of
coordinates, as a circle in x and y, generator = function(q) -> the velocity of the field of its
symmetry (path:momentum): the matrix is then that of what moves along, exact, and `rate` is how fast
the motion goes along the field. fastest: the largest frequency, which a step has to resolve. p
stands in place of v, too; of a system that has only H the matrix is that of (dq, dp). On a group
the changes are (g^-1 dg, dxi) (right trivialization: dg g^-1 where that is steady; of an H without
L dmu), and a generator gives the body velocity. There may be forces, controls (as they are at this
state), constraints and rolling: the matrix is then on an orthonormal basis of the changes that
these allow, as the tangent space of the constraints, and the state must be on them. Of a reduced
system (dm.euler_poincare; v or p, and a) it is that of (dxi, da), or (dmu, da) of an h.]])

class.method("dm.solver", "multipliers", M.multipliers, [[
solver:multipliers{q=, v= | p=, steps= | t=, t0=} -> {stable, why, largest, re, im, matrix, closes}
The eigenvalues of the exact tangent map over a run: the Floquet multipliers where the run is one
period of a periodic orbit (closes: the distance of its end from its start), or one step of a
relative equilibrium. A symplectic rule has them in pairs m, 1/m; stable: none has a modulus above 1
by more than round-off allows (multipliers 1 of the period and of symmetries are double, and known
to the root of round-off only).]])

return M
