-- work-precision charts
return {
  title = "Accuracy against cost: which rule to use",
  about = [[The right question to ask of a method is what an accuracy costs. A chart runs every rule
    with every step, measures the error against a reference that two unlike methods agree on, and
    the time; rivals that preserve nothing are in it.]],
  numbers = { { name = "e", value = 0.6, least = 0, most = 0.8,
    what = "eccentricity of the orbit" },
    { name = "t", value = 30, least = 5, most = 200, what = "how long" } },
  steps = {
    { "Kepler's problem, from the near point of an ellipse.", [[
kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
chart = kepler:chart { q = {1 - e, 0}, v = {0, ((1 + e)/(1 - e))^0.5}, t = t, repeats = 1,
  rules = { "verlet", "blanes-moan(6)", "kahan-li(8)", "gauss(4)", "rk8" },
  h = {0.2, 0.1, 0.05, 0.025, 0.0125} }
chart:plot { height = 18 }]] },
    { "What it says in words:", [[
print(chart)]] },
  },
  claim = function(e)
    local a, b = e.chart:cheapest(1e-2), e.chart:cheapest(1e-8)
    local order = e.chart:order "blanes-moan(6)" -- none where these steps are too coarse to tell
    return b and a and b.rule ~= "verlet" and (not order or math.abs(order - 6) < 0.4),
      ([[For two digits %s is cheapest here, for eight %s. Nothing is best at everything, and what
      preserves nothing may win over a short time: measure it on your own system, with your own
      tolerance.]]):format(a and a.rule or "none of these", b and b.rule or "none of these")
  end,
}
