-- The first step of a reduced run that went wrong is named, whatever rows were kept.
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok = tap.ok
local sin, cos = math.sin, math.cos

-- the failure of a run, or nothing; every: rows that are kept
local function failure_of(shape, rule, h, start, steps, every)
  local fine, e = pcall(function()
    return shape:solver({ rule = rule, h = h }):run { q = start.q, v = start.v, p = start.p,
      steps = steps, every = every }
  end)
  return not fine and e or nil
end

local EVERY = { 1, 3, 40, 7000 }

-- one step for all kinds of rows, and before it the energy was kept
local function check_alike(name, shape, rule, h, start, steps)
  local first = failure_of(shape, rule, h, start, steps, 1)
  ok(first and first.reason, name .. ": told", tostring(first))
  for _, every in ipairs(EVERY) do
    local e = failure_of(shape, rule, h, start, steps, every)
    ok(e and e.step == first.step and e.reason == first.reason and e.time == first.time,
      ("%s: every = %d names the same step"):format(name, every), e and ("%d against %d, %s"):format(
        e.step, first.step, tostring(e)))
    ok(e and e.path.t[#e.path] <= e.time + 1e-9, "and its path ends before it",
      e and e.path.t[#e.path])
  end
  return first
end

-- a pendulum on a turntable that steps past its pole: a stiff wall behind which the run goes on
local bob = dm.system { Q = dm.R(2), coordinates = { "azimuth", "angle" }, L = function(q, v)
  return (v[2] ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) / 2 + 2 * cos(q[2])
end }
local shape = bob:routh { cyclic = { 1 }, mu = 0.004 }
local e = check_alike("a pole that is jumped", shape, "gauss(2)", 0.07, { q = { 1.1 }, v = { 0 } }, 400)
local calm = shape:solver({ rule = "gauss(2)", h = 0.07 }):run { q = { 1.1 }, v = { 0 },
  steps = e.step - 1 }
ok(calm:drift("energy").largest < 1e-3, "up to the step that is named the energy is kept",
  calm:drift("energy").largest)

-- the double spherical pendulum near a straight rod, by other rules and steps than the one that is
-- known: the energy goes in two bursts, and it is the first that is named
local s = models.near_pole
local rods = models.pendulum():routh { cyclic = { 1 }, q = s.q, v = s.v }
local x, u = rods:start(s.q, s.v)
local told = 0
for rule, h in pairs { ["gauss(1)"] = 0.02, ["gauss(2)"] = 0.025, ["lobatto(3)"] = 0.02 } do
  local one = failure_of(rods, rule, h, { q = x, v = u }, 2500, 1)
  if one then
    local name = one.message:match "before that (step %d+)" or ("step %d"):format(one.step)
    for _, every in ipairs { 5, 400 } do
      local other = failure_of(rods, rule, h, { q = x, v = u }, 2500, every)
      ok(other and other.message:find(name .. " ", 1, true) and other.step == one.step,
        ("%s: %s, every = %d"):format(rule, name, every), tostring(other))
      told = told + 1
    end
  end
end
ok(told >= 4, "of several rules", told)

-- a run that is right is none of that, its energy moves as rules let it
local satellite = models.satellite(0.05):routh { cyclic = { 1 }, mu = 0.9 }
for _, every in ipairs(EVERY) do
  local failed = failure_of(satellite, "verlet", 0.2, { q = { 1, 0 }, v = { 0, 0.4 } }, 3000, every)
  ok(not failed, ("a good run of Verlet, every = %d"):format(every), tostring(failed))
end

-- no energy to keep: a force; the pole is found between rows too
local pushed = dm.system { Q = dm.R(2), coordinates = { "azimuth", "angle" }, L = bob.L,
  force = function(_, v) return { 0, -0.01 * v[2] } end }
local damped = pushed:routh { cyclic = { 1 }, mu = 0 }
ok(not failure_of(damped, "gauss(2)", 0.05, { q = { 1.1 }, v = { 0 } }, 300, 50),
  "without momentum nothing is in the way")

-- steps as long as their error allows are not judged by steps of the length h: Kepler's radius near
-- the centre (e = 0.89), whatever rows are kept
local kepler = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1]
end }
local radius = kepler:routh { cyclic = { 2 }, q = { 1, 0 }, v = { 0, 1 / 3 } }
local a = 1 / (2 - 1 / 9)
local e = 1 / a - 1
for _, rule in ipairs { "rk8", "gauss(4)" } do
  local run = radius:solver({ rule = rule, h = 20 / 256 }):run { q = { 1 }, v = { 0 }, at = { 4, 20 },
    control = { tolerance = 1e-12 } }
  for i = 1, 2 do
    local n, E = a ^ -1.5 * run.t[i] + math.pi, nil
    E = n
    for _ = 1, 200 do E = E - (E - e * sin(E) - n) / (1 - e * cos(E)) end
    tap.near(run.q[i][1], a * (1 - e * cos(E)), 1e-8, rule .. " with controlled steps")
  end
end

-- where the momentum is that at rest there is no wall, and beside it all others are small: the
-- locked inertia is at least 1.6, and the run goes on as the unreduced one
local driven = dm.system { Q = dm.R(2), coordinates = { "x", "theta" }, L = function(q, v, t)
  return (2 + 0.4 * sin(q[1])) * (v[1] ^ 2 + v[2] ^ 2) / 2 - q[1] ^ 2 / 2
    + 0.3 * cos(t) * v[2] * sin(q[1])
end }
local mu = driven:momentum({ 0.1, 0 }, { 0.3, 0 }, 1.1)[2]
local below = driven:routh { cyclic = "theta", q = { 0.1, 0 }, v = { 0.3, 0 }, mu = mu }
for _, rule in ipairs { "midpoint", "gauss(2)", "lobatto(3)" } do
  local way = { rule = rule, h = 0.05 }
  local fine, reduced = pcall(function()
    return below:solver(way):run { q = { 0.1 }, v = { 0.3 }, t0 = 1.1, steps = 100 }
  end)
  ok(fine, rule .. ": a start with the momentum at rest", tostring(reduced))
  local whole = driven:solver(way):run { q = { 0.1, 0 }, v = { 0.3, 0 }, t0 = 1.1, steps = 100 }
  tap.near(fine and reduced.q[101][1], whole.q[101][1], 1e-12, rule .. ": the unreduced run")
end
tap.done()
