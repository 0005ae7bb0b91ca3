-- Steps of reduced discrete Lagrangians: they are those of the unreduced ones, from every start and
-- for rules and formulas alike; what is none of the shape is refused.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, max, abs, floor = dm.sin, dm.cos, math.max, math.abs, math.floor

-- largest distance of the rows of two paths
local function apart(a, b, columns)
  local worst = #a == #b and 0 or math.huge
  for k = 1, #b do
    for _, key in ipairs(columns) do worst = max(worst, (a[key][k] - b[key][k]):norm()) end
  end
  return worst
end

-- two unlike particles in the plane, held by a quartic well and a spring
local well = dm.system { Q = dm.R(4), L = function(q, v)
  local x, y = q[3] - q[1], q[4] - q[2]
  return (v[1] ^ 2 + v[2] ^ 2) / 2 + v[3] ^ 2 + v[4] ^ 2 - (q[1] ^ 2 + q[2] ^ 2) ^ 2 / 4
    - 0.7 * (x * x + y * y)
end }
local function turn(t, q)
  local c, s = cos(t), sin(t)
  return { c * q[1] - s * q[2], s * q[1] + c * q[2], c * q[3] - s * q[4], s * q[3] + c * q[4] }
end
local function along(x) return { x[1], 0, x[2], x[3] } end
local function trapezoid(system, h, gauge)
  return dm.discrete_lagrangian { Q = system.Q, h = h, Ld = function(a, b, step)
    local v = (b - a) / step
    local boundary = gauge and gauge(b) - gauge(a) or 0
    return step / 2 * (system.L(a, v, 0) + system.L(b, v, 0)) + boundary
  end }
end

-- a formula with long steps, from starts all around: turns of most of a circle in one step
local Ld, steps = trapezoid(well, 0.45), 60
local worst, most, refused = 0, 0, 0
for k = 1, 30, 2 do
  local q = { 0.2 + 0.03 * k, 0, 0.8 * cos(2 * k), 0.8 * sin(2 * k) }
  local v = { 0.4 * sin(k), 0.5 + 0.02 * k, 0.6 * cos(3 * k), 0.3 * sin(5 * k) }
  local shape = well:routh { action = turn, section = along, q = q, v = v }
  local D = shape:discrete(Ld)
  local x, u, theta = shape:start(q, v)
  local full = dm.solver { Ld }:run { q = q, p = well:momentum(q, v), steps = steps }
  local fine, back = pcall(function()
    return D:solver():run({ q = x, p = shape:momentum(x, u), steps = steps }):reconstruct {
      theta = theta }
  end)
  refused = refused + (fine and 0 or 1)
  worst = max(worst, fine and apart(back, full, { "q", "p" }) or 0)
  local a = dm.vector(x)
  most = max(most, fine and abs(D:step(a, a + 0.01 * dm.vector(u))[1]) or 0)
end
ok(refused == 0, "every start that the unreduced Ld steps is stepped reduced", refused)
ok(worst < 1e-9, "and lies under the unreduced path (an unstable one: round-off grows)", worst)

