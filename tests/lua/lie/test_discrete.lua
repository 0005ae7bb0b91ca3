-- discrete Lagrangians on groups: the action of lie(s), formulas, Legendre maps, two-forms
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local G = dm.SO(3)
local heavy = dm.system { Q = G, L = function(R, W)
  return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3]
end }
local start = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } }

---- of a system ----

for _, rule in ipairs { "lie(1)", "lie(2)", "lie(2, lobatto(3))", "lie(1, gauss(1), cayley)",
  "lie(3)", "lie(1, pade(1))", "lie(2, gauss(2), pade(2))", "lie(3, pade(4))" } do
  local Ld = dm.discrete_lagrangian(heavy, { rule = rule, h = 0.2 })
  local path = heavy:solver { rule = rule, h = 0.2 }:run { q = start.q, p = start.p, steps = 2 }
  local q, p = path.q, path.p
  near((Ld:legendre_minus(q[1], q[2]) - p[1]):norm(), 0, 1e-14, rule .. ": -D1 Ld is p0")
  near((Ld:legendre_plus(q[1], q[2]) - p[2]):norm(), 0, 1e-14, rule .. ": D2 Ld is p1")
  near((Ld:legendre_minus(q[2], q[3]) - p[2]):norm(), 0, 1e-14, rule .. ": the momenta match")
  near((Ld:momentum(G, q[1], q[2]) - path:momentum(G)[2]):norm(), 0, 1e-14, rule .. ": momentum")
  -- derivatives of the value along g exp(e) are the momenta
  for a = 1, 3 do
    local e = dm.vector { a == 1 and 1e-5 or 0, a == 2 and 1e-5 or 0, a == 3 and 1e-5 or 0 }
    near((Ld(q[1], q[2] * G:exp(e)) - Ld(q[1], q[2] * G:exp(-e))) / 2e-5, p[2][a], 1e-9,
      rule .. ": the value has them for derivatives")
  end
end
local Ld
for _, rule in ipairs { "lie(2, gauss(2), pade(2))", "lie(2)" } do
  Ld = dm.discrete_lagrangian(heavy, { rule = rule, h = 0.2 })
  local q = heavy:solver { rule = rule, h = 0.2 }:run { q = start.q, p = start.p, steps = 1 }.q
  local Omega, worst = Ld:two_form(q[1], q[2]), 0
  for b = 1, 3 do
    local e = dm.vector { b == 1 and 1e-5 or 0, b == 2 and 1e-5 or 0, b == 3 and 1e-5 or 0 }
    local change = (Ld:legendre_minus(q[1], q[2] * G:exp(e))
      - Ld:legendre_minus(q[1], q[2] * G:exp(-e))) * (1 / 2e-5)
    for a = 1, 3 do worst = math.max(worst, math.abs(change[a] - Omega[a][b])) end
  end
  ok(worst < 1e-8, rule .. ": the two-form is the derivative of p0 by g1", worst)
end
local whole = Ld:solver():run { q = start.q, p = start.p, steps = 5 }
near((whole.p[6] - heavy:solver { rule = "lie(2)", h = 0.2 }
  :run { q = start.q, p = start.p, steps = 5 }.p[6]):norm(), 0, 0, "its solver is that of the rule")

---- a formula: the discrete rigid body of Moser and Veselov, with gravity ----

-- -trace(J g0^T g1)/h: moments of inertia are sums of two entries of J
local J = { 0.4, 0.2, 0.8 }
local function veselov(g0, g1, h)
  local M = g0:transpose() * g1
  return -(J[1] * M[1][1] + J[2] * M[2][2] + J[3] * M[3][3]) / h - h * (g0[3][3] + g1[3][3]) / 2
end
local mine = dm.discrete_lagrangian { Q = G, h = 0.02, Ld = veselov, name = "Moser-Veselov" }
local path = mine:solver():run { q = start.q, p = start.p, steps = 200 }
local drift = path:drift(path:momentum(dm.SO(2)))
-- its terms are of size 1/h: their round-off, 200 times
ok(drift.largest < 4e-12, "vertical momentum of a formula", drift.largest)
local long = mine:solver():run { q = start.q, p = start.p, steps = 1e5, every = 1e5 }
near(long:momentum(dm.SO(2))[2], long:momentum(dm.SO(2))[1], 3e-11, "and after 10^5 steps")
-- whatever of its equation a step leaves, which is of one sign: momenta are carried from p0, not read off D2 Ld alone
local loose = mine:solver { newton = { tolerance = 1e-6 } }:run { q = start.q, p = start.p, steps = 200 }
ok(loose:drift(loose:momentum(dm.SO(2))).largest < 1e-12, "and of a step that is not solved to round-off",
  loose:drift(loose:momentum(dm.SO(2))).largest)
