-- shape:discrete(Ld): Ld is taken whatever its step, and one of another system, or with another
-- momentum map, is told apart by what it does, also where round-off of short steps is large
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos = dm.sin, dm.cos

local systems = {
  { "oscillator", 2, { "theta" }, { 1.1, 0 }, { 0.1, 0.7 },
    function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2 - q[1] ^ 2) / 2 end },
  { "stiff", 3, { "theta" }, { 1, 0, 0.2 }, { 0.1, 0.7, 0.1 }, function(q, v)
    return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2 + v[3] ^ 2) / 2 - 5e3 * (q[1] - 1) ^ 2 - q[3] ^ 2 / 2
  end },
  { "magnetic", 3, { 3 }, { 0.7, 0.1, 0 }, { 0.1, 1.7, 1 }, function(q, v)
    return v:dot(v) / 2 + v[3] * (q[1] * v[2] - q[2] * v[1]) / 2 - q[1] ^ 2 / 2 - q[2] ^ 2
  end },
  { "top", 3, { 2, 3 }, { 0.7, 0, 0 }, { 0.1, 1.7, 3 }, function(q, v)
    return (v[1] ^ 2 + sin(q[1]) ^ 2 * v[2] ^ 2) / 2 + 0.3 * (v[3] + cos(q[1]) * v[2]) ^ 2 - 2 * cos(q[1])
  end },
  { "in metres", 2, { 2 }, { 7e6, 0 }, { 100, 1e-3 },
    function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 4e14 / q[1] end },
  { "slow", 2, { 2 }, { 1.1, 0 }, { 1e-4, 7e-4 },
    function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2 - 1e-6 * q[1] ^ 2) / 2 end },
}
local function midpoint(L) return function(a, b, h) return h * L((a + b) / 2, (b - a) / h, 0) end end
local function trapezoid(L)
  return function(a, b, h)
    local v = (b - a) / h
    return h / 2 * (L(a, v, 0) + L(b, v, 0))
  end
