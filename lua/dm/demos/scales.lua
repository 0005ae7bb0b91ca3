-- steps over many vibrations (Leok 5.7)
return {
  title = "Scales: a step over many vibrations",
  about = [[A pendulum on a stiff spring: the spring vibrates at omega = sqrt(k) while it swings. A
    curve of powers of t and of sin(w t), cos(w t), integrated by Filon's weights, has both in one
    step, at a cost that does not depend on k.]],
  numbers = { { name = "k", value = 1e4, least = 1e3, most = 1e8, what = "stiffness" } },
  steps = {
    { "Stretch a and angle theta; released at rest.", [[
spring = dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
  return (v[1]^2 + (1 + q[1])^2*v[2]^2)/2 + 9.81*(1 + q[1])*math.cos(q[2]) - k*q[1]^2/2
end }
q, v = {0.01, 0.8}, {0, 0}]] },
    { "Eight steps in a second, and one that resolves the vibration:", [[
rule = dm.multiscale { frequency = k^0.5, degrees = {2, 3} }
solver = spring:solver { rule = rule, h = 1/8 }
path = solver:run { q = q, v = v, steps = 8 }
fine = spring:solver { rule = "gauss(6)", h = 0.5/k^0.5 }:run { q = q, v = v, at = {1} }
print("theta in 8 steps:", path.q[9][2], "resolved:", fine.q[1][2])
print(("Newton: %.1f iterations a step"):format(solver:report().newton_per_step))]] },
    { "Rows inside a step are read off its curve:", [[
at = {}
for i = 1, 200 do at[i] = i/200*15/k^0.5 end
inside = solver:run { q = q, v = v, at = at }
inside:plot("t", "a", { height = 12 })]] },
  },
  claim = function(s)
    local off = math.abs(s.path.q[9][2] - s.fine.q[1][2])
    return off < 1e-4,
      ([[Eight steps, each %.0f radians of the vibration, give the angle to %.0e.]])
        :format(s.k ^ 0.5 / 8, off)
  end,
}
