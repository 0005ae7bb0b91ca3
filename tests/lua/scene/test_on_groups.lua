-- scenes of systems on groups: errors against closed forms, what is watched, what is refused
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local G, I1, I3 = dm.SO(3), 1.3, 0.7
local one = G:identity()
-- a free symmetrical body: J stays in space, the body turns about J by |J| t/I1 and about its axis
local free = dm.system { Q = G,
  L = function(_, xi) return (I1 * (xi[1]^2 + xi[2]^2) + I3 * xi[3]^2) / 2 end }
local xi = { 0.6, -0.2, 1.7 }
local J = { I1 * xi[1], I1 * xi[2], I3 * xi[3] }
local size = math.sqrt(J[1]^2 + J[2]^2 + J[3]^2)
local lambda = (I3 - I1) / I1 * xi[3]
local function R33(t)
  local c = (J[3] / size)^2
  return c + (1 - c) * math.cos(size * t / I1)
end
local function p1(t) return I1 * (xi[1] * math.cos(lambda * t) - xi[2] * math.sin(lambda * t)) end

for _, tolerance in ipairs { 1e-3, 1e-6, 1e-9 } do
  local scene = dm.scene { system = free, q = one, v = xi, watch = { "R33", "p1" },
    tolerance = tolerance, until_t = 12 }
  local at = {}
  for i = 1, 500 do at[i] = 12 * i / 500 end
  local run, worst = scene:run { at = at }, 0
  local r, p = run:column "R33", run:column "p1"
  for i, t in ipairs(at) do
    worst = math.max(worst, math.abs(r[i] - R33(t)), math.abs(p[i] - p1(t)))
  end
  ok(worst <= tolerance and worst <= run.error_estimate, ("tolerance %g"):format(tolerance), worst)
  ok(scene.best.n == 3 and not scene.cut, "the system as given", scene.best.n)
end

-- straight lines between the rows of a plain run
local scene = dm.scene { system = free, q = one, p = J, watch = { turn = function(g) return g[3] end },
  tolerance = 1e-4, until_t = 5 }
local run = scene:run()
local t, x, worst = run.t, run:column "turn3", 0
for i = 1, #t - 1 do
  local s = (t[i] + t[i + 1]) / 2
  worst = math.max(worst, math.abs((x[i] + x[i + 1]) / 2 - R33(s)))
end
ok(worst <= 1e-4, "lines between rows", worst)
ok(scene:why():find "it lives on SO%(3%)", "why there is no other model")

-- a product, with forces; a constraint that leaves a pendulum
local Q = dm.product(G, dm.R(1))
local drag = dm.system { Q = Q, L = function(_, w) return w:dot(w) / 2 end,
  force = function(_, w) return { -w[1], -w[2], -w[3], -2 * w[4] } end }
run = dm.scene { drag, q = { one, { 0 } }, v = { 0, 0, 1, 3 }, tolerance = 1e-7, until_t = 2,
  watch = { "R12_1", "p4", y = function(g) return g[2][1] end } }:run { at = { 0.7, 2 } }
for i, time in ipairs { 0.7, 2 } do
  near(run:column "R12_1"[i], -math.sin(1 - math.exp(-time)), 1e-7, "a body with drag")
  near(run:column "p4"[i], 3 * math.exp(-2 * time), 1e-7, "a particle with drag")
  near(run:column "y"[i], 1.5 * (1 - math.exp(-2 * time)), 1e-7, "where it is")
end
local hung = dm.system { Q = G, L = function(g, w) return w:dot(w) / 2 - g[1][2] end,
  constraint = function(g) return { g[3][1], g[3][2] } end }
local flat = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2 / 2 + math.sin(q[1]) end }
local a = dm.scene { hung, q = one, v = { 0, 0, 0.3 }, watch = { "R11" }, tolerance = 1e-7,
  until_t = 4 }:run { at = { 1, 4 } }
