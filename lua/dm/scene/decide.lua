--- How a scene finds its choice: the reference, models, rules, and the check, each with its part of
-- the seconds.
local blame = require "dm.base.blame"
local central = require "dm.scene.central"
local choice = require "dm.scene.choice"
local core = require "dm.core"
local deadline = require "dm.scene.deadline"
local independent = require "dm.measure.independent"
local linear = require "dm.scene.linear"
local model = require "dm.scene.model"
local narrow = require "dm.scene.narrow"
local pilot = require "dm.scene.pilot"
local reduce = require "dm.scene.reduce"
local references = require "dm.scene.reference"
local relative = require "dm.scene.relative"
local report = require "dm.scene.report"
local scan = require "dm.scene.scan"
local search = require "dm.scene.search"
local whole = require "dm.scene.whole"

local max, min = math.max, math.min

local fail = require "dm.base.options".failing "dm.scene"

-- raises where what was left out stops to hold along a run of the whole
local function look_at_dependent(scene, given)
  if #scene.left_out == 0 then return end
  local path, why = pilot.free_run(given, 1e-9, {})
  if not path then fail("constraints that were left out could not be looked at: %s", why) end
  independent.look(scene.system, path)
end

-- times at which models and rules are compared with the reference, and those of the check: at
-- least so many, at most so many, and per step of the reference; they fall in step with nothing
local PILOT_TIMES = { 256, 3000, 1, 0.6180339887498949 }
local CHECK_TIMES = { 2048, 20000, 8, 0.4142135623730951 }
-- Parts of the seconds that are over when reference, models, rules are to be done. The reference
-- cannot have more: its values at other times, the run of the choice and its check and the rows
-- cost as much again (Kepler's orbit, T = 1.2e4: 0.6 made it 3.6 s for 3).
local REFERENCE_TIME, MODELS_TIME, RULES_TIME = 0.45, 0.55, 0.72
local LEAST = 0.08  -- of them, for each of these, where those before took longer

local function mesh(reference, how)
  local steps = #reference.times
  return reference:mesh(min(how[2], max(how[1], how[3] * steps)), how[4])
end

-- rules that are named are not those of the reference
local function named_rules(scene)
  local out = {}
  for _, rule in ipairs(scene.options.rules or {}) do out[pilot.controlled(rule) or rule] = true end
  return out
end

-- the times of lists, each once
local function merged(lists)
  local all, out = {}, {}
  for _, list in ipairs(lists) do table.move(list, 1, #list, #all + 1, all) end
  table.sort(all)
  for _, t in ipairs(all) do
    if t ~= out[#out] then out[#out + 1] = t end
  end
  return out
end

-- the rows of a record, which has those of all times, at some of them
local function rows_at(record, all, times)
  local where, out, k = {}, {}, 1
  for i, t in ipairs(times) do
    while all[k] ~= t do k = k + 1 end
    where[i] = k
  end
  for name, values in pairs(record) do
    local list = {}
    for i, row in ipairs(where) do list[i] = values[row] end
    out[name] = core.vector(list)
  end
  return out
end

-- what is watched along the reference, at the times of each list, by one run
local function known_at(scene, reference, lists)
  local times, out = merged(lists), {}
  local fine, path = blame.try(reference.path, reference, times)
  if not fine then
    fail("the tolerance cannot be promised: the reference was known at %d times, but not at %d "
      .. "more: %s; give more seconds", #reference.at, #times, pilot.first_line(path))
  end
  local record = pilot.record(scene.problem, path)
  for i, list in ipairs(lists) do out[i] = rows_at(record, times, list) end
  return out
end

-- what pilot runs are compared with: the reference at its times and at ends of steps
local function known_of(scene, reference, times)
  local ends, lists = {}, {}
  if not scene.options.frame then ends, lists = scan.ends(scene.problem) end
  lists[#lists + 1], lists[#lists + 2] = scene.check_times, times
  local records = known_at(scene, reference, lists)
  for _, known in pairs(ends) do known.reference = records[known.list] end
  scene.checked = records[#records - 1]
  return records[#records], ends
end

local function start_search(scene, given)
  local reference = references.find(given, scene.allowed, REFERENCE_TIME, named_rules(scene),
    scene.options.frame and (scene.tolerant and "best" or "best, or any"))
  local times, problem = mesh(reference, PILOT_TIMES), scene.problem
  scene.check_times, scene.reference = mesh(reference, CHECK_TIMES), reference
  local known, ends = known_of(scene, reference, times)
  scene.uncertainty = 2 * (scene.options.frame and reference.noise or reference.distance)
    + pilot.round_off(problem, scene.checked)
  scene.reference_text = ("%s agree to %.1e of the tolerance"):format(reference.text,
    reference.distance)
  return scan.prepare({ times = times, reference = known, ends = ends,
    profile = scene.profile, bound = math.huge, pilots = 0, candidates = {}, models = {},
    resolved = #reference.times, steps = reference.times, check_times = scene.check_times,
    looks = narrow.present(given) and {} or nil,
    rules = search.rules(scene.options.rules, scene.system, { [reference.rule] = true }),
    seconds = scene.allowed, half_time = scene.began + MODELS_TIME * scene.allowed,
    deadline = scene.began + RULES_TIME * scene.allowed }, problem)
end

-- what the seconds left out
local function note_cut(scene)
  local s, out = scene.search, {}
  if s.models_cut then out[#out + 1] = "smaller models" end
  if s.cut then out[#out + 1] = "rules" end
  if #out == 0 then return end
  scene.cut = ("the %g seconds were over before everything was looked at: %s are left out")
    :format(scene.allowed, table.concat(out, " and "))
end

-- what was found, in words
local function conclude(scene)
  scene.check_text = ("check at %d other times, and between them: error %s")
    :format(#scene.check_times, report.error(scene, scene.checked_error))
  scene.seconds = core.cpu() - scene.began
  return scene
end

-- the choice where a frame has a deadline
local function keep_deadline(scene, given)
  pilot.allow(scene.problem, scene.began + scene.allowed - core.cpu(), 1 / 4)
  scene.search.refused = {}
  scene.search.models[1] = { model = given, error = 0, verdict = "the system as given",
    kept = true }
  scene.best = deadline.choose(scene, given, scene.tolerant)
  scene.search.candidates = scene.candidates
  pilot.allow(scene.problem, nil)
  scene.checked_error = scene.best.error
  note_cut(scene)
  return conclude(scene)
end

-- models of linear equations, for which the time may be too short
local function linear_models(scene)
  local left = scene.began + MODELS_TIME * scene.allowed - core.cpu()
  if left > 0 then
    local fine, out = core.within(left, linear.models, scene.problem, scene.options)
    if fine then return out end
    core.pass_stop()
  end
  scene.search.models_cut = true
  return {}
end

-- find the choice
local function look_for_choice(scene)
  scene.began = core.cpu()
  local given = model.given(scene.problem):ready()
  look_at_dependent(scene, given)
  scene.search = start_search(scene, given)
  scene.candidates = scene.search.candidates
  if scene.options.frame then return keep_deadline(scene, given) end
  local elsewhere = not whole.is(scene.system)
  local less = elsewhere and relative.model(scene.problem, scene.options) or nil
  local splits = elsewhere and { central.model(scene.problem, scene.options) } or {}
  splits[#splits + 1] = less and central.model(less.problem, scene.options) or nil
  if scene.options.symmetry then
    splits[#splits + 1] = require "dm.scene.symmetry".model(scene.problem, scene.options)
  end
  -- of the seconds of a step, what one run may take
  local function allow(part, most)
    local left = scene.began + part * scene.allowed - core.cpu()
    pilot.allow(scene.problem, max(left, LEAST * scene.allowed), most)
  end
  allow(MODELS_TIME, 1 / 4)
  scene.rungs = reduce.ladder(scene.search, given, splits,
    elsewhere and linear_models(scene) or {}, less)
  allow(RULES_TIME, 1 / 4)
  search.models(scene.search, scene.rungs)
  scene.finalists = search.finalists(scene.search)
  allow(1, 1)
  choice.choose(scene)
  pilot.allow(scene.problem, nil)
  choice.describe(scene)
  note_cut(scene)
  return conclude(scene)
end

--- Find the choice of a scene, once: on a copy, whose fields become those of the scene when all of
-- them are there, so that what a stop or an error ends leaves nothing half made.
return function(scene)
  if scene.best then return scene end
  local found = setmetatable({}, getmetatable(scene))
  for key, value in pairs(scene) do found[key] = value end
  pilot.allow(scene.problem, nil)
  look_for_choice(found)
  local best = found.best
  found.best = nil
  for key, value in pairs(found) do scene[key] = value end
  scene.best = best -- says that the others are there
  return scene
end
