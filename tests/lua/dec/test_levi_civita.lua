-- the discrete Levi-Civita connection: deficits and holonomies, frames at random, flat meshes of
-- two to four dimensions, the printed rule, both kinds of edges, bad input (Leok 4.7.3, E10)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, cos, sin, pi, acos = math.abs, math.cos, math.sin, math.pi, math.acos

local stream = dm.random(47)

local function frames_of(n)
  if n == 2 then return function(i) return stream:uniform(i, 5, -pi, pi) end end
  local G = dm.SO(n)
  return function(i) return G:random(stream, i) end
end

local function total(list)
  local sum = 0
  for i = 1, #list do sum = sum + (list[i] or 0) end
  return sum
end

local function turn(R) return math.atan(R[2][1], R[1][1]) end
local function wrapped(x) return abs(math.atan(sin(x), cos(x))) end

---- surfaces ----

local bent = dm.mesh { torus = { 14, 10 }, radii = { 2, 0.7 }, map = function(x, y, z)
  return { x + 0.1 * sin(3 * y), y - 0.2 * z * z, z + 0.1 * x }
end }
local surfaces = { icosphere = dm.mesh { icosphere = 2 }, torus = bent,
  csaszar = dm.mesh { named = "csaszar7" }, octahedron = dm.mesh { cross_polytope = 3 } }
for name, K in pairs(surfaces) do
  if K.measured then
    local A = K:levi_civita { frames = frames_of(2) }
    local angle = A:angle()
    near(total(angle), 2 * pi * K.euler, 1e-11, name .. ": Gauss-Bonnet")
    local worst = 0
    for v = 1, K:count(0), 5 do
      worst = math.max(worst, wrapped(turn(A:curvature(v)) - angle[v]))
    end
    ok(worst < 1e-12, name .. ": holonomy round a vertex is its deficit, in frames at random", worst)
    local P = K:levi_civita { frames = frames_of(2), on = "primal" }
    local triangles = P:angle()
    near(total(triangles), 2 * pi * K.euler, 1e-11, name .. ": Gauss-Bonnet of triangles")
    worst = 0
    for t = 1, K:count(2), 5 do
      worst = math.max(worst, wrapped(turn(P:curvature(t)) - triangles[t]))
    end
    ok(worst < 1e-12, name .. ": holonomy round a triangle", worst)
  end
end

