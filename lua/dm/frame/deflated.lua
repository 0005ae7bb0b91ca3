--- Other points of the section on an orbit, by Newton's method from one that is known, with that
-- root taken away: one equation Z_i of the section is divided by |w|, w in the algebra leading from
-- there (deflation, Brown & Gearhart 1971), and Newton begins beside it, where that equation alone
-- changes. If it is quadratic the first step leads to its other root, however far away that is.
local blame = require "dm.base.blame"
local core = require "dm.core"
local groups = require "dm.group"
local places = require "dm.action.points"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"

local M = {}

local BESIDE = 0.3       -- of the algebra, where it begins,
local STEPS = 6          -- the first to somewhere, the others, each shorter, to round-off
local LONGEST = 700      -- of a step
local DONE = 1e-6        -- of the last one
local APART = 1e-3       -- of two roots
-- rows of larger groups are shared by so many points, since each costs 0.2 ms
local ALL, SHARED = 4, 2

-- where steps for equation i lead from the points there: an element, or nothing
local function from(frame, level, there, i)
  local kit, right = groups.kit(frame.group), frame.action.side == "right"
  local unit = core.zeros(frame.r)
  unit[i] = 1
  local d = level:cut(points.flat(there)):solve(unit)
  d = d * (BESIDE / d:norm())
  local w, g, last = core.zeros(frame.r), kit.identity(), math.huge
  for _ = 1, STEPS do
    local h = kit.exp(tangent.along_basis(frame, d))
    w, g = w + d, right and kit.compose(g, h) or kit.compose(h, g)
    d = level:deflated(points.flat(places.images(frame.action, g, there)), i, w)
    local size = d and d:norm() or math.huge
    if size < DONE then return w:norm() > APART and g or nil end
    if not (size < last) then return nil end
    last = size
    if size > LONGEST then d = d * (LONGEST / size) end
  end
end

--- Elements that bring the points there, on the section, to other points of it; turn: which of the
-- shared rows.
function M.others(frame, there, turn)
  local level, out = tangent.level(frame), {}
  local every = frame.r > ALL and SHARED or 1
  for i = 1 + turn % every, frame.r, every do
    local fine, g = blame.try(from, frame, level, there, i)
    if fine and g then out[#out + 1] = g end
  end
  return out
end

return M
