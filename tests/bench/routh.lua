-- make bench: a step of a reduced system next to one of the unreduced system by the same rule, alone and of a member of an ensemble, and what
-- making the reduced one costs. An argument: only models whose name begins so.
local dm = require "dm"
local sqrt, sin, cos = math.sqrt, math.sin, math.cos

local J2, m1, m2, l1, l2, g = 0.05, 2, 1.5, 1, 0.75, 9.8

local function satellite(q, v)
  local r, z = q[2], q[3]
  local rho = sqrt(r * r + z * z)
  return (v[2] ^ 2 + r * r * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * z * z / rho ^ 2 - 0.5)
end

-- (theta1, r1, r2, phi), both rods hanging
local function pendulum(q, v)
  local r1, r2, phi = q[2], q[3], q[4]
  local t1, t2 = v[1], v[1] + v[4]
  local z1, z2 = -sqrt(l1 ^ 2 - r1 ^ 2), -sqrt(l2 ^ 2 - r2 ^ 2)
  local dz1, dz2 = -r1 * v[2] / z1, -r2 * v[3] / z2
  local c, s = cos(phi), sin(phi)
  local T1 = v[2] ^ 2 + r1 ^ 2 * t1 ^ 2 + dz1 ^ 2
  local T2 = v[2] ^ 2 + r1 ^ 2 * t1 ^ 2 + v[3] ^ 2 + r2 ^ 2 * t2 ^ 2 + 2 * (v[2] * v[3] + r1 * r2 * t1 * t2) * c
    + 2 * (r1 * v[3] * t1 - r2 * v[2] * t2) * s + (dz1 + dz2) ^ 2
  return m1 * T1 / 2 + m2 * T2 / 2 - m1 * g * z1 - m2 * g * (z1 + z2)
end

-- k rotors on one carrier of two coordinates: angles first, so that the group has k dimensions
local function rotors(k)
  return function(q, v)
    local x, y = q[k + 1], q[k + 2]
    local sum = (v[k + 1] ^ 2 + v[k + 2] ^ 2) / 2 - (x * x + 2 * y * y) / 2 - 0.1 * x * x * y
    for a = 1, k do
      local r2 = 1 + (x - 0.3 * a) ^ 2 + y * y
      local rate = v[a] + 0.3 * y * v[k + 1] / a
      if a > 1 then rate = rate - 0.2 * v[a - 1] end
      sum = sum + r2 * rate ^ 2 / 2
    end
    return sum
  end
end

local models = {
  { "J2 satellite, 3 -> 2", satellite, 3, { 1 }, { 0, 1, 0 }, { 0.96, 0, 0.28 }, 0.05 },
  { "double spherical pendulum, 4 -> 3", pendulum, 4, { 1 }, { 0, 0.6, 0.45, 0.6435 }, { 3.5, 0, 0, 0 }, 0.02 },
}
for _, k in ipairs { 1, 2, 4, 6 } do
  local q, v, cyclic = {}, {}, {}
  for a = 1, k do q[a], v[a], cyclic[a] = 0, 0.3, a end
  q[k + 1], q[k + 2], v[k + 1], v[k + 2] = 1, 0.5, 0, 0.3
  models[#models + 1] = { ("%d rotors on a carrier, %d -> 2"):format(k, k + 2), rotors(k), k + 2, cyclic, q, v, 0.05 }
end

local RULES = { "gauss(1)", "gauss(2)", "gauss(3)", "lobatto(3)" }
local STEPS, REPEATS = 2000, 15
local MEMBERS, MEMBER_STEPS, APART = 2048, 200, 1e-2

-- ns a step of a side
local function alone(s)
  return s.solver:run({ q = s.q, v = s.v, steps = STEPS, every = STEPS }).ns_per_step
end

-- and of a member of an ensemble on one core, set-up and start included; members start apart, so that lanes differ in their iterations
local function member(s)
  local q, v, last = {}, {}, #s.q
  for i = 1, MEMBERS do
    q[i], v[i] = { table.unpack(s.q) }, s.v
    q[i][last] = q[i][last] + APART * (i / MEMBERS - 0.5)
  end
  q, v = dm.matrix(q), dm.matrix(v)
  local start = os.clock()
  s.solver:ensemble { members = MEMBERS, q = q, v = v, steps = MEMBER_STEPS, threads = 1 }
  return (os.clock() - start) * 1e9 / (MEMBERS * MEMBER_STEPS)
end

-- best of runs that take turns
local function race(ns, a, b, repeats)
  local best = { math.huge, math.huge }
  for _ = 1, repeats do
    for i, s in ipairs { a, b } do best[i] = math.min(best[i], ns(s)) end
  end
  return best[1], best[2]
end

-- milliseconds of making the reduced system: best of some
local function building(system, options)
  local best = math.huge
  for _ = 1, 7 do
    local start = os.clock()
    system:routh(options)
    best = math.min(best, os.clock() - start)
  end
  return best * 1e3
end

print(("%-36s %-12s %10s %10s %7s %10s %10s %7s %12s"):format("reduced next to unreduced", "rule", "ns/step", "reduced", "ratio",
  "member", "reduced", "ratio", "building, ms"))
local function race_all(m)
  local system = dm.system { Q = dm.R(m[3]), L = m[2] }
  local options = { cyclic = m[4], q = m[5], v = m[6] }
  local shape = system:routh(options)
  local x, u = shape:start(m[5], m[6])
  local ms = building(system, options)
  for _, rule in ipairs(RULES) do
    local full = { solver = system:solver { rule = rule, h = m[7] }, q = m[5], v = m[6] }
    local reduced = { solver = shape:solver { rule = rule, h = m[7] }, q = x, v = u }
    local a, b = race(alone, full, reduced, REPEATS)
    local c, d = race(member, full, reduced, 3)
    print(("%-36s %-12s %10.1f %10.1f %7.2f %10.1f %10.1f %7.2f %12.2f"):format(m[1], rule, a, b, b / a, c, d, d / c, ms))
  end
end
for _, m in ipairs(models) do
  if m[1]:find(arg[1] or "", 1, true) == 1 then race_all(m) end
end
