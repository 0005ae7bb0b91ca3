-- dm.scene: a common motion that changes nothing is split off, where and only where that is exact
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local cos, sin, sqrt, abs, max = math.cos, math.sin, math.sqrt, math.abs, math.max

local RULES = { "gauss(4)", "verlet", "blanes-moan(6)", "rattle", "controlled(rk8)" }

-- the scene, its run, and whether a model relative to something was kept, in that many dimensions
local function scene(options, L, more)
  local system = { Q = dm.R(#options.q), L = L }
  for key, value in pairs(more or {}) do system[key] = value end
  options.system, options.rules = dm.system(system), options.rules or RULES
  options.tolerance, options.until_t = options.tolerance or 1e-7, options.until_t or 12
  local out = dm.scene(options)
  local run, kept, told = out:run(), nil, false
  for _, row in ipairs(out.search.models) do
    if row.model:words():find "^relative to" then
      told = true
      if row.kept then kept = row.model:size() end
    end
  end
  return out, run, kept, told
end

local function worst(run, exact, scale)
  local out, t, columns = 0, run.t, {}
  for name in pairs(exact(t[1])) do columns[name] = run:column(name) end
  for i = 1, #run do
    for name, value in pairs(exact(t[i])) do
      out = max(out, abs(columns[name][i] - value) / (scale or 1))
    end
  end
  return out
end

---- two bodies: Kepler's equation ----

local function pair(q) return q:slice(1, 2) - q:slice(3, 4) end
local m1, m2 = 1, 3
local function attraction(q, v)
  return (m1 * v:slice(1, 2):dot(v:slice(1, 2)) + m2 * v:slice(3, 4):dot(v:slice(3, 4))) / 2
    + 1 / pair(q):norm()
end
-- from the pericentre at r = 1 with the relative speed w
local function kepler(w, t)
  local k = 1 / m1 + 1 / m2
  local a = 1 / (2 - w * w / k)
  local e, n = 1 - 1 / a, sqrt(k / a ^ 3)
  local E = n * t
  for _ = 1, 50 do E = E - (E - e * sin(E) - n * t) / (1 - e * cos(E)) end
  return a * (1 - e * cos(E)), a * (cos(E) - e), a * sqrt(1 - e * e) * sin(E)
end
-- the centre moves with u
local function start(w, u)
  local M = m1 + m2
  return { m2 / M + 5, -2, -m1 / M + 5, -2 },
    { u[1], u[2] + m2 / M * w, u[1], u[2] - m1 / M * w }
end
local q, v = start(1.3, { 0.2, -0.1 })
local s, run, kept = scene({ q = q, v = v, watch = { r = function(x) return pair(x):norm() end } },
  attraction)
ok(kept == 2, "two bodies: two relative coordinates", kept)
near(worst(run, function(t) return { r = (kepler(1.3, t)) } end), 0, 1e-7, "by Kepler's equation")
ok(run.error_estimate >= worst(run, function(t) return { r = (kepler(1.3, t)) } end), "as told")
ok(s.best.n <= 2 and s:why():find "plane of motion", "and in polar coordinates of these", s.best.n)

s, run, kept = scene({ q = q, v = v, watch = { "q1", "q4" } }, attraction)
ok(kept == 2, "watched positions have the uniform motion of the centre", kept)
near(worst(run, function(t)
  local _, x, y = kepler(1.3, t)
  return { q1 = 5 + 0.2 * t + m2 / 4 * x, q4 = -2 - 0.1 * t - m1 / 4 * y }
end), 0, 1e-7, "which is known")
local first = run:column "q1"[1]
near(first, q[1], 1e-14, "from the start on")

s, run, kept = scene({ q = q, v = v, watch = { "energy", "p1" } }, attraction)
ok(kept == 2, "energies and momenta too", kept)
local want = (m1 * (v[1] ^ 2 + v[2] ^ 2) + m2 * (v[3] ^ 2 + v[4] ^ 2)) / 2 - 1
near(worst(run, function() return { energy = want } end), 0, 1e-7, "of the whole")

---- spring, gravity, forces, constraints ----

-- two masses on a vertical line, a spring of length 1, g = 2, watched where they are
local function spring(x, y) return (y[1] ^ 2 + 4 * y[2] ^ 2) / 2 - 3 * (x[1] - x[2] - 1) ^ 2 - 2 * (x[1] + 4 * x[2]) end
local function spring_at(t)
  local w = sqrt(6 * 5 / 4)
  local d = 1 + 0.25 * cos(w * t)
  local centre = (1.25 + 0) / 5 + 0.3 * t - t * t
  return { q1 = centre + 0.8 * d, q2 = centre - 0.2 * d }
end
s, run, kept = scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = { "q1", "q2" }, until_t = 5 }, spring)
ok(kept == 1, "a uniform force accelerates the centre", kept)
near(worst(run, spring_at), 0, 1e-7, "in closed form")
-- the same in units of 1e-20 m and 1e12 s
local U, T = 1e-20, 1e12
s, run, kept = scene({ q = { 1.25 * U, 0 }, v = { 0.3 * U / T, 0.3 * U / T }, watch = { "q1", "q2" },
  until_t = 5 * T, tolerance = 1e-7 * U },
  function(x, y) return spring(x / U, y * (T / U)) end)
