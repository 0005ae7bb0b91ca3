-- dm.euler_poincare: reduced runs are those of the system on the group, and lead back to it
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, max = math.abs, math.max

local function far(a, b)
  if type(b) == "number" then return abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = max(worst, far(a[i], b[i])) end
  return worst
end

---- Kirchhoff's equations, against an independent program ----

local body = dm.euler_poincare { group = dm.SE(3), l = function(x)
  return (x[1] ^ 2 + 2 * x[2] ^ 2 + 3 * x[3] ^ 2 + 1.5 * x[4] ^ 2 + x[5] ^ 2 + 0.5 * x[6] ^ 2) / 2
end }
local path = body:solver { rule = "lie(3)", h = 0.05 }
  :run { p = { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 }, t = 3 }
local p = path.p[#path]
ok(far(p, { -0.958450321457076264, -0.198170605138303685, 0.511958389479013909,
  0.185547070286320085, 0.141750723649172072, -0.125149866612226524 }) < 1e-11, "Kirchhoff")
near(p[1] * p[4] + p[2] * p[5] + p[3] * p[6], -0.27, 1e-14, "its Casimir p . m")
near(p:slice(1, 3):norm(), dm.vector({ 0.5, -0.4, 0.9 }):norm(), 1e-14, "its Casimir |p|")
local whole = path:reconstruct { q = dm.SE(3):identity() }
ok(far(whole.q[#whole][1], { -0.232544614153195502, 0.593053648736297423, 0.770850421384658631,
  0.524362173619093961 }) < 1e-11, "the place that it leads to")
near(far(path.mu[7], path.p[7]), 0, 0, "path.mu is path.p")

---- a heavy top with the direction of gravity carried along ----

local G = dm.SO(3)
local heavy = dm.system { Q = G, L = function(R, W)
  return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - R[3][3]
end }
local reduced = dm.euler_poincare { group = G, advected = dm.action { group = G, on = dm.R(3) },
  l = function(W, a) return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - a[3] end }
local g0, mu = G:exp { 0.4, 0, 0 }, { 0.2, 0.1, 1.5 }
local above = heavy:solver { rule = "lie(2)", h = 0.1 }:run { q = g0, p = mu, steps = 50 }
local solver = reduced:solver { rule = "lie(2)", h = 0.1 }
local below = solver:run { p = mu, a = g0:transpose() * dm.vector { 0, 0, 1 }, steps = 50 }
ok(far(below.p[51], above.p[51]) < 1e-13, "body momentum of the top")
ok(far(below:reconstruct { q = g0 }.q[51], above.q[51]) < 1e-13, "and its attitude")
-- energies of the path on the group, whichever run of the system came last
local other = solver:run { p = mu, a = { 1, 0, 0 }, steps = 5 }
local back = below:reconstruct { q = g0 }
ok((back:energy() - above:energy()):norm() < 1e-12, "its energy", back:energy()[1] - above:energy()[1])
ok((back:reconstruct { q = g0 }:energy() - above:energy()):norm() < 1e-12, "of a path that is moved again")
ok(far(below.a, g0:transpose() * dm.vector { 0, 0, 1 }) == 0 and far(other.a, dm.vector { 1, 0, 0 }) == 0,
  "a run knows what it carried")
ok(above.a == nil, "others carry nothing")
raises("cannot be set", function() below.a[1] = 3 end)

---- of a Hamiltonian h(mu): Lie-Poisson ----

local of_h = dm.euler_poincare { group = dm.SE(3), h = function(m)
  return (m[1] ^ 2 + m[2] ^ 2 / 2 + m[3] ^ 2 / 3 + m[4] ^ 2 / 1.5 + m[5] ^ 2 + 2 * m[6] ^ 2) / 2
end }
for _, rule in ipairs { "lie(2)", "gauss(2)", "rkmk4" } do
  local begin = { p = { 0.5, -0.4, 0.9, 0.3, 0.6, -0.2 }, steps = 20 }
  local one = body:solver { rule = rule, h = 0.05 }:run(begin)
  local other = of_h:solver { rule = rule, h = 0.05 }:run(begin)
  ok(far(one.p[21], other.p[21]) < 1e-13, rule .. ": l and its h agree")
end
-- singular ones: orbits and energy are kept, against a small step of another rule
local function casimir(m) return m[1] ^ 2 + m[2] * m[3] end
local singular = {
  { G, function(m) return m[1] ^ 2 / 2 + m[1] * m[2] + 0.3 * m[3] end,
    function(m) return m:norm() end },
  { G, function(m) return m[1] ^ 4 / 4 + 0.3 * m[3] * m[1] ^ 2 end,
    function(m) return m:norm() end },
  { dm.SU(2), function(m) return m[1] ^ 2 / 2 + 0.3 * m[2] end, function(m) return m:norm() end },
  { dm.SL(2), function(m) return m[1] ^ 2 / 2 + m[2] * m[3] * m[1] end,
    function(m) return casimir { m[1] / 2, m[2], m[3] } end },
}
for _, case in ipairs(singular) do
  local system = dm.euler_poincare { group = case[1], h = case[2] }
  local p0, name = { 0.3, -0.4, 0.9 }, tostring(case[1])
  local long = system:solver { rule = "gauss(2)", h = 0.1 }:run { p = p0, steps = 1000 }
  local off = 0
  for i = 1, #long do off = max(off, abs(case[3](long.mu[i]) - case[3](long.mu[1]))) end
  ok(off < 1e-13, name .. ": on its coadjoint orbit", off)
  ok(long:drift "energy".largest < 1e-6, "energy", long:drift "energy".largest)
  local fine = system:solver { rule = "rkmk4", h = 0.002 }:run { p = p0, steps = 500 }
  local six = system:solver { rule = "gauss(3)", h = 0.02 }:run { p = p0, steps = 50 }
  near(far(six.p[51], fine.p[501]), 0, 1e-11, name .. ": the orbit of another rule")
end
raises("gauss(s), midpoint and its compositions, rkmk4 and crouch-grossman3 step any H", function()
  dm.euler_poincare { group = G, h = function(m) return m[1] end }
    :solver { rule = "lie(1)", h = 0.1 }:run { p = { 1, 0, 0 }, steps = 1 }
end)
-- gravity carried along, as h(mu, a)
local of_both = dm.euler_poincare { group = G, advected = dm.action { group = G, on = dm.R(3) },
  h = function(m, a) return (m[1] ^ 2 + m[2] ^ 2 / 1.2 + m[3] ^ 2 / 0.6) / 2 + a[3] end }
local with_h = of_both:solver { rule = "lie(2)", h = 0.1 }
  :run { p = mu, a = g0:transpose() * dm.vector { 0, 0, 1 }, steps = 50 }
ok(far(with_h.p[51], above.p[51]) < 1e-13, "body momentum of the top, by h")

---- of a system, and what is refused ----

local free = dm.euler_poincare(dm.system { Q = G, L = function(_, W)
  return (W[1] ^ 2 + 2 * W[2] ^ 2 + 3 * W[3] ^ 2) / 2
end })
local spun = free:solver { rule = "lie(1)", h = 0.1 }:run { v = { 1, 2, 3 }, steps = 1000 }
near(spun.p[1001]:norm(), spun.p[1]:norm(), 1e-13, "a free body stays on its sphere")
raises("L is not invariant: at g = exp(", dm.euler_poincare, heavy)
raises("H is not invariant: at g = exp(", dm.euler_poincare,
  dm.system { Q = G, H = function(R, P) return P[1] + R[1][1] end })
-- far from the identity, too, along every axis
for _, Q in ipairs { dm.SE(2), dm.SE(3), dm.Heisenberg(1) } do
  raises("L is not invariant: at g = exp(x1 e1) exp(x2 e2) ...", dm.euler_poincare,
    dm.system { Q = Q, L = function(g, x)
      return x:dot(x) / 2 - dm.exp(-(Q:matrix(g)[1][Q:matrix(g).columns] - 15) ^ 2 / 8)
    end })
end
for _, Q in ipairs { dm.SE(3), dm.SL(2), dm.GL(2) } do
  local kept = dm.euler_poincare(dm.system { Q = Q, L = function(g, x)
    local y = Q:Ad(Q:inverse(g), Q:Ad(g, x))
    return y:dot(y) / 2
  end })
  ok(tostring(kept):find "system on", "invariant although it sees g: " .. tostring(Q))
end
raises("L depends on t", dm.euler_poincare,
  dm.system { Q = G, L = function(_, W, t) return W:dot(W) * (2 + t) end })
raises("'l' must be a function of (xi [, a]), or 'h'", dm.euler_poincare, { group = G })
local freed = dm.euler_poincare(dm.system { Q = G, H = function(_, P) return P[1] * P[2] end })
ok(freed:solver { rule = "gauss(2)", h = 0.1 }:run { p = { 1, 2, 3 }, steps = 10 }.mu[11]:norm()
  - dm.vector { 1, 2, 3 }:norm() < 1e-14, "a system of a singular H, reduced")
raises("a run needs the advected quantity", solver.run, solver, { p = mu, steps = 1 })
raises("carries no quantity along", function()
  body:solver { rule = "lie(1)", h = 0.1 }:run { p = { 0, 0, 0, 0, 0, 0 }, a = { 1 }, steps = 1 }
end)
raises("is for reduced systems", function()
  dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end }
    :solver { rule = "verlet", h = 0.1 }:run { q = { 0 }, p = { 0 }, a = { 1 }, steps = 1 }
end)
raises("must be a group", dm.euler_poincare, { group = dm.S(2), l = function() return 0 end })
raises("'advected' must be a dm.action", dm.euler_poincare,
  { group = G, l = function() return 0 end, advected = 3 })
