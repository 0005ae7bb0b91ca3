-- The logarithm of SO(4) by two unit quaternions (lua/dm/group/rotation_log.lua): xi from exp xi
-- up to where the larger turn is near pi, in numbers; in symbols by an Ld whose paths are known
local tap = require "tap"
local dm = require "dm"
local kits = require "dm.group.kit"
local logs = require "dm.group.rotation_log"
local ok = tap.ok
local abs, max = math.abs, math.max

local Q = dm.SO(4)
local kit = kits.of(Q)

local function apart(x, y)
  local worst = 0
  for k = 1, #x do
    local d = abs(x[k] - y[k])
    worst = d == d and max(worst, d) or math.huge
  end
  return worst
end

-- two planes (1, 2) and (3, 4), turned by a and b, carried by some rotation
local g = Q:exp { 0.4, -0.7, 0.2, 0.9, -0.3, 0.5 }
local function turned(a, b) return Q:Ad(g, { a, 0, 0, 0, 0, b }) end
for _, angles in ipairs { { 0, 0 }, { 1e-9, 0 }, { 0.3, 0.3 }, { 0.3, -0.3 }, { 1.5, 0.2 },
  { 2.5, 2.5 }, { 2.5, -2.5 }, { 3, 1 }, { -3, 3 }, { 3.1, 0 } } do
  local xi = turned(angles[1], angles[2])
  -- the entries of exp xi have round-off, which 1/(pi - turn) magnifies
  ok(apart(kit.vee(logs.of_pair(Q:exp(xi))), xi) < 2e-14 / (math.pi - abs(angles[1])),
    ("turns %g and %g"):format(angles[1], angles[2]))
end

-- Ld = |log(g0^-1 g1)|^2/(2h): |xi|^2 is invariant on both sides, so p stays and g_n = exp(n h p)
local h, n, p = 0.1, 20, { 0.9, -0.5, 0.3, 0.2, -0.1, 0.7 }
local system = dm.discrete_lagrangian { Q = Q, h = h, Ld = function(g0, g1, step)
  local xi = Q:log(Q:inverse(g0) * g1)
  return xi:dot(xi) / (2 * step)
end }
local path = system:solver():run { q = Q:identity(), p = p, steps = n }
local steady, whole = 0, {}
for i = 1, #path.p do steady = max(steady, apart(path.p[i], p)) end
for k = 1, 6 do whole[k] = n * h * p[k] end
ok(steady < 1e-13, "momentum of a geodesic stays")
ok(apart(kit.entries(path.q[#path.q]), kit.entries(Q:exp(whole))) < 1e-13, "geodesics of SO(4)")

-- turns about an axis, either way: what is zero is printed as 0, not as -0
do
  local negative = 0
  for axis = 1, 3 do
    for _, angle in ipairs { 0.5, -0.5, 0, -0.0 } do
      local turn = { 0, 0, 0 }
      turn[axis] = angle
      for _, g in ipairs { dm.SO(3):exp(turn), dm.SO(3):cayley(turn), dm.SE(3):exp { 0, 0, 0, table.unpack(turn) } } do
        for i = 1, g.rows do
          for j = 1, g.rows do negative = negative + (1 / g[i][j] == -math.huge and 1 or 0) end
        end
      end
    end
  end
  ok(negative == 0, "turns about an axis have no -0", negative)
end
tap.done()