end
-- the last one has its h in it
local right = { midpoint, trapezoid, function(L)
  return function(a, b, h) return h * L(a, (b - a) / h, 0) end
end, function(L)
  return function(a, b, h) return midpoint(L)(a, b, h) + b[1] ^ 2 - a[1] ^ 2 end
end, function(L, h) return function(a, b) return midpoint(L)(a, b, h) end end }
local wrong = {
  ["discrete: this Ld "] = function(L) -- of another mass, by 1 %
    return function(a, b, h)
      local v = (b - a) / h
      return h * (L((a + b) / 2, v, 0) + 0.01 * L(a, v, 0) - 0.01 * L(a, 0 * v, 0))
    end
  end,
  ["discrete: this Ld"] = function(L) -- without h
    return function(a, b, h) return midpoint(L)(a, b, h) / h end
  end,
  ["this Ld"] = function(L)
    return function(a, b, h) return 2 * midpoint(L)(a, b, h) end
  end,
  ["another momentum map"] = function(L, _, cyclic, size)
    return function(a, b, h) return midpoint(L)(a, b, h) + size * (b[cyclic] - a[cyclic]) end
  end,
}
local refused, taken, count = {}, {}, 0
for _, s in ipairs(systems) do
  local name, n, cyclic, q, v, L = table.unpack(s)
  local names = { "r", "theta", "z" }
  local system = dm.system { Q = dm.R(n), L = L, coordinates = { table.unpack(names, 1, n) } }
  local shape = system:routh { cyclic = cyclic, q = q, v = v }
  local at = cyclic[#cyclic] == "theta" and 2 or cyclic[#cyclic]
  local size = 0.1 * math.abs(system:momentum(q, v)[at])
  for _, h in ipairs { 0.1, 1e-3, 1e-5 } do
    for k, make in ipairs(right) do
      local Ld = dm.discrete_lagrangian { Q = dm.R(n), h = h, Ld = make(L, h) }
      local fine, why = pcall(shape.discrete, shape, Ld)
      count = count + 1
      if not fine then refused[#refused + 1] = ("%s, h = %g, %d: %s"):format(name, h, k, why) end
    end
    for words, make in pairs(wrong) do
      local Ld = dm.discrete_lagrangian { Q = dm.R(n), h = h, Ld = make(L, h, at, size) }
      local fine, why = pcall(shape.discrete, shape, Ld)
      count = count + 1
      if fine or not why:find(words, 1, true) then
        taken[#taken + 1] = ("%s, h = %g, not %s: %s"):format(name, h, words, tostring(why))
      end
    end
  end
end
ok(#refused == 0, "no right Ld is refused, whatever h", #refused .. " of " .. count .. "; " .. tostring(refused[1]))
ok(#taken == 0, "every wrong one is, with the reason", #taken .. " of " .. count .. "; " .. tostring(taken[1]))

-- what the messages say is so: the momentum map of midpoint + 0.3 (theta1 - theta0)
local plane = dm.system { Q = dm.R(2), L = systems[1][6] }
local polar = plane:routh { cyclic = 2, mu = 0.8 }
raises("along the group it gives {1.147} where L gives {0.847}", function()
  local q, v = { 1.1, 0 }, { 0.1, 0.7 }
  plane:routh({ cyclic = 2, q = q, v = v }):discrete(dm.discrete_lagrangian { Q = dm.R(2), h = 1e-3,
    Ld = function(a, b, h) return midpoint(plane.L)(a, b, h) + 0.3 * (b[2] - a[2]) end })
end)
-- that of a formula for one h, where no limit can be taken
raises("another momentum map", function()
  polar:discrete(dm.discrete_lagrangian { Q = dm.R(2), h = 0.05, Ld = function(a, b)
    return midpoint(plane.L)(a, b, 0.05) + 0.3 * (b[2] - a[2])
  end })
end)

-- in the coordinates that an action moves, and under a constraint, which takes up what is across
local flat = dm.system { Q = dm.R(3), L = function(q, v)
  return v:dot(v) / 2 - q[1] ^ 2 - q[2] ^ 2 - 0.4 * q[3]
end }
local bowl = dm.system { Q = dm.R(3), L = flat.L, constraint = function(q)
  return q[3] - (q[1] ^ 2 + q[2] ^ 2) / 2
end }
local function turn(t, q) return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2], q[3] } end
local how = { action = turn, section = function(x) return { x[1], 0, x[2] } end, mu = 0.7 }
local function angle(q) return dm.atan(q[2], q[1]) end
for name, system in pairs { plane = flat, bowl = bowl } do
  local shape = system:routh(how)
  for _, h in ipairs { 0.1, 1e-4 } do
    local function Ld(f) return dm.discrete_lagrangian { Q = dm.R(3), h = h, Ld = f } end
    ok(pcall(shape.discrete, shape, Ld(trapezoid(flat.L))), name .. ": an Ld of the system")
    raises("another momentum map", shape.discrete, shape, Ld(function(a, b, k)
      return trapezoid(flat.L)(a, b, k) + 0.2 * (angle(b) - angle(a))
    end))
    raises("of another system", shape.discrete, shape, Ld(function(a, b, k)
      return trapezoid(flat.L)(a, b, k) - 0.1 * k * a[3]
    end))
  end
end
ok(bowl:routh(how):discrete(dm.discrete_lagrangian { Q = dm.R(3), h = 0.1, Ld = function(a, b, h)
  return trapezoid(flat.L)(a, b, h) + 0.3 * h * (a[3] - (a[1] ^ 2 + a[2] ^ 2) / 2)
end }), "a multiple of the constraint makes no other system of it")

-- an Ld of another system with the same L and the same params is one of this system, and all
-- params are read where L goes through them by next: V = 5 (r - 1)^2/2 at r = 1.1 over h = 0.1
do
  local springs = { k = 2, l = 3 }
  local function L(q, v, _, p)
    local V = 0
    for _, x in next, p do V = V + x end
    return v:dot(v) / 2 - V * (q[1] - 1) ^ 2 / 2
  end
  local function new(f)
    return dm.system { Q = dm.R(2), params = springs, L = f, coordinates = { "r", "th" } }
  end
  local one, twin = new(L), new(L)
  local shape = one:routh { cyclic = "th", mu = 1 }
  for _, system in ipairs { one, twin } do
    for _, rule in ipairs { "midpoint", "gauss(2)" } do
      local Ld = dm.discrete_lagrangian(system, { rule = rule, h = 0.1 })
      ok(pcall(shape.discrete, shape, Ld), rule .. ": an Ld of a system of the same L and params")
    end
  end
  local function value(f)
    return new(f):routh({ cyclic = "th", mu = 1 }):discrete({ rule = "midpoint", h = 0.1 })
      :value({ 1 }, { 1.2 })
  end
  local free = value(function(_, v) return v:dot(v) / 2 end)
  tap.near(free - value(L), 0.1 * 5 * 0.1 ^ 2 / 2, 1e-15, "all params are in the reduced Ld")
end
-- how much is seen (docs/failures.md): an oscillator in polar coordinates whose spring is too stiff
do
  local polar = dm.system { Q = dm.R(2), coordinates = { "r", "theta" },
    L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 - q[1] ^ 2 / 2 end }
  local shape = polar:routh { cyclic = { "theta" }, mu = 1 }
  local function midpoint(k, h)
    return function(q0, q1, given)
      local step = given or h
      local q, v = (q0 + q1) / 2, (q1 - q0) / step
      return step * ((v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 - k * q[1] ^ 2 / 2)
    end
  end
  local function is_taken(k, h, timed)
    local f = midpoint(k, h)
    local Ld = dm.discrete_lagrangian { Q = dm.R(2), h = h, Ld = timed and f or function(a, b) return f(a, b) end }
    local fine, why = pcall(shape.discrete, shape, Ld)
    return fine or not tostring(why):find "of another system" and why
  end
  for _, h in ipairs { 0.01, 0.1, 0.5 } do
    ok(is_taken(1, h, true) == true and is_taken(1, h) == true, "its own at h = " .. h)
    ok(is_taken(1.001, h, true) == false, "0.1 % by an Ld of (q0, q1, h), h = " .. h)
  end
  ok(is_taken(1.02, 0.01) == false and is_taken(1.05, 0.1) == false, "by one of (q0, q1) 2 % at h = 0.01 and 5 % at 0.1")
  ok(is_taken(1.02, 0.1) == true and is_taken(1.3, 0.5) == true, "and 2 % at 0.1, 30 % at 0.5 are what rules differ by")
end

-- round-off at the border of a domain: to the side where there is a value
do
  local noise = require "dm.reduce.discrete.places".noise
  local at = { q0 = dm.vector { 1 }, q1 = dm.vector { 2 } }
  tap.near(noise(at, function(a, b) return math.sqrt(1 - a[1]) + b[1] end), math.sqrt(2 ^ -50) + 2 * 2 ^ -50, 1e-12,
    "what has no value on one side of q0")
  tap.ok(noise(at, function(a) return a[1] == 1 and 1 or 0 / 0 end) == 0, "what has none on either excuses nothing")
end

tap.done()