ok(kept == 1, "in any units", kept)
near(worst(run, function(t)
  local out = spring_at(t / T)
  return { q1 = out.q1 * U, q2 = out.q2 * U }
end, U), 0, 1e-7, "as exactly")

-- gravity that depends on time: what is relative does not feel it, the rest is not known
local function swaying(x, y, t) return spring(x, y) - (x[1] + 4 * x[2]) * dm.sin(t) end
local distance = { d = function(x) return x[1] - x[2] end }
s, run, kept = scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = distance, until_t = 5 }, swaying)
ok(kept == 1, "a force that depends on time", kept)
near(worst(run, function(t) return { d = 1 + 0.25 * cos(sqrt(7.5) * t) } end), 0, 1e-7, "is not felt")
local told
s, run, kept, told = scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = { "q1" }, until_t = 5 }, swaying)
ok(not told, "and not taken for a constant one")
-- x_cm'' = -(2 + sin t)
near(worst(run, function(t)
  local now = spring_at(t)
  return { q1 = now.q1 + sin(t) - t }
end), 0, 1e-7, "where positions are watched")

-- drag by the mass splits, any other does not
local function drag(a, b) return { force = function(_, y) return dm.vector { -a * y[1], -b * y[2] } end } end
s, run, kept = scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = distance, until_t = 5 }, spring, drag(0.1, 0.4))
ok(kept == 1, "drag by the mass", kept)
near(worst(run, function(t)
  local w = sqrt(7.5 - 0.0025)
  return { d = 1 + 0.25 * math.exp(-0.05 * t) * (cos(w * t) + 0.05 / w * sin(w * t)) }
end), 0, 1e-7, "is drag of what is relative")
told = select(4, scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = distance, until_t = 5 }, spring, drag(0.1, 0.3)))
ok(not told, "other drag does not split")

-- a free bar in the plane: it turns uniformly, its centre falls
local function bar(_, y) return y:dot(y) / 2 end
s, run, kept = scene({ q = { 1, 0, 0, 0 }, v = { 0, 0.8, 0, 0.2 }, watch = { "q1", "q4" }, until_t = 5, tolerance = 1e-5 },
  function(x, y) return bar(x, y) - 2 * (x[2] + x[4]) end, { constraint = function(x) return pair(x):dot(pair(x)) - 1 end })
ok(kept == 2, "constraints of what is relative stay", kept)
near(worst(run, function(t) return { q1 = 0.5 + 0.5 * cos(0.6 * t), q4 = 0.5 * t - t * t - 0.5 * sin(0.6 * t) } end), 0, 1e-5, "the bar turns and falls")

---- where it is not so ----

-- in a magnetic field charges by the mass split, others do not
local function field(c1, c2)
  return function(x, y)
    return attraction(x, y) + c1 * (x[1] * y[2] - x[2] * y[1]) / 2 + c2 * (x[3] * y[4] - x[4] * y[3]) / 2
  end
end
told = select(4, scene({ q = q, v = v, watch = { r = function(x) return pair(x):norm() end }, until_t = 3 }, field(1, -1)))
ok(not told, "charges in a magnetic field are left together")

-- what breaks the symmetry later on is met by the reference
s, run, kept = scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = distance, until_t = 5 }, function(x, y, t)
  return spring(x, y) - 0.3 * dm.exp(-((t - 3.3) / 0.2) ^ 2) * x[1] ^ 2
end)
ok(not kept, "nor what is pushed at some time", kept)
local own = s.system:solver({ rule = "gauss(6)", h = 1e-3 }):run { q = { 1.25, 0 }, v = { 0.3, 0.3 }, at = { 4.2, 5 } }
local at = s:run { at = { 4.2, 5 } }
near(at:column "d"[2], own.q[2][1] - own.q[2][2], 1.01e-7, "it is as exact as asked for")

-- masses that depend on where they are
s, run, kept, told = scene({ q = { 1.25, 0 }, v = { 0.3, 0.1 }, watch = distance, until_t = 5, tolerance = 1e-6 }, function(x, y)
  return (1 + 0.3 * (x[1] - x[2]) ^ 2) * y[1] ^ 2 / 2 + y[2] ^ 2 - (x[1] - x[2]) ^ 2
end)
own = s.system:solver({ rule = "gauss(6)", h = 1e-3 }):run { q = { 1.25, 0 }, v = { 0.3, 0.1 }, t = 5, every = 5000 }
at = s:run { at = { 5 } }
ok(not told, "masses that are not constant are left as they are")
near(at:column "d"[1], own.q[#own][1] - own.q[#own][2], 1e-6, "and right")

-- params are bound
s, run, kept = scene({ q = { 1.25, 0 }, v = { 0.3, 0.3 }, watch = { "q2" }, until_t = 5 },
  function(x, y, _, p) return (y[1] ^ 2 + 4 * y[2] ^ 2) / 2 - p.k * (x[1] - x[2] - 1) ^ 2 - 2 * (x[1] + 4 * x[2]) end, { params = { k = 3 } })
ok(kept == 1, "params", kept)
near(worst(run, function(t) return { q2 = spring_at(t).q2 } end), 0, 1e-7, "at their values")
tap.done()
