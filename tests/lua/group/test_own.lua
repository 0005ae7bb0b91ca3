-- dm.group: groups that a script defines; their axioms, errors, and where they go
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

---- what is refused ----

local up, down, diagonal = { { 0, 1 }, { 0, 0 } }, { { 0, 0 }, { 1, 0 } }, { { 1, 0 }, { 0, -1 } }
raises("not closed under brackets: E1 E2 - E2 E1", function()
  dm.group { basis = { up, down } }
end)
raises("depend on each other", function() dm.group { basis = { up, { { 0, 2 }, { 0, 0 } } } } end)
raises("entry 2 of the basis must be a square matrix", function()
  dm.group { basis = { up, { { 1, 2, 3 } } } }
end)
raises("entry 2 of the basis is of 3 x 3", function()
  dm.group { basis = { up, { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } } }
end)
raises("E1^T J + J E1 is not zero", function()
  dm.group { basis = { up, down, diagonal }, form = { { 1, 0 }, { 0, 1 } } }
end)
raises("'form' must be a regular matrix", function()
  dm.group { basis = { up }, form = { { 0, 0 }, { 0, 0 } } }
end)
raises("must be a list of square matrices", function() dm.group { basis = {} } end)
raises("option 'identity' is missing", function() dm.group { dimension = 1 } end)
raises("unknown option 'product'", function() dm.group { product = 1 } end)

-- a group with one function replaced
local function heisenberg(changed)
  local given = { name = "H", dimension = 3, identity = { 0, 0, 0 },
    mul = function(x, y) return { x[1] + y[1], x[2] + y[2], x[3] + y[3] + x[1] * y[2] } end,
    inv = function(x) return { -x[1], -x[2], x[1] * x[2] - x[3] } end,
    exp = function(x) return { x[1], x[2], x[3] + x[1] * x[2] / 2 } end,
    log = function(x) return { x[1], x[2], x[3] - x[1] * x[2] / 2 } end }
  for key, value in pairs(changed or {}) do given[key] = value end
  return dm.group(given)
end
for _, case in ipairs {
  { "dm.group 'H': the axiom of identity fails: e a is not a at a =", { identity = { 0, 0, 1 } } },
  { "the axiom of inverse fails: a a^-1 is not e at a =",
    { inv = function(x) return { -x[1], -x[2], -x[3] } end } },
  { "the axiom of associativity fails: (a b) c is not a (b c) at a =", {
    mul = function(x, y) return { x[1] + y[1], x[2] + y[2], x[3] + y[3] + x[1] ^ 3 * y[1] } end,
    inv = function(x) return { -x[1], -x[2], -x[3] + x[1] ^ 4 } end } },
  { "the axiom of exp fails: exp(xi) exp(xi/2) is not exp(3 xi/2) at xi =",
    { exp = function(x) return { x[1], x[2], x[3] } end } },
  { "the axiom of log fails: log(exp(xi)) is not xi at xi =",
    { log = function(x) return { x[1], x[2], x[3] } end } },
  { "the axiom of Ad fails", { Ad = function(_, x) return x end } },
  { "the axiom of ad fails", { ad = function() return { 0, 0, 0 } end } },
} do
  raises(case[1], function() heisenberg(case[2]) end)
end
raises("what 'exp' returns must have 3 entries (got 2)", function()
  heisenberg { exp = function(x) return { x[1], x[2] } end }
end)
raises("boom", function() heisenberg { exp = function() error "boom" end } end)
raises("exp has no derivative at 0", function()
  heisenberg { exp = function(x)
    local s = dm.sqrt(x[1] * x[1] + x[2] * x[2])
    return { x[1] * dm.sin(s) / s, x[2], x[3] }
  end }
end)
raises("what 'mul' returns must have 3 entries (got 2)", function()
  heisenberg { mul = function(x, y) return { x[1] + y[1], x[2] + y[2] } end }
end)

---- what is derived ----

local H = heisenberg()
near((H:ad({ 1, 0, 0 }, { 0, 1, 0 }) - dm.vector { 0, 0, 1 }):norm(), 0, 0, "[e1, e2] = e3")
near((H:Ad({ 1, 2, 3 }, { 1, 1, 1 }) - dm.vector { 1, 1, 1 + 1 - 2 }):norm(), 0, 1e-15, "Ad of H")
-- unit quaternions as vectors of 4: more coordinates than dimensions
local function times(a, b)
  return { a[1] * b[1] - a[2] * b[2] - a[3] * b[3] - a[4] * b[4],
    a[1] * b[2] + a[2] * b[1] + a[3] * b[4] - a[4] * b[3],
    a[1] * b[3] - a[2] * b[4] + a[3] * b[1] + a[4] * b[2],
    a[1] * b[4] + a[2] * b[3] - a[3] * b[2] + a[4] * b[1] }
end
local SU = dm.SU(2)
local mine = dm.group { name = "unit quaternions", dimension = 3, identity = { 1, 0, 0, 0 },
  mul = times, inv = function(q) return { q[1], -q[2], -q[3], -q[4] } end,
  exp = function(x) return SU:exp(x) end, log = function(q) return SU:log(q) end }
local g, x, y = SU:exp { 0.4, 0.1, -0.7 }, dm.vector { 0.3, 1, 0.2 }, dm.vector { 1, -1, 0.5 }
for _, method in ipairs { "Ad", "coAd" } do
  near((mine[method](mine, g, x) - SU[method](SU, g, x)):norm(), 0, 1e-14, method .. " derived")
end
for _, method in ipairs { "ad", "coad", "dexp", "dexpinv" } do
  near((mine[method](mine, x, y) - SU[method](SU, x, y)):norm(), 0, 1e-14, method .. " derived")
