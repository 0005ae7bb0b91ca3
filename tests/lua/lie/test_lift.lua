-- rules of coordinates on groups, by the collective lift: orders, closed forms, structure, other groups, refusals
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, log, sin, cos, sqrt, pi = math.abs, math.max, math.log, math.sin, math.cos, math.sqrt, math.pi

local function far(a, b)
  if type(b) == "number" then return abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = max(worst, far(a[i], b[i])) end
  return worst
end
local function finish(system, rule, h, steps, s, every)
  local path = system:solver { rule = rule, h = h }:run { q = s.q, p = s.p, v = s.v, steps = steps, every = every or steps }
  return path.q[#path], path.p[#path], path
end

local G = dm.SO(3)
local one = G:identity()
local function top(I, mgl)
  return dm.system { Q = G, L = function(R, W) return (I[1] * W[1] ^ 2 + I[2] * W[2] ^ 2 + I[3] * W[3] ^ 2) / 2 - mgl * R[3][3] end }
end

---- a heavy top: orders against an independent program ----

local heavy, tilt = top({ 1, 1.2, 0.6 }, 1), { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } }
local at4 = { { 0.863360085068844877, 0.297258278600659099, -0.407733833907967313 },
  { 0.243379992796450193, 0.462521913646183728, 0.852548918539852477 },
  { 0.442013057065418363, -0.83529096439530884, 0.326976241007260511 } }
for _, row in ipairs { { "gauss(1)", 2, 80 }, { "midpoint", 2, 80 }, { "gauss(2)", 4, 40 }, { "gauss(3)", 6, 20 }, { "gauss(4)", 8, 10 },
  { "kahan-li(6, midpoint)", 6, 80 }, { "yoshida(4, midpoint)", 4, 160 } } do
  local e = {}
  for k = 1, 2 do e[k] = far(finish(heavy, row[1], 4 / row[3] / k, row[3] * k, tilt), at4) end
  near(log(e[1] / e[2]) / log(2), row[2], 0.2, row[1] .. ": order " .. row[2] .. " on a heavy top")
end
ok(far(finish(heavy, "gauss(8)", 0.1, 40, tilt), at4) < 1e-14, "gauss(8) to the last digits")
ok(far(finish(heavy, "gauss(12)", 0.4, 10, tilt), at4) < 1e-13, "gauss(12), without lanes")

---- closed forms ----

local free, a, b = top({ 1, 2, 3 }, 0), 1, sqrt(1 - 67 / 111)
for _ = 1, 8 do a, b = (a + b) / 2, sqrt(a * b) end
local spin = { q = one, p = { 0.9, 0.3, 1.2 } }
local R, p = finish(free, "gauss(8)", 4 * pi / (2 * a) / sqrt(1.665 / 6) / 32, 32, spin)
ok(far(R, G:exp { -1.62596367376406061, -0.541987891254686869, -2.16795156501874748 }) < 1e-12, "Montgomery's phase of a free body")
ok(far(p, spin.p) < 1e-12, "after the period of its momentum")
local still = dm.system { Q = G, L = function(_, W) return W:dot(W) / 2 end }
ok(far(finish(still, "gauss(3)", 0.1, 10, { q = one, v = { 0.3, -0.2, 0.5 } }), G:exp { 0.3, -0.2, 0.5 }) < 1e-12, "a ball turns uniformly")

---- structure ----

local _, _, long = finish(heavy, "gauss(4)", 0.1, 10000, tilt, 10)
local S0 = tilt.q * dm.vector(tilt.p)
local vertical, off = 0, 0
for i = 1, #long do
  local Q = long.q[i]
  vertical = max(vertical, abs((Q * long.p[i])[3] - S0[3]))
  off = max(off, far(Q:transpose() * Q, one))
