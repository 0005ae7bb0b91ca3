-- dm.bundle: discrete tangent bundles of curve segments; boundary maps, variations, definition 2, the limit of small h
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, sin, sqrt, pi = math.abs, math.cos, math.sin, math.sqrt, math.pi

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local cart = dm.system { Q = dm.R(2), L = function(q, v, t)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[2]) + cos(q[2]) * (1 + 0.2 * sin(t)) - q[1] ^ 2 / 2
end }
local function distance(a, b) return (dm.vector(a) - dm.vector(b)):norm() end

-- Moser-Veselov pairs: straight segments with bias g
for _, g in ipairs { 0, 0.5, 0.7, 1 } do
  local flat = dm.bundle { Q = dm.R(2), h = 0.3, bias = g }
  local q, v = dm.vector { 0.4, -1 }, dm.vector { 2, 0.5 }
  near(distance(flat:minus(q, v), q - (1 - g) * 0.3 * v), 0, 4e-16, "straight, bias " .. g .. ": d- = q - (1 - g) h v")
  near(distance(flat:plus(q, v), q + g * 0.3 * v), 0, 4e-16, "d+ = q + g h v")
  local D = flat:tangent_plus(q, v)
  near(D[1][1] - 1, 0, 0, "T d+ = (1, g h)"); near(D[2][4], g * 0.3, 1e-16, "in v"); near(D[1][4], 0, 0, "and 0 elsewhere")
  local dq, dv = flat:vertical_plus(q, v, { 1, 0 })
  near(distance(dv, { 1 / 0.3, 0 }) + distance(dq, { 1 - g, 0 }), 0, 1e-14, "dq^+ = ((1 - g) dq, dq / h)")
  dq, dv = flat:vertical_minus(q, v, { 0, 1 })
  near(distance(dv, { 0, -1 / 0.3 }) + distance(dq, { 0, g }), 0, 1e-14, "dq^- = (g dq, -dq / h)")
  local q2, v2 = flat:velocity({ 0, 0 }, { 0.3, 0.6 })
  near(distance(v2, { 1, 2 }) + distance(q2, { (1 - g) * 0.3, (1 - g) * 0.6 }), 0, 1e-15, "the velocity of a pair is its difference quotient")
  local report, sentence = flat:check { q = q, v = v }
  ok(report.ok and report.dimension == 4 and report.largest_h == math.huge, "it is a discrete tangent bundle for every h", sentence)
  ok(report.zero:norm() == 0, "whose zeros are those of TQ")
  ok(g == 0.5 and report.limit == math.huge or abs(report.limit - 1) < 1e-9, "the limit is reached like h, for g = 1/2 at once", report.limit)
end

-- Nystroem's method of order 4 for q'' = a(q), which treats positions and velocities each in its way
local function nystroem(x, f, h)
  local n = #x // 2
  local function at(q, v)
    local y = {}
    for i = 1, n do y[i], y[n + i] = q[i], v[i] end
    return dm.vector(y)
  end
  local function part(y, first)
    local z = {}
    for i = 1, n do z[i] = y[first + i] end
    return dm.vector(z)
  end
  local q, v = part(x, 0), part(x, n)
  local k1 = part(f(x), n)
  local k2 = part(f(at(q + h / 2 * v + h ^ 2 / 8 * k1, v + h / 2 * k1)), n)
  local k3 = part(f(at(q + h * v + h ^ 2 / 2 * k2, v + h * k2)), n)
  return at(q + h * v + h ^ 2 / 6 * (k1 + 2 * k2), v + h / 6 * (k1 + 4 * k2 + k3))
end

