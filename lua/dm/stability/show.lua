--- How a stability map is told: a sentence, a table, a picture, a file of comma-separated values.
local blame = require "dm.base.blame"
local axes = require "dm.stability.axes"
local cells = require "dm.stability.cells"
local characters = require "dm.show.characters"
local class = require "dm.base.class"
local option = require "dm.base.options"
local palette = require "dm.show.palette"

-- how many cells there are of each class
local function counts(map)
  local out = {}
  for _, row in ipairs(map.cells) do
    for _, cell in ipairs(row) do out[cell.class] = (out[cell.class] or 0) + 1 end
  end
  return out
end

local function counted(map)
  local count, text = counts(map), {}
  for i, class in ipairs(cells.CLASSES) do
    if count[i] then text[#text + 1] = ("%d %s"):format(count[i], class.name) end
  end
  return table.concat(text, ", ")
end

local function row_text(map, row)
  local text = {}
  if #map.rules > 1 or #map.row_axes == 0 then text[1] = row.rule end
  for _, axis in ipairs(map.row_axes) do
    text[#text + 1] = ("%s = %.5g"):format(axis.name, row.values[axis.name])
  end
  return table.concat(text, ", ")
end

local function limit_text(x)
  if not x then return "not run" end
  if x == math.huge then return "none" end
  if x == -math.huge then return "all lost" end
  return ("%.5g"):format(x)
end

local function table_of(map, most)
  most = option.whole({ most = most }, "most", "map:table", 1, nil, 40)
  local lines = { ("%-34s %12s %12s  %s"):format("row", "limit of " .. map.column.name, "theory",
    "beyond") }
  local n = #map.rows
  for k = 1, math.min(n, most) do
    local i = n <= most and k or 1 + (k - 1) * (n - 1) // math.max(most - 1, 1)
    local limit, why = map:limit(i)
    local fine, theory -- takes seconds along long orbits: none beside a row that was not run
    if limit then fine, theory = blame.try(map.theory, map, i) end
    lines[#lines + 1] = ("%-34s %12s %12s  %s")
      :format(row_text(map, map.rows[i]), limit_text(limit),
      fine and theory and limit_text(theory) or "-", why)
  end
  if n > most then lines[#lines + 1] = ("(%d of %d rows)"):format(most, n) end
  return table.concat(lines, "\n")
end

local function sentence(map)
  local size = {}
  for _, axis in ipairs(map.row_axes) do size[#size + 1] = ("%d %s"):format(#axis, axis.name) end
  size[#size + 1] = ("%d %s"):format(#map.column, map.column.name)
  local o = map.options
  return ("stability map of %s over %s, %s: %s")
    :format(table.concat(map.rules, ", "), table.concat(size, " x "),
    o.steps and ("%d step%s"):format(o.steps, o.steps == 1 and "" or "s") or ("t = %g"):format(o.t),
    counted(map))
end

---- csv ----

local EVIDENCE = { "steps", "error", "slope", "slope_error", "growth", "exponent", "megno", "off",
  "range", "hidden" }

local function csv(map, file)
  local head = { "rule" }
  for _, name in ipairs(map.names) do
    head[#head + 1] = name:find '[,"%c]' and '"' .. name:gsub('"', '""') .. '"' or name
  end
  local lines = { table.concat(head, ",") .. ",h,class," .. table.concat(EVIDENCE, ",") }
  for _, row in ipairs(map.cells) do
    for _, cell in ipairs(row) do
      local out = { ('"%s"'):format(map.rules[cell.rule]) }
      for _, name in ipairs(map.names) do out[#out + 1] = ("%.17g"):format(cell.values[name]) end
      out[#out + 1], out[#out + 2] = ("%.17g"):format(cell.h), cells.CLASSES[cell.class].name
      for _, name in ipairs(EVIDENCE) do
        out[#out + 1] = cell[name] and ("%.17g"):format(cell[name]) or ""
      end
      lines[#lines + 1] = table.concat(out, ",")
    end
  end
  return require "dm.base.text_file".write(file, table.concat(lines, "\n") .. "\n", "map:csv")
end

---- picture ----

-- rows that belong to one panel, by rule and by all parameters but the one along x
local function panels_of(map)
  local along, out, by_key = map.row_axes[#map.row_axes], {}, {}
  for i, row in ipairs(map.rows) do
    local key = row.rule
    for k = 1, #map.row_axes - 1 do
      key = ("%s, %s = %.4g"):format(key, map.row_axes[k].name, row.values[map.row_axes[k].name])
    end
    if not by_key[key] then
      by_key[key] = { title = key, rows = {} }
      out[#out + 1] = by_key[key]
    end
    table.insert(by_key[key].rows, i)
  end
  return out, along
end

-- rectangles of the classes: neighbours of one class in a row are one
local function rectangles(map, panel, along)
  local by_class = {}
  for x, i in ipairs(panel.rows) do
    local row, j = map.cells[i], 1
    while j <= #row do
      local last = j
      while row[last + 1] and row[last + 1].class == row[j].class do last = last + 1 end
      local box = by_class[row[j].class] or { x = {}, y = {}, xlow = {}, xhigh = {}, ylow = {},
        yhigh = {} }
      by_class[row[j].class] = box
      local n = #box.x + 1
      box.x[n], box.y[n] = along and along[x] or 1, axes.between(map.column, row[j].x, row[last].x,
        0.5)
      if along then
        box.xlow[n], box.xhigh[n] = axes.edges(along, x)
      else
        box.xlow[n], box.xhigh[n] = 0.5, 1.5
      end
      box.ylow[n], box.yhigh[n] = axes.edges(map.column, j), select(2, axes.edges(map.column, last))
      j = last + 1
    end
  end
  return by_class
end

local function line_of(map, panel, along, what)
  local x, y, lo, hi = {}, {}, (axes.edges(map.column, 1)),
    select(2, axes.edges(map.column, #map.column))
  for k, i in ipairs(panel.rows) do
    local fine, value = blame.try(map[what == "right" and "limit" or what], map, i, what == "right"
      and "right" or nil)
    if fine and value and value >= lo and value <= hi then
      x[#x + 1], y[#y + 1] = along and along[k] or 1, value
    end
  end
  return x, y
end

local MOST_MARKED = 64  -- rows whose resonances are drawn

-- steps that turn an oscillation by a part of a circle
local function resonances_of(map, panel, along)
  local x, y = {}, {}
  for k, i in ipairs(map.column == map.h and #panel.rows <= MOST_MARKED and panel.rows or {}) do
    for _, mark in ipairs((map:resonances(i))) do
      x[#x + 1], y[#y + 1] = along and along[k] or 1, mark.h
    end
  end
  return x, y
end

-- units of the system by name; of time under t
local function units_of(map)
  local fine, units = blame.try(function()
    return (map.base or map.system_of(map.cells[1][1])).units
  end)
  return fine and units or {}
end

local function name_of(map)
  local fine, name = blame.try(function()
    return (map.base or map.system_of(map.cells[1][1])).name
  end)
  return fine and name or nil
end

local function unit_of(units, axis) return axis and units[axis.name == "h" and "t" or axis.name] end

local function with_unit(number, unit)
  return ("%.4g"):format(number) .. (unit and " " .. unit or "")
end

-- what all panels share: "name", the step where it is one, how long
local function setting_of(map)
  local units, text, o = units_of(map), {}, map.options
  if map.column ~= map.h then text[1] = "h = " .. with_unit(map.h[1], units.t) end
  text[#text + 1] = o.steps and ("%d step%s"):format(o.steps, o.steps == 1 and "" or "s") or "t = "
    .. with_unit(o.t, units.t)
  return name_of(map), table.concat(text, ", ")
end

local function panel_of(map, panel, along)
  local out, by_class = {}, rectangles(map, panel, along)
  for k, class in ipairs(cells.CLASSES) do
    local box = by_class[k]
    if box then
      box.name, box.style = class.name, "cells"
      box.colour = palette.CLASSES[class.name]
      out[#out + 1] = box
    end
  end
  -- below the limits, which may lie on them
  local marks, steps = resonances_of(map, panel, along)
  if #marks > 0 then
    out[#out + 1] = { x = marks, y = steps, name = "resonances", colour = "#000000", halo = true,
      open = true, style = "points" }
  end
  for _, line in ipairs { { "theory", "linear theory", palette.LINES[4], "lines" },
    { "right", "limit of what is right", "#9a9a9a", "points" },
    { "limit", "measured limit", "#000000", "points" } } do
    local x, y = line_of(map, panel, along, line[1])
    if #x > 1 or #x == 1 and not along then
      out[#out + 1] = { x = x, y = y, name = line[2], colour = line[3], halo = true,
        style = #x == 1 and "points" or line[4] }
    end
  end
  local x1, x2 = 0.5, 1.5
  if along then x1, x2 = (axes.edges(along, 1)), select(2, axes.edges(along, #along)) end
  out.xrange, out.yrange = { x1, x2 }, { (axes.edges(map.column, 1)),
    select(2, axes.edges(map.column, #map.column)) }
  out.log = (along and along.log and "x" or "") .. (map.column.log and "y" or "")
  out.log = out.log ~= "" and out.log or nil
  local units = units_of(map)
  out.xlabel, out.ylabel, out.title = along and along.name or " ", map.column.name, panel.title
  out.xunit, out.yunit = unit_of(units, along), unit_of(units, map.column)
  return out
end

---- in a terminal: a character for each cell ----

local LETTERS = { wrong = "w", drifting = "d", chaotic = "c", off = "o", ["blow-up"] = "#",
  ["no value"] = "?", left = "/", ["no convergence"] = "n",
  ["constraint lost"] = "k", ["no start"] = "x", ["not run"] = " " }

-- the sign of a class: of what is bounded a point, as small as the locale has one
local function letter(class, plain) return LETTERS[class] or characters.here(plain).point end

local WIDE, HIGH = 72, 24

-- at most `most` of the numbers 1 .. n, evenly
local function some_of(n, most)
  local out = {}
  for k = 1, math.min(n, most) do
    out[k] = n <= most and k or 1 + (k - 1) * (n - 1) // (most - 1)
  end
  return out
end

local function print_panel(map, panel, along, plain)
  local across, up, used = some_of(#panel.rows, WIDE), some_of(#map.column, HIGH), {}
  print(panel.title)
  for k = #up, 1, -1 do
    local line = { ("%11.4g "):format(map.column[up[k]]) }
    for _, x in ipairs(across) do
      local class = cells.CLASSES[map.cells[panel.rows[x]][up[k]].class].name
      line[#line + 1], used[class] = letter(class, plain), true
    end
    print(table.concat(line))
  end
  print(("%11s%s"):format(map.column.name, along and (" %s = %.4g to %.4g")
    :format(along.name, along[1], along[#along]) or ""))
  local legend = {}
  for _, class in ipairs(cells.CLASSES) do
    if used[class.name] then
      legend[#legend + 1] = ("%s %s"):format(letter(class.name, plain), class.name)
    end
  end
  print(table.concat(legend, "   "))
end

local MOST_PANELS = 12

local function plot(map, options)
  local given = option.copy(options, "map:plot")
  local all, along = panels_of(map)
  local there = #all
  if #all > MOST_PANELS then
    local some = {}
    for k = 1, MOST_PANELS do some[k] = all[1 + (k - 1) * (#all - 1) // (MOST_PANELS - 1)] end
    all = some
  end
  if not given.file then
    for _, panel in ipairs(all) do print_panel(map, panel, along, given.ascii) end
    if there > #all then print(("(%d of %d panels)"):format(#all, there)) end
    return
  end
  local panels, name, setting = {}, setting_of(map)
  for i, panel in ipairs(all) do panels[i] = panel_of(map, panel, along) end
  if #panels == 1 then
    local panel, rest = panels[1], {}
    for key, value in pairs(panel) do
      if type(key) == "string" then rest[key] = value end
    end
    rest.title = ("%s%s, %s"):format(name and name .. ": " or "", panel.title, setting)
    for key, value in pairs(given) do rest[key] = value end
    if given.file and not (given.size or given.width or given.height) then
      rest.size = { 900, 600 }
    end
    return require "dm.show.plot".plot(table.move(panel, 1, #panel, 1, {}), rest)
  end
  panels.title = (name and name .. ", " or "") .. setting
    .. (there > #all and (" (%d of %d panels)"):format(#all, there) or "")
  for key, value in pairs(given) do panels[key] = value end
  return require "dm.show.plot".figure(panels)
end

class.method("dm.stability_map", "table", table_of, [[
map:table([most]) -> string
A line for every row (at most `most`, default 40, evenly taken): the measured limit, the limit of
linear theory where there is one, and what happens beyond.]])

class.method("dm.stability_map", "csv", csv, [[
map:csv(file) -> file name   or   map:csv() -> string
A line for every cell: rule, parameters, h, class, steps, error, slope, slope_error, growth,
exponent, megno; off, range, hidden as far as the rows of the map told them (map:at looks at every
step).]])

class.method("dm.stability_map", "plot", plot, [[
map:plot{file=, title=, ...} -> file name or nothing
The classes as colours (dm.palette "classes"; blue: right, yellow to red: wrong, drifting or
chaotic, grey: lost) over the last row parameter (across) and the columns (up), one panel for every
rule and every value of the first of two row parameters (at most 12), with the measured and the
theoretical limits and the resonances; without a file as letters in the terminal. Other options as
in dm.plot.]])

--- What tostring gives for a map.
local function text(map)
  local lines = { sentence(map) }
  for _, note in ipairs(map.notes or {}) do lines[#lines + 1] = "note: " .. note end
  lines[#lines + 1] = table_of(map, 12)
  return table.concat(lines, "\n")
end

return { text = text }
