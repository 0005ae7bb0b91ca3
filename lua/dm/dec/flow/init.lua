--- K:euler: the flow of an ideal fluid on a surface, by its vorticity. The step is C's
-- (src/field/flow/euler.h); here is what it needs of the mesh, and what a script sees.
local checkpoint = require "dm.data.checkpoint"
local class = require "dm.base.class"
local core = require "dm.core"
local handles = require "dm.dec.flow.handles"
local held = require "dm.dec.equations.held"
local holes = require "dm.dec.flow.holes"
local mass = require "dm.dec.equations.mass"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local outward = require "dm.dec.flow.outward"
local poisson = require "dm.dec.equations.poisson"
local run = require "dm.dec.flow.run"
local sample = require "dm.dec.equations.sample"
local solver = require "dm.dec.equations.solver"

local M = {}

local WHERE = "mesh:euler"
local fail = option.failing(WHERE)

local Euler = core.class({ __name = "dm.euler" }, [[
dm.euler: flow on a surface by its vorticity, made by K:euler
fields: mesh, vorticity (a 0-form, at the start), circulations (round the holes, a dm.vector),
around (b_k, round the handles), report (of the solver of the stream function; note: what is left
out)]])

local Solver = core.class({ __name = "dm.euler_solver" }, [[
dm.euler_solver: steps of a flow, made by euler:solver
fields: euler, rule, h]])

function Euler.__tostring(e)
  return ("flow on a surface of %d vertices and %d triangles%s"):format(e.mesh:count(0),
    e.mesh:count(2), e.report.note and "; " .. e.report.note or "")
end

function Solver.__tostring(s) return ("%s, h = %.6g of a %s"):format(s.rule, s.h, s.euler) end

---- what the steps need ----

local function check_surface(K)
  if K.dimension ~= 2 then
    fail("a surface is needed, a mesh of dimension 2 (got dimension %d)", K.dimension)
  end
  local masses = mass.of(K, 0)
  local bad = masses.zeros > 0 and masses.zero or masses.negatives > 0 and masses.negative
  if bad then
    fail("the dual area of vertex %d is %s (one of %d such vertices), which leaves its vorticity "
      .. "no weight: K:make_delaunay() gives other triangles, dual = \"barycentric\" other duals",
      bad, masses.zeros > 0 and "zero" or "negative", masses.zeros > 0 and masses.zeros
      or masses.negatives)
  end
end

-- made once for a mesh
local function system_of(K)
  return solver.once(K, "euler", function()
    local solved, component = held.of(K)
    local S, sign = poisson.stiffness(K), outward.signs(K)
    local free = S:pick(solved, solved)
    local inside = free.rows > 0 and solver.new(free, nil, WHERE) or nil
    local system = { solved = solved, component = component, sign = sign, solver = inside,
      holes = holes.of(K, S, solved, inside) }
    system.handles = handles.of(K, system, mass.of(K, 1).values)
    return system
  end)
end

---- classes ----

class.method("dm.mesh", "euler", function(K, options)
  option.check(options, { "vorticity", "circulations", "harmonic" }, WHERE)
  option.need(options, "vorticity", WHERE, "a 0-form, a function of the point, a list or a number")
  check_surface(K)
  local w = sample.values(options.vorticity, K, operator.primal(0), K:count(0),
    function() return K:points() end, WHERE, "vorticity")
  local system = system_of(K)
  local report = system.solver and system.solver:report() or core.result { unknowns = 0 }
  local negatives = mass.of(K, 1).negatives
  if negatives > 0 then report.negative_stars = negatives end
  report.note = mass.joined(mass.joined(report.note, mass.note(K)), system.handles.note)
  return setmetatable({ mesh = K, vorticity = K:form(0, w), system = system, report = report,
    circulations = holes.circulations(options, K, system.holes, w, WHERE),
    around = handles.around(options, K, system, WHERE) }, Euler)
end, [[
K:euler{vorticity=, circulations=, harmonic=} -> dm.euler
The flow of an ideal fluid on a surface: w' = -*(d psi ^ d w), div grad psi = w (as in
K:laplace_beltrami()), with the product of each triangle in thirds to its corners. vorticity: a
0-form, a function of the point, a list or a number. Closed surfaces face outwards; others as
K:orientation() says. psi is a constant on every loop of the boundary, so that no fluid crosses it:
0 on the longest of each component, on the others, the holes, what keeps the circulation round them
(Kelvin). circulations: a number for every hole, in the order of their first vertices, the integral
of the velocity along it with the fluid on the left; left out, psi is 0 on all loops at the start.
On a closed component the mean of w has no psi and stays where it is. Round handles there are flows
without psi: w' = -*(beta ^ d w), beta = d psi + sum b_k eta_k, eta_k an orthonormal basis of them,
b_k' the integral of w eta_k ^ beta. harmonic: the velocity at the start as a 1-form, the function
that K:form(1, f) takes or a list, of which its part round the handles is taken; left out, none.
Where a surface touches itself in a vertex they are left out, and the report's note says so. Raises
where the mesh is not orientable, and where a vertex has no positive dual area.
euler:solver{h=}:run{t=} goes on; the energy |beta|^2/2, the enstrophy |w|^2/2 and the circulation,
the sum of *v w, are kept to round-off (Arakawa 1966).]])

class.method("dm.euler", "solver", function(e, options)
  local where = "euler:solver"
  option.check(options, { "rule", "h" }, where)
  option.need(options, "h", where, "the step")
  local rule = option.one_of(options, "rule", where, { "midpoint" }, "midpoint")
  local h = option.positive(options, "h", where, "a step")
  return setmetatable({ euler = e, rule = rule, h = h }, Solver)
end, [[
euler:solver{h=, rule = "midpoint"} -> dm.euler_solver
Steps of the implicit midpoint rule, solved to round-off; h > 0.]])

class.method("dm.euler", "resume", function(e, from)
  return checkpoint.resume(require "dm.dec.flow.checkpoint", e, from)
end, [[
euler:resume(file | run) -> dm.euler_solver
A solver that goes on where a run ended, from run:checkpoint(file) or from the run itself:
solver:run{t=}, without vorticity, gives the bits of a run that never stopped. Raises when the file
is not a whole checkpoint or the flow is on another mesh.]])

class.method("dm.euler_solver", "run", function(s, options) return run.run(s, options) end, [[
solver:run{t= | steps=, every=, t0=, vorticity=, circulations=, harmonic=, ...} -> dm.flow
From the vorticity of the flow, or another one at time t0 (0), for the duration t or so many steps.
circulations, harmonic: round holes and handles, with a vorticity of its own, as in K:euler.
every: a row for so many steps (1), and one for the end. file: rows go to a .npy file as they come,
with the fields t, w (an array), energy, enstrophy, circulation and around, and the run keeps the
first and the last. checkpoint: a file for where it ended, also where it was stopped
(run:checkpoint). Raises dm.failure with the run so far where a step finds no solution: h is too
long.]])

return M
