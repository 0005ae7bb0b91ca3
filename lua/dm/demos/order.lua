-- Galerkin integrators, collocation and their orders (Leok 5; Marsden & West 2001, 2.6; Hairer,
-- Lubich & Wanner II)
return {
  title = "Orders: what a better quadrature of the action buys",
  about = [[A discrete Lagrangian is a curve between two positions and a quadrature of L along it.
    Polynomials of degree s with the s points of Gauss give a method of order 2 s; with those of
    Lobatto 2 s - 2. The action decides the order, and it is measured here.]],
  numbers = { { name = "s", value = 3, least = 1, most = 5, what = "points of the largest rule" } },
  steps = {
    { "A double pendulum, unit rods and masses, and its Gauss and Lobatto rules.", [[
pendulum = dm.system { Q = dm.R(2), L = function(q, v)
  local a, b = q[1], q[2]
  return v[1]^2 + v[2]^2/2 + v[1]*v[2]*math.cos(a - b) + 2*math.cos(a) + math.cos(b)
end }
rules = {}
for k = 1, s do rules[#rules + 1] = ("gauss(%d)"):format(k) end
rules[#rules + 1] = ("galerkin(%d, lobatto(%d))"):format(s, s + 1)]] },
    { "Each with smaller and smaller steps, against a reference that two unlike methods agree "
      .. "on:", [[
chart = pendulum:chart { q = {0.5, -0.3}, v = {0.2, 0.4}, t = 2,
  rules = rules, h = {0.2, 0.1, 0.05, 0.025}, repeats = 1 }
chart:plot { against = "h", height = 16 }]] },
    { "Slopes are orders:", [[
measured = {}
for k, rule in ipairs(rules) do
  local order, why = chart:order(rule)
  measured[k] = order
  print(rule, order and ("order %.2f"):format(order) or why)
end]] },
  },
  claim = function(e)
    local fine, last = true, 0
    for k = 1, math.min(e.s, 3) do
      fine = fine and e.measured[k] and math.abs(e.measured[k] - 2 * k) < 0.25
      last = k
    end
    return fine,
      ([[Gauss with s points has order 2 s: measured %.2f for s = %d. Beyond s = 4 the last steps
      are at round-off, and there is no slope left to measure.]])
        :format(e.measured[last] or 0 / 0, last)
  end,
}
