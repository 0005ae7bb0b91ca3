--- The run that a scene hands out: how many rows it needs, and a path that carries its error.
local pilot = require "dm.scene.pilot"

local M = {}

local abs, max = math.abs, math.max

local MOST_ROWS = 1 << 15  -- kept by the run that finds out how many are needed

-- largest distance, in tolerances, of rows between those that are kept from straight lines through
-- these; stride 1: by second differences
local function bent(problem, path, stride)
  local worst = 0
  for _, name in ipairs(problem.columns) do
    local x, tolerance = path:column(name):totable(), problem.tolerance[name]
    for from = 1, #x - 1, stride do
      local to = math.min(from + stride, #x)
      for i = from + 1, to - 1 do
        local f = (i - from) / (to - from)
        worst = max(worst, abs(x[i] - (1 - f) * x[from] - f * x[to]) / tolerance)
      end
      if stride == 1 and from > 1 and from + 1 < #x then
        worst = max(worst, abs(x[from + 1] - 2 * x[from] + x[from - 1]) / 8 / tolerance)
      end
    end
  end
  return worst
end

local function run(c, which)
  which.watch = c.model.watch
  return (pilot.go(c.model, c.rule, c.N, which))
end

--- every, the error of straight lines between rows so many steps apart, in tolerances: as few rows
-- as err by `room` at most. nil of a rule whose steps are not even.
function M.every(c, room)
  local problem, every = c.model.problem, 1
  if not pilot.is_even(c.rule) then return nil, math.huge end
  while c.N / every > MOST_ROWS do every = 2 * every end
  local path = run(c, { steps = c.N, every = every })
  local stride, err = 1, bent(problem, path, 1)
  while 4 * stride < #path do
    local next_err = bent(problem, path, 2 * stride)
    if next_err > room then break end
    stride, err = 2 * stride, next_err
  end
  return every * stride, err
end

--- `count` + 1 evenly spaced times over the whole of a problem.
function M.times(problem, count)
  local out = {}
  for i = 0, count do out[i + 1] = problem.t0 + problem.T * i / count end
  return out
end

local TRIES, FIRST, MOST = 8, 256, 1e6

--- How many rows, evenly spaced, straight lines need to err by `room` at most, and what they err
-- by. Lines err by the square of their length, so that a number that is too small tells a better
-- one. nil: more than 10^6.
function M.lines(c, room)
  local count = FIRST
  for _ = 1, TRIES do
    local err = bent(c.model.problem, run(c, { at = M.times(c.model.problem, count) }), 1)
    if err <= room then return count, err end
    count = math.ceil(count * max(1.2, 1.1 * math.sqrt(err / room)))
    if count > MOST then return nil end
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
  local given = {}
  for key, value in pairs(which) do given[key] = value end
  local path = run(c, given)
  local out = { path = path, model = c.model:words(), rule = c.rule }
  for key, value in pairs(more) do out[key] = value end
  return setmetatable(out, Path)
end

return M
