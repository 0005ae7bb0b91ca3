-- symplectic-energy-momentum steps: energies, momenta, roots and none, events, checkpoints, members
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, abs, max, cos = math.sqrt, math.abs, math.max, math.cos

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function line(V)
  return dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - V(q[1]) end }
end
local oscillator = line(function(x) return x ^ 2 / 2 end)
-- two rods of length 1: the mass matrix depends on q
local double = dm.system { Q = dm.R(2), L = function(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2])
    + 9.81 * (2 * cos(q[1]) + cos(q[2]))
end }
local function sem(s, r, h, system)
  return (system or kepler):solver { rule = ("sem(%d, gauss(%d))"):format(s, r), h = h }
end
local start = { q = { 0.5, 0 }, v = { 0, sqrt(3) }, steps = 60 }
local function with(more, of)
  local out = {}
  for k, v in pairs(of or start) do out[k] = v end
  for k, v in pairs(more) do out[k] = v end
  return out
end

-- the same step from its three equations, written by hand for Newton's method of dm.step
local by_hand = dm.step { name = "sem by hand", unknowns = 3, order = 2, parts = { { "last", 1 } },
  begin = function(q, p, h) return { last = h } end,
  start = function(y) return { y.q[1] + y.last * y.p[1], y.q[2] + y.last * y.p[2], y.last } end,
  equation = function(y, x)
    local h, E = x[3], -0.512499292746325657
    local v = { (x[1] - y.q[1]) / h, (x[2] - y.q[2]) / h }
    local m = { (x[1] + y.q[1]) / 2, (x[2] + y.q[2]) / 2 }
    local r = (m[1] ^ 2 + m[2] ^ 2) ^ 0.5
    return { v[1] - y.p[1] + h / 2 * m[1] / r ^ 3, v[2] - y.p[2] + h / 2 * m[2] / r ^ 3,
      (v[1] ^ 2 + v[2] ^ 2) / 2 - 1 / r - E }
  end,
  next = function(y, x)
    local h = x[3]
    local v = { (x[1] - y.q[1]) / h, (x[2] - y.q[2]) / h }
    return { q = { x[1], x[2] }, p = { 2 * v[1] - y.p[1], 2 * v[2] - y.p[2] }, t = y.t + h, last = h }
  end }
local path, hand = sem(1, 1, 0.05):run(start), kepler:solver { rule = by_hand, h = 0.05 }:run(start)
near(path.t[61], hand.t[61], 1e-11, "sem(1, gauss(1)) is the step written by hand: time")
near(path.q[61][1], hand.q[61][1], 1e-11, "  and place")
near(path:column "h"[30], hand:column "last"[30], 1e-12, "  and lengths")

-- what is kept, for three degrees and a mass that changes
for s = 1, 3 do
  path = sem(s, s, 0.05):run(start)
  ok(path:drift "E_d".largest < 1e-13 and path.sem.defect < 1e-13 and path.sem.fallbacks == 0,
    ("degree %d: E_d to round-off"):format(s), path.sem.defect)
  ok(path:drift(path:momentum(dm.SO(2))).largest < 1e-13, "  angular momentum", s)
  local times = path.t
  local off = 0
  for i = 2, 61 do off = max(off, abs(times[i] - times[i - 1] - path:column "h"[i])) end
  ok(off < 1e-14, "  column h is the step that ends at the row", off)
  ok(path.sem.conditioning > 0 and path.sem.conditioning < ({ 1e-13, 1e-9, 1e-7 })[s], "  rounding of h", path.sem.conditioning)
end
path = sem(1, 1, 0.03, double):run { q = { 1, 0.5 }, v = { 0, 0 }, steps = 100 }
ok(path.sem.defect < 1e-13 and path.sem.fallbacks == 0, "two pendulums: E_d to round-off", path.sem.defect)
path = sem(1, 1, 0.1, oscillator):run { q = { 1 }, v = { 0 }, steps = 200 }
near(path.t[201], 20, 1e-12, "oscillator: h stays")
path = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end }
  :solver { rule = "sem(1, gauss(1))", h = 0.1 }:run { q = { 0, 0 }, v = { 1, 2 }, steps = 20 }
near(path.t[21], 2, 1e-14, "free: any h has the energy, and it stays")
path = sem(1, 1, 0.1, oscillator):run { q = { 0 }, p = { 0 }, steps = 20 }
near(path.t[21], 2, 1e-14, "at rest too")
local zeros, ones = {}, {}
for i = 1, 10 do zeros[i], ones[i] = 0, 1 end
path = dm.system { Q = dm.R(10), L = function(q, v) return v:dot(v) / 2 end }
  :solver { rule = "sem(1, gauss(1))", h = 0.1 }:run { q = zeros, v = ones, steps = 20 }
