-- linearization at relative equilibria: in what moves along, against multipliers of exact tangent
-- maps and closed forms; reduced systems on their own space; what is frozen says so
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local G = dm.SO(3)

local function growth(linear) return math.max(table.unpack(linear.rates:totable())) end

---- in coordinates ----

local function turning(q) return { -q[2], q[1] } end
local kepler = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 + 1 / q:norm()
end }
local circle = { q = { 1, 0 }, v = { 0, 1 } }
local frozen = kepler:linearize(circle)
ok(frozen.frozen and frozen.stable == nil and frozen.why:find "moves on",
  "a circle in x and y is no equilibrium of x and y", frozen.why)
circle.generator = turning
local moving = kepler:linearize(circle)
ok(moving.stable and not moving.frozen, "and stable in what turns along", moving.why)
near(moving.fastest, 1, 1e-12, "the radius swings once a turn")
near(moving.rate, 1, 1e-15, "at that rate")
raises("no relative equilibrium of option 'generator'", kepler.linearize, kepler,
  { q = { 1, 0 }, v = { 0, 1.1 }, generator = turning })
raises("it moves nothing", kepler.linearize, kepler,
  { q = { 1, 0 }, v = { 0, 1 }, generator = function() return { 0, 0 } end })
raises("must be a list of 2 numbers", kepler.linearize, kepler,
  { q = { 1, 0 }, v = { 0, 1 }, generator = function() return { 0 } end })

-- an H that no Lagrangian here has: circles of radius r with p^2 = r^2 sqrt(1 + p^2)
local fast = dm.system { Q = dm.R(2), H = function(q, p)
  return dm.sqrt(1 + p:dot(p)) + q:dot(q) / 2
end }
local p = 1.2
local E = math.sqrt(1 + p * p)
local r = p / math.sqrt(E)
local whirl = { q = { r, 0 }, p = { 0, p }, generator = turning }
near(fast:linearize(whirl).rate, math.sqrt(1 / E), 1e-14, "a relativistic oscillator in a circle")
local T = 2 * math.pi * math.sqrt(E)
local turn = fast:solver { rule = "gauss(8)", h = T / 40 }
  :multipliers { q = whirl.q, p = whirl.p, steps = 40 }
local phase = 0
for i = 1, 4 do phase = math.max(phase, math.abs(turn.im[i])) end
near(math.abs(math.sin(fast:linearize(whirl).fastest * T)), phase, 1e-7, "swings as after a turn")

local growing = dm.system { Q = dm.R(1), L = function(q, v, t)
  return dm.exp(0.2 * t) * (v[1] ^ 2 - q[1] ^ 2) / 2
end }
near(growth(growing:linearize { q = { 0 } }), -0.1, 1e-14, "a mass that grows damps")
local straight = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - 2 * q[1] ^ 2 end }
ok(straight:linearize { q = { 1 }, v = { 1 } }.stable, "linear systems are nowhere frozen")

---- on groups ----

local I3, w = 0.6, 1.5
local function top(R, x) return (x[1] ^ 2 + x[2] ^ 2 + I3 * x[3] ^ 2) / 2 - R[3][3] end
local function upright(R) return R:transpose() * dm.vector { 0, 0, 1 } end
local sleeping = { q = G:identity(), v = { 0, 0, w } }
local rate = math.sqrt(1 - (I3 * w / 2) ^ 2)
local left = dm.system { Q = G, L = top }
local right = dm.system { Q = G, trivialization = "right", L = function(R, x)
  return top(R, R:transpose() * x)
end }
local of_p = dm.system { Q = G, H = function(R, m)
  return (m[1] ^ 2 + m[2] ^ 2 + m[3] ^ 2 / I3) / 2 + m[1] ^ 4 + R[3][3]
end }
for name, system in pairs { left = left, right = right, ["H alone"] = of_p } do
  for _, generator in ipairs { false, upright } do
    local start = { q = sleeping.q, p = { 0, 0, I3 * w }, generator = generator or nil }
    local linear = system:linearize(start)
    near(growth(linear), rate, 1e-12, ("a sleeping top, %s%s"):format(name,
      generator and ", turning along" or ""))
    ok(not linear.frozen, "which is not frozen")
  end
