-- operators of forms and fields: exact on constants and linear functions on bent and random meshes
-- of dimension 1 to 4, identities of products, values worked by hand (Leok 3.5-3.10)
local cochains = require "cochains"
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, sin, cos, pi = math.sqrt, math.sin, math.cos, math.pi

local random = cochains.random(1)
local cochain = cochains.of(random)

-- one mesh for every dimension, flat, with inner vertices and boundary, bent at random by linear
-- maps and displaced vertices; triangles and tetrahedra of both orders
local function jittered(options, size)
  local K = dm.mesh(options)
  local points, n = K:points():totable(), K.dimension
  local A = {}
  for i = 1, n do
    A[i] = {}
    for j = 1, n do A[i][j] = (i == j and 1 or 0) + 0.2 * random() end
  end
  for i, p in ipairs(points) do
    local q = {}
    for r = 1, n do
      q[r] = size * random()
      for c = 1, n do q[r] = q[r] + A[r][c] * p[c] end
    end
    points[i] = q
  end
  return dm.mesh { points = points, simplices = K:simplices(n) }
end
local meshes = {
  jittered({ simplices = { { 1, 2 }, { 3, 2 }, { 3, 4 }, { 5, 4 } }, points = { { 0 }, { 1 }, { 2.2 }, { 3 }, { 4 } } }, 0.1),
  jittered({ triangle = 4 }, 0.03), jittered({ shells = { 3, 2 } }, 0.1), jittered({ shells = { 4, 1 } }, 0.1) }

-- the constant k-form with these components, and another one
local function binomial(n, k)
  local product = 1
  for i = 1, k do product = product * (n - k + i) // i end
  return product
end
local function constant(n, k)
  local c = {}
  for i = 1, binomial(n, k) do c[i] = random() end
  return function() return c end, c
end

