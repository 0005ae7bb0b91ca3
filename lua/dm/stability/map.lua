--- What a stability map tells: limits, cells and why they are of their class, linear theory.
local cells = require "dm.stability.cells"
local class = require "dm.base.class"
local closer = require "dm.stability.closer"
local core = require "dm.core"
local borders = require "dm.stability.borders"
local tongues = require "dm.stability.tongues"

local fail = require "dm.base.options".failing "dm.stability"

local abs = math.abs

local Map = core.class({ __name = "dm.stability_map" }, [[
dm.stability_map: where a method fails, made by dm.stability{system=, q=, v=, rule=, h=, steps=}
fields: h and the parameters by name (lists of numbers), rows (what belongs to each), rules, seconds
(what it took)]])

-- what the class of a cell says here: of the energy, of what is watched in its place, or of the
-- size of the state where forces or time change the energy
local function text_of(map, cell)
  local class = cells.CLASSES[cell.class]
  if (class.name == "no start" or class.name == "no convergence") and cell.reason then
    return cell.reason
  end
  if class.name == "blow-up" and cell.code == "not_finite" and cell.error
    and cell.error < (cell.kinetic or 0) then
    return "the motion left all bounds at once, or the domain of L"
  end
  if cell.sized then
    return (class.text:gsub("the energy error", "the size of the state")
      :gsub("the energy", "the size of the state"))
  end
  if not map.options.watch then return class.text end
  local text = class.text:gsub("the energy error", "the change of what is watched")
  return (text:gsub("the energy", "what is watched"))
end

-- why nothing is known of a row that was not run to its end
local function not_run(map, i)
  for _, cell in ipairs(map.cells[i]) do
    if cell.class == cells.NUMBER["not run"] then
      return "stopped before all cells of the row were run"
    end
  end
end

