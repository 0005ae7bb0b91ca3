--- Methods of reduction, by name and doc; their modules are loaded when one is first called.
local blame = require "dm.base.blame"
local core = require "dm.core"

local function add(class, name, module, doc)
  core.method(class, name, blame.later(module, name), doc)
end

add("dm.system", "routh", "dm.reduce.routh", [[
system:routh{cyclic=, mu=, q=, v=, connection=} -> dm.system
system:routh{action=, section=, dimension=, names=, at=, mu=, ...} -> dm.system
The system without its group variables: an ordinary dm.system in the dim Q - m coordinates that are
left, whose Lagrangian is the classical Routhian L - mu . theta' at the momentum mu. cyclic: the
coordinates that L does not depend on, by name or number (default: all of them); mu: their momentum,
a number or a list (default: that of the start q, v). action(theta, q) moves points of Q (theta: a
number, or a vector of `dimension` angles), or is a dm.action; section(x) gives a point of Q for
every shape x (default: as many coordinates as the group has dimensions are held at 0 wherever the
orbit of `at`, of the start q or of a point that is found comes to such points, else at their values
there, and theta is 0 at that point: turns leave r, which is singular at r = 0 alone); names: of
theta and x. connection(x): m rows of dim Q - m numbers, in place of the mechanical connection.
Invariance is checked at a dozen points, and the first that violates it is named: what differs
nowhere there, such as a force along the group that sets in only beyond some distance, is not seen,
and the reduced run leaves it out. Constraints and forces that the group keeps are reduced too. The
params of the system are those of the shape, with the momentum as mu (mu1, mu2, ... of a group of
more dimensions; mu_theta where a parameter is called mu): ensembles and stability maps vary them. A
run that jumps over a shape with a singular mass or locked inertia fails, with reason "pole" or
"collapse". The reduced system also has connection, curvature, locked_inertia, amended_potential,
lift, start, and its paths have reconstruct. Raises when L is no invariant, a force pushes along the
group, or the locked inertia is singular.]])

add("dm.system", "at_momentum", "dm.reduce.routh", [[
shape:at_momentum(mu) -> dm.system
The same reduction at another momentum, a number or a list of dim G numbers; nothing is checked
again.]])

