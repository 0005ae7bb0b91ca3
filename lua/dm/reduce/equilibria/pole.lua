--- Shapes between two others at which the locked inertia vanishes: the group does not act freely
-- there, mu is 0, and what lies behind are the same states again, in mirrored coordinates. A branch
-- of relative equilibria that runs into one ends there; mu^2 / 2 I turns it round like a fold.
local blame = require "dm.base.blame"
local core = require "dm.core"
local model = require "dm.reduce.routh.model"

local M = {}

local min, abs, huge = math.min, math.abs, math.huge

-- least characteristic value of the locked inertia, or nothing outside of the domain
local function least(info, x)
  local rest = {}
  for j = 1, info.d do rest[j] = 0 end
  local fine, re = blame.try(function()
    local _, I = model.momentum_parts(info, core.vector(x), core.vector(rest), 0)
    return (core.matrix(I):eigenvalues())
  end)
  local out = huge
  for i = 1, fine and #re or 0 do out = min(out, re[i]) end
  return out < huge and out or nil
end

local HALVINGS, VANISHES = 24, 1e-3

--- Where on the line from a to b (0 to 1) it vanishes, and the shape there; nothing where it does
-- not. Near a pole it is a square of the distance: a parabola through both ends and the middle
-- tells where to look.
function M.between(info, a, b)
  local function at(s)
    local x = {}
    for j = 1, info.d do x[j] = (1 - s) * a[j] + s * b[j] end
    return least(info, x) or huge, x
  end
  local first, half, last = at(0), at(0.5), at(1)
  local bend = 2 * (first - 2 * half + last)
  local s = bend > 0 and (3 * first - 4 * half + last) / (2 * bend) or -1
  if not (s > 0 and s < 1 and last < huge) then return nil end
  local best, width = at(s), min(s, 1 - s) / 2
  for _ = 1, HALVINGS do
    for _, near in ipairs { s - width, s + width } do
      local now = at(near)
      if now < best then best, s = now, near end
    end
    width = width / 2
  end
  if abs(best) <= VANISHES * min(first, last) then return s, select(2, at(s)) end
end

return M
