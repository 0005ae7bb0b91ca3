--- From discrete to continuous (Leok 4.5.2): A(v_q) = d/dt A_d(q, q(t)), in a trivialization
--   Ad_g (AA(x) x' + g^-1 g'),   AA_a(x) = d/dx1^a log A(x, x1) at x1 = x,
-- its curvature, and what variations of a pair do to its two components.
local bundles = require "dm.connection.bundle"
local connections = require "dm.connection"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"

local M = {}

local method = connections.method

-- the function `name` of the connection, made when it is first asked for
local function kept(own, name, make)
  if not own[name] then own[name] = make(own) end
  return own[name]
end

-- (x, y) -> derivatives of log(A(x, x*)^-1 A(x, y)) at x* = y, d x n: A^-1 dA along the second
-- point
local function slope_of(own)
  local B, kit = own.bundle, own.bundle.kit
  local f = core.derivative(function(x, at, y)
    return core.vector(kit.log(kit.compose(kit.inverse(own.local_form(x, at)),
      own.local_form(x, y))))
  end, B.n, B.n, B.n)
  return function(x, y)
    local J = f(x, y, y)
    return linear.fill(B.d, B.n, function(i, j) return J[i][2 * B.n + j] end)
  end
end

--- AA(x), d x n, and the derivative of A(x, y) along y as A^-1 dA; numbers or symbols.
function M.slope(own, x, y) return kept(own, "slope", slope_of)(x, y) end

local function matrix(own, x)
  local out = M.slope(own, x, x)
  for i = 1, out.rows do
    if not kits.is_finite(out[i]) then
      error(("A:continuous: there is no value at x = %s"):format(bundles.show(x)), 0)
    end
  end
  return out
end

method("continuous", function(A, x)
  return matrix(A.own, bundles.base_point(A.own.bundle, x, "x"))
end, [[
A:continuous(x) -> dm.matrix, dim G x dim S
The continuous connection AA(x) that A_d tends to: A(v) = Ad_g (AA(x) x' + g^-1 g'), column a the
derivative of log A(x, x1) along x1^a at x1 = x. x may hold symbols.]])

-- (n d) entries of AA, column by column, as a function with derivatives
local function slopes_of_matrix(own)
  local B = own.bundle
  return core.derivative(function(x)
    local AA, out = M.slope(own, x, x), {}
    for j = 1, B.n do
      for i = 1, B.d do out[#out + 1] = AA[i][j] end
    end
    return core.vector(out)
  end, B.n)
end

local function direction(B, i, name)
  if math.type(i) == "integer" and i >= 1 and i <= B.n then return i end
  error(("A:curvature(x, i, j): %s must be a whole number from 1 to %d, a direction of the base "
    .. "(got %s)"):format(name, B.n, tostring(i)), 0)
end

method("curvature", function(A, x, i, j)
  local own, B = A.own, A.own.bundle
  x, i, j = bundles.base_point(B, x, "x"), direction(B, i, "i"), direction(B, j, "j")
  local AA, J, d = matrix(own, x), kept(own, "slopes", slopes_of_matrix)(x), B.d
  local bracket, out = B.kit.ad(AA:column(i), AA:column(j)), {}
  for a = 1, d do
    -- one row where d n is 1: then i = j
    out[a] = i == j and 0 or J[(j - 1) * d + a][i] - J[(i - 1) * d + a][j] - bracket[a]
  end
  return core.vector(out)
end, [[
A:curvature(x, i, j) -> dm.vector of dim G entries
That of the continuous connection, d_i AA_j - d_j AA_i - [AA_i, AA_j]. log(holonomy)/area of a small
loop in the plane (i, j), from i to j, tends to minus this: of a few steps where A(x1, x0) is the
inverse of A(x0, x1), else of many.]])

method("variation", function(A, q0, q1, dq1)
  local own, B, kit = A.own, A.own.bundle, A.own.bundle.kit
  if A.raw then
    error("A:variation: a raw connection has no components that compose: take raw = false", 0)
  end
  q0, q1 = B.take(q0, "q0"), B.take(q1, "q1")
  if type(dq1) ~= "table" or #dq1 ~= 2 then
    error("A:variation: dq1 must be a list { dx, eta }, eta = g^-1 dg of the algebra", 0)
  end
  local dx = kits.vector(dq1[1], B.n, "dq1: dx")
  local eta = kits.vector(dq1[2], B.d, "dq1: eta = g^-1 dg")
  local g = own.local_form(q0[1], q1[1])
  local alpha = M.slope(own, q0[1], q1[1]) * dx
  return core.result { core.zeros(B.n), kit.Ad(kit.inverse(g), eta) + alpha },
    core.result { dx, -kit.Ad(g, alpha) }
end, [[
A:variation(q0, q1, {dx, eta}) -> vertical, horizontal
What a variation of q1 (eta = g1^-1 dg1, an algebra vector) does to the second points of ver(q0, q1)
and hor(q0, q1): { 0, Ad_(A^-1) eta + a } and { dx, -Ad_A a }, a = A^-1 dA along dx, lists of the
same kind as dq1; eta = Ad_A eta_v + eta_h.]])

return M
