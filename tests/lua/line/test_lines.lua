-- fields on a line: discrete dispersion, kinks, natural, fixed and absorbing ends, energy, starts
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, exp, pi = math.sin, math.cos, math.exp, math.pi

local function linear(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function sine_gordon(u, ut, ux) return linear(u, ut, ux) - (1 - dm.cos(u)) end
local function zero() return 0 end
local function largest(x)
  local most = 0
  for i = 1, #x do most = math.max(most, math.abs(x[i])) end
  return most
end

---- standing waves: T / (1 - 2T/3) = lambda^2 X / (1 - 2X/3) for exact integrals, T = lambda^2 X for corners ----

local function standing(rule, N, k, lambda, steps)
  local h = lambda / N
  local run = dm.field { x = { 0, 1, N, periodic = true }, L = linear }:solver { rule = rule, h = h }
    :run { u = function(x) return cos(2 * pi * k * x) end, ut = 0, steps = steps }
  local X = sin(pi * k / N) ^ 2
  if rule == "cell(corners)" then return run, math.asin(lambda * math.sqrt(X)) end
  local S = lambda ^ 2 * X / (1 - 2 * X / 3)
  return run, math.asin(math.sqrt(S / (1 + 2 * S / 3)))
end
for _, case in ipairs { { "cell(gauss(2))", 24, 3, 0.75 }, { "cell(gauss(5))", 7, 2, 0.4 }, { "cell(corners)", 15, 4, 0.9 } } do
  local run, half = standing(case[1], case[2], case[3], case[4], 50)
  near(run.u[51][1], cos(100 * half), 2e-13, case[1] .. ": a standing wave turns by the discrete frequency")
end
local run = standing("cell(gauss(2))", 16, 5, 1, 32)
near(largest(run.u[33] - run.u[1]), 0, 1e-12, "lambda = 1 is exact: a wave is back after two periods of the ring")
local grown = dm.field { x = { 0, 1, 24, periodic = true }, L = linear }:solver { h = 1.05 / 24 }
  :run { u = function(x) return cos(24 * pi * x) end, ut = 0, steps = 60 }
ok(largest(grown.u[61]) > 1e3, "and 1.05 grows", largest(grown.u[61]))

---- limits of stability ----

local circle = dm.field { x = { 0, 1, 24, periodic = true }, L = linear }
near(circle:stability_limit "cell(gauss(2))", 1 / 24, 1e-12, "the limit of exact integrals is lambda = 1")
near(circle:stability_limit "cell(corners)", 1 / 24, 1e-12, "of corners, too")
local massive = dm.field { x = { 0, 1, 10, periodic = true }, L = function(u, ut, ux) return linear(u, ut, ux) - 100 * u ^ 2 / 2 end }
-- G = 4 M/h - (h/3) K - (h/3) m M on the mode of alternating signs, M = dx/3, K = 4/dx, m = 100
near(massive:stability_limit(), math.sqrt(4 / (3 * 4 / 0.01 / 3 * 1 + 100 / 3)), 2e-3, "a mass lowers it")
local two = dm.field { x = { 0, 1, 24, periodic = true }, values = 2, L = function(_, ut, ux) return (ut:dot(ut) - ux:dot(ux)) / 2 end }
near(two:stability_limit(), 1 / 24, 1e-12, "two values on a folded ring")
ok(dm.field { x = { 0, 1, 5 }, L = function(_, ut) return ut ^ 2 / 2 end }:stability_limit() == math.huge, "no force: no limit")
local open = dm.field { x = { 0, 1, 30 }, L = linear, fixed = "ends" }
local c29 = cos(29 * pi / 30) -- 4 m/h = h k/3 with m = (4 + 2 c)/6, k = 2 - 2 c of the shortest wave between fixed ends
for _, x in ipairs { { 0, 1, 25, periodic = true }, { 0, 1, 24 } } do -- tan^2(w h/2)/h^2 = tan^2(k dx/2)/dx^2: every h
  for _, m in ipairs { 0, 4 } do
    local line = dm.field { x = x, fixed = not x.periodic and "ends" or nil, L = function(u, ut, ux) return (ut ^ 2 - ux ^ 2 - m * u ^ 2) / 2 end }
    ok(line:stability_limit "cell(gauss(1))" == math.huge, "one point a cell: no step is too long")
  end
end
raises("one point a cell does not see", function() dm.field { x = { 0, 1, 24, periodic = true }, L = function(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end }:stability_limit "cell(gauss(1))" end)
near(open:stability_limit(), math.sqrt(2 * (4 + 2 * c29) / (2 - 2 * c29)) / 30, 1e-12, "fixed ends lack the shortest wave")

-- in any units: c = 3e8 (L is all potential to round-off), 1e-12; of two fields the fast one
for _, c in ipairs { 3e8, 1e-12 } do
  local light = dm.field { x = { 0, 1, 24, periodic = true }, L = function(_, ut, ux) return (ut ^ 2 - c ^ 2 * ux ^ 2) / 2 end }
  near(light:stability_limit() * c * 24, 1, 1e-12, ("waves of speed %g"):format(c))
  local run = light:solver { h = 1 / (48 * c) }:run { u = function(x) return cos(2 * pi * x) end, steps = 48 }
  near(run.u[49][1], standing("cell(gauss(2))", 24, 1, 0.5, 48).u[49][1], 1e-12, ("and a run of %g"):format(c))
end
local both = dm.field { x = { 0, 1, 24, periodic = true }, values = 2, L = function(_, ut, ux) return (ut:dot(ut) - 1e16 * ux[1] ^ 2 - ux[2] ^ 2) / 2 end }
near(both:stability_limit() * 24e8, 1, 1e-12, "two speeds")
raises("of both signs", function() dm.field { x = { 0, 1, 24, periodic = true }, values = 2, L = function(_, ut, ux) return ut[1] ^ 2 - ux[1] ^ 2 - ut[2] ^ 2 + ux[2] ^ 2 end }:stability_limit() end)

---- kinks ----

local g = 1 / math.sqrt(0.75)
local function kink(M, v)
  return dm.field { x = { -15, 15, M }, fixed = "ends", L = sine_gordon }:solver { h = 15 / M }:run { t = 10,
    u = function(x) return 4 * math.atan(exp(g * x)) end, ut = function(x) return -2 * v * g / dm.cosh(g * x) end }
end
for M, figure in pairs { [60] = 0.0204644733882, [120] = 0.00453877564388, [240] = 0.00108783 } do
  local path = kink(M, 0.5)
  local worst = 0
  for i = 1, M + 1 do worst = math.max(worst, math.abs(path.u[#path][i] - 4 * math.atan(exp(g * (path.nodes[i] - 5))))) end
  near(worst, figure, 6e-9, ("a kink after 10 units of time on %d cells"):format(M))
end
-- two kinks by Gauss's rules of 2 and of 6 points: order 2 either way, the same field to the order
local a = dm.field { x = { -15, 15, 120 }, fixed = "ends", L = sine_gordon }:solver { rule = "cell(gauss(6))", h = 0.125 }:run { t = 10,
  u = function(x) return 4 * math.atan(exp(g * x)) end, ut = function(x) return -g / dm.cosh(g * x) end }
ok(largest(a.u[#a] - kink(120, 0.5).u[81]) < 1e-3, "six points a direction differ by less than the error")

---- ends ----

local bump = function(x) return exp(-200 * (x - 0.5) ^ 2) end
local out = dm.field { x = { 0, 1, 200 }, absorbing = "ends", L = linear }:solver { h = 1 / 400 }:run { u = bump, ut = zero, t = 1.5, every = 600 }
ok(largest(out.u[#out]) < 8e-4, "absorbing ends let a wave out", largest(out.u[#out]))
ok(#out == 2 and out.t[2] == 1.5, "the first row and the last")
local half = dm.field { x = { 0, 1, 200 }, absorbing = { left = 3, right = 1 / 3 }, L = linear }
local echo = half:reflection()
local function told(c, Z) return tostring(dm.field { x = { 0, 1, 10 }, absorbing = c, L = function(_, ut, ux) return (ut ^ 2 - Z ^ 2 * ux ^ 2) / 2 end }) end
ok(told("ends", 2):find("absorbing (c = 1, 0.33 of a wave comes back) ends", 1, true), "a field says that its ends reflect", told("ends", 2))
ok(told(2, 2):find("absorbing (c = 2) ends", 1, true), "not of ends that fit", told(2, 2))
near(echo.left, -0.5, 1e-14, "c = 3 against an impedance of 1 reflects -1/2")
near(echo.right, 0.5, 1e-14, "c = 1/3: 1/2")
local back = half:solver { h = 1 / 400 }:run { u = bump, ut = zero, t = 1, every = 400 }
near(back.u[2][101], 0, 2e-3, "two echoes of opposite sign meet in the middle") -- (-1/2 + 1/2)/2
local natural = dm.field { x = { 0, 1, 100 }, L = linear }:solver { h = 1 / 200 }:run { u = bump, ut = zero, t = 1, every = 200 }
near(natural.u[2][51], 1, 5e-3, "free ends send all back, upright")
local held = dm.field { x = { 0, 1, 100 }, fixed = "ends", L = linear }:solver { h = 1 / 200 }:run { u = bump, ut = zero, t = 1, every = 200 }
near(held.u[2][51], -1, 5e-3, "fixed ones upside down")
local mixed = dm.field { x = { 0, 1, 100 }, fixed = "left", L = linear }:solver { h = 1 / 200 }:run { u = bump, ut = zero, t = 2, every = 400 }
near(mixed.u[2][51], -1, 2e-2, "one of each: upside down after two crossings")

---- momenta, energy, rows ----

local flat = dm.field { x = { 0, 2, 4 }, L = linear }:solver { h = 0.1 }:run { u = 0, ut = 3, steps = 5 }
near(flat.p[1]:sum(), 6, 1e-14, "p_i = integral of L_ut phi_i")
near(flat.p[1][1], 0.75, 1e-14, "half a hat at an end")
near(flat.u[6][3], 1.5, 1e-13, "it moves on")
near(flat.energy[1], 9, 1e-13, "energy of the first slab")
ok(flat:drift("energy").largest < 1e-13 and flat:column("u3")[6] == flat.u[6][3], "columns")
local wave = dm.field { x = { 0, 1, 20, periodic = true }, L = linear }:solver { h = 0.02 }
local every = wave:run { u = bump, ut = zero, steps = 50 }
local sparse = wave:run { u = bump, ut = zero, steps = 50, every = 8 }
ok(#sparse == 8 and sparse.u[8] == every.u[51] and sparse.energy[3] == every.energy[17], "fewer rows, the same numbers")
local rest = wave:run { u = every.u[31], p = every.p[31], t0 = every.t[31], steps = 20 }
near(largest(rest.u[21] - every.u[51]), 0, 1e-13, "a level and its momenta go on")
local zero_steps = wave:run { u = bump, ut = zero, steps = 0 }
ok(#zero_steps == 1 and zero_steps.energy[1] == every.energy[1], "no step: the start, with its energy")
local reversed = wave:run { u = every.u[51], p = -every.p[51], steps = 50 }
near(largest(reversed.u[51] - every.u[1]), 0, 1e-12, "and back again")

-- L in other units: the same field, to the bit where the unit is a power of two
for _, free in ipairs { "none", "x", "t" } do
  local function scaled(c)
    return dm.field { x = { 0, 1, 6 }, fixed = "ends", L = function(u, ut, ux) return c * (ut ^ 2 - ux ^ 2 - u ^ 4) end }
      :solver { h = 0.05, free = free ~= "none" and free or nil }:run { u = function(x) return sin(3 * x) end, ut = 1, steps = 4 }
  end
  local one = scaled(1).u
  ok(scaled(2.0 ^ 100).u == one and scaled(2.0 ^ -100).u == one, "L in units of 2^100 and 2^-100, free = " .. free)
end

---- several values, explicit x and t, first order in time ----

-- u1'' = u1_xx, u2 a travelling wave in a medium of speed 2: uncoupled values do not touch each other
local pair = dm.field { x = { 0, 1, 20, periodic = true }, values = 2, L = function(_, ut, ux)
  return (ut[1] ^ 2 - ux[1] ^ 2) / 2 + (ut[2] ^ 2 - 4 * ux[2] ^ 2) / 2
end }:solver { h = 0.02 }:run { u = function(x) return { bump(x), sin(2 * pi * x) } end, ut = function() return { 0, 0 } end, steps = 50 }
local alone = 0
for i = 1, 20 do alone = math.max(alone, math.abs(pair.u[51][2 * i - 1] - every.u[51][i])) end
near(alone, 0, 1e-13, "the first of two values is the field of its own")
-- L = (1 + x) ut^2/2: ut constant; L = ut^2/2 + t^2 u: u = t^4/12, at the levels exactly where the load is
local ramp = dm.field { x = { 0, 1, 10 }, L = function(_, ut, _, x) return (1 + x) * ut ^ 2 / 2 end }:solver { h = 0.1 }:run { u = 0, ut = 2, steps = 10 }
near(largest(ramp.u[11] - dm.vector { 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2 }), 0, 1e-13, "explicit x")
near(ramp.p[1]:sum(), 3, 1e-13, "in the momenta, too")
local driven = dm.field { x = { 0, 1, 5 }, L = function(u, ut, _, _, t) return ut ^ 2 / 2 + t ^ 2 * u end }
  :solver { h = 0.1 }:run { u = 0, ut = 0, t = 1 }
near(driven.u[11][2], 1 / 12, 1e-14, "explicit t")
near(driven.energy[11] - driven.energy[2], driven.energy[11] - driven.energy[1], 0, "the first two rows have the energy of the first slab")
-- first order in time: i psi_t = -psi_xx/2, psi = a + i b, from L = a_t b - ... ; a plane wave turns, its norm stays
local function schroedinger(u, ut, ux) return (ut[1] * u[2] - ut[2] * u[1]) / 2 - ux:dot(ux) / 4 end
local plane = dm.field { x = { 0, 2 * pi, 41, periodic = true }, values = 2, L = schroedinger }:solver { rule = "cell(gauss(1))", h = 0.05 }
  :run { u = function(x) return { cos(x), sin(x) } end, t = 2 }
local last = plane.u[#plane]
near(last[1] ^ 2 + last[2] ^ 2, 1, 1e-12, "a plane wave of first order in time keeps its size")
near(math.atan(last[2], last[1]), -1, 5e-3, "and turns by -k^2 t/2") -- exp(i (x - t/2)) at x = 0, t = 2

---- free heights ----

local free = dm.field { x = { 0, 20, 40 }, L = sine_gordon }:solver { h = 0.125, free = "t" }:run { steps = 61,
  u = function(x) return exp(-(x - 10) ^ 2 / 4) end, ut = function(x) return (x - 10) / 2 * exp(-(x - 10) ^ 2 / 4) end }
ok(free:drift("energy").largest < 1e-12, "free heights: the energy of all slabs is that of the first")
near(free.t[62], 8.753391394314509, 1e-8, "and where they are")
-- an oscillator by one point a cell is the midpoint rule, whose E_d is an invariant of its step: h stays
local steady = dm.field { x = { 0, 1, 3, periodic = true }, L = function(u, ut) return (ut ^ 2 - u ^ 2) / 2 end }:solver { rule = "cell(gauss(1))", h = 0.1, free = "t" }
  :run { u = 1, ut = 0.3, steps = 30 }
near(steady.t[31], 3, 1e-9, "an oscillator keeps its height")

-- L with t has a limit at a time: that of waves of speed sqrt(1 + t)
local faster = dm.field { x = { 0, 1, 16 }, L = function(_, ut, ux, _, t) return (ut ^ 2 - (1 + t) * ux ^ 2) / 2 end }
near(faster:stability_limit(nil, { t = 3 }), faster:stability_limit(nil, { t = 0 }) / 2, 1e-12, "the limit at t = 3")
raises("give { t = }", function() faster:stability_limit() end)
tap.done()
