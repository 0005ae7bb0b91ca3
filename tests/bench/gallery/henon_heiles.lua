-- an orderly orbit of Henon and Heiles
local dm = require "dm"
return {
  title = "Hénon-Heiles, E = 1/12, a thousand units of time",
  text = [[A cheap polynomial force and a smooth orbit: Nystroem splittings lead at every accuracy, and rk8 takes four times their time and more. At
E = 1/8 many orbits are chaotic: errors then grow exponentially, no chart of positions means anything over a long time, and dm.chart says that its
references disagree.]],
  { dm.system { Q = dm.R(2), L = function(q, v)
      local x, y = q[1], q[2]
      return v:dot(v) / 2 - (x ^ 2 + y ^ 2) / 2 - x ^ 2 * y + y ^ 3 / 3
    end }, q = { 0, 0.1 }, v = { math.sqrt(1 / 6 - 0.01 + 0.002 / 3), 0 }, t = 1000,
    rules = { "verlet", "yoshida(4)", "blanes-moan(4)", "blanes-moan(6)", "kahan-li(8)", "gauss(4)", "rk4", "rk8" }, h = { 0.8, 0.4, 0.2, 0.1, 0.05 } },
}
