-- masses that touch zero in other ways than test_touched_masses: at a time, for any velocity of an L
-- that is not quadratic, along a constraint, on a group. And what only looks alike: a mass that is
-- zero for one velocity alone, whose momentum determines v all the same; poles that move, under
-- constraints and on groups. And one that is lost in rounding.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local stream, drawn = dm.random(31), 0
local function uniform(a, b)
  drawn = drawn + 1
  return a + (b - a) * stream:uniform(drawn, 0)
end
local function either(a, b)
  if uniform(0, 1) < 0.5 then return a end
  return b
end

local ON_R = { "verlet", "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)", "rk4", "rk8" }
local KNOW_CONSTRAINTS = { "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)" }
local ON_GROUPS = { "lie(1)", "lie(2)", "rkmk4", "crouch-grossman3", "midpoint", "gauss(2)" }
local V = function(q) return q:dot(q) / 2 end

-- each: the system, a start, for how long; on which side of the place (q, t) is; the rules
local kinds = {}

-- (t - c)^k u1^2/2 in slanted velocities; c is a node, half of the times
function kinds.time()
  local n, c, k = math.floor(uniform(1, 4)), uniform(0.2, 0.9), either(2, 4)
  local a, sine = n > 1 and either(0, uniform(-0.4, 0.4)) or 0, either(true, false)
  local system = dm.system { Q = dm.R(n), L = function(q, v, t)
    local w = sine and dm.sin(t - c) or t - c
    local T = w ^ k * (v[1] + (n > 1 and a * v[2] or 0)) ^ 2 / 2
    if n > 1 then T = T + (v[2] - a * v[1]) ^ 2 / 2 end
    if n > 2 then T = T + (1.5 + dm.cos(q[2])) * v[3] ^ 2 / 2 end
    return T - V(q)
  end }
  local q, v = {}, {}
  for i = 1, n do q[i], v[i] = uniform(-1, 1), uniform(-1, 1) end
  return system, { q = q, v = v }, 2 * c, function(_, t) return t > c + 1e-9 end, ON_R,
    either(c / math.floor(uniform(10, 40)), uniform(0.01, 0.05))
end

-- w(q)^k T(u1), T not quadratic
function kinds.velocity()
  local c, k, cosh, side = uniform(-0.3, 0.3), either(2, 4), either(true, false), either(1, -1)
  local system = dm.system { Q = dm.R(1), L = function(q, v)
    local T = cosh and dm.cosh(v[1]) or v[1] ^ 2 / 2 + v[1] ^ 4 / 12
    return (q[1] - c) ^ k * T - V(q)
  end }
  return system, { q = { c + side * uniform(0.3, 1) }, v = { -side * uniform(0, 2) } }, 4,
    function(q) return (q[1] - c) * side < 0 end, ON_R
end

-- on a sphere: the mass along a meridian or a parallel
function kinds.constraint()
  local k, c, meridian = either(2, 4), uniform(-0.5, 0.5), either(true, false)
  local function place(q) return (meridian and q[3] or q[1]) - c end
  local system = dm.system { Q = dm.R(3), L = function(q, v)
    local turn, rise = q[1] * v[2] - q[2] * v[1], v[3]
    if meridian then turn, rise = rise, turn end
    return place(q) ^ k * turn ^ 2 / 2 + rise ^ 2 / 2 + q:dot(v) ^ 2 / 2 - q[3] / 2
  end, constraint = function(q) return q:dot(q) - 1 end }
  local z, phi, vz, w = uniform(-0.7, 0.7), uniform(-3, 3), uniform(-1, 1), uniform(-1, 1)
  local r = (1 - z * z) ^ 0.5
  local x, y = r * math.cos(phi), r * math.sin(phi)
  local from = place { x, y, z } > 0
  return system, { q = { x, y, z }, v = { -w * y - z * vz / r ^ 2 * x, w * x - z * vz / r ^ 2 * y, vz } }, 3,
    function(q) return (place(q) > 0) ~= from end, KNOW_CONSTRAINTS
end

