-- what lie(s) must hold: Galerkin's method in the coordinates of the chart, long runs, Hante's top
-- in three formulations (Bruels, Cardona & Arnold 2012), a chain of ten links
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max, log, sin = math.abs, math.max, math.log, math.sin
local vector = dm.vector

local function far(a, b)
  if type(b) == "number" then return abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = max(worst, far(a[i], b[i])) end
  return worst
end
local SO3, one = dm.SO(3), dm.SO(3):identity()
local function top(I, mgl)
  return dm.system { Q = SO3, L = function(R, W)
    return (I[1] * W[1] ^ 2 + I[2] * W[2] ^ 2 + I[3] * W[3] ^ 2) / 2 - mgl * R[3][3]
  end }
end

---- lie(s) is galerkin(s) in the coordinates xi about g0 ----

-- Both are stationary among the same curves from g0 to g1, so they have one momentum at the end:
-- the step of galerkin(s) back from there comes to xi = 0. At the start they differ, since the
-- chart of lie(s) moves with g0.
local heavy, R0 = top({ 1, 1.2, 0.6 }, 1), SO3:exp { 0.4, 0, 0 }
local in_chart = dm.system { Q = dm.R(3), L = function(x, v)
  local R, W = R0 * SO3:exp(x), SO3:dexp(-x, v)
  return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3]
end }
local h = 0.1
for _, row in ipairs { { "lie(1)", "galerkin(1, gauss(1))" }, { "lie(2)", "galerkin(2, gauss(2))" },
  { "lie(2, lobatto(3))", "galerkin(2, lobatto(3))" }, { "lie(3)", "galerkin(3, gauss(3))" } } do
  local path = heavy:solver { rule = row[1], h = h }
    :run { q = R0, p = { 0.2, 0.1, 1.5 }, steps = 1 }
  local x = SO3:log(R0:transpose() * path.q[2])
  local p = {} -- p1 on the rates of xi: dexp_(-x)^T p1
  for i = 1, 3 do
    local unit = dm.zeros(3)
    unit[i] = 1
    p[i] = path.p[2]:dot(SO3:dexp(-x, unit))
  end
  local back = in_chart:solver { rule = row[2], h = h }:run { q = x, p = -vector(p), steps = 1 }
  ok(far(back.q[2], { 0, 0, 0 }) < 1e-13, row[1] .. " is " .. row[2] .. " in the chart")
end

---- a million steps ----

local free = top({ 1, 2, 3 }, 0)
local long = free:solver { rule = "lie(1)", h = 0.1 }:run { q = one, p = { 0.9, 0.3, 1.2 },
  steps = 1e6, every = 1e4 }
local off, drift = 0, {}
for i = 1, #long do
  off = max(off, far(long.q[i]:transpose() * long.q[i], one))
  drift[i] = far(long.q[i] * long.p[i], long.p[1])
end
ok(off < 1e-14, "R^T R - 1 after 10^6 steps")
ok(max(table.unpack(drift)) < 1e-12, "spatial momentum after 10^6 steps")
ok(abs(long:drift(vector(drift)).per_time) * 1e5 < 1e-12, "without a slope")
local band = heavy:solver { rule = "lie(2)", h = 0.1 }:run { q = R0, p = { 0.2, 0.1, 1.5 },
  steps = 1e5, every = 100 }:drift "energy"
ok(band.largest < 1e-4 and abs(band.per_time) < 1e-9, "energy of a top over 10^5 steps")

---- Hante's top ----

local m, X, I, g = 15, vector { 0, 1, 0 }, { 0.234375, 0.46875, 0.234375 }, 9.81
local spin = vector { 0, 150, -4.61538 }
local v = spin:cross(X)
local function kinetic(w, a)
  return (I[1] * w[1] ^ 2 + I[2] * w[2] ^ 2 + I[3] * w[3] ^ 2
    + m * (a[1] ^ 2 + a[2] ^ 2 + a[3] ^ 2)) / 2
