-- identities of the calculus on random meshes of dimension 1 to 4, closed and with boundary: exact
-- where they are exact, else to round-off
local cochains = require "cochains"
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

local random = cochains.random(3)
local cochain = cochains.of(random)
local function whole(K, k)
  local x = {}
  for i = 1, K:count(k) do x[i] = math.floor(200 * random()) end
  return x
end

local meshes = { { shells = { 1, 5 } }, { hex_torus = 5 }, { torus = { 8, 6 }, radii = { 3, 1 } }, { annulus = { 2, 9 }, ratio = 1.5 },
  { bcc = 3 }, { shells = { 3, 2 } }, { simplex_boundary = 5 }, { shells = { 4, 1 } }, { klein = 4 }, { named = "rp2" },
  { cross_polytope = 4, dual = "barycentric" } }
for _, options in ipairs(meshes) do
  local K, name = dm.mesh(options), nil
  for key, value in pairs(options) do name = name or type(value) ~= "string" and key or key == "named" and value end
  local n = K.dimension
  for k = 0, n do
    local label = ("%s, degree %d: "):format(name or "mesh", k)
    -- P1, P2: integers in, integers out, so 0 is 0
    if k < n - 1 then ok(K:form(k, whole(K, k)):d():d():max() == 0, label .. "d d = 0") end
    if K.orientable and k < n - 1 then
      ok(K:form(k, whole(K, n - k), { dual = true }):d():d():max() == 0, label .. "d d = 0 on duals")
    end
    if k < n then
      local a, terms = cochain(K, k), {}
      for i, cell in ipairs(K:simplices(k + 1)) do
        if i % 3 == 0 then terms[#terms + 1] = { i % 7 - 3, cell } end
      end
      local c = K:chain(k + 1, terms)
      near(a:d():pair(c), a:pair(c:boundary()), 1e-12 * #terms, label .. "Stokes")
      ok(k == 0 or c:boundary():boundary() == K:chain(k - 1, {}), label .. "boundaries have no boundary")
    end
    -- P3, P4: star star, delta = +-*d*, adjoint
    local zero = K:quality().zero[k] > 0 or k > 0 and K:quality().zero[k - 1] > 0
    if K.orientable and not zero then
      local a, dual = cochain(K, k), cochain(K, n - k, true)
      local sign = (-1) ^ (k * (n - k))
      ok((a:star():star() - sign * a):max() < 1e-13 and (dual:star():star() - sign * dual):max() < 1e-13, label .. "star star")
      if k > 0 then
        local by_stars = -(-1) ^ (n * (k - 1)) * a:star():d():star()
        near((by_stars - a:delta()):max(), 0, 1e-11 * (1 + a:delta():max()), label .. "delta = +-*d*")
      end
    end
    if k > 0 and not zero then
      local a, b = cochain(K, k), cochain(K, k - 1)
      near(b:d():dot(a), b:dot(a:delta()), 1e-11 * K:count(k), label .. "delta is the adjoint of d")
    end
    if K.orientable and not zero and k < n then -- on duals too
      local a, b = cochain(K, n - k, true), cochain(K, n - k - 1, true)
      if K:quality().zero[k + 1] == 0 then
        near(b:d():dot(a), b:dot(a:delta()), 1e-10 * K:count(k), label .. "and on duals")
      end
    end
    -- P9, P10, P12: products
    for l = 0, n - k do
      local a, b = cochain(K, k), cochain(K, l)
      for _, rule in ipairs { "natural", "metric" } do
        local ab, ba = a:wedge(b, { rule = rule }), b:wedge(a, { rule = rule })
        near((ab - (-1) ^ (k * l) * ba):max(), 0, 1e-13, label .. rule .. " products anticommute")
      end
      if k + l < n then
        for _, rule in ipairs { "natural", "cup" } do
          local o = { rule = rule }
          local defect = a:wedge(b, o):d() - (a:d():wedge(b, o) + (-1) ^ k * a:wedge(b:d(), o))
          near(defect:max(), 0, 2e-13, label .. rule .. " products have Leibniz' rule")
        end
        local c = cochain(K, n - k - l)
        local o = { rule = "cup" }
        near((a:wedge(b, o):wedge(c, o) - a:wedge(b:wedge(c, o), o)):max(), 0, 1e-13, label .. "cup products are associative")
      end
      -- P11: on closed forms both are associative
      if k > 0 and l > 0 and k + l < n then
        local c = cochain(K, n - k - l - 1):d()
        local p, q = cochain(K, k - 1):d(), cochain(K, l - 1):d()
        for _, rule in ipairs { "natural", "metric" } do
          local o = { rule = rule }
          near((p:wedge(q, o):wedge(c, o) - p:wedge(q:wedge(c, o), o)):max(), 0, 1e-11,
            label .. rule .. " products of closed forms are associative")
        end
      end
    end
  end
end

-- P11': where they are not
local line = dm.mesh { points = { { 0 }, { 1 } }, simplices = { { 1, 2 } } }
local f, g, a = line:form(0, { 1, 0 }), line:form(0, { 0, 1 }), line:form(1, { 1 })
ok(f:wedge(g):wedge(a)[1] == 0 and f:wedge(g:wedge(a))[1] == 0.25, "products of functions and a 1-form")

-- P29: natural products commute with maps of meshes, metric ones do not
local right = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 0, 1 } }, simplices = { { 1, 2, 3 } } }
local equal = dm.mesh { triangle = 1 }
local function on(K, rule) return K:form(1, { 1, 0, 2 }):wedge(K:form(1, { 3, 1, -1 }), { rule = rule })[1] end
near(on(right, "natural"), on(equal, "natural"), 1e-15, "natural products do not see the metric")
near(on(right, "metric") - on(equal, "metric"), 4 / 3 - 7 / 8, 1e-14, "metric products do")

