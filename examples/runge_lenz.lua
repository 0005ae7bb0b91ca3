-- Kepler's problem in momentum space (w = p, xi = -q): can an integrator keep a component of the Runge-Lenz vector?
-- It belongs to rotations of the sphere, seen in the stereographic plane of w. They are no symmetry of any usual discrete
-- Lagrangian; a moving frame makes one invariant (Bogfjellmo 2011, ch. 4, figure 4.1). Beside it: Stoermer-Verlet with fixed and variable steps.
local dm = require "dm"
local sin, cos, sqrt, abs, max, pi = math.sin, math.cos, math.sqrt, math.abs, math.max, math.pi
local picture = (arg and arg[1] or ".") .. "/runge_lenz.png"
local h, steps = 2 * pi / 200, 4000 -- some 20 orbits of energy -1/2

local rotations = dm.action { group = dm.SO(2), on = dm.R(2), map = function(theta, w) -- about the y1 axis (4.10)
  local n = w:dot(w)
  local d = 1 + n - cos(theta) * (n - 1) - 2 * sin(theta) * w[2]
  return { 2 * w[1] / d, (-sin(theta) * (n - 1) + 2 * cos(theta) * w[2]) / d }
end }
local rho = dm.moving_frame { action = rotations, points = 2,
  cross_section = function(w0) return w0:dot(w0) - 1 end, branch = function(w0) return w0[2] end }
-- L = 2 sqrt|w'| - |w|^2/2, trapezoidal; h = htilde sigma(w0) with sigma = 2/(1 + |w|^2) is htilde on the section
local Ld0 = dm.discrete_lagrangian { Q = dm.R(2), h = h, Ld = function(w0, w1, h)
  return 2 * sqrt(h) * sqrt((w1 - w0):norm()) - h / 4 * (w0:dot(w0) + w1:dot(w1))
end }
local path = dm.solver { rho:invariantize { Ld = Ld0, sigma = function(w) return 2 / (1 + w:dot(w)) end } }
  :run { q = { 0.96, 0.28 }, p = { -0.8, -0.6 }, steps = steps, every = 1 }

-- Stoermer-Verlet with steps h / z: z = 1 is fixed, z' = -q.p/|q|^2 keeps the steps near h |q| (Hairer & Soederlind 2005)
local function verlet(variable)
  local function control(q, p) return variable and -(q:dot(p)) / q:dot(q) or 0 end
  local rows = dm.sequence { y = { 0.8, 0.6, 0.96, 0.28, 1 }, unknowns = 1, steps = steps,
    start = function() return { 1 } end, equation = function(y, x) return { x[1] - 1 } end,
    next = function(y)
      local q, p, z = dm.vector { y[1], y[2] }, dm.vector { y[3], y[4] }, y[5]
      z = z + h / 2 * control(q, p)
      p = p - q * (h / (2 * z) / q:norm() ^ 3)
      q = q + p * (h / z)
      p = p - q * (h / (2 * z) / q:norm() ^ 3)
      return { q[1], q[2], p[1], p[2], z + h / 2 * control(q, p) }
    end }
  return function(i) local y = rows[i] return { y[1], y[2] }, { y[3], y[4] } end
end
local function invariant(i) return -path.p[i], path.q[i] end

local integrals = { -- H, S and R of (4.2)
  { "H", function(q, p) return (p[1] ^ 2 + p[2] ^ 2) / 2 - 1 / sqrt(q[1] ^ 2 + q[2] ^ 2) end },
  { "S", function(q, p) return q[1] * p[2] - q[2] * p[1] end },
  { "R1", function(q, p) return p[2] ^ 2 * q[1] - p[1] * p[2] * q[2] - q[1] / sqrt(q[1] ^ 2 + q[2] ^ 2) end },
  { "R2", function(q, p) return p[1] ^ 2 * q[2] - p[1] * p[2] * q[1] - q[2] / sqrt(q[1] ^ 2 + q[2] ^ 2) end } }
local figure, worst = { file = picture, size = { 1100, 700 }, title = "errors of the first integrals of Kepler's problem, eccentricity 0.94" }, {}
for k, method in ipairs { { "moving frame", invariant }, { "Verlet, variable", verlet(true) }, { "Verlet, fixed", verlet(false) } } do
  for j, integral in ipairs(integrals) do
    local x, y, f = {}, {}, integral[2]
    for i = 2, steps + 1, 3 do x[#x + 1], y[#y + 1] = i - 1, max(abs(f(method[2](i)) - f(method[2](1))), 1e-17) end
    figure[j] = figure[j] or { title = integral[1], log = "y", xlabel = "step" }
    figure[j][k], worst[integral[1] .. k] = { x = x, y = y, name = method[1] }, max(table.unpack(y))
  end
end
local J, drift = path:momentum(rotations), 0
for i = 1, #J do drift = max(drift, abs(J[i] - J[1])) end
print(("moving frame: H to %.1e, S %.0e, R2 %.1e, its own momentum <xi, v> %.0e"):format(worst.H1, worst.S1, worst.R21, drift))
print(("Verlet, variable steps: H %.1e, R2 %.1e; with fixed steps H is off by %.2g"):format(worst.H2, worst.R22, worst.H3))
assert(drift < 1e-12 and worst.H1 < 2e-3 and worst.R21 < worst.R22 / 10 and worst.H3 > 0.3)
print("picture  " .. dm.figure(figure))
