-- charts.lua FOLDER FILE ... - the gallery of work-precision charts: for every file of tests/bench/gallery one picture
-- FOLDER/images/chart-NAME.png, and the page FOLDER/charts.md. A file returns { title =, text =, { system, q =, v =, t =, rules =, h =,
-- error =, suffix = }, ... }: options of dm.chart; several are drawn in one picture, the rules of a later one with its suffix.
local dm = require "dm"
local folder, files = arg[1], { table.unpack(arg, 2) }

local REPEATS = 3  -- batches that the median is taken of

-- one chart of several: the points of all, the rules of later ones by name and suffix
local function joined(entry)
  local all
  for _, options in ipairs(entry) do
    local suffix = options.suffix and " " .. options.suffix or ""
    options.suffix, options.repeats = nil, REPEATS
    local chart = dm.chart(options)
    for _, list in ipairs { chart.points, chart.failures } do
      for _, point in ipairs(list) do point.rule = point.rule .. suffix end
    end
    for i, rule in ipairs(chart.rules) do chart.rules[i] = rule .. suffix end
    if all then
      table.move(chart.points, 1, #chart.points, #all.points + 1, all.points)
      table.move(chart.failures, 1, #chart.failures, #all.failures + 1, all.failures)
      table.move(chart.rules, 1, #chart.rules, #all.rules + 1, all.rules)
      all.floor = math.max(all.floor, chart.floor)
      all.reference_text = all.reference_text .. "; " .. chart.reference_text
    else
      all = chart
    end
  end
  return all
end

local NOT_GEOMETRIC = { rk4 = true, rkf45 = true, rk8pd = true, rk8 = true }

local function time_text(ns)
  if ns < 1e6 then return ("%.3g µs"):format(ns / 1e3) end
  return ns < 1e9 and ("%.3g ms"):format(ns / 1e6) or ("%.3g s"):format(ns / 1e9)
end

-- the table of the page: cheapest at three accuracies, and the best rule that preserves nothing there
local function winners(chart)
  local lines = { "| error at most | cheapest | h | time | best that preserves nothing |", "|---|---|---|---|---|" }
  for _, target in ipairs { 1e-2, 1e-4, 1e-6, 1e-8, 1e-10 } do
    local best, rival
    for _, p in ipairs(chart.points) do
      if p.error <= target then
        if not best or p.ns < best.ns then best = p end
        if NOT_GEOMETRIC[p.rule:match "^[%w-]+"] and (not rival or p.ns < rival.ns) then rival = p end
      end
    end
    if best then
      lines[#lines + 1] = ("| %.0e | %s | %.4g | %s | %s |"):format(target, best.rule, best.h, time_text(best.ns),
        rival == best and "**it wins**" or rival and ("%s, %.1f times the time"):format(rival.rule, rival.ns / best.ns) or "none reaches it")
    end
  end
  return table.concat(lines, "\n")
end

local page = { [[
# Work-precision charts

For every system of the [examples](examples.md): what an accuracy costs, rule by rule. `make charts` measures them all again and writes this page and its
pictures. Error is the largest difference of a coordinate from the reference over 32 times of the run (or of what is named), cost is CPU time of a
whole run, set-up included, on one core: the median of ]] .. REPEATS .. [[ batches, each the best of its runs. The reference is two unlike methods, refined until they agree.
Methods that preserve nothing (rk4, rk8) are in every chart, through the same kernels as the rest, and where they win the table says so. Times are of the machine
that measured them; ratios tell more. What a chart of minutes does not show is what the structure is for: over long times the error of a rule that drifts grows
faster (see [the examples](examples.md) and `dmlua --demo symplectic`).]] }

for _, file in ipairs(files) do
  local name, start = file:match "([%w_]+)%.lua$", dm.clock()
  local entry = dofile(file)
  local chart = joined(entry)
  chart:plot { file = ("%s/images/chart-%s.png"):format(folder, name), title = entry.title }
  page[#page + 1] = ("## %s\n\n![%s](images/chart-%s.png)\n\n%s\n\n%s\n\n%s. Load of the machine meanwhile: %.1f."):format(entry.title, entry.title, name, entry.text, winners(chart),
    (chart.reference_text:gsub("^%l", string.upper)), dm.load_average())
  print(("%-28s %4d points, %2d failed, %5.1f s"):format(name, #chart.points, #chart.failures, dm.clock() - start))
end

local handle = assert(io.open(folder .. "/charts.md", "w"))
handle:write(table.concat(page, "\n\n"), "\n")
handle:close()
