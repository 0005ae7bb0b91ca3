--- One cell of a stability map, looked at step by step when it is asked for: how far off, how late
-- or early, what makes it chaotic.
local blame = require "dm.base.blame"
local cells = require "dm.stability.cells"
local flows = require "dm.stability.flows"
local jobs = require "dm.stability.jobs"
local right = require "dm.stability.right"
local shift = require "dm.chart.shift"

local M = {}

local min, huge = math.min, math.huge

local FINE = 1e-6     -- accuracy of the flow that a cell is measured by
local MOST = 2 ^ 20   -- rows

---- the run, at every step, and its flow ----

local function job_of(map, cell)
  return { map = map, rule = map.rule_list[cell.rule], system = map.system_of(cell) }
end

-- the flow of a cell, resolved better than for its class unless it is one of a line; nothing where
-- it is not known up to the end
local function fine_flow(map, cell)
  flows.observe(map, map.system_of(cell))
  local kept, own = map.beside, {}
  for key, value in pairs(kept) do own[key] = value end
  local is_line = map.system_of(cell).line ~= nil
  own.accuracy, own.flows = is_line and kept.accuracy or min(FINE, kept.accuracy), {}
  map.beside = own
  local twin = { values = cell.values, rule = cell.rule, h = cell.h }
  local fine, why = pcall(flows.attach, job_of(map, cell), { twin })
  map.beside = kept
  if not fine then error(why, 0) end
  local flow = twin.flow
  return flow.e and flow.horizon >= own.horizon and flow or nil
end

-- by how much time the run is ahead at the end
local function shift_of(path, flow, names, horizon)
  local reference = flow.e:path(flow.i)
  local run, its = { t = path.t, columns = {} }, { t = reference.t, columns = {}, range = {} }
  for k, name in ipairs(names) do
    run.columns[k], its.columns[k] = path:column(name), reference:column(name)
    its.range[k] = flow.range[k] > 0 and flow.range[k] or huge
  end
  local found = shift.follow(run, its, horizon)
  return found and found.shift
end

-- what is off, at every step, and by how much time
local function look(map, cell)
  local flow = fine_flow(map, cell)
  if not flow then return end
  local job = job_of(map, cell)
  local o = jobs.starts(job, { cell })
  cell.flow = flow
  o.rows = min(cell.steps, MOST)
  o.beside = right.beside(job, { cell }, function() return o.rows end)
  o.watch = o.beside.watch
  local e, stopped = jobs.guarded(job, job.system, o)
  cell.flow = nil
  if stopped then error(stopped, 0) end
  if e.status[1] ~= "ok" then return end
  cell.flow = flow
  right.tell(job, { cell }, e)
  cell.flow = nil
  if job.system.line then return end
  cell.phase = shift_of(e:path(1), flow, map.beside.observed.columns, map.beside.horizon)
end

---- chaos ----

-- does the flow itself separate its neighbours, or the step alone?
local function cause_of(map, cell)
  local job = job_of(map, cell)
  local T = map.options.t
  local pair = flows.rules_of(job, cell, T)
  if not pair then return nil end
  local steps = flows.steps_of(job, cell)
  local twin = { values = cell.values, rule = cell.rule, h = T / steps, class = cell.class,
    code = "ok" }
  local its = { map = map, rule = pair[1][1], system = job.system }
  local fine, chaotic = blame.try(cells.is_chaotic, its, twin, T)
  return fine and (chaotic and "flow" or "step") or nil
end

--- Fill in what a cell is asked for: off, observable, range, hidden, phase, cause.
function M.look(map, cell)
  if cell.looked then return end
  local class = cells.CLASSES[cell.class]
  local kept = cell.is_right
  if map.beside and not class.lost and class.name ~= "not run" then look(map, cell) end
  cell.is_right = kept
  if map.beside and class.name == "chaotic" then cell.cause = cause_of(map, cell) end
  cell.looked = true
end

return M
