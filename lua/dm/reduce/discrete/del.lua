--- The discrete Routh equations of a formula Ld(q0, q1), stepped in C: they are the discrete
-- Euler-Lagrange equations of the discrete Routhian W(x0, x1) = Ld(x0, x1, psi) - mu . psi, which
-- is stationary in psi at psi_mu: an implicit function in its graph (dm.root).
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"

local M = {}

-- W -> the discrete shape it belongs to
local known = setmetatable({}, { __mode = "k" })

--- The discrete shape of a path of its solver, or nothing.
function M.of(system) return known[system] end

-- the points of Ld over the shapes x0, x1
local function lifted(info, x0, x1, psi)
  local q0, q1 = model.embed(info, x0), model.embed(info, x1, psi)
  if not info.ambient then return q0, q1 end
  return info.ambient.chart(q0), info.ambient.chart(q1)
end

-- h theta' of the straight line from x0 to x1, where it has a formula
local function straight(D)
  local info, h = D.info, D.h
  return function(x0, x1)
    return core.vector((model.group_velocity(info, (x0 + x1) / 2, (x1 - x0) / h, 0)))
  end
end

local function start_of(D)
  if D.info.root then
    local out = {}
    for a = 1, D.info.m do out[a] = 0 end
    return out
  end
  local rate, h = straight(D), D.h
  return function(x0, x1) return h * rate(x0, x1) end
end

local function make(D)
  local info, Ld = D.info, D.Ld
  local f, h, params, mu = Ld.Ld, Ld.h, Ld.params, info.mu
  local psi = core.root { name = "psi_mu (is the step too long for this momentum?)",
    unknowns = info.m, start = start_of(D),
    stationary = function(y, x0, x1)
      local q0, q1 = lifted(info, x0, x1, y)
      local value = f(q0, q1, h, params)
      for a = 1, info.m do value = value - mu[a] * y[a] end
      return value
    end }
  local W = core.discrete_lagrangian { Q = core.R(info.d), h = h, coordinates = D.shape.coordinates,
    name = "discrete Routhian", constraint = D.constraint,
    Ld = function(x0, x1) return psi:value(x0, x1) end }
  known[W], D.implicit = D, psi
  return W
end

function M.solver(D, options)
  if not D.Ld.Ld then
    local own = lists.copy(options or {})
    own.rule, own.h = own.rule or D.Ld.rule, own.h or D.h
    return D.shape:solver(own)
  end
  D.W = D.W or make(D)
  return D.W:solver(options)
end

-- the unreduced state over the first row, whose momentum is not -D1 Ld where there are constraints
local function first_state(info, path, theta)
  local q, p = model.embed(info, path.q[1], theta), model.embed(info, path.p[1], info.mu)
  if not info.ambient then return q, p end
  return info.ambient.point(q, p)
end

-- columns of the unreduced path: psi_mu is added from row to row
local function columns_of(D, path, theta)
  local info = D.info
  local n, out, sum = info.n, { path:column "t" }, {}
  for c = 2, 2 * n + 1 do out[c] = {} end
  for a = 1, info.m do sum[a] = theta[a] end
  local function put(k, q, p)
    for i = 1, n do out[1 + i][k], out[1 + n + i][k] = q[i], p[i] end
  end
  local before = path.q[1]
  for k = 2, #path do
    local psi = D.implicit(before, path.q[k])
    local q0 = model.embed(info, before, sum)
    for a = 1, info.m do sum[a] = sum[a] + psi[a] end
    local q1 = model.embed(info, path.q[k], sum)
    if info.ambient then q0, q1 = info.ambient.chart(q0), info.ambient.chart(q1) end
    local p0, p1 = D.slopes(q0, q1)
    if k == 2 and not D.constraint then put(1, q0, p0) end
    if k == 2 and D.constraint then put(1, first_state(info, path, theta)) end
    put(k, q1, p1)
    before = path.q[k]
  end
  return out
end

--- The unreduced path over a path of the solver above.
function M.reconstruct(D, path, theta)
  if #path ~= path.steps + 1 or #path < 2 then
    error("path:reconstruct: psi_mu leads from one step to the next, so every step must have "
      .. "been kept (every = 1)", 0)
  end
  local info = D.info
  return core.path { system = info.ambient and info.ambient.system or info.full, h = path.h,
    rule = path.rule, steps = path.steps,
    columns = columns_of(D, path, theta) }
end

return M
