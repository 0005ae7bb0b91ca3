-- dm.system, its Legendre transform and structure, as a script sees them: results, then misuse
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, sqrt = math.sin, math.sqrt

local kepler = dm.system { name = "Kepler", Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local s = kepler:structure()
ok(s.separable and s.constant_mass and s.diagonal_mass and s.autonomous, "the Kepler Lagrangian is separable with constant mass")
ok(#s.cyclic == 0, "no Cartesian coordinate of Kepler is cyclic")
near(kepler:energy({ 0.4, 0 }, { 0, 2 }), -0.5, 1e-15, "energy of the start is -1/2")
near(kepler:lagrangian({ 0.4, 0 }, { 0, 2 }), 4.5, 1e-14, "value of L")
near(kepler:legendre({ 0.4, 0 }, { 0, 2 })[2], 2, 0, "p = v for unit mass")
ok(tostring(kepler):find "Kepler" and tostring(kepler):find "separable", "a system prints itself as a sentence", tostring(kepler))
ok(kepler:graph():find "q1", "graph() names the coordinates")

-- polar coordinates: theta cyclic, mass depends on r
local polar = dm.system { Q = dm.R(2), coordinates = { "r", "theta" },
  L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1] end }
s = polar:structure()
ok(not s.separable and not s.constant_mass and s.cyclic[1] == "theta" and #s.cyclic == 1, "theta is found cyclic in polar coordinates")
local p = polar:legendre({ 2, 0.3 }, { 0.1, 0.5 })
near(p[1], 0.1, 0, "p_r = r'"); near(p[2], 2, 1e-15, "p_theta = r^2 theta'")
local v = polar:velocity({ 2, 0.3 }, p)
near(v[1], 0.1, 1e-16, "velocity inverts the Legendre transform, r'"); near(v[2], 0.5, 1e-16, "and theta'")
near(polar:mass({ 2, 0.3 }, { 0, 0 })[2][2], 4, 1e-15, "mass matrix entry r^2")

-- a mass matrix that is not diagonal, a term linear in v, an explicit time
local coupled = dm.system { Q = dm.R(2), L = function(q, v, t)
  return v[1] ^ 2 + v[2] ^ 2 / 2 + v[1] * v[2] + 3 * v[1] - q[1] ^ 2 / 2 - q[2] ^ 2 + q[1] * sin(t) end }
s = coupled:structure()
ok(s.separable and s.constant_mass and not s.diagonal_mass and not s.autonomous, "coupled masses and time are recognised")
p = coupled:legendre({ 0, 0 }, { 0.2, -0.7 })
near(p[1], 0.4 - 0.7 + 3, 1e-15, "p1 with the linear term"); near(p[2], -0.5, 1e-15, "p2")
v = coupled:velocity({ 0, 0 }, p)
near(v[1], 0.2, 1e-15, "v1 back"); near(v[2], -0.7, 1e-15, "v2 back")
near(coupled:lagrangian({ 1, 0 }, { 0, 0 }, 0.5), sin(0.5) - 0.5, 1e-15, "L at t = 0.5")

-- relativistic particle: the Legendre transform is not linear
local fast = dm.system { Q = dm.R(1), L = function(q, v) return -sqrt(1 - v[1] ^ 2) end }
p = fast:legendre({ 0 }, { 0.8 })
near(p[1], 0.8 / 0.6, 1e-15, "relativistic momentum")
near(fast:velocity({ 0 }, p)[1], 0.8, 1e-15, "and back by Newton")

-- parameters
local oscillator = dm.system { Q = dm.R(1), params = { k = 9 }, L = function(q, v, t, p) return v[1] ^ 2 / 2 - p.k * q[1] ^ 2 / 2 end }
near(oscillator:energy({ 1 }, { 0 }), 4.5, 1e-15, "params reach L")
-- a parameter by name where the time stands would be the time
for key, f in pairs { L = function(_, v, k) return k * v[1] ^ 2 end, H = function(_, p, k) return k * p[1] ^ 2 end,
  force = function(_, v, k) return { -k * v[1] } end, constraint = function(q, k) return q[1] - k end } do
  local options = { Q = dm.R(1), params = { k = 9 }, [key] = f }
  options.L = options.L or not options.H and function(_, v) return v[1] ^ 2 end or nil
  raises(("field '%s': its argument %d is t, but is called like the parameter 'k'"):format(key, key == "constraint" and 2 or 3),
    dm.system, options)
end
raises("function(q0, q1, h, params), and the parameter is params.k", dm.discrete_lagrangian,
  { Q = dm.R(1), h = 0.1, params = { k = 9 }, Ld = function(a, b, k) return k * (b[1] - a[1]) ^ 2 end })
ok(dm.system { Q = dm.R(1), params = { t = 9 }, L = function(_, v, t, p) return v[1] ^ 2 * (p.t + t) end }, "a parameter called t")

-- names that have changed places
for words, options in pairs {
  ["field 'L': it is called with q, v in this order"] = { Q = dm.R(1), L = function(v, q) return v[1] ^ 2 - q[1] ^ 2 end },
  ["field 'H': it is called with q, p in this order"] = { Q = dm.R(1), H = function(p, q) return p[1] ^ 2 + q[1] ^ 4 end },
  ["write function(q, v)"] = { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 - q[1] ^ 2 end,
    force = function(v, q) return { q[1] - v[1] } end },
  ["field 'L': it is called with g, xi in this order"] = { Q = dm.SO(3), L = function(xi, g) return xi:dot(xi) + g[1][1] end },
} do raises(words, dm.system, options) end
raises("field 'Ld': it is called with q0, q1 in this order", dm.discrete_lagrangian,
  { Q = dm.R(1), h = 0.1, Ld = function(q1, q0, h) return (q1[1] - q0[1]) ^ 2 / h - h * q0[1] ^ 2 end })
ok(dm.system { Q = dm.R(1), L = function(x, u) return u[1] ^ 2 - x[1] ^ 2 end }, "other names")

-- hyper-dual derivatives of what cannot be traced
local clipped = dm.system { Q = dm.R(1), derivatives = "hyperdual",
  L = function(q, v) if q[1] > 0 then return v[1] ^ 2 / 2 - q[1] ^ 2 end return v[1] ^ 2 / 2 - q[1] ^ 4 end }
near(clipped:energy({ 2 }, { 3 }), 4.5 + 4, 1e-14, "energy on hyper-dual numbers")
near(clipped:energy({ -2 }, { 3 }), 4.5 + 16, 1e-14, "on the other branch")
near(clipped:legendre({ 2 }, { 3 })[1], 3, 0, "momentum on hyper-dual numbers")

-- a loop with too many operations to trace, a thousand a round: one warning (on stderr), and the same numbers
local thousand = dm.zeros(1000)
for i = 1, 1000 do thousand[i] = i end
local long = dm.system { Q = dm.R(1), L = function(q, v)
  local y = 0
  for k = 0, 1099 do y = y + ((thousand + 1000 * k) * q[1]):sum() end
  return v[1] ^ 2 / 2 - 1e-6 * y
end }
ok(tostring(long):find "hyper%-dual", "too large a graph runs on hyper-dual numbers", tostring(long))
near(long:energy({ 1e-3 }, { 2 }), 2 + 1e-9 * 1100000 * 1100001 / 2, 1e-8, "with the right energy")

-- misuse
raises("'Q' must be a space", dm.system, { L = function() return 1 end })
raises("for systems on groups", dm.system, { Q = dm.R(1), columns = "matrix", L = function() return 1 end })
raises("'L' must be a function", dm.system, { Q = dm.R(1) })
raises("did you mean", dm.system, { Q = dm.R(1), L = function() return 1 end, nmae = "x" })
raises("'coordinates' must be", dm.system, { Q = dm.R(2), L = function(q, v) return v[1] ^ 2 end, coordinates = { "x" } })
raises("'derivatives' must be", dm.system, { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 end, derivatives = "none" })
raises("where", dm.system, { Q = dm.R(1), L = function(q, v) if q[1] > 0 then return v[1] ^ 2 end return 2 * v[1] ^ 2 end })
raises("number", dm.system, { Q = dm.R(1), L = function() end })
raises("not finite", kepler.energy, kepler, { 0, 0 }, { 0, 1 })
raises("q", kepler.energy, kepler, { 0 }, { 0, 1 })
raises("dm.system", kepler.energy, 3, { 0 }, { 0, 1 })
raises("whole number", dm.R, 0)
raises("'x' stands there twice", dm.system, { Q = dm.R(2), L = function(q, v) return v:dot(v) end, coordinates = { "x", "x" } })
raises("column of every path", dm.system, { Q = dm.R(2), L = function(q, v) return v:dot(v) end, coordinates = { "x", "energy" } })
raises("momentum of 'x'", dm.system, { Q = dm.R(2), L = function(q, v) return v:dot(v) end, coordinates = { "x", "p_x" } })
raises("momentum of 'x'", dm.system, { Q = dm.R(2), L = function(q, v) return v:dot(v) end, coordinates = { "p_x", "x" } })
raises("one word", dm.system, { Q = dm.R(1), L = function(q, v) return v:dot(v) end, coordinates = { "x\n" } })
raises("dm.sum_over", dm.system, { Q = dm.R(20000), L = function(q, v) return v[1] ^ 2 end })
raises("v must be", kepler.energy, kepler, { 1, 1 })
raises("no velocity", fast.velocity, dm.system { Q = dm.R(1), L = function(q, v) return q[1] * v[1] end }, { 1 }, { 1 })

-- standard actions
ok(dm.SO(3).dimension == 3 and dm.SO(4).dimension == 6 and dm.T(2).dimension == 2, "dimensions of groups")
ok(dm.R(2) == dm.R(2) and dm.R(2) ~= dm.R(3) and tostring(dm.SO(2)) == "SO(2)", "spaces compare and print")

-- params: a change through system.params reaches the next run; a name that nothing reads is refused
do
  local given = { k = 2, g = 1 }
  local function L(q, v, _, p) return v[1] ^ 2 / 2 - p.k * q[1] ^ 2 / 2 - (p.tilt or 0) * q[1] - (p.mode == 2 and p.deep or 0) * q[1] - p.g end
  local s = dm.system { Q = dm.R(1), params = given, L = L }
  raises("params.kk: no function of this system reads it; its parameters are g, k; did you mean 'k'?", function() s.params.kk = 5 end)
  ok(given.kk == nil and s.params.kk == nil, "and is not taken")
  s.params.k, s.params.tilt = 3, 0.5
  ok(given.k == 3 and given.tilt == 0.5, "what L has, or asks for in vain, is taken")
  s.params.deep = 1
  ok(given.deep == 1, "so is what a branch may read later")
  s.params.deep = nil
  given.k, given.note = 4, "mine"
  ok(s.params.k == 4 and s:energy({ 1 }, { 0 }) == 2 + 0.5 + 1, "the table itself is the user's")
  local names = {}
  for name in pairs(s.params) do names[#names + 1] = name end
  table.sort(names)
  ok(table.concat(names, " ") == "g k note tilt" and rawequal(s.params, s.params), "params are enumerated")
  ok(dm.pretty(s.params) == '{ g = 1, k = 4, note = "mine", tilt = 0.5 }', "and printed", dm.pretty(s.params))
  ok(dm.system({ Q = dm.R(1), params = s.params, L = L }).params.k == 4, "and given to another system")
  for name, step in pairs { pairs = pairs, next = function(t) return next, t end } do
    local sum = dm.system { Q = dm.R(1), params = { a1 = 1, a2 = 2 }, L = function(q, v, _, p)
      local V = 0
      for _, x in step(p) do V = V + x * q[1] ^ 2 end
      return v[1] ^ 2 / 2 - V
    end }
    sum.params.a3 = 4
    ok(sum:energy({ 1 }, { 0 }) == 7, "a new name is taken where L goes through its params by " .. name)
  end
  local list = dm.system { Q = dm.R(1), params = { 1, 2 }, L = function(q, v, _, p) return v[1] ^ 2 / 2 - (p[1] + p[2] + (p[3] or 0)) * q[1] end }
  list.params[3] = 4
  ok(#list.params == 3 and list:energy({ 1 }, { 0 }) == 7, "a list of params")
  local rubbed = dm.system { Q = dm.R(1), params = { c = 1 }, L = function(_, v) return v[1] ^ 2 / 2 end, force = function(_, v, _, p) return { -p.c * (p.d or 1) * v[1] } end }
  rubbed.params.d = 2
  ok(rubbed.params.d == 2, "what a force reads is read")
  raises("its parameters are c, d", function() rubbed.params.e = 2 end)
  local numbers = dm.system { Q = dm.R(1), derivatives = "hyperdual", params = { c = 1 }, L = function(q, v, _, p) return v[1] ^ 2 - p.c * q[1] end }
  numbers.params.any = 1
  ok(numbers.params.any == 1, "what is not traced may read anything")
  local shared = { k = 1 }
  local function of(t) return dm.system { Q = dm.R(1), params = t, L = function(q, v, _, p) return v[1] ^ 2 - p.k * q[1] end } end
  ok(of(shared).params == of(shared).params and of(shared).params ~= of({ k = 1 }).params, "params are those of another system where the table is")
  raises("cannot change a protected metatable", setmetatable, of(shared).params, { __index = { g = 1 } })
  library = { forces = { deep = function(q, p) return p.mode == 2 and p.deep * q[1] or q[1] end } } -- luacheck: ignore
  local branches = dm.system { Q = dm.R(1), params = { mode = 1 }, L = function(q, v, _, p) return v[1] ^ 2 - library.forces.deep(q, p) end } -- luacheck: ignore
  branches.params.deep = 3
  ok(branches.params.deep == 3, "what a branch of a function in a library may read later is taken")
  raises("no function of this system reads it", function() branches.params.dip = 3 end)
  library = nil -- luacheck: ignore
  local usual = dm.system { Q = dm.R(1), params = setmetatable({ k = 2 }, { __index = { g = 3 } }), L = function(q, v, _, p) return v[1] ^ 2 - p.k * q[1] ^ 2 - p.g end }
  ok(usual:energy({ 2 }, { 0 }) == 11, "params with a metatable of their own, as defaults are")
  local members = usual:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 2, q = { { 1 }, { 1 } }, v = { { 0 }, { 0 } }, steps = 1, vary = { k = { 2, 3 } } }
  ok(members.q[1] == usual:solver({ rule = "verlet", h = 0.1 }):run({ q = { 1 }, v = { 0 }, steps = 1 }).q[2] and members.q[2] ~= members.q[1], "and members of them")
end

-- the core alone, without dm, checks no names of params
do
  local registry, kept = debug.getregistry(), {}
  for _, name in ipairs { "dm_params", "dm_unread", "dm_may_read", "dm_param_names" } do
    kept[name], registry[name] = registry[name], nil
  end
  local solver = dm.system { Q = dm.R(1), params = { k = 3 }, L = function(q, v, _, p) return v[1] ^ 2 - p.k * q[1] end }:solver { rule = "verlet", h = 0.1 }
  local function members(vary) return solver:ensemble { members = 2, q = { { 1 }, { 1 } }, v = { { 0 }, { 0 } }, steps = 1, vary = vary } end
  ok(solver.system.params.k == 3 and members({ k = { 1, 2 } }).status[2] == "ok", "the core alone has params")
  raises("'kk' is not a number among the params of the system", members, { kk = { 1, 2 } })
  for name, f in pairs(kept) do registry[name] = f end
end

-- d2L/dv2 is singular at rest: v in closed form where L is not convex, and where it has a part linear in v
for c in (function() local e = -300 return function() e = e + 150 return e <= 150 and 2.0 ^ e or nil end end)() do
  for name, case in pairs { ["-v^4"] = { function(_, v) return -c * v[1] ^ 4 / 4 end, function(p) return -p end },
    ["v^4 + 5 v"] = { function(q, v) return c * v[1] ^ 4 / 4 + 5 * c * q[1] * v[1] end, function(p) return p - 5 end },
    ["v^4 - 5 v"] = { function(q, v) return c * v[1] ^ 4 / 4 - 5 * c * q[1] * v[1] end, function(p) return p + 5 end } } do
    local quartic = dm.system { Q = dm.R(1), L = case[1] }
    for _, x in ipairs { 1, 4, -4 } do
      local cube = case[2](x)
      local exact = math.abs(cube) ^ (1 / 3) * (cube < 0 and -1 or 1)
      near(quartic:velocity({ 1 }, { c * x })[1], exact, 1e-14, ("%s, masses of %g: velocity of %g"):format(name, c, x))
    end
  end
end

-- a parameter is a number with which something can be computed
do
  local s = dm.system { Q = dm.R(1), params = { k = 2, c = { 1, 2 }, mode = "soft" }, L = function(q, v, _, p)
    return v[1] ^ 2 / 2 - (p.mode == "hard" and 10 or 1) * p.k * q[1] ^ 2 / 2 - p.c[1] * q[1]
  end }
  local function set(name, value) return function() s.params[name] = value end end
  raises('params.k = "a": a text in place of the number 2', set("k", "a"))
  raises('params.k = "3": a text in place of the number 2', set("k", "3"))
  raises("params.k: NaN is no value of a parameter", set("k", 0 / 0))
  raises("params.k = nil: the functions of this system cannot be computed with it", set("k", nil))
  raises("params.k = a table", set("k", {}))
  raises("params.c = 3", set("c", 3))
  raises("did you mean 'k'?", set("kk", 1))
  ok(s.params.k == 2 and s.params.c[2] == 2 and s.params.kk == nil, "none of these is taken")
  s.params.k, s.params.c, s.params.mode = 4, dm.vector { 5, 6 }, "hard"
  ok(s:energy({ 1 }, { 0 }) == 25, "other numbers, lists and texts are")
  raises("field 'params': params.k is NaN", dm.system, { Q = dm.R(1), params = { k = 0 / 0 }, L = function(q, v, _, p) return v[1] ^ 2 - p.k * q[1] end })
end

-- names are those that a system was made with
do
  local names, units = { "x", "y" }, { x = "m" }
  local s = dm.system { Q = dm.R(2), coordinates = names, units = units, L = function(_, v) return v:dot(v) / 2 end }
  names[1], units.x = "z", "km"
  ok(s.coordinates[1] == "x" and s.units.x == "m", "a change of the tables that were given does not reach it")
  raises("the list of names of coordinates cannot be set", function() s.coordinates[1] = "z" end)
  raises("the list of names of coordinates cannot be set", function() s.given.coordinates[1] = "z" end)
  raises("the table of units of a system cannot be set", function() s.units.x = "km" end)
  local again = dm.system { Q = dm.R(2), coordinates = s.coordinates, units = s.units, L = function(_, v) return v:dot(v) / 2 end }
  ok(table.concat(again.coordinates, " ") == "x y" and again.units.x == "m", "another system takes them")
  local Ld = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, coordinates = { "x" }, Ld = function(a, b, h) return (b[1] - a[1]) ^ 2 / 2 / h end }
  raises("cannot be set", function() Ld.coordinates[1] = "z" end)
end

tap.done()
