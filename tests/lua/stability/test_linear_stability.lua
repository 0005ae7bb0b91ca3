-- linear stability: rules against closed forms, equilibria and orbits, recurrences, folds, singular coordinates
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, sin, tan, pi, abs, huge = math.sqrt, math.sin, math.tan, math.pi, math.abs, math.huge

-- amplification matrices and limits
local z = 0.7
local A, re, im = dm.amplification("verlet", z)
near(A[1][1], 1 - z ^ 2 / 2, 1e-15, "Verlet: 1 - z^2/2"); near(A[1][2], z, 1e-15, "z"); near(A[2][1], -z * (1 - z ^ 2 / 4), 1e-15, "-z (1 - z^2/4)")
near(re[1] ^ 2 + im[1] ^ 2, 1, 1e-14, "its roots are on the unit circle")
-- independent: the trace of a composition of Verlet steps, and where it leaves [-2, 2]
local function composed(gammas, x)
  local a, b, c, d = 1, 0, 0, 1
  for _, g in ipairs(gammas) do
    local y = g * x
    local A11, A12, A21 = 1 - y * y / 2, y, -y * (1 - y * y / 4)
    a, b, c, d = A11 * a + A12 * c, A11 * b + A12 * d, A21 * a + A11 * c, A21 * b + A11 * d
  end
  return a + d
end
local function leaves(gammas)
  local x = 0.001
  while abs(composed(gammas, x)) <= 2 do x = x + 1e-3 end
  local lo, hi = x - 1e-3, x
  for _ = 1, 50 do
    local m = (lo + hi) / 2
    if abs(composed(gammas, m)) <= 2 then lo = m else hi = m end
  end
  return lo
end
local y1, s1 = 1 / (2 - 2 ^ (1 / 3)), 1 / (4 - 4 ^ (1 / 3))
for _, case in ipairs { { "verlet", 2 }, { "yoshida(4)", leaves { y1, 1 - 2 * y1, y1 } }, { "suzuki(4)", leaves { s1, s1, 1 - 4 * s1, s1, s1 } },
  { "symplectic-euler(a)", 2 }, { "trapezoidal", 2 }, { "lobatto(3)", sqrt(8) }, { "rk4", 2 * sqrt(8) }, { "curve(euler)", 2 } } do
  local limit, told = dm.stability_limit(case[1])
  near(limit, case[2], 2e-6 * case[2], ("%s: limit h omega = %.6f"):format(case[1], case[2]))
  ok(told.cause:find "amplification matrix", "with its cause", told.cause)
end
for rule, words in pairs { verlet = "meet at -1", ["yoshida(4)"] = "meet at 1", rk4 = "as a pair", rk8 = "as a pair", rkf45 = "as a pair" } do
  ok(select(2, dm.stability_limit(rule)).cause:find(words, 1, true), rule .. ": its roots " .. words)
end
raises("a number of sweeps", dm.stability_limit, "gauss(3, 5)")
local _, told = dm.stability_limit "lobatto(3)"
near(told.gaps[1][2], sqrt(12), 1e-5, "Lobatto 3 is stable again from sqrt 12 on")
for _, rule in ipairs { "midpoint", "gauss(2)", "gauss(4)" } do
  local limit, said = dm.stability_limit(rule)
  ok(limit == huge and said.cause:find "no limit", rule .. " has none", said.cause)
end
ok(dm.stability_limit("rkf45", { tolerance = 1e-9 }) < 0.2, "GSL's rkf45 grows slowly from small steps on")
_, told = dm.stability_limit "blanes-moan(6)"
ok(abs(told.gaps[1][1] - pi) < 1e-3 and told.gaps[1][2] - told.gaps[1][1] < 2e-3, "a narrow resonance of a good composition at h omega = pi", told.gaps[1][1])
for _, n in ipairs { 3, 4, 5, 6 } do
  near(select(2, dm.stability_limit "verlet").resonances[n - 2].z, 2 * sin(pi / n), 1e-9, ("Verlet turns by 2 pi/%d at 2 sin(pi/%d)"):format(n, n))
  near(select(2, dm.stability_limit "midpoint").resonances[n - 2].z, 2 * tan(pi / n), 1e-9, "the midpoint rule at 2 tan(pi/n)")
end

