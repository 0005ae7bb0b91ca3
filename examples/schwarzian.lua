-- Curves u(x) that make the integral of {u; x}^2 stationary: why does a consistent invariant scheme get worse when the step gets
-- smaller? The recurrence of SL(2) invariants (Bogfjellmo 2011, (6.4), figure 6.1) has a triple root 1 in a Jordan block. The tool
-- says so before anything is run. The same equations, carrying their Noether momentum, keep order 2 down to 1e-9.
local dm = require "dm"
local sin, atan, sqrt, abs, max = math.sin, math.atan, math.sqrt, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/schwarzian.png"

local line = dm.action { group = dm.SL(2), on = dm.R(1) }
local function problem(h, width) -- the cross-section u = -width, Su = 0, S^2 u = width, where sigma = S^3 u/width
  local rho = dm.moving_frame { action = line, points = 3,
    cross_section = function(a, b, c) return { a[1] + width, b[1], c[1] - width } end,
    solution = function(a, b, c)
      local u, v, w = a[1], b[1], c[1] -- the frame (6.5)
      local g = dm.matrix { { width * (w - u), -width * (w - u) * v }, { (w - v) - (v - u), (w - u) * v - 2 * u * (w - v) } }
      return g / dm.sqrt(2 * width * (w - u) * (w - v) * (v - u))
    end }
  return dm.invariant_problem { frame = rho, L = function(I)
    return (I[4][1] - 2 * I[3][1] + I[2][1]) ^ 2 / (width ^ 2 * h ^ 3) -- (sigma - 2)^2/h^3
  end }
end

-- u = phi1/phi2, phi'' = -eta phi/2, eta''' + 3 eta eta' = 0; phi1(0) = phi1(3) = phi2(0) = 1, phi2(3) = -1; eta = 1, eta' = 1/2, eta'' = 0 at 0
local b1, b2 = 0, 0
local solver = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 end,
  force = function(q, v) return { 1.5 - 1.5 * q[1] ^ 2, -q[1] * q[2] / 2, -q[1] * q[3] / 2 } end }
  :solver { rule = "gauss(6)", h = 1 / 1024 }
local function angles(x) -- of the lines through (phi2, phi1), u = tan(angle)
  local path, out = solver:run { q = { 1, 1, 0 }, v = { 0.5, 0, 1 }, at = x }, {}
  for i = 1, #path do out[i] = atan(path.q[i][2] + b1 * path.q[i][3], path.q[i][2] + b2 * path.q[i][3]) end
  return out, path.q[#path]
end
local _, q = angles { 0, 3 }
b1, b2 = (1 - q[2]) / q[3], (-1 - q[2]) / q[3] -- phi = (1 at 0) + b (1' at 0)
-- frame and momentum at x = 0: (y1, y2) = M (phi1, phi2) has y1/y2 = x + O(x^3); <J, w> = 2 eta W'' - 2 eta' W' + (2 eta'' + 4 eta^2) W, W = w/u'
local M = dm.matrix { { -1, 1 }, { b2, -b1 } } / (b2 - b1)
local frame, J = M / sqrt(M:det()), { -4 * 0.5, 2 * 0 + 2 * 1, -4 * 1 }

-- largest distance of the lines; point k of the curve is at x = ((k - 1) every + first) h
local function error_of(curve, h, every, first)
  local x, u, worst = {}, {}, 0
  for k = first < 0 and 2 or 1, #curve - 3 do x[#x + 1], u[#u + 1] = ((k - 1) * every + first) * h, curve.points[k][1] end
  for i, a in ipairs(angles(x)) do worst = max(worst, abs(sin(atan(u[i]) - a))) end
  return worst
end
print(problem(0.01, 0.01):stability { points = { 0, 0.01, 0.02, 0.03, 0.04, 0.05 }, steps = 256 })
local printed, stable = { x = {}, y = {}, name = "the recurrence as printed" }, { x = {}, y = {}, name = "the same, carrying its momentum" }
for i, n in ipairs { 50, 100, 200, 300, 400, 600, 1200, 2400, 4800, 9600, 19200, 38400, 76800, 153600, 204800 } do
  local h, every, first = 3 / n, max(1, n // 600), {}
  for k, a in ipairs(angles { 0, h, 2 * h, 3 * h, 4 * h, 5 * h }) do first[k] = math.tan(a) end
  if n <= 1200 then
    printed.x[i], printed.y[i] = n, error_of(problem(h, 1):solve { points = first, n = n + 1, form = "points" }, h, 1, 0)
  end
  -- the section through the arc of constant eta = 1, sqrt(2) tan(x/sqrt(2)), at x = -h, 0, h
  stable.x[i], stable.y[i] = n, error_of(problem(h, sqrt(2) * math.tan(h / sqrt(2))):solve {
    frame = frame, body_momentum = J, n = n + 2, every = every }, h, every, -1)
  print(("%6d steps: as printed %-8s carrying its momentum %.2e"):format(n, printed.y[i] and ("%.2e"):format(printed.y[i]) or "", stable.y[i]))
  assert(i == 1 or stable.y[i] < stable.y[i - 1], "it should get better with every refinement")
end
assert(stable.y[#stable.y] < 1e-9 and printed.y[7] > 10 * math.min(table.unpack(printed.y)), "one below 1e-9, the other worse again")
print("picture  " .. dm.figure { { title = "largest error on [0, 3]", log = "xy", xlabel = "steps", ylabel = "error", printed, stable }, file = picture })
