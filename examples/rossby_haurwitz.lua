-- A wave on a turning planet: does it keep its shape, and what does the scheme keep?
-- Vorticity w' = -*(d psi ^ d w), div grad psi = w. A spherical harmonic of degree 4 in a rotation moves as a whole, by 1 - 2/(4 5) = 0.9 a unit
-- of time (Haurwitz 1940).
local dm = require "dm"
local abs, cos, sin = math.abs, math.cos, math.sin
local picture = (arg and arg[1] or ".") .. "/rossby_haurwitz.png"

local function vorticity(K, t)
  local c, s = cos(0.9 * t), sin(0.9 * t)
  return K:form(0, function(x, y, z)
    local a, b = c * x + s * y, c * y - s * x
    return 2 * z + 6 * z * (a ^ 3 - 3 * a * b ^ 2)
  end)
end

-- the error falls towards order 2; three integrals stay to round-off, whatever the mesh
local figures, flow, K = { 0.69985549041, 0.20388443755, 0.05350867450 }, nil, nil
for i, level in ipairs { 2, 3, 4 } do
  K = dm.mesh { icosphere = level }
  flow = K:euler { vorticity = vorticity(K, 0) }:solver { rule = "midpoint", h = 0.2 / 2 ^ i }:run { t = 2 }
  local off = (flow:form(#flow) - vorticity(K, 2)):norm() / vorticity(K, 2):norm()
  assert(abs(off - figures[i]) < 1e-9, "error of the vorticity")
  for _, what in ipairs { "energy", "enstrophy", "circulation" } do
    assert(flow:drift(what).largest < 1e-13 * flow:drift("energy").mean, what .. " is kept")
  end
  print(("%5d vertices, h = %-5g: vorticity off by %.4f, energy by %.1g, enstrophy by %.1g, circulation by %.1g"):format(K:count(0), flow.h, off,
    flow:drift("energy").largest, flow:drift("enstrophy").largest, flow:drift("circulation").largest))
end
print("picture  " .. flow:plot("w", { file = picture, title = "Rossby-Haurwitz wave, t = 2" }))
