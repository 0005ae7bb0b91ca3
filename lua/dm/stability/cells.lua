--- Cells of a stability map: looked at with few rows, with others, longer, beside a resolved flow,
-- with a tangent vector.
local blame = require "dm.base.blame"
local classes = require "dm.stability.classes"
local core = require "dm.core"
local flows = require "dm.stability.flows"
local jobs = require "dm.stability.jobs"
local on_group = require "dm.measure.on_group"
local own_step = require "dm.measure.own_step"
local prolong = require "dm.measure.prolong"
local right = require "dm.stability.right"

local M = { CLASSES = classes.CLASSES, NUMBER = classes.NUMBER, compare = classes.compare }

local CLASSES, NUMBER, finite = classes.CLASSES, classes.NUMBER, classes.finite
local abs, max, sqrt, log = math.abs, math.max, math.sqrt, math.log

local ROWS = 64                 -- rows of a cell by which its class is told
local OTHER_ROWS, LONGER = 389, 4  -- the second look at what drifts: rows, and times the steps
local SIGMA = 5                 -- standard errors of a slope that is one
local REGULAR = 4               -- MEGNO: 2 on a regular orbit, exponent * t / 2 on a chaotic one
-- length of the tangent vector at the start: room to grow; on groups, whose rules multiply momenta
-- by each other, their squares must be numbers at rest, too (bind/run/start_constraints.c)
local TINY, TINY_ON_GROUPS = 1e-120, 1e-90

---- what is watched ----

