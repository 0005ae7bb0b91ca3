-- Henon and Heiles (1964): is a star's motion in a galaxy orderly or chaotic?
-- L = (v1^2 + v2^2 - q1^2 - q2^2)/2 - q1^2 q2 + q2^3/3, cut where q1 = 0 and p1 > 0. At E = 1/12 the cuts
-- of an orbit lie on curves; at E = 1/8 some orbits fill areas, and neighbours part exponentially.
local dm = require "dm"
local sqrt, abs, log, max = math.sqrt, math.abs, math.log, math.max
local picture = (arg and arg[1] or "build/pictures") .. "/henon_heiles.png"

local star = dm.system { name = "Henon-Heiles", Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 - q:dot(q) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3
end }
local solver = star:solver { rule = "verlet", h = 0.02 }

-- start on the cut with energy E at (q2, p2)
local function on_cut(E, q2, p2)
  return { q = { 0, q2 }, v = { sqrt(2 * E - p2 ^ 2 - q2 ^ 2 + 2 * q2 ^ 3 / 3), p2 } }
end

-- points (q2, p2) where the path goes through q1 = 0 upwards, linear between rows
local function cuts(path)
  local x, y = {}, {}
  local q1, q2, p2 = path:column "q1", path:column "q2", path:column "p2"
  for i = 2, #path do
    if q1[i - 1] < 0 and q1[i] >= 0 then
      local s = q1[i - 1] / (q1[i - 1] - q1[i])
      x[#x + 1], y[#y + 1] = q2[i - 1] + s * (q2[i] - q2[i - 1]), p2[i - 1] + s * (p2[i] - p2[i - 1])
    end
  end
  return x, y
end

-- rate at which a neighbour 1e-9 away parts, from the distance after t = 200
local function parting(E, q2, p2)
  local last = {}
  for i, d in ipairs { 0, 1e-9 } do
    local start = on_cut(E, q2 + d, p2)
    last[i] = solver:run { q = start.q, v = start.v, steps = 10000, every = 10000 }.q[2]
  end
  return log((last[1] - last[2]):norm() / 1e-9) / 200
end
local order, chaos = parting(1 / 12, -0.2, 0), parting(1 / 8, -0.2, 0)
print(("neighbours part as exp(%.3f t) at E = 1/8, as exp(%.3f t) at E = 1/12"):format(chaos, order))
assert(chaos > 0.05, "the orbit at E = 1/8 should be chaotic")
assert(order < 0.02, "the one at E = 1/12 should part no faster than time itself")

local panels, count, worst = { file = picture, title = "Henon-Heiles: cuts at q1 = 0", size = { 1100, 560 } }, 0, 0
for i, E in ipairs { 1 / 12, 1 / 8 } do
  panels[i] = { title = ("E = 1/%.0f"):format(1 / E), legend = false, equal = true, style = "points" }
  for j, point in ipairs { { -0.2, 0 }, { 0.3, 0 }, { 0.1, 0 }, { 0, 0.25 }, { 0, -0.25 }, { -0.1, 0 } } do
    local start = on_cut(E, table.unpack(point))
    local path = solver:run { q = start.q, v = start.v, steps = 500000, every = 5 }  -- t = 10000
    local x, y = cuts(path)
    panels[i][j] = { x = x, y = y, name = ("(%g, %g)"):format(point[1], point[2]), xlabel = "q2", ylabel = "p2" }
    count, worst = count + #x, max(worst, abs(path:drift("energy").largest))
  end
end
print(("%d cuts of 12 orbits, energy error at most %.1e"):format(count, worst))
assert(worst < 1e-4, "energy in its band")
print("picture  " .. dm.figure(panels))
