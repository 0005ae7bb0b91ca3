-- what the last increment of Newton's method moves P by is in the momentum of a step of lie(s): with an inertia that sees g it
-- was of one sign for hundreds of steps, and the energy drifted
package.path = (arg[0]:match("^(.*/)") or "./") .. "../?.lua;" .. package.path
local tap, dm = require "tap", require "dm"
local ok = tap.ok

local body = dm.system { Q = dm.SO(3), H = function(g, mu)
  return (mu[1] ^ 2 + 2 * mu[2] ^ 2 / (1 + 0.1 * g[3][3] ^ 2) + 0.5 * mu[3] ^ 2) / 2 + g[3][3]
end }

-- as far as Newton's method goes, against where it ends by itself
for _, rule in ipairs { "lie(1)", "lie(2)", "lie(3)", "lie(2, cayley)" } do
  local function run(newton)
    return body:solver { rule = rule, h = 0.05, newton = newton }:run { q = dm.SO(3):identity(), p = { 0.3, 0.5, 0.2 }, steps = 100 }
  end
  local path, all, apart = run(), run { tolerance = 1e-30, max_iterations = 50 }, 0
  for i = 1, #path do apart = math.max(apart, (path.p[i] - all.p[i]):norm()) end
  ok(apart < 4e-15, rule .. ": iterations that a step leaves out do not show", apart)
end

-- the energy of a rule whose own error is below round-off, over times of 800
local solver, slopes, mean, spread = body:solver { rule = "lie(4)", h = 0.04 }, {}, 0, 0
for k = 1, 5 do
  local path = solver:run { q = dm.SO(3):exp { 0.1 * k, 0.2, 0.3 }, p = { 0.3 * k, 0.5, 0.2 + 0.1 * k }, steps = 20000, every = 19 }
  slopes[k] = path:drift "energy".per_time
  mean = mean + slopes[k] / 5
end
for k = 1, 5 do spread = spread + (slopes[k] - mean) ^ 2 / 20 end
ok(math.abs(mean) < 2e-17, "lie(4) of an inertia that sees g: energy does not drift", ("%.1e +- %.1e a unit of time"):format(mean, math.sqrt(spread)))

-- members in lanes do the same
local function q(i) return dm.SO(3):exp { 0.1 * i, 0.2, 0.3 } end
local function p(i) return { 0.1 * i, 0.5, 0.2 } end
for _, rule in ipairs { "lie(1)", "lie(2)" } do
  local one = body:solver { rule = rule, h = 0.05 }
  local many, same = one:ensemble { members = 11, q = q, p = p, steps = 50, every = 50 }, true
  for i = 1, 11 do
    local alone, member = one:run { q = q(i), p = p(i), steps = 50 }, many:path(i)
    for k = 1, 3 do same = same and alone.p[51][k] == member.p[#member][k] end
  end
  ok(same, rule .. ": members have the bits of runs alone")
end
tap.done()
