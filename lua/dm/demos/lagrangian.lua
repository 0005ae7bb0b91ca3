-- discrete Lagrangians and the discrete Euler-Lagrange equations (Marsden & West 2001, 1.1 to 1.3)
return {
  title = "From a Lagrangian to a motion",
  about = [[A mechanical system is a function: L(q, v), kinetic minus potential energy. Its motion
    makes the action, the integral of L, stationary. Discrete mechanics does the same with
    finitely many positions: Ld(q0, q1) stands for the action of one step, and D2 Ld(q0, q1) + D1
    Ld(q1, q2) = 0 gives the next position from the last two.]],
  numbers = { { name = "h", value = 0.1, least = 0.001, most = 1.5, what = "step" } },
  steps = {
    { "A pendulum, by its angle. The action of a step by the midpoint rule is the whole method; "
      .. "nothing else is declared.", [[
pendulum = dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = function(q0, q1, h)
  local q, v = (q0 + q1)/2, (q1 - q0)/h
  return h*(v:dot(v)/2 + math.cos(q[1]))
end }
print(pendulum)]] },
    { "Two positions, and from them a thousand more, by the discrete Euler-Lagrange equations.", [[
start = { q0 = {1}, q1 = {1 - 0.42*h^2} }
path = pendulum:solver():run { q0 = start.q0, q1 = start.q1, steps = 1000 }
path:plot("t", "q1", { height = 12, xrange = {0, math.min(60, 1000*h)} })]] },
    { "Momenta are derivatives of Ld at either end: after a step and before the next one they "
      .. "are the same. That is the equation that was solved.", [[
worst = 0
for k = 2, #path - 1 do
  after = pendulum:legendre_plus(path.q[k-1], path.q[k])
  before = pendulum:legendre_minus(path.q[k], path.q[k+1])
  worst = math.max(worst, (after - before):norm())
end
print("largest mismatch of momenta", worst)
order = pendulum:order()
print("order, measured", order)]] },
  },
  claim = function(e)
    return e.worst < 1e-13 and math.abs(e.order - 2) < 0.1,
      ([[The equations hold to %.0e in all thousand steps, and the method that came out of the
      midpoint rule is of order %.2f: of order 2, as the rule for the action.]])
        :format(e.worst, e.order)
  end,
}
