--- Words about moving frames: what they print as, and the error where there is none.
local M = {}

local function number(x) return type(x) == "number" and ("%.6g"):format(x) or tostring(x) end

--- (0.1, 0.2), (0.3, 0.4)
function M.points(list)
  local out = {}
  for i, z in ipairs(list) do
    local entries = {}
    for j = 1, #z do entries[j] = number(z[j]) end
    out[i] = "(" .. table.concat(entries, ", ") .. ")"
  end
  return table.concat(out, ", ")
end

function M.name(frame)
  return frame.name and ("moving frame '%s'"):format(frame.name) or "the moving frame"
end

function M.describe(frame)
  return ("moving frame of %s on %d point%s of %s, %s")
    :format(tostring(frame.group), frame.k, frame.k == 1 and "" or "s",
    tostring(frame.action.on), frame.solution and "given by a formula" or "solved for")
end

--- what a root that has no value says behind what it met
M.advice = "no moving frame near there: the cross-section may not be transversal to the orbit, or "
  .. "the branch ends"

--- why there is no frame at the points: condition is that of J psi
function M.no_frame(frame, list, condition, why)
  local singular = not (condition < 1e10)
  local cause = singular and "the cross-section is not transversal to the orbit: it is tangent to "
    .. "it, or the action has a fixed point or an isotropy group there"
    or why or "the equations have no root there"
  return ("no moving frame near z = %s: %s (condition number of J psi %.3g); %s")
    :format(M.points(list), cause, condition,
    singular and "try another cross-section, more points, or stay away from this point"
    or "try another branch or cross-section, or give `start`")
end

--- a frame that cannot be: orbits on the k points have this dimension
function M.refuse(frame, dimension)
  local r, k = frame.r, frame.k
  local points = ("%d point%s"):format(k, k == 1 and "" or "s")
  if dimension < r then
    error(("dm.moving_frame: the orbits of %s on %s of %s have %d dimension%s, the group has %d: "
      .. "no cross-section crosses them once; take more points (points = %d)")
      :format(tostring(frame.group), points, tostring(frame.action.on), dimension,
      dimension == 1 and "" or "s", r, k + 1), 0)
  end
  error(("dm.moving_frame: the cross-section is nowhere transversal to the orbits: it is tangent "
    .. "to some direction of those of %s at general points; "
    .. "choose functions of the points that the group does change")
    :format(tostring(frame.group)), 0)
end

return M