local b = flat:solver({ rule = "gauss(6)", h = 0.01 }):run { q = { 0 }, v = { 0.3 }, at = { 1, 4 } }
for i = 1, 2 do
  near(a:column "R11"[i], math.cos(b.q[i][1]), 2e-7, "turns about one axis: a pendulum")
end

-- the steps of a run on a group, as long as their error allows
local top = dm.system { Q = G, L = function(g, w) return (w[1]^2 + 2*w[2]^2 + 3*w[3]^2)/2 - g[3][3] end }
local ends = {}
for _, rule in ipairs { "gauss(5)", "lie(4)" } do
  ends[#ends + 1] = top:solver({ rule = rule, h = 0.1 }):run { q = one, v = { 0.1, 0.2, 5 },
    at = { 3 }, control = { tolerance = 1e-14 } }.q[1]
end
ok(G:distance(ends[1], ends[2]) < 1e-11, "controlled steps of the lift and of the chart",
  G:distance(ends[1], ends[2]))

-- refused by name
local function try(change)
  local o = { system = free, q = one, v = xi, watch = { "R33" }, tolerance = 1e-3, until_t = 1 }
  for key, value in pairs(change) do o[key] = value end
  return function() dm.scene(o) end
end
raises("there is no 'q1'", try { watch = { "q1" } })
raises("there is no 'R43'", try { watch = { "R43" } })
raises("there is no 'p4'", try { watch = "p4" })
raises("nothing is watched", try { watch = {} })
raises("option 'symmetry'", try { symmetry = {} })
raises("name entries of the element", try { watch = "picture" })
raises("the one of 'R33'", try { tolerance = { x = 1 } })
-- an H without a Lagrangian, in coordinates and on groups
local function vortices(q, p)
  return -0.5 * dm.log((q[1] - q[2]) ^ 2 + (p[1] - p[2]) ^ 2)
end
local pair = dm.system { Q = dm.R(2), H = vortices }
local begin = { system = pair, q = { 0.5, -0.5 }, p = { 0, 0 }, tolerance = 1e-6, until_t = 3 }
begin.watch = { "q1", "p2", "energy", apart = function(q, v, t, p)
  return (q[1] - q[2]) ^ 2 + (p[1] - p[2]) ^ 2
end }
scene = dm.scene(begin)
run = scene:run { at = { 1.3, 3 } }
for i, time in ipairs { 1.3, 3 } do
  near(run:column "q1"[i], 0.5 * math.cos(2 * time), 1e-6, "two vortices turn about their middle")
  near(run:column "apart"[i], 1, 1e-6, "and stay apart")
end
ok(scene:why():find "H without a Lagrangian", "why they have no other model")
begin.watch, begin.tolerance = "picture", nil
run = dm.scene(begin):run { at = { 3 } }
near(run:column "q2"[1], -0.5 * math.cos(6), 2e-3, "a picture of them")
begin.watch, begin.tolerance = { "z" }, 1e-6
raises("no column 'z'", dm.scene, begin)
begin.watch, begin.symmetry = { "q1" }, { action = function(_, q) return q end }
raises("this system has only H", dm.scene, begin)
-- H = 3 mu1 turns about axis 1 of the body: R33 = cos 3t; with mu1^4/4 the rate is mu1^3
for _, case in ipairs { { function(_, p) return 3 * p[1] end, 3 },
  { function(_, p) return p[1] ^ 4 / 4 end, 0.8 ^ 3 } } do
  run = dm.scene { dm.system { Q = G, H = case[1] }, q = one, p = { 0.8, 0.2, 0.1 },
    watch = { "R33", "p1" }, tolerance = 1e-7, until_t = 2 }:run { at = { 2 } }
  near(run:column "R33"[1], math.cos(2 * case[2]), 1e-7, "turns about an axis of the body")
  near(run:column "p1"[1], 0.8, 1e-7, "whose momentum stays")
end

tap.done()
