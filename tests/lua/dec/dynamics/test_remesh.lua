-- forms from mesh to mesh, and multigrid (Leok 3.14; P27, P28)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos = math.sin, math.cos
local function cochain(K, k, shift)
  local x = {}
  for i = 1, K:count(k) do x[i] = sin(7 * i + i * i + (shift or 0)) end
  return K:form(k, x)
end
local function box(N) -- the unit square by points without order, and its corners
  local points, random = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 } }, dm.random(N)
  for i = 5, N do points[i] = { random:uniform(i, 0), random:uniform(i, 1) } end
  return dm.mesh { points = points }
end
-- constant forms of every degree
local flat = { { [0] = function() return 3 end, function() return -2 end },
  { [0] = function() return 3 end, function() return { 1, 2 } end, function() return 1.5 end },
  { [0] = function() return 3 end, function() return { 1, 2, 3 } end, function() return { 1, -1, 2 } end, function() return 4 end } }
local function line(N) local p, s = {}, {} for i = 0, N do p[i + 1] = { (i / N) ^ 2 } if i > 0 then s[i] = { i, i + 1 } end end return dm.mesh { points = p, simplices = s } end

for _, case in ipairs { { "triangles", dm.mesh { triangle = 2 }, dm.mesh { triangle = 3 } }, { "finer", dm.mesh { triangle = 2 }, dm.mesh { triangle = 4 } },
  { "and back", dm.mesh { triangle = 4 }, dm.mesh { triangle = 2 } }, { "squares", dm.mesh { grid = 3 }, box(25) }, { "without order", box(30), box(31) },
  { "lines", line(5), line(7) }, { "cubes", dm.mesh { cube_tiling = 2 }, dm.mesh { cube_tiling = 3 } } } do
  local name, K, M = table.unpack(case)
  local T, n = dm.remesh(K, M), K.dimension
  for k = 0, n do
    ok((T(K:form(k, flat[n][k])) - M:form(k, flat[n][k])):max() < 1e-12, ("%s: exact on constants, degree %d"):format(name, k))
    local a = cochain(K, k)
    if k < n then ok((T(a):d() - T(a:d())):max() < 1e-12, ("%s: T d = d T, degree %d"):format(name, k), (T(a):d() - T(a:d())):max()) end
    ok((dm.remesh(K, K)(a) - a):max() < 1e-12, ("%s: the identity, degree %d"):format(name, k))
  end
  local function x1(x) return 2 * x + 1 end
  ok((T(K:form(0, x1)) - M:form(0, x1)):max() < 1e-12, name .. ": exact on linear functions")
end
-- a circle of edges in the plane is not covered by a finer one; the same circle with more vertices on its sides is
local function ring(N, sides) -- a regular polygon of `sides` sides, N edges each
  local p, s = {}, {}
  for i = 0, sides * N - 1 do
    local side, t = i // N, i % N / N
    local function corner(j) return cos(2 * math.pi * j / sides), sin(2 * math.pi * j / sides) end
    local x0, y0 = corner(side) local x1, y1 = corner(side + 1)
    p[i + 1], s[i + 1] = { x0 + t * (x1 - x0), y0 + t * (y1 - y0) }, { i + 1, (i + 1) % (sides * N) + 1 }
  end
  return dm.mesh { points = p, simplices = s }
end
local T = dm.remesh(ring(2, 6), ring(3, 6))
local a = cochain(ring(2, 6), 0)
a = T.from:form(0, a.values)
ok((T(a):d() - T(a:d())):max() < 1e-13, "curves in the plane")
raises("not of one set", function() local R = dm.remesh(ring(1, 6), ring(1, 7)) return R(cochain(R.from, 1)) end)

