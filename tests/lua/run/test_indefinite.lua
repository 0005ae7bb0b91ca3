-- M = [1 + 0.9 sin(4 y), 2 a; 2 a, -1 - 0.9 cos(3 x)] has one negative value anywhere, det M <= -0.05:
-- no step of it goes over a change of inertia, however far off its end is
local tap = require "tap"
local dm = require "dm"

local a = -0.102089
local system = dm.system { Q = dm.R(2), L = function(q, v)
  return (1 + 0.9 * dm.sin(4 * q[2])) * v[1] ^ 2 / 2 - (1 + 0.9 * dm.cos(3 * q[1])) * v[2] ^ 2 / 2
    + 2 * a * v[1] * v[2] - q[1] ^ 2 / 2 + q[2] ^ 2 / 2
end }
for _, row in ipairs {
  { "gauss(2)", 0.02217615528170469, { -0.93426702044102217, -0.81841848171185894 }, { 0.56198101748013518, 0.36769572346781643 } },
  { "gauss(2)", 0.062001424108223804, { 0.56132972365856126, -0.31370015766419113 }, { -0.080596384446702585, -0.35414388406217789 } },
  { "gauss(2)", 0.11826214030705605, { 0.66567586500079456, 0.37994599755075043 }, { -0.22903801230146609, -0.10647517642947402 } },
  { "gauss(2)", 0.022682172222000883, { -0.35946584000864124, 0.38772993716669024 }, { -0.59261619060012638, -0.050914894068786465 } },
  { "symplectic-euler", 0.020237484198745579, { -0.80216602613997834, 0.35322798072195005 }, { -0.0034971173417667201, -0.4220321678453634 } },
  { "gauss(2)", 0.021936984535551294, { 0.52402933158591525, -0.33121100066998155 }, { -0.076550492790115277, 0.43497885148528015 } },
  { "gauss(2)", 0.065146393264643096, { -0.27716174034058172, -0.36396152711361229 }, { 0.18380935723206659, 0.40394994741139501 } },
} do
  local rule, h, q, v = table.unpack(row)
  local solver = system:solver { rule = rule, h = h }
  local fine, path = pcall(solver.run, solver, { q = q, v = v, steps = 300 })
  tap.ok(fine or path.code ~= "inertia", ("%s, h = %g: its inertia does not change"):format(rule, h), path)
  local members = solver:ensemble { members = 2, q = function() return q end, v = function() return v end, steps = 300 }
  tap.ok(members.status[2] ~= "inertia", "nor that of a member")
end
tap.done()
