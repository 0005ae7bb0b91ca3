-- columns of runs of boxes: energy and momentum round the ring against closed forms, entries, what other paths have and these do not
local dm, tap = require "dm", require "tap"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, pi, abs = math.sin, math.cos, math.pi, math.abs

-- Klein-Gordon, u_tt = u_xx - m2 u: energy of (u_t^2 + u_x^2 + m2 u^2)/2, momentum of u_t u_x
local function klein_gordon(N, m2)
  return dm.multisymplectic { names = { "u", "p", "q" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = function(z) return (z[2] ^ 2 - z[3] ^ 2 + m2 * z[1] ^ 2) / 2 end, x = { 0, 2 * pi, N, periodic = true } }
end
local before
for _, N in ipairs { 33, 65 } do
  local run = klein_gordon(N, 4):solver { h = 0.1 }:run { z = { u = function(x) return sin(x) + 0.5 * cos(2 * x) end, p = function(x) return cos(x) end }, steps = 40 }
  ok(run:drift "energy".largest < 1e-12 and run:drift "momentum".largest < 1e-12, "linear boxes keep energy and momentum round the ring",
    run:drift "energy".largest)
  local off = abs(run:column "energy"[1] - pi * (1 + 1 + 4 + 0.25 * (4 + 4)) / 2) / pi
  ok(off < (before or 1) / 3.6, "the energy is that of the equation, to order 2", off)
  near(run:column "momentum"[1] / pi, 1, 12 / N ^ 2, "and the momentum, that of u_t u_x")
  before = off
  ok(run:column "q17"[41] == run.q[41][17] and run:column "time"[41] == run.t[41], "entries and times")
end

-- KdV: momentum -int u^2/2 = -8/3 of a soliton of speed 4, whatever the constant and the gain of the potential; nonlinear: order 2 or better
local last
for _, N in ipairs { 65, 129 } do
  local kdv = dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" }, x = { -20, 20, N, periodic = true },
    M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
    S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end }
  local run = kdv:solver { h = 2.58 / N }:run { z = { u = function(x) return 2 / dm.cosh(x) ^ 2 end }, t = 1 }
  local worst = run:drift "energy".largest
  ok(worst < (last or 4e-3) / 4, "energy of a soliton, with a component that gains", worst)
  near(run:column "momentum"[1], -8 / 3, 1000 / N ^ 2, "its momentum, to order 2")
  last = worst
end

-- names that end in digits: z1 of node 7 or z17 of none
local function plain(names)
  return dm.multisymplectic { names = names, M = { { 0, -1 }, { 1, 0 } }, K = { { 0, 1 }, { -1, 0 } }, S = function(z) return z[1] ^ 2 / 2 end, x = { 0, 1, 9, periodic = true } }
end
local run = plain():solver { h = 0.1 }:run { z = { z1 = sin, z2 = cos }, steps = 2 }
ok(run:column "z17"[2] == run.z1[2][7], "z17 is node 7 of z1")
run = plain { "u", "u1" }:solver { h = 0.1 }:run { z = { u = sin, u1 = cos }, steps = 2 }
ok(run:column "u19"[2] == run.u1[2][9], "u19 of 9 nodes is node 9 of u1")
run = dm.multisymplectic { names = { "u", "u1" }, M = { { 0, -1 }, { 1, 0 } }, K = { { 0, 1 }, { -1, 0 } }, S = function(z) return z[1] ^ 2 / 2 end,
  x = { 0, 1, 19, periodic = true } }:solver { h = 0.1 }:run { z = { u = sin, u1 = cos }, steps = 2 }
raises("is node 17 of 'u' or node 7 of 'u1'", function() run:column "u17" end)

raises("there are t, energy, momentum and a component with the number of a node, as u1 to u19", function() run:column "w" end)
raises("at least 3 rows", function() plain():solver { h = 0.1 }:run { z = { z1 = sin, z2 = cos }, steps = 1 }:drift "energy" end)
raises("a vector of 3 numbers", function() run:drift { 1, 2 } end)
raises("a run of boxes has no 'energy': it is a column", function() run:energy() end)
raises("a run of boxes has no 'frequency'", function() run:frequency() end)
raises("solver of boxes has no 'ensemble'", function() plain():solver { h = 0.1 }:ensemble {} end)
local line = dm.field { x = { 0, 1, 8 }, L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end }:solver { h = 0.05 }
raises("solver of a field on a line has no 'ensemble'", function() line:ensemble {} end)
raises("has no 'form': run.u[i]", function() line:run { u = sin, steps = 1 }:form(1) end)
ok(run.nothing == nil, "what nobody has is nil, so that scripts can ask")
tap.done()
