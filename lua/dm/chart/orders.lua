--- The orders that a chart measures.
local blame = require "dm.base.blame"

local max, log = math.max, math.log

local fail = require "dm.base.options".failing "dm.chart"

-- the points of a rule, from the coarsest step
local function of_rule(chart, rule)
  local out = {}
  for _, p in ipairs(chart.points) do
    if p.rule == rule then out[#out + 1] = p end
  end
  table.sort(out, function(a, b) return a.h > b.h end)
  return out
end

local doc_order = [[
chart:order(rule) -> number   or   nil, sentence
The measured order of a rule: the slope of ln error over ln h, least squares over the four finest
steps whose error is well above (30 times) what the references differ by, and above the rule's own
round-off where finer steps have larger errors. nil, and why, with fewer than two such steps.
Coarse steps may lie before the limit where the order shows.]]

-- where errors of a rule grow again with finer steps its own round-off is what is seen there
local function round_off(points)
  local best = 1
  for i, p in ipairs(points) do
    if p.error <= points[best].error then best = i end
  end
  return points[best] and best < #points and points[best].error or 0
end

-- the finest steps above round-off, at most four, are nearest to the limit
local function finest(points, floor_)
  local used, sizes, last = {}, 0, nil
  for i = #points, 1, -1 do
    local p = points[i]
    if p.error > floor_ and #used < 4 then
      used[#used + 1], sizes, last = p, sizes + (p.h ~= last and 1 or 0), p.h
    end
  end
  return used, sizes
end

local function slope_of(points)
  local n, sx, sy, sxx, sxy = #points, 0, 0, 0, 0
  for _, p in ipairs(points) do
    local x, y = log(p.h), log(p.error)
    sx, sy, sxx, sxy = sx + x, sy + y, sxx + x * x, sxy + x * y
  end
  return (n * sxy - sx * sy) / (n * sxx - sx * sx)
end

local function find_name(names, wanted)
  for _, name in ipairs(names) do
    if name == wanted then return name end
  end
end

local function order_of(chart, rule)
  if type(rule) ~= "string" and rule ~= nil then rule = tostring(rule):gsub("^rule ", "") end
  if not find_name(chart.rules, rule) then
    fail("no point of rule '%s'; there are %s", tostring(rule), table.concat(chart.rules, ", "))
  end
  local points = of_rule(chart, rule)
  if #points < 2 then
    return nil, ("not measurable: %s of %s gave an error; at least two are needed")
      :format(#points == 0 and "no step" or "one step", rule)
  end
  local floor_ = 30 * max(chart.floor, round_off(points))
  local used, sizes = finest(points, floor_)
  if sizes > 1 then return slope_of(used) end
  return nil, ("not measurable: at %s step of %s is the error above %.1e, which is 30 times "
    .. "round-off or what the references differ by; coarser steps show more")
    :format(sizes == 0 and "no" or "only one", rule, floor_)
end

return { order = blame.caller(order_of), doc = doc_order, of_rule = of_rule }
