--- Calls that are right: rows { name, function that takes a table, that table }. A field of a table
-- is changed or left out before the call, so that everything behind the first check is reached.
local dm = require "dm"

local M = {}

local function on_line(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end
local function spin(W) return (W[1] ^ 2 + 2 * W[2] ^ 2 + 3 * W[3] ^ 2) / 2 end
local function twice(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end
local G = dm.SO(3)

-- a system, a solver and a run of a few steps in one table
local function whole(o)
  local system = dm.system(o.system)
  return system:solver(o.solver):run(o.run)
end
local line = dm.system { Q = dm.R(1), L = on_line }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local top = dm.system { Q = G, L = function(R, W) return spin(W) - R[3][3] end }
local verlet = kepler:solver { rule = "verlet", h = 0.05 }
local gauss = line:solver { rule = "gauss(2)", h = 0.1 }
local curved = line:solver { rule = dm.curve "rk4", h = 0.1 }
local at = { q = { 1, 0 }, v = { 0, 1 }, steps = 3 }
local turned = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 }, steps = 3 }
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
local planet = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + 1 / q[2]
end }
local square, solid = dm.mesh { grid = 2 }, dm.mesh { bcc = 3 }

local function with(t, more)
  local out = {}
  for key, x in pairs(t) do out[key] = x end
  for key, x in pairs(more) do out[key] = x end
  return out
end

local systems = {
  { "a run", whole, { system = { Q = dm.R(1), L = on_line }, solver = { rule = "gauss(2)", h = 0.1 },
    run = { q = { 1 }, v = { 0 }, steps = 3 } } },
  { "a run of kicks", whole, { system = { Q = dm.R(2), L = twice },
    solver = { rule = "yoshida(4)", h = 0.1 }, run = at } },
  { "a run by H", whole, { system = { Q = dm.R(1), H = function(q, p)
      return p[1] ^ 2 / 2 * (1 + q[1] ^ 2)
    end }, solver = { rule = "midpoint", h = 0.1 }, run = { q = { 1 }, p = { 0 }, steps = 3 } } },
  { "a run by split H", whole, { system = { Q = dm.R(1), H = function(q, p, t)
      return p[1] ^ 2 / 2 + q[1] ^ 2 * math.cos(t)
    end }, solver = { rule = "verlet", h = 0.1 }, run = { q = { 1 }, p = { 0 }, steps = 3 } } },
  { "a run on a group", whole, { system = { Q = G, L = function(R, W) return spin(W) - R[3][3] end },
    solver = { rule = "lie(1)", h = 0.1 }, run = turned } },
  { "a forced run on a group", whole, { system = { Q = G, L = function(_, W) return spin(W) end,
      force = function(_, W) return { -W[1], -W[2], 0 } end },
    solver = { rule = "lie(2)", h = 0.1 }, run = turned } },
  { "a tied run", whole, { system = { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - q[2] end,
      constraint = function(q) return q:dot(q) - 1 end },
    solver = { rule = "rattle", h = 0.05 }, run = at } },
  { "a rolling run", whole, { system = { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end,
      rolling = function(q, v) return v[3] - q[2] * v[1] end },
    solver = { rule = "gauss(2)", h = 0.05 },
    run = { q = { 0, 1, 0 }, v = { 1, 0.5, 1 }, steps = 3 } } },
  { "a steered run", whole, { system = { Q = dm.R(1), L = on_line,
      force = function(_, v, _, u) return { u[1] - v[1] } end,
      control = function(q) return { -q[1] } end, params = { k = 1 } },
    solver = { rule = "midpoint", h = 0.05 }, run = { q = { 1 }, v = { 0 }, steps = 3 } } },
  { "a hyperdual run", whole, { system = { Q = dm.R(1), L = on_line, derivatives = "hyperdual" },
    solver = { rule = "midpoint", h = 0.1 }, run = { q = { 1 }, v = { 0 }, steps = 2 } } },
  { "euler_poincare", function(o)
    return dm.euler_poincare(o.system):solver(o.solver):run(o.run)
  end, { system = { group = G, l = spin }, solver = { rule = "lie(1)", h = 0.1 },
    run = { v = { 1, 2, 3 }, steps = 3 } } },
  { "euler_poincare with gravity", function(o)
    return dm.euler_poincare(o.system):solver(o.solver):run(o.run)
  end, { system = { group = G, l = function(W, a) return spin(W) - a[3] end,
      advected = dm.action { group = G, on = dm.R(3) } }, solver = { rule = "lie(2)", h = 0.1 },
    run = { p = { 0.1, 0.2, 1 }, a = { 0, 0, 1 }, steps = 3 } } },
  { "dm.step", function(o) return line:solver({ rule = dm.step(o), h = 0.1 })
    :run { q = { 1 }, p = { 0 }, steps = 2 } end,
    { unknowns = 1, order = 1, start = function(y) return { y.p[1] } end,
      equation = function(y, x, h) return { x[1] - y.p[1] + h * y.q[1] } end,
      next = function(y, x, h) return { q = { y.q[1] + h * x[1] }, p = { x[1] } } end } },
  { "dm.step on a group", function(o) return top:solver({ rule = dm.step(o), h = 0.1 })
    :run(turned) end,
    { unknowns = 3, order = 1, start = function(y, h) return { h * y.p[1], 0, 0 } end,
      equation = function(y, x, h) return G:dexpinv(-x, x / h) - y.p end,
      next = function(y, x, h)
        return { q = G:compose(y.q, G:exp(x)), p = G:dexpinv(x, x / h) }
      end } },
  { "an own Ld", function(o)
    return dm.solver({ dm.discrete_lagrangian(o) }):run { q0 = { 1 }, q1 = { 1 }, steps = 3 }
  end, { Q = dm.R(1), h = 0.1, Ld = function(q0, q1, h)
    return (q1[1] - q0[1]) ^ 2 / (2 * h) - h * (q0[1] + q1[1]) ^ 2 / 8
  end, force = function(q0, q1, h) return { -h * q0[1], -h * q1[1] } end } },
  { "galerkin", function(o) return line:solver { rule = dm.galerkin(o), h = 0.1 } end,
    { degree = 2, nodes = { 0, 0.5, 1 }, weights = { 1 / 6, 2 / 3, 1 / 6 } } },
  { "sprk", function(o) return line:solver { rule = dm.sprk(o), h = 0.1 } end,
    { a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 0.5, 0.5 }, A = { { 0.5, 0 }, { 0.5, 0 } },
      B = { 0.5, 0.5 }, c = { 0, 1 } } },
  { "curve", function(o) return line:solver({ rule = dm.curve(o), h = 0.1 })
    :run { q = { 1 }, v = { 0 }, steps = 2 } end,
    { method = function(x, f, h) return x + h * f(x + h / 2 * f(x)) end, order = 2, bias = 0.5 } },
}

