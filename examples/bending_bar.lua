-- A rubber bar, held at one end and turned at the other: what is its shape, and what does it push back with?
-- The stored energy of each triangle is W(F) of its own linear map F; the shape is where their sum is stationary.
local dm = require "dm"
local cos, sin, log, abs = math.cos, math.sin, math.log, math.abs
local picture = (arg and arg[1] or ".") .. "/bending_bar.png"

local N, M, length, width = 24, 4, 6, 1
local points, cells = {}, {}
for j = 0, M do for i = 0, N do points[#points + 1] = { length * i / N, width * j / M } end end
for j = 0, M - 1 do
  for i = 1, N do
    local a = i + (N + 1) * j
    cells[#cells + 1] = { a, a + 1, a + N + 2 }
    cells[#cells + 1] = { a, a + N + 1, a + N + 2 }
  end
end
local K = dm.mesh { points = points, simplices = cells, dual = "barycentric" }

-- neo-Hookean, (|F|^2 - 2 - 2 log J)/2 + (log J)^2: 0 at rest, infinite where a triangle would be flat
local function stored(x, cell)
  local p = cell.points
  local a, b, s, t = p[2] - p[1], p[3] - p[1], x[2] - x[1], x[3] - x[1]
  local D = a[1] * b[2] - a[2] * b[1]
  local f, g, h, k = (s[1] * b[2] - t[1] * a[2]) / D, (t[1] * a[1] - s[1] * b[1]) / D, (s[2] * b[2] - t[2] * a[2]) / D, (t[2] * a[1] - s[2] * b[1]) / D
  local J = log(f * k - g * h)
  return cell.volume * ((f ^ 2 + g ^ 2 + h ^ 2 + k ^ 2 - 2 - 2 * J) / 2 + J ^ 2)
end

-- the right end turned by an angle, about where pure bending has it; the start is the arc of a circle
local function bent(angle)
  local radius = length / angle
  local function arc(x, y) return { (radius - y + width / 2) * sin(x / radius), radius - (radius - y + width / 2) * cos(x / radius) } end
  return K:stationary { values = 2, term = function(X) return K:sum(2, stored, X) end, x = arc,
    fixed = function(x) return x == 0 or x == length end }
end
local energies, shape = {}, nil
for i, angle in ipairs { 0.25, 0.5, 1, 1.5 } do
  local report
  shape, report = bent(angle)
  assert(report.code == "ok" and report.kind == "minimum" and report.residual < 1e-11, report.text)
  energies[i] = report.value
  print(("turned by %.2f rad: energy %.6f, %d iterations"):format(angle, report.value, report.iterations))
end
-- small angles: a beam, energy E I angle^2 / (2 length), so twice the angle is four times the energy
assert(abs(energies[2] / energies[1] - 4) < 0.05, "a beam while the angle is small")
local p = {}
for i = 1, K:count(0) do p[i] = { shape[1][i], shape[2][i] } end
local image = dm.diffeo(K, dm.mesh { points = p, simplices = cells, dual = "barycentric" })   -- raises where a triangle is turned inside out
print("picture  " .. image.to:plot { file = picture, title = "A bar, its right end turned by 1.5 rad" })
