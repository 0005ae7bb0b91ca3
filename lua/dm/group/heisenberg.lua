--- Heisenberg(n): (x, y, z), x and y of n entries, with (a, b, c)(x, y, z) = (a + x, b + y, c + z +
-- (a . y - b . x)/2): in these coordinates exp is the identity.
local acts = require "dm.group.acts"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"

local M = {}

-- a . y - b . x of (a, b, c), (x, y, z)
local function area(g, h, n)
  local sum = 0
  for i = 1, n do sum = sum + g[i] * h[n + i] - g[n + i] * h[i] end
  return sum
end

-- v with s added to its last entry
local function lifted(v, s)
  local out = kits.list_of(v)
  out[#out] = out[#out] + s
  return core.vector(out)
end

local function half_product(g, n)
  local sum = 0
  for i = 1, n do sum = sum + g[i] * g[n + i] end
  return 0.5 * sum
end

-- {{1, x, z + x . y/2}, {0, 1, y}, {0, 0, 1}}; of the algebra without the ones and the product
local function matrix(g, n, one, corner)
  return linear.fill(n + 2, n + 2, function(i, j)
    if i == j then return one end
    if i == 1 then return j == n + 2 and corner or g[j - 1] end
    return j == n + 2 and i <= n + 1 and g[n + i - 1] or 0
  end)
end

function M.kit(n)
  local r = 2 * n + 1
  local kit = { dimension = r, vectors = true, exp = core.vector, log = core.vector,
    cayley = core.vector, cayleyinv = core.vector }
  function kit.identity() return core.zeros(r) end
  function kit.element(g) return kits.vector(g, r, "the group element") end
  kit.raw = kit.element
  function kit.compose(a, b) return lifted(a + b, 0.5 * area(a, b, n)) end
  function kit.inverse(g) return -g end
  function kit.Ad(g, xi) return lifted(xi, area(g, xi, n)) end
  function kit.ad(xi, eta) return lifted(core.zeros(r), area(xi, eta, n)) end
  kit.acts = { translation = acts.translation(kit) }
  -- ad^2 = 0: exp and the Cayley map agree
  function kit.dexp(xi, eta) return lifted(eta, 0.5 * area(xi, eta, n)) end
  function kit.dexpinv(xi, eta) return lifted(eta, -0.5 * area(xi, eta, n)) end
  kit.dcay, kit.dcayinv = kit.dexp, kit.dexpinv
  function kit.matrix(g) return matrix(g, n, 1, g[r] + half_product(g, n)) end
  function kit.hat(xi) return matrix(xi, n, 0, xi[r]) end
  function kit.vee(m)
    local out = {}
    for i = 1, n do out[i], out[n + i] = m[1][i + 1], m[i + 1][n + 2] end
    out[r] = m[1][n + 2]
    return core.vector(out)
  end
  function kit.from_matrix(m)
    local g = kit.vee(m)
    return lifted(g, -half_product(g, n))
  end
  return kits.complete(kit)
end

return M
