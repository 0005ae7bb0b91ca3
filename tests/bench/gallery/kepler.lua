-- Kepler's ellipse, e = 0.6, for fifty periods
local dm = require "dm"
return {
  title = "Kepler's ellipse, e = 0.6, fifty periods",
  text = [[Every rule of order p reaches its slope only when the near point of the ellipse is resolved; Verlet does not get there in this range. A splitting of
the logarithm of the Hamiltonian changes its step along the ellipse and is exact on it but for the phase: it leads from six digits on. Gauss rules come next,
since a few evaluations in vector registers make a large step. The explicit rival of order 8 takes four times their time and more.]],
  { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, q = { 0.4, 0 }, v = { 0, 2 }, t = 100 * math.pi,
    rules = { "verlet", "yoshida(4)", "blanes-moan(6)", "kahan-li(8)", "gauss(4)", "gauss(6)", "log-hamiltonian(kahan-li(8))", "rk4", "rk8" },
    h = { 0.2, 0.1, 0.05, 0.025, 0.0125 } },
}
