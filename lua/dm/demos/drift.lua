-- degenerate Lagrangians: phase-space Lagrangians linear in the velocity
return {
  title = "Linear in v: predators and prey",
  about = [[Some Lagrangians are linear in the velocity: the momentum is a function of the position,
    and there are half as many unknowns. Predators and prey (Lotka and Volterra) are such a
    system, in the logarithms of their numbers; so are vortices and guiding centres. Their orbits
    close.]],
  numbers = { { name = "h", value = 0.2, least = 0.01, most = 0.5, what = "step" } },
  steps = {
    { "q = (ln prey, ln predators); what is kept is e^x - x + e^y - y.", [[
ecology = dm.system { Q = dm.R(2), coordinates = {"x", "y"}, L = function(q, v)
  return q[2]*v[1] - (math.exp(q[1]) - q[1] + math.exp(q[2]) - q[2])
end }
print(ecology)]] },
    { "", [[
path = ecology:solver { rule = "degenerate(2)", h = h }:run { q = {1, 0}, v = {0, 0}, t = 400 }
prey, predators = path:column "x":map(math.exp), path:column "y":map(math.exp)
dm.plot(prey, predators, { width = 60, height = 16, xlabel = "prey", ylabel = "predators" })]] },
    { "", [[
H = path:energy()
print(path)
print("H drifts by", path:drift("energy").per_time, "a unit of time")]] },
  },
  claim = function(e)
    local d = e.path:drift "energy"
    return math.abs(d.per_time) < 1e-8 and d.largest < 1e-2,
      ([[The orbit closes: what is kept is off by %.1e and drifts by %.1e a unit of time, with
      steps of %g.]]):format(d.largest, d.per_time, e.h)
  end,
}
