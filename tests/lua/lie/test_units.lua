-- momenta on groups so small or large that their squares are no numbers are refused, in runs and
-- members; up to there the unit of mass changes nothing, nor does that of time
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

-- units of time: the same steps, seen with another clock
local G = dm.SO(3)
local function inertia(w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end
local clocks = {
  ["a torque"] = { G, function(g, w, T) return inertia(w) - g[3][3] / T ^ 2 end,
    force = function(g, w, T) return { -0.1 * w[1] / T, 0.2 / T ^ 2, g[1][1] / T ^ 2 } end },
  ["an inertia that sees g"] = { G, function(g, w, T)
    return (2 + g[1][1]) * inertia(w) - g[3][3] / T ^ 2
  end },
  ["a quartic mass"] = { G, function(g, w, T) return inertia(w) ^ 2 * T ^ 2 - g[3][3] / T ^ 2 end },
  ["a rolling condition"] = { G, function(g, w, T) return inertia(w) - g[1][2] / T ^ 2 end,
    rolling = function(_, w) return { w[3] - 0.2 * w[1] } end },
  ["the plane"] = { dm.SE(2), function(g, w, T) return inertia(w) - (g[1] ^ 2 + g[3] * g[2]) / T ^ 2 end },
}
for name, case in pairs(clocks) do
  for _, rule in ipairs { "lie(1)", "lie(1, lobatto(2))", "lie(1, gauss(1), cayley)", "lie(2)" } do
    local function ends(T)
      return dm.system { Q = case[1], L = function(g, w) return case[2](g, w, T) end,
        rolling = case.rolling,
        force = case.force and function(g, w) return case.force(g, w, T) end }
        :solver { rule = rule, h = 0.05 * T }
        :run { q = case[1]:exp { 0.4, 0, 0 }, v = { 0.2 / T, 0.1 / T, 0.04 / T }, steps = 5 }.q[6]
    end
    local one = ends(1)
    for _, T in ipairs { 0x1p-200, 0x1p-69, 0x1p69, 0x1p200 } do
      tap.near(case[1]:distance(ends(T), one), 0, 1e-14, ("%s, %s: clocks of %g"):format(rule, name, T))
    end
  end
end
-- masses of a quartic L, whose inverse Legendre transform begins at p
for _, Q in ipairs { G, dm.R(3) } do
  local function ends(c)
    local path = dm.system { Q = Q, L = function(_, w) return c * inertia(w) ^ 2 end }
      :solver { rule = "lie(1)", h = 0.05 }
      :run { q = Q:identity(), v = { 0.2, 0.1, 0.4 }, steps = 5 }
    return path:velocity(6)
  end
  for _, c in ipairs { 0x1p-200, 0x1p-69, 0x1p69, 0x1p200 } do
    tap.near((ends(c) - ends(1)):norm(), 0, 1e-15, ("%s: masses of %g"):format(tostring(Q), c))
  end
end

local tiny = dm.system { Q = dm.SO(3), L = function(_, xi) return 1e-170 * xi:dot(xi) end }
tap.raises("member 2: no start: the momentum is", function()
  return tiny:solver { rule = "gauss(2)", h = 0.1 }:ensemble { members = 3, steps = 2,
    q = function() return dm.SO(3):identity() end,
    v = function(i) return { i == 1 and 0 or 1, 0, 0 } end }
end)
tap.done()
