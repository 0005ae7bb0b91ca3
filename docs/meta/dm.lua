---@meta dm
-- Made by `make docs` from what help() prints.

---@class dm
dm = {}

---dm.action: an action of a group on a space, made by dm.action{group=, on=, map=, side=, domain=}
---fields: group, on, map, side, domain, name, dimension (numbers of a point); of a joint or prolonged
---action base, and points (how many); act(g, z) is the moved point.
---@class dm.action
local dm_action_class = {}

---action:act(g, z) -> dm.vector
---
---The moved point; the same as action(g, z). Raises where g is no element of the group (to 1e-6),
---where the point is not finite.
---@param g? any
---@param z? any
---@return dm.vector
function dm_action_class:act(g, z) end

---action:cotangent() -> dm.action
---
---The cotangent lift on (z, p), 2 dim z numbers: (map(g, z), p') with <p', T map u> = <p, u>, that is
---p' = (T map)^-T p, on the side of the action itself; its momentum map is action:momentum.
---(Bogfjellmo's lift pulls p back, by T map^T: that of the inverse.)
---@return dm.action
function dm_action_class:cotangent() end

---action:free(z) -> boolean
---
---Is the action locally free at z (no vector of the algebra leaves it where it is)? Then a moving
---frame exists near z. Discrete stabilizers are not looked for.
---@param z? any
---@return boolean
function dm_action_class:free(z) end

---action:generator(z) -> dm.matrix, dim z x dim G
---
---Infinitesimal generators at z, a column for each basis vector of the algebra: d/dt map(exp(t e_a),
---z) at t = 0, exact from the graph. z may hold symbols.
---@param z? any
---@return dm.matrix
---@return any
function dm_action_class:generator(z) end

---action:invariant(f | system | Ld) -> true, defect   or   false, violation [, symmetry]
---
---Is a function f(z), the Lagrangian of a dm.system (under the lift to velocities) or a discrete
---Lagrangian (under the joint action) invariant? Compared at random points to 1e-9; the first
---violation has point, g, before, after, defect, and prints as a sentence. Systems of several bodies
---are moved body by body; an action on one coordinate more than the system has moves (q, t), and is
---tested by its generators. Where L is invariant up to a divergence dB/dt and a multiple c L of itself
---alone, the third result is { generator, divergence, scale } as path:noether takes it (of a group of
---more dimensions a list of these). Raises when the value is finite nowhere.
---@param f? any
---@return boolean
---@return any|boolean
---@return any
---@return any
function dm_action_class:invariant(f) end

---action:isotropy(z) -> { dimension, basis, orbit_dimension }
---
---The algebra of the stabilizer of z: its dimension and an orthonormal basis, from the singular values
---of the generators (below 1e-10 of the largest counts as zero), and the dimension of the orbit.
---@param z? any
---@return table
function dm_action_class:isotropy(z) end

---action:jet(n [, { independent = i | { i, j, ... } }]) -> dm.action
---
---The action on jets of order n: the point z, then the first, ..., n-th derivatives. With independent
---= i the curve is a graph over entry i of z, and the derivatives are of the other entries by it: U_x
---= D U / D X; with a list they are functions of these entries, u(x, t) for {1, 2}, the derivatives of
---one order in the order u_xx, u_xt, u_tt, of each all dependent entries. Else the curve has a
---parameter that the group leaves alone, and all entries are differentiated by it. Generators by
---phi_(K, i) = D_i phi_K - u_(K, l) D_i xi^l.
---@param n? any
---@param options? table
---@return dm.action
function dm_action_class:jet(n, options) end

---action:momentum(q, p) -> dm.vector of dim G entries
---
---The momentum map <J(q, p), xi> = <p, xi_Q(q)> of the cotangent lift. Also path:momentum(action),
---Ld:momentum(action, q0, q1).
---@param q? any
---@param p? any
---@return dm.vector
function dm_action_class:momentum(q, p) end

---action:on_pairs() -> dm.action
---
---The joint action on two points, action:on_points(2).
---@return dm.action
function dm_action_class:on_pairs() end

---action:on_points(k) -> dm.action
---
---The joint (diagonal) action on k points, z = their numbers one after the other, or a list of them;
---fields points = k, base = action.
---@param k? any
---@return dm.action
function dm_action_class:on_points(k) end

---action:tangent() -> dm.action
---
---The action on tangent vectors (z, u), 2 dim z numbers: (map(g, z), T map u).
---@return dm.action
function dm_action_class:tangent() end

---action:transitive(z) -> boolean
---
---Does the orbit of z fill a neighbourhood: is its dimension that of the space?
---@param z? any
---@return boolean
function dm_action_class:transitive(z) end

---dm.avi_cells: the cells of the potential of a field, each with a step of its own
---what field:solver{ rule = "avi" } runs
---@class dm.avi_cells
local dm_avi_cells_class = {}

---cells:limits() -> dm.vector
---
---2 / omega of every cell alone at q, with its share of the masses of its entries.
---@return dm.vector
function dm_avi_cells_class:limits() end

---cells:resonances(margin) -> number
---
---Pairs of cells with a common entry of which one kicks the other near a multiple of its half period, as steps turn it, by so many half periods.
---@param margin? any
---@return number
function dm_avi_cells_class:resonances(margin) end

---cells:run({p=, half=, file=, from=, t0=}, h, times) -> dm.path, status, events, row, why
---
---Steps h of every cell from q and p at times[1]; a row at every time. Sets `ending` of the options, the state at a row, the last one unless the run was stopped; a run that goes on from there is given it as `from`, and the time t0 of its start.
---@param options? table
---@param h? any
---@param times? any
---@return dm.path
---@return any
---@return any
---@return any
---@return any
function dm_avi_cells_class:run(options, h, times) end

---cells:sums() -> list of { call, cells }
---
---The sums of the potential in the order of their cells: number of the sum in L, and cells.
---@return table
function dm_avi_cells_class:sums() end

---dm.box_run: the recorded levels of boxes; #run rows
---fields: by the name of each component a matrix, run.u[i] (a vector of all nodes), t[i], z[i] (all
---components, node after node, without what they gain), gain (by name: what a component gains round
---the ring), moved (by name: how far what was given was from its row without z_t, on which it starts),
---steps, h, boxes, solver
---@class dm.box_run
local dm_box_run_class = {}

---run:animate(file, {of=, title=, seconds=}) -> file name
---
---A page, name.html, in which a browser moves the line through its rows, without a network. of: "u",
---"p2", a component of boxes; seconds: how long all rows take.
---@param file? string
---@param options? table
---@return string
function dm_box_run_class:animate(file, options) end

---run:balance("energy" | "momentum" | "multisymplectic") -> number[, number]
---
---The largest residual, over all boxes, of a local law D_t(density) + D_x(flux) = 0. With m the mean
---over a box and D the differences: energy has the density S(m z) - <m z, K D_x z>/2 and the flux
---<m z, K D_t z>/2; momentum exchanges M and K, density and flux; multisymplectic: <v, M w> and
---<v, K w> of two first variations, random at the start (Bridges, Reich 2001). Round-off for quadratic
---S, multisymplectic for every S; the others have order 2. The second number of "multisymplectic" is
---the largest sum of its terms without signs: round-off is some 1e-16 of it, which is large where
---variations grow.
---@param energy? any
---@return number
---@return number
function dm_box_run_class:balance(energy) end

---run:checkpoint(file) -> file name
---
---Write where the run ended, a text with all bits; boxes:resume(file) goes on from it.
---@param file? string
---@return string
function dm_box_run_class:checkpoint(file) end

---run:column(name) -> dm.vector
---
---One number a row: "t"; "u7", node 7 of a component u; "energy" and "momentum", the densities of
---run:balance summed over the ring: S(m z) - <m z, K D_x z>/2 and <m z, M D_x z>/2. Both stay to
---round-off for quadratic S, else to order 2. In products with a component that gains a constant
---round the ring its derivative stands, so that they flow nowhere.
---@param name? any
---@return dm.vector
function dm_box_run_class:column(name) end

---run:drift(name | vector) -> {per_time, error, mean, largest}
---
---Least squares slope against time of a column, or of a vector of one number a row, its standard
---error from block means, the mean, and the largest distance from the first row. At least 3 rows.
---@param name? any
---@return table
function dm_box_run_class:drift(name) end

---run:npy(file) -> file name
---
---The rows as a NumPy array with fields t, energy, u, p (of boxes: t and the components): u of a row
---is an array of all nodes; dm.load reads it.
---@param file? string
---@return string
function dm_box_run_class:npy(file) end

---run:plot(name, {style=, rows=, file=, title=, size=, ...}) -> file name or nothing
---
---name: "u" or "p" ("u2" of several values), of boxes a component. style = "raster" (default): its
---values over x, across, and t, upwards; "profile", or rows = {1, 50, ...}: over x, a line for each of
---these rows. In the terminal, or with file = to a .png, .svg or .pdf through gnuplot. Sizes and
---letters as of dm.plot.
---@param name? any
---@param options? table
---@return string|nil
function dm_box_run_class:plot(name, options) end

---run:vtk(file) -> {file, ...}
---
---A file file_00001.vtk, ... for every row, the nodes as a line with their values, and as the last one
---file.vtk.series, which gives ParaView their times.
---@param file? string
---@return table
function dm_box_run_class:vtk(file) end

---dm.box_solver: boxes with a height, made by boxes:solver
---fields: boxes, h, held (names of components with a gauge mode, whose first node is held)
---@class dm.box_solver
local dm_box_solver_class = {}

---solver:run{z = {name = f, ...}, steps= | t=, every=, t0=, file=, checkpoint=} -> dm.box_run
---
---z: functions of x, or lists of a number for every node, for the components that have a z_t; others
---follow, where they are left out, from rows without z_t, and where none tells them they start where
---their means over the first two steps point to (only their means over steps occur in the equations).
---What is given beside is moved onto its row without z_t (run.moved, and the text of a run, tell by
---how much), or refused where it is off by a quarter of its size: at every level it would be off by
---the same, with alternating signs. Where the kernel of M lies along no component y (K z_x - grad S) =
---0 is solved for all y with y M = 0: what is left out follows, what is given is moved along the
---kernel. file: a NumPy file that the rows go to as they come (t and the
---components; dm.load reads it); the run keeps the first and the last one. checkpoint: a file for
---where it ended, also where it was stopped (run:checkpoint).
---@param options? table
---@return dm.box_run
function dm_box_solver_class:run(options) end

---dm.boxes: M z_t + K z_x = grad S(z) on a ring, made by dm.multisymplectic
---fields: M, K, S, names, from, to, cells, dx
---@class dm.boxes
local dm_boxes_class = {}

---boxes:resume(file | run) -> dm.box_solver
---
---A solver that goes on where a run ended, from run:checkpoint(file) or from the run itself:
---solver:run{steps=}, without z, gives the bits of a run that never stopped. Raises when the file is
---not a whole checkpoint or the boxes are other ones.
---@param file? string
---@return dm.box_solver
function dm_boxes_class:resume(file) end

---boxes:solver{h=} -> dm.box_solver
---
---h: the height of a box. Refused where the step is singular since the ring has an even number of
---cells and det K = 0. A component whose constant nothing determines (a gauge mode, as of KdV's
---potential) is held at the first node: solver.held names it.
---@param options? table
---@return dm.box_solver
function dm_boxes_class:solver(options) end

---dm.branch: relative equilibria followed in the momentum by shape:continue
---fields: [i] (as in relative_equilibria, with momentum), events ({what, momentum, x, at}: folds,
---changes of stability, crossings); columns, vectors: mu, energy, velocity, growth (largest real part
---of a characteristic value), the coordinates of the shape by name or as x1, x2, ...; for groups of
---several dimensions velocity1, velocity2, ...
---@class dm.branch
local dm_branch_class = {}

---branch:series([x, y]) -> series for dm.plot
---
---Two columns of a branch against each other (default "mu", "energy"): dm.plot { up:series(),
---down:series() } is a bifurcation diagram.
---@param x? any
---@param y? any
---@return any
function dm_branch_class:series(x, y) end

---dm.bundle: a discrete tangent bundle (V, d-, d+) of curve segments, made by dm.bundle{system=, h=}
---fields: system, segments, h, bias, dimension
---@class dm.bundle
local dm_bundle_class = {}

---bundle:action(q, v [, t]) -> number
---
---The discrete Lagrangian: the action along the segment, by the weights of its method.
---@param q? any
---@param v? any
---@param t? any
---@return number
function dm_bundle_class:action(q, v, t) end

---bundle:check{q=, v=, t=} -> table, sentence
---
---Is it a discrete tangent bundle at (q, v)? dimension = 2 dim Q; minus, plus: smallest singular values of T d- and T d+ (submersions); transversal: that of ((T d+ + T d-)/2, (T d+ - T d-)/h), 0 where the kernels meet; zero: the element without extent at q; limit: the order in h at which that matrix tends to the identity (at least 1; infinity: it is the identity); largest_h: the first h up to 1000 of its own at which the kernels meet, or infinity; ok: all of it holds (Cuell-Patrick 2008, definition 2, proposition 1).
---@param options? table
---@return table
---@return any
function dm_bundle_class:check(options) end

---bundle:minus(q, v [, t]) -> dm.vector
---
---The boundary map d-: where the segment of (q, v) begins. t (default 0) is the time at q.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_bundle_class:minus(q, v, t) end

---bundle:momenta(q, v [, t]) -> p0, p1
---
---Both discrete Legendre transforms: dLd = p1 dq1 - p0 dq0. A path of the rule has p1 of a step equal to p0 of the next.
---@param q? any
---@param v? any
---@param t? any
---@return any
---@return any
function dm_bundle_class:momenta(q, v, t) end

---bundle:pair(q, v [, t]) -> q0, q1
---
---Both ends of the segment: the Moser-Veselov pair that (q, v) stands for.
---@param q? any
---@param v? any
---@param t? any
---@return any
---@return any
function dm_bundle_class:pair(q, v, t) end

---bundle:plus(q, v [, t]) -> dm.vector
---
---The boundary map d+: where the segment of (q, v) ends.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_bundle_class:plus(q, v, t) end

---bundle:split(q, v, dq, dv [, t]) -> dq+, dv+, dq-, dv-
---
---The variation (dq, dv) as a sum of one that leaves the beginning, (dq+, dv+), and one that leaves the end, (dq-, dv-).
---@param q? any
---@param v? any
---@param dq? any
---@param dv? any
---@param t? any
---@return any
---@return any
---@return any
---@return any
function dm_bundle_class:split(q, v, dq, dv, t) end

---bundle:tangent_minus(q, v [, t]) -> dm.matrix, n x 2n
---
---T d-, the exact derivative of minus; columns dq, dv.
---@param q? any
---@param v? any
---@param t? any
---@return dm.matrix
---@return any
function dm_bundle_class:tangent_minus(q, v, t) end

---bundle:tangent_plus(q, v [, t]) -> dm.matrix, n x 2n
---
---T d+, the exact derivative of plus; columns dq, dv.
---@param q? any
---@param v? any
---@param t? any
---@return dm.matrix
---@return any
function dm_bundle_class:tangent_plus(q, v, t) end

---bundle:velocity(q0, q1 [, t]) -> q, v
---
---The element (q, v) whose segment goes from q0 to q1, the inverse of pair; for q0 = q1 the zero of the bundle there. Raises when there is none near straight motion.
---@param q0? any
---@param q1? any
---@param t? any
---@return any
---@return any
function dm_bundle_class:velocity(q0, q1, t) end

---bundle:vertical_minus(q, v, dq [, t]) -> dq, dv
---
---The variation dq^- of (q, v) that moves the beginning by dq and leaves the end: T d-(dq^-) = dq, T d+(dq^-) = 0.
---@param q? any
---@param v? any
---@param dq? any
---@param t? any
---@return any
---@return any
function dm_bundle_class:vertical_minus(q, v, dq, t) end

---bundle:vertical_plus(q, v, dq [, t]) -> dq, dv
---
---The variation dq^+ of (q, v) that moves the end by dq and leaves the beginning: T d+(dq^+) = dq, T d-(dq^+) = 0.
---@param q? any
---@param v? any
---@param dq? any
---@param t? any
---@return any
---@return any
function dm_bundle_class:vertical_plus(q, v, dq, t) end

---dm.bundle_class: a class of (Q x G)/G or of a chain of pairs, made by A:splitting and A:split
---fields: of A:splitting [1] = q, [2] = g, a representative of [q, g]; of A:split x, g, q.
---@class dm.bundle_class
local dm_bundle_class_class = {}

---class:at(q) -> dm.bundle_class
---
---The same class by its representative at q, a point of the same fibre: [q', g] = [h q', h g h^-1]
---with h q' = q. Raises where q is of another fibre.
---@param q? any
---@return dm.bundle_class
function dm_bundle_class_class:at(q) end

---dm.calculus: the differential invariants of an action, made by dm.differential_invariants
---fields: action, names (of the invariants); methods give dm.formula.
---@class dm.calculus
local dm_calculus_class = {}

---calculus:conservation_law(L) -> dm.formula
---
---The components of v with Ad(rho)^-1 v = c along extremals of the integral of L omega (Noether's
---theorem in invariants): c_a = sum_b v_b (Ad rho)_ba. Its value takes a jet of the curve, f:value{x,
---u, u_x, ...}, and gives c, the same all along the curve.
---@param L? any
---@return dm.formula
function dm_calculus_class:conservation_law(L) end

---calculus:euler_lagrange(L) -> dm.formula
---
---The Euler-Lagrange equations of the integral of L omega in invariants, a formula for each normalized
---variation iota(du - u_x dx): H* E(L) with what the change of omega adds. L(I): a function of
---I.kappa[1], kappa, I.kappa[2], D kappa, ... (by several variables in the order of a jet). For
---kappa^2/2 in the plane kappa_ss + kappa^3/2. Raises for an unknown invariant.
---@param L? any
---@return dm.formula
function dm_calculus_class:euler_lagrange(L) end

---calculus:extremal{L=, start=, frame=, length=, steps=, rule=} -> { points, frame, s, kappa, path }
---
---The curve of an extremal of the integral of L omega, of that length in omega: E(L) = 0 stepped from
---start = { kappa = { kappa, kappa_s } } (as many numbers as the equation has orders) with the frame,
---in `steps` (100) steps of a rule (default "gauss(4)"). points: dm.matrix, a row each;
---frame: the elements g = rho^-1 that bring the normalized point to the curve; the option frame is the
---first of them (default the identity); s; every named invariant as a vector; path, the run itself.
---Raises where E(L) is not linear in the highest derivatives, or degenerate.
---@param options? table
---@return table
function dm_calculus_class:extremal(options) end

---calculus:invariants(jet) -> { kappa = { kappa, kappa_s, ... }, ... }
---
---The named invariants and as many of their derivatives as a jet of numbers has: what
---f:value takes.
---@param jet? any
---@return table
function dm_calculus_class:invariants(jet) end

---calculus:iota(k) -> dm.formula
---
---Entry k of the jet, normalized, by the named invariants: of curves in the plane under SE(2) iota(6),
---of u_xxxx, is kappa_ss + 3 kappa^3.
---@param k? any
---@return dm.formula
function dm_calculus_class:iota(k) end

---calculus:maurer_cartan() -> dm.formula
---
---(D rho) rho^-1, dim G formulas, its components in the basis of the algebra; by several variables
---those of D_1 rho, then of D_2 rho.
---@return dm.formula
function dm_calculus_class:maurer_cartan() end

---calculus:operator() -> H, H*
---
---The operator of d_V kappa = H(t), how the named invariants change with the normalized variations t1,
---t2, ... (one: without a name), and its adjoint; dm.invariant_operator, which print. In the plane
---D^2 + kappa^2.
---@return any
---@return any
function dm_calculus_class:operator() end

---calculus:recurrence() -> dm.formula
---
---What D iota(u_J) and iota(u_(J,x)) differ by, sum_a R^a iota(phi_J^a), for every entry of the jet up
---to the order of the section and of the named invariants; by several variables for every D_i.
---@return dm.formula
function dm_calculus_class:recurrence() end

---calculus:syzygies() -> dm.formula
---
---Expressions of the named invariants that vanish identically: where a derivative is reached in two
---ways, up to two orders beyond the named invariants (Gauss and Codazzi of surfaces). None where the
---invariants are free, as those of curves are unless too many are named.
---@return dm.formula
function dm_calculus_class:syzygies() end

---dm.cell_action: a sum over the cells of a mesh with gradient and Hessian
---made of the term of a stationary problem, a function of all values of a form
---@class dm.cell_action
local dm_cell_action_class = {}

---action:check(f, x)
---
---Compare the function f(x) that the action is of, called with a vector of numbers, with what it was with symbols; raises where they differ.
---@param f? any
---@param x? any
function dm_cell_action_class:check(f, x) end

---action:gradient(x) -> dm.vector
---
---Its derivatives by x; 0 where x is held.
---@param x? any
---@return dm.vector
function dm_cell_action_class:gradient(x) end

---action:hessian(x) -> dm.sparse
---
---Its second derivatives, symmetric to the last bit; all of the diagonal is stored.
---@param x? any
---@return dm.sparse
function dm_cell_action_class:hessian(x) end

---action:value(x) -> number
---
---The sum at x, as many numbers as it has.
---@param x? any
---@return number
function dm_cell_action_class:value(x) end

---dm.cell_table: the face of every cell, for sums over cells (core.cell_faces)
---table[i] is the number of that face of cell i, both from 1
---@class dm.cell_table
local dm_cell_table_class = {}

---dm.chain: a sum of cells of a mesh with integer coefficients, made by K:chain(k, {{2, {i, j}}, ...})
---fields: mesh, degree; c[i] is the coefficient of cell i; + - and integer * chain, ==
---@class dm.chain
local dm_chain_class = {}

---c:boundary() -> dm.chain
---
---The boundary, exact: of [i, j] it is [j] - [i] (Leok, Def 3.13).
---@return dm.chain
function dm_chain_class:boundary() end

---c:support() -> list of cell numbers
---
---The cells with coefficients that are not 0, ascending.
---@return table
function dm_chain_class:support() end

---dm.chart: a work-precision chart, made by dm.chart{system, q=, v=, t=, rules=, h=}
---fields: points (a list of {rule, h, error, ns, setup, steps, evaluations, newton, below}), rules
---(names), failures (what could not be run, and why), floor (errors below it cannot be told from the
---reference's), rival
---@class dm.chart
local dm_chart_class = {}

---chart:cheapest(error) -> {rule, h, error, ns, steps, evaluations, newton} or nil
---
---The cheapest measured point whose error is at most the given one, by CPU time.
---@param error? any
---@return table|nil
function dm_chart_class:cheapest(error) end

---chart:csv(file) -> file name   or   chart:csv() -> string
---
---A line per point: rule, h, error, ns, setup, steps, evaluations, newton.
---@param file? string
---@return string
function dm_chart_class:csv(file) end

---chart:order([rule]) -> number   or   nil, sentence
---
---The measured order of a rule, of the only one where none is named: the slope of ln error over ln h,
---least squares over the finest steps whose error is well above (30 times) what the references differ
---by, above the rule's own round-off where finer steps have larger errors, and below 0.3 of the range
---of the motion, as far as the slopes between neighbours agree to a tenth or 0.4. nil, and why, with
---fewer than three such steps ("not measurable", or "not asymptotic" where they are too coarse), or
---where slopes do not agree ("not asymptotic").
---@param rule? any
---@return number|nil
---@return any
function dm_chart_class:order(rule) end

---chart:pareto() -> list of points
---
---The points that no other beats in both error and time, from the cheapest to the most accurate.
---@return table
function dm_chart_class:pareto() end

---chart:plot{file=, against = "ns" | "evaluations" | "newton" | "steps" | "h", ...} -> file or nothing
---
---Error over cost, both logarithmic, a line per rule with its measured order in the legend; without a
---file in the terminal. Other options as in dm.plot.
---@param options? table
---@return any|nil
function dm_chart_class:plot(options) end

---chart:table() -> string
---
---A line per rule: measured order, number of points, least error and its cost; then the cheapest at
---1e-4, 1e-8, 1e-12 beside the rival, the rules on the front, what failed and why, how far the two
---references are apart, and the load of the machine when it was measured.
---@return string
function dm_chart_class:table() end

---dm.columns: path.t, path.q, path.p
---columns[i] is row i, #columns the number of rows; path.t is taken wherever a list of numbers is
---@class dm.columns
local dm_columns_class = {}

---dm.complex_vector: complex numbers at points, as path.psi[i] of a wave
---fields: re, im (dm.vectors), x (points), weight (of integrals); #v; + - and * / by numbers
---@class dm.complex_vector
local dm_complex_vector_class = {}

---v:abs2() -> dm.vector
---
---|v|^2, entry by entry: the density of a wave.
---@return dm.vector
function dm_complex_vector_class:abs2() end

---v:arg() -> dm.vector
---
---The phase of the entries, from -pi to pi; 0 where an entry is 0.
---@return dm.vector
function dm_complex_vector_class:arg() end

---v:dot(w) -> re, im
---
---<v, w>, the integral of conj(v) w by the weights of the points: linear in w. Raises for another
---length.
---@param w? any
---@return any
---@return any
function dm_complex_vector_class:dot(w) end

---v:norm() -> number
---
---The root of <v, v>: 1 for a normalized wave. On a ring the integral is exact for what the points
---can show.
---@return number
function dm_complex_vector_class:norm() end

---v:times(re, im) -> dm.complex_vector
---
---(re + i im) v.
---@param re? any
---@param im? any
---@return dm.complex_vector
function dm_complex_vector_class:times(re, im) end

---dm.cone: an operator from chains of degree k to degree k + 1, made by K:cone(); p(c) is p of a chain
---fields: mesh, rule, hub, poincare (has the mesh the homology of a point, so that d p + p d = 1 but
---for the hub?), critical (critical[k], k from 0: cells in no pair of the matching; rules "matching",
---"collapse")
---@class dm.cone
local dm_cone_class = {}

---p:augment{at=, ring=, closed=, vertex=} -> dm.cone
---
---The cone of the mesh with one vertex w more, p.mesh of the result: w is joined to the vertex `at`
---and the vertices of its ring, in the plane to one or two of them, in space to a path, or with closed
---= true a circuit of them; or ring is a list of simplices. p(w tau) = +-([w, at, tau] - p of the rest
---of its boundary) (Leok, Def 3.33, Ex 3.13, 3.16). vertex: the point of w, without it the mesh has no
---metric.
---@param options? table
---@return dm.cone
function dm_cone_class:augment(options) end

---p:carry(f) -> dm.cone
---
---f p f^-1, the cone of the second mesh of an isomorphism f, a dm.simplicial_map: where its points are
---plays no part (logically star-shaped complexes, Leok, Def 3.31).
---@param f? any
---@return dm.cone
function dm_cone_class:carry(f) end

---p:check() -> number
---
---The largest coefficient of d p + p d - 1 + projection over all cells: 0, exactly, but for rule
---"linear", whose defect is round-off, or the homology that it cannot draw together.
---@return number
function dm_cone_class:check() end

---p:cocone(a) -> dm.form
---
---The transpose H of p, of degree one less: (H a)(c) = a(p c). H d + d H = 1 but for homology, so that
---a closed form without periods is d of its cocone.
---@param a? any
---@return dm.form
function dm_cone_class:cocone(a) end

---p:project(c) -> dm.chain
---
---The projection of d p + p d = 1 - projection: on a mesh that can be drawn together, vertices to the
---hub and all else to nothing.
---@param c? any
---@return dm.chain
function dm_cone_class:project(c) end

---dm.connection: a discrete connection A_d on Q = base x group, made by dm.connection{group=, base=,
---...}, Ld:connection{cyclic=} or system:mechanical_connection{group=, rule=, h=}; A(q0, q1) is A_d,
---an element g. Points are lists { x, g } of a point of the base and an element of the group, which
---acts on g from the left; of Ld:connection they are points of Q.
---fields: group, base, given (which option it was made from), by, raw, completed (true where axiom
---(iii) was mended), name.
---@class dm.connection
local dm_connection_class = {}

---A:check() -> {equivariance, splitting, composition, worst, where}
---
---The largest defects, at random near points that are always the same, of the axioms (i) A_d(h q0, h
---q1) = h A_d(q0, q1) h^-1, (ii) A_d(q, h q) = h, (iii) A_d(q0, h q1) = h A_d(q0, q1); the largest of
---all, and where that is, { axiom, q0, q1, h }. Raw connections break (iii), mechanical ones of a
---momentum other than 0 break (ii).
---@return table
function dm_connection_class:check() end

---A:compose({q0, q1}, {r0, r1}) -> {q0, k r1}
---
---The extended composition of pairs whose inner points are on one fibre, q1 = k r0 (Leok 4.5.1): that
---of the pair groupoid where q1 = r0; vertical composition, (q0, g q0) (q0, q1) = (q0, g q1). It is
---the same for all connections. Raises where the fibres do not match.
---@param options? table
---@param options_? any
---@return table
function dm_connection_class:compose(options, options_) end

---A:continuous(x) -> dm.matrix, dim G x dim S
---
---The continuous connection AA(x) that A_d tends to: A(v) = Ad_g (AA(x) x' + g^-1 g'), column a the
---derivative of log A(x, x1) along x1^a at x1 = x. x may hold symbols.
---@param x? any
---@return dm.matrix
---@return any
function dm_connection_class:continuous(x) end

---A:curvature(x, i, j) -> dm.vector of dim G entries
---
---That of the continuous connection, d_i AA_j - d_j AA_i - [AA_i, AA_j]. log(holonomy)/area of a small
---loop in the plane (i, j), from i to j, tends to minus this: of a few steps where A(x1, x0) is the
---inverse of A(x0, x1), else of many.
---@param x? any
---@param i? any
---@param j? any
---@return dm.vector
function dm_connection_class:curvature(x, i, j) end

---A:formation{q1, ...} -> list of { dx, g }
---
---Where each body stands relative to the first, itself included: A:relative(q1, qi). A formation is
---locked as long as these stay what they are.
---@param options? table
---@return table
function dm_connection_class:formation(options) end

---A:holonomy({x0, ..., xm} [, q0]) -> h
---
---The lift of a closed loop of shapes from q0 (left out: { x0, identity }) ends at h q0. xm must be
---x0, angles of dm.T(n) up to whole turns. Raises where the loop is open, and where an angle takes
---half a turn or more in a step: the loop is too coarse.
---@param options? table
---@param q0? any
---@return any
function dm_connection_class:holonomy(options, q0) end

---A:hor(q0, q1) -> point
---
---The second point of the horizontal component (q0, A_d(q0, q1)^-1 q1), on the fibre of q1.
---@param q0? any
---@param q1? any
---@return any
function dm_connection_class:hor(q0, q1) end

---A:horizontal_splitting(x0, x1) -> q0, q1
---
---A representative of the class of (Q x Q)/G of horizontal pairs over (x0, x1): the one with q0 = (x0,
---e).
---@param x0? any
---@param x1? any
---@return any
---@return any
function dm_connection_class:horizontal_splitting(x0, x1) end

---A:join{x=, g=, q=} -> {q0, ..., qk}
---
---The inverse of A:split: q_l = g_(l-1) ... g_0 qbar_l, where qbar is the lift of the shapes from
---q.
---@param options? table
---@return table
function dm_connection_class:join(options) end

---A:lift(x0, x1, q0) -> point
---
---The second point of the horizontal lift of (x0, x1) that begins at q0, which lies over x0: (x1, g0
---A(x0, x1)^-1). Raises where q0 is of another fibre.
---@param x0? any
---@param x1? any
---@param q0? any
---@return any
function dm_connection_class:lift(x0, x1, q0) end

---A:local_form(x0, x1) -> g
---
---A(x0, x1) = A_d((x0, e), (x1, e)).
---@param x0? any
---@param x1? any
---@return any
function dm_connection_class:local_form(x0, x1) end

---A:multi_lift({x0, ..., xk}, q0) -> {qbar0, ..., qbark}
---
---The lift of a chain of shapes from q0 on: every pair of neighbours is horizontal.
---@param options? table
---@param q0? any
---@return table
function dm_connection_class:multi_lift(options, q0) end

---A:one_form(q0, q1) -> g
---
---The discrete connection one-form A_d, the same as A(q0, q1): in a trivialization g1 A(x0, x1)
---g0^-1.
---@param q0? any
---@param q1? any
---@return any
function dm_connection_class:one_form(q0, q1) end

---A:order([{reference=, at=}]) -> number
---
---The order, measured: the slope, less 1, of sup |log(A_ref A_d^-1)| over pairs at the distances h =
---0.4, 0.2, 0.1 in directions at random, from (of a rule about) points at random or the one `at`;
---errors below 1e-12 are left out, and larger distances, up to 1.6, are tried then. reference: the
---connection that is approximated; left out, gauss(8) for those of a rule, which take h as their step
---too, and by = "exp" for those of a continuous form.
---@param options? table
---@return number
function dm_connection_class:order(options) end

---A:relative(q0, q1) -> dx, g
---
---What leads from q0 to q1: the command of shape, x1 - x0 (of angles the shortest way), and that of
---the group, A_d(q0, q1), which is the identity where the connection takes the group along with the
---shape (Leok 4.7.2).
---@param q0? any
---@param q1? any
---@return any
---@return any
function dm_connection_class:relative(q0, q1) end

---A:representative({q0, ..., qk}, q) -> list of points
---
---The class [q0, ..., qk] of points that are moved together, by the representative whose first point
---is q, of the fibre of q0.
---@param options? table
---@param q? any
---@return table
function dm_connection_class:representative(options, q) end

---A:split{q0, ..., qk} -> { x, g, q }
---
---The isomorphism alpha of Q^(k+1)/G [E5]: the shapes x = {x0, ..., xk} and the classes [q0, A_d(q_l,
---q_(l+1))], g = their k elements at q = q0. class:at(q) gives them at another point of the fibre;
---A:join takes them back.
---@param options? table
---@return table
function dm_connection_class:split(options) end

---A:splitting(q0, q1) -> { q0, g }
---
---The splitting phi([q0, q1]) = [q0, A_d(q0, q1)] of the discrete Atiyah sequence G~ -> (Q x Q)/G -> S
---x S, by its representative at q0; class:at(q) gives the one at another point of the fibre.
---@param q0? any
---@param q1? any
---@return table
function dm_connection_class:splitting(q0, q1) end

---A:variation(q0, q1, {dx, eta}) -> vertical, horizontal
---
---What a variation of q1 (eta = g1^-1 dg1, an algebra vector) does to the second points of ver(q0, q1)
---and hor(q0, q1): { 0, Ad_(A^-1) eta + a } and { dx, -Ad_A a }, a = A^-1 dA along dx, lists of the
---same kind as dq1; eta = Ad_A eta_v + eta_h.
---@param q0? any
---@param q1? any
---@param options? table
---@return any
---@return any
function dm_connection_class:variation(q0, q1, options) end

---A:ver(q0, q1) -> point
---
---The second point of the vertical component (q0, A_d(q0, q1) q0), on the fibre of q0. A:compose of
---the vertical and the horizontal pair is (q0, q1).
---@param q0? any
---@param q1? any
---@return any
function dm_connection_class:ver(q0, q1) end

---dm.diffeo: a discrete diffeomorphism, or a family of them, made by dm.diffeo(K1, K2 | f)
---fields: from, to (meshes; of a family to is nil); phi(t) is the member of a family at time t
---@class dm.diffeo
local dm_diffeo_class = {}

---phi:compose(psi) -> dm.diffeo
---
---phi after psi, where psi ends on the mesh that phi begins with; else psi after phi. Raises where
---neither fits.
---@param psi? any
---@return dm.diffeo
function dm_diffeo_class:compose(psi) end

---phi:dual(k) -> dm.matrix, dm.matrix
---
---The map of dual vertices: circumcentres of the k-cells (k = n by default), and those of their
---images, a row each. The centre of an image is not the image of the centre.
---@param k? any
---@return dm.matrix
---@return dm.matrix
function dm_diffeo_class:dual(k) end

---phi:dual_velocity(t [, k]) -> dm.matrix
---
---The velocity of the circumcentres of the k-cells (k = n by default) at time t, a row each.
---@param t? any
---@param k? any
---@return dm.matrix
function dm_diffeo_class:dual_velocity(t, k) end

---phi:inverse() -> dm.diffeo
---
---The map back.
---@return dm.diffeo
function dm_diffeo_class:inverse() end

---phi:material_velocity(t) -> dm.vector_field
---
---V(X, t) = d/dt phi_t(X) at the vertices X of the first mesh: exact where the family is a function of
---t that gives points, by differences of order 6 where it gives meshes.
---@param t? any
---@return dm.vector_field
function dm_diffeo_class:material_velocity(t) end

---phi:pair() -> dm.pair
---
---The element (from, to) of the pair groupoid of realizations.
---@return dm.pair
function dm_diffeo_class:pair() end

---phi:pull(a) -> dm.form or dm.vector_field
---
---A form of the image as a form of the first mesh: its value on a cell is that of a on the image of
---the cell. It commutes with d and with the natural wedge, not with the metric one, nor with stars. A
---field of vectors on cells by the inverse of the linear map of each cell.
---@param a? any
---@return dm.form|dm.vector_field
function dm_diffeo_class:pull(a) end

---phi:push(a) -> dm.form or dm.vector_field
---
---A form of the first mesh on the image, the pull-back by the inverse. A field of vectors on cells by
---the linear map of each cell.
---@param a? any
---@return dm.form|dm.vector_field
function dm_diffeo_class:push(a) end

---phi:spatial_velocity(t) -> dm.vector_field
---
---v(x, t) = V(X, t) at the points x = phi_t(X): a field on the mesh at time t.
---@param t? any
---@return dm.vector_field
function dm_diffeo_class:spatial_velocity(t) end

---dm.discrete_lagrangian: Ld(q0, q1), made by dm.discrete_lagrangian{Q=, h=, Ld=}
---or, of a system and a rule, by dm.discrete_lagrangian(system, {rule=, h=})
---fields: Q, Ld, h, name, coordinates, units, params, system, rule, constraint, map
---@class dm.discrete_lagrangian
local dm_discrete_lagrangian_class = {}

---Ld:against_exact{q=, v=, h={...}, t0=} -> { h, value, momentum, value_slope, momentum_slope }
---
---The discrete Lagrangian of a system and a rule beside the exact one, for several steps h, between
---the ends of the motion from q with velocity v at the time t0 (0): value is |Ld - L_exact|, momentum
---the largest difference of a Legendre transform from the momentum of the motion. The slopes are
---exponents of h, 2s + 1 and 2s for gauss(s); nil where fewer than two errors are above round-off
---(Leok 5.1.1, Marsden & West 2001, 2.3). Raises for a formula Ld(q0, q1) of a script.
---@param options? table
---@return table
function dm_discrete_lagrangian_class:against_exact(options) end

---Ld:average(group | action [, {points=}]) -> dm.discrete_lagrangian
---
---The mean of Ld(g q0, g q1) over a compact group, by its standard action on Q or the given one: it
---is invariant, so that its steps keep the momentum map (Leok, remark 5.2). points: of every angle
---(8), by the trapezoidal rule on SO(2) and T^n, by Euler's angles on SO(3) with Gauss nodes of the
---cosine, by factors on products. Invariance is looked at to 1e-12: raises where more points are
---needed, and for a group that is not compact. Of a rule of stages, gauss(2), these are solved for
---inside of the mean, at every element.
---@param group? any
---@param options? table
---@return dm.discrete_lagrangian
function dm_discrete_lagrangian_class:average(group, options) end

---Ld:coefficients() -> {a, d, b, c, beta}
---
---Of a system and a rule, what its curves are made of (Leok 2.4): with velocities V_j, Q_i = q0 + h sum_j a_ij V_j and Qdot_i = sum_j d_ij V_j at the times c_i h, where L is taken with the weights h b_i; q1 = q0 + h sum_j beta_j V_j.
---@return table
function dm_discrete_lagrangian_class:coefficients() end

---Ld:connection{cyclic=, mu=} -> dm.connection
---
---The discrete mechanical connection theta1 - theta0 - psi_mu(x0, x1) of a discrete Lagrangian that
---does not depend on where the cyclic coordinates theta (numbers or names; left out: all that are)
---begin: psi_mu is how far theta goes from x0 to x1 with the momentum mu (0, else a number or list).
---It is called with points of Q and gives a vector; A:lift and A:holonomy take shapes, the coordinates
---that are left. For T = (I theta'^2 + 2 b.x' theta' + ...)/2 the midpoint rule has psi = -a((x0 +
---x1)/2).(x1 - x0), a = b/I. Raises where Ld is not invariant; a value where the locked inertia is
---singular.
---@param options? table
---@return dm.connection
function dm_discrete_lagrangian_class:connection(options) end

---system:emit_c() -> string
---
---C17 text of what the runtime computes, with no need of dmlua: lagrangian (1 output), slope (dL/dq, dL/dv: 2 dim Q) and energy, and constraint, rolling, reaction, force where there are such, each void f(const double *in, double *out) with in = q, v, t; of a discrete Lagrangian Ld and slope with in = q0, q1. Compile with -ffp-contract=off and, for gcc with -mfma, -fno-tree-slp-vectorize: then nothing is fused that the text does not fuse.
---@return string
function dm_discrete_lagrangian_class:emit_c() end

---Ld:hamilton_pontryagin(q0, q1 [, t]) -> {value, p0, p1, q, v, p, residual}
---
---The stationary point of h sum_i b_i [L(q_i, v_i) + p_i . (dq_i/dt - v_i)] over the curves of the rule from q0 to q1: positions, velocities and momenta p_i = dL/dv at its points (matrices, a row each), the multipliers p0 and p1 of the ends, which are the discrete Legendre transforms, and what is left of its equations (Leok 5.2).
---@param q0? any
---@param q1? any
---@param t? any
---@return table
function dm_discrete_lagrangian_class:hamilton_pontryagin(q0, q1, t) end

---Ld:legendre_minus(q0, q1 [, t]) -> dm.vector
---
---The momentum p0 = -D1 Ld(q0, q1) - F1 at q0, F1 the discrete force (Leok 2.3, 2.8.2). t: of a system and a rule, the time at q0 (0).
---@param q0? any
---@param q1? any
---@param t? any
---@return dm.vector
function dm_discrete_lagrangian_class:legendre_minus(q0, q1, t) end

---Ld:legendre_plus(q0, q1 [, t]) -> dm.vector
---
---The momentum p1 = D2 Ld(q0, q1) + F2 at q1, F2 the discrete force (Leok 2.3, 2.8.2). t: of a system and a rule, the time at q0 (0).
---@param q0? any
---@param q1? any
---@param t? any
---@return dm.vector
function dm_discrete_lagrangian_class:legendre_plus(q0, q1, t) end

---Ld:momentum(group, q0, q1 [, {block=, t=}]) -> dm.vector of dim G entries   or   Ld:momentum(action, q0, q1, t)
---
---The discrete momentum map <J, xi> = D2 Ld(q0, q1) . xi_Q(q1) of a standard action; kept along a path when Ld is invariant. t: of a system and a rule, the time at q0 (0).
---@param group? any
---@param q0? any
---@param q1? any
---@param options? table
---@return dm.vector
function dm_discrete_lagrangian_class:momentum(group, q0, q1, options) end

---Ld:order([{q=, v=, p=, t0=}]) -> number
---
---The order, measured on the system itself: by how much runs over the same time approach each other
---when their step is halved, from q and the velocity v or momentum p (left out: a point without
---meaning) at the time t0 (0). A formula Ld(q0, q1, h) must use its h. Raises when no rate is to be
---seen.
---@param options? table
---@return number
function dm_discrete_lagrangian_class:order(options) end

---system:solver{rule=, h=, newton={tolerance=, max_iterations=}, backend=, sums=} -> dm.solver
---
---A solver for this system: see dm.solver and dm.rules().
---@param options? table
---@return dm.solver
function dm_discrete_lagrangian_class:solver(options) end

---Ld:two_form(q0, q1 [, t]) -> dm.matrix
---
---The matrix -D1D2 Ld (row q0, column q1) of the discrete symplectic form omega = -d2Ld/dq0dq1 dq0 ^ dq1. t: of a system and a rule, the time at q0 (0).
---@param q0? any
---@param q1? any
---@param t? any
---@return dm.matrix
function dm_discrete_lagrangian_class:two_form(q0, q1, t) end

---Ld:value(q0, q1 [, t]) -> number
---
---The discrete Lagrangian, the same as Ld(q0, q1 [, t]): of a rule, the action of the curve of that rule from q0 at the time t (0) to q1, found by Newton to round-off.
---@param q0? any
---@param q1? any
---@param t? any
---@return number
function dm_discrete_lagrangian_class:value(q0, q1, t) end

---dm.discrete_shape: a discrete Lagrangian without its group variables, made by shape:discrete
---fields: shape (the reduced system), Ld (of the unreduced system), h; points x0, x1 are dim shape
---numbers each.
---@class dm.discrete_shape
local dm_discrete_shape_class = {}

---D:connection(q0, q1) -> dm.vector of dim G entries
---
---The discrete connection theta1 - theta0 - psi_mu(x0, x1) of two points of the unreduced system: zero
---where their discrete momentum is mu; with mu = 0 the discrete mechanical connection.
---@param q0? any
---@param q1? any
---@return dm.vector
function dm_discrete_shape_class:connection(q0, q1) end

---D:legendre_minus(x0, x1) -> dm.vector
---
---The reduced momentum at x0, s0 = -(D1 L^d + F1 - A^1), F1 the discrete force where there is one: p -
---mu A of the unreduced path there.
---@param x0? any
---@param x1? any
---@return dm.vector
function dm_discrete_shape_class:legendre_minus(x0, x1) end

---D:legendre_plus(x0, x1) -> dm.vector
---
---The reduced momentum at x1, s1 = D2 L^d + F2 - A^2.
---@param x0? any
---@param x1? any
---@return dm.vector
function dm_discrete_shape_class:legendre_plus(x0, x1) end

---D:one_form(x0, x1) -> dm.vector, dm.vector
---
---The two halves of the one-form of Leok (2.3.29), mu psi_x0 - mu A(x0) and mu psi_x1 + mu A(x1), with
---the connection of the shape.
---@param x0? any
---@param x1? any
---@return dm.vector
---@return dm.vector
function dm_discrete_shape_class:one_form(x0, x1) end

---D:psi(x0, x1 [, guess]) -> dm.vector of dim G entries
---
---psi_mu: how far the group variable goes from x0 to x1 at the momentum mu, the solution of
---dLd/dpsi(x0, x1, psi) = mu (Leok 2.3); of several the one that Newton's method reaches from the
---guess, by default h theta' of the straight line. Raises where there is none.
---@param x0? any
---@param x1? any
---@param guess? any
---@return dm.vector
function dm_discrete_shape_class:psi(x0, x1, guess) end

---D:residual(x0, x1, x2 [, kind]) -> dm.vector
---
---What is left of the discrete Routh equations at three points in a row: kind = "literal" (default),
---D2 L^d + D1 L^d - A^2 - A^1 (Leok 2.3.29), or "direct", dLd/dx1 + dLd/dx1 at psi_mu, which is the
---same without a connection; discrete forces F2 + F1 are in it (Leok 2.8.2), reactions are not.
---@param x0? any
---@param x1? any
---@param x2? any
---@param kind? any
---@return dm.vector
function dm_discrete_shape_class:residual(x0, x1, x2, kind) end

---D:routhian(x0, x1) -> number
---
---The discrete classical Routhian Ld(x0, x1, psi_mu) - mu . psi_mu, whose discrete Euler-Lagrange
---equations are the discrete Routh equations.
---@param x0? any
---@param x1? any
---@return number
function dm_discrete_shape_class:routhian(x0, x1) end

---D:solver{...} -> dm.solver
---
---A solver of the discrete Routh equations, in C: the discrete Lagrangian D:routhian with its step as
---a map, x1 and psi_mu solved for together by the equations of Ld in the coordinates of Q, so that it
---steps what Ld steps (run it from q and p, or q0 and q1; p is the canonical momentum s + mu A). Of a
---partitioned Runge-Kutta rule in the coordinates (theta, x) it is the solver of the shape, which
---takes the same steps. path:reconstruct adds psi_mu from step to step. Constraints of the system are
---those of the shape, with the multipliers of the unreduced equations (run with record = {
---"impulses" }, Leok 2.8.1). Options as for dm.solver.
---@param options? table
---@return dm.solver
function dm_discrete_shape_class:solver(options) end

---D:step(x0, x1) -> x2, psi
---
---The next point of the discrete Routh equations after x0 and x1, and psi_mu(x1, x2), solved for
---together, to round-off; of several solutions the one that the step of Ld takes. For long runs use
---D:solver, which takes the same steps.
---@param x0? any
---@param x1? any
---@return any
---@return any
function dm_discrete_shape_class:step(x0, x1) end

---D:two_form(x0, x1) -> dm.matrix, dim shape x dim shape
---
---The matrix -d2W/dx0dx1 (row x0, column x1) of the reduced discrete symplectic form, W the discrete
---Routhian: kept along paths, and regular where x1 determines the momentum.
---@param x0? any
---@param x1? any
---@return dm.matrix
---@return any
function dm_discrete_shape_class:two_form(x0, x1) end

---D:value(x0, x1) -> number
---
---The reduced discrete Lagrangian Ld(x0, x1, psi_mu). It is not what is stationary along paths: that
---is D:routhian.
---@param x0? any
---@param x1? any
---@return number
function dm_discrete_shape_class:value(x0, x1) end

---dm.ensemble: the ends of many runs, made by solver:ensemble{members=}
---fields: q, p (matrices, a row per member; of a failed one its last good state), status[i] ("ok" or a code of dm.failure), steps[i] (finished), t, h (vectors where members have steps of their own, t also where the rule has a time of its own), solver, rows (were some kept?), lanes (members that went side by side, 1: one by one), systems (made for the parameters of members, 1: one kernel served all); #ensemble members
---@class dm.ensemble
local dm_ensemble_class = {}

---ensemble:departure(i, flow, j, names [, until, bounds]) -> table of numbers, number
---
---How far the rows of member i are at most from those of member j of the ensemble `flow`, for each of these watched columns, up to the time `until`: that member's rows lie at even times and so dense that the polynomial through eight of them is the motion; where rows of i leave steps out parabolas tell the largest value between them. NaN where a number is none. With a table of bounds it ends at the first row beyond one, whose time is the second number, else infinite.
---@param i? any
---@param flow? any
---@param j? any
---@param names? any
---@param until_? any
---@param bounds? any
---@return table
---@return number
function dm_ensemble_class:departure(i, flow, j, names, until_, bounds) end

---ensemble:failures() -> table of {member, code, step, message}
---
---The members that did not reach the end, why (see dm.failure), and the step that failed. Code "no_start": its parameters (vary=) leave no equations of motion, a mass of zero for instance; the message says why.
---@return table
function dm_ensemble_class:failures() end

---ensemble:followed(i) -> {name = number}
---
---What solver:ensemble{beside=} has found of member i: of columns that flows have the largest distance from the flow, of others the largest size, each up to where it was looked at.
---@param i? any
---@return table
function dm_ensemble_class:followed(i) end

---ensemble:path(i) -> dm.path
---
---The rows of member i, of an ensemble that was asked to keep some (every=, watch=): what solver:run would have given, of a failed member up to its last good state.
---@param i? any
---@return dm.path
function dm_ensemble_class:path(i) end

---ensemble:plot([x, y,] {members=, file=, title=, style=, ...}) -> file name or nothing
---
---With rows (every=, rows=, watch=): the fan of the members' paths, columns as in path:plot (left out:
---the first column against t). Without: where the members ended, a point each, as columns of q and p
---("q1", "p1" or the names of the coordinates; left out: q1 and q2, or q1 and p1). members: how many
---are drawn, evenly chosen (default 64 paths, all points), or a list of their numbers. Colours go from
---blue to red with the number of the member; one that failed is grey up to there, and is not drawn as
---an end. Options as in dm.plot.
---@param x? any
---@param y? any
---@param options? table
---@return string|nil
function dm_ensemble_class:plot(x, y, options) end

---ensemble:range(i, name [, until]) -> number, number
---
---Greatest less least value of a watched column of member i up to the time `until`, between its rows, too; and its first value (NaN without rows).
---@param i? any
---@param name? any
---@param until_? any
---@return number
---@return number
function dm_ensemble_class:range(i, name, until_) end

---ensemble:stride(i, names, share) -> integer
---
---The largest power of two s such that every s-th row of member i tells those between, of these watched columns, to `share` of their ranges.
---@param i? any
---@param names? any
---@param share? any
---@return integer
function dm_ensemble_class:stride(i, names, share) end

---ensemble:summary([name]) -> {first, last, least, largest, mean, slope, error, early, late, nearest, span, megno} or {name = {least, mean, largest}}
---
---What the rows of every member say of a column y, as tables with an entry for each: slope per unit of time with its standard error as path:drift finds them; early, late: largest |y - first| in the first and the last quarter of the rows; nearest, span: least |y - first| and largest - least in their second half (infinite without rows there); megno: the mean of 2 (y - its mean so far), which is MEGNO where y is the logarithm of the length of a tangent vector. NaN without rows. Without a name: of every column the extent over the rows of all members.
---@param name? any
---@return table
function dm_ensemble_class:summary(name) end

---dm.euler: flow on a surface by its vorticity, made by K:euler
---fields: mesh, vorticity (a 0-form, at the start), circulations (round the holes, a dm.vector),
---around (b_k, round the handles), report (of the solver of the stream function; note: what is left
---out)
---@class dm.euler
local dm_euler_class = {}

---euler:resume(file | run) -> dm.euler_solver
---
---A solver that goes on where a run ended, from run:checkpoint(file) or from the run itself:
---solver:run{t=}, without vorticity, gives the bits of a run that never stopped. Raises when the file
---is not a whole checkpoint or the flow is on another mesh.
---@param file? string
---@return dm.euler_solver
function dm_euler_class:resume(file) end

---euler:solver{h=, rule = "midpoint"} -> dm.euler_solver
---
---Steps of the implicit midpoint rule, solved to round-off; h > 0.
---@param options? table
---@return dm.euler_solver
function dm_euler_class:solver(options) end

---dm.euler_engine: vorticity on a surface, stepped by mesh:euler's solvers
---Between calls it holds the vorticity and its low-order parts; nothing else matters.
---@class dm.euler_engine
local dm_euler_engine_class = {}

---e:advance(h, steps) -> steps taken, rates
---
---Steps of the implicit midpoint rule, and how many rates they needed in all; fewer steps than asked for where one failed.
---@param h? any
---@param steps? any
---@return any
---@return any
function dm_euler_engine_class:advance(h, steps) end

---e:around() -> dm.vector
---
---How much the flow has of each form of the handles.
---@return dm.vector
function dm_euler_engine_class:around() end

---e:fail(steps, t, h, rule, run) -> nothing
---
---Raises a dm.failure that says why the last e:advance ended, with the run so far.
---@param steps? any
---@param t? any
---@param h? any
---@param rule? any
---@param run? any
---@return nil
function dm_euler_engine_class:fail(steps, t, h, rule, run) end

---e:low() -> dm.vector
---
---What compensated sums of the vorticity, and then of e:around(), have beside them.
---@return dm.vector
function dm_euler_engine_class:low() end

---e:measure() -> dm.vector, energy, enstrophy, circulation
---
---The stream function at the vertices, the energy, |w|^2 / 2 and the sum of *v w.
---@return dm.vector
---@return any
---@return any
---@return any
function dm_euler_engine_class:measure() end

---e:vorticity() -> dm.vector
---
---The vorticity at the vertices.
---@return dm.vector
function dm_euler_engine_class:vorticity() end

---dm.euler_solver: steps of a flow, made by euler:solver
---fields: euler, rule, h
---@class dm.euler_solver
local dm_euler_solver_class = {}

---solver:run{t= | steps=, every=, t0=, vorticity=, circulations=, harmonic=, ...} -> dm.flow
---
---From the vorticity of the flow, or another one at time t0 (0), for the duration t or so many steps.
---circulations, harmonic: round holes and handles, with a vorticity of its own, as in K:euler.
---every: a row for so many steps (1), and one for the end. file: rows go to a .npy file as they come,
---with the fields t, w (an array), energy, enstrophy, circulation and around, and the run keeps the
---first and the last. checkpoint: a file for where it ended, also where it was stopped
---(run:checkpoint). Raises dm.failure with the run so far where a step finds no solution: h is too
---long.
---@param options? table
---@return dm.flow
function dm_euler_solver_class:run(options) end

---dm.factor: what solves systems with one sparse matrix, made by A:factor
---fields: kind, condition (an estimate of the reciprocal one), unknowns
---@class dm.factor
local dm_factor_class = {}

---f:solve(b) -> dm.vector, iterations   or nothing
---
---x with A x = b, and how many iterations that took (0: a factorization). Nothing where conjugate gradients find that A is not positive semidefinite.
---@param b? any
---@return dm.vector
---@return any|nil
function dm_factor_class:solve(b) end

---dm.failure: raised when a computation fails; pcall returns it
---fields: code ("no_convergence", "singular", "not_finite", "inertia", "too_short", "no_value", "stopped"), step, time, residual, iterations, rule, message, path (what was computed before); constraint or rolling: the number of the one that lost rank; fading: d2L/dv2 was about to lose a value
---@class dm.failure
local dm_failure_class = {}

---dm.field_chart: errors of a field over its size, made by dm.chart{system = function(N) ... end,
---N = {...}, ...}
---fields: points (a list of {rule, size, width (of a cell), h, steps, error, ns}), rules (names),
---failures (what could not be run, and why), name (of the size), against
---@class dm.field_chart
local dm_field_chart_class = {}

---chart:csv(file) -> file name   or   chart:csv() -> string
---
---A line per point: rule, size, width, h, steps, error, ns.
---@param file? string
---@return string
function dm_field_chart_class:csv(file) end

---chart:order([rule]) -> number   or   nil, sentence
---
---The slope of ln error over ln width of a cell, between the two finest sizes of a rule (default: the
---first).
---@param rule? any
---@return number|nil
---@return any
function dm_field_chart_class:order(rule) end

---chart:plot{file=, against = "width" | "ns" | "h", ...} -> file or nothing
---
---Errors over the width of a cell (or CPU time, or the step), both logarithmic, a line per rule.
---Other options as in dm.plot.
---@param options? table
---@return any|nil
function dm_field_chart_class:plot(options) end

---chart:table() -> string
---
---A line for every size of every rule: width of a cell, step, error, order from the size before, CPU
---time; then what failed.
---@return string
function dm_field_chart_class:table() end

---dm.flow: what a run of K:euler recorded
---fields: mesh, t (a dm.vector), w[i] (vorticity of row i, a dm.vector), around[i] (b_k of row i,
---round the handles), columns (names), steps, h, rule, euler, solver, circulations (round the holes),
---sweeps (rates that a step needed, in the mean), file; #run rows
---@class dm.flow
local dm_flow_class = {}

---run:animate(file, {of = "w" | "psi", title=, seconds=}) -> file name
---
---A page, name.html, in which a browser shows the rows one after the other on the surface, which can
---be turned, without a network; seconds: how long all of them take (10).
---@param file? string
---@param options? table
---@return string
function dm_flow_class:animate(file, options) end

---run:beta(i) -> dm.form
---
---The closed 1-form of row i that, turned by 90 degrees, is the velocity u = *beta: d psi and what
---flows round the handles. Its integral along a path is what crosses it from its right to its left.
---@param i? any
---@return dm.form
function dm_flow_class:beta(i) end

---run:checkpoint(file) -> file name
---
---Write where the run ended, a text with all bits; euler:resume(file) goes on from it.
---@param file? string
---@return string
function dm_flow_class:checkpoint(file) end

---run:column(name) -> dm.vector
---
---"t", "energy", "enstrophy" or "circulation" of every row.
---@param name? any
---@return dm.vector
function dm_flow_class:column(name) end

---run:drift(name | vector) -> {per_time, error, mean, largest}
---
---Least squares slope against time of a column, or of a vector of one number a row, its standard
---error from block means, the mean, and the largest distance from the first row. At least 3 rows.
---@param name? any
---@return table
function dm_flow_class:drift(name) end

---run:form(i) -> dm.form
---
---The vorticity of row i, a 0-form.
---@param i? any
---@return dm.form
function dm_flow_class:form(i) end

---run:npy(file) -> file name
---
---The rows as a NumPy array with fields t, w (of one number a vertex), energy, enstrophy, circulation
---and, on surfaces with handles, around; dm.load reads it.
---@param file? string
---@return string
function dm_flow_class:npy(file) end

---run:plot("w" | "psi" | column, {row=, file=, title=, azimuth=, height=, label=}) -> file name
---
---or nothing
---The vorticity (or the stream function) of a row, the last by default, as form:plot draws it; or a
---column, such as "energy", over t. In the terminal, or with file = to a .png, .svg or .pdf.
---@param w? any
---@param options? table
---@return string
function dm_flow_class:plot(w, options) end

---run:stream(i) -> dm.form
---
---The stream function of row i, div grad psi = w: 0 on the longest loop of the boundary, a constant on
---the others, or 0 at one vertex.
---@param i? any
---@return dm.form
function dm_flow_class:stream(i) end

---run:vtk(file) -> list of file names
---
---file_00001.vtk, ... for every row, with w and psi at the vertices, and as the last one
---file.vtk.series, which gives ParaView their times.
---@param file? string
---@return table
function dm_flow_class:vtk(file) end

---dm.form: a number for every cell of a degree of a mesh, made by K:form(k, ...)
---fields: mesh, degree, side ("primal", "dual"), values (a dm.vector); a[i], #a, + - * / with
---numbers, == entry by entry
---@class dm.form
local dm_form_class = {}

---a:at{i, j, ...} -> number
---
---The value on the cell with these vertices, in this order: odd orders change its sign. Of
---dual forms the dual of the cell with these vertices.
---@param options? table
---@return number
function dm_form_class:at(options) end

---a:contract(X, {method = "extrusion" | "algebraic", side = "central" | "forward" | "backward"})
---
----> dm.form
---The contraction i_X a of a primal k-form, a primal (k - 1)-form. "extrusion" (the default): the
---derivative of the integral of a, as its Whitney interpolant, over the extrusion of a cell along X,
---oriented (X, cell) (Leok, Lemma 3.5). Its value from each top cell differs: "central" takes the mean
---by shares of the dual cell, "forward" the one that X points into, "backward" the one that -X points
---into; where there is none, the nearest. "algebraic": (-1)^(k (n - k)) *(*a ^ X-flat), all dual
---(Lemma 3.6). Both are exact on constants inside.
---@param X? any
---@param options? table
function dm_form_class:contract(X, options) end

---a:d() -> dm.form
---
---The exterior derivative, exact: d d = 0. On duals of k-cells it is (-1)^k times the transpose (Leok,
---Def 3.16, 3.17, with the sign that keeps Def 3.19 right).
---@return dm.form
function dm_form_class:d() end

---a:delta{pinv=} -> dm.form
---
---The codifferential (-1)^(n (k - 1) + 1) * d * of a k-form, the adjoint of d: (d a).b = a.(delta b),
---on closed meshes or with natural boundary conditions (Leok, Def 3.19). That of primal forms is
---M^-1 d^T M and needs no orientation.
---@param options? table
---@return dm.form
function dm_form_class:delta(options) end

---a:dot(b) -> number
---
---The L2 product of two forms of one kind, sum of |*s| / |s| a(s) b(s). Raises where it overflows.
---@param b? any
---@return number
function dm_form_class:dot(b) end

---f:grad{to = "vertices" | "cells", ...} -> dm.vector_field
---
---The gradient (df)-sharp of a function, options as in a:sharp; exact for linear functions. That of a
---dual function is on cells.
---@param options? table
---@return dm.vector_field
function dm_form_class:grad(options) end

---a:hodge{pinv=} -> { exact, coexact, harmonic, potential, copotential, report }
---
---The decomposition of Hodge: a = exact + coexact + harmonic, orthogonal; exact = d potential, coexact
---= delta copotential. Degree 0 has no potential, degree n no copotential. report says which solver
---ran. Raises "zero dual volume" with the cell where delta needs an inverse, unless pinv = true, and
---where negative stars leave the harmonic forms without a norm (Leok 3.12).
---@param options? table
---@return table
function dm_form_class:hodge(options) end

---a:lie(X, {method=, side=}) -> dm.form
---
---The Lie derivative i_X d a + d i_X a, options as in a:contract; d (L_X a) = L_X (d a) (Leok, Lemma
---3.7).
---@param X? any
---@param options? table
---@return dm.form
function dm_form_class:lie(X, options) end

---a:max() -> number
---
---The largest modulus of its values.
---@return number
function dm_form_class:max() end

---a:norm() -> number
---
---The L2 norm. Raises where negative stars make its square negative.
---@return number
function dm_form_class:norm() end

---a:pair(c) -> number
---
---The value of a form on a chain, its integral: sum of c_i a(cell i), in the order of the cells.
---@param c? any
---@return number
function dm_form_class:pair(c) end

---a:plot{file=, dual=, azimuth=, height=, title=, label=} -> file name or nothing
---
---Draw a form: of degree 0 by colours, the mean over each cell; of degree 1 edges coloured by value
---per length, and arrows of its Whitney interpolant in each cell; of degree 2 by colours, value per
---area.
---Without a file in the terminal, as lines or, where cells have colours, in shades, with it through
---gnuplot to a .png, .svg or .pdf. Surfaces in space are seen from azimuth and height (radians); of
---meshes of dimension 3 the boundary is drawn.
---dual = true adds the edges of the dual cells of a surface; title, label (of the colours). size, dpi,
---font, fontsize, linewidth and ascii as of dm.plot.
---@param options? table
---@return string|nil
function dm_form_class:plot(options) end

---a:sharp{to = "vertices" | "cells", rule = "thesis", pinv=} -> dm.vector_field
---
---The field of a 1-form. A primal one to vertices (the default): the sum over the top cells s of a
---vertex v of |*v in s| / |*v| times the sum of a[v, u] grad phi_u (Leok, Def 3.23 with the gradients
---and weights that make it exact on d of linear functions); to cells: its Whitney interpolant at the
---centre. A dual one to cells: least squares over the facets of a cell. rule = "thesis" is Def 3.23 as
---printed, which is not exact on constants. Raises "zero dual volume" where one is divided by, unless
---pinv = true: 0 there.
---@param options? table
---@return dm.vector_field
function dm_form_class:sharp(options) end

---a:star{pinv=} -> dm.form
---
---The Hodge star: a primal k-form becomes a dual (n - k)-form and back; star star = (-1)^(k (n - k)).
---Raises "zero dual volume" with the cell where there is no way back, unless pinv = true: 0 there
---(Leok, Def 3.18). Values on top cells are about ascending vertices, dual 0-forms are plain
---functions: between them the sign of the coherent orientation enters.
---@param options? table
---@return dm.form
function dm_form_class:star(options) end

---a:wedge(b, {rule=}) -> dm.form, or a dm.vector
---
---The product of two forms. Both primal: rule "natural" (the default), the mean over all orders of
---vertices; anticommutative, d (a ^ b) = da ^ b +- a ^ db, no metric (Leok, Def 3.47); "metric":
---weighted by shares of dual volumes (Def 3.24), without that rule; "cup": in the order of the
---vertices, associative, not anticommutative. Both dual: "consistent" (the default), exact on constant
---forms; "thesis": Def 3.25 as printed, wrong by a factor that depends on the cells around.
---One primal of degree k, one dual of degree n - k: a dm.vector with a number for the support of every
---k-cell, whose sum() is the integral: rule "l2" a(s) b(*s), "geometric" with 1 / C(n, k), "thesis"
---with 1 / n (Def 3.35). Dual products need an orientation.
---@param b? any
---@param options? table
---@return dm.form
---@return any
function dm_form_class:wedge(b, options) end

---dm.formula: exact formulas in the invariants of a dm.differential_invariants, with rational
---coefficients and in a normal form
---#f: how many; f[i]: each by itself; fields: label (what it is the formula of); print(f) writes them,
---kappa_ss + kappa^3/2. + and - of formulas of one calculus, f == g compares normal forms.
---@class dm.formula
local dm_formula_class = {}

---f:tex() -> string
---
---The formulas for TeX's mathematics, one a line.
---@return string
function dm_formula_class:tex() end

---f:value{kappa = {kappa, kappa_s, ...}, ...} -> dm.vector
---
---The numbers that the formulas are, an entry each, where every named invariant and its derivatives
---have these values (in the order of a jet, as I.kappa[1], [2], ... in L). Of a conservation law: of
---a jet, value{x, u, u_x, ...}, the conserved vector c. Raises for an unknown invariant, and where
---numbers are missing.
---@param options? table
---@return dm.vector
function dm_formula_class:value(options) end

---dm.frame: a moving frame, made by dm.moving_frame{action=, points=, cross_section=}
---fields: action, group, points, cross_section, branch, solution, name; rho(z1, ..., zk) is the group
---element.
---@class dm.frame
local dm_frame_class = {}

---rho:check{samples=} -> number, table
---
---The worst defect at random points (default 8): equivariance rho(h z) = rho(z) h^-1, invariance and
---replacement, the corrections of shifts and of derivatives (against the graph), relative to the size
---of what is compared; and a table with each, with the worst condition number of J psi. Points that
---have no frame, or an ill-conditioned one, are passed over; an error says when that is all of them.
---@param options? table
---@return number
---@return table
function dm_frame_class:check(options) end

---rho:correction(z1, ..., zk+1) -> group element
---
---Of one point more than the frame is made of, since it compares the frame of the first k points with
---that of the last k: P = rho(z2, ..., zk+1) rho(z1, ..., zk)^-1, as the frame of the normalized
---points (Bogfjellmo thm 12): S(I) = P . I.
---@param z1? any
---@param ... any
---@return any
function dm_frame_class:correction(z1, ...) end

---rho:derivative_correction(points, velocities) -> C, changes, moved
---
---How invariants change when the points move with these velocities: C = -(J psi)^-1 J I_x (dim G
---numbers), d/dx I_j = I_j,x + psi C (a vector for each point), and I_x, the velocities moved by the
---frame (Bogfjellmo thm 4).
---@param points? any
---@param velocities? any
---@return any
---@return any
---@return any
function dm_frame_class:derivative_correction(points, velocities) end

---rho:invariantize(f) -> function,  rho:invariantize(Ld) -> dm.discrete_lagrangian
---
---or rho:invariantize{Ld=, sigma=, H0=}: f or Ld at the normalized points, f(rho z1, ..., rho zn):
---invariant whatever f is, and f itself where f was invariant. Every solver takes the new Ld; by the
---discrete Noether theorem it keeps <p, v> of every generator v to round-off. With sigma(q) or
---sigma(q0, q1) > 0 the step h is htilde sigma, for symmetries of sigma (H - H0) at the energy H0
---(default 0; Bogfjellmo 3.7): Ld must then be a function of (q0, q1, h) and the h of Ld is htilde.
---@param f? any
---@return function
---@return any
function dm_frame_class:invariantize(f) end

---rho:invariants{z1, ..., zn} -> {I1, ..., In}   or   rho:invariants(z1, ..., zn)
---
---The points moved by the frame of the first k of them: I_j = rho(z1, ..., zk) . z_j, whose entries
---are the fundamental invariants of the joint action (vectors; those the cross-section fixes are
---constant, rho:phantom()).
---@param options? table
---@return table
function dm_frame_class:invariants(options) end

---rho:phantom([n]) -> list of lists
---
---For the n (default k) normalized points: the value of each entry that is the same everywhere, false
---for one that varies.
---@param n? any
---@return table
function dm_frame_class:phantom(n) end

---rho:syzygies(points [, velocities]) -> {shift, derivative}
---
---Defects of the relations between invariants at k + 1 points or more: of S(I_J) = P . I_J1, and with
---velocities of the formula for d/dx I against the derivative of the graph. Round-off, where the frame
---is one.
---@param points? any
---@param velocities? any
---@return table
function dm_frame_class:syzygies(points, velocities) end

---rho:tangent(z1, ..., zn) -> dm.matrix
---
---The derivative of the normalized points in the points, T iota = (1 - psi (J psi)^-1 J) T Psi_rho
---(Bogfjellmo thm 3), n dim M x n dim M.
---@param z1? any
---@param ... any
---@return dm.matrix
function dm_frame_class:tangent(z1, ...) end

---rho:transversality(z1, ..., zk) -> dm.matrix, number
---
---J psi (r x r) at these points, and its condition number: J the derivative of the cross-section, psi
---the generators of the action. A frame exists near points of the section where it is regular.
---@param z1? any
---@param ... any
---@return dm.matrix
---@return number
function dm_frame_class:transversality(z1, ...) end

---dm.function: a traced function with exact derivatives, made by dm.trace or dm.derivative
---called on vectors, tables or numbers; also inside another traced function
---@class dm.function
local dm_function_class = {}

---f:bounds(lo, hi) -> lo, hi
---
---Bounds of f where its argument is anywhere between lo and hi, numbers, or lists entry by entry; of a function of several arguments both are lists of them. By interval arithmetic, rounded outwards: f never leaves them, and they close in on f as the box shrinks. A number, or a list where f gives a vector (of rows: a matrix). Infinite where f may leave its domain in the box. Raises where an end is NaN or lo > hi.
---@param lo? any
---@param hi? any
---@return any
---@return any
function dm_function_class:bounds(lo, hi) end

---f:breaks() -> dm.function or false, dm.function or false
---
---What is zero where f passes from one formula to another, as a function of the same arguments that gives a vector: the operands of abs, sign and where, a - b of min(a, b) and max(a, b); false where f is one formula, as it is in each of the cells between. Behind it what must be > 0 where f is finite: the operands of roots, logarithms and powers.
---@return dm.function|boolean
---@return dm.function|boolean
function dm_function_class:breaks() end

---f:clear(x, d, reach, fine) -> list
---
---Intervals { from1, to1, from2, to2, ... } of t in which no entry of f, a function of one vector, is zero at x + t d, |t| <= reach: by f:bounds, looked at down to intervals of fine (1 + |t|). Entries whose bounds exclude a zero hardly anywhere are left out.
---@param x? any
---@param d? any
---@param reach? any
---@param fine? any
---@return table
function dm_function_class:clear(x, d, reach, fine) end

---f:depends() -> table of tables of booleans
---
---depends[k][i]: is entry i of argument k (i = 1 for a bare number) in the expression of f?
---@return table
function dm_function_class:depends() end

---f:emit_c([name]) -> string
---
---C17 text of f: void name(const double *in, double *out); name defaults to f. Words of C, names in <math.h> and functions of the C library are refused.
---@param name? any
---@return string
function dm_function_class:emit_c(name) end

---f:factors() -> c, list of {base =, power =}
---
---f = c * product of base^power: the constant factor, and the functions whose powers are multiplied. A spring k/2 g^2 gives k/2 and { { base = g, power = 2 } }.
---@return any
---@return table
function dm_function_class:factors() end

---f:gradient(x, ...) -> dm.vector
---
---The exact derivatives by all numbers of all arguments, for a function that gives one number. Raises where they are NaN.
---@param x? any
---@param ... any
---@return dm.vector
function dm_function_class:gradient(x, ...) end

---f:graph() -> string
---
---The expression graph, one assignment a line; x1, x2, ... are the inputs, numbered through all arguments.
---@return string
function dm_function_class:graph() end

---f:hessian(x, ...) -> dm.matrix
---
---The exact second derivatives of a function that gives one number: symmetric, inputs x inputs.
---@param x? any
---@param ... any
---@return dm.matrix
function dm_function_class:hessian(x, ...) end

---f:jacobian(x, ...) -> dm.matrix
---
---The exact derivatives of every output (row) by every input (column).
---@param x? any
---@param ... any
---@return dm.matrix
function dm_function_class:jacobian(x, ...) end

---f:operations() -> integer
---
---Arithmetic operations and function calls of one evaluation.
---@return integer
function dm_function_class:operations() end

---f:terms() -> list of dm.function
---
---The terms of which f, a function that gives one number, is the sum: sums opened, products of sums multiplied out, powers of sums kept. Each is a function of the same arguments.
---@return table
function dm_function_class:terms() end

---dm.group_lagrangian: Ld(g0, g1) on a group, made by dm.discrete_lagrangian{Q=, h=, Ld=} or
---dm.discrete_lagrangian(system, {rule = "lie(2)", h=})
---fields: Q, h, name, Ld, constraint, rolling, reaction, force, or system and rule; Ld(g0, g1) is its
---value.
---@class dm.group_lagrangian
local dm_group_lagrangian_class = {}

---Ld:legendre_minus(g0, g1 [, t]) -> dm.vector of dim G entries
---
---The body momentum at g0, -D1 Ld - F1 along g0 exp(e), F1 the discrete force. t: the time at g0
---(0).
---@param g0? any
---@param g1? any
---@param t? any
---@return dm.vector
function dm_group_lagrangian_class:legendre_minus(g0, g1, t) end

---Ld:legendre_plus(g0, g1 [, t]) -> dm.vector of dim G entries
---
---The body momentum at g1, D2 Ld + F2 along g1 exp(e), F2 the discrete force. t: the time at g0
---(0).
---@param g0? any
---@param g1? any
---@param t? any
---@return dm.vector
function dm_group_lagrangian_class:legendre_plus(g0, g1, t) end

---Ld:momentum(group, g0, g1 [, {side=, action=, t=}]) -> dm.vector
---
---Noether's momentum at g1, as path:momentum: of the group itself spatial, { side = "right" } body. t:
---the time at g0 (0).
---@param group? any
---@param g0? any
---@param g1? any
---@param options? table
---@return dm.vector
function dm_group_lagrangian_class:momentum(group, g0, g1, options) end

---Ld:solver{newton=, backend=} -> dm.solver
---
---Its steps, D2 Ld(g0, g1) + D1 Ld(g1, g2) = 0, with the forces and impulses of constraints that were
---given (Leok 2.8, 5.3). Runs take q and p (the body momentum). Of a formula
---they have no energy and no velocity.
---@param options? table
---@return dm.solver
function dm_group_lagrangian_class:solver(options) end

---Ld:two_form(g0, g1 [, t]) -> dm.matrix, dim G x dim G
---
----D1 D2 Ld, row e0, column e1: the discrete symplectic form in the left-invariant frames at g0 and
---g1. t: the time at g0 (0).
---@param g0? any
---@param g1? any
---@param t? any
---@return dm.matrix
---@return any
function dm_group_lagrangian_class:two_form(g0, g1, t) end

---Ld:value(g0, g1 [, t]) -> number
---
---The same as Ld(g0, g1 [, t]): approximately the action between two elements in the time h. t: of an
---L that depends on time, when it begins (0).
---@param g0? any
---@param g1? any
---@param t? any
---@return number
function dm_group_lagrangian_class:value(g0, g1, t) end

---dm.hyperdual: a number with exact derivatives along two directions
---fields: f (value), a, b (first derivatives), ab (second); comparisons work on the value
---@class dm.hyperdual
local dm_hyperdual_class = {}

---dm.invariant_curve: a sequence of points, from problem:solve or problem:boundary
---fields: points (dm.matrix, a row each), invariants (vectors by name), multiplier, first_site, frame
---(the last group element), form; iterations, residual (of problem:boundary); #curve is the number of
---points.
---@class dm.invariant_curve
local dm_invariant_curve_class = {}

---dm.invariant_operator: a matrix of differential operators with exact coefficients, from
---calculus:operator(); fields rows, columns; print(H) writes its rows.
---@class dm.invariant_operator
local dm_invariant_operator_class = {}

---H:coefficient(i, j, k, ...) -> dm.formula
---
---The coefficient of D^k (by several variables D_1^k D_2^l ...) in entry i, j.
---@param i? any
---@param j? any
---@param k? any
---@param ... any
---@return dm.formula
function dm_invariant_operator_class:coefficient(i, j, k, ...) end

---H:tex() -> string
---
---Its rows for TeX's mathematics, one a line.
---@return string
function dm_invariant_operator_class:tex() end

---dm.invariant_problem: a variational problem in invariants of an action, by dm.invariant_problem{}
---fields: frame, action, group, N (points of L), constraints (how many)
---@class dm.invariant_problem
local dm_invariant_problem_class = {}

---problem:action_sum{u1, ..., un} -> number
---
---The sum of L over all windows of N points.
---@param options? table
---@return number
function dm_invariant_problem_class:action_sum(options) end

---problem:both_ways{points=, n=, form=} -> {difference, first, second}
---
---For problems of two points: the sequence from the two given ones by the first way, a path of the
---discrete Lagrangian q0, q1 -> L(I) in the original coordinates, and by the second, problem:solve;
---and their largest distance. They solve the same equations (docs/theory/frames.md): it is
---round-off.
---@param options? table
---@return table
function dm_invariant_problem_class:both_ways(options) end

---problem:boundary{first=, last=, n=, guess=} -> curve
---
---The sequence of n points with the given first and last ones (lists of points: N - 1 at an end fix
---all of it, fewer leave the natural conditions of the sum) that makes the sum of L stationary:
---Newton's method on all points at once, from guess(i) or the line between the ends. curve: points
---(dm.matrix), multiplier, iterations, residual. Raises a dm.failure with the points it had where it
---does not converge.
---@param options? table
---@return any
function dm_invariant_problem_class:boundary(options) end

---problem:momentum({u1, ..., u2N-2} [, multiplier]) -> dm.vector
---
---The Noether momentum J of the discrete problem at these points, <J, e_j> = sum p . v_j over the last
---N - 1 of them: the same at every window of a solution. With a constraint the multipliers of the last
---windows are given as a list (of `curve.multiplier`; row k belongs to the window that begins at point
---curve.first_site + k - 1), or follow from one point more.
---@param options? table
---@param multiplier? any
---@return dm.vector
function dm_invariant_problem_class:momentum(options, multiplier) end

---problem:solve{points=, n=, form=, every=, momentum=, frame=, multiplier=} -> curve
---
---The sequence of n points that starts with the given ones: 2 N - 2 of them, one more with a
---constraint (whose multipliers then follow; or give them). Or from N - 1 points, or a frame there,
---and the Noether momentum J (dim G numbers, problem:momentum), where the section fixes all of them.
---form = "momentum" (default) or "points", the recurrence as it is printed: the same equations, with
---other round-off (problem:stability). curve: points (dm.matrix, a row each; every `every` sites and
---the last ones), invariants (by name, vectors along the curve), multiplier (row k of the window that
---begins at point first_site + k - 1), frame (the last). A step that has no root raises a dm.failure
---with the points so far in its `path`.
---@param options? table
---@return any
function dm_invariant_problem_class:solve(options) end

---problem:stability{points=, multiplier=, steps=} -> {points, momentum, why, constant}
---
---The recurrence of the invariants linearized about the solution through these points (2 N - 2; one
---more with a constraint), for both forms of problem:solve. Of each form: re, im (its characteristic
---roots), largest (modulus), multiplicity (roots within 0.3 of 1) and spread, distance (the largest
---entry of the matrix - 1), growth (the largest entry of the matrix to the power `steps`, a power of
---two, default 128), exponent (that growth goes like n^exponent), jordan (does 1 stand in a Jordan
---block, so that errors grow by powers of n whatever h is?), why, in words. constant: do the
---invariants stay as they are from step to step, so that the roots belong to the whole run (else to
---this place of it)?
---@param options? table
---@return table
function dm_invariant_problem_class:stability(options) end

---dm.journal: what is in the file of a sweep, made by dm.journal(file)
---fields: file, kind, members (of the sweep), finished, missing (list of {first, last}), damaged
---(bytes that are no record), files (it and its parts), head (key -> text: what decides the
---result)
---@class dm.journal
local dm_journal_class = {}

---dm.journal_file: the file of a journal, made by core.journal_file(name)
---It is read and written by the modules of dm.sweep; closed when it is collected.
---@class dm.journal_file
local dm_journal_file_class = {}

---journal_file:append(bytes ...) -> true   or   nil, why
---
---Write behind the end: all of it, whatever stops Lua meanwhile.
---@param ... any
---@return boolean|nil
---@return any
function dm_journal_file_class:append(...) end

---journal_file:close()
---
---Also gives the lock back.
function dm_journal_file_class:close() end

---journal_file:read(offset, count) -> string
---
---Bytes from an offset on, fewer at the end.
---@param offset? any
---@param count? any
---@return string
function dm_journal_file_class:read(offset, count) end

---journal_file:size() -> integer
---
---Bytes.
---@return integer
function dm_journal_file_class:size() end

---journal_file:sync() -> true   or   nil, why
---
---Wait until it is on the disk.
---@return boolean|nil
---@return any
function dm_journal_file_class:sync() end

---journal_file:truncate(size) -> true   or   nil, why
---
---Cut it to so many bytes.
---@param size? any
---@return boolean|nil
---@return any
function dm_journal_file_class:truncate(size) end

---dm.lagrange_poincare: a discrete Lagrangian reduced by a group, made by dm.lagrange_poincare{group=,
---base=, h=, l=} or system:reduce{group=, rule=, h=}
---fields: group, base, h, connection, system (on Q = base x group, its L without g) and rule (of a
---formula a dm.step), for whatever
---takes these: charts, events, checkpoints of the unreduced motion.
---@class dm.lagrange_poincare
local dm_lagrange_poincare_class = {}

---lp:residual({x0, x1, x2}, {f0, f1}) -> Ver, Hor
---
---The discrete Lagrange-Poincare operators (Leok 4.7.1) at x1: Ver = mu1(x0, x1, f0) - mu0(x1, x2,
---f1), dim G numbers, and Hor = p1(x0, x1, f0) - p0(x1, x2, f1) - <Ver, A(x1)>, dim S numbers, with
---the continuous limit A of lp's connection (none: the trivial one, A = 0). Both vanish on solutions.
---@param options? table
---@param options_? any
---@return any
---@return any
function dm_lagrange_poincare_class:residual(options, options_) end

---lp:solver([{h=, newton=}]) -> dm.reduced_solver
---
---What steps the reduced equations, with the step h of lp where none is given; newton as of
---system:solver.
---@param options? table
---@return dm.reduced_solver
function dm_lagrange_poincare_class:solver(options) end

---dm.level: a system reduced at the spatial momentum J by a group that is not abelian, made by
---system:routh{group=, mu=} or system:routh{action=, section=, mu=}
---fields: group, base, mu (J), isotropy (a basis of the algebra of the isotropy group of J), orbit
---(the dimension of its coadjoint orbit), dimension (of the reduced space), system (on base x group).
---@class dm.level
local dm_level_class = {}

---level:amended_potential(x [, nu]) -> number
---
---V + (nu - c).I^-1 (nu - c)/2 at the shape x and the body momentum nu (default: J), a point of the
---coadjoint orbit of J.
---@param x? any
---@param nu? any
---@return number
function dm_level_class:amended_potential(x, nu) end

---level:connection(x) -> dm.matrix, dim G x dim S
---
---The mechanical connection I^-1 L_xix' at the shape x.
---@param x? any
---@return dm.matrix
---@return any
function dm_level_class:connection(x) end

---level:locked_inertia(x) -> dm.matrix, dim G x dim G
---
---L_xixi at the shape x, xi the body velocity.
---@param x? any
---@return dm.matrix
---@return any
function dm_level_class:locked_inertia(x) end

---level:relative_equilibria{x=, spread=, starts=} -> list of {x, nu, xi, energy, stable}
---
---Motions along the group alone: critical points of the amended potential on S x the coadjoint orbit
---of J, by Newton's method from `starts` (40) random shapes about x (default 0, with deviation spread
---= 1) and body momenta on the orbit. nu and xi: body momentum and velocity, the motion from g is g
---exp(xi t); stable: true where the second variation is definite (then it is, modulo the isotropy
---group of J), else nothing is said.
---@param options? table
---@return table
function dm_level_class:relative_equilibria(options) end

