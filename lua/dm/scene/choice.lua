--- The choice of a scene: finalists are checked at times that were not used before, and between
-- them.
local blame = require "dm.base.blame"
local core = require "dm.core"
local narrow = require "dm.scene.narrow"
local pilot = require "dm.scene.pilot"
local profile = require "dm.scene.profile"
local report = require "dm.scene.report"
local scan = require "dm.scene.scan"
local search = require "dm.scene.search"

local M = {}

local max, min = math.max, math.min

local LEAST = 0.02  -- s for a look behind what is narrow

-- what a candidate errs by at times, and between them, beside the reference there; its record
local function error_beside(scene, c, N, times, reference)
  local record, report = pilot.run(c.model, c.rule, N, times)
  if not record then return math.huge, nil, report end
  return pilot.apart_between(scene.problem, record, reference), record
end

local PARTS, MOST = 8, 1000 -- of the time between two rows; rows about which is looked at most

--- Times between those of the check where the error may be larger than at them, `most` rows of the
-- check at most, and the largest error that may be left where these were too few, else 0. Where
-- it may be largest is looked at first, wherever that is.
function M.sharp_times(t, places, most)
  local by_size, taken, out = {}, {}, {}
  for i in pairs(places) do by_size[#by_size + 1] = i end
  table.sort(by_size, function(a, b)
    local x, y = places[a], places[b]
    return x > y or x == y and a < b
  end)
  for k = 1, min(most, #by_size) do
    taken[by_size[k]], taken[by_size[k] + 1] = true, true -- what is before, what is behind
  end
  for i = 2, #t do
    for j = 1, taken[i] and PARTS or 0 do
      out[#out + 1] = t[i - 1] + (t[i] - t[i - 1]) * j / PARTS
    end
  end
  return out, places[by_size[most + 1]] or 0
end

local UNSEEN = 1.5 -- times the error at the check: where there is no time to look between them

-- the same between the times of the check, where the error has peaks: as of rows inside of a step
local function error_in_peaks(scene, c, N, record, err)
  local places = pilot.unresolved(scene.problem, record, scene.checked, err)
  local times, unseen = M.sharp_times(scene.check_times, places, MOST)
  if #times == 0 then return err end
  local left = scene.began + scene.allowed - core.cpu()
  local fine, path = blame.try(scene.reference.path, scene.reference, times, max(LEAST, left / 2))
  if not fine then return UNSEEN * err end
  return max(err, min(unseen, UNSEEN * err),
    (error_beside(scene, c, N, times, pilot.record(scene.problem, path))))
end

-- the same after what is narrow inside of a step; inf where that is too much to look at
local function error_behind(scene, c, N)
  if not pilot.is_even(c.rule) or not narrow.present(c.model) then return 0 end
  local times = narrow.times(scene.reference.times, scene.check_times,
    narrow.even(scene.problem, N), N)
  if not times then return math.huge end
  if #times == 0 then return 0 end
  local left = scene.began + scene.allowed - core.cpu()
  local fine, path = blame.try(scene.reference.path, scene.reference, times, max(LEAST, left / 2))
  if not fine then return math.huge end
  return (error_beside(scene, c, N, times, pilot.record(scene.problem, path)))
end

--- What a candidate errs by at the times of the check and between them, in tolerances. With a
-- deadline, whose tolerance is not known, that may be any number.
local function check_error(scene, c, N)
  local err, record = error_beside(scene, c, N, scene.check_times, scene.checked)
  if err > 1 and not c.per_frame or not record then return err end
  local peaks, behind = error_in_peaks(scene, c, N, record, err), error_behind(scene, c, N)
  -- a jump has no width to look into; around it the times of the check are close
  if behind == math.huge and c.per_frame then return UNSEEN * peaks end
  return max(peaks, behind)
end
M.check_error = check_error

local TRIES, FARTHER = 6, 1.25  -- a candidate is checked so often, with so many times the steps

-- The next number of steps of a candidate that errs by so much where it is checked: one that was
-- enough before; else as its order says, but in small parts, since errors of steps that are long
-- beside what is fast do not follow it.
local function next_number(scene, c, err)
  if #c.enough > 0 then return table.remove(c.enough) end
  local by_order = err < math.huge and (err + scene.uncertainty) ^ (1 / c.order) * 1.02 or FARTHER
  local N = c.N
  for _ = 1, TRIES do
    N = math.ceil(max(1.03, min(FARTHER, by_order)) * N)
    if scan.at_rows(scene.search, c.model, c.rule, N) <= 1 then break end
    by_order = FARTHER
  end
  return N
end

local function more_steps(scene, c, err)
  c.N = next_number(scene, c, err)
  c.h = scene.problem.T / c.N
  local fine, cost = blame.try(scene.profile.cost, scene.profile, c.model, c.rule, c.N)
  c.cost = fine and cost or math.huge
end

-- what a candidate errs by where it is checked; nil: too much, and it has more steps now, or failed
local function stands(scene, c, tried)
  local err = check_error(scene, c, c.N)
  if err + scene.uncertainty <= 1 then return err end
  tried[#tried + 1] = ("%s with %d steps misses it where it is checked: error %s")
    :format(c.rule, c.N, report.error(scene, err))
  c.checks = (c.checks or 0) + 1
  if c.checks >= TRIES and #c.enough == 0 then
    c.failed = "dropped: " .. tried[#tried]
  else
    more_steps(scene, c, err)
  end
end

--- The dimension of the choice, its counted work and its time, without set-up.
function M.describe(scene)
  local c = scene.best
  c.n = c.model:size()
  c.cost = scene.profile:cost(c.model, c.rule, c.N)
  c.work = scene.profile.counts and c.cost or nil
  c.ns = scene.profile.counts and profile.time(c.model, c.rule, c.N) or c.cost
end

--- More steps of the choice until so much of the tolerance is left for what comes after it.
function M.leave(scene, part)
  local c = scene.best
  for _ = 1, TRIES do
    local total = scene.checked_error + scene.uncertainty
    if total <= 1 - part then return end
    local N = math.ceil(max(1.05, (total / (1 - 1.5 * part)) ^ (1 / c.order)) * c.N)
    local err = check_error(scene, c, N)
    if not (err <= scene.checked_error) then return end
    c.N, c.h, scene.checked_error = N, scene.problem.T / N, err
  end
end

local FINER = 1.3

--- More steps of the choice, where one of them fails; false: it errs by more with them, or its
-- steps are those of a deadline.
function M.finer(scene)
  local c = scene.best
  if c.per_frame then return false end
  local N = math.ceil(FINER * c.N)
  local err = check_error(scene, c, N)
  if err + scene.uncertainty > 1 then return false end
  c.N, c.h, scene.checked_error = N, scene.problem.T / N, err
  return true
end

local MOST_WORDS = 8

-- the first of what was tried
local function in_few_words(list)
  local more = #list - MOST_WORDS
  return table.concat(list, "; ", 1, min(#list, MOST_WORDS))
    .. (more > 0 and (", and %d more"):format(more) or "")
end

-- the cheapest that has not failed
local function cheapest(list)
  local best
  for _, c in ipairs(list) do
    if not c.failed and (not best or search.is_better(c, best)) then best = c end
  end
  return best
end

--- Sets best and checked_error of a scene: the cheapest finalist that stands the check. One that
-- does not has more steps, and waits until nothing else costs less. Raises what was tried where
-- there is none.
function M.choose(scene)
  local tried = {}
  while true do
    local c = cheapest(scene.finalists)
    local err = c and stands(scene, c, tried)
    if err then
      scene.best, scene.checked_error = c, err
      table.sort(scene.finalists, search.is_better)
      return
    end
    if not c or core.cpu() > scene.began + scene.allowed then break end
  end
  local words = {}
  for _, c in ipairs(#tried == 0 and scene.search.candidates or {}) do
    words[#words + 1] = ("%s with h = %.3g errs by %s")
      :format(c.rule, c.h, report.error(scene, c.error))
  end
  if #tried + #words == 0 then
    error(("dm.scene: no rule could be tried within %g seconds; give more seconds")
      :format(scene.allowed), 0)
  end
  error(("dm.scene: nothing that was tried delivers the tolerance: %s. Take a larger tolerance, "
    .. "or give more seconds")
    :format(in_few_words(#tried > 0 and tried or words)), 0)
end

return M
