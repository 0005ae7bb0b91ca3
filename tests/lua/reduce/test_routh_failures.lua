-- where reduced runs fail: recognised, named, with the path so far, and the way through (spec, "where methods must fail cleanly")
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, sin, cos = math.sqrt, math.sin, math.cos

local function try(shape, options, h, rule)
  local fine, result = pcall(function()
    local path = shape:solver({ rule = rule or "gauss(2)", h = h }):run(options)
    return path
  end)
  return fine, result
end

-- a small momentum: a wall of width mu, that a long step jumps
local satellite = models.satellite(0.05)
local function start(mu) return { q = { 1, 0 }, v = { 0, sqrt(1 - mu * mu) }, t = 30 } end
for _, case in ipairs { { 0.3, 0.3, true }, { 0.1, 0.1, true }, { 0.03, 0.03, true }, { 0.03, 0.3, false }, { 0.03, 0.1, false }, { 0.01, 0.3, false }, { 0.01, 0.1, false } } do
  local mu, h, should = table.unpack(case)
  local fine, result = try(satellite:routh { cyclic = { 1 }, mu = mu }, start(mu), h)
  ok(fine == should, ("mu = %g, h = %g: %s"):format(mu, h, should and "goes through" or "is stopped"), tostring(result))
  if not should and not fine then
    local path, least = result.path, math.huge
    for i = 1, #path do least = math.min(least, path.q[i][1]) end
    ok(result.reason == "collapse" and tostring(result):find("locked inertia", 1, true), "and told why", tostring(result))
    ok(#path >= 2 and least > 0 and result.step == #path, "with the path up to the wall", ("%d rows, step %d, r %g"):format(#path, result.step, least))
  end
end

-- without momentum there is no wall: r goes on to -r
local through = satellite:routh { cyclic = { 1 }, mu = 0 }
local fine, path = try(through, { q = { 1, 0.2 }, v = { -0.3, 0.6 }, t = 6 }, 0.05)
local least = 0
for i = 1, fine and #path or 0 do least = math.min(least, path.q[i][1]) end
ok(fine and least < 0, "mu = 0 passes the axis", tostring(path))

-- rods near their length: an edge of the chart
local pole = models.near_pole
local pendulum = models.pendulum():routh { cyclic = { 1 }, q = pole.q, v = pole.v }
local x, u = pendulum:start(pole.q, pole.v)
fine, path = try(pendulum, { q = x, v = u, steps = 2000 }, 0.02)
ok(not fine and path.reason == "edge" and tostring(path):find("'r2'", 1, true) and tostring(path):find("constraint =", 1, true),
  "a rod that would leave its sphere is named, and the way through", tostring(path))
ok(#path.path > 500, "with the path so far", path.path)

-- the way through: rods as constraints in ambient coordinates, the same start, ten units of time
local m1, m2, l1, l2, g = models.m1, models.m2, models.l1, models.l2, models.g
local ambient = dm.system { Q = dm.R(6), L = function(p, w)
  local b = (w[1] + w[4]) ^ 2 + (w[2] + w[5]) ^ 2 + (w[3] + w[6]) ^ 2
  return m1 * (w[1] ^ 2 + w[2] ^ 2 + w[3] ^ 2) / 2 + m2 * b / 2 - m1 * g * p[3] - m2 * g * (p[3] + p[6])
end, constraint = function(p)
  return { (p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2 - l1 ^ 2) / 2, (p[4] ^ 2 + p[5] ^ 2 + p[6] ^ 2 - l2 ^ 2) / 2 }
end }
local function turn(t, p)
  local c, s = cos(t), sin(t)
  return { c * p[1] - s * p[2], s * p[1] + c * p[2], p[3], c * p[4] - s * p[5], s * p[4] + c * p[5], p[6] }
end
local Q, V = { 0.6, 0, -0.8, 0.27, 0.36, -0.6 }, { 0.4, 1.2, 0.3, -0.64, -0.02, -0.3 }
local plane = ambient:routh { action = turn, q = Q, v = V }
local y, w = plane:start(Q, V)
fine, path = try(plane, { q = y, v = w, steps = 1000, project = true }, 0.02, "gauss(1)")
ok(fine and path:drift("energy").largest < 0.05 and path:worst "constraint" < 1e-12, "goes on in ambient coordinates", tostring(path))

-- a pole of the chart, met head-on
local bob = dm.system { Q = dm.R(2), coordinates = { "azimuth", "angle" }, L = function(q, v)
  return (v[2] ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) / 2 + cos(q[2])
end }
fine, path = try(bob:routh { cyclic = { 1 }, mu = 1e-3 }, { q = { 1 }, v = { 0 }, t = 10 }, 0.1)
ok(not fine and path.reason == "collapse", "a pendulum that all but hits its pole", tostring(path))

-- what was wrong before there was a path
local kept = satellite:routh { cyclic = { 1 }, mu = 0.96 }
raises("reduced at mu = 0.96", function() kept:start({ 0, 1, 0 }, { 0.5, 0, 0 }) end)
raises("must have 2 entries", function() kept:solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 1 }, v = { 0, 0.2 }, steps = 1 } end)
raises("shape:start(q, v) gives", function() kept:solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 0, 1, 0 }, v = { 0.96, 0, 0.28 }, steps = 1 } end)
local where = select(2, pcall(function() local p = kept:solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 1 }, v = { 0, 0.2 }, steps = 1 }; return p end))
ok(tostring(where):find "test_routh_failures%.lua:%d+: ", "errors name the line of the script", tostring(where))

