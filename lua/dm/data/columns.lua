--- Columns of runs that are no dm.path: one number a row, by name, and how they drift.
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local DRIFT = [[
%s:drift(name | vector) -> {per_time, error, mean, largest}
Least squares slope against time of a column, or of a vector of one number a row, its standard
error from block means, the mean, and the largest distance from the first row. At least 3 rows.]]

local function drift(where, run, of)
  if #run < 3 then option.fail(where, "at least 3 rows are needed (there are %d)", #run) end
  local y = type(of) == "string" and run:column(of) or of
  if lists.count(y) ~= #run then
    option.fail(where, "the name of a column or a vector of %d numbers, one a row, is needed (got "
      .. "%s)", #run, option.got(of))
  end
  return core.drift(run.t, core.vector(y))
end

--- Gives a class ("dm.flow") the methods column and drift. column(run, name): the numbers, or
-- nothing and a text that lists the columns; name: how docs call an object.
function M.give(of, name, column, doc)
  class.method(of, "column", function(run, key)
    if key == "time" then key = "t" end
    local values, there = run.t, nil
    if key ~= "t" then values, there = column(run, key) end
    if values == nil then
      option.fail(name .. ":column", "no column '%s'; there are %s", tostring(key), there)
    end
    return core.vector(values)
  end, doc)

  class.method(of, "drift", function(run, key) return drift(name .. ":drift", run, key) end,
    DRIFT:format(name))
end

return M
