--- Points as a caller gives them, as lists of vectors.
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

-- a point as a dm.vector of m entries: from a vector, a table or, where m = 1, a number
local function point(z, m, what)
  if m == 1 and (type(z) == "number" or not pcall(function() return #z end)) then z = { z } end
  local fine, v = pcall(function() return type(z) == "table" and core.vector(z) or z end)
  if not fine or not pcall(function() return #v end) or #v ~= m then error(("%s must have %d entries"):format(what, m), 0) end
  for j = 1, m do
    if type(v[j]) == "number" and not (math.abs(v[j]) < math.huge) then
      error(("%s is not finite: entry %d is %s"):format(what, j, tostring(v[j])), 0)
    end
  end
  return v
end

-- the points z[1 ...] of a flat vector
local function split(z, count, m)
  local out = {}
  for i = 1, count do
    local p = {}
    for j = 1, m do p[j] = z[(i - 1) * m + j] end
    out[i] = core.vector(p)
  end
  return out
end

-- one list of points: a table of them as it is, the rows of a matrix, one flat vector of k m entries
local function unstacked(list, m)
  if kits.class_of(list) == "dm.matrix" then return list:totable() end
  local size, numbers = #list, type(list) ~= "table" or type(list[1]) == "number"
  if numbers and size > m and size % m == 0 then return split(list, size // m, m) end
  if type(list) ~= "table" or m > 1 and numbers then return { list } end
  return list
end

M.point, M.split, M.unstacked = point, split, unstacked

--- Points of d numbers that a caller gives as a list; `what` names what is wanted in its place.
function M.list(given, d, what)
  local class = kits.class_of(given)
  if class ~= "table" and class ~= "dm.matrix" and class ~= "dm.vector" then error(what, 0) end
  local out = {}
  for i, z in ipairs(unstacked(given, d)) do out[i] = point(z, d, "point " .. i) end
  return out
end

--- All numbers of a list of points.
function M.flat(list)
  local out = {}
  for _, z in ipairs(list) do
    for i = 1, #z do out[#out + 1] = z[i] end
  end
  return core.vector(out)
end

return M
