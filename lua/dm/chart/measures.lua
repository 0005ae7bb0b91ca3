--- What the errors of a chart are of: positions, energies, momenta, constraints, observables.
local core = require "dm.core"
local option = require "dm.base.options"
local shift = require "dm.chart.shift"
local turn = require "dm.chart.turn"

local M = {}

local abs, max = math.abs, math.max

local fail = option.failing "dm.chart"

-- the larger one, NaN where one is
local function worse(worst, x) return (x ~= x or x > worst) and x or worst end

-- largest entry of |q - q_ref| over all samples, and of |q_ref|; of elements of a group their
-- distance, of rotations an angle
local function position_error(path, ref)
  local worst, size, system = 0, 0, path.system
  for i = 1, system.place and #path or 0 do
    worst = worse(worst, system.Q:distance(path.q[i], ref.q[i]))
  end
  if system.place then return worst end
  for i = 1, #path do
    local q, r = path.q[i], ref.q[i]
    for k = 1, #q do worst, size = worse(worst, abs(q[k] - r[k])), max(size, abs(r[k])) end
  end
  return worst, size
end

-- the largest change of one number along the path, and its size
local function change(values)
  local worst, size = 0, 0
  for i = 1, #values do
    worst, size = worse(worst, abs(values[i] - values[1])), max(size, abs(values[i]))
  end
  return worst, size
end

