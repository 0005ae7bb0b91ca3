--- dm.scene: no more than needed. What is watched, how well, how long; the cheapest model, rule and
-- step that deliver it are found by pilot runs and checked.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local starts = require "dm.base.start"
local model = require "dm.scene.model"
local option = require "dm.base.options"
local pilot = require "dm.scene.pilot"
local profile = require "dm.scene.profile"
local reduce = require "dm.scene.reduce"
local report = require "dm.scene.report"
local rows = require "dm.scene.rows"
local search = require "dm.scene.search"

local M = {}

local Scene = core.class({ __name = "dm.scene" }, [[
dm.scene: what is watched, how exactly, for how long; made by dm.scene{system=, q=, v=, watch=, ...}
fields: best (the choice), candidates (all that was measured), profile (the costs, to be saved)]])

local max, min, floor = math.max, math.min, math.floor

local WHERE = "dm.scene"
local fail = option.failing(WHERE)

---- options ----

local KNOWN = { 1, "system", "q", "v", "p", "t0", "watch", "tolerance", "until_t", "rules",
  "symmetry",
  "profile", "seconds", "project" }
local ROWS = { "at", "every", "file" }

local function check_system(options)
  local system = options.system or options[1]
  local fine, given = pcall(function() return system.given end)
  if fine and given and given.H and not given.L then
    fail("option 'system': scenes read the kinetic energy off a Lagrangian, and this H has none "
      .. "(d2H/dp2 is singular, or H is not quadratic in p)")
  end
  if not (fine and given and given.L) then
    fail("option 'system' must be a dm.system (got %s)", tostring(system))
  end
  return system
end

local function check_rules(rules, system)
  for _, rule in ipairs(rules) do
    if type(rule) ~= "string" then
      fail("option 'rules' must hold rules as texts, such as \"gauss(4)\" (got %s)", type(rule))
    end
    if rule:find "^log%-hamiltonian" then
      fail("option 'rules': '%s' has a time of its own, so that a scene cannot choose its step",
        rule)
    end
    system:solver { rule = rule, h = 1 }  -- a misspelled one is told here
  end
end

local function check_options(options)
  option.check(options, KNOWN, WHERE, "{ system =, q =, v =, watch =, tolerance =, until_t = }")
  local system = check_system(options)
  if options.q == nil or (options.v == nil and options.p == nil) then
    fail("the start is missing: give q and v, or q and p")
  end
  if options.watch == nil then
    fail("nothing is watched: say in option 'watch' what is looked at")
  end
  if options.tolerance == nil and options.watch ~= "picture" then
    fail("option 'tolerance' is missing: how well is it to be known?")
  end
  local t0 = option.number(options, "t0", WHERE, "a time", 0)
  local after = ("a time after the start, t0 = %g"):format(t0)
  option.need(options, "until_t", WHERE, after)
  local last = option.number(options, "until_t", WHERE, after)
  option.demand(last > t0, options, "until_t", WHERE, after)
  option.positive(options, "seconds", WHERE)
  check_rules(option.list(options, "rules", WHERE, "rules", {}), system)
  return system
end

local function read_profile(given)
  if given == nil then return profile.new() end
  if type(given) == "string" then return profile.read(given) end
  if getmetatable(given) == profile then return given end
  fail("option 'profile' must be a file that scene.profile:save wrote, or the profile of another "
    .. "scene (got %s)", type(given))
end

---- a picture ----

local PIXELS = 500  -- of the side of a picture: what is smaller is not seen

