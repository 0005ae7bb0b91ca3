-- a field on a line: from its action to cells of space and time, and the laws that they keep
return {
  title = "Fields: a kink on cells of space and time",
  about = [[u_tt - u_xx + sin u = 0 has kinks that run along. Space and time are cut into
    rectangles, u is bilinear in each, and the sum of their actions is made stationary: one equation
    a node.]],
  numbers = { { name = "v", value = 0.5, least = 0.1, most = 0.9, what = "speed of the kink" } },
  steps = {
    { "The field, by its Lagrangian; u stays at the ends.", [[
field = dm.field { x = { -15, 15, 120 }, fixed = "ends",
  L = function(u, ut, ux) return (ut^2 - ux^2)/2 - (1 - dm.cos(u)) end }
print(field, field:stability_limit())]] },
    { "A kink, u and its rate; x across, t up:", [[
g = 1 / math.sqrt(1 - v^2)
run = field:solver { rule = "cell(gauss(2))", h = 0.125 }:run { t = 10, every = 4,
  u = function(x) return 4 * math.atan(math.exp(g * x)) end,
  ut = function(x) return -2 * v * g / dm.cosh(g * x) end }
run:plot "u"]] },
    { "How far is it off, and what became of the energy?", [[
off = 0
for i, x in ipairs(run.nodes:totable()) do
  local exact = 4 * math.atan(math.exp(g * (x - v * 10)))
  off = math.max(off, math.abs(run.u[#run][i] - exact))
end
print(off, run:drift("energy").largest)]] },
    { [[What cells keep: around every node the form of two first variations adds up to zero.
    Momentum is kept to order 2, or to round-off where the nodes move (free = "x").]], [[
form, momentum = run:multisymplectic(), run:conservation "x"
print(form, momentum)]] },
    { "With free heights each slab has the energy of the first one:", [[
free = field:solver { h = 0.125, free = "t" }:run { steps = 20, u = run.u[1],
  ut = function(x) return -2 * v * g / dm.cosh(g * x) end }
print(free:drift("energy").largest, free.t[#free])]] },
  },
  claim = function(e)
    return e.form < 1e-11 and e.free:drift("energy").largest < 1e-11,
      ("The form is kept to %.0e, and the kink is off by %.2g."):format(e.form, e.off)
  end,
}
