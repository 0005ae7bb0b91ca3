-- meshes by name against their recipes, written out vertex by vertex: cells, points and volumes
local tap = require "tap"
local dm = require "dm"
local core = require "dm.core"
local ok, raises = tap.ok, tap.raises

-- a mesh of ids from 0
local function mesh(simplices, points, lengths)
  for _, s in ipairs(simplices) do
    for j = 1, #s do s[j] = s[j] + 1 end
  end
  return core.complex { simplices = simplices, points = points and core.matrix(points), lengths = lengths }
end

local function same(K, L, name)
  local fine = K.dimension == L.dimension
  for k = 0, K.dimension do
    local a, b = K:simplices(k), L:simplices(k)
    fine = fine and #a == #b and K:volume(k) == L:volume(k)
    for i = 1, #a do fine = fine and table.concat(a[i], " ") == table.concat(b[i] or {}, " ") end
  end
  if K.ambient then
    for i = 1, K:count(0) do fine = fine and K:points()[i] == L:points()[i] end
  end
  ok(fine, name .. " is its recipe, bit for bit")
end

local N, simplices, points = 4, {}, {}
for j = 0, N do
  for i = 0, N do points[#points + 1] = { i / N, j / N } end
end
for j = 0, N - 1 do
  for i = 0, N - 1 do
    local a = i + (N + 1) * j
    simplices[#simplices + 1] = { a, a + 1, a + N + 2 }
    simplices[#simplices + 1] = { a, a + N + 2, a + N + 1 }
  end
end
same(dm.mesh { grid = N }, mesh(simplices, points), "grid")

local row, at = {}, 0
simplices, points = {}, {}
for j = 0, N do
  row[j] = at
  for i = 0, N - j do points[#points + 1], at = { (i + j / 2) / N, j * math.sqrt(3) / 2 / N }, at + 1 end
end
for j = 0, N - 1 do
  for i = 0, N - 1 - j do
    simplices[#simplices + 1] = { row[j] + i, row[j] + i + 1, row[j + 1] + i }
    if i < N - 1 - j then simplices[#simplices + 1] = { row[j] + i + 1, row[j + 1] + i + 1, row[j + 1] + i } end
  end
end
same(dm.mesh { triangle = N }, mesh(simplices, points), "triangle")

local function torus(nu, nv, shift)
  local out = {}
  local function id(i, j)
    if j == nv then i, j = i + shift, 0 end
    return i % nu + nu * j
  end
  for j = 0, nv - 1 do
    for i = 0, nu - 1 do
      out[#out + 1] = { id(i, j), id(i + 1, j), id(i, j + 1) }
      out[#out + 1] = { id(i + 1, j), id(i + 1, j + 1), id(i, j + 1) }
    end
  end
  return out
end
same(dm.mesh { hex_torus = 5 }, mesh(torus(5, 5, 0), nil, 1 / 5), "hex_torus")
points = {}
for j = 0, 5 do
  for i = 0, 8 do
    local u, v = 2 * math.pi * (i + j / 2) / 9, 2 * math.pi * j / 6
    points[#points + 1] = { (3 + math.cos(v)) * math.cos(u), (3 + math.cos(v)) * math.sin(u), math.sin(v) }
  end
end
same(dm.mesh { torus = { 9, 6 }, radii = { 3, 1 } }, mesh(torus(9, 6, 3), points), "torus")

simplices, points = {}, {}
for r = 0, 3 do
  for i = 0, 6 do
    local radius, angle = 1.5 ^ (r / 3), 2 * math.pi * (i + r / 2) / 7
    points[#points + 1] = { radius * math.cos(angle), radius * math.sin(angle) }
    local next_ = (i + 1) % 7
    if r < 3 then
      simplices[#simplices + 1] = { 7 * r + i, 7 * (r + 1) + i, 7 * r + next_ }
      simplices[#simplices + 1] = { 7 * r + next_, 7 * (r + 1) + i, 7 * (r + 1) + next_ }
    end
  end
end
same(dm.mesh { annulus = { 3, 7 }, ratio = 1.5 }, mesh(simplices, points), "annulus")

-- body-centred: two centres and an edge of the square between them
N, simplices = 3, {}
local function corner(p) return p[1] % N + N * (p[2] % N + N * (p[3] % N)) end
for cube = 0, N ^ 3 - 1 do
  local p = { cube % N, cube // N % N, cube // (N * N) }
  for a = 1, 3 do
    local b, c = a % 3 + 1, (a + 1) % 3 + 1
    local function moved(x, y)
      local q = { table.unpack(p) }
      q[a], q[b], q[c] = q[a] + 1, q[b] + x, q[c] + y
      return q
    end
    local square = { moved(0, 0), moved(1, 0), moved(1, 1), moved(0, 1) }
    for e = 1, 4 do
      simplices[#simplices + 1] = { 27 + corner(p), 27 + corner(square[1]), corner(square[e]),
        corner(square[e % 4 + 1]) }
    end
  end
end
same(dm.mesh { bcc = N }, mesh(simplices, nil, function(i, j)
  return ((i <= 27) == (j <= 27) and 1 or math.sqrt(3) / 2) / N
end), "bcc")

N, simplices, points = 2, {}, {}
for v = 0, 26 do points[v + 1] = { v % 3 / N, v // 3 % 3 / N, v // 9 / N } end
for cube = 0, 7 do
  local first = cube % 2 + 3 * (cube // 2 % 2) + 9 * (cube // 4)
  for _, o in ipairs { { 1, 3, 9 }, { 1, 9, 3 }, { 3, 1, 9 }, { 3, 9, 1 }, { 9, 1, 3 }, { 9, 3, 1 } } do
    simplices[#simplices + 1] = { first, first + o[1], first + o[1] + o[2], first + 13 }
  end
end
same(dm.mesh { cube_tiling = N }, mesh(simplices, points), "cube_tiling")

-- the icosphere, midpoints where an edge is first met
local g = (1 + math.sqrt(5)) / 2
local function on_sphere(x, y, z)
  local r = math.sqrt(x * x + y * y + z * z)
  return { x / r, y / r, z / r }
end
points = {}
for i, p in ipairs { { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 }, { 1, -g, 0 }, { 0, -1, g }, { 0, 1, g }, { 0, -1, -g },
  { 0, 1, -g }, { g, 0, -1 }, { g, 0, 1 }, { -g, 0, -1 }, { -g, 0, 1 } } do
  points[i] = on_sphere(table.unpack(p))
end
simplices = {}
for a, b, c in ("0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8 3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 "
  .. "4 9 5 2 4 11 6 2 10 8 6 7 9 8 1 "):gmatch "(%d+) (%d+) (%d+) " do
  simplices[#simplices + 1] = { tonumber(a), tonumber(b), tonumber(c) }
end
for _ = 1, 3 do
  local middle, out = {}, {}
  local function half(a, b)
    local key, p, q = math.min(a, b) .. " " .. math.max(a, b), points[a + 1], points[b + 1]
    if not middle[key] then
      points[#points + 1] = on_sphere(p[1] + q[1], p[2] + q[2], p[3] + q[3])
      middle[key] = #points - 1
    end
    return middle[key]
  end
  for _, f in ipairs(simplices) do
    local a, b, c = f[1], f[2], f[3]
    local ab, bc, ca = half(a, b), half(b, c), half(c, a)
    for _, part in ipairs { { a, ab, ca }, { b, bc, ab }, { c, ca, bc }, { ab, bc, ca } } do out[#out + 1] = part end
  end
  simplices = out
end
same(dm.mesh { icosphere = 3 }, mesh(simplices, points), "icosphere")

raises("icosphere must be from 0 to 12", dm.mesh, { icosphere = 13 })
raises("too many", dm.mesh, { grid = 100000 })
raises("too many", dm.mesh, { cube_tiling = 10000000 })
raises("whole number", dm.mesh, { bcc = 2 })
tap.done()
