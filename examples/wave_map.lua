-- Does a map of the plane into the sphere that is wound once shrink to a point? (wave maps: Shatah, Struwe; Leok 3.12 for the sums over cells)
-- L = |u_t|^2/2 - |du|^2/2 with |u| = 1: every vertex is a unit vector, moved by RATTLE. The winding number is the area of the images over 4 pi.
local dm = require "dm"
local pi, sqrt, abs, atan = math.pi, math.sqrt, math.abs, math.atan
local picture = (arg and arg[1] or ".") .. "/wave_map.png"

local N, r0 = 48, 0.35
local K = dm.mesh { grid = N }
local maps = K:field { form = 0, values = 3, on = dm.S(2), fixed = "boundary", name = "wave map",
  L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }

-- the stereographic map of a disk, once around the sphere, at rest; it is the south pole along the boundary
local function wound(x, y)
  local a, b = 2 * x - 1, 2 * y - 1
  local r = sqrt(a * a + b * b)
  local angle = r < 1 and pi - 2 * atan(r0 * (1 - r * r), r) or pi -- from the north pole: 0 in the middle, pi from radius 1 on
  local s = r > 0 and math.sin(angle) / r or 0
  return { s * a, s * b, math.cos(angle) }
end
local h = 0.8 * K:field { form = 0, L = function(u, v) return v:dot(v) / 2 - u:d():dot(u:d()) / 2 end }:stability_limit "verlet"
local run = maps:solver { rule = "rattle", h = h }:run { q = wound, v = function() return { 0, 0, 0 } end, t = 0.3, every = 4 }

-- area of a spherical triangle with its sign (van Oosterom, Strackee 1983)
local triangles = K:simplices(2)
local function winding(u)
  local function at(i) return { u[3 * i - 2], u[3 * i - 1], u[3 * i] } end
  local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end
  local sum, signs = 0, K:orientation()
  for k = 1, #triangles do
    local a, b, c = at(triangles[k][1]), at(triangles[k][2]), at(triangles[k][3])
    local volume = a[1] * (b[2] * c[3] - b[3] * c[2]) + a[2] * (b[3] * c[1] - b[1] * c[3]) + a[3] * (b[1] * c[2] - b[2] * c[1])
    sum = sum + signs[k] * 2 * atan(volume, 1 + dot(a, b) + dot(b, c) + dot(c, a))
  end
  return sum / (4 * pi)
end

-- of the disk whose area is the integral of (1 + height) / 2
local star = K:dual_volume(0)
local function radius(u)
  local area = 0
  for i = 1, #star do area = area + star[i] * (1 + u[3 * i]) / 2 end
  return sqrt(area / pi)
end

local energy, last = run:column "energy", #run
for _, i in ipairs { 1, 1 + last // 3, 1 + 2 * last // 3, last } do
  print(("t = %.3f: radius %.3f, wound %.6f times"):format(run.t[i], radius(run.q[i]), abs(winding(run.q[i]))))
end
local longest = 0
for i = 1, K:count(0) do
  local u = run.q[last]
  longest = math.max(longest, abs(sqrt(u[3 * i - 2] ^ 2 + u[3 * i - 1] ^ 2 + u[3 * i] ^ 2) - 1))
end
print(run)
assert(abs(abs(winding(run.q[1])) - 1) < 1e-9 and abs(winding(run.q[last]) - winding(run.q[1])) < 1e-9, "wound once, all the time")
assert(longest < 1e-14, "unit vectors")
assert(run:drift("energy").largest < 0.02 * energy[1], "the energy of RATTLE stays near")
assert(radius(run.q[last]) < 0.8 * radius(run.q[1]), "and it shrinks")
print("picture  " .. run:form(last)[3]:plot { file = picture, title = ("Wave map, height of the image at t = %.2f"):format(run.t[last]), label = "height" })