end
ok(left:linearize { q = G:exp { 0.4, 0, 0 }, v = { 0.3, 0, w } }.frozen, "a nodding one is")

-- steady precession of a tilted top: the rates of the reduced equations on the group as well
local c, Omega = math.cos(0.5), 1.7
-- Omega^2 c - p3 Omega + 1 = 0 (I1 = mgl = 1)
local p3 = (Omega ^ 2 * c + 1) / Omega
local R0 = G:exp { 0.5, 0, 0 }
local gamma = R0:transpose() * dm.vector { 0, 0, 1 }
local xi = { 0, Omega * gamma[2], p3 / I3 }
-- relative to space it goes about the vertical, and about its own axis with what is left
local spin = p3 / I3 - Omega * gamma[3]
local steady = left:linearize { q = R0, v = xi, generator = function(R)
  local up = upright(R)
  return { Omega * up[1], Omega * up[2], Omega * up[3] + spin }
end }
near(steady.rate, 1, 1e-13, "steady precession: a generator of both turns")
-- small nutations: u'' = -(p3^2 + Omega^2 ... ) by the effective potential of the angle
local a = Omega
local theta = 0.5
local s2 = math.sin(theta) ^ 2
local pz = s2 * a + p3 * c
local function effective(x)
  return (pz - p3 * math.cos(x)) ^ 2 / (2 * math.sin(x) ^ 2) + math.cos(x)
end
local h = 1e-3
local bend = (-effective(theta + 2 * h) + 16 * effective(theta + h) - 30 * effective(theta)
  + 16 * effective(theta - h) - effective(theta - 2 * h)) / (12 * h * h)
near(steady.fastest, math.sqrt(bend), 1e-8, "whose nutation is that of the effective potential")

-- a satellite in its gravity gradient, on SO(3) x R^3: one turn of its orbit
local I, far = { 0.1, 0.2, 0.25 }, 2
local n = math.sqrt((1 + 1.5 * (I[2] + I[3] - 2 * I[1]) / far ^ 2) / far ^ 3)
local satellite = dm.system { Q = dm.product(G, dm.R(3)), L = function(q, v)
  local x = q[2]
  local X, d = q[1]:transpose() * x, dm.sqrt(x:dot(x))
  return (I[1] * v[1] ^ 2 + I[2] * v[2] ^ 2 + I[3] * v[3] ^ 2 + v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2
    + 1 / d + (I[1] + I[2] + I[3] - 3 * (I[1] * X[1] ^ 2 + I[2] * X[2] ^ 2 + I[3] * X[3] ^ 2)
    / d ^ 2) / (2 * d ^ 3)
end }
local orbit = { q = { G:identity(), dm.vector { far, 0, 0 } }, v = { 0, 0, n, 0, far * n, 0 } }
ok(satellite:linearize(orbit).frozen, "a satellite moves on")
orbit.generator = function(g)
  local z = upright(g[1])
  return { z[1], z[2], z[3], -g[2][2], g[2][1], 0 }
end
local linear = satellite:linearize(orbit)
near(linear.rate, n, 1e-14, "its orbit is along turns of space")
local period = 2 * math.pi / n
local map = satellite:solver { rule = "gauss(6)", h = period / 60 }
  :multipliers { q = orbit.q, v = orbit.v, steps = 60 }
local angles, wanted = {}, {}
for i = 1, 12 do
  angles[i] = math.abs(math.atan(map.im[i], map.re[i]))
  local turned = linear.frequencies[i] * period
  wanted[i] = math.abs(math.atan(math.sin(turned), math.cos(turned)))
end
table.sort(angles)
table.sort(wanted)
-- the four multipliers 1 of symmetries are double, and known to the root of round-off
for i = 5, 12 do near(angles[i], wanted[i], 1e-9, "its swings are those of the tangent map") end
ok(linear.stable, "and it is stable", linear.why)

---- reduced ----

local function seen(g, a) return g * dm.vector(a) end
local function l(x, a) return (x[1] ^ 2 + x[2] ^ 2 + I3 * x[3] ^ 2) / 2 - a[3] end
local carried = dm.euler_poincare { group = G, l = l, advected = seen, a = { 0, 0, 1 } }
local by_h = dm.euler_poincare { group = G, advected = seen, a = { 0, 0, 1 }, h = function(m, a)
  return (m[1] ^ 2 + m[2] ^ 2 + m[3] ^ 2 / I3) / 2 + a[3]
end }
for name, it in pairs { l = carried:linearize { v = { 0, 0, w } },
  h = by_h:linearize { p = { 0, 0, I3 * w } } } do
  ok(it.matrix.rows == 6 and not it.frozen, name .. ": on the space of (momentum, a)")
  near(growth(it), rate, 1e-12, name .. ": the sleeping top")
end
near(growth(carried:linearize { v = { 0, 0, w }, a = { 0, 0, 2 } }),
  math.sqrt(2 - (I3 * w / 2) ^ 2), 1e-12, "with another quantity")
near(growth(carried:linearize { v = { 0, 0, w } }), rate, 1e-12, "which is not kept")
ok(carried:linearize { v = { 0.3, 0, w } }.frozen, "what moves is frozen")
local free = dm.euler_poincare { group = G, l = function(x)
  return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2) / 2
end }
local middle = free:linearize { v = { 0, 1, 0 } }
near(growth(middle), 1 / math.sqrt(3), 1e-14, "the middle axis")
ok(middle.matrix.rows == 3, "in three entries")
raises("systems that are not reduced", free.linearize, free, { generator = upright })
raises("the velocity v or the momentum p", left.linearize, left,
  { q = G:identity(), v = { 0, 0, 1 }, p = { 0, 0, 1 } })

