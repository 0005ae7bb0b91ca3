-- what a scene says where it cannot promise, and that it helps
local tap = require "tap"
local dm = require "dm"
local ok, sqrt = tap.ok, math.sqrt

-- what ended it, or nothing
local function refusal(options)
  local scene = dm.scene(options)
  local fine, why = pcall(scene.why, scene)
  return not fine and tostring(why) or nil, scene
end
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local function ellipse(more)
  local options = { kepler, q = { 0.5, 0 }, v = { 0, sqrt(3) }, watch = { "q1" }, tolerance = 1e-2 }
  for key, value in pairs(more) do options[key] = value end
  return refusal(options)
end

-- seconds that end the reference: how far it came, and about how many it takes
local why = ellipse { until_t = 1e7, seconds = 0.5 }
local reached, all = why:match "it had come to t = (%S+) of (%S+) when its"
ok(reached and tonumber(reached) < 1e7 and tonumber(all) == 1e7, "how far it came", why)
-- the seconds that a refusal says it needs: less than one on a fast machine
local function told(refused) return tonumber(refused:match "at that rate (%S+),") end
local needed = told(why)
ok(needed and needed > 0.5 * 1e7 / tonumber(reached) / 2, "and what it takes, which goes with the time that is left", needed)
ok(not why:find "constraint" and not why:find "failure.path" and why:find "a larger tolerance is hardly faster", "and nothing that does not help", why)

-- a stiff spring, off its length, of which only what is slow is watched
local function spring(k, seconds)
  return refusal { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end },
    q = { 1.001 * math.sin(0.5), -1.001 * math.cos(0.5) }, v = { 0, 0 }, watch = { slope = function(q) return q[1] / q:norm() end },
    tolerance = 1e-2, until_t = 20, seconds = seconds }
end
why = spring(1e10, 0.5)
local swings = tonumber(why:match "let a constraint stand for %-5000000000%*%(.*%)%^2, which swings (%S+) times")
ok(swings and math.abs(swings / (20 * 1e5 / (2 * math.pi)) - 1) < 0.02, "the term that asks for so many steps, and how often it swings", why)
needed = told(why)
ok(needed and needed >= 1, "the seconds", needed)
-- the seconds that are told are enough, of a machine that stays as fast: ten times as many here
why = spring(1e5, 0.1)
needed = why and told(why)
if needed then why = spring(1e5, 10 * needed) end
ok(why == nil, "with seconds as were told it is answered, by less than the spring", why)

-- a tolerance below what the references know: one that they do
local tolerance = 1e-14
why = ellipse { until_t = 50, tolerance = tolerance, seconds = 10 }
local times = why and tonumber(why:match "Take a tolerance (%d+) times as large")
ok(times and why:find "%(tolerances%)", "by what the tolerance falls short", why)
why = ellipse { until_t = 50, tolerance = tolerance * (times or 1), seconds = 10 }
ok(why == nil, "which is then promised", why)

-- a pilot run by a rule with a time of its own that stands still ends by its steps, not by seconds: 16 times as many as were
-- thought (of a spring of 1e6 it made three million in the place of 7000, as long as the seconds allowed)
do
  local problem_of, pilot = require "dm.scene.model", require "dm.scene.pilot"
  local problem = problem_of.problem(dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end },
    { q = { 0.5, 0 }, v = { 0, sqrt(3) }, until_t = 20, watch = { "q1" }, tolerance = 1e-2 })
  local model = problem_of.given(problem):ready()
  model.scales = { ["log-hamiltonian(verlet)"] = { length = 20 / 1000 } } -- a thousandth of what it is
  local fine, failure = pcall(pilot.go, model, "log-hamiltonian(verlet)", 100, { at = { 20 } })
  ok(not fine and failure.code == "out_of_time" and failure.step == 1600, "and so do those that stand still", fine or failure.step)
end

-- a watch that gives a list of one number is a column of its own name, as in a run
local listed = dm.scene { system = dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - q[1]^2)/2 end },
  q = { 1 }, v = { 0 }, watch = { x = function(q) return { q[1] } end }, tolerance = 1e-3, until_t = 1 }:run()
ok(math.abs(listed.x[#listed] - math.cos(1)) < 1e-3, "a list of one number", listed.columns)
tap.done()
