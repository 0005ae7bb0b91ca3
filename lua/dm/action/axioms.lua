--- The axioms of a group action, tested at random points that are always the same.
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local points = require "dm.action.points"

local M = {}

local abs, max = math.abs, math.max
local show, moved, size_of = points.show, points.moved, points.size

local POINTS, TRIES, TOLERANCE = 12, 240, 1e-9
-- of standard maps, which are actions: does this one keep its space and its domain?
local OF_STANDARD = 1
local SIZES = { 0.05, 0.3, 1 }

local function broken(action, axiom, what, defect)
  error(("dm.action%s: it is no %s action of %s: the axiom of %s fails: %s (they differ by %.3g)")
    :format(action.name and " '" .. action.name .. "'" or "", action.side, tostring(action.group),
      axiom, what, defect), 0)
end

-- 1 where all is fine; nothing where the point cannot be tested
local function check_identity(action, kit, z)
  local neutral = kit.identity()
  local w = moved(action, neutral, z)
  if not w then return nil end
  local defect, scale = points.apart(action, w, z), 1 + size_of(z)
  if not (defect <= TOLERANCE * scale) then
    broken(action, "identity", ("map(e, z) is not z at z = %s, e = %s")
      :format(show(z), show(neutral)), defect)
  end
  for _, turn in ipairs(kit.turns()) do
    w = moved(action, turn, z)
    defect = w and points.apart(action, w, z) or 0
    if not (defect <= TOLERANCE * scale) then
      broken(action, "identity", ("a full turn, g = %s, moves z = %s")
        :format(show(turn), show(z)), defect)
    end
  end
  return 1
end

local function product_of(action, kit, g, h)
  if action.side == "left" then return kit.compose(g, h) end
  return kit.compose(h, g)
end

local function check_composition(action, kit, z, g, h)
  local w = moved(action, h, z)
  local twice, once = w and moved(action, g, w), moved(action, product_of(action, kit, g, h), z)
  if not twice or not once then return nil end
  local defect, scale = points.apart(action, twice, once), 1 + max(size_of(w), size_of(once)) ^ 2
  if not (defect <= TOLERANCE * scale) then
    local other = moved(action, action.side == "left" and kit.compose(h, g) or kit.compose(g, h), z)
    local hint = ""
    if other and points.apart(action, twice, other) <= TOLERANCE * scale then
      hint = (" (with side = \"%s\" it holds there)")
        :format(action.side == "left" and "right" or "left")
    end
    broken(action, "composition",
      ("map(g, map(h, z)) is not map(%s, z) at z = %s, g = %s, h = %s%s"):format(
      action.side == "left" and "g h" or "h g", show(z), show(g), show(h), hint), defect)
  end
  return 1
end

-- w: the moved point, or nothing
local function check_inverse(action, kit, z, g, w)
  local back = w and moved(action, kit.inverse(g), w)
  if not back then return nil end
  local defect = points.apart(action, back, z)
  if not (defect <= TOLERANCE * (1 + max(size_of(w), size_of(z)) ^ 2)) then
    broken(action, "inverse", ("map(g^-1, map(g, z)) is not z at z = %s, g = %s")
      :format(show(z), show(g)), defect)
  end
  return 1
end

-- on a sphere and the like: does the image lie there?
local function check_place(action, z, g, w)
  local kit = groups.kit(action.on)
  if not w or not kit.bonds then return end
  for _, x in ipairs(kit.bonds(kits.list_of(w))) do
    if not (abs(x) <= TOLERANCE) then
      broken(action, "closure", ("map(g, z) is not in %s at z = %s, g = %s")
        :format(tostring(action.on), show(z), show(g)), abs(x))
    end
  end
end

--- Element i of the group, of one of three sizes.
function M.element(kit, stream, i)
  return kit.exp(kits.normals(stream, i, kit.dimension, SIZES[i % #SIZES + 1]))
end

--- Raise where an axiom fails. wanted: at how many points they are tested
function M.check(action, wanted)
  wanted = wanted or action.kind and OF_STANDARD or POINTS
  local kit, stream, tested = groups.kit(action.group), core.random(20260), 0
  for i = 1, TRIES do
    local z = points.sample_point(action.on, stream, 3 * i)
    if points.is_inside(action, z) then
      local g, h = M.element(kit, stream, 3 * i + 1), M.element(kit, stream, 3 * i + 5)
      local first, second = check_identity(action, kit, z), check_composition(action, kit, z, g, h)
      local w = moved(action, g, z)
      local third = check_inverse(action, kit, z, g, w)
      check_place(action, z, g, w)
      if first and second and third then tested = tested + 1 end
      if tested == wanted then return end
    end
  end
  if tested == 0 then
    error(("dm.action: map(g, z) is finite (and inside of the domain) together with its "
      .. "compositions at none of %d random points, so that the axioms cannot be tested: is it an "
      .. "action on %s?")
      :format(TRIES, tostring(action.on)), 0)
  end
end

return M
