-- a pendulum on a stiff spring in its stretch and angle, Leok 5.7: the start of the stiff spring of the benchmark, and one that vibrates
local dm = require "dm"
local k, cos = 1e6, math.cos
local spring = dm.system { Q = dm.R(2), coordinates = { "a", "theta" }, L = function(q, v)
  return (v[1] ^ 2 + (1 + q[1]) ^ 2 * v[2] ^ 2) / 2 + 9.81 * (1 + q[1]) * cos(q[2]) - k * q[1] ^ 2 / 2 end }
local function chart(a, suffix, rules)
  return { spring, q = { a, 1 }, v = { 0, 0 }, t = 16, suffix = suffix, error = function(q) return q[2] end,
    rules = rules, h = { 0.5, 0.25, 0.125, 0.0625, 0.01, 0.001 } }
end
local rules = { "midpoint", "gauss(3)", "gauss(4)", "rk8", dm.multiscale { frequency = math.sqrt(k), degrees = { 2, 3 } } }
return {
  title = "Pendulum on a vibrating spring, k = 10^6, the angle",
  text = [[Released where the spring has its natural length it hardly vibrates, and gauss(3) and gauss(4), which step over the vibration, are as
good as a space that has it, and cheaper: 1e-6 in 128 steps of the sixteen seconds. Stretched by 2 % at the start, the vibration carries energy, and Gauss rules stay at an
error of 1e-2 in the angle until they resolve it; steps with powers, sines and cosines of omega t (dm.multiscale) have 2e-4 at h = 1/8. rk8 must resolve the vibration in any
case, and is ahead from six digits on.]],
  chart(0, "at rest", rules), chart(0.02, "stretched", rules),
}
