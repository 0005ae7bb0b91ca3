--- The kits of spaces, and elements of groups, checked. What groups can do as methods of dm.space
-- is in dm.group.methods.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local kits = require "dm.group.kit"

local M = {}

--- The kit of a space: the table of its functions, for elements that are known to be right.
M.kit = kits.of

-- the action of a semidirect product is looked at when it is made, not at its first use
local semidirect, semidirect_doc, put_semidirect = class.wraps("dm.group", "semidirect")
M.semidirect = blame.caller(function(...)
  local space = semidirect(...)
  M.kit(space)
  return space
end)
put_semidirect(M.semidirect, semidirect_doc)

--- The kit of a group; raises for another manifold.
function M.group(space)
  local kit = M.kit(space)
  if kit.manifold then error(("%s is a manifold, not a group"):format(tostring(space)), 0) end
  return kit
end

---- arguments ----

local LOOSE = 1e-6  -- how far a matrix may be from its group: what products drift by, no more

-- what an element of this space looks like, behind a message; nothing for manifolds, whose points
-- are vectors
local function looks(kit, space)
  if kit.manifold then return "" end
  return ("; an element of %s is %s"):format(tostring(space), require "dm.group.starts".form(kit))
end

-- an element; a matrix of numbers that is not on the group is an error
local function checked(kit, x, space)
  local right, g = blame.try(kit.element, x)
  if not right then error(tostring(g) .. looks(kit, space), 0) end
  local list = kit.entries and kit.entries(g) or g
  for i = 1, #list do
    if type(list[i]) ~= "number" then return g end
  end
  if not kits.is_finite(list) then error("the group element is not finite", 0) end
  local defect, why = kit.defect(g)
  if not (defect <= LOOSE) then
    local fine, near = blame.try(kit.project, g)
    local hint = fine and kit.defect(near) <= LOOSE and "; G:project(g) is an element near it"
      or looks(kit, space)
    error(("this is no element of %s: %s%s")
      :format(tostring(space), why or ("it is off by %.3g"):format(defect), hint), 0)
  end
  return g
end

--- x as an element of the space that the kit belongs to, checked: shape, finite, on the group.
function M.element(space, x) return checked(M.kit(space), x, space) end
M.checked = checked

return M
