-- At which frequencies does a triangular microwave cavity ring, and how many triangles does it take to hear them?
-- delta d A = omega^2 A with A = 0 along the walls: the equilateral triangle of side 1 has omega^2 = 16 pi^2/9 (m^2 + m n + n^2), and as many
-- zero modes as there are vertices inside: gradients, which are no waves (Leok 3.9; spec's tri(8))
local dm = require "dm"
local pi, abs, log = math.pi, math.abs, math.log
local picture = (arg and arg[1] or ".") .. "/cavity.png"

local function waves(N, m)
  local K = dm.mesh { triangle = N }
  return K, K:laplacian(1, { part = "up", fixed = "boundary" }):eigen(m, { above = 1 })
end

local exact = { 1, 1, 3, 4, 4 } -- m^2 + m n + n^2 of (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)
local errors = {}
for i, N in ipairs { 8, 16, 32 } do
  local _, modes = waves(N, 5)
  errors[i] = {}
  for k, s in ipairs(exact) do
    errors[i][k] = abs(modes.values[k] / (16 * pi ^ 2 / 9 * s) - 1)
    assert(modes.residuals[k] < 1e-8, "an eigenform")
  end
  print(("%4d triangles: omega^2 = %.5f %.5f %.5f %.5f %.5f"):format(N * N, table.unpack(modes.values:totable())))
end
for k = 1, 5 do assert(abs(log(errors[2][k] / errors[3][k], 2) - 2) < 0.1, "frequencies of order 2") end
assert(abs(errors[1][1] - abs(17.44597694 / (16 * pi ^ 2 / 9) - 1)) < 1e-9, "the first one of 64 triangles, from the literature of the scheme")

-- zero modes are the gradients of functions inside: waves are what is orthogonal to them
local K, modes = waves(12, 3)
local inside = K:count(0) - #K:boundary_cells(0)
local all = K:laplacian(1, { part = "up", fixed = "boundary" }):eigen(inside + 1, { near = -1 })
assert(all.values[inside] < 1e-8 and all.values[inside + 1] > 1, "as many zero modes as vertices inside")
assert(modes.forms[1]:delta().values:norm() >= 0 and abs(modes.forms[1]:norm() - 1) < 1e-12, "modes are of norm 1")
print(("%d modes of frequency 0, %d vertices inside"):format(inside, inside))
print("picture  " .. modes.forms[3]:plot { file = picture, title = "Cavity: the third mode, omega^2 = " .. ("%.3f"):format(modes.values[3]), label = "E along edges" })