ok(abs(path.t[21] - 2) < 1e-14 and path.sem.conditioning == 0, "ten free coordinates", path.sem.conditioning)
-- 1e5 steps: what is left of every step has no sign
path = sem(1, 1, 0.05):run(with { steps = 1e5, every = 1000 })
ok(path:drift(path:momentum(dm.SO(2))).largest < 1e-13 and path.sem.defect < 1e-13, "100,000 steps: momentum and E_d", path.sem.defect)

-- one to five coordinates by the kernel of the whole step: masses that do not separate, that vary,
-- and a magnetic term; more by sweeps, with a term linear in v and without. Every step is one of the
-- midpoint's Ld at its own h, whose energy is E
local function mixed(n, coupling)
  return function(q, v)
    local L = 0
    for i = 1, n do L = L + (1 + i / 4) * v[i] ^ 2 / 2 - q[i] ^ 2 / 2 - q[i] ^ 4 / (8 + i) end
    for i = 2, n do L = L + (coupling or 0.2) * v[i] * v[i - 1] - 0.3 * q[i] * q[i - 1] end
    return L + (coupling and 0 or 0.7 * v[n])
  end
end
local function bent(n)
  local plain = mixed(n)
  return function(q, v)
    local L = plain(q, v) + 0.1 * q[1] ^ 2 * v[1] ^ 2
    return n > 1 and L + 0.4 * q[1] ^ 2 * v[2] + 0.1 * q[2] * v[1] * v[2] or L
  end
end
for _, n in ipairs { 1, 2, 3, 4, 5, 11, 14 } do
  local second = n > 5 and "diagonal mass" or "varying mass"
  for name, L in pairs { ["constant mass"] = mixed(n), [second] = n > 5 and mixed(n, 0) or bent(n) } do
    local q, v = { 0.7, 0.5, -0.4, 0.3, 0.1 }, { 0.2, -0.5, 0.6, 0.4, 0.3 }
    for i = 6, n do q[i], v[i] = 0.2 * cos(i), 0.2 * cos(2 * i) end
    local from = { q = { table.unpack(q, 1, n) }, v = { table.unpack(v, 1, n) }, steps = 150 }
    local system = dm.system { Q = dm.R(n), L = L }
    local run, off, energy = sem(1, 1, 0.05, system):run(from), 0, 0
    local length = run:column "h"
    for i = 1, 150, 7 do
      local Ld = dm.discrete_lagrangian(system, { rule = "midpoint", h = length[i + 1] })
      local a, b = run.q[i], run.q[i + 1]
      off = max(off, (Ld:legendre_minus(a, b) - run.p[i]):norm(), (Ld:legendre_plus(a, b) - run.p[i + 1]):norm())
      energy = max(energy, abs(system:energy((a + b) / 2, (b - a) / length[i + 1]) - run.sem.energy))
    end
    local what = ("%d coordinates, %s"):format(n, name)
    ok(off < 1e-12, what .. ": momenta are those of Ld", off)
    ok(energy < 1e-13 * max(1, abs(run.sem.energy)) * 10, "  and the energy of its midpoint is E", energy)
    ok(run.sem.defect < 1e-13 and run.sem.fallbacks < 15, "  defect", run.sem.defect)
  end
end

-- by sweeps, the same as with two coordinates alone: fourteen more at rest; flagged steps too
local function crowd(m)
  return dm.system { Q = dm.R(16), L = function(q, v)
    return v:dot(v) / 2 + (m - 1) * v[9] ^ 2 / 2 + 1 / (q[1] ^ 2 + q[2] ^ 2) ^ 0.5
  end }
end
local function crowded(e, h, steps, m)
  local q, v = { 1 - e, 0 }, { 0, sqrt((1 + e) / (1 - e)) }
  local two = sem(1, 1, h):run { q = q, v = v, steps = steps }
  for i = 3, 16 do q[i], v[i] = i / 10, 0 end
  return two, sem(1, 1, h, crowd(m)):run { q = q, v = v, steps = steps }
end
local two, many = crowded(0.75, 0.02, 60, 1)
near(many.t[61], two.t[61], 1e-10, "16 coordinates, 14 of them at rest: the run of two")
near(many.q[61][2], two.q[61][2], 1e-10, "  and its places")
ok(many.sem.fallbacks == 0 and many.sem.defect < 1e-13, "  E_d", many.sem.defect)
near(many.sem.conditioning, two.sem.conditioning, two.sem.conditioning / 10, "  rounding of h")
two, many = crowded(0.8, 0.02, 40, 3)
ok(many.sem.fallbacks == two.sem.fallbacks, "  e = 0.8: the same steps are flagged", many.sem.fallbacks)
near(many.sem.defect, two.sem.defect, 1e-7, "  by as much")
-- a spring at h omega = 6, where sweeps do not contract
local stiff = dm.system { Q = dm.R(16), L = function(q, v)
  local L = v:dot(v) / 2 - 1800 * q[1] ^ 2
  for i = 2, 16 do L = L - q[i] ^ 2 / 2 - (q[i] - q[i - 1] / 10) ^ 4 / 4 end
  return L
end }
local q, v = {}, {}
for i = 1, 16 do q[i], v[i] = i == 1 and 0.001 or 0.3, i / 40 end
path = sem(1, 1, 0.1, stiff):run { q = q, v = v, steps = 20 }
ok(path.sem.defect < 1e-13 and path.sem.fallbacks == 0, "a stiff spring among 16: by the tables", path.sem.defect)

