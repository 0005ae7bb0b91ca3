-- Which curves does an elastic rod take in space? Its equations in curvature and torsion come out of the group of rigid motions and
-- a cross-section of jets alone, as exact formulas (Bogfjellmo 5.2-5.4); so do the force and the moment that it carries.
local dm = require "dm"
local picture = (arg and arg[1] or ".") .. "/rods.png"

local space = dm.differential_invariants { action = dm.action { group = dm.SE(3), on = dm.R(3) }, independent = 1,
  invariants = { kappa = 6, w = 9 }, branch = function(z) return z[6] end, -- w = kappa tau
  cross_section = function(z) return { z[1], z[2], z[3], z[4], z[5], z[7] } end }
local function bending(I) return I.kappa[1] ^ 2 / 2 end
print(space)
print(space:euler_lagrange(bending))
local E = space:euler_lagrange(bending)
assert(tostring(E[1]) == "kappa_ss + kappa^3/2 - w^2/kappa" and tostring(E[2]) == "w kappa_s/kappa + w_s")
-- E_2 = 0 has the first integral kappa w = kappa^2 tau
local rods = {}
for k, w in ipairs { 0.2, 0.4, 0.7 } do
  rods[k] = space:extremal { L = bending, start = { kappa = { 1, 0.4 }, w = { w } }, length = 14, steps = 700 }
  local worst = 0
  for i = 1, #rods[k].kappa do worst = math.max(worst, math.abs(rods[k].kappa[i] * rods[k].w[i] / w - 1)) end
  print(("kappa w = %.2f is kept to %.0e along the rod"):format(w, worst))
  assert(worst < 1e-8, "kappa^2 tau is constant")
end
-- in the plane: Noether's c of jets, the force and moment of an elastica
local plane = dm.differential_invariants { action = dm.action { group = dm.SE(2), on = dm.R(2) }, independent = 1,
  invariants = { kappa = 4 }, cross_section = function(z) return { z[1], z[2], z[3] } end }
print(plane:conservation_law(bending))
local wire = plane:extremal { L = bending, start = { kappa = { 0.5, 1 } }, length = 12, steps = 600 }
local force = {}
for k = 1, #wire.kappa, 100 do -- rotated back: v = (-kappa^2/2, -kappa_s, kappa)
  local y, angle = wire.path.q[k], wire.frame[k][3]
  local a, b = -y[1] ^ 2 / 2, -y[2]
  force[#force + 1] = { math.cos(angle) * a - math.sin(angle) * b, math.sin(angle) * a + math.cos(angle) * b }
end
for k = 2, #force do assert(math.abs(force[k][1] - force[1][1]) + math.abs(force[k][2] - force[1][2]) < 1e-9, "the force is constant") end
-- a page that moves: points slide along the three rods
local columns = {}
for i = 1, 19 do columns[i] = {} end
for i = 1, 701 do
  columns[1][i] = rods[1].s[i]
  for k = 1, 3 do
    for j = 1, 3 do columns[1 + 3 * (k - 1) + j][i], columns[10 + 3 * (k - 1) + j][i] = rods[k].points[i][j], 0 end
  end
end
local still = dm.system { name = "rods", Q = dm.R(9), L = function(_, v) return v:dot(v) / 2 end }
dm.path { system = still, h = 0.02, columns = columns }:animate(picture:gsub("png$", "html"), { title = "elastic rods in space", points = { { "q1", "q2", "q3" }, { "q4", "q5", "q6" }, { "q7", "q8", "q9" } }, dim = 3, trail = 20, frames = 300, plots = { "q1" } })
local above, curvature = { title = "from above", equal = true, xlabel = "x", ylabel = "y" }, { title = "curvature along them", xlabel = "s", ylabel = "kappa" }
for k, w in ipairs { 0.2, 0.4, 0.7 } do
  local name = ("kappa w = %.2f"):format(w)
  above[k] = { x = rods[k].points:column(1), y = rods[k].points:column(2), name = name }
  curvature[k] = { x = rods[k].s, y = rods[k].kappa, name = name }
end
print("picture  " .. dm.figure { above, curvature, file = picture, size = { 1100, 480 }, title = "Elastic rods by their invariants" })
