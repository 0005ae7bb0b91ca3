-- Routh reduction: what a shape shows, that its paths are the paths below, reconstruction, phases, misuse
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sqrt, sin, cos, pi = math.abs, math.sqrt, math.sin, math.cos, math.pi

local satellite = models.satellite(0.05)
local pendulum = models.pendulum()

-- reduced and reconstructed = unreduced, for every kind of stage rule (spec 3.3)
local kept = satellite:routh { cyclic = { "theta" }, mu = 0.96 }
local rules = { "gauss(1)", "gauss(2)", "gauss(3)", "lobatto(2)", "lobatto(3)", "lobatto(4)", "galerkin(3, lobatto(3))", "midpoint" }
for _, rule in ipairs(rules) do
  local a = satellite:solver({ rule = rule, h = 0.3 }):run { q = models.orbit.q, v = models.orbit.v, steps = 1000 }
  local b = kept:solver({ rule = rule, h = 0.3 }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = 1000 }:reconstruct()
  ok(models.apart(a, b) < 1e-11, rule .. ": satellite reduced and back = unreduced, 1000 steps", models.apart(a, b))
  near(b:energy()[1001], a:energy()[1001], 1e-12, "with its energy")
end
for name, s in pairs { ["away from the poles"] = models.safe, ["near a pole"] = models.near_pole } do
  local shape = pendulum:routh { cyclic = { 1 }, q = s.q, v = s.v }
  local x, u, theta = shape:start(s.q, s.v)
  for _, rule in ipairs { "gauss(1)", "gauss(2)", "lobatto(3)" } do
    local a = pendulum:solver({ rule = rule, h = 0.01 }):run { q = s.q, v = s.v, steps = 200 }
    local b = shape:solver({ rule = "rsprk(" .. rule .. ")", h = 0.01 }):run { q = x, v = u, steps = 200 }:reconstruct { theta = theta }
    ok(models.apart(a, b) < 1e-12, rule .. ": double spherical pendulum " .. name .. ", 200 steps", models.apart(a, b))
  end
end

-- closed forms of the double spherical pendulum (spec 2.2), with m2 ~= 1
local m1, m2 = models.m1, models.m2
local shape = pendulum:routh { cyclic = { "theta1" }, mu = 3.1095 }
local worst, curl = 0, 0
for k = 1, 10 do
  local r1, r2, phi = 0.1 + 0.08 * k, 0.7 - 0.06 * k, 0.6 * k - 2
  local c, s = cos(phi), sin(phi)
  local I = m1 * r1 ^ 2 + m2 * (r1 ^ 2 + r2 ^ 2 + 2 * r1 * r2 * c)
  local A = shape:connection { r1, r2, phi }
  worst = math.max(worst, abs(shape:locked_inertia { r1, r2, phi }[1][1] - I), abs(A[1][1] + m2 * r2 * s / I),
    abs(A[1][2] - m2 * r1 * s / I), abs(A[1][3] - m2 * (r2 ^ 2 + r1 * r2 * c) / I))
  local beta, factor = shape:curvature { r1, r2, phi }, 2 * 3.1095 * m1 * m2 * r1 * r2 / I ^ 2
  curl = math.max(curl, abs(beta[3][1] - factor * r2), abs(beta[3][2] + factor * r1), abs(beta[1][2]), abs(beta[1][3] + factor * r2))
end
ok(worst < 1e-14, "locked inertia and connection of the double spherical pendulum", worst)
ok(curl < 1e-12, "its magnetic form is d(mu A)", curl)

-- statics at the start near a pole (spec 4)
local s = models.near_pole
local x, u = shape:start(s.q, s.v)
near(shape:amended_potential(x), -33.9014220636663008, 1e-12, "amended potential")
near(shape:routhian(x, u), 32.8185, 1e-12, "classical Routhian")
near(shape:routhian(x, u, 0, "magnetic"), 34.3203441273326015, 1e-12, "Routhian of the magnetic form")
local y = shape:legendre(x, u)
near((y - dm.vector { 0.89, 1.2, 0.6075 }):norm(), 0, 1e-14, "canonical momentum")
near((shape:magnetic_momentum(x, y) - dm.vector { 1.70918770581778266, 0.107749725576289791, -0.221927552140504940 }):norm(), 0, 1e-14,
  "momentum of the magnetic form")
