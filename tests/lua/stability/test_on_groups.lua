-- dm.stability on groups: what is chaotic, where charts end, limits known in closed form
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local pi, sqrt = math.pi, math.sqrt

local G = dm.SO(3)
local function top(I, mgl)
  return dm.system { Q = G, L = function(R, w)
    return (I[1] * w[1] ^ 2 + I[2] * w[2] ^ 2 + I[3] * w[3] ^ 2) / 2 - mgl * R[3][3]
  end }
end

-- a symmetric body that swings from rest has two quadratic integrals more: nothing is chaotic. What
-- a lift has along its fibres grows with t^2, and is no change of the motion
local hung, rest = top({ 1, 1, 0.4 }, 4), G:exp { pi - 0.05, 0, 0 }
for _, rule in ipairs { "lie(1)", "rotations(2)", "gauss(2)", "verlet", "lobatto(3)" } do
  local map = dm.stability { system = hung, rule = rule, q = rest, v = { 0, 0, 0 }, steps = 2000,
    h = { 0.3, 0.8 }, refine = false }
  ok(#map.notes == 0, rule .. ": chaos is told of starts at rest", map.notes[1])
  for k, h in ipairs { 0.3, 0.8 } do
    local cell = map:at(1, k)
    ok(cell.class == "bounded" and cell.megno < 3, ("%s, h = %g: a swing is regular"):format(rule, h),
      cell.megno)
  end
end

-- and exponents of a chaotic one are those of solver:lyapunov
local wild, start = top({ 1, 1.3, 0.4 }, 4), { q = G:exp { 0.4, 0, 0 }, v = { 0.3, 0.2, 2 } }
for _, rule in ipairs { "lie(1)", "gauss(2)" } do
  local map = dm.stability { system = wild, rule = rule, q = start.q, v = start.v, steps = 3000,
    h = { 0.05 }, refine = false }
  local found = wild:solver { rule = rule, h = 0.05 }:lyapunov { q = start.q, v = start.v,
    steps = 3000 }
  ok(map:at(1, 1).class == "chaotic", rule .. ": a heavy body is chaotic")
  near(map:at(1, 1).exponent, found.exponent, 0.15, rule .. ": its exponent")
end

-- kicks and drifts lose an oscillation at h omega = 2, omega = sqrt(mgl/I)
local small = dm.stability { system = hung, rules = { "rotations(2)", "verlet" },
  q = G:exp { pi - 1e-3, 0, 0 }, v = { 0, 0, 0 }, steps = 500, h = { 0.5, 0.9, 1.1 }, chaos = false }
for i, rule in ipairs(small.rules) do
  near(small:limit(i), 1, 2e-3, rule .. ": the limit of a small swing")
end

-- a turn of nearly pi a step ends the chart: 2 rad a unit of time of a body that only spins
local spin = dm.stability { system = top({ 1, 1.2, 0.5 }, 0), rules = { "lie(1)", "rkmk4" },
  q = G:identity(), v = { 0, 0, 2 }, steps = 50, h = { 1, 1.4, 1.7 } }
for i, rule in ipairs(spin.rules) do
  local limit, why = spin:limit(i)
  ok(2 * limit > 2.9 and 2 * limit < pi, rule .. ": where a spinning body leaves the chart", limit)
  ok(why:find "the chart ends at pi", rule .. ": the sentence says so", why)
  ok(spin:at(i, 3).why:find "h turns the body by 3.4 rad", rule .. ": so does the cell",
    spin:at(i, 3).why)
end

-- a sleeping top wakes to u = cos(theta) = p3^2/(2 I mgl) - 1 where that is less than 1
local sleeping = dm.stability { system = top({ 1, 1, 0.5 }, 1), rules = { "gauss(2)", "lie(2)" },
  q = G:exp { 1e-3, 0, 0 }, p = function(p3) return { 0, 0, p3 } end, h = 0.05, steps = 4000,
  p3 = { 1.9, 1.96, 2.05 }, inside = function(g) return g[3][3] - 0.9 end, chaos = false,
  refine = false }
for i, rule in ipairs(sleeping.rules) do
  ok(sleeping:at(i, 1).class == "left" and sleeping:at(i, 2).class == "bounded"
    and sleeping:at(i, 3).class == "bounded", rule .. ": how far a sleeping top falls")
end

-- Steps of a third of a period: the polynomial through the last steps swings 31 times as far as
-- these do, and a root there turns the body elsewhere (2.1 rad for 0.05, without a word).
local slow = hung:solver { rule = "lie(1, gauss(1), cayley)", h = 1.38 }
local path = slow:run { q = rest, v = { 0, 0, 0 }, steps = 2000 }
local most = 1
for i = 1, #path do most = math.min(most, -path.q[i][3][3]) end
near(most, math.cos(0.05), 1e-6, "a swing of few steps stays what it is")
local members = slow:ensemble { members = 9, q = function() return rest end,
  v = function() return { 0, 0, 0 } end, steps = 2000 }
ok(G:distance(members.q[9], path.q[2001]) == 0, "and its members are the same")
near(path:drift "energy".largest, 0, 4 * 0.05 ^ 2 / 2, "energy")

-- the same of a joint, where lie(1) is RATTLE: at h omega = 1.9 q is cos(n theta)
local P = dm.product(G, dm.R(3))
local jointed = dm.system { Q = P, constraint = function(q)
  return q[2] - q[1] * dm.vector { 0, 0, 1 }
end, L = function(q, v)
  return 0.05 * (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) + (v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) / 2 - 4 * q[2][3]
end }
local long = jointed:solver { rule = "lie(1, gauss(1), cayley)", h = 1.9 / sqrt(4 / 1.1) }:run {
  q = { rest, rest * dm.vector { 0, 0, 1 } }, v = { 0, 0, 0, 0, 0, 0 }, steps = 500 }
most = 1
for i = 1, #long do most = math.min(most, -long.q[i][2][3]) end
near(most, math.cos(0.05), 1e-4, "a swing on a joint")

-- On R^n, too: at h omega = 2 itself rows are in step with the motion, and show it at rest. Cells
-- between were compared with that one, and the limit was 5 % too large.
local pendulum = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] ^ 2 / 2 + 4 * math.cos(q[1])
end }
near(pendulum:stability { rule = "verlet", q = { 1e-3 }, v = { 0 }, steps = 2000, chaos = false,
  h = { 0.5, 0.9, 1.1 } }:limit(1), 1, 2e-3, "the limit of a small pendulum")

-- rules that step groups alone: what they do to coordinates beside a body at rest is Verlet's rule,
-- and Runge-Kutta of orders 3 and 4
for _, case in ipairs { { "rotations(2)", 2 }, { "crouch-grossman3", sqrt(3) },
  { "rkmk4", 2 * sqrt(2) } } do
  near(dm.stability_limit(case[1]), case[2], 1e-4, case[1] .. ": its limit on the oscillator")
end
near(dm.amplification("rotations(2)", 1)[2][1], -0.75, 1e-14, "rotations(2) is Verlet's rule there")
tap.raises("unknown rule", dm.stability_limit, "none")
local theory, said = hung:stability { rule = "rotations(2)", q = rest, v = { 0, 0, 0 }, steps = 100,
  h = { 0.5 }, chaos = false, refine = false }:theory(1)
ok(theory == nil and said:find "the turn of the motion", "why a group has no linear theory", said)
tap.done()
