--- Axes of a stability map: lists of numbers under any name, and functions of these parameters.
local M = {}

local lists = require "dm.base.lists"
local option = require "dm.base.options"
local fail = option.failing "dm.stability"

local MOST = 4096  -- numbers of an axis

local function check_ends(name, lo, hi, count, mode)
  if type(lo) ~= "number" or type(hi) ~= "number"
    or not (lo < hi and lo > -math.huge and hi < math.huge) then
    fail("axis '%s' must be {least, largest, count, \"log\" or \"linear\"} with least < largest",
      name)
  end
  if math.type(count) ~= "integer" or count < 2 or count > MOST then
    fail("axis '%s': the count must be a whole number from 2 to %d (got %s)", name, MOST,
      tostring(count))
  end
  if mode ~= "log" and mode ~= "linear" then
    fail("axis '%s': \"log\" or \"linear\" is needed (got %q)", name, mode)
  end
  if mode == "log" and lo <= 0 then fail("axis '%s': a logarithmic axis begins above 0", name) end
end

local function spaced(name, lo, hi, count, mode)
  check_ends(name, lo, hi, count, mode)
  local out = { log = mode == "log" }
  for i = 1, count do
    local s = (i - 1) / (count - 1)
    out[i] = out.log and lo * (hi / lo) ^ s or lo + (hi - lo) * s
  end
  out[count] = hi * 1.0
  return out
end

-- given one by one: spaced as its numbers are
local function listed(name, list)
  local count = list[3]
  if #list == 3 and math.type(count) == "integer" and count > 1 and list[1] < list[2]
    and count <= list[2] then
    fail("axis '%s': three numbers are a list, which must grow; for %d values from %g to %g: {%g, "
      .. "%g, %d, \"linear\"}, or \"log\"",
      name, count, list[1], list[2], list[1], list[2], count)
  end
  local out, last = { log = #list > 2 and list[1] > 0 }, -math.huge
  if #list == 0 or #list > MOST then fail("axis '%s' must have 1 to %d numbers", name, MOST) end
  for i, x in ipairs(list) do
    if type(x) ~= "number" or not (x > last and x < math.huge) then
      fail("axis '%s': number %d must be a finite number larger than the one before (got %s)", name,
        i, tostring(x))
    end
    out[i], last = x * 1.0, x
  end
  if out.log then out.log = out[#out] / out[1] > 20 end
  return out
end

-- Parameters that are given as whole numbers stay such, as sizes of meshes must; evenly spaced ones
-- too, where all are.
local function keep_whole(out, given)
  for i = 1, math.min(3, #given) do
    if math.type(given[i]) ~= "integer" then return out end
  end
  for i = 1, #out do
    if not lists.whole(out[i]) then return out end
  end
  for i = 1, #out do out[i] = lists.whole(out[i]) end
  out.whole = true
  return out
end

-- as numbers with a point
local function read(name, given)
  if type(given) == "number" then given = { given } end
  if type(given) ~= "table" then
    fail("axis '%s' must be a number, a list of numbers, or {least, largest, count, \"log\" or "
      .. "\"linear\"} (got %s)", name, type(given))
  end
  if type(given[4]) == "string" then
    local out = spaced(name, given[1], given[2], given[3], given[4])
    out.name = name
    return out
  end
  for i = 1, #given do
    if type(given[i]) ~= "number" then
      fail("axis '%s': entry %d must be a number (got %s)", name, i, tostring(given[i]))
    end
  end
  local out = listed(name, given)
  out.name = name
  return out
end

--- An axis: a number, a list of growing numbers, or {least, largest, count, "log" | "linear"}.
function M.read(name, given)
  given = lists.plain(given)
  local out = read(name, given)
  return name == "h" and out or keep_whole(out, type(given) == "table" and given or { given })
end

-- names of the arguments of a Lua function
local function arguments(f)
  local out = {}
  local info = debug.getinfo(f, "u")
  for i = 1, info.nparams do out[i] = debug.getlocal(f, i) end
  return out, info.isvararg
end

--- Are all arguments of f, one at least, parameters?
function M.takes(f, names)
  local known, args = {}, arguments(f)
  for _, name in ipairs(names) do known[name] = true end
  for _, arg in ipairs(args) do
    if not known[arg] then return false end
  end
  return #args > 0
end

--- f(values by name) of a function of the parameters: by the names of its arguments, or, where
-- there is one parameter, whatever its argument is called. Also the list of names that it uses.
function M.bind(what, f, names)
  local known, args, used = {}, arguments(f), {}
  for _, name in ipairs(names) do known[name] = true end
  local match = true
  for i, arg in ipairs(args) do
    match = match and known[arg] or false
    used[i] = arg
  end
  if not match or #args == 0 then
    if #names == 0 then
      fail("'%s' is a function, but there is no parameter: give one as name = {least, largest, "
        .. "count, \"log\"}", what)
    end
    if #names > 1 then
      fail("'%s' is a function of (%s): with two parameters its arguments must have their names, "
        .. "%s", what, table.concat(args, ", "), table.concat(names, " and "))
    end
    used = { names[1] }
  end
  f = option.single(f, ("'%s'"):format(what))
  return function(values)
    local list = {}
    for i, name in ipairs(used) do list[i] = values[name] end
    return f(table.unpack(list, 1, #used))
  end, used
end

--- The number half way between two of an axis, in its spacing.
function M.between(axis, a, b, s)
  if axis.log then return a * (b / a) ^ s end
  return a + (b - a) * s
end

--- Edges of cell i: half way to its neighbours.
function M.edges(axis, i)
  local function half(a, b) return M.between(axis, a, b, 0.5) end
  local here, before, after = axis[i], axis[i - 1], axis[i + 1]
  if not before and not after then
    local half_width = here ~= 0 and math.abs(here) / 10 or 0.05
    return here - half_width, here + half_width
  end
  local lo = before and half(before, here)
  local hi = after and half(here, after)
  if axis.log then return lo or here * here / hi, hi or here * here / lo end
  return lo or 2 * here - hi, hi or 2 * here - lo
end

return M
