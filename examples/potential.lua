-- When is a force field the slope of a potential? On a disc whenever it has no curl; on a ring one number is in the way (Poincare's lemma, Leok 3.11)
local dm = require "dm"
local abs, atan, pi = math.abs, math.atan, math.pi
local picture = (arg and arg[1] or ".") .. "/potential.png"

-- the wind round a post: closed, and the change of the angle along every edge
local function around(K)
  local values, points = {}, K:points()
  for i, e in ipairs(K:simplices(1)) do
    local p, q = points[e[1]], points[e[2]]
    values[i] = atan(p[1] * q[2] - p[2] * q[1], p[1] * q[1] + p[2] * q[2])
  end
  return K:form(1, values)
end
local ring = dm.mesh { annulus = { 4, 24 }, ratio = 2.5 }
local wind = around(ring)
assert(wind:d():max() < 1e-14 and abs(wind:pair(ring:generators(1)[1])) - 2 * pi < 1e-12, "no curl, but once around it is 2 pi")
local fine, why = pcall(ring.potential, ring, wind)
assert(not fine and why:find "period", "so there is no potential")
print(why:match "the form is.-%(":sub(1, -3))

-- a disc that is cut out of it has one: the angle itself
local slit = {}
for _, t in ipairs(ring:simplices(2)) do
  local x, y = 0, 0
  for _, v in ipairs(t) do x, y = x + ring:points()[v][1] / 3, y + ring:points()[v][2] / 3 end
  if not (x > 0 and abs(y) < 0.35) then slit[#slit + 1] = t end
end
local disc = dm.mesh { points = ring:points(), simplices = slit }
assert(disc:betti()[2] == 0, "no hole is left")
local angle = disc:potential(around(disc))
assert((angle:d() - around(disc)):max() < 1e-13, "a potential: the angle")

-- the same in integers: p with dp + pd = 1 draws every mesh together that can be, a dunce hat too, though it has no free edge
for _, K in ipairs { dm.mesh { cube_tiling = 2 }, dm.mesh { shells = { 3, 2 } }, dm.mesh { named = "dunce" } } do
  local p = K:cone()
  assert(p.poincare and p:check() == 0, "dp + pd = 1, exactly")
end
assert(not pcall(function() return dm.mesh { named = "dunce" }:cone { rule = "collapse" } end), "no free edge")
print(("angle over the disc: from %.3f to %.3f"):format(math.min(table.unpack(angle.values:totable())), math.max(table.unpack(angle.values:totable()))))
print("picture  " .. angle:plot { file = picture, title = "The potential of a wind round a post, on a ring that is cut", label = "angle" })
