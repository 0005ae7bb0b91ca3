-- discrete diffeomorphisms and the pair groupoid (Leok 3.13; P29, P30)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, sqrt = math.sin, math.sqrt
local function single(p) return dm.mesh { points = p, simplices = { { 1, 2, 3 } } } end
local function cochain(K, k, shift)
  local x = {}
  for i = 1, K:count(k) do x[i] = sin(7 * i + i * i + (shift or 0)) end
  return K:form(k, x)
end

-- naturality: the worked numbers of the specification, then meshes of dimension 1 to 3
local right, equal = single { { 0, 0 }, { 1, 0 }, { 0, 1 } }, single { { 0, 0 }, { 1, 0 }, { 0.5, sqrt(0.75) } }
local phi, a, b = dm.diffeo(right, equal), equal:form(1, { 1, 0, 2 }), equal:form(1, { 3, 1, -1 })
near(phi:pull(a:wedge(b))[1], -4 / 3, 1e-14, "f*(a ^ b)")
near(phi:pull(a):wedge(phi:pull(b))[1], -4 / 3, 1e-14, "f*a ^ f*b")
near(phi:pull(a):wedge(phi:pull(b), { rule = "metric" })[1], -7 / 8, 1e-14, "the metric wedge is not natural")
for _, case in ipairs {
  { dm.mesh { triangle = 4 }, dm.mesh { triangle = 4, map = function(x, y) return { x + 0.05 * sin(3 * y), y + 0.2 * x } end } },
  { dm.mesh { shells = { 3, 2 } }, dm.mesh { shells = { 3, 2 }, map = function(x, y, z) return { 2 * x + 0.1 * y, y + 0.1 * z, z } end } } } do
  local f = dm.diffeo(case[1], case[2])
  local n = case[1].dimension
  for k = 0, n do
    for l = 0, n - k do
      local u, v = cochain(case[2], k), cochain(case[2], l, 2)
      ok((f:pull(u:wedge(v)) - f:pull(u):wedge(f:pull(v))):max() < 1e-14, ("f* of a product, %d and %d"):format(k, l))
    end
    if k < n then
      local u = cochain(case[2], k)
      ok(f:pull(u:d()) == f:pull(u):d() and f:push(f:pull(u)) == u, "f* d = d f*, f_* f* = 1")
    end
  end
end

-- groups of maps: inverse, composition, mismatched ends
local K, L, N = dm.mesh { triangle = 3 }, dm.mesh { triangle = 3, map = function(x, y) return { x + 0.1 * y, y } end },
  dm.mesh { triangle = 3, map = function(x, y) return { 2 * x, y - 0.2 * x } end }
local f, g = dm.diffeo(K, L), dm.diffeo(L, N)
local u = cochain(N, 1)
ok(rawequal(g:compose(f).from, K) and rawequal(g:compose(f).to, N) and rawequal(f:compose(g).to, N), "the order that fits")
ok(g:compose(f):pull(u) == f:pull(g:pull(u)), "(g f)* = f* g*")
ok(rawequal(f:inverse().from, L) and rawequal(f:inverse():compose(f).to, K), "inverse")
ok((f:pair() * g:pair()) == g:compose(f):pair(), "composition is the product of the groupoid")
raises("cannot be composed", function() dm.diffeo(K, N):compose(g) end)

-- a shear: dual map, velocities, fields (worked numbers)
local start = single { { 0, 0 }, { 1, 0 }, { 0.5, 0.8 } }
local shear = dm.diffeo(start, function(t) return { { 0, 0 }, { 1, 0 }, { 0.5 + 0.8 * t, 0.8 } } end)
local c0, c1 = shear(0.5):dual()
near(c0[1][1], 0.5, 1e-15, "c(0).x") near(c0[1][2], 0.24375, 1e-15, "c(0).y")
near(c1[1][1], 0.5, 1e-15, "c(1/2).x") near(c1[1][2], 0.34375, 1e-15, "c(1/2).y is not the affine image")
local V = shear:dual_velocity(0.5)
near(V[1][1], 0, 1e-11, "dual velocity") near(V[1][2], 0.4, 1e-11, "of the centre")
local X = start:vector_field(function() return { 0, 1 } end, { on = "cells" })
local pushed = shear(0.5):push(X)
near(pushed[1][1], 0.5, 1e-15, "push-forward") near(pushed[1][2], 1, 1e-15, "of a field")
collectgarbage() -- the member is gone, its mesh lives on in the field
near(shear(0.5):pull(pushed)[1][1], 0, 1e-15, "and back")
-- exact velocities of points, differences of meshes: both of one rotation
local function rotated(t)
  local c, s, out = math.cos(t), math.sin(t), {}
  for i, p in ipairs { { 0, 0 }, { 1, 0 }, { 0.5, 0.8 } } do out[i] = { c * p[1] - s * p[2], s * p[1] + c * p[2] } end
  return out
end
local by_points, by_meshes = dm.diffeo(start, rotated), dm.diffeo(start, function(t) return single(rotated(t)) end)
for _, family in ipairs { by_points, by_meshes } do
  local v = family:spatial_velocity(0.3)
  local x = v.mesh:points()
  for i = 1, 3 do near(v[i][1], -x[i][2], 1e-11, "v = (-y, x)") near(v[i][2], x[i][1], 1e-11, "of a rotation") end
  ok(rawequal(family:material_velocity(0.3).mesh, start), "the material velocity lives on the first mesh")
