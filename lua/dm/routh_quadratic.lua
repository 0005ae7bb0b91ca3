--- Is L quadratic in theta'? Then theta' is eliminated by a linear system in the graph.
local core = require "dm.core"
local model = require "dm.routh_model"

local M = {}

-- does the locked inertia change with theta'?
local function varies(info)
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
        if math.abs(x - y) > 1e-10 * math.max(1, math.abs(x)) then return p end
      end
    end
  end
end

--- Raises where it is not.
function M.check(info)
  local p = varies(info)
  if p then
    error("L is not quadratic in the velocity of the group (its locked inertia changes with it, near "
      .. require "dm.routh_check".at(p) .. "), so the momentum is no linear equation for it", 0)
  end
end

return M
