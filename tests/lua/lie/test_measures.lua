-- what measures a system takes systems on groups: tangent maps, Lyapunov exponents, reversal,
-- charts, momenta of actions, stability maps
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function kinetic(x)
  local sum = 0
  for i = 1, #x do sum = sum + (0.7 + 0.3 * i) * x[i] * x[i] / 2 end
  return sum
end
local affine = dm.group { name = "Aff(1)",
  basis = { { { 0, 1 }, { 0, 0 } }, { { 1, 0 }, { 0, 0 } } } }
local cases = {
  { dm.SO(3), function(g) return g[3][3] + 0.2 * g[1][2] end },
  { dm.SU(2), function(q) return q[1] * q[2] end },
  { dm.SE(3), function(g) return g[3][3] + g[1][4] ^ 2 + g[2][4] ^ 2 + g[3][4] ^ 2 / 2 end },
  { dm.product(dm.SO(3), dm.R(2)), function(g)
    return g[1][3][3] + g[2][1] ^ 2 + g[2][2] ^ 2 + 0.3 * g[2][1] * g[1][1][1]
  end },
  { affine, function(g) return 0.3 * g[1][1] ^ 2 + g[1][2] ^ 2 end },
  { dm.semidirect(dm.SO(3), dm.R(3)), function(g) return g[1][3][3] + g[2]:dot(g[2]) end },
}
for _, case in ipairs(cases) do
  local Q, V = case[1], case[2]
  local system = dm.system { Q = Q, L = function(g, x) return kinetic(x) - V(g) end }
  local v, x = {}, {}
  for i = 1, Q.dimension do v[i], x[i] = 0.3 / i, 0.2 / i end
  local start, name = { q = Q:exp(x), v = v, steps = 10 }, tostring(Q)
  local function tangent(rule) return system:solver { rule = rule, h = 0.05 }:tangent(start) end
  local exact, worst = tangent "lie(4)", 0
  local lifted = tangent "gauss(4)"
  for i = 1, 2 * Q.dimension do
    for k = 1, 2 * Q.dimension do
      worst = math.max(worst, math.abs(exact[i][k] - lifted[i][k]))
    end
  end
  ok(worst < 1e-12, name .. ": the tangent map by the lift is that in the chart", worst)
  for _, rule in ipairs { "gauss(1)", "midpoint", "lie(1)" } do
    local defect = system:solver { rule = rule, h = 0.1 }:symplecticity(start)
    ok(defect < 1e-13, name .. ": " .. rule .. " is symplectic", defect)
  end
  local defect = system:solver { rule = "rkmk4", h = 0.1 }:symplecticity(start)
  ok(defect > 1e-10, name .. ": rkmk4 is not", defect)
  near(system:solver { rule = "gauss(2)", h = 0.1 }:reversal(start), 0, 1e-13, "gauss(2) and back")
  ok(system:solver { rule = "rkmk4", h = 0.1 }:reversal(start) > 1e-11, "not so rkmk4")
  local path = system:solver { rule = "lie(2)", h = 0.1 }:run(start)
  local J = path:momentum(Q, { action = function(k, g) return Q:compose(k, g) end })
  near((J[11] - path:momentum(Q)[11]):norm(), 0, 1e-13, "momentum of the left action, as a function")
end

-- about the middle axis neighbours part as exp(t/sqrt(3))
local G = dm.SO(3)
local free = dm.system { Q = G, L = function(_, w)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2
end }
local middle = { q = G:identity(), v = { 0, 1, 0 }, t = 20 }
for _, rule in ipairs { "lie(2)", "gauss(2)" } do
  local found = free:solver { rule = rule, h = 0.05 }:lyapunov(middle)
  local half = free:solver { rule = rule, h = 0.05 }:lyapunov { q = middle.q, v = middle.v, t = 10 }
  near((found.exponent * 20 - half.exponent * 10) / 10, 1 / math.sqrt(3), 1e-3,
    rule .. ": growth about the middle axis")
end
local all = free:solver { rule = "gauss(2)", h = 0.05 }
  :lyapunov { q = middle.q, v = middle.v, t = 5, exponents = 6 }
near(all.sum, 0, 1e-12, "volumes stay")

-- errors of charts are angles
local round = dm.system { Q = G, L = function(_, w) return w:dot(w) / 2 end,
  force = function(_, w) return -0.4 * w end }