-- equilibria and relative equilibria
local pendulum = dm.system { Q = dm.T(1), L = function(q, v) return v[1] ^ 2 / 2 + 9 * math.cos(q[1]) end }
local down, up = pendulum:linearize { q = { 0 } }, pendulum:linearize { q = { pi } }
ok(down.stable and not up.stable, "a pendulum is stable below and unstable above", up.why); near(down.fastest, 3, 1e-12, "omega = sqrt(g/l)")
near(up.rates[2], 3, 1e-12, "and grows at the same rate")
local polar = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
near(polar:linearize { q = { 1, 0 }, v = { 0, 1 } }.fastest, 1, 1e-12, "a circular orbit of Kepler: the radius oscillates once a turn")
-- the triangular point of the restricted three bodies: lambda^4 + lambda^2 + 27/4 mu (1 - mu) = 0 (Routh)
local function triangle(mu)
  return dm.system { Q = dm.R(2), L = function(q, v)
    local a, b = (q[1] + mu) ^ 2 + q[2] ^ 2, (q[1] - 1 + mu) ^ 2 + q[2] ^ 2
    return v:dot(v) / 2 + q[1] * v[2] - q[2] * v[1] + q:dot(q) / 2 + (1 - mu) / a ^ 0.5 + mu / b ^ 0.5
  end }:linearize { q = { 0.5 - mu, sqrt(0.75) } }
end
local c = 27 / 4 * 0.01 * 0.99
ok(triangle(0.01).stable, "L4 is stable for mu = 0.01", triangle(0.01).why)
near(triangle(0.01).fastest, sqrt((1 + sqrt(1 - 4 * c)) / 2), 1e-12, "with the frequency of Routh's equation")
ok(not triangle(0.05).stable, "and unstable for mu = 0.05")

-- multipliers
local T = 2 * pi / 3
local m = pendulum:solver({ rule = "gauss(6)", h = T / 64 }):multipliers { q = { pi }, v = { 0 }, steps = 64 }
near(m.largest, math.exp(3 * T), 1e-9 * math.exp(3 * T), "the upper equilibrium: a factor exp(omega T)"); ok(not m.stable and m.why:find "unstable", "unstable", m.why)
local circle = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
m = circle:solver({ rule = "gauss(6)", h = 2 * pi / 64 }):multipliers { q = { 1, 0 }, v = { 0, 1 }, steps = 64 }
ok(m.stable and m.closes < 1e-12, "a circular orbit has multipliers 1", m.why)
m = polar:solver({ rule = "gauss(4)", h = 0.1 }):multipliers { q = { 1, 0 }, v = { 0, 1 }, steps = 1 }
local turn = 0
for k = 1, 4 do turn = math.max(turn, m.im[k]) end
near(turn, sin(0.1), 1e-9, "one step of a relative equilibrium: the radius turns by h"); ok(m.stable and m.why:find "up to a symmetry", "and nothing grows", m.why)

-- recurrences
local r, i = dm.polynomial_roots { -6, 11, -6, 1 }
near(r[1] + r[2] + r[3], 6, 1e-12, "roots of (x - 1)(x - 2)(x - 3)"); near(r[1] * r[2] * r[3], 6, 1e-12, "their product"); near(i:norm(), 0, 1e-12, "real")
r, i = dm.polynomial_roots { 1, 0, 1, 0 }
near(i[1] ^ 2, 1, 1e-14, "roots of 1 + x^2, a leading zero left out"); ok(#r == 2, "two of them")
ok(dm.recurrence { 1, -1.9, 1 }.stable, "x - 1.9 + 1/x is bounded"); ok(not dm.recurrence { 1, -2, 1 }.stable, "a double root on the circle is not")
local triple = dm.recurrence { -1, 3, -3, 1 }
ok(not triple.stable and triple.times[1] == 3 and triple.why:find "k^2", "a triple root 1 grows like k^2", triple.why)
near(triple.re[1], 1, 1e-14, "and is found to round-off")
ok(dm.recurrence { 1, -1.9999, 1 }.stable, "two near ones on the circle are two")
ok(dm.recurrence({ 0.25, -1, 1 }).stable, "a double root inside is harmless")
local grow = dm.recurrence { 1, -2.1, 1 }
ok(not grow.stable and grow.why:find "grows by that factor", "a root outside", grow.why); near(grow.largest, 1.05 + sqrt(1.05 ^ 2 - 1), 1e-12, "and its factor")

-- folds: m = (q0 + q1)/2 of the midpoint rule for q'' = q^2 solves h^2 m^2 - 4 m + 4 = 0 from rest at 1: none beyond h = 1
local cubic = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 3 / 3 end }
local fold = cubic:solver({ rule = "midpoint", h = 0.1 }):fold { q = { 1 }, v = { 0 } }
ok(fold.fold, "the midpoint rule has a fold", fold.why); near(fold.h, 1, 1e-8, "at h = 1"); near(fold.q1[1], 3, 1e-3, "where q1 = 3")
local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(a, b, h) return (b[1] - a[1]) ^ 2 / 2 / h + h * ((a[1] + b[1]) / 2) ^ 3 / 3 end }
near(Ld:solver({}):fold({ q = { 1 }, p = { 0 } }).h, 1, 1e-8, "so has the discrete Lagrangian written out")
for _, rule in ipairs { "gauss(2)", "lobatto(3)" } do
  fold = cubic:solver({ rule = rule, h = 0.1 }):fold { q = { 1 }, v = { 0 } }
  local lo, hi = 0.01, 10
  for _ = 1, 30 do
    local h = (lo + hi) / 2
    if pcall(function() return cubic:solver({ rule = rule, h = h }):step { q = { 1 }, v = { 0 } } end) then lo = h else hi = h end
  end
  near(fold.h, lo, 1e-6, rule .. ": the fold is where steps cease to be solvable")
