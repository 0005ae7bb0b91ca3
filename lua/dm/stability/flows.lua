--- Resolved flows that cells of a stability map are compared with: two unlike rules with unlike
-- steps, both halved until they agree along the whole way.
local blame = require "dm.base.blame"
local jobs = require "dm.stability.jobs"
local line_flows = require "dm.stability.line_flows"
local observables = require "dm.stability.observables"

local M = {}

local max, min, ceil, huge = math.max, math.min, math.ceil, math.huge

-- Unlike rules in the order of preference, with their steps in parts of those of a level. The first
-- one makes the flow, the second confirms it. Splittings step many members at once for next to
-- nothing where L separates; where they do not apply they are the last to be tried.
local SEPARABLE = { { "kahan-li(8)", 1 }, { "gauss(6)", 0.61 }, { "rk8", 1.37 },
  { "blanes-moan(6)", 1.61 } }
-- Fields with values on a sphere have compositions of rattle alone.
local CONSTRAINED = { { "kahan-li(8, rattle)", 1 }, { "gauss(6)", 0.61 }, { "lobatto(6)", 1.13 },
  { "gauss(8)", 0.73 }, { "kahan-li(6, rattle)", 1.37 }, { "yoshida(6, rattle)", 1.61 } }
local GENERAL = { { "gauss(6)", 1 }, { "rk8", 1.37 }, { "lobatto(6)", 1.13 },
  { "kahan-li(8)", 1.61 }, { "gauss(8)", 0.73 }, { "degenerate(4)", 1.21 },
  { "degenerate(3)", 1.43 } }

local FIRST = 64          -- steps of the first level
local MOST, ALL = 2 ^ 16, 2 ^ 20  -- steps that a flow may take, and all of a part of the map
local FINEST = 4          -- or as many times those of the finest cell
local ROOM = 2 ^ 22       -- numbers of rows at once
-- of the accuracy: two flows that agree so well are one; of fields on lines, whose flows are dear
local FINER, ON_LINES = 1e-3, 1e-2
local NEAR = 30           -- times that: the next level, 256 times better, will
local ROUND_OFF = 1e-11   -- of the numbers observed
local LEAST_OFF = 1e-300  -- what is at rest at 0 has neither size nor range
local SHARE = 1e-3        -- of the range: what rows of cells may miss between them

---- rules ----

local function can_step(job, rule, cell, T)
  local start = job.map.start
  local fine, why = blame.try(function()
    job.system:solver({ rule = rule, h = T / 2 ^ 20 }):run { q = start.q(cell),
      v = start.v and start.v(cell), p = start.p and start.p(cell), steps = 1,
      t0 = job.map.options.t0, project = job.map.options.project }
  end)
  return fine, why
end

