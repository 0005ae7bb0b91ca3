--- dm.chart of a field as a function of its size: errors at the end of a run over the width of a
-- cell, against a formula or the finest of the sizes.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local ends = require "dm.chart.size_ends"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.chart"
local fail = option.failing(WHERE)

local log, max, sqrt = math.log, math.max, math.sqrt

local Chart = core.class({ __name = "dm.field_chart" }, [[
dm.field_chart: errors of a field over its size, made by dm.chart{system = function(N) ... end,
N = {...}, ...}
fields: points (a list of {rule, size, width (of a cell), h, steps, error, ns}), rules (names),
failures (what could not be run, and why), name (of the size), against]])

---- options ----

local KNOWN = { 1, "system", "rule", "rules", "h", "t", "t0", "exact", "error", "component", "q",
  "v", "p", "u", "ut", "z", "vorticity" }
local STARTS = { "q", "v", "p", "u", "ut", "z", "vorticity" }

-- the option that no other is: the sizes, and its name
local function read_sizes(options)
  local known, name = {}, nil
  for _, key in ipairs(KNOWN) do known[key] = true end
  for key in pairs(options) do
    if not known[key] then
      if name or type(key) ~= "string" then
        fail("of a system that is a function of its size one option more names the sizes, N = {8, "
          .. "16, 32} (got '%s'%s)", tostring(key), name and (" and '%s'"):format(name) or "")
      end
      name = key
    end
  end
  if not name then
    fail("of a system that is a function of its size the sizes are missing: N = {8, 16, 32}")
  end
  local sizes, list = {}, options[name]
  for i = 1, type(list) == "table" and #list or 0 do
    sizes[i] = lists.whole(list[i])
    if not sizes[i] or i > 1 and sizes[i] <= sizes[i - 1] then
      fail("option '%s' must be a list of whole numbers that grow (entry %d is %s)", name, i,
        tostring(list[i]))
    end
  end
  if #sizes < 2 then fail("option '%s' must list two sizes at least, such as {8, 16, 32}", name) end
  return name, sizes
end

local function read_rules(options, field)
  local list = options.rules or options.rule
  if options.rules and options.rule then fail("give 'rule' or 'rules', not both") end
  if list == nil then
    if option.got(field) == "dm.system" then
      fail("the rule is missing: rule = \"verlet\", or rules = { ... }")
    end
    return { false }
  end
  return type(list) == "table" and #list > 0 and list or { list }
end

-- step of size number i
local function step_of(options, sizes, i)
  local h = options.h
  if type(h) == "table" then h = h[i] end
  if type(h) == "function" then h = core.one(h, "h")(sizes[i]) end
  if type(h) ~= "number" or not (h > 0 and h < math.huge) then
    fail("option 'h' must be a step > 0, a list with one for each size, or a function of the size "
      .. "(got %s at size %d)", option.got(h), sizes[i])
  end
  return h
end

---- a point ----

-- the field of a size, and its kind
local function field_of(options, size)
  local field = core.one(options.system or options[1], "system")(size)
  local kind = ends.kind(field)
  if not kind then
    fail("'system' must return a field (K:field, dm.field, K:euler, dm.multisymplectic; got %s)",
      option.got(field))
  end
  return field, kind
end

local function start_of(options, kind)
  local start, takes = { t0 = options.t0 }, {}
  for _, key in ipairs(kind.keys) do takes[key], start[key] = true, options[key] end
  for _, key in ipairs(STARTS) do
    if options[key] ~= nil and not takes[key] then
      fail("the start of such a field is %s, not '%s'", table.concat(kind.keys, ", "), key)
    end
  end
  return start
end

-- { field, kind, values, point }
local function measure(chart, rule, i)
  local options = chart.options
  local field, kind = field_of(options, chart.sizes[i])
  local steps = max(1, math.floor(options.t / step_of(options, chart.sizes, i) + 0.5))
  local h, start = options.t / steps, start_of(options, kind)
  local solver = field:solver { rule = rule or nil, h = h }
  start.steps, start.every = steps, steps
  local began = core.cpu()
  local run = solver:run(start)
  return { field = field, kind = kind, values = kind.values(field, run, options.component),
    point = { rule = tostring(rule or solver.rule or "box"), size = chart.sizes[i],
      width = kind.width(field), h = h, steps = steps, ns = 1e9 * (core.cpu() - began) } }