-- energies that are asked for
path = sem(1, 1, 0.05):run(with { energy = -0.52 })
ok(path.sem.energy == -0.52 and path.sem.defect < 1e-13 and path:column "E_d"[1] == -0.52, "run { energy = }", path.sem.defect)
ok(abs(path:column "h"[2] - 0.05) > 1e-3 and path:column "h"[1] == 0.05, "  whose first step is not h")
raises("sem(s, quadrature(r))", function() kepler:solver { rule = "gauss(1)", h = 0.1 }:run(with { energy = 1 }) end)
raises("finite number", function() sem(1, 1, 0.1):run(with { energy = "E" }) end)

-- where there is no root
path = sem(1, 1, 0.02):run { q = { 0.2, 0 }, v = { 0, 3 }, steps = 40 }
ok(path.sem.fallbacks > 0 and path:column "fallback":sum() == path.sem.fallbacks, "e = 0.8: flagged", path.sem.fallbacks)
ok(path.sem.least >= 0.004 - 1e-15, "  no step below h/5", path.sem.least)
ok(tostring(path):find "without a root", "  and said", tostring(path))
near(path:momentum(dm.SO(2))[41], 0.6, 1e-13, "  the angular momentum is kept all the same")
path = sem(1, 1, 0.02):run { q = { 0.25, 0 }, v = { 0, sqrt(7) }, steps = 49 }
ok(path.sem.fallbacks == 0, "e = 0.75 < sqrt(5/8): one revolution without")
local lobatto = kepler:solver { rule = "sem(2, lobatto(3))", h = 0.05 }
path = lobatto:run { q = { 0.7, 0 }, v = { 0, sqrt(1.3 / 0.7) }, steps = 20 }
ok(path.sem.fallbacks > 10, "degree 2, lobatto(3), e = 0.3: flagged nearly always", path.sem.fallbacks)
-- the flagged step is the best of the lengths that it may have
local E, h = path.sem.energy, path:column "h"
local k = 2
while path:column "fallback"[k] == 0 do k = k + 1 end
local state, before = { q = path.q[k - 1], p = path.p[k - 1] }, h[k - 1]
local lengths = {}
for i = 0, 200 do lengths[i + 1] = max(before / 2, 0.01) + (2 * before - max(before / 2, 0.01)) * i / 200 end
local energies, least = require "dm.core".sem_energies(lobatto, state, lengths), math.huge
for i = 1, 201 do least = math.min(least, abs(energies[i] - E)) end
ok(abs(path:column "E_d"[k] - E) <= least * (1 + 1e-6), "  a flagged step has the least |E_d - E|", least)

