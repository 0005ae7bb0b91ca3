-- linear stability: h omega = 2 of leapfrog, none of the midpoint rule (Hairer, Lubich & Wanner
-- XIII)
return {
  title = "Stiff: where an explicit rule breaks",
  about = [[A pendulum on a spring: the swing is slow, the spring fast, with omega = sqrt(k). An
    explicit rule must follow the spring though nobody wants to see it: Verlet breaks at h omega
    = 2, whatever the accuracy. The implicit midpoint rule steps over the vibration.]],
  numbers = { { name = "factor", value = 2.02, least = 0.1, most = 10, what = "h omega" },
    { name = "k", value = 1e6, least = 1e3, most = 1e10, what = "stiffness" } },
  steps = {
    { "", [[
pendulum = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v)/2 - 9.81*q[2] - k*(q:norm() - 1)^2/2
end }
start = { q = {0.7, -0.7141428428542850}, v = {0, 0}, steps = 3000 }
h = factor/k^0.5]] },
    { "Both rules with that step. A run that fails raises an error that says where, and keeps "
      .. "the path so far:", [[
verlet = pendulum:solver { rule = "verlet", h = h }
held, path = pcall(verlet.run, verlet, start)
print("verlet:", held and path or path.message)
midpoint = pendulum:solver { rule = "midpoint", h = h }:run(start)
print("midpoint:", midpoint)
midpoint:plot("q1", "q2", { width = 56, height = 12 })]] },
    { "The energy of Verlet, run after run, as the step grows:", [[
x, y = {}, {}
for i = 1, 40 do
  x[i] = 1.6 + 0.015*i
  solver = pendulum:solver { rule = "verlet", h = x[i]/k^0.5 }
  fine, run = pcall(solver.run, solver, start)
  y[i] = fine and math.min(run:drift("energy").largest, 1e9) + 1e-12 or 1e9
end
dm.plot(x, y, { log = "y", height = 12, style = "linespoints",
  xlabel = "h omega", ylabel = "energy error of verlet" })]] },
  },
  claim = function(e)
    local limit = 0
    for i = 1, 40 do
      if e.y[i] < 100 then limit = e.x[i] end
    end
    return math.abs(limit - 2) < 0.03 and e.midpoint:drift("energy").largest < 1,
      ([[Verlet holds up to h omega = %.2f; theory: 2. The midpoint rule has no limit (energy off
      by %.1e at h omega = %g).]]):format(limit, e.midpoint:drift("energy").largest, e.factor)
  end,
}
