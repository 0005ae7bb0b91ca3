-- Where is a bent surface curved, and what can its triangles know of it? A mesh has no second derivatives, but vectors carried round a
-- vertex come back turned by 2 pi less the sum of its angles: the discrete Levi-Civita connection. These deficits sum to 2 pi chi
-- on every mesh (Gauss-Bonnet), and over areas they tend to the curvature of the surface (Leok 4.7.3; E10 of docs/theory/connections.md).
local dm = require "dm"
local cos, sin, pi, abs, acos = math.cos, math.sin, math.pi, math.abs, math.acos
local picture = (arg and arg[1] or ".") .. "/mesh_curvature.png"

-- a ring of tube radius r about a circle of R has the curvature cos(u)/(r (R + r cos u)), + outside, - inside
local R, r, last = 3, 1, nil
local function ring(n) return dm.mesh { torus = { 2 * n, n }, radii = { R, r } } end
for _, n in ipairs { 12, 24, 48 } do
  local K = ring(n)
  local deficit, area, points, worst, sum = K:levi_civita():angle(), K:dual_volume(0), K:points(), 0, 0
  for v = 1, K:count(0) do
    local x, y = points[v][1], points[v][2]
    local c = (math.sqrt(x * x + y * y) - R) / r
    worst, sum = math.max(worst, abs(deficit[v] / area[v] - c / (r * (R + r * c)))), sum + deficit[v]
  end
  print(("%5d triangles: curvature to %.1e%s, all of it %.1e"):format(K:count(2), worst, last and (", order %.2f"):format(math.log(last / worst, 2)) or "", sum))
  assert(abs(sum) < 1e-11 and (not last or worst < last / 3), "Gauss-Bonnet; curvature of second order")
  last = worst
end

-- the same on any mesh: a sphere has 4 pi whatever is done to it
local potato = dm.mesh { icosphere = 4, map = function(x, y, z) return { x * (1.3 + 0.3 * sin(3 * z)), y * (1 + 0.2 * cos(4 * x)), z * 1.1 } end }
local A = potato:levi_civita()
local deficit, total = A:angle(), 0
for v = 1, #deficit do total = total + deficit[v] end
assert(abs(total - 4 * pi) < 1e-11, "4 pi of a potato")
-- a vector carried round a vertex, in whatever frames, is turned by the deficit there
local any = potato:levi_civita { frames = function(i) return 2.4 * i end }
local H = any:curvature(7)
assert(abs(math.atan(H[2][1], H[1][1]) - deficit[7]) < 1e-12, "frames do not matter")

-- in space curvature sits on edges: five regular tetrahedra do not close
local five, lone = { { 1, 2, 3, 4 }, { 1, 2, 4, 5 }, { 1, 2, 5, 6 }, { 1, 2, 6, 7 }, { 1, 2, 3, 7 } }, function() return 1 end
local gap = dm.mesh { simplices = five, lengths = lone }:levi_civita():angle()[1]
print(("five tetrahedra lack %.6f rad of a full turn"):format(gap))
assert(abs(gap - (2 * pi - 5 * acos(1 / 3))) < 1e-13)

local area, density = potato:dual_volume(0), {}
for v = 1, #deficit do density[v] = deficit[v] / area[v] end
local curvature = potato:form(0, density)
potato:animate(picture:gsub("png$", "html"), { title = "curvature of a potato", forms = { curvature = curvature } })
print("picture  " .. curvature:plot { file = picture, title = "Deficits over areas: curvature of a bent sphere", label = "curvature" })
