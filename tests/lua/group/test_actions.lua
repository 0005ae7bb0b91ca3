-- group actions: axioms, standard ones, generators, joint actions, momentum; and every misuse
local tap = require "tap"
local dm = require "dm"
local axioms = require "dm.action.axioms"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, cos, sin = math.abs, math.max, math.cos, math.sin

local stream = dm.random(8)
local function vector(n, i, size)
  local out = {}
  for k = 1, n do out[k] = stream:normal(i, k, 0, size or 1) end
  return dm.vector(out)
end

-- rotations of the sphere about the y^1 axis in the stereographic plane (Bogfjellmo 4.10)
local function rotate(theta, w)
  local n = w:dot(w)
  local d = 1 + n - cos(theta) * (n - 1) - 2 * sin(theta) * w[2]
  return { 2 * w[1] / d, (-sin(theta) * (n - 1) + 2 * cos(theta) * w[2]) / d }
end
local sphere = dm.action { group = dm.SO(2), on = dm.R(2), map = rotate, name = "Runge-Lenz" }

---- standard actions ----

local standard = {}
for _, row in ipairs { { dm.SO(2), dm.R(2) }, { dm.SO(2), dm.R(3) }, { dm.SO(3), dm.R(3) },
  { dm.SO(3), dm.S(2) }, { dm.SO(3), dm.R(2) },
  { dm.SO(4), dm.S(3) }, { dm.SE(2), dm.R(2) }, { dm.SE(3), dm.R(3) }, { dm.SL(2), dm.R(1) },
  { dm.SL(2), dm.R(2) }, { dm.SL(3), dm.R(2) },
  { dm.GL(1), dm.R(3) }, { dm.GL(2), dm.R(2) }, { dm.Sp(4), dm.R(4) }, { dm.Heisenberg(), dm.R(3) },
  { dm.R(2), dm.R(2) },
  { dm.T(2), dm.T(2) }, { dm.SE(2), dm.SE(2) }, { dm.semidirect(dm.GL(2), dm.R(2)), dm.R(2) },
  { dm.product(dm.SO(2), dm.R(1)), dm.product(dm.R(2), dm.R(1)) } } do
  local right = dm.action { group = row[1], on = row[2], side = "right" }
  standard[#standard + 1] = dm.action { group = row[1], on = row[2] }
  local g, z = row[1]:random(stream, 3, 0.2), vector(right.dimension, 4)
  if row[2].name == "S" then z = row[2]:project(z) end
  near((right(g, z) - standard[#standard](row[1]:inverse(g), z)):norm(), 0, 1e-13,
    "a right action: " .. tostring(right))
  for _, act in ipairs { right, standard[#standard] } do -- made with a test at one point
    local fine, why = pcall(axioms.check, act, 24)
    ok(fine, "axioms of " .. tostring(act), why)
  end
end

-- the generators are the derivatives of the curves exp(t xi) z, by the graph and by central
-- differences
for _, act in ipairs(standard) do
  local G, m, most = act.group, act.dimension, 0
  local z = vector(m, 20, 0.5)
  if act.on.name == "S" then z = act.on:project(z) end
  local psi, h = act:generator(z), 1e-5
  for a = 1, G.dimension do
    local e = dm.zeros(G.dimension)
    e[a] = h
    local difference = (act(G:exp(e), z) - act(G:exp(-e), z)) * (1 / (2 * h))
    most = max(most, (difference - psi:column(a)):norm())
  end
  ok(most < 1e-9, "generators of " .. tostring(act), most)
end

-- brackets: left generators are an antihomomorphism, [xi_Q, eta_Q] = -[xi, eta]_Q, as vector fields
-- D eta_Q xi_Q - D xi_Q eta_Q
for _, act in ipairs(standard) do
  local G, m, r = act.group, act.dimension, act.group.dimension
  local z, xi, eta = vector(m, 30, 0.5), vector(r, 31), vector(r, 32)
  local field = dm.derivative(function(x, zeta)
    return act:generator(x) * zeta
  end, m, r)
  local function slope(zeta)
    local J, out = field(z, zeta), {}
    for i = 1, m do out[i] = J[i]:slice(1, m) end
    return dm.matrix(out)
  end
  local psi = act:generator(z)
  local bracket = slope(eta) * (psi * xi) - slope(xi) * (psi * eta)
  near((bracket + psi * G:ad(xi, eta)):norm(), 0, 1e-12 * (1 + bracket:norm()),
    "brackets of " .. tostring(act))
end

near((dm.action { group = dm.SO(2), on = dm.R(2), map = "stereographic" }(0.7, { 0.3, -1.2 })
  - sphere(0.7, { 0.3, -1.2 })):norm(), 0,
  1e-15, "the stereographic action of SO(2) is that of Bogfjellmo 4.10")
-- its generator: v = (w1 w2, (1 + w2^2 - w1^2)/2) (Bogfjellmo 4.11)
local psi = sphere:generator { 0.3, -1.2 }
near(psi[1][1], 0.3 * -1.2, 1e-15, "generator of 4.10, w1 w2")
near(psi[2][1], (1 + 1.2 ^ 2 - 0.3 ^ 2) / 2, 1e-15, "generator of 4.10, (1 + w2^2 - w1^2)/2")
local moebius = dm.action { group = dm.SL(2), on = dm.R(1) }
near(moebius({ { 2, 1 }, { 1, 1 } }, { 3 })[1], 7 / 4, 1e-15, "a fractional linear map")

---- joint actions ----

local pairs2 = sphere:on_pairs()
ok(pairs2.points == 2 and pairs2.base == sphere and pairs2.dimension == 4,
  "a joint action knows its base")
local both = pairs2(0.4, { 0.1, 0.2, 0.3, 0.4 })
near((both:slice(3, 4) - sphere(0.4, { 0.3, 0.4 })):norm(), 0, 0, "it moves every point")
near((pairs2:generator { 0.1, 0.2, 0.3, 0.4 }):column(1)[3], 0.12, 1e-15,
  "and has stacked generators")
ok(tostring(sphere:on_points(3)):find "on 3 points", "it says so")
-- symbols
local slope = dm.derivative(function(th) return sphere(th[1], { 0.3, -1.2 }) end, 1) { 0 }
near(slope[2][1], psi[2][1], 1e-15, "an action takes symbols")

---- momentum ----

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local turn = dm.action { group = dm.SO(2), on = dm.R(2), map = function(th, z)
  return { cos(th) * z[1] - sin(th) * z[2], sin(th) * z[1] + cos(th) * z[2] }
end }
local path = kepler:solver { rule = "gauss(2)", h = 0.05 }:run {
  q = { 1, 0 }, v = { 0, 1.1 }, steps = 100 }
near((path:momentum(turn) - path:momentum(dm.SO(2))):norm(), 0, 0,
  "path:momentum of a written action")
local Ld = dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.1 })
near(Ld:momentum(turn, { 1, 0 }, { 1, 0.1 })[1], Ld:momentum(dm.SO(2), { 1, 0 }, { 1, 0.1 })[1],
  1e-16, "Ld:momentum of a written action")
near(turn:momentum({ 1, 2 }, { 3, 4 })[1], 1 * 4 - 2 * 3, 1e-15, "action:momentum is q1 p2 - q2 p1")
local two = dm.system { Q = dm.R(4),
  L = function(q, v) return v:dot(v) / 2 - (q:slice(1, 2) - q:slice(3, 4)):norm() end }
path = two:solver { rule = "verlet", h = 0.01 }:run {
  q = { 1, 0, 0, 0 }, v = { 0, 1, 0.3, 0 }, steps = 50 }
near((path:momentum(turn) - path:momentum(dm.SO(2), { block = 2 })):norm(), 0, 1e-14,
  "on two bodies, block by block")
path = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end }:solver {
  rule = "verlet", h = 0.125 }
  :run { q = { 1, 2 }, v = { 3, 4 }, steps = 10 }
near((path:momentum(dm.SE(2))[11] - dm.vector { 3, 4, -2 }):norm(), 0, 2e-15,
  "a free particle keeps its three momenta of SE(2)")

---- prolongations: actions again, whose generators are the derivatives of their maps ----

local function lifts_of(act)
  local out = { act:tangent(), act:cotangent(), act:jet(2), act:tangent():cotangent() }
  if act.dimension > 1 then
    out[5], out[6] = act:jet(3, { independent = 1 }), act:jet(2, { independent = act.dimension })
  end
  return out
end
for _, row in ipairs { { dm.SE(2), dm.R(2) }, { dm.SL(2), dm.R(1) }, { dm.SO(3), dm.R(2) },
  { dm.SL(3), dm.R(2) }, { dm.SO(3), dm.R(3), "right" },
  { dm.SE(3), dm.R(3) }, { dm.Heisenberg(), dm.R(3) }, { dm.SO(3), dm.S(2) } } do
  local act = dm.action { group = row[1], on = row[2], side = row[3] }
  local G, law, rate = act.group, 0, 0
  local kit = require "dm.group".kit(G)
  for _, lift in ipairs(lifts_of(act)) do
    local g, h, z = G:random(stream, 1, 0.3), G:random(stream, 2, 0.3),
      vector(lift.dimension, 3, 0.7)
    local twice, once = lift(g, lift(h, z)),
      lift(act.side == "left" and G:compose(g, h) or G:compose(h, g), z)
    law = max(law, (twice - once):norm() / (1 + once:norm()), (lift(G:identity(), z) - z):norm())
    local psi = lift:generator(z)
    local slope_of_map = dm.derivative(
      function(xi) return lift.map(kit.exp(xi), z) end, G.dimension)(dm.zeros(G.dimension))
    for i = 1, lift.dimension do
      rate = max(rate, (psi[i] - slope_of_map[i]):norm() / (1 + psi[i]:norm()))
    end
  end
  ok(law < 1e-12, "tangent, cotangent and jet prolongations are actions: " .. tostring(act), law)
  ok(rate < 1e-13, "  and their generators are the derivatives of their maps", rate)
end
-- a closed form: the rotation of a slope and a curvature, u = x^2/2 turned by theta
local plane = dm.action { group = dm.SE(2), on = dm.R(2) }
local jet = plane:jet(2, { independent = 1 })
local turned = jet({ 0, 0, 0.3 }, { 1, 0.5, 1, 1 })
near(turned[3], math.tan(math.pi / 4 + 0.3), 1e-14, "a slope is turned")
near(turned[4] / (1 + turned[3] ^ 2) ^ 1.5, 1 / 2 ^ 1.5, 1e-15, "and the curvature stays")
-- invariants known in closed form: curvature, Schwarzian derivative (of a curve with an invariant
-- parameter), symplectic pairing
ok(jet:invariant(function(j) return j[4] ^ 2 / (1 + j[3] ^ 2) ^ 3 end),
  "curvature squared is invariant under SE(2)")
ok(not jet:invariant(function(j) return j[4] / (1 + j[3] ^ 2) ^ 1.5 end),
  "its sign is not: turned past the vertical, x runs back")
ok(not jet:invariant(function(j) return j[4] end), "the second derivative is not")
ok(moebius:jet(3):invariant(function(j) return j[4] / j[2] - 1.5 * (j[3] / j[2]) ^ 2 end),
  "so is the Schwarzian under SL(2)")
ok(moebius:on_points(4):invariant(
  function(z) return (z[1] - z[3]) * (z[2] - z[4]) / ((z[1] - z[4]) * (z[2] - z[3])) end),
  "and the cross ratio")
ok(sphere:cotangent():invariant(
  function(z) return sphere:momentum(z:slice(1, 2), z:slice(3, 4))[1] end),
  "the momentum of an abelian group is invariant under the cotangent lift")
local lift = sphere:cotangent()(0.4, { 0.3, -1.2, 0.5, 0.7 })
local pushed = sphere:tangent()(0.4, { 0.3, -1.2, 2, 3 })
near(lift:slice(3, 4):dot(pushed:slice(3, 4)), 0.5 * 2 + 0.7 * 3, 1e-14, "<p', T map u> = <p, u>")

---- isotropy ----

local so3 = dm.action { group = dm.SO(3), on = dm.R(3) }
local at = so3:isotropy { 2, -3, 6 }
ok(at.dimension == 1 and at.orbit_dimension == 2, "SO(3) turns about an axis", at.dimension)
near(at.basis[1]:cross(dm.vector { 2, -3, 6 }):norm(), 0, 1e-14, "which is the point's own")
ok(so3:isotropy { 0, 0, 0 }.dimension == 3 and so3:isotropy({ 1e-9, 0, 0 }).dimension == 1,
  "the origin is fixed, its neighbours are not")
ok(not plane:free { 1, 2 } and plane:on_pairs():free { 1, 2, 3, 4 }
  and not plane:on_pairs():free { 1, 2, 1, 2 }, "SE(2) is free on pairs")
ok(plane:transitive { 1, 2 } and not so3:transitive { 1, 2, 3 }
  and dm.action({ group = dm.SO(3), on = dm.S(2) }):transitive { 0, 0, 1 },
  "what is transitive")
ok(not sphere:free { 1, 0 } and sphere:free { 0.9, 0 }, "the fixed points of Bogfjellmo 4.10")

---- invariance of Lagrangians ----

local kepler3 = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local flattened = dm.system { Q = dm.R(3),
  L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() + 0.1 * q[3] ^ 2 end }
ok(so3:invariant(kepler3) and so3:invariant(dm.discrete_lagrangian(
  kepler3, { rule = "gauss(2)", h = 0.1 })), "Kepler's L and Ld are invariant under SO(3)")
local same, why = so3:invariant(flattened)
ok(not same and why.defect > 1e-3 and #why.point == 6 and tostring(
  why):find "not invariant under .* at q = %[", "a flattened one is not", tostring(why))
ok(dm.action({ group = dm.SO(2), on = dm.R(3) }):invariant(flattened),
  "but under turns about its axis")
local g, z = why.g, why.point
near(abs(flattened:lagrangian(g * z:slice(1, 3), g * z:slice(4, 6))
  - flattened:lagrangian(z:slice(1, 3), z:slice(4, 6))), why.defect, 1e-12,
  "the violating point violates")
local Ld0 = dm.discrete_lagrangian { Q = dm.R(2), h = 0.1,
  Ld = function(a, b) return (b - a):norm() - 0.05 * (a:dot(a) + b:dot(b)) end }
ok(turn:invariant(Ld0) and not plane:invariant(Ld0) and not sphere:invariant(Ld0),
  "a discrete Lagrangian under three actions")
local bodies = dm.system { Q = dm.R(6),
  L = function(q, v) return v:dot(v) / 2 - (q:slice(1, 3) - q:slice(4, 6)):norm() end }
ok(dm.action({ group = dm.SE(3), on = dm.R(3) }):invariant(bodies), "two bodies, moved together")
raises("finite at none of", function() return turn:invariant(function() return 0 / 0 end) end)
raises("must return a number", function() return turn:invariant(function() return "no" end) end)
raises("moves points of 3", function()
  return so3:invariant(dm.system { Q = dm.R(4), L = function(_, v) return v:dot(v) / 2 end })
end)
ok(not so3:invariant(kepler), "of a system of two coordinates the third is the time")
raises("takes a function of z, a dm.system", function() return so3:invariant(3) end)
raises("whole number from 1 to 8", function() return so3:jet(0) end)
raises("option 'independent' must be", function() return so3:jet(1, { independent = 4 }) end)
raises("unknown option", function() return so3:jet(1, { dependent = 1 }) end)

-- Routh reduction takes abelian actions of any group, whatever its elements look like
local well = dm.system { Q = dm.R(3),
  L = function(q, v) return v:dot(v) / 2 - (q[1] ^ 2 + q[2] ^ 2) / 2 end }
local screw = dm.action { group = dm.product(dm.SO(2), dm.R(1)), on = dm.R(3), map = function(g, z)
  return { cos(g[1]) * z[1] - sin(g[1]) * z[2], sin(g[1]) * z[1] + cos(g[1]) * z[2],
    z[3] + g[2][1] }
end }
local shape = well:routh { action = screw, at = { 1, 0.2, 0 }, mu = { 0.5, 0.1 } }
ok(shape.Q.dimension == 1, "Routh reduction by SO(2) x R^1", tostring(shape))
ok(well:routh({ action = dm.action {
  group = dm.R(1), on = dm.R(3), map = function(g, z) return { z[1], z[2], z[3] + g[1] } end },
  at = { 1, 0.2, 0 }, mu = 0.1 }).Q.dimension == 2, "and by R^1")

---- what is no action ----

raises("axiom of composition",
  function() return dm.action { group = dm.R(1), on = dm.R(1),
  map = function(g, z) return { z[1] + g[1] ^ 3 } end } end)
raises("axiom of identity", function() return dm.action {
  group = dm.R(1), on = dm.R(1), map = function(g, z) return { 2 * z[1] } end } end)
raises("a full turn", function() return dm.action {
  group = dm.SO(2), on = dm.R(1), map = function(g, z) return { z[1] + g } end } end)
raises('with side = "right"', function() return dm.action {
  group = dm.SO(3), on = dm.R(3), map = function(g, z) return g:transpose() * z end } end)
raises("axiom of closure", function() return dm.action {
  group = dm.R(1), on = dm.S(1), map = function(g, z) return z + dm.vector { g[1], 0 } end } end)
raises("at none of", function() return dm.action {
  group = dm.R(1), on = dm.R(1), map = function() return { 0 / 0 } end } end)
raises("must have 2 entries (got 1)",
  function() return dm.action { group = dm.R(1), on = dm.R(2),
  map = function(_, z) return { z[1] } end } end)
raises("manifold, not a group", function() return dm.action { group = dm.S(2), on = dm.R(2) } end)
raises("no vectors", function() return dm.action { group = dm.SO(3), on = dm.SO(3) } end)
raises("no standard action", function() return dm.action { group = dm.SO(3), on = dm.R(5) } end)
raises("unknown action", function() return dm.action {
  group = dm.SO(3), on = dm.R(3), map = "turn" } end)
raises("unknown option 'sides'; did you mean 'side'?",
  function() return dm.action { group = dm.SO(3), on = dm.R(3), sides = "left" } end)
raises("option 'group' must be a space", function() return dm.action { on = dm.R(3) } end)
raises("the point z must have 2 entries", function() return turn(0.1, { 1, 2, 3 }) end)
raises("is not defined at z", function() return moebius({ { 0, -1 }, { 1, 0 } }, { 0 }) end)
raises("moves points of 3 numbers",
  function() return path.momentum(two:solver { rule = "verlet", h = 0.1 }
  :run { q = { 1, 0, 0, 0 }, v = { 0, 1, 0.3, 0 }, steps = 1 },
    dm.action { group = dm.SO(3), on = dm.R(3) }) end)
-- a local action: the domain is where it is looked at
local half = dm.action { group = dm.R(1), on = dm.R(1), domain = function(z) return z[1] end,
  map = function(g, z) return { z[1] * math.exp(g[1]) } end }
near(half({ 0.5 }, { 2 })[1], 2 * math.exp(0.5), 1e-15, "a local action")
-- NaN before a number
raises("finite (and inside of the domain)", dm.action,
  { group = dm.R(1), on = dm.R(2), map = function(_, z) return { 0 / 0, z[2] } end })
-- what an element looks like, and elements that are none
local space, rigid = dm.action { group = dm.SO(3), on = dm.R(3) },
  dm.action { group = dm.SE(2), on = dm.R(2) }
raises("no element of SO(3): its columns are off orthonormal ones by 1; G:project(g) is an "
  .. "element near it",
  space, { { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 1, 2, 3 })
raises("no element of SL(2): its determinant is 2, not 1", moebius, { { 2, 0 }, { 0, 1 } }, { 1 })
raises("the group element is not finite", rigid, { 0 / 0, 0, 0 }, { 1, 2 })
raises("an element of SO(3) is a matrix of 3 x 3, for instance {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}} "
  .. "or G:exp{0.1, 0.2, 0.3}", space, 0.3, { 1, 2, 3 })
raises("an element of SE(2) is a vector of 3 numbers (x, y, theta)", rigid, 1, { 1, 2 })
raises("an element of GL(1) is a matrix of 1 x 1, for instance {{1}} or G:exp{0.1}",
  dm.action { group = dm.GL(1), on = dm.R(2) }, 2, { 1, 2 })
raises("a list {a number, the angle, a vector of 1 number}, for instance {0, {0}} or G:exp{0.1, "
  .. "0.2}",
  function() dm.product(dm.SO(2), dm.R(1)):inverse(3) end)
raises("map(g, z) gets g in SO(2), a number, the angle",
  function() dm.action { group = dm.SO(2), on = dm.R(2),
  map = function(g, z) return { z[1] * g[1], z[2] } end } end)
raises("map(g, z) gets g in R^1, a vector of 1 number",
  function() dm.action { group = dm.R(1), on = dm.R(2),
  map = function(g, z) return { z[1] + g, z[2] } end } end)
raises("take the action on dm.R(2) and 2 points of it, action:on_points(2)",
  function() dm.action { group = dm.SE(2), on = dm.R(4) } end)
raises("map must return one value", dm.action, { group = dm.R(1), on = dm.R(1),
  map = function(g, z) return z + g, z end })
raises("domain must return one value", dm.action, { group = dm.R(1), on = dm.R(1),
  map = function(g, z) return z + g end, domain = function() return 1, 2 end })
raises("the function of action:invariant must return one value", turn.invariant, turn,
  function(z) return z[1], z[2] end)
-- joint and prolonged actions take lists of points
do
  local plane = dm.action { group = dm.SE(2), on = dm.R(2) }
  local pairs_of, g = plane:on_pairs(), { 0.1, 0.2, 1 }
  near((pairs_of(g, { { 1, 2 }, { 3, 4 } }) - pairs_of(g, { 1, 2, 3, 4 })):norm(), 0, 0,
    "a joint action on a list of points")
  near((pairs_of(g, dm.matrix { { 1, 2 }, { 3, 4 } }) - pairs_of(g, { 1, 2, 3, 4 })):norm(), 0, 0,
    "and on the rows of a matrix")
  ok(pairs_of:free { { 1, 2 }, { 3, 4 } } and pairs_of:isotropy {
    { 1, 2 }, dm.vector { 1, 2 } }.dimension == 1, "isotropy of a list of points")
  near(plane:cotangent()(g, { { 1, 2 }, { 3, 4 } })[3], plane:cotangent()(g, { 1, 2, 3, 4 })[3], 0,
    "a covector beside its point")
  raises("must have 4 entries (got 6)", pairs_of, g, { { 1, 2 }, { 3, 4 }, { 5, 6 } })
end

---- angles are no vectors ----

do
  local function along(Q)
    local n = Q.dimension
    local q, v = {}, {}
    for i = 1, n do q[i], v[i] = i, 1 end
    return dm.system { Q = Q, L = function(_, u) return u:dot(u) / 2 end }
      :solver { rule = "verlet", h = 0.1 }:run { q = q, v = v, steps = 3 }
  end
  local heading = dm.product(dm.R(2), dm.T(1))
  raises("coordinates of T^2 are angles", function() along(dm.T(2)):momentum(dm.SO(2)) end)
  raises("coordinates of R^2 x T^1 are angles", function() along(heading):momentum(dm.SO(2)) end)
  raises("are angles", function() along(dm.product(dm.T(1), heading)):momentum(dm.SO(2), { block = 2 }) end)
  raises("are angles", function()
    dm.discrete_lagrangian { Q = dm.T(3), h = 1, Ld = function(a, b) return (b - a):dot(b - a) / 2 end }
      :momentum(dm.SO(3), { 1, 2, 3 }, { 1, 2, 4 })
  end)
  ok(along(dm.T(2)):momentum(dm.R(2))[4][2] == 1 and along(dm.R(2)):momentum(dm.SO(2))[1] == -1,
    "shifts of angles, turns of vectors")
  raises("of what? a group", function() along(dm.R(2)):momentum() end)
end
tap.done()