near(shape:energy(x, u), pendulum:energy(s.q, s.v), 1e-13, "the energy is the unreduced one")
local q, v = shape:lift(x, u)
near((q - dm.vector(s.q)):norm() + (v - dm.vector(s.v)):norm(), 0, 1e-14, "start and lift are inverse")

-- a group of two dimensions (spec 2.4)
local two = models.two_angles()
local both = two:routh { cyclic = { 1, 2 }, mu = { 0.7, -0.4 } }
local path = both:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1, 0.5 }, v = { 0, 0.3 }, steps = 10 }
local back = path:reconstruct { theta = { 0, 0 } }
near((back.q[11] - dm.vector { 0.473279653142949097, -0.584847844947703463, 0.488925598259935743, 0.29519757847592107 }):norm(), 0, 1e-14,
  "two angles: state after 10 steps")
near((both:magnetic_momentum(path.q[11], path.p[11]) - dm.vector { -0.96585190760508267, -0.574182177215666971 }):norm(), 0, 1e-14,
  "and its momentum")
near(both:curvature({ 1, 0.5 })[1][2], 0.35 - 0.16 * 0.5, 1e-15, "curvature of two components together")
near(both:curvature({ 1, 0.5 }, 0, 2)[1][2], 0.4 * 0.5, 1e-15, "and of the second alone")
local stage = two:routh { cyclic = { 2 }, mu = -0.4 }:routh { cyclic = { 1 }, mu = 0.7 }
near(stage:routhian({ 1, 0.5 }, { 0, 0.3 }), both:routhian({ 1, 0.5 }, { 0, 0.3 }), 1e-14, "reduction by stages is reduction")

-- charged particle (spec 2.3): Gauss of one stage turns the velocity by the Cayley angle
local charged = models.particle(function(a, b) return { -b, a } end):routh { cyclic = { 1 }, mu = 1.5 }
local ring = charged:solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 0, 0 }, v = { 1, 0 }, steps = 10 }
local e = ring:velocity()[11]
near(e[1], cos(20 * math.atan(0.15)), 1e-13, "Cayley angle: cosine"); near(e[2], -sin(20 * math.atan(0.15)), 1e-13, "and sine")
local landau = models.particle(function(a) return { 0, 2 * a } end):routh { cyclic = { 1 }, mu = 1.5 }
ok(models.apart(ring, landau:solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 0, 0 }, v = { 1, 0 }, steps = 10 }) < 1e-14,
  "a gauge of degree 2 changes no point")

-- the connection does not matter: another one gives the same points, and its own magnetic form (spec 3.8)
local other = pendulum:routh { cyclic = { 1 }, mu = 3.1095, connection = function(z) return { z[2] * z[3], cos(z[3]), z[1] } end }
local one, another = shape:solver { rule = "gauss(2)", h = 0.01 }, other:solver { rule = "gauss(2)", h = 0.01 }
ok(models.apart(one:run { q = x, v = u, steps = 50 }, another:run { q = x, v = u, steps = 50 }) < 1e-15, "points do not depend on the connection")
near(other:curvature(x)[1][2], 3.1095 * (0 - x[3]), 1e-12, "a connection that is given has a curvature of its own")

-- phases, and the holonomy of a loop of shapes (spec 3.15)
local still = pendulum:routh { cyclic = { 1 }, mu = 0 }
local loop = function(t)
  local w = 2 * pi * t
  return { 0.5 + 0.1 * cos(w), 0.5 + 0.05 * sin(2 * w), 1 + 0.3 * sin(w) }