end
ok(vertical < 2e-13 and off < 3e-14, ("vertical momentum and R^T R over 10^4 steps (%.1e, %.1e)"):format(vertical, off))
local drift = heavy:solver { rule = "gauss(8)", h = 0.25 }:run { q = tilt.q, p = tilt.p, steps = 4000, every = 40 }:drift "energy"
ok(drift.largest < 5e-13, ("gauss(8) keeps the energy to round-off (%.1e)"):format(drift.largest))
local _, _, round = finish(free, "gauss(2)", 0.1, 10000, spin, 100)
local worst = 0
for i = 1, #round do worst = max(worst, far(round.q[i] * round.p[i], spin.p)) end
ok(worst < 3e-14, ("spatial momentum of a free body (%.1e)"):format(worst))
local g = G:exp { 0.7, -0.4, 1.1 }
local turned = finish(free, "gauss(3)", 0.2, 20, { q = g, p = spin.p })
ok(far(turned, g * finish(free, "gauss(3)", 0.2, 20, spin)) < 1e-14, "left equivariance")
local function same(rule, backend)
  local x = heavy:solver { rule = rule, h = 0.1 }:run { q = tilt.q, p = tilt.p, steps = 50 }
  local y = heavy:solver { rule = rule, h = 0.1, backend = backend }:run { q = tilt.q, p = tilt.p, steps = 50, every = 50 }
  return far(x.p[51], y.p[2]) == 0 and far(x.q[51], y.q[2]) == 0
end
ok(same("gauss(4)", "tape") and same("gauss(8)", "tape") and same("midpoint"), "the same bits by the tape, and however rows are kept")

---- what takes a run ----

local solver = heavy:solver { rule = "gauss(3)", h = 0.1 }
local path, file = solver:run { q = tilt.q, p = tilt.p, steps = 100 }, os.tmpname()
solver:run { q = tilt.q, p = tilt.p, steps = 70 }:checkpoint(file)
ok(far(dm.resume(file, heavy):run { steps = 30 }.p[31], path.p[101]) == 0, "a run goes on bit for bit")
os.remove(file)
local cloud = solver:ensemble { members = 9, q = function() return tilt.q end, p = function(i) return { 0.2, 0.1 * i, 1.5 } end, steps = 100 }
ok(far(cloud.p[1], path.p[101]) == 0, "a member has the bits of a run")
local nutation = top({ 1, 1, 0.4 }, 1):solver { rule = "gauss(6)", h = 0.1 }:run { q = G:exp { 0.5, 0, 0 }, p = { 0, 0.4, 1.6 }, t = 5,
  events = { nod = function(r, W) return r[3][1] * W[2] - r[3][2] * W[1] end } }
local nod = nutation.events[#nutation.events]
near(nod.q[3][3], 0.3598928600845291666, 1e-11, "the largest tilt of a symmetric top, an event")
near(nod.t, 4.024973369484884314, 1e-10, "half a nutation")

---- Hamiltonians on groups ----

local H = dm.system { Q = G, H = function(r, P) return P[1] ^ 2 / 2 + P[2] ^ 2 / 2.4 + P[3] ^ 2 / 1.2 + r[3][3] end }
ok(far(finish(H, "gauss(2)", 0.05, 80, tilt), (finish(heavy, "gauss(2)", 0.05, 80, tilt))) < 1e-13, "H(R, Pi) and L of a top agree")
ok(far(finish(H, "lie(2)", 0.05, 80, tilt), (finish(heavy, "lie(2)", 0.05, 80, tilt))) < 1e-12, "by lie(2), too")
local quartic = dm.system { Q = G, H = function(r, P) return P:dot(P) ^ 2 / 4 + P[1] * P[2] + r[3][3] end }
ok(quartic:structure().hamiltonian, "an H that is not quadratic in Pi")
local q1 = finish(quartic, "gauss(4)", 0.05, 20, { q = tilt.q, p = { 0.2, 0.3, 0.9 } })
ok(far(q1, (finish(quartic, "gauss(8)", 0.05, 20, { q = tilt.q, p = { 0.2, 0.3, 0.9 } }))) < 1e-9, "is stepped by the lift")

---- other groups, against lie(3) ----

local function compare(name, system, s, rule)
  local A, pa = finish(system, rule or "gauss(4)", 0.05, 20, s)
  local B, pb = finish(system, "lie(3)", 0.05, 20, s)
  local d = max(far(A, B), far(pa, pb))
  ok(d < 2e-7, ("%s: gauss(4) and lie(3) agree (%.1e)"):format(name, d))
end
compare("SE(3)", dm.system { Q = dm.SE(3), L = function(m, x)
  return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2 + 1.5 * x[4] ^ 2 + x[5] ^ 2 + 0.5 * x[6] ^ 2) / 2 - m[1][4] ^ 2 / 2 - m[3][3]
end }, { q = dm.SE(3):identity(), p = { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 } })
compare("SO(4)", dm.system { Q = dm.SO(4), L = function(m, x)
  local sum = -m[1][2]
  for i = 1, 6 do sum = sum + (1 + i / 4) * x[i] ^ 2 / 2 end
  return sum
end }, { q = dm.SO(4):identity(), p = { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 } })
compare("SL(2)", dm.system { Q = dm.SL(2), L = function(m, x) return (x[1] ^ 2 + 2 * x[2] ^ 2 + 1.5 * x[3] ^ 2) / 2 - m[1][1] ^ 2 / 3 end },
  { q = dm.SL(2):identity(), p = { 0.3, 0.2, -0.1 } })
