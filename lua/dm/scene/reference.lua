--- The reference of a scene (dm.reference.engine), and what to try where there is none.
local changes = require "dm.scene.changes"
local engine = require "dm.reference.engine"
local fail = require "dm.base.options".failing "dm.scene"
local forces = require "dm.reference.forces"
local pilot = require "dm.scene.pilot"

local M = {}

local ceil, floor, max, huge = math.ceil, math.floor, math.max, math.huge

-- tolerances: what the methods are asked to agree to, and what will do when the time is over
local AGREED, ENOUGH = 0.02, 0.1

---- what to try ----

-- the next number of one digit
local function rounded_up(x)
  local unit = 10 ^ floor(math.log(x, 10))
  return ("%.15g"):format(ceil(x / unit) * unit)
end

local MANY_TURNS = 1000 -- of a spring that is stiff beside the motion

-- a spring that references follow, watched or not: what stands in its place
local function of_spring(model)
  local spring = model.problem.units and changes.stiffest(model)
  local turns = spring and model.problem.T * spring.frequency / (2 * math.pi) or 0
  if turns < MANY_TURNS then return "" end
  return ("; or let a constraint stand for %s, which swings %.2g times: references follow all that "
    .. "moves, and prove what does not need it only so"):format(spring.unit.text, turns)
end

-- The seconds of the scene ended it, which has this share of them. A run that was no more than
-- begun tells no rate.
local function give_seconds(model, late, share, seconds)
  local more = late.seconds < huge and
    (", at that rate %s"):format(rounded_up(max(2 * seconds, late.seconds / share))) or ""
  return ("Give more seconds%s, or a shorter until_t (a larger tolerance is hardly faster)%s")
    :format(more, of_spring(model))
end

local OFFERED = 1000 -- times the tolerance: beyond it is no answer

-- both methods stay so many tolerances apart; nil: a run of theirs failed
local function take_tolerance(apart)
  if not apart then return "Take another start, or a shorter until_t" end
  return ("Is the motion chaotic over this time, or the tolerance below round-off? Take a %s, a "
    .. "shorter until_t, or watch something less sensitive"):format(apart < OFFERED
    and ("tolerance %s times as large"):format(rounded_up(apart / ENOUGH)) or "larger tolerance")
end

---- the reference ----

--- Two unlike methods on the system as given that agree, `best`: as closely as they can; "best, or
-- any": whatever that is. It has `share` of the seconds of the scene. Raises what was measured.
function M.find(model, seconds, share, except, best)
  local problem, start = model:ready().problem, model.start
  local found, why, late, apart = engine.find { system = model.system,
    start = { q = start.q, v = start.v, p = start.p, project = start.project },
    t0 = problem.t0, T = problem.T, watch = model.watch, tolerance = problem.tolerance,
    goal = best and 0 or AGREED, enough = ENOUGH, best = best == "best, or any",
    seconds = share * seconds, except = except, distance = function(a, b)
      return pilot.apart(problem, pilot.record(problem, a), pilot.record(problem, b))
    end }
  if found then
    problem.hidden = found.hidden and forces.of(model.system)
    return found
  end
  local nowhere = why:match "no start: .*"
  if nowhere then fail("%s", nowhere) end
  fail("the tolerance cannot be promised, since no reference is known that well: %s%s. %s", why,
    apart and " (tolerances)" or "",
    late and give_seconds(model, late, share, seconds) or take_tolerance(apart))
end

return M
