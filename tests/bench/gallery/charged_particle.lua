-- a particle in a magnetic field, what Kaluza and Klein's fifth dimension leaves
local dm = require "dm"
return {
  title = "Charge in an uneven magnetic field, fourteen circles",
  text = [[L is linear in the vector potential: positions and velocities do not separate, so that Verlet solves an equation in every step as the midpoint rule
does. Over so short a run half of the cost is set-up, the trace of the reduced Lagrangian, and rk8 wins; at ten digits Gauss rules are level with
it.]],
  { dm.system { Q = dm.R(3), L = function(q, v)
      local a = -2 * q[3] - q[3] ^ 2 / 2
      return (v[2] ^ 2 + v[3] ^ 2 + (v[1] + a * v[2]) ^ 2) / 2
    end }:routh { cyclic = { 1 }, mu = 1.5 }, q = { 0.8, 0 }, v = { 1, 0 }, t = 30,
    rules = { "verlet", "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "gauss(6)", "rk4", "rk8" }, h = { 0.2, 0.1, 0.05, 0.025 } },
}
