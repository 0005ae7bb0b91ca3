--- The run that a scene hands out: how many rows it needs, and a path that carries its error.
local pilot = require "dm.scene.pilot"

local M = {}

local max, min, huge = math.max, math.min, math.huge

-- Where in the line between two rows the motion is looked at: first in the middle, where a parabola
-- is furthest off; elsewhere for what is shorter than the line, as the passage of a wall: behind
-- a jump at a part f of the line it is 1 - f of the jump off.
local MIDDLE = 1 / 2
local PARTS = { MIDDLE, 1 / 32, 1 / 8, 1 / 4, 3 / 8, 5 / 8, 3 / 4, 7 / 8, 31 / 32 }
local BETWEEN = 1.15  -- what is off between these places
local DENSE = 4       -- times of the check in a line: it is no parabola then

-- The largest distance of x from straight lines of length H that have it at the part f of them; one
-- beyond `enough`, where there is such a one. Points before and behind number k: at least so far
-- from it, else its neighbours.
local function off_lines(t, x, H, f, enough)
  local worst, before, behind, count, is_middle = 0, 1, 3, #t, f == MIDDLE
  for k = 2, count - 1 do
    if is_middle or DENSE * (t[k + 1] - t[k - 1]) < 2 * H then
      local from, to = t[k] - f * H, t[k] + (1 - f) * H
      while before + 1 < k and t[before + 1] <= from do before = before + 1 end
      while behind < count and (behind <= k or t[behind] < to) do behind = behind + 1 end
      local a, b = t[k] - t[before], t[behind] - t[k]
      local off = x[k] - (b * x[before] + a * x[behind]) / (a + b)
      if off < 0 then off = -off end
      off = off * (is_middle and H * H / (4 * a * b)
        or (H < a + b and H / (a + b) or 1) * BETWEEN)
      if off > worst then worst = off end
      if worst > enough then return worst end
    end
  end
  return worst
end

-- Largest distance, in tolerances, of the motion from straight lines between rows that are H apart.
-- The reference tells it, at the times of the check, which are dense where the motion is fast: a
-- parabola that is y off the line through points a before, b behind is y H^2/(4 a b) off at most.
-- Where a part of the line is more than `room` off, or a point more than `enough`, no other is
-- looked at.
local function bend(scene, H, room, enough)
  local problem, worst, columns = scene.problem, 0, {}
  for i, name in ipairs(problem.columns) do columns[i] = scene.checked[name]:totable() end
  for _, f in ipairs(PARTS) do
    for i, name in ipairs(problem.columns) do
      local tolerance = problem.tolerance[name]
      worst = max(worst, off_lines(scene.check_times, columns[i], H, f, enough * tolerance)
        / tolerance)
      if worst > enough then return worst end
    end
    if worst > room then return worst end
  end
  return worst
end

--- every, the error of straight lines between rows so many steps apart, in tolerances: as few rows
-- as err by `room` at most, but one a frame. nil where steps are too long for it, or not even.
function M.every(scene, room, per_frame)
  local c, every = scene.best, per_frame or 1
  if not pilot.is_even(c.rule) then return nil, huge end
  local h = scene.problem.T / c.N
  local most = per_frame and huge or room
  local err = bend(scene, every * h, most, most)
  if err > room or per_frame then return every, err end
  while 8 * every < c.N do
    local more = bend(scene, 2 * every * h, room, room)
    if more > room then break end
    every, err = 2 * every, more
  end
  return every, err
end

--- `count` + 1 evenly spaced times over the whole of a problem.
function M.times(problem, count)
  local out = {}
  for i = 0, count do out[i + 1] = problem.t0 + problem.T * i / count end
  return out
end

local FIRST, MOST = 256, 1e6

--- How many rows, evenly spaced, straight lines need to err by `room` at most, and what they err
-- by. Lines err by the square of their length, so that a number that is too small tells a better
-- one; so many of them in each of `frames`, where these are given. nil: more than 10^6.
function M.lines(scene, room, frames)
  local unit, count = frames or 1, frames or FIRST
  while count <= MOST do
    local err = bend(scene, scene.problem.T / count, room, huge)
    if err <= room then return count, err end
    count = unit * math.ceil(count / unit * min(64, max(1.2, 1.1 * math.sqrt(err / room))))
  end
  return nil
end

---- the path ----

local Path = { __name = "dm.scene_path" }

-- a field of the run itself, else of the path; methods get the path
function Path.__index(run_, key)
  local value = rawget(run_, "path")[key]
  if type(value) ~= "function" then return value end
  return function(self, ...) return value(self == run_ and rawget(run_, "path") or self, ...) end
end

function Path.__len(run_) return #rawget(run_, "path") end

function Path.__tostring(run_)
  return ("%s; error of what is watched at most %s (model: %s)")
    :format(tostring(rawget(run_, "path")), run_.in_words, run_.model)
end

--- The run of a choice as a path that has error_estimate, errors, model beside everything that
-- dm.path has.
function M.path(c, which, more)
  local given = { watch = c.model.watch }
  for key, value in pairs(which) do given[key] = value end
  local path = pilot.go(c.model, c.rule, c.N, given)
  local out = { path = path, model = c.model:words(), rule = c.rule }
  for key, value in pairs(more) do out[key] = value end
  return setmetatable(out, Path)
end

return M
