--- dm.stability: where methods fail. Every cell of a map over step size and parameters is run and
-- told apart by what its rows show.
local axes = require "dm.stability.axes"
local blame = require "dm.base.blame"
local borders = require "dm.stability.borders"
local cells = require "dm.stability.cells"
local class = require "dm.base.class"
local core = require "dm.core"
local has_own_time = require "dm.base.own_time"
local journal = require "dm.stability.journal"
local lines = require "dm.stability.lines"
local prolong = require "dm.measure.prolong"
local flows = require "dm.stability.flows"
local given_ = require "dm.stability.given"
local maps = require "dm.stability.map"
local observables = require "dm.stability.observables"
local option = require "dm.base.options"
local own_step = require "dm.measure.own_step"
local ranks = require "dm.sweep.ranks"
local starts = require "dm.base.start"

local M = {}

local WHERE = "dm.stability"
local fail = option.failing(WHERE)

---- options ----

local KNOWN = { "system", "q", "v", "p", "u", "ut", "rule", "rules", "h", "steps", "t", "t0",
  "watch", "inside", "drift", "chaos", "refine", "resolution", "threads", "project",
  "newton", "backend", "sums", "observe", "accuracy", "seconds", "journal" }
local known = {}
-- on lines the start has their names
local OF_LINES = { u = "q", ut = "v" }
for _, name in ipairs(KNOWN) do known[name] = true end

-- a copy with q and v in the place of u and ut
local function renamed(options)
  local out = {}
  for key, value in pairs(options) do
    local name = OF_LINES[key] or key
    if out[name] ~= nil or name ~= key and options[name] ~= nil then
      fail("give '%s' (on lines) or '%s', not both", key, name)
    end
    out[name] = value
  end
  return out
end

-- the names of the parameters: every option that is none of the above
local function parameters(options)
  local names = {}
  for key, value in pairs(options) do
    if type(key) ~= "string" then
      if key ~= 1 or type(value) ~= "userdata" and not lines.is_line(value) then
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
  option.whole(options, "steps", WHERE, 1, 2 ^ 53)
  option.positive(options, "t", WHERE, "a duration")
  if not (options.v or options.p) and not options.q then fail(given_.NO_START) end
  starts.check_one(options, WHERE)
  if options.h == nil then
    fail("the axis of steps is missing: h = {least, largest, count, \"log\"}, a list or a number")
  end
  for _, key in ipairs { "watch", "inside" } do
    option.callable(options, key, WHERE, "(q, v, t, p)")
  end
  for _, key in ipairs { "chaos", "refine", "project" } do option.flag(options, key, WHERE) end
  for _, key in ipairs { "drift", "resolution" } do option.fraction(options, key, WHERE) end
  option.positive(options, "seconds", WHERE, "seconds of CPU time")
  if option.text(options, "journal", WHERE) and options.seconds then
    fail("give 'seconds' or 'journal': a map with a journal goes on where it was stopped")
  end
  observables.accuracy(options)
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