-- along the field of a system, all methods
for _, system in ipairs { kepler, cart } do
  for _, case in ipairs { { "straight" }, { "euler" }, { "heun", 0.3 }, { "rk4" }, { "dop853", 0.5 }, { "gsl-rkf45", 0 },
    { dm.curve { method = nystroem, bias = 0.4 } } } do
    local bundle = dm.bundle { system = system, h = 0.2, segments = case[1], bias = case[2] }
    local q, v, t = dm.vector { 0.8, 0.5 }, dm.vector { -0.3, 0.9 }, 0.7
    local name = tostring(bundle)
    local q0, q1 = bundle:pair(q, v, t)
    ok(q0 == bundle:minus(q, v, t) and q1 == bundle:plus(q, v, t), name)
    -- back, from the ends alone
    local q2, v2 = bundle:velocity(q0, q1, t)
    near(distance(q2, q) + distance(v2, v), 0, 2e-14, "  the pair gives the element back")
    -- tangents by central differences of order 6
    local worst = 0
    for _, end_of in ipairs { "minus", "plus" } do
      local D = bundle["tangent_" .. end_of](bundle, q, v, t)
      for j = 1, 4 do
        local d, sum = 5e-3, dm.vector { 0, 0 }
        for k, w in pairs { [-3] = -1, [-2] = 9, [-1] = -45, [1] = 45, [2] = -9, [3] = 1 } do
          local y = { q[1], q[2], v[1], v[2] }
          y[j] = y[j] + k * d
          sum = sum + w / (60 * d) * bundle[end_of](bundle, { y[1], y[2] }, { y[3], y[4] }, t)
        end
        worst = math.max(worst, abs(sum[1] - D[1][j]), abs(sum[2] - D[2][j]))
      end
    end
    near(worst, 0, 1e-10, "  both tangents are exact")
    -- variations: Lemma 3 and T V = vert+ + vert-
    local Dm, Dp = bundle:tangent_minus(q, v, t), bundle:tangent_plus(q, v, t)
    local function image(D, dq, dv) return D * dm.vector { dq[1], dq[2], dv[1], dv[2] } end
    local dq, dv = bundle:vertical_plus(q, v, { 0.3, -1 }, t)
    near(image(Dm, dq, dv):norm() + distance(image(Dp, dq, dv), { 0.3, -1 }), 0, 1e-14, "  dq^+ moves the end alone")
    dq, dv = bundle:vertical_minus(q, v, { 0.3, -1 }, t)
    near(image(Dp, dq, dv):norm() + distance(image(Dm, dq, dv), { 0.3, -1 }), 0, 1e-14, "  dq^- moves the beginning alone")
    local ap, bp, am, bm = bundle:split(q, v, { 1, 2 }, { -1, 0.5 }, t)
    near(distance(ap + am, { 1, 2 }) + distance(bp + bm, { -1, 0.5 }), 0, 1e-13, "  every variation is a sum of two")
    near(image(Dm, ap, bp):norm() + image(Dp, am, bm):norm(), 0, 1e-14, "  of which each leaves one end")
    -- the Legendre transforms are those of the rule: one step, its element, both momenta
    local rule = bundle.segments
    local start = { q = q0, p = dm.vector { -0.3, 0.9 }, t0 = 0.7 - (1 - bundle.bias) * 0.2 }
    local Q, P = system:solver({ rule = rule, h = 0.2 }):step(start)
    q2, v2 = bundle:velocity(q0, Q, t)
    local p0, p1 = bundle:momenta(q2, v2, t)
    near(distance(p0, start.p) + distance(p1, P), 0, 2e-12, "  its Legendre transforms make the step of the rule")
    local report, sentence = bundle:check { q = q, v = v, t = t }
    ok(report.ok and report.dimension == 4 and report.transversal > 0.5 and report.minus > 0.5 and report.plus > 0.5, "  " .. sentence)
    ok(report.limit > 0.9, "  the limit is reached at least like h", report.limit)
    local z0, z1 = bundle:pair(select(1, bundle:velocity(q, q, t)), report.zero, t)
    near(distance(z0, q) + distance(z1, q), 0, 1e-14, "  its zero has no extent")
  end
end

-- the harmonic oscillator, q1 = q + h v - h^2 q/2 - h^3 v/6 + ...: kernels meet where dq1/dv = 0
for n = 1, 2 do
  local oscillator = dm.system { Q = dm.R(n), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }
  local function largest(method, bias)
    local bundle = dm.bundle { system = oscillator, h = 0.1, segments = method, bias = bias }
    return bundle:check({ q = { 0.3, n == 2 and 0.1 or nil }, v = { 1, n == 2 and 2 or nil } }).largest_h
  end
  near(largest "rk4", sqrt(6), 1e-7, "rk4 on the oscillator: h - h^3/6 = 0")
  near(largest "kutta3", sqrt(6), 1e-7, "kutta3 too")
  ok(largest "heun" == math.huge and largest "midpoint" == math.huge, "methods of order 2 have dq1/dv = h")
  -- to order 5: h - h^3/6 + h^5/120 has no zero, but one minimum is near; order 8 nearly sees sin h = 0
  near(largest "dop853", pi, 0.05, "order 8 meets near the half period")
