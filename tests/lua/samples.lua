--- One value of every class, with arguments that its methods take.
local dm = require "dm"

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local ball = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, force = function(q, v) return -v end,
  constraint = function(q) return q:dot(q) - 1 end }
local disk = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 end, rolling = function(q, v) return v[1] end,
  control = function(q) return -q end, force = function(_, _, _, u) return u end }
local polar = dm.system { Q = dm.R(2), coordinates = { "r", "theta" }, L = function(q, v) return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 - q[1] ^ 2 end }
local shape = polar:routh { cyclic = { "theta" }, mu = 1 }
local discrete = shape:discrete { rule = "midpoint", h = 0.1 }
local solver = kepler:solver { rule = "gauss(2)", h = 0.05 }
local path = solver:run { q = { 1, 0 }, v = { 0, 1 }, steps = 20 }
local swung = ball:solver({ rule = "rattle", h = 0.02 }):run { q = { 0.6, 0, -0.8 }, v = { 0, 1, 0 }, steps = 5 }
local Ld = dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.1 })
local staged = dm.discrete_lagrangian(kepler, { rule = dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 } }, h = 0.1 })
local turn = dm.action { group = dm.SO(2), on = dm.R(2) }
local rho = dm.moving_frame { action = dm.action { group = dm.SE(2), on = dm.R(2) }, points = 2,
  cross_section = function(a, b) return { a[1], a[2], b[2] } end, branch = function(_, b) return b[1] end }
local members = solver:ensemble { members = 3, q = function(i) return { i, 0 } end, v = function() return { 0, 1 } end, steps = 10, every = 5, watch = { "energy" } }
local f = dm.trace(function(x) return x[1] * x[2] end, 2)
local root = dm.root { start = 1, equations = function(y, x) return y ^ 3 + x[1] * y - 1 end }
local least = dm.root { start = 1, stationary = function(y, x) return y ^ 2 + x[1] * y end }
local equilibrium = shape:relative_equilibria { region = { 0.5, 2 }, starts = 5 }[1]
local branch = shape:continue(equilibrium, { mu = { 0.8, 1.2 } })
local map = dm.stability { system = kepler, rule = "verlet", q = { 1, 0 }, v = { 0, 1 }, h = { 0.1, 0.2, 2, "linear" }, steps = 10 }
local chart = kepler:chart { q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, h = { 0.1, 0.05 } }
local G, g, xi, M = dm.SO(3), dm.SO(3):exp { 0.1, 0.2, 0.3 }, { 0.1, 0.2, 0.3 }, dm.matrix { { 2, 1 }, { 1, 3 } }
local a, b, x, y = { 1, 0 }, { 1, 0.1 }, { 1 }, { 1.01 }
local reduced = shape:solver({ rule = "gauss(2)", h = 0.1 }):run { q = x, v = { 0.1 }, steps = 20 }
local triangle = dm.mesh { simplices = { { 1, 2, 3 } }, lengths = 1 }
local operator = triangle:laplacian(0)
local ends = dm.mesh { simplices = { { 1, 2 } }, points = { { 0 }, { 1 } } }
local asynchronous = require "dm.core".avi(ends:field { form = 0, L = function(u, v)
  return v:dot(v) / 2 - ends:sum(1, function(e) return (e[2] - e[1]) ^ 2 end, u)
end }, dm.vector { 0, 0.1 }, 0)
asynchronous:limits()
local nought_of_ends, one_of_ends = dm.vector { 0, 0 }, dm.vector { 1 }
asynchronous:run({ p = nought_of_ends }, one_of_ends, one_of_ends * 0) -- whose steps resonances are about
local plate, levels = dm.mesh { triangle = 2 }, dm.multigrid { dm.mesh { triangle = 1 }, dm.mesh { triangle = 2 } }
local flow = dm.mesh { icosphere = 0 }:euler { vorticity = function(_, _, z) return z end }:solver { h = 0.1 }:run { steps = 3 }
local K0 = flow.mesh
local engine = require "dm.core".euler(K0, K0:incidence(0):gram(K0:volume(1)):pick({ 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 }, { 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 }):factor "dense",
  { 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 }, { 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 }, K0:volume(2), flow.w[1])
