-- waves against closed forms: spectra, plane waves, packets, solitons, invariants
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local pi, cos, sin, exp, sqrt = math.pi, math.cos, math.sin, math.exp, math.sqrt

---- spectra ----

local function harmonic(x) return x ^ 2 / 2 end
for name, given in pairs { ring = {}, walls = { boundary = "walls" } } do
  local wave = dm.schroedinger { x = { -10, 10, 80 }, V = harmonic, boundary = given.boundary }
  local e, worst = wave:eigen(5), 0
  for k = 1, 5 do worst = math.max(worst, math.abs(e.values[k] - (k - 0.5))) end
  ok(worst < 1e-11, "levels of the oscillator, " .. name, worst)
  near((e.psi[2]:dot(e.psi[4])), 0, given.boundary and 1e-8 or 1e-12, "  states are orthogonal")
  local x0 = e.psi[1].x[41]
  near(math.abs(e.psi[1].re[41]), pi ^ -0.25 * exp(-x0 ^ 2 / 2), 1e-12, "  the ground state")
  near(wave:observe(e.psi[3]).energy, 2.5, 1e-11, "  its energy as observed")
end
local levels = dm.schroedinger({ x = { 0, pi, 32 }, boundary = "walls", hbar = 0.5, m = 2 }):eigen(6).values
local worst = 0
for k = 1, 6 do worst = math.max(worst, math.abs(levels[k] - k ^ 2 / 16)) end
ok(worst < 1e-12, "a box: hbar^2 k^2/2m", worst)
for n = 5, 8 do -- psi = x - x^3 is a polynomial: its square is integrated exactly, also where that has the degree n + 1
  local seen = dm.schroedinger({ x = { -1, 1, n }, boundary = "walls" }):observe(function(x) return x - x ^ 3 end)
  near(seen.norm, 16 / 105, 1e-15, "norm of a polynomial between walls, " .. n .. " points")
  near(seen.energy, 4 / 5, 1e-14, "  and its energy")
  local bow = dm.schroedinger({ x = { -1, 1, n }, boundary = "walls" }):solver({ rule = "gauss(2)", h = 0.1 })
    :run({ psi = function(x) return 1 - x ^ 2 end, steps = 1 }).psi[1]
  near((bow:dot(bow)), 16 / 15, 1e-15, "  a product of vectors, of degree n - 1 where n is 5")
end
for _, space in ipairs { "collocation", "galerkin" } do -- Mathieu: V0 + a_0(4 V0)/8, V0 = 3
  local values = dm.schroedinger({ x = { 0, 2 * pi, 24 }, V = function(x) return 3 + 3 * cos(x) end,
    space = space }):eigen(2).values
  near(values[1], 0.833491745631384, 1e-12, "Mathieu's first on 24 points, " .. space)
end

-- Leok's matrix by its definition: integrals on a fine grid between the functions of the space
local N, fine = 8, 64
local function V(x) return 1 + cos(x) + 0.3 * sin(2 * x) - 0.2 * cos(3 * x) + 0.4 * cos(4 * x) end
local function mode(k, x) -- orthonormal, real
  if k == 0 then return 1 / sqrt(2 * pi) end
  if k == N / 2 then return cos(k * x) / sqrt(pi) end
  return (k > 0 and cos(k * x) or sin(-k * x)) / sqrt(pi)
end
local function form(k, l)
  local sum = 0
  for j = 1, fine do
    local x = 2 * pi * j / fine
    sum = sum + mode(k, x) * V(x) * mode(l, x) * 2 * pi / fine
  end
  return sum + (k == l and k ^ 2 / 2 or 0)
end
local rows = {}
for i = 1, N do
  rows[i] = {}
  for j = 1, N do rows[i][j] = form(i - N / 2, j - N / 2) end
end
local told = dm.schroedinger({ x = { 0, 2 * pi, N }, V = V, space = "galerkin" }):eigen(N).values
local found = dm.matrix(rows):eigenvalues()
table.sort(found, function(a, b) return a < b end)
worst = 0
for k = 1, N do worst = math.max(worst, math.abs(told[k] - found[k])) end
ok(worst < 1e-12, "Leok's space: all eigenvalues are those of exact integrals", worst)

---- plane waves and packets ----

local hbar, m = 0.7, 1.3
local ring = dm.schroedinger { x = { 1, 1 + 2 * pi, 16 }, hbar = hbar, m = m, V = 0.4 }
local function plane(x) return cos(3 * x), sin(3 * x) end
local energy = hbar ^ 2 * 9 / (2 * m) + 0.4
for _, rule in ipairs { "strang", "kahan-li(8)", "slab" } do
  local w = ring:solver({ rule = rule, h = 0.2 }):run { psi = plane, steps = 10 }.psi[11]
  local f = 3 * w.x[5] - energy * 2 / hbar
  ok(math.abs(w.re[5] - cos(f)) + math.abs(w.im[5] - sin(f)) < 1e-13, rule .. ": a plane wave, hbar and m", w.re[5])
