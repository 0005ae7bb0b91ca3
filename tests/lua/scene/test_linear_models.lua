-- linear models with drag, gyroscopic terms and forcing are solved: against closed forms, where the matrix is defective, unstable, stiff, resonant too
local tap = require "tap"
local dm = require "dm"
local exp, cos, sin, sqrt, abs, max = math.exp, math.cos, math.sin, math.sqrt, math.abs, math.max

-- the scene of { L, force, q, v, t0, until_t }; its largest error beside exact(t), in tolerances
local function solve(case, exact)
  local t0 = case.t0 or 0
  local scene = dm.scene { dm.system { Q = dm.R(#case.q), L = case.L, force = case.force }, q = case.q, v = case.v, t0 = t0, until_t = case.until_t,
    watch = { "q1" }, tolerance = case.tolerance, seconds = 5 }
  local at, worst = {}, 0
  for i = 1, 700 do at[i] = t0 + (case.until_t - t0) * i / 700 end
  local run = scene:run { at = at }
  local x = run:column "q1"
  for i, t in ipairs(at) do worst = max(worst, abs(x[i] - exact(t))) end
  return scene, worst / case.tolerance, worst <= run.error_estimate
end
local function exactly(what, case, exact)
  local scene, worst, kept = solve(case, exact)
  tap.ok(scene.best.rule == "exact" and scene:why():find "linear[^\n]*solved", what .. ": solved", tostring(scene))
  tap.ok(worst < (case.within or 1e-4) and kept, what .. ": its closed form", worst)
  return scene
end
local function spring(w, c)
  return function(q, v) return (v[1] ^ 2 - w * w * q[1] ^ 2) / 2 end, function(_, v) return -2 * c * v end
end
local function driven(w, c, push)
  return function(q, v, t) return (v[1] ^ 2 - w * w * q[1] ^ 2) / 2 + push(t) * q[1] end, c and function(_, v) return -2 * c * v end or nil
end

-- damping below, at, and next to the critical one
for _, c in ipairs { 0.1, 1, 1 + 1e-9, 1 - 1e-7, 40 } do
  local L, force = spring(1, c)
  local d = sqrt(abs(c * c - 1))
  exactly("damping " .. c, { L = L, force = force, q = { 1 }, v = { 0.5 }, until_t = 30, tolerance = 1e-8 }, function(t)
    if c == 1 then return exp(-t) * (1 + 1.5 * t) end
    if c < 1 then return exp(-c * t) * (cos(d * t) + (0.5 + c) * (d * t < 1e-2 and t * (1 - (d * t) ^ 2 / 6) or sin(d * t) / d)) end
    if d < 1e-3 then return exp(-c * t) * (1 + (d * t) ^ 2 / 2 + (0.5 + c) * t * (1 + (d * t) ^ 2 / 6)) end
    local a, b = (0.5 + c + d) / (2 * d), -(0.5 + c - d) / (2 * d)
    return a * exp((d - c) * t) + b * exp(-(c + d) * t)
  end)
end
-- resonance, and of a critically damped spring: a block of three
local L, force = driven(1, nil, function(t) return cos(t) end)
exactly("resonance", { L = L, q = { 0 }, v = { 0 }, until_t = 200, tolerance = 1e-7, within = 1e-2 }, function(t) return t * sin(t) / 2 end)
L, force = driven(1, 1, function(t) return t * exp(-t) end)
exactly("critical, forced alike", { L = L, force = force, q = { 0 }, v = { 0 }, until_t = 20, tolerance = 1e-9 }, function(t)
  return t ^ 3 / 6 * exp(-t) end)
-- forcing that begins at t0: powers, products, squares of sines
L = function(q, v, t) return v[1] ^ 2 / 2 + q[1] * t ^ 3 end
exactly("a cubic push", { L = L, q = { 3 }, v = { 2 }, t0 = 1, until_t = 11, tolerance = 1e-7 }, function(t)
  return 3 + 2 * (t - 1) + (t ^ 5 - 1) / 20 - (t - 1) / 4 end)
L, force = driven(2, 0.25, function(t) return 8 * sin(1.5 * (t - 0.3)) ^ 2 end)
local re, im = 4 - 9, 0.5 * 3  -- of the answer to cos 3 (t - 0.3), with drag 0.5 v
local function settled(t)
  local s = 3 * (t - 0.3)
  return 1 - 4 * (re * cos(s) + im * sin(s)) / (re * re + im * im), 12 * (re * sin(s) - im * cos(s)) / (re * re + im * im)
end
local x0, v0 = settled(0.7)
exactly("the settled motion of a driven spring", { L = L, force = force, q = { x0 }, v = { v0 }, t0 = 0.7, until_t = 40, tolerance = 1e-9 },
  function(t) return (settled(t)) end)
-- nothing pulls back: fall with drag, drift in crossed fields
exactly("fall with drag", { L = function(q, v) return v[1] ^ 2 / 2 - 9.81 * q[1] end, force = function(_, v) return -0.5 * v end, q = { 3 }, v = { 2 },
  until_t = 10, tolerance = 1e-8 }, function(t) return 3 - 19.62 * t + 2 * 21.62 * (1 - exp(-t / 2)) end)
exactly("drift in crossed fields", { L = function(q, v) return v:dot(v) / 2 + 5 * (q[1] * v[2] - q[2] * v[1]) / 2 + q[1] end, q = { 1, 0 }, v = { 0, 1 },
  until_t = 30, tolerance = 1e-9 }, function(t) return 1 - 1.2 / 5 * (cos(5 * t) - 1) end)
-- a hill that gyroscopic terms hold, and one that grows; in units of astronomy
for _, unit in ipairs { 1, 1.5e11 } do
  for _, w in ipairs { 3, 1 } do
    local a = unit * 1e-3
    local scene = exactly(("a hill that turns by %g, in units of %g"):format(w, unit), { L = function(q, v)
      return 5e20 * (v:dot(v) + 2 * w * (q[1] * v[2] - q[2] * v[1]) + q:dot(q))
    end, q = { a, 0 }, v = { 0, 0 }, until_t = 9, tolerance = unit * 1e-9 }, function(t)
      local z = sqrt(abs(w * w - 1)) -- z'' + 2 i w z' - z = 0 has the roots -i (w +- sqrt(w^2 - 1))
      if w == 1 then return a * (cos(t) + t * sin(t)) end
      local p, m = w + z, w - z
      return a * (p * cos(m * t) - m * cos(p * t)) / (p - m)
    end)
    tap.ok(scene.best.n == 2, "two coordinates", scene.best.n)
  end
end
local rate = sqrt(1.01) - 0.1
exactly("a top with drag", { L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2) / 2 end, force = function(_, v) return -0.2 * v end, q = { 1e-6 },
  v = { rate * 1e-6 }, until_t = 15, tolerance = 1e-8 }, function(t) return 1e-6 * exp(rate * t) end)
-- components that nothing watched feels, or that are alike, are left out
local chain = dm.scene { dm.system { Q = dm.R(6), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end, force = function(_, v) return -0.1 * v end },
  q = { 1, 2, 3, 4, 5, 6 }, v = { 0, 0, 0, 0, 0, 1 }, watch = { s = function(q) return q[1] + q[6] end }, tolerance = 1e-8, until_t = 20 }
tap.ok(chain:why():find "2 of 12 components" and chain.best.n == 1, "one pair of equal ones is left", tostring(chain))
-- small swings with drag; a pulse is no sum of exponentials: stepped
L = function(q, v, t) return v[1] ^ 2 / 2 + cos(q[1]) + 1e-6 * q[1] * sin(0.7 * t) end
local swings = dm.scene { dm.system { Q = dm.R(1), L = L, force = function(_, v) return -0.02 * v end }, q = { 1e-4 }, v = { 0 }, watch = { "q1" },
  tolerance = 1e-9, until_t = 60 }
tap.ok(swings:why():find "linear about an equilibrium, 2 of 2 components, solved" and swings.best.rule == "exact", "small swings", tostring(swings))
L = driven(1, nil, function(t) return exp(-((t - 5) / 0.1) ^ 2) end)
local kicked, worst = solve({ L = L, q = { 1 }, v = { 0 }, until_t = 10, tolerance = 1e-6 }, function(t)
  return cos(t) + (t > 5.8 and 0.1 * sqrt(math.pi) * exp(-0.1 ^ 2 / 4) * sin(t - 5) or t < 4.2 and 0 or 0 / 0) end)
tap.ok(kicked.best.rule ~= "exact" and worst <= 1, "a pulse is stepped", worst)
-- a distance has no derivative at the equilibrium; far from t = 0
local turned = dm.scene { dm.system { Q = dm.R(2), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end,
  force = function(_, v) return { -0.1 * v[1] + v[2], -0.1 * v[2] - v[1] } end }, q = { 1, 0 }, v = { 0, 1 }, t0 = 1e6, until_t = 1e6 + 20,
  watch = { r = function(q) return q:norm() end }, tolerance = 1e-7 }
tap.ok(turned:run().error_estimate <= 1e-7 and turned.best.rule == "exact", "a distance, far from t = 0", tostring(turned))
-- what bends, where at rest and at the start it feels one of two coordinates: w = 2, with and without drag 2 c v
for name, f in pairs { ["r^2"] = function(x, y) return x * x + y * y end, ["x y"] = function(x, y) return x * y end } do
  for _, c in ipairs { 0, 0.05 } do
    local d, worst, at = sqrt(4 - c * c), 0, {}
    for i = 1, 500 do at[i] = 20 * i / 500 end
    local scene = dm.scene { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 2 * q:dot(q) end,
      force = c > 0 and function(_, v) return -2 * c * v end or nil }, q = { 1, 0 }, v = { 0, 0.7 }, until_t = 20, tolerance = 1e-7,
      watch = { it = function(q) return f(q[1], q[2]) end } }
    local it = scene:run({ at = at }):column "it"
    for i, t in ipairs(at) do
      local x, y = exp(-c * t) * (cos(d * t) + c / d * sin(d * t)), exp(-c * t) * 0.7 / d * sin(d * t)
      worst = max(worst, abs(it[i] - f(x, y)))
    end
    tap.ok(scene.best.rule == "exact" and worst < 1e-11, name .. " of two modes is solved, drag " .. c, worst, tostring(scene))
  end
end
tap.done()
