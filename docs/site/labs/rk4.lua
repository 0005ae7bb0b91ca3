-- the same step by a rule of order 4 that is not symplectic and by one of order 2 that is
dm.lab { file = arg[1] .. "/rk4.html", title = "RK4 against Verlet", names = { "RK4", "Verlet" }, frames = 200,
  sliders = { h = { 0.05, 1, 12, "log" }, t = { 20, 400, 5 } },
  run = function(h, t)
    local pendulum = dm.system { Q = dm.R(1), coordinates = { "theta" },
      L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
    local start = { q = { 2 }, v = { 0 }, t = t }
    return { pendulum:solver { rule = "rk4", h = h }:run(start),
      pendulum:solver { rule = "verlet", h = h }:run(start) }
  end,
  draw = function(q) return { points = { { math.sin(q[1]), -math.cos(q[1]) } }, rods = { { 0, 1 } } } end }
