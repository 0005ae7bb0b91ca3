--- dm.stability: where methods fail. Every cell of a map over step size and parameters is run and
-- told apart by what its rows show.
local axes = require "dm.stability.axes"
local blame = require "dm.base.blame"
local cells = require "dm.stability.cells"
local core = require "dm.core"
local prolong = require "dm.measure.prolong"
local given_ = require "dm.stability.given"
local opts = require "dm.base.options"

local M = {}
M.__index = M
M.__name = "dm.stability_map"
setmetatable(M, { __index = function(_, key) core.miss(M.__name, key, M) end })

local WHERE = "dm.stability"
local fail = opts.failing(WHERE)

---- options ----

local KNOWN = { "system", "q", "v", "p", "rule", "rules", "h", "steps", "t", "t0", "watch",
  "inside", "drift", "chaos", "refine", "resolution", "threads", "project",
  "newton", "backend", "sums" }
local known = {}
for _, name in ipairs(KNOWN) do known[name] = true end

-- the names of the parameters: every option that is none of the above
local function parameters(options)
  local names = {}
  for key, value in pairs(options) do
    if type(key) ~= "string" then
      if key ~= 1 or type(value) ~= "userdata" then
        fail("takes names: { system =, q =, v =, rule =, h =, steps = }, and parameters k = {...}")
      end
    elseif not known[key] then
      if type(value) ~= "table" and type(value) ~= "number" then
        fail("option '%s' is not known, and as a parameter it must be numbers: {least, largest, "
          .. "count, \"log\" or \"linear\"}; options are %s", key, table.concat(KNOWN, ", "))
      end
      names[#names + 1] = key
    end
  end
  table.sort(names)
  if #names > 2 then
    fail("at most two parameters beside the step (got %s)", table.concat(names, ", "))
  end
  return names
end

local function check_options(options)
  if (options.steps == nil) == (options.t == nil) then fail("give 'steps' or 't' (a duration)") end
  opts.whole(options, "steps", WHERE, 1, 2 ^ 53)
  opts.positive(options, "t", WHERE, "a duration")
  if not options.q then
    fail("the start is missing: q, and v or p, as numbers or as functions of the parameters")
  end
  if options.v and options.p then fail("give the start as q and v or as q and p, not both") end
  if options.h == nil then
    fail("the axis of steps is missing: h = {least, largest, count, \"log\"}, a list or a number")
  end
  for _, key in ipairs { "watch", "inside" } do
    opts.callable(options, key, WHERE, "(q, v, t, p)")
  end
  for _, key in ipairs { "drift", "resolution" } do opts.fraction(options, key, WHERE) end
end

local function read_rules(options)
  local list = options.rules or options.rule
  if options.rules and options.rule then fail("give 'rule' or 'rules', not both") end
  if list == nil then fail("the rule is missing: rule = \"verlet\", or rules = { ... }") end
  if type(list) ~= "table" then list = { list } end
  if #list == 0 then fail("option 'rules' is an empty list") end
  return list
end

---- the grid ----

-- rows: rules and parameters; columns: steps, or the last parameter where there is one step
local function lay_out(map)
  local by_row = {}
  for _, name in ipairs(map.names) do by_row[#by_row + 1] = map[name] end
  local column = map.h
  if #map.h == 1 and #by_row > 0 then column = table.remove(by_row) end
  map.column, map.row_axes, map.rows, map.cells = column, by_row, {}, {}
  local first, second = by_row[1] or { 0 }, by_row[2] or { 0 }
  for r = 1, #map.rule_list do
    for i = 1, #first do
      for k = 1, #second do
        local values = {}
        if by_row[1] then values[by_row[1].name] = first[i] end
        if by_row[2] then values[by_row[2].name] = second[k] end
        map.rows[#map.rows + 1] = { rule = map.rules[r], number = r, values = values }
      end
    end
  end
end

-- cells of a row share its parameters, where the columns are steps
local function cell_at(map, row, x)
  local values = row.values
  if map.column ~= map.h then
    values = { [map.column.name] = x }
    for name, value in pairs(row.values) do values[name] = value end
  end
  return { rule = row.number, h = map.column == map.h and x or map.h[1], values = values, x = x,
    row = row }
end

local function all_cells(map)
  local out = {}
  for i, row in ipairs(map.rows) do
    map.cells[i] = {}
    for j, x in ipairs(map.column) do
      local cell = cell_at(map, row, x)
      map.cells[i][j], out[#out + 1] = cell, cell
      cell.number, cell.class = #out, cells.NUMBER["not run"]
    end
  end
  return out
end

---- boundary ----

local PARTS = 7  -- cells between two neighbours of which one is lost, run at once

local function is_lost(cell) return cells.CLASSES[cell.class].lost end

-- cells of a row against their neighbour of smaller step
local function compare_row(map, row)
  if map.column ~= map.h then return end
  local smaller
  for _, cell in ipairs(row) do
    if smaller then cells.compare(cell, smaller) end
    if not is_lost(cell) then smaller = cell end
  end
end

-- the last cell before the first that is lost, and that one
local function border(row)
  for j, cell in ipairs(row) do
    if is_lost(cell) then return row[j - 1], cell end
  end
end

local function is_open(map, b)
  return b.low and b.high and math.abs(b.high.x - b.low.x) > map.resolution * math.max(
    math.abs(b.high.x), math.abs(b.low.x))
end

-- narrow all borders at once: PARTS cells in each, then the part in which the first is lost
local function refine(map)
  for _ = 1, 16 do
    local todo, open = {}, {}
    for i, b in ipairs(map.borders) do
      local parts = {}
      for k = 1, is_open(map, b) and PARTS or 0 do
        parts[k] = cell_at(map, map.rows[i], axes.between(map.column, b.low.x, b.high.x,
          k / (PARTS + 1)))
        todo[#todo + 1], parts[k].number = parts[k], k
      end
      if #parts > 0 then open[#open + 1] = { border = b, parts = parts } end
    end
    if #todo == 0 then return end
    local stopped = cells.run(map, todo, false)
    if stopped then return stopped end
    for _, one in ipairs(open) do
      for _, cell in ipairs(one.parts) do
        if map.column == map.h then cells.compare(cell, one.border.low) end
        if is_lost(cell) then
          one.border.high = cell
          break
        end
        one.border.low = cell
      end
    end
  end
end

---- what the map tells ----

-- what the class of a cell says here: of the energy, or of what is watched in its place
local function text_of(map, cell)
  local class = cells.CLASSES[cell.class]
  if class.name == "no start" and cell.reason then return cell.reason end
  if class.name == "blow-up" and cell.code == "not_finite" and cell.error
    and cell.error < (cell.kinetic or 0) then
    return "the motion left all bounds at once, or the domain of L"
  end
  if not map.options.watch then return class.text end
  return (class.text:gsub("the energy error", "the change of what is watched"):gsub("the energy",
    "what is watched"))
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
        distance = distance + math.abs((x - which[name]) / (
          math.abs(x) + math.abs(which[name]) + 1e-300))
      end
    end
    if distance < (least or math.huge) then best, least = i, distance end
  end
  if not best then
    fail("no row of rule '%s'; there are %s", tostring(which.rule), table.concat(map.rules, ", "))
  end
  return best
end

local doc_limit = [[
map:limit(row) -> number, sentence   or   nil, sentence
The largest value of the columns (the step h, or the last parameter of a map with one step) before
the first that is lost in a row, found to `resolution` (1e-3, relative) by cells in between;
infinity when none is lost, 0 when the first is, nil where the map was stopped before. row: its
number, or a table such as { rule = "verlet", k = 100 } (the nearest). The sentence says what
happens beyond.]]

M.limit = blame.caller(function(self, which)
  return sentence_of_limit(self, find_row(self, which))
end)

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

local doc_at = [[
map:at(row, column) -> {class, why, rule, h, steps, error, slope, growth, exponent, megno, ...}
What was found in a cell and on what evidence: row and column are numbers of cells, or row a table
as for map:limit and column a value (the nearest). error: largest |energy - its start| (or of what
is watched); slope per unit of time with its standard error; growth: factor a step from the first to
the last quarter; exponent, megno: of the exact tangent map; steps finished; code: of dm.failure or
"ok".]]

M.at = blame.caller(function(self, which, column)
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
end)

local doc_theory = [[
map:theory(row) -> number, sentence   or   nil, sentence
The step at which the linear theory of the rule loses the fastest oscillation of the system
linearised at the start of the row: the limit of h omega from dm.stability_limit over the largest
frequency from system:linearize. Beside map:limit(row), which is measured. nil, and why, where there
is none: for rules other than Runge-Kutta ones also where forces linear in v (magnetic, Coriolis,
friction) couple the oscillations.]]

M.theory = blame.caller(function(self, which)
  local i = find_row(self, which)
  local row = self.rows[i]
  if self.column ~= self.h then return nil, "the map has no axis of steps" end
  if not row.theory then
    row.theory = { require "dm.stability.linear".limit_at_start(self,
      { rule = row.number, values = row.values, h = self.h[1] }, self.h) }
  end
  return row.theory[1], row.theory[2]
end)

---- making one ----

local doc_stability = [[
dm.stability{system=, q=, v= | p=, rule= | rules=, h=, steps= | t=, k=, ...} -> dm.stability_map
Where does a method fail? A map over the step h and up to two parameters of any name. An axis is
{least, largest, count, "log" | "linear"}, a list of growing numbers (three numbers without the word
are one, too) or one number. A parameter is an argument of that name of the function that makes the
system (system = function(k) return dm.system{...} end), or of functions q, v, p that give the
start, or is among the params of a system. Every cell is run in C, on all cores, over the same
number of steps or the same duration t, and told apart by its rows: bounded, drifting (a slope of
the energy above 5 standard errors that moves it by more than drift = 1e-6 of the kinetic energy),
chaotic (MEGNO above 4, by the exact tangent map; chaos = false leaves that out, as is the default
for implicit rules and more than 4096 cells), off (an energy that has gone far elsewhere), blow-up,
left (inside(q, v, t, p) > 0 no longer holds), no convergence, constraint lost, no start (map:at
says why), no value (of watch).
watch = f(q, v, t, p): what shall not drift, in place of the energy. Borders to what is lost are
refined to resolution = 1e-3 (refine = false: not). map:limit(row), :theory(row), :at(row, column),
:table(), :plot{file=}, :csv(file); map.h, map.k, ... are the axes, map.rows the rows, map.notes
what to know of the start and the axes (an equilibrium does not move, whatever the step; a parameter
that changes no cell).
Other options: t0, threads, project, newton, backend, sums, as in solvers and ensembles. Ctrl-C ends
it with dm.failure, whose field `map` is what is there.]]

local RESERVED = { class = true, why = true, rule = true }
for _, name in ipairs(FIELDS) do RESERVED[name] = true end

local function new_map(options, names)
  local map = setmetatable({ options = options, names = names, rule_list = read_rules(options),
    rules = {}, borders = {},
    drift = options.drift or 1e-6, resolution = options.resolution or 1e-3 }, M)
  for i, rule in ipairs(map.rule_list) do map.rules[i] = (tostring(rule):gsub("^rule ", "")) end
  map.h = axes.read("h", options.h)
  if map.h[1] <= 0 then fail("axis 'h': steps must be > 0") end
  for _, name in ipairs(names) do
    if M[name] or map[name] ~= nil or RESERVED[name] then
      fail("a parameter cannot be called '%s' here", name)
    end
    map[name] = axes.read(name, options[name])
  end
  return map
end

local NO_EXPONENT = { "^log%-hamiltonian", "^degenerate" }

local MANY = 4096  -- cells of which an implicit rule follows no tangent vectors unless asked to

-- are all steps of the rules kicks and drifts or explicit stages?
local function is_costly(map, system)
  if #map.rows * #map.column <= MANY then return false end
  local separable, cheap = system:structure().separable, {}
  for _, row in ipairs(core.rules()) do
    cheap[row.name] = row.explicit or separable and row.instances[1] and row.instances[1].forces > 0
  end
  for _, rule in ipairs(map.rules) do
    if not cheap[rule:match "^[%w_-]+"] then return true end
  end
  return false
end

-- exponents need the prolonged system
local function wants_chaos(map, cell)
  local system = map.system_of(cell)
  if not pcall(prolong.system, system) then return false end  -- not traced
  if map.options.chaos == false or map.options.chaos == nil and is_costly(map, system) then
    return false
  end
  if not (system.given and system.given.L) or system.given.control
    or system:structure().linear_in_v then
    return false
  end
  for _, rule in ipairs(map.rules) do
    for _, pattern in ipairs(NO_EXPONENT) do
      if rule:find(pattern) then return false end
    end
  end
  return true
end

-- what stopped f(...), as it returns or raises it
local function until_stop(f, ...)
  local fine, stopped = core.until_stop(f, ...)
  if not fine and not blame.is_stop(stopped) then error(stopped, 0) end
  return blame.stopped(stopped)
end

local function find_borders(map)
  for i, row in ipairs(map.cells) do
    compare_row(map, row)
    local low, high = border(row)
    map.borders[i] = { low = low, high = high }
  end
end

-- runs the cells; returns what stopped it, if anything
local function fill(map)
  local all = all_cells(map)
  map.count = #all
  local first = given_.first(map)
  given_.check_first(map, first)
  map.notes = given_.notes(map, first)
  map.chaos = wants_chaos(map, first)
  local stopped = cells.run(map, all, map.chaos)
  if not map.started and not stopped then error(map.refusal, 0) end
  find_borders(map)
  if stopped then return stopped end
  given_.note_idle(map)
  if map.options.refine == false then return nil end
  return refine(map)
end

M.stability = blame.caller(function(options)
  if type(options) ~= "table" then
    fail("takes a table { system =, q =, v =, rule =, h = {least, largest, count, \"log\"}, steps "
      .. "= }")
  end
  check_options(options)
  local names = parameters(options)
  local map = new_map(options, names)
  given_.read(map, options, names)
  lay_out(map)
  map.notes = {}
  local start = core.clock()
  local stopped = until_stop(fill, map)
  -- stopped among them: laid out anew, none is run
  if not map.count then map.count = #all_cells(map) end
  map.seconds = core.clock() - start
  if stopped then
    if #map.borders < #map.cells then find_borders(map) end
    stopped.map, stopped.path = map, map
    stopped.message = map.started
      and "dm.stability: stopped on request; what is there is in the failure's field map"
      or "dm.stability: stopped on request before a cell was run"
    error(stopped, 0)
  end
  return map
end)

core.docs[M.stability], core.docs[M.limit], core.docs[M.at], core.docs[M.theory] = doc_stability,
  doc_limit, doc_at, doc_theory
require "dm.stability.show"(M)
require "dm.base.class".register(M, { "limit", "at", "theory", "table", "plot", "csv" }, [[
dm.stability_map: where a method fails, made by dm.stability{system=, q=, v=, rule=, h=, steps=}
fields: h and the parameters by name (lists of numbers), rows (what belongs to each), rules, seconds
(what it took)]])

return M
