-- Routh reduction of systems on groups by abelian groups that act on them
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function far(a, b)
  if type(b) == "number" then return math.abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = math.max(worst, far(a[i], b[i])) end
  return worst
end

---- a heavy top by its turns about the vertical, against a run on the group ----

local G = dm.SO(3)
local e3 = dm.vector { 0, 0, 1 }
local function inertia(w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 end
local top = dm.system { Q = G, L = function(R, w) return inertia(w) - R[3][3] end }
local start = { q = G:exp { 0.4, 0, 0 }, v = { 0.2, 0.1, 1.5 } }
local function turn(a, R) return G:exp(e3 * a) * R end
local function lean(x) return G:exp(dm.vector { x[1], x[2], 0 }) end
local shape = top:routh { action = turn, section = lean, q = start.q, v = start.v }
near(shape.params.mu, (start.q * top:legendre(start.q, start.v))[3], 1e-15,
  "mu is the vertical momentum")
local x, u, theta = shape:start(start.q, start.v)
local function run(system, s) return system:solver { rule = "gauss(6)", h = 0.01 }:run(s) end
local path = run(shape, { q = x, v = u, steps = 100 })
local full = run(top, { q = start.q, v = start.v, steps = 100 })
near(lean(path.q[101])[3][3], full.q[101][3][3], 1e-14, "the tilt of the reduced top")
local again = path:reconstruct { theta = theta }
ok(far(again.q[101], full.q[101]) < 1e-13 and far(again.p[101], full.p[101]) < 1e-13,
  "and its attitude and momentum, reconstructed")
near(again:drift "energy".largest, 0, 1e-12, "a path on the group")
local jump, last = 0, nil
for _, k in ipairs { 2, 3, 4, 5 } do
  local c = again:column(again.columns[k])
  for i = 2, #again do jump = math.max(jump, math.abs(c[i] - c[i - 1])) end
end
ok(jump < 0.05, "whose columns do not jump")
local g, xi = shape:lift(x, u, theta)
ok(far(g, start.q) < 1e-14 and far(xi, start.v) < 1e-14, "the state over a state of the shape")
ok(path:phases().total ~= last, "dynamic and geometric phases")
local cube = dm.commute(top, { q = start.q, v = start.v, h = 0.05, action = turn, section = lean,
  rule = "gauss(2)", steps = 10 })
ok(cube.commutes, "the cube of discrete Routh reduction closes")

---- two symmetries at once; products; quaternions; a torque that the group keeps ----

local symmetric = dm.system { Q = G, L = function(R, w)
  return (w[1] ^ 2 + w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3]
end }
local both = symmetric:routh { dimension = 2, q = start.q, v = start.v,
  action = function(a, R) return G:exp(e3 * a[1]) * R * G:exp(e3 * a[2]) end,
  section = function(y) return G:exp(dm.vector { y[1], 0, 0 }) end }
x, u, theta = both:start(start.q, start.v)
ok(far(run(both, { q = x, v = u, steps = 100 }):reconstruct { theta = theta }.q[101],
  run(symmetric, { q = start.q, v = start.v, steps = 100 }).q[101]) < 1e-13,
  "a symmetric top by its precession and its spin")
near(both.Q.dimension, 1, 0, "has one shape, its tilt")
local rotor = dm.system { Q = dm.product(G, dm.T(1)), force = function(_, v)
  return { -0.1 * v[1], -0.1 * v[2], -0.1 * v[3], 0 }
end, L = function(q, v) return inertia(v) + 0.5 * (v[3] + v[4]) ^ 2 - q[1][3][3] end }
local at = { q = { start.q, { 0.3 } }, v = { 0.2, 0.1, 1.5, 0.4 } }
local frozen = rotor:routh { q = at.q, v = at.v,
  action = function(a, q) return { q[1], { q[2][1] + a } } end,
  section = function(y) return { G:exp(y), { 0 } } end }
x, u, theta = frozen:start(at.q, at.v)
ok(far(run(frozen, { q = x, v = u, steps = 50 }):reconstruct { theta = theta }.q[51],
  run(rotor, { q = at.q, v = at.v, steps = 50 }).q[51]) < 1e-12, "a rotor in a damped body")
local S = dm.SU(2)
local spun = dm.system { Q = S, trivialization = "right", L = function(q, w)
  return w:dot(w) / 2 + 0.1 * w[3] ^ 2 - (q[1] ^ 2 - q[2] ^ 2 - q[3] ^ 2 + q[4] ^ 2)
end }
local q0 = S:exp { 0.4, 0, 0 }
local on = spun:routh { q = q0, v = start.v,
  action = function(a, q) return S:compose(S:exp(e3 * a), q) end,
  section = function(y) return S:exp(dm.vector { y[1], y[2], 0 }) end }
x, u, theta = on:start(q0, start.v)
ok(far(run(on, { q = x, v = u, steps = 50 }):reconstruct { theta = theta }.q[51],
  run(spun, { q = q0, v = start.v, steps = 50 }).q[51]) < 1e-12, "SU(2), right trivialization")

---- what is told ----

-- boosts: what moves far along them keeps few digits, which was taken for a broken symmetry
local Lorentz = dm.group { name = "SO(2,1)", form = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 } },
  basis = { { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 1 }, { 0, 0, 0 }, { 1, 0, 0 } },
    { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 } } } }
local function pushed(k)
  return dm.system { Q = Lorentz, L = function(g, v)
    return (v[1] ^ 2 + 2 * v[2] ^ 2 + 1.5 * v[3] ^ 2) / 2 - 0.2 * g[2][2] - 0.1 * g[2][1] ^ 2
      - k * g[1][1]
  end }
end
local boost = { q = Lorentz:exp { 0.2, 0.3, 0.1 }, v = { 0.4, 0.2, -0.3 },
  action = function(a, g) return Lorentz:exp { 0, a, 0 } * g end,
  section = function(y) return Lorentz:exp { y[1], 0, 0 } * Lorentz:exp { 0, 0, y[2] } end }
local free = pushed(0)
local boosted = free:routh(boost)
x, u, theta = boosted:start(boost.q, boost.v)
ok(far(run(boosted, { q = x, v = u, steps = 50 }):reconstruct { theta = theta }.q[51],
  run(free, { q = boost.q, v = boost.v, steps = 50 }).q[51]) < 1e-12, "boosts of a group by a form")
raises("not invariant under the action", function() pushed(1e-3):routh(boost) end)
raises("not invariant under the action", top.routh, top, { section = lean, mu = 1,
  action = function(a, R) return R * G:exp(e3 * a) end })
raises("crosses the section", top.routh, top, { action = turn, mu = 0.3,
  section = function(y) return G:exp(e3 * y[1]) end })
raises("has no cyclic coordinates", top.routh, top, { cyclic = { 1 }, mu = 1 })
raises("'section' must be function(x)", top.routh, top, { action = turn, mu = 1 })
raises("option 'v' must be 3 numbers", top.routh, top, { action = turn, section = lean,
  q = start.q, v = { 1, 2 } })
raises("on a group give 'section'", top.routh, top, { action = turn, section = lean, mu = 1,
  at = start.q })
raises("knows no theta and x", shape.discrete, shape,
  dm.discrete_lagrangian(top, { rule = "lie(1)", h = 0.1 }))
raises("no theta and shape were found", top.routh, top, { action = turn, q = G:exp { 0, 3.1, 3 },
  section = function(y) return G:exp(dm.vector { dm.sin(y[1]) / 9, dm.sin(y[2]) / 9, 0 }) end,
  v = start.v })

tap.done()
