-- A hot spot on a hollow ball: how does the heat spread, and when is it as good as even?
-- u' = laplacian u on the unit sphere; spherical harmonics of degree l decay like exp(-l (l + 1) t), so that x y (l = 2) goes like e^(-6 t)
local dm = require "dm"
local exp, abs, log = math.exp, math.abs, math.log
local picture = (arg and arg[1] or ".") .. "/heat_sphere.png"

-- the lowest modes of the mesh carry the answer exactly in time
local function cool(K, u0, t, m)
  local modes = K:laplacian(0):eigen(m)
  local u = 0 * u0
  for k, form in ipairs(modes.forms) do u = u + exp(-modes.values[k] * t) * form:dot(u0) * form end
  return u, modes
end

-- x y has l = 2: only its amplitude changes, by e^(-6 t); the mesh's own eigenvalue is off by order 2
local errors = {}
for s = 1, 3 do
  local K = dm.mesh { icosphere = s }
  local wave = K:form(0, function(x, y) return x * y end)
  local u = cool(K, wave, 0.1, 9)
  errors[s] = abs(u:dot(wave) / wave:dot(wave) / exp(-0.6) - 1)
end
for s = 2, 3 do assert(abs(log(errors[s - 1] / errors[s], 2) - 2) < 0.2, "decay of order 2 in the length of edges") end
print(("decay of x y by t = 0.1, e^-0.6 but for %.1e, %.1e, %.1e"):format(table.unpack(errors)))

-- the spot: heat is kept to round-off, and the hottest place cools
local K = dm.mesh { icosphere = 3 }
local spot = K:form(0, function(x, y, z) return exp(-8 * ((x - 0.6) ^ 2 + y ^ 2 + (z - 0.8) ^ 2)) end)
local even = K:form(0, function() return 1 end)
local heat, last, rows = spot:dot(even), 1 / 0, {}
for _, t in ipairs { 0.01, 0.1, 0.5, 2 } do
  local u = cool(K, spot, t, 100)
  local hottest = u:max()
  assert(abs(u:dot(even) / heat - 1) < 1e-10, "no heat is lost")
  assert(hottest < last, "the hottest place cools")
  rows[#rows + 1], last = ("t = %g: %.4f"):format(t, hottest), hottest
end
assert(abs(last - heat / even:dot(even)) < 0.05 * last, "at the end all is even")
print("hottest place at " .. table.concat(rows, ", "))
print("picture  " .. cool(K, spot, 0.05, 100):plot { file = picture, title = "Heat on a ball, t = 0.05", label = "temperature", azimuth = -0.9 })
