--- Meshes by name: dm.mesh { icosphere = 4 } and its like. Each is a function of its argument that
-- returns what dm.complex takes; ids are from 1. Recipes: the numbering decides the order of cells,
-- so it is fixed here.
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local sqrt, pi, sin, cos = math.sqrt, math.pi, math.sin, math.cos
local fail = option.failing "dm.mesh"

local MOST_DIMENSIONS, MOST_VERTICES = 8, 2 ^ 31 - 1 -- of dm.complex

local function whole(x, name, least, most)
  if math.type(x) ~= "integer" or x < least or most and x > most then
    fail("%s must be a whole number %s (got %s)", name,
      most and ("from %d to %d"):format(least, most) or ">= " .. least, option.got(x))
  end
  return x
end

-- Raises before a vertex is made: rows of so many.
local function check_size(rows, of)
  local vertices = 1.0 * rows * of
  if vertices > MOST_VERTICES then fail("%g vertices are too many for a mesh", vertices) end
end

local function pair_of(x, name, least1, least2)
  if type(x) ~= "table" or #x ~= 2 then fail("%s must be a list of two whole numbers", name) end
  return whole(x[1], name .. "[1]", least1), whole(x[2], name .. "[2]", least2)
end

---- of the plane ----

local SQUARE = { 0, 0, 1, 0, 1, 1,  0, 0, 1, 1, 0, 1 } -- cut along the diagonal to (1, 1)
-- axes i, r of an annulus: (r, i) (r + 1, i) (r, i + 1) and (r, i + 1) (r + 1, i) (r + 1, i + 1)
local TURNED_OUT = { 0, 0, 0, 1, 1, 0,  1, 0, 0, 1, 1, 1 }
local TURNED = { 0, 0, 1, 0, 0, 1,  1, 0, 1, 1, 0, 1 } -- along that from (1, 0) to (0, 1)

--- grid = N: the unit square in N x N squares, each cut along its diagonal to (1, 1).
function M.grid(N)
  whole(N, "grid", 1)
  local cells, vertices = { N, N }, { N + 1, N + 1 }
  return { points = core.lattice(cells, vertices), degree = 2,
    simplices = core.tiling(cells, vertices, SQUARE) }
end

