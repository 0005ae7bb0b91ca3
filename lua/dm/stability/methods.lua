--- Methods of systems, solvers and ensembles whose modules are loaded when first used: stability
-- maps, linearised systems, multipliers, sections, fans.
local blame = require "dm.base.blame"
local core = require "dm.core"

core.method("dm.system", "stability", function(system, options)
  local given = {}
  for key, value in pairs(type(options) == "table" and options or {}) do given[key] = value end
  given.system = system
  return require "dm.stability".stability(given)
end, [[
system:stability{q=, v= | p=, rule= | rules=, h=, steps= | t=, ...} -> dm.stability_map
The same as dm.stability{system = system, ...}.]])

core.method("dm.system", "linearize", blame.later("dm.measure.linearize", "linearize"), [[
system:linearize{q=, v=, t=} -> {stable, why, fastest, frequencies, rates, matrix}
The system linearised at a state (v default 0, t default 0): d(dq, dv)/dt = matrix (dq, dv), with
real parts `rates` and imaginary parts `frequencies` of its eigenvalues. At an equilibrium, and at a
relative equilibrium (v along coordinates that L does not depend on), this is its linear stability;
anywhere else how fast the system oscillates there, frozen. fastest: the largest frequency, which a
step has to resolve.]])

core.method("dm.solver", "multipliers", blame.later("dm.measure.linearize", "multipliers"), [[
solver:multipliers{q=, v= | p=, steps= | t=, t0=} -> {stable, why, largest, re, im, matrix, closes}
The eigenvalues of the exact tangent map over a run: the Floquet multipliers where the run is one
period of a periodic orbit (closes: the distance of its end from its start), or one step of a
relative equilibrium. A symplectic rule has them in pairs m, 1/m; stable: none has a modulus above 1
by more than round-off allows (multipliers 1 of the period and of symmetries are double, and known
to the root of round-off only).]])

core.method("dm.solver", "fold", blame.later("dm.measure.step_limits", "fold"), [[
solver:fold{q=, v= | p=, up_to=} -> {h, fold, q1, why}
Up to which step does an implicit step from this state have a solution? The solution q1 of p + D1
Ld(q, q1) = 0 is followed from small h to up_to (default 256 steps of the solver) and the fold,
where two solutions meet, found where det D1D2 Ld vanishes; h is infinite when there is none. fold =
false with a finite h: Newton's method gives up although the matrix is regular. Stage rules and
discrete Lagrangians.]])

core.method("dm.solver", "singularities", blame.later("dm.measure.step_limits", "singularities"), [[
solver:singularities{q=, v= | p=, steps= | t=, t0=} -> {worst, t, q, places, why, failure}
Do the coordinates break down on the way? The condition of d2L/dv2 at the rows of a run (at most
4000), the worst and where; places: {t, condition} where it exceeds 1e4; failure: the code that
ended the run, if one did. why names the coordinate that loses its inertia.]])

core.method("dm.solver", "section", blame.later("dm.measure.poincare", "section"),
  "solver:section{g= | period=, q=, v= | p=, starts=, t= | steps=, t0=, direction=, x=, y=, "
  .. "xlabel=, ylabel=, every=, project=} -> dm.section\n" .. [[
The Poincare section of a run: where it crosses the surface g(q, v, t, p) = 0; g may be the name of
a coordinate, "q1"; period = T in its place: each period of a driven system from t0 on (a
stroboscope). direction: "up" (g grows; the default), "down" or "both". starts = { {q =, v =}, {q =,
p =}, ... }: several runs, one of which may fail. x, y: what is read off a crossing, names of
columns ("q2", "p2", "t") or functions of (q, p, t); left out: another coordinate than g and its
momentum. Crossings are found by steps of fitting length, with the accuracy of the rule; two within
one step are not seen. section:plot() draws them. every = k keeps rows of the runs,
orbits[i].path.]])

core.method("dm.ensemble", "plot", blame.later("dm.show.fan", "plot"), [[
ensemble:plot([x, y,] {members=, file=, title=, style=, ...}) -> file name or nothing
With rows (every=, rows=, watch=): the fan of the members' paths, columns as in path:plot (left out:
the first column against t). Without: where the members ended, a point each, as columns of q and p
("q1", "p1" or the names of the coordinates; left out: q1 and q2, or q1 and p1). members: how many
are drawn, evenly chosen (default 64 paths, all points), or a list of their numbers. Colours go from
blue to red with the number of the member; one that failed is grey up to there, and is not drawn as
an end. Options as in dm.plot.]])