local chart = round:chart { q = G:identity(), v = { 0.3, -0.2, 0.5 }, t = 2, rules = { "lie(1)" },
  h = { 0.1 }, samples = 1, reference = { rule = "lie(3)", h = 0.01 } }
local last = round:solver { rule = "lie(1)", h = 0.1 }
  :run { q = G:identity(), v = { 0.3, -0.2, 0.5 }, steps = 20 }.q[21]
local s = (1 - math.exp(-0.8)) / 0.4
near(chart.points[1].error, G:distance(last, G:exp { 0.3 * s, -0.2 * s, 0.5 * s }), 1e-10,
  "the error of a chart is the angle of turn")
ok(#free:chart { q = G:identity(), v = { 1, 0.2, 0.4 }, t = 1, rules = { "lie(1)", "gauss(2)" } }
  .points > 4, "a chart that finds its steps and its reference")
-- a group without a lift: Gauss' methods were not passed over there
local plane = dm.system { Q = affine, L = function(g, x)
  return (x[1] ^ 2 + x[2] ^ 2) / 2 - 0.3 * g[1][1] - 0.2 * g[1][2] ^ 2
end }
local from = { q = affine:exp { 0.2, 0.1 }, v = { 0.3, -0.4 } }
local own = plane:chart { q = from.q, v = from.v, t = 1, rules = { "lie(1)" }, h = { 0.1 },
  samples = 1 }
local function finish(rule, h)
  local path = plane:solver { rule = rule, h = h }:run { q = from.q, v = from.v, t = 1 }
  return path.q[#path]
end
near(own.points[1].error, affine:distance(finish("rkmk4", 0.002), finish("lie(1)", 0.1)), 1e-9,
  "a chart on a group without a lift")
ok(dm.scene { plane, q = from.q, v = from.v, until_t = 1, tolerance = 1e-5, watch = { "R12" } }
  :run(), "and a scene")

-- another group that acts: turns about the axis of a body from the right
local top = dm.system { Q = G, L = function(R, w)
  return (w[1] ^ 2 + w[2] ^ 2 + 0.4 * w[3] ^ 2) / 2 - R[3][3]
end }
local path = top:solver { rule = "lie(2)", h = 0.1 }
  :run { q = G:exp { 0.5, 0, 0 }, p = { 0, 0.4, 1.6 }, steps = 40 }
local spin = path:momentum(dm.SO(2), { action = function(a, R) return R * G:exp { 0, 0, a } end })
near(spin[41] - 1.6, 0, 1e-13, "momentum about the axis of a symmetric top")
near(spin[20], path.p[20][3], 1e-14, "is the third of the body")
near(path:momentum(dm.SO(2), { side = "right" })[20], path.p[20][3], 1e-15,
  "which the subgroup of turns has on the right, too")
raises("identity must not move", path.momentum, path, dm.SO(2), { action = function(_, R)
  return R * G:exp { 0, 0, 1 }
end })
raises("and how it moves elements", path.momentum, path, dm.action { group = G, on = dm.R(3) })
raises("has no standard action on SO(3)", path.momentum, path, dm.R(2))

local map = top:stability { q = G:exp { 0.5, 0, 0 }, p = { 0, 0.4, 1.6 }, t = 20, h = { 0.1, 3 },
  rules = { "lie(1)", "lie(3)" }, refine = false }
ok(tostring(map):find "bounded" and tostring(map):find "1 wrong",
  "a map of stability, whose flow is found by two other rules")
-- entries of elements are watched by their names
local start = { q = G:exp { 0.5, 0, 0 }, p = { 0, 0.4, 1.6 }, steps = 20 }
local whole = top:solver { rule = "lie(1)", h = 0.1 }:run(start)
start.watch = { "R33", "mu2" }
local watched = top:solver { rule = "lie(1)", h = 0.1 }:run(start)
near((watched:column "R33" - whole:column "R33"):norm(), 0, 1e-15, "R33 is watched")
near((watched:column "mu2" - whole:column "p2"):norm(), 0, 0, "and mu2")
start.watch = { "R44" }
raises("entries of elements", function()
  top:solver { rule = "lie(1)", h = 0.1 }:run(start)
end)
-- what is only for coordinates says so
raises("dm.euler_poincare reduces", top.routh, top, { cyclic = { "q1" }, mu = 1 })
raises("there is no 'q1'; on SO(3)", function()
  dm.scene { top, q = G:identity(), v = { 0, 0, 1 }, watch = { "q1" }, tolerance = 1, until_t = 1 }
end)
---- what a rule keeps in place of H ----

local swung = dm.system { Q = G, L = function(R, w)
  return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 + 0.1 * w[1] * w[2] - R[3][3]
end }
local tilted = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 }, steps = 60 }
local function modified(system, rule, start)
  return system:solver { rule = rule, h = 0.025 }:modified_energy(start)
