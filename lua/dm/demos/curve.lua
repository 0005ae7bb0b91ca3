-- discretizations of TQ by curve segments (Cuell & Patrick 2008)
return {
  title = "Curves: any one-step method, made variational",
  about = [[A Runge-Kutta method draws a curve for every (q, v). Cuell and Patrick take the curves,
    not the steps: join them so that the sum of their actions is stationary. The result is
    symplectic and keeps momenta, whatever the method was, and is as accurate.]],
  numbers = { { name = "n", value = 50, least = 20, most = 400, what = "steps a period" } },
  steps = {
    { "Kepler's ellipse for two hundred periods, by RK4 as it is and by the same RK4 as a "
      .. "curve.", [[
kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
start = { q = {0.5, 0}, v = {0, 3^0.5}, steps = 200*n }
h = 2*math.pi/n
bare = kepler:solver { rule = "rk4", h = h }:run(start)
variational = kepler:solver { rule = "curve(rk4)", h = h }:run(start)]] },
    { "Their energies:", [[
lines = { bare:series("t", "energy", "RK4"), variational:series("t", "energy", "curve(rk4)") }
dm.plot(lines, { height = 14, title = "energy" })]] },
    { "A method of one's own is a function. This one is Ralston's, of order 2:", [[
mine = dm.curve { order = 2, method = function(x, f, h)
  local k = f(x)
  return x + h/4*k + 3*h/4*f(x + 2*h/3*k)
end }
own = kepler:solver { rule = mine, h = h }:run(start)
print(own)
J = own:momentum(dm.SO(2))
print("angular momentum changed by", math.abs(J[#J] - J[1]))]] },
  },
  claim = function(e)
    local a, b = e.bare:drift "energy", e.variational:drift "energy"
    return math.abs(b.per_time) < 1e-3 * math.abs(a.per_time)
      and math.abs(e.J[#e.J] - e.J[1]) < 1e-11,
      ([[The same coefficients: bare, the energy drifts by %.1e a unit of time; as curves by %.1e.
      And Ralston's method, never meant for it, keeps the angular momentum to round-off.]])
        :format(a.per_time, b.per_time)
  end,
}
