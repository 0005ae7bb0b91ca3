-- connections computed from continuous ones: the third axiom fails for raw ones at its order, not for
-- completed ones; matched pairs; orders; bad input
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local SO3 = dm.SO(3)

-- a form of dim G x 2 that is not closed
local function form_of(G)
  local d, stream, b = G.dimension, dm.random(7), {}
  for i = 1, d do b[i] = { stream:normal(i, 0, 0, 0.5), stream:normal(i, 1, 0, 0.5) } end
  b = dm.matrix(b)
  return function(x) return b * (1 + x[1] / 2 - x[2] * x[2] / 5) end
end

-- defects of (ii) and (iii) of pairs at the distance h, both in shape and in the group
local function defects(A, h)
  local G, stream = A.group, dm.random(9)
  local function vector(i, size)
    local v = {}
    for k = 1, G.dimension do v[k] = stream:normal(i, k, 0, size) end
    return dm.vector(v)
  end
  local x0, g0, k = dm.vector { 0.1, 0.2 }, G:exp(vector(1, 0.3)), G:exp(vector(2, 0.5) * h)
  local q0 = { x0, g0 }
  local q1 = { x0 + dm.vector { 0.6, -0.8 } * h, G:compose(g0, G:exp(vector(3, 0.5) * h)) }
  return G:distance(A(q0, { x0, G:compose(k, g0) }), k),
    G:distance(A(q0, { q1[1], G:compose(k, q1[2]) }), G:compose(k, A(q0, q1)))
end

local function slope(f, i)
  local a, b = select(i, f(0.1)), select(i, f(0.05))
  return math.log(a / b) / math.log(2)
end

-- each group by one of three maps, each map with two groups and more (SAMPLES=1: all)
local MAPS = { "exp", "cayley", "pade(2)" }
for i, G in ipairs { SO3, dm.SE(2), dm.SU(2), dm.SE(3), dm.Heisenberg(), dm.SL(2),
  dm.product(SO3, dm.R(1)) } do
  for j = 1, tap.samples(3) do
    local by = MAPS[(i + j) % 3 + 1]
    local given = { group = G, base = dm.R(2), form = form_of(G), by = by, raw = true }
    local name = tostring(G) .. " by " .. by
    local raw = dm.connection(given)
    local c = raw:check()
    ok(c.equivariance < 1e-12 and c.splitting < 1e-12, name .. ": raw, (i) and (ii)", c.worst)
    near(slope(function(h) return defects(raw, h) end, 2), 2, 0.15, name .. ": raw, (iii) as h^2")
    given.raw = nil
    local A = dm.connection(given)
    ok(A:check().worst < 1e-12, name .. ": completed", A:check().worst)
    ok((A:continuous { 0.3, -0.2 } - given.form(dm.vector { 0.3, -0.2 })):column(1):norm() < 1e-11,
      name .. ": tends to its form")
    if by ~= "exp" and tostring(G) ~= tostring(dm.Heisenberg()) then
      near(A:order(), by == "cayley" and 2 or 4, 0.1, name .. ": order")
    end
    -- the closed form is what completion of the raw one-form gives
    local same = dm.connection { group = G, base = dm.R(2), one_form = function(a, b)
      return raw(a, b)
    end }
    ok(same.completed and G:distance(same:local_form({ 0.1, 0.2 }, { 0.4, -0.1 }),
      A:local_form({ 0.1, 0.2 }, { 0.4, -0.1 })) < 1e-12, name .. ": completion in closed form")
  end
end
-- nilpotent of step two: Cayley is exp there but for products of three
ok(dm.connection { group = dm.SO(2), base = dm.R(2), form = function(x) return { x[2], 1 } end,
  raw = true }:check().worst < 1e-12, "an abelian group: raw ones have (iii)")

-- log(q1 q0^-1) q0 of G and R^n
for _, pair in ipairs { { SO3, dm.R(3) }, { dm.SO(2), dm.R(2) }, { dm.SU(2), dm.R(3) },
  { dm.SL(2), dm.R(2) } } do
  local G, S = pair[1], pair[2]
  local d, n = G.dimension, S.dimension
  local function form(x)
    local out = {}
    for i = 1, d do
      out[i] = {}
      for j = 1, n do out[i][j] = 0.3 * i - 0.2 * j + 0.4 * x[j] * x[1] end
    end
    return dm.matrix(out)
  end
  local name = tostring(G) .. " over " .. tostring(S) .. ", log = group"
  local given = { group = G, base = S, form = form, log = "group", raw = true }
  local c = dm.connection(given):check()
  ok(c.equivariance < 1e-12 and c.splitting < 1e-12 and c.composition > 1e-3, name .. ": raw",
    c.worst)
  given.raw = false
  local A = dm.connection(given)
  ok(A:check().worst < 1e-12, name .. ": completed", A:check().worst)
  local x = dm.vector { 0.2, -0.1, 0.3 }:slice(1, n)
  local off = A:continuous(x) - form(x)
  ok(off:column(1):norm() + off:column(n):norm() < 1e-10, name .. ": tends to its form")
