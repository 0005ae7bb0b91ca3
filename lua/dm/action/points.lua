--- The points that groups act on, as vectors, and the map of an action at them: shared by what
-- makes, tests and lifts actions.
local class = require "dm.base.class"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local lists = class.module(function() return require "dm.base.lists" end)

local M = {}

local abs = math.abs

---- spaces that are acted on: points are vectors ----

--- Numbers of a point of the space.
function M.coordinates(space)
  local kit = groups.kit(space)
  if kit.vectors then return kit.coordinates end
  for _, part in ipairs(kit.parts and space.parts or {}) do M.coordinates(part) end
  error(("dm.action: the points of %s are no vectors: let the group act on the entries, "
    .. "in dm.R(%d)")
    :format(tostring(space), #kit.entries(kit.identity())), 0)
end

--- A random point of the space as a vector.
function M.sample_point(space, stream, i)
  local kit = groups.kit(space)
  local point = kit.sample(stream, i)
  return kit.flat == kits.list_of and core.plain(point, #point) or core.vector(kit.flat(point))
end

---- the map ----

-- map(g, z) as a vector, of a copy of z that the map may write on; unchecked arguments
local function image(action, g, z)
  return kits.vector(action.map(g, core.vector(z)), action.dimension, "what map(g, z) returns")
end

--- The points of a list that g moves, a new list; and their size where they are finite numbers.
function M.images(action, g, list)
  local out, most = core.images(action.map, g, list, action.dimension)
  if out then return out, most end
  out = {}
  for i = 1, #list do out[i] = image(action, g, list[i]) end
  return out
end

local function is_inside(action, z)
  if not action.domain then return true end
  local value = action.domain(z)
  if type(value) ~= "number" then
    error(("domain(z) must return a number, > 0 inside (got %s)"):format(kits.class_of(value)), 0)
  end
  return value > 0
end

--- Largest difference of two points; angles by the circle.
function M.apart(action, a, b)
  local plain, worst = not next(action.angles) and core.largest(a - b), 0
  if plain then return plain end
  for i = 1, #a do
    local d = abs(a[i] - b[i])
    if action.angles[i] then d = 2 * abs(math.sin(0.5 * (a[i] - b[i]))) end
    if not (d <= worst) and worst == worst then worst = d end
  end
  return worst
end

local function size_of(z)
  local plain, most = core.largest(z), 0
  if plain then return plain end
  for i = 1, #z do
    local size = abs(z[i])
    if not (size <= most) and most == most then most = size end
  end
  return most
end

-- the moved point, or nothing where it is not finite, huge or outside of the domain
local FAR = 1e4
local function moved(action, g, z)
  local w = image(action, g, z)
  local size = size_of(w)
  if size < FAR and is_inside(action, w) then return w end
end

--- Text of a point or group element, on one line.
local function show(x)
  if type(x) == "table" then
    local out = {}
    for i, part in ipairs(x) do out[i] = show(part) end
    return "{" .. table.concat(out, ", ") .. "}"
  end
  return (tostring(x):gsub("%s*\n%s*", " "))
end
M.show = show

M.image, M.is_inside, M.moved, M.size = image, is_inside, moved, size_of

-- the numbers of the points of a list, or of the rows of a matrix, one after the other
local function joined(list)
  local out = {}
  for i = 1, #list do
    local part = list[i]
    if kits.is_scalar(part) then part = { part } end
    if not lists.count(part) then return nil end
    for j = 1, #part do out[#out + 1] = part[j] end
  end
  return out
end

--- z as a vector of the right length; also a list of points, or of a point and its derivatives.
function M.point(action, z, what)
  local class = kits.class_of(z)
  local first = class == "table" and kits.class_of(z[1])
  local nested = class == "dm.matrix" or first == "table" or first == "dm.vector"
  return kits.vector(nested and joined(z) or z, action.dimension, what or "the point z")
end

return M
