-- Rolling constraints whose reactions spare the group: reduced runs against the unreduced ones and
-- against equations of motion that are written out here.
local tap = require "tap"
local dm = require "dm"
local near, raises = tap.near, tap.raises
local cos, sin = math.cos, math.sin

-- steps of the classical method for q'' = a(q, q', t); the last q
local function runge_kutta(a, q, v, t, T, steps)
  local h = T / steps
  for k = 0, steps - 1 do
    local now = t + k * h
    local k1, l1 = v, a(q, v, now)
    local k2 = v + h / 2 * l1
    local l2 = a(q + h / 2 * k1, k2, now + h / 2)
    local k3 = v + h / 2 * l2
    local l3 = a(q + h / 2 * k2, k3, now + h / 2)
    local k4 = v + h * l3
    local l4 = a(q + h * k3, k4, now + h)
    q, v = q + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), v + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4)
  end
  return q
end

-- a sleigh with a wheel that turns above it: psi is cyclic, the blade does not push it
local function wheel(q) return 0.5 + 0.2 * sin(q[1]) end
local sleigh = dm.system { Q = dm.R(4), coordinates = { "x", "y", "phi", "psi" },
  params = { c = 0.05 },
  L = function(q, v, t) return 0.4 * (v[1] ^ 2 + v[2] ^ 2) + 0.3 * v[3] ^ 2 + wheel(q) * (v[3] + v[4]) ^ 2 / 2 - 0.3 * q[1] ^ 2 - 0.2 * sin(q[3]) * cos(t) end,
  rolling = function(q, v, t, p) return v[1] * sin(q[3]) - v[2] * cos(q[3]) + p.c * v[3] - 0.02 * cos(t) end,
  force = function(_, v) return { -0.1 * v[1], -0.1 * v[2], -0.05 * v[3] * v[4] ^ 2, 0 } end }

-- M a = f + phi_v lambda with phi' = 0, c = 0.05
local function acceleration(q, v, t)
  local J, slope, w = wheel(q), 0.2 * cos(q[1]), v[3] + v[4]
  local s, c = sin(q[3]), cos(q[3])
  local rate = -slope * v[1] * w
  local A = dm.matrix { { 0.8, 0, 0, 0, -s }, { 0, 0.8, 0, 0, c }, { 0, 0, 0.6 + J, J, -0.05 },
    { 0, 0, J, J, 0 }, { s, -c, 0.05, 0, 0 } }
  return A:solve(dm.vector { slope * w ^ 2 / 2 - 0.6 * q[1] - 0.1 * v[1], -0.1 * v[2],
    rate - 0.2 * c * cos(t) - 0.05 * v[3] * v[4] ^ 2, rate,
    -(v[1] * c + v[2] * s) * v[3] - 0.02 * sin(t) }):slice(1, 4)
end
local q, v, t0 = dm.vector { 0.3, -0.2, 0.4, 0.1 }, dm.vector { 0.7, 0, 0.3, 0.9 }, 0.5
v[2] = (v[1] * sin(q[3]) + 0.05 * v[3] - 0.02 * cos(t0)) / cos(q[3])
local exact = runge_kutta(acceleration, q, v, t0, 2, 2000)

