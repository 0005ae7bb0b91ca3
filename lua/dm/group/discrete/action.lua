--- The action of lie(s) between two elements of a group (Leok 5.3), its derivatives and the curve
-- on which it is stationary.
local bound = require "dm.base.bound"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local place = require "dm.group.place"

local M = {}

local WHERE = "dm.discrete_lagrangian"

local part = lists.part

---- maps and curves ----

-- The approximant pade(k) is cay(z(xi)). xi of z, by Newton's method with z' as a matrix, is there
-- for steps that are short enough for their rule.
local NEWTON = 8

local function of_pade(kit, k)
  local d = kit.dimension
  local function slope(xi)
    return linear.matrix_of(function(x)
      local _, dz = kit.pade(k, xi, x)
      return dz
    end, d)
  end
  local function back(g)
    local z, last = core.vector(kits.list_of(kit.cayleyinv(g))), nil
    local xi = z
    for _ = 1, NEWTON do
      last = slope(xi):solve(z - kit.pade(k, xi))
      xi = xi + last
    end
    local size = last:norm()
    if type(size) == "number" and not (size <= 1e-9 * (1 + xi:norm())) then
      error("no curve of this rule was found from g0 to g1: are they one step apart?", 0)
    end
    return xi
  end
  local function inverse(xi, eta)
    return slope(xi):solve(core.vector(kit.dcayinv((kit.pade(k, xi)), eta)))
  end
  return back, inverse, function(xi) return kit.cayley((kit.pade(k, xi))) end
end

--- xi of tau(xi), the inverse of the right-trivialized differential of tau, and tau itself.
function M.map(kit, tau)
  if tau == "exp" then return kit.log, kit.dexpinv, kit.exp end
  local k = tonumber(tau:match "^pade%((%d)%)$")
  if k then return of_pade(kit, k) end
  return kit.cayleyinv, kit.dcayinv, kit.cayley
end

--- The map of a rule lie(s), and a, d, b, c, beta of its curves, those of galerkin on R^n.
function M.curves(rule)
  local inside = tostring(rule):match "^lie%s*%((.*)%)$"
  if not inside then
    error(("%s: on groups rule must be lie(s [, quadrature] [, exp | cayley | pade(k)]) (got %s)")
      :format(WHERE, tostring(rule)), 0)
  end
  local cut, tau = inside:match "^(.*),%s*(%a+)%s*$"
  if not tau then cut, tau = inside:match "^(.*),%s*(pade%(%s*%d%s*%))%s*$" end
  inside, tau = cut or inside, tau and tau:gsub("%s", "") or "exp"
  local s, quadrature = inside:match "^%s*(%d+)%s*,%s*(.-)%s*$"
  s = s or inside:match "^%s*(%d+)%s*$"
  local line = core.system { Q = core.R(1), L = function(_, v) return v[1] * v[1] / 2 end }
  local text = ("galerkin(%s, %s)"):format(s, quadrature or "gauss(" .. s .. ")")
  local c = core.discrete_lagrangian(line, { rule = text, h = 1 })
  return tau == "pade(1)" and "cayley" or tau, c:coefficients()
end

-- F(q0, e, x, u, t) = L(g0 near(e) tau(x), dtau_L(x) u, t): L at a point x of a curve with x' = u
local function at_point(Ld, L, tau)
  local P, N, d = Ld.place, Ld.place.size, Ld.place.dimension
  local chart = place.chart(P, tau)
  if not chart then error(("%s: %s has no map '%s'"):format(WHERE, tostring(Ld.Q), tau), 0) end
  return function(q0, e, x, u, t)
    local y = chart(q0, e, x, u)
    return L(P.element(part(y, 0, N)), part(y, N, d), t)
  end
end

-- sum_j row[j] V_j, of vectors of d entries
local function combined(row, V, d)
  local sum = core.zeros(d)
  for j = 1, #row do sum = sum + part(V, (j - 1) * d, d) * row[j] end
  return sum
end