-- P11: 1 ^ 1 ^ 1 of constant forms on a tetrahedron is the product's integral
local T = dm.mesh { points = { { 0, 0, 0 }, { 1, 0.1, 0 }, { 0.2, 1, 0.1 }, { 0, 0.3, 1.2 } }, simplices = { { 1, 2, 3, 4 } } }
local function dx(i)
  local c = { 0, 0, 0 }
  c[i] = 1
  return T:form(1, function() return c end)
end
near(dx(1):wedge(dx(2)):wedge(dx(3))[1], T:orientation()[1] * T:volume(3)[1], 1e-15, "dx ^ dy ^ dz of a tetrahedron")

-- P16: fields and forms turn with the mesh, scale with it, and do not see the order of vertices
local base = dm.mesh { points = { { 0, 0 }, { 1, 0.1 }, { 0.4, 0.9 }, { -0.7, 0.6 }, { -0.6, -0.5 }, { 0.3, -0.8 } },
  simplices = { { 1, 2, 3 }, { 1, 3, 4 }, { 1, 4, 5 }, { 1, 5, 6 }, { 1, 2, 6 } } }
local angle, scale = 0.8, 3
local c, s = math.cos(angle), math.sin(angle)
local function turn(x, y) return { scale * (c * x - s * y), scale * (s * x + c * y) } end
local turned = dm.mesh { simplices = base:simplices(2), points = (function()
  local out = {}
  for i = 1, 6 do out[i] = turn(base:points()[i][1], base:points()[i][2]) end
  return out
end)() }
local form = cochain(base, 1)
local moved = turned:form(1, form.values)
for _, to in ipairs { "vertices", "cells" } do
  local V, W = form:sharp { to = to }, moved:sharp { to = to }
  for i = 1, #V do
    local want = turn(V[i][1], V[i][2])
    near(math.abs(W[i][1] - want[1] / scale ^ 2) + math.abs(W[i][2] - want[2] / scale ^ 2), 0, 1e-12, "sharp turns and scales, " .. to)
  end
