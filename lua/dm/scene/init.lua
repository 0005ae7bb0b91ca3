--- dm.scene: no more than needed. What is watched, how well, how long; the cheapest model, rule and
-- step that deliver it are found by pilot runs and checked.
local blame = require "dm.base.blame"
local central = require "dm.scene.central"
local choice = require "dm.scene.choice"
local class = require "dm.base.class"
local core = require "dm.core"
local deadline = require "dm.scene.deadline"
local independent = require "dm.measure.independent"
local linear = require "dm.scene.linear"
local starts = require "dm.base.start"
local model = require "dm.scene.model"
local narrow = require "dm.scene.narrow"
local option = require "dm.base.options"
local pilot = require "dm.scene.pilot"
local profile = require "dm.scene.profile"
local reduce = require "dm.scene.reduce"
local references = require "dm.scene.reference"
local relative = require "dm.scene.relative"
local report = require "dm.scene.report"
local rows = require "dm.scene.rows"
local runs = require "dm.scene.run"
local search = require "dm.scene.search"
local whole = require "dm.scene.whole"

local M = {}

local Scene = core.class({ __name = "dm.scene" }, [[
dm.scene: what is watched, how exactly, for how long; made by dm.scene{system=, q=, v=, watch=, ...}
fields: best (the choice), candidates (all that was measured), profile (the costs, to be saved)]])

local max, min = math.max, math.min

local WHERE = "dm.scene"
local fail = option.failing(WHERE)

---- options ----

local KNOWN = { 1, "system", "q", "v", "p", "t0", "watch", "tolerance", "until_t", "rules",
  "symmetry", "profile", "costs", "seconds", "project", "frame", "per_step" }

local function check_system(options)
  local system = options.system or options[1]
  local fine, given = blame.try(function() return system.given end)
  if not (type(system) == "userdata" and fine and given and (given.L or given.H)) then
    local meta = type(system) ~= "string" and getmetatable(system)
    local kind = type(meta) == "table" and meta.__name
    fail("option 'system' must be a dm.system (got %s)%s", kind or tostring(system), kind
      and system.solver and ": scenes know systems and fields on meshes; make a run, system:solver"
      or "")
  end
  return system
end

local function check_rules(rules, system)
  for _, rule in ipairs(rules) do
    if type(rule) ~= "string" then
      fail("option 'rules' must hold rules as texts, such as \"gauss(4)\" (got %s)", type(rule))
    end
    -- a misspelled one is told here
    system:solver { rule = pilot.controlled(rule) or rule, h = 1 }
  end
end

local function check_options(options)
  local named = type(options) == "table" and (options.system or options[1]) ~= nil
  local system = named and check_system(options)
  option.check(options, KNOWN, WHERE, "{ system =, q =, v =, watch =, tolerance =, until_t = }")
  system = system or check_system(options)
  if options.q == nil or (options.v == nil and options.p == nil) then
    fail("the start is missing: give q and v, or q and p")
  end
  if options.watch == nil then
    fail("nothing is watched: say in option 'watch' what is looked at")
  end
  deadline.check(options, option, WHERE)
  if options.tolerance == nil and options.watch ~= "picture" and not options.frame then
    fail("option 'tolerance' is missing: how well is it to be known?")
  end
  local t0 = option.number(options, "t0", WHERE, "a time", 0)
  local after = ("a time after the start, t0 = %g"):format(t0)
  option.need(options, "until_t", WHERE, after)
  local last = option.number(options, "until_t", WHERE, after)
  option.demand(last > t0, options, "until_t", WHERE, after)
  option.positive(options, "seconds", WHERE)
  if options.costs ~= nil and options.costs ~= "clock" and options.costs ~= "work" then
    fail("option 'costs' must be \"work\", counted operations, or \"clock\" (got %s)",
      option.got(options.costs))
  end
  check_rules(option.list(options, "rules", WHERE, "rules", {}), system)
  deadline.check_rules(options)
  return system
end

local function read_profile(given, costs)
  if given == nil then return profile.new(costs) end
  if type(given) == "string" then return profile.read(given) end
  if getmetatable(given) == profile then return given end
  fail("option 'profile' must be a file that scene.profile:save wrote, or the profile of another "
    .. "scene (got %s)", type(given))
end

---- constraints that follow from the others ----

-- the system without them, and their numbers; starts refuse them, and with project = all are kept
local function without_dependent(system, options)
  local given = system.given
  if not given.constraint or system.place or system.field or options.project then
    return system, {}
  end
  return system:independent { q = options.q, t = options.t0 }
end

