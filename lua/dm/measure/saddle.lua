--- The Lagrangian that rules step (src/mech/saddle.h): of a mass M that is singular by itself and
-- regular with the constraints L + kappa/2 sum_c w_c^2, kappa = |M| / |A_c|^2, w = (G v + g_t,
-- phi), A = (G; dphi/dv); else L itself.
local lists = require "dm.base.lists"

local M = {}

-- sum of squares of a list of rows
local function square(rows, first, last)
  local sum = 0
  for _, row in ipairs(rows) do
    for k = first, last do sum = sum + row[k] ^ 2 end
  end
  return sum
end

-- |M| as a function of (q, v, t)
local function size_of_mass(L, n)
  local core = require "dm.core"
  local slope = core.derivative(L, n, n, "number")
  local curve = core.derivative(function(q, v, t) return lists.part(slope(q, v, t), n, n) end,
    n, n, "number")
  return function(q, v, t)
    local rows, H = {}, curve(q, v, t)
    for i = 1, n do rows[i] = H[i] end
    return square(rows, n + 1, 2 * n) ^ 0.5
  end
end

-- sum_c w_c^2 / |A_c|^2 of g(q, t), whose w is its change along v, or, holonomic = false, of
-- phi(q, v, t)
local function share(f, n, holonomic)
  local core = require "dm.core"
  local function value(q, v, t)
    if holonomic then return core.vector(lists.entries(f(q, t))) end
    return core.vector(lists.entries(f(q, v, t)))
  end
  local slope = core.derivative(value, n, n, "number")
  local first = holonomic and 0 or n
  return function(q, v, t)
    local J, w, sum = slope(q, v, t), value(q, v, t), 0
    for c = 1, #w do
      local rate = holonomic and J[c][2 * n + 1] or w[c]
      for k = 1, holonomic and n or 0 do rate = rate + J[c][k] * v[k] end
      sum = sum + rate ^ 2 / square({ J[c] }, first + 1, first + n)
    end
    return sum
  end
end

--- That Lagrangian of a system as a function of (q, v, t): L, constraint and rolling with their
-- params bound, or nil.
function M.lagrangian(system, L, constraint, rolling)
  if not system:structure().saddle then return L end
  local n = system.Q.dimension
  local function all(q, v, t) return L(q, v, t) end
  local size = size_of_mass(all, n)
  local shares = {}
  if constraint then shares[#shares + 1] = share(constraint, n, true) end
  if rolling then shares[#shares + 1] = share(rolling, n, false) end
  return function(q, v, t)
    local sum = 0
    for _, one in ipairs(shares) do sum = sum + one(q, v, t) end
    return L(q, v, t) + size(q, v, t) * sum / 2
  end
end

return M
