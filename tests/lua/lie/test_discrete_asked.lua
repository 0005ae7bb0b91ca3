-- what a discrete Lagrangian is asked about: the time of a step, params as they are now, an L that
-- comes of an H; and what it has no place for
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

---- the time of a step: momenta along a run ----

-- the largest difference of a Legendre transform from the momentum of the run
local function worst_of(system, rule, start)
  local path = system:solver { rule = rule, h = 0.1 }:run(start)
  local Ld, worst = dm.discrete_lagrangian(system, { rule = rule, h = 0.1 }), 0
  for i = 1, #path - 1 do
    local a, b, t = path.q[i], path.q[i + 1], path.t[i]
    worst = math.max(worst, (Ld:legendre_minus(a, b, t) - path.p[i]):norm(),
      (Ld:legendre_plus(a, b, t) - path.p[i + 1]):norm())
  end
  return worst
end

local driven = dm.system { Q = dm.R(1), L = function(q, v, t)
  return (1 + t) * v[1] ^ 2 / 2 - dm.cos(t) * q[1] ^ 2 / 2
end }
for _, rule in ipairs { "midpoint", "trapezoidal", "gauss(2)", "galerkin(2, lobatto(3))" } do
  near(worst_of(driven, rule, { q = { 1 }, v = { 0.3 }, t0 = 0.7, steps = 4 }), 0, 1e-14,
    rule .. ": the time of a step, on R")
end

local G = dm.SO(3)
local function pull(R, W, t)
  return (1 + 0.3 * t) * (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - dm.cos(3 * t) * R[3][3]
end
local pulled = dm.system { Q = G, L = pull }
local start = { q = G:exp { 0.1, 0.2, 0.3 }, v = { 0.3, 0.4, 1 }, t0 = 0.7, steps = 4 }
for _, rule in ipairs { "lie(1)", "lie(2)", "lie(2, lobatto(3))", "lie(3, gauss(3), cayley)",
  "lie(2, gauss(2), pade(2))" } do
  near(worst_of(pulled, rule, start), 0, 1e-14, rule .. ": the time of a step, on SO(3)")
end

local a, b = G:identity(), G:exp { 0.1, 0.2, 0.1 }
local Ld = dm.discrete_lagrangian(pulled, { rule = "lie(2)", h = 0.1 })
local later = dm.discrete_lagrangian(dm.system { Q = G, L = function(R, W, t)
  return pull(R, W, t + 2)
end }, { rule = "lie(2)", h = 0.1 })
near(Ld(a, b, 2), later(a, b), 1e-15, "the value at a time")
near(Ld:value(a, b), Ld(a, b, 0), 0, "which is 0 where it is left out")
near(Ld:momentum(G, a, b, { t = 2 })[3], later:momentum(G, a, b)[3], 1e-14, "Noether's momentum")
local x, y = Ld:two_form(a, b, 2), later:two_form(a, b)
for i = 1, 3 do near(x[i][1], y[i][1], 1e-13, "the two-form") end
raises("the time of g0", function() return Ld(a, b, "x") end)

local plane = dm.system { Q = dm.R(2), L = function(q, v, t)
  return (1 + t) * v:dot(v) / 2 - q:dot(q) / 2
end }
local of_plane = dm.discrete_lagrangian(plane, { rule = "gauss(2)", h = 0.1 })
local p1 = of_plane:legendre_plus({ 1, 0 }, { 1, 0.2 }, 3)
near(of_plane:momentum(dm.SO(2), { 1, 0 }, { 1, 0.2 }, { t = 3 })[1], p1[2] - 0.2 * p1[1], 1e-14,
  "Noether's momentum at a time, on R^2")
near(of_plane:momentum(dm.SO(2), { 1, 0 }, { 1, 0.2 }, { t = 3, block = 2 })[1],
  p1[2] - 0.2 * p1[1], 1e-14, "beside another option")
local form = of_plane:two_form({ 1, 0 }, { 1, 0.2 }, 3)[1][1]
near(form, 4.05 / 0.1, 0.4, "the two-form has the mass of that time")
local exact = dm.discrete_lagrangian(driven, { rule = "gauss(3)", h = 0.1 })
local off = exact:against_exact { q = { 1 }, v = { 0.3 }, h = { 0.4, 0.2, 0.1 }, t0 = 2 }
near(off.value_slope, 7, 0.3, "against the flow from a time on")
near(exact:order { q = { 1 }, v = { 0.3 }, t0 = 1.5 }, 6, 0.1, "the order from a time on")
local formula = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, Ld = function(u, w, h)
  return (w[1] - u[1]) ^ 2 / (2 * h)
end }
raises("has no time; its h is 0.1", formula.value, formula, { 0 }, { 1 }, 0.2)
local falling = dm.system { Q = dm.R(1), L = function(q, v, t)
  return v[1] ^ 2 / 2 + (1 + t) ^ 2 * q[1] ^ 3 / 3
end }
local function fold_at(t0)
  return falling:solver { rule = "midpoint", h = 0.01 }:fold { q = { 1 }, v = { 0 }, t0 = t0 }.h