local measures = {
  { "run", function(o) return verlet:run(o) end, with(at, { every = 2,
    events = { apsis = function(q, v) return q:dot(v) end },
    watch = { r = function(q) return q:norm() end } }) },
  { "run to given times", function(o) return verlet:run(o) end,
    { q = { 1, 0 }, v = { 0, 1 }, at = { 0.05, 0.12 } } },
  { "run into a file", function(o) return verlet:run(o) end,
    with(at, { file = "f.npy", checkpoint = "f.checkpoint" }) },
  { "a run of 2^62 steps", function(o)
    return verlet:run { q = o.q, v = o.v, steps = 2 ^ 62 // 1 | 0 }
  end, { q = { 1, 0 }, v = { 0, 1 } } },
  { "ensemble", function(o) return verlet:ensemble(o) end, { members = 3,
    q = function(i) return { i, 0 } end, v = function() return { 0, 1 } end, steps = 5, threads = 2,
    watch = { r = function(q) return q:norm() end } } },
  { "ensemble of gauss", function(o) return gauss:ensemble(o) end,
    { members = 2, q = { { 1 }, { 2 } }, v = { { 0 }, { 1 } }, steps = 3, every = 1 } },
  { "lyapunov", function(o) return verlet:lyapunov(o) end, with(at, { exponents = 2, every = 1 }) },
  { "all exponents", function(o) return gauss:lyapunov(o) end,
    { q = { 1 }, v = { 0 }, steps = 4, exponents = 2 } },
  { "one exponent", function(o) return gauss:lyapunov(o) end,
    { q = { 1 }, v = { 0 }, steps = 4, u = { 1 }, dp = { 0 } } },
  { "tangent", function(o) return gauss:tangent(o) end, { q = { 1 }, v = { 0 }, steps = 3 } },
  { "step_tangent", function(o) return curved:step_tangent(o) end, { q = { 1 }, v = { 0 } } },
  { "symplecticity", function(o) return verlet:symplecticity(o) end, at },
  { "reversal", function(o) return verlet:reversal(o) end, at },
  { "multipliers", function(o) return gauss:multipliers(o) end,
    { q = { 1 }, v = { 0 }, steps = 3 } },
  { "fold", function(o) return gauss:fold(o) end, { q = { 1 }, v = { 0 }, up_to = 1 } },
  { "measured_order", function(o) return verlet:measured_order(o) end,
    { q = { 1, 0 }, v = { 0, 1 }, t = 0.5 } },
  { "modified_energy", function(o) return verlet:modified_energy(o) end,
    { q = { 1, 0 }, v = { 0, 1 }, steps = 20, points = 4 } },
  { "backward_error", function(o) return verlet:backward_error(o) end,
    { q = { 1, 0 }, v = { 0, 1 }, steps = 20 } },
  { "singularities", function(o) return verlet:singularities(o) end, at },
  { "section", function(o) return verlet:section(o) end, { q = { 1, 0 }, v = { 0, 1.1 }, t = 3,
    g = function(q) return q[2] end, x = "q1", y = "p1", direction = "up" } },
  { "linearize", function(o) return line:linearize(o) end, { q = { 0 }, v = { 0 } } },
  { "chart", dm.chart, { line, q = { 1 }, v = { 0 }, t = 0.4, rules = { "verlet" }, h = { 0.2, 0.1 },
    repeats = 1, reference = { rule = "gauss(3)", h = 0.05 } } },
  { "stability", dm.stability, { system = line, rule = "verlet", q = { 1 }, v = { 0 }, steps = 10,
    h = { 0.1, 3, 3, "log" }, refine = false } },
  { "stability of a family", dm.stability, { system = function(k)
      return dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - k * q[1] ^ 2 end }
    end, rule = "verlet", q = { 1 }, v = { 0 }, steps = 5, h = { 0.1, 1 }, k = { 1, 2 },
    refine = false } },
  { "scene", function(o) return dm.scene(o):run() end, { line, q = { 1 }, v = { 0 },
    watch = { "q1" }, tolerance = 0.1, until_t = 0.5, seconds = 0.1, rules = { "verlet" } } },
  { "scaling", dm.scaling, { system = line, start = function() return { 1 }, { 0 } end,
    members = { 1, 2 }, rules = { "verlet" }, h = 0.1, steps = 2, repeats = 1 } },
  { "sequence", dm.sequence, { equation = function(y, x) return { x[1] ^ 3 + x[1] - y[1] } end,
    next = function(_, x) return { x[1] + 1 } end, start = function(y) return { y[1] } end,
    y = { 1 }, unknowns = 1, steps = 4 } },
  { "stationary", dm.stationary, { term = function(w) return (w[2] - w[1]) ^ 2 + w[1] ^ 2 end,
    sites = 5, block = 1, window = 2, x = { 0, 1, 2, 1, 0 }, given = { true, false, false, false, true } } },
  { "path", dm.path, { system = line, h = 0.1, rule = "verlet",
    columns = { { 0, 0.1, 0.2 }, { 1, 0.9, 0.8 }, { 0, 0.1, 0.2 } } } },
  { "bundle", function(o)
    local B = dm.bundle(o)
    return { B:pair({ 1 }, { 0 }), B:check { q = { 1 }, v = { 0 } }, B:momenta({ 1 }, { 0 }) }
  end, { system = line, h = 0.1, segments = "rk4", bias = 0.5 } },
  { "root", function(o) return dm.root(o)(1.5) end, { unknowns = 1, start = { 1 },
    equations = function(y, x) return y[1] ^ 3 - x end, name = "cubic" } },
}

