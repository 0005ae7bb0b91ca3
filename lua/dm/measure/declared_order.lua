--- Is the order that a dm.step declares the one that it has? Measured for a rule and a system from
-- the start of the first run, and where that start does not tell (an equilibrium, a step that is
-- exact there) or says less, from two near it. Ends of 2 steps of H, 4 of H/2 ... are compared; H
-- is that of the run, or longer where differences would be round-off. A rule is refused where two
-- starts say less than it declares and none says as much, at steps that resolve the motion: the
-- tangent map of a step is near the identity there, so that no stiffness hides the order.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"

local M = {}

local abs, max, min, log = math.abs, math.max, math.min, math.log

local HALVINGS = 9
local ENOUGH = 0.4     -- an order is had where the measured one is not less by more
local SETTLED = 0.1    -- two measured orders that differ by less are the limit
local ROUND = 1e-11    -- of the size: differences below tell nothing
local PLAIN = 1e-6     -- differences to begin with, where they are less by the step of the run
local LONGER, MOST = 8, 12  -- the step for them, and how often it is made longer
local SHORTER, FINER = 2, 12  -- how often steps are made 2^12 times shorter where nothing is told
local RESOLVED = 0.5   -- of the spectral radius of D - 1, D the tangent map of a step
local NEAR = 0.1       -- how far a near start is off, of the size of the start
local OFF = 1e-8       -- of an element from its group

-- what was found of a rule on a system, a text
local measured = setmetatable({}, { __mode = "k" })

local function note(rule, system, text)
  local of_rule = measured[rule] or setmetatable({}, { __mode = "k" })
  measured[rule], of_rule[system] = of_rule, text
end

--- What is known of the order of a rule on a system.
function M.said(rule, system)
  return measured[rule] and measured[rule][system] or "declared, to be measured in the first run"
end

--- A rule whose order is known by other means on this system is not measured.
function M.trust(rule, system) note(rule, system, "declared") end

---- ends of short runs ----

