-- operators of a mesh as sparse matrices, against the same operators on forms, in dimensions 1 to 4
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function cochain(K, k, options)
  local cells, x = options and options.dual and K.dimension - k or k, {}
  for i = 1, K:count(cells) do x[i] = math.sin(7 * i + i * i) end
  return K:form(k, x, options)
end

-- a mesh with its vertices in another order, moved a little
local function shuffled(name, size, seed)
  local K = dm.mesh { [name] = size }
  local random, order = dm.random(seed), {}
  for i = 1, K:count(0) do order[i] = i end
  for i = #order, 2, -1 do
    local j = 1 + math.floor(random:uniform(i, 1) * i)
    order[i], order[j] = order[j], order[i]
  end
  local points, simplices = {}, {}
  for i, p in ipairs(order) do
    points[p] = {}
    for c = 1, K.ambient do points[p][c] = K:points()[i][c] + 0.02 * random:uniform(i, 2 + c) / size end
  end
  for i, cell in ipairs(K:simplices(K.dimension)) do
    simplices[i] = {}
    for j, v in ipairs(cell) do simplices[i][j] = order[v] end
  end
  return dm.mesh { points = points, simplices = simplices }
end

local meshes = {
  dm.mesh { points = { { 0 }, { 0.3 }, { 1 }, { 1.2 } }, simplices = { { 1, 2 }, { 2, 3 }, { 3, 4 } } },
  shuffled("triangle", 4, 1), shuffled("icosphere", 1, 2), dm.mesh { hex_torus = 4 },
  dm.mesh { bcc = 3 }, dm.mesh { simplex_boundary = 5 }, dm.mesh { cross_polytope = 4 },
}
local worst = { d = 0, dual = 0, star = 0, laplacian = 0 }
for _, K in ipairs(meshes) do
  local n = K.dimension
  local function note(what, a, b) worst[what] = math.max(worst[what], (a - b):max()) end
  for k = 0, n do
    local a, b = cochain(K, k), cochain(K, k, { dual = true })
    if k < n then
      note("d", K:d(k) * a, a:d())
      note("dual", K:d(k, { dual = true }) * b, b:d())
    end
    if k > 0 and k < n and (K:d(k) * K:d(k - 1)).nonzeros ~= 0 then worst.d = 1 end
    note("star", K:star(k) * a, a:star())
    note("star", K:star(k, { dual = true }) * b, b:star())
    local delta_d = k < n and a:d():delta() or 0 * a
    local d_delta = k > 0 and a:delta():d() or 0 * a
    local size = (delta_d + d_delta):max()
    note("laplacian", K:laplacian(k) * a / size, (delta_d + d_delta) / size)
    note("laplacian", K:laplacian(k, { part = "up" }) * a / size, delta_d / size)
    note("laplacian", K:laplacian(k, { part = "down" }) * a / size, d_delta / size)
  end
end
ok(worst.d < 1e-14 and worst.dual < 1e-14, "d of both sides is that of forms, d d = 0", worst.d)
ok(worst.star < 1e-15 * 100, "so is the star", worst.star)
ok(worst.laplacian < 1e-12, "and the Laplacian with its parts", worst.laplacian)

local K = dm.mesh { triangle = 4 }
local f = cochain(K, 0)
local L, B = K:laplacian(0), K:laplace_beltrami()
ok(((L + B) * f):max() < 1e-13 and ((2 * L - L) * f - L * f):max() < 1e-12
  and (L * 3 * f + 3 * (B * f)):max() < 1e-11 and (-L * f - B * f):max() == 0,
  "sums and multiples; div grad is the negative one")
ok((K:star(1) * K:d(0)).to.side == "dual" and K:d(0).nonzeros == 2 * K:count(1), "kinds, entries")
-- delta of 1-forms made of the operators (Leok, Def 3.19)
local a = cochain(K, 1)
local delta = -1 * K:star(2, { dual = true }) * K:d(1, { dual = true }) * K:star(1)
ok((delta * a - a:delta()):max() < 1e-12, "- star d star is delta")

-- fixed cells and their faces take no part
local inner = K:laplacian(1, { fixed = "boundary" }) * a
local on = {}
for _, i in ipairs(K:boundary_cells(1)) do on[i] = true end
local zero = true
for i = 1, #inner do zero = zero and (not on[i] or inner[i] == 0) end
ok(zero and inner:max() > 0, "a fixed boundary")
ok((K:laplacian(1, { fixed = K:boundary_cells(1) }) * a - inner):max() < 1e-12, "the same by cells")

raises("takes primal 0-forms", function() return K:d(0) * a end)
raises("two meshes", function() return K:d(0) * cochain(dm.mesh { triangle = 3 }, 0) end)
raises("the left one takes", function() return K:d(0) * K:d(0) end)
raises("one maps", function() return K:d(0) + K:d(1) end)
raises("degree from 0 to 1", function() return K:d(2) end)
raises("fixed must be", function() return K:laplacian(0, { fixed = 3 }) end)
raises("no cell 99", function() return K:laplacian(0, { fixed = { 99 } }) end)
local right = dm.mesh { grid = 2 }
local b = cochain(right, 1)
raises("zero dual volume at simplex {1, 5}", function() return right:laplacian(1) * b end)
raises("zero dual", function() return right:laplacian(2) end)
ok((right:laplacian(1, { pinv = true }) * b):at { 1, 5 } == 0, "pinv")
raises("metric", function() return dm.mesh { simplices = { { 1, 2, 3 } } }:laplacian(0) end)
ok(dm.mesh { named = "rp2" }:laplacian(1):eigen(1).values[1] > 1, "Laplacians need no orientation")
tap.done()
