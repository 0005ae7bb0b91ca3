--- Reduced runs that fail or have lost their way: named by the first step that went wrong, whatever
-- rows were kept, and by what is there (reason.lua). Looked for in the rows that were kept; where
-- these look suspect the steps are run again and all of them are looked at.
local blame = require "dm.base.blame"
local jumps = require "dm.reduce.run.jump"
local reason = require "dm.reduce.run.reason"
local routh = require "dm.reduce.routh"
local shapes = require "dm.reduce.routh.shape"

local M = {}

local abs, min, max = math.abs, math.min, math.max

---- what was left, and where ----

local SUSPECT, DEEP = 0.02, 0.25

-- is there a momentum, and so a wall?
local function has_wall(info)
  for a = 1, info.m do
    if info.mu[a] ~= 0 then return true end
  end
  return false
end

-- has the energy moved by more than a small part?
local function is_suspect(path, info)
  local E = jumps.energies(path, info)
  for i = 2, E and #E or 1 do
    if not (abs(E[i] - E[1]) <= SUSPECT * max(abs(E[1]), 1e-300)) then return true end
  end
  return false
end

-- has some shape between a and b a much smaller locked inertia than either?
local function collapses(shape, a, b, t)
  local function inertia(x) return reason.inertia(shape, x, t) end
  local before, now = inertia(a), inertia(b)
  return before and now
    and jumps.least_between(inertia, a, b, math.huge) < DEEP * min(before, now)
end

-- the first row to which a step jumped through such a shape
local function first_beyond(path)
  local shape, t0 = path.system, path.t[1]
  local before = reason.inertia(shape, path.q[1], t0)
  for i = 2, #path do
    local a, b, t = path.q[i - 1], path.q[i], path.t[i]
    local now = reason.inertia(shape, b, t)
    if before and now then
      local middle = reason.inertia(shape, 0.5 * (a + b), t) or math.huge
      if middle < min(before, now) and collapses(shape, a, b, t) then return i end
    end
    before = now
  end
end

-- Where the zero of r is crossed r falls between the ends of a step by more than in a line, or one
-- end is far nearer to the zero than the other.
local BENDS, NEARER = 0.9, 0.25

local function bends(before, middle, now)
  return middle < BENDS * (before + now) / 2 or min(before, now) < NEARER * max(before, now)
end

local SAFE = 2 -- r falls by less than so many times its fastest change in a step before

