--- Linearization and tangent maps of systems on groups, in the left trivialization: a change of g
-- is u = g^-1 dg, of the body momentum dp.
local core = require "dm.core"
local lists = require "dm.base.lists"
local bound = require "dm.base.bound"
local flats = require "dm.group.flat"
local kits = require "dm.group.kit"
local place = require "dm.group.place"
local steps = require "dm.group.step"

local M = {}

local abs, max = math.abs, math.max

-- L(g, xi, t) with params bound; this file needs the body velocity and nothing but L
local function lagrangian(system, what, forced)
  local given = system.given
  if system.place.right then
    error(what .. ": on groups with the left trivialization only", 0)
  end
  if given.constraint or given.rolling then
    error(what .. ": on groups without constraints only", 0)
  end
  if given.force and not forced or given.control then
    error(what .. ": by rules of the chart on groups without forces only; gauss(s), lobatto(s) and "
      .. "other rules of coordinates take forces, but no controls", 0)
  end
  if not given.L then
    error(what .. ": this H has no Lagrangian; rules that go by the lift, gauss(s) and midpoint, "
      .. "do without", 0)
  end
  return bound(given.L, given.params)
end

--- The place of the same group with entries of matrices for coordinates, which elements have at
-- once.
local function entries_of(system)
  local side = system.place.right and "right" or "left"
  return place.of(system.Q, { columns = "matrix", trivialization = side })
end
M.entries_of = entries_of

---- the system linearized at a state ----

-- second derivatives of L(g near(a) near(b), xi) at a = b = 0: that in a, b is one left-invariant
-- field after the other
local function hessian(system, L, g, xi, t)
  local P, d = entries_of(system), system.place.dimension
  local q = P.flat(g)
  return core.trace(function(a, b, x)
    return L(P.element(P.carry(P.carry(q, P.near(a)), P.near(b))), x, t)
  end, d, d, d):hessian(core.zeros(d), core.zeros(d), xi)
end

-- rows and columns of a part of a matrix
local function block(H, first, second, d)
  local out = core.matrix(d, d)
  for i = 1, d do
    for k = 1, d do out[i][k] = H[first + i][second + k] end
  end
  return out
end

local function matrix_of(f, d)
  local out = core.matrix(d, d)
  for k = 1, d do
    local unit = core.zeros(d)
    unit[k] = 1
    local column = f(unit)
    for i = 1, d do out[i][k] = column[i] end
  end
  return out
end

-- derivatives of a torque f(g near(a), xi, t) by a and by xi; nothing without one
local function torque_slopes(system, g, xi, t)
  local given, d = system.given, system.place.dimension
  if not given.force then return end
  local P, f = entries_of(system), bound(given.force, given.params)
  local q = P.flat(g)
  local J = core.derivative(function(a, x)
    return core.vector(f(P.element(P.carry(q, P.near(a))), x, t))
  end, d, d)(core.zeros(d), xi)
  return block(J, 0, 0, d), block(J, 0, d, d)
end

--- The matrix of d(u, dxi)/dt at (g, xi): u' = dxi - ad_xi u and the change of d/dt L_xi =
-- coad(xi, L_xi) + L_g + f along (u, dxi), with coefficients frozen there.
function M.field(system, q, v, t, what)
  local L, kit, d = lagrangian(system, what, true), system.place.kit, system.place.dimension
  local g, xi = kit.element(q), core.vector(v)
  local p = system:legendre(g, xi, t)
  local H = hessian(system, L, g, xi, t)
  local gg, xg, xx = block(H, d, 0, d), block(H, 2 * d, 0, d), block(H, 2 * d, 2 * d, d)
  local ad = matrix_of(function(u) return kit.ad(xi, u) end, d)
  local coad = matrix_of(function(mu) return kit.coad(xi, mu) end, d)
  local turned = matrix_of(function(x) return kit.coad(x, p) end, d)
  local of_u = gg + coad * xg + xg * ad
  local of_x = turned + coad * xx + xg:transpose() - xg
  local fu, fx = torque_slopes(system, g, xi, t)
  if fu then of_u, of_x = of_u + fu, of_x + fx end
  local su, sx, out = xx:solve(of_u), xx:solve(of_x), core.matrix(2 * d, 2 * d)
  for i = 1, d do
    for k = 1, d do
      out[i][k], out[i][d + k] = -ad[i][k], i == k and 1 or 0
      out[d + i][k], out[d + i][d + k] = su[i][k], sx[i][k]
    end
  end
  return out
