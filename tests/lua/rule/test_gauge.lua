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
-- symplectic-energy-momentum steps of eight coordinates, which sweeps find
local function chain(shift)
  return dm.system { Q = dm.R(8), L = function(q, v)
    local sum = v:dot(v) / 2 + 0.3 * v[1] * v[2] + 0.2 * v[5] * v[8]
    for i = 1, 7 do sum = sum - 1 + dm.cos(q[i + 1] - q[i]) end
    return sum - q:dot(q) / 4 + (shift and 0.8 * v[1] - 0.5 * v[6] or 0)
  end }:solver { rule = "sem(1, gauss(1))", h = 0.1 }:run { q = { 0.5, 0, 0.1, 0, -0.2, 0, 0, 0.3 }, v = { 0, 0.1, 0, 0, 0.2, 0, 0.1, 0 }, steps = 40 }
end
local plain, moved = chain(false), chain(true)
ok((plain.q[41] - moved.q[41]):norm() < 1e-9 and math.abs(plain.t[41] - moved.t[41]) < 1e-9, "sem(1, gauss(1)) of eight coordinates",
  (plain.q[41] - moved.q[41]):norm())
tap.done()