local symmetries = {
  { "routh", function(o) return planet:routh(o):solver { rule = "gauss(2)", h = 0.1 } end,
    { cyclic = 1, mu = 1 } },
  { "routh by an action", function(o) return kepler:routh(o) end, { action = function(a, q)
      local c, s = math.cos(a), math.sin(a)
      return { c * q[1] - s * q[2], s * q[1] + c * q[2] }
    end, section = function(x) return { x[1], 0 } end, mu = 1, q = { 1, 0 }, v = { 0, 1 } } },
  { "reduced steps", function(o)
    local D = planet:routh({ cyclic = 1, mu = 1 }):discrete(o)
    return { D:step({ 1 }, { 1.01 }) }
  end, { rule = "gauss(2)", h = 0.1 } },
  { "commute", function(o) return dm.commute(planet, o) end,
    { q = { 0, 1 }, v = { 1, 0 }, h = 0.1, rule = "gauss(2)", steps = 4, cyclic = 1 } },
  { "action", dm.action, { group = dm.R(1), on = dm.R(2),
    map = function(g, z) return { z[1] + g[1], z[2] } end, side = "left",
    domain = function() return 1 end } },
  { "moving_frame", dm.moving_frame, { action = turn, cross_section = function(z) return z[2] end,
    branch = function(z) return z[1] end,
    solution = function(z) return -dm.atan(z[2], z[1]) end } },
  { "a solved frame", function(o) return dm.moving_frame(o) { 1, 2 } end, { action = turn,
    cross_section = function(z) return z[2] end, branch = function(z) return z[1] end } },
}

