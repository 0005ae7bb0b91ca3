-- every run calls L with symbols; what it does again is not made again. One system whose L changes from run to run against
-- systems that never knew another one: the same bits
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos, sqrt = math.sin, math.cos, math.sqrt

local function bits(path)
  local out, q, p = {}, path.q[#path], path.p[#path]
  for i = 1, #q do out[#out + 1] = ("%a %a"):format(q[i], p[i]) end
  return table.concat(out, " ")
end

-- the changes come in an order in which every one follows every other
local function orders(n)
  local all = {}
  for a = 1, n do for b = 1, n do all[#all + 1], all[#all + 2] = a, b end end
  return all
end

-- makers: functions that give L, by a number that they look up in every call
local function compare(what, Q, makers, rules, start)
  for _, rule in ipairs(rules) do
    local expected, mode, same = {}, 1, 0
    local function run(system) return bits(system:solver(rule):run { q = start.q, v = start.v, steps = 7 }) end
    for k, L in ipairs(makers) do expected[k] = run(dm.system { Q = Q, L = L }) end
    local changing = dm.system { Q = Q, L = function(q, v, t) return makers[mode](q, v, t) end }
    local all = orders(#makers)
    for _, k in ipairs(all) do
      mode = k
      if run(changing) == expected[k] then same = same + 1 end
    end
    ok(same == #all, ("%s by %s: what L does now is what is stepped"):format(what, rule.rule), ("%d of %d runs"):format(same, #all))
  end
end

local plain = { { rule = "verlet", h = 0.01 }, { rule = "gauss(2)", h = 0.05 }, { rule = "gauss(8, 6)", h = 0.05 } }
local function T(v) return v:dot(v) / 2 end
compare("one point", dm.R(2), {
  function(q, v) return T(v) + 1 / q:norm() end,
  function(q, v) return T(v) + 2 / q:norm() end, -- another constant
  function(q, v) return T(v) + 1 / q:norm() - q[1] ^ 2 end, -- goes on
  function(_, v) return T(v) end, -- ends early
  function(q, v) return 1 / q:norm() + T(v) end, -- another order
  function(q, v) return T(v) - cos(q[1]) - sin(q[2]) * 0.5 end,
  function(q, v) return T(v) - cos(q[1]) - sin(q[1]) * 0.5 end, -- another operand
  function(q, v) return T(v) - dm.where(q[1], q[1] ^ 4, q[1] ^ 2) - q[2] ^ 2 end,
  function(q, v) return (v[1] * v[1] + v[2] * v[2]) / 2 + 1 / sqrt(q:dot(q)) end, -- the same graph by other steps
  function(q, v, t) return T(v) - q:dot(q) * (1 + 0.1 * cos(t)) / 2 end,
  function(q, v) local w = 3 * q - q / 2 return T(v) - w:dot(w) end, -- vectors
}, plain, { q = { 1, 0.2 }, v = { 0.1, 0.9 } })

local soft = dm.root { name = "soft", start = 0, equations = function(y, x) return y ^ 3 + y - x end }
compare("an implicit function", dm.R(2), {
  function(q, v) return T(v) - soft(q[1]) ^ 2 - q[2] ^ 2 end,
  function(q, v) return T(v) - soft(q[1]) ^ 2 - 2 * q[2] ^ 2 end,
  function(q, v) return T(v) - q[1] ^ 2 - q[2] ^ 2 end,
}, { { rule = "gauss(2)", h = 0.05 } }, { q = { 1, 0.2 }, v = { 0.1, 0.9 } })

-- a chain: the term, its columns, its numbers, the number of sums
local n = 24
local masses, heavier, q, v = {}, {}, {}, {}
for i = 1, n do masses[i], heavier[i], q[i], v[i] = 1 + i / n, 1 + i / n, 0.2 * sin(1.7 * i), cos(2.1 * i) end
heavier[n] = 3
local ring = { shift = 1, periodic = true }
local function kinetic(u) return u ^ 2 / 2 end
local function weighed(u, m) return m * u ^ 2 / 2 end
local function spring(k) return function(a, b) return k * (a - b) ^ 2 / 2 + (a - b) ^ 4 / 4 end end
compare("a chain", dm.R(n), {
  function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(1), ring) end,
  function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(2), ring) end,
  function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(1), { shift = 1 }) end,
  function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(1), { shift = 2, periodic = true }) end,
  function(x, u) return dm.sum_over(u, masses, weighed) - dm.sum_over(x, spring(1), ring) end,
  function(x, u) return dm.sum_over(u, heavier, weighed) - dm.sum_over(x, spring(1), ring) end,
  function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(1), ring) - dm.sum_over(x, function(a) return a ^ 2 end) end,
  function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(1), ring) - x[3] ^ 2 end,
  function(x, u) return dm.sum_over(u, kinetic) - 0.5 * dm.sum_over(x, spring(1), ring) end,
}, { { rule = "verlet", h = 0.01 }, { rule = "blanes-moan(6)", h = 0.1 }, { rule = "gauss(2)", h = 0.05 } }, { q = q, v = v })

