-- tangent maps end where the inertia of the orbit vanishes, as its runs do: random masses f v1 v2, whose values keep their
-- signs where f loses its own, and f v1^2; and go on where f has a dip alone. What is known of the place is that of the
-- orbit: tangent vectors grow otherwise near it, and short blocks of steps do not know how the mass fell before them
local tap = require "tap"
local dm = require "dm"

local random, drawn = dm.random(5), 0
local function between(a, b)
  drawn = drawn + 1
  return a + (b - a) * random:uniform(drawn, 1)
end

local count = { runs = 0, ended = 0, over = 0, refused = 0 }
for i = 1, 24 do
  local a, b, c, d = between(0.5, 1.5), between(-0.3, 0.3), between(0.5, 1.5), between(-1, 1)
  for _, dip in ipairs { 0, 0.3 } do
    local function f(q)
      local x = 1 - a * q[1] + b * q[2]
      return dip > 0 and x ^ 2 + dip or x
    end
    local system = dm.system { Q = dm.R(3), L = function(q, v)
      local T = i % 2 == 0 and f(q) * v[1] * v[2] or (f(q) * v[1] ^ 2 + v[2] ^ 2) / 2
      return T + v[3] ^ 2 / 2 - (d * q[2] + 0.2 * q[1] + q[3])
    end }
    for _, rule in ipairs { "rk4", "midpoint", "gauss(2)" } do
      local h = between(0.01, 0.05)
      local start = { q = { 0, 0, 0 }, v = { c, 0.3, 0.1 }, steps = math.ceil(2 / h) }
      local solver = system:solver { rule = rule, h = h }
      local goes, stopped = pcall(solver.run, solver, start)
      local follows, failure = pcall(solver.lyapunov, solver, start)
      count.runs = count.runs + 1
      count.ended = count.ended + (goes and 0 or 1)
      if follows and not goes then
        count.over = count.over + 1
        print(("# model %d, dip %g, %s, h = %g goes on over %s"):format(i, dip, rule, h, stopped))
      elseif goes and not follows then
        count.refused = count.refused + 1
        print(("# model %d, dip %g, %s, h = %g: %s"):format(i, dip, rule, h, failure))
      end
    end
  end
end
print(("# %d runs, %d end, %d tangent maps of these go on, %d of others end"):format(count.runs, count.ended, count.over, count.refused))
tap.ok(count.ended >= 50, "orbits come to such places", count.ended)
tap.ok(count.over == 0, "tangent maps end there", count.over)
tap.ok(count.refused == 0, "and nowhere else", count.refused)

-- runs of masses f v1 v2 that touch zero, f a square: momenta stay, so that v grows like 1/f, and a step that bounds tell is
-- short goes over the place
local over, runs = 0, 0
for _ = 1, 20 do
  local a, b, c, d = between(0.5, 1.5), between(-0.3, 0.3), between(0.5, 1.5), between(-1, 1)
  local system = dm.system { Q = dm.R(3), L = function(q, v)
    return (1 - a * q[1] + b * q[2]) ^ 2 * v[1] * v[2] + v[3] ^ 2 / 2 - (d * q[2] + 0.2 * q[1] + q[3])
  end }
  for _, rule in ipairs { "midpoint", "gauss(2)", "gauss(3)", "rk4", "verlet", "lobatto(3)" } do
    local h = between(0.01, 0.05)
    local fine, path = pcall(function() return system:solver { rule = rule, h = h }:run { q = { 0, 0, 0 }, v = { c, 0.3, 0.1 }, steps = math.ceil(3 / h) } end)
    local q = fine and path.q[#path]
    runs = runs + 1
    if fine and 1 - a * q[1] + b * q[2] < 0 then over = over + 1 end
  end
end
tap.ok(over == 0, ("none of %d runs is behind the place"):format(runs), over)
tap.done()
