-- make bench: errors of fields, not times: what docs/benchmarks/fields.md has beside the values that are known. Cavity,
-- kink, linear wave, KdV's soliton, Rossby-Haurwitz wave, laws of boxes, asynchronous steps.
local dm = require "dm"

local cos, sin, exp, pi, sqrt = math.cos, math.sin, math.exp, math.pi, math.sqrt
local function row(text, ...) print(("%-50s "):format(text) .. ("%12.6g "):rep(select("#", ...)):format(...)) end
local function wave(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end
local function linear(u, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function sine_gordon(u, ut, ux) return linear(u, ut, ux) - (1 - dm.cos(u)) end

-- the largest distance of the last level from a function
local function distance(run, exact, x0, dx)
  local worst, u = 0, run.u[#run.u]
  for i = 1, #u do worst = math.max(worst, math.abs(u[i] - exact(x0 + dx * (i - 1)))) end
  return worst
end

local function cavity()
  local K, h = dm.mesh { triangle = 8 }, 0.03
  local field = K:field { form = 1, fixed = "boundary", L = wave }
  local modes, limit = field:modes(2, { above = 1 }), field:stability_limit "verlet"
  local first, omega = modes.forms[1], 2 / h * math.asin(h * sqrt(modes.values[1]) / 2)
  local run = field:solver { rule = "verlet", h = h }:run { q = first, v = 0 * first, steps = 2000 }
  local function energy(i)
    local a, b = run:form(i), run:form(i + 1)
    return ((b - a) / h):norm() ^ 2 / 2 + a:d():dot(b:d()) / 2
  end
  local drift, start = 0, energy(1)
  for i = 1, 2000 do drift = math.max(drift, math.abs(energy(i) - start)) end
  print(("%-50s %.10f"):format("cavity, first mode", modes.values[1]))
  row("the mode after 2000 steps, energy, Gauss", (run:form(2001) - cos(omega * 2000 * h) * first):norm(), drift, run:drift "gauss".largest)
  local sizes, random = {}, dm.random(1)
  local any = {}
  for i = 1, K:count(1) do any[i] = 2 * random:uniform(1, i) - 1 end
  local A = K:form(1, any)
  for i, factor in ipairs { 0.999, 1.001 } do
    local good, path = pcall(function()
      return field:solver { rule = "verlet", h = factor * limit }:run { q = A, v = 0 * A, steps = 2000, every = 2000 }
    end)
    sizes[i] = good and path:form(2):norm() / A:norm() or math.huge
  end
  row("in 2000 steps at 0.999, 1.001 of the limit, times", table.unpack(sizes))
end

local function lines()
  local g, errors, forms = 1 / sqrt(0.75), {}, {}
  for i, M in ipairs { 60, 120, 240 } do
    local run = dm.field { x = { -15, 15, M }, fixed = "ends", L = sine_gordon }:solver { h = 15 / M }:run { t = 10,
      u = function(x) return 4 * math.atan(exp(g * x)) end, ut = function(x) return -g / dm.cosh(g * x) end }
    errors[i] = distance(run, function(x) return 4 * math.atan(exp(g * (x - 5))) end, -15, 30 / M)
    forms[i] = run:multisymplectic()
  end
  row("kink, 60, 120, 240 cells", table.unpack(errors))
  row("form formula", table.unpack(forms))
  local circle, sizes = dm.field { x = { 0, 1, 24, periodic = true }, L = linear }, {}
  for i, lambda in ipairs { 1, 1.05 } do
    local good, run = pcall(function()
      return circle:solver { h = lambda / 24 }:run { u = function(x) return cos(2 * pi * x) end, ut = function(x) return 2 * pi * sin(2 * pi * x) end, steps = 240 }
    end)
    sizes[i] = good and distance(run, function(x) return cos(2 * pi * (x - lambda * 10)) end, 0, 1 / 24) or math.huge
  end
  row("linear wave, lambda = 1, 1.05, error", table.unpack(sizes))
end

local function kdv(N, h)
  local field = dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" }, M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } },
    K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } }, x = { -20, 20, N, periodic = true },
    S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end }
  local run = field:solver { h = h }:run { z = { u = function(x) return 2 / dm.cosh(x) ^ 2 end }, t = 1 }
  return distance(run, function(x) return 2 / dm.cosh(x - 4) ^ 2 end, -20, 40 / N)
end

-- Klein-Gordon: (u, p, q) with S = p^2/2 - q^2/2 + W(u)
local function box(N, h, W)
  return dm.multisymplectic { names = { "u", "p", "q" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 + W(z[1]) end, x = { 0, 2 * pi, N, periodic = true } }:solver { h = h }:run {
    z = { u = function(x) return sin(x) + 0.3 * cos(2 * x) end, p = function(x) return cos(x) / 2 end }, t = 2 }
end
local function laws(text, N, h, W)
  local run = box(N, h, W)
  row(text, run:balance "energy", run:balance "momentum", run:balance "multisymplectic")
end

local function flow(level, h)
  local K = dm.mesh { icosphere = level }
  local function exact(t)
    local c, s = cos(0.9 * t), sin(0.9 * t)
    return K:form(0, function(x, y, z)
      local a, b = c * x + s * y, c * y - s * x
      return 2 * z + 6 * z * (a ^ 3 - 3 * a * b ^ 2)
    end)
  end
  local run = K:euler { vorticity = exact(0) }:solver { rule = "midpoint", h = h }:run { t = 2 }
  local last, kept = exact(2), {}
  for i, what in ipairs { "energy", "enstrophy", "circulation" } do kept[i] = run:drift(what).largest / run:drift("energy").mean end
  row(("Rossby-Haurwitz, icosphere %d; its integrals"):format(level), (run:form(#run) - last):norm() / last:norm(), table.unpack(kept))
end

local function asynchronous()
  local K = dm.mesh { triangle = 20 }
  local field = K:field { form = 1, fixed = "boundary", L = wave }
  local A = K:form(1, function(x, y) return { sin(5 * x * y), cos(3 * x) } end)
  local h, steps = 0.25 * field:stability_limit "verlet", {}
  local one = field:solver { rule = "avi", h = h, start = "half" }:run { q = A, v = 0 * A, t = 100 * h }
  local two = field:solver { rule = "verlet", h = h }:run { q = A, v = 0 * A, steps = 100 }
  for i = 1, K:count(2) do steps[i] = h * (0.5 + 0.6180339887498949 * i % 1) end
  local solver = field:solver { rule = "avi", h = steps }
  local run = solver:run { q = A, v = 0 * A, t = 300 * h }
  row("avi, equal steps less Verlet", (one.q[#one] - two.q[#two]):norm())
  row("avi, uneven: events, Gauss", solver:report().events, run:drift "gauss".largest)
end

print "\nerrors of fields"
cavity()
lines()
row("KdV's soliton, 129, 257 cells", kdv(129, 0.02), kdv(257, 0.01))
flow(2, 0.1)
flow(3, 0.05)
flow(4, 0.025)
laws("linear boxes: energy, momentum, multisymplectic", 33, 0.1, function(u) return 2 * u ^ 2 end)
for k = 1, 3 do laws(("sine-Gordon boxes, %d cells"):format(2 ^ (k + 4) + 1), 2 ^ (k + 4) + 1, 0.1 / 2 ^ (k - 1), function(u) return -dm.cos(u) end) end
asynchronous()
