-- a run has the same bits whatever ran before it on its system, and alone or as a member of an ensemble: kernels that are kept, or taken out of
-- one another, round as those that are made anew
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local sin, cos = math.sin, math.cos

-- a mass that depends on the state, beside one that does not
local function pendulum()
  return dm.system { Q = dm.R(3), L = function(q, v)
    local r, phi = q[2], q[3]
    return 3 * v[2] ^ 2 / 2 + (v[2] ^ 2 + r ^ 2 * v[3] ^ 2 + r ^ 2 * sin(phi) ^ 2 * v[1] ^ 2 + v[1] ^ 2 / 2) / 2 - 9.8 * r * (3 - cos(phi))
  end }
end
local function fast()
  return dm.system { Q = dm.R(2), L = function(q, v) return -math.sqrt(1 - v[1] ^ 2 - q[1] ^ 2 * v[2] ^ 2) - q[1] ^ 2 / 2 end }
end
local function charge()
  return dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 + q[1] * v[2] * (1 + q[3] ^ 2) - cos(q[3]) * q[1] ^ 2 end }
end
local rules = { "verlet", "gauss(1)", "gauss(2)", "lobatto(3)", "galerkin(2, gauss(3))", "sprk(radau-1a, 2)", "curve(rk4)", "rk4", "rkf45", "rk8" }

local function bits(q, p)
  local out = {}
  for k = 1, #q do out[k] = ("%a %a"):format(q[k], p[k]) end
  return table.concat(out, " ")
end

for name, case in pairs { pendulum = { pendulum, { 0, 2, 0.5 }, { 0.8, 0, 0.1 } }, charge = { charge, { 1, 0.1, 0.2 }, { 0, 1, 0.1 } },
  fast = { fast, { 0.5, 0 }, { 0.1, 0.6 } } } do
  local make, q, v = table.unpack(case)
  local function run(system, rule)
    local fine, path = pcall(function() return system:solver({ rule = rule, h = 0.01 }):run { q = q, v = v, steps = 20 } end)
    return fine and bits(path.q[#path], path.p[#path]) or nil, path
  end
  local befores = {
    energy = function(system) system:energy(q, v); system:mass(q, v); system:momentum(q, v) end,
    path = function(system) select(2, run(system, "gauss(2)")):energy() end,
    discrete = function(system) dm.discrete_lagrangian(system, { rule = "gauss(2)", h = 0.1 }) end,
  }
  for _, rule in ipairs(rules) do befores[rule] = function(system) run(system, rule) end end
  for _, rule in ipairs(rules) do
    local fresh, after = run(make(), rule), {}
    for before, f in pairs(befores) do
      local system = make()
      f(system)
      if run(system, rule) ~= fresh then after[#after + 1] = before end
    end
    ok(#after == 0, ("%s, %s: whatever ran before"):format(name, rule), table.concat(after, ", "))
    local system, other = make(), fresh == nil
    run(system, "gauss(2)")
    for _, made in ipairs(fresh and { system, make() } or {}) do
      local e = made:solver({ rule = rule, h = 0.01 }):ensemble { members = 20, threads = 2, steps = 20, q = function() return q end, v = function() return v end }
      for i = 1, 20 do other = other or bits(e.q[i], e.p[i]) ~= fresh end
    end
    ok(not other or not fresh, ("%s, %s: members of two threads"):format(name, rule))
  end
end

-- a single step from two positions, by a rule that begins with what its last step left
local ball = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = function(q) return q:dot(q) - 1 end }
local function two_steps(before)
  local solver = ball:solver { rule = "rattle", h = 0.1 }
  if before then solver:run { q = { sin(1), -cos(1) }, v = { 0, 0 }, steps = before } end
  local q2 = solver:step({ sin(0.5), -cos(0.5) }, { sin(0.55), -cos(0.55) })
  return ("%a %a"):format(q2[1], q2[2])
end
local first = two_steps()
ok(two_steps(1) == first and two_steps(50) == first, "a step from two positions, whatever ran before")

tap.done()
