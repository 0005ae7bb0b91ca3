--- ensemble:plot: the paths of the members in one picture, or where they ended.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local palette = require "dm.show.palette"
local paths = require "dm.show.path"

local M = {}

local MOST_PATHS = 64  -- lines that can still be told apart

local fail = require "dm.base.options".failing "ensemble:plot"

---- which members ----

local function every_one(n)
  local out = {}
  for i = 1, n do out[i] = i end
  return out
end

-- at most `count` numbers from 1 to n, evenly spread, both ends among them
local function spread(n, count)
  if count >= n then return every_one(n) end
  local out = {}
  for k = 0, count - 1 do out[k + 1] = count == 1 and 1 or 1 + (n - 1) * k // (count - 1) end
  return out
end

local function chosen(ensemble, members, most)
  local n = #ensemble
  if members == nil then return spread(n, most) end
  if math.type(members) == "integer" and members >= 1 then return spread(n, members) end
  if type(members) ~= "table" or #members == 0 then
    fail("'members' must be a number of members or a list of their numbers (got %s)",
      tostring(members))
  end
  for _, i in ipairs(members) do
    if not lists.whole(i) or i < 1 or i > n then
      fail("'members': there are members 1 to %d (got %s)", n, tostring(i))
    end
  end
  return members
end

---- a fan of paths ----

-- from the first colour of lines to the second with the number of the member; those that failed are
-- grey
local function shade(ensemble, i)
  if ensemble.status[i] ~= "ok" then return palette.GREY end
  return palette.between(#ensemble > 1 and (i - 1) / (#ensemble - 1) or 0)
end

local function fan(ensemble, x, y, members)
  local series = {}
  for _, i in ipairs(chosen(ensemble, members, MOST_PATHS)) do
    local path = ensemble:path(i)
    local one = paths.series(path, x or "t", y or path.columns[2], "member " .. i)
    one.colour = shade(ensemble, i)
    series[#series + 1] = one
  end
  return series
end

---- where they ended ----

-- the matrix and the column of a name
local function column(ensemble, key, what)
  local system = ensemble.solver.system
  local names, q, p = system.coordinates or {}, ensemble.q, ensemble.p
  for i = 1, q.columns do
    if key == "q" .. i or key == names[i] then return q, i end
    if key == "p" .. i or names[i] and key == "p_" .. names[i] then return p, i end
  end
  fail("%s must be a column of q or p, \"q1\" to \"p%d\" (got %s); other columns need rows: every "
    .. "=, rows = or watch = of solver:ensemble", what,
    q.columns, tostring(key))
end

local function ends(ensemble, x, y, members)
  x = x or "q1"
  y = y or (ensemble.q.columns > 1 and "q2" or "p1")
  local of_x, i = column(ensemble, x, "x")
  local of_y, j = column(ensemble, y, "y")
  local xs, ys = {}, {}
  for _, k in ipairs(chosen(ensemble, members, math.huge)) do
    if ensemble.status[k] == "ok" then xs[#xs + 1], ys[#ys + 1] = of_x[k][i], of_y[k][j] end
  end
  if #xs == 0 then fail "every one of these members failed: ensemble:failures()" end
  return { { x = core.vector(xs), y = core.vector(ys), name = "ends", xlabel = x, ylabel = y,
    style = "points" } }
end

local function is_name(x) return type(x) == "string" end

--- What is drawn, as series for dm.plot.
function M.series(ensemble, x, y, members)
  if x and not y and ensemble.rows then x, y = nil, x end
  return (ensemble.rows and fan or ends)(ensemble, x, y, members)
end

--- The method; its doc is in dm.stability_methods.
M.plot = blame.caller(function(ensemble, x, y, options)
  if type(x) == "table" then
    x, y, options = nil, nil, x
  elseif type(y) == "table" then
    y, options = nil, y
  end
  if x ~= nil and not is_name(x) or y ~= nil and not is_name(y) then
    fail "x and y are names of columns, then a table of options"
  end
  local given, members = { legend = false }, nil
  for key, value in pairs(options or {}) do
    if key == "members" then members = value else given[key] = value end
  end
  return require "dm.show.plot".plot(M.series(ensemble, x, y, members), given)
end)

class.method("dm.ensemble", "plot", M.plot, [[
ensemble:plot([x, y,] {members=, file=, title=, style=, ...}) -> file name or nothing
With rows (every=, rows=, watch=): the fan of the members' paths, columns as in path:plot (left out:
the first column against t). Without: where the members ended, a point each, as columns of q and p
("q1", "p1" or the names of the coordinates; left out: q1 and q2, or q1 and p1). members: how many
are drawn, evenly chosen (default 64 paths, all points), or a list of their numbers. Colours go from
blue to red with the number of the member; one that failed is grey up to there, and is not drawn as
an end. Options as in dm.plot.]])

return M
