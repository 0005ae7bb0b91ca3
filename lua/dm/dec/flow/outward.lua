--- Which way a surface faces: closed surfaces in space outwards, others as they are oriented.
local M = {}

-- six times the volume between a triangle and the origin
local function volume(a, b, c)
  return a[1] * (b[2] * c[3] - b[3] * c[2]) - a[2] * (b[1] * c[3] - b[3] * c[1])
    + a[3] * (b[1] * c[2] - b[2] * c[1])
end

-- component number -> true where it has a boundary
local function open_components(K, of)
  local edge, open = K:boundary_marks(0), {}
  for i = 1, #of do
    if edge[i] ~= 0 then open[of[i]] = true end
  end
  return open
end

--- Signs of the triangles of a surface, a dm.vector: its coherent orientation, turned on closed
-- components in space that enclose a negative volume. Raises where there is none.
function M.signs(K)
  local ones = K:volume(2):map(function() return 1 end)
  local signs = K:oriented(ones)
  if K.ambient ~= 3 then return signs end
  local of, points, cells = K:component_of(), {}, K:simplices(2)
  local all, open, sum = K:points(), open_components(K, of), {}
  for i = 1, K:count(0) do points[i] = all[i]:totable() end
  for i, cell in ipairs(cells) do
    local a, b, c = points[cell[1]], points[cell[2]], points[cell[3]]
    local component = of[cell[1]]
    sum[component] = (sum[component] or 0) + signs[i] * volume(a, b, c)
  end
  for i, cell in ipairs(cells) do
    local component = of[cell[1]]
    if not open[component] and sum[component] < 0 then signs[i] = -signs[i] end
  end
  return signs
end

return M