-- restriction: sums of the fine values, which is the de Rham map of the coarse mesh
local fine, coarse = dm.mesh { triangle = 8 }, dm.mesh { triangle = 2 }
local R = dm.remesh(fine, coarse, { rule = "sum" })
for k, f in pairs { [0] = function(x, y) return x * y end, [1] = function(x, y) return { x * y, y } end, [2] = function(x, y) return x - y end } do
  ok((R(fine:form(k, f)) - coarse:form(k, f)):max() < 1e-14, "sums of integrals, degree " .. k)
end
raises("not nested", function() return dm.remesh(dm.mesh { triangle = 3 }, coarse, { rule = "sum" }):matrix(1) end)
-- as printed: 1 goes to 0.25 .. 0.5 (E14), right and equal to Whitney in the highest degree, the identity for K = M
local four = dm.mesh { triangle = 4 }
local printed, one = dm.remesh(coarse, four, { rule = "thesis" }), coarse:form(0, function() return 1 end)
local least, most = math.huge, 0
for i = 1, four:count(0) do local x = printed(one)[i] least, most = math.min(least, x), math.max(most, x) end
near(least, 0.25, 1e-12, "as printed, constants shrink") near(most, 0.5, 1e-12, "by up to 4")
ok((printed(cochain(coarse, 2)) - dm.remesh(coarse, four)(cochain(coarse, 2))):max() < 1e-13, "right in the highest degree")
for k = 0, 2 do ok((dm.remesh(four, four, { rule = "thesis" })(cochain(four, k)) - cochain(four, k)):max() < 1e-12, "the identity for K = M, degree " .. k) end

-- refusals
local grid = dm.mesh { grid = 2 }
raises("not of one set", function() return dm.remesh(coarse, grid)(coarse:form(1, flat[2][1])) end)
raises("rule", function() dm.remesh(coarse, four, { rule = "mean" }) end)
raises("dimensions 2 and 3", function() dm.remesh(coarse, dm.mesh { cube_tiling = 1 }) end)
raises("no points", function() dm.remesh(dm.mesh { hex_torus = 3 }, coarse) end)
raises("another mesh", function() return dm.remesh(coarse, four)(cochain(four, 1)) end)
raises("primal form is needed", function() return dm.remesh(coarse, four)(coarse:form(0, cochain(coarse, 2).values, { dual = true })) end)
raises("degree from 0 to 2", function() return dm.remesh(coarse, four):matrix(3) end)

-- ---- multigrid
local function meshes(name, first, count) local out = {} for l = 1, count do out[l] = dm.mesh { [name] = first << (l - 1) } end return out end
local mg = dm.multigrid(meshes("triangle", 4, 4))
local K = mg.meshes[4]
local f = K:form(0, function(x, y) return sin(7 * x) * y + 1 end)
local u, report = mg:solve(f)
ok(report.code == "ok" and report.factor <= 0.16, "a V-cycle takes a factor of 0.16", report.factor)
ok((u - K:poisson { f = f, fixed = { boundary = 0 } }):max() < 1e-12, "the solution of K:poisson")
for l = 1, 3 do
  local own = mg.meshes[l]:incidence(0):gram((mg.meshes[l]:star_weights(1)))
  local x = cochain(mg.meshes[l], 0).values
  ok((mg:matrix(l) * x - own * x):norm() < 1e-12, "P^T A P = A of level " .. l)