end
-- the same mesh with other numbers of vertices: new number of old vertex i
local number, simplices, points = { 4, 1, 6, 2, 5, 3 }, {}, {}
for i, t in ipairs(base:simplices(2)) do simplices[i] = { number[t[3]], number[t[1]], number[t[2]] } end
for i = 1, 6 do points[number[i]] = base:points()[i]:totable() end
local renamed = dm.mesh { simplices = simplices, points = points }
local function smooth(x, y) return { math.sin(x + y), math.exp(x) * y } end
for _, to in ipairs { "vertices", "cells" } do
  local V, W = base:form(1, smooth):sharp { to = to }, renamed:form(1, smooth):sharp { to = to }
  for i = 1, to == "vertices" and 6 or 0 do
    near(math.abs(V[i][1] - W[number[i]][1]) + math.abs(V[i][2] - W[number[i]][2]), 0, 1e-12, "numbers of vertices do not matter")
  end
end
local function scalar(K) return K:form(1, smooth):contract(K:vector_field(function(x, y) return { y, -x } end), { side = "forward" }) end
for i = 1, 6 do near(scalar(base)[i], scalar(renamed)[number[i]], 1e-12, "nor in contractions") end
near(base:form(1, smooth):lie(base:vector_field(smooth)):norm(), renamed:form(1, smooth):lie(renamed:vector_field(smooth)):norm(),
  1e-12, "nor in Lie derivatives")

-- P17: the flux out of any set of dual cells is that through the dual faces between it and the rest
for _, options in ipairs { { triangle = 6 }, { icosphere = 1 }, { shells = { 3, 2 } } } do
  local K = dm.mesh(options)
  local X = K:vector_field(function(...)
    local p = { ... }
    return { p[2] * p[1] + 1, math.sin(p[1]), #p == 3 and p[3] ^ 2 - p[1] or nil }
  end, { on = "cells" })
  local div, dual, flux = X:div(), K:dual_volume(0), X:flat():star()
  local total, through, set = 0, 0, {}
  for v = 1, K:count(0) do set[v] = v * 7 % 3 == 0 end
  for v = 1, K:count(0) do total = total + (set[v] and dual[v] * div[v] or 0) end
  for e, ends in ipairs(K:simplices(1)) do -- the dual of [i, j] is crossed from i to j
    if set[ends[1]] ~= set[ends[2]] then through = through + (set[ends[1]] and 1 or -1) * flux[e] end
  end
  near(total, through, 1e-12, "the divergence theorem")
end

-- P21: products of constant forms are exact on a flat torus: |dx^i ^ ..|^2 is the volume 1
local torus = dm.mesh { bcc = 3 }
local N, cubes = 3, 27
local function corner(v) -- of vertex v, in the unit torus
  local i = (v - 1) % cubes
  local half = v > cubes and 0.5 or 0
  return { (i % N + half) / N, (i // N % N + half) / N, (i // (N * N) + half) / N }
end
local edges = {}
for i, e in ipairs(torus:simplices(1)) do
  local p, q, d = corner(e[1]), corner(e[2]), {}
  for j = 1, 3 do
    d[j] = q[j] - p[j]
    d[j] = d[j] - math.floor(d[j] + 0.5)
  end
  edges[i] = d
end
local constant = {}
for j = 1, 3 do
  local x = {}
  for i, d in ipairs(edges) do x[i] = d[j] end
  constant[j] = torus:form(1, x)
end
for i = 1, 3 do
  for j = i, 3 do near(constant[i]:dot(constant[j]), i == j and 1 or 0, 1e-12, "dx_i . dx_j on the flat torus") end
  ok(constant[i]:d():max() < 1e-15 and constant[i]:delta():max() < 1e-12, "constants are harmonic")
end
local xy = constant[1]:wedge(constant[2])
near(xy:dot(xy), 1, 1e-12, "|dx ^ dy|^2 = 1")
local xyz = xy:wedge(constant[3])
near(xyz:dot(xyz), 1, 1e-12, "|dx ^ dy ^ dz|^2 = 1")
near(math.abs(xyz:pair(torus:fundamental())), 1, 1e-12, "whose integral is the volume")
tap.done()