-- two rules that step this cell, or nil, and why
local function find_pair(job, cell, T)
  local measured, out, why = {}, {}, nil
  for _, rule in ipairs(job.map.rules) do measured[rule] = true end
  local s = job.system:structure()
  local splits = s.separable and s.constant_mass and s.rolling == 0 and not s.forced
  local bound = s.constraints > 0 or job.system.field and job.system.field.sphere
  local rules = not splits and GENERAL or bound and CONSTRAINED or SEPARABLE
  for _, one in ipairs(rules) do
    if not measured[one[1]] and #out < 2 then
      local fine, refused = can_step(job, one[1], cell, T)
      if fine then out[#out + 1] = one else why = why or refused end
    end
  end
  if #out == 2 then return out end
  return nil, "there are no two rules for it: " .. blame.bare(why):match "^[^\n]*"
end

local TRIALS = 8 -- cells of a group that may have no start before there are no rules for it

--- Two rules that step the system up to the time T, none of them among those of the map, each with
-- its steps in parts of those of a level; or nil, and why. They are those of the whole group of the
-- job, where it has one.
function M.rules_of(job, cell, T)
  if job.system.line then return line_flows.rules_of(job, cell) end
  local kept, cells = job.group or job, job.group and job.group.cells or { cell }
  local stride, why = max(1, #cells // TRIALS), kept.no_pair
  for k = 1, not (kept.pair or why) and #cells or 0, stride do
    local refused
    kept.pair, refused = find_pair(job, cells[k], T)
    if kept.pair then break end
    why = why or refused
  end
  kept.no_pair = why
  return kept.pair, why
end

---- one level: all flows with so many steps ----

-- an ensemble of flows by one of the rules of a pair
local function run(job, flows, one, level)
  local pseudo, map, T = {}, job.map, job.map.options.t
  local steps = ceil(one[2] * level)
  if job.system.line then return line_flows.run(job, flows, one[1], steps) end
  for i, flow in ipairs(flows) do
    pseudo[i] = { values = flow.values, rule = flow.rule, h = T / steps }
  end
  local its = { map = map, rule = one[1], system = job.system, vary = job.vary }
  local o = jobs.starts(its, pseudo)
  o.every, o.watch, o.t = 1, map.beside.observed.watch, T
  local e, stopped = jobs.guarded(its, its.system, o)
  if stopped then error(stopped, 0) end
  return e
end

-- are all values of a field on a mesh observed?
local function takes_all(map, system)
  return system.field ~= nil and not system.line and map.options.observe == nil
end

-- values of a field have one range, that of the one that changes most
local function share_range(range)
  local most = 0
  for k = 1, #range do most = max(most, range[k]) end
  for k = 1, #range do range[k] = most end
end

-- ranges of the observables, and how far two flows may be apart to be one
local function measure(job, flow, e, i)
  local map = job.map
  local accuracy, scale = map.beside.accuracy, 0
  flow.range, flow.tolerance, flow.bound, flow.near = {}, {}, {}, {}
  for k, column in ipairs(map.beside.observed.columns) do
    local first
    flow.range[k], first = e:range(i, column)
    scale = max(scale, math.abs(first) + flow.range[k])
  end
  if takes_all(map, job.system) then share_range(flow.range) end
  local slack = ROUND_OFF * scale + LEAST_OFF
  local fine = max(map.beside.finer * accuracy, min(0.1 * accuracy, 1e-10))
  for k, range in ipairs(flow.range) do
    flow.tolerance[k] = fine * range + slack
    flow.near[k] = NEAR * flow.tolerance[k]
    flow.bound[k] = accuracy * range + slack + flow.tolerance[k]
  end
end

-- the time up to which member i of e is the flow of another run, within these bounds
local function agreed(map, e, i, flow, bounds)
  if e.status[i] ~= "ok" or not flow.e then return -huge end
  local b = map.beside
  local _, beyond = e:departure(i, flow.e, flow.i, b.observed.columns, b.horizon * (1 + 1e-14),
    bounds)
  return beyond
end

-- The first rule of the pair, beside its level before: flows that hardly changed, and the others.
local function refine(job, flows, one, level)
  local map, e, near, far = job.map, run(job, flows, one, level), {}, {}
  for i, flow in ipairs(flows) do
    local fine = e.status[i] == "ok"
    if fine then measure(job, flow, e, i) end
    flow.parted = flow.horizon
    flow.horizon = fine and agreed(map, e, i, flow, flow.near) or -huge
    flow.e, flow.i, flow.steps = fine and e or nil, i, ceil(one[2] * level)
    local list = flow.horizon == huge and near or far
    list[#list + 1] = flow
  end
  return near, far
end

-- The second rule: flows that it agrees with are settled; the others are added to `far`.
local function confirm(job, near, far, one, level)
  if #near == 0 then return end
  local map, e = job.map, run(job, near, one, level)
  for i, flow in ipairs(near) do
    flow.horizon = min(flow.horizon, agreed(map, e, i, flow, flow.tolerance))
    if flow.horizon == huge then
      flow.horizon = map.beside.horizon
      flow.rows = flow.steps // flow.e:stride(flow.i, map.beside.observed.columns, SHARE)
    else
      far[#far + 1] = flow
    end
  end
end

-- all flows of a job in parts that fit into memory; those that are left
local function take_level(job, flows, pair, level)
  local left, width = {}, 1 + #job.map.beside.observed.columns
  local at_once = max(1, ROOM // ceil(2 * level * width))
  for from = 1, #flows, at_once do
    local some = table.move(flows, from, min(from + at_once - 1, #flows), 1, {})
    local near, far = refine(job, some, pair[1], level)
    confirm(job, near, far, pair[2], level)
    table.move(far, 1, #far, #left + 1, left)
  end
  return left
end

---- flows of cells ----

--- What a map needs to compare: accuracy, observed, t0, horizon, flows so far by flow_key(cell).
-- Nothing where nothing is to be compared.
function M.prepare(map, system)
  local accuracy = observables.accuracy(map.options)
  if not accuracy then return nil end
  if system.given.control then
    map.notes[#map.notes + 1] = "the control is held over every step, so that the step is part of "
      .. "the system: nothing is called wrong"
    return nil
  end
  local t0 = map.options.t0 or 0
  local keys = setmetatable({}, { __mode = "k" }) -- of values, which cells of a row share
  local function flow_key(cell)
    local values, text = cell.values, {}
    if keys[values] then return keys[values] end
    for i, name in ipairs(map.names) do text[i] = ("%a"):format(values[name]) end
    keys[values] = table.concat(text, "/")
    return keys[values]
  end
  return { accuracy = accuracy, finer = system.line and ON_LINES or FINER, t0 = t0,
    observed = observables.read(map.options, system), horizon = t0 + map.options.t, flows = {},
    flow_key = flow_key }
end

--- Of a field on a mesh values are observed, and how many there are its size decides: from now on
-- those of this system.
function M.observe(map, system)
  local beside = map.beside
  if beside and takes_all(map, system) and beside.observed.of ~= system.Q.dimension then
    beside.observed = observables.read(map.options, system)
  end
end

local LEAST = 0.01  -- of the duration: what is resolved for less is not resolved

-- Where flows part on the way, as chaotic ones do, what both rules agree on is kept.
local function give_up(job, flows, pair, level, why)
  local map, some = job.map, {}
  for _, flow in ipairs(flows) do
    local resolved = flow.e and flow.horizon > map.beside.t0 + LEAST * map.options.t
    if resolved then some[#some + 1] = flow else flow.e, flow.why = nil, why end
  end
  if #some == 0 then return end
  local e = run(job, some, pair[2], level)
  for i, flow in ipairs(some) do
    flow.horizon = min(flow.horizon, agreed(map, e, i, flow, flow.near), map.beside.horizon)
    flow.rows, flow.why = flow.steps, why
    if not (flow.horizon > map.beside.t0 + LEAST * map.options.t) then flow.e = nil end
  end
end

-- steps that a flow may take, by the group that the cells are of
local function most_of(job, flows, part)
  if job.system.line then return line_flows.most_of(job, flows[1]) end
  local group, finest = job.group, huge
  if group then
    finest = group.finest
  else
    for _, cell in ipairs(part) do finest = min(finest, cell.h) end
  end
  local count = group and #group.cells or #flows
  return max(FINEST * job.map.options.t / finest, min(MOST, ALL / count), 16 * FIRST)
end

local function resolve(job, flows, part)
  local pair, why = M.rules_of(job, flows[1], job.map.options.t)
  if not pair then
    for _, flow in ipairs(flows) do flow.why = why end
    return
  end
  local level, left, most = FIRST, flows, most_of(job, flows, part)
  while #left > 0 and level <= most do
    left = take_level(job, left, pair, level)
    level = 2 * level
  end
  if #left == 0 then return end
  give_up(job, left, pair, level / 2, ("%s and %s do not agree on it with up to %d steps")
    :format(pair[1][1], pair[2][1], level // 2))
end

-- what is raised for one flow (L has no value at its start) is not told of the others
local function resolve_each(job, flows, part)
  local fine, why = blame.try(resolve, job, flows, part)
  if fine then return end
  if type(why) ~= "string" then error(why, 0) end
  for _, flow in ipairs(flows) do flow.e, flow.horizon = nil, nil end
  if #flows == 1 then
    flows[1].why = blame.bare(why):match "^[^\n]*"
    return
  end
  local half = #flows // 2
  resolve_each(job, table.move(flows, 1, half, 1, {}), part)
  resolve_each(job, table.move(flows, half + 1, #flows, 1, {}), part)
end

-- those of cells before are forgotten where they take much room
local function make_room(map)
  local rows = 0
  for _, flow in pairs(map.beside.flows) do rows = rows + (flow.e and flow.steps or 0) end
  if rows * (1 + #map.beside.observed.columns) > 4 * ROOM then map.beside.flows = {} end
end

--- Give every cell of a part the flow that it is compared with, as cell.flow: { e, i (its rows are
-- those of member i of the ensemble e), horizon (the time up to which it is known), range, bound
-- (of the observables), rows (that show it) }, or { why } without e.
function M.attach(job, part)
  local map, todo = job.map, {}
  if not map.beside then return end
  M.observe(map, job.system)
  make_room(map)
  for _, cell in ipairs(part) do
    local key = map.beside.flow_key(cell)
    if not map.beside.flows[key] then
      map.beside.flows[key] = { values = cell.values, rule = cell.rule, T = map.options.t }
      todo[#todo + 1] = map.beside.flows[key]
    end
    cell.flow = map.beside.flows[key]
  end
  if #todo == 0 then return end
  resolve_each(job, todo, part)
end

--- Steps of the first rule that show the flow of a cell as well as they could.
function M.steps_of(job, cell)
  M.attach(job, { cell })
  local flow = cell.flow
  cell.flow = nil
  return flow.steps
end

return M
