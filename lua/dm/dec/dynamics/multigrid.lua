--- dm.multigrid: V-cycles on nested meshes (Leok 3.14). A function goes to a finer mesh by the
-- Whitney transfer P, a load back by its transpose, and the matrix of a coarser level is P^T A P.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local held = require "dm.dec.equations.held"
local mass = require "dm.dec.equations.mass"
local matrices = require "dm.dec.equations.matrices"
local nesting = require "dm.dec.dynamics.nesting"
local option = require "dm.base.options"
local poisson = require "dm.dec.equations.poisson"
local solver = require "dm.dec.equations.solver"

local M = {}

local Multigrid = core.class({ __name = "dm.multigrid" }, [[
dm.multigrid: nested meshes and what leads from one to the next, made by dm.multigrid{K1, ..., Kn}
fields: meshes (the coarsest first), fixed; #mg levels]])

local WHERE = "dm.multigrid"
local fail = option.failing(WHERE)

-- of Jacobi's sweeps: it takes from rough errors what a coarser mesh cannot see
local DAMPING = 2 / 3

---- levels ----

local function check_meshes(options)
  if #options < 2 then fail("at least two meshes are needed, the coarsest first") end
  for i, K in ipairs(options) do
    if option.got(K) ~= "dm.mesh" then fail("mesh %d is none (got %s)", i, option.got(K)) end
    if not K.ambient then fail("mesh %d has no points: make it with points =", i) end
    local first = options[1]
    if K.dimension ~= first.dimension or K.ambient ~= first.ambient then
      fail("mesh %d is of another dimension than the first", i)
    end
  end
end

-- 1 / diagonal where a level is solved for, times the damping
local function smoother(A, solved, level)
  local diagonal = A:diagonal()
  return matrices.diagonal(diagonal:map(function(x, i)
    if solved[i] == 0 then return 0 end
    if not (x > 0) then
      fail("the matrix of mesh %d has %g at vertex %d of its diagonal, so Jacobi's sweeps do not "
        .. "smooth: negative stars do that, and K:make_delaunay() mends them", level, x, i)
    end
    return DAMPING / x
  end))
end

-- Boundary vertices are held on all levels; a vertex of a closed component only where the coarsest
-- one is solved.
local function make_levels(meshes, P, is_free)
  local count, levels = #meshes, {}
  local A = poisson.stiffness(meshes[count])
  for l = count, 1, -1 do
    local K = meshes[l]
    local solved, component, closed = held.of(K, is_free)
    local open = mass.ones(K, 0)
    if not is_free then open = open - K:boundary_marks(0) end
    levels[l] = { mesh = K, A = A, solved = solved, component = component, closed = closed,
      open = open, smooth = smoother(A, open, l), P = P[l], R = P[l] and P[l]:transpose() }
    if l > 1 then A = P[l - 1]:transpose() * (A * P[l - 1]) end
  end
  local coarse = levels[1]
  local S = coarse.A:pick(coarse.solved, coarse.solved)
  coarse.solver = S.rows > 0 and solver.new(S, nil, WHERE) or nil
  return levels
end

M.multigrid = blame.caller(function(options)
  option.check(options, { "fixed", entries = true }, WHERE, "of meshes, the coarsest first")
  check_meshes(options)
  local fixed = option.one_of(options, "fixed", WHERE, { "boundary", "nothing" }, "boundary")
  local meshes, P = {}, {}
  for l, K in ipairs(options) do
    meshes[l] = K
    if l > 1 then P[l - 1] = nesting.prolongation(meshes[l - 1], K, l) end
  end
  return setmetatable({ meshes = meshes, P = P, fixed = fixed,
    levels = make_levels(meshes, P, fixed == "nothing") }, Multigrid)
end)

core.docs[M.multigrid] = [[
dm.multigrid{coarsest, ..., finest, fixed = "boundary" | "nothing"} -> dm.multigrid
Nested meshes: every cell of one is a union of cells of the next; or each next one has the midpoints
of the edges as further vertices, as dm.mesh{icosphere = s} has, on a curved surface.
mg:prolong(a), mg:restrict(b), mg:solve(b). fixed: solutions are 0 on the boundary, or free there.
Raises where the meshes are not nested, with the cell.]]

function Multigrid.__len(mg) return #mg.meshes end

function Multigrid.__tostring(mg)
  local counts = {}
  for l, K in ipairs(mg.meshes) do counts[l] = tostring(K:count(0)) end
  return "multigrid of " .. table.concat(counts, ", ") .. " vertices"
end

---- from level to level ----

-- the level of a function, which is to be `least` .. `most`
local function level_of(mg, a, least, most, where)
  if not form.is_form(a) or a.side ~= "primal" or a.degree ~= 0 then
    option.fail(where, "a primal 0-form is needed (got %s)",
      form.is_form(a) and "a " .. form.name(a) or option.got(a))
  end
  for l = least, most do
    if rawequal(mg.meshes[l], a.mesh) then return l end
  end
  option.fail(where, "the form is of none of the meshes that have a %s one",
    least == 1 and "finer" or "coarser")
end

class.method("dm.multigrid", "prolong", function(mg, a)
  local l = level_of(mg, a, 1, #mg - 1, "multigrid:prolong")
  return form.new(mg.meshes[l + 1], 0, "primal", mg.P[l] * a.values)
end, [[
mg:prolong(a) -> dm.form
A function of one mesh on the next finer one: P a, exact where a is linear on each cell.]])

class.method("dm.multigrid", "restrict", function(mg, b)
  local l = level_of(mg, b, 2, #mg, "multigrid:restrict")
  return form.new(mg.meshes[l - 1], 0, "primal", mg.P[l - 1]:transpose() * b.values)
end, [[
mg:restrict(b) -> dm.form
A load of one mesh (a number for each vertex, such as A u) on the next coarser one: P^T b.]])

class.method("dm.multigrid", "matrix", function(mg, level)
  if math.type(level) ~= "integer" or level < 1 or level > #mg then
    option.fail("multigrid:matrix", "levels are numbered from 1 to %d (got %s)", #mg,
      option.got(level))
  end
  return mg.levels[level].A
end, [[
mg:matrix(level) -> dm.sparse
The matrix of a level, 1 the coarsest: d^T M_1 d of the finest mesh, P^T A P below.]])

---- V-cycles ----

local function smoothed(level, u, b, sweeps)
  for _ = 1, sweeps do u = u + level.smooth * (b - level.A * u) end
  return u
end

local function solved_coarsest(level, b)
  if not level.solver then return 0 * b end
  return core.spread(level.solver:solve(core.pick(b, level.solved)), level.solved)
end

-- one cycle for A u = b on level l, from u
local function cycle(levels, l, u, b, sweeps)
  local level = levels[l]
  if l == 1 then return solved_coarsest(level, b) end
  local below = levels[l - 1]
  u = smoothed(level, u, b, sweeps)
  local rest = below.R * (b - level.A * u)
  local keep = matrices.diagonal(below.open)
  u = u + below.P * cycle(levels, l - 1, 0 * rest, keep * rest, sweeps)
  return smoothed(level, matrices.diagonal(level.open) * u, b, sweeps)
end

-- the load of what a script gives
local function load_of(mg, b, where)
  local K = mg.meshes[#mg]
  if form.is_form(b) then
    if not rawequal(b.mesh, K) then option.fail(where, "the form is not of the finest mesh") end
    if b.side == "primal" and b.degree == 0 then return K:star_values(0, b.values, "dual") end
    if b.side == "dual" and b.degree == K.dimension then return b.values end
    option.fail(where, "a 0-form (a density) or a dual %d-form (its integrals) is needed, not a %s",
      K.dimension, form.name(b))
  end
  local fine, values = blame.try(core.vector, b)
  if not fine or #values ~= K:count(0) then
    option.fail(where, "the right-hand side must be a form, or %d numbers (got %s)", K:count(0),
      fine and #values or option.got(b))
  end
  for i = 1, #values do
    if values[i] - values[i] ~= 0 then
      option.fail(where, "the right-hand side is %s at vertex %d",
        values[i] == values[i] and "infinite" or "NaN", i)
    end
  end
  return values
end

local function start_of(mg, x, where)
  local K = mg.meshes[#mg]
  if x == nil then return core.vector(K:count(0)) end
  level_of(mg, x, #mg, #mg, where)
  return x.values
end

-- cycles until the residual is small, or no longer falls
local function iterate(mg, u, b, options, report)
  local levels, top, where = mg.levels, mg.levels[#mg], "multigrid:solve"
  local most = option.whole(options, "cycles", where, 1, nil, 100)
  local sweeps = option.whole(options, "sweeps", where, 1, nil, 2)
  local tolerance = option.positive(options, "tolerance", where, "a tolerance", 1e-12)
  local keep = matrices.diagonal(top.open)
  local size, residual = (keep * b):norm(), (keep * (b - top.A * u)):norm()
  report.residuals = { residual }
  while residual > tolerance * size and report.cycles < most do
    u = cycle(levels, #mg, u, b, sweeps)
    local now = (keep * (b - top.A * u)):norm()
    report.cycles = report.cycles + 1
    report.residuals[report.cycles + 1] = now
    local stalls = now > 0.9 * residual
    residual = now
    if stalls then break end
  end
  return u, residual, residual <= tolerance * size, most
end

local function text_of(report, is_done, most)
  if is_done then return ("%d V-cycles"):format(report.cycles) end
  if report.cycles == most then return ("not there after %d V-cycles"):format(most) end
  return ("the residual no longer falls after %d V-cycles"):format(report.cycles)
end

class.method("dm.multigrid", "solve", function(mg, b, options)
  local where = "multigrid:solve"
  options = option.check(options or {}, { "cycles", "sweeps", "tolerance", "start" }, where)
  local top, K = mg.levels[#mg], mg.meshes[#mg]
  local weights = mass.of(K, 0).values
  local density = load_of(mg, b, where)
  density = held.balanced(density, top.component, top.closed, weights)
  local report = core.result { cycles = 0 }
  local u = matrices.diagonal(top.open) * start_of(mg, options.start, where)
  local residual, is_done, most
  u, residual, is_done, most = iterate(mg, u, density, options, report)
  local last, first = report.residuals[#report.residuals], report.residuals[1]
  report.residual = residual
  report.factor = report.cycles > 0 and (last / first) ^ (1 / report.cycles) or nil
  report.code = is_done and "ok" or "no_convergence"
  report.text = text_of(report, is_done, most)
  return K:form(0, held.without_means(u, top.component, top.closed, weights)), report
end, [[
mg:solve(b, {cycles = 100, sweeps = 2, tolerance = 1e-12, start=}) -> dm.form, report
u with d^T M_1 d u = b on the finest mesh, by V-cycles of damped Jacobi sweeps (2/3, so many before
and behind). b: a 0-form, a density f as in K:poisson; a dual form of the highest degree, its
integrals; or numbers for the vertices. u is 0 on the boundary (see fixed); where nothing is held
the mean of b goes and u has mean 0. tolerance: of the residual, beside b. report: cycles, factor
(by which a cycle makes the residual less, in the mean), residual, residuals, code, text.]])

return M