-- a run of the whole with more and more steps until one reaches the end
local function coarse_run(given)
  local N, path = floor(max(256, min(1e5, pilot.first_N(given)))), nil
  for _ = 1, 6 do
    local fine
    fine, path = pcall(function()
      return pilot.solver(given, "gauss(2)", N):run(pilot.options_of(given,
        { steps = N, every = max(1, N // 512), watch = given.watch }))
    end)
    if fine then return path end
    pilot.pass_stop(path)
    N = 4 * N
  end
  fail("watch = \"picture\": the tolerance was to be a pixel, but a first run failed: %s; give "
    .. "option 'tolerance'", tostring(path))
end

-- tolerance of a picture: a pixel of the largest extent, seen by a coarse run of the whole
local function picture_tolerance(problem, given)
  local path, extent = coarse_run(given), 0
  for _, name in ipairs(problem.columns) do
    local lo, hi = math.huge, -math.huge
    for _, x in ipairs(path:column(name):totable()) do lo, hi = min(lo, x), max(hi, x) end
    extent = max(extent, hi - lo)
  end
  if not (extent > 0) then fail("watch = \"picture\": nothing moves; give option 'tolerance'") end
  return extent / PIXELS
end

---- choosing ----

local PILOT_TIMES, HOLD_OUT_TIMES = 96, 61
local GOLDEN, SILVER = 0.6180339887498949, 0.4142135623730951
-- of CPU; with a profile that was given no clock shall decide
local SECONDS, WITHOUT_CLOCK = 20, 600

local function merged(a, b)
  local out = { table.unpack(a) }
  for _, t in ipairs(b) do out[#out + 1] = t end
  table.sort(out)
  local distinct = {}
  for _, t in ipairs(out) do
    if t ~= distinct[#distinct] then distinct[#distinct + 1] = t end
  end
  return distinct
end

-- rows of a record at some of its times
local function at_times(problem, record, all, times)
  local place, out = {}, {}
  for i, t in ipairs(all) do place[t] = i end
  for _, name in ipairs(problem.columns) do
    local x = {}
    for i, t in ipairs(times) do x[i] = record[name][place[t]] end
    out[name] = core.vector(x)
  end
  return out
end

-- both error and that of half the step must be inside, at times that were not used before
local function hold_out(scene, c)
  local record = pilot.run(c.model, c.rule, c.N, scene.held_times)
  local finer = pilot.run(c.model, c.rule, 2 * c.N, scene.held_times)
  local err = record and pilot.apart(scene.problem, record, scene.held) or math.huge
  local finer_err = finer and pilot.apart(scene.problem, finer, scene.held) or math.huge
  return err, finer_err
end

-- the cheapest finalist that stands the check; a few more steps are allowed to it
local function choose(scene)
  local tried = {}
  for _, c in ipairs(scene.finalists) do
    for _ = 1, 4 do
      local err, finer = hold_out(scene, c)
      if err + scene.uncertainty <= 1 and finer <= 1 then
        scene.best, scene.held_error, scene.finer_error = c, err, finer
        return
      end
      tried[#tried + 1] = (
        "%s with h = %.4g misses it on the hold-out run: error %s, with half the step %s")
        :format(c.rule, c.h,
        report.error(scene, err), report.error(scene, finer))
      c.N = math.ceil(1.15 * c.N)
      c.h = scene.problem.T / c.N
    end
    c.failed = "dropped: " .. tried[#tried]
  end
  local words = {}
  for _, c in ipairs(scene.search.candidates) do
    words[#words + 1] = ("%s with h = %.3g errs by %s")
      :format(c.rule, c.h, report.error(scene, c.error))
    if #words == 8 then break end
  end
  error(("dm.scene: nothing that was tried delivers the tolerance: %s. Take a larger tolerance, "
    .. "or give more seconds")
    :format(table.concat(#tried > 0 and tried or words, "; ")), 0)
end

-- the one tolerance of all columns, nil where they have their own
local function unit_of(problem)
  local unit
  for _, name in ipairs(problem.columns) do
    if unit and unit ~= problem.tolerance[name] then return nil end
    unit = problem.tolerance[name]
  end
  return unit
end

local function sentence(problem, until_t)
  local parts = {}
  for _, name in ipairs(problem.columns) do
    parts[#parts + 1] = ("%s to %.3g"):format(name, problem.tolerance[name])
  end
  return ("scene: %s, until t = %g"):format(table.concat(parts, ", "), until_t)
end

local function start_search(scene, given)
  local times = merged(pilot.times(scene.problem, PILOT_TIMES, GOLDEN),
    pilot.times(scene.problem, HOLD_OUT_TIMES, SILVER))
  local record, distance, text = pilot.reference(given, times, scene.allowed / 4)
  local used = pilot.times(scene.problem, PILOT_TIMES, GOLDEN)
  scene.held_times = pilot.times(scene.problem, HOLD_OUT_TIMES, SILVER)
  scene.held = at_times(scene.problem, record, times, scene.held_times)
  scene.uncertainty, scene.reference_text = distance, text
  local now = core.cpu()
  return search.prepare({ times = used, reference = at_times(scene.problem, record, times, used),
    profile = scene.profile, bound = math.huge, pilots = 0,
    candidates = {}, models = {}, rules = search.rules(scene.options.rules, scene.system),
    seconds = scene.allowed,
    half_time = now + 0.4 * scene.allowed, deadline = now + scene.allowed }, scene.problem)
end

local function rows_text(scene)
  local every, err = rows.every(scene.best)
  scene.every, scene.lines = every, rows.lines(scene.best, every, err)
  if err <= 1 then
    return ("rows: one in %d steps; straight lines between them err by %s")
      :format(every, report.error(scene, err))
  end
  return ("rows: one a step; straight lines between them err by %s; with %d rows, by 'at', they "
    .. "would be as good as the tolerance")
    :format(report.error(scene, err), scene.lines)
end

-- find the choice, once
local function decide(scene)
  if scene.best then return scene end
  local began = core.cpu()
  local given = model.given(scene.problem):ready()
  scene.search = start_search(scene, given)
  scene.candidates = scene.search.candidates
  local split = scene.options.symmetry
    and require "dm.scene.symmetry".model(scene.problem, scene.options)
  scene.rungs = reduce.ladder(scene.search, given, split)
  for i = #scene.rungs, 1, -1 do search.model(scene.search, scene.rungs[i]) end
  scene.finalists = search.finalists(scene.search)
  choose(scene)
  scene.solver = pilot.solver(scene.best.model, scene.best.rule, scene.best.N)
  scene.check_text = ("check at %d other times: error %s, with half the step %s")
    :format(#scene.held_times, report.error(scene, scene.held_error),
      report.error(scene, scene.finer_error))
  scene.rows_text = rows_text(scene)
  scene.seconds = core.cpu() - began
  return scene
end

---- what a scene does ----

-- which rows: as asked for; of a picture those that lines need; else one in so many steps
local function rows_of(scene, options)
  option.check(options, ROWS, "scene:run", "{ at =, every =, file = }, or nothing")
  if options.at then
    local last = options.at[#options.at]
    if type(last) == "number" and last > scene.options.until_t then
      option.fail("scene:run", "option 'at': t = %g is after until_t = %g, up to which the "
        .. "tolerance is known", last, scene.options.until_t)
    end
    return options
  end
  if scene.options.watch == "picture" and not options.every and scene.lines then
    return { at = rows.times(scene.problem, scene.lines), file = options.file }
  end
  return { steps = scene.best.N, every = options.every or scene.every, file = options.file }
end

local function run(scene, options)
  decide(scene)
  local err = max(scene.best.error, scene.held_error) + scene.uncertainty
  return rows.path(scene.best, rows_of(scene, options or {}),
    { error_estimate = err * (scene.unit or 1),
    in_words = scene.unit and ("%.2g"):format(err * scene.unit) or ("%.2g of the tolerance")
      :format(err) })end

class.method("dm.scene", "run", run, [[
scene:run([{at=, every=, file=}]) -> path of what is watched
The chosen model by the chosen rule and step, with as many rows as straight lines between them need,
as far as there are steps (a picture: by rows between steps), or those asked for as in solver:run.
Beside all of dm.path it has error_estimate: the largest error of what is watched, from pilot runs,
a hold-out run and what is left of doubt in the reference (where columns have tolerances of their
own: in parts of these); and model, rule.]])

class.method("dm.scene", "why", function(scene) return report.why(decide(scene)) end, [[
scene:why() -> string
The ladder: each model with dimension, operations, error in what is watched, each rule with step,
cost and error, and why it was kept or dropped; the reference, the check, the choice.]])

local FRAMES = 600

class.method("dm.scene", "animate", function(scene, file, options)
  decide(scene)
  local path = run(scene, { at = rows.times(scene.problem,
    max(FRAMES, min(scene.lines or 0, 4 * FRAMES))) })
  return path:animate(file, options)
end, [[
scene:animate(file, {...}) -> file name
Run the scene and write a page with what is watched as a moving picture; options as in
path:animate.]])

function Scene:__tostring()
  if not self.best then return self.sentence .. "; nothing run yet: scene:run(), scene:why()" end
  return self.sentence .. ": " .. report.choice(self)
end

local doc_scene =
  "dm.scene{system, q=, v= | p=, watch=, tolerance=, until_t=, t0=, symmetry=, rules=, "
  .. "profile=, seconds=, project=} -> dm.scene\n" .. [[
The cheapest model and method that deliver what is watched. watch: names of coordinates, momenta
("p1") or "energy", name = function(q, v, t, p) ... end, or "picture": every coordinate, to a pixel.
tolerance: the largest error of each watched number up to the time until_t, in its units, or a table
name -> tolerance. Models: the system as given; without coordinates that nothing watched feels;
cyclic ones that are not watched reduced away (Routh), also those of a symmetry = { action =
f(theta, q), section = f(x) } as for system:routh; stiff terms of L as constraints; coordinates at
rest held; terms of L and of the force left out where that stays inside the tolerance. Rules: all of
dm.rules(), or a list `rules`. All of it is decided by pilot runs against a reference of two unlike
methods, and checked at other times and with half the step; where the tolerance cannot be promised,
scene:run() raises with everything that was measured. profile: a file of scene.profile:save(file):
costs are then not measured, and the choice is always the same. seconds: CPU time to be spent on
looking (default 20). scene:run(), scene:why(), scene:animate(file);
scene.candidates, scene.best.]]

M.scene = blame.caller(function(options)
  options = starts.lists(options)
  local system = check_options(options)
  options = starts.lists(options, system)
  local given = {}
  for key, value in pairs(options) do given[key] = value end
  local wanted = given.tolerance
  given.tolerance = wanted or 1
  if options.symmetry ~= nil then require "dm.scene.symmetry".check(options.symmetry) end
  local costs = read_profile(options.profile)
  local scene = setmetatable({ system = system, options = given, profile = costs,
    allowed = options.seconds or (costs.measures and SECONDS or WITHOUT_CLOCK) }, Scene)
  scene.problem = model.problem(system, given)
  if wanted == nil then
    local pixel = picture_tolerance(scene.problem, model.given(scene.problem):ready())
    for _, name in ipairs(scene.problem.columns) do scene.problem.tolerance[name] = pixel end
  end
  scene.unit, scene.sentence = unit_of(scene.problem), sentence(scene.problem, options.until_t)
  return scene
end)

core.docs[M.scene] = doc_scene

return M