local _, _, squeezed = finish(dm.system { Q = dm.Sp(4), L = function(m, x) return x:dot(x) / 2 - m[1][2] ^ 2 / 3 end }, "gauss(4)", 0.05, 200,
  { q = dm.Sp(4):identity(), v = { 0.1, 0.2, -0.1, 0.1, 0, 0.1, 0.2, 0, 0.1, -0.2 } }, 50)
local flat = dm.Sp(4):bonds(dm.Sp(4):flat(squeezed.q[5]))
local bond = 0
for i = 1, #flat do bond = max(bond, abs(flat[i])) end
ok(bond < 1e-13 and squeezed:drift "energy".largest < 1e-8, ("Sp(4): on the group (%.1e)"):format(bond))
compare("SE(2)", dm.system { Q = dm.SE(2), L = function(m, x) return (x[1] ^ 2 + 2 * x[2] ^ 2 + x[3] ^ 2 / 2) / 2 - m[1] ^ 2 / 2 end },
  { q = { 0.1, 0.2, 0.3 }, v = { 0.5, 0.2, 0.7 } })
compare("Heisenberg", dm.system { Q = dm.Heisenberg(1), L = function(_, x) return x:dot(x) / 2 end }, { q = { 0, 0, 0 }, p = { 1, 0, 1.5 } })
compare("a mass that varies", dm.system { Q = G, L = function(r, W)
  return ((1 + r[1][2] ^ 2) * W[1] ^ 2 + 2 * W[2] ^ 2 + W[3] ^ 2 * (2 + r[3][3]) + W[1] * W[2] * r[1][1] / 2) / 2 + r[2][1] * W[3] - r[3][3]
end }, tilt)
compare("right trivialization", dm.system { Q = G, trivialization = "right", L = function(r, w)
  local W = r:transpose() * w
  return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - r[3][3]
end }, tilt)
compare("matrix columns", dm.system { Q = G, columns = "matrix", L = function(r, W) return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - r[3][3] end }, tilt)
compare("in time", dm.system { Q = G, L = function(r, W, t) return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - r[3][3] * dm.cos(t) end }, tilt)
compare("lobatto where there is no relation", dm.system { Q = dm.SE(2), L = function(m, x) return x:dot(x) / 2 - m[1] ^ 2 / 2 end },
  { q = { 0.1, 0.2, 0.3 }, v = { 0.5, 0.2, 0.7 } }, "lobatto(4)")