-- a loop of triangles turns by the deficits that it has on its left, up to whole turns: rings of
-- two neighbours, joined where they share two triangles
do
  local K = dm.mesh { icosphere = 1 }
  local A, angle = K:levi_civita(), K:levi_civita():angle()
  local edge = K:simplices(1)[7]
  local one, two = K:dual_ring(edge[1]), K:dual_ring(edge[2])
  local inside = {}
  for _, t in ipairs(one) do inside[t] = 1 end
  for _, t in ipairs(two) do inside[t] = (inside[t] or 0) + 2 end
  -- from where the first leaves the shared pair on, all of its own; then those of the other
  local function own_part(ring, mark)
    local start
    for k, t in ipairs(ring) do
      if inside[t] == mark and inside[ring[(k - 2) % #ring + 1]] == 3 then start = k end
    end
    local out = { ring[(start - 2) % #ring + 1] }
    for k = 0, #ring - 1 do
      local t = ring[(start + k - 1) % #ring + 1]
      if inside[t] ~= mark then break end
      out[#out + 1] = t
    end
    return out
  end
  local loop = own_part(one, 1)
  for _, t in ipairs(own_part(two, 2)) do loop[#loop + 1] = t end
  loop[#loop + 1] = loop[1]
  near(wrapped(turn(A:holonomy(loop)) - angle[edge[1]] - angle[edge[2]]), 0, 1e-12,
    "a loop round two vertices turns by both deficits")
  local v = dm.vector { 0.3, -0.8 }
  near((A:transport(loop, v) - A:holonomy(loop) * v):norm(), 0, 1e-15, "transport along it")
  near((A:transport({ 1 }, v) - v):norm(), 0, 0, "transport along one cell")
end

-- fractions of the sphere: the deficits of a fine mesh near the pole are its area
do
  local K = dm.mesh { icosphere = 5 }
  local angle, dual, points, sum, area = K:levi_civita():angle(), K:dual_volume(0), K:points(), 0, 0
  for v = 1, K:count(0) do
    if points[v][3] > 0.5 then sum, area = sum + angle[v], area + dual[v] end
  end
  near(sum / area, 1, 1e-3, "curvature of the unit sphere is 1")
end

-- a cone: its apex, and a flat boundary that has none
do
  local points, triangles = { { 0, 0, 0.5 } }, {}
  for k = 0, 5 do
    points[k + 2] = { cos(pi * k / 3), sin(pi * k / 3), 0 }
    triangles[k + 1] = { 1, k + 2, (k + 1) % 6 + 2 }
  end
  local K = dm.mesh { points = points, simplices = triangles }
  local A = K:levi_civita()
  local angle = A:angle()
  local side = math.sqrt(1.25)
  near(angle[1], 2 * pi - 12 * math.asin(0.5 / side), 1e-13, "apex of a cone")
  ok(angle[2] == false, "no curvature at the boundary")
  raises("lies on the boundary", function() return A:curvature(3) end)
  ok(#K:levi_civita { on = "primal" }:angle() == 6, "a fan at the boundary has directions")
  local F = A:frame(2)
  near((F:column(1):dot(F:column(2))), 0, 1e-14, "axes of a frame in space")
  near(F:column(1):norm() + F:column(2):norm(), 2, 1e-14, "are of length 1")
end

---- flat meshes of any dimension have no holonomy, in whatever frames ----

-- the cube of n dimensions cut along its diagonals (Kuhn), bent so that no cell is like another
local function kuhn(n, size)
  local points, number, simplices = {}, {}, {}
  local function add(at)
    local key = table.concat(at, " ")
    if not number[key] then
      points[#points + 1] = {}
      for i = 1, n do
        points[#points][i] = at[i] + 0.13 * sin(1.7 * at[i] + 2.1 * at[i % n + 1] + i)
      end
      number[key] = #points
    end
    return number[key]
  end
  local function paths(corner, rest, cell)
    if #rest == 0 then
      simplices[#simplices + 1] = cell
      return
    end
    for k, i in ipairs(rest) do
      local next_corner, left = { table.unpack(corner) }, {}
      next_corner[i] = next_corner[i] + 1
      for m, j in ipairs(rest) do if m ~= k then left[#left + 1] = j end end
      local grown = { table.unpack(cell) }
      grown[#grown + 1] = add(next_corner)
      paths(next_corner, left, grown)
    end
  end
  local function cubes(corner, i)
    if i > n then
      local rest = {}
      for k = 1, n do rest[k] = k end
      return paths(corner, rest, { add(corner) })
    end
    for k = 0, size - 1 do
      corner[i] = k
      cubes({ table.unpack(corner) }, i + 1)
    end
  end
  cubes({}, 1)
  return dm.mesh { points = points, simplices = simplices }
end

for n = 2, 4 do
  local K = kuhn(n, 2)
  local A = K:levi_civita { frames = frames_of(n) }
  local angle, inner, worst, off = A:angle(), 0, 0, 0
  local step = math.max(1, #angle // 60)
  for cell = 1, #angle do
    if angle[cell] then inner, worst = inner + 1, math.max(worst, abs(angle[cell])) end
    if angle[cell] and cell % step == 0 then
      local R = A:curvature(cell) - dm.identity(n)
      for i = 1, n do off = math.max(off, R:column(i):norm()) end
    end
  end
  ok(inner > 0 and worst < 1e-12, ("flat, n = %d: no angles"):format(n), worst)
  ok(off < 1e-12, ("flat, n = %d: no holonomy in frames at random"):format(n), off)
  if n > 2 then
    -- the printed rule is right in frames of one chart alone
    local most = 0
    for _, x in ipairs(K:levi_civita { frames = frames_of(n), rule = "thesis" }:angle()) do
      most = math.max(most, x or 0)
    end
    ok(most > 0.5, ("n = %d: the printed rule turns flat rings"):format(n), most)
    local axes = {}
    local own = K:levi_civita()
    for cell = 1, K:count(n) do axes[cell] = own:frame(cell):transpose() end
    local chart = K:levi_civita { frames = function(i) return axes[i] end, rule = "thesis" }
    worst = 0
    for _, x in ipairs(chart:angle()) do worst = math.max(worst, x or 0) end
    ok(worst < 1e-10, ("n = %d: but not in frames of one chart"):format(n), worst)
    local v = dm.zeros(n)
    v[1], v[2] = 0.3, 0.7
    local path = { 1 }
    for _, j in ipairs(K:cofaces(n - 1, K:faces(n, 1)[1])) do if j ~= 1 then path[2] = j end end
    if path[2] then
      local w = K:levi_civita { frames = function(i) return axes[i] end }:transport(path, v)
      near((w - v):norm(), 0, 1e-13, "there transport keeps a vector")
    end
  end
end

---- curved ones ----

local ring = { { 1, 2, 3, 4 }, { 1, 2, 4, 5 }, { 1, 2, 5, 6 }, { 1, 2, 6, 7 }, { 1, 2, 3, 7 } }
local regular = dm.mesh { simplices = ring, lengths = function() return 1 end }
near(regular:levi_civita():angle()[1], 2 * pi - 5 * acos(1 / 3), 1e-14, "five regular tetrahedra")
local seven = { { 1, 2, 3, 9 }, { 1, 2, 8, 9 } }
for k = 3, 7 do seven[k] = { 1, 2, k, k + 1 } end
near(dm.mesh({ simplices = seven, lengths = function() return 1 end }):levi_civita():angle()[1], 7 * acos(1 / 3) - 2 * pi, 1e-14,
  "seven of them: more than a turn")
local five = regular:levi_civita { frames = frames_of(3) }
near(dm.SO(3):log(five:curvature(1)):norm(), 2 * pi - 5 * acos(1 / 3), 1e-13,
  "the same by its rotations")
-- the boundary of the 4-simplex and of the 5-simplex: 3 and 3 regular simplices round a cell
near(dm.mesh { simplices = (function()
  local out = {}
  for i = 1, 5 do
    out[i] = {}
    for j = 1, 5 do if j ~= i then out[i][#out[i] + 1] = j end end
  end
  return out
end)(), lengths = function() return 1 end }:levi_civita():angle()[4], 2 * pi - 3 * acos(1 / 3),
  1e-13, "3-sphere of five tetrahedra")
local four = {}
for i = 1, 6 do
  four[i] = {}
  for j = 1, 6 do if j ~= i then four[i][#four[i] + 1] = j end end
end
local S4 = dm.mesh { simplices = four, lengths = function() return 1 end }
local expected = 2 * pi - 3 * acos(1 / 4)
near(S4:levi_civita():angle()[7], 2 * pi - expected < expected and 2 * pi - expected or expected,
  1e-13, "4-sphere of six simplices")
near(dm.SO(4):distance(S4:levi_civita { frames = frames_of(4) }:curvature(7), dm.identity(4)),
  S4:levi_civita():angle()[7], 1e-12, "by its rotations, which turn one plane")

-- a matrix a cell in place of lengths
local function gram(K)
  local n, length = K.dimension, K:volume(1)
  return function(cell)
    local v, g = K:simplices(n)[cell], {}
    local function square(i, j)
      return i == j and 0 or length[K:find { v[i], v[j] }] ^ 2
    end
    for i = 1, n do
      g[i] = {}
      for j = 1, n do g[i][j] = (square(1, i + 1) + square(1, j + 1) - square(i + 1, j + 1)) / 2 end
    end
    return g
  end
end
local octahedron = dm.mesh { points = { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1.3, 0 }, { 0, -1.3, 0 },
  { 0, 0, 0.7 }, { 0, 0, -0.7 } }, simplices = { { 1, 3, 5 }, { 1, 3, 6 }, { 1, 4, 5 }, { 1, 4, 6 },
  { 2, 3, 5 }, { 2, 3, 6 }, { 2, 4, 5 }, { 2, 4, 6 } } }
local by_points, by_matrix = octahedron:levi_civita():angle(),
  octahedron:levi_civita { metric = gram(octahedron) }:angle()
for v = 1, 6 do near(by_matrix[v], by_points[v], 1e-13, "a matrix a cell, vertex " .. v) end

---- no orientation: rotations may be reflections, angles stay ----

local strip = {}
for k = 0, 4 do strip[k + 1] = { k + 1, (k + 1) % 5 + 1, (k + 2) % 5 + 1 } end
local moebius = dm.mesh { simplices = strip, lengths = function() return 1 end }
ok(not moebius.orientable, "a Moebius band of five triangles")
local band = moebius:levi_civita()
local path, at = { 1 }, 1
local seen = { [1] = true }
for _ = 1, 4 do
  for _, e in ipairs(moebius:faces(2, at)) do
    for _, t in ipairs(moebius:cofaces(1, e)) do
      if not seen[t] and path[#path] == at then path[#path + 1], seen[t] = t, true end
    end
  end
  at = path[#path]
end
path[#path + 1] = 1
near(band:holonomy(path):det(), -1, 1e-13, "round it a frame comes back as its mirror image")
raises("oriented surfaces", function() return moebius:levi_civita { on = "primal" } end)
local klein = dm.mesh { klein = 6 }
if klein.measured then
  near(total(klein:levi_civita():angle()), 0, 1e-12, "Gauss-Bonnet of a Klein bottle")
end

---- errors ----

local K = dm.mesh { icosphere = 0 }
local A = K:levi_civita()
raises("dimension 1", function()
  return dm.mesh { simplices = { { 1, 2 }, { 2, 3 } }, lengths = function() return 1 end }
    :levi_civita()
end)
raises("no metric", function() return dm.mesh { simplices = { { 1, 2, 3 } } }:levi_civita() end)
raises("option 'rule'", function() return K:levi_civita { rule = "edge" } end)
raises("option 'on'", function() return K:levi_civita { on = "both" } end)
raises("goes with on", function() return K:levi_civita { on = "primal", rule = "thesis" } end)
raises("must be a rotation", function()
  return K:levi_civita { frames = function() return { { 1, 0 }, { 0, -1 } } end }
end)
raises("must be a matrix of 2 x 2", function()
  return K:levi_civita { frames = function() return dm.identity(3) end }
end)
raises("no neighbours", function() return A:rotation(1, 20) end)
raises("no such cell", function() return A:rotation(1, 21) end)
raises("no such cell", function() return A:curvature(13) end)
raises("not closed", function() return A:holonomy { 1, 2 } end)
raises("entry 2", function() return A:holonomy { 1, 99, 1 } end)
raises("entry 1", function() return A:transport({ 0 }, { 1, 0 }) end)
raises("must have 2 entries", function() return A:transport({ 1 }, { 1, 0, 0 }) end)
raises("no points", function() return regular:levi_civita():frame(1) end)
raises("do not agree", function()
  return dm.mesh { simplices = { { 1, 2, 3 }, { 1, 2, 4 } } }:levi_civita { metric = function(cell)
    return { { cell, 0 }, { 0, 1 } }
  end }
end)
raises("not positive definite", function()
  return dm.mesh { simplices = { { 1, 2, 3 } } }:levi_civita { metric = function()
    return { { -1, 0 }, { 0, 1 } }
  end }
end)
raises("no neighbours", function() return K:levi_civita { on = "primal" }:rotation(1, 99) end)
raises("there is no triangle", function() return K:levi_civita { on = "primal" }:curvature(99) end)
-- two tetrahedra boundaries that share a vertex; three triangles at an edge
local pinched = dm.mesh { simplices = { { 1, 2, 3 }, { 1, 2, 4 }, { 1, 3, 4 }, { 2, 3, 4 },
  { 1, 5, 6 }, { 1, 5, 7 }, { 1, 6, 7 }, { 5, 6, 7 } }, lengths = function() return 1 end }
raises("no manifold", function() return pinched:levi_civita():angle() end)
local book = dm.mesh { simplices = { { 1, 2, 3 }, { 1, 2, 4 }, { 1, 2, 5 } },
  lengths = function() return 1 end }
raises("no manifold", function() return book:levi_civita():angle() end)
-- a path over an edge of three triangles has no one continuation: {1, 2, 3, 1} gave a reflection
for _, torn in ipairs { pinched, book } do
  raises("no manifold: round {1}", torn.levi_civita, torn)
  raises("no manifold: round {1}", torn.levi_civita, torn, { on = "primal" })
end
local solids = dm.mesh { simplices = { { 1, 2, 3, 4 }, { 1, 5, 6, 7 } }, lengths = 1 }
ok(not solids.manifold and pcall(solids.levi_civita, solids), "what is pinched at a vertex alone has rings in space")
tap.done()
