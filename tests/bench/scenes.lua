-- scenes.lua [KEY ...] - is the choice of dm.scene the cheapest there is? For each system every model of its ladder is run by every rule with
-- every number of steps of a fine grid, up to a little more than the cost of the choice; what delivers the tolerance at other times is compared in cost.
local core = require "dm.core"
local dm = require "dm"
local pilot = require "dm.scene.pilot"
local profile = require "dm.scene.profile"
local search = require "dm.scene.search"

local cos, sin, sqrt = math.cos, math.sin, math.sqrt

local function attraction(q, v) return v:dot(v) / 2 + 1 / q:norm() end
local function oblate(J2)
  return function(q, v)
    local r = q:norm()
    return attraction(q, v) - J2 / 2 * (3 * q[3] ^ 2 / r ^ 2 - 1) / r ^ 3
  end
end
local function spring(k)
  return function(q, v)
    return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - k / 2 * q[1] ^ 2
  end
end
local function double(q, v)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * cos(q[1] - q[2]) + 9.81 * (2 * cos(q[1]) + cos(q[2]))
end
local names = { "a", "theta" }

local SCENES = {
  { "kepler", "Kepler e = 0.6, position", { Q = dm.R(2), L = attraction }, q = { 0.4, 0 }, v = { 0, 2 }, watch = { "q1", "q2" }, tolerance = 1e-6,
    until_t = 100 },
  { "satellite", "satellite, J2 = 0.05, distance", { Q = dm.R(3), L = oblate(0.05) }, q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 },
    watch = { r = function(q) return q:norm() end }, tolerance = 1e-4, until_t = 200 },
  { "weak", "satellite, J2 = 1e-7, position", { Q = dm.R(3), L = oblate(1e-7) }, q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, watch = { "q1" },
    tolerance = 1e-3, until_t = 200 },
  { "spring6", "stiff spring k = 1e6, angle", { Q = dm.R(2), coordinates = names, L = spring(1e6) }, q = { 9.81e-6, 0.5 }, v = { 0, 0 },
    watch = { "theta" }, tolerance = 1e-3, until_t = 20 },
  { "spring8", "stiff spring k = 1e8, angle", { Q = dm.R(2), coordinates = names, L = spring(1e8) }, q = { 9.81e-8, 0.5 }, v = { 0, 0 },
    watch = { "theta" }, tolerance = 1e-3, until_t = 20 },
  { "double", "double pendulum, angles", { Q = dm.R(2), L = double }, q = { 0.6, 0.4 }, v = { 0, 0 }, watch = { "q1", "q2" }, tolerance = 1e-5,
    until_t = 20 },
  { "spherical", "spherical pendulum, height", { Q = dm.R(2), coordinates = { "theta", "phi" }, L = function(q, v)
    return (v[1] ^ 2 + sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + cos(q[1])
  end }, q = { 1, 0 }, v = { 0, 0.9 }, watch = { "theta" }, tolerance = 1e-5, until_t = 100 },
  { "rod", "stiff rod k = 1e7, position", { Q = dm.R(2), L = function(q, v)
    return v:dot(v) / 2 - 9.81 * q[2] - 1e7 / 2 * (q:norm() - 1) ^ 2
  end }, q = { sin(0.5), -cos(0.5) }, v = { 0, 0 }, watch = { "q1" }, tolerance = 1e-3, until_t = 10 },
  { "henon", "Henon-Heiles, position", { Q = dm.R(2), L = function(q, v)
    return (v:dot(v) - q:dot(q)) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3
  end }, q = { 0, 0.1 }, v = { sqrt(0.15), 0.1 }, watch = { "q1", "q2" }, tolerance = 1e-6, until_t = 200 },
  { "drag", "Kepler with drag 1e-9, in a plane of space", { Q = dm.R(3), L = attraction, force = function(_, v) return -1e-9 * v end },
    q = { 1, 0, 0 }, v = { 0, 1.2, 0 }, watch = { "q1" }, tolerance = 1e-4, until_t = 200 },
  { "rods", "two rods, constrained, position", { Q = dm.R(4), L = function(q, v) return v:dot(v) / 2 - q[2] - q[4] end, constraint = function(q)
    return { q[1] ^ 2 + q[2] ^ 2 - 1, (q[3] - q[1]) ^ 2 + (q[4] - q[2]) ^ 2 - 1 }
  end }, q = { 0.6, -0.8, 1.4, -1.4 }, v = { 0, 0, 0, 0 }, watch = { "q3" }, tolerance = 1e-6, until_t = 10 },
  { "ball", "a ball on a rod, constrained, height", { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end,
    constraint = function(q) return { q:dot(q) - 1 } end }, q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, watch = { "q3" }, tolerance = 1e-4, until_t = 40 },
}

