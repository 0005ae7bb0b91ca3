--- R(n): translations; elements are vectors.
local acts = require "dm.group.acts"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = class.module(function() return require "dm.base.linear" end)

local M = {}

local function first(_, eta) return eta end

function M.kit(n)
  local kit = { dimension = n, abelian = true, vectors = true, euclidean = true, exp = core.vector,
    log = core.vector, cayley = core.vector, cayleyinv = core.vector,
    Ad = first, coAd = first, dexp = first, dexpinv = first, dcay = first, dcayinv = first }
  function kit.identity() return core.zeros(n) end
  function kit.element(g) return kits.vector(g, n, "the group element") end
  function kit.compose(a, b) return a + b end
  function kit.inverse(g) return -g end
  function kit.ad() return core.zeros(n) end
  local function homogeneous(x, corner)
    return linear.fill(n + 1, n + 1, function(i, j)
      if j == n + 1 and i <= n then return x[i] end
      return i == j and corner or 0
    end)
  end
  function kit.matrix(g) return homogeneous(g, 1) end
  function kit.hat(xi) return homogeneous(xi, 0) end
  function kit.vee(m) return m:column(n + 1):slice(1, n) end
  kit.from_matrix = kit.vee
  kit.raw = kit.element
  local function turned(x, p) return core.vector { x[1] * p[2] - x[2] * p[1] } end
  kit.momenta = { ["R^" .. n] = first, ["SO(2)"] = (n == 2 or n == 3) and turned or nil,
    ["SO(3)"] = n == 3 and function(x, p) return x:cross(p) end or nil }
  kit.acts = { translation = acts.translation(kit) }
  return kits.complete(kit)
end

return M