end

---- tangent maps ----

-- The Cayley map of T G is the tangent of that of G: (xi, omega) goes to (cay xi, w) with w =
-- dcay_xi omega; and g' g^-1 = a = dcay_xi eta, w' - [a, w] is its right-trivialized differential.
local function give_cayley(tangent, own)
  local kit, d = own.kit, own.dimension
  local along = core.derivative(kit.dcay, d, d)
  local function split(x) return lists.part(x, 0, d), lists.part(x, d, d) end
  function tangent.cayley(x)
    local xi, omega = split(x)
    return { kit.cayley(xi), kit.dcay(xi, omega) }
  end
  function tangent.dcay(x, rate)
    local xi, omega = split(x)
    local eta, nu = split(rate)
    local a, moved, slope = kit.dcay(xi, eta), kit.dcay(xi, nu), along(xi, omega)
    local turned = kit.ad(a, kit.dcay(xi, omega))
    for i = 1, d do
      for k = 1, d do moved[i] = moved[i] + slope[i][k] * eta[k] end
    end
    return lists.joined(a, moved - turned)
  end
  function tangent.smooth.cayley(x)
    local xi, omega = split(x)
    return kits.list_of(lists.joined(own.cayley(xi), kit.dcay(xi, omega)))
  end
end

-- The tangent group T G is the semidirect product of G and its algebra by Ad, (g, w) with w = Ad_g
-- u; its exp is the tangent of exp, so rules of the group step the prolonged Lagrangian
--   L~(g, w; xi, omega) = L_g . u + L_xi . omega,   omega = u' + [xi, u] = Ad_(g^-1) w'
-- by the tangent of their step of L. Momenta: (dp, p).
local function prolonged(system, what)
  local L, P, d = lagrangian(system, what), entries_of(system), system.place.dimension
  local kit, N = system.place.kit, P.size
  local slope = core.derivative(function(q, e, xi, t)
    return L(P.element(P.carry(q, P.near(e))), xi, t)
  end, N, d, d, "number")
  local function lifted(z, x, t)
    local u = kit.Ad(kit.inverse(z[1]), z[2])
    local xi, sum = core.vector(lists.part(x, 0, d)), 0
    local y = slope(core.vector(P.flat(z[1])), core.zeros(d), xi, t)
    for k = 1, d do sum = sum + y[N + k] * u[k] + y[N + d + k] * x[d + k] end
    return sum
  end
  local Q = core.semidirect(system.Q, core.R(d), function(g, w) return kit.Ad(g, w) end)
  if kit.cayley and kit.dcay and not kit.no_cayley then give_cayley(kits.of(Q), system.place) end
  return core.system { L = lifted, Q = Q }
end

local function newton(solver)
  return { tolerance = solver.tolerance, max_iterations = solver.max_iterations }
end

-- (u, dp) of the lifted state in row i of a path
local function tangent_of(path, i, kit, d)
  local z, p = path.q[i], path.p[i]
  local u = kit.Ad(kit.inverse(z[1]), z[2])
  return lists.joined(u, lists.part(p, 0, d))
end

-- a run on the tangent group, whose chart is longer than that of the group
local function run_prolonged(solver, lifted, options, what)
  local fine, path = pcall(lifted.run, lifted, options)
  if fine then return path end
  local why = type(path) == "string" and path
  if why and (why:find "too many to trace" or why:find "stays on it") then
    error(("%s: '%s' steps the tangent group of %s for that, and %s; gauss(s) has a tangent map by "
      .. "the collective lift, where the group has one"):format(what, tostring(solver.rule),
      tostring(solver.system.Q), why:find "stays" and "that has no such map"
      or "its chart is too long to trace (lie(s, cayley) has a shorter one)"), 0)
  end
  error(path, 0)
