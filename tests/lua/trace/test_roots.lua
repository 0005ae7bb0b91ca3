-- dm.root: functions known by an equation, against closed forms, other formulations and their own invariants
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, exp, sqrt, abs, max = math.sin, math.cos, math.exp, math.sqrt, math.abs, math.max
local function cosh(x) return (exp(x) + exp(-x)) / 2 end
local function sinh(x) return (exp(x) - exp(-x)) / 2 end

local function worst(a, b)
  local most = 0
  for i = 1, #a do most = max(most, abs(a[i] - b[i])) end
  return most
end
local function far(A, B)
  local most = 0
  for i = 1, #A do most = max(most, worst(A[i], B[i])) end
  return most
end

---- Kepler's equation E - e sin E = M: derivatives by hand ----
local kepler = dm.root { name = "anomaly", start = function(M) return M end,
  equations = function(E, M, e) return E - e * sin(E) - M end }
for _, x in ipairs { { 0.7, 0.4 }, { 3.0, 0.9 }, { -20.3, 0.2 }, { 1e-3, 0.99 } } do
  local M, e = x[1], x[2]
  local E = kepler(M, e)
  near(E - e * sin(E), M, 4e-16 * max(1, abs(M)), "Kepler's equation holds at M = " .. M)
  local d, s, c = 1 - e * cos(E), sin(E), cos(E)
  local f = dm.trace(kepler, "number", "number")
  near(f(M, e), E, 0, "traced, it is the same number")
  ok(worst(f:gradient(M, e), { 1 / d, s / d }) < 1e-14 / d ^ 2, "its gradient", f:gradient(M, e))
  local EM, Ee = 1 / d, s / d
  local H = { { -e * s * EM ^ 3, c * EM ^ 2 - e * s * Ee * EM ^ 2 },
    { c * EM ^ 2 - e * s * Ee * EM ^ 2, (2 * c * Ee - e * s * Ee ^ 2) / d } }
  ok(far(f:hessian(M, e), H) < 1e-13 * EM ^ 3, "and its Hessian", far(f:hessian(M, e), H))
