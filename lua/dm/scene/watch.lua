--- What a scene watches: functions of (q, v, t, p), the columns that they make, the coordinates
-- that they need.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local fail = option.failing "dm.scene"

--- Names of the coordinates of a system.
function M.names(system)
  local given, out = system.coordinates, {}
  for i = 1, system.Q.dimension do out[i] = given and given[i] or "q" .. i end
  return out
end

-- entry of (q, p) called `name`: "theta", "q2", "p2", "p_theta"; as the number of the coordinate
-- and whether it is a momentum
local function entry_of(names, name)
  for i, own in ipairs(names) do
    if name == own or name == "q" .. i then return i, false end
    if name == "p_" .. own or name == "p" .. i then return i, true end
  end
end

local function of_name(problem, name)
  local i, momentum = entry_of(problem.names, name)
  if i and momentum then return function(_, _, _, p) return p[i] end end
  if i then return function(q) return q[i] end end
  if name ~= "energy" then
    fail("option 'watch': there is no '%s'; watch coordinates (%s), momenta (p_%s), \"energy\", "
      .. "\"picture\" (every coordinate), or "
      .. "name = function(q, v, t, p) ... end", name, table.concat(problem.names, ", "),
      problem.names[1])
  end
  return function(q, v, t, p)
    local sum = -problem.L(q, v, t)
    for k = 1, problem.n do sum = sum + v[k] * p[k] end
    return sum
  end
end

-- name -> function(q, v, t, p) of the option 'watch'
local function functions(problem, watch)
  local out = {}
  if watch == "picture" then watch = problem.names end
  if type(watch) == "string" then watch = { watch } end
  if type(watch) == "function" then watch = { watched = watch } end
  if type(watch) ~= "table" then
    fail("option 'watch' says what is looked at: { \"theta\", r = function(q, v, t, p) ... end }, "
      .. "or \"picture\" (got %s)", type(watch))
  end
  for key, value in pairs(watch) do
    if value == "picture" then
      fail("option 'watch': \"picture\" is every coordinate and stands alone: watch = "
        .. "\"picture\", in no list")
    end
    if type(value) == "string" then
      out[value] = of_name(problem, value)
    elseif type(key) == "string" and type(value) == "function" then
      out[key] = value
    else
      fail("option 'watch': entry '%s' must be a name, or name = function(q, v, t, p) ... end",
        tostring(key))
    end
  end
  if next(out) == nil then
    fail("nothing is watched: name coordinates or functions in option 'watch'")
  end
  return out
end

-- f as a traced function of (q, v, t, p)
local function traced(problem, name, f)
  local n = problem.n
  local function all(q, v, t, p) return f(q, v, t, p) end
  local fine, out = blame.try(core.trace, all, n, n, "number", n)
  if not fine then fail("option 'watch': '%s': %s", name, tostring(out)) end
  return out
end

-- marks the coordinates that f needs: where it depends on p_i those that dL/dv_i depends on
local function mark(problem, needs, f)
  local depends = f:depends()
  for i = 1, problem.n do
    needs.q[i] = needs.q[i] or depends[1][i]
    needs.v[i] = needs.v[i] or depends[2][i]
    if depends[4][i] then
      local of_p = problem.momentum_depends(i)
      for k = 1, problem.n do
        needs.q[k] = needs.q[k] or of_p[1][k]
        needs.v[k] = needs.v[k] or of_p[2][k]
      end
    end
  end
end

local function check_tolerance(tolerance, what)
  if type(tolerance) ~= "number" or not (tolerance > 0 and tolerance < math.huge) then
    fail("%s must be a number > 0, in the units of what is watched (got %s)", what,
      option.got(tolerance))
  end
  return tolerance
end

--- The tolerance of a column: its own, that of the function (r of r1, r2), or the one for all.
function M.tolerance_of(tolerance, column)
  if type(tolerance) ~= "table" then return check_tolerance(tolerance, "option 'tolerance'") end
  local own = tolerance[column] or tolerance[column:gsub("%d+$", "")]
  return check_tolerance(own, ("option 'tolerance': the one of '%s'"):format(column))
end

--- Read the options 'watch' and 'tolerance' of a problem: sets watched = { name = f }, columns,
-- tolerance[column], needs = { q, v }.
function M.read(problem, options)
  problem.watched = functions(problem, options.watch)
  problem.columns, problem.tolerance, problem.needs = {}, {}, { q = {}, v = {} }
  for name, f in pairs(problem.watched) do
    local function_of_state = traced(problem, name, f)
    mark(problem, problem.needs, function_of_state)
    local value = function_of_state(problem.q, problem.v, problem.t0, problem.p)
    local count = type(value) == "number" and 1 or #value
    for i = 1, count do
      problem.columns[#problem.columns + 1] = count == 1 and name or name .. i
    end
  end
  table.sort(problem.columns)
  for _, column in ipairs(problem.columns) do
    problem.tolerance[column] = M.tolerance_of(options.tolerance, column)
  end
end

return M