-- rows apart, members and a run that goes on: the same steps
local q, v = { 0.9, 0.1, -0.4, 0.7 }, { 0.2, 0.6, -0.5, 0.3 }
local shape = well:routh { action = turn, section = along, q = q, v = v }
local D = shape:discrete(Ld)
local x, u = shape:start(q, v)
local y = shape:momentum(x, u)
local every = D:solver():run { q = x, p = y, steps = 40 }
local tenth = D:solver():run { q = x, p = y, steps = 40, every = 10 }
local some, all = tenth:reconstruct(), every:reconstruct()
worst = 0
for k = 1, 5 do worst = max(worst, (some.q[k] - all.q[10 * k - 9]):norm()) end
ok(worst < 1e-12, "the group variable between rows that are ten steps apart", worst)
local members = D:solver():ensemble { members = 3, steps = 40, q = function(i)
  return i == 2 and x or { 1 + 0.1 * i, 0.2, 0.3 }
end, p = function() return y end }
local gap = (members.q:row(2) - every.q[41]):norm()
ok(gap == 0, "a member has the bits of a run", gap)
local file = os.tmpname()
D:solver():run({ q = x, p = y, steps = 17 }):checkpoint(file)
local rest = dm.resume(file, D):run { steps = 23 }
ok(rest.q[#rest] == every.q[41] and rest.p[#rest] == every.p[41], "a checkpoint goes on bit for bit")
os.remove(file)
local a, b = every.q[20]:copy(), every.q[21]:copy()
local c, psi = D:step(a, b)
ok((c - every.q[22]):norm() < 1e-12, "D:step is the step of D:solver", (c - every.q[22]):norm())
ok((psi - D:psi(b, c)):norm() < 1e-12, "with the psi_mu of its pair", psi)
for _, kind in ipairs { "literal", "direct" } do
  local r = D:residual(a, b, c, kind):norm()
  ok(r < 1e-12, "it solves the discrete Routh equations, " .. kind, r)
end
local W0, W1 = D:routhian(a, b), D:value(a, b) - D.info.mu[1] * D:psi(a, b)[1]
ok(abs(W0 - W1) < 1e-14 and abs(every.system(a, b) - W0) < 1e-14, "W = L^d - mu psi", W0 - W1)

-- discrete Lagrangians of rules in the coordinates of Q, also of more points than the degree
local function check_rule(system, how, start, rule, h)
  local reduced = system:routh(how)
  local given = dm.discrete_lagrangian(system, { rule = rule, h = h })
  local E = reduced:discrete(given)
  local z, w, theta = reduced:start(start.q, start.v)
  local path = E:solver {}:run { q = z, p = reduced:momentum(z, w), steps = 30 }
  local left = 0
  for i = 2, #path - 1 do
    left = max(left, E:residual(path.q[i - 1], path.q[i], path.q[i + 1]):norm())
  end
  local full = system:solver({ rule = rule, h = h }):run { q = start.q, v = start.v, steps = 30 }
  local off = apart(path:reconstruct { theta = theta }, full, { "q", "p" })
  ok(left < 1e-11, rule .. ": D:solver solves D's own equations", left)
  ok(off < 1e-11, rule .. ": and takes the steps of the rule on Q", off)
end
for _, rule in ipairs { "gauss(1)", "gauss(3)", "lobatto(3)", "galerkin(2, gauss(3))", "verlet" } do
  check_rule(well, { action = turn, section = along, q = q, v = v }, { q = q, v = v }, rule, 0.1)
end
-- two commuting turns, of a particle each
local torus = dm.system { Q = dm.R(4), L = function(p, w)
  local r, s = p[1] ^ 2 + p[2] ^ 2, p[3] ^ 2 + p[4] ^ 2
  return w:dot(w) / 2 - r - s / 2 - 0.3 * r * s
end }
local function both(t, p)
  local c1, s1, c2, s2 = cos(t[1]), sin(t[1]), cos(t[2]), sin(t[2])
  return { c1 * p[1] - s1 * p[2], s1 * p[1] + c1 * p[2], c2 * p[3] - s2 * p[4],
    s2 * p[3] + c2 * p[4] }
end
local start = { q = { 0.8, 0.3, -0.2, 1.1 }, v = { -0.4, 0.9, 0.7, 0.2 } }
for _, rule in ipairs { "gauss(2)", "lobatto(2)" } do
  check_rule(torus, { action = both, dimension = 2, q = start.q, v = start.v,
    section = function(z) return { z[1], 0, 0, z[2] } end }, start, rule, 0.15)
end
-- a coordinate that is cyclic already; a rule of more points than its degree is no partitioned one
local rotor = dm.system { Q = dm.R(2), coordinates = { "phi", "r" }, L = function(p, w)
  return (w[2] ^ 2 + p[2] ^ 2 * w[1] ^ 2) / 2 - p[2] ^ 2 + 1 / p[2]
end }
for _, rule in ipairs { "gauss(2)", "galerkin(3, gauss(5))" } do
  check_rule(rotor, { cyclic = "phi", q = { 0.3, 1.2 }, v = { 0.8, 0.1 } },
    { q = { 0.3, 1.2 }, v = { 0.8, 0.1 } }, rule, 0.1)
end

-- what is none of the shape
local function refused_with(text, given) raises(text, shape.discrete, shape, given) end
refused_with("not invariant", dm.discrete_lagrangian { Q = dm.R(4), h = 0.1, Ld = function(p0, p1, h)
  local w = (p1 - p0) / h
  return h * well.L((p0 + p1) / 2, w, 0) + 0.01 * h * p0[2] ^ 2 -- vanishes with its slope at theta = 0
end })
raises("not invariant", function()
  rotor:routh({ cyclic = "phi", mu = 1 }):discrete(dm.discrete_lagrangian { Q = dm.R(2), h = 0.1,
    Ld = function(p0, p1, h)
      return h * rotor.L((p0 + p1) / 2, (p1 - p0) / h, 0) + 0.05 * h * sin(p0[1]) ^ 2
    end })
end)
local lighter = dm.system { Q = dm.R(4), L = function(p, w)
  return well.L(p, w, 0) - (w[3] ^ 2 + w[4] ^ 2) / 4
end }
refused_with("of another system", trapezoid(torus, 0.1))
refused_with("of another system", dm.discrete_lagrangian(torus, { rule = "midpoint", h = 0.1 }))
refused_with("of another system", dm.discrete_lagrangian(lighter, { rule = "gauss(2)", h = 0.1 }))
local function square(p) return 0.3 * (p[1] ^ 2 + p[2] ^ 2) end
ok(shape:discrete(trapezoid(well, 0.1, square)), "a boundary term makes no other system of it")
ok(shape:discrete(dm.discrete_lagrangian(well, { rule = "trapezoidal", h = 0.1 })), "nor a rule")
local function rim(p) return p[1] ^ 2 + p[2] ^ 2 - 1 end
refused_with("constraint", dm.discrete_lagrangian { Q = dm.R(4), h = 0.1, Ld = Ld.Ld,
  constraint = rim })
local held = dm.system { Q = dm.R(4), L = well.L, constraint = rim }
local hoop = held:routh { action = turn, mu = 1.1, at = { 1, 0, 0.3, 0.2 },
  section = function(z) return { z[1], 0, z[2], z[3] } end }
raises("not that of its system", hoop.discrete, hoop, dm.discrete_lagrangian { Q = dm.R(4), h = 0.1,
  Ld = Ld.Ld, constraint = function(p) return p[3] ^ 2 + p[4] ^ 2 - 1 end })
ok(hoop:discrete(dm.discrete_lagrangian { Q = dm.R(4), h = 0.1, Ld = Ld.Ld,
  constraint = function(p) return p[1] ^ 2 + p[2] ^ 2 - 1 end }), "the same constraint, written again")

-- of a rule in the coordinates (theta, x): paths over its steps, and points of its connection, are
-- in the coordinates of Q
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(2)" } do
  local gaps, J = {}, 0
  for i, step in ipairs { 0.05, 0.025 } do
    local own = well:routh { action = turn, section = along, q = q, v = { 0.2, 0.6, -0.5, 0.3 } }
    local by_rule, n = own:discrete { rule = rule, h = step }, floor(1 / step + 0.5)
    local z, w, angle = own:start(q, { 0.2, 0.6, -0.5, 0.3 })
    local over = by_rule:solver():run({ q = z, p = own:momentum(z, w), steps = n })
      :reconstruct { theta = angle }
    local full = well:solver({ rule = "gauss(4)", h = step })
      :run { q = q, v = { 0.2, 0.6, -0.5, 0.3 }, steps = n }
    local away = max((over.q[1] - full.q[1]):norm(), (over.p[1] - full.p[1]):norm())
    ok(away < 1e-14, rule .. ": the path over the start begins there", away)
    gaps[i] = (over.q[n + 1] - full.q[n + 1]):norm()
    for k = 1, n do J = max(J, abs(by_rule:connection(over.q[k], over.q[k + 1])[1])) end
  end
  local order = math.log(gaps[1] / gaps[2], 2)
  ok(gaps[2] < 5e-3 and order > (rule == "gauss(2)" and 3.5 or 1.7), "  and stays by the motion", order)
  ok(J < 1e-12, "  its steps are horizontal", J)
end

-- a step that is given: the map of a kicked rotor, with its Ld, and what is wrong with one
local K, h = 0.8, 1
local function kicked(p0, p1) return (p1[1] - p0[1]) ^ 2 / 2 + K * cos(p1[1]) end
local function standard(p, w) return { p[1] + w[1], w[1] - K * sin(p[1] + w[1]) } end
local pair = dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = kicked, map = standard }
local fast = dm.solver { pair }:run { q = { 0.4 }, p = { 0.3 }, steps = 30 }
local slow = dm.solver { pair, rule = "del" }:run { q = { 0.4 }, p = { 0.3 }, steps = 30 }
ok(apart(fast, slow, { "q", "p" }) < 1e-11, "map = and the equations of Ld: the same steps",
  apart(fast, slow, { "q", "p" }))
local two = dm.solver { pair }:run { q0 = fast.q[1], q1 = fast.q[2], steps = 30 }
ok(apart(two, fast, { "q" }) < 1e-11, "also from two positions")
raises("map must return 2 numbers", dm.discrete_lagrangian, { Q = dm.R(1), h = h, Ld = kicked,
  map = function(p) return { p[1] } end })
raises("this one has none", dm.solver, { dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = kicked },
  rule = "map" })
tap.done()
