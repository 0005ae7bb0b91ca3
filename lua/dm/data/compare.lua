--- dm.compare: how far two paths are apart, column by column, and when.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.compare"
local fail = option.failing(WHERE)

local abs, max = math.abs, math.max

local class = { __name = "dm.comparison" }
M.class = class

function class.__tostring(c)
  local out = { ("largest difference %.3g in '%s' at t = %.6g (%d rows)")
    :format(c.worst, c.column, c.t, c.rows) }
  for _, row in ipairs(c) do
    out[#out + 1] = ("  %-12s %-10.3g at t = %.6g"):format(row.name, row.difference, row.t)
  end
  return table.concat(out, "\n")
end

local function is_path(x)
  local fine, is = blame.try(function()
    return x.columns ~= nil and x.steps ~= nil and x.column ~= nil
  end)
  return type(x) == "userdata" and fine and is
end

-- pairs of rows at the same times
local function common_rows(a, b)
  local t, s, rows = a:column "t", b:column "t", {}
  local near, j = 1e-9 * max(a.h, b.h), 1
  for i = 1, #a do
    while j <= #b and s[j] < t[i] - near do j = j + 1 end
    if j <= #b and abs(s[j] - t[i]) <= near then rows[#rows + 1] = { i, j } end
  end
  return rows, t
end

-- names in a and in b of what is compared: the same names, else the same places
local function common_columns(a, b, wanted)
  local one, two, out = a.columns, b.columns, {}
  local there = {}
  for _, name in ipairs(two) do there[name] = true end
  local function add(name, other) out[#out + 1] = { name, other } end
  if wanted then
    for _, name in ipairs(wanted) do add(name, name) end
    return out
  end
  for i = 2, #one do
    if there[one[i]] then add(one[i], one[i]) end
  end
  if #out == 0 and #one == #two then
    for i = 2, #one do add(one[i], two[i]) end
  end
  return out
end

local function difference(a, b, names, rows, t)
  local x, y, worst, when = a:column(names[1]), b:column(names[2]), 0, t[rows[1][1]]
  for _, pair in ipairs(rows) do
    local d = abs(x[pair[1]] - y[pair[2]])
    if not (d <= worst) and worst == worst then worst, when = d, t[pair[1]] end
  end
  return { name = names[1], difference = worst, t = when }
end

local doc = [[
dm.compare(a, b [, {columns=}]) -> dm.comparison {worst, column, t, rows, {name, difference, t} ...}
The largest difference of two paths at the times that both have, for every column of the same name
(or of the same place, where no name is shared): how large, and when. columns: a list of names,
"energy" too. worst, column, t: of all of them.]]

M.compare = blame.caller(function(a, b, options)
  if not is_path(a) or not is_path(b) then fail "takes two paths, a and b" end
  options = option.check(options or {}, { "columns" }, WHERE)
  local rows, t = common_rows(a, b)
  if #rows == 0 then fail "the paths have no times in common" end
  local names = common_columns(a, b, options.columns)
  if #names == 0 then fail "the paths have no columns in common" end
  local out = { worst = -1, rows = #rows }
  for i, pair in ipairs(names) do
    out[i] = difference(a, b, pair, rows, t)
    if not (out[i].difference <= out.worst) then
      out.worst, out.column, out.t = out[i].difference, out[i].name, out[i].t
    end
  end
  return setmetatable(out, class)
end)

core.docs[M.compare] = doc

return M