-- the end of a border, and what is beyond it; `none`, `first`: what to say where nothing is, or the
-- first cell; class: what is beyond, if not the class of that cell
local function border_text(map, i, b, none, first, why, class)
  local name = map.column.name
  local gap = not b.high and not_run(map, i)
  if gap then return nil, gap end
  if not b.high then
    return math.huge, ("%s up to %s = %.4g"):format(none, name, map.column[#map.column])
  end
  local text = ("%s from %s = %.6g on: %s"):format(class or cells.CLASSES[b.high.class].name, name,
    b.high.x, why)
  if b.again then
    text = text .. ("; a tongue of instability: at %s = %.4g it is not lost"):format(name, b.again)
  end
  if not b.low then return map.column == map.h and 0 or -math.huge, first .. ", " .. text end
  return b.low.x, text
end

local function sentence_of_limit(map, i)
  local b = map.borders[i]
  return border_text(map, i, b, "none is lost", "lost from the first cell on",
    b.high and text_of(map, b.high))
end

-- observable k; a field of another size may have more values than the last one looked at
local function name_of(map, k) return map.beside.observed.names[k] or "q" .. k end

-- what makes a cell wrong: an observable, the velocity, or both; nil where it is neither
local function text_of_wrong(map, cell)
  local far = cell.off and cell.observable
    and not (cell.loose and cell.off <= map.beside.accuracy * cell.range)
  local off = far and ("%s is off by %.3g, and its range is %.3g"):format(
    name_of(map, cell.observable), cell.off, cell.range)
  local loose = cell.loose and ("the velocity leaves the constraint by |G v| = %.3g"):format(
    cell.hidden)
  return off and loose and off .. "; " .. loose or off or loose or nil
end

-- the end of what is right, and what is wrong beyond it
local function sentence_of_right(map, i)
  if not map.beside then
    return nil, "nothing is compared with a resolved flow: give t, a duration, and no accuracy = "
      .. "false"
  end
  local b = map.right[i]
  local high = b.high
  if high and high.unresolved then return nil, "no resolved flow: " .. high.unresolved end
  local why = high and text_of_wrong(map, high)
  return border_text(map, i, b, "all are right", "not right from the first cell on",
    why or high and text_of(map, high), why and not cells.CLASSES[high.class].lost and "wrong")
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

class.method("dm.stability_map", "limit", function(self, which, of)
  if of ~= nil and of ~= "right" then
    fail("the limit is that of what is lost, or \"right\" (got %s)", tostring(of))
  end
  local i = find_row(self, which)
  local stopped = borders.settle(self, i)
  if stopped then fail("%s", stopped) end
  return (of == "right" and sentence_of_right or sentence_of_limit)(self, i)
end, [[
map:limit(row [, "right"]) -> number, sentence   or   nil, sentence
The largest value of the columns (the step h, or the last parameter of a map with one step) before
the first that is lost in a row, found to `resolution` (1e-3, relative) by cells in between;
infinity when none is lost, 0 (of a parameter -infinity) when the first is, nil where the map was
stopped before. The first time a limit of a row is asked for, the windows and resonances of linear
theory (map:resonances) are tried between the columns, of maps with up to 64 rows: a narrow tongue
of instability there is the limit, and the sentence says so. Other tongues narrower than a column,
as those about resonances of two oscillations or of more than 6 steps a turn, are seen only where a
column meets them. "right": the same of what is right, no observable further than `accuracy` from
the resolved flow up to t; nil where no flow is known. row: its number, or a table such as { rule =
"verlet", k = 100 } (the nearest). The sentence says what happens beyond.]])

local function nearest_column(map, x)
  local best = 1
  for j, value in ipairs(map.column) do
    if math.abs(value - x) < math.abs(map.column[best] - x) then best = j end
  end
  return best
end

local FIELDS = { "h", "steps", "error", "slope", "slope_error", "growth", "exponent", "megno",
  "code", "off", "range", "horizon", "phase", "hidden", "cause" }

local function observable_of(map, cell)
  return cell.observable and map.beside and name_of(map, cell.observable)
end

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
  if cell.cause then
    add(cell.cause == "flow" and "; the flow itself is chaotic"
      or "; by the step: the flow is not chaotic")
  end
  if class.name == "wrong" then
    local text = text_of_wrong(map, cell)
    if text then add("; %s", text) end
    if cell.phase then
      add("; %s by %.6g at the end", cell.phase > 0 and "ahead" or "behind", abs(cell.phase))
    end
  end
  if class.name == "bounded" or class.name == "wrong" or class.name == "off" then
    add(cell.sized and "; |q|^2 + |p|^2 changes by %.2g" or map.options.watch
      and "; it changes by %.2g" or "; energy error %.2g", cell.error)
  end
  return text
end

class.method("dm.stability_map", "at", function(self, which, column)
  local i = find_row(self, which)
  if type(column) ~= "number" or column ~= column then
    fail("a column is its number, or a value of %s", self.column.name)
  end
  local j = type(which) == "table" and nearest_column(self, column) or column
  local cell = self.cells[i][j]
  if not cell then fail("there are columns 1 to %d (got %s)", #self.column, tostring(column)) end
  closer.look(self, cell)
  local out = { class = cells.CLASSES[cell.class].name, why = why(self, cell),
    rule = self.rules[cell.rule], observable = observable_of(self, cell) }
  for _, name in ipairs(FIELDS) do out[name] = cell[name] end
  for name, value in pairs(cell.values) do out[name] = value end
  return core.result(out)
end, [[
map:at(row, column) -> {class, why, rule, h, steps, error, slope, growth, exponent, megno, cause,
  observable, off, range, phase, hidden, horizon, ...}
What was found in a cell and on what evidence: row and column are numbers of cells, or row a table
as for map:limit and column a value (the nearest). error: largest |energy - its start| (or of what
is watched); slope per unit of time with its standard error; growth: factor a step from the first to
the last quarter; exponent, megno: of the exact tangent map; steps finished; code: of dm.failure or
"ok". Of maps over a duration t, at every step up to it: observable: the one that is furthest off in
parts of its range, off: by how much, range: greatest less least value of it in the resolved flow,
both in its units; phase: the time by which the run is ahead at the end (behind: negative), the
shift of the flow that fits it best, followed from the start; nil where none does; hidden: largest
|G v + g_t| of the constraints g(q, t), G = dg/dq as written, v from p; horizon: the time up to
which the flow is known, where chaos ends it early; cause of chaos: "flow", or "step" where the
resolved flow is not chaotic.]])

class.method("dm.stability_map", "theory", function(self, which)
  local i = find_row(self, which)
  if self.column ~= self.h then return nil, "the map has no axis of steps" end
  return tongues.theory(self, i, "limit_along_orbit")
end, [[
map:theory(row) -> number, sentence   or   nil, sentence
The step at which the linear theory of the rule loses an oscillation of the system linearised along
the orbit of the row: where one of its frequencies (system:linearize) meets the first window of
growth of dm.stability_limit, however narrow. Beside map:limit(row), which is measured. nil, and
why, where there is none: for rules other than Runge-Kutta ones also where forces linear in v
(magnetic, Coriolis, friction) couple the oscillations.]])

class.method("dm.stability_map", "resonances", function(self, which)
  local i = find_row(self, which)
  if self.column ~= self.h then return core.result {}, "the map has no axis of steps" end
  local list, why = tongues.theory(self, i, "resonances")
  return list and core.result(list) or core.result {}, why
end, [[
map:resonances(row) -> list of {n, h, omega, mean}, sentence
The steps, inside of those of the map and the smallest first, that turn an oscillation of the system
linearised along the orbit by 2 pi / n, n = 3 to 6: near these a symplectic rule is unstable in
nonlinear forces. omega: the frequency; where it changes along the orbit its mean over the time, if
it is more than twice as fast as the orbit turns, else that of the orbit itself: of coordinates that
turn with several oscillations (2 to 12 of them) a line of their spectrum, to about half a turn in
the whole time. mean: true where it is a
mean of frequencies that change, as a mode that hardly moves has it: the motion need not have it.
The sentence says why where there are none.]])

local RESERVED = { class = true, why = true, rule = true, observable = true }
for _, name in ipairs(FIELDS) do RESERVED[name] = true end

--- Has a map, or a cell of map:at, a field or method of that name? No parameter may be called so.
local function is_taken(name) return Map.methods[name] ~= nil or RESERVED[name] ~= nil end

Map.__tostring = require "dm.stability.show".text

return { class = Map, is_taken = is_taken }