local mu = wheel(q) * (v[3] + v[4])
local shape = sleigh:routh { cyclic = "psi", mu = mu }
local start = { q = q:slice(1, 3), v = v:slice(1, 3), t0 = t0, t = 2 }
for rule, room in pairs { ["gauss(4)"] = 1e-11, ["lobatto(4)"] = 1e-9, ["curve(rk4)"] = 1e-7 } do
  local solver = shape:solver { rule = rule, h = 0.02 }
  local run = solver:run(start)
  local whole = run:reconstruct { theta = q[4] }
  local full = sleigh:solver { rule = rule, h = 0.02 }:run { q = q, v = v, t0 = t0, t = 2 }
  near((whole.q[#whole] - exact):norm(), 0, room, rule .. " of the shape, and back, is the motion")
  if rule ~= "curve(rk4)" then
    near((whole.q[#whole] - full.q[#full]):norm(), 0, 1e-12, rule .. ": the steps of the unreduced run")
  end
  local cloud = solver:ensemble { members = 3, q = function() return start.q end, v = function() return start.v end,
    t0 = t0, t = 2, vary = { mu = function(i) return mu + (i - 2) / 10 end, c = function() return 0.05 end } }
  near((cloud.q:row(2) - run.q[#run]):norm(), 0, 1e-13, rule .. ": members have momenta of their own")
end
raises("a force", function() shape:discrete { rule = "midpoint", h = 0.1 } end)

-- turns about an axis, the shape (r, z); reactions along phi_v, and along rows that are given,
-- where phi may see the angle's rate
local function turn(angle, x)
  local c, s = dm.cos(angle), dm.sin(angle)
  return { c * x[1] - s * x[2], s * x[1] + c * x[2], x[3] }
end
local function climb(x, u) return u[3] - x[1] * u[1] - x[2] * u[2] end
local function screw(x, u) return u[3] - 0.3 * (x[1] * u[2] - x[2] * u[1]) end
for name, law in pairs {
  bowl = { rolling = climb },
  pushed = { rolling = climb, reaction = function(x) return { { 0.2 * x[1], 0.2 * x[2], 1 } } end },
  screw = { rolling = screw, reaction = function() return { { 0, 0, 1 } } end } } do
  local bead = dm.system { Q = dm.R(3), rolling = law.rolling, reaction = law.reaction,
    L = function(x, u) return u:dot(u) / 2 - 0.15 * (x[1] ^ 2 + x[2] ^ 2) ^ 2 - 0.4 * x[3] ^ 2 end }
  local x, u = { 0.8, 0.3, 0.2 }, { 0.2, 0.7, 0 }
  u[3] = -law.rolling(x, u)
  local full = bead:solver { rule = "gauss(4)", h = 0.02 }:run { q = x, v = u, t = 2 }
  local reduced = bead:routh { action = turn, section = function(y) return { y[1], 0, y[2] } end, q = x, v = u }
  local y, w, angle = reduced:start(x, u)
  local whole = reduced:solver { rule = "gauss(4)", h = 0.02 }:run { q = y, v = w, t = 2 }:reconstruct { theta = angle }
  near((whole.q[#whole] - full.q[#full]):norm(), 0, 1e-11, name .. ": back in space")
  near((whole.p[#whole] - full.p[#full]):norm(), 0, 1e-11, name .. ": and the momentum")
  raises("constraints", function() reduced:relative_equilibria { region = { { 0.1, 1 }, { -1, 1 } } } end)
  raises("constraints", function() reduced:discrete { rule = "midpoint", h = 0.1 } end)
end

-- a body that does not turn about a horizontal axis, without the angle about the vertical
local G = dm.SO(3)
local body = dm.system { Q = G, rolling = function(g, xi) return g[3][2] * xi[1] - g[3][1] * xi[2] end,
  L = function(g, xi) return (xi[1] ^ 2 + 1.7 * xi[2] ^ 2 + 2.5 * xi[3] ^ 2) / 2 - 0.8 * g[3][3] - 0.2 * g[3][1] end }
local g = G:exp { 0.5, 0.3, 0.2 }
local xi = { g[3][1], g[3][2], 0.6 }
local full = body:solver { rule = "lie(3)", h = 0.02 }:run { q = g, v = xi, t = 1 }
local upright = body:routh { q = g, v = xi, action = function(angle, at) return G:compose(G:exp { 0, 0, angle }, at) end,
  section = function(x) return G:compose(G:exp { x[1], 0, 0 }, G:exp { 0, 0, x[2] }) end }
local x, u, angle = upright:start(g, xi)
local whole = upright:solver { rule = "gauss(4)", h = 0.02 }:run { q = x, v = u, t = 1 }:reconstruct { theta = angle }
near(G:distance(whole.q[#whole], full.q[#full]), 0, 1e-10, "on a group")

-- what the group does not keep
local function refused(words, rolling, reaction)
  local system = dm.system { Q = dm.R(3), L = function(p, w) return w:dot(w) / 2 - p[1] ^ 2 end, rolling = rolling, reaction = reaction }
  raises(words, function() system:routh { cyclic = { 3 }, mu = 1 } end)
end
refused("component along the group", function(p, w) return w[1] - p[1] * w[3] end)
refused("constraint is not invariant", function(p, w) return w[1] - dm.sin(p[3]) * w[2] end)
refused("component along the group", function(_, w) return w[1] - w[2] end, function() return { { 1, 0, 0.1 } } end)
refused("reaction is not invariant", function(_, w) return w[1] - w[2] end, function(p) return { { 1, dm.sin(p[3]), 0 } } end)

-- an Ld of this system has its rolling constraints
local function plate(law)
  return dm.discrete_lagrangian { Q = dm.R(3), h = 0.1, rolling = function(p, r) return law(p, (r - p) / 0.1) end,
    Ld = function(p, r, h) return (r - p):dot(r - p) / (2 * h) end,
    reaction = function(p) return { { law(p, { 1, 0, 0 }), law(p, { 0, 1, 0 }), 0 } } end }
end
local function slides(p, w) return w[1] - p[1] * w[2] end
local free = dm.system { Q = dm.R(3), L = function(_, w) return w:dot(w) / 2 end, rolling = slides }:routh { cyclic = { 3 }, mu = 1 }
local D, steps = plate(slides), { p = { 0.4, 0.5 }, q = { 0.8, 0.1 }, steps = 5 }
local got = free:discrete(D):solver {}:run(steps)
local all = D:solver {}:run { q = { 0.8, 0.1, 0 }, p = { 0.4, 0.5, 1 }, steps = 5 }
near((got.q[6] - all.q[6]:slice(1, 2)):norm(), 0, 1e-12, "steps of an Ld with its rolling constraint")
raises("react in other directions", function() free:discrete(plate(function(p, w) return w[1] + p[1] * w[2] end)) end)
tap.done()
