-- a pendulum on a stiff spring in polar coordinates, of which only the angle is looked at
local dm = require "dm"
local cos = math.cos
local k, t = 1e4, 10
local function angle(q) return q[#q] end
return {
  title = "Angle of a pendulum on a spring, k = 10^4, ten seconds",
  text = [[The mass depends on the stretch, so there are no cheap splittings; the spring starts where it balances, and the angle hardly feels it. The midpoint rule and gauss(2) are
cheapest for two digits. From there on rk8 wins, whose steps of h omega = 5 damp a vibration that nobody looks at. The plateau of gauss(4) is the vibration that it steps over and keeps;
its line turns back where sweeps take the place of Newton's method. A rigid pendulum is another motion, by 10^-2 here: the example shows what is gained where that is good enough.]],
  { dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
      return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - k / 2 * q[1] ^ 2
    end }, q = { 9.81 * cos(0.5) / k, 0.5 }, v = { 0, 0 }, t = t, error = angle, rules = { "midpoint", "gauss(2)", "gauss(4)", "rk4", "rk8" },
    h = { 0.2, 0.1, 0.05, 0.02, 0.01, 0.005 } },
}