-- sum of the squares of a constraint
local function constraint_square(given)
  local g = given.constraint
  return function(q, _, t)
    local value, sum = given.params and g(q, t, given.params) or g(q, t), 0
    if type(value) ~= "table" and not blame.try(function() return #value end) then
      return value * value
    end
    for i = 1, #value do sum = sum + value[i] ^ 2 end
    return sum
  end
end

-- columns: _y is what shall not drift, _K half of p . v; the name of the one that is not to drift
local function watch_of(map, system)
  local structure, given, out = system:structure(), system.given, {}
  if system.line then out._K = system.kinetic end
  if not structure.linear_in_v then out._K = function(_, v, _, p) return 0.5 * p:dot(v) end end
  if map.options.watch then
    out._y = map.options.watch
  elseif structure.autonomous and not structure.forced and not given.control then
    out[#out + 1] = "energy"
  else
    out._size = system.place and function(_, _, _, p) return p:dot(p) end
      or function(q, _, _, p) return q:dot(q) + p:dot(p) end
  end
  if map.options.inside then out._inside = map.options.inside end
  if given.constraint then out._constraint = constraint_square(given) end
  return out, out._y and "_y" or out._size and "_size" or "energy"
end

---- the first look ----

-- why cells have no start, where more is known than that L has no value, and on groups why steps
-- have no end: where a chart ends there is no equation that is not solved
local function tell_reasons(job, e, cells)
  local told, any = { no_start = true, no_convergence = job.system.place ~= nil }, false
  for _, cell in ipairs(cells) do any = any or told[cell.code] end
  for _, failure in ipairs(any and e:failures() or {}) do
    if told[failure.code] then
      cells[failure.member].reason = failure.message:match("^[^\n]*"):gsub(
        "^%S*dm/stability/%w+%.lua:%d+: ", "")
    end
  end
end

-- class of cells by the rows of an ensemble
local function tell_classes(job, cells, e, name, watch)
  local sums, status, steps = {}, e.status, e.steps
  sums[name] = e:summary(name)
  for _, column in ipairs { "K", "inside", "constraint" } do
    if watch["_" .. column] then sums[column] = e:summary("_" .. column) end
  end
  local bound = job.system.given.constraint or job.system.given.rolling
  for i, cell in ipairs(cells) do
    cell.steps, cell.code, cell.growth = steps[i], status[i], nil
    local class = status[i] == "stopped" and "not run" or classes.look(job.map, cell, sums, i, name)
    if status[i] ~= "ok" and class ~= "left" then class = classes.of_failure(status[i], bound) end
    if status[i] == "not_finite" and steps[i] == 0 and not finite(sums[name].first[i]) then
      class = "no start"
    end
    cell.class, cell.reason = NUMBER[class], nil
  end
  tell_reasons(job, e, cells)
end

-- class and evidence of cells from one ensemble of `rows` rows; `beside` their flows
local function base_pass(job, cells, rows, beside)
  local system, o, name = job.system, jobs.starts(job, cells), nil
  o.watch, name = watch_of(job.map, system)
  o.rows, o.beside = rows, beside
  local e, stopped = jobs.guarded(job, system, o)
  tell_classes(job, cells, e, name, o.watch)
  if beside then right.tell(job, cells, e) end
  return stopped
end

-- rows that show the class, and what the flow does
local function rows(cell) return max(ROWS, cell.flow.rows) end

local function first_look(job, part)
  if not job.map.beside then return base_pass(job, part, ROWS) end
  flows.attach(job, part)
  return base_pass(job, part, ROWS, right.beside(job, part, rows, true))
end

-- cells that are lost by what their rows show, not by a failure, are looked at with other rows,
-- which no beat of the orbit fits as well
local function other_look(job, all)
  local cells = {}
  for _, cell in ipairs(all) do
    if cell.code == "ok" and (cell.class == NUMBER.off or cell.class == NUMBER["blow-up"]) then
      cells[#cells + 1] = cell
    end
  end
  if #cells > 0 then return base_pass(job, cells, OTHER_ROWS) end
end

-- cells that drift are looked at for LONGER, with other rows: what was a part of a slow
-- oscillation, or a beat of the orbit with its rows, has another slope then; what is damped away
-- does not come back
local function second_look(job, all)
  local cells, given, column = {}, job.map.options, nil
  for _, cell in ipairs(all) do
    if cell.class == NUMBER.drifting then cells[#cells + 1] = cell end
  end
  if #cells == 0 then return end
  local o = jobs.starts(job, cells)
  o.watch, column = watch_of(job.map, job.system)
  o.rows, o.steps, o.t = OTHER_ROWS, given.steps and LONGER * given.steps, given.t
    and LONGER * given.t
  local e, stopped = jobs.guarded(job, job.system, o)
  local s, K = e:summary(column), o.watch._K and e:summary "_K"
  for i, cell in ipairs(cells) do
    local slope = s.slope[i]
    if e.status[i] == "ok" and slope == slope then
      local goes_on = slope * cell.slope > 0.5 * cell.slope ^ 2 and abs(slope) > SIGMA * s.error[i]
      local is_gone = abs(s.mean[i] - s.first[i]) > 0.75 * max(s.largest[i] - s.first[i],
        s.first[i] - s.least[i])
      if not goes_on and not is_gone or classes.is_early(s, K, i) then
        cell.class = NUMBER.bounded
      end
      cell.slope, cell.slope_error = finite(slope), finite(s.error[i])
    end
  end
  return stopped
end

---- chaos ----

-- a tangent vector without symmetry, of this length: of positions, and of velocities or momenta
local function tangent_start(n, tiny)
  local u, w, size = {}, {}, 0
  for i = 1, n do
    u[i], w[i] = 1 / (1 + i), 1 / (2 + i * i)
    size = size + u[i] ^ 2 + w[i] ^ 2
  end
  for i = 1, n do u[i], w[i] = u[i] * tiny / sqrt(size), w[i] * tiny / sqrt(size) end
  return u, w
end

-- ln of the growth beyond which it is no number
local function room(tiny) return math.floor(709 - log(tiny)) end

-- log of its length, as the sum of the sizes of its entries, whose squares would overflow half way
local function growth_of(n)
  return function(x, _, _, p)
    local sum = 0
    for i = 1, n do sum = sum + core.abs(x[n + i]) + core.abs(p[i]) end
    return log(sum) - log(TINY)
  end
end

-- 2n numbers
local function joined(a, b, n)
  local out = {}
  for i = 1, n do out[i], out[n + i] = a[i], b[i] end
  return out
end

-- the same on a group; `beside` of dm.measure.on_group
local function lifted_starts_on_group(job, cells, beside)
  local o, d, t0 = jobs.starts(job, cells), job.system.place.dimension, job.map.options.t0
  local u, dp = tangent_start(d, TINY_ON_GROUPS)
  local p, w = {}, joined(u, dp, d)
  for i = 1, #cells do
    o.q[i], p[i] = beside.start(o.q[i], o.v and o.v[i], o.p and o.p[i], t0, w)
  end
  o.v, o.p, o.rows = nil, p, ROWS
  o.watch = { growth = function(x, _, _, mu)
    local vector, sum = beside.vector(x, mu), 0
    for i = 1, #vector do sum = sum + core.abs(vector[i]) end
    return log(sum) - log(TINY_ON_GROUPS)
  end }
  return o
end

-- starts of the prolonged system: the momentum of u is p, that of q the varied one (dm.prolong)
local function lifted_starts(job, cells)
  local n = job.system.Q.dimension
  local o, u, w = jobs.starts(job, cells), tangent_start(n, TINY)
  for i = 1, #cells do
    o.q[i] = joined(o.q[i], u, n)
    if o.v then o.v[i] = joined(o.v[i], w, n) else o.p[i] = joined(w, o.p[i], n) end
  end
  o.rows, o.watch = ROWS, { growth = growth_of(job.system.Q.dimension) }
  return o
end

-- an ensemble of tangent vectors in the cells, up to the time T where it is given
local function run_tangents(job, cells, T)
  local its, o = job, nil
  if own_step.is(job) then
    error(("tangent vectors of '%s' go with single runs (solver:lyapunov)"):format(
      tostring(job.rule)), 0)
  end
  if job.system.place then
    job.beside = job.beside or on_group.beside(job.system, job.rule)
    its = { map = job.map, rule = job.beside.rule, system = job.beside.system }
    job.lifted, o = its.system, lifted_starts_on_group(job, cells, job.beside)
  else
    job.lifted = job.lifted or prolong.system(job.system, job.vary)
    o = lifted_starts(job, cells)
  end
  o.t = T
  return jobs.guarded(its, job.lifted, o)
end

--- Raises where tangent vectors cannot be run for a step from the start of this cell.
function M.try_tangents(job, cell)
  local least = { h = job.map.h[1], values = cell.values, rule = cell.rule }
  local e = run_tangents(job, { least }, least.h)
  for _, failure in ipairs(e:failures()) do error(failure.message, 0) end
end

-- exponent and MEGNO of cells from one ensemble
local function measure_growth(job, e, cells)
  local s, steps = e:summary "growth", e.steps
  local largest = room(job.system.place and TINY_ON_GROUPS or TINY)
  for i, cell in ipairs(cells) do
    if e.status[i] ~= "stopped" and steps[i] > 0 then
      local rise, megno = s.last[i] - s.first[i], s.megno[i]
      -- a tangent vector that has outgrown all numbers: MEGNO of a straight line is half of its
      -- rise
      if e.status[i] == "not_finite" and cell.code == "ok" and megno ~= megno then
        rise, megno = largest, largest / 2
      end
      cell.exponent, cell.megno = rise / (steps[i] * cell.h), megno
      if cell.megno > REGULAR and cell.exponent > 0 and cell.class ~= NUMBER.drifting then
        cell.class = NUMBER.chaotic
      end
    end
  end
end

--- Do tangent vectors grow exponentially along the run of this cell, up to the time T?
function M.is_chaotic(job, cell, T)
  local e, stopped = run_tangents(job, { cell }, T)
  if stopped then error(stopped, 0) end
  measure_growth(job, e, { cell })
  return cell.class == NUMBER.chaotic and cell.megno > REGULAR and cell.exponent > 0
end

-- growth of a tangent vector in the cells that are not lost
local function chaos_pass(job, all)
  local cells = {}
  for _, cell in ipairs(all) do
    if not CLASSES[cell.class].lost and cell.class ~= NUMBER["not run"] then
      cells[#cells + 1] = cell
    end
  end
  if #cells == 0 then return end
  local e, stopped = run_tangents(job, cells)
  measure_growth(job, e, cells)
  return stopped
end

---- all of it ----

local function all_passes(job, part, chaos)
  local stopped = first_look(job, part) or other_look(job, part) or second_look(job, part)
  if not stopped and chaos then stopped = chaos_pass(job, part) end
  if not stopped and job.map.beside then stopped = right.near_look(job, part) end
  right.tell_wrong(part)
  job.map.started = true
  return stopped
end

-- right or not alone, at many rows
local function right_pass(job, part)
  for _, cell in ipairs(part) do cell.class, cell.is_close = NUMBER.bounded, true end
  flows.attach(job, part)
  local stopped = right.look_closely(job, part)
  for _, cell in ipairs(part) do cell.flow = nil end
  return stopped
end

--- How these cells are run, and every part of them: a cell does not depend on those beside it.
function M.plan(map, cells, chaos)
  return jobs.plan(map, cells, { passes = all_passes, chaos = chaos,
    lifted = chaos and lifted_starts or nil })
end

--- Run cells { number =, rule = (its number), h =, values = { name = } } of a plan and fill in
-- their class and its evidence; what a stop on request was, or nothing.
M.run_planned = jobs.run

--- The same of cells that are a plan of their own.
function M.run(map, cells, chaos) return jobs.run(map, cells, M.plan(map, cells, chaos)) end

--- Whether cells are right, and no more.
function M.run_right(map, cells)
  return jobs.run(map, cells, jobs.plan(map, cells, { passes = right_pass }))
end

return M