end
-- the fourth derivative by M at e = 1/2, M = 0: E = 2 M - (8/3) M^3 ..., E'''' = 0, E''' = -e/(1-e)^4 (Lagrange's series)
local d3 = dm.derivative(dm.derivative(dm.derivative(function(M) return kepler(M, 0.5) end)))
near(d3(0), -0.5 / 0.5 ^ 4, 1e-13, "third derivative at M = 0")
near(dm.derivative(d3)(0), 0, 1e-12, "fourth derivative at M = 0")

---- the square root of a matrix, four unknowns: d vec(Y) by the closed form of 2 x 2 ----
local root2 = dm.root { name = "square root", start = { 1, 0, 0, 1 }, branch = function(y) return y[1] + y[4] end,
  equations = function(y, a)
    return { y[1] * y[1] + y[2] * y[3] - a[1], y[1] * y[2] + y[2] * y[4] - a[2],
      y[3] * y[1] + y[4] * y[3] - a[3], y[3] * y[2] + y[4] * y[4] - a[4] }
  end }
local function closed(a) -- (A + sqrt(det A) 1) / sqrt(tr A + 2 sqrt(det A))
  local s = sqrt(a[1] * a[4] - a[2] * a[3])
  local t = 1 / sqrt(a[1] + a[4] + 2 * s)
  return { (a[1] + s) * t, a[2] * t, a[3] * t, (a[4] + s) * t }
end
local a = { 2.3, 0.4, -0.7, 1.9 }
ok(worst(root2(a), closed(a)) < 1e-15, "square root of a matrix", worst(root2(a), closed(a)))
local by_root, by_form = dm.trace(root2, 4), dm.trace(closed, 4)
ok(far(by_root:jacobian(a), by_form:jacobian(a)) < 1e-14, "its derivative", far(by_root:jacobian(a), by_form:jacobian(a)))
local weights = dm.vector { 0.3, -1.2, 0.8, 0.5 }
local function weighed(f) return dm.trace(function(x) return weights:dot(dm.vector(f(x))) + f(x)[1] * f(x)[4] end, 4) end
local A, B = weighed(root2):hessian(a), weighed(closed):hessian(a)
ok(far(A, B) < 1e-13, "second derivatives of a function of its entries", far(A, B))

---- spheroidal coordinates: x = cosh u cos t, z = sinh u sin t, in a field of two centres ----
local spheroidal = dm.root { name = "spheroidal", branch = function(y) return y[1] end,
  start = function(q) return { 1, math.atan(q[2], q[1]) } end,
  equations = function(y, q)
    return { cosh(y[1]) * cos(y[2]) - q[1], sinh(y[1]) * sin(y[2]) - q[2] }
  end }
local function two_centres(q) return 1 / ((q - dm.vector { 1, 0 }):norm()) + 1 / ((q + dm.vector { 1, 0 }):norm()) end
-- r1 + r2 = 2 cosh u, r1 r2 = cosh^2 u - cos^2 t
local function by_coordinates(q)
  local y = spheroidal(q)
  local c = cosh(y[1])
  return 2 * c / (c ^ 2 - cos(y[2]) ^ 2)
end
local q0 = { 0.9, 1.3 }
local V, W = dm.trace(by_coordinates, 2), dm.trace(two_centres, 2)
near(V(q0), W(q0), 1e-15, "a potential in implicit coordinates")
ok(worst(V:gradient(q0), W:gradient(q0)) < 1e-14, "its force", worst(V:gradient(q0), W:gradient(q0)))
ok(far(V:hessian(q0), W:hessian(q0)) < 1e-13, "its second derivatives", far(V:hessian(q0), W:hessian(q0)))

---- in every family of rules: the same path as without the root ----
local implicit = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + by_coordinates(q) end }
local plain = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + two_centres(q) end }
local start = { q = { 0.2, 1.5 }, v = { 0.9, 0.1 }, steps = 40 }
for _, rule in ipairs { "verlet", "midpoint", "gauss(2)", "gauss(4)", "kahan-li(8)", "lobatto(3)", "galerkin(2, gauss(3))",
  "blanes-moan(6)", "rk8", "trapezoidal", "log-hamiltonian(2)", "curve(4)" } do
  local made, solver = pcall(function() return implicit:solver { rule = rule, h = 0.02 } end)
  if made then
    local p, r = solver:run(start), plain:solver({ rule = rule, h = 0.02 }):run(start)
    near((p.q[#p] - r.q[#r]):norm(), 0, 1e-12, rule .. ": the path of the same system")
  end
end
local solver = implicit:solver { rule = "gauss(2)", h = 0.02 }
local long = { q = { 0.3, 2.2 }, v = { 0.9, 0 }, steps = 2000, every = 10 }
ok(solver:run(long):drift("energy").largest < 1e-6, "energy through a root", solver:run(long):drift("energy").largest)
ok(solver:symplecticity { q = start.q, v = start.v, steps = 20 } < 1e-11, "gauss(2) is symplectic through a root",
  solver:symplecticity { q = start.q, v = start.v, steps = 20 })

---- constraints, forces, events ----
local bead = dm.root { name = "wire", start = 0, equations = function(u, x) return u ^ 3 + u - x end }
local at, rate = bead(0.5), 0.1 / (3 * bead(0.5) ^ 2 + 1)
for _, rule in ipairs { "rattle", "gauss(2)" } do
  local function slide(constraint)
    return dm.system({ Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end, constraint = constraint })
      :solver({ rule = rule, h = 0.01 }):run { q = { 0.5, at }, v = { 0.1, rate }, steps = 100, project = true }
  end
  local p, r = slide(function(q) return q[2] - bead(q[1]) end), slide(function(q) return q[2] ^ 3 + q[2] - q[1] end)
  near((p.q[101] - r.q[101]):norm(), 0, 1e-15, rule .. ": a wire known by its equation")
end
local function drag(force)
  local p = dm.system({ Q = dm.R(1), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end, force = force })
    :solver({ rule = "gauss(2)", h = 0.05 }):run { q = { 0.5 }, v = { 0 }, steps = 100 }
  return p.q[101][1]
end
near(drag(function(_, v) return { -bead(v[1] ^ 3 + v[1]) } end), drag(function(_, v) return { -v[1] } end), 1e-14, "a force")
local crossing = dm.system({ Q = dm.R(1), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end }):solver({ rule = "gauss(4)", h = 0.05 })
  :run { q = { 1 }, v = { 0 }, steps = 40, events = { zero = function(q) return bead(q[1] + 0.5) - at end } }
near(crossing.events[1].t, math.pi / 2, 1e-9, "an event")

---- bits: backends, members, restarts ----
local function last(options)
  local p = implicit:solver(options):run(start)
  return ("%a %a"):format(p.q[#p][1], p.p[#p][2])
end
for _, rule in ipairs { "gauss(3)", "blanes-moan(6)", "midpoint" } do
  ok(last { rule = rule, h = 0.02, backend = "tape" } == last { rule = rule, h = 0.02, backend = "jit" },
    rule .. ": tape and machine code give the same bits")
end
local ensemble = implicit:solver({ rule = "gauss(2)", h = 0.02 }):ensemble { members = 5, threads = 2, steps = 40,
  q = function(i) return { 0.2 + 0.1 * i, 1.5 } end, v = function() return { 0.9, 0.1 } end }
for i = 1, 5 do
  local p = implicit:solver({ rule = "gauss(2)", h = 0.02 }):run { q = { 0.2 + 0.1 * i, 1.5 }, v = { 0.9, 0.1 }, steps = 40 }
  ok(worst(ensemble.q[i], p.q[#p]) == 0, "member " .. i .. " has the bits of a run of its own")
end

-- a discrete Lagrangian in the frame that turns q0 onto the first axis: the step remembers roots, and a run goes on bit for bit
local turn = dm.root { name = "angle", start = 0.1, branch = function(t, q) return q[1] * cos(t) + q[2] * sin(t) end,
  equations = function(t, q) return q[2] * cos(t) - q[1] * sin(t) end }
local function well(a, b) return (b - a):dot(b - a) / 0.2 - 0.025 * (a:dot(a) + b:dot(b)) - 0.01 * a:dot(b) ^ 2 - 0.3 * b[2] ^ 2 end
local function turned(t, z) return dm.vector { cos(t) * z[1] + sin(t) * z[2], cos(t) * z[2] - sin(t) * z[1] } end
local function framed(by) return function(x, y) return well(turned(by(x), x), turned(by(x), y)) end end
local Ld = dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = framed(turn) }
local stepper = dm.solver { Ld }
local function ends(p) local q, m = p.q[#p], p.p[#p] return ("%a %a %a %a"):format(q[1], q[2], m[1], m[2]) end
local begin = { q = { 1, 0.2 }, p = { 0, 1 } }
local function run(steps) begin.steps = steps return stepper:run(begin) end
local whole, half = run(60), run(25)
stepper:run { q = { -1, 0.2 }, p = { 0.3, 1 }, steps = 7 }
ok(ends(dm.resume(half):run { steps = 35 }) == ends(whole), "a run of a discrete Lagrangian with a root is resumed bit for bit")
local apart = stepper:ensemble { members = 3, threads = 2, steps = 60, q = function(i) return { 0.9 + 0.1 * i, 0.2 } end, p = function() return { 0, 1 } end }
ok(worst(apart.q[1], whole.q[61]) == 0, "and so is its member of an ensemble")
local formula = dm.solver { dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = framed(function(q) return math.atan(q[2], q[1]) end) } }
local other = formula:run { q = begin.q, p = begin.p, steps = 60 }
ok(worst(other.q[61], whole.q[61]) < 1e-13, "the path is that of the formula", worst(other.q[61], whole.q[61]))
local J = dm.matrix { { 0, -1 }, { 1, 0 } }
local kept = 0
for i = 1, #whole do kept = max(kept, abs((J * whole.q[i]):dot(whole.p[i]) - (J * whole.q[1]):dot(whole.p[1]))) end
ok(kept < 1e-14, "a well that is not round, seen in the frame: angular momentum is kept", kept)

---- nested, hyper-dual, stationary ----
local y = dm.root { name = "cubic", start = 1, equations = function(u, x) return u ^ 3 + x * u - 1 end }
local z = dm.root { name = "nested", start = 0.5, equations = function(u, x) return u - exp(-u * y(x)) end }
-- z = W(y) / y with Lambert's W: dz/dy = -W^2 / (y^2 (1 + W)); dy/dx = -y / (3 y^2 + x)
local x0 = 0.5
local y0, z0 = y(x0), z(x0)
local slope = -(z0 * y0) ^ 2 / (y0 ^ 2 * (1 + z0 * y0)) * (-y0 / (3 * y0 ^ 2 + x0))
near(dm.derivative(z)(x0), slope, 1e-15, "derivative of a root of a root")
local both = dm.trace(function(q) return z(q[1] ^ 2) * y(q[1]) end, 1)
local slow = dm.system { Q = dm.R(1), derivatives = "hyperdual", L = function(q, v) return v[1] ^ 2 / 2 - z(q[1] ^ 2) * y(q[1]) end }
local fast = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - both(q) end }
local options = { q = { 0.3 }, v = { 0.1 }, steps = 20 }
for _, rule in ipairs { "gauss(2)", "verlet" } do
  local P, R = slow:solver({ rule = rule, h = 0.1 }):run(options), fast:solver({ rule = rule, h = 0.1 }):run(options)
  near(P.q[21][1], R.q[21][1], 1e-14, rule .. ": hyper-dual numbers, and a traced function used again")
end
local function energy_like(u, p) return u:dot(u) * (1 + p[1] ^ 2) / 2 + 0.3 * u[1] * u[2] + u[1] ^ 4 - p[1] * u[1] - p[2] * u[2] end
local extremum = dm.root { name = "extremum", start = { 0, 0 }, stationary = energy_like }
local value = dm.trace(function(p) return extremum:value(p) end, 2)
local same = dm.trace(function(p) return energy_like(extremum(p), p) end, 2)
local at = { 0.7, -0.3 }
near(value(at), same(at), 1e-16, "the value of an extremum")
ok(worst(value:gradient(at), same:gradient(at)) < 1e-15, "its gradient needs no derivative of y")
ok(far(value:hessian(at), same:hessian(at)) < 1e-14, "its Hessian", far(value:hessian(at), same:hessian(at)))
near(extremum:value(at), value(at), 1e-16, "the value on numbers")
local J = extremum:inverse(at)
local yy = extremum(at)
local M = dm.matrix { { 1.49 + 12 * yy[1] ^ 2, 0.3 }, { 0.3, 1.49 } }
ok(far(J * M, dm.matrix { { 1, 0 }, { 0, 1 } }) < 1e-15, "the inverse Jacobian")

-- where it is not needed a root need not exist, nor its derivatives
local half = dm.root { name = "half line", start = 1, branch = function(u) return u end, equations = function(u, x) return u ^ 2 - x end }
local cut = dm.trace(function(x) return dm.where(x, half(x) ^ 3, 0) end)
ok(cut(-1) == 0 and cut:gradient(-1)[1] == 0 and cut:hessian(-1)[1][1] == 0, "beside a branch that is not taken")
near(cut:gradient(4)[1], 3, 1e-14, "and where it is")

---- shapes, starts, functions that change ----
local pair = dm.root { unknowns = 2, equations = function(u, x, k) return { u[1] + u[2] - x, u[1] - k * u[2] - 1 } end }
ok(worst(pair(3, 1), { 2, 1 }) == 0, "without a start: zeros")
near(dm.root({ start = { { 1e9 }, { -1 } }, equations = function(u) return { u[1] ^ 2 - 2 } end, branch = function(u) return -u[1] end })()[1],
  -sqrt(2), 4e-16, "a list of starts, no arguments")
local k = 2
local changing = dm.root { start = 1, equations = function(u, x) return u - k * x end }
near(changing(3), 6, 0, "an upvalue")
k = 5
near(changing(3), 15, 0, "that changes is seen, on numbers")
near(dm.trace(changing)(2), 10, 0, "and by a trace")
k = 7
near(dm.trace(changing)(2), 14, 0, "at once")
ok(dm.trace(changing):graph() == "y1 = dm.root(x1)[1]\n", "the text of a graph", dm.trace(changing):graph())
ok(tostring(kepler) == "implicit function 'anomaly'", "its text", tostring(kepler))

---- without a look at the equations ----
local factor = 4
local scaled = dm.root { start = 1, equations = function(u, x) return u ^ 2 - factor * x end }
ok(scaled(1) == 2, "a root")
factor = 9
ok(scaled:traced(1) == 2, "as it was traced")
ok(scaled(1) == 3 and scaled:traced(1) == 3, "traced anew by a call that looks at the equations")
-- what was traced for a call that compares nothing is compared by the first one that does, as it is then
do
  local by = 2
  local late = dm.root { equations = function(y, x) return y - by * x end, start = 0 }
  ok(late:traced(3) == 6, "traced")
  by = 5
  ok(late(0) == 0 and late(3) == 15, "the functions are what they are now, though this root is the same")
  local blind = dm.root { equations = function(y, x) return y - (type(x) == "number" and 1 or 2) * x end, start = 0 }
  ok(blind:traced(3) == 6, "as its trace says")
  raises("not what its trace says", blind, 3)
  raises("not what its trace says", dm.derivative, function(x) return blind(x[1]) end, 1)
end
raises("has no value at (-1)", scaled.traced, scaled, -1)

---- roots far away, on the way to which increments grow as y does ----
for name, far_away in pairs { log = { function(y) return math.log(y) end, 100, exp(100) }, power = { function(y) return y ^ 0.1 end, 30, 30 ^ 10 },
  asinh = { function(y) return math.log(y + sqrt(y * y + 1)) end, 100, sinh(100) } } do
  local f, x, y = table.unpack(far_away)
  near(dm.root({ start = 1, equations = function(u, z) return f(u) - z end })(x) / y, 1, 1e-13, name .. ": a root far from its start")
end

---- failures ----
local none = dm.root { name = "shadow", failure = "look elsewhere", start = 1, equations = function(u, x) return u ^ 2 + x end }
raises("shadow has no value at (2): Newton's method found no root", none, 2)
raises("look elsewhere", none, 2)
raises("the residual is inf", dm.root { start = { 0, 1 }, equations = function(y, x) return { dm.sqrt(y[1] - 2), y[2] - x } end }, 1)  -- NaN before a zero
raises("the branch condition, which must be > 0, is -", dm.root { start = -1, branch = function(u) return u - 9 end,
  equations = function(u) return u ^ 2 - 4 end })
raises("singular", dm.root { start = 1, equations = function(u) return u ^ 2 end })
raises("singular", dm.root { unknowns = 1, equations = function() return { 3 } end })
raises("singular", spheroidal, { 1, 0 })
raises("gives 1 numbers for 2 unknowns", dm.root { unknowns = 2, equations = function(u) return { u[1] } end })
raises("gives 2 numbers for 3 unknowns", dm.root { unknowns = 3, start = function() return { 1, 2 } end, equations = function(u) return u end })
raises("must return", dm.root { start = 1, equations = function() end })
raises("give one of 'equations'", dm.root, {})
raises("give 'start'", dm.root, { equations = function(u) return u end })
raises("field 'branch' must be a function", dm.root, { start = 1, equations = function(u) return u end, branch = 3 })
raises("did you mean 'equations'", dm.root, { equation = function(u) return u end, start = 1 })
raises("field 'start'", dm.root, { equations = function(u) return u end, start = {} })
raises("argument 1 must be a number", kepler, "M", 0.1)
raises("is NaN, but must be finite", kepler, 0 / 0, 0.1)
raises("pass them as arguments", function()
  dm.trace(function(x) return dm.root { start = 1, equations = function(u) return u - x end }() end)
end)
raises("only a root of 'stationary' has a value", function() return kepler:value(1, 0.1) end)
raises("no C text (dm.sum_over, dm.root)", function() return implicit:emit_c() end)
raises("spheroidal has no value", function() return V { 1, 0 } end)
local fine, failure = pcall(function()
  return dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + half(q[1]) end })
    :solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1 }, v = { -2 }, steps = 100 }
end)
ok(not fine and tostring(failure):find("half line has no value at (-", 1, true) and #failure.path > 3,
  "a run that leaves the domain says which function, and keeps its path", tostring(failure))

---- far starts, flat and steep ones, systems of the literature (More, Garbow, Hillstrom 1981) ----

local function is_found(name, equations, start, root)
  local y = dm.root { start = start, equations = equations }()
  local is_one = type(root) == "number"
  local off = is_one and math.abs(y / root - 1) or (y - dm.vector(root)):norm() / dm.vector(root):norm()
  ok(off < 1e-12, name, y)
end
is_found("y^0.1 = 100 is 20 decades away", function(y) return y ^ 0.1 - 100 end, 1, 1e20)
is_found("y^0.01 = 3 is 48", function(y) return y ^ 0.01 - 3 end, 1, 3 ^ 100)
is_found("log y = 100", function(y) return dm.log(y) - 100 end, 1, math.exp(100))
is_found("y^0.5 = 1e5", function(y) return dm.sqrt(y) - 1e5 end, 1, 1e10)
is_found("1/y = 1e-6", function(y) return 1 / y - 1e-6 end, 1, 1e6)
is_found("y^10 = 1 from the flat side", function(y) return y ^ 10 - 1 end, 0.5, 1)
is_found("y^9 = 1e-9 from the steep side", function(y) return y ^ 9 - 1e-9 end, 2, 0.1)
is_found("exp y = 1e10", function(y) return dm.exp(y) - 1e10 end, 0, 10 * math.log(10))
is_found("exp y = 1e-10 from afar", function(y) return dm.exp(y) - 1e-10 end, 30, -10 * math.log(10))
is_found("atan y = 1 from where Newton's method diverges", function(y) return dm.atan(y) - 1 end, 10, math.tan(1))
is_found("atan y = 1.5 from the other side", function(y) return dm.atan(y) - 1.5 end, -20, math.tan(1.5))
is_found("Powell's badly scaled function", function(y)
  return { 1e4 * y[1] * y[2] - 1, dm.exp(-y[1]) + dm.exp(-y[2]) - 1.0001 }
end, { 0, 1 }, { 1.0981593296998e-5, 9.1061467398665 })
local function freudenstein_roth(y)
  return { -13 + y[1] + ((5 - y[2]) * y[2] - 2) * y[2], -29 + y[1] + ((y[2] + 1) * y[2] - 14) * y[2] }
end
is_found("Freudenstein and Roth's", freudenstein_roth, { 0.5, -2 }, { 5, 4 })
is_found("and from afar", freudenstein_roth, { 15, -2 }, { 5, 4 })
is_found("Rosenbrock's", function(y) return { 10 * (y[2] - y[1] ^ 2), 1 - y[1] } end, { -1.2, 1 }, { 1, 1 })
is_found("Brown's badly scaled function", function(y) return { y[1] - 1e6, y[2] - 2e-6 } end, { 1, 1 }, { 1e6, 2e-6 })
for name, equations in pairs { ["exp y = -1"] = function(y) return dm.exp(y) + 1 end, ["y^2 = -1"] = function(y) return y ^ 2 + 1 end,
  ["atan y = 2"] = function(y) return dm.atan(y) - 2 end } do
  local found, why = pcall(dm.root { start = 0.7, equations = equations })
  ok(not found and why:find("no root from any start", 1, true), name .. " has none", why)
end

tap.done()
