--- Is the defect of a formula its own, or what rounding made of it? Rounding scatters: where the
-- points are nudged a little it makes something else. What a wrong formula is off by stays.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local abs = math.abs

-- of nudges, relative: large beside the last digits of what a formula cancels, small beside what a
-- wrong one changes over
local SIZES = { 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5 }
local TIMES = 2         -- of each size
local SCATTER = 1 / 10  -- of the defect: where nudges change it by more, it is rounding

local SOURCE = core.random(13)

-- a point near z on the space of kit
local function near(kit, z, place, size)
  local u = kits.normals(SOURCE, place, #z, size)
  if not kit.manifold and kit.coordinates == kit.dimension then
    return z:map(function(x, j) return x * (1 + u[j]) end)
  end
  return kits.shoot(kit, z, kit.manifold and kit.tangent(z, u) or core.vector(
    { table.unpack(u:totable(), 1, kit.dimension) }))
end

--- Does measure(list) stay what it is, the defect, beside the points of the list? Where it has no
-- value there it does not. A formula that is something else at the same points is not rounded.
function M.is_own(frame, list, defect, measure)
  local kit = kits.of(frame.action.on)
  local told, again = blame.try(measure, list)
  if told and again ~= defect then return true end
  for i, size in ipairs(SIZES) do
    for j = 1, TIMES do
      local nudged = {}
      for k, z in ipairs(list) do nudged[k] = near(kit, z, (i * TIMES + j) * #list + k, size) end
      local fine, value = blame.try(measure, nudged)
      if not (fine and value and abs(value - defect) <= SCATTER * defect) then return false end
    end
  end
  return true
end

return M
