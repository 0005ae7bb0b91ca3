-- homology of spaces that are known, induced maps, appendix A; random complexes against ranks
-- counted in another way
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function same(a, b)
  local equal = #a == #b
  for i = 1, #b do equal = equal and a[i] == b[i] end
  return equal
end

local moore = {} -- a disc whose boundary of 9 edges is wound three times round a triangle
for i = 0, 8 do
  local j = (i + 1) % 9
  for _, t in ipairs { { i % 3 + 1, j % 3 + 1, i + 4 }, { j % 3 + 1, i + 4, j + 4 },
    { i + 4, j + 4, 13 } } do moore[#moore + 1] = t end
end
-- Betti numbers, torsion of degree 1
for _, row in ipairs { { { simplices = moore }, { 1, 0, 0 }, { 3 } },
  { { klein = 4 }, { 1, 1, 0 }, { 2 } }, { { named = "rp2" }, { 1, 0, 0 }, { 2 } },
  { { named = "csaszar7" }, { 1, 2, 1 }, {} }, { { named = "dunce" }, { 1, 0, 0 }, {} },
  { { bcc = 3 }, { 1, 3, 3, 1 }, {} }, { { icosphere = 1 }, { 1, 0, 1 }, {} },
  { { hex_torus = 4 }, { 1, 2, 1 }, {} }, { { annulus = { 2, 7 }, ratio = 2 }, { 1, 1, 0 }, {} },
  { { simplex_boundary = 7 }, { 1, 0, 0, 0, 0, 0, 1 }, {} },
  { { cross_polytope = 5 }, { 1, 0, 0, 0, 1 }, {} }, { { grid = 3 }, { 1, 0, 0 }, {} },
  -- not pure, not connected: a circle, a filled triangle and a point
  { { simplices = { { 1, 2 }, { 2, 3 }, { 1, 3 }, { 4, 5, 6 }, { 7 } } }, { 3, 1, 0 }, {} } } do
  local K = dm.mesh(row[1])
  ok(same(K:betti(), row[2]), "Betti numbers of " .. tostring(K), table.concat(K:betti(), " "))
  ok(same(K:homology(1).torsion, row[3]), "torsion")
  local sum = 0
  for k = 0, K.dimension do sum = sum + (-1) ^ k * K:betti()[k + 1] end
  ok(sum == K.euler, "their alternating sum is Euler's number")
end

-- generators are cycles whose classes are a basis
for _, K in ipairs { dm.mesh { bcc = 3 }, dm.mesh { klein = 4 }, dm.mesh { hex_torus = 5 } } do
  for k = 1, K.dimension do
    local group = K:homology(k)
    for _, c in ipairs(group.generators) do
      ok(#c:boundary():support() == 0 and #c:support() > 0, "a generator is a cycle")
    end
    local identity = {}
    for i = 1, K:count(0) do identity[i] = i end
    local matrix = dm.simplicial_map(K, K, identity):homology(k)
    local unit = #matrix == group.betti
    for i, line in ipairs(matrix) do
      for j, x in ipairs(line) do unit = unit and x == (i == j and 1 or 0) end
    end
    ok(unit, "the identity is the identity on homology")
  end
end
-- twice a torsion generator is a boundary, once it is not: the lattice of boundaries grows by it
local klein = dm.mesh { klein = 4 }
local torsion = klein:homology(1).of_torsion[1]
local function index_with(times) -- product of the factors of [d_2, times torsion]
  local rows, product = {}, 1
  for i = 1, klein:count(1) do
    rows[i] = {}
    for j = 1, klein:count(2) do rows[i][j] = 0 end
    rows[i][klein:count(2) + 1] = times * torsion[i]
  end
  for j = 1, klein:count(2) do
    for s, face in ipairs(klein:faces(2, j)) do rows[face][j] = s % 2 == 1 and 1 or -1 end
  end
  for _, factor in ipairs(dm.smith(rows).factors) do product = product * factor end
  return product
end
ok(index_with(0) == 2 and index_with(2) == 2, "twice the torsion generator is a boundary")
ok(index_with(1) == 1, "once it is none")

-- relative to the boundary: Lefschetz duality, H_k(K, dK) = H^(n - k)(K)
for _, K in ipairs { dm.mesh { grid = 3 }, dm.mesh { shells = { 3, 2 } },
  dm.mesh { annulus = { 2, 8 }, ratio = 1.5 } } do
  local betti, n = K:betti(), K.dimension
  for k = 0, n do
    ok(K:homology(k, { relative = "boundary" }).betti == betti[n - k + 1], "Lefschetz duality")
  end
end
local disc = dm.mesh { simplices = { { 1, 2, 3 } } }
local cut = disc:homology(1, { relative = { { 1 }, { 2 }, { 3 } } })
ok(cut.betti == 2 and #cut.generators == 2, "relative to three points")

-- random complexes: ranks modulo a large prime, by elimination of the whole boundary
local function rank_modulo(rows, p)
  local rank, pivots = 0, {}
  for _, row in ipairs(rows) do
    local r = {}
    for j, x in pairs(row) do r[j] = x % p end
    for _, pivot in ipairs(pivots) do
      local x = r[pivot.at] or 0
      if x ~= 0 then
        for j, y in pairs(pivot.row) do r[j] = ((r[j] or 0) - x * y) % p end
      end
    end
    local at
    for j, x in pairs(r) do if x ~= 0 and (not at or j < at) then at = j end end
    if at then
      local inverse = 1
      for _ = 1, p - 2 do inverse = inverse * r[at] % p end
      for j, x in pairs(r) do r[j] = x * inverse % p end
      pivots[#pivots + 1] = { at = at, row = r }
      rank = rank + 1
    end
  end
  return rank
end

local random = dm.random(7)
local draws = 0
local function draw(n)
  draws = draws + 1
  return 1 + math.floor(random:uniform(draws, 0) * n)
end
for trial = 1, 25 do
  local dimension, simplices, seen = 1 + trial % 4, {}, {}
  for _ = 1, 14 do
    local simplex, used = {}, {}
    for _ = 0, dimension do
      local v = draw(9)
      if not used[v] then
        used[v] = true
        simplex[#simplex + 1] = v
      end
    end
    table.sort(simplex)
    local key = table.concat(simplex, " ")
    if not seen[key] then simplices[#simplices + 1] = simplex end
    seen[key] = true
  end
  local K = dm.mesh { simplices = simplices }
  local ranks = { [0] = 0, [K.dimension + 1] = 0 }
  for k = 1, K.dimension do
    local rows = {}
    for cell = 1, K:count(k) do
      rows[cell] = {}
      for j, face in ipairs(K:faces(k, cell)) do rows[cell][face] = j % 2 == 1 and 1 or -1 end
    end
    ranks[k] = rank_modulo(rows, 211)
  end
  local fine = true
  for k = 0, K.dimension do
    local free, betti = K:count(k) - ranks[k] - ranks[k + 1], K:betti()[k + 1]
    fine = fine and betti == free
  end
  ok(fine, "Betti numbers of a random complex", table.concat(K:betti(), " "))
  ok(K:cone():check() == 0, "d p + p d = 1 - projection")
end

---- maps ----

local octahedron = dm.mesh { cross_polytope = 3 }
local antipodal = dm.simplicial_map(octahedron, octahedron, { 2, 1, 4, 3, 6, 5 })
ok(antipodal:homology(2)[1][1] == -1, "degree of the antipodal map of S^2")
local four = dm.mesh { cross_polytope = 4 }
ok(dm.simplicial_map(four, four, { 2, 1, 4, 3, 6, 5, 8, 7 }):homology(3)[1][1] == 1, "of S^3")
local hexagon = dm.mesh { simplices = { { 1, 2 }, { 2, 3 }, { 3, 4 }, { 4, 5 }, { 5, 6 }, { 1, 6 } } }
local triangle = dm.mesh { simplices = { { 1, 2 }, { 2, 3 }, { 1, 3 } } }
local wound = dm.simplicial_map(hexagon, triangle, { 1, 2, 3, 1, 2, 3 })
ok(math.abs(wound:homology(1)[1][1]) == 2, "a hexagon wound twice round a triangle")
ok(dm.simplicial_map(hexagon, triangle, { 1, 2, 1, 2, 1, 2 }):homology(1)[1][1] == 0, "and folded")
local x = {}
for i = 1, octahedron:count(1) do x[i] = (i * i * 7) % 11 - 5 end
local a = octahedron:form(1, x)
ok(antipodal:pull(a:d()) == antipodal:pull(a):d(), "pull backs commute with d")
local c = octahedron:chain(2, { { 3, { 1, 3, 5 } }, { -2, { 2, 3, 6 } } })
ok(antipodal:push(c):boundary() == antipodal:push(c:boundary()), "and chains with boundaries")
ok(antipodal:pull(a):pair(c:boundary()) == a:pair(antipodal:push(c:boundary())), "dual to each other")
raises("no simplex", function() dm.simplicial_map(triangle, hexagon, { 1, 3, 5 }) end)
raises("vertices[3]", function() dm.simplicial_map(triangle, hexagon, { 1, 2 }) end)
raises("4 vertices", function() dm.simplicial_map(triangle, hexagon, { 1, 2, 3, 4 }) end)

---- appendix A ----

local function times(A, B)
  local out = {}
  for i, row in ipairs(A) do
    out[i] = {}
    for j = 1, #B[1] do
      out[i][j] = 0
      for k, y in ipairs(row) do out[i][j] = out[i][j] + y * B[k][j] end
    end
  end
  return out
end
local function equal(A, B)
  for i, row in ipairs(B) do
    for j, y in ipairs(row) do if math.abs(A[i][j] - y) > 1e-12 then return false end end
  end
  return #A == #B
end
for m = 1, 4 do
  for n = 1, 4 do
    local A = {}
    for i = 1, m do
      A[i] = {}
      for j = 1, n do A[i][j] = draw(15) - 8 end
    end
    local s = dm.smith(A)
    ok(equal(times(times(s.U, A), s.V), s.D), "U A V = D")
    local fine = true
    for i = 2, s.rank do fine = fine and s.factors[i] % s.factors[i - 1] == 0 end
    ok(fine and math.abs(math.abs(dm.matrix(s.U):det()) - 1) < 1e-6, "each factor divides the next one")
  end
end
ok(same(dm.smith { { 2, 4, 4 }, { -6, 6, 12 }, { 10, 4, 16 } }.factors, { 2, 2, 156 }),
  "Smith's form by its determinantal divisors 2, 4, 624")
raises("64 bits", function()
  local A = {}
  for i = 1, 40 do
    A[i] = {}
    for j = 1, 40 do A[i][j] = (i * j * j + 31 * i * i + j) % 9973 end
  end
  dm.smith(A)
end)
raises("integer", function() dm.smith { { 0.5 } } end)
local two, difference = { { 2 }, { 2 } }, { { 1, -1 } }
ok(not dm.exact(two, difference).exact and dm.exact(two, difference, { over = "Q" }).exact,
  "exact over Q, not over Z")
ok(dm.exact(two, difference, { over = 3 }).exact and not dm.exact(two, difference, { over = 2 }).mono,
  "over Z/3, and not one to one over Z/2")
ok(dm.exact({ { 2 } }).short and not dm.exact({ { 2 } }).splits
  and dm.exact({ { 2 } }).cokernel.torsion[1] == 2, "0 -> Z -2-> Z -> Z/2 -> 0 does not split")
local f, g = { { 1, 0 }, { 2, 1 }, { 0, 3 } }, { { 6, -3, 1 } }
for _, over in ipairs { "Z", "Q", 7 } do
  local e = dm.exact(f, g, { over = over })
  local function unit(A, n)
    for i = 1, n do
      for j = 1, n do
        local y = A[i][j] - (i == j and 1 or 0)
        if over == 7 then y = y % 7 end
        if math.abs(y) > 1e-12 then return false end
      end
    end
    return true
  end
  ok(e.short and e.splits and unit(times(g, e.section), 1) and unit(times(e.retraction, f), 2),
    "section and retraction over " .. over)
  local mixed = times(e.retraction, e.section)
  for i = 1, 2 do
    ok((over == 7 and mixed[i][1] % 7 or math.abs(mixed[i][1])) < 1e-12, "k h = 0")
  end
end
raises("prime", function() dm.exact(two, difference, { over = 6 }) end)
raises("columns", function() dm.exact(two, { { 1 } }) end)
local short = { { { 1 }, { 0 } }, { { 0, 1 } } }
local lemma = dm.five_lemma { top = short, bottom = short, maps = { { { 1 } }, { { 1, 5 }, { 0, 1 } }, { { 1 } } } }
ok(lemma.commutes and lemma.exact and lemma.says.iso and lemma.holds, "the short five lemma")
lemma = dm.five_lemma { top = short, bottom = short, maps = { { { 3 } }, { { 3, 1 }, { 0, 1 } }, { { 1 } } } }
ok(lemma.says.mono and not lemma.says.epi and lemma.holds, "what it does not say")
lemma = dm.five_lemma { top = short, bottom = short, maps = { { { 1 } }, { { 1, 0 }, { 1, 1 } }, { { 1 } } } }
ok(not lemma.commutes and not lemma.says.mono, "a square that does not commute")
-- relative: a list of simplices and nothing else; nothing is passed over in silence
local ball_ = require "dm".mesh { shells = { 3, 1 } }
for _, part in ipairs { { [2] = { 1 } }, { x = { 1, 2 } }, { { 1, 2 }, [4] = { 1 } } } do
  tap.raises("list of simplices", function() return ball_:homology(1, { relative = part }) end)
end
tap.done()
