--- What a stability map tells: limits, cells and why they are of their class, linear theory.
local cells = require "dm.stability.cells"
local class = require "dm.base.class"
local core = require "dm.core"

local fail = require "dm.base.options".failing "dm.stability"

local Map = core.class({ __name = "dm.stability_map" }, [[
dm.stability_map: where a method fails, made by dm.stability{system=, q=, v=, rule=, h=, steps=}
fields: h and the parameters by name (lists of numbers), rows (what belongs to each), rules, seconds
(what it took)]])

-- what the class of a cell says here: of the energy, or of what is watched in its place
local function text_of(map, cell)
  local class = cells.CLASSES[cell.class]
  if class.name == "no start" and cell.reason then return cell.reason end
  if class.name == "blow-up" and cell.code == "not_finite" and cell.error
    and cell.error < (cell.kinetic or 0) then
    return "the motion left all bounds at once, or the domain of L"
  end
  if not map.options.watch then return class.text end
  local text = class.text:gsub("the energy error", "the change of what is watched")
  return (text:gsub("the energy", "what is watched"))
end

local function sentence_of_limit(map, i)
  local b, name = map.borders[i], map.column.name
  for _, cell in ipairs(b.high and {} or map.cells[i]) do
    if cell.class == cells.NUMBER["not run"] then
      return nil, "stopped before all cells of the row were run"
    end
  end
  if not b.high then
    return math.huge, ("none is lost up to %s = %.4g"):format(name, map.column[#map.column])
  end
  local why = ("%s from %s = %.6g on: %s"):format(cells.CLASSES[b.high.class].name, name, b.high.x,
    text_of(map, b.high))
  if not b.low then
    return map.column == map.h and 0 or -math.huge, "lost from the first cell on, " .. why
  end
  return b.low.x, why
end

local function find_row(map, which)
  if math.type(which) == "integer" then
    if not map.rows[which] then fail("there are rows 1 to %d (got %d)", #map.rows, which) end
    return which
  end
  if type(which) ~= "table" then fail("a row is its number or a table { rule =, k = }") end
  local best, least
  for i, row in ipairs(map.rows) do
    local distance = (which.rule and which.rule ~= row.rule) and math.huge or 0
    for name, x in pairs(row.values) do
      if which[name] then
        local size = math.abs(x) + math.abs(which[name]) + 1e-300
        distance = distance + math.abs(x - which[name]) / size
      end
    end
    if distance < (least or math.huge) then best, least = i, distance end
  end
  if not best then
    fail("no row of rule '%s'; there are %s", tostring(which.rule), table.concat(map.rules, ", "))
  end
  return best
end

class.method("dm.stability_map", "limit", function(self, which)
  return sentence_of_limit(self, find_row(self, which))
end, [[
map:limit(row) -> number, sentence   or   nil, sentence
The largest value of the columns (the step h, or the last parameter of a map with one step) before
the first that is lost in a row, found to `resolution` (1e-3, relative) by cells in between;
infinity when none is lost, 0 when the first is, nil where the map was stopped before. row: its
number, or a table such as { rule = "verlet", k = 100 } (the nearest). The sentence says what
happens beyond.]])

local function nearest_column(map, x)
  local best = 1
  for j, value in ipairs(map.column) do
    if math.abs(value - x) < math.abs(map.column[best] - x) then best = j end
  end
  return best
end

local FIELDS = { "h", "steps", "error", "slope", "slope_error", "growth", "exponent", "megno",
  "code" }

local function why(map, cell)
  local class = cells.CLASSES[cell.class]
  local text = ("%s: %s"):format(class.name, text_of(map, cell))
  local function add(...) text = text .. (...):format(select(2, ...)) end
  if class.name == "blow-up" and cell.code == "not_finite" then
    add("; not finite at step %d", cell.steps + 1)
  end
  if class.lost and cell.code == "ok" and cell.growth then
    add("; by a factor of %.6g a step", cell.growth)
  end
  if class.name == "no convergence" then add(" (step %d)", cell.steps + 1) end
  if class.name == "drifting" then
    add("; slope %.3g +- %.1g per unit of time", cell.slope, cell.slope_error)
  end
  if class.name == "chaotic" then
    add("; Lyapunov exponent %.3g, MEGNO %.3g", cell.exponent, cell.megno)
  end
  if class.name == "bounded" or class.name == "off" then
    add(map.options.watch and "; it changes by %.2g" or "; energy error %.2g", cell.error)
  end
  return text
end

class.method("dm.stability_map", "at", function(self, which, column)
  local i = find_row(self, which)
  if type(column) ~= "number" then
    fail("a column is its number, or a value of %s", self.column.name)
  end
  local j = type(which) == "table" and nearest_column(self, column) or column
  local cell = self.cells[i][j]
  if not cell then fail("there are columns 1 to %d (got %s)", #self.column, tostring(column)) end
  local out = { class = cells.CLASSES[cell.class].name, why = why(self, cell),
    rule = self.rules[cell.rule] }
  for _, name in ipairs(FIELDS) do out[name] = cell[name] end
  for name, value in pairs(cell.values) do out[name] = value end
  return core.result(out)
end, [[
map:at(row, column) -> {class, why, rule, h, steps, error, slope, growth, exponent, megno, ...}
What was found in a cell and on what evidence: row and column are numbers of cells, or row a table
as for map:limit and column a value (the nearest). error: largest |energy - its start| (or of what
is watched); slope per unit of time with its standard error; growth: factor a step from the first to
the last quarter; exponent, megno: of the exact tangent map; steps finished; code: of dm.failure or
"ok".]])

class.method("dm.stability_map", "theory", function(self, which)
  local i = find_row(self, which)
  local row = self.rows[i]
  if self.column ~= self.h then return nil, "the map has no axis of steps" end
  if not row.theory then
    row.theory = { require "dm.stability.linear".limit_at_start(self,
      { rule = row.number, values = row.values, h = self.h[1] }, self.h) }
  end
  return row.theory[1], row.theory[2]
end, [[
map:theory(row) -> number, sentence   or   nil, sentence
The step at which the linear theory of the rule loses the fastest oscillation of the system
linearised at the start of the row: the limit of h omega from dm.stability_limit over the largest
frequency from system:linearize. Beside map:limit(row), which is measured. nil, and why, where there
is none: for rules other than Runge-Kutta ones also where forces linear in v (magnetic, Coriolis,
friction) couple the oscillations.]])

local RESERVED = { class = true, why = true, rule = true }
for _, name in ipairs(FIELDS) do RESERVED[name] = true end

--- Has a map, or a cell of map:at, a field or method of that name? No parameter may be called so.
local function is_taken(name) return Map.methods[name] ~= nil or RESERVED[name] ~= nil end

Map.__tostring = require "dm.stability.show"

return { class = Map, is_taken = is_taken }
