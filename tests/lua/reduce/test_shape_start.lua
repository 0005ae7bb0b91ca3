-- Which of several points of a section belongs to a point of Q: the shape of least norm, of equal
-- norms the one whose first entry is positive, or the one on a branch that is named.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, max, abs, pi = dm.sin, dm.cos, math.max, math.abs, math.pi

-- three bodies in the plane by radii and the angles between them
local function kinetic(v) return v:dot(v) / 2 end
local bodies = dm.system { Q = dm.R(6), L = function(q, v) return kinetic(v) - q:dot(q) / 2 end }
local function turn(t, q)
  local c, s, out = cos(t), sin(t), {}
  for i = 1, 5, 2 do
    out[i], out[i + 1] = c * q[i] - s * q[i + 1], s * q[i] + c * q[i + 1]
  end
  return out
end
local function polar(x)
  return { x[1], 0, x[2] * cos(x[3]), x[2] * sin(x[3]), x[4] * cos(x[5]), x[4] * sin(x[5]) }
end
local V = { 0.1, 1, -1, 0.2, 0.3, 0.7 }
local function at(x, theta) return dm.vector(turn(theta, polar(x))) end
local shape = bodies:routh { action = turn, section = polar, q = { 1, 0, 0.5, 0.2, -0.1, 0.7 },
  v = V }
local J = shape:reduction().mu[1]
-- a velocity with the momentum of the shape
local function velocity(q)
  local v, spin = dm.vector(V), 0
  for i = 1, 5, 2 do spin = spin + q[i] * v[i + 1] - q[i + 1] * v[i] end
  local more = (J - spin) / q:dot(q)
  for i = 1, 5, 2 do v[i], v[i + 1] = v[i] - more * q[i + 1], v[i + 1] + more * q[i] end
  return v
end
local worst, lost = 0, 0
for k = 1, 40 do
  local x = { 0.4 + 0.02 * k, 0.3 + 0.5 * abs(sin(k)), 1.5 * sin(3 * k), 0.9 - 0.01 * k, 1.5 * cos(5 * k) }
  local theta = 3 * sin(7 * k)
  local q = at(x, theta)
  local y, u, angle = shape:start(q, velocity(q))
  for i = 1, 5 do worst = max(worst, abs(y[i] - x[i])) end
  worst = max(worst, abs(sin((angle[1] - theta) / 2)))
  local back, w = shape:lift(y, u, angle)
  lost = max(lost, (back - q):norm(), (w - velocity(q)):norm())
end
ok(worst < 1e-12, "radii > 0 and angles within a quarter turn come back from 40 points", worst)
ok(lost < 1e-12, "with their velocities", lost)
-- beyond a quarter turn the mirrored radius has the lesser norm, unless a branch is named
local far = { 0.8, 0.5, 2.5, 0.6, -2.9 }
local q = at(far, 1)
local y = shape:start(q, velocity(q))
local mirrored = dm.vector { 0.8, -0.5, 2.5 - pi, -0.6, pi - 2.9 }
ok((y - mirrored):norm() < 1e-12, "beyond a quarter turn: the shape of least norm", y)
local function positive(x) return x[1], x[2], x[4] end
local named = bodies:routh { action = turn, section = polar, branch = positive, q = q, v = velocity(q) }
y = named:start(q, velocity(q))
ok((y - dm.vector(far)):norm() < 1e-12, "branch = several numbers: all of them are positive", y)
local lists = bodies:routh { action = turn, section = polar, q = q, v = velocity(q),
  branch = function(x) return { x[1], x[2], x[4] } end }
ok((lists:start(q, velocity(q)) - y):norm() == 0, "or a list of them")
ok(abs(named:routhian(y, { 0, 0, 0, 0, 0 }) - shape:routhian(mirrored, { 0, 0, 0, 0, 0 })) < 1e-13,
  "both name one point")
raises("branch > 0", function()
  bodies:routh { action = turn, section = polar, branch = function(x) return x[1] - 50 end, q = q,
    v = velocity(q) }
end)
raises("option 'branch' must be a function", function()
  bodies:routh { action = turn, section = polar, branch = 1, q = q, v = velocity(q) }
end)
raises("belongs to an action", function() bodies:routh { cyclic = 1, mu = 1, branch = positive } end)

-- two commuting turns: both radii may be mirrored
local pair = dm.system { Q = dm.R(4), L = function(p, v) return kinetic(v) - p:dot(p) end }
local torus = pair:routh { dimension = 2, q = { 0.3, 0.4, -0.6, 0.2 }, v = { -1, 0.2, 0.5, 0.9 },
  action = function(t, p)
    local c1, s1, c2, s2 = cos(t[1]), sin(t[1]), cos(t[2]), sin(t[2])
    return { c1 * p[1] - s1 * p[2], s1 * p[1] + c1 * p[2], c2 * p[3] - s2 * p[4],
      s2 * p[3] + c2 * p[4] }
  end, section = function(x) return { 0, x[1], x[2], 0 } end }
local x, u = torus:start({ 0.3, 0.4, -0.6, 0.2 }, { -1, 0.2, 0.5, 0.9 })
ok(abs(x[1] - 0.5) < 1e-14 and abs(x[2] - math.sqrt(0.4)) < 1e-14, "two radii of a torus action", x)
ok(abs(u[1] + 0.22 / 0.5) < 1e-13, "and their velocities", u)

-- without turns, a scaling: one root, found from far away
local free = dm.system { Q = dm.R(2), L = function(p, v)
  return (v[1] ^ 2 + v[2] ^ 2) / (p[1] ^ 2 + p[2] ^ 2) / 2 end }
local scaled = free:routh { action = function(t, p) return { dm.exp(t) * p[1], dm.exp(t) * p[2] } end,
  section = function(z) return { cos(z[1]), sin(z[1]) } end, mu = 0.4 }
local z, _, s = scaled:start({ -60, 80 }, { -60 * 0.4 - 8, 80 * 0.4 - 6 })
ok(abs(z[1] - math.acos(-0.6)) < 1e-13 and abs(s[1] - math.log(100)) < 1e-13, "a scaling", z)
tap.done()
