-- an oscillator with a rim at q = -1, three quarters of the way up
local dm = require "dm"
return {
  title = "Oscillator with a rim, ten periods",
  text = [[One coordinate, a force of two operations: everything is overhead and order. Verlet is lost beyond h = 1.2 at this amplitude (see the stability map
of the example), and long before that it is not accurate. Splittings of order 4 and 6 with many small stages are the cheapest down to eight digits, a Gauss rule below; the explicit
Runge-Kutta method of order 8 takes about three times their time at every error.]],
  { dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 - q[1] ^ 3 / 3 end },
    q = { -0.75 }, v = { 0 }, t = 80, rules = { "verlet", "blanes-moan(4)", "blanes-moan(6)", "kahan-li(8)", "gauss(4)", "rk4", "rk8" },
    h = { 0.4, 0.2, 0.1, 0.05, 0.025 } },
}
