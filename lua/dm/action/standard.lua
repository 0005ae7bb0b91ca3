--- Standard actions, by the group and the space: linear, affine, projective, stereographic, translations.
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local function entries(z, first, last)
  local out = {}
  for i = first, last do out[#out + 1] = z[i] end
  return core.vector(out)
end

-- g z of matrices; SO(2) also about the third axis of R^3, GL(1) on any R^n
local function linear(G, kit, m)
  if G.name == "SO" and G.n == 2 then
    if m ~= 2 and m ~= 3 then return nil end
    return function(theta, z)
      local c, s = core.cos(theta), core.sin(theta)
      local out = { c * z[1] - s * z[2], s * z[1] + c * z[2] }
      if m == 3 then out[3] = z[3] end
      return core.vector(out)
    end
  end
  if G.name == "GL" and G.n == 1 then return function(g, z) return core.vector(z) * g[1][1] end end
  if ({ SO = true, GL = true, SL = true, Sp = true })[G.name] and G.n == m then
    return function(g, z) return kit.matrix(g) * z end
  end
end

-- R z + a of SE(n); g z + v of a semidirect product
local function affine(G, kit, m)
  if G.name == "SE" and G.n == m then
    return function(g, z)
      local x = kits.list_of(z)
      x[m + 1] = 1
      return entries(kit.matrix(g) * core.vector(x), 1, m)
    end
  end
  if G.name == "semidirect" and G.parts[2].dimension == m then
    local move = G.representation
    local part = require "dm.group".kit(G.parts[1])
    return function(g, z)
      return core.vector(move and move(g[1], z) or part.matrix(g[1]) * z) + g[2]
    end
  end
end

-- (A z + b)/(c . z + d) of the matrices {{A, b}, {c, d}}
local function projective(G, kit, m)
  if (G.name ~= "SL" and G.name ~= "GL") or G.n ~= m + 1 then return nil end
  return function(g, z)
    local x = kits.list_of(z)
    x[m + 1] = 1
    local y = kit.matrix(g) * core.vector(x)
    return entries(y, 1, m) * (1 / y[m + 1])
  end
end

-- rotations of S^m seen from its north pole in the plane of its equator: Y = (2 w, |w|^2 - 1) is turned, and
-- w' = Y'_1..m/(1 + |w|^2 - Y'_(m+1)). SO(2) turns the last two entries of Y.
local function stereographic(G, kit, m)
  if G.name ~= "SO" or (G.n ~= m + 1 and G.n ~= 2) then return nil end
  return function(g, w)
    local n = core.vector(w):dot(w)
    local Y = kits.list_of(core.vector(w) * 2)
    Y[m + 1] = n - 1
    if G.n == 2 and m ~= 1 then
      local c, s = core.cos(g), core.sin(g)
      Y[m], Y[m + 1] = c * Y[m] - s * Y[m + 1], s * Y[m] + c * Y[m + 1]
    else
      Y = kit.matrix(g) * core.vector(Y)
    end
    return entries(Y, 1, m) * (1 / (1 + n - Y[m + 1]))
  end
end

-- groups of vectors on themselves, from the left
local function translation(G, kit, m)
  if not ({ R = true, T = true, Heisenberg = true })[G.name] and not (G.name == "SE" and G.n == 2) then return nil end
  if G.dimension ~= m then return nil end
  return function(g, z) return kit.compose(g, z) end
end

local kinds = { linear = linear, affine = affine, projective = projective, stereographic = stereographic,
  translation = translation }
local order = { "linear", "affine", "projective", "translation", "stereographic" }

-- factor by factor where group and space are products alike
local function factors(G, on, get_coordinates)
  if G.name ~= "product" or on.name ~= "product" or #G.parts ~= #on.parts then return nil end
  local maps, counts = {}, {}
  for k, part in ipairs(G.parts) do
    maps[k], counts[k] = M.find(part, on.parts[k], get_coordinates), get_coordinates(on.parts[k])
    if not maps[k] then return nil end
  end
  return function(g, z)
    local out, first = {}, 0
    for k, map in ipairs(maps) do
      local moved = map(g[k], entries(z, first + 1, first + counts[k]))
      for i = 1, counts[k] do out[first + i] = moved[i] end
      first = first + counts[k]
    end
    return core.vector(out)
  end
end

--- The standard action of G on `on` as a function of (g, z), and its kind; of that kind when one is given.
function M.find(G, on, get_coordinates, kind)
  local kit, m = require "dm.group".group(G), get_coordinates(on)
  if kind then
    if not kinds[kind] then
      error(("unknown action '%s': known are %s"):format(tostring(kind), table.concat(order, ", ")), 0)
    end
    return kinds[kind](G, kit, m), kind
  end
  local map = factors(G, on, get_coordinates)
  if map then return map, "factors" end
  if on == G then map = translation(G, kit, m) end
  if map then return map, "translation" end
  for _, name in ipairs(order) do
    map = kinds[name](G, kit, m)
    if map then return map, name end
  end
end

return M