-- rolling, with the mass of what does not roll
function kinds.rolling()
  local k, c, side = either(2, 4), uniform(-0.3, 0.3), either(1, -1)
  local system = dm.system { Q = dm.R(3), L = function(q, v)
    return (q[1] - c) ^ k * v[1] ^ 2 / 2 + v[2] ^ 2 / 2 + v[3] ^ 2 / 2 - V(q)
  end, rolling = function(q, v) return v[3] - dm.sin(q[1]) * v[2] end }
  local x, v2 = c + side * uniform(0.3, 1), uniform(-1, 1)
  return system, { q = { x, 0.2, 0.1 }, v = { -side * uniform(0, 2), v2, math.sin(x) * v2 } }, 4,
    function(q) return (q[1] - c) * side < 0 end, KNOW_CONSTRAINTS
end

-- on SO(3): the inertia about an axis of the body
function kinds.group()
  local k, c = either(2, 4), uniform(-0.5, 0.5)
  local G = dm.SO(3)
  local system = dm.system { Q = G, L = function(g, w)
    return ((g[3][1] - c) ^ k * w[1] ^ 2 + 1.3 * w[2] ^ 2 + 0.8 * w[3] ^ 2 - g[3][3]) / 2
  end }
  local g = G:exp { uniform(-1, 1), uniform(-1, 1), uniform(-1, 1) }
  local from = g[3][1] > c
  return system, { q = g, v = { uniform(-2, 2), uniform(-1, 1), uniform(-1, 1) } }, 3,
    function(q) return (q[3][1] > c) ~= from end, ON_GROUPS
end

for _, kind in ipairs { "time", "velocity", "constraint", "rolling", "group" } do
  local runs, over, named, unlike = 0, 0, 0, 0
  for i = 1, math.max(20, tap.samples(60)) do -- fewer tell nothing
    local system, start, time, behind, rules, h = kinds[kind]()
    h = h or uniform(0.01, 0.05)
    start.steps = math.ceil(time / h)
    for _, rule in ipairs(rules) do
      local solver = system:solver { rule = rule, h = h }
      local fine, result = pcall(solver.run, solver, start)
      local path, goes_over = fine and result or result.path, false
      for j = 2, #path do goes_over = goes_over or behind(path.q[j], path.t[j]) end
      runs, over = runs + 1, over + (goes_over and 1 or 0)
      named = named + (not fine and (result.code == "inertia" or result.fading) and 1 or 0)
      if i % 4 == 0 and kind ~= "group" then
        local members = solver:ensemble { members = 3, steps = start.steps, threads = 1,
          q = function() return start.q end, v = function() return start.v end }
        local code, steps = fine and "ok" or result.code, fine and start.steps or result.step - 1
        if members.status[2] ~= code or members.steps[2] ~= steps then unlike = unlike + 1 end
      end
    end
  end
  -- before: 17 %, 37 %, 13 %, 6 %, 5 % of random runs like these
  ok(over <= runs / 50, kind .. ": hardly a run goes over such a place", over .. " of " .. runs)
  ok(named > runs / 12, "many come to one and are told by name", named)
  ok(unlike <= runs / 100, "members end as runs of their own", unlike)
end

---- what goes on ----

local refused = 0
local function goes_on(system, q, v, rules, h)
  for _, rule in ipairs(rules) do
    local solver = system:solver { rule = rule, h = h or 0.02 }
    local fine, e = pcall(solver.run, solver, { q = q, v = v, steps = 200 })
    if not fine and (e.code == "inertia" or e.fading) then refused = refused + 1 end
  end
end
for i = 1, 10 do
  local a, turn, v = uniform(-1, 1), i % 2 * uniform(0.05, 1), uniform(0.3, 1)
  local function quartic(f)
    return dm.system { Q = dm.R(1), L = function(q, u) return f(q[1], u[1]) ^ 4 / 12 - V(q) end }
  end
  goes_on(quartic(function(_, u) return u end), { a }, { v }, ON_R)
  goes_on(quartic(function(_, u) return u - a end), { a }, { v }, ON_R)
  goes_on(quartic(function(q, u) return u - a * q end), { 0.2 }, { v }, ON_R)
  goes_on(dm.system { Q = dm.R(2), L = function(q, u, t)
    local r = q[1] - a * t
    return ((u[1] - a) ^ 2 + r ^ 2 * u[2] ^ 2 - r ^ 2) / 2
  end }, { 0.4, 0.3 }, { -v, turn }, ON_R)
  goes_on(dm.system { Q = dm.R(3), L = function(q, u)
    return (u[1] ^ 2 + q[1] ^ 2 * u[2] ^ 2 + u[3] ^ 2) / 2 - q[3]
  end, constraint = function(q) return q[3] - q[1] ^ 2 / 2 end }, { 0.4, 0.2, 0.08 },
    { -v, turn, -0.4 * v }, KNOW_CONSTRAINTS)
  goes_on(dm.system { Q = dm.product(dm.SO(3), dm.R(2)), L = function(q, w)
    local r = q[2][1]
    return (w[1] ^ 2 + 1.3 * w[2] ^ 2 + 0.8 * w[3] ^ 2 + w[4] ^ 2 + r ^ 2 * (w[5] ^ 2 - 1)) / 2
  end }, { dm.SO(3):identity(), { 0.4, 0.2 } }, { 0.3, a, 0.1, -v, turn }, ON_GROUPS)