end
local about = dm.system { Q = SO3, L = function(R, w)
  return kinetic(w, w:cross(X)) - m * g * (R * X)[3]
end }
local beside = dm.system { Q = dm.product(SO3, dm.R(3)),
  L = function(q, a) return kinetic(a, { a[4], a[5], a[6] }) - m * g * q[2][3] end,
  constraint = function(q) return q[2] - q[1] * X end }
local rigid = dm.system { Q = dm.SE(3),
  L = function(q, a) return kinetic({ a[4], a[5], a[6] }, a) - m * g * q[3][4] end,
  constraint = function(q)
    return { q[1][4] - q[1][2], q[2][4] - q[2][2], q[3][4] - q[3][2] }
  end }
local FORMS = {
  { "SO(3)", about, { q = one, v = spin }, function(q) return q * X end },
  { "SO(3) x R^3", beside, { q = { one, X },
    v = { spin[1], spin[2], spin[3], v[1], v[2], v[3] } }, function(q) return q[2] end },
  { "SE(3)", rigid, { q = { { 1, 0, 0, 0 }, { 0, 1, 0, 1 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } },
    v = { v[1], v[2], v[3], spin[1], spin[2], spin[3] } },
    function(q) return { q[1][4], q[2][4], q[3][4] } end },
}
local function place(form, rule, n)
  local path = form[2]:solver { rule = rule, h = 0.25 / n }:run { q = form[3].q, v = form[3].v,
    steps = n, every = n }
  return form[4](path.q[2])
end
local exact = place(FORMS[1], "lie(4)", 1024)
for _, form in ipairs(FORMS) do
  for _, row in ipairs { { "lie(1)", 2 }, { "lie(2)", 4 } } do
    local coarse, fine = far(place(form, row[1], 256), exact), far(place(form, row[1], 512), exact)
    near(log(coarse / fine, 2), row[2], 0.05, ("Hante's top on %s: %s"):format(form[1], row[1]))
  end
  ok(far(place(form, "lie(3)", 512), exact) < 1e-11, "and the place of its centre of mass")
end

---- ten links ----