end
ok(mine:valid(g) and not mine:valid { 1, 1, 0, 0 }, "what is no element is found by log and exp")

---- systems ----

-- the same system on a group of one's own and on a built-in one
local function compare(name, one, other, rule, start, there)
  local function run(system, begin)
    local path = system:solver { rule = rule, h = 0.1 }:run { q = begin, p = start, steps = 30 }
    return path.p[31], path:column "energy"
  end
  local p, E = run(one[1], one[2])
  local r, F = run(other[1], other[2])
  near((p - r):norm(), 0, 1e-12, name .. ", " .. rule .. ": momenta")
  near(E[31] - F[31], 0, 1e-12, name .. ", " .. rule .. ": energy", there)
end
local function top(Q, R33)
  return dm.system { Q = Q, L = function(q, w)
    return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R33(q)
  end }
end
local function of_quaternion(q) return q[1] ^ 2 - q[2] ^ 2 - q[3] ^ 2 + q[4] ^ 2 end
local rotations = dm.group { name = "rotations", form = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
  basis = { dm.SO(3):hat { 1, 0, 0 }, dm.SO(3):hat { 0, 1, 0 }, dm.SO(3):hat { 0, 0, 1 } } }
local tilted, p = { 0.4, 0, 0 }, { 0.2, 0.1, 1.5 }
local built = { top(dm.SO(3), function(R) return R[3][3] end), dm.SO(3):exp(tilted) }
for _, rule in ipairs { "lie(2)", "rkmk4", "crouch-grossman3", "rotations(4)" } do
  compare("quaternions", { top(mine, of_quaternion), mine:exp(tilted) }, built, rule, p)
  compare("SU(2)", { top(SU, of_quaternion), SU:exp(tilted) }, built, rule, p)
  compare("matrices", { top(rotations, function(R) return R[3][3] end), rotations:exp(tilted) },
    built, rule, p)
end
compare("SU(2) by its lift", { top(SU, of_quaternion), SU:exp(tilted) }, built, "gauss(2)", p)
local lifted = top(rotations, function(R) return R[3][3] end):solver { rule = "gauss(3)", h = 0.1 }
  :run { q = rotations:exp(tilted), p = p, steps = 100 }
local R, E = lifted.q[101], lifted:drift "energy".largest
local off = R:transpose() * R - dm.SO(3):identity()
ok(math.abs(off[1][1]) + math.abs(off[1][2]) < 1e-13 and E < 1e-7, "gauss by the lift of a form", E)

-- what takes a group takes these
local Aff = dm.group { name = "Aff(1)", basis = { up, { { 1, 0 }, { 0, 0 } } } }
local act = dm.action { group = Aff, on = dm.R(1), map = "affine" }
near(act({ { 2, 3 }, { 0, 1 } }, { 5 })[1], 13, 0, "its affine action")
local plane = dm.system { Q = Aff, L = function(_, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 end }
local solver = plane:solver { rule = "lie(2)", h = 0.1 }
local path = solver:run { q = Aff:identity(), v = { 1, 0.3 }, steps = 50 }
local J, worst = path:momentum(Aff), 0
for i = 1, #path do worst = math.max(worst, (J[i] - J[1]):norm()) end
ok(worst < 1e-13, "spatial momentum", worst)
local file = os.tmpname()
solver:run { q = Aff:identity(), v = { 1, 0.3 }, steps = 20 }:checkpoint(file)
local on = dm.resume(file, plane):run { steps = 30 }
os.remove(file)
ok(on.q[31][1][1] == path.q[51][1][1] and on.p[31][2] == path.p[51][2], "a run goes on bit for bit")
near(path:column "R12"[51], path.q[51][1][2], 0, "a column of an entry")
ok(tostring(Aff) == "Aff(1)" and tostring(dm.product(Aff, dm.R(2))) == "Aff(1) x R^2", "its name")
ok(Aff == Aff and Aff ~= dm.group { name = "Aff(1)", basis = { up, { { 1, 0 }, { 0, 0 } } } },
  "a group is the one that was made")
local reduced = dm.euler_poincare { group = Aff, l = function(v) return v:dot(v) / 2 end }
  :solver { rule = "lie(2)", h = 0.1 }:run { p = { 1, 0.3 }, steps = 50 }
near((reduced.p[51] - path.p[51]):norm(), 0, 1e-14, "reduced")
raises("this is no element of Aff(1)", function()
  solver:run { q = { { 1, 0 }, { 0.5, 1 } }, v = { 1, 0 }, steps = 1 }
end)
---- a start off the group is no start: by no logarithm, of another component ----

local function start_at(Q, q, project)
  return dm.system { Q = Q, L = function(_, xi) return xi:dot(xi) / 2 end }
    :solver { rule = "lie(1)", h = 0.01 }
    :run { q = q, v = dm.zeros(Q.dimension), steps = 1, project = project }
end
local traceless = dm.group { name = "my SL(2)",
  basis = { { { 0, 1 }, { 0, 0 } }, { { 0, 0 }, { 1, 0 } }, { { 1, 0 }, { 0, -1 } } } }
local slanted = dm.group { basis = { { { 1, 0 }, { 0, 2 } } }, name = "slanted" }
for _, project in ipairs { false, true } do
  raises("its determinant is -1, not 1", start_at, traceless, dm.matrix { { 1, 0 }, { 0, -1 } }, project)
  raises("no element of slanted", start_at, slanted, dm.matrix { { -2, 0 }, { 0, 3 } }, project)
  raises("its determinant is -1, not 1", start_at, dm.SL(3),
    dm.matrix { { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } }, project)
end
tap.ok(start_at(traceless, dm.matrix { { -2, 0 }, { 0, -0.5 } }), "an element without a logarithm")

tap.done()
