-- A heavy top by rotations(2) at an h that is a ratio of small numbers: what rounding leaves of a kick then lies at few places, and
-- the vertical momentum drifts where turns do not see it (docs/benchmarks/drifts.md)
local dm = require "dm"
local tap = require "tap"
local STARTS, STEPS, ROWS = tap.watched and 2 or 20, tap.watched and 10000 or 1000000, 500

local G = dm.SO(3)
local top = dm.system { Q = G, L = function(R, w) return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3] end }
local random, drawn = dm.random(11), 0
local function draw() drawn = drawn + 1 return random:uniform(drawn, 0) end

-- mean slope of J per unit of time, and its standard error by the spread of all starts
local function slope()
  local q, v = {}, {}
  for i = 1, STARTS do
    q[i], v[i] = G:exp { 2 * draw() - 1, 2 * draw() - 1, 2 * draw() - 1 }, { draw(), draw(), 1 + draw() }
  end
  local run = top:solver { rule = "rotations(2)", h = 0.1 }:ensemble { q = q, v = v, members = STARTS, steps = STEPS, every = STEPS // ROWS }
  local sum, square = 0, 0
  for i = 1, STARTS do
    local path, J = run:path(i), {}
    for k = 1, #path do
      local R, p = path.q[k], path.p[k]
      J[k] = R[3][1] * p[1] + R[3][2] * p[2] + R[3][3] * p[3]
    end
    local one = path:drift(dm.vector(J)).per_time
    sum, square = sum + one / STARTS, square + one ^ 2
  end
  return sum, math.sqrt((square - STARTS * sum ^ 2) / (STARTS * (STARTS - 1)))
end

-- it was 5.3e-19 +- 1.3e-19 at plain
local level = os.getenv "DMLUA_TURNS"
local mean, err = slope()
tap.ok(tap.watched or math.abs(mean) < 2.5e-19, ("J does not drift: %.1e +- %.1e"):format(mean, err))
tap.ok(tap.watched or err < 1.2e-19, "and that would be seen", err)
if not level then
  local fine = os.execute(("DMLUA_TURNS=1 DMLUA_PROCESSOR=plain %s %s >/dev/null"):format(arg[-1], arg[0]))
  tap.ok(fine, "the same without fused products")
end
tap.done()
