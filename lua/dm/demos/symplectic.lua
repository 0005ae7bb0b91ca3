-- symplecticity and backward error analysis (Hairer, Lubich & Wanner, VI and IX)
return {
  title = "Symplectic: the energy error stays in a band",
  about = [[A variational step is symplectic: d(q, p) after the step over d(q, p) before it is a
    matrix M with M^T J M = J. So it is the exact motion of a slightly different energy, H + h^p
    H_p + ...; what one measures as H moves in a band of that height and goes nowhere.]],
  numbers = { { name = "h", value = 1.0, least = 0.01, most = 1.5, what = "step" } },
  steps = {
    { "A pendulum that swings far out, by two methods of the same step.", [[
pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
verlet, rk4 = pendulum:solver { rule = "verlet", h = h }, pendulum:solver { rule = "rk4", h = h }
start = { q = {2}, v = {0}, steps = 3000 }]] },
    { "The defect of M^T J M = J over fifty steps, from the exact derivative of the step, no "
      .. "differences:", [[
few = { q = {2}, v = {0}, steps = 50 }
defect = { verlet:symplecticity(few), rk4:symplecticity(few) }
print("verlet", defect[1])
print("RK4", defect[2])]] },
    { "And the energy, over three thousand steps:", [[
a, b = verlet:run(start), rk4:run(start)
lines = { a:series("t", "energy", "verlet"), b:series("t", "energy", "RK4") }
dm.plot(lines, { height = 14, title = "energy" })
drift = { a:drift "energy", b:drift "energy" }
print("drift a unit of time", drift[1].per_time, drift[2].per_time)]] },
    { "The modified energy, which the symplectic step does keep, can be found from the path and "
      .. "the discrete Lagrangian:", [[
finer = pendulum:solver { rule = "verlet", h = math.min(h, 0.3) }
modified = finer:modified_energy { q = {2}, v = {0}, steps = 2000 }
print("moves by", modified.amplitude)]] },
  },
  claim = function(e)
    return e.defect[1] < 1e-11 and e.defect[2] > 1e-8
      and math.abs(e.drift[1].per_time) < 1e-2 * math.abs(e.drift[2].per_time)
      and e.modified.amplitude < e.drift[1].largest / 100,
      ([[Verlet is symplectic to round-off; its energy is off by up to %.2g, and drifts by %.1e a
      unit of time. RK4 is more accurate in a step and drifts by %.1e. The modified energy of
      Verlet moves by %.1e only.]])
        :format(e.drift[1].largest, e.drift[1].per_time, e.drift[2].per_time, e.modified.amplitude)
  end,
}
