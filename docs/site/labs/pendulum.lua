-- A weight on a stiff spring that swings: the step must follow the spring, or a rule must not need to
dm.lab { file = arg[1] .. "/pendulum.html", title = "A stiff pendulum: step, stiffness", frames = 150,
  sliders = { h = { 0.005, 0.2, 8, "log" }, k = { 10, 1e4, 7, "log" }, rule = { "verlet", "midpoint" } },
  run = function(h, k, rule)
    local spring = dm.system { Q = dm.R(2), coordinates = { "x", "y" },
      L = function(q, v) return v:dot(v)/2 - q[2] - k*(q:norm() - 1)^2/2 end }
    return spring:solver { rule = rule, h = h }:run { q = { 1, 0 }, v = { 0, 0 }, t = 15 }
  end,
  rods = { { 0, 1 } } }
