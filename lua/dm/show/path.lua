--- Methods of dm.path that are written in Lua: series and plot. csv and npy are in dm.export.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

-- how many columns q has: on groups more than p (flat coordinates of elements), or than entries of
-- path.q[i]
local function positions(path)
  local columns = path.columns
  for i = 3, #columns do
    if columns[i] == "p1" or columns[i] == "p_" .. columns[2] then return i - 2 end
  end
  return #columns - 1
end

-- "q", "p", "t" or "energy" for the column `name` of a path, "rotation" for entries of one; units
-- are filed under these or the name
local function place_of(path, name)
  if name == "t" or name == "time" then return "t" end
  if name:find "^R%d%d" then return "rotation" end
  if path.watched then return name end
  local columns, n = path.columns, positions(path)
  for i, column in ipairs(columns) do
    if column == name then return i <= n + 1 and "q" or i <= 2 * n + 1 and "p" or name end
  end
  return name:match("^([qp])%d+$") or name
end

-- numbers of a column with its label, its unit and what it is: a name, or one number a row
local function column(path, key, what)
  if type(key) == "string" then
    local place, units = place_of(path, key), path.units or {}
    return path:column(key), key, units[key] or units[place],
      (place == "q" or place == "rotation") and place or nil
  end
  local numbers = require "dm.show.series".numbers(key, what)
  if #numbers ~= #path then
    error(("%s has %d numbers, but the path has %d rows: give a column name or one number a row")
      :format(what, #numbers, #path), 0)
  end
  return numbers
end

local doc_series = [[
path:series(x, y, name) -> { x =, y =, name = } for dm.plot and dm.figure
x, y: a column name ("t", "q1", "p1", "energy" ...) or a vector of #path numbers; name: text of the
legend. Labels and units come along.]]

M.series = blame.caller(function(path, x, y, name)
  local xs, xlabel, xunit, xplace = column(path, x, "x")
  local ys, ylabel, yunit, yplace = column(path, y, "y")
  return core.result { x = xs, y = ys, name = name or ylabel, xlabel = xlabel, ylabel = ylabel,
    xunit = xunit,
    yunit = yunit, xplace = xplace, yplace = yplace, title = path.title }
end)

-- a list of columns, from one column or a list of them
local function listed(y)
  if type(y) ~= "table" or type(y[1]) == "number" then return { y } end
  for key in pairs(y) do
    if type(key) == "string" then
      error(("plot: '%s' stands in the list of columns; options are a table behind it: "
        .. "path:plot({ \"q1\" }, { %s = ... })"):format(key, key), 0)
    end
  end
  return y
end

-- every q, or all that was watched, against time
local function default_columns(path)
  local columns, y = path.columns, {}
  local last = path.watched and #columns or #path > 0 and positions(path) + 1 or 1
  for i = 2, last do y[#y + 1] = columns[i] end
  return "t", y
end

local doc_plot =
  "path:plot(x, y | {y1, y2, ...}, {file=, title=, log=, style=, names=, equal=, ...}) "
  .. "-> file name or nothing\n" .. [[
Plot columns of a path: names ("t", "q1", "p1", "energy" ...) or vectors of #path numbers. With no
arguments every q (or all that was watched) against t; path:plot("q1") is q1 against t. Options as
in dm.plot: without `file` in the terminal, with it to a .png, .svg or .pdf.
Two positions of one unit, or two entries of rotations, get equal axes unless equal = false; where
one range is 4 times the other or more they do not, which is written below the plot: equal = true
makes them equal all the same.]]

M.plot = blame.caller(function(path, x, y, options)
  x, y = core.unlocked(x), core.unlocked(y)
  if type(x) == "table" and next(x) and not x[1] then x, options = nil, x end
  if type(y) == "table" and next(y) and not y[1] then y, options = nil, y end
  if x == nil then x, y = default_columns(path) end
  if y == nil then x, y = "t", x end
  if type(x) == "table" and type(x[1]) == "string" then
    error("plot: x must be one column; for curves with x of their own: "
      .. "dm.plot { path:series(\"q1\", \"q2\"), path:series(\"q3\", \"q4\") }", 0)
  end
  local series = {}
  for i, key in ipairs(listed(y)) do series[i] = M.series(path, x, key) end
  return require "dm.show.plot".plot(series, options or {})
end)

core.method("dm.path", "series", M.series, doc_series)
core.method("dm.path", "plot", M.plot, doc_plot)

return M
