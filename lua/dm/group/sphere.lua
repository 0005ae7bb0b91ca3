--- S(n): unit vectors of R^(n+1); a manifold, not a group.
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

function M.kit(n)
  local kit = { dimension = n, coordinates = n + 1, manifold = true, entries = kits.list_of, rebuild = core.vector }
  function kit.element(g) return kits.vector(g, n + 1, "the point") end
  kit.raw = kit.element
  kit.flat, kit.unflat = kit.entries, kit.rebuild
  function kit.bonds(list)
    local sum = -1
    for i = 1, n + 1 do sum = sum + list[i] * list[i] end
    return { sum }
  end
  function kit.defect(z) return math.abs(z:norm() - 1) end
  function kit.project(z)
    local size = z:norm()
    if type(size) == "number" and not (size > 0) then error("the zero vector is near no point of the sphere", 0) end
    return z * (1 / size)
  end
  function kit.sample(stream, i) return kit.project(kits.normals(stream, i, n + 1, 1)) end
  -- the angle: 2 atan2(|a - b|, |a + b|) has all digits at 0 and at pi
  function kit.distance(a, b) return 2 * core.atan(kits.norm(a - b), kits.norm(a + b)) end
  return kit
end

return M