-- change of the momenta of coordinates that L does not depend on
local function cyclic_momenta(system)
  if system.place then
    fail("error = \"momentum\": on a group give the one whose momentum it is, error = dm.SO(3)")
  end
  local cyclic, names = {}, system.coordinates
  for _, name in ipairs(system:structure().cyclic) do
    for i = 1, system.Q.dimension do
      if name == (names and names[i] or "q" .. i) then cyclic[#cyclic + 1] = i end
    end
  end
  if #cyclic == 0 then
    fail("error = \"momentum\": L depends on every coordinate; give the group whose momentum it "
      .. "is, error = dm.SO(2), or { f }")
  end
  return function(path)
    local worst, size = 0, 0
    for _, k in ipairs(cyclic) do
      local err, of_it = change(path:column("p" .. k))
      worst, size = worse(worst, err), max(size, of_it)
    end
    return worst, size
  end
end

-- change of Noether's momentum of a group
local function group_momentum(group)
  return function(path)
    local J, worst, size = path:momentum(group), 0, 0
    for i = 1, #path do
      local now, first = J[i], J[1]
      if type(now) == "number" then now, first = { now }, { first } end
      for k = 1, #now do
        worst, size = worse(worst, abs(now[k] - first[k])), max(size, abs(now[k]))
      end
    end
    return worst, size
  end
end

local function constraint_error(system)
  local s = system:structure()
  local what = s.constraints > 0 and "constraint" or s.rolling > 0 and "rolling"
  if not what then fail("error = \"constraint\": the system has none") end
  return function(path) return path:worst(what) end
end

local function is_space(x)
  return type(x) == "userdata" and getmetatable(x) and getmetatable(x).__name == "dm.space"
end

-- ranges of columns; those that have none count for nothing
local function ranges_of(columns)
  local out = {}
  for k, list in ipairs(columns) do
    local least, most = math.huge, -math.huge
    for i = 1, #list do least, most = math.min(least, list[i]), math.max(most, list[i]) end
    out[k] = most > least and most - least or math.huge
  end
  return out
end

-- coordinates of a path as { t, columns }
local function columns_of(path, system)
  local out, names = { t = path.t, columns = {} }, system.coordinates
  for i = 1, system.Q.dimension do
    out.columns[i] = path:column(names and names[i] or "q" .. i)
  end
  return out
end

-- the largest shift in time, or turn by a group, along the run, against a reference with dense rows
local function shift_error(system, options, what)
  local fresh = what == "precession" and turn.of(system, options)
  return function(path, ref)
    local flow = columns_of(ref, system)
    flow.range = ranges_of(flow.columns)
    local about = fresh and fresh() or {}
    flow.turns, flow.turned, flow.angle = about.turns, about.turned, about.angle
    local found = shift.follow(columns_of(path, system), flow, ref.t[#ref])
    if not found then
      error("no shift in time explains this run: its motion is another one", 0)
    end
    if fresh then return found.largest_turn end
    return found.largest, options.t
  end
end

--- How a function that gives no number is told.
M.NO_NUMBER = "option 'error' must return"

local function numeric(f) return option.numeric(f, "option 'error'") end

--- measure(path, reference) -> error[, size of what it is of, where that has a unit]; its name,
-- whether a reference is needed, what is to be watched, and whether rows must be dense.
function M.make(system, what, options)
  what = what or "position"
  if what == "position" then return position_error, "position", true end
  if what == "energy" then
    local s = system:structure()
    if not s.autonomous or s.forced then
      fail("error = \"energy\": the energy of this system changes by itself (%s); give a function "
        .. "of (q, v, t, p), compared with the reference",
        s.forced and "forces" or "L depends on t")
    end
    return function(path) return change(path:energy()) end, "energy", false
  end
  if what == "momentum" then return cyclic_momenta(system), "momentum", false end
  if what == "phase" or what == "precession" then
    return shift_error(system, options, what), what, true, nil, true
  end
  if what == "constraint" then return constraint_error(system), "constraint", false end
  if is_space(what) then return group_momentum(what), "momentum of " .. tostring(what), false end
  if type(what) == "table" and type(what[1]) == "function" then
    return function(path) return change(path:column "watched") end, "change of what is watched",
      false, numeric(what[1])
  end
  if type(what) ~= "function" then
    fail("option 'error' must be \"position\", \"phase\", \"precession\", \"energy\", "
      .. "\"momentum\" or a group, \"constraint\", a function of (q, v, t, p) compared with the "
      .. "reference, or { f } for the change of f along the run (got %s)", tostring(what))
  end
  return function(path, ref)
    local worst, size, x, y = 0, 0, path:column "watched", ref:column "watched"
    for i = 1, #path do worst, size = worse(worst, abs(x[i] - y[i])), max(size, abs(y[i])) end
    return worst, size
  end, "what is watched", true, numeric(what)
end

--- How far what is compared with the reference reaches: the largest range of a coordinate, or that
-- of what is watched; nil where that is not compared, or nothing moves.
function M.reach(system, what, ref)
  local columns = what == "position" and not system.place and columns_of(ref, system).columns
    or what == "what is watched" and { ref:column "watched" }
  local most = 0
  for _, range in ipairs(columns and ranges_of(columns) or {}) do
    if range < math.huge then most = max(most, range) end
  end
  return most > 0 and most or nil
end

--- The rules of a chart with the tolerances of Newton's method: { rule, name, newton }.
function M.entries(rules, tolerances, name)
  local explicit = {}
  for _, row in ipairs(core.rules()) do explicit[row.name] = row.explicit end
  local out, seen = {}, {}
  if type(tolerances) == "number" then tolerances = { tolerances } end
  local function check(fine)
    if not fine then fail("option 'tolerances' must hold numbers between 0 and 1") end
  end
  check(tolerances == nil or type(tolerances) == "table")
  for _, rule in ipairs(rules) do
    if seen[name(rule)] then fail("rule '%s' is given twice", name(rule)) end
    seen[name(rule)], out[#out + 1] = true, { rule = rule, name = name(rule) }
    for _, tolerance in ipairs(not explicit[name(rule):match "^[%w_-]+"] and tolerances or {}) do
      check(type(tolerance) == "number" and tolerance > 0 and tolerance < 1)
      out[#out + 1] = { rule = rule, name = ("%s, Newton to %.0e"):format(name(rule), tolerance),
        newton = { tolerance = tolerance } }
    end
  end
  return out
end

--- The rule that preserves nothing, which every chart is measured against where it has none; nil
-- where it cannot step the system.
function M.rival(system, rules, name)
  local symplectic = {}
  for _, row in ipairs(core.rules()) do symplectic[row.name] = row.symplectic end
  for _, rule in ipairs(rules) do
    if symplectic[name(rule):match "^[%w_-]+"] == false then return nil end
  end
  if system:structure().linear_in_v then return nil end
  return { rule = "rk8", name = "rk8" }
end

M.worse = worse

return M
