--- Points as a caller gives them, as lists of vectors.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local places = require "dm.action.points"

local M = {}

-- a point as a dm.vector of m entries: from a vector, a table or, where m = 1, a number
local function point(z, m, what)
  if m == 1 and (type(z) == "number" or not blame.try(function() return #z end)) then z = { z } end
  local fine, v = blame.try(function() return type(z) == "table" and core.vector(z) or z end)
  if not fine or type(v) == "string" or not blame.try(function() return #v end) or #v ~= m then
    error(("%s must have %d entries"):format(what, m), 0)
  end
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

-- one list of points: a table of them as it is, the rows of a matrix, one flat vector of k m
-- entries
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

-- several values of a function are the entries of its list
local function several(...)
  local out = table.pack(...)
  for i = 1, out.n do
    local class = kits.class_of(out[i])
    if out[i] == nil or class == "table" or class == "dm.vector" then
      error(("must return one list or several numbers: value %d of %d is %s")
        :format(i, out.n, out[i] == nil and "nil" or "a list"), 0)
    end
  end
  out.n = nil
  return out
end

-- a copy of a list; what a user has put beside its entries, under a name, is not lost in silence
local function unpacked(list)
  for key in next, list do
    if type(key) ~= "number" and not getmetatable(list) then
      error(("a list has '%s' beside its entries, which would be lost: entries have no names")
        :format(tostring(key)), 0)
    end
  end
  return { table.unpack(list) }
end

--- a number, a table or a vector as a list; also what a function returns as several values
function M.entries(value, ...)
  if select("#", ...) > 0 then return several(value, ...) end
  if type(value) == "number" then return { value } end
  if type(value) == "table" then return unpacked(value) end
  if kits.is_scalar(value) then return { value } end
  if kits.class_of(value) == "dm.vector" then return value:totable() end
  local fine, count = blame.try(function() return #value end)
  if not fine or type(value) == "string" then return { value } end
  local out = {}
  for i = 1, count do out[i] = value[i] end
  return out
end

function M.symbolic(list)
  for _, z in ipairs(list) do
    for i = 1, #z do
      if type(z[i]) ~= "number" then return true end
    end
  end
  return false
end

-- numbers between -1 and 1 without a pattern, the same in every run
local function stream(seed)
  local state = seed * 7919 + 12345
  return function()
    state = (state * 1103515245 + 12345) % 2147483648
    return 2 * state / 2147483648 - 1
  end
end
M.stream = stream

local SOURCE = core.random(7)

--- Points of sample `seed`, `count` of them (default: those of the frame), on the space of the
-- action.
function M.sample(frame, seed, count)
  local out = {}
  for i = 1, count or frame.k do
    out[i] = places.sample_point(frame.action.on, SOURCE, 64 * seed + i)
  end
  return out
end

--- All numbers of a list of points.
function M.flat(list)
  local plain, out, n = core.joined(list), {}, 0
  if plain then return plain end
  for _, z in ipairs(list) do
    local size = #z
    for i = 1, size do out[n + i] = z[i] end
    n = n + size
  end
  return core.vector(out)
end

return M