local links = {}
for i = 1, 10 do links[2 * i - 1], links[2 * i] = SO3, dm.R(3) end
local chain = dm.system { Q = dm.product(table.unpack(links)),
  L = function(q, a)
    local sum = 0
    for i = 0, 9 do
      local k = 6 * i
      sum = sum + (a[k + 1] ^ 2 / 12 + a[k + 2] ^ 2 / 12 + a[k + 3] ^ 2 / 100 + a[k + 4] ^ 2
        + a[k + 5] ^ 2 + a[k + 6] ^ 2) / 2 - 9.81 * q[2 * i + 2][3]
    end
    return sum
  end,
  constraint = function(q)
    local out, last = {}, vector { 0, 0, 0 }
    for i = 1, 10 do
      local half = q[2 * i - 1] * vector { 0, 0, 0.5 }
      local joint = q[2 * i] + half - last
      for k = 1, 3 do out[#out + 1] = joint[k] end
      last = q[2 * i] - half
    end
    return out
  end }
local start, at = { q = {}, v = dm.zeros(60) }, vector { 0, 0, 0 }
for i = 1, 10 do
  local turn = SO3:exp { 0.5, 0.1 * sin(i), 0 }
  local half = turn * vector { 0, 0, 0.5 }
  start.q[2 * i - 1], start.q[2 * i], at = turn, at - half, at - 2 * half
end
local solver = chain:solver { rule = "lie(1, cayley)", h = 0.01 }
local swung = solver:run { q = start.q, v = start.v, steps = 1e4, every = 50 }
local energy = swung:drift "energy"
ok(energy.largest < 0.01 * abs(energy.mean), "energy of ten links within 1 %")
ok(abs(energy.per_time) * 100 < 0.3 * energy.largest, "without a slope beside its band")
-- a slope goes with h^2, as the modified energy differs from H; that itself has none
local modified = {}
for i = 1, 5 do
  local row = 40 * i
  modified[i] = solver:modified_energy { q = swung.q[row], p = swung.p[row], steps = 15 }.mean
end
local least, most = math.min(table.unpack(modified)), max(table.unpack(modified))
ok(most - least < 1e-8 and energy.largest > 1e-3, "their modified energy stays", most - least)
ok(solver:report().newton_per_step < 8, "at most 8 iterations")
ok(swung:worst "constraint" < 1e-13, "joints")

---- where it fails ----

raises("lie(2): h turns the body by 3.0 rad; the chart ends at pi: take a smaller step (step 1, ", function()
  free:solver { rule = "lie(2)", h = 1 }:run { q = one, v = { 0, 0, 3 }, steps = 1 }
end)
for _, Q in ipairs { dm.SO(4), dm.SO(5), dm.SE(4) } do -- their largest angle, of two planes
  local v, spinning = dm.zeros(Q.dimension):totable(), dm.system { Q = Q,
    L = function(_, x) return x:dot(x) / 2 end }
  v[Q.dimension], v[Q.dimension - 5] = 3.5, 1
  raises("turns the body by 3.5 rad; the chart ends at pi", function()
    spinning:solver { rule = "lie(1)", h = 1 }:run { q = Q:identity(), v = v, steps = 1 }
  end)
end
raises("degenerate at the start: d2L/dv2 is zero to round-off along xi = (0, 0, 1)", function()
  dm.system { Q = SO3, L = function(R, w) return (R[1][1] * w[1] ^ 2 + w[2] ^ 2) / 2 end }
    :solver { rule = "lie(1)", h = 0.1 }:run { q = one, v = { 0, 0, 1 }, steps = 1 }
end)
local Sp4 = dm.Sp(4)
local large = dm.system { Q = Sp4, L = function(_, x) return x:dot(x) / 2 end }
raises("lie(s, cayley) needs far fewer", function()
  local SO5 = dm.SO(5)
  dm.system { Q = SO5, L = function(g, x) return x:dot(x) / 2 - g[1][1] ^ 2 end, constraint = function(g) return g[1][2] end }
    :solver { rule = "lie(2)", h = 0.1 }:run { q = SO5:identity(), v = dm.zeros(10), steps = 1 }
end)
local swirl = {}
for i = 1, 10 do swirl[i] = 0.01 * i end
local kept = large:solver { rule = "lie(1, cayley)", h = 0.05 }:run { q = Sp4:identity(), v = swirl,
  steps = 100 }
ok(far(kept:momentum(Sp4)[101], kept.p[1]) < 1e-13, "spatial momentum on Sp(4)")
local straight = large:solver { rule = "lie(1)", h = 0.05 }:run { q = Sp4:identity(), v = swirl,
  steps = 100 }
ok(far(straight:momentum(Sp4)[101], straight.p[1]) < 1e-13, "by exp, whose curves are straight")
ok(far(straight.p[101], kept.p[101]) < 1e-4, "and the motion is that of the Cayley map")

-- What a step rounds away has no mean: J of tops about the vertical. Without the low part of p in
-- its turn, and by products with the double 1/40, J goes by 4 and by 5 standard errors.
local function drift_of_tops(rule)
  math.randomseed(1)
  local random, g, p, slope, STARTS = math.random, {}, {}, {}, 16
  for i = 1, STARTS do
    g[i] = SO3:exp { 2 * random() - 1, 2 * random() - 1, 2 * random() - 1 }
    p[i] = { random(), random(), 1 + random() }
  end
  local members = top({ 1, 1.2, 0.6 }, 1):solver { rule = rule, h = 0.05 }:ensemble { members = STARTS,
    steps = 3.2e5, every = 500, q = g, p = p }
  for i = 1, STARTS do
    local path, J = members:path(i), {}
    for k = 1, #path do J[k] = vector(path.q[k][3]:totable()):dot(path.p[k]) end
    slope[i] = path:drift(vector(J)).per_time
  end
  local mean, square = vector(slope):sum() / STARTS, 0
  for i = 1, STARTS do square = square + (slope[i] - mean) ^ 2 end
  return mean / math.sqrt(square / (STARTS * (STARTS - 1)))
end
if (os.getenv "UNDER" or "") == "" then
  for _, rule in ipairs { "lie(1)", "lie(1, gauss(1), cayley)" } do
    local errors = drift_of_tops(rule)
    ok(abs(errors) < 3, "J of tops does not drift by " .. rule, errors)
  end
end

tap.done()
