-- cone operators: d p + p d = 1 - projection in integers, potentials, and what is refused
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local function cochain(K, k, seed)
  local x = {}
  for i = 1, K:count(k) do x[i] = ((29 * i + 13 * k + 7 * seed) % 89) / 44.5 - 1 end
  return K:form(k, x)
end

-- p d + d p = 1 but for the hub, p p = 0, and closed forms have potentials
local balls = { { { named = "dunce" }, { "matching" } }, { { grid = 8 }, { "matching", "collapse" } },
  { { cube_tiling = 2 }, { "matching", "collapse" } } }
for _, size in ipairs { { 1, 3 }, { 2, 3 }, { 3, 2 }, { 4, 2 } } do
  balls[#balls + 1] = { { shells = size }, { "matching", "collapse", "star", "shells" } }
end
for _, row in ipairs(balls) do
  local K = dm.mesh(row[1])
  for _, rule in ipairs(row[2]) do
    local p = K:cone { rule = rule }
    ok(p.poincare and p:check() == 0, tostring(p))
    for k = 0, K.dimension - 1 do
      local terms = {}
      for i, vertices in ipairs(K:simplices(k)) do
        if i % 3 == 1 then terms[#terms + 1] = { i % 7 - 3, vertices } end
      end
      local c = K:chain(k, terms)
      ok(#p(p(c)):support() == 0, "p p = 0")
      if k > 0 then ok(p(c):boundary() + p(c:boundary()) == c, "p d + d p = 1") end
      local a = cochain(K, k + 1, 1)
      near(p:cocone(a):pair(c), a:pair(p(c)), 1e-11 * (1 + math.abs(a:pair(p(c)))),
        "the cocone is the transpose")
      local closed = cochain(K, k, 2):d()
      ok((p:cocone(closed):d() - closed):max() < 1e-11, "a potential")
    end
    local f = cochain(K, 0, 3)
    local back = p:cocone(f:d())
    local defect = 0
    for v = 1, #f do defect = math.max(defect, math.abs(back[v] - f[v] + f[p.hub])) end
    ok(defect < 1e-12, "H d f = f - f(hub)", defect)
  end
end

-- meshes that cannot be drawn together: p stops at their homology
for _, spec in ipairs { { icosphere = 1 }, { klein = 3 }, { bcc = 3 }, { named = "rp2" },
  { simplex_boundary = 6 }, { annulus = { 2, 6 }, ratio = 1.5 } } do
  local K = dm.mesh(spec)
  local p = K:cone()
  ok(not p.poincare and p:check() == 0, tostring(p))
  raises("collaps", function() K:cone { rule = "collapse" } end)
  for k = 0, K.dimension do
    for _, c in ipairs(K:generators(k)) do ok(p:project(c) == c, "a generator is left alone") end
  end
end
raises("24 of degree 1", function() dm.mesh { named = "dunce" }:cone { rule = "collapse" } end)
ok(dm.mesh { shells = { 2, 2 } }:cone { hub = 5 }.hub == 5, "a hub is kept")
ok(dm.mesh { grid = 4 }:cone { rule = "collapse", hub = 13 }:check() == 0, "by collapses, too")

-- pseudo-inverses: the dunce hat can be drawn together, an annulus leaves its hole
ok(dm.mesh { named = "dunce" }:cone { rule = "linear" }:check() < 1e-12, "the dunce hat, linearly")
local ring = dm.mesh { annulus = { 2, 6 }, ratio = 1.5 }
local linear = ring:cone { rule = "linear" }
ok(not linear.poincare and linear:check() > 1e-3, "an annulus: homology is the defect")
raises("integers", function() return linear(ring:chain(0, { { 1, { 1 } } })) end)

-- star-shaped by geometry alone, and refused where it is not
raises("no sum of simplices", function() dm.mesh { grid = 3 }:cone { rule = "star" } end)
raises("points", function()
  dm.mesh { simplices = { { 1, 2, 3 }, { 2, 3, 4 } } }:cone { rule = "star" }
end)
raises("shells", function() dm.mesh { grid = 3 }:cone { rule = "shells" } end)

-- one vertex more (Ex 3.13, 3.16): wheel, octahedral ball with an open and a closed ring
local wheel = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { -1, 0 } },
  simplices = { { 1, 2, 3 }, { 1, 3, 4 } } }
local p = wheel:cone { rule = "star" }
local one = p:augment { at = 2, ring = { 3 }, vertex = { 2, 2 } }
ok(one:check() == 0 and one.mesh:count(2) == 3 and one.mesh.euler == 1, "one triangle more")
near(one.mesh:volume(2)[3], 1.5, 1e-14, "and its point")
local both = p:augment { at = 3, ring = { 2, 4 } }
ok(both:check() == 0 and both.mesh:count(2) == 4, "two triangles more")
ok(both:augment { at = 5, ring = { 2 } }:check() == 0, "and once more")
local ball = dm.mesh { shells = { 3, 1 } }:cone { rule = "shells" }
ok(ball:augment { at = 2, ring = { 4, 6, 5 } }:check() == 0, "in space, an open ring")
local closed = ball:augment { at = 2, ring = { 4, 6, 5, 7 }, closed = true, vertex = { 3, 0, 0 } }
ok(closed:check() == 0 and closed.mesh:count(3) == 12, "a closed ring")
raises("no simplex", function() p:augment { at = 2, ring = { 4 } } end)
raises("point", function()
  dm.mesh { simplices = { { 1, 2, 3 } } }:cone():augment { at = 1, ring = { 2 }, vertex = { 1, 2 } }
end)

-- logically star-shaped: the vertices of shells in another order, without points
local K = dm.mesh { shells = { 2, 2 } }
local n, order, simplices = K:count(0), {}, {}
for i = 1, n do order[i] = (2 * i + 3) % n + 1 end
for i, t in ipairs(K:simplices(2)) do simplices[i] = { order[t[1]], order[t[2]], order[t[3]] } end
local L = dm.mesh { simplices = simplices }
local carried = K:cone { rule = "shells" }:carry(dm.simplicial_map(K, L, order))
ok(carried:check() == 0 and carried.hub == order[1], "a cone carried by a relabelling")
raises("isomorphism", function()
  local same = {}
  for i = 1, n do same[i] = 1 end
  K:cone():carry(dm.simplicial_map(K, L, same))
end)

-- potentials, or what is in their way
local torus = dm.mesh { hex_torus = 6 }
local f = cochain(torus, 1, 4)
ok((torus:potential(f:d()):d() - f:d()):max() < 1e-12, "on a torus, of an exact form")
raises("is not closed: da = ", function() torus:potential(f) end)
-- d of e^x sin 3y by quadrature is closed to its accuracy: the message says what to do, and that does
local coarse = dm.mesh { annulus = { 8, 64 }, ratio = 2 }
local function slope(x, y) return { math.exp(x) * math.sin(3 * y), 3 * math.exp(x) * math.cos(3 * y) } end
raises("order = 21", function() coarse:potential(coarse:form(1, slope)) end)
local whole = coarse:potential(coarse:form(1, slope, { order = 21 }))
local want = coarse:form(0, function(x, y) return math.exp(x) * math.sin(3 * y) end)
near(((whole - want).values - (whole[1] - want[1])):norm(), 0, 1e-11, "the potential of a function's slope")
local around = {}
for i, e in ipairs(ring:simplices(1)) do
  local q, r = ring:points()[e[1]], ring:points()[e[2]]
  around[i] = math.atan(q[1] * r[2] - q[2] * r[1], q[1] * r[1] + q[2] * r[2])
end
raises("its period over generator 1 of degree 1 is 6.283185307", function()
  ring:potential(ring:form(1, around))
end)
raises("degree 1 or more", function() torus:potential(cochain(torus, 0, 1)) end)
local area = dm.mesh { icosphere = 1 }
raises("period", function() area:potential(area:form(2, area:oriented(area:volume(2)))) end)
tap.done()
