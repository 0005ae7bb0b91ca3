--- Ensembles of cells: those of one rule and different parameters together where one kernel serves
-- them.
local apart = require "dm.mpi.apart"
local blame = require "dm.base.blame"
local classes = require "dm.stability.classes"
local prolong = require "dm.measure.prolong"

local M = {}

local NUMBER, min = classes.NUMBER, math.min

local MEMBERS, LINES = 2048, 64  -- of one ensemble; of fields on lines, whose rows are kept

---- one ensemble ----

-- A job: { map =, rule =, system =, vary = names of the parameters that differ from cell to cell,
-- or nil }

-- positions, velocities or momenta, steps, parameters
function M.starts(job, cells)
  local second = job.map.start.v and "v" or "p"
  local out, q, other = { q = {}, h = {}, [second] = {} }, job.map.start.q, job.map.start[second]
  for i, cell in ipairs(cells) do
    out.q[i], out[second][i], out.h[i] = q(cell), other(cell), cell.h
  end
  for _, name in ipairs(job.vary or {}) do
    local values = {}
    for i, cell in ipairs(cells) do values[i] = cell.values[name] end
    out.vary = out.vary or {}
    out.vary[name] = values
  end
  return out
end

local SMALL = 5e4  -- steps of all cells that are done sooner than a second thread has its kernels

local function is_small(o)
  local steps = o.steps and o.steps * #o.h or 0
  for i = 1, o.steps and 0 or #o.h do steps = steps + o.t / o.h[i] end
  return steps < SMALL
end

local function ensemble(job, system, o)
  local given = job.map.options
  o.members, o.t0, o.project = #o.h, given.t0, given.project
  o.gaps = o.watch and true -- a class of its own
  if not o.steps and not o.t then o.steps, o.t = given.steps, given.t end
  o.threads = given.threads or is_small(o) and 1 or nil
  local solver = system:solver { rule = job.rule, h = 1, newton = given.newton,
    backend = given.backend, sums = given.sums }
  return apart.run(solver.ensemble, solver, o)
end

-- runs and keeps what a stop on request leaves; was there a system for every cell where one was
-- meant to serve all?
function M.guarded(job, system, o)
  local fine, e = pcall(ensemble, job, system, o)
  local stopped = not fine and e
  if stopped and not (type(e) ~= "string" and e.code == "stopped" and e.path) then error(e, 0) end
  if stopped then e = stopped.path end
  if o.vary and e.systems > 1 then job.split = true end
  return e, stopped or nil
end

---- jobs ----

-- starts that are refused, with none that is not, before that is an error of all
local REFUSALS = 64

-- cells that have no start, and why
local function refuse(map, cells, why)
  map.refusal = why
  local text = tostring(why):match("^[^\n]*"):gsub("^%S*dm/stability/%w+%.lua:%d+: ", "")
  for _, cell in ipairs(cells) do
    cell.class, cell.code, cell.steps, cell.reason = NUMBER["no start"], "no_start", 0, text
  end
end

