-- rkmk4 and crouch-grossman3: orders on each group, spatial momentum, drift of the energy
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function finish(system, rule, t, steps, start)
  local path = system:solver { rule = rule, h = t / steps }
    :run { q = start.q, p = start.p, steps = steps, every = steps }
  return path.q[2], path.p[2]
end

local affine = dm.group { name = "Aff(1)",
  basis = { { { 0, 1 }, { 0, 0 } }, { { 1, 0 }, { 0, 0 } } } }
-- kinetic energy with different moments and a potential that sees the whole element
local function on(Q, V)
  local d = Q.dimension
  return dm.system { Q = Q, L = function(g, x)
    local sum = 0
    for i = 1, d do sum = sum + (0.7 + 0.3 * i) * x[i] * x[i] / 2 end
    return sum - V(g)
  end }
end
local cases = {
  { dm.SO(3), function(g) return g[3][3] + 0.3 * g[1][2] end },
  { dm.SU(2), function(q) return q[1] * q[2] + q[3] end },
  { dm.SE(3), function(g) return g[1][1] + g[1][4] * g[1][4] + g[2][4] * g[2][4] / 2 end },
  { dm.SL(2), function(g)
    return 0.2 * (g[1][1] ^ 2 + g[1][2] ^ 2 + g[2][1] ^ 2 + g[2][2] ^ 2)
  end },
  { dm.Heisenberg(1), function(g) return g[1] * g[1] + g[3] * g[3] / 2 end },
  { affine, function(g) return g[1][1] + g[1][2] ^ 2 end },
  { dm.product(dm.SO(3), dm.R(1)), function(g) return g[2][1] ^ 2 + g[1][3][3] * g[2][1] end },
}
for _, case in ipairs(cases) do
  local Q, system = case[1], on(case[1], case[2])
  local p = {}
  for i = 1, Q.dimension do p[i] = 0.5 / i end
  local start = { q = Q:exp(dm.vector(p) * 0.3), p = p }
  local exact = finish(system, "lie(4)", 1, 40, start)
  for rule, order in pairs { rkmk4 = 4, ["crouch-grossman3"] = 3 } do
    local a = Q:distance(finish(system, rule, 1, 40, start), exact)
    local b = Q:distance(finish(system, rule, 1, 80, start), exact)
    near(math.log(a / b, 2), order, 0.15, ("%s on %s: its order"):format(rule, tostring(Q)))
  end
end

-- H that no L has: the field is that of H
local spin = dm.system { Q = dm.SO(3), H = function(R, P) return P[1] * R[3][3] + P[2] end }
local turning = { q = dm.SO(3):exp { 0.3, 0.1, 0 }, p = { 0.4, 0.2, 1 } }
local exact, mu = finish(spin, "gauss(6)", 1, 40, turning)
local g, nu = finish(spin, "rkmk4", 1, 200, turning)
ok(dm.SO(3):distance(g, exact) < 1e-9 and (nu - mu):norm() < 1e-9, "rkmk4 steps a singular H")

-- forces, and the other trivialization
local function damped(side)
  return dm.system { Q = dm.SO(3), trivialization = side,
    L = function(_, w) return w:dot(w) / 2 end, force = function(_, w) return -0.4 * w end }
end
local s = (1 - math.exp(-2)) / 0.4
for _, side in ipairs { "left", "right" } do
  for _, rule in ipairs { "rkmk4", "crouch-grossman3" } do
    local R = damped(side):solver { rule = rule, h = 0.01 }
      :run { q = dm.SO(3):identity(), v = { 0.3, -0.2, 0.5 }, steps = 500 }.q[501]
    near(dm.SO(3):distance(R, dm.SO(3):exp { 0.3 * s, -0.2 * s, 0.5 * s }), 0, 1e-7,
      rule .. " with friction: turned by (1 - exp(-ct))/c")
  end
end

-- a free body: spatial momentum stays, the energy does not
local free = on(dm.SO(3), function() return 0 end)
for _, rule in ipairs { "rkmk4", "crouch-grossman3" } do
  local path = free:solver { rule = rule, h = 0.1 }
    :run { q = dm.SO(3):identity(), p = { 0.9, 0.3, 1.2 }, steps = 5000, every = 50 }
  local J, worst = path:momentum(dm.SO(3)), 0
  for i = 1, #path do worst = math.max(worst, (J[i] - J[1]):norm()) end
  ok(worst < 1e-12, rule .. ": spatial momentum of a free body", worst)
  local E = path:column "energy"
  ok(math.abs(E[#path] - E[1]) > 1.5 * math.abs(E[#path // 2] - E[1]), "and its energy drifts")
end
-- a step may turn by up to pi, whatever the coefficients of its stages
local one = dm.SO(3):identity()
for _, rule in ipairs { "rkmk4", "crouch-grossman3" } do
  local solver = free:solver { rule = rule, h = 1 }
  local path = solver:run { q = one, v = { 0, 0, 3 }, steps = 5 }
  near(dm.SO(3):distance(path.q[6], dm.SO(3):exp { 0, 0, 15 }), 0, 1e-13, rule .. ": 3 rad a step")
  raises("h turns the body by 4 rad", solver.run, solver, { q = one, v = { 0, 0, 4 }, steps = 1 })
end
for _, rule in ipairs(dm.rules()) do
  if rule.name == "rkmk4" or rule.name == "crouch-grossman3" then
    ok(not rule.symplectic and rule.explicit, rule.name .. " says that it is not symplectic")
  end
end
raises("rad; the chart ends at pi", function()
  free:solver { rule = "rkmk4", h = 1 }:run { q = dm.SO(3):identity(), v = { 0, 0, 4 }, steps = 1 }
end)
raises("rk4 and rk8 are for R^n", function()
  dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end }
    :solver { rule = "rkmk4", h = 1 }:run { q = { 0 }, v = { 1 }, steps = 1 }
end)
tap.done()
