--- A deadline: every frame of model time costs at most so many seconds, by rules of fixed work, as
-- accurately as that allows.
local blame = require "dm.base.blame"
local choice = require "dm.scene.choice"
local core = require "dm.core"
local pilot = require "dm.scene.pilot"
local report = require "dm.scene.report"

local M = {}

local max, min, floor, huge = math.max, math.min, math.floor, math.huge

local fail = require "dm.base.options".failing "dm.scene"

-- explicit, or with so many sweeps and no more: what a step costs does not depend on the state
local RULES = { "verlet", "blanes-moan(4)", "blanes-moan(6)", "blanes-moan(6, 14)", "kahan-li(6)",
  "kahan-li(8)", "sofroniou-spaletta(10)", "rk4", "rk8", "gauss(2, 4)", "gauss(4, 6)" }
local SWEEPS = { ["gauss(2, 4)"] = true, ["gauss(4, 6)"] = true }
-- two or three iterations in each step: with constraints, where something rolls, of an L that is
-- linear in v
local BOUND = { "rattle", "suzuki(4, rattle)", "kahan-li(6, rattle)", "kahan-li(8, rattle)" }
local ROLLING = { "midpoint", "gauss(2)", "gauss(3)", "gauss(4)" }
local FIRST_ORDER = { "degenerate(1)", "degenerate(2)", "degenerate(3)", "degenerate(4)" }
local PARTS = 0.5     -- of the deadline that the steps of a frame may take as they are first timed
local MOST = 4096     -- steps of a frame
local REPLAYS, FRAMES = 3, 1e5
local RULES_TIME = 0.8  -- of the seconds, when all rules are to be done; the rest is for the frames
local TIMED = 64      -- steps that a first timing goes over
local SHORTER = 8     -- so many times, where such steps fail

--- frame and per_step of the options: both or neither.
function M.check(options, option, where)
  if options.frame == nil and options.per_step == nil then return nil end
  for _, key in ipairs { "frame", "per_step" } do option.positive(options, key, where) end
  if not options.frame then
    fail("option 'frame' is missing: per_step is the time for a frame of how much model time?")
  end
  if not options.per_step then
    fail("option 'per_step' is missing: how many seconds may a frame of %g cost?", options.frame)
  end
end

--- Rules that are named end their steps at the frames.
function M.check_rules(options)
  for _, rule in ipairs(options.frame and options.rules or {}) do
    if not pilot.is_even(rule) then
      fail("option 'rules': steps of %s end at no frame, since they choose their length; with a "
        .. "deadline take rules of even steps, or leave 'rules' out", rule)
    end
  end
end

-- s of a step of length h, the least of several runs; whether it iterates
local function step_seconds(model, rule, h, steps)
  local solver, best = model.system:solver { rule = rule, h = h }, huge
  for _ = 1, REPLAYS do
    solver:run(pilot.options_of(model, { steps = steps, every = steps }))
    best = min(best, 1e-9 * solver:report().ns_per_step)
  end
  return best, solver:report().newton_per_step > 0
end

-- so many steps of a rule in a frame as the deadline has room for; nil: not even one. Where steps
-- as long as a frame run away from what is stiff, shorter ones are timed
local function steps_of(scene, model, rule, explicit)
  local frame, steps, parts = scene.problem.T / scene.frames, min(TIMED, scene.frames), 1
  local fine, seconds, iterates
  repeat
    fine, seconds, iterates = blame.try(step_seconds, model, rule, frame / parts, steps)
    parts = SHORTER * parts
  until fine or parts > MOST or pilot.is_refusal(pilot.first_line(seconds))
  if not fine then error(seconds, 0) end
  if iterates and explicit then
    error("its steps iterate for this L: their work is not fixed", 0)
  end
  local fits = PARTS * scene.options.per_step / seconds
  return fits >= 1 and min(MOST, floor(fits)) or nil
end

-- an error as far as the reference tells it: what is nearer than that is so by chance
local function seen(scene, err) return max(err, scene.uncertainty) end

-- rules that are looked at, and whether they iterate
local function rules_of(scene, system)
  local s = system:structure()
  local iterating = s.rolling > 0 and ROLLING or s.constraints > 0 and BOUND
    or s.linear_in_v and FIRST_ORDER
  local named = scene.options.rules
  return named or iterating or RULES, named or iterating
