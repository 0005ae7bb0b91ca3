--- Pairs of points at which Ld and what acts beside it are looked at, ((theta, x0), (theta + psi,
-- x1)), in the user's coordinates, and what is round-off there: a group that stretches (boosts)
-- moves points so far that their last digits matter.
local blame = require "dm.base.blame"
local core = require "dm.core"
local model = require "dm.reduce.routh.model"

local M = {}

local abs = math.abs
local LOST = 1e12 -- a condition at which points have no digits left to tell shapes by

--- { q0, q1, J0, J1 }: the points of a look { x0, x1, psi } with the group at theta, and
-- dq/d(theta, x) there, nil where q are these coordinates. Raises where the points have lost their
-- digits.
function M.of(D, look, theta)
  local info, there = D.info, {}
  for a = 1, info.m do there[a] = theta[a] + look.psi[a] end
  local z0, z1 = model.embed(info, look.x0, theta), model.embed(info, look.x1, there)
  local A = info.ambient
  if not A then return { q0 = core.vector(z0), q1 = core.vector(z1) } end
  if not (A.condition(z0) < LOST and A.condition(z1) < LOST) then error("no digits left", 0) end
  return { q0 = core.vector(A.chart(z0)), q1 = core.vector(A.chart(z1)), J0 = A.slope(z0),
    J1 = A.slope(z1) }
end

--- J^T F: a covector in the coordinates (theta, x), of which F may have more behind it.
function M.pulled(J, F)
  if not J then return F end
  local out = {}
  for k = 1, #J do
    out[k] = 0
    for i = 1, #J do out[k] = out[k] + J[i][k] * F[i] end
  end
  return core.vector(out)
end

local ULPS = 2 ^ -50 -- what a coordinate of a point may be off by, relatively

-- |f - value| where coordinate i of one point is `part` longer
local function change(at, f, value, key, i, part)
  local moved = { q0 = at.q0:copy(), q1 = at.q1:copy() }
  moved[key][i] = moved[key][i] * (1 + part)
  local fine, there = blame.try(f, moved.q0, moved.q1)
  return fine and abs(there - value) or 0 / 0
end

--- How far the number f(q0, q1) goes when the coordinates of the points `at` change by round-off;
-- at the border of its domain to the side where it has a value. What has none excuses nothing.
function M.noise(at, f)
  local value, sum = f(at.q0, at.q1), 0
  for _, key in ipairs { "q0", "q1" } do
    for i = 1, #at.q0 do
      local some = change(at, f, value, key, i, ULPS)
      if some ~= some then some = change(at, f, value, key, i, -ULPS) end
      if some == some then sum = sum + some end
    end
  end
  return sum
end

return M