-- cells of degree k that no boundary cell touches, when `near_by` of their vertices are inside
local function inner_cells(K, k)
  local on, out = {}, {}
  for _, v in ipairs(K:boundary_cells(0)) do on[v] = true end
  for i, s in ipairs(K:simplices(k)) do
    local inside = true
    for _, v in ipairs(s) do inside = inside and not on[v] end
    if inside then out[#out + 1] = i end
  end
  return out
end
local function worst(a, b, cells)
  local most = 0
  for _, i in ipairs(cells) do most = math.max(most, math.abs(a[i] - b[i])) end
  return most
end

for n, K in ipairs(meshes) do
  local name = ("dimension %d: "):format(n)
  -- de Rham map: d and Stokes; affine forms are integrated exactly
  for k = 0, n do
    local f = constant(n, k)
    local a = K:form(k, f)
    if k < n then ok(a:d():max() < 1e-13, name .. "constant forms are closed, degree " .. k) end
    local dual = K:form(n - k, f == nil and f or (constant(n, n - k)), { dual = true })
    if k == n then
      near(dual:star():star():max(), dual:max(), 1e-13, name .. "dual functions are plain values")
    end
  end
  -- * of a constant form is the constant form *: primal dx -> dual, compared inside
  if n == 2 then
    local dx, dy = K:form(1, function() return { 1, 0 } end), K:form(1, function() return { 0, 1 } end)
    local inside = inner_cells(K, 1)
    ok(worst(dx:star(), K:form(1, function() return { 0, 1 } end, { dual = true }), inside) < 1e-13
      and worst(dy:star(), -K:form(1, function() return { 1, 0 } end, { dual = true }), inside) < 1e-13,
      name .. "star dx = dy, star dy = -dx")
  end
  if n == 3 then
    local dz = K:form(2, function() return { 1, 0, 0 } end):star() -- * dx dy = dz
    ok((dz - K:form(1, function() return { 0, 0, 1 } end, { dual = true })):max() < 1e-12, name .. "star dx dy = dz")
    local dyz = K:form(1, function() return { 1, 0, 0 } end):star() -- * dx = dy dz
    ok((dyz - K:form(2, function() return { 0, 0, 1 } end, { dual = true })):max() < 1e-12, name .. "star dx = dy dz")
  end
  -- the top form: volumes with signs, star 1
  local vol = K:form(n, function() return { 1 } end)
  local one = K:form(0, function() return 1 end, { dual = true })
  ok((vol:star() - one):max() < 1e-12 and (one:star() - vol):max() < 1e-12, name .. "star of the volume form")
  near(vol:pair(K:fundamental()), K:volume(n):sum(), 1e-12, name .. "integral of the volume form")

  -- gradients, sharps and flats of linear functions and constant fields
  local _, c = constant(n, 1)
  local linear = K:form(0, function(...)
    local s = 0.3
    for i, x in ipairs { ... } do s = s + c[i] * x end
    return s
  end)
  local gradient = K:vector_field(function() return c end)
  local on_cells = K:vector_field(function() return c end, { on = "cells" })
  local function apart(X, Y)
    local most = 0
    for i = 1, #X do most = math.max(most, (X.values[i] - Y.values[i]):norm()) end
    return most
  end
  ok(apart(linear:grad(), gradient) < 1e-11, name .. "gradient at vertices, exact on linear functions")
  ok(apart(linear:grad { to = "cells" }, on_cells) < 1e-11, name .. "and in cells")
  ok((gradient:flat() - linear:d()):max() < 1e-12, name .. "flat of a constant field on vertices")
  ok((on_cells:flat() - linear:d()):max() < 1e-12, name .. "and on cells")
  local exact = K:form(1, function() return c end, { dual = true })
  ok((gradient:flat { to = "dual" } - exact):max() < 1e-12, name .. "flat to the dual, from vertices")
  ok((on_cells:flat { to = "dual" } - exact):max() < 1e-12, name .. "and from cells")
  ok(apart(exact:sharp(), on_cells) < 1e-10, name .. "sharp of a dual form")
  ok(apart(on_cells:flat():sharp { to = "cells" }, on_cells) < 1e-11, name .. "sharp of a flat is 1 on constants")

  -- divergence: constants have none with the flux; the theorem; position has n inside
  ok(gradient:div { boundary = "flux" }:max() < 1e-10 and on_cells:div { boundary = "flux" }:max() < 1e-10,
    name .. "divergence of constants with the flux")
  local position = K:vector_field(function(...) return { ... } end, { on = "cells" })
  local inside = inner_cells(K, 0)
  local div = position:div()
  ok(position.mesh:divergence_values(position.values, position.on) == div.values,
    name .. "without the flux unless it is asked for")
  near(div.values:dot(K:dual_volume(0)), 0, 1e-12, name .. "the sum of |*v| div is 0")
  for _, v in ipairs(inside) do near(div[v], n, 1e-10, name .. "divergence of the position is n inside") end
  local at_vertices = K:vector_field(function(...) return { ... } end)
  near(at_vertices:div { boundary = "flux" }.values:dot(K:dual_volume(0)) / K:volume(n):sum(), n, 1e-11,
    name .. "and its integral with the flux n times the volume")
  local minus = -position:flat():delta()
  ok((minus - div):max() < 1e-10, name .. "div = -delta flat")

  -- contraction: exact on constants, both ways, in every degree
  local function minor(k, form_components, X) -- components of i_X a, by hand
    local out = {}
    local function index_of(list)
      local at = 0
      local function count(prefix, from)
        if #prefix == #list then
          at = at + 1
          for i = 1, #list do if prefix[i] ~= list[i] then return false end end
          return true
        end
        for i = from, n do
          prefix[#prefix + 1] = i
          if count(prefix, i + 1) then return true end
          prefix[#prefix] = nil
        end
      end
      count({}, 1)
      return at
    end
    local function lists(prefix, from)
      if #prefix == k - 1 then
        local sum = 0
        for j = 1, n do
          local full, sign, seen = { j }, 1, false
          for _, i in ipairs(prefix) do
            if i == j then seen = true end
            full[#full + 1] = i
          end
          if not seen then
            for a = 1, #full do
              for b = a + 1, #full do if full[a] > full[b] then sign = -sign end end
            end
            table.sort(full)
            sum = sum + sign * X[j] * form_components[index_of(full)]
          end
        end
        out[#out + 1] = sum
        return
      end
      for i = from, n do
        prefix[#prefix + 1] = i
        lists(prefix, i + 1)
        prefix[#prefix] = nil
      end
    end
    lists({}, 1)
    return out
  end
  for k = 1, n do
    local f, components = constant(n, k)
    local a = K:form(k, f)
    local want = K:form(k - 1, function() return minor(k, components, c) end)
    for _, X in ipairs { gradient, on_cells } do
      for _, side in ipairs { "central", "forward", "backward" } do
        ok((a:contract(X, { side = side }) - want):max() < 1e-10,
          name .. ("i_X of a constant %d-form, %s, X on %s"):format(k, side, X.on))
      end
      local cells = k > 1 and {} or inside
      local algebraic = a:contract(X, { method = "algebraic" })
      if k > 1 then for i = 1, #want do cells[i] = i end end
      ok(worst(algebraic, want, k == n and cells or inner_cells(K, k - 1)) < 1e-9,
        name .. ("and algebraic, degree %d, X on %s"):format(k, X.on))
    end
    ok(worst(a:lie(gradient), 0 * want:d(), {}) == 0 and a:lie(on_cells):max() < 1e-9, name .. "L_X of constants is 0")
    if k < n then
      local b = cochain(K, k)
      near((b:lie(gradient):d() - b:d():lie(gradient)):max(), 0, 1e-10, name .. "d L_X = L_X d")
    end
  end

  -- products of dual forms: exact on constants inside, anticommutative by both rules
  for k = 0, n do
    for l = 0, n - k do
      local a, b = cochain(K, k, true), cochain(K, l, true)
      for _, rule in ipairs { "consistent", "thesis" } do
        local ab, ba = a:wedge(b, { rule = rule }), b:wedge(a, { rule = rule })
        ok((ab - (-1) ^ (k * l) * ba):max() < 1e-11 * (1 + ab:max()),
          name .. ("dual products anticommute, %d and %d, %s"):format(k, l, rule))
      end
      near((K:form(0, function() return 1 end, { dual = true }):wedge(a) - a):max(), 0, 1e-11 * (1 + a:max()),
        name .. "1 ^ a = a")
    end
  end
  -- primal by dual: the integral is the product of norms
  for k = 0, n do
    local a, b = cochain(K, k), cochain(K, k)
    near(a:wedge(b:star()):sum(), a:dot(b), 1e-12 * K:count(k), name .. "a ^ *b sums to a.b")
    near(b:star():wedge(a):sum(), (-1) ^ (k * (n - k)) * a:dot(b), 1e-12 * K:count(k), name .. "and *b ^ a")
    near(a:wedge(b:star(), { rule = "thesis" }):sum() * n, a:dot(b), 1e-11 * K:count(k), name .. "factor 1 / n as printed")
    near(a:wedge(b:star(), { rule = "geometric" }):sum() * binomial(n, k), a:dot(b), 1e-11 * K:count(k),
      name .. "geometric factor")
  end
end

-- constants by products of dual forms: dx ^ dy ^ dz in space
do
  local K = meshes[3]
  local function dual(c) return K:form(1, function() return c end, { dual = true }) end
  local dx, dy, dz = dual { 1, 0, 0 }, dual { 0, 1, 0 }, dual { 0, 0, 1 }
  local dxy = K:form(2, function() return { 1, 0, 0 } end, { dual = true })
  ok((dx:wedge(dy) - dxy):max() < 1e-12, "dx ^ dy of dual forms in space")
  ok((dx:wedge(dy):wedge(dz).values - K:dual_volume(0)):norm() < 1e-11, "dx ^ dy ^ dz is the dual volume")
  local X = K:vector_field(function(x, y, z) return { -y, x, 2 } end)
  local curl = X:curl()
  ok(curl.on == "cells", "curls in space are fields on cells")
  local S = dm.mesh { shells = { 3, 1 } }
  local turning = S:vector_field(function(x, y, z) return { -y, x, 0 } end):curl()
  for i = 1, #turning, 3 do
    local t = turning[i]
    near(math.abs(t[1]) + math.abs(t[2]) + math.abs(t[3] - 2), 0, 1e-12, "curl of a rotation")
  end
  local flat = meshes[2]
  local spin = flat:vector_field(function(x, y) return { -y, x } end):curl()
  ok((spin.values:map(function(x) return x - 2 end)):norm() < 1e-11, "curl of a rotation of the plane")
end

---- values worked by hand ----

local right = dm.mesh { points = { { 0, 0 }, { 1, 0 }, { 0, 1 } }, simplices = { { 1, 2, 3 } } }
near(right:form(2, function() return { 1 } end)[1], 0.5, 1e-15, "dx dy on the unit triangle")
near(right:form(1, function(x, y) return { y, 0 } end):at { 2, 3 }, -0.5, 1e-15, "y dx from (1, 0) to (0, 1)")
near(right:form(1, function(x, y) return { y, 0 } end):at { 3, 2 }, 0.5, 1e-15, "and back")
local up1 = right:vector_field(function(x) return { 0, x == 0 and 1 or 0 } end) -- at (0, 0) and (0, 1)
near(right:form(2, function() return { 1 } end):contract(up1):at { 1, 2 }, -0.5, 1e-15, "an edge whose one end moves (Fig 3.10)")
local up2 = right:vector_field(function(x) return { 0, x == 1 and 1 or 0 } end)
for what, row in pairs { ["y dx"] = { function(x, y) return { y, 0 } end, nil }, dy = { function() return { 0, 1 } end, 1 },
  dx = { function() return { 1, 0 } end, 0 } } do
  if row[2] then near(right:form(1, row[1]):lie(up2):at { 1, 2 }, row[2], 1e-14, "L_X " .. what .. " (Fig 3.11)") end
end
near(right:form(1, function(x, y) return { -y, x } end):lie(up2):at { 1, 2 }, 0, 1e-14, "L_X (x dy - y dx) (Fig 3.11)")

-- fans of m triangles: products of dual forms, printed and corrected
for m, ratio in pairs { [5] = 2.7639, [6] = 2, [7] = 1.5060, [8] = 1.1716 } do
  local P, fan = { { 0, 0 } }, {}
  for i = 0, m - 1 do
    P[i + 2], fan[i + 1] = { cos(2 * pi * i / m), sin(2 * pi * i / m) }, { 1, i + 2, (i + 1) % m + 2 }
  end
  local K = dm.mesh { points = P, simplices = fan }
  local dx = K:form(1, function() return { 1, 0 } end, { dual = true })
  local dy = K:form(1, function() return { 0, 1 } end, { dual = true })
  near(dx:wedge(dy)[1], K:dual_volume(0)[1], 1e-13, "dx ^ dy on the dual of the centre")
  near(dx:wedge(dy, { rule = "thesis" })[1] / dx:wedge(dy)[1], ratio, 1e-4, "and what is printed")
  if m == 6 then
    local slope = K:form(0, function(x, y) return 2 * x - y end):d()
    near(slope:sharp { rule = "thesis" }.values[1]:norm(), 0, 1e-15, "the printed sharp of a linear function on a hexagon")
    local linear = K:vector_field(function(x, y) return { x, y } end, { on = "cells" })
    near(linear:div()[1], 2, 1e-13, "divergence of the position on a hexagon")
    local f = K:form(0, { 1, 0, 0, 0, 0, 0, 0 })
    near(f:d():delta()[1], 4, 1e-13, "Laplacian of a hexagon")
    local one = K:form(0, function() return 1 end, { dual = true })
    near(one:wedge(dy, { rule = "thesis" })[1] / dy[1], 2, 1e-14, "1 ^ b as printed is 2 b")
  end
end
-- the irregular fan, and its double
local function irregular(scale)
  local P, fan = { { 0.05 * scale, -0.03 * scale } }, {}
  local radius, angle = { 1, 1.1, 0.9, 1.2, 1, 0.95 }, { 0.1, 1.1, 2.3, 3.2, 4, 5.2 }
  for j = 1, 6 do
    P[j + 1] = { scale * radius[j] * cos(angle[j]), scale * radius[j] * sin(angle[j]) }
    fan[j] = j < 6 and { 1, j + 1, j + 2 } or { 1, 2, 7 }
  end
  return dm.mesh { points = P, simplices = fan }
end
local function printed(scale)
  return irregular(scale):form(0, function(x, y) return 2 * x - y end):d():sharp { rule = "thesis" }[1]
end
near(printed(1)[1], -0.127, 5e-4, "the printed sharp on an irregular fan")
near(printed(1)[2], -0.167, 5e-4, "and its other component")
near(printed(3)[1] / printed(1)[1], 3, 1e-12, "changes with the scale")
local F = irregular(1)
local squares = F:form(0, function(x, y) return x * x + y * y end)
near(-squares:d():delta()[1], 4, 1e-12, "div grad |x|^2 = 4 on the fan")

-- a sphere: cells are integrated over as the chart bends them
local ball = dm.mesh { icosphere = 2 }
local function on_sphere(x, y, z)
  local r = sqrt(x * x + y * y + z * z)
  return { x / r, y / r, z / r }
end
local area = ball:form(2, function(x, y, z) return { z, -y, x } end, { chart = on_sphere, order = 9 })
near(area:pair(ball:fundamental()) * (ball:orientation()[1] * area[1] > 0 and 1 or -1), 4 * pi, 1e-9, "area of the sphere")
local closed = ball:form(1, function(x, y, z) return { y * z, x * z, x * y } end, { chart = on_sphere, order = 9 })
local potential = ball:form(0, function(x, y, z) return x * y * z end, { chart = on_sphere })
ok((closed - potential:d()):max() < 1e-9, "the integral of df is f at the ends, along bent edges")
local tangent = ball:vector_field(function(x, y) return { -y, x, 0 } end, { on = "cells" })
ok(tangent.projected > 0 and tangent.projected < 0.1 and tangent:div():max() < 0.2, "fields are laid into the cells of surfaces")

---- refusals ----

raises("zero dual volume at simplex {2, 3}", function()
  local a = right:form(1, { 1, 2, 3 }, { dual = true })
  return a:wedge(a)
end)
raises("degree", function() return right:form(0, { 1, 2, 3 }):contract(up1) end)
raises("two meshes", function() return right:form(2, { 1 }):contract(F:vector_field(function() return { 0, 1 } end)) end)
raises("did you mean 'side'", function() return right:form(2, { 1 }):contract(up1, { sid = "forward" }) end)
raises("points", function() return dm.mesh { hex_torus = 3 }:vector_field(function() return { 1 } end) end)
raises("single points", function()
  return dm.mesh { simplices = { { 1 }, { 2 } }, points = { { 0 }, { 1 } } }:vector_field(function() return 1 end):flat { to = "dual" }
end)
raises("must have 2 entries", function() return right:form(1, function() return { 1, 2, 3 } end) end)
raises("finite", function() return right:form(0, function() return 0 / 0 end) end)
raises("whole number from 1 to 21", function() return right:form(0, function() return 1 end, { order = 99 }) end)
raises("2 components", function() return right:vector_field(function() return { 1 } end) end)
raises("not orientable", function()
  return dm.mesh { named = "rp2" }:form(2, dm.vector(10)):star()
end)
tap.done()
