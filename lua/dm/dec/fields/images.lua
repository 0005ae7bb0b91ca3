--- What is wrong with the values of a field on a mesh, cell by cell: images that are turned inside
-- out, neighbours that are opposite on a sphere. f: a field, { mesh, degree, values, cells, n }.
local option = require "dm.base.options"

local M = {}

--- Where the values are points of the mesh's own space: the first cell whose image is inverted or
-- degenerate, as its vertices; nothing where there is none.
function M.inverted(f, x)
  local K = f.mesh
  if f.degree > 0 or f.values ~= K.dimension or K.ambient ~= K.dimension then return nil end
  local rows, signs = {}, require "dm.dec.cell_map".signs
  for i = 1, f.cells do
    rows[i] = {}
    for c = 1, f.values do rows[i][c] = x[(i - 1) * f.values + c] end
  end
  local before, after = signs(K), signs(K, rows)
  for i = 1, #before do
    if before[i] ~= after[i] then return K:simplices(K.dimension)[i] end
  end
end

--- Raises where the values are unit vectors and those at the ends of an edge are opposite.
function M.check_opposite(f, x, where)
  local k = f.values
  for _, edge in ipairs(f.degree == 0 and f.mesh.dimension > 0 and f.mesh:simplices(1) or {}) do
    local product = 0
    for c = 1, k do product = product + x[(edge[1] - 1) * k + c] * x[(edge[2] - 1) * k + c] end
    if product < -1 + 1e-12 then
      option.fail(where, "neighbours opposite on the sphere: the values of the vertices {%d, %d} "
        .. "of an edge have no shortest way from one to the other; refine the mesh, or start from "
        .. "elsewhere", edge[1], edge[2])
    end
  end
end

return M
