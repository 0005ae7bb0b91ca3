-- several radians a step of linear systems: one factorization serves all steps. gauss(s) turns an oscillator by
-- 2 arg P(i omega h), P the numerator of the diagonal Pade approximation of e^z
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

-- the angle of a step of gauss(s)
local function angle(s, x)
  local c, re, im = 1, 0, 0
  for j = 0, s do
    local part = ({ 1, 1, -1, -1 })[j % 4 + 1] * c * x ^ j
    if j % 2 == 0 then re = re + part else im = im + part end
    c = c * (s - j) / ((2 * s - j) * (j + 1))
  end
  return 2 * math.atan(im, re)
end

local STEPS = 300
for s = 2, 8, 2 do
  local k = { 100, 3.7, 1 }
  -- coupled by a mass matrix that is not diagonal: q = A x of oscillators x
  local system = dm.system { Q = dm.R(3), L = function(q, v)
    local a, b = { q[1] - 0.5 * q[2], q[2], q[3] - q[1] }, { v[1] - 0.5 * v[2], v[2], v[3] - v[1] }
    local L = 0
    for i = 1, 3 do L = L + b[i] ^ 2 / 2 - k[i] * a[i] ^ 2 / 2 end
    return L
  end }
  local x, h = { 0.3, -1, 0.7 }, 0.9
  local q1 = x[1] + 0.5 * x[2]
  local run = system:solver { rule = ("gauss(%d)"):format(s), h = h }:run { q = { q1, x[2], x[3] + q1 }, v = { 0, 0, 0 }, steps = STEPS, every = STEPS }
  local q, worst = run.q[2], 0
  local found = { q[1] - 0.5 * q[2], q[2], q[3] - q[1] }
  for i = 1, 3 do worst = math.max(worst, math.abs(found[i] - x[i] * math.cos(STEPS * angle(s, math.sqrt(k[i]) * h)))) end
  ok(worst < 2e-11, ("gauss(%d), %.0f radians a step: the closed form after %d steps"):format(s, 10 * h, STEPS), worst)
end

-- no drift of the energy, of a stiff spring beside a soft one
local stiff = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 5e3 * q[1] ^ 2 - q[2] ^ 2 - 0.5 * q[1] * q[2] + 0.3 * q[1] end }
local path = stiff:solver { rule = "gauss(4)", h = 0.5 }:run { q = { 0.1, 0.2 }, v = { 1, 1 }, steps = 2e4, every = 200 }
local drift = path:drift "energy"
ok(drift.largest < 3e-10, "gauss(4), 50 radians a step: the energy stays", drift.largest)

-- a trap in a magnetic field, L of the general form: z = x + iy turns by omega^2 + 2 b omega = k, each part as an oscillator;
-- yoshida(4) takes steps of two lengths in turn
local b, k = 0.7, 2.3
local trap = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + b * (q[1] * v[2] - q[2] * v[1]) - k / 2 * q:dot(q) end }
local w = { -b + math.sqrt(b ^ 2 + k), -b - math.sqrt(b ^ 2 + k) }
local outer = 1 / (2 - 2 ^ (1 / 3))
local function yoshida(x) return 2 * angle(1, outer * x) + angle(1, (1 - 2 * outer) * x) end
local z0, u0 = { 1, 0.3 }, { 0, 0.4 }   -- z and z' at the start
-- z = A e^(i w1 t) + B e^(i w2 t): i w1 A + i w2 B = z', A + B = z
local A = { (u0[2] - w[2] * z0[1]) / (w[1] - w[2]), (-u0[1] - w[2] * z0[2]) / (w[1] - w[2]) }
local B = { z0[1] - A[1], z0[2] - A[2] }
for _, case in ipairs { { "midpoint", 1 }, { "gauss(2)", 2 }, { "gauss(5)", 5 }, { "yoshida(4, midpoint)", yoshida } } do
  local rule, s = case[1], case[2]
  local h = s == 5 and 4.5 or 1.5
  local turn = type(s) == "function" and s or function(x) return angle(s, x) end
  local solver = trap:solver { rule = rule, h = h }
  local q = solver:run { q = z0, v = u0, steps = STEPS, every = STEPS }.q[2]
  local a1, a2 = STEPS * turn(w[1] * h), STEPS * turn(w[2] * h)
  local x = A[1] * math.cos(a1) - A[2] * math.sin(a1) + B[1] * math.cos(a2) - B[2] * math.sin(a2)
  local y = A[1] * math.sin(a1) + A[2] * math.cos(a1) + B[1] * math.sin(a2) + B[2] * math.cos(a2)
  local off = math.max(math.abs(q[1] - x), math.abs(q[2] - y))
  ok(off < 2e-11, rule .. " in a magnetic field: the closed form", off)
  if s ~= yoshida then ok(solver:report().matrices <= 1, "  one matrix for all steps", solver:report().matrices) end
  local member = solver:ensemble { members = 9, q = function() return z0 end, v = function() return u0 end, steps = STEPS }.q[7]
  ok(member[1] == q[1] and member[2] == q[2], "  and the bits of a member of an ensemble")
end

-- drag beyond the critical one: e^(lambda h) becomes P(lambda h)/P(-lambda h)
local function growth(s, x)
  local c, plus, minus = 1, 0, 0
  for j = 0, s do
    plus, minus = plus + c * x ^ j, minus + c * (-x) ^ j
    c = c * (s - j) / ((2 * s - j) * (j + 1))
  end
  return plus / minus
end
local door = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end, force = function(_, v) return -2.5 * v end }
for _, s in ipairs { 1, 3 } do
  local solver = door:solver { rule = ("gauss(%d)"):format(s), h = 0.8 }
  local q = solver:run { q = { 1 }, v = { 0 }, steps = 20 }.q
  local off = 0
  for i = 1, #q do off = math.max(off, math.abs(q[i][1] - (4 * growth(s, -0.4) ^ (i - 1) - growth(s, -1.6) ^ (i - 1)) / 3)) end
  ok(off < 1e-14 and solver:report().matrices == 1, ("gauss(%d) with drag: the closed form, one matrix"):format(s), off)
end
tap.done()
