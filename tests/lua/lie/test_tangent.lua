-- tangent maps of runs with forces, controls, constraints and rolling on groups, beside differences
-- of runs and motions that are known
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

local G = dm.SO(3)
local SE = dm.SE(3)

-- d(end)/d(eps) of a family of starts {q =, p = | v =}, as (u, dp), by differences to order 4
local function change_of(system, run, family)
  local Q, right = system.Q, system.place.right
  local function apart(a, b)
    return dm.vector(Q:log(right and Q:compose(a, Q:inverse(b)) or Q:compose(Q:inverse(b), a)))
  end
  local function slope(eps)
    local a, b = run(family(eps)), run(family(-eps))
    local u, dp = apart(a.q, b.q), a.p - b.p
    local out = u:totable()
    for i = 1, #dp do out[#out + 1] = dp[i] end
    return dm.vector(out) * (0.5 / eps)
  end
  return (4 * slope(5e-4) - slope(1e-3)) * (1 / 3)
end

local function runner(solver, steps)
  return function(start)
    local path = solver:run { q = start.q, p = start.p, v = start.v, steps = steps, every = steps }
    return { q = path.q[#path], p = path.p[#path] }
  end
end

local function begin(system)
  return function(start)
    return { q = start.q, p = dm.vector(start.p or system:legendre(start.q, start.v)) }
  end
end

-- the largest difference between M w and the differences of the run
local function gap(system, rule, h, steps, families)
  local solver, worst = system:solver { rule = rule, h = h }, 0
  local s = families[1](0)
  local M = solver:tangent { q = s.q, v = s.v, p = s.p, steps = steps }
  for _, family in ipairs(families) do
    local w = change_of(system, begin(system), family)
    local moved = change_of(system, runner(solver, steps), family)
    worst = math.max(worst, (M * w - moved):norm())
  end
  return worst
end

-- free changes: of the element and of the momentum
local function free(Q, g, p, right)
  local out = {}
  for i = 1, 2 * #p do
    out[i] = function(eps)
      local u, dp = {}, {}
      for k = 1, #p do
        u[k], dp[k] = k == i and eps or 0, p[k] + (k + #p == i and eps or 0)
      end
      return { q = right and Q:compose(Q:exp(u), g) or Q:compose(g, Q:exp(u)), p = dp }
    end
  end
  return out
end

local function torque(R, w)
  return { -0.1 * w[1] + 0.05 * R[1][2], -0.2 * w[2] * w[1], 0.1 * R[3][1] - 0.1 * w[3] }
end
local function top(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end
local g0, p0 = G:exp { 0.4, 0.1, 0 }, { 0.2, 0.1, 0.8 }

local forced = dm.system { Q = G, L = top, force = torque }
for _, rule in ipairs { "lie(1)", "lie(2, lobatto(3))", "lie(2, gauss(2), pade(2))", "gauss(2)" } do
  local e = gap(forced, rule, 0.1, 6, free(G, g0, p0))
  ok(e < 1e-10, rule .. ": the tangent map with a torque", e)
end
local held = dm.system { Q = G, L = top,
  control = function(R, w) return { R[1][2] - w[1], w[2] } end,
  force = function(_, w, _, u) return { 0.3 * u[1], -0.2 * w[2] * u[2], u[1] * u[2] } end }
for _, rule in ipairs { "lie(2)", "lobatto(2)" } do
  local e = gap(held, rule, 0.1, 6, free(G, g0, p0))
  ok(e < 1e-10, rule .. ": and with a control that is held", e)
end
local spatial = dm.system { Q = G, trivialization = "right", force = torque,
  L = function(R, w) return top(R, R:transpose() * w) end }
local e = gap(spatial, "lie(2)", 0.1, 6, free(G, g0, p0, true))
ok(e < 1e-10, "in the right trivialization", e)
-- by lifts, whose stages are off the group, that is not the tangent map of the left one
local right_top = dm.system { Q = G, trivialization = "right",
  L = function(R, w) return top(R, R:transpose() * w) end }
local right_H = dm.system { Q = G, trivialization = "right", H = function(R, m)
  return m:dot(m) / 2 + 0.3 * m[1] ^ 4 + R[3][3]
end }
for _, rule in ipairs { "gauss(2)", "lobatto(2)", "lie(1)", "rkmk4", "crouch-grossman3" } do
  e = gap(right_top, rule, 0.1, 3, free(G, g0, p0, true))
  ok(e < 1e-10, rule .. ": in the right trivialization, without forces", e)
end
e = gap(right_H, "gauss(2)", 0.1, 3, free(G, g0, p0, true))
ok(e < 1e-10, "gauss(2): and of an H alone", e)
-- vectors that grow beside an inertia that depends on g, which is regular all the while: their sum
-- is that of phase space
local grown = right_top:solver { rule = "crouch-grossman3", h = 0.05 }
  :lyapunov { q = g0, p = p0, t = 100, exponents = 6 }
local sum = 0
for i = 1, 6 do sum = sum + grown.exponents[i] end
ok(grown.exponents[1] > 0.02 and math.abs(sum) < 0.01, "exponents by crouch-grossman3", sum)
-- and along the run itself, with the map of 1/g
for _, rule in ipairs { "rkmk4", "lie(2)" } do
  local solver = right_top:solver { rule = rule, h = 0.1 }
  local _, q, p = solver:tangent { q = g0, p = p0, steps = 5 }
  local path = solver:run { q = g0, p = p0, steps = 5 }
  near(G:distance(q, path.q[6]) + (p - path.p[6]):norm(), 0, 1e-14, rule .. ": the end of a run")
end
local turn = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 4 end,
  control = function(_, v) return v[1] end, force = function(_, _, _, u) return -0.4 * u[1] end }
local T = turn:solver { rule = "gauss(1)", h = 0.1 }:tangent { q = 0, p = 0, steps = 1 }
near(T[2][2], 1 - 0.04, 1e-15, "on the line: a step keeps 1 - c h of a momentum at rest")

-- a top hung on its joint: the same motion on SE(3) and on SO(3) x R^3, as T* SO(3)
local function joint_of(place)
  return function(g) local R, x = place(g) return x - R * dm.vector { 0, 0, 1 } end
end
local function of_pair(g) return g[1], g[2] end
local function of_pose(g)
  return dm.matrix { { g[1][1], g[1][2], g[1][3] }, { g[2][1], g[2][2], g[2][3] },
    { g[3][1], g[3][2], g[3][3] } }, dm.vector { g[1][4], g[2][4], g[3][4] }
end
local function energy(w, v, z)
  return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2 + v:dot(v)) / 2 - z
end
local function three(v, first) return dm.vector { v[first], v[first + 1], v[first + 2] } end
local hung = {
  { "SO(3) x R^3", dm.system { Q = dm.product(G, dm.R(3)), constraint = joint_of(of_pair),
    L = function(g, v) return energy(three(v, 1), three(v, 4), g[2][3]) end },
    function(R, w)
      return { R, R * dm.vector { 0, 0, 1 } }, w, R * dm.vector { w[2], -w[1], 0 }
    end },
  { "SE(3)", dm.system { Q = SE, constraint = joint_of(of_pose),
    L = function(g, v) return energy(three(v, 4), three(v, 1), g[3][4]) end },
    function(R, w)
      local x = R * dm.vector { 0, 0, 1 }
      return SE:compose(SE:exp { x[1], x[2], x[3], 0, 0, 0 }, dm.matrix {
        { R[1][1], R[1][2], R[1][3], 0 }, { R[2][1], R[2][2], R[2][3], 0 },
        { R[3][1], R[3][2], R[3][3], 0 }, { 0, 0, 0, 1 } }), { w[2], -w[1], 0 }, w
    end },
}
for _, case in ipairs(hung) do
  local name, system, place, families = case[1], case[2], case[3], {}
  for i = 1, 6 do
    families[i] = function(eps)
      local e, w = { 0, 0, 0 }, { 0.2, 0.1, 1.5 }
      if i <= 3 then e[i] = eps else w[i - 3] = w[i - 3] + eps end
      local q, a, b = place(g0 * G:exp(e), w)
      return { q = q, v = { a[1], a[2], a[3], b[1], b[2], b[3] } }
    end
  end
  for _, rule in ipairs { "lie(1)", "lie(2)", name == "SE(3)" and "lobatto(2)" or nil } do
    e = gap(system, rule, 0.05, 6, families)
    ok(e < 1e-9, rule .. ": the tangent map of a joint on " .. name, e)
    local s = families[1](0)
    e = system:solver { rule = rule, h = 0.05 }:symplecticity { q = s.q, v = s.v, steps = 6 }
    ok(e < 1e-14, rule .. ": symplectic with a joint on " .. name, e)
  end
end

-- M of L is looked at, not that of the prolonged L, in which large tangent vectors hide it
do
  local _, system, place = table.unpack(hung[2])
  local solver, missed = system:solver { rule = "lobatto(2)", h = 0.05 }, 0
  for i = 1, 20 do
    local q, a, b = place(G:exp { 0.1 * i, 0.3 - 0.07 * i, 0.05 * i },
      { 0.2 - 0.04 * i, 0.1 * i, 1.5 - 0.1 * i })
    local v = { a[1], a[2], a[3], b[1], b[2], b[3] }
    missed = missed + (pcall(solver.tangent, solver, { q = q, v = v, steps = 20 }) and 0 or 1)
  end
  near(missed, 0, 0, "tangent maps of a joint from any start, by rounding of any processor")
end

-- the sleeping top, w3 = 4: small changes grow as sqrt(mgl/I - (I3 w3/(2 I))^2), held by a joint
local sleeping = dm.system { Q = SE, constraint = joint_of(of_pose), L = function(g, v)
  return (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + 0.6 * v[6] ^ 2) / 2 - g[3][4]
end }
local upright = { q = SE:exp { 0, 0, 1, 0, 0, 0 }, v = { 0, 0, 0, 0, 0, 4 } }
local rate = math.sqrt(0.5 - 0.36)
local linear = sleeping:linearize(upright)
near(math.max(table.unpack(linear.rates:totable())), rate, 1e-12, "linearized on its constraints")
ok(#linear.rates == 6, "as many rates as the joint leaves")
local step = sleeping:solver { rule = "lie(3)", h = 0.1 }
  :multipliers { q = upright.q, v = upright.v, steps = 1 }
near(math.log(step.largest) / 0.1, rate, 1e-8, "and the multiplier of a step")
local grown = sleeping:solver { rule = "lie(2)", h = 0.1 }
  :lyapunov { q = upright.q, v = upright.v, t = 6, exponents = 6 }
near(grown.sum, 0, 1e-10, "volumes on T* of the joint stay")

-- Suslov's body loses volume: about w = (0, w2, 0) the rate of w1 is -I13 w2/I11 times w2's sign
local suslov = dm.system { Q = G, rolling = function(_, w) return { w[3] } end, L = function(_, w)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 1.5 * w[3] ^ 2) / 2 + 0.5 * w[1] * w[3]
end }
near(suslov:linearize { q = G:identity(), v = { 0, 1, 0 } }.rates[1], -0.5, 1e-14,
  "Suslov's problem linearized")
local all = suslov:solver { rule = "lie(2)", h = 0.05 }
  :lyapunov { q = G:identity(), v = { 0, 1, 0 }, t = 1, exponents = 5 }
near(all.sum, -0.5, 1e-6, "the volume on its constraints shrinks at that rate")

-- an H that no Lagrangian has, linearized on a group: turns about axis 1 at a constant rate
local singular = dm.system { Q = G, H = function(_, p) return 3 * p[1] end }
near(singular:linearize { q = G:identity(), p = { 0, 1, 0 } }.fastest, 3, 1e-14,
  "H = 3 mu1 linearized")

-- its tangent map by rules that step the group itself, in both trivializations
local function only_H(side)
  return dm.system { Q = G, trivialization = side, H = function(R, p, t)
    return p[3] + R[3][3] * p[1] + R[1][2] * dm.cos(t)
  end }
end
for _, rule in ipairs { "rkmk4", "crouch-grossman3" } do
  for _, side in ipairs { "left", "right" } do
    near(gap(only_H(side), rule, 0.1, 10, free(G, g0, p0, side == "right")), 0, 1e-10,
      ("H = p3 + R33 p1 by %s, %s"):format(rule, side))
  end
end

-- groups whose exp is a series of matrices: the chart is short enough for orders above 2, and for
-- the tangent of steps
local function weighted(x)
  local sum = 0
  for i = 1, #x do sum = sum + (0.7 + 0.3 * i) * x[i] ^ 2 / 2 end
  return sum
end
local function pulled(g)
  local sum = 0
  for i = 1, #g do sum = sum + i * g[i][i] + 0.2 * g[1][i] end
  return 0.3 * sum
end
for _, Q in ipairs { dm.GL(3), dm.Sp(4), dm.SE(4) } do
  local system = dm.system { Q = Q, L = function(g, x) return weighted(x) - pulled(g) end }
  local x, v = {}, {}
  for i = 1, Q.dimension do x[i], v[i] = 0.2 / i, 0.3 / i end
  local start = Q:exp(x)
  local function end_of(rule, n)
    return system:solver { rule = rule, h = 0.5 / n }:run { q = start, v = v, steps = n }.q[n + 1]
  end
  local exact = end_of("gauss(4)", 10)
  local a, b = Q:distance(end_of("lie(2)", 5), exact), Q:distance(end_of("lie(2)", 10), exact)
  near(math.log(a / b, 2), 4, 0.15, tostring(Q) .. ": lie(2) by the series of exp")
  local w = dm.vector(v)
  local D = (dm.vector(Q:log(Q:compose(Q:exp(dm.vector(x) + 1e-4 * w), Q:inverse(start))))
    - dm.vector(Q:log(Q:compose(Q:exp(dm.vector(x) - 1e-4 * w), Q:inverse(start))))) * 5e3
  near((D - Q:dexp(x, v)):norm(), 0, 1e-8, "its differential is that of exp")
  local defect = system:solver { rule = "lie(1)", h = 0.05 }
    :symplecticity { q = start, v = v, steps = 2 }
  ok(defect < 1e-14, tostring(Q) .. ": lie(1) is symplectic", defect)
end

-- rotations(k): turns and kicks of the prolonged system; axes that commute may be coupled, there as
-- on R^2, and coordinates may be entries of matrices
local function of_parts(g, w)
  return w[1] ^ 2 / 2 + w[2] ^ 2 + 0.3 * w[3] ^ 2 + w[4] ^ 2 + 0.7 * w[4] * w[5] + w[5] ^ 2
    - g[1][3][3] * g[2][1] - g[2][2] ^ 2
end
local beside = dm.system { Q = dm.product(G, dm.R(2)), L = of_parts }
local by_entries = dm.system { Q = G, L = top, columns = "matrix" }
local unit = dm.SU(2)
local spinor = dm.system { Q = unit, L = function(q, w)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - q[1] * q[2]
end }
for _, case in ipairs {
  { "SO(3)", dm.system { Q = G, L = top }, g0, p0 },
  { "SO(3) x R^2, coupled", beside, { g0, dm.vector { 0.3, 0.2 } }, { 0.2, 0.1, 0.8, 0.3, 0.1 } },
  { "SU(2)", spinor, unit:exp { 0.4, 0.1, 0 }, p0 },
  { "SO(3) by entries", by_entries, g0, p0 },
} do
  local name, system, q, p = case[1], case[2], case[3], case[4]
  for _, rule in ipairs { "rotations(2)", "rotations(4)" } do
    e = gap(system, rule, 0.1, 5, free(system.Q, q, p))
    ok(e < 1e-10, ("%s: the tangent map on %s"):format(rule, name), e)
    e = system:solver { rule = rule, h = 0.1 }:symplecticity { q = q, p = p, steps = 5 }
    ok(e < 1e-14, ("%s: symplectic on %s"):format(rule, name), e)
  end
end
for _, rule in ipairs { "lie(2)", "lie(1, gauss(1), cayley)", "gauss(2)" } do
  e = gap(by_entries, rule, 0.1, 5, free(G, g0, p0))
  ok(e < 1e-10, rule .. ": the tangent map by entries of matrices", e)
end
local flows = beside:solver { rule = "rotations(4)", h = 0.05 }
local fine = beside:solver { rule = "gauss(4)", h = 0.05 }
local place, shove = { g0, dm.vector { 0.3, 0.2 } }, { 0.2, 0.1, 0.8, 0.3, 0.1 }
local one = flows:run { q = place, p = shove, steps = 40 }
local other = fine:run { q = place, p = shove, steps = 40 }
near((one.p[41] - other.p[41]):norm(), 0, 1e-6, "rotations(4) with a coupled R^2 has its motion")
near(dm.system { Q = G, L = top }:solver { rule = "rotations(4)", h = 0.1 }
  :lyapunov { q = g0, p = p0, t = 10, exponents = 6 }.sum, 0, 1e-12, "and keeps volumes")

-- a body of four dimensions on a joint: the matrix of a step of the prolonged system is too large
-- to be written out, and is made row by row
local G4 = dm.SO(4)
local rod = dm.system { Q = dm.product(G4, dm.R(4)),
  constraint = function(g) return g[2] - g[1] * dm.vector { 0, 0, 0, 1 } end,
  L = function(g, v)
    local sum = -g[2][4]
    for i = 1, 10 do sum = sum + (i <= 6 and 0.5 + 0.2 * i or 1) * v[i] ^ 2 / 2 end
    return sum
  end }
local stepper = rod:solver { rule = "lie(2)", h = 0.02 }
local function begun(eps)
  local R, v = G4:exp { 0.3 + eps, 0.2, 0.1 - eps, 0, 0.2, 0.1 }, dm.zeros(10)
  for i = 1, 6 do v[i] = 0.4 / i + eps * i end
  local path = stepper:run { q = { R, R * dm.vector { 0, 0, 0, 1 } }, v = v, steps = 0,
    project = true }
  return { q = path.q[1], p = path.p[1] }
end
e = gap(rod, "lie(2)", 0.02, 2, { begun })
ok(e < 1e-9, "lie(2): the tangent map of a joint on SO(4) x R^4", e)

tap.raises("coupled where they commute", function()
  dm.system { Q = G, L = function(R, w) return top(R, w) + 0.1 * w[1] * w[2] end }
    :solver { rule = "rotations(2)", h = 0.1 }:symplecticity { q = g0, p = p0, steps = 1 }
end)

tap.done()