---level:routhian(x, x' [, nu]) -> number
---
---L - <nu, xi> at the velocity xi of the group that has the body momentum nu (default: J).
---@param x? any
---@param x_? any
---@param nu? any
---@return number
function dm_level_class:routhian(x, x_, nu) end

---level:solver{rule=, h=} -> dm.reduced_solver
---
---Steps the reduced system at J by a rule of system:reduce: run{x=, p=, g=, steps=}, with mu = Ad*_g J
---(g: by default the identity).
---@param options? table
---@return dm.reduced_solver
function dm_level_class:solver(options) end

---dm.level_set: the points of a cross-section of orbits, made by core.section(F, moved, inside)
---What a frame looks at when it is made: how far points are from the section, how it cuts the orbits there, and where it folds.
---@class dm.level_set
local dm_level_set_class = {}

---level_set:approach(x, goal) -> dm.vector   or nothing
---
---The algebra vector that moves the point x as close to the goal as it can, to first order: y of least squares in psi y = goal - x. Nothing where the generators psi depend on each other.
---@param x? any
---@param goal? any
---@return dm.vector|nil
function dm_level_set_class:approach(x, goal) end

---level_set:cut(x) -> J psi, condition
---
---Slopes of the section at x, which need not be on it, by the generators of the action: r x r. Its condition number in the norm of Frobenius, with rows of J as long as 1, since a section may have any units; or, if that is larger, how much the frame turns for a relative change of the points, |(J psi)^-1| |J| |x|: near a fixed point psi itself vanishes. Raises where J or psi is not finite.
---@param x? any
---@return any
---@return any
function dm_level_set_class:cut(x) end

---level_set:deflated(x, i, w) -> dm.vector   or nothing
---
---Newton's step in the algebra for the section at x, of which entry i is divided by |w|: w leads from a root, which that takes away. Nothing where J psi is singular.
---@param x? any
---@param i? any
---@param w? any
---@return dm.vector|nil
function dm_level_set_class:deflated(x, i, w) end

---level_set:distance(x, Z) -> number, condition, number
---
---|(J psi)^-1 Z| of the r values Z of the section at x: how far in the algebra that is, however the section is written; the condition number as of cut, and |(J psi)^-1|.
---@param x? any
---@param Z? any
---@return number
---@return any
---@return number
function dm_level_set_class:distance(x, Z) end

---level_set:folds(starts, nodes, most) -> list
---
---Where the sine changes its sign along curves from the starts { { x, step } ... }, each brought to F = 1 within its step: pairs { a, b } of points beside a fold, or { a, b, c, d } where a curve leaves what is inside between c and d and comes back between a and b; at most so many of them, by about so many nodes of three kinds. F is followed with steps that fit what is narrow in it, as its graph tells. A search, not a proof.
---@param starts? any
---@param nodes? any
---@param most? any
---@return table
function dm_level_set_class:folds(starts, nodes, most) end

---level_set:node(x, step) -> x, sine, inside   or nothing
---
---The point of F = 1 beside x, by Newton steps of least length, which fit a step of that length; the product of the sines of the angles of that level set with the orbits of the group, with a sign; do the conditions hold there?
---@param x? any
---@param step? any
---@return any
---@return any
---@return any|nil
function dm_level_set_class:node(x, step) end

---dm.levi_civita: a discrete Levi-Civita connection, made by K:levi_civita{frames=, rule=, on=,
---metric=}
---fields: mesh, rule ("face" or "thesis"), on ("dual": frames in top cells, or "primal": frames at the
---vertices of a surface).
---@class dm.levi_civita
local dm_levi_civita_class = {}

---A:angle() -> list of numbers
---
---The curvature of all cells of codimension 2, in their order: on a surface the deficit 2 pi - sum of
---angles with its sign, which over a closed surface sums to 2 pi chi; in higher dimensions the angle
---of the rotation round the cell, 0 to pi; false at the boundary. With on = "primal": of all
---triangles, the angles at which are those of the surface over 2 pi at every inner vertex.
---@return table
function dm_levi_civita_class:angle() end

---A:curvature(cell) -> dm.matrix, n x n
---
---The rotation round a cell of codimension 2, in the frame of the top cell round it with the least
---number, in the sense of the orientation; on a surface by the deficit. With on = "primal": round a
---triangle, in the frame of its first vertex. Raises at the boundary.
---@param cell? any
---@return dm.matrix
---@return any
function dm_levi_civita_class:curvature(cell) end

---A:frame(cell) -> dm.matrix
---
---The frame of a top cell of a mesh with points: its axes in space as columns, ambient x n.
---@param cell? any
---@return dm.matrix
function dm_levi_civita_class:frame(cell) end

---A:holonomy{i, j, ..., i} -> dm.matrix, n x n
---
---The rotation along a closed path of neighbours, top cells (on = "primal": vertices), in the frame of
---the first.
---@param options? table
---@return dm.matrix
---@return any
function dm_levi_civita_class:holonomy(options) end

---A:rotation(i, j) -> dm.matrix, n x n
---
---The rotation that takes vectors from the frame of top cell i to that of its neighbour j, as if both
---were unfolded: edges of the common face go to themselves. With on = "primal": from vertex i to
---vertex j along their edge. Raises where they are no neighbours.
---@param i? any
---@param j? any
---@return dm.matrix
---@return any
function dm_levi_civita_class:rotation(i, j) end

---A:transport({i, j, ...}, v) -> dm.vector
---
---The vector v, n numbers in the frame of the first cell, taken in parallel along a path of
---neighbours, in the frame of the last. A:frame gives the axes of a frame in space.
---@param options? table
---@param v? any
---@return dm.vector
function dm_levi_civita_class:transport(options, v) end

---dm.line_field: a field u(t, x) on a line with a Lagrangian L(u, ut, ux, x, t), made by dm.field
---fields: from, to, cells, nodes, dx, periodic, values (numbers of u), params
---@class dm.line_field
local dm_line_field_class = {}

---field:reflection({u=}) -> {left=, right=}
---
---The part of a wave that comes back from absorbing ends, (Z - c) / (Z + c) with the impedance Z^2 = -
---L_utut L_uxux at u = 0 or at the number u. Waves in a medium with dispersion come back more.
---@param options? table
---@return table
function dm_line_field_class:reflection(options) end

---field:resume(file | run) -> dm.line_solver
---
---A solver that goes on where a run ended, from run:checkpoint(file) or from the run itself:
---solver:run{steps=} gives the bits of a run that never stopped. Raises when the file is not a whole
---checkpoint or the field is another one.
---@param file? string
---@return dm.line_solver
function dm_line_field_class:resume(file) end

---field:solver{rule=, h=, free=} -> dm.line_solver
---
---rule: "cell(gauss(r))" (default r = 2) or "cell(corners)", where L is looked at in a cell; h: the
---height of a slab. free = "t": each slab's height is unknown, its energy that of the first one, whose
---height is h (Leok 5.5, 5.6); free = "x": the nodes move, too, ends stay; free = {"t", "x"}: both.
---@param options? table
---@return dm.line_solver
function dm_line_field_class:solver(options) end

---field:stability_limit(rule, {u=, t=}) -> number
---
---The height h at which the fastest oscillation about the level u (a function of x, nodes; default: 0)
---begins to grow: (-1)^k v becomes a motion there. math.huge where there is none: also of an elliptic
---L, as that of minimal surfaces, whose waves grow at any h. t: the time that L is looked at, needed
---where it depends on it. L must not depend on the sign of ut.
---@param rule? any
---@param options? table
---@return number
function dm_line_field_class:stability_limit(rule, options) end

---dm.line_run: the recorded levels of a field on a line; #run rows
---fields: u[i], p[i] (vectors, node after node), t[i], energy[i] (-dS/dh of the slab that ends at the
---row, first: of the first slab), x[i] (places of the nodes, where they move), nodes (where they are
---at the start), frozen (numbers of the nodes that stay, where others move), steps, h, rule, field,
---solver, ns_per_step
---@class dm.line_run
local dm_line_run_class = {}

---run:animate(file, {of=, title=, seconds=}) -> file name
---
---A page, name.html, in which a browser moves the line through its rows, without a network. of: "u",
---"p2", a component of boxes; seconds: how long all rows take.
---@param file? string
---@param options? table
---@return string
function dm_line_run_class:animate(file, options) end

---run:checkpoint(file) -> file name
---
---Write where the run ended, a text with all bits; field:resume(file) goes on from it.
---@param file? string
---@return string
function dm_line_run_class:checkpoint(file) end

---run:column(name) -> dm.vector
---
---One number a row: "t", "energy", "u7" or "p7" (entry 7 of u or p).
---@param name? any
---@return dm.vector
function dm_line_run_class:column(name) end

---run:conservation(function(u, x, t) | "t" | "x") -> number
---
---The largest residual of a discrete conservation law, a unit of time and length. A generator xi(u, x,
---t): around each node the sum of S_i . xi_i over the boundary of the cells that meet there, which is
---round-off where every cell has the symmetry (shifts, rotations of u). "x": the same for shifts of
---the nodes, round-off with free = "x". "t": the energy of each slab against that of the one before,
---round-off with free = "t". Else their order, 2. Nodes that are fixed, absorb, or do not move with
---the others have no law of their own.
---@param function_? any
---@return number
function dm_line_run_class:conservation(function_) end

---run:drift(name | vector) -> {per_time, error, mean, largest}
---
---Least squares slope against time of a column, or of a vector of one number a row, its standard
---error from block means, the mean, and the largest distance from the first row. At least 3 rows.
---@param name? any
---@return table
function dm_line_run_class:drift(name) end

---run:multisymplectic({seed=}) -> number, number
---
---The largest residual of the multisymplectic form formula: two first variations V, W of the run, from
---random variations of u and p at the start (entries uniform in [-1, 1]), and around each node the sum
---of dS_i(V) W_i - dS_i(W) V_i over the boundary of the cells that meet there (Leok 5.1.3). Round-off
---for every L; nodes that are fixed or absorb have no law. With free heights the times of the levels
---are held. The second number is the largest sum of such terms without signs that a cell's corner has:
---round-off is some 1e-16 of it. It is large where V and W grow, as with free nodes, which have hardly
---any mass of their own where u is nearly straight.
---@param options? table
---@return number
---@return number
function dm_line_run_class:multisymplectic(options) end

---run:npy(file) -> file name
---
---The rows as a NumPy array with fields t, energy, u, p (of boxes: t and the components): u of a row
---is an array of all nodes; dm.load reads it.
---@param file? string
---@return string
function dm_line_run_class:npy(file) end

---run:plot(name, {style=, rows=, file=, title=, size=, ...}) -> file name or nothing
---
---name: "u" or "p" ("u2" of several values), of boxes a component. style = "raster" (default): its
---values over x, across, and t, upwards; "profile", or rows = {1, 50, ...}: over x, a line for each of
---these rows. In the terminal, or with file = to a .png, .svg or .pdf through gnuplot. Sizes and
---letters as of dm.plot.
---@param name? any
---@param options? table
---@return string|nil
function dm_line_run_class:plot(name, options) end

---run:vtk(file) -> {file, ...}
---
---A file file_00001.vtk, ... for every row, the nodes as a line with their values, and as the last one
---file.vtk.series, which gives ParaView their times.
---@param file? string
---@return table
function dm_line_run_class:vtk(file) end

---dm.line_solver: a rule and a height of slabs for a field on a line, made by field:solver
---fields: field, rule, h, free ("t", "x", "tx" or nil)
---@class dm.line_solver
local dm_line_solver_class = {}

---solver:run{u=, ut= | p=, steps= | t=, every=, t0=, file=, checkpoint=} -> dm.line_run
---
---u, ut: functions of x, or lists of a number (with values = n: n numbers) for every node; ut is
---interpolated as u is, so that p_i is the integral of L_ut phi_i; p: those themselves. t: a duration.
---Rows at the start, every `every` slabs and at the end. file: a NumPy file that the rows go to as
---they come (t, energy, u, p; dm.load reads it); the run keeps the first and the last one. checkpoint:
---a file for where it ended, also where it was stopped (run:checkpoint). A level that is not found,
---and an energy that has outgrown the start by 2^104, as beyond the limit of stability, raise a
---dm.failure, whose `path` is the run so far.
---@param options? table
---@return dm.line_run
function dm_line_solver_class:run(options) end

---dm.matching: an acyclic matching of the cells of a mesh, made by core.matching(K)
---M:critical(k): the cells in no pair; chains flow along the pairs to them (Leok 3.11).
---@class dm.matching
local dm_matching_class = {}

---M:cocone(k, alpha [, values]) -> dm.vector
---
---The transpose, of degree k: h^T of alpha, values on the cells of degree k + 1 (nil for 0), and f^T of values at the critical cells of degree k.
---@param k? any
---@param alpha? any
---@param values? any
---@return dm.vector
function dm_matching_class:cocone(k, alpha, values) end

---M:core(k) -> integer
---
---How many cells of degree k collapses left over.
---@param k? any
---@return integer
function dm_matching_class:core(k) end

---M:critical(k) -> list of cell numbers
---
---The cells of degree k that are in no pair.
---@param k? any
---@return table
function dm_matching_class:critical(k) end

---M:flow(k, chain) -> table, table
---
---h and f of a chain of degree k, tables from cells to integers: the cells of degree k + 1 along which it flows, and what is left of it on critical cells. Raises where an integer leaves 64 bits.
---@param k? any
---@param chain? any
---@return table
---@return table
function dm_matching_class:flow(k, chain) end

---M:gather(k, alpha) -> dm.vector
---
---Values at the critical cells of degree k from alpha on all cells of that degree: alpha - h^T alpha on the boundary.
---@param k? any
---@param alpha? any
---@return dm.vector
function dm_matching_class:gather(k, alpha) end

---dm.matrix: rows x columns entries in one block, made by dm.matrix{{...}, ...}
---fields: rows, columns; m[i][j] from 1, #m rows, + - * with matrices, vectors, numbers
---@class dm.matrix
local dm_matrix_class = {}

---m:column(j) -> dm.vector
---
---A copy of column j.
---@param j? any
---@return dm.vector
function dm_matrix_class:column(j) end

---m:copy() -> dm.matrix
---
---A new matrix with the same entries.
---@return dm.matrix
function dm_matrix_class:copy() end

---m:det() -> number
---
---The determinant. Raises when m is not square.
---@return number
function dm_matrix_class:det() end

---m:eigenvalues() -> dm.vector, dm.vector
---
---Real and imaginary parts of the eigenvalues, sorted; the latter are zero for a symmetric matrix. Numbers only.
---@return dm.vector
---@return dm.vector
function dm_matrix_class:eigenvalues() end

---m:inverse() -> dm.matrix
---
---The inverse; m:solve(b) is more exact. Raises as m:solve does.
---@return dm.matrix
function dm_matrix_class:inverse() end

---a:modes(b) -> dm.vector, dm.matrix
---
---The values k, sorted, and in the columns of the matrix the vectors x with a x = k b x and x^T b x = 1, of two symmetric matrices of numbers, b positive definite: of a stiffness and a mass omega^2 and the modes (GSL). Raises where b is not positive definite.
---@param b? any
---@return dm.vector
---@return dm.matrix
function dm_matrix_class:modes(b) end

---m:row(i) -> dm.vector
---
---A copy of row i; m[i] is a view that can be assigned to.
---@param i? any
---@return dm.vector
function dm_matrix_class:row(i) end

---m:solve(b) -> dm.vector or dm.matrix
---
---x with m * x = b, for a vector (or table) or a matrix b with as many rows as m. Numbers by LU with row exchanges; symbols up to 4 x 4 by cofactors, larger ones by elimination. Raises when m is not square, or singular (with its condition).
---@param b? any
---@return dm.vector|dm.matrix
function dm_matrix_class:solve(b) end

---m:totable() -> table
---
---The rows as a table of tables.
---@return table
function dm_matrix_class:totable() end

---m:trace() -> number
---
---The sum of the diagonal. Raises when m is not square.
---@return number
function dm_matrix_class:trace() end

---m:transpose() -> dm.matrix
---
---The matrix with m[j][i] at i, j.
---@return dm.matrix
function dm_matrix_class:transpose() end

---dm.mesh: a simplicial complex of dimension 1 to 8, with volumes and signed duals, made by dm.mesh{...}
---fields: dimension, ambient (of its points), euler, orientable, manifold, pure, measured, dual ("circumcentric", "barycentric"), bytes
---@class dm.mesh
local dm_mesh_class = {}

---K:animate(file, {forms=, title=}) -> file name
---
---A page, name.html, in which a browser turns the mesh, without a network: colours by one of the forms
---= {name = form or field of vectors}, with their scale, arrows, edges. Of meshes of dimension 3 the
---boundary is drawn.
---@param file? string
---@param options? table
---@return string
function dm_mesh_class:animate(file, options) end

---K:betti() -> {b_0, ..., b_n}
---
---Betti numbers: entry k + 1 is the rank of the homology of degree k with integer coefficients. Exact;
---of meshes without metric, that are not orientable or no manifolds, too.
---@return table
function dm_mesh_class:betti() end

---K:boundary() -> dm.mesh, list of vertices   or nothing
---
---The mesh of the facets that have one top cell; vertices as in mesh:subcomplex. Nothing where there
---is no boundary.
---@return dm.mesh
---@return table|nil
function dm_mesh_class:boundary() end

---K:boundary_cells(k) -> list of cell numbers
---
---The cells of degree k in the boundary, ascending: the facets of one top cell only, and their faces.
---@param k? any
---@return table
function dm_mesh_class:boundary_cells(k) end

---K:boundary_marks(k) -> dm.vector
---
---1 for the cells of degree k on the boundary, 0 for the others.
---@param k? any
---@return dm.vector
function dm_mesh_class:boundary_marks(k) end

---K:boundary_sum(k, x) -> dm.vector
---
---The transpose of d: values on the cells of degree k, with signs, to their faces.
---@param k? any
---@param x? any
---@return dm.vector
function dm_mesh_class:boundary_sum(k, x) end

---K:chain(k, {{2, {i, j}}, ...}) -> dm.chain
---
---The sum of 2 [i, j] + ... of cells of degree k. The order of vertices counts: [j, i] = -[i, j].
---@param k? any
---@param options? table
---@return dm.chain
function dm_mesh_class:chain(k, options) end

---K:circumcentres(k) -> dm.matrix
---
---The circumcentres of the cells of degree k, a row each (Leok, Def 3.5); the barycentres where the mesh takes its duals from these.
---@param k? any
---@return dm.matrix
function dm_mesh_class:circumcentres(k) end

---K:coboundary(k, x) -> dm.vector
---
---d x of plain values x on the cells of degree k, on those of degree k + 1.
---@param k? any
---@param x? any
---@return dm.vector
function dm_mesh_class:coboundary(k, x) end

---K:cofaces(k, i) -> list of cell numbers
---
---The cells of degree k + 1 that have cell i of degree k as a face, ascending.
---@param k? any
---@param i? any
---@return table
function dm_mesh_class:cofaces(k, i) end

---K:component_of() -> dm.vector, count
---
---The component of every vertex, from 1 in the order of first vertices; how many there are.
---@return dm.vector
---@return any
function dm_mesh_class:component_of() end

---K:components() -> list of lists of vertices
---
---The connected components, each by its vertices, ascending.
---@return table
function dm_mesh_class:components() end

---K:cone{rule=, hub=} -> dm.cone
---
---A cone operator p of the Poincare lemma: d p + p d = 1 - projection (Leok 3.11). rule = "matching"
---(the default): in integers along an acyclic matching of the cells, of any mesh; the projection is on
---homology, torsion too. "collapse": along free faces; raises where they end before a vertex. "star":
---sums of the simplices in the geometric cone from the vertex hub. "shells": that of dm.mesh{shells=},
---whatever the points are. "linear": by pseudo-inverses, in real numbers; forms alone. hub: the vertex
---that the mesh is drawn together to (default: the first).
---@param options? table
---@return dm.cone
function dm_mesh_class:cone(options) end

---K:contract_values(k, a, X, "vertices" | "cells" [, side]) -> dm.vector, number
---
---i_X a of a primal k-form by extrusion, side "central", "forward" or "backward": see form:contract; and the number of cells of zero dual volume, where plain means are taken.
---@param k? any
---@param a? any
---@param X? any
---@param vertices? any
---@param side? any
---@return dm.vector
---@return number
function dm_mesh_class:contract_values(k, a, X, vertices, side) end

---K:count(k) -> number
---
---How many cells of degree k there are.
---@param k? any
---@return number
function dm_mesh_class:count(k) end

---K:d(k, {dual=}) -> dm.operator
---
---d of primal k-forms, entries 1 and -1; dual = true: of dual k-forms, (-1)^(n - k) times the
---transpose of d of (n - k - 1)-forms.
---@param k? any
---@param options? table
---@return dm.operator
function dm_mesh_class:d(k, options) end

---K:darcy{permeability=, source=, pressure=, flux=, solver=} -> { flux, pressure, report }
---
---Flow through a porous medium, v = -kappa grad p, div v = source. flux: the primal (n - 1)-form of v
---through the facets, exact where p is linear; pressure: a dual 0-form, at the centres of cells.
---permeability > 0: a number, a function of the point (asked at barycentres), a dual 0-form or a list
---(1); source: the same as a density, or an n-form (0). At the boundary: pressure, a number or a
---function of the circumcentre of a facet; where it gives nil, and without it, flux is the density
---that flows outward, a number or a function of the circumcentre, or an (n - 1)-form (0). Without a
---pressure the sources lose what does not flow out, the pressure has mean 0, and report.text says so.
---report: solver, unknowns, note, negative_stars of facets. Fluxes and pressures converge where the
---cells are well-centred, or nearly: barycentric duals lose that. Raises where the mesh is not
---orientable (Leok 3.1).
---@param options? table
---@return table
function dm_mesh_class:darcy(options) end

---K:deficits() -> list of numbers or false
---
---2 pi - the sum of the angles of the top cells at every cell of codimension 2; false at the boundary. On a surface they are the curvatures of the vertices. Raises where K is no manifold.
---@return table|boolean
function dm_mesh_class:deficits() end

---K:divergence_values(X, "vertices" | "cells" [, flux]) -> dm.vector
---
---The divergence at the vertices, with the flux through the boundary or without: see field:div.
---@param X? any
---@param vertices? any
---@param flux? any
---@return dm.vector
function dm_mesh_class:divergence_values(X, vertices, flux) end

---K:dual_ring(cell) -> list of top cells
---
---The dual loop round a cell of codimension 2, from the top cell with the least number on, in the sense of the orientation of K. Raises at the boundary.
---@param cell? any
---@return table
function dm_mesh_class:dual_ring(cell) end

---K:dual_volume(k) -> dm.vector
---
---The signed volumes of the dual cells (of degree n - k) of the cells of degree k: zero or negative where a centre lies outside of its simplex (Leok 3.3).
---@param k? any
---@return dm.vector
function dm_mesh_class:dual_volume(k) end

---K:dual_wedge_values(k, a, l, b [, rule]) -> dm.vector
---
---The product of a dual k-form and a dual l-form, rule "consistent" or "thesis": see form:wedge.
---@param k? any
---@param a? any
---@param l? any
---@param b? any
---@param rule? any
---@return dm.vector
function dm_mesh_class:dual_wedge_values(k, a, l, b, rule) end

---K:euler{vorticity=, circulations=, harmonic=} -> dm.euler
---
---The flow of an ideal fluid on a surface: w' = -*(d psi ^ d w), div grad psi = w (as in
---K:laplace_beltrami()), with the product of each triangle in thirds to its corners. vorticity: a
---0-form, a function of the point, a list or a number. Closed surfaces face outwards; others as
---K:orientation() says. psi is a constant on every loop of the boundary, so that no fluid crosses it:
---0 on the longest of each component, on the others, the holes, what keeps the circulation round them
---(Kelvin). circulations: a number for every hole, in the order of their first vertices, the integral
---of the velocity along it with the fluid on the left; left out, psi is 0 on all loops at the start.
---On a closed component the mean of w has no psi and stays where it is. Round handles there are flows
---without psi: w' = -*(beta ^ d w), beta = d psi + sum b_k eta_k, eta_k an orthonormal basis of them,
---b_k' the integral of w eta_k ^ beta. harmonic: the velocity at the start as a 1-form, the function
---that K:form(1, f) takes or a list, of which its part round the handles is taken; left out, none.
---Where a surface touches itself in a vertex they are left out, and the report's note says so. Raises
---where the mesh is not orientable, and where a vertex has no positive dual area.
---euler:solver{h=}:run{t=} goes on; the energy |beta|^2/2, the enstrophy |w|^2/2 and the circulation,
---the sum of *v w, are kept to round-off (Arakawa 1966).
---@param options? table
---@return dm.euler
function dm_mesh_class:euler(options) end