-- q and p behind `steps` steps of h, and a scale of each of their entries
local function finish(solver, start, h, steps)
  local system = solver.system
  local path = system:solver { rule = solver.rule, h = h }
    :run { q = start.q, v = start.v, p = start.p, a = start.a, t0 = start.t0,
      project = start.project, steps = steps, every = steps }
  local own, out, scale = system.place, {}, {}
  local n = own and own.size or system.Q.dimension
  local function block(first, count)
    local size = 0
    for i = first, first + count - 1 do
      local column = path:column(path.columns[1 + i])
      out[i], size = column[#column], max(size, abs(column[1]), abs(column[#column]))
    end
    for i = first, first + count - 1 do scale[i] = size end
  end
  block(1, n)
  block(n + 1, own and own.dimension or n)
  return out, scale
end

-- the largest difference of two ends, of their scales
local function apart(a, b, scale)
  local worst = 0
  for i = 1, #a do
    if scale[i] > 0 then worst = max(worst, abs(a[i] - b[i]) / scale[i]) end
  end
  return worst
end

-- the distance of the ends of 2 steps of h, and of 4 of h/2
local function first_difference(solver, start, h)
  local a, scale = finish(solver, start, h, 2)
  return apart(a, finish(solver, start, h / 2, 4), scale)
end

-- a step whose first difference is no round-off, the least of h, 8 h, 64 h ...; nothing where there
-- is none
local function telling_step(solver, start, h)
  local best
  for _ = 0, MOST do
    local fine, d = blame.try(first_difference, solver, start, h)
    if not fine or d ~= d then return best end
    if d > ROUND then best = h end
    if d >= PLAIN then return best end
    h = h * LONGER
  end
  return best
end

---- what a start says ----

-- about the largest |eigenvalue| of D - 1, D the tangent map of the step h
local function turn_of(solver, start, h)
  local first = solver.system:solver { rule = solver.rule, h = h }
  local D = first:tangent { q = start.q, v = start.v, p = start.p, t0 = start.t0, steps = 1 }
  local A = linear.fill(D.rows, D.columns, function(i, k) return D[i][k] - (i == k and 1 or 0) end)
  for _ = 1, 3 do A = A * A end
  return linear.largest(A) ^ (1 / 8)
end

-- Does the step h resolve the motion? Half of it does half as much then; of an oscillation that is
-- far from resolved D may be near 1, too, and nearer for longer steps.
local function is_resolved(solver, start, h)
  local fine, whole, half = blame.try(function()
    return turn_of(solver, start, h), turn_of(solver, start, h / 2)
  end)
  return fine and whole <= RESOLVED and whole > 1.5 * half
end

-- how often a run of measured orders has been as high as declared, or has settled at less
local function look(seen, p, order)
  seen.high = p >= order - ENOUGH and seen.high + 1 or 0
  seen.low = seen.p and p < order - ENOUGH and abs(p - seen.p) < SETTLED and seen.low + 1 or 0
  seen.p, seen.least = p, min(p, seen.p or p)
end

-- "had", "less" and the order, or "unknown" and why, from steps of about h on
local function judge_from(solver, start, order, first)
  local h = telling_step(solver, start, first)
  if not h then return "unknown", "differences between steps of h and h/2 are round-off" end
  local seen, last, gap = { high = 0, low = 0 }, nil, nil
  for k = 0, HALVINGS do
    local here, scale = finish(solver, start, h * 0.5 ^ k, 2 << k)
    local now = last and apart(here, last, scale)
    if now and now <= ROUND then
      if gap and log(gap / ROUND, 2) >= order - ENOUGH then return "had", order end
      return "unknown", "differences between steps of h and h/2 are round-off"
    end
    if gap then look(seen, log(gap / now, 2), order) end
    if seen.high >= 2 then return "had", seen.least end
    if seen.low >= 2 and k >= 4 and is_resolved(solver, start, h * 0.5 ^ k) then
      return "less", seen.p
    end
    gap, last = now, here
  end
  return "unknown", seen.low > 0
    and ("it shows %.1f at steps that do not resolve the motion"):format(seen.p)
    or "errors have not settled at a power of h"
end

-- the same from shorter steps where those of the run do not resolve the motion
local function judge(solver, start, order)
  local verdict, what
  for k = 0, SHORTER do
    local fine, now, text = blame.try(judge_from, solver, start, order, solver.h * 2 ^ (-FINER * k))
    if fine then verdict, what = now, text end
    if fine and now ~= "unknown" then break end
  end
  return verdict or "unknown", what or "steps of other lengths do not get on from this start"
end

---- starts ----

-- entries of x, moved by a tenth of their size
local function moved(x, random, k, size)
  local n = #x
  local off, out = kits.normals(random, k, n, NEAR), core.zeros(n)
  for i = 1, n do out[i] = x[i] + size * off[i] end
  return out
end

local function size_of(x)
  local size = 0
  for i = 1, #x do size = max(size, abs(x[i])) end
  return size
end

-- a start near another one: number k
local function near(solver, start, k)
  local system, random = solver.system, core.random(17)
  local own, out = system.place, {}
  for key, value in pairs(start) do out[key] = value end
  local d = own and own.dimension or system.Q.dimension
  local motion = start.p or start.v
  if own and start.q then
    out.q = own.kit.compose(own.kit.element(start.q),
      own.kit.exp(kits.normals(random, 2 * k, d, NEAR)))
  elseif start.q then
    local size = size_of(start.q)
    out.q = moved(start.q, random, 2 * k, size > 0 and size or 1)
  end
  local size = size_of(motion)
  local field = start.p and "p" or "v"
  if size == 0 and system.given.L then
    out.p, out.v, field, motion = nil, nil, "v", core.zeros(d)
  end
  out[field] = moved(motion, random, 2 * k + 1, size > 0 and size or 1)
  return out
end

-- why the start of the run alone does not tell
local function reason(verdict, what)
  return verdict == "less" and ("only this start says %.1f"):format(what) or what
end

-- all that starts say, until two say less or one says as much
local function judge_all(solver, start)
  local order, less, why = solver.order, {}, nil
  for k = 0, 2 do
    local verdict, what = judge(solver, k == 0 and start or near(solver, start, k), order)
    if verdict == "had" then return "had", what end
    if verdict == "less" then less[#less + 1] = what end
    if #less == 2 then return "less", less[1] end
    if k == 0 then why = reason(verdict, what) end
  end
  return "unknown", why
end

-- the start of the first member of an ensemble
local function first_member(options)
  local out = {}
  for _, key in ipairs { "q", "v", "p", "a" } do
    local source = core.one(options[key], key)
    if type(source) == "function" then out[key] = source(1) else out[key] = source and source[1] end
  end
  out.t0, out.project = options.t0, options.project
  return out
end

-- raises where a step leads off the group; where relations of coordinates tell it, every step is
-- looked at (src/integ/step_method.c), but a group of a basis has none
local function check_element(solver, start)
  local system, kit = solver.system, solver.system.place.kit
  local fine, path = blame.try(function()
    return system:solver { rule = solver.rule, h = solver.h }:run { q = start.q, v = start.v,
      p = start.p, a = start.a, t0 = start.t0, project = start.project, steps = 1 }
  end)
  if not fine then return end
  local defect, why = kit.defect(path.q[#path])
  if defect <= OFF then return end
  measured[solver.rule][system] = nil
  error(("dm.step: 'next' of %s gives a q that is no element of %s, %s"):format(
    tostring(solver.rule), tostring(system.Q), why or ("it is off by %.2g"):format(defect)), 0)
end

--- Raise where the order is less than declared; a start from which the step does not get on is left
-- to the run itself. members: the options are those of an ensemble.
function M.check(solver, options, members)
  local rule, system = solver.rule, solver.system
  if measured[rule] and measured[rule][system] then return end
  local fine, start = blame.try(function() return members and first_member(options) or options end)
  if not fine or not start.p and not start.v then return end
  M.trust(rule, system)  -- the runs below are not asked
  if system.place then check_element(solver, start) end
  local fit, verdict, what = blame.try(judge_all, solver, start)
  if not fit then verdict, what = "unknown", "there is no start near this one" end
  if verdict == "unknown" then note(rule, system, "declared, not measured: " .. what) end
  if verdict == "had" then note(rule, system, ("measured: %.1f"):format(what)) end
  if verdict ~= "less" then return end
  measured[rule][system] = nil
  error(("dm.step: %s declares order %d, and from this start it has order %.2f: is a formula "
    .. "wrong, or the order?"):format(tostring(rule), solver.order, what), 0)
end

return M