end
local v, b = cochain(mg.meshes[2], 0), cochain(mg.meshes[3], 0)
near(mg:prolong(v).values:dot(b.values), v.values:dot(mg:restrict(b).values), 1e-12, "restriction is the transpose")
-- closed and curved: spheres, free squares, cubes
for _, case in ipairs { { { dm.mesh { icosphere = 1 }, dm.mesh { icosphere = 2 }, dm.mesh { icosphere = 3 } }, nil }, { meshes("grid", 2, 4), "nothing" }, { meshes("cube_tiling", 1, 3), "boundary" } } do
  local own = case[1]
  own.fixed = case[2]
  local m = dm.multigrid(own)
  local top = m.meshes[#m]
  local load = cochain(top, 0)
  local x, r = m:solve(load)
  local expected = top:poisson { f = load, fixed = case[2] == "boundary" and { boundary = 0 } or nil }
  ok(r.code == "ok" and (x - expected):max() < 1e-10 * (1 + expected:max()), "as K:poisson: " .. tostring(m), (x - expected):max())
end
-- what ended it, and the residual of what is returned
do
  local _, short = mg:solve(f, { cycles = 2 })
  ok(short.code == "no_convergence" and short.text == "not there after 2 V-cycles" and short.residual == short.residuals[3], "cycles that are too few", short.text)
  local _, last = mg:solve(f, { tolerance = 1e-30 })
  ok(last.text:find "no longer falls" and last.residual == last.residuals[#last.residuals], "a tolerance below round-off", last.text)
  local load = dm.zeros(K:count(0)):totable()
  load[7] = 0 / 0
  raises("NaN at vertex 7", function() mg:solve(load) end)
end
local more, again = mg:solve(f, { start = u })
ok(again.cycles == 0 or (more - u):max() < 1e-12, "from the solution nothing is left to do")
ok((mg:solve(K:star_values(0, f.values, "dual")) - u):max() < 1e-13, "a load as numbers")
raises("not nested", dm.multigrid, { dm.mesh { triangle = 2 }, dm.mesh { triangle = 3 } })
raises("not nested", dm.multigrid, { dm.mesh { triangle = 2 }, dm.mesh { grid = 4 } })
raises("not nested", dm.multigrid, { dm.mesh { icosphere = 1 }, dm.mesh { icosphere = 3 } })
raises("at least two meshes", dm.multigrid, { dm.mesh { triangle = 2 } })
raises("another dimension", dm.multigrid, { dm.mesh { triangle = 2 }, dm.mesh { cube_tiling = 2 } })
raises("is none", dm.multigrid, { dm.mesh { triangle = 2 }, 3 })
raises("none of the meshes", function() mg:prolong(cochain(K, 0)) end)
raises("153 numbers", function() dm.multigrid(meshes("triangle", 8, 2)):solve { 1, 2 } end)
-- thin tetrahedra lose no digits: a mesh whose cells are cut at an inner point has the same set, and its vertices stay
do
  for _, thin in ipairs { 1e-2, 1e-3, 1e-4 } do
    local points = { { 0, 0, 0 }, { 1, 0.1, 0 }, { 0.2, 1, 0 }, { 1.1, 1.2, thin }, { 0.6, 0.5, 1 } }
    local coarse = dm.mesh { points = points, simplices = { { 1, 2, 3, 4 }, { 1, 2, 4, 5 }, { 1, 3, 4, 5 } }, dual = "barycentric" }
    local more = { table.unpack(points) }
    more[6] = { 0, 0, 0 }
    for c = 1, 3 do for j, w in ipairs { 0.1, 0.3, 0.2, 0.4 } do more[6][c] = more[6][c] + w * points[j][c] end end
    local fine = dm.mesh { points = more, dual = "barycentric",
      simplices = { { 6, 2, 3, 4 }, { 1, 6, 3, 4 }, { 1, 2, 6, 4 }, { 1, 2, 3, 6 }, { 1, 2, 4, 5 }, { 1, 3, 4, 5 } } }
    local T, off = dm.remesh(coarse, fine):matrix(0), 0
    for v = 1, 5 do
      local unit = {}
      for i = 1, 5 do unit[i] = i == v and 1 or 0 end
      local x = T * dm.vector(unit)
      for i = 1, 5 do off = math.max(off, math.abs(x[i] - unit[i])) end
    end
    ok(off < 1e-14 / thin, ("thin cells of %g: vertices keep their values"):format(thin), off)
    local u = cochain(coarse, 1)
    ok((dm.remesh(coarse, fine)(u):d() - dm.remesh(coarse, fine)(u:d())):max() < 1e-13 / thin, "T d = d T there")
  end
end
tap.done()
