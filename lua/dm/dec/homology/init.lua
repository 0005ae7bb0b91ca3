--- Homology in integers: Betti numbers, torsion and generators, of any complex (Leok 3.1, appendix
-- A). One matching of the cells serves them all.
local chain = require "dm.dec.chain"
local class = require "dm.base.class"
local core = require "dm.core"
local morse = require "dm.dec.homology.morse"
local option = require "dm.base.options"

local M = {}

local fail = option.fail

local function check_degree(K, k, where)
  if math.type(k) ~= "integer" or k < 0 or k > K.dimension then
    fail(where, "a degree from 0 to %d is needed (got %s)", K.dimension, option.got(k))
  end
end

--- Betti numbers of all degrees.
class.method("dm.mesh", "betti", function(K)
  local m, out = morse.of(K), {}
  for k = 0, K.dimension do out[k + 1] = m:betti(k) end
  return core.result(out)
end, [[
K:betti() -> {b_0, ..., b_n}
Betti numbers: entry k + 1 is the rank of the homology of degree k with integer coefficients. Exact;
of meshes without metric, that are not orientable or no manifolds, too.]])

---- relative to a part ----

-- marks of cells of every degree -> the lists that dm.matching takes
local function lists_of(marks, n)
  local out = {}
  for k = 0, n do
    local cells = {}
    for cell in pairs(marks[k]) do cells[#cells + 1] = cell end
    table.sort(cells)
    out[k + 1] = cells
  end
  return out
end

-- the cells given, marked with all of their faces
local function closed(K, marks)
  for k = K.dimension, 1, -1 do
    for cell in pairs(marks[k]) do
      for _, face in ipairs(K:faces(k, cell)) do marks[k - 1][face] = true end
    end
  end
  return lists_of(marks, K.dimension)
end

local function no_marks(K)
  local marks = {}
  for k = 0, K.dimension do marks[k] = {} end
  return marks
end

local function boundary_part(K)
  local marks, n = no_marks(K), K.dimension
  for _, cell in ipairs(K:boundary_cells(n - 1)) do marks[n - 1][cell] = true end
  return closed(K, marks)
end

-- simplices as lists of vertices
local function part_of(K, simplices)
  local marks = no_marks(K)
  for i in pairs(simplices) do
    if math.type(i) ~= "integer" or i < 1 or i > #simplices then
      fail("mesh:homology", "option 'relative' is a list of simplices, and has the key %s",
        option.got(i))
    end
  end
  for i, vertices in ipairs(simplices) do
    local cell = type(vertices) == "table" and K:find(vertices)
    if not cell then
      fail("mesh:homology", "option 'relative': entry %d is no cell of the mesh: lists of its "
        .. "vertices are needed", i)
    end
    marks[#vertices - 1][cell] = true
  end
  return closed(K, marks)
end

local function relative_to(K, part)
  if part == "boundary" then return boundary_part(K) end
  if type(part) ~= "table" then
    fail("mesh:homology", "option 'relative' must be \"boundary\" or a list of simplices (got %s)",
      option.got(part))
  end
  return part_of(K, part)
end

---- groups ----

-- the chain of basis element i of degree k
local function generator(m, k, basis, i)
  local x = {}
  for row = 1, basis.rows do x[row] = basis[row][i] end
  return chain.new(m.mesh, k, m:extend(k, x))
end

--- Betti number, torsion and generators of degree k of a Morse complex.
function M.of(m, k)
  local group = m:group(k)
  local out = { betti = 0, torsion = {}, generators = {}, of_torsion = {} }
  for i = 1, group.size do
    local factor = group.factors[i]
    if not factor then
      out.betti = out.betti + 1
      out.generators[out.betti] = generator(m, k, group.basis, i)
    elseif factor > 1 then
      out.torsion[#out.torsion + 1] = factor
      out.of_torsion[#out.torsion] = generator(m, k, group.basis, i)
    end
  end
  return out
end

class.method("dm.mesh", "homology", function(K, k, options)
  check_degree(K, k, "mesh:homology")
  local part = option.check(options or {}, { "relative" }, "mesh:homology").relative
  local m = part and morse.new(K, relative_to(K, part)) or morse.of(K)
  return core.result(M.of(m, k))
end, [[
K:homology(k, {relative=}) -> {betti, torsion, generators, of_torsion}
The homology of degree k in integers, Z^betti and a Z/d for every d of the list torsion, each
dividing the next. generators: a list of betti chains; of_torsion: a chain for each entry of
torsion, d times which is a boundary. relative = "boundary" or a list of simplices: of chains
modulo those of that part.]])

class.method("dm.mesh", "generators", function(K, k)
  check_degree(K, k, "mesh:generators")
  return M.of(morse.of(K), k).generators
end, [[
K:generators(k) -> list of dm.chain
Cycles of degree k whose classes are a basis of homology without torsion, as many as the Betti
number says.]])

--- Coordinates of the class of a cycle in the basis of K:homology: those of free generators, then
-- those of torsion modulo their order.
function M.coordinates(m, k, terms)
  local group, free, torsion = m:group(k), {}, {}
  local x = m:reduce(k, terms)
  for i = 1, group.size do
    local total = 0
    for j = 1, #x do
      total = chain.sum(total, chain.product(group.coordinates[i][j], x[j]))
    end
    local factor = group.factors[i]
    if not factor then free[#free + 1] = total
    elseif factor > 1 then torsion[#torsion + 1] = total % factor end
  end
  return free, torsion
end

return M
