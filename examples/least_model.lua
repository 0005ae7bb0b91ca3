-- How much model does a question need? A pendulum on a stiff spring, watched in its angle only, as well as one asks for: dm.scene
-- finds the cheapest model, rule and step. Up to some accuracy a rigid pendulum is enough; beyond it the spring must be followed.
local dm = require "dm"
local picture = (arg and arg[1] or ".") .. "/least_model.png"

local g, T = 9.81, 10
local function pendulum(k)  -- a: stretch, m; theta: angle; mass and length 1
  return dm.system { name = "pendulum on a spring", Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
    local a, theta = q[1], q[2]
    return (v[1] ^ 2 + (1 + a) ^ 2 * v[2] ^ 2) / 2 + g * (1 + a) * math.cos(theta) - k / 2 * a ^ 2
  end }
end
local function start(k) return { q = { g * math.cos(0.5) / k, 0.5 }, v = { 0, 0 } } end

-- what the rigid pendulum costs in accuracy, by runs of both that have nothing to do with the scene
local rigid = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + g * math.cos(q[1]) end }
local function difference(k)
  local at, s, worst = {}, start(k), 0
  for i = 1, 400 do at[i] = T * i / 400 end
  local a = pendulum(k):solver({ rule = "gauss(4)", h = 2e-3 }):run { q = s.q, v = s.v, at = at }
  local b = rigid:solver({ rule = "gauss(4)", h = 0.02 }):run { q = { 0.5 }, v = { 0 }, at = at }
  for i = 1, 400 do worst = math.max(worst, math.abs(a.q[i][2] - b.q[i][1])) end
  return worst
end

local series = {}
for _, k in ipairs { 1e4, 1e5 } do
  local limit, x, y, dearest = difference(k), {}, {}, 0
  for _, tolerance in ipairs { 10, 2, 0.5, 0.1, 0.03 } do
    local s = start(k)
    local scene = dm.scene { pendulum(k), q = s.q, v = s.v, watch = { "theta" }, tolerance = tolerance * limit, until_t = T,
      rules = { "gauss(4)", "gauss(6)", "blanes-moan(6)", "verlet", "rk8" } }
    local run, one = scene:run(), scene.best.model.system.Q.dimension == 1
    assert(run.error_estimate <= tolerance * limit, "the tolerance is delivered")
    assert(one or tolerance < 2, "one coordinate answers what a rigid pendulum can answer")
    assert(not one or tolerance > 0.1, "and no more")
    x[#x + 1], y[#y + 1] = tolerance * limit, scene.best.ns * 1e-3
    dearest = math.max(dearest, y[#y] / y[1])
  end
  print(("k = %.0e: the rigid pendulum is good to %.1e rad; beyond that the answer costs %.0f times as much"):format(k, limit, dearest))
  series[#series + 1] = { x = x, y = y, name = ("k = 10^%.0f N/m"):format(math.log(k, 10)) }
end

-- less than that, found without being told: a distance in a central force is one coordinate, a string in its lowest mode one of thirty
local v0 = math.sqrt(1.1 / 0.9)
local space = dm.scene { dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, q = { 0.9, 0, 0 }, v = { 0, 0.8 * v0, 0.6 * v0 },
  watch = { r = function(q) return q:norm() end }, tolerance = 1e-5, until_t = 30, seconds = 4 }
local x, rest = {}, {} for i = 1, 30 do x[i], rest[i] = math.sin(math.pi * i / 31), 0 end
local line = dm.scene { dm.system { Q = dm.R(30), L = function(q, v)
  local U = q[1] ^ 2 + q[30] ^ 2
  for i = 1, 29 do U = U + (q[i + 1] - q[i]) ^ 2 end
  return (v:dot(v) - U) / 2
end }, q = x, v = rest, watch = { "q15" }, tolerance = 1e-6, until_t = 50, seconds = 4 }
for name, scene in pairs { ["Kepler in space, watched in r"] = space, ["a string of thirty"] = line } do
  print(("%s, to %.0e: dimension %d, %s"):format(name, scene:run().error_estimate, scene.best.n, scene.best.model:words()))
  assert(scene.best.n == 1, "one coordinate is left")
end

print("picture  " .. dm.plot(series, { log = "xy", style = "linespoints", file = picture, xlabel = "tolerance of the angle", xunit = "rad",
  ylabel = "least cost of the steps", yunit = "us", title = "Pendulum on a stiff spring, 10 s: what an answer costs" }))
