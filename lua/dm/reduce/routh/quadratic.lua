--- Is L quadratic in theta'? Then theta' is eliminated by a linear system in the graph; else it is
-- an implicit function, dm.root.
local blame = require "dm.base.blame"
local core = require "dm.core"
local model = require "dm.reduce.routh.model"

local M = {}

--- Does the locked inertia not change with theta'?
function M.is(info)
  local rows = model.derived(info).rows
  local n = info.n
  for _, p in ipairs(info.points) do
    local v = {}
    for i = 1, n do v[i] = p.v[i] end
    for a, i in ipairs(info.cyclic) do v[i] = v[i] + 0.31 + 0.17 * a end
    local fine, one, two = blame.try(function()
      return rows(p.q, p.v, p.t), rows(p.q, core.vector(v), p.t)
    end)
    for a = 1, fine and info.m or 0 do
      for _, i in ipairs(info.cyclic) do
        local x, y = one[a][n + i], two[a][n + i]
        if math.abs(x - y) > 1e-10 * math.max(1, math.abs(x)) then return false end
      end
    end
  end
  return true
end

-- velocities of the group to begin Newton's method with: one that is known (M.branch), at rest, and
-- those of the points that were looked at
local function starts(info)
  local out = { info.rate or {} }
  for a = 1, info.rate and 0 or info.m do out[1][a] = 0 end
  for k = 1, math.min(4, #info.points) do
    local _, rate = model.split(info, info.points[k].v)
    out[k + 1] = rate
  end
  return out
end

--- theta'(x, x', mu, t), where L - mu . theta' is stationary; its value is the classical Routhian.
function M.root(info)
  local L = info.L
  return core.root { name = "velocity of the group at this momentum", unknowns = info.m,
    start = starts(info),
    stationary = function(y, x, u, mu, t)
      local value = L(model.embed(info, x), model.embed(info, u, y), t or 0)
      for a = 1, info.m do value = value - mu[a] * y[a] end
      return value
    end }
end

--- Is theta' at the momentum mu the one of this state, not another with the same momentum?
function M.is_branch(info, q, v, t)
  local x, u = model.split(info, q), nil
  local rate
  u, rate = model.split(info, v)
  local fine, found = blame.try(model.group_velocity, info, core.vector(x), core.vector(u), t or 0)
  for a = 1, fine and info.m or 0 do
    if math.abs(found[a] - rate[a]) > 1e-5 * math.max(math.abs(rate[a]), math.abs(found[a])) then
      return false, rate
    end
  end
  return true
end

--- The root on the branch of a start: where L is not convex in theta' several velocities have its
-- momentum.
function M.branch(info, start)
  local fine, rate = M.is_branch(info, start.q, start.v)
  if fine then return end
  info.rate = rate
  info.root = M.root(info)
  if not M.is_branch(info, start.q, start.v) then
    error("L is not convex in the velocity of the group: several have the momentum of this "
      .. "start, and the one of the start is not found again", 0)
  end
end

return M