end
near(still:holonomy(loop)[1], 0.0249664851943495, 1e-15, "holonomy of a loop")
local run = shape:solver({ rule = "gauss(2)", h = 0.02 }):run { q = x, v = u, steps = 80, every = 7 }
local phases = run:phases()
near(phases.total[#run][1], run:reconstruct().q[#run][1], 1e-13, "phases add up to the group variable")
ok(abs(phases.geometric[#run][1]) > 0.05, "and the geometric one is not nothing", phases.geometric[#run][1])

-- along a line of shapes, for plots
local line = shape:slice("curvature", { from = { 0.2, 0.3, 0 }, to = { 0.6, 0.3, 1 }, points = 5 })
ok(#line == 3 and #line[2].x == 5 and line[2].name == "curvature r1, phi", "a slice has a series for each entry", line[2].name)
near(line[2].y[3], shape:curvature({ 0.4, 0.3, 0.5 })[1][3], 1e-15, "of its values")
near(shape:slice("amended_potential", { from = { 0.2, 0.3, 0 }, to = { 0.6, 0.3, 1 }, points = 3 })[1].y[2], shape:amended_potential { 0.4, 0.3, 0.5 }, 1e-13, "of any kind")
raises("slice: give", function() shape:slice("mass", {}) end)
raises("option 'to'", function() shape:slice("connection", { from = { 1, 1, 1 }, to = { 1 } }) end)

-- rows at any times; a chaotic orbit over many Lyapunov times follows its own rows
local whole = one:run { q = x, v = u, steps = 60 }:reconstruct()
local some = one:run { q = x, v = u, at = { 0.1, 0.25, 0.6 } }:reconstruct()
near(some.q[3][1], whole.q[61][1] - whole.q[11][1], 1e-13, "rows at given times, from the first of them")
local free = pendulum:routh { cyclic = { 1 }, q = models.safe.q, v = models.safe.v }
local long = free:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 0.6, 0.45, models.safe.q[4] }, v = { 0, 0, models.safe.v[4] }, steps = 2000, every = 5 }
local around = long:reconstruct()
ok(models.apart(long, long) == 0 and #around == #long and abs(around:drift "theta1".mean) > 0, "a long run is reconstructed", #around)

-- a chaotic shape: two runs part company, reconstruction stays with the rows it was given
local plate = dm.system { Q = dm.R(4), L = function(z, w)
  local a, b, c = z[2], z[3], z[4]
  return w[1] ^ 2 * (1 + cos(a) ^ 2 * 0.5) / 2 + (w[2] + 0.4 * w[1]) ^ 2 / 2 + w[3] ^ 2 / 2 + 0.8 * w[2] * w[3] * cos(a - b)
    + (w[4] + 0.3 * w[1] * sin(b)) ^ 2 / 2 + 4 * cos(a) + 2 * cos(b) + 3 * cos(c - a)
end }
local spin = plate:routh { q = { 0, 2.5, 1.5, 2 }, v = { 0.5, 0.3, -0.2, 0.1 } }
local wild = spin:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 2.5, 1.5, 2 }, v = { 0.3, -0.2, 0.1 }, steps = 4000 }
local kept_to, D = wild:reconstruct(), spin:discrete { rule = "gauss(2)", h = 0.05 }
worst = 0
for k = 1, 4000, 190 do worst = math.max(worst, abs(D:psi(wild.q[k], wild.q[k + 1])[1] - (kept_to.q[k + 1][1] - kept_to.q[k][1]))) end
ok(worst < 1e-11, "a chaotic run: the angle between its rows is psi_mu", worst)
raises("is the motion chaotic", function()
  spin:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = { 2.5, 1.5, 2 }, v = { 0.3, -0.2, 0.1 }, steps = 8000, every = 1000 }):reconstruct()
end)
-- rows between steps: with the start before them the steps are known, without it they are not
local function between(at)
  return kept:solver({ rule = "gauss(2)", h = 0.05 }):run({ q = { 1, 0 }, v = { 0, 0.28 }, at = at }):reconstruct()
end
local whole = satellite:solver({ rule = "gauss(2)", h = 0.05 }):run { q = models.orbit.q, v = models.orbit.v, at = { 0, 0.111, 0.777 } }
ok((between { 0, 0.111, 0.777 }.q[3] - whole.q[3]):norm() < 1e-13, "rows between steps are reconstructed", tostring(whole.q[3]))
raises("let 'at' begin with the start", between, { 0.111, 0.777 })

-- rules that are explicit on what is left
local verlet = kept:solver({ rule = "verlet", h = 0.01 }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = 300 }:reconstruct()
local fine = satellite:solver({ rule = "gauss(4)", h = 0.05 }):run { q = models.orbit.q, v = models.orbit.v, steps = 60 }
near(verlet.q[301][1], fine.q[61][1], 2e-4, "an explicit rule on the shape, with the angle")

-- found from the graph; another momentum
local found = satellite:routh { q = models.orbit.q, v = models.orbit.v }
near(found:reduction().mu[1], 0.96, 0, "cyclic coordinates and momentum are found")
near(found:at_momentum(1.2):amended_potential { 1, 0 }, -1 - 0.025 + 0.72, 1e-14, "the same at another momentum")
local scale = 1
local rod = dm.system { Q = dm.R(2), L = function(_, w) return scale * w[1] ^ 2 / 2 + w[2] ^ 2 / 2 end }:routh { cyclic = { 1 }, mu = 2 }
near(rod:amended_potential { 0 }, 2, 1e-15, "an upvalue"); scale = 4
near(rod:amended_potential { 0 }, 0.5, 1e-15, "that changes is seen"); near(rod:locked_inertia({ 0 })[1][1], 4, 0, "everywhere")

-- an action in ambient coordinates, with a section and with one that is found
local J2 = 0.05
local cartesian = dm.system { Q = dm.R(3), L = function(p, w)
  local rho = p:norm()
  return w:dot(w) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * p[3] ^ 2 / rho ^ 2 - 0.5)
end }
local function turn(t, p) return { cos(t) * p[1] - sin(t) * p[2], sin(t) * p[1] + cos(t) * p[2], p[3] } end
local by_action = cartesian:routh { action = turn, section = function(z) return { z[1], 0, z[2] } end, mu = 0.96 }
local by_slice = cartesian:routh { action = turn, q = { 0, 1, 0 }, v = { -0.96, 0, 0.28 } }
for name, reduced in pairs { ["given"] = by_action, ["found"] = by_slice } do
  near(reduced:routhian({ 0.9, 0.2 }, { 0.1, 0.3 }), kept:routhian({ 0.9, 0.2 }, { 0.1, 0.3 }), 1e-15, "section " .. name)