---K:faces(k, i) -> list of cell numbers
---
---The k + 1 faces of cell i of degree k: face j is opposite to its vertex j and stands in its boundary with the sign (-1)^(j - 1).
---@param k? any
---@param i? any
---@return table
function dm_mesh_class:faces(k, i) end

---K:field{form=, L=, values=, on=, fixed=, absorbing=, force=, data=, massless=, ...} -> dm.system
---
---A field: a form of degree `form` (0 unless given) that moves by the Lagrangian L(A, V, t, params) of
---the form A and its rate V, sums over cells: A:dot(B), A:d(), A:wedge(B), A:map(f), A:star(), K:sum.
---The kinetic energy is V:dot(V) / 2 or any sum of m v^2 / 2. values: numbers a cell (default 1); on =
---dm.S(m): unit vectors of m + 1 numbers, by rule = "rattle". fixed: cells that stay where they start,
---"boundary", a list of their numbers or a function of the position of their centre that is true
---there; other boundaries are natural (free). absorbing: boundary cells, named like those of fixed or
---{ "boundary", c = 2 }, that let waves of speed c (default 1) out: the force -c V with the star of
---the boundary, exact for waves that come at a right angle, up to (cos a - 1)/(cos a + 1) for those at
---the angle a; facets all of whose cells are named absorb. force(A, V, t, params): a form f beside L,
---whose virtual work is f:dot(dA) (friction -g * V, driving cos(t) * J), a list of one for every
---value, or a list of numbers that are added to dL/dq; it reads A and V on the cell itself. Forces of
---V are stepped by verlet, rattle, rules of stages and explicit Runge-Kutta, others by every splitting
---too. massless =
---"eliminate": values without kinetic energy, as on cells whose star is 0, follow from their own
---equation, one by one (two that meet in L are refused), by kicks and drifts; one that L does not have
---at all stays where it starts. So grids, and cubes cut into tetrahedra, have Yee's scheme. data =
---{ name = form }: numbers by name in the cells of K:sum. A field is a system: it has solvers, charts,
---ensembles and checkpoints; q, v and p of a start are forms, functions of the position, lists, or
---of several values a list or matrix with a row for every cell, as K:points();
---path:form(i) is row i as a form, path.q[i] its values, cell after cell; p = dL/dV. Columns "energy"
---and "gauss" (the largest change of d^T p at free cells, where L has A only in dA). Raises where free
---cells have no kinetic energy, or a negative one.
---@param options? table
---@return dm.system
function dm_mesh_class:field(options) end

