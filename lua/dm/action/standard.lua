--- Standard actions, by the group and the space: linear, affine, projective, stereographic,
-- translations, as the kit of the group has them.
local core = require "dm.core"
local groups = require "dm.group"

local M = {}

-- the first that a group has on a space is the standard one
local KINDS = { "linear", "affine", "projective", "translation", "stereographic" }
local known = {}
for _, kind in ipairs(KINDS) do known[kind] = true end

local function slice(z, first, count)
  local out = {}
  for i = 1, count do out[i] = z[first + i] end
  return core.vector(out)
end

-- factor by factor where group and space are products alike
local function factors(G, on, get_coordinates)
  if not (groups.kit(G).parts and groups.kit(on).parts) or #G.parts ~= #on.parts then return nil end
  local maps, counts = {}, {}
  for k, part in ipairs(G.parts) do
    maps[k], counts[k] = M.find(part, on.parts[k], get_coordinates), get_coordinates(on.parts[k])
    if not maps[k] then return nil end
  end
  return function(g, z)
    local out, first = {}, 0
    for k, map in ipairs(maps) do
      local moved = map(g[k], slice(z, first, counts[k]))
      for i = 1, counts[k] do out[first + i] = moved[i] end
      first = first + counts[k]
    end
    return core.vector(out)
  end
end

local function of_kind(kit, kind, m)
  return kit.acts[kind] and kit.acts[kind](m)
end

--- The standard action of G on `on` as a function of (g, z), and its kind; of that kind when one is
-- given.
function M.find(G, on, get_coordinates, kind)
  local kit, m = groups.group(G), get_coordinates(on)
  if kind then
    if not known[kind] then
      error(("unknown action '%s': known are %s"):format(tostring(kind), table.concat(KINDS, ", ")),
        0)
    end
    return of_kind(kit, kind, m), kind
  end
  local map = factors(G, on, get_coordinates)
  if map then return map, "factors" end
  map = on == G and of_kind(kit, "translation", m)
  if map then return map, "translation" end
  for _, name in ipairs(KINDS) do
    map = of_kind(kit, name, m)
    if map then return map, name end
  end
end

return M