-- solvability: C = -(|grad V|^2 + p . V'' p)/8 for the midpoint
local one = sem(1, 1, 0.05)
local r = one:solvability { q = start.q, v = start.v }
near(r.C, -5, 1e-9, "solvability: C")
ok(r.solvable and #r.h == 1 and abs(r.h[1] - 0.05) < 1e-12 and r.order == 2, "  the root is h", r.h[1])
r = one:solvability { q = start.q, v = start.v, energy = -0.49 }
ok(not r.solvable and #r.h == 0 and r.why:find "other sign", "  none on the other side", r.why)
near(sem(1, 1, 0.1, oscillator):solvability { q = { 1 }, p = { 0.5 } }.C, -(1 + 0.25) / 8, 1e-10, "  C of the oscillator")
near(sem(2, 2, 0.1):solvability { q = start.q, v = start.v }.C, -7 / 9, 1e-5, "  of degree 2: E_d - H = C h^4")
raises("'gauss'", function() kepler:solver { rule = "gauss(2)", h = 0.1 }:solvability { q = start.q, v = start.v } end)
raises("unknown option 'E'", function() one:solvability { q = start.q, v = start.v, E = 1 } end)

-- events, times, checkpoints, members: the run itself is not touched
local plain = one:run(start)
local function is_same(a, b, n)
  for i = 1, n do
    if a.t[i] ~= b.t[i] or a.q[i][1] ~= b.q[i][1] or a.p[i][2] ~= b.p[i][2] then return false end
  end
  return true
end
local seen = one:run(with { events = { axis = function(q) return q[2] end } })
ok(#seen.events == 2 and is_same(plain, seen, 61), "events leave the run as it is", #seen.events)
local place = seen.events[1].q
ok(abs(place[2]) < 1e-14 and place[1] < -1, "  and are zeros", place[2])
local at = one:run { q = start.q, v = start.v, at = { plain.t[4], 0.5 * (plain.t[9] + plain.t[10]) } }
near(at.q[1][1], plain.q[4][1], 1e-14, "a row at the time of a step is that step")
near(at:column "h"[2], plain:column "h"[10], 1e-15, "a row inside a step has its h")
local short = one:run(with { steps = 25 })
local file = os.tmpname()
short:checkpoint(file)
local rest = dm.resume(file, kepler):run { steps = 35 }
os.remove(file)
ok(rest.t[36] == plain.t[61] and rest.q[36][1] == plain.q[61][1] and rest:column "h"[1] == plain:column "h"[26],
  "a checkpoint goes on bit for bit, with h and E")
raises("have their energy", function() dm.resume(short):run { steps = 1, energy = -0.5 } end)
local cloud = one:ensemble { members = 3, q = { { 0.5, 0 }, { 0.6, 0 }, { 0.7, 0 } },
  v = function() return { 0, 1.5 } end, steps = 20 }
local single = one:run { q = { 0.6, 0 }, v = { 0, 1.5 }, steps = 20 }
ok(cloud.q[2][1] == single.q[21][1], "a member is a run of its own")
cloud = one:ensemble { members = 3, q = { { 0.5, 0 }, { 0.6, 0 }, { 0.7, 0 } },
  v = function() return { 0, 1.5 } end, steps = 20, energy = -0.6, threads = 2 }
single = one:run { q = { 0.6, 0 }, v = { 0, 1.5 }, steps = 20, energy = -0.6 }
ok(cloud.q[2][1] == single.q[21][1], "  with the energy that is asked for, too")
raises("does not", function() kepler:solver { rule = "gauss(1)", h = 0.1 }:ensemble { members = 1, q = { { 1, 0 } }, v = { { 0, 1 } }, steps = 1, energy = 1 } end)

-- what is asked of steps of one length: h sees the state, which the tangent of L~ does not know
local free_h = sem(2, 2, 0.05)
for _, name in ipairs { "tangent", "symplecticity", "lyapunov", "multipliers", "reversal" } do
  raises("changes the time", free_h[name], free_h, with { steps = 20 })
end
raises("time of its own", free_h.modified_energy, free_h, with { steps = 60 })
raises("changes the time", dm.amplification, "sem(1, gauss(1))", 0.1)
near(free_h:measured_order({ q = start.q, v = start.v, t = 1 }).order, 4, 0.1,
  "orders are measured at one time")
ok(kepler:solver({ rule = " sem(1, gauss(1))", h = 0.1 }).own_time, "blanks before a rule's name are none of it")
near(free_h:backward_error(with { steps = 300 }).order, 4, 0.1, "and energies along the run")
-- a scene that allows this rule alone goes to its end: E = 0.5 - 2 = -1.5, a = 1/3, a turn is
-- 2 pi a^(3/2)
local turn = 2 * math.pi * (1 / 3) ^ 1.5
local scene = dm.scene { system = kepler, q = { 0.5, 0 }, v = { 0, 1 }, watch = { "q1" },
  tolerance = 1e-3, until_t = turn, rules = { "sem(2, gauss(2))" } }:run()
near(scene.t[#scene.t], turn, 1e-14, "a scene by this rule ends when it was told to")
near(scene:column "q1"[#scene], 0.5, 1e-3, "  where its tolerance says, a turn later")

-- what has no energy to keep
local function run(system, rule, n)
  local zero, v = {}, {}
  for i = 1, n do zero[i], v[i] = 0.1, 0.2 end
  return system:solver { rule = rule, h = 0.1 }:run { q = zero, v = v, steps = 1 }
end
raises("time", run, dm.system { Q = dm.R(1), L = function(q, v, t) return v[1] ^ 2 / 2 - t * q[1] end }, "sem(1, gauss(1))", 1)
raises("forces", run, dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end, force = function(_, v) return { -v[1] } end }, "sem(1, gauss(1))", 1)
raises("constraints", run, dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, constraint = function(q) return { q[1] - q[2] } end }, "sem(1, gauss(1))", 2)
raises("in sem(1, gauss(1))", run, oscillator, "sem(2)", 1)
raises("s nodes at least", run, oscillator, "sem(2, gauss(1))", 1)
raises("take a smaller h", function() kepler:solver { rule = "sem(1, gauss(1))", h = 3 }:run { q = { 0.1, 0 }, v = { 0, 0.1 }, steps = 1 } end)
tap.done()