end

-- the geodesic construction: (iii) as h^3; (ii), which the text claims, fails as h^5
local function metric(x)
  return dm.matrix { { 2 + x[1] ^ 2 / 4, 0.1, 0.3, 0.1 * x[2], 0 }, { 0.1, 1.5, 0, 0.2, -0.3 },
    { 0.3, 0, 2, 0.1, 0 }, { 0.1 * x[2], 0.2, 0.1, 1.7, 0.2 * x[1] },
    { 0, -0.3, 0, 0.2 * x[1], 2.4 } }
end
local function geodesic(raw, form)
  return dm.connection { group = SO3, base = dm.R(2), by = "geodesic", metric = metric, raw = raw,
    form = form }
end
for _, form in ipairs { false, form_of(SO3) } do
  local raw, name = geodesic(true, form or nil), form and "another form" or "its mechanical form"
  near(slope(function(h) return defects(raw, h) end, 2), 3, 0.1, "geodesic, (iii) as h^3, " .. name)
  near(slope(function(h) return defects(raw, h) end, 1), 5, 0.3, "geodesic, (ii) as h^5, " .. name)
  local A = geodesic(false, form or nil)
  ok(A:check().worst < 1e-12, "geodesic, completed, " .. name, A:check().worst)
  ok(raw:check().equivariance < 1e-12, "geodesic, equivariant, " .. name)
end
-- a large group: the graph of the shooting has room
local function large(x)
  local rows = {}
  for i = 1, 8 do
    rows[i] = {}
    for j = 1, 8 do rows[i][j] = i == j and 2 + 0.1 * i or 0.1 / (i + j) * (1 + x[1]) end
  end
  return dm.matrix(rows)
end
ok(dm.connection { group = dm.SE(3), base = dm.R(2), by = "geodesic", metric = large }:check().worst
  < 1e-12, "geodesic, SE(3) over two dimensions")
-- frames of the sphere in colatitude and longitude: parallel transport round a geodesic triangle
-- turns by its area, of sides of any length
local frames = dm.connection { group = dm.SO(2), base = dm.R(2), by = "geodesic",
  metric = function(x)
    local c, s = dm.cos(x[1]), dm.sin(x[1])
    return dm.matrix { { 1, 0, 0 }, { 0, s * s + c * c, c }, { 0, c, 1 } }
  end }
local function on_sphere(x)
  local s = math.sin(x[1])
  return dm.vector { s * math.cos(x[2]), s * math.sin(x[2]), math.cos(x[1]) }
end
for _, size in ipairs { 0.2, 1, 1.5 } do
  local P, Q, R = { 1.1, 0.2 }, { 1.1 + 0.4 * size, 0.2 + 0.6 * size }, { 1.1 - 0.3 * size,
    0.2 + size }
  local a, b, c = on_sphere(P), on_sphere(Q), on_sphere(R)
  local area = 2 * math.atan(a:dot(b:cross(c)), 1 + a:dot(b) + b:dot(c) + c:dot(a))
  near(frames:holonomy { P, Q, R, P }, area, 1e-11, "a triangle of sides of about " .. size)
end
-- of its own mechanical form it is A_E up to order 1 only [E7]
local mechanical = geodesic(false)
local flat = dm.connection { group = SO3, base = dm.R(2), form = function(x)
  return mechanical:continuous(x)
end }
near(mechanical:order { reference = flat }, 1, 0.15, "a mechanical one against A_E is of order 1")

---- what is wrong is told ----

local function bad(words, given)
  raises(words, function()
    local all = { group = SO3, base = dm.R(2) }
    for key, value in pairs(given) do all[key] = value end
    return dm.connection(all)
  end)