-- a satellite in its gravity gradient, at a relative equilibrium
local I, r, SR = { 0.1, 0.2, 0.25 }, 2, dm.product(G, dm.R(3))
local n = sqrt((1 + 1.5 * (I[2] + I[3] - 2 * I[1]) / r ^ 2) / r ^ 3)
local satellite = dm.system { Q = SR, L = function(q, v)
  local x = q[2]
  local X, d = q[1]:transpose() * x, sqrt(x:dot(x))
  return (I[1] * v[1] ^ 2 + I[2] * v[2] ^ 2 + I[3] * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 + 1 / d
    + (I[1] + I[2] + I[3] - 3 * (I[1] * X[1] ^ 2 + I[2] * X[2] ^ 2 + I[3] * X[3] ^ 2) / d ^ 2) / (2 * d ^ 3)
end }
local e = finish(satellite, "gauss(4)", 0.1, 100, { q = { one, dm.vector { r, 0, 0 } }, v = { 0, 0, n, 0, r * n, 0 } })
ok(far(e[2], { r * cos(10 * n), r * sin(10 * n), 0 }) < 1e-9 and abs(e[1][2][1] - sin(10 * n)) < 1e-9, "SO(3) x R^3: orbit and attitude of a satellite")

---- explicit splittings ----

for _, row in ipairs { { 2, 160 }, { 4, 80 }, { 6, 40 }, { 8, 16 } } do
  local e, rule = {}, ("rotations(%d)"):format(row[1])
  for k = 1, 2 do e[k] = far(finish(heavy, rule, 4 / row[2] / k, row[2] * k, tilt), at4) end
  near(log(e[1] / e[2]) / log(2), row[1], 0.2, rule .. ": order on a heavy top")
end
local _, _, spun = finish(free, "rotations(4)", 0.1, 10000, spin, 100)
local lost = 0
for i = 1, #spun do lost = max(lost, far(spun.q[i] * spun.p[i], spin.p), far(spun.q[i]:transpose() * spun.q[i], one)) end
ok(lost < 1e-12 and spun:drift "energy".largest < 1e-5, ("rotations(4): spatial momentum and R^T R (%.1e)"):format(lost))
for _, row in ipairs { { "rotations(2)", 2e5 }, { "rotations(4)", 1e5 } } do
  local _, _, long = finish(heavy, row[1], 0.05, row[2], tilt, 500)
  local J, off = long:momentum(G), 0
  for i = 1, #long do off = max(off, abs(J[i][3] - J[1][3])) end
  ok(off < 5e-14, ("%s: the vertical momentum of a top after %d steps (%.1e)"):format(row[1], row[2], off))
end
local gliding = dm.system { Q = SR, L = function(q, v)
  return (v[1] ^ 2 + 2 * v[2] ^ 2 + 3 * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 - q[2]:dot(q[2]) / 2 - q[1][3][3] * q[2][1]
end }
local there = { q = { one, dm.vector { 0.3, 0, 0.1 } }, v = { 0.2, 0.5, -0.3, 0, 0.4, 0.1 } }
ok(far(finish(gliding, "rotations(8)", 0.05, 40, there), (finish(gliding, "gauss(6)", 0.05, 40, there))) < 1e-9, "and on SO(3) x R^3")
-- members in lanes have the bits of runs, with a potential that depends on time, on every group that splits, and with steps of their own
local shaken = dm.system { Q = G, L = function(R, W, t) return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3] * (1 + 0.3 * math.cos(t)) end }
local frame = dm.system { Q = dm.SE(3), L = function(g, x) return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2 + 1.5 * x[4] ^ 2 + x[5] ^ 2 + 0.5 * x[6] ^ 2) / 2 - g[1][4] ^ 2 - g[3][3] * g[2][4] end }
local flat = dm.system { Q = dm.SL(2), L = function(g, x) return x:dot(x) / 2 - (g[1][1] ^ 2 + g[1][2] ^ 2 + g[2][1] ^ 2 + g[2][2] ^ 2) / 4 end }
for name, row in pairs { top = { heavy, tilt.q, 3 }, ["in time"] = { shaken, tilt.q, 3 }, ["R^3 beside"] = { gliding, there.q, 6 }, ["SE(3)"] = { frame, dm.SE(3):exp { 0.1, 0.2, 0, 0.3, 0, 0.1 }, 6 },
  ["SL(2)"] = { flat, dm.SL(2):exp { 0.1, 0.2, 0.3 }, 3 } } do
  local system, q, d = row[1], row[2], row[3]
  local function p(i)
    local out = {}
    for k = 1, d do out[k] = 0.1 * k + 0.01 * i end
    return out
  end
  for _, rule in ipairs { "rotations(2)", "rotations(4)" } do
    local solver = system:solver { rule = rule, h = 0.03 }
    local many = solver:ensemble { members = 13, q = function() return q end, p = p, steps = 40 }
    local alone, worst = nil, 0
    for i = 1, 13 do
      alone = solver:run { q = q, p = p(i), steps = 40, every = 40 }
      worst = max(worst, far(many.p[i], alone.p[2]))
    end
    ok(worst == 0 and (many.lanes >= 4 or many.lanes == 1), ("%s, %s: members have the bits of runs (%d lanes)"):format(name, rule, many.lanes))
  end
  local exact = finish(system, "lie(3)", 0.02, 60, { q = q, p = p(1) })
  local half, whole = finish(system, "rotations(4)", 0.02, 60, { q = q, p = p(1) }), finish(system, "rotations(4)", 0.04, 30, { q = q, p = p(1) })
  ok(far(half, exact) < 1e-6 and far(whole, exact) / far(half, exact) > 11, ("%s: rotations(4) goes where lie(3) goes (%.1e)"):format(name, far(half, exact)))