end
-- q1 = 1 + h^2/2 c^2 m^2 with m = (1 + q1)/2, c = 1 + t0 + h/2: a double root where c h = 1
near(fold_at(0), math.sqrt(3) - 1, 1e-5, "a fold from the time 0 on")
near(fold_at(1), math.sqrt(6) - 2, 1e-5, "and from 1 on")

---- params and upvalues as they are now ----

local P, stiff = { k = 1 }, 1
local turning = dm.system { Q = G, params = P, L = function(R, W, _, p)
  return p.k * (W[1] ^ 2 + 2 * W[2] ^ 2 + 3 * W[3] ^ 2) / 2 - stiff * R[3][3]
end }
local of_turning = dm.discrete_lagrangian(turning, { rule = "lie(2)", h = 0.1 })
local mine = dm.discrete_lagrangian { Q = G, h = 0.1, Ld = function(g0, g1, h)
  local M = g0:transpose() * g1
  return -P.k * (M[1][1] + M[2][2] + M[3][3]) / h
end }
local first, own = of_turning:legendre_minus(a, b), mine:legendre_minus(a, b)
P.k, stiff = 2, 2
near((of_turning:legendre_minus(a, b) - first * 2):norm(), 0, 1e-14, "params that have changed")
near((mine:legendre_minus(a, b) - own * 2):norm(), 0, 1e-13, "upvalues of a formula")
P.k, stiff = 1, 1
near((of_turning:legendre_minus(a, b) - first):norm(), 0, 0, "and back")
local H = dm.system { Q = dm.R(1), params = P, H = function(q, p, _, m)
  return p[1] ^ 2 / (2 * m.k) + q[1] ^ 2
end }
near(H.L({ 0 }, { 3 }, 0, P), 4.5, 1e-14, "L of an H")
P.k = 4
near(H.L({ 0 }, { 3 }, 0, P), 18, 1e-14, "L of an H, after its mass has changed")
P.k = 1

---- an H that is quadratic has an L on elements ----

for _, case in ipairs { { G, function(R) return R[3][3] end },
  { dm.SU(2), function(x) return x[2] ^ 2 + x[3] end },
  { dm.SE(3), function(m) return m[1][4] ^ 2 + m[2][3] end },
  { dm.product(G, dm.R(2)), function(g) return g[1][3][3] * g[2][1] end } } do
  local space, V = case[1], case[2]
  local d = space.dimension
  local I = function(i) return 1 + 0.3 * i end
  local function halves(f)
    return function(g, x)
      local sum = 0
      for i = 1, d do sum = sum + f(i) * x[i] ^ 2 / 2 end
      return sum, V(g)
    end
  end
  local T, K = halves(I), halves(function(i) return 1 / I(i) end)
  local by_L = dm.system { Q = space, columns = "matrix",
    L = function(g, xi) local u, w = T(g, xi) return u - w end }
  local by_H = dm.system { Q = space, columns = "matrix",
    H = function(g, mu) local u, w = K(g, mu) return u + w end }
  local e = dm.zeros(d)
  for i = 1, d do e[i] = 0.1 * math.sin(i) end
  local g0, g1 = space:exp(e), space:exp(e * 1.3)
  local one = dm.discrete_lagrangian(by_L, { rule = "lie(2)", h = 0.1 })
  local two = dm.discrete_lagrangian(by_H, { rule = "lie(2)", h = 0.1 })
  near(two(g0, g1), one(g0, g1), 1e-14, tostring(space) .. ": of H the same value")
  near((two:legendre_plus(g0, g1) - one:legendre_plus(g0, g1)):norm(), 0, 1e-13, "and momenta")