end
fold = pendulum:solver({ rule = "midpoint", h = 0.1 }):fold { q = { 0.1 }, v = { 0 }, up_to = 0.5 }
ok(fold.h == huge and not fold.fold, "no fold below the limit that is asked for", fold.why)

-- coordinates at a pole
local sphere = dm.system { Q = dm.R(2), coordinates = { "theta", "phi" }, L = function(q, v)
  return (v[1] ^ 2 + math.sin(q[1]) ^ 2 * v[2] ^ 2) / 2 - 9.81 * math.cos(q[1])
end }
local solver = sphere:solver { rule = "gauss(2)", h = 0.01 }
local regular, pole = solver:singularities { q = { 2, 0 }, v = { 0, 0.5 }, t = 2 }, solver:singularities { q = { 2, 0 }, v = { 0, 0 }, t = 3 }
ok(#regular.places == 0 and regular.why:find "stay regular", "away from the pole the angles are regular", regular.why)
ok(#pole.places >= 1 and pole.why:find "'phi'", "through the pole the azimuth loses its inertia", pole.why)

-- misuse
raises("h omega must be a number > 0", dm.amplification, "verlet", -1)
raises("changes the time with the state", dm.stability_limit, "log-hamiltonian")
raises("unknown option 'tol'", dm.stability_limit, "verlet", { tol = 1 })
raises("at least two coefficients", dm.polynomial_roots, { 1 })
raises("is a constant", dm.recurrence, { 1, 0, 0 })
raises("must be a finite number", dm.polynomial_roots, { 1, 0 / 0 })
raises("q and v have 1 entries", pendulum.linearize, pendulum, { q = { 1, 2 } })
raises("unknown option 'x'", pendulum.linearize, pendulum, { q = { 1 }, x = 1 })
raises("give the start as q and v", solver.fold, solver, { q = { 1, 0 } })
raises("give 'steps' or 't'", solver.singularities, solver, { q = { 1, 0 }, v = { 0, 0 } })

-- the number of an only coordinate, as runs take it
do
  local pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + math.cos(q[1]) end }
  local solver = pendulum:solver { rule = "gauss(2)", h = 0.1 }
  local one, list = { q = 1, v = 0.5, steps = 30 }, { q = { 1 }, v = { 0.5 }, steps = 30 }
  for _, name in ipairs { "tangent", "symplecticity", "lyapunov", "multipliers", "modified_energy", "backward_error", "reversal" } do
    local a, b = solver[name](solver, one), solver[name](solver, list)
    tap.ok(type(a) == type(b) and (type(a) ~= "number" or a == b), "a number for a list of one: " .. name)
  end
  tap.near(solver:fold { q = 1, v = 0.5 }.h, solver:fold { q = { 1 }, v = { 0.5 } }.h, 1e-9, "fold")
  tap.near(pendulum:linearize { q = 1 }.matrix[2][1], -math.cos(1), 1e-15, "linearize")
  tap.near(dm.discrete_lagrangian(pendulum, { rule = "midpoint", h = 0.1 }):order { q = 1, v = 0.5 }, 2, 0.01, "order")
  tap.ok(pendulum:stability { rule = "verlet", q = 1, v = 0.5, h = { 0.1, 0.5 }, steps = 100 }:at(1, 1).class == "bounded", "a map")
  tap.ok(dm.scene { system = pendulum, q = 1, v = 1, watch = { "q1" }, tolerance = 1e-2, until_t = 1 }:run().error_estimate < 1e-2, "a scene")
end
tap.done()