---K:find{i, j, ...} -> number, sign   or nothing
---
---The number of the cell with these vertices, and 1 or -1: the parity of their order.
---@param options? table
---@return number
---@return any|nil
function dm_mesh_class:find(options) end

---K:flat_values(X, "vertices" | "cells", "primal" | "dual") -> dm.vector, number
---
---The 1-form of a field of vectors, a matrix with a row for every vertex or top cell: see field:flat; and the number of edges of zero dual volume, where plain means are taken.
---@param X? any
---@param vertices? any
---@param primal? any
---@return dm.vector
---@return number
function dm_mesh_class:flat_values(X, vertices, primal) end

---K:flip_values() -> dm.vector, dm.vector, number
---
---The triangles of mesh:make_delaunay, three vertices each; the squares of the lengths of the edges opposite to these; how many flips it took.
---@return dm.vector
---@return dm.vector
---@return number
function dm_mesh_class:flip_values() end

---K:folds() -> count, text of the first
---
---How many facets of a mesh in a space of its own dimension have both of their top cells on the same side: there a cell is turned inside out, and the mesh lies over itself. Volumes, stars and solutions are those of the folded surface then, not of what it covers.
---@return any
---@return string
function dm_mesh_class:folds() end

---K:form(k, values | f, {dual=, order=, chart=}) -> dm.form
---
---A form of degree k from its values, in the order of the cells (dual = true: of the duals of the
---cells of degree n - k); or from f(x, y, ...), which gives the components of a smooth k-form, in
---increasing order of their coordinates (dx dy, dx dz, dy dz): its integrals over the cells, about
---ascending vertices, or over the dual cells (the de Rham map, Leok 3.5). order: the degree of
---polynomials whose integrals are exact, 5 by default, at most 21. chart(x, y, ...) gives the list of
---the point of a curved surface that belongs to a point of the mesh: cells are integrated over as it
---bends them, such as p / |p| for a sphere. Raises where f gives what is not finite.
---@param k? any
---@param values? any
---@param options? table
---@return dm.form
function dm_mesh_class:form(k, values, options) end

---K:frame_places(cell [, frames]) -> dm.matrix, n + 1 x n
---
---The vertices of a top cell in its frame, a row each, the first at 0.
---@param cell? any
---@param frames? any
---@return dm.matrix
---@return any
function dm_mesh_class:frame_places(cell, frames) end

---K:frame_rotation(i, j [, frames [, printed]]) -> dm.matrix, n x n
---
---The rotation from the frame of top cell i to that of its neighbour j; frames: n n numbers a cell, the axes of its frame as columns in the cell's own one; printed = true: the least rotation of the normals.
---@param i? any
---@param j? any
---@param frames? any
---@param printed? any
---@return dm.matrix
---@return any
function dm_mesh_class:frame_rotation(i, j, frames, printed) end

---K:fundamental() -> dm.chain
---
---The sum of all top cells in their coherent orientation; forms of the highest degree are integrated
---over it. Raises where the mesh is not orientable.
---@return dm.chain
function dm_mesh_class:fundamental() end

---K:generators(k) -> list of dm.chain
---
---Cycles of degree k whose classes are a basis of homology without torsion, as many as the Betti
---number says.
---@param k? any
---@return table
function dm_mesh_class:generators(k) end

---K:harmonic(k, {pinv=}) -> list of dm.form
---
---A basis of the forms with d h = 0 and delta h = 0 of degree k, of norm 1 and orthogonal, as many as
---the Betti number: with natural conditions at the boundary. Also where stars are negative, as long as
---the forms have a norm. Raises "zero dual volume" with the cell where delta needs an inverse, unless
---pinv = true.
---@param k? any
---@param options? table
---@return table
function dm_mesh_class:harmonic(k, options) end

---K:homology(k, {relative=}) -> {betti, torsion, generators, of_torsion}
---
---The homology of degree k in integers, Z^betti and a Z/d for every d of the list torsion, each
---dividing the next. generators: a list of betti chains; of_torsion: a chain for each entry of
---torsion, d times which is a boundary. relative = "boundary" or a list of simplices: of chains
---modulo those of that part.
---@param k? any
---@param options? table
---@return table
function dm_mesh_class:homology(k, options) end

---K:incidence(k) -> dm.sparse
---
---d of k-forms as a matrix of 1 and -1: a row for every (k + 1)-cell, a column for every k-cell. K:d(k) is the operator.
---@param k? any
---@return dm.sparse
function dm_mesh_class:incidence(k) end

---K:integrals(k, f [, dual [, order [, chart]]]) -> dm.vector
---
---The de Rham map on plain values: see mesh:form. f(x, y, ...) gives the components of a k-form, in increasing order of their coordinates; order: the degree of polynomials that the quadrature (Grundmann & Moeller) integrates exactly, from 1 to 21, 5 by default.
---@param k? any
---@param f? any
---@param dual? any
---@param order? any
---@param chart? any
---@return dm.vector
function dm_mesh_class:integrals(k, f, dual, order, chart) end

---K:laplace_beltrami({fixed=, pinv=}) -> dm.operator
---
---div grad of functions: negative, u'' on a line, -K:laplacian(0) (Leok 3.9, with div grad where div
---curl is printed).
---@param options? table
---@return dm.operator
function dm_mesh_class:laplace_beltrami(options) end

---K:laplacian(k, {part = "up" | "down", fixed = "boundary" | {cells}, pinv=}) -> dm.operator
---
---The Laplacian of de Rham and Hodge, d delta + delta d of k-forms: positive, so that functions have
----u'' on a line (K:laplace_beltrami() has the other sign). part = "up": delta d alone, "down":
---d delta. fixed: forms that are 0 on the boundary, or on these k-cells and their faces. Where nothing
---is fixed, conditions are natural. Raises "zero dual volume" with the cell where an inverse star is
---needed, unless pinv = true: 0 there (Leok 3.9).
---@param k? any
---@param options? table
---@return dm.operator
function dm_mesh_class:laplacian(k, options) end

---K:levi_civita{frames=, rule=, on=, metric=} -> dm.levi_civita
---
---The discrete Levi-Civita connection of a simplicial manifold of dimension 2 or more (Leok 4.7.3): a
---frame in every top cell, a rotation for every dual edge. frames(cell): a rotation (an element of
---SO(n); on surfaces an angle will do) of the cell's own frame, which is Cholesky's of its edges.
---rule: "face" (default), rotations that keep the common face, or "thesis", the least rotation of one
---normal to the other, which is wrong for frames of no common chart [E10]. on = "primal", of oriented
---surfaces: frames at vertices, rotations along edges, curvature of triangles. metric(cell): the
---matrix e_i . e_j of the edges from the first vertex of a top cell, in place of points or lengths;
---faces must agree. Raises where the top cells round a cell of codimension 2 make no loop or fan.
---@param options? table
---@return dm.levi_civita
function dm_mesh_class:levi_civita(options) end

---K:link(k, i) -> dm.mesh, list of vertices   or nothing
---
---The link of cell i of degree k: of every cell around it the face that it leaves out; vertices as in
---mesh:subcomplex. Nothing where it is no face of another cell.
---@param k? any
---@param i? any
---@return dm.mesh
---@return table|nil
function dm_mesh_class:link(k, i) end

---K:lumped(k, x) -> dm.vector
---
---Densities x on the cells of degree k as loads of their vertices: x_s times what of s lies next to the vertex.
---@param k? any
---@param x? any
---@return dm.vector
function dm_mesh_class:lumped(k, x) end

---K:make_delaunay() -> dm.mesh
---
---The surface in other triangles: edges between two triangles whose dual is negative are flipped until
---there are none, by lengths alone (Bobenko & Springborn 2007). Vertices, and the shape of the
---surface, stay; a mesh in the plane keeps its points, one in space becomes a mesh of lengths, as new
---edges run within its surface. Boundary edges stay. Raises where the result is no simplicial
---complex.
---@return dm.mesh
function dm_mesh_class:make_delaunay() end

---K:open_star(k, i) -> table of lists of cell numbers
---
---The cells that have cell i of degree k as a face, with the cell itself, by degree: star[d].
---@param k? any
---@param i? any
---@return table
function dm_mesh_class:open_star(k, i) end

---K:orientation() -> dm.vector   or nothing
---
---1 or -1 for every top cell: the coherent orientation against the ascending order.
---@return dm.vector|nil
function dm_mesh_class:orientation() end

---K:oriented(x) -> dm.vector
---
---Values on the top cells times the signs of K:orientation(): what is about ascending vertices becomes a function, and back. Raises where the mesh is not orientable.
---@param x? any
---@return dm.vector
function dm_mesh_class:oriented(x) end

---K:plot{file=, dual=, azimuth=, height=, title=} -> file name or nothing
---
---Draw a mesh.
---Without a file in the terminal, as lines or, where cells have colours, in shades, with it through
---gnuplot to a .png, .svg or .pdf. Surfaces in space are seen from azimuth and height (radians); of
---meshes of dimension 3 the boundary is drawn.
---dual = true adds the edges of the dual cells of a surface; title, label (of the colours). size, dpi,
---font, fontsize, linewidth and ascii as of dm.plot.
---@param options? table
---@return string|nil
function dm_mesh_class:plot(options) end

---K:points() -> dm.matrix
---
---The points of the vertices, a row each. Raises where there are none.
---@return dm.matrix
function dm_mesh_class:points() end

---K:poisson{f=, fixed={boundary=, [vertex]=}, flux=, solver=} -> dm.form, report
---
---u with delta d u = f, f a density: a number, a function of the point, a 0-form or a list (0). fixed:
---values on the boundary (the same kinds), and at single vertices; flux: du/dn outward through the
---rest of the boundary, a number or a function of the point, asked at circumcentres of facets (0;
---nil is 0).
---Where nothing is fixed the mean of the load is taken away, u has mean 0 and report.text says so.
---Factors are kept: the next solve with the same vertices fixed is cheap. report: solver, unknowns,
---note where the matrix is not positive definite and of barycentric duals, negative_stars of edges.
---solver = "cholesky", "lu", "gradients" or "dense" asks for one. Order 2 in the L2 norm, also where
---stars of edges are negative; none with barycentric duals, which err by some percent on any mesh.
---@param options? table
---@return dm.form
---@return any
function dm_mesh_class:poisson(options) end

---K:potential(a) -> dm.form
---
---A form b with db = a. Raises "not closed", with the cell where |da| is above 1e-10 max |a|, or "not
---exact", with a generator of homology and the period of a over it. It is the cocone of K:cone() (Leok
---3.11).
---@param a? any
---@return dm.form
function dm_mesh_class:potential(a) end

---K:quality() -> table
---
---negative[k], zero[k], k from 0: how many dual volumes of cells of degree k are below 0, or 0 (below 1e-12 of the largest of that degree); well_centred: every circumcentre lies inside its simplex; least: the least barycentric coordinate of a circumcentre; delaunay: no facet between two top cells has a negative dual volume.
---@return table
function dm_mesh_class:quality() end

---K:save(file, {forms=}) -> file name
---
---The mesh as .off or .obj (surfaces and lines, read back with the same bits) or .vtk (dimension 1 to
---3) with forms = {name = form}: those of degree 0 at the points, those of the highest degree as
---densities, others of degree 1, and of degree 2 in space (those that flow through the faces), as
---vectors in the cells. Cells are written in their coherent orientation, and behind them those of
---lower degree that are faces of none.
---@param file? string
---@param options? table
---@return string
function dm_mesh_class:save(file, options) end

---K:sharp_values(a, "primal" | "dual", "vertices" | "cells" [, thesis [, pinv]]) -> dm.matrix
---
---The field of vectors of the values of a 1-form: see form:sharp.
---@param a? any
---@param primal? any
---@param vertices? any
---@param thesis? any
---@param pinv? any
---@return dm.matrix
function dm_mesh_class:sharp_values(a, primal, vertices, thesis, pinv) end

---K:simplices(k) -> table of lists of vertices
---
---The cells of degree k as ascending lists of vertex numbers, from 1, in lexicographic order: the order of all that lives on them.
---@param k? any
---@return table
function dm_mesh_class:simplices(k) end

---K:skeleton(k) -> dm.mesh, list of vertices
---
---The mesh of all cells of degree k and their faces; vertices as in mesh:subcomplex.
---@param k? any
---@return dm.mesh
---@return table
function dm_mesh_class:skeleton(k) end

---K:star(k, {dual=, pinv=}) -> dm.operator
---
---The Hodge star of primal k-forms, a diagonal of |*s| / |s|; dual = true: of dual k-forms, its
---inverse times (-1)^(k (n - k)). Raises "zero dual volume" with the cell, unless pinv = true: 0
---there.
---@param k? any
---@param options? table
---@return dm.operator
function dm_mesh_class:star(k, options) end

---K:star_cells(k, i, d) -> list of cell numbers
---
---The cells of degree d >= k that have cell i of degree k as a face, or are it.
---@param k? any
---@param i? any
---@param d? any
---@return table
function dm_mesh_class:star_cells(k, i, d) end

---K:star_values(k, x, "dual" | "primal" [, pinv]) -> dm.vector
---
---Plain values x on the cells of degree k to their duals, by |*s| / |s|, or back, by (-1)^(k (n - k)) |s| / |*s| (Leok, Def 3.18), without signs of orientation. Raises where a dual volume is below 1e-12 of the largest, unless pinv: 0 there.
---@param k? any
---@param x? any
---@param dual? any
---@param pinv? any
---@return dm.vector
function dm_mesh_class:star_values(k, x, dual, pinv) end

---K:star_weights(k) -> dm.vector, zeros, negatives, first zero, first negative
---
---|*s| / |s| of the cells of degree k, exactly 0 where the dual is below 1e-12 of the largest; how many are 0 and negative, and the first cells that are.
---@param k? any
---@return dm.vector
---@return any
---@return any
---@return any
---@return any
function dm_mesh_class:star_weights(k) end

---K:stationary{form=, values=, on=, fixed=, term=, x=, data=, iterations=} -> dm.form, report
---
---A form of degree `form` (0 unless given) at which term(A), a sum over cells as the L of K:field has
---it (K:sum, A:dot(B), A:d(), ...), is stationary: harmonic functions and maps, elastic bodies.
---values: numbers a cell (1); on = dm.S(m): unit vectors of m + 1 numbers. fixed: cells that keep the
---values of the start x: "boundary", a list of their numbers or a function of the position. x: a form,
---a function of the position or a list (0; on spheres it must be given). Newton's method with the
---sparse Hessian, downhill where that is not positive definite; a step that would make the term NaN or
---infinite, as a cell turned inside out does, is cut. The result is a list of forms where a cell has
---several values. report: code ("ok", "no_convergence"), text, value, iterations (at most 100, or as
---given), residual (the norm of the gradient), kind ("minimum", "saddle", "degenerate": some
---directions have no curvature, as where a constant may be added). Raises where the term is
---not finite at the start, with the cell that is inverted, and where neighbours are opposite on a
---sphere.
---@param options? table
---@return dm.form
---@return any
function dm_mesh_class:stationary(options) end

---K:subcomplex{[k] = {cell, ...}} -> dm.mesh, list of vertices
---
---The closure of cells, given by their numbers in every degree: a mesh of its own with the metric of
---this one, its vertices numbered anew, in the same order; and the list of what they are here. Nothing
---where there are no cells.
---@param options? table
---@return dm.mesh
---@return table
function dm_mesh_class:subcomplex(options) end

---K:sum(k, f, A, ...) -> number
---
---The sum of f(a, ..., cell) over the cells of degree k. a: the values of the form A on the faces of
---the cell, a dm.vector in ascending order; a number where A has the degree k; a list of vectors where
---A has several values. Numbers and scalars of L, such as t, are passed on. cell: volume, star (dual
---volume over volume), lengths of its edges (a vector), points of its vertices (a list of vectors),
---and the data of the field by name. In L of K:field and in the term of K:stationary f is called once,
---with symbols, and the sum stays a loop whatever the size of the mesh; on forms of numbers it is a
---loop in Lua. Every entry of the gradient is written by one place in a fixed order.
---@param k? any
---@param f? any
---@param A? any
---@param ... any
---@return number
function dm_mesh_class:sum(k, f, A, ...) end

---K:tangent_values(X, "cells") -> dm.matrix, number
---
---Vectors in the top cells without what points out of these cells; and the largest length that went.
---@param X? any
---@param cells? any
---@return dm.matrix
---@return number
function dm_mesh_class:tangent_values(X, cells) end

---K:transfer(M, k [, rule]) -> dm.sparse   or nil, number, number
---
---The matrix that takes the values of k-forms on K to those on M: see dm.remesh; or nil, the first cell of M of which not all is covered by K, and how much of it is.
---@param M? any
---@param k? any
---@param rule? any
---@return dm.sparse|nil
---@return number
---@return number
function dm_mesh_class:transfer(M, k, rule) end

---K:vector_field(f | vectors, {on = "vertices" | "cells"}) -> dm.vector_field
---
---The field f(x, y, ...) -> { vx, vy, ... } at the vertices (the default) or at the centres of the top
---cells; or a list of vectors. On cells of a surface in space what points out of the cell is taken
---away; X.projected is the largest length that went (Leok, Def 3.20, 3.21).
---@param f? any
---@param options? table
---@return dm.vector_field
function dm_mesh_class:vector_field(f, options) end

---K:volume(k) -> dm.vector
---
---The volumes of the cells of degree k, in units of length to the power k; of vertices 1.
---@param k? any
---@return dm.vector
function dm_mesh_class:volume(k) end

---K:wedge_values(k, a, l, b [, rule]) -> dm.vector
---
---The product of plain values a on k-cells and b on l-cells, on (k + l)-cells; rule "natural" (the default), "metric" or "cup": see form:wedge.
---@param k? any
---@param a? any
---@param l? any
---@param b? any
---@param rule? any
---@return dm.vector
function dm_mesh_class:wedge_values(k, a, l, b, rule) end

---K:weighted_dual(k, x) -> dm.vector
---
---The dual volumes of the cells of degree k, the part in every top cell S times x_S.
---@param k? any
---@param x? any
---@return dm.vector
function dm_mesh_class:weighted_dual(k, x) end

---dm.msfem_solution: finite elements for (a u')' = f, u = 0 at the ends
---fields: u (dm.vector, at all nodes), x (nodes), elements ("multiscale", "linear")
---@class dm.msfem_solution
local dm_msfem_solution_class = {}

---s:exact(x) -> number
---
---The solution itself, int F/a - (int_all F/a)/G_all G(x), G and F the integrals of 1/a and f.
---@param x? any
---@return number
function dm_msfem_solution_class:exact(x) end

---s:plot{file=, ...} -> file name or nothing
---
---The exact solution, that of the elements and its values at the nodes; options as of dm.plot.
---@param options? table
---@return string|nil
function dm_msfem_solution_class:plot(options) end

---s:shape(i, x) -> number
---
---The shape function of node i at x: 1 at the node, 0 at all others and beyond its elements.
---@param i? any
---@param x? any
---@return number
function dm_msfem_solution_class:shape(i, x) end

---s:value(x) -> number
---
---The finite element solution at x. Raises outside of the nodes.
---@param x? any
---@return number
function dm_msfem_solution_class:value(x) end

---dm.multigrid: nested meshes and what leads from one to the next, made by dm.multigrid{K1, ..., Kn}
---fields: meshes (the coarsest first), fixed; #mg levels
---@class dm.multigrid
local dm_multigrid_class = {}

---mg:matrix(level) -> dm.sparse
---
---The matrix of a level, 1 the coarsest: d^T M_1 d of the finest mesh, P^T A P below.
---@param level? any
---@return dm.sparse
function dm_multigrid_class:matrix(level) end

---mg:prolong(a) -> dm.form
---
---A function of one mesh on the next finer one: P a, exact where a is linear on each cell.
---@param a? any
---@return dm.form
function dm_multigrid_class:prolong(a) end

---mg:restrict(b) -> dm.form
---
---A load of one mesh (a number for each vertex, such as A u) on the next coarser one: P^T b.
---@param b? any
---@return dm.form
function dm_multigrid_class:restrict(b) end

---mg:solve(b, {cycles = 100, sweeps = 2, tolerance = 1e-12, start=}) -> dm.form, report
---
---u with d^T M_1 d u = b on the finest mesh, by V-cycles of damped Jacobi sweeps (2/3, so many before
---and behind). b: a 0-form, a density f as in K:poisson; a dual form of the highest degree, its
---integrals; or numbers for the vertices. u is 0 on the boundary (see fixed); where nothing is held
---the mean of b goes and u has mean 0. tolerance: of the residual, beside b. report: cycles, factor
---(by which a cycle makes the residual less, in the mean), residual, residuals, code, text.
---@param b? any
---@param options? table
---@return dm.form
---@return any
function dm_multigrid_class:solve(b, options) end

---dm.operator: a linear map of forms as a sparse matrix, made by K:d, K:star, K:laplacian, ...
---fields: mesh, from, to ({ degree, side }), matrix (dm.sparse), nonzeros (entries that are not 0);
---A * form, A * B, A + B, A - B, number * A
---@class dm.operator
local dm_operator_class = {}

---A:eigen(m, {above=, near=}) -> { values, forms, residuals, solver, note }
---
---m eigenvalues of a self-adjoint operator, in the product of the forms that it maps, and eigenforms
---of norm 1: those nearest to 0, with near = x nearest to x, with above = x the least beyond x; the
---best first. Fewer where there are no more. residuals: |A a - lambda a|, and an eigenvalue is no
---farther away. note: values are round-off of the largest ones, as in a mesh of very thin cells, duals
---are barycentric, with which eigenvalues do not converge, or the farthest of all is left out. Up to
---300 unknowns (1200 where many are asked for) by dense rotations, else by Lanczos iterations, which
---need dm/sparse.so (libsuitesparse-dev, libarpack2-dev). Raises where x is an eigenvalue, where the
---operator is not self-adjoint, and where negative stars leave the forms without a norm. u' = -A u,
---with A = K:laplacian(0) heat or the gradient flow of |du|^2/2, has the solution sum_k exp(-values[k]
---t) (forms[k] . u0) forms[k].
---@param m? any
---@param options? table
---@return table
function dm_operator_class:eigen(m, options) end

---dm.pair: an element (a, b) of the pair groupoid, made by dm.pair(a, b)
---fields: source, target; g * h = (a, c) for g = (a, b) and h = (b, c), g == h
---@class dm.pair
local dm_pair_class = {}

---g:inverse() -> dm.pair
---
---(b, a) of (a, b): g * g:inverse() is the identity (a, a).
---@return dm.pair
function dm_pair_class:inverse() end

---g:is_identity() -> boolean
---
---Is it (a, a)?
---@return boolean
function dm_pair_class:is_identity() end

---g:join(h, ...) -> dm.pair_tuple
---
---The tuple of composable pairs g, h, ...: raises where a target is not the next source.
---@param h? any
---@param ... any
---@return dm.pair_tuple
function dm_pair_class:join(h, ...) end

---dm.pair_tuple: composable pairs, a discrete curve of p + 1 points, made by dm.pair(q0, ..., qp)
---fields: points; tuple[i] is pair i, #tuple = p
---@class dm.pair_tuple
local dm_pair_tuple_class = {}

---t:inverse() -> dm.pair_tuple
---
---The curve back: the inverses in the other order.
---@return dm.pair_tuple
function dm_pair_tuple_class:inverse() end

---t:product() -> dm.pair
---
---The product of all of its pairs: from the first point to the last.
---@return dm.pair
function dm_pair_tuple_class:product() end

---dm.path: what a run recorded, one row per kept step
---fields: t[i] (number), q[i], p[i] (vectors), lambda[i], impulses[i] (of runs that recorded them), a (the quantity that dm.euler_poincare carries along, at the start), columns (names), any column by its name (path.q1, path.p_x), steps, h, rule, system, solver, title, units, ns_per_step, events (of a run that looked for some), file (of a run that wrote its rows), sem (of sem rules: energy, fallbacks, defect, least, largest h, conditioning); #path rows.
---Printed, it says how far the energy was off at its rows ("at these rows" where not every step was kept), from when on where it jumped to another level, and whether it drifts: "no drift" within three standard errors, "drift" beyond six, nothing between or with fewer than 12 rows; "slope" where rows are sparser than steps, which may show a fast oscillation as a slow one. path:drift gives the numbers.
---@class dm.path
local dm_path_class = {}

---path:animate(file, {points=, dim=, draw=, rods=, bodies=, trail=, plots=, title=, frames=, t=, fps=, seconds=, size=}) -> file name
---
---Write a page (.html, of its own: no network) with the moving system, its trail, energy and momentum
---over time, a slider and a speed. In a notebook it stands there without a file.
---Points are coordinates by name (x, y, z; x1, y1, x2, ...), else pairs or triples of q (dim = 2 or
---3) without its angles, unless nothing else is left; or points = { {"x1", "y1"}, ... }, columns; or
---draw = function(q, t) return { points = { {x, y}, ... }, rods = { {1, 2}, ... } } end, called for
---every frame. rods: pairs of points, 0 is the origin; of a system with constraints those distances
---that stay.
---On a group every factor that turns (SO(3), SE(3)) is a body, with its axes and the trail of a point
---on the third one, placed by the next factor R^3 or R^2; its ellipsoid is that of its inertia. bodies
---= { { factor = 1, at = 2 or {x, y, z} or function(q, t), shape = "ellipsoid" | "box" | "cylinder",
---inertia = {I1, I2, I3}, mass = or size = half lengths, centre = {x, y, z}, points = body points with
---a trail, joints = without }, ... } says otherwise; of other systems with pose = function(q, t)
---return R, {x, y, z} end. Points of bodies follow those of draw in the numbers that rods have.
---trail: how much time it shows; plots: {
---"energy", "theta", dm.SO(2), { name, numbers } }; t = {from, to} and frames: which rows (default: as
---many as move smoothly, at most 1500).
---A file .mp4 or .gif is a film, drawn by gnuplot and joined by ffmpeg: fps = 25 frames a second for
---seconds = 10, size = {640, 480} pixels; each frame is the recorded row that is nearest to its
---time.
---Of a field on a mesh: options {of = "q" | "p", title=, seconds=}; the mesh is coloured row by row,
---and where its values are points of its own space (an elastic body) it moves.
---@param file? string
---@param options? table
---@return string
function dm_path_class:animate(file, options) end

---path:checkpoint(file) -> file name
---
---Write where the run ended: the state with its low-order parts, what the rule keeps from step to step, rule, step and time, as a text with all bits. dm.resume(file, system) goes on from it bit for bit. Raises when the file cannot be written; an old one is replaced only by a whole one.
---@param file? string
---@return string
function dm_path_class:checkpoint(file) end

---path:column(name) -> dm.vector of #path entries
---
---A column by its name (see path.columns; "time" and "energy" too).
---@param name? any
---@return dm.vector
function dm_path_class:column(name) end

---path:csv(file) -> file name   or   path:csv() -> string
---
---The rows as comma-separated values under a line of column names, 17 significant digits: reading them
---back gives the same bits. Raises when the file cannot be written.
---@param file? string
---@return string
function dm_path_class:csv(file) end

---path:drift(name | vector) -> {per_time, error, mean, largest}
---
---Least squares slope of a column, of "energy" or of any vector of #path entries against time: slope per unit of time, its standard error from block means, the mean, and the largest distance from the first row.
---@param name? any
---@return table
function dm_path_class:drift(name) end

---path:energy() -> dm.vector of #path entries
---
---v . dL/dv - L at every row, v from p by the inverse Legendre transform.
---@return dm.vector
function dm_path_class:energy() end

---path:form(i [, "q" | "p"]) -> dm.form
---
---Row i of the path of a field as a form, its momenta with "p"; a list of forms where a cell has
---several values.
---@param i? any
---@param q? any
---@return dm.form
function dm_path_class:form(i, q) end

---path:frequency(name [, {above=}]) -> omega
---
---The strongest frequency (radians per unit of time) of a column of a run that resolves it, by its
---spectrum under Hann's window: the fast one for dm.multiscale (Leok 5.7.3: ten periods of 200 steps
---give four digits). above: only frequencies above this one. Rows must be equally far apart. Raises
---where there are fewer than 3 periods, or fewer than 3 rows in a period.
---@param name? any
---@param options? table
---@return any
function dm_path_class:frequency(name, options) end

---path:mass(q [, t]) -> dm.matrix, dim Q x dim Q
---
---d2L/dv2 at (q, v = 0, t) by the kernels of the run, where system:mass traces L again; t: default that of the first row. Raises where it is not finite.
---@param q? any
---@param t? any
---@return dm.matrix
---@return any
function dm_path_class:mass(q, t) end

---path:momentum(group [, {block=, side=, action=}]) -> dm.vector   or   (generator) -> dm.vector   or   path:momentum(action)
---
---Noether's momentum map at every row: of a group by its standard action on blocks of coordinates (dm.SO(2), dm.SO(3), dm.R(n); a matrix #path x dim G when dim G > 1), or p . xi(q) of a generator xi(q), a Lua function that returns dim Q numbers. Of coordinates that are angles (dm.T), or whose kinetic energy is another where they are turned (r and phi), groups that act on vectors are refused. On a group G, of G itself the spatial momentum ({ side = "right" }: the body momentum), of SO(3), SO(2) and R(n) that of rotations and translations of space, of any group that of its action on elements, { action = function(k, g) ... end }; a generator returns the body velocity of its field.
---@param group? any
---@param options? table
---@return dm.vector
function dm_path_class:momentum(group, options) end

---path:multipliers() -> dm.matrix, #path x constraints
---
---system:multipliers at every row (v from p): forces of the constraints along the path, to the order
---of the rule. Columns of it are plotted as path:plot("t", M:column(1)); a run records them with
---record = { "lambda" }.
---@return dm.matrix
---@return any
function dm_path_class:multipliers() end

