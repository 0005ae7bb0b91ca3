-- Routh reduction by groups that are not abelian: isotropy, amended potential, relative equilibria,
-- runs at a level of the spatial momentum, free actions on coordinates, refusals
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, sqrt = math.abs, math.max, math.sqrt

local G, R1 = dm.SO(3), dm.R(1)

-- a bead on a spring along the first axis of a free body: inertia (1, 2 + x^2, 3 + x^2)
local bead = dm.system { Q = dm.product(R1, G), L = function(q, v)
  local x = q[1][1]
  return (v[1] ^ 2 + v[2] ^ 2 + (2 + x ^ 2) * v[3] ^ 2 + (3 + x ^ 2) * v[4] ^ 2) / 2
    - 2 * (x - 1) ^ 2
end }
local J = dm.vector { 0.3, -0.4, 1.2 }
local level = bead:routh { group = G, mu = J }
ok(#level.isotropy == 1 and level.orbit == 2 and level.dimension == 4,
  "shapes and a sphere of momenta")
near(abs(level.isotropy[1]:dot(J)) / J:norm(), 1, 1e-14, "the isotropy group turns about J")
near(level:locked_inertia(0.5)[3][3], 3.25, 1e-14, "locked inertia")
near(level:amended_potential(0.5, { 0, 0, 1.3 }), 0.5 + 1.69 / 6.5, 1e-14, "amended potential")
near(level:routhian(0.5, 0.2, { 0, 0, 1.3 }), 0.02 - 0.5 - 1.69 / 6.5, 1e-14, "its Routhian")

-- relative equilibria turn about a principal axis: 4 (x - 1) = m^2 x/I(x)^2 about e2 and e3
local found, m = level:relative_equilibria { x = 1, spread = 0.4, starts = 60 }, J:norm()
ok(#found == 6, "two ways about each axis", #found)
local worst = 0
for _, e in ipairs(found) do
  local x, nu = e.x[1], e.nu
  worst = max(worst, abs(nu:norm() - m), nu:cross(e.xi):norm())
  local I = abs(nu[3]) > 1 and 3 + x ^ 2 or abs(nu[2]) > 1 and 2 + x ^ 2
  worst = max(worst, I and abs(4 * (x - 1) - m ^ 2 * x / I ^ 2) or abs(x - 1))
end
ok(worst < 1e-9, "about principal axes, the shape stretched by the turn", worst)
ok(found[1].stable and found[2].stable and not found[3].stable,
  "stable about the axis of the largest inertia")

-- a run at the level is the unreduced motion
local solver = level:solver { rule = "lie(2)", h = 0.02 }
local run = solver:run { x = 0.7, p = 0.1, g = G:exp { 0.2, 0.1, -0.3 }, steps = 200 }
local g0 = G:exp { 0.2, 0.1, -0.3 }
local full = bead:solver { rule = "lie(2)", h = 0.02 }:run { q = { { 0.7 }, g0 },
  p = { 0.1, table.unpack(G:coAd(G:inverse(g0), J):totable()) }, steps = 200 }
near(run.x[201][1], full.q[201][1][1], 1e-12, "the shape of the unreduced motion")
near((G:coAd(full.q[201][2], run.mu[201]) - J):norm(), 0, 1e-13, "whose momentum is J")

-- two bodies in the plane: SE(2) acts freely, their distance is the shape; at J = (0, 0, l)
local two = dm.system { Q = dm.R(4), L = function(q, v)
  local dx, dy = q[3] - q[1], q[4] - q[2]
  return v:dot(v) / 2 + 1 / dm.sqrt(dx ^ 2 + dy ^ 2)
end }
local plane = dm.action { group = dm.SE(2), on = dm.R(2) }
local function section(x) return { -x[1] / 2, 0, x[1] / 2, 0 } end
local pair = two:routh { action = plane, section = section, mu = { 0, 0, 1 } }
near(pair:amended_potential(2.2), 1 / 2.2 ^ 2 - 1 / 2.2, 1e-14, "l^2/r^2 - 1/r")
local circle = pair:relative_equilibria { x = 2, spread = 0.3, starts = 8 }
ok(#circle == 1 and abs(circle[1].x[1] - 2) < 1e-9, "the circular orbit, r = 2 l^2")
local w = 1 / (2.2 ^ 2 / 2)
local orbit = pair:solver({ rule = "lie(2)", h = 0.01 }):run { x = 2.2, p = 0, steps = 200 }
local flat = two:solver({ rule = "gauss(4)", h = 0.01 }):run { q = { -1.1, 0, 1.1, 0 },
  v = { 0, -1.1 * w, 0, 1.1 * w }, steps = 200 }
local q = flat.q[201]
near(orbit.x[201][1], sqrt((q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2), 1e-10, "their distance in time")

raises("isotropy group of dimension 1", function()
  dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end }
    :routh { action = dm.action { group = G, on = dm.R(3) }, mu = { 0, 0, 1 } }
end)
raises("'section' is missing", function() two:routh { action = plane, mu = { 0, 0, 1 } } end)
raises("option 'mu' is missing", function() bead:routh { group = G } end)
raises("must be 3 finite numbers", function() bead:routh { group = G, mu = { 1, 2 } } end)
raises("L is not invariant", function()
  dm.system { Q = dm.product(R1, G), L = function(r, v) return v:dot(v) / 2 - r[2][3][3] end }
    :routh { group = G, mu = { 0, 0, 1 } }
end)
raises("L is not invariant", function()
  dm.system { Q = dm.R(4), L = function(r, v) return v:dot(v) / 2 - r[1] end }
    :routh { action = plane, section = section, mu = { 0, 0, 1 } }
end)
raises("locked inertia is singular", function()
  dm.system { Q = dm.product(R1, G), L = function(_,
    v) return (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) / 2 end }
    :routh { group = G, mu = { 0, 0, 1 } }
end)
local needle = dm.system { Q = dm.product(R1, G), L = function(r, v)
  local x = r[1][1]
  return (v[1] ^ 2 + x ^ 2 * v[2] ^ 2 + (1 + x ^ 2) * v[3] ^ 2 + v[4] ^ 2) / 2
end }:routh { group = G, mu = { 0, 0, 1 } }
raises("singular at the shape [0", function() needle:amended_potential(0) end)
raises("mu follows from J", function() solver:run { x = 0.7, p = 0, mu = { 0, 0, 1 },
  steps = 1 } end)

tap.done()
