--- Is L quadratic in theta'? Then theta' is eliminated by a linear system in the graph; else it is an implicit function, dm.root.
local core = require "dm.core"
local model = require "dm.routh_model"

local M = {}

--- Does the locked inertia not change with theta'?
function M.is(info)
  local rows = model.derived(info).rows
  local n = info.n
  for _, p in ipairs(info.points) do
    local v = {}
    for i = 1, n do v[i] = p.v[i] end
    for a, i in ipairs(info.cyclic) do v[i] = v[i] + 0.31 + 0.17 * a end
    local fine, one, two = pcall(function() return rows(p.q, p.v, p.t), rows(p.q, core.vector(v), p.t) end)
    for a = 1, fine and info.m or 0 do
      for _, i in ipairs(info.cyclic) do
        local x, y = one[a][n + i], two[a][n + i]
        if math.abs(x - y) > 1e-10 * math.max(1, math.abs(x)) then return false end
      end
    end
  end
  return true
end

-- velocities of the group to begin Newton's method with: at rest, and those of the points that were looked at
local function starts(info)
  local out = { {} }
  for a = 1, info.m do out[1][a] = 0 end
  for k = 1, math.min(4, #info.points) do
    local _, rate = model.split(info, info.points[k].v)
    out[k + 1] = rate
  end
  return out
end

--- theta'(x, x', mu, t), where L - mu . theta' is stationary; its value is the classical Routhian.
function M.root(info)
  local L = info.L
  return core.root { name = "velocity of the group at this momentum", unknowns = info.m, start = starts(info),
    stationary = function(y, x, u, mu, t)
      local value = L(model.embed(info, x), model.embed(info, u, y), t or 0)
      for a = 1, info.m do value = value - mu[a] * y[a] end
      return value
    end }
end

return M
