--- The reference of a chart: two unlike methods that agree (dm.reference.engine), or a run that
-- was given.
local core = require "dm.core"
local engine = require "dm.reference.engine"
local fail = require "dm.base.options".failing "dm.chart"
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
  local steps = max(#chart.times, math.ceil(o.t / given.h / #chart.times) * #chart.times)
  local options = start_of(o)
  options.t0, options.at, options.watch = o.t0, chart.times, chart.watch
  return chart.system:solver({ rule = given.rule, h = o.t / steps }):run(options)
end

-- largest difference of two paths at the same times, relative to 1 + the largest entry
local function apart(a, b)
  local worst, size = 0, 1
  for _, name in ipairs(a.columns) do
    local x, y = a:column(name), b:column(name)
    for i = 1, #x do worst, size = worse(worst, abs(x[i] - y[i])), max(size, abs(x[i])) end
  end
  return worst / size, worst
end

local TRUSTED = 1e-7  -- two references further apart than this are none
local SECONDS = 4     -- of CPU, where the chart has none; else a part of those
local PART = 0.5
local ROUND_OFF = 4e-15

local function seconds_of(chart)
  local all = chart.options.seconds
  return all and PART * all or SECONDS
end

---- on groups, where steps are not controlled ----

local ON_GROUPS, HALVINGS = { "gauss(5)", "lie(5)", "lie(4)" }, 10

-- steps are halved until the path stops to change; the last, and how much it changed, or nil and
-- why not
local function refined(chart, rule)
  local last, change, h = nil, math.huge, chart.options.t / 32
  local ends = core.cpu() + seconds_of(chart) / 2
  for _ = 1, HALVINGS do
    local fine, path = pcall(given_run, chart, { rule = rule, h = h })
    if not fine then
      engine.pass_stop(path)
      if engine.is_refusal(engine.words(path)) then return nil, engine.words(path) end
    end
    local now = fine and last and apart(path, last) or math.huge
    if now > 0.5 * change and change < 1e-10 then break end
    last, change, h = fine and path or nil, now, h / 2
    if core.cpu() > ends or change < 1e-14 then break end
  end
  return last, change
end

-- the first two rules that can, as engine.find returns it
local function find_on_group(chart)
  local paths, rules, why = {}, {}, nil
  local except = measured(chart)
  for _, rule in ipairs(ON_GROUPS) do
    local path, reason = refined(chart, rule)
    why = why or reason
    if path and not except[rule] and #paths < 2 then
      paths[#paths + 1], rules[#rules + 1] = path, rule
    end
  end
  if #paths < 2 then return nil, tostring(why) end
  return { paths = paths, first = rules[1], rule = rules[2], distance = apart(paths[1], paths[2]) }
end

local function found_by_control(chart)
  local o = chart.options
  return engine.find { system = chart.system, start = start_of(o), t0 = o.t0, T = o.t,
    watch = chart.watch, at = chart.times, distance = apart, goal = 0, best = true,
    except = measured(chart), seconds = seconds_of(chart) }
end

--- The reference of a chart: path, what the methods differ by in the measured error, a sentence.
function M.find(chart)
  local o = chart.options
  if o.reference ~= nil then
    local given = o.reference
    if type(given) ~= "table" or not (given.rule and given.h) then
      fail("option 'reference' must be { rule =, h = }; left out, one is found (got %s)",
        tostring(given))
    end
    return given_run(chart, given), 0, ("reference: %s, h = %g, taken as given")
      :format(tostring(given.rule), given.h)
  end
  local own = chart.system.place
  local found, why = (own and find_on_group or found_by_control)(chart)
  if not found then
    fail("no rule could make a reference: %s", why or "does the run reach its end?")
  end
  if found.distance > TRUSTED then
    fail("the references %s and %s disagree by %.1e (relative): is the motion chaotic over this "
      .. "time? Take a shorter t, watch something less sensitive, or give "
      .. "reference = { rule =, h = }", found.first, found.rule, found.distance)
  end
  -- in what is measured
  local floor = chart.measure(found.paths[1], found.paths[2])
  return found.paths[2], floor + ROUND_OFF,
    ("references %s and %s, with %s steps, agree to %.1e"):format(found.first, found.rule,
      own and "halved" or "controlled", floor)
end

return M
