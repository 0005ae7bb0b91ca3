-- one stage, L = T(v) - V(q, t) with constant mass and few coordinates: two iterations written out as one kernel (integ/stage/lanes/one_point.h)
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sqrt, cos, sin, abs, max = math.sqrt, math.cos, math.sin, math.abs, math.max

local models = {
  { "pendulum", 1, function(q, v) return v[1] ^ 2 / 2 + cos(q[1]) end, { 1 }, { 0.3 } },
  { "Kepler", 2, function(q, v) return v:dot(v) / 2 + 1 / q:norm() end, { 0.4, 0 }, { 0, 2 } },
  { "full mass", 2, function(q, v) return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] / 2 + cos(q[1]) + 2 * cos(q[2] - q[1]) end, { 1, 0.5 }, { 0.1, 0.2 } },
  { "term linear in v", 2, function(q, v) return v[1] ^ 2 + v[2] ^ 2 + v[1] * v[2] + 3 * v[1] - 2 * v[2] - q[1] ^ 4 - q[2] ^ 2 * q[1] ^ 2 - q[2] ^ 2 end,
    { 1, 0.5 }, { 0.1, 0.2 }, turns_not = true },
  { "driven", 3, function(q, v, t) return v:dot(v) / 2 - q:dot(q) / 2 - q[1] * q[2] * q[3] + sin(2 * t) * q[1] end, { 0.3, 0.2, 0.1 }, { 0, 0.1, 0.2 }, turns_not = true },
  { "free coordinate, constant force", 3, function(q, v) return v:dot(v) / 2 - 9.81 * q[3] + cos(q[1]) end, { 1, 0, 2 }, { 0, 1, 0 } },
  { "unequal masses", 3, function(q, v) return v[1] ^ 2 + 5 * v[2] ^ 2 + v[3] ^ 2 / 8 + 1 / sqrt(1 + (q[1] - q[2]) ^ 2) - q[3] ^ 2 * (1 + q[1] ^ 2) end, { 1, 0, 0.2 },
    { 0, 0.2, 0 } },
  { "two bodies of a plane", 4, function(q, v)
    return v[1] ^ 2 / 2 + v[2] ^ 2 / 2 + v[3] ^ 2 + v[4] ^ 2 + 1 / sqrt((q[1] - q[3]) ^ 2 + (q[2] - q[4]) ^ 2)
  end, { 1, 0, -0.5, 0 }, { 0, 1, 0, -0.5 } },
}

local function largest(a, b)
  local out = 0
  for i = 1, #a do for k = 1, #a.q[i] do out = max(out, abs(a.q[i][k] - b.q[i][k]), abs(a.p[i][k] - b.p[i][k])) end end
  return out
end

for _, m in ipairs(models) do
  local name, system = m[1], dm.system { Q = dm.R(m[2]), L = m[3] }
  local function run(options)
    local h = options.h or 0.04
    return system:solver({ rule = options.rule or "gauss(1)", h = h, backend = options.backend }):run {
      q = options.q or m[4], v = options.v, p = options.p, steps = options.steps or 400, every = options.every }
  end
  local path = run { v = m[5] }
  local swept = run { v = m[5], rule = "gauss(1, 50)" }
  ok(largest(path, swept) < 2e-12, name .. ": as by 50 sweeps of the fixed point a step", largest(path, swept))
  local tape = run { v = m[5], backend = "tape" }
  ok(largest(path, tape) == 0, name .. ": the same bits by the tape")
  if not m.turns_not then
    local last, p, missed = #path, {}, 0
    for k = 1, m[2] do p[k] = -path.p[last][k] end
    local back = run { q = path.q[last], p = p }
    for k = 1, m[2] do missed = max(missed, abs(back.q[#back][k] - m[4][k])) end
    ok(missed < 1e-12, name .. ": and back", missed)
  end

  -- members apart, so that lanes differ in how they go: far apart some go the long way, alone
  local members, q, v = 11, {}, {}
  for i = 1, members do
    q[i], v[i] = { table.unpack(m[4]) }, m[5]
    q[i][1] = q[i][1] + 0.02 * (i - 1)
  end
  for _, h in ipairs { 0.04, 0.3 } do
    local all = system:solver({ rule = "midpoint", h = h }):ensemble { members = members, q = dm.matrix(q), v = dm.matrix(v), steps = 100 }
    local same = 0
    for i = 1, members do
      local fine, alone = pcall(run, { rule = "midpoint", q = q[i], v = v[i], h = h, steps = 100, every = 100 })
      local equal = fine == (all.status[i] == "ok")
      for k = 1, m[2] do equal = equal and (not fine or all.q[i][k] == alone.q[#alone][k]) end
      if equal then same = same + 1 end
    end
    ok(same == members, ("%s, h = %g: members end as each alone, bit for bit"):format(name, h), same)
  end
end

---- another root than the one of a small step ----

-- the rod of a stiff pendulum swings through its chords near h k^(1/4) = 1, and the pericentre of an orbit is passed in three steps
local stiff = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 5e3 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
for _, c in ipairs { 0.83, 0.9, 0.94, 1.0 } do
  local path, stretch = stiff:solver({ rule = "midpoint", h = c / 10 }):run { q = { sin(1), -cos(1) }, v = { 0, 0 }, steps = 2000 }, 0
  for i = 1, #path do stretch = max(stretch, abs(path.q[i]:norm() - 1)) end
  ok(stretch < 0.014, ("a rod of stiffness 1e4 keeps its length at h = %g"):format(c / 10), stretch)
end
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
for _, h in ipairs { 0.2, 0.215, 0.23 } do
  local path, furthest = kepler:solver({ rule = "midpoint", h = h }):run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 3000 }, 0
  for i = 1, #path do furthest = max(furthest, path.q[i]:norm()) end
  ok(furthest < 1, ("an ellipse of e = 0.6 is not left at h = %g"):format(h), furthest)
end

for _, case in ipairs { { 1, 2.6 }, { 2.2, 2.3 }, { 2.2, 3 }, { 4, 2.6 } } do
  local w, h = case[1], case[2]
  local coupled = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[1] ^ 2 / 2 - w ^ 2 * q[2] ^ 2 / 2 - 0.3 * q[1] ^ 2 * q[2] end }
  local path, furthest = coupled:solver({ rule = "midpoint", h = h }):run { q = { 0.5, 0.3 }, v = { 0, 0.1 }, steps = 1000 }, 0
  for i = 1, #path do furthest = max(furthest, path.q[i]:norm()) end
  ok(furthest < 0.8, ("coupled oscillators, frequencies 1 and %g, stay small at h = %g"):format(w, h), furthest)
end

---- what it rests on ----

local order = {}
for i, steps in ipairs { 50, 100, 200 } do
  local path = kepler:solver({ rule = "gauss(1)", h = 1 / steps }):run { q = { 1, 0 }, v = { 0, 1 }, steps = steps }
  order[i] = abs(path.q[#path][1] - cos(1))
end
tap.near(math.log(order[1] / order[2], 2), 2, 0.01, "order 2 on the circular orbit"); tap.near(math.log(order[2] / order[3], 2), 2, 0.01, "and again")
local path = kepler:solver({ rule = "midpoint", h = 0.05 }):run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 20000, every = 2000 }
local J = path:momentum(dm.SO(2))
for i = 1, #J do ok(abs(J[i] - J[1]) < 2e-14, "angular momentum to round-off", J[i] - J[1]) end
tap.raises("did not converge", function() dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 3 / 3 end })
  :solver({ rule = "midpoint", h = 1.1 }):run { q = { 1 }, v = { 0 }, steps = 1 } end)
tap.done()