-- psi_mu with two solutions: the one near the guess (free rotor, r0 r1 sin psi = mu h)
local rotor = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end }
local spun = rotor:routh { action = function(t, p) return { cos(t) * p[1] - sin(t) * p[2], sin(t) * p[1] + cos(t) * p[2], p[3] } end,
  section = function(z) return { z[1], 0, z[2] } end, mu = 0.5 }
local D = spun:discrete(dm.discrete_lagrangian(rotor, { rule = "midpoint", h = 1 }))
near(D:psi({ 1, 0 }, { 1, 0 })[1], math.asin(0.5), 1e-15, "psi_mu with two solutions: that of small steps")
near(D:psi({ 1, 0 }, { 1, 0 }, 2.5)[1], math.pi - math.asin(0.5), 1e-15, "or that near the guess")
raises("too long", function() spun:at_momentum(5):discrete(dm.discrete_lagrangian(rotor, { rule = "midpoint", h = 1 })):psi({ 1, 0 }, { 1, 0 }) end)

-- two oscillators on R^4 reduced by both turns: the second comes down to r = 0.395, below the value of a slice through the start
local both = dm.system { Q = dm.R(4), L = function(q, v)
  local a, b = q[1] ^ 2 + q[2] ^ 2, q[3] ^ 2 + q[4] ^ 2
  return v:dot(v) / 2 - a / 2 - b - a * b
end }
local function turns(t, p)
  local c, s, C, S = cos(t[1]), sin(t[1]), cos(t[2]), sin(t[2])
  return { c * p[1] - s * p[2], s * p[1] + c * p[2], C * p[3] - S * p[4], S * p[3] + C * p[4] }
end
local q0, v0 = { 1, .2, .4, .7 }, { .1, .3, .6, -.5 }
local full = both:solver({ rule = "gauss(6)", h = 0.02 }):run { q = q0, v = v0, steps = 100 }
local rounded = both:routh { action = turns, dimension = 2, q = q0, v = v0 }
local x0, u0, theta0 = rounded:start(q0, v0)
near((x0 - dm.vector { sqrt(1.04), sqrt(0.65) }):norm(), 0, 1e-14, "the slice that is found has the radii as its shape")
near(theta0:norm(), 0, 1e-14, "with theta = 0 at the start")
for rule, bar in pairs { ["gauss(6)"] = 1e-13, ["gauss(2)"] = 1e-5, ["lobatto(3)"] = 1e-5, midpoint = 1e-2 } do
  local apart = dm.compare(full, rounded:solver({ rule = rule, h = 0.02 }):run({ q = x0, v = u0, steps = 100 }):reconstruct()).worst
  ok(apart < bar, rule .. ": and back is the path of the start itself, below the radius that was its coordinate", apart)
