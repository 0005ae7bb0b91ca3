-- Two bodies on springs, all forces linear but one, by rules of kicks and drifts at an h that is a ratio of small numbers:
-- roundings of h v and h f/2 then lie at few places, and J drifts (docs/benchmarks/drifts.md) where they have a mean
local dm = require "dm"
local tap = require "tap"

local springs = dm.system { Q = dm.R(4), L = function(q, v)
  local xx, xy, yy = q[1] ^ 2 + q[2] ^ 2, q[1] * q[3] + q[2] * q[4], q[3] ^ 2 + q[4] ^ 2
  return v:dot(v) / 2 - xx / 2 - 0.75 * yy / 2 - 0.25 * xy - 0.125 * yy ^ 2
end }
local function J(q, p) return q[1] * p[2] - q[2] * p[1] + q[3] * p[4] - q[4] * p[3] end

local STARTS, STEPS, ROWS, H = 20, 1000000, 500, 0.05
local random, drawn = dm.random(4), 0
local function near(x) drawn = drawn + 1 return x + 0.4 * (random:uniform(drawn, 0) - 0.5) end
local qs, vs = {}, {}
for i = 1, STARTS do
  qs[i] = { near(-0.7), near(0), near(0.3), near(0.2) }
  vs[i] = { near(0), near(-0.6), near(0.2), near(0.3) }
end

-- slopes of J per unit of time: their mean over its standard error by their spread. Products of h b and a force, rounded with the
-- low part of p, moved J by 2e-21 a step (verlet) and 5e-21 (symplectic-euler): 6 and 13 standard errors here, with fused products
for _, rule in ipairs { "verlet", "symplectic-euler", "symplectic-euler(b)", "blanes-moan(4)" } do
  local run = springs:solver { rule = rule, h = H }:ensemble { members = STARTS, q = dm.matrix(qs), v = dm.matrix(vs), steps = STEPS,
    every = STEPS // ROWS }
  local sum, square = 0, 0
  for i = 1, STARTS do
    local path, moments = run:path(i), {}
    for k = 1, #path do moments[k] = J(path.q[k], path.p[k]) end
    local slope = path:drift(dm.vector(moments)).per_time
    sum, square = sum + slope / STARTS, square + slope ^ 2
  end
  local error = math.sqrt((square - STARTS * sum ^ 2) / (STARTS * (STARTS - 1)))
  tap.ok(math.abs(sum) < 4 * error, ("J does not drift by %s: %.1e +- %.1e"):format(rule, sum, error))
  tap.ok(error < 3e-20, "and that would be seen", error)
end
tap.done()
