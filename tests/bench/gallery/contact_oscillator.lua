-- the contact oscillator of Modin and Verdier (2020), beside its accelerations by hand
local dm = require "dm"
local sqrt = math.sqrt
local start, h = { q = { sqrt(1.5), 1, -sqrt(0.5) }, v = { 0, 0, 0 } }, { 0.4, 0.2, 0.1, 0.05, 0.025 }
return {
  title = "Contact oscillator, six hundred units of time",
  text = [[Nonholonomic, reversible, integrable: symmetric rules do not drift on it, and rk8 does not yet after six hundred units of time. The rivals have the accelerations
with the multiplier eliminated by hand, explicit and three unknowns in place of seven: rk8 wins at every accuracy. Rules for rolling constraints are for systems where
nobody wants to do that by hand, and for keeping the constraint.]],
  { dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end,
      rolling = function(q, v) return v[1] + q[2] * v[3] end }, q = start.q, v = start.v, t = 600,
    rules = { "midpoint", "gauss(2)", "gauss(3)", "gauss(4)", "suzuki(4, midpoint)" }, h = h },
  { dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end, force = function(q, v)
      local pull = (q[1] + q[2] * q[3] - v[2] * v[3]) / (1 + q[2] ^ 2) -- the multiplier of x' + y z' = 0
      return { pull, 0, pull * q[2] }
    end }, suffix = "by hand", q = start.q, v = start.v, t = 600, rules = { "rk4", "rk8" }, h = h },
}
