-- group actions: axioms, standard ones, generators, joint actions, momentum; and every misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local max, cos, sin = math.max, math.cos, math.sin

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
for _, row in ipairs { { dm.SO(2), dm.R(2) }, { dm.SO(2), dm.R(3) }, { dm.SO(3), dm.R(3) }, { dm.SO(3), dm.S(2) }, { dm.SO(3), dm.R(2) },
  { dm.SO(4), dm.S(3) }, { dm.SE(2), dm.R(2) }, { dm.SE(3), dm.R(3) }, { dm.SL(2), dm.R(1) }, { dm.SL(2), dm.R(2) }, { dm.SL(3), dm.R(2) },
  { dm.GL(1), dm.R(3) }, { dm.GL(2), dm.R(2) }, { dm.Sp(4), dm.R(4) }, { dm.Heisenberg(), dm.R(3) }, { dm.R(2), dm.R(2) },
  { dm.T(2), dm.T(2) }, { dm.SE(2), dm.SE(2) }, { dm.semidirect(dm.GL(2), dm.R(2)), dm.R(2) },
  { dm.product(dm.SO(2), dm.R(1)), dm.product(dm.R(2), dm.R(1)) } } do
  local right = dm.action { group = row[1], on = row[2], side = "right" }
  standard[#standard + 1] = dm.action { group = row[1], on = row[2] }
  local g, z = row[1]:random(stream, 3, 0.2), vector(right.dimension, 4)
  if row[2].name == "S" then z = row[2]:project(z) end
  near((right(g, z) - standard[#standard](row[1]:inverse(g), z)):norm(), 0, 1e-13, "a right action: " .. tostring(right))
end

-- the generators are the derivatives of the curves exp(t xi) z, by the graph and by central differences
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

-- brackets: left generators are an antihomomorphism, [xi_Q, eta_Q] = -[xi, eta]_Q, as vector fields D eta_Q xi_Q - D xi_Q eta_Q
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
  near((bracket + psi * G:ad(xi, eta)):norm(), 0, 1e-12 * (1 + bracket:norm()), "brackets of " .. tostring(act))
end

near((dm.action { group = dm.SO(2), on = dm.R(2), map = "stereographic" }(0.7, { 0.3, -1.2 }) - sphere(0.7, { 0.3, -1.2 })):norm(), 0,
  1e-15, "the stereographic action of SO(2) is that of Bogfjellmo 4.10")
-- its generator: v = (w1 w2, (1 + w2^2 - w1^2)/2) (Bogfjellmo 4.11)
local psi = sphere:generator { 0.3, -1.2 }
near(psi[1][1], 0.3 * -1.2, 1e-15, "generator of 4.10, w1 w2")
near(psi[2][1], (1 + 1.2 ^ 2 - 0.3 ^ 2) / 2, 1e-15, "generator of 4.10, (1 + w2^2 - w1^2)/2")
local moebius = dm.action { group = dm.SL(2), on = dm.R(1) }
near(moebius({ { 2, 1 }, { 1, 1 } }, { 3 })[1], 7 / 4, 1e-15, "a fractional linear map")

---- joint actions ----

local pairs2 = sphere:on_pairs()
ok(pairs2.points == 2 and pairs2.base == sphere and pairs2.dimension == 4, "a joint action knows its base")
local both = pairs2(0.4, { 0.1, 0.2, 0.3, 0.4 })
near((both:slice(3, 4) - sphere(0.4, { 0.3, 0.4 })):norm(), 0, 0, "it moves every point")
near((pairs2:generator { 0.1, 0.2, 0.3, 0.4 }):column(1)[3], 0.12, 1e-15, "and has stacked generators")
ok(tostring(sphere:on_points(3)):find "on 3 points", "it says so")
-- symbols
local slope = dm.derivative(function(th) return sphere(th[1], { 0.3, -1.2 }) end, 1) { 0 }
near(slope[2][1], psi[2][1], 1e-15, "an action takes symbols")

---- momentum ----

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local turn = dm.action { group = dm.SO(2), on = dm.R(2), map = function(th, z)
  return { cos(th) * z[1] - sin(th) * z[2], sin(th) * z[1] + cos(th) * z[2] }
end }
local path = kepler:solver { rule = "gauss(2)", h = 0.05 }:run { q = { 1, 0 }, v = { 0, 1.1 }, steps = 100 }
near((path:momentum(turn) - path:momentum(dm.SO(2))):norm(), 0, 0, "path:momentum of a written action")
local Ld = dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.1 })
near(Ld:momentum(turn, { 1, 0 }, { 1, 0.1 })[1], Ld:momentum(dm.SO(2), { 1, 0 }, { 1, 0.1 })[1], 1e-16, "Ld:momentum of a written action")
near(turn:momentum({ 1, 2 }, { 3, 4 })[1], 1 * 4 - 2 * 3, 1e-15, "action:momentum is q1 p2 - q2 p1")
local two = dm.system { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 - (q:slice(1, 2) - q:slice(3, 4)):norm() end }
path = two:solver { rule = "verlet", h = 0.01 }:run { q = { 1, 0, 0, 0 }, v = { 0, 1, 0.3, 0 }, steps = 50 }
near((path:momentum(turn) - path:momentum(dm.SO(2), { block = 2 })):norm(), 0, 1e-14, "on two bodies, block by block")
path = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end }:solver { rule = "verlet", h = 0.1 }
  :run { q = { 1, 2 }, v = { 3, 4 }, steps = 10 }
near((path:momentum(dm.SE(2))[11] - dm.vector { 3, 4, -2 }):norm(), 0, 2e-15, "a free particle keeps its three momenta of SE(2)")

---- what is no action ----

raises("axiom of composition", function() return dm.action { group = dm.R(1), on = dm.R(1), map = function(g, z) return { z[1] + g[1] ^ 3 } end } end)
raises("axiom of identity", function() return dm.action { group = dm.R(1), on = dm.R(1), map = function(g, z) return { 2 * z[1] } end } end)
raises("a full turn", function() return dm.action { group = dm.SO(2), on = dm.R(1), map = function(g, z) return { z[1] + g } end } end)
raises('with side = "right"', function() return dm.action { group = dm.SO(3), on = dm.R(3), map = function(g, z) return g:transpose() * z end } end)
raises("axiom of closure", function() return dm.action { group = dm.R(1), on = dm.S(1), map = function(g, z) return z + dm.vector { g[1], 0 } end } end)
raises("at none of", function() return dm.action { group = dm.R(1), on = dm.R(1), map = function() return { 0 / 0 } end } end)
raises("must have 2 entries (got 1)", function() return dm.action { group = dm.R(1), on = dm.R(2), map = function(_, z) return { z[1] } end } end)
raises("manifold, not a group", function() return dm.action { group = dm.S(2), on = dm.R(2) } end)
raises("no vectors", function() return dm.action { group = dm.SO(3), on = dm.SO(3) } end)
raises("no standard action", function() return dm.action { group = dm.SO(3), on = dm.R(5) } end)
raises("unknown action", function() return dm.action { group = dm.SO(3), on = dm.R(3), map = "turn" } end)
raises("unknown field", function() return dm.action { group = dm.SO(3), on = dm.R(3), sides = "left" } end)
raises("field 'group' must be a space", function() return dm.action { on = dm.R(3) } end)
raises("the point z must have 2 entries", function() return turn(0.1, { 1, 2, 3 }) end)
raises("is not defined at z", function() return moebius({ { 0, -1 }, { 1, 0 } }, { 0 }) end)
raises("moves points of 3 numbers", function() return path.momentum(two:solver { rule = "verlet", h = 0.1 }
  :run { q = { 1, 0, 0, 0 }, v = { 0, 1, 0.3, 0 }, steps = 1 }, dm.action { group = dm.SO(3), on = dm.R(3) }) end)
-- a local action: the domain is where it is looked at
local half = dm.action { group = dm.R(1), on = dm.R(1), domain = function(z) return z[1] end,
  map = function(g, z) return { z[1] * math.exp(g[1]) } end }
near(half({ 0.5 }, { 2 })[1], 2 * math.exp(0.5), 1e-15, "a local action")
tap.done()