--- The action S(q0, e, V, h) = h sum_i b_i F(q0, e, h sum_j a_ij V_j, sum_j d_ij V_j, c_i h) of a
-- step of length h from the time 0 by the rule of Ld, lie(s): what solves for its ends otherwise
-- (reduce/mechanical) differentiates `value`, of whatever h, so that steps of several lengths have
-- one graph. inverse: that of the right-trivialized differential of tau.
function M.action(Ld)
  local kit, given, d = kits.of(Ld.Q), Ld.system.given, Ld.place.dimension
  local tau, c = M.curves(Ld.rule)
  local _, inverse = M.map(kit, tau)
  local F = at_point(Ld, bound(given.L, given.params), tau)
  local function value(q0, e, V, h)
    local sum = 0
    for i = 1, #c.b do
      sum = sum + h * c.b[i] * F(q0, e, combined(c.a[i], V, d) * h, combined(c.d[i], V, d),
        c.c[i] * h)
    end
    return sum
  end
  return { value = value, coefficients = c, stages = #c.beta, tau = tau, inverse = inverse }
end

-- the matrix with the rows f(w), w a unit vector each
local function row_by_row(n, f)
  local rows = {}
  for k = 1, n do
    local w = core.zeros(n)
    w[k] = 1
    rows[k] = f(w)
  end
  return core.matrix(rows)
end

--- The action of L with its derivatives by z = (e, V), of those of F by (e, x, u): these are linear
-- in z at each point, and rows of F's second derivative are slopes of w . F', so that neither the
-- points nor the dimension of G multiply the graph (exp on SL(3) with three points is beyond its
-- limit).
function M.derived(Ld, L, tau, c)
  local N, d, h, F = Ld.place.size, Ld.place.dimension, Ld.h, at_point(Ld, L, tau)
  local f = core.trace(F, N, d, d, d, "number")
  local slope = core.derivative(f, N, d, d, d, "number")
  local row = core.derivative(function(q0, e, x, u, t, w)
    return w:dot(part(slope(q0, e, x, u, t), N, 3 * d))
  end, N, d, d, d, "number", 3 * d)
  -- (e, x, u) at point i by (e, V)
  local by_z = {}
  for i = 1, #c.b do
    by_z[i] = linear.fill(3 * d, (#c.beta + 1) * d, function(k, l)
      local block, j = (k - 1) // d, (l - 1) // d
      if (k - l) % d ~= 0 or (block == 0) ~= (j == 0) then return 0 end
      return block == 0 and 1 or block == 1 and h * c.a[i][j] or c.d[i][j]
    end)
  end
  local zero = core.zeros(d)
  local function sum_over(q0, V, t, term)
    local sum
    for i = 1, #c.b do
      local x, u = combined(c.a[i], V, d) * h, combined(c.d[i], V, d)
      local added = term(by_z[i], q0, zero, x, u, t + c.c[i] * h) * (h * c.b[i])
      sum = sum and sum + added or added
    end
    return sum
  end
  local S = {}
  function S.value(q0, V, t)
    return sum_over(q0, V, t, function(_, ...) return f(...) end)
  end
  function S.gradient(q0, V, t)
    return sum_over(q0, V, t, function(C, ...)
      return C:transpose() * part(slope(...), N, 3 * d)
    end)
  end
  function S.hessian(q0, V, t)
    return sum_over(q0, V, t, function(C, ...)
      local q, e, x, u, time = ...
      local H = row_by_row(3 * d, function(w) return part(row(q, e, x, u, time, w), N, 3 * d) end)
      return C:transpose() * H * C
    end)
  end
  return S
end

--- The matrix of the equations below for (V, S_1), of the second derivatives of S.
function M.slope_of_stationary(H, c, h, d)
  local m = #c.beta * d
  local J = core.zeros(m + d, m + d):totable()
  for k = 1, m do
    local hb, a = h * c.beta[(k - 1) // d + 1], (k - 1) % d + 1
    for l = 1, m do J[k][l] = H[d + k][d + l] end
    J[k][m + a], J[m + a][k] = -hb, hb
  end
  return core.matrix(J)
end

local SHRINKS = 0.1  -- of an increment: one matrix is kept while they shrink so fast

--- V and S_1 with dS/dV_j = h beta_j S_1 and h sum_j beta_j V_j = xi, by Newton's method.
function M.stationary(S, c, h, q0, xi, t)
  local d = #xi
  local m, last, J = #c.beta * d, math.huge, nil
  local z = core.zeros(m + d)
  for k = 1, m do z[k] = xi[(k - 1) % d + 1] / h end
  local function residual(V)
    local G, R = S.gradient(q0, V, t), core.zeros(m + d)
    for a = 1, d do R[m + a] = -xi[a] end
    for k = 1, m do
      local hb, a = h * c.beta[(k - 1) // d + 1], (k - 1) % d + 1
      R[k], R[m + a] = G[d + k] - hb * z[m + a], R[m + a] + hb * V[k]
    end
    return R
  end
  for _ = 1, 30 do
    local V = part(z, 0, m)
    J = J or M.slope_of_stationary(S.hessian(q0, V, t), c, h, d)
    local change = J:solve(residual(V))
    z = z - change
    local size = change:norm()
    if size ~= size or size >= last and size < 1e-9 * (1 + z:norm()) then break end
    if size > SHRINKS * last then J = nil end
    last = size
    if size == 0 then break end
  end
  if not (last < 1e-9 * (1 + z:norm())) then
    error("no curve of this rule was found from g0 to g1: are they one step apart?", 0)
  end
  return part(z, 0, m), part(z, m, d)
end

--- The matrix of dtau^-1(xi)^T mu by xi, a row at a time, as a function of (xi, mu); made when it
-- is first asked for.
function M.slope_of_transport(inverse, d)
  local row
  local function make()
    local along = core.derivative(function(xi, x, mu) return mu:dot(inverse(xi, x)) end, d, d, d)
    return core.derivative(function(xi, mu, w)
      return w:dot(part(along(xi, core.zeros(d), mu), d, d))
    end, d, d, d)
  end
  return function(xi, mu)
    row = row or make()
    return row_by_row(d, function(w) return part(row(xi, mu, w), 0, d) end)
  end
end

return M