---- constraints and forces in coordinates: on what they leave ----

local gravity = 9.81
local function rods(n, count)
  return dm.system { Q = dm.R(2 * n), L = function(q, v)
    local V = 0
    for i = 1, n do V = V + gravity * q[2 * i] end
    return v:dot(v) / 2 - V
  end, constraint = function(q)
    local out = {}
    for i = 1, count or n do
      local x, y = q[2 * i - 1], q[2 * i]
      if i > 1 then x, y = x - q[2 * i - 3], y - q[2 * i - 2] end
      out[i] = x ^ 2 + y ^ 2 - 1
    end
    return out
  end }
end
local hanging = rods(1):linearize { q = { 0, -1 } }
near(hanging.fastest, math.sqrt(gravity), 1e-14, "a pendulum of x and y swings as one of its angle")
ok(hanging.stable and hanging.matrix.rows == 2, "in two changes", hanging.why)
near(growth(rods(1):linearize { q = { 0, 1 } }), math.sqrt(gravity), 1e-14, "and falls as it does")
local double = rods(2):linearize({ q = { 0, -1, 0, -2 } }).frequencies:totable()
table.sort(double)
near(double[4] / math.sqrt(gravity * (2 + math.sqrt(2))), 1, 1e-13, "a double pendulum: the fast mode")
near(double[3] / math.sqrt(gravity * (2 - math.sqrt(2))), 1, 1e-13, "and the slow one")
local upside = rods(2):linearize({ q = { 0, 1, 0, 2 } }).rates:totable()
table.sort(upside)
near(upside[4] / math.sqrt(gravity * (2 + math.sqrt(2))), 1, 1e-13, "upside down both grow")
near(upside[3] / math.sqrt(gravity * (2 - math.sqrt(2))), 1, 1e-13, "at these rates")

-- a spherical pendulum's circle at the angle theta: (omega / Omega)^2 = 1 + 3 cos(theta)^2
local ball = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - gravity * q[3] end,
  constraint = function(q) return q:dot(q) - 1 end }
for _, angle in ipairs { 0.2, 0.7, 1.3 } do
  local Omega = math.sqrt(gravity / math.cos(angle))
  local round = { q = { math.sin(angle), 0, -math.cos(angle) }, v = { 0, Omega * math.sin(angle), 0 } }
  ok(ball:linearize(round).frozen, "a spherical pendulum that goes around moves on")
  round.generator = function(q) return { -q[2], q[1], 0 } end
  local its = ball:linearize(round)
  near(its.rate, Omega, 1e-13 * Omega, "at this rate")
  near(its.fastest / Omega, math.sqrt(1 + 3 * math.cos(angle) ^ 2), 1e-13, "and nutates at that one")