-- a start that is refused (L is infinite there, say) is that of one cell: the others run without it
local function run_part(job, part, plan)
  local map = job.map
  local fine, result = blame.try(plan.passes, job, part, plan.chaos)
  if fine then return result end
  map.refused = (map.refused or 0) + 1
  if type(result) ~= "string" or not map.started and map.refused > REFUSALS or map.count == 1 then
    error(result, 0)
  end
  if #part == 1 then return refuse(map, part, result) end
  local half = #part // 2
  return run_part(job, table.move(part, 1, half, 1, {}), plan)
    or run_part(job, table.move(part, half + 1, #part, 1, {}), plan)
end

-- lists of cells by what f says of them, in the order in which that is said first
function M.grouped(cells, f)
  local by, order = {}, {}
  for _, cell in ipairs(cells) do
    local key = f(cell)
    if not by[key] then
      by[key] = {}
      order[#order + 1] = by[key]
    end
    local list = by[key]
    list[#list + 1] = cell
  end
  return order
end

-- in the order of their steps: neighbours of one step go side by side
local function by_step(cells)
  local groups, out = M.grouped(cells, function(cell) return cell.h end), {}
  table.sort(groups, function(a, b) return a[1].h < b[1].h end)
  for _, group in ipairs(groups) do table.move(group, 1, #group, #out + 1, out) end
  return out
end

-- cells of one job in parts that fit into memory; what stopped it, or the cells that are left when
-- it is seen to need a system for each
local function run_job(job, cells, plan)
  local members = job.system.line and LINES or MEMBERS
  cells = by_step(cells)
  for from = 1, #cells, members do
    local last = min(from + members - 1, #cells)
    local stopped = run_part(job, table.move(cells, from, last, 1, {}), plan)
    if stopped then return stopped end
    if job.split then return nil, table.move(cells, last + 1, #cells, 1, {}) end
  end
end

-- what decides how cells are watched and stepped, beside the numbers of their parameters: cells
-- that agree in it may have one kernel
local function family_of(map, cell)
  local key = map.key_of(cell)
  if not map.base or #map.used == 0 then return key end
  if not map.families[key] then
    local fine, s = blame.try(function() return map.system_of(cell):structure() end)
    map.families[key] = fine and ("%s %s %s %s")
      :format(s.separable, s.autonomous, s.linear_in_v, s.constant_mass) or key
  end
  return map.families[key]
end

-- does one kernel serve two cells of different parameters, and their tangent vectors?
local function is_shared(map, rule, cells, plan)
  local job = { map = map, rule = rule, vary = map.used }
  local fine, e = blame.try(function()
    job.system = map.system_of(cells[1])
    local o = M.starts(job, cells)
    o.steps = 1
    local first = ensemble(job, job.system, o)
    if not plan.lifted or first.systems > 1 then return first end
    o = plan.lifted(job, cells)
    o.steps = 1
    return ensemble(job, prolong.system(job.system, map.used), o)
  end)
  return fine and e.systems == 1
end

-- cells of one family of several systems for which one kernel does
local function are_shared(map, rule, cells, plan)
  local key = map.key_of(cells[1])
  for _, other in ipairs(cells) do
    if map.key_of(other) ~= key then return is_shared(map, rule, { cells[1], other }, plan) end
  end
  return false
end

---- plans ----

-- What flows of a group of cells may take (dm.stability.flows) is told by all of it, whatever part
-- of the group is run: its least step, and a cell of each flow, by which rules are chosen.
local function note_group(group, map, cell)
  local values = map.beside and map.beside.flow_key(cell) or ""
  group.finest = min(group.finest, cell.h)
  if not group.seen[values] then
    group.seen[values], group.cells[#group.cells + 1] = true, cell
  end
end

local function group_at(plan, rule, key)
  local name = rule .. "/" .. key
  plan.groups[name] = plan.groups[name] or { finest = math.huge, cells = {}, seen = {} }
  return plan.groups[name]
end

--- How cells are run: which of them share a kernel, and what their groups are. what: { passes(job,
-- part, chaos), chaos, lifted: starts of tangent vectors where these are followed }.
function M.plan(map, cells, what)
  local plan = { passes = what.passes, chaos = what.chaos, lifted = what.lifted, shared = {},
    groups = {} }
  for _, of_rule in ipairs(M.grouped(cells, function(cell) return cell.rule end)) do
    local rule, shared = of_rule[1].rule, {}
    plan.shared[rule] = shared
    for _, family in ipairs(M.grouped(of_rule, function(cell) return family_of(map, cell) end)) do
      local key = family_of(map, family[1])
      shared[key] = are_shared(map, map.rule_list[rule], family, plan)
      for _, cell in ipairs(family) do
        note_group(group_at(plan, rule, map.key_of(cell)), map, cell)
        if shared[key] then note_group(group_at(plan, rule, "all of " .. key), map, cell) end
      end
    end
  end
  return plan
end

-- cells of one system, or (shared) of one family; after all in systems of their own what is left
-- where one kernel does not do
local function run_group(map, cells, plan, shared)
  local first = cells[1]
  local rule, fine, system = map.rule_list[first.rule], blame.try(map.system_of, first)
  if not fine then return refuse(map, cells, system) end
  local key = shared and "all of " .. family_of(map, first) or map.key_of(first)
  local stopped, left = run_job({ map = map, rule = rule, system = system, vary = shared
    and map.used or nil, group = group_at(plan, first.rule, key) }, cells, plan)
  for _, group in ipairs(not stopped and left and M.grouped(left, map.key_of) or {}) do
    stopped = stopped or run_group(map, group, plan)
  end
  return stopped
end

--- Run cells { number =, rule = (its number), h =, values = { name = } }, some or all of those of a
-- plan, and fill in their class and its evidence; what a stop on request was, or nothing.
function M.run(map, cells, plan)
  for _, cell in ipairs(cells) do cell.class = NUMBER["not run"] end
  for _, of_rule in ipairs(M.grouped(cells, function(cell) return cell.rule end)) do
    local shared = plan.shared[of_rule[1].rule]
    local function group_of(cell)
      local family = family_of(map, cell)
      return shared[family] and family or map.key_of(cell)
    end
    for _, group in ipairs(M.grouped(of_rule, group_of)) do
      local stopped = run_group(map, group, plan, shared[family_of(map, group[1])])
      if stopped then return stopped end
    end
  end
end

return M
