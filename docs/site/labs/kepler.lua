-- Kepler's ellipse: which step and which rule at which eccentricity
dm.lab { file = arg[1] .. "/kepler.html", title = "Kepler: step, eccentricity, rule", frames = 150,
  sliders = { h = { 0.01, 0.5, 9, "log" }, e = { 0, 0.9, 7 }, rule = { "verlet", "gauss(2)", "rk4" } },
  run = function(h, e, rule)
    local kepler = dm.system { Q = dm.R(2), coordinates = { "x", "y" },
      L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
    return kepler:solver { rule = rule, h = h }:run { q = { 1 - e, 0 }, v = { 0, ((1 + e)/(1 - e))^0.5 },
      t = 40 }
  end }
