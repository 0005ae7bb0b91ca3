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
local scene = spring(1e6)
local run = scene:run()
ok(run.error_estimate <= 1e-3, "the tolerance is delivered", run.error_estimate)
ok(scene.best.model:words():find "a held at" and #run.columns == 2, "by a model of one dimension", scene.best.model:words())
local exact = stiff(1e6):solver({ rule = "gauss(5)", h = 1e-3 }):run { q = { 9.81e-6, 0.5 }, v = { 0, 0 }, t = 5, every = 5000 }
near(run:column "theta"[#run], exact.q[#exact][2], 1e-3, "as an independent run says")
local why = scene:why()
ok(why:find "dropped" and why:find "chosen" and why:find "as given" and why:find "agree to", "why: the ladder")
ok(tostring(scene):find "theta" and tostring(run):find "error", "both print themselves")
ok(#run == #run.t and run.t[#run] > 4.99, "a run is like a path")

-- a profile that is given decides without a clock
local file = os.tmpname()
scene.profile:save(file)
local again, third = spring(1e6, { profile = file }), spring(1e6, { profile = file })
again:run()
third:run()
ok(again.best.rule == third.best.rule and again.best.N == third.best.N and again.best.ns == third.best.ns, "the same choice for one profile")
ok(again.best.rule == scene.best.rule and again.best.N == scene.best.N, "which is that of the scene that measured it")
os.remove(file)

-- what cannot be promised
raises("tolerance", function() spring(1e6, { tolerance = 1e-30 }):run() end)
raises("tolerance", function() spring(1e6, { rules = { "symplectic-euler(a)" }, tolerance = 1e-9, seconds = 1 }):run() end)
raises("nothing is watched", spring, 1e4, { watch = {} })
raises("there is no 'thta'", spring, 1e4, { watch = { "thta" } })
raises("'until_t'", spring, 1e4, { until_t = -1 })
raises("'tolerance'", spring, 1e4, { tolerance = 0 })
raises("unknown option 'rule'", spring, 1e4, { rule = "verlet" })
raises("time of its own", spring, 1e4, { rules = { "log-hamiltonian(verlet)" } })
raises("the start is missing", dm.scene, { stiff(1), watch = "theta", tolerance = 1, until_t = 1 })
raises("must be a dm.system", dm.scene, { 1, watch = "theta", tolerance = 1, until_t = 1 })
raises("profile", spring, 1e4, { profile = "/nowhere/at all" })

tap.done()
