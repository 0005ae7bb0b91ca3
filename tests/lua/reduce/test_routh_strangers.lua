-- Routh reduction of systems that strangers brought: steady precession of a top whatever its momenta, orbits that pass where an action is not free, kinetic energies
-- that are no quadratic forms, sections that are none
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sin, cos, sqrt = math.abs, math.sin, math.cos, math.sqrt

-- both precessions of a top leaning by 0.9, I1 W^2 cos - p3 W + m g = 0: a trace compared near the pole of its angles, where all digits of the locked inertia cancel,
-- is not refused for that
local I1, I3, mg, th, p3 = 1.1, 0.6, 2, 0.9, 5
local top = dm.system { Q = dm.R(3), coordinates = { "phi", "theta", "psi" }, L = function(q, v)
  return I1 * (v[2] ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) / 2 + I3 * (v[3] + v[1] * cos(q[2])) ^ 2 / 2 - mg * cos(q[2])
end }
for _, sign in ipairs { -1, 1 } do
  local W = (p3 + sign * sqrt(p3 ^ 2 - 4 * I1 * mg * cos(th))) / (2 * I1 * cos(th))
  local list = top:routh({ cyclic = { "phi", "psi" }, mu = { I1 * sin(th) ^ 2 * W + p3 * cos(th), p3 } }):relative_equilibria { region = { 0.05, 3.1 } }
  ok(#list == 1, "one steady precession", tostring(list))
  near(list[1].x[1], th, 1e-12, "where it leans"); near(list[1].velocity[1], W, 1e-12, "how fast it precesses")
  -- nutation: w^2 = V''/I1 of V = (p1 - p3 cos)^2/(2 I1 sin^2) + m g cos, where p1 - p3 cos = I1 W sin^2
  local nods = 0
  for _, value in ipairs(list[1].values) do nods = math.max(nods, value[2]) end
  near(nods, sqrt((p3 / I1 - 2 * cos(th) * W) ^ 2 + sin(th) ^ 2 * W ^ 2), 1e-9, "and nods")
end

-- two oscillators in resonance 1:2. Where the first is at rest the coordinates (theta, r, x) have a pole, and nothing is claimed there; elsewhere the shape stays
local resonant = dm.system { Q = dm.R(4), L = function(q, v)
  local a, b = q[1] ^ 2 + q[2] ^ 2, q[3] ^ 2 + q[4] ^ 2
  return v:dot(v) / 2 - a / 2 - 2 * b - 0.2 * ((q[1] ^ 2 - q[2] ^ 2) * q[3] + 2 * q[1] * q[2] * q[4])
end }
local function turn(t, q)
  local c, s, C, S = cos(t), sin(t), cos(2 * t), sin(2 * t)
  return { c * q[1] - s * q[2], s * q[1] + c * q[2], C * q[3] - S * q[4], S * q[3] + C * q[4] }
end
local shape = resonant:routh { action = turn, mu = 1.2, at = { 1, 0, 0.2, 0.3 } }
local list = shape:relative_equilibria { region = { { 0, 3 }, { -2, 2 }, { -2, 2 } }, starts = 400 }
ok(#list == 2, "resonance 1:2: two relative equilibria", tostring(list))
for _, e in ipairs(list) do
  ok(e.x[1] > 0.1, "away from the pole", e.x)
  local path = shape:solver({ rule = "gauss(4)", h = 0.02 }):run { q = e.x, v = { 0, 0, 0 }, t = 3 }
  near((path.q[#path] - e.x):norm(), 0, 1e-9, "they stay")
end
for _, rule in ipairs { "gauss(2)", "lobatto(3)" } do  -- in the coordinates of the reduction
  local q, v = { 0.8, 0.1, 0.5, 0.2 }, { 0.1, 0.7, -0.3, 0.6 }
  ok(dm.commute(resonant, { action = turn, q = q, v = v, h = 0.02, rule = rule, steps = 20 }).commutes, rule .. ": its cube commutes")
end

-- a rule that is no partitioned Runge-Kutta rule: reduced and unreduced agree to its order, which is told
local pendulum = dm.system { Q = dm.R(2), L = function(q, v) return (v[2] ^ 2 + sin(q[2]) ^ 2 * (v[1] + 0.7) ^ 2) / 2 + 9.8 * cos(q[2]) end }
local cube = dm.commute(pendulum, { q = { 0, 0.4 }, v = { 0.3, 0.1 }, h = 0.02, rule = "galerkin(3, lobatto(4))" })
ok(not cube.commutes and abs(cube.apart - 6) < 0.2 and tostring(cube):find("agree to order", 1, true), "to what order a rule commutes", tostring(cube))

-- L = v^4: d2L/dv2 vanishes at v = 0, where a search for the velocity that has a momentum would begin
local quartic = dm.system { Q = dm.R(2), L = function(q, v) return v[2] ^ 2 / 2 + v[1] ^ 4 * (1 + q[2] ^ 2) end }
local q, v = { 0, 1 }, { 0.5, 0.1 }  -- mu = 4 v1^3 (1 + q2^2) = 1
local below = quartic:routh { cyclic = 1, q = q, v = v }
near(below:routhian({ 0.5 }, { 0.3 }), 0.045 - 0.75 * (1 / 5) ^ (1 / 3), 1e-15, "Routhian of a quartic energy, closed form")
for _, rule in ipairs { "gauss(1)", "gauss(2)", "lobatto(3)", "rk4" } do
  local path = quartic:solver({ rule = rule, h = 0.05 }):run { q = q, v = v, t = 5 }
  local back = below:solver({ rule = rule, h = 0.05 }):run({ q = { 1 }, v = { 0.1 }, t = 5 }):reconstruct()
  near(dm.compare(path, back).worst, 0, rule == "rk4" and 1e-11 or 1e-13, rule .. ": a quartic energy, reduced and back = unreduced")
end

-- L that is not convex in v: a momentum belongs to several velocities. The reduction takes that of its start; a run, whose state is (q, p), is refused where it
-- would begin with another one
local crystal = dm.system { Q = dm.R(2), L = function(p, w) return w[2] ^ 2 / 2 + w[1] ^ 4 / 4 - w[1] ^ 2 / 2 - p[2] ^ 2 / 2 end }
for _, rate in ipairs { 1.2, 0.8, -0.8, -0.2 } do
  local kept = crystal:routh { cyclic = 1, q = { 0, 1 }, v = { rate, 0 } }
  local x, u = kept:start({ 0, 1 }, { rate, 0 })
  local path = kept:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = x, v = u, t = 5 }):reconstruct()
  near(path.q[101][1], 5 * rate, 1e-12, ("theta' = %g, which its momentum alone does not tell"):format(rate))
end
local other = crystal:routh { cyclic = 1, mu = 0.8 ^ 3 - 0.8 }
raises("this reduction has another one", function() other:start({ 0, 1 }, { 0.8, 0 }) end)
raises("no start: L is not convex in v", function() crystal:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 0, 1 }, v = { 0.8, 0 }, t = 5 } end)
raises("member 2: no start: L is not convex in v", function()
  crystal:solver({ rule = "gauss(2)", h = 0.05 }):ensemble { members = 2, q = function() return { 0, 1 } end, v = { { 0.1, 0 }, { 0.8, 0 } }, t = 5 }
end)

-- what cannot be reduced
local free = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[2] ^ 2 end }
local function shift(t, p) return { p[1] + t, p[2], p[3] } end
raises("no shape was found at which the group crosses it", function() free:routh { action = shift, mu = 1, section = function(x) return { x[1], x[2], 0 } end } end)
raises("no shape was found at which the group crosses it", function() free:routh { action = shift, mu = 1, section = function() return { 0, 1, 0 } end } end)
raises("SO(2) is a group, which acts in many ways", function() free:routh { action = dm.SO(2), mu = 1 } end)
raises("option 'action' must return a point of Q: entry 1", function() free:routh { action = shift, dimension = 2, mu = { 1, 1 } } end)
raises("option 'cyclic'[1] must be a coordinate", function() free:routh { cyclic = { { 1 } }, mu = 1 } end)
raises("L is linear in the velocities", function()
  dm.system({ Q = dm.R(2), L = function(p, w) return p[2] * w[1] - p[2] ^ 2 end }):routh { cyclic = 1, mu = 1 }
end)
raises("L is not finite at the start", function()
  dm.system({ Q = dm.R(2), L = function(p, w) return -sqrt(1 - w[1] ^ 2 - p[1] ^ 2 * w[2] ^ 2) end }):routh { cyclic = 2, q = { 1, 0 }, v = { 0.9, 0.9 } }
end)
raises("continue takes one of", function() shape:continue({ x = { 1, 0, 0 }, mu = { 1 } }, { mu = { 1, 2 } }) end)
raises("dm.commute: unknown option 'rul'; did you mean 'rule'? options are rule, h", function() dm.commute(quartic, { q = q, v = v, h = 0.1, rul = "gauss(2)" }) end)

tap.done()
