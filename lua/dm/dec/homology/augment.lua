--- Cones of meshes made from others: with one vertex more (Leok, Def 3.33, Ex 3.13 to 3.17), and
-- carried along a relabelling (Def 3.31).
local chain = require "dm.dec.chain"
local class = require "dm.base.class"
local cone = require "dm.dec.homology.cone"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local function fail(...) option.fail("cone:augment", ...) end

---- the larger mesh ----

-- simplices that are faces of no others
local function maximal(K)
  local out = {}
  for k = 0, K.dimension do
    for i, vertices in ipairs(K:simplices(k)) do
      if k == K.dimension or #K:cofaces(k, i) == 0 then out[#out + 1] = vertices end
    end
  end
  return out
end

local function with(list, ...)
  local out = table.move(list, 1, #list, 1, {})
  for _, v in ipairs { ... } do out[#out + 1] = v end
  return out
end

-- the ring as simplices: of vertices it is a path in space, single vertices in the plane
local function ring_of(K, ring, closed)
  if type(ring[1]) == "table" then return ring end
  local out = {}
  if K.dimension < 3 then
    for i, v in ipairs(ring) do out[i] = { v } end
    return out
  end
  for i = 1, #ring - 1 do out[i] = { ring[i], ring[i + 1] } end
  if closed then out[#out + 1] = { ring[#ring], ring[1] } end
  return out
end

-- points of the larger mesh, where there are any
local function points_with(K, vertex)
  if type(vertex) ~= "table" then return nil end
  if not K.ambient or K.ambient == 0 then
    fail("'vertex' is a point, but the mesh has none: give vertex = %d", K:count(0) + 1)
  end
  local points, old = {}, K:points()
  for i = 1, K:count(0) do points[i] = old[i]:totable() end
  points[#points + 1] = vertex
  return points
end

local function larger(K, at, rings, vertex)
  local simplices, w = maximal(K), K:count(0) + 1
  for i, tau in ipairs(rings) do
    if type(tau) ~= "table" or not K:find(with(tau, at)) then
      fail("ring: vertex %d with entry %d is no simplex of the mesh", at, i)
    end
    simplices[#simplices + 1] = with(tau, at, w)
  end
  return core.complex { simplices = simplices, points = points_with(K, vertex) }
end

---- p on it ----

-- cells of the old mesh as cells of the new one: [k][cell]
local function places(K, L)
  local out = {}
  for k = 0, K.dimension do
    out[k] = {}
    for i, vertices in ipairs(K:simplices(k)) do out[k][i] = L:find(vertices) end
  end
  return out
end

local function inverse(list)
  local out = {}
  for i, x in pairs(list) do out[x] = i end
  return out
end

-- New cells come in pairs (w tau, w v0 tau): p(a) = c (b - p(db - c a)) for a = w tau, 0 for b.
local function engine_of(p, L, at)
  local K, w = p.mesh, L:count(0)
  local to, back = places(K, L), {}
  for k, list in pairs(to) do back[k] = inverse(list) end
  local new_ones = {} -- [k][cell] = p of it, made when asked for
  local of_chain

  local function of_new(k, cell)
    local vertices, known = L:simplices(k)[cell], new_ones[k] or {}
    new_ones[k] = known
    if known[cell] then return known[cell] end
    known[cell] = {}
    for _, v in ipairs(vertices) do if v == at then return known[cell] end end
    local above = L:find(with(vertices, at))
    local c, rest = 0, {}
    for j, face in ipairs(L:faces(k + 1, above)) do
      local sign = j % 2 == 1 and 1 or -1
      if face == cell then c = sign else rest[face] = sign end
    end
    local out = { [above] = c }
    for x, y in pairs(of_chain(k, rest)) do chain.add(out, x, -c * y) end
    known[cell] = out
    return out
  end

  function of_chain(k, terms)
    local old, out = {}, {}
    for cell, x in pairs(terms) do
      local before = back[k] and back[k][cell]
      if before then old[before] = x
      else
        for above, y in pairs(of_new(k, cell)) do chain.add(out, above, chain.product(x, y)) end
      end
    end
    if k < K.dimension then
      for above, y in pairs(p.engine.chain(k, old)) do chain.add(out, to[k + 1][above], y) end
    end
    return out
  end

  -- of old cells as before; the new ones shrink to old ones along their pairs
  local function project(k, terms)
    local out = {}
    if k > 0 then return out end
    for cell, x in pairs(terms) do
      local old = cell == w and at or cell
      for left, y in pairs(p.engine.project(0, { [old] = x })) do
        chain.add(out, to[0][left], y)
      end
    end
    return out
  end
  return { chain = of_chain, project = project }
end

class.method("dm.cone", "augment", function(p, options)
  option.check(options, { "vertex", "at", "ring", "closed" }, "cone:augment")
  local K = p.mesh
  if not p.engine.chain or not p.poincare then
    fail("a cone in integers of a mesh that can be drawn together is needed")
  end
  local at = option.whole(options, "at", "cone:augment", 1, K:count(0))
  local ring = option.list(options, "ring", "cone:augment", "vertices")
  if not at or not ring then fail("'at' (a vertex) and 'ring' (vertices beside it) are needed") end
  local vertex = options.vertex
  if vertex ~= nil and type(vertex) ~= "table" and vertex ~= K:count(0) + 1 then
    fail("'vertex' is the new point, a list, or its number, %d (got %s)", K:count(0) + 1,
      option.got(vertex))
  end
  local L = larger(K, at, ring_of(K, ring, options.closed), vertex)
  return cone.new(L, p.rule, engine_of(p, L, at), { hub = p.hub, poincare = true })
end, [[
p:augment{at=, ring=, closed=, vertex=} -> dm.cone
The cone of the mesh with one vertex w more, p.mesh of the result: w is joined to the vertex `at`
and the vertices of its ring, in the plane to one or two of them, in space to a path, or with closed
= true a circuit of them; or ring is a list of simplices. p(w tau) = +-([w, at, tau] - p of the rest
of its boundary) (Leok, Def 3.33, Ex 3.13, 3.16). vertex: the point of w, without it the mesh has no
metric.]])

---- carried by a relabelling ----

class.method("dm.cone", "carry", function(p, f)
  if option.got(f) ~= "dm.simplicial_map" or not rawequal(f.from, p.mesh) then
    option.fail("cone:carry", "a dm.simplicial_map of the cone's mesh is needed (got %s)",
      option.got(f))
  end
  if not p.engine.chain then option.fail("cone:carry", "rule \"linear\" is of forms alone") end
  local back = inverse(f.vertices)
  local same = f.from.dimension == f.to.dimension
  for k = 0, f.from.dimension do same = same and f.from:count(k) == f.to:count(k) end
  for v = 1, f.to:count(0) do same = same and back[v] ~= nil end
  if not same then option.fail("cone:carry", "the map is no isomorphism") end
  local g = require "dm.dec.homology.map".simplicial_map(f.to, f.from, back)
  local function along(name, rise)
    return function(k, terms)
      local there = g:push(chain.new(f.to, k, terms)).coefficients
      if k + rise > f.from.dimension then return {} end
      return f:push(chain.new(f.from, k + rise, p.engine[name](k, there))).coefficients
    end
  end
  return cone.new(f.to, p.rule, { chain = along("chain", 1), project = along("project", 0) },
    { hub = f.vertices[p.hub], poincare = p.poincare })
end, [[
p:carry(f) -> dm.cone
f p f^-1, the cone of the second mesh of an isomorphism f, a dm.simplicial_map: where its points are
plays no part (logically star-shaped complexes, Leok, Def 3.31).]])

return M
