--- A chart as text: a line for every rule, the cheapest, what failed and what was left out.
local core = require "dm.core"
local orders = require "dm.chart.orders"

local function number(x) return x and ("%.2f"):format(x) or "-" end

-- an error that is below what can be measured is told as that
local function error_text(p) return (p.below and "below %.0e" or "%.1e"):format(p.error) end

local TIMES = { { 1e3, 1, "ns" }, { 1e6, 1e3, "us" }, { 1e9, 1e6, "ms" }, { math.huge, 1e9, "s" } }

local function time_text(ns)
  for _, unit in ipairs(TIMES) do
    if ns < unit[1] then return ("%.3g %s"):format(ns / unit[2], unit[3]) end
  end
end

local function is_symplectic(rule)
  for _, row in ipairs(core.rules()) do
    if row.name == rule:match "^[%w_-]+" then return row.symplectic end
  end
  return true
end

-- "cheapest at 1e-08: gauss(4), 1.2 ms"; says so when a non-geometric rule wins
local function cheapest_lines(chart, lines)
  for _, target in ipairs { 1e-4, 1e-8, 1e-12 } do
    local p = chart:cheapest(target)
    local text = ("none of these reaches %.0e"):format(target)
    if p then
      text = ("cheapest at %.0e: %s, h = %.4g, %s%s"):format(target, p.rule, p.h, time_text(p.ns),
        is_symplectic(p.rule) and "" or " (not symplectic)")
    end
    local r = chart.rival and orders.cheapest(chart.rival.points, target)
    if r and (not p or r.ns < p.ns) then
      text = text .. ("; %s, which preserves nothing, wins with %s"):format(r.rule, time_text(r.ns))
    elseif r then
      text = text .. ("; %s, which preserves nothing, takes %.3g times as long")
        :format(r.rule, r.ns / p.ns)
    end
    lines[#lines + 1] = text
  end
end

local function front_line(chart)
  local out, seen = {}, {}
  for _, p in ipairs(chart:pareto()) do
    if not seen[p.rule] then out[#out + 1], seen[p.rule] = p.rule, true end
  end
  return "front of error and time, from the cheapest: " .. table.concat(out, ", ")
end

local function table_of(chart)
  local head = { "rule", "order", "points", "least error", "for" }
  local lines = { ("%-28s %6s %7s %11s %10s"):format(table.unpack(head)) }
  for _, rule in ipairs(chart.rules) do
    local points, least = orders.of_rule(chart, rule), nil
    for _, p in ipairs(points) do least = (not least or p.error < least.error) and p or least end
    lines[#lines + 1] = least and ("%-28s %6s %7d %11s %10s")
      :format(rule, number((chart:order(rule))), #points, error_text(least), time_text(least.ns))
      or ("%-28s %6s %7d %11s %10s"):format(rule, "-", 0, "-", "-")
  end
  cheapest_lines(chart, lines)
  lines[#lines + 1] = front_line(chart)
  for _, f in ipairs(chart.failures) do
    lines[#lines + 1] = ("%s, h = %.4g%s: %s"):format(f.rule, f.h,
      f.count > 1 and (" and %d more"):format(f.count - 1) or "", f.why)
  end
  lines[#lines + 1] = chart.reference_text
  if chart.cut then lines[#lines + 1] = chart.cut end
  lines[#lines + 1] = ("load %.2f at the start, median of %d batches, CPU time with set-up")
    :format(chart.load, chart.batches)
  return table.concat(lines, "\n")
end

local doc_table = [[
chart:table() -> string
A line per rule: measured order, number of points, least error and its cost; then the cheapest at
1e-4, 1e-8, 1e-12 beside the rival, the rules on the front, what failed and why, how far the two
references are apart, and the load of the machine when it was measured.]]

return { table = table_of, doc = doc_table }