end

-- the discrete Lagrangian and its symmetry
local bundle = dm.bundle { system = kepler, h = 0.1, segments = "rk4" }
-- on the unit circle L = 3/2
local off = {}
for i, h in ipairs { 0.1, 0.05 } do off[i] = dm.bundle({ system = kepler, h = h, segments = "rk4" }):action({ 1, 0 }, { 0, 1 }) - 1.5 * h end
near(math.log(off[1] / off[2], 2), 5, 0.1, "the action on a circle: h (1/2 + 1), to the order of the method and one more")
near(bundle:action({ 1, 0 }, { 0.2, 1 }), bundle:action({ 0, 1 }, { -1, 0.2 }), 1e-16, "it is invariant under rotation")
local p0, p1 = bundle:momenta({ 1, 0 }, { 0.2, 1 })
local q0, q1 = bundle:pair({ 1, 0 }, { 0.2, 1 })
near(q0[1] * p0[2] - q0[2] * p0[1], q1[1] * p1[2] - q1[2] * p1[1], 1e-14, "J- = J+ (theorem of Noether)")

ok(tostring(bundle):find "discrete tangent bundle of R^2", "a bundle prints itself", bundle)
ok(bundle.h == 0.1 and bundle.bias == 1 and bundle.dimension == 4 and bundle.system == kepler and bundle.segments.order == 4, "its fields")
local own = dm.bundle { system = kepler, h = 0.1, segments = dm.curve { method = function(x, f, h) return x + h * f(x + h / 2 * f(x)) end } }
near(distance(own:plus({ 1, 0 }, { 0, 1 }), dm.bundle({ system = kepler, h = 0.1, segments = "midpoint" }):plus({ 1, 0 }, { 0, 1 })), 0, 1e-16, "segments by a method written in Lua")

-- misuse
raises("field 'h'", dm.bundle, { Q = dm.R(1) })
raises("either 'system'", dm.bundle, { h = 1 })
raises("either 'system'", dm.bundle, { h = 1, Q = dm.R(2), system = kepler })
raises("field 'system'", dm.bundle, { h = 1, system = 3 })
raises("give 'system'", dm.bundle, { h = 1, Q = dm.R(2), segments = "rk4" })
raises("unknown one-step method", dm.bundle, { h = 1, system = kepler, segments = "rk5" })
raises("field 'segments'", dm.bundle, { h = 1, system = kepler, segments = 3 })
raises("bias of its own", dm.bundle, { h = 1, system = kepler, segments = dm.curve "rk4", bias = 0.5 })
raises("field 'bias'", dm.bundle, { h = 1, Q = dm.R(2), bias = -1 })
raises("did you mean", dm.bundle, { h = 1, Q = dm.R(2), baias = 1 })
raises("field 'Q'", dm.bundle, { h = 1, Q = 3 })
raises("2 entries", bundle.plus, bundle, { 1 }, { 2 })
raises("q", bundle.plus, bundle)
raises("field 'q'", bundle.check, bundle, { v = { 1, 2 } })
raises("NaN", bundle.plus, bundle, { 0, 0 }, { 0, 0 })
raises("hyper-dual", function()
  local slow = dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v) return v[1] ^ 2 / 2 end }
  dm.bundle({ system = slow, h = 0.1 }):plus({ 1 }, { 1 })
end)
raises("degenerate", function()
  local flat = dm.system { Q = dm.R(2), L = function(q, v) return q[1] * v[2] - q[2] ^ 2 end }
  dm.bundle({ system = flat, h = 0.1 }):plus({ 1, 0 }, { 1, 0 })
end)
local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local report, sentence = dm.bundle({ system = oscillator, h = sqrt(6), segments = "rk4" }):check { q = { 0.3 }, v = { 1 } }
ok(not report.ok and report.transversal < 1e-14 and sentence:find "NO discrete", "where the kernels meet it is none, and says so", sentence)
-- a step far beyond the time scale of the field: Newton's method finds no element
raises("velocity: ", function()
  local stiff = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - math.exp(q[1] ^ 2) end }
  return dm.bundle({ system = stiff, h = 30, segments = "rk4" }):velocity({ 0.5 }, { -0.9 })
end)
tap.done()