-- constraints and forces are functions of their own
local function tied(changes)
  local parts, mode, same, all = {}, 1, 0, orders(#changes)
  local rules = { { rule = "rattle", h = 0.05 }, { rule = "gauss(2)", h = 0.05 } }
  local function system(look)
    return dm.system { Q = dm.R(3), L = function(x, u) return T(u) - look().g * x[3] end,
      constraint = function(x) return look().on(x) end, force = function(x, u) return look().push(x, u) end }
  end
  local function run(s, rule) return bits(s:solver(rule):run { q = { 1, 0, 0 }, v = { 0, 0.6, 0.3 }, steps = 6 }) end
  local changing = system(function() return changes[mode] end)
  for _, rule in ipairs(rules) do
    for k = 1, #changes do parts[k] = run(system(function() return changes[k] end), rule) end
    for _, k in ipairs(all) do
      mode = k
      if run(changing, rule) == parts[k] then same = same + 1 end
    end
  end
  ok(same == 2 * #all, "constraints and forces: what they do now is what is stepped", ("%d of %d runs"):format(same, 2 * #all))
end
local function sphere(x) return x:dot(x) - 1 end
local function drag(_, u) return -0.1 * u end
tied {
  { g = 1, on = sphere, push = drag },
  { g = 2, on = sphere, push = drag },
  { g = 1, on = function(x) return 2 * x:dot(x) - 2 end, push = drag },
  { g = 1, on = sphere, push = function(_, u) return -0.2 * u end },
  { g = 1, on = sphere, push = function(x, u) return { -u[1], x[1], 0 } end },
}

-- what is wrong is still found, and leaves nothing behind
local mode, saved = "fine", nil
local fragile = dm.system { Q = dm.R(2), L = function(x, u)
  local energy = T(u)
  if mode == "breaks" then error "no more" end
  if mode == "text" then return "energy" end
  if mode == "compares" and x[1] < 0 then return energy end
  if mode == "keeps" then saved = saved or x[1] return energy - saved ^ 2 end
  if mode == "uses" then return energy + saved end
  return energy - x:dot(x) / 2
end }
local function go() return bits(fragile:solver({ rule = "verlet", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 5 }) end
local first = go()
for _, case in ipairs { { "breaks", "no more" }, { "text", "must return a number" }, { "compares", "comparison < or >" }, { "keeps", "upvalue" }, { "uses", "" } } do
  mode = case[1]
  raises(case[2], go)
  mode = "fine"
  ok(go() == first, "after '" .. case[1] .. "' the run is what it was")
end

-- a function that remembers its results by their arguments: numbers, and symbols of another run
local function remembering(f)
  local memory = {}
  return function(x)
    memory[x] = memory[x] or f(x)
    return memory[x]
  end
end
local well = remembering(function(x) return x ^ 4 / 4 - x ^ 2 / 2 end)
local pull = remembering(function(x) return dm.vector { x, 2 * x } end)
local whole = remembering(function(x) return x ^ 2 end)
local makes = {
  function(f) return function(x, u) return T(u) - f[1](x[1]) - f[2](x[2]):norm() end end,
  function(f) return function(x, u) return f[3](u[1]) / 2 + f[3](u[2]) / 2 - f[1](x[1]) end end,
  function(f) return function(x) return f[3](x[1]) end end,
}
for k, make in ipairs(makes) do
  local function ends(f) -- of six runs
    local all, s = {}, dm.system { Q = dm.R(2), L = make(f) }
    for i = 1, 6 do
      local fine, path = pcall(function() return s:solver({ rule = "verlet", h = 0.1 }):run { q = { 1, 0.5 }, v = { 0, 1 }, steps = 5 } end)
      all[i] = fine and bits(path) or path
    end
    return table.concat(all, "\n")
  end
  local forgetful = { function(x) return x ^ 4 / 4 - x ^ 2 / 2 end, function(x) return dm.vector { x, 2 * x } end, function(x) return x ^ 2 end }
  local a, b = ends { well, pull, whole }, ends(forgetful)
  ok(a == b, "results that are remembered by symbols, " .. k, a .. "\nagainst\n" .. b)
end

-- a run inside of L, of another system and of the same one
local inner = dm.system { Q = dm.R(1), L = function(x, u) return u[1] ^ 2 / 2 - x[1] ^ 2 / 2 end }
local function inner_length() return inner:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 3 }.q[4][1] end
local outer = dm.system { Q = dm.R(1), L = function(x, u) return u[1] ^ 2 / 2 - inner_length() * x[1] ^ 2 end }
local again = dm.system { Q = dm.R(1), L = function(x, u) return u[1] ^ 2 / 2 - inner_length() * x[1] ^ 2 end }
local function length_of(s) return bits(s:solver({ rule = "verlet", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 4 }) end
local once = length_of(outer)
ok(length_of(outer) == once and length_of(again) == once and length_of(outer) == once, "runs inside of L are repeated with it")

local depth, nested = 0, nil
nested = dm.system { Q = dm.R(1), L = function(x, u)
  depth = depth + 1
  if nested and depth == 1 then length_of(nested) end
  depth = depth - 1
  return u[1] ^ 2 / 2 - x[1] ^ 2
end }
local deep = length_of(nested)
ok(length_of(nested) == deep and length_of(nested) == deep, "a run of the same system inside of its L")

local stiffness, inside, parted = 1, false, nil
parted = dm.system { Q = dm.R(1), L = function(x, u)
  local x1, energy = x[1], u[1] ^ 2 / 2 - stiffness * x[1] ^ 2
  if inside then
    inside = false
    length_of(parted)
    inside = true
  end
  return energy - x1 ^ 2 / 2
end }
local alone = {}
for k = 1, 2 do
  stiffness = k
  for _ = 1, 3 do alone[k] = length_of(parted) end
end
inside = true
ok(pcall(length_of, parted) and length_of(parted) == alone[2], "or where L is what it was")
stiffness = 1
local went, got = pcall(length_of, parted)
ok(went and got == alone[1], "or after its L has become another one", got)

-- parameters are inputs of the kernels of explicit rules: what their own values hide may change, too
local hidden, options = 1, { q = { 0 }, v = { 1 }, steps = 5 }
local function swept(made, rule)
  local e = made:solver({ rule = rule, h = 0.1 }):ensemble { members = 3, q = function() return { 0 } end, v = function() return { 1 } end, steps = 5,
    vary = { k = function(i) return i end } }
  return ("%a %a %a"):format(e.q[1][1], e.q[2][1], e.q[3][1])
end
for _, rule in ipairs { "verlet", "blanes-moan(6)" } do
  local given = { k = 1 }
  local function weighed() return dm.system { Q = dm.R(1), params = given, L = function(x, u, _, c)
    return u[1] ^ 2 / 2 - (1 + (c.k - 1) * hidden) * x[1] ^ 2 / 2
  end } end
  local function stretched() return dm.system { Q = dm.R(1), params = given, L = function(x, u, _, c) return u[1] ^ 2 / 2 - c.k * hidden * x[1] ^ 2 end } end
  local one, other, same = weighed(), stretched(), true
  for _, g in ipairs { 1, 5, 2 } do
    hidden, given.k = g, 1
    same = same and swept(one, rule) == swept(weighed(), rule)
    given.k = 10 / g
    same = same and bits(other:solver({ rule = rule, h = 0.1 }):run(options)) == bits(stretched():solver({ rule = rule, h = 0.1 }):run(options))
  end
  ok(same, rule .. ": an upvalue beside parameters, from an equilibrium")
end

-- == on a parameter, where L at the start is the same on both sides
local function stiffer(k, params) return dm.system { Q = dm.R(1), params = params, L = function(x, u, _, c)
  return u[1] ^ 2 / 2 - ((c and c.k or k) == 2 and 10 * x[1] ^ 4 or x[1] ^ 2)
end } end
local function end_of(made) return bits(made:solver({ rule = "verlet", h = 0.1 }):run(options)) end
ok(end_of(stiffer(2, { k = 2 })) == end_of(stiffer(2)), "== on a parameter, from an equilibrium")
ok(swept(stiffer(1, { k = 1 }), "verlet"):match "%s(%S+)%s" == end_of(stiffer(2)):match "%S+", "and in an ensemble")

-- a rule that needs tables, or a question for the mass, leaves the loops of other runs alone
local links = dm.system { Q = dm.R(n), L = function(x, u) return dm.sum_over(u, kinetic) - dm.sum_over(x, spring(2), ring) end }
local function stepped(rule) return bits(links:solver({ rule = rule, h = 0.02 }):run { q = q, v = v, steps = 3 }) end
local alike, by_loops, by_tables = true, stepped "verlet", stepped "gauss(2)"
for _ = 1, 2 do
  alike = alike and links:mass(q, v)[2][2] == 1 and stepped "verlet" == by_loops and stepped "gauss(2)" == by_tables
end
ok(alike, "runs by loops and by tables do not disturb each other")

tap.done()
