--- Linearization and tangent maps of systems on groups, in the left trivialization: a change of g
-- is u = g^-1 dg, of the body momentum dp.
local core = require "dm.core"
local lists = require "dm.base.lists"
local bound = require "dm.base.bound"
local place = require "dm.group.place"

local M = {}

local abs, max = math.abs, math.max

-- L(g, xi, t) with params bound; this file needs the body velocity and nothing but L
local function lagrangian(system, what)
  local given = system.given
  if system.place.right then
    error(what .. ": on groups with the left trivialization only", 0)
  end
  if given.constraint or given.rolling or given.force then
    error(what .. ": on groups without constraints and forces only", 0)
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

--- The matrix of d(u, dxi)/dt at (g, xi): u' = dxi - ad_xi u and the change of d/dt L_xi =
-- coad(xi, L_xi) + L_g along (u, dxi), with coefficients frozen there.
function M.field(system, q, v, t, what)
  local L, kit, d = lagrangian(system, what), system.place.kit, system.place.dimension
  local g, xi = kit.element(q), core.vector(v)
  local p = system:legendre(g, xi, t)
  local H = hessian(system, L, g, xi, t)
  local gg, xg, xx = block(H, d, 0, d), block(H, 2 * d, 0, d), block(H, 2 * d, 2 * d, d)
  local ad = matrix_of(function(u) return kit.ad(xi, u) end, d)
  local coad = matrix_of(function(mu) return kit.coad(xi, mu) end, d)
  local turned = matrix_of(function(x) return kit.coad(x, p) end, d)
  local of_u = gg + coad * xg + xg * ad
  local of_x = turned + coad * xx + xg:transpose() - xg
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

-- The tangent group T G is the semidirect product of G and its algebra by Ad, (g, w) with w = Ad_g
-- u; its exp is the tangent of exp, so lie(s) steps the prolonged Lagrangian
--   L~(g, w; xi, omega) = L_g . u + L_xi . omega,   omega = u' + [xi, u] = Ad_(g^-1) w'
-- by the tangent of its step of L. Momenta: (dp, p).
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
  return core.system { L = lifted,
    Q = core.semidirect(system.Q, core.R(d), function(g, w) return kit.Ad(g, w) end) }
end

-- (u, dp) of the lifted state in row i of a path
local function tangent_of(path, i, kit, d)
  local z, p = path.q[i], path.p[i]
  local u = kit.Ad(kit.inverse(z[1]), z[2])
  return lists.joined(u, lists.part(p, 0, d))
end

--- Where the unit vectors of (u, dp) lead, and the end of the run.
function M.columns(solver, start, what)
  local system = solver.system
  local kit, d = system.place.kit, system.place.dimension
  local g = kit.element(start.q)
  local p = start.p or system:legendre(g, start.v, start.t0)
  local lifted = prolonged(system, what):solver { rule = solver.rule, h = solver.h,
    newton = { tolerance = solver.tolerance, max_iterations = solver.max_iterations } }
  local first, out, last = {}, {}, nil
  for k = 1, 2 * d do
    local u, dp = core.zeros(d), lists.zeros(d)
    if k <= d then u[k] = 1 else dp[k - d] = 1 end
    last = lifted:run { q = { g, kit.Ad(g, u) }, p = lists.joined(dp, p), t0 = start.t0,
      steps = start.steps, every = max(start.steps, 1) }
    first[k], out[k] = tangent_of(last, 1, kit, d), tangent_of(last, #last, kit, d)
  end
  local q, mu = last.q[#last][1], core.vector(lists.part(last.p[#last], d, d))
  return out, first, q, mu, core.vector(p)
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
