-- path:noether and the symmetries that action:invariant finds: divergences, scales, moving time
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max = math.abs, math.max

local function spread(N)
  local worst = 0
  for k = 1, #N do worst = max(worst, abs(N[k] - N[1])) end
  return worst
end

-- a fall: translations and Galilei's boosts, up to divergences that are known
local fall = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 9.81 * q[2] end }
local path = fall:solver { rule = "verlet", h = 0.1 }:run { q = { 0, 1 }, v = { 1, 2 },
  steps = 100 }
near(spread(path:noether { generator = function(_, t) return { 0, t } end,
  divergence = function(q, t) return q[2] - 4.905 * t ^ 2 end }), 0, 1e-11, "the boost of a fall")
local up = dm.action { group = dm.R(1), on = dm.R(2),
  map = function(e, q) return { q[1], q[2] + e[1] } end }
local fine, why, lift = up:invariant(fall)
ok(not fine and tostring(why):find "not invariant" and tostring(lift) == "symmetry up to a "
  .. "divergence",
  "a translation along gravity", tostring(lift))
near(lift.divergence({ 0.3, 0.7 }, 1.4), -9.81 * 1.4, 1e-12, "its B = -g t")
near(spread(path:noether(lift)), 0, 1e-12, "what it keeps")
local boost = dm.action { group = dm.R(1), on = dm.R(3),
  map = function(e, z) return { z[1], z[2] + e[1] * z[3], z[3] } end }
fine, why, lift = boost:invariant(fall)
near(lift.divergence({ 0.3, 0.7 }, 1.4), 0.7 - 9.81 * 1.4 ^ 2 / 2, 1e-12, "B of the boost")
near(spread(path:noether(lift)), 0, 1e-11, "the boost, found")
ok(not fine and tostring(why):find "divergence", "is no invariance")

-- Kepler's third law is a scale; a conformal group of a free particle
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local scale = dm.action { group = dm.R(1), on = dm.R(3), map = function(e, z)
  return { z[1] * dm.exp(2 * e[1]), z[2] * dm.exp(2 * e[1]), z[3] * dm.exp(3 * e[1]) }
end }
local _, _, third = scale:invariant(kepler)
ok(third.scale == 1 and third.divergence == nil, "Kepler's third law scales the action",
  third.scale)
local orbit = kepler:solver { rule = "gauss(4)", h = 0.05 }
  :run { q = { 1, 0 }, v = { 0, 1.1 }, steps = 200 }
near(spread(orbit:noether(third)), 0, 1e-8, "p . xi - E tau - S along an ellipse")
near(spread(orbit:noether { generator = function() return { 0, 0 }, 1 end }), 0, 1e-9,
  "time alone: the energy, with a sign")
local time = dm.action { group = dm.R(1), on = dm.R(3),
  map = function(e, z) return { z[1], z[2], z[3] + e[1] } end }
ok(time:invariant(kepler) == true, "translations in time leave L as it is")
local free = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
local conformal = dm.action { group = dm.SL(2), on = dm.R(2),
  domain = function(z) return 5 - z[2] ^ 2 - z[1] ^ 2 end, map = function(g, z)
    local below = g[2][1] * z[2] + g[2][2]
    return { z[1] / below, (g[1][1] * z[2] + g[1][2]) / below }
  end }
local _, _, list = conformal:invariant(free)
local line = free:solver { rule = "verlet", h = 0.1 }:run { q = { 0.4 }, v = { 0.3 }, steps = 50 }
for a = 1, 3 do
  near(spread(line:noether(list[a])), 0, 1e-13, "conformal group of a free particle, " .. a)
end

-- B is an integral along a line, however fast it changes and wherever it begins
local shift = dm.action { group = dm.R(1), on = dm.R(1),
  map = function(a, q) return { q[1] + a[1] } end }
local function divergence_of(L)
  return select(3, shift:invariant(dm.system { Q = dm.R(1), L = L })).divergence
end
local fast = divergence_of(function(q, v) return v[1] ^ 2 / 2 + dm.sin(30 * q[1]) * v[1] end)
near(fast({ 7 }, 0) - fast({ 0 }, 0), math.sin(210), 1e-12, "B = sin 30 q")
local forced = divergence_of(function(q, v, t) return v[1] ^ 2 / 2 + q[1] * dm.cos(25 * t) end)
near(forced({ 0.2 }, 20), math.sin(500) / 25, 1e-12, "B = sin(25 t)/25")
local late = divergence_of(function(q, v, t) return v[1] ^ 2 / 2 + q[1] / t end)
near(late({ 0.2 }, 3) - late({ 0.2 }, 2), math.log(1.5), 1e-13, "B = log t, which 0 has not")
local bodies = dm.system { Q = dm.R(4), L = function(q, v)
  local d = dm.vector { q[1] - q[3], q[2] - q[4] }
  return (2 * (v[1] ^ 2 + v[2] ^ 2) + 3 * (v[3] ^ 2 + v[4] ^ 2)) / 2 + 1 / d:norm()
end }
local push = select(3, dm.action { group = dm.R(1), on = dm.R(5), map = function(a, z)
  return { z[1] + a[1] * z[5], z[2], z[3] + a[1] * z[5], z[4], z[5] }
end }:invariant(bodies)).divergence
near(push({ 1, 2, 3, 4 }, 0.7) - push({ 0, 2, 5, 1 }, 0), 2 - 6, 1e-12,
  "Galilei's boost of two bodies, which are not to meet")
local pole = divergence_of(function(q, v) return v[1] ^ 2 / 2 - v[1] / q[1] ^ 2 end)
raises("no finite integral from q = [1], t = 0 to q = [-2]", function() pole({ -2 }, 0) end)

-- none at all, and bad input
local none = { dm.action { group = dm.R(1), on = dm.R(2),
  map = function(e, q) return { q[1] + e[1], q[2] } end }:invariant(kepler) }
ok(none[1] == false and none[3] == nil, "a translation is no symmetry of Kepler's")
raises("option 'generator' is missing", function() path:noether {} end)
raises("must give xi, 2 numbers", function()
  path:noether { generator = function() return { 1 } end }
end)
local saddle = dm.system { Q = dm.R(1), H = function(q, p) return q[1] * p[1] end }
  :solver { rule = "midpoint", h = 0.1 }:run { q = { 1 }, p = { 2 }, steps = 20 }
near(spread(saddle:noether { generator = function() return { 0 }, 1 end }), 0, 1e-13,
  "the energy of an H that no L belongs to")
raises("finite number, B(q, t)", function()
  path:noether { generator = function() return { 1, 0 } end,
    divergence = function() return 1 / 0 end }
end)
raises("B(q, t)", function()
  path:noether { generator = function() return { 1, 0 } end,
    divergence = function() return "x" end }
end)
raises("is for systems on coordinates", function()
  dm.system { Q = dm.SO(3), L = function(_, w) return w:dot(w) / 2 end }
    :solver { rule = "lie(1)", h = 0.1 }:run { q = dm.SO(3):identity(), v = { 0, 0, 1 }, steps = 2 }
    :noether { generator = function() return { 1 } end }
end)

tap.done()