add("dm.system", "connection", "dm.reduce.routh.shape", [[
shape:connection(x [, t]) -> dm.matrix, dim G x dim shape
The connection A(x): theta' + A x' vanishes on horizontal velocities. The mechanical one, I^-1
dp_theta/dx', unless system:routh was given another.]])

add("dm.system", "curvature", "dm.reduce.routh.shape", [[
shape:curvature(x [, t] [, a]) -> dm.matrix, dim shape x dim shape
The magnetic form at momentum mu, beta_ij = d_i B_j - d_j B_i of B = mu A (the exact derivative of
the connection); with a, a number from 1 to dim G, the curvature of component a alone, without
mu.]])

add("dm.system", "symplectic_form", "dm.reduce.routh.shape", [[
shape:symplectic_form(x [, t]) -> dm.matrix, 2 dim shape x 2 dim shape
The reduced form dx ^ ds - beta on (x, s), s = p - mu A(x): rows (-beta, 1), (-1, 0). RSPRK keeps
it; that of pairs of shapes is D:two_form.]])

add("dm.system", "locked_inertia", "dm.reduce.routh.shape", [[
shape:locked_inertia(x [, t]) -> dm.matrix, dim G x dim G
d2L/dtheta'2 at the shape x: the inertia of the system moved by the group as a rigid body.]])

add("dm.system", "amended_potential", "dm.reduce.routh.shape", [[
shape:amended_potential(x [, t]) -> number
V_mu = V + (mu - c).I^-1 (mu - c)/2, minus the Routhian at rest (c: the momentum of the group at
rest, 0 unless L has terms linear in the velocities). Its stationary points are relative
equilibria.]])

add("dm.system", "routhian", "dm.reduce.routh.shape", [[
shape:routhian(x, v [, t] [, kind]) -> number
kind = "classical" (default): R = L - mu . theta' at the momentum mu, the Lagrangian of this system;
kind = "magnetic": R - mu A . x', which goes with the magnetic form of shape:curvature (Leok
2.2).]])

add("dm.system", "magnetic_momentum", "dm.reduce.routh.shape", [[
shape:magnetic_momentum(x, p [, t]) -> dm.vector
s = p - mu A(x): from the canonical momentum p = dR/dx' of a path of this system to the one that
belongs to the magnetic form.]])

add("dm.system", "lift", "dm.reduce.routh.shape", [[
shape:lift(x, v [, theta] [, t]) -> q, v
The state of the unreduced system over the state (x, v) of the shape at the momentum mu: the
velocity of the group is I^-1 (mu - dp/dx' x'). theta: where in the group, a number or list (default
0).]])

add("dm.system", "start", "dm.reduce.routh.shape", [[
shape:start(q, v [, t]) -> x, v, theta
The state of the shape under a state of the unreduced system, and where that is in the group. Raises
when its momentum is not mu.]])

add("dm.system", "reduction", "dm.reduce.routh.shape", [[
shape:reduction() -> {full, mu, cyclic, shape, group}
Where a reduced system comes from: the unreduced system, the momentum (a vector), the numbers of the
coordinates that were eliminated and kept, and the names of the former. Nothing for a system that is
not reduced.]])

add("dm.path", "reconstruct", "dm.reduce.run.reconstruct", [[
path:reconstruct{theta=} -> dm.path
From a path of a reduced system to the one of the unreduced system over it: the group variable is
the integral of I^-1(mu - ...) by the rule's own quadrature, theta + h sum_j b_j theta'_j over the
stages of every step, at every row that was kept. theta: the group variable at the first row, a
number or list (default 0).]])

add("dm.path", "phases", "dm.reduce.run.reconstruct", [[
path:phases() -> {total, dynamic, geometric}
How far the group variable has come along a path of a reduced system, each a dm.matrix, #path x dim
G: dynamic, h sum_j b_j I^-1 (mu - c) over the stages, what the momentum alone would turn, and
geometric, -h sum_j b_j A x', the holonomy of the mechanical connection along the shapes (Marsden,
Montgomery & Ratiu 1990).]])

add("dm.system", "holonomy", "dm.reduce.run.reconstruct", [[
shape:holonomy(loop [, {t=, steps=}]) -> dm.vector of dim G entries
-closed integral A . dx of the connection along a loop of shapes: loop(s) for 0 <= s <= 1 with
loop(0) = loop(1) (where Q = dm.T(n): up to whole turns), a function of one number that can be
traced; by the trapezoidal rule with `steps` points (default 256), which for a smooth loop errs less
than any power of 1/steps.]])

add("dm.system", "discrete", "dm.reduce.discrete", [[
shape:discrete{rule=, h=} -> dm.discrete_shape   or   shape:discrete(Ld) -> dm.discrete_shape
A discrete Lagrangian of the unreduced system without its group variables: that of a stage rule, or
a dm.discrete_lagrangian in the unreduced coordinates, which the group must leave as it is. It has
psi_mu, the discrete connection, the discrete Routh equations.]])

add("dm.system", "rsprk", "dm.reduce.discrete.rsprk_step", [[
shape:rsprk{rule=, h=, a=, b=, A=, beta=} -> function(x0, s0) -> x1, s1
One step of the reduced symplectic partitioned Runge-Kutta rule as it is written down (Leok 2.5.14),
in the momentum s = p - mu A(x) of the magnetic form (shape:magnetic_momentum): a check of
shape:solver{rule = "rsprk(...)"}, which takes the same steps quickly. rule: gauss(s) or lobatto(s);
or the coefficients a, b and, if they are not the partner, A, refused where they are not symplectic.
beta(x): another magnetic form, to see what it changes.]])

add("dm.system", "relative_equilibria", "dm.reduce.equilibria", [[
shape:relative_equilibria{region=, starts=, copies=} -> list of {x, mu, energy, velocity, ...}
Motions along the group alone: stationary points of the amended potential in the region, a pair {
least, most } for each coordinate of the shape, found by Newton's method from `starts` points
(default 200) that fill it. velocity: of the group; index, flat: negative directions of V_mu, and
those in which it has no slope; values: {re, im}, the characteristic values of small motions, with
the magnetic term; stable: "energy" (a minimum of V_mu), "spectral" (all values imaginary) or false.
Poles of the coordinates, also where the group does not act freely (a top upright, all rods
vertical), are left out. copies = false: mirror images, with the same energy, velocity and index,
are listed once. print shows the list.]])

add("dm.system", "continue", "dm.reduce.equilibria.continue", [[
shape:continue(equilibrium, {mu = {from, to}, step=, points=, back=}) -> dm.branch
The relative equilibria that go on from one, followed by arc length (Keller) in (x, mu), through
folds, while mu is in the range, to its very ends; along its own direction where the group has
several dimensions. step: largest step of arc length; back = true: towards smaller mu first.
branch[i] as in relative_equilibria with momentum; branch.mu, .energy, .velocity, .growth, .x1 ...
and coordinates by name: columns; branch:series("mu", "energy") for dm.plot; branch.events: folds,
changes of stability, crossings of other branches, a pole (the locked inertia vanishes: mu = 0) at
which a branch ends.]])

add("dm.system", "slice", "dm.reduce.routh.slice", [[
shape:slice(what, {from=, to=, points=, t=}) -> list of series for dm.plot
"amended_potential", "connection", "curvature" or "locked_inertia" along the straight line between
two shapes, a series { x =, y =, name = } for each entry against the coordinate that changes most:
dm.plot(shape:slice("curvature", { from = a, to = b }), { file = "curvature.png" }).]])

-- rsprk(rule) is one more name of a rule, of reduced systems
local solver, solver_doc = core.method("dm.system", "solver")

local function of_rule(system, options)
  local rule = type(options) == "table" and options.rule
  if type(rule) == "string" and rule:find "^%s*rsprk" then
    return require "dm.reduce.routh.rsprk".solver(solver, system, options)
  end
  return solver(system, options)
end

core.method("dm.system", "solver", blame.relay(of_rule, "solver"), solver_doc .. [[

Of a reduced system (system:routh) also "rsprk(rule)", the reduced rule of Leok 2.5: the same steps
as `rule`, whose p is s + mu A.]])

local run, run_doc = core.method("dm.solver", "run")

-- a run of a reduced system that fails says what of the reduction is in the way
local function guarded(solver, options)
  local routh = package.loaded["dm.reduce.routh"]
  if routh and pcall(function() return solver.system end) and routh.info(solver.system) then
    return require "dm.reduce.run.failure".run(run, solver, options)
  end
  return run(solver, options)
end

core.method("dm.solver", "run", blame.relay(guarded, "run"), run_doc .. [[

A failure of a reduced system (system:routh) has a reason: "collapse" (the locked inertia vanishes;
also raised where a step jumped through such a shape), "pole" or "edge" of the coordinates. Jumps
are looked for at the rows that are kept and, where these are suspect, between them: with every = k
fewer may be seen. Members of ensembles are not looked through for jumps: watch = { "energy" } shows
them.]])

return {}
