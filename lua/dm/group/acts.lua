--- Standard actions of groups on vectors, as they stand in the field `acts` of a kit: a function of
-- m that gives map(g, z) on R^m, or nothing where the group does not act there.
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local function head(z, m) return core.vector(z):slice(1, m) end

-- (z, 1)
local function with_one(z)
  local out = core.vector(z):totable()
  out[#out + 1] = 1
  return core.vector(out)
end

--- g z of n x n matrices.
function M.linear(kit, n)
  return function(m)
    if m == n then return function(g, z) return kit.matrix(g) * z end end
  end
end

--- R z + a of the homogeneous matrices {{R, a}, {0, 1}}, n = m.
function M.affine(kit, n)
  return function(m)
    if m == n then return function(g, z) return head(kit.matrix(g) * with_one(z), m) end end
  end
end

--- (A z + b)/(c . z + d) of the n x n matrices {{A, b}, {c, d}}, m = n - 1.
function M.projective(kit, n)
  return function(m)
    if m ~= n - 1 then return nil end
    return function(g, z)
      local y = kit.matrix(g) * with_one(z)
      return head(y, m) * (1 / y[n])
    end
  end
end

--- What turns Y = (2 w, |w|^2 - 1), rotations of S^m seen from its north pole in the plane of its
-- equator: w' = Y'_1..m/(1 + |w|^2 - Y'_(m+1)). turn(m) gives a function of (g, Y), a list, or nil.
function M.stereographic(turn)
  return function(m)
    local turned = turn(m)
    if not turned then return nil end
    return function(g, w)
      local n = core.vector(w):dot(w)
      local Y = kits.list_of(core.vector(w) * 2)
      Y[m + 1] = n - 1
      Y = turned(g, Y)
      return head(Y, m) * (1 / (1 + n - Y[m + 1]))
    end
  end
end

--- The standard actions of n x n rotations: on R^n, and on S^(n-1) seen from its pole.
function M.rotations(kit, n)
  return { linear = M.linear(kit, n), stereographic = M.stereographic(function(m)
    if m == n - 1 then return function(g, Y) return kit.matrix(g) * core.vector(Y) end end
  end) }
end

--- The group on itself from the left, where its elements are vectors.
function M.translation(kit)
  return function(m)
    if m == kit.dimension then return function(g, z) return kit.compose(g, z) end end
  end
end

return M
