--- What a discrete Lagrangian is the stationary value of. A formula Ld(q0, q1) is its own value.
-- That of a stage rule is stationary in inner variables w, its velocities V_j but one (Leok 2.4):
--   A(q0, q1, w) = h sum_i b_i L(Q_i, Qdot_i),   Q_i = q0 + h sum_j a_ij V_j,
--   Qdot_i = sum_j d_ij V_j,   h sum_j beta_j V_j = q1 - q0.
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local function of_formula(Ld)
  local f, h, given = Ld.Ld, Ld.h, Ld.params
  return { inner = 0, value = function(q0, q1) return f(q0, q1, h, given) end,
    start = function() return {} end }
end

-- sum_j weights[j] V_j
local function mean(weights, V)
  local sum = weights[1] * V[1]
  for j = 2, #V do sum = sum + weights[j] * V[j] end
  return sum
end

-- which of these is the largest
local function largest(x)
  local best = 1
  for j = 2, #x do if math.abs(x[j]) > math.abs(x[best]) then best = j end end
  return best
end

-- all velocities, that of the largest beta by the end q1 of the curve
local function velocities(beta, last, q0, q1, w, h)
  local n, V, sum, k = #q0, {}, (q1 - q0) / h, 0
  for j = 1, #beta do
    if j ~= last then
      V[j], k = lists.part(w, k * n, n), k + 1
      sum = sum - beta[j] * V[j]
    end
  end
  V[last] = sum / beta[last]
  return V
end

local function of_rule(Ld)
  local n, h, c = Ld.Q.dimension, Ld.h, Ld:coefficients()
  local given, s, last = Ld.system.given, #c.beta, largest(c.beta)
  local L = bound(given.L, given.params)
  local function value(q0, q1, w)
    local V, sum = velocities(c.beta, last, q0, q1, w, h), 0
    for i = 1, #c.b do
      sum = sum + h * c.b[i] * L(q0 + h * mean(c.a[i], V), mean(c.d[i], V), 0)
    end
    return sum
  end
  local function start(q0, q1) -- along the straight line
    local w = {}
    for k = 0, s - 2 do for i = 1, n do w[k * n + i] = (q1[i] - q0[i]) / h end end
    return w
  end
  return { inner = (s - 1) * n, value = value, start = start }
end

--- { inner = number of inner variables, value(q0, q1, w), start(q0, q1) -> w, slope(q0, q1, w) ->
-- derivatives of the value in all arguments }; w is nil where there are none.
function M.of(Ld)
  local A, n = Ld.Ld and of_formula(Ld) or of_rule(Ld), Ld.Q.dimension
  local sizes = A.inner > 0 and { n, n, A.inner } or { n, n }
  local slope = core.derivative(A.value, table.unpack(sizes))
  function A.slope(q0, q1, w)
    if w == nil then return slope(q0, q1) end
    return slope(q0, q1, w)
  end
  return A
end

return M