end
local there = by_action:solver({ rule = "gauss(2)", h = 0.3 }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = 10 }:reconstruct()
near(there.q[11][1], 0.846010922264635293 * cos(3.48010875466336101), 1e-14, "back in ambient coordinates")
near(there.p[11][1] * there.q[11][2] - there.p[11][2] * there.q[11][1], -0.96, 1e-14, "with the momentum")

-- L that is not quadratic in the velocity of the group: eliminated by an implicit function (relativistic motion about a centre)
local fast = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(p, w)
  return -sqrt(1 - w[1] ^ 2 - p[1] ^ 2 * w[2] ^ 2) + 0.1 / p[1]
end }
local radial = fast:routh { q = { 1, 0 }, v = { 0.05, 0.3 } }
local l = radial:reduction().mu[1]
near(radial:routhian({ 1.1 }, { 0.2 }), -sqrt((1 - 0.04) * (1 + l * l / 1.21)) + 0.1 / 1.1, 1e-15, "implicit Routhian: closed form")
near(radial:amended_potential { 1.1 }, sqrt(1 + l * l / 1.21) - 0.1 / 1.1, 1e-15, "and amended potential")
local whole_orbit = fast:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1, 0 }, v = { 0.05, 0.3 }, steps = 100 }
local half = radial:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1 }, v = { 0.05 }, steps = 100 }
ok(models.apart(whole_orbit, half:reconstruct()) < 1e-13, "reduced and back = unreduced", models.apart(whole_orbit, half:reconstruct()))
ok(radial:structure().autonomous, "it does not depend on time")