-- The first row to which a step jumped through a shape with a wall of infinite height, where
-- r = (mu I^-1 mu)^-1/2 vanishes: steps near it are looked at, and r tells how many steps are far
-- from it; where the energy has moved all of them. r is infinite where mu is the momentum at rest,
-- beside which all others are small: it is a wall if the locked inertia vanishes. Where L is not
-- quadratic in the velocities of the group the wall may be finite, and it is the energy that tells.
local function first_through(path, info)
  if #path < 2 or not has_wall(info) then return nil end
  local all = is_suspect(path, info)
  if info.root then return all and first_beyond(path) or nil end
  local function distance(x, t) return (shapes.wall(info, x, t) or 0) ^ -0.5 end
  local rows, times = path.q, path.t
  local i, n, fastest, x, t = 1, 1, 0, rows[1], times[1]
  local r = distance(x, t)
  while i < #path do
    local j = min(i + n, #path)
    local y, s = rows[j], times[j]
    local now = distance(y, s)
    if j == i + 1 and bends(r, distance(0.5 * (x + y), s), now)
      and jumps.least_between(function(z) return distance(z, s) end, x, y, math.huge)
        < DEEP ^ 0.5 * min(r, now) and collapses(path.system, x, y, s) then
      return j
    end
    if now < math.huge and r < math.huge then fastest = max(fastest, abs(now - r) / (j - i)) end
    n = all and 1 or max(1, min(2 * n, now // (SAFE * fastest + 1e-300)))
    i, x, t, r = j, y, s, now
  end
end

local LOST = 1  -- of the energy's size: no more than the sign of it is left
-- the size is looked at again that much later; rows that are looked at in any case
local AGAIN, FEW = 1.2, 9

-- the first row at which the energy is off by more than its size, at a place that says why: its
-- row, code and sentence; `whole` is the path that begins with the start
local function first_lost(path, info, whole)
  local E = jumps.energies(path, info)
  if not E then return nil end
  local shape, q, t = path.system, whole.q[1], whole.t[1]
  local first = (whole == path and E or jumps.energies(whole, info))[1]
  local size, known = abs(first), 0
  for i = 2, #E do
    local off = abs(E[i] - first)
    -- from rows before this one: behind a wall all energies are large. Not for every row of a start
    -- at rest
    if not (off <= LOST * size) and i > AGAIN * known then
      size, known = max(size, jumps.energy_size(path, first, max(i - 1, min(#E, FEW)))), i
    end
    if not (off <= LOST * size) then
      for row = i, i - 1, -1 do
        local code, why = reason.at(path, info, path.q[row], path.t[row], q, t)
        if code then return i, code, why end
      end
      local code, why = reason.of_end(shape, info, jumps.head(path, i - 1))
      return code and i, code, why
    end
  end
end

local LEAVES, STANDS_OUT = 2 ^ -12, 30

-- The first row at which the energy is off by more than a small part of its size and by far more
-- than it was before: there the run went wrong that was lost later.
local function first_left(path, info, whole)
  local E = jumps.energies(path, info)
  if not E then return nil end
  local first = (whole == path and E or jumps.energies(whole, info))[1]
  local bar, before = LEAVES * jumps.energy_size(whole, first), {}
  for i = 2, #E do
    local off = abs(E[i] - first)
    if not (off <= bar) then
      local sorted = table.move(before, 1, #before, 1, {})
      table.sort(sorted)
      if not (off <= STANDS_OUT * (sorted[#sorted // 2 + 1] or 0)) then return i end
    end
    before[i - 1] = off
  end
end

---- the first step that went wrong ----

local FORBIDDEN = "jumped through a shape at which the locked inertia vanishes (r = 0), which "
  .. "the momentum forbids: take smaller steps near it"
local OVER, LEFT = "jumped over a pole: ", "left its energy: "

-- of steps that were all kept the first one that is wrong: { row =, code =, why = }, or nothing
local function first_wrong(path, info, whole)
  local found
  local function note(row, code, why)
    if row and (not found or row < found.row) then
      found = { row = row, code = code, why = why, path = path }
    end
  end
  note(first_through(path, info), "collapse", FORBIDDEN)
  local row, where = jumps.first_over(path, info)
  if row then
    note(row, "pole", OVER .. reason.vanishing(path, info, where, path.q[row - 1], path.t[row - 1]))
  end
  local lost, code, why = first_lost(path, info, whole)
  note(lost, code, lost and LEFT .. why)
  return found
end

-- the same between rows that are further apart, run again
local function first_between(path, info, run)
  for _, i in ipairs(jumps.suspects(path, info)) do
    local steps = jumps.again(path, run, i - 1, i)
    local found = steps and #steps >= 2 and first_wrong(steps, info, path)
    if found then return found, i end
  end
  local lost, code, why = first_lost(path, info, path)
  return lost and { row = lost, code = code, why = LEFT .. why, path = path }, lost
end

-- the same step or, where the energy was left before it, that one, with what is there; alone: the
-- run failed, and this is all that is wrong with its steps
local function with_origin(found, path, info, whole)
  local left = first_left(path, info, whole)
  if not left or found and found.path == path and left >= found.row then return found end
  local out = { row = left, path = path, code = found and found.code, why = found and found.why,
    alone = not found }
  for row = left, left - 1, -1 do
    local code, why = reason.at(path, info, path.q[row], path.t[row], whole.q[1], whole.t[1])
    if code then
      out.code, out.why = code, LEFT .. why
      break
    end
  end
  return out
end

-- the steps up to a row, or in a run that is too long for that those to the first row that was kept
-- at which the energy had been left
local function around_origin(path, info, run, row)
  local all = jumps.again(path, run, 1, row)
  if all then return all end
  local left = first_left(path, info, path) or row
  return left and jumps.again(path, run, left - 1, left)
end

-- The first wrong step of a run, { path, row, code, why, whole = the path that begins with the
-- start }, or nothing; again.run(options) steps again, again.all_steps(path) makes all of them
-- where these are not too many; again.none: steps are as long as their error allows, and h is not
-- theirs.
local function wrong(path, info, again, failed)
  if path.watched or #path < 1 then return nil end
  local found, dense, row, whole = nil, path, nil, path
  if #path >= path.steps + 1 or again.none then
    found = first_wrong(path, info, path)
  else
    local all = not failed and again.all_steps(path)
    if all then
      if path.t[1] > all.t[1] or #path < 2 then whole = all end
      found, dense = first_wrong(all, info, whole), all
    else
      found, row = first_between(path, info, again.run)
      dense = (found or failed) and around_origin(path, info, again.run, row) or nil
      if dense then found = first_wrong(dense, info, path) or found end
    end
  end
  if not found and not failed then return nil end
  local out = dense and #dense >= 2 and with_origin(found, dense, info, whole) or found
  if out then out.whole = whole end
  return out
end

---- what is raised ----

local function step_at(whole, t) return math.floor((t - whole.t[1]) / whole.h + 0.5) end

-- which step is wrong: its number, or the numbers between two rows that were kept
local function name_of(found, whole)
  local path, row = found.path, found.row
  local last, first = step_at(whole, path.t[row]), step_at(whole, path.t[row - 1]) + 1
  if last > first then
    return last, ("one of the steps %d to %d (from t = %.6g on)"):format(first, last,
      path.t[row - 1])
  end
  return last, ("step %d (t = %.6g)"):format(last, path.t[row - 1])
end

-- how many rows of a path are before a time
local function rows_before(path, t)
  local n = #path
  while n > 1 and path.t[n] > t + 1e-9 * path.h do n = n - 1 end
  return n
end

local function raise(whole, found)
  local step, which = name_of(found, whole)
  local t = found.path.t[found.row - 1]
  local failure = { code = found.code, reason = found.code, step = step, time = t,
    rule = whole.rule, path = jumps.head(whole, rows_before(whole, t)),
    message = ("%s: %s %s; the path up to there is in failure.path")
      :format(whole.rule, which, found.why) }
  error(setmetatable(failure, debug.getregistry()["dm.failure"]), 0)
end

-- adds reason and a sentence to a failure whose path has rows
local function explain(shape, info, failure)
  local path = failure.path
  if not path or path.watched or #path < 1 or failure.code == "stopped" then return end
  local fine, code, why = blame.try(reason.of_end, shape, info, path)
  if fine and code then
    failure.reason = code
    failure.message = ("%s (%s)"):format(failure.message, why)
  end
end

-- raises for a path that lost its way; a run that failed at an edge keeps that reason, with what
-- was wrong before
local function look(path, info, again, failure)
  local stopped = failure and failure.code == "stopped"
  local fine, found = blame.try(wrong, path, info, again, failure and not stopped)
  if failure then explain(path.system, info, failure) end
  if not fine or not found or not found.code and not failure then return end
  if not failure or failure.reason ~= "edge" and not found.alone then raise(found.whole, found) end
  local _, which = name_of(found, path)
  failure.message = ("%s; before that %s %s"):format(failure.message, which,
    found.why or "left its energy")
end

local KEPT = { "q", "v", "p", "q0", "q1", "p0", "t0", "project" } -- of the options of a run

-- path -> all its steps, from the same start, or nothing: too many, or they fail
local function all_steps_of(plain, solver, options)
  return function(path)
    local again = { steps = path.steps }
    for _, key in ipairs(KEPT) do again[key] = options[key] end
    local fine, all = false, nil
    if path.steps >= 1 and path.steps <= jumps.LONGEST then
      fine, all = blame.try(plain, solver, again)
    end
    return fine and all or nil
  end
end

--- solver:run of a reduced system; plain is the method without this. Positions are put in front by
-- blame.
function M.run(plain, solver, options)
  local info = routh.info(solver.system)
  local fine, path = pcall(plain, solver, options)
  if not fine and type(path) == "string" then
    local unreduced = path:find(("must have %d entries (got %d)"):format(info.d, info.n), 1, true)
    error(unreduced and path
      .. ": this system is reduced, and shape:start(q, v) gives the start below an unreduced one"
      or path, 0)
  end
  local failure = not fine and type(path) == "table" and path.message and path
  if not fine and not failure then error(path, 0) end
  if failure then path = failure.path end
  if path then
    look(path, info, { all_steps = all_steps_of(plain, solver, options),
      none = type(options) == "table" and options.control ~= nil,
      run = function(again)
        again.project = options.project
        return plain(solver, again)
      end }, failure)
  end
  if failure then error(failure, 0) end
  return path
end

return M
