-- runs of an L linear in v: what reads v is refused (it was that of the start), all else is seen
local tap = require "tap"
local dm = require "dm"

local vortex = dm.system { Q = dm.R(2),
  L = function(q, v) return q[1] * v[2] - (q[1]^2 + q[2]^2) / 2 end }
local solver = vortex:solver { rule = "degenerate(2)", h = 0.1 }
local function run(more)
  more.q, more.steps = { 1, 0 }, 20
  return solver:run(more)
end
tap.raises("watch.speed reads v", run, { watch = { speed = function(_, v) return v:norm() end } })
tap.raises("reads v", run, { events = { turn = function(_, v) return v[1] end } })
local path = run { watch = { x = function(q, v) return q[1] + 0 * v[1] end, "energy",
  p2 = function(_, _, t, p) return p[2] + t end } }
tap.near(path:column "x"[21], math.cos(2), 1e-4, "q is seen")
tap.near(path:column "p2"[21], math.cos(2) + 2, 1e-4, "p is seen")
tap.near(path:column "energy"[21], 0.5, 1e-10, "and the energy")
tap.done()
