-- A second value of a function that must return one is not lost in silence: fields, waves, elements, spaces
local tap = require "tap"
local dm = require "dm"
local raises = tap.raises

local function two(f) return function(...) return f(...), 1 end end
local function wave(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end
local function one() return 1 end
local ring = { 0, 1, 8, periodic = true }
local K = dm.mesh { triangle = 2 }
local rows = {
  ["dm.field L"] = function() dm.field { x = ring, L = two(wave) } end,
  ["line u"] = function()
    dm.field { x = ring, L = wave }:solver { rule = "cell(gauss(2))", h = 0.05 }:run { u = two(one), ut = one, steps = 1 }
  end,
  ["line ut"] = function()
    dm.field { x = ring, L = wave }:solver { rule = "cell(gauss(2))", h = 0.05 }:run { u = one, ut = two(one), steps = 1 }
  end,
  ["K:field L"] = function() K:field { form = 0, L = two(function(u, v) return v:dot(v) / 2 - u:dot(u) / 2 end) } end,
  ["K:sum"] = function()
    K:field { form = 0, L = function(u, v) return v:dot(v) / 2 - K:sum(0, two(function(a) return a ^ 2 end), u) end }
  end,
  ["dm.adapt W"] = function() dm.adapt { W = two(function(s) return s ^ 2 / 2 end), x = { 0, 1, 4 }, ends = { 0, 1 } } end,
  ["dm.adapt f"] = function()
    dm.adapt { W = function(s) return s ^ 2 / 2 end, f = two(one), x = { 0, 1, 4 }, ends = { 0, 1 } }
  end,
  ["dm.schroedinger V"] = function() dm.schroedinger { x = { -5, 5, 16 }, V = two(one) } end,
  ["dm.msfem a"] = function() dm.msfem { a = two(one), f = one, x = { 0, 0.5, 1 } } end,
  ["dm.msfem f"] = function() dm.msfem { a = one, f = two(one), x = { 0, 0.5, 1 } } end,
  ["dm.galerkin functions"] = function()
    dm.galerkin { functions = two(function(t) return { 1, t } end), quadrature = "gauss(2)" }
  end,
  ["dm.lagrange_poincare l"] = function()
    dm.lagrange_poincare { group = dm.SO(3), h = 0.1, l = two(function(f) return -f[1][1] end) }
  end,
}
-- functions of elements of groups, of members, of points of meshes, of sizes and parameters
local SO3, start = dm.SO(3), function() return { q = dm.SO(3):identity(), v = { 1, 0, 0 } } end
local function half(_, xi) return xi:dot(xi) / 2 end
local function drag(_, xi) return -xi end
local function rows_of(key, f, others)
  for _, Q in ipairs { SO3, dm.SE(2), dm.SU(2), dm.product(dm.R(1), SO3), dm.product(SO3, dm.S(2)) } do
    rows[("dm.system %s on %s"):format(key, Q)] = function()
      local o = { Q = Q, [key] = two(f) }
      for k, v in pairs(others or {}) do o[k] = v end
      dm.system(o)
    end
  end
end
rows_of("L", half)
rows_of("H", half)
rows_of("force", drag, { L = half })
rows_of("rolling", function(_, xi) return xi[1] end, { L = half })
rows_of("control", function() return 1 end, { L = half, force = drag })
rows_of("reaction", function(_, xi) return { xi * 0 + 1 } end, { L = half, rolling = function(_, xi) return xi[1] end })
local body = dm.system { Q = SO3, L = half }:solver { rule = "lie(1)", h = 0.1 }
local function members(key)
  rows["members on a group " .. key] = function()
    local s = start()
    body:ensemble { members = 2, steps = 2, q = function() return s.q end, v = function() return s.v end,
      [key] = two(function() return s[key] end) }
  end
end
members "q"
members "v"
local circle = { dimension = 1, identity = { 1, 0 },
  mul = function(a, b) return { a[1] * b[1] - a[2] * b[2], a[1] * b[2] + a[2] * b[1] } end,
  inv = function(a) return { a[1], -a[2] } end, exp = function(x) return { dm.cos(x[1]), dm.sin(x[1]) } end,
  log = function(a) return { dm.atan(a[2], a[1]) } end, Ad = function(_, x) return x end, ad = function() return { 0 } end }
for _, key in ipairs { "mul", "inv", "exp", "log", "Ad", "ad" } do
  rows["dm.group " .. key] = function()
    local o = {}
    for k, v in pairs(circle) do o[k] = v end
    o[key] = two(circle[key])
    dm.group(o)
  end
end
local function mesh(name, method, ...)
  local given = table.pack(...)
  rows[name] = function() return K[method](K, table.unpack(given, 1, given.n)) end
end
local function swirl(x, y) return y, -x end
local function square(A) return K:sum(0, function(a) return a ^ 2 end, A) end
local function left(x) return x == 0 end
rows["dm.mesh map"] = function() dm.mesh { triangle = 2, map = two(function(x, y) return { x, 2 * y } end) } end
mesh("K:form", "form", 1, swirl)
mesh("K:integrals", "integrals", 1, swirl)
mesh("K:vector_field", "vector_field", swirl)
mesh("K:poisson f", "poisson", { f = two(one), fixed = { boundary = 0 } })
mesh("K:poisson fixed", "poisson", { f = 1, fixed = { boundary = two(one) } })
mesh("K:poisson flux", "poisson", { f = 0, flux = two(one) })
mesh("K:darcy permeability", "darcy", { permeability = two(one), pressure = one })
mesh("K:darcy pressure", "darcy", { pressure = two(one) })
mesh("K:stationary fixed", "stationary", { fixed = two(left), term = square })
mesh("K:stationary term", "stationary", { fixed = "boundary", term = two(square) })
mesh("K:stationary x", "stationary", { fixed = "boundary", x = two(one), term = square })
rows["dm.diffeo"] = function() dm.diffeo(K, two(function(t) return K:points() * (1 + t) end))(0.5) end
for _, key in ipairs { "q", "v" } do
  rows["K:field " .. key] = function()
    K:field({ form = 0, L = function(u, v) return v:dot(v) / 2 - u:dot(u) / 2 end })
      :solver({ rule = "verlet", h = 0.01 }):run { steps = 1, q = one, v = one, [key] = two(one) }
  end
end
local function string_of(n) return dm.field { x = { 0, 1, n }, fixed = "ends", L = wave } end
for key, f in pairs { system = string_of, exact = math.sin, h = function() return 0.1 end } do
  rows["dm.chart " .. key] = function()
    local o = { system = string_of, n = { 4, 8 }, t = 0.5, h = 0.1, u = math.sin, exact = math.sin }
    o[key] = two(f)
    dm.chart(o)
  end
end
rows["dm.scaling system"] = function()
  dm.scaling { rules = { "verlet" }, n = { 1, 2 }, h = 0.1, steps = 10, repeats = 1,
    system = two(function(n) return dm.system { Q = dm.R(n), L = half } end),
    start = function(n) return dm.zeros(n), dm.zeros(n) end }
end
rows["dm.msfem antiderivative"] = function()
  dm.msfem { a = one, f = one, x = { 0, 0.5, 1 }, antiderivative = two(function(x) return x end) }
end
local line = dm.system { Q = dm.R(1), L = half }
local polar = dm.system { Q = dm.R(2), L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 - q[1] ^ 2 end }
local shape = polar:routh { cyclic = { 2 }, mu = 1 }
rows["system:routh connection"] = function()
  polar:routh { cyclic = { 2 }, mu = 1, connection = two(function() return { { 0 } } end) }
end
rows["shape:holonomy"] = function() shape:holonomy(two(function(s) return { 1 + math.cos(2 * math.pi * s) / 10 } end)) end
rows["reduced members p"] = function()
  shape:solver({ rule = "verlet", h = 0.01 }):ensemble { members = 2, steps = 2,
    q = function() return { 1 } end, p = two(function() return { 0 } end) }
end
rows["dm.stability q"] = function()
  dm.stability { system = line, rule = "verlet", q = two(function(e) return { e } end), v = { 1 }, e = { 0, 0.5, 2 },
    h = { 0.1, 0.2, 2, "linear" }, steps = 10 }
end
rows["path:animate draw"] = function()
  line:solver({ rule = "verlet", h = 0.1 }):run({ q = { 0 }, v = { 1 }, steps = 3 })
    :animate("never.html", { draw = two(function(q) return { points = { { q[1], 0 } } } end) })
end
local names = {}
for name in pairs(rows) do names[#names + 1] = name end
table.sort(names)
for _, name in ipairs(names) do
  print("# " .. name)
  raises("must return one value", rows[name])
end
raises("start must return two values", function()
  dm.scaling { rules = { "verlet" }, n = { 1, 2 }, h = 0.1, steps = 10, repeats = 1, system = function() return line end,
    start = function() return { 0 }, { 0 }, 1 end }
end)
raises("psi must return two numbers", function()
  dm.schroedinger { x = { -5, 5, 16 } }:solver { rule = "strang", h = 0.1 }:run { psi = function() return 1, 0, 3 end, steps = 1 }
end)

-- nor is an entry that a list has under a name, or behind a gap
local pairs_of = dm.action { group = dm.SO(2), on = dm.R(2) }
local function free(_, v) return v:dot(v) / 2 end
local function plane(more)
  local o = { Q = dm.R(2), L = free }
  for k, v in pairs(more) do o[k] = v end
  return dm.system(o)
end
local plain = plane {}:solver { rule = "verlet", h = 0.1 }
local own = { Q = dm.R(2), h = 0.1, Ld = function(a, b, h) return (b - a):dot(b - a) / 2 / h end }
local function own_with(more)
  for k, v in pairs(own) do more[k] = v end
  return dm.discrete_lagrangian(more)
end
local beside = {
  constraint = function() plane { constraint = function(q) return { q[1], wall = q[2] } end } end,
  ["constraint behind a gap"] = function()
    plane { constraint = function(q) local c = { q[1] }; c[3] = q[2]; return c end }
  end,
  ["a name before the entries"] = function()
    plane { constraint = function(q) local c = { a = 0, b = 0, c = q[2] }; c.a, c.b, c[1] = nil, nil, q[1]; return c end }
  end,
  rolling = function() plane { rolling = function(_, v) return { v[1], skate = v[2] } end } end,
  force = function() plane { force = function(_, v) return { -v[1], -v[2], drag = 1 } end } end,
  reaction = function()
    plane { rolling = function(_, v) return v[1] end, reaction = function() return { { 1, 0 }, other = { 0, 1 } } end }
  end,
  control = function()
    plane { control = function() return { 1, u = 2 } end, force = function(_, _, _, u) return { u[1], 0 } end }
  end,
  watch = function() plain:run { q = { 0, 0 }, v = { 1, 0 }, steps = 1, watch = { r = function(q) return { q[1], b = 1 } end } } end,
  ["dm.vector"] = function() dm.vector { 1, 2, x = 3 } end,
  ["dm.matrix"] = function() dm.matrix { { 1, 2 }, { 3, 4 }, last = { 5, 6 } } end,
  ["a row"] = function() dm.matrix { { 1, 2, x = 3 }, { 3, 4 } } end,
  start = function() plain:run { q = { 0, 0, z = 1 }, v = { 1, 0 }, steps = 1 } end,
  times = function() plain:run { q = { 0, 0 }, v = { 1, 0 }, at = { 0.1, last = 0.2 } } end,
  coordinates = function() plane { coordinates = { "x", "y", third = "z" } } end,
  members = function()
    plain:ensemble { members = 1, steps = 1, q = { { 0, 0 }, spare = { 1, 1 } }, v = { { 0, 0 } } }
  end,
  ["a force of Ld"] = function() own_with { force = function() return { { 1, 0 }, { 0, 1 }, third = { 1, 1 } } end } end,
  ["dm.derivative"] = function() dm.derivative(function(x) return { x[1], y = x[2] } end, 2) end,
  ["dm.action map"] = function()
    dm.action { group = dm.R(1), on = dm.R(2), map = function(e, z) return { z[1] + e[1], z[2], w = 1 } end }
  end,
  section = function()
    dm.moving_frame { action = pairs_of, cross_section = function(z) return { z[2], x = z[1] } end,
      branch = function(z) return z[1] end }
  end,
}
for name, f in pairs(beside) do
  print("# beside: " .. name)
  raises("beside its entries", f)
end
raises("field 'q' has 'z' beside its entries 1 to 2", beside.start)

-- table.pack says how many there are, and a list of a class of the user's own knows what it holds
tap.ok(dm.vector(table.pack(1, 2)) == dm.vector { 1, 2 }, "table.pack makes a list")
tap.ok(dm.vector(setmetatable({ 1, 2, unit = "m" }, {})) == dm.vector { 1, 2 }, "a list with a metatable may hold more")

tap.done()