end

-- every rule of fixed work that has room, with what it errs by
local function candidates(scene, model)
  local out, refused = {}, {}
  local rules, iterating = rules_of(scene, model.system)
  for _, rule in ipairs(rules) do
    if #out > 0 and core.cpu() > scene.began + RULES_TIME * scene.allowed then
      scene.search.cut = true
      break
    end
    local fine, steps = blame.try(steps_of, scene, model, rule,
      not (iterating or SWEEPS[rule]))
    if fine and steps then
      -- fewer steps may be more accurate: round-off
      for _, fewer in ipairs { 1, 4, 16 } do
        local per_frame = max(1, steps // fewer)
        local N = per_frame * scene.frames
        local record, why = pilot.run(model, rule, N, scene.check_times)
        local err = record and seen(scene, pilot.apart_between(scene.problem, record,
          scene.checked)) or huge
        out[#out + 1] = { model = model, rule = rule, N = N, h = scene.problem.T / N, error = err,
          per_frame = per_frame, kept = err < huge, n = model.system.Q.dimension,
          order = 1, cost = N }
        if not record then
          refused[#refused + 1] = ("%s, %d steps a frame: %s"):format(rule, per_frame, why)
        end
        if per_frame == 1 then break end
      end
    else
      refused[#refused + 1] = rule .. ": " .. (fine and "one step takes longer"
        or pilot.first_line(steps))
    end
  end
  return out, refused
end

-- s of the slowest of the frames that the seconds have room for, each by the least of its replays
local function worst_frame(scene, c)
  local problem, worst, frames = scene.problem, 0, 0
  local solver = c.model.system:solver { rule = c.rule, h = c.h }
  local q, p, t = c.model.start.q, c.model.start.p, problem.t0
  local v, over = c.model.start.v, scene.began + scene.allowed
  while frames < min(FRAMES, scene.frames) and (frames < 1 or core.cpu() < over) do
    local best, path = huge, nil
    for _ = 1, REPLAYS do
      path = solver:run { q = q, v = not p and v or nil, p = p, t0 = t, steps = c.per_frame,
        every = c.per_frame, project = c.model.start.project }
      best = min(best, 1e-9 * path.ns_per_step * c.per_frame)
    end
    worst, frames = max(worst, best), frames + 1
    q, p, t = path.q[#path], path.p[#path], problem.t0 + frames * problem.T / scene.frames
  end
  return worst, frames
end

local function sort(list)
  table.sort(list, function(a, b)
    return a.error < b.error or (a.error == b.error and a.N < b.N)
  end)
end

-- put what errs least of number `at` and those after it there, with what it errs by between the
-- times of the check, too
local function most_exact(scene, list, at)
  local rest = table.move(list, at, #list, 1, {})
  sort(rest)
  while rest[1].error < huge and not rest[1].sure do
    rest[1].error = seen(scene, choice.check_error(scene, rest[1], rest[1].N))
    rest[1].sure = true
    sort(rest)
  end
  table.move(rest, 1, #rest, at, list)
  return list[at]
end

--- The choice of a scene with a deadline: among rules of fixed work the one that errs least, whose
-- slowest frame keeps it. `tolerant`: it must deliver the tolerance, too.
function M.choose(scene, model, tolerant)
  local options = scene.options
  scene.frames = max(1, math.ceil(scene.problem.T / options.frame - 1e-9))
  local list, refused = candidates(scene, model)
  for at in ipairs(list) do
    local c = most_exact(scene, list, at)
    if c.error < huge then
      c.worst_step, c.frames = worst_frame(scene, c)
      if c.worst_step <= options.per_step then
        if tolerant and c.error + scene.uncertainty > 1 then
          fail("no rule that keeps per_step = %g s delivers the tolerance: %s errs by %s; take "
            .. "either larger", options.per_step, c.rule, report.error(scene, c.error))
        end
        scene.finalists, scene.candidates = list, list
        return c
      end
      refused[#refused + 1] = ("%s: a frame took %.2g s"):format(c.rule, c.worst_step)
    end
  end
  fail("no rule keeps per_step = %g s for a frame of %g: %s", options.per_step, options.frame,
    table.concat(refused, "; "))
end

return M
