--- Products of groups, and of spaces: elements are lists {g, h, ...}; algebra vectors and flat
-- coordinates stand one after the other.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

-- entries first + 1 .. first + n
local function slice(x, first, n)
  local out = {}
  for i = 1, n do out[i] = x[first + i] end
  return out
end

local function append(out, list)
  for i = 1, #list do out[#out + 1] = list[i] end
end

local function element_of(parts, method)
  return function(g)
    local class = kits.class_of(g)
    if class ~= "table" or #g ~= #parts then
      error(("the element must be a list of %d factors (got %s)")
        :format(#parts, class == "table" and #g .. " of them" or class), 0)
    end
    local out = {}
    for k, part in ipairs(parts) do
      local fine, x = blame.try(part[method], g[k])
      if not fine then error(("factor %d: %s"):format(k, x), 0) end
      out[k] = x
    end
    return out
  end
end

-- factor by factor: f of the elements, algebra vectors are cut; joined into one vector when `join`
local function by_factors(parts, name, kinds, join)
  return function(...)
    local out, first, given = {}, 0, { ... }
    for k, part in ipairs(parts) do
      local arguments = {}
      for i, kind in ipairs(kinds) do
        if kind == "g" then
          arguments[i] = given[i][k]
        else
          arguments[i] = core.vector(slice(given[i], first, part.dimension))
        end
      end
      local value = part[name](table.unpack(arguments))
      if join then append(out, value) else out[k] = value end
      first = first + part.dimension
    end
    return join and core.vector(out) or out
  end
end

local ELEMENTS = { identity = {}, compose = { "g", "g" }, inverse = { "g" }, exp = { "x" },
  near = { "x" }, cayley = { "x" }, project = { "g" },
  left_tangent = { "g", "g", "g" }, right_tangent = { "g", "g", "g" } }
local VECTORS = { log = { "g" }, Ad = { "g", "x" }, ad = { "x", "x" }, coAd = { "g", "x" },
  coad = { "x", "x" }, dexp = { "x", "x" },
  dexpinv = { "x", "x" }, cayleyinv = { "g" }, dcay = { "x", "x" }, dcayinv = { "x", "x" } }

local function has_all(parts, name)
  for _, part in ipairs(parts) do
    if not part[name] then return false end
  end
  return true
end

-- matrices on the diagonal
local function diagonal(list)
  local n, first = 0, 0
  for _, m in ipairs(list) do n = n + m.rows end
  local out = core.zeros(n, n):totable()
  for _, m in ipairs(list) do
    for i = 1, m.rows do
      for j = 1, m.rows do out[first + i][first + j] = m[i][j] end
    end
    first = first + m.rows
  end
  return core.matrix(out)
end

-- lists of numbers of the factors one after the other: flat coordinates or entries
local function concatenated(kit, parts, pack, unpack_name, counts)
  kit[pack] = function(g)
    local out = {}
    for k, part in ipairs(parts) do append(out, part[pack](g[k])) end
    return out
  end
  kit[unpack_name] = function(list)
    local out, first = {}, 0
    for k, part in ipairs(parts) do
      out[k] = part[unpack_name](slice(list, first, counts[k]))
      first = first + counts[k]
    end
    return out
  end
end

local function matrix_maps(kit, parts)
  function kit.matrix(g)
    local list = {}
    for k, part in ipairs(parts) do list[k] = part.matrix(g[k]) end
    return diagonal(list)
  end
  function kit.hat(xi)
    local list, first = {}, 0
    for k, part in ipairs(parts) do
      list[k] = part.hat(core.vector(slice(xi, first, part.dimension)))
      first = first + part.dimension
    end
    return diagonal(list)
  end
  function kit.vee(m)
    local out, first = {}, 0
    for _, part in ipairs(parts) do
      local n = part.hat(core.zeros(part.dimension)).rows
      local block = {}
      for i = 1, n do block[i] = slice(m[first + i], first, n) end
      append(out, part.vee(core.matrix(block)))
      first = first + n
    end
    return core.vector(out)
  end
end

-- elements that are one of those of a factor and the identity of the others
local function of_factors(parts, name)
  return function()
    local out = {}
    for k, part in ipairs(parts) do
      for _, x in ipairs(part[name]()) do
        local g = {}
        for i, other in ipairs(parts) do g[i] = i == k and x or other.identity() end
        out[#out + 1] = g
      end
    end
    return out
  end
end

-- what spaces that are no groups have as well
local function as_manifold(kit, parts)
  local counts = {}
  for k, part in ipairs(parts) do
    counts[k] = part.coordinates
  end
  kit.element, kit.raw = element_of(parts, "element"), element_of(parts, "raw")
  concatenated(kit, parts, "flat", "unflat", counts)
  function kit.bonds(list)
    local out, first = {}, 0
    for k, part in ipairs(parts) do
      append(out, part.bonds(slice(list, first, counts[k])))
      first = first + counts[k]
    end
    return out
  end
  function kit.sample(stream, i)
    local out = {}
    for k, part in ipairs(parts) do out[k] = part.sample(stream, i + ((k - 1) << 32)) end
    return out
  end
  function kit.distance(a, b)
    local list = {}
    for k, part in ipairs(parts) do list[k] = part.distance(a[k], b[k]) end
    return kits.norm(list)
  end
  function kit.defect(g)
    local worst, why = 0, nil
    for k, part in ipairs(parts) do
      local defect, text = part.defect(g[k])
      if not (defect <= worst) and worst == worst then worst, why = defect, text end
    end
    return worst, why
  end
  kit.project = by_factors(parts, "project", ELEMENTS.project)
  kit.tangent = function(z, w)
    if kits.class_of(w) ~= "table" or #w ~= #parts then
      error(("the tangent vector must be a list of %d, one for each factor"):format(#parts), 0)
    end
    local out = {}
    for k, part in ipairs(parts) do out[k] = kits.tangent(part, z[k], w[k]) end
    return out
  end
  for _, name in ipairs { "shoot", "aim" } do
    kit[name] = function(z, x)
      local out = {}
      for k, part in ipairs(parts) do out[k] = kits[name](part, z[k], x[k]) end
      return out
    end
  end
end

-- that of each factor
local function pade_of(parts)
  return function(k, xi, eta)
    local z, dz, first = {}, {}, 0
    for _, part in ipairs(parts) do
      local d = part.dimension
      local a, b = part.pade(k, core.vector(slice(xi, first, d)),
        eta and core.vector(slice(eta, first, d)))
      append(z, a)
      if eta then append(dz, b) end
      first = first + d
    end
    return core.vector(z), eta and core.vector(dz)
  end
end

-- the facts of a product from those of its factors
local function facts(kit, parts)
  local forms = {}
  kit.abelian, kit.vectors, kit.angles = true, true, {}
  for k, part in ipairs(parts) do
    for i in pairs(part.angles) do kit.angles[kit.coordinates + i] = true end
    kit.dimension, kit.coordinates = kit.dimension + part.dimension,
      kit.coordinates + part.coordinates
    kit.manifold = kit.manifold or part.manifold
    kit.abelian, kit.vectors = kit.abelian and part.abelian, kit.vectors and part.vectors
    forms[k] = part.form
  end
  kit.form = ("a list {%s}"):format(table.concat(forms, ", "))
end

-- the differential of exp where that of a factor has a shorter form (matrices.lua)
local function slope_of(parts)
  local of, any = {}, false
  for k, part in ipairs(parts) do
    of[k] = { dimension = part.dimension, slope = part.slope or part.dexp }
    any = any or part.slope ~= nil
  end
  return any and by_factors(of, "slope", VECTORS.dexp, true) or nil
end

--- The product of spaces with these kits.
function M.of(parts)
  local kit = { dimension = 0, coordinates = 0, parts = parts }
  facts(kit, parts)
  as_manifold(kit, parts)
  local entry_counts = {}
  if kit.manifold then return kit end
  for k, part in ipairs(parts) do entry_counts[k] = #part.entries(part.identity()) end
  concatenated(kit, parts, "entries", "rebuild", entry_counts)
  for name, kinds in pairs(ELEMENTS) do
    if has_all(parts, name) then kit[name] = by_factors(parts, name, kinds) end
  end
  for name, kinds in pairs(VECTORS) do
    if has_all(parts, name) then kit[name] = by_factors(parts, name, kinds, true) end
  end
  kit.slope, kit.no_cayley = slope_of(parts), not kit.cayley
  if has_all(parts, "pade") then kit.pade = pade_of(parts) end
  matrix_maps(kit, parts)
  function kit.arcs(xi)
    local out, first = {}, 0
    for _, part in ipairs(parts) do
      append(out, part.arcs and part.arcs(core.vector(slice(xi, first, part.dimension))) or {})
      first = first + part.dimension
    end
    return out
  end
  kit.turns, kit.others = of_factors(parts, "turns"), of_factors(parts, "others")
  return kits.complete(kit)
end

function M.kit(_, space)
  local parts = {}
  for k, part in ipairs(space.parts) do parts[k] = kits.of(part) end
  return M.of(parts)
end

return M
