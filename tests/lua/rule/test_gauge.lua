-- a total derivative beside L, d(a . q)/dt, shifts the momenta by a and changes no motion, whatever the mass
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local a, FULL = dm.vector { 0.7, -0.4, 0.3 }, dm.matrix { { 2, 0.5, 0.2 }, { 0.5, 1.5, -0.3 }, { 0.2, -0.3, 1 } }
local DIAGONAL = dm.matrix { { 2, 0, 0 }, { 0, 1.5, 0 }, { 0, 0, 1 } }
local function make(mass, shift, constraint)
  return dm.system { Q = dm.R(3), constraint = constraint, L = function(q, v)
    return v:dot(mass * v) / 2 + 1 / dm.sqrt(q:dot(q) + 0.1) + (shift and a:dot(v) or 0)
  end }
end
local function surface(q) return { q[1] ^ 2 + 2 * q[2] ^ 2 + q[3] ^ 2 - 1 + 0.2 * q[1] * q[3] } end
local function compare(rule, mass, constraint)
  local ends = {}
  for k = 1, 2 do
    local path = make(mass, k == 2, constraint):solver { rule = rule, h = 0.05 }:run {
      q = { 0.6, 0.3, 0 }, v = { 0.2, -0.3, 0.5 }, steps = 60, project = constraint and true or nil }
    ends[k] = { q = path.q[#path], p = path.p[#path], t = path.t[#path] }
  end
  local off = (ends[2].q - ends[1].q):norm() + (ends[2].p - ends[1].p - a):norm() + math.abs(ends[2].t - ends[1].t)
  ok(off < 1e-13, ("%s%s, a %s mass"):format(rule, constraint and " on a surface" or "", mass == FULL and "full" or "diagonal"), off)
end
for _, mass in ipairs { FULL, DIAGONAL } do
  for _, rule in ipairs { "verlet", "symplectic-euler", "midpoint", "trapezoidal", "gauss(2)", "gauss(3, 4)", "lobatto(3)", "galerkin(2, gauss(3))",
    "rk4", "rk8", "kahan-li(8)", "log-hamiltonian(verlet)", "log-hamiltonian(kahan-li(6))" } do
    compare(rule, mass)
  end
  for _, rule in ipairs { "rattle", "shake", "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)", "kahan-li(6, rattle)", "galerkin(2, gauss(3))" } do
    compare(rule, mass, surface)
  end
end
-- symplectic-energy-momentum steps of 8 coordinates, by a kernel, and of 16, by sweeps
local function chain(n, shift)
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = 0.3 * math.cos(3 * i), 0.2 * math.sin(5 * i) end
  return dm.system { Q = dm.R(n), L = function(x, w)
    local sum = w:dot(w) / 2 + 0.3 * w[1] * w[2] + 0.2 * w[5] * w[n]
    for i = 1, n - 1 do sum = sum - 1 + dm.cos(x[i + 1] - x[i]) end
    return sum - x:dot(x) / 4 + (shift and 0.8 * w[1] - 0.5 * w[6] or 0)
  end }:solver { rule = "sem(1, gauss(1))", h = 0.1 }:run { q = q, v = v, steps = 40 }
end
for _, n in ipairs { 8, 16 } do
  local plain, moved = chain(n, false), chain(n, true)
  local off = (plain.q[41] - moved.q[41]):norm() + math.abs(plain.t[41] - moved.t[41])
  ok(off < 1e-10, ("sem(1, gauss(1)) of %d coordinates"):format(n), off)
end
tap.done()
