--- How functions of a mesh go to a finer one that is nested in it.
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local fail = option.failing "dm.multigrid"

---- curved surfaces: midpoints of edges ----

-- the two vertices of the coarse mesh beside vertex v of the fine one, or nothing
local function parents(fine, v, old)
  local out = {}
  for _, e in ipairs(fine:cofaces(0, v)) do
    for _, i in ipairs(fine:faces(1, e)) do
      if i ~= v and i <= old then out[#out + 1] = i end
    end
  end
  if #out == 2 then return out[1], out[2] end
end

-- |p - (a + b)/2| beside |a - b|
local function distance(p, a, b)
  local middle = (a + b) / 2
  return (p - middle):norm() / (a - b):norm()
end

local FAR = 0.5 -- a midpoint that was moved to a curved surface is still nearer than that

-- The matrix with rows 1 at old vertices, 1/2 and 1/2 at those on an edge; nil where the fine mesh
-- is not made by such a refinement.
local function by_midpoints(coarse, fine)
  local old, all, n = coarse:count(0), fine:count(0), coarse.dimension
  if all ~= old + coarse:count(1) or fine:count(n) ~= 2 ^ n * coarse:count(n) then return nil end
  local rows, columns, values, p, q = {}, {}, {}, fine:points(), coarse:points()
  local function add(i, j, x)
    rows[#rows + 1], columns[#columns + 1], values[#values + 1] = i, j, x
  end
  for v = 1, old do
    if p[v] ~= q[v] then return nil end
    add(v, v, 1)
  end
  for v = old + 1, all do
    local a, b = parents(fine, v, old)
    if not a or not coarse:find { a, b } or distance(p[v], q[a], q[b]) > FAR then return nil end
    add(v, a, 0.5)
    add(v, b, 0.5)
  end
  return core.sparse(all, old, rows, columns, values)
end

--- P, of the functions of `coarse` to `fine`, level `level`. Raises where it is not nested in it.
function M.prolongation(coarse, fine, level)
  local n = coarse.dimension
  local P, cell = coarse:transfer(fine, 0, "whitney")
  local restriction, part = fine:transfer(coarse, n, "sum")
  if P and restriction then return P end
  local midpoints = by_midpoints(coarse, fine)
  if midpoints then return midpoints end
  if not P then
    fail("meshes %d and %d are not nested: vertex %d of the second one is not in the first",
      level - 1, level, cell)
  end
  fail("meshes %d and %d are not nested: cell {%s} of the first one is not a union of cells of the "
    .. "second", level - 1, level, table.concat(coarse:simplices(n)[part], ", "))
end

return M