-- raises where what was left out stops to hold along a run of the whole
local function look_at_dependent(scene, given)
  if #scene.left_out == 0 then return end
  local path, why = pilot.free_run(given, 1e-9, {})
  if not path then fail("constraints that were left out could not be looked at: %s", why) end
  independent.look(scene.system, path)
end

---- a picture ----

local PIXELS = 500  -- of the side of a picture: what is smaller is not seen

-- tolerance of a picture: a pixel of the largest extent, seen by a coarse run of the whole
local function picture_tolerance(problem, given)
  local path, why = pilot.free_run(given, 1e-6, { watch = given.watch })
  if not path then
    fail("watch = \"picture\": the tolerance was to be a pixel, but a first run failed: %s; give "
      .. "option 'tolerance'", why)
  end
  local extent = 0
  for _, name in ipairs(problem.columns) do
    local lo, hi = math.huge, -math.huge
    for _, x in ipairs(path:column(name):totable()) do lo, hi = min(lo, x), max(hi, x) end
    extent = max(extent, hi - lo)
  end
  if not (extent > 0) then fail("watch = \"picture\": nothing moves; give option 'tolerance'") end
  return extent / PIXELS
end

---- choosing ----

-- times at which models and rules are compared with the reference, and those of the check: at
-- least so many, at most so many, and per step of the reference; they fall in step with nothing
local PILOT_TIMES = { 256, 3000, 1, 0.6180339887498949 }
local CHECK_TIMES = { 2048, 20000, 8, 0.4142135623730951 }
-- of CPU; with a profile that was given no clock shall decide
local SECONDS, WITHOUT_CLOCK = 20, 600
-- Parts of the seconds that are over when reference, models, rules are to be done. The reference
-- cannot have more: its values at other times, the run of the choice and its check and the rows
-- cost as much again (Kepler's orbit, T = 1.2e4: 0.6 made it 3.6 s for 3).
local REFERENCE_TIME, MODELS_TIME, RULES_TIME = 0.45, 0.55, 0.72
local LEAST = 0.08  -- of them, for each of these, where those before took longer

local function mesh(reference, how)
  local steps = #reference.times
  return reference:mesh(min(how[2], max(how[1], how[3] * steps)), how[4])
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

local function sentence(problem, until_t, known)
  local parts = {}
  for _, name in ipairs(problem.columns) do
    parts[#parts + 1] = not known and name or ("%s to %.3g"):format(name, problem.tolerance[name])
  end
  return ("scene: %s, until t = %g"):format(table.concat(parts, ", "), until_t)
end

-- rules that are named are not those of the reference
local function named_rules(scene)
  local out = {}
  for _, rule in ipairs(scene.options.rules or {}) do out[pilot.controlled(rule) or rule] = true end
  return out
end

-- what is watched along the reference, at these times
local function known_at(scene, reference, times)
  local fine, path = blame.try(reference.path, reference, times)
  if fine then return pilot.record(scene.problem, path) end
  fail("the tolerance cannot be promised: the reference was known at %d times, but not at %d more: "
    .. "%s; give more seconds", #reference.at, #times, pilot.first_line(path))
end

local function start_search(scene, given)
  local reference = references.find(given, scene.allowed, REFERENCE_TIME, named_rules(scene),
    scene.options.frame and (scene.tolerant and "best" or "best, or any"))
  local times, problem = mesh(reference, PILOT_TIMES), scene.problem
  scene.check_times, scene.reference = mesh(reference, CHECK_TIMES), reference
  scene.checked = known_at(scene, reference, scene.check_times)
  scene.uncertainty = 2 * (scene.options.frame and reference.noise or reference.distance)
    + pilot.round_off(problem, scene.checked)
  scene.reference_text = ("%s agree to %.1e of the tolerance"):format(reference.text,
    reference.distance)
  return search.prepare({ times = times, reference = known_at(scene, reference, times),
    profile = scene.profile, bound = math.huge, pilots = 0, candidates = {}, models = {},
    resolved = #reference.times,
    fewest = narrow.present(given) and narrow.fewest(problem, reference.times, scene.check_times)
      or 1,
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

-- the dimension and the counted work of the choice, without set-up
local function describe(scene, c)
  c.n = c.model:size()
  c.cost = scene.profile:cost(c.model, c.rule, c.N)
  c.work = scene.profile.counts and c.cost or nil
  c.ns = scene.profile.counts and profile.time(c.model, c.rule, c.N) or c.cost
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

-- find the choice, once
local function decide(scene)
  if scene.best then return scene end
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
  describe(scene, scene.best)
  note_cut(scene)
  return conclude(scene)
end

---- what a scene does ----

local function run(scene, options)
  decide(scene)
  return runs.run(scene, options or {})
end

class.method("dm.scene", "run", run, [[
scene:run([{at=, every=, file=}]) -> path of what is watched
The chosen model by the chosen rule and step, with as many rows as straight lines between them need
to stay inside the tolerance, or those asked for as in solver:run. Raises where lines need more than
10^6 rows: give `at`. Beside all of dm.path it has error_estimate: the largest error of what is
watched, at the rows and, of a plain run, on straight lines between them, with what is left of doubt
in the reference (where columns have tolerances of their own: in parts of these); and model,
rule.]])

class.method("dm.scene", "why", function(scene) return report.why(decide(scene)) end, [[
scene:why() -> string
The ladder: each model with dimension, operations, error in what is watched, each rule with step,
cost and error, and why it was kept or dropped; the reference, the check, the choice, and what the
least model costs where another one is cheaper.]])

local FRAMES = 600

class.method("dm.scene", "animate", function(scene, file, options)
  decide(scene)
  if not scene.best.per_frame then runs.space(scene) end
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
  .. "profile=, costs=, seconds=, frame=, per_step=, project=} -> dm.scene\n" .. [[
The cheapest model and method that deliver what is watched. watch: names of coordinates, momenta
("p1") or "energy", name = function(q, v, t, p) ... end, or "picture": every coordinate, to a pixel.
tolerance: the largest error of each watched number at every time up to until_t, in its units, or a
table name -> tolerance. Models: the system as given, without constraints that follow from the
others (system:independent; with project they stay, and are refused); without coordinates that
nothing watched feels; in relative coordinates where a common motion changes nothing; in the plane
of motion where turns change nothing; cyclic coordinates reduced away (Routh), also those of a
symmetry = { action = f(theta, q), section = f(x) } as for system:routh; linear, in the modes that
are seen, with drag, gyroscopic terms and forces in t too that are sums of c t^k e^(mu t), solved in
closed form (scene.best.rule is "exact"); stiff terms of L as constraints; coordinates at rest held;
terms left out where that stays inside the tolerance. Rules: all of dm.rules(), log-hamiltonian(...)
and "controlled(rk8)", whose steps are as long as their error allows, or a list `rules`. All of it
is measured against two unlike methods with controlled steps that jump over nothing hidden in the
forces, and checked at other times and between them; where the tolerance cannot be promised,
scene:run() raises with everything that was measured (docs/theory/trust.md). Costs are counted
operations (scene.best.work), so that two scenes choose alike; costs = "clock" measures ns; profile:
a file of scene.profile:save(file) has them. seconds: CPU time to be spent on looking (default 20);
scene.cut says what they left out. frame, per_step: each frame of model time costs at most per_step
seconds, as exactly as rules of fixed work can, under constraints rattle and its compositions
(scene.best.worst_step; with a tolerance: both, or it raises; without one a plain run has a row a
frame, whose error_estimate knows of no lines between them). On a group entries of the element are
watched (R31, of factor k R31_k), body momenta (p1), "energy" and functions (g, xi, t, mu); the
model is the system as given, as it is of an H without a Lagrangian; one that is reduced
(dm.euler_poincare) starts from p or v, and a. scene:run(), scene:why(), scene:animate(file);
scene.candidates, scene.best = { model, rule, N, h, n (dimension), work, ns, error (of the
tolerance, 1 at most) }.]]

M.scene = blame.caller(function(options)
  options = starts.of_system(options)
  local system = check_options(options)
  if whole.is(system) then whole.check(system, options) end
  options = starts.lists(options, system)
  local left_out
  system, left_out = without_dependent(system, options)
  local given = {}
  for key, value in pairs(options) do given[key] = value end
  local wanted = given.tolerance
  given.tolerance = wanted or 1
  if options.symmetry ~= nil then require "dm.scene.symmetry".check(options.symmetry) end
  local costs = read_profile(options.profile, options.costs or "work")
  local scene = setmetatable({ system = system, options = given, profile = costs,
    allowed = options.seconds or (costs.measures and SECONDS or WITHOUT_CLOCK) }, Scene)
  scene.tolerant, scene.left_out = wanted ~= nil, left_out
  scene.problem = (whole.is(system) and whole or model).problem(system, given)
  if wanted == nil and options.watch == "picture" then
    local pixel = picture_tolerance(scene.problem, model.given(scene.problem):ready())
    for _, name in ipairs(scene.problem.columns) do scene.problem.tolerance[name] = pixel end
  end
  scene.unit, scene.sentence = unit_of(scene.problem), sentence(scene.problem, options.until_t,
    scene.tolerant or not options.frame)
  return scene
end)

core.docs[M.scene] = doc_scene

return M
