--- One cell of a stability map, looked at step by step when it is asked for: how far off, how late
-- or early, what makes it chaotic.
local blame = require "dm.base.blame"
local cells = require "dm.stability.cells"
local flows = require "dm.stability.flows"
local jobs = require "dm.stability.jobs"

local M = {}

local abs, max, min, floor, huge = math.abs, math.max, math.min, math.floor, math.huge

local FINE = 1e-6     -- accuracy of the flow that a cell is measured by
local MOST = 2 ^ 20   -- rows
local WINDOWS, ROWS = 32, 64  -- stretches of the run that shifts are followed through, their rows
local TRIES = 8       -- of Gauss and Newton
local KNOWN = 0.5     -- of the size of a signal: what a shift must explain to be one

---- the run, at every step, and its flow ----

local function job_of(map, cell)
  return { map = map, rule = map.rule_list[cell.rule], system = map.system_of(cell) }
end

-- the flow of a cell, resolved better than for its class; nothing where it is not known up to the
-- end
local function fine_flow(map, cell)
  local kept, own = map.beside, {}
  for key, value in pairs(kept) do own[key] = value end
  own.accuracy, own.flows = min(FINE, kept.accuracy), {}
  map.beside = own
  local twin = { values = cell.values, rule = cell.rule, h = cell.h }
  local fine, why = pcall(flows.attach, job_of(map, cell), { twin })
  map.beside = kept
  if not fine then error(why, 0) end
  local flow = twin.flow
  return flow.e and flow.horizon >= own.horizon and flow or nil
end

---- the shift in time ----

-- values and rates of the columns of a flow at a time: a polynomial through six rows
local function reader(flow, columns)
  local path, list = flow.e:path(flow.i), {}
  for k, name in ipairs(columns) do list[k] = path:column(name) end
  local t, count = path.t, #path
  local t0, dt = t[1], t[2] - t[1]
  local nodes = min(8, count)
  return function(time)
    local place = (time - t0) / dt
    local first = floor(max(0, min(count - nodes, floor(place) - nodes / 2 + 1)))
    local s, y, rate = place - first, {}, {}
    for k = 1, #list do y[k], rate[k] = 0, 0 end
    for i = 0, nodes - 1 do
      local w, slope = 1, 0
      for j = 0, nodes - 1 do
        if j ~= i then
          slope = (slope * (s - j) + w) / (i - j)
          w = w * (s - j) / (i - j)
        end
      end
      for k = 1, #list do
        local x = list[k][first + i + 1]
        y[k], rate[k] = y[k] + w * x, rate[k] + slope * x / dt
      end
    end
    return y, rate
  end, t[count]
end

-- One step of Gauss and Newton for the shift a + b (t - middle) of the rows of a window; also what
-- it leaves of the squares, and their sum.
local function improve(w, read, last, a, b)
  local Saa, Sab, Sbb, ra, rb, left, all, used = 0, 0, 0, 0, 0, 0, 0, 0
  for i, t in ipairs(w.t) do
    local x = t - w.middle
    local at = t + a + b * x
    if at <= last and at >= w.t0 then
      local y, rate = read(at)
      used = used + 1
      for k = 1, #y do
        local miss, g = (w.y[i][k] - y[k]) / w.range[k], rate[k] / w.range[k]
        Saa, Sab, Sbb = Saa + g * g, Sab + g * g * x, Sbb + g * g * x * x
        ra, rb, left, all = ra + g * miss, rb + g * miss * x, left + miss ^ 2,
          all + ((w.y[i][k] - w.mean[k]) / w.range[k]) ^ 2
      end
    end
  end
  local det = Saa * Sbb - Sab ^ 2
  if used < 4 or not (abs(det) > 1e-14 * Saa * Sbb) then return nil end
  return a + (ra * Sbb - rb * Sab) / det, b + (rb * Saa - ra * Sab) / det, left, all
end