end
for _, rule in ipairs { "lie(1)", "lie(2)", "lie(1, gauss(1), cayley)", "gauss(1)", "lobatto(2)",
  "lobatto(3)" } do
  local m = modified(swung, rule, tilted)
  ok(m.amplitude < 1e-12, rule .. " keeps a modified energy on SO(3)", m.amplitude)
end
ok(modified(swung, "rkmk4", tilted).amplitude > 1e-9, "rkmk4 keeps none")
ok(modified(swung, "rk4", tilted).amplitude > 1e-10, "nor does rk4")
local plain, halved = modified(swung, "lobatto(2)", tilted), tilted
halved = swung:solver { rule = "lobatto(2)", h = 0.0125 }:modified_energy(tilted)
near(math.log((plain.mean - plain.H[1]) / (halved.mean - halved.H[1])) / math.log(2), 2, 0.2,
  "which is H + O(h^2) for lobatto(2)")
local pair = dm.system { Q = dm.product(G, dm.R(2)), L = function(q, v)
  return kinetic(v) - q[1][3][3] * q[2][1] - q[2][2] ^ 2
end }
local both = { q = { G:identity(), { 0.1, 0.2 } }, v = { 0.5, 0.4, 0.3, 0.2, 0.1 }, steps = 30 }
ok(modified(pair, "lie(2)", both).amplitude < 1e-12, "on a product")
local held = dm.system { Q = dm.product(G, dm.R(3)), L = function(q, v)
  return kinetic(v) + (v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 - q[2][3]
end, constraint = function(q) return q[2] - q[1] * dm.vector { 0, 0, 1 } end }
for _, rule in ipairs { "lie(1)", "lie(2)", "lie(1, gauss(1), cayley)", "lobatto(3)" } do
  local R = G:exp { 0.4, 0, 0 }
  local m = modified(held, rule, { q = { R, R * dm.vector { 0, 0, 1 } }, steps = 40,
    v = { 0, 0, 2.5, 0, 0, 0 } })
  ok(m.amplitude < 1e-12, rule .. " keeps one under constraints", m.amplitude)
end
raises("does not step the system with its action", function()
  dm.system { Q = G, L = function(R, w) return w:dot(w) / 2 - R[3][3] end }
    :solver { rule = "rotations(2)", h = 0.1 }:modified_energy(tilted)
end)

---- where a step ends to exist; the tangent group of maps other than exp ----

local function V(s, c) return 3 * c end
local axis = dm.system { Q = G, L = function(R, w)
  return (7 * w[1] ^ 2 + 8 * w[2] ^ 2 + w[3] ^ 2) / 2 - V(R[2][1], R[1][1])
end }
local ends = axis:solver { rule = "lie(1)", h = 0.1 }:fold { q = G:exp { 0, 0, 0.3 }, v = { 0, 0, 0.5 } }
local line = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] ^ 2 / 2 - V(dm.sin(q[1]), dm.cos(q[1]))
end }
local half = line:solver { rule = "gauss(1)", h = ends.h }:step { q = { 0.3 }, v = { 0.5 } }
ok(not ends.fold, "no fold, but the end of the chart")
near(half[1] - 0.3, math.pi, 1e-6, "where a step of the same turn on the line is half a turn")
local Ld = dm.discrete_lagrangian(swung, { rule = "lie(2, gauss(2), cayley)", h = 0.3 })
local g0, g1 = G:exp { 0.1, 0.2, 0.3 }, G:exp { 0.3, 0.1, 0.5 }
local W, e = Ld:two_form(g0, g1), 1e-5
for k = 1, 3 do
  local u = dm.zeros(3)
  u[k] = e
  local slope = (Ld:legendre_minus(g0, g1 * G:exp(u)) - Ld:legendre_minus(g0, g1 * G:exp(-u)))
    * (0.5 / e)
  near((slope - W:column(k)):norm(), 0, 1e-8, "the two-form is the derivative of p0")
