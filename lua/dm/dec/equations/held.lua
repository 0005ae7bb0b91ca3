--- Where a function is held at 0, so that Laplace's operator can be inverted: on the boundary, and
-- at one vertex of every component that has none, since there it is known up to a constant.
local core = require "dm.core"
local mass = require "dm.dec.equations.mass"

local M = {}

--- Marks of the vertices that are solved for; for each vertex the number of its component, from 1,
-- if the component holds none by itself, else 0 (both dm.vector); how many such components there
-- are. free: the boundary is not held.
function M.of(K, free)
  local of, edge, held = K:component_of(), K:boundary_marks(0), {}
  local solved, component, number, count = mass.ones(K, 0), core.vector(K:count(0)), {}, 0
  for i = 1, #of do
    if edge[i] ~= 0 and not free then held[of[i]], solved[i] = true, 0 end
  end
  for i = 1, #of do
    local c = of[i]
    if not held[c] then
      if not number[c] then
        count = count + 1
        number[c], solved[i] = count, 0
      end
      component[i] = number[c]
    end
  end
  return solved, component, count
end

--- A load whose sum over each of these components is 0: what is too much is taken away in
-- proportion to weights[vertex], as a constant density is.
function M.balanced(b, component, count, weights)
  if count == 0 then return b end
  local sum, area = {}, {}
  for c = 1, count do sum[c], area[c] = 0, 0 end
  for i = 1, #b do
    local c = component[i]
    if c > 0 then sum[c], area[c] = sum[c] + b[i], area[c] + weights[i] end
  end
  return b:map(function(value, i)
    local c = component[i]
    return c > 0 and value - weights[i] * (sum[c] / area[c]) or value
  end)
end

--- x without its means over these components, with weights[vertex].
function M.without_means(x, component, count, weights)
  if count == 0 then return x end
  local sum, area = {}, {}
  for c = 1, count do sum[c], area[c] = 0, 0 end
  for i = 1, #x do
    local c = component[i]
    if c > 0 then sum[c], area[c] = sum[c] + weights[i] * x[i], area[c] + weights[i] end
  end
  return x:map(function(value, i)
    local c = component[i]
    return c > 0 and value - sum[c] / area[c] or value
  end)
end

return M
