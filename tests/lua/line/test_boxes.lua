-- boxes: Klein-Gordon, KdV, Schroedinger, Zakharov, sine-Gordon; local laws; what follows; refusals
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, pi, abs = math.sin, math.cos, math.pi, math.abs

local function below(x, bound, what) ok(x < bound, what .. (" (%.2g)"):format(x), x) end
local function worst(run, name, exact)
  local most, u = 0, run[name][#run]
  for i = 1, #u do most = math.max(most, abs(u[i] - exact(run.nodes[i]))) end
  return most
end

---- linear Klein-Gordon: waves turn by the dispersion of the box; laws to round-off ----

local function klein_gordon(N, S)
  return dm.multisymplectic { names = { "u", "p", "q" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = S or function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 + 2 * z[1] ^ 2 end, x = { 0, 2 * pi, N, periodic = true } }
end
-- tan^2(w h/2)/(h/2)^2 = tan^2(k dx/2)/(dx/2)^2 + m^2 with m^2 = 4: u_tt - u_xx + 4 u = 0
local N, h, k = 33, 0.1, 2
local dx = 2 * pi / N
local w = 2 / h * math.atan(h / 2 * math.sqrt((math.tan(k * dx / 2) / (dx / 2)) ^ 2 + 4))
local run = klein_gordon(N):solver { h = h }:run { z = { u = function(x) return cos(k * x) end, p = function() return 0 end }, steps = 40 }
near(worst(run, "u", function(x) return cos(w * 4) * cos(k * x) end), 0, 1e-12, "a standing wave turns by the dispersion of the box")
run = klein_gordon(N):solver { h = h }:run { z = { u = function(x) return sin(x) + 0.3 * cos(2 * x) end, p = function(x) return cos(x) / 2 end }, steps = 40, every = 40 }
near(run.u[2][1], 0.20154226247748, 1e-11, "two waves")
for _, name in ipairs { "energy", "momentum", "multisymplectic" } do below(run:balance(name), 1e-11, "local law: " .. name) end
ok(#run == 2 and run.t[2] == 4 and #run.z[2] == 3 * N, "rows")

---- sine-Gordon: laws of order 2 ----

local laws = {}
for n = 1, 2 do
  local path = klein_gordon(40 * n + 1, function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 - dm.cos(z[1]) end):solver { h = 0.08 / n }
    :run { z = { u = function(x) return sin(x) end, p = function(x) return cos(2 * x) / 2 end }, t = 1.6 }
  laws[n] = { energy = path:balance "energy", momentum = path:balance "momentum" }
  below(path:balance "multisymplectic", 1e-10, "sine-Gordon: multisymplectic to round-off")
end
for _, name in ipairs { "energy", "momentum" } do
  near(math.log(laws[1][name] / laws[2][name]) / math.log(2), 2, 0.25, name .. " of a nonlinear field: order 2")
end

---- KdV: u_t + 6 u u_x + u_xxx = 0 ----

local function kdv(cells)
  return dm.multisymplectic { names = { "phi", "u", "v", "w" }, gain = { "phi" },
    M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } },
    S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end, x = { -20, 20, cells, periodic = true } }
end
local function soliton(x) return 2 / dm.cosh(x) ^ 2 end
for cells, figure in pairs { [129] = 0.165468301862, [257] = 0.0438447 } do
  local solver = kdv(cells):solver { h = cells == 129 and 0.02 or 0.01 }
  local path = solver:run { z = { u = soliton }, t = 1 }
  near(worst(path, "u", function(x) return soliton(x - 4) end), figure, cells == 129 and 1e-9 or 6e-8, ("a soliton on %d cells"):format(cells))
  below(abs(path.u[#path]:sum() - path.u[1]:sum()), 1e-11, "its mass")
  ok(solver.held[1] == "phi" and tostring(solver):find "gauge mode", "phi's gauge mode is held, and said")
  near(path.gain.phi, 4, 1e-10, "phi gains the mass round the ring")
end
local even = kdv(128):solver { h = 0.02 }:run { z = { u = soliton }, t = 1 }
below(worst(even, "u", function(x) return soliton(x - 4) end), 0.18, "KdV steps an even ring")
local mass = kdv(65):solver { h = 0.04 }:run { z = { u = soliton, phi = function(x) return 2 * dm.tanh(x) end }, steps = 5 }
below(abs(mass.u[6]:sum() - mass.u[1]:sum()), 1e-11, "phi may be given: its gain is u's")
local order = {}
for n = 1, 2 do
  local path = kdv(128 * n + 1):solver { h = 0.02 / n }:run { z = { u = soliton }, t = 0.4 }
  order[n] = { path:balance "energy", path:balance "momentum" }
end
for i, name in ipairs { "energy", "momentum" } do near(math.log(order[1][i] / order[2][i]) / math.log(2), 1.85, 0.4, "KdV " .. name .. ": towards order 2") end

---- Schroedinger: i psi_t + psi_xx + 2 |psi|^2 psi = 0, psi = a + i b, v = a_x, w = b_x ----

local function nls(cells)
  return dm.multisymplectic { names = { "a", "b", "v", "w" }, M = { { 0, 1, 0, 0 }, { -1, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } },
    K = { { 0, 0, -1, 0 }, { 0, 0, 0, -1 }, { 1, 0, 0, 0 }, { 0, 1, 0, 0 } }, x = { -10, 10, cells, periodic = true },
    S = function(z) return ((z[1] ^ 2 + z[2] ^ 2) ^ 2 + z[3] ^ 2 + z[4] ^ 2) / 2 end }
end
local errors = {}
for n = 1, 2 do -- psi = sech(x) exp(i t): row 1 b_t - v_x = 2 |psi|^2 a
  local path = nls(80 * n + 1):solver { h = 0.04 / n }:run { z = { a = function(x) return 1 / dm.cosh(x) end, b = function() return 0 end }, t = 1 }
  errors[n] = worst(path, "a", function(x) return cos(1) / dm.cosh(x) end)
  below(path:balance "multisymplectic", 1e-7, "Schroedinger: multisymplectic")
end
near(math.log(errors[1] / errors[2]) / math.log(2), 2, 0.15, "Schroedinger's soliton at order 2")
raises("component 'b' is needed", function() nls(21):solver { h = 0.1 }:run { z = { a = cos }, steps = 1 } end)

---- Zakharov: i E_t + E_xx = n E, n_tt - n_xx = (|E|^2)_xx, E = a + i b, phi_t = n + |E|^2, phi_x = u ----

local function square()
  local m = {}
  for i = 1, 7 do m[i] = { 0, 0, 0, 0, 0, 0, 0 } end
  return m
end
local M, K = square(), square()
M[1][2], M[2][1], M[5][6], M[6][5] = -1, 1, 0.5, -0.5
K[1][3], K[3][1], K[2][4], K[4][2], K[6][7], K[7][6] = 1, -1, 1, -1, 0.5, -0.5
local function sech(x) return 1 / dm.cosh(x) end
for n = 1, 2 do -- at rest: n = -|E|^2, E = sqrt(2) sech(x) exp(i t)
  local path = dm.multisymplectic { M = M, K = K, names = { "a", "b", "v", "w", "n", "phi", "u" }, gain = { "phi" }, x = { -15, 15, 100 * n + 1, periodic = true },
    S = function(z) return z[5] * (z[1] ^ 2 + z[2] ^ 2) / 2 - (z[3] ^ 2 + z[4] ^ 2) / 2 + z[5] ^ 2 / 4 - z[7] ^ 2 / 4 end }:solver { h = 0.05 / n }
    :run { z = { a = function(x) return math.sqrt(2) * sech(x) end, b = 0, n = function(x) return -2 * sech(x) ^ 2 end, phi = 0 }, t = 1 }
  errors[n] = worst(path, "a", function(x) return math.sqrt(2) * sech(x) * cos(1) end)
  below(path:balance "multisymplectic", 1e-11, "Zakharov: multisymplectic")
end
near(math.log(errors[1] / errors[2]) / math.log(2), 2, 0.1, "Zakharov's soliton at order 2")

---- starts that are given twice: moved onto their rows without z_t, or refused, never left to go to and fro ----

local function start(boxes, h, z) return boxes:solver { h = h }:run { z = z, steps = 6 } end
local plain, exact = start(klein_gordon(33), 0.1, { u = sin, p = cos }), start(klein_gordon(33), 0.1, { u = sin, p = cos, q = cos })
ok(exact.z == plain.z and tostring(exact):find "start of q was moved onto its row", "q = u_x of a formula is moved onto that of the boxes", tostring(exact))
near(exact.moved.q, (pi / 33) ^ 2 / 3, 1e-4, "by (k dx)^2 / 12")
ok(plain.moved.q == nil and start(klein_gordon(33), 0.1, { u = sin, p = cos, q = plain.q[1] }).moved.q == nil, "what satisfies its row stays")
raises("off by 1 from what follows", function() start(klein_gordon(33), 0.1, { u = sin, p = cos, q = 0 }) end)
raises("leave 'q' out", function() start(klein_gordon(33), 0.1, { u = sin, p = cos, q = function(x) return -cos(x) end }) end)
raises("leaves a constant open", function() start(klein_gordon(33), 0.1, { q = cos, p = cos }) end)
local function tanh2(x) return 2 * dm.tanh(x) end
for _, cells in ipairs { 64, 65 } do
  local free, phi = start(kdv(cells), 0.02, { u = soliton }), start(kdv(cells), 0.02, { u = soliton, phi = tanh2 })
  local nodes = {}
  for i = 1, cells do nodes[i] = tanh2(free.nodes[i]) end
  local list = start(kdv(cells), 0.02, { u = soliton, phi = nodes })
  below((phi.u[7] - free.u[7]):norm(), 1e-10, "phi and u given: phi is moved, u is not")
  below((list.phi[7] - phi.phi[7]):norm(), 1e-9, "a list of what gains is its values at the nodes")
  near(phi.phi[1]:sum(), dm.vector(nodes):sum() , 1e-9, "and keeps its mean")
  raises("leave 'phi' out", function() start(kdv(cells), 0.02, { u = soliton, phi = 0 }) end)
  raises("'v' of the start", function() start(kdv(cells), 0.02, { u = soliton, v = 0 }) end)
  raises("would go to and fro", function() start(kdv(cells), 0.02, { u = soliton, w = 0 }) end)
  -- w, which only two steps tell: u_t/2 + w_x = 0, so w = c u / 2 on a soliton of the speed c = 4
  local w = start(kdv(8 * cells), 0.002, { u = soliton })
  near(worst({ { 1 }, w = { w.w[1] }, nodes = w.nodes }, "w", function(x) return 2 * soliton(x) end), 0, 0.02, "what two steps tell is its value at the start")
  below((start(kdv(8 * cells), 0.002, { u = soliton, w = function(x) return 2 * soliton(x) end }).u[7] - w.u[7]):norm(), 1e-10, "and no other component depends on it")
end

---- Camassa-Holm (Cohen, Owren, Raynaud 2008): a bond of two rows, three components that follow, two that only steps tell ----

local values = {}
for k = 0, 1 do
  local N = 32 * 2 ^ k + 1
  local path = dm.multisymplectic { names = { "u", "phi", "w", "v", "nu" }, gain = { "phi" }, x = { 0, 2 * pi, N, periodic = true },
    M = { { 0, 0.5, 0, 0, -0.5 }, { -0.5, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, { 0.5, 0, 0, 0, 0 } },
    K = { { 0, 0, 0, -1, 0 }, { 0, 0, 1, 0, 0 }, { 0, -1, 0, 0, 0 }, { 1, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 } },
    S = function(z) return -z[3] * z[1] - z[1] ^ 3 / 2 - z[1] * z[5] ^ 2 / 2 + z[5] * z[4] end }:solver { h = 1.65 / N }
    :run { z = { u = function(x) return 1 + 0.3 * cos(x) end }, steps = 10 * 2 ^ k }
  values[k] = { path.u[#path][1], path:balance "energy" }
  -- u_t = 2 (v - u nu), at the start as later: v does not go to and fro
  near(path.v[1][5] - path.v[2][5], path.v[2][5] - path.v[3][5], 0.1 * abs(path.v[1][5] - path.v[2][5]), "v is smooth from the start on")
  below(path:balance "multisymplectic", 1e-7, "Camassa-Holm: multisymplectic")
  below(abs(path.u[#path]:sum() - path.u[1]:sum()), 1e-11, "its mass")
end
near(values[0][2] / values[1][2], 4, 0.4, "its energy's law: order 2")

---- a basis of its own: M's kernel lies along no component, and starts are solved for in it ----

-- z = Q y with a rotation Q
local function rotated(Mz, Kz, S, Q, N)
  local d = #Q
  local function turned(A)
    local out = {}
    for i = 1, d do
      out[i] = {}
      for j = 1, d do
        local sum = 0
        for r = 1, d do for c = 1, d do sum = sum + Q[r][i] * A[r][c] * Q[c][j] end end
        out[i][j] = i > j and -out[j][i] or i < j and sum or 0
      end
    end
    return out
  end
  return dm.multisymplectic { M = turned(Mz), K = turned(Kz), x = { 0, 2 * pi, N, periodic = true }, S = function(y)
    local z = {}
    for r = 1, d do
      z[r] = 0
      for c = 1, d do z[r] = z[r] + Q[r][c] * y[c] end
    end
    return S(z)
  end }
end
local function turn(d, i, j, angle, Q)
  local out = {}
  for r = 1, d do
    out[r] = {}
    for c = 1, d do out[r][c] = Q and Q[r][c] or r == c and 1 or 0 end
    local a, b = out[r][i], out[r][j]
    out[r][i], out[r][j] = cos(angle) * a - sin(angle) * b, sin(angle) * a + cos(angle) * b
  end
  return out
end
local psi = { cos, function(x) return 0.3 * sin(2 * x) end, function(x) return -sin(x) end, function(x) return 0.6 * cos(2 * x) end }
local Mpsi = { { 0, 1, 0, 0 }, { -1, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }
local Kpsi = { { 0, 0, -1, 0 }, { 0, 0, 0, -1 }, { 1, 0, 0, 0 }, { 0, 1, 0, 0 } }
local function Spsi(z) return (z[3] ^ 2 + z[4] ^ 2) / 2 + (z[1] ^ 2 + z[2] ^ 2) ^ 2 / 4 end
local Q = turn(4, 1, 3, 0.7, turn(4, 2, 4, 1.1, turn(4, 1, 4, 0.4)))
local basis = rotated(Mpsi, Kpsi, Spsi, Q, 33)
local along = dm.multisymplectic { M = Mpsi, K = Kpsi, S = Spsi, x = { 0, 2 * pi, 33, periodic = true } }
local z = {}
for c = 1, 4 do
  z["z" .. c] = function(x)
    local sum = 0
    for r = 1, 4 do sum = sum + Q[r][c] * psi[r](x) end
    return sum
  end
end
local plain = along:solver { h = 0.02 }:run { z = { z1 = psi[1], z2 = psi[2] }, steps = 20 }
local other = basis:solver { h = 0.02 }:run { z = z, steps = 20 }
local apart = 0
for i = 1, 33 do
  local sum = 0
  for c = 1, 4 do sum = sum + Q[1][c] * other["z" .. c][21][i] end
  apart = math.max(apart, abs(sum - plain.z1[21][i]))
end
below(apart, 1e-13, "the run of another basis")
ok(next(other.moved) ~= nil, "samples are moved along the kernel, and told")
-- KdV with v and w turned about each other: of both of them rows without z_t tell one alone
local Mkdv, Kkdv = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } }, { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } }
local mixed = rotated(Mkdv, Kkdv, function(x) return x[2] ^ 3 - x[2] * x[4] + x[3] ^ 2 / 2 end, turn(4, 3, 4, 0.6), 65)
local function wave(x) return 0.3 * cos(x) end
raises("to and fro; leave 'z3' out", function() mixed:solver { h = 0.02 }:run { z = { z2 = wave, z3 = sin, z4 = wave }, steps = 1 } end)
raises("give 1 more", function() basis:solver { h = 0.02 }:run { z = { z1 = z.z1 }, steps = 1 } end)
raises("does not satisfy the rows without z_t", function() basis:solver { h = 0.02 }:run { z = { z1 = cos, z2 = cos, z3 = function(x) return sin(9 * x) end, z4 = sin }, steps = 1 } end)
-- what is left out follows: rows of u alone, with p and q along (0, 1, 1)
local leaning = dm.multisymplectic { names = { "u", "p", "q" }, M = { { 0, -1, 1 }, { 1, 0, 0 }, { -1, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
  S = function(y) return y[2] ^ 2 / 2 - y[3] ^ 2 / 2 + y[1] ^ 2 end, x = { 0, 2 * pi, 33, periodic = true } }
other = leaning:solver { h = 0.05 }:run { z = { u = sin, p = cos }, steps = 20 }
local bond = 0 -- rows 2 + 3: -u_x = p - q
for i = 1, 33 do
  local k = i % 33 + 1
  local u, p, q = other.u[1], other.p[1], other.q[1]
  bond = math.max(bond, abs(-(u[k] - u[i]) / leaning.dx - (p[i] + p[k] - q[i] - q[k]) / 2))
end
below(bond, 1e-13, "the start satisfies the bond")
below(other:balance "energy", 1e-11, "a quadratic S: its law to round-off")

---- refusals ----

raises("even", function() klein_gordon(32):solver { h = 0.1 } end)
raises("take 33 cells", function() klein_gordon(32):solver { h = 0.1 } end)
raises("antisymmetric", function() dm.multisymplectic { M = { { 1 } }, K = { { 0 } }, S = function(z) return z[1] end, x = { 0, 1, 5, periodic = true } } end)
raises("boxes stand on a ring", function()
  dm.multisymplectic { M = { { 0, 1 }, { -1, 0 } }, K = { { 0, 1 }, { -1, 0 } }, S = function(z) return z[1] ^ 2 end, x = { 0, 1, 5 } } end)
raises("a run has a field of that name", function()
  dm.multisymplectic { names = { "t", "p" }, M = { { 0, 1 }, { -1, 0 } }, K = { { 0, 1 }, { -1, 0 } }, S = function(z) return z[1] ^ 2 end, x = { 0, 1, 5, periodic = true } } end)
raises("but S depends on it", function()
  dm.multisymplectic { names = { "a", "b" }, gain = { "a" }, M = { { 0, 1 }, { -1, 0 } }, K = { { 0, 1 }, { -1, 0 } }, S = function(z) return z[1] ^ 2 end, x = { 0, 1, 5, periodic = true } } end)
raises("there is no component \"c\"", function() klein_gordon(33):solver { h = 0.1 }:run { z = { u = sin, p = cos, c = cos }, steps = 1 } end)
raises("component 'p' is needed", function() klein_gordon(33):solver { h = 0.1 }:run { z = { u = sin }, steps = 1 } end)
raises("takes \"energy\"", function() run:balance "mass" end)
raises("give one of 't' and 'steps'", function() klein_gordon(33):solver { h = 0.1 }:run { z = { u = sin, p = cos }, steps = 1, t = 1 } end)
raises("must be finite", function() klein_gordon(33):solver { h = 0.1 }:run { z = { u = function() return 0 / 0 end, p = cos }, steps = 1 } end)
local no_gain = function()
  return dm.multisymplectic { names = { "phi", "u", "v", "w" }, M = { { 0, 0.5, 0, 0 }, { -0.5, 0, 0, 0 }, { 0, 0, 0, 0 }, { 0, 0, 0, 0 } },
    K = { { 0, 0, 0, 1 }, { 0, 0, -1, 0 }, { 0, 1, 0, 0 }, { -1, 0, 0, 0 } }, S = function(z) return z[2] ^ 3 - z[2] * z[4] + z[3] ^ 2 / 2 end,
    x = { -20, 20, 33, periodic = true } }:solver { h = 0.02 }:run { z = { u = soliton }, steps = 1 }
end
raises("gain = { \"phi\" }", no_gain)
raises("inside of the domain of S", function()
  dm.multisymplectic { names = { "u", "p", "q" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
    S = function(y) return y[2] ^ 2 / 2 - y[3] ^ 2 / 2 + dm.log(y[1]) end, x = { 0, 2 * pi, 33, periodic = true } }:solver { h = 0.1 }:run { z = { u = sin, p = cos }, steps = 1 }
end)

-- S of components by their names has the bits of S of a vector
local function sine_gordon(S)
  return dm.multisymplectic { names = { "u", "v", "w" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
    K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, x = { 0, 2 * pi, 21, periodic = true }, S = S }
end
local kick = { z = { u = sin, v = cos }, steps = 4 }
local by_name = sine_gordon(function(z) return 1 - dm.cos(z.u) + z.v ^ 2 / 2 - z.w ^ 2 / 2 end):solver { h = 0.1 }:run(kick)
local by_number = sine_gordon(function(z) return 1 - dm.cos(z[1]) + z[2] ^ 2 / 2 - z[3] ^ 2 / 2 end):solver { h = 0.1 }:run(kick)
ok(by_name.z == by_number.z and by_name:balance "energy" == by_number:balance "energy", "S of z.u, z.v, z.w")
raises("number expected", function() sine_gordon(function(z) return math.cos(z.nobody) end) end)
-- gain is a list: what is none was nothing at all
for _, gain in ipairs { 3, "u", { u = true }, true } do
  raises("option 'gain' must list names", function()
    dm.multisymplectic { names = { "u", "p", "q" }, gain = gain, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
      K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, S = function(z) return z[2] ^ 2 / 2 end, x = { 0, 1, 9, periodic = true } }
  end)
end
tap.done()
