--- The system linearised at a state, and the exact tangent map along an orbit: eigenvalues that say
-- whether small changes stay small.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local on_group = require "dm.measure.on_group"
local option = require "dm.base.options"
local starts = require "dm.base.start"
local tangent_space = require "dm.measure.tangent_space"

local M = {}

local abs, sqrt, max, huge = math.abs, math.sqrt, math.max, math.huge

-- L(q, v) at a fixed time as a traced function of both
local function traced(system, t)
  local given, n = system.given, system.Q.dimension
  local params = given.params
  return core.trace(function(q, v) return given.L(q, v, t, params) end, n, n)
end

-- d(q, v)/dt of a small change: M a = L_qq q + (L_qv - L_vq) v
local function field(system, q, v, t)
  local n = system.Q.dimension
  local H = traced(system, t):hessian(q, v)
  local mass, right = core.matrix(n, n), core.matrix(n, 2 * n)
  for i = 1, n do
    for k = 1, n do
      mass[i][k] = H[n + i][n + k]
      right[i][k] = H[i][k]
      right[i][n + k] = H[i][n + k] - H[n + i][k]
    end
  end
  local solved, out = mass:solve(right), core.matrix(2 * n, 2 * n)
  for i = 1, n do
    out[i][n + i] = 1
    for k = 1, 2 * n do out[n + i][k] = solved[i][k] end
  end
  return out
end

-- d(q, p)/dt of a small change, by the second derivatives of H
local function phase_field(system, q, p, t)
  local given, n = system.given, system.Q.dimension
  local S = core.trace(function(x, y) return given.H(x, y, t, given.params) end, n, n)
    :hessian(q, p)
  local out = core.matrix(2 * n, 2 * n)
  for i = 1, n do
    for k = 1, 2 * n do out[i][k], out[n + i][k] = S[n + i][k], -S[i][k] end
  end
  return out
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
  local bound = given.constraint or given.rolling or given.force or given.control
  if bound and not system.place then
    error(what .. ": for systems without constraints and forces; solver:multipliers has the "
      .. "tangent map of any", 0)
  end
  if system:structure().linear_in_v then
    error(what .. ": L has no term quadratic in v, so that no acceleration follows from it: its "
      .. "equations are not of second order", 0)
  end
end

local function describe(rates, frequencies)
  local fastest, growth = 0, 0
  for _, w in ipairs(frequencies) do fastest = max(fastest, w) end
  for _, s in ipairs(rates) do growth = max(growth, s) end
  local small = 1e-7 * max(fastest, growth)
  if growth > small then
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
  local stable, why, fastest = describe(re:totable(), im:totable())
  return core.result { stable = stable, why = why, fastest = fastest, rates = re, frequencies = im,
    matrix = A }
end

-- what the constraints leave of a matrix of changes
local function restricted(A, basis)
  local out = core.matrix(#basis, #basis)
  for k, y in ipairs(basis) do
    local moved = A * y
    for i, x in ipairs(basis) do out[i][k] = x:dot(moved) end
  end
  return out
end

-- of changes (g^-1 dg, dxi); of an H alone (g^-1 dg, dmu)
local function of_group(system, options, what)
  local place, t = system.place, options.t or 0
  local g, x = place.kit.element(options.q), options.v and core.vector(options.v)
  if not system.given.L then
    x = options.p and core.vector(options.p) or x and system:legendre(g, x, t)
  end
  x = x or core.zeros(place.dimension)
  local A = on_group.field(system, g, x, t)
  local rows = tangent_space.of_velocity(system, g, x, t)
  if #rows > 0 then A = restricted(A, tangent_space.basis(rows, place.dimension)) end
  check_matrix(A, what)
  return result_of(A)
end

M.linearize = blame.caller(function(system, options)
  options, system = starts.lists(options, system)
  local what = "system:linearize"
  local known = { "q", "v", "t" }
  if not system.given.L then known[4] = "p" end
  option.check(options, known, what, "{ q =, v = }")
  option.need(options, "q", what, "the state is q and v (default: at rest)")
  check_plain(system, what)
  if system.place then return of_group(system, options, what) end
  local n = system.Q.dimension
  local second = options.v or options.p
  if #options.q ~= n or second and #second ~= n then
    error(("%s: q and v have %d entries"):format(what, n), 0)
  end
  local q, v = core.vector(options.q), core.vector(options.v or core.zeros(n))
  local A = system.given.L and field(system, q, v, options.t or 0)
    or phase_field(system, q, momentum_of(system, options, q), options.t or 0)
  check_matrix(A, what)
  return result_of(A)
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
system:linearize{q=, v=, t=} -> {stable, why, fastest, frequencies, rates, matrix}
The system linearised at a state (v default 0, t default 0): d(dq, dv)/dt = matrix (dq, dv), with
real parts `rates` and imaginary parts `frequencies` of its eigenvalues. At an equilibrium, and at a
relative equilibrium (v along coordinates that L does not depend on), this is its linear stability;
anywhere else how fast the system oscillates there, frozen. fastest: the largest frequency, which a
step has to resolve. A system that has only H takes p in place of v, and its matrix is that of (dq,
dp). On a group the changes are (g^-1 dg, dxi) (right trivialization: dg g^-1; of an H without L
dmu), and there may be forces, controls, constraints and rolling: the matrix is then on an
orthonormal basis of the changes that these allow.]])

class.method("dm.solver", "multipliers", M.multipliers, [[
solver:multipliers{q=, v= | p=, steps= | t=, t0=} -> {stable, why, largest, re, im, matrix, closes}
The eigenvalues of the exact tangent map over a run: the Floquet multipliers where the run is one
period of a periodic orbit (closes: the distance of its end from its start), or one step of a
relative equilibrium. A symplectic rule has them in pairs m, 1/m; stable: none has a modulus above 1
by more than round-off allows (multipliers 1 of the period and of symmetries are double, and known
to the root of round-off only).]])

return M
