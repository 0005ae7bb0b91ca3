-- Two pendula hang from a plate that slides on a table without friction: what stays, and where does the plate go?
-- Plate of mass 2 at (x, y), unit masses at the ends of unit rods, u and w in S^2: L = |V|^2 + (|V + u'|^2 + |V + w'|^2)/2 - g (u_z + w_z).
-- The rigid motions of the table, SE(2), move the plate and turn the rods. Noether: two momenta and the angular momentum stay,
-- and the centre of mass goes straight on whatever the pendula do. A spring to a wall leaves the momentum along the wall alone.
local dm = require "dm"
local cos, sin, abs, max = math.cos, math.sin, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/sliding_plate.png"

local place = dm.product(dm.R(2), dm.S(2), dm.S(2))
local function plate(stiffness)
  return dm.system { name = "plate", Q = place, coordinates = { "x", "y", "ux", "uy", "uz", "wx", "wy", "wz" }, L = function(q, v)
    local V = dm.vector { v[1], v[2], 0 }
    local a, b = V + v:slice(3, 5), V + v:slice(6, 8)
    return V:dot(V) + (a:dot(a) + b:dot(b)) / 2 - 9.81 * (q[5] + q[8]) - stiffness / 2 * q[1] ^ 2
  end }
end

-- (a, b, theta) turns the plane about the origin, then shifts the plate; rods are directions and only turn
local function turned(theta, x, y) return cos(theta) * x - sin(theta) * y, sin(theta) * x + cos(theta) * y end
local motions = dm.action { group = dm.SE(2), on = place, map = function(g, q)
  local x, y = turned(g[3], q[1], q[2])
  local ux, uy = turned(g[3], q[3], q[4])
  local wx, wy = turned(g[3], q[6], q[7])
  return { x + g[1], y + g[2], ux, uy, q[5], wx, wy, q[8] }
end }
local along = dm.action { group = dm.R(1), on = place, map = function(g, q)
  local z = q:copy()
  z[2] = z[2] + g[1]
  return z
end }

local free, held = plate(0), plate(3)
assert(motions:invariant(free), "L is invariant under rigid motions of the table")
local still, why = motions:invariant(held)
assert(not still and along:invariant(held), "with a spring, under shifts along the wall alone")
print("with the spring: " .. tostring(why):match "^(.-) under" .. (" (the first point that shows it: off by %.2f)"):format(why.defect))

local start = { q = { 0, 0, 0.8, 0, -0.6, 0, 1, 0 }, v = { 0.5, -0.35, 0, 1.5, 0, -1, 0, 0.5 }, steps = 4000, project = true }
local path = free:solver({ rule = "rattle", h = 0.005 }):run(start)
local J, change, bend = path:momentum(motions), 0, 0
-- the centre of mass, plate + (u + w)/4, against the straight line
local cx, cy = {}, {}
for i = 1, #path do
  local q = path.q[i]
  change = max(change, (J[i] - J[1]):norm())
  cx[i], cy[i] = q[1] + (q[3] + q[6]) / 4, q[2] + (q[4] + q[7]) / 4
  bend = max(bend, abs(cx[i] - cx[1] - J[1][1] / 4 * path.t[i]), abs(cy[i] - cy[1] - J[1][2] / 4 * path.t[i]))
end
print(("rattle, 20 s: p_x, p_y, J change by %.1e, the centre of mass leaves its line by %.1e, energy swings by %.1e"):format(change, bend,
  path:drift("energy").largest))
assert(change < 1e-11 and bend < 1e-11 and path:worst "constraint" < 1e-13, "what Noether says, to round-off")
local pulled = held:solver({ rule = "rattle", h = 0.005 }):run(start)
local K, M = pulled:momentum(along), pulled:momentum(motions)
assert(abs(K[#pulled] - K[1]) < 1e-11 and (M[#pulled] - M[1]):norm() > 0.1, "and with the spring one momentum of three")
print("picture  " .. dm.plot({ path:series("x", "y", "plate"), { x = cx, y = cy, name = "centre of mass" } },
  { file = picture, title = "A plate with two pendula, from above", equal = true }))
