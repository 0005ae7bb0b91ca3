-- Kepler's ellipse with steps that their energy chooses, e = 0.5, four periods
local dm = require "dm"
return {
  title = "Steps that keep the energy, e = 0.5, four periods",
  text = [[Steps that keep the energy do not win here, at no accuracy: their energy is right and their time is not, and the position error is that of
the time. At equal h sem(1, gauss(1)) takes 1.8 times the time of midpoint and has three times its error; sem(2, gauss(2)), which has no kernel of its own, takes eight
times the time of gauss(2) and has five times its error. The splitting of the logarithmic Hamiltonian chooses its steps as well, by the distance, explicitly, and is
exact on the ellipse but for the timing: it leads everywhere. What sem is for is the energy E_d, to round-off whatever the step.]],
  { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }, q = { 0.5, 0 }, v = { 0, math.sqrt(3) }, t = 8 * math.pi,
    rules = { "sem(1, gauss(1))", "sem(2, gauss(2))", "midpoint", "gauss(2)", "log-hamiltonian", "log-hamiltonian(kahan-li(8))", "rk8" },
    h = { 0.16, 0.08, 0.04, 0.02, 0.01, 0.005 } },
}