end
ok(refused == 0, "poles that move, under constraints, on groups; quartics", refused)

-- ... beside other velocities, whose momenta are larger by far (the search for v was lost below 1e-3,
-- and 94 of 300 runs of such an L ended by it)
do
  local system = dm.system { Q = dm.R(2), L = function(q, u)
    return (1.5 + dm.sin(q[2])) * u[1] ^ 4 / 12 + (2 + dm.cos(q[1])) * u[2] ^ 2 / 2 - V(q) end }
  local solver, worst = system:solver { rule = "rk4", h = 1e-9 }, 0
  for _, p1 in ipairs { 1, 1e-2, 1e-4, 1e-6, 1e-9 } do
    for _, p2 in ipairs { 0.01, -0.5, 20 } do
      local v = solver:run({ q = { 0.3, 0.4 }, p = { p1, p2 }, steps = 1 }):velocity(1)
      local v1, v2 = (3 * p1 / (1.5 + math.sin(0.4))) ^ (1 / 3), p2 / (2 + math.cos(0.3))
      worst = math.max(worst, math.abs(v[1] / v1 - 1), math.abs(v[2] / v2 - 1))
    end
  end
  ok(worst < 1e-14, "v of a quartic beside a square", worst)
  local ended = 0
  for _ = 1, 5 do
    for _, rule in ipairs { "rk4", "rk8", "gauss(2)" } do
      local one = system:solver { rule = rule, h = 0.02 }
      local fine = pcall(one.run, one, { q = { uniform(-1, 1), uniform(-1, 1) },
        v = { uniform(0.3, 1), uniform(-1, 1) }, steps = 300 })
      ended = ended + (fine and 0 or 1)
    end
  end
  ok(ended == 0, "and its runs go on", ended)
end

-- ... to what their momenta determine: q' = (3 p)^(1/3), p' = -q by Heun's steps
do
  local system = dm.system { Q = dm.R(1), L = function(q, u) return u[1] ^ 4 / 12 - V(q) end }
  local function root(x) return x < 0 and -(-x) ^ (1 / 3) or x ^ (1 / 3) end
  local q, p, n = 0.5, 0.2, 200000
  local h = 6 / n
  for _ = 1, n do
    local v = root(3 * p)
    local q1, p1 = q + h * v, p - h * q
    q, p = q + h * (v + root(3 * p1)) / 2, p - h * (q + q1) / 2
  end
  local path = system:solver { rule = "gauss(3)", h = 1e-4 }:run { q = { 0.5 }, p = { 0.2 }, t = 6,
    every = 60000 }
  local last = path.q[#path][1]
  ok(math.abs(last - q) < 2e-5, "a quartic is right behind its turning points", last - q)
end

-- v2 = -v1 keeps q1' = 1, along which the mass, definite everywhere, is lost in rounding as e^q1 grows:
-- this is told by name, and before steps by what is left of it go astray
local heavy = dm.system { Q = dm.R(2), L = function(q, v)
  return ((1 + dm.exp(q[1])) * (v[1] + v[2]) ^ 2 + 0.3 * v[1] ^ 2) / 2 end }
for _, rule in ipairs { "verlet", "gauss(2)", "rk4", "midpoint" } do
  local one = heavy:solver { rule = rule, h = 0.1 }
  local fine, e = pcall(one.run, one, { q = { 20, 0 }, v = { 1, -1 }, steps = 250 })
  local off = fine and 1 or math.abs(e.path.q[#e.path.t][1] - 20 - e.path.t[#e.path.t])
  ok(not fine and e.code == "inertia" and off < 0.02, rule .. ": a mass lost in rounding", fine or off)
end
tap.done()
