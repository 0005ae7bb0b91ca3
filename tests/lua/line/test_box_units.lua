-- boxes in any units: the same field, gauge modes and gains; steps that end at round-off on fine rings
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, pi, abs, max = math.sin, math.cos, math.pi, math.abs, math.max

local M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }
local K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }

-- u_tt = c^2 u_xx, lengths in `metre`, times in `second`: c = metre/second
local function wave(metre, second)
  local solver = dm.multisymplectic { names = { "u", "p", "q" }, M = M, K = K, x = { 0, 2 * pi * metre, 33, periodic = true },
    S = function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / (2 * (metre / second) ^ 2) end }:solver { h = 0.1 * second }
  return solver:run { z = { u = function(x) return sin(x / metre) end, p = function(x) return cos(x / metre) / second end }, steps = 10 }, solver
end

local function off(a, b, unit)
  local most = 0
  for i = 1, #a do most = max(most, abs(a[i] / unit - b[i])) end
  return most
end

local one = wave(1, 1).u[11]
for _, k in ipairs { -12, -6, -3, 3, 6, 12 } do
  local run, solver = wave(1, 10.0 ^ -k)
  ok(#solver.held == 0 and off(run.u[11], one, 1) < 1e-14, ("waves of speed 1e%d: those of speed 1"):format(k))
  ok(off(wave(10.0 ^ -k, 1).u[11], one, 1) < 1e-14, ("lengths of 1e%d"):format(-k))
end

---- KdV: u = a w, w_t + 6 w w_x + w_xxx = 0 ----

local function kdv(a, u, gain)
  local solver = dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = gain, x = { -20, 20, 129, periodic = true },
    M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
    S = function(z) return z[2] ^ 3 / a - z[2] * z[4] + z[3] ^ 2 / 2 end }:solver { h = 0.02 }
  return solver:run { z = { u = function(x) return a * u(x) end }, steps = 10 }, solver
end
local function soliton(x) return 2 / dm.cosh(x) ^ 2 end
local function swell(x) return sin(pi * x / 10) end
local unit, closed = kdv(1, soliton, { "phi" }), kdv(1, swell)
for _, a in ipairs { 1e-15, 1e-9, 1e9, 1e15 } do
  local run, solver = kdv(a, soliton, { "phi" })
  ok(#solver.held == 1 and off(run.u[11], unit.u[11], a) < 1e-12 and abs(run.gain.phi / a - 4) < 1e-10, ("a soliton of height %g"):format(2 * a))
  raises("gains", function() kdv(a, soliton) end)
  ok(off(kdv(a, swell).u[11], closed.u[11], a) < 1e-12, ("a swell of %g gains nothing"):format(a))
end

---- fine rings: what is left of a step is round-off of its terms, u/dx among them ----

local function pendula(N, S)
  return dm.multisymplectic { names = { "u", "p", "q" }, M = M, K = K, x = { 0, 2 * pi, N, periodic = true }, S = S }:solver { h = 0.01 }
    :run { z = { u = function(x) return 3 + 0.1 * sin(x) end, p = 0 }, steps = 30 }
end
for _, N in ipairs { 101, 401, 1001 } do
  ok(#pendula(N, function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 - dm.cos(z[1]) end) == 31, ("sine-Gordon on %d nodes steps"):format(N))
  local run = pendula(N, function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 + z[1] ^ 2 / 2 end)
  local dx, h = 2 * pi / N, 0.01 -- tan^2(w h/2)/h^2 = tan^2(k dx/2)/dx^2 + 1/4 for k = 0 and 1
  local a, b = math.atan(h / 2), math.atan(h * math.sqrt(math.tan(dx / 2) ^ 2 / dx ^ 2 + 0.25))
  local most = 0
  for i = 1, N do most = max(most, abs(run.u[31][i] - 3 * cos(60 * a) - 0.1 * sin((i - 1) * dx) * cos(60 * b))) end
  ok(most < 1e-11, ("Klein-Gordon on %d nodes"):format(N), most)
end

---- a constant that only differences have; the form formula where variations grow ----

local solver = dm.multisymplectic { names = { "u", "p", "q" }, M = M, K = K, x = { 0, 1, 9, periodic = true },
  S = function(z) return z[2] ^ 2 / 2 + z[1] ^ 2 / 2 end }:solver { h = 0.1 }
local rigid = solver:run { z = { u = 1, p = 0 }, steps = 10 } -- u_x = 0, u'' = -u by the midpoint rule
ok(#solver.held == 1 and solver.held[1] == "q" and abs(rigid.u[11][4] - cos(20 * math.atan(0.05))) < 1e-13, "q is held, which nothing but its differences binds")

local grows = dm.multisymplectic { names = { "u", "p", "q" }, M = M, K = K, x = { 0, 1, 31, periodic = true }, -- u_tt = -u_xx
  S = function(z) return z[2] ^ 2 / 2 + z[3] ^ 2 / 2 end }:solver { h = 0.05 }:run { z = { u = 1, p = 0 }, steps = 6 }
local left, terms = grows:balance "multisymplectic"
ok(terms > 1e6 and left < 1e-14 * terms, "of variations that grow the form formula leaves round-off of its terms", left / terms)
tap.done()
