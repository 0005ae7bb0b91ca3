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
tap.done()
