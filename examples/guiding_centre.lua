-- Does the banana of a trapped particle in a tokamak stay closed? A guiding centre has a Lagrangian linear in v,
-- L = (A(x) + u b(x)) . x' - u^2/2 - mu |B(x)|, q = (R, Z, phi, u), with equations of first order.
-- Field, particle and units of Ellison, Burby and Qin (2015): B0 = R0 = 1, safety factor 2; a bounce takes about 43,000.
local dm = require "dm"
local sqrt, log, abs, max, min = math.sqrt, math.log, math.abs, math.max, math.min
local picture = (arg and arg[1] or ".") .. "/guiding_centre.png"

local mu = 2.25e-6
local particle = dm.system { name = "guiding centre", Q = dm.R(4), coordinates = { "R", "Z", "phi", "u" }, L = function(q, v)
  local R, Z, u = q[1], q[2], q[4]
  local r2 = (R - 1) ^ 2 + Z ^ 2 -- distance from the axis
  local S = sqrt(r2 + 4)         -- |B| = S / (2 R), b = (Z, 1 - R, 2) / S
  local A_R, A_Z, A_phi = Z / (2 * R), -log(R) / 2, -r2 / 4
  return (A_R + u * Z / S) * v[1] + (A_Z + u * (1 - R) / S) * v[2] + (A_phi + 2 * u * R / S) * v[3]
    - (u ^ 2 / 2 + mu * S / (2 * R))
end }
local start = { q = { 1.05, 0, 0, -4.306e-4 } }

-- 1,800 bounces with 54 steps each; the first and the last ones drawn
start.steps, start.every = 100000, 1
local path = particle:solver { rule = "degenerate(2)", h = 800 }:run(start)
local E, p, worst, turn = path:energy(), path.p, 0, 0
local banana = { { x = {}, y = {}, name = "first 3 bounces", style = "lines" }, { x = {}, y = {}, name = "last 3 of 1,800" } }
local width = { math.huge, 0 }
for i = 1, #path do
  worst, turn = max(worst, abs(E[i] / E[1] - 1)), max(turn, abs(p[i][3] - p[1][3]))
  local which = i <= 160 and 1 or i > #path - 160 and 2
  if which then
    local q, part = path.q[i], banana[which]
    part.x[#part.x + 1], part.y[#part.y + 1] = q[1], q[2]
    width = { min(width[1], q[1]), max(width[2], q[1]) }
  end
end
print(("energy in a band of %.1e, toroidal momentum to %.1e; R from %.4f to %.4f"):format(worst, turn, width[1], width[2]))
assert(worst < 1e-5 and turn < 1e-13, "the energy has a band, the momentum of the cyclic angle is exact")

-- the last bounces lie on the curve of the first
local gap = 0
for k = 1, #banana[2].x do
  local near = math.huge
  for i = 1, #banana[1].x do
    near = min(near, (banana[1].x[i] - banana[2].x[k]) ^ 2 + (banana[1].y[i] - banana[2].y[k]) ^ 2)
  end
  gap = max(gap, sqrt(near))
end
print(("the last bounces are within %.4f of the first, on a banana %.3f wide"):format(gap, width[2] - width[1]))
assert(gap < 0.001, "the banana stays closed")
for k = 1, 2 do banana[k].xlabel, banana[k].ylabel = "R", "Z" end
print("picture  " .. dm.figure { file = picture, title = "guiding centre of a trapped particle", size = { 560, 560 },
  { equal = true, style = "points", banana[1], banana[2] } })
