--- What reduction reads off a Lagrangian that does not depend on m of its coordinates, theta, as
-- graphs of (x, x', t):
--   momentum c + I theta' + C x', locked inertia I = L_theta'theta', C = L_theta'x',
--   connection A = I^-1 C, theta' = I^-1 (mu - L_theta'(x, x', 0)),
--   classical Routhian R = L(x, x', 0) - (mu - L_theta').I^-1 (mu - L_theta') / 2,
-- which is L - mu . theta' at the momentum mu (Marsden & Scheurle 1993) where L is quadratic in
-- theta'; dm.reduce.routh.quadratic has the rest.
local core = require "dm.core"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"

local M = {}

local count = lists.count

--- (theta, x) in the order of the system, from two lists; theta left out: zero.
function M.embed(info, x, theta)
  local q = {}
  for i, at in ipairs(info.shape) do q[at] = x[i] end
  for a, at in ipairs(info.cyclic) do q[at] = theta and theta[a] or 0 end
  return core.vector(q)
end

--- The entries of a full list that belong to the shape, and to the group.
function M.split(info, q)
  local x, theta = {}, {}
  for i, at in ipairs(info.shape) do x[i] = q[at] end
  for a, at in ipairs(info.cyclic) do theta[a] = q[at] end
  return x, theta
end

-- dL/d(q, v) and the rows dp_theta/d(q, v), traced
function M.derive(info)
  local n, L = info.n, info.L
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local rows = core.derivative(function(q, v, t)
    local g, out = slope(q, v, t), {}
    for a, at in ipairs(info.cyclic) do out[a] = g[n + at] end
    return core.vector(out)
  end, n, n, "number")
  return { slope = slope, rows = rows }
end

local function value_at_sample(info) return info.L(info.sample.q, info.sample.v, info.sample.t) end

--- The derivatives of L as it is now: traced again when a number that L uses has changed.
function M.derived(info)
  if info.fixed then return info.fixed end
  local kept = info.derived
  local now = value_at_sample(info)
  if not kept or kept.value ~= now then
    if not kept or kept.value then info.derived = M.derive(info) end
    info.derived.value = now
    info.shown = {}
  end
  return info.derived
end

--- p_theta at theta' = 0, I and C at (x, u, t), as lists.
function M.momentum_parts(info, x, u, t)
  local d, n = M.derived(info), info.n
  local q, v = M.embed(info, x), M.embed(info, u)
  local g, rows, c, I, C = d.slope(q, v, t), d.rows(q, v, t), {}, {}, {}
  for a, at in ipairs(info.cyclic) do
    c[a], I[a], C[a] = g[n + at], {}, {}
    for b, other in ipairs(info.cyclic) do I[a][b] = rows[a][n + other] end
    for j, other in ipairs(info.shape) do C[a][j] = rows[a][n + other] end
  end
  return c, I, C
end

--- Arguments of the implicit theta': t only where L depends on it, so that what does not is seen
-- not to.
function M.of_root(info, x, u, t)
  local mu = core.vector(info.mu)
  if info.autonomous then return core.vector(x), core.vector(u), mu end
  return core.vector(x), core.vector(u), mu, t
end

--- theta' at the momentum mu; where L is quadratic in theta' also mu - p_theta at theta' = 0.
function M.group_velocity(info, x, u, t)
  if info.root then return info.root(M.of_root(info, x, u, t)) end
  local c, I = M.momentum_parts(info, x, u, t)
  local rest = {}
  for a = 1, info.m do rest[a] = info.mu[a] - c[a] end
  if info.diagonal then return linear.solve_definite(I, rest, info.diagonal), rest end
  return linear.solve(I, { rest }, info.order)[1], rest
end

--- The classical Routhian: the stationary value of L - mu . theta' over theta'.
function M.routhian(info, x, u, t)
  if info.root then return info.root:value(M.of_root(info, x, u, t)) end
  local rate, rest = M.group_velocity(info, x, u, t)
  local sum, L = 0, info.L
  for a = 1, info.m do sum = sum + rest[a] * rate[a] end
  local R = L(M.embed(info, x), M.embed(info, u), t) - sum / 2
  if info.fixed then return R end
  return core.extremum(R, function(y, w, z, s)
    local value = L(M.embed(info, y), M.embed(info, w, z), s)
    for a = 1, info.m do value = value - info.mu[a] * z[a] end
    return value
  end, rate, x, u)
end

--- A(x, t) of the mechanical connection, m rows of d.
function M.mechanical_connection(info, x, t)
  local zero = {}
  for j = 1, info.d do zero[j] = 0 end
  local _, I, C = M.momentum_parts(info, x, zero, t)
  local columns = {}
  for j = 1, info.d do
    columns[j] = {}
    for a = 1, info.m do columns[j][a] = C[a][j] end
  end
  local solved, A = linear.solve(I, columns, info.order), {}
  for a = 1, info.m do
    A[a] = {}
    for j = 1, info.d do A[a][j] = solved[j][a] end
  end
  return A
end

--- The connection that was given, or the mechanical one, as lists; a group of one dimension may
-- leave out the outer list.
function M.connection(info, x, t)
  if not info.given_connection then return M.mechanical_connection(info, x, t) end
  local A = info.given_connection(core.vector(x), t)
  if info.m == 1 and count(A) and not count(A[1]) then A = { A } end
  local fits = count(A) == info.m
  for a = 1, fits and info.m or 0 do fits = fits and count(A[a]) == info.d end
  if not fits then
    error(("the connection must return %d row%s of %d numbers")
      :format(info.m, info.m == 1 and "" or "s", info.d), 0)
  end
  return A
end

return M
