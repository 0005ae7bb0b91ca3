-- Which fields on a ring have neither sources nor swirls? As many as there are ways around it: two, the harmonic forms (Hodge)
local dm = require "dm"
local abs = math.abs
local picture = (arg and arg[1] or ".") .. "/torus_fields.png"

local ring = dm.mesh { torus = { 24, 12 }, radii = { 3, 1 } }
local betti, fields, loops = ring:betti(), ring:harmonic(1), ring:generators(1)
assert(betti[1] == 1 and betti[2] == 2 and betti[3] == 1 and #fields == 2 and #loops == 2, "Betti numbers 1, 2, 1")
for _, h in ipairs(fields) do
  assert(h:d():max() < 1e-10 and h:delta():max() < 1e-9, "neither swirls nor sources")
end
-- their periods round two loops are a matrix that can be inverted: the fields are told apart by how they go round
local periods = {}
for i, h in ipairs(fields) do
  periods[i] = {}
  for j, c in ipairs(loops) do
    assert(#c:boundary():support() == 0, "a loop is closed")
    periods[i][j] = h:pair(c)
  end
end
local det = periods[1][1] * periods[2][2] - periods[1][2] * periods[2][1]
assert(abs(det) > 1e-3, "the periods are independent")

-- any field is a gradient, a curl and a harmonic part, each orthogonal to the others
local wind = ring:form(1, function(x, y, z) return { -y + z, x, x * y / 4 } end)
local parts = wind:hodge()
assert((parts.exact + parts.coexact + parts.harmonic - wind):max() < 1e-10, "the parts add up")
assert(abs(parts.exact:dot(parts.coexact)) < 1e-9 and abs(parts.exact:dot(parts.harmonic)) < 1e-9, "and are orthogonal")
-- around the hole it goes like d(phi): its period there is that of its harmonic part alone, but for what d takes away
local why = select(2, pcall(ring.potential, ring, parts.harmonic))
assert(tostring(why):find "period", "a harmonic field has no potential: its period is in the way")
print(("|wind|^2 = %.4f: exact %.4f, coexact %.4f, harmonic %.4f"):format(wind:norm() ^ 2, parts.exact:norm() ^ 2, parts.coexact:norm() ^ 2, parts.harmonic:norm() ^ 2))
print(tostring(why):match "the form is closed.-%(")
print("picture  " .. parts.harmonic:sharp { to = "cells" }:plot { file = picture, title = "The harmonic part of a wind on a ring", height = 0.9 })
