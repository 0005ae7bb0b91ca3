--- T(n): vectors of n angles in rad.
local acts = require "dm.group.acts"
local circle = require "dm.group.so2"
local kits = require "dm.group.kit"
local core = require "dm.core"
local linear = require "dm.base.linear"

local M = {}

function M.kit(n)
  local kit = circle.circles(n)
  kit.acts = { translation = acts.translation(kit) }
  function kit.identity() return core.zeros(n) end
  function kit.element(g) return kits.vector(g, n, "the group element") end
  function kit.compose(a, b) return a + b end
  function kit.inverse(g) return -g end
  kit.matrix = circle.rotations
  kit.project = kit.log
  kit.raw = kit.element
  function kit.turns()
    local out = {}
    for k = 1, n do out[k] = linear.unit(n, k) * (2 * math.pi) end
    return out
  end
  return kits.complete(kit)
end

return M
