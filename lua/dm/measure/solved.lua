--- The Ld of a stage rule as a function of (q0, q1, h) that numbers and symbols go through: the
-- value of h sum_i b_i L(q0 + h sum_j a_ij V_j, sum_j d_ij V_j) where that is stationary in the
-- velocities V_j with h sum_j beta_j V_j = q1 - q0. Unknown are the differences y_j of all V_j but
-- one from w = (q1 - q0)/h.
local core = require "dm.core"

local M = {}

-- the stage whose velocity the others leave: one of the largest weights
local function last_of(beta)
  local best = 1
  for j = 2, #beta do if math.abs(beta[j]) > math.abs(beta[best]) then best = j end end
  return best
end

-- V_j as lists of n entries, from w and y[(s - 1) n]
local function velocities(c, n, last, w, y)
  local V, at = {}, 0
  V[last] = {}
  for k = 1, n do V[last][k] = w[k] end
  for j = 1, #c.beta do
    if j ~= last then
      V[j] = {}
      for k = 1, n do
        local d = y[at + k]
        V[j][k] = w[k] + d
        V[last][k] = V[last][k] - c.beta[j] / c.beta[last] * d
      end
      at = at + n
    end
  end
  return V
end

-- sum_j row[j] V_j, from `start` on
local function combined(row, V, n, start, h)
  local out = {}
  for k = 1, n do
    local sum = 0
    for j = 1, #V do if row[j] ~= 0 then sum = sum + row[j] * V[j][k] end end
    out[k] = start and start[k] + h * sum or sum
  end
  return core.vector(out)
end

--- f(q0, q1, h) for the coefficients { a, d, b, beta } of a rule and L(q, v) on n coordinates.
function M.formula(c, L, n)
  local last = last_of(c.beta)
  local function action(y, q0, q1, h)
    local w, sum = {}, 0
    for k = 1, n do w[k] = (q1[k] - q0[k]) / h end
    local V = velocities(c, n, last, w, y)
    for i = 1, #c.b do
      local q, v = combined(c.a[i], V, n, q0, h), combined(c.d[i], V, n)
      sum = sum + c.b[i] * L(q, v)
    end
    return h * sum
  end
  local unknowns = (#c.beta - 1) * n
  if unknowns == 0 then return function(q0, q1, h) return action({}, q0, q1, h) end end
  local solve = core.root { stationary = action, unknowns = unknowns, name = "stages of Ld" }
  return function(q0, q1, h) return action(solve(q0, q1, h), q0, q1, h) end
end

return M
