-- the free body: its momentum seen from the body, the middle axis, the angle of Montgomery
return {
  title = "A body in free flight",
  about = [[Nothing acts on it, and still its momentum wanders about the body, around the axis of
    least or of most inertia; about the middle one it does not stay. In space the momentum does not
    move at all, and the method keeps that to rounding.]],
  numbers = { { name = "off", value = 0.01, least = 1e-6, most = 0.2,
    what = "how far from the middle axis it starts" } },
  steps = {
    { "Three moments of inertia, no potential.", [[
G = dm.SO(3)
body = dm.system { Q = G, L = function(_, w) return (w[1]^2 + 2*w[2]^2 + 3*w[3]^2)/2 end }
solver = body:solver { rule = "lie(2)", h = 0.05 }]] },
    { "Spun about the middle axis, a little off: its momentum, seen from the body.", [[
path = solver:run { q = G:identity(), p = {off, 2, off}, t = 100 }
path:plot("t", "p2", { width = 64, height = 14 })]] },
    { "It turns over again and again. In space its momentum stands still:", [[
J = path:momentum(G)
moved, least = 0, 2
for i = 1, #J do
  moved = math.max(moved, (J[i] - J[1]):norm())
  least = math.min(least, path.p[i][2])
end
print("momentum in space moved by", moved)
rate = body:linearize { q = G:identity(), v = {0, 1, 0} }.rates
print("rates at which it leaves the middle axis", rate)]] },
  },
  claim = function(e)
    local fastest = math.max(table.unpack(e.rate:totable()))
    return e.least < -1.9 and e.moved < 1e-12 and math.abs(fastest - 1 / math.sqrt(3)) < 1e-9,
      ([[It turned over (J2 came down to %.3f of 2), its momentum in space moved by %.0e, and it
      leaves the middle axis at the rate %.6f = 1/sqrt 3.]]):format(e.least, e.moved, fastest)
  end,
}
