--- What is right or wrong in a cell of a stability map: observables, and the velocity that
-- constraints leave over.
local bound = require "dm.base.bound"
local core = require "dm.core"
local line_flows = require "dm.stability.line_flows"
local lists = require "dm.base.lists"
local observed = require "dm.measure.observed"
local tangent_group = require "dm.measure.tangent_group"

local M = {}

local fail = require "dm.base.options".failing "dm.stability"

local ACCURACY = 0.01  -- of the range of an observable

--- The accuracy that is asked for; nil: nothing is compared.
function M.accuracy(options)
  local given = options.accuracy
  if given == false then return nil end
  if given ~= nil and not (type(given) == "number" and given > 0 and given < 1) then
    fail("option 'accuracy' must be a number between 0 and 1, in parts of the range of an "
      .. "observable, or false (got %s)", tostring(given))
  end
  for _, key in ipairs { "accuracy", "observe" } do
    if options[key] ~= nil and not options.t then
      fail("option '%s' is of what is right up to one time for all cells: give t, a duration, in "
        .. "place of steps", key)
    end
  end
  return options.t and (given or ACCURACY)
end

-- the number of a coordinate by its name, and "q" or "p" for its momentum
local function entry_of(names, name)
  for i, own in ipairs(names) do
    if name == own or name == "q" .. i then return "q", i end
    if name == "p_" .. own or name == "p" .. i then return "p", i end
  end
end

-- on a group: the function of that name, "energy", or nothing
local function on_group(system, name)
  local f = name ~= "energy" and observed.of(system.place, name)
  if not f and name ~= "energy" then
    fail("option 'observe': there is no '%s'; on %s observe entries of the element (R31, of factor "
      .. "k R31_k), momenta (p1), \"energy\", or name = function(g, xi, t, p) ... end",
      tostring(name), tostring(system.Q))
  end
  return f or nil
end

-- columns as solvers call them, so that none is mistaken for a number of ours
local function column_of(system, names, name)
  local kind, i = entry_of(names, name)
  if kind and not system.coordinates then return name end
  if kind then return kind == "q" and names[i] or "p_" .. names[i] end
  if name ~= "energy" then
    fail("option 'observe': there is no '%s'; observe coordinates (%s), momenta (p_%s), "
      .. "\"energy\", or name = function(q, v, t, p) ... end", tostring(name),
      table.concat(names, ", "), names[1])
  end
  return name
end

local MOST = 48 -- names that are observed where nothing is said; a run watches 64 numbers

-- what is observed where nothing is said: all names, of a field those that are not fixed; of more
-- so many, evenly
local function names_to_observe(system, names)
  local field = not system.place and system.field
  if #names <= MOST then return names end
  local free, out = {}, {}
  for i, name in ipairs(names) do
    if not (field and field.held[i]) then free[#free + 1] = name end
  end
  local count = math.min(MOST, #free)
  for k = 1, count do out[k] = free[1 + (k - 1) * #free // count] end
  return out
end

local function names_of(system)
  if system.place then return observed.names(system.place) end
  local out = {}
  for i = 1, system.Q.dimension do
    out[i] = system.coordinates and system.coordinates[i] or "q" .. i
  end
  return out
end

-- entries of the option: names, and functions under their names, in an order of their own
local function entries(observe)
  if type(observe) == "string" then observe = { observe } end
  if type(observe) ~= "table" or next(observe) == nil then
    fail("option 'observe' must be a list of names: { \"q1\", r = function(q, v, t, p) ... end } "
      .. "(got %s)", type(observe))
  end
  local out = {}
  for key, value in pairs(observe) do
    local named = type(key) == "string" and type(value) == "function"
    if not named and type(value) ~= "string" then
      fail("option 'observe': entry '%s' must be a name, or name = function(q, v, t, p) ... end",
        tostring(key))
    end
    out[#out + 1] = { name = named and key or value, f = named and value or nil }
  end
  table.sort(out, function(a, b) return a.name < b.name end)
  return out
end

--- { names, columns, watch, of, most }: what is observed, what its columns are called in runs of a
-- system, what to watch for them, the number of coordinates, and how many names there were.
function M.read(options, system)
  if system.line then
    return line_flows.observed(entries(options.observe or line_flows.names(system.line)),
      system.line)
  end
  local names = names_of(system)
  local out = { names = {}, columns = {}, watch = {}, of = system.Q.dimension,
    most = not options.observe and #names or nil }
  for i, entry in ipairs(entries(options.observe or names_to_observe(system, names))) do
    local f = entry.f or system.place and on_group(system, entry.name)
    out.names[i] = entry.name
    if f then
      out.columns[i] = "observed_" .. entry.name
      out.watch[out.columns[i]] = f
    else
      out.columns[i] = column_of(system, names, entry.name)
      table.insert(out.watch, out.columns[i])
    end
  end
  return out
end

---- what constraints g(q, t) = 0 ask of the velocity: G v + g_t = 0 ----

-- the same on a group
local function slopes_on_group(system)
  local g = bound(system.given.constraint, system.given.params)
  local d = system.place.dimension
  local slope, N = tangent_group.slopes(system, function(q, _, t)
    return core.vector(lists.entries(g(q, t)))
  end)
  return function(q, t)
    local J, out = slope(q, core.zeros(d), t), {}
    for i = 1, #lists.entries(g(q, t)) do
      out[i] = lists.part(J[i], N, d):totable()
      out[i][d + 1] = J[i][N + 2 * d + 1]
    end
    return out
  end
end

-- rows of (G, g_t) at (q, t)
local function slopes(system, n)
  if system.place then return slopes_on_group(system) end
  local given = system.given
  local g = bound(given.constraint, given.params)
  local J = core.derivative(function(q, t) return core.vector(lists.entries(g(q, t))) end, n,
    "number")
  return function(q, t)
    local out = {}
    for i, row in ipairs(J(q, t):totable()) do out[i] = row end
    return out
  end
end

--- |G v + g_t|^2, and |G|^2 |v|^2 to compare it with, as functions to be watched.
function M.hidden(system)
  local n = system.place and system.place.dimension or system.Q.dimension
  local rows = slopes(system, n)
  local function missed(q, v, t)
    local sum = 0
    for _, row in ipairs(rows(q, t)) do
      local rate = row[n + 1] or 0
      for k = 1, n do rate = rate + row[k] * v[k] end
      sum = sum + rate ^ 2
    end
    return sum
  end
  local function size(q, v, t)
    local sum = 0
    for _, row in ipairs(rows(q, t)) do
      for k = 1, n do sum = sum + row[k] ^ 2 end
    end
    return sum * v:dot(v)
  end
  return missed, size
end

return M