end
-- turns of any size: the exact flow of a body that turns about one axis
local quick = finish(free, "rotations(2)", 1, 7, { q = one, v = { 0, 0, 5 } })
ok(far(quick, G:exp { 0, 0, 35 - 10 * math.pi }) < 1e-13, "a step may turn the body by more than half a turn")
raises("rotations", function() finish(dm.system { Q = G, L = function(R, W) return W:dot(W) / 2 + W[1] * R[1][1] end }, "rotations(2)", 0.1, 1, { q = one, v = { 1, 0, 0 } }) end)
raises("rotations", function() finish(dm.system { Q = G, L = function(_, W) return W:dot(W) / 2 + W[1] end }, "rotations(2)", 0.1, 1, { q = one, v = { 1, 0, 0 } }) end)
raises("rotations", function() finish(dm.system { Q = G, L = function(_, W) return W:dot(W) / 2 + W[1] * W[2] / 2 end }, "rotations(2)", 0.1, 1, { q = one, v = { 1, 0, 0 } }) end)
raises("verlet is for R^n", function() dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end }:solver { rule = "rotations", h = 0.1 }:run { q = { 0 }, v = { 1 }, steps = 1 } end)
raises("2, 4, 6 or 8", function() heavy:solver { rule = "rotations(3)", h = 0.1 } end)

---- refusals ----

local four = dm.SO(4)
local function on_four(L, rule, force)
  finish(dm.system { Q = four, L = L, force = force }, rule, 0.1, 1, { q = four:identity(), v = { 0.1, 0, 0, 0, 0, 0 } })
end
local function half(_, x) return x:dot(x) / 2 end
raises("does not keep the quadratic functions", function() on_four(half, "lobatto(3)") end)
raises("does not keep the quadratic functions", function() on_four(half, "rk4") end)
raises("quadratic in the velocity", function() on_four(function(_, x) return x:dot(x) / 2 + x[1] ^ 4 end, "gauss(2)") end)
raises("forces on this group", function() on_four(half, "gauss(2)", function(_, x) return -x end) end)
local lines = dm.group { name = "lines", basis = { { { 1, 0 }, { 0, 2 ^ 0.5 } } } } -- y = x^sqrt(2) is not quadratic
raises("lie(s", function() finish(dm.system { Q = lines, L = half }, "gauss(2)", 0.1, 1, { q = lines:identity(), v = { 1 } }) end)
raises("degenerate", function() finish(dm.system { Q = G, L = function(_, W) return W[1] ^ 2 end }, "gauss(2)", 0.1, 1, { q = one, v = { 1, 0, 0 } }) end)

tap.done()
