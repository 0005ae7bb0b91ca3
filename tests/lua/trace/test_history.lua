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

-- on groups the rules of coordinates step a lift: with the stage kernel (verlet) and without (curve); rules whose weights differ in the last
-- digit of a long double
do
  local G = dm.SO(3)
  local function make()
    return dm.system { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end }
  end
  local function q() return G:exp { 0.4, 0.1, 0 } end
  local function p() return { 0.2, 0.1, 1 } end
  local simpson = dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 } }
  local all = { "verlet", "lobatto(3)", "curve(heun)", "curve(rk4)", "rk8", "gauss(2)", "symplectic-euler(a)", "kahan-li(6)", "galerkin(2, lobatto(3))", simpson }
  local function last(system, rule)
    local path = system:solver({ rule = rule, h = 0.05 }):run { q = q(), p = p(), steps = 20, every = 20 }
    return bits(path.q[2][1], path.q[2][2]) .. bits(path.p[2], path.p[2])
  end
  local fresh = {}
  for k, rule in ipairs(all) do fresh[k] = last(make(), rule) end
  for k, rule in ipairs(all) do
    local after, other = {}, false
    for l, before in ipairs(all) do
      local system = make()
      last(system, before)
      if last(system, rule) ~= fresh[k] then after[#after + 1] = l end
      local e = system:solver({ rule = rule, h = 0.05 }):ensemble { members = 4, threads = 2, steps = 20, q = q, p = p }
      for i = 1, 4 do other = other or bits(e.q[i][1], e.q[i][2]) .. bits(e.p[i], e.p[i]) ~= fresh[k] end
    end
    ok(#after == 0, ("a body, %s: whatever ran before"):format(tostring(rule)), table.concat(after, ", "))
    ok(not other, ("a body, %s: members of two threads"):format(tostring(rule)))
  end
end

do
  local G, rules = dm.SE(2), { "galerkin(2, lobatto(3))", dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 } } }
  local function make() return dm.system { Q = G, L = function(g, x) return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2) / 2 - g[1] ^ 2 / 2 - g[2] end } end
  local function last(system, rule, i)
    local path = system:solver({ rule = rule, h = 0.05 }):run { q = G:exp { 0.1 * i, 0.2, 0.3 }, p = { 0.5, 0.1 * i, 0.3 }, steps = 50, every = 1 }
    local out = {}
    for k = 1, #path do out[k] = bits(path.q[k], path.q[k]) .. bits(path.p[k], path.p[k]) end
    return table.concat(out)
  end
  local other, differ = 0, 0
  for i = 1, 20 do
    local ends = { last(make(), rules[1], i), last(make(), rules[2], i) }
    differ = differ + (ends[1] == ends[2] and 0 or 1)
    for first = 1, 2 do
      local system = make()
      last(system, rules[first], i)
      other = other + (last(system, rules[3 - first], i) == ends[3 - first] and 0 or 1)
    end
  end
  ok(differ > 0 and other == 0, "nor does a rule take the table of another that is nearly its own", other .. " do, of " .. differ)
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