end
local e = SO3:identity()
local function trivial() return e end
bad("what is the connection", {})
bad("not both", { local_form = trivial, one_form = trivial })
bad("goes with form", { local_form = trivial, by = "exp" })
bad("option 'by'", { form = trivial, by = "euler" })
bad("option 'by'", { form = trivial, by = "pade(9)" })
bad("option 'base'", { base = 2, local_form = trivial })
bad("take a chart", { base = dm.S(2), local_form = trivial })
bad("take a chart", { base = SO3, local_form = trivial })
bad("not a group", { group = dm.S(2), local_form = trivial })
bad("axiom of splitting", { local_form = function(a, b) return SO3:exp { b[1] - a[1], 0.1, 0 } end })
bad("axiom of equivariance", { one_form = function(a, b)
  return SO3:compose(SO3:exp { b[1][1] - a[1][1], 0, 0 }, SO3:compose(b[2], SO3:inverse(a[2])))
end })
bad("no element", { local_form = function() return { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 2 } } end })
bad("must lie over x1", { lift = function(x0, _, q0) return { x0 + 1, q0[2] } end })
bad("q must lie over x0", { splitting = function(_, b) return { b, e } end })
bad("two points", { horizontal_splitting = function(a) return { a, e } end })
bad("oops", { local_form = function() error "oops" end })
bad("metric", { by = "geodesic" })
bad("symmetric", { by = "geodesic", metric = dm.matrix { { 1, 2, 0, 0, 0 }, { 0, 1, 0, 0, 0 },
  { 0, 0, 1, 0, 0 }, { 0, 0, 0, 1, 0 }, { 0, 0, 0, 0, 1 } } })
bad("log = \"group\"", { form = trivial, log = "group" })
bad("Cayley", { group = dm.SL(3), form = trivial, by = "cayley" })

bad("3 x 2", { form = function() return dm.zeros(2, 2) end })
local raw = dm.connection { group = SO3, base = dm.R(2), form = form_of(SO3), raw = true }
raises("half turn", raw, { { 0, 0 }, e }, { { 0.1, 0 }, SO3:exp { math.pi, 0, 0 } })
raises("raw connection", function()
  return raw:variation({ { 0, 0 }, e }, { { 0, 0 }, e }, { { 1, 0 }, { 1, 0, 0 } })
end)
raises("q0 must be a point", raw, { 1, 2, 3 }, { { 0, 0 }, e })
raises("no element", raw, { { 0, 0 }, { { 2, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, { { 0, 0 }, e })
raises("not finite", raw, { { 0, 0 / 0 }, e }, { { 0, 0 }, e })
raises("do not match", function() return raw:lift({ 0, 0 }, { 1, 0 }, { { 0, 1 }, e }) end)
raises("whole number from 1 to 2", function() return raw:curvature({ 0, 0 }, 1, 3) end)
raises("reference", function() return raw:order() end)
raises("round-off", function() return raw:order { reference = raw } end)
raises("of SO(2) over", function()
  return raw:order { reference = dm.connection { group = dm.SO(2), base = dm.R(2),
    local_form = function() return 0 end } }
end)
raises("closed", function() return raw:holonomy { { 0, 0 }, { 0, 1 } } end)
raises("at least 2", function() return raw:holonomy { { 0, 0 } } end)
local torus = dm.connection { group = dm.SO(2), base = dm.T(2), local_form = function(a, b)
  return dm.cos((a[1] + b[1]) / 2) * (b[2] - a[2])
end }
raises("too coarse", function() return torus:holonomy { { 1, 0 }, { 1, 3.2 }, { 1, 2 * math.pi } } end)
near(torus:relative({ { 1, 0.1 }, 0 }, { { 1, 0.1 + 2 * math.pi }, 0 })[2], 0, 1e-15,
  "differences of angles go the shortest way")
-- on a circle a turn of both points changes nothing: what it changes had no single holonomy
local function over(base, datum)
  datum.group, datum.base = dm.SO(2), base
  return datum
end
for name, datum in pairs { local_form = function(a, b) return a[1] * (b[1] - a[1]) end, form = function(x) return { { x[1] } } end,
  one_form = function(p, q) return q[2] - p[2] + p[1][1] * (q[1][1] - p[1][1]) end } do
  raises(name .. ": it has no single value on T^1", dm.connection, over(dm.T(1), { [name] = datum }))
  ok(dm.connection(over(dm.R(1), { [name] = datum })).base.dimension == 1, name .. ": a line has no turns")
end
raises("no single value", dm.connection, over(dm.T(1), { by = "geodesic", metric = function(x) return { { 1, x[1] / 9 }, { x[1] / 9, 1 } } end }))
ok(dm.connection(over(dm.T(1), { form = function(x) return { { 2 + dm.sin(x[1]) } } end })).base.dimension == 1, "and what has the period is taken")
tap.done()
