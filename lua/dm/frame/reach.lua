--- Points at which a frame is tried and elements that move them, near and far, the same in every
-- run.
local blame = require "dm.base.blame"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local places = require "dm.action.points"
local points = require "dm.frame.points"

local M = {}

local abs, min = math.abs, math.min

local SIZES = { 1, 0.3, 3, 1, 0.1, 10 } -- of points
local PUSHES = { 1, 2.5, 0.5, 3.1 }     -- of vectors of the algebra whose exp moves them
-- how many elements that go far move a sample that has a root, by dim G, since two cuts of an orbit
-- may lie far apart
local FAR_AGAIN = { 1, 1, 1, 1, 1, 1, 2, 3 }
local NEAREST, FARTHEST = 5, 600        -- sizes of numbers far away, log-uniform
local PARTS, GOLDEN = 16, (5 ^ 0.5 - 1) / 2
M.FAR = 1e3              -- entries beyond which digits are missing

---- points ----

-- are points numbers that may be any ones?
local function is_open(kit) return not kit.manifold and kit.coordinates == kit.dimension end

-- the points, all inside of the domain, or nothing
local function inside(frame, list)
  for _, z in ipairs(list) do
    if not places.is_inside(frame.action, z) then return nil end
  end
  return list
end

--- A list of points of sample `seed` with numbers of size SIZES; nothing outside of the domain.
function M.sample(frame, seed)
  local kit, list = kits.of(frame.action.on), points.sample(frame, seed)
  local size = is_open(kit) and SIZES[seed % #SIZES + 1] or 1
  for _, z in ipairs(list) do
    for j = 1, size ~= 1 and #z or 0 do z[j] = kit.angles[j] and z[j] or z[j] * size end
  end
  return inside(frame, list)
end

-- a number far away, its size log-uniform, of either sign: place in (0, 2)
local function far_number(place)
  local size = NEAREST * (FARTHEST / NEAREST) ^ (place % 1)
  return place < 1 and size or -size
end

-- In (0, 2), spread evenly over 16 parts by samples, which every number j of a list goes through in
-- an order of its own: a s + b s^2 takes all values mod 2^n where a is odd and b even. In one list
-- parts are no linear function of j: points would lie on lines through 0.
local function spread(seed, j)
  local part = seed * (2 * j + 1) + 2 * seed ^ 2 * (3 * j + 1) + 3 * j * (j + 1) // 2
  return 2 * (part % PARTS + GOLDEN * (seed + j ^ 2) % 1) / PARTS
end

--- A list of points far away; nothing where there are none, or outside of the domain.
function M.far_sample(frame, seed)
  local kit, list = kits.of(frame.action.on), points.sample(frame, seed)
  if not is_open(kit) or #kit.angles == kit.coordinates then return nil end
  for i, z in ipairs(list) do
    for j = 1, #z do
      z[j] = kit.angles[j] and z[j] or far_number(spread(seed, (i - 1) * #z + j))
    end
  end
  return inside(frame, list)
end

---- elements ----

local ELEMENTS, OTHERS = core.random(11), 1000

-- an element far from the identity, by turns in every component of the group
local function large(kit, seed)
  local others = kit.others()
  local size = PUSHES[seed % #PUSHES + 1]
  local h = kit.exp(kits.normals(ELEMENTS, seed, kit.dimension, size))
  local other = others[seed % (#others + 1)]
  return other and kit.compose(other, h) or h
end

--- Push number `again` of a sample: large elements and, by turns, the inverse of the next one.
-- Every one, kept in `known`, is pushed with by two samples.
function M.push(frame, known, seed, again)
  local kit, place = groups.kit(frame.group), seed + again // 2
  known[place] = known[place] or large(kit, place)
  return again % 2 == 1 and known[place] or kit.inverse(known[place])
end

-- the largest entry of an element that is no angle
local function extent(kit, g)
  local flat, size = kit.flat(g), 0
  for i = 1, #flat do
    if not (kit.angles[i] or abs(flat[i]) <= size) then size = abs(flat[i]) end
  end
  return size
end

-- exp of so much of axis j of the algebra
local function along(kit, j, size)
  local xi = core.zeros(kit.dimension)
  xi[j] = size
  return kit.exp(xi)
end

-- axes of the algebra along which exp goes away on a straight line, as translations do; boosts are
-- far away at moderate sizes, and rotations never
local function open_axes(kit)
  local out = {}
  for j = 1, kit.dimension do
    local fine, g = blame.try(along, kit, j, FARTHEST)
    local size = fine and extent(kit, g) or 0
    if size > FARTHEST / 2 and size < 2 * FARTHEST then out[#out + 1] = j end
  end
  return out
end

-- An element far away along all these axes, as far as its entries allow; sizes by numbers that fill
-- (0, 2) evenly.
local function far(kit, axes, seed)
  local h = kit.exp(kits.normals(ELEMENTS, OTHERS + seed, kit.dimension, 1))
  for i = 1, #axes do
    local turn = (seed + i) % #axes
    local size = far_number(2 * ((GOLDEN * seed + turn / #axes) % 1))
    local g = kit.compose(along(kit, axes[turn + 1], size), h)
    if extent(kit, g) < M.FAR then h = g end
  end
  return h
end

--- Elements far away for sample `seed`. axes: those of the group, found at first.
function M.far_elements(frame, axes, seed)
  local kit, out = groups.kit(frame.group), {}
  if not axes.found then axes.found = open_axes(kit) end
  local count = #axes.found > 0 and FAR_AGAIN[min(frame.r, #FAR_AGAIN)] or 0
  for i = 1, count do out[i] = far(kit, axes.found, count * seed + i) end
  return out
end

return M
