--- Lagrangians linear in v, L = alpha(q, t) . v - H(q, t), for methods that need a regular one:
-- their equations Omega q' = -H_q - alpha_t, Omega_ij = d alpha_i/dq_j - d alpha_j/dq_i, are
-- q' = f(q, t), whose solutions are those of q'' = f_q q' + f_t with q' = f at the start. That is
-- L = v . v / 2 with a force; along it q' - f(q, t) stays what it was, 0.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"

local M = {}

-- coordinates and operations of the force: beyond them there is no such form
local MANY, LARGEST = 16, 20000

-- alpha(q, t) and f(q, t), traced; q of n numbers
local function fields(L, n)
  local slope = core.derivative(L, n, n, "number")
  local second = core.derivative(core.trace(function(q, v, t) return slope(q, v, t) end, n, n,
    "number"), n, n, "number")
  local still = {}
  for i = 1, n do still[i] = 0 end
  local function alpha(q, t)
    local g, out = slope(q, core.vector(still), t), {}
    for i = 1, n do out[i] = g[n + i] end
    return core.vector(out)
  end
  local function f(q, t)
    local v = core.vector(still)
    local g, H, omega, right = slope(q, v, t), second(q, v, t), {}, {}
    for i = 1, n do
      omega[i], right[i] = {}, g[i] - H[n + i][2 * n + 1]
      for j = 1, n do omega[i][j] = H[n + i][j] - H[n + j][i] end
    end
    return core.matrix(omega):solve(core.vector(right))
  end
  return core.trace(alpha, n, "number"), core.trace(f, n, "number")
end

-- f_q v + f_t as a force
local function force_of(f, n)
  local change = core.derivative(f, n, "number")
  return core.trace(function(q, v, t)
    local D, out = change(q, t), {}
    for i = 1, n do
      out[i] = D[i][n + 1]
      for j = 1, n do out[i] = out[i] + D[i][j] * v[j] end
    end
    return core.vector(out)
  end, n, n, "number")
end

-- what is watched of (q, v, t, p), with p = alpha(q, t)
local function watch_of(watch, alpha)
  local out = watch and {}
  for name, g in pairs(watch or {}) do
    assert(type(g) == "function")
    out[name] = function(q, v, t) return g(q, v, t, alpha(q, t)) end
  end
  return out
end

local function is_finite(list)
  for i = 1, #list do
    if list[i] - list[i] ~= 0 then return false end
  end
  return true
end

local function form(system, start, t0, watch)
  local given, n = system.given, system.Q.dimension
  assert(n <= MANY)
  local alpha, f = fields(bound(given.L, given.params), n)
  local v, force = f(start.q, t0), force_of(f, n)
  assert(is_finite(v) and force:operations() <= LARGEST)
  return { system = core.system { Q = system.Q, coordinates = system.coordinates,
    L = function(_, u) return u:dot(u) / 2 end,
    force = function(q, u, t) return force(q, u, t) end },
    start = { q = start.q, v = v }, watch = watch_of(watch, alpha) }
end

--- { system =, start =, watch = } with the same motion, of a system whose L is linear in v and
-- which has nothing beside it; nil where there is no such form. p of it is v.
function M.of(system, start, t0, watch)
  local fine, s = blame.try(system.structure, system)
  if not fine or not (s.linear_in_v and system.given.L and start.q) or s.forced
    or s.constraints + s.rolling > 0 then
    return nil
  end
  local made, out = blame.try(form, system, start, t0, watch)
  return made and out or nil
end

return M
