-- members whose mass moves with q and touches zero, or passes through it: looked at side by side they
-- end where runs of their own end, and have their states
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sin, cos = math.sin, math.cos
local MEMBERS, STEPS = 21, 150

local function rod(a, b, da, db)
  return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
end
-- name, dimension, T
local models = {
  { "touched, one coordinate", 1, function(q, v) return (q[1] - 0.2) ^ 2 * v[1] ^ 2 / 2 end },
  { "passed", 1, function(q, v) return (cos(q[1]) - 0.6) * v[1] ^ 2 / 2 end },
  { "polar coordinates", 2, function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 end },
  { "rotating, one mass touched", 3, function(q, v)
    return (v[1] ^ 2 + v[3] ^ 2 + (q[1] + 0.7 * q[3]) ^ 2 * v[2] ^ 2) / 2 + 0.3 * v[1] * v[3] end },
  { "double spherical pendulum", 4, function(q, v)
    local x1, y1, z1 = rod(q[1], q[2], v[1], v[2])
    local x2, y2, z2 = rod(q[3], q[4], v[3], v[4])
    return (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2 end },
  { "of five coordinates, indefinite somewhere", 5, function(q, v)
    return v:dot(v) / 2 + 0.9 * (q[1] * v[1] * v[2] + sin(q[2]) * v[3] * v[4] + q[3] * v[5] * v[1]) end },
  { "of time", 1, function(q, v, t) return (1.2 + sin(t) * cos(q[1])) * v[1] ^ 2 / 2 end, true },
}
-- of the ten thousandth parts of k^2 times irrational numbers
local function numbers(n, i, size)
  local out = {}
  for k = 1, n do out[k] = size * (2 * ((i * 0.6180339887 + k * k * 0.4142135623) % 1) - 1) end
  return out
end

for _, model in ipairs(models) do
  local name, n, T, timed = table.unpack(model)
  local function V(q) return q:dot(q) / 2 + 0.3 * q[1] + 0.1 * cos(q[n]) end
  local system = dm.system { Q = dm.R(n), L = timed and function(q, v, t) return T(q, v, t) - V(q) end
    or function(q, v) return T(q, v) - V(q) end }
  for _, rule in ipairs { "midpoint", "gauss(2)" } do
    local solver = system:solver { rule = rule, h = 0.03 }
    local q = dm.matrix((function() local m = {} for i = 1, MEMBERS do m[i] = numbers(n, i, 1.5) end return m end)())
    local v = dm.matrix((function() local m = {} for i = 1, MEMBERS do m[i] = numbers(n, 7 * i, 1) end return m end)())
    local e = solver:ensemble { members = MEMBERS, q = q, v = v, steps = STEPS }
    local wrong, ends = nil, 0
    for i = 1, MEMBERS do
      local fine, run = pcall(solver.run, solver, { q = q[i], v = v[i], steps = STEPS, every = STEPS })
      local same = fine == (e.status[i] == "ok")
      for k = 1, fine and n or 0 do same = same and e.q[i][k] == run.q[#run.q][k] and e.p[i][k] == run.p[#run.p][k] end
      ends = ends + (fine and 0 or 1)
      if not same then wrong = wrong or ("member %d: %s, alone %s"):format(i, e.status[i], fine and "ok" or tostring(run)) end
    end
    ok(not wrong, ("%s, %s: members end as they do alone, %d of %d before the last step%s"):format(name, rule, ends,
      MEMBERS, wrong and " (" .. wrong .. ")" or ""))
  end
end

-- starts at a place, next to it, and one step before it: what members are told of them is what runs are
for _, model in ipairs { { "touched", function(x) return x ^ 2 end }, { "passed", function(x) return x end } } do
  local name, mass = table.unpack(model)
  local system = dm.system { Q = dm.R(2), L = function(q, v)
    return (mass(q[1] - q[2]) * v[1] ^ 2 + v[2] ^ 2) / 2 - q:dot(q) / 2
  end }
  local solver = system:solver { rule = "midpoint", h = 0.03 }
  local q, v, wrong, kinds = {}, {}, nil, {}
  for i, gap in ipairs { 0, 1e-16, 3e-15, 1e-14, 1e-9, 1e-4, 0.004, 0.02, 0.05, 0.3, 0.8 } do
    q[i], v[i] = { 0.7 + gap, 0.7 }, { i % 2 == 0 and -1 or 0.3, 0.2 }
  end
  local e = solver:ensemble { members = #q, q = q, v = v, steps = 40 }
  for i = 1, #q do
    local fine, run = pcall(solver.run, solver, { q = q[i], v = v[i], steps = 40, every = 40 })
    local code, steps = fine and "ok" or run.code, fine and 40 or run.step - 1
    if code ~= e.status[i] or steps ~= e.steps[i] then
      wrong = wrong or ("%d: %s after %d, alone %s after %d"):format(i, e.status[i], e.steps[i], code, steps)
    end
    kinds[code] = true
  end
  local names = {}
  for kind in pairs(kinds) do names[#names + 1] = kind end
  table.sort(names)
  ok(not wrong and #names > 1, ("%s: members start where runs do (%s)"):format(name, table.concat(names, ", ")), wrong)
end

-- a mass of time that passes zero between two looks: a member goes on from one at which that may have been
local COUPLED = { { 0.051989259625018 }, { -0.10948790198543, 0.11753909868324 },
  { -0.011168517980891, -0.070670962335964, -0.0075353535114512 } }
local turning = dm.system { Q = dm.R(4), L = function(q, v, t)
  local T = 0
  for i = 1, 4 do
    T = T + v[i] ^ 2 / 2 * (1.1 + cos(q[i] + 0.3 * t))
    for j = 1, i - 1 do T = T + COUPLED[i - 1][j] * v[i] * v[j] * cos(q[i] - q[j]) end
  end
  return T - q:dot(q) / 2
end }:solver { rule = "gauss(2)", h = 0.05 }
local q = { 0.26337249485477, 0.060079940104931, -1.5274285865522, 1.2006161080988 }
local v = { -0.21546108516324, -1.7652791181558, 1.84608991796, 1.5832279163922 }
local _, failure = pcall(turning.run, turning, { q = q, v = v, steps = 150 })
local member = turning:ensemble { members = 1, q = { q }, v = { v }, steps = 150 }
ok(failure.code == "inertia" and member.status[1] == "inertia" and member.steps[1] == failure.step - 1,
  "a member whose mass of time passes zero between two looks ends as alone", member.status[1])
tap.done()
