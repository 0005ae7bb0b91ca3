--- Cells of a stability map: run by ensembles, cells of one rule and different parameters together
-- where one kernel serves them.
local blame = require "dm.base.blame"
local classes = require "dm.stability.classes"
local core = require "dm.core"
local prolong = require "dm.measure.prolong"

local M = { CLASSES = classes.CLASSES, NUMBER = classes.NUMBER, compare = classes.compare }

local CLASSES, NUMBER, finite = classes.CLASSES, classes.NUMBER, classes.finite
local abs, max, min, sqrt, log = math.abs, math.max, math.min, math.sqrt, math.log

local ROWS, MEMBERS = 64, 2048  -- rows of a cell; members of one ensemble
local OTHER_ROWS, LONGER = 389, 4  -- the second look at what drifts: rows, and times the steps
local SIGMA = 5                 -- standard errors of a slope that is one
local REGULAR = 4               -- MEGNO: 2 on a regular orbit, exponent * t / 2 on a chaotic one
local TINY = 1e-120             -- length of the tangent vector at the start: room to grow
local ROOM = 985                -- by e to this power

---- what is watched ----

-- sum of the squares of a constraint
local function constraint_square(given)
  local g = given.constraint
  return function(q, _, t)
    local value, sum = given.params and g(q, t, given.params) or g(q, t), 0
    if type(value) ~= "table" and not pcall(function() return #value end) then
      return value * value
    end
    for i = 1, #value do sum = sum + value[i] ^ 2 end
    return sum
  end
end

-- columns: y is what shall not drift, K half of p . v
local function watch_of(map, system)
  local structure, given, out = system:structure(), system.given, {}
  if not structure.linear_in_v then out.K = function(_, v, _, p) return 0.5 * p:dot(v) end end
  if map.options.watch then
    out.y = map.options.watch
  elseif structure.autonomous and not structure.forced and not given.control then
    out[#out + 1] = "energy"
  else
    out.size = function(q, _, _, p) return q:dot(q) + p:dot(p) end
  end
  if map.options.inside then out.inside = map.options.inside end
  if given.constraint then out.constraint = constraint_square(given) end
  return out, out.y and "y" or out.size and "size" or "energy"
end

---- ensembles of cells ----

-- A job: { map =, rule =, system =, vary = names of the parameters that differ from cell to cell,
-- or nil }

-- positions, velocities or momenta, steps, parameters
local function starts(job, cells)
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
  if not o.steps and not o.t then o.steps, o.t = given.steps, given.t end
  o.threads = given.threads or is_small(o) and 1 or nil
  return system:solver({ rule = job.rule, h = 1, newton = given.newton, backend = given.backend,
    sums = given.sums }):ensemble(o)
end

-- runs and keeps what a stop on request leaves; was there a system for every cell where one was
-- meant to serve all?
local function guarded(job, system, o)
  local fine, e = pcall(ensemble, job, system, o)
  local stopped = not fine and e
  if stopped and not (type(e) ~= "string" and e.code == "stopped" and e.path) then error(e, 0) end
  if stopped then e = stopped.path end
  if o.vary and e.systems > 1 then job.split = true end
  return e, stopped or nil
end

-- why cells have no start, where more is known than that L has no value
local function tell_reasons(e, cells)
  local any = false
  for _, cell in ipairs(cells) do any = any or cell.code == "no_start" end
  for _, failure in ipairs(any and e:failures() or {}) do
    if failure.code == "no_start" then
      cells[failure.member].reason = failure.message:match("^[^\n]*"):gsub(
        "^%S*dm/stability/%w+%.lua:%d+: ", "")
    end
  end
end

-- class and evidence of cells from one ensemble of `rows` rows
local function base_pass(job, cells, rows)
  local system, o = job.system, starts(job, cells)
  local watch, name = watch_of(job.map, system)
  o.watch, o.rows = watch, rows
  local e, stopped = guarded(job, system, o)
  local sums, status, steps = {}, e.status, e.steps
  sums[name] = e:summary(name)
  for _, column in ipairs { "K", "inside", "constraint" } do
    if watch[column] then sums[column] = e:summary(column) end
  end
  local bound = system.given.constraint or system.given.rolling
  for i, cell in ipairs(cells) do
    cell.steps, cell.code, cell.growth = steps[i], status[i], nil
    local class = status[i] == "stopped" and "not run" or classes.look(job.map, cell, sums, i, name)
    if status[i] ~= "ok" and class ~= "left" then class = classes.of_failure(status[i], bound) end
    if status[i] == "not_finite" and steps[i] == 0 and not finite(sums[name].first[i]) then
      class = "no start"
    end
    cell.class, cell.reason = NUMBER[class], nil
  end
  tell_reasons(e, cells)
  return stopped
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
  local o = starts(job, cells)
  o.watch, column = watch_of(job.map, job.system)
  o.rows, o.steps, o.t = OTHER_ROWS, given.steps and LONGER * given.steps, given.t
    and LONGER * given.t
  local e, stopped = guarded(job, job.system, o)
  local s, K = e:summary(column), o.watch.K and e:summary "K"
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

-- a tangent vector without symmetry: of positions, and of velocities or momenta
local function tangent_start(n)
  local u, w, size = {}, {}, 0
  for i = 1, n do
    u[i], w[i] = 1 / (1 + i), 1 / (2 + i * i)
    size = size + u[i] ^ 2 + w[i] ^ 2
  end
  for i = 1, n do u[i], w[i] = u[i] * TINY / sqrt(size), w[i] * TINY / sqrt(size) end
  return u, w
end

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

-- starts of the prolonged system: the momentum of u is p, that of q the varied one (dm.prolong)
local function lifted_starts(job, cells)
  local n = job.system.Q.dimension
  local o, u, w = starts(job, cells), tangent_start(n)
  for i = 1, #cells do
    o.q[i] = joined(o.q[i], u, n)
    if o.v then o.v[i] = joined(o.v[i], w, n) else o.p[i] = joined(w, o.p[i], n) end
  end
  o.rows, o.watch = ROWS, { growth = growth_of(job.system.Q.dimension) }
  return o
end

-- exponent and MEGNO of cells from one ensemble
local function measure_growth(e, cells)
  local s, steps = e:summary "growth", e.steps
  for i, cell in ipairs(cells) do
    if e.status[i] ~= "stopped" and steps[i] > 0 then
      local rise, megno = s.last[i] - s.first[i], s.megno[i]
      -- a tangent vector that has outgrown all numbers: MEGNO of a straight line is half of its
      -- rise
      if e.status[i] == "not_finite" and cell.code == "ok" and megno ~= megno then
        rise, megno = ROOM, ROOM / 2
      end
      cell.exponent, cell.megno = rise / (steps[i] * cell.h), megno
      if cell.megno > REGULAR and cell.exponent > 0 and cell.class ~= NUMBER.drifting then
        cell.class = NUMBER.chaotic
      end
    end
  end
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
  job.lifted = job.lifted or prolong.system(job.system, job.vary)
  local e, stopped = guarded(job, job.lifted, lifted_starts(job, cells))
  measure_growth(e, cells)
  return stopped
end

---- jobs ----

local function all_passes(job, part, chaos)
  local stopped = base_pass(job, part, ROWS) or other_look(job, part) or second_look(job, part)
  if not stopped and chaos then stopped = chaos_pass(job, part) end
  job.map.started = true
  return stopped
end

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
local function run_part(job, part, chaos)
  local map = job.map
  local fine, result = pcall(all_passes, job, part, chaos)
  if fine then return result end
  map.refused = (map.refused or 0) + 1
  if type(result) ~= "string" or not map.started and map.refused > REFUSALS or map.count == 1 then
    error(result, 0)
  end
  if #part == 1 then return refuse(map, part, result) end
  local half = #part // 2
  return run_part(job, table.move(part, 1, half, 1, {}), chaos)
    or run_part(job, table.move(part, half + 1, #part, 1, {}), chaos)
end

-- lists of cells by what f says of them, in the order in which that is said first
local function grouped(cells, f)
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
  local groups, out = grouped(cells, function(cell) return cell.h end), {}
  table.sort(groups, function(a, b) return a[1].h < b[1].h end)
  for _, group in ipairs(groups) do table.move(group, 1, #group, #out + 1, out) end
  return out
end

-- cells of one job in parts that fit into memory; what stopped it, or the cells that are left when
-- it is seen to need a system for each
local function run_job(job, cells, chaos)
  cells = by_step(cells)
  for from = 1, #cells, MEMBERS do
    local last = min(from + MEMBERS - 1, #cells)
    local stopped = run_part(job, table.move(cells, from, last, 1, {}), chaos)
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
    local fine, s = pcall(function() return map.system_of(cell):structure() end)
    if not fine and blame.is_stop(s) then error(s, 0) end
    map.families[key] = fine and ("%s %s %s %s")
      :format(s.separable, s.autonomous, s.linear_in_v, s.constant_mass) or key
  end
  return map.families[key]
end

-- does one kernel serve two cells of different parameters, and their tangent vectors?
local function is_shared(map, rule, cells, chaos)
  local job = { map = map, rule = rule, vary = map.used }
  local fine, e = pcall(function()
    job.system = map.system_of(cells[1])
    local o = starts(job, cells)
    o.steps = 1
    local first = ensemble(job, job.system, o)
    if not chaos or first.systems > 1 then return first end
    o = lifted_starts(job, cells)
    o.steps = 1
    return ensemble(job, prolong.system(job.system, map.used), o)
  end)
  if not fine and blame.is_stop(e) then error(e, 0) end
  return fine and e.systems == 1
end

-- cells of one family of several systems for which one kernel does
local function are_shared(map, rule, cells, chaos)
  local key = map.key_of(cells[1])
  for _, other in ipairs(cells) do
    if map.key_of(other) ~= key then return is_shared(map, rule, { cells[1], other }, chaos) end
  end
  return false
end

-- cells of one system, or (shared) of one family; after all in systems of their own what is left
-- where one kernel does not do
local function run_group(map, cells, chaos, shared)
  local rule, fine, system = map.rule_list[cells[1].rule], pcall(map.system_of, cells[1])
  if not fine and blame.is_stop(system) then error(system, 0) end
  if not fine then return refuse(map, cells, system) end
  local stopped, left = run_job({ map = map, rule = rule, system = system, vary = shared
    and map.used or nil }, cells, chaos)
  for _, group in ipairs(not stopped and left and grouped(left, map.key_of) or {}) do
    stopped = stopped or run_group(map, group, chaos)
  end
  return stopped
end

--- Run cells { number =, rule = (its number), h =, values = { name = } } and fill in their class
-- and its evidence; what a stop on request was, or nothing.
function M.run(map, cells, chaos)
  local shared = {}
  for _, cell in ipairs(cells) do cell.class = NUMBER["not run"] end
  for _, of_rule in ipairs(grouped(cells, function(cell) return cell.rule end)) do
    local rule = of_rule[1].rule
    for _, family in ipairs(grouped(of_rule, function(cell) return family_of(map, cell) end)) do
      shared[family_of(map, family[1])] = are_shared(map, map.rule_list[rule], family, chaos)
    end
    local function group_of(cell)
      local family = family_of(map, cell)
      return shared[family] and family or map.key_of(cell)
    end
    for _, group in ipairs(grouped(of_rule, group_of)) do
      local stopped = run_group(map, group, chaos, shared[family_of(map, group[1])])
      if stopped then return stopped end
    end
  end
end

return M
