--- The run that is handed out: which rows it has, and more steps where some of them fail.
local blame = require "dm.base.blame"
local choice = require "dm.scene.choice"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local pilot = require "dm.scene.pilot"
local report = require "dm.scene.report"
local rows = require "dm.scene.rows"

local M = {}

local fail = option.failing "dm.scene"

local ROWS = { "at", "every", "file" }
local ROW_ROOM = 0.1  -- of the tolerance, for straight lines between rows

--- How many rows straight lines need, once; of even steps so many of these apart
function M.space(scene)
  if scene.row_error then return end
  local per_frame = scene.best.per_frame
  if not per_frame then choice.leave(scene, ROW_ROOM) end
  local room = 1 - scene.checked_error - scene.uncertainty
  local every, err = rows.every(scene, room, per_frame)
  if not (err <= room) then
    every = nil
    scene.lines, err = rows.lines(scene, room, per_frame and scene.frames)
    if not scene.lines then
      fail("scene:run(): straight lines between rows err by more than the tolerance leaves, %s, "
        .. "with 10^6 of them: give the times, scene:run { at = { ... } }",
        report.error(scene, room))
    end
  end
  scene.every, scene.row_error = every, err
  scene.rows_text = ("rows: %s; straight lines between them err by %s"):format(every
    and ("one in %d steps"):format(every) or ("%d"):format(scene.lines + 1),
    report.error(scene, err))
end

-- the last time asked for, which rounding may have put behind until_t: T*i/n does that for i = n
local function within(at, until_t)
  local last = at[#at]
  if type(last) ~= "number" or not (last > until_t) then return at end
  if last - until_t > 1e-15 * math.abs(until_t) then
    option.fail("scene:run", "option 'at': t = %.17g is after until_t = %.17g, up to which the "
      .. "tolerance is known", last, until_t)
  end
  local out = {}
  for i = 1, #at - 1 do out[i] = at[i] end
  out[#at] = until_t
  return out
end

-- which rows: as asked for, else as many as straight lines need; and what lines add to the error
local function rows_of(scene, options)
  option.check(options, ROWS, "scene:run", "{ at =, every =, file = }, or nothing")
  if options.at then
    if not lists.count(options.at) then
      option.fail("scene:run", "option 'at' must be a list of times (got %s)",
        option.got(options.at))
    end
    local asked = {}
    for name, value in pairs(options) do asked[name] = value end
    asked.at = within(options.at, scene.options.until_t)
    return asked, 0
  end
  if options.every and pilot.is_even(scene.best.rule) then
    return { steps = scene.best.N, every = options.every, file = options.file }, 0
  end
  if scene.best.per_frame and not scene.tolerant then
    return { steps = scene.best.N, every = scene.best.per_frame, file = options.file }, 0
  end
  M.space(scene)
  if scene.every then
    return { steps = scene.best.N, every = scene.every, file = options.file }, scene.row_error
  end
  return { at = rows.times(scene.problem, scene.lines), file = options.file }, scene.row_error
end

local TRIES = 6

-- the step itself failed: of rows between two steps some are made by a shorter one that does where
-- those that were checked did not
local function is_of_a_step(failure)
  local code = type(failure) == "table" and failure.code
  return code == "not_finite" or code == "no_convergence" or code == "too_short"
end

-- the path, and what straight lines between its rows err by
local function path_of(scene, options, tries)
  local which, lines = rows_of(scene, options)
  local err = scene.checked_error + scene.uncertainty + lines
  local fine, path = blame.try(rows.path, scene.best, which,
    { error_estimate = err * (scene.unit or 1),
    in_words = scene.unit and ("%.2g"):format(err * scene.unit) or ("%.2g of the tolerance")
      :format(err) })
  if fine then return path end
  if not is_of_a_step(path) or tries == 0 or not choice.finer(scene) then error(path, 0) end
  scene.row_error = nil
  return path_of(scene, options, tries - 1)
end

--- The run of a scene that has chosen, with the rows that are asked for. Lines between these may
-- need more steps, which cost more.
function M.run(scene, options)
  local N = scene.best.N
  local path = path_of(scene, options, TRIES)
  if scene.best.N ~= N and not scene.best.per_frame then choice.describe(scene) end
  return path
end

return M
