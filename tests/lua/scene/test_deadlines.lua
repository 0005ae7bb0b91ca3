-- deadlines of scenes: errors beside closed forms, stiff systems, rows of a plain run, what is refused
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function kepler(q, v) return v:dot(v) / 2 + 1 / q:norm() end
local far = dm.system { Q = dm.R(2), L = kepler }

-- x, y on an ellipse of semi-axis 1 at a time after the apocentre
local function on_ellipse(e, t)
  local M = math.pi + t
  local E = M
  for _ = 1, 60 do E = E - (E - e * math.sin(E) - M) / (1 - e * math.cos(E)) end
  return e - math.cos(E), -math.sqrt(1 - e * e) * math.sin(E)
end

local e, T = 0.9, 12
local function scene_of(tolerance)
  return dm.scene { far, q = { 1 + e, 0 }, v = { 0, math.sqrt((1 - e) / (1 + e)) }, watch = { "q1", "q2" },
    until_t = T, frame = 0.1, per_step = 3e-4, tolerance = tolerance, seconds = 3 }
end

local function worst_of(run)
  local x, y, worst = run:column "q1", run:column "q2", 0
  for k = 1, #run do
    local a, b = on_ellipse(e, run.t[k])
    worst = math.max(worst, math.abs(x[k] - a), math.abs(y[k] - b))
  end
  return worst
end

-- passages between the frames: errors are largest there, and rules are chosen as exactly as they are known
local at = {}
for k = 1, 4000 do at[k] = T * k / 4000 end
local free, kept = scene_of(), scene_of(1e-2)
for _, scene in ipairs { free, kept } do
  local run = scene:run { at = at }
  local worst = worst_of(run)
  ok(worst <= run.error_estimate and run.error_estimate < 1e-10, "the estimate holds between frames", worst / run.error_estimate)
end

-- with a tolerance straight lines between the rows of a plain run keep it, and each frame has a row
do
  local run, worst, i = kept:run(), 0, 1
  local t, x = run.t, run:column "q1"
  for _, time in ipairs(at) do
    while i + 1 < #t and t[i + 1] < time do i = i + 1 end
    local f = (time - t[i]) / (t[i + 1] - t[i])
    worst = math.max(worst, math.abs((1 - f) * x[i] + f * x[i + 1] - on_ellipse(e, time)))
  end
  ok(worst <= run.error_estimate and run.error_estimate <= 1e-2, "lines between rows", worst)
  ok((#t - 1) % 120 == 0, "rows in each of 120 frames", #t)
  ok(#free:run() == 121, "without a tolerance one a frame")
end

-- steps as long as a frame run away, shorter ones do not
do
  local stiff = dm.system { Q = dm.R(2), L = function(q, v)
    return v:dot(v) / 2 - 5e7 * (q[1] - q[2] ^ 2) ^ 2 - q[2] ^ 2 / 2
  end }
  local scene = dm.scene { stiff, q = { 0.25, 0.5 }, v = { 0, 0 }, watch = { "q2" }, until_t = 0.2, frame = 0.05,
    per_step = 1e-3, seconds = 3 }
  ok(scene:run().error_estimate < 1e-6, "a stiff system", tostring(scene))
end

-- what iterates for a mass that is not constant is of no fixed work
do
  local two = dm.system { Q = dm.R(2), L = function(q, v)
    return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] * math.cos(q[1] - q[2]) + 2 * math.cos(q[1]) + math.cos(q[2])
  end }
  local scene = dm.scene { two, q = { 1, 0 }, v = { 0, 0 }, watch = { "q1" }, until_t = 1, frame = 0.05, per_step = 1e-3,
    seconds = 3 }
  scene:run()
  local fixed = true
  for _, c in ipairs(scene.candidates) do fixed = fixed and (c.rule:find "^rk" or c.rule:find "^gauss") end
  ok(fixed, "rules of fixed work")
end

local function try(more)
  local o = { far, q = { 1, 0 }, v = { 0, 1 }, watch = { "q1" }, until_t = 1, frame = 0.1, per_step = 1e-3, seconds = 0.5 }
  for key, value in pairs(more) do o[key] = value end
  return function() dm.scene(o):run() end
end
raises("end at no frame", try { rules = { "log-hamiltonian(verlet)" } }, "steps of their own length")
raises("end at no frame", try { rules = { "controlled(rk8)" } }, "steps of their own length")
raises("steps a frame: ", try { frame = 1e-9 }, "more frames than can be run: why")
raises("option 'frame' is missing", function()
  dm.scene { far, q = { 1, 0 }, v = { 0, 1 }, watch = { "q1" }, until_t = 1, per_step = 1 }
end)
raises("per_step = 1e-12", try { per_step = 1e-12 }, "no room for a step")

-- what rolls, and an L of first order, in closed form: a skate that turns evenly goes around; q2 pushes q1 around a circle
local skate = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end, rolling = function(q, v) return math.cos(q[3]) * v[2] - math.sin(q[3]) * v[1] end }
local circle = dm.system { Q = dm.R(2), L = function(q, v) return q[2] * v[1] - (q[1] ^ 2 + q[2] ^ 2) / 2 end }
for _, case in ipairs { { skate, { 0, 0, 0 }, { 1, 0, 0.8 }, function(t) return math.sin(0.8 * t) / 0.8 end, "gauss" },
  { circle, { 1, 0 }, { 0, -1 }, function(t) return math.cos(t) end, "degenerate" } } do
  local scene = dm.scene { case[1], q = case[2], v = case[3], watch = { "q1" }, until_t = 3, frame = 0.05, per_step = 5e-4, seconds = 4 }
  local run, worst = scene:run(), 0
  local t, x = run.t, run:column "q1"
  for i = 1, #t do worst = math.max(worst, math.abs(x[i] - case[4](t[i]))) end
  ok(scene.best.rule:find(case[5]) and scene.best.worst_step <= 5e-4, "a rule of few iterations keeps the deadline", scene.best.rule)
  ok(#t == 61 and worst <= run.error_estimate and worst < 1e-8, "a row a frame, as exact as it says", worst, run.error_estimate)
end

tap.done()