end
local top = { q = G:exp { 0.2, 0.3, 0.4 }, p = { 0.1, 0.2, 1 } }
local by_H = dm.system { Q = G, H = function(R, m)
  return (m[1] ^ 2 + m[2] ^ 2 / 1.5 + m[3] ^ 2 / 0.8) / 2 + R[3][3]
end }
local by_L = dm.system { Q = G, L = function(R, W)
  return (W[1] ^ 2 + 1.5 * W[2] ^ 2 + 0.8 * W[3] ^ 2) / 2 - R[3][3]
end }
ok(by_H:solver { rule = "gauss(2)", h = 0.05 }:reversal { q = top.q, p = top.p, steps = 20 }
  < 1e-14, "gauss(2) of an H on SO(3) is reversible")
top.up_to = 0.1
near(G:distance(by_H:solver { rule = "lie(2)", h = 0.05 }:fold(top).q1,
  by_L:solver { rule = "lie(2)", h = 0.05 }:fold(top).q1), 0, 1e-13, "its steps are those of L")

---- what would be dropped ----

local tug = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end,
  control = function() return { 1 } end, force = function(_, _, _, u) return { u[1] } end }
raises("held from the start of a step", function()
  return tug:solver { rule = "gauss(2)", h = 0.1 }:reversal { q = { 1 }, v = { 0 }, steps = 3 }
end)
local function with(more)
  local given = { Q = dm.R(2), h = 0.1, Ld = function(u, w, h)
    return (w - u):dot(w - u) / (2 * h) - h * (u + w):dot(u + w) / 8
  end }
  for key, value in pairs(more) do given[key] = value end
  return dm.discrete_lagrangian(given)
end
local rubbed = with { force = function(u, w, h)
  local f = (u - w) * (1 / (2 * h))
  return { f * h, f * h }
end }
local one_sided = with { force = function(u, w) return { (u - w) * 1, (u - w) * 0 } end }
near(rubbed:order { q = { 1, 0 }, p = { 0, 1 } }, 2, 0.05, "the order of symmetric forces")
near(one_sided:order { q = { 1, 0 }, p = { 0, 1 } }, 1, 0.05, "of one-sided ones it is 1")
for _, other in ipairs { rubbed, with { constraint = function(q) return q:dot(q) - 1 end },
  with { rolling = function(u, w) return w[1] - u[1] end,
    reaction = function() return { { 1, 0 } } end } } do
  raises("without constraints and forces", function()
    return other:solver():fold { q = { 1, 0 }, p = { 0, 1 } }
  end)
end
local frame = dm.moving_frame { action = dm.action { group = dm.R(2), on = dm.R(2),
  map = function(g, z) return g + z end }, cross_section = function(u) return u end }
raises("has 'force'", function() return frame:invariantize(rubbed) end)

---- its solver, by either name; its class, in a session that has made none ----

local top = dm.system { Q = dm.SO(3), L = function(g, xi) return xi[1] ^ 2 + xi:dot(xi) - g[3][3] end }
local of_top = dm.discrete_lagrangian(top, { rule = "lie(2)", h = 0.05 })
local from = { q = dm.SO(3):identity(), v = { 0.1, 1, 0.3 }, steps = 20 }
ok(dm.solver({ of_top }):run(from).p[21] == of_top:solver({}):run(from).p[21], "dm.solver{Ld} is Ld:solver{}")
raises("expected, got string", dm.solver, { "Ld" })
raises("expected, got dm.space", dm.solver, { dm.R(2) })
local pipe = assert(io.popen(("%s -e 'help \"dm.group_lagrangian\"' 2>&1"):format(os.getenv "DMLUA" or "build/dmlua")))
ok(pipe:read("a"):find "Ld:legendre_minus", "its class has help before there is one")
pipe:close()

tap.done()