local function all_cells(map)
  local out = {}
  for i, row in ipairs(map.rows) do
    map.cells[i] = {}
    for j, x in ipairs(map.column) do
      local cell = borders.cell_at(map, row, x)
      map.cells[i][j], out[#out + 1] = cell, cell
      cell.number, cell.class = #out, cells.NUMBER["not run"]
    end
  end
  return out
end

---- making one ----

local doc_stability =
  "dm.stability{system=, q=, v= | p=, rule= | rules=, h=, steps= | t=, k=, ..., watch=, "
  .. "observe=, accuracy=, inside=, drift=, chaos=, refine=, seconds=, journal=, ...} -> "
  .. "dm.stability_map\n" .. [[
Where does a method fail? A map over the step h and up to two parameters of any name. An axis is
{least, largest, count, "log" | "linear"}, a list of growing numbers (three numbers without the word
are one, too) or one number. A parameter is an argument of that name of the function that makes the
system (system = function(k) return dm.system{...} end), or of functions q, v, p that give the
start, or is among the params of a system. Parameters that are whole numbers stay such: of fields on
meshes and lines (dm.field, with u and ut in the place of q and v) a parameter may be a size,
system = function(N) return dm.mesh{grid = N}:field{...} end, and q, v functions of the position;
map:theory is then the CFL limit. Every cell is run in C, on all cores, over the same
number of steps or the same duration t, and told apart by its rows: bounded, wrong (bounded, but
further from the resolved flow than the accuracy), drifting (a slope of the energy above 5 standard
errors that moves it by more than drift = 1e-6 of the kinetic energy),
chaotic (MEGNO above 4, by the exact tangent map; chaos = false leaves that out, as is the default
for implicit rules and more than 4096 cells: chaos that keeps its energy is bounded then),
off (an energy that has gone far elsewhere), blow-up,
left (inside(q, v, t, p) > 0 no longer holds), no convergence, constraint lost, no start (map:at
says why), no value (of watch).
With a duration t cells are compared with the resolved flow, two unlike rules with unlike steps that
agree to a thousandth of the accuracy: wrong is where at some step up to t an observable is further
off than accuracy (0.01) times its range, greatest less least value of the flow, or the velocity
leaves the constraints by so much of |G| |v|. observe: names of coordinates (left out: all, of more
than 48 so many, evenly), momenta (p_x), "energy", or name = f(q, v, t, p). accuracy = false:
nothing is compared. Where the flow is chaotic it is known up to a time (horizon of map:at), and
cells are compared up to there.
Of a field on a mesh values are observed, and the range is that of the value that changes most.
On lines (dm.field) the flow is that of the field itself, of cells ever finer in space and time, so
that a mesh too coarse is wrong, too; u and ut are then functions of x, and observe takes u (u1, ...
where it has several values; the range is that of all nodes) or name = f(u, nil, t).
watch = f(q, v, t, p): what shall not drift, in place of the energy. Borders to what is lost, and to
what is wrong, are refined to resolution = 1e-3 (refine = false: not). seconds: CPU time after which
cells are left out; map.cut says which. map:limit(row), :limit(row, "right"), :theory(row),
:resonances(row), :at(row, column), :table(), :plot{file=}, :csv(file); map.h, map.k, ... are the
axes, map.rows the rows, map.notes
what to know of the start and the axes (an equilibrium does not move, whatever the step; a parameter
that changes no cell).
journal = "file": finished cells are kept there, and the same call goes on where it stopped, by
parts and ranks as ensembles do (docs/sweeps.md); borders are refined again by the whole call.
map.journal is { file, found, run }.
On a group entries of the element are observed (R31, of factor k R31_k), where observe is left out
all of them, and body momenta (p1); a reduced system (dm.euler_poincare) starts from p or v (and a)
alone, and its momenta are observed.
Other options: t0, threads, project, newton, backend, sums, as in solvers and ensembles. Ctrl-C ends
it with dm.failure, whose field `map` is what is there.]]

local function new_map(options, names)
  local map = setmetatable({ options = options, names = names, rule_list = read_rules(options),
    rules = {}, borders = {}, right = {}, drift = options.drift or 1e-6,
    resolution = options.resolution or 1e-3 }, maps.class)
  for i, rule in ipairs(map.rule_list) do map.rules[i] = (tostring(rule):gsub("^rule ", "")) end
  map.h = axes.read("h", options.h)
  if map.h[1] <= 0 then fail("axis 'h': steps must be > 0") end
  for _, name in ipairs(names) do
    if maps.is_taken(name) or map[name] ~= nil then
      fail("a parameter cannot be called '%s' here", name)
    end
    map[name] = axes.read(name, options[name])
  end
  return map
end

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

-- has the system of a cell a prolonged one? On a group tangent vectors are run for a step, by each
-- rule, and by a dm.step everywhere; where that is refused the map says so
local function is_prolonged(map, cell, system)
  for _, rule in ipairs(map.rule_list) do
    local job = { map = map, rule = rule, system = system }
    local asked = system.place or own_step.is(job)
    local fine, why = true, nil
    if asked then fine, why = blame.try(cells.try_tangents, job, cell) end
    if not fine then
      map.notes[#map.notes + 1] = "chaos is not told: " .. blame.bare(why):match "^[^\n]*"
      return false
    end
  end
  return system.place ~= nil or (blame.try(prolong.system, system))
end

-- exponents need the prolonged system
local function wants_chaos(map, cell)
  local system = map.system_of(cell)
  if map.options.chaos == false or not is_prolonged(map, cell, system) then return false end
  if map.options.chaos == false or map.options.chaos == nil and is_costly(map, system) then
    return false
  end
  local given = system.given
  if not (given and (given.L or given.H)) or given.control
    or system:structure().linear_in_v then
    return false
  end
  for _, rule in ipairs(map.rules) do
    if has_own_time(rule) or rule:find "^degenerate" then return false end
  end
  return true
end

-- what stopped f(...), as it returns or raises it
local function until_stop(f, ...)
  local fine, stopped = core.until_stop(f, ...)
  if not fine and not blame.is_stop(stopped) then error(stopped, 0) end
  return blame.stopped(stopped)
end

-- all by themselves, or as members of a sweep
local function run_cells(map, all)
  if map.options.journal or not map.options.seconds and ranks.shares(#all) then
    return journal.run(map, all)
  end
  return cells.run(map, all, map.chaos)
end

-- what is called bounded beside no flow is told
local function note_unresolved(map, all)
  local count, why = 0, nil
  for _, cell in ipairs(all) do
    if cell.unresolved and cell.class == cells.NUMBER.bounded then
      count, why = count + 1, why or cell.unresolved
    end
  end
  if count > 0 then
    map.notes[#map.notes + 1] = ("%d of %d cells are bounded beside no resolved flow, so that none "
      .. "of them is called wrong: %s"):format(count, #all, why)
  end
end

-- of many names some are observed
local function note_observed(map)
  local seen = map.beside and map.beside.observed
  if seen and seen.most and seen.most > #seen.names then
    map.notes[#map.notes + 1] = ("of %d coordinates %d are observed, evenly: option 'observe' "
      .. "takes others"):format(seen.most, #seen.names)
  end
end

-- runs the cells; returns what stopped it, if anything
local function fill(map)
  local all = all_cells(map)
  map.count = #all
  local first = given_.first(map)
  given_.check_first(map, first)
  map.notes = given_.notes(map, first)
  map.beside = flows.prepare(map, map.system_of(first))
  note_observed(map)
  map.chaos = wants_chaos(map, first)
  local stopped = run_cells(map, all)
  if not map.started and not stopped then error(map.refusal, 0) end
  borders.find(map)
  if stopped then return stopped end
  given_.note_idle(map)
  note_unresolved(map, all)
  if map.options.refine == false then return nil end
  return borders.refine(map)
end

-- what stopped the map, where its own time did not
local function fill_within(map, seconds)
  if not seconds then return until_stop(fill, map) end
  local start = core.cpu()
  local fine, stopped = core.within(seconds, until_stop, fill, map)
  if core.cpu() - start < seconds then return fine and stopped or not fine and stopped end
  local left = 0
  for _, row in ipairs(map.cells) do
    for _, cell in ipairs(row) do
      left = left + (cell.class == cells.NUMBER["not run"] and 1 or 0)
    end
  end
  if not fine or stopped or left > 0 then
    map.cut = ("after %g s of CPU time: %d of %d cells were not run%s"):format(seconds, left,
      map.count or 0, left == 0 and ", and borders are not refined" or "")
    map.notes[#map.notes + 1] = map.cut
  end
end

-- lays out what is there, should it have been stopped before
local function complete(map)
  if not map.count then map.count = #all_cells(map) end
  if #map.borders < #map.cells then borders.find(map) end
end

M.stability = blame.caller(function(options)
  if type(options) ~= "table" then
    fail("takes a table { system =, q =, v =, rule =, h = {least, largest, count, \"log\"}, steps "
      .. "= }")
  end
  options = renamed(starts.of_system(options))
  given_.check_system(options)
  check_options(options)
  local names = parameters(options)
  local map = new_map(options, names)
  given_.read(map, options, names)
  lay_out(map)
  map.notes = {}
  local start = core.clock()
  local stopped = fill_within(map, options.seconds)
  complete(map)
  map.seconds = core.clock() - start
  if stopped then
    stopped.map, stopped.path = map, map
    stopped.message = map.started
      and "dm.stability: stopped on request; what is there is in the failure's field map"
      or "dm.stability: stopped on request before a cell was run"
    error(stopped, 0)
  end
  return map
end)

core.docs[M.stability] = doc_stability

class.method("dm.system", "stability", function(system, options)
  local given = {}
  for key, value in pairs(type(options) == "table" and options or {}) do given[key] = value end
  given.system = system
  return M.stability(given)
end, [[
system:stability{q=, v= | p=, rule= | rules=, h=, steps= | t=, ...} -> dm.stability_map
The same as dm.stability{system = system, ...}.]])

return M
