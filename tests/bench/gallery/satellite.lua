-- the J2 satellite of Leok 2.9
local dm = require "dm"
local J2 = 0.05
return {
  title = "J2 satellite, three hundred units of time (fifty orbits)",
  text = [[A nearly circular orbit has no near point to resolve: everything converges at once, and what counts is how far one evaluation carries. Gauss rules with a step of
a fifteenth of an orbit win from four digits on; gauss(6) is at ten digits with its coarsest step.]],
  { dm.system { Q = dm.R(3), L = function(q, v)
      local r, z = q:norm(), q[3]
      return v:dot(v) / 2 + 1 / r - J2 / r ^ 3 * (3 * z ^ 2 / (2 * r ^ 2) - 1 / 2)
    end }, q = { 1, 0, 0 }, v = { 0, 0.96, 0.28 }, t = 300,
    rules = { "verlet", "blanes-moan(6)", "kahan-li(8)", "gauss(2)", "gauss(4)", "gauss(6)", "rk4", "rk8" }, h = { 0.4, 0.2, 0.1, 0.05, 0.025 } },
}