raises("system on a group is needed", dm.euler_poincare,
  dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end })


---- checkpoints, members, exponents begin at the identity, with the quantity that is given ----

do
  local solver = reduced:solver { rule = "lie(2)", h = 0.05 }
  local v, a = { 0.2, 0.3, 0.9 }, { 0.36, 0.48, 0.8 }
  local run = solver:run { v = v, a = a, steps = 40 }
  local file = os.tmpname()
  solver:run { v = v, a = a, steps = 15 }:checkpoint(file)
  local rest = dm.resume(file, reduced):run { a = a, steps = 25 }
  near(far(rest.p[#rest], run.p[#run]), 0, 0, "a run in two pieces")
  raises("not the one of the checkpoint", function()
    dm.resume(file, reduced):run { a = { 0, 0, 1 }, steps = 25 }
  end)
  -- the quantity goes with the checkpoint, in a file and in memory
  local first = solver:run { v = v, a = a, steps = 15 }
  solver:run { v = v, a = { 1, 0, 0 }, steps = 1 }
  for name, from in pairs { file = file, path = first } do
    rest = dm.resume(from, reduced):run { steps = 10 }
    rest = dm.resume(rest, reduced):run { steps = 15 }
    near(far(rest.p[#rest], run.p[#run]), 0, 0, "in three pieces, which keep it, from a " .. name)
  end
  os.remove(file)
  local function own(i) return { 0.1 * i, math.cos(i), 0.5 } end
  local function begin(i) return { 0.2, 0.1 * i, 1 } end
  local each = solver:ensemble { members = 3, v = begin, a = own, steps = 40 }
  local listed = solver:ensemble { members = 3, v = begin, a = { own(1), own(2), own(3) },
    steps = 40 }
  for i = 1, 3 do
    local alone = solver:run { v = begin(i), a = own(i), steps = 40 }
    ok(far(each.p[i], alone.p[41]) == 0 and far(listed.p[i], alone.p[41]) == 0,
      "members with quantities of their own")
  end
  raises("one quantity for each of 3 members", function()
    solver:ensemble { members = 3, v = begin, a = { own(1), own(2) }, steps = 1 }
  end)
  raises("'a' of member 1 must have 3 entries", function()
    solver:ensemble { members = 3, v = begin, a = function() return { 1 } end, steps = 1 }
  end)
  local members = solver:ensemble { members = 2, v = function() return v end, a = a, steps = 40 }
  near(far(members.p[2], run.p[#run]), 0, 0, "and a member of an ensemble")
  raises("carries no quantity", function()
    body:solver { rule = "lie(1)", h = 0.1 }
      :ensemble { members = 1, v = function() return { 1, 0, 0, 0, 0, 0 } end, a = a, steps = 1 }
  end)
  -- the run of the whole system from the g0 that brings the vertical to a
  local at = G:exp { -math.asin(0.48), 0, 0 } * G:exp { 0, math.atan(0.36, 0.8), 0 }
  local seen = at:transpose() * dm.vector { 0, 0, 1 }
  local one = solver:lyapunov { v = v, a = seen, t = 5 }
  local same = heavy:solver { rule = "lie(2)", h = 0.05 }:lyapunov { q = at, v = v, t = 5 }
  near(one.exponent, same.exponent, 1e-11, "exponents of a reduced run")
  near(solver:symplecticity { v = v, a = a, steps = 10 }, 0, 1e-12, "whose steps are symplectic")
end

---- what measures a system takes reduced ones from p and a alone: the same as on the group ----

local axis = { 0, 0.6, 0.8 }
local function slant(x, a) return (x[1] ^ 2 + x[2] ^ 2 + 0.4 * x[3] ^ 2) / 2 - a[3] end
local carried = dm.euler_poincare { group = G, l = slant, a = { 0, 0, 1 },
  advected = function(g, a) return g * a end }
local whole = dm.system { Q = G, L = function(R, x)
  return slant(x, R:transpose() * dm.vector(axis))
end }
local p0, one = { 0.2, 0.3, 1.1 }, G:identity()
local function both(name, read, options)
  local of_a, of_q = { p = p0, a = axis }, { p = p0, q = one }
  for key, value in pairs(options) do of_a[key], of_q[key] = value, value end
  local S, F = carried:solver { rule = "lie(2)", h = 0.1 }, whole:solver { rule = "lie(2)", h = 0.1 }
  near(read(S[name](S, of_a)) - read(F[name](F, of_q)), 0, 1e-13,
    name .. " of a reduced system with its quantity")
end
local function itself(x) return x end
local function field(key) return function(x) return x[key] end end
both("symplecticity", itself, { steps = 10 })
both("reversal", itself, { steps = 10 })
both("lyapunov", field "exponent", { steps = 10 })
both("backward_error", field "amplitude", { steps = 20 })
both("modified_energy", field "mean", { steps = 20 })
both("measured_order", field "order", { t = 1 })
both("multipliers", field "largest", { steps = 4 })
both("section", function(x) return x.orbits[1].x[1] end,
  { g = function(_, _, _, mu) return mu[1] end, x = "p2", y = "p3", t = 20 })
local chart = { p = p0, t = 1, rules = { "lie(1)" }, h = { 0.1 } }
local on_whole = { p = p0, q = one, t = 1, rules = { "lie(1)" }, h = { 0.1 } }
chart.a = axis
near(carried:chart(chart).points[1].error, whole:chart(on_whole).points[1].error, 1e-10,
  "its chart")
local map = carried:stability { p = p0, a = axis, t = 5, h = { 0.01, 1 }, rules = { "lie(1)" },
  refine = false }
ok(map:at(1, 1).class == "bounded" and map:at(1, 2).class == "wrong", "its map of stability")
map = dm.stability { system = function(k)
  return dm.euler_poincare { group = G, l = function(x) return k * x:dot(x) / 2 end }
end, k = { 1, 2 }, p = { 0.3, 0, 0 }, t = 2, h = 0.1, rule = "lie(1)" }
ok(map:at(1, 1).class == "bounded", "reduced systems made of a parameter")
raises("the start is missing", dm.stability, { system = whole, p = p0, t = 1, h = 0.1,
  rule = "lie(1)" })
raises("carries no quantity along", function()
  dm.euler_poincare { group = G, l = function(x) return x:dot(x) end }
    :solver { rule = "lie(1)", h = 0.1 }:symplecticity { p = p0, a = axis, steps = 1 }
end)
local seen = dm.scene { carried, p = p0, a = axis, watch = { "mu1", "energy" }, tolerance = 1e-3,
  until_t = 2 }:run { at = { 2 } }
local exact = whole:solver { rule = "gauss(6)", h = 0.05 }:run { q = one, p = p0, t = 2 }
near(seen:column "mu1"[#seen], exact.p[#exact][1], 1e-3, "a scene of it")

for why, wrong in pairs { ["linear in a"] = function(g, a) return g * (a + dm.vector(axis)) end,
  ["a left action"] = function(g, a) return g:transpose() * a end } do
  raises(why, dm.euler_poincare, { group = G, l = slant, a = axis, advected = wrong })
end
raises("must have 3 entries (got 1)", dm.euler_poincare, { group = G, l = slant, a = axis,
  advected = function(_, a) return { a[1] } end })
local slow = carried:solver { rule = "lie(1)", h = 0.1 }
raises("field 'a' must be 3 numbers (got 2)", slow.run, slow, { p = p0, a = { 1, 2 }, steps = 1 })
raises("field 'a': entry 2 is", slow.run, slow, { p = p0, a = { 1, 0 / 0, 0 }, steps = 1 })
local stretched = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1.1 } }
local short = slow:run { p = p0, a = axis, steps = 1 }
raises("no element of SO(3)", short.reconstruct, short, { q = stretched })
ok(short:reconstruct { q = stretched, project = true }.q[1][3][3] == 1, "or the nearest one")
raises("spatial velocity", dm.euler_poincare, dm.system { Q = G, trivialization = "right",
  L = function(_, w) return w:dot(w) / 2 end })

-- a path that is brought back again begins where it is told, and so does one whose run goes on
do
  local rigid = dm.euler_poincare { group = G, l = function(w) return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end }
  local solver = rigid:solver { rule = "lie(2)", h = 0.05 }
  local path, g0, g1 = solver:run { v = { 1, 2, 3 }, steps = 20 }, G:exp { 1, 2, 3 }, G:exp { -1, 0.5, 0 }
  local twice = path:reconstruct { q = g0 }:reconstruct { q = g1 }
  local once, rest = path:reconstruct { q = g1 }, dm.resume(path, rigid):run { steps = 5 }
  ok(far(twice.q[1], g1) < 1e-15 and far(twice.q[21], once.q[21]) < 1e-14, "brought back twice")
  ok(far(rest:reconstruct { q = g0 }.q[1], g0) < 1e-15, "the rest of a run")
end

tap.done()