end

-- relative in the norm of the field, or the largest difference
local function error_of(chart, one, reference)
  local options, values = chart.options, one.values
  local exact = options.exact
    and one.kind.exact(one.field, options.exact, (options.t0 or 0) + options.t)
    or one.kind.from(one.field, reference.field, reference.values)
  local off, size, largest, weights = 0, 0, 0, one.kind.weights(one.field)
  for k = 1, #values do
    local d = values[k] - exact[k]
    off, size, largest = off + weights[k] * d * d, size + weights[k] * exact[k] ^ 2,
      max(largest, math.abs(d))
  end
  if options.error == "largest" then return largest end
  if not (size > 0) then
    fail("the field that is compared with vanishes at the end: error = \"largest\" takes the "
      .. "largest difference")
  end
  return sqrt(off / size)
end

-- a point, or why there is none; what stops it goes on
local function try(chart, rule, i)
  local fine, one = blame.try(measure, chart, rule, i)
  if fine then return one end
  if type(one) == "string" then error(one, 0) end -- what is asked for is wrong
  chart.failures[#chart.failures + 1] = { rule = tostring(rule or ""), size = chart.sizes[i],
    why = tostring(one):match "^[^\n]*" }
end

local function of_rule(chart, rule)
  local last = #chart.sizes
  local reference
  if not chart.options.exact then
    reference = try(chart, rule, last)
    if not reference then return end
    last = last - 1
  end
  for i = 1, last do
    local one = try(chart, rule, i)
    if one then
      one.point.error = error_of(chart, one, reference)
      chart.points[#chart.points + 1] = core.result(one.point)
    end
  end
end

---- what it tells ----

local function points_of(chart, rule)
  local out = {}
  for _, p in ipairs(chart.points) do
    if rule == nil or p.rule == rule then out[#out + 1] = p end
  end
  if #out == 0 then
    fail("no point of rule '%s'; there are %s", tostring(rule), table.concat(chart.rules, ", "))
  end
  return out
end

class.method("dm.field_chart", "order", function(chart, rule)
  local points = points_of(chart, rule or chart.rules[1])
  local n = #points
  local a, b = points[n - 1], points[n]
  if not a or not (a.error > 0 and b.error > 0) then
    return nil, "two sizes with errors above 0 are needed"
  end
  return log(a.error / b.error) / log(a.width / b.width)
end, [[
chart:order([rule]) -> number   or   nil, sentence
The slope of ln error over ln width of a cell, between the two finest sizes of a rule (default: the
first).]])

local function table_of(chart)
  local lines = { ("%-16s %8s %10s %10s %11s %7s %9s"):format("rule", chart.name, "width", "h",
    "error", "order", "CPU time") }
  local last
  for _, p in ipairs(chart.points) do
    local order = last and last.rule == p.rule and last.error > 0 and p.error > 0
      and ("%.2f"):format(log(last.error / p.error) / log(last.width / p.width)) or ""
    lines[#lines + 1] = ("%-16s %8d %10.4g %10.4g %11.4e %7s %7.3g s"):format(p.rule, p.size,
      p.width, p.h, p.error, order, p.ns / 1e9)
    last = p
  end
  for _, f in ipairs(chart.failures) do
    lines[#lines + 1] = ("%s, %s = %d: %s"):format(f.rule, chart.name, f.size, f.why)
  end
  return table.concat(lines, "\n")
end

class.method("dm.field_chart", "table", table_of, [[
chart:table() -> string
A line for every size of every rule: width of a cell, step, error, order from the size before, CPU
time; then what failed.]])

function Chart:__len() return #self.points end

function Chart:__tostring()
  return ("errors of a field over its size at t = %g, %s, against %s\n"):format(self.options.t,
    self.what, self.against) .. table_of(self)
end

local AGAINST = { width = { "width of a cell", 1 }, ns = { "CPU time (s)", 1e-9 },
  h = { "h", 1 } }

class.method("dm.field_chart", "plot", function(chart, options)
  local given, series = option.copy(options, "chart:plot"), {}
  local key = option.one_of(given, "against", "chart:plot", { "width", "ns", "h" }) or "width"
  given.against = nil
  for _, rule in ipairs(chart.rules) do
    local x, y = {}, {}
    for _, p in ipairs(chart.points) do
      if p.rule == rule and p.error > 0 then
        x[#x + 1], y[#y + 1] = p[key] * AGAINST[key][2], p.error
      end
    end
    if #x > 0 then series[#series + 1] = { x = x, y = y, name = rule, style = "linespoints" } end
  end
  if #series == 0 then option.fail("chart:plot", "there is no error above 0 to draw") end
  given.log, given.xlabel = "xy", given.xlabel or AGAINST[key][1]
  given.ylabel = given.ylabel or chart.what
  given.title = given.title or ("errors over size, t = %.4g"):format(chart.options.t)
  return require "dm.show.plot".plot(series, given)
end, [[
chart:plot{file=, against = "width" | "ns" | "h", ...} -> file or nothing
Errors over the width of a cell (or CPU time, or the step), both logarithmic, a line per rule.
Other options as in dm.plot.]])

class.method("dm.field_chart", "csv", function(chart, file)
  local lines = { "rule,size,width,h,steps,error,ns" }
  for _, p in ipairs(chart.points) do
    lines[#lines + 1] = ('"%s",%d,%.17g,%.17g,%d,%.17g,%.17g'):format(p.rule, p.size, p.width, p.h,
      p.steps, p.error, p.ns)
  end
  return require "dm.base.text_file".write(file, table.concat(lines, "\n") .. "\n", "chart:csv")
end, [[
chart:csv(file) -> file name   or   chart:csv() -> string
A line per point: rule, size, width, h, steps, error, ns.]])

---- making one ----

local OF_ONE_SIZE = { ["dm.line_field"] = "a field on a line", ["dm.boxes"] = "boxes",
  ["dm.euler"] = "a flow" }

--- Is the system of these options a function of its size? Raises where it is of one size and its
-- errors are those of the size.
function M.is_meant(options)
  local system = type(options) == "table" and (options.system or options[1])
  local what = OF_ONE_SIZE[option.got(system)]
  if what then
    fail("%s is charted over its size: give system = function(N) that returns it, and N = { 8, 16, "
      .. "32 }", what)
  end
  return type(system) == "function"
end

--- The chart of options.
function M.chart(options)
  local name, sizes = read_sizes(options)
  option.need(options, "t", WHERE, "a duration > 0")
  option.positive(options, "t", WHERE, "a duration")
  option.number(options, "t0", WHERE)
  option.need(options, "h", WHERE, "a step, a list with one for each size, or a function of it")
  option.callable(options, "exact", WHERE, "(x, ..., t)")
  option.text(options, "component", WHERE)
  local what = option.one_of(options, "error", WHERE, { "norm", "largest" }) or "norm"
  if not options.exact and #sizes < 3 then
    fail("without 'exact' the finest size is compared with, so that three are needed")
  end
  local chart = setmetatable({ options = options, name = name, sizes = sizes, points = {},
    rules = {}, failures = {},
    what = what == "norm" and "relative error in the norm" or "largest error",
    against = options.exact and "a formula" or ("%s = %d"):format(name, sizes[#sizes]) }, Chart)
  for i in ipairs(sizes) do step_of(options, sizes, i) end
  for _, rule in ipairs(read_rules(options, (field_of(options, sizes[1])))) do
    local before = #chart.points
    of_rule(chart, rule)
    local first = chart.points[before + 1]
    chart.rules[#chart.rules + 1] = first and first.rule or tostring(rule or "")
  end
  return chart
end

return M
