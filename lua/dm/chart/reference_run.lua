--- The reference of a chart: two unlike methods that agree (dm.reference.engine), or a run that
-- was given.
local blame = require "dm.base.blame"
local engine = require "dm.reference.engine"
local option = require "dm.base.options"
local fail = option.failing "dm.chart"
local worse = require "dm.chart.measures".worse

local M = {}

local abs, max = math.abs, math.max

-- the rules that are measured are no references
local function measured(chart)
  local out = {}
  for _, rule in ipairs(chart.options.rules) do out[tostring(rule):gsub("^rule ", "")] = true end
  return out
end

local function start_of(o) return { q = o.q, v = o.v, p = o.p } end

local function given_run(chart, given)
  local o = chart.options
  local parts = chart.dense and #chart.times or #chart.times - 1 -- the first is the start
  local steps = max(parts, math.ceil(o.t / given.h / parts) * parts)
  local options = start_of(o)
  options.t0, options.at, options.watch = o.t0, chart.times, chart.watch
  options.gaps = chart.watch and true
  return chart.system:solver({ rule = given.rule, h = o.t / steps }):run(options)
end

-- largest difference of two paths at the same times, relative to the largest entry, and itself
local function apart(a, b)
  local worst, size = 0, 0
  for _, name in ipairs(a.columns) do
    local x, y = a:column(name), b:column(name)
    for i = 1, #x do worst, size = worse(worst, abs(x[i] - y[i])), max(size, abs(x[i])) end
  end
  return size > 0 and worst / size or worst, worst
end

local TRUSTED = 1e-7  -- two references further apart than this are none
local SECONDS = 4     -- of CPU, where the chart has none; else a part of those
local PART = 0.5
local ROUND_OFF = 4e-15

local function seconds_of(chart)
  local all = chart.options.seconds
  return all and PART * all or SECONDS
end

local function find(chart)
  local o = chart.options
  return engine.find { system = chart.system, start = start_of(o), t0 = o.t0, T = o.t,
    watch = chart.watch, at = chart.times, distance = apart, goal = 0, best = true,
    except = measured(chart), seconds = seconds_of(chart) }
end

local LEAST = 1e-15  -- of the size of what is measured: errors below it are round-off

-- the unit of errors of what has this size: 1 where that is not known, or nothing moves
local function unit_of(size) return size and size > 0 and size < math.huge and size or 1 end

--- The floor of errors that need no reference, by a step of one of the rules.
function M.own_floor(chart)
  local o, size = chart.options, nil
  for _, entry in ipairs(chart.entries) do
    local fine = blame.try(function()
      local options = start_of(o)
      options.t0, options.steps, options.watch, options.gaps = o.t0, 1, chart.watch,
        chart.watch and true
      local solver = chart.system:solver { rule = entry.rule, h = o.h[#o.h] }
      size = select(2, chart.measure(solver:run(options)))
    end)
    if fine then break end
  end
  return LEAST * unit_of(size)
end

local SENSITIVE = "is the motion chaotic over this time? Take a shorter t, watch something less "
  .. "sensitive, or give reference = { rule =, h = }"
local HELD = "a control is held over every step, so that other steps make another motion. Give "
  .. "reference = { rule =, h = } with the step that is meant, or put what is continuous into "
  .. "'force'"

--- The reference of a chart: path, what the methods differ by in the measured error with what is
-- rounded, a sentence.
function M.find(chart)
  local o = chart.options
  if o.reference ~= nil then
    local given = o.reference
    if type(given) ~= "table" or not (given.rule and given.h) then
      fail("option 'reference' must be { rule =, h = }; left out, one is found (got %s)",
        tostring(given))
    end
    option.positive(given, "h", "dm.chart: reference", "a step")
    local path = given_run(chart, given)
    local _, size = chart.measure(path, path)
    return path, LEAST * unit_of(size), ("reference: %s, h = %g, taken as given")
      :format(tostring(given.rule), given.h)
  end
  local found, why = find(chart)
  if not found then
    fail("no rule could make a reference: %s", why or "does the run reach its end?")
  end
  if found.distance > TRUSTED then
    local given = chart.system.given
    fail("the references %s and %s disagree by %.1e (relative): %s", found.first, found.rule,
      found.distance, given and given.control and HELD or SENSITIVE)
  end
  -- in what is measured
  local floor, size = chart.measure(found.paths[1], found.paths[2])
  return found.paths[2], floor + ROUND_OFF * unit_of(size),
    ("references %s and %s, with controlled steps, agree to %.1e"):format(found.first, found.rule,
      floor)
end

return M