local R = long.q[2]:transpose() * long.q[2]
for i = 1, 3 do near(R[i][i], 1, 1e-14, "on the group") end
near((mine:legendre_plus(path.q[10], path.q[11]) - path.p[11]):norm(), 0, 1e-13, "D2 Ld is p1")
near((mine:legendre_minus(path.q[11], path.q[12]) - path.p[11]):norm(), 0, 1e-13, "and -D1 Ld")
local same = dm.system { Q = G, L = function(R, W)
  return ((J[2] + J[3]) * W[1] ^ 2 + (J[1] + J[3]) * W[2] ^ 2 + (J[1] + J[2]) * W[3] ^ 2) / 2
    - R[3][3]
end }:solver { rule = "lie(3)", h = 0.1 }:run { q = start.q, p = start.p, steps = 40 }
local function error_of(of_h, h)
  local run = of_h:solver():run { q = start.q, p = start.p, steps = math.floor(4 / h + 0.5) }
  return G:distance(run.q[#run], same.q[41])
end
local finer = dm.discrete_lagrangian { Q = G, h = 0.01, Ld = veselov }
near(math.log(error_of(mine, 0.02) / error_of(finer, 0.01), 2), 2, 0.1, "Moser and Veselov's body has order 2")
near(mine:momentum(G, path.q[1], path.q[2], { side = "right" })[3], path.p[2][3], 1e-14,
  "body momentum")
local form = mine:two_form(G:identity(), G:identity())
near(form[1][1], (J[2] + J[3]) / 0.02, 1e-10, "the two-form at rest is the inertia over h")
ok(tostring(mine):find "SO%(3%), h = 0.02", "what it is")

---- of a formula there is no energy: |p|^2/2 of this run moves by 0.3, which is none of its motion's ----

ok(not tostring(path):find "energy", "a run does not speak of one", tostring(path))
raises("has no energy", function() return path:energy() end)
raises("no velocity", function() return path:velocity(2) end)
raises("has no energy", function() return path:drift "energy" end)
raises("no energy to watch", function()
  return mine:solver():run { q = start.q, p = start.p, steps = 2, watch = { "energy" } }
end)
raises("knows no velocity", function()
  return mine:solver():run { q = start.q, p = start.p, steps = 2, watch = { spin = function(_, w) return w[1] end } }
end)
-- nor a step of another length: a row at 0.01 had the state of 0.02
raises("has a fixed step", function() return mine:solver():run { q = start.q, p = start.p, at = { 0.01 } } end)
raises("cannot be chosen", function()
  return mine:solver():run { q = start.q, p = start.p, t = 0.1, control = { tolerance = 1e-6 } }
end)
raises("has a fixed step", function()
  return mine:solver():run { q = start.q, p = start.p, steps = 2, events = { up = function(q) return q[3][3] end } }
end)
local of_system = Ld:solver():run { q = start.q, p = start.p, steps = 2 }
ok(tostring(of_system):find "energy off by", "that of a system has its own", tostring(of_system))

---- refusals ----

raises("rule must be lie(s", dm.discrete_lagrangian, heavy, { rule = "gauss(2)", h = 0.1 })
raises("option 'h' is missing", dm.discrete_lagrangian, { Q = G, Ld = veselov })
raises("option 'Ld' is missing", dm.discrete_lagrangian, { Q = G, h = 0.1 })
raises("without constraints and forces", dm.discrete_lagrangian, dm.system { Q = G,
  L = function(_, w) return w:dot(w) end, force = function(_, w) return -w end },
  { rule = "lie(1)", h = 0.1 })
raises("unknown option 'h'", mine.solver, mine, { h = 0.3 })
raises("g1: the group element must be a matrix", mine.value, mine, G:identity(), { 1 })
tap.done()
