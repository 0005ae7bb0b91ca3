-- holonomic constraints: RATTLE and variational rules with multipliers (Marsden & West 2001, 3;
-- Hairer, Lubich & Wanner VII.1)
return {
  title = "Constraints: a pendulum in space, with a rod",
  about = [[A rod is an equation, g(q) = 0, beside L. Its multiplier is found in every step with the
    position, so that the rod has its length to the last digit after a million steps, and the
    step is still symplectic.]],
  numbers = { { name = "h", value = 0.05, least = 0.002, most = 0.2, what = "step" } },
  steps = {
    { "A unit mass on a rod of unit length, in coordinates x, y, z: no angles, and no pole.", [[
pendulum = dm.system { Q = dm.R(3), coordinates = {"x", "y", "z"},
  L = function(q, v) return v:dot(v)/2 - q[3] end,
  constraint = function(q) return q:dot(q) - 1 end }
print(pendulum)]] },
    { "Pushed sideways, it draws an ellipse that turns. From above:", [[
solver = pendulum:solver { rule = "rattle", h = h }
swing = solver:run { q = {0.8, 0, -0.6}, v = {0, 0.25, 0}, t = 60 }
swing:plot("x", "y", { width = 60, height = 18 })]] },
    { "The rod, the energy, and the momentum about the vertical after a long run:", [[
long = solver:run { q = {0.8, 0, -0.6}, v = {0, 0.25, 0},
  steps = 200000, every = 100 }
J = long:momentum(function(q) return {-q[2], q[1], 0} end)
print("rod off by", long:worst "constraint")
print("energy drifts by", long:drift("energy").per_time, "a unit of time")
print("momentum moved by", long:drift(J).largest)]] },
  },
  claim = function(e)
    local energy = e.long:drift "energy"
    return e.long:worst "constraint" < 1e-14 and e.long:drift(e.J).largest < 1e-11
      and math.abs(energy.per_time) < 1e-6,
      ([[After 200,000 steps the rod is off by %.0e, the vertical momentum moved by %.0e, and the
      energy error is a band of %.1e: a larger step widens the band, nothing else.]])
        :format(e.long:worst "constraint", e.long:drift(e.J).largest, energy.largest)
  end,
}
