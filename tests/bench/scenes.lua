-- scenes.lua [KEY ...] - is the choice of dm.scene the cheapest there is? For each system every model of its ladder is run by every rule with
-- every number of steps of a fine grid, up to the cost of the choice; what delivers the tolerance, and stands the check of the scene, is compared in cost.
-- scenes.lua random [COUNT [SEED]] does that with random models (tests/lua/scene/scene_kinds.lua), and asks for a tenth and ten times the tolerance, too.
package.path = "tests/lua/scene/?.lua;" .. package.path
local choice = require "dm.scene.choice"
local core = require "dm.core"
local dm = require "dm"
local pilot = require "dm.scene.pilot"
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
local DEARER = 1     -- times the cost of the choice, where the grid of a rule ends
local MOST = 1 << 17
local MOST_SECONDS = 2   -- of one run: rules with a time of their own that have run away never end

local FEW = 6        -- checks that a rule on a model is given

-- every number of steps of a rule that delivers at the times of the pilot runs, at less than so many operations
local function grid(scene, model, rule, limit, found)
  local costs, N, failures, tried = scene.profile, 2, 0, 0
  while N < MOST do
    pilot.allow(scene.problem, MOST_SECONDS, 1)
    local fine, work = pcall(costs.about, costs, model, rule, N)
    if fine and work > limit and N > 64 then break end
    local run = fine and work <= limit and pilot.run(model, rule, N, scene.search.times)
    local err = run and pilot.apart(scene.problem, run, scene.search.reference) or math.huge
    failures, tried = fine and failures or failures + 1, tried + 1
    if failures > 20 or (not fine and pilot.is_refusal(tostring(work))) then break end
    if err <= 1 then found[#found + 1] = { model = model, rule = rule, N = N, error = err, work = work } end
    N = math.max(N + 1, math.floor(N * RATIO))
  end
  return tried
end

-- the cheapest that stands the check, or the choice
local function cheapest(scene, found)
  table.sort(found, function(a, b) return a.work < b.work end)
  local failed, best = {}, scene.best
  for _, c in ipairs(found) do
    local key = c.rule .. c.model:words()
    if c.work >= best.work then break end
    if (failed[key] or 0) < FEW then
      pilot.allow(scene.problem, MOST_SECONDS, 1)
      if choice.check_error(scene, c, c.N) + scene.uncertainty <= 1 then return c end
      failed[key] = (failed[key] or 0) + 1
    end
  end
  return best
end

local function scene_of(row, tolerance)
  local scene = dm.scene { core.system(row[3]), q = row.q, v = row.v, watch = row.watch, tolerance = tolerance or row.tolerance, until_t = row.until_t,
    seconds = 60 }
  scene:why()
  return scene
end

local function one(row)
  local scene, found, tried = scene_of(row), {}, 0
  local b = scene.best
  for _, model in ipairs(scene.rungs) do
    for _, rule in ipairs(search.rules(nil, model.system)) do tried = tried + grid(scene, model, rule.rule, DEARER * b.work, found) end
  end
  scene.allowed = scene.allowed + 1e9
  local best = cheapest(scene, found)
  pilot.allow(scene.problem, nil)
  print(("%s | %s, %d steps | %s | %.2f | %d of %d | %.1f s%s"):format(row[2], b.rule, b.N, b.model:words(), b.work / best.work, #scene.rungs, tried,
    scene.seconds, scene.cut and " (cut)" or ""))
  if best ~= b then print(("  best of the grid: %s, %d steps, %.3g operations (%s)"):format(best.rule, best.N, best.work, best.model:words())) end
  io.stdout:flush()
  return b.work / best.work, scene
end

-- cost at ten times, a tenth of the tolerance: how many times a larger tolerance costs what a smaller one does, the most
local function rise(row, scene)
  local loose, tight = scene_of(row, 10 * row.tolerance), scene_of(row, row.tolerance / 10)
  local cut = loose.cut or tight.cut or scene.cut
  return cut and 0 or math.max(loose.best.work / scene.best.work, scene.best.work / tight.best.work, loose.best.work / tight.best.work)
end

local function random(count, seed)
  local ratios, most, rises = {}, 0, 0
  for _, m in ipairs(require "scene_models".make(count, seed)) do
    local row = { m.kind, ("%s %d"):format(m.kind, #ratios + 1), { Q = dm.R(m.n), L = m.L, force = m.force, constraint = m.constraint }, q = m.q, v = m.v,
      watch = m.watch or { "q1" }, tolerance = m.tolerance, until_t = m.T }
    local fine, ratio, scene = pcall(one, row)
    if fine then
      local up = rise(row, scene)
      ratios[#ratios + 1], most = ratio, math.max(most, up)
      if up > 1 then print(("  a larger tolerance costs %.3f times as much"):format(up)) rises = rises + 1 end
    else
      print(row[2], ratio)
    end
  end
  table.sort(ratios)
  print(("%d models, seed %d: cost / least %.2f in the median, %.2f of 9 in 10, %.2f at most; %d rise with the tolerance, by %.3f at most"):format(#ratios, seed,
    ratios[(#ratios + 1) // 2], ratios[(9 * #ratios + 9) // 10], ratios[#ratios], rises, most))
end

print("scene | choice | model | cost / least | models, runs tried | chosen in")
if arg[1] == "random" then return random(tonumber(arg[2]) or 60, tonumber(arg[3]) or 1) end
for _, row in ipairs(SCENES) do
  local wanted = #arg == 0
  for _, key in ipairs(arg) do wanted = wanted or key == row[1] end
  local fine, why = pcall(wanted and one or type, row)
  if not fine then print(("%s | %s"):format(row[2], why)) end
end
