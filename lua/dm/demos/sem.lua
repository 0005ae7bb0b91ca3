-- steps that keep the discrete energy (Kane, Marsden & Ortiz 1999; Leok 5.5)
return {
  title = "Steps that keep the energy",
  about = [[A symplectic rule with equal steps keeps the energy in a band. Make the length of a step
    one more unknown, and the energy itself the equation for it: then it is kept to round-off. On
    an ellipse that works up to e = 0.79.]],
  numbers = { { name = "e", value = 0.5, least = 0.05, most = 0.78, what = "eccentricity" } },
  steps = {
    { "Kepler's problem from the pericentre.", [[
kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
q, v = {1 - e, 0}, {0, ((1 + e)/(1 - e))^0.5}
h = 0.14*(1 - e)^1.5]] },
    { "The first step is h, its discrete energy that of all others. Columns h, E_d, fallback:", [[
path = kepler:solver { rule = "sem(1, gauss(1))", h = h }:run { q = q, v = v, steps = 200 }
print(path)
path:plot("t", "h", { height = 12 })]] },
    { "The energy E_d does not move; H, the energy of the states, swings beside it:", [[
print("E_d:", path:drift "E_d")
print("H:  ", path:drift "energy")]] },
    { "Where no step has the energy the rule says so: beyond the border", [[
beyond = kepler:solver { rule = "sem(1, gauss(1))", h = 0.01 }
  :run { q = {0.18, 0}, v = {0, (1.82/0.18)^0.5}, steps = 60 }
print(beyond.sem.fallbacks .. " of 60 steps without a root at e = 0.82")]] },
  },
  claim = function(s)
    local off = s.path:drift "E_d".largest
    return off < 1e-12 and s.path.sem.fallbacks == 0 and s.beyond.sem.fallbacks > 0,
      ([[Over 200 steps, from %.2g to %.2g long, the discrete energy is off by %.0e.]])
        :format(s.path.sem.least, s.path.sem.largest, off)
  end,
}