local meshes = {
  { "mesh of points", dm.mesh, { simplices = { { 1, 2, 3 }, { 2, 4, 3 } },
    points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1.2 } } } },
  { "mesh of lengths", dm.mesh, { simplices = { { 1, 2, 3 }, { 2, 4, 3 } },
    lengths = function(i, j) return 1 + (i + j) / 20 end, dual = "barycentric" } },
  { "mesh of cells", function(o) return dm.mesh(o):betti() end,
    { simplices = { { 1, 2, 3 }, { 2, 3, 4 }, { 5, 6 }, { 7 } } } },
  { "delaunay", dm.mesh, { points = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1.1, 1.2 }, { 0.4, 0.3 } } } },
  { "delaunay of space", dm.mesh, { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 },
    { 1, 1, 1 } } } },
  { "moved grid", dm.mesh, { grid = 2, map = function(x, y) return { x + y / 4, y, x * y } end } },
  { "annulus", dm.mesh, { annulus = { 1, 4 }, ratio = 1.5 } },
  { "torus", dm.mesh, { torus = { 4, 4 }, radii = { 3, 1 } } },
  { "generators", dm.mesh, { shells = { 2, 1 } } },
  { "named", dm.mesh, { named = "csaszar7" } },
  { "poisson", function(o) return square:poisson(o) end, { f = function(x, y) return x + y end,
    fixed = { boundary = 0 }, solver = "cholesky" } },
  { "poisson with flux", function(o) return square:poisson(o) end,
    { f = function() return 0 end, fixed = { [1] = 1 }, flux = function(x) return x - 0.5 end } },
  { "darcy", function(o) return square:darcy(o) end, { permeability = function(x) return 1 + x end,
    source = function() return 1 end, pressure = function(x, y) return x - y end } },
  { "darcy of flux", function(o) return solid:darcy(o) end, { permeability = 2,
    flux = function() return 0 end } },
  { "form", function(o) return square:form(o[1], o[2], o[3]):d():star() end,
    { 1, function(x, y) return { y, x } end, { order = 2 } } },
  { "dual form", function(o) return square:form(o[1], o[2], o[3])  :star { pinv = true } end,
    { 1, function(x, y) return { y, x } end, { dual = true } } },
  { "vector_field", function(o) return square:vector_field(o[1], o[2]):flat(o[3]) end,
    { function(x, y) return { x, y } end, { on = "cells" }, { to = "dual" } } },
  { "sharp", function(o) return square:form(1, function() return { 1, 2 } end):sharp(o) end,
    { to = "vertices", rule = "thesis" } },
  { "contract", function(o)
    return square:form(2, square:volume(2)):contract(square:vector_field(o[1]), o[2])
  end, { function(x, y) return { x, y } end, { method = "extrusion", side = "central" } } },
  { "eigen", function(o) return square:laplacian(o[1], o[2]):eigen(o[3], o[4]) end,
    { 0, { fixed = "boundary" }, 1, {} } },
  { "cone", function(o) return dm.mesh(o[1]):cone(o[2]):check() end,
    { { shells = { 2, 1 } }, { rule = "star", hub = 1 } } },
  { "homology", function(o) return dm.mesh(o[1]):homology(o[2], o[3]) end,
    { { annulus = { 1, 4 }, ratio = 1.5 }, 1, { relative = "boundary" } } },
  { "potential", function(o)
    local K = dm.mesh(o[1])
    return K:potential(K:form(o[2], o[3]):d())
  end, { { grid = 2 }, 0, function(x, y) return x * y end } },
  { "hodge", function(o)
    local K = dm.mesh(o[1])
    return K:form(1, o[2]):hodge(o[3])
  end, { { annulus = { 1, 5 }, ratio = 1.5 }, function(x, y) return { -y, x } end, {} } },
  { "augment", function(o) return dm.mesh({ grid = 1 }):cone({}):augment(o) end,
    { vertex = 5, at = 1, ring = { 2, 3 }, closed = false } },
  { "simplicial_map", function(o) return dm.simplicial_map(square, square, o):homology(1) end,
    { 1, 2, 3, 4, 5, 6, 7, 8, 9 } },
  { "save", function(o) return square:save(o[1], o[2]) end,
    { "f.vtk", { forms = { a = square:form(0, square:volume(0)) } } } },
  { "plot of a mesh", function(o) return square:plot(o) end, { azimuth = 20, height = 30 } },
  { "page of a mesh", function(o) return square:animate(o[1], o[2]) end,
    { "f.html", { forms = { a = square:form(0, square:volume(0)) }, title = "x" } } },
  { "exact", function(o) return dm.exact(o[1], o[2], o[3]) end,
    { { { 2 }, { 0 } }, { { 0, 1 } }, { over = "Z" } } },
  { "five_lemma", dm.five_lemma, { top = { { { 2 } }, { { 1 } } }, bottom = { { { 2 } }, { { 1 } } },
    maps = { { { 1 } }, { { 1 } }, { { 1 } } }, over = 2 } },
  { "smith", dm.smith, { { 2, 4 }, { 6, 8 }, { 0, 3 } } },
  { "embeddable", dm.embeddable, { { 0, 1, 1 }, { 1, 0, 1 }, { 1, 1, 0 } } },
}

