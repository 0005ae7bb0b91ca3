--- Cells of a stability map: run by ensembles, and told apart by what their rows show.
local core = require "dm.core"
local prolong = require "dm.prolong"

local M = {}

local abs, max, min, sqrt, log, huge = math.abs, math.max, math.min, math.sqrt, math.log, math.huge

local ROWS, MEMBERS = 64, 2048  -- rows of a cell; members of one ensemble
local OTHER_ROWS, LONGER = 389, 4  -- the second look at what drifts: rows, and times the steps
local FEWEST = 8                -- steps that show anything
local GROWTH = 1e3              -- energy error of the last quarter over that of the first: it grows without bound
local JUMP = 10                 -- the same where it has only gone elsewhere
local STILL = 0.02              -- change of the energy, in parts of its error, of what flew off
local SIGMA = 5                 -- standard errors of a slope that is one
local REGULAR = 4               -- MEGNO: 2 on a regular orbit, exponent * t / 2 on a chaotic one
local TIE = 1e-6                -- |g| of a constraint that is lost
local TINY = 1e-120             -- length of the tangent vector at the start: room to grow
local ROOM = 985                -- by e to this power

--- Classes: name, whether the motion is lost, what it says.
M.CLASSES = {
  { name = "bounded", text = "the energy error stays in its band" },
  { name = "drifting", text = "the energy error grows steadily" },
  { name = "chaotic", text = "neighbouring orbits separate exponentially" },
  { name = "off", lost = true, text = "the energy has gone far elsewhere, and stays there: another motion" },
  { name = "blow-up", lost = true, text = "the energy error grows without bound" },
  { name = "left", lost = true, text = "the state left the region that was given as inside" },
  { name = "no convergence", lost = true, text = "the step equation could not be solved" },
  { name = "constraint lost", lost = true, text = "the constraints lost rank or are not kept" },
  { name = "no start", lost = true, text = "L has no value at the start" },
  { name = "not run", text = "stopped before" },
}
local NUMBER = {}
for i, class in ipairs(M.CLASSES) do NUMBER[class.name] = i end

---- what is watched ----

