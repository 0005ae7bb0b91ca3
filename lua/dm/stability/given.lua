--- What a map is given: a system and a start, as they are or as functions of the parameters.
local blame = require "dm.base.blame"
local axes = require "dm.stability.axes"
local core = require "dm.core"
local lines = require "dm.stability.lines"
local params = require "dm.base.params"
local rule_alone = require "dm.base.rule_alone"
local starts = require "dm.base.start"

local M = {}

local fail = require "dm.base.options".failing "dm.stability"

-- a copy of the system with these numbers among its params
local function with_params(system, values, names)
  if system.line then return lines.with_params(system, values, names) end
  local given, own, field = {}, {}, system.field
  for key, value in pairs(field and field.options or system.given) do given[key] = value end
  for key, value in pairs(system.params) do own[key] = value end
  for _, name in ipairs(names) do own[name] = values[name] end
  given.params = own
  return field and field.mesh:field(given) or core.system(given)
end

local function is_system(x)
  if type(x) == "table" and x.line then return true end
  return type(x) == "userdata" and getmetatable(x) and getmetatable(x).__name == "dm.system"
end

-- Raises where a parameter does not reach the functions that read it, and no start: all rows would
-- be one. One that is read nowhere is noted when the map is made.
local function check_reach(system, used, by_starts)
  for _, name in ipairs(used) do
    local names = by_starts[name] and {} or { name }
    local unread = system.line and names or params.unread(system, system.params, names)
    local _, why, somewhere = params.out_of_reach(system.line or system, names, unread)
    if somewhere then
      fail("parameter '%s' changes %s: %s", name, #unread > 0 and "nothing" or "a part only", why)
    end
  end
end

-- system_of(cell), and the parameters that it depends on; map.base: the system whose params these
-- are
local function make_systems(map, system, names)
  system = lines.wrapped(system)
  if type(system) == "function" then
    local make, used = axes.bind("system", system, names)
    return function(cell)
      local made = lines.wrapped(make(cell.values))
      if not is_system(made) then
        fail("'system' is a function that must return a dm.system (got %s)", type(made))
      end
      return made
    end, used
  end
  if not is_system(system) then
    fail("the system is missing: system = dm.system{...}, or a function of the parameters that "
      .. "returns one (a discrete Lagrangian has one step only)")
  end
  local used = {}
  for _, name in ipairs(names) do
    if type(system.params) == "table" and type(system.params[name]) == "number" then
      used[#used + 1] = name
    end
  end
  map.base = system
  if #used == 0 then return function() return system end, used end
  return function(cell) return with_params(system, cell.values, used) end, used
end

local function text_of(values)
  local text = {}
  for name, x in pairs(values) do text[#text + 1] = ("%s = %.6g"):format(name, x) end
  table.sort(text)
  return table.concat(text, ", ")
end

-- is it a field that is looked at, whose start may be a function of the position?
local function is_field(map, names)
  local values = {}
  for _, name in ipairs(names) do values[name] = map[name][1] end
  local fine, system = blame.try(map.system_of, { values = values })
  return fine and system.field ~= nil
end

M.NO_START = "the start is missing: q, and v or p, as numbers or as functions of the parameters"

-- reduced systems (dm.euler_poincare) begin at the identity
local function at_identity(map)
  return function(cell)
    local place = map.system_of(cell).place
    if not (place and place.reduced) then fail(M.NO_START) end
    return place.kit.identity()
  end
end

local function make_start(map, what, given, names, uses)
  local function list(x, cell) return starts.list(x, map.base or map.system_of(cell), what) end
  local of_place = type(given) == "function" and not axes.takes(given, names)
    and is_field(map, names)
  local all = (type(given) ~= "function" or of_place) and map.base and list(given)
  if all then return function() return all end end
  if type(given) ~= "function" or of_place then
    return function(cell) return list(given, cell) end
  end
  local f, used = axes.bind(what, given, names)
  for _, name in ipairs(used) do uses[name] = true end
  return function(cell)
    local given_there = f(cell.values)
    if given_there == nil then
      fail("the function '%s' returns nothing at %s", what, text_of(cell.values))
    end
    return list(given_there, cell)
  end
end

-- a text for every combination of these parameters, kept with the values of a cell
local function make_key(used)
  local keys = setmetatable({}, { __mode = "k" })
  return function(cell)
    local key = keys[cell.values]
    if key then return key end
    local text = {}
    for i, name in ipairs(used) do text[i] = ("%a"):format(cell.values[name]) end
    key = table.concat(text, "/")
    keys[cell.values] = key
    return key
  end
end

-- what a start is before it is numbers of one system: as it is, or what the function of parameters
-- gives
local function make_given(map, what, given, names)
  local of_parameters = type(given) == "function"
    and not (not axes.takes(given, names) and is_field(map, names))
  if not of_parameters then return function() return given end end
  local f = axes.bind(what, given, names)
  return function(cell) return f(cell.values) end
end

--- Raises where maps are not made of what is given: of boxes (dm.multisymplectic), flows, waves.
function M.check_system(options)
  local system = options.system or options[1]
  local meta = type(system) ~= "string" and getmetatable(system)
  local kind = type(meta) == "table" and meta.__name
  if kind and not is_system(lines.wrapped(system)) then
    fail("maps are of a dm.system, of fields on meshes (mesh:field) or on lines (dm.field), or of "
      .. "a function of the parameters that returns one (got %s)", kind)
  end
end

--- map.system_of(cell), map.key_of(cell) (cells of one key have one system), map.used (the
-- parameters that it depends on), map.start.q, .v, .p of a cell, and map.start.given.q, .v: what
-- was given for them.
function M.read(map, options, names)
  local of, used = make_systems(map, options.system or options[1], names)
  local uses, last, kept = {}, nil, nil
  map.key_of, map.used, map.families = make_key(used), used, {}
  map.system_of = function(cell)
    local key = map.key_of(cell)
    if key ~= last then last, kept = key, of(cell) end
    return kept
  end
  map.start = { q = options.q and make_start(map, "q", options.q, names, uses)
    or at_identity(map), v = options.v
    and make_start(map, "v", options.v, names, uses),
    p = options.p and make_start(map, "p", options.p, names, uses),
    given = { q = make_given(map, "q", options.q, names),
      v = options.v and make_given(map, "v", options.v, names) } }
  if map.base and #used > 0 then check_reach(map.base, used, uses) end
  for _, name in ipairs(used) do uses[name] = true end
  for _, name in ipairs(names) do
    if not uses[name] then
      fail("parameter '%s' changes nothing: 'system', 'q', 'v' or 'p' must be a function with an "
        .. "argument %s, or the system have it among its params", name, name)
    end
  end
end

--- The first cell that has a system; raises what the very first raises where none has.
function M.first(map)
  local why
  for _, row in ipairs(map.cells) do
    local fine, text = blame.try(map.system_of, row[1])
    if fine then return row[1] end
    why = why or text
  end
  error(why, 0)
end

--- Look at the first cell: a start that needs no velocity where L is linear in v; misspelled rules.
function M.check_first(map, cell)
  local system = map.system_of(cell)
  if system.line and not map.start.p then
    map.start.v = map.start.v or function(c) return core.zeros(map.system_of(c).Q.dimension) end
  end
  if not map.start.v and not map.start.p then
    if not system:structure().linear_in_v then
      fail("the start is missing: give v (velocity) or p (momentum) beside q")
    end
    local rest = core.zeros(system.Q.dimension)
    map.start.p = function(c) return map.system_of(c):legendre(map.start.q(c), rest) end
  end
  -- a misspelled one is told here
  for _, rule in ipairs(map.rule_list) do
    if type(rule) == "string" and rule:find "^%s*avi%s*$" then
      fail("rule '%s' has steps of its own in every cell, and no ensembles: its report tells which "
        .. "are beyond their limit", tostring(rule))
    end
    rule_alone(system, rule)
  end
end

-- does nothing move in a step from the start of the cell? Rates below are round-off
local STILL = 1e-13
local function rests(map, cell)
  local h = map.h[1]
  local path = map.system_of(cell):solver({ rule = map.rule_list[1], h = h }):run {
    q = map.start.q(cell), v = map.start.v and map.start.v(cell),
    p = map.start.p and map.start.p(cell), steps = 1, t0 = map.options.t0,
    project = map.options.project }
  for _, columns in ipairs { path.q, path.p } do
    local before, after = columns[1], columns[2]
    if not ((after - before):norm() <= STILL * h * (1 + before:norm())) then return false end
  end
  return true
end

--- What a reader of the map should know of its start and of its axes, as sentences.
function M.notes(map, cell)
  local notes, h = {}, map.options.h
  local fine, at_rest = blame.try(rests, map, cell)
  if fine and at_rest then
    notes[1] = "the start is an equilibrium: where nothing moves no instability shows; displace "
      .. "it, or give it a small velocity"
  end
  for _, name in ipairs { "h", table.unpack(map.names) } do
    h = map.options[name]
    -- 0.5, 4, 12 is more of a count than 1, 4, 12
    local far = type(h) == "table" and #h == 3 and (h[1] % 1 ~= 0 and 2 or 5)
    if far and math.type(h[3]) == "integer" and h[3] >= 5 and h[3] > far * h[2] then
      notes[#notes + 1] = (
        "%s = {%g, %g, %d} is a list of three numbers; the range is written {%g, %g, %d, \"log\"} "
        .. "or \"linear\""):format(
        name, h[1], h[2], h[3], h[1], h[2], h[3])
    end
  end
  return notes
end

-- rows that belong together but for this parameter, and those that differ from the first of these
local function differs(map, name)
  local first = {}
  for i, row in ipairs(map.rows) do
    local key = row.rule
    for other, x in pairs(row.values) do key = other == name and key or key .. "/" .. x end
    local before = first[key]
    first[key] = before or i
    for j, cell in ipairs(before and map.cells[i] or {}) do
      local twin = map.cells[before][j]
      if cell.class ~= twin.class or cell.error ~= twin.error or cell.steps ~= twin.steps
        or cell.slope ~= twin.slope then
        return true
      end
    end
  end
  return false
end

--- Note the parameters that change no cell: L may not use them.
function M.note_idle(map)
  for _, axis in ipairs(map.row_axes) do
    if #axis > 1 and not differs(map, axis.name) then
      map.notes[#map.notes + 1] =
        ("'%s' changes no cell, to the last digit: does anything here depend on it?")
        :format(axis.name)
    end
  end
end

return M
