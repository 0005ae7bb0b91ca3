-- the choice of a scene is the cheapest of what was measured to serve, a larger tolerance costs no more than a smaller one, and no number of steps far
-- below the chosen one serves, though errors do not fall with every step more
local tap = require "tap"
local dm = require "dm"
package.path = "tests/lua/scene/?.lua;" .. package.path
local ok = tap.ok

local RULES = { "gauss(4)", "gauss(6)", "blanes-moan(6)", "verlet", "rk8", "kahan-li(8, rattle)" }

-- what serves and costs less than the choice
local function cheaper(scene)
  for _, c in ipairs(scene.candidates) do
    if c.kept and not c.failed and c.cost < scene.best.cost then return c.rule .. " on " .. c.model:words() end
  end
end

-- from the largest tolerance to the smallest: costs, by counted operations
local function ladder(what, options, tolerances)
  local last, scene = 0, nil
  for _, tolerance in ipairs(tolerances) do
    local given = { tolerance = tolerance, rules = RULES }
    for key, value in pairs(options) do given[key] = value end
    scene = dm.scene(given)
    scene:why()
    ok(not scene.cut and scene.best.work >= last, ("%s: to %g it costs no less than to more than that"):format(what, tolerance),
      ("%.6g after %.6g %s"):format(scene.best.work, last, scene.cut or ""))
    ok(not cheaper(scene), ("%s: to %g nothing that serves is cheaper"):format(what, tolerance), cheaper(scene))
    last = scene.best.work
  end
end

-- a pendulum on a spring that long steps pass over: gauss(4) serves with 12 steps, and not again before 44
local g, k, T = 9.81, 1e4, 10
local pendulum = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + g * (1 + q[1]) * math.cos(q[2]) - k / 2 * q[1] ^ 2
end }
local start = { pendulum, q = { g * math.cos(0.5) / k, 0.5 }, v = { 0, 0 }, watch = { "q2" }, until_t = T }
ladder("a pendulum on a spring", start, { 0.1, 0.02, 5e-3, 1e-3, 3e-4 })

-- every number of steps, by runs that have nothing to do with the scene
do
  local at = {}
  for i = 1, 1500 do at[i] = T * i / 1500 end
  local function angles(rule, h)
    local fine, path = pcall(function() return pendulum:solver({ rule = rule, h = h }):run { q = start.q, v = start.v, at = at } end)
    return fine and path or nil
  end
  local exact, tolerance = angles("gauss(6)", 2e-3), 5e-3
  local scene = dm.scene { pendulum, q = start.q, v = start.v, watch = start.watch, until_t = T, tolerance = tolerance, rules = { "gauss(4)" } }
  scene:why()
  local least
  for N = 2, scene.best.N do
    local path, worst = angles("gauss(4)", T / N), 0
    for i = 1, path and #at or 0 do worst = math.max(worst, math.abs(path.q[i][2] - exact.q[i][2])) end
    if path and worst <= tolerance and not least then least = N end
  end
  ok(least and scene.best.N <= 1.25 * least, "no number of steps far below the chosen one serves", ("%s, %s"):format(scene.best.N, least))
end

-- models that nobody has seen
local every = tap.watched and 8 or 2
for i, m in ipairs(require "scene_models".make(15, 77)) do
  if i % every == 1 then
    ladder(m.kind, { dm.system { Q = dm.R(m.n), L = m.L, force = m.force, constraint = m.constraint }, q = m.q, v = m.v, watch = { "q1" }, until_t = m.T },
      { 10 * m.tolerance, m.tolerance, m.tolerance / 10 })
  end
end
tap.done()
