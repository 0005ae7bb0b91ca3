--- dm.scene: no more than needed. What is watched, how well, how long; the cheapest model, rule and
-- step that deliver it are found by pilot runs and checked.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local decide = require "dm.scene.decide"
local deadline = require "dm.scene.deadline"
local rule_alone = require "dm.base.rule_alone"
local starts = require "dm.base.start"
local model = require "dm.scene.model"
local option = require "dm.base.options"
local pilot = require "dm.scene.pilot"
local profile = require "dm.scene.profile"
local report = require "dm.scene.report"
local rows = require "dm.scene.rows"
local runs = require "dm.scene.run"
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
    rule_alone(system, pilot.controlled(rule) or rule)
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
  starts.check_one(options, WHERE)
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

---- what a scene is told by ----

-- of CPU; with a profile that was given no clock shall decide
local SECONDS, WITHOUT_CLOCK = 20, 600

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
seconds, as exactly as rules of fixed work can, or those of few iterations under constraints, where
something rolls, for L linear in v (scene.best.worst_step; with a tolerance: both, or it raises;
without one a plain run has a row a frame, whose error_estimate knows of no lines between them). On
a group entries of the element are watched (R31, of factor k R31_k), body momenta (p1), "energy" and
functions (g, xi, t, mu); the model is the system as given, as it is of an H without a Lagrangian;
one that is reduced (dm.euler_poincare) starts from p or v, and a. scene:run(), scene:why(),
scene:animate(file); scene.candidates, scene.best = { model, rule, N, h, n (dimension), work, ns,
error (of the tolerance, 1 at most) }.]]

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
