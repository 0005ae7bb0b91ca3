-- spheres: systems on them, and exp and log, the geodesics from a point
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin, pi = math.cos, math.sin, math.pi

---- a system on the sphere ----

local pendulum = dm.system { Q = dm.S(2), L = function(q, v) return v:dot(v) / 2 - 9.81 * q[3] end }
local path = pendulum:solver { rule = "rattle", h = 0.01 }:run {
  q = { 1, 0, 0 }, v = { 0, 1, 0 }, steps = 200 }
ok(path:worst "constraint" < 1e-13, "a system on S(2) stays there", path:worst "constraint")
near(path:momentum(dm.SO(2))[201], 1, 1e-13, "and keeps what turns about the vertical")

-- spheres among other coordinates, with a constraint of the user's: two spherical pendula on a
-- cart; a bead on a ring held by a slide
local pendula = dm.system { Q = dm.product(dm.S(2), dm.R(1), dm.S(2)), L = function(q, v)
  local a, b = v:slice(1, 3), v:slice(5, 7)
  a[1], b[1] = a[1] + v[4], b[1] + v[4]
  return a:dot(a) / 2 + b:dot(b) / 2 + v[4] ^ 2 / 2 - 9.81 * (q[3] + q[7])
end }
ok(pendula.Q == dm.R(7) and pendula:structure().constraints == 2,
  "two spheres and a line are R^7 with two constraints")
path = pendula:solver { rule = "rattle", h = 0.005 }:run {
  q = { 0, 1, 0, 0.3, 0.6, 0, -0.8 }, v = { 0.5, 0, 0, 0, 0, 1, 0 }, steps = 400 }
ok(path:worst "constraint" < 1e-13, "which are kept", path:worst "constraint")
near(path.p[401][4], path.p[1][4], 1e-13, "as is the momentum along the line")
local held = dm.system { Q = dm.product(dm.S(1), dm.R(1)),
  L = function(q, v) return v:dot(v) / 2 end, constraint = function(q) return q[1] - q[3] end }
path = held:solver { rule = "rattle", h = 0.01 }:run {
  q = { 0, 1, 0 }, v = { 1, 0, 1 }, steps = 300 }
ok(held:structure().constraints == 2 and path:worst "constraint" < 1e-13,
  "a constraint of the user's joins", path:worst "constraint")
-- the same in the angle: L = (1 + sin^2) w^2 / 2 with x = cos(angle) from pi/2 on
local by_angle = dm.system { Q = dm.T(1),
  L = function(q, v) return (1 + sin(q[1]) ^ 2) * v[1] ^ 2 / 2 end }
local reference = by_angle:solver { rule = "gauss(4)", h = 0.01 }:run {
  q = { pi / 2 }, v = { -1 }, steps = 300 }
near(path.q[301][1], cos(reference.q[301][1]), 2e-4, "and moves as in the angle")
local fine_path = held:solver { rule = "rattle", h = 0.005 }:run {
  q = { 0, 1, 0 }, v = { 1, 0, 1 }, steps = 600 }
near((path.q[301][1] - cos(reference.q[301][1])) / (fine_path.q[601][1] - cos(reference.q[301][1])),
  4, 0.05, "to second order")

---- great circles: exp and log of a sphere, from a point ----

for n = 1, 5 do
  local S, stream, worst, apart, back = dm.S(n), dm.random(40 + n), 0, 0, 0
  for i = 1, 40 do
    local z, y = S:random(stream, 2 * i), S:random(stream, 2 * i + 1)
    local w = S:log(z, y)
    worst = math.max(worst, (S:exp(z, w) - y):norm(), math.abs(w:dot(z)))
    apart = math.max(apart, math.abs(w:norm() - S:distance(z, y)))
    local u = w * ((0.1 + 3 * i / 40) / w:norm())
    back = math.max(back, (S:log(z, S:exp(z, u)) - u):norm())
  end
  ok(worst < 2e-15 and apart < 2e-15,
    ("S(%d): exp(z, log(z, y)) = y, |log| is the distance"):format(n), worst .. " " .. apart)
  ok(back < 2e-14, ("S(%d): log(z, exp(z, w)) = w for |w| from 0.1 to 3.1"):format(n), back)