local RATIO = 1.07   -- from one number of steps to the next
local DEARER = 1.3   -- times the cost of the choice, where the grid of a rule ends
local MOST = 1 << 17
local ROUNDS = 15
local MOST_SECONDS = 2   -- of one run: rules with a time of their own that have run away never end

-- errors are taken at times of their own
local function hold_out(scene)
  local times = pilot.times(scene.problem, 73, 0.7320508075688772)
  local given = scene.rungs[1]
  local path = pilot.reference(given, 20, {}):path(times)
  return times, pilot.record(scene.problem, path)
end

-- every number of steps of a rule that delivers, at less than so many ns
local function grid(scene, costs, model, rule, times, record, limit, found)
  local N, failures, tried = 2, 0, 0
  while N < MOST do
    pilot.allow(scene.problem, MOST_SECONDS, 1)
    local fine, ns = pcall(costs.about, costs, model, rule, N)
    if fine and ns > limit then break end
    local run = fine and pilot.run(model, rule, N, times)
    local err = run and pilot.apart(scene.problem, run, record) or math.huge
    failures, tried = fine and failures or failures + 1, tried + 1
    if failures > 40 or (not fine and pilot.is_refusal(tostring(ns))) then break end
    if err <= 1 then found[#found + 1] = { model = model, rule = rule, N = N, error = err, ns = ns } end
    N = math.max(N + 1, math.floor(N * RATIO))
  end
  return tried
end

-- the cheapest of what was found, timed in turn with the choice
local function compare(costs, found, choice)
  table.sort(found, function(a, b) return a.ns < b.ns end)
  local list = { choice }
  for i = 1, math.min(12, #found) do list[#list + 1] = found[i] end
  for _, c in ipairs(list) do c.ns = costs:cost(c.model, c.rule, c.N) end
  costs:again(list, ROUNDS, 4)
  local best
  for _, c in ipairs(list) do
    c.ns = costs:least(c.model, c.rule, c.N)
    best = (not best or c.ns < best.ns) and c or best
  end
  return best
end

local function line(scene, tried, best, choice, err)
  return ("%.1f us | %s, %d steps | %s | %.2f | %.2f | %d of %d | %.1f s"):format(choice.ns / 1e3, choice.rule, choice.N, choice.model:words(),
    choice.ns / best.ns, err, #scene.rungs, tried, scene.seconds), ("best of the grid: %s, %d steps, %.1f us (%s)"):format(best.rule,
    best.N, best.ns / 1e3, best.model:words())
end

local function one(row)
  local scene = dm.scene { core.system(row[3]), q = row.q, v = row.v, watch = row.watch, tolerance = row.tolerance, until_t = row.until_t,
    seconds = 60 }
  scene:run()
  local times, record = hold_out(scene)
  local costs, found, tried = profile.new(), {}, 0
  local b = scene.best
  local choice = { model = b.model, rule = b.rule, N = b.N }
  choice.ns = costs:cost(b.model, b.rule, b.N)
  for _, model in ipairs(scene.rungs) do
    for _, rule in ipairs(search.rules(nil, model.system)) do
      tried = tried + grid(scene, costs, model, rule.rule, times, record, DEARER * choice.ns, found)
    end
  end
  pilot.allow(scene.problem, nil)
  local err = pilot.apart(scene.problem, pilot.run(b.model, b.rule, b.N, times), record)
  local told, other = line(scene, tried, compare(costs, found, choice), choice, err)
  print(("%s | %s"):format(row[2], told))
  print("  " .. other)
end

print("scene | cost | rule | model | cost / least | error / tolerance | models, runs tried | chosen in")
for _, row in ipairs(SCENES) do
  local wanted = #arg == 0
  for _, key in ipairs(arg) do wanted = wanted or key == row[1] end
  local fine, why = pcall(wanted and one or type, row)
  if not fine then print(("%s | %s"):format(row[2], why)) end
end