---path:noether{generator=, divergence=, scale=} -> dm.vector
---
---p . xi - E tau - B - c S at every row, a number each: what Noether's theorem keeps of a symmetry
---generator(q, t) -> xi [, tau] (tau: how time moves) whose prolongation changes L by dB/dt + c L,
---divergence(q, t) = B, scale = c (S: the action from the first row, by the rule's own quadrature).
---action:invariant finds B and c. Momenta of symmetries of Q alone are path:momentum.
---@param options? table
---@return dm.vector
function dm_path_class:noether(options) end

---path:npy(file) -> file name
---
---The rows as a NumPy array with named fields: numpy.load(file)["q1"] is the column q1. The bits of
---the numbers are kept. Raises when the file cannot be written.
---Of a field on a mesh: fields t, q, p, where a row of q is an array of all values.
---@param file? string
---@return string
function dm_path_class:npy(file) end

---path:phases() -> {total, dynamic, geometric}
---
---How far the group variable has come along a path of a reduced system. On SO(3) or SU(2), alone or
---as one factor of Q: dm.vectors of a number a row, about the spatial momentum J and not wrapped.
---total is the turn of g_k S g_0^-1 about J, S the shortest rotation from the first body momentum to
---that of row k; dynamic sums what turn a step has beyond the shortest rotation between its body
---momenta; geometric is minus the area of their geodesic polygon, closed to the start; the sum is
---exact for the rows that are kept. Raises where J is not kept or rows are half a turn apart. Of an
---abelian group each is a dm.matrix, #path x dim G: dynamic, h sum_j b_j I^-1 (mu - c) over the
---stages, what the momentum alone would turn, and geometric, -h sum_j b_j A x', the holonomy of the
---mechanical connection along the shapes (Marsden, Montgomery & Ratiu 1990).
---@return table
function dm_path_class:phases() end

---path:plot(x, y | {y1, y2, ...}, {file=, title=, log=, style=, names=, equal=, ...}) -> file name or nothing
---
---Plot columns of a path: names ("t", "q1", "p1", "energy" ...) or vectors of #path numbers. With no
---arguments every q (or all that was watched) against t; path:plot("q1") is q1 against t. Options as
---in dm.plot: without `file` in the terminal, with it to a .png, .svg or .pdf.
---Two positions of one unit, or two entries of rotations, get equal axes unless equal = false; where
---one range is 4 times the other or more they do not, which is written below the plot: equal = true
---makes them equal all the same.
---Of a field on a mesh: path:plot("q" | "p", {row=, file=, title=, azimuth=, height=}) draws a row,
---the last by default, as form:plot does; columns such as "energy" as above.
---@param x? any
---@param y? any
---@param options? table
---@return string|nil
function dm_path_class:plot(x, y, options) end

---path:reconstruct{theta=} -> dm.path
---
---From a path of a reduced system to the one of the unreduced system over it: the group variable is
---the integral of I^-1(mu - ...) by the rule's own quadrature, theta + h sum_j b_j theta'_j over the
---stages of every step, at every row that was kept. theta: the group variable at the first row, a
---number or list (default 0). Of dm.euler_poincare: path:reconstruct{q = g0}, the path on the group
---that begins at the element g0.
---@param options? table
---@return dm.path
function dm_path_class:reconstruct(options) end

---path:series(x, y, name) -> { x =, y =, name = } for dm.plot and dm.figure
---
---x, y: a column name ("t", "q1", "p1", "energy" ...) or a vector of #path numbers; name: text of the
---legend. Labels and units come along.
---@param x? any
---@param y? any
---@param name? any
---@return table
function dm_path_class:series(x, y, name) end

---path:velocity([row]) -> dm.matrix, #path x dim Q, or dm.vector of one row
---
---The velocity at every row, or at that one, from p by the inverse Legendre transform.
---@param row? any
---@return dm.matrix
---@return any
---@return any|dm.vector
function dm_path_class:velocity(row) end

---path:vtk(file) -> list of file names
---
---Of a field on a mesh: file_00001.vtk, ... for every row with q and p (q1, q2, ... of several
---values), forms of degree 1, and of degree 2 in space, as vectors in the cells, and as the last one
---file.vtk.series, which gives ParaView their times.
---@param file? string
---@return table
function dm_path_class:vtk(file) end

---path:worst("constraint" | "rolling") -> number
---
---The largest |g(q, t)| or |phi(q, v, t)| at the rows (v from the momentum) and, where the rule looks at it in every step, over all of its steps.
---@param constraint? any
---@return number
function dm_path_class:worst(constraint) end

---dm.prismal: slices of time, made by dm.prismal{t0, t1, ...}, the rule of a field's solver
---fields: times (a dm.vector)
---@class dm.prismal
local dm_prismal_class = {}

---dm.prismal_solver: steps of a field between uneven slices, made by
---field:solver{rule = dm.prismal{...}}
---fields: system, rule, slices
---@class dm.prismal_solver
local dm_prismal_solver_class = {}

---solver:run{q=, v= | p=, every=, file=, checkpoint=} -> dm.path
---
---Steps of a field over all slices of dm.prismal, from q and v or p at the first one. Rows at the
---start, at every slice (every = k: every k-th) and at the last. file: a .npy file that the rows go to
---as they come (the path keeps the last). checkpoint: a file for where it ended, also where it was
---stopped; dm.resume goes on from it, and from the path, over the slices that are left or over others,
---dm.resume(from, field, { rule = dm.prismal{...} }), with the bits of a run that never stopped.
---@param options? table
---@return dm.path
function dm_prismal_solver_class:run(options) end

---dm.random: random numbers by counting, made by dm.random(seed)
---field: seed
---@class dm.random
local dm_random_class = {}

---random:normal(i, k [, mean, deviation]) -> number
---
---Number k (0 to 2^32 - 1) of member i, normal with that mean (0) and standard deviation (1); independent of uniform(i, k).
---@param i? any
---@param k? any
---@param mean? any
---@param deviation? any
---@return number
function dm_random_class:normal(i, k, mean, deviation) end

---random:uniform(i, k [, a, b]) -> number
---
---Number k (0 to 2^32 - 1) of member i, uniform in (0, 1) or between a and b. The same arguments give the same number, in any order of asking.
---@param i? any
---@param k? any
---@param a? any
---@param b? any
---@return number
function dm_random_class:uniform(i, k, a, b) end

---dm.reduced_path: a run of a reduced system, of solver:run{x=, p=, mu=} of dm.lagrange_poincare
---fields: x, p, mu (a dm.vector a row: shape, its momentum, body momentum), f (f[k] leads from row k
---to the next, f = g_k^-1 g_(k+1)), t, path (the dm.path on Q, for functions that take one), #run
---rows; after reconstruct{g=} also g, elements. Other fields and methods are those of path.
---@class dm.reduced_path
local dm_reduced_path_class = {}

---path:phases() -> {total, dynamic, geometric}
---
---Of a run on SO(3): how far the body has turned about its spatial momentum J, a dm.vector of a number
---a row, not wrapped: see path:phases of dm.path.
---@return table
function dm_reduced_path_class:phases() end

---path:reconstruct{g=} -> dm.reduced_path
---
---The run on Q over a reduced one that begins at the element g (default: the identity), g_(k+1) = g_k
---f_k: the same rows, with elements .g and a dm.path .path on Q.
---@param options? table
---@return dm.reduced_path
function dm_reduced_path_class:reconstruct(options) end

---dm.reduced_solver: what steps a reduced system, made by lp:solver()
---fields: solver (the dm.solver on Q, for what is not listed here), system, rule, h; its other methods
---are those of solver.
---@class dm.reduced_solver
local dm_reduced_solver_class = {}

---solver:ensemble{members=, x=, p=, mu=, g=, momentum=, steps=, ...} -> dm.ensemble
---
---Members of the reduced system: x, p, mu, g and momentum as of solver:run, each a value for all or a
---function of the member's number. The dm.ensemble is one on Q.
---@param options? table
---@return dm.ensemble
function dm_reduced_solver_class:ensemble(options) end

---solver:run{x=, p=, mu=, steps=, ...} -> dm.reduced_path
---
---A run of the reduced equations from the shape x, its momentum p and the body momentum mu; or from g=
---and momentum= J, the spatial momentum, mu = Ad*_g J: the level of J reduced by a group that is not
---abelian (Routh); or from v = (x', xi), where the system has velocities. g is the element at the
---start (default: the identity). Other options are those of a dm.solver: t, every, at, watch, events.
---@param options? table
---@return dm.reduced_path
function dm_reduced_solver_class:run(options) end

---dm.remesh: takes forms of a mesh to another mesh of the same set, made by dm.remesh(K, M)
---fields: from, to (meshes), rule; T(a) is the form on the other mesh
---@class dm.remesh
local dm_remesh_class = {}

---T:matrix(k) -> dm.sparse
---
---The matrix that takes values of k-forms: a row for each k-cell of the second mesh, a column for each
---of the first.
---@param k? any
---@return dm.sparse
function dm_remesh_class:matrix(k) end

---dm.root: a function that is only known by an equation, made by dm.root{equations=, start=}
---called on numbers, vectors or tables; also inside of traced functions and of other roots
---@class dm.root
local dm_root_class = {}

---f:inverse(x, ...) -> dm.matrix
---
---The inverse of dF/dy at the root: entry (i, k) is how much unknown i moves where equation k is off by one. On numbers.
---@param x? any
---@param ... any
---@return dm.matrix
function dm_root_class:inverse(x, ...) end

---f:traced(x, ...) -> number or dm.vector
---
---f(x, ...) of the equations as they were traced: they are not called to see whether the trace says what they do, nor whether what they read has changed since. For many calls of one root, of which each costs less, where the result is looked at anyway.
---@param x? any
---@param ... any
---@return number|dm.vector
function dm_root_class:traced(x, ...) end

---f:value(x, ...) -> number
---
---S(y, x, ...) at the point y where it is stationary. Its first derivatives are those of S at fixed y, so a Lagrangian that is such a value costs no derivative of y.
---@param x? any
---@param ... any
---@return number
function dm_root_class:value(x, ...) end

---dm.rule: a rule with coefficients of its own, made by dm.galerkin and its like, for rule = in a solver
---fields: name, order, symmetric, symplectic, linear (false: curves by a method that is not linear in the values of f, or with substeps that are chosen), own (true: of the functions of a dm.step)
---@class dm.rule
local dm_rule_class = {}

---dm.scaling: what a step costs as things grow, made by dm.scaling{system=, start=, ...}
---fields: points (a list of {rule, size, ns, setup}), rules (names)
---@class dm.scaling
local dm_scaling_class = {}

---scaling:exponent(rule) -> number or nil
---
---The cost grows like size^exponent, by least squares over the upper half of the sizes; nil with fewer
---than two of them.
---@param rule? any
---@return number|nil
function dm_scaling_class:exponent(rule) end

---scaling:plot{file=, ...} -> file name or nothing
---
---Cost over size, both logarithmic, a line for every rule with its exponent. Options as in dm.plot.
---@param options? table
---@return string|nil
function dm_scaling_class:plot(options) end

---scaling:table() -> string
---
---A line for every rule and size: ns a step (of a member), the set-up in ms; then the exponents, what
---failed, and the load of the machine.
---@return string
function dm_scaling_class:table() end

---dm.scene: what is watched, how exactly, for how long; made by dm.scene{system=, q=, v=, watch=, ...}
---fields: best (the choice), candidates (all that was measured), profile (the costs, to be saved)
---@class dm.scene
local dm_scene_class = {}

---scene:animate(file, {...}) -> file name
---
---Run the scene and write a page with what is watched as a moving picture; options as in
---path:animate.
---@param file? string
---@param options? table
---@return string
function dm_scene_class:animate(file, options) end

---scene:run([{at=, every=, file=}]) -> path of what is watched
---
---The chosen model by the chosen rule and step, with as many rows as straight lines between them need
---to stay inside the tolerance, or those asked for as in solver:run. Raises where lines need more than
---10^6 rows: give `at`. Beside all of dm.path it has error_estimate: the largest error of what is
---watched, at the rows and, of a plain run, on straight lines between them, with what is left of doubt
---in the reference (where columns have tolerances of their own: in parts of these); and model,
---rule.
---@param options? table
---@return any
function dm_scene_class:run(options) end

---scene:why() -> string
---
---The ladder: each model with dimension, operations, error in what is watched, each rule with step,
---cost and error, and why it was kept or dropped; the reference, the check, the choice, and what the
---least model costs where another one is cheaper.
---@return string
function dm_scene_class:why() end

---dm.schroedinger: a Schroedinger equation on a ring or between walls
---fields: x (points), weight (of integrals), V (at `nodes`), nodes, N, from, to, hbar, m, g, space,
---boundary
---@class dm.schroedinger
local dm_schroedinger_class = {}

---wave:current(psi) -> j, density
---
---hbar/m Im(psi* psi_x) and |psi|^2 at the points, dm.vectors: density_t + j_x = 0. The current of the
---phase (Leok 5.8, signs corrected) is -hbar times both. psi: a complex vector or a function of x.
---@param psi? any
---@return any
---@return any
function dm_schroedinger_class:current(psi) end

---wave:eigen(k) -> {values, psi}
---
---The k least energies of the linear equation, ascending, and their states, real dm.complex_vectors of
---norm 1: by dense rotations up to 1200 points, beyond it, up to 4096, by Lanczos iterations, which
---need dm/sparse.so (libsuitesparse-dev, libarpack2-dev). k: 6 unless given. Raises where g is not 0:
---energies then depend on how much there is of the state.
---@param k? any
---@return table
function dm_schroedinger_class:eigen(k) end

---wave:equation() -> dm.wave_equation
---
---What stands behind it in C, made when it is first asked for.
---@return dm.wave_equation
function dm_schroedinger_class:equation() end

---wave:observe(psi) -> {norm, energy, x, momentum}
---
---Of a state: the integral of |psi|^2; that of psi* (T + V) psi + g/2 |psi|^4; means of x and p.
---@param psi? any
---@return table
function dm_schroedinger_class:observe(psi) end

---wave:resume(file | path) -> dm.wave_solver
---
---The solver of a run, which goes on from where that ended, bit for bit: run it without psi. From a
---path or from the file that path:checkpoint wrote. Raises where the wave is another one.
---@param file? string
---@return dm.wave_solver
function dm_schroedinger_class:resume(file) end

---wave:solver{rule=, h=, norm=, unstable=, plan=, wisdom=} -> dm.wave_solver
---
---What steps a wave. rule: "strang" (half a kick by V + g |psi|^2, a drift, half a kick) and every
---composition and splitting of dm.rules(), "yoshida(4)"; "gauss(s)", "crank-nicolson" = "gauss(1)", by
---the modes of H up to 1200 points and by iteration for what these do not have (g, s <= 24); "slab",
---Gauss with a degree in time that resolves every mode, or "slab(s)"; "two-step", Leok's linear
---functions in time, with norm = true the multiplier that keeps the norm, with unstable = true beyond
---its limit. plan = "measure": FFTW chooses by timing, kept in the file wisdom = (unless given, in
---the user's cache), so that the next run has the same bits. Raises, with the reason, on rules that
---are not unitary.
---@param options? table
---@return dm.wave_solver
function dm_schroedinger_class:solver(options) end

---wave:stability_limit(rule) -> h, exact
---
---The largest step that does not let modes grow: sqrt(3) hbar/E_max for "two-step"; for kicks and
---drifts with g that of resonances, pi hbar/T_max (Weideman & Herbst 1986); infinite for all that is
---unitary. exact = false: an estimate.
---@param rule? any
---@return any
---@return any
function dm_schroedinger_class:stability_limit(rule) end

---dm.section: the crossings of a surface by one run or several, made by solver:section{g=, ...}
---fields: orbits (each {x, y, t, path, failure}: vectors with a number for each crossing), count (of
---all crossings), failures (how many runs ended early), xlabel, ylabel; #section orbits.
---@class dm.section
local dm_section_class = {}

---section:plot{file=, title=, ...} -> file name or nothing
---
---Draw the crossings, one colour an orbit; options as in dm.plot.
---@param options? table
---@return string|nil
function dm_section_class:plot(options) end

---section:series() -> list of { x =, y =, name = } for dm.plot and dm.figure
---
---The crossings of each orbit that has some.
---@return table
function dm_section_class:series() end

---dm.simplicial_map: a map of vertices that takes simplices to simplices, made by
---dm.simplicial_map(K, L, vertices)
---fields: from, to (meshes), vertices
---@class dm.simplicial_map
local dm_simplicial_map_class = {}

---f:homology(k) -> list of rows of integers
---
---The matrix of the map between the homologies of degree k without torsion, in the bases
---K:generators(k): row i, column j tells how often image j goes round generator i. In the highest
---degree of closed oriented manifolds it is the degree of the map.
---@param k? any
---@return table
function dm_simplicial_map_class:homology(k) end

---f:pull(a) -> dm.form
---
---The form on the first mesh whose value on a cell is that of a on its image, 0 where vertices
---coincide. It commutes with d and with the natural wedge product (Leok 3.13).
---@param a? any
---@return dm.form
function dm_simplicial_map_class:pull(a) end

---f:push(c) -> dm.chain
---
---The image of a chain: cells whose vertices coincide give nothing. d commutes with it.
---@param c? any
---@return dm.chain
function dm_simplicial_map_class:push(c) end

---dm.solver: a system, a rule and a step, made by system:solver{rule=, h=}
---fields: system, rule, h, order, tolerance, max_iterations, sums, backend (nil: the usual one); own_time: what a step covers of t is known when it is taken; lift: of a system on a group, "collective" or "homogeneous" where the rule steps it in coordinates
---@class dm.solver
local dm_solver_class = {}

---solver:backward_error{q=, v= | p=, steps= | t=, t0=} -> {amplitude, order, drift, error, ...}
---
---The energy along the run next to that of half the step over the same time. A symplectic rule of
---order p keeps a modified energy H + h^p H_p + ... up to exponentially small terms (Hairer, Lubich &
---Wanner IX.8): H then stays within `amplitude` = h^p max |H_p - mean| of its mean, order = log2 of
---the ratio of the two amplitudes is p, and what the modified energy itself drifts is the slope
---`drift` of H per unit of time, with its standard error `error`. energy, mean: at the start and
---along the run; finer: the same figures with h/2.
---@param options? table
---@return table
function dm_solver_class:backward_error(options) end

---solver:ensemble{members=, q=, v=, p=, steps=, t=, t0=, h=, vary=, threads=, every=, rows=, watch=, gaps=, project=, energy=, a=, beside=} -> dm.ensemble
---
---Run `members` starts side by side for `steps` steps or the duration t. q, and v or p (q alone where L is linear in v): functions of the member's number (from 1) that return dim Q numbers, or a matrix or table with a row per member. vary = { name = }: numbers among the params of the system that every member has for itself, as functions or tables too; where the potential alone depends on them and the rule is explicit all share one kernel, else members that follow each other with the same ones do. h: a step of its own for every member, as a function or a table (with t each takes as many as cover it). Explicit rules step 4 or 8 members side by side in vector registers, neighbours with one step, implicit rules also those with steps of their own, where L does not depend on t (environment variable DMLUA_LANES = 0, 1, 4 or 8: at most so many). threads: default one per core (always one for hyper-dual functions, and for fields by implicit rules). Each member ends with the same bits as a run of its own, whatever the number of threads; one that fails does so alone (status[i], failures()). The ends are kept, 32 dim Q bytes a member; every = k keeps a row every k steps, rows = n about n rows of each, watch = { ... } rows of chosen numbers, as in solver:run (gaps, too): ensemble:path(i). energy: that the steps of sem(s, quadrature(r)) of all members are to have. a: the quantity that all members of a reduced system carry along (dm.euler_poincare). beside = { watch = { ... }, compared = names, flows = { { e =, i =, horizon =, rows =, bound = }, ... } }: columns beside those of a resolved flow for every member (false: none), member i of the ensemble e, as in ensemble:departure, up to the time `horizon`, at about so many rows, until one is beyond its bound (a list as `compared`; left out: none), then at the rows that are kept; no row of this stays: ensemble:followed(i). Raises dm.failure with the ensemble as its path on Ctrl-C.
---journal = "file": finished ranges of members are kept in this file; the same call goes on where it
---stopped, and one that is finished is only read. The file is refused where the system, the rule, h,
---steps or members are others, or where a member that is run again differs. ensemble.journal is
---{ file, found, run }: members read from the file, members run now. dmlua --part k/n runs a part of
---the members (docs/sweeps.md).
---Members of a reduced system (system:routh) are looked through for jumps: status[i] is "collapse",
---"pole" or "edge" where a run of its own would have been refused, failures() names the step; q and p
---are those of its end. All members are, where these take up to 20000 steps in all, else those whose
---energy at the end has moved by more than 2 %, the 256 that moved most. Not looked through are
---ensembles that only watch, of more than 1000 members with less than 500 steps each, and long ones
---with vary, a force or a time in L.
---@param options? table
---@return dm.ensemble
function dm_solver_class:ensemble(options) end

---solver:fold{q=, v= | p=, t0=, up_to=} -> {h, fold, q1, why}
---
---Up to which step does an implicit step from this state have a solution? The solution q1 of p + D1
---Ld(q, q1) = 0 is followed from small h to up_to (default 256 steps of the solver) and the fold,
---where two solutions meet, found where det D1D2 Ld vanishes; h is infinite when there is none. fold =
---false with a finite h: Newton's method gives up although the matrix is regular, as where the chart
---of a group ends, at half a turn. Stage rules and discrete Lagrangians, without constraints and
---forces; lie(s) on groups. t0: the time of the start (0).
---@param options? table
---@return table
function dm_solver_class:fold(options) end

---solver:lyapunov{q=, v= | p=, steps= | t=, exponents=, every=, u=, dp=, t0=} -> {exponent, megno, t}
---
---Follow one tangent vector (u, dp; default: one without symmetry) by the exact tangent map of the
---rule. exponent: ln |growth| / t, the largest Lyapunov exponent, per unit of time, of the last row;
---megno: the mean of MEGNO (Cincotta & Simo 2000), which tends to 2 on a regular orbit and to exponent
---* t / 2 on a chaotic one. A row is taken every `every` steps (default: 1000 rows). history: {t,
---exponent, megno} of all rows; q, p, t: the end. exponents = k, from 1 to 2 dim Q: k vectors that are
---kept orthonormal; exponents: their rates of growth, the largest first, and sum of them, the rate at
---which volumes of that dimension grow (Benettin et al. 1980). Vectors are rescaled as they grow, so
---that no time is too long. Lengths are taken in units of the masses at the start, under constraints
---of what of dp these leave, so that volumes are those of Liouville: all exponents of a symplectic
---rule have the sum 0. On a group they are changes g^-1 dg and that of the body momentum.
---@param options? table
---@return table
function dm_solver_class:lyapunov(options) end

---solver:measured_order{q=, v= | p=, t=, t0=} -> {order, error, h}
---
---The order of the rule, measured on this run: log2 of the ratio by which the ends after the time t of
---runs with steps of h, h/2 and h/4 approach each other. error: the last difference. Raises where that
---is round-off.
---@param options? table
---@return table
function dm_solver_class:measured_order(options) end

---solver:modified_energy{q=, v= | p=, steps=, points=} -> {energy, H, mean, amplitude, drift, ...}
---
---What a symplectic rule keeps in place of H: the modified energy along a run, from int p dq of the
---polynomials through 2 points + 1 (default 13) neighbouring points and the discrete Lagrangian of
---every step, (int p dq - Ld)/h; right to h^(2 points), so for steps that resolve the motion. energy,
---H, t: vectors, the modified energy and H at the same rows; amplitude: the largest distance of the
---modified energy from its mean; drift: its slope per unit of time with its standard error: round-off
---for a symplectic rule. Needs a Lagrangian without time, rolling and forces; under constraints all
---rules that take a mass of any kind (not rattle); on groups all but rotations(k).
---@param options? table
---@return table
function dm_solver_class:modified_energy(options) end

---solver:multipliers{q=, v= | p=, steps= | t=, t0=} -> {stable, why, largest, re, im, matrix, closes}
---
---The eigenvalues of the exact tangent map over a run: the Floquet multipliers where the run is one
---period of a periodic orbit (closes: the distance of its end from its start), or one step of a
---relative equilibrium. A symplectic rule has them in pairs m, 1/m; stable: none has a modulus above 1
---by more than round-off allows (multipliers 1 of the period and of symmetries are double, and known
---to the root of round-off only).
---@param options? table
---@return table
function dm_solver_class:multipliers(options) end

---solver:report() -> table
---
---What the last run cost: rule, order, h, backend, operations (of the kernels, per evaluation), trace_ms, compile_ms (trace to kernels), steps, ns_per_step, solves (step equations), newton (iterations), matrices (of these, those that took their matrix anew), newton_per_step, evaluations; substeps_per_step where they are chosen; condition: the condition number of the step equation of a dm.multiscale, defect: what its curves miss of the momentum at their ends, drift: of the energy, over the largest v . L_v; unseen: how often a controlled step would have jumped over something; with constraints: constraint and rolling, the largest |g| and |phi| at the end of a step.
---@return table
function dm_solver_class:report() end

---solver:reversal{q=, v= | p=, steps= | t=, t0=} -> number
---
---Run, then run L(q, -v, -t), or H(q, -p, -t), from the end with the momentum reversed: the largest
---distance from the start in any entry of q (on a group that of elements) or p. Round-off, as far as
---the orbit lets it stay so, for a symmetric rule; the error of the step for any other.
---@param options? table
---@return number
function dm_solver_class:reversal(options) end

---solver:run{q=, v=, p=, q0=, q1=, p0=, steps=, t=, at=, every=, t0=, project=, watch=, record=, gaps=, events=, file=, checkpoint=, energy=, most=} -> dm.path
---
---Run `steps` steps of h, or as many as cover the duration t, from q and v, from q and the momentum p, or from two positions q0, q1 one step apart (each dim Q numbers, in a list or by the names of coordinates, q = { x = 1, y = 0 }); keep the start, one state in `every` (default 1) and the end, or the states at the growing times `at` (by a shorter step on the side, which leaves the run as it is); t0 (default 0) is the time of the start. With constraints the start must lie on them, and its velocity be tangent: project = true moves it to the nearest such state in the metric of the mass. The Lagrangian is traced anew, so changed upvalues are picked up.
---watch = { "q1", "energy", r = function(q, v, t, p) ... end }: rows hold t and these numbers instead of q and p (a function that gives several has the columns r1, r2, ...); "lambda" stands for system:multipliers at the state; on groups entries of the element are watched, too ("R33", of factor k "R33_k"). record = { "lambda", ... }: such columns beside q and p. NaN in a column ends the run; gaps = true keeps it. record = { "impulses" }: multipliers of the steps, in units of momentum: what the end of one step and the start of the next give the momentum at the row, along the rows of constraint and rolling (reaction); so the first and the last row have a half of it. For rules of one stage that is the multiplier of the discrete Euler-Lagrange equations; over h it is a force to order 2; rules with s constraint intervals (gauss(s), lobatto(s + 1)) share h among the nodes of a Lobatto rule, so over 2 h / (s (s + 1)). "inner": those between as well, of the step that begins at the row. path.lambda[i], path.impulses[i] are vectors. file = "rows.npy": rows go there as they come, the path keeps the last one, failure.path those that a full disk did not take (of fields on meshes t, q and p, a row of q an array). events = { name = function(q, v, t, p) ... end } or { name = { g = f, direction = "up" | "down", stop = true } }: zeros of these functions, by steps of fitting length in between, as path.events[i] = { name, t, q, p }; stop ends the run there; a zero that is touched but not crossed, or two of one function within a step, are not seen. checkpoint = file or { file =, every = seconds }: written while it runs (every minute) and at its end, for dm.resume. energy: that the steps of sem(s, quadrature(r)) are to have, instead of that of the first. most: steps that a rule with a time of its own may take to the last of the times `at`. Raises dm.failure with the path so far when a step cannot be solved, the state stops being finite, a column is NaN, more steps are needed, or on Ctrl-C.
---A failure of a field on a mesh says where h is beyond its limit of stability, and which cell turned
---inside out; a field without forces whose energy has outgrown the start by 2^104 fails, too.
---A failure of a reduced system (system:routh) has a reason: "collapse" (the locked inertia vanishes;
---also raised where a step jumped through such a shape), "pole" or "edge" of the coordinates. Jumps
---are looked for at every step of runs of up to 20000 steps, whatever rows are kept (steps between
---rows are made again), in longer ones at the rows that are kept and, where these are suspect, between
---them.
---@param options? table
---@return dm.path
function dm_solver_class:run(options) end

---solver:section{g= | period=, q=, v= | p=, starts=, t= | steps=, t0=, direction=, x=, y=, xlabel=, ylabel=, every=, project=} -> dm.section
---
---The Poincare section of a run: where it crosses the surface g(q, v, t, p) = 0; g may be the name of
---a coordinate, "q1", of an angle of dm.T(n) up to whole turns; period = T in its place: each period
---of a driven system from t0 on (a stroboscope). direction: "up" (g grows; the default), "down" or
---"both". starts = { {q =, v =}, {q =, p =}, ... }: several runs, one of which may fail. x, y: what is
---read off a crossing, names of columns ("q2", "p2", "t", on groups "R31"; angles from -pi to pi) or
---functions of (q, p, t); left out: another coordinate than g and its momentum. Crossings are found by
---steps of fitting length, with the accuracy of the rule; two within one step are not seen.
---section:plot() draws them. every = k keeps rows of the runs, orbits[i].path.
---@param options? table
---@return dm.section
function dm_solver_class:section(options) end

---solver:singularities{q=, v= | p=, steps= | t=, t0=} -> {worst, t, q, places, change, why, failure}
---
---Does d2L/dv2 lose a value on the way? Its condition at the rows of a run (at most 4000): the largest
---value there and at the start over the least, on the velocities that constraints allow; the worst and
---where; places: {t, condition} where it exceeds 1e4; change: the times between which its inertia, the
---number of negative values, changes, and the motion ends; failure: the code that ended the run, if
---one did. why names the coordinate that loses its inertia.
---@param options? table
---@return table
function dm_solver_class:singularities(options) end

---solver:solvability{q=, v= | p=, energy=} -> { solvable, h, C, order, energy, why }
---
---Can a sem rule step from this state with this energy (left out: that of a step of the solver's h)?
---h: the lengths from h/5 to 4 h whose discrete energy it is, growing. C: the limit of (E_d - H)/h^p
---for h to 0, p = order, H the energy of the state: short steps have energies on that side of H only.
---why: a sentence. Raises for rules that do not choose their steps.
---@param options? table
---@return table
function dm_solver_class:solvability(options) end

---solver:step{q=, v=, p=, q0=, q1=, t0=, project=} -> q, p   or   solver:step(q0, q1) -> q2
---
---One step from a state, or the next position after two positions one step apart.
---@param options? table
---@return any
---@return any
function dm_solver_class:step(options) end

---solver:step_tangent{q=, v= | p=, t0=} -> dm.matrix, q, p
---
---The exact derivative of one step in (q, p), 2 dim Q x 2 dim Q, by the rule itself, and the end of the step: for rules of curve segments without constraints. A choice of substeps is held. solver:tangent is for all rules and many steps.
---@param options? table
---@return dm.matrix
---@return any
---@return any
function dm_solver_class:step_tangent(options) end

---solver:symplecticity{q=, v= | p=, steps= | t=, t0=} -> number
---
---The largest entry of M^T J M - J, M the exact tangent map of the run (solver:tangent), relative to
---the square of the largest entry of M where that is above 1: round-off for a symplectic rule, the
---defect of any other. With constraints: of the two-form on the vectors that are tangent to them.
---@param options? table
---@return number
function dm_solver_class:symplecticity(options) end

---solver:tangent{q=, v= | p=, steps= | t=, t0=} -> dm.matrix, q, p
---
---The exact derivative of the flow of the rule, d(q, p at the end)/d(q, p at the start), 2 dim Q x 2
---dim Q, not a difference: the rule steps the prolonged Lagrangian dL . (u, w), whose step is the
---tangent of the step. Also the end of the run. With constraints the start must lie on them, and so
---must each column: use tangent vectors of solver:lyapunov instead. On a group the changes are g^-1 dg
---and that of the body momentum (right trivialization: dg g^-1, of the spatial one); with constraints
---or rolling it is the derivative of the step after the nearest changes that these allow.
---@param options? table
---@return dm.matrix
---@return any
---@return any
function dm_solver_class:tangent(options) end

---dm.space: a manifold or group, made by dm.R(n), dm.T(n), dm.S(n), dm.SO(n), dm.SE(n), dm.SL(n), dm.GL(n), dm.Sp(n), dm.SU(2), dm.Heisenberg(n), dm.product, dm.semidirect, dm.group
---fields: name, n, dimension, chart (can a system live on it with these coordinates), parts (of a product)
---@class dm.space
local dm_space_class = {}

---G:Ad(g, xi) -> dm.vector
---
---The adjoint action g xi g^-1 on the algebra.
---@param g? any
---@param xi? any
---@return dm.vector
function dm_space_class:Ad(g, xi) end

---G:ad(xi, eta) -> dm.vector
---
---The bracket [xi, eta] of the algebra, of matrices X Y - Y X.
---@param xi? any
---@param eta? any
---@return dm.vector
function dm_space_class:ad(xi, eta) end

---G:bonds(list) -> list of numbers
---
---N - dim G equations that flat coordinates fulfil: |q|^2 - 1 of a quaternion, orthonormal columns of
---other rotations, the last across the others, det - 1 of SL(n), g^T J g = J above the diagonal of
---Sp(n).
---@param list? any
---@return table
function dm_space_class:bonds(list) end

---G:cayley(xi) -> element
---
---The Cayley map (1 - X/2)^-1 (1 + X/2), X = hat(xi), which agrees with exp to second order; angles 2
---atan(xi/2). Not for SL(n > 2), whose determinant it does not keep.
---@param xi? any
---@return any
function dm_space_class:cayley(xi) end

---G:cayleyinv(g) -> dm.vector
---
---The inverse of the Cayley map, 2 (g - 1)(g + 1)^-1. Raises where -1 is an eigenvalue.
---@param g? any
---@return dm.vector
function dm_space_class:cayleyinv(g) end

---G:coAd(g, mu) -> dm.vector
---
---The coadjoint action Ad*_(g^-1): <coAd(g, mu), xi> = <mu, Ad(g^-1, xi)>, a left action.
---@param g? any
---@param mu? any
---@return dm.vector
function dm_space_class:coAd(g, mu) end

---G:coad(xi, mu) -> dm.vector
---
---The transpose of ad: <coad(xi, mu), eta> = <mu, [xi, eta]>, as in the Euler-Poincare equations mu' =
---coad(xi, mu).
---@param xi? any
---@param mu? any
---@return dm.vector
function dm_space_class:coad(xi, mu) end

---G:compose(a, b) -> element
---
---The product a b. Angles are not wrapped.
---@param a? any
---@param b? any
---@return any
function dm_space_class:compose(a, b) end

---G:dcay(xi, eta) -> dm.vector
---
---The right-trivialized differential of the Cayley map: (1 - X/2)^-1 Y (1 + X/2)^-1. The left one is
---dcay(-xi, eta).
---@param xi? any
---@param eta? any
---@return dm.vector
function dm_space_class:dcay(xi, eta) end

---G:dcayinv(xi, eta) -> dm.vector
---
---The inverse of eta -> dcay(xi, eta): (1 - X/2) Y (1 + X/2).
---@param xi? any
---@param eta? any
---@return dm.vector
function dm_space_class:dcayinv(xi, eta) end

---G:dexp(xi, eta) -> dm.vector
---
---The right-trivialized differential of exp: d/dt exp(xi) = hat(dexp(xi, xi')) exp(xi), dexp = (e^ad -
---1)/ad (HLW III.4). The left one is dexp(-xi, eta).
---@param xi? any
---@param eta? any
---@return dm.vector
function dm_space_class:dexp(xi, eta) end

---G:dexpinv(xi, eta) -> dm.vector
---
---The inverse of eta -> dexp(xi, eta). Raises where it has none (rotations by 2 pi).
---@param xi? any
---@param eta? any
---@return dm.vector
function dm_space_class:dexpinv(xi, eta) end

---G:distance(a, b) -> number
---
---The angle of rotation of a^-1 b (SO(n), T(n): of all planes, in the Euclidean norm; S(n): between
---the vectors), |log(a^-1 b)| for R(n), SE(n), Heisenberg(n), the Frobenius norm of a - b for GL(n),
---SL(n), Sp(n).
---@param a? any
---@param b? any
---@return number
function dm_space_class:distance(a, b) end

---G:exp(xi) -> element   or   S:exp(z, w) -> point
---
---The exponential of an algebra vector of dim G entries (a number will do for dim 1), with exact
---derivatives at 0 too. Closed forms; for GL(n), Sp(2n), SL(n > 2), SO(n > 3) scaling and squaring (of
---symbols for norms up to 32). Of a manifold, S(n) or a product with one: the point at the end of the
---geodesic (great circle) of length |w| from z along the tangent vector w, z cos|w| + w sin|w|/|w|; of
---a product lists, with g exp(xi) for factors that are groups.
---@param xi? any
---@return any
function dm_space_class:exp(xi) end

---G:flat(g) -> list of N numbers
---
---Coordinates of an element without a singularity: a unit quaternion for SO(3), entries for other
---matrices, angles as they are.
---@param g? any
---@return table
function dm_space_class:flat(g) end

---G:hat(xi) -> dm.matrix
---
---The matrix of an algebra vector: of SO(3) that of xi x; of vector groups the one of their
---homogeneous matrices.
---@param xi? any
---@return dm.matrix
function dm_space_class:hat(xi) end

---G:identity() -> element
---
---The neutral element. Elements are: SO(2) an angle; R(n), T(n), SE(2) = (x, y, theta), SU(2) = (w, x,
---y, z), Heisenberg(n) vectors; SO(n), SE(n), SL(n), GL(n), Sp(n) dm.matrix; products lists. All
---methods of groups also take symbols.
---@return any
function dm_space_class:identity() end

---G:inverse(g) -> element
---
---The inverse element.
---@param g? any
---@return any
function dm_space_class:inverse(g) end

---G:left(g, h) -> element
---
---The left translation L_g h = g h.
---@param g? any
---@param h? any
---@return any
function dm_space_class:left(g, h) end

---G:left_tangent(g, h, w) -> w'
---
---The tangent T_h L_g w of the left translation at h; w, a change of h, has the shape of an
---element.
---@param g? any
---@param h? any
---@param w? any
---@return any
function dm_space_class:left_tangent(g, h, w) end

---G:log(g) -> dm.vector of dim G entries   or   S:log(z, y) -> w
---
---The principal logarithm: exp(log(g)) is g; rotations by up to pi, with all digits near 0 and near
---pi. Raises where there is none. Of a manifold, S(n) or a product with one: the tangent vector w at z
---of the shortest geodesic to y, exp(z, w) = y, |w| = distance(z, y). Raises at antipodes.
---@param g? any
---@return dm.vector
function dm_space_class:log(g) end

---G:matrix(g) -> dm.matrix
---
---The (homogeneous) matrix of an element; of a product the blocks on the diagonal.
---@param g? any
---@return dm.matrix
function dm_space_class:matrix(g) end

---G:project(M) -> element
---
---The nearest rotation of SO(n) and SE(n) (the polar factor), M/det^(1/n) of SL(n), a symplectic
---matrix near M of Sp(n), angles wrapped to -pi .. pi, a unit vector of S(n).
---@param M? any
---@return any
function dm_space_class:project(M) end

---G:random(stream [, i [, size]]) -> element
---
---Element i (0) of the stream dm.random(seed): uniform on SO(n), T(n), S(n) and their products
---(translations normal), else a product of exponentials. With size: exp of normal numbers of that
---deviation.
---@param stream? any
---@param i? any
---@param size? any
---@return any
function dm_space_class:random(stream, i, size) end

---G:right(g, h) -> element
---
---The right translation R_g h = h g.
---@param g? any
---@param h? any
---@return any
function dm_space_class:right(g, h) end

---G:right_tangent(g, h, w) -> w'
---
---The tangent T_h R_g w of the right translation at h; w, a change of h, has the shape of an
---element.
---@param g? any
---@param h? any
---@param w? any
---@return any
function dm_space_class:right_tangent(g, h, w) end

---G:unflat(list) -> element
---
---The element of flat coordinates, which fulfil G:bonds.
---@param list? any
---@return any
function dm_space_class:unflat(list) end

---G:valid(g) -> true, defect   or   false, why
---
---Is g an element: of the right shape, finite, and on the group to 1e-9?
---@param g? any
---@return boolean
---@return any|boolean
---@return any
function dm_space_class:valid(g) end

---G:vee(M) -> dm.vector
---
---The algebra vector of a matrix: the inverse of hat; what of M is not in the algebra is left out.
---@param M? any
---@return dm.vector
function dm_space_class:vee(M) end

---dm.sparse: a sparse matrix of numbers, the A.matrix of a dm.operator
---fields: rows, columns, nonzeros (entries that are not 0); A * x, A * B, A + B, A - B, number * A
---@class dm.sparse
local dm_sparse_class = {}

---S:all_eigenpairs(mass) -> values, list of dm.vector, residuals
---
---All solutions of S x = lambda M x, ascending, by dense rotations: up to 1200 unknowns, masses > 0.
---@param mass? any
---@return any
---@return table
---@return any
function dm_sparse_class:all_eigenpairs(mass) end

---A:asymmetry() -> number
---
---The largest |A - A^T| over the largest |entry|.
---@return number
function dm_sparse_class:asymmetry() end

---A:dense() -> dm.matrix
---
---All entries; raises above 2^24 of them.
---@return dm.matrix
function dm_sparse_class:dense() end

---A:diagonal() -> dm.vector
---
---The diagonal.
---@return dm.vector
function dm_sparse_class:diagonal() end

---S:eigenpairs(mass, factor, shift, count [, above]) -> values, list of dm.vector, residuals, solves
---
---count solutions of S x = lambda M x, S symmetric, M = diag(mass) with masses >= 0, x^T M x = 1, by Lanczos iterations with the factor of S - shift M: nearest to the shift, with above the least beyond it, in no order. Residuals are |M^-1 S x - lambda x|.
---@param mass? any
---@param factor? any
---@param shift? any
---@param count? any
---@param above? any
---@return any
---@return table
---@return any
---@return any
function dm_sparse_class:eigenpairs(mass, factor, shift, count, above) end

---A:factor("cholesky" | "lu" | "gradients" | "dense") -> dm.factor   or nothing
---
---What solves A x = b: Cholesky (CHOLMOD) or LU (UMFPACK) factors, conjugate gradients with the diagonal as preconditioner, or dense elimination up to 1200 unknowns. Nothing where A is singular, for "cholesky" not positive definite; raises where dm/sparse.so is missing.
---@param cholesky? any
---@return dm.factor|nil
function dm_sparse_class:factor(cholesky) end

---A:gram(w) -> dm.sparse
---
---A^T diag(w) A, w a number for every row: the matrix of a weighted sum of squares.
---@param w? any
---@return dm.sparse
function dm_sparse_class:gram(w) end

---S:negatives() -> integer   or nothing
---
---How many eigenvalues of a symmetric matrix are negative, by the signs of D in L D L^T (CHOLMOD); nothing where a pivot is 0.
---@return integer|nil
function dm_sparse_class:negatives() end

---A:pick(rows, columns) -> dm.sparse
---
---The rows and columns whose marks, a number each, are not 0; nil keeps all.
---@param rows? any
---@param columns? any
---@return dm.sparse
function dm_sparse_class:pick(rows, columns) end

---A:row_sums() -> dm.vector
---
---The sum of the moduli of the entries of every row.
---@return dm.vector
function dm_sparse_class:row_sums() end

---A:saddle(r) -> dm.sparse
---
---{{diag(r), -A^T}, {-A, 0}}: of r x = A^T y with A x given.
---@param r? any
---@return dm.sparse
function dm_sparse_class:saddle(r) end

---A:scale(left, right) -> dm.sparse
---
---diag(left) A diag(right); nil stands for ones.
---@param left? any
---@param right? any
---@return dm.sparse
function dm_sparse_class:scale(left, right) end

---A:transpose() -> dm.sparse
---
---The transpose.
---@return dm.sparse
function dm_sparse_class:transpose() end

---dm.stability_map: where a method fails, made by dm.stability{system=, q=, v=, rule=, h=, steps=}
---fields: h and the parameters by name (lists of numbers), rows (what belongs to each), rules, seconds
---(what it took)
---@class dm.stability_map
local dm_stability_map_class = {}

---map:at(row, column) -> {class, why, rule, h, steps, error, slope, growth, exponent, megno, cause, observable, off, range, phase, hidden, horizon, ...}
---
---What was found in a cell and on what evidence: row and column are numbers of cells, or row a table
---as for map:limit and column a value (the nearest). error: largest |energy - its start| (or of what
---is watched); slope per unit of time with its standard error; growth: factor a step from the first to
---the last quarter; exponent, megno: of the exact tangent map; steps finished; code: of dm.failure or
---"ok". Of maps over a duration t, at every step up to it: observable: the one that is furthest off in
---parts of its range, off: by how much, range: greatest less least value of it in the resolved flow,
---both in its units; phase: the time by which the run is ahead at the end (behind: negative), the
---shift of the flow that fits it best, followed from the start; nil where none does; hidden: largest
---|G v + g_t| of the constraints g(q, t), G = dg/dq as written, v from p; horizon: the time up to
---which the flow is known, where chaos ends it early; cause of chaos: "flow", or "step" where the
---resolved flow is not chaotic.
---@param row? any
---@param column? any
---@return table
function dm_stability_map_class:at(row, column) end

---map:csv(file) -> file name   or   map:csv() -> string
---
---A line for every cell: rule, parameters, h, class, steps, error, slope, slope_error, growth,
---exponent, megno; off, range, hidden as far as the rows of the map told them (map:at looks at every
---step).
---@param file? string
---@return string
function dm_stability_map_class:csv(file) end

---map:limit(row [, "right"]) -> number, sentence   or   nil, sentence
---
---The largest value of the columns (the step h, or the last parameter of a map with one step) before
---the first that is lost in a row, found to `resolution` (1e-3, relative) by cells in between;
---infinity when none is lost, 0 (of a parameter -infinity) when the first is, nil where the map was
---stopped before. The first time a limit of a row is asked for, the windows and resonances of linear
---theory (map:resonances) are tried between the columns, of maps with up to 64 rows: a narrow tongue
---of instability there is the limit, and the sentence says so. Other tongues narrower than a column,
---as those about resonances of two oscillations or of more than 6 steps a turn, are seen only where a
---column meets them. "right": the same of what is right, no observable further than `accuracy` from
---the resolved flow up to t; nil where no flow is known. row: its number, or a table such as { rule =
---"verlet", k = 100 } (the nearest). The sentence says what happens beyond.
---@param row? any
---@param right? any
---@return number
---@return any|nil
---@return any
function dm_stability_map_class:limit(row, right) end

---map:plot{file=, title=, ...} -> file name or nothing
---
---The classes as colours (dm.palette "classes"; blue: right, yellow to red: wrong, drifting or
---chaotic, grey: lost) over the last row parameter (across) and the columns (up), one panel for every
---rule and every value of the first of two row parameters (at most 12), with the measured and the
---theoretical limits and the resonances; without a file as letters in the terminal. Other options as
---in dm.plot.
---@param options? table
---@return string|nil
function dm_stability_map_class:plot(options) end

---map:resonances(row) -> list of {n, h, omega, mean}, sentence
---
---The steps, inside of those of the map and the smallest first, that turn an oscillation of the system
---linearised along the orbit by 2 pi / n, n = 3 to 6: near these a symplectic rule is unstable in
---nonlinear forces. omega: the frequency; where it changes along the orbit its mean over the time, if
---it is more than twice as fast as the orbit turns, else that of the orbit itself: of coordinates that
---turn with several oscillations (2 to 12 of them) a line of their spectrum, to about half a turn in
---the whole time. mean: true where it is a
---mean of frequencies that change, as a mode that hardly moves has it: the motion need not have it.
---The sentence says why where there are none.
---@param row? any
---@return table
---@return any
function dm_stability_map_class:resonances(row) end

---map:table([most]) -> string
---
---A line for every row (at most `most`, default 40, evenly taken): the measured limit, the limit of
---linear theory where there is one, and what happens beyond.
---@param most? any
---@return string
function dm_stability_map_class:table(most) end

---map:theory(row) -> number, sentence   or   nil, sentence
---
---The step at which the linear theory of the rule loses an oscillation of the system linearised along
---the orbit of the row: where one of its frequencies (system:linearize) meets the first window of
---growth of dm.stability_limit, however narrow. Beside map:limit(row), which is measured. nil, and
---why, where there is none: for rules other than Runge-Kutta ones also where forces linear in v
---(magnetic, Coriolis, friction) couple the oscillations.
---@param row? any
---@return number
---@return any|nil
---@return any
function dm_stability_map_class:theory(row) end

---dm.strip: levels of a field on a line, as Lua modules see them
---Two levels with a row of cells between them; made by core.strip. Fields and boxes on lines are made of it.
---@class dm.strip
local dm_strip_class = {}

---strip:cells(lower, upper, t, h, "value" | "slopes" | "hessian") -> dm.matrix
---
---A row for every cell: the action or the equations, and their derivatives.
---@param lower? any
---@param upper? any
---@param t? any
---@param h? any
---@param value? any
---@return dm.matrix
function dm_strip_class:cells(lower, upper, t, h, value) end

---strip:energies{u=, t=} -> dm.vector, dm.vector
---
----dS/dh and dS/dt of every slab.
---@param options? table
---@return dm.vector
---@return dm.vector
function dm_strip_class:energies(options) end

---strip:follows(f) -> boolean
---
---Does f, traced again, do what the function did that the strip was made of?
---@param f? any
---@return boolean
function dm_strip_class:follows(f) end

---strip:limit(u, unit) -> number
---
---The height at which the fastest oscillation about u begins to grow, looked for around unit.
----1: none is seen, and the kinetic energy is of both signs.
---@param u? any
---@param unit? any
---@return number
function dm_strip_class:limit(u, unit) end

---strip:momenta(lower, upper, t, h) -> dm.vector
---
---The momenta of the upper level.
---@param lower? any
---@param upper? any
---@param t? any
---@param h? any
---@return dm.vector
function dm_strip_class:momenta(lower, upper, t, h) end

---strip:residual{u=, t=, xi= | v=, w=, leave=, area=} -> number, number
---
---The largest boundary sum of a law around a node, and of the terms of a corner, over area.
---@param options? table
---@return number
---@return number
function dm_strip_class:residual(options) end

---strip:run{u=, p=, guess=, t0=, h=, steps=, every=, free=, from=} -> table
---
---Levels from u (and p, of an action) on: u, p (matrices, a row a level), t, energy, code, status, done, iterations, residual, h, tangled, ending. from: the ending of a run, whose last u and p are given; then this one has the bits of one that never stopped.
---@param options? table
---@return table
function dm_strip_class:run(options) end

---strip:vary{u=, t=, v=, dp=} -> dm.matrix, dp
---
---First variations along known levels from v, and dp of an action, at the first.
---@param options? table
---@return dm.matrix
---@return any
function dm_strip_class:vary(options) end

---dm.sweep: what dm.sweep{run =} has found, a row for each member
---fields: columns (names), a dm.vector for each of them (NaN where a member failed), status[i] ("ok"
---or a code of dm.failure), journal ({ file, found, run } where there is one); #sweep members
---@class dm.sweep
local dm_sweep_class = {}

---sweep:csv(file) -> file name   or   sweep:csv() -> string
---
---A line for each member: its number and its columns with 17 significant digits, nan where it
---failed.
---@param file? string
---@return string
function dm_sweep_class:csv(file) end

---sweep:failures() -> table of {member, code, step, message}
---
---The members whose run raised a dm.failure.
---@return table
function dm_sweep_class:failures() end

---sweep:npy(file) -> file name
---
---The same as records of NumPy, which dm.load reads, too.
---@param file? string
---@return string
function dm_sweep_class:npy(file) end

---sweep:plot(x, y [, options]) -> string or nothing
---
---Points of two columns, "member" among them, as dm.plot draws them; members that failed are left
---out.
---@param x? any
---@param y? any
---@param options? table
---@return string|nil
function dm_sweep_class:plot(x, y, options) end

---dm.symbol: an argument of a function while it is traced
---+ - * / ^ and math.* record an expression; comparisons, %, // and whatever else needs a value raise
---@class dm.symbol
local dm_symbol_class = {}

---dm.system: a configuration space and a Lagrangian, made by dm.system{Q=, L=}
---fields: Q, L, name, coordinates, units, params, given (all options as they were given, to be read); system.params.k = 3 reaches the next run, a new name that nothing reads is refused
---@class dm.system
local dm_system_class = {}

---system:acceleration(q, v [, t]) -> dm.vector of dim Q entries
---
---d2q/dt2 at a state by the equations of motion, with forces and constraints; a control is that of
---this state. Numbers, or symbols in a traced function.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:acceleration(q, v, t) end

---shape:amended_potential(x [, t]) -> number
---
---V_mu = V + (mu - c).I^-1 (mu - c)/2, minus the Routhian at rest (c: the momentum of the group at
---rest, 0 unless L has terms linear in the velocities). Its stationary points are relative
---equilibria.
---@param x? any
---@param t? any
---@return number
function dm_system_class:amended_potential(x, t) end

---shape:at_momentum(mu) -> dm.system
---
---The same reduction at another momentum, a number or a list of dim G numbers; nothing is checked
---again.
---@param mu? any
---@return dm.system
function dm_system_class:at_momentum(mu) end

---system:chart{q=, v= | p=, t=, rules={...}, h={...}, ...} -> dm.chart
---
---The same as dm.chart{system, ...}.
---@param options? table
---@return dm.chart
function dm_system_class:chart(options) end

---shape:connection(x [, t]) -> dm.matrix, dim G x dim shape
---
---The connection A(x): theta' + A x' vanishes on horizontal velocities. The mechanical one, I^-1
---dp_theta/dx', unless system:routh was given another.
---@param x? any
---@param t? any
---@return dm.matrix
---@return any
function dm_system_class:connection(x, t) end

---system:constraint(q [, t]) -> dm.vector
---
---g(q, t) of the holonomic constraints, in their units: zero on the constraint.
---@param q? any
---@param t? any
---@return dm.vector
function dm_system_class:constraint(q, t) end

---shape:continue(equilibrium, {mu = {from, to}, step=, points=, back=}) -> dm.branch
---
---The relative equilibria that go on from one, followed by arc length (Keller) in (x, mu), through
---folds, while mu is in the range, to its very ends; along its own direction where the group has
---several dimensions. step: largest step of arc length; back = true: towards smaller mu first.
---branch[i] as in relative_equilibria with momentum; branch.mu, .energy, .velocity, .growth, .x1 ...
---and coordinates by name: columns; branch:series("mu", "energy") for dm.plot; branch.events: folds,
---changes of stability, crossings of other branches, a pole (the locked inertia vanishes: mu = 0) at
---which a branch ends.
---@param equilibrium? any
---@param options? table
---@return dm.branch
function dm_system_class:continue(equilibrium, options) end

---system:control(q, v [, t]) -> dm.vector
---
---The controls u of a step that starts at (q, v, t).
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:control(q, v, t) end

---shape:curvature(x [, t] [, a]) -> dm.matrix, dim shape x dim shape
---
---The magnetic form at momentum mu, beta_ij = d_i B_j - d_j B_i of B = mu A (the exact derivative of
---the connection); with a, a number from 1 to dim G, the curvature of component a alone, without
---mu.
---@param x? any
---@param t? any
---@param a? any
---@return dm.matrix
---@return any
function dm_system_class:curvature(x, t, a) end

---shape:discrete{rule=, h=} -> dm.discrete_shape   or   shape:discrete(Ld) -> dm.discrete_shape
---
---A discrete Lagrangian of the unreduced system without its group variables: that of a stage rule, or
---a dm.discrete_lagrangian in the unreduced coordinates. It has psi_mu, the discrete connection, the
---discrete Routh equations. Raises where the group does not leave Ld as it is, where it is that of
---another system (its equations do not approach those of L as h goes to 0) or has another momentum
---along the group than L has, or a constraint that the system has not. Its forces and rolling
---constraints are reduced where the group leaves them and their reactions invariant and they have no
---part along it (Leok 2.8.2-2.8.3); else raises with the entry and the component.
---@param options? table
---@return dm.discrete_shape
function dm_system_class:discrete(options) end

---system:emit_c() -> string
---
---C17 text of what the runtime computes, with no need of dmlua: lagrangian (1 output), slope (dL/dq, dL/dv: 2 dim Q) and energy, and constraint, rolling, reaction, force where there are such, each void f(const double *in, double *out) with in = q, v, t; of a discrete Lagrangian Ld and slope with in = q0, q1. Compile with -ffp-contract=off and, for gcc with -mfma, -fno-tree-slp-vectorize: then nothing is fused that the text does not fuse.
---@return string
function dm_system_class:emit_c() end

---system:energy(q, v [, t]) -> number
---
---v . dL/dv - L, in the units of L; q, v: vectors or tables of dim Q numbers, t: 0 unless given. Of an H that has no Lagrangian: system:energy(q, p [, t]), H itself. Raises where it is not finite, as do the other methods of a state.
---@param q? any
---@param v? any
---@param t? any
---@return number
function dm_system_class:energy(q, v, t) end

---system:force(q, v [, t]) -> dm.vector of dim Q entries
---
---The force f(q, v, t) of the system, a covector: f . dq is the work; with controls, as at the start of a step.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:force(q, v, t) end

---system:graph() -> string
---
---The expression graph of L, one assignment a line; coordinates and their rates by name.
---@return string
function dm_system_class:graph() end

---shape:holonomy(loop [, {t=, steps=}]) -> dm.vector of dim G entries
---
----closed integral A . dx of the connection along a loop of shapes: loop(s) for 0 <= s <= 1 with
---loop(0) = loop(1) (where Q = dm.T(n): up to whole turns), a function of one number that can be
---traced; by the trapezoidal rule with `steps` points (default 256), which for a smooth loop errs less
---than any power of 1/steps.
---@param loop? any
---@param options? table
---@return dm.vector
function dm_system_class:holonomy(loop, options) end

---system:independent{q=, t=} -> system, list
---
---The system without the constraints that follow from those before them, and their numbers: a doubled
---one, the last bar of a frame that is rigid without it, the closing joint of a plane loop. They must
---follow near q (and at other times) and not at q only: a row that is dependent in one position, as
---the distance of the ends of a straight bar of three points, is needed there, and raises. Runs of the
---new system whose rows have q are looked through: where a constraint that was left out no longer
---holds they raise. Systems on coordinates; rolling constraints stay.
---@param options? table
---@return any
---@return table
function dm_system_class:independent(options) end

---system:lagrangian(q, v [, t]) -> number
---
---L(q, v, t) through the kernel that was traced from it, in the units of L.
---@param q? any
---@param v? any
---@param t? any
---@return number
function dm_system_class:lagrangian(q, v, t) end

---system:legendre(q, v [, t]) -> dm.vector
---
---The momentum p = dL/dv of dim Q entries (the Legendre transform), entry i in units of L over those of v_i; inverse: system:velocity.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:legendre(q, v, t) end

---system:level{group=, mu=, factor=} -> dm.level   or   {action=, section=, mu=} -> dm.level
---
---What system:routh makes for a group that is not abelian: the system at the spatial momentum J = mu.
---Q is a product with the group as a factor; or coordinates with a free left action (a dm.action; of
---one body, or of all bodies alike) and section(x), a point of Q for every shape. Raises where L is
---not invariant, the locked inertia singular, or the action not free (the dimension of the isotropy).
---@param options? table
---@return dm.level|table
function dm_system_class:level(options) end

---shape:lift(x, v [, theta] [, t]) -> q, v
---
---The state of the unreduced system over the state (x, v) of the shape at the momentum mu: the
---velocity of the group is I^-1 (mu - dp/dx' x'). theta: where in the group, a number or list (default
---0).
---@param x? any
---@param v? any
---@param theta? any
---@param t? any
---@return any
---@return any
function dm_system_class:lift(x, v, theta, t) end

---system:linearize{q=, v= | p=, t=, generator=, a=} -> {stable, why, fastest, frequencies, rates, ...}
---
---The system linearised at a state (v default 0, t default 0): d(dq, dv)/dt = matrix (dq, dv), with
---real parts `rates` and imaginary parts `frequencies` of its eigenvalues. At an equilibrium, and at a
---relative equilibrium with v along coordinates that L does not depend on, this is its linear
---stability; anywhere else coefficients change along the motion: frozen is true, there is no `stable`,
---and it is how fast the system oscillates there. At a relative equilibrium that is none of
---coordinates, as a circle in x and y, generator = function(q) -> the velocity of the field of its
---symmetry (path:momentum): the matrix is then that of what moves along, exact, and `rate` is how fast
---the motion goes along the field. fastest: the largest frequency, which a step has to resolve. p
---stands in place of v, too; of a system that has only H the matrix is that of (dq, dp). On a group
---the changes are (g^-1 dg, dxi) (right trivialization: dg g^-1 where that is steady; of an H without
---L dmu), and a generator gives the body velocity. There may be forces, controls (as they are at this
---state), constraints and rolling: the matrix is then on an orthonormal basis of the changes that
---these allow, as the tangent space of the constraints, and the state must be on them. Of a reduced
---system (dm.euler_poincare; v or p, and a) it is that of (dxi, da), or (dmu, da) of an h.
---@param options? table
---@return table
function dm_system_class:linearize(options) end

---shape:locked_inertia(x [, t]) -> dm.matrix, dim G x dim G
---
---d2L/dtheta'2 at the shape x: the inertia of the system moved by the group as a rigid body.
---@param x? any
---@param t? any
---@return dm.matrix
---@return any
function dm_system_class:locked_inertia(x, t) end

---shape:magnetic_momentum(x, p [, t]) -> dm.vector
---
---s = p - mu A(x): from the canonical momentum p = dR/dx' of a path of this system to the one that
---belongs to the magnetic form.
---@param x? any
---@param p? any
---@param t? any
---@return dm.vector
function dm_system_class:magnetic_momentum(x, p, t) end

---system:mass(q, v [, t]) -> dm.matrix
---
---The mass matrix d2L/dv2, dim Q x dim Q; singular where L is degenerate.
---@param q? any
---@param v? any
---@param t? any
---@return dm.matrix
function dm_system_class:mass(q, v, t) end

---system:mechanical_connection{group=, rule=, h=, factor=} -> dm.connection
---
---The discrete mechanical connection of a system whose Q is a product of coordinates (R^n, T^n) and
---the group, of equal factors the first or number `factor`: A_d(q0, q1) takes q1 = { x1, g1 } to the
---end of the curve of the rule from q0 to the shape x1, in the time h, that has the momentum 0 along
---the group. rule: "lie(s)", of order 2s; where the group is R^m or T^m any rule of Ld:connection.
---Raises where L is not invariant under the group, where its locked inertia is singular.
---@param options? table
---@return dm.connection
function dm_system_class:mechanical_connection(options) end

---field:modes(n, {q=, t=, above=, near=}) -> { values, forms, residuals, solver }
---
---n modes of small oscillations of a field around the state q (default 0): squares of frequencies,
---omega^2, and forms of norm 1 in the kinetic energy, those nearest to 0, with above = x the least
---beyond x, with near = x nearest to x. t: the time of L, needed where L depends on it. They are
---those of L: forces beside it are left out. Cells that are fixed stay at 0; those without mass
---follow from their own equation. Of unit
---vectors (on = dm.S(m)) q must be given; forms are tangent there, and where q is no equilibrium the
---constraint's force is that of q.
---@param n? any
---@param options? table
---@return table
function dm_system_class:modes(n, options) end

---system:momentum(q, v [, t]) -> dm.vector
---
---The same as system:legendre, p = dL/dv; the momentum map of a group along a path is path:momentum(group).
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:momentum(q, v, t) end

---system:multipliers(q, v [, t]) -> dm.vector
---
---The multipliers at a state, of constraints first, then of rolling ones: lambda in d/dt L_v = L_q + f
---+ G^T lambda + E^T mu with G = dg/dq, E = dphi/dv (or the rows of `reaction`), such that g and phi
---stay zero. So +G^T lambda is the force of the constraint on q: with g = |q| - l the multiplier is
---the force along the rod, outwards, and the tension is -lambda; it is scaled with g. Numbers, or
---symbols in a traced function: an event at a zero of it is where a rope goes slack. Raises where
---constraints depend on each other.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:multipliers(q, v, t) end

---system:reduce{group=, rule=, h=, factor=, connection=} -> dm.lagrange_poincare
---
---The discrete Lagrange-Poincare equations of a system on a product with the group as a factor (of
---equal ones the first, or number `factor`), whose other factors are shapes: dm.R(n), dm.T(n) or
---dm.SO(2). rule: "lie(s [, quadrature] [, exp | cayley])" (abelian groups: also gauss(s)):
---its steps are those of the unreduced rule, to round-off, without the group elements in
---the equations. Raises where L is not invariant under the group.
---@param options? table
---@return dm.lagrange_poincare
function dm_system_class:reduce(options) end

---shape:reduction() -> {full, mu, cyclic, shape, group}
---
---Where a reduced system comes from: the unreduced system, the momentum (a vector), the numbers of the
---coordinates that were eliminated and kept, and the names of the former. Nothing for a system that is
---not reduced.
---@return table
function dm_system_class:reduction() end

---shape:relative_equilibria{region=, starts=, copies=} -> list of {x, mu, energy, velocity, ...}
---
---Motions along the group alone: stationary points of the amended potential in the region, a pair {
---least, most } for each coordinate of the shape, found by Newton's method from `starts` points
---(default 200) that fill it. velocity: of the group; index, flat: negative directions of V_mu, and
---those in which it has no slope; values: {re, im}, the characteristic values of small motions, with
---the magnetic term; stable: "energy" (a minimum of V_mu), "spectral" (all values imaginary) or false.
---Poles of the coordinates, also where the group does not act freely (a top upright, all rods
---vertical), are left out. copies = false: mirror images, with the same energy, velocity and index,
---are listed once. print shows the list.
---@param options? table
---@return table
function dm_system_class:relative_equilibria(options) end

---system:rolling(q, v [, t]) -> dm.vector
---
---phi(q, v, t) of the rolling constraints: zero where they hold.
---@param q? any
---@param v? any
---@param t? any
---@return dm.vector
function dm_system_class:rolling(q, v, t) end

---system:routh{cyclic=, mu=, q=, v=, connection=} -> dm.system
---
---system:routh{action=, section=, branch=, dimension=, names=, at=, mu=, ...} -> dm.system
---system:routh{group=, mu=} or {action=, section=, mu=} of a group that is not abelian -> dm.level
---The system without its group variables: an ordinary dm.system in the dim Q - m coordinates that are
---left, whose Lagrangian is the classical Routhian L - mu . theta' at the momentum mu. cyclic: the
---coordinates that L does not depend on, by name or number (default: all of them); mu: their momentum,
---a number or a list (default: that of the start q, v). action(theta, q) moves points of Q (theta: a
---number, or a vector of `dimension` angles), or is a dm.action; section(x) gives a point of Q for
---every shape x (default: as many coordinates as the group has dimensions are held at 0 wherever the
---orbit of `at`, of the start q or of a point that is found comes to such points, else at their values
---there, and theta is 0 at that point: turns leave r, which is singular at r = 0 alone); where an
---orbit meets a section several times, as at r and, half a turn on, at -r, a point has the shape of
---least norm, of equal norms the one whose first entry is positive, or the one of them where branch(x)
---> 0; names: of theta and x (default theta, x1, x2, ..., but a coordinate that the group leaves alone
---keeps its name). On a group action(theta, g), of an abelian group, and section(x), which
---has to be given, make elements, for instance a top's turns about the vertical: x are coordinates
---near the section, states and reconstructed paths have elements. connection(x): m rows of dim Q - m
---numbers, in place of the mechanical connection. Invariance of L under cyclic coordinates is proved,
---or searched, by bounds between a dozen points; all else is checked at these points. The first that
---violates it is named: what differs nowhere there, such as a force along the group that sets in only
---beyond some distance, is not seen, and the reduced run leaves it out. Constraints, rolling ones
---whose reactions spare the group, and forces that the group keeps are reduced too. The params of the
---system are those of the shape, with the momentum as mu (mu1, mu2, ... of a group of more dimensions;
---mu_theta where a parameter is called mu): ensembles and stability maps vary them, and what is
---changed in the system later changes in the shape, unless that was given another value of its own. A
---run that jumps over a shape with a singular mass or locked inertia fails, with reason "pole" or
---"collapse". The reduced system also has connection, curvature, locked_inertia, amended_potential,
---lift, start, and its paths have reconstruct. Raises when L is no invariant, a force pushes along the
---group, or the locked inertia is singular.
---@param options? table
---@return dm.system
function dm_system_class:routh(options) end

---shape:routhian(x, v [, t] [, kind]) -> number
---
---kind = "classical" (default): R = L - mu . theta' at the momentum mu, the Lagrangian of this system;
---kind = "magnetic": R - mu A . x', which goes with the magnetic form of shape:curvature (Leok
---2.2).
---@param x? any
---@param v? any
---@param t? any
---@param kind? any
---@return number
function dm_system_class:routhian(x, v, t, kind) end

---shape:rsprk{rule=, h=, a=, b=, A=, beta=} -> function(x0, s0) -> x1, s1
---
---One step of the reduced symplectic partitioned Runge-Kutta rule as it is written down (Leok 2.5.14),
---in the momentum s = p - mu A(x) of the magnetic form (shape:magnetic_momentum): a check of
---shape:solver{rule = "rsprk(...)"}, which takes the same steps quickly. rule: gauss(s) or lobatto(s);
---or the coefficients a, b and, if they are not the partner, A, refused where they are not symplectic.
---beta(x): another magnetic form, to see what it changes.
---@param options? table
---@return function
---@return any
function dm_system_class:rsprk(options) end

---shape:slice(what, {from=, to=, points=, t=}) -> list of series for dm.plot
---
---"amended_potential", "connection", "curvature" or "locked_inertia" along the straight line between
---two shapes, a series { x =, y =, name = } for each entry against the coordinate that changes most:
---dm.plot(shape:slice("curvature", { from = a, to = b }), { file = "curvature.png" }).
---@param what? any
---@param options? table
---@return table
function dm_system_class:slice(what, options) end

---system:solver{rule=, h=, newton={tolerance=, max_iterations=}, backend=, sums=} -> dm.solver
---
---A solver for this system: see dm.solver and dm.rules().
---Of a field on a mesh (K:field) also rule = "avi", with h a number, a list or a function(cell) of the
---cells of the potential (default: half of what each allows), start = "half" for half a kick at the
---start: every cell has a step of its own (Lew, Marsden, Ortiz & West 2003); and rule =
---dm.prismal{t0, t1, ...}, without h: prisms over uneven slices of time.
---Of a reduced system (system:routh) also "rsprk(rule)", the reduced rule of Leok 2.5: the same steps
---as `rule`, whose p is s + mu A.
---@param options? table
---@return dm.solver
function dm_system_class:solver(options) end

---system:stability{q=, v= | p=, rule= | rules=, h=, steps= | t=, ...} -> dm.stability_map
---
---The same as dm.stability{system = system, ...}.
---@param options? table
---@return dm.stability_map
function dm_system_class:stability(options) end

---field:stability_limit(rule, {q=, t=}) -> number
---
---The largest step of a rule on small oscillations of a field around q (default 0): the h omega up to
---which the rule is stable on a harmonic oscillator (dm.stability_limit, which also sees narrow bands
---of growth) over the largest frequency; 2 over it for verlet. Infinite where no step is too large. t:
---the time of L, needed where L depends on it; forces beside L are left out.
---@param rule? any
---@param options? table
---@return number
function dm_system_class:stability_limit(rule, options) end

---shape:start(q, v [, t]) -> x, v, theta
---
---The state of the shape under a state of the unreduced system, and where that is in the group. Raises
---when its momentum is not mu.
---@param q? any
---@param v? any
---@param t? any
---@return any
---@return any
---@return any
function dm_system_class:start(q, v, t) end

---system:structure() -> table
---
---What was read off the graph of L: separable, constant_mass, diagonal_mass, autonomous, linear_in_v, quadratic_in_v (d2L/dv2 does not depend on v), saddle (d2L/dv2 is singular by itself and regular with the constraints; rules step L plus squares of the constraints' velocities, which vanish) (booleans), cyclic (names of coordinates that L does not depend on), operations; and how the system is constrained: constraints, rolling (how many), forced (boolean). hamiltonian: H(q, p) is stepped as it stands, no formula gives an L of it; separable is then H = T(p) + V(q, t).
---@return table
function dm_system_class:structure() end

---shape:symplectic_form(x [, t]) -> dm.matrix, 2 dim shape x 2 dim shape
---
---The reduced form dx ^ ds - beta on (x, s), s = p - mu A(x): rows (-beta, 1), (-1, 0). RSPRK keeps
---it; that of pairs of shapes is D:two_form.
---@param x? any
---@param t? any
---@return dm.matrix
---@return any
function dm_system_class:symplectic_form(x, t) end

---system:velocity(q, p [, t]) -> dm.vector
---
---The velocity v with dL/dv(q, v, t) = p, by Newton to round-off; of an H, dH/dp. Raises when d2L/dv2 is singular, or L linear in v.
---@param q? any
---@param p? any
---@param t? any
---@return dm.vector
function dm_system_class:velocity(q, p, t) end

---dm.vector: entries in one block, made by dm.vector{...} or dm.zeros(n)
---v[i] from 1, #v, + - * / with vectors and numbers, == entry by entry
---@class dm.vector
local dm_vector_class = {}

---v:copy() -> dm.vector
---
---A new vector with the same entries.
---@return dm.vector
function dm_vector_class:copy() end

---v:cross(w) -> dm.vector or number
---
---The cross product of two vectors of 3 entries; of 2 entries the number v1 w2 - v2 w1. Raises for other lengths.
---@param w? any
---@return dm.vector|number
function dm_vector_class:cross(w) end

---v:dot(w) -> number
---
---The inner product of two vectors of the same length. Raises when the lengths differ.
---@param w? any
---@return number
function dm_vector_class:dot(w) end

---v:map(f) -> dm.vector
---
---A new vector of f(v[i], i), or f(v[i]) of a function written in C, as those of math and dm are. Raises when f returns no number.
---@param f? any
---@return dm.vector
function dm_vector_class:map(f) end

---v:norm() -> number
---
---The Euclidean norm sqrt(v . v), without overflow.
---@return number
function dm_vector_class:norm() end

---v:outer(w) -> dm.matrix
---
---The matrix v_i w_j, #v x #w.
---@param w? any
---@return dm.matrix
function dm_vector_class:outer(w) end

---v:slice(i [, j]) -> dm.vector
---
---A copy of the entries i to j (the last one when left out). Raises when they are out of range.
---@param i? any
---@param j? any
---@return dm.vector
function dm_vector_class:slice(i, j) end

---v:sum() -> number
---
---The sum of the entries.
---@return number
function dm_vector_class:sum() end

---v:totable() -> table
---
---The entries as a Lua table.
---@return table
function dm_vector_class:totable() end

---dm.vector_field: a vector at every vertex or in every top cell of a mesh, made by
---K:vector_field(f, ...) and a:sharp()
---fields: mesh, on ("vertices", "cells"), values (a dm.matrix, a row each), projected (the largest
---length of what pointed out of the cells and was taken away); X[i] is the list of components at
---vertex or cell i, #X how many there are; + - and * / with numbers
---@class dm.vector_field
local dm_vector_field_class = {}

---X:curl() -> dm.form or dm.vector_field
---
---In dimension 2 the dual 0-form * d X-flat, circulation by area in every triangle; in dimension 3 the
---field (* d X-flat)-sharp on cells.
---@return dm.form|dm.vector_field
function dm_vector_field_class:curl() end

---X:div{boundary = "flux"} -> dm.form
---
---The divergence -delta X-flat, a primal 0-form: 1 / |*v| times the flux of X out of the dual cell of
---v (Leok, Def 3.26). The sum of |*v| div X over vertices is the flux between their dual cells and
---the others; the part of a dual cell that lies in the boundary of the mesh is left out unless
---boundary = "flux", so without it constant fields have a divergence there.
---@param options? table
---@return dm.form
function dm_vector_field_class:div(options) end

---X:flat{to = "primal" | "dual"} -> dm.form
---
---The 1-form of a field. To edges e (the default), from cells: the mean of X.e with the shares of the
---dual of e as weights (Leok, Def 3.22); where that dual has no volume the plain mean, and a.averaged
---counts these edges; from vertices: (X_i + X_j).e / 2. To duals of facets f: the sum of |*f in s| X.m
---over the top cells s at f, m the unit vector along *f; from vertices X is its mean over f. Constant
---fields give exact values of the de Rham map.
---@param options? table
---@return dm.form
function dm_vector_field_class:flat(options) end

---X:plot{file=, dual=, azimuth=, height=, title=} -> file name or nothing
---
---Draw a field of vectors as arrows, the longest as long as an edge at the median.
---Without a file in the terminal, as lines or, where cells have colours, in shades, with it through
---gnuplot to a .png, .svg or .pdf. Surfaces in space are seen from azimuth and height (radians); of
---meshes of dimension 3 the boundary is drawn.
---dual = true adds the edges of the dual cells of a surface; title, label (of the colours). size, dpi,
---font, fontsize, linewidth and ascii as of dm.plot.
---@param options? table
---@return string|nil
function dm_vector_field_class:plot(options) end

---dm.wave_equation: the equation behind a dm.schroedinger
---fields: n (unknowns), fft (who makes transforms)
---@class dm.wave_equation
local dm_wave_equation_class = {}

---w:eigen(k) -> values, list of dm.vector
---
---The k least energies of H and values of real eigenfunctions of norm 1 at the points; up to 1200 unknowns.
---@param k? any
---@return any
---@return table
function dm_wave_equation_class:eigen(k) end

---w:energies() -> dm.vector, exact
---
---The energies of all modes of H, without g; beyond 1200 unknowns bounds of them, exact = false.
---@return dm.vector
---@return any
function dm_wave_equation_class:energies() end

---w:lanczos(k) -> values, list of dm.vector
---
---As w:eigen(k), for up to 4096 unknowns, by the library behind dm/sparse.so; raises without it.
---@param k? any
---@return any
---@return table
function dm_wave_equation_class:lanczos(k) end

---w:matrix() -> dm.matrix
---
---H of the amplitudes sqrt(weight) psi, real symmetric, without g.
---@return dm.matrix
function dm_wave_equation_class:matrix() end

---w:observe(re, im) -> norm, energy, x, momentum
---
---The integral of |psi|^2, the energy, and means of x and p.
---@param re? any
---@param im? any
---@return any
---@return any
---@return any
---@return any
function dm_wave_equation_class:observe(re, im) end

---w:slope(re, im) -> re, im
---
---The derivative in x at the points.
---@param re? any
---@param im? any
---@return any
---@return any
function dm_wave_equation_class:slope(re, im) end

---dm.wave_path: the rows of a run of a wave
---fields: t, psi (psi[i] is a copy, a dm.complex_vector), columns (names), steps, h, rule, wave,
---solver, title, notes (what to know of its accuracy), ns_per_step, file (where the rows are); #path
---rows
---@class dm.wave_path
local dm_wave_path_class = {}

---path:animate(file, {title=}) -> file name
---
---A page, name.html, on which a browser shows |psi|^2 in time, coloured by the phase, with V behind
---it, without a network: at most 400 of the rows.
---@param file? string
---@param options? table
---@return string
function dm_wave_path_class:animate(file, options) end

---path:checkpoint(file) -> file name
---
---Write where the run ended, a text with all bits; wave:resume(file) goes on from it.
---@param file? string
---@return string
function dm_wave_path_class:checkpoint(file) end

---path:column(name) -> dm.vector
---
---"t", "norm" (integral of |psi|^2), "energy" (of psi* (T + V) psi + g/2 |psi|^4), "x" and "momentum"
---(means), "noether": the discrete Noether quantity of the phase, of "two-step" hbar Re<psi, psi+> -
---h/3 Im<psi, H psi+>, else hbar times the norm.
---@param name? any
---@return dm.vector
function dm_wave_path_class:column(name) end

---path:csv(file) -> file name   or   path:csv() -> string
---
---The columns as comma-separated values, 17 significant digits; psi is left out.
---@param file? string
---@return string
function dm_wave_path_class:csv(file) end

---path:drift(name | vector) -> {per_time, error, mean, largest}
---
---Least squares slope against time of a column, or of a vector of one number a row, its standard
---error from block means, the mean, and the largest distance from the first row. At least 3 rows.
---@param name? any
---@return table
function dm_wave_path_class:drift(name) end

---path:plot("density" | "phase" | "re" | "im", {rows=, file=, ...}) -> file or nothing   or   path:plot(x, y | {y1, y2, ...}, {file=, ...}) -> file or nothing
---
---Over x at the rows (first and last, unless given), the density with V behind it, scaled; or columns
---("t", "norm", "energy", "x", "momentum", "noether") over one of them. Options as of dm.plot: without
---a file in the terminal.
---@param density? any
---@param options? table
---@return any
function dm_wave_path_class:plot(density, options) end

---path:spacetime{of = "density" | "phase", file=, title=, size=, ...} -> file or nothing
---
---x across, t up, |psi|^2 or the phase by colours with their scale, in a .png, .svg or .pdf; without a
---file by characters in the terminal. Sizes and letters as of dm.plot.
---@param options? table
---@return any|nil
function dm_wave_path_class:spacetime(options) end

---dm.wave_solver: a rule that steps a wave
---fields: wave, rule, h
---@class dm.wave_solver
local dm_wave_solver_class = {}

---solver:report() -> {rule, h, fft, steps, ns_per_step, iterations, residual, degree, parasitic}
---
---Who makes the transforms ("FFTW", "GSL", "none" between walls); of the last run steps and time;
---iterations so far and the residual of the last, where a step is solved for; degree in time of Gauss
---and slabs; parasitic: the share of the parasitic mode in the start of "two-step".
---@return table
function dm_wave_solver_class:report() end

---solver:run{psi=, steps= | t=, every=, t0=, seconds=, checkpoint=, file=} -> dm.wave_path
---
---Steps from psi, a function of x that returns re and im (left out: 0), a complex vector or
---{ re =, im = }; t: a duration, up to the step that reaches it. A row for `every` steps and the last.
---seconds: of CPU, at most; checkpoint: a file, written at the end and where the run stops. file =
---"rows.npy": rows go there as they come, NumPy records of the columns, re and im; the path keeps the
---columns, and psi of the last row. What ends a run early, Ctrl-C too, is a dm.failure with the path
---so far. The rows: path.psi[i], and columns t, norm, energy, x, momentum, noether.
---@param options? table
---@return dm.wave_path
function dm_wave_solver_class:run(options) end

---dm.wave_stepper: steps of a wave
---fields: iterations, residual (of the last step that was solved for), parasitic
---@class dm.wave_stepper
local dm_wave_stepper_class = {}

---s:run(t0, first, steps, every [, seconds]) -> rows, done, code, seconds
---
---Steps from the state, which is step `first` of a run from t0, and a row for `every` of them: t, norm, energy, x, momentum, noether, tail, edge, then re and im of psi in turn. code as of a dm.failure, "ok" where nothing failed.
---@param t0? any
---@param first? any
---@param steps? any
---@param every? any
---@param seconds? any
---@return any
---@return any
---@return any
---@return any
function dm_wave_stepper_class:run(t0, first, steps, every, seconds) end

---s:start(re, im)
---
---Set the state to the values of psi at the points.
---@param re? any
---@param im? any
function dm_wave_stepper_class:start(re, im) end

---s:state([numbers]) -> dm.vector
---
---All that a run needs to go on bit for bit; given, it is set first.
---@param numbers? any
---@return dm.vector
function dm_wave_stepper_class:state(numbers) end

---dm.worker: another process, made by core.worker(f)
---Members of dm.sweep run in such ones; it is ended when it is collected.
---@class dm.worker
local dm_worker_class = {}

---worker:close()
---
---End the process.
function dm_worker_class:close() end

---worker:receive() -> string or nil
---
---Wait for a text; nil: the other process has ended.
---@return string|nil
function dm_worker_class:receive() end

---worker:send(text) -> boolean
---
---Is there somebody who reads it?
---@param text? any
---@return boolean
function dm_worker_class:send(text) end

---dm.GL(n) -> dm.space
---
---Regular n x n matrices. The algebra has all matrices, row by row. They act on blocks of n coordinates by g x; the momentum is the sum of the matrices p_i x_j.
---@param n? any
---@return dm.space
function dm.GL(n) end

---dm.Heisenberg(n) -> dm.space
---
---The Heisenberg group of n pairs (1 when left out), of dimension 2n + 1: vectors (x, y, z) with (a, b, c)(x, y, z) = (a + x, b + y, c + z + (a . y - b . x)/2), so that exp is the identity. It acts on blocks of 2n + 1 coordinates from the left.
---@param n? any
---@return dm.space
function dm.Heisenberg(n) end

---dm.R(n) -> dm.space
---
---Euclidean space R^n. As a group it acts on blocks of n coordinates by translation; its momentum is the sum of the momenta of the blocks.
---@param n? any
---@return dm.space
function dm.R(n) end

---dm.S(n) -> dm.space
---
---Sphere S^n of unit vectors of R^(n+1): a manifold that groups act on. A system on it has n+1 coordinates q and the constraint q . q = 1, which dm.system adds. It is no group: S:exp(z, w) and S:log(z, y) are those of its great circles, from a point z.
---@param n? any
---@return dm.space
function dm.S(n) end

---dm.SE(n) -> dm.space
---
---Rigid motions of R^n, n >= 2: x -> R x + a. Elements of SE(2) are (x, y, theta), of SE(3) and more the matrices {{R, a}, {0, 1}}; the algebra has the translations first, then the rotations of SO(n). They act on blocks of n coordinates; the momentum is (sum of p, momentum of SO(n)).
---@param n? any
---@return dm.space
function dm.SE(n) end

---dm.SL(n) -> dm.space
---
---Matrices n x n of determinant 1, n >= 2. The algebra has the matrices of trace zero, row by row without the last entry: (a, b, c) is {{a, b}, {c, -a}} for SL(2). They act on blocks of n coordinates by g x.
---@param n? any
---@return dm.space
function dm.SL(n) end

---dm.SO(n) -> dm.space
---
---Rotations of R^n, n >= 2, of dimension n(n-1)/2. The algebra of SO(3) has the vectors w with hat(w) a = w x a (cross product), of others the entries below the diagonal, column by column from (2, 1) on. They act on blocks of n coordinates; SO(2) also on blocks of 3, about the third axis. The momentum of SO(3) is the sum of q x p, of SO(2) the sum of q1 p2 - q2 p1.
---@param n? any
---@return dm.space
function dm.SO(n) end

---dm.SU(n) -> dm.space
---
---SU(2), n = 2: unit quaternions (w, x, y, z), vectors of 4, which cover the rotations of SO(3) twice. The algebra has the basis of SO(3): exp(t e_a) turns by the angle t. It acts on blocks of 4 coordinates by quaternion products.
---@param n? any
---@return dm.space
function dm.SU(n) end

---dm.Sp(n) -> dm.space
---
---Symplectic n x n matrices, n = 2k: g^T J g = J for x = (q, p) with k entries each. The algebra has the matrices {{A, B}, {C, -A^T}}, B and C symmetric: A row by row, then the upper triangles of B and of C. They act on blocks of n coordinates by g x.
---@param n? any
---@return dm.space
function dm.Sp(n) end

---dm.T(n) -> dm.space
---
---Torus T^n of n angles in rad. Paths keep the angles unwrapped, so that differences stay small; it acts on blocks of n angles by addition.
---@param n? any
---@return dm.space
function dm.T(n) end

---math.abs(x) -> number
---
---The absolute value.
---@param x? any
---@return number
function dm.abs(x) end

---math.acos(x) -> number
---
---The arc cosine, in radians; NaN outside [-1, 1].
---@param x? any
---@return number
function dm.acos(x) end

---dm.action{group=, on=, map=, side=, domain=, name=} -> dm.action
---
---The action map(g, z) of a group on the points z, vectors, of dm.R(n), dm.T(n), dm.S(n) (n + 1
---numbers) or a product of these. map: a Lua function that returns the moved point; left out: the
---standard one (matrix times vector, rigid motions, translations, SL(2) and SL(n) projectively on
---R^(n-1), SO(n+1) stereographically on R^n); or the name of one: "linear", "affine", "projective",
---"translation", "stereographic" (SO(2): of the last two coordinates of the sphere). side: "left"
---(default: map(g, map(h, z)) = map(g h, z)) or "right". domain(z) > 0 where a local action is
---defined. Identity, composition, inverse are tested at random points; what fails is an error with the
---axiom, the point and the defect. Also act(g, z).
---@param options? table
---@return dm.action
function dm.action(options) end

---dm.adapt{W=, f=, x = {from, to, elements}, ends = {a, b}} -> {x, u, energy, force, frozen, ...}
---
---The least integral of W(u') - f u over broken lines u with that many elements, over values and knots
---alike (Leok 5.6). W(s), f(x): functions; ends: u at both ends, a number or "free". x, u: knots and
---values; force: the derivative of the energy by each knot, 0 inside to round-off of those at the
---ends, so that without f W - s W_s is equal on all elements; frozen: numbers of the knots beside
---which u is affine, which nothing moves; exact: f is integrated to round-off (over up to 8192
---panels); iterations. Knots stay where all that they could gain is below rounding of the energy, as
---along very steep lines. A minimum near the one on equal elements: energies with several are not
---searched. Raises where none is found.
---@param options? table
---@return table
function dm.adapt(options) end

---dm.amplification(rule, z) -> dm.matrix, dm.vector, dm.vector
---
---The matrix of one step of a rule for (q, p) on the oscillator L = (v^2 - q^2)/2 with h = z, so z = h
---omega, and the real and imaginary parts of its eigenvalues: a pair on the unit circle is stable, one
---outside of it grows in every step.
---@param rule? any
---@param z? any
---@return dm.matrix
---@return dm.vector
---@return dm.vector
function dm.amplification(rule, z) end

---dm.animate({path, path, ...}, file, {points=, dim=, draw=, rods=, bodies=, trail=, plots=, names=, title=, frames=, t=, fps=, seconds=, size=}) -> file name
---
---A page for a browser (no network, nothing to install) in which several paths move side by side on
---one clock and one scale: with trails, energy and momentum over time, a slider, speed, and, in space,
---a camera that the mouse turns. names: one for each path; the other options are those of
---path:animate.
---@param options? table
---@param file? string
---@param options_? any
---@return string
function dm.animate(options, file, options_) end

---apropos(word)
---
---List what mentions the word, capitals or not: documented names, rules, demonstrations, examples and
---codes of failures, with how to open them.
---@param word? any
function dm.apropos(word) end

---math.asin(x) -> number
---
---The arc sine, in radians; NaN outside [-1, 1].
---@param x? any
---@return number
function dm.asin(x) end

---math.atan(y [, x]) -> number
---
---The angle of the point (x, y), x = 1 when left out, in radians.
---@param y? any
---@param x? any
---@return number
function dm.atan(y, x) end

---dm.bench(f [, k]) -> number, string
---
---Seconds of one call f(), the best of k batches (default 10) of 20 ms or one call each; and as a text
---with the spread, the largest batch over the best.
---@param f? any
---@param k? any
---@return number
---@return string
function dm.bench(f, k) end

---dm.bundle{system=, h=, segments=, bias=} -> dm.bundle   or   dm.bundle{Q=, h=, bias=}
---
---A discrete tangent bundle: to every (q, v) belongs a curve segment of duration h. segments: "straight" (the default), the name of a one-step method that follows the field of the system, or a dm.curve; bias (1/2 for straight segments, else 1): the part of h behind q. With straight segments and Q alone: Moser-Veselov pairs.
---@param options? table
---@return dm.bundle
function dm.bundle(options) end

---math.ceil(x) -> integer
---
---The smallest integer >= x. Raises on a symbol: see dm.where.
---@param x? any
---@return integer
function dm.ceil(x) end

---dm.chart{system, q=, v= | p=, t=, rules={...}, h={...}, error=, tolerances=, rivals=, samples=, repeats=, reference=, seconds=, journal=, t0=} -> dm.chart
---
---Run every rule with every step h (or `steps`: the same, or how many, all larger than t; left out:
---seven, from the coarsest that shows the motion, by halves) over the duration t (h is made to fit a
---whole number of steps) and measure error against CPU time (median of batches, set-up included,
---pinned to one core), evaluations, Newton iterations and steps. error: "position" (default: the
---largest difference of a coordinate from a reference over 32 times; on a group of elements their
---distance, of rotations the angle between them), "phase" (the time by which a run is ahead of the
---reference or behind it, the shift that fits it best, followed from the start), "precession" (how far
---it has turned besides: cyclic coordinates, else rotations of the plane or of space that L does not
---feel, in rad), "energy", "momentum" (of coordinates that L does not depend on) or a group
---(dm.SO(2)), "constraint", a function f(q, v, t, p) compared with the reference, or { f }: the change
---of f along the run. What changes along the run itself is looked at after each step, or at as many
---times as `samples` says. Errors below
---chart.floor, what the references differ by, are raised to it and marked `below`; those of more than
---0.3 of the range of the motion, which tell of no order, are marked `far`. ns is the CPU time of a
---run, setup that of its first step, kernels included.
---The reference is found: two unlike methods, each refined until they agree; where they do not come
---close enough, dm.chart raises and says how far apart they are; reference = { rule =, h = } takes one
---on your word. tolerances = { 1e-6 }: rules that solve also with Newton's method stopped at these.
---Where no rule is of the kind that preserves nothing, rk8 is measured beside them (chart.rival;
---rivals = false: not), and the table says when it wins. seconds: CPU time for all of it, in which
---pilot runs, references and points end; chart.cut says what was left out, false where nothing was.
---journal = "file": measured points are kept there, and the same call goes on where it stopped. A
---chart is never split, since times of two machines do not compare: of parts and ranks the first one
---measures (docs/sweeps.md). chart.journal is { file, found, run }.
---On a terminal's stderr a line tells how far it is from 2 s on. chart:table(), :order(rule),
---:cheapest(error), :pareto(), :plot{}, :csv().
---On Ctrl-C the error's `chart` field has what was measured so far, which a session keeps as _.
---Fields over their size: system = function(N) that returns a field (K:field, dm.field, K:euler,
---dm.multisymplectic), N = {8, 16, 32}, h a number, a list or a function of N, rule or rules, t, the
---start in functions of the position, and exact = f(x, ..., t), a formula; without it the finest size
---is compared with (through dm.remesh, or at the nodes that they share). error: "norm" (the default,
---relative) or "largest"; component: of boxes. -> dm.field_chart: chart:table(), :order(rule),
---:plot{}, :csv().
---@param options? table
---@return dm.chart
function dm.chart(options) end

---dm.cite([x]) -> string
---
---BibTeX of what stands behind x: a rule ("gauss(2)", "kahan-li(6, midpoint)"), a solver, a function
---or method (dm.moving_frame, "routh"), an action; without x of dmlua itself. Raises where nothing is
---known, with the names that are.
---@param x? any
---@return string
function dm.cite(x) end

---dm.clock() -> number
---
---Seconds of a clock that never goes back; only differences mean something.
---@return number
function dm.clock() end

---dm.commute(system, {q=, v=, h=, rule=, steps=, cyclic=, action=, mu=, ...}) -> dm.cube
---
---A dm.cube is {rule, h, steps, mu, commutes, {name, difference, order, commutes}, ...}. The cube of
---discrete Routh reduction for a system (Leok, figure 2.1): Euler-Lagrange and Hamilton's equations,
---Routh's equations, and for each its discrete one (DEL, SPRK, DR, RSPRK), run from one start and
---compared edge by edge. Edges among discrete corners commute to round-off where the rule is a
---partitioned Runge-Kutta rule; those from continuous to discrete to its order, which is measured.
---print shows the table; commutes: all of them; without: why the faces of DEL and DR are not there, if
---so (time, constraints, forces, rules without an Ld); apart: the order in h to which reduced and
---unreduced steps agree, for rules with which they are not the same. Options as in system:routh,
---connection too: with an action the cube is that of the system in (theta, x), in which rules commute
---with reduction.
---@param system? any
---@param options? table
---@return any
function dm.commute(system, options) end

---dm.compare(a, b [, {columns=}]) -> dm.comparison {worst, column, t, rows, {name, difference, t} ...}
---
---The largest difference of two paths at the times that both have, for every column of the same name
---(or of the same place, where no name is shared): how large, and when. columns: a list of names,
---"energy" too. worst, column, t: of all of them.
---@param a? any
---@param b? any
---@param options? table
---@return any
function dm.compare(a, b, options) end

---dm.complex{simplices=, points= | lengths=, dual=, vertices=, degree=} -> dm.mesh
---
---The mesh with these simplices and all their faces: simplices is a list of lists of vertex numbers from 1, or a dm.vector of them with degree =. lengths: a number, a list in the order of the edges, or a function(i, j), i < j. dual = "circumcentric" (the default) or "barycentric". dm.mesh knows meshes by name besides. Raises on repeated vertices, duplicate and degenerate simplices and impossible lengths, naming the simplex (Leok 3.3, 3.4).
---@param options? table
---@return dm.mesh
function dm.complex(options) end

---dm.connection{group=, base=, local_form= | one_form= | ..., complete=, name=} -> dm.connection
---
---dm.connection{group=, base=, form=, by=, raw=, metric=, log=} -> dm.connection
---A discrete connection A_d(q0, q1) in G on Q = base x group (Leok 4.4), from one of
---local_form(x0, x1) -> A = A_d((x0, e), (x1, e)), with A_d = g1 A g0^-1;
---one_form(q0, q1) -> A_d;
---horizontal(q0, q1) -> the second point of hor(q0, q1), A_d^-1 q1;
---lift(x0, x1, q0) -> the second point of the lift from q0;
---splitting(q0, q1) -> { q, g }, any representative of [q0, A_d];
---horizontal_splitting(x0, x1) -> q0, q1, any representative.
---Points are lists { x, g }; base is dm.R(n), dm.T(n) or a product of these. Tried at random points:
---equivariance (i) and splitting (ii) must hold (else an error with sample and defect); without
---composition (iii), A_d(q0, h q1) = h A_d(q0, q1), it is completed, A_d the g with F(q0, g^-1 q1) = e
---(complete = false: refused). On dm.T(n) a turn of an angle of both points must change nothing.
---
---form(x) -> dim G x dim S, a continuous connection g^-1 g' + form(x) x', is made discrete by "exp"
---(default), "cayley", "pade(k)", A_d = g0 exp(form(x0) (x1 - x0) + log(g0^-1 g1)) g0^-1, or
---"geodesic", by the geodesic of metric(x), a matrix in (x', g^-1 g') (then form left out is the
---mechanical one). These break (iii), with slopes 2 and 3 in the distance, and are completed, for exp
---to A = exp(form(x0) (x1 - x0)); raw = true leaves them. log = "group" takes log(q1 q0^-1) q0 of the
---semidirect product of G and R^n, as SE(3) over R^3 for SO(3); or a function log(q0, q1) -> { x',
---g^-1 g' }.
---@param options? table
---@return dm.connection
function dm.connection(options) end

---math.cos(x) -> number
---
---The cosine; x in radians.
---@param x? any
---@return number
function dm.cos(x) end

---dm.cosh(x) -> number
---
---The hyperbolic cosine.
---@param x? any
---@return number
function dm.cosh(x) end

---dm.cpu() -> number
---
---Seconds of CPU time that the process has used, also for factors of large matrices, which are made in a process of their own.
---@return number
function dm.cpu() end

---dm.curve(name [, {bias=}]) -> dm.rule   or   dm.curve{method=, bias=, order=}
---
---Curve segments for rule =: an explicit one-step method made variational, symplectic and of the order of the method. Names: straight, euler, midpoint, heun, kutta3, rk4, dopri5, butcher6, fehlberg7, dop853, and GSL's gsl-rk2, gsl-rk4, gsl-rkf45, gsl-rkck, gsl-rk8pd. method may be a function(x, f, h) or function(x, f, h, t) that gives the state x = (q, v), a vector of 2 n entries, after a step h of x' = f(x) (f(x, t) takes the time too). f:along(x, u, ...) is the derivative of f at x along u, the second one along two directions, ..., at most four, for Taylor methods: x + h*k + h^2/2*f:along(x, k), k = f(x). f:along(x, t, u, ...) takes the time too, which goes on at the rate 1 along u and at another one along { u, rate }: x + h*k + h^2/2*f:along(x, t, k), k = f(x, t). substeps = function(x, h, t): how many equal substeps of the method a step has (rounded, 1 to `most`, 4 unless given), or a list of weights of substeps (rounded to whole numbers, 0: left out), from the state at its start; held for the step, derivatives too, so that a step is symplectic wherever the choice does not change; solver:report().substeps_per_step. method and substeps are read here: upvalues of theirs keep the values that they have now. The order is found, and `order` (optional) checked against it. Methods that are linear in the values of f, as Runge-Kutta, leapfrog and Nystroem methods are, become tables of numbers; any other is written out as one expression. bias in [0, 1]: the part of a step behind (q, v), 1 unless given, 1/2 for "straight" and for symmetric rules; straight segments with bias 1/2 are the midpoint rule, with 0 and 1 the two symplectic Euler methods. Systems may have force, control, constraint and rolling. The rule as text: rule = "curve(rk4)", "curve(rk4, 0.5)" (Cuell-Patrick 2008).
---@param name? any
---@param options? table
---@return dm.rule|any
function dm.curve(name, options) end

---dm.delaunay(points) -> dm.vector
---
---The simplices of the Delaunay triangulation of the rows of a matrix, of 1 to 8 coordinates: numbers of points from 1, n + 1 a simplex; dm.mesh{points =} makes the mesh of them. Of points on one sphere, as in grids, it takes one triangulation of many, chosen by their coordinates: the order of points does not matter. Raises on duplicate points and on points in a smaller space, and where qhull (libqhull-dev) is missing.
---@param points? any
---@return dm.vector
function dm.delaunay(points) end

---demo()   or   demo(name [, {number = value}])
---
---Guided demonstrations: without a name the list of them; with one it shows what one would type, runs
---it and explains what came out. On a terminal it waits after every step (q stops), and asks for
---another number to run again with; elsewhere it runs straight through.
---demo("noether", { squash = 0.1 }) begins with another number. From a shell: dmlua --demo noether
---squash=0.1
---@param or_? any
---@param options? table
function dm.demo(or_, options) end

---dm.derivative(f [, n, ...]) -> dm.function
---
---The exact derivative of f, a Lua function of a vector of n entries (arguments as for dm.trace) or a dm.function: called on x it gives the gradient as a vector; the matrix of derivatives where f gives a vector; a number where f takes and gives one number. Raises as dm.trace does.
---@param f? any
---@param n? any
---@param ... any
---@return dm.function
function dm.derivative(f, n, ...) end

---dm.diffeo(K1, K2) -> dm.diffeo   or   dm.diffeo(K1, f) -> dm.diffeo
---
---The map of a mesh to another one with the same simplices and other points: vertices go to vertices,
---each cell to its namesake by a linear map. f(t): a family, whose values are meshes or lists of
---points; phi(t) is its member. Raises where the meshes are of two complexes, and where a cell is
---inverted (in a space of the dimension of the mesh); degenerate images are no meshes, so dm.mesh
---names their cell (Leok 3.13).
---@param K1? any
---@param K2? any
---@return dm.diffeo
function dm.diffeo(K1, K2) end

---dm.differential_invariants{action=, independent=, cross_section=, branch=, invariants=} -> calculus
---
---The differential invariants of a left action on dm.R(n) by the moving frame of a cross-section of
---its jets, in exact formulas. independent: as in action:jet, an entry of the point or a list of them;
---left out: curves with a parameter that the group leaves alone. cross_section(z): of the jet, in the
---order of action:jet, as many numbers as the group has dimensions, each linear in an entry, such as
---z[3] or z[4] - 1; branch(z) > 0 on it. invariants = { kappa = 4 } names entries of the normalized
---jet; the others follow from these and their derivatives kappa_s = D kappa along the invariant
---arclength omega = iota(dx) (by several variables kappa_1, kappa_2, whose derivations do not commute;
---by a parameter x kappa_x). Methods: iota, recurrence, syzygies, operator, maurer_cartan,
---euler_lagrange, conservation_law, extremal, invariants. Raises where the section is not transversal
---(the isotropy of the jets), cannot be solved, or an invariant that is needed has no name.
---@param options? table
---@return any
function dm.differential_invariants(options) end

---dm.discrete_lagrangian{Q=, h=, Ld=, name=, coordinates=, units=, params=, derivatives=, constraint=, rolling=, reaction=, force=, map=, crossings=} -> dm.discrete_lagrangian   or   dm.discrete_lagrangian(system, {rule=, h=})
---
---The latter with any stage rule ("galerkin(3, lobatto(4))", "gauss(2)", "midpoint" ...), or with "exact": the action of the motion from q0 to q1 itself, by gauss(8) on as many pieces as round-off needs (Leok 5.1.1); it raises where q0 and q1 are conjugate or no motion is found. A force of the system is in p0 and p1 by the quadrature of the rule (Leok 2.8.2).
---Ld(q0, q1), Ld(q0, q1, h) or Ld(q0, q1, h, params): approximately the action from q0 to q1 in the time h. Step it with dm.solver{Ld}; Ld(q0, q1) is its value. constraint(q): what is to be zero at every node, D2 Ld(q0, q1) + D1 Ld(q1, q2) + G^T lambda = 0 (a run gives lambda with record = { "impulses" }); momenta are D2 Ld, as they are. crossings: as of dm.system. map(q, p): the step of Ld, q1 and p1 as one list (with constraints, holonomic and rolling, an impulse for each behind them), where it is known: runs then take it (rule "map") in place of solving for q1. It is compared with Ld and its forces at made-up points here, and at the start of every run: raises with the point where it is not their step. rolling(q0, q1 [, h [, params]]): what is to be zero between two nodes; reaction(q0, q1 [, h [, params]]): a row of dim Q numbers for each, in whose directions it reacts (the rows span the annihilator of the virtual displacements at q0; Cuell-Patrick 3). force(q0, q1 [, h [, params]]): { F1, F2 }, dim Q numbers each, the discrete forces at q0 and at q1: p0 = -D1 Ld - F1, p1 = D2 Ld + F2 (Leok 2.8.2). On a group elements take the place of q, and covectors (momenta, F1 and F2, rows of reactions) are those of the body, d numbers along g exp(e); of a system rule is lie(s): class dm.group_lagrangian.
---@param options? table
---@return dm.discrete_lagrangian
function dm.discrete_lagrangian(options) end

---dm.drift(t, y) -> {per_time, error, mean, largest}
---
---What path:drift finds, for numbers y at growing times t (vectors of at least 3 entries).
---@param t? any
---@param y? any
---@return table
function dm.drift(t, y) end

---dm.embeddable(D [, {tolerance=}]) -> boolean, dm.vector, number
---
---Are there points of a Euclidean space with the distances D[i][j]? The eigenvalues of -J D^2 J / 2,
---D^2 of the squares and J = 1 - 1 1^T / n, tell: none may be below -tolerance (1e-10) of the largest.
---The third result is how many are above: the dimension (Leok, Ex 3.4).
---@param D? any
---@param options? table
---@return boolean
---@return dm.vector
---@return number
function dm.embeddable(D, options) end

---dm.euler_poincare{group=, l=, h=, advected=, a=, name=} -> dm.system   or   (system) -> dm.system
---
---The reduced system of a Lagrangian l(xi) of the body velocity on a group, or of a Hamiltonian h(mu)
---of the body momentum (Lie-Poisson; h may be singular); l(xi, a) and h(mu, a) have a quantity a =
---g^-1 a0 that is carried along by the linear action `advected` (a dm.action or a function of (g, a)),
---as gravity in a heavy top. Or that of a system on a group whose L or H does not depend on g; raises
---at the first point where it does. Runs take p or v (and a, the quantity at the start; in ensembles
---one for all or, as a list or a function of the member, one for each, which are traced one by one)
---and begin at the identity, as do ensembles, sections, charts, scenes, stability maps and all that
---measures a run; path.p is the body momentum, also path.mu, which moves on a coadjoint orbit;
---path:reconstruct{q = g0} is the path on the group that begins at g0. lie(s) steps mu1(f_(k-1)) =
---mu0(f_k) (Leok 5.4).
---@param options? table
---@return dm.system|any
function dm.euler_poincare(options) end

---dm.exact(f [, g] [, {over=}]) -> {exact, mono, epi, short, splits, section, retraction, cokernel}
---
---Is A -f-> B -g-> C exact, im f = ker g? Maps are lists of rows of integers; over = "Z" (the
---default), "Q" or a prime. mono: is f one to one; epi: does g reach all of C; short: is 0 -> A -> B
----> C -> 0 exact; splits: then, is B the sum of A and C? section: h with g h = 1, retraction: k with
---k f = 1, where there are any; if both and exact, k h = 0. cokernel of f: rank, torsion. Without g it
---is C = B/im f, which over Z may have torsion: 0 -> Z -2-> Z -> Z/2 -> 0 does not split (Leok,
---appendix A).
---@param f? any
---@param g? any
---@param options? table
---@return table
function dm.exact(f, g, options) end

---dm.example(name) -> string or nil
---
---What is typed at a prompt and answered for a function, a method or a class by its name in help:
---dm.example "path.drift"; nil of a name that help does not know.
---@param name? any
---@return string|nil
function dm.example(name) end

---math.exp(x) -> number
---
---The exponential.
---@param x? any
---@return number
function dm.exp(x) end

---dm.extremum(value, f, y, q, v) -> value
---
---Says of the value that a Lagrangian returns at its own arguments q and v that it is f(q, v, y, t) at the y (a list) for which f is stationary: its derivatives are then made from those of f (f_x, and f_xx - f_xy f_yy^-1 f_yx), which is less to compute than those of a formula with y eliminated. Raises when f(q, v, y, t) is not the value, or not stationary at y. Changes nothing anywhere else.
---@param value? any
---@param f? any
---@param y? any
---@param q? any
---@param v? any
---@return any
function dm.extremum(value, f, y, q, v) end

---dm.fft(x [, y]) -> re, im
---
---The discrete Fourier transform of x + i y, n numbers each (y left out: 0), n >= 1: entry k + 1 is sum_j (x_j + i y_j) exp(-2 pi i j k/n), j, k = 0 .. n - 1, as two dm.vectors. By FFTW, where dm/fft.so was built (libfftw3-dev), else by GSL, which takes n^2 operations for large prime factors of n. Raises on entries that are not finite and on vectors of two lengths.
---@param x? any
---@param y? any
---@return any
---@return any
function dm.fft(x, y) end

---dm.field{x = {from, to, cells, periodic=}, L=, values=, fixed=, absorbing=, params=} -> dm.line_field
---
---A field on a line: L(u, ut, ux, x, t) is its Lagrangian density; u is a number, or with values = n a
---vector; params: a table that L gets as its last argument. Cells of space and time are bilinear, and
---their action is made stationary (Leok 5.1.2). fixed = "ends", "left", "right": u stays there as at
---the start. Other ends are natural: the momentum of the field flows out of none. absorbing = "ends",
---"left", "right", c for both or { left = c, right = c }: the force -c u_t at the end node, c = 1 by
---default, lets waves out whose impedance c is; field:reflection() says how much of others comes back.
---See solver, stability_limit, resume.
---@param options? table
---@return dm.line_field
function dm.field(options) end

---dm.figure{panel, panel, ..., file=, title=, columns=, share=, letters=, width=, height=, size=, dpi=, font=, fontsize=, linewidth=, text=, ascii=} -> file or nothing
---
---Several plots in one picture. Each panel is a list of series { x =, y =, name = } (path:series makes
---them), or x, y, with the options of dm.plot: { orbit:series("q1", "q2"), equal = true, title =
---"orbit" }. Panels stand in `columns`, their edges in line; share = "x", "y" or "xy": one range for
---all, with texts on the last panels alone; letters = true: (a), (b), ...
---@param options? table
---@return any|nil
function dm.figure(options) end

---dm.filon(quadrature, z) -> re, im, nodes
---
---Filon's weights b_i(z) = int_0^1 l_i(x) exp(i z x) dx on the nodes of a quadrature ("lobatto(5)",
---or { nodes = }; at most 8), l_i their Lagrange polynomials: the integral over a step h of
---F(t) exp(i w t) is about h sum_i b_i(w h) F(c_i h), exactly where F has a degree below the number
---of nodes. Real and imaginary parts, and the nodes in [0, 1], as vectors. Filon 1928; Leok 5.7.2.
---@param quadrature? any
---@param z? any
---@return any
---@return any
---@return any
function dm.filon(quadrature, z) end

---dm.five_lemma{top=, bottom=, maps=, over=} -> {commutes, exact, maps, says, holds}
---
---The five lemma on a diagram of two rows: top and bottom are lists of two maps, short exact rows, and
---maps the three between them; or four, and five. commutes, exact: is the diagram as the lemma asks?
---maps[i]: mono, epi, iso of each; says: what the lemma then says of the one in the middle; holds: so
---it is. over as for dm.exact (Leok, appendix A).
---@param options? table
---@return table
function dm.five_lemma(options) end

---math.floor(x) -> integer
---
---The largest integer <= x. Raises on a symbol: see dm.where.
---@param x? any
---@return integer
function dm.floor(x) end

---math.fmod(x, y) -> number
---
---The remainder of x / y with the sign of x. Raises on a symbol.
---@param x? any
---@param y? any
---@return number
function dm.fmod(x, y) end

---dm.galerkin{degree=, nodes=, weights=} -> dm.rule   or   dm.galerkin{functions= | curve=, parameters=, start=, quadrature=} -> dm.rule
---
---A Galerkin variational integrator for rule =: curves of that degree, the action by a quadrature with these nodes in [0, 1] (growing) and weights (sum 1; left out: those exact to the highest degree). Quadratures with names need no object: rule = "galerkin(3, lobatto(4))". Raises, with the degree, when the quadrature is not exact enough (Marsden & West 2001, 2.6; HLW VI.6).
---functions = function(t, h) return { 1, t, math.cos(t) } end: curves in the space of these functions, t from 0 to h, for every coordinate, or a list of such functions, one a coordinate. Or any curve: curve = function(t, z, h) -> the coordinates, z of `parameters` numbers, for which start = function(q, v, h) gives the first guess. quadrature: a name, "gauss(8)", { nodes =, weights = }, or { "gauss(4)", pieces = 5 }. A step solves for z and the momentum at its end (Leok 5.2). Raises for functions that depend on each other, that leave an end no freedom, or that the quadrature does not tell apart.
---@param options? table
---@return dm.rule|any
function dm.galerkin(options) end

---dm.group{basis=, form=, name=} -> dm.space   or   {dimension=, identity=, mul=, inv=, exp=, log=}
---
---A group of one's own. basis: square matrices E1, ... of numbers, a basis of the algebra, which must
---be closed under brackets; elements are the matrices that their exponentials make, with g^T J g = J
---where form = J is given. Or elements are vectors of as many numbers as `identity` has, with the
---functions mul(a, b), inv(g), exp(xi), log(g) of vectors; xi has `dimension` entries. exp must have
---its derivative at 0. Ad(g, xi), ad(xi, eta) and all differentials are derived from the graph where
---they are left out. The axioms are tested at random points: an error names the first that fails, and
---where. Such a group goes wherever a built-in one does: systems, products, actions, momentum maps,
---moving frames, lie(s).
---@param options? table
---@return dm.space|table
function dm.group(options) end

---help(x)
---
---What x is: the doc of a function, the class and methods of a value, the content of a table; for a
---string a topic ("keys", "options", "rules", "classes", "demos", "examples", "failures"), a class
---("dm.path"), a name ("solver.run"), a rule, a code of a failure ("no_convergence"), a demonstration
---or an example.
---@param x? any
function dm.help(x) end

---dm.hyperdual(f [, a, b, ab]) -> dm.hyperdual
---
---The number f with the derivatives a, b along two directions and ab along both (0 when left out): functions of hyperdual(x, 1, 1, 0) have f, f', f' and f'' in the fields f, a, b, ab (Fike & Alonso 2011).
---@param f? any
---@param a? any
---@param b? any
---@param ab? any
---@return dm.hyperdual
function dm.hyperdual(f, a, b, ab) end

---dm.identity(n) -> dm.matrix
---
---The n x n unit matrix.
---@param n? any
---@return dm.matrix
function dm.identity(n) end

---dm.ifft(re [, im]) -> x, y
---
---The inverse of dm.fft: sum_k (re_k + i im_k) exp(2 pi i j k/n)/n.
---@param re? any
---@param im? any
---@return any
---@return any
function dm.ifft(re, im) end

---dm.invariant_problem{frame=, L=, points=, invariants=, constraint=, inside=, name=} -> problem
---
---The variational problem sum L(I) = extremal over sequences of points, invariant under the action of
---the frame. I[1] ... I[N] are the points moved by the frame of the first of them, I.name what
---`invariants` names: {name = {point, entry} or function(I1, ..., IN)}. points = N (default: one more
---than the frame looks at). constraint(I) gives numbers that vanish at every site, with multipliers mu
---in L - mu . constraint; inside(I) gives numbers that are > 0 where a root is allowed. The discrete
---Euler-Lagrange equations are derived and solved for the next invariants (Bogfjellmo ch. 5). Methods:
---solve, boundary, stability, momentum, action_sum, both_ways.
---@param options? table
---@return any
function dm.invariant_problem(options) end

---dm.journal(file) -> dm.journal
---
---What is finished, missing and damaged in the journal of a sweep and in its parts beside it, and what
---decided the result. Printed in full; raises where the file is none.
---@param file? string
---@return dm.journal
function dm.journal(file) end

---dm.lab{sliders=, run=, file=, points=, dim=, draw=, rods=, bodies=, trail=, plots=, names=, title=, frames=, t=} -> file name
---
---A page with sliders, for a lecture: every position was run when the page was made, so that it needs
---no server and no network. sliders = { h = { 0.01, 0.5, 12, "log" }, rule = { "verlet", "rk4" } }:
---{ from, to, count [, "log"] }, or a list of texts; run = function(h, rule) returns the path of a
---position, or a list of paths that move side by side; its arguments have the names of the sliders.
---The other options are those of path:animate, frames by default 240. Where run fails the page shows
---its message. In a notebook the page stands there without a file. Raises when the page would have
---more than 4 MB, with what to lower.
---@param options? table
---@return string
function dm.lab(options) end

---dm.lagrange_poincare{group=, base=, h=, l=, connection=, name=} -> dm.lagrange_poincare
---
---The discrete Lagrange-Poincare equations of l(x0, x1, f, h), a discrete Lagrangian on base x group
---that sees the elements as f = g0^-1 g1 alone (without a base: of l(f, h), discrete Euler-Poincare).
---p0 = -D1 l, p1 = D2 l at fixed f, whatever the connection is (left out: the trivial one), which
---enters lp:residual alone; mu1 is the left derivative by f, mu0 = Ad*(f^-1) mu1, kept on its
---coadjoint orbit to round-off. lp:solver():run{x=, p=, mu=, steps=}. The reduced equations are not
---canonical: an ordinary symplectic rule applied to them is not this one, and does not keep the orbit.
---@param options? table
---@return dm.lagrange_poincare
function dm.lagrange_poincare(options) end

---dm.load(file, {separator=, decimal=, names=, skip=}) -> table
---
---Columns of a .npy file or of a text, as path:npy and path:csv write them, or of what comes through a
---pipe ("/dev/stdin"), up to its end: data.columns lists the names, data.q1 is a dm.vector, of a field
---of arrays a dm.matrix with a row each. Of a .npy file the numbers have 4 or 8 bytes, whole ones and
---truth values 1 to 8, in any order, as rows; what stands behind the array is not read. An array has
---columns c1, c2, ... In a text commas, semicolons, tabs or blanks stand between the fields; blank
---lines and comments, from a # on, are skipped. A column of the name columns is data.columns_. Names
---are in the first line, or in the last comment above the numbers; without names the columns are c1,
---c2, ... Words beside bare numbers in the first line are refused: a row with a fault, or names that
---need quotes. A decimal comma is seen where the fields show it ("1,5;2,5"); exponents may be of
---Fortran ("1.0D+00").
---Given:
---separator = ",", ";", "tab" or "blank", decimal = "," or ".", names = a list, skip = lines to
---leave out.
---Raises with the line and the column of what is not a number. Of the journal of a sweep
---(dm.sweep, solver:ensemble) these are the members that ended well, by their number in column
---member.
---@param file? string
---@param options? table
---@return table
function dm.load(file, options) end

---dm.load_average() -> number
---
---Load of the machine over the last minute, 0 where the system does not tell.
---@return number
function dm.load_average() end

---math.log(x [, base]) -> number
---
---The logarithm, natural when base is left out; NaN for x < 0.
---@param x? any
---@param base? any
---@return number
function dm.log(x, base) end

---dm.log10(x) -> number
---
---The logarithm to base 10.
---@param x? any
---@return number
function dm.log10(x) end

---dm.matrix{{a11, a12, ...}, ...} -> dm.matrix   or   dm.matrix(rows, columns)
---
---A matrix from a table of rows (tables or vectors of one length), or of zeros. m[i][j] counts from 1, m[i] is a view of row i; * takes numbers, vectors and matrices. Raises when the rows differ in length.
---@param options? table
---@return dm.matrix
function dm.matrix(options) end

---math.max(x, ...) -> number
---
---The largest of its arguments.
---@param x? any
---@param ... any
---@return number
function dm.max(x, ...) end

---dm.mesh{simplices=, points= | lengths=, dual=, map=} or dm.mesh{name = size, ...} -> dm.mesh
---
---dm.mesh(file) -> dm.mesh
---A simplicial mesh of dimension 1 to 8: simplices, lists of vertex numbers from 1; points, a list of
---points in any space, or lengths of edges (a number, a list, a function(i, j) with i < j), or
---neither, for topology alone. Points alone: their Delaunay triangulation (dm.delaunay). map(x, y,
---...) gives the list of the moved point; dual = "barycentric" takes duals from barycentres in place
---of circumcentres: no star is zero or negative, but solutions of equations and speeds of waves err by
---some percent however fine the mesh is. dm.complex says what is refused.
---By name: grid = N (unit square), triangle = N (equilateral), annulus = {rings, m} with ratio =,
---hex_torus = N, square_torus = N, torus = {nu, nv} with radii = {R, r}, klein = n, icosphere = s,
---bcc = N (flat 3-torus), cube_tiling = N, simplex_boundary = m, cross_polytope = m, shells = {n, L},
---named = "csaszar7" | "rp2" | "dunce".
---From a file: .obj, .off, .msh (Gmsh 2.2 and 4.1), .mesh (Medit), .node and .ele (Triangle, TetGen),
---as text. Points whose third coordinate is the same everywhere lie in the plane; of .msh and .mesh
---the simplices of the highest dimension count. Errors name the line.
---@param options? table
---@return dm.mesh
function dm.mesh(options) end

---math.min(x, ...) -> number
---
---The smallest of its arguments.
---@param x? any
---@param ... any
---@return number
function dm.min(x, ...) end

---math.modf(x) -> number, number
---
---Integral and fractional part of x. Raises on a symbol.
---@param x? any
---@return number
---@return number
function dm.modf(x) end

---dm.moving_frame{action=, points=, cross_section=, branch=, solution=, start=, partial=, ...} -> rho
---
---The right-equivariant moving frame rho(z1, ..., zk) of an action on k points (`points`, default 1;
---or action:on_points(k), action:on_pairs(), a tangent or jet action with one): the group element g
---with cross_section(g z1, ..., g zk) = 0, which gives as many numbers as the group has dimensions.
---branch(z1, ..., zk) gives a number (or several) that must be > 0 on the section, where the equations
---have more than one root. solution(z1, ..., zk) gives g by formula; without it g is solved for
---(dm.root) from `start`: flat coordinates, or a function of the points that gives an element
---(default: from the identity, turns about every axis and a few elements spread over the group). When
---it is made the frame is tried at random points and under large elements of the group: it must be one
---of the group, on the section and its branch, and equivariant, wherever it is finite; an error
---has the point and the defect. A solution is trusted inside of runs; a root looks at branch and
---transversality every time. partial = true: a frame up to isotropy, where the action is not free
---(a discrete group, as half turns about the normal of a surface, is isotropy too): cross_section
---gives as many numbers as the orbits have dimensions (a slice), rho is an element that brings the
---points there, and rho(h z) is rho(z) h^-1 up to what leaves the section where it is;
---invariants are as ever. invariants: names for entries, {name = {point, entry}}, which
---dm.invariant_problem uses. Takes numbers and symbols, so what is made with it is differentiated
---exactly. Methods: rho(z...), rho:invariants, phantom, invariantize, transversality, tangent,
---correction, derivative_correction, syzygies, check.
---@param options? table
---@return any
function dm.moving_frame(options) end

---dm.msfem{a=, f=, x=, period=, antiderivative=, shape=} -> dm.msfem_solution
---
---(a u')' = f with u = 0 at both ends of the nodes x, a growing list; a and f: functions of x, a > 0.
---The shape functions follow a (shape = "multiscale", unless given), so that the values at the nodes
---are those of the solution to round-off on any mesh; shape = "linear": hats, for comparison. period:
---of a, where it varies fast; antiderivative: of 1/a, where it is known (it is checked). Integrals are
---by 12 Gauss points on panels that are halved until nothing changes; what is narrow in f or 1/a
---between nodes is looked for by their bounds, where they can be traced (f:bounds), else put nodes
---beside it. Raises on a <= 0, on nodes that do not grow, and on integrals that do not settle.
---@param options? table
---@return dm.msfem_solution
function dm.msfem(options) end

---dm.multigrid{coarsest, ..., finest, fixed = "boundary" | "nothing"} -> dm.multigrid
---
---Nested meshes: every cell of one is a union of cells of the next; or each next one has the midpoints
---of the edges as further vertices, as dm.mesh{icosphere = s} has, on a curved surface.
---mg:prolong(a), mg:restrict(b), mg:solve(b). fixed: solutions are 0 on the boundary, or free there.
---Raises where the meshes are not nested, with the cell.
---@param options? table
---@return dm.multigrid
function dm.multigrid(options) end

---dm.multiscale{frequency=, degrees=, oscillating=, nodes=, phases=, ansatz=} -> dm.rule
---
---A rule for motion that vibrates with a known frequency w (radians per unit of time;
---path:frequency reads it off a run) beside something slow, with steps over many vibrations: every
---coordinate is P(t) + S(t) sin(w t) + C(t) cos(w t), P of `degrees` (3; a list: one for each
---coordinate), S and C of degree `oscillating` (0). L is taken at nodes x phases points of time and
---phase (5 Lobatto nodes, at most 8; 9 phases, odd) and every harmonic integrated by Filon's
---weights, so that a step costs the same however stiff the spring. Rows and events inside a step are
---read off its curve. ansatz = "product": P(t) (1 + a sin(w t) + b cos(w t)), the printed space with
---w held, to compare: its equations have many roots and conditions of 1e10 and more
---(solver:report().condition). Where h w is below 3, more nodes and phases are needed (6 and 15),
---below 1/2 the space is refused. With a wrong frequency, or a second fast one, the energy goes:
---solver:report().drift says by how much of the largest v . L_v (0.03 and less where all is right),
---the path asks from 0.01 on, and above 0.2 the run ends. Leok 5.7.
---@param options? table
---@return dm.rule
function dm.multiscale(options) end

---dm.multisymplectic{M=, K=, S=, x = {from, to, cells, periodic = true}, names=, gain=} -> dm.boxes
---
---The equations M z_t + K z_x = grad S(z) for z with d components, by Preissman's box: one equation a
---box and component, between means and differences of its four corners. M, K: antisymmetric d x d
---matrices; S(z): a function of the vector z, or of its components by their names, z.u; names: of the
---components (default z1, z2, ...); gain: names of those that gain a constant round the ring (S must
---not depend on them).
---So Klein-Gordon, sine-Gordon, KdV, Schroedinger and Zakharov equations are written; boxes:solver{h=}
---steps them.
---@param options? table
---@return dm.boxes
function dm.multisymplectic(options) end

---dm.pair(a, b) -> dm.pair   or   dm.pair(q0, q1, ..., qp) -> dm.pair_tuple
---
---The element (a, b) of the pair groupoid, from its source a to its target b: numbers, lists, vectors
---or objects. g * h of (a, b) and (b, c) is (a, c), and raises where the target of g is not the source
---of h; g:inverse() is (b, a); (a, a) are the identities. More points: the p composable pairs of a
---discrete curve (Leok 3.13).
---@param a? any
---@param b? any
---@return dm.pair
function dm.pair(a, b) end

---dm.palette("lines" | "classes") -> table
---
---The colours of all pictures, as "#rrggbb": "lines" the list of six that lines take in turn,
---"classes" those of the classes of stability maps by their names. Colour-blind eyes tell them apart:
---CIE76 distances, as seen by normal, protan, deutan and tritan eyes, are at least 24 and 16.
---@param lines? any
---@return table
function dm.palette(lines) end

---dm.part() -> integer, integer
---
---k and n of dmlua --part k/n, the part of every sweep that this process runs; 1 and 1 without it.
---@return integer
---@return integer
function dm.part() end

---dm.path{system=, h=, rule=, steps=, columns = {t, q1, ..., p1, ...}} -> dm.path
---
---A path from numbers that were computed elsewhere: 1 + 2 dim Q columns of one number a row, growing times first; h: the step, rule: what made it (a text), steps: how many (default: rows - 1). It has energy, drift, plots and files like that of a run.
---@param options? table
---@return dm.path
function dm.path(options) end

---dm.pin() -> string or nothing
---
---Keep this thread on the core where it runs, so that measured times are of one core; threads that it makes stay there, too. Returns what dm.unpin takes to undo it; nothing where the system cannot.
---@return string|nil
function dm.pin() end

---dm.plot(x, y, {file=, title=, xlabel=, ylabel=, xunit=, yunit=, log=, style=, names=, legend=, equal=, xrange=, yrange=, width=, height=, size=, dpi=, font=, fontsize=, linewidth=, slopes=, marks=, minor=, text=, ascii=}) -> file name or nothing
---
---Plot y against x: two vectors or tables of numbers of one length; x and a list of columns y; or a
---list of series { x =, y =, name =, style =, colour = } (then the options come second; a colour is
---"#rrggbb" or a name). Without `file` in the terminal, in ASCII where the locale is not UTF-8; with
---it through gnuplot to a .png, .svg or .pdf. log: "x", "y" or "xy"; style: "lines", "points" or
---"linespoints"; names: texts of the legend (legend = false: none); equal: one length per unit on both
---axes; xrange, yrange: {least, largest}; width, height (or size = {width, height}): pixels in a file,
---characters in a terminal. For print: size = {8.5, 6, "cm"} ("mm", "in"), dpi (300 then), font,
---fontsize and linewidth in points. slopes = {2, 4}: triangles of these powers (log = "xy"); marks =
---{ {x, y, "text"} }: points with a text; minor = true: minor ticks. Texts of files know q_1, p_theta,
---10^{-3} and Greek names; text = "plain": as they stand. ascii = true: no other signs in the
---terminal. Points that are not finite, or not positive on a logarithmic axis, leave
---gaps and are counted below the plot. Long columns are thinned to what the picture can show, extremes
---kept.
---@param x? any
---@param y? any
---@param options? table
---@return string|nil
function dm.plot(x, y, options) end

---dm.polynomial_roots{c0, c1, ..., cn} -> dm.vector, dm.vector
---
---Real and imaginary parts of the roots of c0 + c1 x + ... + cn x^n, as eigenvalues of its companion
---matrix, with a step of Newton.
---@param options? table
---@return dm.vector
---@return dm.vector
function dm.polynomial_roots(options) end

---dm.pow(x, y) -> number
---
---The power x^y.
---@param x? any
---@param y? any
---@return number
function dm.pow(x, y) end

---dm.pretty(value, {depth=, length=, width=, colour=}) -> string
---
---The text that a session prints for a value. depth of tables in tables (4), entries of one table
---(30), characters of a line (80), colours (false).
---@param value? any
---@param options? table
---@return string
function dm.pretty(value, options) end

---dm.prismal{t0, t1, ...} -> dm.prismal
---
---Slices of time as the rule of a field: field:solver{rule = dm.prismal{...}}, without h. Space-time
---is cut into prisms over the cells of the mesh, from slice to slice; varying their action gives
---M ((A2 - A1)/h1 - (A1 - A0)/h0) = (h0 + h1)/2 dL/dA at every inner slice (Leok 3.12): symplectic, it
---keeps Gauss's law to round-off, has order 2 where steps change smoothly, and is verlet where all
---are equal.
---@param options? table
---@return dm.prismal
function dm.prismal(options) end

---dm.product(G, H, ...) -> dm.space
---
---The product of two or more spaces. Of groups: the group of lists {g, h, ...}, whose algebra has the vectors of the factors one after the other; of R(n), T(n), S(n): a space that a system can live on.
---@param G? any
---@param H? any
---@param ... any
---@return dm.space
function dm.product(G, H, ...) end

---dm.random(seed) -> dm.random
---
---Random numbers for starts of ensembles: r:uniform(i, k), r:normal(i, k) depend on the whole number `seed` and their place alone, not on what was asked before. Philox4x32-10, Salmon et al. 2011.
---@param seed? any
---@return dm.random
function dm.random(seed) end

---dm.recurrence{c0, c1, ..., cn} -> {stable, why, largest, re, im, times}
---
---The linear recurrence c0 x_k + c1 x_(k+1) + ... + cn x_(k+n) = 0 by its characteristic roots:
---bounded when none is outside the unit circle and none on it is multiple (times: multiplicities); the
---sentence `why` says which it is.
---@param options? table
---@return table
function dm.recurrence(options) end

---dm.remesh(K, M, {rule = "whitney" | "sum" | "thesis"}) -> dm.remesh
---
---T(a): a primal form on the mesh K as a form on M, a mesh of the same set |K| = |M|. "whitney" (the
---default): integrals of the Whitney form over the cells of M; exact on constant forms, T d = d T, the
---identity for M = K, and where K is coarse and M finer the exact prolongation. "sum": for cells of M
---that are unions of cells of K, their sums: the restriction to a coarser mesh. "thesis": by supports,
---sum of +-|V_t and V_s| / |V_s|, as printed (Leok 3.14): right for the highest degree alone.
---T:matrix(k) is the matrix of degree k. Raises where a cell of M is not covered by K once, with how
---much of it is; surfaces in space must have the same points, not only nearly.
---@param K? any
---@param M? any
---@param options? table
---@return dm.remesh
function dm.remesh(K, M, options) end

---dm.resume(file, system [, {rule=, backend=}]) -> dm.solver   or   dm.resume(path) -> dm.solver
---
---A solver that goes on where a run ended, from path:checkpoint(file) or from the path itself: solver:run{steps=} gives the bits of a run that never stopped. Rows of every = k are at every k-th step from there, the first where it goes on. Rule, h and Newton's tolerance are those of the checkpoint; rule: for a rule that is an object, which a file does not hold. run{file =} adds its rows to those of the run that it goes on from, and raises where the file has another state at its time. Raises when the file is not a whole checkpoint or the system is another one.
---So do runs of fields on lines, of boxes, of waves and of flows: dm.resume(run), or dm.resume(file,
---field) with the dm.field, dm.multisymplectic, dm.schroedinger or K:euler that they are of; and runs
---of fields on meshes by rule "avi" (run{t=} goes on from there) and over the slices of dm.prismal
---(those that are left, or those of { rule = dm.prismal{...} }). Runs by D = shape:discrete(Ld) go on
---with D in the place of the system.
---@param file? string
---@param system? any
---@param options? table
---@return dm.solver
function dm.resume(file, system, options) end

---dm.root{equations= | stationary=, start= | unknowns=, branch=, angles=, name=, failure=} -> dm.root
---
---The function y = f(x, ...) with equations(y, x, ...) = 0: as many numbers as unknowns; or for which stationary(y, x, ...), one number, is stationary in y. Arguments are numbers, vectors or tables of numbers. start: where Newton's method begins, a list (or a number: then y is one), a list of lists to be tried in turn, or a function of the arguments; unknowns = r without a start: r zeros. branch(y, x, ...) > 0 tells the root that is meant from others. angles = {i, ...}: these unknowns are angles in rad, of which the equations are periodic: whole turns are taken off them, so that they keep their digits. y depends on the arguments alone, not on earlier calls. In a function that is traced f has exact derivatives of any order, so Lagrangians, discrete Lagrangians, constraints, forces and events may use it; it may call other roots. Raises, or ends a run, where there is no root, dF/dy is singular or the branch is left: the message has the name, where, the residual or condition number, and the text of failure.
---@param options? table
---@return dm.root
function dm.root(options) end

---dm.rules() -> table of {name, signature, doc, order, stages, cost, symmetric, symplectic, explicit, on_groups, for_pairs, formula, own_time, instances}
---
---Every rule that a solver can use. order and stages as formulas, cost a step with n coordinates; on_groups: it steps groups by itself, not by their lift; formula: its discrete Lagrangian is a formula in L; own_time: what a step covers of t is known when it is taken; instances: {rule, order, stages, forces, symmetric, symplectic ...}, rules on which all this is measured by the tests (forces a step when L = T(v) - V(q), 0 where the rule stays implicit).
---@return table
function dm.rules() end

---dm.scaling{system=, start=, n= | members=, rules=, h=, steps=, repeats=} -> dm.scaling
---
---What a step costs as things grow. n: system = function(n) returns the system of that size, start =
---function(n) its q and v; ns is that of one step. members: system is a dm.system, start = function(i)
---gives q and v of member i of an ensemble in one thread; ns is that of a member and step. CPU time
---without set-up (which is told as `setup`), the median of `repeats` batches (3) of `steps` steps
---(1000), pinned to one core; more steps where set-up would be most of it. points[i] = {rule, size,
---ns, setup}; s:exponent(rule): cost like size^exponent at the upper half of the sizes; s:table(),
---s:plot{file=}.
---@param options? table
---@return dm.scaling
function dm.scaling(options) end

---dm.scene{system, q=, v= | p=, watch=, tolerance=, until_t=, t0=, symmetry=, rules=, profile=, costs=, seconds=, frame=, per_step=, project=} -> dm.scene
---
---The cheapest model and method that deliver what is watched. watch: names of coordinates, momenta
---("p1") or "energy", name = function(q, v, t, p) ... end, or "picture": every coordinate, to a pixel.
---tolerance: the largest error of each watched number at every time up to until_t, in its units, or a
---table name -> tolerance. Models: the system as given, without constraints that follow from the
---others (system:independent; with project they stay, and are refused); without coordinates that
---nothing watched feels; in relative coordinates where a common motion changes nothing; in the plane
---of motion where turns change nothing; cyclic coordinates reduced away (Routh), also those of a
---symmetry = { action = f(theta, q), section = f(x) } as for system:routh; linear, in the modes that
---are seen, with drag, gyroscopic terms and forces in t too that are sums of c t^k e^(mu t), solved in
---closed form (scene.best.rule is "exact"); stiff terms of L as constraints; coordinates at rest held;
---terms left out where that stays inside the tolerance. Rules: all of dm.rules(), log-hamiltonian(...)
---and "controlled(rk8)", whose steps are as long as their error allows, or a list `rules`. All of it
---is measured against two unlike methods with controlled steps that jump over nothing hidden in the
---forces, and checked at other times and between them; where the tolerance cannot be promised,
---scene:run() raises with everything that was measured (docs/theory/trust.md). Costs are counted
---operations (scene.best.work), so that two scenes choose alike; costs = "clock" measures ns; profile:
---a file of scene.profile:save(file) has them. seconds: CPU time to be spent on looking (default 20);
---scene.cut says what they left out. frame, per_step: each frame of model time costs at most per_step
---seconds, as exactly as rules of fixed work can, or those of few iterations under constraints, where
---something rolls, for L linear in v (scene.best.worst_step; with a tolerance: both, or it raises;
---without one a plain run has a row a frame, whose error_estimate knows of no lines between them). On
---a group entries of the element are watched (R31, of factor k R31_k), body momenta (p1), "energy" and
---functions (g, xi, t, mu); the model is the system as given, as it is of an H without a Lagrangian;
---one that is reduced (dm.euler_poincare) starts from p or v, and a. scene:run(), scene:why(),
---scene:animate(file); scene.candidates, scene.best = { model, rule, N, h, n (dimension), work, ns,
---error (of the tolerance, 1 at most) }.
---@param options? table
---@return dm.scene
function dm.scene(options) end

---dm.schroedinger{x = {from, to, N}, V=, hbar=, m=, g=, space=, boundary=} -> dm.schroedinger
---
---The equation i hbar psi_t = -hbar^2/2m psi_xx + (V + g |psi|^2) psi in one dimension. On a ring
---(boundary = "periodic", unless given) of the even number N of points from + (j - 1) (to - from)/N;
---boundary = "walls": psi = 0 at both ends, N Chebyshev points with the ends among them. V: a function
---of x, a number (0) or a list of N values; hbar = m = 1 and g = 0 unless given. space =
---"collocation", or "galerkin" on a ring: Leok's trigonometric polynomials with exact integrals of the
---interpolated V, g = 0. Raises on odd rings, where V is not finite, and on V of x and t.
---@param options? table
---@return dm.schroedinger
function dm.schroedinger(options) end

---dm.semidirect(G, V [, action]) -> dm.space
---
---The semidirect product of a group G and V = dm.R(n): lists {g, v} with (g, v)(h, w) = (g h, v + g w), where g w is action(g, w), linear in w (left out: the standard one of G, matrix times vector). The algebra has that of G first, then V.
---@param G? any
---@param V? any
---@param action? any
---@return dm.space
function dm.semidirect(G, V, action) end

---dm.sequence{equation=, next=, start=, y=, unknowns=, steps=, inside=, every=, check=} -> dm.matrix, report
---
---The sequence y, y', y'' ... with y' = next(y, x) where x, of `unknowns` numbers, is the root of equation(y, x) = 0 that Newton's method finds from start(y). The functions are traced once, with vectors y and x, and run in C. inside(y, x) gives numbers that must be > 0 at the root. scale(y) gives the sizes of what the unknowns are added to, where x is a small difference. check = false trusts the traces without comparing them with plain calls. Rows: y at the start, every `every` steps, and at the end. report: code ("ok", "no_convergence", "singular", "not_finite"), text, done (steps), outside (which condition the root broke, from 1), iterations, residual. A step that fails ends the sequence without an error: look at report.code. Ctrl-C raises a dm.failure, whose path has the rows so far.
---@param options? table
---@return dm.matrix
---@return any
function dm.sequence(options) end

---dm.sign(x) -> number
---
---1, 0 or -1: the sign of x; its derivative is taken as 0.
---@param x? any
---@return number
function dm.sign(x) end

---dm.simplicial_map(K, L, vertices) -> dm.simplicial_map
---
---The simplicial map that sends vertex i of the mesh K to vertex vertices[i] of L. Raises where a
---simplex does not go to a simplex. f:push(chain), f:pull(form), f:homology(k).
---@param K? any
---@param L? any
---@param vertices? any
---@return dm.simplicial_map
function dm.simplicial_map(K, L, vertices) end

---math.sin(x) -> number
---
---The sine; x in radians.
---@param x? any
---@return number
function dm.sin(x) end

---dm.sinh(x) -> number
---
---The hyperbolic sine.
---@param x? any
---@return number
function dm.sinh(x) end

---dm.smith(A) -> {factors, rank, D, U, V}
---
---Smith's normal form of a matrix of integers, a list of rows: D = U A V is diagonal, U and V have
---determinant 1 or -1, and each of the factors, > 0, divides the next one. Raises where an integer
---leaves 64 bits on the way.
---@param A? any
---@return table
function dm.smith(A) end

---dm.solver{system, rule=, h=, newton={tolerance=, max_iterations=}, backend=, sums=, threads=} -> dm.solver
---
---A solver for a dm.system (rule and h needed: see dm.rules()) or a dm.discrete_lagrangian (which has its own h; rule "del"), or of anything else with a method solver. newton.tolerance: relative increment at which Newton stops, 4e-15 unless a looser one is asked for. sums = "plain": kicks and drifts without compensation, for wide ensembles and long chains: fewer operations, and round-off that grows faster (default "compensated"). threads: of a step, of fields on meshes by kicks and drifts and rattle, and of sums over pairs of 64 bodies or more by kicks and drifts; the bits are those of one.
---@param options? table
---@return dm.solver
function dm.solver(options) end

---dm.sprk{a=, b=, A=, B=, c=, name=} -> dm.rule
---
---A symplectic partitioned Runge-Kutta method for rule =: positions by (a, b), momenta by (A, B), s rows of s numbers and s weights, c the times of the stages (left out: the sums of the rows of a). A and B left out: the partner, A_ij = b_j (1 - a_ji / b_i). Raises when b_i A_ij + B_j a_ji = b_i B_j or b = B is violated, with the defect and where; b and B may differ in tables of kicks and drifts, which step L = T(v) - V(q). Its order is measured when it is made (HLW VI.4).
---@param options? table
---@return dm.rule
function dm.sprk(options) end

---math.sqrt(x) -> number
---
---The square root; NaN for x < 0.
---@param x? any
---@return number
function dm.sqrt(x) end

---dm.stability{system=, q=, v= | p=, rule= | rules=, h=, steps= | t=, k=, ..., watch=, observe=, accuracy=, inside=, drift=, chaos=, refine=, seconds=, journal=, ...} -> dm.stability_map
---
---Where does a method fail? A map over the step h and up to two parameters of any name. An axis is
---{least, largest, count, "log" | "linear"}, a list of growing numbers (three numbers without the word
---are one, too) or one number. A parameter is an argument of that name of the function that makes the
---system (system = function(k) return dm.system{...} end), or of functions q, v, p that give the
---start, or is among the params of a system. Parameters that are whole numbers stay such: of fields on
---meshes and lines (dm.field, with u and ut in the place of q and v) a parameter may be a size,
---system = function(N) return dm.mesh{grid = N}:field{...} end, and q, v functions of the position;
---map:theory is then the CFL limit. Every cell is run in C, on all cores, over the same
---number of steps or the same duration t, and told apart by its rows: bounded, wrong (bounded, but
---further from the resolved flow than the accuracy), drifting (a slope of the energy above 5 standard
---errors that moves it by more than drift = 1e-6 of the kinetic energy),
---chaotic (MEGNO above 4, by the exact tangent map; chaos = false leaves that out, as is the default
---for implicit rules and more than 4096 cells: chaos that keeps its energy is bounded then),
---off (an energy that has gone far elsewhere), blow-up,
---left (inside(q, v, t, p) > 0 no longer holds), no convergence, constraint lost, no start (map:at
---says why), no value (of watch).
---With a duration t cells are compared with the resolved flow, two unlike rules with unlike steps that
---agree to a thousandth of the accuracy: wrong is where at some step up to t an observable is further
---off than accuracy (0.01) times its range, greatest less least value of the flow, or the velocity
---leaves the constraints by so much of |G| |v|. observe: names of coordinates (left out: all, of more
---than 48 so many, evenly), momenta (p_x), "energy", or name = f(q, v, t, p). accuracy = false:
---nothing is compared. Where the flow is chaotic it is known up to a time (horizon of map:at), and
---cells are compared up to there.
---Of a field on a mesh values are observed, and the range is that of the value that changes most.
---On lines (dm.field) the flow is that of the field itself, of cells ever finer in space and time, so
---that a mesh too coarse is wrong, too; u and ut are then functions of x, and observe takes u (u1, ...
---where it has several values; the range is that of all nodes) or name = f(u, nil, t).
---watch = f(q, v, t, p): what shall not drift, in place of the energy. Borders to what is lost, and to
---what is wrong, are refined to resolution = 1e-3 (refine = false: not). seconds: CPU time after which
---cells are left out; map.cut says which. map:limit(row), :limit(row, "right"), :theory(row),
---:resonances(row), :at(row, column), :table(), :plot{file=}, :csv(file); map.h, map.k, ... are the
---axes, map.rows the rows, map.notes
---what to know of the start and the axes (an equilibrium does not move, whatever the step; a parameter
---that changes no cell).
---journal = "file": finished cells are kept there, and the same call goes on where it stopped, by
---parts and ranks as ensembles do (docs/sweeps.md); borders are refined again by the whole call.
---map.journal is { file, found, run }.
---On a group entries of the element are observed (R31, of factor k R31_k), where observe is left out
---all of them, and body momenta (p1); a reduced system (dm.euler_poincare) starts from p or v (and a)
---alone, and its momenta are observed.
---Other options: t0, threads, project, newton, backend, sums, as in solvers and ensembles. Ctrl-C ends
---it with dm.failure, whose field `map` is what is there.
---@param options? table
---@return dm.stability_map
function dm.stability(options) end

---dm.stability_limit(rule [, {tolerance=}]) -> z, {cause, gaps, resonances}
---
---The linear stability of a rule: the largest z = h omega up to which no root of its amplification
---matrix on the oscillator leaves the unit circle by more than tolerance (1e-6), by bisection;
---infinity when none does up to 1e4. gaps: {from, to} of all intervals that are lost; resonances:
---{n, z}, where a step turns by 2 pi / n (n = 3 to 6): near these a symplectic rule is unstable in
---nonlinear forces, for n = 3 however small the amplitude; cause: a sentence.
---@param rule? any
---@param options? table
---@return any
---@return table
function dm.stability_limit(rule, options) end

---dm.stationary{term=, sites=, block=, window=, x=, given=} -> dm.vector, report
---
---The sequence x of `sites` blocks of `block` numbers for which the sum of term(w) over all windows w of `window` neighbouring blocks (a vector) is stationary, from the guess x by Newton's method on the whole (a band). given: a list of booleans, true for the numbers that stay. report: code ("ok", "no_convergence", "singular", "not_finite"), text, iterations, residual (the largest derivative left). Look at report.code: x is no solution when it is not "ok". Ctrl-C raises a dm.failure, whose path is x so far.
---@param options? table
---@return dm.vector
---@return any
function dm.stationary(options) end

---dm.step{equation=, next=, start=, unknowns=, order=, name=, parts=, begin=, inside=, scale=, sums=} -> dm.rule
---
---A rule from three functions, traced once for the system that it steps and solved in C: x, of `unknowns` numbers, is the root of equation(y, x, h, m) = 0 that Newton's method finds from start(y, h, m), to round-off and with the exact Jacobian; next(y, x, h, m) is the state behind the step, { q =, p = }. y has q (an element on a group), p, t, and parts of its own: parts = { { "E", 1 }, { "F", 3 } } are a number y.E and a vector y.F, which begin(q, p, h, m) sets at the start, { E =, F = } (left out: 0), and next gives anew; what it does not give stays. They are columns of paths and go into checkpoints. t grows by h unless next gives it: the steps have a time of their own then. m has functions of the system and their exact derivatives: L(q, v, t), L_q, L_v and H(q, p, t), H_q, H_p (of an L, where it is quadratic in v); on groups v is xi and L_q the derivative along the body velocity. inside(y, x, h, m) gives numbers that must be > 0 at the root, scale(y, h, m) the sizes of what the unknowns are added to, where x is a small difference. With sums = true next gives what the step adds to q (on a group: to `flat`, the coordinates of y.q that y has too) and to p, and runs sum it to twice the digits. The declared order is measured in the first run on a system, which raises where it is less; print(solver) says what was found, or why nothing can be told (ends that differ by round-off, steps that do not resolve the motion). It is that of steps of h, h/2 ... beside each other: that they tend to the motion of the system, and no other, is what a chart shows. At the start of a run traces are compared with plain calls; a q that is off its group by more than 1e-8 ends the run. Such a rule looks for events, fills ensembles, goes on from checkpoints and has a tangent map as any other.
---@param options? table
---@return dm.rule
function dm.step(options) end

---dm.sum_over(x, ..., f [, {shift=, periodic=, pairs=, within=, margin=, box=, block=}]) -> number
---
---Sum of f over equal bodies. f gets what a body has of every vector (f(x_i, u_i, m_i) for dm.sum_over(q, v, masses, f)), numbers are passed on as they are, behind. shift = k: f also gets the same of body i + k (f(x_i, x_j)), periodic = true: the last ones meet the first. pairs = true: all pairs i < j. within = r: of these the ones nearer than r alone, by the positions in the first vector (1 to 3 coordinates), found by lists that are kept until a body has moved margin/2 (margin: r/10 by default); box = L or a list of sides (math.huge: open): a periodic box, sides at least 2 (r + margin), in which f gets the image of x_j that is nearest to x_i. A term that does not end at 0 at the distance r makes the energy jump there. block = 3: a body has 3 neighbouring entries, f gets vectors. In L of a system f is traced once and the sum stays a loop in the kernels: a chain of 10^5 bodies costs 100 times one of 10^3. f must not use other arguments of L than those it is given. Loops are for explicit rules, for kinetic energies that are sums of m v^2/2 and without constraints; implicit rules, constraints and forces write the sums out, up to 400 coordinates, but none within a distance.
---@param x? any
---@param ... any
---@return number
function dm.sum_over(x, ...) end

---dm.sweep{members=, run=, journal=, workers=} -> dm.sweep
---
---Call run(i) for i = 1 .. members in processes of their own (workers; default: one a core). run
---returns a number (column "value"), a list (x1, x2, ...) or named numbers: sweep.a is the column of
---all members, a dm.vector. A dm.failure that it raises is the status of the member, NaN in the
---columns; any other error ends the sweep and names the member. Random numbers are those of
---dm.random(seed), which do not depend on the process. journal = "file": finished ranges of members
---are kept there, and the same call goes on where it stopped (docs/sweeps.md). What run changes
---outside of itself is lost with its process.
---@param options? table
---@return dm.sweep
function dm.sweep(options) end

---dm.system{Q=, L= | H=, constraint=, rolling=, force=, control=, reaction=, name=, coordinates=, units=, params=, derivatives=, crossings=} -> dm.system
---
---A mechanical system on the space Q with the Lagrangian L(q, v), L(q, v, t) or, with params, L(q, v, t, params); q, v are vectors of dim Q entries. L is called with symbols at every run, so a changed upvalue is picked up. coordinates: dim Q names, used for columns; units: table name -> unit, used for labels; derivatives: "exact" (traced, the default) or "hyperdual" for functions that branch on the state. Raises when L cannot be traced, with what to use instead.
---H(q, p), H(q, p, t) or H(q, p, t, params) in place of L: a Hamiltonian. Quadratic in p with a regular mass it is taken as its Lagrangian, in the field L, and every rule steps it; functions of a state get v = dH/dp. Any other (point vortices, H = q p, a relativistic particle) is stepped as it stands, by rules of stages and explicit rules, and starts from q and p, or from v where dH/dp = v has a solution.
---constraint(q [, t]) returns what shall be zero along every path (holonomic: reactions along its gradient), rolling(q, v [, t]) what shall be zero of the velocities (reactions along its derivative in v, Chetaev's rule, or along the rows that reaction(q, v [, t]) returns), force(q, v [, t]) dim Q numbers (friction, driving) that are added to dL/dq (discrete Lagrange-d'Alembert); with control(q, v [, t]) it is force(q, v, t, u), where u is what control returned at the start of the step and is held over it; each a number, a vector or a table, traced like L. Rules without them refuse the system and name others. A step over a place where constraints cross, as the flat position of a parallelogram, ends the run; with crossings = true steps go over it, mostly straight on.
---@param options? table
---@return dm.system
function dm.system(options) end

---math.tan(x) -> number
---
---The tangent; x in radians.
---@param x? any
---@return number
function dm.tan(x) end

---dm.tanh(x) -> number
---
---The hyperbolic tangent.
---@param x? any
---@return number
function dm.tanh(x) end

---dm.terminal([stream]) -> {tty, colour, width, height}
---
---What "stdout" (the default), "stderr" or "stdin" is: a terminal or not, whether to write colours to it (the option --color, FORCE_COLOR, NO_COLOR), and the characters of a line and lines of the screen (80 and 24 when unknown).
---@param stream? any
---@return table
function dm.terminal(stream) end

---dm.time(f, ...) -> number, string
---
---Seconds of one call f(...): the best of several batches, each long enough to be measured; and the
---same as a text in ns, us or ms. Takes about a fifth of a second, or two calls when one takes
---longer.
---@param f? any
---@param ... any
---@return number
---@return string
function dm.time(f, ...) end

---math.tointeger(x) -> integer
---
---x as an integer, or nil. Raises on a symbol: see dm.where.
---@param x? any
---@return integer
function dm.tointeger(x) end

---dm.trace(f [, n, ...]) -> dm.function
---
---Trace the Lua function f once: n, ... are the numbers of entries of its vector arguments, or "number" for a bare number (one number when nothing is given). The result is called like f, on vectors, tables or numbers, and has exact derivatives; upvalues keep the values they have now. f gives a number, or a vector or table of numbers. Raises when f branches on an argument, or returns no number; that is found by calls of f at points of all sizes, which "unchecked" behind the lengths leaves out.
---@param f? any
---@param n? any
---@param ... any
---@return dm.function
function dm.trace(f, n, ...) end

---dm.unpin(before) -> boolean
---
---Undo dm.pin(): `before` is what it returned. Whether it was done; nothing without an argument.
---@param before? any
---@return boolean
function dm.unpin(before) end

---dm.vector{x1, x2, ...} -> dm.vector
---
---A vector of the entries of a table or another vector; dm.vector(n) has n zeros. Entries are numbers, or symbols and hyper-dual numbers inside a traced function. + - * / work with vectors and numbers; tables of numbers are taken as vectors; v[i] counts from 1. Raises when an entry is no number.
---@param options? table
---@return dm.vector
function dm.vector(options) end

---dm.where(c, a, b) -> number
---
---a where c > 0, else b: the way to branch in a function that is traced. Both sides are computed; derivatives are those of the side that is taken.
---@param c? any
---@param a? any
---@param b? any
---@return number
function dm.where(c, a, b) end

---who()
---
---The globals that were made in this session, with what they are.
function dm.who() end

---dm.zeros(n [, columns]) -> dm.vector or dm.matrix
---
---n zeros, or n x columns of them.
---@param n? any
---@param columns? any
---@return dm.vector|dm.matrix
function dm.zeros(n, columns) end

return dm
