-- the guiding centre of a trapped particle (Ellison, Burby and Qin 2015), beside its equations of first order solved for q'
local dm = require "dm"
local sqrt, log, mu = math.sqrt, math.log, 2.25e-6
local function alpha(q)
  local R, Z, u = q[1], q[2], q[4]
  local r2 = (R - 1) ^ 2 + Z ^ 2
  local S = sqrt(r2 + 4)
  return Z / (2 * R) + u * Z / S, -log(R) / 2 + u * (1 - R) / S, -r2 / 4 + 2 * u * R / S
end
local function energy(q) return q[4] ^ 2 / 2 + mu * sqrt((q[1] - 1) ^ 2 + q[2] ^ 2 + 4) / (2 * q[1]) end
-- L = alpha . q' - H: W q' = grad H with W_ij = d_i alpha_j - d_j alpha_i; nothing depends on phi, alpha_u = 0
local gradient, slope = dm.derivative(energy, 4), dm.derivative(function(x) return { alpha(x) } end, 4)
local function velocity(q)
  local d, W = slope(q), {}
  for i = 1, 4 do
    W[i] = {}
    for j = 1, 4 do W[i][j] = (j < 4 and d[j][i] or 0) - (i < 4 and d[i][j] or 0) end
  end
  return dm.matrix(W):solve(gradient(q))
end
local change = dm.derivative(velocity, 4)
local q, h = { 1.05, 0, 0, -4.306e-4 }, { 1600, 800, 400, 200, 100 }
return {
  title = "Guiding centre in a tokamak, two bounces",
  text = [[L is linear in the velocity: the equations are of first order, and rules for second-order systems refuse it. The rivals integrate q' = f(q), solved
for by the inverse of the symplectic matrix and differentiated once to fit a Lagrangian (q'' = Df q'). Over two bounces they win at every accuracy,
most of their time being set-up, the expression of that inverse in symbols; what decides over thousands of bounces is that only the symplectic rules
keep the banana closed (see the [example](examples.md)).]],
  { dm.system { Q = dm.R(4), L = function(x, v)
      local a, b, c = alpha(x)
      return a * v[1] + b * v[2] + c * v[3] - energy(x)
    end }, q = q, v = { 0, 0, 0, 0 }, t = 86000, error = function(x) return x[1] end,
    rules = { "degenerate(1)", "degenerate(2)", "degenerate(3)" }, h = h },
  { dm.system { Q = dm.R(4), L = function(_, v) return v:dot(v) / 2 end, force = function(x, v) return change(x) * v end }, suffix = "solved for q'", q = q, v = velocity(dm.vector(q)), t = 86000, error = function(x) return x[1] end,
    rules = { "rk4", "rk8" }, h = h },
}