local moving = dm.diffeo(plate, function(t) return plate:points() * (1 + t) end)
local halfway = moving(0.5)
local random, bundle = dm.random(1), dm.bundle { system = kepler, h = 0.1 }
local chords = dm.invariant_problem { frame = rho, invariants = { lambda = { 2, 1 }, sigma = { 3, 2 } },
  L = function(I) return I.sigma ^ 2 / I.lambda ^ 3 + I.lambda end }
local curves = dm.differential_invariants { action = dm.action { group = dm.SE(2), on = dm.R(2) }, independent = 1,
  invariants = { kappa = 4 }, cross_section = function(z) return { z[1], z[2], z[3] } end }
local function bending(I) return I.kappa[1] ^ 2 / 2 end
local spinning = dm.lagrange_poincare { group = dm.SO(3), h = 0.1, l = function(w, h) return dm.SO(3):cayleyinv(w):dot(dm.SO(3):cayleyinv(w)) / h end }
local spun = spinning:solver():run { mu = { 0.1, 0.2, 1 }, steps = 3 }
local level = dm.system { Q = dm.product(dm.R(1), dm.SO(3)), L = function(_, v) return v:dot(v) / 2 end }:level { group = dm.SO(3), mu = { 0, 0, 1 } }
local scaling = dm.scaling { rules = { "verlet" }, n = { 1, 2 }, h = 0.1, steps = 10, repeats = 1,
  system = function(n) return dm.system { Q = dm.R(n), L = function(q, v) return (v:dot(v) - q:dot(q)) / 2 end } end,
  start = function(n) return dm.zeros(n), dm.zeros(n) end }
local core = require "dm.core"
local parabola = core.section(core.trace(function(z) return { 1 + z[2] - z[1] ^ 2 } end, 2),
  core.trace(function(angle, z) return { z[1] - angle[1] * z[2], z[2] + angle[1] * z[1] } end, 1, 2), nil)
local rows = solver:section { g = function(q) return q[2] end, starts = { { q = { 1, 0 }, v = { 0, 1.1 } } }, t = 40, x = "q1", y = "p1" }

local wave = dm.schroedinger { x = { 0, 1, 8 } }
local waves = wave:solver { rule = "strang", h = 0.1 }
local waved = waves:run { psi = math.sin, steps = 4 }
local rod = dm.msfem { a = math.exp, f = math.sin, x = { 0, 0.5, 1 } }
local upright = dm.SO(3):identity()
local rotor = dm.discrete_lagrangian { Q = dm.SO(3), h = 0.1,
  Ld = function(q0, q1) return -(q0:transpose() * q1)[1][1] - 2 * (q0:transpose() * q1)[2][2] end }

local turning = dm.connection { group = dm.SO(2), base = dm.R(2), local_form = function(x0, x1) return (x0[1] + x1[1]) * (x1[2] - x0[2]) end }
local at_a, at_b = { a, 0.3 }, { b, 0.4 }

-- fields on lines
local cable = dm.field { x = { 0, 1, 4 }, absorbing = 1, L = function(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end }
local cable_solver = cable:solver { h = 0.1 }
local cable_run = cable_solver:run { u = 0, ut = 1, steps = 4 }
local cable_strip = cable_run.level.strip
local five, nought = dm.vector { 1, 2, 3, 4, 5 }, dm.zeros(5)
local boxes = dm.multisymplectic { names = { "u", "p", "q" }, M = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } }, K = { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } },
  S = function(z) return z[2] ^ 2 / 2 - z[3] ^ 2 / 2 + 2 * z[1] ^ 2 end, x = { 0, 6, 5, periodic = true } }
