-- Runge-Kutta methods bare and as curves, on Kepler's ellipse over a longer time
local dm = require "dm"
return {
  title = "Runge-Kutta methods bare and as curves: Kepler, e = 0.6, a hundred periods",
  text = [[The same coefficients with and without the action principle. A curve takes four to five bare steps, and over a hundred periods that is not
yet paid back at equal error, at either order: who wants positions over such a time takes a Gauss rule, and who wants a curve has other reasons for its method. What a
curve buys grows with time: its error grows linearly where the bare method's grows quadratically, and its energy stays (see the
[example](examples.md) over a thousand periods).]],
  { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, q = { 0.4, 0 }, v = { 0, 2 }, t = 200 * math.pi,
    rules = { "curve(rk4)", "curve(dop853)", "rk4", "rk8", "gauss(2)", "gauss(4)" }, h = { 0.2, 0.1, 0.05, 0.025, 0.0125 } },
}
