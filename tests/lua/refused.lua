-- One of everything, for tests/c/refuse.c: no error is caught, so that a refused request is seen.
local dm = require "dm"

local a, M = dm.vector { 1, 2, 3 }, dm.matrix { { 2, 1 }, { 1, 3 } }
assert((a + 2 * a):dot(a) == 42 and #tostring(a:cross { 0, 0, 1 }) > 0)
assert(#tostring(M * M:inverse()) > 0 and M:solve { 1, 2 })

local gradient = dm.derivative(function(x) return math.sin(x[1]) * x[2] ^ 2 end, 2)
assert(gradient { 0, 3 }[1] == 9)

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
assert(#tostring(kepler) > 0)
local path = kepler:solver { rule = "verlet", h = 0.01 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 50, every = 5 }
assert(#tostring(path) > 0 and #path:energy() == 11 and #path:csv() > 100)
path:momentum(dm.SO(2))

local swing = dm.system { Q = dm.T(1), L = function(q, v) return v:dot(v) / 2 * (2 + math.cos(q[1])) end }
swing:solver { rule = "gauss(2)", h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 20 }

-- sweeps do not contract: Newton's kernel is made within the first step
local stiff = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 1e6 * q:dot(q) + math.cos(q[1]) end }
stiff:solver { rule = "gauss(2)", h = 0.1 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 2 }

local Ld = dm.discrete_lagrangian(kepler, { rule = dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 } }, h = 0.1 })
assert(Ld({ 1, 0 }, { 1, 0.1 }) > 0 and Ld:hamilton_pontryagin({ 1, 0 }, { 1, 0.1 }).residual < 1e-13 and #tostring(Ld) > 0)
dm.solver { Ld }:run { q0 = { 1, 0 }, q1 = { 1, 0.1 }, steps = 3 }
swing:solver({ rule = dm.sprk { a = { { 0.5 } }, b = { 1 } }, h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 2 }
assert(#dm.rules() > 20)

local cubic = dm.root { start = 1, equations = function(y, x) return y ^ 3 + x[1] * y - 1 end, branch = function(y) return y end }
assert(cubic { 0 } == 1 and dm.trace(function(x) return cubic(x) ^ 2 end, 1):hessian { 0.5 }[1][1] < 1)
dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - cubic { q[1] ^ 2 + 1 } end })
  :solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 2 }

local rows = dm.sequence { y = { 2 }, unknowns = 1, steps = 3, start = function(y) return y end, next = function(y, x) return x end,
  equation = function(y, x) return { x[1] ^ 2 - y[1] } end }
assert(rows.rows == 4 and dm.stationary { term = function(w) return (w[2] - w[1]) ^ 2 end, sites = 3, block = 1, window = 2, x = { 0, 5, 2 },
  given = { true, false, true } }[2] == 1)

local sphere = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, force = function(q) return -q end,
  constraint = function(q) return q:dot(q) - 1 end }
path = sphere:solver({ rule = "rattle", h = 0.1 }):run { q = { 0.6, 0, -0.7 }, v = { 0, 1, 1 }, steps = 20, project = true }
assert(path:worst "constraint" < 1e-14)

local own = dm.curve { method = function(x, f, h) return x + h * f(x + h / 2 * f(x)) end, bias = 0.5 }
swing:solver { rule = own, h = 0.1 }:run { q = { 1 }, v = { 0 }, steps = 5 }
assert(dm.bundle({ system = swing, h = 0.1, segments = own }):check({ q = { 1 }, v = { 0 } }).ok)

-- q + v y - y^2/2 over y: an extremum, its Hessian by a Schur complement
local top = dm.system { Q = dm.R(1), L = function(q, v)
  local y = v[1] * q[1]
  return dm.extremum(v[1] ^ 2 + y * y / 2 - q[1] ^ 2, function(x, u, z) return u[1] ^ 2 + u[1] * x[1] * z[1] - z[1] ^ 2 / 2 - x[1] ^ 2 end, { y }, q, v)
end }
path = top:solver({ rule = "gauss(1)", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 2 }
assert(#dm.path { system = top, h = 0.1, columns = { path:column "t", path:column "q1", path:column "p1" } } == 3)

-- equations on a mesh, by every solver
local mesh = dm.mesh { triangle = 4 }
mesh:poisson { f = 1, fixed = { boundary = 0 } }
mesh:poisson { f = 1, solver = "gradients" }
mesh:poisson { f = 1, solver = "dense" }
local stiffness = mesh:laplacian(0, { fixed = { 1 } }).stiffness:pick(nil, nil)
assert(#tostring(stiffness) > 0 and #mesh:laplacian(1):eigen(3).values == 3 and #mesh:harmonic(0) == 1)
mesh:form(1, dm.zeros(mesh:count(1))):hodge()
dm.mesh({ grid = 2 }):darcy { pressure = 1 }

-- waves by every engine, transforms, elements
local function bump(x) return math.exp(-x * x) end
for _, given in ipairs { { "strang" }, { "gauss(2)", g = 0.01 }, { "two-step", V = bump }, { "strang", space = "galerkin", V = bump },
  { "gauss(1)", boundary = "walls" } } do
  local wave = dm.schroedinger { x = { -4, 4, 8 }, V = given.V, g = given.g, space = given.space, boundary = given.boundary }
  local waved = wave:solver({ rule = given[1], h = 0.01 }):run { psi = function(x) return (16 - x * x) * bump(x) end, steps = 3 }
  assert(#waved == 4 and #tostring(waved) > 0 and waved.psi[4]:norm() > 0 and (given.g or #wave:eigen(2).psi == 2))
end
assert(#dm.fft { 1, 2, 3 } == 3 and #dm.msfem { a = math.exp, f = bump, x = { 0, 1, 2 } }.u == 3)
