-- maps of where a method fails, beside linear theory
return {
  title = "Stability: a map of where a method fails",
  about = [[Every cell of a map is a run: a step and a stiffness, told apart by what came of it.
    Borders are refined by bisection, and stand beside the linear theory of the rule, the roots
    of its amplification matrix.]],
  numbers = { { name = "steps", value = 2000, least = 200, most = 20000,
    what = "steps in every cell" } },
  steps = {
    { "A spring whose stiffness is an argument of the function that makes the system.", [[
function spring(k)
  return dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - k*q[1]^2)/2 end }
end]] },
    { "Steps from 0.01 to 1, stiffnesses from 100 to 10,000:", [[
function diagram(rule)
  return dm.stability { system = spring, rule = rule, q = {1}, v = {0}, steps = steps,
    h = {0.01, 1, 40, "log"}, k = {1e2, 1e4, 5, "log"} }
end
map = diagram "verlet"
map:plot()
print(map)]] },
    { "A composition of order 4 takes larger steps inside, and bears less:", [[
fourth = diagram "yoshida(4)"
worst = 0
for i, k in ipairs(map.k) do
  local a, b = map:limit(i)*k^0.5, fourth:limit(i)*k^0.5
  print(string.format("k = %5.0f  verlet h omega = %.4f  yoshida(4) %.4f", k, a, b))
  worst = math.max(worst, math.abs(a/2 - 1))
end]] },
  },
  claim = function(e)
    local yoshida = e.fourth:limit(3) * e.map.k[3] ^ 0.5
    return e.worst < 0.03 and math.abs(yoshida - 1.5734) < 0.05,
      ([[Verlet breaks at h omega = 2 to %.1f percent, for every stiffness; theory: 2. Yoshida's
      composition of order 4 breaks at %.3f; theory: 1.573. Its middle stage goes backwards, by
      more than a step.]]):format(100 * e.worst, yoshida)
  end,
}
