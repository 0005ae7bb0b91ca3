-- the exact tangent map: Lyapunov exponents and MEGNO (Cincotta & Simo 2000) on Henon and Heiles
-- (1964)
return {
  title = "Chaos: orderly or not, by the exact tangent map",
  about = [[Henon and Heiles asked in 1964 whether a star in a galaxy has a third integral. At low
    energy its orbit is orderly; at high energy some fill areas, and neighbours part
    exponentially. The derivative of a variational step is a variational step, so the tangent map
    is exact.]],
  numbers = { { name = "E", value = 0.125, least = 0.01, most = 0.166, what = "energy" },
    { name = "y", value = -0.1, least = -0.25, most = 0.3, what = "where on the cut" } },
  steps = {
    { "", [[
star = dm.system { Q = dm.R(2), L = function(q, v)
  local x, y = q[1], q[2]
  return v:dot(v)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3
end }
start = { q = {0, y}, v = {(2*E - y^2 + 2*y^3/3)^0.5, 0} }]] },
    { "The orbit, and its cut with x = 0 where x grows:", [[
solver = star:solver { rule = "blanes-moan(6)", h = 0.1 }
path = solver:run { q = start.q, v = start.v, t = 6000, every = 1000,
  events = { cut = { g = function(q) return q[1] end, direction = "up" } } }
ys, ps = {}, {}
for i, event in ipairs(path.events) do ys[i], ps[i] = event.q[2], event.p[2] end
dm.plot(ys, ps, { style = "points", width = 64, height = 18, xlabel = "y", ylabel = "v_y" })]] },
    { "MEGNO tends to 2 on an orderly orbit and grows with time on a chaotic one:", [[
l = solver:lyapunov { q = start.q, v = start.v, t = 6000 }
print("MEGNO", l.megno, "exponent", l.exponent)]] },
  },
  claim = function(e)
    local chaotic, words = e.l.megno > 4, "orderly"
    if chaotic then
      words = ("chaotic, neighbours part by e every %.0f units of time"):format(1 / e.l.exponent)
    end
    return chaotic and e.path:drift("energy").largest < 1e-6,
      ([[MEGNO is %.3g: this orbit is %s. The energy was kept to %.0e meanwhile. Try E = 0.08: the
      same start is orderly.]])
        :format(e.l.megno, words, e.path:drift("energy").largest)
  end,
}