-- misuse
raises("L is not invariant under translations of 'r'", function() satellite:routh { cyclic = { "r" }, mu = 1 } end)
raises("no coordinate 's'", function() satellite:routh { cyclic = { "s" }, mu = 1 } end)
raises("stands there twice", function() satellite:routh { cyclic = { 1, "theta" }, mu = 1 } end)
raises("option 'mu'", function() satellite:routh { cyclic = { 1 } } end)
raises("one for each dimension", function() satellite:routh { cyclic = { 1 }, mu = { 1, 2 } } end)
raises("finite number", function() satellite:routh { cyclic = { 1 }, mu = 0 / 0 } end)
raises("unknown option 'cyclc'", function() satellite:routh { cyclc = { 1 }, mu = 1 } end)
raises("system:routh: takes a table", function() satellite:routh(1) end)
raises("option 'connection' must be a function", function() satellite:routh { cyclic = { 1 }, mu = 1, connection = 3 } end)
raises("1 row of 2 numbers", function() satellite:routh { cyclic = { 1 }, mu = 1, connection = function() return { { 1, 2, 3 } } end } end)
raises("'action' must return a point of Q: 3 numbers (got 2)", function()
  cartesian:routh { action = function(_, q) return { q[1], q[2] } end, mu = 1 }
end)
raises("'section' must return a point of Q: 3 numbers (got 2)", function()
  cartesian:routh { action = function(_, q) return q end, section = function(x) return x end, mu = 1 }
end)
raises("at_momentum takes", function() kept:at_momentum() end)
raises("locked inertia is singular", function() kept:lift({ 0, 1 }, { 0, 0 }) end)
raises("path:reconstruct: takes a table of options (got 1)", function()
  kept:solver({ rule = "gauss(1)", h = 0.1 }):run({ q = { 1, 0 }, v = { 0, 0.2 }, steps = 1 }):reconstruct(1)
end)
raises("none is cyclic", function() cartesian:routh { mu = 1 } end)
raises("reduced system", function() satellite:connection { 1, 2, 3 } end)
raises("2 numbers", function() kept:connection { 1 } end)
raises("path of a reduced system", function() fine:reconstruct() end)
raises("reduced at mu = 0.96", function() kept:start({ 0, 1, 0 }, { 0.9, 0, 0 }) end)
raises("steps a reduced system", function() satellite:solver { rule = "rsprk(gauss(2))", h = 0.1 } end)
raises("known rules", function() kept:solver { rule = "rsprk(gaus(2))", h = 0.1 } end)
raises("abelian", function() cartesian:routh { action = function(t, p) return { p[1] * (1 + t), p[2], p[3] } end, at = { 1, 0, 0 }, mu = 1 } end)
raises("isotropy group of dimension 1", function()
  local act = dm.action { group = dm.SO(3), on = dm.R(3), map = function(R, p) return R * p end }
  dm.system { Q = dm.R(3), L = function(p, w) return w:dot(w) / 2 - p:norm() end }:routh { action = act, mu = 1 }
end)
local driven = dm.system { Q = dm.R(2), L = function(p, w, t) return (1 + p[2] ^ 2 + 0.3 * sin(t)) * w[1] ^ 2 / 2 + w[2] ^ 2 / 2 - p[2] ^ 2 * (1 + 0.2 * cos(t)) + 0.4 * t * w[1] * p[2] end }
local pushed = driven:routh { mu = (2 + 0.3 * sin(0.5)) * 0.3 + 0.4 * 0.5 }
local above = driven:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 0, 1 }, v = { 0.3, 0.2 }, steps = 50, t0 = 0.5 }
local beneath = pushed:solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 1 }, v = { 0.2 }, steps = 50, t0 = 0.5 }
ok(models.apart(above, beneath:reconstruct()) < 1e-14, "L that depends on time", models.apart(above, beneath:reconstruct()))
raises("depends on the time", function() pushed:rsprk { rule = "gauss(1)", h = 0.1 } end)
local many = dm.system { Q = dm.R(21), L = function(p, w)  -- a sum that stays a loop
  local x, u = {}, {}
  for i = 1, 20 do x[i], u[i] = p[i + 1], w[i + 1] end
  return dm.sum_over(dm.vector(x), dm.vector(u), function(a, b) return b ^ 2 / 2 - a ^ 2 / 2 - a ^ 4 / 8 end) + w[1] ^ 2 / 2 * (1 + p[2] ^ 2)
end }
near(many:routh({ cyclic = { 1 }, mu = 0.5 }):amended_potential(dm.vector { 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }), 0.625 + 0.0625, 1e-15, "sums over bodies")
raises("singular", function()
  dm.system { Q = dm.R(2), L = function(_, w) return w[2] ^ 2 / 2 end }:routh { cyclic = { 1 }, mu = 1 }
end)
raises("rolling", function()
  dm.system { Q = dm.R(2), L = function(_, w) return w:dot(w) / 2 end, rolling = function(_, w) return w[1] end }:routh { cyclic = { 1 }, mu = 1 }
end)
raises("component along the group", function()
  dm.system { Q = dm.R(2), L = function(_, w) return w:dot(w) / 2 end, force = function(_, w) return { -w[1], 0 } end }:routh { cyclic = { 1 }, mu = 1 }
end)
raises("not invariant", function()
  dm.system { Q = dm.R(2), L = function(_, w) return w:dot(w) / 2 end, constraint = function(p) return p[2] - sin(p[1]) end }:routh { cyclic = { 1 }, mu = 1 }
end)
raises("does not close", function() still:holonomy(function(t) return { 0.5 + t, 0.5, 1 } end) end)

tap.done()