end
near(rounded:mass({ 0.3, 0.2 }, { 0, 0 })[2][2], 1, 1e-14, "its mass is that of a radius")
local function screw(t, p) return { cos(t[1]) * p[1] - sin(t[1]) * p[2], sin(t[1]) * p[1] + cos(t[1]) * p[2], p[3] + t[2] } end
local well = dm.system { Q = dm.R(3), L = function(p, w) return w:dot(w) / 2 - (p[1] ^ 2 + p[2] ^ 2) / 2 end }
local wound = well:routh { action = screw, dimension = 2, q = { .3, .4, 5 }, v = { .1, .2, .3 } }
near(wound:start({ .3, .4, 5 }, { .1, .2, .3 })[1], 0.5, 1e-14, "a screw leaves the radius")
near((wound:lift({ 0.5 }, { 0.22 }) - dm.vector { .3, .4, 5 }):norm(), 0, 1e-14, "over the start")
local free = dm.system { Q = dm.R(2), L = function(p, w) return w:dot(w) / p:dot(p) / 2 end }
local grown = free:routh { action = function(t, p) return { math.exp(t) * p[1], math.exp(t) * p[2] } end, q = { .3, .8 }, v = { .1, .2 } }
near(grown:start({ .3, .8 }, { .1, .2 })[1], 0.3, 1e-14, "growth never comes to 0: its slice goes through the start")

-- a section that stays at q3 = 0.4 has no points there: told, never stepped over, whatever rows are kept
local cut = both:routh { action = turns, dimension = 2, section = function(z) return { z[1], .2, .4, z[2] } end, q = q0, v = v0 }
local xc, uc = cut:start(q0, v0)
for _, rule in ipairs { "gauss(5)", "gauss(2)", "lobatto(3)", "midpoint", "verlet" } do
  for _, every in ipairs { 1, 25 } do
    fine, path = try(cut, { q = xc, v = uc, steps = 100, every = every }, 0.02, rule)
    ok(not fine and path.reason == "pole" and tostring(path):find("'x2'", 1, true) and tostring(path):find("another section", 1, true),
      ("%s, every %d: a pole of the section"):format(rule, every), tostring(path))
    ok(not fine and path.path.t[#path.path] < 0.7, "with the path before it", tostring(path))
  end
end
-- r = 1 is where the path of that section is safe
local safe = both:solver({ rule = "gauss(5)", h = 0.02 }):run { q = q0, v = v0, steps = 25 }
near(dm.compare(safe, cut:solver({ rule = "gauss(5)", h = 0.02 }):run({ q = xc, v = uc, steps = 25 }):reconstruct()).worst, 0, 1e-6, "up to there it is right")

-- steps that do not end at the wall name it, and rows that are far apart hide nothing
for rule, case in pairs { ["gauss(1)"] = { 0.02, 0.3 }, ["lobatto(3)"] = { 0.03, 0.1 }, ["gauss(2)"] = { 0.01, 0.3 } } do
  for _, every in ipairs { 1, 10 } do
    local given = start(case[1])
    given.every = every
    fine, path = try(satellite:routh { cyclic = { 1 }, mu = case[1] }, given, case[2], rule)
    ok(not fine and path.reason == "collapse", ("%s, mu = %g, every %d: a wall that is not resolved"):format(rule, case[1], every), tostring(path))
  end
end

-- no symmetry: said at a point of Q
local function round(t, p) return { cos(t) * p[1] - sin(t) * p[2], sin(t) * p[1] + cos(t) * p[2], p[3] } end
local lame = dm.system { Q = dm.R(3), L = function(p, w) return w:dot(w) / 2 - p[1] ^ 2 end }
local told = select(2, pcall(lame.routh, lame, { action = round, section = function(z) return { z[1], 0, z[2] } end, mu = 1 }))
local change, a, b = tostring(told):match "not invariant under the action: it changes by (%S+) along 'theta' at q = {(%S+), (%S+),"
near(tonumber(change), 2 * tonumber(a) * tonumber(b), 1e-5, "dL/dtheta = 2 q1 q2 at the point that is named")

-- a wall in front of 1/r, left by the first step that meets it: energies behind it are a million times those before
do
  local fall = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }:routh { mu = 0.2 }
  local told = 0
  for _, every in ipairs { 1, 50 } do
    local fine, failure = pcall(function() return fall:solver({ rule = "verlet", h = 0.02 }):run { q = { 1 }, v = { -0.3 }, t = 20, every = every } end)
    told = told + (not fine and failure.code == "collapse" and #failure.path >= 1 and 1 or 0)
  end
  tap.ok(told == 2, "a run that has lost its energy at a wall is told, however large it is behind", told)
  local path = fall:solver({ rule = "verlet", h = 0.001 }):run { q = { 1 }, v = { -0.3 }, t = 20, every = 50 }
  tap.ok(path:drift("energy").largest < 0.5, "and not one that dips in the bounce alone", path:drift("energy").largest)
end

tap.done()
