-- a pendulum on a stiff spring, Leok 5.7, the spring at rest on the circle where its pull balances
local dm = require "dm"
local k = 1e6
return {
  title = "Pendulum on a stiff spring, k = 10^6, two seconds",
  text = [[The spring is a thousand times as fast as the swing. Explicit rules do not work at all beyond h omega of order 2, that is h = 0.002; implicit ones may step
over the vibration, and then have the accuracy of the swing alone: for two digits the midpoint rule with a step twenty times as large is cheapest. The plateau at 10^-5 is
the vibration itself, which all coarse steps miss; where it is to be right, explicit splittings are cheapest. If it is not to be seen, use a rod: see the
spherical pendulum.]],
  { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - 9.81 * q[2] - k * (q:norm() - 1) ^ 2 / 2 end },
    q = { math.sqrt(0.5), -math.sqrt(0.5) }, v = { 0, 0 }, t = 2,
    rules = { "verlet", "blanes-moan(6)", "kahan-li(8)", "midpoint", "gauss(2)", "gauss(4)", "rk4", "rk8" },
    h = { 0.04, 0.01, 0.0025, 0.001, 0.0005, 0.00025 } },
}
