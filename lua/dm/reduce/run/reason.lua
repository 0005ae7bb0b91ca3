--- What is wrong with a state of a reduced run, by what happens to the locked inertia and to the
-- mass of the shape. A shape at which the group does not act freely (r = 0, all rods vertical) has
-- a singular locked inertia: with mu it is behind a wall of V_mu, which a step that is too long may
-- jump; a pole or an edge of the coordinates makes the mass d2R/dx'2 singular or infinite.
local blame = require "dm.base.blame"
local core = require "dm.core"
local jumps = require "dm.reduce.run.jump"

local M = {}

local abs, min, max = math.abs, math.min, math.max

--- The least characteristic value of the locked inertia at x, or nothing outside of the domain.
function M.inertia(shape, x, t)
  local fine, re = blame.try(function() return (shape:locked_inertia(x, t):eigenvalues()) end)
  if not fine then return nil end
  local least = math.huge
  for i = 1, #re do least = min(least, re[i]) end
  return least
end

local WAY = "; with constraint = in coordinates without such a place, "
  .. "system:routh { action = ... } reduces it too"
local SECTION = "; take another section there, or leave 'section' out for one that is regular "
  .. "wherever the group acts freely"

-- what to do at a pole or an edge
local function way(info) return info.ambient and info.ambient.given and SECTION or WAY end

local LOW, FAR = 0.02, 50  -- of the value at the start

--- Code and sentence for the state (x, t), beside the start (x0, t0); nothing where all looks
-- regular.
function M.at(path, info, x, t, x0, t0)
  local shape = path.system
  local least, before = M.inertia(shape, x, t), M.inertia(shape, x0, t0)
  if least and before and least < LOW * before then
    return "collapse", ("the locked inertia has fallen from %.3g to %.3g: the shape comes near "
      .. "one at which the group does not act freely (r = 0), behind a centrifugal wall as narrow "
      .. "as the momentum is small; take smaller steps there, or no reduction")
      :format(before, least)
  end
  local G, G0 = jumps.mass(path, x, t), jumps.mass(path, x0, t0)
  for i = 1, G and G0 and info.d or 0 do
    local name, ratio = info.own[i], abs(G[i][i] / G0[i][i])
    if not (ratio <= FAR) then
      return "edge", ("the inertia of '%s' has grown %.0f-fold at %s = %.6g: an edge of these "
        .. "coordinates%s"):format(name, ratio, name, x[i], way(info))
    elseif ratio < LOW then
      return "pole", ("the inertia of '%s' has fallen %.0f-fold: a pole of these coordinates, "
        .. "where it has no meaning%s"):format(name, 1 / ratio, way(info))
    end
  end
end

-- does the straight line from x leave the domain of L within a step?
local function leaves(shape, info, x, v, t, h)
  for _, part in ipairs { 0.5, 1 } do
    local y, fine, value = {}, nil, nil
    for j = 1, info.d do y[j] = x[j] + part * h * v[j] end
    fine, value = blame.try(shape.lagrangian, shape, y, v, t)
    if not fine then
      local worst, name = 0, nil
      for j = 1, info.d do
        local z = { table.unpack(core.vector(x):totable()) }
        z[j] = y[j]
        if not blame.try(shape.lagrangian, shape, z, v, t) and abs(v[j]) > worst then
          worst, name = abs(v[j]), info.own[j]
        end
      end
      return "edge", ("the next step would leave the domain of L%s%s")
        :format(name and (" by '%s'"):format(name) or "", way(info)), value
    end
  end
end

local POLE = "the mass of the shape vanishes along '%s' at %s: a pole of these coordinates, "
  .. "behind which they have no points%s"

--- The sentence for a shape where the mass is singular: the coordinate whose inertia is the least
-- there beside what it is at x.
function M.vanishing(path, info, where, x, t)
  local G, G0, least, best = jumps.mass(path, where, t), jumps.mass(path, x, t), math.huge, 1
  for i = 1, G and G0 and info.d or 0 do
    local ratio = abs(G[i][i] / G0[i][i])
    if ratio < least then least, best = ratio, i end
  end
  local place = {}
  for i, name in ipairs(info.own) do place[i] = ("%s = %.3g"):format(name, where[i]) end
  return POLE:format(info.own[best], table.concat(place, ", "), way(info))
end

-- what is wrong in the last rows
local function behind(info, path)
  local n = #path
  for i = n, max(2, n - 3), -1 do
    local where = #path >= path.steps + 1 and jumps.over(path, i, math.huge)
    if where then
      return "pole", M.vanishing(path, info, where, path.q[i - 1], path.t[i])
    end
  end
end

local AHEAD, PARTS = 2, 32  -- steps that the line ahead is followed

-- what the last row heads for
local function ahead(info, path, v)
  local n = #path
  local x, t = path.q[n], path.t[n]
  for k = 1, PARTS do
    local code, why = M.at(path, info, x + AHEAD * path.h * k / PARTS * v, t, path.q[1],
      path.t[1])
    if code then return code, "the last row heads for such a place: " .. why end
  end
  local where = jumps.singular(path, x, x + AHEAD * path.h * v, t)
  if where then
    return "pole", "the last row heads for such a place: " .. M.vanishing(path, info, where, x, t)
  end
end

--- The same for the end of a path: where it is, where it heads, and what its last steps went over.
function M.of_end(shape, info, path)
  local n = #path
  local x, t = path.q[n], path.t[n]
  local code, why = M.at(path, info, x, t, path.q[1], path.t[1])
  local known, v = blame.try(path.velocity, path, n)
  if not code and known then code, why = leaves(shape, info, x, v, t, path.h) end
  if not code and known then code, why = ahead(info, path, v) end
  if not code then code, why = behind(info, path) end
  return code, why
end

return M