end

-- along(s, steps, vectors): where the vectors (u, dp) at the state s = { q, p, t } lead in so many
-- steps; s becomes the end
local function by_prolonging(solver, what)
  local system = solver.system
  local kit, d = system.place.kit, system.place.dimension
  local lifted = prolonged(system, what)
    :solver { rule = solver.rule, h = solver.h, newton = newton(solver) }
  return function(s, steps, vectors)
    local out, last = {}, nil
    for k, w in ipairs(vectors) do
      last = run_prolonged(solver, lifted, {
        q = { s.q, kit.Ad(s.q, core.vector(lists.part(w, 0, d))) },
        p = lists.joined(lists.part(w, d, d), s.p), t0 = s.t, steps = steps,
        every = max(steps, 1) }, what)
      out[k] = tangent_of(last, #last, kit, d)
    end
    s.q, s.p = last.q[#last][1], core.vector(lists.part(last.p[#last], d, d))
    s.t = s.t + steps * solver.h
    return out
  end
end

---- by a lift, whose tangent map is that of coordinates ----

-- a change of (q, p) from one (u, dp) of the group, at a state above it, and back
local function between(own, to, J)
  local N, d = own.size, own.dimension
  local X = flats.directions(own, N, d)
  local rise, descend = core.derivative(to, N, d), core.derivative(J, N, N)
  local function velocity(q, z)
    local Y = X(q)
    return (Y:transpose() * Y):solve(Y:transpose() * z)
  end
  local function up(q, mu, w)
    local dq = X(q) * lists.part(w, 0, d)
    return lists.joined(dq, rise(q, mu) * lists.joined(dq, lists.part(w, d, d)))
  end
  local function down(q, p, z)
    local below, moved = J(q, p), descend(q, p) * z
    local u = velocity(lists.part(below, 0, N), lists.part(moved, 0, N))
    return lists.joined(u, lists.part(moved, N, d))
  end
  return up, down
end

-- H(q, J(q, p), t) on T*R^N (mech/group_lift.c); p of least length, and (q, J) of a state
local function collective(system)
  local own, m = system.place, steps.functions_of(system)
  local X = flats.directions(own, own.size, own.dimension)
  local function J(q, p) return X(q):transpose() * p end
  local function H(q, p, t) return m.H(own.element(q), J(q, p), t) end
  return core.system { Q = core.R(own.size), H = H },
    function(q, mu)
      local at = X(q)
      return at * (at:transpose() * at):solve(core.vector(mu))
    end,
    function(q, p) return lists.joined(q, J(q, p)) end
end

-- the system that does not see multiples of q (mech/group_homogeneous.c)
local function homogeneous(system)
  local own, given = system.place, system.given
  local N, d = own.size, own.dimension
  local rates, momenta = place.homogeneous(own)
  local slope = core.derivative(function(q, v)
    return lists.part(rates(q, v), N, d)
  end, N, N)
  local function pulled(q, f)
    local S, out = slope(q, core.zeros(N)), {}
    for i = 1, N do
      out[i] = 0
      for a = 1, d do out[i] = out[i] + S[a][N + i] * f[a] end
    end
    return core.vector(out)
  end
  local options, f = { Q = core.R(N) }, given.force and bound(given.force, given.params)
  local L, H = bound(given.L, given.params), bound(given.H, given.params)
  function options.L(q, v, t)
    local r = rates(q, v)
    local sum = L(own.element(lists.part(r, 0, N)), lists.part(r, N, d), t)
    for k = 1, own.scales do sum = sum + 0.5 * r[N + d + k] * r[N + d + k] end
    return sum
  end
  function options.force(q, v, t)
    local r = rates(q, v)
    return pulled(q, f(own.element(lists.part(r, 0, N)), lists.part(r, N, d), t))
  end
  function options.H(q, p, t)
    local r = momenta(q, p)
    return H(own.element(lists.part(r, 0, N)), lists.part(r, N, d), t)
  end
  options.force = f and options.force or nil
  options[given.L and "H" or "L"] = nil
  return core.system(options), pulled,
    function(q, p) return lists.part(momenta(q, p), 0, N + d) end
end

local LIFTS = { collective = collective, homogeneous = homogeneous }

--- The system on R^N that the rule of a solver steps by a lift (solver.lift), to(q, mu) -> p of
-- flat coordinates on the group, and down(q, p) -> these and mu, one after the other.
function M.lifted(solver) return LIFTS[solver.lift](solver.system) end

local function by_lift(solver, what)
  local system, own = solver.system, solver.system.place
  local N, d = own.size, own.dimension
  if system.given.constraint or system.given.rolling then
    error(what .. ": on groups without constraints only", 0)
  end
  local lifted, to, J = M.lifted(solver)
  local up, down = between(own, to, J)
  local runs = lifted:solver { rule = solver.rule, h = solver.h, newton = newton(solver) }
  return function(s, count, vectors)
    local q = core.vector(own.flat(s.q))
    local p = core.vector(to(q, s.p))
    local D, q1, p1 = runs:tangent { q = q, p = p, t0 = s.t, steps = count }
    local out = {}
    for k, w in ipairs(vectors) do out[k] = down(q1, p1, D * up(q, s.p, w)) end
    local z = J(q1, p1)
    s.q, s.p = own.element(lists.part(z, 0, N)), lists.part(z, N, d)
    s.t = s.t + count * solver.h
    return out
  end
end

-- does the rule step groups by itself?
local function steps_groups(rule)
  local name = tostring(rule):match "^[%w%-]+"
  for _, row in ipairs(core.rules()) do
    if row.name == name then return row.on_groups end
  end
  return type(rule) ~= "string" and not rule.stages
end

--- The tangent map of a solver on a group, along(s, steps, vectors).
function M.map(solver, what)
  if solver.system.place.right then
    error(what .. ": on groups with the left trivialization only", 0)
  end
  if steps_groups(solver.rule) then return by_prolonging(solver, what) end
  return by_lift(solver, what)
end

-- unit vectors of (u, dp)
local function units(d)
  local out = {}
  for k = 1, 2 * d do
    out[k] = lists.zeros(2 * d)
    out[k][k] = 1
  end
  return out
end

-- the momentum of v; a reduced system keeps the quantity that this run carries along, where a call
-- from outside would take the usual one
local function momentum(system, g, v, t)
  local reduced = system.place.reduced
  local a = reduced and reduced.a
  local p = system:legendre(g, v, t)
  if reduced then reduced.a = a end
  return p
end

--- The state that options of a run begin at.
function M.start(system, start)
  local g = system.place.kit.element(start.q)
  local p = start.p or momentum(system, g, start.v, start.t0)
  return { q = g, p = core.vector(p), t = start.t0 or 0 }
end

--- Where the unit vectors of (u, dp) lead, these, the end of the run, the momentum at its start.
function M.columns(solver, start, what)
  local s, first = M.start(solver.system, start), units(solver.system.place.dimension)
  local p = s.p
  local out = M.map(solver, what)(s, start.steps, first)
  return out, first, s.q, s.p, p
end

--- The two-form <dp', u> - <dp, u'> + <p, [u, u']> between two tangent vectors at momentum p.
function M.form(kit, p, a, b)
  local d, sum = kit.dimension, 0
  for i = 1, d do sum = sum + a[i] * b[d + i] - a[d + i] * b[i] end
  local bracket = kit.ad(core.vector(lists.part(a, 0, d)), core.vector(lists.part(b, 0, d)))
  return sum + core.vector(p):dot(bracket)
end

--- What the two-form changed by over a run, over the square of the largest entry.
function M.defect(solver, start, what)
  local kit = solver.system.place.kit
  local out, first, _, p1, p0 = M.columns(solver, start, what)
  local worst, size = 0, 1
  for a = 1, #out do
    for i = 1, #out do size = max(size, abs(out[a][i])) end
    for b = 1, #out do
      local change = M.form(kit, p1, out[a], out[b]) - M.form(kit, p0, first[a], first[b])
      worst = max(worst, abs(change))
    end
  end
  return worst / size ^ 2
end

return M