end
local S2, north = dm.S(2), dm.vector { 0, 0, 1 }
ok(S2:exp(dm.vector { 0.6, 0.8, 0 }, { 8e-321, -6e-321, 1e-320 })[3] == 1e-320, "below the least normal number")
near((S2:exp(north, { math.pi / 2, 0, 0 }) - dm.vector { 1, 0, 0 }):norm(), 0, 1e-15,
  "a quarter of a meridian")
near(S2:log(north, { 3e-9, 4e-9, 1 }):norm(), 5e-9, 1e-23, "log has all digits near the point")
near(S2:log(north, { 3e-9, 0, -1 })[1], math.pi - 3e-9, 1e-15, "and near the antipode")
ok(S2:log(north, north):norm() == 0 and (S2:exp(north, { 0, 0, 0 }) - north):norm() == 0,
  "the point itself")
-- unit quaternions are S(3): exp from 1 is that of SO(3) at half the angle
local turned = dm.SO(3):flat(dm.SO(3):exp { 0.6, -0.4, 1.1 })
near((dm.S(3):exp({ 1, 0, 0, 0 }, { 0, 0.3, -0.2, 0.55 }) - dm.vector(turned)):norm(), 0, 4e-16,
  "exp of S(3) at 1 is that of quaternions")
-- derivatives at w = 0 and at y = z: the projections to the tangent plane
local slope = dm.derivative(function(w) return S2:exp(north, w - north * w[3]) end, 3) { 0, 0, 0 }
local inverse = dm.derivative(function(y) return S2:log(north, y) end, 3) { 0, 0, 1 }
ok(slope[1][1] == 1 and slope[2][2] == 1 and slope[1][2] == 0 and slope[3][1] == 0,
  "d exp/dw at 0 is the identity of the tangent plane", tostring(slope))
ok(inverse[1][1] == 1 and inverse[2][2] == 1 and inverse[1][2] == 0 and inverse[3][1] == 0,
  "and so is d log/dy at y = z", tostring(inverse))
local far = dm.derivative(function(y) return S2:log(north, y) end, 3) { 0.6, 0, -0.8 }
-- rotations about the axis turn w with y: the slope along (0, 1, 0) is theta/sin theta
near(far[2][2], math.acos(-0.8) / 0.6, 1e-14, "d log/dy across the circle, beyond a quarter")
-- free motion on the sphere, stepped in ambient coordinates with a constraint, follows it: order 2
local free, off = dm.system { Q = S2, L = function(_, v) return v:dot(v) / 2 end }, {}
for k, h in ipairs { 0.02, 0.01 } do
  local last = free:solver({ rule = "rattle", h = h }):run {
    q = { 0, 0, 1 }, v = { 1.2, -0.5, 0 }, t = 2 }
  off[k] = (last.q[#last] - S2:exp(north, { 2.4, -1, 0 })):norm()
end
ok(off[2] < 1e-4 and math.abs(off[1] / off[2] - 4) < 0.05,
  "free motion on the sphere is a geodesic", off[1] .. " " .. off[2])
local mixed = dm.product(S2, dm.R(1), dm.SO(3))
local from, to = mixed:random(dm.random(7), 1), mixed:random(dm.random(7), 2)
local way = mixed:log(from, to)
near(mixed:distance(mixed:exp(from, way), to), 0, 4e-15, "products with a sphere: factor by factor")
raises("no tangent vector at the point", function() return S2:exp(north, { 1, 0, 0.1 }) end)
raises("the tangent vector is not finite", function() return S2:exp(north, { 0 / 0, 0, 0 }) end)
near(S2:exp(north, { 1e200, 0, 0 }):norm(), 1, 1e-15, "however often it goes round")
raises("the points are antipodes", function() return S2:log(north, { 0, 0, -1 }) end)
raises("takes two arguments, a point and a second point", function() return S2:log(north) end)
raises("must have 3 entries", function() return S2:exp(north, { 1, 0 }) end)
raises("a list of 3, one for each factor", function() return mixed:exp(from, { 1, 2 }) end)
tap.done()