end
-- the same in polar coordinates with friction: -c/2 +- sqrt(c^2/4 - g)
local rubbed = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - gravity * q[2] end,
  constraint = function(q) return q:dot(q) - 1 end, force = function(_, v) return -0.3 * v end }
local slowed = rubbed:linearize { q = { 0, -1 } }
near(slowed.rates[1], -0.15, 1e-14, "friction damps it")
near(slowed.fastest, math.sqrt(gravity - 0.15 ^ 2), 1e-14, "and slows it")
-- a skate on a slope that holds its heading: rolling leaves one direction less of velocities
local skate = dm.system { Q = dm.R(3), L = function(q, v) return (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2 - 2 * q[3] ^ 2 - q[1] ^ 2) / 2 end,
  rolling = function(q, v) return dm.cos(q[3]) * v[2] - dm.sin(q[3]) * v[1] end }
local still = skate:linearize { q = { 0, 0, 0 } }
local tones = still.frequencies:totable()
table.sort(tones)
ok(#tones == 5 and math.abs(tones[5] - math.sqrt(2)) < 1e-14 and math.abs(tones[4] - 1) < 1e-14,
  "a skate slides along x and turns", still.frequencies)
-- a massless slider between springs: regular with its constraint alone
local slider = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2 - 3 * q[2] ^ 2) / 2 end,
  constraint = function(q) return q[2] - q[1] end }
near(slider:linearize({ q = { 0, 0 } }).fastest, 2, 1e-13, "a slider without mass")
raises("off the constraints: constraint 1 is 0.21 there", ball.linearize, ball, { q = { 0, 0, -1.1 } })
raises("the rate of constraint 1 is -2 there", ball.linearize, ball, { q = { 0, 0, -1 }, v = { 0, 0, 1 } })
raises("rolling condition 1 is 1 there", skate.linearize, skate, { q = { 0, 0, 0 }, v = { 0, 1, 0 } })

-- a disk that rolls upright falls like exp(s t), s^2 = 4/5 (g/r - 3 v^2/r^2): stable from v^2 = g r/3 on (Routh). Its
-- places and turns are zeros without eigenvectors, which round-off moves to either side
local disk = dm.system { Q = dm.product(G, dm.R(3)), L = function(q, u)
  return (u[1] ^ 2 / 4 + u[2] ^ 2 / 4 + u[3] ^ 2 / 2 + u[4] ^ 2 + u[5] ^ 2 + u[6] ^ 2) / 2 - gravity * q[2][3]
end, rolling = function(q, u)
  local up = q[1]:transpose() * dm.vector { 0, 0, 1 }
  local size = (up[1] ^ 2 + up[2] ^ 2) ^ 0.5
  local rim = q[1] * dm.vector { u[1], u[2], u[3] }:cross(dm.vector { -up[1] / size, -up[2] / size, 0 * size })
  return { u[4] + rim[1], u[5] + rim[2], u[6] + rim[3] }
end }
for _, part in ipairs { 0.5, 0.9, 1.1, 2 } do
  local speed = math.sqrt(part * gravity / 3)
  local ahead = { 0, 0, -speed, speed, 0, 0 }
  local its = disk:linearize { q = { G:exp { math.pi / 2, 0, 0 }, { 0, 0, 1 } }, v = ahead, generator = function() return ahead end }
  local square = 4 / 5 * gravity * (1 - part)
  ok(its.stable == (part > 1), ("a disk that rolls at %g g r/3"):format(part), its.why)
  near(part > 1 and its.fastest or growth(its), math.sqrt(math.abs(square)), 1e-6, "wobbles, or falls, at that rate")
end
local slowly = dm.system { Q = dm.R(2), L = function(q, u) return (u:dot(u) - q[1] ^ 2 + 1e-12 * q[2] ^ 2) / 2 end }
local slow = slowly:linearize { q = { 0, 0 } }
ok(not slow.stable and math.abs(growth(slow) - 1e-6) < 1e-9, "what grows slowly grows", slow.why)

tap.done()
