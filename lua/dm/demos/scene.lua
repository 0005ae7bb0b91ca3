-- the cheapest model and method that deliver what is watched
return {
  title = "Scenes: no more than needed",
  about = [[Say what you watch, how exactly, and for how long. A scene finds the cheapest model and
    method that deliver it: it drops what nobody watches, holds a stiff spring as a rod where its
    vibration is not to be seen, chooses rule and step; from pilot runs, never from folklore.]],
  numbers = { { name = "k", value = 1e6, least = 1e4, most = 1e7,
    what = "stiffness of the spring" } },
  steps = {
    { "A pendulum on a stiff spring: stretch a, angle theta.", [[
stiff = dm.system { Q = dm.R(2), coordinates = {"a", "theta"}, L = function(q, v)
  local a, theta = q[1], q[2]
  return (v[1]^2 + (1 + a)^2*v[2]^2)/2 + 9.81*(1 + a)*math.cos(theta) - k/2*a^2
end }
start = { q = {9.81/k, 0.5}, v = {0, 0} }]] },
    { "Only the angle is watched, to a thousandth, for four units of time; without a list of "
      .. "rules it would try all there are:", [[
scene = dm.scene { system = stiff, q = start.q, v = start.v,
  watch = {"theta"}, tolerance = 1e-3, until_t = 4,
  rules = {"verlet", "midpoint", "blanes-moan(6)", "gauss(2)", "gauss(4)", "rk4", "rk8"} }
run = scene:run()
run:plot("t", "theta", { height = 12, style = "linespoints" })]] },
    { "And why:", [[
print(scene:why())]] },
  },
  claim = function(e)
    local held = e.scene:why():find "choice: [^\n]*a held at 0"
    local words = held and "The model that was chosen holds the spring, so its cost does not "
      .. "depend on k: try k = 1e7, and a soft one, k = 1e4."
      or "The spring was not held: at this k that would err too much, or pay too little."
    return e.run.error_estimate <= 1e-3 and (held or e.k < 1e5),
      ("The promise is kept: the error is at most %.1e. %s"):format(e.run.error_estimate, words)
  end,
}
