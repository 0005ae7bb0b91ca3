--- The orders that a chart measures, and the cheapest of its points.
local blame = require "dm.base.blame"

local abs, max, log = math.abs, math.max, math.log

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
chart:order([rule]) -> number   or   nil, sentence
The measured order of a rule, of the only one where none is named: the slope of ln error over ln h,
least squares over the finest steps whose error is well above (30 times) what the references differ
by, above the rule's own round-off where finer steps have larger errors, and below 0.3 of the range
of the motion, as far as the slopes between neighbours agree to a tenth or 0.4. nil, and why, with
fewer than three such steps ("not measurable", or "not asymptotic" where they are too coarse), or
where slopes do not agree ("not asymptotic").]]

-- where errors of a rule grow again with finer steps its own round-off is what is seen there
local function round_off(points)
  local best = 1
  for i, p in ipairs(points) do
    if p.error <= points[best].error then best = i end
  end
  return points[best] and best < #points and points[best].error or 0
end

-- the finest steps above round-off, not as far off as the motion reaches, from the finest, each
-- once
local function finest(points, floor_)
  local used = {}
  for i = #points, 1, -1 do
    local p = points[i]
    if p.error > floor_ and not p.below and not p.far and (#used == 0 or p.h > used[#used].h) then
      used[#used + 1] = p
    end
  end
  return used
end

-- slopes between neighbours
local function slopes_of(used)
  local out = {}
  for i = 1, #used - 1 do
    out[i] = log(used[i + 1].error / used[i].error) / log(used[i + 1].h / used[i].h)
  end
  return out
end

local MOST = 4 -- points: what is finest is nearest to the limit

-- The first and the last of the points, at most MOST, whose slopes agree with the first of them;
-- what is finer than these may be bent by round-off. Nothing where no two slopes agree.
local function agreeing(slopes)
  for first = 1, #slopes - 1 do
    local last, near = first, max(0.4, 0.1 * abs(slopes[first]))
    while slopes[last + 1] and last - first < MOST - 2
      and abs(slopes[last + 1] - slopes[first]) <= near do
      last = last + 1
    end
    if last > first then return first, last + 1 end
  end
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

local COUNTS = { [0] = "no step", "one step", "two steps" }

local function order_of(chart, rule)
  if type(rule) ~= "string" and rule ~= nil then rule = tostring(rule):gsub("^rule ", "") end
  if rule == nil and #chart.rules == 1 then rule = chart.rules[1] end
  if rule == nil then
    fail("chart:order takes the rule whose order is asked for: %s", table.concat(chart.rules, ", "))
  end
  if not find_name(chart.rules, rule) then
    fail("no point of rule '%s'; there are %s", tostring(rule), table.concat(chart.rules, ", "))
  end
  local points = of_rule(chart, rule)
  if #points < 2 then
    return nil, ("not measurable: %s of %s gave an error; at least two are needed")
      :format(#points == 0 and "no step" or "one step", rule)
  end
  local floor_ = 30 * max(chart.floor, round_off(points))
  local used = finest(points, floor_)
  local slopes = slopes_of(used)
  local first, last = agreeing(slopes)
  if first then return slope_of(table.move(used, first, last, 1, {})) end
  if #used < 3 then
    if points[1].far then
      return nil, ("not asymptotic: at %s of %s is the error below 0.3 of the range of the motion, "
        .. "and well above round-off, and three are needed; finer steps may show an order")
        :format(COUNTS[#used], rule)
    end
    return nil, ("not measurable: at %s of %s is the error above %.1e, which is 30 times round-off "
      .. "or what the references differ by, and three are needed; coarser steps show more")
      :format(COUNTS[#used], rule, floor_)
  end
  for i, slope in ipairs(slopes) do slopes[i] = ("%.2f"):format(slope) end
  return nil, ("not asymptotic: the slopes between successive steps of %s, from the finest, are "
    .. "%s; finer steps may show an order"):format(rule, table.concat(slopes, ", "))
end

-- the point of least time whose error is at most that
local function cheapest(points, target)
  if type(target) ~= "number" then
    fail("chart:cheapest takes an error, a number such as 1e-6 (got %s)", type(target))
  end
  local best
  for _, p in ipairs(points) do
    if p.error <= target and (not best or p.ns < best.ns) then best = p end
  end
  return best
end

return { order = blame.caller(order_of), doc = doc_order, of_rule = of_rule, cheapest = cheapest }