end
for _, Q in ipairs { G, dm.SE(3), dm.SL(2) } do
  local v = {}
  for i = 1, Q.dimension do v[i] = 0.3 / i end
  local bent = dm.system { Q = Q, L = function(g, x) return kinetic(x) - g[1][1] ^ 2 / 2 end }
    :solver { rule = "lie(2, gauss(2), cayley)", h = 0.1 }
  local start = { q = Q:identity(), v = v, steps = 3 }
  ok(bent:symplecticity(start) < 1e-13, tostring(Q) .. ": by the Cayley map, symplectic")
  local M = bent:tangent(start)
  local p, u = bent.system:legendre(start.q, v), dm.zeros(Q.dimension)
  u[2] = 1e-4
  local up = bent:run { q = Q:exp(u), p = p, steps = 3 }
  local down = bent:run { q = Q:exp(-u), p = p, steps = 3 }
  near(((up.p[4] - down.p[4]) * 5e3 - M:column(2):slice(Q.dimension + 1, 2 * Q.dimension)):norm(),
    0, 1e-7, "and its tangent map is the derivative")
end
-- friction: at rest a hanging ball swings as s^2 + c s + 1 = 0 has it
local c = 0.3
local damped = dm.system { Q = G, L = function(R, w) return w:dot(w) / 2 - R[3][3] end,
  force = function(_, w) return -c * w end }
local rest = damped:linearize { q = G:exp { math.pi, 0, 0 } }
near(rest.rates[2], -c / 2, 1e-14, "the rate of a damped swing, linearized on a group")
near(rest.fastest, math.sqrt(1 - c * c / 4), 1e-14, "and its frequency")
local T = damped:solver { rule = "lobatto(3)", h = 0.02 }:tangent { q = G:exp { math.pi, 0, 0 },
  v = { 0, 0, 0 }, steps = 50 }
near(T:det(), math.exp(-3 * c), 1e-9, "volumes shrink with friction, by the lift")
T = damped:solver { rule = "lie(2)", h = 0.02 }:tangent { q = G:exp { math.pi, 0, 0 },
  v = { 0, 0, 0 }, steps = 50 }
near(T:det(), math.exp(-3 * c), 1e-9, "and in the chart")

-- sections by entries of elements; not by quaternions, whose sign jumps
local crossed = swung:solver { rule = "lobatto(3)", h = 0.05 }:section { q = tilted.q, p = tilted.p,
  g = "R31", t = 10, x = "R33", y = "p1" }
ok(#crossed.orbits[1].path.events > 0, "crossings of an entry")
for _, e in ipairs(crossed.orbits[1].path.events) do near(e.q[3][1], 0, 1e-12, "R31 is zero there") end
local looking = swung:solver { rule = "lie(1)", h = 0.1 }
raises("must be one of p1, p2, p3, t, R31", looking.section, looking,
  { q = tilted.q, p = tilted.p, g = "R31", t = 1, x = "q1", y = "p1" })

-- the mass of a path at an element, of the momenta alone; singularities of a product
local run = pair:solver { rule = "lie(1)", h = 0.1 }:run { q = both.q, v = both.v, steps = 3 }
near(run:mass(run.q[2])[5][5], 0.7 + 0.3 * 5, 1e-14, "path:mass of an element")
ok(pair:solver { rule = "lie(1)", h = 0.1 }:singularities { q = both.q, v = both.v, steps = 3 }.worst
  < 10, "singularities along a run on a product")

-- maps of stability with torques and joints, and what is chaotic
local damping = dm.system { Q = G, L = function(R, w) return w:dot(w) / 2 - R[3][3] end,
  force = function(_, w) return -0.1 * w end }
ok(damping:stability { q = G:exp { 0.4, 0, 0 }, v = { 0.1, 0.2, 0.3 }, t = 5, h = { 0.02 },
  rules = { "lie(1)" }, refine = false }:at(1, 1).class == "bounded", "a map with a torque")
local wild = dm.system { Q = G, L = function(R, w)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 - 3 * R[3][3] - 2 * R[3][1]
end }
for _, rule in ipairs { "lie(1)", "gauss(2)" } do
  local chaos = wild:stability { q = G:exp { 1.4, 0.3, 0 }, v = { 0.5, 0.7, 0.3 }, steps = 4000,
    h = { 0.05 }, rules = { rule }, refine = false }
  ok(chaos:at(1, 1).class == "chaotic", rule .. ": a heavy body without symmetry is chaotic")
  local calm = free:stability { q = G:identity(), v = { 0.5, 0.7, 0.3 }, steps = 4000,
    h = { 0.05 }, rules = { rule }, refine = false }
  ok(calm:at(1, 1).class == "bounded", rule .. ": a free one is not")
end

tap.done()