local box_solver = boxes:solver { h = 0.1 }
local strings = dm.chart { system = function(n) return dm.field { x = { 0, 1, n }, fixed = "ends", L = function(_, ut, ux) return (ut ^ 2 - ux ^ 2) / 2 end } end,
  n = { 4, 8 }, t = 0.5, h = 0.1, u = math.sin, exact = function(x) return math.sin(x) end }
local box_run = box_solver:run { z = { u = math.sin, p = math.cos }, steps = 4 }

-- class -> method -> a list of calls that are right: { object, arguments }
return {
  ["dm.vector"] = { { dm.vector { 1, 2, 3 }, cross = { xi }, dot = { xi }, map = { math.sin }, outer = { xi }, slice = { 1, 2 } } },
  ["dm.matrix"] = { { M, column = { 1 }, row = { 1 }, solve = { a } } },
  ["dm.function"] = { { f, emit_c = { "f" }, gradient = { a }, hessian = { a }, jacobian = { a } } },
  ["dm.root"] = { { root, inverse = { { 1 } } }, { least, value = { { 1 } } } },
  ["dm.random"] = { { random, normal = { 1, 1, 0, 1 }, uniform = { 1, 1, 0, 1 } } },
  ["dm.system"] = {
    { kepler, energy = { a, b, 0 }, lagrangian = { a, b, 0 }, legendre = { a, b, 0 }, mass = { a, b, 0 }, momentum = { a, b, 0 }, velocity = { a, b, 0 } },
    { ball, constraint = { xi, 0 }, force = { xi, xi, 0 }, multipliers = { { 0.6, 0, -0.8 }, { 0, 1, 0 }, 0 }, acceleration = { { 0.6, 0, -0.8 }, { 0, 1, 0 }, 0 } }, { disk, rolling = { a, b, 0 }, control = { a, b, 0 } },
    { shape, amended_potential = { x, 0 }, at_momentum = { 1 }, connection = { x, 0 }, continue = { equilibrium, { mu = { 0.9, 1.1 } } },
      curvature = { x, 0 }, lift = { x, x, 0, 0 }, locked_inertia = { x, 0 }, magnetic_momentum = { x, x, 0 }, routhian = { x, x, 0 },
      slice = { "connection", { from = x, to = { 2 }, points = 5 } }, discrete = { { rule = "midpoint", h = 0.1 } }, start = { { 1, 0 }, { 0, 1 }, 0 }, symplectic_form = { x, 0 }, holonomy = { function(s) return { 1 + 0.1 * math.cos(2 * math.pi * s) } end } } },
  ["dm.discrete_shape"] = { { discrete, connection = { a, b }, legendre_minus = { x, y }, legendre_plus = { x, y }, one_form = { x, y }, psi = { x, y, { 0 } },
    residual = { x, y, x }, routhian = { x, y }, step = { x, y }, two_form = { x, y }, value = { x, y } } },
  ["dm.connection"] = { { turning, compose = { { at_a, at_b }, { at_b, at_a } }, continuous = { a }, curvature = { a, 1, 2 }, formation = { { at_a, at_b } },
    holonomy = { { a, b, a }, at_a }, hor = { at_a, at_b }, horizontal_splitting = { a, b }, join = { turning:split { at_a, at_b } }, lift = { a, b, at_a },
    local_form = { a, b }, multi_lift = { { a, b }, at_a }, one_form = { at_a, at_b }, relative = { at_a, at_b }, representative = { { at_a, at_b }, { a, 1 } },
    split = { { at_a, at_b } }, splitting = { at_a, at_b }, variation = { at_a, at_b, { a, { 1 } } }, ver = { at_a, at_b } } },
  ["dm.levi_civita"] = { { dm.mesh { icosphere = 0 }:levi_civita(), holonomy = { { 1, 1 } }, transport = { { 1 }, a }, frame = { 1 } } },
  ["dm.bundle_class"] = { { turning:splitting(at_a, at_b), at = { { a, 1 } } } },
  ["dm.discrete_lagrangian"] = { { Ld, legendre_minus = { a, b }, legendre_plus = { a, b }, momentum = { dm.SO(2), a, b },
    two_form = { a, b }, value = { a, b, 0 } }, { staged, hamilton_pontryagin = { a, b, 0 } }, { staged, momentum = { turn, a, b } } },
  ["dm.form"] = { { triangle:form(1, { 1, 2, 3 }), at = { { 1, 2 } }, pair = { triangle:chain(1, {}) } } },
  ["dm.mesh"] = { { triangle, count = { 1 }, simplices = { 1 }, volume = { 1 }, dual_volume = { 1 }, faces = { 1, 1 },
    cofaces = { 1, 1 }, frame_places = { 1 }, find = { { 1, 2 } }, coboundary = { 0, { 1, 2, 3 } }, boundary_sum = { 1, { 1, 2, 3 } },
    star_values = { 0, { 1, 2, 3 }, "dual" }, wedge_values = { 0, { 1, 2, 3 }, 1, { 1, 2, 3 }, "natural" } } },
  ["dm.matching"] = { { require "dm.core".matching(triangle), critical = { 0 }, core = { 0 }, flow = { 1, { 1 } },
    cocone = { 0, { 1, 2, 3 }, { 1 } }, gather = { 0, { 1, 2, 3 } } } },
  ["dm.simplicial_map"] = { { dm.simplicial_map(triangle, triangle, { 2, 3, 1 }), push = { triangle:chain(1, {}) },
    pull = { triangle:form(1, { 1, 2, 3 }) }, homology = { 0 } } },
  ["dm.cone"] = { { triangle:cone(), project = { triangle:chain(1, {}) }, cocone = { triangle:form(1, { 1, 2, 3 }) },
    carry = { dm.simplicial_map(triangle, triangle, { 2, 3, 1 }) } } },
  ["dm.multigrid"] = { { levels, prolong = { levels.meshes[1]:form(0, { 1, 2, 3 }) }, restrict = { levels.meshes[2]:form(0, { 1, 2, 3, 4, 5, 6 }) },
    matrix = { 1 }, solve = { { 1, 2, 3, 4, 5, 6 } } } },
  ["dm.remesh"] = { { dm.remesh(plate, plate), matrix = { 0 } } },
  ["dm.flow"] = { { flow, form = { 1 }, stream = { 1 }, column = { "energy" }, drift = { "energy" } } },
  ["dm.euler_engine"] = { { engine, advance = { 0.1, 1 } } },
  ["dm.diffeo"] = { { halfway, compose = { halfway:inverse() }, pull = { halfway.to:form(0, { 1, 2, 3, 4, 5, 6 }) },
    push = { plate:form(0, { 1, 2, 3, 4, 5, 6 }) }, dual = { 1 } }, { moving, material_velocity = { 0 }, spatial_velocity = { 0 }, dual_velocity = { 0, 1 } } },
  ["dm.pair"] = { { dm.pair(1, 2), join = { dm.pair(2, 3) } } },
  ["dm.cell_action"] = { { require "dm.dec.fields.action".new(plate, 0, 1, function(u) return u:dot(u) end).traced, value = { { 1, 2, 3, 4, 5, 6 } },
    gradient = { { 1, 2, 3, 4, 5, 6 } }, hessian = { { 1, 2, 3, 4, 5, 6 } } } },
  ["dm.avi_cells"] = { { asynchronous, resonances = { 0.05 }, run = { { p = nought_of_ends }, one_of_ends, one_of_ends * 0 } } },
  ["dm.operator"] = { { operator, eigen = { 1 } } },
  ["dm.sparse"] = { { operator.stiffness, gram = { { 1, 1, 1 } }, scale = { { 1, 1, 1 }, { 1, 1, 1 } }, pick = { { 1, 0, 1 }, { 1, 1, 0 } },
    saddle = { { 1, 1, 1 } }, factor = { "gradients" }, all_eigenpairs = { { 1, 1, 1 } } } },
  ["dm.factor"] = { { operator.stiffness:factor "gradients", solve = { { 1, -1, 0 } } } },
  ["dm.bundle"] = { { bundle, action = { a, b, 0 }, minus = { a, b, 0 }, momenta = { a, b, 0 }, pair = { a, b, 0 }, plus = { a, b, 0 },
    split = { a, b, a, b, 0 }, tangent_minus = { a, b, 0 }, tangent_plus = { a, b, 0 }, velocity = { a, b, 0 }, vertical_minus = { a, b, a, 0 },
    vertical_plus = { a, b, a, 0 } } },
  ["dm.path"] = { { path, column = { "q1" }, drift = { "energy" }, mass = { a, 0 }, momentum = { dm.SO(2), { block = 2 } },
    plot = { "q1", "q2", {} }, series = { "q1", "q2", "orbit" }, velocity = { 1 } }, { swung, worst = { "constraint" } }, { path, momentum = { turn } },
    { reduced, reconstruct = {} } },
  ["dm.ensemble"] = { { members, path = { 1 }, summary = { "energy" } } },
  ["dm.journal_file"] = { { assert(require "dm.core".journal_file(os.tmpname(), true)), read = { 0, 8 }, append = { "" }, truncate = { 0 } } },
  ["dm.wave_equation"] = { { wave:equation(), eigen = { 2 }, slope = { wave.x, wave.x }, observe = { wave.x, wave.x } } },
  ["dm.wave_stepper"] = { { waves.stepper, start = { wave.x, wave.x }, run = { 0, 0, 1, 1 } } },
  ["dm.schroedinger"] = { { wave, eigen = { 2 }, stability_limit = { "two-step" }, current = { math.sin }, observe = { math.sin }, resume = { waved } } },
  ["dm.wave_path"] = { { waved, column = { "x" }, drift = { "norm" } } },
  ["dm.complex_vector"] = { { waved.psi[1], dot = { waved.psi[2] }, times = { 0, 1 } } },
  ["dm.msfem_solution"] = { { rod, value = { 0.3 }, exact = { 0.3 }, shape = { 2, 0.3 }, plot = { {} } } },
  ["dm.worker"] = { { require "dm.core".worker(function(channel) while channel:receive() do end end), send = { "x" } } },
  ["dm.sweep"] = { { dm.sweep { members = 2, workers = 1, run = function(i) return i end }, plot = { "member", "value", {} } } },
  ["dm.group_lagrangian"] = { { rotor, legendre_minus = { upright, upright },
    legendre_plus = { upright, upright }, momentum = { dm.SO(3), upright, upright },
    two_form = { upright, upright }, value = { upright, upright } } },
  ["dm.line_field"] = { { cable, resume = { cable_run }, solver = { { h = 0.1 } }, stability_limit = { "cell(gauss(2))", {} }, reflection = { {} } } },
  ["dm.line_solver"] = { { cable_solver, run = { { u = 0, steps = 2 } } } },
  ["dm.line_run"] = { { cable_run, column = { "energy" }, drift = { "energy" }, multisymplectic = { {} }, conservation = { "t" } } },
  ["dm.strip"] = { { cable_strip, momenta = { five, five, 0, 0.1 }, cells = { five, five, 0, 0.1, "value" }, limit = { nought, 1 },
    energies = { { u = cable_run.u, t = cable_run.t } }, vary = { { u = cable_run.u, t = cable_run.t, v = five, dp = five } },
    residual = { { u = cable_run.u, t = cable_run.t, v = cable_run.u, w = cable_run.p, leave = nought, area = 1 } },
    run = { { u = five, p = five, h = 0.1, steps = 1 } } } },
  ["dm.boxes"] = { { boxes, solver = { { h = 0.1 } }, resume = { box_run } } },
  ["dm.box_solver"] = { { box_solver, run = { { z = { u = math.sin, p = math.cos }, steps = 1 } } } },
  ["dm.box_run"] = { { box_run, balance = { "energy" } } },
  ["dm.branch"] = { { branch, series = { "mu", "energy" } } },
  ["dm.solver"] = { { dm.solver { Ld }, step = { a, b } } },
  ["dm.scaling"] = { { scaling, exponent = { "verlet" } } },
  ["dm.invariant_problem"] = { { chords, momentum = { { { 0, 0 }, { 1, 0 }, { 2, 0.1 }, { 3, 0.3 } } } } },
  ["dm.calculus"] = { { curves, iota = { 6 }, euler_lagrange = { bending }, conservation_law = { bending }, invariants = { { 0, 0, 0, 1 } },
    extremal = { { L = bending, start = { kappa = { 1, 0 } }, length = 1, steps = 2 } } } },
  ["dm.formula"] = { { curves:iota(6), value = { { kappa = { 1, 0, 0 } } } } },
  ["dm.invariant_operator"] = { { (curves:operator()), coefficient = { 1, 1, 0 } } },
  ["dm.lagrange_poincare"] = { { spinning, residual = { { {}, {}, {} }, { dm.SO(3):exp { 0.1, 0, 0 }, dm.SO(3):exp { 0.1, 0, 0.1 } } } } },
  ["dm.reduced_solver"] = { { spinning:solver() } },
  ["dm.level"] = { { level, locked_inertia = { 1 }, connection = { 1 }, amended_potential = { 1, { 0, 0, 1 } }, routhian = { 1, 1, { 0, 0, 1 } },
    solver = { { rule = "lie(1)", h = 0.1 } } } },
  ["dm.reduced_path"] = { { spun } },
  ["dm.section"] = { { rows, plot = { {} } } },
  ["dm.level_set"] = { { parabola, node = { { 1, 1 }, 1 }, cut = { { 1, 3 } }, distance = { { 1, 3 }, { 2 } }, approach = { { 2, 0 }, { 7, 1 } },
    folds = { { { { 0.5, 0.9 }, 1 } }, 100, 1 } } },
  ["dm.field_chart"] = { { strings, order = { "cell(gauss(2))" } } },
  ["dm.chart"] = { { chart, cheapest = { 0.1 }, order = { "verlet" } } },
  ["dm.stability_map"] = { { map, at = { 1, 1 }, limit = { 1 }, theory = { 1 }, table = { 3 } } },
  ["dm.action"] = { { turn, act = { { 0.1 }, a }, free = { a }, generator = { a }, isotropy = { a }, momentum = { a, b }, on_points = { 2 }, jet = { 1 },
    transitive = { a }, invariant = { kepler } } },
  ["dm.frame"] = { { rho, correction = { a, b, a }, derivative_correction = { { a, b }, { a, b } }, invariants = { a, b }, tangent = { a, b },
    transversality = { a, b }, phantom = { 3 }, invariantize = { function(p, q) return (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 end }, syzygies = { { a, b, { 2, 1 } } } } },
  ["dm.space"] = { { G, Ad = { g, xi }, ad = { xi, xi }, cayley = { xi }, cayleyinv = { g }, coAd = { g, xi }, coad = { xi, xi }, compose = { g, g },
    dcay = { xi, xi }, dcayinv = { xi, xi }, dexp = { xi, xi }, dexpinv = { xi, xi }, distance = { g, g }, exp = { xi }, flat = { g }, hat = { xi },
    inverse = { g }, left = { g, g }, left_tangent = { g, g, g }, right_tangent = { g, g, g }, bonds = { { 1, 0, 0, 0 } }, unflat = { { 1, 0, 0, 0 } },
       log = { g }, matrix = { g }, project = { g }, random = { random, 1, 0.5 }, right = { g, g }, valid = { g },
    vee = { G:hat(xi) } } },
}
