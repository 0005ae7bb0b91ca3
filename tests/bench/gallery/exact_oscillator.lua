-- an oscillator, whose exact discrete Lagrangian has no error at all
local dm = require "dm"
return {
  title = "Harmonic oscillator, two hundred periods",
  text = [[For a linear force nothing is wasted: orders show as they are, and a Nystroem splitting of order 6 leads until order 8 pays. The exact discrete Lagrangian of the
example (Marsden and West 2001) has no error but round-off at any step, and so is not in the picture: it answers a question that one can ask of linear systems only.]],
  { dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - 1.125 * q:dot(q) end }, q = { 1 }, v = { 0 }, t = 200 * 2 * math.pi / 1.5,
    rules = { "verlet", "yoshida(4)", "blanes-moan(6)", "kahan-li(8)", "gauss(2)", "gauss(4)", "rk4", "rk8" }, h = { 0.8, 0.4, 0.2, 0.1, 0.05 } },
}