-- a wave, a solver and a run in one table
local function waved(o)
  local wave = dm.schroedinger(o.wave)
  local path = wave:solver(o.solver):run(o.run)
  wave:current(path.psi[1])
  return wave:resume(path):run { steps = 2 }
end
local function hill(x) return math.exp(-x * x) end
local ring = { x = { -4, 4, 16 }, V = hill, hbar = 1, m = 1, g = 0.5, space = "collocation",
  boundary = "periodic" }
local start = { psi = function(x) return hill(x), 0.1 * hill(x) end, steps = 3, every = 2, t0 = 1,
  seconds = 1 }
local waves = {
  { "a wave", waved, { wave = ring, solver = { rule = "strang", h = 0.1 }, run = start } },
  { "a wave by Gauss", waved, { wave = with(ring, { boundary = "walls" }),
    solver = { rule = "gauss(2)", h = 0.1 }, run = { psi = function(x) return 16 - x * x end,
      t = 0.3 } } },
  { "two-step", waved, { wave = { x = { -4, 4, 16 }, V = 1, space = "galerkin" },
    solver = { rule = "two-step", h = 0.01, norm = true, unstable = false }, run = start } },
  { "a slab", waved, { wave = { x = { -4, 4, 16 } }, solver = { rule = "slab", h = 0.1 },
    run = start } },
  { "spectrum", function(o) return dm.schroedinger(o[1]):eigen(o[2]) end, { with(ring, { g = 0 }), 3 } },
  { "space and time", function(o)
    return dm.schroedinger(ring):solver({ rule = "strang", h = 0.1 }):run(start):spacetime(o)
  end, { of = "phase", width = 20, height = 5, title = "x" } },
  { "a page of a wave", function(o)
    return dm.schroedinger(ring):solver({ rule = "strang", h = 0.1 }):run(start)
      :animate(o[1], o[2])
  end, { "f.html", { title = "x" } } },
  { "fft", function(o) return dm.fft(o[1], o[2]) end, { { 1, 2, 3 }, { 0, 1, 0 } } },
  { "msfem", function(o) return dm.msfem(o):value(0.3) end, { a = hill, f = hill, x = { 0, 0.4, 1 },
    period = 0.5, shape = "multiscale", antiderivative = nil } },
}

--- All rows.
function M.rows()
  local out = {}
  for _, rows in ipairs { systems, measures, symmetries, meshes, waves } do
    for _, row in ipairs(rows) do out[#out + 1] = row end
  end
  return out
end

return M
