--- Cones of star-shaped meshes (Leok, Def 3.29 to 3.31): p of a cell is the sum of the simplices
-- that its geometric cone from the hub is made of; nothing where the cell is radial.
local chain = require "dm.dec.chain"
local core = require "dm.core"
local named = require "dm.dec.named"
local option = require "dm.base.options"

local M = {}

local NEAR = 1e-9 -- of barycentric coordinates

local function fail(...) option.fail("mesh:cone", ...) end

-- engine of a table of p of every cell
local function of_table(table_of)
  return { chain = function(k, terms)
    local out = {}
    for cell, x in pairs(terms) do
      for above, y in pairs(table_of[k] and table_of[k][cell] or {}) do
        chain.add(out, above, chain.product(x, y))
      end
    end
    return out
  end }
end

-- [hub, cell] where it is a simplex; true: the hub is in the cell
local function simplicial(K, hub, vertices)
  local joined = { hub }
  for _, v in ipairs(vertices) do
    if v == hub then return {}, true end
    joined[#joined + 1] = v
  end
  local cell, sign = K:find(joined)
  return cell and { [cell] = sign }, cell ~= nil
end

---- geometry ----

-- x - y as a vector
local function minus(x, y)
  local out = {}
  for i = 1, #x do out[i] = x[i] - y[i] end
  return core.vector(out)
end

-- coordinates in the basis `sides`: x = sum c_i sides_i; nothing where x is not in their span
local function coordinates_in(sides)
  local k, size = #sides, 0
  local gram = {}
  for i = 1, k do
    gram[i] = {}
    for j = 1, k do gram[i][j] = sides[i]:dot(sides[j]) end
    size = math.max(size, gram[i][i])
  end
  gram = core.matrix(gram)
  local scaled = gram:det() / size ^ k
  if not (math.abs(scaled) > NEAR) then return nil end -- the cell is radial
  return function(x)
    local right, left = {}, x
    for i = 1, k do right[i] = sides[i]:dot(x) end
    local c = gram:solve(core.vector(right))
    for i = 1, k do left = left - c[i] * sides[i] end
    if left:dot(left) > NEAR ^ 2 * size then return nil end
    return c
  end
end

-- is the point with these coordinates in the simplex of the hub and the sides?
local function is_inside(c)
  local sum = 0
  for i = 1, #c do
    if c[i] < -NEAR then return false end
    sum = sum + c[i]
  end
  return sum < 1 + NEAR
end

-- signed volume of a simplex by the coordinates of its vertices, that of the cone being 1
local function share_of(list)
  local rows = {}
  for i = 2, #list do rows[i - 1] = minus(list[i], list[1]):totable() end
  return core.matrix(rows):det()
end

-- p of one cell by geometry
local function geometric(K, points, hub, k, vertices, above)
  local sides = {}
  for i, v in ipairs(vertices) do sides[i] = minus(points[v], points[hub]) end
  local coordinates = coordinates_in(sides)
  if not coordinates then return {} end
  local at, out, total = {}, {}, 0
  local function coordinates_of(v)
    if at[v] == nil then
      local c = coordinates(minus(points[v], points[hub]))
      at[v] = c and is_inside(c) and c or false
    end
    return at[v]
  end
  for cell, tuple in ipairs(above) do
    local list = {}
    for _, v in ipairs(tuple) do
      local c = coordinates_of(v)
      if not c then break end
      list[#list + 1] = c
    end
    if #list == #tuple then
      local share = share_of(list)
      out[cell] = share > 0 and 1 or -1
      total = total + math.abs(share)
    end
  end
  if not (math.abs(total - 1) < 1e-6) then
    fail("rule \"star\": the cone from vertex %d over the cell {%s} of degree %d is no sum of "
      .. "simplices; rule \"matching\" needs no star", hub, table.concat(vertices, ", "), k)
  end
  return out
end

local function rows_of(points)
  local out = {}
  for i = 1, #points do out[i] = points[i] end
  return out
end

--- The engine of a cone from the vertex hub.
function M.engine(K, hub)
  local out, points = {}, nil
  for k = 0, K.dimension - 1 do
    local above = K:simplices(k + 1)
    out[k] = {}
    for cell, vertices in ipairs(K:simplices(k)) do
      local terms, fine = simplicial(K, hub, vertices)
      if not fine then
        if K.ambient == 0 or not K.ambient then
          fail("rule \"star\": {%d} with {%s} is no simplex, and the mesh has no points to look "
            .. "further", hub, table.concat(vertices, ", "))
        end
        points = points or rows_of(K:points())
        terms = geometric(K, points, hub, k, vertices, above)
      end
      out[k][cell] = terms
    end
  end
  return of_table(out)
end

---- shells ----

--- The engine of a mesh with the simplices of dm.mesh{shells = {n, L}}, by the cones of that one:
-- its points may be anywhere (a logically star-shaped complex, Def 3.31).
function M.engine_of_shells(K)
  local n = K.dimension
  local L = (K:count(0) - 1) // (2 * n)
  local given = L >= 1 and named.make("shells", { shells = { n, L } })
  local model = given and core.complex { simplices = given.simplices, points = given.points }
  local is_same = model and model:count(0) == K:count(0) and model:count(n) == K:count(n)
  for _, vertices in ipairs(is_same and model:simplices(n) or {}) do
    is_same = is_same and K:find(vertices) ~= nil
  end
  if not is_same then
    fail("rule \"shells\" is for the simplices of dm.mesh{shells = {%d, L}}", n)
  end
  return M.engine(model, 1)
end

return M
