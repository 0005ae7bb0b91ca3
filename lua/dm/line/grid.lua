--- The nodes of a line, and what a user gives on them: functions of x, or lists.
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local MOST = 10000000

local function is_finite(x) return type(x) == "number" and x - x == 0 end

--- { from, to, cells, dx, periodic, nodes } from option x = { from, to, cells, periodic = }.
function M.read(given, where, cells)
  cells = cells or "cells"
  if type(given) ~= "table" then
    option.fail(where, "option 'x' must be { from, to, %s, periodic = } (got %s)", cells,
      option.got(given))
  end
  option.check(given, { entries = true, "periodic" }, where .. "'s x")
  local from, to, count = given[1], given[2], given[3]
  if not (is_finite(from) and is_finite(to) and from < to) or #given ~= 3 then
    option.fail(where, "option 'x' must be { from, to, %s, periodic = } with from < to", cells)
  end
  count = option.whole({ [cells] = count }, cells, where .. "'s x", given.periodic and 3 or 1, MOST)
  if not count then option.fail(where, "option 'x': the number of %s is missing", cells) end
  local periodic = given.periodic and true or false
  return { from = from, to = to, cells = count, dx = (to - from) / count, periodic = periodic,
    nodes = periodic and count or count + 1 }
end

--- Where node i is, from 1.
function M.x(grid, i)
  if i == grid.nodes and not grid.periodic then return grid.to end
  return grid.from + (i - 1) * grid.dx
end

--- The left ends of all cells, as a vector.
function M.lefts(grid)
  local out = {}
  for c = 1, grid.cells do out[c] = grid.from + (c - 1) * grid.dx end
  return core.vector(out)
end

-- what f gave at x as a list of n numbers
local function entries_of(value, n, key, where, x)
  local list = type(value) == "number" and { value } or value
  if lists.count(list) ~= n then
    option.fail(where, "%s must give %s at x = %g (got %s)", key,
      n == 1 and "a number" or ("%d numbers"):format(n), x, option.got(value))
  end
  for k = 1, n do
    if not is_finite(list[k]) then
      option.fail(where, "%s is %s at x = %g: it must be finite", key, tostring(list[k]), x)
    end
  end
  return list
end

local function of_function(grid, f, n, key, where)
  local out = {}
  f = option.single(f, where .. ": " .. key)
  for i = 1, grid.nodes do
    local x = M.x(grid, i)
    local list = entries_of(f(x), n, key, where, x)
    for k = 1, n do out[#out + 1] = list[k] end
  end
  return core.vector(out)
end

local function of_nodes(grid, given, n, key, where)
  local out = {}
  for i = 1, grid.nodes do
    local list = entries_of(given[i], n, key, where, M.x(grid, i))
    for k = 1, n do out[#out + 1] = list[k] end
  end
  return core.vector(out)
end

--- n numbers at every node, node after node, from a function of x, a list of them, a list with an
-- entry for each node, or one number for all; nothing given: zeros.
function M.values(grid, given, n, key, where)
  if given == nil then return core.zeros(grid.nodes * n) end
  if type(given) == "number" then
    local x = given
    given = function()
      if n == 1 then return x end
      local list = {}
      for k = 1, n do list[k] = x end
      return list
    end
  end
  if type(given) == "function" then return of_function(grid, given, n, key, where) end
  local count = lists.count(given)
  if count == grid.nodes and (n > 1 or type(given[1]) == "number") then
    return of_nodes(grid, given, n, key, where)
  end
  if count ~= grid.nodes * n then
    option.fail(where, "%s must be a function of x or a list for %d nodes%s (got %s)", key,
      grid.nodes, n > 1 and (" of %d numbers"):format(n) or "",
      count and ("%d entries"):format(count) or option.got(given))
  end
  local one = { nodes = grid.nodes * n, from = grid.from, to = grid.to, dx = grid.dx / n,
    periodic = grid.periodic }
  return of_nodes(one, given, 1, key, where)
end

return M