--- triangle = N: the equilateral triangle of side 1 in N^2 equilateral ones.
function M.triangle(N)
  whole(N, "triangle", 1)
  check_size(N, N)
  local points, ids, row = {}, {}, {}
  for j = 0, N do
    row[j] = #points
    for i = 0, N - j do points[#points + 1] = { (i + j / 2) / N, j * sqrt(3) / 2 / N } end
  end
  local count = 0
  local function add(a, b, c)
    ids[count + 1], ids[count + 2], ids[count + 3] = a, b, c
    count = count + 3
  end
  for j = 0, N - 1 do
    for i = 0, N - 1 - j do
      local a, b = 1 + row[j] + i, 1 + row[j + 1] + i
      add(a, a + 1, b)
      if i < N - 1 - j then add(a + 1, b + 1, b) end
    end
  end
  return { points = points, simplices = core.vector(ids), degree = 2 }
end

--- annulus = {rings, m}, ratio =: rings of m vertices, each turned by half a step against the last.
function M.annulus(given, options)
  local rings, m = pair_of(given, "annulus", 1, 3)
  local ratio = options.ratio
  if type(ratio) ~= "number" or not (ratio > 1) then
    fail("ratio must be a number > 1, of the outer radius to the inner (got %s)",
      option.got(ratio))
  end
  check_size(rings, m)
  local points = {}
  for r = 0, rings do
    for i = 0, m - 1 do
      local radius, angle = ratio ^ (r / rings), 2 * pi * (i + r / 2) / m
      points[#points + 1] = { radius * cos(angle), radius * sin(angle) }
    end
  end
  return { points = points, degree = 2,
    simplices = core.tiling({ m, rings }, { m, rings + 1 }, TURNED_OUT) }
end

---- surfaces without a plane ----

--- hex_torus = N: the flat torus of N^2 vertices, all edges 1/N.
function M.hex_torus(N)
  whole(N, "hex_torus", 3)
  return { simplices = core.tiling({ N, N }, { N, N }, TURNED), degree = 2, lengths = 1 / N }
end

--- square_torus = N: the flat unit torus, squares cut along the diagonal from (1, 0) to (0, 1).
function M.square_torus(N)
  whole(N, "square_torus", 3)
  local function length(a, b)
    local i, j = (b - 1) % N - (a - 1) % N, (b - 1) // N - (a - 1) // N
    local is_straight = i % N == 0 or j % N == 0
    return (is_straight and 1 or sqrt(2)) / N
  end
  return { simplices = core.tiling({ N, N }, { N, N }, TURNED), degree = 2, lengths = length }
end

--- torus = {nu, nv}, radii = {R, r}: the torus in space, every other ring turned by half a step.
function M.torus(given, options)
  local nu, nv = pair_of(given, "torus", 3, 4)
  local radii = options.radii or {}
  if nv % 2 ~= 0 then fail("torus[2] must be even, as every other ring is turned (got %d)", nv) end
  if type(radii) ~= "table" then radii = {} end
  local R, r = radii[1], radii[2]
  if type(R) ~= "number" or type(r) ~= "number" or not (R > r and r > 0) then
    fail("radii must be { R, r } with R > r > 0")
  end
  check_size(nu, nv)
  local points = {}
  for j = 0, nv - 1 do
    for i = 0, nu - 1 do
      local u, v = 2 * pi * (i + j / 2) / nu, 2 * pi * j / nv
      local a = R + r * cos(v)
      points[#points + 1] = { a * cos(u), a * sin(u), r * sin(v) }
    end
  end
  return { points = points, degree = 2,
    simplices = core.tiling({ nu, nv }, { nu, nv }, TURNED, nv // 2) }
end

--- klein = n: Klein's bottle of n x n squares, edges 1.
function M.klein(n)
  whole(n, "klein", 3)
  check_size(n, n)
  local simplices = {}
  local function id(i, j)
    if i == n then i, j = 0, n - j end
    return 1 + i + n * (j % n)
  end
  for j = 0, n - 1 do
    for i = 0, n - 1 do
      simplices[#simplices + 1] = { id(i, j), id(i + 1, j), id(i + 1, j + 1) }
      simplices[#simplices + 1] = { id(i, j), id(i + 1, j + 1), id(i, j + 1) }
    end
  end
  return { simplices = simplices, lengths = 1 }
end

--- icosphere = s: the icosahedron, s times split in four, on the unit sphere.
function M.icosphere(s)
  local ids, points = core.icosphere(whole(s, "icosphere", 0))
  return { points = points, simplices = ids, degree = 2 }
end

---- in space ----

-- The tetrahedra round the squares between a cube and its neighbours in directions x, y, z: both
-- centres and an edge of the square. A fourth axis tells corners (0) from centres (1).
local function bcc_pattern()
  local out = {}
  for a = 0, 2 do
    local b, c = (a + 1) % 3, (a + 2) % 3
    local function add(x, y, z, is_centre)
      local p = { 0, 0, 0, is_centre }
      p[a + 1], p[b + 1], p[c + 1] = x, y, z
      table.move(p, 1, 4, #out + 1, out)
    end
    local square = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } }
    for e = 1, 4 do
      local from, to = square[e], square[e % 4 + 1]
      add(0, 0, 0, 1)
      add(1, 0, 0, 1)
      add(1, from[1], from[2], 0)
      add(1, to[1], to[2], 0)
    end
  end
  return out
end

--- bcc = N: the flat unit 3-torus in tetrahedra of the body-centred cubic lattice.
function M.bcc(N)
  whole(N, "bcc", 3)
  local cubes = N * N * N
  local function length(a, b) return ((a <= cubes) == (b <= cubes) and 1 or sqrt(3) / 2) / N end
  return { simplices = core.tiling({ N, N, N, 1 }, { N, N, N, 2 }, bcc_pattern()), degree = 3,
    lengths = length }
end

-- the six orders of three axes
local ORDERS = { { 1, 2, 3 }, { 1, 3, 2 }, { 2, 1, 3 }, { 2, 3, 1 }, { 3, 1, 2 }, { 3, 2, 1 } }

-- from a corner of the cube along the axes in one order after the other
local function cube_pattern()
  local out = {}
  for _, order in ipairs(ORDERS) do
    local p = { 0, 0, 0 }
    table.move(p, 1, 3, #out + 1, out)
    for _, axis in ipairs(order) do
      p[axis] = 1
      table.move(p, 1, 3, #out + 1, out)
    end
  end
  return out
end

--- cube_tiling = N: the unit cube in N^3 cubes, each in six tetrahedra round its diagonal.
function M.cube_tiling(N)
  whole(N, "cube_tiling", 1)
  local cells, vertices = { N, N, N }, { N + 1, N + 1, N + 1 }
  return { points = core.lattice(cells, vertices), degree = 3,
    simplices = core.tiling(cells, vertices, cube_pattern()) }
end

---- of any dimension ----

--- simplex_boundary = m: all facets of an m-simplex with edges 1.
function M.simplex_boundary(m)
  whole(m, "simplex_boundary", 2, MOST_DIMENSIONS + 1)
  local simplices = {}
  for left_out = 1, m + 1 do
    local facet = {}
    for v = 1, m + 1 do facet[#facet + 1] = v ~= left_out and v or nil end
    simplices[left_out] = facet
  end
  return { simplices = simplices, lengths = 1 }
end

--- cross_polytope = m: its boundary; 2i - 1 and 2i are opposite; edges sqrt 2.
function M.cross_polytope(m)
  whole(m, "cross_polytope", 2, MOST_DIMENSIONS + 1)
  local simplices = {}
  for choice = 0, (1 << m) - 1 do
    local facet = {}
    for i = 1, m do facet[i] = 2 * i - 1 + (choice >> (i - 1) & 1) end
    simplices[#simplices + 1] = facet
  end
  return { simplices = simplices, lengths = sqrt(2) }
end

--- shells = {n, L}: a ball of dimension n in L shells of a cross-polytope round a centre, whose
-- prisms are cut so that every geometric cone from the centre is a sum of simplices (Leok, Ex
-- 3.10).
function M.shells(given)
  local n, L = pair_of(given, "shells", 1, 1)
  whole(n, "shells[1]", 1, MOST_DIMENSIONS)
  check_size(2 * n, L)
  local points, simplices, zero = {}, {}, {}
  for c = 1, n do zero[c] = 0 end
  points[1] = zero
  for r = 1, L do
    for ray = 1, 2 * n do
      local p = table.move(zero, 1, n, 1, {})
      p[(ray + 1) // 2] = ray % 2 == 1 and r or -r
      points[#points + 1] = p
    end
  end
  local function id(r, ray) return 1 + (r - 1) * 2 * n + ray end
  for _, facet in ipairs(n > 1 and M.cross_polytope(n).simplices or { { 1 }, { 2 } }) do
    local first = { 1 }
    for i, ray in ipairs(facet) do first[i + 1] = id(1, ray) end
    simplices[#simplices + 1] = first
    for r = 1, L - 1 do
      local rays = {}
      for i = 1, n do rays[i] = r % 2 == 1 and facet[i] or facet[n + 1 - i] end
      for i = 1, n do -- o_1 .. o_i, i_i .. i_n
        local prism = {}
        for j = 1, i do prism[#prism + 1] = id(r + 1, rays[j]) end
        for j = i, n do prism[#prism + 1] = id(r, rays[j]) end
        simplices[#simplices + 1] = prism
      end
    end
  end
  return { points = points, simplices = simplices }
end

---- single ones ----

local NAMED = {}

-- Csaszar's torus of 7 vertices
function NAMED.csaszar7()
  local out = {}
  for i = 0, 6 do
    out[#out + 1] = { i + 1, (i + 1) % 7 + 1, (i + 3) % 7 + 1 }
    out[#out + 1] = { i + 1, (i + 2) % 7 + 1, (i + 3) % 7 + 1 }
  end
  return out
end

-- the projective plane of 6 vertices
function NAMED.rp2()
  return { { 1, 2, 3 }, { 1, 3, 4 }, { 1, 4, 5 }, { 1, 5, 6 }, { 1, 2, 6 }, { 2, 3, 5 },
    { 3, 4, 6 },
    { 2, 4, 5 }, { 3, 5, 6 }, { 2, 4, 6 } }
end

-- the dunce hat of 8 vertices: contractible, but no cell can be collapsed
function NAMED.dunce()
  return { { 1, 2, 4 }, { 1, 2, 5 }, { 1, 2, 6 }, { 1, 3, 6 }, { 1, 3, 7 }, { 1, 3, 8 },
    { 1, 4, 5 }, { 1, 7, 8 }, { 2, 3, 4 }, { 2, 3, 5 }, { 2, 3, 7 }, { 2, 6, 7 }, { 3, 4, 8 },
    { 3, 5, 6 },
    { 4, 5, 6 }, { 4, 6, 7 }, { 4, 7, 8 } }
end

--- named = "csaszar7" | "rp2" | "dunce": edges 1.
function M.named(name)
  if not NAMED[name] then
    fail('named must be "csaszar7", "rp2" or "dunce" (got %s)', option.got(name))
  end
  return { simplices = NAMED[name](), lengths = 1 }
end

--- The names, for the check of options.
M.names = { "grid", "triangle", "annulus", "hex_torus", "square_torus", "torus", "klein",
  "icosphere", "bcc", "cube_tiling", "simplex_boundary", "cross_polytope", "shells", "named" }

-- 4.0 as 4, also in a list
local function whole_numbers(size)
  if type(size) == "number" then return math.tointeger(size) or size end
  if type(size) ~= "table" then return size end
  local out = {}
  for key, x in pairs(size) do out[key] = whole_numbers(x) end
  return out
end

--- What dm.complex takes, points as a dm.matrix; simplices are lists, or with degree a dm.vector.
function M.make(name, options)
  local made = M[name](whole_numbers(options[name]), options)
  made.points = made.points and core.matrix(made.points)
  return made
end

return M