-- sum of the squares of a constraint
local function tie_of(given)
  local g = given.constraint
  return function(q, _, t)
    local value, sum = given.params and g(q, t, given.params) or g(q, t), 0
    if type(value) ~= "table" and not pcall(function() return #value end) then return value * value end
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
  if given.constraint then out.tie = tie_of(given) end
  return out, out.y and "y" or out.size and "size" or "energy"
end

---- one cell ----

local FAILED = { not_finite = "blow-up", no_convergence = "no convergence", singular = "no convergence", stopped = "not run", no_start = "no start" }

local function of_failure(code, tied)
  if code == "singular" and tied then return "constraint lost" end
  return FAILED[code] or "no convergence"
end

local SHARE = 0.2  -- of the kinetic energy: an error below it is one of motion that grows by itself, off the top of a hill

-- the energy error of the last quarter is no small part of the kinetic energy then
local function is_much(s, K, i) return not (K and s.late[i] < SHARE * K.late[i]) end

-- growth of the error of y, which only an instability has: from the first to the last quarter
local function is_growing(s, i, kinetic, free)
  local early, late = s.early[i], s.late[i]
  if late ~= late or s.largest[i] == huge then return true end
  if free then return late > GROWTH ^ 2 * max(early, abs(s.first[i])) and late > 0 end
  return late > GROWTH * early and late > kinetic and late > 1e-7 * abs(s.first[i])
end

-- the energy has gone elsewhere in the middle of the run, and stays there
local function has_jumped(s, i, kinetic)
  return kinetic > 0 and s.late[i] > JUMP * s.early[i] and s.late[i] > kinetic and s.late[i] > 1e-6 * abs(s.first[i])
end

-- the same from early on: at no row of the second half is the energy near its start, and nearly all of the motion is that error
local function left_at_once(s, i, K)
  local error = max(s.largest[i] - s.first[i], s.first[i] - s.least[i])
  local nearest = s.nearest[i]
  if not K or not (2 * error > abs(K.first[i])) or not (nearest < huge) then return false end
  -- it flew off: nothing acts on it any more, and the energy does not change
  if nearest > 0.9 * error and s.span[i] < STILL * error then return true end
  return error > abs(K.first[i]) and 2 * error > K.largest[i] and 2 * nearest > error
end

local function is_drifting(map, s, i, kinetic, T)
  local slope = abs(s.slope[i])
  return slope > SIGMA * s.error[i] and slope * T > map.drift * max(kinetic, 1e-6 * abs(s.first[i]))
end

local function finite(x) return x == x and abs(x) < huge and x or nil end

-- the class by what the rows show; sums: summaries by column
local function look(map, cell, sums, i, name)
  local s, K = sums[name], sums.K
  local kinetic = K and abs(K.first[i]) + K.early[i] or 0
  cell.kinetic = finite(K and max(abs(K.least[i]), K.largest[i]) or 0)
  cell.error = finite(max(s.largest[i] - s.first[i], s.first[i] - s.least[i]))
  cell.slope, cell.slope_error = finite(s.slope[i]), finite(s.error[i])
  if sums.inside and not (sums.inside.least[i] > 0) then return "left" end
  if sums.tie and not (sqrt(sums.tie.largest[i]) < TIE) then return "constraint lost" end
  if cell.steps < FEWEST then return "bounded" end
  if is_growing(s, i, kinetic, name == "size") and (name ~= "energy" or is_much(s, K, i)) then
    if s.early[i] > 0 then cell.growth = finite((s.late[i] / s.early[i]) ^ (1 / (0.75 * max(cell.steps, 1)))) end
    return "blow-up"
  end
  if name == "size" then return "bounded" end
  if is_drifting(map, s, i, kinetic, cell.steps * cell.h) then return "drifting" end
  if name == "energy" and (has_jumped(s, i, kinetic) and is_much(s, K, i) or left_at_once(s, i, K)) then return "off" end
  return "bounded"
end

---- many cells of one system and rule ----

-- positions, velocities or momenta, steps
local function starts(map, cells)
  local second = map.start.v and "v" or "p"
  local out = { q = {}, h = {}, [second] = {} }
  for i, cell in ipairs(cells) do
    out.q[i], out[second][i], out.h[i] = map.start.q(cell), map.start[second](cell), cell.h
  end
  return out
end

local function ensemble(map, system, rule, cells, more)
  local o = { members = #cells, steps = map.options.steps, t = map.options.t, t0 = map.options.t0, threads = map.options.threads,
    project = map.options.project }
  for key, value in pairs(more) do o[key] = value end
  return system:solver({ rule = rule, h = 1, newton = map.options.newton, backend = map.options.backend, sums = map.options.sums }):ensemble(o)
end

-- runs and keeps what a stop on request leaves
local function guarded(run)
  local fine, result = pcall(run)
  if fine then return result end
  if type(result) ~= "string" and result.code == "stopped" and result.path then return result.path, result end
  error(result, 0)
end

-- class and evidence of cells from one ensemble of `rows` rows
local function base_pass(map, system, rule, cells, rows)
  local watch, name = watch_of(map, system)
  local o = starts(map, cells)
  o.watch, o.rows = watch, rows
  local e, stopped = guarded(function() return ensemble(map, system, rule, cells, o) end)
  local sums, status, steps = {}, e.status, e.steps
  for _, column in ipairs { name, watch.K and "K" or name, watch.inside and "inside" or name, watch.tie and "tie" or name } do
    sums[column] = sums[column] or e:summary(column)
  end
  local tied = system.given.constraint ~= nil or system.given.rolling ~= nil
  for i, cell in ipairs(cells) do
    cell.steps, cell.code, cell.growth = steps[i], status[i], nil
    local class = status[i] == "stopped" and "not run" or look(map, cell, sums, i, name)
    if status[i] ~= "ok" and class ~= "left" then class = of_failure(status[i], tied) end
    if status[i] == "not_finite" and steps[i] == 0 and not finite(sums[name].first[i]) then class = "no start" end
    cell.class = NUMBER[class]
  end
  return stopped
end

-- cells that are lost by what their rows show, not by a failure, are looked at with other rows, which no beat of the orbit fits as well
local function other_look(map, system, rule, all)
  local cells = {}
  for _, cell in ipairs(all) do
    if cell.code == "ok" and (cell.class == NUMBER.off or cell.class == NUMBER["blow-up"]) then cells[#cells + 1] = cell end
  end
  if #cells > 0 then return base_pass(map, system, rule, cells, OTHER_ROWS) end
end

-- cells that drift are looked at for LONGER, with other rows: what was a part of a slow oscillation, or a beat of the orbit with its
-- rows, has another slope then; what is damped away does not come back
local function second_look(map, system, rule, all)
  local cells, column = {}, nil
  for _, cell in ipairs(all) do
    if cell.class == NUMBER.drifting then cells[#cells + 1] = cell end
  end
  if #cells == 0 then return end
  local o = starts(map, cells)
  o.watch, column = watch_of(map, system)
  o.rows, o.steps, o.t = OTHER_ROWS, map.options.steps and LONGER * map.options.steps, map.options.t and LONGER * map.options.t
  local e, stopped = guarded(function() return ensemble(map, system, rule, cells, o) end)
  local s = e:summary(column)
  for i, cell in ipairs(cells) do
    local slope = s.slope[i]
    if e.status[i] == "ok" and slope == slope then
      local goes_on = slope * cell.slope > 0.5 * cell.slope ^ 2 and abs(slope) > SIGMA * s.error[i]
      local is_gone = abs(s.mean[i] - s.first[i]) > 0.75 * max(s.largest[i] - s.first[i], s.first[i] - s.least[i])
      if not goes_on and not is_gone then cell.class = NUMBER.bounded end
      cell.slope, cell.slope_error = finite(slope), finite(s.error[i])
    end
  end
  return stopped
end

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

-- growth of a tangent vector in the cells that are not lost
local function chaos_pass(map, system, rule, all)
  local n, cells = system.Q.dimension, {}
  for _, cell in ipairs(all) do
    if not M.CLASSES[cell.class].lost and cell.class ~= NUMBER["not run"] then cells[#cells + 1] = cell end
  end
  if #cells == 0 then return end
  local u, w = tangent_start(n)
  local given = starts(map, cells)
  local o = { q = {}, v = given.v and {}, p = given.p and {} }
  for i = 1, #cells do  -- the momentum of u is p, that of q the varied one (dm.prolong)
    o.q[i] = prolong.joined(given.q[i], u)
    if o.v then o.v[i] = prolong.joined(given.v[i], w) else o.p[i] = prolong.joined(w, given.p[i]) end
  end
  o.h, o.rows, o.watch = given.h, ROWS, { growth = growth_of(n) }
  local e, stopped = guarded(function() return ensemble(map, prolong.system(system), rule, cells, o) end)
  local s, steps = e:summary "growth", e.steps
  for i, cell in ipairs(cells) do
    if e.status[i] ~= "stopped" and steps[i] > 0 then
      local rise, megno = s.last[i] - s.first[i], s.megno[i]
      -- a tangent vector that has outgrown all numbers: MEGNO of a straight line is half of its rise
      if e.status[i] == "not_finite" and cell.code == "ok" and megno ~= megno then rise, megno = ROOM, ROOM / 2 end
      cell.exponent, cell.megno = rise / (steps[i] * cell.h), megno
      if cell.megno > REGULAR and cell.exponent > 0 and cell.class ~= NUMBER.drifting then cell.class = NUMBER.chaotic end
    end
  end
  return stopped
end

local FAR = 1e3  -- energy error over the kinetic energy of the same motion with a smaller step

--- A growth that ended early, where a nonlinear force holds it, shows beside a bounded cell of smaller step: its energy error is far above the
-- kinetic energy there, which grows with the duration squared at most.
function M.compare(cell, smaller)
  local class = M.CLASSES[cell.class].name
  if M.CLASSES[cell.class].lost or class == "not run" or not (cell.error and smaller.kinetic and smaller.kinetic > 0) then return end
  local ratio = max(1, cell.steps * cell.h / (max(smaller.steps, 1) * smaller.h))
  if cell.error > FAR * smaller.kinetic * ratio ^ 2 then cell.class = NUMBER.off end
end

local function all_passes(map, system, part, chaos)
  local rule = map.rule_list[part[1].rule]
  local stopped = base_pass(map, system, rule, part, ROWS) or other_look(map, system, rule, part) or second_look(map, system, rule, part)
  if not stopped and chaos then stopped = chaos_pass(map, system, rule, part) end
  map.started = true
  return stopped
end

local REFUSALS = 64  -- starts that are refused, with none that is not, before that is an error of all

-- a start that is refused (L is infinite there, say) is that of one cell: the others run without it
local function run_part(map, system, part, chaos)
  local fine, result = pcall(all_passes, map, system, part, chaos)
  if fine then return result end
  map.refused = (map.refused or 0) + 1
  if type(result) ~= "string" or not map.started and map.refused > REFUSALS or map.count == 1 then error(result, 0) end
  if #part == 1 then
    part[1].class, part[1].code, part[1].steps, map.refusal = NUMBER["no start"], "no_start", 0, result
    return nil
  end
  local half = #part // 2
  return run_part(map, system, table.move(part, 1, half, 1, {}), chaos) or run_part(map, system, table.move(part, half + 1, #part, 1, {}), chaos)
end

-- cells of one group in parts that fit into memory
local function run_group(map, group, chaos)
  table.sort(group, function(a, b)
    if a.h ~= b.h then return a.h < b.h end
    return a.number < b.number
  end)
  local system = map.system_of(group[1])
  for from = 1, #group, MEMBERS do
    local stopped = run_part(map, system, table.move(group, from, math.min(from + MEMBERS - 1, #group), 1, {}), chaos)
    if stopped then return stopped end
  end
end

--- Run cells { number =, rule = (its number), h =, values = { name = } } and fill in their class and its evidence; what a stop
-- on request was, or nothing.
function M.run(map, cells, chaos)
  local groups, order = {}, {}
  for _, cell in ipairs(cells) do
    local key = cell.rule .. "/" .. map.key_of(cell)
    if not groups[key] then
      groups[key] = {}
      order[#order + 1] = key
    end
    local group = groups[key]
    group[#group + 1] = cell
    cell.class = NUMBER["not run"]
  end
  for _, key in ipairs(order) do
    local stopped = run_group(map, groups[key], chaos)
    if stopped then return stopped end
  end
end

M.NUMBER = NUMBER

return M
