--- How a chart is shown: a picture, a file of comma-separated values.
local blame = require "dm.base.blame"
local of_rule = require "dm.chart.orders".of_rule
local option = require "dm.base.options"

local fail = option.failing "dm.chart"

-- a rule with its order, where that is measurable
local function named(chart, rule)
  local order = chart:order(rule)
  return order and ("%s (order %.2f)"):format(rule, order) or rule
end

local doc_plot = [[
chart:plot{file=, against = "ns" | "evaluations" | "newton" | "steps" | "h", ...} -> file or nothing
Error over cost, both logarithmic, a line per rule with its measured order in the legend; without a
file in the terminal. Other options as in dm.plot.]]

local AGAINST = { ns = { "CPU time", "s", 1e-9 }, evaluations = { "evaluations", nil, 1 },
  newton = { "Newton iterations", nil, 1 }, steps = { "steps", nil, 1 }, h = { "h", nil, 1 } }

-- of errors: what it is filed under
local UNIT = { position = "q", energy = "energy", momentum = "p" }

-- the unit of the errors of a chart; positions that only turn are told by an angle
local function unit_of(chart)
  local place = chart.what == "position" and chart.system.place
  local body = place and place.kit.body
  return body and not body.moving and "rad" or (chart.system.units or {})[UNIT[chart.what]]
end

local draw = blame.caller(function(self, options)
  local given = option.copy(options, "chart:plot")
  local axis = AGAINST[given.against or "ns"]
  if not axis then
    fail('option \'against\' must be "ns", "evaluations", "newton", "steps" or "h" (got %s)',
      tostring(given.against))
  end
  local key, series = given.against or "ns", {}
  given.against = nil
  for _, rule in ipairs(self.rules) do
    local x, y = {}, {}
    for _, p in ipairs(of_rule(self, rule)) do
      if p.error > 0 and p[key] > 0 then x[#x + 1], y[#y + 1] = p[key] * axis[3], p.error end
    end
    if #x > 0 then
      series[#series + 1] = { x = x, y = y, name = named(self, rule), style = "linespoints" }
    end
  end
  if axis[1] == "h" then given.xunit = given.xunit or (self.system.units or {}).t end
  if self.rival and #series > 0 then
    local x, y = {}, {}
    for _, p in ipairs(self.rival.points) do
      if p.error > 0 and p[key] > 0 then x[#x + 1], y[#y + 1] = p[key] * axis[3], p.error end
    end
    if #x > 0 then
      series[#series + 1] = { x = x, y = y, name = self.rival.name .. ", preserves nothing",
        style = "linespoints", colour = "#888888" }
    end
  end
  if #series == 0 then
    fail("there is no point to draw: no error above 0 with %s above 0", axis[1])
  end
  given.log, given.xlabel, given.xunit = "xy", given.xlabel or axis[1], given.xunit or axis[2]
  local units = self.system.units or {}
  given.ylabel = given.ylabel or "error of " .. self.what
  given.yunit = given.yunit or unit_of(self)
  if given.file and not (given.size or given.width or given.height) then
    given.size = { 1000, 640 }
  end
  given.title = given.title or (self.system.name and self.system.name .. ": " or "")
    .. ("accuracy against cost, t = %.4g"):format(self.options.t)
    .. (units.t and " " .. units.t or "")
  return require "dm.show.plot".plot(series, given)
end)

local doc_csv = [[
chart:csv(file) -> file name   or   chart:csv() -> string
A line per point: rule, h, error, ns, setup, steps, evaluations, newton.]]

local csv = blame.caller(function(self, file)
  local lines = { "rule,h,error,ns,setup,steps,evaluations,newton" }
  for _, p in ipairs(self.points) do
    lines[#lines + 1] = ('"%s",%.17g,%.17g,%.17g,%.17g,%d,%d,%d')
      :format(p.rule, p.h, p.error, p.ns, p.setup, p.steps, p.evaluations, p.newton)
  end
  return require "dm.base.text_file".write(file, table.concat(lines, "\n") .. "\n", "chart:csv")
end)

return { plot = draw, csv = csv, doc_plot = doc_plot, doc_csv = doc_csv }