-- the shift in a window, from the one before
local function fit(w, read, last, a, b)
  local left, all
  for _ = 1, TRIES do
    local next_a, next_b, its_left, its_all = improve(w, read, last, a, b)
    if not next_a or not (abs(next_b) < 2) then return nil end
    a, b, left, all = next_a, next_b, its_left, its_all
  end
  return a, b, left <= KNOWN * all
end

-- rows of a path in the times (from, to]
local function window_of(path, columns, range, from, to)
  local t, w = path.t, { t = {}, y = {}, range = range, mean = {}, middle = 0.5 * (from + to),
    t0 = path.t[1] }
  local first, count = 1, #t
  while first <= count and t[first] <= from do first = first + 1 end
  local final = first
  while final < count and t[final + 1] <= to do final = final + 1 end
  local stride = max(1, (final - first) // ROWS)
  for i = first, min(final, count), stride do
    local y = {}
    for k, list in ipairs(columns) do
      y[k] = list[i]
      w.mean[k] = (w.mean[k] or 0) + y[k]
    end
    w.t[#w.t + 1], w.y[#w.y + 1] = t[i], y
  end
  for k in ipairs(columns) do w.mean[k] = w.mean[k] / max(1, #w.t) end
  return w
end

-- By how much the run is ahead at its end, followed from its start, where nothing is shifted;
-- nothing where no shift explains what it does.
local function shift_of(path, flow, names, horizon)
  local columns, range = {}, {}
  for k, name in ipairs(names) do
    columns[k], range[k] = path:column(name), max(flow.range[k], 1e-300)
    if not (flow.range[k] > 0) then range[k] = huge end
  end
  local read, last = reader(flow, names)
  local t0 = path.t[1]
  local length = (horizon - t0) / WINDOWS
  local a, b, middle, known = 0, 0, t0, false
  for k = 1, WINDOWS do
    local w = window_of(path, columns, range, t0 + (k - 1) * length, t0 + k * length)
    if #w.t >= 4 then
      local its_a, its_b, fine = fit(w, read, last, a + b * (w.middle - middle), b)
      if its_a then a, b, middle, known = its_a, its_b, w.middle, fine end
    end
  end
  return known and a + b * (horizon - middle) or nil
end

-- what is off, at every step, and by how much time
local function look(map, cell)
  local flow = fine_flow(map, cell)
  if not flow then return end
  local job = job_of(map, cell)
  local o = jobs.starts(job, { cell })
  o.watch, o.rows = cells.beside(map, job.system), min(cell.steps, MOST)
  local e, stopped = jobs.guarded(job, job.system, o)
  if stopped then error(stopped, 0) end
  if e.status[1] ~= "ok" then return end
  cell.flow = flow
  cells.tell_right(job, { cell }, e, o.watch)
  cell.flow = nil
  cell.phase = shift_of(e:path(1), flow, map.beside.observed.columns, map.beside.horizon)
end

---- chaos ----

-- does the flow itself separate its neighbours, or the step alone?
local function cause_of(map, cell)
  local job = job_of(map, cell)
  local T = map.options.t or cell.steps * cell.h
  local pair = flows.rules_of(job, cell, T)
  if not pair then return nil end
  local steps = flows.steps_of(job, cell) or 8 * cell.steps
  local twin = { values = cell.values, rule = cell.rule, h = T / steps, class = cell.class,
    code = "ok" }
  local its = { map = map, rule = pair[1][1], system = job.system }
  local fine, chaotic = pcall(cells.is_chaotic, its, twin, T)
  if not fine and blame.is_stop(chaotic) then error(chaotic, 0) end
  return fine and (chaotic and "flow" or "step") or nil
end

--- Fill in what a cell is asked for: off, observable, range, hidden, phase, cause.
function M.look(map, cell)
  if cell.looked then return end
  local class = cells.CLASSES[cell.class]
  local kept = cell.is_right
  if map.beside and not class.lost and class.name ~= "not run" then look(map, cell) end
  cell.is_right = kept
  if class.name == "chaotic" then cell.cause = cause_of(map, cell) end
  cell.looked = true
end

return M
