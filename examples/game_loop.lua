-- A game draws sixty frames a second, and physics may have a tenth of a millisecond of each: dm.scene finds the rule of fixed work that is most exact in
-- that time, and says what the slowest frame took. Then the loop is played, frame by frame, beside the pendulum solved far more finely.
local dm = require "dm"

local frame, budget, T = 1 / 60, 1e-4, 10
local pendulum = dm.system { name = "pendulum", Q = dm.R(1), coordinates = { "theta" }, L = function(q, v) return v[1] ^ 2 / 2 + 9.81 * math.cos(q[1]) end }
local start = { q = { 2 }, v = { 0 } }

local scene = dm.scene { pendulum, q = start.q, v = start.v, watch = { "theta" }, until_t = T, frame = frame, per_step = budget, seconds = 2 }
local run, best = scene:run(), scene.best
print(scene:why():match "^[^\n]*\n[^\n]*\n[^\n]*")
print(("%s, %d steps a frame: the slowest of %d frames took %.2g us of %.0f, theta is right to %.1e")
  :format(best.rule, best.per_frame, best.frames, 1e6 * best.worst_step, 1e6 * budget, run.error_estimate))
assert(best.worst_step <= budget, "the deadline is kept")

-- the loop itself: one call a frame, from where the last one ended
local solver, q, p = pendulum:solver { rule = best.rule, h = best.h }, start.q, { 0 }
local frames, at = 0, {}
while frames * frame < T - 1e-9 do
  local path = solver:run { q = q, p = p, steps = best.per_frame, every = best.per_frame }
  q, p, frames = path.q[#path], path.p[#path], frames + 1
end
at[1] = T
local truth = pendulum:solver({ rule = "gauss(6)", h = 0.01 }):run { q = start.q, v = start.v, at = at }
local off = math.abs(q[1] - truth.q[1][1])
print(("after %d frames theta = %.6f, off by %.1e"):format(frames, q[1], off))
assert(off <= run.error_estimate + 1e-9, "the loop is as exact as the scene says")

-- what no rule can do is said before the game begins
local fine, why = pcall(function() return dm.scene { pendulum, q = start.q, v = start.v, watch = { "theta" }, until_t = 1, frame = frame, per_step = 1e-12 }:run() end)
assert(not fine and tostring(why):find "per_step", "a deadline that nothing keeps is refused")