end
-- how fast a motion is says neither t nor the points: differences of meshes find their step
for _, case in ipairs { { 1, 1000 }, { 1, 1e6 }, { 2000 * math.pi, 0 }, { 1e6, 10 }, { 1e-6, 0 }, { 0, 1 } } do
  local w, t = table.unpack(case)
  local swing = dm.diffeo(start, function(s)
    local x = math.sin(w * s)
    return single { { x, 0 }, { 1 + x, 0 }, { 0.5 + x, 0.8 } }
  end)
  local v, centre = swing:material_velocity(t), swing:dual_velocity(t)
  local expected = w * math.cos(w * t)
  near(v[2][1], expected, 1e-6 * w, "a swing of frequency " .. w .. " at t = " .. t)
  near(centre[1][1], expected, 1e-6 * w, "its centre")
end
-- linear interpolation to the mesh turned by pi collapses half-way
local back = dm.diffeo(start, function(t)
  return { { 0, 0 }, { 1 - 2 * t, 0 }, { 0.5 - t, 0.8 - 1.6 * t } } end)
raises("degenerate", function() back(0.5) end)
ok(back(0.4).to:volume(2)[1] > 0, "before it is a map")

-- surfaces in space: tangent vectors go to tangent vectors
local ball = dm.mesh { icosphere = 1 }
local egg = dm.diffeo(ball, dm.mesh { icosphere = 1, map = function(x, y, z) return { x, y, 2 * z } end })
local Y = ball:vector_field(function(x, y) return { -y, x, 0 } end, { on = "cells" })
local Z = egg:push(Y)
local tangent = Z.mesh:vector_field(Z.values, { on = "cells" })
near(tangent[5][1], Z[5][1], 1e-14, "tangent to") near(tangent[5][3], Z[5][3], 1e-14, "the image")
near(egg:pull(Z).values[3][1], Y.values[3][1], 1e-14, "and back")

-- refusals
raises("inverts cell {1, 2, 3}", function() dm.diffeo(right, single { { 0, 0 }, { 0, 1 }, { 1, 0 } }) end)
raises("inverts cell", function() dm.diffeo(K, dm.mesh { triangle = 3, map = function(x, y) return { -x, y } end }) end)
raises("not realizations of one complex", function() dm.diffeo(K, dm.mesh { triangle = 4 }) end)
raises("has no points", function() dm.diffeo(K, dm.mesh { hex_torus = 3 }) end)
raises("must be a mesh", function() dm.diffeo(K, 3) end)
raises("must be a mesh", function() dm.diffeo({}, K) end)
raises("take a member", function() shear:pull(a) end)
raises("does not depend on time", function() phi(1) end)
raises("another mesh", function() f:pull(cochain(K, 1)) end)
raises("fields on", function() f:push(K:vector_field(function() return { 1, 0 } end)) end)
raises("gives 2 points", function() dm.diffeo(start, function() return { { 0, 0 }, { 1, 0 } } end)(0) end)
raises("mesh or a list of points", function() dm.diffeo(start, function() return 1 end)(0) end)

-- the pair groupoid
local p, q, r = dm.pair(1, 2), dm.pair(2, 5), dm.pair(5, -1)
ok((p * q) * r == p * (q * r) and p * q == dm.pair(1, 5), "associative")
ok(p * p:inverse() == dm.pair(1, 1) and p:inverse() * p == dm.pair(2, 2) and (p * p:inverse()):is_identity(), "inverse, identities")
ok(dm.pair(1, 1) * p == p and p * dm.pair(2, 2) == p and not p:is_identity(), "units")
ok(dm.pair({ 1, { 2 } }, dm.vector { 3, 4 }) * dm.pair({ 3, 4 }, 0) == dm.pair({ 1, { 2 } }, 0), "lists and vectors")
local curve = dm.pair(1, 2, 5, -1)
ok(#curve == 3 and curve[2] == q and curve == p:join(q, r) and curve:product() == dm.pair(1, -1), "p-tuples")
ok(curve:inverse()[1] == dm.pair(-1, 5) and curve[4] == nil and curve[0] == nil, "backwards")
raises("cannot be composed", function() return p * r end)
raises("cannot be composed", function() return p:join(r) end)
raises("point 2 is missing", dm.pair, 1)
raises("NaN", dm.pair, 0 / 0, 1)
-- points with names are one where every entry is
local place = dm.pair(0, { x = 1, at = { 2 } })
ok(place * dm.pair({ x = 1, at = { 2 } }, 3) == dm.pair(0, 3), "tables entry by entry")
for _, other in ipairs { { x = 2, at = { 2 } }, { x = 1, at = { 3 } }, { x = 1 }, { x = 1, at = { 2 }, y = 0 }, {} } do
  raises("cannot be composed: the target {at = {2}, x = 1}", function() return place * dm.pair(other, 3) end)
end
raises("point 1 has an entry that is NaN", dm.pair, { 1, { 0 / 0 } }, 1)
raises("point 2 has an entry that is NaN", dm.pair, 1, dm.vector { 0, 0 / 0 })
raises("two pairs are needed", function() return p * 3 end)
tap.done()
