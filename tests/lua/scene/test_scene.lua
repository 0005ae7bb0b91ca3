-- dm.scene: the smallest model and the cheapest rule that deliver what is watched, and honest answers where none does
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sqrt = math.cos, math.sqrt

-- a function comes apart
local f = dm.trace(function(q, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 - 500 * (q:norm() - 1) ^ 2 - (1 - 0.01 * q[1]) / q:norm() end, 2, 2)
local terms, x, sum = f:terms(), { { 0.7, -0.4 }, { 0.3, 1.1 } }, 0
for _, term in ipairs(terms) do sum = sum + term(x[1], x[2]) end
ok(#terms == 5, "sums are opened, products of sums multiplied out, powers of sums kept", #terms)
near(sum, f(x[1], x[2]), 1e-12, "terms add up to the function")
for _, term in ipairs(terms) do
  local c, factors = term:factors()
  local product = c
  for _, factor in ipairs(factors) do product = product * factor.base(x[1], x[2]) ^ factor.power end
  near(product, term(x[1], x[2]), 1e-12, "factors multiply to the term")
end
local c, factors = terms[3]:factors()
ok(c == -500 and #factors == 1 and factors[1].power == 2, "a spring is a constant times a square")
near(factors[1].base(x[1], x[2]), sqrt(0.65) - 1, 1e-15, "of its elongation")
local depends = terms[1]:depends()
ok(not depends[1][1] and depends[2][1] and not depends[2][2], "what a term depends on")
raises("terms are of a function that gives one number", function() dm.trace(function(q) return q end, 2):terms() end)

-- a stiff spring watched in the angle only is a pendulum
local function stiff(k)
  return dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
    return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - k / 2 * q[1] ^ 2
  end }
end
local few = { "gauss(4)", "verlet", "blanes-moan(6)", "gauss(2)", "rk4", "lobatto(4)" }
local function spring(k, more)
  local options = { system = stiff(k), q = { 9.81 / k, 0.5 }, v = { 0, 0 }, watch = { "theta" }, tolerance = 1e-3, until_t = 5, rules = few }
  for key, value in pairs(more or {}) do options[key] = value end
  return dm.scene(options)
end
local scene = spring(1e5)
local run = scene:run()
ok(run.error_estimate <= 1e-3, "the tolerance is delivered", run.error_estimate)
ok(scene.best.model:words():find "a held at" and #run.columns == 2, "by a model of one dimension", scene.best.model:words())
local exact = stiff(1e5):solver({ rule = "gauss(5)", h = 1e-3 }):run { q = { 9.81e-5, 0.5 }, v = { 0, 0 }, t = 5, every = 5000 }
near(run:column "theta"[#run], exact.q[#exact][2], 1e-3, "as an independent run says")
local why = scene:why()
ok(why:find "dropped" and why:find "chosen" and why:find "as given" and why:find "agree to", "why: the ladder")
ok(tostring(scene):find "theta" and tostring(run):find "error", "both print themselves")
ok(#run == #run.t and run.t[#run] > 4.99 and #run:csv() > 20, "a run is like a path")

-- a profile that is given decides without a clock
local file = os.tmpname()
scene.profile:save(file)
local again, third = spring(1e5, { profile = file }), spring(1e5, { profile = file })
again:run()
third:run()
ok(again.best.rule == third.best.rule and again.best.N == third.best.N and again.best.ns == third.best.ns, "the same choice for one profile")
ok(again.best.rule == scene.best.rule and again.best.N == scene.best.N, "which is that of the scene that measured it")
local foreign = {}
for i = 1, 2 do
  foreign[i] = dm.scene { system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, q = { 0.8, 0 }, v = { 0, 1.2 },
    watch = { "q1" }, tolerance = 1e-5, until_t = 20, rules = few, profile = file }
  foreign[i]:run()
end
ok(foreign[1].best.rule == foreign[2].best.rule and foreign[1].best.N == foreign[2].best.N and foreign[1].best.ns == foreign[2].best.ns,
  "also for a system that the profile does not know")
ok(tostring(scene.profile):find "measured" and tostring(foreign[1].profile):find "as given", "profiles say what they are")
local handle = assert(io.open(file, "a"))
handle:write "0123 4 x y z verlet\n"
handle:close()
raises("does not read", spring, 1e6, { profile = file })
os.remove(file)

-- the cheapest model, for other systems
local function kinds(options)
  local all = dm.scene(options)
  all:run()
  return all.best.model:words(), all
end
local fast = { "gauss(4)", "blanes-moan(6)", "verlet", "rattle", "gauss(2)" }
-- is there a model in the ladder of which all these words are said, and was it kept? (what is chosen of models of like cost is up to the clock)
local function kept(scene_, ...)
  for _, row in ipairs(scene_.search.models) do
    local text, fits = row.model:words(), true
    for _, some in ipairs { ... } do fits = fits and text:find(some, 1, true) ~= nil end
    if fits then return row.kept, row.error end
  end
end
local function newton(name, L, more)
  local options = { system = dm.system { Q = dm.R(#more.q), L = L, force = more.force, constraint = more.constraint, name = name }, rules = fast }
  for key, value in pairs(more) do
    if key ~= "force" and key ~= "constraint" then options[key] = value end
  end
  return kinds(options)
end
local function attraction(q, v) return v:dot(v) / 2 + 1 / q:norm() end

-- what is watched does not feel two of three oscillators
local words, all = newton("three oscillators", function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 - q[2] ^ 4 / 4 - q[3] ^ 2 / 2 - q[1] * q[3] / 5 end,
  { q = { 1, 0.5, 1 }, v = { 0, 0.1, 0 }, watch = { "q2" }, tolerance = 1e-6, until_t = 20 })
ok(kept(all, "without q1, q3"), "coordinates that nothing watched feels fall off", words)
ok(#all.rungs[#all.rungs]:kept() == 1, "one is left")
words, all = newton("two of them", function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 - q[2] ^ 4 / 4 - q[3] ^ 2 / 2 - q[1] * q[3] / 5 end,
  { q = { 1, 0.5, 1 }, v = { 0, 0.1, 0 }, watch = { "q3" }, tolerance = 1e-6, until_t = 20 })
ok(kept(all, "without q2, which") and not kept(all, "without q1"), "those that are felt stay", words)

-- motion in a plane, drag too weak to be seen, and strong enough
local plane = { q = { 1, 0, 0 }, v = { 0, 1.2, 0 }, watch = { "q1" }, tolerance = 1e-4, until_t = 30 }
local function drag(c)
  local options = { force = function(_, v) return -c * v end }
  for key, value in pairs(plane) do options[key] = value end
  return newton("drag", attraction, options)
end
words, all = drag(1e-9)
ok(kept(all, "q3 held at 0", "without the force"), "a plane is enough, and drag of 1e-9 is nothing", words)
words, all = drag(1e-3)
ok(kept(all, "q3 held at 0") and kept(all, "without the force") == false, "drag of 1e-3 stays", words)
ok(all.best.error < 1 and all:why():find "without the force: dimension 3", "and why")

-- a term too small to be seen
local function flat(c)
  return newton("J2", function(q, v)
    local r = q:norm()
    return attraction(q, v) - c / 2 * (3 * q[3] ^ 2 / r ^ 2 - 1) / r ^ 3
  end, { q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, watch = { "q1" }, tolerance = 1e-4, until_t = 20 })
end
words, all = flat(1e-9)
ok(kept(all, "without the 2 smallest terms"), "a J2 of 1e-9 is nothing", words)
words, all = flat(1e-2)
ok(not kept(all, "without"), "a J2 of 1e-2 is", words)

-- a stiff rod becomes a constraint of two coordinates
words, all = newton("stiff rod", function(q, v) return v:dot(v) / 2 - 9.81 * q[2] - 1e7 / 2 * (q:norm() - 1) ^ 2 end,
  { q = { math.sin(0.5), -cos(0.5) }, v = { 0, 0 }, watch = { "q1" }, tolerance = 1e-3, until_t = 4 })
ok(words:find "as a constraint" and all.best.n == 2, "a stiff rod is a constraint", words)
-- but not when its oscillation is what is watched
words = newton("stretched rod", function(q, v) return v:dot(v) / 2 - 9.81 * q[2] - 1e5 / 2 * (q:norm() - 1) ^ 2 end,
  { q = { 1.01 * math.sin(0.5), -1.01 * cos(0.5) }, v = { 0, 0 }, watch = { r = function(q) return q:norm() end }, tolerance = 1e-3, until_t = 1 })
ok(not words:find "constraint", "unless its oscillation is watched", words)

-- cyclic coordinates that are not watched are reduced away; watched rates of theirs are known all the same
local function spherical(what, more)
  local options = { system = dm.system { Q = dm.R(2), coordinates = { "theta", "phi" }, L = function(q, v)
    return (v[1] ^ 2 + math.sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + cos(q[1])
  end }, q = { 1, 0 }, v = { 0, 0.9 }, watch = what, tolerance = 1e-5, until_t = 20, rules = fast }
  for key, value in pairs(more or {}) do options[key] = value end
  if what == "picture" then options.tolerance = nil end
  return kinds(options)
end
words, all = spherical { "theta", spin = function(_, v) return v[2] end }
ok(kept(all, "reduced by phi") and all.rungs[#all.rungs].system.Q.dimension == 1, "a spherical pendulum of which phi is not watched is reduced", words)
words, all = spherical { "phi" }
ok(kept(all, "reduced") == nil, "where phi is watched it is not", words)
local turn = { action = function(a, q) return { q[1] * cos(a) - q[2] * math.sin(a), q[1] * math.sin(a) + q[2] * cos(a), q[3] } end,
  section = function(x) return { x[1], 0, x[2] } end }
local told = { system = dm.system { Q = dm.R(3), L = function(q, v)
  local r = q:norm()
  return attraction(q, v) - 0.02 * (3 * q[3] ^ 2 / r ^ 2 - 1) / r ^ 3
end }, q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, watch = { r = function(q) return q:norm() end }, tolerance = 1e-8, until_t = 20, rules = { "gauss(6)" },
  symmetry = turn }
words, all = kinds(told)
local rung
for _, row in ipairs(all.search.models) do rung = row.model:words():find "coordinates of the symmetry" and row or rung end
ok(rung and rung.kept and rung.error < 1e-2, "a symmetry that is told gives a reduced model", rung and rung.error)
told.watch = { "q1" }
words, all = kinds(told)
ok(not words:find "symmetry" and not all:why():find "coordinates of the symmetry", "unless what is watched turns with it", words)
told.symmetry = { map = turn.action }
raises("'symmetry'", kinds, told)

-- what is watched may be several numbers, momenta, the energy; each with a tolerance of its own
words, all = spherical({ "p_phi", "energy", e = function(q) return { cos(q[1]), math.sin(q[1]) } end },
  { tolerance = { p_phi = 1e-3, energy = 1e-3, e = 1e-4 } })
local columns = all:run()
ok(#columns.columns == 5 and columns.error_estimate <= 1, "several columns, errors in parts of their tolerances", columns.error_estimate)
near(columns:column "p_phi"[#columns], 0.9 * math.sin(1) ^ 2, 1e-3, "a momentum, of a model without its coordinate (" .. words .. ")")
raises("the one of 'energy'", spherical, { "energy" }, { tolerance = { theta = 1 } })

-- a picture: every coordinate to a pixel, with rows for lines
words, all = spherical "picture"
local picture = all:run()
ok(#picture.columns == 3, "a picture watches every coordinate", #picture.columns)
local middles = {}
for i = 1, #picture - 1 do middles[i] = (picture.t[i] + picture.t[i + 1]) / 2 end
local between, bend = all:run { at = middles }, 0
local theta, of_middles = picture:column "theta", between:column "theta"
for i = 1, #middles do
  local line = (theta[i] + theta[i + 1]) / 2
  bend = math.max(bend, math.abs(of_middles[i] - line) / all.problem.tolerance.theta)
end
ok(bend < 1.3, "with rows so close that straight lines between them are as good as the tolerance", bend)
ok(all.problem.tolerance.theta < 0.1 and all.problem.tolerance.theta > 1e-4, "to a pixel of its size", all.problem.tolerance.theta)

-- linear models are solved: a chain in two of its modes, free ends, a hill, t0
local masses = dm.system { Q = dm.R(12), L = function(q, v)
  local U = 0
  for i = 1, 11 do U = U + (q[i + 1] - q[i]) ^ 2 end
  return (v:dot(v) - U) / 2
end }
local pi, x0, v0 = math.pi, {}, {}
for i = 1, 12 do x0[i], v0[i] = 0.3 + cos(3 * pi * (i - 0.5) / 12), 0.1 + 0.2 * cos(5 * pi * (i - 0.5) / 12) end
local solved = dm.scene { masses, q = x0, v = v0, watch = { "q2", "p7" }, tolerance = 1e-9, t0 = 2, until_t = 102 }
local function w(k) return 2 * math.sin(k * pi / 24) end
local times, worst = {}, 0
for i = 1, 500 do times[i] = 2 + 0.2 * i end
local run = solved:run { at = times }
for i, t in ipairs(times) do
  local s = t - 2
  local q2 = 0.3 + 0.1 * s + cos(3 * pi * 1.5 / 12) * cos(w(3) * s) + 0.2 * cos(5 * pi * 1.5 / 12) * math.sin(w(5) * s) / w(5)
  local p7 = 0.1 - w(3) * cos(3 * pi * 6.5 / 12) * math.sin(w(3) * s) + 0.2 * cos(5 * pi * 6.5 / 12) * cos(w(5) * s)
  worst = math.max(worst, math.abs(run:column "q2"[i] - q2), math.abs(run:column "p7"[i] - p7))
end
ok(worst < 2e-12 and worst <= run.error_estimate + 1e-12, "three of twelve modes, solved in closed form", worst)
ok(solved.best.n == 3 and solved.best.rule == "exact" and tostring(solved):find "solved, exact:", "and nothing is stepped", tostring(solved))
local hill = dm.scene { dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 + 4 * q[1] ^ 2) / 2 end }, q = { 1e-3 }, v = { 3e-3 }, watch = { "q1", "p1" },
  tolerance = 1e-8, until_t = 3 }
local top = hill:run { at = { 1, 3 } }
tap.near(top:column "q1"[2], 1.25e-3 * math.exp(6) - 0.25e-3 * math.exp(-6), 1e-12, "a hill: cosh 2t and sinh 2t")
tap.near(top:column "p1"[2], 2.5e-3 * math.exp(6) + 0.5e-3 * math.exp(-6), 1e-11, "and the momentum")
ok(hill.best.rule == "exact", "solved, too", hill.best.rule)

-- L linear in v, forces, time, constraints as they are given
words, all = newton("first order", function(q, v) return q[2] * v[1] - (q[1] ^ 2 + q[2] ^ 2) / 2 end,
  { q = { 1, 0 }, v = { 0, -1 }, watch = { "q1" }, tolerance = 1e-6, until_t = 10, rules = { "gauss(2)", "degenerate(2)" } })
ok(all.best.rule == "degenerate(2)" and all:why():find "left out: gauss", "rules that cannot are left out, and it is said why", all.best.rule)
words, all = newton("driven", function(q, v, t) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 + q[1] * math.sin(2 * t) / 10 end,
  { q = { 1 }, v = { 0 }, t0 = 1, watch = { "q1" }, tolerance = 1e-5, until_t = 6, force = function(_, v) return { -v[1] / 10 } end })
local last = all:run { at = { 6 } }
-- x'' + x'/10 + x = sin(2 t)/10: the particular solution A sin 2t + B cos 2t, the rest decays
local A, B = -0.3 / 9.04, -0.02 / 9.04
local function forced(t) return A * math.sin(2 * t) + B * cos(2 * t), 2 * A * cos(2 * t) - 2 * B * math.sin(2 * t) end
local x0, v0 = forced(1)
local w = sqrt(1 - 0.0025)
local a, b = 1 - x0, ((0 - v0) + 0.05 * (1 - x0)) / w
near(last:column "q1"[1], forced(6) + math.exp(-0.25) * (a * cos(5 * w) + b * math.sin(5 * w)), 1e-5, "a driven oscillator in closed form")
words, all = newton("rod", function(q, v) return v:dot(v) / 2 - 9.81 * q[3] end, { q = { 1, 0, 0 }, v = { 0, 0, 0 }, watch = { "q3" }, tolerance = 1e-4,
  until_t = 2, constraint = function(q) return q:dot(q) - 1 end })
ok(kept(all, "q2 held at 0"), "a pendulum on a rod swings in a plane", words)

-- what cannot be promised
raises("tolerance", function() spring(1e3, { tolerance = 1e-30 }):run() end)
raises("tolerance", function() spring(1e3, { rules = { "symplectic-euler(a)" }, tolerance = 1e-9, seconds = 1 }):run() end)
raises("after until_t", scene.run, scene, { at = { 1, 9 } })
raises("entry 1 is NaN", scene.run, scene, { at = { 0 / 0 } })
local last_t = 5
local rounded = scene:run { at = { last_t / 2, last_t * (1 + 2 ^ -52) } }
ok(rounded:column "t"[2] == last_t, "a time that rounding has put behind until_t is that", rounded:column "t"[2])
raises("unknown option 'steps'", scene.run, scene, { steps = 3 })
raises("takes a table", scene.run, scene, 3)
raises("unknown rule 'nonsense'", spring, 1e6, { rules = { "nonsense" } })
raises("nothing is watched", spring, 1e4, { watch = {} })
raises("there is no 'thta'", spring, 1e4, { watch = { "thta" } })
raises("'until_t'", spring, 1e4, { until_t = -1 })
raises("'tolerance'", spring, 1e4, { tolerance = 0 })
raises("unknown option 'rule'", spring, 1e4, { rule = "verlet" })
raises("'costs'", spring, 1e4, { costs = "hours" })
raises("the start is missing", dm.scene, { stiff(1), watch = "theta", tolerance = 1, until_t = 1 })
raises("must be a dm.system", dm.scene, { 1, watch = "theta", tolerance = 1, until_t = 1 })
raises("profile", spring, 1e4, { profile = "/nowhere/at all" })

-- a long run whose coarse steps fail again and again before one holds
do
  local sqrt, sin, cos = math.sqrt, math.sin, math.cos
  local double = dm.system { Q = dm.R(4), coordinates = { "theta", "r1", "r2", "phi" }, L = function(q, v)
    local r1, r2, c, s = q[2], q[3], cos(q[4]), sin(q[4])
    local z1, z2, radial, around = -sqrt(1 - r1 ^ 2), -sqrt(0.5625 - r2 ^ 2), v[3], r2 * (v[1] + v[4])
    local a = dm.vector { v[2], r1 * v[1], -r1 * v[2] / z1 }
    local b = a + dm.vector { c * radial - s * around, s * radial + c * around, -r2 * v[3] / z2 }
    return a:dot(a) + 0.75 * b:dot(b) - 19.6 * z1 - 14.7 * (z1 + z2)
  end }
  local far = dm.scene { double, q = { 0, 0.6, 0.45, 0.64 }, v = { 3.5, 0, 0, 0 }, watch = { "r1", "r2", "phi" }, tolerance = 1e-4,
    until_t = 100, rules = { "gauss(4)", "rk8" } }
  tap.ok(far:run().error_estimate <= 1e-4, "where only fine steps get through, more of them are tried")
end

-- rows of a plain run do not fall in step with the motion: two long steps, 256 periods
do
  local swing = dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - q[1]^2) / 2 end }
  for _, case in ipairs { { 5, "gauss(8)" }, { 512 * math.pi, "controlled(rk8)" },
    { 512 * math.pi, "verlet" }, { 512 * math.pi, "gauss(8)" } } do
    local run = dm.scene { swing, q = { 1 }, v = { 0 }, watch = { "q1" }, tolerance = 1e-3,
      until_t = case[1], rules = { case[2] } }:run()
    local t, x, worst = run.t, run:column "q1", 0
    for i = 1, #t - 1 do
      for f = 0.1, 0.9, 0.2 do
        worst = math.max(worst, math.abs((1 - f) * x[i] + f * x[i + 1]
          - math.cos((1 - f) * t[i] + f * t[i + 1])))
      end
    end
    tap.ok(worst <= 1e-3 and worst <= run.error_estimate,
      ("lines between rows of %s until %.0f"):format(case[2], case[1]), worst)
  end
end
-- what stands the check may cost more than what is near to the best
local stub = { size = function() return 1, 1 end }
local function found(rule, cost, kept) return { rule = rule, model = stub, N = cost, cost = cost, kept = kept } end
local order = require "dm.scene.search".finalists { bound = 1, seconds = 1, candidates = { found("dear", 9, true), found("out", 2, false), found("best", 1, true),
  found("dearer", 30, true) }, profile = { again = function() end, least = function(_, _, _, N) return N end } }
ok(#order == 3 and order[1].rule == "best" and order[2].rule == "dear" and order[3].rule == "dearer", "dearer ones are tried last", #order)

-- Newton's method that needed more evaluations, as where a step is tried in parts, costs no less
do
  local weights = require "dm.scene.weights"
  local rods = { graphs = function() return "" end, system = dm.system { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 - q[2] - q[4] end,
    constraint = function(q) return { q[1] ^ 2 + q[2] ^ 2 - 1, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - 1 } end } }
  local function work(evaluations, matrices)
    return weights.work({ newton = 30, matrices = matrices, evaluations = evaluations, steps = 9, solves = 9, operations = 32 }, rods, "gauss(6)")
  end
  tap.ok(work(180, 30) > 30 * 36 ^ 2 and work(220, 30) >= work(180, 30), "its matrix counts", work(220, 30))
  tap.ok(work(180, 30) - work(180, 9) > 21 * 36 ^ 2, "as often as it is taken", work(180, 9))
end
-- what a run with steps of its own choice costs by the clock is all of its steps, 50 times as many as N here
do
  local problem_of, pilot = require "dm.scene.model", require "dm.scene.pilot"
  local ring = dm.system { Q = dm.R(8), L = function(q, v)
    local U = 0
    for i = 1, 8 do U = U + dm.exp(q[i] - q[i % 8 + 1]) end
    return v:dot(v) / 2 - U
  end }
  local problem = problem_of.problem(ring, { q = { 1, 0, -1, 0, 0.5, 0, 0, -0.5 }, v = { 0, 0, 0, 0, 0, 0, 0, 0 }, until_t = 5, watch = { "q1" },
    tolerance = 1e-6 })
  local model = problem_of.given(problem):ready()
  local _, report = pilot.go(model, "controlled(rk8)", 64, { steps = 64 })
  -- the least of the very runs that are measured, whatever else the machine does meanwhile
  local core, go, least = require "dm.core", pilot.go, math.huge
  pilot.go = function(...)
    local before = core.cpu()
    local path, told = go(...)
    least = math.min(least, told.ns_per_step * told.steps, 1e9 * (core.cpu() - before))
    return path, told
  end
  local cost = require "dm.scene.profile".new "clock":cost(model, "controlled(rk8)", 64)
  pilot.go = go
  tap.ok(report.steps > 640 and least < math.huge and cost > 0.1 * least, "the clock counts all steps", cost / least)
  local fast = dm.system { Q = dm.R(1), L = function(_, v) return -math.sqrt(1 - v[1] ^ 2) end }
  tap.ok(ring:structure().quadratic_in_v and not fast:structure().quadratic_in_v, "quadratic in v or not")
end
-- units of astronomy: the steps of log-hamiltonian are as long as its own time asks for, and no time is lost on it
do
  local mu, a = 1.32712440018e20, 1.496e11
  local year = 2 * math.pi * math.sqrt(a ^ 3 / mu)
  local earth = dm.scene { dm.system { Q = dm.R(2), L = function(q, v) return 5.97e24 * (v:dot(v) / 2 + mu / q:norm()) end }, q = { 0.5 * a, 0 },
    v = { 0, math.sqrt(3 * mu / a) }, watch = { "q1" }, tolerance = 1e6, until_t = year, seconds = 20, rules = { "log-hamiltonian(kahan-li(8))", "gauss(6)" } }
  tap.near(earth:run { at = { year } }:column "q1"[1], 0.5 * a, 1e6, "a year")
  local tried
  for _, c in ipairs(earth.candidates) do tried = tried or c.rule:find "log" and c.kept and c.N end
  tap.ok(tried and tried < 25, "log-hamiltonian reaches it in a few steps", tried)
end

-- a start where V almost vanishes: log-hamiltonian stands still there, and took all the seconds to find out
do
  local saddle = dm.scene { dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 2 / 2 - q[1] ^ 4 / 4 end }, q = { 1e-3 }, v = { 0 },
    watch = { "q1" }, tolerance = 1e-4, until_t = 20 }
  local run = saddle:run()
  tap.ok(run.error_estimate <= 1e-4 and not saddle.cut, "from the top of a hill in double precision", tostring(saddle.cut))
  tap.ok(saddle:why():find("log-hamiltonian(kahan-li(8)), log-hamiltonian(verlet): cannot step this system: V almost vanishes at the start", 1, true),
    "its start says so, without a step", saddle:why())
end

-- a deadline with a constraint
do
  local rod = dm.scene { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return { q:dot(q) - 1 } end },
    q = { 0.6, -0.8 }, v = { 0, 0 }, watch = { "q1" }, until_t = 1, frame = 0.05, per_step = 1e-3, seconds = 2 }
  tap.ok(rod:run().error_estimate < 1e-6 and rod.best.rule:find "rattle" and rod.best.worst_step <= 1e-3, "rattle keeps it", tostring(rod))
end

-- the choice is the cheapest; where a model of fewer coordinates does as well the report says what it costs
do
  local function centre(power, rule)
    local system = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q:norm() ^ power / 4 end }
    local scene = dm.scene { system, q = { 0.9, 0.1, 0 }, v = { 0, 0.7, 0.5 }, watch = { r = function(q) return q:norm() end }, tolerance = 1e-5, until_t = 20, rules = { rule } }
    return scene:why(), scene.best.n
  end
  local words, n = centre(4, "blanes-moan(6)")
  local times = words:match "\nleast model that keeps the tolerance: dimension 1, in polar [^:]*: blanes%-moan%(6%), ([%d.]+) times the cost of the choice\n"
  ok(n == 3 and times and tonumber(times) > 1, "a smaller model that costs more is named", words)
  words, n = centre(-1, "gauss(6)")
  ok(n == 1 and not words:find "least model", "and where it is chosen it is the choice", words)
end
tap.done()
