-- momenta on groups so small or large that their squares are no numbers are refused, in runs and
-- members; up to there the unit of mass changes nothing
local tap = require "tap"
local dm = require "dm"

local spaces = { dm.SO(3), dm.SE(3), dm.product(dm.SO(3), dm.R(2)), dm.Heisenberg(1) }
for _, G in ipairs(spaces) do
  local d = G.dimension
  local function of(c)
    local p = {}
    for i = 1, d do p[i] = c * (0.3 + 0.1 * i) * math.sin(i) end
    return dm.system { Q = G, L = function(_, xi)
      local sum = 0
      for i = 1, d do sum = sum + (1 + 0.3 * i) * xi[i] ^ 2 / 2 end
      return c * sum
    end }, p
  end
  for _, rule in ipairs { "gauss(2)", "midpoint", "verlet", "lie(2)" } do
    local function ends(c)
      local system, p = of(c)
      return system:solver { rule = rule, h = 0.1 }
        :run { q = G:identity(), p = p, steps = 5 }.q[6]
    end
    local name = ("%s, %s: "):format(tostring(G), rule)
    for _, c in ipairs { 1e-95, 1e95 } do
      tap.near(G:distance(ends(1), ends(c)), 0, 1e-12, name .. "masses of " .. c)
    end
    for _, c in ipairs { 1e-170, 1e-155, 1e155, 1e170 } do
      tap.raises("take other units of mass", ends, c)
    end
  end
end
local tiny = dm.system { Q = dm.SO(3), L = function(_, xi) return 1e-170 * xi:dot(xi) end }
tap.raises("member 2: no start: the momentum is", function()
  return tiny:solver { rule = "gauss(2)", h = 0.1 }:ensemble { members = 3, steps = 2,
    q = function() return dm.SO(3):identity() end,
    v = function(i) return { i == 1 and 0 or 1, 0, 0 } end }
end)
tap.done()