end
local j, density = ring:current(plane)
ok(math.abs(j[7] - 3 * hbar / m) < 1e-13 and math.abs(density[7] - 1) < 1e-14, "its current, hbar k/m", j[7])
near(ring:observe(plane).momentum, 3 * hbar, 1e-13, "its momentum")

-- density_t + j_x = 0, by central differences in time
local wave = dm.schroedinger { x = { -8, 8, 64 }, V = function(x) return x ^ 2 / 3 end, g = 0.8 }
local function packet(x) local a = exp(-x ^ 2) return a * cos(x), a * sin(x) end
local path = wave:solver({ rule = "kahan-li(8)", h = 2e-4 }):run { psi = packet, steps = 2 }
local before, now, after = path.psi[1]:abs2(), path.psi[2], path.psi[3]:abs2()
local current = wave:current(now)
local slope = wave:equation():slope(current, dm.zeros(64))
worst = ((after - before) / 4e-4 + slope):norm()
ok(worst < 2e-6, "continuity of the density", worst)

---- what is kept ----

for _, rule in ipairs { "gauss(1)", "gauss(3)", "crank-nicolson", "slab(6)" } do
  for _, boundary in ipairs { "periodic", "walls" } do
    local box = dm.schroedinger { x = { -9, 9, 48 }, V = harmonic, boundary = boundary }
    local p = box:solver({ rule = rule, h = 0.05 }):run { psi = function(x) return exp(-(x - 1) ^ 2 / 2), 0 end, steps = 1000, every = 100 }
    local norm, e = p:drift("norm").largest, p:drift("energy").largest
    ok(norm < 1e-12 and e < 1e-12, ("%s, %s: norm and energy over 1000 steps"):format(rule, boundary), norm + e)
  end
end
for _, g in ipairs { -1, 2 } do
  local nls = dm.schroedinger { x = { -9, 9, 64 }, V = harmonic, g = g }
  for _, rule in ipairs { "strang", "yoshida(4)", "gauss(2)" } do
    local p = nls:solver({ rule = rule, h = 0.02 }):run { psi = packet, steps = 1000, every = 100 }
    ok(p:drift("norm").largest < 1e-12, ("%s, g = %d: norm"):format(rule, g), p:drift("norm").largest)
  end
end

-- a bright and a dark soliton, i psi_t = -psi_xx/2 + g |psi|^2 psi
local dark = dm.schroedinger { x = { -20, 20, 256 }, V = 0, g = 1 }
local function tanhs(x, t) -- two of them, so that the ring closes
  local y = (math.abs(x) - 10)
  local a = (exp(2 * y) - 1) / (exp(2 * y) + 1)
  return a * cos(t), -a * sin(t)
end
local p = dark:solver({ rule = "yoshida(4)", h = 0.005 }):run { psi = function(x) return tanhs(x, 0) end, steps = 200, every = 200 }
local w = p.psi[2]
worst = 0
for i = 1, 256 do
  local a, b = tanhs(w.x[i], 1)
  worst = math.max(worst, math.abs(w.re[i] - a) + math.abs(w.im[i] - b))
end
ok(worst < 1e-6, "two dark solitons rest", worst)

---- two-step ----

local free = dm.schroedinger { x = { 0, 2 * pi, 16 } }
local function error_of(h)
  local last = free:solver({ rule = "two-step", h = h }):run { psi = function(x) return cos(2 * x), sin(2 * x) end, t = 1 }
  local v = last.psi[#last]
  return math.abs(math.atan(v.im[1], v.re[1]) + 2)
end
-- the start has the local error h^3 of one Crank-Nicolson step, in a mode that hardly moves
local order = math.log(error_of(1 / 50) / error_of(1 / 100)) / math.log(2)
ok(order > 2.9, "two-step: the phase", order)
local function middle(x) return packet(x - math.pi) end
p = free:solver({ rule = "two-step", h = 0.05 }):run { psi = middle, steps = 1000 }
ok(p:drift("noether").largest < 1e-12, "  its Noether quantity", p:drift("noether").largest)
ok(p:drift("norm").largest > 1e-9, "  which is not the norm", p:drift("norm").largest)
p = free:solver({ rule = "two-step", h = 0.05, norm = true }):run { psi = middle, steps = 200 }
ok(p:drift("norm").largest < 1e-12, "  the multiplier keeps the norm", p:drift("norm").largest)
p = free:solver { rule = "two-step", h = 0.06, unstable = true }
local fine, failure = pcall(p.run, p, { psi = middle, steps = 20000, every = 100 })
ok(not fine and failure.code == "not_finite" and #failure.path > 2, "  beyond its limit it grows", failure)
raises("linear", function() wave:solver { rule = "two-step", h = 0.001 } end)

-- half of the states of many points: told by name, with how many there are
tap.raises("wave:eigen: of more than 1200 points fewer states than half of these are found, here at most 1023 (got 1024)",
  function() dm.schroedinger { x = { -4, 4, 2048 }, V = function(x) return x^2 end }:eigen(1024) end)
tap.done()
