--- What a frame that is not trusted yet gives at points: an element and where it brings them, and
-- what it makes of rounding.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local options = require "dm.base.options"
local places = require "dm.action.points"
local points = require "dm.frame.points"
local reach = require "dm.frame.reach"
local steady = class.module(function() return require "dm.frame.steady" end)
local tangent = require "dm.frame.tangent"
local text = require "dm.frame.text"

local M = {}

local huge, max = math.huge, math.max

local STEADY = 1e6       -- entries up to which rounding is told from what a formula makes
M.VALID = 1e-9           -- how far an element may be from the group
local NUDGE = 1e-7       -- of points, relative
local MODERATE = 30      -- a point of larger numbers is far away

function M.fail(...) options.fail("dm.moving_frame", ...) end
function M.refuse(what, ...) M.fail("no moving frame: " .. what, ...) end

--- The largest number of the points.
function M.size_of(list)
  local size = 0
  for _, z in ipairs(list) do size = max(size, places.size(z)) end
  return size
end

--- What to try where a formula is wrong at points far away.
function M.advice(list)
  return M.size_of(list) > MODERATE and "; a formula for nearer points needs an action that says "
    .. "where they are, by domain(z) > 0" or ""
end

--- The list moved by g; nothing where it is not finite, far away or outside of the domain.
function M.moved(frame, g, list)
  local fine, out, most = blame.try(places.images, frame.action, g, list)
  if not (fine and most and most < (frame.solution and STEADY or reach.FAR)) then return nil end
  for i = 1, frame.action.domain and #out or 0 do
    if not places.is_inside(frame.action, out[i]) then return nil end
  end
  return out
end

-- How much larger g makes relative changes of the points: of those that lie close together it has
-- to magnify their differences, with the rounding in them. What is solved for g loses as many
-- digits again.
local function stretch(frame, g, list, there)
  local size, nudged, worst = M.size_of(list), {}, 0
  for i, z in ipairs(list) do
    nudged[i] = z:map(function(x, j) return x + ((i + j) % 2 == 0 and NUDGE or -NUDGE) * size end)
  end
  local moved_too = M.moved(frame, g, nudged)
  for i, z in ipairs(moved_too or {}) do
    worst = max(worst, places.apart(frame.action, z, there[i]) / (1 + places.size(there[i])))
  end
  return moved_too and worst / NUDGE or huge
end

-- what the formula gives, of the form of an element; nothing where it raises or is not finite
local function by_formula(frame, list)
  local kit = groups.kit(frame.group)
  local fine, value = blame.try(frame.solution, table.unpack(list))
  if not fine then return nil, value end
  local is, g = blame.try(kit.element, value)
  if not is then
    M.refuse("at z = %s the solution gives something else: %s", text.points(list), g)
  end
  return kits.is_finite(kit.entries(g)) and g or nil
end

-- the same, an element of the group; nothing where rounding made it none
local function by_valid_formula(frame, list)
  local kit = groups.kit(frame.group)
  local g, raised = by_formula(frame, list)
  if not g then return nil, raised end
  local defect, why = kit.defect(g)
  if defect <= M.VALID then return g end
  local function defect_at(nudged)
    local h = by_formula(frame, nudged)
    return h and kit.defect(h)
  end
  if not steady.is_own(frame, list, defect, defect_at) then return nil end
  M.refuse("at z = %s the solution is no element of %s: %s%s", text.points(list),
    tostring(frame.group), why or ("it is off by %.3g"):format(defect), M.advice(list))
end

--- The root; nothing where there is none, and why. What else it raises is an error of the section,
-- branch or start. compared: are the equations what was traced? Where the points come to the
-- section they are.
function M.by_root(frame, list, compared)
  local root, x, fine, y = frame.root, points.flat(list), nil, nil
  if compared then fine, y = blame.try(root, x) else fine, y = blame.try(root.traced, root, x) end
  if fine then return require "dm.frame".of_root(frame, y) end
  if not tostring(y):find(text.advice, 1, true) then M.fail("%s", blame.bare(y)) end
  return nil, y
end

--- The frame's element at the points; nothing where there is none, and why
function M.element(frame, list)
  if frame.solution then return by_valid_formula(frame, list) end
  return M.by_root(frame, list)
end

--- What J psi and g make of rounding at the points there
function M.condition(frame, list, a)
  if not a.condition then
    local _, condition = tangent.transversality(frame, a.there)
    a.condition = condition
  end
  return a.condition * max(1, stretch(frame, a.g, list, a.there)) ^ 2
end

--- The frame by formula, of points that may be nudged: its element g and the points there
function M.plain(frame, list)
  local g = by_formula(frame, list)
  local there = g and M.moved(frame, g, list)
  return there and { g = g, there = there }
end

return M
