-- the pendulum on a cart of the example, swinging below it without a controller
local dm = require "dm"
local M, m, l, g = 1, 0.2, 0.5, 9.81
return {
  title = "Pendulum under a cart, a minute",
  text = [[The example holds a control over every step, so that there the step is part of the question; here the cart runs free and the pendulum swings below
it. L does not separate, so Verlet is implicit and has no advantage left. rk8 wins for two digits, gauss(4) from there on.]],
  { dm.system { Q = dm.R(2), L = function(q, v)
      return (M + m) * v[1] ^ 2 / 2 + m * l * v[1] * v[2] * math.cos(q[2]) + m * l ^ 2 * v[2] ^ 2 / 2 - m * g * l * math.cos(q[2])
    end }, q = { 0, 2.2 }, v = { 0.1, 0 }, t = 60,
    rules = { "verlet", "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "rk4", "rk8" }, h = { 0.2, 0.1, 0.05, 0.025, 0.0125 } },
}
